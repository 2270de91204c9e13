//! The largest rate that a loop of position demands, in words. The JSON result carries them.

use counterpoise_project::Assumption;

use crate::synth::demanded_rate::{DemandedRate, RateOrigin};

/// The basis of the limit if the file does not state it.
const HALF_OF_DRIVE: &str = "half of what the drive can take up and brake without saturating";

/// Describes the largest demanded rate and where it comes from.
pub fn describe_demanded_rate(limit: &DemandedRate) -> String {
    let origin = match limit.origin {
        RateOrigin::Stated => "as the file states",
        RateOrigin::Drive => HALF_OF_DRIVE,
    };
    format!("demanded rate at most {:.4} {}: {origin}", limit.rate, limit.unit)
}

/// Returns the assumption that a largest demanded rate is; `None` if the file states the rate.
pub(crate) fn assumption_of_demanded_rate(limit: &DemandedRate) -> Option<Assumption> {
    (limit.origin == RateOrigin::Drive).then_some(Assumption {
        key: "synth.rate_limit".to_owned(),
        value: limit.rate,
        unit: limit.unit,
        meaning: "largest rate that the loop of position demands",
        rule: "half of what the drive can take up and brake without saturating, on a ramp of the demand",
        source: "a loop that saturates is not the one that was verified",
        usual: None,
    })
}
