//! The section of a diagnosis' report that shows where and when: the balances, and component x regime.

use crate::wording::answer::{AnswerText, component_list};
use counterpoise_diagnose::findings::localisation_chart::ChartRow;
use counterpoise_diagnose::localisation::error_hypotheses::Regime;

use counterpoise_plot::{Figure, Heat, HeatGroup, HeatRow};

use crate::diagnosis::words;
use crate::{Cell, Column, Section, Table};

/// Where and when.
pub(super) fn where_section(answer: &AnswerText) -> Section {
    let mut balances = Table::new(
        "Balances that these sensors allow, and the components that each can see",
        &[Column::Text("balance"), Column::Text("available"), Column::Text("sees")],
    );
    for row in &answer.isolability {
        let available = if row.available { "yes" } else { "no" };
        balances.rows.push(vec![
            Cell::text(row.balance.name()),
            Cell::text(available),
            Cell::text(words(&component_list(&row.sees))),
        ]);
    }
    let section = Section::new("Where and when").listing(balances);
    if answer.map.is_empty() { section } else { section.showing([where_when(answer)]) }
}

/// Component x regime.
fn where_when(answer: &AnswerText) -> Figure {
    let rows = answer.chart.rows.iter().map(shown).collect();
    let heat = Heat {
        meaning: "of what the best cell gains".to_owned(),
        ring: "where the effect belongs that the search then named".to_owned(),
        columns: Regime::ALL.iter().map(|regime| words(regime.name())).collect(),
        groups: vec![HeatGroup { heading: "What an error at each component explains".to_owned(), rows }],
    };
    Figure::cells("Where (component) and when (regime) the simulation departs, in per cent", heat)
        .captioned(&format!("{} {HOW}", answer.chart_summary))
}

/// A component's row; one that no balance sees has no shares.
fn shown(row: &ChartRow) -> HeatRow {
    let shares = if row.seen { row.shares.clone() } else { Vec::new() };
    let ringed =
        row.found.iter().filter_map(|found| Regime::ALL.iter().position(|one| one == found)).collect();
    HeatRow { name: words(row.component.name()), shares, ringed }
}

/// What a cell is.
const HOW: &str = "This is a first look, before the search, and nothing is named by it. At each component an error is let in that is a \
                   free function of one variable, times what errors there scale with: friction with the direction of sliding, a \
                   motor's loss with its torque. A cell is the log-likelihood that it gains, in all balances at once, on stretches \
                   that it was not fitted to. The balances are simpler than the simulator, so that the true cause too may gain a \
                   small part of what a perfect explanation would. A dash: no such error is thought of.";
