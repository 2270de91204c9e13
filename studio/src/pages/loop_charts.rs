//! The tab Loop of the page Design: the loop in the complex plane, and every response of the closed loop.

#![allow(non_snake_case)]

use std::f64::consts::TAU;

use counterpoise_linalg::C64;
use counterpoise_pipeline::preview::DesignPreview;
use counterpoise_report::bode::{BodeCurve, ResponsePoint};
use counterpoise_verify::linear::loop_shape::nichols_points;
use counterpoise_verify::linear::{
    Disk, LOCUS_CROSSOVERS, LoopCause, LoopEffect, LoopResponse, LoopShape, MarginKind, RootLocus,
    largest_sensitivity, margins_on_path,
};
use egui::{Rect, Ui};

use super::design_charts::{loop_chart, sensitivity_chart};
use super::frequency_charts::frequency_chart;
use super::widgets;
use crate::charts::chart::{AxisScale, Chart, LabelledPoint, LineDash};
use crate::command::Command;
use crate::number_format::format_short;
use crate::view::StudioView;

/// Ends of the Nichols chart's modulus, dB.
const NICHOLS_DB: (f64, f64) = (-40.0, 40.0);
/// Ends of the Nyquist chart on each axis.
const NYQUIST: [(f64, f64); 2] = [(-3.0, 1.5), (-2.2, 2.2)];
/// What a cell has beside its plot: margins of the card, heading, numbers and labels of the axes, points.
const CELL_FRAME: [f32; 2] = [78.0, 84.0];

/// Shows the charts. Without `shape` the paths have the points of the other curves, and the root locus follows in a moment.
pub fn show(
    ui: &mut Ui,
    view: &mut StudioView,
    queue: &mut Vec<Command>,
    design: &DesignPreview,
    shape: Option<&LoopShape>,
) {
    let area = widgets::take_remaining_area(ui);
    let cells = widgets::grid_cells(area, 9, 3);
    let response = shape.map_or(&design.curves.broken.response, |shape| &shape.path.response);
    let requirements = design.project.verify.as_ref().map_or(&[][..], |verify| &verify.requirements);
    let largest = largest_sensitivity(requirements);
    let charts = [
        loop_chart(view, design),
        phase_chart(view, design),
        nichols_chart(view, design, response, largest),
        with_equal_scales(nyquist_chart(view, design, response, largest), cells[3]),
        with_equal_scales(
            locus_chart(view, shape.map(|shape| &shape.locus), design.crossover_hz()),
            cells[4],
        ),
        sensitivity_chart(view, design),
        response_chart(
            view,
            design,
            "Hub for the demand",
            &[LoopPath { cause: LoopCause::Demand, effect: LoopEffect::Hub }],
        ),
        response_chart(
            view,
            design,
            "Hub for 1 V on the control",
            &[LoopPath { cause: LoopCause::Control, effect: LoopEffect::Hub }],
        ),
        control_chart(view, design),
    ];
    for (cell, chart) in cells.iter().zip(&charts) {
        widgets::show_chart(ui, view, queue, *cell, chart);
    }
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
        let points = d.curves.frequency_hz.iter().zip(&d.curves.broken.response);
        let curve = BodeCurve::new(
            "",
            counterpoise_plot::Colour::First,
            points.map(|(f, L)| ResponsePoint::new(*f, L.re, L.im)).collect(),
        );
        let phase = curve.phase_deg().into_iter();
        phase.map(|at| [view.units.display_frequency(at.x * TAU), at.y]).collect::<Vec<_>>()
    };
    let mut chart = Chart::new("Loop phase", view.units.frequency_label(), "phase, deg");
    chart.scales = [AxisScale::Log, AxisScale::Linear];
    for (slot, kept) in &view.kept {
        chart = chart.with_curve(slot.name(), view.theme.kept_colour(*slot), LineDash::Dotted, of(kept));
    }
    chart = chart.with_curve("L", view.theme.curves[0], LineDash::Solid, of(design));
    chart.levels.push(-180.0);
    if let Some(margin) = design.margins.phase_margin() {
        let x = view.units.display_frequency(margin.rate_rad_s);
        chart.add_mark(x, format!("{:.0}\u{b0}", margin.deg));
    }
    chart
}

/// A margin as a point of the plane of L, with its size in words.
struct NamedMargin {
    response: C64,
    label: String,
}

