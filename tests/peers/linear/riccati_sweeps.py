#!/usr/bin/env python3
"""The parametric examples of CAREX and DAREX over the decades of their parameters and over their sizes, with references of 1000 bits: see RICCATI.md.

  cargo build --release -p counterpoise-tests --example hard-problems
  python3 tests/peers/linear/riccati_sweeps.py --slicot SLICOT-Reference [--examples carex_2.5,darex_2.2] [--show] [--out FILE]

The examples come from the collections' generators (see riccati.py), the judge is that of hard.py, and it needs what both need. An example without a
stabilising solution, or with a weight that rounding has made singular, has no reference: there only a panic counts."""
import argparse, os

import hard
import riccati

LARGEST = 40  # states; references of larger ones take minutes


def decades(low, high, step=1):
    """Powers of ten, and factors between them that are no whole decade."""
    return [share * 10.0 ** k for k in range(low, high + 1, step) for share in (1.0, 3.7)]


def chains():
    """Example 4.1: sizes, and weights of both ends over the decades."""
    yield from (dict(size=n, reals=(1.0, 1.0)) for n in (1, 2, 5, 10, 15, 21, 30))
    yield from (dict(size=n, reals=(q, r)) for n in (5, 12) for q in decades(-12, 12, 4) for r in decades(-12, 12, 4))


def heat_flows():
    """Example 4.2: conductivity, and the places of input and output."""
    places = ((0.2, 0.3, 0.2, 0.3), (0.0, 1.0, 0.0, 1.0), (0.1, 0.2, 0.8, 0.9), (0.01, 0.02, 0.9, 1.0))
    yield from (dict(size=n, reals=(a, 1.0, 1.0, *place)) for n in (5, 20) for a in (1e-6, 1e-4, 0.01, 1.0, 100.0) for place in places)
    yield from (dict(size=12, reals=(0.01, b, c, *places[0])) for b in (1e-8, 1e-4, 1e4, 1e8) for c in (1e-8, 1e-4, 1.0, 1e4, 1e8))


def masses():
    """Example 4.3: mass, damping and stiffness."""
    yield from (dict(size=n, reals=(4.0, 4.0, 1.0)) for n in (2, 5, 12, 20))
    yield from (dict(size=5, reals=(m, d, k)) for m in (1e-4, 1.0, 1e4) for d in (1e-8, 1e-4, 1.0, 1e4) for k in (1e-6, 1.0, 1e6, 1e12))


def lags():
    """Example 2.5 of DAREX: time constant, delay, gain and weight."""
    yield from (dict(reals=(tau, 1.0, 1.0, 0.25)) for tau in decades(-3, 12))
    yield from (dict(reals=(tau, d, k, r)) for tau in (1.0, 1e4, 1e8) for d in (1e-3, 1.0, 1e3) for k in (1e-4, 1.0, 1e4) for r in (1e-12, 1e-6, 0.25, 1e6))


def one(low, high):
    return [dict(reals=(value,)) for value in decades(low, high)]


SWEEPS = {
    'carex_2.1': one(-12, 8), 'carex_2.2': one(-16, 8), 'carex_2.3': one(-12, 14), 'carex_2.4': one(-14, 8), 'carex_2.5': one(-14, 4),
    'carex_2.6': one(-10, 10), 'carex_2.7': one(-12, 4), 'carex_2.8': one(-12, 4),
    'carex_3.1': [dict(size=n) for n in (1, 2, 5, 12, 20)], 'carex_3.2': [dict(size=n) for n in (3, 8, 20, 40)],
    'carex_4.1': list(chains()), 'carex_4.2': list(heat_flows()), 'carex_4.3': list(masses()),
    'darex_2.1': one(-18, 12), 'darex_2.2': one(-12, 12), 'darex_2.3': one(-10, 12), 'darex_2.4': one(-12, 12), 'darex_2.5': list(lags()),
    'darex_4.1': [dict(size=n, reals=(r,)) for n in (1, 2, 10, 40) for r in (1e-12, 1e-6, 1.0, 1e6, 1e12)],
}


def problems(library, slicot, name):
    kind, number = name.split('_')
    group, member = map(int, number.split('.'))
    for k, parameters in enumerate(SWEEPS[name]):
        E, _ = riccati.example(library, slicot, kind, group, member, **parameters)
        if len(E['A']) > LARGEST:
            continue
        given = {key: value.tolist() for key, value in E.items() if key != 'S' or value.any()}
        yield dict(given, kind='care' if kind == 'carex' else 'dare', family=name, seed=k, parameters=parameters)


def reference(problem):
    """The solution in 1000 bits; `exists` is None if there is no gain because the weight is singular."""
    R = hard.hard_references.long(problem['R'])
    if problem['kind'] == 'care' and hard.hard_references.solve(R, R) is None:
        return dict(exists=None)
    return hard.hard_references.reference(problem['kind'], problem)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument('--slicot', required=True, help="folder with SLICOT's src and benchmark_data")
    p.add_argument('--work', default=os.path.join(riccati.ROOT, 'out', 'peers', 'riccati'))
    p.add_argument('--examples', default=','.join(SWEEPS)); p.add_argument('--show', action='store_true'); p.add_argument('--out')
    a = p.parse_args()
    work, slicot = os.path.abspath(a.work), os.path.abspath(a.slicot)
    os.makedirs(work, exist_ok=True)
    library, records = riccati.generator(slicot, work), []
    for name in a.examples.split(','):
        made = list(problems(library, slicot, name))
        for problem, answer in zip(made, hard.ours(made)):
            found = reference(problem)
            theirs = {peer: hard.attempt(solver) for peer, solver in hard.hard_references.peers(problem['kind'], problem)}
            record = hard.judge(problem['kind'], problem, answer, found, theirs)
            records.append(record)
            if a.show and record['verdict'] != 'ok':
                print({**record, 'parameters': problem['parameters']}, flush=True)
    text = hard.table(records)
    print(text)
    if a.out:
        with open(a.out, 'w') as file:
            file.write(text + '\n')


if __name__ == '__main__':
    main()
