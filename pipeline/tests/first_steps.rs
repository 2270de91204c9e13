//! The response of a first design to a step of the demand that the project does not state, of a sensor's delay and of tolerances.

use counterpoise_controller::Controller;
use counterpoise_pipeline::first_design::ChosenWeights;
use counterpoise_pipeline::{build_plant_model, reduce_plant, synthesise, with_chosen_weights};
use counterpoise_project::{Attachments, Document, Project, Purpose};
use counterpoise_synth::{LimitKind, Unknown};
use counterpoise_verify::{LoopFigure, PerformanceFigure, Procedure, frequency_figures};

/// A stage on a linear motor: 40 kg, 1020 N, a scale of 1 nm.
const STAGE: &str = "format = 2
plant.axis = \"linear\"
plant.mass = \"40 kg\"
plant.motor = { torque_constant = \"68 N/A\" }
plant.drive = { kind = \"current\", limit = \"15 A\", bandwidth = \"1.5 kHz\" }
plant.sensors.encoder = { resolution = \"1 nm\" }
plant.interface.sample_period = \"100 us\"
";
fn read(text: &str) -> (Document, Project) {
    let document = Document::parse(text, "machine.toml");
    let parsed = Project::resolve_for(&document, &Attachments::none(), Purpose::Design).unwrap();
    (document, parsed.project)
}

fn choose_weights(text: &str) -> ChosenWeights {
    with_chosen_weights(&read(text).1).unwrap().unwrap()
}

fn step(chosen: &ChosenWeights) -> f64 {
    chosen.project.verify.as_ref().unwrap().procedure.step.rate_rad_s
}

#[test]
fn a_step_that_nobody_stated_limits_no_loop_and_one_that_is_stated_does() {
    let open = choose_weights(STAGE);
    let stated = choose_weights(&format!("{STAGE}verify.step.rate = 0.1\n"));
    let bandwidth = |chosen: &ChosenWeights| chosen.first.bandwidth.bandwidth_rad_s;
    assert_eq!(stated.first.bandwidth.limited_by, [LimitKind::Control]);
    assert_eq!(step(&stated), 0.1);
    // 0.1 m within 1020 N on 40 kg leave sqrt(1020 / 40 / 0.1) = 16 rad/s
    assert!(bandwidth(&stated) < 16.0, "{}", bandwidth(&stated));
    assert!(open.first.bandwidth.unknown.contains(&Unknown::Demand));
    assert!(!open.first.bandwidth.limited_by.contains(&LimitKind::Control));
    assert!(bandwidth(&open) > 50.0 * bandwidth(&stated), "{}", bandwidth(&open));
    // what is not known lowers the ceiling: structure, sensor and step, each by 0.7
    let ceiling = std::f64::consts::TAU * 1e4 / 20.0 * 0.7_f64.powi(3);
    assert!(bandwidth(&open) <= ceiling * 1.001, "{} {ceiling}", bandwidth(&open));
    // the step that it is verified by stays within the limit, and is read again from the saved file
    assert!(step(&open) * open.first.judgement.step_gain <= 10.0, "{}", step(&open));
    assert!(2.5 * step(&open) * open.first.judgement.step_gain > 10.0, "the next size exceeds it");
    let (document, project) = read(STAGE);
    let saved = open.project.update(&document, &project).unwrap();
    let again = read(saved.text()).1;
    let specification = |project: &Project| project.synth.as_ref().unwrap().specification.clone();
    assert_eq!(specification(&again), specification(&open.project));
    assert_eq!(again.verify, open.project.verify);
}

/// An inertia under a torque drive, with a gyroscope.
const TURRET: &str = "format = 2
plant.inertia = INERTIA
plant.motor = { inertia = 1e-4, torque_constant = TORQUE }
plant.drive = { kind = \"torque\", limit = 5.0 }
plant.sensors.hub_gyro = { noise = 1e-3, natural_frequency = 600, delay = DELAY }
plant.interface.sample_period = 1e-3
";

fn turret(inertia: &str, torque: &str, delay: &str) -> String {
    TURRET.replace("INERTIA", inertia).replace("TORQUE", torque).replace("DELAY", delay)
}

/// The margins of the controller that a file is given, on its sampled plant with every delay as it is.
fn verified_margins(text: &str) -> [f64; 3] {
    let project = choose_weights(text).project;
    let made = build_plant_model(&project).unwrap();
    let reduced = reduce_plant(&project, &made).unwrap();
    let designed = synthesise(&project, &made, &reduced).unwrap();
    let controller = &designed.sampled.controller;
    let found = frequency_figures(&made.plant, controller, &Procedure::default()).unwrap();
    assert!(found.is_stable);
    [LoopFigure::GainMargin, LoopFigure::PhaseMargin, LoopFigure::MaxSensitivity]
        .map(|figure| found.value(PerformanceFigure::Loop(figure)).unwrap())
}

#[test]
fn a_loop_is_judged_with_the_delay_of_its_sensor() {
    let mut last = f64::INFINITY;
    for delay in ["\"1 ms\"", "\"3 ms\"", "\"10 ms\"", "\"20 ms\""] {
        let text = turret("0.02", "0.5", delay);
        let first = choose_weights(&text).first;
        let reached = first.bandwidth.bandwidth_rad_s;
        assert!(reached < 0.9 * last, "{delay}: {reached} rad/s after {last}");
        last = reached;
        let [gain, phase, sensitivity] = verified_margins(&text);
        let judged = first.judgement;
        assert!((judged.gain_margin_db - gain).abs() < 0.1, "{delay}: {judged:?} {gain}");
        assert!((judged.phase_margin_deg - phase).abs() < 0.5, "{delay}: {judged:?} {phase}");
        assert!(
            (judged.max_sensitivity / sensitivity - 1.0).abs() < 0.01,
            "{delay}: {judged:?} {sensitivity}"
        );
    }
    assert!(last > 0.4 / 0.02, "a loop whose delay is 20 ms reaches {last} rad/s");
}

#[test]
fn a_first_design_holds_for_the_tolerances_of_its_file() {
    let exact = choose_weights(&turret("0.02", "0.5", "\"1 ms\""));
    let within = turret("{ value = 0.02, tolerance = 0.6 }", "{ value = 0.5, tolerance = 0.5 }", "\"1 ms\"");
    let held = choose_weights(&within);
    assert_eq!(held.first.bandwidth.limited_by, [LimitKind::Tolerances]);
    assert!(!exact.first.bandwidth.limits.iter().any(|limit| limit.kind == LimitKind::Tolerances));
    let synthesis = |project: &Project| {
        let made = build_plant_model(project).unwrap();
        let reduced = reduce_plant(project, &made).unwrap();
        synthesise(project, &made, &reduced).unwrap().sampled.controller
    };
    let worst = |controller: &Controller| {
        let ends = [0.4, 1.6].into_iter().flat_map(|inertia| [0.5, 1.5].map(|torque| (inertia, torque)));
        let sensitivity = |(inertia, torque): (f64, f64)| {
            let text = turret(&format!("{}", 0.02 * inertia), &format!("{}", 0.5 * torque), "\"1 ms\"");
            let plant = build_plant_model(&read(&text).1).unwrap().plant;
            let found = frequency_figures(&plant, controller, &Procedure::default()).unwrap();
            let peak = found.value(PerformanceFigure::Loop(LoopFigure::MaxSensitivity)).unwrap();
            if found.is_stable { peak } else { f64::INFINITY }
        };
        ends.map(sensitivity).fold(0.0, f64::max)
    };
    assert!(worst(&synthesis(&held.project)) < 2.01, "{}", worst(&synthesis(&held.project)));
    assert!(worst(&synthesis(&exact.project)) > 2.5, "the same machine without tolerances");
}

/// A load on a belt, driven by a motor of its own inertia, with an encoder on the load.
const BELT: &str = "format = 2
plant.inertia = 1.0
plant.motor = { inertia = 0.02 }
plant.drive = { kind = \"torque\", limit = \"50 N m\" }
plant.sensors.encoder = { counts = \"20 bit\" }
plant.interface = { sample_period = \"1 ms\", output_delay_samples = 1 }
verify.step.rate = 0.01
";

#[test]
fn what_is_not_known_is_taken_at_the_worst_that_is_usual() {
    let bandwidth = |text: &str| choose_weights(text).first.bandwidth.bandwidth_rad_s;
    let belt = |keys: &str| format!("{BELT}plant.belt = {{ ratio = 10.0{keys} }}\n");
    let open = choose_weights(&belt(""));
    let reached = open.first.bandwidth.bandwidth_rad_s;
    assert!(open.first.bandwidth.limits.iter().any(|limit| limit.kind == LimitKind::UsualRanges));
    // a belt at 5 Hz with the motor held is the softest that is usual
    let soft = (std::f64::consts::TAU * 5.0_f64).powi(2);
    for stiffer in [1.0, 4.0, 100.0] {
        let stated = bandwidth(&belt(&format!(", stiffness = {}", stiffer * soft)));
        // weights that are chosen with the stiffness known may be slower by a quarter
        assert!(
            reached < 1.25 * stated,
            "{stiffer}: {reached} rad/s, {stated} rad/s with the stiffness stated"
        );
    }
    // the design holds that belt with the sensitivity of its margins
    assert!(open.first.judgement.share_within_usual_ranges <= 1.0);
    assert!(open.first.judgement.share_within_usual_ranges > 0.5);
    // a gyroscope without noise is taken as a micromechanical one, 0.01 degrees a second per root of a hertz
    let heavy = turret("20.0", "0.5", "1e-3");
    let noise_rms = 1.7e-4 * (0.5_f64 / 1e-3).sqrt();
    let open = choose_weights(&heavy.replace("noise = 1e-3, ", "")).first;
    let stated =
        |noise: f64| choose_weights(&heavy.replace("1e-3, natural", &format!("{noise}, natural"))).first;
    assert!(open.bandwidth.unknown.contains(&Unknown::Noise));
    assert_eq!(open.bandwidth.limited_by, [LimitKind::Noise]);
    assert!(open.bandwidth.bandwidth_rad_s < 1.03 * stated(noise_rms).bandwidth.bandwidth_rad_s);
    assert!(open.bandwidth.bandwidth_rad_s < stated(0.1 * noise_rms).bandwidth.bandwidth_rad_s);
}

#[test]
fn what_is_stated_to_be_ideal_is_known() {
    let quick = "format = 2
plant.inertia = 1.0
plant.drive = { kind = \"torque\", limit = 5.0 }
plant.sensors.hub_gyro = { noise = 1e-3 }
plant.interface.sample_period = 1e-3
";
    let stated = quick
        .replace("noise = 1e-3", "noise = 1e-3, delay = 0.0")
        .replace("sample_period = 1e-3", "sample_period = 1e-3\nplant.interface.output_delay_samples = 0");
    let (open, known) = (choose_weights(quick), choose_weights(&stated));
    let bandwidth = |chosen: &ChosenWeights| chosen.first.bandwidth.bandwidth_rad_s;
    // A reading of a digital sensor may come 2 ms late, and a control a sample: each costs phase that a machine without them has.
    assert!(bandwidth(&known) > 1.3 * bandwidth(&open), "{} {}", bandwidth(&known), bandwidth(&open));
    let is_late = |fact: &Unknown| matches!(fact, Unknown::Sensor | Unknown::Delay);
    assert!(open.first.bandwidth.unknown.iter().any(is_late), "{:?}", open.first.bandwidth.unknown);
    assert!(!known.first.bandwidth.unknown.iter().any(is_late), "{:?}", known.first.bandwidth.unknown);
    // The facts stay known where the project is written anew.
    let project = read(&stated).1;
    assert_eq!(read(&project.to_text()).1, project);
    assert!(!project.assumptions().iter().any(|open| open.key.ends_with("delay")));
}

#[test]
fn a_rotor_of_which_nothing_is_known_makes_no_loop_quicker() {
    let bandwidth = |text: &str| choose_weights(text).first.bandwidth.bandwidth_rad_s;
    let belt =
        format!("{BELT}plant.belt = {{ ratio = 10.0 }}\n").replace("inertia = 0.02", "inertia = 0.001");
    let without = belt.replace("plant.motor = { inertia = 0.001 }\n", "");
    assert_ne!(belt, without);
    let (known, open) = (bandwidth(&belt), bandwidth(&without));
    // A belt that yields shows only between load and rotor: without a rotor the machine looked rigid.
    assert!(open <= 1.02 * known, "{open} {known}");
    let direct = turret("0.02", "0.5", "1e-3").replace("inertia = 1e-4, ", "");
    assert!(bandwidth(&direct) > 50.0, "a direct drive has no transmission that yields");
}

#[test]
fn requirements_on_the_loop_are_margins_of_a_first_design() {
    let required = |figure: &str, side: &str, limit: f64| {
        let text = turret("0.02", "0.5", "1e-3");
        format!("{text}[[verify.requirement]]\nfigure = \"{figure}\"\n{side} = {limit}\n")
    };
    let value = |text: &str, figure: LoopFigure| {
        let chosen = choose_weights(text);
        let made = build_plant_model(&chosen.project).unwrap();
        let reduced = reduce_plant(&chosen.project, &made).unwrap();
        let controller = synthesise(&chosen.project, &made, &reduced).unwrap().sampled.controller;
        let found = frequency_figures(&made.plant, &controller, &Procedure::default()).unwrap();
        found.value(PerformanceFigure::Loop(figure)).unwrap()
    };
    let free = turret("0.02", "0.5", "1e-3");
    for (figure, key, side, limit) in [
        (LoopFigure::DelayMargin, "delay_margin_s", "at_least", 0.02),
        (LoopFigure::DiskMargin, "disk_margin", "at_least", 1.3),
        (LoopFigure::MaxComplementary, "max_complementary_sensitivity", "at_most", 1.05),
        (LoopFigure::Crossover, "crossover_hz", "at_most", 5.0),
    ] {
        let (open, held) = (value(&free, figure), value(&required(key, side, limit), figure));
        let holds = |found: f64| if side == "at_least" { found >= limit } else { found <= 1.001 * limit };
        assert!(!holds(open), "{key} holds without being asked for: {open}");
        assert!(holds(held), "{key}: {held}, required {limit}");
    }
}

#[test]
fn an_overshoot_that_is_required_chooses_the_weights_unless_it_costs_the_bandwidth() {
    let overshoot = |limit: f64| {
        let figure = "nonlinear_step_overshoot_percent";
        let text = turret("0.02", "0.5", "1e-3");
        let text = format!("{text}[[verify.requirement]]\nfigure = \"{figure}\"\nat_most = {limit}\n");
        choose_weights(&text).first
    };
    let (free, held) = (overshoot(90.0), overshoot(2.0));
    assert!(free.judgement.overshoot > 0.04, "{:?}", free.judgement);
    assert!(held.judgement.overshoot <= 0.02, "{:?}", held.judgement);
    assert!(held.bandwidth.bandwidth_rad_s > 0.9 * free.bandwidth.bandwidth_rad_s, "{:?}", held.bandwidth);
    // Two integrators overshoot whatever the weights are.
    let position = |limit: f64| {
        let text = format!(
            "format = 2
plant.inertia = 0.5
plant.drive = {{ kind = \"torque\", limit = 40.0 }}
plant.sensors.encoder = {{ counts = \"18 bit\", delay = 1e-4 }}
plant.interface = {{ sample_period = 1e-3, output_delay_samples = 1 }}
verify.requirement = [{{ figure = \"linear_step_overshoot_percent\", at_most = {limit} }}]
"
        );
        choose_weights(&text).first.bandwidth.bandwidth_rad_s
    };
    assert!(position(5.0) > 0.99 * position(90.0));
}

#[test]
fn a_loop_of_position_keeps_more_phase_than_the_usual_shapes_leave() {
    let text = "format = 2
plant.inertia = 0.5
plant.drive = { kind = \"torque\", limit = 40.0 }
plant.sensors.encoder = { counts = \"18 bit\", delay = 1e-4 }
plant.interface = { sample_period = 1e-3, output_delay_samples = 1 }
[[verify.requirement]]
figure = \"phase_margin_deg\"
at_least = 60
";
    let first = choose_weights(text).first;
    assert!(first.judgement.phase_margin_deg >= 60.0, "{:?}", first.judgement);
    assert!(first.bandwidth.bandwidth_rad_s > 5.0, "{}", first.bandwidth.bandwidth_rad_s);
}

/// A direct drive with a gyroscope of which everything is stated but the stiffness of its structure.
const DIRECT: &str = "format = 2
plant.lumped.hub_inertia = \"0.02 kg m^2\"
plant.motor = { torque_constant = \"0.3 N m/A\" }
plant.drive = { kind = \"current\", limit = \"5 A\", bandwidth = \"unlimited\", delay = 0.0 }
plant.sensors.hub_gyro = { noise = \"0.01 deg/s\", delay = \"0 ms\", natural_frequency = \"unlimited\" }
plant.interface = { sample_period = \"250 us\", output_delay_samples = 0 }
verify.step.rate = 0.05
";

#[test]
fn a_structure_that_is_stated_rigid_is_known_and_stays_so_when_it_is_saved() {
    let open = choose_weights(DIRECT);
    assert_eq!(open.first.bandwidth.unknown, [Unknown::Structure]);
    let stated = format!("{DIRECT}plant.lumped.stiffness = \"rigid\"\n");
    let rigid = choose_weights(&stated);
    assert_eq!(rigid.first.bandwidth.unknown, []);
    let rates = [&open, &rigid].map(|chosen| chosen.first.bandwidth.bandwidth_rad_s);
    assert!(rates[1] > 1.1 * rates[0], "{rates:?}");
    let (document, project) = read(&stated);
    let saved = rigid.project.update(&document, &project).unwrap();
    assert!(saved.text().contains("stiffness = \"rigid\""), "{}", saved.text());
    let whole = Project::parse(&project.to_text(), "written.toml").unwrap().project;
    assert_eq!(whole.plant, project.plant);
}

#[test]
fn delays_of_a_control_and_of_its_drive_are_open_each_by_itself() {
    let file = |drive: &str, control: &str| {
        format!(
            "format = 2
plant.inertia = 0.4
plant.motor = {{ torque_constant = 0.3 }}
plant.drive = {{ kind = \"current\", limit = 9.0{drive} }}
plant.sensors.hub_gyro = {{ noise = \"0.002 deg/s\", delay = 1e-3 }}
plant.interface = {{ sample_period = 1e-3{control} }}
verify.step.rate = 1e-3
"
        )
    };
    let [drive, control] = [", delay = 1e-4", ", output_delay_samples = 1"];
    let reached = |drive, control| choose_weights(&file(drive, control)).first.bandwidth.bandwidth_rad_s;
    let stated = reached(drive, control);
    for (drive, control) in [("", control), (drive, ""), ("", "")] {
        let open = reached(drive, control);
        assert!(open <= 1.03 * stated, "{drive} {control}: {open} against {stated}");
    }
}

#[test]
fn limits_that_raise_nothing_alone_are_those_that_the_loop_uses_up() {
    // A screw's stiffness is known, the lag of its sensor is not, and a spring holds the slide.
    let screw = "format = 2
plant.axis = \"linear\"
plant.lumped = { mass = \"3 kg\", position_stiffness = \"50 N/mm\" }
plant.ball_screw = { lead = \"5 mm\", stiffness = \"50 N/um\" }
plant.motor.inertia = \"0.1 kg cm^2\"
plant.drive.limit = \"1 N m\"
plant.sensors.torque.noise = \"1 N\"
plant.interface.sample_period = \"0.5 ms\"
";
    let found = choose_weights(screw).first.bandwidth;
    let used = |kind: &LimitKind| found.limits.iter().find(|limit| limit.kind == *kind).and_then(|l| l.used);
    assert!(found.limits.iter().all(|limit| limit.used.is_some_and(|used| (0.0..=1.0).contains(&used))));
    let is_nearly_used_up = |kind: &LimitKind| used(kind).is_some_and(|used| used > 0.94);
    assert!(found.limits.iter().all(|limit| limit.lifted_rad_s.is_none()), "{found:?}");
    assert!(found.limited_by.iter().all(is_nearly_used_up), "{found:?}");
    assert!(!found.limited_by.contains(&LimitKind::SampleRate), "{found:?}");
}
