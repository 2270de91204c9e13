//! A weight that the drive cannot carry at any control is refused before anything is designed.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_pipeline::{PipelineError, cannot_hold, model, with_chosen_weights};
use counterpoise_project::{Attachments, Document, Project};

const BOOM: &str = r#"format = 2
[plant]
name = "boom"
[plant.lumped]
hub_inertia = 266.7
out_of_balance = 350.0
[plant.cylinder]
area = "4545 mm^2"
supply_pressure = "7.5 MPa"
volume = 2.12e-3
leakage = 1.0e-11
rated_flow = 4.0e-4
rated_pressure_drop = "1.5 MPa"
valve_frequency = "67 Hz"
lever_arm = 0.433
[plant.interface]
sample_period = "1 ms"
"#;

fn project(supply: &str) -> Project {
    let text = BOOM.replace("7.5 MPa", supply);
    Project::resolve(&Document::parse(&text, "boom.toml"), &Attachments::none()).unwrap().project
}

#[test]
fn a_weight_beyond_the_supply_pressure_is_refused() {
    // 350 kg m need 3432 N m, and 1.6 MPa on 4545 mm^2 at 0.433 m give 3149 N m
    let weak = project("1.6 MPa");
    let modelled = model(&weak).unwrap();
    assert!(matches!(cannot_hold(&modelled), Some(PipelineError::CannotCarry { .. })));
    let refused = with_chosen_weights(&weak).unwrap_err();
    let PipelineError::CannotCarry { needed_nm, largest_nm, .. } = refused else { panic!("{refused}") };
    assert!((needed_nm - 350.0 * 9.80665).abs() < 1e-6, "{needed_nm}");
    assert!((largest_nm - 1.6 * 4545.0 * 0.433).abs() < 1e-6, "{largest_nm}");
    let strong = project("7.5 MPa");
    assert!(cannot_hold(&model(&strong).unwrap()).is_none());
}
