#!/usr/bin/env python3
"""The lowest modes of large structures beside SciPy's eigsh: time, memory, frequencies.

  cargo build --release -p counterpoise-models --example large_structure
  python3 tests/peers/linear/large.py [--kinds plane,space] [--unknowns 3000,30000,200000] [--work FOLDER] [--project]

Makes box girders of beam elements on a pivot: `plane` has nodes in one plane (three unknowns each), `space` is a lattice of members in
three directions (six each). Both programs find ten modes of the structure pinned at its hub; Counterpoise also finds those of the
clamped and of the free structure in the same run. eigsh inverts about a shift below zero, since the pinned structure turns freely. Each program runs
in a process of its own, whose peak memory and processor time (reading the matrices included) are read when it has ended. --project leaves a project for `counterpoise model` in the folder."""
import argparse, json, os, subprocess, sys, time

import numpy as np
import scipy.sparse as sp

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
TARGET = os.environ.get('CARGO_TARGET_DIR', os.path.join(ROOT, 'target'))
PROGRAM = os.path.join(TARGET, 'release', 'examples', 'large_structure')
MODES = 10
E, G, RHO, SIDE = 70e9, 26e9, 2700.0, 0.01  # aluminium members of 10 mm square


def member(direction, length):
    """Stiffness (12 x 12) and lumped mass (12) of a square member along x, y or z; displacements, then rotations, of both ends."""
    A, I = SIDE ** 2, SIDE ** 4 / 12
    K = np.zeros((12, 12))
    def add(rows, block):
        K[np.ix_(rows, rows)] += block
    add([0, 6], E * A / length * np.array([[1, -1], [-1, 1]]))
    add([3, 9], G * 2 * I / length * np.array([[1, -1], [-1, 1]]))
    l = length
    bend = E * I / l ** 3 * np.array([[12, 6 * l, -12, 6 * l], [6 * l, 4 * l * l, -6 * l, 2 * l * l], [-12, -6 * l, 12, -6 * l], [6 * l, 2 * l * l, -6 * l, 4 * l * l]])
    add([1, 5, 7, 11], bend)  # v with the rotation about z
    turn = np.diag([1, -1, 1, -1])
    add([2, 4, 8, 10], turn @ bend @ turn)  # w with the rotation about y
    axes = {'x': np.eye(3), 'y': np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1.0]]), 'z': np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0.0]])}[direction]
    T = np.kron(np.eye(4), axes)
    half = RHO * A * l / 2
    return T.T @ K @ T, np.tile([half] * 3 + [half * l * l / 12] * 3, 2)


