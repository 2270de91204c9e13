//! Linear time-invariant systems with an explicit timebase.
//!
//! In come A, B, C, D and a timebase; out go connected and sampled systems, responses, norms, Gramians and margins. A
//! system is scaled by powers of two before anything is computed from it, and taken apart into the groups of states
//! that act on each other, so that plants in physical units and weights at the far ends of the spectrum keep their
//! digits.
//!
//! *Invariant*: nothing here knows a machine, a weight, a file, a thread or a clock. There is no default timebase, no
//! polynomial is expanded, `feedback` is negative and `lft` positive.
//!
//! Modules in reading order: [`system`], [`connect`](mod@connect), [`named_blocks`], [`delay`], [`zpk`], [`transfer`], [`descriptor`],
//! [`discretise`], [`delayed_hold`], [`sampled_h2_problem`],
//! [`scaling`], [`components`], [`roots`], [`response`], [`time`], [`gramians`], [`norms`], [`margins`](mod@margins),
//! [`delayed_margins`], [`multiloop_margins`], [`placement`],
//! [`tolerance`] (the numbers that decide), [`error`].
//!
//! ```
//! use counterpoise_linalg::C64;
//! use counterpoise_lti::{Timebase, Zpk, margins};
//! // 2/(s+1)^3 may be multiplied by 4 before it oscillates, at sqrt(3) rad/s.
//! let poles = vec![C64::new(-1.0, 0.0); 3];
//! let g = Zpk { zeros: vec![], poles, gain: 2.0, timebase: Timebase::Continuous }.to_state_space()?;
//! let margin = margins(&g)?.gain[0];
//! assert!((margin.factor - 4.0).abs() < 1e-12);
//! assert!((margin.rate_rad_s - 3f64.sqrt()).abs() < 1e-12);
//! # Ok::<(), counterpoise_lti::Error>(())
//! ```
#![allow(non_snake_case)]

mod asymptotes;
mod bounds;
mod careful_response;
pub mod components;
pub mod connect;
mod crossings;
pub mod delay;
pub mod delayed_hold;
pub mod delayed_margins;
pub mod descriptor;
pub mod discretise;
mod entrywise_zeros;
pub mod error;
pub mod gramians;
mod hessenberg_sweep;
mod hidden_modes;
mod level;
pub mod margins;
pub mod multiloop_margins;
pub mod named_blocks;
pub mod norms;
mod peak;
pub mod placement;
pub mod response;
mod root_order;
pub mod roots;
pub mod sampled_h2_problem;
pub mod scaling;
mod scan;
mod structure;
pub mod system;
pub mod time;
pub mod tolerance;
mod tracked_matrix;
pub mod transfer;
pub mod zpk;

pub use connect::{append, feedback, inverse, lft, parallel, series};
use counterpoise_linalg::{C64, CMat, Mat};
pub use delay::{delay_samples, pade};
pub use delayed_hold::c2d_delayed;
pub use delayed_margins::{DelayedMargins, margins_with_delay};
pub use descriptor::Descriptor;
pub use discretise::{Discretisation, QuadraticCost, SampledCost, c2d, d2c_tustin, sampled_cost};
pub use error::Error;
pub use gramians::{
    ctrb_factor, ctrb_gramian, gramian_factors, hankel_values, hankelnorm, obsv_factor, obsv_gramian,
};
pub use margins::{
    CandidateMargins, DiskMargin, GainChange, GainMargin, Margins, PhaseMargin, candidate_margins,
    candidate_sensitivity, margins, provisional_margins,
};
pub use multiloop_margins::{MultiloopMargins, multiloop_margins};
pub use named_blocks::{NamedSystem, SignalTerm, connect};
pub use norms::{NormBounds, h2norm, hinfnorm, linfnorm, linfnorm_bounds};
pub use peak::Peak;
pub use placement::{Placement, place};
pub use response::{Response, dcgain, frequency_response, response_at, sigma};
pub use roots::{damping_ratio, is_stable, is_stable_pole, poles, poles_on_boundary, zeros};
pub use sampled_h2_problem::{Noise, SampledProblem, sampled_problem};
pub use system::{StateSpace, Timebase};
pub use time::{TimeResponse, impulse, lsim, step};
pub use transfer::TransferFunction;
pub use zpk::Zpk;
