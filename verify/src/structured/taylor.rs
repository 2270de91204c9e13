//! Functions of the frequency with a bound of what their tangent leaves out: how a condition is shown to hold between the points of a
//! grid.
//!
//! ```text
//!     |f(w + x) - value - slope x| <= rest,     -half <= x <= half
//! ```
//!
//! (R. Moore, *Interval Analysis*, 1966; K. Makino and M. Berz, Taylor models, 2003.) Rounding errors are not enclosed: a least eigenvalue
//! of 2e-9 of the largest, the narrowest proof of the examples, comes out alike to 2e-5 when the response is computed another way.

use std::ops::{Add, Mul};

use counterpoise_linalg::{C64, CMat, Mat, Schur, schur};
use counterpoise_lti::{StateSpace, Timebase};

/// A function of the rate over an interval: its tangent in the middle, and what that leaves out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Taylor {
    /// Value in the middle.
    pub value: C64,
    /// Derivative in the middle, s/rad.
    pub slope: C64,
    /// Largest distance from the tangent over the interval.
    pub rest: f64,
    /// Half the interval, rad/s.
    pub half_rad_s: f64,
}

/// An interval of rates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RateInterval {
    /// Middle, rad/s.
    pub middle_rad_s: f64,
    /// Half the width, rad/s; 0 for a point.
    pub half_rad_s: f64,
}

impl Taylor {
    /// Returns a constant.
    pub fn constant(value: C64, over: RateInterval) -> Self {
        Self { value, slope: C64::new(0.0, 0.0), rest: 0.0, half_rad_s: over.half_rad_s }
    }

    /// Returns j w times a factor.
    pub fn derivative(factor: f64, over: RateInterval) -> Self {
        let slope = C64::new(0.0, factor);
        Self { value: slope * over.middle_rad_s, slope, rest: 0.0, half_rad_s: over.half_rad_s }
    }

    /// Returns exp(-j w time).
    pub fn delay(time_s: f64, over: RateInterval) -> Self {
        let value = C64::from_polar(1.0, -over.middle_rad_s * time_s);
        let rest = 0.5 * (over.half_rad_s * time_s).powi(2);
        Self { value, slope: C64::new(0.0, -time_s) * value, rest, half_rad_s: over.half_rad_s }
    }

    /// Returns the response of a hold over a period: (1 - exp(-j w T)) / (j w T), the mean of exp(-j w t) over the period.
    pub fn hold(period_s: f64, over: RateInterval) -> Self {
        let j = C64::new(0.0, over.middle_rad_s * period_s);
        let late = (-j).exp();
        let value = (1.0 - late) / j;
        let slope = (late - value) / over.middle_rad_s;
        // the second derivative is the mean of -t^2 exp(-j w t): T^2 / 3 at most
        let rest = (over.half_rad_s * period_s).powi(2) / 6.0;
        Self { value, slope, rest, half_rad_s: over.half_rad_s }
    }

    /// Returns the complex conjugate.
    pub fn conj(self) -> Self {
        Self { value: self.value.conj(), slope: self.slope.conj(), ..self }
    }

    /// Returns the reciprocal; its rest is infinite if the function may pass through 0.
    pub fn recip(self) -> Self {
        let size = self.value.norm();
        let change = (self.half_rad_s * self.slope.norm() + self.rest) / size;
        let value = self.value.inv();
        let rest = if change < 1.0 {
            (self.rest / size + change * change / (1.0 - change)) / size
        } else {
            f64::INFINITY
        };
        Self { value, slope: -self.slope * value * value, rest, half_rad_s: self.half_rad_s }
    }

    /// Returns the largest modulus over the interval.
    pub fn largest_modulus(self) -> f64 {
        self.value.norm() + self.half_rad_s * self.slope.norm() + self.rest
    }
}

impl Add for Taylor {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            slope: self.slope + other.slope,
            rest: self.rest + other.rest,
            half_rad_s: self.half_rad_s,
        }
    }
}

impl Mul for Taylor {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let straight = |of: Self| of.value.norm() + of.half_rad_s * of.slope.norm();
        let bent = self.half_rad_s.powi(2) * self.slope.norm() * other.slope.norm();
        Self {
            value: self.value * other.value,
            slope: self.value * other.slope + self.slope * other.value,
            rest: bent + self.rest * (straight(other) + other.rest) + other.rest * straight(self),
            half_rad_s: self.half_rad_s,
        }
    }
}

impl Mul<f64> for Taylor {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self {
            value: self.value * factor,
            slope: self.slope * factor,
            rest: self.rest * factor.abs(),
            half_rad_s: self.half_rad_s,
        }
    }
}

/// A system whose response is asked for over many intervals, in the coordinates of its real Schur form.
pub struct SchurSystem {
    form: Schur,
    /// n x m.
    B: CMat,
    /// p x n.
    C: CMat,
    /// p x m.
    D: Mat,
    timebase: Timebase,
}

impl SchurSystem {
    /// Transforms a system, which should be balanced: rounding is relative to its largest entries.
    ///
    /// # Errors
    /// Those of [`schur`](fn@schur).
    pub fn of(system: &StateSpace) -> Result<Self, counterpoise_lti::Error> {
        let what = "response over intervals";
        let form = schur(&system.A).map_err(|source| counterpoise_lti::Error::Matrix { what, source })?;
        let (B, C) = (form.U.t() * &system.B, &system.C * &form.U);
        Ok(Self {
            B: B.to_complex(),
            C: C.to_complex(),
            D: system.D.clone(),
            form,
            timebase: system.timebase,
        })
    }

