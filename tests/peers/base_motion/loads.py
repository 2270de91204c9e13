#!/usr/bin/env python3
"""Equilibrator, stops and recoil by an independent simulation: the machine of a small project under its holding torque, on a moving base.

    python3 -m venv .venv && .venv/bin/pip install numpy scipy
    .venv/bin/python tests/peers/base_motion/loads.py target/release/counterpoise

For a spring and for a gas it writes a project, lets the program run its verification, and takes the run without control. The equations of
docs/theory/loads.md are written here anew and solved by SciPy (DOP853); the recoil is solved as a differential equation of the recoiling mass under the
force of the shot and that of the recoil system, not by its closed form. Exits with 1 if a hub rate differs by more than 2e-5 of the largest.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from scipy.integrate import solve_ivp

TOLERANCE = 2e-5
PI = np.pi
G = 9.80665
J, MU, VISCOUS = 40.0, 60.0, 15.0
STOPS = dict(lower=-0.05, upper=0.08, stiffness=4e4, dissipation=1.2)
SHOT = dict(times=[1.5, 3.2], impulse=300.0, shot_time=0.02, mass=30.0, length=0.3, run_out=0.5, height=0.05, offset=0.02, ahead=0.6)
HEAVE, PITCH = (1.0, 1.5), (0.05, 0.8)
PINS = dict(arm=0.35, arm_angle=0.2, anchor=0.8, anchor_angle=1.6)
FORCES = {
    "spring": 'kind = "spring"\nstiffness = 3000.0\nfree_length = 0.4\n',
    "gas": 'kind = "gas"\npressure = 1.6e6\narea = 1e-3\nvolume = 3e-3\ncharge_length = 0.75\nexponent = 1.3\n'
    "charge_temperature = 293.15\ntemperature = 263.15\n",
}

PROJECT = """format = 1
[plant]
name = "loads"
[plant.lumped]
hub_inertia = {J}
out_of_balance = {MU}
[plant.friction.pivot]
viscous = {VISCOUS}
[plant.equilibrator]
arm = {arm}
arm_angle = {arm_angle}
anchor = {anchor}
anchor_angle = {anchor_angle}
{force}
[plant.end_stops]
lower = {lower}
upper = {upper}
stiffness = {stiffness}
dissipation = {dissipation}
[plant.recoil]
shots = {times}
impulse = {impulse}
shot_time = {shot_time}
mass = {mass}
length = {length}
run_out = {run_out}
height = {height}
bore_offset = {offset}
ahead = {ahead}
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


def tension(kind, length):
    if kind == "spring":
        return 3000.0 * max(length - 0.4, 0.0)
    volume = 3e-3 - 1e-3 * (length - 0.75)
    return 1e-3 * (1.6e6 * 263.15 / 293.15 * (3e-3 / volume) ** 1.3 - 101325.0)


def lifting(kind, angle):
    """Moment of the tension: the arm crossed with the unit vector from pin to pin."""
    on_mass = PINS["arm"] * np.array([np.cos(angle + PINS["arm_angle"]), np.sin(angle + PINS["arm_angle"])])
    on_base = PINS["anchor"] * np.array([np.cos(PINS["anchor_angle"]), np.sin(PINS["anchor_angle"])])
    way = on_base - on_mass
    length = np.hypot(*way)
    force = tension(kind, length) * way / length
    return on_mass[0] * force[1] - on_mass[1] * force[0]


def stop(angle, rate):
    if angle > STOPS["upper"]:
        depth, into, sense = angle - STOPS["upper"], rate, -1.0
    elif angle < STOPS["lower"]:
        depth, into, sense = STOPS["lower"] - angle, -rate, 1.0
    else:
        return 0.0
    return sense * max(STOPS["stiffness"] * depth * (1.0 + STOPS["dissipation"] * into), 0.0)


