//! Gyroscopes that are not mounted exactly along the axis: they also read a part of the platform's roll rate.

use std::f64::consts::TAU;

use counterpoise_controller::{Readings, Runner, SampledController};
use counterpoise_linalg::C64;
use counterpoise_models::plant::Plant;
use counterpoise_plot::{Axis, Point};
use counterpoise_simulate::{PlatformMotion, Scenario, Signal, Simulator};

use super::drawing::{ClaimCurve, make_figure, make_panel, time_axis};
use super::{Claim, Criterion, TestedDesign};
use counterpoise_pipeline::PipelineError;

/// Angle between a gyroscope's axis and the axis of the mechanism, in the plane of pitch and roll, rad: one degree.
const ANGLE_RAD: f64 = std::f64::consts::PI / 180.0;
/// Roll rate of the platform, rad/s, and its frequency, Hz: beside the pitch of the procedure, not a multiple of it.
const ROLL_RAD_S: f64 = 0.3;
const ROLL_HZ: f64 = 1.4;
/// Time over which the platform moves, and from which whole cycles of roll are judged, s.
const DURATION_S: (f64, f64) = (14.0, 4.0);

/// A controller whose gyroscopes also read the roll rate, by the sine of their angles.
struct MisalignedController {
    runner: Runner,
    hub_rad: f64,
    platform_rad: f64,
    period_s: f64,
    sample: u32,
}

impl SampledController for MisalignedController {
    fn reset(&mut self) {
        self.runner.reset();
        self.sample = 0;
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        let roll = ROLL_RAD_S * (TAU * ROLL_HZ * self.period_s * f64::from(self.sample)).sin();
        self.sample += 1;
        let read = |rate: f64, angle: f64| angle.cos() * rate + angle.sin() * roll;
        self.runner.step(&Readings {
            hub_rate_rad_s: read(readings.hub_rate_rad_s, self.hub_rad),
            platform_rate_rad_s: read(readings.platform_rate_rad_s, self.platform_rad),
            ..*readings
        })
    }
}

/// Returns the hub rate under pitch and roll.
fn simulate_hub_rate(
    tested: &TestedDesign<'_>,
    hub_rad: f64,
    platform_rad: f64,
) -> Result<Vec<f64>, PipelineError> {
    let p = tested.parameters();
    let pitch = &tested.procedure.pitch;
    let platform = PlatformMotion {
        pitch_rate_rad_s: Signal::sine(pitch.amplitude, TAU * pitch.frequency_hz),
        ..PlatformMotion::STILL
    };
    let scenario = Scenario { platform, ..Scenario::at_rest(DURATION_S.0) };
    let runner = tested.observed.runner();
    let period_s = p.interface.sample_period_s;
    let mut controller = MisalignedController { runner, hub_rad, platform_rad, period_s, sample: 0 };
    let run = Simulator::new(&Plant::from_lumped(p)?)?.run(&mut controller, &scenario)?;
    Ok(run.truth.hub_rate_rad_s().to_vec())
}

/// Returns what a misaligned run has more than the aligned one at the roll's frequency, over the roll rate.
fn cross_coupling(tested: &TestedDesign<'_>, hub: &[f64], aligned: &[f64]) -> f64 {
    let period_s = tested.parameters().interface.sample_period_s;
    let first = (DURATION_S.1 / period_s).round() as usize;
    let cycles = ((hub.len().saturating_sub(first)) as f64 * period_s * ROLL_HZ).floor();
    let count = (cycles / (ROLL_HZ * period_s)).round() as usize;
    let at = |k: usize| C64::from_polar(hub[k] - aligned[k], -TAU * ROLL_HZ * period_s * k as f64);
    let sum: C64 = (first..(first + count).min(hub.len()).min(aligned.len())).map(at).sum();
    2.0 * sum.norm() / (count as f64 * ROLL_RAD_S)
}

/// Returns the linear loop's complementary sensitivity at the roll's frequency.
fn complementary(tested: &TestedDesign<'_>) -> f64 {
    let curves = &tested.designed.verified.verification().evidence.curves;
    let far = |k: &usize| (curves.frequency_hz[*k] / ROLL_HZ).ln().abs();
    let near = (0..curves.frequency_hz.len()).min_by(|a, b| far(a).total_cmp(&far(b)));
    near.map_or(f64::NAN, |k| {
        let open = curves.broken.response[k];
        (open / (C64::new(1.0, 0.0) + open)).norm()
    })
}

/// Returns row C34: misaligned gyroscopes.
///
/// # Errors
/// Those of the simulator.
pub fn misaligned_gyroscopes(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let aligned = simulate_hub_rate(tested, 0.0, 0.0)?;
    let hub = simulate_hub_rate(tested, ANGLE_RAD, 0.0)?;
    let platform = simulate_hub_rate(tested, 0.0, ANGLE_RAD)?;
    let share = |of: &[f64]| cross_coupling(tested, of, &aligned) / ANGLE_RAD.sin();
    let (of_hub, of_platform, loop_) = (share(&hub), share(&platform), complementary(tested));
    let period_s = tested.parameters().interface.sample_period_s;
    let curve = |name: &str, rates: &[f64]| {
        let first = (DURATION_S.1 / period_s).round() as usize;
        let points = rates.iter().enumerate().skip(first).take((2.0 / period_s) as usize);
        ClaimCurve::line(name, points.map(|(k, rate)| Point::new(k as f64 * period_s, 1e3 * rate)).collect())
    };
    let curves = vec![
        curve("aligned", &aligned),
        curve("hub gyroscope off by 1 deg", &hub),
        curve("platform gyroscope off by 1 deg", &platform),
    ];
    Ok(Claim {
        id: "C34",
        title: "misaligned gyroscopes",
        source: "4.2, 5.5",
        says: "two gyroscopes, on the hub and on the platform, measure the rates about the axis; the hub is stabilised as the hub's gyroscope says, the platform's only helps",
        measured: format!(
            "1 deg between a gyroscope and the axis, roll of {ROLL_RAD_S} rad/s at {ROLL_HZ} Hz beside the pitch: hub rate at that frequency over the misread roll rate {of_hub:.2} for the hub's gyroscope (the linear loop's |T| is {loop_:.2}), {of_platform:.2} for the platform's"
        ),
        criteria: criteria(of_hub, of_platform, loop_),
        why: String::new(),
        drawings: vec![make_figure(
            "Hub rate under pitch and roll",
            time_axis(),
            vec![make_panel(Axis::linear("hub rate", "mrad/s"), curves)],
        )],
    })
}

/// Returns what is asked of the shares of the misread roll rate that reach the hub by either gyroscope.
fn criteria(of_hub: f64, of_platform: f64, complementary: f64) -> Vec<Criterion> {
    vec![
        Criterion::with_range(
            "hub gyroscope: hub rate over misread roll rate, over |T| of the linear loop",
            "the loop holds what the gyroscope reads",
            of_hub / complementary,
            [0.85, 1.15],
            "friction, which the observer does not cancel wholly, changes a closed-loop gain by at most a seventh",
        ),
        Criterion::at_most(
            "platform gyroscope: hub rate over misread roll rate, over that of the hub gyroscope",
            "a feedforward, not the loop",
            of_platform / of_hub,
            0.5,
            "the feedback removes most of what a feedforward does wrong at this frequency",
        ),
    ]
}
