"""Recomputes every figure that `counterpoise model`, `reduce`, `synth`, `verify` and `design` print from the JSON result alone, with numpy
and python-control.

    counterpoise design PROJECT -o out --histories --json=result.json
    python tests/peers/results/recompute.py result.json [--controller out/controller.json]

The describing functions of friction observers need the observers' laws, which stand in controller.json.
Linear figures come from the matrices (poles, margins, sensitivities, rejection ratios, costs as integrals over frequency), the others from
the time histories. The script fails if one differs by more than its tolerance, and lists the printed figures that the result does not
determine, each with the reason.
"""

import json
import math
import sys

import control
import numpy as np

import axes
import certificates
import controlled
import sight
import stages
import targets
import trials
import tuned
from responses import at, bisect, crossings, decibels, figures_of_loop, golden, largest, named, same_response, swept, system

# Margins are found here by another method than in the program (a dense grid, then bisection).
LOOP_TOLERANCE = 1e-7
# Rejection ratios and histories are the same formulas on the same numbers.
TOLERANCE = 1e-9
ROUNDING = 1e-12
# A control that does not move has an RMS about its mean that is rounding beside its size.
STILL = 1e-11


def loop_figures(verify):
    loop = named(verify["systems"], "loop")
    found = figures_of_loop(system(loop), loop["sample_time_s"])
    return {**found, "closed_loop_pole_radius": pole_radius(verify)}


def pole_radius(verify):
    """The sampled plant closed with the controller: readings are the outputs from the sixth on, the control is the last input."""
    plant, K = (system(named(verify["systems"], name)) for name in ("sampled_plant", "controller"))
    to = control.ss(plant.A, plant.B[:, 3:], plant.C[5:, :], plant.D[5:, 3:], plant.dt)
    closed = control.feedback(to, K, sign=1)
    return float(np.max(np.abs(np.linalg.eigvals(closed.A))))


def rejection_db(verify, source, arrangement, hertz):
    return decibels(abs(rejection(verify, source, arrangement, hertz)))


def rejection(verify, source, arrangement, hertz):
    return sum(rejection_terms(verify, source, arrangement, hertz))


def rejection_terms(verify, source, arrangement, hertz):
    """What the base does to the hub by itself, and through the controller: where the controller is good, they cancel."""
    dt = named(verify["systems"], "sampled_plant")["sample_time_s"]
    rate = 2.0 * math.pi * hertz
    G = at(system(named(verify["systems"], "plant_with_sensors")), np.array([rate]), 0.0)[0]
    source_input = {"heave": 1, "pitch": 2}[source]
    if arrangement == "uncontrolled":
        return G[0, source_input], 0.0
    sampled = system(named(verify["systems"], "sampled_plant"))
    name = "controller" if arrangement == "compensated" else "controller_feedback_alone"
    K = at(system(named(verify["systems"], name)), np.array([rate]), dt)[0][0]
    P = at(sampled, np.array([rate]), dt)[0][5:, 3]
    late = np.exp(-1j * rate * dt * np.array(verify["reading_delays_samples"]))
    R = np.concatenate([[0.0], G[4:, source_input]]) * late
    tone = (K @ R) / (1.0 - K @ P)
    hold = (1.0 - np.exp(-1j * rate * dt)) / (1j * rate * dt)
    hold *= np.exp(-1j * rate * dt * verify["control_delay_samples"])
    return G[0, source_input], G[0, 0] * hold * tone


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


