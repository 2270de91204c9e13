#!/usr/bin/env python3
"""Counterpoise beside SciPy, python-control, slycot (SLICOT) and others, on the same problems, judged by the same code.

  cargo build --release -p counterpoise-tests --example counterpoise-peers
  python3 tests/peers/linear/peers.py [--kinds care,lyap] [--families rand,flex] [--sizes 10,50] [--threads 1] [--again] [--out FILE]

Needs numpy, scipy, control and slycot, and the problems' generator and judge in ../shared/benchmarks/peers/linear. The
data (about 140 MB for all sizes), the answers and the results are kept in the folder --work: a run that is cut off goes on
where it stopped. Peer and Counterpoise run in turn, each in a process of its own; a time is the shortest of several runs.
Read the ratios: above 1 means that Counterpoise is faster, or more accurate."""
import argparse, contextlib, io, json, os, subprocess, sys

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
SHARED = os.path.join(os.path.dirname(ROOT), 'shared', 'benchmarks', 'peers', 'linear')
PROGRAM = os.path.join(ROOT, 'target', 'release', 'examples', 'counterpoise-peers')
KINDS = ['care', 'lyap', 'h2', 'hinf', 'bt', 'freq', 'zoh', 'tustin']
ERROR = {'care': 'fwd', 'lyap': 'fwd', 'zoh': 'fwd', 'h2': 'excess', 'bt': 'relerr', 'freq': 'maxrel', 'tustin': 'maxrel'}
FLOOR = 1e-16  # below the rounding of the reference, errors are not compared
LONG = 1e-3  # seconds from which on processor time is read, for Counterpoise, too
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


def child(work, family, n, methods):
    """Peers on one problem, one after the other in this process: what they import takes longer than what they solve."""
    run_py = shared(work)[2]
    for method in methods.split('|'):
        run_py.child(family, n, method)


def error(kind, judged):
    """One figure of merit: the smaller the better; infinite for an unstable loop."""
    if kind in ('care', 'h2', 'hinf', 'bt') and judged.get('maxre', -1) >= 0:
        return float('inf')
    if kind == 'hinf':
        return judged.get('norm', judged.get('norm_grid', float('inf')))
    return max(judged.get(ERROR[kind], float('inf')), FLOOR)


def run_peers(a, kind, family, n, methods):
    """The result of each; one that takes the process with it, or all the time, takes those after it, too."""
    command = [sys.executable, os.path.abspath(__file__), '--work', a.work, '--child', family, str(n), '|'.join(methods)]
    env = dict(os.environ)
    if a.threads:
        env.update(OPENBLAS_NUM_THREADS=str(a.threads), OMP_NUM_THREADS=str(a.threads))
    try:
        text, missing = subprocess.run(command, env=env, capture_output=True, text=True, timeout=a.limit).stdout, 'crash'
    except subprocess.TimeoutExpired as late:
        text, missing = (late.stdout or b'').decode(), f'over {a.limit:.0f} s'
    said = [json.loads(line[5:]) for line in text.splitlines() if line.startswith('DONE ')]
    results = {method: dict(why=missing) for method in methods}
    for entry in said:
        if 'error' in entry:
            results[entry['method']] = dict(why=entry['error'][:60])
        else:
            # On one thread the processor's time, which a busy machine does not lengthen.
            seconds = min(entry['min'], entry['cpu_min']) if a.threads == 1 and entry['min'] > LONG else entry['min']
            results[entry['method']] = dict(ms=1e3 * seconds, error=error(kind, entry))
    return results


def run_ours(a, kind, family, n):
    out = os.path.join(a.work, 'answers', f'{kind}_{family}_{n}')
    command = [a.program, kind, family, str(n), os.path.join(a.work, 'data'), out]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=a.limit)
    except subprocess.TimeoutExpired:
        return dict(why=f'over {a.limit:.0f} s')
    if done.returncode:
        return dict(why='crash: ' + done.stderr.strip()[-60:])
    said = json.loads(done.stdout)
    if 'refused' in said:
        return dict(why=said['refused'][:100])
    return dict(ms=1e3 * said['seconds'], error=error(kind, judged(a, kind, family, n, out)))


