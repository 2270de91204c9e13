"""What is not known lowers the bandwidth of a first design, never raises it.

Files: every key and every section of the smallest files is left out in turn, and the file is designed again without its weights. The bandwidth of the
program's own result must not rise by more than the search resolves, unless the file then describes another machine (another signal is measured, another
quantity is driven, mass or friction is gone), or asks for less, or stated something worse than is usual. Those keys are listed with the reason, and
their rises are printed as well.

Machines: random machines whose stated values lie within what is usual, at clocks of 100 Hz to 10 kHz. Each of the stated facts is left out, alone and
all together.

    python3 tests/peers/kinds/left_out.py target/release/counterpoise [MACHINES [FIRST]]

With FIRST, the number of the first machine, the files are left out.

Needs nothing but Python 3.11.
"""

import concurrent.futures
import copy
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[3]
EXAMPLES = ["belt-antenna", "ball-screw", "direct-gimbal", "servo-pendulum", "crane-cylinder"]
KINDS = ["sight", "gun", "antenna", "robot-joint", "gimbal", "linear-axis", "pendulum"]
# A bandwidth that differs by less is the same: the search climbs in steps.
STEP = 1.03

# Keys without which the file describes another machine, by the last parts of their path, with the reason.
OTHER_MACHINES = {
    "sensors": "another signal is measured",
    "encoder": "another signal is measured",
    "gyroscope": "another signal is measured",
    "tachometer": "another signal is measured",
    "resolver": "another signal is measured",
    "place": "the sensor sits elsewhere",
    "loop": "another loop is closed",
    "drive": "another quantity is driven",
    "kind": "another quantity is driven",
    "cylinder": "another quantity is driven",
    "inertia": "less inertia",
    "mass": "less mass",
    "beam_inertia": "less inertia",
    "hub_inertia": "less inertia",
    "gearbox": "the motor sits on the load",
    "belt": "the motor sits on the load",
    "ball_screw": "the motor sits on the load",
    "harmonic_drive": "the motor sits on the load",
    "cable": "the motor sits on the load",
    "ratio": "the motor sits on the load",
    "friction": "no friction",
    "viscous": "no friction",
    "coulomb": "no friction",
    "motor": "another motor",
    "pivot": "no friction",
    "out_of_balance": "no gravity torque",
    "vertical_offset": "no gravity torque",
    "position_stiffness": "no spring",
    "chain": "less inertia",
    "backlash": "no gap",
    "structure": "another structure",
    "verify": "the requirements are gone",
    "requirement": "the requirements are gone",
    "requirements": "the requirements are gone",
    "bandwidth": "the bandwidth that is asked for is gone",
    "synth": "what is asked for is gone",
    "step": "no step is asked for",
    "rate": "no step is asked for",
    "limit": "the stated drive is weaker than is usual",
    "natural_frequency": "the stated sensor is slower than is usual",
    "hub_gyro": "the stated sensor is slower than is usual",
    "torque_constant": "another motor",
}


def paths(table, before=()):
    """Yields the path of every key and section."""
    for key, value in table.items():
        path = (*before, key)
        yield path
        if isinstance(value, dict):
            yield from paths(value, path)
        elif isinstance(value, list):
            for k, item in enumerate(value):
                if isinstance(item, dict):
                    yield from paths(item, (*path, k))


def without(table, path):
    changed = copy.deepcopy(table)
    at = changed
    for part in path[:-1]:
        at = at[part]
    del at[path[-1]]
    return changed


