"""Recomputes the figures that `counterpoise sweep`, `compare`, `adapt`, `claims`, `fra`, `replay`, `diagnose`, `identify` and `experiment` print from their JSON results,
with what the program writes beside them.

    counterpoise COMMAND PROJECT ... --histories --json=result.json
    python tests/peers/results/studies.py result.json [--series data/series] [--samples out/sweep/samples.parquet] [--verify verify.json]

Without --histories the runs, and the mechanisms of `sweep`, are missing: the series that --data writes and the samples of the sweep's folder serve in
their place. `fra` needs the linear loop of the result of `verify` or `design` on the same project. The script fails if a figure differs by more than its
tolerance, and lists the printed figures that these files do not determine, each with the reason.
"""

import json
import math
import pathlib
import sys

import numpy as np

import recompute
import trials
import tuned
from responses import named

EXACT, FORMULA = 0.0, 1e-12
# RMS errors of series whose numbers have all their digits.
SERIES = 1e-9
# A diagnosis' series are further runs of the models that were fitted, with another start.
ANOTHER_RUN = 0.01
# 97.5 % point of the normal distribution.
NORMAL = 1.959963984540054
# Linear figures that are found in another way.
LOOP = tuned.LOOP
RUN = "a run of the simulator, which the result does not contain"
WITHOUT = "its run is not part of the result without --histories"
RUNS = ("measured", "before", "after")
# Harmonics of a signal that are fitted together.
HARMONICS = 5
# Log-likelihood ratio from which a recording decides between two machines.
DECIDES = 18.0


def harmonics(samples, step):
    """Mean and complex amplitudes of the harmonics of a signal by least squares; `step` is the fundamental's angle a sample, rad."""
    count = min(HARMONICS, max(math.ceil(math.pi / step) - 1, 1))
    k = np.arange(len(samples))[:, None] * step * np.arange(1, count + 1)[None, :]
    columns = np.hstack([np.ones((len(samples), 1)), np.cos(k), np.sin(k)])
    found = np.linalg.lstsq(columns, samples, rcond=None)[0]
    return found[0], found[1 : count + 1] - 1j * found[count + 1 :]


def measured(point, history):
    """Response, mean, distortion and last change of a point from the signals of its last two windows."""
    signals, n = [np.array(history[key]) for key in ("input", "output")], len(history["input"]) // 2
    step = 2.0 * math.pi * point["frequency_hz"] * history["sample_time_s"]
    windows = [[harmonics(signal[part], step) for signal in signals] for part in (slice(0, n), slice(n, 2 * n))]
    before, last = (out[1][0] / into[1][0] for into, out in windows)
    mean, spectrum = windows[1][1]
    return {
        "response": last,
        "mean_rad_s": mean,
        "distortion": math.sqrt(float(np.sum(np.abs(spectrum[1:]) ** 2))) / abs(spectrum[0]),
        "last_change": abs(last - before) / abs(last),
    }


def fra(result, files):
    verify = files.get("verify")
    for chart in result["maps"]:
        histories = chart.get("histories") or [None] * len(chart["points"])
        for point, history in zip(chart["points"], histories):
            name = f"{chart['name']}, {point['amplitude']:.4g} at {point['frequency_hz']:.4g} Hz"
            response = complex(*point["response"])
            yield f"gain, {name}", point["gain_db"], 20.0 * math.log10(abs(response)), FORMULA
            yield f"phase, {name}", point["phase_deg"], math.degrees(math.atan2(response.imag, response.real)), FORMULA
            if point.get("linear") and verify and chart["around"] == "disturbance":
                told = complex(*point["linear"])
                mine = recompute.rejection(verify, "pitch", "compensated", point["frequency_hz"])
                yield f"linear response, {name}", 1.0, 1.0 + abs(mine - told) / abs(told), LOOP
            elif point.get("linear"):
                yield f"linear response, {name}", abs(complex(*point["linear"])), "the loop is not part of the result: give that of verify"
            if point.get("describing") is not None:
                yield f"describing, {name}", 0.0, "a balance with describing functions, whose plants are not in the result"
            if history is None:
                yield f"response, mean and distortion, {name}", 0.0, WITHOUT
                continue
            mine = measured(point, history)
            off = abs(mine["response"] - response) / abs(response)
            yield f"response, {name}", 1.0, 1.0 + off, SERIES
            level = abs(response) * point["amplitude"]
            yield f"mean, {name}", 1.0, 1.0 + abs(mine["mean_rad_s"] - point["mean_rad_s"]) / level, SERIES
            yield f"distortion, {name}", 1.0 + point["distortion"], 1.0 + mine["distortion"], SERIES
            yield f"last change, {name}", 1.0 + point["last_change"], 1.0 + mine["last_change"], SERIES


