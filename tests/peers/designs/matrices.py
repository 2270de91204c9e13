"""Writes the matrices of an imported structure with pyYeti's OUTPUT4 writer, text and binary, and compares the plants that Counterpoise makes of them.

    pip install pyyeti scipy
    python tests/peers/designs/matrices.py target/release/counterpoise [examples/imported-structure]

pyYeti reads and writes Nastran's files and was written by other people. The script fails if a plant's matrices differ from those of the Matrix Market files.
"""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np
import scipy.io
from pyyeti.nastran import op4

def plant(program, folder):
    done = subprocess.run([program, "model", folder, "--json", "-q"], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{folder}: {done.stderr}")
    found = json.loads(done.stdout)
    return np.array(found["plant"]["A"]), np.array(found["poles_rad_s"])


def main(program, example):
    expected, poles = plant(program, str(example))
    mass, stiffness = (scipy.io.mmread(example / name).toarray() for name in ("mass.mtx", "stiffness.mtx"))
    text = (example / "project.toml").read_text()
    text = text.replace('format = "matrix-market"', 'format = "op4"').replace('"mass.mtx"', '"all.op4"')
    text = text.replace('"stiffness.mtx"', '"all.op4"\nmass_name = "MGG"\nstiffness_name = "KGG"')
    with tempfile.TemporaryDirectory() as place:
        for binary in (True, False):
            for endian in ("<", ">") if binary else ("",):
                for form in ("dense", "bigmat", "nonbigmat"):
                    folder = pathlib.Path(place) / f"{binary}{form}{'b' if endian == '>' else ''}"
                    folder.mkdir()
                    shutil.copy(example / "nodes.map", folder)
                    (folder / "project.toml").write_text(text)
                    op4.write(str(folder / "all.op4"), ["MGG", "KGG"], [mass, stiffness], binary=binary, sparse=form, endian=endian)
                    found, own_poles = plant(program, str(folder))
                    change = np.abs(own_poles - poles).max() / np.abs(poles).max()
                    exact = np.array_equal(found, expected)
                    assert change < 1e-9 and (exact or not binary), f"{folder.name}: poles change by {change:.1e}"
                    print(f"{'binary' if binary else 'text'} {endian} {form}: poles within {change:.1e}{', every bit of A the same' if exact else ''}")


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    root = pathlib.Path(__file__).resolve().parents[3]
    main(sys.argv[1], pathlib.Path(sys.argv[2]) if len(sys.argv) == 3 else root / "examples/imported-structure")
