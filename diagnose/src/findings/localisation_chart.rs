//! The chart of the localisation: component by regime, with the cells of the effects that the search found after it.

use crate::findings::answer::Finding;
use crate::library::Component;
use crate::localisation::error_hypotheses::{COMPONENTS, Regime, regimes_of};
use crate::localisation::error_map::{MapCell, rank_components};
use crate::localisation::torque_balances::BalanceVisibility;

/// A row of the chart: a component, with its share under each regime.
#[derive(Debug, Clone, PartialEq)]
pub struct ChartRow {
    /// The component.
    pub component: Component,
    /// `true` if a balance that these sensors allow sees it.
    pub seen: bool,
    /// Shares of the best cell's gain, 0 to 1, in the order of [`Regime::ALL`]; `None` if no error along that variable is tried at
    /// the component.
    pub shares: Vec<Option<f64>>,
    /// The regimes of the cells to which effects belong that the search then found.
    pub found: Vec<Regime>,
}

/// Agreement of the search, which follows the localisation, with its best cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SearchAgreement {
    /// It found the effect of the best cell, or there is nothing to compare.
    Agrees,
    /// The chart has a best cell, and the search found nothing.
    FoundNothing,
    /// The search found an effect that belongs to another cell.
    FoundAnother,
}

/// The chart of the localisation.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalisationChart {
    /// The rows, one for each component.
    pub rows: Vec<ChartRow>,
    /// The cell that gains most; `None` if no cell gains more than noise may.
    pub best: Option<MapCell>,
    /// The components that these recordings cannot tell apart, the most probable first: see [`rank_components`].
    pub likeliest: Vec<Component>,
    /// The agreement of the search.
    pub agreement: SearchAgreement,
}

/// Builds the chart of a map, of the balances that it was made with, and of what the search found after it.
pub fn build_chart(
    map: &[MapCell],
    balances: &[BalanceVisibility],
    findings: &[Finding],
) -> LocalisationChart {
    let largest = map.iter().map(|cell| cell.explained).fold(0.0, f64::max);
    let share = |component: Component, regime: Regime| {
        let cell = map.iter().find(|cell| cell.component == component && cell.regime == regime)?;
        Some(if largest > 0.0 { cell.explained / largest } else { 0.0 })
    };
    let row = |component: Component| ChartRow {
        component,
        seen: balances.iter().any(|row| row.available && row.sees.contains(&component)),
        shares: Regime::ALL.iter().map(|regime| share(component, *regime)).collect(),
        found: findings
            .iter()
            .filter(|finding| finding.component == component)
            .filter_map(|finding| regime_of_finding(map, finding))
            .collect(),
    };
    let best = map
        .iter()
        .max_by(|a, b| a.log_likelihood_gain.total_cmp(&b.log_likelihood_gain))
        .filter(|c| c.explained > 0.0);
    LocalisationChart {
        rows: COMPONENTS.iter().map(|component| row(*component)).collect(),
        best: best.cloned(),
        likeliest: rank_components(map),
        agreement: search_agreement(map, best, findings),
    }
}

/// Returns the regime of the cell to which a found effect belongs: of those along whose variables it shows, the one that gains most.
fn regime_of_finding(map: &[MapCell], finding: &Finding) -> Option<Regime> {
    let gain = |regime: Regime| {
        let cell = map.iter().find(|c| c.component == finding.component && c.regime == regime);
        cell.filter(|c| c.explained > 0.0).map_or(0.0, |c| c.log_likelihood_gain)
    };
    // `max_by` takes the last of equals, and the plainest regime, which comes first, is to be preferred
    let regimes = regimes_of(finding.component, finding.effect).iter().rev().copied();
    regimes.max_by(|a, b| gain(*a).total_cmp(&gain(*b)))
}

