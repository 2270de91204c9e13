//! The limits of requirements in the plots that they concern: shaded regions, whose edges are dragged to change the project.

use std::f64::consts::TAU;

use counterpoise_lti::Margins;
use counterpoise_models::ControlledQuantity;
use counterpoise_report::wording::figures::describe_figure;
use counterpoise_verify::{
    Experiment, History, HistoryColumn, Limit, LoopFigure, PerformanceFigure, Quantity, Requirement, Source,
    StepFigure, Verdict,
};
use egui::{Rect, Ui};

use super::edge_grips::{EdgeGrip, GrippedEdge, show_edge_grip};
use super::requirement_values::RequirementValue;
use super::widgets;
use crate::charts::chart::{BoundTone, Chart, ChartBound, ForbiddenSide, PlotAxis};
use crate::charts::chart_view::ChartResponse;
use crate::command::Command;
use crate::editing::weight_handles::round_to_three_digits;
use crate::number_format::format_short;
use crate::tolerance::SMALLEST_SENSITIVITY_LIMIT;
use crate::units::DisplayUnits;
use crate::view::StudioView;

/// What help says of the grip of a limit.
const GRIP_HELP: &str = "The limit of a requirement; the region on its wrong side is shaded. Drag the grip, or move it by the arrow keys: the limit in the project changes, is judged at once and verified in a moment. Ctrl+Z undoes it.";
/// Factor on each side of a crossing within which the limit of a margin is drawn: a margin is read at one frequency.
const CROSSING_SPAN: f64 = 1.35;
/// Share of the demand within which the response has to stay after the settling time, and that a rise ends below, as in the figures.
const SETTLED_SHARE: f64 = 0.05;
const RISE_SHARES: [f64; 2] = [0.1, 0.9];
/// Share of a run after which its steady state is read, as in the figure.
const STEADY_FROM: f64 = 0.9;
/// Modulus on each side of 1 between which the limit of a crossover is drawn.
const CROSSOVER_SPAN: f64 = 2.0;

/// A plot in which limits are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BoundPlot {
    /// Modulus of the loop gain.
    LoopGain,
    /// Phase of the loop gain.
    LoopPhase,
    /// Both sensitivities.
    Sensitivity,
    /// A disturbance rejection over frequency.
    Rejection(Source),
    /// A column of runs over time.
    History(HistoryColumn),
}

/// The results about which limits are drawn.
#[derive(Clone, Copy)]
pub struct BoundContext<'a> {
    /// Margins of the loop: their limits are drawn at its crossings.
    pub margins: &'a Margins,
    /// The response to a step of the demand.
    pub step: Option<&'a History>,
    /// Value about which the control is drawn, V.
    pub control_origin_v: f64,
    /// What the loop controls.
    pub controlled: ControlledQuantity,
    /// The runs that a plot over time shows.
    pub shown: &'a [Experiment],
}

/// The limit of a requirement in one plot.
#[derive(Debug, Clone, PartialEq)]
pub struct RequirementBound {
    /// The number of the requirement, from 0.
    pub requirement: usize,
    /// The limit as it is drawn.
    pub bound: ChartBound,
    scale: LimitScale,
    /// Smallest limit that the project allows.
    smallest: f64,
}

/// The way from a limit, in the unit of its figure, to its place on an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
enum LimitScale {
    /// Place = factor x limit + offset.
    Affine { factor: f64, offset: f64 },
    /// The limit is a modulus.
    Modulus,
    /// The limit is in dB, times a sign.
    Decibel { sign: f64 },
    /// The limit is in Hz.
    Frequency,
}

impl LimitScale {
    /// Returns the place of a limit on its axis.
    fn place(self, units: &DisplayUnits, limit: f64) -> f64 {
        match self {
            Self::Affine { factor, offset } => factor * limit + offset,
            Self::Modulus => units.display_gain(limit),
            Self::Decibel { sign } => units.display_gain(10f64.powf(sign * limit / 20.0)),
            Self::Frequency => units.display_frequency(TAU * limit),
        }
    }

    /// Returns the limit at a place of its axis.
    fn limit(self, units: &DisplayUnits, place: f64) -> f64 {
        match self {
            Self::Affine { factor, offset } => (place - offset) / factor,
            Self::Modulus => units.gain_from_display(place),
            Self::Decibel { sign } => sign * 20.0 * units.gain_from_display(place).log10(),
            Self::Frequency => units.frequency_from_display(place) / TAU,
        }
    }
}

