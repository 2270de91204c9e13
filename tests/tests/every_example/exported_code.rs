//! The reference rig's controller as generated code, in the simulated loop: on this machine, and on a Cortex-M4F under
//! QEMU. Every control that the code gives is the reference's, to the last bit, so the whole motion is.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

use counterpoise_controller::{Controller, READINGS, SampledController};
use counterpoise_export::ExportSource::Unverified;
use counterpoise_export::board::{CORES, TargetCore};
use counterpoise_export::host::{RUST_COMPILER, RUST_CRATE, count_differing, encode_requests, rust_replay};
use counterpoise_export::{
    CodeOptions, File, FixedRunner, Numbers, Precision, Ranges, Targets, c99, fixed_c99, plan_fixed_point,
    rust_crate, single_precision,
};
use counterpoise_models::plant::Plant;
use counterpoise_pipeline::export::run_targets;
use counterpoise_pipeline::project_procedure;
use counterpoise_simulate::{Imperfections, PlatformMotion, Scenario, Signal, Simulator, TimeHistory};
use counterpoise_tests::examples;

use crate::every_example::support::{
    FixedInLoop, InLoop, STRICT, Target, folder, is_there, provenance, run, server, server_in, write,
};
use crate::every_example::target;

/// Plant and controller of the shipped example.
fn reference_rig() -> (Plant, Controller) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/reference-rig/project.toml");
    let designed = examples::design_example(&file).unwrap();
    (designed.modelled.plant.clone(), designed.made.sampled.controller.clone())
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
        ..Scenario::at_rest(duration_s)
    }
}

fn drive(plant: &Plant, controller: &mut dyn SampledController, duration_s: f64) -> TimeHistory {
    Simulator::new(plant).unwrap().run(controller, &scenario(duration_s)).unwrap()
}

/// Compiles the C for this machine.
fn compile_controller(test: &str, controller: &Controller, precision: Precision) -> PathBuf {
    let folder = folder(test);
    let options = CodeOptions { name: "controller".into(), precision };
    write(&folder, &c99(Unverified(controller), &provenance(), &options).unwrap());
    std::fs::write(folder.join("server.c"), server(&["controller".into()])).unwrap();
    let sources = ["server.c", "controller.c", "-o", "server"];
    run(Command::new("cc").current_dir(&folder).args(STRICT).args(sources));
    folder.join("server")
}

#[test]
fn c_in_the_simulated_loop_moves_the_rig_as_the_reference_does() {
    if !is_there("cc") {
        return crate::every_example::support::report_skip("no C compiler");
    }
    let (plant, controller) = reference_rig();
    let double = compile_controller("rig_double", &controller, Precision::Double);
    let expected = drive(&plant, &mut controller.runner(), 2.0);
    assert_eq!(drive(&plant, &mut InLoop(Target::start(&double)), 2.0), expected);
    let single = compile_controller("rig_single", &controller, Precision::Single);
    let expected = drive(&plant, &mut controller.runner_in::<f32>(), 2.0);
    assert_eq!(drive(&plant, &mut InLoop(Target::start(&single)), 2.0), expected);
}

