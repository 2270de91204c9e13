//! The computed results, by the revision that they came from.

use std::sync::Arc;
use std::time::Duration;

use counterpoise_pipeline::check::RankedAssumptions;
use counterpoise_pipeline::loop_view::LoopView;
use counterpoise_pipeline::preview::{DesignPreview, PlantPreview};
use counterpoise_pipeline::studies::trade_off::EffortPoint;
use counterpoise_verify::{Verification, VerifiedController};

use crate::jobs::measurements::Measurements;
use crate::jobs::plant_pictures::{BeamModes, ReductionPicture};
use crate::versioned_results::{Freshness, VersionedResult};

/// Everything that was computed.
#[derive(Debug, Clone, Default)]
pub struct ComputedResults {
    /// The last design that succeeded.
    pub design: Option<VersionedResult<Arc<DesignPreview>>>,
    /// Time that this design took.
    pub design_time: Duration,
    /// The plant of the last project that could be modelled.
    pub plant: Option<VersionedResult<PlantPreview>>,
    /// Why a revision could not be modelled.
    pub plant_failure: Option<VersionedResult<Vec<String>>>,
    /// Why there is no design for a revision.
    pub design_failure: Option<VersionedResult<Vec<String>>>,
    /// The last verification.
    pub verified: Option<VersionedResult<Arc<VerifiedController>>>,
    /// Results of a running verification so far.
    pub partial: Option<VersionedResult<Arc<Verification>>>,
    /// Error against effort around the last design.
    pub effort: Option<VersionedResult<Vec<EffortPoint>>>,
    /// The loop of the last design as charts of the plane show it.
    pub loop_view: Option<VersionedResult<LoopView>>,
    /// The last map of the analyser, and the last campaign.
    pub measurements: Measurements,
    /// Views in Plant and Reduce of the plant of the last design.
    pub reduction: Option<Arc<ReductionPicture>>,
    /// Values that the project file leaves open, ranked, of the last plant that Plant has shown.
    pub ranking: Option<VersionedResult<RankedAssumptions>>,
    /// The modes of the beam that was animated last.
    pub beam_modes: Option<Arc<BeamModes>>,
    /// Why a revision could not be verified.
    pub verification_failure: Option<VersionedResult<Vec<String>>>,
    /// `true` if a design is being made.
    pub designing: bool,
    /// `true` if a verification runs.
    pub verifying: bool,
}

/// The state of a verification with respect to the project.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VerificationState {
    /// The result belongs to the project as it stands, and is complete.
    Complete,
    /// The computation is still running.
    Running,
    /// The result belongs to an older design.
    Stale,
}

impl ComputedResults {
    /// Returns why the project as it stands has no design.
    pub fn design_errors(&self, revision: u64) -> Option<&[String]> {
        self.design_failure.as_ref().filter(|of| of.revision == revision).map(|of| of.value.as_slice())
    }

    /// Returns why the project as it stands could not be modelled.
    pub fn plant_errors(&self, revision: u64) -> Option<&[String]> {
        self.plant_failure.as_ref().filter(|of| of.revision == revision).map(|of| of.value.as_slice())
    }

    /// Returns the last design, and whether it belongs to this revision.
    pub fn design_at(&self, revision: u64) -> Option<(&Arc<DesignPreview>, Freshness)> {
        self.design.as_ref().map(|of| (&of.value, of.freshness(revision)))
    }

    /// Returns what is known of the verification: all of it, or what a running one has found so far if that is newer.
    pub fn verification(&self, revision: u64) -> Option<(&Verification, VerificationState)> {
        let whole = self.verified.as_ref();
        if let Some(part) = self.partial.as_ref()
            && self.verifying
            && whole.is_none_or(|of| of.revision != part.revision)
        {
            return Some((&part.value, VerificationState::Running));
        }
        let of = whole?;
        let state = match of.freshness(revision) {
            Freshness::Current => VerificationState::Complete,
            Freshness::Stale => VerificationState::Stale,
        };
        Some((of.value.verification(), state))
    }
}
