"""Computes the figures of the line of sight from the time history of a verification, and compares them with the printed ones.

    counterpoise verify PROJECT --histories --json=RESULT
    python tests/peers/base_motion/sight.py PROJECT RESULT

PROJECT must have [verify.line_of_sight] with coincidence and optics, all keys as numbers in SI units.
"""

import json
import sys
import tomllib
from pathlib import Path

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.stats import norm

# The figures are means of thousands of numbers of order one: rounding alone separates the two programs.
TOLERANCE = 1e-9

project = Path(sys.argv[1])
project = tomllib.loads((project / "project.toml" if project.is_dir() else project).read_text())["verify"]
result = json.loads(Path(sys.argv[2]).read_text())
asked = project["line_of_sight"]
gate, optics = asked["coincidence"], asked["optics"]
kind = "road" if "road" in project else "both"
history = next(one for one in result["histories"] if one["name"] == f"nonlinear_{kind}_compensated")
time = np.array(history["time_s"]) if "time_s" in history else history["sample_time_s"] * np.arange(len(history["hub_rate_rad_s"]))
settle = asked.get("settle", project.get("settle", 2.0))
first, period = int(np.searchsorted(time, settle)), time[1] - time[0]
demand = np.array(history.get("demand_rad_s") or np.zeros(len(time)))


def angle(rates):
    raw = cumulative_trapezoid((np.array(rates) - demand)[first:], dx=period, initial=0.0)
    return raw - raw.mean()


def exposures(values):
    n = max(round(asked.get("exposure", 0.02) / period), 2)
    return values[: len(values) // n * n].reshape(-1, n)


def jitter(values):
    windows = exposures(values)
    return np.sqrt(np.mean((windows - windows.mean(axis=1, keepdims=True)) ** 2))


def loss(values):
    phase = 2.0 * np.pi * optics["spatial_frequency"] * optics["focal_length"]
    return 1.0 - np.mean(np.abs(np.mean(np.exp(1j * phase * exposures(values)), axis=1)))


hub, tip = angle(history["hub_rate_rad_s"]), angle(history["tip_rate_rad_s"])
inside = np.abs(hub) <= gate["window"]
index = np.arange(len(hub))
# the next sample within the window, for each sample as the trigger's instant
places = index[inside]
after = np.searchsorted(places, index)
has_release = after < len(places)
release = places[np.minimum(after, len(places) - 1)]
leaves = release + gate.get("delay", 0.0) / period
counted = has_release & (leaves <= len(hub) - 1)
error = np.interp(leaves[counted], index, tip)
sigma = gate.get("dispersion", 0.0)
if sigma > 0.0:
    hit = norm.cdf((gate["target"] - error) / sigma) - norm.cdf((-gate["target"] - error) / sigma)
else:
    hit = np.abs(error) <= gate["target"]
mine = {
    "line_of_sight_rms_rad": hub.std(),
    "line_of_sight_jitter_rad": jitter(hub),
    "tip_line_of_sight_rms_rad": tip.std(),
    "tip_line_of_sight_jitter_rad": jitter(tip),
    "tip_against_hub_rms_rad": (tip - hub).std(),
    "coincidence_fraction": inside.mean(),
    "coincidence_wait_s": period * (release - index)[counted].mean(),
    "hit_probability": hit.mean(),
    "line_of_sight_mtf_loss": loss(hub),
    "tip_line_of_sight_mtf_loss": loss(tip),
}
theirs = {figure["figure"]: figure["value"] for figure in result["figures"]}
worst = 0.0
for name, value in mine.items():
    off = abs(value - theirs[name]) / abs(theirs[name])
    worst = max(worst, off)
    print(f"{name:32} {theirs[name]:.9g} {value:.9g} {off:.1e}")
sys.exit(0 if worst < TOLERANCE else f"differ by {worst:.1e}")
