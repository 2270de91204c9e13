//! Component x regime: in which balances the recordings depart from the replay, along which variable, and what that
//! leaves each component to carry.
//!
//! A balance of the recording less the same balance of its replay: what the balances simplify is in both, and goes.

use counterpoise_models::Parameters;

use crate::answer::MapCell;
use crate::bench::{Drive, Judged};
use crate::locate::{Balance, Measured, Signature, balances, cells};

/// Balance x regime: the share of each balance's departure from the replay that follows each regime variable, on data not
/// used to find it. A recording with the replay that was judged on it.
pub fn departures(parameters: &Parameters, recordings: &[(Measured, Judged)]) -> Vec<MapCell> {
    let departed: Vec<Vec<Balance>> =
        recordings.iter().map(|(measured, judged)| departed(parameters, measured, judged)).collect();
    cells(&departed)
}

fn departed(parameters: &Parameters, measured: &Measured, judged: &Judged) -> Vec<Balance> {
    let replay = balances(parameters, &replayed(measured, judged));
    let mut out = balances(parameters, measured);
    for (balance, simulated) in out.iter_mut().zip(&replay) {
        balance.residual.iter_mut().zip(&simulated.residual).for_each(|(r, s)| *r -= s);
        detrend(&mut balance.residual);
    }
    out
}

/// The readings of the replay: those recorded and their misfits. A control that was played back is the recorded one.
fn replayed(measured: &Measured, judged: &Judged) -> Measured {
    let mut out = measured.clone();
    for misfit in &judged.misfits {
        let column = match misfit.channel {
            "control" if judged.drive == Drive::ClosedLoop => Some(&mut out.control),
            "hub_rate" => Some(&mut out.hub_rate),
            "motor_rate" => out.motor_rate.as_mut(),
            "hub_position" => out.hub_position.as_mut(),
            _ => None,
        };
        let pairs = column.into_iter().flatten().zip(&misfit.residual);
        pairs.for_each(|(value, residual)| *value += residual * misfit.floor);
    }
    out
}

/// Takes off the straight line that fits best: a start that is not known, and what noise integrates to.
fn detrend(series: &mut [f64]) {
    let count = series.len() as f64;
    let middle = 0.5 * (count - 1.0);
    let mean = series.iter().sum::<f64>() / count.max(1.0);
    let along = |k: usize| k as f64 - middle;
    let slope: f64 = series.iter().enumerate().map(|(k, v)| along(k) * v).sum::<f64>()
        / (0..series.len()).map(|k| along(k).powi(2)).sum::<f64>().max(1.0);
    series.iter_mut().enumerate().for_each(|(k, v)| *v -= mean + slope * along(k));
}

/// A row of the picture: a balance or a component, with its share under each regime variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Name of the balance or the component.
    pub name: &'static str,
    /// Shares from 0 to 1 in the order of [`Whereabouts::regimes`]; none where no balance that these sensors allow sees it.
    pub shares: Vec<Option<f64>>,
}

/// The picture of where and when.
#[derive(Debug, Clone, PartialEq)]
pub struct Whereabouts {
    /// Regime variables, the columns.
    pub regimes: Vec<&'static str>,
    /// Balances: the share of each one's residual that follows the variable, as measured.
    pub balances: Vec<Row>,
    /// Components: the most that each can carry. It is the largest share of the available balances that see it, times what
    /// the largest share of those that do not see it leaves. An empty balance excludes nothing: noise may cover it.
    pub components: Vec<Row>,
}

