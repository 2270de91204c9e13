"""A machine program for `counterpoise commission` that asks a person to run the experiment, and waits for the recording.

    python3 examples/machines/manual/machine.py FOLDER [--once] [--poll SECONDS]

It prints what to run, waits until recording.csv lies in FOLDER, checks it, asks for the hash that the target shows, and writes answer.json
(docs/reference/machine.md). A file hash.txt in FOLDER takes the place of the question; a file aborted.txt says why a run was stopped before its end. The
program may be interrupted and started again at any time: whatever already lies in the folder counts. With `--once` it does not wait: it ends with 1 if
something is missing. Needs nothing but Python 3.
"""

import argparse
import csv
import json
import math
import os
import pathlib
import re
import sys
import time

PROTOCOL = 1

# Largest distance of a sample from its place on an even grid, in sample periods: more is a lost sample, or another sample period.
LARGEST_SHIFT = 0.5


def say(text):
    print(text, flush=True)


def instructions(folder, request):
    """Returns what the person is to do."""
    limits = request.get("limits") or {}
    names = {"angle_rad": ("angle from the start", "rad"), "rate_rad_s": ("rate", "rad/s"), "current_a": ("current", "A")}
    stated = [f"{name} {limits[key]:g} {unit}" for key, (name, unit) in names.items() if limits.get(key) is not None]
    motion = "motion.csv: the motion of the base, for a base that can be moved" if (folder / "motion.csv").is_file() else None
    lines = [
        f"Round {request.get('round')}, run {request.get('run')!r}: {request['samples']} samples of {request['sample_period_s']:g} s",
        f"  folder      {folder}",
        f"  controller  {folder.parent / 'controller'}  (hash {request['controller_hash']})",
        f"  demand      {folder / 'demand.csv'}",
        f"  base        {motion}" if motion else "  base        at rest",
        f"  start       at rest at {request.get('start_angle_rad', 0.0):g} rad, the controller put to its start",
        f"  limits      {', '.join(stated) or 'none'}: stop the machine where it leaves them",
        f"Record time [s] and {', '.join(request['columns'])} (those that the machine has), one row a sample, and put the file here:",
        f"  {folder / 'recording.csv'}",
        "If the run was stopped before its end, write the reason into aborted.txt beside it.",
    ]
    return "\n".join(lines)


def read_recording(path, request):
    """Returns the number of samples of the recording and what is wrong with it, one text each."""
    with open(path, newline="") as file:
        rows = [row for row in csv.reader(file) if row]
    if not rows:
        return 0, ["recording.csv is empty"]
    names = [re.sub(r"\s*\[.*\]\s*$", "", title.strip()) for title in rows[0]]
    wrong = [f"the column {needed!r} is missing" for needed in ("time", "demand", "control") if needed not in names]
    if not any(name in names for name in request["columns"] if name not in ("demand", "control")):
        wrong.append("no sensor of the request was recorded")
    unknown = [name for name in names if name != "time" and name not in request["columns"]]
    if unknown:
        wrong.append(f"the request does not ask for the columns {', '.join(unknown)}: remove them or correct their names")
    count = len(rows) - 1
    if count > request["samples"]:
        wrong.append(f"it has {count} samples: the request asks for {request['samples']}")
    numbers = []
    for line, row in enumerate(rows[1:], start=2):
        try:
            values = [float(text) for text in row]
        except ValueError:
            values = [math.nan]
        if len(row) != len(names) or not all(math.isfinite(value) for value in values):
            wrong.append(f"line {line} does not hold {len(names)} numbers")
            break
        numbers.append(values)
    if "time" in names and len(numbers) == count and count > 1:
        column = names.index("time")
        period = request["sample_period_s"]
        for index, values in enumerate(numbers):
            shift = (values[column] - numbers[0][column]) / period - index
            if abs(shift) > LARGEST_SHIFT:
                wrong.append(f"sample {index} lies {shift:.3g} samples off an even sampling of {period:g} s: a sample was lost, or the period is another")
                break
    return count, wrong


