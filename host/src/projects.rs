//! Files: finding the project and its recordings, and writing results so that nothing half-written is left.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use counterpoise_models::Parameters;
use counterpoise_pipeline::recordings::RecordingFile;
use counterpoise_pipeline::{
    DecidedProject, PipelineStage, TunedProject, World, choose_and_tune, with_recorded_design,
};
use counterpoise_pool::Pool;
use counterpoise_project::diagnostic::first_findings;
use counterpoise_project::resolve::synthesis_options::AdaptationUse;
use counterpoise_project::{Assumption, Attachments, Diagnostic, Document, ParsedProject, Project, Purpose};
use counterpoise_synth::FirstDesign;

use crate::files::{self, Disk, NativeDisk, PROJECT_FILE, RECORDING_ENDINGS, is_recording};
use crate::stages::{ProgressDisplay, StagePrinter};
use crate::workers::QuietPool;
use counterpoise_pipeline::StageTime;

/// A project as found on disk.
pub struct ProjectOnDisk {
    /// Path of the file.
    pub path: PathBuf,
    /// Document as written.
    pub document: Document,
    /// Project as resolved, with weights and the bands of an adaptation chosen if the file states none and the purpose needs them.
    pub project: Project,
    /// Project as the file states it, which differs from `project` if something was chosen.
    pub stated: Project,
    /// Why the chosen weights are what they are; `None` if the file states them or none are needed.
    pub first_design: Option<FirstDesign>,
    /// Result of the tuning of the open parameters of a fixed structure; `None` if there are none.
    pub tuned: Option<TunedProject>,
    /// Warnings about the file.
    pub warnings: Vec<Diagnostic>,
    /// Defaults that stand in for what the file does not have.
    pub assumptions: Vec<Assumption>,
}

impl ProjectOnDisk {
    /// Returns the folder beside whose files the project stands.
    pub fn project_folder(&self) -> files::ProjectFolder {
        files::ProjectFolder(self.path.parent().unwrap_or(Path::new(".")).to_owned())
    }
}

/// Every error of a project file, the most important first.
#[derive(Debug, thiserror::Error)]
#[error("{}", render_errors(.errors, .document))]
pub struct BadProject {
    /// The errors.
    pub errors: Vec<Diagnostic>,
    /// The file as written, with its parts.
    pub document: Document,
}

/// A project file that cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("cannot read the project file {}", .path.display())]
pub struct UnreadProject {
    /// Path of the file.
    pub path: PathBuf,
    /// The error of the file system.
    pub source: std::io::Error,
}

impl ProjectOnDisk {
    /// Returns whether trials left an adaptation out that the project asks for.
    pub fn adaptation_is_left_out(&self) -> bool {
        let used = |project: &Project| {
            let adaptation = project.synth.as_ref().and_then(|synth| synth.options.adaptation.as_ref());
            adaptation.map(|adaptation| adaptation.use_in_code)
        };
        used(&self.stated) == Some(AdaptationUse::Exported)
            && used(&self.project) == Some(AdaptationUse::LeftOut)
    }
}

/// Returns the first errors with the lines that they speak of, and how many there are.
fn render_errors(errors: &[Diagnostic], document: &Document) -> String {
    let mut out = first_findings(errors, |error| document.excerpt(error));
    let count = errors.len();
    out.push(format!(
        "{count} error{} in the project file; nothing was done",
        if count == 1 { "" } else { "s" }
    ));
    out.join("\n")
}

/// Reads a project file, or the project.toml of a folder, with the files that it names.
pub fn load_project(path: &Path, purpose: Purpose) -> Result<ProjectOnDisk> {
    let path = project_file(path);
    let (document, attachments) = read_as_written(&path)?;
    load_document(path, document, &attachments, purpose)
}

/// Returns the path of a project file: the project.toml of a folder, or the file itself.
pub fn project_file(path: &Path) -> PathBuf {
    if path.is_dir() { path.join(PROJECT_FILE) } else { path.to_owned() }
}

