//! The changes that meet a requirement that fails: the sensitivity of its figure to each weight, and the change of one weight that meets it.
//!
//! Each weight in turn is changed by 5 %, the controller designed and sampled again, and the figure measured again. The slope, in the
//! logarithm of the weight, gives the change that should be enough; that design is made and measured as well, so that what is advised
//! has been tried.

use crate::tolerance::WIDEST_ADVICE;
use counterpoise_controller::Controller;
use counterpoise_models::ControlledQuantity;
use counterpoise_project::Project;
use counterpoise_synth::{Specification, Weight};
use counterpoise_verify::robustness::{figures_of, history_of};
use counterpoise_verify::{
    LoopFigure, PerformanceFigure, Procedure, Requirement, Value, Verdict, Verification,
};

use crate::exchange::{HistoryResult, SystemResult, controllers_of};
use crate::{PipelineError, PlantModel, ReducedPlant, synthesise};

/// A change of one weight.
#[derive(Debug, Clone, PartialEq)]
pub struct WeightAdvice {
    /// The requirement that fails.
    pub requirement: Requirement,
    /// Quantity that the loop controls; the figure has its name and unit.
    pub controlled: ControlledQuantity,
    /// Figure as it is.
    pub value: f64,
    /// The sensitivity to each weight.
    pub sensitivities: Vec<WeightSensitivity>,
    /// The best change that was tried; `None` if no weight moves the figure.
    pub change: Option<TriedChange>,
}

impl WeightAdvice {
    /// Returns the figure's unit.
    pub fn unit(&self) -> &'static str {
        self.requirement.figure.unit(self.controlled)
    }
}

/// The sensitivity of a figure to a weight.
#[derive(Debug, Clone, PartialEq)]
pub struct WeightSensitivity {
    /// The weight's key in the project file.
    pub key: &'static str,
    /// Change of the figure for a weight that is e times as large.
    pub per_factor_e: f64,
    /// The design from which it was found.
    pub tried: TriedDesign,
}

/// A design with a weight changed.
#[derive(Debug, Clone, PartialEq)]
pub struct TriedDesign {
    /// By what the weight is multiplied.
    pub factor: f64,
    /// The figure then.
    pub value: f64,
    /// The controllers and the loop.
    pub systems: Vec<SystemResult>,
    /// The time history from which the figure is measured, if it is and histories were asked for.
    pub history: Option<HistoryResult>,
}

/// Designs that a trial keeps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KeptDesigns {
    /// Their linear systems.
    Systems,
    /// Their time histories as well: a run more for each.
    Histories,
}

/// A change of a weight that was tried.
#[derive(Debug, Clone, PartialEq)]
pub struct TriedChange {
    /// The weight's key in the project file.
    pub key: &'static str,
    /// By what it is multiplied.
    pub factor: f64,
    /// The figure then.
    pub value: f64,
    /// Change of the gain margin, dB.
    pub gain_margin_db: f64,
    /// `true` if the requirement holds then.
    pub holds: bool,
    /// The design.
    pub tried: TriedDesign,
}

/// A parameter of the weights.
struct WeightParameter {
    /// Key in the project file.
    key: &'static str,
    /// Multiplies it by a factor.
    scale: fn(&mut Specification, f64),
}

/// Step of the difference quotient, as a factor.
const STEP: f64 = 1.05;
/// Distance beyond the limit that is aimed at, as a share of what is missing: the figure bends.
const BEYOND: f64 = 1.15;
/// Weights whose changes are tried: those that promise to meet the requirement with the smallest change.
const TRIED: usize = 3;

/// Returns what to change for each requirement that fails with a finite figure; `kept` says what the designs that are tried carry.
///
/// # Errors
/// Those of the plant and the verification; a change that admits no controller is left out.
pub fn advise_changes(
    project: &Project,
    modelled: &PlantModel,
    reduced: &ReducedPlant,
    procedure: &Procedure,
    found: &Verification,
    kept: KeptDesigns,
) -> Result<Vec<WeightAdvice>, PipelineError> {
    let Some(asked) = project.synth.as_ref() else { return Ok(Vec::new()) };
    let trials = WeightTrials { project, modelled, reduced, procedure, kept };
    let parameters = weight_parameters(&asked.specification);
    let failing = found.verdicts.iter().filter_map(|(requirement, verdict)| match verdict {
        // the certificate is computed for the design alone, not for each one that is tried
        Verdict::Fails { .. } if matches!(requirement.figure, PerformanceFigure::Certificate(_)) => None,
        Verdict::Fails { value, .. } if value.is_finite() => Some((requirement, *value)),
        _ => None,
    });
    failing.map(|(requirement, value)| trials.advise(requirement, value, &parameters)).collect()
}

/// Returns the weights that a specification has.
fn weight_parameters(specification: &Specification) -> Vec<WeightParameter> {
    let of = |key, scale: fn(&mut Specification, f64)| WeightParameter { key, scale };
    let mut all: Vec<WeightParameter> = vec![
        of("synth.feedback.error.gain", |s, by| scale(&mut s.feedback.error, by)),
        of("synth.feedback.control.gain", |s, by| scale(&mut s.feedback.control, by)),
        of("synth.feedback.measurement_noise", |s, by| s.feedback.measurement_noise *= by),
        of("synth.feedback.loop_recovery", |s, by| s.feedback.loop_recovery *= by),
    ];
    if specification.heave.is_some() {
        all.push(of("synth.heave.error.gain", |s, by| {
            s.heave.iter_mut().for_each(|part| scale(&mut part.error, by));
        }));
    }
    if specification.pitch.is_some() {
        all.push(of("synth.pitch.error.gain", |s, by| {
            s.pitch.iter_mut().for_each(|part| scale(&mut part.error, by));
        }));
    }
    all
}

