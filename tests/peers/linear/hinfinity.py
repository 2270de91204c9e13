#!/usr/bin/env python3
"""H-infinity synthesis on random plants, compared with SLICOT's sb10ad; every norm is computed again by other programs.

  cargo build --release -p counterpoise-tests --example hard-problems
  python3 tests/peers/linear/hinfinity.py [--first 0] [--count 30] [--show]

Needs numpy, slycot and python-flint. The gain of each controller's loop is computed with 77 digits from plant and controller as they are given, at every
frequency of the search, and so are the poles: near the optimum a controller may have entries of 1e14, and doubles then place peaks wrongly. A claim is too low if the norm that is found exceeds it by more than 1e-6. An answer stops above the
reachable level if it exceeds the best norm of all programs by more than 1e-3, though some controller reaches that with a stable loop."""
import argparse, json, os, subprocess, warnings

import flint
import numpy as np
import slycot

flint.ctx.prec = 256

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
TARGET = os.environ.get('CARGO_TARGET_DIR', os.path.join(ROOT, 'target'))
PROGRAM = os.path.join(TARGET, 'release', 'examples', 'hard-problems')


def plant(A, B1, B2, C1, C2, D11, D12, D21):
    D22 = np.zeros((C2.shape[0], B2.shape[1]))
    return dict(A=A, B=np.hstack([B1, B2]), C=np.vstack([C1, C2]), D=np.block([[D11, D12], [D21, D22]]),
                controls=B2.shape[1], measurements=C2.shape[0])


def benign(r, scale=1.0, direct=False, stable=True):
    n, m1, m2, p1, p2 = r.integers(1, 7), 3, int(r.integers(1, 3)), 3, int(r.integers(1, 3))
    A = r.standard_normal((n, n))
    if stable:
        A -= (np.linalg.eigvals(A).real.max() + 0.3) * np.eye(n)
    g = r.standard_normal
    return plant(A, g((n, m1)), g((n, m2)), g((p1, n)), g((p2, n)), g((p1, m1)) if direct else np.zeros((p1, m1)),
                 np.vstack([np.zeros((p1 - m2, m2)), scale * np.eye(m2)]) if not direct else scale * g((p1, m2)),
                 np.hstack([np.zeros((p2, m1 - p2)), scale * np.eye(p2)]) if not direct else scale * g((p2, m1)))


def flexible(r):
    """A mechanism with light damping, mixed sensitivity: error with an integral-like weight, control with a gain."""
    k = int(r.integers(1, 4))
    w = np.sort(10.0 ** r.uniform(0, 2, k)); w[0] = 0.0 if r.random() < 0.4 else w[0]
    z = 10.0 ** r.uniform(-3, -1)
    n = 2 * k
    A = np.zeros((n + 1, n + 1)); B = np.zeros((n + 1, 1)); C = np.zeros((1, n + 1))
    for i in range(k):
        A[2 * i:2 * i + 2, 2 * i:2 * i + 2] = [[0, 1], [-w[i] ** 2, -2 * z * w[i]]]
        B[2 * i + 1], C[0, 2 * i] = 1.0, 10.0 ** r.uniform(-1, 1)
    A[n, n], A[n, :n] = -1e-3, C[0, :n]  # the error's weight
    B1 = np.hstack([B, np.zeros((n + 1, 1))])
    C1 = np.zeros((2, n + 1)); C1[0, n] = 10.0 ** r.uniform(-1, 1)
    small = 10.0 ** r.uniform(-4, 0)
    return plant(A, B1, B, C1, C, np.zeros((2, 2)), np.array([[0.0], [small]]), np.array([[0.0, 10.0 ** r.uniform(-3, 0)]]))


def graded(r):
    p = benign(r)
    d = 10.0 ** r.uniform(-5, 5, len(p['A']))
    return dict(p, A=p['A'] * d[:, None] / d, B=p['B'] * d[:, None], C=p['C'] / d)


