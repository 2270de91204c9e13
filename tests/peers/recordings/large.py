"""Replays a recording that is too large to be read at once, and measures memory and processor time.

    python3 tests/peers/recordings/large.py PROGRAM [ROWS] [FOLDER]

Needs Python with pyarrow. Writes a CSV file of ROWS rows (10 000 000 unless said otherwise) with time and two channels, which repeat
ten seconds of examples/left-out-friction/multisine.parquet, into FOLDER (a temporary one unless said otherwise), and replays it in closed
loop (demand, hub rate) and in open loop (control, hub rate). Fails if a replay takes more than 2 GB of memory, or so much processor time
that 10^8 rows would take more than five minutes on two cores.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pyarrow.parquet

ROOT = Path(__file__).resolve().parents[3]
PROJECT = ROOT / "examples/left-out-friction"
MOST_MEGABYTES = 2000.0
# five minutes on two cores for 10^8 rows
MOST_SECONDS_PER_ROW = 2 * 300 / 1e8


def write(path, rows, channel, unit):
    """Writes the recording of one channel and the hub's rate; returns nothing."""
    table = pyarrow.parquet.read_table(PROJECT / "multisine.parquet")
    first, rate = (table[name].to_pylist() for name in (f"{channel} [{unit}]", "hub_rate [rad/s]"))
    cells = [f",{a:.9g},{b:.9g}\n" for a, b in zip(first, rate)]
    period = len(cells)
    with open(path, "w", encoding="utf-8") as out:
        out.write(f"time [s],{channel} [{unit}],hub_rate [rad/s]\n")
        for start in range(0, rows, period):
            count = min(period, rows - start)
            out.write("".join(f"{(start + k) // 1000}.{(start + k) % 1000:03d}{cells[k]}" for k in range(count)))


def replayed(program, path, arguments):
    """Returns exit code, processor time in seconds and peak memory in megabytes of a replay."""
    command = [program, "replay", str(PROJECT), str(path), "-q", "--json=" + str(path) + ".json", *arguments]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    return os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def main():
    program = str(Path(sys.argv[1]).resolve())
    rows = int(float(sys.argv[2])) if len(sys.argv) > 2 else 10_000_000
    failed = []
    with tempfile.TemporaryDirectory(dir=sys.argv[3] if len(sys.argv) > 3 else None) as folder:
        path = Path(folder) / "large.csv"
        for name, channel, unit, arguments in (
            ("closed loop", "demand", "rad/s", []),
            ("open loop", "control", "V", ["--open-loop"]),
        ):
            write(path, rows, channel, unit)
            code, seconds, megabytes = replayed(program, path, arguments)
            size = path.stat().st_size / 1e9
            print(f"{name}: {rows} rows ({size:.2f} GB), exit code {code}, {seconds:.1f} s of processor time, {megabytes:.0f} MB", flush=True)
            if code != 0 or megabytes > MOST_MEGABYTES or seconds > MOST_SECONDS_PER_ROW * rows:
                failed.append(name)
    sys.exit(f"beyond the limits: {', '.join(failed)}" if failed else 0)


main()
