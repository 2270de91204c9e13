#!/usr/bin/env python3
"""Solves Lagrange's equations of two axes with both loops closed, and compares the product's simulation with them.

    python3 -m venv .venv && .venv/bin/pip install sympy numpy scipy
    cargo build --release -p counterpoise-simulate --example two_axes_loops
    .venv/bin/python tests/peers/base_motion/two_axes_loops.py target/release/examples/two_axes_loops

The equations are those that `two_axes.py` derives. The base moves about and along all its axes by sines of its position and of its Euler angles. Both
axes have viscous friction, a sampled proportional-integral controller and steps of their demands; the gyroscope of the traverse axis is on
the elevated mass. SciPy's eighth-order Runge-Kutta method takes each sample. Exits with 1 if a rate differs by more than 1e-4 of the largest.
"""
import math
import subprocess
import sys

import numpy as np
from scipy.integrate import solve_ivp

import two_axes as lagrangian

PERIOD_S, DURATION_S, BASE_PERIOD_S = 1e-3, 5.0, 2.5e-4
ALLOWED = 1e-4
NM_PER_V = 30.0 * 0.86
# position x, y, z and Euler angles yaw, pitch, roll: amplitude, rate, phase
SINES = [
    (0.05, 5.0, 0.3),
    (0.04, 6.0, 1.0),
    (0.02, 8.0, 2.0),
    (0.10, 2.0, 0.5),
    (0.08, 4.0, 1.5),
    (0.12, 3.0, 2.5),
]
# ring: m1, c1, A, C; body: M, g, c, J about the centre of mass, pivot: so that the sums are those of simulate/examples/two_axes_loops.rs
M, MU, NU = 5.0, 1.5, 0.4
ABOUT_AXIS, ABOUT_BEAM, ABOUT_NORMAL, PRODUCT = 12.0, 2.0, 13.0, 0.7
FORWARD, LEFT, INCLUDED = 0.4, -0.6, 0.2
s0, c0 = math.sin(INCLUDED), math.cos(INCLUDED)
FORWARD_MOMENT = MU * c0 - NU * s0
BODY = ABOUT_BEAM * s0**2 + ABOUT_NORMAL * c0**2 - 2 * PRODUCT * s0 * c0 + 2 * FORWARD * FORWARD_MOMENT
RING_MASS = 20.0
RING_CENTRE = [(2.5 - M * FORWARD - FORWARD_MOMENT) / RING_MASS, (-0.6 - M * LEFT) / RING_MASS, 0.1]
b, n = MU / M, NU / M
MASSES = [RING_MASS, *RING_CENTRE, 20.0, 30.0 - BODY, M, 9.80665, b, n]
MASSES += [ABOUT_BEAM - M * n * n, ABOUT_AXIS - M * (b * b + n * n), ABOUT_NORMAL - M * b * b, PRODUCT - M * b * n]
MASSES += [FORWARD, LEFT]
VISCOUS = [2.0, 3.0]
GAINS = [(8.0, 40.0), (20.0, 100.0)]


def base(t):
    """Values, rates and accelerations of the base's coordinates, the first two angles turned so that it starts level."""
    values = [a * math.sin(w * t + p) for a, w, p in SINES]
    rates = [a * w * math.cos(w * t + p) for a, w, p in SINES]
    turns = [-a * w * w * math.sin(w * t + p) for a, w, p in SINES]
    return values, rates, turns


def arguments(t, q, dq, ddq):
    """Arguments of the Lagrangian's functions: traverse and elevation after the base's coordinates."""
    values, rates, turns = base(t)
    return [*values, *q, *rates, *dq, *turns, *ddq, *MASSES]


def felt(t, traverse=(0.0, 0.0, 0.0)):
    angle, rate, turn = traverse
    return lagrangian.felt(*arguments(t, (angle, 0.0), (rate, 0.0), (turn, 0.0)))


def torques(t, q, dq, ddq):
    elevation, traverse = lagrangian.needed(*arguments(t, q, dq, ddq))
    return np.array([traverse, elevation])


def slope(t, x, drive):
    q, dq = x[:2], x[2:]
    rest = torques(t, q, dq, (0.0, 0.0))
    mass = np.column_stack([torques(t, q, dq, unit) - rest for unit in ((1.0, 0.0), (0.0, 1.0))])
    friction = np.array([VISCOUS[1] * dq[0], VISCOUS[0] * dq[1]])
    return [*dq, *np.linalg.solve(mass, np.array(drive) - friction - rest)]


def demand(t):
    after = t + 1e-9
    elevation = -0.2 if after >= 2.0 else 0.3 if after >= 0.5 else 0.0
    traverse = 0.5 if after >= 3.0 else -0.4 if after >= 1.0 else 0.0
    return elevation, traverse


def solve():
    """Rates of the elevation axis and of the ring, and the elevation, at the samples."""
    start = felt(0.0)
    # at rest: the ring's rate is the base's yaw, so it does not turn on the base; the elevated body's rate is the ring's about the elevation axis
    pitch_on_ring = felt(0.0, (0.5, 0.0, 0.0))[4]
    x = np.array([0.5, 0.3, 0.0, 0.0])
    assert abs(start[5] - felt(0.0, (0.5, 0.0, 0.0))[5]) < 1e-12 and math.isfinite(pitch_on_ring)
    integrals, rows = [0.0, 0.0], []
    for k in range(int(round(DURATION_S / PERIOD_S))):
        t = k * PERIOD_S
        ring = felt(t, (x[0], x[2], 0.0))
        roll, left, up = ring[3:6]
        elevation = x[3] - left
        cross = up * math.cos(x[1]) - roll * math.sin(x[1])
        rows.append((elevation, up, x[1]))
        drive = []
        for axis, (reading, wanted) in enumerate(zip((elevation, cross), demand(t))):
            error = wanted - reading
            volts = GAINS[axis][0] * error + integrals[axis]
            integrals[axis] += GAINS[axis][1] * PERIOD_S * error
            drive.append(NM_PER_V * max(-10.0, min(10.0, volts)))
        found = solve_ivp(
            slope, (t, t + PERIOD_S), x, method="DOP853", rtol=1e-10, atol=1e-12, args=((drive[1], drive[0]),)
        )
        x = found.y[:, -1]
    return np.array(rows)


def main(program):
    samples = int(round(DURATION_S / BASE_PERIOD_S)) + 5
    rows = [felt(k * BASE_PERIOD_S)[:6] for k in range(samples)]
    text = f"{BASE_PERIOD_S}\n" + "\n".join(" ".join(repr(float(v)) for v in row) for row in rows)
    answer = subprocess.run([program], input=text, capture_output=True, text=True, check=True).stdout
    found = np.array([[float(word) for word in line.split()] for line in answer.splitlines()])[:, 1:]
    expected = solve()
    worst = 0.0
    # the elevation is that relative to the ring; the product's axis starts at an inertial angle of 0.3 with its platform level
    for column, name in enumerate(["elevation rate", "ring rate", "elevation"]):
        size = np.abs(expected[:, column]).max()
        off = np.abs(found[:, column] - expected[:, column]).max() / size
        worst = max(worst, off)
        print(f"{name}: largest {size:.3f}, difference {off:.1e} of it")
    print(f"allowed {ALLOWED:.0e}")
    return 0 if worst <= ALLOWED else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
