//! Weights: what the designer asks of the error and forbids the control, over frequency.
//!
//! A weight multiplies a signal in the cost. A large error weight asks for rejection there; a large control weight
//! forbids effort there. Only |W(jw)| matters to the cost, so zeros and poles in the right half plane are mirrored.

use std::f64::consts::TAU;
use std::fmt;

use counterpoise_lti::{C64, StateSpace};

use crate::Error;
use crate::rational::Rational;

/// A weight over frequency, in the forms of the source thesis and those that a designer draws.
#[derive(Debug, Clone, PartialEq)]
pub enum Weight {
    /// `K`: the same at every frequency.
    Constant {
        /// K.
        gain: f64,
    },
    /// `K / (a s)`: infinite at zero frequency, so that no steady error remains.
    Integral {
        /// K.
        gain: f64,
        /// a, s.
        time_s: f64,
    },
    /// `K / (a s + 1)`: K below 1/a, falling above.
    Lag {
        /// K.
        gain: f64,
        /// a, s.
        time_s: f64,
    },
    /// `K (a s + 1)`: K below 1/a, rising above.
    Lead {
        /// K.
        gain: f64,
        /// a, s.
        time_s: f64,
    },
    /// `K (b s^2 + a s + 1)`: K at low frequency, rising with the square above 1/sqrt(b).
    Quadratic {
        /// K.
        gain: f64,
        /// b, s^2.
        second_s2: f64,
        /// a, s.
        first_s: f64,
    },
    /// `K (b s^2 + a s)`: nothing at zero frequency (steady control is free), rising with the square.
    QuadraticFreeAtZero {
        /// K.
        gain: f64,
        /// b, s^2.
        second_s2: f64,
        /// a, s.
        first_s: f64,
    },
    /// `K prod(s - z) / prod(s - p)`.
    ZeroPoleGain {
        /// Zeros, rad/s; complex ones with their conjugates.
        zeros: Vec<C64>,
        /// Poles, rad/s; complex ones with their conjugates.
        poles: Vec<C64>,
        /// K.
        gain: f64,
    },
    /// From `low` well below the corner to `high` well above it, first order: the modulus is sqrt(low high) at the corner.
    Shelf {
        /// Modulus at zero frequency.
        low: f64,
        /// Modulus at infinity.
        high: f64,
        /// Corner, rad/s.
        corner_rad_s: f64,
    },
    /// `K (s^2 + 2 z g w s + w^2) / (s^2 + 2 z w s + w^2)`: K everywhere but near w, where it is K g (g < 1 a notch,
    /// g > 1 a peak).
    Notch {
        /// K.
        gain: f64,
        /// w, rad/s.
        centre_rad_s: f64,
        /// z, the relative half width.
        width: f64,
        /// g, the factor at the centre.
        factor: f64,
    },
    /// The product of weights.
    Product(Vec<Weight>),
    /// A table of moduli, by the stable function of minimum phase that comes nearest to it ([`Weight::table`]).
    Table {
        /// Frequency in rad/s and modulus, the frequencies rising.
        points: Vec<[f64; 2]>,
        /// Order of the function.
        order: usize,
        /// The function.
        fitted: Box<Weight>,
    },
}

impl Weight {
    /// A table of (frequency in rad/s, modulus), fitted by a function of the given order ([`crate::fit_table`]).
    ///
    /// # Errors
    /// As [`crate::fit_table`].
    pub fn table(points: &[[f64; 2]], order: usize) -> Result<Self, Error> {
        let pairs: Vec<(f64, f64)> = points.iter().map(|&[rate, modulus]| (rate, modulus)).collect();
        let fitted = Box::new(crate::fit_table(&pairs, order)?.weight);
        Ok(Weight::Table { points: points.to_vec(), order, fitted })
    }

    /// How far a table's function is from its points at most, dB; 0 for every other form.
    pub fn worst_db(&self) -> f64 {
        let Weight::Table { points, fitted, .. } = self else { return 0.0 };
        let off = |&[rate, modulus]: &[f64; 2]| 20.0 * (fitted.magnitude(rate) / modulus).log10().abs();
        points.iter().map(off).fold(0.0, f64::max)
    }

