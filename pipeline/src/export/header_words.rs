//! The sentences in the header of generated code: what they are about is found here, and how it is said is handed in.

use counterpoise_models::Parameters;
use counterpoise_project::resolve::synthesis::DesignRequest;
use counterpoise_verify::Verification;

use crate::PipelineError;

/// Whoever words the header of generated code; each line that is returned is a line of the header.
pub trait HeaderWords {
    /// Describes what the first two readings of the controller hold; `None` if the loop is one of the hub's inertial rate on a turning axis.
    fn describe_loop_signals(&self, plant: &Parameters) -> Option<String>;

    /// Describes what each weight of a design asks for.
    fn describe_weights(&self, asked: &DesignRequest) -> Vec<String>;

    /// Describes the verdict on every requirement.
    fn describe_verdicts(&self, found: &Verification) -> Vec<String>;

    /// Describes the loop that remains when the code hands over to feedback alone, as it was verified, or why it could not be verified.
    fn describe_feedback_alone(&self, verified: Result<&Verification, &PipelineError>) -> Vec<String>;
}
