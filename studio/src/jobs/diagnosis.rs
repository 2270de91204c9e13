//! The diagnosis of recordings, as the command line makes it.

use std::path::PathBuf;
use std::sync::Arc;

use counterpoise_host::files::ProjectFolder;
use counterpoise_host::progress::{CancellablePool, SharedProgress};
use counterpoise_host::projects;
use counterpoise_host::worker::{BackgroundWorker, CancelToken, WakeWindow};
use counterpoise_pipeline::recordings::diagnose;
use counterpoise_pipeline::with_recorded_design;
use counterpoise_project::Project;
use counterpoise_report::wording::answer::{DescribedDiagnosis, describe_diagnosed_recordings};
use counterpoise_report::wording::recordings::describe_recordings_error;

use super::error_lines::ErrorLines;

/// Input of a diagnosis.
#[derive(Debug, Clone)]
pub struct DiagnosisRequest {
    /// The project.
    pub project: Arc<Project>,
    /// The folder of the project's file.
    pub folder: PathBuf,
    /// The recordings.
    pub paths: Vec<PathBuf>,
}

/// Diagnoses.
pub type DiagnosisWorker = BackgroundWorker<DiagnosisRequest, Result<DescribedDiagnosis, ErrorLines>>;

/// Returns a worker that diagnoses and says its progress.
pub fn diagnosis_worker(wake: &WakeWindow, progress: &SharedProgress) -> DiagnosisWorker {
    let (progress, own_wake) = (progress.clone(), Arc::clone(wake));
    BackgroundWorker::new(Arc::clone(wake), move |request: DiagnosisRequest, token: &CancelToken| {
        let watch = CancellablePool { token, progress: &progress, wake: &own_wake };
        watch.progress.begin();
        let files = projects::read_recordings(&request.paths).map_err(|error| vec![format!("{error:#}")])?;
        let refused = |error| vec![describe_recordings_error(&error)];
        let decided = with_recorded_design(&request.project, &ProjectFolder(request.folder.clone()))
            .map_err(refused)?;
        let project = decided.as_ref().unwrap_or(&request.project);
        let found = diagnose(project, &files, &watch).map_err(refused)?;
        Ok(describe_diagnosed_recordings(&found))
    })
}