    /// The weight as gain, zeros and poles, as it was written: nothing mirrored.
    pub fn rational(&self) -> Rational {
        match self {
            Weight::Constant { gain } => Rational::new(&[], &[], *gain),
            Weight::Integral { gain, time_s } => Rational::new(&[], &[C64::ZERO], gain / time_s),
            Weight::Lag { gain, time_s } => Rational::new(&[], &[real(-1.0 / time_s)], gain / time_s),
            Weight::Lead { gain, time_s } => Rational::new(&[real(-1.0 / time_s)], &[], gain * time_s),
            Weight::Quadratic { gain, second_s2, first_s } => polynomial(*gain, *second_s2, *first_s, 1.0),
            Weight::QuadraticFreeAtZero { gain, second_s2, first_s } => {
                polynomial(*gain, *second_s2, *first_s, 0.0)
            }
            Weight::ZeroPoleGain { zeros, poles, gain } => Rational::new(zeros, poles, *gain),
            Weight::Shelf { low, high, corner_rad_s } => shelf(*low, *high, *corner_rad_s),
            Weight::Notch { gain, centre_rad_s, width, factor } => {
                notch(*gain, *centre_rad_s, *width, *factor)
            }
            Weight::Product(parts) => {
                parts.iter().fold(Rational::new(&[], &[], 1.0), |all, part| all.times(&part.rational()))
            }
            Weight::Table { fitted, .. } => fitted.rational(),
        }
    }

    /// W(jw) as written; infinite at a pole on the axis.
    pub fn response(&self, rate_rad_s: f64) -> C64 {
        self.rational().at(C64::new(0.0, rate_rad_s))
    }

    /// |W(jw)|.
    pub fn magnitude(&self, rate_rad_s: f64) -> f64 {
        self.response(rate_rad_s).norm()
    }

    /// The same weight times `factor`.
    pub fn scaled(&self, factor: f64) -> Self {
        Weight::Product(vec![Weight::Constant { gain: factor }, self.clone()])
    }

    /// A stable system with the modulus |W(jw)|, poles on the axis kept: what an error weight becomes.
    ///
    /// # Errors
    /// [`Error::Weight`] where the weight has more zeros than poles, or a number that is not finite.
    pub fn realise(&self) -> Result<StateSpace, Error> {
        let mirrored = self.rational().mirrored();
        self.refuse(
            mirrored.relative_degree() < 0,
            "it rises without bound at high frequency: no proper realisation",
        )?;
        self.realised(&mirrored)
    }

    /// A system with the modulus 1/|W(jw)| and the zeros of W as its poles: what a control weight becomes.
    ///
    /// With `u = W^-1 v` the weighted control is v exactly; an improper W needs no far poles, and the controller
    /// inherits its roll-off.
    ///
    /// # Errors
    /// [`Error::Weight`] where the weight has more poles than zeros (it vanishes at high frequency), is zero, or holds
    /// a number that is not finite.
    pub fn realise_inverse(&self) -> Result<StateSpace, Error> {
        let inverse = self.rational().mirrored().inverse();
        self.refuse(
            inverse.relative_degree() < 0,
            "it vanishes at high frequency, where control would be free",
        )?;
        self.realised(&inverse)
    }

    fn realised(&self, rational: &Rational) -> Result<StateSpace, Error> {
        self.refuse(!rational.is_finite(), "it is zero, or one of its numbers is not finite")?;
        rational.realise()
    }

    fn refuse(&self, wrong: bool, problem: &'static str) -> Result<(), Error> {
        if wrong { Err(Error::Weight { weight: self.to_string(), problem }) } else { Ok(()) }
    }

