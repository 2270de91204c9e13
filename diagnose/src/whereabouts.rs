//! Component x regime, from balance x regime: what each component can carry of the mismatch at most.

use crate::answer::MapCell;
use crate::locate::Signature;

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
    /// Components: the least of the shares of the available balances that see it. A mismatch shows in every balance that
    /// contains its component, so that it can carry no more than that.
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
    let row = |name: &'static str, seeing: &[&str]| {
        let least = |regime: &&'static str| {
            seeing.iter().filter_map(|balance| share(balance, regime)).reduce(f64::min)
        };
        Row { name, shares: regimes.iter().map(least).collect() }
    };
    let balances = distinct(map.iter().map(|cell| cell.component)).into_iter().map(|name| row(name, &[name]));
    let component = |name: &'static str| {
        let sees = |s: &&Signature| s.available && s.sees.contains(&name);
        let seeing: Vec<&str> = isolability.iter().filter(sees).map(|s| s.balance).collect();
        row(name, &seeing)
    };
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
    use crate::locate::isolability;

    fn cell(component: &'static str, explained: f64) -> MapCell {
        MapCell { component, regime: "position", explained, shape: String::new() }
    }

    fn of(found: &Whereabouts, name: &str) -> Option<f64> {
        found.components.iter().find(|row| row.name == name).unwrap().shares[0]
    }

    #[test]
    fn a_component_carries_no_more_than_the_quietest_balance_that_sees_it() {
        let map = [cell("twist", 0.1), cell("drive", 0.9), cell("hub", 0.4)];
        let found = whereabouts(&map, &isolability(true, true));
        assert_eq!(found.balances.len(), 3);
        assert_eq!(of(&found, "motor"), Some(0.9), "in the drive balance alone");
        assert_eq!(of(&found, "pivot"), Some(0.4), "in drive and hub");
        assert_eq!(of(&found, "gearbox"), Some(0.1), "in all three");
    }

    #[test]
    fn a_component_that_no_balance_sees_has_no_share() {
        let found = whereabouts(&[cell("drive", 0.9)], &isolability(false, false));
        assert_eq!(of(&found, "platform_gyro"), None);
        assert_eq!(of(&found, "pivot"), Some(0.9));
    }
}
