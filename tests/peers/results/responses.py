"""Systems of a JSON result as those of python-control, their responses, and searches over frequency."""

import math

import control
import numpy as np
import scipy.linalg


def system(result):
    """The three lines of the manual: a system of the result as one of python-control."""
    dt = result["sample_time_s"]
    return control.ss(result["A"], result["B"], result["C"], result["D"], dt)


def named(systems, name):
    return next(one for one in systems if one["name"] == name)


def at(sys_, rates, dt):
    """The response at rates in rad/s, an array of matrices; a thousand rates are solved at a time."""
    points = np.exp(1j * rates * dt) if dt else 1j * rates
    A, B, C, D = (np.array(matrix, dtype=complex) for matrix in (sys_.A, sys_.B, sys_.C, sys_.D))
    if not len(A):
        return np.repeat(D[None], len(points), axis=0)
    eye, parts = np.eye(len(A)), []
    for k in range(0, len(points), 1000):
        parts.append(C @ np.linalg.solve(points[k : k + 1000, None, None] * eye - A, B) + D)
    return np.concatenate(parts)


def swept(sys_, rates, dt):
    """The same, quicker where there are many rates: A becomes triangular once (Schur), then each rate takes a substitution. A response that is tiny beside the
    largest loses digits by it."""
    points = np.exp(1j * rates * dt) if dt else 1j * rates
    if not sys_.nstates:
        return np.repeat(np.array(sys_.D, dtype=complex)[None], len(points), axis=0)
    T, B, C = triangular(sys_)
    states = np.empty((len(T), B.shape[1], len(points)), dtype=complex)
    for i in reversed(range(len(T))):
        above = np.tensordot(T[i, i + 1 :], states[i + 1 :], axes=1)
        states[i] = (B[i][:, None] + above) / (points - T[i, i])
    return np.moveaxis(np.tensordot(C, states, axes=1), 2, 0) + sys_.D


def triangular(sys_):
    """The upper triangular A of a system with the B and C that belong to it, kept with the system."""
    if not hasattr(sys_, "kept_triangle"):
        T, Q = scipy.linalg.schur(sys_.A, output="complex")
        sys_.kept_triangle = T, Q.conj().T @ sys_.B, sys_.C @ Q
    return sys_.kept_triangle


def response_rows(sys_, responses, columns):
    """Stored responses of one output against those of a system: the place of each response's input among its inputs is in `columns`."""
    for one, column in zip(responses, columns):
        mine = at(sys_, 2.0 * math.pi * np.array(one["frequency_hz"]), sys_.dt)[:, 0, column]
        yield from same_response(one, mine)


def same_response(one, mine, rounding=0.0):
    """The largest difference of a response beyond the rounding of terms that cancel, relative to its size."""
    told = np.array(one["real"]) + 1j * np.array(one["imaginary"])
    # where a response passes through nothing, its size there is that of its neighbours
    size = np.maximum(np.abs(told), 1e-12 * np.max(np.abs(told)))
    yield f"response, {one['name']}", 1.0, 1.0 + float(np.max(np.maximum(np.abs(mine - told) - rounding, 0.0) / np.maximum(size, 1e-300))), 1e-6


def bisect(function, low, high):
    sign = function(low) > 0
    for _ in range(200):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if (function(middle) > 0) == sign else (low, middle)
    return math.sqrt(low * high)


def golden(function, low, high):
    """The place of the largest value between two rates."""
    ratio = (math.sqrt(5.0) - 1.0) / 2.0
    low, high = math.log(low), math.log(high)
    for _ in range(120):
        a, b = high - ratio * (high - low), low + ratio * (high - low)
        if function(math.exp(a)) > function(math.exp(b)):
            high = b
        else:
            low = a
    return math.exp(0.5 * (low + high))


def crossings(rates, values, function):
    found = []
    for k in range(len(rates) - 1):
        if values[k] == 0.0 or values[k] * values[k + 1] < 0.0:
            found.append(bisect(function, rates[k], rates[k + 1]))
    return found


def largest(rates, values, function):
    k = int(np.argmax(values))
    place = golden(function, rates[max(k - 1, 0)], rates[min(k + 1, len(rates) - 1)])
    return max(function(place), values[k])


def decibels(ratio):
    return 20.0 * math.log10(ratio) if ratio > 0.0 else -math.inf


def figures_of_loop(broken, dt):
    nyquist = math.pi / dt
    rates = np.geomspace(1e-3, nyquist * (1 - 1e-9), 40000)
    one = lambda rate: swept(broken, np.array([rate]), dt)[0, 0, 0]
    values = swept(broken, rates, dt)[:, 0, 0]
    modulus = crossings(rates, np.abs(values) - 1.0, lambda r: abs(one(r)) - 1.0)
    # only crossings of the negative real axis count
    real = [r for r in crossings(rates, values.imag, lambda r: one(r).imag) if one(r).real < 0.0]
    # with the plant's own input broken, 1 + L = 0 at the stability limit
    gains = [-20.0 * math.log10(abs(one(r))) for r in real]
    gains += [-20.0 * math.log10(abs(v)) for v in [at(broken, np.array([nyquist]), dt)[0, 0, 0].real] if v < 0.0]
    phases = [(math.degrees(np.angle(-one(r))), r) for r in modulus]
    delays = [(math.radians(deg) % (2.0 * math.pi)) / rate for deg, rate in phases]
    sensitivity = lambda r: abs(1.0 / (1.0 + one(r)))
    complementary = lambda r: abs(one(r) / (1.0 + one(r)))
    skew = lambda r: abs(0.5 * (1.0 - one(r)) / (1.0 + one(r)))
    return {
        "gain_margin_db": min([g for g in gains if g > 0.0], default=math.inf),
        "gain_reduction_margin_db": min([-g for g in gains if g < 0.0], default=math.inf),
        "phase_margin_deg": min([abs(deg) for deg, _ in phases], default=math.inf),
        "delay_margin_s": min(delays, default=math.inf),
        "disk_margin": 1.0 / largest(rates, np.abs(0.5 * (1 - values) / (1 + values)), skew),
        "max_sensitivity": largest(rates, np.abs(1 / (1 + values)), sensitivity),
        "max_complementary_sensitivity": largest(rates, np.abs(values / (1 + values)), complementary),
        "crossover_hz": max(modulus, default=0.0) / (2.0 * math.pi),
    }
