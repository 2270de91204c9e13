//! Claims on how a loop is drawn and measured: Nyquist and Nichols charts, and the open loop measured in closed loop.

use counterpoise_controller::Controller;
use counterpoise_linalg::C64;
use counterpoise_models::plant::Plant;
use counterpoise_plot::{Axis, Figure as Drawing, Point};
use counterpoise_simulate::fra::{Settings, Test, TestSine, measure_point};
use counterpoise_verify::linear_loop::ResponseCurve as Response;
use counterpoise_verify::{LoopFigure, PerformanceFigure};

use super::drawing::{ClaimCurve, frequency_axis, make_figure, make_panel};
use super::{Claim, Criterion, TestedDesign};
use counterpoise_pipeline::PipelineError;

/// Gains that are drawn on the Nichols chart, dB, and distances on the Nyquist chart.
const NICHOLS_DB: f64 = 40.0;
const NYQUIST: f64 = 3.0;

/// Returns row C28: the loop on Nyquist and Nichols charts.
///
/// # Errors
/// None beyond the tested design's.
pub fn nyquist_and_nichols(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let evidence = &tested.designed.verified.verification().evidence;
    let loop_gain: &Response = &evidence.curves.broken;
    let one = C64::new(1.0, 0.0);
    let nearest = loop_gain.response.iter().map(|h| (one + h).norm()).fold(f64::INFINITY, f64::min);
    let closed = loop_gain.response.iter().map(|h| (h / (one + h)).norm()).fold(0.0, f64::max);
    let value = |figure| tested.value(PerformanceFigure::Loop(figure));
    let (ms, mt) = (value(LoopFigure::MaxSensitivity), value(LoopFigure::MaxComplementary));
    Ok(Claim {
        id: "C28",
        title: "Nyquist and Nichols",
        source: "5.2.9",
        says: "the loop is judged on Nyquist and Nichols charts: its distance from -1, and the largest closed-loop gain",
        measured: format!(
            "nearest to -1: {nearest:.3} (1/Ms {:.3}); largest closed-loop gain {:.2} dB (Mt {:.2} dB)",
            1.0 / ms,
            20.0 * closed.log10(),
            20.0 * mt.log10()
        ),
        criteria: vec![
            Criterion::at_least(
                "distance of the loop from -1",
                "0.5 (a gain margin of 6 dB)",
                nearest,
                0.5,
                "the usual circle of Ms = 2",
            ),
            Criterion::with_range(
                "distance read from the curve over 1/Ms",
                "the same loop",
                nearest * ms,
                [0.99, 1.01],
                "the curve has 700 points",
            ),
            Criterion::with_range(
                "closed-loop peak read from the curve over Mt",
                "the same loop",
                closed / mt,
                [0.99, 1.01],
                "the curve has 700 points",
            ),
            Criterion::at_most(
                "largest closed-loop gain, dB",
                "13 % of overshoot",
                20.0 * closed.log10(),
                3.0,
                "a second-order loop with 13 % of overshoot peaks by 1 dB; sensors and delay may add 2",
            ),
        ],
        why: String::new(),
        drawings: charts(loop_gain),
    })
}

fn charts(loop_gain: &Response) -> Vec<Drawing> {
    let near =
        loop_gain.response.iter().filter(|h| h.norm() < NYQUIST).map(|h| Point::new(h.re, h.im)).collect();
    let circle = (0..=120).map(|k| {
        let angle = f64::from(k) * std::f64::consts::TAU / 120.0;
        (-1.0 + 0.5 * angle.cos(), 0.5 * angle.sin())
    });
    let nyquist = vec![
        ClaimCurve::line("loop", near),
        ClaimCurve::reference("Ms = 2", circle.map(Point::from).collect()),
    ];
    let db = |h: &C64| 20.0 * h.norm().log10();
    let mut before: Option<f64> = None;
    // without jumps of a whole turn, from between -360 and 0 degrees on
    let mut phase = |h: &C64| {
        let raw = h.arg().to_degrees();
        let start = if raw > 0.0 { raw - 360.0 } else { raw };
        let unwrapped = before.map_or(start, |last| raw + 360.0 * ((last - raw) / 360.0).round());
        before = Some(unwrapped);
        unwrapped
    };
    let within = loop_gain.response.iter().filter(|h| db(h).abs() < NICHOLS_DB);
    let nichols = vec![ClaimCurve::line("loop", within.map(|h| Point::new(phase(h), db(h))).collect())];
    vec![
        make_figure(
            "Nyquist chart of the loop",
            Axis::linear("real part", ""),
            vec![make_panel(Axis::linear("imaginary part", ""), nyquist).with_instant(-1.0, "-1")],
        ),
        make_figure(
            "Nichols chart of the loop",
            Axis::degrees("phase"),
            vec![make_panel(Axis::linear("loop gain", "dB"), nichols).with_level(0.0, "")],
        ),
    ]
}

/// Frequencies at which the open loop is measured, Hz, and the amplitude of the demand, rad/s.
const MEASURED_HZ: [f64; 5] = [1.0, 2.0, 3.0, 5.0, 8.0];
const DEMAND_RAD_S: f64 = 0.1;

