"""Writes random machines: for each a project as drawn, and the truth that was built, off by up to 30 % and with one to three effects that nobody drew.

    python3 examples/machines/python/make_machines.py COUNT SEED FOLDER

FOLDER/machine-001.toml is a Counterpoise project without weights, FOLDER/machine-001-truth.toml its true machine for machine.py, and FOLDER/hidden.json states
what differs in each. Inertias span a decade. A machine depends on SEED and its number alone, so a longer list begins with the shorter one.
"""

import json
import math
import pathlib
import random
import sys

# Largest relative error of a drawn value. The project states it as the tolerance.
SPREAD = 0.3

# Angle within which tight spots lie and cables are centred, rad: the travel that a commissioning usually allows.
TRAVEL = 0.25


def number(value):
    """Returns a value with four digits, as TOML writes it."""
    text = f"{value:.4g}"
    return text if any(mark in text for mark in ".en") else text + ".0"


def table(**values):
    """Returns an inline table."""
    texts = {key: f'"{value}"' if isinstance(value, str) else str(value) if isinstance(value, int) else number(value) for key, value in values.items()}
    return "{ " + ", ".join(f"{key} = {text}" for key, text in texts.items()) + " }"


def drawing(dice):
    """Returns the values of a machine as it is drawn, in SI units; torques scale with the inertia."""
    size = 10.0 ** dice.uniform(math.log10(0.25), math.log10(2.5))
    kind = dice.choice(["current", "voltage", "torque"])
    ratio = 1.0 if kind == "torque" else float(dice.choice([20, 30, 40, 60, 80]))
    values = {
        "kind": kind,
        "ratio": ratio,
        "inertia": size,
        "out_of_balance": size * dice.uniform(0.05, 0.25),
        "coulomb": size * dice.uniform(0.4, 2.0),
        # The friction at rest and the inertia swing at 12 to 30 rad/s: quicker than that, and it alone would decide the bandwidth.
        "presliding": size * dice.uniform(12.0, 30.0) ** 2,
        "viscous": size * dice.uniform(0.3, 1.5),
        "period": dice.choice([1e-3, 1e-3, 2e-3]),
        "gyro": dice.uniform(300.0, 700.0),
        "noise": dice.uniform(2e-4, 8e-4),
        "delay": dice.choice([0, 1]),
        # Half of the machines stand on a base that moves and has sensors, the others on a floor.
        "base": dice.choice([True, False]),
    }
    # Enough torque for gravity, friction and 12 rad/s^2, one and a half times.
    torque = 1.5 * (9.81 * values["out_of_balance"] + values["coulomb"] + 12.0 * size) / ratio
    if kind == "torque":
        return values | {"limit": torque}
    reflected = size * dice.uniform(0.1, 0.4)
    constant = dice.uniform(0.05, 0.15)
    current = torque * (1.0 + reflected / size) / constant
    values |= {
        "motor_inertia": reflected / ratio**2,
        "torque_constant": constant,
        "gear_stiffness": size * dice.uniform(90.0, 200.0) ** 2,
        "gear_damping": size * dice.uniform(2.0, 6.0),
    }
    if kind == "current":
        return values | {"limit": current, "bandwidth": dice.uniform(1000.0, 3000.0)}
    resistance = dice.uniform(0.4, 1.5)
    # The back-EMF at 1 rad/s of the hub is added to the voltage of the largest current.
    return values | {"resistance": resistance, "inductance": resistance * dice.uniform(3e-4, 1.5e-3), "limit": current * resistance + constant * ratio}


