#!/usr/bin/env python3
"""The front of `counterpoise synth --search` against a long random search.

  cargo build --release
  python3 tests/peers/designs/front.py [PROJECT ...] [--evaluations NUMBER] [--times 20] [--draws 20000]

Needs Python 3.11, numpy and scipy. For each project, and for each kind of design:

1. the program's front is compared with that of the program's random search (`method = "random"` in [synth.front]), which evaluates `--times` as
   many feedbacks of the same family on the same loop and keeps up to 200 designs: the volumes that both dominate below one reference point, and how many designs
   of each are dominated by the other;
2. the figures of every structure are computed anew from the values of its blocks (the loop of designs.py), and must agree;
3. a random search that is written here, over the parameters of the PI with a lag, must not dominate a design of the program's.

Costs are logarithms of the figures, or margins with their sign turned. The reference point is the worst cost of both fronts, and a tenth of their range
beyond. Exits with 1 if the random search has more volume, or if more than a tolerance separates a design of the front from one that dominates it."""
import argparse, json, os, shutil, subprocess, sys, tempfile, time

import numpy as np

from designs import CLOSE, PROGRAM, ROOT, Loop, ask

EXAMPLES = ['reference-rig', 'servo-pendulum', 'direct-gimbal']
# A design counts as dominated if another is better by this share in every objective: what the grid of the search resolves.
CLEARLY = 2e-3


def front(project, *options):
    begun = time.time()
    found = ask('synth', project, '--search', *options)
    return found, time.time() - begun


def random_front(project, evaluations, seed):
    """The front of the program's random search, from a copy of the project."""
    source = project if os.path.isdir(project) else os.path.dirname(project)
    name = 'project.toml' if os.path.isdir(project) else os.path.basename(project)
    with tempfile.TemporaryDirectory() as folder:
        copy = os.path.join(folder, 'copy')
        shutil.copytree(source, copy)
        with open(os.path.join(copy, name), 'a') as file:
            file.write(f'\n[synth.front]\nmethod = "random"\nevaluations = {evaluations}\npoints = 200\nseed = {seed}\n')
        return front(os.path.join(copy, name))


def costs_of(found, kind):
    margins = [name.endswith('-margin') for name in found['objectives']]
    cost = lambda row: [-f if is_margin else np.log(f) for f, is_margin in zip(row, margins)]
    return np.array([cost(d['figures']) for d in found['designs'] if d['kind'] == kind]).reshape(-1, len(margins))


def volume(points, reference):
    """The volume that points dominate below a reference, by slices of the last cost."""
    points = points[(points < reference).all(axis=1)]
    if not len(points):
        return 0.0
    if points.shape[1] == 1:
        return reference[0] - points.min()
    points = points[np.argsort(points[:, -1])]
    tops = np.append(points[1:, -1], reference[-1])
    return sum((top - points[k, -1]) * volume(points[:k + 1, :-1], reference[:-1])
               for k, top in enumerate(tops) if top > points[k, -1])


def dominated(points, others, share):
    """How many points are beaten by one of the others, by a share in every cost."""
    return sum(bool((others <= point - share).all(axis=1).any()) for point in points) if len(others) else 0


def compare(kind, ours, theirs):
    both = np.vstack([ours, theirs])
    low, high = both.min(axis=0), both.max(axis=0)
    reference = high + 0.1 * np.maximum(high - low, 1e-9)
    a, b = volume(ours, reference), volume(theirs, reference)
    line = dict(kind=kind, ours=len(ours), random=len(theirs), ratio=a / b if b else np.inf,
                ours_dominated=dominated(ours, theirs, 0.0), ours_clearly=dominated(ours, theirs, CLEARLY),
                random_dominated=dominated(theirs, ours, 0.0))
    print(f"   {kind:24} volume over that of random {line['ratio']:.4f}; dominated: {line['ours_dominated']} of {len(ours)} "
          f"({line['ours_clearly']} by more than {CLEARLY}), random {line['random_dominated']} of {len(theirs)}")
    return (a < b) + (line['ours_clearly'] > 0)


