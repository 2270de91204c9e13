"""Walks every machine of machines.py through the commands, as a new user would, and lists what happened.

    python3 tests/peers/kinds/walk.py PATH_OF_COUNTERPOISE [WORK_FOLDER] [PART_OF_A_NAME]

check, model, design, verify, synth --save, export with an FMI unit, and, from recordings that an independent simulation makes under the
exported C controller, replay, identify and, with --diagnose, diagnose; sweep where tolerances are stated. A command fails if it ends with
another code than 0 (or 1, a verdict), says "internal", or prints "NaN". A diagnosis fails if it names an effect: the recordings have none
that the file lacks. A machine with hysteresis, a kinematic error or Dahl's friction is not recorded, because the simulation has none of them.

--only-diagnose leaves out everything but what leads to a diagnosis. --refined=N takes steps N times as short in the simulation of the recordings.

--other walks the machines of OTHERS instead of MACHINES.
"""

import ctypes
import json
import math
import pathlib
import re
import resource
import subprocess
import sys
import tempfile

import numpy as np
from scipy.linalg import expm

from machines import MACHINES, OTHERS

DURATION_S, SUBSTEPS = 8.0, 4
FINE_SUBSTEPS = 20  # of a machine with friction, a weight, teeth that meet, or a drive that is late by a part of a sample
FRICTION_SWEEPS = 4  # Gauss-Seidel sweeps over the bodies with friction, which act on one another within a step by little
REFINED = next((int(word[10:]) for word in sys.argv if word.startswith("--refined=")), 1)
UNSIMULATED = ("hysteresis", "kinematic_error", '"dahl"', "torque_ripple", "cogging")
G = 9.80665


class Readings(ctypes.Structure):
    _fields_ = [(name, ctypes.c_double) for name in ("demand", "hub", "rate", "accel", "motor", "position")]


class Sheet:
    """The values of a project in the units of their keys, as `check --json` understood them."""

    def __init__(self, checked):
        self.values = {}
        for section in checked["sections"]:
            for value in section["values"]:
                self.values[f'{section["path"]}.{value["key"]}'] = value["value"]

    def __call__(self, path, default=0.0):
        text = self.values.get("plant." + path)
        if text is None:
            return default
        return float(text) if re.match(r"^[-+0-9.einf]+$", text) else text.strip('"')

    def has(self, section):
        return any(path.startswith("plant." + section + ".") for path in self.values)


