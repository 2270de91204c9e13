//! The frequency responses that a plant contributes to its loop, whatever the controller.

use counterpoise_linalg::{C64, CMat};
use counterpoise_lti::{Response, StateSpace};

use super::plant::port;
use super::{ClosedLoop, SampledPlant};
use crate::Error;

// places of readings in the order of the controller
pub(super) const DEMAND: usize = 0;
pub(super) const HUB_GYRO: usize = 1;
pub(super) const PLATFORM_GYRO: usize = 2;
pub(super) const ACCELEROMETER: usize = 3;

/// Contribution of a plant to its curves: computed once for all controllers.
#[derive(Debug, Clone)]
pub struct PlantResponse {
    /// Frequencies, Hz.
    pub frequency_hz: Vec<f64>,
    pub(super) rates_rad_s: Vec<f64>,
    /// (control, heave, pitch rate) to all outputs, continuous.
    pub(super) continuous: Vec<CMat>,
    /// Control to readings, sampled.
    pub(super) readings: Vec<CMat>,
}

impl PlantResponse {
    /// Returns the response of a plant at some frequencies.
    ///
    /// # Errors
    /// A response that does not exist because of a pole on the axis.
    pub fn of(plant: &SampledPlant, frequency_hz: Vec<f64>) -> Result<Self, Error> {
        let rates_rad_s: Vec<f64> = frequency_hz.iter().map(|f| std::f64::consts::TAU * f).collect();
        let continuous = Response::of(&plant.continuous)?.at_all(&rates_rad_s)?;
        let readings = Response::of(&to_readings(plant))?.at_all(&rates_rad_s)?;
        Ok(Self { frequency_hz, rates_rad_s, continuous, readings })
    }

    pub(super) fn controller(&self, closed: &ClosedLoop) -> Result<Option<Vec<CMat>>, Error> {
        let K = closed.controller.as_ref();
        K.map(|K| Ok(Response::of(K)?.at_all(&self.rates_rad_s)?)).transpose()
    }
}

/// The discrete plant from control to readings.
fn to_readings(plant: &SampledPlant) -> StateSpace {
    let readings: Vec<usize> = (port::FIRST_READING..plant.sampled.outputs()).collect();
    plant.sampled.select(&readings, &[port::CONTROL])
}

/// The hold and the control's delay.
pub(crate) fn hold_and_delay(plant: &SampledPlant, rate: f64) -> C64 {
    let angle = rate * plant.sample_period_s;
    let j = C64::new(0.0, angle);
    (C64::new(1.0, 0.0) - (-j).exp()) / j * C64::from_polar(1.0, -angle * plant.delays.control as f64)
}