/// The shape of a limit in a plot.
#[derive(Clone, Copy)]
struct BoundShape {
    axis: PlotAxis,
    scale: LimitScale,
    side: ForbiddenSide,
    span: Option<[f64; 2]>,
}

/// Returns the limits that concern a plot.
pub fn plot_bounds(
    plot: BoundPlot,
    view: &StudioView,
    values: &[RequirementValue],
    context: &BoundContext,
) -> Vec<RequirementBound> {
    let mut found = Vec::new();
    for (requirement, value) in values.iter().enumerate() {
        let asked = &value.requirement;
        for BoundShape { axis, scale, side, span } in shapes(plot, &view.units, asked, context) {
            let bound = ChartBound {
                label: bound_label(view, asked, context.controlled),
                axis,
                at: scale.place(&view.units, asked.limit.value()),
                side,
                span,
                tone: if matches!(value.verdict, Some(Verdict::Fails { .. })) {
                    BoundTone::Broken
                } else {
                    BoundTone::Kept
                },
                is_selected: view.requirement == requirement,
            };
            found.push(RequirementBound { requirement, bound, scale, smallest: smallest_limit(asked) });
        }
    }
    found
}

/// Returns the smallest limit that the project allows for a figure.
fn smallest_limit(requirement: &Requirement) -> f64 {
    match requirement.figure {
        PerformanceFigure::Loop(LoopFigure::MaxSensitivity) => SMALLEST_SENSITIVITY_LIMIT,
        _ => f64::NEG_INFINITY,
    }
}

/// A chart with the limits that concern it.
pub struct BoundedChart {
    /// The chart.
    pub chart: Chart,
    /// The limits.
    pub bounds: Vec<RequirementBound>,
}

impl BoundedChart {
    /// Returns a chart with its limits drawn in it.
    pub fn new(mut chart: Chart, bounds: Vec<RequirementBound>) -> Self {
        chart.bounds = bounds.iter().map(|one| one.bound.clone()).collect();
        Self { chart, bounds }
    }

    /// Shows the chart in a cell; its limits are dragged to the paths of the project's requirements.
    pub fn show(
        &self,
        ui: &mut Ui,
        view: &mut StudioView,
        queue: &mut Vec<Command>,
        place: ChartPlace,
    ) -> ChartResponse {
        let shown = widgets::show_chart(ui, view, queue, place.cell, &self.chart);
        for (index, one) in self.bounds.iter().enumerate() {
            let name = format!("limit: {}", one.bound.label);
            let grip = EdgeGrip { chart: &self.chart, shown: &shown, bound: &one.bound, index, name };
            if let Some(gripped) = show_edge_grip(ui, &view.theme, &grip) {
                take_move(view, queue, one, ShownMove { gripped, paths: place.paths });
            }
        }
        shown
    }
}

/// The place of a chart on its page, and the paths of the limits that are dragged in it.
#[derive(Clone, Copy)]
pub struct ChartPlace<'a> {
    /// The cell.
    pub cell: Rect,
    /// The path of the limit of each requirement; without one a limit cannot be dragged.
    pub paths: &'a [String],
}

fn bound_label(view: &StudioView, requirement: &Requirement, controlled: ControlledQuantity) -> String {
    let unit = view.units.display_unit(requirement.figure.unit(controlled));
    let name = describe_figure(requirement.figure, controlled);
    let value = format_short(unit.factor * requirement.limit.value());
    format!("{name} {} {value} {}", requirement.limit.side(), unit.name).trim_end().to_owned()
}

fn shapes(
    plot: BoundPlot,
    units: &DisplayUnits,
    requirement: &Requirement,
    context: &BoundContext,
) -> Vec<BoundShape> {
    let limit = requirement.limit;
    match (plot, requirement.figure) {
        (
            BoundPlot::LoopGain | BoundPlot::LoopPhase | BoundPlot::Sensitivity,
            PerformanceFigure::Loop(figure),
        ) => loop_shape(plot, units, figure, limit, context).into_iter().collect(),
        (BoundPlot::Rejection(shown), PerformanceFigure::Rejection { source, frequency_hz, .. })
            if shown == source =>
        {
            let span = crossing_range(units.display_frequency(TAU * frequency_hz));
            vec![value_limit(LimitScale::Decibel { sign: 1.0 }, wrong_side(limit), Some(span))]
        }
        (BoundPlot::History(column), PerformanceFigure::Step(_, figure))
            if context.shown.contains(&Experiment::Step) =>
        {
            let factor = units.display_unit(context.controlled.unit()).factor;
            step_shapes(column, StepLimit { figure, limit, factor }, context)
        }
        (BoundPlot::History(column), PerformanceFigure::Disturbance(_, source, arrangement, quantity))
            if context.shown.contains(&Experiment::Disturbance(source, arrangement)) =>
        {
            let factor = units.display_unit(requirement.figure.unit(context.controlled)).factor;
            motion_shapes(column, PeakLimit { quantity, limit, factor }, context)
        }
        _ => Vec::new(),
    }
}

