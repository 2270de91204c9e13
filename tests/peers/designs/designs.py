#!/usr/bin/env python3
"""The table of `counterpoise compare`, rebuilt with SciPy.

  cargo build --release
  python3 tests/peers/designs/designs.py [PROJECT] [--limits MS,MT,NOISE,KS] [--search SECONDS]

Needs Python 3.11, numpy and scipy. Reads the linear plant from `counterpoise model --json`, adds the hub gyroscope of the project file, holds and
samples it, and computes every figure of each tuned structure from the values of its blocks: transfer functions, sampling and figures are written anew
here. Then a differential evolution of SciPy tunes the PI with a lag for the same disturbance under the same limits: Counterpoise must be at
least as good. Exits with 1 on any disagreement."""
import argparse, json, os, subprocess, sys, time, tomllib

import numpy as np
from scipy.optimize import differential_evolution
from scipy.signal import cont2discrete

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
TARGET = os.environ.get('CARGO_TARGET_DIR', os.path.join(ROOT, 'target'))
PROGRAM = os.path.join(TARGET, 'release', 'counterpoise')


def ask(*arguments):
    done = subprocess.run([PROGRAM, *arguments, '--json', '-q'], capture_output=True, text=True)
    if done.returncode > 1:
        sys.exit(done.stderr)
    return json.loads(done.stdout)


def gyroscope(project):
    """Numerator and denominator of the hub gyroscope; unity if the file states none."""
    gyro = project['plant'].get('sensors', {}).get('hub_gyro', {})
    w, z = gyro.get('natural_frequency'), gyro.get('damping_ratio', 0.7)
    return ([1.0], [1.0]) if w is None else ([w * w], [1.0, 2 * z * w, w * w])


def block(kind, p, s):
    """The transfer function of a block at s."""
    if kind == 'gain':
        return p['gain'] + 0 * s
    if kind == 'pi':
        return p['gain'] * (1 + p['corner'] / s)
    if kind == 'pid':
        return p['gain'] * (1 + p['corner'] / s + p['derivative_time'] * s / (1 + p['filter_time'] * s))
    if kind == 'lead':
        return (1 + s / p['frequency']) / (1 + s / (p['frequency'] * p['ratio']))
    if kind == 'lag':
        return (s + p['frequency']) / (s + p['frequency'] / p['ratio'])
    if kind == 'notch':
        w, z, d = p['frequency'], p['damping'], p['depth']
        return (s**2 + 2 * d * z * w * s + w**2) / (s**2 + 2 * z * w * s + w**2)
    if kind == 'biquad':
        a, y, b, z = (p[k] for k in ('zero_frequency', 'zero_damping', 'pole_frequency', 'pole_damping'))
        return (s**2 / a**2 + 2 * y * s / a + 1) / (s**2 / b**2 + 2 * z * s / b + 1)
    if kind == 'low-pass':
        return 1 / (1 + s / p['frequency'])
    if kind == 'second-order-low-pass':
        return 1 / (s**2 / p['frequency']**2 + 2 * p['damping'] * s / p['frequency'] + 1)
    raise ValueError(kind)


