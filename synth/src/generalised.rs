//! The generalised plant of the textbooks, and what can be wrong with one.

use counterpoise_lti::linalg::{Svd, svd};
use counterpoise_lti::scaling::balance;
use counterpoise_lti::{Mat, StateSpace, Timebase, lft};

use crate::cause::Cause;
use crate::finding::{Finding, Part};
use crate::{Error, Outcome};

/// A plant between what disturbs and what is judged
///
/// ```text
///     w ---> |       | ---> z         x' = A  x + B1  w + B2  u
///            |   P   |                z  = C1 x + D11 w + D12 u
///     u ---> |       | ---> y         y  = C2 x + D21 w + D22 u
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Generalised {
    /// From (w, u) to (z, y), continuous.
    pub system: StateSpace,
    /// Number of controls u, the last inputs.
    pub controls: usize,
    /// Number of measurements y, the last outputs.
    pub measurements: usize,
}

/// A singular value of D12 or D21 below this, relative to the largest, counts as zero.
pub const FULL_RANK: f64 = 1e-13;

/// The blocks of a generalised plant, states scaled by powers of two.
pub(crate) struct Blocks {
    pub A: Mat,
    pub B1: Mat,
    pub B2: Mat,
    pub C1: Mat,
    pub C2: Mat,
    pub D11: Mat,
    pub D12: Mat,
    pub D21: Mat,
    pub D22: Mat,
    /// Physical state = scale x scaled state, powers of two.
    pub scale: Vec<f64>,
}

impl Blocks {
    /// A controller whose states estimate the scaled states, with states that estimate the plant's own: exact.
    pub fn in_plant_states(&self, K: StateSpace) -> StateSpace {
        let T = &self.scale;
        let A = Mat::from_fn(K.order(), K.order(), |i, j| K.A[(i, j)] * (T[i] / T[j]));
        let B = Mat::from_fn(K.order(), K.inputs(), |i, j| K.B[(i, j)] * T[i]);
        let C = Mat::from_fn(K.outputs(), K.order(), |i, j| K.C[(i, j)] / T[j]);
        StateSpace { A, B, C, ..K }
    }
}

impl Generalised {
    /// The generalised plant with its last `controls` inputs and `measurements` outputs.
    ///
    /// # Errors
    /// [`Error::System`] for a sampled system, [`Error::Index`] where it has fewer inputs or outputs.
    pub fn new(system: StateSpace, controls: usize, measurements: usize) -> Result<Self, Error> {
        if system.timebase != Timebase::Continuous {
            return Err(Error::System { what: "generalised plant", problem: "it must be continuous" });
        }
        let within = |what, index, count| {
            if index <= count { Ok(()) } else { Err(Error::Index { what, index, count }) }
        };
        within("control", controls, system.inputs())?;
        within("measurement", measurements, system.outputs())?;
        Ok(Self { system, controls, measurements })
    }

    /// The closed loop from w to z with the controller u = K y.
    ///
    /// # Errors
    /// [`Error::Lti`] where K does not fit, or the algebraic loop is singular.
    pub fn close(&self, K: &StateSpace) -> Result<StateSpace, Error> {
        Ok(lft(&self.system, K)?)
    }

    pub(crate) fn blocks(&self) -> Blocks {
        let (system, scale) = balance(&self.system);
        let n = system.order();
        let (w, z) = (system.inputs() - self.controls, system.outputs() - self.measurements);
        let (u, y) = (self.controls, self.measurements);
        Blocks {
            B1: system.B.block(0, 0, n, w),
            B2: system.B.block(0, w, n, u),
            C1: system.C.block(0, 0, z, n),
            C2: system.C.block(z, 0, y, n),
            D11: system.D.block(0, 0, z, w),
            D12: system.D.block(0, w, z, u),
            D21: system.D.block(z, 0, y, w),
            D22: system.D.block(z, w, y, u),
            A: system.A,
            scale,
        }
    }

    /// D12 must have full column rank, D21 full row rank: every control is weighed, every measurement is noisy.
    pub(crate) fn regular(&self) -> Result<Outcome<()>, Error> {
        let blocks = self.blocks();
        let mut findings = Vec::new();
        for (matrix, needed, cause) in [
            (&blocks.D12, self.controls, Cause::ControlUnweighed),
            (&blocks.D21, self.measurements, Cause::MeasurementNoiseless),
        ] {
            if rank(matrix)? < needed {
                findings.push(Finding::refusal(Part::Generalised, cause).at(f64::INFINITY));
            }
        }
        Ok(if findings.is_empty() { Outcome::Solved(()) } else { Outcome::Infeasible(findings) })
    }
}

fn rank(matrix: &Mat) -> Result<usize, Error> {
    if matrix.norm_max() == 0.0 {
        return Ok(0);
    }
    let Svd { s, .. } = svd(matrix)?;
    Ok(s.iter().filter(|value| **value > FULL_RANK * s[0]).count())
}

/// K0 designed for D22 = 0, put around a plant with D22: K0 inv(I + D22 K0).
pub(crate) fn around_direct_path(K: StateSpace, D22: &Mat) -> Result<StateSpace, Error> {
    if D22.norm_max() == 0.0 {
        return Ok(K);
    }
    let direct = StateSpace::gain(D22.clone(), Timebase::Continuous)?;
    let closed = counterpoise_lti::feedback(&K, &direct)?;
    Ok(closed)
}
