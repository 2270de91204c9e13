"""Checks that every number which `counterpoise model`, `reduce`, `synth`, `verify` and `design` print, on the terminal and in their HTML
reports, occurs in their JSON result.

    python tests/peers/results/printed.py PROGRAM PROJECT... [--only COMMAND]

Each number is looked up, to the digits with which it is printed, among the values of the result that are no matrices, curves or time
histories, what follows from the result by one formula (`derived`), the numbers in its texts, and the numbers of the project file. A printed unit may be a multiple of the unit of the result
(mrad, degrees, Hz, %, ms). A number is a statement about one figure, so that chance may find another one: the script also looks up every number
moved by a few parts in a hundred, and prints how many of these are found.
"""

import html.parser
import json
import math
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import leaves
import responses

COMMANDS = ("model", "reduce", "synth", "verify", "design")
NUMBER = re.compile(r"(?<![\w.])[-+\u2212]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.]*\d)")
# Multiples by which a printed unit differs from that of the result.
FACTORS = (1.0, 1e3, 1e6, 1e-3, 100.0, 1e-6, 180.0 / math.pi, 0.5 / math.pi)
# Matrices, curves and time histories: what figures are computed from, not what is printed.
ARRAYS = re.compile(
    r".*\.([ABCDG]\.\d+\.\d+.*|real\.\d+|imaginary\.\d+|perturbation\..*|rates_rad_s\.\d+|\w+_rates_rad_s\.\d+|errors_rad_s\.\d+|(hub|tip)_rad\.\d+"
    r"|elements\..*)|.*histor.*|.*responses\..*|.*\.bounds\..*|.*\.pulled\..*|.*systems\..*|.*basis\..*|.*loops?\.\d*\.?[ABCD].*"
)
MOVED = (1.013, 0.977, 1.061)


class Text(html.parser.HTMLParser):
    """The text of a page without its pictures, styles and scripts."""

    def __init__(self):
        super().__init__()
        self.depth, self.parts = 0, []

    def handle_starttag(self, tag, attrs):
        self.depth += tag in ("svg", "style", "script")
        self.parts.append(" ")

    def handle_endtag(self, tag):
        self.depth -= tag in ("svg", "style", "script")
        self.parts.append(" ")

    def handle_data(self, data):
        if self.depth == 0:
            self.parts.append(data)


def text_of(page):
    parser = Text()
    parser.feed(page)
    return "".join(parser.parts)


SUPERSCRIPTS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


def numbers(text):
    """(as it is printed, its value, half a unit of its last digit, what stands around it)."""
    power = lambda match: f"e{match.group(1).translate(SUPERSCRIPTS)}"
    text = re.sub("×10([⁻⁰¹²³⁴-⁹]+)", power, text)
    for match in NUMBER.finditer(text):
        word = match.group().replace("\u2212", "-")
        mantissa, _, exponent = word.partition("e")
        digits = len(mantissa.partition(".")[2])
        yield word, float(word), 0.5 * 10.0 ** (int(exponent or 0) - digits), text[max(match.start() - 60, 0) : match.end() + 30]


def texts(node):
    if isinstance(node, dict):
        for key, value in node.items():
            yield key
            yield from texts(value)
    elif isinstance(node, list):
        for value in node:
            yield from texts(value)
    elif isinstance(node, str):
        yield node


def lengths(node):
    """Lists are counted in what is printed: so many poles, so many requirements."""
    if isinstance(node, dict):
        for value in node.values():
            yield from lengths(value)
    elif isinstance(node, list):
        yield float(len(node))
        for value in node[:40]:
            yield from lengths(value)


def derived(result):
    """Printed figures that follow from the result by one formula: shares in percent, ratios of a trial, moduli and angles of complex errors,
    differences of a value and its limit, sizes and damping of poles, the margins at every crossing of the loop, and where the disk margin is
    smallest."""
    verify = result.get("verify", result)
    verdicts = verify.get("verdicts", [])
    for word in ("holds", "fails", "not applicable"):
        yield float([one["verdict"] for one in verdicts].count(word))
    yield from (abs(one["value"] - one["limit"]) for one in verdicts if one["value"] is not None)
    for pole in result.get("poles_rad_s", []) + result.get("model", {}).get("poles_rad_s", []):
        size = math.hypot(*pole)
        yield from (size, abs(pole[0]) / size if size else 0.0)
    budget = verify.get("error_budget") or {"contributions": []}
    for one in budget["contributions"]:
        yield from (abs(one["share_rad2"][key]) / value**2 for key, value in budget["total_rad"].items() if value)
    for row in (verify.get("adaptation_trials") or {"rows": []})["rows"]:
        yield row["with_rad_s"] / row["without_rad_s"]
        added = row["without_rad_s"] - row["told_rad_s"]
        yield abs((row["without_rad_s"] - row["with_rad_s"]) / added) if added else 0.0
    for one in verify.get("robustness", []):
        for error in (one["nearest"] or {"errors": []})["errors"]:
            yield from (math.hypot(*error), abs(math.degrees(math.atan2(error[1], error[0]))))
    yield from margins(verify.get("systems", []))


