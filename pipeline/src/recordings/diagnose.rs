//! Recordings diagnosed: what the project's model lacks.

use counterpoise_diagnose::Diagnosis;
use counterpoise_diagnose::bench::Pool;
use counterpoise_diagnose::mend::mended;
use counterpoise_project::Project;
use counterpoise_simulate::recording::Recording;
use counterpoise_simulate::replay::Loop;

use super::read::{Gaps, RecordingFile, control_for, missing_demand, read};
use crate::PipelineError;

/// A diagnosis with the way in which the recordings were replayed.
#[derive(Debug, Clone)]
pub struct DiagnosedRecordings {
    /// The answer and the improved mechanism.
    pub diagnosis: Diagnosis,
    /// The control under which the recordings were replayed.
    pub control: Loop,
}

/// Diagnoses files of recordings of the project's machine. What was found on reading them comes first among the answer's remarks.
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
    let mut diagnosis = counterpoise_diagnose::diagnose(&project.plant, control.clone(), &recordings, pool)
        .map_err(PipelineError::Diagnosis)?;
    let demand = missing_demand(project, read.iter().map(|item| (item.file.as_str(), &item.recording)));
    let remarks =
        read.iter().flat_map(|item| item.remarks.iter().map(|remark| format!("{}: {remark}", item.file)));
    diagnosis.answer.qualification.splice(0..0, demand.into_iter().chain(remarks));
    Ok(DiagnosedRecordings { diagnosis, control })
}

impl DiagnosedRecordings {
    /// Returns the recordings as they were diagnosed, with gaps repaired, so that they can be replayed from start to end.
    pub fn repaired(&self, project: &Project) -> Vec<Recording> {
        let ratio = project.plant.gearbox.ratio;
        self.diagnosis.recordings.iter().flat_map(|recording| mended(recording, ratio).parts).collect()
    }
}
