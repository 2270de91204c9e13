//! The three-part design on the reduced plant, and its sampled controller.

pub(crate) mod controller_blocks;
pub mod friction_observers;
pub mod schedule;

use counterpoise_lti::{Mat, StateSpace, Timebase, series};
use counterpoise_models::Parameters;
use counterpoise_models::plant::LinearPlant;
use counterpoise_reduce::{ControllerReduction, Method as Truncation, Order, reduce_controller};
use counterpoise_synth::{
    Alternative, Channel, Design, DesignPlant, Entry, Finding, Method, Outcome, Reference, Sampled, Sampling,
    alternative, design, discretise, discretise_schedule,
};

use crate::model::CONVERTER_RANGE_V;
use crate::synth::controller_blocks::{designed_on, surrounded};
use crate::{Modelled, PipelineError, Reduced};
use counterpoise_project::Project;
use counterpoise_project::resolve::design::Synthesis;

/// A design with the controller that runs.
#[derive(Debug, Clone)]
pub struct Synthesised {
    /// The continuous design with its certificates.
    pub design: Design,
    /// The sampled controller and its loop.
    pub sampled: Sampled,
    /// What a designer should know.
    pub warnings: Vec<Finding>,
    /// How it is sampled.
    pub sampling: Sampling,
    /// The other method that made the feedback, where the project names one.
    pub other: Option<Alternative>,
    /// What was left out of the feedback to reach its order, where the project asks for one.
    pub lowered: Option<Lowered>,
    /// The designs over out-of-balance, nominal first; empty without schedule.
    pub balance: Vec<Entry>,
}

/// A feedback of lower order, and the one before it.
#[derive(Debug, Clone)]
pub struct Lowered {
    /// The feedback before.
    pub before: StateSpace,
    /// The reduction from the error, and what it does to the loop.
    pub reduction: ControllerReduction,
}

/// Designs feedback and feedforwards, and samples them with what surrounds them.
///
/// # Errors
/// [`PipelineError::NoController`] with every reason, and those of the plant and the design.
pub fn synthesise(
    project: &Project,
    modelled: &Modelled,
    reduced: &Reduced,
) -> Result<Synthesised, PipelineError> {
    let asked =
        project.synth.as_ref().ok_or(PipelineError::Missing { section: "synth", needed_by: "the design" })?;
    let plant = design_plant(asked, modelled, reduced)?;
    let mut design = solved(design(&plant, &asked.specification)?)?;
    let other = by_method(asked, &mut design)?;
    let lowered = asked.around.controller_order.map(|order| lower(&mut design, order)).transpose()?;
    let sampling = sampling(asked, modelled)?;
    let balance = match &asked.around.schedule {
        Some(wanted) => schedule::balance(project, asked, (modelled, wanted))?,
        None => Vec::new(),
    };
    let sampled = match &asked.around.schedule {
        Some(wanted) if schedule::redesigns(wanted, &balance) && design.part(Channel::Heave).is_some() => {
            solved(discretise_schedule(&design, schedule::interpolated(wanted, &balance), &sampling)?)?
        }
        _ => solved(discretise(&design, &sampling)?)?,
    };
    let sampled = surrounded(sampled, (asked, modelled), (&plant, &sampling))?;
    let warnings = design.warnings.clone();
    Ok(Synthesised { design, sampled, warnings, sampling, other, lowered, balance })
}

/// Puts the feedback of another method in place of the three-part one, where the project names one.
fn by_method(asked: &Synthesis, design: &mut Design) -> Result<Option<Alternative>, PipelineError> {
    let method = asked.around.method;
    if method == Method::ThreePart {
        return Ok(None);
    }
    sees_the_error_alone(design, "method")?;
    let made = solved(alternative(&design.plant, &asked.specification.feedback, method)?)?;
    design.substitute = Some(made.controller.clone());
    Ok(Some(made))
}

