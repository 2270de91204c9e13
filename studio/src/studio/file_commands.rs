//! Projects opened, made and saved.
//!
//! A worker reads and writes ([`crate::jobs::file_jobs`]), one job at a time; here commands wait for their turn, and their results are
//! taken over. A journal stands beside the open project, so that nothing is lost on the way.

use std::path::Path;

use counterpoise_host::files::project_file;
use counterpoise_project::PlatformSource;
use counterpoise_project::starters::StarterKind;

use super::{OpenProject, Studio, WindowClosing};
use crate::browser::Browser;
use crate::command::{BrowsePurpose, Command};
use counterpoise_host::journals::journal_path;

use crate::design_overlays::{HistoryFileState, OverlayName};
use crate::editing::journal::JournalHeader;
use crate::editing::session::file_name;
use crate::examples::find_example;
use crate::file_queue::{QueuedCommand, is_save};
use crate::jobs::file_jobs::{
    DiskText, FileJob, FileJobResult, LoadedProject, Overwrite, ProjectOrigin, SaveOutcome,
};
use crate::jobs::kept_designs::{KeptRequest, KeptText};
use crate::settings::ProjectSettings;
use crate::tile_layout::PlotTiles;
use counterpoise_host::journal_writer::JournalEnding;
use counterpoise_host::project_lock::ProjectLock;
use counterpoise_host::recent_files::RecentList;

/// The advice if nothing can be written.
const SAVE_FAILURE_ADVICE: &str =
    "Nothing is lost: make room and save again (Ctrl+S), or save under another name (Ctrl+Shift+S)";

impl Studio {
    /// Opens a browser at a useful place.
    pub(super) fn browse(&mut self, purpose: BrowsePurpose) {
        let here = std::env::current_dir().unwrap_or_default();
        let file = self.opened.as_ref().map(|o| o.path.clone());
        if file.is_none() && purpose != BrowsePurpose::Project {
            return self.view.show_error("no project is open");
        }
        let folder = file.as_deref().and_then(Path::parent).map_or(here, Path::to_owned);
        let start = match (purpose, file) {
            (BrowsePurpose::SaveAs, Some(file)) => file,
            (BrowsePurpose::Project, Some(_)) => folder.parent().map_or(folder.clone(), Path::to_owned),
            (BrowsePurpose::Export, _) => {
                self.view.output_folder.clone().unwrap_or_else(|| folder.join("out"))
            }
            (BrowsePurpose::Recordings, _) => {
                self.jobs.recordings.last().and_then(|p| p.parent()).map_or(folder, Path::to_owned)
            }
            (BrowsePurpose::PlotFile, _) => folder.join(self.plot_file_name()),
            (BrowsePurpose::Report, _) => folder.join("report.html"),
            _ => folder,
        };
        self.open_error = None;
        self.view.browser = Some(Browser::new(purpose, &start));
    }

    /// Returns a file name for the plot that was under the pointer last, made of its title.
    fn plot_file_name(&self) -> String {
        let title = self.view.chart.as_ref().map_or("plot", |chart| chart.title.as_str());
        let letters = title.to_lowercase().replace(|c: char| !c.is_ascii_alphanumeric(), "-");
        let words: Vec<&str> = letters.split('-').filter(|word| !word.is_empty()).collect();
        format!("{}.svg", words.join("-"))
    }

    pub(super) fn show_open_error(&mut self, why: String) {
        self.view.show_error(why.clone());
        self.open_error = Some(why);
    }

    /// Opens a project; unsaved edits are restored. The open project stays until the other is read.
    pub fn open(&mut self, path: &Path) {
        self.queue_file_command(&Command::Open { path: path.to_owned() });
    }

    /// Queues a command that concerns files. The text to be saved is the one of this moment.
    pub(super) fn queue_file_command(&mut self, command: &Command) {
        let text = self.opened.as_ref().map_or_else(String::new, |o| o.session.text().to_owned());
        if is_save(command)
            && let Some(leaving) = self.file_queue.running.take_if(|other| !is_save(other))
        {
            self.jobs.file.cancel();
            self.file_queue.push_first(match leaving {
                Command::New { folder, .. } => Command::Open { path: folder },
                other => other,
            });
        }
        self.file_queue.push(command.clone(), text);
        self.start_next_file_job();
    }

    fn start_next_file_job(&mut self) {
        while self.file_queue.running.is_none() {
            let Some(QueuedCommand { command, text }) = self.file_queue.pop() else { return };
            match command {
                Command::Close => self.leave(None),
                Command::DiscardAndClose => self.leave(Some(JournalEnding::Remove)),
                _ => match self.file_job(&command, text) {
                    Ok(job) => {
                        self.file_queue.running = Some(command);
                        self.jobs.file.ask(0, job);
                    }
                    Err(Some(why)) => self.view.show_error(why),
                    Err(None) => {}
                },
            }
        }
    }

