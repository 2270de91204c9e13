//! The motion of the hub and of the tip under noise of the readings and of the control, by the linear loop.

use counterpoise_linalg::C64;

use super::SampledPlant;
use super::closed_loop::ClosedLoop;
use super::frequency::break_loop;
use super::plant::port;
use super::plant_response::{PlantResponse, hold_and_delay};
use crate::Error;

/// Place at which noise enters a loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseEntry {
    /// The reading with this place among the readings ([`counterpoise_controller::READING_NAMES`]), after its delay.
    Reading(usize),
    /// The control, before its delay.
    Control,
}

/// The rates of hub and tip over one noise.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseResponse {
    /// Place at which it enters.
    pub entry: NoiseEntry,
    /// Hub rate over the noise, one value a frequency.
    pub hub: Vec<C64>,
    /// Tip rate over the noise.
    pub tip: Vec<C64>,
}

/// Returns the rates of hub and tip over noise of every reading and of the control at some frequencies in Hz, below half the sample rate; none without a
/// controller. With S = 1/(1 + L), the plant G from control to hub or tip and the hold H:
///
/// ```text
///     reading i -> G H K_i S        control -> G H S
/// ```
///
/// # Errors
/// A response that does not exist because of a pole on the axis.
pub fn noise_responses(
    plant: &SampledPlant,
    closed: &ClosedLoop,
    frequency_hz: Vec<f64>,
) -> Result<Vec<NoiseResponse>, Error> {
    let at = PlantResponse::of(plant, frequency_hz)?;
    let Some(K) = at.controller(closed)? else { return Ok(Vec::new()) };
    let broken = break_loop(&K, &at.readings);
    let through = |k: usize, row: usize| {
        at.continuous[k][(row, 0)] * hold_and_delay(plant, at.rates_rad_s[k])
            / (C64::new(1.0, 0.0) + broken[k])
    };
    let response = |entry: NoiseEntry| {
        let gain = |k: usize| match entry {
            NoiseEntry::Reading(i) => K[k][(0, i)],
            NoiseEntry::Control => C64::new(1.0, 0.0),
        };
        let at = |row: usize| (0..broken.len()).map(|k| through(k, row) * gain(k)).collect();
        NoiseResponse { entry, hub: at(port::HUB), tip: at(port::TIP) }
    };
    let readings = (0..plant.delays.readings.len()).map(NoiseEntry::Reading);
    Ok(readings.chain([NoiseEntry::Control]).map(response).collect())
}
