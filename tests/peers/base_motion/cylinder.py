#!/usr/bin/env python3
"""A hydraulic cylinder by an independent simulation: the machine of a small project under the control that holds it, on a moving base.

    python3 -m venv .venv && .venv/bin/pip install numpy scipy
    .venv/bin/python tests/peers/base_motion/cylinder.py target/release/counterpoise

It writes a project, lets the program run its verification, and takes the run without control. The equations of the section on the cylinder in
docs/theory/loads.md are written here anew, in SI units, with the pins of the cylinder as vectors, and solved by SciPy (Radau, an implicit method for stiff
equations). Exits with 1 if a hub rate differs by more than
1e-4 of the largest, or if the volume of oil that flows in is not what is displaced, compressed and leaks.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

TOLERANCE = 1e-4
PI = np.pi
G = 9.80665
J, MU, VISCOUS = 900.0, 420.0, 300.0
OIL = dict(area=2.5e-3, supply=1.6e7, volume=1.5e-3, bulk=7.5e8, leakage=6e-12, flow=7e-4, drop=7e6, control=10.0, frequency=380.0, damping=0.75, overlap=0.04)
PINS = dict(arm=0.45, arm_angle=-0.25, anchor=1.1, anchor_angle=-1.75)
SEALS = dict(viscous=1500.0)
HEAVE, PITCH = (1.2, 1.5), (0.06, 0.8)
LAMINAR = 1e-4

PROJECT = """format = 2
[plant]
name = "cylinder"
[plant.lumped]
hub_inertia = {J}
out_of_balance = {MU}
[plant.friction.pivot]
viscous = {VISCOUS}
[plant.friction.motor]
viscous = {viscous}
[plant.cylinder]
area = {area}
supply_pressure = {supply}
volume = {volume}
bulk_modulus = {bulk}
leakage = {leakage}
rated_flow = {flow}
rated_pressure_drop = {drop}
rated_control = {control}
valve_frequency = {frequency}
valve_damping = {damping}
overlap = {overlap}
[plant.cylinder.linkage]
arm = {arm}
arm_angle = {arm_angle}
anchor = {anchor}
anchor_angle = {anchor_angle}
[plant.interface]
sample_period = 1e-3
[verify]
duration = 5.0
[verify.heave]
amplitude = {heave}
frequency = {heave_hz}
[verify.pitch]
amplitude = {pitch}
frequency = {pitch_hz}
"""


def pins(angle):
    """Length of the cylinder, and its lever: the arm crossed with the unit vector along the cylinder, pushing."""
    on_mass = PINS["arm"] * np.array([np.cos(angle + PINS["arm_angle"]), np.sin(angle + PINS["arm_angle"])])
    on_base = PINS["anchor"] * np.array([np.cos(PINS["anchor_angle"]), np.sin(PINS["anchor_angle"])])
    way = on_mass - on_base
    length = np.hypot(*way)
    return length, (on_mass[0] * way[1] - on_mass[1] * way[0]) / length


def flow(opening, pressure):
    """Flow through the valve, m^3/s, at an opening as a share of the full one: of its rated flow at its rated pressure drop beyond the overlap."""
    sense = np.sign(opening)
    beyond = max(abs(opening) - OIL["overlap"], 0.0) / (1.0 - OIL["overlap"])
    left = OIL["supply"] - sense * pressure
    root = left / np.sqrt(OIL["drop"] * max(abs(left), LAMINAR * OIL["supply"]))
    return sense * beyond * OIL["flow"] * root


def held():
    pressure = MU * G / (OIL["area"] * pins(0.0)[1])
    leak = OIL["leakage"] * pressure
    opening = brentq(lambda o: flow(o, pressure) - leak, 0.0, 1.0, xtol=1e-15)
    return pressure, opening


def simulated(times):
    pressure, opening = held()
    w, d = OIL["frequency"], OIL["damping"]

    def slope(t, x):
        angle, rate, base, p, o, o_rate, inflow, leaked = x
        heave = HEAVE[0] * np.sin(2 * PI * HEAVE[1] * t)
        pitch = PITCH[0] * np.sin(2 * PI * PITCH[1] * t)
        lever = pins(angle - base)[1]
        piston = lever * (rate - pitch)
        q = flow(o, p)
        force = OIL["area"] * p - SEALS["viscous"] * piston
        torque = lever * force - VISCOUS * (rate - pitch) - MU * (G + heave) * np.cos(angle)
        compression = 4.0 * OIL["bulk"] / OIL["volume"]
        dp = compression * (q - OIL["leakage"] * p - OIL["area"] * piston)
        return [rate, torque / J, pitch, dp, o_rate, w * w * (opening - o) - 2 * d * w * o_rate, q, OIL["leakage"] * p]

    start = [0.0, 0.0, 0.0, pressure, opening, 0.0, 0.0, 0.0]
    scale = np.array([1e-9, 1e-9, 1e-10, 1e-2, 1e-10, 1e-8, 1e-14, 1e-14])
    return solve_ivp(slope, (0.0, times[-1]), start, method="Radau", t_eval=times, rtol=1e-9, atol=scale, max_step=2e-3).y


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        project, result = pathlib.Path(folder) / "project.toml", pathlib.Path(folder) / "result.json"
        project.write_text(PROJECT.format(J=J, MU=MU, VISCOUS=VISCOUS, heave=HEAVE[0], heave_hz=HEAVE[1], pitch=PITCH[0], pitch_hz=PITCH[1], **SEALS, **OIL, **PINS))
        done = subprocess.run([program, "verify", project, "--histories", f"--json={result}", "--quiet"], capture_output=True, text=True)
        if not result.exists():
            sys.exit(done.stderr)
        histories = json.loads(result.read_text())["histories"]
    history = next(one for one in histories if one["name"] == "nonlinear_both_uncontrolled")
    rates = np.array(history["hub_rate_rad_s"])
    times = history["sample_time_s"] * np.arange(len(rates))
    other = simulated(times)
    largest = np.abs(other[1]).max()
    apart = np.abs(rates - other[1]).max() / largest
    displaced = OIL["area"] * (pins(other[0, -1] - other[2, -1])[0] - pins(0.0)[0])
    compressed = OIL["volume"] / (4.0 * OIL["bulk"]) * (other[3, -1] - other[3, 0])
    lost = abs(other[6, -1] - displaced - compressed - other[7, -1]) / abs(other[7, -1])
    swing = other[3].max() - other[3].min()
    levers = [pins(angle)[1] for angle in (np.min(other[0] - other[2]), np.max(other[0] - other[2]))]
    print(f"largest rate {largest:.4f} rad/s, largest difference {apart:.1e} of it; pressure swings by {swing / 1e6:.2f} MPa; lever {levers[0]:.4f} to {levers[1]:.4f} m")
    print(f"oil that is neither displaced nor compressed nor leaks: {lost:.1e} of the leakage")
    good = apart <= TOLERANCE and lost <= 1e-6
    print("agrees" if good else "DIFFERS")
    sys.exit(not good)


main()
