//! The consequences of a design as charts: loop, sensitivity, step, control, platform motion, and error against effort.

use counterpoise_pipeline::preview::DesignPreview;
use counterpoise_pipeline::studies::trade_off::EffortPoint;
use counterpoise_verify::{Arrangement, History, Source};

use super::frequency_charts::{frequency_chart, magnitude_points, mark_margins};
use crate::charts::chart::{AxisScale, Chart, LabelledPoint, LineDash};
use crate::design_overlays::OverlaidDesign;
use crate::versioned_results::VersionedResult;
use crate::view::StudioView;

/// Adds the designs that are drawn over the current one to a chart, each in its colour.
pub fn with_overlays(
    view: &StudioView,
    mut chart: Chart,
    points: impl Fn(&DesignPreview) -> Vec<[f64; 2]>,
) -> Chart {
    for OverlaidDesign { name, colour, design } in view.overlaid_designs() {
        chart = chart.with_curve(&name.label(), colour, LineDash::Dotted, points(&design));
    }
    chart
}

/// Returns the loop gain with its margins.
pub fn loop_chart(view: &StudioView, design: &DesignPreview) -> Chart {
    let of = |d: &DesignPreview| magnitude_points(view, &d.curves.frequency_hz, &d.curves.broken);
    let mut chart = with_overlays(view, frequency_chart(view, "Loop gain", "modulus"), of);
    chart = chart.with_curve("L", view.theme.curves[0], LineDash::Solid, of(design));
    chart.levels.push(view.units.display_gain(1.0));
    mark_margins(view, &design.margins, &mut chart);
    chart.range[1] = Some((view.units.display_gain(1e-4), view.units.display_gain(1e4)));
    chart
}

/// Returns the sensitivity S (disturbances) and the complementary sensitivity T (noise).
pub fn sensitivity_chart(view: &StudioView, design: &DesignPreview) -> Chart {
    let of = |k: usize| {
        move |d: &DesignPreview| magnitude_points(view, &d.curves.frequency_hz, &d.curves.sensitivities[k])
    };
    let mut chart = with_overlays(view, frequency_chart(view, "Sensitivity", "modulus"), of(0));
    chart = chart.with_curve("S", view.theme.curves[0], LineDash::Solid, of(0)(design));
    chart = chart.with_curve("T", view.theme.curves[1], LineDash::Dashed, of(1)(design));
    chart.levels.push(view.units.display_gain(design.margins.ms.value));
    chart.range[1] = Some((view.units.display_gain(1e-3), view.units.display_gain(4.0)));
    chart
}

/// Returns a history of what a design controls in the chosen unit.
fn controlled_points(view: &StudioView, of: &DesignPreview, time_s: &[f64], values: &[f64]) -> Vec<[f64; 2]> {
    let factor = view.units.display_unit(of.synthesised.controlled.unit()).factor;
    time_s.iter().zip(values).map(|(t, v)| [*t, factor * v]).collect()
}

fn controlled_chart(view: &StudioView, of: &DesignPreview, title: &str) -> Chart {
    let controlled = of.synthesised.controlled;
    let unit = view.units.display_unit(controlled.unit()).name;
    Chart::new(title, "time, s", &format!("{}, {unit}", controlled.name())).with_group("design")
}

/// Returns the response to a step of the demand.
pub fn step_chart(view: &StudioView, design: &DesignPreview) -> Chart {
    let of = |d: &DesignPreview| controlled_points(view, d, d.step.time_s(), d.step.hub_rate_rad_s());
    let mut chart = with_overlays(view, controlled_chart(view, design, "Step of the demand"), of);
    let demand = controlled_points(view, design, design.step.time_s(), design.step.demand_rad_s());
    chart = chart.with_curve("demand", view.theme.weak, LineDash::Dashed, demand);
    chart.group = None;
    chart.with_curve("hub", view.theme.curves[0], LineDash::Solid, of(design))
}

/// Returns the control about the value that holds the weight of the mechanism.
pub fn control_chart(view: &StudioView, design: &DesignPreview) -> Chart {
    let about = |response: &History| -> Vec<[f64; 2]> {
        let control_v = design.control_about_holding_v(response);
        response.time_s().iter().zip(control_v).map(|(t, v)| [*t, v]).collect()
    };
    let of = |source| design.motion(source, Arrangement::Compensated).map_or(Vec::new(), about);
    let c = &view.theme.curves;
    Chart::new("Control effort", "time, s", "about the holding value, V")
        .with_group("design")
        .with_curve("heave", c[1], LineDash::Dashed, of(Source::Heave))
        .with_curve("pitch", c[2], LineDash::Dotted, of(Source::Pitch))
        .with_curve("step", c[0], LineDash::Solid, about(&design.step))
}

/// Space around the trade-off, as a factor on its limits.
const EFFORT_MARGIN: f64 = 1.25;

/// Returns error against effort over the error weight, with the design itself.
pub fn effort_chart(view: &StudioView, effort: Option<&VersionedResult<Vec<EffortPoint>>>) -> Chart {
    let mut chart =
        Chart::new("Error against effort", "control for unit noise, V s/rad", "residual disturbance");
    chart.scales = [AxisScale::Log; 2];
    let points = effort.map_or(&[][..], |of| &of.value[..]);
    let at = |p: &EffortPoint| [p.figures.noise_gain, p.figures.rejection];
    let mut line: Vec<[f64; 2]> = points.iter().map(at).collect();
    line.sort_by(|a, b| a[0].total_cmp(&b[0]));
    if let Some(now) = points.iter().find(|p| p.factor == 1.0) {
        chart.spots.push(LabelledPoint::new(at(now), "now"));
    }
    for axis in 0..2 {
        let values = line.iter().map(|p| p[axis]);
        let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
        chart.range[axis] = (low < high).then_some((low / EFFORT_MARGIN, high * EFFORT_MARGIN));
    }
    chart.with_curve("over the error weight", view.theme.curves[0], LineDash::Solid, line)
}

/// Returns the response to motion of the platform, with and without the feedforward.
pub fn motion_chart(view: &StudioView, design: &DesignPreview, source: Source) -> Chart {
    let title = if source == Source::Heave { "Heave" } else { "Pitch" };
    let of = |arrangement| {
        move |d: &DesignPreview| {
            let history = d.motion(source, arrangement);
            history.map_or(Vec::new(), |h| controlled_points(view, d, h.time_s(), h.hub_rate_rad_s()))
        }
    };
    let chart = with_overlays(view, controlled_chart(view, design, title), of(Arrangement::Compensated));
    let c = &view.theme.curves;
    chart.with_curve("feedback alone", c[1], LineDash::Dashed, of(Arrangement::Feedback)(design)).with_curve(
        "with feedforward",
        c[0],
        LineDash::Solid,
        of(Arrangement::Compensated)(design),
    )
}
