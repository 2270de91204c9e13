//! The page of the thesis' claims: verdicts on the first screen, the table, then each row with the curves that decided it.

use crate::picture::{Axis as Quantity, Curve, Mark as Marked, Panel as Drawn, Spacing, Style};
use crate::{Claim, Finding, Picture};

use counterpoise_plot::{Axis, Colour, Dash, Figure, Mark, Panel, Series};
use counterpoise_report::summary::capital;
use counterpoise_report::verification::Context;
use counterpoise_report::{Cell, Column, Headline, Report, Section, Table, Tile, Tone};

/// The report: the verdicts are the first screen. `again` is the command that measures one row again.
pub fn report(rows: &[Claim], context: Context, again: &dyn Fn(&str) -> String) -> Report {
    let mut sections: Vec<Section> = rows.iter().map(|row| section(row, &again(row.id))).collect();
    sections.extend(context.more);
    Report {
        title: context.title,
        subtitle: context.subtitle,
        headline: headline(rows),
        tiles: rows.iter().map(tile).collect(),
        verdicts: table(rows),
        glance: Vec::new(),
        sections,
        provenance: context.provenance,
    }
}

fn headline(rows: &[Claim]) -> Headline {
    let count = |which: fn(&Finding) -> bool| rows.iter().filter(|row| which(&row.finding)).count();
    let holds = count(|f| *f == Finding::Holds);
    let differs = count(|f| matches!(f, Finding::Differs { .. }));
    let fails = count(|f| *f == Finding::Fails);
    let open = count(|f| matches!(f, Finding::NotMeasured { .. }));
    let all = rows.len();
    let text = format!(
        "{holds} of {all} claims {}, {differs} {} for a reason, {fails} {}",
        verb(holds, "hold"),
        verb(differs, "differ"),
        verb(fails, "fail")
    );
    let detail = if open == 0 { String::new() } else { format!("{open} are not measured by this command.") };
    let tone = match (fails, holds) {
        (0, 0) => Tone::Neutral,
        (0, _) => Tone::Good,
        _ => Tone::Bad,
    };
    Headline { tone, text, detail }
}

fn verb(count: usize, plural: &str) -> String {
    if count == 1 { format!("{plural}s") } else { plural.to_owned() }
}

/// Tone, word, and what is said beside the measurement.
fn outcome(finding: &Finding) -> (Tone, &'static str, String) {
    match finding {
        Finding::Holds => (Tone::Good, "holds", String::new()),
        Finding::Fails => (Tone::Bad, "fails", String::new()),
        Finding::Differs { why } => (Tone::Neutral, "differs", format!("Why it differs: {why}.")),
        Finding::NotMeasured { why } => (Tone::Neutral, "not measured", format!("Not measured: {why}.")),
    }
}

fn tile(claim: &Claim) -> Tile {
    let (tone, word, _) = outcome(&claim.finding);
    let note = claim.title.to_owned();
    Tile { label: claim.id.to_owned(), value: word.to_owned(), unit: String::new(), note, tone }
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
    let (tone, word, _) = outcome(&claim.finding);
    vec![
        Cell::text(claim.id),
        Cell::text(whole(claim.source)),
        Cell::text(claim.says),
        Cell::text(claim.measured.as_str()),
        Cell::Verdict(tone, word.to_owned()),
    ]
}

/// A reference that is broken only after a comma.
fn whole(source: &str) -> String {
    source.replace('-', "\u{2011}").replace(' ', "\u{A0}").replace(",\u{A0}", ", ")
}

/// A row as a page of its own: what is said, what was measured, why it differs, and its figures.
fn section(claim: &Claim, command: &str) -> Section {
    let (_, word, why) = outcome(&claim.finding);
    let mut section = Section::new(&format!("{} {}: {word}", claim.id, claim.title))
        .saying(format!("The thesis, {}: {}.", claim.source, claim.says));
    if !claim.measured.is_empty() {
        section = section.saying(format!("Measured: {}.", claim.measured));
    }
    if !why.is_empty() {
        section = section.saying(why);
    }
    section.showing(
        claim.pictures.iter().map(|picture| Figure { command: command.to_owned(), ..figure(picture) }),
    )
}