/// Returns row C29: the open loop measured with the controller inside.
///
/// # Errors
/// Those of the simulator.
pub fn open_loop_analyser(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let plant = &tested.designed.modelled.plant;
    let measured = open_loop(plant, &tested.observed)?;
    let curves = &tested.designed.verified.verification().evidence.curves;
    let predicted = |hz: f64| {
        let near = |a: &usize, b: &usize| {
            (curves.frequency_hz[*a] / hz).ln().abs().total_cmp(&(curves.frequency_hz[*b] / hz).ln().abs())
        };
        (0..curves.frequency_hz.len())
            .min_by(near)
            .map_or(C64::new(f64::NAN, 0.0), |k| curves.broken.response[k])
    };
    let linear: Vec<C64> = MEASURED_HZ.iter().map(|hz| predicted(*hz)).collect();
    let [db, deg] = largest_differences(&measured, &linear);
    let words: Vec<String> = MEASURED_HZ
        .iter()
        .zip(&measured)
        .map(|(hz, h)| format!("{hz} Hz {:.1} dB {:.0} deg", 20.0 * h.norm().log10(), h.arg().to_degrees()))
        .collect();
    let points = |of: &dyn Fn(&C64) -> f64| {
        MEASURED_HZ.iter().copied().zip(measured.iter().map(of)).map(Point::from).collect()
    };
    let line = |of: &dyn Fn(&C64) -> f64| {
        let both = curves.frequency_hz.iter().copied().zip(curves.broken.response.iter().map(of));
        both.filter(|point| (0.5..=20.0).contains(&point.0)).map(Point::from).collect()
    };
    let gain = |h: &C64| 20.0 * h.norm().log10();
    let panels = vec![make_panel(
        Axis::linear("loop gain", "dB"),
        vec![
            ClaimCurve::points("measured in closed loop", points(&gain)),
            ClaimCurve::reference("linear loop", line(&gain)),
        ],
    )];
    Ok(Claim {
        id: "C29",
        title: "open loop, controller inside",
        source: "4.4.1",
        says: "the open loop is measured by the analyser with the loop closed around it, from demand to hub rate",
        measured: format!(
            "T / (1 - T) of the nonlinear closed loop with the friction observer at {DEMAND_RAD_S} rad/s: {}; up to {db:.1} dB and {deg:.0} deg from the linear loop",
            words.join(", ")
        ),
        criteria: open_loop_criteria(db, deg),
        why: String::new(),
        drawings: vec![make_figure("Open loop measured in closed loop", frequency_axis(), panels)],
    })
}

/// Returns what is asked of the measured open loop, in dB and degrees off.
fn open_loop_criteria(db: f64, deg: f64) -> Vec<Criterion> {
    vec![
        Criterion::at_most(
            "largest difference of the gain, dB",
            "the loop that was designed",
            db,
            3.0,
            "what the friction observer leaves is below the noise of the thesis' measurement, 3 dB",
        ),
        Criterion::at_most(
            "largest difference of the phase, deg",
            "the loop that was designed",
            deg,
            20.0,
            "a sixth of the phase margin's own 60 deg, twice",
        ),
    ]
}

/// Largest difference of two loops at the same frequencies: of the gain in dB, and of the phase in degrees.
fn largest_differences(measured: &[C64], linear: &[C64]) -> [f64; 2] {
    let apart: Vec<C64> = measured.iter().zip(linear).map(|(h, told)| h / told).collect();
    let largest = |of: &dyn Fn(&C64) -> f64| apart.iter().map(|ratio| of(ratio).abs()).fold(0.0, f64::max);
    [largest(&|ratio| 20.0 * ratio.norm().log10()), largest(&|ratio| ratio.arg().to_degrees())]
}

/// T / (1 - T) from the closed loop's response T at each frequency.
fn open_loop(plant: &Plant, controller: &Controller) -> Result<Vec<C64>, PipelineError> {
    let settings = Settings { least_duration_s: 1.0, ..Settings::default() };
    let one = |hz: &f64| -> Result<C64, PipelineError> {
        let at = TestSine { frequency_rad_s: std::f64::consts::TAU * hz, amplitude: DEMAND_RAD_S };
        let closed =
            measure_point(plant, &mut controller.runner(), Test::ClosedLoop, at, &settings)?.response.value;
        Ok(closed / (C64::new(1.0, 0.0) - closed))
    };
    MEASURED_HZ.iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::criterion::Agreement;

    #[test]
    fn a_loop_other_than_the_designed_one_fails() {
        let linear: Vec<C64> = [1.0, 0.5, 0.2].iter().map(|gain| C64::from_polar(*gain, -2.0)).collect();
        let disagreeing = |change: C64| -> Vec<String> {
            let measured: Vec<C64> = linear.iter().map(|h| h * change).collect();
            let [db, deg] = largest_differences(&measured, &linear);
            let all = open_loop_criteria(db, deg).into_iter();
            all.filter(|one| one.agreement() == Agreement::Disagrees).map(|one| one.what).collect()
        };
        assert!(disagreeing(C64::from_polar(1.2, 0.1)).is_empty());
        assert_eq!(disagreeing(C64::new(1.5, 0.0)), ["largest difference of the gain, dB"]);
        assert_eq!(disagreeing(C64::from_polar(1.0, -0.5)), ["largest difference of the phase, deg"]);
    }
}
