"""What `counterpoise synth` compares a design with, recomputed from its JSON result alone: norms of other methods, states of balance, and
margins of a loop.

Each function yields rows (name, value in the result, value computed here, relative tolerance).
"""

import math

import control
import numpy as np

import stages
from responses import at, crossings, decibels, largest, swept, system

# A Lyapunov equation of a generalised plant by another library; slow poles beside quick ones cost digits.
NORM = 1e-5
# A peak by a grid and a golden section.
PEAK = 1e-4
# Integrals over frequency on another grid.
INTEGRALS = 2e-4
# A small difference of large numbers.
RESIDUALS = 5e-3


def feedback_loop(P, K):
    """The lower linear fractional transformation of a plant with one control and one measurement, the last ones."""
    B1, B2, C1, C2 = P.B[:, :-1], P.B[:, -1:], P.C[:-1], P.C[-1:]
    D11, D12, D21 = P.D[:-1, :-1], P.D[:-1, -1:], P.D[-1:, :-1]
    assert not P.D[-1:, -1:].any()
    A = np.block([[P.A + B2 @ K.D @ C2, B2 @ K.C], [K.B @ C2, K.A]])
    B = np.vstack([B1 + B2 @ K.D @ D21, K.B @ D21])
    C = np.hstack([C1 + D12 @ K.D @ C2, D12 @ K.C])
    return A, B, C, D11 + D12 @ K.D @ D21


def h2_norm(A, B, C):
    """The norm by a Lyapunov equation in the basis of eigenvectors."""
    values, V = np.linalg.eig(A)
    b = np.linalg.solve(V, B.astype(complex))
    X = -(b @ b.conj().T) / (values[:, None] + values[None, :].conj())
    out = C @ V
    return math.sqrt(float(np.trace(out @ X @ out.conj().T).real))


def h_infinity_norm(A, B, C, D):
    poles = np.linalg.eigvals(A)
    moduli = np.abs(poles)[np.abs(poles) > 0.0]
    rates = np.unique(np.concatenate([np.geomspace(moduli.min() * 1e-2, moduli.max() * 1e2, 6000), np.abs(poles)]))
    one = control.ss(A, B, C, D)
    size = lambda rate: float(np.linalg.norm(at(one, np.array([rate]), 0.0)[0], 2))
    return largest(rates, np.array([np.linalg.norm(G, 2) for G in at(one, rates, 0.0)]), size)


def method(row):
    """Order, integral action and norm of the feedback of a method."""
    problem = row.get("problem")
    if not problem:
        return
    name = row["method"]
    yield f"{name}: order", row["order"], len(problem["feedback"]["A"]), 0.0
    poles = [abs(complex(*pole)) for pole in problem["error_weight"]["poles"]]
    yield f"{name}: integral action", float(row["integral"]), float(0.0 in poles), 0.0
    if row["norm"] is None:
        return
    if problem.get("basis"):
        weights = [problem["error_weight"], problem["control_weight"]]
        cost = stages.Assembled(problem["basis"], weights).of_feedback(1.0)
        yield f"{name}: norm", row["norm"], math.sqrt(cost), INTEGRALS
    elif problem.get("generalised"):
        closed = feedback_loop(system(problem["generalised"]), system(problem["on_generalised"]))
        if "inf" in name.lower():
            yield f"{name}: norm", row["norm"], h_infinity_norm(*closed), PEAK
        else:
            yield f"{name}: norm", row["norm"], h2_norm(*closed[:3]), NORM


# The band of 60 frequencies over which controllers are compared, rad/s.
BAND = [0.628 * (126.0 / 0.628) ** (k / 59.0) for k in range(60)]


def change(before, after):
    """Lowest and highest change of the gain on the last input, dB."""
    a, b = (np.abs(at(system(one), np.array(BAND), 0.0)[:, 0, -1]) for one in (before, after))
    ratios = 20.0 * np.log10(b / a)
    return float(ratios.min()), float(ratios.max())


def balance(beside, weights):
    """States of balance: change of each controller, and the hub's rate with the nominal design, with the gain law and with its own."""
    rows, bases = beside["balance"], beside["balance_basis"]
    for row, basis in zip(rows, bases):
        parts = {one["name"]: one for one in basis["controllers"]}
        nominal = {one["name"]: one for one in bases[0]["controllers"]}
        for key in ("feedback", "heave", "pitch"):
            told = row[f"{key}_db"]
            if told is not None:
                for end, a, b in zip(("lowest", "highest"), told, change(nominal[key], parts[key])):
                    # dB of a ratio near 1
                    yield f"{row['name']}: {end} change of {key}, dB", 1.0, 1.0 + abs(a - b), 1e-6
        factor = row["out_of_balance_kg_m"] / rows[0]["out_of_balance_kg_m"] if rows[0]["out_of_balance_kg_m"] else 1.0
        for key, of, gain in (("error_before", "nominal", 1.0), ("error_gain_law", "nominal", factor), ("error_after", "redesign", 1.0)):
            told = row[f"{key}_rad_s"]
            if told is not None:
                assembled = stages.Assembled(basis[of], weights)
                channel = next(one for one in basis[of]["channels"] if one["name"] == "heave")
                output = basis[of]["rate_output"]
                yield f"{row['name']}: {key}", told, assembled.motion(channel, output, gain), RESIDUALS


# Order up to which a loop is solved at every rate.
SOLVED = 40


def margins(L):
    """Margins of a sampled loop broken at the control."""
    dt = L.dt
    rates = np.geomspace(1e-3, math.pi / dt * (1 - 1e-9), 40000)
    # a sweep by eigenvectors loses digits where they are nearly parallel: it serves loops that are too large to be solved at every rate
    one = lambda rate: at(L, np.array([rate]), dt)[0, 0, 0]
    values = (at if L.nstates <= SOLVED else swept)(L, rates, dt)[:, 0, 0]
    unity = crossings(rates, np.abs(values) - 1.0, lambda r: abs(one(r)) - 1.0)
    real = [r for r in crossings(rates, values.imag, lambda r: one(r).imag) if one(r).real < 0.0]
    gains = [abs(decibels(abs(one(r)))) for r in real]
    nyquist = one(math.pi / dt).real
    gains += [abs(decibels(-nyquist))] if nyquist < 0.0 else []
    return {
        "gain_margin_db": min(gains, default=math.inf),
        "phase_margin_deg": min([abs(math.degrees(np.angle(-one(r)))) for r in unity], default=math.inf),
        "crossover_rad_s": max(unity, default=0.0),
        # where the gain falls to 1 first: a resonance may take it above 1 once more
        "bandwidth_rad_s": min([r for r in unity if abs(one(r * (1.0 - 1e-6))) > 1.0], default=0.0),
        "max_sensitivity": largest(rates, np.abs(1.0 / (1.0 + values)), lambda r: abs(1.0 / (1.0 + one(r)))),
    }
