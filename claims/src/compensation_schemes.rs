//! The schemes of the thesis' appendix 1 and section 9.2 against friction, beside the observer: dither, impulses, variable structure.

use counterpoise_controller::{Readings, Runner, SampledController};
use counterpoise_models::plant::Plant;
use counterpoise_plot::{Axis, Point};
use counterpoise_simulate::{PlatformMotion, Scenario, Signal, Simulator};
use counterpoise_verify::Sine;
use counterpoise_verify::signals::rms;

use super::drawing::{ClaimCurve, make_figure, make_panel, time_axis};
use super::{Claim, Criterion, TestedDesign};
use crate::tolerance::STOPPED_RAD_S;
use counterpoise_pipeline::PipelineError;

/// The term that is added to the control of the design without observer.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Scheme {
    /// Nothing.
    None,
    /// A tone, so that friction is passed through all the time.
    Dither,
    /// A pulse in the direction of the error where the hub has stopped against the platform.
    Impulse,
    /// A switching term on the rate error, softened in a boundary layer.
    VariableStructure,
}

/// Frequency of the dither, Hz: well above the loop, well below half the sample rate.
const DITHER_HZ: f64 = 60.0;
/// Rate error within which the switching term is proportional, rad/s.
const LAYER_RAD_S: f64 = 0.02;
/// Time over which the platform moves, and from which the hub is judged, s.
const DURATION_S: (f64, f64) = (10.0, 2.0);

/// A controller with a scheme beside it.
struct CompensatedController {
    runner: Runner,
    scheme: Scheme,
    /// Control that overcomes the dry friction, V.
    friction_v: f64,
    period_s: f64,
    sample: u32,
}

impl SampledController for CompensatedController {
    fn reset(&mut self) {
        self.runner.reset();
        self.sample = 0;
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        let control = self.runner.step(readings);
        let error = readings.demand_rad_s - readings.hub_rate_rad_s;
        let relative = readings.hub_rate_rad_s - readings.platform_rate_rad_s;
        let angle = std::f64::consts::TAU * DITHER_HZ * self.period_s * f64::from(self.sample);
        self.sample += 1;
        control
            + self.friction_v
                * match self.scheme {
                    Scheme::None => 0.0,
                    Scheme::Dither => angle.sin(),
                    Scheme::Impulse if relative.abs() < STOPPED_RAD_S => error.signum(),
                    Scheme::Impulse => 0.0,
                    Scheme::VariableStructure => (error / LAYER_RAD_S).clamp(-1.0, 1.0),
                }
    }
}

/// Returns row C32: schemes against friction that need no model of it.
///
/// # Errors
/// Those of the simulator.
pub fn schemes_of_the_appendix(tested: &TestedDesign<'_>) -> Result<Claim, PipelineError> {
    let schemes = [
        (Scheme::None, "feedforwards alone"),
        (Scheme::Dither, "dither"),
        (Scheme::Impulse, "impulses"),
        (Scheme::VariableStructure, "variable structure"),
    ];
    let (mut rates, mut curves) = (Vec::new(), Vec::new());
    for (scheme, name) in schemes {
        let hub = simulate_hub_rate(tested, &mut with(tested, scheme))?;
        rates.push(settled_rms(tested, &hub));
        curves.push(curve(tested, name, &hub));
    }
    let hub = simulate_hub_rate(tested, &mut tested.observed.runner())?;
    let observed = settled_rms(tested, &hub);
    curves.push(curve(tested, "friction observer", &hub));
    let words: Vec<String> =
        schemes.iter().zip(&rates).map(|((_, name), rate)| format!("{name} {:.2}", 1e3 * rate)).collect();
    let best = rates[1..].iter().copied().fold(f64::INFINITY, f64::min);
    Ok(Claim {
        id: "C32",
        title: "schemes without a model",
        source: "app. 1, 9.2(e)",
        says: "dither, impulse control and variable structure control are alternatives to a friction model; dither gave no significant improvement in the work that the thesis cites",
        measured: format!(
            "RMS hub rate under heave and pitch in mrad/s: {}, friction observer {:.2}",
            words.join(", "),
            1e3 * observed
        ),
        criteria: vec![
            Criterion::at_least(
                "dither over no scheme, RMS hub rate",
                "no significant improvement",
                rates[1] / rates[0],
                0.7,
                "3 dB would be significant",
            ),
            Criterion::at_least(
                "best scheme without a model over the observer, RMS hub rate",
                "the observer is preferred",
                best / observed,
                1.0,
                "no scheme may be better",
            ),
        ],
        why: String::new(),
        drawings: vec![make_figure(
            "Hub rate by each scheme",
            time_axis(),
            vec![make_panel(Axis::linear("hub rate", "mrad/s"), curves)],
        )],
    })
}

fn with(tested: &TestedDesign<'_>, scheme: Scheme) -> CompensatedController {
    let p = tested.parameters();
    let torque_per_volt =
        p.amplifier.stall_gain_a_v(&p.motor) * p.motor.torque_constant_nm_a * p.gearbox.ratio;
    let friction_nm = p.pivot_friction.coulomb_nm() + p.gearbox.ratio * p.motor_friction.coulomb_nm();
    let friction_v = friction_nm / torque_per_volt;
    CompensatedController {
        runner: tested.controller().runner(),
        scheme,
        friction_v,
        period_s: p.interface.sample_period_s,
        sample: 0,
    }
}

/// Returns the hub rate while the platform heaves and pitches.
fn simulate_hub_rate(
    tested: &TestedDesign<'_>,
    controller: &mut dyn SampledController,
) -> Result<Vec<f64>, PipelineError> {
    let sine = |s: &Sine| Signal::sine(s.amplitude, std::f64::consts::TAU * s.frequency_hz);
    let platform = PlatformMotion {
        heave_m_s2: sine(&tested.procedure.heave),
        pitch_rate_rad_s: sine(&tested.procedure.pitch),
        ..PlatformMotion::STILL
    };
    let scenario = Scenario { platform, ..Scenario::at_rest(DURATION_S.0) };
    let run = Simulator::new(&Plant::from_lumped(tested.parameters())?)?.run(controller, &scenario)?;
    Ok(run.truth.hub_rate_rad_s().to_vec())
}

fn first_sample(tested: &TestedDesign<'_>) -> usize {
    (DURATION_S.1 / tested.parameters().interface.sample_period_s).round() as usize
}

fn settled_rms(tested: &TestedDesign<'_>, hub: &[f64]) -> f64 {
    rms(&hub[first_sample(tested).min(hub.len())..])
}

/// Returns the hub rate in mrad/s over time, of two seconds after the start.
fn curve(tested: &TestedDesign<'_>, name: &str, hub: &[f64]) -> ClaimCurve {
    let period_s = tested.parameters().interface.sample_period_s;
    let (from, count) = (first_sample(tested), (2.0 / period_s).round() as usize);
    let points =
        hub.iter().enumerate().skip(from).take(count).map(|(k, rate)| (k as f64 * period_s, 1e3 * rate));
    ClaimCurve::line(name, points.map(Point::from).collect())
}
