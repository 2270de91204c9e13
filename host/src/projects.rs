//! Files: finding the project and its recordings, and writing results so that nothing half-written is left.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use counterpoise_models::Parameters;
use counterpoise_pipeline::recordings::RecordingFile;
use counterpoise_pipeline::{Step, World};
use counterpoise_project::{Diagnostic, Document, Parsed, Project, Purpose};

use crate::files::{self, PROJECT_FILE, RECORDING_ENDINGS, is_recording};
use crate::stages::{StageTime, Stages};

/// A project as found on disk.
pub struct Loaded {
    /// Path of the file.
    pub path: PathBuf,
    /// As written.
    pub document: Document,
    /// As resolved.
    pub project: Project,
    /// What is suspicious in it.
    pub warnings: Vec<Diagnostic>,
}

/// Every error of a project file, each with the line it stands on.
#[derive(Debug, thiserror::Error)]
#[error("{}", rendered(.errors, .text))]
pub struct BadProject {
    /// The errors.
    pub errors: Vec<Diagnostic>,
    /// Text of the file.
    pub text: String,
}

fn rendered(errors: &[Diagnostic], text: &str) -> String {
    let mut out: Vec<String> = errors.iter().map(|e| e.excerpt(text)).collect();
    let count = errors.len();
    out.push(format!(
        "{count} error{} in the project file; nothing was done",
        if count == 1 { "" } else { "s" }
    ));
    out.join("\n")
}

/// Reads a project file, or the project.toml of a folder, with the files that it names.
pub fn load(path: &Path, purpose: Purpose) -> Result<Loaded> {
    let path = if path.is_dir() { path.join(PROJECT_FILE) } else { path.to_owned() };
    let bytes =
        fs::read(&path).with_context(|| format!("cannot read the project file {}", path.display()))?;
    let name = path.display().to_string();
    let bad = |errors, text: &str| BadProject { errors, text: text.to_owned() };
    let lossy = String::from_utf8_lossy(&bytes);
    let document = Document::from_bytes(&bytes, &name).map_err(|errors| bad(errors, &lossy))?;
    let attachments = files::attachments(&document, &path);
    let resolved = Project::resolve_for(&document, &attachments, purpose);
    let Parsed { project, warnings } = resolved.map_err(|errors| bad(errors, document.text()))?;
    Ok(Loaded { path, document, project, warnings })
}

/// The recordings among files and folders, in the order given; a folder's are sorted by name.
pub fn recordings(paths: &[PathBuf]) -> Result<Vec<RecordingFile>> {
    let mut found = Vec::new();
    for path in paths {
        if path.is_dir() {
            let inside = in_folder(path)?;
            if inside.is_empty() {
                bail!(
                    "the folder {} holds no recording (.{})",
                    path.display(),
                    RECORDING_ENDINGS.join(", .")
                );
            }
            found.extend(inside);
        } else {
            found.push(path.clone());
        }
    }
    let read = |path: PathBuf| {
        let bytes =
            fs::read(&path).with_context(|| format!("cannot read the recording {}", path.display()))?;
        Ok(RecordingFile { name: path.display().to_string(), bytes })
    };
    found.into_iter().map(read).collect()
}

fn in_folder(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder).with_context(|| format!("cannot list {}", folder.display()))?;
    let mut paths: Vec<PathBuf> =
        entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|p| is_recording(p)).collect();
    paths.sort();
    Ok(paths)
}

/// Writes the project with an improved mechanism; everything else of the file stays as it is.
pub fn save_improved(loaded: &Loaded, plant: &Parameters, path: &Path) -> Result<()> {
    let improved = Project { plant: plant.clone(), ..loaded.project.clone() };
    let document = improved.update(&loaded.document, &loaded.project)?;
    write(path, document.text().as_bytes())
}

/// Writes a file whole or not at all, as the studio does.
pub fn write(path: &Path, content: &[u8]) -> Result<()> {
    files::write(path, content).with_context(|| format!("cannot write {}", path.display()))
}

/// What the road is given of the world: the files beside the project, and a clock that watches its steps.
pub struct Surroundings {
    folder: PathBuf,
    stages: Stages,
}

impl Surroundings {
    /// The surroundings of a project.
    pub fn of(loaded: &Loaded, quiet: bool) -> Self {
        let folder = loaded.path.parent().unwrap_or(Path::new(".")).to_owned();
        Self { folder, stages: Stages::new(quiet) }
    }

    /// What each step took; printed, too, unless quiet.
    pub fn times(&self) -> Vec<StageTime> {
        self.stages.times()
    }
}

impl World for Surroundings {
    fn read(&self, name: &str) -> std::result::Result<Vec<u8>, String> {
        let path = self.folder.join(name);
        fs::read(&path).map_err(|error| format!("cannot read {}: {error}", path.display()))
    }

    fn begins(&self, step: Step) {
        self.stages.begins(step.name());
    }

    fn ended(&self, _step: Step) {
        self.stages.ended();
    }
}
