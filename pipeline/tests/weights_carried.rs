//! A weight that the drive cannot carry at any control is refused before anything is designed.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_pipeline::{PipelineError, build_plant_model, cannot_hold, with_chosen_weights};
use counterpoise_project::{Attachments, Document, Project};

const CRANE: &str = include_str!("../../examples/crane-cylinder/project.toml");

/// The crane with another supply pressure.
fn project(supply: &str) -> Project {
    let text = CRANE.replace("\"7.5 MPa\"", &format!("\"{supply}\"")).replace("\"7 MPa\"", "\"1.5 MPa\"");
    Project::resolve(&Document::parse(&text, "crane.toml"), &Attachments::none()).unwrap().project
}

#[test]
fn a_weight_beyond_the_supply_pressure_is_refused() {
    // 350 kg m need 3432 N m, and 1.6 MPa on 4545 mm^2 at 0.433 m give 3149 N m
    let weak = project("1.6 MPa");
    let modelled = build_plant_model(&weak).unwrap();
    assert!(matches!(cannot_hold(&modelled), Some(PipelineError::CannotCarry { .. })));
    let refused = with_chosen_weights(&weak).unwrap_err();
    let PipelineError::CannotCarry { needed_nm, largest_nm, .. } = refused else { panic!("{refused}") };
    assert!((needed_nm - 350.0 * 9.80665).abs() < 1e-6, "{needed_nm}");
    // the lever at the angle 0: 0.5 m and 0.866 m at 30 degrees, and a cylinder of 0.5 m
    let lever_m = 0.5 * 0.866 * 0.5 / (0.25_f64 + 0.866 * 0.866 - 0.866 * 0.75_f64.sqrt()).sqrt();
    assert!((largest_nm - 1.6 * 4545.0 * lever_m).abs() < 1e-6, "{largest_nm} {lever_m}");
    let strong = project("7.5 MPa");
    assert!(cannot_hold(&build_plant_model(&strong).unwrap()).is_none());
}
