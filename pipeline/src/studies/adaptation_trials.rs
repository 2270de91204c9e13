//! Methods of adaptation where they can fail: motions that no window fits, right and wrong starting values, sudden and slow changes of
//! the load; each against the same controller without adaptation, and against one that knows the load.

use counterpoise_controller::{Controller, Readings, Runner, SampledController};
use counterpoise_simulate::signal::Sine;
use counterpoise_simulate::{
    FurtherMotion, Imperfections, Initial, PlantState, PlatformMotion, Scenario, Signal, Simulator,
};
use counterpoise_verify::Procedure;
use counterpoise_verify::signals::{Drive, RoadClass, Vehicle, iso_road};
use serde::Serialize;

use crate::synth::controller_blocks::{dead_band_m_s2, estimator, hold_band};
use crate::synth::schedule::unbalanced;
use crate::tolerance::{LEAST_ADDED, LEAST_ADDED_OVER_HYSTERESIS};
use crate::{Modelled, PipelineError, Synthesised};
use counterpoise_project::Project;
use counterpoise_project::resolve::synthesis_options::{Adaptation, AdaptationMethod, AdaptationUse};

/// How the platform moves in a trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Motion {
    /// Heave and pitch of the verification, at frequencies of which no window holds whole periods.
    Sines,
    /// The project's road; one of ISO 8608, class C at 8 m/s, without it.
    Road,
    /// Sines of eight frequencies from 0.3 to 5 Hz in heave and in pitch.
    Multisine,
}

/// What the load does, and what the estimate starts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Load {
    /// The design's load, from the right value.
    Nominal,
    /// The design's load, from a value 30 % too low.
    WrongStart,
    /// Thirty percent more from one sample to the next.
    Sudden,
    /// Thirty percent more, in ten steps over half the run.
    Slow,
}

/// One trial of one method: RMS of the hub rate once the load has settled.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TrialRow {
    /// The method's key.
    pub method: &'static str,
    /// The motion.
    pub motion: Motion,
    /// The load.
    pub load: Load,
    /// Without adaptation, rad/s.
    pub without_rad_s: f64,
    /// With adaptation, rad/s.
    pub with_rad_s: f64,
    /// With a controller that knows the load, rad/s.
    pub told_rad_s: f64,
    /// Difference of the hub rates without adaptation after a sudden and after a slow change, rad/s: load, motion and controller are the same, so
    /// that only what friction remembers differs.
    pub spread_rad_s: f64,
}

/// Where the estimate of recursive least squares is followed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bands {
    /// RMS of the platform's acceleration below which the estimate is not changed, m/s^2.
    pub dead_band_m_s2: f64,
    /// Share of the design's out-of-balance within which it is not followed.
    pub hold_band: f64,
    /// Whether the exported controller adapts: it does not where no trial shows that it helps.
    pub is_exported: bool,
}

/// Trials of all methods.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trials {
    /// Rows: trial by trial, the methods in each.
    pub rows: Vec<TrialRow>,
    /// Methods that are refused for this project, with the reason.
    pub refused: Vec<Refusal>,
    /// Where recursive least squares act; absent for other methods.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bands: Option<Bands>,
    /// The hub's rate once the load has settled, of every run.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub histories: Vec<TrialHistory>,
}

/// The hub's rate in a run of a trial.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrialHistory {
    /// The motion.
    pub motion: Motion,
    /// The load.
    pub load: Load,
    /// `none`, `told`, or the method's key.
    pub acts: &'static str,
    /// Sample time, s.
    pub sample_time_s: f64,
    /// From when the hub rate is measured until the end, rad/s; empty if the motion diverges.
    pub hub_rate_rad_s: Vec<f64>,
}

/// Why a method is refused.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Refusal {
    /// The trial in which it does worst.
    pub worst: TrialRow,
    /// Hub rate with adaptation over that without, in that trial.
    pub ratio: f64,
}

