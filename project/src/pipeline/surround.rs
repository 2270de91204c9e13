//! What surrounds the design's paths in the controller: the demand's prefilter, friction observers, the estimator.

use counterpoise_controller::{Estimator, FrictionObserver, Parts, Signal};
use counterpoise_lti::{StateSpace, c2d};
use counterpoise_models::{Friction, FrictionLaw, Parameters};
use counterpoise_synth::{
    DesignPlant, Drive, Identified, Sampled, Sampling, Side, check, friction_observers,
};

use super::synth::{solved, torque_per_volt};
use super::{Modelled, PipelineError};
use crate::resolve::around::{Adaptation, AdaptationMethod, Levels, ObserverAsked};
use crate::resolve::design::Synthesis;

/// Stiffness at rest; a law without one breaks away within this angle in the observer, rad.
const BREAKAWAY_RAD: f64 = 5e-4;
/// Smallest out-of-balance from which the estimator takes the size of its first parameter, kg m.
const SMALL_KG_M: f64 = 10.0;

/// The sampled controller with what surrounds its paths, checked anew.
///
/// # Errors
/// Those of the controller.
pub(crate) fn surrounded(
    sampled: Sampled,
    (asked, modelled): (&Synthesis, &Modelled),
    (plant, sampling): (&DesignPlant, &Sampling),
) -> Result<Sampled, PipelineError> {
    let prefilter = prefilter(asked, sampling)?;
    let observers = match &asked.around.observer {
        Some(observer) => observers(observer, &modelled.parameters)?,
        None => Vec::new(),
    };
    let adaptation = asked.around.adaptation.as_ref();
    let estimator = adaptation.and_then(|adaptation| estimator(adaptation, modelled));
    if prefilter.is_none() && observers.is_empty() && estimator.is_none() {
        return Ok(sampled);
    }
    let change = |parts: &mut Parts| {
        (parts.prefilter, parts.observers, parts.estimator) = (prefilter, observers, estimator);
    };
    let controller = sampled.controller.with(change).map_err(counterpoise_synth::Error::from)?;
    solved(check(plant, controller, sampling)?)
}

fn prefilter(asked: &Synthesis, sampling: &Sampling) -> Result<Option<StateSpace>, PipelineError> {
    let Some(weight) = &asked.around.prefilter else { return Ok(None) };
    Ok(Some(c2d(&weight.realise()?, sampling.period_s, sampling.method)?))
}

/// Observers of the friction at motor and pivot: the identified levels, or the plant's.
fn observers(asked: &ObserverAsked, p: &Parameters) -> Result<Vec<FrictionObserver>, PipelineError> {
    let sides = [
        ("friction_pivot", Side::Load, asked.pivot, &p.pivot_friction),
        ("friction_motor", Side::Motor, asked.motor, &p.motor_friction),
    ];
    let identified: Vec<Identified> = sides
        .into_iter()
        .map(|(name, side, given, friction)| {
            identified(name, side, given.unwrap_or_else(|| of_plant(friction)))
        })
        .filter(|one| one.coulomb_nm > 0.0)
        .collect();
    let drive = Drive { ratio: p.gearbox.ratio, stall_nm_v: torque_per_volt(p) };
    Ok(friction_observers(&identified, drive, asked.drives, asked.share)?)
}

fn identified(name: &str, side: Side, levels: Levels) -> Identified {
    Identified {
        name: name.to_owned(),
        side,
        coulomb_nm: levels.coulomb_nm,
        rest_stiffness_nm_rad: levels.rest_stiffness_nm_rad,
        viscous_nm_s_rad: 0.0,
    }
}

fn of_plant(friction: &Friction) -> Levels {
    let rest_stiffness_nm_rad = rest_stiffness_nm_rad(&friction.law);
    Levels { coulomb_nm: friction.coulomb_nm(), rest_stiffness_nm_rad }
}

/// The stiffness at rest with which an observer stands for a law; of a law without one, what lets it break away within
/// half a milliradian.
pub(crate) fn rest_stiffness_nm_rad(law: &FrictionLaw) -> f64 {
    match law {
        FrictionLaw::Dahl { rest_stiffness_nm_rad, .. } => *rest_stiffness_nm_rad,
        FrictionLaw::Lugre { bristle_stiffness_nm_rad, .. } => *bristle_stiffness_nm_rad,
        FrictionLaw::None => 0.0,
        FrictionLaw::Coulomb { coulomb_nm }
        | FrictionLaw::ResetIntegrator { coulomb_nm, .. }
        | FrictionLaw::Stribeck { coulomb_nm, .. }
        | FrictionLaw::Karnopp { coulomb_nm, .. }
        | FrictionLaw::Walrath { coulomb_nm, .. }
        | FrictionLaw::Bristle { coulomb_nm, .. } => coulomb_nm / BREAKAWAY_RAD,
    }
}

/// The estimator that is part of the controller; none for the methods that run beside it.
fn estimator(adaptation: &Adaptation, modelled: &Modelled) -> Option<Estimator> {
    if adaptation.method != AdaptationMethod::Gradient {
        return None;
    }
    let p = &modelled.parameters;
    let volts = 1.0 / torque_per_volt(p);
    let moment = modelled.plant.body().out_of_balance_kg_m.abs().max(SMALL_KG_M);
    let ratio = p.gearbox.ratio;
    let dry = p.pivot_friction.coulomb_nm() + ratio * p.motor_friction.coulomb_nm();
    let viscous = p.pivot_friction.viscous_nm_s_rad + ratio * ratio * p.motor_friction.viscous_nm_s_rad;
    Some(Estimator {
        gravity_m_s2: p.gravity_m_s2,
        rate: Signal::RelativeRate,
        half_rate_rad_s: adaptation.half_rate_rad_s,
        step: adaptation.step,
        scale: [moment * volts, dry * volts, viscous * volts],
        volts_per_kg_m_s2: volts,
        rate_limit_kg_m_s: adaptation.rate_limit_kg_m_s,
    })
}
