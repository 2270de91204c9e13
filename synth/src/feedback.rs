//! The feedback part: an observer of the plant, and the weights' own states, which the controller knows exactly.
//!
//! ```text
//!     w --[ G_w ]---+                         z1 = C_e x_e - D_e y0      (error, weighted; the direct part sees no noise)
//!                   v                         z2 = v                     (control, weighted: u = H_r^-1 v)
//!   v -->[ H_r^-1 ]--u-->[ plant ]-- y0 --o-- y --> controller           z3 = M y_true             (further outputs)
//!                                         ^n
//! ```
//!
//! The states of the error weight (driven by r - y) and of the inverse control weight (driven by v) are computed inside
//! the controller: they carry no estimation error, so an integrating error weight needs no far pole, no epsilon, and the
//! filter's Riccati equation is that of the plant alone.

use counterpoise_linalg::sparse::VectorEntry;
use counterpoise_linalg::{C64, Mat, Riccati, care, eigenvalues};
use counterpoise_lti::{StateSpace, Timebase};

use crate::augmented_plant::AugmentedPlant;
use crate::cause::DesignEquation;
use crate::certificate::{Cost, Equation, mean_square, riccati};
use crate::finding::Part;
use crate::{DesignPlant, Error, FeedbackWeights, LightModes, Reference};

/// The feedback part with its certificates.
#[derive(Debug, Clone, PartialEq)]
pub struct Feedback {
    /// From (demand, measured rate) to (control, weighted control v); the states are \[plant; error weight; inverse
    /// control weight\].
    pub controller: StateSpace,
    /// State feedback v = -F \[x_p; x_e; x_u\].
    pub F: Mat,
    /// Observer gain.
    pub L: Mat,
    /// The regulator's Riccati equation; its spectrum is that of the state feedback.
    pub regulator: Equation,
    /// The filter's Riccati equation; its spectrum is that of the observer.
    pub filter: Equation,
    /// Poles of the design plant with the controller around it.
    pub closed_loop: Vec<C64>,
    /// Mean square of (z1, z2, z3): as the Riccati equations predict it, and as the assembled loop has it.
    pub cost: Cost,
}

/// The augmented problem with the plant's disturbances.
struct Problem {
    core: AugmentedPlant,
    /// Columns of the white disturbances, scaled to unit density.
    Gw: Mat,
}

/// Designs the feedback part, on the plant with stiff modes if the weights say so
///
/// ```text
///     A'X + XA - XBB'X + C'C = 0      on [x_p; x_e; x_u],  F = B'X
///     AY + YA' - YC'V^-1CY + G_w W G_w' = 0      on x_p,   L = Y C' V^-1
///     cost = tr(B_e' X B_e V) + tr(M Y M'),  B_e = [L; -B_e; 0]
/// ```
///
/// # Errors
/// [`Error`] for a plant or weights that do not make a problem. A problem without a solution is
/// [`Error::Refused`].
pub fn design_feedback(
    plant: &DesignPlant,
    weights: &FeedbackWeights,
    reference: Reference,
) -> Result<Feedback, Error> {
    let problem = problem(plant, weights)?;
    let density = weights.measurement_noise;
    let regulator = problem.regulator()?;
    let filter = problem.filter(density)?;
    let (F, L) = (regulator.F.clone(), filter.F.t());
    let controller = problem.controller(&F, &L, reference)?;
    let predicted = problem.predicted_cost(&regulator.X, &filter.X, &L, density);
    let closed = problem.closed_loop(&controller, density)?;
    Ok(Feedback {
        F,
        L,
        closed_loop: eigenvalues(&closed.A)?,
        cost: Cost { predicted: Some(predicted), achieved: mean_square(&closed)? },
        regulator: regulator.into(),
        filter: filter.into(),
        controller,
    })
}

/// The observer's gain L of [`design_feedback`], which the weights on error and control do not change.
///
/// # Errors
/// As [`design_feedback`].
pub(crate) fn observer_gain(plant: &DesignPlant, weights: &FeedbackWeights) -> Result<Mat, Error> {
    Ok(problem(plant, weights)?.filter(weights.measurement_noise)?.F.t())
}

/// The controller of [`design_feedback`] from (demand, measured rate) to (control, weighted control) with a given observer's gain, and without
/// the certificates.
///
/// # Errors
/// As [`design_feedback`].
pub(crate) fn controller_with_observer(
    plant: &DesignPlant,
    weights: &FeedbackWeights,
    L: &Mat,
) -> Result<StateSpace, Error> {
    let problem = problem(plant, weights)?;
    problem.controller(&problem.regulator()?.F, L, Reference::Error)
}

