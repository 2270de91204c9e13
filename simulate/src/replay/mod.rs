//! Replay of a recording with the model: the residuals of the simulated channels.
//!
//! The platform's motion comes from its sensors ([`platform`]), the start of the recording from its first moments
//! ([`start`]), the control from the recorded controller acting on the simulated hub (closed loop) or from the
//! recording (open loop). The run is without noise and without quantisation: the residual of a perfect model is the
//! recording's own noise, whose RMS is the noise floor.

mod control;
mod exported_controller;
mod first_motion;
mod initial_controller_state;
mod normal_equations;
pub mod platform;
mod recorded_controller;
mod recorded_readings;
mod slopes;
pub(crate) mod smoother;
pub mod start;
mod windowed_replay;
mod windows;

pub use control::control_fit;
pub use exported_controller::ExportedController;
pub use platform::{platform_motion, reading_floor, sensor_of};
pub use recorded_controller::RecordedController;
pub use slopes::{ReplayDirection, ReplayMember, SlopedReplay};
pub use start::{UNKNOWNS as START_FREEDOMS, start_has};
pub use windowed_replay::{Divergence, ReplayMode, SelectedReplay, WINDOW_S};

use self::exported_controller::FittedStart;
use crate::Error;
use crate::ensemble::{EnsembleRun, run_ensemble};
use crate::firing::Firing;
use crate::history::{ReadingColumns, TimeHistory};
use crate::run::Simulator;
use crate::scenario::{Detail, Initial, Scenario};
use crate::sensing::Imperfections;
use crate::signal::{LOOK_AHEAD, Signal};
use crate::tolerance::SAME_PERIOD;
use crate::{PlantState, PlatformMotion};
use counterpoise_controller::{ProportionalIntegral, Readings, SampledController};
use counterpoise_models::plant::Body;
use counterpoise_models::plant::core::state;
use counterpoise_models::{Parameters, Plant};
use counterpoise_recordings::{Channel, Recording};

/// The channels that a replay compares, in the order of its results.
pub const COMPARED: [Channel; 6] = [
    Channel::Control,
    Channel::HubRate,
    Channel::PlatformRate,
    Channel::PlatformAccel,
    Channel::MotorRate,
    Channel::HubPosition,
];

/// Source of the control of a replay.
#[derive(Debug, Clone, PartialEq)]
pub enum ReplayLoop {
    /// The recorded controller acts on the simulated readings; its state at the start is found from the recording.
    Closed(RecordedController),
    /// The recorded control is played back.
    Open,
}

impl ReplayLoop {
    /// Returns how a recording of a mechanism under a controller is replayed: in closed loop, or with the recorded control if the loop controls
    /// a torque or a current.
    ///
    /// Such a loop holds neither rate nor angle. The motion that the noise of its sensor and the rounding of its control once caused goes on
    /// as an undamped oscillation or a slow decay; a run with other noise has another, and differs from the recording by many noise floors
    /// although nothing is wrong. Under the recorded control the mechanism repeats its motion.
    pub fn from_controller(parameters: &Parameters, controller: RecordedController) -> Self {
        if parameters.sensors.measured.is_effort() { Self::Open } else { Self::Closed(controller) }
    }
}

impl From<&ProportionalIntegral> for ReplayLoop {
    fn from(controller: &ProportionalIntegral) -> Self {
        Self::Closed(controller.clone().into())
    }
}

impl From<RecordedController> for ReplayLoop {
    fn from(controller: RecordedController) -> Self {
        Self::Closed(controller)
    }
}

/// A recording compared with its simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Replay {
    /// Fit of each recorded channel.
    pub channels: Vec<ChannelFit>,
    /// The simulated readings.
    pub simulated: ReadingColumns,
    /// The state from which the simulation started.
    pub start: PlantState,
}

