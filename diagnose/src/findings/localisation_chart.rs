//! The chart of the localisation: component x regime, with the cells of the effects that the search found after it.

use crate::findings::answer::Finding;
use crate::localisation::error_hypotheses::{COMPONENTS, REGIMES, regimes_of};
use crate::localisation::error_map::{MapCell, likeliest, place};
use crate::localisation::torque_balances::BalanceVisibility;

/// A row of the picture: a component, with its share under each regime variable.
#[derive(Debug, Clone, PartialEq)]
pub struct ChartRow {
    /// Name of the component.
    pub name: &'static str,
    /// Whether a balance that these sensors allow sees it.
    pub seen: bool,
    /// Shares of the best cell's gain, 0 to 1, in the order of [`LocalisationChart::regimes`]; none where the component has no error along
    /// that variable.
    pub shares: Vec<Option<f64>>,
    /// Places among [`LocalisationChart::regimes`] of the cells that effects belong to which the search then named.
    pub named: Vec<usize>,
}

/// The picture of where and when.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalisationChart {
    /// Regime variables, the columns.
    pub regimes: Vec<&'static str>,
    /// Components: what an error there, along that variable, gains.
    pub components: Vec<ChartRow>,
    /// Share of what a perfect explanation would gain that the best cell gains; 0 where none gains more than chance may.
    pub best: f64,
    /// The components that cannot be told apart by these recordings, the likeliest first: see [`likeliest`].
    pub likeliest: Vec<&'static str>,
    /// What it says, in words.
    pub summary: String,
}

/// The picture of a map, of the balances that it was made with, and of what the search found after it.
pub fn whereabouts(
    map: &[MapCell],
    isolability: &[BalanceVisibility],
    findings: &[Finding],
) -> LocalisationChart {
    let best = map.iter().map(|cell| cell.explained).fold(0.0, f64::max);
    let share = |component: &str, regime: &str| {
        let cell = map.iter().find(|cell| cell.component == component && cell.regime == regime)?;
        Some(if best > 0.0 { cell.explained / best } else { 0.0 })
    };
    let sees = |name: &str| isolability.iter().any(|s| s.available && s.sees.contains(&name));
    let row = |name: &'static str| ChartRow {
        name,
        seen: sees(name),
        shares: REGIMES.iter().map(|regime| share(name, regime)).collect(),
        named: findings.iter().filter(|f| f.component == name).filter_map(|f| named(map, f)).collect(),
    };
    let components = COMPONENTS.iter().map(|name| row(name)).collect();
    let likeliest = likeliest(map);
    let summary = format!("{}{}", summary(map, &likeliest), agreement(map, findings));
    LocalisationChart { regimes: REGIMES.to_vec(), components, best, likeliest, summary }
}

/// FitState of the cell that a named effect belongs to: of those along whose variables it shows, the one that gains most.
fn named(map: &[MapCell], finding: &Finding) -> Option<usize> {
    let gain = |regime: &str| {
        let cell = map.iter().find(|c| c.component == finding.component && c.regime == regime);
        cell.filter(|c| c.explained > 0.0).map_or(0.0, |c| c.gain_nats)
    };
    // the last of equals is taken: the plainest is to win
    let regimes = regimes_of(finding.component, finding.effect).iter().rev();
    place(regimes.max_by(|a, b| gain(a).total_cmp(&gain(b)))?)
}

/// What is to be said where the brightest cell is none that the search named.
fn agreement(map: &[MapCell], findings: &[Finding]) -> String {
    let best = map.iter().max_by(|a, b| a.gain_nats.total_cmp(&b.gain_nats)).filter(|c| c.explained > 0.0);
    let ringed: Vec<(&str, Option<usize>)> =
        findings.iter().map(|f| (f.component, named(map, f))).filter(|(_, cell)| cell.is_some()).collect();
    match best {
        Some(_) if findings.is_empty() => " The search named nothing: what shows here is too little for an effect.".to_owned(),
        Some(best) if !ringed.is_empty() && !ringed.contains(&(best.component, place(best.regime))) => {
            " The search then named another cell (ringed): the balances are simpler than the simulator, and its fits decide.".to_owned()
        }
        _ => String::new(),
    }
}

