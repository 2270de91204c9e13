//! H2 feedback and feedforward by Riccati and Sylvester equations, with what surrounds them on a designer's bench.
//!
//! In come a linear plant ([`DesignPlant`]) and what is asked of it ([`Specification`]: weights, noises, assembly); out
//! comes a [`Design`] with its certificates, and from it a discrete controller that runs on the target.
//!
//! *Invariant*: nothing here knows friction, backlash, a kilogram or a simulator; no file, thread or clock; and no
//! equation is solved before [`preflight()`] has said that it can be.
//!
//! Modules in reading order: [`weight`], [`plant`], [`specification`], [`finding`], [`preflight`](mod@preflight),
//! [`feedback`](mod@feedback), [`feedforward`](mod@feedforward), [`design`](mod@design), [`certificate`].
#![allow(non_snake_case)]

pub mod weight;
pub mod rational;
pub mod plant;
pub mod specification;
pub mod finding;
pub mod outcome;
pub mod error;
pub mod preflight;

pub use error::Error;
pub use finding::{Cause, Finding, Part, Severity};
pub use outcome::Outcome;
pub use plant::{Channel, DesignPlant};
pub use preflight::preflight;
pub use rational::Rational;
pub use specification::{Assembly, FeedbackWeights, FeedforwardWeights, Knowledge, Reference, Specification};
pub use weight::Weight;