/// The picture of a map and the balances that it was made with.
pub fn whereabouts(map: &[MapCell], isolability: &[Signature]) -> Whereabouts {
    let regimes = distinct(map.iter().map(|cell| cell.regime));
    let share = |balance: &str, regime: &str| {
        map.iter()
            .find(|cell| cell.component == balance && cell.regime == regime)
            .map(|cell| cell.explained.clamp(0.0, 1.0))
    };
    let balance =
        |name: &'static str| Row { name, shares: regimes.iter().map(|regime| share(name, regime)).collect() };
    let carried = |name: &'static str, regime: &str| {
        let (seeing, blind): (Vec<&Signature>, Vec<&Signature>) =
            isolability.iter().filter(|s| s.available).partition(|s| s.sees.contains(&name));
        let of = |some: &[&Signature]| -> Vec<f64> {
            some.iter().filter_map(|s| share(s.balance, regime)).collect()
        };
        let elsewhere = of(&blind).into_iter().fold(0.0, f64::max);
        of(&seeing).into_iter().reduce(f64::max).map(|most| most * (1.0 - elsewhere))
    };
    let component = |name: &'static str| {
        let shares = regimes.iter().map(|regime| carried(name, regime)).collect();
        Row { name, shares }
    };
    let balances = distinct(map.iter().map(|cell| cell.component)).into_iter().map(balance);
    let names = distinct(isolability.iter().flat_map(|s| s.sees.iter().copied()));
    let (balances, components) = (balances.collect(), names.into_iter().map(component).collect());
    Whereabouts { regimes, balances, components }
}

/// Each name once, in the order of its first appearance.
fn distinct(names: impl Iterator<Item = &'static str>) -> Vec<&'static str> {
    let mut out = Vec::new();
    names.for_each(|name| {
        if !out.contains(&name) {
            out.push(name);
        }
    });
    out
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::bench::Misfit;
    use crate::locate::isolability;
    use counterpoise_models::reference;

    fn cell(component: &'static str, explained: f64) -> MapCell {
        MapCell { component, regime: "position", explained, shape: String::new() }
    }

    fn of(found: &Whereabouts, name: &str) -> Option<f64> {
        found.components.iter().find(|row| row.name == name).unwrap().shares[0]
    }

    #[test]
    fn a_component_does_not_carry_what_shows_where_it_is_not_seen() {
        let map = [cell("twist", 0.0), cell("drive", 0.75), cell("hub", 0.5)];
        let found = whereabouts(&map, &isolability(true, true));
        assert_eq!(found.balances.len(), 3);
        assert_eq!(of(&found, "motor"), Some(0.375), "drive sees it, hub has a half that is not its");
        assert_eq!(of(&found, "pivot"), Some(0.75), "drive and hub see it");
        assert_eq!(
            of(&found, "platform_gyro"),
            Some(0.0),
            "the twist balance, which alone sees it, is empty"
        );
    }

    #[test]
    fn a_control_that_repeats_with_the_motors_angle_departs_there() {
        let p = reference::rig();
        let samples = 8000;
        let t = |k: usize| k as f64 * 1e-3;
        let hub_rate: Vec<f64> = (0..samples).map(|k| 0.1 * (1.3 * t(k)).sin()).collect();
        let angle: Vec<f64> = (0..samples).map(|k| 0.1 * (1.0 - (1.3 * t(k)).cos()) / 1.3).collect();
        let still = vec![0.0; samples];
        let measured = Measured {
            period_s: 1e-3,
            control: vec![2.9; samples],
            motor_rate: Some(hub_rate.iter().map(|w| p.gearbox.ratio * w).collect()),
            hub_position: Some(angle.clone()),
            hub_rate,
            platform_rate: still.clone(),
            platform_accel: still,
        };
        let residual = angle.iter().map(|a| (2.0 * p.gearbox.ratio * a).sin()).collect();
        let misfits = vec![Misfit { channel: "control", residual, floor: 0.01 }];
        let judged = Judged { misfits, wander: vec![0.0], start: None, drive: Drive::ClosedLoop };
        let map = departures(&p, &[(measured, judged)]);
        let share = |regime: &str| {
            map.iter().find(|c| c.component == "drive" && c.regime == regime).map_or(0.0, |c| c.explained)
        };
        assert!(share("motor angle") > 0.8, "{map:?}");
        assert!(share("rate") < 0.3 && share("load") < 0.3, "{map:?}");
        let found = whereabouts(&map, &isolability(true, true));
        let column = found.regimes.iter().position(|r| *r == "motor angle").unwrap();
        let motor = found.components.iter().find(|row| row.name == "motor").unwrap();
        assert!(motor.shares[column].unwrap() > 0.8, "{:?}", motor.shares);
    }

    #[test]
    fn a_component_that_no_balance_sees_has_no_share() {
        let found = whereabouts(&[cell("drive", 0.9)], &isolability(false, false));
        assert_eq!(of(&found, "platform_gyro"), None);
        assert_eq!(of(&found, "pivot"), Some(0.9));
    }
}
