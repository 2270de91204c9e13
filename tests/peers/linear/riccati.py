#!/usr/bin/env python3
"""Every example of CAREX and DAREX: the residual that Counterpoise leaves beside the ones of SLICOT and SciPy.

  cargo build --release -p counterpoise-tests --example counterpoise-peers
  python3 tests/peers/linear/riccati.py --slicot SLICOT-Reference [--out FILE]

The examples come from the collections' own generators, BB01AD and BB02AD (default parameters), which are compiled here from
SLICOT's sources; they lie, with their data, in slycot's source distribution: `pip download --no-binary slycot --no-deps
slycot`. Needs gfortran, numpy, scipy and slycot. One judge for all: the residual of the returned X in long double, over the
sum of the norms of its terms. Then the discrete equation's times on random systems."""
import argparse, ctypes, glob, json, os, subprocess, time, warnings

import numpy as np
import scipy.linalg as sla

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
PROGRAM = os.path.join(ROOT, 'target', 'release', 'examples', 'counterpoise-peers')
EXAMPLES = {'carex': [6, 9, 2, 4], 'darex': [13, 5, 0, 1]}
LARGEST = 430
LONG = np.longdouble


def generator(slicot, work):
    """The two generators as a library."""
    out = os.path.join(work, 'generators.so')
    if not os.path.exists(out):
        sources = [os.path.join(slicot, 'src', name + '.f') for name in ('BB01AD', 'BB02AD', 'MA02DD', 'MA02ED')]
        libraries = [sorted(glob.glob(f'/usr/lib/*/lib{name}.so*'))[0] for name in ('lapack', 'blas')]
        subprocess.run(['gfortran', '-O1', '-std=legacy', '-w', '-shared', '-fPIC', '-o', out] + sources + libraries, check=True)
    return ctypes.CDLL(out)


def example(library, slicot, kind, group, number, reals=None, size=0):
    """A, B, Q, R and S of one example, with the default parameters or with those given."""
    k = LARGEST
    square = lambda: np.zeros((k, k), order='F')
    whole = lambda *values: (ctypes.c_int * len(values))(*values)
    A, B, C, Q, R, S, X = (square() for _ in range(7))
    work = np.zeros(k * k)
    real = lambda M: M.ctypes.data_as(ctypes.c_void_p)
    dpar = np.zeros(7)
    dpar[:len(reals or ())] = reals or ()
    nr, ipar, vec = whole(group, number), whole(size, 0, 0, 0), whole(*[0] * 10)
    n, m, p, info, ld, lwork = (ctypes.c_int(v) for v in (0, 0, 0, 0, k, k * k))
    text, by = ctypes.create_string_buffer(b' ' * 255, 255), ctypes.byref
    head = [ctypes.c_char_p(b'D' if reals is None and not size else b'N'), nr, real(dpar), ipar]
    sizes = [vec, by(n), by(m), by(p), real(A), by(ld), real(B), by(ld), real(C), by(ld)]
    here = os.getcwd()
    os.chdir(os.path.join(slicot, 'benchmark_data'))  # the generators open their data by bare names
    if kind == 'carex':
        call = head + [whole(0, 1, 1, 1, 1, 1), text] + sizes
        call += [real(R), by(ld), real(Q), by(ld), real(X), by(ld), real(work), by(lwork), by(info)]
        library.bb01ad_(*call, ctypes.c_size_t(1), ctypes.c_size_t(255))
    else:
        call = head + [whole(1, 1, 1, 0, 1, 1, 1), text] + sizes
        call += [real(Q), by(ld), real(R), by(ld), real(S), by(ld), real(X), by(ld), real(work), by(lwork), by(info)]
        library.bb02ad_(*call, ctypes.c_size_t(1), ctypes.c_size_t(255))
    os.chdir(here)
    if info.value:
        raise RuntimeError(f'{kind} {group}.{number}: info {info.value}')
    n, m = n.value, m.value
    part = lambda M, r, c: M[:r, :c].copy()
    note = ' '.join(text.raw.decode('latin1').split('\0')[0].split())
    return dict(A=part(A, n, n), B=part(B, n, m), Q=part(Q, n, n), R=part(R, m, m), S=part(S, n, m)), note


