//! The actions of the studio by itself in each frame: it asks for what is due, and checks the file and the journal.

use counterpoise_host::clock::Moment;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use counterpoise_pipeline::preview::PreviewRequest;

use super::Studio;
use crate::browser::Browser;
use crate::command::{BrowsePurpose, Page};
use crate::jobs::assumption_ranking::RankingRequest;
use crate::jobs::file_jobs::DiskText;
use crate::jobs::history_file::history_path;
use counterpoise_host::file_check::FileCheck;

/// Shortest time between two frames that the studio asks for itself.
const SHORTEST_WAIT: Duration = Duration::from_millis(5);

impl Studio {
    /// Takes answers and asks for what is due; it is called once before and once after each frame.
    pub fn update(&mut self) {
        self.take_file_result();
        self.take_answers();
        self.take_pictures();
        self.take_history();
        self.take_overlays();
        self.request_design();
        self.request_pictures();
        self.request_overlays();
        self.request_overlay_runs();
        self.request_rounds();
        if self.verify_at.is_some_and(Moment::has_come) && !self.view.dragging {
            self.verify();
        }
        self.replay_again();
        self.check_disk();
        self.check_journal();
        self.save_changed_settings();
        (self.results.designing, self.results.verifying) =
            (self.jobs.design.is_busy(), self.jobs.verify.is_busy());
    }

    /// Returns when the studio needs the next frame without any input; `None` if a worker wakes it before that.
    pub fn next_wake_after(&self) -> Option<Duration> {
        let verification = self.verify_at.map(Moment::remaining_time);
        verification.map(|wait| wait.max(SHORTEST_WAIT))
    }

    /// Returns whether nothing is asked for or running.
    pub fn is_idle(&self) -> bool {
        !self.can_stop() && !self.file_queue.is_busy() && !self.jobs.has_background_work()
    }

    /// Returns whether there is something that the user can stop.
    pub fn can_stop(&self) -> bool {
        self.verify_at.is_some() || self.jobs.is_busy() || self.file_queue.path_being_opened().is_some()
    }

    /// Asks for the pictures of the page if those that are there belong to another plant.
    fn request_pictures(&mut self) {
        let (page, results) = (self.view.page, &self.results);
        if let (Page::Plant | Page::Reduce, Some(of)) = (page, &results.plant)
            && !results.reduction.as_ref().is_some_and(|p| p.belongs_to(&of.value))
            && !self.jobs.reduction.is_pending()
        {
            self.jobs.reduction.ask(of.revision, of.value.clone());
        }
        let session = self.opened.as_ref().map(|opened| &opened.session);
        if let (Page::Plant, Some(of), Some(session)) = (page, &results.plant, session)
            && of.revision == session.revision()
            && results.ranking.as_ref().is_none_or(|ranked| ranked.revision != of.revision)
            && !self.jobs.ranking.is_pending()
            && let Some(project) = session.project()
        {
            let (modelled, assumptions) = (Arc::clone(&of.value.modelled), session.assumptions().to_vec());
            let project = Arc::clone(project);
            self.jobs.ranking.ask(of.revision, RankingRequest { project, modelled, assumptions });
        }
        let project = self.opened.as_ref().and_then(|o| o.session.project());
        if let (Page::Plant, true, Some(beam)) =
            (page, self.view.mode > 0, project.and_then(|p| p.plant.beam.as_ref()))
            && !results.beam_modes.as_ref().is_some_and(|modes| modes.beam == *beam)
            && !self.jobs.beam_modes.is_pending()
        {
            self.jobs.beam_modes.ask(0, beam.clone());
        }
    }

    /// Replays the recordings again if the project has changed since.
    fn replay_again(&mut self) {
        let revision = self.opened.as_ref().map(|o| o.session.revision());
        let is_due = self.jobs.recording_views.as_ref().is_some_and(|of| Some(of.revision) != revision);
        if is_due && !self.jobs.replay.is_busy() && !self.view.dragging && !self.jobs.recordings.is_empty() {
            self.replay_recordings();
        }
    }

