"""Applies what `counterpoise verify` advises for requirements that fail to the project file, verifies again, and compares the figure with what was promised.

    python tests/peers/results/advice.py PROGRAM PROJECT_FOLDER...

Each requirement of the list below is set a few percent beyond what the project reaches, on the linear plant. Every advised change is written into a copy of the
file with the digits that the file then has.
"""

import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

# Figure, side of the limit, and the share by which it is to be missed.
ASKED = [
    ("gain_margin_db", "at_least", 0.05),
    ("phase_margin_deg", "at_least", 0.03),
    ("max_sensitivity", "at_most", 0.03),
    ("delay_margin_s", "at_least", 0.1),
    ("linear_step_overshoot_percent", "at_most", 0.1),
    ("heave_compensated_drr_db at 1 Hz", "at_most", 0.03),
]
# The file holds the advised value with twelve digits; the figure is found from designs that differ by their rounding.
TOLERANCE = 1e-6


def verified(program, file):
    said = subprocess.run([program, "verify", file, "--plant", "linear", "-q", "--json"], capture_output=True, text=True, check=False)
    if said.returncode not in (0, 1):
        raise SystemExit(said.stderr)
    return json.loads(said.stdout)


def values(found):
    return {one["figure"]: one["value"] for one in found["figures"]}


def with_factor(text, key, factor):
    """The file with one number multiplied."""
    table, name = key.rsplit(".", 1)
    start = text.index(f"[{table}]")
    end = text.find("\n[", start)
    part = text[start : end if end > 0 else len(text)]
    changed = re.sub(rf"(?m)^({name} = )([-+.\deE]+)", lambda m: f"{m[1]}{float(m[2]) * factor:.12g}", part, count=1)
    if changed == part:
        raise SystemExit(f"{key}: not found in the file")
    return text.replace(part, changed, 1)


def with_requirements(text, reached):
    text = re.sub(r"(?ms)^\[\[verify\.requirement\]\].*?(?=^\[|\Z)", "", text)
    for figure, side, share in ASKED:
        value = reached.get(figure)
        if value is not None:
            limit = value + (1.0 if side == "at_least" else -1.0) * share * abs(value)
            text += f'\n[[verify.requirement]]\nfigure = "{figure}"\n{side} = {limit:.9g}\n'
    return text


def main(program, *folders):
    count, wrong = 0, 0
    for folder in folders:
        with tempfile.TemporaryDirectory() as room:
            copy = Path(room) / "copy"
            shutil.copytree(folder, copy)
            file = copy / "project.toml"
            base = with_requirements(file.read_text(), values(verified(program, file)))
            file.write_text(base)
            for advice in verified(program, file)["advice"]:
                change, figure = advice.get("change"), advice["figure"]
                if not change:
                    print(f"{folder}: {figure}: no weight moves it")
                    continue
                file.write_text(with_factor(base, change["weight"], change["factor"]))
                mine = values(verified(program, file))[figure]
                off = abs(mine - change["value"]) / abs(change["value"])
                holds = mine >= advice["limit"] if change["value"] > advice["value"] else mine <= advice["limit"]
                count += 1
                good = off <= TOLERANCE and holds == change["holds"]
                wrong += not good
                print(f"{folder}: {figure} {advice['value']:.6g}, limit {advice['limit']:.6g}: {change['weight']} x {change['factor']:.4g} promises "
                      f"{change['value']:.6g}, gives {mine:.6g} (off by {off:.1e}); holds {holds}{'' if good else '  WRONG'}")
    print(f"{count} suggestions applied, {count - wrong} as promised")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
