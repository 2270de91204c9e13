"""Every drive before every transmission: the response of `counterpoise model` to the control against the equations of the data sheet.

    python tests/peers/kinds/drives.py PROGRAM

A project file states a drive (torque, current, voltage; with and without units), a motor (torque constant, inertia and inductance stated or
not), a transmission (none, gearbox, belt, cable, harmonic drive, ball screw; rigid or with a stiffness) and a load that turns or slides. From
the same numbers this script writes down the response of the load's rate to the control, without reading a project file:

    motor   J_m w' = T - (k x + d x') / N,   x' = w / N - v,   J v' = k x + d x' - b v     (rigid: w = N v)
    torque  T = limit / 10 per V of control;   current  T = K_t limit / 10 / (1 + s / bandwidth)
    voltage (R + s L) i = limit / 10 u - K_t w,   T = K_t i
"""

import itertools
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

RATES_RAD_S = (3.0, 60.0, 500.0)
RESISTANCE_OHM = 1.7
VISCOUS = 0.3
BANDWIDTH_RAD_S = 1000.0
TOLERANCE = 1e-6

TRANSMISSIONS = {
    "none": (None, 1.0),
    "gearbox": ("gearbox", 40.0),
    "belt": ("belt", 8.0),
    "cable": ("cable", 12.0),
    "harmonic drive": ("harmonic_drive", 100.0),
    "ball screw": ("ball_screw", 2.0 * math.pi / 0.01),
}
DRIVES = {
    "torque": ("torque", 3.0, 'kind = "torque", limit = 3.0'),
    "torque, unit": ("torque", 3.0, 'kind = "torque", limit = "300 N cm"'),
    "nothing but a limit": ("torque", 3.0, "limit = 3.0"),
    "current": ("current", 6.0, 'kind = "current", limit = 6.0'),
    "current, unit": ("current", 6.0, 'kind = "current", limit = "6000 mA"'),
    "current, bandwidth": ("current loop", 6.0, f'kind = "current", limit = 6.0, bandwidth = {BANDWIDTH_RAD_S}'),
    "voltage": ("voltage", 24.0, 'kind = "voltage", limit = 24.0'),
    "voltage, unit": ("voltage", 24.0, 'kind = "voltage", limit = "24 V"'),
}


def cases():
    """Every machine that makes sense, as a dictionary of what is stated."""
    for transmission, drive, constant, rotor, inductance, axis, stiffness in itertools.product(
        TRANSMISSIONS, DRIVES, (None, 0.05, 2.5), (None, 2e-4), (None, 1e-3), ("rotary", "linear"), (None, 9e3)
    ):
        slides, direct = axis == "linear", transmission == "none"
        kind = DRIVES[drive][0]
        makes_sense = (
            (direct or slides == (transmission == "ball screw"))
            and not (slides and direct and rotor)
            and (kind != "voltage" or constant)
            and (kind == "voltage" or not inductance)
            and (stiffness is None or (rotor and not direct))
            and not (slides and direct and "N cm" in DRIVES[drive][2])
        )
        if makes_sense:
            yield dict(
                transmission=transmission, drive=drive, constant=constant, rotor=rotor, inductance=inductance,
                slides=slides, stiffness=stiffness,
            )


def project(case):
    """The project file of a machine."""
    section, ratio = TRANSMISSIONS[case["transmission"]]
    elastic = f", stiffness = {case['stiffness']}, damping = 2.0" if case["stiffness"] else ""
    size = "lead = 0.01" if section == "ball_screw" else f"ratio = {ratio}"
    motor = {
        "torque_constant": case["constant"], "inertia": case["rotor"], "inductance": case["inductance"],
        "resistance": RESISTANCE_OHM if DRIVES[case["drive"]][0] == "voltage" else None,
    }
    stated = ", ".join(f"{key} = {value}" for key, value in motor.items() if value)
    sensor = "encoder = { resolution = 1e-6 }" if case["slides"] else "hub_gyro = { noise = 1e-6 }"
    lines = ["format = 2", "[plant]"]
    lines += ['axis = "linear"', "mass = 20.0"] if case["slides"] else ["inertia = 0.7"]
    lines += [f"{section} = {{ {size}{elastic} }}"] if section else []
    lines += [f"motor = {{ {stated} }}"] if stated else []
    lines += [f"drive = {{ {DRIVES[case['drive']][2]} }}", f"friction = {{ pivot = {{ viscous = {VISCOUS} }} }}"]
    lines += [f"sensors = {{ {sensor} }}", "interface = { sample_period = 1e-3 }"]
    return "\n".join(lines) + "\n"


def expected(case, rate_rad_s):
    """Rate of the load per volt of control."""
    s, (kind, limit, _) = 1j * rate_rad_s, DRIVES[case["drive"]]
    ratio, load = TRANSMISSIONS[case["transmission"]][1], 20.0 if case["slides"] else 0.7
    constant, rotor = case["constant"] or 1.0, case["rotor"] or 0.0
    coil = RESISTANCE_OHM + s * (case["inductance"] or 0.0)
    braking = constant**2 / coil if kind == "voltage" else 0.0
    torque = {
        "torque": limit / 10.0,
        "current": constant * limit / 10.0,
        "current loop": constant * limit / 10.0 / (1.0 + s / BANDWIDTH_RAD_S),
        "voltage": constant * limit / 10.0 / coil,
    }[kind]
    of_motor, of_load = s * rotor + braking, s * load + VISCOUS
    if not case["stiffness"]:
        return ratio * torque / (of_load + ratio**2 * of_motor)
    passed = case["stiffness"] / s + 2.0
    # J_m w' + ... = T - F / N, F = passed (w / N - v), (s J + b) v = F
    both = np.array([[of_motor + passed / ratio**2, -passed / ratio], [-passed / ratio, of_load + passed]])
    return np.linalg.solve(both, np.array([torque, 0.0]))[1]


def found(program, text, folder):
    """The response of the program's plant to the control, from its first output, as a rate."""
    path = folder / "project.toml"
    path.write_text(text)
    run = subprocess.run([program, "model", str(path), "--json", "-q"], capture_output=True, text=True)
    if run.returncode != 0:
        raise SystemExit(f"refused:\n{text}{run.stderr}")
    plant = json.loads(run.stdout)["plant"]
    A, B, C, D = (np.array(plant[key], float) for key in "ABCD")
    is_rate = "rate" in plant["outputs"][0]["name"] or plant["outputs"][0]["unit"] in ("rad/s", "m/s")

    def response(rate_rad_s):
        s = 1j * rate_rad_s
        value = C[0] @ np.linalg.solve(s * np.eye(len(A)) - A, B[:, 0]) + D[0, 0]
        return value if is_rate else value * s

    return response


def main(program):
    """Compares all machines; fails if one differs."""
    count, worst, wrong = 0, 0.0, []
    with tempfile.TemporaryDirectory() as folder:
        for case in cases():
            response = found(program, project(case), pathlib.Path(folder))
            off = max(abs(response(w) / expected(case, w) - 1.0) for w in RATES_RAD_S)
            count, worst = count + 1, max(worst, off)
            if not off <= TOLERANCE:
                wrong.append(f"{off:.1e} {case}")
    print(f"{count} machines, {count - len(wrong)} within {TOLERANCE:g} at every rate, largest difference {worst:.1e}")
    print("\n".join(wrong[:20]))
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
