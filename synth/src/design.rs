//! The three-part design: feedback, heave feedforward and pitch feedforward, put together.

use counterpoise_lti::{Mat, StateSpace, Timebase, append, series};

use crate::{
    Assembly, Basis, Channel, DesignPlant, Error, Feedback, Feedforward, Finding, Outcome, Specification,
    feedback, feedforward, preflight,
};

/// A designed controller, continuous, with its certificates.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// The feedback: its controller goes from (demand, measured rate) to (control, weighted control).
    pub feedback: Feedback,
    /// The heave feedforward.
    pub heave: Option<Feedforward>,
    /// The pitch feedforward.
    pub pitch: Option<Feedforward>,
    /// How they are put together, and where the demand enters.
    pub specification: Specification,
    /// The plant it was designed for.
    pub plant: DesignPlant,
    /// Findings of the preflight that do not stand in the way.
    pub warnings: Vec<Finding>,
    /// A feedback controller from (demand, measured rate) to the control in place of the three-part one's: another
    /// method's, or one of lower order.
    pub substitute: Option<StateSpace>,
}

/// The three-part H2 design.
///
/// The steps: [`preflight()`] (refusals end here, before any equation is solved), [`feedback()`], [`feedforward()`] for
/// heave and pitch. The three are independent of each other: each source of disturbance has its own weights.
///
/// # Errors
/// [`Error`] for a plant that is not one. Weights that make no solvable problem are [`Outcome::Infeasible`] with every
/// reason.
pub fn design(plant: &DesignPlant, specification: &Specification) -> Result<Outcome<Design>, Error> {
    let findings = preflight(plant, specification)?;
    if findings.iter().any(Finding::is_refusal) {
        return Ok(Outcome::Infeasible(findings));
    }
    let feedback = match feedback(plant, &specification.feedback, specification.reference)? {
        Outcome::Solved(feedback) => feedback,
        Outcome::Infeasible(reasons) => return Ok(Outcome::Infeasible(reasons)),
    };
    let mut parts = [None, None];
    for (part, channel) in parts.iter_mut().zip([Channel::Heave, Channel::Pitch]) {
        let Some(weights) = specification.feedforward(channel) else { continue };
        let solved = match weights.basis {
            Basis::OpenLoop => feedforward(plant, weights, channel)?,
            Basis::ClosedLoop => feedforward(&with_feedback(plant, &feedback)?, weights, channel)?,
        };
        match solved {
            Outcome::Solved(solution) => *part = Some(solution),
            Outcome::Infeasible(reasons) => return Ok(Outcome::Infeasible(reasons)),
        }
    }
    let [heave, pitch] = parts;
    let (specification, plant) = (specification.clone(), plant.clone());
    let warnings = findings;
    Ok(Outcome::Solved(Design { feedback, heave, pitch, specification, plant, warnings, substitute: None }))
}

/// The plant with the feedback around it, its sensor and delay inside: states \[plant; controller\].
fn with_feedback(plant: &DesignPlant, feedback: &Feedback) -> Result<DesignPlant, Error> {
    let (seen, K) = (plant.measured()?, feedback.controller.select(&[0], &[1]));
    let (n, k, outputs) = (seen.order(), K.order(), seen.outputs() - 1);
    let column = seen.B.block(0, plant.control, n, 1);
    let row = seen.C.block(0, 0, 1, n);
    let A = Mat::from_blocks(&[&[&seen.A, &(&column * &K.C)], &[&(&K.B * &row), &K.A]]);
    let B = seen.B.vstack(&Mat::zeros(k, seen.inputs()));
    let C = seen.C.block(1, 0, outputs, n).hstack(&Mat::zeros(outputs, k));
    let D = seen.D.block(1, 0, outputs, seen.inputs());
    let system = StateSpace::new(A, B, C, D, Timebase::Continuous)?;
    Ok(DesignPlant { system, hub_sensor: None, delay_s: 0.0, pade_order: 0, ..plant.clone() })
}

