#!/usr/bin/env python3
"""Grey-box fits with SciPy by hand of three real machines, in the figures of docs/evidence/real-machines.md: the rival of the product.

    python3 tests/peers/identification/machines.py FOLDER [flexible-link] [two-mass] [cogging]

FOLDER holds the recordings as examples/real-recordings describes them. Every model is fitted to the first window (or file) and judged on the
held-out one by the variance accounted for, open loop, from a start that the first moments of the window give.
"""
import math
import sys
import time

import numpy as np
import pandas as pd
from scipy.optimize import least_squares


def vaf(made, measured):
    return 100 * (1 - np.var(made - measured) / np.var(measured))


def slope(x, half, period):
    """The slope as the project files take it: the central difference over 2 half samples."""
    k = np.arange(len(x))
    low, high = np.maximum(k - half, 0), np.minimum(k + half, len(x) - 1)
    return (x[high] - x[low]) / ((high - low) * period)


def two_inertias(p, current, start, period, steps):
    """Motor and load with a spring between them; dry friction as tanh, implicit; returns both rates."""
    j1, j2, spring, damp, gain, offset = (p[n] for n in ("j1", "j2", "spring", "damping", "gain", "offset"))
    twist, w1, w2 = start
    h = period / steps
    out = np.empty((2, len(current)))
    for k, i in enumerate(current):
        out[0, k], out[1, k] = w1, w2
        for _ in range(steps):
            t1, t2 = math.tanh(w1 / p["rounding"]), math.tanh(w2 / p["rounding"])
            mesh = spring * twist + damp * (w1 - w2)
            s1 = p["dry1"] * (1 - t1 * t1) / p["rounding"] + p["viscous1"]
            s2 = p["dry2"] * (1 - t2 * t2) / p["rounding"] + p["viscous2"]
            w1 += h * (gain * i + offset - mesh - p["dry1"] * t1 - p["viscous1"] * w1) / (j1 + h * s1)
            w2 += h * (mesh - p["dry2"] * t2 - p["viscous2"] * w2) / (j2 + h * s2)
            twist += h * (w1 - w2)
    return out


