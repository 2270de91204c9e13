//! A run with the derivatives of its outputs.

use super::block::Block;
use super::controllers::DifferentiableController;
use super::direction::{Direction, Family, start_of};
use super::jumps::DiscreteState;
use super::port_rows::given;
use super::readings::{ReadSensor, ReadTruth, ReadingSlopes};
use super::refusal::SensitivityRefusal;
use super::step_slopes::PlantSlopes;
use crate::engine::present_plant::Sample;
use crate::engine::stepper::{Stepper, TakenStep};
use crate::engine::tables::OUTPUTS;
use crate::history::{ReadingColumn, TimeHistory, TrueColumn};
use crate::motion::MotionSample;
use crate::run::{HUB_ANGLE, Lap, PlantSample, Simulator, holding_control};
use crate::scenario::{Detail, Scenario};
use crate::sensing::Imperfections;
use crate::tolerance::DRIVE_DIFFERENCE_V;
use counterpoise_controller::{Readings, SampledController};
use counterpoise_models::plant::core::state;
use counterpoise_models::{
    AccelerometerAxis, CONVERTER_RANGE_V, Clock, DriveLimits, LearnedPlace, Parameters, Plant, Sensor,
};
use std::collections::VecDeque;

/// Number of outputs of [`OutputSlopes`].
const COLUMNS: usize = 11;

/// A run with the derivatives of its outputs.
#[derive(Debug, Clone, PartialEq)]
pub struct SensitiveRun {
    /// The run itself: the same bytes as without derivatives.
    pub history: TimeHistory,
    /// The derivatives.
    pub slopes: OutputSlopes,
}

/// The derivatives of the outputs of a run, direction by direction.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputSlopes {
    /// Of each output, sample by sample.
    columns: Vec<[Vec<f64>; COLUMNS]>,
}

impl OutputSlopes {
    /// Returns the derivatives of a reading along a direction; empty for the platform's readings and the demand, which no direction changes.
    pub fn reading(&self, direction: usize, column: ReadingColumn) -> &[f64] {
        let place = match column {
            ReadingColumn::ControlRequest => 0,
            ReadingColumn::Control => 1,
            ReadingColumn::HubRate => 2,
            ReadingColumn::MotorRate => 3,
            ReadingColumn::HubPosition => 4,
            ReadingColumn::Demand
            | ReadingColumn::PlatformRate
            | ReadingColumn::PlatformAccel
            | ReadingColumn::PlatformSurge => return &[],
        };
        &self.columns[direction][place]
    }

    /// Returns the derivatives of a true motion along a direction; empty for what no direction changes, for torques, and if the scenario keeps
    /// the recording alone.
    pub fn truth(&self, direction: usize, column: TrueColumn) -> &[f64] {
        let place = match column {
            TrueColumn::HubRate => 5,
            TrueColumn::TipRate => 6,
            TrueColumn::MotorRate => 7,
            TrueColumn::HubAngle => 8,
            TrueColumn::Voltage => 9,
            TrueColumn::WindUp => 10,
            _ => return &[],
        };
        &self.columns[direction][place]
    }
}

impl Simulator {
    /// Runs a scenario with the derivatives of its outputs along directions: in forward mode, along the steps that the run takes.
    ///
    /// # Errors
    /// [`SensitivityRefusal`]: the run is refused, or has no derivatives, with the reason.
    pub fn run_with_slopes(
        &mut self,
        controller: &mut dyn DifferentiableController,
        scenario: &Scenario,
        directions: &[Direction],
    ) -> Result<SensitiveRun, SensitivityRefusal> {
        let (plant, stepper, steps_per_sample) = self.parts();
        check_scenario(plant, scenario)?;
        let families = directions.iter().enumerate().map(|(k, one)| Family::new(plant, one, scenario, k));
        let mut families = families
            .enumerate()
            .map(|(k, one)| Ok((k, one?)))
            .collect::<Result<Vec<_>, SensitivityRefusal>>()?;
        // those that change the core are the first ones: the derivatives of its matrices then stand side by side
        families.sort_by_key(|(_, family)| !family.has_other_core);
        let (order, families) = families.into_iter().unzip();
        let lap = Lap::new(plant, scenario, stepper, steps_per_sample)?;
        let mut run = SlopeRun::new(plant, scenario, Directions { order, families }, stepper)?;
        run.go(lap, stepper, controller)
    }
}

/// Checks that a scenario has no part whose derivatives are missing.
fn check_scenario(plant: &Plant, scenario: &Scenario) -> Result<(), SensitivityRefusal> {
    let parameters = plant.parameters();
    let is_noisy = matches!(scenario.imperfections, Imperfections::NoiseAndQuantisation { .. });
    let checks = [
        ("a base that rolls, yaws or surges", scenario.platform.further.is_some()),
        ("limits of the drive by heat or slew", parameters.drive_limits != DriveLimits::default()),
        ("a clock with errors", is_noisy && parameters.interface.clock != Clock::IDEAL),
        ("an accelerometer on the hub", parameters.sensors.accelerometer_axis != AccelerometerAxis::Vertical),
    ];
    match checks.into_iter().find(|(_, there)| *there) {
        Some((part, _)) => Err(SensitivityRefusal::Part { part }),
        None => Ok(()),
    }
}

