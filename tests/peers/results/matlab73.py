"""A result as a MATLAB file of version 7.3, read by another program and compared with the same result as JSON.

    python tests/peers/results/matlab73.py PROGRAM PROJECT [PROJECT ...]

`mat73` (PyPI) reads the file. Every value of the JSON result must be found again: numbers exactly, texts, truth values, lists of numbers as columns,
lists of rows as matrices, other lists as cells.
"""

import json
import math
import pathlib
import subprocess
import sys
import tempfile

import mat73
import numpy


def field_name(key):
    name = "".join(c if c.isascii() and c.isalnum() else "_" for c in key)[:63]
    name = name if name[:1].isascii() and name[:1].isalpha() else ("x" + name)[:63]
    return name + "_" if name in WORDS else name


# words of the language that a file of version 7.3 may not have as names, of those that results have
WORDS = {"methods", "properties", "events", "enumeration"}


def number(value):
    return math.nan if value is None else float(value)


def is_number(value):
    return value is None or (isinstance(value, (int, float)) and not isinstance(value, bool))


def same_numbers(found, wanted):
    return numpy.array_equal(numpy.asarray(found, float).ravel(), numpy.asarray(wanted, float).ravel(), equal_nan=True)


def compare(found, wanted, path, wrong):
    """Compares what a file holds with what it should; returns the number of values that were compared."""
    if isinstance(wanted, dict):
        if not wanted:
            return 1
        if not isinstance(found, dict):
            wrong.append(f"{path}: a structure is missing")
            return 0
        return sum(compare(found.get(field_name(k)), v, f"{path}.{k}", wrong) for k, v in wanted.items())
    if isinstance(wanted, list):
        if all(is_number(v) for v in wanted):
            good = len(wanted) == 0 or same_numbers(found, [number(v) for v in wanted])
        elif all(isinstance(v, bool) for v in wanted):
            good = list(numpy.atleast_1d(found).astype(bool).ravel()) == wanted
        elif all(isinstance(r, list) and len(r) == len(wanted[0]) and all(is_number(v) for v in r) for r in wanted):
            array = numpy.array([[number(v) for v in row] for row in wanted])
            good = array.size == 0 or same_numbers(numpy.asarray(found, float).reshape(array.shape), array)
        else:
            if not isinstance(found, list) or len(found) != len(wanted):
                wrong.append(f"{path}: a list of {len(wanted)} is missing")
                return 0
            # the reader gives a row of a column of cells as a list of one, unless it is a structure
            rows = [f[0] if isinstance(f, list) and len(f) == 1 else f for f in found]
            return sum(compare(f, w, f"{path}[{k}]", wrong) for k, (f, w) in enumerate(zip(rows, wanted)))
        if not good:
            wrong.append(f"{path}: {str(found)[:60]} for {str(wanted)[:60]}")
        return max(1, len(wanted))
    if wanted is None:
        good = found is None or numpy.size(found) == 0
    elif isinstance(wanted, str):
        good = (found or "") == wanted
    else:
        good = found is not None and (bool(found) == wanted if isinstance(wanted, bool) else float(found) == float(wanted))
    if not good:
        wrong.append(f"{path}: {found!r} for {wanted!r}")
    return 1


def main(program, projects):
    for project in projects:
        with tempfile.TemporaryDirectory() as place:
            folder = pathlib.Path(place)
            for command in (["model"], ["synth"], ["verify", "--histories"]):
                data, result = folder / command[0], folder / (command[0] + ".json")
                asked = [program, *command, project, "-q", "--data", data, "--matlab", "7.3", f"--json={result}"]
                subprocess.run(asked, stdout=subprocess.DEVNULL, check=False)
                wanted = json.loads(result.read_text())
                wanted.pop("schema", None)
                found = mat73.loadmat(data / "result.mat")
                wrong = []
                count = compare(found, wanted, command[0], wrong)
                print(f"{project} {command[0]}: {count} values, {len(wrong)} differ")
                if wrong:
                    sys.exit("\n".join(wrong[:10]))


main(sys.argv[1], sys.argv[2:])
