//! H2 feedback and feedforward by Riccati and Sylvester equations, with what surrounds them on a designer's bench.
//!
//! In come a linear plant ([`DesignPlant`]) and what is asked of it ([`Specification`]: weights, noises, assembly); out
//! comes a [`Design`] with its certificates, and from it a discrete controller that runs on the target.
//!
//! *Invariant*: no physics lives here: no model of friction, backlash or structure is evaluated, none is simulated (the
//! friction observer takes identified levels as plain numbers); no file, thread or clock; and no equation of the design
//! is solved before [`preflight()`] has said that it can be.
//!
//! Modules in reading order:
//! - what is asked: [`weight`] (with [`rational_function`]; [`table`] fits one to drawn points), [`channel`], [`plant`], [`specification`];
//! - whether it can be had: [`preflight`](mod@preflight), [`finding`], [`cause`], [`refusal`], [`error`];
//! - the design: [`feedback`](mod@feedback), [`error_feedback`] (one that sees the error alone), [`cascade`], [`feedforward`](mod@feedforward), [`design`](mod@design), [`certificate`],
//!   [`joint`] optimum of all parts, [`residual`], [`total_cost`](mod@total_cost);
//! - [`first_design`](mod@first_design): weights chosen for the highest [`bandwidth`] that the loop allows, on the processors at hand;
//! - in sampled time: [`sampling`], [`discretise`](mod@discretise), [`ramp`];
//! - around it: [`schedule`](mod@schedule) over out-of-balance with its [`scheduled_controller`], [`figures`](mod@figures),
//!   [`requirements`] and [`search`](mod@search) from requirements to weights, [`observer`] of friction, [`adaptation`];
//! - feedback of fixed structure: [`fixed_structure`], and its [`tuning`] under limits of the loop; [`front`], the designs between which
//!   objectives are traded; [`best_loop`](mod@best_loop), what any linear feedback could do;
//! - other methods: [`generalised_plant`], [`h2syn`](mod@h2syn), [`hinfsyn`](mod@hinfsyn), [`lqg`], [`alternatives`];
//! - [`tolerance`]: every number that decides.
//!
//! A servo of one inertia with viscous drag, held without steady error:
//!
//! ```
//! use counterpoise_linalg::{Mat, sparse::VectorEntry};
//! use counterpoise_lti::{StateSpace, Timebase};
//! use counterpoise_synth::*;
//! let (A, B) = (Mat::from_rows(&[&[-0.5]]), Mat::from_rows(&[&[2.0, 1.0]]));
//! let system = StateSpace::new(A, B, Mat::eye(1), Mat::zeros(1, 2), Timebase::Continuous)?;
//! let plant = DesignPlant::ideal(system, 0, 0);
//! let weights = FeedbackWeights {
//!     error: Weight::Integral { gain: 10.0, time_s: 1.0 },
//!     control: Weight::Lead { gain: 1.0, time_s: 0.01 },
//!     combination: vec![],
//!     measurement_noise: 1e-4,
//!     disturbances: vec![VectorEntry::new(1, 1.0)],
//!     loop_recovery: 0.0,
//!     modes: LightModes::Kept,
//! };
//! let part = design_feedback(&plant, &weights, Reference::Error)?;
//! assert!(part.closed_loop.iter().all(|pole| pole.re < 0.0));
//! assert!(part.cost.relative_difference().is_some_and(|difference| difference < 1e-6));
//! # Ok::<(), Error>(())
//! ```
#![allow(non_snake_case)]