/// A method is refused where its hub rate exceeds that without adaptation by more than this factor.
pub const REFUSED_ABOVE: f64 = 1.03;
/// Change of the load, and error of a wrong starting value.
const CHANGE: f64 = 0.3;
/// Length of a trial, s; its times are no whole number of any period.
const LENGTH_S: f64 = 47.3;
/// When a slow change ends, s.
const SETTLED_S: f64 = 23.7;
/// From when the hub rate is measured, s.
const MEASURED_S: f64 = 31.1;
/// When the load begins to change, s.
const CHANGE_S: f64 = 7.9;
/// Steps of a slow change.
const SLOW_STEPS: usize = 10;
/// Factors on the frequencies of heave and pitch, away from whole numbers of periods in a window.
const DETUNED: [f64; 2] = [0.887, 1.137];

/// Every motion of the platform that is tried.
pub(super) const MOTIONS: [Motion; 3] = [Motion::Sines, Motion::Road, Motion::Multisine];
/// Every load that is tried.
pub(super) const LOADS: [Load; 4] = [Load::Nominal, Load::WrongStart, Load::Sudden, Load::Slow];
/// Key of recursive least squares.
pub(super) const RECURSIVE: &str = "recursive";

/// Every method with its key in a project file.
pub const METHODS: [(AdaptationMethod, &str); 3] = [
    (AdaptationMethod::Gradient, "gradient"),
    (AdaptationMethod::WindowedMean, "windowed-mean"),
    (AdaptationMethod::Recursive, RECURSIVE),
];

impl TrialRow {
    /// Returns the hub rate with adaptation over that without.
    pub fn ratio(&self) -> f64 {
        self.with_rad_s / self.without_rad_s
    }

    /// Returns the share of the added hub rate that the adaptation removes; `None` if the load adds no more than a twentieth, or no more than
    /// what friction remembers of the runs before.
    pub fn removed(&self) -> Option<f64> {
        let added = self.without_rad_s - self.told_rad_s;
        let least = (LEAST_ADDED * self.told_rad_s).max(LEAST_ADDED_OVER_HYSTERESIS * self.spread_rad_s);
        (added > least).then(|| (self.without_rad_s - self.with_rad_s) / added)
    }
}

impl Trials {
    /// Returns whether a method is refused.
    pub fn refuses(&self, method: AdaptationMethod) -> bool {
        let name = METHODS.iter().find(|row| row.0 == method).map_or("", |row| row.1);
        self.refused.iter().any(|refused| refused.worst.method == name)
    }
}

/// Returns the trials of every method that the project's mechanism allows, by a procedure with or without a road.
///
/// # Errors
/// A project without adaptation, and those of the plant and the simulator.
pub fn run_trials(
    project: &Project,
    modelled: &Modelled,
    made: &Synthesised,
    procedure: &Procedure,
) -> Result<Trials, PipelineError> {
    let missing =
        PipelineError::Missing { section: "synth.adaptation", needed_by: "the trials of adaptation" };
    let adaptation = asked(project).ok_or(missing)?;
    let stage = Stage { project, adaptation, modelled, controller: &made.sampled.controller, procedure };
    let possible = |(method, _): &(AdaptationMethod, _)| {
        // the mean goes by gravity, which an axis without it does not have
        *method != AdaptationMethod::WindowedMean || modelled.parameters.gravity_m_s2 != 0.0
    };
    let methods: Vec<_> = METHODS.into_iter().filter(possible).collect();
    tried(&stage, &methods)
}

/// Returns the trials of the project's own method; `None` if it does not adapt.
///
/// # Errors
/// Those of the plant and the simulator.
pub fn own_trials(
    project: &Project,
    modelled: &Modelled,
    made: &Synthesised,
    procedure: &Procedure,
) -> Result<Option<Trials>, PipelineError> {
    let Some(adaptation) = asked(project) else { return Ok(None) };
    let stage = Stage { project, adaptation, modelled, controller: &made.sampled.controller, procedure };
    let own: Vec<_> = METHODS.into_iter().filter(|(method, _)| *method == adaptation.method).collect();
    let mut found = tried(&stage, &own)?;
    if adaptation.use_in_code == AdaptationUse::LeftOut {
        // what is not exported is not refused
        found.refused.clear();
    }
    Ok(Some(found))
}

pub(super) fn asked(project: &Project) -> Option<&Adaptation> {
    project.synth.as_ref().and_then(|asked| asked.options.adaptation.as_ref())
}

