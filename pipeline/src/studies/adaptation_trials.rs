//! Methods of adaptation where they can fail: motions that no window fits, right and wrong starting values, sudden and slow changes of
//! the load; each against the same controller without adaptation, and against one that knows the load.

mod excitation;
mod stage;

pub use excitation::{TrialLoad, TrialMotion};

pub(super) use excitation::{LOADS, MOTIONS};
pub(super) use stage::{Stage, TrialController, TrialRun};

use counterpoise_models::ControlledQuantity;
use counterpoise_project::Project;
use counterpoise_project::resolve::synthesis_options::{AdaptationMethod, AdaptationOptions, AdaptationUse};
use counterpoise_verify::Procedure;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::synth::controller_blocks::{dead_band_m_s2, hold_band};
use crate::tolerance::{LEAST_ADDED, LEAST_ADDED_OVER_HYSTERESIS, NEVER_WORSE, REFUSED_ABOVE};
use crate::{PipelineError, PlantModel, SynthesisedDesign};

/// One trial of one method: RMS of the hub rate once the load has settled. Its keys end in the unit of the axis: `with_m_s` on one that slides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrialRow {
    /// The rate, whose unit the values have.
    pub rate: ControlledQuantity,
    /// The method's key.
    pub method: &'static str,
    /// The motion.
    pub motion: TrialMotion,
    /// The load.
    pub load: TrialLoad,
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

/// Hold bands of the estimate of recursive least squares.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HoldBands {
    /// RMS of the platform's acceleration below which the estimate is not changed, m/s^2.
    pub dead_band_m_s2: f64,
    /// Share of the design's out-of-balance within which it is not followed.
    pub hold_band: f64,
    /// `true` if the exported controller adapts: it does not where no trial shows that it helps.
    pub is_exported: bool,
}

/// Trials of all methods.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AdaptationTrials {
    /// Rows: trial by trial, the methods in each.
    pub rows: Vec<TrialRow>,
    /// The rows that say most of what the adaptation is worth.
    #[serde(skip)]
    pub extremes: TrialExtremes,
    /// Methods that are refused for this project, with the reason.
    pub refused: Vec<MethodRefusal>,
    /// Hold bands of recursive least squares; absent for other methods.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bands: Option<HoldBands>,
    /// The hub's rate once the load has settled, of every run.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub histories: Vec<TrialHistory>,
}

/// The rows that say most of what an adaptation is worth.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TrialExtremes {
    /// The row with the largest hub rate with adaptation over that without; `None` if it is nowhere larger.
    pub worst: Option<TrialRow>,
    /// The row in which an unknown load adds most to the hub rate without adaptation; `None` if none adds to it.
    pub most_added: Option<TrialRow>,
}

impl TrialExtremes {
    /// Returns the extremes of trials.
    pub fn of(rows: &[TrialRow]) -> Self {
        let largest = |value: fn(&TrialRow) -> f64, above: f64| {
            let rows = rows.iter().filter(|row| value(row) > above);
            rows.max_by(|a, b| value(a).total_cmp(&value(b))).copied()
        };
        Self { worst: largest(TrialRow::ratio, 1.0), most_added: largest(TrialRow::added_share, 0.0) }
    }
}

/// The hub's rate in a run of a trial.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialHistory {
    /// The rate, whose name and unit the samples have.
    pub rate: ControlledQuantity,
    /// The motion.
    pub motion: TrialMotion,
    /// The load.
    pub load: TrialLoad,
    /// `none`, `told`, or the method's key.
    pub acts: &'static str,
    /// Sample time, s.
    pub sample_time_s: f64,
    /// From when the hub rate is measured until the end, rad/s; empty if the motion diverges.
    pub hub_rate_rad_s: Vec<f64>,
}

impl Serialize for TrialHistory {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(5))?;
        map.serialize_entry("motion", &self.motion)?;
        map.serialize_entry("load", &self.load)?;
        map.serialize_entry("acts", self.acts)?;
        map.serialize_entry("sample_time_s", &self.sample_time_s)?;
        map.serialize_entry(&self.rate.signal(), &self.hub_rate_rad_s)?;
        map.end()
    }
}

