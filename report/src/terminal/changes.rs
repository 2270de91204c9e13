//! What `counterpoise verify --against` prints of figures that have changed.

use counterpoise_verify::difference::FigureChange;

use super::add_line;
use crate::difference::{classify_change, describe_size, has_changed};
use crate::wording::figures::{describe_figure, format_figure};

/// Returns the lines on figures before and after: every one that a requirement judges, and how many others have changed.
pub fn change_lines(changed: &[FigureChange]) -> Vec<String> {
    let mut all = Vec::new();
    let lines = &mut all;
    let shown: Vec<&FigureChange> =
        changed.iter().filter(|change| change.holds.is_some() || change.held.is_some()).collect();
    for change in &shown {
        let text = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), format_figure);
        add_line!(
            lines,
            "  {:15} {}: {} -> {} {} ({})",
            classify_change(change).1,
            describe_figure(change.figure, change.controlled),
            text(change.before),
            text(change.after),
            change.unit(),
            describe_size(change)
        );
    }
    let others = changed.iter().filter(|change| has_changed(change)).count();
    let turned = changed.iter().filter(|change| change.has_changed_verdict()).count();
    let word = if turned == 1 { "verdict" } else { "verdicts" };
    add_line!(
        lines,
        "{turned} {word} turned; {others} of {} figures changed (--report shows all)",
        changed.len()
    );
    all
}
