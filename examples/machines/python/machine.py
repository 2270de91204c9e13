"""A machine program for `counterpoise commission`: runs one experiment on a simulated machine that shares no code with Counterpoise.

    python3 examples/machines/python/machine.py TRUTH.toml FOLDER

TRUTH.toml states the true machine (README.md lists its keys), FOLDER holds the request (docs/reference/machine.md). The exported C of `FOLDER/../controller`
runs in the loop. Needs Python 3.11 and a C compiler, `cc` or the one that the environment variable CC names.
"""

import argparse
import csv
import ctypes
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

# Nothing is written beside the program: the folder belongs to the product.
sys.dont_write_bytecode = True
import simulator  # noqa: E402

PROTOCOL = 1


class RequestError(Exception):
    """A request that this program cannot carry out."""


class Controller:
    """The exported controller, compiled as a library. Its hash must be that of the request."""

    def __init__(self, folder, wanted_hash):
        self._check_hash(folder, wanted_hash)
        step = folder / "machine_step.c"
        if not step.is_file():
            raise RequestError(f"{step} is missing: `counterpoise commission` writes it beside the exported controller")
        self.folder = tempfile.TemporaryDirectory(prefix="machine-")
        library = pathlib.Path(self.folder.name) / "step.so"
        compiler = os.environ.get("CC", "cc").split()
        command = [*compiler, "-std=c99", "-O1", "-ffp-contract=off", "-shared", "-fPIC", "-iquote", str(folder), "-o", str(library), str(step)]
        try:
            built = subprocess.run(command, capture_output=True, text=True, check=False)
        except OSError as error:
            raise RequestError(f"the C compiler {compiler[0]} does not start ({error}): install one, or name it in CC") from error
        if built.returncode != 0:
            raise RequestError(f"the exported controller does not compile:\n{' '.join(command)}\n{built.stderr}")
        code = ctypes.CDLL(str(library))
        code.machine_start.restype = None
        code.machine_start.argtypes = []
        code.machine_step.restype = ctypes.c_double
        code.machine_step.argtypes = [ctypes.POINTER(ctypes.c_double)]
        code.machine_start()
        self._step = code.machine_step
        self._readings = (ctypes.c_double * 7)()

    @staticmethod
    def _check_hash(folder, wanted):
        path = folder / "controller.json"
        try:
            found = json.loads(path.read_text())["project_hash"]
        except (OSError, ValueError, KeyError) as error:
            raise RequestError(f"{path} states no project_hash, so the controller cannot be told from another one: export it again ({error})") from error
        if found != wanted:
            raise RequestError(f"{path} has the hash {found}, the request {wanted}: the folder holds another controller than the one to be run")

    def step(self, readings):
        """Returns the control in volts for the seven readings."""
        self._readings[:] = readings
        return self._step(self._readings)


def read_request(folder):
    """Returns `request.json`, checked."""
    try:
        request = json.loads((folder / "request.json").read_text())
    except (OSError, ValueError) as error:
        raise RequestError(f"{folder / 'request.json'} cannot be read: {error}") from error
    if request.get("protocol") != PROTOCOL:
        raise RequestError(f"the request has protocol {request.get('protocol')}: this program knows protocol {PROTOCOL}")
    missing = [key for key in ("sample_period_s", "samples", "controller_hash", "columns") if key not in request]
    if missing:
        raise RequestError(f"request.json lacks {', '.join(missing)}: see docs/reference/machine.md")
    return request


def column_name(header):
    """Returns the name in a header such as `hub_rate [rad/s]`."""
    return re.sub(r"\s*\[.*\]\s*$", "", header.strip())


