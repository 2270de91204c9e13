//! Writes a report as one HTML page.

use std::fmt::Write as _;

use crate::style::PAGE_CSS;
use crate::{
    FigureTile, Headline, OutcomeTone, ProvenanceEntry, Report, ReportCell, ReportColumn, ReportSection,
    ReportTable,
};
use counterpoise_plot::svg::{self, escape_xml};
use counterpoise_plot::{Figure, Theme, css};

/// Returns the report as a page that needs nothing else. Deterministic.
pub fn html_page(report: &Report) -> String {
    let mut page = Page::default();
    page.head(&report.title);
    page.first_screen(report);
    page.contents(&report.sections);
    for (number, section) in report.sections.iter().enumerate() {
        page.section(number, section);
    }
    page.provenance(&report.provenance);
    page.put("</main></body></html>\n");
    page.text
}

#[derive(Default)]
struct Page {
    text: String,
}

impl Page {
    fn put(&mut self, markup: &str) {
        self.text.push_str(markup);
    }

    /// Markup with places for text; the caller has escaped what it puts in. Writing to a string cannot fail.
    fn form(&mut self, markup: std::fmt::Arguments<'_>) {
        let _ = self.text.write_fmt(markup);
    }

    fn head(&mut self, title: &str) {
        self.put("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n");
        self.put("<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n");
        self.put("<meta name=\"color-scheme\" content=\"light dark\">\n");
        self.form(format_args!(
            "<title>{}</title>\n<style>\n{}{PAGE_CSS}@media print{{{}}}\n</style></head><body><main>\n",
            escape_xml(title),
            css::style_sheet(),
            Theme::Light.properties()
        ));
    }

    fn first_screen(&mut self, report: &Report) {
        self.form(format_args!(
            "<header><h1>{}</h1><p class=\"soft\">{}</p></header>\n",
            escape_xml(&report.title),
            escape_xml(&report.subtitle)
        ));
        self.headline(&report.headline);
        self.put("<div class=\"tiles\">\n");
        for tile in &report.tiles {
            self.tile(tile);
        }
        self.put("</div>\n");
        self.verdicts_beside_glance(report);
    }

    /// The verdicts with pictures beside them, or over the whole width if there are none.
    fn verdicts_beside_glance(&mut self, report: &Report) {
        if report.glance.is_empty() {
            return self.table(&report.verdicts);
        }
        self.put("<div class=\"pair\"><div>\n");
        self.table(&report.verdicts);
        self.put("</div><div>\n");
        for figure in &report.glance {
            self.figure(figure);
        }
        self.put("</div></div>\n");
    }

    fn headline(&mut self, headline: &Headline) {
        let (class, sign) = class_and_sign(headline.tone);
        self.form(format_args!(
            "<div class=\"headline {class}\"><span class=\"sign\">{sign}</span><div><strong>{}</strong>",
            escape_xml(&headline.text)
        ));
        if !headline.detail.is_empty() {
            self.form(format_args!("<br><span>{}</span>", escape_xml(&headline.detail)));
        }
        self.put("</div></div>\n");
    }

    fn tile(&mut self, tile: &FigureTile) {
        let (class, _) = class_and_sign(tile.tone);
        self.form(format_args!(
            "<div class=\"tile {class}\"><span class=\"label\">{}</span><span class=\"value\">{}<small> {}</small></span><span class=\"soft\">{}</span></div>\n",
            escape_xml(&tile.label),
            escape_xml(&tile.value),
            escape_xml(&tile.unit),
            escape_xml(&tile.note)
        ));
    }

    fn contents(&mut self, sections: &[ReportSection]) {
        self.put("<nav>");
        for (number, section) in sections.iter().enumerate() {
            self.form(format_args!("<a href=\"#s{}\">{}</a>", number + 1, escape_xml(&section.heading)));
        }
        self.put("</nav>\n");
    }

    fn section(&mut self, number: usize, section: &ReportSection) {
        self.form(format_args!(
            "<section id=\"s{0}\"><h2>{0}. {1}</h2>\n",
            number + 1,
            escape_xml(&section.heading)
        ));
        for paragraph in &section.text {
            self.form(format_args!("<p>{}</p>\n", escape_xml(paragraph)));
        }
        self.put("<div class=\"figures\">\n");
        for figure in &section.figures {
            self.figure(figure);
        }
        self.put("</div>\n");
        for table in &section.tables {
            self.table(table);
        }
        self.put("</section>\n");
    }

    fn figure(&mut self, figure: &Figure) {
        self.form(format_args!(
            "<figure><h3>{}</h3>\n{}",
            escape_xml(&figure.title),
            svg::inline_svg(figure)
        ));
        if !figure.caption.is_empty() || !figure.command.is_empty() {
            self.form(format_args!("<figcaption>{}", escape_xml(&figure.caption)));
            if !figure.command.is_empty() {
                self.form(format_args!(" <code>{}</code>", escape_xml(&figure.command)));
            }
            self.put("</figcaption>");
        }
        self.put("</figure>\n");
    }