def hidden_effects(dice, drawn, truth):
    """Puts one to three effects that the drawing lacks into the truth; returns their names with their sizes."""
    size, coulomb = drawn["inertia"], drawn["coulomb"]
    sign = dice.choice([-1.0, 1.0])
    effects = {
        "cable spring": lambda: truth["structure"].append(
            "cable = " + table(stiffness=size * dice.uniform(2.0, 12.0), centre=dice.uniform(-TRAVEL, TRAVEL), cubic=size * dice.uniform(0.0, 40.0))),
        "hose": lambda: truth["structure"].append(
            "hose = " + table(torque=coulomb * dice.uniform(0.3, 0.8), stiffness=coulomb * dice.uniform(5.0, 20.0))),
        "random torque of the angle": lambda: truth["structure"].append(
            "roughness = " + table(rms=coulomb * dice.uniform(0.2, 0.6), length=dice.uniform(0.02, 0.1))),
        "tight spot": lambda: truth["friction.pivot"].append(
            "tight_spots = [" + table(angle=dice.uniform(-0.6, 0.6) * TRAVEL, width=dice.uniform(0.01, 0.04), height=dice.uniform(0.4, 1.2)) + "]"),
        "stiction that grows at rest": lambda: truth["friction.pivot"].extend([
            f"aging_ratio = {number(dice.uniform(0.3, 0.8))}", f"aging_time = {number(dice.uniform(0.5, 3.0))}", f"stribeck_rate = {number(0.02)}"]),
        "friction that drifts": lambda: truth["friction.pivot"].append(f"drift = {number(sign * dice.uniform(0.01, 0.04))}"),
        "friction that depends on the direction": lambda: truth["friction.pivot"].append(f"asymmetry = {number(sign * dice.uniform(0.15, 0.4))}"),
        "scale error of the gyroscope": lambda: truth["sensors.hub_rate"].append(f"gain = {number(1.0 + sign * dice.uniform(0.04, 0.12))}"),
        "bias of the gyroscope": lambda: truth["sensors.hub_rate"].append(f"bias = {number(sign * dice.uniform(2e-3, 8e-3))}"),
        "wandering bias of the gyroscope": lambda: truth["sensors.hub_rate"].append(f"walk = {number(dice.uniform(5e-4, 2e-3))}"),
        "late gyroscope": lambda: truth["sensors.hub_rate"].append(f"delay_samples = {dice.choice([1, 2, 3])}"),
        "dropouts of the gyroscope": lambda: truth["sensors.hub_rate"].append(f"dropouts = {number(dice.uniform(0.02, 0.15))}"),
        "eccentric resolver": lambda: truth["sensors.hub_position"].extend([
            f"eccentricity = {number(dice.uniform(0.005, 0.03))}", f"eccentricity_phase = {number(dice.uniform(0.0, 6.28))}"]),
        "dead zone of the drive": lambda: truth["drive"].append(f"dead_zone = {number(dice.uniform(0.05, 0.3))}"),
    }
    if "motor_inertia" in drawn:
        constant, ratio = drawn["torque_constant"], drawn["ratio"]
        effects |= {
            "cogging": lambda: truth["motor"].append(
                "cogging = " + table(
                    amplitude=coulomb / ratio * dice.uniform(0.15, 0.6), order=float(dice.choice([6, 12, 24])), phase=dice.uniform(0.0, 6.28))),
            "torque ripple": lambda: truth["motor"].append(
                "torque_ripple = " + table(amplitude=dice.uniform(0.05, 0.2), order=float(dice.choice([2, 6])), phase=dice.uniform(0.0, 6.28))),
            "backlash": lambda: truth["gear"].append(f"backlash = {number(dice.uniform(3e-4, 2e-3))}"),
            "friction at the motor": lambda: truth["friction.motor"].extend([
                f"coulomb = {number(coulomb / ratio * dice.uniform(0.2, 0.6))}", f"stiffness = {number(constant * dice.uniform(2.0, 6.0))}"]),
            "flexible structure": lambda: _split_inertia(dice, truth),
        }
    else:
        effects["flexible structure"] = lambda: _split_inertia(dice, truth)
    names = dice.sample(sorted(effects), dice.choice([1, 2, 2, 3]))
    for name in names:
        effects[name]()
    return names


def _split_inertia(dice, truth):
    """Moves a part of the hub's inertia to a beam on a spring, which swings at 60 to 150 rad/s with the hub held."""
    whole = truth["inertia"]
    beam = whole * dice.uniform(0.15, 0.4)
    stiffness = beam * dice.uniform(60.0, 150.0) ** 2
    truth["structure"][0] = f"hub_inertia = {number(whole - beam)}"
    truth["structure"] += [
        f"beam_inertia = {number(beam)}", f"stiffness = {number(stiffness)}", f"damping = {number(2.0 * 0.02 * math.sqrt(stiffness * beam))}",
    ]


def project_text(name, drawn):
    """Returns the project as drawn."""
    def tolerated(value):
        return "{ value = " + number(value) + f", tolerance = {SPREAD} }}"

    motor = drawn["kind"] != "torque"
    lines = [
        "# As drawn. The weights are chosen.", "format = 2", "[plant]", f'name = "{name}"',
        f"lumped = {{ hub_inertia = {tolerated(drawn['inertia'])}, out_of_balance = {tolerated(drawn['out_of_balance'])} }}",
    ]
    if motor:
        winding = f", resistance = {number(drawn['resistance'])}, inductance = {number(drawn['inductance'])}" if drawn["kind"] == "voltage" else ""
        lines += [
            "gearbox = " + table(ratio=drawn["ratio"], stiffness=drawn["gear_stiffness"], damping=drawn["gear_damping"]),
            f"motor = {{ inertia = {number(drawn['motor_inertia'])}, torque_constant = {tolerated(drawn['torque_constant'])}{winding} }}",
        ]
    bandwidth = f", bandwidth = {number(drawn['bandwidth'])}" if drawn["kind"] == "current" else ""
    delay = f", output_delay_samples = {drawn['delay']}" if drawn["delay"] else ""
    lines += [
        f'drive = {{ kind = "{drawn["kind"]}", limit = {number(drawn["limit"])}{bandwidth} }}',
        f"interface = {{ sample_period = {drawn['period']}, input_bits = 16, output_bits = 12{delay} }}",
        "", "[plant.friction.pivot]", 'model = "dahl"', f"coulomb = {tolerated(drawn['coulomb'])}",
        f"rest_stiffness = {number(drawn['presliding'])}", f"viscous = {number(drawn['viscous'])}",
        "", "[plant.sensors]", f"hub_gyro = {{ natural_frequency = {number(drawn['gyro'])}, scale = 10.0, noise = {number(drawn['noise'])} }}",
        "hub_resolver = { scale = 5.0, noise = 2e-5 }",
    ]
    if motor:
        lines.append(f"motor_tachometer = {{ scale = {number(10.0 / drawn['ratio'])}, noise = {number(5e-4 * drawn['ratio'])} }}")
    if drawn["base"]:
        lines += ["platform_gyro = { scale = 10.0, noise = 2e-4 }", "platform_accelerometer = { scale = 1.0, noise = 2e-3 }"]
    lines += ["", "[verify]", "step = { rate = 0.2, duration = 1.0 }", "triangle = { rate = 0.1, period = 4.0 }"]
    for figure, limit in (("nonlinear_step_settling_time_s", 0.25), ("nonlinear_triangle_error_rms_rad_s", 0.01), ("rest_hub_rms_rad_s", 1e-3)):
        lines += ["", "[[verify.requirement]]", f'figure = "{figure}"', f"at_most = {number(limit)}"]
    return "\n".join(lines) + "\n"


