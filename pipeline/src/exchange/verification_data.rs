//! The data that a verification measured its figures on: the sampled plant, the controller, the loop, and the time histories.

use counterpoise_controller::{COMMON_READINGS, Controller, READING_NAMES};
use counterpoise_models::ControlledQuantity;
use counterpoise_models::plant::{LinearPlant, Plant};
use counterpoise_verify::linear_loop::SampledPlant;
use counterpoise_verify::linear_loop::closed_loop::{ClosedLoop, arrange_controller, resolver_use};
use counterpoise_verify::{
    Arrangement, Experiment, History, Model, PerformanceFigure, Procedure, Quantity, StepFigure,
    TriangleFigure, Verification, linear_plant,
};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::BalanceResult;
use super::systems::{ResponseResult, SystemResult};
use crate::PipelineError;

/// Loop on which the linear figures of a verification are measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VerifiedLoop {
    /// The continuous plant with its sensors, the sampled plant, the controller with and without feedforwards, and the loop broken at the
    /// plant's input (1 + L is the return difference).
    pub systems: Vec<SystemResult>,
    /// Whole samples by which the control is late.
    pub control_delay_samples: usize,
    /// Whole samples by which each reading is late; the rest of a delay is part of the continuous system.
    pub reading_delays_samples: Vec<usize>,
    /// Control that holds the mechanism at its operating point, V.
    pub holding_v: f64,
    /// First moment of mass about the pivot, kg m.
    pub out_of_balance_kg_m: f64,
    /// Balance from which the holding control follows.
    pub balance: BalanceResult,
    /// Time after which a disturbance is judged, s.
    pub settle_s: f64,
}

/// A time history of an experiment; columns that were not computed are absent. Demand, hub and tip have the names and units of what the loop
/// controls: `transmitted_torque_nm` for `hub_rate_rad_s` in a loop of torque.
#[derive(Debug, Clone, PartialEq)]
pub struct HistoryResult {
    /// Quantity that the loop controls.
    pub controlled: ControlledQuantity,
    /// Sample time, s.
    pub sample_time_s: f64,
    /// Plant, experiment and signals.
    pub history: History,
}

impl Serialize for HistoryResult {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (controlled, history) = (self.controlled, &self.history);
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("name", &history_name(history.model, history.experiment))?;
        map.serialize_entry("start_s", &history.time_s().first().copied().unwrap_or(0.0))?;
        map.serialize_entry("sample_time_s", &self.sample_time_s)?;
        map.serialize_entry(&controlled.named_signal("demand_rad_s"), history.demand_rad_s())?;
        map.serialize_entry("heave_m_s2", history.heave_m_s2())?;
        map.serialize_entry("pitch_rate_rad_s", history.pitch_rate_rad_s())?;
        map.serialize_entry(&controlled.signal(), history.hub_rate_rad_s())?;
        map.serialize_entry(&controlled.tip_signal(), history.tip_rate_rad_s())?;
        map.serialize_entry("control_v", history.control_v())?;
        map.serialize_entry(&controlled.named_signal("current_a"), history.current_a())?;
        map.serialize_entry(&format!("travel_{}", controlled.travel_unit()), history.travel_rad())?;
        if !history.contact().is_empty() {
            map.serialize_entry("contact", history.contact())?;
        }
        map.end()
    }
}

/// Returns what the linear figures of a controller on a plant are measured on.
///
/// # Errors
/// Those of the linearisation and of the sampling.
pub fn verified_loop(
    plant: &Plant,
    controller: &Controller,
    procedure: &Procedure,
) -> Result<VerifiedLoop, PipelineError> {
    let linear = linear_plant(plant, procedure)?;
    let sampled = SampledPlant::new(&linear, plant.parameters(), resolver_use(controller))?;
    let mut systems = plants(&sampled);
    systems.extend(controllers(plant, &sampled, controller)?);
    Ok(verified_on(plant, &linear, procedure, &sampled, systems))
}

/// Returns what [`verified_loop`] does without the controllers and the loop: for one of several plants under a controller.
///
/// # Errors
/// As [`verified_loop`].
pub fn plants_of(
    plant: &Plant,
    controller: &Controller,
    procedure: &Procedure,
) -> Result<VerifiedLoop, PipelineError> {
    let linear = linear_plant(plant, procedure)?;
    let sampled = SampledPlant::new(&linear, plant.parameters(), resolver_use(controller))?;
    Ok(verified_on(plant, &linear, procedure, &sampled, plants(&sampled)))
}

/// Returns the controllers and the loop of [`verified_loop`]: for one of several controllers of a plant.
///
/// # Errors
/// As [`verified_loop`].
pub fn controllers_of(
    plant: &Plant,
    controller: &Controller,
    procedure: &Procedure,
) -> Result<Vec<SystemResult>, PipelineError> {
    let linear = linear_plant(plant, procedure)?;
    let sampled = SampledPlant::new(&linear, plant.parameters(), resolver_use(controller))?;
    let controlled = plant.parameters().controlled_quantity();
    let found = controllers(plant, &sampled, controller)?;
    Ok(found.into_iter().map(|system| system.of_loop(controlled)).collect())
}

