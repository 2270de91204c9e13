"""The line of sight from time histories, from the JSON result alone: figures of gunner and observer, and the error budget.

Each function yields rows (name, value in the result, value computed here, relative tolerance), or (name, value, why) for a printed
figure that the result does not determine.
"""

import math

import numpy as np
from scipy.stats import norm

KEYS = ("hub", "hub_jitter", "tip", "tip_jitter", "tip_against_hub")
FIGURES = ("line_of_sight_rms_rad", "line_of_sight_jitter_rad", "tip_line_of_sight_rms_rad", "tip_line_of_sight_jitter_rad",
           "tip_against_hub_rms_rad")
# Running sums of rates over tens of thousands of samples in another order.
SUMS = 1e-9
# Differences of mean squares that nearly cancel.
SHARES = 1e-9
NO_ANGLES = "its angles are not part of the result: ask for --histories"


def integrated(rates, dt):
    """The integral by the trapezoidal rule, about its mean."""
    angle = np.concatenate([[0.0], np.cumsum(0.5 * dt * (rates[1:] + rates[:-1]))])
    return angle - np.mean(angle)


def rms(values):
    return math.sqrt(float(np.mean(np.square(values))))


def exposures(angle, dt, exposure_s):
    # halves are rounded away from zero, as the program does
    count = min(max(math.floor(exposure_s / dt + 0.5), 2), len(angle))
    return angle[: len(angle) // count * count].reshape(-1, count)


def jitter(angle, dt, exposure_s):
    parts = exposures(angle, dt, exposure_s)
    return rms(parts - parts.mean(axis=1, keepdims=True))


def angles_of(hub, tip, dt, exposure_s):
    """The five sizes of the error, in the order of KEYS."""
    return [rms(hub), jitter(hub, dt, exposure_s), rms(tip), jitter(tip, dt, exposure_s), rms(tip - hub)]


def shots(hub, tip, dt, asked):
    """Share of the time within the window, mean wait, and probability of a hit; None if every shot leaves after the end."""
    inside = np.abs(hub) <= asked["window_rad"]
    if not inside.any():
        return 0.0, math.inf, 0.0
    at = np.arange(len(tip)) + asked["delay_s"] / dt
    leaves = at <= len(tip) - 1
    error = np.interp(at, np.arange(len(tip)), tip)
    counted, waited, hits = 0, 0, 0.0
    release = None
    for trigger in range(len(hub) - 1, -1, -1):
        if inside[trigger]:
            release = trigger if leaves[trigger] else None
        if release is None:
            continue
        counted, waited = counted + 1, waited + release - trigger
        low, high = -asked["target_rad"] - error[release], asked["target_rad"] - error[release]
        deviation = asked["dispersion_rad"]
        hits += norm.cdf(high / deviation) - norm.cdf(low / deviation) if deviation > 0.0 else float(low <= 0.0 <= high)
    return (float(np.mean(inside)), dt * waited / counted, hits / counted) if counted else None


def transfer_loss(angle, dt, exposure_s, optics):
    phase = 2.0 * math.pi * optics["spatial_frequency_m"] * optics["focal_length_m"]
    parts = exposures(angle, dt, exposure_s)
    return max(1.0 - float(np.mean(np.abs(np.mean(np.exp(1j * phase * parts), axis=1)))), 0.0)


def figures(history, asked):
    """Every figure of the line of sight from its time history."""
    time = history["start_s"] + history["sample_time_s"] * np.arange(len(history["hub_rate_rad_s"]))
    first, dt = int(np.searchsorted(time, asked["settle_s"])), history["sample_time_s"]
    demand = np.array(history["demand_rad_s"])
    hub, tip = (integrated((np.array(history[key]) - demand)[first:], dt) for key in ("hub_rate_rad_s", "tip_rate_rad_s"))
    found = dict(zip(FIGURES, angles_of(hub, tip, dt, asked["exposure_s"])))
    if asked.get("optics"):
        found["line_of_sight_mtf_loss"] = transfer_loss(hub, dt, asked["exposure_s"], asked["optics"])
        found["tip_line_of_sight_mtf_loss"] = transfer_loss(tip, dt, asked["exposure_s"], asked["optics"])
    if asked.get("coincidence"):
        fired = shots(hub, tip, dt, asked["coincidence"])
        if fired:
            found.update(zip(("coincidence_fraction", "coincidence_wait_s", "hit_probability"), fired))
    return found


def budget(verify):
    """The runs by their angles; shares, sums and superposition by the runs."""
    found = verify.get("error_budget")
    if not found:
        return
    exposure_s = verify["sight_procedure"]["exposure_s"]
    runs = {}
    for run in found["runs"]:
        name = "budget with " + (", ".join(run["on"]) or "nothing")
        runs[frozenset(run["on"])] = run["rms_rad"]
        if not run.get("hub_rad"):
            yield name, run["rms_rad"]["hub"], NO_ANGLES
            continue
        mine = angles_of(np.array(run["hub_rad"]), np.array(run["tip_rad"]), run["sample_time_s"], exposure_s)
        for key, value in zip(KEYS, mine):
            yield f"{name}: {key}", run["rms_rad"][key], value, SUMS
    order = [one["source"] for one in found["contributions"]]
    whole, none = runs[frozenset(order)], runs[frozenset()]
    # bending moves nothing by itself: beside the others the structure stays flexible
    flexible = frozenset(["bending"])
    for key in KEYS:
        yield f"budget, all sources: {key}", found["total_rad"][key], whole[key], 0.0
        yield f"budget, no source: {key}", found["none_rad"][key], none[key], 0.0
        shares, alone = [], []
        for k, one in enumerate(found["contributions"]):
            grown = 0.0
            for before in (order[:k], order[k + 1 :]):
                grown += runs[frozenset(before + [one["source"]])][key] ** 2 - runs[frozenset(before)][key] ** 2
            shares.append(0.5 * grown)
            alone.append(runs[flexible | {one["source"]}][key])
            # over the whole, because a share may be nearly nothing
            yield f"share of {one['source']}: {key}", 1.0, 1.0 + (one["share_rad2"][key] - shares[-1]) / (whole[key] ** 2 or 1.0), SHARES
            yield f"{one['source']} alone: {key}", one["alone_rad"][key], alone[-1], 0.0
        yield f"sum of the shares: {key}", found["sum_rad"][key], math.sqrt(max(sum(shares) + none[key] ** 2, 0.0)), SUMS
        yield f"superposed: {key}", found["superposed_rad"][key], math.sqrt(sum(value**2 for value in alone)), SUMS