fn tried(stage: &Stage, methods: &[(AdaptationMethod, &'static str)]) -> Result<Trials, PipelineError> {
    let (mut rows, mut histories) = (Vec::new(), Vec::new());
    let sample_time_s = stage.modelled.parameters.interface.sample_period_s;
    for motion in MOTIONS {
        let platform = stage.platform(motion)?;
        for load in LOADS {
            let mut rms = |acts, name| {
                let hub_rate_rad_s = stage.run(&platform, load, acts)?.hub_rate_rad_s;
                let found = rms_or_infinite(&hub_rate_rad_s);
                histories.push(TrialHistory { motion, load, acts: name, sample_time_s, hub_rate_rad_s });
                Ok::<_, PipelineError>(found)
            };
            let (without_rad_s, told_rad_s) = (rms(Acts::Without, "none")?, rms(Acts::Told, "told")?);
            for &(method, name) in methods {
                let with_rad_s = rms(Acts::Adapts(method), name)?;
                let spread_rad_s = 0.0;
                let row = TrialRow {
                    method: name,
                    motion,
                    load,
                    without_rad_s,
                    with_rad_s,
                    told_rad_s,
                    spread_rad_s,
                };
                rows.push(row);
            }
        }
    }
    set_spreads(&mut rows);
    let refused = methods.iter().filter_map(|(_, name)| refusal(name, &rows)).collect();
    let squares = methods.iter().any(|(method, _)| *method == AdaptationMethod::Recursive);
    let bands = squares.then(|| stage.bands());
    Ok(Trials { rows, refused, bands, histories })
}

/// Sets what the hub rate without adaptation differs by after a sudden and after a slow change, motion by motion.
pub(super) fn set_spreads(rows: &mut [TrialRow]) {
    for motion in MOTIONS {
        let after = |load| {
            let found = rows.iter().find(|row| row.motion == motion && row.load == load);
            found.map(|row| row.without_rad_s).filter(|rate| rate.is_finite())
        };
        let [sudden, slow] = [Load::Sudden, Load::Slow].map(after);
        let spread_rad_s = sudden.zip(slow).map_or(0.0, |(sudden, slow)| (sudden - slow).abs());
        let same = rows.iter_mut().filter(|row| row.motion == motion);
        same.for_each(|row| row.spread_rad_s = spread_rad_s);
    }
}

/// The RMS of rates; infinite if there are none, because the motion diverged.
pub(super) fn rms_or_infinite(rates: &[f64]) -> f64 {
    if rates.is_empty() { f64::INFINITY } else { counterpoise_verify::signals::rms(rates) }
}

/// Returns the trial in which a method does worst, if that is reason enough to refuse it.
fn refusal(method: &'static str, rows: &[TrialRow]) -> Option<Refusal> {
    let own = rows.iter().filter(|row| row.method == method);
    let worst = *own.max_by(|a, b| a.ratio().total_cmp(&b.ratio()))?;
    (worst.ratio() > REFUSED_ABOVE).then(|| Refusal { worst, ratio: worst.ratio() })
}

/// What acts in a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Acts {
    Without,
    Told,
    Adapts(AdaptationMethod),
}

pub(super) struct Stage<'a> {
    pub project: &'a Project,
    pub adaptation: &'a Adaptation,
    pub modelled: &'a Modelled,
    pub controller: &'a Controller,
    pub procedure: &'a Procedure,
}

/// What a run of a trial shows.
#[derive(Debug, Clone, Default)]
pub(super) struct TrialRun {
    /// The hub's rate after the load has settled; empty if the motion diverges.
    pub hub_rate_rad_s: Vec<f64>,
    /// The largest RMS of the platform's acceleration that the estimator found over its memory, m/s^2; 0 if it has no dead-band.
    pub peak_rms_m_s2: f64,
}

/// A controller with a note of how lively its estimator finds the platform.
struct MonitoredController {
    runner: Runner,
    /// Place of the mean square of the platform's acceleration among the states.
    place: Option<usize>,
    most_m2_s4: f64,
}

impl SampledController for MonitoredController {
    fn reset(&mut self) {
        self.runner.reset();
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        let control = self.runner.step(readings);
        let now = self.place.and_then(|place| self.runner.state(place)).unwrap_or(0.0);
        self.most_m2_s4 = self.most_m2_s4.max(now);
        control
    }
}

