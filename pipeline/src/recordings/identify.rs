//! The triangle-wave method on files of recordings.

use std::path::Path;

use counterpoise_diagnose::identify::Identified;
use counterpoise_project::Project;
use counterpoise_simulate::recording::Recording;

use super::read::{Gaps, RecordingFile, read};
use crate::PipelineError;

/// Identifies out-of-balance, friction, inertia and the amplifier's gain curve; each group of files is one state of balance.
///
/// # Errors
/// [`PipelineError::UnreadableRecording`] for a file, [`PipelineError::Diagnosis`] if the recordings do not allow it.
pub fn identify(project: &Project, states: &[&[RecordingFile]]) -> Result<Identified, PipelineError> {
    let (mut recordings, mut notes) = (Vec::new(), Vec::new());
    for files in states.iter().filter(|files| !files.is_empty()) {
        let mut of_state = Vec::new();
        for item in read(project, files, Gaps::Repaired)? {
            notes.extend(item.remarks.iter().map(|remark| format!("{}: {remark}", item.file)));
            let stem = Path::new(&item.file).file_stem().map(|s| s.to_string_lossy().into_owned());
            of_state.push(Recording { name: stem.unwrap_or(item.file), ..item.recording });
        }
        recordings.push(of_state);
    }
    let states: Vec<&[Recording]> = recordings.iter().map(Vec::as_slice).collect();
    let mut found = counterpoise_diagnose::identify::identify(&project.plant, &states)
        .map_err(PipelineError::Diagnosis)?;
    found.notes.extend(notes);
    Ok(found)
}
