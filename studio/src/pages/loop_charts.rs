//! The tab Loop of the page Design: the loop in the complex plane, and every response of the closed loop.

#![allow(non_snake_case)]

use std::f64::consts::TAU;

use counterpoise_pipeline::loop_view::{
    ChartPoints, LocusView, LoopPlane, LoopView, MarginPoint, PlaneCurve,
};
use counterpoise_pipeline::preview::DesignPreview;
use counterpoise_verify::linear_loop::{
    Disk, LOCUS_CROSSOVERS, LoopCause, LoopEffect, LoopResponse, MarginKind,
};
use egui::{Rect, Ui};

use super::design_charts::{loop_chart, sensitivity_chart, with_overlays};
use super::frequency_charts::frequency_chart;
use super::plot_tiles::{self, TileRequest};
use super::requirement_bounds::{BoundContext, BoundPlot, BoundedChart, ChartPlace, plot_bounds};
use super::requirement_values::Requirements;
use crate::charts::chart::{AxisScale, Chart, LabelledPoint, LineDash};
use crate::command::Command;
use crate::design_overlays::OverlaidDesign;
use crate::number_format::format_short;
use crate::tile_layout::TilePlace;
use crate::view::StudioView;

/// Ends of the Nichols chart's modulus, dB.
const NICHOLS_DB: (f64, f64) = (-40.0, 40.0);
/// Ends of the Nyquist chart on each axis.
const NYQUIST: [(f64, f64); 2] = [(-3.0, 1.5), (-2.2, 2.2)];
/// Height of a cell beside its plot: margins of the card, heading, numbers and labels of the axes, points.
const CELL_FRAME: [f32; 2] = [78.0, 84.0];

/// What the charts show.
#[derive(Clone, Copy)]
pub struct LoopCharts<'a> {
    /// The design.
    pub design: &'a DesignPreview,
    /// The loop in detail; without it the paths have the points of the other curves, and the root locus follows in a moment.
    pub loop_view: Option<&'a LoopView>,
    /// The requirements, whose limits are drawn.
    pub requirements: &'a Requirements,
}

/// Shows the charts.
pub fn show(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, of: LoopCharts) {
    let draw = &mut |ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, tile: TileRequest| {
        let chart = tile_chart(view, &of, &tile)?;
        let place = ChartPlace { cell: tile.cell, paths: &of.requirements.paths };
        Some(chart.show(ui, view, queue, place))
    };
    plot_tiles::show(ui, view, queue, TilePlace::Loop, draw);
}

/// Returns the chart of a tile.
fn tile_chart(view: &StudioView, of: &LoopCharts, tile: &TileRequest) -> Option<BoundedChart> {
    let LoopCharts { design, loop_view, requirements } = *of;
    let plane = loop_view.map_or(&design.plane, |view| &view.plane);
    let locus = loop_view.map(|view| &view.locus);
    let context = BoundContext {
        margins: &design.margins,
        step: None,
        control_origin_v: 0.0,
        controlled: design.synthesised.controlled,
        shown: &[],
    };
    let bounded =
        |chart, plot| BoundedChart::new(chart, plot_bounds(plot, view, &requirements.values, &context));
    let free = |chart| BoundedChart::new(chart, Vec::new());
    let equal = |chart| free(with_equal_scales(chart, tile.cell));
    let path = |cause| [LoopPath { cause, effect: LoopEffect::Hub }];
    Some(match tile.key {
        "loop-gain" => bounded(loop_chart(view, design), BoundPlot::LoopGain),
        "loop-phase" => bounded(phase_chart(view, design), BoundPlot::LoopPhase),
        "nichols" => free(nichols_chart(view, plane)),
        "nyquist" => equal(nyquist_chart(view, plane)),
        "root-locus" => equal(locus_chart(view, locus, design.crossover_hz())),
        "sensitivity" => bounded(sensitivity_chart(view, design), BoundPlot::Sensitivity),
        "hub-for-demand" => {
            free(response_chart(view, design, "Hub for the demand", &path(LoopCause::Demand)))
        }
        "hub-for-control" => {
            free(response_chart(view, design, "Hub for 1 V on the control", &path(LoopCause::Control)))
        }
        "control-for-noise" => free(control_chart(view, design)),
        _ => return None,
    })
}

