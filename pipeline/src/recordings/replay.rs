//! Recordings replayed on the project's model.

use counterpoise_diagnose::fitting::fitted_start::fit_start;
use counterpoise_diagnose::learning::visited_ranges::VisitedRanges;
use counterpoise_diagnose::recording::measured_signals::read_signals;
use counterpoise_diagnose::recording::sanity_checks::{SanityRemark, check_signals};
use counterpoise_diagnose::tolerance::{EXPLAINED, SAMPLES_AT_MOST};
use counterpoise_models::Parameters;
use counterpoise_models::plant::Body;
use counterpoise_project::{Project, StructureChoice};
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::replay::{Replay, ReplayLoop, ReplayMode, Replayer, SelectedReplay};

use super::column_remarks::ColumnRemark;
use super::read::{ReadRecording, unused_columns};
use super::tracks::{ChannelTrack, compare_channels};
use crate::PipelineError;
use crate::build_plant_model;
use crate::model::two_inertias;
use crate::tolerance::START_WORTH;

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
pub struct ReplayedRecording {
    /// Name of the recording.
    pub file: String,
    /// Measured and simulated, with the length over which it was replayed.
    pub followed: SelectedReplay,
    /// Remarks on the recording itself.
    pub remarks: Vec<ColumnRemark>,
    /// Channels, measured and simulated.
    pub tracks: Vec<ChannelTrack>,
}

/// Replays recordings on the project's mechanism as it is modelled, in their order: in its configuration, and with the modes of its finite elements
/// if the model has them.
///
/// # Errors
/// As [`replay_one`], and a structure that makes no mechanism.
pub fn replay(
    project: &Project,
    read: &[ReadRecording],
    control: &ReplayLoop,
    length: ReplayLength,
) -> Result<Vec<ReplayedRecording>, PipelineError> {
    let (parameters, structure) = match project.model.structure {
        StructureChoice::Lumped => (two_inertias(project)?, None),
        StructureChoice::Beam | StructureChoice::Import => {
            let modelled = build_plant_model(project)?;
            let body = modelled.plant.body().clone();
            (modelled.parameters, Some(body))
        }
    };
    let mechanism = Mechanism { parameters: &parameters, structure: structure.as_ref() };
    read.iter().map(|item| replay_on(&mechanism, item, control, length)).collect()
}

/// A mechanism with its structure, if that is not two inertias.
struct Mechanism<'a> {
    parameters: &'a Parameters,
    structure: Option<&'a Body>,
}

/// Replays one recording on a mechanism; under its recorded control if another controller than the project's was in the loop, or if the
/// demand was not recorded.
///
/// # Errors
/// [`PipelineError::CannotReplay`] with the simulator's reason.
pub fn replay_one(
    plant: &Parameters,
    item: &ReadRecording,
    control: &ReplayLoop,
    length: ReplayLength,
) -> Result<ReplayedRecording, PipelineError> {
    replay_on(&Mechanism { parameters: plant, structure: None }, item, control, length)
}

/// A recording that is made ready for replays on one mechanism after another: the motion of the platform and the state in which an exported controller
/// was at the first sample are found once.
#[derive(Debug, Clone)]
pub struct PreparedRecording<'a> {
    item: &'a ReadRecording,
    control: &'a ReplayLoop,
    replayer: Replayer<'a>,
}

impl<'a> PreparedRecording<'a> {
    /// Prepares a recording for mechanisms with the platform's sensors of the first one.
    ///
    /// # Errors
    /// [`PipelineError::CannotReplay`] with the simulator's reason.
    pub fn new(
        first: &Parameters,
        item: &'a ReadRecording,
        control: &'a ReplayLoop,
    ) -> Result<Self, PipelineError> {
        let control = if item.plays_control_back() { &ReplayLoop::Open } else { control };
        let replayer = Replayer::new(first, &item.recording).map_err(|cause| cannot_replay(item, cause))?;
        Ok(Self { item, control, replayer })
    }

    /// Returns the recording.
    pub fn recording(&self) -> &'a Recording {
        &self.item.recording
    }

    /// Replays the recording whole on a mechanism from the start that its first samples give, which is quicker than
    /// [`Self::replay_from_fitted_start`]: a start that is fitted takes a dozen replays.
    ///
    /// # Errors
    /// [`PipelineError::CannotReplay`] with the simulator's reason.
    pub fn replay_from_given_start(&self, plant: &Parameters) -> Result<Replay, PipelineError> {
        self.replay_whole(plant, |_, found| found)
    }

    /// Replays the recording whole on a mechanism, as [`replay_one`] does.
    ///
    /// # Errors
    /// [`PipelineError::CannotReplay`] with the simulator's reason.
    pub fn replay_from_fitted_start(&self, plant: &Parameters) -> Result<Replay, PipelineError> {
        self.replay_whole(plant, |replayer, found| from_fitted_start(replayer, plant, self.control, found))
    }

    fn replay_whole(
        &self,
        plant: &Parameters,
        improve: impl Fn(&Replayer, SelectedReplay) -> SelectedReplay,
    ) -> Result<Replay, PipelineError> {
        let replayer = self.replayer.with_platform_sensors_of(plant);
        let found = select_replay(&replayer, plant, self.control, ReplayLength::Whole);
        found.map(|found| improve(&replayer, found).replay).map_err(|cause| cannot_replay(self.item, cause))
    }
}

