//! The stages between a project file and exported code, and between recordings and a better model: each stage is a function.
//!
//! [`design`] is the whole forward way: [`model`](mod@model) -> [`reduce`](mod@reduce) -> [`synthesise`] -> [`verify`](mod@verify)
//! -> [`export`](mod@export). Each stage takes what the stage before it made; nothing else is shared. A caller who wants
//! fewer stages calls fewer. [`recordings`] leads back from recordings of a machine to a better model; [`studies`] vary what the
//! forward way does.
//!
//! *Invariant*: no file, thread, clock or terminal; files are read and stages are watched through [`World`].
//!
//! Modules in reading order: [`error`], [`model`](mod@model), [`reduce`](mod@reduce), [`synth`], [`road`], [`verify`](mod@verify),
//! [`export`](mod@export), [`plant_views`], [`recordings`], [`studies`], [`results`].
//!
//! ```
//! use counterpoise_pipeline::{PipelineError, model};
//! use counterpoise_project::Project;
//!
//! let mut project = Project::parse(counterpoise_project::STARTER, "project.toml").map_err(|_| "bad project")?.project;
//! assert!(model(&project)?.linear.system.order() > 4);
//! project.model.configuration = Some("unknown".into());
//! assert!(matches!(model(&project), Err(PipelineError::Configuration { .. })));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod error;
pub mod export;
pub mod model;
pub mod plant_views;
pub mod recordings;
pub mod reduce;
pub mod results;
pub mod road;
pub mod studies;
pub mod synth;
pub mod verify;

use counterpoise_export::File;
use counterpoise_project::Project;
use counterpoise_verify::VerifiedController;

pub use error::PipelineError;
pub use export::{Exported, LeftOut, export};
pub use model::{Modelled, cannot_hold, finite_elements, finite_elements_of, model};
pub use recordings::redesign::{Consequence, consequence};
pub use reduce::{Reduced, reduce};
pub use studies::sweep::{campaign, families, robust_stability};
pub use synth::{Synthesised, synthesise};
pub use verify::{procedure, verify, verify_linear_on, verify_on, verify_watched};

/// What the road needs of the world, handed in: files beside the project, and somebody who watches the steps.
pub trait World {
    /// The bytes of a file beside the project file.
    ///
    /// # Errors
    /// Why the file cannot be read, in words.
    fn read(&self, name: &str) -> Result<Vec<u8>, String>;

    /// Called when a step begins.
    fn begins(&self, _step: Step) {}

    /// Called when it has ended.
    fn ended(&self, _step: Step) {}
}

/// The steps of the road.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// The plant is built and linearised.
    Model,
    /// Its order is reduced.
    Reduce,
    /// The controller is designed and sampled.
    Synthesise,
    /// The sampled controller is verified.
    Verify,
    /// Its code is written.
    Export,
}

impl Step {
    /// The step in one word.
    pub fn name(self) -> &'static str {
        match self {
            Step::Model => "model",
            Step::Reduce => "reduce",
            Step::Synthesise => "synthesise",
            Step::Verify => "verify",
            Step::Export => "export",
        }
    }
}

/// Everything that the road made.
#[derive(Debug, Clone)]
pub struct Designed {
    /// The plant.
    pub modelled: Modelled,
    /// The plant that the design took.
    pub reduced: Reduced,
    /// The design and its sampled controller.
    pub synthesised: Synthesised,
    /// The controller with its verdicts.
    pub verified: VerifiedController,
    /// Its code.
    pub files: Vec<File>,
    /// Code that the project asks for and cannot have.
    pub left_out: Vec<LeftOut>,
}

/// The whole road.
///
/// # Errors
/// [`PipelineError`]: what is missing in the project, what cannot be built, and every reason why there is no controller.
/// A requirement that is not met is no error: it is a verdict in [`Designed::verified`].
pub fn design(project: &Project, world: &dyn World) -> Result<Designed, PipelineError> {
    let modelled = watched(world, Step::Model, || model(project))?;
    let reduced = watched(world, Step::Reduce, || reduce(project, &modelled))?;
    let synthesised = watched(world, Step::Synthesise, || synthesise(project, &modelled, &reduced))?;
    let verified = watched(world, Step::Verify, || verify(project, &modelled, &synthesised, world))?;
    let Exported { files, left_out } =
        watched(world, Step::Export, || export(project, &modelled, &verified, world))?;
    Ok(Designed { modelled, reduced, synthesised, verified, files, left_out })
}

/// Runs a step under the eyes of the world.
pub fn watched<T>(world: &dyn World, step: Step, run: impl FnOnce() -> T) -> T {
    world.begins(step);
    let made = run();
    world.ended(step);
    made
}
