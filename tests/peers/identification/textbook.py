#!/usr/bin/env python3
"""Sealed machines whose project is a page of a textbook: what is concealed, what `diagnose` says, and how far held-out recordings are replayed.

    python3 tests/peers/identification/textbook.py PROGRAM COUNT [FIRST_SEED] [FOLDER] [--table]

Each seed draws a kind of machine, its size over two decades, every value by up to 30 %, and one thing that the project file does not state or
states wrongly; every fifth machine conceals nothing. axis.c, compiled with `cc`, records five experiments under the controller that the
project names; three are diagnosed and two are held out. One line a machine is kept in FOLDER/answers.jsonl, so that a run that was stopped
goes on. --table prints the table of what is there.
"""
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).parent
COUNTS_GEAR, COUNTS_LOAD = 2 * math.pi / 4096, 2 * math.pi / 40960


def joint(v):
    v.update(rotor=1e-4, ratio=100, stiffness=2e4, damping=6, inertia=0.5, motor_viscous=1e-4, viscous=1.0, motor_coulomb=0.02, coulomb=2.0,
             out_of_balance=0.5, torque_constant=0.1, gain=2.0, bandwidth=1885)
    v.control = dict(position=1, on_motor=1, kp=25, kv=7, ki=140, count=COUNTS_GEAR / 100)
    v.sensor = 'sensors.encoder = { place = "motor", counts = 4096 }'
    v.drive = 'drive = { kind = "current", limit = 20.0, bandwidth = %(bandwidth)r }'
    v.amplitude = 0.3


def pendulum(v):
    v.update(rotor=2e-6, ratio=20, inertia=0.004, motor_viscous=1e-6, viscous=0.002, coulomb=0.02, out_of_balance=0.02, torque_constant=0.02,
             voltage_drive=1, resistance=2.0, inductance=2e-4, gain=1.2)
    v.period = 2e-3
    v.control = dict(position=1, kp=12, kv=1.5, ki=10, count=COUNTS_LOAD)
    v.sensor = "sensors.encoder = { counts = 40960 }"
    v.drive = 'drive = { kind = "voltage", limit = 12.0 }'
    v.amplitude = 0.3


def direct(v):
    v.update(inertia=0.5, viscous=0.3, coulomb=0.4, torque_constant=1.0, gain=4.0)
    v.control = dict(kv=6, ki=90, sensor=600, noise=2e-4, converter=0)
    v.sensor = "sensors.hub_gyro = { noise = 2e-4, natural_frequency = 600.0, damping_ratio = 0.7 }"
    v.drive = 'drive = { kind = "torque", limit = %(ten)r }'
    v.amplitude = 0.4


def belt(v):
    v.update(rotor=3e-5, ratio=6, stiffness=3000, damping=4.0, inertia=0.02, motor_viscous=5e-5, viscous=0.1, motor_coulomb=0.02, coulomb=0.15,
             torque_constant=0.06, voltage_drive=1, resistance=1.2, inductance=6e-4, gain=2.4)
    v.control = dict(on_motor=1, kv=0.4, ki=6, noise=2e-3)
    v.sensor = 'sensors.tachometer = { place = "motor", noise = 1.2e-2 }'
    v.drive = 'drive = { kind = "voltage", limit = 24.0 }'
    v.amplitude = 1.2


KINDS = {"joint": joint, "pendulum": pendulum, "direct drive": direct, "belt axis": belt}
TORQUES = ("rotor", "stiffness", "damping", "inertia", "motor_viscous", "viscous", "motor_coulomb", "coulomb", "out_of_balance", "torque_constant")
SCALED = ("coulomb", "inertia", "viscous", "motor_coulomb", "torque_constant", "out_of_balance", "stiffness", "resistance")
NAMES = {
    "coulomb": {"pivot coulomb"}, "inertia": {"structure inertia"}, "viscous": {"pivot viscous"}, "motor_coulomb": {"motor coulomb"},
    "torque_constant": {"motor torque_constant"}, "out_of_balance": {"structure out_of_balance"}, "stiffness": {"gearbox stiffness"},
    "resistance": {"motor resistance"}, "spring": {"structure position_stiffness"}, "stribeck": {"pivot stribeck"}, "late": {"control delay"},
    "current_limit": {"amplifier current_limit"}, "cogging": {"motor cogging"}, "drift": {"pivot warm_up"},
    "bump": set(), "cubic": set(), "kt_wave": {"motor torque_ripple"}, "hard": set(),
}


class Values(dict):
    """The machine as its project file states it, and the same with what is concealed."""

    period = 1e-3


def machine(seed):
    draw = random.Random(seed)
    name = draw.choice(list(KINDS))
    v = Values()
    KINDS[name](v)
    size = 10 ** draw.uniform(-1, 1)
    for key in v:
        v[key] *= size if key in TORQUES else 1.0
        if key not in ("ratio", "voltage_drive", "gain"):
            v[key] *= draw.uniform(0.85, 1.15)
    if name in ("pendulum", "belt axis"):  # a winding of another size draws another current at the same voltage
        v["resistance"] *= size
        v["inductance"] *= size
    true = dict(v)
    concealed, how = conceal(draw, name, v, true)
    if name == "direct drive":
        v["gain"], true["gain"] = v["gain"] * v["torque_constant"], true["gain"]
    return name, v, true, concealed, how


