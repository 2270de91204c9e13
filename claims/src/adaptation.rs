//! Claims on an out-of-balance that changes during a run, and on its estimation.

use counterpoise_controller::Controller;
use counterpoise_models::Parameters;
use counterpoise_models::plant::Plant;
use counterpoise_project::resolve::synthesis_options::{AdaptationMethod, AdaptationOptions, Compensation};
use counterpoise_simulate::{Initial, PlatformMotion, Scenario, Signal, Simulator};
use counterpoise_synth::adaptation::{self, Scale};
use counterpoise_synth::{AdaptiveController, Estimation, RecursiveLeastSquares, RecursiveSettings};
use counterpoise_verify::Sine;
use counterpoise_verify::signals::rms;

use super::drawing::{ClaimCurve, make_figure, make_panel, time_axis};
use super::identification::with_amplifier;
use super::{Claim, Criterion, TestedDesign};
use crate::tolerance::RETURNED;
use counterpoise_pipeline::{PipelineError, build_plant_model, reduce_plant, synthesise};
use counterpoise_plot::{Axis, Figure as Drawing, Panel, Point};

/// Shares of the out-of-balance, one after the other, and how long each lasts, s: whole cycles of heave, pitch and window.
const SHARES: [f64; 5] = [1.0, 0.75, 0.37, 1.48, 1.0];
const INTERVAL_S: f64 = 20.0;
const WINDOW_S: f64 = 2.0;
/// Memory of least squares, s: an interval is judged ten seconds after its load changed.
const MEMORY_S: f64 = 3.0;
/// RMS over this last part of each interval.
const JUDGED: f64 = 0.5;

/// The source of the controller's out-of-balance.
#[derive(Clone, Copy, PartialEq)]
enum LoadSource {
    Nobody,
    Truth,
    Estimate(AdaptationMethod),
}

fn sine(s: &Sine) -> Signal {
    Signal::sine(s.amplitude, std::f64::consts::TAU * s.frequency_hz)
}

fn heave_scenario(tested: &TestedDesign<'_>, initial: Initial) -> Scenario {
    let platform = PlatformMotion {
        heave_m_s2: sine(&tested.procedure.heave),
        pitch_rate_rad_s: sine(&tested.procedure.pitch),
        ..PlatformMotion::STILL
    };
    Scenario { platform, initial, ..Scenario::at_rest(INTERVAL_S) }
}

/// Returns volts that hold one kg m at one m/s^2, and what the drive makes of a control.
fn scale(tested: &TestedDesign<'_>, parameters: &Parameters) -> Scale {
    let nominal_g = tested.parameters().gravity_m_s2;
    let points = if parameters.amplifier.map.is_empty() {
        Vec::new()
    } else {
        let drive = |k: i32| {
            (0.05 * f64::from(k), parameters.amplifier.drive_v(0.05 * f64::from(k), &parameters.motor))
        };
        (-200..=200).map(drive).collect()
    };
    Scale {
        volts_per_kg_m_s2: volts_per_kg_m(tested.parameters()) / nominal_g,
        gravity_m_s2: parameters.gravity_m_s2,
        curve: adaptation::Curve { points },
    }
}

fn volts_per_kg_m(p: &Parameters) -> f64 {
    let torque_per_volt =
        p.amplifier.stall_gain_a_v(&p.motor) * p.motor.torque_constant_nm_a * p.gearbox.ratio;
    p.gravity_m_s2 / torque_per_volt
}

/// Returns the estimator of a machine that nothing is known of.
fn blank_estimation(tested: &TestedDesign<'_>, scale: Scale) -> Result<Estimation, PipelineError> {
    let squares = RecursiveLeastSquares::new(RecursiveSettings {
        scale,
        memory_s: MEMORY_S,
        sample_period_s: tested.parameters().interface.sample_period_s,
        dead_band_m_s2: 0.1,
        half_rate_rad_s: 2e-3,
        rate_limit_kg_m_s: 50.0,
        start_kg_m: 0.0,
        start_deviation_kg_m: 100.0,
        filter_s: 0.0,
        inertia_v_s2_rad: [0.0; 2],
    })?;
    Ok(Estimation::Squares(Box::new(squares)))
}

/// Returns the controller that a design exports for a machine, with the estimator of its out-of-balance if it has one, and with the inverse of the
/// amplifier's curve if that is measured.
fn exported_controller(
    tested: &TestedDesign<'_>,
    machine: &Parameters,
    telling: LoadSource,
) -> Result<Controller, PipelineError> {
    let mut project = tested.observing_project.clone();
    project.plant.amplifier = machine.amplifier.clone();
    let mut synth = project.synth.take().unwrap_or_default();
    if !machine.amplifier.map.is_empty() {
        synth.options.amplifier_curve = Compensation::Applied;
    }
    synth.options.adaptation = match telling {
        LoadSource::Nobody | LoadSource::Truth => None,
        LoadSource::Estimate(method) => Some(AdaptationOptions {
            method,
            window_s: WINDOW_S,
            memory_s: MEMORY_S,
            ..AdaptationOptions::usual()
        }),
    };
    project.synth = Some(synth);
    let modelled = build_plant_model(&project)?;
    let reduced = reduce_plant(&project, &modelled)?;
    Ok(synthesise(&project, &modelled, &reduced)?.sampled.controller)
}