    fn request_design(&mut self) {
        let Some(opened) = &self.opened else { return };
        let (revision, trial) = (opened.session.revision(), self.view.trial_moment_kg_m);
        if self.requested_design == Some((revision, trial)) {
            return;
        }
        self.requested_design = Some((revision, trial));
        if !opened.session.errors().is_empty() {
            let value = opened.session.errors().iter().map(ToString::to_string).collect();
            self.take_project_errors(revision, value);
        } else if let Some(project) = opened.session.project() {
            let request = PreviewRequest { project: Arc::clone(project), out_of_balance_kg_m: trial };
            self.jobs.design.ask(revision, request);
        }
    }

    /// Checks the project file and lists the browser's folder, if they have changed or were not read yet.
    fn check_disk(&mut self) {
        self.open_first_browser();
        self.jobs.watcher.set_paths(self.watched_paths());
        let has_changed = self.jobs.watcher.take_change();
        self.is_file_check_due |= has_changed;
        self.is_history_read_due |= has_changed;
        self.read_changed_history();
        self.take_listing();
        if has_changed || self.view.browser.as_ref().is_some_and(|browser| !browser.is_listed()) {
            self.ask_for_listing();
        }
        self.take_file_check();
        let is_free = !self.jobs.file_check.is_pending();
        if let Some(opened) = self.opened.as_ref().filter(|_| is_free && self.is_file_check_due) {
            let check = FileCheck { path: opened.path.clone(), modified: opened.modified };
            self.jobs.file_check.ask(self.saves, check);
            self.is_file_check_due = false;
        }
    }

    fn watched_paths(&self) -> Vec<PathBuf> {
        let project = self.opened.iter().flat_map(|o| {
            [Some(o.path.clone()), Some(history_path(&o.path)), o.path.parent().map(Path::to_owned)]
        });
        project.flatten().chain(self.view.browser.iter().map(Browser::folder)).collect()
    }

    /// Opens the browser that stands in the window while no project is open.
    fn open_first_browser(&mut self) {
        if self.opened.is_none() && self.view.browser.is_none() && !self.file_queue.is_busy() {
            let here = std::env::current_dir().unwrap_or_default();
            self.view.browser = Some(Browser::new(BrowsePurpose::Project, &here));
        }
    }

    fn take_listing(&mut self) {
        let Some(browser) = &mut self.view.browser else { return };
        if let Some((_, listing)) = self.jobs.list.take() {
            browser.listing = Some(listing);
        }
    }

    fn ask_for_listing(&mut self) {
        let Some(browser) = self.view.browser.as_ref().filter(|_| !self.jobs.list.is_busy()) else { return };
        self.jobs.list.ask(0, browser.wanted_listing());
    }

    /// Takes over a check of the file, unless a project was opened or saved since it began.
    fn take_file_check(&mut self) {
        let Some((saves, found)) = self.jobs.file_check.take() else { return };
        let is_late = saves != self.saves || self.file_queue.is_busy();
        let Some(opened) = self.opened.as_mut().filter(|o| !is_late && o.path == found.path) else {
            self.is_file_check_due = true;
            return;
        };
        if self.jobs.recordings.is_empty() {
            self.jobs.nearby_recordings = found.nearby_recordings;
        }
        if let Some(content) = found.content {
            opened.modified = found.modified;
            let text = String::from_utf8_lossy(&content).into_owned();
            let is_changed = text != opened.session.saved_text();
            opened.disk_text =
                is_changed.then_some(DiskText { text, attachments: None, modified: found.modified });
        }
    }

    fn check_journal(&mut self) {
        let error = self.journal.error().filter(|_| self.opened.is_some());
        if error == self.journal_error {
            return;
        }
        match &error {
            Some(why) => self.view.show_error(format!(
                "edits are not kept against a crash: {why}. Make room, or save (Ctrl+S) as soon as there is some"
            )),
            None => self.view.show_message("edits are kept again against a crash"),
        }
        self.journal_error = error;
    }
}
