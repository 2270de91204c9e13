//! Recordings read as a project maps their columns.

use counterpoise_diagnose::recording::gap_repair::{Repair, RepairedPart, repair_gaps};
use counterpoise_diagnose::recording::sanity_checks::check_control;
use counterpoise_project::Project;
use counterpoise_project::resolve::controller::RecordingController;
use counterpoise_recordings::{Channel, Error, Mapping, Recording, RecordingTable, Remark};
use counterpoise_simulate::replay::{RecordedController, ReplayLoop};

use super::column_remarks::{ColumnRemark, UnusedColumn};
use super::converter_range::remove_impossible;
use crate::{PipelineError, build_plant_model, reduce_plant, synthesise};

/// A file with recordings, handed in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordingFile {
    /// Name of the file, as messages quote it.
    pub name: String,
    /// Content.
    pub bytes: Vec<u8>,
}

/// A recording that was read, with what was found on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadRecording {
    /// Name of the recording: its file, and the part of it if there are several.
    pub file: String,
    /// The recording.
    pub recording: Recording,
    /// Remarks on its columns.
    pub remarks: Vec<ColumnRemark>,
    /// `true` if demand, control and hub rate are the samples that were written, not made from other columns or resampled.
    pub keeps_samples: bool,
}

/// Returns the columns of the files of recordings that were not read, or that have nearly the name of a channel that is missing.
pub(super) fn unused_columns<'a>(read: impl IntoIterator<Item = &'a ReadRecording>) -> Vec<UnusedColumn> {
    let unused = |item: &'a ReadRecording| {
        let of_column = |remark: &Remark| {
            let is_unused = matches!(remark, Remark::Unread { .. } | Remark::NearlyNamed { .. });
            is_unused.then(|| UnusedColumn { recording: item.file.clone(), remark: remark.clone() })
        };
        item.recording.remarks.iter().filter_map(of_column).collect::<Vec<_>>()
    };
    read.into_iter().flat_map(unused).collect()
}

/// Treatment of gaps and of stuck sensors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GapTreatment {
    /// Short gaps are filled; a long one splits the recording; a channel whose sensor is stuck loses those samples.
    Repaired,
    /// They stay as they were written.
    AsWritten,
}

/// Reads files as the project maps their columns; one that has no clock takes the sample period of the project's interface.
///
/// `controller` is the project's [`recording_controller`].
///
/// # Errors
/// [`PipelineError::UnreadableRecording`] if a file cannot be read as it is mapped, [`PipelineError::NothingToReplay`] if the
/// gaps of a recording leave no part of it.
pub fn read_files(
    project: &Project,
    controller: Option<&RecordedController>,
    files: &[RecordingFile],
    gaps: GapTreatment,
) -> Result<Vec<ReadRecording>, PipelineError> {
    let mut all = Vec::new();
    for file in files {
        let (_, recordings) =
            read_table_and_recordings(project, file).map_err(PipelineError::UnreadableRecording)?;
        for recording in recordings {
            all.extend(read_recording(project, controller, recording, gaps)?);
        }
    }
    Ok(all)
}

/// Returns the table of a file and its recordings as the project maps them.
///
/// # Errors
/// The file cannot be decoded, or its columns do not fit the mapping.
pub fn read_table_and_recordings(
    project: &Project,
    file: &RecordingFile,
) -> Result<(RecordingTable, Vec<Recording>), Error> {
    let table = RecordingTable::read(&file.bytes, &file.name)?;
    let recordings = mapping(project).recordings(&table)?;
    Ok((table, recordings))
}

/// Returns how the project maps columns, with the sample period of its interface for a table without a clock.
fn mapping(project: &Project) -> Mapping {
    let clock = project.recording.sample_period_s.or(Some(project.plant.interface.sample_period_s));
    let units = project.channel_units();
    Mapping { sample_period_s: clock, units, ..project.recording.clone() }
}

/// Reads the recordings of a table as the project maps its columns, gaps and stuck sensors repaired; see [`read_files`].
///
/// `controller` is the project's [`recording_controller`].
///
/// # Errors
/// As [`read_files`].
pub fn read_table(
    project: &Project,
    controller: Option<&RecordedController>,
    table: &RecordingTable,
) -> Result<Vec<ReadRecording>, PipelineError> {
    let mut all = Vec::new();
    for recording in mapping(project).recordings(table).map_err(PipelineError::UnreadableRecording)? {
        all.extend(read_recording(project, controller, recording, GapTreatment::Repaired)?);
    }
    Ok(all)
}

