//! The specification of the designer: the weights of the three parts and how the parts are put together.

use counterpoise_linalg::Mat;
use counterpoise_linalg::sparse::VectorEntry;

use crate::{DisturbanceChannel, Weight};

/// The whole of a three-part design, apart from the plant.
#[derive(Debug, Clone, PartialEq)]
pub struct Specification {
    /// The feedback from the measured rate.
    pub feedback: FeedbackWeights,
    /// The feedforward from measured heave; `None` for a design without it.
    pub heave: Option<FeedforwardWeights>,
    /// The feedforward from measured pitch; `None` for a design without it.
    pub pitch: Option<FeedforwardWeights>,
    /// Structure in which the parts are put together.
    pub assembly: Assembly,
    /// Place at which the demand enters.
    pub reference: Reference,
    /// Gain of the position loop around the rate loop, rate per position, 1/s; `None` if there is one loop.
    pub position_gain: Option<f64>,
}

/// Structure in which the parts are put together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Assembly {
    /// `u = C0 (r - y) + u_h + u_p`: the feedback also cleans up what the feedforward leaves.
    #[default]
    SimpleAdd,
    /// `u = C0 (r - (y - y_h - y_p)) + u_h + u_p`: the feedback leaves to the feedforward what it expects of it.
    /// Each source then costs exactly what its own weights say.
    Grimble,
    /// `u = C (r, y, heave, pitch)`: one problem under the feedback's weights, with every disturbance and every sensor
    /// ([`mod@crate::joint`]). Of the feedforwards' weights the generators and noises alone are used.
    Joint,
}

/// Place at which the demand enters the feedback.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Reference {
    /// The controller sees the error r - y alone: one degree of freedom, quick and with overshoot.
    #[default]
    Error,
    /// The demand enters the error weight's states alone: two degrees of freedom, slower and smooth. Needs an error
    /// weight with states.
    WeightOnly,
}

/// Weights and noises of the feedback part (the cost of what no sensor announces).
#[derive(Debug, Clone, PartialEq)]
pub struct FeedbackWeights {
    /// Weight on the measured error.
    pub error: Weight,
    /// Weight on the control.
    pub control: Weight,
    /// Constant weights on further outputs, each by the index of its output: on the tip's rate, for instance. All are summed into
    /// one signal first, so k on the tip and -k on the hub weigh the twist rate.
    pub combination: Vec<VectorEntry>,
    /// Spectral density of the measurement noise, (rad/s)^2 s.
    pub measurement_noise: f64,
    /// Spectral densities of white disturbances that no sensor announces, each by the index of its input.
    pub disturbances: Vec<VectorEntry>,
    /// Spectral density of a fictitious white noise on the control, V^2 s: the more, the more of the state feedback's
    /// margins the loop recovers, at the cost of noise.
    pub loop_recovery: f64,
    /// The lightly damped modes in the plant that the feedback is designed on.
    pub modes: LightModes,
}

/// The lightly damped modes in the plant that a feedback is designed on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LightModes {
    /// They are in the plant: the observer follows them.
    #[default]
    Kept,
    /// They are far quicker and well damped, as those of a much stiffer structure: the observer follows no lightly damped mode. The loop is judged on
    /// the plant as it is.
    Stiffened,
}

/// Weights and model of one feedforward part.
#[derive(Debug, Clone, PartialEq)]
pub struct FeedforwardWeights {
    /// Weight on the rate that the disturbance would cause.
    pub error: Weight,
    /// Weight on the feedforward's control.
    pub control: Weight,
    /// Shape of the disturbance: its spectrum is |generator|^2, driven by unit white noise. Strictly proper and stable.
    pub generator: Weight,
    /// Knowledge of the disturbance.
    pub knowledge: DisturbanceKnowledge,
    /// The output whose rate is weighed: the tip, for instance; `None` for the rate that is controlled.
    pub output: Option<usize>,
    /// The plant that the feedforward is designed on.
    pub basis: FeedforwardBasis,
}

/// The plant that a feedforward is designed on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FeedforwardBasis {
    /// The plant alone: G and G_d.
    #[default]
    OpenLoop,
    /// The plant with the feedback around it: S G and S G_d. The module then knows what the feedback will do.
    ClosedLoop,
}

/// Knowledge of the disturbance in the feedforward.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DisturbanceKnowledge {
    /// The value and its derivatives up to the generator's order, exactly. The sensor is taken as perfect.
    Exact,
    /// The plant's sensor with white noise of this spectral density, unit^2 s: an optimal filter in front.
    Measured {
        /// Spectral density of the noise.
        noise: f64,
    },
}

impl Specification {
    /// Returns the feedforward of a channel.
    pub fn feedforward(&self, channel: DisturbanceChannel) -> Option<&FeedforwardWeights> {
        match channel {
            DisturbanceChannel::Heave => self.heave.as_ref(),
            DisturbanceChannel::Pitch => self.pitch.as_ref(),
        }
    }
}

impl Specification {
    /// Puts other weights in the place of a channel's.
    pub(crate) fn set_feedforward(&mut self, channel: DisturbanceChannel, weights: FeedforwardWeights) {
        match channel {
            DisturbanceChannel::Heave => self.heave = Some(weights),
            DisturbanceChannel::Pitch => self.pitch = Some(weights),
        }
    }
}

impl FeedbackWeights {
    /// The row that makes the weighted combination out of all true outputs; zeros where there is none.
    pub(crate) fn combination_row(&self, outputs: usize) -> Mat {
        let mut row = Mat::zeros(1, outputs);
        for entry in self.combination.iter().filter(|entry| entry.index < outputs) {
            row[(0, entry.index)] += entry.value;
        }
        row
    }
}
