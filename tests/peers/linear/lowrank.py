#!/usr/bin/env python3
"""Balanced truncation of structures with sparse matrices, from low-rank Gramians, beside dense ones.

  cargo build --release -p counterpoise-tests --example hard-problems
  python3 tests/peers/linear/lowrank.py [--first 0] [--count 12] [--large 6000,30000]

Small structures (chains with cross links; proportional damping, dashpots, dashpots so strong that masses creep; masses and stiffnesses that
spread over decades) are balanced by SciPy too, with the Gramians of its dense Lyapunov solver. Of large ones (lattices in space, as `large.py` makes them) the
error of the reduced system is measured at frequencies by both programs; SciPy solves with the whole matrices there. Needs numpy and scipy."""
import argparse, json, os, subprocess, sys

import numpy as np
import scipy.linalg as sl
import scipy.sparse as sp
import scipy.sparse.linalg as spl

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
sys.path.insert(0, HERE)
import large  # noqa: E402

PROGRAM = os.path.join(os.environ.get('CARGO_TARGET_DIR', os.path.join(ROOT, 'target')), 'release', 'examples', 'hard-problems')
FAMILIES = ('proportional', 'dashpots', 'creeping', 'spread', 'light')


def chain(family, seed):
    r = np.random.default_rng(seed)
    n = int(r.integers(15, 90))
    spread = 3 if family == 'spread' else 0.3
    masses = 10 ** r.uniform(-spread / 2, spread / 2, n)
    K = np.zeros((n, n))
    def spring(i, j, k):
        K[i, i] += k
        if j is not None:
            K[j, j] += k; K[i, j] -= k; K[j, i] -= k
    spring(0, None, 1e3)
    for i in range(1, n):
        spring(i, i - 1, 1e3 * 10 ** r.uniform(-spread / 2, spread / 2))
        if i > 6 and r.random() < 0.3:
            spring(i, int(r.integers(0, i - 1)), 100 * r.random())
    M = np.diag(masses)
    D = {'proportional': 0.02 * M + 2e-4 * K, 'light': 1e-3 * M + 1e-6 * K}.get(family, 1e-4 * K + 1e-3 * M)
    if family in ('dashpots', 'creeping', 'spread'):
        for i in r.choice(n, max(2, n // 8), replace=False):
            D[i, i] += {'dashpots': 0.5, 'creeping': 500.0, 'spread': 2.0}[family] * r.random()
    m, p = int(r.integers(1, 4)), int(r.integers(1, 4))
    F, P, V = np.zeros((n, m)), np.zeros((p, n)), np.zeros((p, n))
    for j in range(m):
        F[r.integers(0, n), j] = 1
    for i in range(p):
        (P if r.random() < 0.7 else V)[i, r.integers(0, n)] = 1
    return M, D, K, F, P, V


def sparse(A):
    A = sp.coo_matrix(A)
    return [A.row.tolist(), A.col.tolist(), A.data.tolist()]


def ours(problems):
    text = ''.join(json.dumps(p) + '\n' for p in problems)
    done = subprocess.run([PROGRAM], input=text, capture_output=True, text=True, check=True)
    return [json.loads(line) for line in done.stdout.splitlines()]


def problem(M, D, K, F, P, V, order, rates):
    return dict(kind='balred_large', M=sparse(M), D=sparse(D), K=sparse(K), F=F.tolist(), P=P.tolist(), V=V.tolist(), order=order, rates=list(rates))


def modal_hankel(M, D, K, F, P, V):
    """The Hankel values by dense Gramians, in coordinates in which the undamped structure is diagonal."""
    w2, X = sl.eigh(K, M)
    w = np.sqrt(w2)
    n = len(w)
    A = np.block([[np.zeros((n, n)), np.diag(w)], [-np.diag(w), -X.T @ D @ X]])
    B, C = np.vstack([np.zeros((n, F.shape[1])), X.T @ F]), np.hstack([P @ X / w, V @ X])
    Wc, Wo = sl.solve_continuous_lyapunov(A, -B @ B.T), sl.solve_continuous_lyapunov(A.T, -C.T @ C)
    root = lambda W: (lambda e, U: U * np.sqrt(np.maximum(e, 0)))(*sl.eigh((W + W.T) / 2))
    return np.sort(sl.svdvals(root(Wo).T @ root(Wc)))[::-1]


def small(first, count):
    print('| family | structures | refused | largest difference of a Hankel value, over the first | largest difference of the first ten, relative | most factorisations | unfinished |')
    print('|---|---|---|---|---|---|---|')
    for number, family in enumerate(FAMILIES):
        cases = [chain(family, 1000 * number + seed) for seed in range(first, first + count)]
        answers = ours([problem(*case, order=6, rates=[]) for case in cases])
        refused, apart, relative, steps, unfinished = 0, 0.0, 0.0, 0, 0
        for case, answer in zip(cases, answers):
            if 'hankel' not in answer:
                refused += 1
                print(family, answer, file=sys.stderr)
                continue
            exact = modal_hankel(*case)
            k = min(len(exact), len(answer['hankel']))
            got = np.array(answer['hankel'][:k])
            missing = exact[k] if len(exact) > k else 0.0
            apart = max(apart, np.abs(got - exact[:k]).max() / exact[0], missing / exact[0])
            ten = exact[:10] > 1e-6 * exact[0]
            relative = max(relative, np.abs(got[:10][ten[:len(got[:10])]] / exact[:10][ten] - 1).max())
            steps, unfinished = max(steps, answer['steps']), unfinished + any('balancing still' in w for w in answer['warnings'])
        print(f'| {family} | {count} | {refused} | {apart:.1e} | {relative:.1e} | {steps} | {unfinished} |', flush=True)


def big(sizes):
    print('\n| unknowns | order | factorisations | s | first Hankel value | estimated bound | largest error at 25 frequencies | gains by SciPy at three frequencies |')
    print('|---|---|---|---|---|---|---|---|')
    for size in sizes:
        M, K, x, z, components, pivot, tip = large.girder('space', size)
        held = [pivot * 6 + c for c in range(6)]
        free = np.setdiff1d(np.arange(K.shape[0]), held)
        M, K = M[free][:, free], K[free][:, free]
        D = 0.5 * M + 2e-5 * K
        place = {int(row): k for k, row in enumerate(free)}
        F = np.zeros((len(free), 2)); F[place[tip * 6 + 2], 0] = 1; F[place[6 * 3 + 1], 1] = 1
        P, V = F.T.copy(), np.zeros((2, len(free)))
        rates = np.geomspace(0.3, 600, 25)
        order = 30
        answer = ours([problem(M, D, K, F, P, V, order, rates)])[0]
        if 'hankel' not in answer:
            print(f'| {len(free)} | {answer} |')
            continue
        # SciPy: the gain of the structure itself at three of the frequencies, to judge what `error_at` says of its size.
        gains = [np.linalg.norm(P @ spl.splu((-w * w * M + 1j * w * D + K).tocsc(), permc_spec='MMD_AT_PLUS_A').solve(F.astype(complex)), 2) for w in rates[::12]] if len(free) < 40000 else [float('nan')]
        print(f"| {len(free)} | {order} | {answer['steps']} | {answer['seconds']:.0f} | {answer['hankel'][0]:.2e} | {answer['bound']:.2e} | {max(answer['errors']):.2e} | gains {' '.join(f'{g:.2e}' for g in gains)} |", flush=True)


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument('--first', type=int, default=0); p.add_argument('--count', type=int, default=12); p.add_argument('--large', default='')
    a = p.parse_args()
    small(a.first, a.count)
    if a.large:
        big([int(s) for s in a.large.split(',')])


if __name__ == '__main__':
    main()
