//! The one rule by which every routine decides whether an eigenvalue lies on the boundary of stability.

use crate::boundary::Boundary;
use crate::error::Error;
use crate::mat::{C64, Mat};
use crate::spectrum::Spectrum;

/// Returns the eigenvalues of `A`, one of each conjugate pair, that lie on the boundary of stability as far as the entries of
/// `A`, each rounded to a double, can tell.
///
/// The rule does not depend on the units of the states: an eigenvalue counts as on the boundary if its distance is below
/// the first-order effect of rounding each entry of `A`, from its left and right eigenvectors. A slow mode beside a fast one
/// is thus told from an integrator, and an integrator in coordinates that hide it is found. An eigenvalue of a matrix with at most 32 rows that is nearer to the
/// boundary than its computation tells is corrected in 32 digits. Both halves of a double
/// integrator that rounding has split are among the answer, because each is as sensitive as the split.
///
/// # Errors
/// Returns an error if `A` is not square or not finite, or if the eigenvalue iteration fails.
pub fn boundary_eigenvalues(A: &Mat, boundary: Boundary) -> Result<Vec<C64>, Error> {
    Ok(Spectrum::of(A)?.eigenvalues_on_boundary(boundary))
}

/// Returns whether every eigenvalue of `A` is farther from the boundary of stability than rounding the entries of `A` may move
/// it, to first order.
///
/// # Errors
/// As for [`boundary_eigenvalues`].
pub fn is_clear_of_boundary(A: &Mat, boundary: Boundary) -> Result<bool, Error> {
    let spectrum = Spectrum::of(A)?;
    let modes = spectrum.modes();
    Ok(modes.into_iter().all(|l| boundary.excess(l).abs() > spectrum.rounding_error(l)))
}
