"""Odd calls of the numerical core: whatever comes in, an answer without NaN or a `NumericalError` that says why comes out.

    python python/tests/test_odd_calls.py --first 0 --count 20000     # the long run
"""

import argparse
import collections
import warnings

import control
import numpy as np
import pytest

import counterpoise as cp

SIZES = (0, 1, 1, 2, 2, 3, 5)


def entries(rng, rows, columns):
    """A matrix of some size and structure."""
    M = rng.standard_normal((rows, columns))
    kind = rng.integers(0, 12)
    if kind == 0:
        M = np.round(2 * M)
    elif kind == 1:
        M *= 10.0 ** rng.integers(-300, 300)
    elif kind == 2:
        M *= 10.0 ** rng.integers(-12, 13, (rows, columns))
    elif kind == 3:
        M = np.where(rng.random((rows, columns)) < 0.6, 0.0, M)
    elif kind == 4:
        M = np.zeros((rows, columns))
    elif kind == 5 and M.size:
        M.flat[rng.integers(M.size)] = rng.choice([np.nan, np.inf, -np.inf, 1e308, 5e-324])
    return M


def dressed(rng, M):
    """The same matrix as somebody may hand it over; seldom in another shape."""
    kind = rng.integers(0, 16)
    if kind == 0:
        return np.asfortranarray(M)
    if kind == 1:
        return M[::-1, ::-1].copy()[::-1, ::-1]
    if kind == 2:
        return np.repeat(np.repeat(M, 2, 0), 3, 1)[::2, ::3]
    if kind == 3:
        return M.tolist()
    if kind == 4:
        return np.round(np.clip(np.nan_to_num(M), -1e9, 1e9)).astype(np.int64)
    if kind == 5:
        return M.astype(complex) + (1j if rng.random() < 0.3 else 0)
    if kind == 6:
        return M.astype(np.float32 if rng.random() < 0.5 else object)
    if kind == 7 and rng.random() < 0.5:
        return [M.ravel(), M[None], M.T, M[:, :-1], "matrix", None, {"a": 1}, [[1.0], [2.0, 3.0]], np.float64(2.0)][rng.integers(9)]
    if kind == 8:
        return np.broadcast_to(M, (2, *M.shape))[0]
    if kind == 9:
        return M > 0 if rng.random() < 0.3 else np.ma.masked_array(M, mask=rng.random() < 0.2)
    return M


def symmetric(rng, n):
    M = entries(rng, n, n)
    if rng.random() < 0.1:
        return M
    with np.errstate(all="ignore"):
        return M @ M.T if rng.random() < 0.7 else M + M.T


class Plain:
    """A system of any object with matrices, which python-control has not checked."""

    def __init__(self, A, B, C, D, dt):
        self.A, self.B, self.C, self.D, self.dt = A, B, C, D, dt


def system(rng, inputs=None, outputs=None):
    n, m, p = (int(rng.choice(SIZES)) for _ in range(3))
    m, p = (m if inputs is None else inputs), (p if outputs is None else outputs)
    A = entries(rng, n, n)
    if rng.random() < 0.5 and np.isfinite(A).all():
        A = A - 2 * np.eye(n) * np.sqrt(n) * np.abs(A).max(initial=0.0)
    parts = [A, entries(rng, n, m), entries(rng, p, n), entries(rng, p, m) if rng.random() < 0.5 else np.zeros((p, m))]
    dt = [0, 0, 0, None, True, 0.1, 1e-300, -1.0, np.nan, np.inf, "s"][rng.integers(11 if rng.random() < 0.2 else 6)]
    return Plain(*(dressed(rng, part) if rng.random() < 0.3 else part for part in parts), dt)


def plant(rng, y, u):
    """A generalised plant that meets the assumptions of a synthesis, if all goes well."""
    P, n = system(rng, 0, 0), int(rng.choice(SIZES))
    w, z = y + int(rng.integers(0, 2)), u + int(rng.integers(0, 2))
    P.A, P.B, P.C = entries(rng, n, n), entries(rng, n, w + u), entries(rng, z + y, n)
    P.D, P.dt = np.zeros((z + y, w + u)), 0
    P.D[:u, w:], P.D[z:, :y] = np.eye(u), np.eye(y)
    return P


def count(rng, usual):
    odd = [-1, 2.5, 10**9, 2**70, np.nan, "one", None, np.int8(1), 0]
    return odd[rng.integers(len(odd))] if rng.random() < 0.15 else usual


def tolerance(rng):
    odd = [0, -1.0, np.nan, np.inf, 1.0, 1e-300, "small", None]
    return odd[rng.integers(len(odd))] if rng.random() < 0.3 else 1e-6


