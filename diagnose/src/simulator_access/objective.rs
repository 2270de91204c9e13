//! The simulator that answers the questions: every recording is replayed for any mechanism, in closed loop if the controller is
//! known, else under the recorded control.

use crate::tolerance::fitting::HUNTING_DIVERGENCE;
use std::sync::OnceLock;

use counterpoise_models::{LearnedElement, Parameters};
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::PlantState;
use counterpoise_simulate::history::ReadingColumns;
use counterpoise_simulate::replay::{
    Replay, ReplayDirection, ReplayLoop, ReplayMember, ReplayRequest, ReplayVariant, Replayer, SlopedReplay,
    reading_floor, replay_each,
};
use counterpoise_simulate::tolerance::WRONG_MODEL;

use crate::error::Error;
use crate::recording::measured_signals::{MeasuredSignals, read_signals};
use crate::recording::noise::{measure_noise_floor, rounding_noise, stated_noise};
use crate::recording::series::deviation;
use crate::recording::series::rms;
use crate::simulator_access::access::{
    Assessment, ChannelResidual, ControlSource, MechanismVariant, NearRecording, PlacedVariant,
    SimulatorAccess, Span, StartShift, VariantDirection,
};
use crate::tolerance::{FITTED_SHARE, STEPS_PER_SAMPLE};

/// Channels whose residual is scored; the platform's channels drive the replay.
const SCORED: [Channel; 4] = [Channel::Control, Channel::HubRate, Channel::MotorRate, Channel::HubPosition];
/// Index of the hub rate among them.
const HUB_RATE: usize = 1;
/// The hub angle among the freedoms of a start.
const HUB_ANGLE: usize = 0;

/// Recordings of one machine with what is computed from them once: their first parts, and copies with noise on the demand.
pub struct PreparedRecordings {
    whole: Vec<Recording>,
    heads: Vec<Recording>,
    noisy: Vec<Recording>,
}

impl PreparedRecordings {
    /// Prepares recordings of a mechanism.
    pub fn new(recordings: &[Recording], base: &Parameters) -> Self {
        Self {
            heads: recordings.iter().map(head).collect(),
            noisy: recordings.iter().map(|r| with_other_noise(r, base, 0)).collect(),
            whole: recordings.to_vec(),
        }
    }
}

/// Recordings of one machine that are ready to be replayed.
pub struct RecordingReplays<'a> {
    base: &'a Parameters,
    control: ReplayLoop,
    prepared: &'a PreparedRecordings,
    whole: Vec<Replayer<'a>>,
    heads: Vec<Replayer<'a>>,
    noisy: Vec<Replayer<'a>>,
    /// RMS of each scored channel's own noise, recording by recording.
    floors: Vec<[f64; SCORED.len()]>,
    control_floor: f64,
    /// `true` if the hub is made to follow its own recorded rate, recording by recording.
    followed: Vec<bool>,
    /// The assessment of every recording for the mechanism that the replays were made with, which is asked for repeatedly.
    standing: Vec<OnceLock<Option<Assessment>>>,
}

/// Returns the errors of the platform's sensors.
fn platform_errors(of: &Parameters) -> impl Iterator<Item = &LearnedElement> {
    of.learned.iter().filter(|element| element.place.is_platform_sensor())
}