/// A mechanism to be replayed beside others.
#[derive(Debug, Clone, Copy)]
pub struct ReplayVariant<'p> {
    /// The mechanism.
    pub parameters: &'p Parameters,
    /// The start of a similar mechanism.
    pub start: &'p PlantState,
    /// By how many of their step sizes the freedoms of that start are moved, as [`Replayer::replay_nudged`] does; `None` if the replay
    /// starts there itself.
    pub steps: Option<[f64; START_FREEDOMS]>,
}

/// A replay that is asked for beside others, of this recording or of another.
#[derive(Clone, Copy)]
pub struct ReplayRequest<'r, 'a> {
    /// The recording.
    pub replayer: &'r Replayer<'a>,
    /// The loop.
    pub control: &'r ReplayLoop,
    /// The mechanism.
    pub variant: ReplayVariant<'r>,
}

/// Carries out replays side by side, each once: what each gives has the same bytes as [`Replayer::replay_from`] and [`Replayer::replay_nudged`] give.
///
/// # Errors
/// Request by request, as [`replay`].
pub fn replay_each<'a>(requests: &[ReplayRequest<'_, 'a>]) -> Vec<Result<Replay, Error>> {
    let ready = requests.iter().map(|one| one.replayer.prepare_variant(one.control, &one.variant));
    let mut ready: Vec<Result<ReadyVariant<'a>, Error>> = ready.collect();
    let possible = ready.iter_mut().filter_map(|one| one.as_mut().ok());
    let mut runs: Vec<EnsembleRun> = possible
        .map(|one| EnsembleRun {
            simulator: &mut one.simulator,
            controller: one.controller.as_mut(),
            scenario: &one.scenario,
            watch: None,
        })
        .collect();
    let mut histories = run_ensemble(&mut runs).into_iter();
    drop(runs);
    let replay = |(one, asked): (Result<ReadyVariant, Error>, &ReplayRequest)| {
        let ReadyVariant { simulator, start, .. } = one?;
        let history = histories.next().unwrap_or(Err(Error::NoChannel { channel: "samples" }))?;
        Ok(asked.replayer.compare_channels(simulator.plant(), asked.control, history, start))
    };
    ready.into_iter().zip(requests).map(replay).collect()
}

/// A mechanism that is ready to be replayed.
struct ReadyVariant<'a> {
    simulator: Simulator,
    start: PlantState,
    scenario: Scenario,
    controller: Box<dyn SampledController + 'a>,
}

/// Fit of one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelFit {
    /// Channel.
    pub channel: Channel,
    /// RMS of the residual, recorded - simulated, in the channel's unit.
    pub rms_error: f64,
    /// Noise floor: RMS of the residual of a perfect model, from noise and quantisation of the project's sensors, in the channel's unit.
    pub floor: f64,
    /// RMS of the white noise in the recording itself, from its third differences: a check on the floor. An
    /// overestimate if the channel moves fast.
    pub white_noise: f64,
    /// Variance accounted for, percent: 100 (1 - var(residual) / var(recorded)).
    pub vaf: f64,
}

impl ChannelFit {
    /// Returns the RMS of the residual over the noise floor.
    pub fn residual_over_floor(&self) -> f64 {
        self.rms_error / self.floor
    }
}

/// Replays a recording.
///
/// # Errors
/// A mechanism that cannot be simulated, a recording without samples, without the demand (closed loop) or the
/// control (open loop), a sample period that is not the interface's, columns of different lengths.
pub fn replay(parameters: &Parameters, recording: &Recording, control: &ReplayLoop) -> Result<Replay, Error> {
    Replayer::new(parameters, recording)?.replay(parameters, control)
}

/// A recording made ready for replays with one mechanism after another, as long as the platform's sensors are the
/// same: their readings are deconvolved once.
#[derive(Debug, Clone)]
pub struct Replayer<'a> {
    recording: &'a Recording,
    sensed: platform::PlatformSensorInputs,
    platform: PlatformMotion,
    samples: usize,
    steps_per_sample: f64,
    /// The state of an exported controller at the first sample.
    fitted: FittedStart,
    /// The structure, if it is not that of the mechanism's two inertias.
    body: Option<Body>,
    imperfections: Imperfections,
}

