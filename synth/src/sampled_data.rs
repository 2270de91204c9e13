//! The three-part design in sampled time: what [`crate::feedback()`] and [`crate::feedforward()`] do for signals that flow,
//! done for a control that is held over each period and readings that are taken once in it.
//!
//! The plant, its sensors and its disturbances stay continuous: their cost is that of the whole period, between the
//! samples too (Van Loan). The delay is that of the loop as it runs, in whole samples, exactly. The weights are asked of
//! the samples: a control weight and the states of an error weight are filters inside the controller, which cost by their
//! modulus; the bilinear map keeps that modulus. The direct part of an error weight, constant weights on further outputs
//! and the whole error weight of a feedforward act on the continuous motion.
//!
//! A reading carries the noise of the continuous design averaged over the period: density over period.

use counterpoise_lti::linalg::dsylvester;
use counterpoise_lti::{
    Cost as Quadratic, Discretisation, Mat, Noise, StateSpace, Timebase, c2d, delay_samples, sampled_problem,
};

use crate::certificate::{Cost, Equation};
use crate::feedforward::with_derivatives;
use crate::finding::Part;
use crate::stage::{Estimate, Extension, SampledNoise, Stage, after_reading, filter};
use crate::{
    Assembly, Basis, Channel, Design, DesignPlant, Error, FeedbackWeights, FeedforwardWeights, Knowledge,
    Outcome, Reference, Sampling,
};

/// The certificates of one part that was designed in sampled time.
#[derive(Debug, Clone, PartialEq)]
pub struct Certified {
    /// Which part.
    pub part: Part,
    /// Mean square of its weighted signals: as the equations predict it, and as the assembled sampled loop has it.
    pub cost: Cost,
    /// The regulator's discrete Riccati equation.
    pub regulator: Equation,
    /// The filter's; none with exact knowledge.
    pub filter: Option<Equation>,
}

/// A part of the controller in sampled time.
pub(crate) struct Drafted {
    /// Feedback: from (demand, rate) to the control. Feedforward: from the measured disturbance to (control, hub rate that
    /// is expected of the sensor).
    pub system: StateSpace,
    /// Its certificates.
    pub certified: Certified,
}

/// The feedback designed on the sampled problem
///
/// ```text
///     x_p+ = A x_p + B u + w,  y = x_p C + n             plant and sensor, exact under the hold; u late by whole samples
///     x_e+ = A_e x_e + B_e (r - y),  s = C_e x_e + D_e (r - y)     error weight by the bilinear map, in the controller
///     u = H_r^-1 v                                                  control weight by the bilinear map
///     cost = mean of |s - d_e C x_p(t)|^2 + |M x_p(t)|^2 + |v|^2    over time, between the samples too
/// ```
///
/// Regulator and filter are discrete Riccati equations; the control uses the reading of its own instant.
///
/// # Errors
/// As [`crate::feedback()`]; a problem without solution is [`Outcome::Infeasible`].
pub(crate) fn feedback(design: &Design, sampling: &Sampling) -> Result<Outcome<Drafted>, Error> {
    let weights = &design.specification.feedback;
    let held = Held::feedback(&design.plant, weights, sampling)?;
    let full = held.full();
    let regulator = match full.regulator(Part::Feedback)? {
        Outcome::Solved(solution) => solution,
        Outcome::Infeasible(findings) => return Ok(Outcome::Infeasible(findings)),
    };
    let filter = match filter(&held.plant.A, &held.noise, Part::Feedback)? {
        Outcome::Solved(solution) => solution,
        Outcome::Infeasible(findings) => return Ok(Outcome::Infeasible(findings)),
    };
    let (unknown, gain, innovation) = after_reading(&filter.X, &held.noise.reading, held.noise.measurement);
    let controller = held.controller(&regulator.F, &gain, design.specification.reference)?;
    let from_reading = held.as_driven(&controller);
    let rest = full.order() - held.plant.order();
    let mut into = gain.vstack(&Mat::zeros(rest, 1));
    if held.weighs() {
        into[(held.plant.order(), 0)] = 1.0;
    }
    let estimate = Estimate { gain: into, innovation, unknown: Some(unknown) };
    let T = sampling.period_s;
    let mean = |cost: Option<f64>| cost.map(|cost| cost / T);
    let cost = Cost {
        predicted: mean(full.predicted(&regulator.F, &estimate, &held.noise)?),
        achieved: mean(held.plant.achieved(&from_reading, &held.noise, T)?),
    };
    let certified =
        Certified { part: Part::Feedback, cost, regulator: regulator.into(), filter: Some(filter.into()) };
    Ok(Outcome::Solved(Drafted { system: controller.select(&[0], &[0, 1]), certified }))
}

