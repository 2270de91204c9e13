//! The report of a real verification: complete, self-contained, small. It is left in the target folder for a person to look at.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise::report::{Context, html, of_verification};
use counterpoise_project::controller::{Controller, Parts, Path, Scaling, Signal};
use counterpoise_project::lti::{Mat, StateSpace, Timebase};
use counterpoise_project::models::{plant::Plant, reference};
use counterpoise_project::verify::{Figure, Limit, Procedure, Requirement, Verification, verify};

const PERIOD_S: f64 = 1e-3;
const VOLTS_PER_NM: f64 = 1.0 / (3.0 * 0.86 * 200.0);

fn path(name: &str, signal: Signal, system: StateSpace) -> Path {
    let anti_windup = vec![0.01; system.order()];
    Path { name: name.into(), inputs: vec![signal], system, anti_windup, scaling: Scaling::Fixed }
}

/// PI feedback and constant feedforward gains for the reference rig.
fn controller(moment: f64) -> Controller {
    let one = |x: f64| Mat::row(&[x]);
    let timebase = Timebase::Discrete { period_s: PERIOD_S };
    let pi = StateSpace::new(one(1.0), one(0.08), one(1.0), one(18.0), timebase).unwrap();
    let heave = StateSpace::gain(one(moment * VOLTS_PER_NM), timebase).unwrap();
    let mut parts = Parts::new(PERIOD_S, 10.0);
    parts.paths =
        vec![path("feedback", Signal::RateError, pi), path("heave", Signal::PlatformAcceleration, heave)];
    parts.design_out_of_balance_kg_m = moment;
    parts.bias_v_per_kg_m = 9.80665 * VOLTS_PER_NM;
    Controller::new(parts).unwrap()
}

fn verification() -> Verification {
    let rig = reference::rig();
    let moment = rig.lumped.as_ref().unwrap().out_of_balance_kg_m;
    let limits = [
        ("gain_margin_db", Limit::AtLeast(12.0)),
        ("phase_margin_deg", Limit::AtLeast(60.0)),
        ("linear_step_overshoot_percent", Limit::AtMost(13.0)),
        ("heave_compensated_drr_db at 1 Hz", Limit::AtMost(-50.0)),
        ("pitch_compensated_drr_db at 1 Hz", Limit::AtMost(-40.0)),
        ("linear_road_compensated_hub_rms_rad_s", Limit::AtMost(1e-3)),
    ];
    let requirements =
        limits.map(|(key, limit)| Requirement::new(Figure::from_key(key).unwrap(), limit).unwrap());
    let plant = Plant::lumped(&rig).unwrap();
    let verified = verify(&plant, &controller(moment), &Procedure::default(), &requirements).unwrap();
    verified.verification().clone()
}

#[test]
fn a_report_holds_every_part_and_stays_small() {
    let context = Context {
        title: "Reference rig".into(),
        subtitle: "PI feedback, heave feedforward".into(),
        ..Context::default()
    };
    let page = html(&of_verification(&verification(), context));
    std::fs::write(concat!(env!("CARGO_TARGET_TMPDIR"), "/report.html"), &page).unwrap();
    for heading in [
        "Requirements",
        "Loop and margins",
        "Platform in motion",
        "Disturbance rejection ratio",
        "Controllers",
        "Plant",
    ] {
        assert!(page.contains(heading), "{heading}");
    }
    assert!(page.len() < 3_000_000, "{}", page.len());
    assert!(!page.contains("NaN"), "a number that is none reached the page");
}