class Loop:
    """The sampled plant and a dense grid."""

    def __init__(self, path):
        folder = path if os.path.isdir(path) else os.path.dirname(path)
        with open(os.path.join(path, 'project.toml') if os.path.isdir(path) else path, 'rb') as file:
            project = tomllib.load(file)
        if isinstance(project.get('include'), str):
            with open(os.path.join(folder, project['include']), 'rb') as file:
                project = {**tomllib.load(file), **project}
        interface = project['plant'].get('interface', {})
        self.period = interface['sample_period']
        plant = ask('model', path)['plant']
        A, B, C = (np.array(plant[k]) for k in 'ABC')
        control = [i['name'] for i in plant['inputs']].index('control_v')
        rate = [o['name'] for o in plant['outputs']].index('hub_rate_rad_s')
        n, d = gyroscope(project)
        A, B, C = self.sensed(A, B[:, [control]], C[[rate]], n, d)
        self.A, self.B, self.C, self.D, _ = cont2discrete((A, B, C, np.zeros((1, 1))), self.period)
        self.delay = interface.get('output_delay_samples', 0)
        half = np.pi / self.period
        poles = np.log(np.linalg.eigvals(self.A).astype(complex) + 1e-300) / self.period
        grid = [np.geomspace(1e-5 * half, 0.999 * half, 6000)]
        for p in poles[(poles.imag > 0) & (abs(poles.real) < 0.3 * abs(poles))]:
            grid.append(p.imag + abs(p.real) * np.linspace(-8, 8, 400))
        self.w = np.unique(np.concatenate(grid))
        self.w = self.w[(self.w > 0) & (self.w < 0.999 * half)]
        self.P = self.plant(self.w)

    @staticmethod
    def sensed(A, B, C, n, d):
        """The plant followed by the second-order gyroscope."""
        if len(d) == 1:
            return A, B, C
        k = len(A)
        Ag = np.array([[0, 1], [-d[2], -d[1]]])
        out = np.zeros((k + 2, k + 2))
        out[:k, :k], out[k:, k:] = A, Ag
        out[k + 1, :k] = n[0] * C[0]
        Cs = np.zeros((1, k + 2))
        Cs[0, k] = 1
        return out, np.vstack([B, np.zeros((2, 1))]), Cs

    def plant(self, w):
        z = np.exp(1j * w * self.period)
        values = np.linalg.solve(z[:, None, None] * np.eye(len(self.A)) - self.A, self.B[None])
        return (self.C @ values)[:, 0, 0] * z**-self.delay

    def s(self, w):
        return 2j / self.period * np.tan(0.5 * w * self.period)

    def controller(self, blocks, w):
        s = self.s(w)
        return np.prod([block(b['kind'], dict(b['values']), s) for b in blocks], axis=0)

    def figures(self, blocks, lines, noise):
        w, P, K = self.w, self.P, self.controller(blocks, self.w)
        L = P * K
        S = 1 / (1 + L)
        mean = lambda power: np.trapezoid(np.concatenate([power[:1], power]), np.concatenate([[0], w])) * self.period / np.pi
        found = dict(max_sensitivity=abs(S).max(), max_complementary=abs(L * S).max(), control_peak=abs(K * S).max(),
                     noise_gain=mean(abs(K * S)**2)**.5)
        at, power = lines[:, 0], lines[:, 1]
        Kl, Pl = self.controller(blocks, at), self.plant(at)
        Sl = 1 / (1 + Pl * Kl)
        found['residual_rad_s'] = (np.sum(power * abs(Sl)**2) + noise**2 * mean(abs(L * S)**2))**.5
        found['effort_v'] = np.sum(power * abs(Kl * Sl)**2)**.5
        size, angle = np.log(abs(L)), np.unwrap(np.angle(L))
        cross = np.where(size[:-1] * size[1:] < 0)[0]
        part = size[cross] / (size[cross] - size[cross + 1])
        phase = angle[cross] + part * (angle[cross + 1] - angle[cross])
        rate = w[cross] + part * (w[cross + 1] - w[cross])
        above = np.mod(phase + np.pi, 2 * np.pi)
        found['phase_margin_deg'] = np.degrees(np.minimum(above, 2 * np.pi - above).min(initial=np.pi))
        found['delay_margin_s'] = (above / rate).min(initial=np.inf)
        turn = np.where((L.imag[:-1] * L.imag[1:] < 0) & (L.real[:-1] < 0))[0]
        part = L.imag[turn] / (L.imag[turn] - L.imag[turn + 1])
        real = L.real[turn] + part * (L.real[turn + 1] - L.real[turn])
        found['gain_margin_db'] = abs(20 * np.log10(-real)).min() if len(real) else np.inf
        # Encirclements of -1: plant and blocks have no pole outside, so the angle of 1 + L ends where it began, but for the integrator.
        turned = np.unwrap(np.angle(1 + L))
        found['stable'] = -0.75 < (turned[-1] - turned[0]) / np.pi < 1.25
        return found


