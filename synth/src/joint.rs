//! The joint optimum: feedback and both feedforwards as one H2 problem, with the expected motion and every sensor.
//!
//! ```text
//!     xi = [x_p; x_f]        plant with its delay and hub sensor, then generator and sensor of each measured motion
//!     xi' = A xi + B u + G w,    y = C xi + n        y = (rate, heave, pitch) as the sensors read them
//!     z = (H_q e, v, combination),   u = H_r^-1 v     the feedback's weights, on every disturbance at once
//! ```
//!
//! The states of the weights are computed inside the controller and known exactly, as in [`crate::design_feedback()`]: an
//! integrating error weight needs no far pole, an improper control weight no approximation. The regulator's equation is
//! that of the feedback; the disturbances' share follows from a Sylvester equation; one filter estimates plant and
//! disturbances from all sensors together, so each of them informs every part.

use counterpoise_linalg::sparse::VectorEntry;
use counterpoise_linalg::{C64, Mat, care, eigenvalues, sylvester};
use counterpoise_lti::{StateSpace, Timebase};

use crate::augmented_plant::AugmentedPlant;
use crate::cause::DesignEquation;
use crate::certificate::{Cost, Equation, mean_square, riccati};
use crate::feedforward::with_derivatives;
use crate::finding::Part;
use crate::tolerance::GAIN_STEP;
use crate::{DesignPlant, DisturbanceChannel, DisturbanceKnowledge, Error, Specification};

/// A joint controller with its certificates.
#[derive(Debug, Clone, PartialEq)]
pub struct JointOptimum {
    /// From (demand, measured rate, measured heave, measured pitch) to (control, weighted control v); a motion that the
    /// specification has no feedforward for is left out.
    pub controller: StateSpace,
    /// The motions that are measured, in the order of the controller's inputs.
    pub channels: Vec<DisturbanceChannel>,
    /// The regulator's Riccati equation.
    pub regulator: Equation,
    /// The filter's.
    pub filter: Equation,
    /// Residual of the Sylvester equation of the disturbances' share, relative to its terms.
    pub sylvester_residual: f64,
    /// Mean square of the weighted signals: as the equations predict it, and as the assembled loop has it.
    pub cost: Cost,
    /// Relative change of that cost for a relative change of the gain from each measured signal into
    /// the estimates (rate first): 0 at the
    /// optimum.
    pub slopes: Vec<f64>,
    /// Poles of the plant with the controller around it.
    pub closed_loop: Vec<C64>,
}

/// The problem, all disturbances in.
struct Problem {
    core: AugmentedPlant,
    /// \[plant; motions\].
    A: Mat,
    /// Control on them.
    B: Mat,
    /// Readings of them, rate first.
    C: Mat,
    /// White noise on them, scaled to unit density.
    G: Mat,
    /// Densities of the readings' noises.
    noises: Vec<f64>,
    channels: Vec<DisturbanceChannel>,
}

