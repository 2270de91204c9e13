//! Dense matrices and the matrix equations of control engineering.
//!
//! In come plain real matrices; out go solutions, each with the certificate that says how good it is.
//!
//! *Invariant*: nothing here knows a system, a unit, a file, a thread or a clock.
//!
//! Modules in reading order: [`mat`] (the matrix itself), [`dense`] and [`decomposition`] (checked wrappers of faer),
//! [`balance`](mod@balance), [`schur`](mod@schur) (ordered real Schur form), [`sylvester`](mod@sylvester), [`invariant_subspace`] (how well one is determined), [`generalised_sylvester`],
//! [`lyapunov`], [`hammarling`] (factored Lyapunov solutions), [`expm`](mod@expm), [`sampled_integrals`] (sampled cost and noise), [`riccati`] (with certificates and named refusals), [`generalised_lyapunov`] (equations with a matrix `E`),
//! [`pencil_roots`](mod@pencil_roots), [`sparse`] (large structures), [`cone_program`] (convex programs, by Clarabel), [`tolerance`],
//! [`boundary`], [`stability`], [`staircase`] (minimal part in 32 digits), [`range_basis`] (ranks on the way to zeros), [`transfer_matrix`] (a transfer matrix to the last digits),
//! [`eigenvector_gain`](mod@eigenvector_gain) (the feedback of chosen eigenvectors).
//!
//! ```
//! use counterpoise_linalg::{Mat, care};
//! // x'' = u at the cost of the integral of x^2 + u^2.
//! let A = Mat::from_rows(&[&[0.0, 1.0], &[0.0, 0.0]]);
//! let B = Mat::col(&[0.0, 1.0]);
//! let answer = care(&A, &B, &Mat::diag(&[1.0, 0.0]), &Mat::eye(1), None)?;
//! let solution = answer.into_result().map_err(|reason| reason.to_string()).unwrap();
//! assert!((solution.F[(0, 1)] - 2f64.sqrt()).abs() < 1e-15);
//! assert!(solution.certificate.relative_residual < 1e-15);
//! # Ok::<(), counterpoise_linalg::Error>(())
//! ```
#![allow(non_snake_case)]

pub mod balance;
pub mod boundary;
pub mod cone_program;
pub mod decomposition;
pub mod dense;
pub mod eigenvector_gain;
mod error;
pub mod expm;
mod exponential_series;
mod extended_precision;
pub mod generalised_lyapunov;
pub mod generalised_sylvester;
pub mod hammarling;
mod hammarling_leaf;
mod heap;
pub mod invariant_subspace;
mod kernel;
mod long_complex;
mod long_matrix;
pub mod lyapunov;
mod lyapunov_leaf;
pub mod mat;
pub mod pencil_roots;
pub mod range_basis;
pub mod riccati;
pub mod sampled_integrals;
mod scalar;
pub mod schur;
mod simple_roots;
mod small_factors;
mod small_systems;
mod smith;
pub mod sparse;
mod spectrum;
pub mod stability;
pub mod staircase;
mod stein_leaf;
mod structure;
pub mod sylvester;
pub mod tolerance;
pub mod transfer_matrix;
mod transition;

pub use balance::{BalancedMatrix, balance};
pub use boundary::Boundary;
pub use cone_program::{Cone, ConeFailure, ConeProgram, ConeSolution};
pub use decomposition::{
    CSvd, Svd, cond, csingular_values, csvd, gen_eigenvalues, hessenberg, largest_singular_value, lstsq,
    pinv, rank, rank_tolerance, rcond_one, singular_values, svd, sym_eigen, sym_eigenvalues, sym_gen_eigen,
};
pub use dense::{
    Qr, cdet, cholesky, csolve, dot, inverse, qr, qr_full_q, qr_r, solve, transpose_times, unit_power,
};
pub use eigenvector_gain::{EigenvectorChoice, eigenvector_gain};
pub use error::Error;
pub use expm::{expm, expm_integral};
pub use generalised_lyapunov::{CostWeights, gcare, gdare, gdlyap, glyap};
pub use generalised_sylvester::gsylvester;
pub use hammarling::{
    dlyap_factor, dlyap_factors, dlyap_square_factor, lyap_factor, lyap_factors, lyap_square_factor,
};
pub use invariant_subspace::Subspace;
pub use lyapunov::{
    dlyap, dlyap_separation, lyap, lyap_separation, precise_gramian_factors, refined_square_norm,
};
pub use mat::{C64, CMat, Mat};
pub use pencil_roots::pencil_roots;
pub use range_basis::RangeBasis;
pub use riccati::{Outcome, Reason, Riccati, RiccatiCertificate, RiccatiMethod, care, care_g, dare};
pub use sampled_integrals::{van_loan_accumulated, van_loan_cost, van_loan_noise};
pub use schur::{Schur, eigenvalues, schur};
pub use sparse::{Sparse, SparseCholesky};
pub use stability::{boundary_eigenvalues, is_clear_of_boundary};
pub use staircase::{MinimalPart, minimal_part};
pub use sylvester::{dsylvester, eigenvalue_separation, sylvester};
pub use transfer_matrix::{StateRealisation, refined_transfer};
