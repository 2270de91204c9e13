"""Checks the simulator against closed forms, and the machine program against its protocol and against Counterpoise's own simulator.

    python3 examples/machines/python/check_machine.py PROGRAM

PROGRAM is the `counterpoise` binary. Ends with 0 if every check holds. Takes about half a minute.
"""

import csv
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

# Nothing is written beside the program: the folder belongs to the product.
sys.dont_write_bytecode = True
import simulator  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
PERIOD = 1e-3
failures = []


def check(name, value, expected, tolerance):
    """Prints one comparison, with the tolerance relative to the expected value (absolute where that is 0)."""
    error = abs(value - expected) / (abs(expected) or 1.0)
    holds = error <= tolerance
    print(f"{'holds' if holds else 'FAILS'}  {name}: {value:.9g}, expected {expected:.9g}, error {error:.1e} (at most {tolerance:.0e})")
    if not holds:
        failures.append(name)


def check_true(name, holds, detail=""):
    print(f"{'holds' if holds else 'FAILS'}  {name}{': ' + detail if detail else ''}")
    if not holds:
        failures.append(name)


def machine(stated, **options):
    return simulator.Machine(simulator.complete_truth(stated), PERIOD, **options)


def crossing_times(values, period):
    """Returns the times at which a signal rises through zero, by linear interpolation."""
    pairs = enumerate(zip(values, values[1:]))
    return [(index + before / (before - after)) * period for index, (before, after) in pairs if before < 0.0 <= after]


def frequency(values, period):
    times = crossing_times(values, period)
    return 2.0 * math.pi * (len(times) - 1) / (times[-1] - times[0])


def check_free_motion():
    """Motion without control."""
    axis = machine({"structure": {"hub_inertia": 2.0}, "friction": {"pivot": {"viscous": 3.0}}})
    axis.set(w_h=1.0)
    for _ in range(1000):
        axis.advance(0.0)
    check("rate of a damped inertia after 1 s", axis.get("w_h"), math.exp(-1.5), 1e-9)
    check("angle of a damped inertia after 1 s", axis.get("phi"), (1.0 - math.exp(-1.5)) / 1.5, 1e-9)

    axis = machine({"structure": {"hub_inertia": 2.0, "beam_inertia": 5.0, "stiffness": 1e4}})
    axis.set(th_b=1e-3)
    twist = []
    for _ in range(3000):
        twist.append(axis.get("th_h") - axis.get("th_b"))
        axis.advance(0.0)
    check("frequency of two inertias, rad/s", frequency(twist, PERIOD), math.sqrt(1e4 * (1.0 / 2.0 + 1.0 / 5.0)), 1e-5)

    axis = machine({"structure": {"hub_inertia": 2.0, "out_of_balance": 3.0}}, start_angle=-0.5 * math.pi + 1e-3)
    swing = []
    for _ in range(6000):
        swing.append(axis.get("th_h") + 0.5 * math.pi)
        axis.advance(0.0)
    check("frequency of a hanging pendulum, rad/s", frequency(swing, PERIOD), math.sqrt(3.0 * 9.80665 / 2.0), 1e-5)

    structure = {"hub_inertia": 2.0, "beam_inertia": 5.0, "stiffness": 1e4, "out_of_balance": 3.0, "vertical_offset": 1.0,
                 "cable": {"stiffness": 20.0, "centre": 0.1, "cubic": 50.0}}
    axis = machine({"structure": structure, "gear": {"ratio": 20.0, "stiffness": 5e4}, "motor": {"inertia": 1e-3}})
    axis.set(w_h=0.5, w_b=0.5, w_m=10.0)
    before, largest, kinetic = energy(axis), 0.0, 0.0
    for _ in range(5000):
        axis.advance(0.0)
        largest = max(largest, abs(energy(axis) - before))
        kinetic = max(kinetic, 0.5 * 2.0 * axis.get("w_h") ** 2)
    check("drift of the energy over 5 s, as a part of the largest kinetic energy", largest / kinetic, 0.0, 1e-5)


