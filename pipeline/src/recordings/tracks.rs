//! Channels of recordings as they were measured and as models simulate them, ready to be drawn.

use std::path::Path;

use crate::exchange::{RunHistory, RunSignal};
use crate::recordings::amplitude_density::AmplitudeDensity;
use crate::recordings::channel_words::{ChannelWords, channel_words};
use counterpoise_models::{ControlledQuantity, Parameters};
use counterpoise_recordings::{Channel, ColumnName, Recording, Signals};
use counterpoise_simulate::replay::{ChannelFit, Replay, ReplayLoop, replay};

/// One channel of one recording, measured and simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelTrack {
    /// Name of the recording, without folder and ending.
    pub recording: String,
    /// The channel.
    pub channel: Channel,
    /// What the machine has in it.
    pub words: ChannelWords,
    /// Sample period, s.
    pub period_s: f64,
    /// The samples of every run.
    pub signals: Signals<TrackColumn>,
    /// The residual of each model, measured less simulated.
    pub residuals: Signals<ResidualColumn>,
    /// Power of the residual of the model as it was, relative to that of what was measured.
    pub relative_residual_power: f64,
}

/// A run of a [`ChannelTrack`]: a column of its array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrackColumn {
    /// Recorded values.
    Measured,
    /// Values simulated by the model as it was.
    Before,
    /// Values simulated by the improved model; a track has no such column if there is none.
    After,
}

impl ColumnName for TrackColumn {
    fn index(self) -> usize {
        self as usize
    }
}

impl ChannelTrack {
    /// Returns the track as plain data, under the name of its recording and its channel.
    pub fn history(&self) -> RunHistory {
        let runs = [
            (TrackColumn::Measured, "measured"),
            (TrackColumn::Before, "before"),
            (TrackColumn::After, "after"),
        ];
        let there = runs.into_iter().filter(|(column, _)| self.signals.has(*column));
        let signals = there.map(|(column, name)| RunSignal::new(name, self.signals.column(column).to_vec()));
        RunHistory::new(format!("{} {}", self.recording, self.channel.name()), self.period_s, signals)
    }

    /// Returns the amplitude spectral density of what was measured; `None` if it is too short or does not move.
    pub fn measured_density(&self) -> Option<AmplitudeDensity> {
        AmplitudeDensity::of(self.signals.column(TrackColumn::Measured), self.period_s)
    }

    /// Returns that of the residual of the model as it was.
    pub fn residual_density(&self) -> Option<AmplitudeDensity> {
        AmplitudeDensity::of(self.residuals.column(ResidualColumn::Before), self.period_s)
    }

    /// Returns the quantity that the loop controls, if this is the track of its reading.
    pub fn controlled_quantity(&self) -> ControlledQuantity {
        ControlledQuantity::of_unit(self.channel.unit())
    }

    /// Returns a track with the residuals of its models.
    fn new(
        recording: &Recording,
        channel: Channel,
        words: ChannelWords,
        signals: Signals<TrackColumn>,
    ) -> Self {
        let measured = signals.column(TrackColumn::Measured);
        let residual = |run| measured.iter().zip(signals.column(run)).map(|(m, s)| m - s).collect();
        let models = [TrackColumn::Before, TrackColumn::After].into_iter().filter(|run| signals.has(*run));
        let residuals: Vec<Vec<f64>> = models.map(residual).collect();
        let before = signals.column(TrackColumn::Before);
        let sum: f64 = measured.iter().zip(before).map(|(m, b)| (m - b).powi(2)).sum();
        let power: f64 = measured.iter().map(|m| m * m).sum();
        Self {
            recording: short_name(&recording.name),
            channel,
            words,
            period_s: recording.sample_period_s,
            residuals: Signals::stack(residuals.iter().map(Vec::as_slice)),
            relative_residual_power: sum / power.max(f64::MIN_POSITIVE),
            signals,
        }
    }
}

/// A residual of a [`ChannelTrack`]: a column of its array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ResidualColumn {
    /// Of the model as it was.
    Before,
    /// Of the improved model; a track has no such column if there is none.
    After,
}

impl ColumnName for ResidualColumn {
    fn index(self) -> usize {
        self as usize
    }
}

/// Channels that are compared with the simulation.
const COMPARED: [Channel; 4] = [Channel::Control, Channel::HubRate, Channel::MotorRate, Channel::HubPosition];

/// Returns the channels of recordings replayed on a mechanism and, if it differs, on an improved one. A recording that the
/// mechanism cannot replay is left out.
pub fn replay_before_and_after(
    recordings: &[Recording],
    control: &ReplayLoop,
    plant: &Parameters,
    improved: &Parameters,
) -> Vec<ChannelTrack> {
    let is_improved = improved != plant;
    let of = |recording: &Recording| {
        let before = replay(plant, recording, control).ok()?;
        let after = is_improved.then(|| replay(improved, recording, control).ok()).flatten();
        Some(compare_channels(plant, recording, &before, after.as_ref()))
    };
    recordings.iter().filter_map(of).flatten().collect()
}

/// Returns the compared channels of one recording of a machine beside its replays.
pub fn compare_channels(
    plant: &Parameters,
    recording: &Recording,
    before: &Replay,
    after: Option<&Replay>,
) -> Vec<ChannelTrack> {
    let track = |channel: Channel| {
        let runs = [Some(before), after].into_iter().flatten();
        let simulated = runs.map(|replay| replay.simulated.channel(channel));
        let columns = std::iter::once(recording.samples(channel)?).chain(simulated);
        let words = channel_words(plant, channel);
        Some(ChannelTrack::new(recording, channel, words, Signals::stack(columns)))
    };
    COMPARED.into_iter().filter_map(track).collect()
}

/// Simulation of a channel of a recording by a model.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedChannel {
    /// The simulated samples.
    pub signal: Vec<f64>,
    /// The residual, measured less simulated.
    pub residual: Vec<f64>,
    /// RMS of the residual over the noise floor of the project's model; `None` if that does not simulate the channel.
    pub residual_over_floor: Option<f64>,
}

/// Returns what the project's model and an improved one make of a channel of a recording; `None` of a model that was not replayed, or that
/// does not simulate the channel.
pub fn simulate_channel(
    recording: &Recording,
    channel: Channel,
    models: [Option<&Replay>; 2],
) -> [Option<SimulatedChannel>; 2] {
    let fit = |replay: &Replay| replay.channels.iter().copied().find(|fit| fit.channel == channel);
    let floor = models[0].and_then(fit).map(|fit| fit.floor);
    models.map(|replay| {
        let (replay, measured) = (replay?, recording.samples(channel)?);
        let own = fit(replay)?;
        let signal = replay.simulated.channel(channel).to_vec();
        let residual =
            signal.iter().zip(measured).map(|(simulated, measured)| measured - simulated).collect();
        let residual_over_floor = floor.map(|floor| ChannelFit { floor, ..own }.residual_over_floor());
        Some(SimulatedChannel { signal, residual, residual_over_floor })
    })
}

/// Returns the name of a recording without its folder and ending, with the part of it that is meant.
fn short_name(name: &str) -> String {
    let (path, part) = name.split_once(", ").map_or((name, String::new()), |(p, w)| (p, format!(", {w}")));
    let stem = Path::new(path).file_stem().map(|s| s.to_string_lossy().into_owned());
    stem.unwrap_or_else(|| path.to_owned()) + &part
}