/// Designs the joint optimum under the feedback's weights and the generators and noises of the feedforwards.
///
/// # Errors
/// [`Error`] for a plant or weights that do not make a problem, [`Error::System`] for exact knowledge of a motion, which no
/// sensor has. A problem without a solution is [`Error::Refused`].
pub fn joint_optimum(plant: &DesignPlant, specification: &Specification) -> Result<JointOptimum, Error> {
    let problem = Problem::new(plant, specification)?;
    let (n, f) = (problem.core.A.nrows(), problem.motions());
    let (A, B, C) = (problem.core.state(), problem.core.input(), problem.core.output());
    let solved = care(&A, &B, &(&C.t() * &C), &Mat::eye(1), None)?;
    let regulator = riccati(DesignEquation::Regulator, Part::Feedback, solved)?;
    let entering = problem.entering_columns();
    let settled = (&A - &(&B * &regulator.F)).t();
    let of_motions = problem.A.block(n, n, f, f);
    let driven = &regulator.X * &entering;
    let (X_f, sylvester_residual) = share_of_motions(&settled, &of_motions, &driven)?;
    let V = Mat::diag(&problem.noises);
    let W = &problem.G * &problem.G.t();
    let solved = care(&problem.A.t(), &problem.C.t(), &W, &V, None)?;
    let filter = riccati(DesignEquation::JointFilter, Part::Feedback, solved)?;
    let (F, L) = (regulator.F.hstack(&(&B.t() * &X_f)), filter.F.t());
    let controller = problem.controller(&F, &L)?;
    let closed = problem.closed_loop(&controller, &vec![1.0; problem.noises.len()])?;
    let cost =
        Cost { predicted: problem.predicted_cost(&F, &L, &filter.X)?, achieved: mean_square(&closed)? };
    Ok(JointOptimum {
        slopes: problem.slopes(&controller)?,
        closed_loop: eigenvalues(&closed.A)?,
        channels: problem.channels.clone(),
        regulator: regulator.into(),
        filter: filter.into(),
        sylvester_residual,
        cost,
        controller,
    })
}

/// X_f of settled X_f + X_f A_f + driven = 0 with its relative residual; of no states if there is no motion.
fn share_of_motions(settled: &Mat, A_f: &Mat, driven: &Mat) -> Result<(Mat, f64), Error> {
    if A_f.nrows() == 0 {
        return Ok((Mat::zeros(settled.nrows(), 0), 0.0));
    }
    let X_f = sylvester(settled, A_f, &-driven)?;
    let terms = [settled * &X_f, &X_f * A_f, driven.clone()];
    let size: f64 = terms.iter().map(Mat::norm_fro).sum();
    let residual = (&(&terms[0] + &terms[1]) + &terms[2]).norm_fro() / size.max(f64::MIN_POSITIVE);
    Ok((X_f, residual))
}

impl Problem {
    fn new(plant: &DesignPlant, specification: &Specification) -> Result<Self, Error> {
        let weights = &specification.feedback;
        let system = plant.measured_plant()?;
        let (n, outputs) = (system.order(), system.outputs());
        let column = |index: usize| system.B.block(0, index, n, 1);
        let mut G = column(plant.control).scale(weights.loop_recovery.sqrt());
        for &VectorEntry { index, value: density } in &weights.disturbances {
            G = G.hstack(&column(index).scale(density.sqrt()));
        }
        let further = &weights.combination_row(outputs - 1) * &system.C.block(1, 0, outputs - 1, n);
        let core = AugmentedPlant {
            A: system.A.clone(),
            B: column(plant.control),
            C: system.C.block(0, 0, 1, n),
            further,
            error: weights.error.realise()?,
            control: weights.control.realise_inverse()?,
        };
        let (A, B, C) = (core.A.clone(), core.B.clone(), core.C.clone());
        let noises = vec![weights.measurement_noise];
        let mut problem = Self { core, A, B, C, G, noises, channels: Vec::new() };
        for channel in [DisturbanceChannel::Heave, DisturbanceChannel::Pitch] {
            problem.add_motion(plant, specification, channel, &system)?;
        }
        Ok(problem)
    }

    /// Puts the generator and the sensor of a motion behind the states.
    fn add_motion(
        &mut self,
        plant: &DesignPlant,
        specification: &Specification,
        channel: DisturbanceChannel,
        system: &StateSpace,
    ) -> Result<(), Error> {
        let Some(weights) = specification.feedforward(channel) else { return Ok(()) };
        let DisturbanceKnowledge::Measured { noise } = weights.knowledge else {
            let problem = "it takes motions as sensors read them, not as exactly known";
            return Err(Error::System { what: "joint optimum", problem });
        };
        let columns = plant.columns(channel);
        let generator = with_derivatives(&weights.generator.realise()?, columns.len())?;
        let first = generator.select(&[0], &[0]);
        let source = match plant.sensor(channel) {
            Some(sensor) => counterpoise_lti::series(&first, sensor)?,
            None => first,
        };
        let (n, k, f, d) = (system.order(), self.A.nrows(), source.order(), generator.order());
        let states: Vec<usize> = (0..n).collect();
        let into = &system.B.select(&states, columns) * &generator.C;
        let mut A = self.A.block_diag(&source.A);
        A.set_block(0, k, &into);
        debug_assert!(d <= f);
        self.A = A;
        self.B = self.B.vstack(&Mat::zeros(f, 1));
        self.C = self.C.block_diag(&source.C);
        self.G = self.G.block_diag(&source.B);
        self.noises.push(noise);
        self.channels.push(channel);
        Ok(())
    }

