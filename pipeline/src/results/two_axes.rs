//! Both axes verified together, as plain data.

use counterpoise_recordings::{ColumnName, Signals};
use counterpoise_verify::{JointRun, JointVerification, Verdict};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

/// Both axes together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointResult {
    /// Verdicts on both axes, in the order of the project file.
    pub verdicts: Vec<JointVerdictResult>,
    /// Every figure of both axes.
    pub figures: Vec<JointFigureResult>,
    /// Settling time from which on the figures are taken, s.
    pub settle_s: f64,
    /// The rate in cross-elevation over that of the ring, where the gyroscope of the traverse axis is on the ring; `None` if it is on the elevated mass.
    pub ring_to_sight: Option<f64>,
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
    /// Source of the requirement, as the project file states it; empty if it does not.
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

/// A run of both axes in samples. Each column is a key of its own in the results.
#[derive(Debug, Clone, PartialEq)]
pub struct JointHistoryResult {
    /// Beginning of the keys of its figures.
    pub experiment: &'static str,
    /// Sample period, s.
    pub sample_period_s: f64,
    /// Mean number of passes per sample until the torques between the axes no longer changed.
    pub passes_per_sample: f64,
    /// The samples.
    pub signals: Signals<JointColumn>,
}

/// A column of a run of both axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointColumn {
    /// Inertial rate of the elevation axis, rad/s.
    ElevationRate,
    /// Inertial rate of the ring about its axis, rad/s.
    RingRate,
    /// Inertial rate in cross-elevation, rad/s.
    CrossElevationRate,
    /// Elevation relative to the ring, rad.
    Elevation,
    /// Control of the elevation axis, V.
    ElevationControl,
    /// Control of the traverse axis, V.
    TraverseControl,
    /// Demand of the elevation axis, rad/s.
    ElevationDemand,
    /// Demand of the traverse axis, rad/s.
    TraverseDemand,
    /// Inertial rate of the elevation axis if each axis is alone, rad/s.
    ElevationRateAlone,
    /// Inertial rate of the traverse axis if each axis is alone, rad/s.
    TraverseRateAlone,
}

impl JointColumn {
    /// The columns with their keys in the results.
    const KEYS: [(Self, &'static str); 10] = [
        (Self::ElevationRate, "elevation_rate_rad_s"),
        (Self::RingRate, "ring_rate_rad_s"),
        (Self::CrossElevationRate, "cross_elevation_rate_rad_s"),
        (Self::Elevation, "elevation_rad"),
        (Self::ElevationControl, "elevation_control_v"),
        (Self::TraverseControl, "traverse_control_v"),
        (Self::ElevationDemand, "elevation_demand_rad_s"),
        (Self::TraverseDemand, "traverse_demand_rad_s"),
        (Self::ElevationRateAlone, "elevation_rate_alone_rad_s"),
        (Self::TraverseRateAlone, "traverse_rate_alone_rad_s"),
    ];
}

impl ColumnName for JointColumn {
    fn index(self) -> usize {
        self as usize
    }
}

impl Serialize for JointHistoryResult {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(3 + JointColumn::KEYS.len()))?;
        map.serialize_entry("experiment", self.experiment)?;
        map.serialize_entry("sample_period_s", &self.sample_period_s)?;
        map.serialize_entry("passes_per_sample", &self.passes_per_sample)?;
        for (column, key) in JointColumn::KEYS {
            map.serialize_entry(key, self.signals.column(column))?;
        }
        map.end()
    }
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
            settle_s: found.settle_s,
            ring_to_sight: found.ring_to_sight,
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
            signals: Signals::stack([
                history.elevation.truth.hub_rate_rad_s(),
                history.traverse.truth.hub_rate_rad_s(),
                history.cross_elevation_rate_rad_s(),
                history.elevation_rad(),
                history.elevation.readings.control_v(),
                history.traverse.readings.control_v(),
                history.elevation.readings.demand_rad_s(),
                history.traverse.readings.demand_rad_s(),
                &run.rates_alone.elevation,
                &run.rates_alone.traverse,
            ]),
        }
    }
}
