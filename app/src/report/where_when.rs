//! The section of a diagnosis' report that shows where and when: the balances, and component x regime.

use counterpoise_project::diagnose::answer::Answer;
use counterpoise_project::diagnose::whereabouts::{Row, whereabouts};

use crate::plot::{Figure, Heat, HeatGroup};

use super::diagnosis::words;
use super::{Cell, Column, Section, Table};

/// Where and when.
pub(super) fn where_section(answer: &Answer) -> Section {
    let mut balances = Table::new(
        "Balances that these sensors allow, and the components that each can see",
        &[Column::Text("balance"), Column::Text("available"), Column::Text("sees")],
    );
    for row in &answer.isolability {
        let available = if row.available { "yes" } else { "no" };
        balances.rows.push(vec![
            Cell::text(row.balance),
            Cell::text(available),
            Cell::text(row.sees.join(", ")),
        ]);
    }
    let section = Section::new("Where and when").listing(balances);
    if answer.map.is_empty() { section } else { section.showing([where_when(answer)]) }
}

/// Component x regime.
fn where_when(answer: &Answer) -> Figure {
    let found = whereabouts(&answer.map, &answer.isolability);
    let rows = found.components.iter().map(|row| (words(row.name), shares(row))).collect();
    let heat = Heat {
        meaning: "of what the best cell gains on stretches that it was not fitted to".to_owned(),
        columns: found.regimes.iter().map(|regime| words(regime)).collect(),
        groups: vec![HeatGroup { heading: "What an error at each component explains".to_owned(), rows }],
    };
    Figure::cells("Where (component) and when (regime) the simulation departs, in per cent", heat)
        .captioned(&format!("{} {HOW}", found.summary))
}

/// A row's shares; of one that no balance sees, none.
fn shares(row: &Row) -> Vec<Option<f64>> {
    if row.seen { row.shares.clone() } else { Vec::new() }
}

/// What a cell is.
const HOW: &str = "At each component an error is let in that is a free function of one variable, times what errors there scale with: friction \
                   with the direction of sliding, a motor's loss with its torque. A cell is the log-likelihood that it gains in all \
                   balances at once, where it was not fitted; nothing is named by it. A dash: no such error is thought of.";
