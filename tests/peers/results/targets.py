"""The controller on its targets, from the JSON result of `counterpoise design` alone: what smaller numbers cost the loop, and what rounded
coefficients do to each path.

Each function yields rows (name, value in the result, value computed here, relative tolerance), or (name, value, why) for a printed
figure that the result does not determine.
"""

import math

import numpy as np

from responses import at, decibels, system

# Mean squares in another order.
SUMS = 1e-9
# A response with rounded coefficients less the response: a small difference of large numbers.
DIFFERENCE = 1e-4
NO_HISTORY = "its run is not part of the result: ask for --histories"
SINGLE = 2.0**-24


def rows(result):
    yield from certificates(result)
    targets = result["targets"]
    double = {one["experiment"]: one["error_rms_rad_s"] for one in targets["numbers"][0]["experiments"]}
    histories = {one["name"]: one for one in result["verify"].get("histories", [])}
    for numbers in targets["numbers"]:
        for run in numbers["experiments"]:
            name = f"{run['experiment']} in {numbers['numbers']}"
            if run.get("errors_rad_s"):
                mine = math.sqrt(float(np.mean(np.square(run["errors_rad_s"]))))
                yield f"error, {name}", run["error_rms_rad_s"], mine, SUMS
            else:
                yield f"error, {name}", run["error_rms_rad_s"], NO_HISTORY
            if run["cost_db"] is not None:
                # dB of a ratio near 1
                off = abs(run["cost_db"] - decibels(run["error_rms_rad_s"] / double[run["experiment"]]))
                yield f"cost, {name}, dB", 1.0, 1.0 + off, SUMS
        if numbers["numbers"] == "double":
            for run in numbers["experiments"]:
                known = histories.get(run["experiment"])
                if known and run.get("errors_rad_s"):
                    own = np.array(known["demand_rad_s"]) - np.array(known["hub_rate_rad_s"])
                    off = float(np.max(np.abs(own - np.array(run["errors_rad_s"]))))
                    yield f"the run in double is that of the verification, {run['experiment']}", 1.0, 1.0 + off, 1e-12
    chosen = [one for one in targets["path_forms"] if one["is_in_use"]]
    for one in targets["path_forms"]:
        yield from form(one)
    yield "paths with a form in use", float(len(chosen)), float(len({one["path"] for one in targets["path_forms"]})), 0.0
    needed = 2 * targets["multiplications"] + targets["additions"] + 2 * targets["states"]
    yield "instructions of a step by hand", targets["instructions_by_hand"], needed, 0.0
    in_use = [one for one in targets["by_form"] if one["form"] == "as exported"]
    for one in in_use:
        yield "multiplications of the exported form", one["multiplications"], targets["multiplications"], 0.0
    for one in targets["compiled"]:
        if one["samples"] is not None:
            # the longest runs together: every sample of every closed loop
            yield f"samples that differ, {one['language']} {one['numbers']}", one["wrong"], "compiled code is run, not simulated"


def form(one):
    """Coefficients, and the error of the response when they are rounded: as predicted and as measured."""
    name = f"{one['path']}, {one['form']}"
    G = system(one["system"])
    matrices = [np.array(M) for M in (G.A, G.B, G.C, G.D)]
    counts = lambda M: (M != 0.0) & (np.abs(M) != 1.0)
    yield f"coefficients, {name}", one["coefficients"], sum(int(np.sum(counts(M))) for M in matrices), 0.0
    rates = np.array([math.pi / G.dt * 10.0 ** (5.0 * ((k + 0.5) / 100.0 - 1.0)) for k in range(100)])
    points = np.exp(1j * rates * G.dt)
    sizes = np.max(np.abs(at(G, rates, G.dt)), axis=(1, 2))
    scale = np.maximum(sizes, np.sort(sizes)[len(sizes) // 2])
    A, B, C, D = matrices
    rounded = [M.astype(np.float32).astype(float) for M in matrices]
    measured, predicted = [], []
    for z in points:
        inverse = np.linalg.inv(z * np.eye(len(A)) - A)
        other = np.linalg.inv(z * np.eye(len(A)) - rounded[0])
        # (C' R' B' + D') - (C R B + D) by the change of each, because the two nearly cancel
        change = (rounded[2] - C) @ other @ rounded[1] + C @ other @ (rounded[0] - A) @ inverse @ rounded[1]
        change = change + C @ inverse @ (rounded[1] - B) + rounded[3] - D
        measured.append(float(np.max(np.abs(change))))
        f, g = np.sum(np.abs(inverse @ B) ** 2, axis=1), np.sum(np.abs(C @ inverse) ** 2, axis=0)
        square = lambda M, weight: float(np.sum(np.where(counts(M), M**2 * weight, 0.0)))
        total = square(D, 1.0) + square(A, np.outer(g, f)) + square(B, g[:, None]) + square(C, f[None, :])
        predicted.append(SINGLE * math.sqrt(total / 3.0))
    # a pole on the unit circle has no response there
    worst = lambda errors: float(max((e for e in np.array(errors) / scale if math.isfinite(e)), default=0.0))
    yield f"error of rounded coefficients, predicted, {name}", one["predicted"], worst(predicted), DIFFERENCE
    yield f"error of rounded coefficients, measured, {name}", one["measured"], worst(measured), 1e-2


def certificates(result):
    """Costs and poles among the certificates; residuals are rounding errors of the program's own arithmetic."""
    costs = {one["part"]: one for one in result["synth"]["costs"]}
    figures = {one["figure"]: one["value"] for one in result["verify"]["figures"]}
    for one in result["certificates"]:
        name = one["name"]
        if "predicted against achieved cost" in name:
            cost = costs[name.split(":")[0].replace(" feedforward", "")]
            yield name, one["value"], abs(cost["achieved"] - cost["predicted"]) / abs(cost["predicted"]), SUMS
        elif "on the design plant" in name:
            yield name, one["value"], result["synth"]["largest_pole_modulus"], 0.0
        elif "on the full plant" in name:
            yield name, one["value"], figures["closed_loop_pole_radius"], SUMS
        else:
            yield name, one["value"], "a residual: the rounding errors of this program's own arithmetic"