class Machine:
    """Drive, motor, transmission and a chain of inertias: x' = A x + B u + F torques, exact between samples but for friction and weight."""

    def __init__(self, sheet, chain):
        s = sheet
        self.linear = s("axis", "rotary") == "linear"
        kind = next((k for k in ("gearbox", "belt", "harmonic_drive", "cable", "ball_screw") if s.has(k)), None)
        ratio = 1.0
        if kind:
            ratio = 2 * math.pi / s("ball_screw.lead") if kind == "ball_screw" else s(f"{kind}.ratio", 1.0)
        stiffness = s(f"{kind}.stiffness", math.inf) if kind else math.inf
        loads = [s("lumped.mass", 0) or s("lumped.hub_inertia", 0) or s("inertia", 0) or s("mass", 0)]
        springs = []
        if s.has("lumped") and (s("lumped.beam_inertia") or s("lumped.tip_mass")):
            loads.append(s("lumped.beam_inertia") or s("lumped.tip_mass"))
            springs.append(s("lumped.stiffness"))
        for link in chain:
            loads.append(link["inertia"])
            springs.append(link["stiffness"])
        rotor = s("motor.inertia", 0.0)
        self.ratio, self.elastic = ratio, math.isfinite(stiffness)
        self.stiffness, self.gap = stiffness, s(f"{kind}.backlash") if kind and math.isfinite(stiffness) else 0.0
        self.delay = s("drive.delay")
        self.kt = s("motor.torque_constant", 1.0)
        n = len(loads)
        m = n + (1 if self.elastic else 0)  # bodies; the motor is the last one, in hub coordinates
        masses = list(loads)
        if self.elastic:
            masses.append(rotor * ratio**2)
        else:
            masses[0] += rotor * ratio**2
        K, D = np.zeros((m, m)), np.zeros((m, m))

        def join(a, b, k, d):
            for M, v in ((K, k), (D, d)):
                M[a, a] += v
                M[b, b] += v
                M[a, b] -= v
                M[b, a] -= v

        for i, k in enumerate(springs):
            join(i, i + 1, k, 0.02 * math.sqrt(k * loads[i + 1]))
        if self.elastic:
            join(m - 1, 0, stiffness, s(f"{kind}.damping", 0.02 * math.sqrt(stiffness * sum(loads))))
        D[0, 0] += s("friction.pivot.viscous")
        D[-1 if self.elastic else 0, -1 if self.elastic else 0] += s("friction.motor.viscous") * ratio**2
        self.masses = np.array(masses)
        takes = s("drive.kind", "torque")
        limit = s("drive.limit", math.inf)
        self.full = limit / 10.0 if math.isfinite(limit) else None
        if s.has("amplifier"):  # what a voltage drive is listed as
            takes, self.full = "voltage", s("amplifier.gain")
        R, L = s("motor.resistance", 1.0), s("motor.inductance", 0.0)
        bandwidth = s("drive.bandwidth", math.inf)
        w = s("sensors.hub_gyro.natural_frequency", math.inf)
        for name in ("tachometer", "encoder", "resolver"):
            w = s(f"sensors.{name}.natural_frequency", w)
        size = 2 * m + 1 + 2  # positions, rates, current, sensor
        A, B, F = np.zeros((size, size)), np.zeros(size), np.zeros((size, m))
        inverse = np.diag(1 / self.masses)
        A[:m, m:2 * m] = np.eye(m)
        A[m:2 * m, :m], A[m:2 * m, m:2 * m] = -inverse @ K, -inverse @ D
        F[m:2 * m] = inverse
        drive = m - 1 if self.elastic else 0
        pull = self.kt * ratio / self.masses[drive]
        self.driven, self.m = drive, m
        quick = 2e5
        if takes == "voltage":
            if L == 0:
                A[m + drive, m + drive] -= pull * self.kt * ratio / R
                B[m + drive] = pull / R
                A[2 * m, 2 * m] = -quick
            else:
                A[m + drive, 2 * m] = pull
                A[2 * m, 2 * m], A[2 * m, m + drive], B[2 * m] = -R / L, -self.kt * ratio / L, 1 / L
        elif math.isfinite(bandwidth):
            A[m + drive, 2 * m] = pull
            A[2 * m, 2 * m], B[2 * m] = -bandwidth, bandwidth
        else:
            B[m + drive] = (1.0 if takes == "torque" else self.kt) * ratio / self.masses[drive]
            A[2 * m, 2 * m] = -quick
        measured = self.measured(sheet, drive, m)
        if math.isfinite(w):
            A[2 * m + 1, 2 * m + 2] = 1
            A[2 * m + 2] += w * w * measured
            A[2 * m + 2, 2 * m + 1] -= w * w
            A[2 * m + 2, 2 * m + 2] -= 1.4 * w
            self.read = np.eye(size)[2 * m + 1]
        else:
            A[2 * m + 1, 2 * m + 1] = A[2 * m + 2, 2 * m + 2] = -quick
            self.read = measured
        self.A, self.B, self.F = A, B, F
        self.coulomb = np.zeros(m)
        self.coulomb[0] += s("friction.pivot.coulomb")
        self.coulomb[drive] += s("friction.motor.coulomb") * ratio
        self.weight = s("lumped.out_of_balance") * G if not self.linear else 0.0

    def torques(self, x):
        """What weight and teeth do beside the linear machine."""
        torques = np.zeros(self.m)
        if self.weight:
            torques[0] -= self.weight * math.cos(x[0])
        if self.gap:  # inside the gap the spring of the linear machine does not push
            windup = x[self.m - 1] - x[0]
            inside = self.stiffness * max(-self.gap / 2, min(self.gap / 2, windup))
            torques[self.m - 1] += inside
            torques[0] -= inside
        return torques

    def rubbed(self, x, F):
        """The state at the end of a step after dry friction, which stops a body or acts against its motion (Moreau's time stepping)."""
        bodies = np.flatnonzero(self.coulomb)
        friction = np.zeros(self.m)
        for _ in range(FRICTION_SWEEPS if len(bodies) > 1 else 1):
            for j in bodies:
                moved = x[self.m + j] + F[self.m + j] @ friction
                stop = friction[j] - moved / F[self.m + j, j]
                friction[j] = max(-self.coulomb[j], min(self.coulomb[j], stop))
        return x + F @ friction if len(bodies) else x

    def measured(self, s, drive, m):
        row = np.zeros(2 * m + 3)
        if s.has("sensors.encoder") or s.has("sensors.resolver"):
            name = "encoder" if s.has("sensors.encoder") else "resolver"
            row[drive if s(f"sensors.{name}.place", "load") == "motor" else 0] = 1
        else:
            place = s("sensors.tachometer.place", "load")
            row[m + (drive if place == "motor" else 0)] = 1
        self.position = bool(row[:m].any())
        self.of_motor = "motor" in (s("sensors.encoder.place", ""), s("sensors.resolver.place", ""), s("sensors.tachometer.place", ""))
        return row