pub mod adaptation;
pub mod alternatives;
mod anti_windup;
mod augmented_plant;
pub mod bandwidth;
pub mod best_loop;
pub mod cascade;
pub mod cause;
pub mod certificate;
pub mod channel;
pub mod design;
pub mod discretise;
pub mod error;
pub mod error_feedback;
pub mod feedback;
pub mod feedforward;
pub mod figures;
pub mod finding;
pub mod first_design;
pub mod fixed_structure;
pub mod front;
pub mod generalised_plant;
pub mod h2syn;
pub mod hinfsyn;
pub mod joint;
pub mod lqg;
mod modes;
mod normal_form;
pub mod observer;
mod origin;
pub mod plant;
pub mod preflight;
pub mod ramp;
pub mod rational_function;
pub mod refusal;
pub mod requirements;
pub mod residual;
mod sampled_data;
pub mod sampling;
pub mod schedule;
pub mod scheduled_controller;
pub mod search;
pub mod specification;
mod stage;
pub mod table;
pub mod tolerance;
pub mod total_cost;
pub mod tuning;
pub mod weight;

pub use adaptation::{
    AdaptiveController, Estimation, RecursiveLeastSquares, RecursiveSettings, WindowedMean,
};
pub use alternatives::{Alternative, SynthesisMethod, design_alternative};
pub use bandwidth::{Bandwidth, BandwidthLimit, LimitKind, Unknown};
pub use best_loop::problem::BestLoopProblem;
pub use best_loop::{BestLoop, BestLoopTask, best_loop};
pub use cause::{
    Cause, DesignEquation, HiddenDirection, ModeBlock, PlantCause, SpecificationCause, StatedDensity,
};
pub use certificate::{Cost, Equation, PartCertificates};
pub use channel::DisturbanceChannel;
pub use design::{Design, design};
pub use discretise::discretise;
pub use error::{Error, attempt};
pub use feedback::{Feedback, design_feedback};
pub use feedforward::{Feedforward, design_feedforward};
pub use figures::{FigureSystems, Figures, figure_systems, sampled_loop_figures};
pub use finding::{ConcernedWeight, DesignFinding, FindingSeverity, Part, WeightRole};
pub use first_design::{
    Circumstances, ControlLimit, ExpectedMotion, FirstDesign, LimitLoops, LoopJudgement, RequiredMargins,
    UsualPlants, UsualReading, first_design, first_design_on,
};
pub use fixed_structure::{Block, BlockKind, BlockParameter, FixedStructure, ParameterName};
pub use front::{DesignFront, FrontMethod, FrontObjective, FrontPoint, FrontTask, search_front};
pub use generalised_plant::{GeneralisedPlant, NamedBlock, Ports, StateOrigin};
pub use h2syn::{H2, h2syn};
pub use hinfsyn::{HInfinity, hinfsyn};
pub use joint::{JointOptimum, joint_optimum};
pub use lqg::{Gain, LqgLtrDesign, kalman, lqg_ltr, lqr, observer_controller};
pub use observer::{Drive, Drives, FrictionSide, ObservedFriction, friction_observers};
pub use plant::{DesignPlant, LateReading, RateLoop};
pub use preflight::preflight;
pub use ramp::control_of_ramp;
pub use rational_function::RationalFunction;
pub use refusal::Refusal;
pub use requirements::{BandSpectrum, Requirements};
pub use residual::{ResidualChoice, error_at, stabilisation_error};
pub use sampling::{SampledLoop, Sampling, SamplingMethod, check_sampled_loop, sampled_loop, sampled_plant};
pub use schedule::{Conditions, HeaveFeedforwardLaw, ScheduleConfiguration, ScheduleEntry, design_schedule};
pub use scheduled_controller::discretise_schedule;
pub use search::{SearchEnding, SearchResult, SearchTask, SearchTrial, search_specification, trade_off};
pub use specification::{
    Assembly, DisturbanceKnowledge, FeedbackWeights, FeedforwardBasis, FeedforwardWeights, LightModes,
    Reference, Specification,
};
pub use table::{TablePoint, WeightFit, fit_table};
pub use total_cost::{SourceCost, TotalCost, total_cost};
pub use tuning::{
    Disturbance, LoopLimits, LoopMeasures, TunedDesign, TunedFeedback, TuningSubject, TuningTask,
    measure_controller, tune_parameters,
};
pub use weight::Weight;
