//! The experiments of a round, with what the model predicts of each.

use counterpoise_controller::Controller;
use counterpoise_diagnose::experiment::{ExperimentExtremes, Limits};
use counterpoise_models::{Parameters, Plant};
use counterpoise_pool::{Pool, map};
use counterpoise_project::Project;
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::Simulator;
use counterpoise_simulate::replay::{reading_floor, sensor_of};
use counterpoise_verify::robustness::Distribution;
use counterpoise_verify::{Arrangement, Experiment, Procedure, Source, nonlinear_runs};

use super::machine_runs::{MachineRun, RunRequest, simulate_run};
use crate::recordings::experiment::plan_experiment;
use crate::tolerance::{BAND_FLOORS, PLANNED_SHARE};
use crate::{DesignStages, PipelineError, build_plant_model};

/// An experiment of a round.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedRun {
    /// Its name, which is that of its folder.
    pub name: &'static str,
    /// The experiment of the verification that it is; `None` for the one that is planned to tell machines apart.
    pub experiment: Option<Experiment>,
    /// The use of the recording for a replay.
    pub replay: ReplayUse,
    /// The request to the machine.
    pub request: RunRequest,
    /// The prediction of the model.
    pub predicted: Vec<PredictedChannel>,
    /// The extremes that the model and the machines within the tolerances reach: angle, rate and current.
    pub reached: ExperimentExtremes,
}

/// The experiments of a round.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedRuns {
    /// Those that keep the limits.
    pub runs: Vec<PlannedRun>,
    /// Those that leave them on the model, or on a machine within the tolerances.
    pub left_out: Vec<PlannedRun>,
}

/// The use of the recording of a run for a replay on a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReplayUse {
    /// It can: the base stands still, or its motion is recorded.
    Replayed,
    /// The base moves, and no sensor reads how: the recording shows figures alone.
    FiguresAlone,
}

/// The prediction of a channel by the model, at each sample.
#[derive(Debug, Clone, PartialEq)]
pub struct PredictedChannel {
    /// The channel.
    pub channel: Channel,
    /// With the model's own values.
    pub values: Vec<f64>,
    /// The lowest that the machines within the tolerances give, less a few noise floors.
    pub low: Vec<f64>,
    /// The highest.
    pub high: Vec<f64>,
}

/// Returns the experiments of a round: those of the verification that run the whole controller, and one that best tells apart what the model may lack.
/// Those that leave the limits on the model, or on a machine within the tolerances, are left out.
///
/// # Errors
/// Those of the simulator.
pub fn plan_runs(
    project: &Project,
    stages: &DesignStages,
    limits: Limits,
    pool: &dyn Pool,
) -> Result<PlannedRuns, PipelineError> {
    let (plant, procedure) = (&stages.modelled.plant, &stages.procedure);
    let controller = stages.verified.controller();
    let machines = machines_within_tolerances(project);
    let mut runs = Vec::new();
    for experiment in machine_experiments(project, procedure) {
        let request = request_of(plant, controller, procedure, experiment)?;
        let Some(run) = predict(plant, &machines, controller, request, pool) else { continue };
        runs.push(PlannedRun { name: run_name(experiment), experiment: Some(experiment), ..run });
    }
    // A machine on which no demand within the limits tells anything apart is known well enough for its verification's experiments.
    let room = Limits {
        angle_rad: PLANNED_SHARE * limits.angle_rad,
        rate_rad_s: PLANNED_SHARE * limits.rate_rad_s,
        current_a: PLANNED_SHARE * limits.current_a,
        ..limits
    };
    if let Ok(plan) = plan_experiment(project, None, room, pool)
        && let Some(best) = plan.experiments.into_iter().next()
    {
        let request = RunRequest {
            sample_period_s: plant.parameters().interface.sample_period_s,
            demand: best.demand,
            platform_rate_rad_s: Vec::new(),
            platform_accel_m_s2: Vec::new(),
            start_angle_rad: project.model.operating_point.hub_angle_rad,
        };
        runs.extend(predict(plant, &machines, controller, request, pool));
    }
    let (runs, left_out) = runs.into_iter().partition(|run: &PlannedRun| {
        run.reached.angle_rad <= limits.angle_rad
            && run.reached.rate_rad_s <= limits.rate_rad_s
            && run.reached.current_a <= limits.current_a
    });
    Ok(PlannedRuns { runs, left_out })
}

/// The experiments that a machine can run, with the whole controller: step and rest, and those of which the project requires a figure.
fn machine_experiments(project: &Project, procedure: &Procedure) -> Vec<Experiment> {
    let required = |experiment: &Experiment| {
        let mut all = project.verify.iter().flat_map(|asked| &asked.requirements);
        all.any(|requirement| Experiment::from_figure(requirement.figure) == *experiment)
    };
    let is_asked = |experiment: &Experiment| match experiment {
        Experiment::Step | Experiment::Rest => true,
        Experiment::Triangle | Experiment::Disturbance(..) => required(experiment),
    };
    let is_whole = |experiment: &Experiment| !matches!(experiment, Experiment::Disturbance(_, arrangement) if *arrangement != Arrangement::Compensated);
    nonlinear_runs::list_experiments(procedure).into_iter().filter(is_whole).filter(is_asked).collect()
}

