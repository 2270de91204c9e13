//! The loop as Nichols chart, Nyquist chart and root locus, and the responses of the closed loop beside its sensitivities.

#![allow(non_snake_case)]

use std::f64::consts::TAU;

use counterpoise_controller::READING_NAMES;
use counterpoise_plot::number::short;
use counterpoise_plot::{Axis, Colour, Figure, Mark, Panel, Series};
use counterpoise_verify::linear::loop_shape::nichols;
use counterpoise_verify::linear::root_locus::continuous_equivalent;
use counterpoise_verify::linear::{
    Disk, LoopCause, LoopEffect, LoopResponse, LoopShape, RootLocus, largest_sensitivity,
};
use counterpoise_verify::{C64, Requirement, Verification};

use crate::Section;
use crate::bode::{BodeCurve, Phase, bode};

/// Ends of the Nichols chart's modulus, dB: beyond them nothing is near the critical point.
const NICHOLS_DB: [f64; 2] = [-40.0, 40.0];
/// Ends of the Nyquist chart on each axis.
const NYQUIST: [[f64; 2]; 2] = [[-3.5, 1.5], [-2.5, 2.5]];
/// The root locus is drawn up to this many crossover frequencies from the origin.
const LOCUS_CROSSOVERS: f64 = 5.0;
/// Damping ratios whose rays are drawn in the root locus.
const DAMPINGS: [f64; 3] = [0.3, 0.5, 0.7];
/// Height of charts of a plane, pixels.
const HEIGHT: f64 = 380.0;

/// Returns the section with the charts of the plane and the responses of the closed loop.
pub fn section(found: &Verification, shape: &LoopShape) -> Section {
    let requirements: Vec<Requirement> = found.verdicts.iter().map(|(asked, _)| asked.clone()).collect();
    let largest = largest_sensitivity(&requirements);
    let crossover_hz = found.evidence.margins.phase.iter().map(|p| p.rate_rad_s / TAU).fold(0.0, f64::max);
    Section::new("The loop in the complex plane")
        .saying(
            "The same loop as above. The curve has to pass the critical point, -1 or -180 degrees and 0 dB, outside the outlined region; \
             how far it stays away is what the margins measure.",
        )
        .showing([
            nichols_chart(found, shape, largest),
            nyquist_chart(found, shape, largest),
            locus_chart(&shape.locus, crossover_hz),
        ])
        .showing(response_charts(found))
}

fn outline_name(largest: f64) -> String {
    format!("|S| = {} ({} dB)", short(largest), short(20.0 * largest.log10()))
}

/// Margins with the points of L where they are read.
fn margin_points(found: &Verification) -> Vec<(C64, String, Colour)> {
    let margins = &found.evidence.margins;
    let hz = |rate: f64| short(rate / TAU);
    let gains = [margins.gain_increase(), margins.gain_decrease()].into_iter().flatten();
    let gains = gains.filter(|gain| gain.rate_rad_s > 0.0 && gain.rate_rad_s.is_finite()).map(|gain| {
        let text = format!("gain margin {} dB at {} Hz", short(gain.db), hz(gain.rate_rad_s));
        (C64::new(-1.0 / gain.factor, 0.0), text, Colour::Second)
    });
    let phase = margins.phase_margin().map(|phase| {
        let text = format!("phase margin {} deg at {} Hz", short(phase.deg), hz(phase.rate_rad_s));
        (C64::from_polar(1.0, (phase.deg - 180.0).to_radians()), text, Colour::Third)
    });
    gains.chain(phase).collect()
}

