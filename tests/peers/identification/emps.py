#!/usr/bin/env python3
"""EMPS by a grey-box fit with SciPy, under the published law of the real controller: the rival of `counterpoise diagnose`.

    python3 tests/peers/identification/emps.py FOLDER    # with estimation.parquet and pulses.parquet

Every model is fitted to `estimation` and judged on `pulses`: RMS of the residual of the control over the RMS of the control, and RMS of
the residual of the position. Models: rigid mass with (1) the published parameters, (2) symmetric friction, (3) friction that depends on the
direction, (4) that with a drive lag and a Coulomb friction that is rounded at low rates, (5) that with a Stribeck term of either sign.
"""
import math
import sys
import time

import numpy as np
import pandas as pd
from scipy.optimize import least_squares

KP, KV, PERIOD, FORCE = 160.18, 243.45, 1e-3, 35.15
STEPS = 4
# The recorded pulses are 5 V in their column and 5.0685 V in the control: the largest part of what the law leaves.
PULSE = 1.0137
NAMES = ["mass", "viscous_plus", "viscous_minus", "coulomb_plus", "coulomb_minus", "offset", "rounding", "lag", "stribeck", "stribeck_rate"]
PUBLISHED = dict(mass=95.109, viscous_plus=203.5, viscous_minus=203.5, coulomb_plus=20.394, coulomb_minus=20.394, offset=-3.165,
                 rounding=1e-4, lag=0.0, stribeck=0.0, stribeck_rate=1e-2)


def read(folder, name):
    table = pd.read_parquet(f"{folder}/{name}.parquet")
    return [table[c].to_numpy(float) for c in ("reference [m]", "position [m]", "control [V]", "pulse [V]")]


def simulate(p, data):
    reference, position, control, pulse = data
    h = PERIOD / STEPS
    q, v, drive = position[0], (position[4] - position[0]) / (4 * PERIOD), FORCE * control[0]
    before = [q - PERIOD * v, q - 2 * PERIOD * v]
    share = 1.0 if p["lag"] <= 0 else 1.0 - math.exp(-h / p["lag"])
    mass, offset, rounding = p["mass"], p["offset"], abs(p["rounding"]) + 1e-9
    out_q, out_u = np.empty(len(reference)), np.empty(len(reference))
    for k in range(len(reference)):
        u = KP * KV * (reference[k] - q) - KV * (q - before[1]) / (2 * PERIOD) + PULSE * pulse[k]
        u = min(10.0, max(-10.0, u))
        out_q[k], out_u[k] = q, u
        before = [q, before[0]]
        for _ in range(STEPS):
            drive += share * (FORCE * u - drive)
            side = "plus" if v > 0 else "minus"
            level = p[f"coulomb_{side}"] + p["stribeck"] * math.exp(-(v / p["stribeck_rate"]) ** 2)
            # the friction's slope is taken implicitly: it is steep at rest
            tanh = math.tanh(v / rounding)
            slope = level * (1 - tanh * tanh) / rounding + p[f"viscous_{side}"]
            v += h * (drive - level * tanh - p[f"viscous_{side}"] * v - offset) / (mass + h * slope)
            q += h * v
    return out_q, out_u


def errors(p, data):
    q, u = simulate(p, data)
    relative = 100 * np.linalg.norm(u - data[2]) / np.linalg.norm(data[2])
    return relative, 1e6 * float(np.sqrt(np.mean((q - data[1]) ** 2)))


def fitted(start, free, data):
    size = np.array([abs(start[n]) or 1e-3 for n in free])

    def model(x):
        p = dict(start)
        p.update({n: float(v * s) for n, v, s in zip(free, x, size)})
        for side in ("viscous", "coulomb"):
            if f"{side}_minus" not in free:
                p[f"{side}_minus"] = p[f"{side}_plus"]
        return p

    x0 = np.array([start[n] for n in free]) / size
    found = least_squares(lambda x: simulate(model(x), data)[1] - data[2], x0, diff_step=1e-3, max_nfev=25)
    return model(found.x)


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else "../shared/recordings/real/emps"
    estimation, pulses = read(folder, "estimation"), read(folder, "pulses")
    both = ["viscous_plus", "viscous_minus", "coulomb_plus", "coulomb_minus", "offset"]
    models = [
        ("published", [], {}),
        ("symmetric", ["mass", "viscous_plus", "coulomb_plus", "offset"], {}),
        ("by direction", ["mass"] + both, {}),
        ("and rounded, with a lag", ["mass"] + both + ["rounding", "lag"], dict(rounding=2e-3, lag=3e-4)),
        ("and Stribeck", ["mass"] + both + ["rounding", "lag", "stribeck", "stribeck_rate"], dict(stribeck=-3.0)),
    ]
    start = dict(PUBLISHED)
    print(f"{'model':<26} {'fitted: control':>16} {'held out: control':>18} {'held out: position':>20} {'time':>8}")
    for name, free, new in models:
        clock = time.time()
        start.update(new)
        start = fitted(start, free, estimation) if free else start
        (own, _), (held, place) = errors(start, estimation), errors(start, pulses)
        print(f"{name:<26} {own:14.2f} % {held:16.2f} % {place:17.1f} um {time.time() - clock:6.0f} s", flush=True)
        print("   ", ", ".join(f"{n} {start[n]:.5g}" for n in free), flush=True)


if __name__ == "__main__":
    main()