/// Returns the controller that was in the loop when the project's recordings were made; `None` if the project names none.
///
/// Each call designs the project's own controller again, so call it once.
///
/// # Errors
/// The project's own controller is meant, and the project does not design one; or the file of an exported one was not read.
pub fn recording_controller(project: &Project) -> Result<Option<RecordedController>, PipelineError> {
    match &project.recording_controller {
        None => Ok(None),
        Some(RecordingController::ProportionalIntegral(controller)) => Ok(Some(controller.clone().into())),
        Some(RecordingController::Position(controller)) => Ok(Some(controller.clone().into())),
        Some(RecordingController::Project) => {
            let modelled = build_plant_model(project)?;
            let synthesised = synthesise(project, &modelled, &reduce_plant(project, &modelled)?)?;
            Ok(Some(synthesised.sampled.controller.into()))
        }
        Some(RecordingController::Exported(source)) => match &source.content {
            Some(content) => Ok(Some(content.controller.clone().into())),
            None => Err(PipelineError::File {
                name: source.file.clone(),
                section: "recording_controller",
                problem: "the file was not read with the project".to_owned(),
            }),
        },
    }
}

/// Returns the parts of one recording: several if gaps split it. Remarks about the whole recording stand with the first.
///
/// `controller` is the project's [`recording_controller`].
///
/// # Errors
/// [`PipelineError::NothingToReplay`] if the gaps leave no part of the recording.
pub fn read_recording(
    project: &Project,
    controller: Option<&RecordedController>,
    mut whole: Recording,
    gaps: GapTreatment,
) -> Result<Vec<ReadRecording>, PipelineError> {
    let keeps_samples = project.recording.keeps_samples(&whole);
    let name = whole.name.clone();
    let mut remarks: Vec<ColumnRemark> = whole.remarks.iter().cloned().map(ColumnRemark::File).collect();
    let beyond = remove_impossible(&project.plant, &mut whole);
    remarks.extend(beyond.into_iter().map(|(channel, found)| ColumnRemark::BeyondRange { channel, found }));
    let parts = match gaps {
        GapTreatment::AsWritten => vec![(name.clone(), whole)],
        GapTreatment::Repaired => {
            let repaired = repair_gaps(&whole, project.plant.gearbox.ratio);
            let done = |(part, repair): (RepairedPart, Repair)| ColumnRemark::Repair { part, repair };
            remarks.extend(repaired.repairs.into_iter().map(done));
            repaired.parts.into_iter().map(|part| (part.name.clone(), part)).collect()
        }
    };
    if parts.is_empty() {
        return Err(PipelineError::NothingToReplay { recording: name, remarks });
    }
    // Columns made from others are not the measurements that the controller read, so its control cannot be compared.
    let controller = controller.filter(|_| keeps_samples);
    let one = |(file, recording): (String, Recording)| {
        let foreign = foreign_controller(project, controller, &recording);
        let remarks = foreign.into_iter().chain(std::mem::take(&mut remarks)).collect();
        ReadRecording { file, recording, remarks, keeps_samples }
    };
    Ok(parts.into_iter().map(one).collect())
}

/// Returns a remark if the recorded control is not what the project's recording controller makes of the recorded readings.
fn foreign_controller(
    project: &Project,
    controller: Option<&RecordedController>,
    recording: &Recording,
) -> Option<ColumnRemark> {
    check_control(&project.plant, recording, &ReplayLoop::from(controller?.clone()))
        .map(ColumnRemark::Controller)
}

/// Returns the loop in which recordings are replayed, each by itself: with the project's [`recording_controller`], or under the recorded
/// control if the project names none or the loop controls a torque or a current ([`ReplayLoop::from_controller`]). A recording that lacks the demand is replayed
/// under its recorded control all the same.
pub fn loop_of(project: &Project, controller: Option<&RecordedController>) -> ReplayLoop {
    controller
        .cloned()
        .map_or(ReplayLoop::Open, |controller| ReplayLoop::from_controller(&project.plant, controller))
}

/// Returns the one loop in which all recordings are compared with a model: that of [`loop_of`] if every recording holds the demand,
/// otherwise the recorded control.
pub fn control_for<'a>(
    project: &Project,
    controller: Option<&RecordedController>,
    recordings: impl IntoIterator<Item = &'a Recording>,
) -> ReplayLoop {
    let complete = recordings.into_iter().all(|recording| recording.has(Channel::Demand));
    loop_of(project, controller.filter(|_| complete))
}

impl ReadRecording {
    /// Returns whether the recording was made under another controller than the project's, so that its control is played back.
    pub fn has_other_controller(&self) -> bool {
        let contradicts = |remark: &ColumnRemark| matches!(remark, ColumnRemark::Controller(_));
        self.recording.has(Channel::Control) && self.remarks.iter().any(contradicts)
    }

    /// Returns whether the recorded control is played back although the project names a controller: another one made the recording, or
    /// the demand, which a controller needs, was not recorded.
    pub fn plays_control_back(&self) -> bool {
        self.has_other_controller() || !self.recording.has(Channel::Demand)
    }
}

/// Returns the names of the recordings that lack the demand, so that the project's recording controller cannot be run; none if the
/// project has no recording controller.
pub fn without_demand<'a>(
    project: &Project,
    read: impl IntoIterator<Item = &'a ReadRecording>,
) -> Vec<String> {
    if project.recording_controller.is_none() {
        return Vec::new();
    }
    let lacking = read.into_iter().filter(|item| !item.recording.has(Channel::Demand));
    lacking.map(|item| item.file.clone()).collect()
}
