//! The request for a design, as plain data.

use counterpoise_controller::sensitivity::RealisationForm;
use counterpoise_synth::{
    Assembly, DisturbanceKnowledge, FeedbackWeights, FeedforwardBasis, FeedforwardWeights, LightModes,
    Reference, SamplingMethod, Specification, SynthesisMethod, Weight,
};

use super::synthesis_options::SynthesisOptions;
use super::weight::blank_weight;

/// Options of a design.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignRequest {
    /// Weights and assembly. Inputs and outputs are numbered as those of [`LinearPlant`](counterpoise_models::plant::LinearPlant).
    pub specification: Specification,
    /// The source of the feedback's weights.
    pub weights: WeightSource,
    /// Bandwidth that chosen weights aim at, rad/s; `None` asks for the highest.
    pub bandwidth_rad_s: Option<f64>,
    /// Quantity that the loop controls.
    pub loop_kind: LoopKind,
    /// Largest rate that a loop of position demands, rad/s or m/s; 0 for no limit, `None` for what the drive allows.
    pub rate_limit: Option<f64>,
    /// Delay of the design plant in sample periods.
    pub delay_samples: f64,
    /// Order of the Pade approximation of that delay.
    pub pade_order: usize,
    /// Sampling of the controller.
    pub discretisation: SamplingMethod,
    /// The form in which each path runs.
    pub form: RealisationForm,
    /// Time in which the step of a changed out-of-balance fades in, s.
    pub transfer_time_s: f64,
    /// Method, order, observer, schedule, adaptation, search.
    pub options: SynthesisOptions,
}

/// Quantity that the loop controls.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LoopKind {
    /// The rate that the loop's sensor measures.
    #[default]
    Rate,
    /// The position that the loop's sensor measures.
    Position,
    /// The position, by a proportional loop around a loop of its rate.
    Cascade,
    /// The torque or the force that a sensor between transmission and load measures.
    Torque,
    /// The motor's current.
    Current,
}

/// Source of the feedback's weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WeightSource {
    /// They are to be chosen for the highest bandwidth, or for the one that is asked for.
    #[default]
    Chosen,
    /// The file states them.
    Stated,
    /// They were chosen, and stand in the project as if its file stated them.
    Found,
}

impl DesignRequest {
    /// Returns whether the feedback may be designed as if the structure were much stiffer: no other part of the design relies on its cost.
    pub fn may_stiffen_modes(&self) -> bool {
        self.options.method == SynthesisMethod::ThreePart
            && self.specification.assembly == Assembly::SimpleAdd
            && self.discretisation != SamplingMethod::SampledData
            && self.options.schedule.is_none()
    }
}

impl Default for DesignRequest {
    /// Returns a design of which nothing is stated.
    fn default() -> Self {
        blank_synthesis()
    }
}

/// Returns a design still to be read.
pub(crate) fn blank_synthesis() -> DesignRequest {
    let unit = Weight::Constant { gain: 1.0 };
    // what stands here until weights are chosen equals itself, so that projects without weights can be compared
    let feedback =
        FeedbackWeights { error: unit.clone(), control: unit, measurement_noise: 0.0, ..blank_feedback() };
    let (assembly, reference) = (Assembly::default(), Reference::default());
    DesignRequest {
        specification: Specification {
            feedback,
            heave: None,
            pitch: None,
            assembly,
            reference,
            position_gain: None,
        },
        loop_kind: LoopKind::Rate,
        rate_limit: None,
        weights: WeightSource::Chosen,
        bandwidth_rad_s: None,
        delay_samples: 1.0,
        pade_order: 2,
        discretisation: SamplingMethod::TUSTIN,
        form: RealisationForm::LeastSensitive,
        transfer_time_s: 0.0,
        options: SynthesisOptions::default(),
    }
}

/// Returns weights of the feedback still to be read.
pub(super) fn blank_feedback() -> FeedbackWeights {
    FeedbackWeights {
        error: blank_weight(),
        control: blank_weight(),
        combination: Vec::new(),
        measurement_noise: f64::NAN,
        disturbances: Vec::new(),
        loop_recovery: 0.0,
        modes: LightModes::Kept,
    }
}

/// Returns weights of a feedforward still to be read.
pub(super) fn blank_feedforward() -> FeedforwardWeights {
    let knowledge = DisturbanceKnowledge::Measured { noise: f64::NAN };
    FeedforwardWeights {
        error: blank_weight(),
        control: blank_weight(),
        generator: blank_weight(),
        knowledge,
        output: None,
        basis: FeedforwardBasis::OpenLoop,
    }
}
