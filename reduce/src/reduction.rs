//! The request for a reduction and its result.

use crate::Error;
use crate::tolerance::PAIRED_VALUES;
use counterpoise_lti::{Peak, StateSpace};

/// Choice of the number of states to keep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Order {
    /// This many in all, poles that must be kept among them.
    States(usize),
    /// As few as the bound on the H-infinity error allows.
    Error {
        /// The largest error allowed.
        largest: f64,
    },
    /// Every state with a Hankel value above this share of the largest.
    Relative {
        /// The share, between 0 and 1.
        share: f64,
    },
}

/// Method of a reduction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Balanced truncation in balanced coordinates (Tombs and Postlethwaite 1987).
    SquareRoot,
    /// The same response from orthogonal bases (Varga 1991): accurate where states are almost uncontrollable.
    BalancingFree,
    /// Singular perturbation of the balanced system (Liu and Anderson 1989): the gain at zero frequency is kept.
    MatchDc,
}

/// A reduced system and what is known of its error.
#[derive(Debug, Clone, PartialEq)]
pub struct Reduction {
    /// The reduced system.
    pub system: StateSpace,
    /// The values by which states were ranked, largest first (Hankel values; with weights, weighted ones). States that
    /// had to be kept are not among them.
    pub hankel: Vec<f64>,
    /// A priori bound on the H-infinity error, where the method has one.
    pub bound: Option<f64>,
    /// The H-infinity error, measured, and where it is largest.
    pub measured_error: Peak,
    /// States kept of those that were ranked.
    pub kept: usize,
    /// Poles on or beyond the border of stability that were put back unchanged.
    pub untouched: usize,
    /// Warnings for the user.
    pub warnings: Vec<Warning>,
}

/// Warning about a reduction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Warning {
    /// The cut lies between two values of almost the same size: one more or one less state is the better choice.
    CutsPair {
        /// The last value kept.
        kept: f64,
        /// The first value dropped.
        dropped: f64,
    },
    /// Fewer states than asked for carry anything above rounding.
    FewerThanAsked {
        /// Asked for.
        asked: usize,
        /// Kept.
        kept: usize,
    },
    /// The system is too large for the exact norm: its error was measured at this many frequencies.
    MeasuredOnGrid {
        /// Number of frequencies.
        points: usize,
    },
    /// The loop with the reduced controller is not stable.
    LoopUnstable {
        /// Real part of the worst pole.
        re: f64,
        /// Imaginary part of the worst pole.
        im: f64,
    },
    /// The iteration for the Gramians of a large structure ended before its steps became small.
    GramiansUnfinished {
        /// Contribution of the last step, as a share of the factor.
        share: f64,
    },
    /// The gap at which a realisation was cut is too small to be sure of the order.
    SmallGap {
        /// Smallest value kept.
        kept: f64,
        /// Largest value dropped.
        dropped: f64,
    },
}

/// Returns how many of the ranked values to keep, and what there is to say about it.
pub(crate) fn choose(hankel: &[f64], order: Order, untouched: usize) -> Result<(usize, Vec<Warning>), Error> {
    let largest = hankel.first().copied().unwrap_or(0.0);
    let numerical = count_above_rounding(hankel);
    let asked = match order {
        Order::States(wanted) => {
            wanted.checked_sub(untouched).ok_or(Error::Order { wanted, kept: untouched })?.min(hankel.len())
        }
        Order::Error { largest } if largest >= 0.0 => {
            (0..hankel.len()).find(|&r| bound(hankel, r) <= largest).unwrap_or(hankel.len())
        }
        Order::Error { largest: value } => {
            return Err(Error::Range { what: "largest error", value, allowed: "not negative" });
        }
        Order::Relative { share } if (0.0..=1.0).contains(&share) => {
            hankel.iter().filter(|&&s| s > share * largest).count()
        }
        Order::Relative { share: value } => {
            return Err(Error::Range {
                what: "share of the largest value",
                value,
                allowed: "between 0 and 1",
            });
        }
    };
    let kept = asked.min(numerical);
    let mut warnings = Vec::new();
    if kept < asked {
        warnings.push(Warning::FewerThanAsked { asked: asked + untouched, kept: kept + untouched });
    }
    if kept > 0 && kept < numerical && hankel[kept] > (1.0 - PAIRED_VALUES) * hankel[kept - 1] {
        warnings.push(Warning::CutsPair { kept: hankel[kept - 1], dropped: hankel[kept] });
    }
    Ok((kept, warnings))
}

/// Returns how many of the ranked values, largest first, stand above rounding: n eps times the largest.
pub(crate) fn count_above_rounding(values: &[f64]) -> usize {
    let floor = values.len() as f64 * f64::EPSILON * values.first().copied().unwrap_or(0.0);
    values.iter().filter(|&&value| value > floor).count()
}

/// Returns twice the sum of the values beyond the first `kept` (Glover 1984, Enns 1984).
pub(crate) fn bound(hankel: &[f64], kept: usize) -> f64 {
    // Smallest first, so that the tail does not vanish beside its head.
    2.0 * hankel[kept..].iter().rev().sum::<f64>()
}
