//! Projects closed: with a question about unsaved edits, and with their journal and settings in order.

use super::Studio;
use crate::command::Command;
use crate::design_overlays::HistoryState;
use crate::results::ComputedResults;
use crate::view::CloseTarget;
use counterpoise_host::journal_writer::JournalEnding;
use counterpoise_host::worker::wait_between_looks;

impl Studio {
    /// Closes the project, and asks first if it has unsaved edits.
    pub(super) fn ask_close(&mut self) {
        match &self.opened {
            Some(opened) if opened.session.is_changed() && !opened.is_read_only() => {
                self.view.close_question = Some(CloseTarget::Project);
            }
            _ => self.queue_file_command(&Command::Close),
        }
    }

    /// Leaves the project. Without a stated ending the journal is kept if there are unsaved edits.
    pub(super) fn leave(&mut self, ending: Option<JournalEnding>) {
        self.save_settings_now();
        self.jobs.clear();
        if let Some(opened) = self.opened.take() {
            let is_changed = opened.session.is_changed();
            let natural = if is_changed { JournalEnding::Keep } else { JournalEnding::Remove };
            self.journal.end(ending.unwrap_or(natural), opened.lock);
        }
        (self.results, self.requested_design, self.verify_at) = (ComputedResults::default(), None, None);
        (self.view.output_folder, self.view.browser, self.view.close_question) = (None, None, None);
        (self.view.shows_difference, self.view.history) = (false, HistoryState::default());
        self.is_history_read_due = false;
    }

    /// Waits until every queued save is done, and leaves the project. Its journal is kept if there are unsaved edits.
    pub fn close(&mut self) {
        self.stop_opening();
        while self.file_queue.is_saving() {
            wait_between_looks();
            self.take_file_result();
        }
        self.leave(None);
        while self.jobs.settings.is_busy() || self.jobs.history.is_busy() {
            wait_between_looks();
        }
    }
}