def conceal(draw, name, v, true):
    """Changes the true machine in one respect; returns the key and what was done."""
    if draw.random() < 0.2:
        return None, "nothing"
    scaled = [key for key in SCALED if key in v and not (name == "direct drive" and key == "torque_constant")]
    keys = scaled + ["spring", "stribeck", "late", "cogging", "drift", "bump", "cubic", "hard"] + (["current_limit"] if "resistance" in v else [])
    key = draw.choice(keys)
    level, amplitude = v["coulomb"], v.amplitude
    angle = amplitude if v.control.get("position") else amplitude / (2 * math.pi * 0.4)
    rate = amplitude * 2 * math.pi * 0.5 if v.control.get("position") else amplitude
    size = 10 ** draw.uniform(-0.5, 0.5)
    if key in scaled:
        factor = draw.choice([-1, 1]) * draw.uniform(0.15, 0.6)
        true[key] *= math.exp(factor)
    elif key == "late":
        true["late"] = draw.choice([2, 3, 4])
    elif key == "current_limit":
        true[key] = size * 3 * level / (v["torque_constant"] * v["ratio"])
    elif key == "stribeck":
        true.update(stribeck=draw.uniform(0.3, 1.0), stribeck_rate=draw.uniform(0.05, 0.2) * rate)
    elif key == "drift":
        true[key] = draw.choice([-1, 1]) * draw.uniform(0.02, 0.06)
    elif key == "bump":
        true.update(bump=draw.uniform(0.4, 1.5), bump_at=(draw.uniform(-0.6, 0.6) + (0 if v.control.get("position") else 1)) * angle, bump_width=draw.uniform(0.08, 0.3) * angle)
    elif key == "cogging":
        per = v.get("ratio", 1)
        true.update(cogging=size * 0.3 * level / per, order=draw.choice([4, 6, 12]) if per > 1 else draw.choice([24, 36]))
    else:
        true[key] = size * level * {"spring": draw.choice([-0.5, 1.0]) / angle, "hard": 1 / angle**3, "cubic": 1 / rate**3}[key]
    return key, f"{key} {true[key]:.4g}" + (f", {v[key]:.4g} in the file" if key in v else "")


def project(name, v):
    text = ["format = 2", "[plant]", f'name = "{name}"']
    text.append(v.drive % {**v, "ten": 10 * v["gain"]})
    if "ratio" in v:
        elastic = f', stiffness = {v["stiffness"]!r}, damping = {v["damping"]!r}' if "stiffness" in v else ""
        text.append(f'gearbox = {{ ratio = {float(v["ratio"])!r}{elastic} }}')
        winding = f', resistance = {v["resistance"]!r}, inductance = {v["inductance"]!r}' if "resistance" in v else ""
        text.append(f'motor = {{ inertia = {v["rotor"]!r}, torque_constant = {v["torque_constant"]!r}{winding} }}')
        text.append(f'friction.motor = {{ model = "coulomb", coulomb = {v.get("motor_coulomb", 0.0)!r}, viscous = {v["motor_viscous"]!r} }}')
    text.append(f'friction.pivot = {{ model = "coulomb", coulomb = {v["coulomb"]!r}, viscous = {v["viscous"]!r} }}')
    text += [v.sensor, f"interface = {{ sample_period = {v.period!r} }}", "[plant.lumped]", f'hub_inertia = {v["inertia"]!r}']
    if "out_of_balance" in v:
        text.append(f'out_of_balance = {v["out_of_balance"]!r}')
    text.append("[recording_controller]")
    c = v.control
    if c.get("position"):
        text += ['kind = "position"', f'position_gain = {c["kp"]}.0', f'rate_gain = {float(c["kv"])}', f'rate_integral_gain = {float(c["ki"])}']
    else:
        text += ['kind = "pi"', f'kp = {float(c["kv"])}', f'ki = {float(c["ki"])}']
    text += ['anti_windup = "hold"', "[recording.channels]", 'demand = "demand"', 'control = "control"']
    text.append(f'{"hub_position" if c.get("position") else "hub_rate"} = "reading"')
    return "\n".join(text) + "\n"


def experiments(v):
    a = v.amplitude
    fast = 0.08 if v.control.get("position") else 0.3
    return {
        "fit/a.csv": dict(a1=a, f1=0.4, a2=fast * a, f2=3.1),
        "fit/b.csv": dict(a1=0, triangle=1.3 * a, ft=0.2),
        "fit/c.csv": dict(a1=0.5 * a, f1=1.1, a2=0.4 * a, f2=0.17),
        "held/d.csv": dict(a1=0.8 * a, f1=0.55, a2=fast * a, f2=2.3),
        "held/e.csv": dict(a1=0, square=0.15 * a, fs=0.3, a2=0.3 * a, f2=0.7),
    }


