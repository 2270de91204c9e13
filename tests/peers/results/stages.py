"""What `counterpoise model`, `reduce` and `synth` print, recomputed from their JSON results alone.

Each function yields rows (name, value in the result, value computed here, relative tolerance), or (name, value, why) for a printed
figure that the result does not determine.
"""

import math

import control
import numpy as np

import designs
import structure
from responses import at, bisect, crossings, decibels, golden, largest, response_rows, swept, system

# Eigenvalues of a badly scaled matrix by another library.
POLES = 1e-7
# Margins by a dense grid and bisection.
MARGINS = 1e-6
# Integrals over frequency on another grid.
INTEGRALS = 2e-4
# The same sums.
SUMS = 1e-9
# Every fifth point of a loop.
AREAS = 2e-2


def model(result):
    plant = system(result["plant"])
    yield "order", result["order"], plant.nstates, 0.0
    yield "number of states named", result["order"], len(result["states"]), 0.0
    told = sorted((complex(*p) for p in result["poles_rad_s"]), key=lambda p: (abs(p), p.imag))
    mine = sorted(np.linalg.eigvals(plant.A), key=lambda p: (abs(p), p.imag))
    for a, b in zip(told, mine):
        if a.imag >= 0.0 and abs(a) > 0.0:
            yield "frequency of a pole, Hz", abs(a) / (2.0 * math.pi), abs(b) / (2.0 * math.pi), POLES
            yield "damping of a pole", -a.real / abs(a), -b.real / abs(b), POLES * abs(a) / max(abs(a.real), 1e-12)
    yield "holding_v", result["holding_v"], *holding(result)
    yield from structure.rows(result)
    yield from frictions(result)
    yield from accuracy(result)
    yield from response_rows(plant, result["responses"], range(3))


def frictions(result):
    """Loops of friction under a sine of 1 Hz by their points: what they lose, their largest torque, and the damping that loses as much."""
    for friction in result.get("frictions", []):
        for loop in friction["loops"]:
            name = f"at the {friction['place']}, {loop['amplitude_rad']:.3e} rad"
            angle, torque = np.array(loop["points"]).T
            yield f"largest torque {name}", loop["largest_torque_nm"], float(np.max(np.abs(torque))), SUMS
            yield f"swing {name}", loop["amplitude_rad"], float(np.max(np.abs(angle))), 1e-2
            # the area of the polygon of every fifth point
            area = abs(float(np.sum(0.5 * (torque[1:] + torque[:-1]) * np.diff(angle))))
            yield f"lost in a period {name}", loop["lost_j"], area, AREAS
            damping = loop["lost_j"] / (2.0 * (math.pi * loop["amplitude_rad"]) ** 2)
            yield f"equivalent damping {name}", loop["equivalent_damping_nm_s_rad"], damping, SUMS


def accuracy(result):
    """The order of the simulator's error: the slope between the longest step and the shortest whose error is no rounding."""
    for law in result.get("accuracy", []):
        floor = max(10.0 * law["second_method"], 1e-9)
        known = [(step, error) for step, error in zip(law["step_s"], law["plain"]) if error > floor]
        if law["order"] is not None:
            (long, first), (short, last) = known[0], known[-1]
            yield f"order of the error, {law['name']}", law["order"], math.log(first / last) / math.log(long / short), SUMS


def holding(result):
    """The control that holds the weight, by the balance; why not, if free functions add torques of their own."""
    b = result["balance"]
    if b["has_free_functions"]:
        return ("free functions of a diagnosis add torques to the balance",)
    cos, sin = b["tilt"]
    held = b["gravity_m_s2"] * (result["out_of_balance_kg_m"] * cos - b["vertical_offset_kg_m"] * sin) - b["spring_nm"]
    current = ((held - b["mesh_ripple_nm"]) * b["motor_share"] - b["cogging_nm"]) / b["torque_constant_nm_a"]
    drive = abs(drive_for(current, b))
    points = [(0.0, 0.0)] + [tuple(point) for point in b["curve_v"]]
    beyond = points[-1][0] + (drive - points[-1][1])
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        if drive <= y1:
            beyond = x0 + (drive - y0) * (x1 - x0) / (y1 - y0)
            break
    limit = math.inf if b["input_limit_v"] is None else b["input_limit_v"]
    size = min(beyond + b["dead_zone_v"], limit) if drive > 0.0 else 0.0
    return math.copysign(size, current), SUMS


