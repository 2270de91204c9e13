//! The project of a traverse axis: read from the file that the project of its elevation axis names, and checked against that project.

use counterpoise_models::{AxisKind, FeedbackSignal};
use counterpoise_pool::Pool;
use counterpoise_project::resolve::traverse::TraverseAxis;
use counterpoise_project::{Attachments, Document, ParsedProject, Project, Purpose};

use crate::axes_problem::AxesProblem;
use crate::{PipelineError, World};

/// Returns the project of the traverse axis as its file states it.
///
/// # Errors
/// A file that cannot be read, and every error in it, with its name.
pub fn traverse_project(axis: &TraverseAxis, world: &dyn World) -> Result<Project, PipelineError> {
    let problem =
        |problem: String| PipelineError::File { name: axis.file.clone(), section: "traverse", problem };
    let in_words = |found: Vec<counterpoise_project::Diagnostic>| {
        problem(found.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))
    };
    let bytes = world.read(&axis.file).map_err(problem)?;
    let document = Document::from_bytes(&bytes, &axis.file).map_err(in_words)?;
    let attachments = attachments(&document, &FolderOfFile::of(&axis.file, world));
    let ParsedProject { project, .. } =
        Project::resolve_for(&document, &attachments, Purpose::Verify).map_err(in_words)?;
    Ok(project)
}

/// Reads what a project file names; a part that was read can name further files.
fn attachments(document: &Document, world: &dyn World) -> Attachments {
    let (mut all, mut tried) = (Attachments::none(), Vec::new());
    loop {
        let names = document.with_parts(&all).attachments();
        let new: Vec<String> = names.into_iter().filter(|name| !tried.contains(name)).collect();
        if new.is_empty() {
            return all;
        }
        for name in new {
            all = match world.read(&name) {
                Ok(bytes) => all.with(&name, bytes),
                Err(problem) => all.with_problem(&name, problem),
            };
            tried.push(name);
        }
    }
}

/// The files in the folder of a file.
pub(crate) struct FolderOfFile<'a> {
    folder: &'a str,
    world: &'a dyn World,
}

impl<'a> FolderOfFile<'a> {
    pub(crate) fn of(file: &'a str, world: &'a dyn World) -> Self {
        Self { folder: file.rsplit_once('/').map_or("", |(folder, _)| folder), world }
    }
}

impl World for FolderOfFile<'_> {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        match self.folder {
            folder if !folder.is_empty() && !name.starts_with('/') => {
                self.world.read(&format!("{folder}/{name}"))
            }
            _ => self.world.read(name),
        }
    }

    fn pool(&self) -> &dyn Pool {
        self.world.pool()
    }
}

/// Checks that the traverse axis of a project, if it has one, fits under it, before anything is designed.
///
/// # Errors
/// A file of the traverse axis that cannot be read or has errors, and axes that do not fit together.
pub fn check_traverse(project: &Project, world: &dyn World) -> Result<(), PipelineError> {
    let Some(axis) = &project.traverse else { return Ok(()) };
    check_axes(project, &traverse_project(axis, world)?, &axis.file)
}

/// Checks that two axes fit together.
pub(crate) fn check_axes(elevation: &Project, traverse: &Project, file: &str) -> Result<(), PipelineError> {
    let Some(problem) = find_axes_problem(elevation, traverse) else { return Ok(()) };
    Err(PipelineError::Axes { name: file.to_owned(), problem })
}

fn find_axes_problem(elevation: &Project, traverse: &Project) -> Option<AxesProblem> {
    let (axes, sensors) = ([elevation, traverse], &traverse.plant.sensors);
    let gyroscopes = [&sensors.hub_gyro, &sensors.platform_gyro];
    let periods = axes.map(|axis| axis.plant.interface.sample_period_s);
    if traverse.traverse.is_some() {
        return Some(AxesProblem::TwoTraverseAxes);
    }
    if axes.iter().any(|axis| axis.plant.axis == AxisKind::Linear) {
        return Some(AxesProblem::LinearAxis);
    }
    if gyroscopes.iter().any(|gyro| gyro.alignment.has_cross_axis()) {
        return Some(AxesProblem::CrossAxisSensitivity);
    }
    if axes.iter().any(|axis| axis.plant.sensors.measured != FeedbackSignal::HubRate) {
        return Some(AxesProblem::OtherLoop);
    }
    if traverse.plant.gravity_m_s2 != 0.0 {
        return Some(AxesProblem::Gravity);
    }
    (periods[1] != periods[0]).then_some(AxesProblem::SamplePeriod)
}
