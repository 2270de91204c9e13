"""python-control's own tests of its Riccati and Lyapunov equations, syntheses, reductions, margins and norms, computed by Counterpoise.

    pip install counterpoise control slycot pytest
    python tests/peers/python/control_tests.py FOLDER

FOLDER holds the tests, control/tests of the source distribution of the installed version (`pip download --no-deps --no-binary :all: control`).
It is run twice: with python-control's own functions, and with ours in their places. Prints the counts of both and every test that passes
with its own functions and fails with ours; the exit code is their number.
"""

import pathlib
import re
import subprocess
import sys

SUITES = ["mateqn_test.py", "robust_test.py", "modelsimp_test.py", "margin_test.py", "sysnorm_test.py"]
PLUGIN = """
import counterpoise.control_backend as backend

backend.install()


def pytest_terminal_summary(terminalreporter):
    terminalreporter.write_line(f"computed here: {dict(backend.computed)}")
    terminalreporter.write_line(f"handed on: {dict(backend.handed_on)}")
"""


def run(folder, *options):
    suites = [str(folder / suite) for suite in SUITES]
    command = [sys.executable, "-m", "pytest", "-q", "-rA", "-p", "no:cacheprovider", *options, *suites]
    text = subprocess.run(command, capture_output=True, text=True, cwd=folder.parent.parent).stdout
    passed = set(re.findall(r"^PASSED (\S+)", text, re.M))
    failed = set(re.findall(r"^(?:FAILED|ERROR) (\S+)", text, re.M))
    skipped = sum(int(count) for count in re.findall(r"^SKIPPED \[(\d+)\]", text, re.M))
    return passed, failed, skipped, text


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()
    plugin = folder.parent.parent / "counterpoise_backend_plugin.py"
    plugin.write_text(PLUGIN)
    own, own_failed, skipped, _ = run(folder)
    print(f"python-control's own functions: {len(own)} pass, {len(own_failed)} fail, {skipped} are skipped")
    ours, failed, skipped, text = run(folder, "-p", "counterpoise_backend_plugin")
    print(f"computed by Counterpoise: {len(ours)} pass, {len(failed)} fail, {skipped} are skipped")
    print("\n".join(re.findall(r"^(?:computed here|handed on): .*", text, re.M)))
    worse = sorted(own - ours)
    print(f"{len(worse)} pass with their own functions alone", *worse, sep="\n  ")
    (folder.parent.parent / "counterpoise_backend.log").write_text(text)
    sys.exit(min(len(worse), 100))


main()
