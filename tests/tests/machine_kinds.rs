//! Every kind of machine: what is left out of its file, its code, and recordings of it under its own controller.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, OnceLock};

use counterpoise_controller::Controller;
use counterpoise_models::{ControlledQuantity, Plant};
use counterpoise_pipeline::exchange::verified_loop;
use counterpoise_pipeline::results::{SynthResult, VerifyResult};
use counterpoise_pipeline::{
    PipelineError, PlantModel, SynthesisedDesign, World, build_plant_model, export, reduce_plant, synthesise,
    verify, with_chosen_weights,
};
use counterpoise_project::resolve::design::Language;
use counterpoise_project::starters::StarterKind;
use counterpoise_project::{Attachments, Document, ParsedProject, Project, Purpose};
use counterpoise_recordings::{Channel, Recording};
use counterpoise_report::results::verification::VerifiedAxes;
use counterpoise_report::results::{SynthText, VerifyText};
use counterpoise_report::wording::code_header::HeaderText;
use counterpoise_report::wording::errors::describe_pipeline_error;
use counterpoise_report::{VerificationContext, html_page, of_verification};
use counterpoise_simulate::replay::{ChannelFit, RecordedController, ReplayLoop, Replayer};
use counterpoise_simulate::signal::{Signal, Sine};
use counterpoise_simulate::{Detail, Imperfections, Initial, PlatformMotion, Scenario, Simulator};
use counterpoise_synth::LimitKind;
use counterpoise_verify::VerifiedController;

/// The examples of one kind of machine each.
const EXAMPLES: [&str; 4] = ["direct-gimbal", "belt-antenna", "servo-pendulum", "ball-screw"];

struct Machine {
    name: String,
    document: Document,
    attachments: Attachments,
}

impl Machine {
    fn read(path: &Path) -> Self {
        let name = path.display().to_string();
        let document = Document::from_bytes(&std::fs::read(path).unwrap(), &name).unwrap();
        let folder = path.parent().unwrap();
        let attachments = document.attachments().into_iter().fold(Attachments::none(), |all, name| {
            match std::fs::read(folder.join(&name)) {
                Ok(bytes) => all.with(&name, bytes),
                Err(_) => all,
            }
        });
        Self { name, document, attachments }
    }

    fn starter(kind: StarterKind) -> Self {
        let document = Document::parse(kind.text(), "project.toml");
        Self { name: format!("starter {}", kind.name()), document, attachments: Attachments::none() }
    }

    fn from_text((name, text): (&str, &str)) -> Self {
        let document = Document::parse(text, "project.toml");
        Self { name: name.to_owned(), document, attachments: Attachments::none() }
    }

    fn resolve_document(&self, document: &Document) -> Result<ParsedProject, Vec<String>> {
        Project::resolve_for(document, &self.attachments, Purpose::Design)
            .map_err(|errors| errors.iter().map(ToString::to_string).collect())
    }

    fn project(&self) -> Project {
        self.resolve_document(&self.document).unwrap().project
    }
}

fn example(name: &str) -> Machine {
    Machine::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(name).join("project.toml"))
}