# Relative differences that the grid here explains.
CLOSE = dict(max_sensitivity=1e-3, max_complementary=1e-3, control_peak=2e-3, noise_gain=5e-3, residual_rad_s=2e-3, effort_v=2e-3,
             phase_margin_deg=2e-3, delay_margin_s=2e-3, gain_margin_db=2e-3)


def random_search(loop, lines, noise, limits, seconds):
    """A PI with a lag tuned by differential evolution under the same limits."""
    from_vector = lambda x: [dict(kind='pi', values=[('gain', np.exp(x[0])), ('corner', np.exp(x[1]))]),
                             dict(kind='low-pass', values=[('frequency', np.exp(x[2]))])]
    best = [np.inf]
    begun = time.time()
    coarse = slice(None, None, 5)
    fine_w, fine_P = loop.w, loop.P

    def cost(x):
        found = loop.figures(from_vector(x), lines, noise)
        over = max(max(found[k] / v - 1 for k, v in limits.items() if v), 0.0)
        unstable = not found['stable']
        if over <= 1e-4 and not unstable:
            best[0] = min(best[0], found['residual_rad_s'])
        return np.log(found['residual_rad_s']) + 100 * over + 10 * unstable

    loop.w, loop.P = fine_w[coarse], fine_P[coarse]
    half = np.pi / loop.period
    bounds = [(np.log(0.05), np.log(2000)), (np.log(0.05), np.log(0.05 * half)), (np.log(0.003 * half), np.log(0.8 * half))]
    stop = lambda *_args, **_more: time.time() - begun > seconds
    differential_evolution(cost, bounds, seed=1, popsize=12, maxiter=10_000, tol=1e-9, callback=stop, polish=False)
    loop.w, loop.P = fine_w, fine_P
    return best[0]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('project', nargs='?', default=os.path.join(ROOT, 'examples', 'reference-rig'))
    parser.add_argument('--limits', action='append', default=[])
    parser.add_argument('--search', type=float, default=60.0)
    asked = parser.parse_args()
    table = ask('compare', asked.project, *(part for each in asked.limits for part in ('--limits', each)))
    loop = Loop(asked.project)
    lines, noise, wrong, searched = np.array(table['disturbance']), table['reading_noise_rad_s'], 0, None
    for row in table['rows']:
        if not row['blocks']:
            continue
        here = loop.figures(row['blocks'], lines, noise)
        print(f"{row['name']}, limits {row['limits']}")
        wrong += not here['stable']
        for name, close in CLOSE.items():
            theirs = row['linear'][name]
            off = abs(here[name] / theirs - 1) if theirs else 0.0
            verdict = 'ok' if off <= close else 'DIFFERS'
            wrong += off > close
            print(f'   {name:20} {theirs:12.6g} here {here[name]:12.6g}  {off:8.1e}  {verdict}')
        if searched is None and [b['kind'] for b in row['blocks']] == ['pi', 'low-pass']:
            limits = {k: row['limits'][k] for k in ('max_sensitivity', 'max_complementary', 'noise_gain', 'control_peak')}
            searched = random_search(loop, lines, noise, limits, asked.search)
            ratio = row['linear']['residual_rad_s'] / searched
            wrong += ratio > 1.002
            print(f"   differential evolution in {asked.search:.0f} s: {searched:.6g}, Counterpoise over it {ratio:.4f}")
    print('all agree' if not wrong else f'{wrong} DISAGREEMENTS')
    sys.exit(1 if wrong else 0)


if __name__ == '__main__':
    main()
