//! The page of the thesis' claims: verdicts on the first screen, the table, then each row with the curves that decided it.

use crate::{Agreement, Claim, ClaimOutcome, Criterion};

use counterpoise_plot::Figure;
use counterpoise_plot::number::short_number;
use counterpoise_report::verification::VerificationContext;
use counterpoise_report::{
    FigureTile, Headline, OutcomeTone, Report, ReportCell, ReportColumn, ReportSection, ReportTable,
};

/// Returns the report: the verdicts are the first screen. `again` is the command that measures one row again.
pub fn claims_report(rows: &[Claim], context: VerificationContext, again: &dyn Fn(&str) -> String) -> Report {
    let mut sections: Vec<ReportSection> = rows.iter().map(|row| section(row, &again(row.id))).collect();
    sections.extend(context.more);
    Report {
        title: context.title,
        subtitle: context.subtitle,
        headline: headline(rows),
        tiles: rows.iter().map(tile).collect(),
        verdicts: claims_table(rows),
        glance: Vec::new(),
        sections,
        provenance: context.provenance,
    }
}

fn headline(rows: &[Claim]) -> Headline {
    let count = |which: fn(&ClaimOutcome) -> bool| rows.iter().filter(|row| which(&row.finding())).count();
    let holds = count(|f| *f == ClaimOutcome::Holds);
    let differs = count(|f| matches!(f, ClaimOutcome::Differs { .. }));
    let fails = count(|f| *f == ClaimOutcome::Fails);
    let open = count(|f| matches!(f, ClaimOutcome::NotMeasured { .. }));
    let all = rows.len();
    let text = format!(
        "{holds} of {all} claims {}, {differs} {} for a reason, {fails} {}",
        verb(holds, "hold"),
        verb(differs, "differ"),
        verb(fails, "fail")
    );
    let detail = if open == 0 { String::new() } else { format!("{open} are not measured by this command.") };
    let tone = match (fails, holds) {
        (0, 0) => OutcomeTone::Neutral,
        (0, _) => OutcomeTone::Good,
        _ => OutcomeTone::Bad,
    };
    Headline { tone, text, detail }
}

fn verb(count: usize, plural: &str) -> String {
    if count == 1 { format!("{plural}s") } else { plural.to_owned() }
}

/// Tone, word, and what is said beside the measurement.
fn outcome(finding: &ClaimOutcome) -> (OutcomeTone, &'static str, String) {
    match finding {
        ClaimOutcome::Holds => (OutcomeTone::Good, "holds", String::new()),
        ClaimOutcome::Fails => (OutcomeTone::Bad, "fails", String::new()),
        ClaimOutcome::Differs { why } => (OutcomeTone::Neutral, "differs", format!("Why it differs: {why}.")),
        ClaimOutcome::NotMeasured { why } => {
            (OutcomeTone::Neutral, "not measured", format!("Not measured: {why}."))
        }
    }
}

fn tile(claim: &Claim) -> FigureTile {
    let (tone, word, _) = outcome(&claim.finding());
    let note = claim.title.to_owned();
    FigureTile { label: claim.id.to_owned(), value: word.to_owned(), unit: String::new(), note, tone }
}

/// Returns one row a claim.
pub fn claims_table(rows: &[Claim]) -> ReportTable {
    let columns = [
        ReportColumn::Text(""),
        ReportColumn::Text("thesis"),
        ReportColumn::Text("says"),
        ReportColumn::Text("measured here"),
        ReportColumn::Text("verdict"),
    ];
    let mut table = ReportTable::new("", &columns);
    table.rows = rows.iter().map(row).collect();
    table
}

fn row(claim: &Claim) -> Vec<ReportCell> {
    let (tone, word, _) = outcome(&claim.finding());
    vec![
        ReportCell::text(claim.id),
        ReportCell::text(keep_together(claim.source)),
        ReportCell::text(claim.says),
        ReportCell::text(claim.measured.as_str()),
        ReportCell::Verdict(tone, word.to_owned()),
    ]
}

/// Returns a reference that is broken only after a comma.
fn keep_together(source: &str) -> String {
    source.replace('-', "\u{2011}").replace(' ', "\u{A0}").replace(",\u{A0}", ", ")
}