fn cannot_replay(item: &ReadRecording, cause: counterpoise_simulate::Error) -> PipelineError {
    let unused = unused_columns([item]);
    PipelineError::CannotReplay { recording: item.file.clone(), cause: Box::new(cause), unused }
}

fn replay_on(
    mechanism: &Mechanism<'_>,
    item: &ReadRecording,
    control: &ReplayLoop,
    length: ReplayLength,
) -> Result<ReplayedRecording, PipelineError> {
    let plant = mechanism.parameters;
    let replayer = Replayer::new(plant, &item.recording).map(|replayer| match mechanism.structure {
        Some(body) => replayer.with_whole_body(body.clone()),
        None => replayer,
    });
    let control = if item.plays_control_back() { &ReplayLoop::Open } else { control };
    let followed = replayer.and_then(|replayer| match mechanism.structure {
        Some(_) => select_replay(&replayer, plant, control, length),
        None => {
            let found = select_replay(&replayer, plant, control, length)?;
            Ok(from_fitted_start(&replayer, plant, control, found))
        }
    });
    let mut followed = followed.map_err(|cause| cannot_replay(item, cause))?;
    if followed.mode != ReplayMode::Free && !item.keeps_samples {
        // Columns made from others are not the measurements that the controller read, so its control cannot be compared.
        followed.replay.channels.retain(|fit| fit.channel != Channel::Control);
    }
    let remarks = item.remarks.iter().cloned().chain(anomalies(plant, &item.recording)).collect();
    let tracks = compare_channels(plant, &item.recording, &followed.replay, None);
    Ok(ReplayedRecording { file: item.file.clone(), followed, remarks, tracks })
}

fn select_replay(
    replayer: &Replayer,
    plant: &Parameters,
    control: &ReplayLoop,
    length: ReplayLength,
) -> Result<SelectedReplay, counterpoise_simulate::Error> {
    let (replay, mode) = match (length, control) {
        (ReplayLength::Automatic, _) => {
            return replayer.replay_free_or_windowed(plant, control);
        }
        (ReplayLength::Whole, ReplayLoop::Open) => (replayer.replay_open(plant)?, ReplayMode::Free),
        (ReplayLength::Whole, _) => {
            let replay = replayer.replay(plant, control)?;
            return Ok(SelectedReplay { replay, mode: ReplayMode::Free, divergence: None });
        }
        (ReplayLength::Windows { window_s }, ReplayLoop::Open) => {
            (replayer.replay_windowed(plant, window_s)?, ReplayMode::Windowed { window_s, free: Vec::new() })
        }
        (ReplayLength::Windows { window_s }, ReplayLoop::Closed(controller)) => {
            let replay = replayer.replay_windowed_with_control(plant, window_s, controller)?;
            (replay, ReplayMode::Windowed { window_s, free: Vec::new() })
        }
    };
    Ok(SelectedReplay { replay, mode, divergence: None })
}

/// Returns the same replay from the initial state that the diagnosis would fit, if the first moments of the recording do not show it: the
/// figures of a diagnosis and those of a replay of what it saved are then the same.
fn from_fitted_start(
    replayer: &Replayer,
    plant: &Parameters,
    control: &ReplayLoop,
    selected: SelectedReplay,
) -> SelectedReplay {
    let free = selected.mode == ReplayMode::Free;
    let before = largest_ratio(&selected.replay);
    if !free
        || *control == ReplayLoop::Open
        || before < EXPLAINED
        || replayer.recording().len() > SAMPLES_AT_MOST
    {
        return selected;
    }
    let start = fit_start(plant, control, replayer.recording(), &selected.replay.start);
    let again = start.and_then(|start| replayer.replay_from(plant, control, &start).ok());
    match again.filter(|again| largest_ratio(again) < START_WORTH * before) {
        Some(replay) => SelectedReplay { replay, ..selected },
        None => selected,
    }
}

/// Returns the largest RMS error of a channel that the model explains, over its floor.
fn largest_ratio(replay: &Replay) -> f64 {
    let driven = |channel: Channel| matches!(channel, Channel::PlatformRate | Channel::PlatformAccel);
    let compared = replay.channels.iter().filter(|fit| !driven(fit.channel));
    compared.map(|fit| fit.residual_over_floor()).fold(0.0, f64::max)
}

/// Returns what is wrong with a recording itself.
fn anomalies(plant: &Parameters, recording: &Recording) -> Vec<ColumnRemark> {
    let ratio = plant.gearbox.ratio;
    let Some(signals) = read_signals(recording, plant.sensors.measured) else { return Vec::new() };
    let remark =
        |found: SanityRemark| ColumnRemark::Anomaly { channel: found.channel, anomaly: found.anomaly };
    let mut all: Vec<ColumnRemark> =
        check_signals(&recording.name, &signals, ratio).into_iter().map(remark).collect();
    if !plant.learned.is_empty() {
        let visited = VisitedRanges::of(plant, std::slice::from_ref(&signals));
        let beyond = plant.learned.iter().filter_map(|element| visited.range_exceedance(element));
        all.extend(beyond.map(ColumnRemark::RangeExceeded));
    }
    all
}
