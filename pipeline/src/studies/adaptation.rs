//! The adaptation put to the test in the nonlinear closed loop: the eight runs, and the trials of every method.

use counterpoise_project::Project;

use crate::studies::adapt::{AdaptRun, adapt};
use crate::studies::adaptation_trials::{AdaptationTrials, run_trials};
use crate::{PipelineError, World, build_plant_model, project_procedure, reduce_plant, synthesise};

/// The adaptation put to the test.
#[derive(Debug, Clone, PartialEq)]
pub struct AdaptResult {
    /// The runs (a) to (h).
    pub runs: Vec<AdaptRun>,
    /// Trials of every method, and the methods that are refused.
    pub trials: AdaptationTrials,
}

impl AdaptResult {
    /// Leaves out the time histories.
    pub fn leave_histories_out(&mut self) {
        self.trials.histories.clear();
        for interval in self.runs.iter_mut().flat_map(|run| &mut run.intervals) {
            interval.settled_rates_rad_s.clear();
            interval.default_rates_rad_s.clear();
        }
    }
}

/// Designs the project's controller and puts its adaptation to the test.
///
/// # Errors
/// Those of model, design, procedure and simulator.
pub fn study_adaptation(project: &Project, world: &dyn World) -> Result<AdaptResult, PipelineError> {
    let modelled = build_plant_model(project)?;
    let made = synthesise(project, &modelled, &reduce_plant(project, &modelled)?)?;
    let runs = adapt(project, &modelled, &made)?;
    let trials = run_trials(project, &modelled, &made, &project_procedure(project, world)?)?;
    Ok(AdaptResult { runs, trials })
}
