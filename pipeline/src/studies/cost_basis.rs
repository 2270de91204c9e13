//! The basis of the total cost of an assembled loop, as plain data: with these systems and densities, and with the weights, another
//! program computes the cost and its slopes again.

use counterpoise_linalg::sparse::VectorEntry;
use counterpoise_lti::StateSpace;
use counterpoise_models::LinearPlant;
use counterpoise_synth::{Assembly, Design, DisturbanceChannel, DisturbanceKnowledge, FeedforwardWeights};
use serde::Serialize;

use crate::PipelineError;
use crate::exchange::{DesignSignals, SystemResult};

/// The parts of the integral J = 1/pi over w > 0 of |H_q y|^2 + |H_r u|^2, as [`counterpoise_synth::total_cost`](fn@counterpoise_synth::total_cost) states it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CostBasis {
    /// `simple-add`, `grimble` or `joint`: how the parts are put together.
    pub assembly: &'static str,
    /// The design plant behind its delay: the measured rate, then every true output; inputs are numbered from 0.
    pub plant: SystemResult,
    /// The feedback from the measured rate to the control.
    pub feedback: SystemResult,
    /// Input that is the control, and true output that is controlled.
    pub control_input: usize,
    /// Number of that output among the true outputs.
    pub rate_output: usize,
    /// Spectral density of the noise of the measured rate, (rad/s)^2 s.
    pub measurement_noise: f64,
    /// White disturbances that no sensor announces, with that of the loop recovery on the control.
    pub disturbances: Vec<WhiteDisturbance>,
    /// Further true outputs with a constant weight, summed into one signal.
    pub combination: Vec<WeighedOutput>,
    /// Part of the feedback's error weight that passes everything at once, and so sees no noise.
    pub direct_error_weight: f64,
    /// The feedforwards.
    pub channels: Vec<ChannelBasis>,
}

/// A white disturbance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WhiteDisturbance {
    /// Input of the plant.
    pub input: usize,
    /// Spectral density, unit^2 s.
    pub density: f64,
}

/// A true output with its weight.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WeighedOutput {
    /// Number among the true outputs.
    pub output: usize,
    /// Weight.
    pub weight: f64,
}

/// A disturbance that a feedforward measures.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelBasis {
    /// `heave` or `pitch`: the name of its weights.
    pub name: &'static str,
    /// Inputs of the plant on which the disturbance and its derivatives act.
    pub inputs: Vec<usize>,
    /// From the disturbance, or from it and its derivatives, to control and expected rate.
    pub module: SystemResult,
    /// Sensor of the disturbance; `None` if it is known exactly or the sensor is perfect.
    pub sensor: Option<SystemResult>,
    /// Sensor of the disturbance as the motions see it, whatever the design takes for known; `None` if it is perfect or not read.
    pub true_sensor: Option<SystemResult>,
    /// Spectral density of the sensor's noise; `None` if the disturbance is known exactly.
    pub noise: Option<f64>,
    /// True output whose rate is weighed.
    pub weighed_output: usize,
}

/// Returns what the total cost of a design is computed from.
///
/// # Errors
/// Those of the plant with its delay.
pub fn cost_basis(design: &Design, signals: DesignSignals) -> Result<CostBasis, PipelineError> {
    let channels = [DisturbanceChannel::Heave, DisturbanceChannel::Pitch].into_iter();
    let channels = channels.filter_map(|channel| channel_basis(design, channel, signals)).collect();
    basis(design, &design.feedback_controller(), signals, channels)
}

/// Returns what the cost of a feedback alone is computed from, under the weights and on the plant of a design.
///
/// # Errors
/// Those of the plant with its delay.
pub fn feedback_basis(
    design: &Design,
    feedback: &StateSpace,
    signals: DesignSignals,
) -> Result<CostBasis, PipelineError> {
    basis(design, feedback, signals, Vec::new())
}

fn basis(
    design: &Design,
    feedback: &StateSpace,
    signals: DesignSignals,
    channels: Vec<ChannelBasis>,
) -> Result<CostBasis, PipelineError> {
    let (plant, asked) = (&design.plant, &design.specification);
    let weights = &asked.feedback;
    let recovery = WhiteDisturbance { input: plant.control, density: weights.loop_recovery };
    let others = weights
        .disturbances
        .iter()
        .map(|entry| WhiteDisturbance { input: entry.index, density: entry.value });
    let weighed = |entry: &VectorEntry| WeighedOutput { output: entry.index, weight: entry.value };
    let mirrored = weights.error.realise().map_err(PipelineError::from)?;
    Ok(CostBasis {
        assembly: match asked.assembly {
            Assembly::SimpleAdd => "simple-add",
            Assembly::Grimble => "grimble",
            Assembly::Joint => "joint",
        },
        plant: SystemResult::of_design_plant(&plant.measured_plant()?, signals),
        feedback: SystemResult::new(
            "feedback",
            &feedback.select(&[0], &[1]),
            &["measured_rate_rad_s"],
            &["control_v"],
        )
        .of_loop(signals.controlled),
        control_input: plant.control,
        rate_output: plant.rate,
        measurement_noise: weights.measurement_noise,
        disturbances: std::iter::once(recovery).chain(others).collect(),
        combination: weights.combination.iter().map(weighed).collect(),
        direct_error_weight: weights.error.rational().gain.signum() * mirrored.D[(0, 0)],
        channels,
    })
}

fn channel_basis(
    design: &Design,
    channel: DisturbanceChannel,
    signals: DesignSignals,
) -> Option<ChannelBasis> {
    let (part, weights) = (design.part(channel)?, design.specification.feedforward(channel)?);
    let asked: &FeedforwardWeights = weights;
    let columns = design.plant.columns(channel);
    let acting: Vec<&str> = columns.iter().filter_map(|k| LinearPlant::INPUTS.get(*k).copied()).collect();
    let read: Vec<String> = acting.iter().map(|name| format!("measured_{name}")).collect();
    let read: Vec<&str> = read.iter().take(1).map(String::as_str).collect();
    let sensor = design.plant.sensor(channel);
    let sensor = sensor.map(|system| SystemResult::new("sensor", system, &acting[..read.len()], &read));
    let noise = match asked.knowledge {
        DisturbanceKnowledge::Exact => None,
        DisturbanceKnowledge::Measured { noise } => Some(noise),
    };
    Some(ChannelBasis {
        name: match channel {
            DisturbanceChannel::Heave => "heave",
            DisturbanceChannel::Pitch => "pitch",
        },
        inputs: columns.to_vec(),
        module: SystemResult::new(
            "feedforward",
            &part.module,
            if noise.is_some() { &read } else { &acting },
            &["control_v", "expected_rate_rad_s"],
        )
        .of_loop(signals.controlled),
        true_sensor: sensor.clone().filter(|_| part.module.inputs() == 1),
        sensor: sensor.filter(|_| noise.is_some()),
        noise,
        weighed_output: asked.output.unwrap_or(design.plant.rate),
    })
}
