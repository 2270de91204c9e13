//! The next experiment of a project's machine: the machines that a diagnosis leaves possible, and the demand that separates them best.

use counterpoise_diagnose::can_have;
use counterpoise_diagnose::experiment::{
    ExperimentPlan, ExperimentRequest, Limits, PossibleMachine, choose_experiment,
};
use counterpoise_diagnose::library::{
    Component, Effect, EffectKind, EffectName, EffectParameter, find_effects, list_effects,
};
use counterpoise_models::Parameters;
use counterpoise_pool::Pool;
use counterpoise_project::Project;
use serde::Deserialize;

use super::read::recording_controller;
use crate::PipelineError;
use crate::configuration::apply_configuration;

/// Machines that the JSON result of a diagnosis leaves possible.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct DiagnosisFindings {
    /// The findings.
    pub findings: Vec<FoundEffect>,
    /// Everything that was tried.
    #[serde(default)]
    pub hypotheses: Vec<TriedEffect>,
}

/// A finding.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct FoundEffect {
    /// Name of the effect.
    pub effect: String,
    /// Name of the component.
    pub component: String,
    /// Fitted parameters.
    #[serde(default)]
    pub parameters: Vec<NamedValue>,
    /// Effects that cannot be distinguished from it.
    #[serde(default)]
    pub alternatives: Vec<NamedEffect>,
}

/// An effect by its name.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct NamedEffect {
    /// Name of the effect.
    pub effect: String,
    /// Name of the component.
    pub component: String,
}

/// A value by its name.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct NamedValue {
    /// Name of the parameter.
    pub name: String,
    /// Value.
    pub value: f64,
}

/// An effect that was tried.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct TriedEffect {
    /// Name of the effect.
    pub effect: String,
    /// Name of the component.
    pub component: String,
    /// Effects that were fitted with it.
    #[serde(default)]
    pub beside: Vec<NamedEffect>,
    /// Fitted parameters.
    pub values: Vec<NamedValue>,
    /// Log-likelihood that it gains on held-out data.
    pub log_likelihood_gain: f64,
}

/// Effects of the library that stand for what is left if no finding says it.
const CANDIDATES: usize = 4;
/// Share of its value by which a plan without findings changes a parameter: what a drawing or a data sheet leaves open.
const CHANGE: f64 = 0.2;
/// Share of the drive's largest torque that a weight takes which a plan without findings adds.
const WEIGHT: f64 = 0.02;
/// Standard acceleration of gravity, m/s^2.
const GRAVITY: f64 = 9.80665;

/// Plans the next experiment of a project's machine within limits: from the findings of a diagnosis, or, without one, for the effects that a
/// machine of this kind most often lacks.
///
/// # Errors
/// [`PipelineError::Missing`] if the project names no recording controller, [`PipelineError::NothingToSeparate`] if fewer than two machines
/// are left, [`PipelineError::NoExperiment`] if no demand of the menu keeps the limits.
pub fn plan_experiment(
    project: &Project,
    findings: Option<&DiagnosisFindings>,
    limits: Limits,
    pool: &dyn Pool,
) -> Result<ExperimentPlan, PipelineError> {
    let controller = recording_controller(project)?.ok_or(PipelineError::Missing {
        section: "recording_controller",
        needed_by: "the plan of an experiment",
    })?;
    let plant = apply_configuration(project, &project.plant)?;
    let machines = match findings {
        Some(findings) => findings.machines(&plant),
        None => usual_machines(&plant),
    };
    if machines.len() < 2 {
        return Err(PipelineError::NothingToSeparate);
    }
    let start_angle_rad = project.model.operating_point.hub_angle_rad;
    let request = ExperimentRequest { machines: &machines, controller: &controller, start_angle_rad, limits };
    let planned = choose_experiment(&request, pool);
    if planned.experiments.is_empty() {
        return Err(PipelineError::NoExperiment);
    }
    Ok(planned)
}

/// Returns a demand as a CSV recording.
pub fn demand_csv(demand: &[f64], period_s: f64) -> String {
    let rows =
        demand.iter().enumerate().map(|(k, value)| format!("{:.6},{value:.9e}\n", k as f64 * period_s));
    std::iter::once("time [s],demand\n".to_owned()).chain(rows).collect()
}

/// Effects that a plan without findings separates: those that are most often confused.
const USUAL: [(Component, EffectName); 6] = [
    (Component::Pivot, EffectName::Coulomb),
    (Component::Pivot, EffectName::Viscous),
    (Component::Structure, EffectName::OutOfBalance),
    (Component::Structure, EffectName::Inertia),
    (Component::Motor, EffectName::TorqueConstant),
    (Component::Control, EffectName::Delay),
];

