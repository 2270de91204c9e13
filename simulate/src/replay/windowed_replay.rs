//! The choice of the replay that says something about the model: one over the whole recording, or one over short windows.
//!
//! Two runs of the same model that differ only in noise and in what is not known of their start diverge: by less than a noise floor
//! if the closed loop forgets its start, by many if the machine hunts. The residual of a free replay of a hunting machine is no
//! measure of the model. Such a recording is replayed over windows instead, each from a start of its own.

use super::control::control_fit;
use super::exported_controller::FittedStart;
use super::start::redraw_start;
use super::windows::is_explained;
use super::{ChannelFit, RecordedController, Replay, ReplayLoop, Replayer};
use crate::Error;
use crate::history::ReadingColumns;
use crate::noise::Noise;
use crate::tolerance::{
    DIVERGED_FLOORS, LONG_WINDOWS, MODEL_SEED, OWN_EXPLAINED, SHORTEST_OWN_WINDOW_S, WRONG_MODEL,
};
use counterpoise_models::Parameters;
use counterpoise_recordings::{Channel, Recording};

/// Length of a window, s; a machine that forgets its start faster is followed over halves of it.
pub const WINDOW_S: f64 = 0.5;
/// The channels that show whether a machine hunts. The control contains the noise itself, and in a rate loop the angle drifts
/// anyway.
const TELLING: [Channel; 2] = [Channel::HubRate, Channel::MotorRate];

/// A replay, and the mode that was selected for it.
#[derive(Debug, Clone, PartialEq)]
pub struct SelectedReplay {
    /// The replay.
    pub replay: Replay,
    /// Over the whole recording or over windows.
    pub mode: ReplayMode,
    /// Divergence of two runs of the model over the whole recording; `None` in open loop, which feeds no difference back.
    pub divergence: Option<Divergence>,
}

/// Mode of the replay of a recording.
#[derive(Debug, Clone, PartialEq)]
pub enum ReplayMode {
    /// From its start to its end.
    Free,
    /// Over windows, each from a start of its own.
    Windowed {
        /// Length of a window, s.
        window_s: f64,
        /// The fits of the free replay.
        free: Vec<ChannelFit>,
    },
}

/// Divergence of two runs of one model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Divergence {
    /// The channel in which they diverge most.
    pub channel: Channel,
    /// RMS of their difference over the channel's noise floor.
    pub floors: f64,
}

