//! The plot of the weights, with handles that are dragged or moved by arrow keys.

use counterpoise_project::Project;
use counterpoise_project::resolve::synthesis::WeightSource;
use counterpoise_synth::weight::handles::{HandlePosition, WeightHandle, WeightNumber, weight_handles};
use counterpoise_synth::{FeedforwardWeights, Weight};
use egui::{Color32, Ui};

use super::frequency_charts::frequency_chart;
use super::plot_handles::moved_position;
use super::widgets;
use crate::charts::chart::{Chart, LineDash, PlotAxis};
use crate::charts::chart_view::ChartResponse;
use crate::command::Command;
use crate::editing::weight_handles::values_when_moved;
use crate::theme::WindowTheme;
use crate::view::{ControllerPart, StudioView};

/// A weight of the part that is shown.
pub struct PlottedWeight<'a> {
    /// The path of its section in the project file.
    pub path: String,
    /// Name.
    pub name: &'static str,
    /// The weight.
    pub weight: &'a Weight,
    /// The colour of its curve.
    pub colour: Color32,
    /// The stroke of its curve.
    pub dash: LineDash,
}

/// Returns the weights of a part of the controller; empty if the project does not have this part.
pub fn plotted_weights<'a>(
    project: &'a Project,
    part: ControllerPart,
    theme: &WindowTheme,
) -> Vec<PlottedWeight<'a>> {
    let Some(synth) = &project.synth else { return Vec::new() };
    let s = &synth.specification;
    let plotted = |section: &str, name, weight, k: usize| PlottedWeight {
        path: format!("synth.{section}.{name}"),
        name,
        weight,
        colour: theme.curves[k],
        dash: [LineDash::Solid, LineDash::Dashed, LineDash::Dotted][k],
    };
    let feedforward = |section: &'static str, w: &'a Option<FeedforwardWeights>| match w {
        Some(w) => vec![
            plotted(section, "error", &w.error, 0),
            plotted(section, "control", &w.control, 1),
            plotted(section, "generator", &w.generator, 2),
        ],
        None => Vec::new(),
    };
    match part {
        // Weights that are chosen, or replaced by blocks, are not in the file: there is nothing to drag.
        ControllerPart::Feedback if synth.weights == WeightSource::Chosen => Vec::new(),
        ControllerPart::Feedback => {
            vec![
                plotted("feedback", "error", &s.feedback.error, 0),
                plotted("feedback", "control", &s.feedback.control, 1),
            ]
        }
        ControllerPart::Heave => feedforward("heave", &s.heave),
        ControllerPart::Pitch => feedforward("pitch", &s.pitch),
    }
}

/// Lowest and highest frequency of the plot, rad/s.
const FREQUENCIES_RAD_S: (f64, f64) = (0.1, 5000.0);
/// Intervals between the points of a curve.
const INTERVALS: usize = 240;
/// Smallest and largest modulus that is drawn: a weight with an integrator is infinite at 0.
const MODULI: (f64, f64) = (1e-6, 1e8);

/// Shows the weights of the selected part, with their handles.
pub fn show_weight_plot(
    ui: &mut Ui,
    view: &mut StudioView,
    queue: &mut Vec<Command>,
    project: &Project,
    cell: egui::Rect,
) -> ChartResponse {
    let theme = view.theme;
    let weights = plotted_weights(project, view.part, &theme);
    let mut chart = frequency_chart(view, "Weights", "modulus");
    let (low, high) = FREQUENCIES_RAD_S;
    let rate = |k: usize| low * (high / low).powf(k as f64 / INTERVALS as f64);
    for weight in &weights {
        let point = |k| {
            let modulus = weight.weight.magnitude(rate(k)).clamp(MODULI.0, MODULI.1);
            [view.units.display_frequency(rate(k)), view.units.display_gain(modulus)]
        };
        chart =
            chart.with_curve(weight.name, weight.colour, weight.dash, (0..=INTERVALS).map(point).collect());
    }
    chart.range[0] = Some((view.units.display_frequency(low), view.units.display_frequency(high)));
    let shown = widgets::show_chart(ui, view, queue, cell, &chart);
    for weight in &weights {
        for (index, handle) in weight_handles(weight.weight).iter().enumerate() {
            let plotted = PlottedHandle { weight, handle, index, chart: &chart, shown: &shown };
            show_handle(ui, view, queue, &plotted);
        }
    }
    shown
}

/// A handle on its plot.
struct PlottedHandle<'a> {
    weight: &'a PlottedWeight<'a>,
    handle: &'a WeightHandle,
    index: usize,
    chart: &'a Chart,
    shown: &'a ChartResponse,
}

impl PlottedHandle<'_> {
    /// Returns where the handle stands on the screen.
    fn screen_position(&self, view: &StudioView) -> egui::Pos2 {
        let position = self.handle.position;
        let x = view.units.display_frequency(position.rate_rad_s);
        let y = view.units.display_gain(position.magnitude);
        let x = self.chart.plot_coordinate(PlotAxis::X, x);
        let y = self.chart.plot_coordinate(PlotAxis::Y, y);
        self.shown.transform.position_from_point(&egui_plot::PlotPoint::new(x, y))
    }

    /// Returns the frequency and modulus at a place of the screen.
    fn position_at(&self, view: &StudioView, at: egui::Pos2) -> HandlePosition {
        let point = self.shown.transform.value_from_position(at);
        let (x, y) = (self.chart.value_at(PlotAxis::X, point.x), self.chart.value_at(PlotAxis::Y, point.y));
        HandlePosition {
            rate_rad_s: view.units.frequency_from_display(x),
            magnitude: view.units.gain_from_display(y),
        }
    }
}

/// What help says of a handle.
const HANDLE_HELP: &str = "A handle of a weight. Drag it, or move it by the arrow keys: the numbers of the weight change in the project, and every plot follows. One step of undo takes back a whole drag.";
/// Size of the area in which a handle is gripped, points: a finger's width would cover its neighbours.
const GRIP_SIZE: f32 = 22.0;

fn show_handle(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, plotted: &PlottedHandle) {
    let theme = view.theme;
    let at = plotted.screen_position(view);
    if !plotted.shown.transform.frame().expand(6.0).contains(at) {
        return;
    }
    let id = ui.scope_id().with((&plotted.weight.path, plotted.index));
    let grip = egui::Rect::from_center_size(at, egui::Vec2::splat(GRIP_SIZE));
    let response =
        ui.interact(grip, id, egui::Sense::click_and_drag()).on_hover_cursor(egui::CursorIcon::Move);
    let name = format!("{} weight: {}", plotted.weight.name, plotted.handle.name);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, name.clone()));
    let is_active = response.hovered() || response.dragged() || response.has_focus();
    let radius = if is_active { 7.0 } else { 5.5 };
    ui.painter().circle(at, radius, theme.card, egui::Stroke::new(2.5, plotted.weight.colour));
    if response.drag_started() {
        view.gesture += 1;
    }
    let moved = moved_position(ui, &response, at);
    view.dragging |= response.dragged();
    if let Some(to) = moved {
        let position = plotted.position_at(view, to);
        for WeightNumber { key, value } in values_when_moved(plotted.weight.weight, plotted.handle, position)
        {
            let path = format!("{}.{key}", plotted.weight.path);
            queue.push(Command::Set { path, value, gesture: Some(view.gesture) });
        }
    }
    if is_active {
        view.help.note(&name, HANDLE_HELP);
        response.on_hover_text(name);
    }
}