    /// States of the motions.
    fn motions(&self) -> usize {
        self.A.nrows() - self.core.A.nrows()
    }

    /// Columns of the motions' states into \[x_p; x_e; x_u\].
    fn entering_columns(&self) -> Mat {
        let (n, e, u) = self.core.sizes();
        self.A.block(0, n, n, self.motions()).vstack(&Mat::zeros(e + u, self.motions()))
    }

    /// \[x_p; x_f; x_e; x_u\] from \[x_p; x_e; x_u; x_f\]: the order in which the controller holds its states.
    fn reorder_row(&self, row: &Mat) -> Mat {
        let ((n, e, u), f, rows) = (self.core.sizes(), self.motions(), row.nrows());
        let plant = row.block(0, 0, rows, n);
        plant.hstack(&row.block(0, n + e + u, rows, f)).hstack(&row.block(0, n, rows, e + u))
    }

    /// xi' = A xi + B u + L (y - C xi), x_e' = A_e x_e + B_e (r - y), x_u' = A_u x_u + B_u v, u = C_u x_u + D_u v; states
    /// \[xi; x_e; x_u\].
    fn controller(&self, F: &Mat, L: &Mat) -> Result<StateSpace, Error> {
        let ((_, e, u), k, m) = (self.core.sizes(), self.A.nrows(), self.noises.len());
        let (E, U) = (&self.core.error, &self.core.control);
        let v = -&self.reorder_row(F);
        let held = Mat::zeros(1, k + e).hstack(&U.C);
        let control = &held + &(&U.D * &v);
        let observer = &self.A - &(L * &self.C);
        let open = Mat::from_blocks(&[
            &[&observer, &Mat::zeros(k, e + u)],
            &[&Mat::zeros(e, k), &E.A.hstack(&Mat::zeros(e, u))],
            &[&Mat::zeros(u, k), &Mat::zeros(u, e).hstack(&U.A)],
        ]);
        let acting = self.B.vstack(&Mat::zeros(e + u, 1));
        let weighed = Mat::zeros(k + e, 1).vstack(&U.B);
        let A = &(&open + &(&acting * &control)) + &(&weighed * &v);
        let demand = (-&L.block(0, 0, k, 1)).vstack(&E.B).vstack(&Mat::zeros(u, 1));
        let rate = L.block(0, 0, k, 1).vstack(&-&E.B).vstack(&Mat::zeros(u, 1));
        let others = L.block(0, 1, k, m - 1).vstack(&Mat::zeros(e + u, m - 1));
        let B = demand.hstack(&rate).hstack(&others);
        let C = control.vstack(&v);
        Ok(StateSpace::new(A, B, C, Mat::zeros(2, m + 1), Timebase::Continuous)?)
    }

    /// Rows of (error, combination) on \[xi; controller\]; the error weight's states are the controller's.
    fn weighted_rows(&self) -> Mat {
        let ((n, e, u), k, f) = (self.core.sizes(), self.A.nrows(), self.motions());
        let output = self.core.output();
        let rows = output.nrows();
        let plant = output.block(0, 0, rows, n).hstack(&Mat::zeros(rows, f));
        plant.hstack(&Mat::zeros(rows, k)).hstack(&output.block(0, n, rows, e + u))
    }