impl Stage<'_> {
    /// Returns where recursive least squares act.
    fn bands(&self) -> Bands {
        let observer = self.project.synth.as_ref().and_then(|asked| asked.options.observer.as_ref());
        let adaptation = Adaptation { method: AdaptationMethod::Recursive, ..self.adaptation.clone() };
        Bands {
            dead_band_m_s2: dead_band_m_s2(&adaptation, self.modelled, observer),
            hold_band: hold_band(&adaptation),
            is_exported: adaptation.use_in_code == AdaptationUse::Exported,
        }
    }

    /// Runs the load on a motion of the platform.
    pub(super) fn run(
        &self,
        platform: &PlatformMotion,
        load: Load,
        acts: Acts,
    ) -> Result<TrialRun, PipelineError> {
        let mut watched = self.watched(acts)?;
        let design = self.modelled.plant.body().out_of_balance_kg_m;
        if load == Load::WrongStart && acts != Acts::Told {
            watched.runner.set_out_of_balance((1.0 - CHANGE) * design);
        }
        let mut state: Option<PlantState> = None;
        let mut angle = self.procedure.operating_point.platform_angle_rad;
        let mut rates = Vec::new();
        for part in parts(load) {
            if acts == Acts::Told {
                watched.runner.set_out_of_balance(part.factor * design);
            }
            let plant = unbalanced(&self.modelled.plant, part.factor)?;
            let rest = Initial::Rest { hub_angle_rad: self.procedure.operating_point.hub_angle_rad };
            let scenario = Scenario {
                platform: shifted(platform, part.from_s, angle),
                imperfections: Imperfections::NoiseAndQuantisation { seed: self.procedure.seed },
                initial: state.take().map_or(rest, |state| Initial::State(Box::new(state))),
                ..Scenario::still(part.to_s - part.from_s)
            };
            let run = match Simulator::new(&plant)?.run(&mut watched, &scenario) {
                Err(counterpoise_simulate::Error::Diverged { .. }) => return Ok(TrialRun::default()),
                other => other?,
            };
            rates.extend(run.truth.hub_rate_rad_s);
            angle = run.truth.platform_angle_rad.last().copied().unwrap_or(angle);
            state = Some(run.final_state);
        }
        let period_s = self.modelled.parameters.interface.sample_period_s;
        let first = ((MEASURED_S / period_s) as usize).min(rates.len());
        let peak_rms_m_s2 = watched.most_m2_s4.sqrt();
        Ok(TrialRun { hub_rate_rad_s: rates.split_off(first), peak_rms_m_s2 })
    }

    fn watched(&self, acts: Acts) -> Result<MonitoredController, PipelineError> {
        let own = match acts {
            Acts::Adapts(method) => {
                let adaptation = Adaptation { method, ..self.adaptation.clone() };
                let synth = self.project.synth.as_ref();
                let observer = synth.and_then(|asked| asked.options.observer.as_ref());
                Some(estimator(&adaptation, self.modelled, observer))
            }
            Acts::Without | Acts::Told => None,
        };
        let controller = self.controller.with(|parts| parts.estimator = own);
        let controller = controller.map_err(counterpoise_synth::Error::from)?;
        let mut states = controller.programs().states.iter();
        let place = states.find(|group| group.name == "liveliness").map(|group| group.first);
        Ok(MonitoredController { runner: controller.runner(), place, most_m2_s4: 0.0 })
    }

    pub(super) fn platform(&self, motion: Motion) -> Result<PlatformMotion, PipelineError> {
        let procedure = self.procedure;
        let sine = |sine: &counterpoise_verify::Sine, by: f64| {
            Signal::sine(sine.amplitude, by * std::f64::consts::TAU * sine.frequency_hz)
        };
        let (heave_m_s2, pitch_rate_rad_s) = match motion {
            Motion::Sines => (sine(&procedure.heave, DETUNED[0]), sine(&procedure.pitch, DETUNED[1])),
            Motion::Multisine => {
                (multisine(procedure.heave.amplitude, 0.31), multisine(procedure.pitch.amplitude, 0.37))
            }
            Motion::Road => return self.road(),
        };
        Ok(PlatformMotion { heave_m_s2, pitch_rate_rad_s, ..PlatformMotion::STILL })
    }

    /// Returns the road, driven again and again for the whole trial.
    fn road(&self) -> Result<PlatformMotion, PipelineError> {
        let seed = self.procedure.seed;
        let road = match (&self.procedure.road, RoadClass::from_letter("C")) {
            (Some(road), _) => road.clone(),
            (None, None) => return Ok(PlatformMotion::STILL),
            (None, Some(class)) => {
                let (speed_m_s, duration_s, sample_period_s, fade_s) = (8.0, 30.0, 0.005, 1.0);
                let drive = Drive { class, speed_m_s, duration_s, sample_period_s, fade_s, seed };
                iso_road(drive, Vehicle::HEAVY, self.modelled.parameters.gravity_m_s2)?
            }
        };
        let count = (LENGTH_S / road.sample_period_s) as usize + 2;
        let again = |values: &[f64]| Signal::Samples {
            period_s: road.sample_period_s,
            values: values.iter().copied().cycle().take(count).collect(),
        };
        Ok(PlatformMotion {
            heave_m_s2: again(&road.heave_m_s2),
            pitch_rate_rad_s: again(&road.pitch_rate_rad_s),
            further: road.further.as_ref().map(|further| FurtherMotion {
                surge_m_s2: again(&further.surge_m_s2),
                roll_rate_rad_s: again(&further.roll_rate_rad_s),
                yaw_rate_rad_s: again(&further.yaw_rate_rad_s),
            }),
            ..PlatformMotion::STILL
        })
    }
}