def record(sheet, checked, chain, code, period, step, origin, noise, resolution, seed):
    """A recording of the machine under its exported controller: time, demand, control, reading."""
    machine = Machine(sheet, chain)
    if machine.full is None:
        assumed = next(a for a in checked["assumptions"] if a["key"].endswith("drive.limit"))
        machine.full = assumed["value"] / 10.0
    fine = machine.gap or machine.delay or machine.weight or machine.coulomb.any()
    substeps = (FINE_SUBSTEPS if fine else SUBSTEPS) * REFINED
    dt = period / substeps
    late = round(machine.delay / dt)
    queue = [0.0] * late
    n = machine.A.shape[0]
    wide = np.zeros((n + 1 + machine.m, n + 1 + machine.m))
    wide[:n, :n], wide[:n, n], wide[:n, n + 1:] = machine.A, machine.B, machine.F
    step_of = lambda moved: (moved[:n, :n], moved[:n, n], moved[:n, n + 1:])
    whole, half = step_of(expm(wide * dt)), step_of(expm(wide * dt / 2))
    random = np.random.default_rng(seed)
    state = ctypes.create_string_buffer(8192)
    code.controller_init(state)
    x = np.zeros(n)
    x[: machine.m] = origin
    if machine.position:
        x[2 * machine.m + 1] = origin
    torques = np.zeros(machine.m)
    samples = min(int(DURATION_S / period), 20000)
    out = []
    for k in range(samples):
        t = k * period
        swing = 0.4 * math.sin(2 * math.pi * 0.31 * t) + 0.2 * math.sin(2 * math.pi * 1.7 * t + 1) - 0.2 * math.sin(1)
        demand = (origin if machine.position else 0.0) + step * swing
        reading = machine.read @ x + noise * random.standard_normal()
        if resolution:
            reading = round(reading / resolution) * resolution
        u = code.controller_step(state, ctypes.byref(Readings(demand, reading, 0, 0, 0, 0)))
        out.append((t, demand, u, reading))
        drive = machine.full * max(-10.0, min(10.0, u))
        for _ in range(substeps):
            queue.append(drive)
            acting = queue.pop(0)
            if fine:  # the torques of the middle of the step: second order
                torques = machine.torques(half[0] @ x + half[1] * acting + half[2] @ torques)
            x = machine.rubbed(whole[0] @ x + whole[1] * acting + whole[2] @ torques, whole[2])
    return machine, np.array(out)


def controller(folder):
    library = pathlib.Path(folder) / "controller.so"
    source = str(pathlib.Path(folder) / "controller.c")
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-std=c99", "-ffp-contract=off", source, "-o", str(library)], check=True)
    found = ctypes.CDLL(str(library))
    found.controller_step.restype = ctypes.c_double
    return found