/// A picture's data as a figure.
pub fn figure(picture: &Picture) -> Figure {
    let high = if picture.panels.len() > 2 { 150.0 } else { 190.0 };
    let panels = picture.panels.iter().map(|drawn| panel(drawn).with_height(high)).collect();
    Figure::new(&picture.title, axis(&picture.x), panels).with_caption(&picture.caption)
}

fn axis(quantity: &Quantity) -> Axis {
    let name = quantity.quantity.as_str();
    match (quantity.unit, quantity.spacing) {
        ("deg", Spacing::Even) => Axis::degrees(name),
        (unit, Spacing::Even) => Axis::linear(name, unit),
        (unit, Spacing::Logarithmic) => Axis::logarithmic(name, unit),
    }
}

fn panel(drawn: &Drawn) -> Panel {
    let (mut series, mut marks, mut at) = (Vec::new(), Vec::new(), 0);
    for curve in &drawn.curves {
        let (colour, dash) = dress(curve, &mut at);
        if curve.style == Style::Points {
            let ring =
                |point: &(f64, f64)| Mark::Point { x: point.0, y: point.1, text: String::new(), colour };
            marks.extend(curve.points.iter().map(ring));
        }
        series.push(Series::new(&capital(&curve.name), (colour, dash), curve.points.iter().copied()));
    }
    marks.extend(drawn.marks.iter().map(mark));
    Panel::new(axis(&drawn.y), series).with_marks(marks)
}

/// Colours in turn, a pair in one colour.
fn dress(curve: &Curve, at: &mut usize) -> (Colour, Dash) {
    if curve.style == Style::Faint {
        return (Colour::Muted, Dash::Solid);
    }
    let of = |turn: usize| Colour::CYCLE[turn % Colour::CYCLE.len()];
    if curve.style == Style::Pair {
        return (of(at.saturating_sub(1)), Dash::Dashed);
    }
    *at += 1;
    (of(*at - 1), if curve.style == Style::Beside { Dash::Dashed } else { Dash::Solid })
}

fn mark(mark: &Marked) -> Mark {
    match mark {
        Marked::Level(y, text) => Mark::Level { y: *y, text: text.clone() },
        Marked::At(x, text) => Mark::Instant { x: *x, text: text.clone() },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn claim(finding: Finding) -> Claim {
        let points = vec![(0.5, 1.0), (1.0, 2.0)];
        let panel = Drawn::of(Quantity::even("overshoot", "%"), vec![Curve::points("measured", points)]);
        let picture =
            Picture::new("Overshoot", Quantity::factor("inertia"), vec![panel.level(13.0, "thesis")]);
        Claim {
            id: "C1",
            title: "elements",
            source: "table 6-1",
            says: "something",
            measured: "1 to 2 %".to_owned(),
            finding,
            pictures: vec![picture],
        }
    }

    #[test]
    fn every_row_is_on_the_first_screen_in_the_table_and_on_a_page_with_its_figure_and_command() {
        let rows = [claim(Finding::Holds), claim(Finding::Differs { why: "of a reason".to_owned() })];
        let page = report(&rows, Context::default(), &|id| format!("counterpoise claims RIG --only {id}"));
        assert_eq!((page.tiles.len(), page.verdicts.rows.len(), page.sections.len()), (2, 2, 2));
        assert_eq!(page.tiles[1].value, "differs");
        assert!(page.sections[1].text.iter().any(|text| text.contains("of a reason")));
        let drawn = &page.sections[0].figures[0];
        assert_eq!(drawn.command, "counterpoise claims RIG --only C1");
        assert_eq!(drawn.panels()[0].y.text(), "overshoot [%]");
        let texts: Vec<_> =
            drawn.panels()[0].marks.iter().filter(|m| matches!(m, Mark::Point { .. })).collect();
        assert_eq!(texts.len(), 2, "each of few points is marked");
    }
}