fn search_agreement(map: &[MapCell], best: Option<&MapCell>, findings: &[Finding]) -> SearchAgreement {
    let found: Vec<(Component, Regime)> = findings
        .iter()
        .filter_map(|finding| Some((finding.component, regime_of_finding(map, finding)?)))
        .collect();
    match best {
        Some(_) if findings.is_empty() => SearchAgreement::FoundNothing,
        Some(best) if !found.is_empty() && !found.contains(&(best.component, best.regime)) => {
            SearchAgreement::FoundAnother
        }
        _ => SearchAgreement::Agrees,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::findings::answer::FindingBasis;
    use crate::library::EffectName;
    use crate::localisation::error_map::localise_errors;
    use crate::localisation::residual_regression::AssessedReplay;
    use crate::localisation::torque_balances::list_balances;
    use crate::localisation::trend::{Repetition, Trend};
    use crate::machine::RedundantSensors;
    use crate::recording::measured_signals::MeasuredSignals;
    use crate::simulator_access::{Assessment, ChannelResidual, ControlSource};
    use counterpoise_models::reference;
    use counterpoise_pool::Serial;
    use counterpoise_recordings::{Channel, Signals};

    const MOTOR_RATE: RedundantSensors = RedundantSensors { motor_rate: true, hub_position: false };
    const NO_MORE: RedundantSensors = RedundantSensors { motor_rate: false, hub_position: false };

    const SAMPLES: usize = 8000;
    const CONTROL_FLOOR: f64 = 5e-3;

    /// A recording at the reference rig's pace whose control differs from the replay by `torque(k)`, N m at the hub, which the motor
    /// makes and the hub takes.
    fn departing_map(sensors: RedundantSensors, torque: impl Fn(usize, f64) -> f64) -> Vec<MapCell> {
        let p = reference::rig();
        let t = |k: usize| k as f64 * 1e-3;
        let mut seed = 7u64;
        let mut noise = |size: f64| {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            size * 3f64.sqrt() * ((seed >> 33) as f64 / (1u64 << 30) as f64 - 1.0)
        };
        let rate = |k: usize| 0.1 * (1.3 * t(k)).sin() + 0.05 * (2.9 * t(k)).sin();
        let angle =
            |k: usize| 0.1 * (1.0 - (1.3 * t(k)).cos()) / 1.3 + 0.05 * (1.0 - (2.9 * t(k)).cos()) / 2.9;
        let per_volt = 200.0 * 0.86 * 30.0 / (0.8 + 30.0 * 0.3067);
        let mut series = |size: f64, f: &dyn Fn(usize) -> f64| -> Vec<f64> {
            (0..SAMPLES).map(|k| f(k) + noise(size)).collect()
        };
        let mut columns = vec![
            series(CONTROL_FLOOR, &|_| 2.9),
            series(2e-4, &rate),
            series(2e-4, &|_| 0.0),
            series(5e-3, &|k| 1.5 * (9.0 * t(k)).sin()),
        ];
        // a sensor that is missing draws no noise
        let still = || vec![0.0; SAMPLES];
        columns.push(if sensors.motor_rate { series(2e-2, &|k| 200.0 * rate(k)) } else { still() });
        columns.push(if sensors.hub_position { series(2e-5, &angle) } else { still() });
        let measured = MeasuredSignals {
            measured: counterpoise_models::FeedbackSignal::HubRate,
            period_s: 1e-3,
            recorded: sensors,
            signals: Signals::stack(columns.iter().map(Vec::as_slice)),
        };
        let apart = |k: usize| -torque(k, angle(k)) / per_volt / CONTROL_FLOOR;
        let mut channels = vec![ChannelResidual {
            channel: Channel::Control,
            residual: series(1.0, &apart),
            floor: CONTROL_FLOOR,
        }];
        let mut quiet = |channel, floor| {
            channels.push(ChannelResidual { channel, residual: series(1.0, &|_| 0.0), floor });
        };
        quiet(Channel::HubRate, 2e-4);
        if sensors.motor_rate {
            quiet(Channel::MotorRate, 2e-2);
        }
        let judged = Assessment {
            divergence: vec![0.0; channels.len()],
            channels,
            start: None,
            source: ControlSource::ClosedLoop,
        };
        localise_errors(
            &p,
            &[AssessedReplay { measured, assessment: judged }],
            &list_balances(sensors),
            &Serial,
        )
    }

    fn best_cell(map: &[MapCell]) -> (Component, Regime) {
        let cell = map.iter().max_by(|a, b| a.log_likelihood_gain.total_cmp(&b.log_likelihood_gain)).unwrap();
        (cell.component, cell.regime)
    }

    #[test]
    fn nothing_left_out_leaves_an_empty_chart() {
        let map = departing_map(MOTOR_RATE, |_, _| 0.0);
        let chart = build_chart(&map, &list_balances(MOTOR_RATE), &[]);
        assert!(chart.best.is_none() && chart.likeliest.is_empty(), "{map:?}");
        assert_eq!(chart.agreement, SearchAgreement::Agrees);
    }

    fn finding_of(component: Component, effect: EffectName) -> Finding {
        Finding {
            effect,
            component,
            probability: 1.0,
            basis: FindingBasis::NoKnownEffect { pattern: None, nearest: None },
            parameters: Vec::new(),
            alternatives: Vec::new(),
        }
    }

    #[test]
    fn a_control_that_repeats_with_the_motors_angle_points_there() {
        let map = departing_map(MOTOR_RATE, |_, angle| 20.0 * (3.0 * 200.0 * angle).sin());
        assert_eq!(best_cell(&map), (Component::Motor, Regime::MotorAngle), "{map:?}");
        let sees = list_balances(MOTOR_RATE);
        let ringed = |component, effect| {
            let chart = build_chart(&map, &sees, &[finding_of(component, effect)]);
            let cells: Vec<_> =
                chart.rows.iter().flat_map(|row| row.found.iter().map(|r| (row.component, *r))).collect();
            (cells, chart.agreement)
        };
        assert_eq!(
            ringed(Component::Motor, EffectName::Cogging),
            (vec![(Component::Motor, Regime::MotorAngle)], SearchAgreement::Agrees)
        );
        assert_eq!(
            ringed(Component::Pivot, EffectName::Stribeck),
            (vec![(Component::Pivot, Regime::Rate)], SearchAgreement::FoundAnother)
        );
        assert_eq!(ringed(Component::Motor, EffectName::Unknown), (vec![], SearchAgreement::Agrees));
        assert_eq!(build_chart(&map, &sees, &[]).agreement, SearchAgreement::FoundNothing);
    }

    #[test]
    fn a_torque_of_time_alone_shows_its_period_and_what_cannot_be_told_from_it() {
        let map = departing_map(NO_MORE, |k, _| 30.0 * (std::f64::consts::TAU * k as f64 / 410.0).sin());
        let chart = build_chart(&map, &list_balances(NO_MORE), &[]);
        assert_eq!(chart.likeliest[0], Component::Structure);
        assert!(chart.likeliest.contains(&Component::Amplifier), "{:?}", chart.likeliest);
        let Some(Trend::Periodic { repetition: Some(Repetition::InTime { period_s, .. }) }) =
            chart.best.unwrap().trend
        else {
            panic!("{map:?}");
        };
        assert!((period_s - 0.41).abs() < 5e-4, "{period_s}");
        let blind: Vec<Component> =
            chart.rows.iter().filter(|row| !row.seen).map(|row| row.component).collect();
        assert_eq!(blind, [Component::PlatformGyro, Component::Platform]);
    }
}