def drive_for(current, b):
    """The drive for a current, V; with a cylinder for a load pressure, MPa: the valve passes what leaks."""
    valve = b.get("valve")
    if valve is None:
        return current * b["drive_v_per_a"]
    share = 1.0 - abs(current) / valve["supply_mpa"]
    root = share / math.sqrt(max(abs(share), valve["laminar_share"]))
    opening = valve["leakage_l_s_mpa"] * abs(current) / root + valve["overlap_l_s"] if current else 0.0
    return math.copysign(opening / valve["gain_l_s_v"], current)


def largest_singular_value(before, after):
    """The largest singular value of the difference over frequency, and where."""
    poles = np.concatenate([np.linalg.eigvals(before.A), np.linalg.eigvals(after.A)])
    moduli = np.abs(poles)[np.abs(poles) > 0.0]
    rates = np.geomspace(moduli.min() * 1e-2, moduli.max() * 1e2, 4000)
    rates = np.unique(np.concatenate([rates, np.abs(poles.imag)[poles.imag > 0.0]]))
    size = lambda rate: np.linalg.norm(at(before, np.array([rate]), 0.0)[0] - at(after, np.array([rate]), 0.0)[0], 2)
    values = np.array([size(rate) for rate in rates])
    k = int(np.argmax(values))
    place = golden(size, rates[max(k - 1, 0)], rates[min(k + 1, len(rates) - 1)])
    return (size(place), place) if size(place) > values[k] else (values[k], rates[k])


def reduce(result):
    before, after = system(result["plant_before"]), system(result["plant"])
    yield from response_rows(after, result["responses"], range(3))
    yield "order before", result["order"][0], before.nstates, 0.0
    yield "order after", result["order"][1], after.nstates, 0.0
    if result["error"] is not None:
        error, rate = largest_singular_value(before, after)
        yield "largest error", result["error"][0], error, 1e-4
        # a flat maximum has a wide place
        reached = np.linalg.norm(np.subtract(*(at(s, np.array([result["error"][1]]), 0.0)[0] for s in (before, after))), 2)
        yield "error at the rate of the largest one", result["error"][0], reached, 1e-4
    ranked = result["ranked"]
    if result["bound"] is not None and ranked:
        yield "bound", result["bound"], 2.0 * sum(ranked[result["order"][1]:]), 1e-6
    if ranked and result["bound"] is not None and np.max(np.linalg.eigvals(before.A).real) < 0.0:
        P = control.lyap(before.A, before.B @ before.B.T)
        Q = control.lyap(before.A.T, before.C.T @ before.C)
        hankel = np.sqrt(np.abs(np.sort(np.linalg.eigvals(P @ Q).real)[::-1]))
        for k, (told, mine) in enumerate(zip(ranked, hankel)):
            if told > 1e-6 * ranked[0]:
                yield f"Hankel value {k + 1}", told, float(mine), 1e-5
            else:
                yield f"Hankel value {k + 1}", told, "below what the product of two Gramians determines"
    elif ranked:
        for k, told in enumerate(ranked):
            yield f"rank {k + 1}", told, "a share of a mode, computed with its own error bound"


