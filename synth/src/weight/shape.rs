//! The shape of a weight over frequency: both ends, and where one passes into the other.

use crate::rational_function::RationalFunction;
use crate::weight::Weight;

/// Course of a weight over frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WeightShape {
    /// The same at every frequency.
    Constant {
        /// Modulus.
        modulus: f64,
    },
    /// The weight has zeros or poles.
    Varying {
        /// Towards zero frequency.
        low: LowFrequency,
        /// The place of the change.
        transition: Transition,
        /// Towards infinite frequency.
        high: HighFrequency,
    },
}

/// A weight towards zero frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LowFrequency {
    /// The weight tends to a modulus.
    Level {
        /// The modulus.
        modulus: f64,
    },
    /// The weight has poles at the origin.
    Unbounded,
    /// The weight has zeros at the origin.
    Zero,
}

/// A weight towards infinite frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HighFrequency {
    /// The weight tends to a modulus.
    Level {
        /// The modulus.
        modulus: f64,
    },
    /// The weight rises with a power of the frequency.
    Rising {
        /// The power.
        power: i32,
    },
    /// The weight falls with a power of the frequency.
    Falling {
        /// The power, positive.
        power: i32,
    },
}

/// Transition of a weight from one end to the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Transition {
    /// A power of the frequency at all rates: where its modulus is one.
    UnitModulus {
        /// The rate, rad/s.
        rate_rad_s: f64,
    },
    /// The rate at which its modulus leaves that of low frequency by 3 dB.
    Corner {
        /// The rate, rad/s.
        rate_rad_s: f64,
    },
    /// Level at both ends, and largest between them by more than 3 dB.
    Peak {
        /// The rate, rad/s.
        rate_rad_s: f64,
        /// The modulus there.
        modulus: f64,
    },
    /// Level at both ends, and smallest between them by more than 3 dB.
    Dip {
        /// The rate, rad/s.
        rate_rad_s: f64,
        /// The modulus there.
        modulus: f64,
    },
}

impl Weight {
    /// Returns the shape of the weight over frequency.
    pub fn shape(&self) -> WeightShape {
        let rational = self.rational();
        let modulus = rational.gain.abs();
        if rational.zeros.is_empty() && rational.poles.is_empty() {
            return WeightShape::Constant { modulus };
        }
        let low = match rational.order_at_zero() {
            0 => LowFrequency::Level { modulus: self.magnitude(0.0) },
            n if n < 0 => LowFrequency::Unbounded,
            _ => LowFrequency::Zero,
        };
        let high = match rational.relative_degree() {
            0 => HighFrequency::Level { modulus },
            n if n < 0 => HighFrequency::Rising { power: -n },
            n => HighFrequency::Falling { power: n },
        };
        let transition = match self.corner(&rational) {
            None => Transition::UnitModulus {
                rate_rad_s: modulus.powf(1.0 / f64::from(rational.relative_degree())),
            },
            Some(rate_rad_s) => self.extreme(&rational).unwrap_or(Transition::Corner { rate_rad_s }),
        };
        WeightShape::Varying { low, transition, high }
    }

    /// The rates over which a weight with roots off the origin changes, evenly spaced on a logarithmic axis.
    fn rates(rational: &RationalFunction) -> Option<Vec<f64>> {
        let moduli =
            rational.zeros.iter().chain(&rational.poles).map(|root| root.norm()).filter(|r| *r > 0.0);
        let (least, most) = moduli.fold((f64::INFINITY, 0.0_f64), |(a, b), r| (a.min(r), b.max(r)));
        let (from, to) = (least * 1e-3, most * 1e3);
        let rate = |k: usize| from * (to / from).powf(k as f64 / (SHAPE_POINTS - 1) as f64);
        (most > 0.0).then(|| (0..SHAPE_POINTS).map(rate).collect())
    }

    /// The rate at which the modulus leaves that of low frequency by 3 dB; `None` if every root is at the origin.
    fn corner(&self, rational: &RationalFunction) -> Option<f64> {
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

    /// Returns where a weight that is level at both ends is largest or smallest between them, if by more than 3 dB.
    fn extreme(&self, rational: &RationalFunction) -> Option<Transition> {
        if rational.order_at_zero() != 0 || rational.relative_degree() != 0 {
            return None;
        }
        let rates = Self::rates(rational)?;
        let ends = [self.magnitude(0.0), rational.gain.abs()];
        let values: Vec<(f64, f64)> = rates.iter().map(|&rate| (rate, self.magnitude(rate))).collect();
        let most = values.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let least = values.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1))?;
        if most.1 > 2f64.sqrt() * ends[0].max(ends[1]) {
            return Some(Transition::Peak { rate_rad_s: most.0, modulus: most.1 });
        }
        (least.1 * 2f64.sqrt() < ends[0].min(ends[1]))
            .then_some(Transition::Dip { rate_rad_s: least.0, modulus: least.1 })
    }
}

/// Frequencies at which a weight is evaluated for its shape.
const SHAPE_POINTS: usize = 601;
/// Halvings of the stretch in which a corner lies.
const BISECTIONS: usize = 20;