fn named_margins(design: &DesignPreview) -> Vec<NamedMargin> {
    let named = margins_on_path(&design.margins).into_iter().map(|margin| {
        let label = match margin.kind {
            MarginKind::Gain => format!("{:.1} dB", margin.size),
            MarginKind::Phase => format!("{:.0}\u{b0}", margin.size),
        };
        NamedMargin { response: margin.response, label }
    });
    named.collect()
}

fn nichols_chart(view: &StudioView, design: &DesignPreview, response: &[C64], largest: f64) -> Chart {
    let mut chart = Chart::new("Nichols", "phase of L, deg", "modulus of L, dB");
    for (slot, kept) in &view.kept {
        let path = nichols_points(&kept.curves.broken.response);
        chart = chart.with_path(slot.name(), view.theme.kept_colour(*slot), LineDash::Dotted, path);
    }
    chart = chart
        .with_path(
            &outline_name(largest),
            view.theme.weak,
            LineDash::Dashed,
            nichols_points(&Disk::of_sensitivity(largest).edge()),
        )
        .with_path("L", view.theme.curves[0], LineDash::Solid, nichols_points(response));
    for NamedMargin { response, label } in named_margins(design) {
        chart.spots.extend(
            nichols_points(&[response]).into_iter().map(|at| LabelledPoint { at, label: label.clone() }),
        );
    }
    chart.levels.push(0.0);
    chart.add_mark(-180.0, "");
    chart.range = [Some((-360.0, 0.0)), Some(NICHOLS_DB)];
    chart
}

fn outline_name(largest: f64) -> String {
    format!("|S| = {}", format_short(largest))
}

fn plane(points: &[C64]) -> Vec<[f64; 2]> {
    points.iter().map(|L| [L.re, L.im]).collect()
}

fn nyquist_chart(view: &StudioView, design: &DesignPreview, response: &[C64], largest: f64) -> Chart {
    let theme = &view.theme;
    let mut chart = Chart::new("Nyquist", "real part of L", "imaginary part of L");
    for (slot, kept) in &view.kept {
        let path = plane(&kept.curves.broken.response);
        chart = chart.with_path(slot.name(), theme.kept_colour(*slot), LineDash::Dotted, path);
    }
    let unit = Disk { centre: 0.0, radius: 1.0 };
    chart = chart.with_path("", theme.weak, LineDash::Dotted, plane(&unit.edge())).with_path(
        &outline_name(largest),
        theme.weak,
        LineDash::Dashed,
        plane(&Disk::of_sensitivity(largest).edge()),
    );
    if let Some(disk) = Disk::of_disk_margin(design.margins.disk.alpha) {
        chart = chart.with_path("disk margin", theme.curves[3], LineDash::Dashed, plane(&disk.edge()));
    }
    chart = chart.with_path("L", theme.curves[0], LineDash::Solid, plane(response));
    for NamedMargin { response, label } in named_margins(design) {
        chart.spots.push(LabelledPoint { at: [response.re, response.im], label });
    }
    chart.spots.push(LabelledPoint { at: [-1.0, 0.0], label: "-1".to_owned() });
    chart.range = NYQUIST.map(Some);
    chart
}

/// Returns the root locus at the equivalents of the poles in continuous time, in the unit of frequencies.
fn locus_chart(view: &StudioView, locus: Option<&RootLocus>, crossover_hz: f64) -> Chart {
    let unit = view.units.frequency_label().replace("frequency, ", "");
    let mut chart =
        Chart::new("Root locus", &format!("real part, {unit}"), &format!("imaginary part, {unit}"));
    let reach = view.units.display_frequency(TAU * LOCUS_CROSSOVERS * crossover_hz.max(0.01));
    chart.range = [Some((-1.2 * reach, 0.3 * reach)), Some((-reach, reach))];
    chart.add_mark(0.0, "");
    let Some(locus) = locus.map(RootLocus::convert_to_continuous) else { return chart };
    let shown = |part: f64| part.signum() * view.units.display_frequency(part.abs());
    let place = |s: &C64| [shown(s.re), shown(s.im)];
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
    for (slot, kept) in &view.kept {
        for response in kept.curves.loop_responses.iter().filter(is_wanted).take(1) {
            let colour = view.theme.kept_colour(*slot);
            chart = chart.with_curve(slot.name(), colour, LineDash::Dotted, moduli(view, kept, response));
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
