//! Draws coloured cells: rows x columns of shares with their numbers, and a scale of colours above them.

use crate::draw::{FONT, WIDTH};
use crate::element::{Anchor, Svg, escape, px, width_of};
use crate::{Heat, HeatGroup};

const ROW: f64 = 26.0;
const HEADING: f64 = 28.0;
const MARGIN: f64 = 12.0;
const SCALE_HEIGHT: f64 = 44.0;
const SCALE_CELL: f64 = 22.0;
/// Strength of the colour of a share of 1.
const FULL: f64 = 0.95;
/// Share from which on a number stands on a ground darker (or, on dark ground, lighter) than the page.
const STRONG: f64 = 0.75;

/// The cells as an `<svg>` element. Deterministic.
pub fn svg(title: &str, heat: &Heat, prologue: &str) -> String {
    let place = Place::of(heat);
    let mut svg = Svg::default();
    svg.raw(&format!(
        "<svg class=\"fig\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n{prologue}",
        px(WIDTH),
        px(place.bottom(heat)),
        escape(title)
    ));
    scale(&mut svg, heat);
    for (k, column) in heat.columns.iter().enumerate() {
        svg.rising("axis", (place.left + (k as f64 + 0.5) * place.width - 4.0, place.top - 6.0), column);
    }
    let mut y = place.top;
    for group in &heat.groups {
        y = draw_group(&mut svg, (heat, group), &place, y);
    }
    svg.raw("</svg>\n");
    svg.finish()
}

/// Where the cells stand.
struct Place {
    left: f64,
    top: f64,
    width: f64,
}

impl Place {
    fn of(heat: &Heat) -> Self {
        let names = heat.groups.iter().flat_map(|g| g.rows.iter().map(|row| width_of(&row.name, FONT)));
        let left = names.fold(60.0, f64::max) + MARGIN + 8.0;
        let longest = heat.columns.iter().map(|c| width_of(c, FONT)).fold(0.0, f64::max);
        // the last heading leans beyond its column
        let room = WIDTH - left - MARGIN - 0.3 * longest;
        let top = SCALE_HEIGHT + 0.62 * longest + 14.0;
        Self { left, top, width: room / heat.columns.len().max(1) as f64 }
    }

    fn bottom(&self, heat: &Heat) -> f64 {
        let rows = |g: &HeatGroup| HEADING + ROW * g.rows.len() as f64;
        self.top + heat.groups.iter().map(rows).sum::<f64>() + MARGIN
    }
}

/// The scale of colours with what it means.
fn scale(svg: &mut Svg, heat: &Heat) {
    for k in 0..=10 {
        let x = MARGIN + SCALE_CELL * f64::from(k);
        svg.cell("heat", (x, 8.0), (SCALE_CELL, 12.0), FULL * 0.1 * f64::from(k));
        if k % 5 == 0 {
            svg.text("axis", (x + 0.5 * SCALE_CELL, 34.0), Anchor::Middle, &format!("{} %", 10 * k));
        }
    }
    let right = MARGIN + 11.0 * SCALE_CELL + 18.0;
    svg.text("", (right, 18.0), Anchor::Start, &heat.meaning);
    if heat.groups.iter().flat_map(|g| &g.rows).any(|row| !row.ringed.is_empty()) {
        draw_ring(svg, (right, 25.0), (SCALE_CELL, 12.0));
        svg.text("", (right + SCALE_CELL + 6.0, 35.0), Anchor::Start, &heat.ring);
    }
}

/// A group from a height on; gives the height below it.
fn draw_group(svg: &mut Svg, (heat, group): (&Heat, &HeatGroup), place: &Place, top: f64) -> f64 {
    svg.text("axis", (MARGIN, top + HEADING - 9.0), Anchor::Start, &group.heading);
    let mut y = top + HEADING;
    for row in &group.rows {
        svg.text("", (place.left - 8.0, y + 0.5 * ROW + 4.0), Anchor::End, &row.name);
        if row.shares.is_empty() {
            draw_blind(svg, heat, place, y);
        }
        let corner = |k: usize| (place.left + k as f64 * place.width, y);
        for (k, share) in row.shares.iter().enumerate() {
            draw_cell(svg, *share, corner(k), place.width);
        }
        row.ringed.iter().for_each(|&k| draw_ring(svg, corner(k), (place.width, ROW)));
        y += ROW;
    }
    y
}

/// A row that nothing sees.
fn draw_blind(svg: &mut Svg, heat: &Heat, place: &Place, y: f64) {
    let width = place.width * heat.columns.len() as f64;
    svg.cell("blind", (place.left, y + 1.0), (width, ROW - 2.0), 1.0);
    let middle = (place.left + 0.5 * width, y + 0.5 * ROW + 4.0);
    svg.text("", middle, Anchor::Middle, "these sensors do not see it");
}

fn draw_cell(svg: &mut Svg, share: Option<f64>, corner: (f64, f64), width: f64) {
    let strength = share.unwrap_or(0.0).clamp(0.0, 1.0);
    svg.cell("heat", corner, (width, ROW), FULL * strength);
    let text = share.map_or_else(|| "\u{2013}".to_owned(), |s| format!("{:.0}", 100.0 * s));
    let class = if strength > STRONG { "on" } else { "" };
    svg.text(class, (corner.0 + 0.5 * width, corner.1 + 0.5 * ROW + 4.0), Anchor::Middle, &text);
}

/// A ring just inside a cell.
fn draw_ring(svg: &mut Svg, corner: (f64, f64), size: (f64, f64)) {
    svg.frame("named", (corner.0 + 1.5, corner.1 + 1.5), (size.0 - 3.0, size.1 - 3.0));
}

#[cfg(test)]
mod tests {
    use super::super::HeatRow;
    use super::*;

    #[test]
    fn every_cell_has_its_number_and_what_is_not_known_has_none() {
        let row = HeatRow { name: "pivot".to_owned(), shares: vec![Some(0.873), None], ringed: vec![1] };
        let blind = HeatRow { name: "platform gyro".to_owned(), shares: Vec::new(), ringed: Vec::new() };
        let groups = vec![HeatGroup { heading: "components".to_owned(), rows: vec![row, blind] }];
        let columns = vec!["rate".to_owned(), "a < b".to_owned()];
        let (meaning, ring) = ("share".to_owned(), "found".to_owned());
        let picture = svg("where", &Heat { meaning, ring, columns, groups }, "");
        assert!(picture.contains(">87</text>") && picture.contains(">\u{2013}</text>"));
        assert!(picture.contains("a &lt; b") && picture.contains(">100 %</text>"));
        assert_eq!(picture.matches("fill-opacity=\"0.83\"").count(), 1, "{picture}");
        assert!(picture.contains("class=\"blind\"") && picture.contains("do not see it"));
        assert_eq!(picture.matches("class=\"named\"").count(), 2, "the ring and its legend: {picture}");
        assert!(picture.contains(">found</text>") && !picture.contains("NaN"));
    }
}
