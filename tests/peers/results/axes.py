"""The figures of two axes, from their time histories: RMS errors of both rates, and of the line of sight as the integral of its rate."""

import numpy as np

# RMS values of the same samples
TOLERANCE = 1e-9
# A figure that is nothing but rounding: of the size of the rates times the precision of a double.
ROUNDING = 1e-15


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def angle(rates, period):
    """RMS of the integral by the trapezoidal rule, less its mean."""
    steps = 0.5 * period * (rates[1:] + rates[:-1])
    travel = np.concatenate([[0.0], np.cumsum(steps)])
    return rms(travel - np.mean(travel))


def errors(elevation, traverse, cross, period):
    found = {
        "elevation_rate_rms_rad_s": rms(elevation),
        "traverse_rate_rms_rad_s": rms(traverse),
        "elevation_sight_rms_rad": angle(elevation, period),
        "cross_elevation_sight_rms_rad": angle(cross, period),
    }
    found["sight_rms_rad"] = float(np.hypot(found["elevation_sight_rms_rad"], found["cross_elevation_sight_rms_rad"]))
    return found


def together(run, first, ring_to_sight):
    signal = lambda key: np.array(run[key])[first:]
    elevation = signal("elevation_rate_rad_s") - signal("elevation_demand_rad_s")
    demand = signal("traverse_demand_rad_s")
    if ring_to_sight is None:
        cross = signal("cross_elevation_rate_rad_s") - demand
        return errors(elevation, cross, cross, run["sample_period_s"])
    wanted = demand * np.cos(signal("elevation_rad"))
    traverse = signal("ring_rate_rad_s") - demand
    return errors(elevation, traverse, signal("cross_elevation_rate_rad_s") - wanted, run["sample_period_s"])


def alone(run, first, ring_to_sight):
    signal = lambda key: np.array(run[key])[first:]
    elevation = signal("elevation_rate_alone_rad_s") - signal("elevation_demand_rad_s")
    traverse = signal("traverse_rate_alone_rad_s") - signal("traverse_demand_rad_s")
    cross = (1.0 if ring_to_sight is None else ring_to_sight) * traverse
    return errors(elevation, traverse, cross, run["sample_period_s"])


def rows(both, rows_of_axis):
    """The figures of the traverse axis alone, then those of both axes and their verdicts."""
    if not both:
        return
    for name, *rest in rows_of_axis(both["traverse"]):
        yield f"traverse axis: {name}", *rest
    ratio, mine = both["ring_to_sight"], {}
    for run in both.get("histories", []):
        first = round(both["settle_s"] / run["sample_period_s"])
        for kind, found in ("value", together(run, first, ratio)), ("alone", alone(run, first, ratio)):
            mine.update({(f"{run['experiment']}_{key}", kind): value for key, value in found.items()})
    values = {}
    for figure in both["figures"]:
        key = figure["figure"]
        values[key] = figure["value"]
        for kind in "value", "alone":
            found = mine.get((key, kind))
            if found is None:
                yield f"both axes: {key}, {kind}", figure[kind], "its time history is not part of the result: ask for --histories"
            elif max(found, figure[kind]) < ROUNDING:
                yield f"both axes: {key}, {kind}", 0.0, 0.0, TOLERANCE
            else:
                yield f"both axes: {key}, {kind}", figure[kind], found, TOLERANCE
    for verdict in both["verdicts"]:
        if verdict["value"] is None:
            continue
        yield f"both axes: verdict on {verdict['figure']}", verdict["value"], values[verdict["figure"]], 0.0
        room = (verdict["limit"] - verdict["value"]) * (1.0 if verdict["limit_side"] == "at most" else -1.0)
        yield f"both axes: {verdict['figure']} holds", float(verdict["verdict"] == "holds"), float(room >= 0.0), 0.0
    passes = both["traverse"]["passes"] and all(verdict["verdict"] != "fails" for verdict in both["verdicts"])
    yield "both axes: passes", float(both["passes"]), float(passes), 0.0
