//! A feedforward on the sampled problem.

use counterpoise_linalg::{Mat, dsylvester};
use counterpoise_lti::{StateSpace, delay_samples};

use super::DraftedPart;
use super::held_plant::{Problem, bilinear, discretise_under_hold, pad_columns, remove_delay};
use super::rows::Rows;
use crate::certificate::{Cost, Equation, PartCertificates};
use crate::feedforward::with_derivatives;
use crate::finding::Part;
use crate::stage::{Estimate, SampledNoise, Stage, filter, update_by_reading};
use crate::{
    Assembly, Design, DesignPlant, DisturbanceChannel, DisturbanceKnowledge, Error, FeedforwardBasis,
    FeedforwardWeights, Sampling,
};

/// The feedforward of a channel designed on the sampled problem
///
/// ```text
///     x' = A x + B u + E C_d x_d,  x_d' = A_d x_d + B_d w,  x_s' = A_s x_s + B_s d       continuous, u held and late
///     measured = C_s x_s + n at the samples                     cost = mean of |H_q C x(t)|^2 + |v|^2,  u = H_r^-1 v
/// ```
///
/// The regulator is a discrete Riccati equation on plant and weights; the disturbance's share follows from a discrete
/// Sylvester equation, as does what the disturbance's filter tells of the plant. With [`FeedforwardBasis::ClosedLoop`] the sampled
/// feedback runs in the plant.
///
/// # Errors
/// As [`crate::design_feedforward()`], and for exact knowledge of derivatives, which no sensor reads.
pub(crate) fn feedforward(
    design: &Design,
    channel: DisturbanceChannel,
    feedback: &StateSpace,
    sampling: &Sampling,
) -> Result<Option<DraftedPart>, Error> {
    let Some(weights) = design.specification.feedforward(channel) else { return Ok(None) };
    let (closed, part) = (weights.basis == FeedforwardBasis::ClosedLoop, Part::from(channel));
    let with_sensor = closed || design.specification.assembly == Assembly::Grimble;
    let feels = if with_sensor { HubSensor::Inside } else { HubSensor::Outside };
    let driven = DisturbedStage::new(&design.plant, weights, channel, feels, sampling)?;
    let around = closed.then(|| feedback.select(&[0], &[1]));
    let stage = driven.stage(around.as_ref());
    Ok(Some(driven.solve(stage, part, sampling.period_s)?))
}

/// The place of the hub sensor in the plant of a feedforward.
#[derive(Clone, Copy, PartialEq)]
enum HubSensor {
    /// A feedback reads it inside the plant, or what it would read is expected.
    Inside,
    /// Nothing reads it.
    Outside,
}

/// Plant, error weight, disturbance and its sensor under the hold: states \[x_p; x_e; x_d; x_s\].
struct DisturbedStage {
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

/// Returns the plant with its measurements, without delay and, if the loop's sensor is outside, without the hub's sensor.
fn measured_without_delay(plant: &DesignPlant, hub_sensor: HubSensor) -> Result<StateSpace, Error> {
    let bare = remove_delay(plant);
    let bare = match hub_sensor {
        HubSensor::Inside => bare,
        HubSensor::Outside => DesignPlant { hub_sensor: None, ..bare },
    };
    bare.measured_plant()
}

impl DisturbedStage {
    fn new(
        plant: &DesignPlant,
        weights: &FeedforwardWeights,
        channel: DisturbanceChannel,
        hub_sensor: HubSensor,
        sampling: &Sampling,
    ) -> Result<Self, Error> {
        let system = measured_without_delay(plant, hub_sensor)?;
        let weighed = 1 + weights.output.unwrap_or(plant.rate);
        let columns = plant.columns(channel);
        let generator = with_derivatives(&weights.generator.realise()?, columns.len())?;
        let exact = weights.knowledge == DisturbanceKnowledge::Exact;
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
            DisturbanceKnowledge::Exact => 0.0,
            DisturbanceKnowledge::Measured { noise } => noise,
        };
        let reading = Mat::zeros(1, n + e).hstack(&source.C);
        let T = sampling.period_s;
        let (process, direct) = (&entering * &entering.t(), Mat::zeros(1, 1));
        let problem = Problem {
            A: &A,
            B: &B,
            seen: &seen,
            direct: &direct,
            process: &process,
            density,
            reading: &reading,
        };
        let (stage, noise) = discretise_under_hold(&problem, T)?;
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
        let late = self.stage.filter_input(&self.delay);
        match feedback {
            Some(K) => late.close_loop(K, &pad_columns(&self.rate, late.order())),
            None => late,
        }
    }

    fn solve(&self, stage: Stage, part: Part, T: f64) -> Result<DraftedPart, Error> {
        let k = stage.order();
        let noise = SampledNoise {
            process: self
                .noise
                .process
                .block_diag(&Mat::zeros(k - self.stage.order(), k - self.stage.order())),
            reading: pad_columns(&self.noise.reading, k),
            ..self.noise
        };
        let full = stage.filter_input(&self.inverse).with_price(T);
        let solution = self.equations(&stage, &full, &noise, part)?;
        let module = self.module(&stage, &solution, &noise, T)?;
        let mean = |cost: Option<f64>| cost.map(|cost| cost / T);
        let cost = Cost {
            predicted: mean(full.predict_cost(&solution.F, &solution.estimate, &noise)?),
            achieved: mean(stage.closed_loop_cost(&module.select(&[0, 2], &[0]), &noise, T)?),
        };
        let (regulator, filter) = (solution.regulator, solution.filter);
        let certified = PartCertificates { part, cost, regulator, filter };
        Ok(DraftedPart { system: module.select(&[0, 1], &[0]), certified })
    }