    /// Returns the job of a command; or why it cannot be done, if that is to be shown.
    fn file_job(&self, command: &Command, text: String) -> Result<FileJob, Option<&'static str>> {
        let read_only =
            "not saved: the project is open in another window; save it under another name (Ctrl+Shift+S)";
        let open = self.opened.as_ref();
        let writable = || match open {
            Some(open) if open.is_read_only() => Err(Some(read_only)),
            Some(open) => Ok(open),
            None => Err(None),
        };
        Ok(match command {
            Command::Open { path } => FileJob::Open { path: path.clone() },
            Command::New { folder, like } => {
                let like = like.as_deref().and_then(StarterKind::from_name);
                FileJob::Create { folder: folder.clone(), like }
            }
            Command::CopyExample { example, folder } => FileJob::CopyExample {
                example: find_example(example).ok_or(Some("not copied: there is no such example"))?,
                folder: folder.clone(),
            },
            Command::Reload => FileJob::Reread { path: open.ok_or(None)?.path.clone() },
            Command::Save => {
                let open = writable()?;
                let overwrite = Overwrite::IfUnchanged(open.session.saved_text().to_owned());
                FileJob::Save { path: open.path.clone(), text, overwrite }
            }
            Command::Overwrite => {
                FileJob::Save { path: writable()?.path.clone(), text, overwrite: Overwrite::Always }
            }
            Command::SaveAs { path } => {
                let open = open.ok_or(None)?;
                if open.is_read_only() && project_file(path) == open.path {
                    return Err(Some(read_only));
                }
                let names = named_files(open);
                FileJob::SaveAs { from: open.path.clone(), to: path.clone(), text, names }
            }
            _ => return Err(None),
        })
    }

    /// Takes over the result of a file job.
    pub(super) fn take_file_result(&mut self) {
        if let Some((_, result)) = self.jobs.file.take() {
            self.file_queue.running = None;
            match result {
                FileJobResult::Loaded(Ok(loaded)) => self.begin_project(*loaded),
                FileJobResult::Loaded(Err(why)) => self.show_open_error(why),
                FileJobResult::Reread { path, found: Ok(found) } => self.take_disk_text(&path, found),
                FileJobResult::Reread { found: Err(why), .. } => self.view.show_error(why),
                FileJobResult::Written { path, text, outcome } => match outcome {
                    SaveOutcome::Saved { modified, lock } => {
                        if let Some(opened) = &mut self.opened {
                            (opened.modified, opened.disk_text) = (modified, None);
                        }
                        self.finish_save(&path, &text, lock);
                    }
                    SaveOutcome::Conflict(found) => self.show_conflict(found),
                    SaveOutcome::Failed(why) => self.show_save_error(&path, &why),
                },
            }
        }
        self.start_next_file_job();
    }

    fn begin_project(&mut self, mut loaded: LoadedProject) {
        let same = self.opened.as_mut().filter(|open| open.path == loaded.path);
        if let Some(open) = same {
            loaded.lock = loaded.lock.or_else(|| open.lock.take());
            if open.session.is_changed() {
                let text = open.session.text().to_owned();
                loaded.restored = vec![Command::Replace { text: text.clone() }];
                let _ = loaded.session.apply(&Command::Replace { text });
            }
        }
        self.leave(None);
        self.open_error = None;
        self.show_how_it_opened(&loaded);
        if loaded.lock.is_some() {
            let header = JournalHeader { project: loaded.path.clone(), text: loaded.text };
            self.journal.begin(&journal_path(&self.state, &loaded.path), &header, &loaded.restored);
        }
        self.recent_files.add(RecentList::Projects, &loaded.path);
        self.jobs.nearby_recordings = loaded.nearby_recordings;
        let (path, session, modified, lock) = (loaded.path, loaded.session, loaded.modified, loaded.lock);
        self.opened = Some(OpenProject { path, session, lock, modified, disk_text: None });
        self.is_file_check_due = true;
        self.is_history_read_due = true;
        self.restore_view(loaded.settings);
        if self.opened.as_ref().is_some_and(|opened| opened.session.project().is_none()) {
            // a file that was never read has nothing to show but its text, where it is corrected
            self.run(&Command::NextError);
        }
    }

    /// Restores what the window showed of the project when it was open last.
    fn restore_view(&mut self, settings: Option<ProjectSettings>) {
        (self.view.kept, self.view.kept_texts, self.view.text) = Default::default();
        self.view.tiles = PlotTiles::default();
        let Some(settings) = settings else { return };
        settings.apply(&mut self.view);
        let Some(opened) = self.opened.as_ref().filter(|_| !settings.kept.is_empty()) else { return };
        let text = |(slot, text)| KeptText { name: OverlayName::Slot(slot), text };
        let request = KeptRequest {
            document: opened.session.document().clone(),
            attachments: opened.session.attachments().clone(),
            texts: settings.kept.into_iter().map(text).collect(),
        };
        self.jobs.restore.ask(0, request);
    }

    fn show_how_it_opened(&mut self, loaded: &LoadedProject) {
        if loaded.origin == ProjectOrigin::Created {
            let file = loaded.path.display();
            self.view.show_message(format!("{file} is a complete machine: change its numbers to your own"));
        } else if loaded.restored_count > 0 {
            self.view.show_message(format!(
                "{} unsaved edits are restored; \"Read the file again\" discards them",
                loaded.restored_count
            ));
        }
    }

    /// Replaces the project by the text on disk, as an edit that can be undone.
    fn take_disk_text(&mut self, path: &Path, found: DiskText) {
        let Some(opened) = self.opened.as_mut().filter(|opened| opened.path == path) else { return };
        let had_edits = opened.session.is_changed();
        opened.session.mark_saved(&found.text);
        (opened.modified, opened.disk_text) = (found.modified, None);
        if let Some(attachments) = found.attachments {
            opened.session.set_attachments(attachments);
        }
        let replace = Command::Replace { text: found.text };
        if opened.session.apply(&replace).is_ok() && !opened.is_read_only() {
            self.journal.append(&replace);
        }
        self.view.shows_difference = false;
        let undo = if had_edits { " (Ctrl+Z restores the edits)" } else { "" };
        self.view.show_message(format!("the project is as the file has it{undo}"));
    }

    /// Shows that another program has changed the file, so that it was not saved.
    fn show_conflict(&mut self, found: DiskText) {
        self.file_queue.keep_saves();
        self.window_closing = WindowClosing::No;
        if let Some(opened) = &mut self.opened {
            opened.disk_text = Some(found);
        }
        self.view.browser = None;
        self.view.show_error(
            "not saved: another program has changed the file; choose above which of the two is kept",
        );
    }

    /// Takes over that a project has been written: the journal begins again, with what was edited meanwhile.
    fn finish_save(&mut self, path: &Path, text: &str, lock: Option<ProjectLock>) {
        let Some(opened) = &mut self.opened else { return };
        opened.session.mark_saved(text);
        let mut message = format!("saved {}", path.display());
        let browses_save_as = self.view.browser.as_ref().is_some_and(|b| b.purpose == BrowsePurpose::SaveAs);
        let is_renamed = opened.path != path;
        if is_renamed {
            self.journal.end(JournalEnding::Remove, std::mem::replace(&mut opened.lock, lock));
            opened.session.rename(&file_name(path));
            opened.path = path.to_owned();
            message = format!("saved as {}", path.display());
            self.recent_files.add(RecentList::Projects, path);
            (self.view.browser, self.open_error) = (None, None);
        } else if browses_save_as {
            self.view.browser = None;
        }
        let header = JournalHeader { project: path.to_owned(), text: text.to_owned() };
        let was_edited = opened.session.text() != text;
        let further = was_edited.then(|| Command::Replace { text: opened.session.text().to_owned() });
        self.journal.begin(&journal_path(&self.state, path), &header, further.as_slice());
        self.saves += 1;
        self.view.shows_difference = false;
        self.view.show_message(message);
        if is_renamed {
            (self.view.history.file, self.view.history.known) = (HistoryFileState::Unread, Vec::new());
            self.is_history_read_due = true;
        }
    }

    fn show_save_error(&mut self, path: &Path, why: &str) {
        self.file_queue.keep_saves();
        self.window_closing = WindowClosing::No;
        if self.opened.as_ref().is_some_and(|o| o.path == path) {
            self.view.show_error(format!("not saved, {why}. {SAVE_FAILURE_ADVICE}"));
        } else {
            self.show_open_error(format!("not saved, {why}; nothing is lost, choose another place"));
        }
    }

    /// Cancels what is being opened; what is being saved goes on.
    pub(super) fn stop_opening(&mut self) {
        self.file_queue.keep_saves();
        if self.file_queue.running.take_if(|command| !is_save(command)).is_some() {
            self.jobs.file.cancel();
        }
    }
}

/// Returns the files in the project's folder that the project names.
fn named_files(opened: &OpenProject) -> Vec<String> {
    let mut names = opened.session.document().attachments();
    let road = opened.session.project().and_then(|p| p.verify.as_ref()?.road.as_ref());
    names.extend(road.and_then(PlatformSource::recording).map(str::to_owned));
    names
}
