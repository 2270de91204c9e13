//! The file `controller.json` that an export writes, read back: the same controller to the last bit.

use counterpoise_controller::{
    COMMON_READINGS, Controller, Correction, DemandLimit, Estimator, FrictionObserver, LevelLearning, Parts,
    Path, PathSignal, Projection, READINGS, Scaling,
};
use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};
use serde::Deserialize;

/// An exported controller as its file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct ControllerContent {
    /// The controller.
    pub controller: Controller,
    /// Hash of the project that it was exported from, as in the header of its C code.
    pub project_hash: String,
}

/// Beginning of the schema's name, without its version.
const SCHEMA: &str = "counterpoise.results/";

/// The keys of the file from which the controller is made; others describe it for other programs.
#[derive(Deserialize)]
struct ControllerFile {
    schema: String,
    project_hash: String,
    sample_time_s: f64,
    limit_v: f64,
    design_out_of_balance_kg_m: f64,
    out_of_balance_range_kg_m: [f64; 2],
    transfer_time_s: f64,
    bias_v_per_kg_m: f64,
    reading_limits: Vec<f64>,
    corrections: Vec<Correction>,
    #[serde(default)]
    projection: Option<Projection>,
    prefilter: Option<System>,
    #[serde(default)]
    demand_limit: Option<DemandLimit>,
    paths: Vec<FilePath>,
    observers: Vec<FrictionObserver>,
    #[serde(default)]
    level_learning: Option<LevelLearning>,
    estimator: Option<Estimator>,
    drive_curve: Vec<[f64; 2]>,
}

#[derive(Deserialize)]
struct FilePath {
    #[serde(flatten)]
    system: System,
    anti_windup: Vec<f64>,
    scaling: Scaling,
}

#[derive(Deserialize)]
#[allow(non_snake_case)]
struct System {
    name: String,
    sample_time_s: f64,
    A: Vec<Vec<f64>>,
    B: Vec<Vec<f64>>,
    C: Vec<Vec<f64>>,
    D: Vec<Vec<f64>>,
    inputs: Vec<NamedFormat>,
}

#[derive(Deserialize)]
struct NamedFormat {
    name: String,
}

/// Returns the controller in the text of a `controller.json`.
///
/// # Errors
/// The problem with it, in words: no JSON, a key that is missing or of another type, or numbers that make no controller.
pub(crate) fn parse(text: &str) -> Result<ControllerContent, String> {
    let file: ControllerFile = serde_json::from_str(text).map_err(|error| {
        format!("{error}: this is not a controller.json of this version of counterpoise; export it again")
    })?;
    if !file.schema.starts_with(SCHEMA) {
        let found = &file.schema;
        return Err(format!(
            "the schema is \"{found}\", not {SCHEMA}2: give the controller.json of an export"
        ));
    }
    let reading_limits = reading_limits(&file)?;
    let parts = Parts {
        sample_period_s: file.sample_time_s,
        corrections: file.corrections,
        projection: file.projection,
        prefilter: file.prefilter.as_ref().map(System::state_space).transpose()?,
        demand_limit: file.demand_limit,
        paths: file.paths.iter().map(FilePath::path).collect::<Result<_, _>>()?,
        observers: file.observers,
        level_learning: file.level_learning,
        design_out_of_balance_kg_m: file.design_out_of_balance_kg_m,
        out_of_balance_range_kg_m: file.out_of_balance_range_kg_m.into(),
        bias_v_per_kg_m: file.bias_v_per_kg_m,
        transfer_time_s: file.transfer_time_s,
        estimator: file.estimator,
        drive_curve: file.drive_curve,
        limit_v: file.limit_v,
        reading_limits,
    };
    let controller = Controller::new(parts).map_err(|error| error.to_string())?;
    Ok(ControllerContent { controller, project_hash: file.project_hash })
}

/// Returns the limits of all readings: one that the controller does not take keeps the usual limit.
fn reading_limits(file: &ControllerFile) -> Result<[f64; READINGS], String> {
    let mut limits = Parts::new(file.sample_time_s, file.limit_v).reading_limits;
    let given = &file.reading_limits;
    let wanted = if file.projection.is_some() { READINGS } else { COMMON_READINGS };
    if given.len() != wanted {
        return Err(format!(
            "reading_limits has {} values; this controller takes {wanted} readings",
            given.len()
        ));
    }
    limits.iter_mut().zip(given).for_each(|(limit, value)| *limit = *value);
    Ok(limits)
}

impl FilePath {
    fn path(&self) -> Result<Path, String> {
        let signal = |input: &NamedFormat| {
            let known = serde_json::from_value(serde_json::Value::String(input.name.clone()));
            known.map_err(|error| format!("an input of \"{}\": {error}", self.system.name))
        };
        Ok(Path {
            name: self.system.name.clone(),
            inputs: self.system.inputs.iter().map(signal).collect::<Result<Vec<PathSignal>, _>>()?,
            system: self.system.state_space()?,
            anti_windup: self.anti_windup.clone(),
            scaling: self.scaling,
        })
    }
}

impl System {
    fn state_space(&self) -> Result<StateSpace, String> {
        let (states, inputs) = (self.A.len(), self.inputs.len());
        let matrix = |name: &str, rows: &[Vec<f64>], shape: (usize, usize)| {
            let fits = rows.len() == shape.0 && rows.iter().all(|row| row.len() == shape.1);
            let wrong = || format!("{name} of \"{}\" must have {} rows of {}", self.name, shape.0, shape.1);
            fits.then(|| Mat::from_fn(shape.0, shape.1, |i, j| rows[i][j])).ok_or_else(wrong)
        };
        StateSpace::new(
            matrix("A", &self.A, (states, states))?,
            matrix("B", &self.B, (states, inputs))?,
            matrix("C", &self.C, (1, states))?,
            matrix("D", &self.D, (1, inputs))?,
            Timebase::Discrete { period_s: self.sample_time_s },
        )
        .map_err(|error| format!("\"{}\": {error}", self.name))
    }
}
