//! Steps of every size on machines with a loop of position: however large, they settle as the smallest do.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_lti::margins;
use counterpoise_models::Plant;
use counterpoise_pipeline::{
    SynthesisedDesign, build_plant_model, reduce_plant, synthesise, with_chosen_weights,
};
use counterpoise_project::{Attachments, Document, Project, Purpose};
use counterpoise_simulate::{Initial, Scenario, Signal, Simulator};

/// Largest overshoot of a large step beyond that of a small one, as a fraction of the step.
const MORE_OVERSHOOT: f64 = 0.05;
/// Largest error at the end, as a fraction of the step.
const SETTLED: f64 = 0.02;
/// Durations after the ramp within which a step settles, over the reciprocal of the loop's bandwidth.
const SETTLING: f64 = 80.0;

/// A machine as a file, and its range in rad or m.
struct Machine {
    name: &'static str,
    text: String,
    range: f64,
}

const TURNING: &str = "format = 2
    plant.interface = { sample_period = 1e-3 }
    plant.inertia = 2.0
    plant.friction = { pivot = { viscous = 0.5 } }";
const SLIDING: &str = "format = 2
    plant.interface = { sample_period = 1e-3 }
    plant.axis = \"linear\"
    plant.mass = 70.0";

/// Transmissions, with what the motor needs beside them.
const TRANSMISSIONS: [(&str, &str); 5] = [
    ("direct", ""),
    (
        "gearbox",
        "plant.gearbox = { ratio = 50.0, stiffness = 2e5 }\nplant.motor = { inertia = 3e-4, torque_constant = 0.2, resistance = 1.0 }",
    ),
    (
        "belt",
        "plant.belt = { ratio = 8.0, stiffness = 4e3 }\nplant.motor = { inertia = 0.01, torque_constant = 0.4, resistance = 1.0 }",
    ),
    (
        "cable",
        "plant.cable = { ratio = 20.0, stiffness = 6e4 }\nplant.motor = { inertia = 1e-3, torque_constant = 0.3, resistance = 1.0 }",
    ),
    (
        "harmonic drive",
        "plant.harmonic_drive = { ratio = 100.0, stiffness = 3e4, hysteresis = 3.0 }\nplant.motor = { inertia = 6e-5, torque_constant = 0.1, resistance = 1.0 }",
    ),
];

/// Drives with their limits.
const DRIVES: [&str; 3] = [
    "plant.drive = { kind = \"torque\", limit = LIMIT }",
    "plant.drive = { kind = \"current\", limit = 10.0, bandwidth = 2000.0 }",
    "plant.drive = { kind = \"voltage\", limit = 48.0 }",
];

fn machines() -> Vec<Machine> {
    let mut all = Vec::new();
    for (k, (name, transmission)) in TRANSMISSIONS.into_iter().enumerate() {
        // each transmission with another drive, the loop and the sensor's place in turn
        for (i, kind) in ["position", "cascade"].into_iter().enumerate() {
            let drive = if k == 0 { DRIVES[0] } else { DRIVES[(k + i) % 3] };
            let limit = if k == 0 { "40.0" } else { "2.0" };
            let place = if k > 0 && i == 1 { "motor" } else { "load" };
            let drive = drive.replace("LIMIT", limit);
            let sensor = format!("plant.sensors.encoder = {{ place = \"{place}\", counts = 16777216 }}");
            let text = format!("{TURNING}\nsynth.loop = \"{kind}\"\n{transmission}\n{drive}\n{sensor}");
            all.push(Machine { name, text, range: 12.0 });
        }
    }
    let screw = "plant.ball_screw = { lead = 0.02, stiffness = 1e8 }\nplant.motor = { inertia = 4e-4 }\nplant.drive = { limit = 6.0 }";
    for kind in ["position", "cascade"] {
        let sensor = "plant.sensors.encoder = { place = \"motor\", counts = 1048576 }";
        let text = format!("{SLIDING}\nsynth.loop = \"{kind}\"\n{screw}\n{sensor}");
        all.push(Machine { name: "ball screw", text, range: 1.0 });
        let sensor =
            "plant.sensors.encoder = { resolution = 1e-7 }\nplant.motor = { torque_constant = 60.0 }";
        let drive = "plant.drive = { kind = \"current\", limit = 15.0 }";
        let text = format!("{SLIDING}\nsynth.loop = \"{kind}\"\n{drive}\n{sensor}");
        all.push(Machine { name: "linear motor", text, range: 2.0 });
    }
    all
}

