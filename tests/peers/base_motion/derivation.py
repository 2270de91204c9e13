#!/usr/bin/env python3
"""Derives the equation of the elevation axis on a base with six degrees of freedom, and compares it with docs/theory/base-motion.md.

    python3 -m venv .venv && .venv/bin/pip install sympy
    .venv/bin/python tests/peers/base_motion/derivation.py

Lagrange's equation of a rigid body that turns about the elevation axis on a traverse ring, on a base whose position and attitude are given
functions of time (roll, pitch, yaw by Euler angles), is derived symbolically. Its angular acceleration is then compared at random motions
with the reduced form that `models/src/base_motion.rs` and the plant use: heave, surge, roll rate and yaw rate in axes that do not turn about the
elevation axis. Nothing of the product's code or derivation is used. Exits with 1 if any case differs by more than 1e-10 of its largest term.
"""
import random
import sys

import sympy as sp

CASES = 200
ALLOWED = 1e-10

t = sp.symbols("t")
names = "x y z yaw pitch roll traverse theta"
functions = [sp.Function(name)(t) for name in names.split()]
x, y, z, yaw, pitch, roll, traverse, theta = functions
M, g, cx, cn, Jb, Jn, Je = sp.symbols("M g c_b c_n J_b J_n J_e")


def about_z(a):
    return sp.Matrix([[sp.cos(a), -sp.sin(a), 0], [sp.sin(a), sp.cos(a), 0], [0, 0, 1]])


def nose_up(a):
    """Turns x towards z: the positive sense of pitch and elevation."""
    return sp.Matrix([[sp.cos(a), 0, -sp.sin(a)], [0, 1, 0], [sp.sin(a), 0, sp.cos(a)]])


def about_x(a):
    return sp.Matrix([[1, 0, 0], [0, sp.cos(a), -sp.sin(a)], [0, sp.sin(a), sp.cos(a)]])


def rate_of(R):
    """Angular velocity in the axes of R, from R' dR/dt."""
    W = R.T * R.diff(t)
    return sp.Matrix([W[2, 1], W[0, 2], W[1, 0]])


base = about_z(yaw) * nose_up(pitch) * about_x(roll)
ring = base * about_z(traverse)
body = ring * nose_up(theta)
centre = sp.Matrix([x, y, z]) + body * sp.Matrix([cx, 0, cn])
velocity = centre.diff(t)
omega = rate_of(body)
# inertia about the centre of mass, principal along the beam (x), across it to the left (y) and along its normal (z)
kinetic = M * velocity.dot(velocity) / 2 + (Jb * omega[0] ** 2 + Je * omega[1] ** 2 + Jn * omega[2] ** 2) / 2
potential = M * g * centre[2]

# numbers in place of functions: d/dt of dT/dtheta' by the chain rule over values, rates and accelerations
value = {f: sp.Symbol(f"{f.func}0") for f in functions}
first = {f: sp.Symbol(f"{f.func}1") for f in functions}
second = {f: sp.Symbol(f"{f.func}2") for f in functions}


def plain(e):
    e = e.subs({f.diff(t, 2): second[f] for f in functions})
    e = e.subs({f.diff(t): first[f] for f in functions})
    return e.subs(value)


T, V = plain(kinetic), plain(potential)
momentum = T.diff(first[theta])
left = sum(momentum.diff(value[f]) * first[f] + momentum.diff(first[f]) * second[f] for f in functions)
residual = left - T.diff(value[theta]) + V.diff(value[theta])
arguments = list(value.values()) + list(first.values()) + list(second.values()) + [M, g, cx, cn, Jb, Jn, Je]
lagrange = sp.lambdify(arguments, residual, "math")

# what the base's sensors feel: rates in axes of the base, specific force of the pivot in axes of the base
pivot = sp.Matrix([x, y, z])
ring_rate = plain(rate_of(ring))
ring_force = plain(ring.T * (pivot.diff(t, 2) + sp.Matrix([0, 0, g])))
ring_turn = plain(rate_of(ring).diff(t))
felt = sp.lambdify(arguments, [*ring_rate, *ring_force, *ring_turn], "math")


def reduced(given, phi):
    """Torque about the axis by the reduced form, for any angle phi that the axes were turned back by; and the axis' own term."""
    import math

    P, minus_Q, R, forward, _, up, _, minus_turn, _ = felt(*given)
    m, _, b, n, j_b, j_n, j_e = given[-7:]
    th, th2 = given[7], given[23]
    mu, nu = m * b, m * n
    J = j_e + m * (b * b + n * n)
    s_x = forward * math.cos(phi) - up * math.sin(phi)
    s_z = forward * math.sin(phi) + up * math.cos(phi)
    p = P * math.cos(phi) - R * math.sin(phi)
    r = P * math.sin(phi) + R * math.cos(phi)
    h = th + phi
    imbalance = mu * (s_z * math.cos(h) - s_x * math.sin(h)) - nu * (s_z * math.sin(h) + s_x * math.cos(h))
    # inertias about the pivot along the beam and along its normal, and their product
    about_beam, about_normal, product = j_b + m * n * n, j_n + m * b * b, -m * b * n
    along, across = p * math.cos(h) + r * math.sin(h), r * math.cos(h) - p * math.sin(h)
    gyroscopic = -(about_normal - about_beam) * along * across - product * (along * along - across * across)
    inertial = J * (th2 - minus_turn)
    return inertial + imbalance - gyroscopic, max(abs(inertial), abs(imbalance), abs(gyroscopic), 1e-30)


def main():
    source = random.Random(8)
    worst = 0.0
    for case in range(CASES):
        motion = [source.uniform(-1.5, 1.5) for _ in range(24)]
        masses = [source.uniform(1, 100), 9.80665, source.uniform(-2, 2), source.uniform(-0.5, 0.5)]
        inertias = [source.uniform(0.1, 20) for _ in range(3)]
        given = [*motion, *masses, *inertias]
        for phi in (0.0, source.uniform(-3, 3)):
            found, size = reduced(given, phi)
            worst = max(worst, abs(found - lagrange(*given)) / size)
    print(f"{CASES} random motions: largest difference {worst:.2e} of the largest term, allowed {ALLOWED:.0e}")
    return 0 if worst <= ALLOWED else 1


if __name__ == "__main__":
    sys.exit(main())
