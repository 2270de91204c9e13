//! Which replay says something about the model: one over the whole recording, or one over short horizons.
//!
//! Two runs of one and the same model that differ by less than its start is known, and by noise like the hub gyroscope's, part: by less
//! than a floor where the loop forgets, by many where the machine hunts. What free replay leaves of such a machine is no figure of the
//! model's, and the recording is followed over windows instead, each from a start of its own.

use super::control::control_fit;
use super::start::redrawn;
use super::windows::explained;
use super::{ChannelFit, Loop, Replay, Replayer};
use crate::Error;
use crate::history::ReadingColumns;
use crate::recording::{Channel, Recording};
use crate::sensing::Noise;
use counterpoise_controller::ProportionalIntegral;
use counterpoise_models::{Parameters, Plant};

/// Length of a window, s.
pub const WINDOW_S: f64 = 0.5;
/// Two runs of one model that part by more than this many floors hunt: a loop that forgets parts by 0.1 in the hub's rate and 0.4 in
/// the motor's.
const PARTED: f64 = 0.5;
/// A recording of no more than so many windows is followed from start to end: what is not known of its start is as much in a window.
const LONG: f64 = 3.0;
/// What a model is off by more than so many times what its own runs part by is not the hunting: its free replay says that it is wrong.
const WRONG: f64 = 10.0;
/// The channels that tell whether a machine hunts: noise is a part of the control itself, and an angle wanders in any loop of a rate.
const TELLING: [Channel; 2] = [Channel::HubRate, Channel::MotorRate];

/// A replay, and how the recording was followed.
#[derive(Debug, Clone, PartialEq)]
pub struct Followed {
    /// The replay.
    pub replay: Replay,
    /// Over the whole recording or over windows.
    pub way: Way,
    /// How far two runs of the model part over the whole recording; none in open loop, which feeds no parting back.
    pub parting: Option<Parting>,
}

/// How a recording was followed.
#[derive(Debug, Clone, PartialEq)]
pub enum Way {
    /// From its start to its end.
    Free,
    /// Over windows, each from a start of its own.
    Windows {
        /// Length of a window, s.
        window_s: f64,
        /// What the replay over the whole recording left.
        free: Vec<ChannelFit>,
    },
}

/// How far two runs of one model part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parting {
    /// The channel in which they part most.
    pub channel: Channel,
    /// RMS of their difference over the channel's floor.
    pub floors: f64,
}

impl Replayer<'_> {
    /// Replays the recording over its whole length, and over windows where two runs of the model itself part there by more than noise.
    ///
    /// # Errors
    /// As [`super::replay`].
    pub fn follow(&self, parameters: &Parameters, control: &Loop) -> Result<Followed, Error> {
        let Loop::Closed(controller) = control else {
            return Ok(Followed { replay: self.replay_open(parameters)?, way: Way::Free, parting: None });
        };
        let free = self.replay(parameters, control)?;
        let parting = self.parting(parameters, control, &free)?;
        let long = self.samples as f64 * self.recording.sample_period_s > LONG * WINDOW_S;
        let hunts = parting.filter(|p| p.floors > PARTED && long && self.recording.control_v.is_some());
        let Some(parting) = hunts.filter(|p| !explained(&free) && excess(&free) < WRONG * p.floors) else {
            return Ok(Followed { replay: free, way: Way::Free, parting });
        };
        let replay = self.replay_horizons(parameters, WINDOW_S, controller)?;
        let way = Way::Windows { window_s: WINDOW_S, free: free.channels };
        Ok(Followed { replay, way, parting: Some(parting) })
    }

    /// As [`Self::replay_windows`], and the control beside the one that the controller makes of the recorded measurements
    /// ([`control_fit`]): under the recorded control it has no other.
    ///
    /// # Errors
    /// As [`Self::replay_windows`].
    pub fn replay_horizons(
        &self,
        parameters: &Parameters,
        window_s: f64,
        controller: &ProportionalIntegral,
    ) -> Result<Replay, Error> {
        let mut replay = self.replay_windows(parameters, window_s)?;
        if let Some((fit, made)) = control_fit(parameters, self.recording, controller) {
            replay.channels.push(fit);
            Channel::Control.of_mut(&mut replay.simulated).copy_from_slice(&made);
        }
        Ok(replay)
    }

    /// How far two runs of the model part that differ in their start, as far as it is not known, and in the noise of the hub gyroscope;
    /// none where nothing that would tell was recorded.
    fn parting(
        &self,
        parameters: &Parameters,
        control: &Loop,
        quiet: &Replay,
    ) -> Result<Option<Parting>, Error> {
        let mut simulator = self.simulator(&Plant::lumped(parameters)?)?;
        let start = redrawn(&mut simulator, self, &quiet.start)?;
        let moved = self.run(&mut simulator, control, &start)?.readings;
        let recording = with_noise(self.recording, parameters.sensors.hub_gyro.noise_rms);
        let noisy = Replayer { recording: &recording, ..self.clone() };
        let noisy = noisy.run(&mut simulator, control, &quiet.start)?.readings;
        let apart = |fit: &ChannelFit, other: &ReadingColumns| {
            rms_of_difference(fit.channel.of(&quiet.simulated), fit.channel.of(other)) / fit.floor
        };
        let one = |fit: &ChannelFit| Parting {
            channel: fit.channel,
            floors: apart(fit, &moved).max(apart(fit, &noisy)),
        };
        let telling = quiet.channels.iter().filter(|fit| TELLING.contains(&fit.channel));
        Ok(telling.map(one).max_by(|a, b| a.floors.total_cmp(&b.floors)))
    }
}

/// The largest RMS error over its floor in the channels that tell.
fn excess(replay: &Replay) -> f64 {
    let telling = replay.channels.iter().filter(|fit| TELLING.contains(&fit.channel));
    telling.map(|fit| fit.rms_error / fit.floor).fold(0.0, f64::max)
}

/// The recording with noise on its demand: that of the loop with another noise of its gyroscope.
fn with_noise(recording: &Recording, size: f64) -> Recording {
    let mut noise = Noise::new(0);
    let mut noisy = recording.clone();
    noisy.demand_rad_s.iter_mut().flatten().for_each(|value| *value += size * noise.next());
    noisy
}

fn rms_of_difference(a: &[f64], b: &[f64]) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum();
    (squares / a.len().max(1) as f64).sqrt()
}
