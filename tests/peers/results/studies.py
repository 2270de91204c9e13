"""Recomputes the figures that `counterpoise sweep`, `compare`, `adapt`, `claims`, `fra`, `replay`, `diagnose` and `identify` print from their JSON results,
with what the program writes beside them.

    counterpoise COMMAND PROJECT ... --json=result.json --data data
    python tests/peers/results/studies.py result.json [--series data/series] [--samples out/sweep/samples.parquet] [--verify verify.json]

`replay` and `diagnose` need the series that --data writes, `sweep` the mechanisms that --histories adds to its result or the samples of its folder,
and `fra` the linear loop of the result of `verify` or `design` on the same project. The script fails if a figure differs by more than its
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


def fra(result, files):
    verify = files.get("verify")
    for chart in result["maps"]:
        for point in chart["points"]:
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
            for key, why in (("response", RUN), ("distortion", RUN), ("mean_rad_s", RUN), ("describing", "a balance with describing functions, whose plants are not in the result")):
                if point.get(key) is not None:
                    yield f"{key}, {name}", 0.0, why


def series_of(files, recording):
    path = files.get("series") and files["series"] / f"{pathlib.Path(recording).stem}.csv"
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
        series = series_of(files, recording["file"])
        for channel, told in recording["channels"].items():
            name = f"{channel}, {recording['file']}"
            both = pair(series, channel, "before")
            if both is None:
                yield f"RMS error, {name}", told["rms_error"], "its series is not among the files of --data"
                yield f"variance accounted for, {name}", told["vaf"], "its series is not among the files of --data"
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
    series = sorted(files["series"].glob("*.csv")) if files.get("series") else []
    series = [path for path in series if path.name != "contents.csv"]
    one = series_of(files, series[0]) if len(series) == 1 else None
    for when in ("before", "after"):
        for channel, told in (result["fit"][when] or {}).items():
            both = pair(one, channel, when)
            name = f"RMS error {when}, {channel}"
            if both is None:
                yield name, told["rms_error"], "more recordings than one share the figure, or there is no series"
            else:
                yield f"{name}, by the series' own run", told["rms_error"], math.sqrt(float(np.mean((both[0] - both[1]) ** 2))), ANOTHER_RUN
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


def adapt(result, _):
    """Hub rates over that of run a between the same times: runs that share an interval must tell of the same rate of run a."""
    factors, first = {}, result["runs"][0]["intervals"][0]
    for run in result["runs"]:
        for interval in run["intervals"]:
            ends = tuple(interval["from_to_s"])
            name = f"run {run['letter']} from {ends[0]:.4g} s"
            if run["letter"] == "a":
                yield f"hub rate over that of run a, {name}", interval["over_default"], 1.0, FORMULA
                factors[ends] = interval["hub_rms_rad_s"]
            elif ends in factors:
                yield f"hub rate over that of run a, {name}", interval["over_default"], interval["hub_rms_rad_s"] / factors[ends], FORMULA
            else:
                factors[ends] = interval["hub_rms_rad_s"] / interval["over_default"]
                yield f"hub rate over that of run a, {name}", interval["over_default"], "the hub rate of run a between these times is told by no other number"
            yield f"out-of-balance, {name}", interval["out_of_balance_kg_m"], interval["factor"] * first["out_of_balance_kg_m"], FORMULA
            yield f"hub rate, {name}", interval["hub_rms_rad_s"], RUN
            yield f"out-of-balance in use, {name}", interval["used_kg_m"], RUN
    yield from trials.rows(result.get("trials"))


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
        for key, value in (row["nonlinear"] or {}).items():
            if value is not None:
                yield f"{key}, {row['name']}", value, RUN


STUDIES = [("maps", fra), ("recordings", replay), ("verdict", diagnose), ("balances", identify), ("runs", adapt), ("claims", claims), ("rows", compare), ("figures", sweep)]


def rows_of(result, files):
    found = [rows for key, rows in STUDIES if key in result]
    if not found:
        sys.exit("this script recomputes no figure of such a result: it knows sweep, compare, adapt, claims, fra, replay, diagnose and identify")
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
