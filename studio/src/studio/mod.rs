//! The studio: it carries out commands.
//!
//! Modules in reading order: `file_commands` (projects opened and saved), `closing`, `work_commands` (everything that is computed),
//! `history_commands` (designs kept with a name), `overlays` (designs drawn over the current one), `commissioning_commands` (rounds on a machine), `study_commands` (searches, comparisons and experiments),
//! `settings_commands` (what is remembered), `event_loop` (what the studio does by
//! itself in each frame), `answers` (what the workers found).

mod answers;
mod closing;
mod commissioning_commands;
mod event_loop;
mod file_commands;
mod history_commands;
mod overlays;
mod settings_commands;
mod study_commands;
mod work_commands;

pub use history_commands::rate_figures;

use counterpoise_host::clock::Moment;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use counterpoise_host::code_files::LibraryBuilder;
use counterpoise_host::files::{Disk, NativeDisk};
use counterpoise_host::worker::WakeWindow;

use crate::command::Command;
use crate::editing::journal::Journal;
use crate::editing::session::Session;
use crate::file_queue::FileQueue;
use crate::jobs::BackgroundJobs;
use crate::jobs::file_jobs::{DiskText, ProjectStore};
use crate::jobs::plot_copy::{ClipboardContent, CopyFormat};
use crate::results::ComputedResults;
use crate::settings::{ProjectSettings, UserSettings};
use crate::view::{StudioView, ViewCommand};
use counterpoise_host::project_lock::ProjectLock;
use counterpoise_host::recent_files::RecentFiles;

/// An open project.
pub struct OpenProject {
    /// The file.
    pub path: PathBuf,
    /// The project as it is edited.
    pub session: Session,
    /// The lock that lets this window write the project; `None` if another window holds it.
    pub lock: Option<ProjectLock>,
    /// The content of the file, if another program has changed it since it was read.
    pub disk_text: Option<DiskText>,
    pub(crate) modified: Option<SystemTime>,
}

impl OpenProject {
    /// Returns whether another window has the project open, so that this one may not write it.
    pub fn is_read_only(&self) -> bool {
        self.lock.is_none()
    }
}

/// State of the window's closing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WindowClosing {
    /// No request to close it.
    #[default]
    No,
    /// The window closes when the project is closed.
    WhenProjectIsClosed,
}

/// The studio.
pub struct Studio {
    /// The folder with the studio's own files.
    pub state: PathBuf,
    /// The project.
    pub opened: Option<OpenProject>,
    /// View of the window.
    pub view: StudioView,
    /// Settings that are stored for the user.
    pub user_settings: UserSettings,
    /// Computed results.
    pub results: ComputedResults,
    /// The commands that concern files and are not done yet.
    pub file_queue: FileQueue,
    /// Why edits are not kept against a crash; `None` if they are.
    pub journal_error: Option<String>,
    /// Builds the libraries of FMI units; without it none are built.
    pub library: LibraryBuilder,
    /// Why a project could not be opened.
    pub open_error: Option<String>,
    /// State of the window's closing.
    pub window_closing: WindowClosing,
    pub(crate) jobs: BackgroundJobs,
    pub(crate) journal: Journal,
    pub(crate) recent_files: RecentFiles,
    /// Content that the window has to put into the clipboard.
    pub(crate) clipboard: Option<ClipboardContent>,
    /// Number of saves, by which a check of the file that began before a save is recognised.
    saves: u64,
    requested_design: Option<(u64, Option<f64>)>,
    verify_at: Option<Moment>,
    /// The settings that are on disk, or on their way there.
    stored_settings: (UserSettings, Option<ProjectSettings>),
    is_file_check_due: bool,
    is_history_read_due: bool,
}

impl Studio {
    /// Starts a studio that keeps its own files in `state` and calls `wake` when an answer has come.
    pub fn new(state: &Path, wake: WakeWindow) -> Self {
        Self::with_disk(state, wake, Arc::new(NativeDisk))
    }

