"""Commissions random machines whose physics is concealed, beside a designer who knows the true machine.

    python3 tests/peers/commissioning/evidence.py PROGRAM COUNT SEED FOLDER [--table]

PROGRAM is the `counterpoise` binary. The machines are those of `examples/machines/python/make_machines.py COUNT SEED`: values off by up to 30 %, one to three
effects that the project lacks, some of them shapes that no law of the library has, some of them faults of sensors. Each is commissioned by the machine program in Python,
which shares no code with the product. The designer who knows has a project with the true values and with those hidden effects that a project can state, without
tolerances, and one round. FOLDER keeps everything, and a machine that is finished there is not run again; `--table` only prints.
"""

import csv
import json
import pathlib
import re
import statistics
import subprocess
import sys
import time
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
DRIVER = HERE.parents[2] / "examples" / "machines" / "python"
LIMITS = {"angle": 0.5, "rate": 0.5}
ROUNDS = 5
LONGEST_S = 1800.0


def run_commission(program, project, truth, folder, rounds):
    """Returns the story of a commissioning, its exit code, its time and what it said last."""
    story = folder.with_suffix(".json")
    command = [program, "commission", str(project), "--machine", f"python3 {DRIVER / 'machine.py'} {truth}", "-o", str(folder), "--rounds", str(rounds), f"--json={story}"]
    command += [word for key, value in LIMITS.items() for word in (f"--{key}", str(value))]
    begin = time.monotonic()
    try:
        ran = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST_S, check=False)
        code, said = ran.returncode, ran.stderr
    except subprocess.TimeoutExpired:
        code, said = None, f"no end within {LONGEST_S:.0f} s"
    rounds = json.loads(story.read_text())["rounds"] if story.exists() else []
    return {"rounds": rounds, "exit": code, "seconds": time.monotonic() - begin, "said": said.strip().splitlines()[-3:]}


def toml(value):
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml(one)}" for key, one in value.items() if one is not None) + " }"
    return repr(value)


def known_project(drawn_text, truth):
    """Returns the project of a designer who knows the true machine, as far as a project can state it."""
    structure, gear, motor = (truth.get(name, {}) for name in ("structure", "gear", "motor"))
    text = re.sub(r"\{ value = ([^,]+), tolerance = [^}]+\}", r"\1", drawn_text)
    cable, hose = structure.get("cable", {}), structure.get("hose", {})
    sections = {"lumped": {key: structure.get(key) for key in ("hub_inertia", "beam_inertia", "stiffness", "damping", "out_of_balance")} | {
        "position_stiffness": cable.get("stiffness"), "position_stiffness_centre": cable.get("centre"),
        "hysteresis": hose.get("torque"), "hysteresis_stiffness": hose.get("stiffness")}}
    if gear:
        sections["gearbox"] = {key: gear.get(key) for key in ("ratio", "stiffness", "damping", "backlash")}
    if motor:
        sections["motor"] = {key: motor.get(key) for key in ("inertia", "torque_constant", "resistance", "inductance", "cogging", "torque_ripple")}
    for key, values in sections.items():
        text = re.sub(rf"^{key} = .*$", f"{key} = {toml(values)}", text, flags=re.M)
    pivot = truth["friction"]["pivot"]
    text = re.sub(r"^coulomb = .*$", f"coulomb = {pivot['coulomb']!r}", text, flags=re.M)
    extra = [f"asymmetry = {pivot['asymmetry']!r}"] if "asymmetry" in pivot else []
    if "motor" in truth["friction"]:
        side = truth["friction"]["motor"]
        extra += ["", "[plant.friction.motor]", 'model = "dahl"', f"coulomb = {side['coulomb']!r}", f"rest_stiffness = {side['stiffness']!r}"]
    text = text.replace("\n[plant.sensors]", "\n".join([*extra, "", "[plant.sensors]"]), 1)
    gyro = truth["sensors"]["hub_rate"]
    period = float(re.search(r"sample_period = ([0-9.e-]+)", drawn_text)[1])
    stated = {key: gyro[key] for key in ("gain", "bias") if key in gyro}
    if "delay_samples" in gyro:
        stated["delay"] = gyro["delay_samples"] * period
    more = "".join(f", {key} = {value!r}" for key, value in stated.items())
    text = re.sub(r"^(hub_gyro = \{.*) \}$", rf"\1{more} }}", text, flags=re.M)
    return text


def true_figures(folder):
    """Returns the extremes of all recordings of a commissioning, and the number of runs that the machine stopped."""
    largest = {"hub_position": 0.0, "hub_rate": 0.0}
    aborted = 0
    for answer in folder.glob("round-*/*/answer.json"):
        aborted += json.loads(answer.read_text())["ended"] == "aborted"
        with open(answer.parent / "recording.csv", newline="") as file:
            rows = csv.reader(file)
            names = [name.split(" [")[0] for name in next(rows)]
            values = [[float(value) for value in row] for row in rows]
        for name in largest.keys() & set(names):
            column = names.index(name)
            start = values[0][column] if name == "hub_position" else 0.0
            largest[name] = max(largest[name], max(abs(row[column] - start) for row in values))
    return {"angle": largest["hub_position"], "rate": largest["hub_rate"], "aborted": aborted}