def energy(axis):
    """Returns the energy of a machine with hub, beam, gear, motor, gravity and cable."""
    structure, gear, motor = (axis.truth[key] for key in ("structure", "gear", "motor"))
    now = axis.observe()
    mu, nu, gravity = structure["out_of_balance"], structure["vertical_offset"], structure["gravity"]
    cable = structure["cable"]
    pull = now["phi"] - cable["centre"]
    return (
        0.5 * structure["hub_inertia"] * now["w_h"] ** 2 + 0.5 * structure["beam_inertia"] * now["w_b"] ** 2 + 0.5 * motor["inertia"] * now["w_m"] ** 2
        + 0.5 * structure["stiffness"] * (now["th_h"] - now["th_b"]) ** 2 + 0.5 * gear["stiffness"] * now["delta"] ** 2
        + gravity * (mu * math.sin(now["th_h"]) + nu * math.cos(now["th_h"])) + 0.5 * cable["stiffness"] * pull**2 + 0.25 * cable["cubic"] * pull**4
    )


def check_drives_and_friction():
    axis = machine({
        "structure": {"hub_inertia": 1e9}, "motor": {"torque_constant": 0.5, "resistance": 2.0, "inductance": 0.01},
        "drive": {"kind": "voltage", "limit": 50.0},
    })
    for _ in range(5):
        axis.advance(4.0)
    check("current of a stalled armature after 5 ms, A", axis.get("i"), 10.0 * (1.0 - math.exp(-0.005 * 2.0 / 0.01)), 1e-8)

    axis = machine({
        "structure": {"hub_inertia": 1e9}, "motor": {"torque_constant": 0.86, "resistance": 0.8, "inductance": 4e-3},
        "drive": {"kind": "amplifier", "gain": 30.0, "current_feedback": 0.3067, "time_constant": 1.5e-3, "input_limit": 10.0, "bus_voltage": 150.0},
    })
    for _ in range(500):
        axis.advance(1.0)
    check("static gain of an amplifier with current feedback, A/V", axis.get("i"), 30.0 / (0.8 + 30.0 * 0.3067), 1e-6)

    axis = machine({"structure": {"hub_inertia": 1.0}, "friction": {"pivot": {"coulomb": 2.0, "stiffness": 300.0}}})
    axis.set(w_h=1.0)
    for _ in range(30):
        axis.advance(0.0)
    now = axis.observe()
    check("Dahl's torque over displacement, N m", now["F_pivot"], 2.0 * (1.0 - math.exp(-300.0 * now["phi"] / 2.0)), 1e-8)

    axis = machine({"structure": {"hub_inertia": 1.0}, "friction": {"pivot": {"model": "smooth", "coulomb": 2.0, "tight_spots": [
        {"angle": 0.2, "width": 0.01, "height": 0.5}]}}})
    axis.set(th_h=0.2, w_h=1.0)
    check("friction in a tight spot, N m", axis.get("F_pivot"), 3.0, 1e-9)

    gear = {"ratio": 10.0, "stiffness": 1e4, "backlash": 2e-3}
    axis = machine({"structure": {"hub_inertia": 1.0}, "gear": gear, "motor": {"inertia": 1e-3}})
    for delta, torque in ((0.5e-3, 0.0), (1.5e-3, 5.0), (-2e-3, -10.0)):
        axis.set(th_m=10.0 * delta)
        check(f"torque of a gear with backlash at {delta} rad, N m", axis.get("T_2"), torque, 1e-9)