def series_of(result, files, recording):
    """The tracks of a recording, from the result's own histories or from the files of --data."""
    stem = pathlib.Path(recording).stem
    own = {one["name"]: one for one in result.get("histories", [])}
    if own:
        tracks = {name.removeprefix(f"{stem} "): one for name, one in own.items() if name.startswith(f"{stem} ")}
        columns = {f"{channel} {run} [": one[run] for channel, one in tracks.items() for run in RUNS if run in one}
        return {name: np.array([math.nan if value is None else value for value in values]) for name, values in columns.items()}
    path = files.get("series") and files["series"] / f"{stem}.csv"
    if not path or not path.exists():
        return None
    with open(path, encoding="utf-8") as file:
        names = file.readline().rstrip("\n").split(",")
        return dict(zip(names, np.genfromtxt(file, delimiter=",").T))


def pair(series, channel, when):
    """What was measured and what the model gives, without the samples that either lacks; None if the series has no such column."""
    found = [next((values for name, values in (series or {}).items() if name.startswith(f"{channel} {what} [")), None) for what in ("measured", when)]
    if any(values is None for values in found):
        return None
    known = np.isfinite(found[0]) & np.isfinite(found[1])
    return found[0][known], found[1][known]


def replay(result, files):
    for recording in result["recordings"]:
        series = series_of(result, files, recording["file"])
        for channel, told in recording["channels"].items():
            name = f"{channel}, {recording['file']}"
            both = pair(series, channel, "before")
            if both is None:
                why = "what was recorded of the platform, against the motion that the model was given" if series else WITHOUT
                yield f"RMS error, {name}", told["rms_error"], why
                yield f"variance accounted for, {name}", told["vaf"], why
            else:
                error = both[0] - both[1]
                yield f"RMS error, {name}", told["rms_error"], math.sqrt(float(np.mean(error**2))), SERIES
                yield f"variance accounted for, {name}", told["vaf"], 100.0 * (1.0 - float(np.var(error) / np.var(both[0]))), SERIES
            yield f"floor, {name}", told["floor"], "noise, resolution and rounding of the project's sensors, which the result does not contain"
        if recording.get("parting"):
            yield f"where it parts, {recording['file']}", recording["parting"]["floors"], "how far a start in the middle of the recording leads, " + RUN


def middle(told, name):
    low, high = told["ci95"]
    # parameters that are positive are fitted by their logarithm: their interval lies about the geometric mean
    means = [0.5 * (low + high)] + ([math.sqrt(low * high)] if low > 0.0 else [])
    yield f"middle of the interval, {name}", told["value"], min(means, key=lambda mean: abs(mean - told["value"])), 1e-9
    yield f"width of the interval, {name}", high - low, "the covariance is not part of the result"
    yield f"value, {name}", told["value"], "a fit to the recordings, which the result does not contain"


def diagnose(result, files):
    if "fit" not in result:
        yield "figures of measured modes", 0.0, "fits of the structure, which the result does not contain"
        return
    names = sorted({one["name"].rpartition(" ")[0] for one in result.get("histories", [])})
    if not names and files.get("series"):
        names = [path.stem for path in sorted(files["series"].glob("*.csv")) if path.name != "contents.csv"]
    series = [series_of(result, files, name) for name in names]
    for when in ("before", "after"):
        for channel, told in (result["fit"][when] or {}).items():
            pairs = [both for both in (pair(one, channel, when) for one in series) if both]
            name = f"RMS error {when}, {channel}"
            if pairs:
                errors = np.concatenate([measured - given for measured, given in pairs])
                yield f"{name}, by the series' own runs", told["rms_error"], root_mean_square(errors), ANOTHER_RUN
            else:
                yield name, told["rms_error"], WITHOUT
            yield f"floor, {channel}", told["floor"], "noise, resolution and rounding of the project's sensors, which the result does not contain"
        for channel, told in (result["fit"][f"held_out_{when}"] or {}).items():
            yield f"RMS error held out {when}, {channel}", told["rms_error"], "runs of the parts that were held out, with starts of their own"
    for finding in result["findings"]:
        yield f"probability of {finding['effect']}", finding["probability"], "calibrated on sealed machines"
        for parameter in finding["parameters"]:
            if parameter.get("ci95"):
                yield from middle(parameter, f"{parameter['name']} of {finding['effect']}")


