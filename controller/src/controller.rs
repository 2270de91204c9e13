//! A checked controller.

use crate::signal::{DEMAND, HUB_RATE};
use crate::{Correction, Error, Parts, Programs, check, lowering};

/// A discrete controller whose arithmetic is fixed to the last bit. It cannot be changed: what was verified is what is
/// exported.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    parts: Parts,
    programs: Programs,
}

impl Controller {
    /// Checks the parts and fixes the order of the arithmetic.
    ///
    /// # Errors
    /// A number out of its range, a name that target code cannot carry, a system that does not fit its signals, its
    /// timebase or its anti-windup gains: see [`Error`].
    pub fn new(parts: Parts) -> Result<Self, Error> {
        check::check_parts(&parts)?;
        let programs = lowering::lower_parts(&parts);
        check::check_distinct(&programs)?;
        Ok(Self { parts, programs })
    }

    /// Returns what the controller is made of.
    pub fn parts(&self) -> &Parts {
        &self.parts
    }

    /// Returns the straight lines of arithmetic that every back end carries out.
    pub fn programs(&self) -> &Programs {
        &self.programs
    }

    /// Returns the sample period, s.
    pub fn sample_period_s(&self) -> f64 {
        self.parts.sample_period_s
    }

    /// Returns the largest control, V: the control is limited to +/- this.
    pub fn limit_v(&self) -> f64 {
        self.parts.limit_v
    }

    /// Returns the controller with some of its parts changed, checked again.
    ///
    /// # Errors
    /// As [`Controller::new`].
    pub fn with(&self, change: impl FnOnce(&mut Parts)) -> Result<Self, Error> {
        let mut parts = self.parts.clone();
        change(&mut parts);
        Self::new(parts)
    }

    /// Returns the controller that remains when feedback works alone: it reads the demand and the hub gyroscope, and 0 for every
    /// other sensor. What is verified of it holds for the exported code after its handover to feedback alone.
    ///
    /// # Errors
    /// As [`Controller::new`].
    pub fn feedback_alone(&self) -> Result<Self, Error> {
        self.with(|parts| {
            parts.corrections.retain(|each| each.reading == DEMAND || each.reading == HUB_RATE);
            let others =
                (0..parts.reading_count()).filter(|reading| *reading != DEMAND && *reading != HUB_RATE);
            let original = &self.parts.corrections;
            parts.corrections.extend(others.map(|reading| {
                let offset =
                    original.iter().find(|each| each.reading == reading).map_or(0.0, |each| each.offset);
                Correction { reading, gain: 0.0, offset }
            }));
        })
    }
}