def check_base_and_sensors():
    rate = 0.3
    base = simulator.Base(PERIOD, [rate] * 3001, [0.0] * 3001)
    sensors = {"hub_rate": {}, "hub_position": {}, "platform_rate": {}, "motor_rate": {}}
    axis = machine({"structure": {"hub_inertia": 2.0}, "gear": {"ratio": 5.0}, "sensors": sensors}, base=base)
    axis.set(w_h=0.0)
    for _ in range(1000):
        axis.advance(0.0)
    readings, _ = axis.read()
    check("rate of a free hub on a pitching base, rad/s", readings["hub_rate"], 0.0, 1e-12)
    check("its angle on the platform, rad", readings["hub_position"], -rate, 1e-9)
    check("rate of its motor, rad/s", readings["motor_rate"], -5.0 * rate, 1e-9)

    axis = machine({"structure": {"hub_inertia": 2.0}, "friction": {"pivot": {"viscous": 3.0}}}, base=base)
    axis.set(w_h=0.0)
    for _ in range(1000):
        axis.advance(0.0)
    check("rate of a hub that the base drags along, rad/s", axis.get("w_h"), rate * (1.0 - math.exp(-1.5)), 1e-9)

    base = simulator.Base(PERIOD, [0.0] * 101, [1.5] * 101)
    axis = machine({"structure": {"hub_inertia": 2.0, "out_of_balance": 0.2, "gravity": 0.0}}, base=base)
    for _ in range(100):
        axis.advance(0.0)
    check("rate after 0.1 s of heave, rad/s", axis.get("w_h"), -0.2 * 1.5 / 2.0 * 0.1, 1e-6)

    # The response of the rate's reading to a step, at 0.7 of critical damping.
    wn, z = 300.0, 0.7
    axis = machine({"structure": {"hub_inertia": 2.0}, "sensors": {"hub_rate": {"natural_frequency": wn, "damping_ratio": z}}})
    axis.set(w_h=1.0)
    for _ in range(6):
        axis.advance(0.0)
    wd = wn * math.sqrt(1.0 - z * z)
    expected = 1.0 - math.exp(-z * wn * 6e-3) * (math.cos(wd * 6e-3) + z * wn / wd * math.sin(wd * 6e-3))
    check("reading of a gyroscope 6 ms after a step of the rate", axis.read()[0]["hub_rate"], expected, 1e-7)

    axis = machine({
        "structure": {"hub_inertia": 2.0}, "interface": {"input_bits": 12, "output_bits": 8, "delay_samples": 2}, "sensors": {"hub_position": {"scale": 5.0}},
    })
    axis.set(th_h=0.1234)
    check("reading of a converter of 12 bits", axis.read()[0]["hub_position"], round(0.1234 * 5.0 / (20.0 / 4096)) * 20.0 / 4096 / 5.0, 1e-12)
    check("control of a converter of 8 bits", axis.convert(3.3), round(3.3 / (20.0 / 256)) * 20.0 / 256, 1e-12)
    for control in (1.0, 2.0, 3.0):
        axis.advance(control)
    check("control that acts two samples late", axis.control, 1.0, 1e-12)


PLAIN = """format = 2
[plant]
name = "plain axis"
gravity = 0.0
inertia = 2.0
drive = { kind = "torque", limit = 20.0 }
sensors = { hub_gyro = {} }
interface = { sample_period = 1e-3 }
[[synth.block]]
kind = "gain"
gain = 15.0
"""
PLAIN_TRUTH = """[structure]
hub_inertia = 2.0
[drive]
kind = "torque"
limit = 20.0
[sensors.hub_rate]
"""
# sight.toml as it is drawn.
DRAWN_TRUTH = """seed = 3
[structure]
hub_inertia = 0.9
out_of_balance = 0.12
[gear]
ratio = 40.0
stiffness = 1.5e4
damping = 3.0
[motor]
inertia = 1.2e-4
torque_constant = 0.11
[drive]
kind = "current"
limit = 8.0
bandwidth = 2000.0
[friction.pivot]
coulomb = 1.5
stiffness = 500.0
viscous = 1.1
[sensors.hub_rate]
natural_frequency = 500.0
noise = 5e-4
scale = 10.0
[sensors.hub_position]
noise = 2e-5
scale = 5.0
[sensors.motor_rate]
noise = 0.02
scale = 0.1
[sensors.platform_rate]
scale = 10.0
noise = 2e-4
[sensors.platform_accel]
scale = 1.0
noise = 2e-3
[interface]
input_bits = 16
output_bits = 12
delay_samples = 1
"""
RECORDED_WITH = """
[recording_controller]
kind = "exported"
file = "controller/controller.json"
"""


