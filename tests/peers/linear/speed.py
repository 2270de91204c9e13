#!/usr/bin/env python3
"""Processor time of Counterpoise beside the fastest peer on problems that TABLE.md lacks: see SPEED.md.

  cargo build --release -p counterpoise-tests --example hard-problems
  python3 tests/peers/linear/speed.py [--kinds care,dare,...] [--sizes 20,50,100,200] [--seconds 0.5] [--rounds 3] [--out FILE]

Needs numpy, scipy and slycot. One thread each. In each of several rounds each program solves the problem for some time, Counterpoise and peers in
turn; the figure is the shortest time of all, that of the processor, below a millisecond that of the clock (which the processor's time is too coarse for). The error of a Riccati equation is that of the entries over the roots of the diagonal, against the solution of
hard_references (to 100 states); that of a norm is how far it lies below the largest value that any program found."""
import argparse, os, sys, time

os.environ.setdefault('OPENBLAS_NUM_THREADS', '1'); os.environ.setdefault('OMP_NUM_THREADS', '1')
import numpy as np
import scipy.linalg as sla
import slycot

import hard


def shortest(run, seconds):
    """The shortest time, s, of the runs within some time, four at least, and the answer; None if it refuses."""
    best, answer, runs, begun = np.inf, None, 0, time.perf_counter()
    while runs < 4 or time.perf_counter() - begun < seconds:
        clock, processor = time.perf_counter(), time.process_time()
        answer = hard.attempt(run)
        processor, clock = time.process_time() - processor, time.perf_counter() - clock
        best, runs = min(best, clock if clock < 1e-3 else processor), runs + 1
        if best > 5:
            break
    return best, answer


# --- problems ---------------------------------------------------------------------------------------------------------------