/// Returns the wrong side of a limit whose figure is drawn upwards.
fn wrong_side(limit: Limit) -> ForbiddenSide {
    match limit {
        Limit::AtMost(_) => ForbiddenSide::Larger,
        Limit::AtLeast(_) => ForbiddenSide::Smaller,
    }
}

/// Returns the range about a frequency in which a limit that is read there is drawn.
fn crossing_range(frequency: f64) -> [f64; 2] {
    [frequency / CROSSING_SPAN, frequency * CROSSING_SPAN]
}

fn value_limit(scale: LimitScale, side: ForbiddenSide, span: Option<[f64; 2]>) -> BoundShape {
    BoundShape { axis: PlotAxis::Y, scale, side, span }
}

/// Returns the limit of a figure of the loop in a plot over frequency.
fn loop_shape(
    plot: BoundPlot,
    units: &DisplayUnits,
    figure: LoopFigure,
    limit: Limit,
    context: &BoundContext,
) -> Option<BoundShape> {
    let span = |rate_rad_s: f64| Some(crossing_range(units.display_frequency(rate_rad_s)));
    let is_lower = matches!(limit, Limit::AtLeast(_));
    match (plot, figure) {
        // the loop gain may grow by the margin until it is 1
        (BoundPlot::LoopGain, LoopFigure::GainMargin) if is_lower => {
            let at = context.margins.gain_increase()?.rate_rad_s;
            Some(value_limit(LimitScale::Decibel { sign: -1.0 }, ForbiddenSide::Larger, span(at)))
        }
        (BoundPlot::LoopGain, LoopFigure::GainReductionMargin) if is_lower => {
            let at = context.margins.gain_decrease()?.rate_rad_s;
            Some(value_limit(LimitScale::Decibel { sign: 1.0 }, ForbiddenSide::Smaller, span(at)))
        }
        (BoundPlot::LoopGain, LoopFigure::Crossover) => {
            let span = Some([units.display_gain(CROSSOVER_SPAN.recip()), units.display_gain(CROSSOVER_SPAN)]);
            Some(BoundShape {
                axis: PlotAxis::X,
                scale: LimitScale::Frequency,
                side: wrong_side(limit),
                span,
            })
        }
        (BoundPlot::LoopPhase, LoopFigure::PhaseMargin) if is_lower => {
            let at = context.margins.phase_margin()?.rate_rad_s;
            let scale = LimitScale::Affine { factor: 1.0, offset: -180.0 };
            Some(value_limit(scale, ForbiddenSide::Smaller, span(at)))
        }
        (BoundPlot::Sensitivity, LoopFigure::MaxSensitivity | LoopFigure::MaxComplementary) => {
            Some(value_limit(LimitScale::Modulus, wrong_side(limit), None))
        }
        _ => None,
    }
}

/// The limit of a figure of a step, with the display unit of what the loop controls over its SI unit.
struct StepLimit {
    figure: StepFigure,
    limit: Limit,
    factor: f64,
}

