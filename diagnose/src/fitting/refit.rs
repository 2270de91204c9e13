//! A given structure, fitted to the first part of every recording and assessed on the rest: the outcome of a search is measured
//! against it.

use counterpoise_models::Parameters;
use counterpoise_recordings::Recording;
use counterpoise_simulate::replay::ReplayLoop;

use crate::error::Error;
use crate::fitting::output_error::{FitSelection, Problem};
use crate::fitting::score::{RecordingPart, assess_recordings, score_parts};
use crate::library::Effect;
use crate::recording::noise::with_recorded_noise;
use crate::simulator_access::SimulatorAccess;
use crate::simulator_access::objective::{PreparedRecordings, RecordingReplays};
use crate::tolerance::FITTED_SHARE;
use counterpoise_pool::Pool;

/// Effects that are fitted together, and the values of their parameters from which the fit starts.
#[derive(Debug, Clone, Default)]
pub struct Structure {
    /// Effects; empty for the model as it is.
    pub effects: Vec<&'static Effect>,
    /// Values, effect after effect.
    pub start: Vec<f64>,
}

/// Returns, for each structure, the mean ln(RMS / noise floor) on the last part of every recording after a fit to the first, 0
/// being perfect; `None` if the structure cannot be simulated.
///
/// # Errors
/// A recording that cannot be replayed.
pub fn refit(
    base: &Parameters,
    control: impl Into<ReplayLoop>,
    recordings: &[Recording],
    structures: &[Structure],
    pool: &dyn Pool,
) -> Result<Vec<Option<f64>>, Error> {
    let base = &with_recorded_noise(base, recordings);
    let prepared = PreparedRecordings::new(recordings, base);
    let simulator = RecordingReplays::new(base, &control.into(), &prepared)?;
    Ok(structures.iter().map(|structure| refit_one(&simulator, pool, base, structure)).collect())
}

fn refit_one(
    simulator: &dyn SimulatorAccess,
    pool: &dyn Pool,
    base: &Parameters,
    structure: &Structure,
) -> Option<f64> {
    let recordings: Vec<usize> = (0..simulator.count()).collect();
    let parts: Vec<RecordingPart> = recordings
        .iter()
        .map(|&recording| RecordingPart { recording, from: FITTED_SHARE, to: 1.0 })
        .collect();
    let selection = FitSelection::first_parts(recordings);
    let parameters = if structure.effects.is_empty() {
        base.clone()
    } else {
        let effects = structure.effects.clone();
        let problem = Problem {
            simulator,
            pool,
            selection: &selection,
            base,
            effects,
            assessments: &[],
            preferences: &[],
        };
        problem.fit(&structure.start)?.parameters
    };
    Some(score_parts(&assess_recordings(simulator, pool, &parameters)?, &parts)?.distance())
}
