"""Results as objects: what the command line writes as JSON, with arrays, tables and state-space systems."""

from __future__ import annotations

import html
import json
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np


class System:
    """A state-space system with named, dimensioned signals: x' = A x + B u, y = C x + D u, or in samples of `sample_time_s`."""

    def __init__(self, data: Mapping[str, Any]):
        self.name: str = data["name"]
        n, p = len(data["states"]), len(data["D"])
        m = len(data["D"][0]) if p else len(data["inputs"])
        self.A = np.array(data["A"], dtype=float).reshape(n, n)
        self.B = np.array(data["B"], dtype=float).reshape(n, m)
        self.C = np.array(data["C"], dtype=float).reshape(p, n)
        self.D = np.array(data["D"], dtype=float).reshape(p, m)
        self.sample_time_s: float = data.get("sample_time_s") or 0.0
        self.states = [_name(signal) for signal in data["states"]]
        self.inputs = _names(data["inputs"], m, "u")
        self.outputs = _names(data["outputs"], p, "y")

    def to_control(self):
        """Returns the system as `control.StateSpace`. Needs python-control."""
        import control

        return control.ss(
            self.A,
            self.B,
            self.C,
            self.D,
            self.sample_time_s or 0,
            states=self.states or None,
            inputs=self.inputs,
            outputs=self.outputs,
            name=self.name,
        )

    def poles(self) -> np.ndarray:
        """Returns the eigenvalues of A: in rad/s, or in the z-plane."""
        return np.linalg.eigvals(self.A)

    def __repr__(self) -> str:
        time = f"sampled every {self.sample_time_s:g} s" if self.sample_time_s else "continuous"
        size = f"{len(self.states)} states, {len(self.inputs)} inputs, {len(self.outputs)} outputs"
        return f"<System {self.name}: {size}, {time}>"


def _names(signals: list[Any], count: int, letter: str) -> list[str]:
    """Returns a name for each of `count` signals; those without a name of their own are numbered."""
    named = [_name(signal) for signal in signals[:count]]
    return named + [f"{letter}{k + 1}" for k in range(len(named), count)]


def _name(signal: Any) -> str:
    return signal["name"] if isinstance(signal, Mapping) else str(signal)


class Result(Mapping):
    """A result as the command line writes it: a mapping, with its systems, verdicts and tables at hand."""

    def __init__(self, kind: str, data: dict[str, Any]):
        self.kind = kind
        self.data = data

    @classmethod
    def from_json(cls, kind: str, text: str) -> Result:
        """Reads a result; `kind` is its name in words."""
        return cls(kind, json.loads(text))

    def __getitem__(self, key: str) -> Any:
        return self.data[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self.data)

    def __len__(self) -> int:
        return len(self.data)

    def systems(self) -> dict[str, System]:
        """Returns the state-space systems of the result, those of its parts included.

        A system goes by its name; where several parts have one of the same name, by its place, as "verify.systems.loop".
        """
        parts = list(_systems(self.data))
        names = [part["name"] for _, part in parts]
        return {part["name"] if names.count(part["name"]) == 1 else place: System(part) for place, part in parts}

    def to_control(self, name: str):
        """Returns one of the systems as `control.StateSpace`. Needs python-control.

        `name` is a key of `systems()`, or a name that several parts share: then the system that is nested least deeply is meant.
        """
        systems = self.systems()
        if name not in systems:
            alike = [place for place in systems if place.endswith("." + name)]
            depth = [place.count(".") + place.count("[") for place in alike]
            if not alike or depth.count(min(depth)) > 1:
                raise KeyError(f"no system is '{name}' alone; there are {', '.join(alike or systems) or 'none'}")
            name = alike[depth.index(min(depth))]
        return systems[name].to_control()

    def verdicts(self) -> list[dict[str, Any]]:
        """Returns the requirements with their measured values, one a row; empty if the result judges nothing."""
        part = self.data.get("verify", self.data)
        return list(part.get("verdicts", []))

    def figures(self) -> list[dict[str, Any]]:
        """Returns every measured figure with unit and basis, one a row; empty if the result measures nothing."""
        part = self.data.get("verify", self.data)
        return list(part.get("figures", []))

    @property
    def passes(self) -> bool | None:
        """Whether every requirement holds; `None` if the result judges nothing."""
        return self.data.get("verify", self.data).get("passes")

    def to_pandas(self, key: str | None = None):
        """Returns a part of the result as a data frame: that at `key`, as in "verify.verdicts", or the figures. Needs pandas.

        A list gives a row for each of its items, a mapping of lists a column for each of them.
        """
        import pandas

        if key is None:
            return pandas.DataFrame(self.figures())
        value: Any = self.data
        for step in key.split("."):
            value = value[step]
        if isinstance(value, dict) and value and all(isinstance(column, list) for column in value.values()):
            return pandas.DataFrame(value)
        return pandas.json_normalize(value)

    def __repr__(self) -> str:
        passes = {None: "", True: ", every requirement holds", False: ", not every requirement holds"}[self.passes]
        return f"<{self.kind}{passes}>"

    def _repr_html_(self) -> str:
        rows = self.verdicts() or self.figures()
        title = f"<b>{html.escape(repr(self)[1:-1])}</b>"
        if not rows:
            return title + "<br>" + ", ".join(html.escape(key) for key in self.data)
        keys = [key for key in rows[0] if not isinstance(rows[0][key], (dict, list))]
        head = "".join(f"<th>{html.escape(key)}</th>" for key in keys)
        body = "".join(
            "<tr>" + "".join(f"<td>{html.escape(_short(row.get(key)))}</td>" for key in keys) + "</tr>" for row in rows
        )
        return f"{title}<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _short(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _systems(value: Any, place: str = "") -> Iterator[tuple[str, dict[str, Any]]]:
    """Walks over a result; yields every state-space system with its place."""
    if isinstance(value, dict):
        if {"A", "B", "C", "D", "name", "states"} <= value.keys():
            yield f"{place.rpartition('.')[0]}.{value['name']}".lstrip("."), value
        for key, inner in value.items():
            yield from _systems(inner, f"{place}.{key}".lstrip("."))
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        listed = {"A", "B", "C", "D", "name", "states"} <= value[0].keys()
        for index, inner in enumerate(value):
            # a list of systems names its members, another one numbers them
            yield from _systems(inner, f"{place}.system" if listed else f"{place}[{index}]")
