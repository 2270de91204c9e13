//! The sampled closed loop on the nonlinear plant.

use crate::Error;
use crate::drive_limits::LimitedDrive;
use crate::engine::ports::{Bonds, FrictionState, PlatformPoint};
use crate::engine::present_plant::Sample;
use crate::engine::state::PlantState;
use crate::engine::stepper::Stepper;
use crate::history::{ReadingColumns, TimeHistory, TrueColumn, TrueColumns};
use crate::motion::{MotionSample, MotionTrack};
use crate::sampling_errors::{ErrantClock, SampleError, Step};
use crate::scenario::{Detail, Initial, Scenario};
use crate::sensing::{Converter, Imperfections, Sensing, Truth};
use crate::tolerance::{DURATION_ROUNDING, MOST_ANGLE_RAD, MOST_SAMPLES, TOLERANCE};
use counterpoise_controller::{Readings, SampledController};
use counterpoise_models::plant::core::state;
use counterpoise_models::{AmplifierDynamics, FeedbackSignal, Mesh, OperatingPoint, Plant};

/// Index of the hub's angle among the stepper's outputs.
pub(crate) const HUB_ANGLE: usize = 2;

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
        require_positive("tolerance", tolerance)?;
        let period_s = plant.parameters().interface.sample_period_s;
        Ok(Self {
            plant: plant.clone(),
            stepper: Stepper::new(plant, period_s, tolerance)?,
            steps_per_sample: None,
        })
    }

    /// Returns the simulator with a bound on the steps of a run, taken and tried, on the average over its samples: beyond it a run is
    /// refused ([`Error::Effort`]). For searches that try mechanisms by the thousand, of which some are unreasonably stiff.
    pub fn with_step_bound(self, steps_per_sample: f64) -> Self {
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
        let Self { plant, stepper, steps_per_sample } = self;
        let mut lap = Lap::new(plant, scenario, stepper, *steps_per_sample)?;
        for k in 0..lap.samples {
            if k > 0 && k.is_multiple_of(every.max(1)) && !goes_on(&lap.readings) {
                break;
            }
            let motion = lap.track.sample(lap.angle);
            let drive_v = lap.sample(k, controller, &motion, &PlantSample::of(stepper));
            lap.limit_current(stepper);
            let sample = Sample { drive_v, start_s: lap.time(k), motion: &motion };
            if scenario.detail == Detail::Everything {
                lap.log_friction(stepper.dry_torques(&sample));
            }
            let before_a = lap.current_a(&motion, stepper);
            stepper.advance(&sample);
            lap.finish_sample(&motion, stepper.outputs()[HUB_ANGLE]);
            lap.heat(before_a, &motion, stepper);
            lap.check(k, stepper)?;
        }
        Ok(lap.history(stepper))
    }

    /// Returns the parts that an ensemble takes over.
    pub(crate) fn parts(&mut self) -> (&Plant, &mut Stepper, Option<f64>) {
        (&self.plant, &mut self.stepper, self.steps_per_sample)
    }

    /// Returns the state of rest at a hub angle, on a platform at an angle and a rate: the motor holds weight and spring,
    /// and hub and platform turn together.
    pub fn rest(&self, hub_angle_rad: f64, platform_angle_rad: f64, platform_rate_rad_s: f64) -> PlantState {
        state_at_rest(&self.plant, hub_angle_rad, platform_angle_rad, platform_rate_rad_s)
    }
}

/// Returns the state of rest of a plant; see [`Simulator::rest`].
pub fn state_at_rest(
    plant: &Plant,
    hub_angle_rad: f64,
    platform_angle_rad: f64,
    platform_rate: f64,
) -> PlantState {
    let mut core = plant.equilibrium(&OperatingPoint { hub_angle_rad, platform_angle_rad }).core_state;
    core[state::RATE] = platform_rate;
    if plant.has_state(state::MOTOR) {
        core[state::MOTOR] = plant.parameters().motor.platform_coupling * platform_rate;
    }
    let platform = MotionAtStart { angle_rad: platform_angle_rad, rate_rad_s: platform_rate };
    let shown = loop_sensor_input(plant, &core, platform);
    PlantState { core, friction: FrictionState::default(), bonds: Bonds::default(), hub_gyro: [shown, 0.0] }
}

/// Motion of the platform at the start of a run.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MotionAtStart {
    /// Angle, rad.
    pub angle_rad: f64,
    /// Rate, rad/s.
    pub rate_rad_s: f64,
}

