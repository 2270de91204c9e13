//! The sampled closed loop on the nonlinear plant.

use crate::Error;
use crate::engine::ports::{Bonds, FrictionState, PlatformPoint};
use crate::engine::present::Sample;
use crate::engine::state::PlantState;
use crate::engine::stepper::Stepper;
use crate::history::{ReadingColumns, TimeHistory, TrueColumns};
use crate::motion::{MotionSample, Track};
use crate::sampling_errors::{ErrantClock, SampleError, Step};
use crate::scenario::{Detail, Initial, Scenario};
use crate::sensing::{Converter, Imperfections, Sensing, Truth};
use crate::tolerance::{DURATION_ROUNDING, MOST_ANGLE_RAD, MOST_SAMPLES, TOLERANCE};
use counterpoise_controller::{Readings, SampledController};
use counterpoise_models::plant::core::state;
use counterpoise_models::{AmplifierDynamics, Measured, Mesh, OperatingPoint, Plant};

/// Which of the stepper's outputs is the hub's angle.
const HUB_ANGLE: usize = 2;

/// A plant ready to run again and again: its stored matrices are kept from run to run.
#[derive(Debug, Clone)]
pub struct Simulator {
    plant: Plant,
    stepper: Stepper,
    steps_per_sample: Option<f64>,
}

/// Runs a plant with its controller through a scenario.
///
/// At the instants k T the sensors are read, the controller gives the control, the output converter holds it (after
/// the interface's whole samples of delay), and the plant moves to the next instant; see the crate's documentation
/// for the integrator. The controller is used as it is handed in: it is not reset.
///
/// # Errors
/// A duration that is not positive, a state of the wrong length, a friction law that the simulator does not step, and
/// a motion that grows beyond all bounds.
pub fn run(
    plant: &Plant,
    controller: &mut dyn SampledController,
    scenario: &Scenario,
) -> Result<TimeHistory, Error> {
    Simulator::new(plant)?.run(controller, scenario)
}

impl Simulator {
    /// Returns a simulator with the usual tolerance.
    ///
    /// # Errors
    /// As [`run`].
    pub fn new(plant: &Plant) -> Result<Self, Error> {
        Self::with_tolerance(plant, TOLERANCE)
    }

    /// Returns a simulator with a tolerance of its own in place of [`TOLERANCE`].
    ///
    /// # Errors
    /// As [`run`], and a tolerance that is not positive.
    pub fn with_tolerance(plant: &Plant, tolerance: f64) -> Result<Self, Error> {
        positive("tolerance", tolerance)?;
        let period_s = plant.parameters().interface.sample_period_s;
        Ok(Self {
            plant: plant.clone(),
            stepper: Stepper::new(plant, period_s, tolerance)?,
            steps_per_sample: None,
        })
    }

    /// Returns the simulator with a bound on the steps of a run, taken and tried, on the average over its samples: beyond it a run is
    /// refused ([`Error::Effort`]). For searches that try mechanisms by the thousand, of which some are unreasonably stiff.
    pub fn bounded(self, steps_per_sample: f64) -> Self {
        Self { steps_per_sample: Some(steps_per_sample), ..self }
    }

    /// Returns the plant.
    pub fn plant(&self) -> &Plant {
        &self.plant
    }

    /// Runs a scenario from its start; see [`run`].
    ///
    /// # Errors
    /// As [`run`].
    pub fn run(
        &mut self,
        controller: &mut dyn SampledController,
        scenario: &Scenario,
    ) -> Result<TimeHistory, Error> {
        self.run_while(controller, scenario, usize::MAX, &mut |_| true)
    }