def normal_equations(regression):
    """Returns values, half widths, RMS residual and largest share of noise of the regression's unknowns; a column of zeros has no value."""
    gram, noise = np.array(regression["regressors"]), np.array(regression["noise"])
    moments = np.array(regression["with_target"])
    seen = np.diag(gram) > 0.0
    inverse = np.zeros_like(gram)
    inverse[np.ix_(seen, seen)] = np.linalg.inv((gram - np.diag(noise))[np.ix_(seen, seen)])
    values = inverse @ (moments - np.array(regression["shared_noise"]))
    power = regression["target"] - 2.0 * values @ moments + values @ gram @ values
    covariance = inverse @ np.array(regression["spread"]) @ inverse
    half_widths = regression["quantile"] * np.sqrt(np.diag(covariance))
    shares = noise / np.maximum(np.diag(gram), np.finfo(float).tiny)
    values[~seen] = np.nan
    return values, half_widths, math.sqrt(power / regression["rows"]), shares.max()


def at_place(result, place):
    """Returns what stands at a place such as `balances[0].inertia_kg_m2`; None for a change in words."""
    at = result
    for part in place.replace("[", ".").replace("]", "").split("."):
        if isinstance(at, list):
            at = at[int(part)]
        elif isinstance(at, dict) and part in at:
            at = at[part]
        else:
            return None
    return at


# Values of normal equations whose unknowns are told apart to a few parts in 1e7 of their digits.
REGRESSION = 1e-6
# RMS of a residual that is the difference of sums a million times as large.
REMAINDER = 1e-3


def estimate(stated, value, half_width, name):
    if stated["value"] is not None:
        yield f"value, {name}", stated["value"], value, REGRESSION
    for end, sign in zip(stated["ci95"], (-1.0, 1.0)):
        if end is not None:
            yield f"end of the interval, {name}", end, value + sign * half_width, REGRESSION


def identify(result, _):
    regression = result["regression"]
    values, half_widths, residual, share = normal_equations(regression)
    told = {name: (value, half) for name, value, half in zip(regression["unknowns"], values, half_widths)}
    for name, (value, half) in told.items():
        stated = at_place(result, name)
        if stated is not None:
            yield from estimate(stated, value, half, name)
    arm = told.get("change of sensors.lever_arm_m")
    sensors = result.get("sensors") or {}
    if arm and sensors.get("lever_arm_m"):
        stated = sensors["lever_arm_m"]
        yield from estimate(stated, stated["before"] + arm[0], arm[1], "sensors.lever_arm_m")
    curve = {float(name.rsplit(" ", 2)[-2]): found for name, found in told.items() if name.startswith("change of the current")}
    points = (result.get("amplifier") or {}).get("points") or []
    for point in points:
        name = f"amplifier at {point['input_v']:.3g} V"
        gain = points[0]["linear_a"] / points[0]["input_v"]
        change, half = curve[point["input_v"]]
        stated = {"value": point["current_a"], "ci95": point["ci95_a"]}
        yield from estimate(stated, point["linear_a"] + gain * change, gain * half, name)
        yield f"scatter, {name}", point["scatter_a"], "the recordings are not part of the result"
        # the project's amplifier is a gain
        yield f"project, {name}", point["linear_a"] / point["input_v"], gain, 1e-2
    if result.get("breakaway_nm"):
        yield from middle(result["breakaway_nm"], "breakaway_nm")
    if result.get("lobes"):
        for key, value in result["lobes"].items():
            yield key, value, "a fit to rate and acceleration; the loops in the result hold rate and control"
    yield "residual", result["residual_nm"], residual, REMAINDER
    if share:
        yield "share of noise", result["noise_share"], share, REGRESSION


def root_mean_square(values):
    return math.sqrt(float(np.mean(np.square(values))))