fn verified_on(
    plant: &Plant,
    linear: &LinearPlant,
    procedure: &Procedure,
    sampled: &SampledPlant,
    systems: Vec<SystemResult>,
) -> VerifiedLoop {
    let controlled = plant.parameters().controlled_quantity();
    VerifiedLoop {
        systems: systems.into_iter().map(|system| system.of_loop(controlled)).collect(),
        control_delay_samples: plant.parameters().interface.output_delay_samples,
        reading_delays_samples: sampled.reading_delays_samples(),
        holding_v: linear.equilibrium.control_v,
        out_of_balance_kg_m: plant.body().out_of_balance_kg_m,
        balance: BalanceResult::of(plant, linear),
        settle_s: procedure.settle_s,
    }
}

/// Returns the controller with and without feedforwards, and the loop.
fn controllers(
    plant: &Plant,
    sampled: &SampledPlant,
    controller: &Controller,
) -> Result<Vec<SystemResult>, PipelineError> {
    let moment = plant.body().out_of_balance_kg_m;
    let mut systems = Vec::new();
    for (arrangement, name) in
        [(Arrangement::Compensated, "controller"), (Arrangement::Feedback, "controller_feedback_alone")]
    {
        let Some(part) = arrange_controller(controller, arrangement)? else { continue };
        let closed = ClosedLoop::new(sampled, Some(&part), moment)?;
        systems.extend(closed.controller.as_ref().map(|system| {
            SystemResult::new(name, system, &READING_NAMES[..COMMON_READINGS], &["control_v"])
        }));
        if arrangement == Arrangement::Compensated {
            systems.extend(
                closed
                    .broken
                    .as_ref()
                    .map(|system| SystemResult::new("loop", system, &["control_v"], &["returned_control_v"])),
            );
        }
    }
    Ok(systems)
}

fn plants(sampled: &SampledPlant) -> Vec<SystemResult> {
    const TRUTHS: [&str; 4] = ["hub_rate_rad_s", "tip_rate_rad_s", "motor_rate_rad_s", "current_a"];
    let readings: Vec<String> =
        READING_NAMES[..COMMON_READINGS].iter().map(|name| format!("reading_of_{name}")).collect();
    let readings: Vec<&str> = readings.iter().map(String::as_str).collect();
    let continuous: Vec<&str> = TRUTHS.iter().copied().chain(readings[1..].iter().copied()).collect();
    let discrete: Vec<&str> =
        TRUTHS.iter().copied().chain(["control_v"]).chain(readings.iter().copied()).collect();
    vec![
        SystemResult::new(
            "plant_with_sensors",
            &sampled.continuous,
            &["control_v", "heave_m_s2", "pitch_rate_rad_s"],
            &continuous,
        ),
        SystemResult::new(
            "sampled_plant",
            &sampled.sampled,
            &["demand_rad_s", "heave_m_s2", "pitch_rate_rad_s", "control_v"],
            &discrete,
        ),
    ]
}

/// Returns the time histories of a verification.
pub fn history_results(found: &Verification) -> Vec<HistoryResult> {
    let (controlled, sample_time_s) = (found.controlled_quantity(), found.evidence.sample_period_s);
    let result = |history: &History| HistoryResult { controlled, sample_time_s, history: history.clone() };
    found.evidence.histories.iter().map(result).collect()
}

/// Returns the name of a time history: the beginning of the keys of its experiment's figures.
pub(super) fn history_name(model: Model, experiment: Experiment) -> String {
    let (key, ending) = match experiment {
        Experiment::Step => {
            (PerformanceFigure::Step(model, StepFigure::Overshoot).key(), "_overshoot_percent")
        }
        Experiment::Triangle => {
            (PerformanceFigure::Triangle(model, TriangleFigure::ErrorRms).key(), "_error_rms_rad_s")
        }
        Experiment::Disturbance(source, arrangement) => (
            PerformanceFigure::Disturbance(model, source, arrangement, Quantity::HubRms).key(),
            "_hub_rms_rad_s",
        ),
        Experiment::Rest => ("rest".to_owned(), ""),
    };
    key.trim_end_matches(ending).to_owned()
}

/// Returns the frequency responses of a verification: plant, controller, loop, sensitivities and rejection ratios.
pub fn response_results(found: &Verification) -> Vec<ResponseResult> {
    let curves = &found.evidence.curves;
    let hz = &curves.frequency_hz;
    let plant = curves.plant.iter().map(|c| (format!("plant from {}", c.name), &c.response));
    let controller = curves.controller.iter().map(|c| (format!("controller, {}", c.name), &c.response));
    let broken = [("loop".to_owned(), &curves.broken.response)];
    let sensitivities = curves.sensitivities.iter().map(|c| (c.name.clone(), &c.response));
    let rejection = curves.rejection.iter().map(|one| {
        let figure = PerformanceFigure::Rejection {
            source: one.source,
            arrangement: one.arrangement,
            frequency_hz: 1.0,
        };
        let key = figure.key();
        let stem = key.split("_drr_db").next().unwrap_or_default();
        (format!("{} over platform, {stem}", found.controlled_quantity().name()), &one.response)
    });
    let all = plant.chain(controller).chain(broken).chain(sensitivities).chain(rejection);
    all.map(|(name, values)| ResponseResult::new(&name, hz, values)).collect()
}