    /// What the weight means in words, as a weight on the `signal` ("error", "control"): what it says of the steady and of
    /// the fast signal, up to where it is the one, and where it weighs most or least in between.
    pub fn meaning(&self, signal: &str) -> String {
        let rational = self.rational();
        if rational.zeros.is_empty() && rational.poles.is_empty() {
            return format!("weight on the {signal}: {} at every frequency", plain(rational.gain.abs()));
        }
        let low = match rational.order_at_zero() {
            0 => format!("{} at low frequency", plain(self.magnitude(0.0))),
            n if n < 0 => {
                format!("without bound towards zero frequency, so that no steady {signal} may remain")
            }
            _ => format!("nothing at zero frequency, so that a steady {signal} is free"),
        };
        let high = match rational.relative_degree() {
            0 => format!("{} at high frequency", plain(rational.gain.abs())),
            n if n < 0 => {
                format!("rising with the power {} of frequency, so that fast {signal} is forbidden", -n)
            }
            n => format!("falling with the power {n} of frequency, so that fast {signal} is let be"),
        };
        let between = match (self.corner(&rational), self.extreme(&rational)) {
            (None, _) => format!(
                "1 at {} Hz",
                plain(rational.gain.abs().powf(1.0 / rational.relative_degree() as f64) / TAU)
            ),
            (Some(corner), None) => format!("up to {} Hz", plain(corner / TAU)),
            (Some(_), Some((rate, modulus, which))) => {
                format!("{which} at {} Hz ({})", plain(rate / TAU), plain(modulus))
            }
        };
        format!("weight on the {signal}: {low}, {between}; {high}")
    }

    /// The rates over which a weight with roots off the origin changes, evenly spaced on a logarithmic axis.
    fn rates(rational: &Rational) -> Option<Vec<f64>> {
        let moduli =
            rational.zeros.iter().chain(&rational.poles).map(|root| root.norm()).filter(|r| *r > 0.0);
        let (least, most) = moduli.fold((f64::INFINITY, 0.0_f64), |(a, b), r| (a.min(r), b.max(r)));
        let (from, to) = (least * 1e-3, most * 1e3);
        let rate = |k: usize| from * (to / from).powf(k as f64 / (MEANING_POINTS - 1) as f64);
        (most > 0.0).then(|| (0..MEANING_POINTS).map(rate).collect())
    }

    /// The rate at which the modulus leaves that of low frequency by 3 dB; `None` if every root is at the origin.
    fn corner(&self, rational: &Rational) -> Option<f64> {
        let (rates, order) = (Self::rates(rational)?, rational.order_at_zero());
        let level = |rate: f64| self.magnitude(rate) / rate.powi(order);
        let start = level(*rates.first()?);
        let left = |rate: f64| (level(rate) / start).ln().abs() > 2f64.sqrt().ln();
        let Some(first) = rates.iter().position(|rate| left(*rate)) else { return rates.last().copied() };
        let (mut before, mut after) = (rates[first.saturating_sub(1)], rates[first]);
        for _ in 0..BISECTIONS {
            let middle = (before * after).sqrt();
            (before, after) = if left(middle) { (before, middle) } else { (middle, after) };
        }
        Some(after)
    }

    /// Where a weight that is level at both ends is largest or smallest between them, if by more than 3 dB: rate, modulus and
    /// which.
    fn extreme(&self, rational: &Rational) -> Option<(f64, f64, &'static str)> {
        if rational.order_at_zero() != 0 || rational.relative_degree() != 0 {
            return None;
        }
        let rates = Self::rates(rational)?;
        let ends = [self.magnitude(0.0), rational.gain.abs()];
        let values: Vec<(f64, f64)> = rates.iter().map(|&rate| (rate, self.magnitude(rate))).collect();
        let most = values.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let least = values.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1))?;
        if most.1 > 2f64.sqrt() * ends[0].max(ends[1]) {
            return Some((most.0, most.1, "most"));
        }
        (least.1 * 2f64.sqrt() < ends[0].min(ends[1])).then_some((least.0, least.1, "least"))
    }
}

/// Frequencies at which a weight is looked at for its meaning.
const MEANING_POINTS: usize = 601;
/// Halvings of the stretch in which a corner lies.
const BISECTIONS: usize = 20;

