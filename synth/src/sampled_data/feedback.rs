//! The feedback on the sampled problem.

use counterpoise_linalg::Mat;
use counterpoise_linalg::sparse::VectorEntry;
use counterpoise_lti::{StateSpace, delay_samples};

use super::DraftedPart;
use super::held_plant::{Problem, bilinear, discretise_under_hold, remove_delay};
use super::rows::Rows;
use crate::certificate::{Cost, PartCertificates};
use crate::finding::Part;
use crate::stage::{Estimate, Extension, SampledNoise, Stage, filter, update_by_reading};
use crate::{Design, DesignPlant, Error, FeedbackWeights, Reference, Sampling};

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
/// As [`crate::design_feedback()`]; a problem without solution is [`Error::Refused`].
pub(crate) fn feedback(design: &Design, sampling: &Sampling) -> Result<DraftedPart, Error> {
    let weights = &design.specification.feedback;
    let held = SampledFeedbackProblem::feedback(&design.plant, weights, sampling)?;
    let full = held.full_stage();
    let regulator = full.regulator(Part::Feedback)?;
    let filter = filter(&held.plant.A, &held.noise, Part::Feedback)?;
    let (unknown, gain, innovation) =
        update_by_reading(&filter.X, &held.noise.reading, held.noise.measurement);
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
        predicted: mean(full.predict_cost(&regulator.F, &estimate, &held.noise)?),
        achieved: mean(held.plant.closed_loop_cost(&from_reading, &held.noise, T)?),
    };
    let certified = PartCertificates {
        part: Part::Feedback,
        cost,
        regulator: regulator.into(),
        filter: Some(filter.into()),
    };
    Ok(DraftedPart { system: controller.select(&[0], &[0, 1]), certified })
}

/// The feedback's problem under the hold.
struct SampledFeedbackProblem {
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

impl SampledFeedbackProblem {
    fn feedback(plant: &DesignPlant, weights: &FeedbackWeights, sampling: &Sampling) -> Result<Self, Error> {
        let T = sampling.period_s;
        let system = remove_delay(plant).measured_plant()?;
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
        for &VectorEntry { index: input, value: density } in &weights.disturbances {
            entering = entering.hstack(&system.B.block(0, input, n, 1).scale(density.sqrt()));
        }
        let problem = Problem {
            A: &system.A,
            B: &B,
            seen: &seen,
            direct: &direct,
            process: &(&entering * &entering.t()),
            density: weights.measurement_noise,
            reading: &row,
        };
        let (stage, noise) = discretise_under_hold(&problem, T)?;
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

    /// Returns whether the error weight has states.
    fn weighs(&self) -> bool {
        self.error.order() > 0
    }

    /// \[x_p; y; x_e; delay; x_u\] (y and x_e where the error weight has states), input v.
    fn full_stage(&self) -> Stage {
        let known = if self.weighs() { self.plant.extend(&self.known_error()) } else { self.plant.clone() };
        known.filter_input(&self.delay).filter_input(&self.inverse).with_price(self.period_s)
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
