//! A feedforward part: the answer to a measured disturbance of known spectrum.
//!
//! ```text
//!     w -->[ A_d, B_d ]-- x_d --> d = C_d x_d --+--[ E ]--> plant, whose error e = - C x_p is weighted by H_q
//!                                               |
//!                                               +--[ sensor ]--o--> measured --> module --> u_i = H_r^-1 v
//!                                                              ^n
//! ```
//!
//! The module holds a copy of plant and weights, all stable: a feedforward cannot make a stable loop unstable. It is
//! linear in the columns E: a disturbance that grows with the out-of-balance scales the module's output, nothing else.

mod measured_disturbance;

use counterpoise_linalg::{Mat, Riccati, care, inverse, lyap, sylvester};
use counterpoise_lti::{StateSpace, Timebase};

use crate::augmented_plant::AugmentedPlant;
use crate::cause::DesignEquation;
use crate::certificate::{Cost, Equation, mean_square, riccati};
use crate::finding::Part;
use crate::{DesignPlant, DisturbanceChannel, DisturbanceKnowledge, Error, FeedforwardWeights};

/// A feedforward part with its certificates.
#[derive(Debug, Clone, PartialEq)]
pub struct Feedforward {
    /// From the measured disturbance (with exact knowledge: the disturbance and its derivatives) to (control, rate that
    /// the module expects, weighted control v).
    pub module: StateSpace,
    /// State feedback on \[x_p; x_e; x_u\].
    pub F: Mat,
    /// Feedforward gain on x_d.
    pub Fd: Mat,
    /// The regulator's Riccati equation.
    pub regulator: Equation,
    /// The Riccati equation of the disturbance's filter; none with exact knowledge.
    pub filter: Option<Equation>,
    /// Residual of the Sylvester equation, relative to its terms.
    pub sylvester_residual: f64,
    /// Mean square of the weighted error and control.
    pub cost: Cost,
    /// Steady volts for a steady unit of the disturbance.
    pub dc_gain: f64,
}

/// The problem of one channel.
struct Problem {
    core: AugmentedPlant,
    /// The disturbance's columns, on \[x_p; x_e; x_u\], times C_d: from x_d.
    ECd: Mat,
    generator: StateSpace,
    sensor: Option<StateSpace>,
}

/// The full-information solution: X of the Riccati, X_d of the Sylvester equation.
struct Regulator {
    riccati: Riccati,
    X_d: Mat,
    Fd: Mat,
    residual: f64,
}

/// Designs the feedforward of a channel
///
/// ```text
///     A'X + XA - XBB'X + C'C = 0,   F = B'X                   on [x_p; x_e; x_u]
///     (A - BF)' X_d + X_d A_d + X E C_d = 0,   F_d = B'X_d     v = -F x - F_d x_d
/// ```
///
/// with x, x_d simulated from the exact disturbance, or estimated by the Kalman filter of generator, sensor and plant
/// from the sensor's signal. Solvable whenever the generator is stable.
///
/// # Errors
/// [`Error`] for a plant or weights that do not make a problem (see [`crate::preflight()`]); a problem without a
/// solution is [`Error::Refused`].
pub fn design_feedforward(
    plant: &DesignPlant,
    weights: &FeedforwardWeights,
    channel: DisturbanceChannel,
) -> Result<Feedforward, Error> {
    let problem = problem(plant, weights, channel)?;
    let regulator = problem.regulator(channel.into())?;
    let DisturbanceKnowledge::Measured { noise } = weights.knowledge else {
        let knows = exact_knowledge(&problem.generator)?;
        let module = problem.exact_module(&regulator, &knows)?;
        let cost = Cost {
            predicted: Some(problem.exact_cost(&regulator)?),
            achieved: mean_square(&problem.exact_loop(&module, &knows)?)?,
        };
        return finish(regulator, module, None, cost);
    };
    let filter = problem.filter(noise, channel.into())?;
    let module = problem.measured_module(&regulator, &filter)?;
    let cost = Cost {
        predicted: problem.measured_cost(&regulator, &filter)?,
        achieved: mean_square(&problem.measured_loop(&module, &filter)?)?,
    };
    finish(regulator, module, Some(filter.equation), cost)
}

fn finish(
    solution: Regulator,
    module: StateSpace,
    filter: Option<Equation>,
    cost: Cost,
) -> Result<Feedforward, Error> {
    let dc_gain = counterpoise_lti::dcgain(&module)?[(0, 0)];
    Ok(Feedforward {
        module,
        F: solution.riccati.F.clone(),
        Fd: solution.Fd,
        regulator: solution.riccati.into(),
        filter,
        sylvester_residual: solution.residual,
        cost,
        dc_gain,
    })
}

