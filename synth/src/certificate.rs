//! The certificate of a design: residuals, spectra, and the cost that the assembled loop really has.

use counterpoise_linalg as linalg;
use counterpoise_linalg::C64;
use counterpoise_lti::{StateSpace, h2norm};

use crate::Error;
use crate::cause::{Cause, DesignEquation, PlantCause};
use crate::finding::{DesignFinding, Part};

/// Accuracy of the solution of a Riccati equation.
#[derive(Debug, Clone, PartialEq)]
pub struct Equation {
    /// Norm of the residual relative to the norms of the equation's terms.
    pub relative_residual: f64,
    /// Spectrum of the closed matrix: all in the left half plane.
    pub spectrum: Vec<C64>,
}

/// A cost as predicted by the equations and as found on the assembled loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// From the solutions of the Riccati and Sylvester equations; `None` if it has no bound.
    pub predicted: Option<f64>,
    /// From a Lyapunov equation of the assembled loop; `None` if that is not stable or not strictly proper.
    pub achieved: Option<f64>,
}

impl Cost {
    /// Returns |achieved - predicted| / predicted, where both are known.
    pub fn relative_difference(&self) -> Option<f64> {
        let (predicted, achieved) = (self.predicted?, self.achieved?);
        let scale = predicted.abs().max(f64::MIN_POSITIVE);
        Some((achieved - predicted).abs() / scale)
    }
}

/// The certificates of one part that was designed in sampled time.
#[derive(Debug, Clone, PartialEq)]
pub struct PartCertificates {
    /// Part.
    pub part: Part,
    /// Mean square of its weighted signals: as the equations predict it, and as the assembled sampled loop has it.
    pub cost: Cost,
    /// The regulator's discrete Riccati equation.
    pub regulator: Equation,
    /// The filter's; none with exact knowledge.
    pub filter: Option<Equation>,
}

impl From<linalg::Riccati> for Equation {
    fn from(solution: linalg::Riccati) -> Self {
        Self { relative_residual: solution.certificate.relative_residual, spectrum: solution.closed_loop }
    }
}

/// Returns the solution of a Riccati equation, or refuses with the finding that says why there is none.
pub(crate) fn riccati(
    equation: DesignEquation,
    part: Part,
    outcome: linalg::Outcome<linalg::Riccati>,
) -> Result<linalg::Riccati, Error> {
    match outcome {
        linalg::Outcome::Solved(solution) => Ok(solution),
        linalg::Outcome::Infeasible(reason) => {
            let rate = mode_of(&reason).map(|mode| mode.norm());
            let finding =
                DesignFinding::refusal(part, Cause::Plant(PlantCause::Equation { equation, reason }));
            Err(Error::refusal(vec![match rate {
                Some(rate) => finding.at(rate),
                None => finding,
            }]))
        }
    }
}

/// The mode that a reason names.
fn mode_of(reason: &linalg::Reason) -> Option<C64> {
    use linalg::Reason;
    match reason {
        Reason::Uncontrollable { mode, .. } | Reason::Unobservable { mode, .. } => Some(*mode),
        Reason::OnBoundary { eigenvalue, .. } => Some(*eigenvalue),
        Reason::Inaccurate { hardest, .. } => hardest.map(|(mode, _)| mode),
        Reason::NoGraph | Reason::SingularWeight { .. } => None,
    }
}

/// The square of the H2 norm: the mean square of the outputs under unit white noise; `None` if the system is not
/// strictly stable, or passes white noise on.
pub(crate) fn mean_square(system: &StateSpace) -> Result<Option<f64>, Error> {
    let norm = h2norm(system)?;
    Ok(norm.is_finite().then_some(norm * norm))
}
