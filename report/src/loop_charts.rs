//! The loop as Nichols chart, Nyquist chart and root locus, and the responses of the closed loop beside its sensitivities.

use counterpoise_controller::READING_NAMES;
use counterpoise_models::ControlledQuantity;
use counterpoise_pipeline::loop_view::{ChartPoints, LocusView, LoopPlane, LoopView, MarginPoint};
use counterpoise_plot::number::short_number;
use counterpoise_plot::{Axis, Colour, Figure, Mark, Panel, Series};
use counterpoise_verify::Verification;
use counterpoise_verify::linear_loop::MarginKind;
use counterpoise_verify::linear_loop::{LoopCause, LoopEffect, LoopResponse};

use crate::ReportSection;
use crate::bode::{BodeCurve, PhasePanel, bode_figure, response_of};
use crate::wording::capitalise_first;

/// Ends of the Nichols chart's modulus, dB: beyond them nothing is near the critical point.
const NICHOLS_DB: [f64; 2] = [-40.0, 40.0];
/// Ends of the Nyquist chart on each axis.
const NYQUIST: [[f64; 2]; 2] = [[-3.5, 1.5], [-2.5, 2.5]];
/// Damping ratios whose rays are drawn in the root locus.
const DAMPINGS: [f64; 3] = [0.3, 0.5, 0.7];
/// Height of charts of a plane, pixels.
const HEIGHT: f64 = 380.0;

/// Returns the section with the charts of the plane and the responses of the closed loop.
pub fn charts_section(found: &Verification, view: &LoopView) -> ReportSection {
    ReportSection::new("The loop in the complex plane")
        .with_text(
            "The same loop as above. The curve has to pass the critical point, -1 or -180 degrees and 0 dB, outside the outlined region; \
             how far it stays away is what the margins measure.",
        )
        .with_figures([
            nichols_chart(&view.plane),
            nyquist_chart(&view.plane, found.evidence.margins.disk.alpha),
            locus_chart(&view.locus),
        ])
        .with_figures(response_charts(found))
}

fn pairs(points: &ChartPoints) -> impl Iterator<Item = (f64, f64)> + '_ {
    points.iter().map(|[x, y]| (*x, *y))
}

fn outline_name(largest: f64, largest_db: f64) -> String {
    format!("|S| = {} ({} dB)", short_number(largest), short_number(largest_db))
}

/// Margins as rings at the points of a chart.
fn margin_marks(view: &LoopPlane, of: fn(&MarginPoint) -> &ChartPoints) -> Vec<Mark> {
    let marks = view.margins.iter().flat_map(|margin| {
        let (name, unit, colour) = match margin.kind {
            MarginKind::Gain => ("gain margin", "dB", Colour::Second),
            MarginKind::Phase => ("phase margin", "deg", Colour::Third),
        };
        let text = format!(
            "{name} {} {unit} at {} Hz",
            short_number(margin.size),
            short_number(margin.frequency_hz)
        );
        pairs(of(margin)).map(move |(x, y)| Mark::Point { x, y, text: text.clone(), colour })
    });
    marks.collect()
}

/// Returns a cross at the critical point.
fn critical(x: f64) -> Mark {
    Mark::Cross { x, y: 0.0, text: String::new(), colour: Colour::Muted }
}

fn nichols_chart(view: &LoopPlane) -> Figure {
    let series = vec![
        Series::dashed_line(
            &outline_name(view.largest_sensitivity, view.largest_sensitivity_db),
            Colour::Muted,
            pairs(&view.outline.nichols),
        ),
        Series::solid_line("L", Colour::First, pairs(&view.path.nichols)),
    ];
    let mut marks = vec![critical(-180.0)];
    marks.extend(margin_marks(view, |margin| &margin.place.nichols));
    let y = Axis::linear("modulus of L", "dB").with_range(NICHOLS_DB[0], NICHOLS_DB[1]);
    let panel = Panel::new(y, series).with_marks(marks).with_height(HEIGHT);
    Figure::new("Nichols chart", Axis::degrees("phase of L").with_range(-360.0, 0.0), vec![panel])
}

fn nyquist_chart(view: &LoopPlane, disk_margin: f64) -> Figure {
    let outline = outline_name(view.largest_sensitivity, view.largest_sensitivity_db);
    let mut series = vec![
        Series::dotted_line("unit circle", Colour::Muted, pairs(&view.unit.nyquist)),
        Series::dashed_line(&outline, Colour::Muted, pairs(&view.outline.nyquist)),
    ];
    if let Some(disk) = &view.disk {
        let name = format!("disk margin {}", short_number(disk_margin));
        series.push(Series::dashed_line(&name, Colour::Fourth, pairs(&disk.nyquist)));
    }
    let path = &view.path.nyquist;
    series.push(Series::solid_line("L", Colour::First, pairs(path)));
    let mirrored = pairs(path).map(|(x, y)| (x, -y));
    series.push(Series::dashed_line("L at negative frequencies", Colour::Sixth, mirrored));
    let mut marks = vec![critical(-1.0)];
    marks.extend(margin_marks(view, |margin| &margin.place.nyquist));
    let [x, y] = [("real part of L", NYQUIST[0]), ("imaginary part of L", NYQUIST[1])]
        .map(|(name, [from, to])| Axis::linear(name, "").with_range(from, to));
    let panel = Panel::new(y, series).with_marks(marks).with_height(HEIGHT);
    Figure::new("Nyquist chart", x, vec![panel]).with_equal_scales()
}