def record(axis, folder, v, true, seed):
    for place, (file, demand) in enumerate(experiments(v).items()):
        target = folder / file
        target.parent.mkdir(parents=True, exist_ok=True)
        values = {**{"period": v.period}, **true, **v.control, **demand, "seed": 10 * seed + place + 1}
        made = subprocess.run([axis] + [f"{key}={value!r}" for key, value in values.items()], capture_output=True, check=True)
        target.write_bytes(made.stdout)


def diagnose(program, folder):
    started = time.time()
    words = [program, "diagnose", folder / "project.toml", folder / "fit", "--held-out", folder / "held", "--save", folder / "improved.toml",
             f"--json={folder / 'answer.json'}", "-q"]
    done = subprocess.run(words, capture_output=True, text=True, timeout=1800)
    if done.returncode not in (0, 1):
        return dict(verdict="failed", why=done.stderr[-300:], seconds=time.time() - started)
    answer = json.loads((folder / "answer.json").read_text())
    floors = {"before": 1.0, "after": 1.0}
    for held in answer["held_out_recordings"]:
        for side in floors:
            worst = max(c[side] / c["floor"] for c in held["channels"].values())
            floors[side] = max(floors[side], worst)
    removed = [held["power_removed"] for held in answer["held_out_recordings"]]
    findings = [dict(name=f'{f["component"]} {f["effect"]}', probability=f["probability"], others=[f'{o["component"]} {o["effect"]}' for o in f["alternatives"]])
                for f in answer["findings"]]
    return dict(verdict=answer["verdict"], findings=findings, removed=min(removed), seconds=time.time() - started, **floors)


def judge(row):
    """What an answer is worth: right, offered (among those that cannot be told apart), component, unnamed but modelled, missed, false alarm."""
    found = [f["name"] for f in row.get("findings", [])]
    modelled = row.get("after", 9e9) <= 1.5 or row.get("removed", 0) >= 0.95
    if row["concealed"] is None:
        return "right" if row["verdict"] == "consistent" else "false alarm"
    right = NAMES[row["concealed"]]
    if row.get("before", 9e9) < 1.3 and not found:
        return "hidden"
    if right & set(found) and len(found) == 1:
        return "right"
    if right & {o for f in row["findings"] for o in f["others"]} or right & set(found):
        return "offered"
    if not right and any("unknown" in name for name in found) and modelled:
        return "right"
    return "modelled" if modelled else "missed"


def table(rows):
    print("| seed | machine | concealed | answer | held-out floors before, after | judged | s |\n|---|---|---|---|---|---|---|")
    for row in rows:
        found = "; ".join(f'{f["name"]} {100 * f["probability"]:.0f} %' for f in row.get("findings", [])) or row["verdict"]
        print(f'| {row["seed"]} | {row["kind"]} | {row["how"]} | {found} | {row.get("before", 0):.1f}, {row.get("after", 0):.2f} | {judge(row)} | {row["seconds"]:.0f} |')
    verdicts = [judge(row) for row in rows]
    print("\n" + ", ".join(f"{verdicts.count(word)} {word}" for word in dict.fromkeys(verdicts)))
    stated = [(f["probability"], f["name"] in NAMES.get(row["concealed"], set())) for row in rows for f in row.get("findings", []) if "unknown" not in f["name"]]
    for low, high in ((0, 0.3), (0.3, 0.6), (0.6, 0.9), (0.9, 1.01)):
        inside = [true for p, true in stated if low <= p < high]
        print(f"stated {low} to {high}: {sum(inside)} of {len(inside)} true")


def main():
    words = [word for word in sys.argv[1:] if word != "--table"]
    program, count = str(pathlib.Path(words[0]).resolve()), int(words[1])
    first = int(words[2]) if len(words) > 2 else 1
    base = pathlib.Path(words[3] if len(words) > 3 else tempfile.mkdtemp())
    base.mkdir(parents=True, exist_ok=True)
    axis = base / "axis"
    subprocess.run(["cc", "-O2", "-o", axis, HERE / "axis.c", "-lm"], check=True)
    kept = base / "answers.jsonl"
    rows = [json.loads(line) for line in kept.read_text().splitlines()] if kept.exists() else []
    if "--table" not in sys.argv:
        for seed in range(first, first + count):
            if any(row["seed"] == seed for row in rows):
                continue
            name, v, true, concealed, how = machine(seed)
            folder = base / str(seed)
            folder.mkdir(exist_ok=True)
            (folder / "project.toml").write_text(project(name, v))
            record(axis, folder, v, true, seed)
            row = dict(seed=seed, kind=name, concealed=concealed, how=how, **diagnose(program, folder))
            rows.append(row)
            with kept.open("a") as out:
                out.write(json.dumps(row) + "\n")
    table(rows)


main()
