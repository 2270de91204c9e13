//! The control that a ramp of the demand asks for, against closed forms.
#![allow(clippy::unwrap_used, missing_docs, non_snake_case)]

use counterpoise_controller::{Controller, Parts, Path, PathSignal, Scaling};
use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};
use counterpoise_synth::{DesignPlant, Sampling, control_of_ramp};

/// An integrator with a proportional loop needs the rate itself as control, once it follows: 1 - exp(-K t) of it.
#[test]
fn an_integrator_follows_a_ramp_with_its_rate() {
    let one = |x: f64| Mat::from_rows(&[&[x]]);
    let system = StateSpace::new(one(0.0), one(1.0), one(1.0), one(0.0), Timebase::Continuous).unwrap();
    let plant = DesignPlant::ideal(system, 0, 0);
    let (period_s, gain) = (1e-3, 20.0);
    let mut parts = Parts::new(period_s, 10.0);
    let timebase = Timebase::Discrete { period_s };
    parts.paths.push(Path {
        name: "feedback".into(),
        inputs: vec![PathSignal::RateError],
        system: StateSpace::gain(one(gain), timebase).unwrap(),
        anti_windup: Vec::new(),
        scaling: Scaling::Fixed,
    });
    let controller = Controller::new(parts).unwrap();
    let sampling = Sampling::new(period_s, 10.0);
    let early = control_of_ramp(&plant, &controller, &sampling, 0.1).unwrap();
    let late = control_of_ramp(&plant, &controller, &sampling, 2.0).unwrap();
    assert!((early - (1.0 - (-gain * 0.1_f64).exp())).abs() < 0.01, "{early}");
    assert!((late - 1.0).abs() < 1e-9, "{late}");
}
