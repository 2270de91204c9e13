//! Controller and plant as FMI 3.0 units, closed into a loop by FMPy, against the studio's own loop.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs, non_snake_case)]

#[path = "../../export/tests/support/mod.rs"]
mod support;

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use counterpoise_export::Source::Unverified;
use counterpoise_export::fmi::{PlantUnit, PlantUnitError, controller_unit, pack, plant_unit};
use counterpoise_export::{File, Options};
use counterpoise_models::plant::Plant;
use counterpoise_project::Project;
use counterpoise_project::pipeline::{model, reduce, synthesise};
use counterpoise_simulate::{PlatformMotion, Scenario, Signal, Simulator, TimeHistory};
use support::{STRICT, folder, is_there, provenance, run, write};

fn project() -> Project {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/reference-rig/project.toml");
    let text = std::fs::read_to_string(file).unwrap();
    Project::parse(&text, "project.toml").map_err(|errors| errors[0].to_string()).unwrap().project
}

/// A step of demand on a platform that heaves and pitches; ideal converters.
fn scenario() -> Scenario {
    let platform = PlatformMotion {
        heave_m_s2: Signal::sine(0.5, 9.0),
        pitch_rate_rad_s: Signal::sine(0.05, 7.0),
        ..PlatformMotion::STILL
    };
    Scenario { demand_rad_s: Signal::step(0.2, 0.1), platform, ..Scenario::still(2.0) }
}

fn csv(run: &TimeHistory) -> String {
    let mut text = "time,demand,heave,pitch_rate,control,hub_rate\n".to_owned();
    let (r, t) = (&run.readings, &run.truth);
    for (k, time) in run.time_s().iter().enumerate() {
        let (demand, heave, pitch) = (r.demand_rad_s[k], t.heave_m_s2[k], t.platform_rate_rad_s[k]);
        let (control, rate) = (r.control_request_v[k], t.hub_rate_rad_s[k]);
        writeln!(text, "{time:?},{demand:?},{heave:?},{pitch:?},{control:?},{rate:?}").unwrap();
    }
    text
}

/// A unit's library for this machine, compiled without a word.
fn compiled(folder: &Path, name: &str, files: &[File]) -> Vec<u8> {
    write(folder, files);
    let own = [format!("{name}/sources/{name}.c"), format!("{name}/sources/fmu.c")];
    let library = format!("{name}.so");
    let link = ["-fPIC", "-shared", "-ffp-contract=off", "-lm", "-o", &library];
    assert_eq!(run(Command::new("cc").current_dir(folder).args(STRICT).args(&own).args(link)), "");
    std::fs::read(folder.join(library)).unwrap()
}

#[test]
fn the_loop_closed_by_fmpy_is_the_simulated_one() {
    let project = project();
    let modelled = model(&project).unwrap();
    let reduced = reduce(&project, &modelled).unwrap();
    let controller = synthesise(&project, &modelled, &reduced).unwrap().sampled.controller;
    let folder = folder("fmi_loop");
    let axis = controller_unit(Unverified(&controller), &provenance(), &Options::double("axis")).unwrap();
    let plant = Plant::lumped(modelled.plant.parameters()).unwrap();
    let rig = plant_unit(PlantUnit { plant: &plant, name: "rig" }, &provenance()).unwrap();
    let mut runner = controller.runner();
    let expected = Simulator::new(&plant).unwrap().run(&mut runner, &scenario()).unwrap();
    std::fs::write(folder.join("expected.csv"), csv(&expected)).unwrap();
    if !is_there("cc") {
        return println!("skipped: no C compiler");
    }
    for (name, files) in [("axis", &axis), ("rig", &rig)] {
        let library = compiled(&folder, name, files);
        std::fs::write(folder.join(format!("{name}.fmu")), pack(files, name, Some(&library))).unwrap();
    }
    let python = Command::new("python3").args(["-c", "import fmpy"]).output();
    if !python.is_ok_and(|output| output.status.success()) {
        return println!("skipped: FMPy missing (pip install fmpy)");
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/fmi/check.py");
    println!("{}", run(Command::new("python3").arg(script).arg(&folder)));
}

#[test]
fn physics_that_the_generated_plant_lacks_is_named() {
    let mut parameters = model(&project()).unwrap().plant.parameters().clone();
    parameters.motor.cogging.amplitude = 0.01;
    let plant = Plant::lumped(&parameters).unwrap();
    let refused = plant_unit(PlantUnit { plant: &plant, name: "rig" }, &provenance());
    assert_eq!(refused, Err(PlantUnitError::Physics { what: "cogging" }));
}