def assumption_rows(model, verify):
    """What the loop loses or gains with an assumption at the ends of its usual range."""
    effects = model.get("assumption_effects", [])
    if not effects:
        return
    assumed = dict(model["assumed_loop"])
    yield "control that holds the weight, assumed loop", assumed["holding_v"], *stages.holding(assumed)
    before = assumption_figures(assumed, assumed)
    for effect in effects:
        largest_ = 0.0
        for end in effect["at"]:
            # an end without a number is infinite
            value = math.inf if end["value"] is None else end["value"]
            name = f"{effect['key']} at {value:.6g}"
            if end.get("measured_on"):
                yield f"control that holds the weight, {name}", end["measured_on"]["holding_v"], *stages.holding(end["measured_on"])
            after = assumption_figures(assumed, end["measured_on"]) if end.get("measured_on") else None
            is_stable = after is not None and after["radius"] < 1.0
            yield f"{name}: stable", float(end["is_stable"]), float(is_stable), 0.0
            if after is None:
                continue
            residual = max(((after[k] - before[k]) for k in ("heave", "pitch") if finite(after[k], before[k])), key=abs, default=None)
            for key, mine in (("gain_margin_change_db", difference(after, before, "gain")),
                              ("phase_margin_change_deg", difference(after, before, "phase")),
                              ("sensitivity_change_db", difference(after, before, "sensitivity")),
                              ("residual_change_db", residual)):
                told = end[key]
                if told is not None:
                    # differences of figures that are found to a part in a million
                    yield f"{name}: {key}", 1.0, 1.0 + abs(told - (math.nan if mine is None else mine)), 1e-4
                    largest_ = max(largest_, 0.0 if "deg" in key else abs(told))
            largest_ = largest_ if end["is_stable"] else math.inf
        told = math.inf if effect["largest_change_db"] is None else effect["largest_change_db"]
        yield f"{effect['key']}: largest change, dB", told, largest_, 0.0


def finite(*values):
    return all(value is not None and math.isfinite(value) for value in values)


def difference(after, before, key):
    return after[key] - before[key] if finite(after[key], before[key]) else None


def assumption_figures(assumed, on):
    """Margins, sensitivity and residual at 1 Hz of the assumed controller on another plant."""
    plants = [one for one in on["systems"] if "plant" in one["name"]]
    controllers = [one for one in assumed["systems"] if "controller" in one["name"]]
    both = dict(on, systems=plants + controllers)
    sampled, K = (system(named(both["systems"], name)) for name in ("sampled_plant", "controller"))
    readings = control.ss(sampled.A, sampled.B[:, 3:], sampled.C[5:, :], sampled.D[5:, 3:], sampled.dt)
    loop = control.series(readings, -K)
    states = [{"name": "", "unit": ""}] * loop.nstates
    both["systems"] = both["systems"] + [{"name": "loop", "sample_time_s": sampled.dt, "A": loop.A.tolist(), "B": loop.B.tolist(),
                                          "C": loop.C.tolist(), "D": loop.D.tolist(), "states": states}]
    found = loop_figures(both)
    out = {"gain": found["gain_margin_db"], "phase": found["phase_margin_deg"], "radius": found["closed_loop_pole_radius"],
           "sensitivity": decibels(found["max_sensitivity"])}
    for source in ("heave", "pitch"):
        out[source] = rejection_db(both, source, "compensated", 1.0)
    return out


def recomputed(verify):
    all_ = loop_figures(verify)
    for history in verify.get("histories", []):
        all_.update(history_figures(history, verify["settle_s"]))
    if verify.get("certificate"):
        all_.update(certificates.headline(verify["certificate"]))
    asked = verify.get("sight_procedure")
    judged = next((one for one in verify.get("histories", []) if asked and one["name"] == asked["experiment"]), None)
    if judged:
        all_.update(sight.figures(judged, asked))
    for figure in verify["figures"]:
        key = figure["figure"]
        if "_drr_db at " in key:
            words, rest = key.split("_drr_db at ")
            source, arrangement = words.split("_")
            all_[key] = rejection_db(verify, source, arrangement, float(rest.split()[0]))
    return all_


def check_responses(synth):
    """Weights by their coefficients and by their roots, and the stored responses of the controllers and of the sampled loop."""
    for weight in synth["weights"]:
        transfer = control.tf(weight["numerator"], weight["denominator"])
        s = 3.0j
        by_roots = weight["gain"]
        for root in weight["zeros"]:
            by_roots *= s - complex(*root)
        for root in weight["poles"]:
            by_roots /= s - complex(*root)
        yield f"weight {weight['name']}", abs(by_roots), abs(transfer(s)), 1e-9
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
            off = np.max(np.abs(mine - theirs) / np.maximum(np.abs(theirs), 1e-12))
            yield f"response {name}", 1.0, 1.0 + float(off), 1e-6


# What no figure of a result determines.
NO_HISTORY = "its time history is not part of the result: ask for --histories"