/// Widens one range of the chart so that a unit is as long on one axis as on the other.
fn with_equal_scales(mut chart: Chart, cell: Rect) -> Chart {
    let pixels =
        [cell.width() - CELL_FRAME[0], cell.height() - CELL_FRAME[1]].map(|p| f64::from(p.max(40.0)));
    let [Some(x), Some(y)] = chart.range else { return chart };
    let unit = ((x.1 - x.0) / pixels[0]).max((y.1 - y.0) / pixels[1]);
    let widened = |(low, high): (f64, f64), pixels: f64| {
        let (middle, half) = (0.5 * (low + high), 0.5 * unit * pixels);
        Some((middle - half, middle + half))
    };
    chart.range = [widened(x, pixels[0]), widened(y, pixels[1])];
    chart
}

/// Returns the phase of the loop, with the phase margin.
fn phase_chart(view: &StudioView, design: &DesignPreview) -> Chart {
    let of = |d: &DesignPreview| {
        let phase = d.loop_response.phase_deg().into_iter();
        phase.map(|[hz, deg]| [view.units.display_frequency(hz * TAU), deg]).collect::<Vec<_>>()
    };
    let mut chart = Chart::new("Loop phase", view.units.frequency_label(), "phase, deg");
    chart.scales = [AxisScale::Log, AxisScale::Linear];
    chart = with_overlays(view, chart, of);
    chart = chart.with_curve("L", view.theme.curves[0], LineDash::Solid, of(design));
    chart.levels.push(-180.0);
    if let Some(margin) = design.margins.phase_margin() {
        let x = view.units.display_frequency(margin.rate_rad_s);
        chart.add_mark(x, format!("{:.0}\u{b0}", margin.deg));
    }
    chart
}

/// Returns the margins as points of a chart, with their sizes in words.
fn label_margins(plane: &LoopPlane, of: fn(&PlaneCurve) -> &ChartPoints) -> Vec<LabelledPoint> {
    let label = |margin: &MarginPoint| match margin.kind {
        MarginKind::Gain => format!("{:.1} dB", margin.size),
        MarginKind::Phase => format!("{:.0}\u{b0}", margin.size),
    };
    let points = plane
        .margins
        .iter()
        .flat_map(|margin| of(&margin.place).iter().map(move |at| LabelledPoint::new(*at, label(margin))));
    points.collect()
}

fn nichols_chart(view: &StudioView, plane: &LoopPlane) -> Chart {
    let mut chart = Chart::new("Nichols", "phase of L, deg", "modulus of L, dB");
    for OverlaidDesign { name, colour, design } in view.overlaid_designs() {
        chart = chart.with_path(&name.label(), colour, LineDash::Dotted, design.plane.path.nichols.clone());
    }
    chart = chart
        .with_path(&outline_name(plane), view.theme.weak, LineDash::Dashed, plane.outline.nichols.clone())
        .with_path("L", view.theme.curves[0], LineDash::Solid, plane.path.nichols.clone());
    chart.spots.extend(label_margins(plane, |curve| &curve.nichols));
    chart.levels.push(0.0);
    chart.add_mark(-180.0, "");
    chart.range = [Some((-360.0, 0.0)), Some(NICHOLS_DB)];
    chart
}

fn outline_name(plane: &LoopPlane) -> String {
    format!("|S| = {}", format_short(plane.largest_sensitivity))
}

fn nyquist_chart(view: &StudioView, plane: &LoopPlane) -> Chart {
    let theme = &view.theme;
    let mut chart = Chart::new("Nyquist", "real part of L", "imaginary part of L");
    for OverlaidDesign { name, colour, design } in view.overlaid_designs() {
        chart = chart.with_path(&name.label(), colour, LineDash::Dotted, design.plane.path.nyquist.clone());
    }
    chart = chart.with_path("", theme.weak, LineDash::Dotted, plane.unit.nyquist.clone()).with_path(
        &outline_name(plane),
        theme.weak,
        LineDash::Dashed,
        plane.outline.nyquist.clone(),
    );
    if let Some(disk) = &plane.disk {
        chart = chart.with_path("disk margin", theme.curves[3], LineDash::Dashed, disk.nyquist.clone());
    }
    chart = chart.with_path("L", theme.curves[0], LineDash::Solid, plane.path.nyquist.clone());
    chart.spots.extend(label_margins(plane, |curve| &curve.nyquist));
    chart.spots.push(LabelledPoint::new([-1.0, 0.0], "-1"));
    chart.range = NYQUIST.map(Some);
    chart
}

