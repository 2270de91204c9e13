"""Checks what `counterpoise verify` proves, from its JSON result alone: bounds of the structured singular value by their scalings and by the
perturbations that were found, sector arguments by their multipliers, motions on the simulator by the rates that were recorded of them.

Each function yields rows (name, value in the result, value computed here, relative tolerance).
"""

import math

import control
import numpy as np

from responses import at, named, system

# Scalings prove a bound to a part in ten thousand of its square.
PROVED = 1e-4
# A pole at the limit of stability is found by bisection.
LIMIT = 1e-6
# An upper bound is a statement: it holds (0) or not (1).
HOLDS = 0.0
# A perturbation makes I - M Delta / lower singular to the residual of its iteration.
SINGULAR = 1e-3
# The hub gyroscope, the tachometer and the resolver among all readings.
FED_BACK = (1, 4, 5)


class Pulled:
    """The response M from what deviations add to what they are proportional to."""

    def __init__(self, result):
        self.G = system(named(result["systems"], "mechanism"))
        self.P = system(named(result["systems"], "sampled_mechanism"))
        self.K = system(named(result["systems"], "controller"))
        self.dt = named(result["systems"], "controller")["sample_time_s"]
        self.blocks = result["blocks"]
        self.errors = result["errors"]
        self.control_delay = result["control_delay_samples"]
        self.late = np.array(result["reading_delays_samples"])

    def pieces(self, rate):
        """(through the mechanism alone, by the control, to the control) at one rate."""
        m = self.G.ninputs - 1
        G = at(self.G, np.array([rate]), 0.0)[0]
        P = at(self.P, np.array([rate]), self.dt)[0][:, 0]
        K = at(self.K, np.array([rate]), self.dt)[0][0]
        x = 1j * rate * self.dt
        held = (1.0 - np.exp(-x)) / x * np.exp(-x * self.control_delay)
        read = np.zeros((len(K), m), dtype=complex)
        for row, reading in enumerate(FED_BACK):
            read[reading] = G[m + row, :m] * np.exp(-x * self.late[reading])
        return G[:m, :m], G[:m, m] * held, (K @ read) / (1.0 - K @ P), (G, P, K, read, held)

    def M(self, rate):
        direct, control, reading, (G, P, K, read, held) = self.pieces(rate)
        M = direct + np.outer(control, reading)
        kinds = [k for k in (0, 1) if self.errors[k] > 0.0]
        if not kinds:
            return M
        m, opened = len(direct), 1.0 / (1.0 - K @ P)
        wide = np.zeros((m + len(kinds), m + len(kinds)), dtype=complex)
        wide[:m, :m] = M
        computed = {0: opened * (K @ P), 1: opened * K[1]}
        for column, kind in enumerate(kinds):
            applied = computed[kind] + (1.0 if kind == 0 else 0.0)
            wide[:m, m + column] = control * applied
            for row, to in enumerate(kinds):
                felt = computed[kind] if to == 0 else P[1] * applied
                wide[m + row, m + column] = felt * self.errors[to]
        for row, to in enumerate(kinds):
            felt = reading if to == 0 else P[1] * reading + read[1]
            wide[m + row, :m] = felt * self.errors[to]
        return wide


def diagonal(blocks):
    pieces = [np.array(block)[..., 0] + 1j * np.array(block)[..., 1] for block in blocks]
    size = sum(len(piece) for piece in pieces)
    whole, k = np.zeros((size, size), dtype=complex), 0
    for piece in pieces:
        whole[k : k + len(piece), k : k + len(piece)] = piece
        k += len(piece)
    return whole


def is_positive(X):
    try:
        np.linalg.cholesky(X)
        return True
    except np.linalg.LinAlgError:
        return False


def least_proved(M, D, G):
    """The least bound of mu that a pair of scalings proves: the root of the largest eigenvalue of D^-1/2 (M* D M + j (G M - M* G)) D^-1/2."""
    root = np.linalg.inv(np.linalg.cholesky(D))
    X = M.conj().T @ D @ M + 1j * (G @ M - M.conj().T @ G)
    return math.sqrt(max(float(np.linalg.eigvalsh(root @ (X + X.conj().T) / 2.0 @ root.conj().T)[-1]), 0.0))


