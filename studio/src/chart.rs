//! Plots: data first, drawn in the theme, copied as numbers, drawing or pixels.

use std::fmt::Write;

use egui::{Color32, Ui, Vec2};
use egui_plot::{GridInput, GridMark, Line, LineStyle, Plot, PlotPoint, PlotPoints, PlotTransform};

use crate::theme::Theme;

/// A curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Its name.
    pub name: String,
    /// Its points, in the units of the axes.
    pub points: Vec<[f64; 2]>,
    /// Its colour.
    pub colour: Color32,
    /// How it is stroked.
    pub dash: Dash,
}

/// How a curve is stroked, so that it can be read without colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dash {
    /// Unbroken.
    Solid,
    /// Dashes.
    Dashed,
    /// Dots.
    Dotted,
}

/// How an axis runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By decades.
    Log,
}

/// A plot as data.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// What it shows; also its name for copies and screen readers.
    pub title: String,
    /// What the axes are, with units.
    pub labels: [String; 2],
    /// How they run.
    pub scales: [Scale; 2],
    /// What is on it.
    pub curves: Vec<Curve>,
    /// Vertical marks with their labels.
    pub marks: Vec<(f64, String)>,
    /// Horizontal lines.
    pub levels: Vec<f64>,
    /// Fixed range of the axes, where they have one.
    pub range: [Option<(f64, f64)>; 2],
}

/// What showing a chart gives back.
pub struct Shown {
    /// Where plot coordinates lie on the screen; logarithmic axes are in decades.
    pub transform: PlotTransform,
    /// The plot as a widget.
    pub response: egui::Response,
}

impl Chart {
    /// A chart without curves.
    pub fn new(title: &str, x: &str, y: &str) -> Self {
        Self {
            title: title.to_owned(),
            labels: [x.to_owned(), y.to_owned()],
            scales: [Scale::Linear; 2],
            curves: Vec::new(),
            marks: Vec::new(),
            levels: Vec::new(),
            range: [None, None],
        }
    }

    /// With another curve.
    #[must_use]
    pub fn curve(mut self, name: &str, colour: Color32, dash: Dash, points: Vec<[f64; 2]>) -> Self {
        self.curves.push(Curve { name: name.to_owned(), points, colour, dash });
        self
    }

    /// Shows the chart in its card, with the legend above the data.
    pub fn show(&self, ui: &mut Ui, theme: &Theme, size: Vec2) -> Shown {
        let inner = size - Vec2::splat(18.0);
        theme
            .card()
            .show(ui, |ui| {
                ui.set_width(inner.x);
                ui.spacing_mut().item_spacing.y = 2.0;
                self.heading(ui, theme);
                let height = (inner.y - 24.0).max(40.0);
                self.plot(ui, theme, Vec2::new(inner.x, height))
            })
            .inner
    }

