#!/usr/bin/env python3
"""Widely drawn problems for every routine of the numerical core, with references of 1000 bits or exact fractions: see WIDE.md.

  cargo build --release -p counterpoise-tests --example hard-problems
  python3 tests/peers/linear/wide.py [--kinds care,zeros,...] [--families NAME,...] [--count 20] [--first 0] [--show] [--out FILE]

Needs what hard.py needs. The judge is that of hard.py; the families are those of wide_families.py."""
import argparse

import hard
import wide_families
import wide_references
from hard_families import rng

FLOOR = dict(delayed=1e-8, mzeros=1e-10, bounds=1e-9, mh2=1e-10, c2d=1e-10, c2d_delayed=1e-10, balred=1e-9, minimal=0.5, multiloop=1e-8)


def problems(families, kind, seed, only):
    for family, make in families[kind].items():
        if only and family not in only:
            continue
        problem = make(rng(kind, family, seed))
        problem = {k: v.tolist() if hasattr(v, 'tolist') else v for k, v in problem.items()}
        yield dict(problem, kind=problem.get('kind', kind), family=family, seed=seed)


def run(families, kind, first, count, only):
    made = [p for seed in range(first, first + count) for p in problems(families, kind, seed, only)]
    for problem, answer in zip(made, hard.ours(made)):
        try:
            reference = wide_references.reference(kind, problem)
        except ZeroDivisionError:
            reference = dict(exists=None)
        theirs = {name: hard.attempt(solver) for name, solver in wide_references.peers(kind, problem)}
        yield dict(hard.judge(problem['kind'], problem, answer, reference, theirs, wide_references.error), kind=kind)


def main(families=wide_families.FAMILIES, description=__doc__):
    p = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument('--kinds', default=','.join(families)); p.add_argument('--families', default='')
    p.add_argument('--count', type=int, default=20); p.add_argument('--first', type=int, default=0)
    p.add_argument('--show', action='store_true'); p.add_argument('--out')
    a = p.parse_args()
    hard.FLOOR.update(FLOOR)
    records = []
    for kind in a.kinds.split(','):
        for record in run(families, kind, a.first, a.count, a.families.split(',') if a.families else None):
            records.append(record)
            if a.show and record['verdict'] not in ('ok', 'no reference'):
                print(record, flush=True)
    text = hard.table(records)
    print(text)
    if a.out:
        with open(a.out, 'w') as file:
            file.write(text + '\n')


if __name__ == '__main__':
    main()