def loop_figures(systems):
    """The seven figures of a sampled feedback loop."""
    named = {one["name"]: system(one) for one in systems}
    L, P, K = named["loop"], named["held_plant"], named["controller"]
    dt = L.dt
    rates = np.geomspace(1e-3, math.pi / dt * (1 - 1e-9), 40000)
    one = lambda rate: swept(L, np.array([rate]), dt)[0, 0, 0]
    values = swept(L, rates, dt)[:, 0, 0]
    unity = crossings(rates, np.abs(values) - 1.0, lambda r: abs(one(r)) - 1.0)
    real = [r for r in crossings(rates, values.imag, lambda r: one(r).imag) if one(r).real < 0.0]
    gains = [-20.0 * math.log10(abs(one(r))) for r in real]
    nyquist = one(math.pi / dt).real
    gains += [-20.0 * math.log10(-nyquist)] if nyquist < 0.0 else []
    phases = [abs(math.degrees(np.angle(-one(r)))) for r in unity]
    band = np.array([1.26 * (12.6 / 1.26) ** (k / 23.0) for k in range(24)])
    rejection = math.sqrt(float(np.mean(np.abs(1.0 / (1.0 + at(L, band, dt)[:, 0, 0])) ** 2)))
    x, q, peak = np.zeros(P.nstates), np.zeros(K.nstates), 0.0
    for _ in range(math.ceil(1.5 / dt)):
        measured, true = P.C @ x
        peak = max(peak, true)
        u = K.C @ q + K.D @ np.array([1.0, measured])
        q = K.A @ q + K.B @ np.array([1.0, measured])
        x = P.A @ x + P.B @ u
    # the control for white noise of the measured rate
    Kn = control.ss(K.A, K.B[:, 1:], K.C, K.D[:, 1:], dt)
    Pn = control.ss(P.A, P.B, P.C[:1, :], P.D[:1, :], dt)
    closed = control.feedback(Kn, Pn, sign=1)
    X = control.dlyap(closed.A, closed.B @ closed.B.T)
    noise = math.sqrt(float((closed.C @ X @ closed.C.T + closed.D @ closed.D.T)[0, 0]))
    return {
        "gain_margin_db": min([g for g in gains if g > 0.0], default=math.inf),
        "phase_margin_deg": min(phases, default=math.inf),
        "max_sensitivity": largest(rates, np.abs(1.0 / (1.0 + values)), lambda r: abs(1.0 / (1.0 + one(r)))),
        "crossover_rad_s": max(unity, default=0.0),
        "overshoot_percent": 100.0 * (peak - 1.0),
        "rejection": rejection,
        "noise_gain": noise,
    }


