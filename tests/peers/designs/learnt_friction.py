"""The reference rig without friction compensation, with a fixed friction observer and with one whose level is learnt, on machines whose friction is not the stated one.

    python3 tests/peers/designs/learnt_friction.py PROGRAM [COUNT]

The observers know the friction of the drawing. First the true friction is a factor of it (level and presliding stiffness of motor and pivot alike), and `verify` measures the hub
rate on the rig's road and sines after the level has been learnt; beside it stand the machine without friction, and a fixed observer that knows the true friction. Then COUNT machines (200) have factors of
their own at motor and pivot, presliding stiffness and inertia, in a campaign: on the road, and at rest after it, for which the road is followed by stillness. Needs pyarrow.
"""

import csv
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import pyarrow.parquet

RIG = pathlib.Path(__file__).resolve().parents[3] / "examples" / "reference-rig"
MOTOR, PIVOT = {"coulomb": 0.065, "rest_stiffness": 1.3}, {"coulomb": 117.0, "rest_stiffness": 2.4e5}
ROAD, BOTH, REST = "nonlinear_road_compensated_hub_rms_rad_s", "nonlinear_both_compensated_hub_rms_rad_s", "rest_hub_rms_rad_s"
VARIATIONS = {"motor_friction": (0.5, 1.5), "pivot_friction": (0.5, 1.5), "presliding_stiffness": (0.7, 1.4), "hub_inertia": (0.9, 1.1)}


def observer(share, factor=1.0, learning=False):
    sides = ""
    for side, friction in (("motor", MOTOR), ("pivot", PIVOT)):
        values = "".join(f"{key} = {value * factor!r}\n" for key, value in friction.items())
        sides += f'[synth.observer.{side}]\nmodel = "dahl"\n{values}'
    learnt = "[synth.observer.learning]\n" if learning else ""
    return f"\n[synth.observer]\nshare = {share}\n{learnt}{sides}"


def rig(friction, block, duration=25.0, settle=14.0, road=(2.0, 26.0), recording="sandy-loam.parquet"):
    """The rig's project with a factor on its friction, longer runs of which the end counts, and a block of `[synth]`."""
    text = (RIG / "project.toml").read_text().split("# --- robustness")[0]
    for key, value in (*MOTOR.items(), *PIVOT.items()):
        text, count = re.subn(rf"(?m)^{key} = {re.escape(written(value))} ", f"{key} = {value * friction!r} ", text)
        assert count == 1, key
    verify = f"[verify]\nduration = {duration}\nsettle = {settle}\nseed = 1\n"
    text, count = re.subn(r"\[verify\]\n(?:[a-z].*\n)+", verify, text)
    assert count == 1
    text = text.replace("\nstart = 5.0 ", f"\nstart = {road[0]} ").replace("\nduration = 20.0", f"\nduration = {road[1]}")
    return text.replace("sandy-loam.parquet", recording) + block


def written(value):
    return {2.4e5: "2.4e5"}.get(value, repr(value))


def road_then_still(folder, seconds=24.0, still=14.0):
    """Writes the road faded out, and stillness after it."""
    table = pyarrow.parquet.read_table(folder / "sandy-loam.parquet").to_pydict()
    time = next(name for name in table if name.startswith("t"))
    start, step = table[time][0], table[time][1] - table[time][0]
    kept = sum(t - start <= seconds for t in table[time])
    others = [name for name in table if name != time]
    means = {name: sum(table[name][:kept]) / kept for name in others}
    with open(folder / "still.csv", "w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow([time, *others])
        for k in range(kept + int(still / step)):
            fade = min(max((seconds - k * step) / 1.0, 0.0), 1.0) if k < kept else 0.0
            rows.writerow([k * step, *(means[name] + fade * (table[name][min(k, kept - 1)] - means[name]) for name in others)])


def run(program, command, text, folder):
    (folder / "project.toml").write_text(text)
    out = folder / "result.json"
    ran = subprocess.run([program, command, str(folder / "project.toml"), "-q", f"--json={out}"], capture_output=True, text=True, cwd=folder, check=False)
    assert ran.returncode in (0, 1), ran.stderr
    return json.loads(out.read_text())


def verified(program, text, folder):
    found = {verdict["figure"]: verdict["value"] for verdict in run(program, "verify", text, folder)["verdicts"]}
    return [1e3 * found[figure] for figure in (ROAD, BOTH, REST)]


def campaign(program, text, folder, count):
    varied = "".join(f'[[sweep.variation]]\nparameter = "{name}"\nlow = {low}\nhigh = {high}\n' for name, (low, high) in VARIATIONS.items())
    figures = {row["figure"]: row for row in run(program, "sweep", f"{text}\n[sweep]\nsamples = {count}\n{varied}", folder)["figures"]}
    return [1e3 * value for value in (figures[ROAD]["median"], figures[ROAD]["q95"], figures[ROAD]["worst_case"]["value"])]


def main():
    program, count = str(pathlib.Path(sys.argv[1]).resolve()), int(sys.argv[2]) if len(sys.argv) > 2 else 200
    folder = pathlib.Path(tempfile.mkdtemp())
    shutil.copy(RIG / "sandy-loam.parquet", folder)
    road_then_still(folder)
    print("| true friction | controller | road, mrad/s | sines, mrad/s | at rest before, mrad/s |\n|---|---|---|---|---|")
    row = lambda *cells: print("| " + " | ".join(cell if isinstance(cell, str) else f"{cell:.3g}" for cell in cells) + " |", flush=True)
    row("none", "no observer", *verified(program, rig(1e-4, ""), folder))
    for factor in (0.5, 1.0, 1.5):
        row(f"{factor} times", "no observer", *verified(program, rig(factor, ""), folder))
        row(f"{factor} times", "fixed, stated level", *verified(program, rig(factor, observer(1.0)), folder))
        row(f"{factor} times", "fixed, true level", *verified(program, rig(factor, observer(0.95, factor)), folder))
        row(f"{factor} times", "learnt level", *verified(program, rig(factor, observer(0.95, learning=True)), folder))
    print(f"\n| {count} machines | controller | median, mrad/s | 95 %, mrad/s | worst case, mrad/s |\n|---|---|---|---|---|")
    for kind, change in (("on the road", {}), ("at rest after the road", {"duration": 36.0, "settle": 26.0, "road": (0.0, 36.0), "recording": "still.csv"})):
        for name, block in (("no observer", ""), ("fixed, stated level", observer(1.0)), ("learnt level", observer(0.95, learning=True))):
            row(kind, name, *campaign(program, rig(1.0, block, **change), folder, count))
    shutil.rmtree(folder)


if __name__ == "__main__":
    main()