def read_table(path, samples):
    """Returns the header and the columns of a CSV file, as texts by name; raises if it has not one row a sample."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    header = rows[0]
    if len(rows) - 1 != samples:
        raise RequestError(f"{path} has {len(rows) - 1} rows: the request asks for {samples} samples")
    columns = zip(*rows[1:])
    return [text.strip() for text in header], {column_name(name): [text.strip() for text in column] for name, column in zip(header, columns)}


def read_base(folder, request, moves):
    """Returns the motion of the base, or `None` if the run has none or the base cannot be moved."""
    path = folder / "motion.csv"
    if not moves or not path.is_file():
        return None
    _, columns = read_table(path, request["samples"])
    still = ["0.0"] * request["samples"]
    rates = [float(text) for text in columns.get("platform_rate", still)]
    heaves = [float(text) for text in columns.get("platform_accel", still)]
    return simulator.Base(request["sample_period_s"], rates, heaves)


def beyond_limits(true, limits, start_angle):
    """Returns why the machine must be stopped, or `None`. Angle (from the start) and rate are those of the hub relative to the platform."""
    for key, value, quantity in (
        ("angle_rad", true["phi"] - start_angle, "the hub's angle from its start on the platform is {:.4g} rad"),
        ("rate_rad_s", true["om"], "the hub's rate on the platform is {:.4g} rad/s"),
        ("current_a", true["i"], "the motor's current is {:.4g} A"),
    ):
        limit = limits.get(key)
        # A value that is no number is beyond every limit.
        if limit is not None and not abs(value) <= limit:
            return quantity.format(value) + f", beyond its limit of {limit:.4g}"
    return None


def run(truth, folder, request):
    """Runs the experiment; returns the rows of the recording as text with their header, and why it was stopped, or an empty text."""
    demand_header, columns = read_table(folder / "demand.csv", request["samples"])
    demand_texts = columns["demand"]
    time_texts = columns["time"]
    base = read_base(folder, request, truth["base_moves"])
    name = f"{request.get('round', 0)} {request.get('run', '')}"
    start_angle = float(request.get("start_angle_rad", 0.0))
    machine = simulator.Machine(truth, request["sample_period_s"], start_angle, base, name)
    controller = Controller(folder.parent / "controller", request["controller_hash"])

    fitted = list(truth["sensors"])
    recorded = [column for column in request["columns"] if column in fitted or column in ("demand", "control")]
    if truth["loop"] not in fitted:
        raise RequestError(f"the truth file closes the loop on {truth['loop']} but has no sensor of it: add [sensors.{truth['loop']}]")
    demand_title = next(title for title in demand_header if column_name(title) == "demand")
    if "[" not in demand_title:
        demand_title = f"demand [{simulator.UNITS[truth['loop']]}]"
    header = ["time [s]"] + [demand_title if column == "demand" else f"{column} [{simulator.UNITS[column]}]" for column in recorded]

    limits = request.get("limits") or {}
    rows = [",".join(header)]
    for sample, demand_text in enumerate(demand_texts):
        readings, true = machine.read()
        reason = beyond_limits(true, limits, start_angle)
        if reason is not None:
            return rows, f"at {time_texts[sample]} s {reason}"
        # The controller sees the numbers that are recorded, to the last digit.
        texts = {column: f"{value:.9e}" for column, value in readings.items()}
        values = {column: float(text) for column, text in texts.items()}
        control = controller.step((
            float(demand_text), values[truth["loop"]], values.get("platform_rate", 0.0), values.get("platform_accel", 0.0), values.get("motor_rate", 0.0),
            values.get("hub_position", 0.0), 0.0,
        ))
        if control != control:
            return rows, f"at {time_texts[sample]} s the controller gives no number"
        control = machine.convert(control)
        texts["demand"], texts["control"] = demand_text, f"{control:.9e}"
        rows.append(",".join([time_texts[sample]] + [texts[column] for column in recorded]))
        try:
            machine.advance(control)
        except (ValueError, OverflowError):
            return rows, f"after {time_texts[sample]} s the simulated motion grows without bound"
    return rows, ""


def write_whole(path, text):
    """Writes a file that appears under its name only when it is complete."""
    partial = path.with_name(path.name + ".partial")
    partial.write_text(text)
    os.replace(partial, path)


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Runs one experiment on a simulated machine.")
    parser.add_argument("truth", type=pathlib.Path, help="file of the true machine")
    parser.add_argument("folder", type=pathlib.Path, help="folder of the run, with request.json")
    options = parser.parse_args(arguments)
    try:
        truth = simulator.read_truth(options.truth)
        request = read_request(options.folder)
        rows, reason = run(truth, options.folder, request)
    except (RequestError, simulator.TruthError, OSError, ValueError, KeyError) as error:
        text = f"{error} is missing" if isinstance(error, KeyError) else str(error)
        print(f"machine.py: {text}", file=sys.stderr)
        return 1
    write_whole(options.folder / "recording.csv", "\n".join(rows) + "\n")
    answer = {
        "protocol": PROTOCOL, "controller_hash": request["controller_hash"], "ended": "aborted" if reason else "complete", "reason": reason,
    }
    write_whole(options.folder / "answer.json", json.dumps(answer) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
