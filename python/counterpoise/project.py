"""Projects: the file, edited by key, and everything that is made of it."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _native
from ._native import CounterpoiseError, ProjectError
from .progress import Progress, Telling
from .results import Result

Value = float | int | str | bool | list | None


@dataclass(frozen=True)
class Finding:
    """One mistake in a project file, or something suspicious in it."""

    severity: str
    file: str
    line: int
    column: int
    path: str
    found: str | None
    allowed: str
    hint: str | None


def _findings(error: ProjectError) -> list[Finding]:
    keys = Finding.__dataclass_fields__
    found = json.loads(getattr(error, "_findings_json", "[]"))
    return [Finding(**{key: finding.get(key) for key in keys}) for finding in found]


ProjectError.findings = property(_findings)


class Project:
    """A project file in memory. It is immutable: `set` and `remove` return changed projects; `save` writes one.

    `progress(stage, done, of)` of the methods that work long is called as they go on; in a notebook a bar is shown where nothing is
    given. Such methods release the interpreter's lock and end with `KeyboardInterrupt` at Ctrl+C.
    """

    def __init__(self, native: _native.NativeProject):
        self._native = native

    @classmethod
    def load(cls, path: str | os.PathLike) -> Project:
        """Reads a project file, or the project.toml of a folder, with the parts that it includes."""
        return cls(_native.NativeProject.load(os.fspath(path)))

    @classmethod
    def from_text(cls, text: str, folder: str | os.PathLike = ".") -> Project:
        """Makes a project of a text; files that it names are looked for in `folder`."""
        return cls(_native.NativeProject.from_text(text, os.fspath(folder)))

    @property
    def path(self) -> str:
        """Path of the file."""
        return os.fspath(self._native.path)

    @property
    def text(self) -> str:
        """The file as `save` would write it."""
        return self._native.text

    def get(self, key: str) -> Value:
        """Returns the value at a path of keys, as in "plant.gearbox.ratio"; `None` if nothing is there.

        A number comes as a number, a quantity with a unit as the text that was written, a table or a list as its TOML text.
        """
        written = self._native.source_text(key)
        if written is None or self._native.is_text(key):
            return written
        try:
            return int(written)
        except ValueError:
            pass
        try:
            return float(written)
        except ValueError:
            return {"true": True, "false": False}.get(written, written)

    def set(self, key: str, value: Value) -> Project:
        """Returns the project with a value at a path of keys. Comments and order stay; a number keeps the unit that was written."""
        if isinstance(value, (bool, np.bool_)):
            raise CounterpoiseError(f"{key}: a project file has no value that is true or false")
        if isinstance(value, (int, np.integer)):
            return Project(self._native.with_whole(key, int(value)))
        if isinstance(value, (float, np.floating)):
            return Project(self._native.with_number(key, float(value)))
        if isinstance(value, str):
            return Project(self._native.with_text(key, value))
        return Project(self._native.with_numbers(key, [float(item) for item in value]))

    def remove(self, key: str) -> Project:
        """Returns the project without a key."""
        return Project(self._native.without(key))

    def save(self, path: str | os.PathLike | None = None) -> None:
        """Writes the project to a file, or over its own."""
        self._native.save(os.fspath(path if path is not None else self._native.path))

    def check(self) -> Result:
        """Returns warnings and assumptions. Raises `ProjectError` with all mistakes if the file cannot be used."""
        return Result.from_json("check", self._native.check())

    def model(self) -> Result:
        """Returns the plant: its matrices, poles and modes."""
        return Result.from_json("model", self._native.model())

    def reduce(self) -> Result:
        """Returns the reduced plant and the error of the reduction."""
        return Result.from_json("reduction", self._native.reduce())

    def synth(self, progress: Progress | None = None) -> Result:
        """Returns the controller: its parts, its matrices and the certificates of its equations."""
        with Telling(progress) as tell:
            return Result.from_json("synthesis", self._native.synth(tell))

    def design(self, progress: Progress | None = None) -> Result:
        """Returns the design with everything that was verified."""
        with Telling(progress) as tell:
            return Result.from_json("design", self._native.design(tell))

    def verify(self, progress: Progress | None = None) -> Result:
        """Returns what was verified: verdicts, margins, figures, certificate, frequency responses, time histories."""
        return Result("verification", self.design(progress)["verify"])

    def frequency_response(self, progress: Progress | None = None) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Returns the frequency responses of the verified loop by name: frequencies in Hz, complex values."""
        found = {}
        for response in self.design(progress)["verify"]["responses"]:
            values = np.array(response["real"]) + 1j * np.array(response["imaginary"])
            found[response["name"]] = (np.array(response["frequency_hz"]), values)
        return found

    def simulate(
        self,
        demand: np.ndarray | None = None,
        heave_m_s2: np.ndarray | None = None,
        pitch_rate_rad_s: np.ndarray | None = None,
        *,
        duration_s: float | None = None,
        hub_angle_rad: float = 0.0,
        seed: int | None = None,
        progress: Progress | None = None,
    ) -> dict[str, np.ndarray]:
        """Runs the nonlinear machine under the project's controller and returns the columns of the run as arrays.

        Signals have one value a sample of the controller; what is left out is zero. With a `seed` the sensors have noise and the
        converters quantise.
        """
        signals = [None if s is None else np.ascontiguousarray(s, dtype=float) for s in (demand, heave_m_s2, pitch_rate_rad_s)]
        with Telling(progress) as tell:
            return _native.simulate(self._native, *signals, duration_s, hub_angle_rad, seed, tell)

    def replay(self, recordings: str | os.PathLike | Iterable) -> Result:
        """Replays recordings on the model: residuals of each channel beside its noise floor."""
        return Result.from_json("replay", self._native.replay(_paths(recordings)))

    def diagnose(self, recordings: str | os.PathLike | Iterable, progress: Progress | None = None) -> tuple[Result, Project]:
        """Compares recordings with the model. Returns what was left out, and the project with it modelled."""
        with Telling(progress) as tell:
            answer, improved = self._native.diagnose(_paths(recordings), tell)
        return Result.from_json("diagnosis", answer), Project(improved)

    def export(self, folder: str | os.PathLike, progress: Progress | None = None) -> list[str]:
        """Writes the verified controller's code into a folder, and returns the paths of the files."""
        with Telling(progress) as tell:
            return json.loads(self._native.export(os.fspath(folder), tell))

    def sweep(self, progress: Progress | None = None) -> Result:
        """Runs the project's campaign over mechanisms that differ from the designed one.

        "figures" has every requirement with the share of mechanisms that meet it and the worst case that was found; "samples" has a
        column for every factor and every figure, as `to_pandas("samples")`.
        """
        with Telling(progress) as tell:
            return Result.from_json("campaign", _native.sweep(self._native, tell))

    def adapt(self, progress: Progress | None = None) -> Result:
        """Puts the adaptation to the test in the nonlinear closed loop: "runs" and "trials" of every method."""
        with Telling(progress) as tell:
            return Result.from_json("adaptation", _native.adapt(self._native, tell))

    def frequency_response_map(
        self,
        amplitudes: Iterable[float],
        frequencies_hz: Iterable[float],
        *,
        loop: str = "disturbance",
        offset_m: float = 0.0,
        recordings: str | os.PathLike | Iterable | None = None,
        progress: Progress | None = None,
    ) -> Result:
        """Measures frequency responses on the nonlinear machine by sines of each amplitude and frequency: "maps" has the points.

        `loop` is "plant" (control to hub rate, amplitudes in V), "closed" (demand to hub rate), "disturbance" (platform rate to hub
        rate) or "disconnected" (the same, balanced, without the motor), amplitudes in rad/s. With `recordings` the same instrument runs on
        their columns instead.
        """
        plan = [float(a) for a in amplitudes], [float(f) for f in frequencies_hz], offset_m
        found = [] if recordings is None else _paths(recordings)
        with Telling(progress) as tell:
            return Result.from_json("map", _native.frequency_response_map(self._native, loop, *plan, found, tell))

    def identify(
        self, recordings: str | os.PathLike | Iterable, other: str | os.PathLike | Iterable | None = None
    ) -> tuple[Result, Project]:
        """Identifies the machine from recordings of triangle waves; `other` holds those of a second state of balance.

        Returns what was identified with its 95 % intervals, and the project with it.
        """
        second = [] if other is None else _paths(other)
        found, improved = _native.identify(self._native, _paths(recordings), second)
        return Result.from_json("identification", found), Project(improved)

    def __repr__(self) -> str:
        return f"<Project {self.path}>"


def _paths(recordings: Any) -> list[str]:
    if isinstance(recordings, (str, os.PathLike)):
        return [os.fspath(recordings)]
    return [os.fspath(path) for path in recordings]