    fn equations(
        &self,
        stage: &Stage,
        full: &Stage,
        noise: &SampledNoise,
        part: Part,
    ) -> Result<Solution, Error> {
        let (F, regulator) = self.regulator(full, part)?;
        let f: Vec<usize> = (self.disturbance.0..self.disturbance.1).collect();
        let own = stage.select_states(&f);
        let seen = SampledNoise {
            process: noise.process.select(&f, &f),
            reading: noise.reading.select(&[0], &f),
            ..*noise
        };
        let (Y, equation) = if self.exact {
            (seen.process.clone(), None)
        } else {
            let solution = filter(&own.A, &seen, part)?;
            (solution.X.clone(), Some(solution.into()))
        };
        let estimate = self.estimate(stage, &Y, &f, noise)?;
        let mut gain = estimate.gain;
        gain = gain.vstack(&Mat::zeros(full.order() - gain.nrows(), 1));
        let estimate = Estimate { gain, ..estimate };
        Ok(Solution { F, estimate, regulator, filter: equation })
    }

    /// The gain on every state: by Riccati on those that control moves, by Sylvester on the disturbance's
    ///
    /// ```text
    ///     A_c' X_pf A_f - X_pf + A_c' X A_pf + Q_pf - F' S_f' = 0,   F_f = (R + B'XB)^-1 (B'(X A_pf + X_pf A_f) + S_f')
    /// ```
    fn regulator(&self, full: &Stage, part: Part) -> Result<(Mat, Equation), Error> {
        let (first, last) = self.disturbance;
        let f: Vec<usize> = (first..last).collect();
        let p: Vec<usize> = (0..full.order()).filter(|i| !f.contains(i)).collect();
        let moved = full.select_states(&p);
        let solution = moved.regulator(part)?;
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
        Ok((F, solution.into()))
    }

    /// Returns what a reading of the disturbance tells of every state: the covariance between plant and disturbance before a
    /// reading obeys P = (A_pp P + A_pf Y) (A_f (I - M C))' + W_pf.
    fn estimate(&self, stage: &Stage, Y: &Mat, f: &[usize], noise: &SampledNoise) -> Result<Estimate, Error> {
        let p: Vec<usize> = (0..stage.order()).filter(|i| !f.contains(i)).collect();
        let row = noise.reading.select(&[0], f);
        let (_, gain, innovation) = update_by_reading(Y, &row, noise.measurement);
        let settled = (&stage.A.select(f, f) * &(Mat::eye(f.len()) - &(&gain * &row))).t();
        let driven = &(&stage.A.select(&p, f) * &(Y * &settled)) + &noise.process.select(&p, f);
        let cross = dsylvester(&stage.A.select(&p, &p), &settled, &driven)?;
        let of_plant = (&cross * &row.t()).scale(1.0 / innovation);
        let mut all = Mat::zeros(stage.order(), 1);
        p.iter().enumerate().for_each(|(k, &i)| all[(i, 0)] = of_plant[(k, 0)]);
        f.iter().enumerate().for_each(|(k, &i)| all[(i, 0)] = gain[(k, 0)]);
        let unknown = unknown_covariance(stage, &all, noise)?;
        Ok(Estimate { gain: all, innovation, unknown })
    }

    /// From the measured disturbance to (u, expected rate, v); states \[stage before the reading; x_u\].
    fn module(
        &self,
        stage: &Stage,
        solution: &Solution,
        noise: &SampledNoise,
        period_s: f64,
    ) -> Result<StateSpace, Error> {
        let rows = Rows::new(&[stage.order(), self.inverse.order()], 1);
        let [before, x_u] = std::array::from_fn(|i| rows.state(i));
        let gain = solution.estimate.gain.block(0, 0, stage.order(), 1);
        let x = &before + &(&gain * &(&rows.input(0) - &(&noise.reading * &before)));
        let v = -(&solution.F * &x.vstack(&x_u));
        let u = &(&self.inverse.C * &x_u) + &(&self.inverse.D * &v);
        let expected = &pad_columns(&self.rate, stage.order()) * &x;
        let next = (&(&stage.A * &x) + &(&stage.B * &u))
            .vstack(&(&(&self.inverse.A * &x_u) + &(&self.inverse.B * &v)));
        rows.system(&next, &u.vstack(&expected).vstack(&v), period_s)
    }
}

/// Covariance after a reading of what an estimator with this gain does not know.
fn unknown_covariance(stage: &Stage, gain: &Mat, noise: &SampledNoise) -> Result<Option<Mat>, Error> {
    let kept = Mat::eye(stage.order()) - &(gain * &noise.reading);
    let carried = &kept * &stage.A;
    let W = &(&kept * &(&noise.process * &kept.t())) + &(gain * &gain.t().scale(noise.measurement));
    crate::stage::stationary_covariance(&carried, &W.symmetric_part())
}

/// Generator, its sensor behind it: from w to the measured disturbance, states \[x_d; x_s\].
fn source(generator: &StateSpace, sensor: Option<&StateSpace>) -> Result<StateSpace, Error> {
    let first = generator.select(&[0], &[0]);
    Ok(match sensor {
        Some(sensor) => counterpoise_lti::series(&first, sensor)?,
        None => first,
    })
}