class Assembled:
    """The cost of an assembled loop as the documentation of the program states it, on a grid of its own."""

    def __init__(self, basis, weights):
        self.basis = basis
        self.plant = system(basis["plant"])
        self.feedback = system(basis["feedback"])
        self.weights = {w["name"]: (np.array(w["numerator"]), np.array(w["denominator"])) for w in weights}
        poles = [np.linalg.eigvals(self.plant.A), np.linalg.eigvals(self.feedback.A)]
        poles.append(np.linalg.eigvals(control.feedback(self.loop(), control.ss([], [], [], [[1.0]]), sign=1).A))
        for channel in basis["channels"]:
            poles.append(np.linalg.eigvals(system(channel["module"]).A))
            poles.append(np.roots(self.weights[f"{channel['name']}.generator"][1]))
        poles = np.concatenate(poles)
        moduli = np.abs(poles)[np.abs(poles) > 1e-6]
        rates = [np.geomspace(moduli.min() * 1e-3, moduli.max() * 1e3, 4000)]
        for pole in poles[(poles.imag > 0.0) & (np.abs(poles.real) < 0.3 * np.abs(poles))]:
            rates.append(pole.imag + max(abs(pole.real), 1e-9 * abs(pole)) * 60.0 * np.linspace(-1.0, 1.0, 201) ** 3)
        rates = np.unique(np.concatenate(rates))
        self.rates = rates[rates > 0.0]
        self.G = at(self.plant, self.rates, 0.0)
        self.K0 = at(self.feedback, self.rates, 0.0)[:, 0, 0]

    def loop(self):
        chosen = self.plant
        u = self.basis["control_input"]
        one = control.ss(chosen.A, chosen.B[:, [u]], chosen.C[[0], :], chosen.D[[0], :][:, [u]])
        return control.series(one, self.feedback)

    def weight(self, name):
        numerator, denominator = self.weights[name]
        s = 1j * self.rates
        return np.polyval(numerator, s) / np.polyval(denominator, s)

    def integral(self, density):
        r = self.rates
        below, above = np.concatenate([[0.0], r[:-1]]), np.concatenate([r[1:], [r[-1]]])
        return float(np.sum(0.5 * (above - below) / math.pi * density))

    def of_feedback(self, gain):
        b, u = self.basis, self.basis["control_input"]
        true = lambda output, input_: self.G[:, 1 + output, input_]
        hub, K = b["rate_output"], self.K0 * gain
        closed = 1.0 / (1.0 - K * self.G[:, 0, u])
        error, on_control = self.weight("feedback.error"), self.weight("feedback.control")
        sum_ = np.zeros(len(self.rates))
        H = self.G[:, 0, u] / true(hub, u)
        for one in (d for d in b["disturbances"] if d["density"] > 0.0):
            moved = closed * K * self.G[:, 0, one["input"]]
            y = lambda output: true(output, one["input"]) + true(output, u) * moved
            further = sum(w["weight"] * y(w["output"]) for w in b["combination"]) + 0.0 * moved
            sum_ += one["density"] * (np.abs(error * H * y(hub)) ** 2 + np.abs(on_control * moved) ** 2 + np.abs(further) ** 2)
        moved = closed * K
        y = lambda output: true(output, u) * moved
        further = sum(w["weight"] * y(w["output"]) for w in b["combination"]) + 0.0 * moved
        noisy = error * H * y(hub) + (error - b["direct_error_weight"])
        sum_ += b["measurement_noise"] * (np.abs(noisy) ** 2 + np.abs(on_control * moved) ** 2 + np.abs(further) ** 2)
        return self.integral(sum_)

    def source(self, channel):
        """The disturbance with its derivatives for a unit of white noise, and what the module makes of it."""
        s = 1j * self.rates
        size = self.weight(f"{channel['name']}.generator")
        signals = np.array([size * s**k for k in range(len(channel["inputs"]))])
        return signals, at(system(channel["module"]), self.rates, 0.0)

    def terms(self, channel, feedback_gain, given, module, weighed):
        """Weighed (rate, control) without the module and by it."""
        b, u = self.basis, self.basis["control_input"]
        K, G = self.K0 * feedback_gain, self.G[:, 0, u]
        closed = 1.0 / (1.0 - K * G)
        H = G / self.G[:, 1 + b["rate_output"], u]
        expected = H * module[1] if b["assembly"] == "grimble" else 0.0
        before, by = closed * K * H * given[0], closed * (module[0] - K * expected)
        to = self.G[:, 1 + weighed, u]
        return (given[1] + to * before, to * by), (before, by)

    def quadratic(self, channel, feedback_gain):
        signals, M = self.source(channel)
        sensor = at(system(channel["sensor"]), self.rates, 0.0)[:, 0, 0] if channel["sensor"] else 1.0
        direct = lambda output: sum(self.G[:, 1 + output, c] * signals[j] for j, c in enumerate(channel["inputs"]))
        module = [sum(M[:, i, j] * signals[j] for j in range(M.shape[2])) * sensor for i in (0, 1)]
        hub, weighed = self.basis["rate_output"], channel["weighed_output"]
        given = (direct(hub), direct(weighed))
        pairs = [self.terms(channel, feedback_gain, given, module, weighed)]
        if channel["noise"] is not None:
            of_noise = [M[:, i, 0] * math.sqrt(channel["noise"]) for i in (0, 1)]
            pairs.append(self.terms(channel, feedback_gain, (0.0, 0.0), of_noise, weighed))
        weights = (self.weight(f"{channel['name']}.error"), self.weight(f"{channel['name']}.control"))
        constant = linear = square = 0.0
        for pair in pairs:
            for weight, (before, by) in zip(weights, pair):
                before, by = weight * before + 0.0 * by, weight * by
                constant += self.integral(np.abs(before) ** 2)
                linear += self.integral(2.0 * (np.conj(before) * by).real)
                square += self.integral(np.abs(by) ** 2)
        return constant, linear, square

    def motion(self, channel, output, gain):
        """RMS of a true output under the expected disturbance, the feedforward times a gain."""
        signals, M = self.source(channel)
        sensor = at(system(channel["true_sensor"]), self.rates, 0.0)[:, 0, 0] if channel["true_sensor"] else 1.0
        direct = lambda o: sum(self.G[:, 1 + o, c] * signals[j] for j, c in enumerate(channel["inputs"]))
        module = [sum(M[:, i, j] * signals[j] for j in range(M.shape[2])) * sensor for i in (0, 1)]
        given = (direct(self.basis["rate_output"]), direct(output))
        (before, by), _ = self.terms(channel, 1.0, given, module, output)
        return math.sqrt(self.integral(np.abs(before + gain * by) ** 2))


