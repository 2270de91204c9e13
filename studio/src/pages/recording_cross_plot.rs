//! The tab X-Y of the page Diagnose: one channel of a recording against another, as measured and as simulated, over a window of time.
//!
//! Friction shows as a loop of torque over rate, backlash as a gap of position, a sensor's error as a line that is not straight.

use std::sync::Arc;

use egui::{RichText, Ui};

use super::edge_grips::{EdgeGrip, GrippedEdge, show_edge_grip};
use super::recording_charts::{channel_words, signal_chart};
use super::widgets;
use crate::charts::chart::{BoundTone, Chart, ChartBound, ForbiddenSide, LabelledPoint, LineDash, PlotAxis};
use crate::charts::chart_view::cursor_position;
use crate::charts::cross_plot::{pair_samples, thin_path};
use crate::charts::min_max_pyramid::MinMaxPyramid;
use crate::command::Command;
use crate::editing::weight_handles::round_to_three_digits;
use crate::jobs::recording_views::{ChannelView, RecordingView, SimulatedView};
use crate::number_format::format_short;
use crate::theme::space;
use crate::tolerance::SHORTEST_WINDOW_SHARE;
use crate::view::{CrossPlotPaths, StudioView};

/// Share of the area that the plot over time takes.
const TIME_SHARE: f32 = 0.3;
/// Points of a path: more would be drawn slower than a frame.
const PATH_POINTS: usize = 8000;

/// Shows the tab.
pub fn show(
    ui: &mut Ui,
    view: &mut StudioView,
    queue: &mut Vec<Command>,
    recording: &RecordingView,
    revision: u64,
) {
    let Some([x, y]) = chosen_channels(view, recording) else {
        let text = "the recording has no two channels to draw against each other";
        return widgets::show_placeholder(ui, &view.theme, "Nothing to compare", text);
    };
    let whole = time_range(&y.measured);
    let window_s =
        view.cross_plot.window_s.map_or(whole, |[from, to]| [from.max(whole[0]), to.min(whole[1])]);
    let window_s = if window_s[0] < window_s[1] { window_s } else { whole };
    let shown = ShownChannels { x, y, whole, window_s };
    show_choices(ui, view, queue, recording, &shown);
    let area = widgets::take_remaining_area(ui);
    let (mut top, mut bottom) = (area, area);
    top.max.y = area.top() + TIME_SHARE * area.height();
    bottom.min.y = top.max.y + space::MEDIUM;
    show_window(ui, view, queue, &shown, top);
    let time = cursor_position(ui, &signal_chart(view, y));
    let chart = cross_chart(view, &shown, &format!("{} {revision}", recording.name), time);
    widgets::show_chart(ui, view, queue, bottom, &chart);
}

/// The channels that are drawn against each other, and the window of time.
struct ShownChannels<'a> {
    x: &'a ChannelView,
    y: &'a ChannelView,
    whole: [f64; 2],
    window_s: [f64; 2],
}

fn time_range(samples: &MinMaxPyramid) -> [f64; 2] {
    let at = |sample: Option<&[f64; 2]>| sample.map_or(0.0, |sample| sample[0]);
    [at(samples.points().first()), at(samples.points().last())]
}

/// Returns the chosen channels; without a choice what is simulated against what drives the mechanism.
fn chosen_channels<'a>(view: &StudioView, recording: &'a RecordingView) -> Option<[&'a ChannelView; 2]> {
    let named = |name: &str| recording.channels.iter().find(|one| one.channel.name() == name);
    let answers = |one: &&ChannelView| one.model.is_some() && one.channel.name() != "control";
    let simulated = recording.channels.iter().find(answers);
    let x = named(&view.cross_plot.x).or(simulated).or(recording.channels.first())?;
    let other = |one: &&ChannelView| one.channel != x.channel;
    let y = named(&view.cross_plot.y)
        .or(named("control").filter(other))
        .or(recording.channels.iter().find(other))?;
    Some([x, y])
}

/// Shows the fields in which the channels are chosen, and the window.
fn show_choices(
    ui: &mut Ui,
    view: &StudioView,
    queue: &mut Vec<Command>,
    recording: &RecordingView,
    shown: &ShownChannels,
) {
    let names = [shown.x, shown.y].map(|one| one.channel.name().to_owned());
    let choose = |[x, y]: [String; 2], window_s| Command::SetCrossPlot { x, y, window_s };
    ui.horizontal(|ui| {
        for (k, axis) in ["horizontal", "vertical"].into_iter().enumerate() {
            let label = ui.label(RichText::new(axis).color(view.theme.weak));
            let shown_name = names[k].replace('_', " ");
            let combo =
                egui::ComboBox::from_id_salt(("cross plot", k)).selected_text(shown_name).width(150.0);
            let inside = combo.show_ui(ui, |ui| {
                for one in &recording.channels {
                    let name = one.channel.name();
                    if ui.selectable_label(names[k] == name, channel_words(one.channel)).clicked() {
                        let mut chosen = names.clone();
                        chosen[k] = name.to_owned();
                        queue.push(choose(chosen, view.cross_plot.window_s));
                    }
                }
            });
            let response = inside.response.labelled_by(label.id);
            response.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::ComboBox, true, format!("{axis} channel"))
            });
        }
        if ui.button("Swap").clicked() {
            let [x, y] = names.clone();
            queue.push(choose([y, x], view.cross_plot.window_s));
        }
        ui.add_space(space::LARGE);
        let [from, to] = shown.window_s.map(format_short);
        ui.label(RichText::new(format!("from {from} s to {to} s")).color(view.theme.weak));
        if view.cross_plot.window_s.is_some() && ui.button("Whole recording").clicked() {
            queue.push(choose(names.clone(), None));
        }
    });
}

