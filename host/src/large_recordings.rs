//! Recordings that are too large to be read at once: text files, read in parts of so many rows.

use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use counterpoise_recordings::{CsvParts, RecordingTable};
use indicatif::{ProgressBar, ProgressStyle};

use crate::files::{self, recording_files};

/// Size of a CSV file above which it is read in parts, bytes.
pub const READ_AT_ONCE: u64 = 128 << 20;
/// Rows of a part: at a kilohertz eight minutes.
pub const ROWS_OF_A_PART: usize = 500_000;

/// Paths by the way in which they are read.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct BySize {
    /// Read at once.
    pub whole: Vec<PathBuf>,
    /// Read in parts.
    pub in_parts: Vec<PathBuf>,
}

/// Tells the recordings that are read at once from those that are read in parts, which are text above `limit` bytes. A folder with such a
/// text becomes the recordings in it.
pub fn split_by_size(paths: &[PathBuf], limit: u64) -> BySize {
    let expanded = paths.iter().flat_map(|path| {
        let inside = recording_files(std::slice::from_ref(path));
        if inside.iter().any(|file| is_large_text(file, limit)) { inside } else { vec![path.clone()] }
    });
    let (in_parts, whole) = expanded.partition(|path| is_large_text(path, limit));
    BySize { whole, in_parts }
}

/// Returns whether a path is a regular file above `limit` bytes that is read as text, by its first bytes.
fn is_large_text(path: &Path, limit: u64) -> bool {
    if !std::fs::metadata(path).is_ok_and(|found| found.is_file() && found.len() > limit) {
        return false;
    }
    let mut first = [0; 16];
    let read = files::open_file(path).and_then(|(mut file, _)| file.read_exact(&mut first));
    read.is_ok() && counterpoise_recordings::is_text(&first)
}

/// A large recording that is being read, with a bar that says how far.
pub struct LargeRecording {
    parts: CsvParts<BufReader<CountedFile>>,
    path: PathBuf,
    bar: ProgressBar,
}

impl LargeRecording {
    /// Opens a recording; the bar is hidden where `quiet`.
    ///
    /// # Errors
    /// The file cannot be opened, is no regular file, or has no header.
    pub fn open(path: &Path, rows: usize, bar: ProgressBar) -> Result<Self> {
        let told = || format!("cannot read the recording {}", path.display());
        let (file, size) = files::open_file(path).with_context(told)?;
        bar.set_length(size);
        let style =
            ProgressStyle::with_template("{bar:30} {bytes}/{total_bytes}, {elapsed} gone, {eta} to go")?;
        bar.set_style(style);
        let counted = CountedFile { file, bar: bar.clone(), line: 0 };
        let reader = BufReader::with_capacity(1 << 20, counted);
        let parts = CsvParts::new(reader, &path.display().to_string(), rows).with_context(told)?;
        Ok(Self { parts, path: path.to_owned(), bar })
    }
}

impl Iterator for LargeRecording {
    type Item = Result<RecordingTable>;

    fn next(&mut self) -> Option<Result<RecordingTable>> {
        let next = self.parts.next();
        if next.is_none() {
            self.bar.finish_and_clear();
        }
        next.map(|part| part.with_context(|| format!("cannot read the recording {}", self.path.display())))
    }
}

/// Longest line of a text that is read in parts, bytes: a line is held in memory whole.
const LONGEST_LINE: usize = 16 << 20;

/// A file whose bytes are counted as they are read.
struct CountedFile {
    file: std::fs::File,
    bar: ProgressBar,
    line: usize,
}

impl Read for CountedFile {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(buffer)?;
        self.bar.inc(count as u64);
        let is_end = |byte: &u8| matches!(byte, b'\n' | b'\r');
        self.line = match buffer[..count].iter().rposition(is_end) {
            Some(end) => count - end - 1,
            None => self.line + count,
        };
        if self.line > LONGEST_LINE {
            let why = format!("a line of more than {} MB: is it a text of rows?", LONGEST_LINE >> 20);
            return Err(io::Error::other(why));
        }
        Ok(count)
    }
}
