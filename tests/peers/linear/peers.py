#!/usr/bin/env python3
"""Counterpoise beside SciPy, python-control, slycot (SLICOT) and others, on the same problems, judged by the same code.

  cargo build --release -p counterpoise-tests --example counterpoise-peers
  python3 tests/peers/linear/peers.py [--kinds care,lyap] [--families rand,flex] [--sizes 10,50] [--threads 1] [--out FILE]

Needs numpy, scipy, control and slycot, and the problems' generator and judge in ../shared/benchmarks/peers/linear. The
data (about 140 MB for all sizes) and the answers are kept in the folder --work. Peer and Counterpoise run in turn, each
in a process of its own; a time is the shortest of several runs. Read the ratios: above 1 means that Counterpoise is
faster, or more accurate."""
import argparse, contextlib, io, json, os, subprocess, sys

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
SHARED = os.path.join(os.path.dirname(ROOT), 'shared', 'benchmarks', 'peers', 'linear')
PROGRAM = os.path.join(ROOT, 'target', 'release', 'examples', 'counterpoise-peers')
KINDS = ['care', 'lyap', 'h2', 'hinf', 'bt', 'freq', 'zoh', 'tustin']
ERROR = {'care': 'fwd', 'lyap': 'fwd', 'zoh': 'fwd', 'h2': 'excess', 'bt': 'relerr', 'freq': 'maxrel', 'tustin': 'maxrel'}
FLOOR = 1e-16  # below the rounding of the reference, errors are not compared
SLOW = {'bt:pymor.BTReductor', 'freq:harold', 'freq:scipy.freqresp(siso)', 'hinf:control.hinfsyn'}


def shared(work):
    """The generator, the judge and the peers' drivers, working in `work` instead of beside themselves."""
    sys.path.insert(0, SHARED)
    import check, gen, run_py
    for module in (check, gen, run_py):
        module.HERE = work
    as_drawn = check.true_fr
    check.true_fr = lambda family, n, P, w: rod_response(P, w) if family == 'flex' else as_drawn(family, n, P, w)
    return gen, check, run_py


def rod_response(P, w):
    """The response of the family `flex` from the closed form of the rod's modes, in long double.

    The judge's own reference takes the natural frequencies from a symmetric eigenproblem in double precision, which is
    good to eps norm(K): 1e-10 of the resonant peaks at n = 100, 2e-9 at n = 400, more than the better answers are off."""
    import numpy as np
    real = np.longdouble
    n = len(P['A']) // 2
    stiffness = real(P['A'][n, 1])
    i, j, pi = np.arange(1, n + 1).astype(real), np.arange(1, n + 1).astype(real), 4 * np.arctan(real(1))
    rates = 2 * np.sqrt(stiffness) * np.sin((2 * j - 1) * pi / (2 * (2 * n + 1)))
    shapes = np.sin(np.outer(i, 2 * j - 1) * pi / (2 * n + 1))
    shapes /= np.sqrt((shapes * shapes).sum(0))
    s = 1j * w.astype(np.clongdouble)[:, None]
    modes = 1 / (s * s + 2 * real(0.005) * rates * s + rates * rates)
    left, right = P['C2'][:, :n].astype(real) @ shapes, shapes.T @ P['B2'][n:].astype(real)
    return np.einsum('pi,fi,im->fpm', left, modes, right).astype(complex)  # numpy.linalg takes no long doubles


def generate(work, sizes):
    """Makes the problems that are missing, in a process of its own: the generator works in long double."""
    missing = [str(n) for n in sizes if not os.path.isdir(os.path.join(work, 'data', f'flexm_{n}'))]
    if missing:
        command = [sys.executable, os.path.abspath(__file__), '--work', work, '--sizes', ','.join(missing), '--generate']
        subprocess.run(command, check=True, stdout=sys.stderr)
    for folder in sorted(os.listdir(os.path.join(work, 'data'))):
        write_grid(os.path.join(work, 'data', folder))


def write_grid(folder):
    """The frequencies to the last bit as the judge has them: a resonance magnifies a rounding of them a hundredfold."""
    import numpy as np
    path = os.path.join(folder, 'w.mtx')
    if os.path.exists(path):
        return
    with open(os.path.join(folder, 'meta.json')) as file:
        meta = json.load(file)
    grid = np.logspace(np.log10(meta['wmin']), np.log10(meta['wmax']), meta['nfreq'])
    with open(path, 'w') as file:
        file.write(f'%%MatrixMarket matrix array real general\n{len(grid)} 1\n' + '\n'.join(f'{w!r}' for w in grid.tolist()) + '\n')


def child(work, family, n, method):
    """One peer on one problem, in this process."""
    run_py = shared(work)[2]
    run_py.child(family, n, method)


def error(kind, judged):
    """One figure of merit: the smaller the better; infinite for an unstable loop."""
    if kind in ('care', 'h2', 'hinf', 'bt') and judged.get('maxre', -1) >= 0:
        return float('inf')
    if kind == 'hinf':
        return judged.get('norm', judged.get('norm_grid', float('inf')))
    return max(judged.get(ERROR[kind], float('inf')), FLOOR)