def bounds(one, name):
    """The upper bound at each frequency by its scalings, the lower one by its perturbation."""
    pulled = Pulled(one["pulled"])
    for bound in one["bounds"]:
        place = f"{name}, {bound['frequency_hz']:.4g} Hz"
        M = pulled.M(2.0 * math.pi * bound["frequency_hz"])
        D, G = diagonal(bound["D"]), diagonal(bound["G"])
        complex_blocks = [k for k, count in enumerate(pulled.blocks) if count == 0]
        free = all(np.all(np.array(bound["G"][k]) == 0.0) for k in complex_blocks)
        yield f"scalings have their structure, {place}", 0.0, 0.0 if is_positive(D) and free else 1.0, HOLDS
        proved = least_proved(M, D, G)
        # the search keeps no bound below its floor, though the scalings prove less
        yield f"upper bound, {place}", 0.0, 0.0 if proved <= bound["upper"] * (1.0 + PROVED) else 1.0, HOLDS
        if bound["perturbation"]:
            delta = [complex(*q) for q in bound["perturbation"]]
            sizes = [abs(q) for q in delta]
            repeated = np.diag(np.repeat(delta, [max(count, 1) for count in pulled.blocks]))
            size = np.linalg.norm(M, 2)
            off = np.linalg.svd(np.eye(len(M)) - M @ repeated / bound["lower"])[1][-1] / (1.0 + size / bound["lower"])
            right = max(sizes) <= 1.0 + 1e-9 and all(abs(q.imag) <= 1e-12 for q, count in zip(delta, pulled.blocks) if count)
            yield f"perturbation of size 1, {place}", 0.0, 0.0 if right else 1.0, HOLDS
            yield f"lower bound, {place}", 1.0, 1.0 + off, SINGULAR


def nearest(one, name):
    """The mechanism at the limit of stability: its factors by their ranges, its pole by closing the loop."""
    found, ranges = one["nearest"], {row["key"]: row for row in one["ranges"]}
    for row, delta in zip(found["factors"], found["deltas"]):
        r = ranges[row["key"]]
        d = found["scale"] * delta
        lowest = -1.0 / r["a"] if r["a"] > 0.0 else -math.inf
        highest = -1.0 / r["b"] if r["b"] < 0.0 else math.inf
        if lowest < d < highest and (d - lowest) > 1e-2 * abs(lowest):
            yield f"factor of {row['key']}, {name}", row["factor"], r["centre"] * (1.0 + r["a"] * d) / (1.0 + r["b"] * d), 1e-9
    for told, phase, size in zip(found["errors"], found["phases"], one["errors"]):
        mine = found["scale"] * size * complex(*phase)
        yield f"error, {name}", 1.0, 1.0 + abs(complex(*told) - mine), 1e-9
    plant, K = (system(named(found["systems"], part)) for part in ("sampled_plant", "controller"))
    n, readings = plant.nstates, K.ninputs
    B, C, D = plant.B[:, -1:], plant.C[-readings:, :], plant.D[-readings:, -1:]
    gain = np.linalg.inv(np.eye(1) - K.D @ D)
    A = np.block([
        [plant.A + B @ gain @ K.D @ C, B @ gain @ K.C],
        [K.B @ (C + D @ gain @ K.D @ C), K.A + K.B @ D @ gain @ K.C],
    ])
    poles = np.linalg.eigvals(A)
    told = complex(*found["pole"])
    nearest_ = poles[np.argmin(np.abs(poles - told))]
    yield f"pole at the limit, {name}", 1.0, 1.0 + abs(nearest_ - told), 1e-6
    yield f"modulus of that pole, {name}", abs(told), 1.0, LIMIT
    beyond = [p for p in poles if abs(p) > 1.0 + LIMIT and abs(p - 1.0) > 1e-5]
    yield f"poles beyond it, {name}", 0.0, float(len(beyond)), HOLDS
    del n


def multiplier(terms, joint, rate, reference):
    s, N, R = 1j * rate, 0.0, 0.0
    for term in (t for t in terms if t["joint"] == joint):
        kind, value, weight = term["kind"], term["value"], term["weight"]
        if kind == "constant":
            N += weight
        elif kind == "derivative":
            N += weight * value * s / reference
        elif kind == "kernel":
            N += -weight * term["sign"] / (1.0 + s / value)
        elif kind == "stiffness":
            N += -weight * s / reference
            R += weight * 2.0 * rate**2 / (reference * value)
    return N, R