fn design_project(text: &str) -> (Project, Plant, SynthesisedDesign) {
    let document = Document::parse(text, "project.toml");
    let parsed = Project::resolve_for(&document, &Attachments::none(), Purpose::Design);
    let project = parsed.unwrap_or_else(|errors| panic!("{text}: {errors:?}")).project;
    let project = with_chosen_weights(&project).unwrap().map_or(project, |chosen| chosen.project);
    let modelled = build_plant_model(&project).unwrap();
    let made = synthesise(&project, &modelled, &reduce_plant(&project, &modelled).unwrap()).unwrap();
    (project, modelled.plant, made)
}

/// Overshoot and error at the end of a step, as fractions of it.
struct Answer {
    overshoot: f64,
    left: f64,
}

fn answer(plant: &Plant, made: &SynthesisedDesign, (size, duration_s): (f64, f64), start: f64) -> Answer {
    let scenario = Scenario {
        demand_rad_s: Signal::Sum(vec![Signal::Constant(start), Signal::step(0.05, size)]),
        initial: Initial::Rest { hub_angle_rad: start },
        ..Scenario::at_rest(duration_s)
    };
    let run = Simulator::new(plant).unwrap().run(&mut made.sampled.controller.runner(), &scenario).unwrap();
    let reached = |y: &f64| (y - start) / size - 1.0;
    let errors: Vec<f64> = run.readings.hub_rate_rad_s().iter().map(reached).collect();
    let last = &errors[errors.len() * 9 / 10..];
    Answer {
        overshoot: errors.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        left: last.iter().map(|e| e.abs()).fold(0.0, f64::max),
    }
}

#[test]
fn steps_of_every_size_settle_as_the_smallest_does() {
    let mut wrong = Vec::new();
    for machine in machines() {
        let (_, plant, made) = design_project(&machine.text);
        let rate = made.demanded_rate.unwrap().rate;
        let crossings = margins(&made.sampled.loop_gain).unwrap().phase;
        let slowest = crossings.iter().map(|c| c.rate_rad_s).fold(f64::INFINITY, f64::min);
        let settle_s = SETTLING / slowest;
        let step = plant.parameters().sensors.hub_gyro.resolution;
        // within a tenth of a ramp's distance over the bandwidth the linear loop alone acts
        let small = (0.1 * rate / slowest).max(1000.0 * step);
        let usual = answer(&plant, &made, (small, settle_s), 0.0).overshoot;
        let mut size = 1e-4_f64;
        while size <= machine.range {
            let found = answer(&plant, &made, (size, settle_s + 1.2 * size / rate), 0.0);
            let rounding = 3.0 * step / size;
            let what = format!(
                "{} {size}: overshoot {:.3} (small step {usual:.3}), left {:.4}",
                machine.name, found.overshoot, found.left
            );
            if !(found.overshoot <= usual.max(0.0) + MORE_OVERSHOOT + rounding
                && found.left <= SETTLED + rounding)
            {
                wrong.push(what);
            }
            size *= 10.0;
        }
        println!("{}: at most {rate:.4} a second", machine.name);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A machine that stands away from where its controller starts does not move before it is asked to, and the limit that the file states
/// is kept.
#[test]
fn a_stated_limit_is_kept_and_a_start_elsewhere_is_no_step() {
    // the machine overshoots the rate of a ramp as it overshoots a step
    for (kind, more) in [("position", 1.5), ("cascade", 1.5)] {
        let limited = format!(
            "{TURNING}\nsynth = {{ loop = \"{kind}\", rate_limit = 0.2 }}\nplant.drive = {{ limit = 40.0 }}\nplant.sensors.encoder = {{ counts = 16777216 }}"
        );
        let (_, plant, made) = design_project(&limited);
        assert_eq!(made.demanded_rate.unwrap().rate, 0.2);
        let scenario = Scenario { demand_rad_s: Signal::step(0.05, 1.0), ..Scenario::at_rest(8.0) };
        let run =
            Simulator::new(&plant).unwrap().run(&mut made.sampled.controller.runner(), &scenario).unwrap();
        let fastest = run.truth.hub_rate_rad_s().iter().map(|w| w.abs()).fold(0.0, f64::max);
        assert!(fastest <= 0.2 * more && fastest >= 0.19, "{kind}: {fastest}");
    }
    let free = format!(
        "{TURNING}\nsynth = {{ loop = \"position\" }}\nplant.drive = {{ limit = 40.0 }}\nplant.sensors.encoder = {{ counts = 16777216 }}"
    );
    let (_, plant, made) = design_project(&free);
    let still = Scenario {
        demand_rad_s: Signal::Constant(0.7),
        initial: Initial::Rest { hub_angle_rad: 0.7 },
        ..Scenario::at_rest(1.0)
    };
    let run = Simulator::new(&plant).unwrap().run(&mut made.sampled.controller.runner(), &still).unwrap();
    let fastest = run.truth.hub_rate_rad_s().iter().map(|w| w.abs()).fold(0.0, f64::max);
    assert!(fastest < 1e-3, "{fastest}");
}
