//! Recordings that were not part of a diagnosis, replayed by the model as it was and by the improved one.

use counterpoise_models::Parameters;
use counterpoise_project::Project;
use counterpoise_recordings::Channel;
use counterpoise_simulate::replay::{ChannelFit, ReplayMode};

use super::column_remarks::ColumnRemark;
use super::read::{GapTreatment, RecordingFile, control_for, read_files, recording_controller};
use super::replay::{ReplayLength, replay_one};
use crate::PipelineError;
use crate::configuration::apply_configuration;
use crate::tolerance::RESIDUAL_ABOVE_FLOOR;

/// One held-out recording by both models, over the same length.
#[derive(Debug, Clone)]
pub struct HeldOutRecording {
    /// Name of the recording.
    pub file: String,
    /// Channels that both models were compared in.
    pub channels: Vec<HeldOutFit>,
    /// Length of the windows over which both were replayed, s; `None` from start to end.
    pub window_s: Option<f64>,
    /// Remarks on the recording.
    pub remarks: Vec<ColumnRemark>,
}

/// The residuals of one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldOutFit {
    /// The channel.
    pub channel: Channel,
    /// Noise floor, in the channel's unit.
    pub floor: f64,
    /// RMS of the residual of the model as it was.
    pub before: f64,
    /// RMS of the residual of the improved model.
    pub after: f64,
}

impl HeldOutFit {
    /// Returns the RMS of the residual over the noise floor, of the model as it was and of the improved one.
    pub fn residuals_over_floor(&self) -> [f64; 2] {
        [self.before / self.floor, self.after / self.floor]
    }
}

/// Improvement of the prediction of a held-out recording by the improved model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldOutComparison {
    /// Largest RMS of a channel's residual over its noise floor, with the model as it was.
    pub before: f64,
    /// The same with the improved model.
    pub after: f64,
    /// Share of the residual's power that the improved model removes, mean over the channels that were above their noise floor; 0 if
    /// none was.
    pub power_removed: f64,
    /// Outcome.
    pub outcome: HeldOutOutcome,
}

/// Outcome of the improved model on a held-out recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeldOutOutcome {
    /// The model as it was explains the recording: there is nothing to improve.
    ExplainedBefore,
    /// The fit improves.
    Improved,
    /// The improved model does not predict it better.
    NotImproved,
}

impl HeldOutRecording {
    /// Returns the channels that show how good a model is, in the order of their names. Those of the platform drive the model, so they are the same
    /// in every replay.
    pub fn judged_channels(&self) -> Vec<HeldOutFit> {
        let mut judged: Vec<HeldOutFit> =
            self.channels.iter().copied().filter(|fit| !fit.channel.is_of_platform()).collect();
        judged.sort_by_key(|fit| fit.channel.name());
        judged
    }

    /// Compares both models over the judged channels.
    pub fn comparison(&self) -> HeldOutComparison {
        let channels = self.judged_channels();
        let worst =
            |model: usize| channels.iter().map(|c| c.residuals_over_floor()[model]).fold(0.0, f64::max);
        let [before, after] = [worst(0), worst(1)];
        let removed: Vec<f64> = channels
            .iter()
            .filter(|c| c.before > RESIDUAL_ABOVE_FLOOR * c.floor)
            .map(|c| 1.0 - (c.after / c.before).powi(2))
            .collect();
        let power_removed =
            if removed.is_empty() { 0.0 } else { removed.iter().sum::<f64>() / removed.len() as f64 };
        let outcome = match (removed.is_empty(), after < before) {
            (true, _) => HeldOutOutcome::ExplainedBefore,
            (false, true) => HeldOutOutcome::Improved,
            (false, false) => HeldOutOutcome::NotImproved,
        };
        HeldOutComparison { before, after, power_removed, outcome }
    }
}

/// Returns the channels that both replays compare.
fn compare_channels(before: &[ChannelFit], after: &[ChannelFit]) -> Vec<HeldOutFit> {
    let one = |fit: &ChannelFit| {
        let same = before.iter().find(|other| other.channel == fit.channel)?;
        Some(HeldOutFit {
            channel: fit.channel,
            floor: fit.floor,
            before: same.rms_error,
            after: fit.rms_error,
        })
    };
    after.iter().filter_map(one).collect()
}

/// Replays files that no diagnosis was given, on the project's mechanism and on an improved one, both in the project's configuration.
///
/// # Errors
/// As [`read_files`] and [`replay_one`].
pub fn replay_held_out(
    project: &Project,
    improved: &Parameters,
    files: &[RecordingFile],
) -> Result<Vec<HeldOutRecording>, PipelineError> {
    let plant = apply_configuration(project, &project.plant)?;
    let improved = apply_configuration(project, improved)?;
    let controller = recording_controller(project)?;
    let read = read_files(project, controller.as_ref(), files, GapTreatment::Repaired)?;
    let control = control_for(project, controller.as_ref(), read.iter().map(|item| &item.recording));
    let one = |item| {
        let after = replay_one(&improved, item, &control, ReplayLength::Automatic)?;
        // both over the same length, so that the figures can be compared
        let (length, window_s) = match after.followed.mode {
            ReplayMode::Free => (ReplayLength::Whole, None),
            ReplayMode::Windowed { window_s, .. } => (ReplayLength::Windows { window_s }, Some(window_s)),
        };
        let before = replay_one(&plant, item, &control, length)?;
        Ok(HeldOutRecording {
            file: after.file,
            channels: compare_channels(&before.followed.replay.channels, &after.followed.replay.channels),
            window_s,
            remarks: after.remarks,
        })
    };
    read.iter().map(one).collect()
}