impl<'a> RecordingReplays<'a> {
    /// Prepares the replays: reconstructs the platform's motion and measures the noise of each channel.
    ///
    /// # Errors
    /// A recording that cannot be replayed.
    pub fn new(
        base: &'a Parameters,
        control: &ReplayLoop,
        prepared: &'a PreparedRecordings,
    ) -> Result<Self, Error> {
        let ready = |recordings: &'a [Recording]| {
            let one = |r: &'a Recording| {
                Ok(Replayer::new(base, r)?.with_step_bound(STEPS_PER_SAMPLE).with_motion_computed())
            };
            recordings.iter().map(one).collect::<Result<Vec<_>, counterpoise_simulate::Error>>()
        };
        let control_floor = match control {
            ReplayLoop::Closed(controller) => controller.control_floor(base),
            ReplayLoop::Open => 0.0,
        };
        // A replay holds the noise that this loop makes of its readings, whatever the recorded control shows of it: readings that move by
        // single counts leave most samples without noise, and a control of another loop has another noise.
        let of = |c, own: f64| if c == Channel::Control { own.max(control_floor) } else { own };
        let floors =
            |r: &Recording| SCORED.map(|c| of(c, measure_noise_floor(base, c, r.samples(c).unwrap_or(&[]))));
        Ok(Self {
            base,
            control: control.clone(),
            whole: ready(&prepared.whole)?,
            heads: ready(&prepared.heads)?,
            noisy: ready(&prepared.noisy)?.into_iter().map(Replayer::with_rounded_readings).collect(),
            floors: prepared.whole.iter().map(floors).collect(),
            control_floor,
            followed: prepared.whole.iter().map(follows).collect(),
            standing: prepared.whole.iter().map(|_| OnceLock::new()).collect(),
            prepared,
        })
    }

    /// Returns the same with noise floors no lower than the noise that a mechanism's sensors state. A sensor at rest shows none, and a slope
    /// that was smoothed shows less than it is wrong by.
    pub fn with_stated_noise(mut self, stated: &Parameters) -> Self {
        let least = SCORED.map(|channel| stated_noise(stated, channel));
        for floors in &mut self.floors {
            floors.iter_mut().zip(least).for_each(|(floor, least)| *floor = floor.max(least));
        }
        self
    }

    /// Returns the same with another bound on the steps that a mechanism may take for each sample.
    pub fn with_step_bound(self, steps_per_sample: f64) -> Self {
        let bounded = |all: Vec<Replayer<'a>>| {
            all.into_iter().map(|one| one.with_step_bound(steps_per_sample)).collect::<Vec<_>>()
        };
        let standing = self.prepared.whole.iter().map(|_| OnceLock::new()).collect();
        let (whole, heads, noisy) = (bounded(self.whole), bounded(self.heads), bounded(self.noisy));
        Self { whole, heads, noisy, standing, ..self }
    }

    /// Returns the signals of a recording; `None` if it has no hub rate or no control.
    pub fn signals_of(&self, index: usize) -> Option<MeasuredSignals> {
        let measured = self.base.sensors.measured;
        self.prepared.whole.get(index).and_then(|recording| read_signals(recording, measured))
    }

    fn same_platform_sensors(&self, parameters: &Parameters) -> bool {
        let (ours, theirs) = (&self.base.sensors, &parameters.sensors);
        ours.platform_gyro == theirs.platform_gyro
            && ours.platform_accelerometer == theirs.platform_accelerometer
            && ours.accelerometer_lever_arm_m == theirs.accelerometer_lever_arm_m
            && platform_errors(self.base).eq(platform_errors(parameters))
    }

    /// Runs a prepared replay; prepares it again if the mechanism has other platform sensors.
    fn with<T>(
        &self,
        parameters: &Parameters,
        ready: &Replayer<'a>,
        run: impl Fn(&Replayer) -> Result<T, counterpoise_simulate::Error>,
    ) -> Option<T> {
        if self.same_platform_sensors(parameters) {
            return run(ready).ok();
        }
        run(&ready.with_platform_sensors_of(parameters)).ok()
    }

    fn control(&self, source: ControlSource) -> &ReplayLoop {
        match source {
            ControlSource::ClosedLoop => &self.control,
            ControlSource::Playback => &ReplayLoop::Open,
        }
    }

    /// Returns the channel that is scored in a place of [`SCORED`], and its index there; `None` if nothing is scored. In a playback
    /// the control has no residual of its own; the hub rate takes its place, so that both ways of running a mechanism have the same
    /// number of channels. A hub that is made to follow its own recorded rate is no evidence: the control that it takes is.
    fn scored_channel(
        &self,
        replay: &Replay,
        index: usize,
        source: ControlSource,
        place: usize,
    ) -> Option<(Channel, usize)> {
        let channel = SCORED[place];
        let stand_in = channel == Channel::Control && source == ControlSource::Playback;
        if stand_in && self.control == ReplayLoop::Open {
            return None;
        }
        let (shown, place) = if stand_in { (Channel::HubRate, HUB_RATE) } else { (channel, place) };
        let of_hub = matches!(shown, Channel::HubRate | Channel::HubPosition);
        let given = of_hub && source == ControlSource::ClosedLoop && self.followed[index];
        (!given && replay.channels.iter().any(|f| f.channel == shown)).then_some((shown, place))
    }

    /// Returns the residual of every scored channel.
    fn channels(
        &self,
        replay: &Replay,
        index: usize,
        length: usize,
        source: ControlSource,
    ) -> Option<Vec<ChannelResidual>> {
        let mut out = Vec::new();
        for (place, channel) in SCORED.into_iter().enumerate() {
            let Some((shown, c)) = self.scored_channel(replay, index, source, place) else { continue };
            let recorded = &self.prepared.whole[index].samples(shown)?[..length];
            let floor = self.floors[index][c];
            let simulated = replay.simulated.channel(shown);
            let difference = |(s, r): (&f64, &f64)| if r.is_finite() { (r - s) / floor } else { 0.0 };
            let residual: Vec<f64> = simulated.iter().zip(recorded).map(difference).collect();
            let told = if shown == channel { floor } else { self.control_floor };
            out.push(ChannelResidual { channel, residual, floor: told });
        }
        Some(out)
    }

    /// Returns the derivatives of every scored channel's residual along a direction.
    fn channel_slopes(
        &self,
        found: &SlopedReplay,
        direction: usize,
        index: usize,
        source: ControlSource,
    ) -> Option<Vec<ChannelResidual>> {
        let mut out = Vec::new();
        for (place, channel) in SCORED.into_iter().enumerate() {
            let Some((shown, c)) = self.scored_channel(&found.replay, index, source, place) else { continue };
            let recorded = self.prepared.whole[index].samples(shown)?;
            let floor = self.floors[index][c];
            let slope = |(s, r): (&f64, &f64)| if r.is_finite() { -s / floor } else { 0.0 };
            let residual = found.slope(direction, shown).iter().zip(recorded).map(slope).collect();
            out.push(ChannelResidual { channel, residual, floor });
        }
        Some(out)
    }

    /// Returns how far a run diverges from one with other noise and rounded readings, channel by channel: noise like the hub gyroscope's on the
    /// demand is another realisation of the loop's noise, rounding is what the replay leaves out, and more noise on the platform's readings is another reconstruction of its
    /// motion.
    fn divergence(&self, index: usize, quiet: &Replay, shaken: &Replay, source: ControlSource) -> Vec<f64> {
        let rounding = |channel| rounding_noise(self.base, channel);
        let size = |place: usize| {
            let (shown, place) = self.scored_channel(quiet, index, source, place)?;
            let apart =
                rms_difference(shown, &quiet.simulated, &shaken.simulated) / self.floors[index][place];
            let own =
                if shown == Channel::Control { 1.0 } else { rounding(shown) / self.floors[index][place] };
            Some((apart * apart - own * own).max(0.0).sqrt())
        };
        (0..SCORED.len()).filter_map(size).collect()
    }

    /// Replays a recording with other noise and rounded readings, from the start of a run.
    fn shake(
        &self,
        parameters: &Parameters,
        index: usize,
        quiet: &Replay,
        source: ControlSource,
    ) -> Option<Replay> {
        let control = self.control(source);
        self.with(parameters, &self.noisy[index], |r| r.replay_from(parameters, control, &quiet.start))
    }

    /// Returns a recording ready to be replayed.
    fn prepared_replayer(&self, index: usize, span: Span) -> &Replayer<'a> {
        match span {
            Span::Whole => &self.whole[index],
            Span::Head => &self.heads[index],
        }
    }

    /// Returns the replay of a variant in its recording; `None` if it has to be prepared anew, because the mechanism has other platform sensors.
    fn request<'r>(&'r self, placed: &'r PlacedVariant, span: Span) -> Option<ReplayRequest<'r, 'a>> {
        let PlacedVariant { variant, index, near } = placed;
        let start = near.start.as_ref().filter(|_| self.same_platform_sensors(&variant.parameters))?;
        let is_shifted = variant.shift.iter().any(|s| *s != 0.0);
        Some(ReplayRequest {
            replayer: self.prepared_replayer(*index, span),
            control: self.control(near.source),
            variant: ReplayVariant {
                parameters: &variant.parameters,
                start,
                steps: is_shifted.then(|| self.possible_shift(*index, near.source, &variant.shift)),
            },
        })
    }

    /// Returns a shift of an initial state without what the recording determines.
    fn possible_shift(&self, index: usize, source: ControlSource, shift: &StartShift) -> StartShift {
        let mut shift = *shift;
        if source == ControlSource::ClosedLoop && self.followed[index] {
            // here the hub's recorded angle is no evidence, so only the recording determines the initial angle
            shift[HUB_ANGLE] = 0.0;
        }
        shift
    }

    /// Assesses a run; if one in closed loop does not repeat, assesses the playback in its place.
    fn assess_run(
        &self,
        parameters: &Parameters,
        index: usize,
        quiet: Replay,
        playback: impl Fn() -> Option<Replay>,
    ) -> Option<Assessment> {
        let shaken = self.shake(parameters, index, &quiet, ControlSource::ClosedLoop)?;
        self.judge_runs(parameters, index, [quiet, shaken], playback)
    }

    /// Assesses a run beside one with other noise; if those in closed loop do not repeat, assesses the playback in their place.
    fn judge_runs(
        &self,
        parameters: &Parameters,
        index: usize,
        [quiet, shaken]: [Replay; 2],
        playback: impl Fn() -> Option<Replay>,
    ) -> Option<Assessment> {
        if self.control == ReplayLoop::Open {
            return self.compare_runs(index, quiet, &shaken, ControlSource::Playback);
        }
        let found = self.compare_runs(index, quiet, &shaken, ControlSource::ClosedLoop)?;
        if !hunts(&found.channels, &found.divergence) {
            return Some(found);
        }
        let played = playback()?;
        let shaken = self.shake(parameters, index, &played, ControlSource::Playback)?;
        self.compare_runs(index, played, &shaken, ControlSource::Playback)
    }

    /// Returns the assessment of a run, with its divergence from one with other noise.
    fn compare_runs(
        &self,
        index: usize,
        quiet: Replay,
        shaken: &Replay,
        source: ControlSource,
    ) -> Option<Assessment> {
        let length = self.prepared.whole[index].len();
        let divergence = self.divergence(index, &quiet, shaken, source);
        let channels = self.channels(&quiet, index, length, source)?;
        Some(Assessment { channels, divergence, start: Some(quiet.start), source })
    }
}

