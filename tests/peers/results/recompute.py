"""Recomputes every figure that `counterpoise design` prints from its JSON result alone, with numpy and python-control.

    counterpoise design PROJECT -o out --histories --json=result.json
    python tests/peers/results/recompute.py result.json

Linear figures come from the matrices (poles, margins, sensitivities, rejection ratios), the others from the time histories. Every
figure of the result is recomputed; the script fails if one differs by more than its tolerance or is not recomputed.
"""

import json
import math
import sys

import control
import numpy as np

# Margins are found here by another method than in the program (a dense grid, then bisection).
LOOP_TOLERANCE = 1e-7
# Rejection ratios and histories are the same formulas on the same numbers.
TOLERANCE = 1e-9
ROUNDING = 1e-12


def system(result):
    """The three lines of the manual: a system of the result as one of python-control."""
    dt = result["sample_time_s"]
    return control.ss(result["A"], result["B"], result["C"], result["D"], dt)


def named(systems, name):
    return next(one for one in systems if one["name"] == name)


def at(sys_, rates, dt):
    """The response at rates in rad/s, an array of matrices."""
    points = np.exp(1j * rates * dt) if dt else 1j * rates
    eye = np.eye(sys_.nstates)
    return np.array([sys_.C @ np.linalg.solve(s * eye - sys_.A, sys_.B.astype(complex)) + sys_.D for s in points])


def bisect(function, low, high):
    sign = function(low) > 0
    for _ in range(200):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if (function(middle) > 0) == sign else (low, middle)
    return math.sqrt(low * high)


def golden(function, low, high):
    """The place of the largest value between two rates."""
    ratio = (math.sqrt(5.0) - 1.0) / 2.0
    low, high = math.log(low), math.log(high)
    for _ in range(120):
        a, b = high - ratio * (high - low), low + ratio * (high - low)
        if function(math.exp(a)) > function(math.exp(b)):
            high = b
        else:
            low = a
    return math.exp(0.5 * (low + high))


def crossings(rates, values, function):
    found = []
    for k in range(len(rates) - 1):
        if values[k] == 0.0 or values[k] * values[k + 1] < 0.0:
            found.append(bisect(function, rates[k], rates[k + 1]))
    return found


def largest(rates, values, function):
    k = int(np.argmax(values))
    place = golden(function, rates[max(k - 1, 0)], rates[min(k + 1, len(rates) - 1)])
    return max(function(place), values[k])


def loop_figures(verify):
    loop = named(verify["systems"], "loop")
    broken, dt = system(loop), loop["sample_time_s"]
    nyquist = math.pi / dt
    rates = np.geomspace(1e-3, nyquist * (1 - 1e-9), 40000)
    one = lambda rate: at(broken, np.array([rate]), dt)[0, 0, 0]
    values = at(broken, rates, dt)[:, 0, 0]
    modulus = crossings(rates, np.abs(values) - 1.0, lambda r: abs(one(r)) - 1.0)
    # only crossings of the negative real axis count
    real = [r for r in crossings(rates, values.imag, lambda r: one(r).imag) if one(r).real < 0.0]
    # with the plant's own input broken, 1 + L = 0 at the stability limit
    gains = [-20.0 * math.log10(abs(one(r))) for r in real]
    gains += [-20.0 * math.log10(abs(v)) for v in [at(broken, np.array([nyquist]), dt)[0, 0, 0].real] if v < 0.0]
    phases = [(math.degrees(np.angle(-one(r))), r) for r in modulus]
    delays = [(math.radians(deg) % (2.0 * math.pi)) / rate for deg, rate in phases]
    sensitivity = lambda r: abs(1.0 / (1.0 + one(r)))
    complementary = lambda r: abs(one(r) / (1.0 + one(r)))
    skew = lambda r: abs(0.5 * (1.0 - one(r)) / (1.0 + one(r)))
    return {
        "gain_margin_db": min([g for g in gains if g > 0.0], default=math.inf),
        "gain_reduction_margin_db": min([-g for g in gains if g < 0.0], default=math.inf),
        "phase_margin_deg": min([abs(deg) for deg, _ in phases], default=math.inf),
        "delay_margin_s": min(delays, default=math.inf),
        "disk_margin": 1.0 / largest(rates, np.abs(0.5 * (1 - values) / (1 + values)), skew),
        "max_sensitivity": largest(rates, np.abs(1 / (1 + values)), sensitivity),
        "max_complementary_sensitivity": largest(rates, np.abs(values / (1 + values)), complementary),
        "crossover_hz": max(modulus, default=0.0) / (2.0 * math.pi),
        "closed_loop_pole_radius": pole_radius(verify),
    }


