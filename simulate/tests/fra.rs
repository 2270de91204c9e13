//! The analyser on the simulator, against the linearised plant and on a recording of itself.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common::controller;
use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::StateSpace;
use counterpoise_models::{
    Angles, FrictionLaw, FrictionLinearisation, LinearPlant, OperatingPoint, Parameters, Plant, reference,
};
use counterpoise_simulate::fra::{self, Measurement, Settings, Test, TestSine};

fn without_dry_friction() -> Parameters {
    let mut rig = reference::rig();
    rig.motor_friction.law = FrictionLaw::None;
    rig.pivot_friction.law = FrictionLaw::None;
    rig
}

fn measure_rig(rig: &Parameters, test: Test, frequency: f64, amplitude: f64) -> Measurement {
    let plant = Plant::from_lumped(rig).unwrap();
    fra::measure_point(
        &plant,
        &mut controller(),
        test,
        TestSine { frequency_rad_s: frequency, amplitude },
        &Settings::default(),
    )
    .unwrap()
}

fn response(g: &StateSpace, output: usize, input: usize, frequency: f64) -> C64 {
    let n = g.order();
    let at = Mat::eye(n).to_complex().scale(C64::new(0.0, frequency));
    let resolvent = counterpoise_linalg::csolve(&(&at - &g.A.to_complex()), &g.B.to_complex()).unwrap();
    (&g.C.to_complex() * &resolvent)[(output, input)] + g.D[(output, input)]
}

#[test]
fn without_dry_friction_the_plants_response_is_the_linear_one() {
    let rig = without_dry_friction();
    let plant = Plant::from_lumped(&rig).unwrap();
    let at_rest = plant.equilibrium(&OperatingPoint::default());
    let linear = plant.linearise(&at_rest, FrictionLinearisation::Viscous, Angles::Keep).unwrap();
    let gyro = rig.sensors.hub_gyro.dynamics().unwrap();
    for frequency in [6.0, 20.0, 60.0, 110.0] {
        let found = measure_rig(&rig, Test::Plant, frequency, 0.05);
        assert!(found.settled, "{frequency}: {}", found.last_change);
        let w = found.response.frequency_rad_s;
        // a held sine, as the samples see it: half a sample late, to the accuracy of the images left out
        let hold = C64::from_polar(1.0, -0.5 * w * 1e-3);
        let expected = response(&linear.system, LinearPlant::HUB_RATE, LinearPlant::CONTROL, w)
            * response(&gyro, 0, 0, w)
            * hold;
        let error = (found.response.value - expected).norm() / expected.norm();
        assert!(error < 3e-3, "{frequency}: {error}");
        assert!(found.response.distortion() < 1e-3);
    }
}

#[test]
fn dry_friction_makes_the_response_depend_on_the_amplitude() {
    let rig = reference::rig();
    let small = measure_rig(&rig, Test::Plant, 12.0, 0.05);
    let large = measure_rig(&rig, Test::Plant, 12.0, 1.0);
    assert!(large.response.value.norm() > 2.0 * small.response.value.norm());
    assert!(large.response.distortion() > 1e-3);
}

#[test]
fn the_loop_follows_slowly_and_rejects_the_platform() {
    let rig = reference::rig();
    let follows = measure_rig(&rig, Test::ClosedLoop, 2.0, 0.1).response;
    assert!((follows.value - 1.0).norm() < 0.35, "{}", follows.value);
    let rejects = measure_rig(&rig, Test::PlatformToHub, 3.0, 0.1).response;
    assert!(rejects.gain_db() < -10.0, "{}", rejects.gain_db());
}

#[test]
fn friction_carries_a_balanced_disconnected_mechanism_at_small_amplitudes() {
    let mut rig = reference::rig();
    assert!(fra::disconnect_motor(&rig).is_err());
    rig.lumped.as_mut().unwrap().out_of_balance_kg_m = 0.0;
    let open = fra::disconnect_motor(&rig).unwrap();
    let small = measure_rig(&open, Test::PlatformToHub, 6.0, 0.002).response;
    let large = measure_rig(&open, Test::PlatformToHub, 6.0, 0.5).response;
    assert!(small.value.norm() > 0.8, "{}", small.value.norm());
    assert!(large.value.norm() < 0.8 * small.value.norm(), "{}", large.value.norm());
}