/// Shows the vertical channel over time with the two edges of the window.
fn show_window(
    ui: &mut Ui,
    view: &mut StudioView,
    queue: &mut Vec<Command>,
    shown: &ShownChannels,
    cell: egui::Rect,
) {
    let mut chart = signal_chart(view, shown.y);
    let edge = |at, side| ChartBound {
        label: String::new(),
        axis: PlotAxis::X,
        at,
        side,
        span: None,
        tone: BoundTone::Outside,
        is_selected: false,
    };
    chart.bounds =
        vec![edge(shown.window_s[0], ForbiddenSide::Smaller), edge(shown.window_s[1], ForbiddenSide::Larger)];
    let response = widgets::show_chart(ui, view, queue, cell, &chart);
    for (index, name) in ["start of the window", "end of the window"].into_iter().enumerate() {
        let bound = &chart.bounds[index];
        let grip = EdgeGrip { chart: &chart, shown: &response, bound, index, name: name.to_owned() };
        let Some(GrippedEdge { response, moved_to }) = show_edge_grip(ui, &view.theme, &grip) else {
            continue;
        };
        view.dragging |= response.dragged();
        if let Some(to) = moved_to {
            let mut window_s = shown.window_s;
            window_s[index] = moved_edge(shown, index, to);
            let [x, y] = [shown.x, shown.y].map(|one| one.channel.name().to_owned());
            queue.push(Command::SetCrossPlot { x, y, window_s: Some(window_s) });
        }
    }
}

/// Returns the place of an edge that is moved, inside the recording and on its side of the other edge.
fn moved_edge(shown: &ShownChannels, index: usize, to: f64) -> f64 {
    let shortest = SHORTEST_WINDOW_SHARE * (shown.whole[1] - shown.whole[0]);
    let to = round_to_three_digits(to);
    if index == 0 {
        to.max(shown.whole[0]).min(shown.window_s[1] - shortest)
    } else {
        to.min(shown.whole[1]).max(shown.window_s[0] + shortest)
    }
}

/// Returns the chart of one channel against the other, with a point at the time under the cursor.
fn cross_chart(view: &mut StudioView, shown: &ShownChannels, source: &str, time: Option<f64>) -> Chart {
    let units = [shown.x, shown.y].map(|one| view.units.display_unit(one.channel.unit()));
    let names = [shown.x, shown.y].map(|one| channel_words(one.channel));
    let label = |k: usize| format!("{}, {}", names[k], units[k].name);
    let title = format!("{} against {}", names[1], names[0]);
    let key = format!("{source} {title} {:?}", shown.window_s);
    let paths = match &view.cross_plot.paths {
        Some(kept) if kept.key == key => Arc::clone(kept),
        _ => Arc::new(paths_of(shown, key)),
    };
    view.cross_plot.paths = Some(Arc::clone(&paths));
    let scaled = |points: &[[f64; 2]]| {
        points.iter().map(|[x, y]| [units[0].factor * x, units[1].factor * y]).collect::<Vec<_>>()
    };
    let c = &view.theme.curves;
    let mut chart = Chart::new(&title, &label(0), &label(1));
    chart = chart.with_path("measured", c[1], LineDash::Solid, scaled(&paths.measured));
    if let Some(model) = &paths.model {
        chart = chart.with_path("model", c[0], LineDash::Solid, scaled(model));
    }
    if let Some(improved) = &paths.improved {
        chart = chart.with_path("with the diagnosis", c[2], LineDash::Solid, scaled(improved));
    }
    if let Some(at) = time.and_then(|time| sample_at(shown, time)) {
        let at = [units[0].factor * at[0], units[1].factor * at[1]];
        let label = time.map_or(String::new(), |t| format!("{} s", format_short(t)));
        chart.spots.push(LabelledPoint::new(at, label));
    }
    chart
}

/// Returns the measured values at the first sample from a time on.
fn sample_at(shown: &ShownChannels, time: f64) -> Option<[f64; 2]> {
    let value = |samples: &MinMaxPyramid| {
        let points = samples.points();
        points.get(points.partition_point(|point| point[0] < time)).map(|point| point[1])
    };
    Some([value(&shown.x.measured)?, value(&shown.y.measured)?])
}

/// Returns the paths; a channel that a model does not simulate, because it drives the mechanism, is taken as measured.
fn paths_of(shown: &ShownChannels, key: String) -> CrossPlotPaths {
    let path = |x: &MinMaxPyramid, y: &MinMaxPyramid| {
        thin_path(pair_samples(x.points(), y.points(), shown.window_s), PATH_POINTS)
    };
    let simulated = |of: fn(&ChannelView) -> Option<&SimulatedView>| {
        let signal = |channel: &'_ ChannelView| {
            of(channel).map_or(Arc::clone(&channel.measured), |view| Arc::clone(&view.signal))
        };
        let has_any = of(shown.x).is_some() || of(shown.y).is_some();
        has_any.then(|| path(&signal(shown.x), &signal(shown.y)))
    };
    CrossPlotPaths {
        measured: path(&shown.x.measured, &shown.y.measured),
        model: simulated(|channel| channel.model.as_ref()),
        improved: simulated(|channel| channel.improved.as_ref()),
        key,
    }
}