fn problem(
    plant: &DesignPlant,
    weights: &FeedforwardWeights,
    channel: DisturbanceChannel,
) -> Result<Problem, Error> {
    let system = plant.delayed_plant()?;
    let weighed = weights.output.unwrap_or(plant.rate);
    if weighed >= system.outputs() {
        return Err(Error::Index { what: "weighed output", index: weighed, count: system.outputs() });
    }
    let columns = plant.columns(channel);
    if system.D[(weighed, plant.control)] != 0.0 {
        return Err(Error::System {
            what: "plant",
            problem: "the control reaches the rate directly (D is not zero)",
        });
    }
    let generator = weights.generator.realise()?;
    let system = without_direct_path(&system, weighed, columns, &generator)?;
    let n = system.order();
    let generator = with_derivatives(&generator, columns.len())?;
    let core = AugmentedPlant {
        B: system.B.block(0, plant.control, n, 1),
        C: system.C.block(weighed, 0, 1, n),
        further: Mat::zeros(0, n),
        error: weights.error.realise()?,
        control: weights.control.realise_inverse()?,
        A: system.A.clone(),
    };
    let states: Vec<usize> = (0..n).collect();
    let into_plant = &system.B.select(&states, columns) * &generator.C;
    let ECd = into_plant.vstack(&Mat::zeros(core.order() - n, generator.order()));
    Ok(Problem { core, ECd, generator, sensor: plant.sensor(channel).cloned() })
}

/// The plant whose disturbances reach an output through a lag that is [`DIRECT_LAG`] of the generator's quickest time constant, where they reach it directly: through a rotor on
/// a rigid transmission, which the platform drags along.
fn without_direct_path(
    system: &StateSpace,
    output: usize,
    columns: &[usize],
    generator: &StateSpace,
) -> Result<StateSpace, Error> {
    let direct: Vec<usize> =
        columns.iter().copied().filter(|&input| system.D[(output, input)] != 0.0).collect();
    let quickest = counterpoise_lti::poles(generator)?.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    if direct.is_empty() || quickest == 0.0 {
        return Ok(system.clone());
    }
    let (n, m, lag_rad_s) = (system.order(), direct.len(), quickest / DIRECT_LAG);
    let A = Mat::from_fn(n + m, n + m, |i, j| match (i < n, j < n) {
        (true, true) => system.A[(i, j)],
        (false, false) if i == j => -lag_rad_s,
        _ => 0.0,
    });
    let B = Mat::from_fn(n + m, system.inputs(), |i, j| match i.checked_sub(n) {
        None => system.B[(i, j)],
        Some(k) if direct[k] == j => lag_rad_s,
        Some(_) => 0.0,
    });
    let C = Mat::from_fn(system.outputs(), n + m, |i, j| match j.checked_sub(n) {
        None => system.C[(i, j)],
        Some(k) if i == output => system.D[(output, direct[k])],
        Some(_) => 0.0,
    });
    let D = Mat::from_fn(system.outputs(), system.inputs(), |i, j| {
        if i == output && direct.contains(&j) { 0.0 } else { system.D[(i, j)] }
    });
    Ok(StateSpace::new(A, B, C, D, system.timebase)?)
}

/// Time constant of the lag in a direct path over the quickest of the generator: its phase is a thousandth of a radian where the disturbance has its corner.
const DIRECT_LAG: f64 = 1e-3;

/// The generator with outputs (d, d', d'', ...), `count` of them.
pub(crate) fn with_derivatives(generator: &StateSpace, count: usize) -> Result<StateSpace, Error> {
    let mut rows = generator.C.clone();
    let mut row = generator.C.clone();
    let mut direct = generator.D.norm_max();
    for _ in 1..count.max(1) {
        direct = direct.max((&row * &generator.B).norm_max());
        row = &row * &generator.A;
        rows = rows.vstack(&row);
    }
    if count == 0 || direct > f64::EPSILON * generator.C.norm_fro() * generator.B.norm_fro() {
        let problem =
            "it must have more poles than zeros by the number of inputs it acts on, and act on at least one";
        return Err(Error::System { what: "generator", problem });
    }
    let (A, B) = (generator.A.clone(), generator.B.clone());
    let D = Mat::zeros(count, B.ncols());
    Ok(StateSpace::new(A, B, rows, D, Timebase::Continuous)?)
}

/// inv(C_d): the generator's states from the disturbance and its derivatives.
fn exact_knowledge(generator: &StateSpace) -> Result<Mat, Error> {
    if generator.outputs() != generator.order() {
        let problem = "exact knowledge needs as many signals as it has states";
        return Err(Error::System { what: "generator", problem });
    }
    Ok(inverse(&generator.C)?)
}

impl Problem {
    fn regulator(&self, part: Part) -> Result<Regulator, Error> {
        let (A, B, C) = (self.core.state(), self.core.input(), self.core.output());
        let solved = care(&A, &B, &(&C.t() * &C), &Mat::eye(1), None)?;
        let riccati = riccati(DesignEquation::Regulator, part, solved)?;
        let closed = (&A - &(&B * &riccati.F)).t();
        let driven = &riccati.X * &self.ECd;
        let X_d = sylvester(&closed, &self.generator.A, &-&driven)?;
        let terms = [&closed * &X_d, &X_d * &self.generator.A, driven];
        let size: f64 = terms.iter().map(Mat::norm_fro).sum();
        let residual = (&(&terms[0] + &terms[1]) + &terms[2]).norm_fro() / size.max(f64::MIN_POSITIVE);
        let Fd = &B.t() * &X_d;
        Ok(Regulator { riccati, X_d, Fd, residual })
    }

