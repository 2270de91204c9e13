#!/usr/bin/env python3
"""Hard problems with references of 300 digits or more: Counterpoise beside SciPy and SLICOT.

  cargo build --release -p counterpoise-tests --example hard-problems
  python3 tests/peers/linear/hard.py [--kinds care,dare,lyap,...] [--count 40] [--first 0] [--out FILE]

Needs numpy, scipy, mpmath and python-flint; slycot if it is there. Each kind has families of problems made from a seed: benign
ones, graded ones whose states' units spread over twelve decades, powers of ten, nearly singular, defective, and rigid-body ones.
HARD.md lists the seeds that have been looked at. The judge is the same for all: the error of each entry of
the solution, relative to the root of the two diagonal entries that belong to it (matrices), or relative to the exact value
(numbers). An answer is wrong if its error exceeds ten times the condition number times the rounding error, at least 1e-12 (1e-10 for systems, as no norm is asked for more closely); a
refusal counts if a peer's error is below 1e-6."""
import argparse, json, os, subprocess, sys, warnings

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
sys.path.insert(0, HERE)
import hard_families, hard_references  # noqa: E402

TARGET = os.environ.get('CARGO_TARGET_DIR', os.path.join(ROOT, 'target'))
PROGRAM = os.path.join(TARGET, 'release', 'examples', 'hard-problems')
EPS = np.finfo(float).eps
FLOOR = dict.fromkeys(('zeros', 'margins', 'linfnorm', 'h2norm', 'descriptor'), 1e-10)  # an answer in doubles is not judged below this


def ours(problems):
    """The answers of Counterpoise, in order."""
    text = ''.join(json.dumps(p) + '\n' for p in problems)
    done = subprocess.run([PROGRAM], input=text, capture_output=True, text=True, check=True)
    return [json.loads(line) for line in done.stdout.splitlines()]


def attempt(run):
    """What a peer answers, or None if it refuses."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter('ignore')
            return run()
    except Exception:
        return None


def judge(kind, problem, answer, reference, peers, error_of=hard_references.error):
    """One line of the record."""
    error = error_of(kind, answer, reference, problem)
    theirs = {name: error_of(kind, got, reference, problem) for name, got in peers.items() if got is not None}
    best = min((e for e in theirs.values() if np.isfinite(e)), default=np.inf)
    condition = reference.get('condition') or answer.get('condition') or 1.0
    if reference['exists'] is None and not answer.get('panicked'):
        verdict = 'no reference'
    elif answer.get('panicked'):
        verdict = 'PANIC'
    elif 'refused' in answer or 'failed' in answer:
        verdict = 'ok' if not reference['exists'] else 'REFUSED' if best < 1e-6 else 'refused'
    elif not reference['exists']:
        verdict = 'ACCEPTED'
    elif not error < max(10 * condition * EPS, FLOOR.get(kind, 1e-12)):
        verdict = 'WRONG'
    else:
        verdict = 'ok'
    return dict(kind=kind, family=problem['family'], seed=problem['seed'], verdict=verdict, error=error, best=best,
                condition=condition, seconds=answer.get('seconds'), why=answer.get('refused') or answer.get('failed'))


def run(kind, first, count):
    problems = [p for seed in range(first, first + count) for p in hard_families.problems(kind, seed)]
    answers = ours(problems)
    for problem, answer in zip(problems, answers):
        reference = hard_references.reference(kind, problem)
        peers = {name: attempt(solver) for name, solver in hard_references.peers(kind, problem)}
        yield judge(kind, problem, answer, reference, peers)


def table(records):
    """Counts and largest errors by family."""
    lines = ['| kind | family | problems | without reference | wrong | refused though a peer solves it | refused | accepted without a solution | panics | largest error | largest of the best peer |',
             '|---|---|---|---|---|---|---|---|---|---|---|']
    for key in sorted({(r['kind'], r['family']) for r in records}):
        mine = [r for r in records if (r['kind'], r['family']) == key]
        count = lambda verdict: sum(r['verdict'] == verdict for r in mine)
        largest = lambda name: max((r[name] for r in mine if np.isfinite(r[name])), default=float('nan'))
        cells = [*key, len(mine), count('no reference'), count('WRONG'), count('REFUSED'), count('refused'), count('ACCEPTED'), count('PANIC')]
        lines.append('| ' + ' | '.join(map(str, cells)) + f" | {largest('error'):.1e} | {largest('best'):.1e} |")
    return '\n'.join(lines)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument('--kinds', default=','.join(hard_families.KINDS)); p.add_argument('--count', type=int, default=20)
    p.add_argument('--first', type=int, default=0); p.add_argument('--out'); p.add_argument('--show', action='store_true')
    a = p.parse_args()
    records = []
    for kind in a.kinds.split(','):
        for record in run(kind, a.first, a.count):
            records.append(record)
            if a.show and record['verdict'] not in ('ok', 'no reference'):
                print({k: v for k, v in record.items()}, flush=True)
    text = table(records)
    print(text)
    if a.out:
        with open(a.out, 'w') as file:
            file.write(text + '\n')


if __name__ == '__main__':
    main()
