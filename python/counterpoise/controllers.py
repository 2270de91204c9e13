"""Controllers that were made elsewhere, written as `[synth.controller]` of a project reads them."""

from __future__ import annotations

import json
import os
from typing import Any

import numpy as np


def write_controller(path: str | os.PathLike, system: Any, sample_time_s: float | None = None) -> None:
    """Writes a controller, from the error to the control, to a JSON file for `synth.controller.file`.

    `system` is a state-space system, a transfer function, or zeros, poles and gain of python-control or of `scipy.signal`; one input, one
    output. `sample_time_s` (0: continuous) is needed only if the system does not state it.

    >>> import control
    >>> write_controller("/tmp/legacy.json", control.tf([4.0, 40.0], [1.0, 0.0]))
    """
    stated = getattr(system, "dt", None)
    # scipy.signal says None for continuous time; python-control says None for "not stated" and 0 for continuous time
    if stated is None and type(system).__module__.startswith("scipy."):
        stated = 0.0
    period = stated if sample_time_s is None else sample_time_s
    if period is None or period is True:
        raise ValueError("the system does not state its sample time: give sample_time_s (0 for continuous time)")
    content = {**_form(system), "Ts": float(period)}
    with open(path, "w", encoding="utf-8") as file:
        json.dump(content, file)


def _form(system: Any) -> dict[str, Any]:
    """Returns the system in the form in which it was made, so that no digits are lost."""
    if all(hasattr(system, key) for key in "ABCD"):
        return {key: np.atleast_2d(np.asarray(getattr(system, key), dtype=float)).tolist() for key in "ABCD"}
    if all(hasattr(system, key) for key in ("zeros", "poles", "gain")) and not callable(system.zeros):
        roots = {"z": system.zeros, "p": system.poles}
        return {key: [[float(r.real), float(r.imag)] for r in map(complex, all_)] for key, all_ in roots.items()} | {
            "k": float(system.gain)
        }
    numerator, denominator = _only(system.num), _only(system.den)
    return {"num": [float(c) for c in numerator], "den": [float(c) for c in denominator]}


def _only(polynomial: Any) -> np.ndarray:
    """Returns the coefficients of a polynomial, which python-control keeps in a list for each output and input."""
    while isinstance(polynomial, (list, tuple)) or (isinstance(polynomial, np.ndarray) and polynomial.dtype == object):
        if len(polynomial) != 1:
            raise ValueError("the controller has several inputs or outputs; one of each is taken: from the error to the control")
        polynomial = polynomial[0]
    return np.atleast_1d(np.asarray(polynomial, dtype=float)).ravel()
