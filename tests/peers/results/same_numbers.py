"""Numbers of every example before and after a change of the program: equal to the last bit, through a map of renamed keys.

usage: same_numbers.py OLD_PROGRAM OLD_EXAMPLES NEW_PROGRAM NEW_EXAMPLES [--list] [--only EXAMPLE] [--published FOLDER]

Each project file of an example that both folders have is run by both programs (`model`, `reduce`, `synth`, `verify`, `fra` and `adapt`, each with --json, and
`export`; `replay`, `identify` and `diagnose` where recordings lie beside it or in its folders). A command that a project does not allow is left out. Recordings that
other people published are no part of the examples: with --published they are taken from FOLDER, where each machine of `real-recordings` has a folder of them. The numbers of both
results are compared by their places. `renamed_keys.toml` beside this script says under which name a number stands now. Of the exported C
files the numeric literals are compared, in their order; names and comments do not count. Printed for each example: how many numbers are equal, differ, stand only before, stand only now.
With --list every number that differs is listed, with both values, and every place that stands only before. `worst` is the largest relative
difference of a number that differs.
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib

COMMANDS = ("model", "reduce", "synth", "verify", "fra", "adapt")
OF_RECORDINGS = ("replay", "identify", "diagnose")
LITERAL = re.compile(r"(?<![\w.])[-+]?(?:0x[0-9a-fA-F.]+p[-+]?\d+|\d+\.?\d*(?:[eE][-+]?\d+)?)f?")
COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*|\"[^\"\n]*\"", re.S)


def leaves(value, place=()):
    if isinstance(value, dict):
        for key, item in value.items():
            yield from leaves(item, (*place, key))
    elif isinstance(value, list):
        for label, item in zip(labels(value), value):
            yield from leaves(item, (*place, label))
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield place, value


def labels(items):
    """Returns what each item of a list is called: what names it, counted if several share the name, else its place."""
    for key in ("figure", "name", "key", "method", "part"):
        names = [item.get(key) if isinstance(item, dict) else None for item in items]
        if items and all(isinstance(name, str) for name in names):
            return [f"{name}#{names[:k].count(name)}" if names[:k].count(name) else name for k, name in enumerate(names)]
    return [str(index) for index in range(len(items))]


class Renaming:
    """What the numbers of an example's results are called now."""

    def __init__(self, path, example):
        written = tomllib.loads(path.read_text()).get("renamed", [])
        rules = [rule for rule in written if example in rule["examples"]]
        self.rules = [(re.compile(rule["was"]), rule["is"]) for rule in rules]

    def apply(self, place):
        for was, now in self.rules:
            place = tuple(was.sub(now, key) for key in place)
        return place


def recordings(project, published):
    """Returns the recordings of a project's machine; the road of a verification, a single file, is none."""
    folder = project.parent
    if published and folder.parent.name == "real-recordings":
        return sorted(str(path) for path in (published / folder.name).glob("*.parquet"))
    if project.name != "project.toml":
        return []
    beside, below = sorted(map(str, folder.glob("*.parquet"))), sorted(map(str, folder.rglob("*.parquet")))
    return next((files for files in (beside, below) if len(files) > 1), [])


def numbers(program, project, command, published):
    files = recordings(project, published) if command in OF_RECORDINGS else []
    run = subprocess.run([program, command, project, *files, "--json", "--quiet"], capture_output=True, text=True)
    try:
        return dict(leaves(json.loads(run.stdout)))
    except json.JSONDecodeError:
        return None


def projects(folder):
    """Returns the project files below a folder, from it; that of a traverse axis is a part of another project."""
    files = (path.relative_to(folder) for path in folder.rglob("*.toml"))
    return sorted(path for path in files if path.name != "traverse.toml")


def option(name):
    """Returns what follows an option of the command line; None if it is not given."""
    return sys.argv[sys.argv.index(name) + 1] if name in sys.argv else None


def literals(program, example):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "export", example, "-o", folder], capture_output=True)
        files = sorted(path for path in pathlib.Path(folder).rglob("*.[ch]"))
        return {path.name: LITERAL.findall(COMMENT.sub("", path.read_text())) for path in files}


def main():
    old_program, old_examples, new_program, new_examples = sys.argv[1:5]
    published = option("--published")
    published = published and pathlib.Path(published)
    both_have = [file for file in projects(pathlib.Path(old_examples)) if (pathlib.Path(new_examples) / file).exists()]
    differing = 0
    for file in both_have:
        example = file.parts[0]
        if option("--only") not in (None, example):
            continue
        name = str(file.parent if file.name == "project.toml" else file.with_suffix(""))
        renaming = Renaming(pathlib.Path(__file__).with_name("renamed_keys.toml"), example)
        before, after = (pathlib.Path(folder) / file for folder in (old_examples, new_examples))
        for command in COMMANDS + (OF_RECORDINGS if recordings(after, published) else ()):
            old, new = numbers(old_program, before, command, published), numbers(new_program, after, command, published)
            if old is None and new is None:
                continue
            if old is None or new is None:
                print(f"{name:30} {command:8} no JSON: before {old is not None}, now {new is not None}")
                continue
            old = {renaming.apply(place): value for place, value in old.items()}
            both = old.keys() & new.keys()
            unequal = sorted(place for place in both if old[place] != new[place])
            differing += len(unequal)
            only_old, only_new = len(old.keys() - both), len(new.keys() - both)
            worst = max((abs(old[p] - new[p]) / max(abs(old[p]), abs(new[p])) for p in unequal), default=0.0)
            print(f"{name:30} {command:8} {len(both) - len(unequal):7} equal {len(unequal):6} differ {only_old:6} only before {only_new:7} only now, worst {worst:.0e}")
            if "--list" in sys.argv:
                for place in unequal:
                    print("    ", ".".join(place), old[place], new[place])
                for place in sorted({re.sub(r"\.\d+", ".*", ".".join(place)) for place in old.keys() - both}):
                    print("     only before:", place)
        old, new = literals(old_program, before), literals(new_program, after)
        for code in sorted(old.keys() & new.keys()):
            same = old[code] == new[code]
            differing += not same
            print(f"{name:30} {code:24} {len(old[code])} literals {'equal' if same else f'DIFFER ({len(new[code])} now)'}")
    print(f"{differing} differences")
    sys.exit(differing > 0)


if __name__ == "__main__":
    main()
