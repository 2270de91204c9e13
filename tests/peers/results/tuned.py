"""Figures of feedback loops that `counterpoise compare`, and `synth` and `design` of a tuned PI beside the design, state: recomputed from the plant, the
feedback, the disturbance and the noise in the JSON result.
"""

import math

import control
import numpy as np
import scipy.linalg

from responses import figures_of_loop, largest, named, swept, system

# Linear figures that are found in another way.
LOOP = 1e-5
# Share of a limit up to which a tuned structure keeps it.
KEPT = 1e-3
# Limits from above; the others are limits from below.
MOST = {"max_sensitivity", "max_complementary", "noise_gain", "control_peak"}
# The band of the RMS of |S|, rad/s, and its lines, even over the logarithm of frequency.
BAND, BAND_LINES = (1.26, 12.6), 96
# Poles of a smaller modulus have faded within a sample or two.
FASTEST_POLE = 1e-6


def two_norm(closed):
    """RMS of the output for white noise of unit RMS."""
    X = scipy.linalg.solve_discrete_lyapunov(closed.A, closed.B @ closed.B.T)
    return math.sqrt(float(np.trace(closed.C @ X @ closed.C.T + closed.D @ closed.D.T)))


def loop_figures(told, plant, feedback, figures):
    """Linear figures of a feedback on a plant, under the keys that the result has, for the disturbance and the noise that it tells."""
    dt = plant["sample_time_s"]
    P, K = system(plant), system(feedback)
    L = control.series(P, K)
    found = figures_of_loop(L, dt)
    closed, KS = control.feedback(L, 1), control.feedback(K, P)
    poles = np.abs(np.linalg.eigvals(closed.A))
    reading = lambda part, rates: swept(part, np.asarray(rates), dt)[:, 0, 0]
    rates = np.geomspace(1e-3, math.pi / dt * (1 - 1e-9), 40000)
    peak_of = lambda r: abs(reading(K, [r])[0] / (1.0 + reading(L, [r])[0]))
    lines = np.array(told["disturbance"])
    S = 1.0 / (1.0 + reading(L, lines[:, 0]))
    band = BAND[0] * (BAND[1] / BAND[0]) ** ((np.arange(BAND_LINES) + 0.5) / BAND_LINES)
    noise = next(value for key, value in told.items() if key.startswith("reading_noise"))
    residual = math.sqrt(float(np.sum(lines[:, 1] * np.abs(S) ** 2)))
    unit, effort = (next(key for key in figures if key.startswith(stem)) for stem in ("residual", "effort"))
    return {**{key: found[key] for key in ("max_sensitivity", "gain_margin_db", "phase_margin_deg", "delay_margin_s")},
            "max_complementary": found["max_complementary_sensitivity"], "crossover_rad_s": 2.0 * math.pi * found["crossover_hz"],
            "decay_rad_s": float(np.min(-np.log(poles[poles > FASTEST_POLE]) / dt)), "noise_gain": two_norm(KS),
            "control_peak": largest(rates, np.abs(reading(K, rates) / (1.0 + reading(L, rates))), peak_of),
            effort: math.sqrt(float(np.sum(lines[:, 1] * np.abs(S * reading(K, lines[:, 0])) ** 2))),
            unit: math.hypot(residual, noise * two_norm(closed)),
            "rejection": float(np.sqrt(np.mean(np.abs(1.0 / (1.0 + reading(L, band))) ** 2)))}


def missed(limits, figures):
    """By how much the worst limit is missed. A margin without a number is infinite."""
    beyond = lambda key, limit: figures[key] / limit - 1.0 if key in MOST else 1.0 - figures[key] / limit
    over = max(beyond(key, limit) for key, limit in limits.items() if limit is not None and figures[key] is not None)
    return over if over > KEPT else 0.0


def beside_rows(told):
    """The rows of a tuned PI beside a design; none if the result has none."""
    if not told:
        return
    plant = named(told["systems"], "plant")
    for figures, feedback in (("own", "feedback"), ("tuned", "tuned_pi")):
        mine = loop_figures(told, plant, named(told["systems"], feedback), told[figures])
        for key, value in told[figures].items():
            if value is not None:
                yield f"{key} beside a tuned PI, {figures}", value, mine[key], LOOP
    for key, limit in told["limits"].items():
        if limit is not None:
            yield f"limit of a tuned PI, {key}", limit, told["own"][key], 0.0
    yield "limit that the tuned PI misses", told["missed"], missed(told["limits"], told["tuned"]), 1e-6