    /// The plant and its motions with the controller around them, the gain from each reading into the estimates times `gains` (the
    /// error weight, which is the cost's own, keeps its input), from unit white
    /// noise to (error, combination, v).
    fn closed_loop(&self, K: &StateSpace, gains: &[f64]) -> Result<StateSpace, Error> {
        let (k, q, m, w) = (self.A.nrows(), K.order(), self.noises.len(), self.G.ncols());
        let mut into = K.B.block(0, 1, q, m);
        for (j, gain) in gains.iter().enumerate() {
            (0..k).for_each(|i| into[(i, j)] *= gain);
        }
        let (control, v) = (K.C.block(0, 0, 1, q), K.C.block(1, 0, 1, q));
        let A = Mat::from_blocks(&[&[&self.A, &(&self.B * &control)], &[&(&into * &self.C), &K.A]]);
        let roots: Vec<f64> = self.noises.iter().map(|density| density.sqrt()).collect();
        let noise = &into * &Mat::diag(&roots);
        let B = Mat::from_blocks(&[&[&self.G, &Mat::zeros(k, m)], &[&Mat::zeros(q, w), &noise]]);
        let C = self.weighted_rows().vstack(&Mat::zeros(1, k).hstack(&v));
        let D = Mat::zeros(C.nrows(), w + m);
        Ok(StateSpace::new(A, B, C, D, Timebase::Continuous)?)
    }

    /// Returns what is known, driven by the innovation, and what is not known after all readings: tr(M Y M').
    fn predicted_cost(&self, F: &Mat, L: &Mat, Y: &Mat) -> Result<Option<f64>, Error> {
        let ((n, e, u), f) = (self.core.sizes(), self.motions());
        let roots: Vec<f64> = self.noises.iter().map(|density| density.sqrt()).collect();
        let innovation = L * &Mat::diag(&roots);
        let (k, m) = (n + e + u, roots.len());
        let mut of_error = Mat::zeros(e, m);
        of_error.set_block(0, 0, &(-&self.core.error.B).scale(roots[0]));
        let into = innovation
            .block(0, 0, n, m)
            .vstack(&of_error)
            .vstack(&Mat::zeros(u, m))
            .vstack(&innovation.block(n, 0, f, m));
        let open = Mat::from_blocks(&[
            &[&self.core.state(), &self.entering_columns()],
            &[&Mat::zeros(f, k), &self.A.block(n, n, f, f)],
        ]);
        let A = &open - &(&self.core.input().vstack(&Mat::zeros(f, 1)) * F);
        let output = self.core.output();
        let C = output.hstack(&Mat::zeros(output.nrows(), f)).vstack(&-F);
        let D = Mat::zeros(C.nrows(), m);
        let known = mean_square(&StateSpace::new(A, into, C, D, Timebase::Continuous)?)?;
        let M = output.block(0, 0, output.nrows(), n);
        let unknown = (&M * &(&Y.block(0, 0, n, n) * &M.t())).trace();
        Ok(known.map(|known| known + unknown))
    }

    /// Slopes of the logarithm of the cost in the gain from each reading, by central differences.
    fn slopes(&self, K: &StateSpace) -> Result<Vec<f64>, Error> {
        let mut slopes = Vec::new();
        for j in 0..self.noises.len() {
            let at = |gain: f64| -> Result<Option<f64>, Error> {
                let mut gains = vec![1.0; self.noises.len()];
                gains[j] = gain;
                mean_square(&self.closed_loop(K, &gains)?)
            };
            let slope = match (at(1.0 + GAIN_STEP)?, at(1.0 - GAIN_STEP)?) {
                (Some(above), Some(below)) => (above / below).ln() / (2.0 * GAIN_STEP),
                _ => f64::INFINITY,
            };
            slopes.push(slope);
        }
        Ok(slopes)
    }
}
