"""Trials of an adaptation from the hub's rates of their runs, from the JSON result alone."""

import math

import numpy as np

# Mean squares in another order.
SUMS = 1e-10
# What a method may exceed the hub rate without adaptation by before it is refused.
REFUSED_ABOVE = 1.03
NO_HISTORY = "its run is not part of the result: ask for --histories"


def rows(found):
    if not found:
        return
    runs = {(one["motion"], one["load"], one["acts"]): np.array(one["hub_rate_rad_s"]) for one in found.get("histories", [])}
    worst = {}
    after = {(row["motion"], row["load"]): row["without_rad_s"] for row in found["rows"]}
    for row in found["rows"]:
        ends = [after[row["motion"], load] for load in ("sudden", "slow")]
        yield f"spread on {row['motion']}", row["spread_rad_s"], 0.0 if None in ends else abs(ends[0] - ends[1]), SUMS
        for key, acts in (("without_rad_s", "none"), ("told_rad_s", "told"), ("with_rad_s", row["method"])):
            name = f"trial on {row['motion']}, load {row['load']}: {acts}"
            rates = runs.get((row["motion"], row["load"], acts))
            if rates is None:
                yield name, row[key], NO_HISTORY
            else:
                mine = math.sqrt(float(np.mean(rates**2))) if len(rates) else math.inf
                yield name, math.inf if row[key] is None else row[key], mine, SUMS
        # where the load is less than designed, ignorance of it can do better by luck than knowledge
        known = row["told_rad_s"] if row["load"] == "lower" else 0.0
        ratio = (row["with_rad_s"] or math.inf) / max(row["without_rad_s"], known)
        if ratio > worst.get(row["method"], (0.0, None))[0]:
            worst[row["method"]] = ratio, row
    refused = {one["worst"]["method"]: one for one in found["refused"]}
    if found.get("bands") and not found["bands"]["is_exported"]:
        # what is not exported is not refused
        worst = {}
    for method, (ratio, row) in worst.items():
        yield f"whether {method} is refused", float(method in refused), float(ratio > REFUSED_ABOVE), 0.0
        if method in refused:
            yield f"ratio of {method} in its worst trial", refused[method]["ratio"], ratio, SUMS
            yield f"worst trial of {method}", 0.0, float(refused[method]["worst"] != row), 0.0