/// Why a method is refused.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MethodRefusal {
    /// The trial in which it does worst.
    pub worst: TrialRow,
    /// Hub rate with adaptation over that without, in that trial.
    pub ratio: f64,
}

/// Key of recursive least squares.
pub(super) const RECURSIVE: &str = "recursive";

/// A method of adaptation with its key in a project file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeyedMethod {
    /// The method.
    pub method: AdaptationMethod,
    /// Key.
    pub key: &'static str,
}

/// Every method with its key in a project file.
pub const METHODS: [KeyedMethod; 3] = [
    KeyedMethod { method: AdaptationMethod::Gradient, key: "gradient" },
    KeyedMethod { method: AdaptationMethod::WindowedMean, key: "windowed-mean" },
    KeyedMethod { method: AdaptationMethod::Recursive, key: RECURSIVE },
];

impl Serialize for TrialRow {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(7))?;
        map.serialize_entry("method", self.method)?;
        map.serialize_entry("motion", &self.motion)?;
        map.serialize_entry("load", &self.load)?;
        let rates = [self.without_rad_s, self.with_rad_s, self.told_rad_s, self.spread_rad_s];
        for (stem, value) in ["without", "with", "told", "spread"].into_iter().zip(rates) {
            map.serialize_entry(&self.rate.key_of(stem), &value)?;
        }
        map.end()
    }
}

impl TrialRow {
    /// Returns the hub rate with adaptation over that without. Where the load becomes less than designed, a controller that does not know it can
    /// do better by luck than one that does, because what is left of the imbalance can cancel friction: there the ratio is to the larger of both.
    pub fn ratio(&self) -> f64 {
        let known_rad_s = if self.load == TrialLoad::Lower { self.told_rad_s } else { 0.0 };
        self.with_rad_s / self.without_rad_s.max(known_rad_s)
    }

    /// Returns whether the adaptation does harm. A load that has returned to the designed one is right without any adaptation, and the estimate
    /// comes back to it but for its noise; of a smaller load friction hides more. On both harm begins where a method is refused.
    pub fn is_harmful(&self) -> bool {
        let allowed = match self.load {
            TrialLoad::Lower | TrialLoad::Returned => REFUSED_ABOVE,
            TrialLoad::Nominal | TrialLoad::WrongStart | TrialLoad::Sudden | TrialLoad::Slow => {
                1.0 + NEVER_WORSE
            }
        };
        self.ratio() > allowed
    }

    /// Returns by how much the hub rate without adaptation exceeds that with a known load, relative to it.
    pub fn added_share(&self) -> f64 {
        self.without_rad_s / self.told_rad_s - 1.0
    }

    /// Returns the share of the added hub rate that the adaptation removes; `None` if the load adds no more than a twentieth, or no more than
    /// what friction remembers of the runs before.
    pub fn removed_share(&self) -> Option<f64> {
        let added = self.without_rad_s - self.told_rad_s;
        let least = (LEAST_ADDED * self.told_rad_s).max(LEAST_ADDED_OVER_HYSTERESIS * self.spread_rad_s);
        (added > least).then(|| (self.without_rad_s - self.with_rad_s) / added)
    }
}

impl AdaptationTrials {
    /// Returns whether a method is refused.
    pub fn refuses(&self, method: AdaptationMethod) -> bool {
        let name = METHODS.iter().find(|row| row.method == method).map_or("", |row| row.key);
        self.refused.iter().any(|refused| refused.worst.method == name)
    }
}

/// Returns the trials of every method that the project's mechanism allows, by a procedure with or without a road.
///
/// # Errors
/// A project without adaptation, and those of the plant and the simulator.
pub fn run_trials(
    project: &Project,
    modelled: &PlantModel,
    made: &SynthesisedDesign,
    procedure: &Procedure,
) -> Result<AdaptationTrials, PipelineError> {
    let missing =
        PipelineError::Missing { section: "synth.adaptation", needed_by: "the trials of adaptation" };
    let adaptation = adaptation_options(project).ok_or(missing)?;
    let stage = Stage { project, adaptation, modelled, controller: &made.sampled.controller, procedure };
    let possible = |one: &KeyedMethod| {
        // the mean goes by gravity, which an axis without it does not have
        one.method != AdaptationMethod::WindowedMean || modelled.parameters.gravity_m_s2 != 0.0
    };
    let methods: Vec<_> = METHODS.into_iter().filter(possible).collect();
    run_methods(&stage, &methods)
}