def write(folder, matrices):
    os.makedirs(folder, exist_ok=True)
    for name, M in matrices.items():
        rows = '\n'.join(repr(float(e)) for e in M.T.ravel())
        with open(os.path.join(folder, name + '.mtx'), 'w') as file:
            file.write(f'%%MatrixMarket matrix array real general\n{M.shape[0]} {M.shape[1]}\n{rows}\n')


def read(path):
    with open(path) as file:
        words = [line for line in file if not line.startswith('%')]
    rows, cols = map(int, words[0].split())
    return np.array([float(w) for w in words[1:]]).reshape(cols, rows).T


def long_solve(R, Y):
    """R^-1 Y in long double: elimination with partial pivoting."""
    M, n = np.hstack([R, Y]).astype(LONG), len(R)
    for k in range(n):
        row = k + int(np.argmax(np.abs(M[k:, k])))
        M[[k, row]] = M[[row, k]]
        M[k] /= M[k, k]
        M[:k] -= np.outer(M[:k, k], M[k])
        M[k + 1:] -= np.outer(M[k + 1:, k], M[k])
    return M[:, n:]


def residual(kind, E, X):
    """The relative residual of X, made symmetric first as every user would."""
    A, B, Q, R, S = (E[name].astype(LONG) for name in 'ABQRS')
    X = ((X + X.T) / 2).astype(LONG)
    size = lambda *Ms: sum(float(np.sqrt((M * M).sum())) for M in Ms)
    if kind == 'carex':
        right = B.T @ X + S.T
        AX, last = A.T @ X, right.T @ long_solve(R, right)
        return size(AX + AX.T - last + Q) / size(AX, AX, last, Q)
    right = B.T @ X @ A + S.T
    AXA, last = A.T @ X @ A, right.T @ long_solve(R + B.T @ X @ B, right)
    return size(AXA - X - last + Q) / size(AXA, X, last, Q)


def peers(kind, E):
    """Name and solver of every peer that takes the example."""
    import slycot
    A, B, Q, R, S = (E[name] for name in 'ABQRS')
    n, m = B.shape
    letter = 'C' if kind == 'carex' else 'D'
    scipys = sla.solve_continuous_are if kind == 'carex' else sla.solve_discrete_are
    yield 'sb02od', lambda: slycot.sb02od(n, m, A, B, Q, R, letter, L=S)[0]
    yield 'sg02ad', lambda: slycot.sg02ad(letter, 'B', 'N', 'U', 'N', 'N', 'S', 'N', n, m, n, A, np.eye(n), B, Q, R, S)[1]
    if kind == 'carex' and not S.any() and np.linalg.matrix_rank(R) == m:
        yield 'sb02md', lambda: slycot.sb02md(n, A, B @ np.linalg.solve(R, B.T), Q, letter)[0]
    yield 'scipy', lambda: scipys(A, B, Q, R, s=S)


