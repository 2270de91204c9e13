//! H2 control of a generalised plant by two Riccati equations.

use counterpoise_linalg::{C64, Mat, care};
use counterpoise_lti::{StateSpace, Timebase, h2norm};

use crate::Error;
use crate::cause::DesignEquation;
use crate::cause::{Cause, PlantCause};
use crate::certificate::Equation;
use crate::finding::{DesignFinding, Part};
use crate::generalised_plant::{Blocks, GeneralisedPlant, absorb_direct_path};
use crate::origin::require_solution;

/// An H2 controller with its certificates.
#[derive(Debug, Clone, PartialEq)]
pub struct H2 {
    /// u = K y.
    pub controller: StateSpace,
    /// State feedback u = -F x, in the plant's states scaled by powers of two.
    pub F: Mat,
    /// Observer gain.
    pub L: Mat,
    /// Norm from w to z that the equations predict.
    pub predicted_norm: f64,
    /// Norm of the assembled loop; infinite if that is not stable.
    pub achieved_norm: f64,
    /// Poles of the loop: those of the state feedback and of the observer, by separation.
    pub closed_loop: Vec<C64>,
    /// The regulator's equation.
    pub regulator: Equation,
    /// The filter's equation.
    pub filter: Equation,
}

/// Returns the controller that makes the H2 norm from w to z smallest
///
/// ```text
///     A'X + XA - (XB2 + C1'D12) R^-1 (B2'X + D12'C1) + C1'C1 = 0,  R = D12'D12,  F = R^-1 (B2'X + D12'C1)
///     AY + YA' - (YC2' + B1D21') V^-1 (C2Y + D21B1') + B1B1' = 0,  V = D21 D21', L = (YC2' + B1D21') V^-1
///     K: x' = (A - B2F - LC2) x + L y,  u = -F x                    norm^2 = tr(B1'XB1) + tr(R F Y F')
/// ```
///
/// (Doyle, Glover, Khargonekar, Francis, IEEE TAC 34 (1989) 831, with cross terms.) Needs D11 = 0, D12 of full column,
/// D21 of full row rank; D22 may be anything. The states are scaled by powers of two first.
///
/// # Errors
/// [`Error`] if a decomposition fails. A plant that breaks a condition is [`Error::Refused`] and says which.
pub fn h2syn(plant: &GeneralisedPlant) -> Result<H2, Error> {
    plant.check_regular()?;
    let P = plant.blocks();
    if P.D11.norm_max() != 0.0 {
        let cause = Cause::Plant(PlantCause::NoiseReachesCost { gain: P.D11.norm_max() });
        return Err(Error::refusal(vec![DesignFinding::refusal(Part::Generalised, cause).at(f64::INFINITY)]));
    }
    let (R, V) = (&P.D12.t() * &P.D12, &P.D21 * &P.D21.t());
    let (SX, SY) = (&P.C1.t() * &P.D12, &P.B1 * &P.D21.t());
    let X = care(&P.A, &P.B2, &(&P.C1.t() * &P.C1), &R, Some(&SX))?;
    let Y = care(&P.A.t(), &P.C2.t(), &(&P.B1 * &P.B1.t()), &V, Some(&SY))?;
    let X = require_solution(&P, DesignEquation::Regulator, X)?;
    let Y = require_solution(&P, DesignEquation::Filter, Y)?;
    let (F, L) = (X.F.clone(), Y.F.t());
    let square = (&P.B1.t() * &(&X.X * &P.B1)).trace() + (&R * &(&F * &(&Y.X * &F.t()))).trace();
    let controller = absorb_direct_path(P.convert_to_plant_states(observer(&P, &F, &L)?), &P.D22)?;
    let closed = plant.close(&controller)?;
    Ok(H2 {
        predicted_norm: square.max(0.0).sqrt(),
        achieved_norm: h2norm(&closed)?,
        closed_loop: [X.closed_loop.as_slice(), Y.closed_loop.as_slice()].concat(),
        regulator: X.into(),
        filter: Y.into(),
        controller,
        F,
        L,
    })
}

/// x' = (A - B2 F - L C2) x + L y, u = -F x.
fn observer(P: &Blocks, F: &Mat, L: &Mat) -> Result<StateSpace, Error> {
    let A = &(&P.A - &(&P.B2 * F)) - &(L * &P.C2);
    let D = Mat::zeros(F.nrows(), L.ncols());
    Ok(StateSpace::new(A, L.clone(), -F, D, Timebase::Continuous)?)
}
