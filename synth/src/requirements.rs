//! The requirements of a search on the feedback loop.

use counterpoise_lti::StateSpace;
use counterpoise_lti::response::Response;

use crate::feedforward::with_derivatives;
use crate::figures::{BAND_POINTS, Figures, band_rate, rejection};
use crate::{DesignPlant, DisturbanceChannel, Error, Specification};

/// Limits that the feedback loop must keep. Infinite or zero limits ask for nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Requirements {
    /// Smallest gain margin, dB.
    pub gain_margin_db: f64,
    /// Smallest phase margin, degrees.
    pub phase_margin_deg: f64,
    /// Largest sensitivity.
    pub ms: f64,
    /// Largest overshoot of a step, as a share of it.
    pub overshoot: f64,
    /// Smallest crossover, rad/s.
    pub crossover_rad_s: f64,
    /// Largest control after a unit step, V s/rad.
    pub step_control_v: f64,
    /// Largest RMS control for measurement noise of unit RMS, V s/rad.
    pub noise_gain: f64,
    /// Band over which rejection is wanted, rad/s.
    pub band_rad_s: [f64; 2],
    /// By what the share that is left is averaged over the band.
    pub spectrum: BandSpectrum,
}

/// Spectrum by which the remaining share of a disturbance is averaged over the band.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BandSpectrum {
    /// Alike everywhere on the logarithmic axis.
    #[default]
    Flat,
    /// By the spectrum of the rate that the expected heave and pitch (the generators of the feedforwards) cause where no
    /// control acts.
    Expected,
}

impl Requirements {
    /// Returns the margins and the overshoot of the source thesis: 12 dB, 60 degrees, 13 %; rejection from 0.2 to 2 Hz.
    pub fn thesis() -> Self {
        Self {
            gain_margin_db: 12.0,
            phase_margin_deg: 60.0,
            ms: f64::INFINITY,
            overshoot: 0.13,
            crossover_rad_s: 0.0,
            step_control_v: f64::INFINITY,
            noise_gain: f64::INFINITY,
            band_rad_s: [1.26, 12.6],
            spectrum: BandSpectrum::Flat,
        }
    }

    /// Returns the RMS of |S| over the band, averaged as the requirements say.
    ///
    /// # Errors
    /// [`Error::System`] if the average is by the expected motion and the specification expects none.
    pub fn share_left(
        &self,
        loop_gain: &StateSpace,
        plant: &DesignPlant,
        specification: &Specification,
    ) -> Result<f64, Error> {
        rejection(loop_gain, self.band_rad_s, &self.powers(plant, specification)?)
    }

    /// The average's weights at the points of the band.
    pub(crate) fn powers(
        &self,
        plant: &DesignPlant,
        specification: &Specification,
    ) -> Result<[f64; BAND_POINTS], Error> {
        match self.spectrum {
            BandSpectrum::Flat => Ok([1.0; BAND_POINTS]),
            BandSpectrum::Expected => expected_powers(plant, specification, self.band_rad_s),
        }
    }

    /// Returns the sum of what is missed, each relative to its limit; 0 if everything holds.
    pub fn total_shortfall(&self, found: &Figures) -> f64 {
        let below =
            |value: f64, limit: f64| if limit > 0.0 { ((limit - value) / limit).max(0.0) } else { 0.0 };
        let above =
            |value: f64, limit: f64| if limit.is_finite() { ((value - limit) / limit).max(0.0) } else { 0.0 };
        below(found.gain_margin_db, self.gain_margin_db)
            + below(found.phase_margin_deg, self.phase_margin_deg)
            + below(found.crossover_rad_s, self.crossover_rad_s)
            + above(found.ms, self.ms)
            + above(found.overshoot, self.overshoot)
            + above(found.step_control_v, self.step_control_v)
            + above(found.noise_gain, self.noise_gain)
    }
}

/// Power of the uncontrolled rate under the expected motion, per unit of the logarithm of frequency.
fn expected_powers(
    plant: &DesignPlant,
    specification: &Specification,
    band_rad_s: [f64; 2],
) -> Result<[f64; BAND_POINTS], Error> {
    let mut powers = [0.0; BAND_POINTS];
    for channel in [DisturbanceChannel::Heave, DisturbanceChannel::Pitch] {
        let Some(weights) = specification.feedforward(channel) else { continue };
        let columns = plant.columns(channel);
        let generator = Response::of(&with_derivatives(&weights.generator.realise()?, columns.len())?)?;
        let path = Response::of(&plant.system.select(&[plant.rate], columns))?;
        for (k, power) in powers.iter_mut().enumerate() {
            let rate = band_rate(band_rad_s, k);
            *power += rate * (&path.at(rate)? * &generator.at(rate)?)[(0, 0)].norm_sqr();
        }
    }
    if powers.iter().any(|power| *power > 0.0) {
        return Ok(powers);
    }
    let problem = "no motion is expected that causes a rate: it needs a feedforward with its generator";
    Err(Error::System { what: "search by the expected motion", problem })
}
