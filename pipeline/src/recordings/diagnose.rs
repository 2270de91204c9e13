//! Recordings diagnosed: what the project's model lacks.

use counterpoise_diagnose::Diagnosis;
use counterpoise_diagnose::diagnosis::{Contradiction, Request};
use counterpoise_diagnose::findings::localisation_chart::{LocalisationChart, build_chart};
use counterpoise_diagnose::recording::gap_repair::repair_gaps;
use counterpoise_pool::Pool;
use counterpoise_project::Project;
use counterpoise_recordings::Recording;
use counterpoise_simulate::replay::ReplayLoop;

use super::column_remarks::ColumnRemark;
use super::read::{
    GapTreatment, RecordingFile, control_for, read_files, recording_controller, unused_columns,
    without_demand,
};
use super::residuals::{ResidualStudy, study_residuals};
use super::tracks::{ChannelTrack, replay_before_and_after};
use crate::PipelineError;
use crate::configuration::{apply_configuration, without_configuration};

/// A diagnosis with the way in which the recordings were replayed, and everything that a report of it shows.
#[derive(Debug, Clone)]
pub struct DiagnosedRecordings {
    /// The answer and the improved mechanism.
    pub diagnosis: Diagnosis,
    /// The control under which the recordings were replayed.
    pub control: ReplayLoop,
    /// Recordings without the demand, for which the project's recording controller could not be run.
    pub without_demand: Vec<String>,
    /// Remarks on each recording that was read, with its name.
    pub remarks: Vec<(String, Vec<ColumnRemark>)>,
    /// The chart of the localisation.
    pub chart: LocalisationChart,
    /// Channels measured and simulated, by the model as it was and by the improved one.
    pub tracks: Vec<ChannelTrack>,
    /// Residuals of both models.
    pub residuals: ResidualStudy,
}

/// Diagnoses files of recordings of the project's machine in the configuration that its model names. What is found holds for that
/// configuration; the improved mechanism is stated without what the configuration fits to it, as the project file states it.
///
/// # Errors
/// [`PipelineError::UnreadableRecording`] for a file, [`PipelineError::Diagnosis`] if the recordings cannot be diagnosed or the
/// pool was asked to stop.
pub fn diagnose(
    project: &Project,
    files: &[RecordingFile],
    pool: &dyn Pool,
) -> Result<DiagnosedRecordings, PipelineError> {
    let controller = recording_controller(project)?;
    let read = read_files(project, controller.as_ref(), files, GapTreatment::AsWritten)?;
    let control = control_for(project, controller.as_ref(), read.iter().map(|item| &item.recording));
    let contradiction = if read.iter().all(|item| item.keeps_samples) {
        Contradiction::PlayBack
    } else {
        Contradiction::Ignore
    };
    let recordings: Vec<Recording> = read.iter().map(|item| item.recording.clone()).collect();
    let base = apply_configuration(project, &project.plant)?;
    let request = Request { base: &base, control, contradiction, recordings: &recordings };
    let mut diagnosis = counterpoise_diagnose::diagnosis::diagnose_request(&request, pool)
        .map_err(|cause| PipelineError::Diagnosis { cause, unused: unused_columns(&read) })?;
    let without_demand = without_demand(project, &read);
    let remarks = read.into_iter().map(|item| (item.file, item.remarks)).collect();
    let control = diagnosis.control.clone();
    let answer = &diagnosis.answer;
    let chart = build_chart(&answer.map, &answer.isolability, &answer.findings);
    let tracks = replay_before_and_after(
        &repair_recordings(&diagnosis, project),
        &control,
        &base,
        &diagnosis.improved,
    );
    let residuals = study_residuals(&tracks);
    diagnosis.improved = without_configuration(project, &diagnosis.improved)?;
    Ok(DiagnosedRecordings { diagnosis, control, without_demand, remarks, chart, tracks, residuals })
}

/// Returns the recordings as they were diagnosed, with gaps repaired, so that they can be replayed from start to end.
fn repair_recordings(diagnosis: &Diagnosis, project: &Project) -> Vec<Recording> {
    let ratio = project.plant.gearbox.ratio;
    diagnosis.recordings.iter().flat_map(|recording| repair_gaps(recording, ratio).parts).collect()
}
