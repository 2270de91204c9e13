//! The effect of each assumption of a project: the design as it stands, on plants in which one assumed value is wrong by its
//! usual range.

use counterpoise_models::plant::Plant;
use counterpoise_pool::{Pool, map_all};
use counterpoise_project::{Assumption, Project};
use counterpoise_verify::{Arrangement, LoopFigure, PerformanceFigure, Procedure, Source, frequency_figures};
use serde::Serialize;

use crate::exchange::{VerifiedLoop, plants_of, verified_loop};
use crate::synth::demanded_rate::assumption_of_demanded_rate;
use crate::{PipelineError, PlantModel, SynthesisedDesign, build_plant_model};

/// Frequency at which the residual of heave and pitch is compared, Hz: within the band that feedback and feedforward reject.
const RESIDUAL_HZ: f64 = 1.0;

/// Effect of an assumption on the loop.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AssumptionEffect {
    /// Path of the absent key.
    pub key: String,
    /// The assumed value.
    pub value: f64,
    /// Unit.
    pub unit: &'static str,
    /// Effects at the lowest and at the highest usual value.
    pub at: [EffectAtValue; 2],
    /// Largest change of gain margin, sensitivity or residual, dB; infinite if the loop becomes unstable.
    pub largest_change_db: f64,
}

/// The loop at one value of an assumed quantity. Changes are those from the loop at the assumed value.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectAtValue {
    /// The value.
    pub value: f64,
    /// `true` if the closed loop is stable there.
    pub is_stable: bool,
    /// Change of the gain margin, dB; `None` if one of the two has none.
    pub gain_margin_change_db: Option<f64>,
    /// Change of the phase margin, degrees.
    pub phase_margin_change_deg: Option<f64>,
    /// Change of the largest sensitivity, dB.
    pub sensitivity_change_db: Option<f64>,
    /// Largest change of the hub rate that heave or pitch leaves, dB.
    pub residual_change_db: Option<f64>,
    /// The plant there; absent if none can be built, or if the systems are left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured_on: Option<VerifiedLoop>,
}

/// Systems of a loop from which the effects of a result can be recomputed, if the result contains them. They are asked for by whoever writes
/// the result for another program: two sampled plants for each assumption take as long as the effects themselves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoopSystems {
    /// The plants at both ends of each usual range, and the loop at the assumed values.
    Included,
    /// None.
    LeftOut,
}

/// The effects of assumptions, with the loop from which they are counted.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct AssumptionEffects {
    /// The effects, the largest first.
    pub effects: Vec<AssumptionEffect>,
    /// The loop at the assumed values; `None` without effects, or if the systems are left out.
    pub assumed_loop: Option<VerifiedLoop>,
}

/// Figures of one loop.
#[derive(Debug, Clone, Copy)]
struct LoopFigures {
    is_stable: bool,
    gain_margin_db: Option<f64>,
    phase_margin_deg: Option<f64>,
    sensitivity_db: Option<f64>,
    residual_db: [Option<f64>; 2],
}