def attempt(run):
    """X, or why there is none."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter('ignore')
            return run(), ''
    except Exception as why:
        return None, f'{type(why).__name__}: {why}'.replace('\n', ' ')[:60]


def ours(kind, group, number, work):
    """X or why there is none, and the shortest time in seconds."""
    out = os.path.join(work, 'X')
    done = subprocess.run([PROGRAM, kind, str(group), str(number), os.path.join(work, kind), out], capture_output=True, text=True, check=True)
    said = json.loads(done.stdout)
    if 'refused' in said:
        return None, said['refused'], None
    return read(os.path.join(out, 'X.mtx')), '', said['seconds']


def row(kind, group, number, E, note, work):
    write(os.path.join(work, kind, f'{group}_{number}'), E)
    X, why, _ = ours(kind, group, number, work)
    found = residual(kind, E, X) if X is not None else None
    theirs = {}
    for name, run in peers(kind, E):
        theirs[name], _ = attempt(run)
    theirs = {name: residual(kind, E, X) for name, X in theirs.items() if X is not None and np.isfinite(X).all()}
    slicots = [value for name, value in theirs.items() if name != 'scipy']
    cell = lambda name: f'{theirs[name]:.1e}' if name in theirs else '-'
    ratio = f'{found / max(min(slicots), 1e-17):.2g}' if slicots and found is not None else '-'
    mine = f'{found:.1e}' if found is not None else why
    return [f'{kind} {group}.{number}', str(len(E['A'])), mine] + [cell(name) for name in ('sb02md', 'sb02od', 'sg02ad', 'scipy')] + [ratio]


def sampled(n):
    """A random stable system sampled ten times a unit of time, two inputs, unit weights."""
    random = np.random.default_rng(n)
    A = random.standard_normal((n, n)) / np.sqrt(n)
    A -= (np.linalg.eigvals(A).real.max() + 0.2) * np.eye(n)
    return dict(A=sla.expm(0.1 * A), B=random.standard_normal((n, 2)), Q=np.eye(n), R=np.eye(2), S=np.zeros((n, 2)))


def shortest(run):
    """Seconds of the shortest of the runs that half a second holds, three at least."""
    times = []
    while len(times) < 3 or sum(times) < 0.5:
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return min(times)


def timed(n, work):
    """One line of the discrete equation's times in ms and residuals, peers and Counterpoise in turn."""
    E = sampled(n)
    write(os.path.join(work, 'darex', f'random_{n}'), E)
    runs = dict(peers('darex', E))
    first = {name: (shortest(run), residual('darex', E, run())) for name, run in runs.items() if attempt(run)[0] is not None}
    X, why, seconds = ours('darex', 'random', n, work)
    best = min(seconds_of for seconds_of, _ in first.values())
    cell = lambda name: f'{1e3 * first[name][0]:.3g} ms, {first[name][1]:.1e}' if name in first else 'refused'
    cells = [cell(name) for name in ('sb02od', 'sg02ad', 'scipy')]
    return ['random, sampled', str(n), f"{1e3 * seconds:.3g} ms, {residual('darex', E, X):.1e}"] + cells + [f'{best / seconds:.2g}']


TIMES = ['discrete equation', 'n', 'Counterpoise', 'sb02od', 'sg02ad', 'SciPy', 'time ratio to the fastest']
HEAD = ['example', 'n', 'Counterpoise', 'sb02md', 'sb02od', 'sg02ad', 'SciPy', 'over the best of SLICOT']


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument('--slicot', required=True, help="folder with SLICOT's src and benchmark_data")
    p.add_argument('--work', default=os.path.join(ROOT, 'out', 'peers', 'riccati')); p.add_argument('--out')
    p.add_argument('--program', default=PROGRAM)
    a = p.parse_args()
    globals()['PROGRAM'] = a.program
    work, slicot = os.path.abspath(a.work), os.path.abspath(a.slicot)
    os.makedirs(work, exist_ok=True)
    library = generator(slicot, work)
    lines = ['| ' + ' | '.join(HEAD) + ' |', '|' + '---|' * len(HEAD)]
    print('\n'.join(lines), flush=True)
    for kind, counts in EXAMPLES.items():
        for group, count in enumerate(counts, 1):
            for number in range(1, count + 1):
                E, note = example(library, slicot, kind, group, number)
                lines.append('| ' + ' | '.join(row(kind, group, number, E, note, work)) + ' |')
                print(lines[-1], flush=True)
    lines += ['', '| ' + ' | '.join(TIMES) + ' |', '|' + '---|' * len(TIMES)]
    print('\n'.join(lines[-3:]), flush=True)
    for n in (10, 20, 50, 100, 200):
        lines.append('| ' + ' | '.join(timed(n, work)) + ' |')
        print(lines[-1], flush=True)
    if a.out:
        with open(a.out, 'w') as file:
            file.write('\n'.join(lines) + '\n')


if __name__ == '__main__':
    main()