impl<'a> Replayer<'a> {
    /// Reconstructs the platform's motion.
    ///
    /// # Errors
    /// As [`replay`].
    pub fn new(parameters: &Parameters, recording: &'a Recording) -> Result<Self, Error> {
        let samples = recording.len();
        if samples == 0 {
            return Err(Error::NoChannel { channel: "samples" });
        }
        for channel in COMPARED.into_iter().chain([Channel::Demand]) {
            check_length(channel.name(), recording.samples(channel), samples)?;
        }
        let period = parameters.interface.sample_period_s;
        if (recording.sample_period_s / period - 1.0).abs() > SAME_PERIOD {
            let allowed = "the sample period of the interface";
            return Err(Error::Range { what: "sample_period_s", value: recording.sample_period_s, allowed });
        }
        let sensed = platform::PlatformSensorInputs::new(parameters, recording, None);
        let platform = sensed.motion(parameters, period);
        let fitted = FittedStart::default();
        let (steps_per_sample, imperfections) = (f64::INFINITY, Imperfections::None);
        Ok(Self { recording, sensed, platform, samples, steps_per_sample, fitted, body: None, imperfections })
    }

    /// Returns the same with a bound on the steps of a run: see [`Simulator::with_step_bound`].
    pub fn with_step_bound(self, steps_per_sample: f64) -> Self {
        Self { steps_per_sample, ..self }
    }

    /// Returns the same with the platform's motion computed over every sample: for many replays of one recording.
    pub fn with_motion_computed(self) -> Self {
        let platform = self.platform.with_courses(self.recording.sample_period_s, self.samples);
        Self { platform, ..self }
    }

    /// Returns the same with readings and a control that are rounded as the project's converters do. A replay without rounding differs from it
    /// by more than the noise floor if a loop under dry friction waits for the next count.
    pub fn with_rounded_readings(self) -> Self {
        Self { imperfections: Imperfections::Quantisation, ..self }
    }

    /// Returns the same with the readings' noise and rounding, drawn from a seed: it simulates what the model itself would have recorded.
    fn with_noise_of(self, seed: u64) -> Self {
        Self { imperfections: Imperfections::NoiseAndQuantisation { seed }, ..self }
    }

    /// Returns the same on another structure than that of two inertias: with the modes of finite elements, for instance. The rotor behind a rigid
    /// transmission belongs to it.
    pub fn with_whole_body(self, body: Body) -> Self {
        Self { body: Some(body), ..self }
    }

    /// Returns the plant of a mechanism.
    fn plant(&self, parameters: &Parameters) -> Result<Plant, Error> {
        Ok(match &self.body {
            Some(body) => Plant::with_whole_body(parameters, body.clone())?,
            None => Plant::from_lumped(parameters)?,
        })
    }

    /// Returns a simulator of a plant with that bound.
    fn simulator(&self, plant: &Plant) -> Result<Simulator, Error> {
        Ok(Simulator::new(plant)?.with_step_bound(self.steps_per_sample))
    }

    /// Returns the same recording seen by other sensors of the platform: their readings are deconvolved again only if a
    /// sensor's dynamics or noise are others.
    pub fn with_platform_sensors_of(&self, parameters: &Parameters) -> Self {
        let sensed = platform::PlatformSensorInputs::new(parameters, self.recording, Some(&self.sensed));
        let platform = sensed.motion(parameters, self.recording.sample_period_s);
        Self { sensed, platform, fitted: self.fitted.clone(), body: self.body.clone(), ..*self }
    }

    /// Returns the same with an exported controller that starts in the state that another recording of the same run shows: for copies
    /// of a recording that differ from it in noise.
    pub fn with_controller_start_of(self, other: &Replayer) -> Self {
        Self { fitted: other.fitted.clone(), ..self }
    }