def verify_rows(verify):
    mine = recomputed(verify)
    for figure in verify["figures"]:
        key, value = figure["figure"], figure["value"]
        if value is None:
            continue
        if key not in mine or mine[key] is None:
            yield (key, value, math.nan, 0.0) if verify.get("histories") else (key, value, NO_HISTORY)
        else:
            is_still = key.endswith("_control_rms_v") and max(value, mine[key]) < STILL * max(mine[key.replace("_rms_v", "_peak_v")], 1.0)
            yield key, value, value if is_still else mine[key], LOOP_TOLERANCE if key in loop_keys else TOLERANCE
    yield from verdict_rows(verify, mine)
    yield "control that holds the weight", verify["holding_v"], *stages.holding(verify)
    yield from certificate_rows(verify)
    yield from robustness_rows(verify)
    yield from response_rows_of(verify)
    for advice in verify.get("advice", []):
        yield from advice_rows(verify, advice)
    yield from sight.budget(verify)
    yield from trials.rows(verify.get("adaptation_trials"))
    yield from axes.rows(verify.get("two_axes"), verify_rows)


def verdict_rows(verify, mine):
    values = {figure["figure"]: figure["value"] for figure in verify["figures"]}
    for verdict in verify["verdicts"]:
        if verdict["value"] is not None:
            yield f"verdict on {verdict['figure']}", verdict["value"], values[verdict["figure"]], 0.0
    holds = sum(verdict["verdict"] == "holds" for verdict in verify["verdicts"])
    yield "requirements that hold", float(holds), float(sum(map(is_held, verify["verdicts"]))), 0.0
    judged = [verdict for verdict in verify["verdicts"] if verdict["value"] is not None]
    yield "passes", float(verify["passes"]), float(all(map(is_held, judged))), 0.0


def is_held(verdict):
    if verdict["value"] is None:
        return False
    room = verdict["limit"] - verdict["value"]
    return room >= 0.0 if verdict["limit_side"] == "at most" else room <= 0.0


def figure_of_design(verify, key, tried):
    """A figure of the verified plant under another controller; None if the result does not hold its history."""
    kept = [one for one in verify["systems"] if "plant" in one["name"]]
    other = dict(verify, systems=kept + tried["systems"])
    if key in loop_keys:
        return loop_figures(other)[key]
    if "_drr_db at " in key:
        words, rest = key.split("_drr_db at ")
        source, arrangement = words.split("_")
        return rejection_db(other, source, arrangement, float(rest.split()[0]))
    if tried.get("history"):
        return history_figures(tried["history"], verify["settle_s"]).get(key)
    return None


def advice_rows(verify, advice):
    """The figure of each design that was tried, the sensitivities as difference quotients, and what the advised change costs."""
    key, stands = advice["figure"], {figure["figure"]: figure["value"] for figure in verify["figures"]}
    yield f"advice on {key}: as it is", advice["value"], stands[key], 0.0
    tolerance = LOOP_TOLERANCE if key in loop_keys else TOLERANCE
    change = advice.get("change")
    designs = [(f"{one['weight']} x{one['tried']['factor']:.4g}", one["tried"]) for one in advice["sensitivities"]]
    designs += [(f"advised, {change['weight']} x{change['factor']:.4g}", change["tried"])] if change else []
    for name, tried in designs:
        mine = figure_of_design(verify, key, tried)
        told = f"{key} with {name}"
        yield (told, tried["value"], mine, tolerance) if mine is not None else (told, tried["value"], NO_HISTORY)
    for one in advice["sensitivities"]:
        slope = (one["tried"]["value"] - advice["value"]) / math.log(one["tried"]["factor"])
        yield f"sensitivity of {key} to {one['weight']}", one["per_factor_e"], slope, 1e-6
    if change:
        yield f"advised figure, {key}", change["value"], change["tried"]["value"], 0.0
        room = (advice["limit"] - change["value"]) * (1.0 if stands[key] > advice["limit"] else -1.0)
        yield f"whether it holds then, {key}", float(change["holds"]), float(room >= 0.0), 0.0
        margin = figure_of_design(verify, "gain_margin_db", change["tried"]) - stands["gain_margin_db"]
        yield f"change of the gain margin, {key}", change["gain_margin_change_db"], margin, 1e-5