def larger(r):
    """Nine to fifteen states, some of them unstable."""
    n, m2, p2 = int(r.integers(9, 16)), int(r.integers(1, 3)), int(r.integers(1, 3))
    g = r.standard_normal
    A = g((n, n)) - r.choice([0.0, 1.5]) * np.sqrt(n) * np.eye(n)
    return plant(A, g((n, 3)), g((n, m2)), g((3, n)), g((p2, n)), 0.1 * g((3, 3)), np.vstack([np.zeros((3 - m2, m2)), np.eye(m2)]),
                 np.hstack([np.zeros((p2, 3 - p2)), np.eye(p2)]))


def uneven(r):
    """Weights of two controls and of two noises that differ by up to eight decades."""
    p = benign(np.random.default_rng(r.integers(1 << 30)))
    while p['controls'] < 2 or p['measurements'] < 2:
        p = benign(np.random.default_rng(r.integers(1 << 30)))
    D, m2, p2 = p['D'].copy(), p['controls'], p['measurements']
    D[:, -1] *= 10.0 ** r.uniform(-8, 0)
    D[-1, :-m2] *= 10.0 ** r.uniform(-8, 0)
    return dict(p, D=D)


def mechanism(r):
    """A free body with a flexible part, forces of disturbance, weighted rate and control."""
    k = int(r.integers(2, 4))
    m, c = 10.0 ** r.uniform(-1, 1, k), 10.0 ** r.uniform(1, 5, k - 1)
    K = np.zeros((k, k))
    for i in range(k - 1):
        K[i:i + 2, i:i + 2] += c[i] * np.array([[1, -1], [-1, 1]])
    A = np.block([[np.zeros((k, k)), np.eye(k)], [-K / m[:, None], -1e-3 * K / m[:, None]]])
    B2 = np.r_[np.zeros((k, 1)), np.eye(k)[:, [0]] / m[0]]
    B1 = np.c_[np.r_[np.zeros((k, 1)), np.ones((k, 1))], np.zeros((2 * k, 1))]
    C2 = np.c_[np.zeros((1, k)), np.eye(k)[[int(r.integers(0, k))]]] if r.random() < 0.5 else np.c_[np.eye(k)[[0]], np.zeros((1, k))]
    C1 = np.r_[np.c_[np.eye(k)[[k - 1]], np.zeros((1, k))], np.zeros((1, 2 * k))]
    return plant(A, B1, B2, C1, C2, np.zeros((2, 2)), np.array([[0.0], [10.0 ** r.uniform(-3, 0)]]), np.array([[0.0, 10.0 ** r.uniform(-4, -1)]]))


FAMILIES = dict(larger=larger, uneven=uneven, mechanism=mechanism, benign=benign, unstable=lambda r: benign(r, stable=False), direct=lambda r: benign(r, direct=True),
                small_weight=lambda r: benign(r, scale=10.0 ** r.uniform(-12, -3)), flexible=flexible, graded=graded)


def ours(problems):
    text = ''.join(json.dumps({k: v.tolist() if isinstance(v, np.ndarray) else v for k, v in dict(p, kind='hinfsyn').items()}) + '\n' for p in problems)
    done = subprocess.run([PROGRAM], input=text, capture_output=True, text=True, check=True)
    return [json.loads(line) for line in done.stdout.splitlines()]


def slicot(p):
    """The controller of sb10ad, searched in two of its ways, or None."""
    n, m, q = len(p['A']), p['B'].shape[1], len(p['C'])
    best = None
    for start in (1e3, 1e6, 1e-1):
        for job in (1, 3):
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter('ignore')
                    out = slycot.sb10ad(n, m, q, p['controls'], p['measurements'], start, p['A'], p['B'], p['C'], p['D'], job=job, gtol=1e-9)
            except Exception:
                continue
            K = out[1:5] if len(out[1:5]) == 4 else None
            value = norm(p, K) if K else None
            if value is not None and (best is None or value < best):
                best = value
    return best


