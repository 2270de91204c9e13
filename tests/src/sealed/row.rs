//! The comparison of one answer with its sealed truth: a line of the score.

use counterpoise_diagnose::findings::answer::{Answer, DiagnosisVerdict, Finding, Name};
use counterpoise_diagnose::findings::channel_fits::{PooledFit, PooledFits};
use counterpoise_diagnose::library::EffectName;
use counterpoise_recordings::{Channel, Recording};
use serde::{Deserialize, Serialize};

use super::{Case, ConcealedEffect, KINDS, MachineFamily, PERIOD, SealedAnswer, WrittenColumns};

/// One machine's score.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Row {
    pub seed: u64,
    pub family: String,
    /// Concealed effect, as `component effect`.
    pub truth: Vec<String>,
    /// RMS change that it makes to the most changed channel, in floors: below 1 it drowns.
    pub visibility: f64,
    pub noise: f64,
    pub verdict: String,
    /// Findings, each as `component effect`.
    pub found: Vec<String>,
    /// For each finding with a name: its probability, and whether it is true.
    pub stated: Vec<(f64, bool)>,
    /// Concealed effects whose component was found; whose name was; that were named or among the alternatives.
    pub component: usize,
    pub top: usize,
    pub in_set: usize,
    /// Names offered for all findings, alternatives included.
    pub offered: usize,
    /// 95 % intervals that hold the true value, of how many.
    pub covered: usize,
    pub intervals: usize,
    /// Mean ln(RMS / floor) over the channels, data that was not fitted: the model as it was, the improved one.
    pub held_out_before: f64,
    pub held_out_after: f64,
    /// `true` if data that was not fitted got worse.
    pub damaged: bool,
    pub seconds: f64,
    /// For each concealed effect, the RMS change that it makes beside the others to the most changed channel, in floors.
    #[serde(default)]
    pub sizes: Vec<f64>,
    /// For each interval: how far the value is from the truth, in its standard deviations.
    #[serde(default)]
    pub errors: Vec<f64>,
    /// Hypotheses of the search: the best few of each stage.
    #[serde(default)]
    pub evidence: Vec<HypothesisRow>,
    /// Mean ln(RMS / floor) on the last part of every recording, fitted to the first: the model as it was, its parameters
    /// refitted, what was found, the truth.
    #[serde(default)]
    pub split: [Option<f64>; 4],
}

/// A hypothesis that was fitted: what the search weighed.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct HypothesisRow {
    pub stage: usize,
    pub name: String,
    pub beside: usize,
    pub gain: f64,
    pub distance: f64,
    pub worst: f64,
    pub accepted: bool,
}

/// Hypotheses kept of each stage.
const KEPT: usize = 6;

fn tried_hypotheses(answer: &Answer) -> Vec<HypothesisRow> {
    let mut out: Vec<HypothesisRow> = Vec::new();
    for h in &answer.hypotheses {
        if out.iter().filter(|t| t.stage == h.stage).count() < KEPT {
            out.push(HypothesisRow {
                stage: h.stage,
                name: format!("{} {}", h.component, h.effect),
                beside: h.beside.len(),
                gain: h.log_likelihood_gain,
                distance: h.distance,
                worst: h.worst,
                accepted: h.accepted,
            });
        }
    }
    out
}

/// Returns what the diagnosis is handed of a machine.
pub fn recordings(case: &Case) -> Vec<Recording> {
    let one = |(index, written): (usize, &WrittenColumns)| {
        let mut recording = recording_of(index, written);
        if !case.sealed.motor_rate {
            recording.remove(Channel::MotorRate);
        }
        if !case.sealed.hub_position {
            recording.remove(Channel::HubPosition);
        }
        recording
    };
    case.recordings.iter().enumerate().map(one).collect()
}

/// Returns the recording of the k-th of [`KINDS`], with all sensors.
pub fn recording_of(index: usize, written: &WrittenColumns) -> Recording {
    Recording::new(format!("{:?}", KINDS[index]), PERIOD)
        .with(Channel::Demand, written.demand.clone())
        .with(Channel::Control, written.control.clone())
        .with(Channel::HubRate, written.hub_rate.clone())
        .with(Channel::PlatformRate, written.platform_rate.clone())
        .with(Channel::PlatformAccel, written.platform_accel.clone())
        .with(Channel::MotorRate, written.motor_rate.clone())
        .with(Channel::HubPosition, written.hub_position.clone())
}

