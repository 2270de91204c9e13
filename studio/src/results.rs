//! What was computed, by the revision that it came from.

use std::sync::Arc;

use counterpoise_pipeline::studies::trade_off::EffortPoint;
use counterpoise_verify::{Verification, VerifiedController};

use crate::live::Live;
use crate::measure::Measured;
use crate::portrait::{Portrait, Swinging};

/// A result and the revision of the project that it came from.
#[derive(Debug, Clone)]
pub struct Of<T> {
    /// The revision.
    pub revision: u64,
    /// The result.
    pub value: T,
}

/// Everything that was computed.
#[derive(Debug, Clone, Default)]
pub struct Results {
    /// The last good design.
    pub live: Option<Of<Arc<Live>>>,
    /// Why there is no design for a revision.
    pub no_design: Option<Of<Vec<String>>>,
    /// The last verification.
    pub verified: Option<Of<Arc<VerifiedController>>>,
    /// What a verification that still runs has found so far.
    pub partial: Option<Of<Arc<Verification>>>,
    /// Error against effort around the last good design.
    pub effort: Option<Of<Vec<EffortPoint>>>,
    /// The last map of the analyser, and the last campaign.
    pub measured: Measured,
    /// What Plant and Reduce show of the last good design's plant.
    pub portrait: Option<Arc<Portrait>>,
    /// The modes of the beam that was swung last.
    pub swinging: Option<Arc<Swinging>>,
    /// Why a revision could not be verified.
    pub no_verification: Option<Of<Vec<String>>>,
    /// Whether a design is being made.
    pub designing: bool,
    /// Whether a verification runs.
    pub verifying: bool,
}

impl Results {
    /// Why the project as it stands has no design.
    pub fn why_not(&self, revision: u64) -> Option<&[String]> {
        self.no_design.as_ref().filter(|of| of.revision == revision).map(|of| of.value.as_slice())
    }

    /// The design, with whether it is of an older revision.
    pub fn design(&self, revision: u64) -> Option<(&Arc<Live>, Age)> {
        self.live.as_ref().map(|of| (&of.value, Age::of(of.revision, revision)))
    }
}

impl Results {
    /// What is known of the verification: all of it, or what a running one has found so far where that is newer.
    pub fn verification(&self, revision: u64) -> Option<(&Verification, Standing)> {
        let whole = self.verified.as_ref();
        if let Some(part) = self.partial.as_ref()
            && self.verifying
            && whole.is_none_or(|of| of.revision != part.revision)
        {
            return Some((&part.value, Standing::Running));
        }
        let of = whole?;
        let standing = match Age::of(of.revision, revision) {
            Age::Fresh => Standing::Whole,
            Age::Stale => Standing::Stale,
        };
        Some((of.value.verification(), standing))
    }
}

/// How a verification stands to the project.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// It is of the project as it stands, and complete.
    Whole,
    /// It is still running.
    Running,
    /// It is of an older design.
    Stale,
}

/// Whether a result is of the project as it stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Age {
    /// It is.
    Fresh,
    /// It is of an older revision.
    Stale,
}

impl Age {
    /// The age of a result.
    pub fn of(result: u64, project: u64) -> Self {
        if result == project { Self::Fresh } else { Self::Stale }
    }
}
