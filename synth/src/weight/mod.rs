//! Weights: what the designer asks of the error and forbids the control, over frequency.
//!
//! A weight multiplies a signal in the cost. A large error weight asks for rejection there; a large control weight
//! forbids effort there. Only |W(jw)| matters to the cost, so zeros and poles in the right half plane are mirrored.

mod form;
mod formula;
pub mod handles;
pub mod shape;
#[cfg(test)]
mod tests;

pub use form::Weight;

use counterpoise_linalg::C64;
use counterpoise_lti::StateSpace;

use crate::Error;
use crate::rational_function::RationalFunction;

impl Weight {
    /// Returns how far a table's function is from its points at most, dB; 0 for every other form.
    pub fn worst_db(&self) -> f64 {
        let Weight::Table { points, fitted, .. } = self else { return 0.0 };
        let off = |&[rate, modulus]: &[f64; 2]| 20.0 * (fitted.magnitude(rate) / modulus).log10().abs();
        points.iter().map(off).fold(0.0, f64::max)
    }

    /// Returns the weight as gain, zeros and poles, as it was written: nothing mirrored.
    pub fn rational(&self) -> RationalFunction {
        match self {
            Weight::Constant { gain } => RationalFunction::new(&[], &[], *gain),
            Weight::Integral { gain, time_s } => RationalFunction::new(&[], &[C64::ZERO], gain / time_s),
            Weight::Lag { gain, time_s } => {
                RationalFunction::new(&[], &[to_complex(-1.0 / time_s)], gain / time_s)
            }
            Weight::Lead { gain, time_s } => {
                RationalFunction::new(&[to_complex(-1.0 / time_s)], &[], gain * time_s)
            }
            Weight::Quadratic { gain, second_s2, first_s } => polynomial(*gain, *second_s2, *first_s, 1.0),
            Weight::QuadraticFreeAtZero { gain, second_s2, first_s } => {
                polynomial(*gain, *second_s2, *first_s, 0.0)
            }
            Weight::ZeroPoleGain { zeros, poles, gain } => RationalFunction::new(zeros, poles, *gain),
            Weight::Shelf { low, high, corner_rad_s } => shelf(*low, *high, *corner_rad_s),
            Weight::Notch { gain, centre_rad_s, width, factor } => {
                notch(*gain, *centre_rad_s, *width, *factor)
            }
            Weight::Product(parts) => parts
                .iter()
                .fold(RationalFunction::new(&[], &[], 1.0), |all, part| all.times(&part.rational())),
            Weight::Table { fitted, .. } => fitted.rational(),
        }
    }

    /// Returns W(jw) as written; infinite at a pole on the axis.
    pub fn response(&self, rate_rad_s: f64) -> C64 {
        self.rational().at(C64::new(0.0, rate_rad_s))
    }

    /// Returns |W(jw)|.
    pub fn magnitude(&self, rate_rad_s: f64) -> f64 {
        self.response(rate_rad_s).norm()
    }

    /// Returns the same weight times `factor`.
    pub fn scale_by(&self, factor: f64) -> Self {
        Weight::Product(vec![Weight::Constant { gain: factor }, self.clone()])
    }

    /// Returns a stable system with the modulus |W(jw)|, poles on the axis kept: what an error weight becomes.
    ///
    /// # Errors
    /// [`Error::Weight`] if the weight has more zeros than poles, or a number that is not finite.
    pub fn realise(&self) -> Result<StateSpace, Error> {
        let mirrored = self.rational().mirror_to_left();
        if mirrored.relative_degree() < 0 {
            return Err(self.weight_error("it rises without bound at high frequency: no proper realisation"));
        }
        self.realise_rational(&mirrored)
    }

    /// Returns a system with the modulus 1/|W(jw)| and the zeros of W as its poles: what a control weight becomes.
    ///
    /// With `u = W^-1 v` the weighted control is v exactly; an improper W needs no far poles, and the controller
    /// inherits its roll-off.
    ///
    /// # Errors
    /// [`Error::Weight`] if the weight has more poles than zeros (it vanishes at high frequency), is zero, or holds
    /// a number that is not finite.
    pub fn realise_inverse(&self) -> Result<StateSpace, Error> {
        let inverse = self.rational().mirror_to_left().inverse();
        if inverse.relative_degree() < 0 {
            return Err(self.weight_error("it vanishes at high frequency, where control would be free"));
        }
        self.realise_rational(&inverse)
    }

    fn realise_rational(&self, rational: &RationalFunction) -> Result<StateSpace, Error> {
        if !rational.is_finite() {
            return Err(self.weight_error("it is zero, or one of its numbers is not finite"));
        }
        rational.realise()
    }

    fn weight_error(&self, problem: &'static str) -> Error {
        Error::Weight { weight: self.to_string(), problem }
    }
}

fn to_complex(value: f64) -> C64 {
    C64::new(value, 0.0)
}

/// `gain (b s^2 + a s + c)`, of lower degree where b or a is zero.
fn polynomial(gain: f64, b: f64, a: f64, c: f64) -> RationalFunction {
    if b != 0.0 {
        return RationalFunction::new(&quadratic_roots(a / b, c / b), &[], gain * b);
    }
    if a != 0.0 {
        RationalFunction::new(&[to_complex(-c / a)], &[], gain * a)
    } else {
        RationalFunction::new(&[], &[], gain * c)
    }
}

/// The roots of s^2 + p s + q, the smaller one without cancellation.
pub(crate) fn quadratic_roots(p: f64, q: f64) -> [C64; 2] {
    let discriminant = 0.25 * p * p - q;
    if discriminant < 0.0 {
        let imaginary = (-discriminant).sqrt();
        return [C64::new(-0.5 * p, imaginary), C64::new(-0.5 * p, -imaginary)];
    }
    let far = -0.5 * p - discriminant.sqrt().copysign(p);
    if far == 0.0 { [C64::ZERO; 2] } else { [to_complex(far), to_complex(q / far)] }
}

/// `high (s + w sqrt(low / high)) / (s + w sqrt(high / low))`.
fn shelf(low: f64, high: f64, corner_rad_s: f64) -> RationalFunction {
    let ratio = (low / high).abs().sqrt();
    RationalFunction::new(&[to_complex(-corner_rad_s * ratio)], &[to_complex(-corner_rad_s / ratio)], high)
}

fn notch(gain: f64, centre: f64, width: f64, factor: f64) -> RationalFunction {
    let roots = |damping: f64| quadratic_roots(2.0 * damping * centre, centre * centre);
    RationalFunction::new(&roots(width * factor), &roots(width), gain)
}