/// The feedback's problem under the hold.
struct Held {
    /// Plant and sensor; inputs (control as it arrives, output s of the error weight if it has states).
    plant: Stage,
    noise: SampledNoise,
    /// Error weight without its continuous direct part, sampled.
    error: StateSpace,
    /// Inverse control weight, sampled.
    inverse: StateSpace,
    delay: StateSpace,
    period_s: f64,
}

impl Held {
    fn feedback(plant: &DesignPlant, weights: &FeedbackWeights, sampling: &Sampling) -> Result<Self, Error> {
        let T = sampling.period_s;
        let system = undelayed(plant).measured()?;
        let (n, outputs) = (system.order(), system.outputs());
        let error = weights.error.realise()?;
        let (column, row) = (system.B.block(0, plant.control, n, 1), system.C.block(0, 0, 1, n));
        let further = &weights.combination_row(outputs - 1) * &system.C.block(1, 0, outputs - 1, n);
        let seen = row.scale(-error.D[(0, 0)]).vstack(&further);
        let inputs = if error.order() > 0 { 2 } else { 1 };
        let (mut B, mut direct) = (Mat::zeros(n, inputs), Mat::zeros(2, inputs));
        B.set_block(0, 0, &column);
        if inputs == 2 {
            direct[(0, 1)] = 1.0;
        }
        let mut entering = column.scale(weights.loop_recovery.sqrt());
        for &(input, density) in &weights.disturbances {
            entering = entering.hstack(&system.B.block(0, input, n, 1).scale(density.sqrt()));
        }
        let white = (&entering * &entering.t(), weights.measurement_noise);
        let (stage, noise) = under_hold((&system.A, &B), (&seen, &direct), (white, &row), T)?;
        let strict = StateSpace { D: Mat::zeros(1, 1), ..error };
        Ok(Self {
            plant: stage,
            noise,
            error: bilinear(&strict, T)?,
            inverse: bilinear(&weights.control.realise_inverse()?, T)?,
            delay: delay_samples(sampling.delay_samples, T)?,
            period_s: T,
        })
    }

    /// Whether the error weight has states.
    fn weighs(&self) -> bool {
        self.error.order() > 0
    }

    /// \[x_p; y; x_e; delay; x_u\] (y and x_e where the error weight has states), input v.
    fn full(&self) -> Stage {
        let known = if self.weighs() { self.plant.extended(&self.known_error()) } else { self.plant.clone() };
        known.behind(&self.delay).behind(&self.inverse).with_price(self.period_s)
    }

    /// The reading y, which the controller has, and the error weight's states that it drives.
    fn known_error(&self) -> Extension {
        let (n, e) = (self.plant.order(), self.error.order());
        let row = &self.noise.reading;
        let control = self.plant.B.block(0, 0, n, 1);
        let weight = &self.error;
        Extension {
            from_state: (row * &self.plant.A).vstack(&Mat::zeros(e, n)),
            own: Mat::from_blocks(&[&[&Mat::zeros(1, 1), &Mat::zeros(1, e)], &[&-&weight.B, &weight.A]]),
            from_input: (row * &control).vstack(&Mat::zeros(e, 1)),
            by_state: Mat::zeros(2, n),
            by_own: Mat::zeros(1, 1 + e).vstack(&(-&weight.D).hstack(&weight.C)),
            by_input: Mat::col(&[1.0, 0.0]),
        }
    }

