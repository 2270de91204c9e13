#!/usr/bin/env python3
"""The simulator beside the C solvers on the two-mass servo, in turn, in one run.

    cargo build --release -p counterpoise-simulate --example two_mass_servo
    python3 tests/peers/nonlinear/run.py BENCHMARK_FOLDER [--cvode] [--rounds 7]

BENCHMARK_FOLDER holds sim.c, controller.txt and MODEL.md of the comparison. Builds the C programs there under build/
(gcc -O3 -march=native; --cvode needs SUNDIALS), makes the references once (RK4, 0.5 microseconds), and prints for
every friction and stiffness the fastest of the rounds and the largest error of the load angle over the run. The C
programs tell processor time, ours wall time, the best of three in each round: measure on an idle machine.
"""

import json
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parents[3]
OURS = HERE / "target/release/examples/two_mass_servo"
FRICTIONS = ("Dahl", "LuGre", "reset integrator")
PEERS = (("rk4r", "20"), ("dp5", "1e-3"), ("dp5", "1e-6"))
TOLERANCES = ("2e-4", "2e-5")


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


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()
    cvode = "--cvode" in sys.argv
    rounds = int(sys.argv[sys.argv.index("--rounds") + 1]) if "--rounds" in sys.argv else 7
    out = pathlib.Path("build-peers-nonlinear").resolve()
    build(folder, out, cvode)
    peers = PEERS + ((("adams", "1e-6"), ("bdf", "1e-6")) if cvode else ())
    log = out / "log.bin"
    for friction in range(3):
        for stiff in range(3):
            exe, reference = out / f"sim_{friction}_{stiff}", out / f"ref_{friction}_{stiff}.bin"
            commands = {f"ours {t}": [OURS, folder / "controller.txt", friction, stiff, t, 3, log] for t in TOLERANCES}
            commands |= {f"C {mode} {par}": [exe, mode, par, "10", log] for mode, par in peers}
            best = {}
            for _ in range(rounds):
                for name, command in commands.items():
                    seconds = timed(command, folder)
                    wrong = error(log, reference) if seconds is not None else float("nan")
                    best[name] = min(best.get(name, (float("inf"), wrong)), (seconds or float("inf"), wrong))
            print(f"{FRICTIONS[friction]}, stiffness {stiff}")
            for name, (seconds, wrong) in best.items():
                print(f"    {name:14s} {1e3 * seconds:8.2f} ms   error {wrong:.1e}")


if __name__ == "__main__":
    main()