/// What a map says, in words.
fn summary(map: &[MapCell], likeliest: &[&str]) -> String {
    let best = map.iter().max_by(|a, b| a.gain_nats.total_cmp(&b.gain_nats));
    let Some(best) = best.filter(|cell| cell.explained > 0.0) else {
        return "No cell stands out: an error at any component, along any of these variables, explains no more than chance may. \
                What is left in the balances is noise."
            .to_owned();
    };
    let words = |name: &str| name.replace('_', " ");
    let shape = if best.shape.is_empty() { String::new() } else { format!(" ({})", best.shape) };
    let alike = match likeliest.split_last() {
        Some((last, some)) if !some.is_empty() => {
            let some: Vec<String> = some.iter().map(|name| words(name)).collect();
            format!(
                "The balances cannot tell {} and {} apart; the fits in the simulator may.",
                some.join(", "),
                words(last)
            )
        }
        _ => "An error at any other component explains clearly less.".to_owned(),
    };
    format!(
        "The best cell, {} along {}{shape}, gains {:.0} nats: {:.0} % of what a perfect explanation would. {alike}",
        words(best.component),
        best.regime,
        best.gain_nats,
        100.0 * best.explained
    )
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::localisation::error_map::localise_errors;
    use crate::localisation::torque_balances::list_balances;
    use crate::recording::measured_signals::MeasuredSignals;
    use crate::simulator_access::{Assessment, ChannelResidual, ControlSource, Serial};
    use counterpoise_models::reference;

    const SAMPLES: usize = 8000;
    const CONTROL_FLOOR: f64 = 5e-3;

    /// A recording at the reference rig's pace whose control departs from the replay by `torque(k)`, N m at the hub, which the motor
    /// makes and the hub takes.
    fn departing(motor: bool, position: bool, torque: impl Fn(usize, f64) -> f64) -> Vec<MapCell> {
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
        let measured = MeasuredSignals {
            period_s: 1e-3,
            control: series(CONTROL_FLOOR, &|_| 2.9),
            hub_rate: series(2e-4, &rate),
            platform_rate: series(2e-4, &|_| 0.0),
            platform_accel: series(5e-3, &|k| 1.5 * (9.0 * t(k)).sin()),
            motor_rate: motor.then(|| series(2e-2, &|k| 200.0 * rate(k))),
            hub_position: position.then(|| series(2e-5, &angle)),
        };
        let apart = |k: usize| -torque(k, angle(k)) / per_volt / CONTROL_FLOOR;
        let mut channels =
            vec![ChannelResidual { channel: "control", residual: series(1.0, &apart), floor: CONTROL_FLOOR }];
        let mut quiet = |channel, floor| {
            channels.push(ChannelResidual { channel, residual: series(1.0, &|_| 0.0), floor });
        };
        quiet("hub_rate", 2e-4);
        if motor {
            quiet("motor_rate", 2e-2);
        }
        let judged = Assessment {
            divergence: vec![0.0; channels.len()],
            channels,
            start: None,
            source: ControlSource::ClosedLoop,
        };
        localise_errors(&p, &[(measured, judged)], &list_balances(motor, position), &Serial)
    }

    fn best(map: &[MapCell]) -> (&'static str, &'static str) {
        let cell = map.iter().max_by(|a, b| a.gain_nats.total_cmp(&b.gain_nats)).unwrap();
        (cell.component, cell.regime)
    }

    #[test]
    fn nothing_left_out_leaves_an_empty_picture_that_says_why() {
        let map = departing(true, false, |_, _| 0.0);
        let found = whereabouts(&map, &list_balances(true, false), &[]);
        assert!(found.best == 0.0 && found.likeliest.is_empty(), "{map:?}");
        assert!(found.summary.starts_with("No cell stands out"));
    }

    fn found(component: &'static str, effect: &'static str) -> Finding {
        let (when, explanation) = (String::new(), String::new());
        let (parameters, alternatives) = (Vec::new(), Vec::new());
        Finding { effect, component, probability: 1.0, when, explanation, parameters, alternatives }
    }

    #[test]
    fn a_control_that_repeats_with_the_motors_angle_points_there() {
        let map = departing(true, false, |_, angle| 20.0 * (3.0 * 200.0 * angle).sin());
        assert_eq!(best(&map), ("motor", "motor angle"), "{map:?}");
        let sees = list_balances(true, false);
        let ringed = |named: Finding| {
            let picture = whereabouts(&map, &sees, &[named]);
            let rows = picture.components.iter();
            let cells =
                rows.flat_map(|row| row.named.iter().map(|&k| (row.name, REGIMES[k]))).collect::<Vec<_>>();
            (cells, picture.summary.contains("named another cell"))
        };
        assert_eq!(ringed(found("motor", "cogging")), (vec![("motor", "motor angle")], false));
        assert_eq!(ringed(found("pivot", "stribeck")), (vec![("pivot", "rate")], true));
        assert_eq!(ringed(found("motor", "unknown")), (vec![], false));
        assert!(whereabouts(&map, &sees, &[]).summary.contains("named nothing"));
    }

    #[test]
    fn a_torque_of_time_alone_shows_its_period_and_what_cannot_be_told_from_it() {
        let map = departing(false, false, |k, _| 30.0 * (std::f64::consts::TAU * k as f64 / 410.0).sin());
        let found = whereabouts(&map, &list_balances(false, false), &[]);
        assert_eq!(found.likeliest[0], "structure", "{}", found.summary);
        assert!(found.likeliest.contains(&"amplifier"), "{}", found.summary);
        assert!(found.summary.contains("it repeats every 0.410"), "{}", found.summary);
        let blind: Vec<&str> = found.components.iter().filter(|row| !row.seen).map(|row| row.name).collect();
        assert_eq!(blind, ["platform_gyro", "platform"]);
    }
}
