//! The export that the file with the recordings' controller comes from.

use counterpoise_project::Project;
use counterpoise_project::resolve::controller::RecordingController;

use crate::World;
use crate::export::project_hash;

/// A controller of the recordings that another state of the project exported.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OtherExport {
    /// Name of the file that holds it.
    pub file: String,
    /// Hash of the project that exported it.
    pub file_hash: String,
    /// Hash of the project as it stands.
    pub project_hash: String,
}

/// Returns the export of the recordings' controller if this project as it stands would not make it; `None` if it would, or if no such
/// file is named.
///
/// The project is compared as it was before it named the file: without a controller of the recordings, or with its own.
pub fn other_export(project: &Project, world: &dyn World) -> Option<OtherExport> {
    let Some(RecordingController::Exported(source)) = &project.recording_controller else { return None };
    let file_hash = source.content.as_ref()?.project_hash.clone();
    let hash_with = |recording_controller: Option<RecordingController>| {
        project_hash(&Project { recording_controller, ..project.clone() }, world)
    };
    let own = [hash_with(None), hash_with(Some(RecordingController::Project)), project_hash(project, world)];
    let [project_hash, ..] = own.clone();
    (!own.contains(&file_hash)).then(|| OtherExport { file: source.file.clone(), file_hash, project_hash })
}