def riccati(r, n, inputs, scale=1.0):
    C = r.standard_normal((max(1, n // 3), n))
    return dict(A=r.standard_normal((n, n)) * scale, B=r.standard_normal((n, inputs)), Q=C.T @ C, R=np.eye(inputs))


def graded(r, n):
    p, d = riccati(r, n, max(1, n // 3)), 10.0 ** r.uniform(-6, 6, n)
    return dict(p, A=p['A'] * d[:, None] / d, B=p['B'] * d[:, None], Q=p['Q'] / np.outer(d, d))


def out_of_reach(r, n, scale=1.0):
    """An unstable mode that no input reaches, in rotated coordinates."""
    p = riccati(r, n, max(1, n // 3), scale)
    A, B = p['A'], p['B']
    A[0], A[:, 0], B[0] = 0, 0, 0
    A[0, 0] = 1.5
    U = sla.qr(r.standard_normal((n, n)))[0]
    return dict(p, A=U @ A @ U.T, B=U @ B)


def system(r, n, period=None):
    A = r.standard_normal((n, n)) / np.sqrt(n)
    A = A - (np.linalg.eigvals(A).real.max() + 0.1) * np.eye(n)
    if period:
        A = sla.expm(A * 0.5)
    p = dict(A=A, B=r.standard_normal((n, 2)), C=r.standard_normal((2, n)), D=np.zeros((2, 2)))
    return dict(p, period=period) if period else p


def flexible(r, n):
    k = n // 2
    w = np.sort(10.0 ** r.uniform(0, 3, k))
    A = np.block([[np.zeros((k, k)), np.eye(k)], [-np.diag(w ** 2), -2 * 0.005 * np.diag(w)]])
    g = r.standard_normal
    return dict(A=A, B=np.r_[np.zeros((k, 2)), g((k, 2))], C=np.c_[g((2, k)), np.zeros((2, k))], D=np.zeros((2, 2)))


def lyapunov(r, n, discrete=False):
    p = system(r, n, 1.0 if discrete else None)
    C = r.standard_normal((n, n))
    return dict(A=p['A'], Q=C @ C.T)


PROBLEMS = {
    ('care', 'benign'): lambda r, n: riccati(r, n, max(1, n // 3)),
    ('care', 'half unstable, two inputs'): lambda r, n: riccati(r, n, 2),
    ('care', 'half unstable, n/10 inputs'): lambda r, n: riccati(r, n, max(2, n // 10)),
    ('care', 'units over twelve decades'): graded,
    ('care', 'out of reach'): out_of_reach,
    ('dare', 'benign'): lambda r, n: riccati(r, n, max(1, n // 3), 1.2 / np.sqrt(n)),
    ('dare', 'two inputs, a third unstable'): lambda r, n: riccati(r, n, 2, 1.2 / np.sqrt(n)),
    ('dare', 'out of reach'): lambda r, n: out_of_reach(r, n, 0.8 / np.sqrt(n)),
    ('linfnorm', 'dense'): system,
    ('linfnorm', 'flexible'): flexible,
    ('linfnorm', 'sampled'): lambda r, n: system(r, n, 1.0),
    ('zeros', 'dense'): system,
    ('zeros', 'flexible'): flexible,
    ('h2norm', 'dense'): system,
    ('h2norm', 'flexible'): flexible,
    ('lyap', 'dense'): lyapunov,
    ('dlyap', 'dense'): lambda r, n: lyapunov(r, n, True),
}


# --- peers ------------------------------------------------------------------------------------------------------------------

def peers(kind, p):
    get = {k: np.array(v) for k, v in p.items() if isinstance(v, np.ndarray)}
    A = get['A']
    n = len(A)
    if kind in ('care', 'dare'):
        B, Q, R = get['B'], get['Q'], get['R']
        G, letter = B @ np.linalg.solve(R, B.T), 'C' if kind == 'care' else 'D'
        solver = sla.solve_continuous_are if kind == 'care' else sla.solve_discrete_are
        yield 'scipy', lambda: solver(A, B, Q, R)
        yield 'sb02md', lambda: slycot.sb02md(n, A, G, Q, letter, sort='S' if kind == 'care' else 'U')[0]
        yield 'sb02od', lambda: slycot.sb02od(n, B.shape[1], A, B, Q, R, letter)[0]
        return
    if kind in ('lyap', 'dlyap'):
        letter = 'C' if kind == 'lyap' else 'D'
        yield 'scipy', lambda: sla.solve_continuous_lyapunov(A, -get['Q']) if kind == 'lyap' else sla.solve_discrete_lyapunov(A, get['Q'])
        yield 'sb03md57', lambda: slycot.sb03md57(A.copy(), C=-get['Q'], dico=letter, trana='T')[2]
        return
    B, C, D = get['B'], get['C'], get['D']
    m, q = B.shape[1], len(C)
    letter = 'D' if 'period' in p else 'C'
    if kind == 'linfnorm':
        yield 'ab13dd', lambda: slycot.ab13dd(letter, 'I', 'S', 'D', n, m, q, A.copy(), np.eye(n), B.copy(), C.copy(), D.copy(), 1e-10)[0]
    elif kind == 'h2norm':
        yield 'ab13bd', lambda: slycot.ab13bd(letter, 'H', n, m, q, A.copy(), B.copy(), C.copy(), D.copy())
    elif kind == 'zeros':
        yield 'ab08nd', lambda: pencil_zeros(n, m, q, A, B, C, D)


def pencil_zeros(n, m, q, A, B, C, D):
    out = slycot.ab08nd(n, m, q, A.copy(), B.copy(), C.copy(), D.copy(), equil='S')
    nu = out[0]
    return sla.eig(out[8][:nu, :nu], out[9][:nu, :nu], right=False)


def ours(kind, p, seconds):
    problem = {k: v.tolist() if isinstance(v, np.ndarray) else v for k, v in p.items()}
    answer, = hard.ours([dict(problem, kind=kind, repeat_s=seconds)])
    return answer['seconds'], answer


# --- judgement ----------------------------------------------------------------------------------------------------------------

def scaled_error(X, exact):
    d = np.sqrt(np.maximum(np.abs(np.diag(exact)), 1e-300))
    return float(np.max(np.abs((X + X.T) / 2 - exact) / np.outer(d, d)))


def errors(kind, p, answer, theirs, exact_to):
    """The error of ours and of each peer; None if unknown."""
    if kind in ('care', 'dare') and len(p['A']) <= exact_to:
        import hard_references
        ref = hard_references.reference(kind, dict({k: v.tolist() for k, v in p.items()}, kind=kind))
        if not ref['exists']:
            return None, {}
        of = lambda X: scaled_error(np.array(X, float), ref['X']) if X is not None and np.isfinite(X).all() else None
        return of(answer.get('X')), {name: of(X) for name, X in theirs.items()}
    if kind == 'linfnorm':
        values = {name: v for name, v in theirs.items() if v is not None}
        best = max([*values.values(), answer.get('value') or 0])
        return 1 - answer.get('value', 0) / best, {name: 1 - v / best for name, v in values.items()}
    return None, {}


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument('--kinds', default=''); a.add_argument('--sizes', default='20,50,100,200')
    a.add_argument('--seconds', type=float, default=0.5)
    a.add_argument('--rounds', type=int, default=3); a.add_argument('--exact', type=int, default=0); a.add_argument('--out')
    a = a.parse_args()
    lines = ['| problem | family | n | Counterpoise | fastest peer | other peers | time ratio |', '|---|---|---|---|---|---|---|']
    print('\n'.join(lines), flush=True)
    say = lambda e: '' if e is None else f', error {e:.0e}'
    for (kind, family), make in PROBLEMS.items():
        if a.kinds and kind not in a.kinds.split(','):
            continue
        for n in map(int, a.sizes.split(',')):
            p = make(np.random.default_rng([n, sum(map(ord, family))]), n)
            seconds, timed = np.inf, {}
            for _ in range(a.rounds):
                own_time, answer = ours(kind, p, a.seconds)
                seconds = min(seconds, own_time)
                for name, run in peers(kind, p):
                    found = shortest(run, a.seconds)
                    timed[name] = (min(found[0], timed.get(name, found)[0]), found[1])
            own, others = errors(kind, p, answer, {k: v[1] for k, v in timed.items()}, a.exact)
            why = answer.get('refused') or answer.get('failed')
            state = lambda name: 'refused' if timed[name][1] is None else ''
            order = sorted(timed, key=lambda name: timed[name][0])
            cells = [f'{1e3 * timed[k][0]:.3g} ms ({k}{" " + state(k) if state(k) else ""}{say(others.get(k))})' for k in order]
            lines.append(f"| {kind} | {family} | {n} | {1e3 * seconds:.3g} ms{', refused' if why else ''}{say(own)} | {cells[0]} | "
                         f"{'; '.join(cells[1:])} | {timed[order[0]][0] / seconds:.2g} |")
            print(lines[-1], flush=True)
    if a.out:
        with open(a.out, 'w') as file:
            file.write('\n'.join(lines) + '\n')


if __name__ == '__main__':
    main()