fn run_name(experiment: Experiment) -> &'static str {
    match experiment {
        Experiment::Step => "step",
        Experiment::Triangle => "triangle",
        Experiment::Rest => "rest",
        Experiment::Disturbance(source, _) => match source {
            Source::Heave => "heave",
            Source::Pitch => "pitch",
            Source::Both => "heave-and-pitch",
            Source::Road => "road",
        },
    }
}

/// Returns what a machine is to do in an experiment of the verification: its demand and its motion of the base at the samples.
fn request_of(
    plant: &Plant,
    controller: &Controller,
    procedure: &Procedure,
    experiment: Experiment,
) -> Result<RunRequest, PipelineError> {
    let run = nonlinear_runs::run(&mut Simulator::new(plant)?, controller, procedure, experiment)?;
    let moves = matches!(experiment, Experiment::Disturbance(..));
    let motion = |values: &[f64]| if moves { values.to_vec() } else { Vec::new() };
    Ok(RunRequest {
        sample_period_s: run.sample_period_s,
        demand: run.readings.demand_rad_s().to_vec(),
        platform_rate_rad_s: motion(run.truth.platform_rate_rad_s()),
        platform_accel_m_s2: motion(run.truth.heave_m_s2()),
        start_angle_rad: procedure.operating_point.hub_angle_rad,
    })
}

/// Returns the machines at the ends of the tolerances. One that cannot be built is left out.
fn machines_within_tolerances(project: &Project) -> Vec<Plant> {
    let mut machines = Vec::new();
    for variation in project.variations_within_tolerances() {
        let Distribution::Uniform { low, high } = variation.distribution else { continue };
        for factor in [low, high] {
            let mut changed = project.clone();
            let scaled = variation.parameter.scale(&mut changed.plant, factor);
            machines
                .extend(scaled.ok().and_then(|()| build_plant_model(&changed).ok()).map(|model| model.plant));
        }
    }
    machines
}

/// Returns the noise floor of a machine's reading, or the step of its control.
fn noise_floor(machine: &Parameters, channel: Channel) -> f64 {
    let interface = &machine.interface;
    sensor_of(machine, channel).map_or(interface.control_step_v(), |sensor| reading_floor(sensor, interface))
}

/// Returns a run with its prediction; `None` if the model's own motion diverges.
fn predict(
    plant: &Plant,
    machines: &[Plant],
    controller: &Controller,
    request: RunRequest,
    pool: &dyn Pool,
) -> Option<PlannedRun> {
    // The model twice, with other noise: how far two runs of one machine differ.
    let all: Vec<&Plant> = [plant, plant].into_iter().chain(machines).collect();
    let ran: Vec<Option<MachineRun>> = map(pool, all.len(), |k| {
        simulate_run(all[k], &mut controller.runner(), &request, SEED + k.min(1) as u64).ok()
    });
    let mut ran = ran.into_iter();
    let (nominal, repeated) = (ran.next().flatten()?, ran.next().flatten()?);
    let mut reached = nominal.reached;
    let mut others: Vec<Recording> = Vec::new();
    for other in ran.flatten() {
        reached = reached.larger_of(&other.reached);
        others.push(other.recording);
    }
    let recorded = Channel::ALL.into_iter().filter(|channel| nominal.recording.has(*channel));
    let predicted = recorded.map(|channel| {
        let values = nominal.recording.samples(channel).unwrap_or_default().to_vec();
        let repeats = deviation(&nominal.recording, &repeated.recording, channel);
        let floor = BAND_FLOORS * noise_floor(plant.parameters(), channel).max(repeats);
        let at = |k: usize, pick: fn(f64, f64) -> f64| {
            let of_others = others.iter().filter_map(|other| other.samples(channel)?.get(k).copied());
            of_others.fold(values[k], pick)
        };
        let low = (0..values.len()).map(|k| at(k, f64::min) - floor).collect();
        let high = (0..values.len()).map(|k| at(k, f64::max) + floor).collect();
        PredictedChannel { channel, values, low, high }
    });
    let predicted = predicted.collect();
    let replay = replay_use(plant.parameters(), &request);
    Some(PlannedRun { name: IDENTIFICATION, experiment: None, replay, request, predicted, reached })
}

/// Returns the RMS of what noise makes of a channel: two runs of one machine differ by its square root of two times.
fn deviation(first: &Recording, second: &Recording, channel: Channel) -> f64 {
    let (first, second) =
        (first.samples(channel).unwrap_or_default(), second.samples(channel).unwrap_or_default());
    let squares: f64 = first.iter().zip(second).map(|(a, b)| (a - b).powi(2)).sum();
    (0.5 * squares / first.len().max(1) as f64).sqrt()
}

fn replay_use(machine: &Parameters, request: &RunRequest) -> ReplayUse {
    let moves = |values: &[f64]| values.iter().any(|value| *value != 0.0);
    let sensors = &machine.sensors;
    let pitch_is_read = !moves(&request.platform_rate_rad_s) || sensors.platform_gyro.is_fitted();
    let heave_is_read = !moves(&request.platform_accel_m_s2) || sensors.platform_accelerometer.is_fitted();
    if pitch_is_read && heave_is_read { ReplayUse::Replayed } else { ReplayUse::FiguresAlone }
}

/// Name of the run that is planned to tell machines apart.
const IDENTIFICATION: &str = "identification";
/// Seed of the noise in predictions.
const SEED: u64 = 1;
