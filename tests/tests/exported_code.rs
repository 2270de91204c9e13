//! The reference rig's controller as generated code, in the simulated loop: on this machine, and on a Cortex-M4F under
//! QEMU. Every control that the code gives is the reference's, to the last bit, so the whole motion is.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs, non_snake_case)]

#[path = "../../export/tests/support/mod.rs"]
mod support;

use std::path::{Path, PathBuf};
use std::process::Command;

use counterpoise_controller::{Controller, SampledController};
use counterpoise_export::Source::Unverified;
use counterpoise_export::{
    FixedRunner, Options, Precision, Ranges, c99, fixed_c99, plan, rust_crate, single_precision,
};
use counterpoise_models::plant::Plant;
use counterpoise_project::Project;
use counterpoise_project::pipeline::export::compare;
use counterpoise_project::pipeline::{World, model, reduce, synthesise, verify};
use counterpoise_simulate::{Imperfections, PlatformMotion, Scenario, Signal, Simulator, TimeHistory};
use support::{InLoop, STRICT, Target, folder, is_there, provenance, run, server, write};

fn project() -> Project {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/reference-rig/project.toml");
    let text = std::fs::read_to_string(file).unwrap();
    Project::parse(&text, "project.toml").map_err(|errors| errors[0].to_string()).unwrap().project
}

/// Plant and controller of the shipped example.
fn reference_rig() -> (Plant, Controller) {
    let project = project();
    let modelled = model(&project).unwrap();
    let reduced = reduce(&project, &modelled).unwrap();
    let made = synthesise(&project, &modelled, &reduced).unwrap();
    (modelled.plant, made.sampled.controller)
}

/// Steps of demand on a platform that heaves and pitches, with noise and quantisation.
fn scenario(duration_s: f64) -> Scenario {
    let platform = PlatformMotion {
        heave_m_s2: Signal::sine(1.0, 9.0),
        pitch_rate_rad_s: Signal::sine(0.1, 7.0),
        ..PlatformMotion::STILL
    };
    Scenario {
        demand_rad_s: Signal::step(0.2, 0.1),
        platform,
        imperfections: Imperfections::NoiseAndQuantisation { seed: 5 },
        ..Scenario::still(duration_s)
    }
}

fn drive(plant: &Plant, controller: &mut dyn SampledController, duration_s: f64) -> TimeHistory {
    Simulator::new(plant).unwrap().run(controller, &scenario(duration_s)).unwrap()
}

/// Compiles the C for this machine.
fn compiled(test: &str, controller: &Controller, precision: Precision) -> PathBuf {
    let folder = folder(test);
    let options = Options { name: "controller".into(), precision };
    write(&folder, &c99(Unverified(controller), &provenance(), &options).unwrap());
    std::fs::write(folder.join("server.c"), server(&["controller".into()])).unwrap();
    let sources = ["server.c", "controller.c", "-o", "server"];
    run(Command::new("cc").current_dir(&folder).args(STRICT).args(sources));
    folder.join("server")
}

#[test]
fn c_in_the_simulated_loop_moves_the_rig_as_the_reference_does() {
    if !is_there("cc") {
        return println!("skipped: no C compiler");
    }
    let (plant, controller) = reference_rig();
    let double = compiled("rig_double", &controller, Precision::Double);
    let expected = drive(&plant, &mut controller.runner(), 2.0);
    assert_eq!(drive(&plant, &mut InLoop(Target::start(&double)), 2.0), expected);
    let single = compiled("rig_single", &controller, Precision::Single);
    let expected = drive(&plant, &mut controller.runner_in::<f32>(), 2.0);
    assert_eq!(drive(&plant, &mut InLoop(Target::start(&single)), 2.0), expected);
}

#[test]
fn a_processor_in_the_simulated_loop_moves_the_rig_as_the_reference_does() {
    if !is_there("arm-none-eabi-gcc") || !is_there("qemu-system-arm") {
        return println!("skipped: no cross compiler or no emulator");
    }
    let (plant, controller) = reference_rig();
    let folder = folder("rig_processor");
    let files = c99(Unverified(&controller), &provenance(), &Options::single("controller")).unwrap();
    write(&folder, &files);
    std::fs::write(folder.join("server.c"), server(&["controller".into()])).unwrap();
    let board = Path::new(env!("CARGO_MANIFEST_DIR")).join("../export/target");
    let core = ["-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"];
    let link = ["-std=gnu99", "-O2", "-ffp-contract=off", "-nostartfiles", "--specs=rdimon.specs", "-T"];
    run(Command::new("arm-none-eabi-gcc")
        .current_dir(&folder)
        .args(core)
        .args(link)
        .arg(board.join("mps2.ld"))
        .arg(board.join("startup.c"))
        .args(["server.c", "controller.c", "-lm", "-o", "firmware.elf"]));
    let mut emulator = Command::new("qemu-system-arm");
    emulator.args(["-M", "mps2-an386", "-nographic", "-monitor", "none", "-serial", "none"]);
    emulator
        .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
        .arg(folder.join("firmware.elf"));
    let found = drive(&plant, &mut InLoop(Target::launch(&mut emulator)), 1.0);
    assert_eq!(found, drive(&plant, &mut controller.runner_in::<f32>(), 1.0));
}