/// Multiplies a weight of any form.
fn scale(weight: &mut Weight, by: f64) {
    *weight = Weight::Product(vec![Weight::Constant { gain: by }, weight.clone()]);
}

/// A parameter of the weights and the factor on it.
struct WeightChange<'a> {
    parameter: &'a WeightParameter,
    factor: f64,
}

struct WeightTrials<'a> {
    project: &'a Project,
    modelled: &'a PlantModel,
    reduced: &'a ReducedPlant,
    procedure: &'a Procedure,
    kept: KeptDesigns,
}

impl WeightTrials<'_> {
    fn advise(
        &self,
        requirement: &Requirement,
        value: f64,
        parameters: &[WeightParameter],
    ) -> Result<WeightAdvice, PipelineError> {
        let figures = [requirement.figure, PerformanceFigure::Loop(LoopFigure::GainMargin)];
        let designed = self.design_controller(None)?;
        let before = designed.map(|controller| self.measure_figures(&figures, &controller)).transpose()?;
        let Some(before) = before.flatten() else {
            return Ok(WeightAdvice {
                requirement: requirement.clone(),
                controlled: self.project.plant.controlled_quantity(),
                value,
                sensitivities: Vec::new(),
                change: None,
            });
        };
        let (mut sensitivities, mut candidates) = (Vec::new(), Vec::new());
        for parameter in parameters {
            let Some((after, tried)) =
                self.try_change(&figures, &WeightChange { parameter, factor: STEP })?
            else {
                continue;
            };
            let slope = (after[0] - before[0]) / STEP.ln();
            sensitivities.push(WeightSensitivity { key: parameter.key, per_factor_e: slope, tried });
            let needed = BEYOND * (requirement.limit.value() - before[0]) / slope;
            if needed.is_finite() {
                candidates.push((
                    parameter,
                    needed.clamp(-WIDEST_ADVICE.ln(), WIDEST_ADVICE.ln()).exp(),
                    needed.abs(),
                ));
            }
        }
        candidates.sort_by(|a, b| a.2.total_cmp(&b.2));
        let mut best: Option<TriedChange> = None;
        for (parameter, factor, _) in candidates.into_iter().take(TRIED) {
            let Some((after, tried)) = self.try_change(&figures, &WeightChange { parameter, factor })? else {
                continue;
            };
            let holds = requirement.limit.distance_to_limit(after[0]) >= 0.0;
            let gain_margin_db = after[1] - before[1];
            let change =
                TriedChange { key: parameter.key, factor, value: after[0], gain_margin_db, holds, tried };
            let better = |old: &TriedChange| {
                (change.holds, requirement.limit.distance_to_limit(after[0]).min(0.0))
                    > (old.holds, requirement.limit.distance_to_limit(old.value).min(0.0))
            };
            if best.as_ref().is_none_or(better) {
                best = Some(change);
            }
        }
        let controlled = self.project.plant.controlled_quantity();
        Ok(WeightAdvice { requirement: requirement.clone(), controlled, value, sensitivities, change: best })
    }

    /// Returns the controller of the design with a weight changed; `None` if there is none.
    fn design_controller(
        &self,
        change: Option<&WeightChange<'_>>,
    ) -> Result<Option<Controller>, PipelineError> {
        let mut project = self.project.clone();
        if let (Some(synth), Some(change)) = (&mut project.synth, change) {
            (change.parameter.scale)(&mut synth.specification, change.factor);
        }
        match synthesise(&project, self.modelled, self.reduced) {
            Ok(made) => Ok(Some(made.sampled.controller)),
            Err(PipelineError::NoController(_)) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Returns figures of the design with a weight changed, and the design; `None` as in [`Self::measure_figures`], and without a
    /// controller.
    fn try_change(
        &self,
        figures: &[PerformanceFigure],
        change: &WeightChange<'_>,
    ) -> Result<Option<(Vec<f64>, TriedDesign)>, PipelineError> {
        let Some(controller) = self.design_controller(Some(change))? else { return Ok(None) };
        let Some(values) = self.measure_figures(figures, &controller)? else { return Ok(None) };
        let (plant, procedure) = (&self.modelled.plant, self.procedure);
        let history = match self.kept {
            KeptDesigns::Systems => None,
            KeptDesigns::Histories => history_of(plant, &controller, procedure, &figures[0])?,
        };
        let tried = TriedDesign {
            factor: change.factor,
            value: values[0],
            systems: controllers_of(plant, &controller, procedure)?,
            history: history.map(|history| HistoryResult {
                controlled: plant.parameters().controlled_quantity(),
                sample_time_s: controller.sample_period_s(),
                history,
            }),
        };
        Ok(Some((values, tried)))
    }

    /// Returns figures under a controller; `None` if one of them is not a finite number.
    fn measure_figures(
        &self,
        figures: &[PerformanceFigure],
        controller: &Controller,
    ) -> Result<Option<Vec<f64>>, PipelineError> {
        let values = figures_of(&self.modelled.plant, controller, self.procedure, figures)?;
        let number = |value: &Value| match value {
            Value::Is(number) if number.is_finite() => Some(*number),
            _ => None,
        };
        Ok(values.iter().map(number).collect())
    }
}
