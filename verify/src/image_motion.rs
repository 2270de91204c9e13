//! The loss of an image by motion of the line of sight: the modulation transfer function of motion during an exposure.
//!
//! A detector that integrates while its image moves by x(t) multiplies the modulation at a spatial frequency by |mean of exp(2 pi i f x(t))| over
//! the exposure, whatever the motion is (O. Hadar, I. Dror and N. S. Kopeika, Optical Engineering 33(2), 1994: the transform of the histogram of
//! positions). A sight of focal length F that turns by an angle moves its image by F times that angle. The loss is 1 less the mean of this
//! modulus over all exposures.

use counterpoise_linalg::C64;

use crate::Error;

/// The optics of a sight, and the detail that it shall show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Optics {
    /// Focal length, m.
    pub focal_length_m: f64,
    /// Spatial frequency in the image at which the loss is stated, periods a metre.
    pub spatial_frequency_m: f64,
}

impl Default for Optics {
    /// 100 mm and the Nyquist frequency of pixels of 15 micrometres.
    fn default() -> Self {
        Self { focal_length_m: 0.1, spatial_frequency_m: 0.5 / 15e-6 }
    }
}

impl Optics {
    /// Refuses optics that cannot be.
    ///
    /// # Errors
    /// [`Error::Range`].
    pub fn check(&self) -> Result<(), Error> {
        for (what, value) in [
            ("focal length in m", self.focal_length_m),
            ("spatial frequency in 1/m", self.spatial_frequency_m),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::Range { what, value, allowed: "positive" });
            }
        }
        Ok(())
    }

    /// Returns the share of the modulation that motion takes: 0 for none, up to 1. `exposure` is the number of samples of one exposure.
    pub(crate) fn loss(&self, angle_rad: &[f64], exposure: usize) -> f64 {
        let phase = std::f64::consts::TAU * self.spatial_frequency_m * self.focal_length_m;
        let transfer = |window: &[f64]| {
            let sum: C64 = window.iter().map(|angle| C64::from_polar(1.0, phase * angle)).sum();
            sum.norm() / window.len() as f64
        };
        let all: Vec<f64> = angle_rad.chunks_exact(exposure.max(1)).map(transfer).collect();
        if all.is_empty() { 0.0 } else { (1.0 - all.iter().sum::<f64>() / all.len() as f64).max(0.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    const OPTICS: Optics = Optics { focal_length_m: 0.2, spatial_frequency_m: 2e4 };

    /// A steady rate smears the image by d during the exposure: sin(pi f d) / (pi f d).
    #[test]
    fn a_steady_rate_loses_what_a_smear_loses() {
        let exposure = 1000;
        let smear_m = 3e-5;
        let angle: Vec<f64> = (0..10 * exposure)
            .map(|k| smear_m / OPTICS.focal_length_m * k as f64 / exposure as f64)
            .collect();
        let x = PI * OPTICS.spatial_frequency_m * smear_m;
        let found = OPTICS.loss(&angle, exposure);
        assert!((found - (1.0 - x.sin() / x)).abs() < 1e-6, "{found}");
    }

    /// A sine that is fast beside the exposure leaves J0(2 pi f a); J0(1.2) is 0.671132744264363.
    #[test]
    fn a_fast_sine_leaves_the_bessel_function() {
        let amplitude_rad = 1.2 / (TAU * OPTICS.spatial_frequency_m * OPTICS.focal_length_m);
        let angle: Vec<f64> = (0..4000).map(|k| amplitude_rad * (TAU * f64::from(k) / 40.0).sin()).collect();
        let found = OPTICS.loss(&angle, 400);
        assert!((found - (1.0 - 0.671_132_744_264_363)).abs() < 1e-12, "{found}");
    }

    #[test]
    fn a_still_image_loses_nothing() {
        assert_eq!(OPTICS.loss(&[0.3; 100], 10), 0.0);
        assert_eq!(OPTICS.loss(&[], 10), 0.0);
    }
}