    /// Returns the recording.
    pub fn recording(&self) -> &Recording {
        self.recording
    }

    /// Returns the reconstructed motion of the platform.
    pub fn platform(&self) -> &PlatformMotion {
        &self.platform
    }

    /// Replays the recording with a mechanism.
    ///
    /// # Errors
    /// As [`replay`].
    pub fn replay(&self, parameters: &Parameters, control: &ReplayLoop) -> Result<Replay, Error> {
        let plant = self.plant(parameters)?;
        self.replay_plant(&plant, control)
    }

    /// Replays the recording with a mechanism whose start is sought from that of a similar mechanism: this is faster than
    /// [`Self::replay`], which seeks it from the recording alone.
    ///
    /// # Errors
    /// As [`replay`].
    pub fn replay_near(
        &self,
        parameters: &Parameters,
        control: &ReplayLoop,
        near: &PlantState,
    ) -> Result<Replay, Error> {
        let plant = self.plant(parameters)?;
        let mut simulator = self.simulator(&plant)?;
        let start = start::refine(&mut simulator, self, near)?;
        self.run_settled(&plant, simulator, control, start)
    }

    /// Replays the recording with a plant, whatever its structure.
    ///
    /// # Errors
    /// As [`replay`].
    pub fn replay_plant(&self, plant: &Plant, control: &ReplayLoop) -> Result<Replay, Error> {
        let mut simulator = self.simulator(plant)?;
        let start = start::estimate(&mut simulator, self)?;
        self.run_settled(plant, simulator, control, start)
    }

    /// Runs from a start, and once more if the hub's angle was off over the whole recording.
    fn run_settled(
        &self,
        plant: &Plant,
        mut simulator: Simulator,
        control: &ReplayLoop,
        mut start: PlantState,
    ) -> Result<Replay, Error> {
        let mut history = self.run(&mut simulator, control, &start)?;
        let knows_position = matches!(control, ReplayLoop::Closed(controller) if controller.knows_position());
        let offset = self.position_offset(&history).filter(|_| !knows_position);
        if let (ReplayLoop::Closed(_), Some(offset)) = (control, offset) {
            start.core[state::ANGLE] -= offset;
            history = self.run(&mut simulator, control, &start)?;
        }
        Ok(self.compare_channels(plant, control, history, start))
    }

    /// Replays the recording once from a given start: that of a similar mechanism, when many are tried.
    ///
    /// # Errors
    /// As [`replay`].
    pub fn replay_from(
        &self,
        parameters: &Parameters,
        control: &ReplayLoop,
        start: &PlantState,
    ) -> Result<Replay, Error> {
        let plant = self.plant(parameters)?;
        let history = self.run(&mut self.simulator(&plant)?, control, start)?;
        Ok(self.compare_channels(&plant, control, history, start.clone()))
    }

    /// Replays the recording once from a given start whose freedoms (those of [`start_has`]) are moved by `steps` of their step sizes: for fits of start and mechanism together.
    ///
    /// # Errors
    /// As [`replay`].
    pub fn replay_nudged(
        &self,
        parameters: &Parameters,
        control: &ReplayLoop,
        near: &PlantState,
        steps: &[f64; START_FREEDOMS],
    ) -> Result<Replay, Error> {
        let plant = self.plant(parameters)?;
        let mut simulator = self.simulator(&plant)?;
        let start = start::nudge_start(&mut simulator, self, near, steps);
        let history = self.run(&mut simulator, control, &start)?;
        Ok(self.compare_channels(&plant, control, history, start))
    }