def independent(project, found, draws):
    """Figures of the structures, and a random search over the PI with a lag."""
    if 'reading_noise_rad_s' not in found:
        print('   not a loop of rate: its structures are not computed anew here')
        return 0
    loop, wrong = Loop(project), 0
    lines, noise = np.array(found['disturbance']), found['reading_noise_rad_s']
    worst = 0.0
    for design in (d for d in found['designs'] if d['blocks']):
        here = loop.figures(design['blocks'], lines, noise)
        for name, close in CLOSE.items():
            value = design['linear'][name]
            off = abs(here[name] / value - 1) if value and np.isfinite(value) and np.isfinite(here[name]) else 0.0
            worst = max(worst, off / close)
        wrong += not here['stable']
    print(f'   figures of the structures, computed anew: largest difference {worst:.2f} of what the grid explains')
    wrong += worst > 1
    keys = dict(zip(['residual', 'noise-gain', 'max-sensitivity', 'max-complementary', 'control-peak', 'effort'],
                    ['residual_rad_s', 'noise_gain', 'max_sensitivity', 'max_complementary', 'control_peak', 'effort_v']))
    bar = next(k['name'] for k in found['kinds'] if k['role'] == 'bar')
    ours = costs_of(found, bar)
    if not len(ours) or any(name not in keys for name in found['objectives']):
        return wrong
    limits = {k: v for k, v in found['limits'].items() if v and k in keys.values()}
    blocks = [d['blocks'] for d in found['designs'] if d['kind'] == bar]
    values = np.log([[v for b in each for _, v in b['values']] for each in blocks])
    low, high = values.min(axis=0) - 0.7, values.max(axis=0) + 0.7
    random = np.random.default_rng(1)
    loop.w, loop.P = loop.w[::5], loop.P[::5]
    kept = []
    for x in low + (high - low) * random.random((draws, 3)):
        drawn = [dict(kind='pi', values=[('gain', np.exp(x[0])), ('corner', np.exp(x[1]))]), dict(kind='low-pass', values=[('frequency', np.exp(x[2]))])]
        here = loop.figures(drawn, lines, noise)
        if here['stable'] and all(here[k] <= v for k, v in limits.items()):
            kept.append([np.log(here[keys[name]]) for name in found['objectives']])
    theirs = np.array(kept).reshape(-1, ours.shape[1])
    # The coarse grid misses up to 0.5 % of a peak, and the decay is not looked at here.
    beaten = dominated(ours, theirs, 5e-3)
    print(f'   random search of {draws} draws here over {bar}: {len(theirs)} keep the limits, {beaten} of {len(ours)} designs are dominated by more than 0.005')
    return wrong + (beaten > 0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('projects', nargs='*', default=[os.path.join(ROOT, 'examples', name) for name in EXAMPLES])
    parser.add_argument('--evaluations', type=int, default=6000)
    parser.add_argument('--times', type=int, default=20)
    parser.add_argument('--draws', type=int, default=20000)
    asked = parser.parse_args()
    wrong = 0
    for project in asked.projects:
        found, seconds = front(project, '--evaluations', str(asked.evaluations))
        evaluations = sum(kind['evaluations'] for kind in found['kinds'])
        print(f'{project}: {evaluations} feedbacks in {seconds:.1f} s, {evaluations / seconds:.0f} a second')
        random, seconds = random_front(project, asked.times * asked.evaluations, 7)
        print(f"   random: {sum(kind['evaluations'] for kind in random['kinds'])} feedbacks in {seconds:.1f} s")
        for kind in found['kinds']:
            ours, theirs = costs_of(found, kind['name']), costs_of(random, kind['name'])
            if len(ours) and len(theirs):
                wrong += compare(kind['name'], ours, theirs)
            else:
                print(f"   {kind['name']:24} {len(ours)} designs, random {len(theirs)}")
                wrong += len(theirs) > 0
        wrong += independent(project, found, asked.draws)
    print('the front holds' if not wrong else f'{wrong} FAILURES')
    sys.exit(1 if wrong else 0)


if __name__ == '__main__':
    main()
