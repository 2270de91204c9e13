//! From a search to an answer: verdict, findings with their intervals, what the recordings cannot tell.

use crate::findings::answer::{
    Answer, DiagnosisVerdict, Finding, FindingBasis, FitTable, FittedParameter, Hypothesis, HypothesisValue,
    Name, NearestEffect, NextExperiment, Pattern, SearchWarning, UnexcitedEffect,
};
use crate::findings::channel_fits::fits_by_channel;
use crate::fitting::output_error::{confidence_intervals, parameters_of};
use crate::fitting::score::{RecordingPart, score_parts};
use crate::library::{Component, Effect, EffectName, EffectParameter};
use crate::localisation::error_hypotheses::COMPONENTS;
use crate::localisation::error_map::{MapCell, rank_components};
use crate::localisation::torque_balances::BalanceVisibility;
use crate::recording::remarks::RecordingRemark;
use crate::recording::series::correlation_time;
use crate::selection::candidate::FittedCandidate;
use crate::selection::outcome::SearchOutcome;
use crate::selection::signature::EffectSignature;
use crate::selection::sizes::Sizes;
use crate::simulator_access::SimulatorAccess;
use crate::tolerance::findings::{EXCITED_MULTIPLE, LEAST_DISTANCE, LEAST_INFORMATION};
use crate::tolerance::findings::{LARGEST_REPORTED_MULTIPLE, SMALL_TRAVEL_RAD, WHOLE_SAMPLES};
use crate::tolerance::{
    AMBIGUOUS, EXPLAINED, FITTED_SHARE, GAIN_NEEDED, RIGHT_OF_TEXTBOOK, RIGHT_OF_THREE, RIGHT_OF_UNKNOWN,
    RIGHT_WHERE_EXPLAINED, RIGHT_WHERE_INCOMPLETE, RIVAL_DECAY, SHARE_TO_NAME, TEXTBOOK_SHARE_TO_NAME,
};
use counterpoise_models::{AxisKind, Parameters};

/// Evidence from which the answer is derived.
pub struct VerdictEvidence<'a> {
    /// Simulator and recordings.
    pub simulator: &'a dyn SimulatorAccess,
    /// The mechanism as the project file has it.
    pub base: &'a Parameters,
    /// The search.
    pub search: &'a SearchOutcome,
    /// Component x regime.
    pub map: Vec<MapCell>,
    /// Balances that the sensors allow.
    pub isolability: Vec<BalanceVisibility>,
    /// Remarks on the recordings themselves.
    pub remarks: Vec<RecordingRemark>,
    /// Known sizes of the machine.
    pub sizes: Sizes,
}