    /// Runs a scenario until its end, or until `goes_on` returns `false`; it is called with the readings so far after every `every`
    /// samples.
    ///
    /// # Errors
    /// As [`run`].
    pub fn run_while(
        &mut self,
        controller: &mut dyn SampledController,
        scenario: &Scenario,
        every: usize,
        goes_on: &mut dyn FnMut(&ReadingColumns) -> bool,
    ) -> Result<TimeHistory, Error> {
        positive("duration_s", scenario.duration_s)?;
        let mut lap = Lap::new(&self.plant, scenario, &mut self.stepper)?;
        let steps = self.steps_per_sample.map_or(usize::MAX, |most| (most * lap.samples as f64) as usize);
        for k in 0..lap.samples {
            if k > 0 && k.is_multiple_of(every.max(1)) && !goes_on(&lap.readings) {
                break;
            }
            let motion = lap.track.sample(lap.angle);
            let control = lap.sample(k, controller, &motion, &self.stepper);
            let amplifier = &self.plant.parameters().amplifier;
            let drive_v = amplifier.drive_v(control, &self.plant.parameters().motor);
            lap.drive_v = drive_v;
            let sample = Sample { drive_v, start_s: lap.time(k), motion: &motion };
            if scenario.detail == Detail::Everything {
                let dry = self.stepper.dry_torques(&sample);
                lap.truth.motor_friction_nm.push(dry[0]);
                lap.truth.pivot_friction_nm.push(dry[1]);
            }
            self.stepper.advance(&sample);
            lap.sensing.advance(&motion, self.stepper.outputs()[HUB_ANGLE]);
            lap.angle = motion.at(1.0).angle;
            if !self.stepper.is_finite() {
                return Err(Error::Diverged { time_s: lap.time(k) });
            }
            if self.stepper.effort().tried() > steps {
                return Err(Error::Effort { time_s: lap.time(k), steps });
            }
        }
        Ok(TimeHistory {
            sample_period_s: lap.period_s,
            readings: lap.readings,
            truth: lap.truth,
            final_state: self.stepper.state(),
            effort: self.stepper.effort(),
        })
    }

    /// Returns the state of rest at a hub angle, on a platform at an angle and a rate: the motor holds weight and spring,
    /// and hub and platform turn together.
    pub fn rest(&self, hub_angle_rad: f64, platform_angle_rad: f64, platform_rate_rad_s: f64) -> PlantState {
        rest(&self.plant, hub_angle_rad, platform_angle_rad, platform_rate_rad_s)
    }
}

fn rest(plant: &Plant, hub_angle_rad: f64, platform_angle_rad: f64, platform_rate: f64) -> PlantState {
    let mut core = plant.equilibrium(&OperatingPoint { hub_angle_rad, platform_angle_rad }).core_state;
    core[state::RATE] = platform_rate;
    if plant.has_state(state::MOTOR) {
        core[state::MOTOR] = plant.parameters().motor.platform_coupling * platform_rate;
    }
    let position = hub_angle_rad - platform_angle_rad;
    let shown = match plant.parameters().sensors.measured {
        Measured::HubRate => platform_rate,
        Measured::RelativeRate | Measured::MotorRate => 0.0,
        Measured::HubPosition => position,
        Measured::MotorPosition => position + core[state::WINDUP],
        Measured::Torque => plant.transmitted_torque_at_rest_nm(core[state::WINDUP], position),
        Measured::Current => core[state::CURRENT],
    };
    PlantState { core, friction: FrictionState::default(), bonds: Bonds::default(), hub_gyro: [shown, 0.0] }
}

fn positive(what: &'static str, value: f64) -> Result<(), Error> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(Error::Range { what, value, allowed: "positive and finite" })
    }
}

/// What a controller made of a sample.
#[derive(Debug, Clone, Copy)]
struct Given {
    readings: Readings,
    request_v: f64,
    control_v: f64,
}

/// One run under way.
struct Lap<'a> {
    plant: &'a Plant,
    scenario: &'a Scenario,
    period_s: f64,
    samples: usize,
    angle: f64,
    track: Track<'a>,
    sensing: Sensing,
    output: Converter,
    queue: Vec<f64>,
    /// Control that acts until the first delayed one arrives: the one that holds the amplifier as it starts.
    before: f64,
    /// Drive that has acted until now, V.
    drive_v: f64,
    clock: Option<ErrantClock>,
    /// What the controller read, asked for and gave last: what a missed sample repeats.
    last: Option<Given>,
    /// The control of the sample before, as the interface delays it.
    before_v: f64,
    readings: ReadingColumns,
    truth: TrueColumns,
}

