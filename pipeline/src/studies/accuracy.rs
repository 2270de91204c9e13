//! The accuracy of the simulator on this plant: its error over the step, for every law of friction and for contact.

use counterpoise_pool::{Pool, map};
use counterpoise_simulate::convergence::{Case, convergence_cases, study_convergence};
use serde::Serialize;

use crate::{PipelineError, PlantModel};

/// Lengths of steps that are looked at: eight sample periods and its halves.
const LENGTHS: usize = 7;

/// The simulator's error with one law of friction at the pivot, or with teeth that part and meet.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Accuracy {
    /// The law, or `contact`.
    pub name: &'static str,
    /// `true` if the law truly sticks.
    pub sticks: bool,
    /// Lengths of the steps, s, from the longest.
    pub step_s: Vec<f64>,
    /// Largest error of the hub rate relative to the largest rate, with the simulator's own steps within a sample of that length.
    pub error: Vec<f64>,
    /// The same with steps of that length only, no instant of a change found.
    pub plain: Vec<f64>,
    /// Order of `plain`; `None` if it is exact.
    pub order: Option<f64>,
    /// Estimated error of the second method, with which both are compared.
    pub second_method: f64,
}

/// Returns the errors on the modelled plant, against the classical Runge-Kutta method in steps a thousand times
/// shorter.
///
/// # Errors
/// A plant that a law does not fit, or that cannot be simulated.
pub fn simulation_accuracy(modelled: &PlantModel, pool: &dyn Pool) -> Result<Vec<Accuracy>, PipelineError> {
    let all = convergence_cases(&modelled.plant)?;
    let found = map(pool, all.len(), |k| one(&all[k]));
    found.into_iter().collect()
}

fn one(case: &Case) -> Result<Accuracy, PipelineError> {
    let found = study_convergence(&case.plant, case.control_v, LENGTHS)?;
    let order = Some(found.order()).filter(|order| order.is_finite());
    Ok(Accuracy {
        name: case.name,
        sticks: case.sticks,
        order,
        step_s: found.step_s,
        error: found.finding_events,
        plain: found.error,
        second_method: found.second_method,
    })
}