def gain(p, K, w):
    """The largest singular value of P11 + P12 K (I - P22 K)^-1 P21 at a frequency, with 77 digits; zero at a pole of plant or
    controller, which the frequencies beside it cover."""
    def response(A, B, C, D):
        shifted = long([[w * 1j if i == j else 0 for j in range(len(A))] for i in range(len(A))]) - long(A)
        return long(C) * shifted.solve(long(B)) + long(D)
    try:
        P, K = response(*(p[k] for k in 'ABCD')), response(*K)
        z, q = P.nrows() - p['measurements'], P.ncols() - p['controls']
        part = lambda rows, cols: flint.acb_mat([[P[i, j] for j in cols] for i in rows])
        up, down, left, right = range(z), range(z, P.nrows()), range(q), range(q, P.ncols())
        inner = long(np.eye(p['measurements'])) - part(down, right) * K
        H = part(up, left) + part(up, right) * (K * inner.solve(part(down, left)))
    except ZeroDivisionError:
        return 0.0
    return np.linalg.svd([[complex(H[i, j]) for j in range(q)] for i in range(z)], compute_uv=False)[0]


def long(M):
    return flint.acb_mat([[flint.acb(float(np.real(e)), float(np.imag(e))) for e in row] for row in np.atleast_2d(M)])


def poles(p, K):
    """The poles of the loop, assembled with 77 digits (P22 has no direct path)."""
    Ak, Bk, Ck, Dk = map(long, K)
    A, B2, C2 = long(p['A']), long(p['B'][:, -p['controls']:]), long(p['C'][-p['measurements']:])
    blocks = [[A + B2 * Dk * C2, B2 * Ck], [Bk * C2, Ak]]
    rows = [[e for block in row for e in block.tolist()[i]] for row in blocks for i in range(row[0].nrows())]
    return np.array([complex(e) for e in flint.acb_mat(rows).eig(algorithm='approx')])


def norm(p, K):
    """The peak of the largest singular value; None for a loop that is not stable."""
    K = [np.atleast_2d(M) for M in K]
    if not all(np.isfinite(M).all() for M in K):
        return None
    roots = poles(p, K)
    if roots.real.max() >= 0:
        return None
    sizes = np.r_[np.abs(roots), np.abs(roots.imag)]
    rates = np.unique(np.r_[0, sizes, np.logspace(np.log10(np.abs(roots).min() + 1e-12) - 2, np.log10(sizes.max()) + 2, 400)])
    values = lambda rates: np.array([gain(p, K, w) for w in rates])
    found = values(rates)
    best = found.max()
    for k in np.argsort(found)[-2:]:
        low, high = rates[max(k - 1, 0)], rates[min(k + 1, len(rates) - 1)]
        for _ in range(8):
            inner = np.linspace(low, high, 9)
            at = int(np.argmax(values(inner)))
            low, high = inner[max(at - 1, 0)], inner[min(at + 1, 8)]
        best = max(best, values(inner).max())
    return best


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument('--first', type=int, default=0); p.add_argument('--count', type=int, default=30)
    p.add_argument('--families', default=','.join(FAMILIES)); p.add_argument('--show', action='store_true')
    a = p.parse_args()
    print('| family | plants | claims too low | above the reachable level | refused though SLICOT solves it | refused by both | SLICOT above our level | milliseconds |')
    print('|---|---|---|---|---|---|---|---|')
    for family in a.families.split(','):
        problems = [FAMILIES[family](np.random.default_rng([seed, sum(map(ord, family))])) for seed in range(a.first, a.first + a.count)]
        low = above = refused = both = theirs = 0
        seconds = []
        for seed, (problem, answer) in enumerate(zip(problems, ours(problems)), a.first):
            best = slicot(problem)
            seconds.append(answer.get('seconds', 0))
            say = lambda what: a.show and print(family, seed, what, answer.get('value'), answer.get('bound'), answer.get('unreachable'), 'slicot', best, answer.get('refused'), answer.get('failed'), flush=True)
            if 'value' not in answer:
                refused += best is not None; both += best is None
                say('refused')
                continue
            real = norm(problem, [answer[k] for k in 'ABCD'])
            if real is None or real > answer['value'] * (1 + 1e-6):
                low += 1; say(f'too low: {real}')
            elif best is not None and answer['value'] > best * (1 + 1e-3):
                above += 1; say('above')
            theirs += best is None or best > answer['value'] * (1 + 1e-3)
        print(f'| {family} | {len(problems)} | {low} | {above} | {refused} | {both} | {theirs} | {1e3 * np.median(seconds):.1f} |', flush=True)


if __name__ == '__main__':
    main()