/// Returns the trials of the project's own method; `None` if it does not adapt.
///
/// # Errors
/// Those of the plant and the simulator.
pub fn own_trials(
    project: &Project,
    modelled: &PlantModel,
    made: &SynthesisedDesign,
    procedure: &Procedure,
) -> Result<Option<AdaptationTrials>, PipelineError> {
    let Some(adaptation) = adaptation_options(project) else { return Ok(None) };
    let stage = Stage { project, adaptation, modelled, controller: &made.sampled.controller, procedure };
    let own: Vec<_> = METHODS.into_iter().filter(|one| one.method == adaptation.method).collect();
    let mut found = run_methods(&stage, &own)?;
    if adaptation.use_in_code == AdaptationUse::LeftOut {
        // what is not exported is not refused
        found.refused.clear();
    }
    Ok(Some(found))
}

pub(super) fn adaptation_options(project: &Project) -> Option<&AdaptationOptions> {
    project.synth.as_ref().and_then(|asked| asked.options.adaptation.as_ref())
}

fn run_methods(stage: &Stage, methods: &[KeyedMethod]) -> Result<AdaptationTrials, PipelineError> {
    let (mut rows, mut histories) = (Vec::new(), Vec::new());
    let sample_time_s = stage.modelled.parameters.interface.sample_period_s;
    let rate = stage.modelled.parameters.controlled_quantity().rate();
    for motion in MOTIONS {
        let platform = stage.platform(motion)?;
        for load in LOADS {
            let mut rms = |acts, name| {
                let hub_rate_rad_s = stage.run(&platform, load, acts)?.hub_rate_rad_s;
                let found = rms_or_infinite(&hub_rate_rad_s);
                histories.push(TrialHistory {
                    rate,
                    motion,
                    load,
                    acts: name,
                    sample_time_s,
                    hub_rate_rad_s,
                });
                Ok::<_, PipelineError>(found)
            };
            let (without_rad_s, told_rad_s) =
                (rms(TrialController::Without, "none")?, rms(TrialController::Told, "told")?);
            for &KeyedMethod { method, key } in methods {
                let with_rad_s = rms(TrialController::Adapts(method), key)?;
                let spread_rad_s = 0.0;
                let row = TrialRow {
                    rate,
                    method: key,
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
    let refused = methods.iter().filter_map(|one| refusal(one.key, &rows)).collect();
    let squares = methods.iter().any(|one| one.method == AdaptationMethod::Recursive);
    let bands = squares.then(|| bands(stage));
    Ok(AdaptationTrials { extremes: TrialExtremes::of(&rows), rows, refused, bands, histories })
}

/// Sets what the hub rate without adaptation differs by after a sudden and after a slow change, motion by motion.
pub(super) fn set_spreads(rows: &mut [TrialRow]) {
    for motion in MOTIONS {
        let after = |load| {
            let found = rows.iter().find(|row| row.motion == motion && row.load == load);
            found.map(|row| row.without_rad_s).filter(|rate| rate.is_finite())
        };
        let [sudden, slow] = [TrialLoad::Sudden, TrialLoad::Slow].map(after);
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
fn refusal(method: &'static str, rows: &[TrialRow]) -> Option<MethodRefusal> {
    let own = rows.iter().filter(|row| row.method == method);
    let worst = *own.max_by(|a, b| a.ratio().total_cmp(&b.ratio()))?;
    (worst.ratio() > REFUSED_ABOVE).then(|| MethodRefusal { worst, ratio: worst.ratio() })
}

/// Returns where recursive least squares act.
fn bands(stage: &Stage) -> HoldBands {
    let observer = stage.project.synth.as_ref().and_then(|asked| asked.options.observer.as_ref());
    let adaptation = AdaptationOptions { method: AdaptationMethod::Recursive, ..stage.adaptation.clone() };
    HoldBands {
        dead_band_m_s2: dead_band_m_s2(&adaptation, stage.modelled, observer),
        hold_band: hold_band(&adaptation),
        is_exported: adaptation.use_in_code == AdaptationUse::Exported,
    }
}
