//! The commands of a commissioning.

use std::path::{Path, PathBuf};

use counterpoise_host::commissioning::CommissioningSetup;
use counterpoise_host::machine_program::RunLimits;

use super::Studio;
use crate::command::Command;
use crate::jobs::commissioning::CommissioningRequest;

impl Studio {
    /// Returns the folder of the rounds; `None` if no project is open.
    fn commissioning_folder(&self) -> Option<PathBuf> {
        let project = self.opened.as_ref()?.path.parent().unwrap_or(Path::new("."));
        Some(project.join(&self.view.commissioning.folder))
    }

    pub(super) fn read_rounds(&mut self) {
        if let Some(folder) = self.commissioning_folder() {
            self.jobs.commission.ask(0, CommissioningRequest::Read { folder });
        }
    }

    /// Runs the next round of the project as it stands in its file: a machine that moves is no place for edits that are not saved.
    pub(super) fn run_round(&mut self) {
        let (Some(opened), Some(folder)) = (&self.opened, self.commissioning_folder()) else { return };
        let inputs = &self.view.commissioning;
        if opened.session.is_changed() {
            return self.view.show_error("no round was run: save the project first (Ctrl+S)");
        }
        if inputs.machine.trim().is_empty() {
            return self.view.show_error("no round was run: name the program that runs the machine");
        }
        let limits = RunLimits {
            angle_rad: inputs.angle_rad,
            rate_rad_s: inputs.rate_rad_s,
            current_a: (inputs.current_a > 0.0).then_some(inputs.current_a),
        };
        let setup = CommissioningSetup {
            project: opened.path.clone(),
            machine: inputs.machine.clone(),
            limits,
            duration_s: inputs.duration_s,
            folder,
        };
        self.jobs.commission.ask(0, CommissioningRequest::Run(setup));
    }

    pub(super) fn accept_round(&mut self) {
        let model = self.jobs.commissioning.as_ref().and_then(|found| found.as_ref().ok()?.model.clone());
        match model {
            Some(text) => {
                self.run(&Command::Replace { text });
                self.view.show_message(
                    "the newest model of the rounds is in the project; design and verification follow (Ctrl+Z undoes this)",
                );
            }
            None => self.view.show_error("the rounds have left no model yet"),
        }
    }

    /// Takes over the rounds that were read or run.
    pub(super) fn take_rounds(&mut self) {
        if let Some((_, found)) = self.jobs.commission.take() {
            self.jobs.commissioning = Some(found);
        }
    }

    /// Reads the rounds when their page is shown first.
    pub(super) fn request_rounds(&mut self) {
        let is_shown = self.view.page == crate::command::Page::Commission && self.opened.is_some();
        if is_shown && self.jobs.commissioning.is_none() && !self.jobs.commission.is_pending() {
            self.read_rounds();
        }
    }
}