/// Puts a feedback of lower order in place of the design's, by frequency-weighted balancing that keeps the loop.
fn lower(design: &mut Design, order: usize) -> Result<Lowered, PipelineError> {
    sees_the_error_alone(design, "controller_order")?;
    let before = design.feedback_controller();
    let seen = design.plant.measured()?.select(&[0], &[design.plant.control]);
    let from_error = before.select(&[0], &[0]);
    let reduction = reduce_controller(&seen, &from_error, Order::States(order), Truncation::MatchDc)?;
    let difference = StateSpace::gain(Mat::row(&[1.0, -1.0]), Timebase::Continuous)?;
    design.substitute = Some(series(&difference, &reduction.reduction.system)?);
    Ok(Lowered { before, reduction })
}

fn sees_the_error_alone(design: &Design, key: &'static str) -> Result<(), PipelineError> {
    match design.specification.reference {
        Reference::Error => Ok(()),
        Reference::WeightOnly => Err(PipelineError::NeedsError { key }),
    }
}

pub(crate) fn solved<T>(outcome: Outcome<T>) -> Result<T, PipelineError> {
    match outcome {
        Outcome::Solved(solution) => Ok(solution),
        Outcome::Infeasible(reasons) => Err(PipelineError::NoController(reasons)),
    }
}

/// The plant as the design sees it: the reduced plant, the sensors, the loop's delay.
pub fn design_plant(
    asked: &Synthesis,
    modelled: &Modelled,
    reduced: &Reduced,
) -> Result<DesignPlant, PipelineError> {
    let sensors = designed_on(asked, &modelled.parameters.sensors);
    Ok(DesignPlant {
        system: reduced.system.clone(),
        control: LinearPlant::CONTROL,
        heave: vec![LinearPlant::HEAVE],
        pitch: vec![LinearPlant::PITCH_RATE],
        rate: LinearPlant::HUB_RATE,
        hub_sensor: Some(sensors.hub_gyro.dynamics()?),
        heave_sensor: Some(sensors.platform_accelerometer.dynamics()?),
        pitch_sensor: Some(sensors.platform_gyro.dynamics()?),
        delay_s: asked.delay_samples * modelled.parameters.interface.sample_period_s,
        pade_order: asked.pade_order,
    })
}

pub(crate) fn sampling(asked: &Synthesis, modelled: &Modelled) -> Result<Sampling, PipelineError> {
    let p = &modelled.parameters;
    let moment = modelled.plant.body().out_of_balance_kg_m;
    let volts_per_nm = 1.0 / torque_per_volt(p);
    let bias_v_per_kg_m = p.gravity_m_s2 * volts_per_nm;
    let limit_v = p.amplifier.input_limit_v.min(CONVERTER_RANGE_V);
    let felt_m_s2 = if p.gravity_m_s2 == 0.0 { STANDARD_GRAVITY_M_S2 } else { p.gravity_m_s2 };
    let reach = limit_v / (volts_per_nm * felt_m_s2);
    if moment.abs() > reach {
        let needed_v = moment.abs() * volts_per_nm * felt_m_s2;
        return Err(PipelineError::CannotHold { moment_kg_m: moment, needed_v, limit_v });
    }
    Ok(Sampling {
        method: asked.discretisation,
        form: asked.form,
        delay_samples: p.interface.output_delay_samples,
        out_of_balance_kg_m: moment,
        out_of_balance_range_kg_m: (-reach, reach),
        bias_v_per_kg_m,
        transfer_time_s: asked.transfer_time_s,
        ..Sampling::new(p.interface.sample_period_s, limit_v)
    })
}

/// The acceleration that an out-of-balance is judged by where no gravity acts on it, m/s^2.
const STANDARD_GRAVITY_M_S2: f64 = 9.80665;

/// Torque at the stalled hub for one volt of control, N m/V.
pub(crate) fn torque_per_volt(p: &Parameters) -> f64 {
    p.gearbox.ratio * p.motor.torque_constant_nm_a * p.amplifier.stall_gain_a_v(&p.motor)
}