    fn heading(&self, ui: &mut Ui, theme: &Theme) {
        ui.horizontal(|ui| {
            ui.set_height(20.0);
            ui.label(egui::RichText::new(&self.title).strong());
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.spacing_mut().item_spacing.x = 5.0;
                for curve in self.curves.iter().rev().filter(|c| !c.name.is_empty()) {
                    ui.label(egui::RichText::new(&curve.name).small().color(theme.weak));
                    swatch(ui, curve);
                }
            });
        });
    }

    fn plot(&self, ui: &mut Ui, theme: &Theme, size: Vec2) -> Shown {
        let mut plot = Plot::new(("chart", &self.title))
            .width(size.x)
            .height(size.y)
            .x_axis_label(egui::RichText::new(&self.labels[0]).small().color(theme.weak))
            .y_axis_label(egui::RichText::new(&self.labels[1]).small().color(theme.weak))
            .y_axis_min_width(46.0)
            .grid_color(theme.grid)
            .show_background(false)
            .allow_double_click_reset(true)
            .set_margin_fraction(Vec2::new(0.0, 0.06))
            .label_formatter(|_| None);
        if self.scales[0] == Scale::Linear {
            plot = plot.x_grid_spacer(|input| even(input, X_MARKS)).x_axis_formatter(|mark, _| plain(mark));
        }
        if self.scales[1] == Scale::Linear {
            plot = plot.y_grid_spacer(|input| even(input, Y_MARKS)).y_axis_formatter(|mark, _| plain(mark));
        }
        if self.scales[0] == Scale::Log {
            plot = plot
                .x_grid_spacer(decades)
                .x_axis_formatter(|mark, range| power(mark, range.end() - range.start()));
        }
        if self.scales[1] == Scale::Log {
            plot = plot
                .y_grid_spacer(decades)
                .y_axis_formatter(|mark, range| power(mark, range.end() - range.start()));
        }
        let [x, y] = self.range;
        if let Some((low, high)) = x.map(|r| self.limits(0, r)) {
            plot = plot.default_x_bounds(low, high);
        }
        let pixels = size.x;
        let shown = plot.show(ui, |plot| {
            if let (Some((low, high)), true) = (y.map(|r| self.limits(1, r)), plot.auto_bounds().y) {
                plot.set_plot_bounds_y(low..=high);
            }
            self.draw(plot, theme, pixels);
        });
        let title = self.title.clone();
        let response = shown.response;
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, format!("plot: {title}")));
        Shown { transform: shown.transform, response }
    }

    fn limits(&self, axis: usize, (low, high): (f64, f64)) -> (f64, f64) {
        (self.place(axis, low), self.place(axis, high))
    }

    /// A value in plot coordinates.
    pub fn place(&self, axis: usize, value: f64) -> f64 {
        if self.scales[axis] == Scale::Log { value.max(f64::MIN_POSITIVE).log10() } else { value }
    }

    fn draw<'a>(&'a self, plot: &mut egui_plot::PlotUi<'a>, theme: &Theme, pixels: f32) {
        for level in &self.levels {
            let y = self.place(1, *level);
            plot.hline(
                egui_plot::HLine::new("", y)
                    .color(theme.weak.gamma_multiply(0.6))
                    .width(1.0)
                    .allow_hover(false),
            );
        }
        let bounds = plot.plot_bounds();
        let all = (f64::NEG_INFINITY, f64::INFINITY);
        let seen = if plot.auto_bounds().x { all } else { (bounds.min()[0], bounds.max()[0]) };
        for curve in &self.curves {
            let placed: Vec<[f64; 2]> =
                curve.points.iter().map(|p| [self.place(0, p[0]), self.place(1, p[1])]).collect();
            let points = thin(&placed, seen, pixels as usize);
            let style = match curve.dash {
                Dash::Solid => LineStyle::Solid,
                Dash::Dashed => LineStyle::dashed_dense(),
                Dash::Dotted => LineStyle::dotted_dense(),
            };
            plot.line(
                Line::new(&curve.name, PlotPoints::from(points)).color(curve.colour).width(1.6).style(style),
            );
        }
        for (x, label) in &self.marks {
            let x = self.place(0, *x);
            plot.vline(
                egui_plot::VLine::new("", x)
                    .color(theme.weak.gamma_multiply(0.7))
                    .width(1.0)
                    .allow_hover(false),
            );
            let top = bounds.min()[1] + 0.94 * (bounds.max()[1] - bounds.min()[1]);
            let text = egui::RichText::new(format!(" {label}")).small().color(theme.weak);
            plot.text(
                egui_plot::Text::new("", PlotPoint::new(x, top), text).anchor(egui::Align2::LEFT_CENTER),
            );
        }
    }

    /// The numbers: one column for x, one a curve, where the curves share their x; else x and y a curve.
    pub fn csv(&self) -> String {
        let mut out = String::from("curve,x,y\n");
        for curve in &self.curves {
            for [x, y] in &curve.points {
                let _ = writeln!(out, "{},{x:e},{y:e}", curve.name);
            }
        }
        out
    }

    /// The chart as a drawing of its own, on white.
    pub fn svg(&self) -> String {
        crate::svg::drawing(self)
    }
}

