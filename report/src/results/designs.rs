//! The table of designs as a result file has it.

use counterpoise_pipeline::exchange::{SystemResult, UnitValue};
use counterpoise_pipeline::studies::designs::{DesignRow, DesignTable};
use counterpoise_pipeline::tuning::MeasuredLoops;
use serde::Serialize;

use crate::wording::designs::{describe_design_failure, describe_objective, name_motion};

/// Every design of a project in one table.
#[derive(Debug, Serialize)]
pub struct DesignTableText {
    /// Name of the mechanism.
    pub name: String,
    /// Hash of the project.
    pub hash: String,
    /// The quantity that the loops control, and in which units their figures are.
    #[serde(skip)]
    pub loops: MeasuredLoops,
    /// Objective of the tuned structures.
    pub objective: String,
    /// Motion that the last nonlinear run has.
    pub motion: &'static str,
    /// The disturbance of the linear loop: frequency in rad/s and power of each line at the output without feedback, in the square of the
    /// unit of what the loop controls.
    pub disturbance: Vec<[f64; 2]>,
    /// RMS of the white noise of a reading.
    #[serde(flatten)]
    pub reading_noise: UnitValue<f64>,
    /// The sampled plant of every loop, from the control to the reading.
    pub systems: Vec<SystemResult>,
    /// The designs, the project's own first.
    pub rows: Vec<DesignRow<String>>,
}

impl From<DesignTable> for DesignTableText {
    fn from(found: DesignTable) -> Self {
        let rows = found.rows.into_iter().map(|row| row.map_reason(describe_design_failure));
        Self {
            name: found.name,
            hash: found.hash,
            loops: found.loops,
            objective: describe_objective(found.objective, found.loops.controlled, found.motion),
            motion: name_motion(found.motion),
            disturbance: found.disturbance,
            reading_noise: found.reading_noise,
            systems: found.systems,
            rows: rows.collect(),
        }
    }
}