# Points of the grid on which a condition is checked, refined where it varies by more than its least value.
GRID = 4000


class Condition:
    """N H + (N H)^* + R over the frequency."""

    def __init__(self, result):
        self.pulled = Pulled(result["pulled"])
        self.units, self.terms, self.reference = np.array(result["units"]), result["terms"], result["reference_rad_s"]

    def at(self, rate):
        direct, control, reading, _ = self.pulled.pieces(rate)
        direct, control, reading = direct * np.outer(self.units, self.units), control * self.units, reading * self.units
        N, R = zip(*(multiplier(self.terms, joint, rate, self.reference) for joint in (0, 1)))
        N = np.diag(np.array(N, dtype=complex))
        passed = N @ (direct + np.outer(control, reading))
        return passed + passed.conj().T + np.diag(R), N @ control, reading.conj()

    def least(self, rate):
        values = np.linalg.eigvalsh(self.at(rate)[0])
        return float(values[0] / max(abs(values)))

    def aliases(self, rate, count=20):
        nyquist = math.pi / self.pulled.dt
        rows = []
        for k in range(-count, count + 1):
            Q, b, r = self.at(abs(rate + 2.0 * nyquist * k))
            weight = float(count) if abs(k) == count else 1.0
            rows.append([weight * float((x.conj() @ np.linalg.solve(Q, x)).real) for x in (b, r)])
        rows = np.array(rows)
        # the term of the tone itself is far larger than those of its aliases, so that a difference of sums would be rounding
        return 4.0 * sum(row[0] * float(np.sum(np.delete(rows[:, 1], k))) for k, row in enumerate(rows))


def sector(found, name):
    if found.get("multiplier") is None:
        yield f"sector argument holds, {name}", float(found["holds"]), 0.0, HOLDS
        return
    condition = Condition(found["multiplier"])
    terms = found["multiplier"]["terms"]
    fair = all(t["weight"] >= 0.0 for t in terms)
    for joint in (0, 1):
        kernels = sum(t["weight"] for t in terms if t["joint"] == joint and t["kind"] == "kernel")
        constant = sum(t["weight"] for t in terms if t["joint"] == joint and t["kind"] == "constant")
        fair = fair and kernels <= constant * (1.0 + 1e-6) + 1e-9
    yield f"the multiplier is one that the law allows, {name}", 0.0, 0.0 if fair else 1.0, HOLDS
    low, high = (2.0 * math.pi * hz for hz in found["range_hz"])
    rates = list(np.geomspace(low, high, GRID))
    values = [condition.least(rate) for rate in rates]
    yield f"the condition holds at {GRID} frequencies, {name}", 0.0, 0.0 if min(values) > 0.0 else 1.0, HOLDS
    # what the program states is a lower bound over intervals, so it is not above what a point shows
    yield f"least eigenvalue, {name}", 0.0, 0.0 if found["least"] <= min(values) * (1.0 + 1e-9) else 1.0, HOLDS
    here = condition.least(2.0 * math.pi * found["frequency_hz"])
    yield f"least eigenvalue where it is least, {name}", 0.0, 0.0 if here >= found["least"] else 1.0, HOLDS
    worst = max(condition.aliases(rate) for rate in np.geomspace(low, math.pi / condition.pulled.dt, 160))
    yield f"share through aliases, {name}", found["aliases"], worst, 1e-5


NO_RATE = "its rate is not part of the result: ask for --histories"
# Crossings count that leave this share of the range about the mean.
BAND = 0.25


def cycle(rates, dt):
    """Half the range of a rate."""
    return 0.5 * (max(rates) - min(rates))


