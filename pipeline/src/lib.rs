//! The stages between a project file and exported code, and between recordings and a better model: each stage is a function.
//!
//! [`run_stages`] is the whole forward direction: [`model`](mod@model) -> [`reduce`](mod@reduce) -> [`synthesise`] ->
//! [`verify`](mod@verify) -> [`export`](mod@export). Each stage takes what the stage before it made; nothing else is shared. A caller
//! who wants fewer stages calls fewer. [`design_project`] adds everything that is stated about the result, so that reports, terminals
//! and other programs only present it. [`recordings`] leads back from recordings of a machine to a better model; [`studies`] vary what
//! the forward direction does.
//!
//! *Invariant*: no file, thread, clock or terminal; files are read and stages are watched through [`World`]. No sentence about a result:
//! results hold numbers and enums, which the crate `report` puts into words, those in the headers of generated code through [`HeaderWords`].
//!
//! Modules in reading order: [`error`], `budget`, [`check_problem`], [`check`], [`configuration`], [`model`](mod@model), [`reduce`](mod@reduce), [`synth`],
//! [`first_design`](mod@first_design), [`tuning`], [`certificates`], [`road`], [`inertial_unit`](mod@inertial_unit),
//! [`verify`](mod@verify), [`export`](mod@export), [`identity`], [`frequencies`], [`design_views`], [`loop_view`](mod@loop_view), [`sight_views`], [`axes_problem`], [`traverse_file`], [`two_axes`], [`mod@design`], [`plant_views`],
//! [`reduction_views`], [`preview`], [`live_figures`], [`recordings`], [`studies`], [`commission`],
//! [`exchange`] (systems and responses for other programs), [`results`].
//!
//! ```
//! use counterpoise_pipeline::{PipelineError, build_plant_model};
//! use counterpoise_project::Project;
//!
//! let mut project = Project::parse(counterpoise_project::STARTER, "project.toml").map_err(|_| "bad project")?.project;
//! assert!(build_plant_model(&project)?.linear.system.order() > 4);
//! project.model.configuration = Some("unknown".into());
//! assert!(matches!(build_plant_model(&project), Err(PipelineError::Configuration { .. })));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod axes_problem;
mod budget;
pub mod certificates;
pub mod check;
pub mod check_problem;
pub mod commission;
pub mod configuration;
pub mod design;
pub mod design_views;
pub mod error;
pub mod exchange;
pub mod export;
pub mod first_design;
pub mod frequencies;
pub mod identity;
pub mod inertial_unit;
pub mod live_figures;
pub mod loop_view;
pub mod model;
pub mod plant_views;
pub mod preview;
pub mod recordings;
pub mod reduce;
pub mod reduction_views;
pub mod results;
pub mod road;
pub mod sight_views;
pub mod studies;
pub mod synth;
mod tolerance;
pub mod traverse_file;
pub mod tuning;
pub mod two_axes;
pub mod verify;

use counterpoise_pool::{Pool, Serial};
use counterpoise_synth::FirstDesign;

pub use design::{
    CompletedDesign, DesignContents, DesignStages, SynthesisStudy, design_project, run_stages,
    study_synthesis,
};
pub use error::PipelineError;
pub use export::{ExportedCode, HeaderWords, OmittedCode, export};
pub use first_design::{
    ChosenWeights, FirstDesignResult, choose_weights, leaves_weights_open, with_chosen_weights,
};
pub use identity::ProjectIdentity;
pub use model::{
    PlantModel, build_plant_model, cannot_hold, finite_elements, finite_elements_of, finite_elements_watched,
    model_watched,
};
pub use recordings::redesign::{RedesignComparison, verify_redesign};
pub use reduce::{ReducedPlant, reduce_plant};
pub use studies::sweep::{prepare_campaign, robust_stability, vary_families};
pub use synth::{DemandedRate, SynthesisedDesign, synthesise};
pub use traverse_file::{check_traverse, traverse_project};
pub use tuning::{DecidedProject, TunedProject, choose_and_tune, with_recorded_design, with_tuned_structure};
pub use two_axes::{
    DesignedAxis, TraverseCode, TraverseDesign, TwoAxisStudy, design_traverse, export_traverse,
    study_two_axes,
};
pub use verify::{project_procedure, verify, verify_linear_on, verify_on, verify_watched};

/// Access of the pipeline to its surroundings: the files beside the project, and an observer of the stages.
pub trait World {
    /// Returns the bytes of a file beside the project file.
    ///
    /// # Errors
    /// Why the file cannot be read, in words.
    fn read(&self, name: &str) -> Result<Vec<u8>, String>;

    /// Returns the processors for work that has independent parts.
    fn pool(&self) -> &dyn Pool {
        &Serial
    }

    /// Called when a step begins.
    fn begins(&self, _step: PipelineStage) {}

    /// Called when it has ended.
    fn ends(&self, _step: PipelineStage) {}
}

/// The stages of the pipeline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PipelineStage {
    /// The plant is built and linearised.
    Model,
    /// The order is reduced.
    Reduce,
    /// The controller is designed and sampled.
    Synthesise,
    /// The sampled controller is verified.
    Verify,
    /// The code is written.
    Export,
}

impl PipelineStage {
    /// Returns the name of the stage.
    pub fn name(self) -> &'static str {
        match self {
            PipelineStage::Model => "model",
            PipelineStage::Reduce => "reduce",
            PipelineStage::Synthesise => "synthesise",
            PipelineStage::Verify => "verify",
            PipelineStage::Export => "export",
        }
    }
}

/// Time of a stage, as measured by the program that runs the pipeline.
#[derive(Debug, Clone, PartialEq)]
pub struct StageTime {
    /// The stage.
    pub name: String,
    /// Time, ms.
    pub milliseconds: f64,
}

/// Runs a stage between the two calls that announce its beginning and its end.
pub fn run_observed<T>(world: &dyn World, step: PipelineStage, run: impl FnOnce() -> T) -> T {
    world.begins(step);
    let made = run();
    world.ends(step);
    made
}
