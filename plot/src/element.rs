//! The few SVG elements that figures need, written as text.

use std::fmt::Write as _;

/// SVG text under construction.
#[derive(Debug, Default)]
pub struct Svg {
    text: String,
}

/// Which side of its point a text stands on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// To the right.
    Start,
    /// Centred.
    Middle,
    /// To the left.
    End,
}

impl Svg {
    /// Everything written so far.
    pub fn finish(self) -> String {
        self.text
    }

    /// Raw markup, for opening and closing tags.
    pub fn raw(&mut self, markup: &str) {
        self.text.push_str(markup);
    }

    /// A straight line.
    pub fn line(&mut self, class: &str, from: (f64, f64), to: (f64, f64)) {
        self.put(format_args!(
            "<path class=\"{class}\" d=\"M{} {}L{} {}\"/>",
            px(from.0),
            px(from.1),
            px(to.0),
            px(to.1)
        ));
    }

    /// An open path through the points of each run.
    pub fn runs(&mut self, class: &str, runs: &[Vec<(f64, f64)>]) {
        let mut path = String::new();
        for run in runs.iter().filter(|run| !run.is_empty()) {
            for (k, (x, y)) in run.iter().enumerate() {
                let letter = if k == 0 { "M" } else { "L" };
                let _ = write!(path, "{letter}{} {}", px(*x), px(*y));
            }
        }
        if !path.is_empty() {
            self.put(format_args!("<path class=\"{class}\" d=\"{path}\"/>"));
        }
    }

    /// A filled region.
    pub fn polygon(&mut self, class: &str, points: &[(f64, f64)]) {
        let corners: Vec<String> = points.iter().map(|(x, y)| format!("{},{}", px(*x), px(*y))).collect();
        self.put(format_args!("<polygon class=\"{class}\" points=\"{}\"/>", corners.join(" ")));
    }

    /// A ring.
    pub fn ring(&mut self, class: &str, centre: (f64, f64), radius: f64) {
        self.put(format_args!(
            "<circle class=\"{class}\" cx=\"{}\" cy=\"{}\" r=\"{radius}\"/>",
            px(centre.0),
            px(centre.1)
        ));
    }

    /// A rectangle's outline.
    pub fn frame(&mut self, class: &str, corner: (f64, f64), size: (f64, f64)) {
        self.put(format_args!(
            "<rect class=\"{class}\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>",
            px(corner.0),
            px(corner.1),
            px(size.0),
            px(size.1)
        ));
    }

    /// A line of text.
    pub fn text(&mut self, class: &str, at: (f64, f64), anchor: Anchor, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        self.put(format_args!(
            "<text class=\"{class}\" x=\"{}\" y=\"{}\" text-anchor=\"{anchor}\">{}</text>",
            px(at.0),
            px(at.1),
            escape(text)
        ));
    }

    /// A line of text that runs upwards, centred.
    pub fn upright(&mut self, class: &str, at: (f64, f64), text: &str) {
        let (x, y) = (px(at.0), px(at.1));
        self.put(format_args!(
            "<text class=\"{class}\" transform=\"translate({x} {y}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            escape(text)
        ));
    }

    /// A line of text that rises to the right from its start.
    pub fn rising(&mut self, class: &str, at: (f64, f64), text: &str) {
        let (x, y) = (px(at.0), px(at.1));
        self.put(format_args!(
            "<text class=\"{class}\" transform=\"translate({x} {y}) rotate(-38)\">{}</text>",
            escape(text)
        ));
    }

    /// A filled rectangle of a strength from 0 to 1.
    pub fn cell(&mut self, class: &str, corner: (f64, f64), size: (f64, f64), strength: f64) {
        self.put(format_args!(
            "<rect class=\"{class}\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill-opacity=\"{strength:.2}\"/>",
            px(corner.0),
            px(corner.1),
            px(size.0),
            px(size.1)
        ));
    }

    /// Writing to a string cannot fail.
    fn put(&mut self, markup: std::fmt::Arguments<'_>) {
        let _ = self.text.write_fmt(markup);
        self.text.push('\n');
    }
}

/// A coordinate to a tenth of a pixel, without trailing zeros.
pub fn px(value: f64) -> String {
    let rounded = (value * 10.0).round() / 10.0;
    if rounded == 0.0 { "0".to_owned() } else { rounded.to_string() }
}

/// Text that is safe inside markup and attributes.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// About how wide a text will be in the viewer's font, in pixels.
pub fn width_of(text: &str, font_px: f64) -> f64 {
    0.57 * font_px * text.chars().count() as f64
}
