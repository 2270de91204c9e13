//! The factor by which the stated ranges of all parameters together may be widened before the loop can become unstable.

use counterpoise_controller::Controller;
use counterpoise_models::parameters::Parameters;

use super::loops::PulledLoop;
use super::nearest_mechanism::find_nearest;
use super::places::Joints;
use super::problem::{
    Bounds, DestabilisingMechanism, Direction, FrequencyBounds, Mechanism, Problem, StatedRange, Uncertainty,
};
use super::{Perturbation, UpperBound};
use crate::robustness::VariedParameter;
use crate::tolerance::WIDEST_RANGES;
use crate::{Error, Procedure};

/// The robust stability of a loop.
#[derive(Debug, Clone, PartialEq)]
pub struct RobustStability {
    /// Bounds over frequency, by rising frequency.
    pub bounds: Vec<Bounds>,
    /// The loop is stable for all parameters in the stated ranges widened by less than this: 1 over the largest upper bound.
    pub guaranteed: f64,
    /// Frequency at which the upper bound is largest, Hz.
    pub worst_hz: f64,
    /// The smallest perturbation that was found to make the loop unstable.
    pub found: Option<DestabilisingMechanism>,
    /// Parameters that do not enter the linear loop.
    pub left_out: Vec<VariedParameter>,
    /// The sinusoidal hub rate at which dry friction is taken as viscous friction, where it varies, rad/s.
    pub dry_friction_at_rad_s: Option<f64>,
    /// The errors at the plant's input and of the hub gyroscope's reading.
    pub errors: [f64; 2],
    /// Proof of the bounds.
    pub proof: BoundProof,
}

/// Proof of the bounds of a [`RobustStability`], for a check by other code.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundProof {
    /// The systems of which M is made.
    pub pulled: PulledLoop,
    /// The stated range of each parameter that enters, in the order of the blocks.
    pub ranges: Vec<StatedRange>,
    /// The scalings that prove each upper bound, in the order of the bounds.
    pub scalings: Vec<UpperBound>,
    /// The perturbation behind each lower bound; `None` if none was found.
    pub perturbations: Vec<Option<Perturbation>>,
}

/// Bounds how far the ranges of all parameters together may be widened before the loop can be unstable.
///
/// At each frequency the structured singular value of the loop's uncertain parts is bounded from above by scalings D and G and from
/// below by the power iteration; the most dangerous perturbations are then closed with the sampled loop, and scaled until a pole
/// stands on the unit circle. `None` if the nominal loop is unstable, or nothing that enters the loop is uncertain.
///
/// # Errors
/// Parameters that make no mechanism, and those of the linear loop.
pub fn robust_stability(
    parameters: &Parameters,
    controller: &Controller,
    procedure: &Procedure,
    uncertainty: &Uncertainty,
) -> Result<Option<RobustStability>, Error> {
    robust_stability_in(Joints::Sliding, parameters, controller, procedure, uncertainty)
}

/// Does the same as [`robust_stability`], with friction sliding or at rest. At rest `controller` has linear paths in the place of
/// its friction observers ([`crate::certificate::elements::quasi_linear`]), and the presliding stiffness is a parameter like any
/// other.
///
/// # Errors
/// As [`robust_stability`].
pub fn robust_stability_in(
    joints: Joints,
    parameters: &Parameters,
    controller: &Controller,
    procedure: &Procedure,
    uncertainty: &Uncertainty,
) -> Result<Option<RobustStability>, Error> {
    let problem = Problem::new(Mechanism { parameters, joints }, controller, procedure, uncertainty)?;
    let stable = problem.pole(&Direction::none(problem.entering.len()), 1.0)?.norm() < 1.0;
    if !stable || problem.pulled.structure.blocks.is_empty() {
        return Ok(None);
    }
    let scanned = problem.scan()?;
    let found = find_nearest(&problem, &scanned)?;
    let worst = scanned.iter().max_by(|a, b| a.upper.beta.total_cmp(&b.upper.beta));
    let (peak, worst_hz) = worst.map_or((0.0, 0.0), |at| (at.upper.beta, at.hz));
    let bounds = scanned.iter().map(FrequencyBounds::bounds).collect();
    Ok(Some(RobustStability {
        bounds,
        guaranteed: 1.0 / peak.max(1.0 / WIDEST_RANGES),
        worst_hz,
        found,
        left_out: problem.left_out.clone(),
        dry_friction_at_rad_s: problem.dry_at,
        errors: problem.errors,
        proof: BoundProof {
            pulled: problem.pulled.pulled_loop(),
            ranges: problem.entering.clone(),
            scalings: scanned.iter().map(|at| at.upper.clone()).collect(),
            perturbations: scanned.into_iter().map(|at| at.lower).collect(),
        },
    }))
}
