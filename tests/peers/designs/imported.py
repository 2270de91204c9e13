"""Controllers that were made elsewhere, in every form and kind of file, against what runs.

usage: imported.py PROGRAM [FIRST_SEED [COUNT]]

Random controllers (a PI, notches, lags, pairs of complex poles and zeros) are made with python-control on a small machine with a
sampling period of 1 ms, written as state space, transfer function, or zeros, poles and gain, in continuous or in sampled time, into JSON,
MATLAB 5 (SciPy), MATLAB 7.3 (h5py), HDF5 and NumPy files, and read by `counterpoise synth`. Compared, at 60 frequencies: the response of the
feedback path that runs with that of the controller as it was made (continuous ones by the bilinear map), and the closed sampled loop's
poles with mpmath's. A controller whose loop mpmath finds unstable must be refused, and no other.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import control
import h5py
import mpmath
import numpy as np
import scipy.io

mpmath.mp.dps = 50
PERIOD = 1e-3
PROJECT = """format = 2
[plant]
name = "axis"
inertia = 0.5
friction = {{ pivot = {{ viscous = 0.8 }} }}
drive = {{ kind = "torque", limit = 4.0 }}
interface = {{ sample_period = 1e-3 }}
[synth]
delay_samples = 0
[synth.controller]
file = "{file}"
"""


def random_roots(rng):
    """Returns zeros, poles (rad/s) and the gain at 1 rad/s of a controller in continuous time."""
    zeros, poles = [], []
    if rng.random() < 0.7:
        poles.append(0.0)
        zeros.append(-10 ** rng.uniform(-1, 1))
    for _ in range(rng.integers(0, 3)):
        w = 10 ** rng.uniform(1.5, 3)
        for roots, z in ((zeros, rng.uniform(0.01, 0.3)), (poles, rng.uniform(0.3, 1.0))):
            root = w * complex(-z, np.sqrt(1 - z * z))
            roots += [root, root.conjugate()]
    for _ in range(rng.integers(0, 3)):
        poles.append(-10 ** rng.uniform(1.5, 3.2))
    while len(zeros) > len(poles):
        poles.append(-2000.0)
    at = np.prod(1j - np.array(zeros, complex)) / np.prod(1j - np.array(poles, complex))
    return np.array(zeros, complex), np.array(poles, complex), 10 ** rng.uniform(-1, 1.2) / abs(at)


def to_sampled(zeros, poles, gain):
    """Returns zeros, poles and gain under the bilinear map."""
    a = 2 / PERIOD
    mapped = [(1 + roots / a) / (1 - roots / a) for roots in (zeros, poles)]
    gain = gain * np.prod(a - zeros) / np.prod(a - poles)
    zeros = np.concatenate([mapped[0], -np.ones(len(poles) - len(zeros))])
    return zeros, mapped[1], gain.real


def factors(roots):
    """Returns polynomials of degree two, and at most one of degree one, with these roots."""
    pairs = [root for root in roots if root.imag > 0]
    real = sorted(root.real for root in roots if root.imag == 0)
    all_ = [np.real(np.poly([root, root.conjugate()])) for root in pairs]
    return all_ + [np.poly(real[k : k + 2]) for k in range(0, len(real), 2)]


def state_space(zeros, poles, gain):
    """Returns A, B, C, D as a series of sections of second order, which keeps the digits that a polynomial loses."""
    system = control.ss([], [], [], [[gain]])
    above, below = (sorted(factors(roots), key=len, reverse=True) for roots in (zeros, poles))
    for place, denominator in enumerate(below):
        numerator = above[place] if place < len(above) else [1.0]
        system = control.series(system, control.ss(control.tf(numerator, denominator)))
    return system.A, system.B, system.C, system.D


def written(folder, form, kind, roots, period):
    """Writes a controller, and returns the name of its file."""
    zeros, poles, gain = roots
    if form == "zpk":
        # a single row is two real roots, except in JSON
        pairs = lambda all_: np.array([[r.real, r.imag] if len(all_) > 1 or kind == "json" else [r.real] for r in all_])
        parts = {"k": np.array([[gain]]), "Ts": np.array([[period]])}
        parts |= {key: pairs(all_) for key, all_ in (("z", zeros), ("p", poles)) if len(all_)}
    elif form == "tf":
        parts = {"num": gain * np.real(np.poly(zeros)), "den": np.real(np.poly(poles)), "Ts": np.array([[period]])}
        parts = {key: np.atleast_2d(value) for key, value in parts.items()}
    else:
        parts = dict(zip("ABCD", state_space(zeros, poles, gain))) | {"Ts": np.array([[period]])}
    name = f"legacy.{kind.lstrip('7')}"
    path = pathlib.Path(folder) / name
    if kind == "json":
        path.write_text(json.dumps({key: value.tolist() for key, value in parts.items()}))
    elif kind == "mat":
        scipy.io.savemat(path, parts)
    elif kind == "npz":
        np.savez(path, **parts)
    else:
        with h5py.File(path, "w", userblock_size=512 if kind == "7mat" else 0) as file:
            for key, value in parts.items():
                file[key] = value.T if kind == "7mat" else value
        if kind == "7mat":
            with open(path, "r+b") as file:
                file.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")
    return name


def response(system, z):
    A, B, C, D = (np.array(system[key], float) for key in "ABCD")
    n = len(A)
    return (C.reshape(1, n) @ np.linalg.solve(z * np.eye(n) - A.reshape(n, n), B.reshape(n, -1)) + D.reshape(1, -1))[0, 0] if n else D.flat[0]


def polynomial(roots):
    """Returns the coefficients with these roots, highest power first, in 50 digits."""
    coefficients = [mpmath.mpf(1)]
    for root in roots:
        shifted = [-root * c for c in coefficients]
        coefficients = [a + b for a, b in zip([*coefficients, 0], [0, *shifted])]
    return coefficients


def largest_pole(zeros, poles, gain):
    """Returns the largest modulus of the poles of the closed sampled loop: the axis under a zero-order hold."""
    decay = mpmath.mpf("0.8") / mpmath.mpf("0.5")
    held = mpmath.exp(-decay * mpmath.mpf(PERIOD))
    axis = mpmath.mpf("0.4") * (1 - held) / decay / mpmath.mpf("0.5")
    den = polynomial([*map(mpmath.mpc, poles), held])
    num = [axis * mpmath.mpf(gain) * c for c in polynomial(map(mpmath.mpc, zeros))]
    num = [0] * (len(den) - len(num)) + num
    roots = mpmath.polyroots([a + b for a, b in zip(den, num)], maxsteps=500, extraprec=300)
    return float(max(abs(root) for root in roots))


def main():
    program = sys.argv[1]
    first, count = (int(sys.argv[k]) if len(sys.argv) > k else usual for k, usual in ((2, 0), (3, 60)))
    worst, refused, ran, lost = 0.0, 0, 0, []
    for seed in range(first, first + count):
        rng = np.random.default_rng(seed)
        form = ("ss", "tf", "zpk")[seed % 3]
        kind = ("json", "mat", "7mat", "h5", "npz")[seed % 5]
        roots = random_roots(rng)
        as_sampled = to_sampled(*roots)
        period = PERIOD if seed % 2 else 0.0
        with tempfile.TemporaryDirectory() as folder:
            name = written(folder, form, kind, as_sampled if period else roots, period)
            project = pathlib.Path(folder) / "axis.toml"
            project.write_text(PROJECT.format(file=name))
            result = subprocess.run([program, "synth", str(project), "--json"], capture_output=True, text=True)
        if result.returncode not in (0, 1) or not result.stdout.strip():
            is_unstable = largest_pole(*as_sampled) >= 1 - 1e-9
            if is_unstable and "does not hold the loop" in result.stderr:
                refused += 1
            else:
                lost.append((seed, form, kind, period, result.stderr.strip()[-200:]))
            continue
        answer = json.loads(result.stdout)
        path = next(path for path in answer.get("synth", answer)["paths"] if path["name"] == "feedback")
        zeros, poles, gain = as_sampled
        error = 0.0
        for w in np.geomspace(0.1, 3000, 60):
            z = np.exp(1j * w * PERIOD)
            wanted = gain * np.prod(z - zeros) / np.prod(z - poles)
            error = max(error, abs(response(path, z) - wanted) / abs(wanted))
        pole, wanted = answer.get("synth", answer)["largest_pole_modulus"], largest_pole(*as_sampled)
        if abs(pole - wanted) > 1e-6:
            lost.append((seed, form, kind, period, f"the largest pole is {pole}, not {wanted}"))
        ran += 1
        worst = max(worst, error)
        if error > (1e-6 if form == "tf" else 1e-8):
            lost.append((seed, form, kind, period, f"the response differs by {error:.1e}"))
    print(f"{ran} ran, {refused} refused because their loop is not stable, largest difference of a response {worst:.1e}")
    for row in lost:
        print("WRONG", *row)
    sys.exit(bool(lost))


if __name__ == "__main__":
    main()
