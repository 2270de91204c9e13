//! A curve that has been read as an effect of the library: which effect it is, with values from which its fit in the simulator starts.
//!
//! A search that starts from a model far from the recordings may miss an effect that is in the library. The free function comes close
//! first; its curve then says which effect it is and how large.

use counterpoise_models::{LearnedElement, LearnedPlace, LearnedQuantity, Parameters, RegimeVariable};

use crate::fitting::output_error::FitSelection;
use crate::fitting::score::score_parts;
use crate::learning::learner::{FittedFunctions, LearningTask};
use crate::learning::reading::{CurveForm, CurveReading, read_curve};
use crate::library::{Component, Effect, EffectName, find_effects, learned_element, learned_values_in};
use crate::selection::candidate::FittedCandidate;
use crate::tolerance::{AMBIGUOUS, PARAMETER_PRICE, SEARCH_ITERATIONS};

/// An effect of the library with values from which its fit starts.
struct LibraryForm {
    effect: &'static Effect,
    start: Vec<f64>,
}

/// Returns the effect that an error of the loop's sensor is, with where its fit starts; `None` if it is none.
fn sensor_form(
    variable: RegimeVariable,
    reading: &CurveReading,
    base: &Parameters,
) -> Option<(Component, EffectName, Vec<f64>)> {
    let gyro = &base.sensors.hub_gyro;
    match (variable, reading.form) {
        (RegimeVariable::Reading, CurveForm::Linear) => {
            let gain = gyro.gain * (1.0 + reading.value("slope"));
            Some((Component::HubGyro, EffectName::Scale, vec![gain]))
        }
        (_, CurveForm::Constant) => {
            Some((Component::HubGyro, EffectName::Bias, vec![gyro.bias + reading.value("level")]))
        }
        _ => None,
    }
}

/// Returns the effects of the library that a curve may be.
fn library_forms(element: &LearnedElement, reading: &CurveReading, base: &Parameters) -> Vec<LibraryForm> {
    use LearnedPlace::{LoopSensor, Motor, Pivot};
    use LearnedQuantity::{FrictionLevel, Torque, TorqueConstant};
    use RegimeVariable::{Angle, Load, Rate, Time, Turn};
    let of = |name: &str| reading.value(name);
    let ripple = || vec![of("amplitude").abs(), of("order"), of("phase")];
    let level = if of("level").abs() > f64::MIN_POSITIVE { of("level") } else { 1.0 };
    let (friction, component) = match element.place {
        Motor => (&base.motor_friction, Component::Motor),
        _ => (&base.pivot_friction, Component::Pivot),
    };
    let found = match (element.place, element.quantity, element.variable, reading.form) {
        (Pivot, Torque, Angle, CurveForm::Linear) => {
            let stiffness = -of("slope");
            let centre = if stiffness == 0.0 { 0.0 } else { of("level") / stiffness };
            Some((Component::Structure, EffectName::PositionStiffness, vec![stiffness, centre]))
        }
        (_, Torque, Rate, CurveForm::Linear) => {
            Some((component, EffectName::Viscous, vec![friction.viscous_nm_s_rad - of("slope")]))
        }
        (_, Torque, Rate, CurveForm::Sign) => {
            Some((component, EffectName::Coulomb, vec![friction.coulomb_nm() - of("step")]))
        }
        (_, FrictionLevel, _, CurveForm::Constant) => {
            Some((component, EffectName::Coulomb, vec![friction.coulomb_nm() * of("level")]))
        }
        (Pivot, FrictionLevel, Angle, CurveForm::Sine) => {
            Some((Component::Pivot, EffectName::PositionDependentFriction, ripple()))
        }
        (Pivot, FrictionLevel, Time, CurveForm::ExponentialApproach) => {
            Some((Component::Pivot, EffectName::WarmUp, vec![-of("rise") / level, of("constant")]))
        }
        (_, FrictionLevel, Load, CurveForm::Linear) => {
            Some((component, EffectName::LoadDependentFriction, vec![of("slope") * friction.coulomb_nm()]))
        }
        (Motor, Torque, Turn, CurveForm::Sine) => Some((Component::Motor, EffectName::Cogging, ripple())),
        (Motor, TorqueConstant, Turn, CurveForm::Sine) => {
            Some((Component::Motor, EffectName::TorqueRipple, ripple()))
        }
        (Motor, TorqueConstant, _, CurveForm::Constant) => Some((
            Component::Motor,
            EffectName::TorqueConstant,
            vec![base.motor.torque_constant_nm_a * of("level")],
        )),
        (LoopSensor, ..) => sensor_form(element.variable, reading, base),
        _ => None,
    };
    let Some((component, name, start)) = found else { return Vec::new() };
    let sized = find_effects(component, name).filter(|e| e.parameters.len() <= start.len());
    let within = |e: &&'static Effect| {
        e.parameters.iter().zip(&start).all(|(p, v)| v.is_finite() && (p.bounds[0]..=p.bounds[1]).contains(v))
    };
    let of_effect = |effect: &'static Effect| start[..effect.parameters.len()].to_vec();
    sized.filter(within).map(|effect| LibraryForm { effect, start: of_effect(effect) }).collect()
}