/// The directions of a run.
struct Directions {
    /// Place of each family among the directions that were asked for.
    order: Vec<usize>,
    families: Vec<Family>,
}

/// The derivatives of one run under way.
struct SlopeRun<'a> {
    /// See [`Directions`].
    order: Vec<usize>,
    scenario: &'a Scenario,
    slopes: PlantSlopes,
    count: usize,
    seen: Block,
    hub: ReadingSlopes,
    tachometer: Option<ReadingSlopes>,
    resolver: Option<ReadingSlopes>,
    readings: Vec<Readings>,
    /// Those of readings and control in the order in which the directions were asked for.
    asked: (Vec<Readings>, Vec<f64>),
    /// Derivatives of the controls that wait for the interface's delay, and of the one that acts until the first arrives.
    queue: VecDeque<Vec<f64>>,
    before: Vec<f64>,
    discrete: Option<DiscreteState>,
    columns: Vec<[Vec<f64>; COLUMNS]>,
    /// What the controller has made of the sample.
    request_v: f64,
    request: Vec<f64>,
}

impl<'a> SlopeRun<'a> {
    fn new(
        plant: &Plant,
        scenario: &'a Scenario,
        directions: Directions,
        stepper: &Stepper,
    ) -> Result<Self, SensitivityRefusal> {
        let Directions { order, families } = directions;
        let start = start_of(plant, scenario)?;
        let count = families.len();
        let holding = |member: &Plant, start: &crate::PlantState| holding_control(member, &start.core);
        let own = holding(plant, &start);
        let before = families.iter().map(|family| {
            let of = std::array::from_fn(|m| holding(&family.plants[m], &family.starts[m]));
            family.stencil.derivative(own, of)
        });
        let before = before.collect();
        let part = SensitivityRefusal::Part { part: "a machine without a sensor in its loop" };
        let read = |of: fn(&Parameters) -> Option<&Sensor>, place| {
            ReadingSlopes::new(plant, &families, ReadSensor { of, place })
        };
        let hub = read(|p| Some(&p.sensors.hub_gyro), LearnedPlace::LoopSensor).ok_or(part)?;
        let tachometer = read(|p| p.sensors.motor_tachometer.as_ref(), LearnedPlace::MotorTachometer);
        let resolver = read(|p| p.sensors.hub_resolver.as_ref(), LearnedPlace::HubResolver);
        let mut slopes = PlantSlopes::new(plant, families, stepper.period_s())?;
        slopes.restart(&start);
        Ok(Self {
            scenario,
            order,
            seen: Block::new(OUTPUTS + 1, slopes.width()),
            slopes,
            count,
            hub,
            tachometer,
            resolver,
            readings: vec![Readings::default(); count],
            asked: (vec![Readings::default(); count], vec![0.0; count]),
            queue: VecDeque::new(),
            before,
            discrete: None,
            columns: (0..count).map(|_| std::array::from_fn(|_| Vec::new())).collect(),
            request_v: 0.0,
            request: vec![0.0; count],
        })
    }

    /// Runs to the end.
    fn go(
        &mut self,
        mut lap: Lap,
        stepper: &mut Stepper,
        controller: &mut dyn DifferentiableController,
    ) -> Result<SensitiveRun, SensitivityRefusal> {
        for k in 0..lap.samples {
            let motion = lap.track.sample(lap.angle);
            let shown = PlantSample::of(stepper);
            self.read(stepper, &shown, &motion);
            let mut adapter = Adapter { run: self, controller };
            let drive_v = lap.sample(k, &mut adapter, &motion, &shown);
            self.drive(&lap, drive_v);
            let sample = Sample { drive_v, start_s: lap.time(k), motion: &motion };
            if self.scenario.detail == Detail::Everything {
                lap.log_friction(stepper.dry_torques(&sample));
            }
            self.advance(stepper, &sample)?;
            lap.finish_sample(&motion, stepper.outputs()[HUB_ANGLE]);
            lap.check(k, stepper)?;
        }
        let mut columns = vec![std::array::from_fn(|_| Vec::new()); self.count];
        for (place, own) in self.order.iter().zip(&mut self.columns) {
            columns[*place] = std::mem::take(own);
        }
        Ok(SensitiveRun { history: lap.history(stepper), slopes: OutputSlopes { columns } })
    }

