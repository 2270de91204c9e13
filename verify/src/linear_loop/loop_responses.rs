//! The responses of the closed loop to its demand, to a disturbance of the control, and to the noise of its sensors.

use counterpoise_linalg::{C64, CMat};

use super::SampledPlant;
use super::plant::port;
use super::plant_response::{ACCELEROMETER, DEMAND, PLATFORM_GYRO, PlantResponse, hold_and_delay};

/// One response of the closed loop beside its sensitivities.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopResponse {
    /// The input that drives it.
    pub cause: LoopCause,
    /// Observed signal.
    pub effect: LoopEffect,
    /// One value a frequency of [`Curves::frequency_hz`](super::Curves::frequency_hz): rad/s (in a loop of position, rad) or V, over the unit of the cause.
    pub response: Vec<C64>,
}

/// Input of a loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoopCause {
    /// The demand.
    Demand,
    /// A disturbance that is added to the control, V.
    Control,
    /// Noise of the sensor with this place among the readings ([`counterpoise_controller::READING_NAMES`]).
    Noise(usize),
}

/// Output of a loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoopEffect {
    /// The hub's rate; its position in a loop of position.
    Hub,
    /// The control, V.
    Control,
}

/// With S = 1/(1 + L), G the plant from control to hub and H the hold:
///
/// ```text
///     demand -> hub  G H K_0 S      demand -> control  K_0 S      control -> hub  G H S      noise of sensor i -> control  K_i S
/// ```
pub(super) fn loop_responses(
    plant: &SampledPlant,
    at: &PlantResponse,
    K: &[CMat],
    broken: &[C64],
) -> Vec<LoopResponse> {
    let sensitivity = |k: usize| C64::new(1.0, 0.0) / (C64::new(1.0, 0.0) + broken[k]);
    let held = |k: usize| at.continuous[k][(port::HUB, 0)] * hold_and_delay(plant, at.rates_rad_s[k]);
    let over = |value: &dyn Fn(usize) -> C64| (0..broken.len()).map(value).collect();
    let mut all = vec![
        LoopResponse {
            cause: LoopCause::Demand,
            effect: LoopEffect::Hub,
            response: over(&|k| held(k) * K[k][(0, DEMAND)] * sensitivity(k)),
        },
        LoopResponse {
            cause: LoopCause::Demand,
            effect: LoopEffect::Control,
            response: over(&|k| K[k][(0, DEMAND)] * sensitivity(k)),
        },
        LoopResponse {
            cause: LoopCause::Control,
            effect: LoopEffect::Hub,
            response: over(&|k| held(k) * sensitivity(k)),
        },
    ];
    let sees_the_platform = |i: &usize| [DEMAND, PLATFORM_GYRO, ACCELEROMETER].contains(i);
    let is_read = |i: &usize| K.iter().any(|K| K[(0, *i)].norm() > 0.0);
    let sensors = (0..plant.delays.readings.len()).filter(|i| !sees_the_platform(i)).filter(is_read);
    all.extend(sensors.map(|i| LoopResponse {
        cause: LoopCause::Noise(i),
        effect: LoopEffect::Control,
        response: over(&|k| K[k][(0, i)] * sensitivity(k)),
    }));
    all
}