    /// From (demand, rate) to (control, control as it arrives, s, v); states \[x_p before the reading; x_e; delay; x_u\].
    fn controller(&self, F: &Mat, gain: &Mat, reference: Reference) -> Result<StateSpace, Error> {
        let (n, e) = (self.plant.order(), self.error.order());
        let sizes = [n, e, self.delay.order(), self.inverse.order()];
        let rows = Rows::new(&sizes, 2);
        let [before, x_e, late, x_u] = std::array::from_fn(|i| rows.state(i));
        let error = rows.input(1) - rows.input(0);
        let read = match reference {
            Reference::Error => error.clone(),
            Reference::WeightOnly => rows.input(1),
        };
        let x = &before + &(gain * &(&read - &(&self.noise.reading * &before)));
        let known = if self.weighs() { error.vstack(&x_e) } else { x_e.clone() };
        let v = -(F * &x.vstack(&known).vstack(&late).vstack(&x_u));
        let u = &(&self.inverse.C * &x_u) + &(&self.inverse.D * &v);
        let arrives = &(&self.delay.C * &late) + &(&self.delay.D * &u);
        let s = &(&self.error.C * &x_e) - &(&self.error.D * &error);
        let control = self.plant.B.block(0, 0, n, 1);
        let next = (&(&self.plant.A * &x) + &(&control * &arrives))
            .vstack(&(&(&self.error.A * &x_e) - &(&self.error.B * &error)))
            .vstack(&(&(&self.delay.A * &late) + &(&self.delay.B * &u)))
            .vstack(&(&(&self.inverse.A * &x_u) + &(&self.inverse.B * &v)));
        rows.system(&next, &u.vstack(&arrives).vstack(&s).vstack(&v), self.period_s)
    }

    /// The controller as it acts on the stage: from the reading to (inputs of the stage, v).
    fn as_driven(&self, controller: &StateSpace) -> StateSpace {
        let outputs: &[usize] = if self.weighs() { &[1, 2, 3] } else { &[1, 3] };
        controller.select(outputs, &[1])
    }
}

/// The feedforward of a channel designed on the sampled problem
///
/// ```text
///     x' = A x + B u + E C_d x_d,  x_d' = A_d x_d + B_d w,  x_s' = A_s x_s + B_s d       continuous, u held and late
///     measured = C_s x_s + n at the samples                     cost = mean of |H_q C x(t)|^2 + |v|^2,  u = H_r^-1 v
/// ```
///
/// The regulator is a discrete Riccati equation on plant and weights; the disturbance's share follows from a discrete
/// Sylvester equation, as does what the disturbance's filter tells of the plant. With [`Basis::ClosedLoop`] the sampled
/// feedback runs in the plant.
///
/// # Errors
/// As [`crate::feedforward()`], and for exact knowledge of derivatives, which no sensor reads.
pub(crate) fn feedforward(
    design: &Design,
    channel: Channel,
    feedback: &StateSpace,
    sampling: &Sampling,
) -> Result<Option<Outcome<Drafted>>, Error> {
    let Some(weights) = design.specification.feedforward(channel) else { return Ok(None) };
    let (closed, part) = (weights.basis == Basis::ClosedLoop, Part::from(channel));
    let senses = closed || design.specification.assembly == Assembly::Grimble;
    let driven = Driven::new(&design.plant, weights, (channel, senses), sampling)?;
    let around = closed.then(|| feedback.select(&[0], &[1]));
    let stage = driven.stage(around.as_ref());
    Ok(Some(driven.solve(stage, part, sampling.period_s)?))
}

/// Plant, error weight, disturbance and its sensor under the hold: states \[x_p; x_e; x_d; x_s\].
struct Driven {
    stage: Stage,
    noise: SampledNoise,
    /// The hub rate as the feedback's sensor reads it, on the first states.
    rate: Mat,
    /// First and last but one state of disturbance and sensor.
    disturbance: (usize, usize),
    inverse: StateSpace,
    delay: StateSpace,
    exact: bool,
}

/// The solution of a feedforward's equations.
struct Solution {
    F: Mat,
    estimate: Estimate,
    regulator: Equation,
    filter: Option<Equation>,
}

