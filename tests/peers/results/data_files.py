"""Reads the files that `--data` writes and compares every number with the JSON result: the MATLAB file with SciPy, the tables with pandas.

    counterpoise design PROJECT -o out --histories --data out/data --json=result.json
    python tests/peers/results/data_files.py result.json out/data [--octave]

The script fails if a number of the JSON result is not in the MATLAB file, bit for bit and at its place, if a table cannot be read, if a history or a
response of the result has no table with its numbers, or if a column of a history or a response carries no unit. With --octave it also lets Octave compare the
matrices of every system.
"""

import json
import math
import pathlib
import re
import subprocess
import sys
import warnings

import numpy as np
import pandas
import scipy.io

# before version 4, pandas needs to be asked for the nearest number; from then on it is the default, and asking warns
warnings.filterwarnings("ignore", message=".*float_precision.*")

#: Columns whose numbers have no unit: a count, a state that is on or off, a sum of a mean.
PURE = {"contact", "sample", "curve"}


def field_name(key):
    """Returns a key as a name of MATLAB."""
    name = re.sub(r"[^A-Za-z0-9_]", "_", key)[:63]
    return name if name[:1].isalpha() else f"x{name}"[:63]


class Comparison:
    """The numbers, texts and truth values that agree."""

    def __init__(self):
        self.numbers = self.texts = self.missing = 0

    def same(self, value, found, place):
        if value is None:
            assert np.size(found) == 0 or (np.size(found) == 1 and np.isnan(np.ravel(found)[0])), f"{place}: {found} for a missing value"
            self.missing += 1
        elif isinstance(value, bool):
            assert bool(np.ravel(found)[0]) == value and np.size(found) == 1, place
        elif isinstance(value, (int, float)):
            number = float(np.ravel(found)[0])
            assert np.size(found) == 1 and number == value and math.copysign(1, number) == math.copysign(1, value), f"{place}: {found} for {value}"
            self.numbers += 1
        elif isinstance(value, str):
            text = str(np.ravel(found)[0]) if np.size(found) else ""
            assert text == value, f"{place}: {text!r} for {value!r}"
            self.texts += 1
        elif isinstance(value, dict):
            assert found.dtype.names is not None and len(found.dtype.names) == len(value) or not value, f"{place}: other fields"
            for key, inner in value.items():
                self.same(inner, np.ravel(found)[0][field_name(key)], f"{place}.{key}")
        else:
            self.same_list(value, found, place)

    def same_list(self, value, found, place):
        if not value:
            assert np.size(found) == 0, place
        elif all(is_number(one) for one in value):
            assert found.shape == (len(value), 1), f"{place}: shape {found.shape}"
            self.same_array(np.array([np.nan if one is None else one for one in value], dtype=float), found[:, 0], place)
        elif is_matrix(value):
            rows = np.array([[np.nan if one is None else one for one in row] for row in value], dtype=float)
            assert found.shape == rows.shape, f"{place}: shape {found.shape} for {rows.shape}"
            self.same_array(rows, found, place)
        else:
            assert found.shape == (len(value), 1), f"{place}: shape {found.shape} for {len(value)}"
            for k, inner in enumerate(value):
                one = found[k, 0]
                self.same(inner, np.array([[one]], dtype=found.dtype) if found.dtype.names else one, f"{place}.{k}")

    def same_array(self, expected, found, place):
        same = (expected == found) & (np.signbit(expected) == np.signbit(found)) | np.isnan(expected) & np.isnan(found)
        assert same.all(), f"{place}: {np.count_nonzero(~same)} numbers differ"
        self.missing += int(np.isnan(expected).sum())
        self.numbers += int((~np.isnan(expected)).sum())


def is_number(value):
    return value is None or isinstance(value, (int, float)) and not isinstance(value, bool)


def is_matrix(value):
    rows = all(isinstance(row, list) and all(is_number(one) for one in row) for row in value)
    return rows and len({len(row) for row in value}) == 1