fn locus_chart(locus: &LocusView) -> Figure {
    let reach = locus.reach_hz;
    let rays = DAMPINGS.iter().map(|damping| {
        let (x, y) = (-2.0 * reach * damping, 2.0 * reach * (1.0 - damping * damping).sqrt());
        Series::dotted_line("damping 0.3, 0.5, 0.7", Colour::Muted, [(x, y), (0.0, 0.0), (x, -y)])
    });
    let branches = locus
        .branches
        .iter()
        .map(|branch| Series::solid_line("poles over the gain", Colour::First, pairs(branch)));
    let crosses = |places: &ChartPoints, name: &str, colour: Colour| -> Vec<Mark> {
        pairs(places).map(|(x, y)| Mark::Cross { x, y, text: name.to_owned(), colour }).collect()
    };
    let mut marks = crosses(&locus.open_poles, "poles of the open loop", Colour::Muted);
    let ring =
        |(x, y)| Mark::Point { x, y, text: "zeros of the open loop".to_owned(), colour: Colour::Third };
    marks.extend(pairs(&locus.open_zeros).map(ring));
    marks.extend(crosses(&locus.closed_poles, "poles of the closed loop", Colour::Second));
    let y = Axis::linear("imaginary part", "Hz").with_range(-reach, reach);
    let panel = Panel::new(y, rays.chain(branches).collect()).with_marks(marks).with_height(HEIGHT);
    let panel = panel.with_instant(0.0, "border of stability");
    let x = Axis::linear("real part", "Hz").with_range(-1.3 * reach, 0.4 * reach);
    Figure::new("Root locus of the sampled loop, at its equivalents in continuous time", x, vec![panel])
        .with_equal_scales()
        .with_caption(
            "The gain of the whole loop goes from 0.01 to 100 times what it is. Each pole and zero z is drawn at ln(z)/T.",
        )
}

/// Returns the responses of the closed loop, those with the same unit in one figure.
fn response_charts(found: &Verification) -> Vec<Figure> {
    let curves = &found.evidence.curves;
    let chart = |title: &str, unit: &str, wanted: &dyn Fn(&LoopResponse) -> bool| {
        let all = curves.loop_responses.iter().filter(|response| wanted(response)).zip(Colour::CYCLE);
        let drawn: Vec<BodeCurve> = all
            .map(|(response, colour)| {
                let name = cause_name(response.cause, found.controlled_quantity());
                let points =
                    curves.frequency_hz.iter().zip(&response.response).map(|(f, h)| [*f, h.re, h.im]);
                BodeCurve::new(response_of(&name, points), colour)
            })
            .collect();
        (!drawn.is_empty()).then(|| bode_figure(title, unit, &drawn, PhasePanel::Hidden, Vec::new()))
    };
    let of =
        |cause: LoopCause, effect: LoopEffect| move |r: &LoopResponse| (r.cause, r.effect) == (cause, effect);
    let drives = |r: &LoopResponse| {
        r.effect == LoopEffect::Control && matches!(r.cause, LoopCause::Demand | LoopCause::Noise(_))
    };
    let name = capitalise_first(found.controlled_quantity().name());
    let all = [
        chart(&format!("{name} for the demand"), "", &of(LoopCause::Demand, LoopEffect::Hub)),
        chart(
            &format!("{name} for a disturbance of the control"),
            &format!("{} per V", found.controlled_quantity().unit()),
            &of(LoopCause::Control, LoopEffect::Hub),
        ),
        chart("Control for the demand and for noise of the sensors", "V per unit", &drives),
    ];
    all.into_iter().flatten().collect()
}

fn cause_name(cause: LoopCause, controlled: ControlledQuantity) -> String {
    match cause {
        LoopCause::Demand => "demand".to_owned(),
        LoopCause::Control => "disturbance of the control".to_owned(),
        LoopCause::Noise(reading) => {
            format!(
                "noise in {}",
                controlled.named_signal(READING_NAMES.get(reading).copied().unwrap_or("a reading"))
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_outline_is_named_by_its_sensitivity() {
        assert_eq!(outline_name(2.0, 20.0 * 2.0f64.log10()), "|S| = 2 (6.021 dB)");
    }
}
