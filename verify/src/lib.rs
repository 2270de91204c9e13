//! Figures, limits and verdicts: the judge of a controller.
//!
//! In come a plant, the discrete controller that will be exported, and requirements; out come measured figures, a verdict for
//! each requirement, and the evidence as plain data.
//!
//! *Invariant*: nothing here knows how a controller was designed; nothing here reads a file, a clock or an unseeded random number.
//!
//! Modules in reading order: [`figure`], [`requirement`], [`road_class`], [`procedure`], [`signals`], [`history`], [`linear_loop`],
//! [`nonlinear_runs`], [`missing_figures`], [`measure`], [`coincidence`], [`image_motion`], [`sight_options`], [`line_of_sight`], [`sight_spectrum`], [`error_budget`](mod@error_budget), [`verification`], [`two_axes`], [`rejection_spectra`], [`difference`], [`robustness`], [`structured`], [`certificate`],
//! [`tolerance`] (the numbers that decide), [`error`].
//!
//! ```
//! use counterpoise_verify::{PerformanceFigure, Limit, Requirement, Verdict};
//! let requirement = Requirement::new(PerformanceFigure::from_key("gain_margin_db")?, Limit::AtLeast(12.0))?;
//! assert!(matches!(requirement.judge(13.0), Verdict::Holds { .. }));
//! # Ok::<(), counterpoise_verify::Error>(())
//! ```
#![allow(non_snake_case)]

pub mod certificate;
pub mod coincidence;
pub mod difference;
pub mod error;
pub mod error_budget;
pub mod figure;
pub mod history;
pub mod image_motion;
pub mod line_of_sight;
pub mod linear_loop;
pub mod measure;
pub mod missing_figures;
pub mod nonlinear_runs;
pub mod procedure;
pub mod rejection_spectra;
pub mod requirement;
pub mod road_class;
pub mod robustness;
pub mod sight_options;
pub mod sight_spectrum;
pub mod signals;
mod spelling;
pub mod structured;
pub mod tolerance;
pub mod two_axes;
pub mod verification;

pub use coincidence::Coincidence;
pub use error::Error;
pub use error_budget::{
    BudgetRun, Contribution, ErrorBudget, ErrorSource, LinearContribution, budget_angles, error_budget,
};
pub use figure::{
    ARRANGEMENTS, Arrangement, CertificateFigure, LoopFigure, Model, PerformanceFigure, Quantity, RestFigure,
    SightFigure, Source, StepFigure, TriangleFigure,
};
pub use history::{Experiment, History, HistoryColumn};
pub use image_motion::Optics;
pub use line_of_sight::{SightAngles, SightError};
pub use measure::{MeasuredFigure, Value};
pub use missing_figures::MissingReason;
pub use procedure::{HeaveAndPitch, Procedure, Road, RoadColumn, RoadOrigin, Sine, Step, Triangle};
pub use requirement::{Limit, Requirement, Verdict};
pub use sight_options::LineOfSight;
pub use two_axes::{
    AxisPair, JointExperiment, JointFigure, JointMachine, JointProcedure, JointQuantity, JointRequirement,
    JointRun, JointValue, JointVerification, verify_two_axes,
};
pub use verification::{
    Evidence, FrequencyFigures, Verification, VerifiedController, frequency_figures, linear_plant, verify,
    verify_linear, verify_watched,
};