def summary(outcome, folder):
    """Returns what one commissioning came to."""
    rounds = outcome["rounds"]
    figures = []
    for one in rounds:
        figures.append({asked["figure"]: asked["measured"] if asked["measured"] is not None else asked["predicted"] for asked in one["requirements"]})
    machine_s = sum(run["duration_s"] for one in rounds for run in one["runs"])
    missed = [asked["figure"] for asked in rounds[-1]["requirements"] if not asked["holds"]] if rounds else []
    stop = (rounds[-1]["stop"] or {}) if rounds else {"reason": "failed", "why": " ".join(outcome["said"])}
    return {
        "rounds": len(rounds), "machine_s": machine_s, "seconds": outcome["seconds"], "stop": stop, "missed": missed, "figures": figures,
        "residuals": [(one["residual_before"], one["residual_after"]) for one in rounds],
        "findings": [[f"{found['component']}: {found['effect']}" for found in one["findings"]] for one in rounds],
        "left_out": [one["left_out"] for one in rounds], "crossovers": [one["crossover_rad_s"] for one in rounds], **true_figures(folder),
    }


def commission(program, name, folder):
    """Runs one machine, or returns what was kept of it."""
    kept = folder / "results" / f"{name}.json"
    if kept.exists():
        return json.loads(kept.read_text())
    drawn, truth = folder / "machines" / f"{name}.toml", folder / "machines" / f"{name}-truth.toml"
    known = folder / "machines" / f"{name}-known.toml"
    known.write_text(known_project(drawn.read_text(), tomllib.loads(truth.read_text())))
    result = {}
    for role, project, rounds in (("commissioned", drawn, ROUNDS), ("known", known, 1)):
        target = folder / role / name
        target.parent.mkdir(parents=True, exist_ok=True)
        result[role] = summary(run_commission(program, project, truth, target, rounds), target)
    kept.parent.mkdir(parents=True, exist_ok=True)
    kept.write_text(json.dumps(result, indent=1) + "\n")
    return result


TRIANGLE = "nonlinear_triangle_error_rms_rad_s"
REST = "rest_hub_rms_rad_s"
STEP = "nonlinear_step_settling_time_s"


def figure(one, key, unit=1.0):
    value = one["figures"][-1].get(key) if one["figures"] else None
    return "none" if value is None else f"{value * unit:.3g}"


def print_table(results, hidden):
    print("| machine | hidden | rounds | machine time, s | stop | missed | error of the triangle, mrad/s: first, last, known | at rest, mrad/s: last, known | settling, s: last, known |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name, result in results.items():
        mine, known = result["commissioned"], result["known"]
        first = {"figures": mine["figures"][:1]}
        print(
            f"| {name[-3:]} | {', '.join(hidden[name]['hidden'])} | {mine['rounds']} | {mine['machine_s']:.0f} | {mine['stop'].get('reason')} | {', '.join(mine['missed']) or '-'}"
            f" | {figure(first, TRIANGLE, 1e3)}, {figure(mine, TRIANGLE, 1e3)}, {figure(known, TRIANGLE, 1e3)}"
            f" | {figure(mine, REST, 1e3)}, {figure(known, REST, 1e3)} | {figure(mine, STEP)}, {figure(known, STEP)} |")


def print_totals(results):
    met = lambda one: one["stop"].get("reason") == "requirements-met"
    able = [result for result in results.values() if met(result["known"])]
    unable = [result for result in results.values() if not met(result["known"])]
    both = [result for result in able if met(result["commissioned"])]
    print(f"\n{len(results)} machines; the designer who knows meets the requirements on {len(able)}, and of these the commissioning on {len(both)}")
    print(f"of the {len(unable)} others, {sum(not met(result['commissioned']) for result in unable)} ended with a refusal")
    ratios = [
        result["commissioned"]["figures"][-1][TRIANGLE] / result["known"]["figures"][-1][TRIANGLE]
        for result in results.values()
        if result["commissioned"]["figures"] and result["known"]["figures"] and result["known"]["figures"][-1].get(TRIANGLE) and result["commissioned"]["figures"][-1].get(TRIANGLE)]
    print(f"error of the triangle over that of the designer who knows: median {statistics.median(ratios):.2f}, largest {max(ratios):.2f}")
    commissioned = [result["commissioned"] for result in results.values()]
    for key, unit in (("rounds", ""), ("machine_s", " s of machine time"), ("seconds", " s elapsed")):
        values = [one[key] for one in commissioned]
        print(f"{key}: median {statistics.median(values):.3g}{unit}, largest {max(values):.3g}")
    print(
        f"runs that the machine stopped: {sum(one['aborted'] for one in commissioned)}; largest readings {max(one['angle'] for one in commissioned):.3f} rad"
        f" of {LIMITS['angle']}, {max(one['rate'] for one in commissioned):.3f} rad/s of {LIMITS['rate']}")


def main():
    words = [word for word in sys.argv[1:] if word != "--table"]
    if len(words) != 4:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    program, count, seed, folder = words[0], int(words[1]), words[2], pathlib.Path(words[3]).resolve()
    subprocess.run([sys.executable, str(DRIVER / "make_machines.py"), str(count), seed, str(folder / "machines")], check=True)
    hidden = json.loads((folder / "machines" / "hidden.json").read_text())
    results = {}
    for name in hidden:
        if "--table" in sys.argv and not (folder / "results" / f"{name}.json").exists():
            continue
        results[name] = commission(program, name, folder)
        mine, known = results[name]["commissioned"], results[name]["known"]
        if "--table" not in sys.argv:
            print(f"{name} {mine['stop'].get('reason')} in {mine['rounds']} rounds, {mine['seconds']:.0f} s; known {known['stop'].get('reason')}", flush=True)
    print_table(results, hidden)
    print_totals(results)
    return 0


if __name__ == "__main__":
    sys.exit(main())
