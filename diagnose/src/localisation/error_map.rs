//! Component x regime: where the recordings depart from the replay, and along which variable.
//!
//! At every component an error is let in that is a free function of one regime variable (`error_hypotheses`), as it would
//! show in all balances at once (`ports`); what it gains on stretches of the recordings that it was not fitted to is the
//! cell. Nothing is named by it: it is told which component, and what the function looks like.

use counterpoise_models::Parameters;
use serde::Serialize;

use crate::localisation::error_hypotheses::{
    COMPONENTS, ERROR_HYPOTHESES, ErrorHypothesis, Law, Quantity, REGIMES,
};
use crate::localisation::free_functions::{fitted_shape, knots, on_knots, sines, turns, waves};
use crate::localisation::residual_regression::{ResidualRegression, Series};
use crate::localisation::torque_balances::BalanceVisibility;
use crate::recording::measured_signals::MeasuredSignals;
use crate::simulator_access::{Assessment, Pool, map};
use crate::tolerance::{AMBIGUOUS, GAIN_NEEDED};

/// Share of the best gain by which a component may be behind and not be told apart: what the balances leave out is no noise.
const ALIKE: f64 = 0.1;
/// Share of what a perfect explanation would gain from which a cell is described in words.
const DESCRIBED: f64 = 0.1;

/// What an error at one component would explain that is a free function of one regime variable.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MapCell {
    /// Component.
    pub component: &'static str,
    /// Regime variable.
    pub regime: &'static str,
    /// Share, 0 to 1, of the log-likelihood that a perfect explanation would gain; 0 where it gains no more than chance may.
    pub explained: f64,
    /// Log-likelihood gained on data not used to find it, in nats.
    pub gain_nats: f64,
    /// Shape of that function in words; empty where the variable explains little or the shape is not a simple one.
    pub shape: String,
}

/// Component x regime of recordings, each with the replay that was judged on it, best first within a component.
pub fn localise_errors(
    parameters: &Parameters,
    recordings: &[(MeasuredSignals, Assessment)],
    isolability: &[BalanceVisibility],
    pool: &dyn Pool,
) -> Vec<MapCell> {
    let Some(departures) = ResidualRegression::new(parameters, recordings) else { return Vec::new() };
    let seen =
        |s: &&ErrorHypothesis| isolability.iter().any(|row| row.available && row.sees.contains(&s.component));
    let suspects: Vec<&ErrorHypothesis> = ERROR_HYPOTHESES.iter().filter(seen).collect();
    let found = map(pool, suspects.len(), |k| {
        let tried = FittedHypothesis::of(&departures, suspects[k])?;
        let gain = departures.gain(&tried.columns).filter(|gain| gain.is_finite())?;
        Some((gain, cell(&departures, suspects[k], &tried, gain)))
    });
    let mut found: Vec<(f64, MapCell)> = found.into_iter().flatten().collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut cells: Vec<MapCell> = Vec::new();
    for (_, cell) in found {
        if !cells.iter().any(|c| c.component == cell.component && c.regime == cell.regime) {
            cells.push(cell);
        }
    }
    cells.sort_by_key(|c| (COMPONENTS.iter().position(|n| *n == c.component), place(c.regime)));
    cells
}

/// FitState of a regime among [`REGIMES`].
pub(crate) fn place(regime: &str) -> Option<usize> {
    REGIMES.iter().position(|n| *n == regime)
}

fn cell(
    departures: &ResidualRegression,
    suspect: &ErrorHypothesis,
    tried: &FittedHypothesis,
    gain: f64,
) -> MapCell {
    let share = gain / departures.possible().max(GAIN_NEEDED);
    let explained = if gain > GAIN_NEEDED { share.clamp(0.0, 1.0) } else { 0.0 };
    let shape = if explained > DESCRIBED { tried.shape(departures, suspect) } else { String::new() };
    MapCell { component: suspect.component, regime: suspect.regime, explained, gain_nats: gain, shape }
}

/// A suspect as columns of the departures.
struct FittedHypothesis {
    columns: Vec<Vec<f64>>,
    /// Knots of a free function.
    knots: Vec<f64>,
    /// How it repeats, in words.
    repeats: String,
}