def fit_two_inertias(name, start, free, fitted, held, period, steps):
    current, rates = fitted
    size = np.array([abs(start[n]) or 1e-3 for n in free])
    scale = rates.std(axis=1)

    def model(x):
        p = dict(start)
        p.update({n: abs(v * s) if n != "offset" else v * s for n, v, s in zip(free, x, size)})
        return p

    def run(p, data, twist):
        return two_inertias(p, data[0], (twist, data[1][0, :3].mean(), data[1][1, :3].mean()), period, steps)

    def residual(x):
        made = run(model(x[:-1]), fitted, x[-1] * 1e-3)
        return ((made - rates) / scale[:, None]).ravel()

    clock = time.time()
    x0 = np.append(np.array([start[n] for n in free]) / size, 0.0)
    found = least_squares(residual, x0, diff_step=1e-3, max_nfev=25)
    p = model(found.x[:-1])
    # of the held-out window the twist at the start is fitted alone
    first = (held[0][: len(held[0]) // 20], held[1][:, : len(held[0]) // 20])
    twist = least_squares(lambda t: ((run(p, first, t[0] * 1e-3) - first[1]) / scale[:, None]).ravel(), [0.0]).x[0] * 1e-3
    made = run(p, held, twist)
    print(f"{name}: motor rate {vaf(made[0], held[1][0]):.1f} %, load rate {vaf(made[1], held[1][1]):.1f} % of the held-out variance, "
          f"{time.time() - clock:.0f} s; {', '.join(f'{n} {p[n]:.4g}' for n in free)}", flush=True)


def flexible_link(folder):
    table = pd.read_parquet(f"{folder}/flexible-link/lqr.parquet")
    t = table["time [s]"].to_numpy() - table["time [s]"].iloc[0]
    keep = slice(None, None, 2)  # 4 ms, as the project file
    angle = np.deg2rad(table["th1 [deg]"].to_numpy()[keep])
    link = angle + np.deg2rad(table["defl1 [deg]"].to_numpy()[keep])
    current = table["I1_meas [A]"].to_numpy()
    current = 0.5 * (current[keep] + current[1::2])
    rates = np.array([slope(angle, 2, 4e-3), slope(link, 2, 4e-3)])
    part = lambda a, b: (current[int(a / 4e-3):int(b / 4e-3)], rates[:, int(a / 4e-3):int(b / 4e-3)])
    start = dict(j1=0.0635, j2=0.1704, spring=39.96, damping=1.0, gain=8.925, offset=0.0, dry1=1.0, dry2=0.0, viscous1=4.0, viscous2=0.0, rounding=2e-2)
    fit_two_inertias("flexible link", start, ["j1", "j2", "spring", "damping", "offset", "dry1", "viscous1", "rounding"],
                     part(2.8, 8.8), part(9.0, 19.0), 4e-3, 4)
    del t


def two_mass(folder):
    table = pd.read_parquet(f"{folder}/two-mass/multisine.parquet")
    motor, load = table["motor_angle [rad]"].to_numpy(), -table["load_angle [rad]"].to_numpy()
    current = table["current [A]"].to_numpy()
    rates = np.array([slope(motor, 1, 4e-4), slope(load, 1, 4e-4)])
    part = lambda a, b: (current[int(a / 4e-4):int(b / 4e-4)], rates[:, int(a / 4e-4):int(b / 4e-4)])
    start = dict(j1=4.3e-3, j2=4.8e-3, spring=532.0, damping=0.03, gain=1.0, offset=0.0, dry1=0.05, dry2=0.05, viscous1=0.02, viscous2=0.02, rounding=0.1)
    fit_two_inertias("two masses", start, ["j1", "j2", "spring", "damping", "offset", "dry1", "dry2", "viscous1", "viscous2"],
                     part(2.0, 4.0), part(12.0, 14.0), 4e-4, 2)


def cogging(folder):
    def read(name):
        table = pd.read_parquet(f"{folder}/cogging/{name}.parquet")
        t, current = table["time [s]"].to_numpy(), table["current [A]"].to_numpy()
        counts = table["position [count]"].to_numpy()
        counts = counts - 8192 * np.concatenate([[0], np.cumsum(np.round(np.diff(counts) / 8192))])
        use = (t > t[0] + 1.2) & (t < t[0] + 9.7)
        return 2 * np.pi * counts[use] / 8192, current[use], t[use]

    def rows(angle, t, orders):
        rate = slope(angle, 4, float(np.median(np.diff(t))))
        return np.column_stack([np.ones_like(angle), np.tanh(rate / 0.02), rate]
                               + [f(n * angle) for n in orders for f in (np.sin, np.cos)])

    clock = time.time()
    angle, current, t = read("nocomp_0")
    chosen = []
    for _ in range(6):  # greedy selection of orders from 1 to 60
        left = lambda n: np.linalg.lstsq(rows(angle, t, chosen + [n]), current, rcond=None)[1].sum()
        chosen.append(min((n for n in range(1, 61) if n not in chosen), key=left))
        weights = np.linalg.lstsq(rows(angle, t, chosen), current, rcond=None)[0]
        held = {name: vaf(rows(a, s, chosen) @ weights, i) for name in ("nocomp_1", "comp_0", "comp_1") for a, i, s in [read(name)]}
        print(f"brushless motor, orders {chosen}: " + ", ".join(f"{n} {v:.1f} %" for n, v in held.items()) + f", {time.time() - clock:.1f} s", flush=True)


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else "../shared/recordings/real"
    wanted = sys.argv[2:] or ["flexible-link", "two-mass", "cogging"]
    for name, run in (("flexible-link", flexible_link), ("two-mass", two_mass), ("cogging", cogging)):
        if name in wanted:
            run(folder)


if __name__ == "__main__":
    main()
