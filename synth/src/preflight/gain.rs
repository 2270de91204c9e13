//! The gain of a plant over frequency, as the checks before solving need it.

use counterpoise_linalg::C64;
use counterpoise_lti::StateSpace;
use counterpoise_lti::response::Response;

use crate::{Error, RationalFunction, Weight};

/// Frequencies at which gains are compared: decades from 10^LOWEST to 10^HIGHEST rad/s, so many points each.
const LOWEST: i32 = -3;
const HIGHEST: i32 = 5;
const POINTS: i32 = 24;

/// The modulus of a system over frequency, relative to its largest on the grid.
pub(crate) struct Gain {
    response: Response,
    moduli: Vec<(f64, f64)>,
    pub largest: f64,
}

impl Gain {
    pub fn of(system: &StateSpace) -> Result<Self, Error> {
        let response = Response::of(system)?;
        let points = (LOWEST * POINTS)..=(HIGHEST * POINTS);
        let rates = points.map(|k| 10f64.powf(f64::from(k) / f64::from(POINTS)));
        let moduli = rates.map(|rate| (rate, modulus(&response, rate))).collect::<Vec<_>>();
        let finite = moduli.iter().map(|(_, modulus)| *modulus).filter(|modulus| modulus.is_finite());
        let largest = finite.fold(0.0, f64::max);
        Ok(Self { response, moduli, largest })
    }

    /// Returns the modulus at a frequency over the largest; 1 if it is infinite, 0 if the system is zero.
    pub fn relative_modulus(&self, rate: f64) -> Result<f64, Error> {
        if self.largest == 0.0 {
            return Ok(0.0);
        }
        Ok((modulus(&self.response, rate) / self.largest).min(1.0))
    }

    /// Returns the highest frequency of the grid at which error weight times gain exceeds the control weight.
    pub fn crossover(&self, error: &Weight, control: &Weight) -> Option<f64> {
        let (error, control): (RationalFunction, RationalFunction) = (error.rational(), control.rational());
        let exceeds = |rate: f64, gain: f64| {
            let s = C64::new(0.0, rate);
            error.at(s).norm() * gain > control.at(s).norm()
        };
        self.moduli.iter().rev().find(|(rate, gain)| exceeds(*rate, *gain)).map(|(rate, _)| *rate)
    }
}

/// The largest modulus of an entry; infinite at a pole.
fn modulus(response: &Response, rate: f64) -> f64 {
    response.at(rate).map_or(f64::INFINITY, |value| value.norm_max())
}
