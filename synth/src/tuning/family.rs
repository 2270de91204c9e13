//! The family that a tuning moves: a family of sampled feedbacks over the logarithms of its parameters.

use counterpoise_linalg::C64;
use counterpoise_lti::StateSpace;

use super::grid::{LoopGrid, LoopPlant};
use super::{RangeEnd, TunedFeedback};
use crate::Error;

/// A feedback on the grid.
pub(crate) struct GridResponse {
    /// K, at each frequency.
    pub K: Vec<C64>,
    /// Slopes of ln K in the open parameters, at each frequency.
    pub slopes: Vec<Vec<C64>>,
}

/// A family of feedbacks. A point is the logarithms of the open parameters.
pub(crate) trait FeedbackFamily {
    /// Logarithms of the lowest and the highest value of each open parameter.
    fn ranges(&self) -> &[[f64; 2]];

    /// K at each frequency of the grid.
    ///
    /// # Errors
    /// As [`FeedbackFamily::unchecked_feedback`].
    fn gain(&self, at: &[f64], grid: &LoopGrid) -> Result<Vec<C64>, Error>;

    /// K and the slopes of ln K.
    ///
    /// # Errors
    /// As [`FeedbackFamily::gain`].
    fn response(&self, at: &[f64], grid: &LoopGrid) -> Result<GridResponse, Error>;

    /// Feedbacks that one call of [`FeedbackFamily::response`] computes.
    fn response_feedbacks(&self) -> usize {
        1
    }

    /// The sampled feedback from the error to the control, as it runs.
    ///
    /// # Errors
    /// As [`FeedbackFamily::unchecked_feedback`], and those of the conversion.
    fn sampled_feedback(&self, at: &[f64]) -> Result<StateSpace, Error>;

    /// The feedback of [`FeedbackFamily::sampled_feedback`] in any realisation and without its checks: what slopes are differences of.
    ///
    /// # Errors
    /// [`Error::Refused`] if the family has no feedback at the point.
    fn unchecked_feedback(&self, at: &[f64]) -> Result<StateSpace, Error>;

    /// The point with less gain, whose loop is nearer to a stable one; `None` if the family has no gain of its own.
    fn calmer_point(&self, at: &[f64]) -> Option<Vec<f64>>;

    /// The points from which the tuning on the nominal plant starts: the same for the same seed.
    fn starts(&self, nominal: &LoopPlant, grid: &LoopGrid, count: usize, seed: u64) -> Vec<Vec<f64>>;

    /// The feedback at a point with every parameter fixed.
    fn feedback(&self, at: &[f64]) -> TunedFeedback;

    /// The parameters that a point has at an end of their range, beyond which another answer may lie.
    fn range_ends(&self, _at: &[f64]) -> Vec<RangeEnd> {
        Vec::new()
    }
}
