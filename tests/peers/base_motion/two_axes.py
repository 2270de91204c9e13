#!/usr/bin/env python3
"""Derives the equations of a traverse ring with an elevated body on a base with six degrees of freedom, and compares the product with them.

    python3 -m venv .venv && .venv/bin/pip install sympy
    cargo build --release -p counterpoise-models --example two_axes
    .venv/bin/python tests/peers/base_motion/two_axes.py target/release/examples/two_axes

One Lagrangian: a base whose position and attitude are given functions of time (roll, pitch, yaw by Euler angles), a ring that turns about its upward
axis, and a rigid body that turns about the elevation axis on the ring, whose pivot lies off the ring's axis and whose centre of mass
lies off the pivot along the beam and along its normal, with a product of inertia. Lagrange's equations of both angles are derived
symbolically and give the torques that a motion needs. The program computes them by `models/src/two_axes.rs`. Exits with 1 if any case differs by
more than 1e-10 of the largest term.
"""
import math
import random
import subprocess
import sys

import sympy as sp

CASES = 200
ALLOWED = 1e-10

t = sp.symbols("t")
names = "x y z yaw pitch roll traverse theta"
functions = [sp.Function(name)(t) for name in names.split()]
x, y, z, yaw, pitch, roll, traverse, theta = functions
masses = sp.symbols("m1 c1x c1y c1z A C M g c_b c_n J_b J_e J_n J_bn p_f p_l")
m1, c1x, c1y, c1z, A, C, M, g, cb, cn, Jb, Je, Jn, Jbn, pf, pl = masses


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


value = {f: sp.Symbol(f"{f.func}0") for f in functions}
first = {f: sp.Symbol(f"{f.func}1") for f in functions}
second = {f: sp.Symbol(f"{f.func}2") for f in functions}


def plain(e):
    """Puts symbols in place of functions of time and their derivatives."""
    e = e.subs({f.diff(t, 2): second[f] for f in functions})
    e = e.subs({f.diff(t): first[f] for f in functions})
    return e.subs(value)


base = about_z(yaw) * nose_up(pitch) * about_x(roll)
ring = base * about_z(traverse)
body = ring * nose_up(theta)
origin = sp.Matrix([x, y, z])
ring_rate, body_rate = rate_of(ring), rate_of(body)

# The ring: with a mass M at the pivot it is symmetric about its axis, moments A, A and C about the origin.
pivot_in_ring = sp.Matrix([pf, pl, 0])
point = M * (pivot_in_ring.dot(pivot_in_ring) * sp.eye(3) - pivot_in_ring * pivot_in_ring.T)
about_origin = sp.diag(A, A, C) - point
centre_in_ring = sp.Matrix([c1x, c1y, c1z])
about_centre = about_origin - m1 * (
    centre_in_ring.dot(centre_in_ring) * sp.eye(3) - centre_in_ring * centre_in_ring.T
)
ring_centre = origin + ring * centre_in_ring
# The elevated body: J about its centre of mass along the beam, to the left, and along the normal; J_bn is the integral of beam times normal.
body_centre = origin + ring * pivot_in_ring + body * sp.Matrix([cb, 0, cn])
inertia = sp.Matrix([[Jb, 0, -Jbn], [0, Je, 0], [-Jbn, 0, Jn]])


def kinetic(mass, centre, rate, tensor):
    v = centre.diff(t)
    return plain(mass * v.dot(v) / 2 + (rate.T * tensor * rate)[0] / 2)


T = kinetic(m1, ring_centre, ring_rate, about_centre) + kinetic(M, body_centre, body_rate, inertia)
V = plain(m1 * g * ring_centre[2] + M * g * body_centre[2])


def lagrange(coordinate):
    """The generalised force that a motion needs: d/dt of dT/dq' by the chain rule, less dT/dq, plus dV/dq."""
    momentum = T.diff(first[coordinate])
    slope = sum(momentum.diff(value[f]) * first[f] + momentum.diff(first[f]) * second[f] for f in functions)
    return slope - T.diff(value[coordinate]) + V.diff(value[coordinate])


arguments = [*value.values(), *first.values(), *second.values(), *masses]
needed = sp.lambdify(arguments, [lagrange(theta), lagrange(traverse)], "math", cse=True)
felt = sp.lambdify(
    arguments,
    [*plain(ring.T * (origin.diff(t, 2) + sp.Matrix([0, 0, g]))), *plain(ring_rate), *plain(ring_rate.diff(t))],
    "math",
    cse=True,
)


def case(source):
    """Returns a random motion with random masses, and the line that the product reads of it."""
    motion = [source.uniform(-1.5, 1.5) for _ in range(24)]
    ring_masses = [source.uniform(10, 200), *[source.uniform(-0.5, 0.5) for _ in range(3)]]
    inertias = [source.uniform(50, 200), source.uniform(50, 200)]
    m, b, n = source.uniform(1, 100), source.uniform(-2, 2), source.uniform(-0.5, 0.5)
    own = [source.uniform(0.1, 20), source.uniform(0.1, 20), source.uniform(0.1, 20), source.uniform(-5, 5)]
    at = [source.uniform(-1, 1), source.uniform(-1, 1)]
    given = [*motion, *ring_masses, *inertias, m, 9.80665, b, n, own[0], own[1], own[2], own[3], *at]
    # at the pivot
    mu, nu = m * b, m * n
    about_beam, about_normal = own[0] + m * n * n, own[2] + m * b * b
    about_axis, product = own[1] + m * (b * b + n * n), own[3] + m * b * n
    included = source.uniform(-1, 1)
    s, c = math.sin(included), math.cos(included)
    forward_moment = mu * c - nu * s
    inertia = inertias[1] + about_beam * s * s + about_normal * c * c - 2 * product * s * c
    inertia += 2 * at[0] * forward_moment
    first_forward = ring_masses[0] * ring_masses[1] + m * at[0] + forward_moment
    first_left = ring_masses[0] * ring_masses[2] + m * at[1]
    seen = felt(*given)
    forces, rates, turns = seen[:3], seen[3:6], seen[6:]
    # the elevation axis points to the right: Q = -(rate to the left)
    rate, turn = motion[15] - rates[1], motion[23] - turns[1]
    line = [mu, nu, about_axis, about_beam, about_normal, product, *at, included]
    line += [*forces, *rates, *turns, motion[7], rate, turn, inertia, first_forward, first_left]
    return given, line


def main(program):
    source = random.Random(22)
    cases = [case(source) for _ in range(CASES)]
    text = "\n".join(" ".join(repr(float(v)) for v in line) for _, line in cases)
    answer = subprocess.run([program], input=text, capture_output=True, text=True, check=True).stdout
    found = [[float(word) for word in line.split()] for line in answer.splitlines()]
    assert len(found) == CASES
    worst = [0.0, 0.0]
    for (given, line), torques in zip(cases, found):
        size = [
            abs(line[2] * line[20]) + abs(line[0] * 9.80665),
            abs(line[21] * line[17]) + abs(line[22] * line[10]) + abs(line[2] * line[20]),
        ]
        for axis, expected in enumerate(needed(*given)):
            worst[axis] = max(worst[axis], abs(torques[axis] - expected) / size[axis])
    print(f"{CASES} random motions: largest difference about the elevation axis {worst[0]:.1e}, about the traverse axis {worst[1]:.1e}")
    print(f"of the largest terms, allowed {ALLOWED:.0e}")
    return 0 if max(worst) <= ALLOWED else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