def processor_time():
    """Processor time of the commands so far, s: unlike the time that passed, it does not depend on what else the machine does."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Walk:
    def __init__(self, program, name, text, folder):
        self.program, self.name, self.folder, self.failures = program, name, folder, []
        (folder / "project.toml").write_text(text)
        self.text = text

    def run(self, *arguments, allowed=(0, 1)):
        before = processor_time()
        done = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, cwd=self.folder)
        said = done.stdout + done.stderr
        (self.folder / f"{arguments[0]}.txt").write_text(said)
        words = (" NaN", "internal error", "panicked")
        if done.returncode not in allowed or any(word in said for word in words):
            first = [line for line in said.splitlines() if line.strip()][-4:]
            self.failures.append(f"{' '.join(map(str, arguments))} -> {done.returncode}: " + " | ".join(first)[:600])
        return done, processor_time() - before

    def all(self):
        done, t = self.run("check", ".", "--json")
        if done.returncode:
            return
        checked = json.loads(done.stdout)
        if checked["problems"]:
            self.failures.append(f"check: {checked['problems']}")
        self.run("model", ".")
        done, t_design = self.run("design", ".", "-o", "out")
        print(f"{self.name:50} design {t_design:5.2f} s", end="", flush=True)
        if done.returncode > 1:
            print()
            return
        limited = re.search(r"limited by: ([^;]*)", done.stdout)
        failed = re.search(r"(\d+) requirements hold, (\d+) fail", done.stdout)
        if failed and failed.group(2) != "0":
            print(f" [{failed.group(2)} fail]", end="")
        if "--only-diagnose" in sys.argv:
            if not any(word in self.text for word in UNSIMULATED):
                self.replayed(checked)
            print(flush=True)
            return
        self.run("verify", ".", "--json")
        self.run("synth", ".", "--save", "saved.toml")
        self.run("check", "saved.toml")
        if "tolerance" in self.text:
            (self.folder / "sweep.toml").write_text(self.text + "\n[sweep]\nsamples = 8\n")
            self.run("sweep", "sweep.toml", "-o", "swept")
        (self.folder / "fmi.toml").write_text(self.text + '\n[export]\nlanguages = ["c99", "rust", "fmi"]\n')
        self.run("export", "fmi.toml", "-o", "code")
        if not any(word in self.text for word in UNSIMULATED):
            self.replayed(checked)
        print(f"  limited by {limited.group(1) if limited else '?'}", flush=True)

    def replayed(self, checked):
        import tomllib

        raw = tomllib.loads(self.text)
        chain = [
            {k: v for k, v in link.items()} for link in raw["plant"].get("lumped", {}).get("chain", [])
        ]
        for link in chain:
            if isinstance(link["stiffness"], str):
                link["stiffness"] = float(link["stiffness"].split()[0]) * 1e3
        sheet = Sheet(checked)
        period = sheet("interface.sample_period")
        kinds = ["encoder", "resolver", "tachometer", "hub_gyro"]
        sensor = next((k for k in kinds if sheet.has(f"sensors.{k}")), "hub_gyro")
        noise = sheet(f"sensors.{sensor}.noise", 0.0)
        counts, resolution = sheet("sensors.encoder.counts", 0.0), sheet("sensors.encoder.resolution", 0.0)
        step = float(sheet.values.get("verify.step.rate", 0.1))
        origin = float(sheet.values.get("model.hub_angle", 0.0))
        machine = Machine(sheet, chain)
        if counts:
            resolution = 2 * math.pi / counts / (machine.ratio if machine.of_motor else 1.0)
        if machine.of_motor:
            noise /= machine.ratio
        if not resolution and not noise:
            noise = 1e-3 * step
        code = controller(self.folder / "out")
        runs = self.folder / "runs"
        runs.mkdir(exist_ok=True)
        for seed in (1, 2):
            machine, data = record(sheet, checked, chain, code, period, step * (0.6 + 0.4 * seed), origin, noise, resolution, seed)
            if not np.isfinite(data).all() or np.abs(data[:, 3]).max() > 1e3 * (abs(step) + abs(origin)):
                self.failures.append("the independent simulation runs away")
                return
            unit = ("m" if machine.linear else "rad") if machine.position else ("m/s" if machine.linear else "rad/s")
            column = "hub_position" if machine.position else "hub_rate"
            header = f"time [s],demand [{unit}],control [V],{column} [{unit}]"
            np.savetxt(runs / f"run{seed}.csv", data, delimiter=",", header=header, comments="", fmt="%.12g")
        (self.folder / "recorded.toml").write_text(self.text + '\n[recording_controller]\nkind = "exported"\nfile = "out/controller.json"\n')
        done, t = self.run("replay", "recorded.toml", "runs")
        ratios = [line.split() for line in done.stdout.splitlines() if re.match(r"\s+(control|hub_rate|hub_position)\s", line)]
        print("  replay " + " ".join(f"{row[0]} {row[3]}" for row in ratios[:2]), end="")
        if "--only-diagnose" not in sys.argv:
            self.run("identify", "recorded.toml", "runs", allowed=(0, 1, 2, 3))
        if "--diagnose" in sys.argv or "--only-diagnose" in sys.argv:
            done, t = self.run("diagnose", "recorded.toml", "runs", "--save", "improved.toml")
            verdicts = ("consistent", "named", "ambiguous", "incomplete", "unknown")
            lines = [line for line in done.stdout.splitlines() if line.split(":")[0] in verdicts]
            verdict = lines[0] if lines else "no verdict"
            fit = [line.split() for line in done.stdout.splitlines() if re.match(r"  (control|hub_rate|hub_position|motor_rate)\s", line)]
            left = max((float(row[3]) / float(row[1]) for row in fit if len(row) == 6), default=math.nan)
            print(f"  diagnose {t:4.1f} s {left:5.2f} floors {verdict.split(':')[0]}", end="")
            if not verdict.startswith("consistent"):
                self.failures.append(f"diagnose: {verdict}")


def main():
    words = [word for word in sys.argv[1:] if not word.startswith("--")]
    program = str(pathlib.Path(words[0]).resolve())
    work = pathlib.Path(words[1] if len(words) > 1 else tempfile.mkdtemp()).resolve()
    machines = OTHERS if "--other" in sys.argv else MACHINES
    chosen = [name for name in machines if len(words) < 3 or words[2] in name]
    failures = 0
    for name in chosen:
        folder = work / re.sub(r"[^a-z0-9]+", "-", name)
        folder.mkdir(parents=True, exist_ok=True)
        walk = Walk(program, name, machines[name], folder)
        walk.all()
        for failure in walk.failures:
            failures += 1
            print(f"    FAILS {failure}")
    print(f"{len(chosen)} machines, {failures} failures")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
