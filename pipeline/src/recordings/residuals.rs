//! The part of recordings that a model leaves unexplained: spectra and tests of the residuals, and responses measured and simulated.

use counterpoise_diagnose::fitting::residual_tests::{MeasuredSignal, ResidualTest, test_residual};
use counterpoise_recordings::Channel;
use counterpoise_verify::signals::welch::{Spectra, WelchOptions, welch};

use super::tracks::{ChannelTrack, ResidualColumn, TrackColumn};

/// Longest segment of a spectrum, samples, and the number of segments below which it is shorter: six segments average enough for a
/// coherence that means something.
const SEGMENT: (usize, usize) = (2048, 6);
/// Probability of the confidence intervals.
const CONFIDENCE: f64 = 0.95;

/// The residuals of recordings, of the model as it was and of the improved model.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ResidualStudy {
    /// Spectra of control and hub rate and of their residuals.
    pub spectra: Vec<ResidualSpectra>,
    /// Responses from control to hub rate, one entry a recording.
    pub responses: Vec<ControlResponse>,
    /// Tests of the residual of every channel.
    pub tests: Vec<TestedResidual>,
}

/// The spectrum of a measured channel, and those of its residuals.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualSpectra {
    /// Name of the recording.
    pub recording: String,
    /// The channel.
    pub channel: Channel,
    /// Measured spectra.
    pub measured: Spectra,
    /// Residual of the model as it was; `None` if the recording is too short.
    pub before: Option<Spectra>,
    /// Residual of the improved model; `None` if there is none.
    pub after: Option<Spectra>,
}

/// The response from control to hub rate in one recording.
#[derive(Debug, Clone, PartialEq)]
pub struct ControlResponse {
    /// Name of the recording.
    pub recording: String,
    /// Measured spectra.
    pub measured: Spectra,
    /// Simulation by the model; `None` if the recording is too short.
    pub before: Option<Spectra>,
    /// Simulation by the improved model; `None` if there is none.
    pub after: Option<Spectra>,
}

/// The tests of the residual of one channel.
#[derive(Debug, Clone, PartialEq)]
pub struct TestedResidual {
    /// Name of the recording.
    pub recording: String,
    /// The channel.
    pub channel: Channel,
    /// Sample period, s.
    pub period_s: f64,
    /// Of the model as it was; `None` if the residual is too short to be tested.
    pub before: Option<ResidualTest>,
    /// Of the improved model; `None` if there is none.
    pub after: Option<ResidualTest>,
}

/// Studies the residuals of tracks.
pub fn study_residuals(tracks: &[ChannelTrack]) -> ResidualStudy {
    let mut recordings: Vec<&str> = tracks.iter().map(|t| t.recording.as_str()).collect();
    recordings.dedup();
    ResidualStudy {
        spectra: tracks.iter().filter_map(spectra).collect(),
        responses: recordings.into_iter().filter_map(|name| response(tracks, name)).collect(),
        tests: tracks.iter().map(|track| test_track(tracks, track)).collect(),
    }
}

fn find<'a>(tracks: &'a [ChannelTrack], recording: &str, channel: Channel) -> Option<&'a ChannelTrack> {
    tracks.iter().find(|t| t.recording == recording && t.channel == channel)
}

/// Returns averaged spectra in segments as long as the record allows.
fn average_spectra(x: &[f64], y: &[f64], period_s: f64) -> Option<Spectra> {
    let segment = SEGMENT.0.min(2 * x.len() / (SEGMENT.1 + 1)) / 2 * 2;
    welch(x, y, period_s, WelchOptions { segment, confidence: CONFIDENCE }).ok()
}

fn spectra(track: &ChannelTrack) -> Option<ResidualSpectra> {
    if !matches!(track.channel, Channel::Control | Channel::HubRate) {
        return None;
    }
    let own = |signal: &[f64]| average_spectra(signal, signal, track.period_s);
    let of_residual = |run| own(track.residuals.column(run));
    Some(ResidualSpectra {
        recording: track.recording.clone(),
        channel: track.channel,
        measured: own(track.signals.column(TrackColumn::Measured))?,
        before: of_residual(ResidualColumn::Before),
        after: if track.residuals.has(ResidualColumn::After) {
            of_residual(ResidualColumn::After)
        } else {
            None
        },
    })
}

fn response(tracks: &[ChannelTrack], recording: &str) -> Option<ControlResponse> {
    let (control, rate) =
        (find(tracks, recording, Channel::Control)?, find(tracks, recording, Channel::HubRate)?);
    let of = |run| average_spectra(control.signals.column(run), rate.signals.column(run), rate.period_s);
    Some(ControlResponse {
        recording: recording.to_owned(),
        measured: of(TrackColumn::Measured)?,
        before: of(TrackColumn::Before),
        after: if rate.signals.column(TrackColumn::After).is_empty() { None } else { of(TrackColumn::After) },
    })
}

fn test_track(tracks: &[ChannelTrack], track: &ChannelTrack) -> TestedResidual {
    let signals = [Channel::Control, Channel::HubRate].map(|channel| {
        find(tracks, &track.recording, channel)
            .map(|t| MeasuredSignal { channel, values: t.signals.column(TrackColumn::Measured) })
    });
    let signals: Vec<MeasuredSignal<'_>> = signals.into_iter().flatten().collect();
    let test = |run| test_residual(track.residuals.column(run), &signals);
    TestedResidual {
        recording: track.recording.clone(),
        channel: track.channel,
        period_s: track.period_s,
        before: test(ResidualColumn::Before),
        after: test(ResidualColumn::After),
    }
}