impl FittedHypothesis {
    fn of(departures: &ResidualRegression, suspect: &ErrorHypothesis) -> Option<Self> {
        let all = |q: Quantity| departures.all(q);
        let plain = |columns| Self { columns, knots: Vec::new(), repeats: String::new() };
        match suspect.law {
            Law::Free(port, variable, carrier) => {
                let (variables, carriers) = (all(variable), all(carrier));
                let knots = knots(&variables, variable.is_dense_at_rest())?;
                let columns = departures.columns(port, &on_knots(&variables, &carriers, &knots));
                Some(Self { knots, ..plain(columns) })
            }
            Law::Fixed(terms) => {
                Some(plain(terms.iter().map(|(port, q)| departures.column(&[(*port, &all(*q))])).collect()))
            }
            Law::OneOf(port, several) => {
                let columns = several.iter().map(|q| departures.columns(port, &[all(*q)]));
                let gains = columns.filter_map(|c| Some((departures.gain(&c)?, c)));
                gains.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, columns)| plain(columns))
            }
            Law::Together(terms) => {
                let series: Vec<Series> = terms.iter().map(|(_, q)| all(*q)).collect();
                let terms: Vec<_> = terms.iter().zip(&series).map(|((port, _), s)| (*port, s)).collect();
                Some(plain(vec![departures.column(&terms)]))
            }
            Law::Sine(..) | Law::Repeats(..) | Law::Turns(..) => Self::repeating(departures, suspect.law),
        }
    }

    /// A suspect that repeats.
    fn repeating(departures: &ResidualRegression, law: Law) -> Option<Self> {
        let (columns, repeats) = match law {
            Law::Sine(port, carrier) => {
                let (frequency, series) = sines(departures, &departures.all(carrier))?;
                let doubt = departures.period_doubt(frequency);
                let words = format!("it repeats every {:.4} +/- {doubt:.4} s", 1.0 / frequency);
                (departures.columns(port, &series), words)
            }
            Law::Repeats(port, variable, carrier) => {
                let along = departures.all(variable);
                let found = departures.repetition(&along)?;
                let series = waves(std::f64::consts::TAU * found.frequency, &along, &departures.all(carrier));
                (departures.columns(port, &series), found.told(variable.unit()))
            }
            Law::Turns(port, carrier) => {
                let (order, columns) = turns(departures, port, &departures.all(carrier))?;
                (columns, format!("it repeats every 1/{order:.0} turn of the motor"))
            }
            _ => return None,
        };
        Some(Self { columns, knots: Vec::new(), repeats })
    }

    /// What the function looks like, in words.
    fn shape(&self, departures: &ResidualRegression, suspect: &ErrorHypothesis) -> String {
        let Law::Free(_, variable, _) = suspect.law else { return self.repeats.clone() };
        let coefficients = departures.coefficients(&self.columns).unwrap_or_default();
        let along: Vec<f64> = departures.all(variable).concat();
        fitted_shape(&self.knots, &coefficients, &along, variable.unit())
    }
}

/// The components that may hold what the model lacks, the likeliest first: the one at which an error explains most, and those that
/// these recordings cannot tell from it. None where no component explains enough.
pub fn likeliest(map: &[MapCell]) -> Vec<&'static str> {
    let best = |component: &str| {
        map.iter().filter(|c| c.component == component).map(|c| c.gain_nats).fold(0.0, f64::max)
    };
    let all: Vec<(&'static str, f64)> =
        COMPONENTS.iter().map(|c| (*c, best(c))).filter(|(_, gain)| *gain > GAIN_NEEDED).collect();
    let most = all.iter().map(|(_, gain)| *gain).fold(0.0, f64::max);
    let mut near: Vec<_> =
        all.into_iter().filter(|(_, gain)| most - gain < (ALIKE * most).max(AMBIGUOUS)).collect();
    // equal to what the noise decides: the likelier beforehand first
    near.sort_by(|a, b| (most - b.1 < AMBIGUOUS).cmp(&(most - a.1 < AMBIGUOUS)).then(b.1.total_cmp(&a.1)));
    let ties = near.iter().filter(|(_, gain)| most - gain < AMBIGUOUS).count();
    near[..ties].sort_by_key(|(name, _)| COMPONENTS.iter().position(|c| c == name));
    near.into_iter().map(|(name, _)| name).collect()
}