/// Scores an answer.
pub fn score(seed: u64, case: &Case, answer: &Answer, seconds: f64) -> Row {
    let sealed = &case.sealed;
    let known = sealed.family != MachineFamily::Outside;
    let count = |hit: &dyn Fn(&ConcealedEffect) -> bool| sealed.concealed.iter().filter(|c| hit(c)).count();
    let any = |hit: &dyn Fn(&Finding) -> bool| answer.findings.iter().any(hit);
    let names = |c: &str, e: &str| format!("{c} {e}");
    let errors = errors(sealed, answer);
    let sizes: Vec<f64> = (0..sealed.concealed.len()).map(|k| size(case, k, answer)).collect();
    Row {
        seed,
        family: format!("{:?}", sealed.family),
        truth: sealed.concealed.iter().map(|c| names(c.component, c.effect)).collect(),
        visibility: sizes.iter().copied().fold(0.0, f64::max),
        noise: sealed.noise,
        verdict: format!("{:?}", answer.verdict),
        found: answer.findings.iter().map(|f| names(f.component.name(), f.effect.name())).collect(),
        stated: answer
            .findings
            .iter()
            .filter(|f| f.effect != EffectName::Unknown)
            .map(|f| stated_probability(sealed, f))
            .collect(),
        component: count(&|c| any(&|f| f.component.name() == c.component)),
        top: count(&|c| known && any(&|f| is(c, f.name()))),
        in_set: count(&|c| known && any(&|f| offers(c, f))),
        offered: answer.findings.iter().map(|f| 1 + f.alternatives.len()).sum(),
        covered: errors.iter().filter(|e| e.abs() <= 1.96).count(),
        intervals: errors.len(),
        held_out_before: distance(&answer.fit.held_out_before),
        held_out_after: distance(&answer.fit.held_out_after),
        damaged: answer.verdict != DiagnosisVerdict::Consistent && is_damaged(answer),
        seconds,
        sizes,
        errors,
        evidence: tried_hypotheses(answer),
        split: [None; 4],
    }
}

/// Returns whether a name is the concealed effect's, or one that such recordings cannot tell from it.
fn is(c: &ConcealedEffect, name: Name) -> bool {
    (c.component, c.effect) == name.names() || c.also.contains(&name.names())
}

/// Returns whether a finding has the concealed effect's name, or offers it as an alternative.
pub fn offers(c: &ConcealedEffect, f: &Finding) -> bool {
    is(c, f.name()) || f.alternatives.iter().any(|a| is(c, *a))
}

fn stated_probability(sealed: &SealedAnswer, f: &Finding) -> (f64, bool) {
    (f.probability, sealed.concealed.iter().any(|c| is(c, f.name())))
}

/// Errors of the parameters of the findings with the right name, in their standard deviations.
fn errors(sealed: &SealedAnswer, answer: &Answer) -> Vec<f64> {
    let mut errors = Vec::new();
    for c in &sealed.concealed {
        let finding = answer.findings.iter().find(|f| f.name().names() == (c.component, c.effect));
        for p in finding.map_or(&[][..], |f| &f.parameters) {
            let truth = c.parameters.iter().find(|(name, _)| *name == p.name);
            if let Some(&(_, value)) = truth {
                let side = if value < p.value { p.value - p.ci95[0] } else { p.ci95[1] - p.value };
                errors.push(1.96 * (p.value - value) / side.max(f64::MIN_POSITIVE));
            }
        }
    }
    errors
}

/// The change that a concealed effect makes beside the others to the most changed channel of any recording, in floors; a
/// fault of the platform's own sensors changes no motion, and counts by the residual that it leaves.
fn size(case: &Case, index: usize, answer: &Answer) -> f64 {
    if case.sealed.concealed[index].component.starts_with("platform") {
        let over = |f: &PooledFit| (f.pooled_residual_over_floor().powi(2) - 1.0).max(0.0).sqrt();
        return answer.fit.before.values().map(over).fold(0.0, f64::max);
    }
    let mut largest: f64 = 0.0;
    for (with, without) in case.recordings.iter().zip(&case.without[index]) {
        let channels = [
            (Channel::Control, &with.control, &without.control),
            (Channel::HubRate, &with.hub_rate, &without.hub_rate),
            (Channel::MotorRate, &with.motor_rate, &without.motor_rate),
            (Channel::HubPosition, &with.hub_position, &without.hub_position),
        ];
        for (channel, a, b) in channels {
            let Some(fit) = answer.fit.before.get(channel) else { continue };
            let square = a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>() / a.len() as f64;
            largest = largest.max(square.sqrt() / fit.floor);
        }
    }
    largest
}

/// Mean ln(RMS / floor) of the channels, 0 at the floor.
fn distance(channels: &PooledFits) -> f64 {
    let sum: f64 = channels.values().map(|c| c.pooled_residual_over_floor().max(1.0).ln()).sum();
    sum / channels.values().count().max(1) as f64
}

fn is_damaged(answer: &Answer) -> bool {
    answer.fit.held_out_after.iter().any(|(channel, after)| {
        let before = answer.fit.held_out_before.get(channel).unwrap();
        after.rms_error > 1.05 * before.rms_error.max(before.floor)
    })
}