impl VerdictEvidence<'_> {
    /// Derives the answer.
    pub fn answer(self) -> Answer {
        let verdict = self.verdict();
        let findings = self.findings(verdict);
        let warnings = self.warnings();
        Answer {
            verdict,
            next_experiment: self.next_experiment(verdict, &findings),
            findings,
            fit: self.fit_table(),
            not_excited: not_excited(self.search.stages.first().map_or(&[], |s| &s.signatures)),
            hypotheses: self.hypotheses(),
            isolability: self.isolability,
            map: self.map,
            remarks: self.remarks,
            warnings,
            learned: None,
        }
    }

    /// Returns the mechanism with the found effects, or as it was.
    pub fn improved_mechanism(&self) -> Parameters {
        self.named_model().map_or_else(|| self.base.clone(), |c| c.fit.parameters.clone())
    }

    /// Returns the verdict.
    pub(crate) fn verdict(&self) -> DiagnosisVerdict {
        let Some(accepted) = self.named_model() else {
            let explained = self.search.baseline.score.largest_excess() < EXPLAINED;
            return if explained { DiagnosisVerdict::Consistent } else { DiagnosisVerdict::Unknown };
        };
        let ambiguous = (0..accepted.fit.effects.len()).any(|i| !self.alternatives(accepted, i).is_empty());
        match (accepted.whole.largest_excess() < EXPLAINED, ambiguous) {
            (true, false) => DiagnosisVerdict::Named,
            (true, true) => DiagnosisVerdict::Ambiguous,
            (false, _) => DiagnosisVerdict::Incomplete,
        }
    }

    /// Returns the accepted model if it explains enough of the mismatch to be named: all of it, or most of it within its bounds. A
    /// parameter that went to a bound to explain a part stands for something else.
    pub(crate) fn named_model(&self) -> Option<&FittedCandidate> {
        let accepted = self.search.accepted.as_ref()?;
        let textbook =
            !self.sizes.typical && accepted.power_share(&self.search.baseline.score) > TEXTBOOK_SHARE_TO_NAME;
        let most = accepted.is_within_bounds() && self.share(accepted) > SHARE_TO_NAME;
        (accepted.explains() || most || textbook).then_some(accepted)
    }

    /// Returns the share of the mismatch that a model explains: of the distance from the noise floor, or, on a machine with textbook values,
    /// of the residual's power.
    fn share(&self, model: &FittedCandidate) -> f64 {
        if !self.sizes.typical {
            // far above the floor, what matters is how much of the error is gone
            return model.power_share(&self.search.baseline.score);
        }
        let before = self.search.baseline.score.distance().max(LEAST_DISTANCE);
        1.0 - model.whole.distance() / before
    }

    /// Returns the effects that explain the recordings as well as the effect at `index` does.
    fn alternatives(&self, accepted: &FittedCandidate, index: usize) -> Vec<Name> {
        let Some(rivals) = self.search.rivals.get(index) else { return Vec::new() };
        let chosen = accepted.fit.effects[index];
        let best = rivals.iter().find(|r| r.newest_effect().is_some_and(|e| same_name(e, chosen)));
        let best = best.unwrap_or(accepted);
        let mut names: Vec<Name> = Vec::new();
        for rival in rivals.iter().filter(|r| r.log_likelihood_deficit(best) < AMBIGUOUS) {
            let Some(effect) = rival.newest_effect().filter(|e| !same_name(e, chosen)) else { continue };
            let name = Name { effect: effect.effect, component: effect.component };
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names.extend(self.structural_equivalent(accepted, index).filter(|name| !names.contains(name)));
        names
    }

    /// Returns the effect that acts as another one does whatever is recorded: on a platform that stands still, and over a small travel, a mass
    /// above or below the pivot pulls back or pushes away as a spring does; and beside one sensor alone, whole samples by which its reading is
    /// late are those by which the control is.
    fn structural_equivalent(&self, accepted: &FittedCandidate, index: usize) -> Option<Name> {
        let effect = accepted.fit.effects[index];
        let sensors = &self.base.sensors;
        let stands_still = !sensors.platform_gyro.is_fitted() && self.base.axis == AxisKind::Rotary;
        let small = self.simulator.travel_rad() < SMALL_TRAVEL_RAD;
        let alone = !sensors.platform_gyro.is_fitted()
            && sensors.motor_tachometer.is_none()
            && sensors.hub_resolver.is_none();
        let first = parameters_of(&accepted.fit.effects[..index]).len();
        let late_samples = accepted.fit.values[first] / self.base.interface.sample_period_s;
        let whole = (late_samples - late_samples.round()).abs() < WHOLE_SAMPLES && late_samples.round() > 0.0;
        let (component, other, holds) = match (effect.component, effect.effect) {
            (Component::Structure, EffectName::VerticalOffset) => {
                (Component::Structure, EffectName::PositionStiffness, stands_still && small)
            }
            (Component::Structure, EffectName::PositionStiffness) => {
                (Component::Structure, EffectName::VerticalOffset, stands_still && small)
            }
            (Component::Control, EffectName::Delay) => (Component::HubGyro, EffectName::Delay, alone),
            (Component::HubGyro, EffectName::Delay) => {
                (Component::Control, EffectName::Delay, alone && whole)
            }
            _ => return None,
        };
        holds.then_some(Name { effect: other, component })
    }

    fn probability(&self, accepted: &FittedCandidate, index: usize) -> f64 {
        let rivals = self.search.rivals.get(index).map_or(&[][..], Vec::as_slice);
        let chosen = accepted.fit.effects[index];
        let best = rivals.iter().find(|r| r.newest_effect().is_some_and(|e| same_name(e, chosen)));
        let best = best.unwrap_or(accepted);
        let others = rivals.iter().filter(|r| r.newest_effect().is_some_and(|e| !same_name(e, chosen)));
        let weight: f64 =
            others.map(|r| (-RIVAL_DECAY * r.log_likelihood_deficit(best).max(0.0)).exp()).sum();
        // what acts alike whatever is recorded is as probable, however its fit went
        let weight =
            if self.structural_equivalent(accepted, index).is_some() { weight.max(1.0) } else { weight };
        self.ceiling(accepted) / (1.0 + weight)
    }

    /// Returns the probability that a name without a rival is true, by how well the model explains the recordings.
    fn ceiling(&self, accepted: &FittedCandidate) -> f64 {
        let explained = accepted.whole.largest_excess() < EXPLAINED;
        match (explained, accepted.fit.effects.len()) {
            (true, ..3) if self.sizes.typical => RIGHT_WHERE_EXPLAINED,
            (true, ..3) => RIGHT_OF_TEXTBOOK,
            (true, _) => RIGHT_OF_THREE,
            (false, _) => RIGHT_WHERE_INCOMPLETE,
        }
    }

    fn findings(&self, verdict: DiagnosisVerdict) -> Vec<Finding> {
        match (self.named_model(), verdict) {
            (Some(accepted), _) => {
                (0..accepted.fit.effects.len()).map(|i| self.finding(accepted, i)).collect()
            }
            (None, DiagnosisVerdict::Unknown) => vec![self.unknown_finding()],
            _ => Vec::new(),
        }
    }

    fn finding(&self, accepted: &FittedCandidate, index: usize) -> Finding {
        let effect = accepted.fit.effects[index];
        let parameters = self.fitted_parameters(accepted, index);
        Finding {
            effect: effect.effect,
            component: effect.component,
            probability: self.probability(accepted, index),
            basis: FindingBasis::FittedEffect {
                worst_before: self.search.baseline.score.largest_excess(),
                worst_after: accepted.whole.largest_excess(),
            },
            parameters,
            alternatives: self.alternatives(accepted, index),
        }
    }

    fn fitted_parameters(&self, accepted: &FittedCandidate, index: usize) -> Vec<FittedParameter> {
        let first = parameters_of(&accepted.fit.effects[..index]).len();
        let effect = accepted.fit.effects[index];
        let (samples, inflation) = self.worth(accepted);
        let bounds = confidence_intervals(&accepted.fit, samples, inflation);
        let one = |(j, definition): (usize, &EffectParameter)| {
            let wrap =
                if effect.is_ripple() && j == 2 { whole_turns(accepted.fit.values[first + j]) } else { 0.0 };
            FittedParameter {
                name: definition.name,
                value: accepted.fit.values[first + j] - wrap,
                unit: definition.unit,
                before: definition.read(self.base),
                ci95: bounds[first + j].map(|b| b - wrap),
            }
        };
        effect.parameters.iter().enumerate().map(one).collect()
    }

    /// Returns the number of residuals, and how many of them carry the information of one.
    fn worth(&self, accepted: &FittedCandidate) -> (usize, f64) {
        let parameters = &accepted.fit.parameters;
        let mut samples = 0;
        let mut independent = 0.0;
        for index in 0..self.simulator.count() {
            let judged = match accepted.assessments.get(index) {
                Some(near) => self.simulator.assess_from(parameters, index, near),
                None => self.simulator.assess(parameters, index),
            };
            for channel in judged.map(|j| j.channels).unwrap_or_default() {
                samples += channel.residual.len();
                independent += channel.residual.len() as f64 / correlation_time(&channel.residual);
            }
        }
        (samples, samples as f64 / independent.max(1.0))
    }

    fn unknown_finding(&self) -> Finding {
        let places = rank_components(&self.map);
        let (component, others) =
            places.split_first().map_or((Component::Unknown, &[][..]), |(first, others)| (*first, others));
        let tried = self.search.stages.first().map_or(&[][..], |s| &s.candidates);
        let left = FittedCandidate::held_out_power_share;
        let alone = tried.iter().filter(|c| c.fit.effects.len() == 1);
        let nearest = alone.min_by(|a, b| left(a).total_cmp(&left(b))).and_then(|c| {
            let effect = c.newest_effect()?;
            let name = Name { effect: effect.effect, component: effect.component };
            Some(NearestEffect { name, share: 1.0 - left(c) })
        });
        let unknown = |component: &Component| Name { effect: EffectName::Unknown, component: *component };
        Finding {
            effect: EffectName::Unknown,
            component,
            probability: RIGHT_OF_UNKNOWN * self.place_probability(component),
            basis: FindingBasis::NoKnownEffect { pattern: self.pattern(component), nearest },
            parameters: Vec::new(),
            alternatives: others.iter().map(unknown).collect(),
        }
    }

    /// Returns the probability of a component among all, by what an error at each explains of held-out stretches.
    fn place_probability(&self, component: Component) -> f64 {
        let gain = |of: Component| {
            let cells = self.map.iter().filter(|cell| cell.component == of);
            cells.map(|cell| cell.log_likelihood_gain).fold(0.0, f64::max)
        };
        let own = gain(component);
        let weight = |other: &Component| (RIVAL_DECAY * (gain(*other) - own).min(0.0)).exp();
        let rivals: f64 = COMPONENTS.iter().filter(|other| **other != component).map(weight).sum();
        1.0 / (1.0 + rivals)
    }

    /// Returns what the mismatch depends on, as an error at a component.
    fn pattern(&self, component: Component) -> Option<Pattern> {
        let here = self.map.iter().filter(|cell| cell.component == component);
        let cell = here.max_by(|a, b| a.log_likelihood_gain.total_cmp(&b.log_likelihood_gain))?;
        Some(Pattern { regime: cell.regime, explained: cell.explained, trend: cell.trend })
    }

    fn fit_table(&self) -> FitTable {
        let before = fits_by_channel(&self.search.baseline.score);
        let Some(accepted) = self.named_model() else {
            // the model is what it was: of held-out data it leaves what it left before
            let fitted = &self.search.baseline.fitted;
            let parts: Vec<RecordingPart> = (0..fitted.len())
                .map(|recording| RecordingPart { recording, from: FITTED_SHARE, to: 1.0 })
                .collect();
            let held_out = score_parts(fitted, &parts).as_ref().map(fits_by_channel).unwrap_or_default();
            return FitTable {
                after: before.clone(),
                held_out_before: held_out.clone(),
                held_out_after: held_out,
                before,
            };
        };
        let held_out_before = score_parts(&self.search.baseline.fitted, &accepted.held_out_parts);
        FitTable {
            before,
            after: fits_by_channel(&accepted.whole),
            held_out_before: held_out_before.as_ref().map(fits_by_channel).unwrap_or_default(),
            held_out_after: fits_by_channel(&accepted.held_out),
        }
    }

    fn hypotheses(&self) -> Vec<Hypothesis> {
        let accepted = self.named_model();
        let named = |e: &Effect| accepted.is_some_and(|a| a.fit.effects.iter().any(|f| same_name(f, e)));
        let stages = self.search.stages.iter().enumerate();
        stages
            .flat_map(|(stage, s)| s.candidates.iter().map(move |c| (stage + 1, c)))
            .filter_map(|(stage, c)| {
                let effect = c.newest_effect()?;
                Some(Hypothesis {
                    stage,
                    effect: effect.effect,
                    component: effect.component,
                    beside: other_effects(c),
                    values: newest_values(c),
                    power_left: c.held_out_power_share(),
                    log_likelihood_gain: c.held_out.gain_over(&c.held_out_before),
                    distance: c.whole.distance(),
                    worst: c.whole.largest_excess(),
                    accepted: c.fit.effects.iter().all(|e| named(e)),
                })
            })
            .collect()
    }

    fn next_experiment(&self, verdict: DiagnosisVerdict, findings: &[Finding]) -> Option<NextExperiment> {
        let rival = findings.iter().find(|f| f.effect != EffectName::Unknown && !f.alternatives.is_empty());
        match (verdict, rival) {
            (DiagnosisVerdict::Consistent, _) => None,
            (_, Some(finding)) => {
                Some(NextExperiment::Separate { found: finding.name(), alternative: finding.alternatives[0] })
            }
            (DiagnosisVerdict::Unknown | DiagnosisVerdict::Incomplete, None) => {
                Some(NextExperiment::of_unknown(findings))
            }
            _ => None,
        }
    }

    fn warnings(&self) -> Vec<SearchWarning> {
        let limit = self.search.accepted.as_ref().is_some_and(|c| c.fit.limit_reached);
        let stopped = self.search.cancelled.then_some(SearchWarning::Stopped);
        stopped.into_iter().chain(limit.then_some(SearchWarning::IterationLimit)).collect()
    }
}

