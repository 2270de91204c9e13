//! The verdicts on the sampled controller, on the full plant, with the road that the project names.

use counterpoise_models::plant::Plant;
use counterpoise_recordings::RecordingTable;
use counterpoise_verify::{Procedure, Road, Verification, VerifiedController};

use crate::budget::{Run, require_memory};
use crate::inertial_unit::inertial_unit;
use crate::road::{realise_motion, road_from_table};
use crate::{PipelineError, PlantModel, SynthesisedDesign, World};
use counterpoise_project::Project;
use counterpoise_project::resolve::platform::PlatformSource;

/// Verifies the sampled controller on the plant as it was before reduction.
///
/// # Errors
/// A road that cannot be read, and those of the verification.
pub fn verify(
    project: &Project,
    modelled: &PlantModel,
    synthesised: &SynthesisedDesign,
    world: &dyn World,
) -> Result<VerifiedController, PipelineError> {
    verify_on(project, &modelled.plant, synthesised, &project_procedure(project, world)?)
}

/// Verifies the sampled controller on a plant and by a procedure that need not be the project's own.
///
/// # Errors
/// Those of the verification.
pub fn verify_on(
    project: &Project,
    plant: &Plant,
    synthesised: &SynthesisedDesign,
    procedure: &Procedure,
) -> Result<VerifiedController, PipelineError> {
    let asked = project.verify.as_ref().ok_or(MISSING)?;
    let controller = &synthesised.sampled.controller;
    Ok(counterpoise_verify::verify(plant, controller, procedure, &asked.requirements)?)
}

/// A function that is called with what is found so far and returns whether to go on.
pub type VerificationObserver<'a> = &'a mut dyn FnMut(&Verification) -> bool;

/// Verifies as [`verify`] does and calls `observer` with what is found so far; returns `None` if `observer` asked to stop.
///
/// # Errors
/// As [`verify`].
pub fn verify_watched(
    project: &Project,
    modelled: &PlantModel,
    synthesised: &SynthesisedDesign,
    world: &dyn World,
    observer: VerificationObserver<'_>,
) -> Result<Option<VerifiedController>, PipelineError> {
    let asked = project.verify.as_ref().ok_or(MISSING)?;
    let controller = &synthesised.sampled.controller;
    let by = project_procedure(project, world)?;
    Ok(counterpoise_verify::verify_watched(&modelled.plant, controller, &by, &asked.requirements, observer)?)
}

/// Returns the linear figures alone, on a plant and by a procedure.
///
/// # Errors
/// Those of the verification.
pub fn verify_linear_on(
    project: &Project,
    plant: &Plant,
    synthesised: &SynthesisedDesign,
    procedure: &Procedure,
) -> Result<Verification, PipelineError> {
    let asked = project.verify.as_ref().ok_or(MISSING)?;
    let controller = &synthesised.sampled.controller;
    Ok(counterpoise_verify::verify_linear(plant, controller, procedure, &asked.requirements)?)
}

const MISSING: PipelineError = PipelineError::Missing { section: "verify", needed_by: "the verification" };

/// Returns what the project does to the mechanism, with its road read.
///
/// # Errors
/// A road that cannot be read.
pub fn project_procedure(project: &Project, world: &dyn World) -> Result<Procedure, PipelineError> {
    let asked = project.verify.as_ref().ok_or(MISSING)?;
    let (procedure, period_s) = (&asked.procedure, project.plant.interface.sample_period_s);
    let triangle =
        procedure.triangle.as_ref().map(|triangle| ("verify.triangle.period", 3.0 * triangle.period_s));
    let runs =
        [("verify.duration", procedure.duration_s), ("verify.step.duration", procedure.step.duration_s)];
    for (key, duration_s) in runs.into_iter().chain(triangle) {
        require_memory(Run { key, duration_s, period_s })?;
    }
    let gravity_m_s2 = project.plant.gravity_m_s2;
    let road = asked.road.as_ref().map(|source| platform_motion(source, world, gravity_m_s2)).transpose()?;
    Ok(Procedure {
        operating_point: project.model.operating_point,
        friction: project.model.friction,
        road,
        ..asked.procedure.clone()
    })
}

/// Shortest period of a platform's motion that is made from numbers, s.
const SHORTEST_ROAD_PERIOD_S: f64 = 1e-3;

/// Returns the platform's motion, read or made.
pub(crate) fn platform_motion(
    source: &PlatformSource,
    world: &dyn World,
    gravity_m_s2: f64,
) -> Result<Road, PipelineError> {
    match source {
        PlatformSource::Recording(source) => {
            Ok(road_from_table(source, &read_road_recording(&source.recording, world)?)?)
        }
        PlatformSource::InertialUnit(unit) => {
            Ok(inertial_unit(unit, &read_road_recording(&unit.recording, world)?)?)
        }
        PlatformSource::Made(motion) => {
            let duration_s = motion.realisation.duration_s;
            require_memory(Run {
                key: "verify.road.duration",
                duration_s,
                period_s: SHORTEST_ROAD_PERIOD_S,
            })?;
            Ok(realise_motion(motion, gravity_m_s2)?)
        }
    }
}

/// Returns a recording of the platform's motion.
fn read_road_recording(name: &str, world: &dyn World) -> Result<RecordingTable, PipelineError> {
    let file =
        |problem: String| PipelineError::File { name: name.to_owned(), section: "verify.road", problem };
    Ok(RecordingTable::read(&world.read(name).map_err(file)?, name)?)
}
