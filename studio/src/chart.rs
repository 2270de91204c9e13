//! Plots: data first, drawn in the theme, copied as numbers, drawing or pixels.

use std::fmt::Write;

use egui::{Color32, Ui, Vec2};
use egui_plot::{AxisHints, Line, LineStyle, Plot, PlotPoint, PlotPoints, PlotTransform};

use crate::axes::{X_APART, Y_APART, marks, plain, power};
use crate::number::short;
use crate::pyramid::Points;
use crate::theme::Theme;
use crate::thinning::corners;

/// A curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Its name.
    pub name: String,
    /// Its points, in the units of the axes.
    pub points: Points,
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
    /// Single points with their labels.
    pub spots: Vec<([f64; 2], String)>,
    /// Horizontal lines.
    pub levels: Vec<f64>,
    /// Fixed range of the axes, where they have one.
    pub range: [Option<(f64, f64)>; 2],
    /// Charts of one group share their x axis and their cursor.
    pub group: Option<&'static str>,
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
            spots: Vec::new(),
            levels: Vec::new(),
            range: [None, None],
            group: None,
        }
    }

    /// With another curve.
    #[must_use]
    pub fn curve(self, name: &str, colour: Color32, dash: Dash, points: Vec<[f64; 2]>) -> Self {
        self.with(Curve { name: name.to_owned(), points: Points::Few(points), colour, dash })
    }

    /// With another curve, of any length.
    #[must_use]
    pub fn with(mut self, curve: Curve) -> Self {
        self.curves.push(curve);
        self
    }

    /// In a group of charts that are zoomed and read together.
    #[must_use]
    pub fn grouped(mut self, group: &'static str) -> Self {
        self.group = Some(group);
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
                let read = self.cursor(ui);
                for curve in self.curves.iter().rev().filter(|c| !c.name.is_empty()) {
                    match read.and_then(|x| curve.points.at(x)) {
                        Some(value) => ui.label(egui::RichText::new(short(value)).small().color(theme.text)),
                        None => ui.label(egui::RichText::new(&curve.name).small().color(theme.weak)),
                    };
                    swatch(ui, curve);
                }
                if let Some(x) = read {
                    ui.label(egui::RichText::new(format!("at {}", short(x))).small().color(theme.accent));
                }
            });
        });
    }

    /// The name under which the cursor of the chart, or of its group, is kept.
    fn cursor_id(&self) -> egui::Id {
        egui::Id::unique(("cursor", self.group.unwrap_or(self.title.as_str())))
    }

    /// Where the pointer stood on the chart, or on another of its group, in the frame before.
    fn cursor(&self, ui: &Ui) -> Option<f64> {
        let kept: Option<(u64, f64)> = ui.data(|d| d.get_temp(self.cursor_id()));
        let (frame, x) = kept?;
        (ui.ctx().cumulative_frame_nr() <= frame + 1).then_some(x)
    }

    fn note_cursor(&self, ui: &Ui, shown: &Shown) {
        if let Some(at) = shown.response.hover_pos() {
            let x = self.unplace(0, shown.transform.value_from_position(at).x);
            let frame = ui.ctx().cumulative_frame_nr();
            ui.data_mut(|d| d.insert_temp(self.cursor_id(), (frame, x)));
        }
    }

    fn plot(&self, ui: &mut Ui, theme: &Theme, size: Vec2) -> Shown {
        let mut plot = Plot::new(("chart", &self.title))
            .width(size.x)
            .height(size.y)
            .custom_x_axes(vec![self.axis(0, theme)])
            .custom_y_axes(vec![self.axis(1, theme).min_thickness(48.0)])
            .grid_color(theme.grid)
            .grid_spacing(egui::Rangef::new(5.0, 60.0))
            .show_background(false)
            .allow_double_click_reset(true)
            .set_margin_fraction(Vec2::new(0.0, 0.06))
            .label_formatter(|_| None);
        let scales = self.scales;
        plot = plot.x_grid_spacer(move |input| marks(scales[0], input, size.x / X_APART));
        plot = plot.y_grid_spacer(move |input| marks(scales[1], input, size.y / Y_APART));
        if let Some(group) = self.group {
            let id = egui::Id::unique(("group", group));
            plot = plot.link_axis(id, [true, false]).link_cursor(id, [true, false]);
        }
        let [x, y] = self.range;
        if let Some((low, high)) = x.map(|r| self.limits(0, r)) {
            plot = plot.default_x_bounds(low, high);
        }
        let shown = plot.show(ui, |plot| {
            if let (Some((low, high)), true) = (y.map(|r| self.limits(1, r)), plot.auto_bounds().y) {
                plot.set_plot_bounds_y(low..=high);
            }
            self.draw(plot, theme, size);
        });
        let title = self.title.clone();
        let response = shown.response;
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, format!("plot: {title}")));
        let shown = Shown { transform: shown.transform, response };
        self.note_cursor(ui, &shown);
        shown
    }

    fn axis<'a>(&self, axis: usize, theme: &Theme) -> AxisHints<'a> {
        let hints = if axis == 0 { AxisHints::new_x() } else { AxisHints::new_y() };
        let number = match self.scales[axis] {
            Scale::Linear => plain,
            Scale::Log => power,
        };
        hints
            .label(egui::RichText::new(&self.labels[axis]).small().color(theme.weak))
            .formatter(move |mark, _| number(mark))
            .label_spacing(egui::Rangef::new(1.0, 2.0))
            .tick_label_color(theme.text.gamma_multiply(0.85))
            .tick_label_font(egui::FontId::proportional(11.0))
    }

    fn limits(&self, axis: usize, (low, high): (f64, f64)) -> (f64, f64) {
        (self.place(axis, low), self.place(axis, high))
    }

    /// A value in plot coordinates.
    pub fn place(&self, axis: usize, value: f64) -> f64 {
        if self.scales[axis] == Scale::Log { value.max(f64::MIN_POSITIVE).log10() } else { value }
    }

    /// A place on an axis as a value.
    pub fn unplace(&self, axis: usize, placed: f64) -> f64 {
        if self.scales[axis] == Scale::Log { 10f64.powf(placed) } else { placed }
    }

    fn draw<'a>(&'a self, plot: &mut egui_plot::PlotUi<'a>, theme: &Theme, size: Vec2) {
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
        let seen = if plot.auto_bounds().x {
            all
        } else {
            (self.unplace(0, bounds.min()[0]), self.unplace(0, bounds.max()[0]))
        };
        let per_unit = [f64::from(size.x) / bounds.width(), f64::from(size.y) / bounds.height()];
        for curve in &self.curves {
            let shown = curve.points.shown(seen, size.x as usize);
            let mut points: Vec<[f64; 2]> =
                shown.iter().map(|p| [self.place(0, p[0]), self.place(1, p[1])]).collect();
            let style = match curve.dash {
                Dash::Solid => LineStyle::Solid,
                Dash::Dashed => LineStyle::dashed_dense(),
                Dash::Dotted => LineStyle::dotted_dense(),
            };
            if curve.dash != Dash::Solid && per_unit.iter().all(|v| v.is_finite()) {
                points = corners(&points, per_unit);
            }
            plot.line(
                Line::new(&curve.name, PlotPoints::from(points)).color(curve.colour).width(1.6).style(style),
            );
        }
        self.draw_spots(plot, theme);
        self.draw_marks(plot, theme);
    }

    fn draw_spots<'a>(&'a self, plot: &mut egui_plot::PlotUi<'a>, theme: &Theme) {
        for (at, label) in &self.spots {
            let place = [self.place(0, at[0]), self.place(1, at[1])];
            plot.points(
                egui_plot::Points::new("", vec![place]).color(theme.accent).radius(4.5).allow_hover(false),
            );
            let text = egui::RichText::new(format!("  {label}")).small().color(theme.text);
            let at = PlotPoint::new(place[0], place[1]);
            plot.text(egui_plot::Text::new("", at, text).anchor(egui::Align2::LEFT_BOTTOM));
        }
    }

    fn draw_marks<'a>(&'a self, plot: &mut egui_plot::PlotUi<'a>, theme: &Theme) {
        let bounds = plot.plot_bounds();
        for (x, label) in &self.marks {
            let x = self.place(0, *x);
            plot.vline(
                egui_plot::VLine::new("", x)
                    .color(theme.weak.gamma_multiply(0.7))
                    .width(1.0)
                    .allow_hover(false),
            );
            let top = bounds.min()[1] + 0.94 * (bounds.max()[1] - bounds.min()[1]);
            let text = egui::RichText::new(format!(" {label} ")).small().color(theme.weak);
            let is_right = x > bounds.min()[0] + 0.7 * bounds.width();
            let side = if is_right { egui::Align2::RIGHT_CENTER } else { egui::Align2::LEFT_CENTER };
            plot.text(egui_plot::Text::new("", PlotPoint::new(x, top), text).anchor(side));
        }
    }

    /// The numbers, one point a line: curve, x, y, under the labels of the axes.
    pub fn csv(&self) -> String {
        let [x, y] = self.labels.each_ref().map(|label| quoted(label));
        let mut out = format!("curve,{x},{y}\n");
        for curve in &self.curves {
            let name = quoted(if curve.name.is_empty() { &self.title } else { &curve.name });
            for [x, y] in curve.points.all().iter() {
                let _ = writeln!(out, "{name},{x:e},{y:e}");
            }
        }
        out
    }

    /// The chart as a drawing of its own, on white.
    pub fn svg(&self) -> String {
        crate::picture::drawing(self)
    }
}

/// A cell of CSV.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
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
