//! Verification, export, measurement, kept designs, plots and recordings.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use counterpoise_host::files::ProjectFolder;
use counterpoise_project::Project;
use counterpoise_verify::VerifiedController;

use super::Studio;
use crate::command::{Command, DesignSlot};
use crate::jobs::code_export::ExportRequest;
use crate::jobs::diagnosis::DiagnosisRequest;
use crate::jobs::measurements::MeasurementRequest;
use crate::jobs::plot_copy::{CopyFormat, CopyRequest, CopyTarget};
use crate::jobs::recording_views::ReplayRequest;
use crate::jobs::report_job::ReportRequest;
use crate::jobs::verification::VerificationRequest;
use crate::versioned_results::VersionedResult;
use counterpoise_host::recent_files::RecentList;

/// A design with its verification, both of the project as it stands.
struct CurrentVerification {
    revision: u64,
    request: VerificationRequest,
    verified: Arc<VerifiedController>,
}

impl Studio {
    fn verification_request(&self) -> Option<VersionedResult<VerificationRequest>> {
        let (opened, of) = (self.opened.as_ref()?, self.results.design.as_ref()?);
        let folder = ProjectFolder(opened.path.parent().unwrap_or(Path::new(".")).to_owned());
        let value = VerificationRequest { design: Arc::clone(&of.value), folder };
        Some(VersionedResult { revision: of.revision, value })
    }

    pub(super) fn verify(&mut self) {
        self.verify_at = None;
        self.view.history.are_runs_stopped = false;
        self.jobs.overlay_runs.cancel();
        if let Some(request) = self.verification_request() {
            let (revision, design) = (request.revision, Arc::clone(&request.value.design));
            self.jobs.verify.ask(revision, request);
            if self.results.loop_view.as_ref().is_none_or(|shown| shown.revision != revision) {
                self.jobs.loop_view.ask(revision, Arc::clone(&design));
            }
            self.jobs.effort.ask(revision, design);
        }
    }

    /// Returns the design with its verification if both belong to the project as it stands; otherwise shows what is missing.
    fn verified_now(&mut self, failure: &str) -> Option<CurrentVerification> {
        let (Some(request), Some(of)) = (self.verification_request(), self.results.verified.clone()) else {
            self.view.show_error(format!("{failure}: the design is not verified yet (F5)"));
            return None;
        };
        let is_stale = self.opened.as_ref().is_none_or(|o| o.session.revision() != of.revision);
        if is_stale || request.value.design.trial_moment_kg_m.is_some() {
            self.view.show_error(format!(
                "{failure}: the verification belongs to an older design; verify (F5) first"
            ));
            return None;
        }
        Some(CurrentVerification { revision: request.revision, request: request.value, verified: of.value })
    }

    pub(super) fn export(&mut self) {
        let Some(now) = self.verified_now("not exported") else { return };
        let output = self.view.output_folder.clone().unwrap_or_else(|| now.request.folder.0.join("out"));
        let (design, verified, library) = (now.request, now.verified, self.library);
        self.jobs.export.ask(now.revision, ExportRequest { design, verified, output, library });
    }

    pub(super) fn export_to(&mut self, folder: &Path) {
        self.recent_files.add(RecentList::Folders, folder);
        (self.view.output_folder, self.view.browser) = (Some(folder.to_owned()), None);
        self.export();
    }

    /// Writes the report of the project as it stands to a file.
    pub(super) fn write_report(&mut self, path: &Path) {
        self.view.browser = None;
        let Some(opened) = self.opened.as_ref().filter(|o| o.session.errors().is_empty()) else {
            return self.view.show_error("the report was not written: the project file has errors");
        };
        let Some(project) = opened.session.project().cloned() else { return };
        let folder = ProjectFolder(opened.path.parent().unwrap_or(Path::new(".")).to_owned());
        if let Some(folder) = path.parent() {
            self.recent_files.add(RecentList::Folders, folder);
        }
        let (project_path, output) = (opened.path.clone(), path.to_owned());
        let assumptions = opened.session.assumptions().to_vec();
        let request = ReportRequest { project, assumptions, folder, project_path, output };
        self.jobs.report.ask(opened.session.revision(), request);
    }

    pub(super) fn measure_map(&mut self) {
        match self.verification_request() {
            Some(of) => self.jobs.measure.ask(of.revision, MeasurementRequest::Map(of.value)),
            None => self.view.show_error("not measured: there is no controller yet"),
        }
    }

    pub(super) fn run_campaign(&mut self) {
        if let Some(now) = self.verified_now("the campaign was not run") {
            let request = MeasurementRequest::Campaign(now.request, now.verified);
            self.jobs.measure.ask(now.revision, request);
        }
    }

    pub(super) fn keep_design(&mut self, slot: DesignSlot) {
        let Some(of) = &self.results.design else {
            return self.view.show_error("not kept: there is no design yet");
        };
        self.view.kept.insert(slot, Arc::clone(&of.value));
        let session = self.opened.as_ref().map(|opened| &opened.session);
        match session.filter(|session| session.revision() == of.revision) {
            Some(session) => drop(self.view.kept_texts.insert(slot, session.text().to_owned())),
            None => drop(self.view.kept_texts.remove(&slot)),
        }
        self.view.show_message(format!("kept as {}", slot.name()));
    }

