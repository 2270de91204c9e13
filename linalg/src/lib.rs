//! Dense matrices and the matrix equations of control engineering.
//!
//! In come plain real matrices; out go solutions, each with the certificate that says how good it is.
//!
//! *Invariant*: nothing here knows a system, a unit, a file, a thread or a clock.
//!
//! Modules in reading order: [`mat`].
//!
//! ```
//! use counterpoise_linalg::Mat;
//! let a = Mat::from_rows(&[&[1.0, 2.0], &[3.0, 4.0]]);
//! assert_eq!((&a * &Mat::eye(2))[(1, 0)], 3.0);
//! ```
#![allow(non_snake_case)]

pub mod mat;

pub use mat::{C64, CMat, Mat};
