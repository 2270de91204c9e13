"""Checks the JSON results of every example against the published schema.

    python3 tests/peers/results/schema.py PROGRAM [EXAMPLE...]

Needs Python with jsonschema. Runs the commands that every project has, on every project of the examples (or on those named), and
validates each result and checks that every signal of every system has a name of its own, and validates the `controller.json` that `export` and `design` write, against the definition of its command in docs/reference/results.schema.json.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import jsonschema

ROOT = Path(__file__).resolve().parents[3]
SCHEMA = json.loads((ROOT / "docs/reference/results.schema.json").read_text(encoding="utf-8"))
COMMANDS = ("check", "model", "reduce", "synth", "verify", "export", "design")


def projects():
    """Returns the project files of the examples."""
    named = [Path(name).resolve() for name in sys.argv[2:]]
    return named or sorted(path for path in (ROOT / "examples").rglob("*.toml") if "[plant" in path.read_text(encoding="utf-8"))


def errors(name, result):
    """Returns what the schema does not allow."""
    own = {**SCHEMA["$defs"][name], "$defs": SCHEMA["$defs"]}
    found = jsonschema.Draft202012Validator(own).iter_errors(result)
    return [f"{'.'.join(map(str, error.absolute_path))}: {error.message[:200]}" for error in found]


def unnamed(result, path=""):
    """Returns the systems of which a signal lacks a name, or two have the same."""
    if isinstance(result, dict):
        if {"A", "B", "C", "D", "inputs", "outputs"} <= result.keys():
            counts = len(result["D"][0]) if result["D"] else 0, len(result["D"])
            names = [[signal["name"] for signal in result[key]] for key in ("inputs", "outputs")]
            if counts != tuple(map(len, names)) or any(len(set(one)) < len(one) or "" in one for one in names):
                yield f"{path}: {counts[0]} inputs {names[0]}, {counts[1]} outputs {names[1]}"
        for key, value in result.items():
            yield from unnamed(value, f"{path}.{key}")
    elif isinstance(result, list):
        for k, value in enumerate(result):
            yield from unnamed(value, f"{path}.{k}")


def main():
    program, wrong, valid, refused = str(Path(sys.argv[1]).resolve()), 0, 0, 0
    for project in projects():
        for command in COMMANDS:
            written = None
            with tempfile.TemporaryDirectory() as folder:
                output = ["-o", folder] if command in ("export", "design") else []
                done = subprocess.run(
                    [program, command, str(project), *output, "-q", "--json"], capture_output=True, text=True, check=False
                )
                controller = Path(folder) / "controller.json"
                if controller.exists():
                    written = json.loads(controller.read_text(encoding="utf-8"))
            if done.returncode not in (0, 1):
                refused += 1
                continue
            result = json.loads(done.stdout)
            found = errors(command, result) + list(unnamed(result))
            found += errors("controller", written) if written else []
            valid, wrong = valid + (not found), wrong + bool(found)
            for error in found:
                print(f"{project.relative_to(ROOT)}: {command}: {error}", flush=True)
    print(f"{valid} results valid, {wrong} not, {refused} commands refused the project")
    sys.exit(1 if wrong or not valid else 0)


main()