/// Returns whether two runs of a model differ so much that its residual tells of that and not of the model: one far above their difference says that
/// the model is wrong, and the recorded control would hide it.
fn hunts(channels: &[ChannelResidual], divergence: &[f64]) -> bool {
    // in any loop that controls a rate the angle drifts, which is no sign of hunting
    let telling = || channels.iter().zip(divergence).filter(|(m, _)| m.channel != Channel::HubPosition);
    let apart = telling().fold(0.0_f64, |most, (_, apart)| most.max(*apart));
    let excess = telling().fold(0.0_f64, |most, (channel, _)| most.max(channel.relative_rms()));
    apart > HUNTING_DIVERGENCE && excess < WRONG_MODEL * apart
}

/// Returns whether the demand of a recording equals its hub rate: then a controller that was not recorded makes the model follow.
fn follows(recording: &Recording) -> bool {
    let channels = [Channel::Demand, Channel::HubRate];
    let [Some(demand), Some(rate)] = channels.map(|channel| recording.samples(channel)) else {
        return false;
    };
    let differs = |(d, r): (&f64, &f64)| r.is_finite() && d != r;
    rate.iter().any(|r| r.is_finite() && *r != 0.0) && !demand.iter().zip(rate).any(differs)
}

/// Returns the first part of a recording, which candidates are fitted to.
fn head(recording: &Recording) -> Recording {
    recording.part(0..(recording.len() as f64 * FITTED_SHARE) as usize)
}

