//! A given structure, fitted to the first part of every recording and judged on the rest: what the outcome of a search is
//! to be measured against.

use counterpoise_models::Parameters;
use counterpoise_simulate::recording::Recording;
use counterpoise_simulate::replay::Loop;

use crate::bench::{Bench, Pool};
use crate::error::Error;
use crate::fit::{Problem, Selection};
use crate::library::Effect;
use crate::noise::as_heard;
use crate::replays::{Prepared, Replays};
use crate::score::{Part, judge, score};
use crate::tolerance::FITTED_SHARE;

/// Effects that are fitted together, and the values of their knobs from which to start.
#[derive(Debug, Clone, Default)]
pub struct Structure {
    /// Effects; none for the model as it is.
    pub effects: Vec<&'static Effect>,
    /// Values, effect after effect.
    pub start: Vec<f64>,
}

/// For each structure, the mean ln(RMS / floor) that it leaves on the last part of every recording, fitted to the first;
/// none where it cannot be simulated. 0 is perfect.
///
/// # Errors
/// A recording that cannot be replayed.
pub fn refit(
    base: &Parameters,
    control: impl Into<Loop>,
    recordings: &[Recording],
    structures: &[Structure],
    pool: &dyn Pool,
) -> Result<Vec<Option<f64>>, Error> {
    let base = &as_heard(base, recordings);
    let prepared = Prepared::new(recordings, base);
    let bench = Replays::new(base, &control.into(), &prepared)?;
    Ok(structures.iter().map(|structure| left(&bench, pool, base, structure)).collect())
}

fn left(bench: &dyn Bench, pool: &dyn Pool, base: &Parameters, structure: &Structure) -> Option<f64> {
    let recordings: Vec<usize> = (0..bench.count()).collect();
    let parts: Vec<Part> =
        recordings.iter().map(|&recording| Part { recording, from: FITTED_SHARE, to: 1.0 }).collect();
    let selection = Selection::heads(recordings);
    let parameters = if structure.effects.is_empty() {
        base.clone()
    } else {
        let effects = structure.effects.clone();
        let problem = Problem { bench, pool, selection: &selection, base, effects, stances: &[] };
        problem.fit(&structure.start)?.parameters
    };
    Some(score(&judge(bench, pool, &parameters)?, &parts)?.distance())
}
