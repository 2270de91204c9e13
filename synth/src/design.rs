//! The three-part design: feedback, heave feedforward and pitch feedforward, put together.

use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase, append, series};

use crate::cascade::with_position_loop;
use crate::cause::{Cause, SpecificationCause};
use crate::finding::WeightRole;
use crate::preflight::gain::Gain;
use crate::tolerance::{SLOWEST_RAD_S, ZERO_GAIN};
use crate::{
    Assembly, DesignFinding, DesignPlant, DisturbanceChannel, Error, Feedback, Feedforward, FeedforwardBasis,
    FeedforwardWeights, JointOptimum, LightModes, Specification, Weight, design_feedback, design_feedforward,
    joint_optimum, preflight,
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
    /// Structure of the loop, and the place at which the demand enters.
    pub specification: Specification,
    /// The plant it was designed for.
    pub plant: DesignPlant,
    /// Findings of the preflight that do not stand in the way.
    pub warnings: Vec<DesignFinding>,
    /// All parts as one problem, if the assembly is [`Assembly::Joint`]; there are then no feedforwards apart.
    pub joint: Option<JointOptimum>,
    /// A feedback controller from (demand, measured rate) to the control in place of the three-part one's: another
    /// method's, one of lower order, that of a cascade, or one for the plant with stiff modes.
    pub substitute: Option<StateSpace>,
}

/// Returns the three-part H2 design.
///
/// The weights are those of the rate loop if the plant has one ([`DesignPlant::rate_loop`]); the position loop is then put around its
/// feedback.
///
/// The steps: [`preflight()`] (refusals end here, before any equation is solved), [`design_feedback()`], [`design_feedforward()`] for
/// heave and pitch. The three are independent of each other: each source of disturbance has its own weights.
///
/// # Errors
/// [`Error`] for a plant that is not one. Weights that make no solvable problem are [`Error::Refused`] with every
/// reason.
pub fn design(plant: &DesignPlant, specification: &Specification) -> Result<Design, Error> {
    let (whole, plant) = (plant, plant.weighted_plant());
    let findings = preflight(plant, specification)?;
    if findings.iter().any(DesignFinding::is_refusal) {
        return Err(Error::refusal(findings));
    }
    let feedback = design_feedback(plant, &specification.feedback, specification.reference)?;
    let cascade = with_position_loop(whole, &feedback.controller, specification.position_gain)?;
    // The cost of a feedback for stiff modes is that of another plant.
    let for_stiff_modes = specification.feedback.modes == LightModes::Stiffened;
    let substitute = cascade.or_else(|| for_stiff_modes.then(|| feedback.controller.clone()));
    let (mut parts, mut warnings, mut solvable) = ([None, None], findings, specification.clone());
    for (part, channel) in parts.iter_mut().zip([DisturbanceChannel::Heave, DisturbanceChannel::Pitch]) {
        let Some(weights) = specification.feedforward(channel) else { continue };
        if specification.assembly == Assembly::Joint {
            continue;
        }
        *part = Some(match weights.basis {
            FeedforwardBasis::OpenLoop => design_feedforward(plant, weights, channel)?,
            FeedforwardBasis::ClosedLoop => {
                let closed = with_feedback(plant, &feedback)?;
                let (seen, warning) = with_control_seen(&closed, weights, channel)?;
                warnings.extend(warning);
                let solved = design_feedforward(&closed, &seen, channel)?;
                solvable.set_feedforward(channel, seen);
                solved
            }
        });
    }
    let joint = match specification.assembly {
        Assembly::Joint => Some(joint_optimum(plant, specification)?),
        Assembly::SimpleAdd | Assembly::Grimble => None,
    };
    let [heave, pitch] = parts;
    let (specification, plant) = (solvable, whole.clone());
    Ok(Design { feedback, heave, pitch, specification, plant, warnings, joint, substitute })
}

/// Returns a feedforward's weights with the control weight's zeros on the axis moved off it at every frequency at which the
/// closed loop's rate shows no control, and a warning for the first of them.
///
/// With integral action in the feedback a steady control of the feedforward is cancelled: if it is free too, any steady
/// control is as good as any other. A zero at -[`SLOWEST_RAD_S`] makes the least one the best.
fn with_control_seen(
    closed: &DesignPlant,
    weights: &FeedforwardWeights,
    channel: DisturbanceChannel,
) -> Result<(FeedforwardWeights, Option<DesignFinding>), Error> {
    let weighed = weights.output.unwrap_or(closed.rate);
    let gain = Gain::of(&closed.system.select(&[weighed], &[closed.control]))?;
    let mut rational = weights.control.rational();
    let mut moved = None;
    for zero in rational.zeros.iter_mut().filter(|zero| zero.re == 0.0) {
        if gain.relative_modulus(zero.im.abs())? < ZERO_GAIN {
            moved = moved.or(Some(zero.im.abs()));
            zero.re = -SLOWEST_RAD_S;
        }
    }
    let Some(rate) = moved else { return Ok((weights.clone(), None)) };
    let finding = DesignFinding::warning(
        channel.into(),
        Cause::Specification(SpecificationCause::FreeControlUnseen { moved_rad_s: SLOWEST_RAD_S }),
    );
    let control = Weight::ZeroPoleGain { zeros: rational.zeros, poles: rational.poles, gain: rational.gain };
    let warning = finding.with_weight(WeightRole::Control, &weights.control).at(rate);
    Ok((FeedforwardWeights { control, ..weights.clone() }, Some(warning)))
}

