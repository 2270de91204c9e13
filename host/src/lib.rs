//! The operating system: the one crate that opens files, starts threads, compilers and clocks, and shows progress.
//!
//! In come paths and work; out go projects, recordings and generated code on disk, and what compilers and emulators answered.
//!
//! *Invariant*: no mathematics, and no sentence about a result; what is computed and how it is worded is decided elsewhere.
//!
//! Modules in reading order: [`terminal`], [`clock`], [`files`], [`folders`], [`json`], [`result_files`], [`journals`], [`project_lock`], [`large_recordings`], [`projects`], [`code_files`],
//! [`shards`], [`programs`], [`interrupt`], [`worker`], [`journal_writer`], [`recent_files`], [`file_check`], [`change_watcher`], [`time_left`], [`progress`],
//! [`workers`], [`campaign_progress`], [`stages`], [`compilers`], [`machine_program`], [`commissioning`].
//!
//! ```
//! let folder = counterpoise_host::files::scratch_folder()?;
//! let path = folder.path().join("a/b.txt");
//! counterpoise_host::files::write_file(&path, b"whole or not at all")?;
//! assert_eq!(std::fs::read(&path)?, b"whole or not at all");
//! # Ok::<(), std::io::Error>(())
//! ```

pub mod campaign_progress;
pub mod change_watcher;
pub mod clock;
pub mod code_files;
pub mod commissioning;
pub mod compilers;
pub mod file_check;
pub mod files;
pub mod folders;
pub mod interrupt;
pub mod journal_writer;
pub mod journals;
pub mod json;
pub mod large_recordings;
pub mod machine_program;
pub mod programs;
pub mod progress;
pub mod project_lock;
pub mod projects;
pub mod recent_files;
pub mod result_files;
pub mod shards;
pub mod stages;
pub mod terminal;
pub mod time_left;
mod tolerance;
pub mod worker;
pub mod workers;