def shot_forces(since):
    """The force of the shot and that of the recoil system at a time after a shot."""
    d = SHOT["shot_time"]
    s = 2.0 * SHOT["mass"] * SHOT["length"] / SHOT["impulse"] - d
    if 0.0 <= since < d:
        return SHOT["impulse"] * PI / (2.0 * d) * np.sin(PI * since / d), 0.0
    if 0.0 <= since - d < s:
        return 0.0, SHOT["impulse"] * PI / (2.0 * s) * np.sin(PI * (since - d) / s)
    z = (since - d - s) / SHOT["run_out"]
    if 0.0 <= z < 1.0:
        return 0.0, SHOT["mass"] * SHOT["length"] / SHOT["run_out"] ** 2 * (60 * z - 180 * z**2 + 120 * z**3)
    return 0.0, 0.0


def simulated(kind, times):
    def forces(t):
        shots = [shot_forces(t - at) for at in SHOT["times"] if t > at]
        return shots[-1] if shots else (0.0, 0.0)

    hold = MU * G - lifting(kind, 0.0)

    def slope(t, x):
        angle, rate, base, way, way_rate = x
        heave = HEAVE[0] * np.sin(2 * PI * HEAVE[1] * t)
        pitch = PITCH[0] * np.sin(2 * PI * PITCH[1] * t)
        load = (G + heave) * np.cos(angle)
        shot, cradle = forces(t)
        m = SHOT["mass"]
        recoil = SHOT["height"] * cradle + SHOT["offset"] * shot + m * way * load + 2 * m * (SHOT["ahead"] - way) * way_rate * rate
        torque = hold - MU * load + lifting(kind, angle - base) + stop(angle - base, rate - pitch) - VISCOUS * (rate - pitch) + recoil
        return [rate, torque / J, pitch, way_rate, (shot - cradle) / m]

    # the forces have corners: the solver is stopped at each of them
    d = SHOT["shot_time"]
    s = 2.0 * SHOT["mass"] * SHOT["length"] / SHOT["impulse"] - d
    corners = sorted({0.0, times[-1], *(at + part for at in SHOT["times"] for part in (0.0, d, d + s, d + s + SHOT["run_out"]))})
    x, rates = [0.0, 0.0, 0.0, 0.0, 0.0], np.zeros(len(times))
    for low, high in zip(corners, corners[1:]):
        inside = (times >= low) & (times <= high)
        found = solve_ivp(slope, (low, high), x, method="DOP853", rtol=1e-11, atol=1e-12, max_step=1e-3, dense_output=True)
        rates[inside] = found.sol(times[inside])[1]
        x = found.y[:, -1]
    return rates, x


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    worst = 0.0
    for kind, force in FORCES.items():
        with tempfile.TemporaryDirectory() as folder:
            project, result = pathlib.Path(folder) / "project.toml", pathlib.Path(folder) / "result.json"
            numbers = {key: value for key, value in SHOT.items()}
            project.write_text(PROJECT.format(J=J, MU=MU, VISCOUS=VISCOUS, force=force, heave=HEAVE[0], heave_hz=HEAVE[1], pitch=PITCH[0], pitch_hz=PITCH[1], **PINS, **STOPS, **numbers))
            done = subprocess.run([program, "verify", project, "--histories", f"--json={result}", "--quiet"], capture_output=True, text=True)
            if not result.exists():
                sys.exit(done.stderr)
            histories = json.loads(result.read_text())["histories"]
        history = next(one for one in histories if one["name"] == "nonlinear_both_uncontrolled")
        rates = np.array(history["hub_rate_rad_s"])
        times = history["sample_time_s"] * np.arange(len(rates))
        other, end = simulated(kind, times)
        largest = np.abs(other).max()
        apart = np.abs(rates - other).max() / largest
        worst = max(worst, apart)
        print(f"{kind}: largest rate {largest:.4f} rad/s, largest difference {apart:.1e} of it; the recoiling mass ends at {end[3]:.1e} m")
    print("agrees" if worst <= TOLERANCE else "DIFFERS")
    sys.exit(int(worst > TOLERANCE))


main()