impl SimulatorAccess for RecordingReplays<'_> {
    fn count(&self) -> usize {
        self.whole.len()
    }

    fn measured_signals(&self, index: usize) -> Option<MeasuredSignals> {
        self.signals_of(index)
    }

    fn most_active_recording(&self) -> usize {
        let motion = |r: &Recording| r.samples(Channel::HubRate).map_or(0.0, deviation);
        let sizes: Vec<f64> = self.prepared.whole.iter().map(motion).collect();
        (0..sizes.len()).max_by(|&a, &b| sizes[a].total_cmp(&sizes[b])).unwrap_or(0)
    }

    fn residuals(
        &self,
        parameters: &Parameters,
        index: usize,
        span: Span,
        near: &Assessment,
    ) -> Option<Vec<ChannelResidual>> {
        let ready = self.prepared_replayer(index, span);
        let start = near.start.as_ref()?;
        let control = self.control(near.source);
        let replay = self.with(parameters, ready, |r| r.replay_from(parameters, control, start))?;
        self.channels(&replay, index, ready.recording().len(), near.source)
    }

    fn residuals_from_shifted_start(
        &self,
        parameters: &Parameters,
        index: usize,
        span: Span,
        near: &Assessment,
        shift: &StartShift,
    ) -> Option<(Vec<ChannelResidual>, PlantState)> {
        let ready = self.prepared_replayer(index, span);
        let start = near.start.as_ref()?;
        let control = self.control(near.source);
        let shift = self.possible_shift(index, near.source, shift);
        let replay = self.with(parameters, ready, |r| r.replay_nudged(parameters, control, start, &shift))?;
        let channels = self.channels(&replay, index, ready.recording().len(), near.source)?;
        Some((channels, replay.start))
    }

    fn residuals_of_each(&self, placed: &[PlacedVariant], span: Span) -> Vec<Option<Vec<ChannelResidual>>> {
        let requests: Vec<Option<ReplayRequest>> = placed.iter().map(|one| self.request(one, span)).collect();
        let together: Vec<ReplayRequest> = requests.iter().flatten().copied().collect();
        let mut replays = replay_each(&together).into_iter();
        let one = |(asked, request): (&PlacedVariant, Option<ReplayRequest>)| {
            let PlacedVariant { variant, index, near } = asked;
            let Some(request) = request else { return self.residuals_of(variant, *index, span, near) };
            let length = request.replayer.recording().len();
            self.channels(&replays.next()?.ok()?, *index, length, near.source)
        };
        placed.iter().zip(requests).map(one).collect()
    }

    fn residual_slopes(
        &self,
        variant: &MechanismVariant,
        directions: &[VariantDirection],
        index: usize,
        span: Span,
        near: &Assessment,
    ) -> Option<Vec<Vec<ChannelResidual>>> {
        let start = near.start.as_ref()?;
        let (ready, control) = (self.prepared_replayer(index, span), self.control(near.source));
        let member = |variant: MechanismVariant| ReplayMember {
            steps: self.possible_shift(index, near.source, &variant.shift),
            parameters: variant.parameters,
        };
        let members: Vec<_> =
            directions.iter().map(|direction| move |by: f64| member((direction.member)(by))).collect();
        let asked: Vec<ReplayDirection> = members
            .iter()
            .zip(directions)
            .map(|(member, direction)| ReplayDirection { member, side: direction.side })
            .collect();
        let nominal = member(variant.clone());
        let run = |r: &Replayer| Ok(r.replay_with_slopes(control, start, &nominal, &asked));
        let found = self.with(&variant.parameters, ready, run)?.ok()?;
        (0..directions.len()).map(|k| self.channel_slopes(&found, k, index, near.source)).collect()
    }

    fn travel_rad(&self) -> f64 {
        self.prepared.whole.iter().map(travel).fold(0.0, f64::max)
    }

    fn turns_per_sample(&self) -> f64 {
        let recording = &self.prepared.whole[self.most_active_recording()];
        let Some(hub) = recording.samples(Channel::HubRate) else { return 0.0 };
        let platform = recording.samples(Channel::PlatformRate);
        let rates = hub.iter().enumerate().map(|(k, h)| h - platform.map_or(0.0, |p| p[k]));
        let finite: Vec<f64> = rates.filter(|rate| rate.is_finite()).collect();
        rms(&finite) * recording.sample_period_s / std::f64::consts::TAU
    }

    fn noise_response(
        &self,
        parameters: &Parameters,
        index: usize,
        near: &Assessment,
        which: u64,
    ) -> Option<Vec<Vec<f64>>> {
        let recording = &self.prepared.whole[index];
        let start = near.start.as_ref()?;
        let control = self.control(near.source);
        let noisy = with_other_noise(recording, self.base, which + 1);
        let shaken = Replayer::new(self.base, &noisy).ok()?.with_controller_start_of(&self.whole[index]);
        let shaken = self.with(parameters, &shaken, |r| r.replay_from(parameters, control, start))?;
        let quiet =
            self.with(parameters, &self.whole[index], |r| r.replay_from(parameters, control, start))?;
        let one = |place: usize| -> Option<Vec<f64>> {
            let (shown, c) = self.scored_channel(&quiet, index, near.source, place)?;
            let floor = self.floors[index][c];
            let pairs = shaken.simulated.channel(shown).iter().zip(quiet.simulated.channel(shown));
            Some(pairs.map(|(a, b)| (a - b) / floor).collect())
        };
        Some((0..SCORED.len()).filter_map(one).collect())
    }

    fn assess_from(&self, parameters: &Parameters, index: usize, near: &Assessment) -> Option<Assessment> {
        let (ready, start) = (&self.whole[index], near.start.as_ref()?);
        let run = |control: &ReplayLoop| {
            self.with(parameters, ready, |r| r.replay_from(parameters, control, start))
        };
        self.assess_run(parameters, index, run(&self.control)?, || run(&ReplayLoop::Open))
    }

    fn assess_each_from(
        &self,
        parameters: &Parameters,
        recordings: &[NearRecording],
    ) -> Vec<Option<Assessment>> {
        let alone = |one: &NearRecording| self.assess_from(parameters, one.index, one.near);
        let starts: Option<Vec<&PlantState>> = recordings.iter().map(|one| one.near.start.as_ref()).collect();
        let Some(starts) = starts.filter(|_| self.same_platform_sensors(parameters)) else {
            return recordings.iter().map(alone).collect();
        };
        let runs = |replayers: &[Replayer]| {
            let requests = recordings.iter().zip(&starts).map(|(one, start)| ReplayRequest {
                replayer: &replayers[one.index],
                control: &self.control,
                variant: ReplayVariant { parameters, start, steps: None },
            });
            let requests: Vec<ReplayRequest> = requests.collect();
            replay_each(&requests)
        };
        let (quiet, shaken) = (runs(&self.whole), runs(&self.noisy));
        let one = |((one, quiet), shaken): ((&NearRecording, Result<Replay, _>), Result<Replay, _>)| {
            let start = one.near.start.as_ref()?;
            let played = || {
                self.with(parameters, &self.whole[one.index], |r| {
                    r.replay_from(parameters, &ReplayLoop::Open, start)
                })
            };
            self.judge_runs(parameters, one.index, [quiet.ok()?, shaken.ok()?], played)
        };
        recordings.iter().zip(quiet).zip(shaken).map(one).collect()
    }

    fn assess_near(&self, parameters: &Parameters, index: usize, near: &Assessment) -> Option<Assessment> {
        let Some(start) = near.start.as_ref() else { return self.assess(parameters, index) };
        let ready = &self.whole[index];
        let run = |control: &ReplayLoop| {
            self.with(parameters, ready, |r| r.replay_near(parameters, control, start))
        };
        self.assess_run(parameters, index, run(&self.control)?, || run(&ReplayLoop::Open))
    }

    fn assess(&self, parameters: &Parameters, index: usize) -> Option<Assessment> {
        let judged = || {
            let run = |control: &ReplayLoop| {
                self.with(parameters, &self.whole[index], |r| r.replay(parameters, control))
            };
            self.assess_run(parameters, index, run(&self.control)?, || run(&ReplayLoop::Open))
        };
        if parameters == self.base { self.standing[index].get_or_init(judged).clone() } else { judged() }
    }
}

