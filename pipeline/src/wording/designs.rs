//! The rows and columns of the table of designs, in words. The JSON result carries them.

use counterpoise_models::ControlledQuantity;
use counterpoise_verify::Road;

/// Returns the name of the motion under which designs are simulated: the project's own, or the sines if it has none.
pub(crate) fn name_motion(own: Option<&Road>) -> &'static str {
    if own.is_some() { "the project's own motion" } else { "the sines" }
}

/// Describes the objective of a tuning that reduces what the loop controls under a motion.
pub(crate) fn describe_motion_objective(controlled: ControlledQuantity, motion: &str) -> String {
    format!("{} under {motion}", controlled.name())
}

/// Describes the objective of a tuning that reduces the sensitivity in a band, rad/s.
pub(crate) fn describe_band_objective([low, high]: [f64; 2]) -> String {
    format!("RMS of |S| from {low} to {high} rad/s")
}
