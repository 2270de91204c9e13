//! Recordings diagnosed: what the project's model lacks.

use counterpoise_diagnose::Diagnosis;
use counterpoise_diagnose::recording::gap_repair::repair_gaps;
use counterpoise_diagnose::simulator_access::Pool;
use counterpoise_project::Project;
use counterpoise_recordings::Recording;
use counterpoise_simulate::replay::Loop;

use super::read::{ColumnRemark, Gaps, RecordingFile, control_for, read, unused_columns, without_demand};
use crate::PipelineError;

/// A diagnosis with the way in which the recordings were replayed.
#[derive(Debug, Clone)]
pub struct DiagnosedRecordings {
    /// The answer and the improved mechanism.
    pub diagnosis: Diagnosis,
    /// The control under which the recordings were replayed.
    pub control: Loop,
    /// Recordings without the demand, for which the project's recording controller could not be run.
    pub without_demand: Vec<String>,
    /// What was found on reading each recording, with its name.
    pub remarks: Vec<(String, Vec<ColumnRemark>)>,
}

/// Diagnoses files of recordings of the project's machine.
///
/// # Errors
/// [`PipelineError::UnreadableRecording`] for a file, [`PipelineError::Diagnosis`] if the recordings cannot be diagnosed or the
/// pool was asked to stop.
pub fn diagnose(
    project: &Project,
    files: &[RecordingFile],
    pool: &dyn Pool,
) -> Result<DiagnosedRecordings, PipelineError> {
    let read = read(project, files, Gaps::AsWritten)?;
    let control = control_for(project, read.iter().map(|item| &item.recording));
    let recordings: Vec<Recording> = read.iter().map(|item| item.recording.clone()).collect();
    let diagnosis = counterpoise_diagnose::diagnose(&project.plant, control.clone(), &recordings, pool)
        .map_err(|cause| PipelineError::Diagnosis { cause, unused: unused_columns(&read) })?;
    let without_demand =
        without_demand(project, read.iter().map(|item| (item.file.as_str(), &item.recording)));
    let remarks = read.into_iter().map(|item| (item.file, item.remarks)).collect();
    Ok(DiagnosedRecordings { diagnosis, control, without_demand, remarks })
}

impl DiagnosedRecordings {
    /// Returns the recordings as they were diagnosed, with gaps repaired, so that they can be replayed from start to end.
    pub fn repaired(&self, project: &Project) -> Vec<Recording> {
        let ratio = project.plant.gearbox.ratio;
        self.diagnosis.recordings.iter().flat_map(|recording| repair_gaps(recording, ratio).parts).collect()
    }
}
