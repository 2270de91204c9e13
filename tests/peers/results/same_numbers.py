"""Numbers of every example before and after a change of the program: equal to the last bit, through a map of renamed keys.

usage: same_numbers.py OLD_PROGRAM OLD_EXAMPLES NEW_PROGRAM NEW_EXAMPLES [--list]

Each example that both folders have is run by both programs (`model`, `reduce`, `synth`, `verify`, each with --json, and `export`). The numbers of both
results are compared by their places. `renamed_keys.toml` beside this script says under which key a number stands now: `[keys]` renames single
keys wherever they stand, `[places]` whole places (`*` stands for any item of a list). Of the exported C files the numeric literals are compared, in their order;
names and comments do not count. Printed for each example: how many numbers are equal, differ, stand only before, stand only now.
With --list every number that differs is listed, with both values.
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib

COMMANDS = ("model", "reduce", "synth", "verify")
LITERAL = re.compile(r"(?<![\w.])[-+]?(?:0x[0-9a-fA-F.]+p[-+]?\d+|\d+\.?\d*(?:[eE][-+]?\d+)?)f?")
COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*|\"[^\"\n]*\"", re.S)


def leaves(value, place=()):
    if isinstance(value, dict):
        for key, item in value.items():
            yield from leaves(item, (*place, key))
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from leaves(item, (*place, str(index)))
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield place, value


class Renaming:
    def __init__(self, path):
        written = tomllib.loads(path.read_text()) if path.exists() else {}
        self.keys = written.get("keys", {})
        self.places = [(old.split("."), new.split(".")) for old, new in written.get("places", {}).items()]

    def apply(self, place):
        place = tuple(self.keys.get(key, key) for key in place)
        for old, new in self.places:
            head = place[: len(old)]
            if len(head) == len(old) and all(a in ("*", b) for a, b in zip(old, head)):
                filled = iter(b for a, b in zip(old, head) if a == "*")
                return (*(next(filled) if key == "*" else key for key in new if key), *place[len(old) :])
        return place


def numbers(program, example, command):
    run = subprocess.run([program, command, example, "--json"], capture_output=True, text=True)
    try:
        return dict(leaves(json.loads(run.stdout)))
    except json.JSONDecodeError:
        return None


def literals(program, example):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "export", example, "-o", folder], capture_output=True)
        files = sorted(path for path in pathlib.Path(folder).rglob("*.[ch]"))
        return {path.name: LITERAL.findall(COMMENT.sub("", path.read_text())) for path in files}


def main():
    old_program, old_examples, new_program, new_examples = sys.argv[1:5]
    renaming = Renaming(pathlib.Path(__file__).with_name("renamed_keys.toml"))
    names = sorted(p.name for p in pathlib.Path(old_examples).iterdir() if (pathlib.Path(new_examples) / p.name / "project.toml").exists())
    differing = 0
    for name in names:
        before, after = (f"{folder}/{name}" for folder in (old_examples, new_examples))
        for command in COMMANDS:
            old, new = numbers(old_program, before, command), numbers(new_program, after, command)
            if old is None or new is None:
                print(f"{name:24} {command:8} no JSON: before {old is not None}, now {new is not None}")
                continue
            old = {renaming.apply(place): value for place, value in old.items()}
            both = old.keys() & new.keys()
            unequal = sorted(place for place in both if old[place] != new[place])
            differing += len(unequal)
            only_old, only_new = len(old.keys() - both), len(new.keys() - both)
            print(f"{name:24} {command:8} {len(both) - len(unequal):7} equal {len(unequal):6} differ {only_old:6} only before {only_new:7} only now")
            if "--list" in sys.argv:
                for place in unequal:
                    print("    ", ".".join(place), old[place], new[place])
                for place in sorted({re.sub(r"\.\d+", ".*", ".".join(place)) for place in old.keys() - both}):
                    print("     only before:", place)
        old, new = literals(old_program, before), literals(new_program, after)
        for file in sorted(old.keys() & new.keys()):
            same = old[file] == new[file]
            differing += not same
            print(f"{name:24} {file:24} {len(old[file])} literals {'equal' if same else f'DIFFER ({len(new[file])} now)'}")
    print(f"{differing} differences")
    sys.exit(differing > 0)


if __name__ == "__main__":
    main()