impl Driven {
    fn new(
        plant: &DesignPlant,
        weights: &FeedforwardWeights,
        (channel, senses): (Channel, bool),
        sampling: &Sampling,
    ) -> Result<Self, Error> {
        let bare = undelayed(plant);
        let bare = if senses { bare } else { DesignPlant { hub_sensor: None, ..bare } };
        let system = bare.measured()?;
        let weighed = 1 + weights.output.unwrap_or(plant.rate);
        let columns = plant.columns(channel);
        let generator = with_derivatives(&weights.generator.realise()?, columns.len())?;
        let exact = weights.knowledge == Knowledge::Exact;
        let sensor = if exact { None } else { plant.sensor(channel) };
        let source = source(&generator, sensor)?;
        let error = weights.error.realise()?;
        let (n, e, f) = (system.order(), error.order(), source.order());
        let row = system.C.block(weighed, 0, 1, n);
        let states: Vec<usize> = (0..n).collect();
        let into = &system.B.select(&states, columns) * &generator.C;
        let into = into.hstack(&Mat::zeros(n, f - generator.order()));
        let A = Mat::from_blocks(&[
            &[&system.A, &Mat::zeros(n, e), &into],
            &[&-(&error.B * &row), &error.A, &Mat::zeros(e, f)],
            &[&Mat::zeros(f, n), &Mat::zeros(f, e), &source.A],
        ]);
        let B = system.B.block(0, plant.control, n, 1).vstack(&Mat::zeros(e + f, 1));
        let seen = row.scale(-error.D[(0, 0)]).hstack(&error.C).hstack(&Mat::zeros(1, f));
        let entering = Mat::zeros(n + e, source.inputs()).vstack(&source.B);
        let density = match weights.knowledge {
            Knowledge::Exact => 0.0,
            Knowledge::Measured { noise } => noise,
        };
        let reading = Mat::zeros(1, n + e).hstack(&source.C);
        let white = (&entering * &entering.t(), density);
        let T = sampling.period_s;
        let (stage, noise) = under_hold((&A, &B), (&seen, &Mat::zeros(1, 1)), (white, &reading), T)?;
        Ok(Self {
            stage,
            noise,
            rate: system.C.block(0, 0, 1, n).hstack(&Mat::zeros(1, e + f)),
            disturbance: (n + e, n + e + f),
            inverse: bilinear(&weights.control.realise_inverse()?, T)?,
            delay: delay_samples(sampling.delay_samples, T)?,
            exact,
        })
    }

    /// \[x_p; x_e; x_d; x_s; delay; feedback\], input u.
    fn stage(&self, feedback: Option<&StateSpace>) -> Stage {
        let late = self.stage.behind(&self.delay);
        match feedback {
            Some(K) => late.around(K, &widened(&self.rate, late.order())),
            None => late,
        }
    }

    fn solve(&self, stage: Stage, part: Part, T: f64) -> Result<Outcome<Drafted>, Error> {
        let k = stage.order();
        let noise = SampledNoise {
            process: self
                .noise
                .process
                .block_diag(&Mat::zeros(k - self.stage.order(), k - self.stage.order())),
            reading: widened(&self.noise.reading, k),
            ..self.noise
        };
        let full = stage.behind(&self.inverse).with_price(T);
        let solution = match self.equations(&stage, &full, (&noise, part))? {
            Outcome::Solved(solution) => solution,
            Outcome::Infeasible(findings) => return Ok(Outcome::Infeasible(findings)),
        };
        let module = self.module(&stage, &solution, (&noise, T))?;
        let mean = |cost: Option<f64>| cost.map(|cost| cost / T);
        let cost = Cost {
            predicted: mean(full.predicted(&solution.F, &solution.estimate, &noise)?),
            achieved: mean(stage.achieved(&module.select(&[0, 2], &[0]), &noise, T)?),
        };
        let (regulator, filter) = (solution.regulator, solution.filter);
        let certified = Certified { part, cost, regulator, filter };
        Ok(Outcome::Solved(Drafted { system: module.select(&[0, 1], &[0]), certified }))
    }

    fn equations(
        &self,
        stage: &Stage,
        full: &Stage,
        (noise, part): (&SampledNoise, Part),
    ) -> Result<Outcome<Solution>, Error> {
        let (F, regulator) = match self.regulator(full, part)? {
            Outcome::Solved(found) => found,
            Outcome::Infeasible(findings) => return Ok(Outcome::Infeasible(findings)),
        };
        let f: Vec<usize> = (self.disturbance.0..self.disturbance.1).collect();
        let own = stage.on(&f);
        let seen = SampledNoise {
            process: noise.process.select(&f, &f),
            reading: noise.reading.select(&[0], &f),
            ..*noise
        };
        let (Y, equation) = if self.exact {
            (seen.process.clone(), None)
        } else {
            match filter(&own.A, &seen, part)? {
                Outcome::Solved(solution) => (solution.X.clone(), Some(solution.into())),
                Outcome::Infeasible(findings) => return Ok(Outcome::Infeasible(findings)),
            }
        };
        let estimate = self.estimate(stage, (&Y, &f), noise)?;
        let mut gain = estimate.gain;
        gain = gain.vstack(&Mat::zeros(full.order() - gain.nrows(), 1));
        let estimate = Estimate { gain, ..estimate };
        Ok(Outcome::Solved(Solution { F, estimate, regulator, filter: equation }))
    }

