//! The three-part design on the reduced plant, and its sampled controller.

use counterpoise_models::plant::LinearPlant;
use counterpoise_synth::{Design, DesignPlant, Finding, Outcome, Sampled, Sampling, design, discretise};

use super::{Modelled, PipelineError, Reduced};
use crate::Project;
use crate::resolve::design::Synthesis;

/// A design with the controller that runs.
#[derive(Debug, Clone)]
pub struct Synthesised {
    /// The continuous design with its certificates.
    pub design: Design,
    /// The sampled controller and its loop.
    pub sampled: Sampled,
    /// What a designer should know.
    pub warnings: Vec<Finding>,
}

/// Designs feedback and feedforwards, and samples them.
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
    let design = solved(design(&plant, &asked.specification)?)?;
    let sampled = solved(discretise(&design, &sampling(asked, modelled))?)?;
    let warnings = design.warnings.clone();
    Ok(Synthesised { design, sampled, warnings })
}

fn solved<T>(outcome: Outcome<T>) -> Result<T, PipelineError> {
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
    let sensors = &modelled.parameters.sensors;
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

/// Volts of the output converter beyond which the control is limited: the converter's own range.
const CONVERTER_RANGE_V: f64 = 10.0;

fn sampling(asked: &Synthesis, modelled: &Modelled) -> Sampling {
    let p = &modelled.parameters;
    let moment = modelled.plant.body().out_of_balance_kg_m;
    let torque_per_volt =
        p.gearbox.ratio * p.motor.torque_constant_nm_a * p.amplifier.stall_gain_a_v(&p.motor);
    let bias_v_per_kg_m = p.gravity_m_s2 / torque_per_volt;
    let limit_v = p.amplifier.input_limit_v.min(CONVERTER_RANGE_V);
    let reach = limit_v / bias_v_per_kg_m.max(f64::MIN_POSITIVE);
    Sampling {
        method: asked.discretisation,
        delay_samples: p.interface.output_delay_samples,
        out_of_balance_kg_m: moment,
        out_of_balance_range_kg_m: (-reach, reach),
        bias_v_per_kg_m,
        transfer_time_s: asked.transfer_time_s,
        ..Sampling::new(p.interface.sample_period_s, limit_v)
    }
}