def margins(systems):
    """The loop at its crossings of the unit circle and of the real axis: frequency in Hz, and phase in degrees or gain in dB."""
    found = [one for one in systems if one["name"] == "loop"]
    if not found:
        return
    L = responses.system(found[0])
    one = lambda rate: responses.at(L, np.array([rate]), L.dt)[0, 0, 0]
    rates = np.geomspace(1e-3, math.pi / L.dt * (1.0 - 1e-9), 40000)
    values = responses.at(L, rates, L.dt)[:, 0, 0]
    for rate in responses.crossings(rates, values.imag, lambda r: one(r).imag):
        yield from (rate / (2.0 * math.pi), abs(responses.decibels(abs(one(rate)))))
    for rate in responses.crossings(rates, np.abs(values) - 1.0, lambda r: abs(one(r)) - 1.0):
        yield from (rate / (2.0 * math.pi), abs(math.degrees(np.angle(-one(rate)))))
    # where the disk margin is smallest
    skew = lambda rate: abs(0.5 * (1.0 - one(rate)) / (1.0 + one(rate)))
    k = int(np.argmax(np.abs((1.0 - values) / (1.0 + values))))
    yield responses.golden(skew, rates[max(k - 1, 0)], rates[min(k + 1, len(rates) - 1)]) / (2.0 * math.pi)


class Pool:
    def __init__(self, result, project):
        found = {0.0}
        for path in leaves.walk(result):
            if not ARRAYS.fullmatch("." + ".".join(map(str, path))):
                value = leaves.value_at(result, path)
                found.add(abs(float(value)))
        for text in list(texts(result)) + [project]:
            found.update(abs(value) for _, value, _, _ in numbers(text))
        found.update(lengths(result))
        found.update(derived(result))
        self.values = sorted(value for value in found if math.isfinite(value))

    def has(self, value, half):
        import bisect

        for factor in FACTORS:
            # numbers are rounded from a binary value: a tie may go either way
            low, high = (abs(value) - half * 1.000001) / factor, (abs(value) + half * 1.000001) / factor
            at = bisect.bisect_left(self.values, low)
            if at < len(self.values) and self.values[at] <= high:
                return True
        return False


def without_provenance(text):
    """Hashes, versions, paths, dates and times of stages say nothing about the design."""
    text = re.sub(r"\b[0-9a-f]{12,}\b", " ", text)
    text = re.sub(r"\S*/\S*\.(toml|html|json|c|h|rs|fmu)\b", " ", text)
    text = re.sub(r"What each stage took\s+stage\s+time \[ms\](\s+[a-z]+\s+[\d.]+)+", " ", text)
    # the axes of a chart are no figures
    text = re.sub("[-\u2212]180 degrees", " ", text)
    return re.sub(r"\b(ISO \d+|C99|Cortex-M\w*|[Vv]ersion \S+|H2|L2|H-?infinity)\b", " ", text)


def run(program, command, project, folder):
    out, page = Path(folder) / "result.json", Path(folder) / "report.html"
    to = {"design": ["-o", folder], "reduce": []}.get(command, ["--report", str(page)])
    shown = subprocess.run([program, command, str(project), *to, "-q"], capture_output=True, text=True, check=False)
    done = subprocess.run([program, command, str(project), *to, "-q", f"--json={out}"], capture_output=True, text=True, check=False)
    if shown.returncode not in (0, 1) or done.returncode not in (0, 1):
        return None
    shown_page = text_of(page.read_text(encoding="utf-8")) if page.exists() else ""
    return shown.stdout, shown_page, json.loads(out.read_text(encoding="utf-8"))


def main():
    arguments = sys.argv[1:]
    only = COMMANDS
    if "--only" in arguments:
        at = arguments.index("--only")
        only = (arguments[at + 1],)
        del arguments[at : at + 2]
    program, missing_in_all = str(Path(arguments[0]).resolve()), 0
    for project in map(Path, arguments[1:]):
        file = project / "project.toml" if project.is_dir() else project
        for command in only:
            with tempfile.TemporaryDirectory() as folder:
                found = run(program, command, project, folder)
            if found is None:
                print(f"{project}: {command}: refused")
                continue
            terminal, page, result = found
            pool, missing, count, chance = Pool(result, file.read_text(encoding="utf-8")), {}, 0, 0
            for where, text in (("terminal", terminal), ("report", page)):
                for word, value, half, around in numbers(without_provenance(text)):
                    count += 1
                    if not pool.has(value, half):
                        missing.setdefault((where, word), " ".join(around.split()))
                    if abs(value) > 20.0 * half:
                        chance += sum(pool.has(value * factor, half) for factor in MOVED) / len(MOVED)
            missing_in_all += len(missing)
            print(f"{project}: {command}: {count} numbers printed, {len(missing)} not in the result; of moved ones {chance:.0f} would be found by chance")
            for (where, word), around in missing.items():
                print(f"  {where}: {word}  in  ...{around}...")
    sys.exit(1 if missing_in_all else 0)


if __name__ == "__main__":
    main()
