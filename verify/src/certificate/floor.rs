//! A case with its noise floor, and the motion that the floor is one of: the hub's rate, or what else the loop controls.

use counterpoise_controller::Controller;
use counterpoise_models::{ControlledQuantity, QuantityKind};
use counterpoise_simulate::history::TrueColumns;

use super::CertifiedCase;
use crate::Procedure;
use crate::signals::rms;
use crate::signals::statistics::subtract_mean;

/// Uncertainty of a reading, and the noise that keeps the loop moving without being a motion: in rad/s in a loop of the hub's rate, in the unit
/// of what it controls in every other loop.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ReadingNoise {
    /// RMS of the sensor's noise that is white, rad/s.
    pub white_rad_s: f64,
    /// Step of the reading, rad/s: that of the converter, or of a digital sensor.
    pub step_rad_s: f64,
    /// RMS of what rounding keeps up in the controlled quantity; 0 in a loop of rate, whose floor is that of its reading.
    pub rounding: f64,
}

impl ReadingNoise {
    /// Returns the RMS of noise, quantisation and rounding together, rad/s.
    pub fn rms_rad_s(&self) -> f64 {
        self.white_rad_s.hypot(self.step_rad_s / 12f64.sqrt()).hypot(self.rounding)
    }
}

/// A case with the controller and the procedure.
pub(crate) struct Subject<'a> {
    pub(crate) case: &'a CertifiedCase,
    pub(crate) controller: &'a Controller,
    pub(crate) procedure: &'a Procedure,
    /// The contributions to its noise floor.
    pub(crate) noise: ReadingNoise,
}

impl Subject<'_> {
    /// Returns what the loop controls.
    pub(crate) fn controlled_quantity(&self) -> ControlledQuantity {
        self.case.plant.parameters().controlled_quantity()
    }

    /// Returns the noise floor of the hub's rate, rad/s, or of what else the loop controls, in its unit.
    pub(crate) fn noise_floor_rad_s(&self) -> f64 {
        self.noise.rms_rad_s()
    }

    /// Returns the motion that the floor is one of, from a sample on: the hub's rate, or what else the loop controls. A position is taken about
    /// a line, because friction lets it creep while it cycles.
    pub(crate) fn motion(&self, truth: &TrueColumns, first: usize) -> Vec<f64> {
        let from = |column: &[f64]| column[first.min(column.len())..].to_vec();
        match self.controlled_quantity().kind {
            QuantityKind::Rate => from(truth.hub_rate_rad_s()),
            QuantityKind::Position => {
                let pairs = truth.hub_angle_rad().iter().zip(truth.platform_angle_rad()).skip(first);
                about_line(&pairs.map(|(hub, base)| hub - base).collect::<Vec<f64>>())
            }
            QuantityKind::Effort => from(truth.mesh_torque_nm()),
            QuantityKind::Current => from(truth.current_a()),
        }
    }

    /// Returns the RMS by which a motion is seen to settle or to fade: of the hub's rate, in which creep is small, or of the torque or the
    /// current that the loop controls.
    pub(crate) fn settling_rms(&self, truth: &TrueColumns) -> f64 {
        match self.controlled_quantity().kind {
            QuantityKind::Rate | QuantityKind::Position => rms(&subtract_mean(truth.hub_rate_rad_s())),
            QuantityKind::Effort | QuantityKind::Current => rms(&subtract_mean(&self.motion(truth, 0))),
        }
    }

    /// Returns the amplitude of the hub's rate, rad/s, in an oscillation of what the loop controls at a frequency, Hz. A torque or a current
    /// is taken to accelerate hub and motor as one inertia.
    pub(crate) fn rate_of(&self, amplitude: f64, hz: f64) -> f64 {
        let (parameters, rate) = (self.case.plant.parameters(), std::f64::consts::TAU * hz);
        let ratio = parameters.gearbox.ratio;
        let inertia =
            || self.case.plant.body().inertia_kg_m2 + parameters.motor.inertia_kg_m2 * ratio * ratio;
        match self.controlled_quantity().kind {
            QuantityKind::Rate => amplitude,
            QuantityKind::Position => rate * amplitude,
            QuantityKind::Effort => amplitude / (inertia() * rate),
            QuantityKind::Current => {
                ratio * parameters.motor.torque_constant_nm_a * amplitude / (inertia() * rate)
            }
        }
    }
}

/// Returns a series about its line of least squares.
fn about_line(series: &[f64]) -> Vec<f64> {
    let middle = 0.5 * (series.len().max(1) - 1) as f64;
    let level = subtract_mean(series);
    let time = |k: usize| k as f64 - middle;
    let square: f64 = (0..series.len()).map(|k| time(k).powi(2)).sum();
    let slope = level.iter().enumerate().map(|(k, value)| time(k) * value).sum::<f64>() / square.max(1.0);
    level.iter().enumerate().map(|(k, value)| value - slope * time(k)).collect()
}
