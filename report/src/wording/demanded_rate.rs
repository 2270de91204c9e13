//! The largest rate that a loop of position demands, in words.

use counterpoise_pipeline::synth::demanded_rate::{DemandedRate, RateOrigin};

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