impl LearningTask<'_> {
    /// Returns a model in which an effect of the library stands for the free function that explains most, beside the effects that were
    /// named before; `None` if the curve is no effect of the library, or if that effect predicts held-out data less well.
    pub(crate) fn name_function(
        &self,
        functions: &FittedFunctions,
        named: Option<&FittedCandidate>,
    ) -> Option<FittedCandidate> {
        let candidate = &functions.learned.candidate;
        let [effect] = candidate.fit.effects.as_slice() else { return None };
        let known = learned_element(effect)?;
        let values = learned_values_in(&candidate.fit.parameters, known);
        let coverage = self.visited.coverage(known);
        let element = LearnedElement { values, coverage, ..known.clone() };
        let reading = read_curve(&element)?;
        let forms = library_forms(&element, &reading, self.base);
        let fitted = forms.iter().filter_map(|form| self.fit_form(form, functions, named));
        fitted.min_by(|a, b| a.log_likelihood_deficit(b).total_cmp(&0.0))
    }

    /// Fits a form of the library in the place of a function.
    fn fit_form(
        &self,
        form: &LibraryForm,
        functions: &FittedFunctions,
        named: Option<&FittedCandidate>,
    ) -> Option<FittedCandidate> {
        let searcher = self.searcher;
        let known = named.map_or_else(Vec::new, |n| n.fit.effects.clone());
        let tried = searcher.effects.iter().any(|e| std::ptr::eq(*e, form.effect));
        if !tried || known.iter().any(|e| std::ptr::eq(*e, form.effect)) {
            return None;
        }
        let values = named.map_or_else(Vec::new, |n| n.fit.values.clone());
        let effects: Vec<&'static Effect> = known.into_iter().chain([form.effect]).collect();
        let start: Vec<f64> = values.iter().chain(&form.start).copied().collect();
        let curve = &functions.learned.candidate;
        let split = self.split(&curve.fit.effects)?;
        let selection = FitSelection { iterations: SEARCH_ITERATIONS, restarts: 1, ..split.selection };
        let fit = searcher.fit(effects, &start, &selection, &curve.assessments)?;
        let judged: Option<Vec<_>> = (0..self.before.len()).map(|r| self.assessment(&fit, r)).collect();
        let judged = judged?;
        let held_out = score_parts(&judged, &curve.held_out_parts)?;
        let spared = self.effective_parameters(&functions.learned) - form.start.len() as f64;
        let allowed = AMBIGUOUS.max(0.5 * PARAMETER_PRICE * spared);
        if held_out.loss_against(&curve.held_out) > allowed {
            return None;
        }
        let before = score_parts(self.before, &curve.held_out_parts)?;
        let built = searcher.build_candidate(fit, &judged, &selection.recordings, self.before)?;
        let parts = curve.held_out_parts.clone();
        let built = FittedCandidate { held_out, held_out_before: before, held_out_parts: parts, ..built };
        built.is_acceptable().then(|| searcher.refit_candidate(built))
    }
}
