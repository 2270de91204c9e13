//! The feedforwards of a first design: what is measured of an expected motion is used.

use super::Circumstances;
use super::candidate::round_weight;
use super::scan::TriedFeedback;
use crate::error::attempt;
use crate::finding::DesignFinding;
use crate::{
    Assembly, DisturbanceChannel, DisturbanceKnowledge, Error, FeedforwardBasis, FeedforwardWeights,
    Reference, Specification, Weight, design,
};

/// A motion of the platform that is expected, and how it is measured.
#[derive(Debug, Clone, PartialEq)]
pub struct ExpectedMotion {
    /// The motion's spectrum as the modulus of a stable, strictly proper weight.
    pub generator: Weight,
    /// Spectral density of the noise of its sensor, unit^2 s.
    pub noise: f64,
}

/// The error weight of a feedforward over the feedback's: what a feedforward does costs no margin, so more is asked of it.
const ERROR_RATIO: f64 = 12.0;
/// The feedforward's control rolls off above this many times the bandwidth.
const ROLL_OFF: f64 = 2.0;
/// Damping ratio of that roll-off.
const ROLL_OFF_DAMPING: f64 = 0.7;

/// Returns the specification with a feedforward for each motion that is measured and has one, and why others have none.
///
/// # Errors
/// Those of the design.
pub(super) fn with_feedforwards(
    given: &Circumstances,
    found: &TriedFeedback,
) -> Result<(Specification, Vec<DesignFinding>), Error> {
    let mut specification = Specification {
        feedback: found.weights.clone(),
        heave: None,
        pitch: None,
        assembly: Assembly::SimpleAdd,
        reference: Reference::Error,
        position_gain: found.position_gain,
    };
    // A feedforward on the closed loop knows one feedback, not a cascade.
    let bases: &[FeedforwardBasis] = match given.plant.rate_loop {
        Some(_) => &[FeedforwardBasis::OpenLoop],
        None => &[FeedforwardBasis::OpenLoop, FeedforwardBasis::ClosedLoop],
    };
    let mut left_out = Vec::new();
    for (channel, motion) in
        [(DisturbanceChannel::Heave, &given.heave), (DisturbanceChannel::Pitch, &given.pitch)]
    {
        let Some(motion) = motion else { continue };
        let mut reasons = Vec::new();
        for &basis in bases {
            let trial = with_one(&specification, channel, feedforward(found, channel, motion, basis));
            match attempt(design(&given.plant, &trial))? {
                Ok(_) => {
                    (specification, reasons) = (trial, Vec::new());
                    break;
                }
                Err(refusal) => reasons = refusal.findings,
            }
        }
        left_out.extend(reasons.into_iter().filter(DesignFinding::is_refusal));
    }
    Ok((specification, left_out))
}

fn with_one(base: &Specification, channel: DisturbanceChannel, weights: FeedforwardWeights) -> Specification {
    match channel {
        DisturbanceChannel::Heave => Specification { heave: Some(weights), ..base.clone() },
        DisturbanceChannel::Pitch => Specification { pitch: Some(weights), ..base.clone() },
    }
}

/// Steady volts cost in heave, where they hold a weight, and are free in pitch, where they cancel a drag.
fn feedforward(
    found: &TriedFeedback,
    channel: DisturbanceChannel,
    motion: &ExpectedMotion,
    basis: FeedforwardBasis,
) -> FeedforwardWeights {
    let corner = ROLL_OFF * found.judgement.bandwidth_rad_s;
    let (second_s2, first_s) =
        (round_weight(1.0 / (corner * corner)), round_weight(2.0 * ROLL_OFF_DAMPING / corner));
    let is_free = channel == DisturbanceChannel::Pitch && basis == FeedforwardBasis::OpenLoop;
    let control = if is_free {
        Weight::QuadraticFreeAtZero { gain: 1.0, second_s2, first_s }
    } else {
        Weight::Quadratic { gain: 1.0, second_s2, first_s }
    };
    let level = found.weights.error.rational().gain.abs();
    FeedforwardWeights {
        error: Weight::Constant { gain: round_weight(ERROR_RATIO * level) },
        control,
        generator: motion.generator.clone(),
        knowledge: DisturbanceKnowledge::Measured { noise: round_weight(motion.noise) },
        output: None,
        basis,
    }
}
