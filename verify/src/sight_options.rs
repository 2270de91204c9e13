//! The options by which the line of sight is judged: exposure, settling time, window of coincidence, optics.

use crate::coincidence::Coincidence;
use crate::image_motion::Optics;
use crate::{Error, SightFigure};

/// Options for the figures of the line of sight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineOfSight {
    /// Length of one exposure, s.
    pub exposure_s: f64,
    /// Time at the beginning that the figures of the line of sight leave out, s; `None` for that of the procedure.
    pub settle_s: Option<f64>,
    /// The window within which shots are released; `None` if none are.
    pub coincidence: Option<Coincidence>,
    /// The optics whose image moves; `None` without a camera.
    pub optics: Option<Optics>,
}

impl Default for LineOfSight {
    /// 20 ms: the exposure of a camera at 50 Hz.
    fn default() -> Self {
        Self { exposure_s: 0.02, settle_s: None, coincidence: None, optics: None }
    }
}

impl LineOfSight {
    /// Refuses what cannot be measured in a run of a duration.
    ///
    /// # Errors
    /// [`Error::Range`].
    pub fn check(&self, duration_s: f64, settle_s: f64) -> Result<(), Error> {
        if !(self.exposure_s > 0.0 && self.exposure_s.is_finite()) {
            return Err(Error::Range { what: "exposure in s", value: self.exposure_s, allowed: "positive" });
        }
        let settle_s = self.settle_s.unwrap_or(settle_s);
        if !(0.0..duration_s).contains(&settle_s) {
            return Err(Error::Range {
                what: "settling time of the line of sight in s",
                value: settle_s,
                allowed: "0 or more, below the duration",
            });
        }
        if let Some(optics) = &self.optics {
            optics.check()?;
        }
        let Some(coincidence) = &self.coincidence else { return Ok(()) };
        coincidence.check()?;
        if coincidence.delay_s >= duration_s - settle_s {
            return Err(Error::Range {
                what: "delay of the shot in s",
                value: coincidence.delay_s,
                allowed: "below what the settling time leaves of the run",
            });
        }
        Ok(())
    }

    /// Returns whether a figure is measured.
    pub fn has(&self, figure: SightFigure) -> bool {
        match figure {
            SightFigure::Coincidence | SightFigure::Wait | SightFigure::Hit => self.coincidence.is_some(),
            SightFigure::HubTransferLoss | SightFigure::TipTransferLoss => self.optics.is_some(),
            SightFigure::Hub
            | SightFigure::HubJitter
            | SightFigure::Tip
            | SightFigure::TipJitter
            | SightFigure::Bending => true,
        }
    }
}
