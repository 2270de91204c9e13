"""Counterpoise as the numerical core of python-control.

    import counterpoise.control_backend
    counterpoise.control_backend.install()

From then on `control.care`, `dare`, `lyap`, `dlyap`, `h2syn`, `hinfsyn`, `balred`, `margin` and `linfnorm` are computed here. What is not
offered (an explicit `method`, solutions that do not stabilise, frequency-response data, systems of several loops in `margin`) goes to
python-control's own function.
"""

from __future__ import annotations

import collections
import functools

import control
import control.margins
import control.mateqn
import control.modelsimp
import control.robust
import control.statesp
import numpy as np

from . import numerics

#: Number of calls by name that were computed here, and that were handed on.
computed: collections.Counter = collections.Counter()
handed_on: collections.Counter = collections.Counter()

_PLACES = {
    "lyap": control.mateqn,
    "dlyap": control.mateqn,
    "care": control.mateqn,
    "dare": control.mateqn,
    "h2syn": control.robust,
    "hinfsyn": control.robust,
    "balred": control.modelsimp,
    "margin": control.margins,
    "linfnorm": control.statesp,
}
_ORIGINAL = {name: getattr(module, name) for name, module in _PLACES.items()}


def _check(M, rows, columns, name, **properties):
    control.mateqn._check_shape(np.atleast_2d(M), rows, columns, name=name, **properties)


def _square_size(M, name):
    size = np.atleast_2d(M).shape[0]
    _check(M, size, size, name, square=True)
    return size


def _lyapunov(ours, A, Q, C, E):
    n, q = _square_size(A, "A"), _square_size(Q, "Q")
    if C is not None:
        if E is not None:
            raise control.ControlArgument("C and E cannot be given together")
        _check(C, n, q, "C")
        return ours(A, Q, C)
    _check(Q, n, n, "Q", symmetric=True)
    if E is not None:
        _check(E, n, n, "E", square=True)
    return ours(A, Q, None, E)


def _lyap(A, Q, C=None, E=None, method=None):
    return None if method else _lyapunov(numerics.lyap, A, Q, C, E)


def _dlyap(A, Q, C=None, E=None, method=None):
    return None if method else _lyapunov(numerics.dlyap, A, Q, C, E)


def _riccati(ours, A, B, Q, R, S, E, names):
    n = _square_size(A, names[0])
    m = np.atleast_2d(B).shape[1]
    R = np.eye(m) if R is None else R
    _check(B, n, m, names[1])
    _check(Q, n, n, names[2], symmetric=True)
    _check(R, m, m, names[3], symmetric=True)
    if S is not None:
        _check(S, n, m, names[4])
    if E is not None:
        _check(E, n, n, names[5], square=True)
    return ours(A, B, Q, R, S, E)


def _care(A, B, Q, R=None, S=None, E=None, stabilizing=True, method=None, _As="A", _Bs="B", _Qs="Q", _Rs="R", _Ss="S", _Es="E"):
    if method or not stabilizing:
        return None
    return _riccati(numerics.care, A, B, Q, R, S, E, (_As, _Bs, _Qs, _Rs, _Ss, _Es))


def _dare(A, B, Q, R, S=None, E=None, stabilizing=True, method=None, _As="A", _Bs="B", _Qs="Q", _Rs="R", _Ss="S", _Es="E"):
    if method or not stabilizing:
        return None
    return _riccati(numerics.dare, A, B, Q, R, S, E, (_As, _Bs, _Qs, _Rs, _Ss, _Es))


def _h2syn(P, nmeas, ncon):
    return numerics.h2syn(P, nmeas, ncon) if P.isctime() else None


def _hinfsyn(P, nmeas, ncon):
    if not P.isctime():
        return None
    K, closed, gam, _ = numerics.hinfsyn(P, nmeas, ncon)
    # python-control returns condition numbers of its two equations, which are solved otherwise here
    return K, closed, gam, np.full(4, np.nan)


def _balred(sys, orders, method="truncate", alpha=None):
    known = method in ("truncate", "matchdc") and alpha is None and isinstance(sys, control.StateSpace)
    return numerics.balred(sys, orders, method) if known else None


def _margin(*args):
    is_loop = len(args) == 1 and isinstance(args[0], (control.StateSpace, control.TransferFunction)) and args[0].issiso()
    return numerics.margin(args[0]) if is_loop else None


def _linfnorm(sys, tol=1e-10):
    return numerics.linfnorm(sys, tol)


_OURS = {
    "lyap": _lyap,
    "dlyap": _dlyap,
    "care": _care,
    "dare": _dare,
    "h2syn": _h2syn,
    "hinfsyn": _hinfsyn,
    "balred": _balred,
    "margin": _margin,
    "linfnorm": _linfnorm,
}


def _replacement(name):
    original, ours = _ORIGINAL[name], _OURS[name]

    @functools.wraps(original)
    def call(*args, **options):
        found = ours(*args, **options)
        if found is None:
            handed_on[name] += 1
            return original(*args, **options)
        computed[name] += 1
        return found

    return call


def install() -> None:
    """Puts the functions of this module in the place of python-control's."""
    for name, module in _PLACES.items():
        call = _replacement(name)
        setattr(module, name, call)
        setattr(control, name, call)


def remove() -> None:
    """Puts python-control's own functions back."""
    for name, module in _PLACES.items():
        setattr(module, name, _ORIGINAL[name])
        setattr(control, name, _ORIGINAL[name])
