//! Longer measurements of a verified design: the analyser's map, and the requirements over many mechanisms.

use std::f64::consts::TAU;
use std::sync::{Arc, Mutex};

use counterpoise_diagnose::simulator_access::map;
use counterpoise_pipeline as pipeline;
use counterpoise_pipeline::studies::fra::{Analyser, Around, Map, On, Plan};
use counterpoise_verify::robust::{Campaign, Sample, Sense, Summary, ranking, summary};
use counterpoise_verify::{Requirement, VerifiedController};

use crate::jobs::{Reasons, VerifyAsk};
use crate::live::reasons;
use crate::results::Of;
use counterpoise_host::progress::Watch;

/// What was measured.
#[derive(Debug, Clone, Default)]
pub struct Measured {
    /// The analyser's map, or why there is none.
    pub map: Option<Of<Result<Map, Reasons>>>,
    /// The campaign, or why there is none.
    pub robust: Option<Of<Result<Robust, Reasons>>>,
}

/// What is asked of the measurements.
#[derive(Debug, Clone)]
pub enum MeasureAsk {
    /// The analyser's map of platform to hub.
    Map(VerifyAsk),
    /// The campaign of the project.
    Robust(VerifyAsk, Arc<VerifiedController>),
}

/// An answer.
#[derive(Debug, Clone)]
pub enum MeasureAnswer {
    /// The map.
    Map(Result<Map, Reasons>),
    /// The campaign.
    Robust(Result<Robust, Reasons>),
}

/// The requirements over many mechanisms.
#[derive(Debug, Clone)]
pub struct Robust {
    /// One row a requirement.
    pub rows: Vec<RobustRow>,
    /// Mechanisms that were tried.
    pub done: usize,
    /// Mechanisms of the whole campaign.
    pub of: usize,
}

/// A requirement over many mechanisms.
#[derive(Debug, Clone)]
pub struct RobustRow {
    /// The requirement.
    pub requirement: Requirement,
    /// Share, quantiles and the worst.
    pub summary: Summary,
    /// The parameter that moves the figure most, with its rank correlation and what of the parameter it is with.
    pub strongest: Option<(&'static str, f64, Sense)>,
    /// The figure of every mechanism, sorted.
    pub values: Vec<f64>,
}

/// Where a campaign that still runs leaves what it has so far.
pub type SoFar = Arc<Mutex<Option<Robust>>>;

/// Amplitudes of the platform's rate, rad/s.
const AMPLITUDES_RAD_S: [f64; 4] = [0.02, 0.05, 0.1, 0.2];
/// From, to (Hz) and count of the frequencies.
const FREQUENCIES: (f64, f64, usize) = (0.3, 30.0, 21);
/// Mechanisms between two looks at a campaign.
const LOOK_EACH: usize = 10;

/// Carries out a measurement.
pub fn measure(ask: &MeasureAsk, so_far: &SoFar, watch: &Watch) -> MeasureAnswer {
    match ask {
        MeasureAsk::Map(ask) => MeasureAnswer::Map(mapped(ask, watch).map_err(|error| reasons(&error))),
        MeasureAsk::Robust(ask, verified) => MeasureAnswer::Robust(swept(ask, verified, so_far, watch)),
    }
}

fn mapped(ask: &VerifyAsk, watch: &Watch) -> Result<Map, pipeline::PipelineError> {
    let (from, to, count) = FREQUENCIES;
    let frequency = |k: usize| from * (to / from).powf(k as f64 / (count - 1) as f64);
    let plan = Plan {
        around: Around::Disturbance,
        amplitudes: AMPLITUDES_RAD_S.to_vec(),
        frequencies_hz: (0..count).map(frequency).collect(),
        offset_m: 0.0,
    };
    let analyser = Analyser::new(&ask.live.project, &ask.live.modelled, &plan, On::Simulation)?;
    analyser.compare(&analyser.measure(&plan, watch)?, watch)
}

fn swept(
    ask: &VerifyAsk,
    verified: &VerifiedController,
    so_far: &SoFar,
    watch: &Watch,
) -> Result<Robust, Reasons> {
    let live = &ask.live;
    let campaign = pipeline::campaign(&live.project, &live.modelled, verified, &ask.folder)
        .map_err(|error| reasons(&error))?;
    let mut samples: Vec<Sample> = Vec::new();
    while samples.len() < campaign.len() {
        let (from, count) = (samples.len(), LOOK_EACH.min(campaign.len() - samples.len()));
        let made = map(watch, count, |k| campaign.run(from + k));
        if made.len() < count {
            break;
        }
        samples.extend(made.into_iter().collect::<Result<Vec<_>, _>>().map_err(|e| vec![e.to_string()])?);
        if let Ok(mut kept) = so_far.lock() {
            *kept = Some(robust(&campaign, &samples));
        }
        watch.progress.say(format!("mechanism {} of {}", samples.len(), campaign.len()));
        (watch.wake)();
    }
    Ok(robust(&campaign, &samples))
}

fn robust(campaign: &Campaign, samples: &[Sample]) -> Robust {
    let row = |(k, requirement): (usize, &Requirement)| {
        let mut values: Vec<f64> = samples.iter().map(|s| s.values[k]).filter(|v| !v.is_nan()).collect();
        values.sort_by(f64::total_cmp);
        let strongest = ranking(campaign, samples, k).into_iter().find(|r| r.correlation.is_finite());
        RobustRow {
            requirement: requirement.clone(),
            summary: summary(campaign, samples, k),
            strongest: strongest
                .map(|r| (campaign.variations()[r.variation].parameter.key(), r.correlation, r.sense)),
            values,
        }
    };
    let rows = campaign.requirements().iter().enumerate().map(row).collect();
    Robust { rows, done: samples.len(), of: campaign.len() }
}

/// One amplitude of a map: frequencies in rad/s with moduli.
#[derive(Debug, Clone, Default)]
pub struct Amplitude {
    /// Amplitude of the excitation.
    pub amplitude: f64,
    /// As measured.
    pub measured: Vec<[f64; 2]>,
    /// Of the linear model.
    pub linear: Vec<[f64; 2]>,
}

/// The curves of a map, amplitude by amplitude.
pub fn curves(map: &Map) -> Vec<Amplitude> {
    let mut all: Vec<Amplitude> = Vec::new();
    for point in &map.points {
        if all.last().is_none_or(|last| last.amplitude != point.amplitude) {
            all.push(Amplitude { amplitude: point.amplitude, ..Amplitude::default() });
        }
        if let Some(Amplitude { measured, linear, .. }) = all.last_mut() {
            let (rate, size) = (TAU * point.frequency_hz, |h: [f64; 2]| h[0].hypot(h[1]));
            measured.push([rate, size(point.response)]);
            linear.push([rate, size(point.linear)]);
        }
    }
    all
}
