//! The answers of the workers, taken over in each frame.

use counterpoise_host::clock::Moment;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use counterpoise_verify::VerifiedController;

use super::Studio;
use crate::command::{DesignTab, Page};
use crate::design_overlays::OverlayName;
use crate::jobs::DiagnosisNews;
use crate::jobs::code_export::WrittenCode;
use crate::jobs::kept_designs::RestoredDesign;
use crate::jobs::live_design::TimedPreview;
use crate::jobs::measurements::MeasurementResult;
use crate::jobs::plot_copy::{CopiedPlot, CopyOutcome};
use crate::versioned_results::VersionedResult;

/// Time from the last change to the verification on the full plant: shorter would verify in the middle of typing.
const VERIFICATION_DELAY: Duration = Duration::from_millis(120);

impl Studio {
    /// Takes the answers of the workers.
    pub(super) fn take_answers(&mut self) {
        if let Some((revision, answer)) = self.jobs.design.take() {
            match answer {
                Ok(preview) => self.take_preview(revision, preview),
                Err(why) => self.take_project_errors(revision, why),
            }
        }
        if let Some((revision, answer)) = self.jobs.verify.take() {
            match answer {
                Ok(Some(found)) => self.take_verification(revision, found),
                Ok(None) => {}
                Err(why) => {
                    self.results.verification_failure = Some(VersionedResult { revision, value: why })
                }
            }
        }
        if let Some((revision, Some(value))) = self.jobs.effort.take() {
            self.results.effort = Some(VersionedResult { revision, value });
        }
        if let Some((revision, Some(value))) = self.jobs.loop_view.take() {
            self.results.loop_view = Some(VersionedResult { revision, value });
        }
        self.take_partial_verification();
        self.take_measurements();
        self.take_export();
        self.take_report();
        self.take_rounds();
        self.take_study();
        let had_recordings = !self.jobs.recordings.is_empty();
        if self.jobs.take_diagnosis() == DiagnosisNews::Ended {
            self.replay_recordings();
        }
        if had_recordings && self.jobs.recordings.is_empty() && self.jobs.recording_views.is_some() {
            self.view.show_error("there is no recording in that folder (CSV, Parquet, MATLAB, HDF5, NumPy)");
        }
    }

    fn take_preview(&mut self, revision: u64, preview: TimedPreview) {
        (self.results.plant_failure, self.results.design_failure) = (None, None);
        self.results.plant = Some(VersionedResult { revision, value: preview.plant });
        match preview.design {
            Some(Ok(design)) => {
                self.results.design_time = preview.took;
                let design = Arc::new(*design);
                // where its charts are not shown they wait until the design rests, as verification does
                if self.view.page == Page::Design && self.view.design_tab == DesignTab::Loop {
                    self.jobs.loop_view.ask(revision, Arc::clone(&design));
                }
                self.results.design = Some(VersionedResult { revision, value: design });
                self.verify_at = Some(Moment::now() + VERIFICATION_DELAY);
            }
            Some(Err(why)) => self.results.design_failure = Some(VersionedResult { revision, value: why }),
            None => (self.results.design, self.results.verified) = (None, None),
        }
    }

    /// Takes over why the project cannot be modelled, and therefore has no design either.
    pub(super) fn take_project_errors(&mut self, revision: u64, why: Vec<String>) {
        self.results.plant_failure = Some(VersionedResult { revision, value: why.clone() });
        self.results.design_failure = Some(VersionedResult { revision, value: why });
    }

    fn take_verification(&mut self, revision: u64, found: VerifiedController) {
        (self.results.verification_failure, self.results.partial) = (None, None);
        self.results.verified = Some(VersionedResult { revision, value: Arc::new(found) });
        self.results.verifying = false;
        self.complete_kept_design(revision);
    }

    fn take_partial_verification(&mut self) {
        if let Some(partial) = self.jobs.partial.lock().ok().and_then(|mut slot| slot.take()) {
            self.results.partial = Some(partial);
        }
    }

    fn take_measurements(&mut self) {
        let measurements = &mut self.results.measurements;
        match self.jobs.measure.take() {
            Some((revision, MeasurementResult::Map(value))) => {
                measurements.map = Some(VersionedResult { revision, value });
            }
            Some((revision, MeasurementResult::Campaign(value))) => {
                measurements.campaign = Some(VersionedResult { revision, value });
            }
            None => {}
        }
        let partial = self.jobs.partial_campaign.lock().ok().and_then(|mut slot| slot.take());
        if let (Some(found), Some(of)) = (partial, &self.results.verified)
            && self.jobs.measure.is_busy()
        {
            measurements.campaign = Some(VersionedResult { revision: of.revision, value: Ok(found) });
        }
    }

    fn take_export(&mut self) {
        match self.jobs.export.take() {
            Some((_, Ok(Some(WrittenCode { paths, left_out })))) => {
                let folder = paths.first().and_then(|p| p.parent()).unwrap_or(Path::new("."));
                let name = |path: &PathBuf| path.strip_prefix(folder).unwrap_or(path).display().to_string();
                let names: Vec<String> = paths.iter().map(name).collect();
                let message = format!("wrote {} to {}", names.join(", "), folder.display());
                if left_out.is_empty() {
                    self.view.show_message(message);
                } else {
                    self.view.show_error(format!("{message}; left out {}", left_out.join("; ")));
                }
            }
            Some((_, Ok(None))) => {
                self.view.show_message("the export was stopped; files that were written stay");
            }
            Some((_, Err(why))) => {
                self.view.show_error(format!("not exported: {why}; Ctrl+Shift+E exports into another folder"))
            }
            None => {}
        }
    }

    fn take_report(&mut self) {
        match self.jobs.report.take() {
            Some((_, Ok(path))) => {
                self.view.show_message(format!("the report is in {}", path.display()));
            }
            Some((_, Err(why))) => self.view.show_error(format!("the report was not written: {why}")),
            None => {}
        }
    }

    /// Takes the pictures of a plant, kept designs and copied plots.
    pub(super) fn take_pictures(&mut self) {
        if let Some((_, picture)) = self.jobs.reduction.take() {
            self.results.reduction = Some(Arc::new(picture));
        }
        if let Some((revision, value)) = self.jobs.ranking.take() {
            self.results.ranking = Some(VersionedResult { revision, value });
        }
        if let Some((_, modes)) = self.jobs.beam_modes.take() {
            self.results.beam_modes = Some(Arc::new(modes));
        }
        if let Some((_, restored)) = self.jobs.restore.take() {
            for RestoredDesign { name, design } in restored {
                // a design that cannot be computed any more is left out
                if let (OverlayName::Slot(slot), Ok(design)) = (name, design) {
                    self.view.kept.entry(slot).or_insert(design);
                }
            }
        }
        if let Some((_, copied)) = self.jobs.copy.take() {
            self.take_copied_plot(copied);
        }
    }

    fn take_copied_plot(&mut self, copied: CopiedPlot) {
        let CopiedPlot { format, title, outcome } = copied;
        match outcome {
            Ok(CopyOutcome::ForClipboard(content)) => {
                self.view.show_message(format!("\"{title}\" is in the clipboard as {}", format.words()));
                self.clipboard = Some(content);
            }
            Ok(CopyOutcome::Written(path)) => {
                self.view.show_message(format!("\"{title}\" is saved in {}", path.display()));
            }
            Err(why) => {
                self.view.show_error(format!("\"{title}\" cannot be copied as {}: {why}", format.words()));
            }
        }
    }
}