fn problem(plant: &DesignPlant, weights: &FeedbackWeights) -> Result<Problem, Error> {
    if weights.modes == LightModes::Stiffened {
        let kept = FeedbackWeights { modes: LightModes::Kept, ..weights.clone() };
        return problem(&plant.with_stiff_modes()?, &kept);
    }
    let system = plant.measured_plant()?;
    let (n, inputs, outputs) = (system.order(), system.inputs(), system.outputs());
    if system.D[(0, plant.control)] != 0.0 {
        return Err(Error::System {
            what: "plant",
            problem: "the control reaches the rate directly (D is not zero)",
        });
    }
    let column = |index: usize| system.B.block(0, index, n, 1);
    let mut Gw = column(plant.control).scale(weights.loop_recovery.sqrt());
    for &VectorEntry { index, value: density } in &weights.disturbances {
        if index >= inputs {
            return Err(Error::Index { what: "disturbance input", index, count: inputs });
        }
        Gw = Gw.hstack(&column(index).scale(density.sqrt()));
    }
    let row = weights.combination_row(outputs - 1);
    let core = AugmentedPlant {
        B: column(plant.control),
        C: system.C.block(0, 0, 1, n),
        further: &row * &system.C.block(1, 0, outputs - 1, n),
        A: system.A,
        error: weights.error.realise()?,
        control: weights.control.realise_inverse()?,
    };
    Ok(Problem { core, Gw })
}

impl Problem {
    fn regulator(&self) -> Result<Riccati, Error> {
        let (A, B, C) = (self.core.state(), self.core.input(), self.core.output());
        let solution = care(&A, &B, &(&C.t() * &C), &Mat::eye(1), None)?;
        riccati(DesignEquation::Regulator, Part::Feedback, solution)
    }

    fn filter(&self, density: f64) -> Result<Riccati, Error> {
        let (V, W) = (Mat::eye(1).scale(density), &self.Gw * &self.Gw.t());
        let solution = care(&self.core.A.t(), &self.core.C.t(), &W, &V, None)?;
        riccati(DesignEquation::Filter, Part::Feedback, solution)
    }

    /// x_p' = A x_p + B u + L (y - C x_p), x_e' = A_e x_e + B_e (r - y), x_u' = A_u x_u + B_u v, u = C_u x_u + D_u v.
    fn controller(&self, F: &Mat, L: &Mat, reference: Reference) -> Result<StateSpace, Error> {
        let (n, e, u) = self.core.sizes();
        let mut A = self.core.state();
        A.set_block(0, 0, &(&self.core.A - &(L * &self.core.C)));
        A.set_block(n, 0, &Mat::zeros(e, n));
        A -= &(&self.core.input() * F);
        let into_observer = match reference {
            Reference::Error => -L,
            Reference::WeightOnly => Mat::zeros(n, 1),
        };
        let E = &self.core.error.B;
        let B = Mat::from_blocks(&[&[&into_observer, L], &[E, &-E], &[&Mat::zeros(u, 1), &Mat::zeros(u, 1)]]);
        let v = -F;
        let C = self.core.control_row(&v).vstack(&v);
        Ok(StateSpace::new(A, B, C, Mat::zeros(2, 2), Timebase::Continuous)?)
    }

    /// tr(B_e' X B_e V) + tr(M Y M') with M the direct part of the weighted outputs on the plant's state.
    fn predicted_cost(&self, X: &Mat, Y: &Mat, L: &Mat, V: f64) -> f64 {
        let (n, _, u) = self.core.sizes();
        let innovation = L.vstack(&-&self.core.error.B).vstack(&Mat::zeros(u, 1));
        let M = self.core.output().block(0, 0, 1 + self.core.further.nrows(), n);
        V * (&innovation.t() * &(X * &innovation)).trace() + (&M * &(Y * &M.t())).trace()
    }

    /// The design plant with the controller around it, from unit white noise to (z1, z3, z2).
    fn closed_loop(&self, K: &StateSpace, V: f64) -> Result<StateSpace, Error> {
        let core = &self.core;
        let ((n, _, _), k, m) = (core.sizes(), core.order(), self.Gw.ncols());
        let into = K.B.block(0, 1, k, 1);
        let (control, v) = (K.C.block(0, 0, 1, k), K.C.block(1, 0, 1, k));
        let A = Mat::from_blocks(&[&[&core.A, &(&core.B * &control)], &[&(&into * &core.C), &K.A]]);
        let B =
            Mat::from_blocks(&[&[&self.Gw, &Mat::zeros(n, 1)], &[&Mat::zeros(k, m), &into.scale(V.sqrt())]]);
        let output = core.output();
        let (plant, own) = (output.block(0, 0, output.nrows(), n), output.block(0, n, output.nrows(), k - n));
        let own = Mat::zeros(output.nrows(), n).hstack(&own);
        let C = Mat::from_blocks(&[&[&plant, &own], &[&Mat::zeros(1, n), &v]]);
        let D = Mat::zeros(C.nrows(), m + 1);
        Ok(StateSpace::new(A, B, C, D, Timebase::Continuous)?)
    }
}