/// Three significant digits, as a person writes them.
fn plain(value: f64) -> String {
    if !(1e-3..1e6).contains(&value) {
        return format!("{value:.2e}");
    }
    let decimals = (2.0 - value.log10().floor()).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

impl fmt::Display for Weight {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Weight::Constant { gain } => write!(f, "{gain}"),
            Weight::Integral { gain, time_s } => write!(f, "{gain} / ({time_s} s)"),
            Weight::Lag { gain, time_s } => write!(f, "{gain} / ({time_s} s + 1)"),
            Weight::Lead { gain, time_s } => write!(f, "{gain} ({time_s} s + 1)"),
            Weight::Quadratic { gain, second_s2, first_s } => {
                write!(f, "{gain} ({second_s2} s^2 + {first_s} s + 1)")
            }
            Weight::QuadraticFreeAtZero { gain, second_s2, first_s } => {
                write!(f, "{gain} ({second_s2} s^2 + {first_s} s)")
            }
            Weight::ZeroPoleGain { zeros, poles, gain } => {
                write!(f, "zero-pole-gain with {} zeros, {} poles, gain {gain}", zeros.len(), poles.len())
            }
            Weight::Shelf { low, high, corner_rad_s } => {
                write!(f, "shelf from {low} to {high} at {corner_rad_s} rad/s")
            }
            Weight::Notch { gain, centre_rad_s, factor, .. } => {
                write!(f, "{gain}, times {factor} near {centre_rad_s} rad/s")
            }
            Weight::Product(parts) => {
                let texts: Vec<String> = parts.iter().map(ToString::to_string).collect();
                write!(f, "({})", texts.join(") ("))
            }
            Weight::Table { points, order, .. } => {
                let (count, off) = (points.len(), self.worst_db());
                write!(f, "table of {count} points, by a function of order {order} within {off:.2} dB")
            }
        }
    }
}

fn real(value: f64) -> C64 {
    C64::new(value, 0.0)
}

/// `gain (b s^2 + a s + c)`, of lower degree where b or a is zero.
fn polynomial(gain: f64, b: f64, a: f64, c: f64) -> Rational {
    if b != 0.0 {
        return Rational::new(&quadratic_roots(a / b, c / b), &[], gain * b);
    }
    if a != 0.0 { Rational::new(&[real(-c / a)], &[], gain * a) } else { Rational::new(&[], &[], gain * c) }
}

/// The roots of s^2 + p s + q, the smaller one without cancellation.
fn quadratic_roots(p: f64, q: f64) -> [C64; 2] {
    let discriminant = 0.25 * p * p - q;
    if discriminant < 0.0 {
        let imaginary = (-discriminant).sqrt();
        return [C64::new(-0.5 * p, imaginary), C64::new(-0.5 * p, -imaginary)];
    }
    let far = -0.5 * p - discriminant.sqrt().copysign(p);
    if far == 0.0 { [C64::ZERO; 2] } else { [real(far), real(q / far)] }
}

/// `high (s + w sqrt(low / high)) / (s + w sqrt(high / low))`.
fn shelf(low: f64, high: f64, corner_rad_s: f64) -> Rational {
    let ratio = (low / high).abs().sqrt();
    Rational::new(&[real(-corner_rad_s * ratio)], &[real(-corner_rad_s / ratio)], high)
}