    /// tr(B_d' X_dd B_d) with A_d'X_dd + X_dd A_d + C_d'E'X_d + X_d'E C_d - F_d'F_d = 0.
    fn exact_cost(&self, regulator: &Regulator) -> Result<f64, Error> {
        let B = &self.generator.B;
        let cross = &self.ECd.t() * &regulator.X_d;
        let Q = &(&cross + &cross.t()) - &(&regulator.Fd.t() * &regulator.Fd);
        let X_dd = lyap(&self.generator.A.t(), &Q)?;
        Ok((&B.t() * &(&X_dd * B)).trace())
    }

    /// x' = (A - BF) x + (E C_d - B F_d) inv(C_d) d.
    fn exact_module(&self, regulator: &Regulator, knows: &Mat) -> Result<StateSpace, Error> {
        let input = self.core.input();
        let A = &self.core.state() - &(&input * &regulator.riccati.F);
        let B = &(&self.ECd - &(&input * &regulator.Fd)) * knows;
        let (v, v_d) = (-&regulator.riccati.F, -(&regulator.Fd * knows));
        let C = self.core.control_row(&v).vstack(&self.expected_rate_row(0)).vstack(&v);
        let D = (&self.core.control.D * &v_d).vstack(&Mat::zeros(1, v_d.ncols())).vstack(&v_d);
        Ok(StateSpace::new(A, B, C, D, Timebase::Continuous)?)
    }

    /// The row of the expected rate C x_p, with `more` states after those of the plant and its weights.
    fn expected_rate_row(&self, more: usize) -> Mat {
        let (n, e, u) = self.core.sizes();
        debug_assert_eq!(self.core.C.ncols(), n);
        self.core.C.hstack(&Mat::zeros(1, e + u + more))
    }

    /// The plant and its error weight without control, and the columns of x_d into them.
    fn uncontrolled_plant(&self) -> (Mat, Mat) {
        let (n, e, _) = self.core.sizes();
        let entering = self.ECd.block(0, 0, n + e, self.generator.order());
        (self.core.state().block(0, 0, n + e, n + e), entering)
    }

    /// Generator (and sensor), plant with its error weight, and module, from unit white noise to (z1, z2).
    ///
    /// `into` is the module's input matrix times what it reads of the generator's states; `noise` are the columns of
    /// white noise on \[generator; plant; module\].
    fn assembled_loop(
        &self,
        module: &StateSpace,
        source: &StateSpace,
        into: &Mat,
        noise: &Mat,
    ) -> Result<StateSpace, Error> {
        let (n, e, _) = self.core.sizes();
        let (g, k) = (source.order(), module.order());
        let (open, entering) = self.uncontrolled_plant();
        let entering = entering.hstack(&Mat::zeros(n + e, g - self.generator.order()));
        let column = self.core.B.vstack(&Mat::zeros(e, 1));
        let (u, v) = (module.C.block(0, 0, 1, k), module.C.block(2, 0, 1, k));
        let direct = |row: usize| match module.D.norm_max() == 0.0 {
            true => Mat::zeros(1, g),
            false => &module.D.block(row, 0, 1, module.inputs()) * &self.generator_outputs(g),
        };
        let A = Mat::from_blocks(&[
            &[&source.A, &Mat::zeros(g, n + e), &Mat::zeros(g, k)],
            &[&(&entering + &(&column * &direct(0))), &open, &(&column * &u)],
            &[into, &Mat::zeros(k, n + e), &module.A],
        ]);
        let error = self.core.output().block(0, 0, 1, n + e);
        let C = Mat::from_blocks(&[
            &[&Mat::zeros(1, g), &error, &Mat::zeros(1, k)],
            &[&direct(2), &Mat::zeros(1, n + e), &v],
        ]);
        let D = Mat::zeros(2, noise.ncols());
        Ok(StateSpace::new(A, noise.clone(), C, D, Timebase::Continuous)?)
    }

    /// (d, d', ...) from the source's states, of which there are `states`.
    fn generator_outputs(&self, states: usize) -> Mat {
        let C = &self.generator.C;
        C.hstack(&Mat::zeros(C.nrows(), states - self.generator.order()))
    }

    fn exact_loop(&self, module: &StateSpace, knows: &Mat) -> Result<StateSpace, Error> {
        debug_assert_eq!(knows.nrows(), self.generator.order());
        let (n, e, _) = self.core.sizes();
        let noise = self.generator.B.vstack(&Mat::zeros(n + e + module.order(), 1));
        self.assembled_loop(module, &self.generator, &(&module.B * &self.generator.C), &noise)
    }
}
