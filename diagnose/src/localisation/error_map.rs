//! The localisation: component by regime, what an error there would explain of the residuals of the replay.
//!
//! At every component an error is tried that is a free function of one regime variable (`error_hypotheses`), as it would show in
//! all balances at once (`ports`). What it gains on held-out stretches of the recordings is the value of the cell. No effect is
//! named by it: it states the component, and what the function looks like.

use crate::tolerance::localisation::{CLASSIFIED_GAIN_SHARE, EQUIVALENT_COMPONENT_SHARE};
use counterpoise_models::Parameters;

use crate::library::Component;
use crate::localisation::error_hypotheses::{
    COMPONENTS, ERROR_HYPOTHESES, ErrorHypothesis, Law, Regime, SignalQuantity,
};
use crate::localisation::free_functions::{
    KnotSpacing, best_motor_order, classify_knot_function, hat_series, place_knots, sines, waves,
};
use crate::localisation::residual_regression::{AssessedReplay, ErrorTerm, ResidualRegression, Series};
use crate::localisation::torque_balances::BalanceVisibility;
use crate::localisation::trend::{Repetition, Trend};
use crate::tolerance::{AMBIGUOUS, GAIN_NEEDED};
use counterpoise_pool::{Pool, map};

/// Gain that an error at one component explains if it is a free function of one regime variable.
#[derive(Debug, Clone, PartialEq)]
pub struct MapCell {
    /// Component.
    pub component: Component,
    /// Regime variable.
    pub regime: Regime,
    /// Share, 0 to 1, of the log-likelihood that a perfect explanation would gain; 0 if it gains no more than noise may.
    pub explained: f64,
    /// Log-likelihood gained on held-out data.
    pub log_likelihood_gain: f64,
    /// Course of that function; `None` if the variable explains little or the function has no simple form.
    pub trend: Option<Trend>,
}

/// Tries every error hypothesis on recordings with their replays; returns the cells component by component.
pub fn localise_errors(
    parameters: &Parameters,
    recordings: &[AssessedReplay],
    isolability: &[BalanceVisibility],
    pool: &dyn Pool,
) -> Vec<MapCell> {
    let Some(regression) = ResidualRegression::new(parameters, recordings) else { return Vec::new() };
    let seen =
        |s: &&ErrorHypothesis| isolability.iter().any(|row| row.available && row.sees.contains(&s.component));
    let hypotheses: Vec<&ErrorHypothesis> = ERROR_HYPOTHESES.iter().filter(seen).collect();
    let found = map(pool, hypotheses.len(), |k| {
        let tried = FittedHypothesis::of(&regression, hypotheses[k])?;
        let gain = regression.gain(&tried.columns).filter(|gain| gain.is_finite())?;
        Some((gain, cell(&regression, hypotheses[k], &tried, gain)))
    });
    let mut found: Vec<(f64, MapCell)> = found.into_iter().flatten().collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut cells: Vec<MapCell> = Vec::new();
    for (_, cell) in found {
        if !cells.iter().any(|c| c.component == cell.component && c.regime == cell.regime) {
            cells.push(cell);
        }
    }
    cells.sort_by_key(|c| (COMPONENTS.iter().position(|n| *n == c.component), c.regime));
    cells
}

fn cell(
    regression: &ResidualRegression,
    hypothesis: &ErrorHypothesis,
    tried: &FittedHypothesis,
    gain: f64,
) -> MapCell {
    let share = gain / regression.largest_gain().max(GAIN_NEEDED);
    let explained = if gain > GAIN_NEEDED { share.clamp(0.0, 1.0) } else { 0.0 };
    let trend = if explained > CLASSIFIED_GAIN_SHARE { tried.trend(regression, hypothesis) } else { None };
    MapCell {
        component: hypothesis.component,
        regime: hypothesis.regime,
        explained,
        log_likelihood_gain: gain,
        trend,
    }
}

/// An error hypothesis as columns of the regression.
struct FittedHypothesis {
    columns: Vec<Vec<f64>>,
    /// Knots of a free function.
    knots: Vec<f64>,
    /// Its periodic trend.
    repeats: Option<Trend>,
}

