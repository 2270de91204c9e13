"""Projects: the file, edited by key, and everything that is made of it."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _native
from ._native import CounterpoiseError, ProjectError
from .results import Result

Progress = Callable[[str, int, int], None]
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

    `progress(stage, done, of)` of the methods that work long is called as they go on. Such methods release the interpreter's lock and
    end with `KeyboardInterrupt` at Ctrl+C.
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
        written = self._native.written(key)
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
        return Result.from_json("synthesis", self._native.synth(progress))

    def design(self, progress: Progress | None = None) -> Result:
        """Returns the design with everything that was verified."""
        return Result.from_json("design", self._native.design(progress))

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
        return _native.simulate(self._native, *signals, duration_s, hub_angle_rad, seed, progress)

    def replay(self, recordings: str | os.PathLike | Iterable) -> Result:
        """Replays recordings on the model: residuals of each channel beside its noise floor."""
        return Result.from_json("replay", self._native.replay(_paths(recordings)))

    def diagnose(self, recordings: str | os.PathLike | Iterable, progress: Progress | None = None) -> tuple[Result, Project]:
        """Compares recordings with the model. Returns what was left out, and the project with it modelled."""
        answer, improved = self._native.diagnose(_paths(recordings), progress)
        return Result.from_json("diagnosis", answer), Project(improved)

    def export(self, folder: str | os.PathLike, progress: Progress | None = None) -> list[str]:
        """Writes the verified controller's code into a folder, and returns the paths of the files."""
        return json.loads(self._native.export(os.fspath(folder), progress))

    def __repr__(self) -> str:
        return f"<Project {self.path}>"


def _paths(recordings: Any) -> list[str]:
    if isinstance(recordings, (str, os.PathLike)):
        return [os.fspath(recordings)]
    return [os.fspath(path) for path in recordings]