    /// Makes a mechanism ready to be replayed.
    fn prepare_variant(
        &self,
        control: &ReplayLoop,
        variant: &ReplayVariant,
    ) -> Result<ReadyVariant<'a>, Error> {
        let mut simulator = self.simulator(&self.plant(variant.parameters)?)?;
        let start = match &variant.steps {
            Some(steps) => start::nudge_start(&mut simulator, self, variant.start, steps),
            None => variant.start.clone(),
        };
        let controller: Box<dyn SampledController + 'a> = match control {
            ReplayLoop::Open => Box::new(self.playback()?),
            ReplayLoop::Closed(controller) => controller.at_start_of(self.recording, &self.fitted)?,
        };
        Ok(ReadyVariant { scenario: self.scenario(self.samples, &start), simulator, start, controller })
    }

    /// Returns the fits of a run.
    fn compare_channels(
        &self,
        plant: &Plant,
        control: &ReplayLoop,
        history: TimeHistory,
        start: PlantState,
    ) -> Replay {
        let channels = self.fits(plant.parameters(), control, &history.readings);
        Replay { channels, simulated: history.readings, start }
    }

    /// Returns how well simulated readings fit the recording, channel by channel.
    fn fits(
        &self,
        parameters: &Parameters,
        control: &ReplayLoop,
        simulated: &ReadingColumns,
    ) -> Vec<ChannelFit> {
        let floors = Floors { parameters, control };
        let one = |channel: Channel| {
            let floor = floors.of(channel)?;
            fit(channel, simulated.channel(channel), self.recording.samples(channel)?, floor)
        };
        COMPARED.into_iter().filter_map(one).collect()
    }

    fn run(
        &self,
        simulator: &mut Simulator,
        control: &ReplayLoop,
        start: &PlantState,
    ) -> Result<TimeHistory, Error> {
        let scenario = self.scenario(self.samples, start);
        match control {
            ReplayLoop::Open => simulator.run(&mut self.playback()?, &scenario),
            ReplayLoop::Closed(controller) => {
                let mut ready = controller.at_start_of(self.recording, &self.fitted)?;
                simulator.run(ready.as_mut(), &scenario)
            }
        }
    }

    /// Returns by how much the simulated hub position exceeds the recorded one on the average of the whole recording: a rate loop does not know its angle, and the
    /// first moments do not fix it better than the resolver's noise.
    fn position_offset(&self, history: &TimeHistory) -> Option<f64> {
        let recorded = self.recording.samples(Channel::HubPosition)?;
        let differences = history.readings.hub_position_rad().iter().zip(recorded).map(|(s, r)| s - r);
        let (sum, count) =
            differences.filter(|d| d.is_finite()).fold((0.0, 0.0), |(s, c), d| (s + d, c + 1.0));
        (count > 0.0).then(|| sum / count)
    }

    /// Returns the scenario of the first samples from a start. Signals are copied no further than the run looks: the fit of a start runs
    /// hundreds of times over the first moments of what may be an hour.
    pub(crate) fn scenario(&self, samples: usize, start: &PlantState) -> Scenario {
        let period = self.recording.sample_period_s;
        let demand = self.recording.samples(Channel::Demand).unwrap_or_default();
        let demand = demand[..demand.len().min(samples + LOOK_AHEAD)].to_vec();
        let platform = PlatformMotion {
            pitch_rate_rad_s: self.platform.pitch_rate_rad_s.part(0..samples),
            heave_m_s2: self.platform.heave_m_s2.part(0..samples),
            initial_angle_rad: self.platform.initial_angle_rad,
            further: self.platform.further.as_ref().map(|further| further.part(0..samples)),
        };
        Scenario {
            duration_s: samples as f64 * period,
            demand_rad_s: Signal::Held { period_s: period, values: demand },
            injection_v: Signal::ZERO,
            platform,
            imperfections: self.imperfections,
            initial: Initial::State(Box::new(start.clone())),
            detail: Detail::Recording,
            firing: Firing::Stated,
        }
    }

    /// Returns a controller that plays the recorded control back.
    pub(crate) fn playback(&self) -> Result<Playback<'a>, Error> {
        let control_v =
            self.recording.samples(Channel::Control).ok_or(Error::NoChannel { channel: "control" })?;
        Ok(Playback::new(control_v))
    }
}

