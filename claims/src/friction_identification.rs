//! The friction observer of the rows: its parameters are identified from a recording of the mechanism, as they would be on a real one.
//!
//! The recording is a noisy triangle wave. The search starts from a project that is wrong in level and in presliding stiffness. The level
//! comes from the triangle-wave identification, the stiffness from replays of the recording.

use counterpoise_controller::ProportionalIntegral;
use counterpoise_diagnose::identification::{apply_identified, identify};
use counterpoise_models::Parameters;
use counterpoise_models::plant::Plant;
use counterpoise_pipeline::PipelineError;
use counterpoise_project::Project;
use counterpoise_project::resolve::synthesis_options::{ObserverFriction, ObserverOptions};
use counterpoise_recordings::Recording;
use counterpoise_simulate::replay::{ReplayLoop, Replayer};
use counterpoise_simulate::{Detail, Imperfections, Scenario, Signal, Simulator};
use counterpoise_synth::observer::Drives;

/// By how much the project is wrong before the identification: Coulomb level at the pivot, and presliding stiffness.
const WRONG: [f64; 2] = [0.7, 3.0];
/// The triangle: peak rate in rad/s, period and length in s.
const TRIANGLE: (f64, f64, f64) = (0.15, 2.0, 10.0);
/// Seed of the recording's noise.
const SEED: u64 = 11;
/// Factors on the presliding stiffness that are tried, in equal ratios from the first to the last; the best is refined by a parabola in
/// the logarithm.
const STIFFNESS: (f64, f64, usize) = (0.05, 5.0, 15);

/// The friction of a mechanism as a user would have it from a recording.
#[derive(Debug, Clone)]
pub struct IdentifiedFriction {
    /// The mechanism with the identified friction.
    pub parameters: Parameters,
    /// Identified over true Coulomb level, motor and pivot together at the output.
    pub coulomb_ratio: f64,
    /// Identified over true presliding stiffness at the pivot.
    pub stiffness_ratio: f64,
}

/// Identifies the friction of a mechanism from a recording of it.
///
/// # Errors
/// Those of the simulator and of the identification.
pub fn identify_friction(truth: &Parameters) -> Result<IdentifiedFriction, PipelineError> {
    let mut wrong = truth.clone();
    wrong.pivot_friction.law.scale_coulomb(WRONG[0]);
    scale_stiffness(&mut wrong, WRONG[1]);
    let (recording, control) = record_machine(truth)?;
    let found = identify(&wrong, &[std::slice::from_ref(&recording)])?;
    let level = apply_identified(&wrong, &found);
    let parameters = with_fitted_stiffness(&level, &recording, &control)?;
    let total =
        |p: &Parameters| p.pivot_friction.coulomb_nm() + p.gearbox.ratio * p.motor_friction.coulomb_nm();
    Ok(IdentifiedFriction {
        coulomb_ratio: total(&parameters) / total(truth),
        stiffness_ratio: stiffness(&parameters) / stiffness(truth),
        parameters,
    })
}

/// Returns a project whose exported controller observes the identified friction.
pub fn with_observer(project: &Project, found: &IdentifiedFriction) -> Project {
    let mut project = project.clone();
    if let Some(synth) = &mut project.synth {
        synth.options.observer = Some(ObserverOptions {
            drives: Drives::MeasuredRate,
            share: 1.0,
            motor: Some(found.parameters.motor_friction.clone()),
            pivot: Some(found.parameters.pivot_friction.clone()),
            model: ObserverFriction::Dahl,
            sign_rate_rad_s: 5e-3,
            learning: None,
        });
    }
    project
}

/// Returns a PI controller that holds a machine's weight.
pub(crate) fn holding_controller(machine: &Parameters) -> Result<ProportionalIntegral, PipelineError> {
    let bias_v = Plant::from_lumped(machine)?.equilibrium(&Default::default()).control_v;
    let sample_period_s = machine.interface.sample_period_s;
    Ok(ProportionalIntegral {
        kp_v_s_rad: 18.0,
        ki_v_rad: 80.0,
        bias_v,
        sample_period_s,
        ..ProportionalIntegral::default()
    })
}

fn record_machine(truth: &Parameters) -> Result<(Recording, ReplayLoop), PipelineError> {
    let plant = Plant::from_lumped(truth)?;
    let mut controller = holding_controller(truth)?;
    let control = ReplayLoop::from(&controller);
    let scenario = Scenario {
        demand_rad_s: Signal::Triangle { amplitude: TRIANGLE.0, period_s: TRIANGLE.1 },
        imperfections: Imperfections::NoiseAndQuantisation { seed: SEED },
        detail: Detail::Recording,
        ..Scenario::at_rest(TRIANGLE.2)
    };
    let run = Simulator::new(&plant)?.run(&mut controller, &scenario)?;
    Ok((run.readings.recording("triangle", truth.interface.sample_period_s), control))
}

/// Returns the mechanism with the presliding stiffness that replays a recording best.
fn with_fitted_stiffness(
    start: &Parameters,
    recording: &Recording,
    control: &ReplayLoop,
) -> Result<Parameters, PipelineError> {
    let replayer = Replayer::new(start, recording)?;
    let with = |factor: f64| {
        let mut parameters = start.clone();
        scale_stiffness(&mut parameters, factor);
        parameters
    };
    let cost = |factor: f64| -> Result<f64, PipelineError> {
        let replay = replayer.replay(&with(factor), control)?;
        Ok(replay.channels.iter().map(|fit| (fit.rms_error / fit.floor).powi(2)).sum::<f64>().ln())
    };
    let (low, high, count) = STIFFNESS;
    let step = (high / low).ln() / (count - 1) as f64;
    let factors: Vec<f64> = (0..count).map(|k| low * (step * k as f64).exp()).collect();
    let costs = factors.iter().map(|factor| cost(*factor)).collect::<Result<Vec<f64>, _>>()?;
    let best = (1..count - 1).min_by(|a, b| costs[*a].total_cmp(&costs[*b])).unwrap_or(0);
    let (mut centre, mut width) = (factors[best].ln(), step);
    for _ in 0..3 {
        let [left, middle, right] =
            [cost((centre - width).exp())?, cost(centre.exp())?, cost((centre + width).exp())?];
        let curvature = left - 2.0 * middle + right;
        let shift = if curvature > 0.0 { 0.5 * (left - right) / curvature } else { 0.0 };
        centre += width * shift.clamp(-1.0, 1.0);
        width *= 0.4;
    }
    Ok(with(centre.exp()))
}

/// Presliding stiffness at the pivot, N m/rad; NaN for a law that has none.
fn stiffness(parameters: &Parameters) -> f64 {
    parameters.pivot_friction.presliding_stiffness_nm_rad().unwrap_or(f64::NAN)
}

fn scale_stiffness(parameters: &mut Parameters, factor: f64) {
    parameters.pivot_friction.scale_presliding_stiffness(factor);
    parameters.motor_friction.scale_presliding_stiffness(factor);
}