def export(program, project, folder):
    """Exports the controller of a project and writes `machine_step.c` beside it."""
    folder.mkdir(parents=True, exist_ok=True)
    done = subprocess.run([program, "design", "-q", str(project), "-o", str(folder)], capture_output=True, text=True, check=False)
    if not (folder / "controller.h").is_file():
        raise SystemExit(f"{program} design {project} wrote no controller:\n{done.stdout}{done.stderr}")
    places = ("demand", "hub_rate", "platform_rate", "platform_accel", "motor_rate", "hub_position", "surge")
    body = (folder / "controller.h").read_text()
    names = re.search(r"typedef struct \{([^}]*)\} controller_readings;", body)[1]
    lines = []
    for name in re.findall(r"controller_real (\w+);", names):
        lines.append(f"    r.{name} = in[{next(i for i, place in enumerate(places) if name.startswith(place))}];")
    (folder / "machine_step.c").write_text("\n".join([
        '#include "controller.c"', "static controller_state state;", "void machine_start(void);", "double machine_step(const double in[7]);",
        "void machine_start(void) { controller_init(&state); }", "double machine_step(const double in[7])", "{", "    controller_readings r;", *lines,
        "    return controller_step(&state, &r);", "}", "",
    ]))


def controller_hash(folder):
    return json.loads((folder / "controller" / "controller.json").read_text())["project_hash"]


def write_request(folder, run, demand, motion=None, limits=None):
    """Writes a request as `counterpoise commission` does; returns the folder of the run."""
    hash_of_controller = controller_hash(folder)
    folder = folder / run
    folder.mkdir(parents=True)
    request = {
        "protocol": 1, "round": 1, "run": run, "sample_period_s": PERIOD, "samples": len(demand), "start_angle_rad": 0.0,
        "limits": limits or {"angle_rad": 1.0, "rate_rad_s": 1.0, "current_a": None}, "controller_hash": hash_of_controller,
        "columns": ["demand", "control", "hub_rate", "platform_rate", "platform_accel", "motor_rate", "hub_position"],
    }
    (folder / "request.json").write_text(json.dumps(request))
    rows = [f"{k * PERIOD:.6f},{value!r}" for k, value in enumerate(demand)]
    (folder / "demand.csv").write_text("time [s],demand [rad/s]\n" + "\n".join(rows) + "\n")
    if motion:
        rows = [f"{k * PERIOD:.6f},{rate!r},{heave!r}" for k, (rate, heave) in enumerate(motion)]
        (folder / "motion.csv").write_text("time [s],platform_rate [rad/s],platform_accel [m/s^2]\n" + "\n".join(rows) + "\n")
    return folder