def adapt(result, _):
    """Hub rates from the rates of their runs, and over those of run a between the same times."""
    first = result["runs"][0]["intervals"][0]
    for run in result["runs"]:
        for interval in run["intervals"]:
            name = f"run {run['letter']} from {interval['from_to_s'][0]:.4g} s"
            own, default = (interval.get(f"{which}_hub_rate_rad_s") for which in ("settled", "default"))
            if own:
                rms = root_mean_square(own)
                yield f"hub rate, {name}", interval["hub_rms_rad_s"], rms, SERIES
                yield f"hub rate over that of run a, {name}", interval["over_default"], rms / root_mean_square(default), SERIES
            else:
                yield f"hub rate and its ratio to that of run a, {name}", interval["hub_rms_rad_s"], WITHOUT
            yield f"out-of-balance, {name}", interval["out_of_balance_kg_m"], interval["factor"] * first["out_of_balance_kg_m"], FORMULA
            yield f"out-of-balance in use, {name}", interval["used_kg_m"], "what the controller holds at the end of the interval"
    yield from trials.rows(result.get("trials"))


def experiment(result, _):
    """Expected log-likelihood ratios from the products of slopes and distances, and what the machines reach from their motions."""
    weakest = []
    for one in result["separations"]:
        name = f"machines {one['first']} and {one['second']}"
        ratios = []
        for refit in one["refits"]:
            right = np.array(refit["slopes_with_distance"])
            explained = right @ np.linalg.solve(np.array(refit["slopes"]), right) if len(right) else 0.0
            ratios.append(0.5 * max(refit["squared_distance"] - explained, 0.0))
        ratio = min(ratios)
        yield f"log-likelihood ratio, {name}", one["log_likelihood_ratio"], ratio, REGRESSION
        below = 0.5 * math.erfc(-(ratio - DECIDES) / math.sqrt(2.0 * ratio) / math.sqrt(2.0)) if ratio > 0.0 else 0.0
        # the program's normal distribution has an error of up to 1e-7
        yield f"probability, {name}", 1.0 + one["probability"], 1.0 + below, 1e-7
    motions = result.get("histories", [])
    for key in ("angle_rad", "rate_rad_s", "current_a"):
        told = result[f"reached_{key}"]
        mine = max((float(np.max(np.abs(motion[key]))) for motion in motions), default=None)
        yield (f"reached {key}", told, WITHOUT) if mine is None else (f"reached {key}", told, mine, FORMULA)
    for one in result["others"]:
        yield f"log-likelihood ratio of {one['what']}", one["log_likelihood_ratio"], "another experiment, whose recordings the result does not contain"


def quantile(values, share):
    return float(np.quantile(values, share))


def wilson(good, count):
    share, z = good / count, NORMAL**2 / count
    centre, half = (share + 0.5 * z) / (1.0 + z), NORMAL / (1.0 + z) * math.sqrt(share * (1.0 - share) / count + 0.25 * z / count)
    return max(centre - half, 0.0), min(centre + half, 1.0)


def sweep(result, files):
    """Shares and quantiles from the mechanisms, of which --histories writes all, and the linear worst case from its proofs."""
    yield from recompute.robustness_rows(result)
    mechanisms = result.get("mechanisms") or files.get("samples")
    for told in result["figures"]:
        name, worst = told["figure"], told.get("worst_case")
        room = lambda value: told["limit"] - value if told["side"] == "at most" else value - told["limit"]
        if worst:
            yield f"value of the worst case, {name}", worst["value"], "a design outside the samples, which a search found: `counterpoise sweep` runs it again with the options that stand beside it"
            yield f"whether the worst case meets it, {name}", float(worst["meets"]), float(room(worst["value"]) >= 0.0), EXACT
        if mechanisms is None:
            yield f"share, interval and quantiles, {name}", told["share"], "the mechanisms are not part of the result without --histories"
            continue
        whole = np.array([math.nan if value is None else value for value in mechanisms[name]])
        values = whole[~np.isnan(whole)]
        for key, share in (("q05", 0.05), ("median", 0.5), ("q95", 0.95)):
            yield f"{key}, {name}", told[key], quantile(values, share), FORMULA
        good = int(np.sum(room(values) >= 0.0))
        yield f"share, {name}", told["share"], good / len(values), FORMULA
        for side, mine, its in zip(("lower", "upper"), wilson(good, len(values)), told["interval"]):
            yield f"{side} end of the interval, {name}", its, mine, FORMULA
        number = np.array(mechanisms["sample"])[~np.isnan(whole)][int(np.argmin(room(values)))]
        yield f"worst sample, {name}", float(told["worst_sample"]), float(number), EXACT
        if worst:
            of_worst = float(np.min(room(values)))
            yield f"worst case no better than the worst sample, {name}", 0.0, max(room(worst["value"]) - of_worst, 0.0), EXACT


