"""Breaks the machine or the controller of the reference rig on purpose, one part at a time, and measures the claims that stand on this part:
each of them must fail.

    python tests/peers/results/broken_claims.py PROGRAM examples/reference-rig [NAME ...]

With names, only these breakages are tried. The script fails if a row holds although what it rests on is broken.
"""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

# name of the breakage: (what is changed: section, key, value; claims that rest on it)
BREAKAGES = {
    "stepped-beam": (
        [("plant.beam.section rear tube", "outer_diameter", "[0.40, 0.06]")],
        ["C1", "C2", "C4", "C30"],
    ),
    "soft-beam": ([("plant.beam", "youngs_modulus", "4e8")], ["C3", "C9"]),
    "cheap-control": ([("synth.feedback.control", "gain", "0.1")], ["C5", "C27"]),
    "control-for-nothing": ([("synth.feedback.control", "gain", "0.01")], ["C28"]),
    "friction-of-a-hundredth": (
        [("plant.friction.pivot", "coulomb", "1.17"), ("plant.friction.motor", "coulomb", "0.00065")],
        ["C8", "C11", "C15", "C16", "C18", "C21", "F3"],
    ),
    "tenfold-friction": (
        [("plant.friction.pivot", "coulomb", "1170.0"), ("plant.friction.motor", "coulomb", "0.65")],
        ["C23", "C33", "C34"],
    ),
    "balanced": (
        [("plant.lumped", "out_of_balance", "5.0")],
        ["C12", "C13", "C22", "C24", "F4"],
    ),
    # a key that the file does not have stands behind one that it has
    "misread-rate": ([("plant.sensors.hub_gyro", "noise", "2.0e-4\ngain = 1.3")], ["C26"]),
    "coarse-readings": ([("plant.interface", "input_bits", "6")], ["C19"]),
    "misread-acceleration": ([("plant.sensors.platform_accelerometer", "noise", "5.0e-3\ngain = 1.3")], ["F1"]),
    "coarse-control": ([("plant.interface", "output_bits", "6")], ["C20"]),
    "feedforward-hardly-asked": (
        [
            ("synth.pitch.error", "gain", "0.3"),
            ("synth.heave.error", "gain", "0.3"),
            ("plant.lumped", "vertical_offset", "60.0"),
        ],
        ["C6", "C7"],
    ),
    # what is left is the base's motion, and friction no part of it
    "feedforward-hardly-asked-and-half-the-friction": (
        [
            ("synth.pitch.error", "gain", "0.3"),
            ("synth.heave.error", "gain", "0.3"),
            ("plant.lumped", "vertical_offset", "60.0"),
            ("plant.friction.pivot", "coulomb", "60.0"),
        ],
        ["C32"],
    ),
    # half as much again out of balance takes more than the drive's torque
    "loud-heave": ([("verify.heave", "amplitude", "20.0")], ["C14"]),
    "light-hub": ([("plant.lumped", "hub_inertia", "5.0")], ["C10"]),
    "raised-mass": ([("plant.lumped", "vertical_offset", "60.0")], ["C31"]),
    "friction-of-one-end": ([("plant.friction.pivot", "coulomb", "0.5")], ["C17"]),
    "soft-tip": ([("plant.lumped", "stiffness", "1.5e5")], ["F2"]),
}


def heading(section):
    """The line that opens a section; one of a list is found by its name."""
    table, _, name = section.partition(" ")
    if name:
        return rf"\[\[{re.escape(table)}\]\]\s*\nname = \"{re.escape(name)}\""
    return rf"\[{re.escape(table)}\]"


def changed(text, section, key, value):
    # a value ends at a comment or at the end of its line
    pattern = rf"(?m)(^{heading(section)}[^\n]*\n(?:(?!\[)[^\n]*\n)*?{key} = )[^#\n]*"
    found, count = re.subn(pattern, lambda match: match.group(1) + value + " ", text, count=1)
    if count != 1:
        raise SystemExit(f"[{section}] has no key {key}")
    return found


def measured(program, project, edits, rows):
    """The findings of the rows on the broken project; a string if there is no design."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        shutil.copytree(project, folder / "broken")
        path = folder / "broken" / "project.toml"
        text = path.read_text()
        for edit in edits:
            text = changed(text, *edit)
        path.write_text(text)
        command = [program, "claims", str(folder / "broken"), "--quiet", "--only", ",".join(rows)]
        command += [f"--json={folder / 'claims.json'}", "--report", str(folder / "claims.html")]
        ran = subprocess.run(command, capture_output=True, text=True)
        if not (folder / "claims.json").exists():
            return ran.stderr.strip()
        return json.loads((folder / "claims.json").read_text())["claims"]


def main():
    program, project, *names = sys.argv[1:]
    failed, touched = [], set()
    print("| broken | claim | finding | what fails |\n|---|---|---|---|")
    for name in names or BREAKAGES:
        edits, rows = BREAKAGES[name]
        claims = measured(program, project, edits, rows)
        if isinstance(claims, str):
            print(f"| {name} | {', '.join(rows)} | no result | {claims} |", flush=True)
            failed += rows
            continue
        for claim in claims:
            touched.add(claim["id"])
            wrong = [one for one in claim["criteria"] if one["agreement"] == "disagrees"]
            what = "; ".join(f"{one['what']}: {one['measured']}" for one in wrong)
            print(f"| {name} | {claim['id']} | {claim['finding']} | {what} |", flush=True)
            if claim["finding"] != "fails":
                failed.append(claim["id"])
    print(f"\n{len(touched)} rows, of which {len(touched - set(failed))} fail when broken")
    if failed:
        print("do not fail:", ", ".join(failed))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
