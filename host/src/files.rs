//! Files: projects read and written so that nothing half-written is left, and what stands beside them.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use counterpoise_pipeline::World;
use counterpoise_project::{Attachments, Document, STARTER, Setting};

/// The disk under a project: what can make one wait. Tests put a slow one here.
pub trait Disk: Send + Sync {
    /// The bytes of a file.
    ///
    /// # Errors
    /// Those of the file system.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        fs::read(path)
    }

    /// Waits until the disk has what was written.
    ///
    /// # Errors
    /// Those of the file system.
    fn sync(&self, file: &fs::File) -> io::Result<()> {
        file.sync_all()
    }
}

/// The disk of this machine.
#[derive(Debug, Clone, Copy, Default)]
pub struct Native;

impl Disk for Native {}

/// Name of the project file in a project's folder.
pub const PROJECT_FILE: &str = "project.toml";

/// The project file that a path means.
pub fn project_file(path: &Path) -> PathBuf {
    if path.is_dir() { path.join(PROJECT_FILE) } else { path.to_owned() }
}

/// The text of a project file and the files that it names.
///
/// # Errors
/// The file cannot be read, or is not text, in words.
pub fn read(disk: &dyn Disk, path: &Path) -> Result<(String, Attachments), String> {
    let bytes = disk.read(path).map_err(|error| format!("cannot read {}: {error}", path.display()))?;
    let name = path.display().to_string();
    let document = Document::from_bytes(&bytes, &name)
        .map_err(|errors| errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))?;
    Ok((document.text().to_owned(), named(disk, &document, path)))
}

/// The files that a project names, from beside it; a missing one is told by the project's own errors.
pub fn attachments(document: &Document, path: &Path) -> Attachments {
    named(&Native, document, path)
}

fn named(disk: &dyn Disk, document: &Document, path: &Path) -> Attachments {
    let folder = path.parent().unwrap_or(Path::new("."));
    let with = |all: Attachments, name: String| match disk.read(&folder.join(&name)) {
        Ok(bytes) => all.with(&name, bytes),
        Err(_) => all,
    };
    document.attachments().into_iter().fold(Attachments::none(), with)
}

/// Makes a folder with a complete project file to start from; gives the file. The folder's name becomes the machine's.
///
/// # Errors
/// A folder that holds a project already, or cannot be made, in words.
pub fn create(folder: &Path) -> Result<PathBuf, String> {
    let path = folder.join(PROJECT_FILE);
    if path.exists() {
        return Err(format!("{} is there already; give another folder, or remove it", path.display()));
    }
    if folder.exists() && !folder.is_dir() {
        return Err(format!("{} is a file, not a folder; give another name", folder.display()));
    }
    let cannot = |error: io::Error| format!("cannot make {}: {error}", folder.display());
    fs::create_dir_all(folder).map_err(cannot)?;
    let whole = folder.canonicalize().map_err(cannot)?;
    let name = whole.file_name().and_then(|name| name.to_str()).unwrap_or("machine");
    let document = Document::parse(STARTER, PROJECT_FILE);
    let named = document.set("plant.name", &Setting::Text(name.to_owned())).map_err(|e| e.to_string())?;
    let path = whole.join(PROJECT_FILE);
    write(&path, named.text().as_bytes()).map_err(cannot)?;
    Ok(path)
}

/// Endings of files that can be recordings.
pub const RECORDING_ENDINGS: [&str; 5] = ["csv", "parquet", "mat", "h5", "hdf5"];

/// The recordings among files and folders; a folder's are sorted by name.
pub fn recording_files(paths: &[PathBuf]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for path in paths {
        if path.is_dir() {
            let entries = fs::read_dir(path).into_iter().flatten();
            let mut inside: Vec<PathBuf> =
                entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|p| is_recording(p)).collect();
            inside.sort();
            found.extend(inside);
        } else {
            found.push(path.clone());
        }
    }
    found
}

/// Whether a path is a file whose ending says that it can be a recording.
pub fn is_recording(path: &Path) -> bool {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    path.is_file() && RECORDING_ENDINGS.contains(&ending.as_str())
}

/// Writes a file whole or not at all: to a neighbour first, then renamed.
///
/// # Errors
/// Those of the file system; the old file is then as it was.
pub fn write(path: &Path, content: &[u8]) -> io::Result<()> {
    write_on(&Native, path, content)
}

/// [`write()`] on a disk.
///
/// # Errors
/// Those of the file system; the old file is then as it was.
pub fn write_on(disk: &dyn Disk, path: &Path, content: &[u8]) -> io::Result<()> {
    if let Some(folder) = path.parent().filter(|f| !f.as_os_str().is_empty()) {
        fs::create_dir_all(folder)?;
    }
    let mut partial = path.as_os_str().to_owned();
    partial.push(".partial");
    let partial = PathBuf::from(partial);
    let written = fs::File::create(&partial).and_then(|mut file| {
        file.write_all(content)?;
        disk.sync(&file)
    });
    let done = written.and_then(|()| fs::rename(&partial, path));
    if done.is_err() {
        let _ = fs::remove_file(&partial);
    }
    done
}

/// Returns a new temporary folder that only this user can enter; it is removed when the value is dropped.
///
/// # Errors
/// Those of the file system.
pub fn scratch_folder() -> io::Result<tempfile::TempDir> {
    tempfile::Builder::new().prefix("counterpoise-").tempdir()
}

/// What the road is given of the world: the files beside the project.
#[derive(Debug, Clone)]
pub struct Folder(pub PathBuf);

impl World for Folder {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        let path = self.0.join(name);
        fs::read(&path).map_err(|error| format!("cannot read {}: {error}", path.display()))
    }
}

/// Where the studio keeps its own files: journals and the lists of recent projects and folders.
pub fn state_folder() -> PathBuf {
    let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    set("XDG_STATE_HOME")
        .or_else(|| set("HOME").map(|home| home.join(".local/state")))
        .or_else(|| set("LOCALAPPDATA"))
        .unwrap_or_else(std::env::temp_dir)
        .join("counterpoise")
}