impl FittedHypothesis {
    fn of(regression: &ResidualRegression, hypothesis: &ErrorHypothesis) -> Option<Self> {
        let all = |q: SignalQuantity| regression.all(q);
        let plain = |columns| Self { columns, knots: Vec::new(), repeats: None };
        match hypothesis.law {
            Law::Free(port, variable, carrier) => {
                let (variables, carriers) = (all(variable), all(carrier));
                let spacing =
                    if variable.is_dense_at_rest() { KnotSpacing::DenseAtRest } else { KnotSpacing::Even };
                let knots = place_knots(&variables, spacing)?;
                let columns = regression.columns(port, &hat_series(&variables, &carriers, &knots));
                Some(Self { knots, ..plain(columns) })
            }
            Law::Fixed(terms) => Some(plain(
                terms
                    .iter()
                    .map(|(port, q)| regression.column(&[ErrorTerm { port: *port, error: &all(*q) }]))
                    .collect(),
            )),
            Law::OneOf(port, several) => {
                let columns = several.iter().map(|q| regression.columns(port, &[all(*q)]));
                let gains = columns.filter_map(|c| Some((regression.gain(&c)?, c)));
                gains.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, columns)| plain(columns))
            }
            Law::Together(terms) => {
                let series: Vec<Series> = terms.iter().map(|(_, q)| all(*q)).collect();
                let terms =
                    terms.iter().zip(&series).map(|((port, _), error)| ErrorTerm { port: *port, error });
                let terms: Vec<ErrorTerm> = terms.collect();
                Some(plain(vec![regression.column(&terms)]))
            }
            Law::Sine(..) | Law::Repeats(..) | Law::Turns(..) => {
                Self::fit_repeating(regression, hypothesis.law)
            }
        }
    }

    /// Fits a hypothesis that repeats.
    fn fit_repeating(regression: &ResidualRegression, law: Law) -> Option<Self> {
        let (columns, repeats) = match law {
            Law::Sine(port, carrier) => {
                let (frequency, series) = sines(regression, &regression.all(carrier))?;
                let doubt = regression.period_doubt(frequency);
                let repetition = Repetition::InTime { period_s: 1.0 / frequency, half_width_s: doubt };
                (regression.columns(port, &series), Trend::Periodic { repetition: Some(repetition) })
            }
            Law::Repeats(port, variable, carrier) => {
                let along = regression.all(variable);
                let found = regression.repetition(&along)?;
                let series = waves(std::f64::consts::TAU * found.frequency, &along, &regression.all(carrier));
                (regression.columns(port, &series), found.trend(variable.unit()))
            }
            Law::Turns(port, carrier) => {
                let (order, columns) = best_motor_order(regression, port, &regression.all(carrier))?;
                (columns, Trend::Periodic { repetition: Some(Repetition::WithMotorTurn { order }) })
            }
            _ => return None,
        };
        Some(Self { columns, knots: Vec::new(), repeats: Some(repeats) })
    }

    /// Returns what the function looks like.
    fn trend(&self, regression: &ResidualRegression, hypothesis: &ErrorHypothesis) -> Option<Trend> {
        let Law::Free(_, variable, _) = hypothesis.law else { return self.repeats };
        let coefficients = regression.coefficients(&self.columns).unwrap_or_default();
        let along: Vec<f64> = regression.all(variable).concat();
        classify_knot_function(&self.knots, &coefficients, &along, variable.unit())
    }
}

/// Returns the components that may contain what the model lacks, the most probable first: the one at which an error explains most,
/// and those that these recordings cannot tell from it. Returns none if no component explains enough.
pub fn rank_components(map: &[MapCell]) -> Vec<Component> {
    let best = |component: Component| {
        map.iter().filter(|c| c.component == component).map(|c| c.log_likelihood_gain).fold(0.0, f64::max)
    };
    let all: Vec<(Component, f64)> =
        COMPONENTS.iter().map(|c| (*c, best(*c))).filter(|(_, gain)| *gain > GAIN_NEEDED).collect();
    let most = all.iter().map(|(_, gain)| *gain).fold(0.0, f64::max);
    let mut near: Vec<_> = all
        .into_iter()
        .filter(|(_, gain)| most - gain < (EQUIVALENT_COMPONENT_SHARE * most).max(AMBIGUOUS))
        .collect();
    // Ties within the noise are broken by prior probability.
    near.sort_by(|a, b| (most - b.1 < AMBIGUOUS).cmp(&(most - a.1 < AMBIGUOUS)).then(b.1.total_cmp(&a.1)));
    let ties = near.iter().filter(|(_, gain)| most - gain < AMBIGUOUS).count();
    near[..ties].sort_by_key(|(name, _)| COMPONENTS.iter().position(|c| c == name));
    near.into_iter().map(|(name, _)| name).collect()
}