/// Returns the root locus at the equivalents of the poles in continuous time, in the unit of frequencies.
fn locus_chart(view: &StudioView, locus: Option<&LocusView>, crossover_hz: f64) -> Chart {
    let unit = view.units.frequency_label().replace("frequency, ", "");
    let mut chart =
        Chart::new("Root locus", &format!("real part, {unit}"), &format!("imaginary part, {unit}"));
    let reach = view.units.display_frequency(TAU * LOCUS_CROSSOVERS * crossover_hz.max(0.01));
    chart.range = [Some((-1.2 * reach, 0.3 * reach)), Some((-reach, reach))];
    chart.add_mark(0.0, "");
    let Some(locus) = locus else { return chart };
    let shown = |hz: f64| hz.signum() * view.units.display_frequency(TAU * hz.abs());
    let place = |at: &[f64; 2]| at.map(shown);
    for branch in &locus.branches {
        let path = branch.iter().map(&place).collect();
        chart = chart.with_path("", view.theme.curves[0], LineDash::Solid, path);
    }
    let reached = |at: &[f64; 2]| at.iter().all(|part| part.abs() < 4.0 * reach);
    let size = 0.035 * reach;
    for pole in locus.closed_poles.iter().map(&place).filter(reached) {
        chart = chart.with_path("", view.theme.curves[1], LineDash::Solid, cross(pole, size));
    }
    for pole in locus.open_poles.iter().map(&place).filter(reached) {
        chart = chart.with_path("", view.theme.weak, LineDash::Solid, cross(pole, size));
    }
    for zero in locus.open_zeros.iter().map(&place).filter(reached) {
        let ring = Disk { centre: 0.0, radius: size }.edge();
        let path = ring.iter().map(|corner| [zero[0] + corner.re, zero[1] + corner.im]).collect();
        chart = chart.with_path("", view.theme.curves[2], LineDash::Solid, path);
    }
    let legend = [("poles", 1), ("zeros", 2), ("over the gain", 0)];
    for (name, k) in legend {
        chart = chart.with_path(name, view.theme.curves[k], LineDash::Solid, Vec::new());
    }
    chart
}

/// Returns a cross about a point as one path.
fn cross([x, y]: [f64; 2], size: f64) -> Vec<[f64; 2]> {
    vec![
        [x - size, y - size],
        [x + size, y + size],
        [f64::NAN; 2],
        [x - size, y + size],
        [x + size, y - size],
    ]
}

/// A path through the closed loop: from where a signal enters to what it acts on.
#[derive(Clone, Copy, PartialEq)]
struct LoopPath {
    cause: LoopCause,
    effect: LoopEffect,
}

/// Returns responses of the closed loop.
fn response_chart(view: &StudioView, design: &DesignPreview, title: &str, wanted: &[LoopPath]) -> Chart {
    let is_wanted = |r: &&LoopResponse| wanted.contains(&LoopPath { cause: r.cause, effect: r.effect });
    let mut chart = frequency_chart(view, title, "modulus");
    for OverlaidDesign { name, colour, design: kept } in view.overlaid_designs() {
        for response in kept.curves.loop_responses.iter().filter(is_wanted).take(1) {
            let points = moduli(view, &kept, response);
            chart = chart.with_curve(&name.label(), colour, LineDash::Dotted, points);
        }
    }
    let found = design.curves.loop_responses.iter().filter(is_wanted).zip(view.theme.curves.iter().cycle());
    for (response, colour) in found {
        let points = moduli(view, design, response);
        chart = chart.with_curve(cause_name(response.cause), *colour, LineDash::Solid, points);
    }
    chart
}

/// Returns the control for the demand and for noise of every sensor that the feedback reads.
fn control_chart(view: &StudioView, design: &DesignPreview) -> Chart {
    let causes = design.curves.loop_responses.iter().filter(|r| r.effect == LoopEffect::Control);
    let wanted: Vec<LoopPath> = causes.map(|r| LoopPath { cause: r.cause, effect: r.effect }).collect();
    response_chart(view, design, "Control for demand and noise", &wanted)
}

fn moduli(view: &StudioView, design: &DesignPreview, response: &LoopResponse) -> Vec<[f64; 2]> {
    let points = design.curves.frequency_hz.iter().zip(&response.response);
    points.map(|(f, h)| [view.units.display_frequency(f * TAU), view.units.display_gain(h.norm())]).collect()
}

fn cause_name(cause: LoopCause) -> &'static str {
    match cause {
        LoopCause::Demand => "demand",
        LoopCause::Control => "disturbance",
        LoopCause::Noise(_) => "noise",
    }
}