    fn table(&mut self, table: &ReportTable) {
        self.put("<div class=\"table\"><table>");
        if !table.caption.is_empty() {
            self.form(format_args!("<caption>{}</caption>", escape_xml(&table.caption)));
        }
        self.put("<thead><tr>");
        for column in &table.columns {
            let (class, name) = class_and_name(*column);
            self.form(format_args!("<th class=\"{class}\">{}</th>", escape_xml(&unit_in_one_piece(name))));
        }
        self.put("</tr></thead><tbody>\n");
        for row in &table.rows {
            self.row(&table.columns, row);
        }
        self.put("</tbody></table></div>\n");
    }

    fn row(&mut self, columns: &[ReportColumn], row: &[ReportCell]) {
        self.put("<tr>");
        for (column, cell) in columns.iter().zip(row) {
            let (class, _) = class_and_name(*column);
            self.form(format_args!("<td class=\"{class}\">{}</td>", cell_markup(cell)));
        }
        self.put("</tr>\n");
    }

    fn provenance(&mut self, all: &[ProvenanceEntry]) {
        self.put("<footer><dl>");
        for ProvenanceEntry { name, value } in all {
            self.form(format_args!("<dt>{}</dt><dd>{}</dd>", escape_xml(name), escape_xml(value)));
        }
        self.put("</dl></footer>\n");
    }
}

fn cell_markup(cell: &ReportCell) -> String {
    match cell {
        ReportCell::Text(text) => escape_xml(text),
        ReportCell::Verdict(tone, text) => {
            let (class, sign) = class_and_sign(*tone);
            format!("<span class=\"chip {class}\">{sign}\u{A0}{}</span>", escape_xml(text))
        }
        ReportCell::Room(tone, part, text) => {
            let (class, _) = class_and_sign(*tone);
            let percent = (100.0 * part.clamp(0.0, 1.0)).round();
            format!(
                "<span class=\"pair-of\"><span class=\"room {class}\"><i style=\"width:{percent}%\"></i></span>{}</span>",
                escape_xml(text)
            )
        }
    }
}

/// Returns the name with no line break inside its unit, which stands in brackets at its end.
fn unit_in_one_piece(name: &str) -> String {
    match name.rsplit_once('[') {
        Some((words, unit)) => format!("{words}[{}", unit.replace(' ', "\u{A0}")),
        None => name.to_owned(),
    }
}

fn class_and_name(column: ReportColumn) -> (&'static str, &'static str) {
    match column {
        ReportColumn::Text(name) => ("words", name),
        ReportColumn::Number(name) => ("number", name),
    }
}

/// Returns the class of a tone and the sign that says the same without colour.
fn class_and_sign(tone: OutcomeTone) -> (&'static str, &'static str) {
    match tone {
        OutcomeTone::Good => ("good", "\u{2713}"),
        OutcomeTone::Bad => ("bad", "\u{2717}"),
        OutcomeTone::Neutral => ("none", "\u{2013}\u{2060}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use counterpoise_plot::{Axis, Colour, Panel, Series};

    fn report() -> Report {
        let series = Series::solid_line("hub", Colour::First, vec![(0.0, 0.0), (1.0, 1.0)]);
        let figure = Figure::new(
            "Step",
            Axis::linear("time", "s"),
            vec![Panel::new(Axis::linear("rate", "rad/s"), vec![series])],
        );
        let mut verdicts =
            ReportTable::new("Verdicts", &[ReportColumn::Text("requirement"), ReportColumn::Text("verdict")]);
        verdicts.rows.push(vec![
            ReportCell::text("a < b"),
            ReportCell::Verdict(OutcomeTone::Bad, "fails by 3".to_owned()),
        ]);
        Report {
            title: "rig <one>".to_owned(),
            subtitle: String::new(),
            headline: Headline {
                tone: OutcomeTone::Bad,
                text: "1 of 1 fails".to_owned(),
                detail: String::new(),
            },
            tiles: vec![],
            verdicts,
            glance: vec![figure.clone()],
            sections: vec![ReportSection::new("Step response").with_text("as & when").with_figures([figure])],
            provenance: vec![ProvenanceEntry::new("version", "1")],
        }
    }

    #[test]
    fn the_page_is_closed_escaped_and_needs_nothing_else() {
        let page = html_page(&report());
        for tag in ["main", "section", "table", "figure", "svg", "div", "nav", "footer"] {
            let (opened, closed) =
                (page.matches(&format!("<{tag}")).count(), page.matches(&format!("</{tag}>")).count());
            assert_eq!(opened, closed, "{tag}");
        }
        assert!(page.contains("rig &lt;one&gt;") && page.contains("a &lt; b"));
        assert!(!page.contains("src=") && !page.contains("<link") && !page.contains("<script"));
    }

    #[test]
    fn a_failure_is_seen_before_the_evidence() {
        let page = html_page(&report());
        let (headline, evidence) = (page.find("1 of 1 fails"), page.find("<section"));
        assert!(headline.is_some() && headline < evidence);
    }
}
