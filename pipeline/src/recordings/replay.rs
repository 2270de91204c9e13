//! Recordings replayed on the project's model.

use counterpoise_diagnose::qualify::qualify;
use counterpoise_diagnose::replays::measured;
use counterpoise_models::Parameters;
use counterpoise_project::Project;
use counterpoise_simulate::recording::{Channel, Recording};
use counterpoise_simulate::replay::{Loop, Replay, ReplayMode, Replayer, SelectedReplay};

use super::read::ReadRecording;
use crate::PipelineError;
use crate::results::{RecordingResult, ReplayResult};

/// Over what length a recording is replayed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ReplayLength {
    /// From start to end; over windows if two runs of the model itself diverge by more than the noise.
    Automatic,
    /// From start to end.
    Whole,
    /// Over windows of a length.
    Windows {
        /// Length, s.
        window_s: f64,
    },
}

/// One recording replayed.
#[derive(Debug, Clone)]
pub struct FollowedRecording {
    /// Measured and simulated.
    pub replay: Replay,
    /// The fit as plain data.
    pub result: RecordingResult,
}

/// All recordings replayed.
#[derive(Debug, Clone)]
pub struct ReplayedRecordings {
    /// Each recording's replay, in the order of the recordings.
    pub replays: Vec<Replay>,
    /// The fits as plain data.
    pub result: ReplayResult,
}

/// Replays recordings on the project's mechanism.
///
/// # Errors
/// As [`replay_one`].
pub fn replay(
    project: &Project,
    read: &[ReadRecording],
    control: &Loop,
    length: ReplayLength,
) -> Result<ReplayedRecordings, PipelineError> {
    let mut all = ReplayedRecordings { replays: Vec::new(), result: ReplayResult { recordings: Vec::new() } };
    for item in read {
        let followed = replay_one(&project.plant, item, control, length)?;
        all.replays.push(followed.replay);
        all.result.recordings.push(followed.result);
    }
    Ok(all)
}

/// Replays one recording on a mechanism.
///
/// # Errors
/// [`PipelineError::CannotReplay`] with the simulator's reason.
pub fn replay_one(
    plant: &Parameters,
    item: &ReadRecording,
    control: &Loop,
    length: ReplayLength,
) -> Result<FollowedRecording, PipelineError> {
    let followed = Replayer::new(plant, &item.recording).and_then(|r| follow(&r, plant, control, length));
    let cannot = |cause| PipelineError::CannotReplay { recording: item.file.clone(), cause };
    let mut followed = followed.map_err(cannot)?;
    if followed.mode != ReplayMode::Free && !item.keeps_samples {
        // Columns made from others are not the measurements that the controller read, so its control cannot be compared.
        followed.replay.channels.retain(|fit| fit.channel != Channel::Control);
    }
    let remarks = item.remarks.iter().cloned().chain(sanity_remarks(plant, &item.recording)).collect();
    let result = RecordingResult::new(&item.file, &followed, remarks);
    Ok(FollowedRecording { replay: followed.replay, result })
}

fn follow(
    replayer: &Replayer,
    plant: &Parameters,
    control: &Loop,
    length: ReplayLength,
) -> Result<SelectedReplay, counterpoise_simulate::Error> {
    let (replay, mode) = match (length, control) {
        (ReplayLength::Automatic, _) => return replayer.replay_free_or_windowed(plant, control),
        (ReplayLength::Whole, Loop::Open) => (replayer.replay_open(plant)?, ReplayMode::Free),
        (ReplayLength::Whole, _) => (replayer.replay(plant, control)?, ReplayMode::Free),
        (ReplayLength::Windows { window_s }, Loop::Open) => {
            (replayer.replay_windowed(plant, window_s)?, ReplayMode::Windowed { window_s, free: Vec::new() })
        }
        (ReplayLength::Windows { window_s }, Loop::Closed(controller)) => {
            let replay = replayer.replay_windowed_with_control(plant, window_s, controller)?;
            (replay, ReplayMode::Windowed { window_s, free: Vec::new() })
        }
    };
    Ok(SelectedReplay { replay, mode, divergence: None })
}

/// Returns what is wrong with a recording itself, one sentence a channel.
fn sanity_remarks(plant: &Parameters, recording: &Recording) -> Vec<String> {
    let ratio = plant.gearbox.ratio;
    let remarks = measured(recording).map(|m| qualify(&recording.name, &m, ratio)).unwrap_or_default();
    remarks.into_iter().map(|remark| format!("{}: {}", remark.channel, remark.what)).collect()
}
