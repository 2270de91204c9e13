//! The one way from recordings of a project's machine to their replays: read them, choose the loop, simulate them. Command line, studio and
//! the package for Python all take it.

use counterpoise_models::Parameters;
use counterpoise_project::Project;
use counterpoise_recordings::{Recording, RecordingTable};
use counterpoise_simulate::replay::{RecordedController, ReplayLoop};

use super::read::{
    GapTreatment, ReadRecording, RecordingFile, control_for, loop_of, read_files, read_recording, read_table,
    recording_controller, without_demand,
};
use super::replay::{ReplayLength, ReplayedRecording, replay, replay_one};
use crate::PipelineError;
use crate::configuration::apply_configuration;

/// The source that drives the plant of a replay.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ReplayControl {
    /// The controller that was in the loop when the recordings were made; the recorded control if the project names none.
    #[default]
    RecordingController,
    /// The recorded control.
    RecordedControl,
}

/// The settings of a replay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReplaySettings {
    /// The source that drives the plant.
    pub control: ReplayControl,
    /// Over what length a recording is replayed.
    pub length: ReplayLength,
}

impl Default for ReplaySettings {
    fn default() -> Self {
        Self { control: ReplayControl::default(), length: ReplayLength::Automatic }
    }
}

/// A project that recordings are replayed on, with the controller that was in the loop when they were made.
#[derive(Debug, Clone)]
pub struct ProjectReplayer<'a> {
    project: &'a Project,
    controller: Option<RecordedController>,
    settings: ReplaySettings,
    control: ReplayLoop,
}

impl<'a> ProjectReplayer<'a> {
    /// Returns the replayer of a project. The project's own controller, if that made the recordings, is designed here, once.
    ///
    /// # Errors
    /// As [`recording_controller`].
    pub fn new(project: &'a Project, settings: ReplaySettings) -> Result<Self, PipelineError> {
        let controller = recording_controller(project)?;
        let control = match settings.control {
            ReplayControl::RecordingController => loop_of(project, controller.as_ref()),
            ReplayControl::RecordedControl => ReplayLoop::Open,
        };
        Ok(Self { project, controller, settings, control })
    }

    /// Reads files as the project maps their columns, gaps and stuck sensors repaired.
    ///
    /// # Errors
    /// As [`read_files`].
    pub fn read_files(&self, files: &[RecordingFile]) -> Result<Vec<ReadRecording>, PipelineError> {
        read_files(self.project, self.controller.as_ref(), files, GapTreatment::Repaired)
    }

    /// Reads one recording of a file, gaps and stuck sensors repaired: several parts if gaps split it.
    ///
    /// # Errors
    /// As [`read_recording`].
    pub fn read_recording(&self, recording: Recording) -> Result<Vec<ReadRecording>, PipelineError> {
        read_recording(self.project, self.controller.as_ref(), recording, GapTreatment::Repaired)
    }

    /// Replays recordings on the project's mechanism, in their order.
    ///
    /// # Errors
    /// As [`replay`].
    pub fn replay(&self, read: &[ReadRecording]) -> Result<Vec<ReplayedRecording>, PipelineError> {
        replay(self.project, read, &self.control, self.settings.length)
    }

    /// Replays one recording on another mechanism than the project's, such as that of a diagnosis.
    ///
    /// # Errors
    /// As [`replay_one`].
    pub fn replay_on(
        &self,
        mechanism: &Parameters,
        item: &ReadRecording,
    ) -> Result<ReplayedRecording, PipelineError> {
        replay_one(mechanism, item, &self.control, self.settings.length)
    }

    /// Reads the recordings of a table and replays them.
    ///
    /// # Errors
    /// As [`read_table`] and [`replay`].
    pub fn replay_table(&self, table: RecordingTable) -> Result<Vec<ReplayedRecording>, PipelineError> {
        let read = read_table(self.project, self.controller.as_ref(), &table)?;
        // a part of a large recording has a hundred megabytes, which the replay does not need
        drop(table);
        self.replay(&read)
    }

    /// Returns the names of the recordings that are replayed under their recorded control because they lack the demand, although the
    /// project names a controller that is to be run.
    pub fn without_demand<'b>(&self, read: impl IntoIterator<Item = &'b ReadRecording>) -> Vec<String> {
        match self.settings.control {
            ReplayControl::RecordingController => without_demand(self.project, read),
            ReplayControl::RecordedControl => Vec::new(),
        }
    }
}

/// Replays the files of a diagnosis on the mechanism that it improved, in the project's configuration: all in the one loop in which the
/// diagnosis compared them.
///
/// # Errors
/// As [`read_files`] and [`replay_one`].
pub fn replay_improved(
    project: &Project,
    improved: &Parameters,
    files: &[RecordingFile],
) -> Result<Vec<ReplayedRecording>, PipelineError> {
    let controller = recording_controller(project)?;
    let read = read_files(project, controller.as_ref(), files, GapTreatment::Repaired)?;
    let control = control_for(project, controller.as_ref(), read.iter().map(|item| &item.recording));
    let improved = apply_configuration(project, improved)?;
    read.iter().map(|item| replay_one(&improved, item, &control, ReplayLength::Automatic)).collect()
}