    /// The gain on every state: by Riccati on those that control moves, by Sylvester on the disturbance's
    ///
    /// ```text
    ///     A_c' X_pf A_f - X_pf + A_c' X A_pf + Q_pf - F' S_f' = 0,   F_f = (R + B'XB)^-1 (B'(X A_pf + X_pf A_f) + S_f')
    /// ```
    fn regulator(&self, full: &Stage, part: Part) -> Result<Outcome<(Mat, Equation)>, Error> {
        let (first, last) = self.disturbance;
        let f: Vec<usize> = (first..last).collect();
        let p: Vec<usize> = (0..full.order()).filter(|i| !f.contains(i)).collect();
        let moved = full.on(&p);
        let solution = match moved.regulator(part)? {
            Outcome::Solved(solution) => solution,
            Outcome::Infeasible(findings) => return Ok(Outcome::Infeasible(findings)),
        };
        let (Q, R, S) = full.costs();
        let (A_f, A_pf) = (full.A.select(&f, &f), full.A.select(&p, &f));
        let (Q_pf, S_f) = (Q.select(&p, &f), S.select(&f, &[0]));
        let closed = (&moved.A - &(&moved.B * &solution.F)).t();
        let driven = &(&closed * &(&solution.X * &A_pf)) + &(&Q_pf - &(&solution.F.t() * &S_f.t()));
        let X_pf = dsylvester(&closed, &A_f, &driven)?;
        let price = (&R + &(&moved.B.t() * &(&solution.X * &moved.B)))[(0, 0)];
        let carried = &(&solution.X * &A_pf) + &(&X_pf * &A_f);
        let F_f = (&(&moved.B.t() * &carried) + &S_f.t()).scale(1.0 / price);
        let mut F = Mat::zeros(1, full.order());
        p.iter().enumerate().for_each(|(k, &i)| F[(0, i)] = solution.F[(0, k)]);
        f.iter().enumerate().for_each(|(k, &i)| F[(0, i)] = F_f[(0, k)]);
        Ok(Outcome::Solved((F, solution.into())))
    }

    /// What a reading of the disturbance tells of every state: the covariance between plant and disturbance before a
    /// reading obeys P = (A_pp P + A_pf Y) (A_f (I - M C))' + W_pf.
    fn estimate(
        &self,
        stage: &Stage,
        (Y, f): (&Mat, &[usize]),
        noise: &SampledNoise,
    ) -> Result<Estimate, Error> {
        let p: Vec<usize> = (0..stage.order()).filter(|i| !f.contains(i)).collect();
        let row = noise.reading.select(&[0], f);
        let (_, gain, innovation) = after_reading(Y, &row, noise.measurement);
        let settled = (&stage.A.select(f, f) * &(Mat::eye(f.len()) - &(&gain * &row))).t();
        let driven = &(&stage.A.select(&p, f) * &(Y * &settled)) + &noise.process.select(&p, f);
        let cross = dsylvester(&stage.A.select(&p, &p), &settled, &driven)?;
        let of_plant = (&cross * &row.t()).scale(1.0 / innovation);
        let mut all = Mat::zeros(stage.order(), 1);
        p.iter().enumerate().for_each(|(k, &i)| all[(i, 0)] = of_plant[(k, 0)]);
        f.iter().enumerate().for_each(|(k, &i)| all[(i, 0)] = gain[(k, 0)]);
        let unknown = unknown(stage, &all, noise)?;
        Ok(Estimate { gain: all, innovation, unknown })
    }

    /// From the measured disturbance to (u, expected rate, v); states \[stage before the reading; x_u\].
    fn module(
        &self,
        stage: &Stage,
        solution: &Solution,
        (noise, period_s): (&SampledNoise, f64),
    ) -> Result<StateSpace, Error> {
        let rows = Rows::new(&[stage.order(), self.inverse.order()], 1);
        let [before, x_u] = std::array::from_fn(|i| rows.state(i));
        let gain = solution.estimate.gain.block(0, 0, stage.order(), 1);
        let x = &before + &(&gain * &(&rows.input(0) - &(&noise.reading * &before)));
        let v = -(&solution.F * &x.vstack(&x_u));
        let u = &(&self.inverse.C * &x_u) + &(&self.inverse.D * &v);
        let expected = &widened(&self.rate, stage.order()) * &x;
        let next = (&(&stage.A * &x) + &(&stage.B * &u))
            .vstack(&(&(&self.inverse.A * &x_u) + &(&self.inverse.B * &v)));
        rows.system(&next, &u.vstack(&expected).vstack(&v), period_s)
    }
}

