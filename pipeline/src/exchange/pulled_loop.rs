//! A loop with its uncertain parts pulled out, as plain data: what the bounds of the structured singular value and the sector argument are
//! checked with.

use counterpoise_controller::{COMMON_READINGS, READING_NAMES};
use counterpoise_verify::structured::{PerturbationBlock, PulledLoop};
use serde::Serialize;

use super::systems::SystemResult;

/// A loop with its uncertain parts pulled out. With the gain H(jw) of the hold (a zero-order hold that is late by whole samples), the
/// mechanism G, the sampled mechanism P and the controller K, the response from what deviations add to what they are proportional to is
/// M = G_zw + G_zu H (1 - K P)^-1 K G_yw, the readings late by their samples.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PulledLoopResult {
    /// `mechanism` (continuous), `sampled_mechanism` (from the control to the readings) and `controller`.
    pub systems: Vec<SystemResult>,
    /// The blocks of the deviation: the number of places at which each real parameter acts, and 0 for a complex number.
    pub blocks: Vec<usize>,
    /// Relative errors at the plant's input and of the hub gyroscope's reading, by which their complex blocks are multiplied.
    pub errors: [f64; 2],
    /// Whole samples by which the control is late.
    pub control_delay_samples: usize,
    /// Whole samples by which each reading is late.
    pub reading_delays_samples: Vec<usize>,
}

/// Readings that the mechanism's last outputs stand for.
const FED_BACK: [&str; 3] = ["hub_rate", "motor_rate", "hub_angle"];

impl From<&PulledLoop> for PulledLoopResult {
    fn from(pulled: &PulledLoop) -> Self {
        let places = pulled.mechanism.inputs() - 1;
        let named = |stem: &str| -> Vec<String> { (1..=places).map(|k| format!("{stem}_{k}")).collect() };
        let added: Vec<String> = named("added").into_iter().chain(["control_v".to_owned()]).collect();
        let felt = FED_BACK.iter().map(|name| format!("reading_of_{name}"));
        let seen: Vec<String> = named("deviating").into_iter().chain(felt).collect();
        let system = |name: &str, system, inputs: &[String], outputs: &[String]| {
            let inputs: Vec<&str> = inputs.iter().map(String::as_str).collect();
            let outputs: Vec<&str> = outputs.iter().map(String::as_str).collect();
            SystemResult::new(name, system, &inputs, &outputs)
        };
        let readings: Vec<String> =
            READING_NAMES[..COMMON_READINGS].iter().map(|&name| name.to_owned()).collect();
        let control = ["control_v".to_owned()];
        Self {
            systems: vec![
                system("mechanism", &pulled.mechanism, &added, &seen),
                system("sampled_mechanism", &pulled.sampled, &control, &readings),
                system("controller", &pulled.controller, &readings, &control),
            ]
            .into_iter()
            .map(|system| system.of_loop(pulled.controlled))
            .collect(),
            blocks: pulled
                .structure
                .blocks
                .iter()
                .map(|block| match block {
                    PerturbationBlock::Real { repeated } => *repeated,
                    PerturbationBlock::Complex => 0,
                })
                .collect(),
            errors: pulled.errors,
            control_delay_samples: pulled.control_delay_samples,
            reading_delays_samples: pulled.reading_delays_samples.clone(),
        }
    }
}