/// Returns the limit of a figure of a step in a plot over time.
fn step_shapes(column: HistoryColumn, asked: StepLimit, context: &BoundContext) -> Vec<BoundShape> {
    let StepLimit { figure, limit, factor } = asked;
    let Limit::AtMost(_) = limit else { return Vec::new() };
    if (column, figure) == (HistoryColumn::Control, StepFigure::ControlPeak) {
        return both_signs(1.0, context.control_origin_v);
    }
    let Some(step) = context.step.filter(|_| column == HistoryColumn::HubRate) else { return Vec::new() };
    let demand = factor * step.demand_rad_s().last().copied().unwrap_or_default();
    // a step downwards would have its limits mirrored; the procedure has none
    if demand <= 0.0 {
        return Vec::new();
    }
    let later = |offset: f64, span: [f64; 2]| BoundShape {
        axis: PlotAxis::X,
        scale: LimitScale::Affine { factor: 1.0, offset },
        side: ForbiddenSide::Larger,
        span: Some(span),
    };
    let percent = |sign: f64| LimitScale::Affine { factor: sign * 0.01 * demand, offset: demand };
    match figure {
        StepFigure::Overshoot => vec![value_limit(percent(1.0), ForbiddenSide::Larger, None)],
        StepFigure::SettlingTime => vec![
            later(0.0, [(1.0 + SETTLED_SHARE) * demand, f64::INFINITY]),
            later(0.0, [f64::NEG_INFINITY, (1.0 - SETTLED_SHARE) * demand]),
        ],
        StepFigure::RiseTime => {
            let begun = |(_, rate): &(&f64, &f64)| factor * **rate >= RISE_SHARES[0] * demand;
            let begin = step.time_s().iter().zip(step.hub_rate_rad_s()).find(begun).map_or(0.0, |(t, _)| *t);
            vec![later(begin, [f64::NEG_INFINITY, RISE_SHARES[1] * demand])]
        }
        StepFigure::PeakTime => vec![later(0.0, [demand, f64::INFINITY])],
        StepFigure::SteadyStateError => {
            let end = step.time_s().last().copied().unwrap_or_default();
            let span = Some([STEADY_FROM * end, end]);
            vec![
                value_limit(percent(1.0), ForbiddenSide::Larger, span),
                value_limit(percent(-1.0), ForbiddenSide::Smaller, span),
            ]
        }
        StepFigure::ControlPeak => Vec::new(),
    }
}

/// The limit of a quantity in motion, with its display unit over its SI unit.
struct PeakLimit {
    quantity: Quantity,
    limit: Limit,
    factor: f64,
}

/// Returns the limit of a peak in a plot over time.
fn motion_shapes(column: HistoryColumn, peak: PeakLimit, context: &BoundContext) -> Vec<BoundShape> {
    let Limit::AtMost(_) = peak.limit else { return Vec::new() };
    match (peak.quantity, column) {
        (Quantity::HubPeak, HistoryColumn::HubRate)
        | (Quantity::TipPeak, HistoryColumn::TipRate)
        | (Quantity::CurrentPeak, HistoryColumn::Current) => both_signs(peak.factor, 0.0),
        (Quantity::ControlPeak, HistoryColumn::Control) => both_signs(peak.factor, context.control_origin_v),
        _ => Vec::new(),
    }
}

/// Returns the two limits of a modulus that is drawn about an origin.
fn both_signs(factor: f64, origin: f64) -> Vec<BoundShape> {
    let scale = |factor| LimitScale::Affine { factor, offset: -origin };
    vec![
        value_limit(scale(factor), ForbiddenSide::Larger, None),
        value_limit(scale(-factor), ForbiddenSide::Smaller, None),
    ]
}

/// Changes the limit of a requirement in the project if its grip was moved, and selects the requirement.
fn take_move(view: &mut StudioView, queue: &mut Vec<Command>, one: &RequirementBound, moved: ShownMove) {
    let ShownMove { gripped: GrippedEdge { response, moved_to }, paths } = moved;
    if response.drag_started() {
        view.gesture += 1;
    }
    if response.clicked() || response.drag_started() || response.gained_focus() {
        view.requirement = one.requirement;
    }
    view.dragging |= response.dragged();
    if response.hovered() || response.has_focus() {
        view.help.note(&one.bound.label, GRIP_HELP);
    }
    if let (Some(place), Some(path)) = (moved_to, paths.get(one.requirement)) {
        let limit = one.scale.limit(&view.units, place).max(one.smallest);
        if limit.is_finite() {
            let (value, gesture) = (round_to_three_digits(limit), Some(view.gesture));
            queue.push(Command::Set { path: path.clone(), value, gesture });
        }
    }
}

/// A grip after a frame, and the paths of the limits.
struct ShownMove<'a> {
    gripped: GrippedEdge,
    paths: &'a [String],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_and_its_place_belong_to_each_other_in_every_unit() {
        let scales = [
            LimitScale::Affine { factor: -3.0, offset: 2.0 },
            LimitScale::Modulus,
            LimitScale::Decibel { sign: -1.0 },
            LimitScale::Frequency,
        ];
        let mut units = DisplayUnits::default();
        for _ in 0..2 {
            for scale in scales {
                let back = scale.limit(&units, scale.place(&units, 1.7));
                assert!((back - 1.7).abs() < 1e-9, "{scale:?} {back}");
            }
            units.toggle_gain();
            units.toggle_frequency();
        }
    }
}
