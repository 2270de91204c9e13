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


def _matrix(name: str, value: Any) -> np.ndarray:
    array = np.atleast_2d(np.asarray(value, dtype=float))
    if array.ndim != 2:
        raise NumericalError(f"{name} must be a matrix; it has {array.ndim} dimensions")
    return array


def _optional(name: str, value: Any) -> np.ndarray | None:
    return None if value is None else _matrix(name, value)


def riccati(A, B, Q, R=None, S=None, E=None, *, discrete: bool = False) -> Riccati:
    """Solves A'XE + E'XA - (E'XB + S) R^-1 (B'XE + S') + Q = 0, or its discrete counterpart, with a certificate."""
    A, B, Q = _matrix("A", A), _matrix("B", B), _matrix("Q", Q)
    R = np.eye(B.shape[1]) if R is None else _matrix("R", R)
    X, poles, gain, certificate = _native.riccati(A, B, Q, R, _optional("S", S), _optional("E", E), _time(discrete))
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
    period = None if sys.dt in (None, 0) else (1.0 if sys.dt is True else float(sys.dt))
    n, (p, m) = np.shape(sys.A)[0], np.shape(sys.D)
    A, B, C, D = (np.asarray(part, dtype=float) for part in (sys.A, sys.B, sys.C, sys.D))
    return A.reshape(n, n), B.reshape(n, m), C.reshape(p, n), D.reshape(p, m), period


def _control(matrices, dt):
    import control

    return control.ss(*matrices, 0 if dt is None else dt)


def linfnorm(sys, tol: float = 1e-10):
    """Returns the largest gain over frequency, and that frequency in rad/s, as `control.linfnorm` does."""
    low, _, rate = _native.peak_gain(_system(sys), tol)
    return low, rate


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
        return [balred(sys, int(order), method) for order in orders]
    given = _system(sys)
    kept = _native.Kept.ZeroFrequency if method == "matchdc" else _native.Kept.HighFrequencies
    reduced, _, _, _ = _native.balanced_reduction(given, int(orders), kept)
    return _control(reduced, given[-1])


def h2syn(P, nmeas: int, ncon: int):
    """Returns the controller u = K y that makes the H2 norm from w to z smallest, for the last `nmeas` outputs and `ncon` inputs of P."""
    K, _ = _native.h2_synthesis(_continuous(P), nmeas, ncon)
    return _control(K, None)


def hinfsyn(P, nmeas: int, ncon: int, tolerance: float = 1e-4):
    """Returns K, the closed loop, its norm and the largest bound found not to be reachable; the norm is within `tolerance` of the smallest."""
    given = _continuous(P)
    K, norm, unreachable = _native.hinf_synthesis(given, nmeas, ncon, tolerance)
    controller = _control(K, None)
    closed = _control(given[:4], None).lft(controller)
    return controller, closed, norm, unreachable


def _continuous(P):
    given = _system(P)
    if given[-1] is not None:
        raise NumericalError("the plant must be continuous: a sampled plant is not offered here")
    return given
