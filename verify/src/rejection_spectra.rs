//! The rejection ratio read from time histories: Pxy / Pxx by Welch's method, with coherence and confidence.

use crate::history::Experiment;
use crate::signals::welch::{Spectra, WelchOptions, welch};
use crate::tolerance::{FEWEST_SEGMENTS, LONGEST_SEGMENT};
use crate::{Arrangement, Model, Source, Verification};

/// Hub rate over one motion of the platform, on the nonlinear plant on the road.
#[derive(Debug, Clone, PartialEq)]
pub struct HubRateSpectra {
    /// Heave (m/s^2) or pitch (rad/s): the motion that the hub rate is compared with.
    pub source: Source,
    /// Part of the controller that acts.
    pub arrangement: Arrangement,
    /// Spectra, transfer, coherence and the radius of confidence.
    pub spectra: Spectra,
}

/// Probability of the confidence intervals.
pub const CONFIDENCE: f64 = 0.95;

/// Returns the ratios of every arrangement that was run on the road; none without a road, or where the record is too short. Heave and
/// pitch of a vehicle go together, so each ratio carries a part of the other: where they are coherent, it tells of both.
pub fn spectral_rejections(found: &Verification) -> Vec<HubRateSpectra> {
    let mut all = Vec::new();
    for source in [Source::Pitch, Source::Heave] {
        for arrangement in crate::ARRANGEMENTS {
            all.extend(one(found, source, arrangement));
        }
    }
    all
}

fn one(found: &Verification, source: Source, arrangement: Arrangement) -> Option<HubRateSpectra> {
    let history = found.history(Model::Nonlinear, Experiment::Disturbance(Source::Road, arrangement))?;
    let x = history.motion(source);
    let most = 2 * x.len() / (FEWEST_SEGMENTS + 1);
    let segment = if most >= LONGEST_SEGMENT { LONGEST_SEGMENT } else { most / 2 * 2 };
    let options = WelchOptions { segment, confidence: CONFIDENCE };
    let spectra = welch(x, history.hub_rate_rad_s(), found.evidence.sample_period_s, options).ok()?;
    Some(HubRateSpectra { source, arrangement, spectra })
}