def total_cost(cost, weights, motions):
    if cost.get("basis") is None:
        yield "total cost", cost["total"], "one joint problem, whose certificate stands in the design"
        return
    assembled = Assembled(cost["basis"], weights)
    channels = assembled.basis["channels"]
    own = assembled.of_feedback(1.0)
    quadratics = [assembled.quadratic(channel, 1.0) for channel in channels]
    total = own + sum(sum(q) for q in quadratics)
    yield "total cost", cost["total"], total, INTEGRALS
    rows = {row["part"]: row for row in cost["parts"]}
    names = list(rows)
    yield f"cost of {names[0]}", rows[names[0]]["cost"], own, INTEGRALS
    # the program's step: where the gain is nearly the best, the slope is as small as what a difference of another step leaves out
    step = 1e-3
    at_gain = lambda g: assembled.of_feedback(g) + sum(sum(assembled.quadratic(c, g)) for c in channels)
    slope = (at_gain(1.0 + step) - at_gain(1.0 - step)) / (2.0 * step * total)
    # where the gain is the best, the slope is the difference of equal parts of the total, each integrated on another grid
    yield f"slope of {names[0]}", rows[names[0]]["slope"], slope, max(1e-2, 0.1 * INTEGRALS / abs(slope))
    for name, (constant, linear, square) in zip(names[1:], quadratics):
        row, best = rows[name], -0.5 * linear / square
        lowered = constant + best * (linear + best * square)
        yield f"cost of {name}", row["cost"], constant + linear + square, INTEGRALS
        yield f"slope of {name}", row["slope"], (linear + 2.0 * square) / total, 20.0 * INTEGRALS
        yield f"best gain of {name}", row["best_gain"], best, INTEGRALS
        yield f"what it gains, {name}, %", row["gained_percent"], 100.0 * (constant + linear + square - lowered) / total, 0.05
    for row in motions:
        channel = next(c for c in channels if c["name"] == row["disturbance"])
        for key, output in (("hub_rad_s", 0), ("tip_rad_s", 1)):
            for gain, told in zip((0.0, 1.0), row[key]):
                # a small difference of large numbers
                yield f"{row['disturbance']} {key} with feedforward x{gain:g}", told, assembled.motion(channel, output, gain), 5e-3


def poles_of_the_sampled_loop(result):
    """The closed feedback loop, and the paths that no loop goes through."""
    loop = system(result["sampled_loop"])
    closed = control.feedback(loop, control.ss([], [], [], [[1.0]], loop.dt), sign=-1)
    return np.max(np.abs(np.linalg.eigvals(closed.A)))


def synth(result):
    if result["design_plant"]:
        yield "order of the design plant", result["plant_order"], system(result["design_plant"]).nstates, 0.0
    for path in result["paths"]:
        order = len(path["system"]["A"]) if "system" in path else len(path["A"])
        yield f"order of {path['name']}", result["path_orders"][path["name"]], order, 0.0
    moduli = [abs(complex(*pole)) for pole in result["closed_loop_poles"]]
    yield "largest modulus of the poles", result["largest_pole_modulus"], max(moduli), SUMS
    yield "poles of the loop, broken and closed again", result["largest_pole_modulus"], max(
        [poles_of_the_sampled_loop(result)] + feedforward_moduli(result)), 1e-6
    yield from costs(result)
    beside = result.get("beside")
    if beside is None:
        return
    for row in beside["methods"]:
        yield from designs.method(row)
        if row["figures"]:
            mine = loop_figures(row["systems"])
            for key, told in row["figures"].items():
                yield f"{row['method']}: {key}", told, mine[key], MARGINS
    if beside["lowered"]:
        row = beside["lowered"]
        for which, systems in zip(("before", "after"), row["systems"]):
            mine = loop_figures(systems)
            for key, told in row[which].items():
                yield f"order lowered, {which}: {key}", told, mine[key], MARGINS
        change, _ = largest_singular_value(*(system(one) for one in row["closed_loops"]))
        yield "change of the closed loop", row["loop_change"], change, 1e-6
        plant_order = len(result["design_plant"]["A"])
        for told, one in zip(row["order"], row["closed_loops"]):
            order = system(one).nstates - plant_order
            yield "order of the feedback, lowered or not", told, order, 0.0
    if beside["total_cost"]:
        yield from total_cost(beside["total_cost"], result["weights"], beside["motions"])
    yield from designs.balance(beside, result["weights"])
    if beside["spillover"]:
        row = beside["spillover"]
        moduli = [abs(complex(*pole)) for pole in row["poles"]]
        yield "largest modulus on the structure with all its modes", row["largest_pole"], max(moduli, default=math.inf), SUMS
        if row.get("sampled_loop"):
            loop = system(row["sampled_loop"])
            closed = control.feedback(loop, control.ss([], [], [], [[1.0]], loop.dt), sign=-1)
            yield "the same by closing the loop", row["largest_pole"], float(np.max(np.abs(np.linalg.eigvals(closed.A)))), 1e-6


def feedforward_moduli(result):
    all_ = []
    for path in result["paths"]:
        if not path["name"].startswith("feedback"):
            one = path.get("system", path)
            if len(one["A"]):
                all_.append(float(np.max(np.abs(np.linalg.eigvals(np.array(one["A"]))))))
    return all_


