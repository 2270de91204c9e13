"""Projects from Python: editing, designing, simulating, and the text of a mistake."""

import pathlib
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import counterpoise as cp

EXAMPLES = pathlib.Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="session")
def gimbal():
    return cp.Project.load(EXAMPLES / "direct-gimbal")


@pytest.fixture(scope="session")
def design(gimbal):
    return gimbal.design()


def test_values_are_read_and_changed_by_key(gimbal):
    key = "plant.inertia"
    before = gimbal.get(key)
    changed = gimbal.set(key, 0.75)
    assert gimbal.get(key) == before and gimbal.get("plant.nothing") is None
    assert changed.get(key) != before and changed.text != gimbal.text
    assert changed.set("plant.name", "another").get("plant.name") == "another"
    assert changed.remove("plant.name").get("plant.name") is None
    assert changed.set("plant.inertia", "4000 kg cm^2").get("plant.inertia") == "4000 kg cm^2"


def test_a_design_is_verified_and_its_systems_are_arrays(design):
    assert design.passes is True and all(row["verdict"] == "holds" for row in design.verdicts())
    systems = design.systems()
    controller = systems["verify.systems.controller"]
    assert controller.A.shape == (len(controller.states),) * 2
    loop = design.to_control("loop")
    assert loop.dt == systems["verify.systems.loop"].sample_time_s
    gain, _, _, _ = cp.margin(loop)
    assert np.isfinite(gain)
    figures = {row["figure"]: row["value"] for row in design.figures()}
    assert figures["gain_margin_db"] == pytest.approx(20 * np.log10(gain), abs=1e-6)
    assert cp.margins(loop)["is_stable"]
    with pytest.raises(KeyError, match="synth.controllers.feedback, synth.paths.feedback"):
        design.to_control("feedback")
    assert "<table>" in design._repr_html_() and len(design.to_pandas()) == len(figures)


@pytest.mark.parametrize("name", ["ball-screw", "belt-antenna", "azimuth", "servo-pendulum"])
def test_every_system_of_a_synthesis_goes_to_python_control(name):
    made = cp.Project.load(EXAMPLES / name).synth()
    for key, system in made.systems().items():
        assert system.to_control().nstates == len(system.states), key
        assert len(system.inputs) == system.D.shape[1] and len(system.outputs) == system.D.shape[0]


def test_a_run_follows_its_demand(gimbal):
    demand = np.full(1500, 0.05)
    run = gimbal.simulate(demand)
    assert len(run["time_s"]) == 1500
    assert abs(run["hub_rate_rad_s"][-100:].mean() - 0.05) < 2e-3
    noisy = gimbal.simulate(demand, seed=3)
    again = gimbal.simulate(demand, seed=3)
    assert np.array_equal(noisy["measured_hub_rate_rad_s"], again["measured_hub_rate_rad_s"])
    with pytest.raises(cp.CounterpoiseError, match="different lengths"):
        gimbal.simulate(demand, np.zeros(10))


def test_a_mistake_names_file_line_and_remedy(gimbal):
    with pytest.raises(cp.ProjectError) as caught:
        gimbal.set("plant.inertia", -1.0).model()
    finding = caught.value.findings[0]
    assert finding.severity == "error" and finding.line > 0 and finding.file.endswith("project.toml")
    assert "inertia" in finding.path and "-1" in finding.found
    with pytest.raises(cp.CounterpoiseError, match="no-such-folder"):
        cp.Project.load("no-such-folder/project.toml")


def test_other_threads_go_on_and_progress_is_told(gimbal):
    ticks, stages, is_done = [], [], threading.Event()

    def tick():
        while not is_done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.005)

    thread = threading.Thread(target=tick)
    thread.start()
    gimbal.design(progress=lambda *step: stages.append(step))
    is_done.set()
    thread.join()
    assert len(ticks) > 20 and len(stages) >= 3
    assert all(0 <= done <= of for _, done, of in stages)


def test_a_diagnosis_tells_no_more_than_all_of_a_stage():
    project = cp.Project.load(EXAMPLES / "left-out-friction")
    steps = []

    def stop_after_screening(stage, done, of):
        steps.append((stage, done, of))
        if stage == "screening" and done == of:
            raise StopIteration

    with pytest.raises(StopIteration):
        project.diagnose([EXAMPLES / "left-out-friction"], progress=stop_after_screening)
    assert steps and all(0 <= done <= of for _, done, of in steps)