    /// Reads the sensors at a sample.
    fn read(&mut self, stepper: &Stepper, shown: &PlantSample, motion: &MotionSample) {
        let present = stepper.present_plant();
        let x = present.linear().physical_state(present.core());
        self.slopes.seen_slopes(&x, &mut self.seen);
        let platform = motion.at(0.0);
        let [motor, _, hub_angle, ..] = shown.outputs;
        let motor_rate = motor - self.slopes.machine.plant.motor_share() * platform.rate;
        let coupling = &self.slopes.machine.slopes.coupling;
        let motor_slopes: Vec<f64> =
            (0..self.count).map(|k| self.seen.row(0)[k] - coupling[k] * platform.rate).collect();
        let (hub_angle_rad, angle_slopes) = (hub_angle - platform.angle, &self.seen.row(2)[..self.count]);
        let truth = |value, slopes| ReadTruth { value, slopes, heave: 0.0, hub_angle_rad, angle_slopes };
        let shown_hub = truth(shown.hub_gyro, &self.slopes.state.gyro.row(0)[..self.count]);
        let hub = self.hub.read(&ReadTruth { heave: platform.heave, ..shown_hub });
        for (readings, slope) in self.readings.iter_mut().zip(hub) {
            readings.hub_rate_rad_s = *slope;
        }
        if let Some(tachometer) = &mut self.tachometer {
            for (readings, slope) in
                self.readings.iter_mut().zip(tachometer.read(&truth(motor_rate, &motor_slopes)))
            {
                readings.motor_rate_rad_s = *slope;
            }
        }
        if let Some(resolver) = &mut self.resolver {
            let slopes = resolver.read(&truth(hub_angle_rad, angle_slopes));
            for (readings, slope) in self.readings.iter_mut().zip(slopes) {
                readings.hub_position_rad = *slope;
            }
        }
        if self.scenario.detail == Detail::Everything {
            self.log_truth(&motor_slopes);
        }
    }

    fn log_truth(&mut self, motor_slopes: &[f64]) {
        let voltage = self.slopes.state.core.row(state::VOLTAGE);
        for (k, columns) in self.columns.iter_mut().enumerate() {
            let seen = |row: usize| self.seen.row(row)[k];
            let values = [seen(3), seen(OUTPUTS), motor_slopes[k], seen(2), voltage[k], seen(1)];
            columns[5..].iter_mut().zip(values).for_each(|(column, value)| column.push(value));
        }
    }

    /// Carries the derivatives of the control through the output converter, the delay and the amplifier's static part.
    fn drive(&mut self, lap: &Lap, drive_v: f64) {
        let is_limited = self.request_v.abs() >= CONVERTER_RANGE_V;
        let control: Vec<f64> =
            self.request.iter().map(|slope| if is_limited { 0.0 } else { *slope }).collect();
        for (k, columns) in self.columns.iter_mut().enumerate() {
            let readings = &self.readings[k];
            let values = [
                self.request[k],
                control[k],
                readings.hub_rate_rad_s,
                readings.motor_rate_rad_s,
                readings.hub_position_rad,
            ];
            columns.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
        }
        let PlantSlopes { machine, state, .. } = &mut self.slopes;
        let delay = machine.plant.parameters().interface.output_delay_samples;
        self.queue.push_back(control);
        let acting = if self.queue.len() > delay { self.queue.pop_front() } else { None };
        let acting = acting.as_ref().unwrap_or(&self.before);
        let control_v = lap.acting_control_v();
        let drive = |plant: &Plant, control_v: f64| {
            plant.parameters().amplifier.drive_v(control_v, &plant.parameters().motor)
        };
        let [below, above] =
            [-DRIVE_DIFFERENCE_V, DRIVE_DIFFERENCE_V].map(|by| drive(&machine.plant, control_v + by));
        let steepness = (above - below) / (2.0 * DRIVE_DIFFERENCE_V);
        for (k, family) in machine.families.iter().enumerate() {
            let own = if family.has_other_amplifier {
                family.slope_of(&machine.plant, |member| drive(member, control_v))
            } else {
                0.0
            };
            state.given.row_mut(given::DRIVE)[k] = steepness * acting[k] + own;
        }
        self.slopes.drive_v = drive_v;
    }

    /// Moves plant and derivatives over a sample.
    fn advance(&mut self, stepper: &mut Stepper, sample: &Sample) -> Result<(), SensitivityRefusal> {
        let Self { slopes, discrete, .. } = self;
        let mut refused = None;
        stepper.advance_observed(sample, &mut |step: TakenStep| {
            if refused.is_some() {
                return;
            }
            let x = step.present.linear().physical_state(step.present.core());
            if let Some(before) = &discrete {
                let at = step.present.instant(sample, step.part.start, step.mode);
                refused = slopes.jump(before, &step, &at, &x).err();
            }
            slopes.advance(&step, &x);
            *discrete = Some(DiscreteState::of(&step));
        });
        refused.map_or(Ok(()), Err)
    }
}

/// The controller of a run as the run's loop asks it.
struct Adapter<'a, 'b> {
    run: &'a mut SlopeRun<'b>,
    controller: &'a mut dyn DifferentiableController,
}

impl SampledController for Adapter<'_, '_> {
    fn reset(&mut self) {}

    fn step(&mut self, readings: &Readings) -> f64 {
        let SlopeRun { readings: slopes, asked, request, request_v, order, .. } = &mut *self.run;
        for (slopes, place) in slopes.iter().zip(order.iter()) {
            asked.0[*place] = *slopes;
        }
        *request_v = self.controller.step(readings, &asked.0, &mut asked.1);
        for (request, place) in request.iter_mut().zip(order.iter()) {
            *request = asked.1[*place];
        }
        *request_v
    }
}
