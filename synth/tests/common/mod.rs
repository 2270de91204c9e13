//! The reference rig as a design plant, for tests.
#![allow(clippy::unwrap_used, dead_code)]

use counterpoise_linalg::C64;
use counterpoise_models::{
    Angles, FrictionLinearisation, LinearPlant, OperatingPoint, Parameters, Plant, reference,
};
use counterpoise_synth::{
    Assembly, DesignPlant, DisturbanceKnowledge, FeedbackWeights, FeedforwardBasis, FeedforwardWeights,
    LightModes, Reference, Specification, Weight,
};

/// The lumped reference rig, held at 0 rad, viscous friction, with its sensors and one sample of delay.
pub fn rig() -> DesignPlant {
    plant(&reference::rig())
}

/// Any parameters as a design plant, in the same way.
pub fn plant(parameters: &Parameters) -> DesignPlant {
    let plant = Plant::from_lumped(parameters).unwrap();
    let equilibrium = plant.equilibrium(&OperatingPoint::default());
    let linear = plant.linearise(&equilibrium, FrictionLinearisation::Viscous, Angles::Drop).unwrap();
    let sensors = &parameters.sensors;
    DesignPlant {
        heave: vec![LinearPlant::HEAVE],
        pitch: vec![LinearPlant::PITCH_RATE],
        hub_sensor: Some(sensors.hub_gyro.dynamics().unwrap()),
        heave_sensor: Some(sensors.platform_accelerometer.dynamics().unwrap()),
        pitch_sensor: Some(sensors.platform_gyro.dynamics().unwrap()),
        delay_s: parameters.interface.sample_period_s,
        pade_order: 2,
        ..DesignPlant::ideal(linear.system, LinearPlant::CONTROL, LinearPlant::HUB_RATE)
    }
}

/// The default weights of the reference rig: an integrating error weight with a corner, two-stage feedforward.
///
/// Densities of the noises are those of the rig's sensors (rms^2 x sample period). The loop recovery of 3.6e-4 V^2 s is
/// chosen so that the sampled loop keeps the state feedback's margins.
pub fn weights() -> Specification {
    Specification {
        feedback: FeedbackWeights {
            error: Weight::ZeroPoleGain {
                zeros: vec![to_complex(-18.0)],
                poles: vec![to_complex(0.0)],
                gain: 25.0,
            },
            control: Weight::Lead { gain: 1.0, time_s: 0.005 },
            combination: vec![],
            measurement_noise: 4e-11,
            disturbances: vec![],
            loop_recovery: 3.6e-4,
            modes: LightModes::Kept,
        },
        heave: Some(heave()),
        pitch: Some(pitch()),
        assembly: Assembly::SimpleAdd,
        reference: Reference::Error,
        position_gain: None,
    }
}

/// The weights in the thesis' own form: K1/(a1 s) and K2 (a2 s + 1) for the feedback.
pub fn thesis_weights() -> Specification {
    let mut specification = weights();
    specification.feedback.error = Weight::Integral { gain: 200.0, time_s: 1.0 };
    specification
}

fn heave() -> FeedforwardWeights {
    FeedforwardWeights {
        error: Weight::Constant { gain: 300.0 },
        control: Weight::Quadratic { gain: 1.0, second_s2: 1e-4, first_s: 1.4e-2 },
        generator: low_pass(1.0, 20.0),
        knowledge: DisturbanceKnowledge::Measured { noise: 2.5e-8 },
        output: None,
        basis: FeedforwardBasis::OpenLoop,
    }
}

fn pitch() -> FeedforwardWeights {
    FeedforwardWeights {
        error: Weight::Constant { gain: 300.0 },
        control: Weight::QuadraticFreeAtZero { gain: 1.0, second_s2: 1e-4, first_s: 1.4e-2 },
        generator: low_pass(0.1, 12.0),
        knowledge: DisturbanceKnowledge::Measured { noise: 4e-11 },
        output: None,
        basis: FeedforwardBasis::OpenLoop,
    }
}

/// A disturbance of the given density below the corner, falling with the square above it.
fn low_pass(density_root: f64, corner_rad_s: f64) -> Weight {
    let pole = C64::new(-0.7 * corner_rad_s, 0.51_f64.sqrt() * corner_rad_s);
    let gain = density_root * corner_rad_s * corner_rad_s;
    Weight::ZeroPoleGain { zeros: vec![], poles: vec![pole, pole.conj()], gain }
}

fn to_complex(value: f64) -> C64 {
    C64::new(value, 0.0)
}
