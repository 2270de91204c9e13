//! Model reduction with its error.
//!
//! In come systems (or mass, damping and stiffness) and an order or an error; out go smaller systems, each with the
//! values by which its states were ranked, the a priori bound if there is one, the error that was measured, and
//! warnings.
//!
//! *Invariant*: nothing here knows a weight's purpose, a machine, a file, a thread or a clock. Poles on or beyond the
//! border of stability are never reduced: they are split off first and put back unchanged.
//!
//! Modules in reading order: [`reduction`], [`split`](mod@split), [`balanced_truncation`], [`weighted_balancing`], [`modal_truncation`], [`second_order`],
//! [`large`] (structures with sparse matrices), [`minimal_realisation`](mod@minimal_realisation), [`measure`], [`tolerance`] (the numbers that decide),
//! [`error`].
//!
//! ```
//! use counterpoise_linalg::C64;
//! use counterpoise_lti::{Timebase, Zpk};
//! use counterpoise_reduce::{Method, Order, balred};
//! // An integrator in front of a slow and a fast lag: the integrator stays, the fast lag goes.
//! let poles = [0.0, -1.0, -500.0].map(|p| C64::new(p, 0.0)).to_vec();
//! let g = Zpk { zeros: vec![], poles, gain: 500.0, timebase: Timebase::Continuous }.to_state_space()?;
//! let reduced = balred(&g, Order::States(2), Method::SquareRoot)?;
//! assert_eq!(counterpoise_lti::poles(&reduced.system)?[1].re, 0.0);
//! assert!(reduced.measured_error.value <= reduced.bound.unwrap_or(0.0) * (1.0 + 1e-6));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![allow(non_snake_case)]

pub mod balanced_truncation;
pub mod error;
pub mod large;
pub mod measure;
pub mod minimal_realisation;
pub mod modal_truncation;
pub mod reduction;
pub mod second_order;
pub mod split;
mod state_units;
pub mod tolerance;
pub mod weighted_balancing;

pub use balanced_truncation::{BalancedSystem, balred};
pub use error::Error;
pub use large::{LargeReduction, LargeStructure, balred_large, error_at};
pub use measure::error_norm;
pub use minimal_realisation::{MinimalRealisation, minimal_realisation};
pub use modal_truncation::{Residual, modal_truncation};
pub use reduction::{Method, Order, Reduction, Warning};
pub use second_order::{SecondOrder, SecondOrderReduction, guyan, modal_basis};
pub use split::{Split, split_by, split_stable};
pub use weighted_balancing::{ControllerReduction, Weights, reduce_controller, weighted_balred};