def text(value):
    if isinstance(value, dict):
        return "{ " + ", ".join(f'"{k}" = {text(v)}' for k, v in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(text(v) for v in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    return json.dumps(value) if isinstance(value, str) else repr(value)


def write(table):
    return "".join(f"{key} = {text(value)}\n" for key, value in table.items())


def bandwidth(program, table):
    """Returns the bandwidth in rad/s, or why there is none."""
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "project.toml").write_text(write(table))
        run = subprocess.run(
            [program, "synth", folder, "--json"], capture_output=True, text=True, check=False
        )
    if run.returncode != 0:
        return None, run.stderr.strip().split("\n")[0]
    result = json.loads(run.stdout)
    first = find(result, "bandwidth_rad_s")
    return first, None


def find(value, key):
    if isinstance(value, dict):
        if isinstance(value.get(key), (int, float)):
            return value[key]
        value = list(value.values())
    if isinstance(value, list):
        for item in value:
            found = find(item, key)
            if found is not None:
                return found
    return None


def files(program):
    for name in EXAMPLES:
        yield name, tomllib.loads((ROOT / "examples" / name / "project.toml").read_text())
    with tempfile.TemporaryDirectory() as folder:
        for kind in KINDS:
            at = pathlib.Path(folder) / kind
            subprocess.run([program, "new", str(at), "--like", kind], check=True, capture_output=True)
            yield kind, tomllib.loads((at / "project.toml").read_text())


# Lowest usual frequency of a load on its transmission, Hz.
SOFT_HZ = {"belt": 5.0, "cable": 5.0, "gearbox": 10.0, "harmonic_drive": 10.0}
# Latest usual reading, s, and lowest usual natural frequency, Hz, of a sensor.
LAGS = {"hub_gyro": (2e-3, 100.0), "tachometer": (2e-3, 300.0), "resolver": (2e-3, 300.0), "encoder": (1e-4, 3000.0)}


class Machine:
    """A machine within what is usual, and the paths of the facts that may be left out."""

    def __init__(self, seed):
        self.draw = random.Random(seed)
        self.facts = []
        self.inertia, self.period = self.spread(1e-3, 1e3), self.spread(1e-4, 1e-2)
        self.ratio = 1.0
        self.plant = {"interface": {"sample_period": self.period}}
        self.structure()
        kind = self.draw.choice([None, *SOFT_HZ])
        if kind is not None:
            self.transmission(kind)
        self.drive(self.draw.choice(["torque", "torque", "current", "voltage"]))
        self.sensor(self.draw.choice(["hub_gyro", "hub_gyro", "encoder", "tachometer", "resolver"]))
        if self.draw.random() < 0.5:
            self.plant["interface"]["output_delay_samples"] = self.draw.choice([0, 1])
            self.facts.append(("plant", "interface", "output_delay_samples"))

    def spread(self, low, high):
        return math.exp(self.draw.uniform(math.log(low), math.log(high)))

    def state(self, section, key, value, *path):
        """States a fact that may be left out."""
        section[key] = value
        self.facts.append(("plant", *path, key))

    def structure(self):
        if self.draw.random() < 0.6:
            self.plant["inertia"] = self.inertia
            return
        share = self.draw.uniform(0.2, 0.8)
        hub, beam = self.inertia * share, self.inertia * (1 - share)
        lumped = {"hub_inertia": hub, "beam_inertia": beam}
        stiffness = beam * (2 * math.pi * self.spread(10.0, 200.0)) ** 2
        self.state(lumped, "stiffness", stiffness, "lumped")
        if self.draw.random() < 0.6:
            damping = 2 * self.spread(0.005, 0.03) * math.sqrt(stiffness * hub * beam / self.inertia)
            self.state(lumped, "damping", damping, "lumped")
        self.plant["lumped"] = lumped

    def transmission(self, kind):
        self.ratio = self.spread(2.0, 100.0) if kind != "harmonic_drive" else self.spread(30.0, 160.0)
        section = {"ratio": self.ratio}
        stiffness = self.inertia * (2 * math.pi * SOFT_HZ[kind] * self.spread(1.0, 10.0)) ** 2
        self.state(section, "stiffness", stiffness, kind)
        if self.draw.random() < 0.6:
            damping = 2 * self.spread(0.005, 0.03) * math.sqrt(stiffness * self.inertia)
            self.state(section, "damping", damping, kind)
        self.plant[kind] = section
        self.plant["motor"] = {"inertia": self.inertia / self.ratio**2 * self.spread(0.05, 2.0)}

    def drive(self, kind):
        # A drive as strong as is usual: what is missing is then no stronger.
        torque = 1000.0 * self.inertia / self.ratio
        drive = {"kind": kind, "limit": torque}
        self.plant["drive"] = drive
        if kind == "torque":
            return
        motor = self.plant.setdefault("motor", {})
        if kind == "current":
            motor["torque_constant"] = self.spread(0.02, 1.0)
            drive["limit"] = torque / motor["torque_constant"]
            if self.draw.random() < 0.7:
                self.state(drive, "bandwidth", 2 * math.pi * self.spread(1000.0, 10000.0), "drive")
            if self.draw.random() < 0.7:
                self.state(drive, "delay", self.draw.uniform(0.0, 2e-4), "drive")
            return
        # A voltage drive whose motor reaches this speed of the load without load.
        speed, volts = self.spread(2.0, 50.0), self.spread(12.0, 400.0)
        motor["torque_constant"] = volts / (speed * self.ratio)
        motor["resistance"] = volts * motor["torque_constant"] / torque
        drive["limit"] = volts
        if self.draw.random() < 0.7:
            self.state(motor, "inductance", motor["resistance"] * self.spread(1e-4, 5e-3), "motor")
        if self.draw.random() < 0.7:
            self.state(drive, "time_constant", self.spread(2e-5, 5e-4), "drive")

    def sensor(self, signal):
        sensor, path = {}, ("sensors", signal)
        latest, slowest_hz = LAGS[signal]
        if self.draw.random() < 0.6:
            self.state(sensor, "delay", self.draw.uniform(0.0, latest), *path)
        if self.draw.random() < 0.6:
            frequency = 2 * math.pi * slowest_hz * self.spread(1.0, 10.0)
            self.state(sensor, "natural_frequency", frequency, *path)
        if signal == "encoder":
            self.state(sensor, "counts", int(self.spread(1e4, 1e7)), *path)
        elif signal == "hub_gyro":
            self.state(sensor, "noise", self.spread(1e-6, 1e-4), *path)
        else:
            sensor["noise"] = self.spread(1e-6, 1e-4)
        self.plant["sensors"] = {signal: sensor}

    def table(self):
        step = self.spread(1e-3, 1e-2)
        return {"format": 2, "verify": {"step": {"rate": step}}, "plant": self.plant}


def judge_machine(program, seed):
    """Returns how many facts were left out, how many of them raised the bandwidth of a random machine, and what was found."""
    machine = Machine(seed)
    table, found, tried, rises = machine.table(), [], 0, 0
    stated, why = bandwidth(program, table)
    if stated is None:
        return 0, 0, [f"machine {seed}: {why}"]
    found.append(f"machine {seed}: {stated:.4g} rad/s, {len(machine.facts)} facts")
    everything = table
    for path in machine.facts:
        everything = without(everything, path)
    left_out = [(path, without(table, path)) for path in machine.facts] + [(("all",), everything)]
    for path, open_table in left_out:
        open_, why = bandwidth(program, open_table)
        tried += 1
        if open_ is None:
            found.append(f"machine {seed} without {'.'.join(path)}: {why}")
        elif open_ > STEP * stated:
            rises += 1
            ratio = f"{open_ / stated:.3f} times"
            found.append(f"machine {seed} without {'.'.join(path)}: {stated:.4g} to {open_:.4g} rad/s, {ratio}: A RISE")
    if rises:
        found.append(write(table))
    return tried, rises, found


def machines(program, count, first):
    """Returns how many facts were left out and how many of them raised the bandwidth of a random machine."""
    tried, rises = 0, 0
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        for left, higher, found in pool.map(lambda seed: judge_machine(program, seed), range(first, first + count)):
            tried, rises = tried + left, rises + higher
            print("\n".join(found), flush=True)
    return tried, rises


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    numbers = [int(number) for number in sys.argv[2:4]]
    count, first = [*numbers, *[60, 0][len(numbers) :]]
    rises, others, tried = 0, 0, 0
    for name, table in files(program) if len(numbers) < 2 else ():
        table.pop("synth", None)
        stated, why = bandwidth(program, table)
        print(f"{name}: {stated if stated is None else round(stated, 3)} rad/s {why or ''}")
        if stated is None:
            continue
        for path in paths(table):
            open_, why = bandwidth(program, without(table, path))
            tried += 1
            if open_ is None or open_ <= STEP * stated:
                continue
            named = ".".join(str(part) for part in path)
            reasons = [OTHER_MACHINES[part] for part in path[-1:] if part in OTHER_MACHINES]
            others += bool(reasons)
            rises += not reasons
            mark = reasons[0] if reasons else "A RISE"
            print(f"  without {named}: {open_:.3f} rad/s, {open_ / stated:.2f} times: {mark}")
    print(f"{tried} keys left out, {others} of them make another machine that is quicker, {rises} rises")
    left, higher = machines(program, count, first)
    print(f"{count} random machines: {left} facts left out, {higher} rises")
    sys.exit(rises + higher > 0)


if __name__ == "__main__":
    main()
