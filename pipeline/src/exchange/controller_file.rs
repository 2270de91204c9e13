//! The exported controller as plain data: the file `controller.json` beside the code.
//!
//! The file is complete: `counterpoise_project::resolve::controller_file` makes the same controller of it, to the last bit, for the
//! replay of recordings.

use counterpoise_controller::{
    COMMON_READINGS, Controller, Correction, DemandLimit, Estimator, FrictionObserver, LevelLearning, Path,
    PathSignal, Projection, READING_NAMES, Scaling,
};
use counterpoise_models::ControlledQuantity;
use serde::Serialize;

use super::SCHEMA;
use super::systems::SystemResult;
use crate::ProjectIdentity;

/// A controller: the paths from readings to volts, and what acts beside them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ControllerResult {
    /// Name and version of the schema.
    pub schema: &'static str,
    /// Name of the mechanism.
    pub project: String,
    /// Hash of the project, as in the header of the C code.
    pub project_hash: String,
    /// Sample time, s.
    pub sample_time_s: f64,
    /// The control is limited to plus and minus this, V.
    pub limit_v: f64,
    /// Out-of-balance that the paths were designed for, kg m.
    pub design_out_of_balance_kg_m: f64,
    /// Lowest and highest out-of-balance that may be set, kg m.
    pub out_of_balance_range_kg_m: [f64; 2],
    /// Time constant with which the step of a changed out-of-balance fades in, s.
    pub transfer_time_s: f64,
    /// Volts that hold one kg m against gravity, V/(kg m).
    pub bias_v_per_kg_m: f64,
    /// Largest magnitude of each reading that the controller takes: those of the inputs of `linear`, then that of surge where it is projected.
    pub reading_limits: Vec<f64>,
    /// Corrections of readings before anything else.
    pub corrections: Vec<Correction>,
    /// Projection of heave and surge across the beam; absent if the heave reading is taken as it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub projection: Option<Projection>,
    /// Filter of the demand; `None` if there is none.
    pub prefilter: Option<SystemResult>,
    /// Limit of the rate with which a loop of position follows its demand; absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub demand_limit: Option<DemandLimit>,
    /// The paths, whose outputs are summed.
    pub paths: Vec<PathResult>,
    /// Friction observers, summed after the paths.
    pub observers: Vec<FrictionObserver>,
    /// Learning of the friction's level; absent if what the observers give is cancelled.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub level_learning: Option<LevelLearning>,
    /// `true` if the controller estimates the out-of-balance while it runs.
    pub estimates_out_of_balance: bool,
    /// Estimator of the out-of-balance; `None` if it has none.
    pub estimator: Option<Estimator>,
    /// The inverse of the drive's curve as pairs (volts of a linear drive, control), V; empty if the drive is linear.
    pub drive_curve: Vec<[f64; 2]>,
    /// From all readings to the control at the design out-of-balance, without limits, observers and estimator.
    pub linear: Option<SystemResult>,
}

/// A path of the controller.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PathResult {
    /// System, from its signals to volts.
    #[serde(flatten)]
    pub system: SystemResult,
    /// Gain a state on what the limiter cut off.
    pub anti_windup: Vec<f64>,
    /// Scaling of the output with the out-of-balance.
    pub scaling: Scaling,
}

impl ControllerResult {
    /// Returns a controller as plain data.
    pub fn new(identity: &ProjectIdentity, controller: &Controller) -> Self {
        let parts = controller.parts();
        let linear = controller.linear(parts.design_out_of_balance_kg_m).ok();
        Self {
            schema: SCHEMA,
            project: identity.name.clone(),
            project_hash: identity.hash.clone(),
            sample_time_s: parts.sample_period_s,
            limit_v: parts.limit_v,
            design_out_of_balance_kg_m: parts.design_out_of_balance_kg_m,
            out_of_balance_range_kg_m: parts.out_of_balance_range_kg_m.into(),
            transfer_time_s: parts.transfer_time_s,
            bias_v_per_kg_m: parts.bias_v_per_kg_m,
            reading_limits: parts.reading_limits[..parts.reading_count()].to_vec(),
            corrections: parts.corrections.clone(),
            projection: parts.projection,
            prefilter: parts.prefilter.as_ref().map(|system| {
                SystemResult::new("prefilter", system, &["demand_rad_s"], &["filtered_demand_rad_s"])
            }),
            demand_limit: parts.demand_limit,
            paths: parts.paths.iter().map(PathResult::of).collect(),
            observers: parts.observers.clone(),
            level_learning: parts.level_learning,
            estimates_out_of_balance: parts.estimator.is_some(),
            estimator: parts.estimator.clone(),
            drive_curve: parts.drive_curve.clone(),
            linear: linear.map(|system| {
                SystemResult::new(
                    "linear controller",
                    &system,
                    &READING_NAMES[..COMMON_READINGS],
                    &["control_v"],
                )
            }),
        }
    }
}

impl PathResult {
    /// Returns a path as plain data.
    pub fn of(path: &Path) -> Self {
        let inputs: Vec<&str> = path.inputs.iter().map(|signal: &PathSignal| signal.name()).collect();
        let system = SystemResult::new(&path.name, &path.system, &inputs, &["control_v"]);
        Self { system, anti_windup: path.anti_windup.clone(), scaling: path.scaling }
    }

    /// Returns the same path with its signals under their names in the loop of a quantity.
    pub fn of_loop(self, controlled: ControlledQuantity) -> Self {
        Self { system: self.system.of_loop(controlled), ..self }
    }
}