def girder(kind, unknowns):
    """M, K, positions (x, z) of the nodes and the components of their unknowns; the pivot's and the tip's node."""
    components = [0, 2, 4] if kind == 'plane' else [0, 1, 2, 3, 4, 5]
    per = len(components)
    high = max(3, int(round((unknowns / per / (16 if kind == 'plane' else 10)) ** (1 / 2 if kind == 'plane' else 1 / 3)))) | 1
    wide = 1 if kind == 'plane' else high
    long = max(8, unknowns // per // high // wide)
    number = lambda i, j, k: (i * wide + j) * high + k
    step = 0.1
    i, j, k = (a.ravel() for a in np.meshgrid(np.arange(long), np.arange(wide), np.arange(high), indexing='ij'))
    n = long * wide * high
    rows, cols, values, mass = [], [], [], np.zeros(n * per)
    for direction, ok, other in [('x', i + 1 < long, (1, 0, 0)), ('y', j + 1 < wide, (0, 1, 0)), ('z', k + 1 < high, (0, 0, 1))]:
        a = number(i, j, k)[ok]
        b = number(i + other[0], j + other[1], k + other[2])[ok]
        if not len(a):
            continue
        Ke, Me = member(direction, step)
        kept = components + [6 + c for c in components]
        Ke, Me = Ke[np.ix_(kept, kept)], Me[kept]
        place = np.hstack([per * a[:, None] + np.arange(per), per * b[:, None] + np.arange(per)])
        rows.append(np.repeat(place, 2 * per, axis=1).ravel()); cols.append(np.tile(place, (1, 2 * per)).ravel())
        values.append(np.tile(Ke.ravel(), len(a)))
        np.add.at(mass, place.ravel(), np.tile(Me, len(a)))
    K = sp.csc_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(cols))), shape=(n * per, n * per))
    K.eliminate_zeros()
    centre = (wide // 2, high // 2)
    pivot, tip = number(long // 5, *centre), number(long - 1, *centre)
    return sp.diags(mass).tocsc(), K, step * i, step * (k - high // 2), components, pivot, tip


def write(folder, kind, unknowns):
    M, K, x, z, components, pivot, tip = girder(kind, unknowns)
    os.makedirs(folder, exist_ok=True)
    for name, A in (('mass', M), ('stiffness', K)):
        L = sp.tril(A).tocoo()
        with open(os.path.join(folder, name + '.mtx'), 'w') as file:
            file.write(f'%%MatrixMarket matrix coordinate real symmetric\n{A.shape[0]} {A.shape[0]} {L.nnz}\n')
            np.savetxt(file, np.c_[L.row + 1, L.col + 1, L.data], fmt=['%d', '%d', '%.17g'])
    with open(os.path.join(folder, 'nodes.map'), 'w') as file:
        file.write(f'axes 3 -5\naxial 1\npivot {pivot + 1}\ntip {tip + 1}\n')
        file.writelines(f'node {g + 1} {x[g]:.6f} {z[g]:.6f}\n' for g in range(len(x)))
        file.writelines(f'row {g + 1} {c + 1}\n' for g in range(len(x)) for c in components)
    np.savez(os.path.join(folder, 'scipy.npz'), pivot=pivot, per=len(components), place=components.index(4))
    sp.save_npz(os.path.join(folder, 'M.npz'), M); sp.save_npz(os.path.join(folder, 'K.npz'), K)
    return K.shape[0], K.nnz


def scipy_modes(folder):
    """Run in a process of its own: the frequencies of the pinned structure by eigsh."""
    from scipy.sparse.linalg import eigsh
    M, K = sp.load_npz(os.path.join(folder, 'M.npz')), sp.load_npz(os.path.join(folder, 'K.npz'))
    about = np.load(os.path.join(folder, 'scipy.npz'))
    held = [int(about['pivot'] * about['per'] + c) for c in range(int(about['per'])) if c != int(about['place'])]
    free = np.setdiff1d(np.arange(K.shape[0]), held)
    start = time.perf_counter()
    values = eigsh(K[free][:, free], MODES + 1, M[free][:, free], sigma=-100.0, tol=1e-10, return_eigenvectors=True)[0]
    seconds = time.perf_counter() - start
    print(json.dumps(dict(seconds=seconds, rad_s=np.sqrt(np.sort(values)[1:]).tolist())))


def measured(command, limit):
    """Standard output, the peak memory in MiB and the processor time in s; None if it takes too long or too much."""
    try:
        done = subprocess.run(['/usr/bin/env', 'python3', '-c', 'import resource,subprocess,sys\nd=subprocess.run(sys.argv[1:],capture_output=True,text=True)\nsys.stderr.write(d.stderr[-300:])\nu=resource.getrusage(resource.RUSAGE_CHILDREN)\nprint(d.stdout)\nprint(u.ru_maxrss,u.ru_utime+u.ru_stime)', *command],
                              capture_output=True, text=True, timeout=limit)
        text, used = done.stdout.rstrip().rsplit('\n', 1)
        memory, processor = used.split()
        return json.loads(text), int(memory) / 1024, float(processor)
    except Exception as why:
        print(f'{command[0]}: {why}', file=sys.stderr)
        return None, float('nan'), float('nan')


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument('--kinds', default='plane,space'); p.add_argument('--unknowns', default='3000,30000,200000')
    p.add_argument('--work', default=os.path.join(ROOT, 'out', 'peers', 'large')); p.add_argument('--limit', type=float, default=1800)
    p.add_argument('--scipy', help=argparse.SUPPRESS); p.add_argument('--project', action='store_true')
    a = p.parse_args()
    if a.scipy:
        return scipy_modes(a.scipy)
    print('| structure | unknowns | entries of K | Counterpoise, three supports | memory | eigsh, pinned | memory | largest difference of frequencies |')
    print('|---|---|---|---|---|---|---|---|', flush=True)
    for kind in a.kinds.split(','):
        for unknowns in map(int, a.unknowns.split(',')):
            folder = os.path.join(a.work, f'{kind}_{unknowns}')
            n, entries = write(folder, kind, unknowns)
            if a.project:
                text = open(os.path.join(ROOT, 'examples', 'imported-structure', 'project.toml')).read()
                open(os.path.join(folder, 'project.toml'), 'w').write(text)
            ours, memory, own = measured([PROGRAM, folder, str(MODES)], a.limit)
            theirs, peers_memory, peers = measured([sys.executable, os.path.abspath(__file__), '--scipy', folder], a.limit)
            apart = max(abs(x / y - 1) for x, y in zip(ours['pinned'], theirs['rad_s'])) if ours and theirs else float('nan')
            mine = f'{own:.1f} s' if ours else 'failed'
            other = f'{peers:.1f} s' if theirs else 'failed'
            print(f'| {kind} | {n} | {entries} | {mine} | {memory:.0f} MiB | {other} | {peers_memory:.0f} MiB | {apart:.1e} |', flush=True)


if __name__ == '__main__':
    main()
