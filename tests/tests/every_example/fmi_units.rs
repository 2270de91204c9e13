//! Controller and plant as FMI 3.0 units, closed into a loop by FMPy, against the studio's own loop.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use counterpoise_controller::{Controller, Parts, PathSignal as ControlSignal, ProportionalIntegral};
use counterpoise_export::ExportSource::Unverified;
use counterpoise_export::fmi::{PlantUnit, controller_unit, pack_unit, plant_unit};
use counterpoise_export::{CodeOptions, File};
use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};
use counterpoise_models::plant::{OperatingPoint, Plant};
use counterpoise_pipeline::{PlantModel, World, build_plant_model, export, reduce_plant, synthesise, verify};
use counterpoise_project::resolve::controller::RecordingController;
use counterpoise_project::{Attachments, Document, Project, SettingValue};
use counterpoise_report::wording::code_header::HeaderText;
use counterpoise_simulate::signal::Sine;
use counterpoise_simulate::{Firing, PlatformMotion, Scenario, Signal, Simulator, TimeHistory};
use counterpoise_tests::examples;

use crate::every_example::support::{self, STRICT, folder, is_there, provenance, run, write};

/// Two sines that begin without a slope: the unit goes on in the straight line through its last two inputs, and at the
/// start there is only one.
fn swing(amplitude: f64, frequency_rad_s: f64) -> Signal {
    let sine = |amplitude, frequency_rad_s| Sine { amplitude, frequency_rad_s, phase_rad: 0.0 };
    Signal::Sines(vec![sine(amplitude, frequency_rad_s), sine(-0.5 * amplitude, 2.0 * frequency_rad_s)])
}

/// A step of demand on a platform that heaves and pitches; ideal converters.
fn scenario() -> Scenario {
    let platform = PlatformMotion {
        heave_m_s2: swing(0.5, 9.0),
        pitch_rate_rad_s: swing(0.05, 7.0),
        ..PlatformMotion::STILL
    };
    // the unit fires at the instants that the machine states
    let firing = Firing::Stated;
    Scenario { demand_rad_s: Signal::step(0.2, 0.1), platform, firing, ..Scenario::at_rest(2.0) }
}

fn csv(run: &TimeHistory) -> String {
    let mut text = "time,demand,heave,pitch_rate,control,hub_rate\n".to_owned();
    let (r, t) = (&run.readings, &run.truth);
    for (k, time) in run.time_s().iter().enumerate() {
        let (demand, heave, pitch) = (r.demand_rad_s()[k], t.heave_m_s2()[k], t.platform_rate_rad_s()[k]);
        let (control, rate) = (r.control_request_v()[k], t.hub_rate_rad_s()[k]);
        writeln!(text, "{time:?},{demand:?},{heave:?},{pitch:?},{control:?},{rate:?}").unwrap();
    }
    text
}

/// A unit's library for this machine, compiled without a word.
fn compile_unit(folder: &Path, name: &str, files: &[File]) -> Vec<u8> {
    write(folder, files);
    let own = [format!("{name}/sources/{name}.c"), format!("{name}/sources/fmu.c")];
    let library = format!("{name}.so");
    let link = ["-fPIC", "-shared", "-ffp-contract=off", "-lm", "-o", &library];
    assert_eq!(run(Command::new("cc").current_dir(folder).args(STRICT).args(&own).args(link)), "");
    std::fs::read(folder.join(library)).unwrap()
}

/// Writes the units of a controller and of a plant, and what the studio's own loop of them does.
fn write_loop(folder: &Path, plant: &Plant, controller: &Controller, scenario: &Scenario) {
    let axis = controller_unit(Unverified(controller), &provenance(), &CodeOptions::double("axis")).unwrap();
    let rig = plant_unit(PlantUnit { plant, name: "rig" }, &provenance()).unwrap();
    let expected = Simulator::new(plant).unwrap().run(&mut controller.runner(), scenario).unwrap();
    std::fs::create_dir_all(folder).unwrap();
    std::fs::write(folder.join("expected.csv"), csv(&expected)).unwrap();
    for (name, files) in [("axis", &axis), ("rig", &rig)] {
        let library = compile_unit(folder, name, files);
        std::fs::write(folder.join(format!("{name}.fmu")), pack_unit(files, name, Some(&library))).unwrap();
    }
}

/// Writes the loop of an example, or nothing if it has no controller.
fn write_example(path: &Path, folder: &Path) {
    if let Some(designed) = examples::design_example(path) {
        write_loop(folder, &designed.modelled.plant, &designed.made.sampled.controller, &scenario());
    }
}

/// Closes the loops in FMPy; each must be the studio's.
fn in_fmpy(folders: &[PathBuf]) {
    let python = Command::new("python3").args(["-c", "import fmpy"]).output();
    if !python.is_ok_and(|output| output.status.success()) {
        return support::report_skip("FMPy missing (pip install fmpy)");
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/fmi/check.py");
    println!("{}", run(Command::new("python3").arg(script).args(folders)));
}

#[test]
fn the_loop_that_fmpy_closes_is_the_simulated_one_for_examples() {
    if !is_there("cc") {
        return support::report_skip("no C compiler");
    }
    let all = folder("fmi_loop");
    let files = examples::chosen_files();
    let place = |path: &PathBuf| all.join(examples::name(path));
    counterpoise_tests::run_in_parallel(files.len(), &|k| {
        write_example(&files[k], &place(&files[k]));
    });
    let folders: Vec<PathBuf> = files.iter().map(place).filter(|folder| folder.is_dir()).collect();
    assert!(folders.len() >= 8, "{folders:?}");
    in_fmpy(&folders);
}

/// The examples tried here need no file beside their own.
struct EmptyWorld;

impl World for EmptyWorld {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        Err(format!("{name} is not needed"))
    }
}