def truth_text(dice, drawn, seed):
    """Returns the truth, the relative errors of the drawn values, and the names of the hidden effects."""
    errors = {key: dice.uniform(-SPREAD, SPREAD) for key in ("inertia", "out_of_balance", "coulomb", "torque_constant") if key in drawn}
    true = drawn | {key: drawn[key] * (1.0 + error) for key, error in errors.items()}
    sections = {
        "structure": [f"hub_inertia = {number(true['inertia'])}", f"out_of_balance = {number(true['out_of_balance'])}"],
        "gear": [], "motor": [],
        "drive": [f'kind = "{true["kind"]}"', f"limit = {number(true['limit'])}"],
        "friction.pivot": [
            f"coulomb = {number(true['coulomb'])}", f"stiffness = {number(true['presliding'])}", f"viscous = {number(true['viscous'])}"],
        "friction.motor": [],
        "sensors.hub_rate": [f"natural_frequency = {number(true['gyro'])}", f"noise = {number(true['noise'])}", "scale = 10.0"],
        "sensors.hub_position": ["noise = 2e-5", "scale = 5.0"],
        "sensors.motor_rate": [],
        "sensors.platform_rate": ["noise = 2e-4", "scale = 10.0"] if true["base"] else [],
        "sensors.platform_accel": ["noise = 2e-3", "scale = 1.0"] if true["base"] else [],
        "interface": ["input_bits = 16", "output_bits = 12", f"delay_samples = {true['delay']}"],
        "inertia": true["inertia"],
    }
    if true["kind"] != "torque":
        sections["gear"] += [f"ratio = {number(true['ratio'])}", f"stiffness = {number(true['gear_stiffness'])}", f"damping = {number(true['gear_damping'])}"]
        sections["motor"] += [f"inertia = {number(true['motor_inertia'])}", f"torque_constant = {number(true['torque_constant'])}"]
        sections["sensors.motor_rate"] += [f"noise = {number(5e-4 * true['ratio'])}", f"scale = {number(10.0 / true['ratio'])}"]
    if true["kind"] == "current":
        sections["drive"].append(f"bandwidth = {number(true['bandwidth'])}")
    if true["kind"] == "voltage":
        sections["motor"] += [f"resistance = {number(true['resistance'])}", f"inductance = {number(true['inductance'])}"]
    names = hidden_effects(dice, drawn, sections)
    lines = ["# As built. Not drawn: " + ", ".join(names) + ".", f"seed = {seed}", f"base_moves = {str(true['base']).lower()}"]
    for section, keys in sections.items():
        if section != "inertia" and keys:
            lines += ["", f"[{section}]", *keys]
    return "\n".join(lines) + "\n", errors, names


def main():
    if len(sys.argv) != 4:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    count, seed, folder = int(sys.argv[1]), int(sys.argv[2]), pathlib.Path(sys.argv[3])
    folder.mkdir(parents=True, exist_ok=True)
    manifest = {}
    for index in range(1, count + 1):
        dice = random.Random(f"machine {seed} {index}")
        name = f"machine-{index:03d}"
        drawn = drawing(dice)
        truth, errors, names = truth_text(dice, drawn, seed * 1000 + index)
        (folder / f"{name}.toml").write_text(project_text(name, drawn))
        (folder / f"{name}-truth.toml").write_text(truth)
        rounded = {key: round(error, 4) for key, error in errors.items()}
        manifest[name] = {"drive": drawn["kind"], "base_moves": drawn["base"], "errors": rounded, "hidden": sorted(names)}
    (folder / "hidden.json").write_text(json.dumps(manifest, indent=2) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
