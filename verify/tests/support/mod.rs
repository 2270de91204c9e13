//! A controller for the reference rig: PI on the rate error, and constant feedforward gains.
#![allow(dead_code, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_controller::{Controller, Parts, Path, PathSignal, Scaling};
use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};
use counterpoise_models::parameters::Parameters;
use counterpoise_models::plant::Plant;

pub const PERIOD_S: f64 = 1e-3;
/// Volts that hold one N m: stalled amplifier 3 A/V, 0.86 N m/A, gear 200.
pub const VOLTS_PER_NM: f64 = 1.0 / (3.0 * 0.86 * 200.0);

pub fn rig() -> Parameters {
    counterpoise_models::reference::rig()
}

pub fn plant() -> Plant {
    Plant::from_lumped(&rig()).unwrap()
}

fn gain(name: &str, signal: PathSignal, value: f64) -> Path {
    let system = StateSpace::gain(Mat::row(&[value]), Timebase::Discrete { period_s: PERIOD_S }).unwrap();
    let inputs = vec![signal];
    Path { name: name.into(), inputs, system, anti_windup: vec![], scaling: Scaling::Fixed }
}

/// u = 18 e + 80 integral of e - (static feedforward of heave) + drag of the pitch rate, with the holding bias.
pub fn controller() -> Controller {
    let one = |x: f64| Mat::row(&[x]);
    let timebase = Timebase::Discrete { period_s: PERIOD_S };
    let pi = StateSpace::new(one(1.0), one(80.0 * PERIOD_S), one(1.0), one(18.0), timebase).unwrap();
    let mut parts = Parts::new(PERIOD_S, 10.0);
    parts.paths.push(Path {
        name: "feedback".into(),
        inputs: vec![PathSignal::RateError],
        system: pi,
        anti_windup: vec![0.01],
        scaling: Scaling::Fixed,
    });
    let moment = rig().lumped.unwrap().out_of_balance_kg_m;
    parts.paths.push(gain("heave", PathSignal::PlatformAcceleration, moment * VOLTS_PER_NM));
    parts.paths.push(gain("pitch", PathSignal::PlatformRate, -200.0 * 200.0 * 0.002 * VOLTS_PER_NM));
    parts.design_out_of_balance_kg_m = moment;
    parts.bias_v_per_kg_m = 9.80665 * VOLTS_PER_NM;
    Controller::new(parts).unwrap()
}
