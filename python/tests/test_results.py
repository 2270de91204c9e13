"""Poles and margins of a result by python-control, as the manual loads them, against those that the result states."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests/peers/results"))


@pytest.fixture(scope="module", params=["direct-gimbal"])
def result(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp(request.param)
    program = shutil.which("counterpoise")
    path = folder / "result.json"
    command = [program, "design", ROOT / "examples" / request.param, "-o", folder / "out", "-q", f"--json={path}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode in (0, 1), done.stderr
    return json.loads(path.read_text(encoding="utf-8"))


def test_poles_are_those_of_python_control(result):
    import systems

    assert systems.pole_difference(result) < systems.TOLERANCE


def test_margins_are_those_of_python_control(result):
    import systems

    _, gain, phase = systems.margin_differences(result)
    assert max(gain, phase) < systems.TOLERANCE
