//! Files: projects read and written so that nothing half-written is left, and what stands beside them.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use counterpoise_pipeline::World;
use counterpoise_pool::Pool;
use counterpoise_project::{Attachments, Document, SettingValue};

use crate::workers::QuietPool;

/// The disk under a project: what can make one wait. Tests put a slow one here.
pub trait Disk: Send + Sync {
    /// Returns the bytes of a file. Devices, pipes and very large files are refused: a project file or a part of one is
    /// neither.
    ///
    /// # Errors
    /// Those of the file system.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        read_file(path)
    }

    /// Returns the bytes of a file that a project names: see [`read_reference`].
    ///
    /// # Errors
    /// Those of the file system.
    fn read_reference(&self, folder: &Path, name: &str) -> io::Result<Vec<u8>> {
        read_reference(folder, name)
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
pub struct NativeDisk;

impl Disk for NativeDisk {}

/// Name of the project file in a project's folder.
pub const PROJECT_FILE: &str = "project.toml";

/// Returns the project file that a path means.
pub fn project_file(path: &Path) -> PathBuf {
    if path.is_dir() { path.join(PROJECT_FILE) } else { path.to_owned() }
}

/// Returns the text of a project file and the files that it names.
///
/// # Errors
/// The file cannot be read, or is not text, in words.
pub fn read_project(disk: &dyn Disk, path: &Path) -> Result<(String, Attachments), String> {
    let bytes = disk.read(path).map_err(|error| format!("cannot read {}: {error}", path.display()))?;
    let name = path.display().to_string();
    let document = Document::from_bytes(&bytes, &name)
        .map_err(|errors| errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))?;
    Ok((document.text().to_owned(), read_named_files(disk, &document, path)))
}

/// Largest file that is read whole, bytes; a larger recording is read in parts by `replay`, if it is text.
pub const LARGEST_FILE: u64 = 1 << 30;

