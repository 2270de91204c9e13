//! Recordings read as a project maps their columns.

use counterpoise_diagnose::mend::mended;
use counterpoise_diagnose::qualify::foreign_control;
use counterpoise_project::Project;
use counterpoise_project::recording::{Mapping, Record, RecordingError, Table};
use counterpoise_simulate::recording::Recording;
use counterpoise_simulate::replay::Loop;

use crate::PipelineError;

/// A file with recordings, handed in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordingFile {
    /// Name of the file, as messages quote it.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// A recording that was read, with what was found on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadRecording {
    /// Name of the recording: its file, and the part of it if there are several.
    pub file: String,
    /// The recording.
    pub recording: Recording,
    /// What was found about its columns, one sentence each.
    pub remarks: Vec<String>,
    /// Whether demand, control and hub rate are the samples that were written, not made from other columns or resampled.
    pub keeps_samples: bool,
}

/// What happens to gaps and stuck sensors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gaps {
    /// Short gaps are filled; a long one splits the recording; a channel whose sensor is stuck loses those samples.
    Repaired,
    /// They stay as they were written.
    AsWritten,
}

/// Reads files as the project maps their columns; one that has no clock takes the sample period of the project's interface.
///
/// # Errors
/// [`PipelineError::UnreadableRecording`] if a file cannot be read as it is mapped, [`PipelineError::NothingToReplay`] if the
/// gaps of a recording leave no part of it.
pub fn read(
    project: &Project,
    files: &[RecordingFile],
    gaps: Gaps,
) -> Result<Vec<ReadRecording>, PipelineError> {
    let mut all = Vec::new();
    for file in files {
        let (_, records) = tabulate(project, file).map_err(PipelineError::UnreadableRecording)?;
        for record in &records {
            all.extend(read_record(project, record, gaps)?);
        }
    }
    Ok(all)
}

/// Returns the table of a file and its records as the project maps them.
///
/// # Errors
/// The file cannot be decoded, or its columns do not fit the mapping.
pub fn tabulate(project: &Project, file: &RecordingFile) -> Result<(Table, Vec<Record>), RecordingError> {
    let clock = project.recording.sample_period_s.or(Some(project.plant.interface.sample_period_s));
    let mapping = Mapping { sample_period_s: clock, ..project.recording.clone() };
    let table = Table::read(&file.bytes, &file.name)?;
    let records = mapping.records(&table)?;
    Ok((table, records))
}

/// Returns the recordings of one record: several if gaps split it. Remarks about the whole record stand with the first.
///
/// # Errors
/// [`PipelineError::NothingToReplay`] if the gaps leave no part of the record.
pub fn read_record(
    project: &Project,
    record: &Record,
    gaps: Gaps,
) -> Result<Vec<ReadRecording>, PipelineError> {
    let keeps_samples = project.recording.keeps_samples(record);
    let mut remarks: Vec<String> = record.findings.iter().map(ToString::to_string).collect();
    let parts = match gaps {
        Gaps::AsWritten => vec![(record.name.clone(), record.recording())],
        Gaps::Repaired => {
            let repaired = mended(&record.recording(), project.plant.gearbox.ratio);
            remarks.extend(repaired.remarks.into_iter().map(|(channel, what)| format!("{channel}: {what}")));
            repaired.parts.into_iter().map(|part| (part.name.clone(), part)).collect()
        }
    };
    if parts.is_empty() {
        return Err(PipelineError::NothingToReplay {
            recording: record.name.clone(),
            why: remarks.join("; "),
        });
    }
    let one = |(file, recording): (String, Recording)| {
        let foreign = foreign_controller(project, &recording, keeps_samples);
        let remarks = foreign.into_iter().chain(std::mem::take(&mut remarks)).collect();
        ReadRecording { file, recording, remarks, keeps_samples }
    };
    Ok(parts.into_iter().map(one).collect())
}

/// Returns a remark if the recorded control is not what the project's recording controller makes of the recorded measurements.
fn foreign_controller(project: &Project, recording: &Recording, keeps_samples: bool) -> Option<String> {
    let controller = project.recording_controller.as_ref().filter(|_| keeps_samples)?;
    let foreign = foreign_control(&project.plant, recording, &Loop::from(controller))?;
    Some(format!("control: {foreign}"))
}

/// Returns how recordings of a project are replayed: in closed loop with the recording controller if the project has one and every
/// recording holds the demand, otherwise under the recorded control.
pub fn control_for<'a>(project: &Project, recordings: impl IntoIterator<Item = &'a Recording>) -> Loop {
    let mut recordings = recordings.into_iter();
    match &project.recording_controller {
        Some(controller) if recordings.all(|recording| recording.demand_rad_s.is_some()) => {
            Loop::from(controller)
        }
        _ => Loop::Open,
    }
}

/// Returns a sentence if the recording controller cannot be run because recordings lack the demand.
pub fn missing_demand<'a>(
    project: &Project,
    recordings: impl IntoIterator<Item = (&'a str, &'a Recording)>,
) -> Option<String> {
    project.recording_controller.as_ref()?;
    let lacking: Vec<&str> = recordings
        .into_iter()
        .filter(|(_, recording)| recording.demand_rad_s.is_none())
        .map(|(name, _)| name)
        .collect();
    (!lacking.is_empty()).then(|| {
        format!(
            "demand was not recorded in {}: everything is replayed under the recorded control instead of by the recorded controller",
            lacking.join(", ")
        )
    })
}