/// What a smaller arithmetic costs: in volts before the converter, and in the hub's motion.
#[test]
fn single_and_fixed_move_the_rig_nearly_as_the_reference_does() {
    let (plant, controller) = reference_rig();
    let expected = drive(&plant, &mut controller.runner(), 4.0);
    let histories = [readings(&expected)];
    let samples = histories[0].len();
    let known = Ranges::from_readings(&controller, &histories, 4.0);
    let half_step = 0.5 * 20.0 / 4096.0;
    let fixed = plan(&controller, &known, half_step, samples).unwrap();
    let single = single_precision(&controller, &known, samples);
    let (mut reference_run, mut single_run, mut fixed_run) =
        (controller.runner(), controller.runner_in::<f32>(), FixedRunner::new(&fixed));
    let (mut single_worst, mut fixed_worst) = (0.0_f64, 0.0_f64);
    for readings in &histories[0] {
        let control = reference_run.step_array(readings);
        single_worst = single_worst.max((single_run.step_array(readings) - control).abs());
        fixed_worst = fixed_worst.max((fixed_run.step_array(readings) - control).abs());
    }
    println!("single: {single_worst:.1e} V measured, {single:?}");
    println!("fixed: {fixed_worst:.1e} V measured, {:?}", fixed.deviation);
    assert!(single_worst <= single.worst_v && fixed_worst <= fixed.deviation.worst_v);
    assert!(single_worst < half_step && single.rms_v < 0.1 * half_step);
    let rms = |run: &TimeHistory| {
        let rates = &run.truth.hub_rate_rad_s[1000..];
        let error = |rate: &f64| (rate - 0.1).powi(2);
        (rates.iter().map(error).sum::<f64>() / rates.len() as f64).sqrt()
    };
    let reference = rms(&expected);
    let mut acting: [(&str, Box<dyn SampledController>); 2] =
        [("single", Box::new(controller.runner_in::<f32>())), ("fixed", Box::new(FixedRunner::new(&fixed)))];
    for (name, controller) in &mut acting {
        let cost_db = 20.0 * (rms(&drive(&plant, controller.as_mut(), 4.0)) / reference).log10();
        println!("{name}: hub rate error {cost_db:+.4} dB against double");
        assert!(cost_db.abs() < 0.1, "{name}: {cost_db}");
    }
}

/// The example's folder.
struct Example;

impl World for Example {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/reference-rig");
        std::fs::read(folder.join(name)).map_err(|error| error.to_string())
    }
}

#[test]
fn the_targets_stand_side_by_side_in_every_experiment_of_the_verification() {
    let project = project();
    let modelled = model(&project).unwrap();
    let reduced = reduce(&project, &modelled).unwrap();
    let made = synthesise(&project, &modelled, &reduced).unwrap();
    let verified = verify(&project, &modelled, &made, &Example).unwrap();
    let found = compare(&project, &modelled, &verified, &Example).unwrap();
    assert_eq!(found.figures.len(), 3);
    for target in &found.figures {
        assert!(target.measured_v <= target.predicted.worst_v, "{target:?}");
        for each in &target.experiments {
            println!("{:?} {:?}: {:+.4} dB", target.numbers, each.experiment, each.cost_db);
            assert!(each.cost_db.abs() < 0.5, "{each:?}");
        }
    }
}

fn readings(run: &TimeHistory) -> Vec<[f64; 6]> {
    let r = &run.readings;
    let at = |k: usize| {
        [
            r.demand_rad_s[k],
            r.hub_rate_rad_s[k],
            r.platform_rate_rad_s[k],
            r.platform_accel_m_s2[k],
            r.motor_rate_rad_s[k],
            r.hub_position_rad[k],
        ]
    };
    (0..run.len()).map(at).collect()
}

#[test]
fn every_language_of_the_example_compiles_without_a_word() {
    let (plant, controller) = reference_rig();
    let run_of = drive(&plant, &mut controller.runner(), 2.0);
    let known = Ranges::from_readings(&controller, &[readings(&run_of)], 4.0);
    let fixed = plan(&controller, &known, 1e-2, run_of.len()).unwrap();
    let folder = folder("rig_languages");
    write(&folder, &rust_crate(Unverified(&controller), &provenance(), &Options::double("axis")).unwrap());
    let rust = ["--edition=2021", "--crate-type=lib", "-Dwarnings", "axis/src/lib.rs"];
    run(Command::new("rustc").current_dir(&folder).args(rust));
    if !is_there("cc") {
        return println!("C skipped: no compiler");
    }
    write(&folder, &fixed_c99(Unverified(&controller), &fixed, &provenance(), "fixed").unwrap());
    let sources = ["fixed.c", "fixed_self_test.c", "fixed_test.c", "-o", "fixed_test"];
    assert_eq!(run(Command::new("cc").current_dir(&folder).args(STRICT).args(sources)), "");
    run(&mut Command::new(folder.join("fixed_test")));
}