/// Returns what the loop's sensor is given in a state of the mechanism, in its unit.
pub(crate) fn loop_sensor_input(plant: &Plant, core: &[f64], platform: MotionAtStart) -> f64 {
    let parameters = plant.parameters();
    let position = core[state::ANGLE] - platform.angle_rad;
    let relative_rate = core[state::RATE] - platform.rate_rad_s;
    let motor_rate = if plant.has_mechanism_state(state::MOTOR) {
        let coupling = parameters.motor.platform_coupling;
        (core[state::MOTOR] - coupling * platform.rate_rad_s) / parameters.gearbox.ratio
    } else {
        relative_rate
    };
    match parameters.sensors.measured {
        FeedbackSignal::HubRate => core[state::RATE],
        FeedbackSignal::RelativeRate => relative_rate,
        FeedbackSignal::MotorRate => motor_rate,
        FeedbackSignal::HubPosition => position,
        FeedbackSignal::MotorPosition => position + core[state::WINDUP],
        FeedbackSignal::Torque => {
            plant.transmitted_torque_at_rest_nm(core[state::WINDUP], position)
                + parameters.gearbox.damping_nm_s_rad * (motor_rate - relative_rate)
        }
        FeedbackSignal::Current => core[state::CURRENT],
    }
}

pub(crate) fn require_positive(what: &'static str, value: f64) -> Result<(), Error> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(Error::Range { what, value, allowed: "positive and finite" })
    }
}

/// The control that a controller made of a sample.
#[derive(Debug, Clone, Copy)]
struct ControllerSample {
    readings: Readings,
    request_v: f64,
    control_v: f64,
}

/// The values that a sample shows of a plant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlantSample {
    /// Motor state, wind-up, hub angle, hub rate, current.
    pub outputs: [f64; 5],
    /// Voltage of the amplifier and rate of the tip.
    pub voltage_and_tip: [f64; 2],
    /// Reading of the loop's sensor.
    pub hub_gyro: f64,
}

impl PlantSample {
    /// Returns what a plant shows.
    pub fn of(stepper: &Stepper) -> Self {
        Self {
            outputs: *stepper.outputs(),
            voltage_and_tip: stepper.voltage_and_tip(),
            hub_gyro: stepper.hub_gyro()[0],
        }
    }
}

/// One run under way.
pub(crate) struct Lap<'a> {
    plant: &'a Plant,
    scenario: &'a Scenario,
    period_s: f64,
    /// Number of samples.
    pub samples: usize,
    /// Most steps that may be tried.
    most_steps: usize,
    /// Angle of the platform at the start of the next sample, rad.
    pub angle: f64,
    /// The platform's motion.
    pub track: MotionTrack<'a>,
    sensing: Sensing,
    output: Converter,
    queue: Vec<f64>,
    /// Control that acts until the first delayed one arrives: the one that holds the amplifier as it starts.
    before: f64,
    /// Drive that has acted until now, V.
    drive_v: f64,
    clock: Option<ErrantClock>,
    /// The readings, the demand and the control of the last step: what a missed sample repeats.
    last: Option<ControllerSample>,
    /// The control of the sample before, as the interface delays it.
    before_v: f64,
    readings: ReadingColumns,
    truth: TrueColumns,
    /// The drive, if its limits hold.
    limited: Option<LimitedDrive>,
    /// Lowest and highest current that they leave over the sample, A.
    range_a: Option<[f64; 2]>,
}

