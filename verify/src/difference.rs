//! The changes from one verification to another.

use counterpoise_models::ControlledQuantity;

use crate::{PerformanceFigure, Verdict, Verification};

/// A figure before and after.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FigureChange {
    /// Figure.
    pub figure: PerformanceFigure,
    /// Quantity that the loop controls; the figure has its name and unit.
    pub controlled: ControlledQuantity,
    /// Value before; `None` if it was not measured.
    pub before: Option<f64>,
    /// Value after; `None` if it was not measured.
    pub after: Option<f64>,
    /// `true` if its requirements held before; none without one that could be judged.
    pub held: Option<bool>,
    /// `true` if its requirements hold after.
    pub holds: Option<bool>,
}

impl FigureChange {
    /// Returns the figure's unit.
    pub fn unit(&self) -> &'static str {
        self.figure.unit(self.controlled)
    }

    /// Returns after - before; `None` if one is missing.
    pub fn difference(&self) -> Option<f64> {
        Some(self.after? - self.before?)
    }

    /// Returns (after - before) / |before|: 0 if both are the same, infinite from 0 or without a bound, `None` if one is missing.
    pub fn relative_change(&self) -> Option<f64> {
        let (before, after) = (self.before?, self.after?);
        Some(if before == after { 0.0 } else { (after - before) / before.abs() })
    }

    /// Returns whether a requirement is met that was not, or the other way.
    pub fn has_changed_verdict(&self) -> bool {
        matches!((self.held, self.holds), (Some(a), Some(b)) if a != b)
    }
}

/// Returns every figure of either verification, in the order of the second, those of the first alone at the end.
pub fn figure_changes(before: &Verification, after: &Verification) -> Vec<FigureChange> {
    let mut figures: Vec<PerformanceFigure> = after.figures.iter().map(|measured| measured.figure).collect();
    let gone = before.figures.iter().map(|measured| measured.figure);
    figures.extend(gone.filter(|figure| after.figures.iter().all(|m| m.figure != *figure)));
    let change = |figure: PerformanceFigure| FigureChange {
        figure,
        controlled: after.controlled_quantity(),
        before: before.value(figure),
        after: after.value(figure),
        held: verdict_holds(before, figure),
        holds: verdict_holds(after, figure),
    };
    figures.into_iter().map(change).collect()
}

fn verdict_holds(found: &Verification, figure: PerformanceFigure) -> Option<bool> {
    let judged = found.verdicts.iter().filter(|(requirement, _)| requirement.figure == figure);
    judged
        .filter_map(|(_, verdict)| match verdict {
            Verdict::Holds { .. } => Some(true),
            Verdict::Fails { .. } => Some(false),
            Verdict::NotApplicable { .. } => None,
        })
        .reduce(|a, b| a && b)
}