fn nichols_chart(found: &Verification, shape: &LoopShape, largest: f64) -> Figure {
    let path = |points: Vec<[f64; 2]>| points.into_iter().map(|[x, y]| (x, y));
    let edge = nichols(&Disk::of_sensitivity(largest).edge());
    let series = vec![
        Series::dashed(&outline_name(largest), Colour::Muted, path(edge)),
        Series::solid("L", Colour::First, path(shape.path.nichols())),
    ];
    let mut marks = vec![Mark::Cross { x: -180.0, y: 0.0, text: String::new(), colour: Colour::Muted }];
    marks.extend(margin_points(found).into_iter().flat_map(|(L, text, colour)| {
        let at = nichols(&[L]);
        at.into_iter().map(move |[x, y]| Mark::Point { x, y, text: text.clone(), colour })
    }));
    let y = Axis::linear("modulus of L", "dB").over(NICHOLS_DB[0], NICHOLS_DB[1]);
    let panel = Panel::new(y, series).with_marks(marks).with_height(HEIGHT);
    Figure::new("Nichols chart", Axis::degrees("phase of L").over(-360.0, 0.0), vec![panel])
}

fn nyquist_chart(found: &Verification, shape: &LoopShape, largest: f64) -> Figure {
    let plane = |points: &[C64], sign: f64| points.iter().map(|L| (L.re, sign * L.im)).collect::<Vec<_>>();
    let unit = Disk { centre: 0.0, radius: 1.0 };
    let alpha = found.evidence.margins.disk.alpha;
    let mut series = vec![
        Series::dotted("unit circle", Colour::Muted, plane(&unit.edge(), 1.0)),
        Series::dashed(
            &outline_name(largest),
            Colour::Muted,
            plane(&Disk::of_sensitivity(largest).edge(), 1.0),
        ),
    ];
    if let Some(disk) = Disk::of_disk_margin(alpha) {
        let name = format!("disk margin {}", short(alpha));
        series.push(Series::dashed(&name, Colour::Fourth, plane(&disk.edge(), 1.0)));
    }
    let response = &shape.path.response;
    series.push(Series::solid("L", Colour::First, plane(response, 1.0)));
    series.push(Series::dashed("L at negative frequencies", Colour::Sixth, plane(response, -1.0)));
    let mut marks = vec![Mark::Cross { x: -1.0, y: 0.0, text: String::new(), colour: Colour::Muted }];
    let points = margin_points(found).into_iter();
    marks.extend(points.map(|(L, text, colour)| Mark::Point { x: L.re, y: L.im, text, colour }));
    let [x, y] = [("real part of L", NYQUIST[0]), ("imaginary part of L", NYQUIST[1])]
        .map(|(name, [from, to])| Axis::linear(name, "").over(from, to));
    let panel = Panel::new(y, series).with_marks(marks).with_height(HEIGHT);
    Figure::new("Nyquist chart", x, vec![panel]).with_equal_scales()
}

fn locus_chart(locus: &RootLocus, crossover_hz: f64) -> Figure {
    let place = |z: &C64| {
        let s = continuous_equivalent(*z, locus.sample_period_s);
        s.map_or((f64::NAN, f64::NAN), |s| (s.re / TAU, s.im / TAU))
    };
    let farthest = locus.closed_poles.iter().map(&place).filter(|at| at.0.is_finite());
    let reach = if crossover_hz > 0.0 {
        LOCUS_CROSSOVERS * crossover_hz
    } else {
        farthest.map(|(x, y)| x.hypot(y)).fold(0.0, f64::max).max(1.0)
    };
    let rays = DAMPINGS.iter().map(|damping| {
        let (x, y) = (-2.0 * reach * damping, 2.0 * reach * (1.0 - damping * damping).sqrt());
        Series::dotted("damping 0.3, 0.5, 0.7", Colour::Muted, [(x, y), (0.0, 0.0), (x, -y)])
    });
    let branches = locus.branches.iter().map(|branch| {
        Series::solid("poles over the gain", Colour::First, unbroken(branch.iter().map(&place)))
    });
    let mark = |name: &str, colour: Colour| {
        let name = name.to_owned();
        move |(x, y): (f64, f64)| Mark::Cross { x, y, text: name.clone(), colour }
    };
    let ring = |(x, y): (f64, f64)| Mark::Point {
        x,
        y,
        text: "zeros of the open loop".to_owned(),
        colour: Colour::Third,
    };
    let seen = |at: &(f64, f64)| at.0.is_finite();
    let marks =
        locus.open_poles.iter().map(&place).filter(seen).map(mark("poles of the open loop", Colour::Muted));
    let marks = marks.chain(locus.open_zeros.iter().map(&place).filter(seen).map(ring));
    let closed = locus.closed_poles.iter().map(&place).filter(seen);
    let marks = marks.chain(closed.map(mark("poles of the closed loop", Colour::Second)));
    let y = Axis::linear("imaginary part", "Hz").over(-reach, reach);
    let panel = Panel::new(y, rays.chain(branches).collect()).with_marks(marks.collect()).with_height(HEIGHT);
    let panel = panel.with_instant(0.0, "border of stability");
    let x = Axis::linear("real part", "Hz").over(-1.3 * reach, 0.4 * reach);
    Figure::new("Root locus of the sampled loop, at its equivalents in continuous time", x, vec![panel])
        .with_equal_scales()
        .with_caption(
            "The gain of the whole loop goes from 0.01 to 100 times what it is. Each pole and zero z is drawn at ln(z)/T.",
        )
}