/// Covariance after a reading of what an estimator with this gain does not know.
fn unknown(stage: &Stage, gain: &Mat, noise: &SampledNoise) -> Result<Option<Mat>, Error> {
    let kept = Mat::eye(stage.order()) - &(gain * &noise.reading);
    let carried = &kept * &stage.A;
    let W = &(&kept * &(&noise.process * &kept.t())) + &(gain * &gain.t().scale(noise.measurement));
    crate::stage::stationary(&carried, &W.symmetric_part())
}

/// Signals as rows on \[states; inputs\] of a system that is being built.
struct Rows {
    sizes: Vec<usize>,
    width: usize,
    inputs: usize,
}

impl Rows {
    fn new(sizes: &[usize], inputs: usize) -> Self {
        Self { sizes: sizes.to_vec(), width: sizes.iter().sum::<usize>() + inputs, inputs }
    }

    fn state(&self, index: usize) -> Mat {
        let first: usize = self.sizes[..index].iter().sum();
        Mat::from_fn(self.sizes[index], self.width, |i, j| if j == first + i { 1.0 } else { 0.0 })
    }

    fn input(&self, index: usize) -> Mat {
        let at = self.width - self.inputs + index;
        Mat::from_fn(1, self.width, |_, j| if j == at { 1.0 } else { 0.0 })
    }

    fn system(&self, next: &Mat, outputs: &Mat, period_s: f64) -> Result<StateSpace, Error> {
        let (n, m) = (self.width - self.inputs, self.inputs);
        let split = |rows: &Mat| (rows.block(0, 0, rows.nrows(), n), rows.block(0, n, rows.nrows(), m));
        let ((A, B), (C, D)) = (split(next), split(outputs));
        Ok(StateSpace::new(A, B, C, D, Timebase::Discrete { period_s })?)
    }
}

/// x' = A x + B q + white noise, z = seen x + direct q, under held q.
fn under_hold(
    (A, B): (&Mat, &Mat),
    (seen, direct): (&Mat, &Mat),
    ((process, density), reading): ((Mat, f64), &Mat),
    period_s: f64,
) -> Result<(Stage, SampledNoise), Error> {
    let (Q, R, S) = (&seen.t() * seen, &direct.t() * direct, &seen.t() * direct);
    let cost = Quadratic { Q: &Q, R: &R, S: &S };
    let measurement = Mat::eye(1).scale(density);
    let noise = Noise { process: &process, measurement: &measurement };
    let found = sampled_problem(A, B, cost, noise, period_s)?;
    let weight = Mat::from_blocks(&[&[&found.cost.Q, &found.cost.S], &[&found.cost.S.t(), &found.cost.R]]);
    let noise = SampledNoise {
        process: found.process,
        reading: reading.clone(),
        measurement: found.measurement[(0, 0)],
        unavoidable: found.unavoidable,
    };
    Ok((Stage { A: found.cost.A, B: found.cost.B, weight }, noise))
}

/// Generator, its sensor behind it: from w to the measured disturbance, states \[x_d; x_s\].
fn source(generator: &StateSpace, sensor: Option<&StateSpace>) -> Result<StateSpace, Error> {
    let first = generator.select(&[0], &[0]);
    Ok(match sensor {
        Some(sensor) => counterpoise_lti::series(&first, sensor)?,
        None => first,
    })
}

fn undelayed(plant: &DesignPlant) -> DesignPlant {
    DesignPlant { pade_order: 0, ..plant.clone() }
}

fn bilinear(weight: &StateSpace, period_s: f64) -> Result<StateSpace, Error> {
    Ok(c2d(weight, period_s, Discretisation::Tustin { prewarp_rad_s: None })?)
}

/// The row with zeros behind it.
fn widened(row: &Mat, columns: usize) -> Mat {
    row.hstack(&Mat::zeros(1, columns - row.ncols()))
}
