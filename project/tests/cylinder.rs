//! `[plant.cylinder]`: what is read is what the drive has, what is read is written, and what is wrong is told at its key.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_models::parameters::cylinder::Lever;
use counterpoise_models::{AxisKind, Plant};
use counterpoise_project::{Attachments, Document, Project};

const GOOD: &str = r#"format = 2
[plant]
name = "boom"
[plant.lumped]
hub_inertia = 266.7
out_of_balance = 350.0
[plant.cylinder]
area = "4545 mm^2"
supply_pressure = "7.5 MPa"
volume = 2.12e-3
bulk_modulus = "959 MPa"
leakage = 1.1e-11
rated_flow = 4.0e-4
valve_frequency = "35 Hz"
overlap = 0.03
lever_arm = 0.433
[plant.friction.motor]
model = "dahl"
coulomb = "150 N"
rest_stiffness = "1.5e6 N/m"
[plant.interface]
sample_period = "1 ms"
"#;
const PINS: &str =
    "[plant.cylinder.linkage]\narm = 0.5\nanchor = 0.866\nanchor_angle = \"-30 deg\"\n[plant.friction.motor]";

fn resolve_project(text: &str) -> Project {
    match Project::resolve(&Document::parse(text, "boom.toml"), &Attachments::none()) {
        Ok(parsed) => parsed.project,
        Err(errors) => panic!("{errors:?}"),
    }
}

fn error_text(text: &str) -> String {
    let errors = Project::resolve(&Document::parse(text, "boom.toml"), &Attachments::none()).unwrap_err();
    errors.iter().map(|error| format!("{error}\n")).collect()
}

#[test]
fn a_cylinder_stands_in_the_places_of_gear_motor_and_amplifier() {
    let project = resolve_project(GOOD);
    let (p, cylinder) = (&project.plant, project.plant.cylinder.as_ref().unwrap());
    let near =
        |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    near(p.motor.torque_constant_nm_a, 4545.0);
    near(p.motor.back_emf_v_s_rad, 4.545);
    near(p.motor.resistance_ohm, 0.011);
    near(p.motor.inductance_h, 2.12 / (4.0 * 959.0));
    near(p.gearbox.ratio, 0.433);
    near(cylinder.supply_mpa, 7.5);
    // the rated flow at the rated pressure drop, with the valve fully open
    let full = p.amplifier.gain * p.amplifier.input_limit_v;
    near(cylinder.flow_l_s(full, 7.5 - 7.0), 0.4);
    near(cylinder.overlap_l_s / full, 0.03);
    assert_eq!(cylinder.lever, Lever::Constant(0.433));
    assert_eq!(p.axis, AxisKind::Rotary);
    near(p.motor_friction.coulomb_nm(), 150.0);
    assert!(Plant::from_lumped(p).is_ok());
}

#[test]
fn what_is_read_is_written() {
    for text in [GOOD.to_owned(), GOOD.replace("lever_arm = 0.433\n[plant.friction.motor]", PINS)] {
        let project = resolve_project(&text);
        let again = resolve_project(&project.to_text());
        assert_eq!(again.plant, project.plant, "{}", project.to_text());
        assert!(!project.to_text().contains("[plant.motor]"), "{}", project.to_text());
    }
}

#[test]
fn what_is_wrong_is_told_at_its_key() {
    let wrong = [
        (
            GOOD.replace("[plant.interface]", "[plant.motor]\ninertia = 0.1\n[plant.interface]"),
            "plant.motor",
            "must not stand beside [plant.cylinder]",
        ),
        (GOOD.replace("lever_arm = 0.433\n", ""), "lever_arm", "must be stated, or the section linkage"),
        (
            GOOD.replace("[plant.friction.motor]", PINS),
            "lever_arm",
            "must not stand beside the section linkage",
        ),
        (GOOD.replace("overlap = 0.03", "overlap = 0.7"), "overlap", "must be between 0 and 0.5"),
        (GOOD.replace("volume = 2.12e-3", "volume = 0.0"), "volume", "must be above 0"),
        (GOOD.replace("area = \"4545 mm^2\"\n", ""), "area", "missing"),
        (
            GOOD.replace("name = \"boom\"", "axis = \"linear\"").replace("hub_inertia", "mass"),
            "cylinder",
            "acts about a pivot",
        ),
        (
            GOOD.replace("lever_arm = 0.433\n[plant.friction.motor]", &PINS.replace("\"-30 deg\"", "0.0")),
            "linkage",
            "must have a lever at the angle 0",
        ),
        (
            GOOD.replace("lever_arm = 0.433\n[plant.friction.motor]", &PINS.replace("-30 deg", "180 deg")),
            "linkage",
            "must have a lever at the angle 0",
        ),
        (
            GOOD.replace("lever_arm = 0.433\n[plant.friction.motor]", PINS) + "[model]\nhub_angle = -0.55\n",
            "plant.cylinder.linkage",
            "has no lever on the way to the angle -0.55 rad",
        ),
        (
            GOOD.replace("model = \"dahl\"", "model = \"coulomb\"")
                .replace("rest_stiffness = \"1.5e6 N/m\"\n", ""),
            "plant.friction.motor.model",
            "must be a law with presliding",
        ),
        (
            GOOD.replace(
                "[plant.interface]",
                "[plant.drive_limits]\ncontinuous_current = 1.0\n[plant.interface]",
            ),
            "plant.drive_limits",
            "must not limit a current",
        ),
    ];
    for (text, key, message) in wrong {
        let all = error_text(&text);
        assert!(all.contains(key) && all.contains(message), "{key}, {message}: {all}");
    }
}
