//! The figures that are read from sampled signals: step figures, spectra and rejection ratios, filters for platform motion.
//!
//! Modules in reading order: [`step`], [`welch`](mod@welch), [`filter`], [`vehicle`], [`four_wheels`], [`iso_road`](mod@iso_road), [`spectrum`], [`six_axes`], [`sea`], [`period`], [`statistics`], `normal`.

pub mod filter;
pub mod four_wheels;
pub mod iso_road;
pub(crate) mod normal_distribution;
pub mod period;
pub mod sea;
pub mod six_axes;
pub mod spectrum;
pub mod statistics;
pub mod step;
pub mod vehicle;
pub mod welch;

pub use filter::{LowPass, from_rest, low_pass};
pub use iso_road::{RoadClass, RoadDrive, iso_road};
pub use sea::{Sea, Ship, WaveShape, Waves};
pub use spectrum::{MotionRealisation, MotionTone, pitch_simulator, random_motion};
pub use statistics::{mean, peak, rms};
pub use step::{StepFigures, step_figures};
pub use vehicle::{Sides, Vehicle};
pub use welch::{Spectra, WelchOptions, welch};

use crate::Error;

/// Refuses NaN and infinite samples.
pub(crate) fn check_finite(what: &'static str, samples: &[f64]) -> Result<(), Error> {
    match samples.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(Error::NotFinite { what, index, value: samples[index] }),
        None => Ok(()),
    }
}

/// Refuses a series shorter or longer than another.
pub(crate) fn check_length(what: &'static str, found: usize, needed: usize) -> Result<(), Error> {
    if found == needed { Ok(()) } else { Err(Error::Length { what, found, needed }) }
}