/// Returns the effect of each assumption that has a usual range, the largest first: what is first is worth measuring next.
///
/// The controller is the one that was designed with the assumed values; the plant alone is varied, linearised where it stands.
///
/// # Errors
/// Those of the linear verification at the assumed values. A value at which no plant can be built counts as unstable.
pub fn assumption_effects(
    project: &Project,
    modelled: &PlantModel,
    synthesised: &SynthesisedDesign,
    assumptions: &[Assumption],
    systems: LoopSystems,
    pool: &dyn Pool,
) -> Result<AssumptionEffects, PipelineError> {
    let procedure = Procedure {
        operating_point: project.model.operating_point,
        friction: project.model.friction,
        rejection_hz: vec![RESIDUAL_HZ],
        ..Procedure::default()
    };
    let controller = &synthesised.sampled.controller;
    let is_included = systems == LoopSystems::Included;
    let nominal = figures(&modelled.plant, synthesised, &procedure)?;
    let effect = |assumption: &Assumption| {
        let [low, high] = assumption.usual?;
        let at = |value: f64| {
            let changed = project.with_number(&assumption.key, value)?;
            let made = build_plant_model(&changed).ok();
            let varied = made.as_ref().and_then(|made| figures(&made.plant, synthesised, &procedure).ok());
            let plants = |made: PlantModel| plants_of(&made.plant, controller, &procedure).ok();
            let measured_on = made.filter(|_| is_included).and_then(plants);
            Some(EffectAtValue { measured_on, ..compare_figures(value, varied, nominal) })
        };
        let at = [at(low)?, at(high)?];
        let largest_change_db = at.iter().map(largest).fold(0.0, f64::max);
        let (key, value, unit) = (assumption.key.clone(), assumption.value, assumption.unit);
        Some(AssumptionEffect { key, value, unit, at, largest_change_db })
    };
    let found = map_all(pool, assumptions.len(), |k| effect(&assumptions[k]));
    let mut effects: Vec<AssumptionEffect> = found.into_iter().flatten().collect();
    effects.sort_by(|a, b| b.largest_change_db.total_cmp(&a.largest_change_db));
    let assumed = || verified_loop(&modelled.plant, controller, &procedure);
    let assumed_loop = (is_included && !effects.is_empty()).then(assumed).transpose()?;
    Ok(AssumptionEffects { effects, assumed_loop })
}

/// Returns what a file leaves open, and what its design assumes beside.
pub fn with_those_of_design(assumptions: &[Assumption], synthesised: &SynthesisedDesign) -> Vec<Assumption> {
    let of_design = synthesised.demanded_rate.as_ref().and_then(assumption_of_demanded_rate);
    assumptions.iter().cloned().chain(of_design).collect()
}

fn figures(
    plant: &Plant,
    synthesised: &SynthesisedDesign,
    procedure: &Procedure,
) -> Result<LoopFigures, PipelineError> {
    let found = frequency_figures(plant, &synthesised.sampled.controller, procedure)?;
    let of = |figure| found.value(PerformanceFigure::Loop(figure)).filter(|value| value.is_finite());
    let residual = |source| {
        let figure = PerformanceFigure::Rejection {
            source,
            arrangement: Arrangement::Compensated,
            frequency_hz: RESIDUAL_HZ,
        };
        found.value(figure).filter(|value| value.is_finite())
    };
    Ok(LoopFigures {
        is_stable: found.is_stable,
        gain_margin_db: of(LoopFigure::GainMargin),
        phase_margin_deg: of(LoopFigure::PhaseMargin),
        sensitivity_db: of(LoopFigure::MaxSensitivity).map(|ms| 20.0 * ms.log10()),
        residual_db: [residual(Source::Heave), residual(Source::Pitch)],
    })
}

/// Returns the changes from the nominal loop to another; `None` for a plant that cannot be built.
fn compare_figures(value: f64, varied: Option<LoopFigures>, nominal: LoopFigures) -> EffectAtValue {
    let change = |of: fn(&LoopFigures) -> Option<f64>| Some(of(varied.as_ref()?)? - of(&nominal)?);
    let residuals = [change(|f| f.residual_db[0]), change(|f| f.residual_db[1])];
    EffectAtValue {
        value,
        is_stable: varied.is_some_and(|f| f.is_stable),
        gain_margin_change_db: change(|f| f.gain_margin_db),
        phase_margin_change_deg: change(|f| f.phase_margin_deg),
        sensitivity_change_db: change(|f| f.sensitivity_db),
        residual_change_db: residuals.into_iter().flatten().max_by(|a, b| a.abs().total_cmp(&b.abs())),
        measured_on: None,
    }
}

fn largest(at: &EffectAtValue) -> f64 {
    if !at.is_stable {
        return f64::INFINITY;
    }
    let changes = [at.gain_margin_change_db, at.sensitivity_change_db, at.residual_change_db];
    changes.into_iter().flatten().map(f64::abs).fold(0.0, f64::max)
}
