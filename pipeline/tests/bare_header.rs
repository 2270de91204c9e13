//! A header without sentences, because the crate that words it stands above.

use counterpoise_models::Parameters;
use counterpoise_pipeline::{HeaderWords, PipelineError};
use counterpoise_project::resolve::synthesis::DesignRequest;
use counterpoise_verify::Verification;

/// No sentence on anything.
pub struct BareHeader;

impl HeaderWords for BareHeader {
    fn describe_loop_signals(&self, _: &Parameters) -> Option<String> {
        None
    }

    fn describe_weights(&self, _: &DesignRequest) -> Vec<String> {
        Vec::new()
    }

    fn describe_verdicts(&self, _: &Verification) -> Vec<String> {
        Vec::new()
    }

    fn describe_feedback_alone(&self, _: Result<&Verification, &PipelineError>) -> Vec<String> {
        Vec::new()
    }
}
