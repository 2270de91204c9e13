//! The consequences of a design as charts: loop, sensitivity, step, control, platform motion, and error against effort.

use counterpoise_pipeline::studies::trade_off::EffortPoint;
use counterpoise_verify::linear::Curve as Response;
use counterpoise_verify::{Arrangement, Experiment, History, Source};

use super::design::bode;
use crate::chart::{Chart, Dash, Scale};
use crate::live::Live;
use crate::results::Of;
use crate::view::View;

fn magnitudes(view: &View, frequency_hz: &[f64], response: &Response) -> Vec<[f64; 2]> {
    let point =
        |(f, h): (&f64, &counterpoise_lti::C64)| [view.rate(f * std::f64::consts::TAU), view.level(h.norm())];
    frequency_hz.iter().zip(&response.response).map(point).collect()
}

/// The response to a motion in an arrangement.
pub fn motion(live: &Live, source: Source, arrangement: Arrangement) -> Option<&History> {
    let wanted = Experiment::Disturbance(source, arrangement);
    live.motions.iter().find(|h| h.experiment == wanted)
}

/// Kept designs behind the present one.
fn with_kept(view: &View, mut chart: Chart, points: impl Fn(&Live) -> Vec<[f64; 2]>) -> Chart {
    for (name, kept) in &view.kept {
        chart = chart.curve(name, view.theme.weak.gamma_multiply(0.8), Dash::Dotted, points(kept));
    }
    chart
}

/// The loop gain with its margins.
pub fn loop_chart(view: &View, live: &Live) -> Chart {
    let of = |d: &Live| magnitudes(view, &d.curves.frequency_hz, &d.curves.broken);
    let mut chart = with_kept(view, bode(view, "Loop gain", "modulus"), of);
    chart = chart.curve("L", view.theme.curves[0], Dash::Solid, of(live));
    chart.levels.push(view.level(1.0));
    if let Some(crossing) = live.margins.phase_margin() {
        chart.marks.push((view.rate(crossing.rate_rad_s), format!("{:.0}\u{b0}", crossing.deg)));
    }
    if let Some(gain) = live.margins.gain_increase() {
        chart.marks.push((view.rate(gain.rate_rad_s), format!("{:.1} dB", gain.db)));
    }
    chart.range[1] = Some((view.level(1e-4), view.level(1e4)));
    chart
}

/// What the loop leaves of disturbances, and passes of noise.
pub fn sensitivity_chart(view: &View, live: &Live) -> Chart {
    let of = |k: usize| move |d: &Live| magnitudes(view, &d.curves.frequency_hz, &d.curves.sensitivities[k]);
    let mut chart = with_kept(view, bode(view, "Sensitivity", "modulus"), of(0));
    chart = chart.curve("S", view.theme.curves[0], Dash::Solid, of(0)(live));
    chart = chart.curve("T", view.theme.curves[1], Dash::Dashed, of(1)(live));
    chart.levels.push(view.level(live.margins.ms.value));
    chart.range[1] = Some((view.level(1e-3), view.level(4.0)));
    chart
}

/// A history of rates in the unit that is shown.
fn rates(view: &View, time_s: &[f64], values: &[f64]) -> Vec<[f64; 2]> {
    let factor = view.angular();
    time_s.iter().zip(values).map(|(t, v)| [*t, factor * v]).collect()
}

fn time_chart(view: &View, title: &str) -> Chart {
    Chart::new(title, "time, s", &format!("hub rate, {}", view.angular_rate_unit())).grouped("design")
}

/// The response to a step of the demand.
pub fn step_chart(view: &View, live: &Live) -> Chart {
    let of = |d: &Live| rates(view, &d.step.time_s, &d.step.hub_rate_rad_s);
    let mut chart = with_kept(view, time_chart(view, "Step of the demand"), of);
    let demand = rates(view, &live.step.time_s, &live.step.demand_rad_s);
    chart = chart.curve("demand", view.theme.weak, Dash::Dashed, demand);
    chart.group = None;
    chart.curve("hub", view.theme.curves[0], Dash::Solid, of(live))
}

/// The control about the value that holds the weight.
pub fn control_chart(view: &View, live: &Live) -> Chart {
    let held = live.modelled.linear.equilibrium.control_v;
    let about =
        |h: &History| h.time_s.iter().zip(&h.control_v).map(|(t, v)| [*t, v - held]).collect::<Vec<_>>();
    let of = |source| motion(live, source, Arrangement::Compensated).map_or(Vec::new(), about);
    let c = &view.theme.curves;
    Chart::new("Control effort", "time, s", "about the holding value, V")
        .grouped("design")
        .curve("heave", c[1], Dash::Dashed, of(Source::Heave))
        .curve("pitch", c[2], Dash::Dotted, of(Source::Pitch))
        .curve("step", c[0], Dash::Solid, about(&live.step))
}

/// Room around the trade-off, as a factor.
const EFFORT_MARGIN: f64 = 1.25;

/// Error against effort over the error weight, with the design itself.
pub fn effort_chart(view: &View, effort: Option<&Of<Vec<EffortPoint>>>) -> Chart {
    let mut chart = Chart::new("Error against effort", "control for unit noise, V s/rad", "disturbance left");
    chart.scales = [Scale::Log; 2];
    let points = effort.map_or(&[][..], |of| &of.value[..]);
    let at = |p: &EffortPoint| [p.figures.noise_gain, p.figures.rejection];
    let mut line: Vec<[f64; 2]> = points.iter().map(at).collect();
    line.sort_by(|a, b| a[0].total_cmp(&b[0]));
    if let Some(now) = points.iter().find(|p| p.factor == 1.0) {
        chart.spots.push((at(now), "now".to_owned()));
    }
    for axis in 0..2 {
        let values = line.iter().map(|p| p[axis]);
        let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
        chart.range[axis] = (low < high).then_some((low / EFFORT_MARGIN, high * EFFORT_MARGIN));
    }
    chart.curve("by the error weight", view.theme.curves[0], Dash::Solid, line)
}

/// The response to motion of the platform, with and without the feedforward.
pub fn motion_chart(view: &View, live: &Live, source: Source) -> Chart {
    let title = if source == Source::Heave { "Heave" } else { "Pitch" };
    let of = |arrangement| {
        move |d: &Live| {
            motion(d, source, arrangement).map_or(Vec::new(), |h| rates(view, &h.time_s, &h.hub_rate_rad_s))
        }
    };
    let chart = with_kept(view, time_chart(view, title), of(Arrangement::Compensated));
    let c = &view.theme.curves;
    chart.curve("feedback alone", c[1], Dash::Dashed, of(Arrangement::Feedback)(live)).curve(
        "with feedforward",
        c[0],
        Dash::Solid,
        of(Arrangement::Compensated)(live),
    )
}
