//! The section of a diagnosis' report on localisation: the balances, and the map of component against regime.

use crate::wording::answer::{AnswerText, component_list};
use counterpoise_diagnose::findings::localisation_chart::ChartRow;
use counterpoise_diagnose::localisation::error_hypotheses::Regime;

use counterpoise_plot::{Figure, HeatMap, HeatRow};
use ndarray::Array2;

use crate::wording::name_in_words;
use crate::{ReportCell, ReportColumn, ReportSection, ReportTable};

/// Returns the section on localisation.
pub(super) fn localisation_section(answer: &AnswerText) -> ReportSection {
    let mut balances = ReportTable::new(
        "Equations of torque and motion that these sensors allow, and the components that each depends on",
        &[ReportColumn::Text("equation"), ReportColumn::Text("available"), ReportColumn::Text("depends on")],
    );
    for row in &answer.isolability {
        let available = if row.available { "yes" } else { "no" };
        balances.rows.push(vec![
            ReportCell::text(row.balance.name()),
            ReportCell::text(available),
            ReportCell::text(name_in_words(&component_list(&row.sees))),
        ]);
    }
    let section = ReportSection::new("Localisation").with_table(balances);
    if answer.map.is_empty() { section } else { section.with_figures([localisation_map(answer)]) }
}

/// Component x regime.
fn localisation_map(answer: &AnswerText) -> Figure {
    let rows = &answer.chart.rows;
    let share = |row: usize, column: usize| {
        let shares = if rows[row].seen { rows[row].shares.as_slice() } else { &[] };
        shares.get(column).copied().flatten().unwrap_or(f64::NAN)
    };
    let place = |found: &Regime| Regime::ALL.iter().position(|one| one == found);
    let framed = rows.iter().enumerate();
    let map = HeatMap {
        meaning: "of what the best cell gains".to_owned(),
        frame_meaning: "where the effect belongs that the search then named".to_owned(),
        heading: "What an error at each component explains".to_owned(),
        columns: Regime::ALL.iter().map(|regime| name_in_words(regime.name())).collect(),
        rows: rows.iter().map(row).collect(),
        shares: Array2::from_shape_fn((rows.len(), Regime::ALL.len()), |(r, c)| share(r, c)),
        framed: framed.flat_map(|(r, row)| row.found.iter().filter_map(place).map(move |c| (r, c))).collect(),
    };
    Figure::heat_map(
        "Localisation: what an error of each component explains in each regime, in per cent",
        map,
    )
    .with_caption(&format!("{} {HOW}", answer.chart_summary))
}

/// Returns a component's row; one that no balance sees has no cells.
fn row(row: &ChartRow) -> HeatRow {
    let cover = (!row.seen).then(|| "these sensors do not see it".to_owned());
    HeatRow { name: name_in_words(row.component.name()), cover }
}

/// The kind of a cell.
const HOW: &str = "These errors are examined before the effects are fitted, and they identify no effect. The error of a component is a free \
                   function of one variable, multiplied by the quantity that such errors are proportional to: friction by the direction \
                   of sliding, a motor's loss by its torque. A cell is the gain in log-likelihood over all torque balances, on \
                   stretches that were not used in the fit. The balances are simpler than the simulator, so the true cause, too, can \
                   gain a small part of what a perfect explanation would gain. A dash means that no such error is examined.";