impl<'a> Lap<'a> {
    /// Begins a run, with a bound on its steps as [`Simulator::with_step_bound`] has it.
    pub fn new(
        plant: &'a Plant,
        scenario: &'a Scenario,
        stepper: &mut Stepper,
        steps_per_sample: Option<f64>,
    ) -> Result<Self, Error> {
        require_positive("duration_s", scenario.duration_s)?;
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
        let track = MotionTrack::new(&scenario.platform, period_s, 0.0);
        let motion = track.clone().sample(angle);
        let start = motion.at(0.0);
        let mut sensing = Sensing::new(parameters, scenario.imperfections);
        let state = initial_state(plant, scenario, start.angle, start.rate)?;
        stepper.restart(&state);
        stepper.fire(scenario.firing);
        stepper.limit_current(None);
        sensing.settle_sensors(&motion, stepper.outputs()[HUB_ANGLE], state.hub_gyro[1] * period_s);
        let before = holding_control(plant, &state.core);
        let limited = LimitedDrive::new(parameters, before);
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
            most_steps: steps_per_sample.map_or(usize::MAX, |most| (most * samples) as usize),
            before,
            drive_v: parameters.amplifier.drive_v(before, &parameters.motor),
            angle,
            track,
            sensing,
            output: Converter::new(parameters.interface.output_bits, scenario.imperfections),
            queue: Vec::new(),
            readings: ReadingColumns::of_machine(parameters, samples as usize),
            truth: empty_truth(scenario.detail, limited.as_ref(), samples as usize),
            limited,
            range_a: None,
        })
    }

    /// Returns the instant of a sample, s.
    pub fn time(&self, k: usize) -> f64 {
        k as f64 * self.period_s
    }

    /// Reads, controls and logs at sample k; returns the drive of the amplifier that acts until the next, V.
    pub fn sample(
        &mut self,
        k: usize,
        controller: &mut dyn SampledController,
        motion: &MotionSample,
        shown: &PlantSample,
    ) -> f64 {
        let time = self.time(k);
        let platform = motion.at(0.0);
        let [motor, _, hub_angle, hub_rate, _] = shown.outputs;
        let motor_rate = match self.plant.lever_at(hub_angle - platform.angle) {
            Some(lever) => lever.arm_m * (hub_rate - platform.rate),
            None => motor - self.plant.motor_share() * platform.rate,
        };
        let truth = Truth { hub_gyro: shown.hub_gyro, motor_rate, hub_position: hub_angle - platform.angle };
        let error = self.clock.as_mut().map_or(SampleError::NONE, ErrantClock::next);
        let mut readings = self.sensing.read(&truth, error.offset);
        readings.demand_rad_s = self.scenario.demand_rad_s.at(time);
        let given = match (error.step, self.last) {
            (Step::Missed, Some(last)) => last,
            _ => {
                let request_v = controller.step(&readings) + self.scenario.injection_v.at(time);
                ControllerSample { readings, request_v, control_v: self.output.convert(request_v) }
            }
        };
        self.last = Some(given);
        self.log_readings(&given.readings, given.request_v, given.control_v);
        if self.scenario.detail == Detail::Everything {
            self.log_truth(&platform, motor_rate, shown);
        }
        let control = self.delay_control(given.control_v);
        let before = std::mem::replace(&mut self.before_v, control);
        let control = if error.step == Step::Late { before } else { control };
        let control = self.limit_control(control, motor_rate);
        let parameters = self.plant.parameters();
        self.drive_v = parameters.amplifier.drive_v(control, &parameters.motor);
        self.drive_v
    }

    /// Returns the readings so far.
    pub fn readings(&self) -> &ReadingColumns {
        &self.readings
    }

    /// Logs the dry friction torques at motor and pivot, N m.
    pub fn log_friction(&mut self, [motor_nm, pivot_nm]: [f64; 2]) {
        self.truth.signals.set_newest(TrueColumn::MotorFriction, motor_nm);
        self.truth.signals.set_newest(TrueColumn::PivotFriction, pivot_nm);
    }

    /// Moves the sensors and the platform over a sample, at whose end the hub stands at an angle.
    pub fn finish_sample(&mut self, motion: &MotionSample, hub_angle_rad: f64) {
        self.sensing.advance(motion, hub_angle_rad);
        self.angle = motion.at(1.0).angle;
    }

    /// Checks a plant after sample k.
    pub fn check(&self, k: usize, stepper: &Stepper) -> Result<(), Error> {
        if !stepper.is_finite() {
            return Err(Error::Diverged { time_s: self.time(k) });
        }
        if stepper.effort().count_tried() > self.most_steps {
            return Err(Error::Effort { time_s: self.time(k), steps: self.most_steps });
        }
        Ok(())
    }

    /// Returns what the run leaves, with the plant as it is at its end.
    pub fn history(&mut self, stepper: &Stepper) -> TimeHistory {
        TimeHistory {
            sample_period_s: self.period_s,
            readings: std::mem::take(&mut self.readings),
            truth: std::mem::take(&mut self.truth),
            final_state: stepper.state(),
            effort: stepper.effort(),
        }
    }

    /// Returns the control that the limits of the drive leave at a rate of the motor, and keeps the current that they leave over the sample.
    fn limit_control(&mut self, control_v: f64, motor_rate: f64) -> f64 {
        let Some(drive) = &mut self.limited else { return control_v };
        self.range_a = drive.range_a(motor_rate);
        if self.scenario.detail == Detail::Everything {
            let [lowest_a, highest_a] = self.range_a.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
            let columns = &mut self.truth.signals;
            columns.set_newest(TrueColumn::Winding, drive.heat().winding_k);
            columns.set_newest(TrueColumn::Overload, drive.heat().overload_a2);
            columns.set_newest(TrueColumn::LowestCurrent, lowest_a);
            columns.set_newest(TrueColumn::HighestCurrent, highest_a);
        }
        drive.slew(control_v)
    }

    /// Sets the current that the limits of the drive leave over the sample.
    pub fn limit_current(&self, stepper: &mut Stepper) {
        if self.limited.is_some() {
            stepper.limit_current(self.range_a);
        }
    }

    /// Returns the motor's current at the present state, A; 0 if no limit of the drive depends on it.
    pub fn current_a(&self, motion: &MotionSample, stepper: &Stepper) -> f64 {
        if self.limited.is_none() {
            return 0.0;
        }
        stepper.outputs()[4] + self.plant.direct_current_a(self.drive_v, motion.at(0.0).rate)
    }

    /// Heats the drive over a sample that was taken.
    pub fn heat(&mut self, before_a: f64, motion: &MotionSample, stepper: &Stepper) {
        let Some(drive) = &mut self.limited else { return };
        let after_a = stepper.outputs()[4] + self.plant.direct_current_a(self.drive_v, motion.at(1.0).rate);
        drive.advance([before_a, after_a]);
    }

    fn delay_control(&mut self, control: f64) -> f64 {
        let delay = self.plant.parameters().interface.output_delay_samples;
        if delay == 0 {
            return control;
        }
        self.queue.push(control);
        let index = self.queue.len().checked_sub(delay + 1);
        index.map_or(self.before, |k| self.queue[k])
    }

    /// Returns the control that acts over the sample, after the interface's delay, V.
    pub fn acting_control_v(&self) -> f64 {
        self.before_v
    }

    fn log_readings(&mut self, readings: &Readings, request: f64, control: f64) {
        // in the order of `ReadingColumn`
        self.readings.signals.push([
            readings.demand_rad_s,
            request,
            control,
            readings.hub_rate_rad_s,
            readings.platform_rate_rad_s,
            readings.platform_accel_m_s2,
            readings.motor_rate_rad_s,
            readings.hub_position_rad,
            readings.platform_surge_m_s2,
        ]);
    }

    fn log_truth(&mut self, platform: &PlatformPoint, motor_rate: f64, shown: &PlantSample) {
        let [_, wind_up, hub_angle, hub_rate, current] = shown.outputs;
        let lever = self.plant.lever_at(hub_angle - platform.angle).map(|lever| lever.arm_m);
        // with a cylinder the valve's opening stands there
        let wind_up = if lever.is_some() { 0.0 } else { wind_up };
        let current = current + self.plant.direct_current_a(self.drive_v, platform.rate);
        let [voltage, tip_rate] = shown.voltage_and_tip;
        let mesh_torque_nm = if self.plant.is_rigid() {
            lever.unwrap_or(self.plant.parameters().gearbox.ratio)
                * self.plant.parameters().motor.torque_constant_nm_a
                * current
        } else {
            self.plant.mesh_torque_nm(wind_up, hub_rate, motor_rate, platform.rate)
        };
        let touching = self.plant.mesh(wind_up).0 == Mesh::Touching;
        // in the order of `TrueColumn`; friction and the drive's limits follow as soon as they are known
        self.truth.signals.push([
            hub_rate,
            tip_rate,
            motor_rate,
            hub_angle,
            platform.angle,
            platform.rate,
            platform.heave,
            current,
            voltage,
            wind_up,
            mesh_torque_nm,
            if touching { wind_up.signum() } else { 0.0 },
        ]);
    }
}

/// Returns the columns of what will be true, without samples: those of the drive's limits are there if the drive has limits.
fn empty_truth(detail: Detail, limited: Option<&LimitedDrive>, samples: usize) -> TrueColumns {
    let last = if limited.is_some() { TrueColumn::HighestCurrent } else { TrueColumn::PivotFriction };
    match detail {
        Detail::Everything => TrueColumns::columns_to(last, samples),
        Detail::Recording => TrueColumns::default(),
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

/// Returns the state from which a scenario starts a plant on a platform at an angle and a rate.
///
/// # Errors
/// [`Error::Length`] for a state of another plant, [`Error::Range`] for an angle beyond what the displacements of presliding bear.
pub(crate) fn initial_state(
    plant: &Plant,
    scenario: &Scenario,
    platform_angle_rad: f64,
    platform_rate: f64,
) -> Result<PlantState, Error> {
    match &scenario.initial {
        Initial::Rest { hub_angle_rad } => {
            Ok(state_at_rest(plant, *hub_angle_rad, platform_angle_rad, platform_rate))
        }
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
