//! The curves of a plot that the user has hidden: a click on a curve's name in the legend hides or shows it, and with Ctrl it shows that curve alone.

use std::collections::BTreeSet;

use egui::{Context, Id};

use super::chart::Chart;

/// The hidden curves of one chart in a window, by their names.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct HiddenCurves(BTreeSet<String>);

impl HiddenCurves {
    /// Returns the hidden curves of a chart.
    pub fn load(context: &Context, chart: &Chart) -> Self {
        context.data(|data| data.get_temp::<BTreeSet<String>>(id(chart))).map(Self).unwrap_or_default()
    }

    /// Returns whether a curve is hidden. One without a name never is.
    pub fn contains(&self, name: &str) -> bool {
        !name.is_empty() && self.0.contains(name)
    }

    /// Shows a hidden curve, or hides one that is shown.
    pub fn toggle(&mut self, name: &str) {
        if !self.0.remove(name) {
            self.0.insert(name.to_owned());
        }
    }

    /// Shows one curve of a chart alone; all of them if it is alone already.
    pub fn isolate(&mut self, chart: &Chart, name: &str) {
        let others = chart.curves.iter().map(|curve| curve.name.clone());
        let others: BTreeSet<String> = others.filter(|other| other != name && !other.is_empty()).collect();
        self.0 = if self.0 == others { BTreeSet::new() } else { others };
    }

    /// Keeps the hidden curves of a chart.
    pub fn store(self, context: &Context, chart: &Chart) {
        context.data_mut(|data| data.insert_temp(id(chart), self.0));
        context.request_repaint();
    }
}

fn id(chart: &Chart) -> Id {
    Id::unique(("hidden curves", &chart.title))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::charts::chart::LineDash;

    #[test]
    fn a_curve_is_hidden_shown_and_isolated() {
        let points = || vec![[0.0, 0.0], [1.0, 1.0]];
        let mut chart = Chart::new("Step", "time, s", "rate");
        for name in ["hub", "demand", ""] {
            chart = chart.with_curve(name, egui::Color32::WHITE, LineDash::Solid, points());
        }
        let mut hidden = HiddenCurves::default();
        hidden.toggle("demand");
        assert!(hidden.contains("demand") && !hidden.contains("hub") && !hidden.contains(""));
        hidden.toggle("demand");
        assert_eq!(hidden, HiddenCurves::default());
        hidden.isolate(&chart, "hub");
        assert!(hidden.contains("demand") && !hidden.contains("hub") && !hidden.contains(""));
        hidden.isolate(&chart, "hub");
        assert_eq!(hidden, HiddenCurves::default());
    }
}
