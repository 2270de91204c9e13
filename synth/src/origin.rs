//! The place in a generalised plant of the mode that leaves a Riccati equation without a solution.

use counterpoise_linalg as linalg;
use counterpoise_linalg::{C64, CMat, Mat, Reason, csvd};

use crate::Error;
use crate::cause::{Cause, DesignEquation, HiddenDirection, PlantCause};
use crate::finding::{DesignFinding, Part};
use crate::generalised_plant::Blocks;

/// The solution of one of the two equations, or the finding with the mode that is in the way and the block it lives in.
pub(crate) fn require_solution(
    P: &Blocks,
    equation: DesignEquation,
    outcome: linalg::Outcome<linalg::Riccati>,
) -> Result<linalg::Riccati, Error> {
    let reason = match outcome {
        linalg::Outcome::Solved(solution) => return Ok(solution),
        linalg::Outcome::Infeasible(reason) => reason,
    };
    let side = |regulator, filter| if equation == DesignEquation::Regulator { regulator } else { filter };
    let (cause, rate) = match reason {
        Reason::Uncontrollable { mode, distance } => {
            let from = side(HiddenDirection::Control, HiddenDirection::Measurement);
            (hidden_mode(P, mode, distance, from)?, Some(mode.norm()))
        }
        Reason::Unobservable { mode, distance } => (
            hidden_mode(P, mode, distance, side(HiddenDirection::Cost, HiddenDirection::Noise))?,
            Some(mode.norm()),
        ),
        Reason::OnBoundary { eigenvalue, .. } => {
            (Cause::Plant(PlantCause::Equation { equation, reason }), Some(eigenvalue.norm()))
        }
        Reason::Inaccurate { hardest, .. } => {
            (Cause::Plant(PlantCause::Equation { equation, reason }), hardest.map(|(mode, _)| mode.norm()))
        }
        Reason::NoGraph | Reason::SingularWeight { .. } => {
            (Cause::Plant(PlantCause::Equation { equation, reason }), None)
        }
    };
    let finding = DesignFinding { rate_rad_s: rate, ..DesignFinding::refusal(Part::Generalised, cause) };
    Err(Error::refusal(vec![finding]))
}

fn hidden_mode(P: &Blocks, mode: C64, distance: f64, from: HiddenDirection) -> Result<Cause, Error> {
    Ok(Cause::Plant(PlantCause::ModeHidden {
        mode,
        distance,
        from,
        block: P.block_of(&direction(P, mode, from)?),
    }))
}

/// The moduli of the mode's direction, an entry a state: a left eigenvector that the inputs do not reach or a right one
/// that the outputs do not show.
fn direction(P: &Blocks, mode: C64, from: HiddenDirection) -> Result<Vec<f64>, Error> {
    match from {
        HiddenDirection::Control => missed_moduli(&P.A.t(), &P.B2.t(), mode),
        HiddenDirection::Measurement => missed_moduli(&P.A, &P.C2, mode),
        HiddenDirection::Cost => {
            let (A, C) = without(&P.A, &P.B2, &P.C1, &P.D12)?;
            missed_moduli(&A, &C, mode)
        }
        HiddenDirection::Noise => {
            let (A, C) = without(&P.A.t(), &P.C2.t(), &P.B1.t(), &P.D21.t())?;
            missed_moduli(&A, &C, mode)
        }
    }
}

/// `A - B D^+ C` and `(I - D D^+) C`: what is left where the input cancels what it can of the output.
fn without(A: &Mat, B: &Mat, C: &Mat, D: &Mat) -> Result<(Mat, Mat), Error> {
    let cancelled = linalg::solve(&(&D.t() * D), &(&D.t() * C))?;
    Ok((A - &(B * &cancelled), C - &(D * &cancelled)))
}

/// The moduli of the `x` with `[A - mode I; C] x` nearest to zero, scaled to a sum of squares of 1.
fn missed_moduli(A: &Mat, C: &Mat, mode: C64) -> Result<Vec<f64>, Error> {
    let n = A.nrows();
    let shifted = &A.to_complex() - &CMat::eye(n).scale(mode);
    let V = csvd(&shifted.vstack(&C.to_complex()))?.V;
    Ok(V.column(n - 1).iter().map(|entry| entry.norm()).collect())
}