def curves(value, place=""):
    """Yields the histories and the responses of a result with their places."""
    if isinstance(value, dict):
        if "sample_time_s" in value and "start_s" in value:
            yield place, value, "history"
        elif "frequency_hz" in value and "real" in value:
            yield place, value, "response"
        for key, inner in value.items():
            yield from curves(inner, f"{place}.{key}" if place else key)
    elif isinstance(value, list):
        names = [one.get("name") if isinstance(one, dict) else None for one in value]
        for k, inner in enumerate(value):
            own = names[k] if isinstance(names[k], str) and names[k] and names.count(names[k]) == 1 else str(k)
            yield from curves(inner, f"{place}.{own}")


def numbers(values):
    return np.array([np.nan if one is None else one for one in values], dtype=float)


def compare_tables(result, folder):
    """Compares the tables with the histories and responses of the result; returns how many were compared."""
    contents = pandas.read_csv(folder / "contents.csv", keep_default_na=False)
    tables = {row.table: pandas.read_csv(folder / row.file, keep_default_na=False, na_values=[""], float_precision="round_trip") for row in contents.itertuples()}
    for row in contents.itertuples():
        assert len(tables[row.table]) == row.rows, f"{row.file}: {len(tables[row.table])} rows"
    histories = responses = 0
    for place, curve, kind in curves(result):
        if kind == "history":
            listed = {key: values for key, values in curve.items() if isinstance(values, list) and len(values) > 1 and all(map(is_number, values))}
            if not listed:
                continue
            table = tables[place]
            time = curve["start_s"] + np.arange(len(table)) * curve["sample_time_s"]
            assert (table["time_s"].to_numpy() == time).all(), f"{place}: other times"
            for key, values in listed.items():
                assert np.array_equal(table[key].to_numpy(dtype=float), numbers(values), equal_nan=True), f"{place}.{key}"
                assert key in PURE or re.search(r"_(rad|m|s|v|a|mpa|nm|n|s2|deg|hz|db)$", key), f"{place}.{key} carries no unit"
            histories += 1
        else:
            within, _, own = place.rpartition(".")
            together = within in tables and "frequency_hz" in tables[within]
            table = tables[within] if together else tables[place]
            assert np.array_equal(table["frequency_hz"].to_numpy(), numbers(curve["frequency_hz"])), place
            for part in ("real", "imaginary"):
                named = [name for name in table if re.fullmatch(re.escape(f"{curve['name']}, {part} [") + r"[^\]]+\]", name)]
                assert len(named) == 1 or not together, f"{place}: columns {named}"
                column = table[named[0]] if together else table[part]
                assert np.array_equal(column.to_numpy(), numbers(curve[part]), equal_nan=True), f"{place}.{part}"
                assert not together or "()" not in named[0], f"{named[0]} carries no unit"
            responses += 1
    return len(tables), histories, responses


def main(arguments):
    result = json.loads(pathlib.Path(arguments[0]).read_text())
    folder = pathlib.Path(arguments[1])
    found = scipy.io.loadmat(folder / "result.mat", struct_as_record=True, squeeze_me=False, chars_as_strings=True)
    comparison = Comparison()
    for key, value in result.items():
        if key != "schema" or field_name(key) in found:
            comparison.same(value, found[field_name(key)], key)
    tables, histories, responses = compare_tables(result, folder)
    for path in sorted((folder / "figures").glob("*.csv")):
        pandas.read_csv(path)
    figures = len(list((folder / "figures").glob("*.csv")))
    print(f"result.mat: {comparison.numbers} numbers, {comparison.texts} texts, {comparison.missing} missing values, all the same")
    print(f"{tables} tables, of them {histories} histories and {responses} responses compared; {figures} tables of figures read")
    if "--octave" in arguments:
        script = pathlib.Path(__file__).with_name("data_files.m")
        done = subprocess.run(["octave-cli", "--norc", str(script), str(folder / "result.mat"), arguments[0]], capture_output=True, text=True)
        print(done.stdout.strip() or done.stderr.strip())
        assert done.returncode == 0


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1:])