/// Plays a recorded control back; a missing value repeats the one before, and the last one stays.
#[derive(Debug, Clone)]
pub struct Playback<'a> {
    control_v: &'a [f64],
    next: usize,
}

impl<'a> Playback<'a> {
    /// Returns the recorded control with missing values filled by those before them.
    pub(crate) fn fill_missing(recording: &Recording) -> Result<Vec<f64>, Error> {
        let control_v = recording.samples(Channel::Control).ok_or(Error::NoChannel { channel: "control" })?;
        let mut last = 0.0;
        let held = control_v.iter().map(|v| {
            if v.is_finite() {
                last = *v;
            }
            last
        });
        Ok(held.collect())
    }

    /// Returns the control from the first sample on.
    pub fn new(control_v: &'a [f64]) -> Self {
        Self { control_v, next: 0 }
    }
}

impl SampledController for Playback<'_> {
    fn reset(&mut self) {
        self.next = 0;
    }

    fn step(&mut self, _readings: &Readings) -> f64 {
        let passed = &self.control_v[..self.control_v.len().min(self.next + 1)];
        self.next += 1;
        passed.iter().rev().find(|v| v.is_finite()).copied().unwrap_or(0.0)
    }
}

/// The floors of the channels.
struct Floors<'a> {
    parameters: &'a Parameters,
    control: &'a ReplayLoop,
}

impl Floors<'_> {
    /// Returns the floor of a channel: noise and quantisation of its sensor; for the control in closed loop those of what the controller
    /// reads, through the controller, and the output converter's step. Played-back control has none and no fit.
    fn of(&self, channel: Channel) -> Option<f64> {
        match channel {
            Channel::Control => {
                let ReplayLoop::Closed(controller) = self.control else { return None };
                Some(controller.control_floor(self.parameters))
            }
            read => Some(reading_floor(sensor_of(self.parameters, read)?, &self.parameters.interface)),
        }
    }
}

fn check_length(what: &'static str, column: Option<&[f64]>, expected: usize) -> Result<(), Error> {
    match column {
        Some(column) if column.len() != expected => {
            Err(Error::Length { what, found: column.len(), expected })
        }
        _ => Ok(()),
    }
}

/// Returns the fit of a channel; `None` if no sample was recorded.
fn fit(channel: Channel, simulated: &[f64], recorded: &[f64], floor: f64) -> Option<ChannelFit> {
    let pairs = || simulated.iter().zip(recorded).filter(|(_, r)| r.is_finite());
    let count = pairs().count() as f64;
    if count == 0.0 {
        return None;
    }
    let mean = |f: &dyn Fn(f64, f64) -> f64| pairs().map(|(s, r)| f(*s, *r)).sum::<f64>() / count;
    let (residual, level) = (mean(&|s, r| r - s), mean(&|_, r| r));
    let variance = mean(&|_, r| (r - level).powi(2));
    let scatter = mean(&|s, r| (r - s - residual).powi(2));
    Some(ChannelFit {
        channel,
        rms_error: mean(&|s, r| (r - s).powi(2)).sqrt(),
        floor,
        white_noise: white_noise(recorded),
        vaf: if variance > 0.0 { 100.0 * (1.0 - scatter / variance) } else { 0.0 },
    })
}

/// RMS of white noise by third differences, whose variance is 20 times the noise's.
fn white_noise(values: &[f64]) -> f64 {
    let differences = values.windows(4).map(|w| w[3] - 3.0 * (w[2] - w[1]) - w[0]);
    let (sum, count) =
        differences.filter(|d| d.is_finite()).fold((0.0, 0.0), |(s, c), d| (s + d * d, c + 1.0));
    if count > 0.0 { (sum / count / 20.0_f64).sqrt() } else { 0.0 }
}