/// Returns the RMS hub rate, mrad/s, over the last part of each interval, the out-of-balance stepping between
/// intervals.
fn intervals(
    tested: &TestedDesign<'_>,
    base: &Parameters,
    telling: LoadSource,
) -> Result<Vec<f64>, PipelineError> {
    let moment = nominal_moment(base);
    let mut controller = exported_controller(tested, base, telling)?.runner();
    let mut initial = Initial::Rest { hub_angle_rad: 0.0 };
    let mut found = Vec::new();
    for share in SHARES {
        let mut machine = base.clone();
        machine.lumped.iter_mut().for_each(|lumped| lumped.out_of_balance_kg_m *= share);
        if telling == LoadSource::Truth {
            controller.set_out_of_balance(share * moment);
        }
        let plant = Plant::from_lumped(&machine)?;
        let run = Simulator::new(&plant)?.run(&mut controller, &heave_scenario(tested, initial))?;
        let rates = run.truth.hub_rate_rad_s();
        let first = ((1.0 - JUDGED) * rates.len() as f64) as usize;
        found.push(1e3 * rms(&rates[first..]));
        initial = Initial::State(Box::new(run.final_state));
    }
    Ok(found)
}

fn nominal_moment(p: &Parameters) -> f64 {
    p.lumped.as_ref().map_or(f64::NAN, |lumped| lumped.out_of_balance_kg_m)
}

fn words(values: &[f64]) -> String {
    values.iter().map(|v| format!("{v:.2}")).collect::<Vec<_>>().join(" / ")
}

/// Returns row C24: the estimate updates the heave feedforward.
///
/// # Errors
/// Those of the simulator.
pub fn adapted_feedforward(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let linear = tested.parameters().clone();
    let curved = with_amplifier(&linear, 1.0);
    let (mut lines, mut criteria) = (Vec::new(), Vec::new());
    let mut lowest = Vec::new();
    let mut panels = Vec::new();
    for (name, machine) in [("linear amplifier", &linear), ("measured amplifier", &curved)] {
        let of = |telling| intervals(tested, machine, telling);
        let (nobody, mean, squares, truth) = (
            of(LoadSource::Nobody)?,
            of(LoadSource::Estimate(AdaptationMethod::WindowedMean))?,
            of(LoadSource::Estimate(AdaptationMethod::Recursive))?,
            of(LoadSource::Truth)?,
        );
        let most = |rates: &[f64]| rates.iter().copied().fold(0.0, f64::max) / truth[0];
        let changed = |rates: &[f64]| rates[1..4].iter().copied().fold(f64::INFINITY, f64::min) / truth[0];
        criteria.extend(adaptation_criteria(name, most(&mean), most(&truth), changed(&nobody)));
        let squared = format!("{name}: adapted by least squares");
        criteria.push(returning_criterion(&squared, most(&squares), most(&truth)));
        lowest.push(mean[2] / truth[0]);
        panels.push(interval_panel(name, [&nobody, &mean, &squares, &truth]));
        lines.push(format!(
            "{name}: not updated {}, mean over {WINDOW_S} s {}, least squares {}, told the truth {}",
            words(&nobody),
            words(&mean),
            words(&squares),
            words(&truth)
        ));
    }
    Ok(Claim {
        id: "C24",
        title: "adaptation",
        source: "7.6, fig 7-18",
        says: "the mean of the control over a window updates the heave feedforward: after each step of out-of-balance the hub rate returns to the default case; with the nonlinear amplifier too, slightly worse at the lowest imbalance",
        measured: format!(
            "RMS hub rate in mrad/s under heave and pitch, last half of each 20 s at 1 / 0.75 / 0.37 / 1.48 / 1 of the out-of-balance. {}. At the lowest: {:.2} times the default with the linear, {:.2} with the measured amplifier",
            lines.join(". "),
            lowest[0],
            lowest[1]
        ),
        criteria,
        why: interval_reason(&lowest),
        drawings: vec![
            make_figure("RMS hub rate after each change of the out-of-balance", Axis::linear("interval of 20 s", ""), panels)
                .with_caption("The out-of-balance is 1, 0.75, 0.37, 1.48 and 1 times the normal. Above the linear amplifier, below the measured one."),
        ],
    })
}