def judged(a, kind, family, n, out):
    check = shared(a.work)[1]
    # The reader makes long doubles of files with subnormal numbers.
    answer = {name: matrix.astype(float) for name, matrix in check.load_out(out).items()}
    if kind == 'freq':
        shape = (-1, 2, 2)
        answer = dict(H=(answer['Hre'] + 1j * answer['Him']).reshape(shape).transpose(0, 2, 1))
    with contextlib.redirect_stdout(io.StringIO()):
        return check.evaluate(kind, family, n, answer)


class Store:
    """What was measured, a line each, so that a run that was cut off goes on where it stopped."""

    def __init__(self, path):
        self.path, self.known = path, {}
        if os.path.exists(path):
            with open(path) as file:
                for line in file:
                    entry = json.loads(line)
                    self.known[tuple(entry['key'])] = entry['result']

    def add(self, key, result):
        self.known[key] = result
        with open(self.path, 'a') as file:
            file.write(json.dumps(dict(key=key, result=result)) + '\n')


def faster(one, other):
    """Of two runs of the same program the one with the shorter time."""
    return other if 'ms' in other and ('ms' not in one or other['ms'] < one['ms']) else one


def measure(a, store, kind, family, n, methods):
    """Counterpoise, every peer, Counterpoise again, the fastest peer again: what loads the machine meets both."""
    keys = {m: (a.threads, kind, family, n, m) for m in methods + ['ours']}
    if keys['ours'] in store.known and not a.again:
        return {m: store.known[key] for m, key in keys.items() if key in store.known}
    results = run_peers(a, kind, family, n, methods)
    results['ours'] = run_ours(a, kind, family, n)
    timed = [m for m in methods if 'ms' in results[m]]
    if timed:
        first = min(timed, key=lambda m: results[m]['ms'])
        if results[first]['ms'] < 2000:
            results[first] = faster(results[first], run_peers(a, kind, family, n, [first])[first])
            results['ours'] = faster(results['ours'], run_ours(a, kind, family, n))
    for m, result in results.items():
        store.add(keys[m], result)
    return results


def cell(result):
    return result['why'] if 'why' in result else f"{result['ms']:.3g} ms, {result['error']:.1e}"


def row(kind, family, n, results):
    results = dict(results)
    ours = results.pop('ours')
    good = {m: r for m, r in results.items() if 'why' not in r}
    line = [kind, family, str(n), cell(ours)]
    if not good:
        return line + ['every peer refuses or takes too long', '', '', '']
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
    p.add_argument('--sizes', default='10,20,50,100,200,400')
    p.add_argument('--threads', type=int, default=1, help='of the peers; 0: their default')
    p.add_argument('--limit', type=float, default=150); p.add_argument('--all', action='store_true', help='slow peers too')
    p.add_argument('--again', action='store_true', help='measure anew what the store has')
    p.add_argument('--work', default=os.path.join(ROOT, 'out', 'peers')); p.add_argument('--out')
    p.add_argument('--store', help='default: results.jsonl in the work folder'); p.add_argument('--program', default=PROGRAM)
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
    if not os.path.exists(a.program):
        sys.exit('build first: cargo build --release -p counterpoise-tests --example counterpoise-peers')
    table(a)


def table(a):
    sizes, families = [int(n) for n in a.sizes.split(',')], a.families.split(',')
    generate(a.work, sizes)
    methods = shared(a.work)[2].METHODS
    store = Store(a.store or os.path.join(a.work, 'results.jsonl'))
    head = ['| ' + ' | '.join(HEAD) + ' |', '|' + '---|' * len(HEAD)]
    print('\n'.join(head), flush=True)
    lines = {}
    for n in sizes:  # the small ones first: a run that is cut off has them all
        for kind in a.kinds.split(','):
            chosen = [m for m, k in methods.items() if k == kind and (a.all or m not in SLOW)]
            for family in families:
                results = measure(a, store, kind, family, n, chosen)
                lines[kind, family, n] = '| ' + ' | '.join(row(kind, family, n, results)) + ' |'
                print(lines[kind, family, n], flush=True)
    if a.out:
        ordered = [lines[kind, family, n] for kind in a.kinds.split(',') for family in families for n in sizes]
        with open(a.out, 'w') as file:
            file.write('\n'.join(head + ordered) + '\n')


if __name__ == '__main__':
    main()