/// Does what [`load_project`] does after reading: resolves a project file that stands, or would stand, at a path.
///
/// # Errors
/// [`BadProject`], and a design that does not exist where the purpose needs one.
pub fn load_document(
    path: PathBuf,
    document: Document,
    attachments: &Attachments,
    purpose: Purpose,
) -> Result<ProjectOnDisk> {
    let resolved = Project::resolve_for(&document, attachments, purpose);
    let bad = |errors| BadProject { errors, document: document.clone() };
    let ParsedProject { project, warnings, assumptions } = resolved.map_err(bad)?;
    let folder = files::ProjectFolder(path.parent().unwrap_or(Path::new(".")).to_owned());
    let stated = project.clone();
    let DecidedProject { project, first: first_design, tuned } = if purpose.needs_weights() {
        choose_and_tune(&project, &folder)?
    } else {
        let decided =
            if purpose.reads_recordings() { with_recorded_design(&project, &folder)? } else { None };
        DecidedProject { project: decided.unwrap_or(project), first: None, tuned: None }
    };
    Ok(ProjectOnDisk { path, document, project, stated, first_design, tuned, warnings, assumptions })
}

/// So many bytes of a file that cannot be read are kept to be quoted.
const QUOTED: usize = 1 << 20;

/// Reads a project file as written, with its parts in their places, and the files that it names.
///
/// # Errors
/// A file that cannot be read or is not text.
pub fn read_as_written(path: &Path) -> Result<(Document, Attachments)> {
    let unread = |source| UnreadProject { path: path.to_owned(), source };
    let bytes = NativeDisk.read(path).map_err(unread)?;
    let name = path.display().to_string();
    // What a message quotes of a file that is no text, or too large, stands at its beginning.
    let lossy = || Document::parse(&String::from_utf8_lossy(&bytes[..bytes.len().min(QUOTED)]), &name);
    let document =
        Document::from_bytes(&bytes, &name).map_err(|errors| BadProject { errors, document: lossy() })?;
    let attachments = files::read_attachments(&document, path);
    Ok((document.with_parts(&attachments), attachments))
}

/// Returns the recordings among files and folders, in the order given; a folder's are sorted by name.
pub fn read_recordings(paths: &[PathBuf]) -> Result<Vec<RecordingFile>> {
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
        let bytes = files::read_file(&path)
            .with_context(|| format!("cannot read the recording {}", path.display()))?;
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
pub fn save_improved(loaded: &ProjectOnDisk, plant: &Parameters, path: &Path) -> Result<()> {
    write_file(path, improved_document(loaded, plant)?.text().as_bytes())
}

/// Returns the project file with an improved mechanism; everything else of the file stays as it is.
pub fn improved_document(loaded: &ProjectOnDisk, plant: &Parameters) -> Result<Document> {
    let improved = Project { plant: plant.clone(), ..loaded.project.clone() };
    Ok(improved.update(&loaded.document, &loaded.project)?)
}

/// Writes a file whole or not at all, as the studio does.
pub fn write_file(path: &Path, content: &[u8]) -> Result<()> {
    files::write_file(path, content).with_context(|| format!("cannot write {}", path.display()))
}

/// World of the pipeline that reads the files beside the project and measures the time of each stage.
pub struct ProjectWorld {
    folder: PathBuf,
    stages: StagePrinter,
}

impl ProjectWorld {
    /// Returns the surroundings of a project.
    pub fn of(loaded: &ProjectOnDisk, progress: ProgressDisplay) -> Self {
        let folder = loaded.path.parent().unwrap_or(Path::new(".")).to_owned();
        Self { folder, stages: StagePrinter::new(progress) }
    }

    /// Returns what each step took; printed, too, unless quiet.
    pub fn times(&self) -> Vec<StageTime> {
        self.stages.times()
    }
}

impl World for ProjectWorld {
    fn read(&self, name: &str) -> std::result::Result<Vec<u8>, String> {
        let told = |error| format!("cannot read {}: {error}", self.folder.join(name).display());
        files::read_reference(&self.folder, name).map_err(told)
    }

    fn pool(&self) -> &dyn Pool {
        &QuietPool
    }

    fn begins(&self, step: PipelineStage) {
        self.stages.begins(step.name());
    }

    fn ends(&self, _step: PipelineStage) {
        self.stages.ends();
    }
}
