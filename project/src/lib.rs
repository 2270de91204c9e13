//! The project file: as written, and resolved.
//!
//! In come the text of a project file and the files that it names; out comes a resolved [`Project`], or every error of
//! the file at once, each with its place, what is allowed, and a hint.
//!
//! *Invariant*: nothing is computed here, and no file is opened: texts and bytes are handed in.
//!
//! Modules in reading order: [`diagnostic`], [`unit`](mod@unit) (quantities), [`file`](mod@file) (as written), [`assumption`] (what it leaves open),
//! [`resolve`] (as meant), [`starters`] (files to start from).
//!
//! ```
//! use counterpoise_project::Project;
//! let errors = Project::parse("[plant]\nname = 3", "rig.toml").unwrap_err();
//! let mistyped = "rig.toml:2:8: error: plant.name = 3: must be a text in quotes, not a whole number";
//! assert!(errors.iter().any(|error| error.to_string() == mistyped));
//! ```

pub mod assumption;
pub mod diagnostic;
pub mod file;
pub mod resolve;
pub mod starters;
mod tolerance;
pub mod unit;

pub use assumption::{
    Assumption, KeyTolerance, LATEST_USUAL_DRIVE_S, LATEST_USUAL_READING_S, SLOWEST_USUAL_DRIVE_RAD_S,
    ToleranceKind,
};
pub use diagnostic::{Diagnostic, Severity};
pub use file::{Attachments, Document, FORMAT, SettingValue};
pub use resolve::design::{ExportRequest, Language, ReductionMethod, ReductionOptions};
pub use resolve::fixed_structure::{FurtherPlants, TunedWeights, TuningObjective, TuningOptions};
pub use resolve::import::{ImportedStructure, MatrixFormat};
pub use resolve::model::{PlantSelection, StructureChoice};
pub use resolve::platform::{GeneratedMotion, MotionKind, PlatformSource, RoadSource};
pub use resolve::purpose::Purpose;
pub use resolve::statements::{SectionStatement, ValueStatement};
pub use resolve::sweep::{RobustnessCampaign, VariedTolerance};
pub use resolve::synthesis::DesignRequest;
pub use resolve::verify::VerificationOptions;
pub use resolve::{ParsedProject, Project};

/// Text of a complete, commented project file to start a new one from: an out-of-balance cantilever on a moving
/// platform, whose design holds every requirement that it states.
pub const STARTER: &str = include_str!("starter.toml");