def claims(result, _):
    for claim in result["claims"]:
        seen = []
        for one in claim["criteria"]:
            within = lambda ends: ends and (ends[0] is None or one["measured"] >= ends[0]) and (ends[1] is None or one["measured"] <= ends[1])
            mine = "agrees" if within(one["accepted"]) else "explained" if within(one["explained"]) else "disagrees"
            seen.append(mine)
            yield f"agreement, {claim['id']}, {one['what']}", 0.0, float(mine != one["agreement"]), EXACT
            yield f"measured, {claim['id']}, {one['what']}", one["measured"], "designs and runs of the program, which the result does not contain"
        mine = "fails" if "disagrees" in seen else "differs" if "explained" in seen else "holds"
        yield f"finding, {claim['id']}", 0.0, float(mine != claim["finding"]), EXACT


def runs_of(row):
    """Figures of the nonlinear closed loop, from its runs."""
    runs = {run["name"]: run for run in row.get("histories", [])}
    for key, value in (row["nonlinear"] or {}).items():
        if value is None:
            continue
        run = runs.get("motion", runs.get("sines")) if key == "control_v" else runs.get(key.partition("_")[0])
        if run is None:
            yield f"{key}, {row['name']}", value, WITHOUT
        elif key == "control_v":
            yield f"{key}, {row['name']}", value, float(np.std(run["control_v"])), SERIES
        else:
            error = next(values for name, values in run.items() if name.startswith("error_"))
            yield f"{key}, {row['name']}", value, root_mean_square(error), SERIES


def compare(result, files):
    for row in result["rows"]:
        if not row["linear"]:
            continue
        # a bound keeps its limits on its own grid only, and misses none by definition
        if row["limits"] and not row["bound"]:
            yield f"limit that is missed, {row['name']}", row["missed"], tuned.missed(row["limits"], row["linear"]), 1e-6
        mine = {}
        if row.get("systems"):
            mine = tuned.loop_figures(result, named(result["systems"], "plant"), named(row["systems"], "feedback"), row["linear"])
        for key, value in row["linear"].items():
            if key in mine and value is not None:
                yield f"{key}, {row['name']}", value, mine[key], LOOP
            elif value is not None:
                yield f"{key}, {row['name']}", value, "a bound from a convex program, which no controller of the result reaches"
        if mine and row["rejection"] is not None:
            yield f"RMS of S, {row['name']}", row["rejection"], mine["rejection"], LOOP
        yield from runs_of(row)


STUDIES = [("maps", fra), ("separations", experiment), ("recordings", replay), ("verdict", diagnose), ("balances", identify), ("runs", adapt), ("claims", claims), ("rows", compare), ("figures", sweep)]


def rows_of(result, files):
    found = [rows for key, rows in STUDIES if key in result]
    if not found:
        sys.exit("this script recomputes no figure of such a result: it knows sweep, compare, adapt, claims, fra, replay, diagnose, identify and experiment")
    return found[0](result, files)


def files_of(options):
    files = {name: pathlib.Path(path) for name, path in zip(options[::2], options[1::2])}
    found = {"series": files.get("--series")}
    if "--verify" in files:
        result = json.loads(files["--verify"].read_text(encoding="utf-8"))
        found["verify"] = result.get("verify", result)
    if "--samples" in files:
        import pandas

        table = pandas.read_parquet(files["--samples"])
        found["samples"] = {name: table[name].to_numpy() for name in table}
    return found


def main(path, *options):
    result = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
    count, wrong, cannot = 0, [], {}
    for name, value, mine, *allowed in rows_of(result, files_of(options)):
        if not allowed:
            cannot.setdefault(mine, []).append(name)
            continue
        count += 1
        if not recompute.difference_of(value, mine, allowed[0]) <= allowed[0]:
            wrong.append(f"  WRONG {name}: {value!r} in the result, {mine!r} here")
    print(f"{path}: {count} figures, {count - len(wrong)} recomputed within their tolerance; {sum(map(len, cannot.values()))} that these files do not determine")
    for why, names in cannot.items():
        print(f"  {len(names)}, as {names[0]}: {why}")
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