def run_peer(a, kind, family, n, method):
    command = [sys.executable, os.path.abspath(__file__), '--work', a.work, '--child', family, str(n), method]
    env = dict(os.environ, OPENBLAS_NUM_THREADS=str(a.threads), OMP_NUM_THREADS=str(a.threads))
    try:
        text = subprocess.run(command, env=env, capture_output=True, text=True, timeout=a.limit).stdout
    except subprocess.TimeoutExpired:
        return dict(why='time limit')
    lines = [json.loads(line[5:]) for line in text.splitlines() if line.startswith('DONE ')]
    if not lines:
        return dict(why='crash')
    if 'error' in lines[0]:
        return dict(why=lines[0]['error'][:60])
    return dict(ms=1e3 * lines[0]['min'], error=error(kind, lines[0]))


def run_ours(a, kind, family, n):
    out = os.path.join(a.work, 'answers', f'{kind}_{family}_{n}')
    command = [PROGRAM, kind, family, str(n), os.path.join(a.work, 'data'), out]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=a.limit)
    except subprocess.TimeoutExpired:
        return dict(why='time limit')
    if done.returncode:
        return dict(why='crash: ' + done.stderr.strip()[-60:])
    said = json.loads(done.stdout)
    if 'refused' in said:
        return dict(why=said['refused'][:100])
    check = shared(a.work)[1]
    # The reader makes long doubles of files with subnormal numbers.
    answer = {name: matrix.astype(float) for name, matrix in check.load_out(out).items()}
    if kind == 'freq':
        shape = (-1, 2, 2)
        h = (answer['Hre'] + 1j * answer['Him']).reshape(shape).transpose(0, 2, 1)
        answer = dict(H=h)
    with contextlib.redirect_stdout(io.StringIO()):
        judged = check.evaluate(kind, family, n, answer)
    return dict(ms=1e3 * said['seconds'], error=error(kind, judged))


def cell(result):
    return result['why'] if 'why' in result else f"{result['ms']:.3g} ms, {result['error']:.1e}"


def row(a, kind, family, n, methods):
    results = {m: run_peer(a, kind, family, n, m) for m in methods}
    ours = run_ours(a, kind, family, n)
    good = {m: r for m, r in results.items() if 'why' not in r}
    line = [kind, family, str(n), cell(ours)]
    if not good:
        return line + ['every peer refuses', '', '', '']
    fast = min(good, key=lambda m: good[m]['ms'])
    sharp = min(good, key=lambda m: good[m]['error'])
    line += [f"{good[fast]['ms']:.3g} ms ({fast.split(':')[-1]})", f"{good[sharp]['error']:.1e} ({sharp.split(':')[-1]})"]
    if 'why' in ours:
        return line + ['', '']
    return line + [f"{good[fast]['ms'] / ours['ms']:.2g}", f"{good[sharp]['error'] / ours['error']:.2g}"]


HEAD = ['problem', 'family', 'n', 'Counterpoise: time, error', 'fastest peer', 'most accurate peer', 'time ratio', 'error ratio']


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument('--kinds', default=','.join(KINDS)); p.add_argument('--families', default='rand,flex,flexm')
    p.add_argument('--sizes', default='10,20,50,100,200,400'); p.add_argument('--threads', type=int, default=1)
    p.add_argument('--limit', type=float, default=150); p.add_argument('--all', action='store_true', help='slow peers too')
    p.add_argument('--work', default=os.path.join(ROOT, 'out', 'peers')); p.add_argument('--out')
    p.add_argument('--child', nargs=3); p.add_argument('--generate', action='store_true')
    a = p.parse_args()
    if not os.path.isdir(SHARED):
        sys.exit(f'skipped: {SHARED} is not there')
    a.work = os.path.abspath(a.work)
    os.makedirs(a.work, exist_ok=True)
    if a.child:
        return child(a.work, a.child[0], int(a.child[1]), a.child[2])
    if a.generate:
        gen = shared(a.work)[0]
        gen.NS = [int(n) for n in a.sizes.split(',')]
        return gen.main()
    if not os.path.exists(PROGRAM):
        sys.exit('build first: cargo build --release -p counterpoise-tests --example counterpoise-peers')
    sizes = [int(n) for n in a.sizes.split(',')]
    generate(a.work, sizes)
    methods = shared(a.work)[2].METHODS
    print('| ' + ' | '.join(HEAD) + ' |\n|' + '---|' * len(HEAD), flush=True)
    lines = []
    for kind in a.kinds.split(','):
        chosen = [m for m, k in methods.items() if k == kind and (a.all or m not in SLOW)]
        for family in a.families.split(','):
            for n in sizes:
                lines.append('| ' + ' | '.join(row(a, kind, family, n, chosen)) + ' |')
                print(lines[-1], flush=True)
    if a.out:
        with open(a.out, 'w') as file:
            file.write('| ' + ' | '.join(HEAD) + ' |\n|' + '---|' * len(HEAD) + '\n' + '\n'.join(lines) + '\n')


if __name__ == '__main__':
    main()