/// Returns the angle over which the hub moves on the platform, rad: from the resolver, else from the gyroscopes.
fn travel(recording: &Recording) -> f64 {
    let span = |series: &mut dyn Iterator<Item = f64>| {
        let (low, high) = series
            .filter(|v| v.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        (high - low).max(0.0)
    };
    if let Some(position) = recording.samples(Channel::HubPosition) {
        return span(&mut position.iter().copied());
    }
    let Some(hub) = recording.samples(Channel::HubRate) else { return 0.0 };
    let mut angle = 0.0;
    let still = vec![0.0; hub.len()];
    let platform = recording.samples(Channel::PlatformRate).unwrap_or(&still);
    let rates = hub.iter().zip(platform).map(|(h, p)| h - p);
    span(&mut rates.map(|rate| {
        angle += if rate.is_finite() { rate * recording.sample_period_s } else { 0.0 };
        angle
    }))
}

fn rms_difference(channel: Channel, a: &ReadingColumns, b: &ReadingColumns) -> f64 {
    let difference: Vec<f64> =
        a.channel(channel).iter().zip(b.channel(channel)).map(|(x, y)| x - y).collect();
    rms(&difference)
}

/// Returns the recording with other noise: on its demand of the size of the hub gyroscope's and its rounding, on the platform's channels of the size
/// of their sensors' (a fixed sequence for each number).
fn with_other_noise(recording: &Recording, p: &Parameters, which: u64) -> Recording {
    let mut state = 0x2545_f491_4f6c_dd1d_u64 ^ which.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut uniform = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut normal = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
    let mut noisy = recording.clone();
    let columns = [
        (Channel::Demand, reading_floor(&p.sensors.hub_gyro, &p.interface)),
        (Channel::PlatformRate, p.sensors.platform_gyro.noise_rms),
        (Channel::PlatformAccel, p.sensors.platform_accelerometer.noise_rms),
    ];
    for (channel, size) in columns {
        let samples = noisy.samples_mut(channel).unwrap_or_default();
        samples.iter_mut().for_each(|value| *value += size * normal());
    }
    noisy
}
