//! The traverse axis under an elevation axis: its file, what does not fit, and both axes verified together.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::bare_header::BareHeader;
use counterpoise_pipeline::{
    DesignedAxis, PipelineError, ProjectIdentity, World, build_plant_model, design_traverse, export_traverse,
    project_procedure, reduce_plant, study_two_axes, synthesise,
};
use counterpoise_project::{Attachments, Document, Project};
use counterpoise_verify::{JointExperiment, JointFigure, JointQuantity, Verdict};

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/two-axis-sight/");

/// The example with a change of the traverse axis' file.
struct Example {
    from: &'static str,
    to: &'static str,
}

const AS_SHIPPED: Example = Example { from: "", to: "" };

impl World for Example {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        let bytes = std::fs::read(format!("{FOLDER}{name}")).map_err(|error| error.to_string())?;
        if name != "traverse.toml" || self.from.is_empty() {
            return Ok(bytes);
        }
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.contains(self.from), "{}", self.from);
        Ok(text.replacen(self.from, self.to, 1).into_bytes())
    }
}

fn project() -> Project {
    let text = std::fs::read_to_string(format!("{FOLDER}project.toml")).unwrap();
    let below = AS_SHIPPED.read("traverse.toml").unwrap();
    let given = Attachments::none().with("traverse.toml", below);
    Project::resolve(&Document::parse(&text, "project.toml"), &given).unwrap().project
}

fn refusal(from: &'static str, to: &'static str) -> String {
    match design_traverse(&project(), &Example { from, to }) {
        Err(why) => why.to_string(),
        Ok(_) => panic!("{from} -> {to}: accepted"),
    }
}

#[test]
fn errors_of_the_traverse_axis_are_named_with_its_file() {
    let mistyped = refusal("ratio = 200.0", "ratio = \"many\"");
    assert!(mistyped.contains("traverse.toml:") && mistyped.contains("plant.gearbox.ratio"), "{mistyped}");
    let heavy = refusal("gravity = 0.0", "gravity = 9.8");
    assert!(heavy.contains("traverse.toml") && heavy.contains("plant.gravity must be 0"), "{heavy}");
    let slow = refusal("sample_period = 1.0e-3", "sample_period = 2.0e-3");
    assert!(slow.contains("sample_period must be that of the elevation axis"), "{slow}");
    let misaligned = refusal("[plant.sensors.hub_gyro]", "[plant.sensors.hub_gyro]\nroll_sensitivity = 0.02");
    assert!(misaligned.contains("roll_sensitivity and yaw_sensitivity"), "{misaligned}");
    let turned = refusal("hub_inertia = 460.0", "hub_inertia = 460.0\nwheels = 3");
    assert!(turned.contains("wheels"), "{turned}");
}

#[test]
fn both_axes_are_verified_together_and_each_has_its_code() {
    let project = project();
    let modelled = build_plant_model(&project).unwrap();
    let reduced = reduce_plant(&project, &modelled).unwrap();
    let synthesised = synthesise(&project, &modelled, &reduced).unwrap();
    let procedure = project_procedure(&project, &AS_SHIPPED).unwrap();
    let code = export_traverse(&project, &BareHeader, &AS_SHIPPED).unwrap().unwrap();
    assert!(code.files.iter().any(|file| file.name.ends_with(".c")) && code.left_out.is_empty());
    let elevation = DesignedAxis {
        project: &project,
        plant: &modelled.plant,
        synthesised: &synthesised,
        procedure: &procedure,
    };
    let study = study_two_axes(elevation, Some(code.design), &AS_SHIPPED).unwrap().unwrap();
    assert!(study.passes(), "{:?}", study.joint.verdicts);
    assert!(study.joint.verdicts.iter().all(|(_, verdict)| matches!(verdict, Verdict::Holds { .. })));
    assert_eq!(study.joint.values.len(), JointFigure::all().count());
    let value = |experiment, quantity| {
        let figure = JointFigure { experiment, quantity };
        study.joint.values.iter().find(|value| value.figure == figure).unwrap()
    };
    // in its plane the elevation axis moves as it does alone, and on the road the ring's motion adds to its error
    let step = value(JointExperiment::ElevationStep, JointQuantity::ElevationRate);
    assert!((step.together / step.alone - 1.0).abs() < 0.02, "{step:?}");
    let road = value(JointExperiment::Motion, JointQuantity::ElevationSight);
    assert!(road.together > 1.05 * road.alone, "{road:?}");
    let [up, across, all] =
        [JointQuantity::ElevationSight, JointQuantity::CrossElevationSight, JointQuantity::Sight]
            .map(|quantity| value(JointExperiment::Motion, quantity).together);
    assert!((up.hypot(across) / all - 1.0).abs() < 1e-12);
}

#[test]
fn the_traverse_project_is_part_of_the_identity_of_the_elevation_project() {
    let project = project();
    let shipped = ProjectIdentity::of(&project, &AS_SHIPPED);
    let other = Example { from: "ratio = 200.0", to: "ratio = 201.0" };
    assert_ne!(shipped.hash, ProjectIdentity::of(&project, &other).hash);
    let itself = Example { from: "", to: "" };
    let mut endless = project.clone();
    endless.traverse.as_mut().unwrap().file = "project.toml".to_owned();
    assert_ne!(shipped.hash, ProjectIdentity::of(&endless, &itself).hash);
    let commented = Example { from: "[model]", to: "# a comment\n[model]" };
    assert_eq!(shipped.hash, ProjectIdentity::of(&project, &commented).hash);
}

#[test]
fn a_road_at_another_angle_than_the_ring_is_refused() {
    let mut project = project();
    let modelled = build_plant_model(&project).unwrap();
    let synthesised = synthesise(&project, &modelled, &reduce_plant(&project, &modelled).unwrap()).unwrap();
    let procedure = project_procedure(&project, &AS_SHIPPED).unwrap();
    let turned = Example { from: "[model]", to: "[model]\nhub_angle = 0.5" };
    let traverse = design_traverse(&project, &turned).unwrap();
    project.verify.as_mut().unwrap().procedure = procedure.clone();
    let elevation = DesignedAxis {
        project: &project,
        plant: &modelled.plant,
        synthesised: &synthesised,
        procedure: &procedure,
    };
    let refused = study_two_axes(elevation, traverse, &turned);
    assert!(matches!(refused, Err(PipelineError::RingAngle { ring_rad: 0.5, .. })), "{refused:?}");
}