def is_settled(path, poll):
    """Returns whether the file keeps its size for one poll, so that a copy in progress is not read."""
    before = path.stat()
    time.sleep(min(poll, 1.0))
    after = path.stat()
    return (before.st_size, before.st_mtime_ns) == (after.st_size, after.st_mtime_ns)


def wait_for_recording(folder, request, options):
    """Returns the number of samples of a sound recording, or `None` if there is none and `--once` forbids to wait."""
    path = folder / "recording.csv"
    refused = None
    while True:
        if path.is_file() and path.stat().st_mtime_ns != refused and (options.once or is_settled(path, options.poll)):
            count, wrong = read_recording(path, request)
            if not wrong:
                say(f"recording.csv: {count} samples")
                return count
            refused = path.stat().st_mtime_ns
            say("recording.csv is not that of the request:\n" + "\n".join(f"  {text}" for text in wrong) + "\nReplace it.")
        if options.once:
            if refused is None:
                say(f"{path} is not there")
            return None
        time.sleep(options.poll)


def stated_hash(folder, request, options):
    """Returns the hash that ran on the target if it is that of the request, or `None` if it is not and `--once` forbids to wait."""
    path = folder / "hash.txt"
    wanted = request["controller_hash"]
    asks = not options.once and sys.stdin is not None and sys.stdin.isatty()
    told = None
    while True:
        if path.is_file():
            shown, place = path.read_text().strip(), "hash.txt"
        elif asks:
            shown, place = input(f"Hash of the controller that the target shows (the request has {wanted}): ").strip(), "the target"
        else:
            shown, place = None, None
        if shown is not None and shown.lower() == wanted.lower():
            return wanted
        text = f"no hash is stated: write the one that the target shows into {path}"
        if shown is not None:
            text = f"{place} has the hash {shown or '(none)'}, the request {wanted}: load the controller of {folder.parent / 'controller'} and run it again"
        if text != told or asks:
            say(text)
            told = text
        if options.once:
            return None
        if not asks or path.is_file():
            time.sleep(options.poll)


def reason_of_abort(folder, count, request):
    """Returns why the run ended early, or an empty text for a complete one."""
    path = folder / "aborted.txt"
    if path.is_file():
        return path.read_text().strip() or "stopped by hand"
    return "" if count == request["samples"] else f"the recording has {count} of {request['samples']} samples"


def write_whole(path, text):
    """Writes a file that appears under its name only when it is complete."""
    partial = path.with_name(path.name + ".partial")
    partial.write_text(text)
    os.replace(partial, path)


def carry_out(options):
    folder = options.folder.resolve()
    try:
        request = json.loads((folder / "request.json").read_text())
    except (OSError, ValueError) as error:
        print(f"machine.py: {folder / 'request.json'} cannot be read: {error}", file=sys.stderr)
        return 1
    if request.get("protocol") != PROTOCOL:
        print(f"machine.py: the request has protocol {request.get('protocol')}: this program knows protocol {PROTOCOL}", file=sys.stderr)
        return 1
    say(instructions(folder, request))
    count = wait_for_recording(folder, request, options)
    if count is None:
        return 1
    shown = stated_hash(folder, request, options)
    if shown is None:
        return 1
    reason = reason_of_abort(folder, count, request)
    answer = {"protocol": PROTOCOL, "controller_hash": shown, "ended": "aborted" if reason else "complete", "reason": reason}
    write_whole(folder / "answer.json", json.dumps(answer) + "\n")
    say(f"answer.json: {answer['ended']}{': ' + reason if reason else ''}")
    return 0


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Asks a person to run one experiment and waits for its recording.")
    parser.add_argument("folder", type=pathlib.Path, help="folder of the run, with request.json")
    parser.add_argument("--once", action="store_true", help="do not wait: end with 1 if something is missing")
    parser.add_argument("--poll", type=float, default=1.0, metavar="SECONDS", help="time between two looks at the folder (default 1)")
    try:
        return carry_out(parser.parse_args(arguments))
    except (KeyboardInterrupt, EOFError):
        say("\nInterrupted. Start the same command again to go on; what lies in the folder counts.")
        return 130


if __name__ == "__main__":
    sys.exit(main())