impl Replayer<'_> {
    /// Replays the recording over its whole length, or over windows if two runs of the model itself diverge by more than noise.
    ///
    /// # Errors
    /// As [`super::replay`].
    pub fn replay_free_or_windowed(
        &self,
        parameters: &Parameters,
        control: &ReplayLoop,
    ) -> Result<SelectedReplay, Error> {
        let mode = ReplayMode::Free;
        let ReplayLoop::Closed(controller) = control else {
            return Ok(SelectedReplay { replay: self.replay_open(parameters)?, mode, divergence: None });
        };
        let free = self.replay(parameters, control)?;
        let divergence = self.divergence(parameters, control, &free)?;
        let long = self.samples as f64 * self.recording.sample_period_s > LONG_WINDOWS * WINDOW_S;
        let can_window = long && self.recording.has(Channel::Control);
        let hunts = divergence.filter(|d| d.floors > DIVERGED_FLOORS && can_window);
        let Some(divergence) =
            hunts.filter(|d| !is_explained(&free) && excess(&free) < WRONG_MODEL * d.floors)
        else {
            return Ok(SelectedReplay { replay: free, mode, divergence });
        };
        let mut replay = self.replay_windowed_with_control(parameters, WINDOW_S, controller)?;
        let window_s =
            if is_explained(&replay) { WINDOW_S } else { self.own_window_s(parameters, control, &free)? };
        if window_s < WINDOW_S {
            replay = self.replay_windowed_with_control(parameters, window_s, controller)?;
        }
        // a start that a window's first half does not show, as that of an elastic gear behind few counts, leaves more than the divergence
        if excess(&replay) > excess(&free) {
            return Ok(SelectedReplay { replay: free, mode, divergence: Some(divergence) });
        }
        let mode = ReplayMode::Windowed { window_s, free: free.channels };
        Ok(SelectedReplay { replay, mode, divergence: Some(divergence) })
    }

    /// Returns the longest window, of [`WINDOW_S`] and its halves, over which a replay explains what the model itself would have recorded: a
    /// machine that floats in its gap forgets faster than one that hunts, and what it forgets says nothing against the model.
    fn own_window_s(
        &self,
        parameters: &Parameters,
        control: &ReplayLoop,
        free: &Replay,
    ) -> Result<f64, Error> {
        let mut simulator = self.simulator(&self.plant(parameters)?)?;
        let noisy = self.clone().with_noise_of(MODEL_SEED);
        let own = noisy.run(&mut simulator, control, &free.start)?.readings;
        let recording = own.recording("model", self.recording.sample_period_s);
        // the platform is reconstructed anew: what noise leaves in it moves a machine that floats in its gap
        let itself = Replayer {
            steps_per_sample: self.steps_per_sample,
            body: self.body.clone(),
            ..Replayer::new(parameters, &recording)?
        };
        let mut window_s = WINDOW_S;
        while window_s > SHORTEST_OWN_WINDOW_S
            && excess(&itself.replay_windowed(parameters, window_s)?) > OWN_EXPLAINED
        {
            window_s *= 0.5;
        }
        Ok(window_s)
    }

    /// Replays over windows as [`Self::replay_windowed`] does, and compares the recorded control with the one that the controller makes
    /// of the recorded measurements ([`control_fit`]): a replay under the recorded control has no control of its own.
    ///
    /// # Errors
    /// As [`Self::replay_windowed`].
    pub fn replay_windowed_with_control(
        &self,
        parameters: &Parameters,
        window_s: f64,
        controller: &RecordedController,
    ) -> Result<Replay, Error> {
        let mut replay = self.replay_windowed(parameters, window_s)?;
        if let Some((fit, made)) = control_fit(parameters, self.recording, controller) {
            replay.channels.push(fit);
            replay.simulated.channel_mut(Channel::Control).copy_from_slice(&made);
        }
        Ok(replay)
    }

    /// Returns how far two runs of the model diverge that differ in their start, as far as it is not known, and in the noise of the
    /// hub gyroscope; `None` if no channel that shows it was recorded.
    fn divergence(
        &self,
        parameters: &Parameters,
        control: &ReplayLoop,
        quiet: &Replay,
    ) -> Result<Option<Divergence>, Error> {
        let mut simulator = self.simulator(&self.plant(parameters)?)?;
        let start = redraw_start(&mut simulator, self, &quiet.start)?;
        let moved = self.run(&mut simulator, control, &start)?.readings;
        let recording = with_noise(self.recording, parameters.sensors.hub_gyro.noise_rms);
        let noisy = Replayer { recording: &recording, fitted: FittedStart::default(), ..self.clone() };
        let noisy = noisy.run(&mut simulator, control, &quiet.start)?.readings;
        let apart = |fit: &ChannelFit, other: &ReadingColumns| {
            rms_of_difference(quiet.simulated.channel(fit.channel), other.channel(fit.channel)) / fit.floor
        };
        let one = |fit: &ChannelFit| Divergence {
            channel: fit.channel,
            floors: apart(fit, &moved).max(apart(fit, &noisy)),
        };
        let telling = quiet.channels.iter().filter(|fit| TELLING.contains(&fit.channel));
        Ok(telling.map(one).max_by(|a, b| a.floors.total_cmp(&b.floors)))
    }
}

/// Returns the largest residual over its noise floor in the channels that show whether a machine hunts.
fn excess(replay: &Replay) -> f64 {
    let telling = replay.channels.iter().filter(|fit| TELLING.contains(&fit.channel));
    telling.map(|fit| fit.residual_over_floor()).fold(0.0, f64::max)
}

/// Returns the recording with noise on its demand: it drives the loop as another noise of the gyroscope does.
fn with_noise(recording: &Recording, size: f64) -> Recording {
    let mut noise = Noise::new(0);
    let mut noisy = recording.clone();
    noisy
        .samples_mut(Channel::Demand)
        .unwrap_or_default()
        .iter_mut()
        .for_each(|value| *value += size * noise.next());
    noisy
}

fn rms_of_difference(a: &[f64], b: &[f64]) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum();
    (squares / a.len().max(1) as f64).sqrt()
}