/// Eight sines from a lowest frequency up, with phases that spread the peaks (M. Schroeder, IEEE Trans. Information Theory 16, 1970).
fn multisine(amplitude: f64, lowest_hz: f64) -> Signal {
    const COUNT: usize = 8;
    let share = amplitude / (COUNT as f64).sqrt();
    let sine = |k: usize| Sine {
        amplitude: share,
        frequency_rad_s: std::f64::consts::TAU * lowest_hz * 1.443f64.powi(k as i32),
        phase_rad: -std::f64::consts::PI * (k * (k + 1)) as f64 / COUNT as f64,
    };
    Signal::Sines((0..COUNT).map(sine).collect())
}

/// A part of a run with a factor on the out-of-balance.
struct Part {
    from_s: f64,
    to_s: f64,
    factor: f64,
}

/// Returns the parts of a run.
fn parts(load: Load) -> Vec<Part> {
    let part = |from_s, to_s, factor| Part { from_s, to_s, factor };
    match load {
        Load::Nominal | Load::WrongStart => vec![part(0.0, LENGTH_S, 1.0)],
        Load::Sudden => vec![part(0.0, CHANGE_S, 1.0), part(CHANGE_S, LENGTH_S, 1.0 + CHANGE)],
        Load::Slow => {
            let step_s = (SETTLED_S - CHANGE_S) / SLOW_STEPS as f64;
            let at = |k: usize| CHANGE_S + step_s * k as f64;
            let changed = |k: usize| {
                let end_s = if k == SLOW_STEPS { LENGTH_S } else { at(k) };
                part(at(k - 1), end_s, 1.0 + CHANGE * k as f64 / SLOW_STEPS as f64)
            };
            std::iter::once(part(0.0, CHANGE_S, 1.0)).chain((1..=SLOW_STEPS).map(changed)).collect()
        }
    }
}

/// Returns the motion from a time on.
fn shifted(platform: &PlatformMotion, from_s: f64, initial_angle_rad: f64) -> PlatformMotion {
    let later = |signal: &Signal| match signal {
        Signal::Sines(sines) => {
            let shift = |s: &Sine| Sine { phase_rad: s.phase_rad + s.frequency_rad_s * from_s, ..*s };
            Signal::Sines(sines.iter().map(shift).collect())
        }
        Signal::Samples { period_s, values } => {
            let first = ((from_s / period_s).round() as usize).min(values.len().saturating_sub(1));
            Signal::Samples { period_s: *period_s, values: values[first..].to_vec() }
        }
        other => other.clone(),
    };
    PlatformMotion {
        heave_m_s2: later(&platform.heave_m_s2),
        pitch_rate_rad_s: later(&platform.pitch_rate_rad_s),
        initial_angle_rad,
        further: platform.further.as_ref().map(|further| FurtherMotion {
            surge_m_s2: later(&further.surge_m_s2),
            roll_rate_rad_s: later(&further.roll_rate_rad_s),
            yaw_rate_rad_s: later(&further.yaw_rate_rad_s),
        }),
    }
}