impl<'a> Lap<'a> {
    fn new(plant: &'a Plant, scenario: &'a Scenario, stepper: &mut Stepper) -> Result<Self, Error> {
        let parameters = plant.parameters();
        let period_s = parameters.interface.sample_period_s;
        let samples = (scenario.duration_s / period_s - DURATION_ROUNDING).ceil();
        if samples > MOST_SAMPLES {
            return Err(Error::Range {
                what: "duration_s",
                value: scenario.duration_s,
                allowed: "up to 1e8 samples",
            });
        }
        let angle = scenario.platform.initial_angle_rad;
        let track = Track::new(&scenario.platform, period_s, 0.0);
        let motion = track.clone().sample(angle);
        let start = motion.at(0.0);
        let mut sensing = Sensing::new(parameters, scenario.imperfections);
        let state = initial(plant, scenario, &start)?;
        stepper.restart(&state);
        sensing.settle(&motion, stepper.outputs()[HUB_ANGLE]);
        let before = holding_control(plant, &state.core);
        let clock = match scenario.imperfections {
            Imperfections::NoiseAndQuantisation { seed } => {
                ErrantClock::new(parameters.interface.clock, period_s, seed)
            }
            _ => None,
        };
        Ok(Self {
            clock,
            last: None,
            before_v: before,
            plant,
            scenario,
            period_s,
            samples: samples as usize,
            before,
            drive_v: parameters.amplifier.drive_v(before, &parameters.motor),
            angle,
            track,
            sensing,
            output: Converter::new(parameters.interface.output_bits, scenario.imperfections),
            queue: Vec::new(),
            readings: ReadingColumns::for_samples(samples as usize),
            truth: TrueColumns::default(),
        })
    }

    fn time(&self, k: usize) -> f64 {
        k as f64 * self.period_s
    }

    /// Reads, controls and logs at sample k; returns the control that acts until the next.
    fn sample(
        &mut self,
        k: usize,
        controller: &mut dyn SampledController,
        motion: &MotionSample,
        stepper: &Stepper,
    ) -> f64 {
        let time = self.time(k);
        let platform = motion.at(0.0);
        let [motor, _, hub_angle, _, _] = *stepper.outputs();
        let motor_rate = motor - self.plant.motor_share() * platform.rate;
        let hub_gyro = stepper.hub_gyro()[0];
        let truth = Truth { hub_gyro, motor_rate, hub_position: hub_angle - platform.angle };
        let error = self.clock.as_mut().map_or(SampleError::NONE, ErrantClock::next);
        let mut readings = self.sensing.read(&truth, error.offset);
        readings.demand_rad_s = self.scenario.demand_rad_s.at(time);
        let given = match (error.step, self.last) {
            (Step::Missed, Some(last)) => last,
            _ => {
                let request_v = controller.step(&readings) + self.scenario.injection_v.at(time);
                Given { readings, request_v, control_v: self.output.convert(request_v) }
            }
        };
        self.last = Some(given);
        self.log_readings(&given.readings, given.request_v, given.control_v);
        if self.scenario.detail == Detail::Everything {
            self.log_truth(&platform, motor_rate, stepper);
        }
        let control = self.delayed(given.control_v);
        let before = std::mem::replace(&mut self.before_v, control);
        if error.step == Step::Late { before } else { control }
    }

    fn delayed(&mut self, control: f64) -> f64 {
        let delay = self.plant.parameters().interface.output_delay_samples;
        if delay == 0 {
            return control;
        }
        self.queue.push(control);
        let index = self.queue.len().checked_sub(delay + 1);
        index.map_or(self.before, |k| self.queue[k])
    }

