#!/usr/bin/env python3
"""The simulator beside the C solvers on the two-mass servo, in turn, in one run.

    cargo build --release -p counterpoise-simulate --example two_mass_servo
    python3 tests/peers/nonlinear/run.py BENCHMARK_FOLDER [--cvode] [--rounds 5] [--table FILE]

BENCHMARK_FOLDER holds sim.c, controller.txt and MODEL.md of the comparison. Builds the C programs there under
build-peers-nonlinear/ (gcc -O3 -march=native; --cvode needs SUNDIALS), makes the references once (RK4, 0.5 microseconds), and prints
for every friction and stiffness the fastest of the rounds, in processor time of both, and the largest error of the load
angle over the run. The table compares, of each side's settings, the fastest with an error of at most 1e-5, or of at most
that of the most exact C program where none reaches 1e-5.
"""

import json
import pathlib
import resource
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parents[3]
OURS = HERE / "target/release/examples/two_mass_servo"
FRICTIONS = ("Dahl", "LuGre", "reset integrator")
PEERS = (("rk4r", "20"), ("dp5", "1e-3"), ("dp5", "1e-5"), ("dp5", "1e-6"), ("dp5", "1e-7"))
TOLERANCES = ("5e-3", "1e-3", "2e-4", "2e-5")
# runs of ours that are timed together: the start of the program is taken off
RUNS = 20
EQUAL = 1e-5


def angle(path):
    import array

    rows = array.array("d")
    rows.frombytes(path.read_bytes())
    return rows[2::10]


def error(path, reference):
    found, exact = angle(path), angle(reference)
    n = min(len(found), len(exact))
    scale = max(abs(v) for v in exact)
    worst = max(abs(a - b) for a, b in zip(found[:n], exact[:n])) / scale
    return worst if worst == worst and all(v == v for v in found) else float("nan")


def build(folder, out, cvode):
    out.mkdir(exist_ok=True)
    libraries = "-lsundials_cvode -lsundials_nvecserial -lsundials_sunmatrixdense -lsundials_sunlinsoldense -lsundials_sunnonlinsolfixedpoint -lsundials_generic".split()
    for friction in range(3):
        for stiff in range(3):
            exe = out / f"sim_{friction}_{stiff}"
            flags = ["-DWITH_CVODE"] if cvode else []
            command = ["gcc", "-D_GNU_SOURCE", "-O3", "-march=native", f"-DFRIC={friction}", f"-DSTIFF={stiff}"]
            command += [*flags, str(folder / "sim.c"), "-o", str(exe), *(libraries if cvode else []), "-lm"]
            subprocess.run(command, check=True)
            reference = out / f"ref_{friction}_{stiff}.bin"
            if not reference.exists():
                subprocess.run([exe, "rk4", "2000", "10", reference], cwd=folder, stdout=subprocess.DEVNULL, check=True)


def timed(command, folder):
    ran = subprocess.run([str(c) for c in command], cwd=folder, capture_output=True, text=True)
    if ran.returncode:
        return None
    return json.loads(ran.stdout.replace("-nan", "NaN").replace(": nan", ": NaN"))["cpu_s"]


def own(arguments, log):
    """Processor time of one of our runs, the making of the step matrices included."""

    def spent(runs):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([OURS, *map(str, arguments), str(runs), log], capture_output=True, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime

    few = spent(1)
    return (spent(1 + RUNS) - few) / RUNS


def chosen(best):
    """The fastest setting of either side that is exact enough."""
    theirs = [wrong for name, (_, wrong) in best.items() if name.startswith("C ") and wrong == wrong]
    allowed = max(EQUAL, min(theirs))
    exact = [(seconds, wrong, name) for name, (seconds, wrong) in best.items() if wrong <= allowed]
    return [min(entry for entry in exact if entry[2].startswith(side)) for side in ("ours", "C ")]


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()
    cvode = "--cvode" in sys.argv
    rounds = int(sys.argv[sys.argv.index("--rounds") + 1]) if "--rounds" in sys.argv else 5
    table = pathlib.Path(sys.argv[sys.argv.index("--table") + 1]) if "--table" in sys.argv else None
    out = pathlib.Path("build-peers-nonlinear").resolve()
    build(folder, out, cvode)
    peers = PEERS + ((("adams", "1e-6"), ("bdf", "1e-6")) if cvode else ())
    log = out / "log.bin"
    rows = []
    for friction in range(3):
        for stiff in range(3):
            exe, reference = out / f"sim_{friction}_{stiff}", out / f"ref_{friction}_{stiff}.bin"
            best = {}
            for _ in range(rounds):
                for tolerance in TOLERANCES:
                    seconds = own((folder / "controller.txt", friction, stiff, tolerance), log)
                    name = f"ours {tolerance}"
                    best[name] = min(best.get(name, (float("inf"), 0.0)), (seconds, error(log, reference)))
                for mode, par in peers:
                    seconds = timed([exe, mode, par, "10", log], folder)
                    wrong = error(log, reference) if seconds is not None else float("nan")
                    name = f"C {mode} {par}"
                    best[name] = min(best.get(name, (float("inf"), wrong)), (seconds or float("inf"), wrong))
            print(f"{FRICTIONS[friction]}, stiffness {stiff}")
            for name, (seconds, wrong) in best.items():
                print(f"    {name:14s} {1e3 * seconds:8.2f} ms   error {wrong:.1e}")
            ours, theirs = chosen(best)
            line = (
                f"| {FRICTIONS[friction]} | {(1, 20, 500)[stiff]} | {1e3 * ours[0]:.1f} | {ours[1]:.0e} | {ours[2][5:]} "
                f"| {1e3 * theirs[0]:.1f} | {theirs[1]:.0e} | {theirs[2][2:]} | {theirs[0] / ours[0]:.1f} |"
            )
            print("    " + line, flush=True)
            rows.append(line)
    if table:
        head = "| friction | stiffness | ours, ms | error | tolerance | best C, ms | error | which | ratio |\n" + "|---" * 9 + "|\n"
        table.write_text(head + "\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