    /// Returns the response over an interval of rates, by rows. With the resolvent R = (s I - A)^-1,
    /// R(s + d) = R - d R^2 + d^2 R^3 (I + d R)^-1.
    /// `None` if the middle of the interval is a pole.
    pub fn evaluate_over(&self, over: RateInterval) -> Option<Vec<Vec<Taylor>>> {
        let half = over.half_rad_s;
        // the point, its derivative with the rate, how far it moves, and how far it leaves its tangent
        let (point, along, moved, bent) = match self.timebase {
            Timebase::Continuous => (C64::new(0.0, over.middle_rad_s), C64::new(0.0, 1.0), half, 0.0),
            Timebase::Discrete { period_s } => {
                let point = C64::from_polar(1.0, over.middle_rad_s * period_s);
                let angle = half * period_s;
                (point, C64::new(0.0, period_s) * point, angle, 0.5 * angle * angle)
            }
        };
        let resolvent = self.form.resolvent(point)?;
        let size = resolvent.norm_fro();
        let (CR, RB) = ((&self.C * &resolvent).t(), &resolvent * &self.B);
        let tail =
            if moved * size < 1.0 { moved * moved * size / (1.0 - moved * size) } else { f64::INFINITY };
        let tail = if moved == 0.0 { 0.0 } else { tail };
        let rows = self.C.t();
        let sum = |left: &[C64], right: &[C64]| left.iter().zip(right).map(|(x, y)| x * y).sum::<C64>();
        let length = |all: &[C64]| all.iter().map(|x| x.norm_sqr()).sum::<f64>().sqrt();
        let entry = |i: usize, j: usize| {
            let first = -sum(CR.column(i), RB.column(j));
            let value = sum(rows.column(i), RB.column(j)) + self.D[(i, j)];
            let sizes = length(CR.column(i)) * length(RB.column(j));
            let rest = bent * first.norm() + if sizes == 0.0 { 0.0 } else { tail * sizes };
            Taylor { value, slope: along * first, rest, half_rad_s: half }
        };
        let (outputs, inputs) = self.D.shape();
        Some((0..outputs).map(|i| (0..inputs).map(|j| entry(i, j)).collect()).collect())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use counterpoise_lti::response_at;

    fn is_inside(found: Taylor, exact: C64, x: f64) -> bool {
        (exact - found.value - found.slope * x).norm() <= found.rest * (1.0 + 1e-9) + 1e-12
    }

    #[test]
    fn responses_stay_within_their_bounds_between_the_points() {
        let A = Mat::from_rows(&[[0.0, 1.0], [-400.0, -0.8]]);
        for timebase in [Timebase::Continuous, Timebase::Discrete { period_s: 0.01 }] {
            let A = if timebase == Timebase::Continuous { A.clone() } else { A.scale(0.002) };
            let system =
                StateSpace::new(A, Mat::col(&[0.3, 1.0]), Mat::row(&[5.0, 1.0]), Mat::row(&[0.2]), timebase)
                    .unwrap();
            let evaluated = SchurSystem::of(&system).unwrap();
            // Beside the resonance at 20 rad/s, whose half-width is 0.4, the wide interval has no finite bound: it is halved.
            for (middle_rad_s, half_rad_s) in
                [(2.0, 0.2), (15.0, 0.2), (19.9, 0.2), (19.9, 0.01), (40.0, 0.2)]
            {
                let over = RateInterval { middle_rad_s, half_rad_s };
                let found = evaluated.evaluate_over(over).unwrap()[0][0];
                for x in [-1.0, -0.5, 0.35, 1.0].map(|share| share * half_rad_s) {
                    let exact = response_at(&system, middle_rad_s + x).unwrap()[(0, 0)];
                    assert!(is_inside(found, exact, x), "{timebase:?} {middle_rad_s} {x}");
                    assert!(is_inside(found.recip(), exact.inv(), x), "{timebase:?} {middle_rad_s} {x}");
                    let squared = found * found + found.conj();
                    assert!(
                        is_inside(squared, exact * exact + exact.conj(), x),
                        "{timebase:?} {middle_rad_s} {x}"
                    );
                }
                let is_wide = (middle_rad_s, half_rad_s) == (19.9, 0.2) && timebase == Timebase::Continuous;
                assert!(
                    is_wide || found.rest.is_finite() && found.rest < found.largest_modulus(),
                    "{timebase:?} {over:?}"
                );
            }
        }
    }

    #[test]
    fn a_hold_and_a_delay_stay_within_their_bounds() {
        let over = RateInterval { middle_rad_s: 700.0, half_rad_s: 30.0 };
        let period_s = 1e-3;
        for x in [-30.0, -7.0, 30.0] {
            let j = C64::new(0.0, (700.0 + x) * period_s);
            assert!(is_inside(Taylor::hold(period_s, over), (1.0 - (-j).exp()) / j, x));
            assert!(is_inside(Taylor::delay(period_s, over), (-j).exp(), x));
        }
    }
}
