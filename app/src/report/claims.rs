//! The page of the thesis' claims.

use counterpoise_project::claims::{Claim, Finding};

use super::verification::Context;
use super::{Cell, Column, Headline, Report, Table, Tone};

/// The report: the table is the first screen.
pub fn report(rows: &[Claim], context: Context) -> Report {
    Report {
        title: context.title,
        subtitle: context.subtitle,
        headline: headline(rows),
        tiles: Vec::new(),
        verdicts: table(rows),
        glance: Vec::new(),
        sections: context.more,
        provenance: context.provenance,
    }
}

fn headline(rows: &[Claim]) -> Headline {
    let count = |which: fn(&Finding) -> bool| rows.iter().filter(|row| which(&row.finding)).count();
    let holds = count(|f| *f == Finding::Holds);
    let differs = count(|f| matches!(f, Finding::Differs { .. }));
    let fails = count(|f| *f == Finding::Fails);
    let open = count(|f| matches!(f, Finding::NotMeasured { .. }));
    let text = format!("{holds} of {} claims hold, {differs} differ for a reason, {fails} fail", rows.len());
    let detail = if open == 0 { String::new() } else { format!("{open} are not measured by this command.") };
    Headline { tone: if fails == 0 { Tone::Good } else { Tone::Bad }, text, detail }
}

/// One row a claim.
pub fn table(rows: &[Claim]) -> Table {
    let columns = [
        Column::Text(""),
        Column::Text("thesis"),
        Column::Text("says"),
        Column::Text("measured here"),
        Column::Text("verdict"),
    ];
    let mut table = Table::new("", &columns);
    table.rows = rows.iter().map(row).collect();
    table
}

fn row(claim: &Claim) -> Vec<Cell> {
    let (tone, word, why) = match &claim.finding {
        Finding::Holds => (Tone::Good, "holds", String::new()),
        Finding::Fails => (Tone::Bad, "fails", String::new()),
        Finding::Differs { why } => (Tone::Neutral, "differs", format!("Differs: {why}.")),
        Finding::NotMeasured { why } => (Tone::Neutral, "not measured", format!("Not measured: {why}.")),
    };
    let measured = [claim.measured.as_str(), why.as_str()]
        .iter()
        .filter(|t| !t.is_empty())
        .copied()
        .collect::<Vec<_>>()
        .join(". ");
    vec![
        Cell::text(claim.id),
        Cell::text(claim.source),
        Cell::text(claim.says),
        Cell::text(measured),
        Cell::Verdict(tone, word.to_owned()),
    ]
}