/// Kinds that no example and no starter has.
const OTHERS: [(&str, &str); 9] = [
    (
        "loop of speed on the encoder of a geared motor",
        "format = 2
         plant.inertia = 1.2
         plant.gearbox = { ratio = 20.0, stiffness = \"20 kN m/rad\" }
         plant.motor = { inertia = 2e-4, torque_constant = 0.15 }
         plant.drive = { kind = \"current\", limit = 12.0 }
         plant.sensors.encoder = { place = \"motor\", counts = 20000, reads = \"rate\" }
         plant.interface = { sample_period = 1e-3 }",
    ),
    (
        "five inertias in a chain",
        "format = 2
         plant.motor = { inertia = 2e-4 }
         plant.gearbox = { ratio = 60.0, stiffness = 4e4 }
         plant.drive = { limit = 3.0 }
         plant.sensors.encoder = { counts = 4194304 }
         plant.interface = { sample_period = 1e-3 }
         [plant.lumped]
         hub_inertia = 1.2
         beam_inertia = 0.8
         stiffness = 9e4
         chain = [{ inertia = 0.5, stiffness = 7e4 }, { inertia = 0.3, stiffness = 7e4 }, { inertia = 0.1, stiffness = 5e4 }]",
    ),
    (
        "cable drive with a current loop and a tachometer on the motor",
        "format = 2
         plant.inertia = 40.0
         plant.cable = { ratio = 30.0 }
         plant.motor = { inertia = 2e-3, torque_constant = 0.3 }
         plant.drive = { kind = \"current\", limit = 12.0, bandwidth = \"300 Hz\" }
         plant.sensors.tachometer = { place = \"motor\", noise = \"0.1 deg/s\" }
         plant.interface = { sample_period = 1e-3 }",
    ),
    (
        "harmonic drive in a cascade with an encoder on the motor",
        "format = 2
         synth.loop = \"cascade\"
         plant.inertia = 1.5
         plant.harmonic_drive = { ratio = 100.0, stiffness = 16e3, hysteresis = 2.0, kinematic_error = \"0.5 arcmin\" }
         plant.motor = { inertia = 5.5e-5, torque_constant = 0.11 }
         plant.drive = { kind = \"current\", limit = 8.0 }
         plant.sensors.encoder = { place = \"motor\", counts = 65536 }
         plant.interface = { sample_period = 0.5e-3 }",
    ),
    (
        "linear motor with a scale",
        "format = 2
         plant.axis = \"linear\"
         plant.mass = 6.0
         plant.motor = { torque_constant = 45.0 }
         plant.drive = { kind = \"current\", limit = 9.0 }
         plant.sensors.encoder = { resolution = 1e-6 }
         plant.interface = { sample_period = 0.25e-3 }
         verify.step.rate = 0.1",
    ),
    (
        "series elastic joint with a torque sensor against a spring",
        "format = 2
         plant.lumped = { hub_inertia = 0.3, position_stiffness = 60.0 }
         plant.gearbox = { ratio = 50.0, stiffness = 300.0 }
         plant.motor = { inertia = 6e-5, torque_constant = 0.1 }
         plant.drive = { kind = \"current\", limit = 15.0, bandwidth = \"800 Hz\" }
         plant.sensors.torque = { noise = 1e-4 }
         plant.interface = { sample_period = 1e-3 }",
    ),
    (
        "servo press with a load cell",
        "format = 2
         plant.axis = \"linear\"
         plant.lumped = { mass = 60.0, position_stiffness = 2e7 }
         plant.ball_screw = { lead = \"5 mm/rev\", stiffness = \"200 N/um\" }
         plant.motor = { inertia = 5e-4 }
         plant.drive = { limit = 8.0 }
         plant.sensors.torque = { noise = 5.0 }
         plant.interface = { sample_period = 0.5e-3 }",
    ),
    (
        "current loop of a motor on a voltage",
        "format = 2
         plant.inertia = 1.42e-5
         plant.motor = { torque_constant = 0.0302, resistance = 0.299, inductance = 8.23e-5 }
         plant.drive = { kind = \"voltage\", limit = 24.0 }
         plant.friction.pivot = { viscous = 5e-6 }
         plant.sensors.current = { noise = 1e-4 }
         plant.interface = { sample_period = 5e-5 }",
    ),
    (
        "direct drive with a resolver",
        "format = 2
         plant.inertia = 0.02
         plant.drive = { limit = 6.0 }
         plant.sensors.resolver = { noise = \"2 arcsec\", natural_frequency = 4000.0 }
         plant.interface = { sample_period = 0.5e-3 }",
    ),
];

/// One machine of each kind: the four examples, every file that `new --like` writes, and the others.
fn kinds() -> Vec<Machine> {
    let known = EXAMPLES.into_iter().map(example).chain(StarterKind::ALL.into_iter().map(Machine::starter));
    known.chain(OTHERS.map(Machine::from_text)).collect()
}

/// Every project file of the examples.
fn examples() -> Vec<Machine> {
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples")];
    let mut files: Vec<PathBuf> = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.file_name().is_some_and(|name| name == "project.toml") {
                files.push(path);
            }
        }
    }
    files.sort();
    files.iter().map(|path| Machine::read(path)).collect()
}

/// Every section and every key that a file states, in the order of the reference.
fn paths(machine: &Machine) -> Vec<String> {
    let sections = machine.project().statements();
    let keys = sections.iter().flat_map(|s| s.values.iter().map(move |v| format!("{}.{}", s.path, v.key)));
    let named = sections.iter().map(|s| s.path.clone()).filter(|path| !path.ends_with(']'));
    named.chain(keys).filter(|path| machine.document.source_text_at(path).is_some()).collect()
}

/// Returns what is wrong with the answer to a file without one key or section; `Ok` has the project if the file is read.
fn answer(machine: &Machine, path: &str) -> Result<Option<Project>, String> {
    let without = machine.document.remove(path).unwrap();
    match machine.resolve_document(&without) {
        Ok(parsed) => {
            let listed =
                parsed.assumptions.iter().any(|a| a.key == path || a.key.starts_with(&format!("{path}.")));
            let is_number = machine.project().with_number(path, 1.0).is_some();
            let is_physical = path.starts_with("plant.") && is_number && !path.contains('[');
            if is_physical && !listed {
                return Err(format!("{}: {path} is read, but not listed as assumed", machine.name));
            }
            Ok(Some(parsed.project))
        }
        Err(said) => {
            // the sentence speaks of the key, of its section, or of what else the section needs
            let parent = path.rsplit_once('.').map_or(path, |(parent, _)| parent);
            let names = |line: &String| line.contains(parent);
            if said.len() != 1 || !said.iter().any(names) {
                return Err(format!("{}: without {path}:\n    {}", machine.name, said.join("\n    ")));
            }
            Ok(None)
        }
    }
}

fn design_project(project: &Project) -> Result<(Project, SynthesisedDesign), PipelineError> {
    let chosen = with_chosen_weights(project)?;
    let project = chosen.map_or_else(|| project.clone(), |chosen| chosen.project);
    let modelled = build_plant_model(&project)?;
    let made = synthesise(&project, &modelled, &reduce_plant(&project, &modelled)?)?;
    Ok((project, made))
}

/// A machine of one kind with its design, which several tests use.
struct DesignedKind {
    name: String,
    project: Project,
    modelled: PlantModel,
    made: SynthesisedDesign,
    verified: OnceLock<VerifiedController>,
}

impl DesignedKind {
    /// Returns the verified controller; it is computed once.
    fn verified_controller(&self) -> &VerifiedController {
        self.verified.get_or_init(|| verify(&self.project, &self.modelled, &self.made, &EmptyWorld).unwrap())
    }
}

/// Returns the design of one machine of each kind; they are computed once.
fn designed_kinds() -> impl Iterator<Item = &'static DesignedKind> {
    static ALL: LazyLock<Vec<OnceLock<DesignedKind>>> =
        LazyLock::new(|| kinds().iter().map(|_| OnceLock::new()).collect());
    let design = |machine: &Machine| {
        let (project, made) = design_project(&machine.project()).unwrap();
        let modelled = build_plant_model(&project).unwrap();
        DesignedKind { name: machine.name.clone(), project, modelled, made, verified: OnceLock::new() }
    };
    ALL.iter().zip(kinds()).map(move |(kept, machine)| kept.get_or_init(|| design(&machine)))
}

/// Marsaglia's xorshift generator, for a sample that is the same in every run.
struct RandomGenerator(u64);

impl RandomGenerator {
    fn draw_below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % n.max(1)
    }
}

#[test]
fn a_file_without_any_one_key_is_read_or_asks_for_it_in_one_sentence() {
    let (mut wrong, mut count) = (Vec::new(), 0);
    for machine in examples().iter().chain(&StarterKind::ALL.map(Machine::starter)) {
        for path in paths(machine) {
            count += 1;
            wrong.extend(answer(machine, &path).err());
        }
    }
    assert!(count > 1000, "{count}");
    assert!(wrong.is_empty(), "{} of {count}:\n{}", wrong.len(), wrong.join("\n"));
}

/// Files without one key whose design is tried; all of them with `EVERY_KEY=1`.
const SAMPLE: usize = 12;

/// A bandwidth is lower if it is by this share: the search knows it to 0.7 %.
const LOWER: f64 = 0.015;

#[test]
fn a_quicker_clock_never_lowers_the_bandwidth_of_a_first_design() {
    let machine = example("ball-screw");
    let bandwidth = |period_s: f64| {
        let project = machine.project().with_number("plant.interface.sample_period", period_s).unwrap();
        with_chosen_weights(&project).unwrap().unwrap().first.bandwidth
    };
    let found = [1e-3, 5e-4, 2.5e-4, 1.25e-4].map(bandwidth);
    // where the clock is named as what limits, a quicker one has a higher bandwidth
    for two in found.windows(2).filter(|two| two[0].limited_by == [LimitKind::SampleRate]) {
        assert!(two[1].bandwidth_rad_s > 1.1 * two[0].bandwidth_rad_s, "what is named limits");
    }
    for two in found.windows(2) {
        let [slow, quick] = [two[0].bandwidth_rad_s, two[1].bandwidth_rad_s];
        assert!(quick > (1.0 - LOWER) * slow, "{slow} then {quick} rad/s");
    }
}

/// A table over a ball screw, read at the motor, with friction so small that it matters at rest alone.
const SCREW_TABLE: &str = r#"
[plant]
axis = "linear"
mass = "55 kg"
ball_screw = { lead = "5 mm", stiffness = "20 N/um", backlash = "2 um" }
motor = { inertia = "1.2 kg cm^2", torque_constant = "0.5 N m/A" }
friction.pivot = { viscous = 40.0, model = "coulomb", coulomb = "0.1 N" }
drive = { kind = "current", limit = "9 A", bandwidth = "900 Hz", delay = "0.1 ms" }
sensors = { encoder = { place = "motor", counts = "20 bit", delay = "0.05 ms", natural_frequency = "unlimited" } }
interface = { sample_period = "0.25 ms", output_delay_samples = 1 }
[synth]
loop = "cascade"
[verify]
step = { rate = "0.5 mm" }
"#;

#[test]
fn a_screw_of_twice_the_stiffness_has_nearly_the_bandwidth_of_the_softer() {
    let machine = Machine::from_text(("table over a screw", SCREW_TABLE));
    let bandwidth = |stiffness: f64| {
        let project = machine.project().with_number("plant.ball_screw.stiffness", stiffness).unwrap();
        with_chosen_weights(&project).unwrap().unwrap().first.bandwidth.bandwidth_rad_s
    };
    let [soft, stiff] = [2e7, 4e7].map(bandwidth);
    // Above 20 N/um the mode comes into a phase in which it harms, and the bandwidth falls a little before it rises again.
    assert!(soft > 300.0 && stiff > 0.85 * soft, "{soft} then {stiff} rad/s");
}

#[test]
fn a_file_without_one_key_that_is_read_is_designed_or_refused_with_what_to_change() {
    let mut left = Vec::new();
    for machine in kinds() {
        for path in paths(&machine) {
            if let Ok(Some(project)) = answer(&machine, &path) {
                left.push((format!("{} without {path}", machine.name), project));
            }
        }
    }
    let (mut random, mut wrong) = (RandomGenerator(20_261_123), Vec::new());
    let count = if std::env::var_os("EVERY_KEY").is_some() { left.len() } else { SAMPLE };
    for _ in 0..count {
        let (name, project) = left.swap_remove(random.draw_below(left.len()));
        let Err(why) = design_project(&project) else { continue };
        let said = describe_pipeline_error(&why);
        // a key of the machine, a weight of which the file states too few, or the clock that the machine left over would need
        let changes = ["plant.", "give the loop recovery", "sample faster"];
        if !changes.iter().any(|change| said.contains(change)) {
            wrong.push(format!("{name}: a refusal names what to change: {said}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_examples_of_the_kinds_have_fifteen_lines_and_the_starters_twenty_five() {
    for machine in EXAMPLES.map(example) {
        let lines = machine.document.text().lines().count();
        assert!(lines <= 15, "{}: {lines} lines", machine.name);
    }
    for kind in StarterKind::ALL {
        assert!(kind.text().lines().count() <= 25, "{}", kind.name());
    }
}

/// Sines of different frequencies: (amplitude, frequency in Hz).
fn sines(all: &[(f64, f64)]) -> Signal {
    let sine =
        |&(amplitude, hz): &(f64, f64)| Sine { amplitude, frequency_rad_s: TAU * hz, phase_rad: 0.4 * hz };
    Signal::Sines(all.iter().map(sine).collect())
}

/// The plant with a recorder's converters and noise where the file states ideal ones.
fn recorded_plant(project: &Project) -> Plant {
    let mut parameters = build_plant_model(project).unwrap().parameters;
    let size = project.verify.as_ref().unwrap().procedure.step.rate_rad_s.abs();
    parameters.interface.output_bits = parameters.interface.output_bits.min(16);
    let sensor = &mut parameters.sensors.hub_gyro;
    if sensor.resolution == 0.0 && sensor.noise_rms == 0.0 {
        sensor.noise_rms = 1e-3 * size;
    }
    Plant::from_lumped(&parameters).unwrap()
}

/// A recording of a machine under a controller, with noise and quantisation; the demand is a fraction of the verified step.
fn record(project: &Project, plant: &Plant, controller: &Controller) -> Recording {
    let size = project.verify.as_ref().unwrap().procedure.step.rate_rad_s;
    let scenario = Scenario {
        demand_rad_s: sines(&[(0.3 * size, 0.31), (0.1 * size, 1.7)]),
        platform: PlatformMotion::STILL,
        imperfections: Imperfections::NoiseAndQuantisation { seed: 5 },
        initial: Initial::Rest { hub_angle_rad: project.model.operating_point.hub_angle_rad },
        detail: Detail::Recording,
        ..Scenario::at_rest(6.0)
    };
    let mut runner = controller.runner();
    let history = Simulator::new(plant).unwrap().run(&mut runner, &scenario).unwrap();
    history.readings.recording("run", history.sample_period_s)
}

/// Ratio of residual to noise floor up to which a replay is that of the machine itself.
const REPLAYED: f64 = 1.5;

#[test]
fn every_kind_replays_what_it_recorded_under_its_own_controller() {
    let mut wrong = Vec::new();
    for machine in designed_kinds() {
        let plant = recorded_plant(&machine.project);
        let controller = machine.made.sampled.controller.clone();
        let recording = record(&machine.project, &plant, &controller);
        let control = ReplayLoop::from_controller(plant.parameters(), RecordedController::from(controller));
        let replay = Replayer::new(plant.parameters(), &recording).and_then(|r| match &control {
            ReplayLoop::Open => r.replay_open(plant.parameters()),
            ReplayLoop::Closed(_) => r.replay_plant(&plant, &control),
        });
        let Ok(replay) = replay else {
            wrong.push(format!("{}: {:?}", machine.name, replay.err()));
            continue;
        };
        let ratio = |fit: &ChannelFit| (fit.residual_over_floor(), fit.channel);
        let worst: (f64, Channel) =
            replay.channels.iter().map(ratio).max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        println!("{}: {} floors in {}", machine.name, worst.0, worst.1.name());
        if worst.0.is_nan() || worst.0 > REPLAYED {
            wrong.push(format!("{}: {} floors in {}", machine.name, worst.0, worst.1.name()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

struct EmptyWorld;

impl World for EmptyWorld {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        Err(format!("there is no {name}"))
    }
}

#[test]
fn every_kind_is_exported_in_every_language() {
    for machine in designed_kinds() {
        let mut project = machine.project.clone();
        project.export.languages = vec![Language::C99, Language::Rust, Language::Fmi];
        let exported =
            export(&project, &machine.modelled, machine.verified_controller(), &HeaderText, &EmptyWorld)
                .unwrap();
        assert!(exported.left_out.is_empty(), "{}: {:?}", machine.name, exported.left_out);
        assert!(exported.files.len() > 12, "{}", machine.name);
        let measured = project.plant.sensors.measured;
        let is_rate = !(measured.is_position() || measured.is_effort());
        for file in &exported.files {
            let named = file.text.contains(" hub_rate_rad_s");
            assert!(is_rate || !named, "{}: {} has hub_rate_rad_s", machine.name, file.name);
        }
    }
}

/// The names of figures and signals of a loop of a rate in rad/s.
const OF_A_RATE: [&str; 6] =
    ["hub rate", "hub_rate_rad_s", "hub_rms_rad_s", "hub_peak_rad_s", "demand_rad_s", "[rad/s]</th>"];

#[test]
fn results_and_report_name_what_the_loop_controls() {
    let mut wrong = Vec::new();
    for machine in designed_kinds() {
        let controlled = machine.project.plant.controlled_quantity();
        let verified = machine.verified_controller();
        let found = verified.verification();
        let plant = &machine.modelled.plant;
        let measured_on = verified_loop(plant, verified.controller(), &found.evidence.procedure).unwrap();
        let axis = VerifiedAxes { own: found, both: None };
        let results = [
            serde_json::to_string(&VerifyText::new(axis, VerifyResult::new(found, measured_on))).unwrap(),
            serde_json::to_string(&SynthText::from(SynthResult::from(&machine.made))).unwrap(),
            html_page(&of_verification(found, &[], VerificationContext::default())),
        ];
        let is_rate = controlled == ControlledQuantity::RATE;
        for (kind, text) in ["verify", "synth", "report"].into_iter().zip(&results) {
            assert!(text.len() > 10_000, "{}: {kind}", machine.name);
            let named = OF_A_RATE.iter().filter(|word| text.contains(*word));
            // rates of hub and tip are outputs of the plant in every loop that does not hold a position
            let own = named.filter(|word| kind != "synth" || !word.starts_with("hub_rate"));
            let own: Vec<_> = own.collect();
            if !is_rate && !own.is_empty() {
                wrong.push(format!("{}: {kind} has {own:?}", machine.name));
            }
            let name = if kind == "report" { controlled.name().to_owned() } else { controlled.signal() };
            if !text.contains(&name) && kind != "synth" {
                wrong.push(format!("{}: {kind} has no {name}", machine.name));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