/// The points with a break where a branch reaches the negative real axis of the z-plane and its equivalent jumps to the other side.
fn unbroken(points: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut all: Vec<(f64, f64)> = Vec::new();
    for at in points {
        let jumps = all
            .last()
            .is_some_and(|last| last.1 * at.1 < 0.0 && (last.1 - at.1).abs() > 0.5 * scale(*last, at));
        if jumps {
            all.push((f64::NAN, f64::NAN));
        }
        all.push(at);
    }
    all
}

fn scale(a: (f64, f64), b: (f64, f64)) -> f64 {
    a.0.hypot(a.1).max(b.0.hypot(b.1))
}

/// The responses of the closed loop, those with the same unit in one figure.
fn response_charts(found: &Verification) -> Vec<Figure> {
    let curves = &found.evidence.curves;
    let chart = |title: &str, unit: &str, wanted: &dyn Fn(&LoopResponse) -> bool| {
        let all = curves.loop_responses.iter().filter(|response| wanted(response)).zip(Colour::CYCLE);
        let drawn: Vec<BodeCurve> = all
            .map(|(response, colour)| {
                let points =
                    curves.frequency_hz.iter().zip(&response.response).map(|(f, h)| (*f, h.re, h.im));
                BodeCurve::new(&cause_name(response.cause), colour, points.collect())
            })
            .collect();
        (!drawn.is_empty()).then(|| bode(title, unit, &drawn, Phase::Hidden, Vec::new()))
    };
    let of =
        |cause: LoopCause, effect: LoopEffect| move |r: &LoopResponse| (r.cause, r.effect) == (cause, effect);
    let drives = |r: &LoopResponse| {
        r.effect == LoopEffect::Control && matches!(r.cause, LoopCause::Demand | LoopCause::Noise(_))
    };
    let all = [
        chart("Hub for the demand", "", &of(LoopCause::Demand, LoopEffect::Hub)),
        chart(
            "Hub for a disturbance of the control",
            "rad/s per V",
            &of(LoopCause::Control, LoopEffect::Hub),
        ),
        chart("Control for the demand and for noise of the sensors", "V per unit", &drives),
    ];
    all.into_iter().flatten().collect()
}

fn cause_name(cause: LoopCause) -> String {
    match cause {
        LoopCause::Demand => "demand".to_owned(),
        LoopCause::Control => "disturbance of the control".to_owned(),
        LoopCause::Noise(reading) => {
            format!("noise in {}", READING_NAMES.get(reading).copied().unwrap_or("a reading"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn branches_break_where_they_pass_to_the_other_side() {
        let points = unbroken([(-1.0, 3.0), (-1.0, 3.1), (-1.0, -3.1), (-1.0, -3.0)].into_iter());
        assert_eq!(points.len(), 5);
        assert!(points[2].0.is_nan());
        assert_eq!(unbroken([(-4.0, 0.1), (-4.0, -0.1)].into_iter()).len(), 2);
    }

    #[test]
    fn the_outline_is_named_by_its_sensitivity() {
        assert_eq!(outline_name(2.0), "|S| = 2 (6.02 dB)");
    }
}