fn swatch(ui: &mut Ui, curve: &Curve) {
    let (rect, _) = ui.allocate_exact_size(Vec2::new(16.0, 10.0), egui::Sense::hover());
    let line = [rect.left_center(), rect.right_center()];
    let stroke = egui::Stroke::new(2.0, curve.colour);
    match curve.dash {
        Dash::Solid => {
            ui.painter().line_segment(line, stroke);
        }
        Dash::Dashed => ui.painter().extend(egui::Shape::dashed_line(&line, stroke, 5.0, 3.0)),
        Dash::Dotted => ui.painter().extend(egui::Shape::dotted_line(&line, curve.colour, 4.0, 1.2)),
    }
}

/// What a screen can show of a long curve: in each stretch of pixels the first, lowest, highest and last point.
pub fn thin(points: &[[f64; 2]], (low, high): (f64, f64), pixels: usize) -> Vec<[f64; 2]> {
    let from = points.partition_point(|p| p[0] < low).saturating_sub(1);
    let to = (points.partition_point(|p| p[0] <= high) + 1).min(points.len());
    let seen = if from < to { &points[from..to] } else { points };
    let stretches = pixels.max(64);
    if seen.len() <= 4 * stretches {
        return seen.to_vec();
    }
    let each = seen.len().div_ceil(stretches);
    let extremes = |part: &[[f64; 2]]| {
        let by = |better: fn(f64, f64) -> bool| {
            (0..part.len()).fold(0, |best, k| if better(part[k][1], part[best][1]) { k } else { best })
        };
        let mut kept = [0, by(|a, b| a < b), by(|a, b| a > b), part.len() - 1];
        kept.sort_unstable();
        kept.map(|k| part[k])
    };
    seen.chunks(each).flat_map(extremes).collect()
}

/// About how many marks stand on an even axis.
const X_MARKS: f64 = 6.0;
const Y_MARKS: f64 = 5.0;

/// Marks of an even axis, at round numbers.
fn even(input: GridInput, count: f64) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let raw = ((high - low) / count).max(f64::MIN_POSITIVE);
    let decade = 10f64.powf(raw.log10().floor());
    let step_size = [1.0, 2.0, 5.0, 10.0].map(|k| k * decade).into_iter().find(|s| *s >= raw).unwrap_or(raw);
    let marks = (low / step_size).ceil() as i64..=(high / step_size).floor() as i64;
    marks.map(|k| GridMark { value: k as f64 * step_size, step_size }).collect()
}

/// A mark's number, with the digits that its step needs.
fn plain(mark: GridMark) -> String {
    let digits = (-mark.step_size.log10()).ceil().clamp(0.0, 9.0) as usize;
    format!("{:.digits$}", mark.value + 0.0)
}

/// Marks of an axis that runs by decades.
fn decades(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let wide = high - low > 7.0;
    let mut marks = Vec::new();
    for decade in low.floor() as i64..=high.ceil() as i64 {
        let at = decade as f64;
        let step_size = if wide && decade % 2 != 0 { 0.2 } else { 1.0 };
        marks.push(GridMark { value: at, step_size });
        if !wide {
            marks.extend((2..10).map(|k| GridMark { value: at + f64::from(k).log10(), step_size: 0.1 }));
        }
    }
    marks.retain(|mark| (low..=high).contains(&mark.value));
    marks
}

fn power(mark: GridMark, _span: f64) -> String {
    if mark.step_size < 0.9 {
        return String::new();
    }
    let exponent = mark.value.round() as i32;
    match exponent {
        -3..=4 => format!("{}", 10f64.powi(exponent)),
        _ => format!("1e{exponent}"),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn peaks_survive_thinning_and_the_rest_is_left_out() {
        let mut points: Vec<[f64; 2]> =
            (0..600_000).map(|k| [f64::from(k) * 1e-3, (f64::from(k) * 0.01).sin()]).collect();
        points[123_456][1] = 9.0;
        let all = thin(&points, (0.0, 600.0), 1000);
        assert!(all.len() <= 4000 && all.iter().any(|p| p[1] == 9.0));
        let part = thin(&points, (10.0, 11.0), 1000);
        assert!(part.len() <= 1003 && part[0][0] <= 10.0 && part[part.len() - 1][0] >= 11.0);
    }
}
