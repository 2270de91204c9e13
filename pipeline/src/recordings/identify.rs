//! The triangle-wave method on files of recordings.

use std::path::Path;

use counterpoise_diagnose::identification::{Identification, apply_identified};
use counterpoise_models::{AxisKind, ControlledQuantity, Parameters, QuantityKind};
use counterpoise_project::Project;
use counterpoise_recordings::Recording;

use super::column_remarks::ColumnRemark;
use super::read::{GapTreatment, RecordingFile, read_files, recording_controller, unused_columns};
use crate::PipelineError;

/// Result of an identification, with the remarks on each recording.
#[derive(Debug, Clone)]
pub struct IdentifiedRecordings {
    /// The identified mechanism.
    pub identified: Identification,
    /// The project's mechanism with the identified values of the first state of balance.
    pub improved: Parameters,
    /// Remarks on each recording, with its name.
    pub remarks: Vec<(String, Vec<ColumnRemark>)>,
    /// The units of the values.
    pub units: AxisUnits,
}

/// Units of what is identified on an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AxisUnits {
    /// Of the out-of-balance.
    pub moment: &'static str,
    /// Of the inertia.
    pub inertia: &'static str,
    /// Of a torque or a force.
    pub torque: &'static str,
    /// Of viscous friction.
    pub viscous: &'static str,
    /// Of volts over a rate.
    pub slope: &'static str,
    /// Of a position.
    pub position: &'static str,
    /// The rate of the axis.
    pub rate: ControlledQuantity,
}

impl AxisUnits {
    /// Returns the units of an axis.
    pub fn of(axis: AxisKind) -> Self {
        Self {
            moment: axis.unit("kg m"),
            inertia: axis.unit("kg m^2"),
            torque: axis.unit("N m"),
            viscous: axis.unit("N m s/rad"),
            slope: axis.unit("V s/rad"),
            position: axis.unit("rad"),
            rate: ControlledQuantity { kind: QuantityKind::Rate, axis, ..ControlledQuantity::RATE },
        }
    }
}

/// Identifies out-of-balance, friction, inertia and the amplifier's gain curve; each group of files is one state of balance.
///
/// # Errors
/// [`PipelineError::UnreadableRecording`] for a file, [`PipelineError::Diagnosis`] if the recordings do not allow it.
pub fn identify(
    project: &Project,
    states: &[&[RecordingFile]],
) -> Result<IdentifiedRecordings, PipelineError> {
    let controller = recording_controller(project)?;
    let (mut recordings, mut remarks, mut unused) = (Vec::new(), Vec::new(), Vec::new());
    for files in states.iter().filter(|files| !files.is_empty()) {
        let mut of_state = Vec::new();
        for item in read_files(project, controller.as_ref(), files, GapTreatment::Repaired)? {
            unused.extend(unused_columns([&item]));
            let stem = Path::new(&item.file).file_stem().map(|s| s.to_string_lossy().into_owned());
            of_state.push(item.recording.with_name(stem.unwrap_or_else(|| item.file.clone())));
            remarks.push((item.file, item.remarks));
        }
        recordings.push(of_state);
    }
    let states: Vec<&[Recording]> = recordings.iter().map(Vec::as_slice).collect();
    let identified = counterpoise_diagnose::identification::identify(&project.plant, &states)
        .map_err(|cause| PipelineError::Diagnosis { cause, unused })?;
    let improved = apply_identified(&project.plant, &identified);
    Ok(IdentifiedRecordings { identified, improved, remarks, units: AxisUnits::of(project.plant.axis) })
}
