//! The largest rate that a loop of position demands: no more than the drive can take up and brake again without saturating.
//!
//! A loop that saturates is not the loop that was verified: a large step of the demand then overshoots, and may oscillate. So the rate
//! is limited to that of a ramp whose start, and whose end, take half of the control that weight and dry friction leave, and half of
//! the rate at which the back-EMF takes the whole voltage. Within the limit the controller is the linear one, and
//! everything that is stated of it holds.

use counterpoise_controller::{DemandLimit, Parts};
use counterpoise_lti::margins;
use counterpoise_models::{AmplifierDynamics, AxisKind};
use counterpoise_project::Assumption;
use counterpoise_project::resolve::synthesis::{DesignRequest, LoopKind};
use counterpoise_synth::{Design, SampledLoop, Sampling, control_of_ramp};

use super::torque_per_volt;
use crate::tolerance::LEAST_LEFT;
use crate::{PipelineError, PlantModel};

/// Share of the available control and of the no-load rate that a ramp takes: the other half is for disturbances, and for a machine
/// that is not quite the model.
const SHARE: f64 = 0.5;
/// Duration over which a ramp's control is looked at, in periods of the loop's bandwidth over 2 pi, and of its position gain.
const RAMP_OF_BANDWIDTH: f64 = 30.0;
const RAMP_OF_POSITION_GAIN: f64 = 6.0;
/// Bandwidth of a loop whose gain never is 1, in samples.
const NO_BANDWIDTH_SAMPLES: f64 = 100.0;

/// The largest rate that a loop of position demands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DemandedRate {
    /// In rad/s, or in m/s of a linear axis.
    pub rate: f64,
    /// The origin of the limit: the file or the drive.
    pub origin: RateOrigin,
    /// Unit.
    pub unit: &'static str,
}

/// Origin of the largest demanded rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RateOrigin {
    /// The file states it.
    Stated,
    /// It follows from what the drive can take up and brake.
    Drive,
}

/// Returns the largest rate that a loop of position demands; `None` for a loop of rate, or without a limit.
///
/// # Errors
/// Those of the linear loop.
pub(crate) fn demanded_rate(
    asked: &DesignRequest,
    modelled: &PlantModel,
    design: &Design,
    sampled: &SampledLoop,
    sampling: &Sampling,
) -> Result<Option<DemandedRate>, PipelineError> {
    let p = &modelled.parameters;
    if !p.sensors.measured.is_position() || asked.rate_limit == Some(0.0) {
        return Ok(None);
    }
    let unit = match p.axis {
        AxisKind::Rotary => "rad/s",
        AxisKind::Linear => "m/s",
    };
    if let Some(rate) = asked.rate_limit {
        return Ok(Some(DemandedRate { rate, origin: RateOrigin::Stated, unit }));
    }
    let highest = margins(&sampled.loop_gain)
        .ok()
        .and_then(|found| found.phase.iter().map(|crossing| crossing.rate_rad_s).max_by(f64::total_cmp))
        .filter(|rate| *rate > 0.0);
    let of_bandwidth =
        highest.map_or(NO_BANDWIDTH_SAMPLES * sampling.period_s, |rate| RAMP_OF_BANDWIDTH / rate);
    let of_gain = asked.specification.position_gain.map_or(0.0, |gain| RAMP_OF_POSITION_GAIN / gain);
    let duration_s = of_bandwidth.max(of_gain);
    let needed = control_of_ramp(&design.plant, &sampled.controller, sampling, duration_s)?;
    let rate = (SHARE * left_v(modelled, sampling.limit_v) / needed).min(SHARE * no_load_rate(modelled));
    let is_limit = rate.is_finite() && rate > 0.0;
    Ok(is_limit.then_some(DemandedRate { rate, origin: RateOrigin::Drive, unit }))
}

/// Returns the control that weight, wherever the machine stands, and dry friction leave, V.
fn left_v(modelled: &PlantModel, limit_v: f64) -> f64 {
    let p = &modelled.parameters;
    let volts_per_nm = 1.0 / torque_per_volt(p);
    let weight_nm = modelled.plant.body().out_of_balance_kg_m * p.gravity_m_s2;
    let weight_v = modelled.linear.equilibrium.control_v.abs().max((weight_nm * volts_per_nm).abs());
    let dry_nm = p.pivot_friction.coulomb_nm() + p.gearbox.ratio * p.motor_friction.coulomb_nm();
    (limit_v - weight_v - dry_nm * volts_per_nm).max(LEAST_LEFT * limit_v)
}

/// Returns the rate at which the back-EMF takes the whole voltage of the drive; infinite for a drive that has none.
fn no_load_rate(modelled: &PlantModel) -> f64 {
    let p = &modelled.parameters;
    match p.amplifier.dynamics {
        AmplifierDynamics::Modelled => {
            p.amplifier.bus_voltage_v / (p.motor.back_emf_v_s_rad * p.gearbox.ratio).abs()
        }
        _ => f64::INFINITY,
    }
}

/// Returns the controller with the limit of what its loop of position demands.
///
/// # Errors
/// Those of the controller.
pub(crate) fn with_demand_limit(
    sampled: SampledLoop,
    asked: &DesignRequest,
    limit: Option<DemandedRate>,
) -> Result<SampledLoop, PipelineError> {
    let Some(DemandedRate { rate, .. }) = limit else { return Ok(sampled) };
    let demand_limit = match asked.specification.position_gain {
        Some(gain) if asked.loop_kind == LoopKind::Cascade => DemandLimit::Error(rate / gain),
        _ => DemandLimit::Rate(rate),
    };
    let change = |parts: &mut Parts| parts.demand_limit = Some(demand_limit);
    let controller = sampled.controller.with(change).map_err(counterpoise_synth::Error::from)?;
    Ok(SampledLoop { controller, ..sampled })
}

/// Returns the assumption that a largest demanded rate is; `None` if the file states the rate.
pub(crate) fn assumption_of_demanded_rate(limit: &DemandedRate) -> Option<Assumption> {
    (limit.origin == RateOrigin::Drive).then_some(Assumption {
        key: "synth.rate_limit".to_owned(),
        value: limit.rate,
        unit: limit.unit,
        meaning: "largest rate that the loop of position demands",
        rule: "half of what the drive can take up and brake without saturating, on a ramp of the demand",
        source: "a loop that saturates is not the one that was verified",
        usual: None,
    })
}
