//! Both axes verified together, as plain data.

use counterpoise_verify::{JointRun, JointVerification, Verdict};
use serde::Serialize;

/// Both axes together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointResult {
    /// Verdicts on both axes, in the order of the project file.
    pub verdicts: Vec<JointVerdictResult>,
    /// Every figure of both axes.
    pub figures: Vec<JointFigureResult>,
    /// Time histories of both axes; absent unless they were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub histories: Vec<JointHistoryResult>,
}

/// A requirement on both axes with its verdict.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointVerdictResult {
    /// Key of the figure.
    pub figure: String,
    /// `holds` or `fails`.
    pub verdict: &'static str,
    /// Value.
    pub value: Option<f64>,
    /// Limit.
    pub limit: f64,
    /// `at least` or `at most`.
    pub limit_side: &'static str,
    /// Where the requirement comes from, as the project file states it; empty if it does not.
    pub source: String,
}

/// A figure of both axes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointFigureResult {
    /// Key, as in a project file.
    pub figure: String,
    /// With both axes.
    pub value: f64,
    /// With each axis alone.
    pub alone: f64,
    /// Unit.
    pub unit: &'static str,
}

/// A run of both axes in samples.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointHistoryResult {
    /// Beginning of the keys of its figures.
    pub experiment: &'static str,
    /// Sample period, s.
    pub sample_period_s: f64,
    /// How often a sample was taken on the average, until the torques between the axes no longer changed.
    pub passes_per_sample: f64,
    /// Inertial rate of the elevation axis, rad/s.
    pub elevation_rate_rad_s: Vec<f64>,
    /// Inertial rate of the ring about its axis, rad/s.
    pub ring_rate_rad_s: Vec<f64>,
    /// Inertial rate in cross-elevation, rad/s.
    pub cross_elevation_rate_rad_s: Vec<f64>,
    /// Elevation relative to the ring, rad.
    pub elevation_rad: Vec<f64>,
    /// Control of the elevation axis, V.
    pub elevation_control_v: Vec<f64>,
    /// Control of the traverse axis, V.
    pub traverse_control_v: Vec<f64>,
}

impl From<&JointVerification> for JointResult {
    fn from(found: &JointVerification) -> Self {
        let verdicts = found.verdicts.iter().map(|(requirement, verdict)| JointVerdictResult {
            figure: requirement.figure.key(),
            verdict: match verdict {
                Verdict::Holds { .. } => "holds",
                Verdict::Fails { .. } => "fails",
                Verdict::NotApplicable { .. } => "not applicable",
            },
            value: match verdict {
                Verdict::Holds { value, .. } | Verdict::Fails { value, .. } => Some(*value),
                Verdict::NotApplicable { .. } => None,
            },
            limit: requirement.limit.value(),
            limit_side: requirement.limit.side(),
            source: requirement.source.clone(),
        });
        let figures = found.values.iter().map(|value| JointFigureResult {
            figure: value.figure.key(),
            value: value.together,
            alone: value.alone,
            unit: value.figure.quantity.unit(),
        });
        Self {
            verdicts: verdicts.collect(),
            figures: figures.collect(),
            histories: found.runs.iter().map(Into::into).collect(),
        }
    }
}

impl From<&JointRun> for JointHistoryResult {
    fn from(run: &JointRun) -> Self {
        let history = &run.history;
        Self {
            experiment: run.experiment.key(),
            sample_period_s: history.elevation.sample_period_s,
            passes_per_sample: history.passes_per_sample,
            elevation_rate_rad_s: history.elevation.truth.hub_rate_rad_s().to_vec(),
            ring_rate_rad_s: history.traverse.truth.hub_rate_rad_s().to_vec(),
            cross_elevation_rate_rad_s: history.cross_elevation_rate_rad_s.clone(),
            elevation_rad: history.elevation_rad.clone(),
            elevation_control_v: history.elevation.readings.control_v().to_vec(),
            traverse_control_v: history.traverse.readings.control_v().to_vec(),
        }
    }
}
