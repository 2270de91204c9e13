"""Equations, norms, margins, reductions and syntheses, with the argument order of python-control.

Systems are anything with `A`, `B`, `C`, `D` and `dt`, as `control.StateSpace` has; functions that return systems need python-control.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _native
from ._native import NumericalError


@dataclass(frozen=True)
class Riccati:
    """A Riccati solution with its certificate.

    `X` is the stabilising solution, `gain` the feedback u = -gain x, `poles` the closed loop's. `certificate` holds the
    residual, the condition number and bounds of the error of each entry.
    """

    X: np.ndarray
    gain: np.ndarray
    poles: np.ndarray
    certificate: dict[str, Any]


def _real(name: str, value: Any) -> np.ndarray:
    """Returns an array of doubles. NumPy alone would drop imaginary parts and masks."""
    try:
        array = np.asarray(value)
        if np.ma.is_masked(value):
            raise NumericalError(f"{name} has masked entries: fill them first")
        if np.iscomplexobj(array):
            if np.any(array.imag != 0):
                raise NumericalError(f"{name} is complex; its entries must be real")
            array = array.real
        return array.astype(float)
    except NumericalError:
        raise
    except (TypeError, ValueError, OverflowError) as why:
        raise NumericalError(f"{name} is not an array of real numbers: {why}") from None


def _matrix(name: str, value: Any) -> np.ndarray:
    array = np.atleast_2d(_real(name, value))
    if array.ndim != 2:
        raise NumericalError(f"{name} must be a matrix; it has {array.ndim} dimensions")
    return array


def _columns(name: str, value: Any) -> np.ndarray:
    """Returns a matrix; a list of numbers is one column, as python-control reads it."""
    array = _real(name, value)
    return array.reshape(-1, 1) if array.ndim == 1 else _matrix(name, array)


def _optional(name: str, value: Any) -> np.ndarray | None:
    return None if value is None else _matrix(name, value)


def _count(name: str, value: Any) -> int:
    try:
        count = int(value)
        is_count = count == value and 0 <= count < 2**31
    except (TypeError, ValueError, OverflowError):
        is_count = False
    if not is_count:
        raise NumericalError(f"{name} must be a whole number that is not negative; it is {value!r}")
    return count


def _number(name: str, value: Any) -> float:
    array = _real(name, value)
    if array.size != 1:
        raise NumericalError(f"{name} must be one number; it has {array.size}")
    return float(array.reshape(()))


def riccati(A, B, Q, R=None, S=None, E=None, *, discrete: bool = False) -> Riccati:
    """Solves A'XE + E'XA - (E'XB + S) R^-1 (B'XE + S') + Q = 0, or its discrete counterpart, with a certificate."""
    A, B, Q = _matrix("A", A), _columns("B", B), _matrix("Q", Q)
    R = np.eye(B.shape[1]) if R is None else _matrix("R", R)
    S = None if S is None else _columns("S", S)
    X, poles, gain, certificate = _native.riccati(A, B, Q, R, S, _optional("E", E), _time(discrete))
    return Riccati(X, gain, poles, certificate)


def care(A, B, Q, R=None, S=None, E=None):
    """Solves the continuous Riccati equation. Returns X, the closed loop's poles and the gain, as `control.care` does."""
    found = riccati(A, B, Q, R, S, E)
    return found.X, found.poles, found.gain


def dare(A, B, Q, R, S=None, E=None):
    """Solves the discrete Riccati equation. Returns X, the closed loop's poles and the gain, as `control.dare` does."""
    found = riccati(A, B, Q, R, S, E, discrete=True)
    return found.X, found.poles, found.gain


def lyap(A, Q, C=None, E=None):
    """Solves A X + X A' + Q = 0; with C, A X + X Q + C = 0; with E, A X E' + E X A' + Q = 0."""
    return _lyapunov(A, Q, C, E, discrete=False)


def dlyap(A, Q, C=None, E=None):
    """Solves A X A' - X + Q = 0; with C, A X Q' - X + C = 0; with E, A X A' - E X E' + Q = 0."""
    return _lyapunov(A, Q, C, E, discrete=True)


def _time(discrete: bool) -> _native.Time:
    return _native.Time.Discrete if discrete else _native.Time.Continuous


def _lyapunov(A, Q, C, E, *, discrete):
    A, Q = _matrix("A", A), _matrix("Q", Q)
    if C is not None:
        if E is not None:
            raise NumericalError("C and E cannot be given together")
        return _native.two_sided(A, np.ascontiguousarray(Q.T) if discrete else Q, _matrix("C", C), _time(discrete))
    return _native.lyapunov(A, Q, _optional("E", E), _time(discrete))


def _system(sys) -> tuple:
    if not hasattr(sys, "A"):
        import control

        sys = control.ss(sys)
    period = None if sys.dt in (None, 0) else (1.0 if sys.dt is True else _number("dt", sys.dt))
    A, B, C = (_real(name, getattr(sys, name)) for name in "ABC")
    D = _matrix("D", sys.D)
    n, (p, m) = (A.shape[0] if A.ndim else 1), D.shape
    try:
        return A.reshape(n, n), B.reshape(n, m), C.reshape(p, n), D.reshape(p, m), period
    except ValueError:
        shapes = ", ".join(f"{name} {M.shape}" for name, M in zip("ABCD", (A, B, C, D), strict=True))
        raise NumericalError(f"the matrices of the system do not fit: {shapes}") from None


def _control(matrices, dt):
    import control

    if 0 in matrices[-1].shape:
        raise NumericalError("python-control has no systems without inputs or without outputs, so that none can be returned")
    return control.ss(*matrices, 0 if dt is None else dt)


def linfnorm(sys, tol: float = 1e-10):
    """Returns the largest gain over frequency, and that frequency in rad/s, as `control.linfnorm` does."""
    low, _, rate = _native.peak_gain(_system(sys), _number("tol", tol))
    return low, rate


def poles(sys) -> np.ndarray:
    """Returns the poles: the eigenvalues of A, by real and then by imaginary part."""
    return _native.poles(_system(sys))


def zeros(sys) -> np.ndarray:
    """Returns the finite invariant zeros, by real and then by imaginary part; decoupling zeros are among them."""
    return _native.zeros(_system(sys))


def h2norm(sys) -> float:
    """Returns the H2 norm; infinite for an unstable system, and for a continuous one with a direct path."""
    return _native.h2_norm(_system(sys))


def margins(sys) -> dict[str, Any]:
    """Returns every gain and phase crossing of a loop under negative feedback, the delay margin in s, the peaks of S and T, and the disk margin."""
    return _native.loop_margins(_system(sys))


# A loop with integrators crosses the negative real axis at zero frequency, where its gain is infinite: no change of gain reaches that.
_LARGEST_FACTOR = 1e10


def margin(sys):
    """Returns gain margin, phase margin in degrees, and their frequencies in rad/s, as `control.margin` does."""
    found = margins(sys)
    rises = [(factor, rate) for factor, rate in found["gain"] if 1 / _LARGEST_FACTOR < factor < _LARGEST_FACTOR]
    gm, wcg = min(rises, key=lambda one: abs(np.log(one[0])), default=(np.inf, np.nan))
    pm, wcp = min(found["phase"], key=lambda one: abs(one[0]), default=(np.inf, np.nan))
    return gm, pm, wcg, wcp


def balred(sys, orders, method: str = "truncate"):
    """Returns the system reduced to an order by balanced truncation, or by "matchdc"; a list of systems for a list of orders."""
    if method not in ("truncate", "matchdc"):
        raise NumericalError(f"method '{method}': write 'truncate' or 'matchdc'")
    if np.ndim(orders) > 0:
        return [balred(sys, order, method) for order in orders]
    given = _system(sys)
    kept = _native.Kept.ZeroFrequency if method == "matchdc" else _native.Kept.HighFrequencies
    reduced, _, _, _ = _native.balanced_reduction(given, _count("the order", orders), kept)
    return _control(reduced, given[-1])


def h2syn(P, nmeas: int, ncon: int):
    """Returns the controller u = K y that makes the H2 norm from w to z smallest, for the last `nmeas` outputs and `ncon` inputs of P."""
    K, _ = _native.h2_synthesis(_continuous(P), _count("nmeas", nmeas), _count("ncon", ncon))
    return _control(K, None)


def hinfsyn(P, nmeas: int, ncon: int, tolerance: float = 1e-4):
    """Returns K, the closed loop, its norm and the largest bound found not to be reachable; the norm is within `tolerance` of the smallest."""
    given = _continuous(P)
    counts = _count("nmeas", nmeas), _count("ncon", ncon)
    K, norm, unreachable = _native.hinf_synthesis(given, *counts, _number("the tolerance", tolerance))
    controller = _control(K, None)
    try:
        closed = _control(given[:4], None).lft(controller)
    except ValueError as why:
        raise NumericalError(
            f"the loop of the plant and the controller with norm {norm:.4g} is singular at high frequency to working precision ({why}): "
            "change the direct paths of the plant (D11, D22) or their units"
        ) from why
    return controller, closed, norm, unreachable


def _continuous(P):
    given = _system(P)
    if given[-1] is not None:
        raise NumericalError("the plant must be continuous: a sampled plant is not offered here")
    return given
