//! The designs that are drawn over the current one: computed, and run on the full plant where their runs are drawn.

use std::path::Path;
use std::sync::Arc;

use counterpoise_host::files::ProjectFolder;
use counterpoise_pipeline::preview::DesignPreview;

use super::Studio;
use crate::command::{Page, VerificationTab};
use crate::design_overlays::{OverlayName, OverlayRuns};
use crate::editing::weight_text::{other_sections, replace_design_sections};
use crate::jobs::kept_designs::{KeptRequest, KeptText, RestoredDesign};
use crate::jobs::overlay_runs::{OverlayRunRequest, OverlayRunResult};
use crate::jobs::verification::VerificationRequest;

impl Studio {
    /// Asks for the named designs that are drawn and not computed yet.
    pub(super) fn request_overlays(&mut self) {
        let Some(opened) = self.opened.as_ref().filter(|_| !self.view.dragging) else { return };
        let (session, history) = (&opened.session, &mut self.view.history);
        if history.shown.is_empty() || !session.errors().is_empty() {
            return;
        }
        if history.compared_revision != Some(session.revision()) {
            history.compared_revision = Some(session.revision());
            let mechanism_text = other_sections(session.text());
            if mechanism_text != history.mechanism_text {
                history.mechanism_text = mechanism_text;
                history.generation += 1;
                history.previews.clear();
                history.failures.clear();
            }
        }
        if self.jobs.overlays.is_pending() {
            return;
        }
        let is_missing =
            |name: &&String| !history.previews.contains_key(*name) && !history.failures.contains_key(*name);
        let text = |name: &String| {
            let weights = &history.designs.find(name)?.weights;
            let text = replace_design_sections(session.text(), weights);
            Some(KeptText { name: OverlayName::Named(name.clone()), text })
        };
        let texts: Vec<KeptText> = history.shown.values().filter(is_missing).filter_map(text).collect();
        if !texts.is_empty() {
            let (document, attachments) = (session.document().clone(), session.attachments().clone());
            self.jobs.overlays.ask(history.generation, KeptRequest { document, attachments, texts });
        }
    }

    /// Takes over computed designs.
    pub(super) fn take_overlays(&mut self) {
        if let Some((generation, restored)) = self.jobs.overlays.take() {
            let history = &mut self.view.history;
            for RestoredDesign { name, design } in restored {
                let OverlayName::Named(name) = name else { continue };
                match design {
                    _ if generation != history.generation => {}
                    Ok(design) => drop(history.previews.insert(name, design)),
                    Err(why) => {
                        let message = format!("\"{name}\" cannot be drawn: {why}");
                        history.failures.insert(name, why);
                        self.view.notice = Some(crate::view::StatusNotice {
                            text: message,
                            severity: crate::view::NoticeKind::Error,
                        });
                    }
                }
            }
        }
        if let Some((_, OverlayRunResult { name, design, found })) = self.jobs.overlay_runs.take() {
            self.view.history.runs.insert(name, OverlayRuns { design, found });
        }
    }

    /// Asks for the runs of a design that is drawn where runs are drawn, one after the other, while nothing else is verified.
    pub(super) fn request_overlay_runs(&mut self) {
        let view = &self.view;
        let draws_runs = view.page == Page::Verify && view.verification_tab == VerificationTab::Histories;
        let is_free =
            self.verify_at.is_none() && !self.jobs.verify.is_pending() && !self.jobs.design.is_pending();
        let Some(opened) = self.opened.as_ref().filter(|_| draws_runs && is_free && !view.dragging) else {
            return;
        };
        if self.jobs.overlay_runs.is_pending() || view.history.are_runs_stopped {
            return;
        }
        let has_runs = |name: &OverlayName, design: &Arc<DesignPreview>| {
            view.history.runs.get(name).is_some_and(|runs| Arc::ptr_eq(&runs.design, design))
        };
        let missing = view.overlaid_designs().into_iter().find(|one| !has_runs(&one.name, &one.design));
        if let Some(one) = missing {
            let folder = ProjectFolder(opened.path.parent().unwrap_or(Path::new(".")).to_owned());
            let request = VerificationRequest { design: one.design, folder };
            self.jobs.overlay_runs.ask(0, OverlayRunRequest { name: one.name, request });
        }
    }
}