/// Returns a row as a page of its own: what is said, what was measured, why it differs, and its figures.
fn section(claim: &Claim, command: &str) -> ReportSection {
    let (_, word, why) = outcome(&claim.finding());
    let mut section = ReportSection::new(&format!("{} {}: {word}", claim.id, claim.title))
        .with_text(format!("The thesis, {}: {}.", claim.source, claim.says));
    if !claim.measured.is_empty() {
        section = section.with_text(format!("Measured: {}.", claim.measured));
    }
    if !why.is_empty() {
        section = section.with_text(why);
    }
    if !claim.criteria.is_empty() {
        section = section.with_table(criteria(&claim.criteria));
    }
    section.with_figures(
        claim.drawings.iter().map(|figure| Figure { command: command.to_owned(), ..figure.clone() }),
    )
}

/// Returns every criterion with what the thesis says, the range that agrees with it, and what was measured.
fn criteria(all: &[Criterion]) -> ReportTable {
    let columns = [
        ReportColumn::Text("quantity"),
        ReportColumn::Text("thesis"),
        ReportColumn::Number("measured"),
        ReportColumn::Text("agrees"),
        ReportColumn::Text("why this range"),
        ReportColumn::Text("verdict"),
    ];
    let mut table = ReportTable::new("What must hold", &columns);
    table.rows = all.iter().map(criterion).collect();
    table
}

fn criterion(one: &Criterion) -> Vec<ReportCell> {
    let explained = one.explained.map_or(String::new(), |(low, high)| {
        format!("; explained from {} to {}", short_number(low), short_number(high))
    });
    let (tone, word) = match one.agreement() {
        Agreement::Agrees => (OutcomeTone::Good, "agrees"),
        Agreement::Explained => (OutcomeTone::Neutral, "explained"),
        Agreement::Disagrees => (OutcomeTone::Bad, "disagrees"),
    };
    vec![
        ReportCell::text(one.what.as_str()),
        ReportCell::text(one.thesis.as_str()),
        ReportCell::number(one.measured),
        ReportCell::text(one.range() + &explained),
        ReportCell::text(one.reason.as_str()),
        ReportCell::Verdict(tone, word.to_owned()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::{ClaimCurve, factor_axis, make_figure, make_panel};
    use counterpoise_plot::{Axis, Mark, Point};

    fn claim(criterion: Criterion, why: &str) -> Claim {
        let points = vec![Point::new(0.5, 1.0), Point::new(1.0, 2.0)];
        let panel = make_panel(Axis::linear("overshoot", "%"), vec![ClaimCurve::points("measured", points)]);
        let figure = make_figure("Overshoot", factor_axis("inertia"), vec![panel.with_level(13.0, "thesis")]);
        Claim {
            id: "C1",
            title: "elements",
            source: "table 6-1",
            says: "something",
            measured: "1 to 2 %".to_owned(),
            criteria: vec![criterion],
            why: why.to_owned(),
            drawings: vec![figure],
        }
    }

    #[test]
    fn every_row_is_on_the_first_screen_in_the_table_and_on_a_page_with_its_figure_and_command() {
        let of = |measured| Criterion::at_most("overshoot", "13 %", measured, 13.0, "the thesis' own figure");
        let rows = [claim(of(10.0), ""), claim(of(14.0).with_explained_range(13.0, 15.0), "of a reason")];
        let page = claims_report(&rows, VerificationContext::default(), &|id| {
            format!("counterpoise claims RIG --only {id}")
        });
        assert_eq!((page.tiles.len(), page.verdicts.rows.len(), page.sections.len()), (2, 2, 2));
        assert_eq!(page.tiles[1].value, "differs");
        assert_eq!(claim(of(20.0), "of a reason").finding(), ClaimOutcome::Fails);
        assert_eq!(page.sections[0].tables[0].rows.len(), 1);
        assert!(page.sections[1].text.iter().any(|text| text.contains("of a reason")));
        let drawn = &page.sections[0].figures[0];
        assert_eq!(drawn.command, "counterpoise claims RIG --only C1");
        assert_eq!(drawn.panels()[0].y.text(), "overshoot [%]");
        let texts: Vec<_> =
            drawn.panels()[0].marks.iter().filter(|m| matches!(m, Mark::Point { .. })).collect();
        assert_eq!(texts.len(), 2, "each of few points is marked");
    }
}