/// Returns what is asked of the adapted and of the unadapted controller on a machine, over the default's hub rate.
fn adaptation_criteria(name: &str, adapted: f64, truth: f64, unadapted: f64) -> [Criterion; 2] {
    [
        returning_criterion(&format!("{name}: adapted"), adapted, truth),
        Criterion::at_least(
            &format!("{name}: not adapted, smallest hub rate at a changed out-of-balance over the default"),
            "does not return",
            unadapted,
            RETURNED,
            "what the adapted one passes, the unadapted one must fail",
        ),
    ]
}

/// Returns what is asked of an adapted controller: the hub rate of the default, or that of the controller that is told the truth.
fn returning_criterion(name: &str, adapted: f64, truth: f64) -> Criterion {
    Criterion::at_most(
        &format!("{name}, largest hub rate over the default"),
        "returns",
        adapted,
        RETURNED,
        "returned means within 10 %, as a restored friction does",
    )
    .with_explained_range(RETURNED, RETURNED * truth)
}

/// Returns the four ways to tell the controller, interval by interval.
fn interval_panel(name: &str, [nobody, mean, squares, truth]: [&[f64]; 4]) -> Panel {
    let over =
        |values: &[f64]| values.iter().enumerate().map(|(k, v)| Point::new((k + 1) as f64, *v)).collect();
    let curves = vec![
        ClaimCurve::points("not updated", over(nobody)),
        ClaimCurve::points("mean of the control", over(mean)),
        ClaimCurve::points("least squares", over(squares)),
        ClaimCurve::reference("told the truth", over(truth)),
    ];
    make_panel(Axis::linear(&format!("hub, {name}"), "mrad/s"), curves)
}

fn interval_reason(lowest: &[f64]) -> String {
    format!(
        "some interval stays above {RETURNED} times the default ({:.2} and {:.2} times at the lowest); where even the controller that is told the truth does not return, the changed loop and not the estimate is the cause",
        lowest[0], lowest[1]
    )
}

/// Returns row F1: the out-of-balance where gravity gives no offset.
///
/// # Errors
/// Those of the simulator.
pub fn imbalance_without_gravity(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let mut weightless = tested.parameters().clone();
    weightless.gravity_m_s2 = 0.0;
    let no_bias: Controller = tested
        .controller()
        .with(|parts| parts.bias_v_per_kg_m = 0.0)
        .map_err(counterpoise_verify::Error::from)?;
    let moment = nominal_moment(&weightless);
    let (mut lines, mut worst) = (Vec::new(), 0.0_f64);
    let mut curves = Vec::new();
    for share in [0.37, 0.75, 1.0, 1.48] {
        let mut machine = weightless.clone();
        machine.lumped.iter_mut().for_each(|lumped| lumped.out_of_balance_kg_m *= share);
        let estimation = blank_estimation(tested, scale(tested, &machine))?;
        let mut adaptive = AdaptiveController::new(no_bias.runner(), estimation);
        let initial = Initial::Rest { hub_angle_rad: 0.0 };
        Simulator::new(&Plant::from_lumped(&machine)?)?
            .run(&mut adaptive, &heave_scenario(tested, initial))?;
        let history = adaptive.history_kg_m();
        let time = |k: usize| INTERVAL_S * (k + 1) as f64 / history.len() as f64;
        let every = history.len().div_ceil(1000).max(1);
        let points = (0..history.len()).step_by(every).map(|k| Point::new(time(k), history[k])).collect();
        curves.push(ClaimCurve::line(format!("true {:.1} kg m", share * moment), points));
        let last = &history[history.len() / 2..];
        let estimate = last.iter().sum::<f64>() / last.len().max(1) as f64;
        worst = worst.max((estimate / (share * moment) - 1.0).abs());
        lines.push(format!("{estimate:.1} for {:.1}", share * moment));
    }
    Ok(Claim {
        id: "F1",
        title: "without gravity",
        source: "9.2",
        says: "asks for the out-of-balance where gravity gives no offset, from the correlation of acceleration with control",
        measured: format!(
            "without gravity, from nothing known, least squares of control on acceleration over 20 s of heave and pitch, in kg m: {}; worst {:.1} %",
            lines.join(", "),
            100.0 * worst
        ),
        criteria: vec![Criterion::at_most(
            "largest error of the estimate, %",
            "asked for",
            100.0 * worst,
            15.0,
            "good enough for the feedforward: 15 % of the heave torque is -16 dB",
        )],
        why: String::new(),
        drawings: vec![estimates(curves, moment)],
    })
}

/// Returns the estimates over time, with the truth of each.
fn estimates(curves: Vec<ClaimCurve>, moment: f64) -> Drawing {
    let panel = make_panel(Axis::linear("estimate", "kg m"), curves);
    let truths = [0.37, 0.75, 1.0, 1.48].map(|share| share * moment);
    let panel = truths.into_iter().fold(panel, |panel, truth| panel.with_level(truth, "the truth"));
    make_figure("The out-of-balance estimated without gravity", time_axis(), vec![panel])
}