impl Design {
    /// The feedforward of a channel.
    pub fn part(&self, channel: Channel) -> Option<&Feedforward> {
        match channel {
            Channel::Heave => self.heave.as_ref(),
            Channel::Pitch => self.pitch.as_ref(),
        }
    }

    /// The feedback controller C0 from (demand, measured rate) to the control.
    pub fn feedback_controller(&self) -> StateSpace {
        let own = || self.feedback.controller.select(&[0], &[0, 1]);
        self.substitute.clone().unwrap_or_else(own)
    }

    /// The feedforward module of a channel from the measured disturbance to the control.
    pub fn feedforward_controller(&self, channel: Channel) -> Option<StateSpace> {
        let module = &self.part(channel)?.module;
        let inputs: Vec<usize> = (0..module.inputs()).collect();
        Some(module.select(&[0], &inputs))
    }

    /// The whole controller from (demand, measured rate, heave signals, pitch signals) to the control, in the assembly
    /// that the specification asks for.
    ///
    /// # Errors
    /// [`Error::Lti`].
    pub fn joint_controller(&self) -> Result<StateSpace, Error> {
        let parts = [Channel::Heave, Channel::Pitch].into_iter().filter_map(|channel| self.part(channel));
        let modules: Vec<StateSpace> =
            parts.map(|part| self.as_seen(&part.module)).collect::<Result<_, Error>>()?;
        self.assembled(&self.feedback_controller(), &modules)
    }

    /// Feedback from (demand, rate) and modules from their signals to (control, rate as the sensor would read it), put
    /// together in the assembly that the specification asks for; all of one timebase.
    pub(crate) fn assembled(
        &self,
        feedback: &StateSpace,
        modules: &[StateSpace],
    ) -> Result<StateSpace, Error> {
        let timebase = feedback.timebase;
        let mut joint = StateSpace::gain(Mat::eye(2), timebase)?;
        for module in modules {
            joint = append(&joint, module)?;
        }
        let wired = series(&joint, &StateSpace::gain(self.mixer(modules.len()), timebase)?)?;
        let passed = StateSpace::gain(Mat::eye(1), timebase)?;
        let controllers = append(feedback, &passed)?;
        let sum = StateSpace::gain(Mat::row(&[1.0, 1.0]), timebase)?;
        Ok(series(&series(&wired, &controllers)?, &sum)?)
    }

    /// The module with outputs (control, expected rate), the latter as the hub sensor would read it.
    fn as_seen(&self, module: &StateSpace) -> Result<StateSpace, Error> {
        let inputs: Vec<usize> = (0..module.inputs()).collect();
        let both = module.select(&[0, 1], &inputs);
        match (&self.plant.hub_sensor, self.specification.assembly) {
            (Some(sensor), Assembly::Grimble) => {
                Ok(series(&both, &append(&StateSpace::gain(Mat::eye(1), Timebase::Continuous)?, sensor)?)?)
            }
            _ => Ok(both),
        }
    }

    /// From (demand, rate, u1, y1, u2, y2, ...) to (demand, rate less what is expected, sum of the u).
    fn mixer(&self, modules: usize) -> Mat {
        let share = match self.specification.assembly {
            Assembly::SimpleAdd => 0.0,
            Assembly::Grimble => -1.0,
        };
        let mut D = Mat::zeros(3, 2 + 2 * modules);
        D[(0, 0)] = 1.0;
        D[(1, 1)] = 1.0;
        for module in 0..modules {
            D[(2, 2 + 2 * module)] = 1.0;
            D[(1, 3 + 2 * module)] = share;
        }
        D
    }

    /// The largest relative difference between predicted and achieved cost over the three parts; `None` where none of
    /// them has both.
    pub fn worst_cost_difference(&self) -> Option<f64> {
        let parts = [self.heave.as_ref(), self.pitch.as_ref()];
        let costs = parts.into_iter().flatten().map(|part| part.cost).chain([self.feedback.cost]);
        costs.filter_map(|cost| cost.relative_difference()).max_by(f64::total_cmp)
    }
}
