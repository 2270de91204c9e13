//! The example projects, as the suites that try every one of them read them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock};

use counterpoise_pipeline::{
    PlantModel, SynthesisedDesign, build_plant_model, reduce_plant, synthesise, verify,
};
use counterpoise_project::{Attachments, Diagnostic, Document, Project, Purpose};
use counterpoise_verify::VerifiedController;

use crate::workspace::root;
use crate::{ExampleFolder, decide_choices};

/// Returns every project file below `examples/`, sorted by path.
pub fn files() -> Vec<PathBuf> {
    let mut open = vec![root().join("examples")];
    let mut found = Vec::new();
    while let Some(folder) = open.pop() {
        for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|ending| ending == "toml") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Examples that the longest suites try by default: feedforwards, schedule, adaptation, cascade of a hobby servo and of a ball screw, a direct
/// drive, a hydraulic cylinder, and the thesis' own design.
const CHOSEN: [&str; 8] = [
    "reference-rig_project",
    "out-of-balance-schedule_project",
    "adaptation_project",
    "servo-pendulum_project",
    "ball-screw_project",
    "direct-gimbal_project",
    "crane-cylinder_project",
    "appendix-5_chapter-6",
];

/// Returns whether everything is tried on every example, as `.ci/evidence` does: `EVERY_EXAMPLE` is set.
pub fn every_one_is_asked_for() -> bool {
    std::env::var_os("EVERY_EXAMPLE").is_some()
}

/// Returns the examples that the longest suites try: a few of different structure, or every one if it is asked for.
///
/// # Panics
/// If a chosen example is no longer there.
pub fn chosen_files() -> Vec<PathBuf> {
    let all = files();
    if every_one_is_asked_for() {
        return all;
    }
    let chosen: Vec<PathBuf> = all.into_iter().filter(|path| CHOSEN.contains(&name(path).as_str())).collect();
    assert_eq!(chosen.len(), CHOSEN.len(), "{chosen:?}");
    chosen
}

/// Returns the name of an example without separators, for example `reference-rig_project`.
pub fn name(path: &Path) -> String {
    let folder = path.parent().and_then(Path::file_name).unwrap();
    format!("{}_{}", folder.display(), path.file_stem().unwrap().display())
}

/// Returns the folder of an example, from which its other files are read.
pub fn world(path: &Path) -> ExampleFolder {
    ExampleFolder(path.parent().unwrap().to_owned())
}

/// Reads the project of an example with the files that it names.
///
/// # Errors
/// The problem of the file for this purpose.
pub fn resolve_example(path: &Path, purpose: Purpose) -> Result<Project, Vec<Diagnostic>> {
    let document = Document::from_bytes(&std::fs::read(path).unwrap(), &path.display().to_string())?;
    let attached = attachments(&document, path.parent().unwrap());
    Ok(Project::resolve_for(&document, &attached, purpose)?.project)
}

/// Reads the files that a project names, as far as they lie in a folder.
pub fn attachments(document: &Document, folder: &Path) -> Attachments {
    let read = |all: Attachments, name: String| match std::fs::read(folder.join(&name)) {
        Ok(bytes) => all.with(&name, bytes),
        Err(_) => all,
    };
    document.attachments().into_iter().fold(Attachments::none(), read)
}

/// An example with the design of its controller.
#[derive(Debug)]
pub struct DesignedExample {
    /// The project, with everything decided that its file leaves to the program.
    pub project: Project,
    /// The plant.
    pub modelled: PlantModel,
    /// The design and its sampled controller.
    pub made: SynthesisedDesign,
}

/// The results that this program has computed of each example; several suites ask for it, and the first one computes it.
struct ExampleCache<T>(Mutex<BTreeMap<PathBuf, Arc<CacheCell<T>>>>);

type CacheCell<T> = OnceLock<Option<Arc<T>>>;

impl<T> ExampleCache<T> {
    const fn none() -> Self {
        Self(Mutex::new(BTreeMap::new()))
    }

    fn or_compute(&self, path: &Path, compute: impl FnOnce() -> Option<T>) -> Option<Arc<T>> {
        let key = path.canonicalize().unwrap();
        let kept = self.0.lock().unwrap().entry(key).or_default().clone();
        kept.get_or_init(|| compute().map(Arc::new)).clone()
    }
}

static DESIGNS: ExampleCache<DesignedExample> = ExampleCache::none();
static VERIFIED: ExampleCache<VerifiedController> = ExampleCache::none();

/// Returns the design of an example whose machine is to be controlled; it is computed once in a program. Returns `None` for an example that asks for no design and tells of recordings or of measured modes instead.
pub fn design_example(path: &Path) -> Option<Arc<DesignedExample>> {
    DESIGNS.or_compute(path, || compute(path))
}

/// Returns the verified controller of an example by its own procedure; it is computed once in a program. Returns `None` if [`design_example`] does.
///
/// # Panics
/// If the file has no `[verify]`, or if the verification fails.
pub fn verify_example(path: &Path) -> Option<Arc<VerifiedController>> {
    VERIFIED.or_compute(path, || {
        let designed = design_example(path)?;
        Some(verify(&designed.project, &designed.modelled, &designed.made, &world(path)).unwrap())
    })
}

fn compute(path: &Path) -> Option<DesignedExample> {
    let project = resolve_example(path, Purpose::Model).unwrap();
    let tells_of_data = project.recording_controller.is_some()
        || project.measured.is_some()
        || !project.recording.channels.is_empty();
    if project.synth.is_none() && tells_of_data {
        return None;
    }
    let project = decide_choices(resolve_example(path, Purpose::Export).unwrap(), &world(path));
    let modelled = build_plant_model(&project).unwrap();
    let made = synthesise(&project, &modelled, &reduce_plant(&project, &modelled).unwrap()).unwrap();
    Some(DesignedExample { project, modelled, made })
}