def certificate_rows(verify):
    certificate = verify.get("certificate")
    if not certificate:
        return
    for case in certificate["cases"]:
        for regime in case["regimes"]:
            yield from regime_rows(regime, f"{case['name']}, {regime['regime']}")
        if case["sector"]:
            yield from certificates.sector(case["sector"], case["name"])
        dt = case["regimes"][0]["sampled_loop"]["sample_time_s"]
        yield from certificates.orbits(case, dt, case["noise_floor_rad_s"])
        yield from certificates.runs(case, dt)
        yield from certificates.predictions(case, verify)


def regime_rows(regime, name):
    """Poles, margin and largest sensitivity of the loop in one regime, from its sampled loop."""
    loop = system(regime["sampled_loop"])
    yield from certificates.regime_poles(regime, loop, name)
    if regime["gain_margin_db"] is None or regime["max_sensitivity"] is None:
        return
    dt = loop.dt
    rates = np.geomspace(1e-2, math.pi / dt * (1.0 - 1e-9), 20000)
    values = swept(loop, rates, dt)[:, 0, 0]
    one = lambda rate: swept(loop, np.array([rate]), dt)[0, 0, 0]
    real = [r for r in crossings(rates, values.imag, lambda r: one(r).imag) if one(r).real < 0.0]
    gains = [abs(one(r)) for r in real]
    # a loop without integral action also crosses the axis at zero frequency: a gain of that size lets the mechanism fall
    still = at(loop, np.array([1e-9]), dt)[0, 0, 0]
    gains += [abs(still)] if still.real < 0.0 and abs(still.imag) < 1e-3 * abs(still) else []
    margin = min((abs(20.0 * math.log10(gain)) for gain in gains), default=math.inf)
    # the certificate reads both off a grid of frequencies
    yield f"gain margin, {name}", regime["gain_margin_db"], margin, 5e-3
    sensitivity = largest(rates, np.abs(1 / (1 + values)), lambda r: abs(1 / (1 + one(r))))
    yield f"largest sensitivity, {name}", regime["max_sensitivity"], sensitivity, 5e-3


def response_row(verify, one):
    """A stored response of the plant, the controller, the loop, its sensitivities, or the hub's rate over the platform's motion."""
    name, hertz = one["name"], np.array(one["frequency_hz"])
    rates, dt = 2.0 * math.pi * hertz, named(verify["systems"], "loop")["sample_time_s"]
    if name.startswith("plant from "):
        column = ["control", "heave", "pitch"].index(name.removeprefix("plant from "))
        return at(system(named(verify["systems"], "plant_with_sensors")), rates, 0.0)[:, 0, column]
    if name.startswith("controller, "):
        reading = {"feedback": 1, "heave feedforward": 3, "pitch feedforward": 2}[name.removeprefix("controller, ")]
        # the feedback is drawn as what acts on the error
        sign = -1.0 if reading == 1 else 1.0
        return sign * at(system(named(verify["systems"], "controller")), rates, dt)[:, 0, reading]
    if name.startswith("hub rate over platform, "):
        source, arrangement = name.removeprefix("hub rate over platform, ").split("_")
        return np.array([rejection(verify, source, arrangement, hz) for hz in hertz])
    L = at(system(named(verify["systems"], "loop")), rates, dt)[:, 0, 0]
    return {"loop": L, "sensitivity": 1.0 / (1.0 + L), "complementary sensitivity": L / (1.0 + L)}[name]


def response_rows_of(verify):
    for one in verify["responses"]:
        yield from same_response(one, response_row(verify, one), rounding_of(verify, one))


# Digits of a double that a term of a rejection keeps: with fifty digits, terms of size 3.3 that cancel to 4.7e-8 are off by 2e-12 in the result
# and by as much here.
TERM = 1e-11


def rounding_of(verify, one):
    """The rounding of a response whose terms cancel; 0 for others."""
    if not one["name"].startswith("hub rate over platform, "):
        return 0.0
    source, arrangement = one["name"].removeprefix("hub rate over platform, ").split("_")
    return np.array([TERM * max(map(abs, rejection_terms(verify, source, arrangement, hz))) for hz in one["frequency_hz"]])