#[test]
fn a_plant_without_a_unit_leaves_the_rest_of_the_code_there() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/appendix-5/chapter-6.toml");
    let text = std::fs::read_to_string(file).unwrap();
    let text = text.replace("languages = [\"c99\"]", "languages = [\"fmi\", \"c99\"]");
    let project = Project::parse(&text, "project.toml").unwrap().project;
    let modelled = build_plant_model(&project).unwrap();
    let reduced = reduce_plant(&project, &modelled).unwrap();
    let made = synthesise(&project, &modelled, &reduced).unwrap();
    let verified = verify(&project, &modelled, &made, &EmptyWorld).unwrap();
    let whole = export(&project, &modelled, &verified, &HeaderText, &EmptyWorld).unwrap();
    assert!(whole.left_out.is_empty());
    let mut parameters = modelled.plant.parameters().clone();
    parameters.interface.output_delay_samples = 20_000;
    let late = PlantModel { plant: Plant::from_lumped(&parameters).unwrap(), ..modelled };
    let rest = export(&project, &late, &verified, &HeaderText, &EmptyWorld).unwrap();
    let units = |files: &[File], name: &str| files.iter().filter(|file| file.name.contains(name)).count();
    assert_eq!((units(&whole.files, "_plant/"), units(&rest.files, "_plant/")), (5, 0));
    assert_eq!(rest.files.len() + 5, whole.files.len());
    let said: Vec<String> = rest.left_out.iter().map(ToString::to_string).collect();
    let expected = "FMI unit of the plant: delay in samples = 20002: the generated plant keeps at most 10000";
    assert_eq!(said, [expected]);
}

/// Keys of the practice machines' project files with what each machine truly has, beside its plain model.
fn practice() -> Vec<(&'static str, Vec<(&'static str, SettingValue)>)> {
    let number = |key, value| (key, SettingValue::Number(value));
    let curve = [[0.22, 0.48], [0.51, 0.96], [0.8, 1.86], [1.04, 2.79], [2.0, 6.0]];
    vec![
        (
            "p01",
            vec![
                number("plant.friction.pivot.static_ratio", 1.55),
                number("plant.friction.pivot.stribeck_rate", 0.012),
            ],
        ),
        ("p02", vec![number("plant.gearbox.backlash", 6e-3)]),
        ("p03", vec![("plant.amplifier.map", SettingValue::Pairs(curve.to_vec()))]),
        ("p04", vec![number("plant.lumped.out_of_balance", 186.0)]),
        (
            "p05",
            vec![number("plant.motor.cogging.amplitude", 0.16), number("plant.motor.cogging.order", 6.0)],
        ),
        ("p06", vec![("plant.interface.output_delay_samples", SettingValue::Whole(6))]),
        (
            "p07",
            vec![
                number("plant.lumped.position_stiffness", 900.0),
                number("plant.lumped.position_stiffness_centre", -0.04),
            ],
        ),
        ("p08", Vec::new()),
    ]
}

/// Proportional and integral control of the hub rate, with the control that holds the machine.
fn plain_controller(plant: &Plant, gains: &ProportionalIntegral) -> Controller {
    let period_s = plant.parameters().interface.sample_period_s;
    let held = plant.equilibrium(&OperatingPoint::default()).control_v;
    let moment = plant.body().out_of_balance_kg_m;
    let mut parts = Parts::new(period_s, 10.0);
    parts.design_out_of_balance_kg_m = moment;
    parts.out_of_balance_range_kg_m = (moment - 1.0, moment + 1.0);
    parts.bias_v_per_kg_m = if moment == 0.0 { 0.0 } else { held / moment };
    let one = |x: f64| Mat::from_rows(&[&[x]]);
    let (kp, ki) = (gains.kp_v_s_rad, gains.ki_v_rad);
    let timebase = Timebase::Discrete { period_s };
    let system = StateSpace::new(one(1.0), one(ki * period_s), one(1.0), one(kp), timebase).unwrap();
    parts.paths = vec![support::path("feedback", vec![ControlSignal::RateError], system)];
    Controller::new(parts).unwrap()
}

#[test]
fn the_loop_that_fmpy_closes_is_the_simulated_one_for_every_practice_machine() {
    let recordings = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/practice");
    if !is_there("cc") {
        return support::report_skip("no C compiler");
    }
    let all = folder("fmi_practice");
    let mut folders = Vec::new();
    for (name, truth) in practice() {
        let text = std::fs::read_to_string(recordings.join(name).join("project.toml")).unwrap();
        let document = truth
            .iter()
            .fold(Document::parse(&text, name), |file, (key, value)| file.set(key, value).unwrap());
        let project = Project::resolve(&document, &Attachments::none()).unwrap().project;
        let plant = Plant::from_lumped(&project.plant).unwrap();
        let controller = plain_controller(
            &plant,
            project
                .recording_controller
                .as_ref()
                .and_then(RecordingController::as_proportional_integral)
                .unwrap(),
        );
        folders.push(all.join(name));
        write_loop(&all.join(name), &plant, &controller, &scenario());
    }
    in_fmpy(&folders);
}