def pole_radius(verify):
    """The sampled plant closed with the controller: readings are the outputs from the sixth on, the control is the last input."""
    plant, K = (system(named(verify["systems"], name)) for name in ("sampled_plant", "controller"))
    to = control.ss(plant.A, plant.B[:, 3:], plant.C[5:, :], plant.D[5:, 3:], plant.dt)
    closed = control.feedback(to, K, sign=1)
    return float(np.max(np.abs(np.linalg.eigvals(closed.A))))


def rejection_db(verify, source, arrangement, hertz):
    dt = named(verify["systems"], "sampled_plant")["sample_time_s"]
    rate = 2.0 * math.pi * hertz
    G = at(system(named(verify["systems"], "plant_with_sensors")), np.array([rate]), 0.0)[0]
    source_input = {"heave": 1, "pitch": 2}[source]
    if arrangement == "uncontrolled":
        return decibels(abs(G[0, source_input]))
    sampled = system(named(verify["systems"], "sampled_plant"))
    name = "controller" if arrangement == "compensated" else "controller_feedback_alone"
    K = at(system(named(verify["systems"], name)), np.array([rate]), dt)[0][0]
    P = at(sampled, np.array([rate]), dt)[0][5:, 3]
    late = np.exp(-1j * rate * dt * np.array(verify["reading_delays_samples"]))
    R = np.concatenate([[0.0], G[4:, source_input]]) * late
    tone = (K @ R) / (1.0 - K @ P)
    hold = (1.0 - np.exp(-1j * rate * dt)) / (1j * rate * dt)
    hold *= np.exp(-1j * rate * dt * verify["control_delay_samples"])
    return decibels(abs(G[0, source_input] + G[0, 0] * hold * tone))


def decibels(ratio):
    return 20.0 * math.log10(ratio) if ratio > 0.0 else -math.inf


def rms(values):
    return math.sqrt(float(np.mean(np.square(values)))) if len(values) else math.nan


def peak(values):
    return float(np.max(np.abs(values)))


def crossing(time, y, level):
    k = int(np.argmax(y >= level))
    if y[k] < level:
        return None
    if k == 0:
        return time[0]
    return time[k - 1] + (level - y[k - 1]) / (y[k] - y[k - 1]) * (time[k] - time[k - 1])


def step_figures(time, history):
    demand, hub = history["demand_rad_s"][-1], np.array(history["hub_rate_rad_s"])
    y = hub / demand
    k = int(np.argmax(y))
    top, top_time = y[k], time[k]
    if 0 < k < len(y) - 1:
        curvature = y[k - 1] - 2.0 * y[k] + y[k + 1]
        if curvature < 0.0:
            shift = 0.5 * (y[k - 1] - y[k + 1]) / curvature
            top_time, top = time[k] + shift * (time[k] - time[k - 1]), y[k] - 0.25 * (y[k - 1] - y[k + 1]) * shift
    outside = np.nonzero(np.abs(y - 1.0) > 0.05)[0]
    settling = time[0]
    if len(outside):
        last = int(outside[-1])
        settling = math.inf
        if last + 1 < len(y):
            edge = 1.05 if y[last] > 1.0 else 0.95
            part = min(max((edge - y[last]) / (y[last + 1] - y[last]), 0.0), 1.0)
            settling = time[last] + part * (time[last + 1] - time[last])
    start, end = crossing(time, y, 0.1), crossing(time, y, 0.9)
    steady = max(math.ceil(0.1 * len(y)), 1)
    return {
        "overshoot_percent": 100.0 * max(top - 1.0, 0.0),
        "rise_time_s": None if end is None else end - start,
        "peak_time_s": top_time if top > 1.0 else None,
        "settling_time_s": settling,
        "steady_state_error_percent": 100.0 * abs(1.0 - float(np.mean(hub[-steady:])) / demand),
        "control_peak_v": peak(history["control_v"]),
    }


def rejection_of_history(history, first):
    """RMS of the hub's rate over that of the platform's pitch rate, or of its acceleration if it only heaves, in dB."""
    moved = "heave_m_s2" if "_heave_" in history["name"] else "pitch_rate_rad_s"
    size = rms(history[moved][first:])
    return decibels(rms(history["hub_rate_rad_s"][first:]) / size) if size > 0.0 else None