/// The plant with the feedback around it, its sensor and delay inside: states \[plant; controller\].
fn with_feedback(plant: &DesignPlant, feedback: &Feedback) -> Result<DesignPlant, Error> {
    let (seen, K) = (plant.measured_plant()?, feedback.controller.select(&[0], &[1]));
    let (n, k, outputs) = (seen.order(), K.order(), seen.outputs() - 1);
    let column = seen.B.block(0, plant.control, n, 1);
    let row = seen.C.block(0, 0, 1, n);
    let A = Mat::from_blocks(&[&[&seen.A, &(&column * &K.C)], &[&(&K.B * &row), &K.A]]);
    let B = seen.B.vstack(&Mat::zeros(k, seen.inputs()));
    let C = seen.C.block(1, 0, outputs, n).hstack(&Mat::zeros(outputs, k));
    let D = seen.D.block(1, 0, outputs, seen.inputs());
    let system = StateSpace::new(A, B, C, D, Timebase::Continuous)?;
    Ok(DesignPlant {
        system,
        hub_sensor: None,
        late_reading: None,
        delay_s: 0.0,
        pade_order: 0,
        ..plant.clone()
    })
}

impl Design {
    /// Returns the feedforward of a channel.
    pub fn part(&self, channel: DisturbanceChannel) -> Option<&Feedforward> {
        match channel {
            DisturbanceChannel::Heave => self.heave.as_ref(),
            DisturbanceChannel::Pitch => self.pitch.as_ref(),
        }
    }

    /// Returns the feedback controller C0 from (demand, measured rate) to the control.
    pub fn feedback_controller(&self) -> StateSpace {
        let own = || match &self.joint {
            Some(joint) => joint.controller.select(&[0], &[0, 1]),
            None => self.feedback.controller.select(&[0], &[0, 1]),
        };
        self.substitute.clone().unwrap_or_else(own)
    }

    /// Returns the feedforward module of a channel from the measured disturbance to the control.
    pub fn feedforward_controller(&self, channel: DisturbanceChannel) -> Option<StateSpace> {
        let module = &self.part(channel)?.module;
        let inputs: Vec<usize> = (0..module.inputs()).collect();
        Some(module.select(&[0], &inputs))
    }

    /// Returns the whole controller from (demand, measured rate, heave signals, pitch signals) to the control, in the assembly
    /// that the specification asks for.
    ///
    /// # Errors
    /// [`Error::Lti`].
    pub fn joint_controller(&self) -> Result<StateSpace, Error> {
        if let Some(joint) = &self.joint {
            let inputs: Vec<usize> = (0..joint.controller.inputs()).collect();
            return Ok(joint.controller.select(&[0], &inputs));
        }
        let parts = [DisturbanceChannel::Heave, DisturbanceChannel::Pitch]
            .into_iter()
            .filter_map(|channel| self.part(channel));
        let modules: Vec<StateSpace> =
            parts.map(|part| self.as_seen(&part.module)).collect::<Result<_, Error>>()?;
        self.assemble(&self.feedback_controller(), &modules)
    }

    /// Feedback from (demand, rate) and modules from their signals to (control, rate as the sensor would read it), put
    /// together in the assembly that the specification asks for; all of one timebase.
    pub(crate) fn assemble(
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
    pub(crate) fn as_seen(&self, module: &StateSpace) -> Result<StateSpace, Error> {
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
            Assembly::SimpleAdd | Assembly::Joint => 0.0,
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

    /// Returns the largest relative difference between predicted and achieved cost over the three parts; `None` if none of them
    /// has both.
    pub fn worst_cost_difference(&self) -> Option<f64> {
        let parts = [self.heave.as_ref(), self.pitch.as_ref()];
        let costs = parts.into_iter().flatten().map(|part| part.cost).chain([self.feedback.cost]);
        let costs = costs.chain(self.joint.as_ref().map(|joint| joint.cost));
        costs.filter_map(|cost| cost.relative_difference()).max_by(f64::total_cmp)
    }
}
