//! Time histories on the nonlinear plant: friction, backlash, limits, converters and sensor noise, with the controller as exported.

use counterpoise_controller::{Controller, Readings, Runner, SampledController};
use counterpoise_models::FeedbackSignal;
use counterpoise_models::plant::{OperatingPoint, Plant};
use counterpoise_simulate::{
    Detail, Firing, FurtherMotion, Imperfections, Initial, PlatformMotion, Scenario, Signal, Simulator,
    TimeHistory, state_at_rest,
};

use crate::history::{Experiment, History, HistoryColumn, integrate};
use crate::linear_loop::arrange_controller;
use crate::{Arrangement, Error, Model, Procedure, Source, line_of_sight};

/// The source that acts on the mechanism: the controller, or the voltage that holds it.
enum MechanismInput {
    Runner(Box<Runner>),
    Constant(f64),
}

impl SampledController for MechanismInput {
    fn reset(&mut self) {
        if let MechanismInput::Runner(runner) = self {
            runner.reset();
        }
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        match self {
            MechanismInput::Runner(runner) => runner.step(readings),
            MechanismInput::Constant(volts) => *volts,
        }
    }
}

/// Returns every experiment of a procedure: step, rest and triangle with the whole controller, the disturbances in every arrangement.
pub fn list_experiments(procedure: &Procedure) -> Vec<Experiment> {
    let mut all = vec![Experiment::Step, Experiment::Rest];
    all.extend(procedure.triangle.map(|_| Experiment::Triangle));
    for source in procedure.sources() {
        all.extend(crate::ARRANGEMENTS.map(|arrangement| Experiment::Disturbance(source, arrangement)));
    }
    all
}

/// Runs one experiment. A step comes after the procedure's settling time, when friction carries its load, and the history starts
/// with it. `simulator` is kept by the caller, because it can be used again for the same plant.
///
/// # Errors
/// [`Error::Simulate`], with the motion's divergence among its kinds, and those of the controller.
pub fn run_history(
    simulator: &mut Simulator,
    controller: &Controller,
    procedure: &Procedure,
    experiment: Experiment,
) -> Result<History, Error> {
    let run = run(simulator, controller, procedure, experiment)?;
    Ok(columns_of(run, simulator.plant(), procedure, experiment))
}

/// Runs one experiment as [`run_history`] does; returns everything that the simulator keeps.
///
/// # Errors
/// As [`run_history`].
pub fn run(
    simulator: &mut Simulator,
    controller: &Controller,
    procedure: &Procedure,
    experiment: Experiment,
) -> Result<TimeHistory, Error> {
    let arrangement = match experiment {
        Experiment::Disturbance(_, arrangement) => arrangement,
        Experiment::Step | Experiment::Triangle | Experiment::Rest => Arrangement::Compensated,
    };
    let mut acting = match arrange_controller(controller, arrangement)? {
        Some(controller) => MechanismInput::Runner(Box::new(controller.runner())),
        None => MechanismInput::Constant(holding_v(simulator.plant(), &procedure.operating_point)),
    };
    run_of(simulator, &mut acting, procedure, experiment)
}

/// Runs one experiment with anything that acts once a sample: the same controller in other numbers, or on a target.
///
/// # Errors
/// As [`run_history`].
pub fn history_of(
    simulator: &mut Simulator,
    acting: &mut dyn SampledController,
    procedure: &Procedure,
    experiment: Experiment,
) -> Result<History, Error> {
    let run = run_of(simulator, acting, procedure, experiment)?;
    Ok(columns_of(run, simulator.plant(), procedure, experiment))
}

fn run_of(
    simulator: &mut Simulator,
    acting: &mut dyn SampledController,
    procedure: &Procedure,
    experiment: Experiment,
) -> Result<TimeHistory, Error> {
    let from = Start::of(simulator.plant(), procedure);
    let mut scenario = scenario(procedure, experiment);
    if let Some(reading) = from.reading.filter(|reading| *reading != 0.0) {
        let demand = std::mem::replace(&mut scenario.demand_rad_s, Signal::ZERO);
        let stands = Signal::Constant(reading);
        scenario.demand_rad_s = Signal::Sum(vec![stands, demand]);
    }
    Ok(simulator.run(acting, &scenario)?)
}

/// Returns the history of a run of an experiment on a plant.
pub(crate) fn columns_of(
    run: TimeHistory,
    plant: &Plant,
    procedure: &Procedure,
    experiment: Experiment,
) -> History {
    let history = columns(&run, experiment, &Start::of(plant, procedure));
    if experiment == Experiment::Step { history.from_time(procedure.settle_s) } else { history }
}

fn holding_v(plant: &Plant, point: &OperatingPoint) -> f64 {
    plant.equilibrium(point).control_v
}

fn scenario(procedure: &Procedure, experiment: Experiment) -> Scenario {
    let still = Scenario {
        imperfections: Imperfections::NoiseAndQuantisation { seed: procedure.seed },
        initial: Initial::Rest { hub_angle_rad: procedure.operating_point.hub_angle_rad },
        detail: Detail::Everything,
        firing: firing_in(procedure, experiment),
        ..Scenario::at_rest(procedure.duration_s)
    };
    let angle = procedure.operating_point.platform_angle_rad;
    let platform = PlatformMotion { initial_angle_rad: angle, ..PlatformMotion::STILL };
    match experiment {
        Experiment::Rest => Scenario { platform, ..still },
        Experiment::Triangle => {
            let demand_rad_s = procedure.triangle.map_or(Signal::ZERO, |triangle| triangle.signal());
            Scenario { demand_rad_s, platform, ..still }
        }
        Experiment::Step => Scenario {
            duration_s: procedure.settle_s + procedure.step.duration_s,
            demand_rad_s: Signal::step(procedure.settle_s, procedure.step.rate_rad_s),
            platform,
            ..still
        },
        Experiment::Disturbance(source, _) => Scenario {
            duration_s: procedure.duration_of(source),
            platform: moving(procedure, source, platform),
            ..still
        },
    }
}

