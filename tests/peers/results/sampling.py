"""Puts each error of a sampled loop into projects and shows that the nonlinear figures of `verify` answer to it, that the linear ones do not, that
`sweep` varies it and its worst case holds it, and that a requirement is traced from its source to its test.

    python tests/peers/results/sampling.py PROGRAM examples/direct-gimbal examples/left-out-friction ...

The script fails if an error changes no nonlinear figure, changes a linear one, or is missing in the sweep.
"""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

CLOCK = {"sample_jitter": "1e-4", "missed_samples": "0.05", "late_samples": "0.1", "missing_codes": "0.2"}
DRIFT = {"angle_random_walk": "1e-4", "bias_instability": "1e-4", "rate_random_walk": "1e-4"}
VARIED = list(CLOCK) + ["gyro_drift"]
# converters of which a code can be missing, and a range that suits a rate
CONVERTER = {"input_bits": "14"}
RANGE = {"scale": "10.0"}
SOURCE = "specification 3.2.1"


def with_keys(text, table, keys):
    """Puts keys into a table, written under its heading or in braces, in place of those that are there."""
    for key, value in keys.items():
        under = re.compile(rf"(?m)^(\[plant\.(?:sensors\.)?{table}\][^\n]*\n(?:(?!\[)[^\n]*\n)*)")
        braces = re.compile(rf"(\b{table} = \{{)([^{{}}]*)\}}")
        if under.search(text):
            body = under.search(text).group(1)
            kept = re.sub(rf"(?m)^{key} = [^\n]*\n", "", body)
            text = text.replace(body, kept.rstrip("\n") + f"\n{key} = {value}\n\n", 1)
        elif braces.search(text):
            body = braces.search(text).group(2)
            kept = re.sub(rf",?\s*{key} = [^,}}]*", "", body).strip()
            text = braces.sub(rf"\1 {kept}, {key} = {value} }}", text, count=1)
        else:
            raise SystemExit(f"there is no table {table}")
    return text


def result(program, project, text, *command):
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        shutil.copytree(project, folder / "project")
        (folder / "project" / "project.toml").write_text(text)
        where = ["-o", str(folder / "out")] if command[0] == "sweep" else []
        call = [program, *command, str(folder / "project"), *where, "--quiet", f"--json={folder / 'result.json'}"]
        ran = subprocess.run(call, capture_output=True, text=True)
        if not (folder / "result.json").exists():
            raise SystemExit(f"{project}: {ran.stderr}")
        return json.loads((folder / "result.json").read_text())


def figures(program, project, text):
    found = result(program, project, text, "verify")["figures"]
    return {one["figure"]: (one["value"], one["basis"] == "linear") for one in found}


def changes(base, other):
    moved = [name for name in base if base[name][0] != other[name][0]]
    linear = [name for name in moved if base[name][1]]
    return len(moved) - len(linear), linear


def without(text, table):
    return re.sub(rf"(?ms)^\[+{table}\b[^\n]*\n(?:(?!\[)[^\n]*\n?)*", "", text)


def judged(program, project, text):
    """The sweep of a project with every error, each varied, and the trace of its requirement."""
    text = without(without(without(text, r"sweep\.variation"), r"sweep\.family"), "sweep")
    text = without(text, r"verify\.requirement").rstrip() + "\n"
    text += f'[[verify.requirement]]\nfigure = "nonlinear_step_overshoot_percent"\nat_most = 200.0\nsource = "{SOURCE}"\n'
    text += "[sweep]\nsamples = 8\n"
    for name in VARIED:
        text += f'[[sweep.variation]]\nparameter = "{name}"\nlow = 0.5\nhigh = 2.0\n'
    trace = [one for one in result(program, project, text, "verify")["verdicts"] if one["source"] == SOURCE]
    figure = result(program, project, text, "sweep")["figures"][0]
    return trace, figure


def main():
    program, *projects = sys.argv[1:]
    wrong = []
    print("| project | error | nonlinear figures that differ | linear ones that differ |\n|---|---|---|---|")
    for project in projects:
        text = (pathlib.Path(project) / "project.toml").read_text()
        text = with_keys(with_keys(text, "interface", CONVERTER), "hub_gyro", RANGE)
        base = figures(program, project, text)
        every = text
        for table, keys in (("interface", CLOCK), ("hub_gyro", DRIFT)):
            for key, value in keys.items():
                every = with_keys(every, table, {key: value})
                moved, linear = changes(base, figures(program, project, with_keys(text, table, {key: value})))
                print(f"| {project} | {key} | {moved} | {len(linear)} |", flush=True)
                if moved == 0 or linear:
                    wrong.append(f"{project}: {key}: {moved} nonlinear, linear: {linear}")
        trace, figure = judged(program, project, every)
        worst = figure["worst_case"]
        spread = f"{figure['q05']:.4g} to {figure['q95']:.4g}, worst case {worst['value']:.4g}"
        print(f"| {project} | sweep of {figure['figure']} | {spread} | |", flush=True)
        if {name for name, _ in worst["factors"]} != set(VARIED) or not figure["q05"] < figure["q95"]:
            wrong.append(f"{project}: sweep: {figure}")
        if len(trace) != 1 or not all(trace[0][key] for key in ("judged_by", "acceptance_test")):
            wrong.append(f"{project}: trace: {trace}")
        else:
            print(f"| {project} | trace | {trace[0]['source']}; {trace[0]['judged_by']}; {trace[0]['acceptance_test']} | |")
    print("\n".join(["", *wrong]) if wrong else "\nevery error shows in nonlinear figures alone, in the sweep and its worst case")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