    /// Puts a kept design's weights and order into the project; one step of undo removes them again.
    pub(super) fn restore_design(&mut self, slot: DesignSlot) {
        let name = slot.name();
        let Some(kept) = self.view.kept.get(&slot).map(|design| Arc::clone(&design.project)) else {
            return self
                .view
                .show_error(format!("nothing is kept as {name} (Ctrl+Shift+1 to 3 keeps a design)"));
        };
        let Some(opened) = &self.opened else { return };
        let Some(now) = opened.session.project() else { return };
        let restored = Project { synth: kept.synth.clone(), reduce: kept.reduce, ..Project::clone(now) };
        match restored.update(opened.session.document(), now) {
            Ok(updated) => {
                self.run(&Command::Replace { text: updated.text().to_owned() });
                self.view.show_message(format!("the weights of {name} are restored (Ctrl+Z undoes this)"));
            }
            Err(error) => {
                self.view.show_error(format!("the weights of {name} cannot be restored: {error}"));
            }
        }
    }

    /// Shows the whole content of the plot that was under the pointer last.
    pub(super) fn fit_plot(&mut self) {
        self.view.fit_request = self.view.chart.as_ref().map(|chart| chart.title.clone());
    }

    /// Has the plot that was under the pointer last written for the clipboard.
    pub(super) fn copy_plot(&mut self, format: CopyFormat) {
        if let Some(chart) = self.view.chart.clone() {
            self.jobs.copy.ask(0, CopyRequest { chart, format, target: CopyTarget::Clipboard });
        }
    }

    /// Has the plot that was under the pointer last written to a file.
    pub(super) fn save_plot(&mut self, path: &Path) {
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        let Some(format) = CopyFormat::with_ending(&ending) else {
            return self.view.show_error("not saved: the name of a plot ends in .svg, .png or .csv");
        };
        let Some(chart) = self.view.chart.clone() else {
            return self.view.show_error("not saved: point at a plot first");
        };
        if let Some(folder) = path.parent() {
            self.recent_files.add(RecentList::Folders, folder);
        }
        self.view.browser = None;
        self.jobs.copy.ask(0, CopyRequest { chart, format, target: CopyTarget::File(path.to_owned()) });
    }

    pub(super) fn set_recordings(&mut self, paths: &[PathBuf]) {
        self.view.browser = None;
        if let Some(folder) = paths.last().and_then(|path| path.parent()) {
            self.recent_files.add(RecentList::Folders, folder);
        }
        self.jobs.recordings = paths.to_vec();
        (self.jobs.recording_views, self.jobs.diagnosis, self.jobs.diagnosed_plant) = (None, None, None);
        (self.view.recording, self.view.cross_plot) = Default::default();
        self.replay_recordings();
    }

    /// Replays the recordings on the model as it stands, and on the diagnosed one.
    pub(super) fn replay_recordings(&mut self) {
        let Some(opened) = &self.opened else { return };
        let Some(project) = opened.session.project() else { return };
        let diagnosed = self.jobs.diagnosis.as_ref().and_then(|found| found.as_ref().ok());
        let improved = diagnosed
            .filter(|_| self.jobs.diagnosed_plant.as_ref() == Some(&project.plant))
            .map(|found| Arc::new(found.diagnosis.improved.clone()));
        let (project, paths) = (Arc::clone(project), self.jobs.recordings.clone());
        let folder = opened.path.parent().unwrap_or(Path::new(".")).to_owned();
        self.jobs.replay.ask(opened.session.revision(), ReplayRequest { project, folder, paths, improved });
    }

    pub(super) fn diagnose(&mut self) {
        let Some(opened) = &self.opened else { return };
        let Some(project) = opened.session.project() else { return };
        if self.jobs.recordings.is_empty() {
            return self
                .view
                .show_error("drop recordings (CSV, Parquet, MATLAB, HDF5, NumPy) onto the window first");
        }
        let folder = opened.path.parent().unwrap_or(Path::new(".")).to_owned();
        let paths = self.jobs.recordings.clone();
        let request = DiagnosisRequest { project: Arc::clone(project), folder, paths };
        self.jobs.diagnosed_plant = Some(project.plant.clone());
        self.jobs.diagnose.ask(opened.session.revision(), request);
    }

    pub(super) fn accept_diagnosis(&mut self) {
        let Some(project) = self.opened.as_ref().and_then(|o| o.session.project()) else { return };
        if self.jobs.diagnosed_plant.as_ref().is_some_and(|plant| *plant != project.plant) {
            return self.view.show_error(
                "not accepted: the mechanism was changed since the diagnosis; diagnose again (F6)",
            );
        }
        let improved = self.opened.as_ref().and_then(|o| self.jobs.improved_text(&o.session));
        match improved {
            Some(Ok(text)) => {
                self.run(&Command::Replace { text });
                self.view.show_message(
                    "the diagnosis is in the project; design and verification follow (Ctrl+Z undoes this)",
                );
            }
            Some(Err(why)) => self.view.show_error(why),
            None => self.view.show_error("there is no diagnosis to accept"),
        }
    }
}