#[test]
fn a_processor_in_the_simulated_loop_moves_the_rig_as_the_reference_does() {
    if !is_there("arm-none-eabi-gcc") || !is_there("qemu-system-arm") {
        return crate::every_example::support::report_skip("no cross compiler or no emulator");
    }
    let (plant, controller) = reference_rig();
    let folder = folder("rig_processor");
    let files = c99(Unverified(&controller), &provenance(), &CodeOptions::single("controller")).unwrap();
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

/// The cost of a smaller arithmetic: in volts before the converter, and in the hub's motion.
#[test]
fn single_and_fixed_move_the_rig_nearly_as_the_reference_does() {
    let (plant, controller) = reference_rig();
    let expected = drive(&plant, &mut controller.runner(), 4.0);
    let histories = [readings(&expected)];
    let samples = histories[0].len();
    let known = Ranges::from_readings(&controller, &histories, 4.0);
    let half_step = 0.5 * 20.0 / 4096.0;
    let fixed = plan_fixed_point(&controller, &known, half_step, samples).unwrap();
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
        let rates = &run.truth.hub_rate_rad_s()[1000..];
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

fn readings(run: &TimeHistory) -> Vec<[f64; READINGS]> {
    let r = &run.readings;
    let at = |k: usize| {
        [
            r.demand_rad_s()[k],
            r.hub_rate_rad_s()[k],
            r.platform_rate_rad_s()[k],
            r.platform_accel_m_s2()[k],
            r.motor_rate_rad_s()[k],
            r.hub_position_rad()[k],
            0.0,
        ]
    };
    (0..run.len()).map(at).collect()
}

/// Returns the design of an example; `None` if its machine is not to be controlled.
fn design_of(path: &Path) -> Option<Design> {
    let designed = examples::design_example(path)?;
    let (project, modelled) = (&designed.project, &designed.modelled);
    let world = examples::world(path);
    let verified = examples::verify_example(path)?;
    let compared = run_targets(modelled, &verified, &project_procedure(project, &world).unwrap()).unwrap();
    let name = examples::name(path);
    let controller = designed.made.sampled.controller.clone();
    Some(Design { name, plant: modelled.plant.clone(), controller, compared })
}

/// Examples with a controller, at least.
const EXAMPLES: usize = 8;
/// The example of which more is asked.
const REFERENCE: &str = "reference-rig_project";

/// Examples whose code the analysers and the compilers of the targets read in the default tests, and whose Rust is compiled: feedforwards, and a
/// cascade. They read the code of every example if it is asked for.
const ANALYSED: [&str; 2] = [REFERENCE, "servo-pendulum_project"];

/// Factor by which a prediction may exceed what is measured.
const LOOSE: f64 = 20.0;

struct Design {
    name: String,
    plant: Plant,
    controller: Controller,
    compared: Targets,
}

impl Design {
    /// Everything that is claimed of an example's generated code.
    fn is_right(&self, cores: &[TargetCore]) {
        self.within_prediction();
        if self.name == REFERENCE {
            self.costs_nothing_in_any_numbers();
        }
        let is_analysed = ANALYSED.contains(&self.name.as_str()) || examples::every_one_is_asked_for();
        if is_analysed {
            self.rust_answers_alike();
        }
        for (numbers, folder) in self.kinds() {
            let sources = ["axis.c", "axis_self_test.c", "axis_test.c", "-o", "axis_test"];
            assert_eq!(run(Command::new("cc").current_dir(&folder).args(STRICT).args(sources)), "");
            assert!(run(&mut Command::new(folder.join("axis_test"))).contains("equal to the last bit"));
            self.same_motion(numbers, &folder);
            let own = ["axis.c", "axis_self_test.c", "axis_interrupt.c"].map(str::to_owned);
            if is_analysed {
                cores.iter().for_each(|core| drop(target::compile(core, &folder, &own)));
                analyse_folder(&folder);
            }
        }
    }

    /// The reference rig has all three kinds of numbers, and none costs rejection in any experiment of its verification.
    fn costs_nothing_in_any_numbers(&self) {
        assert_eq!(self.compared.figures.len(), 3);
        for target in &self.compared.figures {
            assert!(target.measured_v <= target.predicted.worst_v, "{target:?}");
            for each in &target.experiments {
                let cost_db = each.cost_db.unwrap();
                println!("{:?} {:?}: {cost_db:+.4} dB", target.numbers, each.experiment);
                assert!(cost_db.abs() < 0.5, "{each:?}");
            }
        }
    }

    /// All generated C, each kind in a folder of its own.
    fn kinds(&self) -> Vec<(Numbers, PathBuf)> {
        let c = &self.controller;
        let mut kinds = vec![
            (Numbers::Double, c99(Unverified(c), &provenance(), &CodeOptions::double("axis")).unwrap()),
            (Numbers::Single, c99(Unverified(c), &provenance(), &CodeOptions::single("axis")).unwrap()),
        ];
        match &self.compared.fixed {
            Ok(fixed) => {
                kinds.push((Numbers::Fixed, fixed_c99(Unverified(c), fixed, &provenance(), "axis").unwrap()));
            }
            Err(why) => println!("{}: no fixed-point form: {why}", self.name),
        }
        let place = |(numbers, files): (Numbers, Vec<File>)| {
            let folder = folder(&format!("example_{}_{numbers:?}", self.name));
            write(&folder, &files);
            (numbers, folder)
        };
        kinds.into_iter().map(place).collect()
    }

    /// The server of one kind, compiled for this machine.
    fn server_target(&self, numbers: Numbers, folder: &Path) -> Target {
        let main = match numbers {
            Numbers::Fixed => server_in(&["axis".into()], |_| "int32_t".into()),
            _ => server(&["axis".into()]),
        };
        std::fs::write(folder.join("server.c"), main).unwrap();
        let sources = ["server.c", "axis.c", "-o", "server"];
        run(Command::new("cc").current_dir(folder).args(STRICT).args(sources));
        Target::start(&folder.join("server"))
    }

    /// The C in the simulated loop moves the plant as its model in this program does.
    fn same_motion(&self, numbers: Numbers, folder: &Path) {
        let target = self.server_target(numbers, folder);
        let (mut code, mut own): (Box<dyn SampledController>, Box<dyn SampledController>) = match numbers {
            Numbers::Double => (Box::new(InLoop(target)), Box::new(self.controller.runner())),
            Numbers::Single => (Box::new(InLoop(target)), Box::new(self.controller.runner_in::<f32>())),
            Numbers::Fixed => {
                let fixed = self.compared.fixed.as_ref().unwrap();
                (Box::new(FixedInLoop::new(target, fixed)), Box::new(FixedRunner::new(fixed)))
            }
        };
        let expected = drive(&self.plant, own.as_mut(), 0.5);
        assert!(drive(&self.plant, code.as_mut(), 0.5) == expected, "{} {numbers:?}", self.name);
    }

    /// The Rust crate compiles without a word, passes its own tests, and answers every reading of the closed loops of the
    /// verification's experiments as its model does.
    fn rust_answers_alike(&self) {
        let folder = folder(&format!("example_{}_rust", self.name));
        write(
            &folder,
            &rust_crate(Unverified(&self.controller), &provenance(), &CodeOptions::double("axis")).unwrap(),
        );
        write(&folder, &[rust_replay(self.controller.parts().reading_count())]);
        let rustc =
            |arguments: &[&str]| run(Command::new(RUST_COMPILER).current_dir(&folder).args(arguments));
        let name = format!("--crate-name={RUST_CRATE}");
        let library = ["--edition=2021", "--crate-type=lib", &name, "-Dwarnings", "axis/src/lib.rs"];
        assert_eq!(rustc(&library), "");
        assert_eq!(rustc(&["--edition=2021", "-L.", "-Dwarnings", "-o", "replay", "replay.rs"]), "");
        let library = format!("axis=lib{RUST_CRATE}.rlib");
        let tests = ["--edition=2021", "--test", "--extern", &library, "-Dwarnings", "axis/tests/vectors.rs"];
        assert_eq!(rustc(&tests), "");
        assert!(run(&mut Command::new(folder.join("vectors"))).contains("1 passed"));
        let records = &self.compared.figures[0].closed_loops;
        std::fs::write(folder.join("readings"), encode_requests(records, None)).unwrap();
        let readings = std::fs::File::open(folder.join("readings")).unwrap();
        let output = Command::new(folder.join("replay")).stdin(readings).output().unwrap();
        let samples: usize = records.iter().map(|record| record.controls_v.len()).sum();
        assert!(samples > 1000);
        assert_eq!(count_differing(records, None, &output.stdout), Some((samples, 0)), "{}", self.name);
    }

    /// Every kind of numbers is there. Deviations stay within what was predicted and not far below, and the closed loop where
    /// it was.
    fn within_prediction(&self) {
        match &self.compared.fixed {
            Ok(_) => {}
            Err(why) => panic!("{}: no fixed-point form: {why}", self.name),
        }
        for target in &self.compared.figures {
            let (found, predicted) = (target.measured_v, &target.predicted);
            println!(
                "{} {:?}: {found:.1e} V of {:.1e}, RMS {:.1e} V of {:.1e}",
                self.name, target.numbers, predicted.likely_v, target.measured_rms_v, predicted.rms_v
            );
            assert!(found <= predicted.likely_v, "{}: {target:?}", self.name);
            assert!(predicted.likely_v <= LOOSE * found, "{}: {target:?}", self.name);
            assert!(target.measured_rms_v <= 3.0 * predicted.rms_v, "{}: {target:?}", self.name);
            for each in &target.experiments {
                // A loop that stands still in double may creep by what the numbers resolve, and no more.
                let good = each.cost_db.map_or(each.error_rms_rad_s < 1e-6, |cost| cost < 0.5);
                assert!(good, "{}: {:?} {each:?}", self.name, target.numbers);
            }
        }
    }
}

#[test]
fn the_code_of_examples_compiles_in_silence_and_moves_the_plant_alike() {
    if !is_there("cc") {
        return crate::every_example::support::report_skip("no C compiler");
    }
    for program in ["clang", "cppcheck"].into_iter().filter(|program| !is_there(program)) {
        crate::every_example::support::report_skip(&format!(
            "analysis: no {program} (apt install {program})"
        ));
    }
    let cores = if target::tools_are_there() { &CORES[..] } else { &[] };
    let files = examples::chosen_files();
    let tried = Mutex::new(Vec::new());
    counterpoise_tests::run_in_parallel(files.len(), &|k| match design_of(&files[k]) {
        Some(design) => {
            design.is_right(cores);
            tried.lock().unwrap().push(design.name);
        }
        None => println!("{} has no controller: it tells of data", files[k].display()),
    });
    let tried = tried.into_inner().unwrap();
    assert!(tried.len() >= EXAMPLES, "{tried:?}");
    assert!(tried.iter().any(|name| name == REFERENCE), "{tried:?}");
}

/// Clang's analyser and cppcheck over everything that was generated into a folder: not a word, nothing suppressed. Clang alone takes a second
/// for each kind of numbers.
fn analyse_folder(folder: &Path) {
    if is_there("clang") {
        let flags = ["--analyze", "-Xanalyzer", "-analyzer-output=text", "-std=c99", "-Wall", "-Wextra"];
        let sources = ["axis.c", "axis_self_test.c", "axis_test.c", "axis_interrupt.c"];
        assert_eq!(run(Command::new("clang").current_dir(folder).args(flags).args(sources)), "");
    }
    if is_there("cppcheck") {
        let flags = ["--std=c99", "--quiet", "--enable=warning,style,performance,portability"];
        let sources = ["--error-exitcode=1", "axis.c", "axis_self_test.c", "axis_test.c", "axis_interrupt.c"];
        assert_eq!(run(Command::new("cppcheck").current_dir(folder).args(flags).args(sources)), "");
    }
}

/// Instructions that the guard may take for each number that the controller keeps: about a dozen, and the loop over them.
const GUARD_OF_STATE: usize = 14;
/// Instructions that the guard may take for each reading: two limits, the last good value, three counts and flags, a call.
const GUARD_OF_READING: usize = 60;

/// What one step of the reference rig's controller needs: a product and a sum are an instruction each, a coefficient is
/// loaded for each product, a state loaded and stored; the rest, at most half as much again, is addresses, limits, call.
/// The guard comes on top: each number that is kept is loaded, its size taken, compared with the smallest that matters,
/// stored and summed, and each reading is compared with its limits, with the one before, and counted.
#[test]
fn the_reference_rigs_step_costs_what_its_multiplications_need() {
    if !target::tools_are_there() {
        return;
    }
    let (_, controller) = reference_rig();
    let step = &controller.programs().step;
    let states = controller.programs().state_count();
    let needed = (2 * step.multiplications() + step.additions() + 2 * states) as u64;
    let guard = (GUARD_OF_STATE * states + GUARD_OF_READING * controller.parts().reading_count()) as u64;
    let files = c99(Unverified(&controller), &provenance(), &CodeOptions::single("axis")).unwrap();
    let found = target::cost(&CORES[0], "reference_rig", ("axis", Numbers::Single), &files);
    println!("{} multiplications, {} additions, {states} states", step.multiplications(), step.additions());
    println!("about {needed} instructions needed and at most {guard} for the guard, {found:?}");
    assert!(found.step_instructions < 2000);
    assert!(found.step_instructions > needed && found.step_instructions < needed + needed / 2 + guard);
}

#[test]
fn every_language_of_the_example_compiles_without_a_word() {
    let (plant, controller) = reference_rig();
    let run_of = drive(&plant, &mut controller.runner(), 2.0);
    let known = Ranges::from_readings(&controller, &[readings(&run_of)], 4.0);
    let fixed = plan_fixed_point(&controller, &known, 1e-2, run_of.len()).unwrap();
    let folder = folder("rig_languages");
    write(
        &folder,
        &rust_crate(Unverified(&controller), &provenance(), &CodeOptions::double("axis")).unwrap(),
    );
    let rust = ["--edition=2021", "--crate-type=lib", "-Dwarnings", "axis/src/lib.rs"];
    run(Command::new("rustc").current_dir(&folder).args(rust));
    if !is_there("cc") {
        return crate::every_example::support::report_skip("C: no compiler");
    }
    write(&folder, &fixed_c99(Unverified(&controller), &fixed, &provenance(), "fixed").unwrap());
    let sources = ["fixed.c", "fixed_self_test.c", "fixed_test.c", "-o", "fixed_test"];
    assert_eq!(run(Command::new("cc").current_dir(&folder).args(STRICT).args(sources)), "");
    run(&mut Command::new(folder.join("fixed_test")));
}
