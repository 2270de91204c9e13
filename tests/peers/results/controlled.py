"""Results of a loop of position, torque or current under the names of a loop of rate.

Figures and histories have the quantity and the unit of what their loop controls in their names. The scripts beside this one compute the same
numbers for every loop, so they read all of them under the names of a loop of rate.
"""

import re

# The tip's angle against the hub's is an angle in every loop.
ENDINGS = [
    (r"(?:(?<=_)(?<!against_)|^)(?:hub|slide|torque|force|controlled_current)_(rms|peak)_(?:rad_s|m_s|rad|m|nm|n|a)$", r"hub_\1_rad_s"),
    (r"tip_(rms|peak)_(?:rad_s|m_s|rad|m)$", r"tip_\1_rad_s"),
    (r"error_(rms|peak)_(?:rad_s|m_s|rad|m|nm|n|a)$", r"error_\1_rad_s"),
    (r"travel_peak_(?:rad|m)$", "travel_peak_rad"),
    (r"rest_drift_(?:rad|m)$", "rest_drift_rad"),
]


# A case of the stability certificate: its runs, its noise floor and its limit cycle.
CASE = [
    (r"^(rest_rms|noise_floor|reading_noise|reading_step|amplitude|start)_(?:m_s|rad|m|nm|n|a)$", r"\1_rad_s"),
    (r"^rounding_(?:m_s|rad|m|nm|n|a)$", "rounding"),
    (r"^(rest_|motion_|)samples_(?:m_s|rad|m|nm|n|a)$", r"\1rates_rad_s"),
]


def case(one):
    """Returns a case of the certificate under the names of a loop of rate."""

    def keys(part):
        renamed = {}
        for name, value in part.items():
            for own, of_rate in CASE:
                name = re.sub(own, of_rate, name)
            renamed[name] = value
        return renamed

    one = keys(one)
    cycle = one["limit_cycle"]
    return {**one, "limit_cycle": cycle and keys(cycle), "orbits": [keys(orbit) for orbit in one["orbits"]]}


def figure(name):
    """Returns the key of a figure in a loop of rate."""
    for own, of_rate in ENDINGS:
        name = re.sub(own, of_rate, name)
    return name


def history(columns):
    """Returns a time history whose columns have the names of a loop of rate: the controlled one stands before the tip's."""
    names = list(columns)
    tip = next(k for k, name in enumerate(names) if name.startswith("tip_"))
    renamed = {names[tip - 1]: "hub_rate_rad_s", names[tip]: "tip_rate_rad_s"}
    for name in names:
        for start, of_rate in (("demand_", "demand_rad_s"), ("travel_", "travel_rad")):
            if name.startswith(start):
                renamed[name] = of_rate
    return {renamed.get(name, name): value for name, value in columns.items()}


def as_rate_loop(value):
    """Returns a result, or a part of one, under the names of a loop of rate."""
    if isinstance(value, list):
        return [as_rate_loop(one) for one in value]
    if not isinstance(value, dict):
        return value
    if {"start_s", "control_v"} <= value.keys() and any(name.startswith("tip_") for name in value):
        value = history(value)
    if "experiment" in value and "cost_db" in value:
        value = {re.sub(r"^(error_rms|errors)_.*", r"\1_rad_s", name): one for name, one in value.items()}
    if {"orbits", "limit_cycle"} <= value.keys():
        value = case(value)
    if "frequency_hz" in value and isinstance(value.get("name"), str):
        value = {**value, "name": re.sub("^.* over platform, ", "hub rate over platform, ", value["name"])}
    return {
        name: figure(one) if name == "figure" and isinstance(one, str) else as_rate_loop(one) for name, one in value.items()
    }