fn notch(gain: f64, centre: f64, width: f64, factor: f64) -> Rational {
    let roots = |damping: f64| quadratic_roots(2.0 * damping * centre, centre * centre);
    Rational::new(&roots(width * factor), &roots(width), gain)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use counterpoise_lti::response::response_at;

    fn all() -> Vec<Weight> {
        vec![
            Weight::Constant { gain: 3.0 },
            Weight::Integral { gain: 2.0, time_s: 0.5 },
            Weight::Lag { gain: 2.0, time_s: 0.5 },
            Weight::Lead { gain: 0.2, time_s: 0.01 },
            Weight::Quadratic { gain: 0.1, second_s2: 1e-4, first_s: 0.03 },
            Weight::QuadraticFreeAtZero { gain: 0.1, second_s2: 1e-4, first_s: 0.03 },
            Weight::Shelf { low: 10.0, high: 0.1, corner_rad_s: 3.0 },
            Weight::Notch { gain: 2.0, centre_rad_s: 100.0, width: 0.1, factor: 0.01 },
        ]
    }

    #[test]
    fn realisations_have_the_modulus_of_the_weight() {
        for weight in all() {
            for rate in [0.1, 3.0, 100.0, 4000.0] {
                let expected = weight.magnitude(rate);
                if let Ok(system) = weight.realise() {
                    let found = response_at(&system, rate).unwrap()[(0, 0)].norm();
                    assert!((found / expected - 1.0).abs() < 1e-12, "{weight} at {rate}: {found} {expected}");
                }
                if let Ok(system) = weight.realise_inverse() {
                    let found = response_at(&system, rate).unwrap()[(0, 0)].norm();
                    assert!((found * expected - 1.0).abs() < 1e-12, "1/({weight}) at {rate}");
                }
            }
        }
    }

    #[test]
    fn improper_weights_have_an_inverse_of_their_own_order_and_no_other() {
        let weight = Weight::Quadratic { gain: 0.1, second_s2: 1e-4, first_s: 0.03 };
        assert!(weight.realise().is_err());
        let inverse = weight.realise_inverse().unwrap();
        assert_eq!((inverse.order(), inverse.D[(0, 0)]), (2, 0.0));
        assert!(Weight::Lag { gain: 1.0, time_s: 1.0 }.realise_inverse().is_err());
        assert!(Weight::Constant { gain: 0.0 }.realise_inverse().is_err());
        assert!(Weight::Lag { gain: 1.0, time_s: f64::NAN }.realise().is_err());
    }

    #[test]
    fn corners_are_where_they_are_said_to_be() {
        let shelf = Weight::Shelf { low: 10.0, high: 0.1, corner_rad_s: 3.0 };
        assert!((shelf.magnitude(0.0) - 10.0).abs() < 1e-12);
        assert!((shelf.magnitude(3.0) - 1.0).abs() < 1e-12);
        let notch = Weight::Notch { gain: 2.0, centre_rad_s: 100.0, width: 0.1, factor: 0.01 };
        assert!((notch.magnitude(100.0) - 0.02).abs() < 1e-12);
        assert!((notch.magnitude(0.0) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn right_half_plane_roots_are_mirrored() {
        let poles = [C64::new(0.3, 0.0)];
        let weight = Weight::ZeroPoleGain { zeros: vec![], poles: poles.to_vec(), gain: 2.0 };
        let system = weight.realise().unwrap();
        assert_eq!(system.A[(0, 0)], -0.3);
    }

    #[test]
    fn a_table_is_the_function_that_comes_nearest() {
        let lag = |rate: f64| 30.0 / (1.0 + (rate / 2.0).powi(2)).sqrt() + 0.5;
        let points: Vec<[f64; 2]> =
            (0..12).map(|k| 0.05 * 2.5_f64.powi(k)).map(|rate| [rate, lag(rate)]).collect();
        let table = Weight::table(&points, 2).unwrap();
        assert!(table.worst_db() < 0.5, "{}", table.worst_db());
        assert!(table.realise().is_ok() && table.to_string().contains("table of 12 points"), "{table}");
        assert!(Weight::table(&points[..3], 2).is_err());
    }

    #[test]
    fn the_meaning_names_both_ends_and_where_one_passes_into_the_other() {
        let said = |weight: Weight, signal: &str, words: &[&str]| {
            let text = weight.meaning(signal);
            words.iter().for_each(|word| assert!(text.contains(word), "{word}: {text}"));
        };
        let integral = Weight::Integral { gain: 1.0, time_s: 0.5 };
        said(integral, "error", &["no steady error may remain", "1 at 0.318 Hz", "fast error is let be"]);
        let lead = Weight::Lead { gain: 1.0, time_s: 0.005 };
        said(lead, "control", &["1 at low frequency, up to 31", "fast control is forbidden"]);
        let shelf = Weight::Shelf { low: 100.0, high: 1.0, corner_rad_s: 20.0 };
        said(shelf, "error", &["100 at low frequency, up to ", "; 1 at high frequency"]);
        let notch = Weight::Notch { gain: 2.0, centre_rad_s: 50.0, width: 0.2, factor: 10.0 };
        said(notch, "error", &["2 at low frequency", "at 7.9", "2 at high frequency"]);
        said(Weight::Constant { gain: 300.0 }, "hub rate", &["300 at every frequency"]);
        let free = Weight::QuadraticFreeAtZero { gain: 1.0, second_s2: 1e-4, first_s: 1.4e-2 };
        said(free, "control", &["a steady control is free, up to", "power 2"]);
    }
}