    fn log_readings(&mut self, readings: &Readings, request: f64, control: f64) {
        let columns = &mut self.readings;
        columns.demand_rad_s.push(readings.demand_rad_s);
        columns.control_request_v.push(request);
        columns.control_v.push(control);
        columns.hub_rate_rad_s.push(readings.hub_rate_rad_s);
        columns.platform_rate_rad_s.push(readings.platform_rate_rad_s);
        columns.platform_accel_m_s2.push(readings.platform_accel_m_s2);
        columns.motor_rate_rad_s.push(readings.motor_rate_rad_s);
        columns.hub_position_rad.push(readings.hub_position_rad);
        if self.plant.parameters().sensors.surge_accelerometer.is_some() {
            columns.platform_surge_m_s2.push(readings.platform_surge_m_s2);
        }
    }

    fn log_truth(&mut self, platform: &PlatformPoint, motor_rate: f64, stepper: &Stepper) {
        let [_, wind_up, hub_angle, hub_rate, current] = *stepper.outputs();
        let current = current + self.plant.direct_current_a(self.drive_v, platform.rate);
        let [voltage, tip_rate] = stepper.voltage_and_tip();
        let columns = &mut self.truth;
        columns.hub_rate_rad_s.push(hub_rate);
        columns.tip_rate_rad_s.push(tip_rate);
        columns.motor_rate_rad_s.push(motor_rate);
        columns.hub_angle_rad.push(hub_angle);
        columns.platform_angle_rad.push(platform.angle);
        columns.platform_rate_rad_s.push(platform.rate);
        columns.heave_m_s2.push(platform.heave);
        columns.current_a.push(current);
        columns.voltage_v.push(voltage);
        columns.wind_up_rad.push(wind_up);
        columns.mesh_torque_nm.push(if self.plant.is_rigid() {
            self.plant.parameters().gearbox.ratio
                * self.plant.parameters().motor.torque_constant_nm_a
                * current
        } else {
            self.plant.mesh_torque_nm(wind_up, hub_rate, motor_rate, platform.rate)
        });
        let touching = self.plant.mesh(wind_up).0 == Mesh::Touching;
        columns.contact.push(if touching { wind_up.signum() as i8 } else { 0 });
    }
}

/// Returns the control under which the amplifier's voltage stays as it is, or that holds the weight if the current is no state.
pub(crate) fn holding_control(plant: &Plant, core: &[f64]) -> f64 {
    let modelled = plant.parameters().amplifier.dynamics == AmplifierDynamics::Modelled;
    if !plant.has_state(state::CURRENT) || (modelled && !plant.has_state(state::VOLTAGE)) {
        let angle: f64 = plant.hub_angle_row().iter().zip(core).map(|(row, x)| row * x).sum();
        let point = OperatingPoint { hub_angle_rad: angle, platform_angle_rad: 0.0 };
        return plant.equilibrium(&point).control_v;
    }
    let (amplifier, motor) = (&plant.parameters().amplifier, &plant.parameters().motor);
    let drive_v = amplifier.holding_drive_v(core[state::VOLTAGE], core[state::CURRENT], motor);
    amplifier.control_v(drive_v, motor)
}

fn initial(plant: &Plant, scenario: &Scenario, start: &PlatformPoint) -> Result<PlantState, Error> {
    match &scenario.initial {
        Initial::Rest { hub_angle_rad } => Ok(rest(plant, *hub_angle_rad, start.angle, start.rate)),
        Initial::State(given) => {
            let (found, expected) = (given.core.len(), plant.core_order());
            if found != expected {
                return Err(Error::Length { what: "the initial state of the core", found, expected });
            }
            let angle = given.core[state::ANGLE];
            if angle.is_nan() || angle.abs() > MOST_ANGLE_RAD {
                let allowed = "within 1e5 rad: beyond, the displacements of presliding are lost in rounding";
                return Err(Error::Range { what: "the initial hub angle", value: angle, allowed });
            }
            Ok(given.as_ref().clone())
        }
    }
}