def call(rng):
    """One call: its name and what runs it."""
    name = str(rng.choice(["care", "dare", "lyap", "dlyap", "linfnorm", "h2norm", "margin", "margins", "poles", "zeros", "balred", "h2syn", "hinfsyn"]))
    of = getattr(cp, name)
    n, m = int(rng.choice(SIZES)), int(rng.choice(SIZES))
    if name in ("care", "dare"):
        optional = lambda M: dressed(rng, M) if rng.random() < 0.3 else None
        R = np.eye(m) if rng.random() < 0.5 else symmetric(rng, m)
        given = [dressed(rng, M) for M in (entries(rng, n, n), entries(rng, n, m), symmetric(rng, n), R)]
        S, E = optional(entries(rng, n, m)), optional(entries(rng, n, n))
        return name, lambda: of(*given, S, E)
    if name in ("lyap", "dlyap"):
        A, Q = dressed(rng, entries(rng, n, n)), dressed(rng, symmetric(rng, n))
        if rng.random() < 0.3:
            B, C = dressed(rng, entries(rng, m, m)), dressed(rng, entries(rng, n, m))
            return name, lambda: of(A, B, C)
        E = dressed(rng, entries(rng, n, n)) if rng.random() < 0.3 else None
        return name, lambda: of(A, Q, None, E)
    if name in ("h2syn", "hinfsyn"):
        y, u = int(rng.choice([0, 1, 1, 2])), int(rng.choice([0, 1, 1, 2]))
        odd = system(rng, u + int(rng.choice(SIZES)), y + int(rng.choice(SIZES)))
        P, counts = plant(rng, y, u) if rng.random() < 0.6 else odd, (count(rng, y), count(rng, u))
        return name, lambda: of(P, *counts)
    g = system(rng, 1, 1) if name in ("margin", "margins") and rng.random() < 0.9 else system(rng)
    if name == "balred":
        order = count(rng, int(rng.choice(SIZES)))
        return name, lambda: of(g, order, str(rng.choice(["truncate", "matchdc"])))
    if name == "linfnorm":
        tol = tolerance(rng)
        return name, lambda: of(g, tol)
    return name, lambda: of(g)


def numbers(answer):
    """Every number of an answer."""
    if isinstance(answer, dict):
        answer = list(answer.values())
    if isinstance(answer, (tuple, list)):
        return [x for part in answer for x in numbers(part)]
    if isinstance(answer, control.StateSpace):
        return numbers([answer.A, answer.B, answer.C, answer.D])
    return list(np.ravel(answer))


def may_be_infinite(name):
    return name in ("linfnorm", "h2norm", "margin", "margins", "hinfsyn")


def outcome(seed):
    """`answer`, `refused` or what is wrong."""
    rng = np.random.default_rng([20, seed])
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        name, run = call(rng)
        try:
            answer = run()
        except cp.NumericalError as why:
            return name, "refused" if len(str(why)) > 10 else f"an exception without a text: {why!r}"
        except BaseException as why:  # a panic is no Exception
            return name, f"another exception: {why!r}"
    values = numbers(answer)
    # a margin that does not exist has no frequency
    bad = [x for x in values if np.isnan(x) and name != "margin" or np.isinf(x) and not may_be_infinite(name)]
    return name, f"answers with {bad[0]}" if bad else "answer"


@pytest.mark.parametrize("first", range(0, 2000, 500))
def test_odd_calls_have_an_answer_or_a_reason(first):
    wrong = [(seed, *found) for seed in range(first, first + 500) if (found := outcome(seed))[1] not in ("answer", "refused")]
    assert not wrong, wrong[:5]


@pytest.mark.parametrize("seed", [51004557, 51014771])
def test_a_loop_that_is_not_well_posed_is_refused_as_a_numerical_error(seed):
    assert outcome(seed) == ("hinfsyn", "refused")


def test_imaginary_parts_and_masks_are_not_dropped():
    for odd in (np.array([[1j]]), np.ma.masked_array([[1.0]], mask=True), [["one"]], [[10**400]]):
        with pytest.raises(cp.NumericalError, match="A "):
            cp.lyap(odd, [[1.0]])
    assert cp.lyap(np.array([[-1 + 0j]]), 2) == pytest.approx(1.0)


def test_a_list_of_numbers_is_one_input():
    X, _, gain = cp.care([[0, 1], [0, 0]], [0, 1], np.eye(2))
    assert np.allclose(X, [[np.sqrt(3), 1], [1, np.sqrt(3)]]) and gain.shape == (1, 2)


def test_poles_and_zeros_are_those_of_python_control():
    g = control.ss(control.zpk([-200, -3], [-100, -0.1, -0.1, 5], 2.0))
    assert np.allclose(cp.poles(g), [-100, -0.1, -0.1, 5], rtol=1e-6)
    assert np.allclose(cp.zeros(g), [-200, -3], rtol=1e-9)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=20000)
    given = parser.parse_args()
    counts = collections.Counter()
    for seed in range(given.first, given.first + given.count):
        name, found = outcome(seed)
        counts[name, found if found in ("answer", "refused") else "WRONG"] += 1
        if found not in ("answer", "refused"):
            print(seed, name, found, flush=True)
    for (name, found), number in sorted(counts.items()):
        print(f"{name:9} {found:8} {number}")


if __name__ == "__main__":
    main()
