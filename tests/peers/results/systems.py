"""Reads the systems of `design --json` into python-control as the manual shows, and compares poles and margins with those that the result states.

    counterpoise design PROJECT -o out --json=result.json
    python tests/peers/results/systems.py result.json... [--octave]

The script fails if a pole of the model, or a gain or phase margin of the verified loop, differs by more than 1e-9 of itself. With --octave it also runs
systems.m, which does the same in Octave with the package control.
"""

import json
import math
import pathlib
import subprocess
import sys

import control
import numpy as np
import scipy.optimize

TOLERANCE = 1e-9
# A pole at zero is found to this of the largest.
ROUNDING = 1e-12


def pole_difference(result):
    """The largest relative difference between the poles of python-control and the printed ones, each with its nearest."""
    plant = result["model"]["plant"]
    system = control.ss(plant["A"], plant["B"], plant["C"], plant["D"], plant["sample_time_s"])
    mine, told = list(system.poles()), [complex(*pole) for pole in result["model"]["poles_rad_s"]]
    assert len(mine) == len(told), (len(mine), len(told))
    smallest = ROUNDING * max(map(abs, told))
    worst = 0.0
    for pole in told:
        nearest = mine.pop(int(np.argmin(np.abs(np.array(mine) - pole))))
        worst = max(worst, abs(nearest - pole) / max(abs(pole), smallest / TOLERANCE) if smallest else abs(nearest))
    return worst


def margins(loop):
    """Gain margin in dB and phase margin in degrees of a sampled loop, from its response at every crossing.

    `control.stability_margins` expands the loop into polynomials, which holds no digit at orders above about fifty."""
    at = lambda rate: complex(loop(np.exp(1j * rate * loop.dt)))
    rates = np.geomspace(1e-2, 0.999 * math.pi / loop.dt, 3000)
    values = np.array([at(rate) for rate in rates])

    def crossings(function, numbers):
        places = np.nonzero(numbers[:-1] * numbers[1:] < 0.0)[0]
        return [scipy.optimize.brentq(function, rates[k], rates[k + 1], xtol=1e-14, rtol=1e-15) for k in places]

    real = [at(rate) for rate in crossings(lambda rate: at(rate).imag, values.imag)]
    unit = [at(rate) for rate in crossings(lambda rate: abs(at(rate)) - 1.0, np.abs(values) - 1.0)]
    last = at(math.pi / loop.dt)
    gains = [-20.0 * math.log10(abs(value)) for value in [*real, last] if value.real < 0.0]
    return min((gain for gain in gains if gain > 0.0), default=math.inf), min((abs(math.degrees(np.angle(-value))) for value in unit), default=math.inf)


def margin_differences(result):
    """The relative differences of gain and phase margin, with the order of the loop."""
    figures = {one["figure"]: one["value"] for one in result["verify"]["figures"]}
    told = next(one for one in result["verify"]["systems"] if one["name"] == "loop")
    loop = control.ss(told["A"], told["B"], told["C"], told["D"], told["sample_time_s"])
    mine = margins(loop)
    # null stands for a margin without end
    stated = [math.inf if figures[key] is None else figures[key] for key in ("gain_margin_db", "phase_margin_deg")]
    return loop.nstates, *(0.0 if a == b else abs(a / b - 1.0) for a, b in zip(mine, stated))


def in_octave(path):
    script = pathlib.Path(__file__).with_name("systems.m")
    done = subprocess.run(["octave-cli", "--norc", "-q", str(script), str(path)], capture_output=True, text=True, check=False)
    print(*(f"  Octave: {line}" for line in (done.stdout.strip() or done.stderr.strip()).splitlines()), sep="\n")
    return done.returncode == 0


def main(*arguments):
    paths, wrong = [one for one in arguments if one != "--octave"], 0
    for path in paths:
        result = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
        poles, (order, gain, phase) = pole_difference(result), margin_differences(result)
        print(f"{path}: {len(result['model']['poles_rad_s'])} poles to {poles:.1e}, loop of order {order}: gain margin to {gain:.1e}, phase margin to {phase:.1e}")
        good = max(poles, gain, phase) < TOLERANCE
        good &= "--octave" not in arguments or in_octave(path)
        wrong += not good
    print(f"{len(paths)} results, {len(paths) - wrong} equal to {TOLERANCE:.0e}")
    return 1 if wrong or not paths else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