/// Reads a file that the user named. Only a regular file is read, so that neither a pipe nor a device can hold the program up, and
/// none larger than [`LARGEST_FILE`].
///
/// # Errors
/// Those of the file system, and what is wrong with the file otherwise.
pub fn read_file(path: &Path) -> io::Result<Vec<u8>> {
    let (file, size) = open_file(path)?;
    if size > LARGEST_FILE {
        let (size, most) = (size as f64 / 1e9, LARGEST_FILE as f64 / 1e9);
        let why = format!(
            "it has {size:.1} GB; at most {most:.1} GB are read at once: cut it, or replay it as a CSV file, which is read in parts"
        );
        return Err(io::Error::other(why));
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(size as usize).map_err(io::Error::other)?;
    // A file that grows meanwhile is read as far as it was.
    file.take(size).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Makes a file that is written line by line.
///
/// # Errors
/// Those of the file system.
pub fn create_log(path: &Path) -> io::Result<Box<dyn Write>> {
    Ok(Box::new(fs::File::create(path)?))
}

/// Opens a regular file for reading; returns it with its size in bytes.
///
/// # Errors
/// Those of the file system, and that it is no regular file.
pub fn open_file(path: &Path) -> io::Result<(fs::File, u64)> {
    require_regular(&fs::metadata(path)?)?;
    let file = fs::File::open(path)?;
    let found = file.metadata()?;
    require_regular(&found)?;
    Ok((file, found.len()))
}

/// Reads a file that the project in a folder names. As [`read_file`], and no symbolic link below that folder is followed: a project that was
/// received from another person reaches no file through one.
///
/// # Errors
/// As [`read_file`].
pub fn read_reference(folder: &Path, name: &str) -> io::Result<Vec<u8>> {
    let mut path = folder.to_owned();
    for part in Path::new(name).components() {
        path.push(part);
        if fs::symlink_metadata(&path)?.file_type().is_symlink() {
            let why = "it is a symbolic link, or lies behind one, and links that a project names are not followed: name the file itself, or copy it";
            return Err(io::Error::other(why));
        }
    }
    read_file(&path)
}

fn require_regular(found: &fs::Metadata) -> io::Result<()> {
    match found.is_file() {
        true => Ok(()),
        false if found.is_dir() => Err(io::Error::other("it is a folder, not a file")),
        false => Err(io::Error::other("it is no regular file but a pipe, a socket or a device")),
    }
}

/// Returns the files that a project names, from beside it; a missing one is told by the project's own errors.
pub fn read_attachments(document: &Document, path: &Path) -> Attachments {
    read_named_files(&NativeDisk, document, path)
}

/// Reads what a document names; a part that was read can name further files.
fn read_named_files(disk: &dyn Disk, document: &Document, path: &Path) -> Attachments {
    let folder = path.parent().unwrap_or(Path::new("."));
    let (mut all, mut tried) = (Attachments::none(), BTreeSet::new());
    loop {
        let names = document.with_parts(&all).attachments();
        let new: Vec<String> = names.into_iter().filter(|name| tried.insert(name.clone())).collect();
        if new.is_empty() {
            return all;
        }
        for name in new {
            all = match disk.read_reference(folder, &name) {
                Ok(bytes) => all.with(&name, bytes),
                Err(error) if error.kind() == io::ErrorKind::NotFound => all,
                Err(error) => all.with_problem(&name, error.to_string()),
            };
        }
    }
}

/// Makes a folder with a project file to start from and returns the file. The folder's name becomes the machine's.
///
/// # Errors
/// A folder that holds a project already, or cannot be made, in words.
pub fn create_project(folder: &Path, document: &Document) -> Result<PathBuf, String> {
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
    let named =
        document.set("plant.name", &SettingValue::Text(name.to_owned())).map_err(|e| e.to_string())?;
    let path = whole.join(PROJECT_FILE);
    write_file(&path, named.text().as_bytes()).map_err(cannot)?;
    Ok(path)
}

/// Endings of files that can be recordings.
pub const RECORDING_ENDINGS: [&str; 7] = ["csv", "parquet", "mat", "h5", "hdf5", "npy", "npz"];

/// Returns the recordings among files and folders; a folder's are sorted by name.
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

/// Returns whether a path is a file whose ending says that it can be a recording.
pub fn is_recording(path: &Path) -> bool {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    path.is_file() && RECORDING_ENDINGS.contains(&ending.as_str())
}

/// Writes a file whole or not at all: to a neighbour first, then renamed. What stands in its place must be a regular file, or a link to
/// one, which is replaced; a character device such as `/dev/null` is written to.
///
/// # Errors
/// Those of the file system, and that the place is taken by something else; the old file is then as it was.
pub fn write_file(path: &Path, content: &[u8]) -> io::Result<()> {
    write_on(&NativeDisk, path, content)
}

/// Writes on a disk as [`write_file`] does.
///
/// # Errors
/// Those of the file system; the old file is then as it was.
pub fn write_on(disk: &dyn Disk, path: &Path, content: &[u8]) -> io::Result<()> {
    if place(path)? == Place::Device {
        return fs::OpenOptions::new().write(true).open(path)?.write_all(content);
    }
    if let Some(folder) = path.parent().filter(|f| !f.as_os_str().is_empty()) {
        fs::create_dir_all(folder)?;
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut partial = new_partial(folder, path)?;
    partial.write_all(content)?;
    disk.sync(partial.as_file())?;
    partial.persist(path).map_err(|error| error.error)?;
    Ok(())
}

/// The present contents of the place to which a file is to be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    /// Nothing, or a file that can be replaced.
    File,
    /// A character device, which is written to: renaming a file to its name would replace the device.
    Device,
}

/// Returns what stands where a file is to be written.
///
/// # Errors
/// A folder, a pipe, a socket or another device stands there, or a link to one.
fn place(path: &Path) -> io::Result<Place> {
    let Ok(found) = fs::symlink_metadata(path) else { return Ok(Place::File) };
    #[cfg(unix)]
    if std::os::unix::fs::FileTypeExt::is_char_device(&found.file_type()) {
        return Ok(Place::Device);
    }
    let target = if found.is_symlink() { fs::metadata(path) } else { Ok(found) };
    match target {
        Ok(target) => require_regular(&target).map(|()| Place::File),
        Err(_) => Ok(Place::File),
    }
}

/// Returns a new file beside `path`, of a random name that nothing else has; it is removed when the value is dropped.
fn new_partial(folder: &Path, path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let prefix: String = format!(".{name}.").chars().take(100).collect();
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(".partial");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// A file that is to be written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileToWrite<'a> {
    /// Destination.
    pub path: PathBuf,
    /// Content.
    pub bytes: &'a [u8],
}

/// Writes several files as a set: all of them beside their places first, then each in its place. Whatever fails before that leaves
/// every old file as it was.
///
/// # Errors
/// The file that cannot be written, and why.
pub fn write_set(files: &[FileToWrite<'_>]) -> Result<(), String> {
    let cannot = |path: &Path, error: io::Error| format!("{} cannot be written: {error}", path.display());
    let mut partials = Vec::new();
    for FileToWrite { path, bytes } in files {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let write = || {
            if place(path)? == Place::Device {
                return Err(io::Error::other("it is a device, not a file"));
            }
            fs::create_dir_all(folder)?;
            let mut partial = new_partial(folder, path)?;
            partial.write_all(bytes)?;
            partial.as_file().sync_all()?;
            Ok(partial)
        };
        partials.push(write().map_err(|error| cannot(path, error))?);
    }
    let _held = files.first().and_then(|file| lock_folder(&file.path));
    for (FileToWrite { path, .. }, partial) in files.iter().zip(partials) {
        partial.persist(path).map_err(|error| cannot(path, error.error))?;
    }
    Ok(())
}

/// Holds the folder of a file for as long as the value lives, so that of two programs that write a set at once, the files of one stand there in
/// the end. `None` if folders cannot be held: their files may then be mixed.
fn lock_folder(path: &Path) -> Option<fs::File> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = fs::File::open(folder).ok()?;
    folder.lock().ok()?;
    Some(folder)
}

/// Returns a new temporary folder that only this user can enter; it is removed when the value is dropped.
///
/// # Errors
/// Those of the file system.
pub fn scratch_folder() -> io::Result<tempfile::TempDir> {
    let mut builder = tempfile::Builder::new();
    builder.prefix("counterpoise-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o700));
    builder.tempdir()
}

/// World of the pipeline that reads the files beside the project.
#[derive(Debug, Clone)]
pub struct ProjectFolder(pub PathBuf);

impl World for ProjectFolder {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        let told = |error| format!("cannot read {}: {error}", self.0.join(name).display());
        read_reference(&self.0, name).map_err(told)
    }

    fn pool(&self) -> &dyn Pool {
        &QuietPool
    }
}

/// Returns whether nothing stands at a path, or an empty folder.
pub fn is_empty_place(folder: &Path) -> bool {
    !folder.exists() || folder.read_dir().is_ok_and(|mut entries| entries.next().is_none())
}

/// Returns a path from the root on, without links.
///
/// # Errors
/// Nothing stands there, or it cannot be read.
pub fn whole_path(path: &Path) -> io::Result<PathBuf> {
    path.canonicalize()
}

/// Returns where the studio keeps its own files: journals and the lists of recent projects and folders.
pub fn state_folder() -> PathBuf {
    let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    set("XDG_STATE_HOME")
        .or_else(|| set("HOME").map(|home| home.join(".local/state")))
        .or_else(|| set("LOCALAPPDATA"))
        .unwrap_or_else(std::env::temp_dir)
        .join("counterpoise")
}