    /// Starts a studio on a disk.
    pub fn with_disk(state: &Path, wake: WakeWindow, disk: Arc<dyn Disk>) -> Self {
        let journal = Journal::new(Arc::clone(&disk), Arc::clone(&wake));
        let store = ProjectStore { disk: Arc::clone(&disk), state: state.to_owned(), flush: journal.flush() };
        let user_settings = UserSettings::load(state);
        let mut view = StudioView::default();
        user_settings.apply(&mut view);
        Self {
            state: state.to_owned(),
            opened: None,
            view,
            stored_settings: (user_settings.clone(), None),
            user_settings,
            results: ComputedResults::default(),
            file_queue: FileQueue::default(),
            journal_error: None,
            library: |_, _| None,
            open_error: None,
            window_closing: WindowClosing::No,
            jobs: BackgroundJobs::new(&wake, store),
            journal,
            recent_files: RecentFiles::new(state, disk),
            clipboard: None,
            saves: 0,
            requested_design: None,
            verify_at: None,
            is_file_check_due: false,
            is_history_read_due: false,
        }
    }

    /// Carries out a command.
    pub fn run(&mut self, command: &Command) {
        if command.is_edit() {
            self.edit(command);
        } else if self.view.apply(command) == ViewCommand::NotOfView {
            self.act(command);
        }
    }

    fn edit(&mut self, command: &Command) {
        let Some(opened) = &mut self.opened else { return };
        if opened.is_read_only() {
            let why = "not changed: the project is open in another window; save it under another name (Ctrl+Shift+S) to edit it here";
            return self.view.show_error(why);
        }
        match opened.session.apply(command) {
            // A step of undo leads to a text that is in no journal, so the journal gets the text itself.
            Ok(()) if matches!(command, Command::Undo | Command::Redo) => {
                self.journal.append(&Command::Replace { text: opened.session.text().to_owned() });
            }
            Ok(()) => self.journal.append(command),
            Err(error) => self.view.show_error(error.to_string()),
        }
    }

    fn act(&mut self, command: &Command) {
        match command {
            Command::Open { .. }
            | Command::New { .. }
            | Command::CopyExample { .. }
            | Command::Close
            | Command::DiscardAndClose
            | Command::Save
            | Command::Overwrite
            | Command::SaveAs { .. }
            | Command::Reload => self.queue_file_command(command),
            Command::AskClose => self.ask_close(),
            Command::Browse { purpose } => self.browse(*purpose),
            Command::Verify => self.verify(),
            Command::Cancel => self.cancel(),
            Command::Export => self.export(),
            Command::ExportTo { folder } => self.export_to(folder),
            Command::Measure => self.measure_map(),
            Command::Sweep => self.run_campaign(),
            Command::Keep { slot } => self.keep_design(*slot),
            Command::Return { slot } => self.restore_design(*slot),
            Command::KeepDesign { name } => self.keep_named_design(name),
            Command::RestoreDesign { name } => self.restore_named_design(name),
            Command::RenameDesign { name, new_name } => self.rename_named_design(name, new_name),
            Command::DeleteDesign { name } => self.delete_named_design(name),
            Command::PutDesignBack => self.put_design_back(),
            Command::FitPlot => self.fit_plot(),
            Command::CopyCsv => self.copy_plot(CopyFormat::Csv),
            Command::CopySvg => self.copy_plot(CopyFormat::Svg),
            Command::CopyPng => self.copy_plot(CopyFormat::Png),
            Command::SavePlot { path } => self.save_plot(path),
            Command::WriteReport { path } => self.write_report(path),
            Command::Recordings { paths } => self.set_recordings(paths),
            Command::Diagnose => self.diagnose(),
            Command::Accept => self.accept_diagnosis(),
            Command::ReadRounds => self.read_rounds(),
            Command::RunRound => self.run_round(),
            Command::AcceptRound => self.accept_round(),
            Command::RunStudy { study } => self.run_study(*study),
            Command::RunShownStudy => self.run_study(self.view.study),
            Command::TakeProposal { number } => self.take_proposal(*number),
            _ => {}
        }
    }

    fn cancel(&mut self) {
        self.verify_at = None;
        self.view.history.are_runs_stopped = true;
        self.jobs.cancel();
        self.stop_opening();
        self.view.show_message("stopped");
    }

    /// Returns the workers, and what the recordings' workers have found.
    pub fn jobs(&self) -> &BackgroundJobs {
        &self.jobs
    }
}

impl Drop for Studio {
    fn drop(&mut self) {
        self.close();
    }
}