def test_ctrl_c_ends_long_work():
    call = f"import counterpoise as cp; p = cp.Project.load({str(EXAMPLES / 'reference-rig')!r}); print('go', flush=True); p.design()"
    work = subprocess.Popen([sys.executable, "-c", call], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    work.stdout.readline()
    time.sleep(0.5)
    work.send_signal(signal.SIGINT)
    start = time.perf_counter()
    _, said = work.communicate(timeout=60)
    assert "KeyboardInterrupt" in said and time.perf_counter() - start < 5.0


def test_code_is_written(gimbal, tmp_path):
    names = {pathlib.Path(path).name for path in gimbal.export(tmp_path)}
    assert {"controller.c", "controller.h", "controller.json"} <= names
    assert all((tmp_path / name).stat().st_size > 0 for name in ("controller.c", "controller.json"))


def test_a_controller_made_elsewhere_runs(tmp_path):
    control = pytest.importorskip("control")
    signal = pytest.importorskip("scipy.signal")
    text = """format = 2
[plant]
name = "axis"
inertia = 0.5
friction = { pivot = { viscous = 0.8 } }
drive = { kind = "torque", limit = 25.0 }
interface = { sample_period = 1e-3 }
"""
    made = control.tf([4.0, 12.0], [1.0, 0.0])
    forms = {
        "tf": made,
        "ss": control.ss(made),
        "sampled": control.c2d(made, 1e-3, "tustin"),
        "zpk": signal.ZerosPolesGain([-3.0], [0.0], 4.0),
        "scipy": signal.TransferFunction([4.0, 12.0], [1.0, 0.0]),
    }
    wanted = control.evalfr(forms["sampled"], np.exp(1e-3j * 9.0))
    for name, form in forms.items():
        cp.write_controller(tmp_path / f"{name}.json", form)
        (tmp_path / "axis.toml").write_text(text)
        project = cp.Project.load(tmp_path / "axis.toml").set("synth.controller.file", f"{name}.json")
        path = project.synth().to_control("paths.feedback")
        assert abs(control.evalfr(path, np.exp(1e-3j * 9.0)) / wanted - 1) < 1e-9, name
    with pytest.raises(ValueError, match="sample time"):
        cp.write_controller(tmp_path / "none.json", control.StateSpace([], [], [], [[1.0]], None))


def test_a_project_is_saved_as_it_was_written(gimbal, tmp_path):
    gimbal.save(tmp_path / "project.toml")
    saved = cp.Project.load(tmp_path)
    assert saved.text == gimbal.text and saved.check()["warnings"] == []


def test_reading_a_key_and_a_small_equation_cost_little(gimbal):
    def seconds(call, count=2000):
        call()
        start = time.perf_counter()
        for _ in range(count):
            call()
        return (time.perf_counter() - start) / count

    # figures, not limits: a busy machine is slower
    print(f"get {1e6 * seconds(lambda: gimbal.get('plant.inertia')):.1f} us")
    A, B, Q = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [1.0]]), np.eye(2)
    print(f"care {1e6 * seconds(lambda: cp.care(A, B, Q)):.1f} us")


SWEEP = """
[sweep]
samples = 12
seed = 1

[[sweep.variation]]
parameter = "hub_inertia"
low = 0.8
high = 1.2
"""


def test_a_campaign_has_a_row_a_mechanism(gimbal):
    swept = cp.Project.from_text(gimbal.text + SWEEP, EXAMPLES / "direct-gimbal").sweep()
    samples = swept["samples"]
    assert samples["sample"] == list(range(12)) and 0 <= swept["passing"] <= 12
    factor = np.array(samples["factor.hub_inertia"])
    assert ((factor >= 0.8) & (factor <= 1.2)).all() and factor.std() > 0.05
    for row in swept["figures"]:
        values = np.array(samples[row["figure"]])
        assert values.min() <= row["median"] <= values.max() and 0 <= row["share"] <= 1
    assert len(swept.to_pandas("figures")) == len(swept["figures"])
    assert swept["figures"] and len(swept.to_pandas("samples")) == 12


def test_a_map_is_that_of_the_linear_model_where_the_machine_is_linear(gimbal):
    found = gimbal.frequency_response_map([0.05], [2.0, 5.0], loop="closed")
    for point in found["maps"][0]["points"]:
        assert abs(complex(*point["response"]) - complex(*point["linear"])) < 0.02
    with pytest.raises(cp.CounterpoiseError, match="no loop"):
        gimbal.frequency_response_map([0.05], [2.0], loop="open")
    with pytest.raises(cp.CounterpoiseError, match="positive"):
        gimbal.frequency_response_map([0.05], [])


def test_triangle_waves_tell_of_friction_and_amplifier():
    folder = EXAMPLES / "amplifier-curve"
    project = cp.Project.load(folder)
    found, better = project.identify(folder / "balanced", folder / "midpoint")
    low, high = found["coulomb_nm"]["ci95"]
    assert low < found["coulomb_nm"]["value"] < high
    assert found["amplifier"]["outcome"] == "curve" and better.text != project.text
    assert len(better.model()["poles_rad_s"]) == len(project.model()["poles_rad_s"])


def test_the_command_line_is_in_the_package(gimbal, tmp_path):
    def run(*arguments):
        return subprocess.run(
            [sys.executable, "-m", "counterpoise", *arguments], capture_output=True, text=True, cwd=tmp_path
        )

    done = run("export", str(EXAMPLES / "direct-gimbal"), "-o", "code")
    assert done.returncode == 0 and (tmp_path / "code" / "controller.c").exists(), done.stderr
    gimbal.export(tmp_path / "same")
    for name in ("controller.c", "controller.json"):
        assert (tmp_path / "code" / name).read_bytes() == (tmp_path / "same" / name).read_bytes()
    assert run("design", "no-such-folder").returncode == 2
    assert "Usage" in run("--help").stdout
    assert "studio" in run("studio").stderr


def test_progress_is_a_line_on_a_terminal(gimbal, capsys):
    bar = cp.ProgressBar()
    gimbal.design(progress=bar)
    bar.close()
    assert "\r" in capsys.readouterr().err