def robustness_rows(verify):
    for one in verify.get("robustness", []):
        name = f"{one['case']}, {one['joints']}"
        if one["guaranteed"] is None:
            continue
        peak = max(one["bounds"], key=lambda bound: bound["upper"])
        yield f"stable within times the ranges, {name}", one["guaranteed"], 1.0 / peak["upper"], 1e-12
        yield f"largest bound at, Hz, {name}", one["worst_hz"], peak["frequency_hz"], 0.0
        yield from certificates.bounds(one, name)
        if one["nearest"]:
            yield from certificates.nearest(one, name)
            pole, dt = complex(*one["nearest"]["pole"]), one["nearest"]["systems"][0]["sample_time_s"]
            yield f"oscillation at the limit, Hz, {name}", one["nearest"]["frequency_hz"], abs(np.angle(pole)) / (2.0 * math.pi * dt), 1e-9


def rows_of(result):
    """The rows of every stage that a result holds."""
    if "synth" in result:
        yield from stages.model(result["model"])
        yield from assumption_rows(result["model"], result["verify"])
        yield from stages.reduce(result["reduce"])
        yield from stages.synth(dict(result["synth"], beside=result["beside"]))
        yield from check_responses(result["synth"])
        yield from tuned.beside_rows(result["beside"].get("tuned_pi"))
        yield from stages.first_design(result.get("first_design"))
        yield from targets.rows(result)
        yield from verify_rows(result["verify"])
    elif "poles_rad_s" in result:
        yield from stages.model(result)
        yield from assumption_rows(result, None)
    elif "ranked" in result:
        yield from stages.reduce(result)
    elif "path_orders" in result:
        yield from stages.synth(result)
        yield from stages.first_design(result.get("first_design"))
        yield from tuned.beside_rows(result["beside"].get("tuned_pi"))
        yield from check_responses(result)
    else:
        yield from verify_rows(result)


def difference_of(value, mine, allowed):
    """The relative difference of two numbers; those of order 1 differ by rounding below 1e-12."""
    scale = abs(value) + (ROUNDING / allowed if allowed > 0.0 else 0.0) or 1.0
    return 0.0 if mine == value else abs(mine - value) / scale


def loaded(path, *options):
    """A result under the names of a loop of rate, with the exported controller that --controller names."""
    with open(path, encoding="utf-8") as file:
        result = controlled.as_rate_loop(json.load(file))
    assert result["schema"] == "counterpoise.results/2", result["schema"]
    if "--controller" in options:
        with open(options[options.index("--controller") + 1], encoding="utf-8") as file:
            result.get("verify", result)["exported_controller"] = json.load(file)
    return result


def constants_left_out(result):
    """(poles that belong to constants, regimes that have some, regimes)."""
    cases = (result.get("verify", result).get("certificate") or {"cases": []})["cases"]
    counts = [certificates.constants(regime) for case in cases for regime in case["regimes"]]
    return sum(counts), sum(count > 0 for count in counts), len(counts)


def main(path, *options):
    result = loaded(path, *options)
    count, worst, wrong, cannot = 0, 0.0, [], []
    for name, value, mine, *allowed in rows_of(result):
        if not allowed:
            cannot.append(f"  {name}: {mine}")
            continue
        count += 1
        off = difference_of(value, mine, allowed[0])
        worst = max(worst, off / allowed[0] if allowed[0] > 0.0 else off)
        if not off <= allowed[0]:
            wrong.append(f"  WRONG {name}: {value!r} in the result, {mine!r} here")
    print(f"{count} figures, {count - len(wrong)} recomputed within their tolerance, largest difference {worst:.1e} of its tolerance")
    poles, with_some, regimes = constants_left_out(result)
    if poles:
        print(f"{poles} poles of constants that nothing changes are left out of {with_some} of {regimes} regimes")
    if cannot:
        print(f"{len(cannot)} printed figures that the result does not determine:")
    print("\n".join(wrong + cannot))
    return 1 if wrong else 0


loop_keys = {
    "gain_margin_db", "gain_reduction_margin_db", "phase_margin_deg", "delay_margin_s", "disk_margin", "max_sensitivity",
    "max_complementary_sensitivity", "crossover_hz", "closed_loop_pole_radius",
}

if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