def costs(result):
    """The largest difference of a cost as predicted and as achieved; the cost of the feedback, and of each feedforward by itself."""
    pairs = [(one["predicted"], one["achieved"]) for one in result["costs"] if None not in (one["predicted"], one["achieved"])]
    if pairs:
        yield "difference of costs", result["cost_difference"], max(abs(a - p) / abs(p) for p, a in pairs), SUMS


def first_design(found):
    """Margins and bandwidth of the loops on which a first design was judged."""
    if not found:
        return
    mine = [designs.margins(system(one)) for one in found["loops"]]
    yield "bandwidth", found["bandwidth_rad_s"], mine[0]["bandwidth_rad_s"], MARGINS
    for key in ("gain_margin_db", "phase_margin_deg", "max_sensitivity"):
        yield f"first design: {key}", found[key], mine[0][key], 1e-4
    worst = max(one["max_sensitivity"] for one in mine)
    yield "largest sensitivity with shifted modes", found["max_sensitivity_modes_shifted"], worst, 1e-4
    for row in found["limits"]:
        if row["over_reached"] is not None:
            yield f"{row['limit']}: over what was reached", row["over_reached"], row["bandwidth_rad_s"] / found["bandwidth_rad_s"], SUMS
        yield from limit_rows(found, row)
        yield from used_shares(found, row, mine[0], worst)
    yield "limit that decides", 0.0, float(deciding(found) != found["limited_by"]), 0.0


# The ceiling of the bandwidth over the sample rate, and what each fact that is not known leaves of it.
CEILING, CAUTION = 1.0 / 20.0, 0.7


def limit_rows(found, row):
    """What a limit of the bandwidth allows: by a formula, or as the crossover of the loop that shows it."""
    name = row["limit"]
    if name == "sample rate":
        ceiling = CEILING * 2.0 * math.pi / found["sample_period_s"] * CAUTION ** len(found["unknown"])
        yield f"{name}: bandwidth", row["bandwidth_rad_s"], ceiling, SUMS
    elif name == "what is asked for":
        yield f"{name}: bandwidth", row["bandwidth_rad_s"], found["asked_rad_s"], 0.0
    elif row["shown_by"]:
        mine = designs.margins(system(row["shown_by"]))
        yield f"{name}: bandwidth", row["bandwidth_rad_s"], mine["bandwidth_rad_s"], MARGINS
        if name.startswith("margins"):
            asked = found["required"]
            keeps = mine["gain_margin_db"] >= asked["gain_margin_db"] - 1e-3 and mine["phase_margin_deg"] >= asked["phase_margin_deg"] - 1e-3
            keeps = keeps and mine["max_sensitivity"] <= asked["max_sensitivity"] + 1e-3
            yield f"{name}: kept by the loop that shows it", 1.0, float(keeps), 0.0
    elif row["bandwidth_rad_s"] is not None:
        # no loop that was tried keeps the limit
        yield f"{name}: bandwidth", row["bandwidth_rad_s"], 0.0, 0.0
    if row["lifted_rad_s"] is not None:
        mine = designs.margins(system(row["lifted_shown_by"]))
        yield f"{name}: bandwidth without it", row["lifted_rad_s"], mine["bandwidth_rad_s"], MARGINS


# The largest sensitivity that the loop may have with shifted modes.
SHIFTED_MS = 2.0


def used_shares(found, row, loop, shifted):
    """The share of the margins, and of the sensitivity with shifted modes, that the loop uses up. Only the usual margins are in the result."""
    if row["limit"] == "resonance":
        yield "resonance: used", row["used"], shifted / SHIFTED_MS, 1e-4
    elif row["limit"].startswith("margins"):
        asked = found["required"]
        shares = [asked["gain_margin_db"] / loop["gain_margin_db"], asked["phase_margin_deg"] / loop["phase_margin_deg"], loop["max_sensitivity"] / asked["max_sensitivity"]]
        yield "margins: used at least", 1.0, float(row["used"] >= max(shares) - 1e-4), 0.0


def deciding(found):
    """The limit whose lifting alone raises the bandwidth most; what is stated where none does, which no single loop shows."""
    lifted = [row for row in found["limits"] if row["lifted_rad_s"] is not None]
    return max(lifted, key=lambda row: row["lifted_rad_s"])["limit"] if lifted else found["limited_by"]