def orbits(case, dt, floor):
    """Motions by the last stretch of the rate: amplitude, or that it faded."""
    for orbit in case["orbits"]:
        name = f"motion from {orbit['start_rad_s']:.3e} rad/s, {case['name']}"
        rates = np.array(orbit.get("rates_rad_s", []))
        if orbit["amplitude_rad_s"] is None:
            yield f"{name}: diverged before a stretch ended", 0.0, float(len(rates)), HOLDS
        elif len(rates) == 0:
            yield f"{name}", orbit["amplitude_rad_s"], NO_RATE
        elif orbit["amplitude_rad_s"] > 0.0:
            yield f"amplitude, {name}", orbit["amplitude_rad_s"], cycle(rates, dt), 1e-12
            yield f"frequency, {name}", orbit["frequency_hz"], frequency_of(rates, dt), 1e-6
        else:
            left = float(np.sqrt(np.mean(rates**2)))
            yield f"it faded or fades: rate left over two noise floors, {name}", 0.0, 0.0 if left < 2.0 * floor else 1.0, HOLDS


def frequency(rates, dt):
    """The frequency with which a series repeats itself: the first peak of its correlation with itself, by a parabola."""
    block = -(-len(rates) // 4000)
    x = rates[: len(rates) // block * block].reshape(-1, block).mean(axis=1)
    x, count = x - np.mean(x), len(x)
    sums = np.concatenate([[0.0], np.cumsum(x**2)])
    lags = np.arange(count // 2 + 1)
    products = np.correlate(x, x, "full")[count - 1 : count + count // 2]
    r = products / np.sqrt(sums[count - lags] * (sums[-1] - sums[lags]))
    below = np.nonzero(r <= 0.0)[0]
    if not len(below):
        return math.nan
    peaks = [k for k in range(max(below[0], 1), len(r) - 1) if r[k] >= r[k - 1] and r[k] >= r[k + 1]]
    most = max([0.6] + [r[k] for k in peaks])
    lag = next((k for k in peaks if r[k] >= max(0.9 * most, 0.6)), None)
    if lag is None:
        return math.nan
    bend = r[lag - 1] - 2.0 * r[lag] + r[lag + 1]
    return 1.0 / ((lag + (0.5 * (r[lag - 1] - r[lag + 1]) / bend if bend < 0.0 else 0.0)) * block * dt)


def crossed(rates, dt):
    """The frequency of upward crossings of a band of a quarter of the range about the mean."""
    middle, band = np.mean(rates), BAND * (np.max(rates) - np.min(rates))
    above, count, first, last = True, 0, 0, 0
    for k, rate in enumerate(rates):
        if not above and rate > middle + band:
            above, count, last = True, count + 1, k
            first = k if count == 1 else first
        elif rate < middle - band:
            above = False
    return (count - 1) / ((last - first) * dt) if count > 1 else 0.0


def frequency_of(rates, dt):
    by_crossings, repeats = crossed(rates, dt), frequency(rates, dt)
    return repeats if by_crossings > 0.0 and repeats < 0.9 * by_crossings else by_crossings


def runs(case, dt):
    """The runs with noise by their rates, the noise floor, and which motion the limit cycle is."""
    name = case["name"]
    # a loop of position, torque or current has a floor in its own unit, with what rounding keeps up
    noise = (case["reading_noise_rad_s"], case["reading_step_rad_s"] / math.sqrt(12.0), case.get("rounding", 0.0))
    floor = math.hypot(*noise)
    yield f"noise floor, {name}", case["noise_floor_rad_s"], floor, 1e-12
    rest, moved = (np.array(case.get(key, [])) for key in ("rest_rates_rad_s", "motion_rates_rad_s"))
    spread = lambda part: float(np.std(part))
    if len(rest):
        yield f"rate at rest, {name}", case["rest_rms_rad_s"], spread(rest), 1e-10
    elif case["rest_rms_rad_s"] is not None:
        yield f"rate at rest, {name}", case["rest_rms_rad_s"], NO_RATE
    if len(moved):
        half = len(moved) // 2
        first, second = spread(moved[:half]), spread(moved[half:])
        # a balanced direct drive stands still under heave and pitch, and what stands still has no growth
        if first > 0.0:
            yield f"growth in motion, {name}", case["motion_growth"], second / first, 1e-10
        elif case["motion_growth"] is not None:
            yield f"growth in motion, {name}", case["motion_growth"], math.inf, 0.0
    elif case["motion_growth"] is not None:
        yield f"growth in motion, {name}", case["motion_growth"], NO_RATE
    cycle_ = case["limit_cycle"]
    if cycle_ is None:
        return
    known = [(orbit["amplitude_rad_s"], orbit["frequency_hz"]) for orbit in case["orbits"]]
    if len(rest):
        late = rest[len(rest) // 2 :]
        known.append((cycle(late, dt), frequency_of(late, dt)))
    near = min(known, key=lambda pair: abs((pair[0] or math.inf) - cycle_["amplitude_rad_s"]))
    yield f"amplitude of the limit cycle, {name}", cycle_["amplitude_rad_s"], near[0], 1e-10
    yield f"frequency of the limit cycle, {name}", cycle_["frequency_hz"], near[1], 1e-6


# The describing functions are sampled 2000 times a period in the program, and 400 times for the gap.
SAMPLED = 2e-3
# Frequency and ratio of motions are those of the last of a few rounds that converge on them.
CONVERGED = 1e-2
# Growth, 1/s, above which a motion counts as growing.
STEADY_GROWTH = 0.02
# Share of the third harmonic up to which a loop counts as a low-pass.
THIRD_HARMONIC = 0.5
# Relative difference of frequencies up to which a prediction is consistent.
FREQUENCY_ERROR = 0.1
NO_TORQUE = "the torque of a period is not part of the result: ask for --histories"
NO_OBSERVER = "the law of the observer is not part of the result: give the controller.json that design and export write"
OTHER_LAW = "the observer follows another law than Dahl's with a constant level"
# Periods in which a friction observer settles, and the fewest and most samples of a period.
SETTLED, PERIOD = 3, (8, 4000)
# A pole nearer than this to 1 belongs to a constant that nothing changes.
NEUTRAL = 1e-5
POLES = 1e-9
# Frequency is that of one of the poles that are largest to this.
SAME_SIZE = 1e-9


def regime_poles(regime, loop, name):
    """The closed loop's largest pole, its growth and its frequency. Poles at 1 of constants that nothing changes are left out, and counted."""
    closed = loop.A - loop.B @ np.linalg.solve(np.eye(loop.ninputs) + loop.D, loop.C)
    poles = np.linalg.eigvals(closed)
    moving = poles[np.abs(poles - 1.0) > NEUTRAL]
    radius = float(np.max(np.abs(moving), initial=0.0))
    yield f"pole modulus, {name}", regime["pole_radius"], radius, POLES
    yield f"growth, {name}", regime["growth_per_s"], math.log(radius) / loop.dt if radius else -math.inf, POLES
    largest_ = moving[np.abs(moving) > radius * (1.0 - SAME_SIZE)]
    # of poles of one size, any may be the one that is told
    hertz = np.abs(np.angle(largest_)) / (2.0 * math.pi * loop.dt)
    told = regime["frequency_hz"]
    yield f"frequency of that pole, {name}", told, float(hertz[np.argmin(np.abs(hertz - told))]), LIMIT
    if radius >= 1.0:
        # an unstable loop has no margin, and no largest sensitivity
        yield f"gain margin of an unstable loop, {name}", regime["gain_margin_db"] or 0.0, 0.0, HOLDS
        yield f"sensitivity of an unstable loop, {name}", float(regime["max_sensitivity"] is None), 1.0, HOLDS


def constants(regime):
    """How many poles of a regime's closed loop belong to constants."""
    loop = system(regime["sampled_loop"])
    poles = np.linalg.eigvals(loop.A - loop.B @ np.linalg.solve(np.eye(loop.ninputs) + loop.D, loop.C))
    return int(np.sum(np.abs(poles - 1.0) <= NEUTRAL))


def severity(regime):
    """What orders regimes: the largest sensitivity, and beyond stability the growth."""
    if regime["pole_radius"] >= 1.0:
        return 1, regime["growth_per_s"]
    return 0, math.inf if regime["max_sensitivity"] is None else regime["max_sensitivity"]


def headline(certificate):
    """The figures of the certificate that requirements can be stated on: those of the worst regime, and the largest limit cycle."""
    # no control reaches the hub while the teeth are open
    judged = [regime for case in certificate["cases"] for regime in case["regimes"] if regime["regime"] != "teeth_open"]
    size = {"stable": lambda case: 0.0, "limit cycle": lambda case: case["limit_cycle"]["amplitude_rad_s"], "unstable": lambda case: math.inf}
    out = {}
    if all(case["stability"] in size for case in certificate["cases"]):
        out["limit_cycle_peak_rad_s"] = max((size[case["stability"]](case) for case in certificate["cases"]), default=0.0)
    if judged:
        worst = max(judged, key=severity)
        out.update({f"worst_regime_{key}": worst[key] for key in ("gain_margin_db", "max_sensitivity")})
    return out


def first_harmonic(torque, amplitude, rate):
    """Stiffness and damping of what acts at x = A sin(w t)."""
    phase = 2.0 * math.pi * np.arange(1, len(torque) + 1) / len(torque)
    sine, cosine = (2.0 * float(np.mean(torque * wave)) / amplitude for wave in (np.sin(phase), np.cos(phase)))
    return sine, cosine / rate


def dahl(coulomb, stiffness, amplitude, rate):
    """The same of Dahl's law: F = -+F_c + (F_0 +- F_c) exp(-+sigma x / F_c) on each branch, F_0 from the symmetry of the loop."""
    a = stiffness * amplitude / coulomb
    turn = coulomb * math.tanh(a)
    phase = np.linspace(-math.pi / 2.0, math.pi / 2.0, 20001)
    x = amplitude * np.sin(phase)
    rising = coulomb - (coulomb + turn) * np.exp(-stiffness * (x + amplitude) / coulomb)
    # the falling half is the rising one mirrored: its harmonics are the same
    step = phase[1] - phase[0]
    whole = lambda values: float(np.sum((values[1:] + values[:-1]) * 0.5) * step)
    return 2.0 / (math.pi * amplitude) * whole(rising * np.sin(phase)), 2.0 / (math.pi * amplitude) * whole(rising * np.cos(phase)) / rate


def observer(law, rate_rad_s, rate, dt):
    """The first harmonic of a friction observer's volts over that of the rate it follows, as (direct, integral) of direct + integral T z / (z - 1).

    The equation is the manual's: F[k+1] = (F[k] + sigma T w) / (1 + sigma T |w| / g)."""
    count = min(max(round(2.0 * math.pi / (rate * dt)), PERIOD[0]), PERIOD[1])
    turn = np.exp(2j * math.pi * np.arange(count) / count)
    step = law["rest_stiffness_nm_rad"] * dt * rate_rad_s * turn.real
    torque, torques = 0.0, []
    for moved in np.tile(step, 2 * SETTLED):
        torque = (torque + moved) / (1.0 + abs(moved) / law["coulomb_nm"])
        torques.append(torque)
    settled = np.array(torques[SETTLED * count :]) * law["volts_per_nm"]
    gain = 2.0 / rate_rad_s * np.mean(settled * np.tile(turn.conj(), SETTLED))
    integrator = dt * turn[1] / (turn[1] - 1.0)
    integral = gain.imag / integrator.imag
    return gain.real - integral * integrator.real, integral


def observers(one, exported, dt, name):
    """The describing functions of friction observers by the laws in the exported controller."""
    laws = [law for law in (exported or {}).get("observers", []) if law]
    for k, told in enumerate(one["observers"]):
        place = f"describing function of friction observer {k + 1}, {name}"
        size = math.hypot(told["direct_v_s_rad"], told["integral_v_rad"])
        if len(laws) != len(one["observers"]):
            yield place, size, NO_OBSERVER
        elif laws[k]["law"]["kind"] != "dahl" or laws[k]["level"] or exported.get("level_learning"):
            yield place, size, OTHER_LAW
        else:
            felt = one["amplitude_rad_s"] * (one["motor_over_hub"] if laws[k]["rate"] == "motor_rate_rad_s" else 1.0)
            loop = laws[k]["rate"] != "demand_rad_s"
            direct, integral = observer(laws[k], felt, 2.0 * math.pi * one["frequency_hz"], dt) if loop else (0.0, 0.0)
            yield f"{place}, direct", told["direct_v_s_rad"], direct, POLES
            yield f"{place}, integral", told["integral_v_rad"], integral, POLES


def gap(mesh):
    """The describing function of a dead zone that is pressed to one side, by the times at which its edges are passed."""
    A, pressed, width = mesh["wind_up_rad"], mesh["pressed_rad"], mesh["gap_rad"]
    if width == 0.0 or A <= pressed:
        return 1.0
    inside = lambda level: math.acos(min(max(level / A, -1.0), 1.0))
    # about x = A cos(p): touching while x > -pressed, and on the other flank while x < -pressed - gap
    near, far = inside(-pressed), inside(-pressed - width)
    part = lambda low, high, shift: 0.5 * A * ((high - low) + 0.5 * (math.sin(2.0 * high) - math.sin(2.0 * low))) + shift * (math.sin(high) - math.sin(low))
    return max(2.0 / (math.pi * A) * (part(0.0, near, pressed) + part(far, math.pi, pressed + width)), 1e-6)


def closed_by_friction(free, joints, rates):
    """Responses from the control to all outputs with the impedances of the joints put in; free: inputs control, torques on motor and hub."""
    G = at(free["system"], rates, 0.0)
    out = []
    for k, rate in enumerate(rates):
        s = 1j * rate
        to_rate = np.array([G[k][2], G[k][0] * (s if free["is_position"] else 1.0)])
        Z = np.diag([joint["damping_nm_s_rad"] + joint["stiffness_nm_rad"] / s for joint in joints])
        torques = -np.linalg.solve(np.eye(2) + Z @ to_rate[:, 1:], Z @ to_rate[:, 0])
        out.append(G[k][:, 0] + G[k][:, 1:] @ torques)
    return np.array(out)


def balance(one, verify, name):
    """A loop with its describing functions: the functions, the mechanism with them, its sampling, and the growth of its poles."""
    rate = 2.0 * math.pi * one["frequency_hz"]
    swing = one["amplitude_rad_s"] / rate
    for joint, expected in zip(one["joints"], (swing * one["motor_over_hub"], swing)):
        place = f"{joint['joint']}, {name}"
        yield f"amplitude of the joint, {place}", joint["amplitude_rad"], expected, 1e-12
        told = (joint["stiffness_nm_rad"], joint["damping_nm_s_rad"])
        size = math.hypot(told[0], told[1] * rate)
        if joint.get("torque_nm"):
            mine = first_harmonic(np.array(joint["torque_nm"]), joint["amplitude_rad"], rate)
            yield f"describing function, {place}", 1.0, 1.0 + math.hypot(mine[0] - told[0], (mine[1] - told[1]) * rate) / (size or 1.0), 1e-9
        else:
            yield f"describing function, {place}", size, NO_TORQUE
        if joint["dahl_coulomb_nm"]:
            mine = dahl(joint["dahl_coulomb_nm"], joint["dahl_stiffness_nm_rad"], joint["amplitude_rad"], rate)
            yield f"describing function of Dahl's law, {place}", 1.0, 1.0 + math.hypot(mine[0] - told[0], (mine[1] - told[1]) * rate) / size, SAMPLED
    yield f"share of the gear's stiffness, {name}", one["mesh"]["share"], gap(one["mesh"]), SAMPLED
    yield from mechanism_of(one, verify, name)
    pole, dt = pole_of(one)
    yield f"growth, {name}", 1.0, 1.0 + abs(math.log(abs(pole)) / dt - one["growth_per_s"]), 1e-4


def pole_of(one):
    """The least stable pole of a balance: oscillating, or real and growing."""
    P, K = (system(named(one["systems"], part)) for part in ("sampled_mechanism", "controller"))
    inner = np.linalg.inv(np.eye(1) - K.D @ P.D)
    A = np.block([
        [P.A + P.B @ inner @ K.D @ P.C, P.B @ inner @ K.C],
        [K.B @ (P.C + P.D @ inner @ K.D @ P.C), K.A + K.B @ P.D @ inner @ K.C],
    ])
    poles = np.linalg.eigvals(A)
    lively = [p for p in poles if p.imag > 0.0 or (p.imag == 0.0 and p.real > 1.0)]
    return max((p for p in lively if abs(p - 1.0) > 1e-5), key=abs), P.dt


def frequency_error(one):
    pole, dt = pole_of(one)
    rate = abs(np.angle(pole)) / dt if pole.imag else abs(math.log(abs(pole.real))) / dt
    return abs(rate / (2.0 * math.pi * one["frequency_hz"]) - 1.0)


def mechanism_of(one, verify, name):
    rate = 2.0 * math.pi * one["frequency_hz"]
    free, whole, P = (named(one["systems"], part) for part in ("mechanism_without_friction", "mechanism", "sampled_mechanism"))
    hub = free["outputs"][0]["name"]
    rates = np.geomspace(0.1 * rate, min(20.0 * rate, 2.0 / P["sample_time_s"]), 40)
    theirs = at(system(whole), rates, 0.0)[:, :, 0]
    if hub != "effort":
        mine = closed_by_friction({"system": system(free), "is_position": hub == "hub_rad"}, one["joints"], rates)
        off = float(np.max(np.abs(mine - theirs) / np.maximum(np.max(np.abs(theirs), axis=0), 1e-300)))
        yield f"mechanism with its describing functions, {name}", 1.0, 1.0 + off, 1e-7
        at_rate = at(system(whole), np.array([rate]), 0.0)[0][:, 0]
        moved = abs(at_rate[2]) / (abs(at_rate[0]) * (rate if hub == "hub_rad" else 1.0))
        # the ratio is that of the round before: where the rounds do not converge, the prediction says that it is not reliable
        allowed = max(CONVERGED, frequency_error(one))
        yield f"motion of the motor over that of the hub, {name}", one["motor_over_hub"], moved, allowed
    held = control.sample_system(control.ss(system(whole).A, system(whole).B, system(whole).C[4:], system(whole).D[4:]), P["sample_time_s"], method="zoh")
    inside = rates[rates < 0.9 * math.pi / P["sample_time_s"]]
    late = np.array(verify["reading_delays_samples"])[1:] + verify["control_delay_samples"]
    mine = at(held, inside, P["sample_time_s"])[:, :, 0] * np.exp(-1j * np.outer(inside, late) * P["sample_time_s"])
    theirs = at(system(P), inside, P["sample_time_s"])[:, 1:, 0]
    off = float(np.max(np.abs(mine - theirs) / np.maximum(np.max(np.abs(theirs), axis=0), 1e-300)))
    yield f"sampled mechanism, {name}", 1.0, 1.0 + off, 1e-6


def predictions(case, verify):
    """Limit cycles by harmonic balance: between an amplitude that grows and one that fades, each by its describing functions."""
    for cycle_ in case["predicted"]:
        name = f"predicted limit cycle of {1e3 * cycle_['amplitude_rad_s']:.4g} mrad/s, {case['name']}"
        sides = cycle_["balances"]
        for side, words in zip(sides, ("below", "above")):
            yield from balance(side, verify, f"{words}, {name}")
            dt = named(side["systems"], "controller")["sample_time_s"]
            yield from observers(side, verify.get("exported_controller"), dt, f"{words}, {name}")
        if len(sides) < 2:
            continue
        below, above = sides
        errors = [frequency_error(side) for side in sides]
        # with parted teeth the amplitude is that of the round after the loop's
        yield f"amplitude, {name}", cycle_["amplitude_rad_s"], below["amplitude_rad_s"], max(CONVERGED, errors[0])
        yield f"frequency, {name}", cycle_["frequency_hz"], below["frequency_hz"], max(CONVERGED, errors[0])
        changes = below["growth_per_s"] > STEADY_GROWTH >= above["growth_per_s"]
        error = max(errors) if changes else math.inf
        told = math.inf if cycle_["frequency_error"] is None else cycle_["frequency_error"]
        yield f"frequency of the describing functions against the pole's, {name}", told, error, 1e-3
        P, K = (system(named(below["systems"], part)) for part in ("sampled_mechanism", "controller"))
        rate = 2.0 * math.pi * cycle_["frequency_hz"]
        third = 0.0
        if 3.0 * rate * P.dt < math.pi:
            first, third = (abs((at(K, np.array([w]), P.dt)[0] @ at(P, np.array([w]), P.dt)[0])[0, 0]) for w in (rate, 3.0 * rate))
            third /= first
        yield f"third harmonic, {name}", cycle_["third_harmonic"], third, max(CONVERGED, errors[0])
        yield f"whether the loop is a low-pass, {name}", float(cycle_["reliable"]), float(cycle_["third_harmonic"] <= THIRD_HARMONIC and error <= FREQUENCY_ERROR), HOLDS