/// A machine fires where its base moves as on duty: figures of a step, of rest and of one motion alone are those of the machine that does not.
fn firing_in(procedure: &Procedure, ran: Experiment) -> Firing {
    let on_duty = line_of_sight::sight_experiment(procedure);
    match (ran, on_duty) {
        (Experiment::Disturbance(ran, _), Experiment::Disturbance(source, _)) if ran == source => {
            Firing::Stated
        }
        _ => Firing::Silent,
    }
}

fn moving(procedure: &Procedure, source: Source, still: PlatformMotion) -> PlatformMotion {
    let sine = |sine: &crate::Sine| Signal::sine(sine.amplitude, std::f64::consts::TAU * sine.frequency_hz);
    let (heave_m_s2, pitch_rate_rad_s) = match (source, &procedure.road) {
        (Source::Heave, _) => (sine(&procedure.heave), Signal::ZERO),
        (Source::Pitch, _) => (Signal::ZERO, sine(&procedure.pitch)),
        (Source::Both, _) => (sine(&procedure.heave), sine(&procedure.pitch)),
        (Source::Road, None) => (Signal::ZERO, Signal::ZERO),
        (Source::Road, Some(road)) => {
            let samples =
                |values: &[f64]| Signal::Samples { period_s: road.sample_period_s, values: values.to_vec() };
            (samples(road.heave_m_s2()), samples(road.pitch_rate_rad_s()))
        }
    };
    let road = procedure.road.as_ref().filter(|_| source == Source::Road);
    let further = road.filter(|road| road.has_further_motion()).map(|road| {
        let samples =
            |values: &[f64]| Signal::Samples { period_s: road.sample_period_s, values: values.to_vec() };
        FurtherMotion {
            surge_m_s2: samples(road.surge_m_s2()),
            roll_rate_rad_s: samples(road.roll_rate_rad_s()),
            yaw_rate_rad_s: samples(road.yaw_rate_rad_s()),
        }
    });
    PlatformMotion { heave_m_s2, pitch_rate_rad_s, further, ..still }
}

/// The reading of the loop's sensor at rest, from which demands and histories count; `None` in a loop of rate, where that is zero.
struct Start {
    measured: FeedbackSignal,
    reading: Option<f64>,
}

impl Start {
    fn of(plant: &Plant, procedure: &Procedure) -> Self {
        let at = &procedure.operating_point;
        let measured = plant.parameters().sensors.measured;
        let reading = match measured {
            FeedbackSignal::HubRate | FeedbackSignal::RelativeRate | FeedbackSignal::MotorRate => None,
            FeedbackSignal::HubPosition | FeedbackSignal::MotorPosition => {
                Some(at.hub_angle_rad - at.platform_angle_rad)
            }
            FeedbackSignal::Torque | FeedbackSignal::Current => {
                Some(state_at_rest(plant, at.hub_angle_rad, at.platform_angle_rad, 0.0).hub_gyro[0])
            }
        };
        Self { measured, reading }
    }
}

fn columns(run: &TimeHistory, experiment: Experiment, from: &Start) -> History {
    let relative = |k: usize| run.truth.hub_angle_rad()[k] - run.truth.platform_angle_rad()[k];
    let travel_rad: Vec<f64> = (0..run.len()).map(|k| relative(k) - relative(0)).collect();
    let period_s = run.sample_period_s;
    let time_s = run.time_s();
    let truth = &run.truth;
    let about_start = |values: &[f64]| -> Vec<f64> {
        from.reading
            .map_or_else(|| values.to_vec(), |reading| values.iter().map(|value| value - reading).collect())
    };
    let demand = about_start(run.readings.demand_rad_s());
    let mut hub = match from.measured {
        FeedbackSignal::Torque => about_start(truth.mesh_torque_nm()),
        FeedbackSignal::Current => about_start(truth.current_a()),
        _ => truth.hub_rate_rad_s().to_vec(),
    };
    let mut tip = truth.tip_rate_rad_s().to_vec();
    if from.measured.is_position() {
        let beyond = tip.iter().zip(&hub).map(|(tip, hub)| tip - hub);
        let bent = integrate(beyond, period_s);
        tip = travel_rad.iter().zip(bent).map(|(hub, bent)| hub + bent).collect();
        hub.clone_from(&travel_rad);
    }
    History::zeros(Model::Nonlinear, experiment, time_s.len())
        .with(HistoryColumn::Time, time_s)
        .with(HistoryColumn::Demand, demand)
        .with(HistoryColumn::Heave, truth.heave_m_s2().iter().copied())
        .with(HistoryColumn::PitchRate, truth.platform_rate_rad_s().iter().copied())
        .with(HistoryColumn::HubRate, hub)
        .with(HistoryColumn::TipRate, tip)
        .with(HistoryColumn::Control, run.readings.control_v().iter().copied())
        .with(HistoryColumn::Current, truth.current_a().iter().copied())
        .with(HistoryColumn::Travel, travel_rad)
        .with(HistoryColumn::Contact, truth.contact().iter().map(|flank| flank.abs()))
}