/// Returns the model as it is, and with each of the effects that machines most often lack.
fn usual_machines(plant: &Parameters) -> Vec<PossibleMachine> {
    let mut all = vec![PossibleMachine {
        name: "the model as it is".into(),
        parameters: plant.clone(),
        free: Vec::new(),
    }];
    for (component, name) in USUAL {
        let effect = find_effects(component, name).find(|effect| can_have(plant, effect));
        all.extend(effect.map(|effect| {
            let mut values = effect.values(plant);
            values[0] += match name {
                EffectName::Delay => 1.0,
                EffectName::OutOfBalance => WEIGHT * largest_torque_nm(plant) / GRAVITY,
                _ => CHANGE * values[0],
            };
            machine(plant, &[ValuedEffect { effect, values }])
        }));
    }
    all
}

/// Returns the torque at the hub that the full control gives at rest, N m.
fn largest_torque_nm(plant: &Parameters) -> f64 {
    let motor = &plant.motor;
    let current_a = FULL_V * plant.amplifier.stall_gain_a_v(motor);
    (plant.gearbox.ratio * motor.torque_constant_nm_a * current_a).min(plant.largest_hold_nm())
}

/// Full scale of the control, V.
const FULL_V: f64 = 10.0;

/// An effect with a value for each of its parameters, in their units.
#[derive(Clone)]
struct ValuedEffect {
    effect: &'static Effect,
    values: Vec<f64>,
}

/// Returns a mechanism with effects at given values; their parameters are free in a fit.
fn machine(plant: &Parameters, effects: &[ValuedEffect]) -> PossibleMachine {
    let parameters = effects.iter().fold(plant.clone(), |p, one| one.effect.apply_to(&p, &one.values));
    let name = |one: &ValuedEffect| format!("{} {}", one.effect.component, one.effect.effect);
    let names: Vec<String> = effects.iter().map(name).collect();
    let free: Vec<&'static EffectParameter> = effects.iter().flat_map(|one| one.effect.parameters).collect();
    PossibleMachine { name: names.join(" and "), parameters, free }
}

impl DiagnosisFindings {
    /// Returns the machines that the findings leave possible: with what was found, and with each alternative in its place; with the library's
    /// best candidates if nothing was identified.
    fn machines(&self, plant: &Parameters) -> Vec<PossibleMachine> {
        let known: Vec<(usize, ValuedEffect)> = self
            .findings
            .iter()
            .enumerate()
            .filter_map(|(k, found)| {
                Some((k, effect_of(&found.component, &found.effect, &found.parameters)?))
            })
            .collect();
        let found: Vec<_> = known.iter().map(|(_, effect)| effect.clone()).collect();
        let mut all = Vec::new();
        if found.is_empty() {
            all.push(PossibleMachine {
                name: "the model as it is".into(),
                parameters: plant.clone(),
                free: Vec::new(),
            });
        } else {
            all.push(machine(plant, &found));
        }
        for (place, (k, _)) in known.iter().enumerate() {
            for other in &self.findings[*k].alternatives {
                let mut effects = found.clone();
                let Some(tried) = self.best_effect(&other.component, &other.effect) else { continue };
                effects[place] = tried;
                all.push(machine(plant, &effects));
            }
        }
        if all.len() < 2 {
            all.extend(self.candidates(plant, &found));
        }
        all
    }

    /// Returns the effect of a name with the values of the trial that gained most.
    fn best_effect(&self, component: &str, effect: &str) -> Option<ValuedEffect> {
        let same = self.hypotheses.iter().filter(|h| h.component == component && h.effect == effect);
        let best = same.max_by(|a, b| a.log_likelihood_gain.total_cmp(&b.log_likelihood_gain))?;
        effect_of(component, effect, &best.values)
    }

    /// Returns the machines with the effects that explain most alone, beside what was found.
    fn candidates(&self, plant: &Parameters, found: &[ValuedEffect]) -> Vec<PossibleMachine> {
        let mut alone: Vec<&TriedEffect> = self.hypotheses.iter().filter(|h| h.beside.is_empty()).collect();
        alone.sort_by(|a, b| b.log_likelihood_gain.total_cmp(&a.log_likelihood_gain));
        let is_new = |one: &ValuedEffect| !found.iter().any(|known| std::ptr::eq(known.effect, one.effect));
        let effects = alone.iter().filter_map(|h| effect_of(&h.component, &h.effect, &h.values));
        let of = |own: ValuedEffect| machine(plant, &[found, &[own]].concat());
        effects.filter(is_new).take(CANDIDATES).map(of).collect()
    }
}

/// Returns the effect of the library with a name and these parameters; `None` if there is none, or if it is a fault of an instrument.
fn effect_of(component: &str, effect: &str, values: &[NamedValue]) -> Option<ValuedEffect> {
    let (component, name) = (Component::from_name(component)?, EffectName::from_name(effect)?);
    let fits = |e: &&'static Effect| {
        e.parameters.len() == values.len() && e.parameters.iter().zip(values).all(|(p, v)| p.name == v.name)
    };
    let found = find_effects(component, name).find(fits)?;
    let is_physics =
        found.kind != EffectKind::Instrument || list_effects().iter().any(|e| std::ptr::eq(*e, found));
    is_physics.then(|| ValuedEffect { effect: found, values: values.iter().map(|v| v.value).collect() })
}