/// Returns the effects of a candidate but its newest.
fn other_effects(candidate: &FittedCandidate) -> Vec<Name> {
    let effects = &candidate.fit.effects;
    let name = |e: &&'static Effect| Name { effect: e.effect, component: e.component };
    effects[..effects.len().saturating_sub(1)].iter().map(name).collect()
}

/// Returns the fitted parameters of a candidate's newest effect.
fn newest_values(candidate: &FittedCandidate) -> Vec<HypothesisValue> {
    let Some(effect) = candidate.newest_effect() else { return Vec::new() };
    let values = &candidate.fit.values[candidate.fit.values.len() - effect.parameters.len()..];
    let one = |(parameter, value): (&EffectParameter, &f64)| HypothesisValue {
        name: parameter.name,
        value: *value,
        unit: parameter.unit,
    };
    effect.parameters.iter().zip(values).map(one).collect()
}

fn same_name(a: &Effect, b: &Effect) -> bool {
    a.effect == b.effect && a.component == b.component
}

fn whole_turns(phase: f64) -> f64 {
    std::f64::consts::TAU * (phase / std::f64::consts::TAU).round()
}

/// Returns the effects whose smallest detectable size is larger than a size that would matter.
fn not_excited(signatures: &[EffectSignature]) -> Vec<UnexcitedEffect> {
    let mut out: Vec<UnexcitedEffect> = Vec::new();
    for look in signatures {
        let definition = &look.effect.parameters[0];
        let smallest = look.change * (2.0 * GAIN_NEEDED / look.information.max(LEAST_INFORMATION)).sqrt();
        let known =
            out.iter().any(|n| n.effect == look.effect.effect && n.component == look.effect.component);
        if !known && smallest > EXCITED_MULTIPLE * look.change {
            out.push(UnexcitedEffect {
                effect: look.effect.effect,
                component: look.effect.component,
                smallest_detectable: (smallest < LARGEST_REPORTED_MULTIPLE * look.change).then_some(smallest),
                parameter: definition.name,
                unit: definition.unit,
            });
        }
    }
    out
}