def history_figures(history, settle_s):
    hub = np.array(history["hub_rate_rad_s"])
    time = history["start_s"] + history["sample_time_s"] * np.arange(len(hub))
    name = history["name"]
    if name == "rest":
        half = len(hub) // 2
        travel = history["travel_rad"]
        return {"rest_hub_rms_rad_s": rms(hub[half:]), "rest_drift_rad": abs(travel[-1] - travel[half])}
    first = int(np.searchsorted(time, settle_s))
    if name.endswith("_step"):
        found = step_figures(time, history)
    elif name.endswith("_triangle"):
        error = (np.array(history["demand_rad_s"]) - hub)[first:]
        found = {"error_rms_rad_s": rms(error), "error_peak_rad_s": peak(error), "control_peak_v": peak(history["control_v"][first:])}
    else:
        control_v = np.array(history["control_v"])[first:]
        found = {
            "hub_rms_rad_s": rms(hub[first:]),
            "hub_peak_rad_s": peak(hub[first:]),
            "tip_rms_rad_s": rms(history["tip_rate_rad_s"][first:]),
            "tip_peak_rad_s": peak(history["tip_rate_rad_s"][first:]),
            "control_rms_v": rms(control_v - np.mean(control_v)),
            "control_peak_v": peak(control_v),
            "current_peak_a": peak(history["current_a"][first:]),
            "travel_peak_rad": peak(history["travel_rad"][first:]),
        }
        if "contact" in history:
            found["gear_open_fraction"] = 1.0 - float(np.mean(history["contact"][first:]))
        found["drr_db"] = rejection_of_history(history, first)
    return {f"{name}_{key}": value for key, value in found.items()}


def recomputed(verify):
    all_ = loop_figures(verify)
    for history in verify["histories"]:
        all_.update(history_figures(history, verify["settle_s"]))
    for figure in verify["figures"]:
        key = figure["figure"]
        if "_drr_db at " in key:
            words, rest = key.split("_drr_db at ")
            source, arrangement = words.split("_")
            all_[key] = rejection_db(verify, source, arrangement, float(rest.split()[0]))
    return all_


def check_design(design):
    """Poles and responses of the parts before the verification."""
    model, synth = design["model"], design["synth"]
    poles = np.sort_complex(np.linalg.eigvals(system(model["plant"]).A))
    told = np.sort_complex(np.array([complex(*p) for p in model["poles_rad_s"]]))
    assert np.max(np.abs(poles - told)) <= 1e-7 * np.max(np.abs(told)), "poles of the plant"
    for weight in synth["weights"]:
        transfer = control.tf(weight["numerator"], weight["denominator"])
        s = 3.0j
        by_roots = weight["gain"]
        for root in weight["zeros"]:
            by_roots *= s - complex(*root)
        for root in weight["poles"]:
            by_roots /= s - complex(*root)
        assert abs(transfer(s) - by_roots) <= 1e-9 * abs(by_roots), weight["name"]
    responses = {one["name"]: one for one in synth["responses"]}
    for part in synth["controllers"] + [synth["sampled_loop"]]:
        dt = part["sample_time_s"]
        for name, one in responses.items():
            if not name.startswith(part["name"]):
                continue
            column = next((k for k, signal in enumerate(part["inputs"]) if name.endswith(signal["name"])), 0)
            hertz = np.array(one["frequency_hz"])
            if dt:
                hertz = hertz[hertz < 0.499 / dt]
            mine = at(system(part), 2.0 * math.pi * hertz, dt)[:, 0, column]
            theirs = np.array(one["real"])[: len(hertz)] + 1j * np.array(one["imaginary"])[: len(hertz)]
            assert np.max(np.abs(mine - theirs) / np.maximum(np.abs(theirs), 1e-12)) < 1e-6, name


def main(path):
    with open(path, encoding="utf-8") as file:
        result = json.load(file)
    assert result["schema"] == "counterpoise.results/2", result["schema"]
    if "model" in result:
        check_design(result)
    verify = result.get("verify", result)
    mine, worst, wrong = recomputed(verify), 0.0, []
    for figure in verify["figures"]:
        key, value = figure["figure"], figure["value"]
        if value is None:
            continue
        if key not in mine or mine[key] is None:
            wrong.append(f"{key}: not recomputed")
            continue
        allowed = LOOP_TOLERANCE if key in loop_keys else TOLERANCE
        # differences of numbers of order 1 are rounding below 1e-12
        scale = abs(value) + ROUNDING / allowed
        off = 0.0 if mine[key] == value else abs(mine[key] - value) / scale
        worst = max(worst, off)
        if not off <= allowed:
            wrong.append(f"{key}: {value!r} in the result, {mine[key]!r} here")
    count = sum(figure["value"] is not None for figure in verify["figures"])
    print(f"{count} figures, {count - len(wrong)} recomputed within their tolerance, largest relative difference {worst:.1e}")
    print("\n".join(wrong))
    return 1 if wrong else 0


loop_keys = {
    "gain_margin_db", "gain_reduction_margin_db", "phase_margin_deg", "delay_margin_s", "disk_margin", "max_sensitivity",
    "max_complementary_sensitivity", "crossover_hz", "closed_loop_pole_radius",
}

if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