def run_machine(truth, folder):
    """Runs the machine program; returns its answer and the columns of its recording."""
    done = subprocess.run([sys.executable, str(HERE / "machine.py"), str(truth), str(folder)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return {"ended": f"exit code {done.returncode}: {done.stderr.strip()}"}, {}
    with open(folder / "recording.csv", newline="") as file:
        rows = list(csv.reader(file))
    columns = {title: [float(text) for text in column] for title, column in zip(rows[0], zip(*rows[1:]))}
    return json.loads((folder / "answer.json").read_text()), columns


def check_loop(program, folder):
    """The step response of an integrator under proportional feedback: e[k + 1] = (1 - k T / J) e[k]."""
    (folder / "plain.toml").write_text(PLAIN)
    (folder / "plain-truth.toml").write_text(PLAIN_TRUTH)
    export(program, folder / "plain.toml", folder / "controller")
    answer, columns = run_machine(folder / "plain-truth.toml", write_request(folder, "step", [0.1] * 400))
    expected = {"protocol": 1, "controller_hash": controller_hash(folder), "ended": "complete", "reason": ""}
    check_true("the run of the plain axis is complete", answer == expected, str(answer))
    rates, controls = columns["hub_rate [rad/s]"], columns["control [V]"]
    factor = 1.0 - 15.0 * 2.0 * PERIOD / 2.0
    worst = max(abs(rate - 0.1 * (1.0 - factor**k)) for k, rate in enumerate(rates))
    check("largest error of the step response of a first-order loop, rad/s", worst, 0.0, 1e-9)
    worst = max(abs(control - 15.0 * (0.1 - rate)) for control, rate in zip(controls, rates))
    check("largest error of the exported controller's control, V", worst, 0.0, 1e-7)

    limits = {"angle_rad": 1.0, "rate_rad_s": 0.08, "current_a": None}
    answer, columns = run_machine(folder / "plain-truth.toml", write_request(folder, "aborted", [0.1] * 400, limits=limits))
    check_true("a rate beyond its limit stops the machine", answer["ended"] == "aborted" and "rate" in answer["reason"], str(answer.get("reason")))
    check_true("the recording ends there", max(columns["hub_rate [rad/s]"]) <= 0.08 and len(columns["time [s]"]) < 400)

    run = write_request(folder, "broken", [0.1] * 400)
    (run / "demand.csv").write_text("time [s],demand [rad/s]\n0.0,0.0\n")
    answer, _ = run_machine(folder / "plain-truth.toml", run)
    check_true("a request that contradicts itself ends with an exit code", "exit code 1" in answer["ended"], answer["ended"])


    run = write_request(folder, "other", [0.1] * 400)
    request = json.loads((run / "request.json").read_text())
    (run / "request.json").write_text(json.dumps(request | {"controller_hash": "0" * 32}))
    answer, _ = run_machine(folder / "plain-truth.toml", run)
    check_true("a controller with another hash is not run", "exit code 1" in answer["ended"] and not (run / "recording.csv").exists(), answer["ended"])


def triangle(time, peak, period):
    phase = (time / period) % 1.0
    return peak * (4.0 * phase if phase < 0.25 else 2.0 - 4.0 * phase if phase < 0.75 else 4.0 * phase - 4.0)


def check_replay(program, folder):
    """Counterpoise's simulator replays what this one records, to about the noise."""
    project = folder / "project.toml"
    project.write_text((HERE / "sight.toml").read_text())
    (folder / "truth.toml").write_text(DRAWN_TRUTH)
    export(program, project, folder / "controller")
    project.write_text((HERE / "sight.toml").read_text() + RECORDED_WITH)
    times = [k * PERIOD for k in range(4000)]
    runs = {
        "triangle": ([triangle(t, 0.1, 4.0) for t in times], None),
        "road": ([0.0] * len(times), [(0.1 * math.sin(6.3 * t), 1.5 * math.sin(9.4 * t)) for t in times]),
    }
    for run, (demand, motion) in runs.items():
        answer, columns = run_machine(folder / "truth.toml", write_request(folder, run, demand, motion))
        check_true(f"the run {run} of the sight is complete", answer["ended"] == "complete", answer["ended"])
        steps = [control / (20.0 / 4096) for control in columns["control [V]"]]
        check(f"its control is in steps of 12 bits ({run})", max(abs(step - round(step)) for step in steps), 0.0, 1e-6)
        recording = folder / f"{run}.csv"
        recording.write_text((folder / run / "recording.csv").read_text())
        done = subprocess.run([program, "replay", "-q", str(project), str(recording)], capture_output=True, text=True, check=False)
        for channel in ("control", "hub_rate", "hub_position", "motor_rate"):
            found = re.search(rf"^\s+{channel}\s+(\S+)\s+(\S+)\s+(\S+)\s", done.stdout, re.MULTILINE)
            ratio = float(found[3]) if found else math.inf
            # The start from rest and the platform's own noise are not in the model's floor.
            check_true(f"replay of {run}: {channel} is reproduced to twice the noise floor", ratio < 2.0, f"{ratio:.2f} noise floors")


def main():
    if len(sys.argv) != 2:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    check_free_motion()
    check_drives_and_friction()
    check_base_and_sensors()
    with tempfile.TemporaryDirectory() as folder:
        for name, checks in (("plain", check_loop), ("sight", check_replay)):
            (pathlib.Path(folder) / name).mkdir()
            checks(sys.argv[1], pathlib.Path(folder) / name)
    print(f"{len(failures)} checks fail" if failures else "every check holds")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
