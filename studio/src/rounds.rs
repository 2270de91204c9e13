//! What the studio does by itself, once a frame: takes answers, asks for what is due, looks at the file and the journal.

use std::sync::Arc;
use std::time::{Duration, Instant};

use counterpoise_verify::VerifiedController;

use crate::browser::Browser;
use crate::command::{Place, Purpose};
use crate::errands::Glance;
use crate::exporting::Written;
use crate::jobs::{Copied, Form};
use crate::live::{Ask, Live};
use crate::measure::MeasureAnswer;
use crate::results::Of;
use crate::studio::Studio;

/// How long after the last change the nonlinear verification begins.
const VERIFY_AFTER: Duration = Duration::from_millis(120);
/// How often it is looked whether the file was changed outside.
const LOOK_EVERY: Duration = Duration::from_secs(1);

impl Studio {
    /// Takes answers, asks for what is due; once a frame.
    pub fn tick(&mut self) {
        self.take_filed();
        self.take_answers();
        self.take_pictures();
        self.ask_design();
        self.ask_pictures();
        if self.verify_at.is_some_and(|at| Instant::now() >= at) && !self.view.dragging {
            self.verify();
        }
        self.look_again();
        self.look_outside();
        self.list_folder();
        (self.results.designing, self.results.verifying) =
            (self.jobs.live.is_busy(), self.jobs.verify.is_busy());
    }

    /// When the studio should next look after itself, while nobody touches it.
    pub fn wakes_after(&self) -> Duration {
        let verify = self.verify_at.map(|at| at.saturating_duration_since(Instant::now()));
        verify.unwrap_or(LOOK_EVERY).max(Duration::from_millis(5))
    }

    /// Whether nothing is asked for or running.
    pub fn is_idle(&self) -> bool {
        !self.can_stop() && !self.filing.is_busy() && !self.jobs.is_tidying()
    }

    /// Whether there is something to stop.
    pub fn can_stop(&self) -> bool {
        self.verify_at.is_some() || self.jobs.is_busy() || self.filing.opening().is_some()
    }

    fn take_answers(&mut self) {
        if let Some((revision, answer)) = self.jobs.live.take() {
            match answer {
                Ok(live) => self.designed(revision, live),
                Err(why) => self.results.no_design = Some(Of { revision, value: why }),
            }
        }
        if let Some((revision, answer)) = self.jobs.verify.take() {
            match answer {
                Ok(Some(found)) => self.verified(revision, found),
                Ok(None) => {}
                Err(why) => self.results.no_verification = Some(Of { revision, value: why }),
            }
        }
        if let Some((revision, Some(value))) = self.jobs.effort.take() {
            self.results.effort = Some(Of { revision, value });
        }
        self.take_partial();
        self.take_measured();
        self.take_exported();
        let asked = !self.jobs.recordings.is_empty();
        if self.jobs.take_diagnosis() {
            self.look();
        }
        if asked && self.jobs.recordings.is_empty() && self.jobs.seen.is_some() {
            self.view.warn("there is no recording in that folder (CSV, Parquet, MATLAB, HDF5)");
        }
    }

    fn take_pictures(&mut self) {
        if let Some((_, portrait)) = self.jobs.portrait.take() {
            self.results.portrait = Some(Arc::new(portrait));
        }
        if let Some((_, swinging)) = self.jobs.swing.take() {
            self.results.swinging = Some(Arc::new(swinging));
        }
        if let Some((_, copied)) = self.jobs.copy.take() {
            self.take_copy(copied);
        }
    }

    fn take_copy(&mut self, (form, title, copy): Copied) {
        let kind = match form {
            Form::Csv => "numbers (CSV)",
            Form::Svg => "a drawing (SVG)",
            Form::Png => "pixels (PNG)",
        };
        match copy {
            Ok(copy) => {
                self.view.say(format!("\"{title}\" is in the clipboard as {kind}"));
                self.copied = Some(copy);
            }
            Err(why) => self.view.warn(format!("\"{title}\" cannot be copied as {kind}: {why}")),
        }
    }

    /// Asks for what the place shows beside the design, where that is of another plant.
    fn ask_pictures(&mut self) {
        let (place, results) = (self.view.place, &self.results);
        if let (Place::Plant | Place::Reduce, Some(of)) = (place, &results.live)
            && !results.portrait.as_ref().is_some_and(|p| p.is_of(&of.value))
            && !self.jobs.portrait.is_pending()
        {
            self.jobs.portrait.ask(of.revision, Arc::clone(&of.value));
        }
        let project = self.opened.as_ref().and_then(|o| o.session.project());
        if let (Place::Plant, true, Some(beam)) =
            (place, self.view.mode > 0, project.and_then(|p| p.plant.beam.as_ref()))
            && !results.swinging.as_ref().is_some_and(|s| s.beam == *beam)
            && !self.jobs.swing.is_pending()
        {
            self.jobs.swing.ask(0, beam.clone());
        }
    }

    /// Lays the recordings beside the model again where the project has changed since.
    fn look_again(&mut self) {
        let revision = self.opened.as_ref().map(|o| o.session.revision());
        let due = self.jobs.seen.as_ref().is_some_and(|of| Some(of.revision) != revision);
        if due && !self.jobs.look.is_busy() && !self.view.dragging && !self.jobs.recordings.is_empty() {
            self.look();
        }
    }

    fn take_partial(&mut self) {
        let partial = self.jobs.partial.lock().ok().and_then(|mut kept| kept.take());
        if let Some((revision, value)) = partial {
            self.results.partial = Some(Of { revision, value });
        }
    }

    fn take_measured(&mut self) {
        let measured = &mut self.results.measured;
        match self.jobs.measure.take() {
            Some((revision, MeasureAnswer::Map(value))) => measured.map = Some(Of { revision, value }),
            Some((revision, MeasureAnswer::Robust(value))) => measured.robust = Some(Of { revision, value }),
            None => {}
        }
        let so_far = self.jobs.so_far.lock().ok().and_then(|mut kept| kept.take());
        if let (Some(found), Some(of)) = (so_far, &self.results.verified)
            && self.jobs.measure.is_busy()
        {
            measured.robust = Some(Of { revision: of.revision, value: Ok(found) });
        }
    }

    fn take_exported(&mut self) {
        match self.jobs.export.take() {
            Some((_, Ok(Some(Written { paths, left_out })))) => {
                let folder = paths.first().and_then(|p| p.parent()).unwrap_or(std::path::Path::new("."));
                let names: Vec<String> = paths
                    .iter()
                    .map(|path| path.strip_prefix(folder).unwrap_or(path).display().to_string())
                    .collect();
                let wrote = format!("wrote {} to {}", names.join(", "), folder.display());
                if left_out.is_empty() {
                    self.view.say(wrote);
                } else {
                    self.view.warn(format!("{wrote}; left out {}", left_out.join("; ")));
                }
            }
            Some((_, Ok(None))) => self.view.say("the export was stopped; what is written stays"),
            Some((_, Err(why))) => {
                self.view.warn(format!("not exported: {why}; Ctrl+Shift+E exports into another folder"))
            }
            None => {}
        }
    }

    fn designed(&mut self, revision: u64, live: Box<Live>) {
        self.results.no_design = None;
        self.results.live = Some(Of { revision, value: Arc::new(*live) });
        self.verify_at = Some(Instant::now() + VERIFY_AFTER);
    }

    fn verified(&mut self, revision: u64, found: VerifiedController) {
        (self.results.no_verification, self.results.partial) = (None, None);
        self.results.verified = Some(Of { revision, value: Arc::new(found) });
    }

    fn ask_design(&mut self) {
        let Some(opened) = &self.opened else { return };
        let now = (opened.session.revision(), self.view.tried_kg_m);
        if self.asked == Some(now) {
            return;
        }
        self.asked = Some(now);
        if !opened.session.errors().is_empty() {
            let value = opened.session.errors().iter().map(ToString::to_string).collect();
            self.results.no_design = Some(Of { revision: now.0, value });
        } else if let Some(project) = opened.session.project() {
            let ask = Ask { project: Arc::clone(project), out_of_balance_kg_m: now.1 };
            self.jobs.live.ask(now.0, ask);
        }
    }

    /// Lists the folder that is looked through, again every now and then; where no project is open there always is one.
    fn list_folder(&mut self) {
        let here = || Browser::new(Purpose::Project, &std::env::current_dir().unwrap_or_default());
        if self.opened.is_none() && self.view.browser.is_none() && !self.filing.is_busy() {
            self.view.browser = Some(here());
        }
        let Some(browser) = &mut self.view.browser else { return };
        let wanted = (browser.folder(), browser.purpose);
        if let Some((_, listing)) = self.jobs.list.take() {
            self.listed = Instant::now();
            browser.listing = Some(listing);
        }
        let there = browser.listing.as_ref().is_some_and(|l| (&l.folder, l.purpose) == (&wanted.0, wanted.1));
        if (!there || self.listed.elapsed() > LOOK_EVERY) && !self.jobs.list.is_busy() {
            self.jobs.list.ask(0, wanted);
        }
    }

    /// Looks every now and then whether somebody else wrote the file, and whether the journal is written.
    fn look_outside(&mut self) {
        self.take_glance();
        if self.looked.elapsed() < LOOK_EVERY {
            return;
        }
        self.looked = Instant::now();
        self.look_at_journal();
        if let Some(opened) = self.opened.as_ref().filter(|_| !self.jobs.glance.is_pending()) {
            let ask = Glance { path: opened.path.clone(), modified: opened.modified };
            self.jobs.glance.ask(self.saves, ask);
        }
    }

    /// Takes what was seen, unless a project was opened or saved since.
    fn take_glance(&mut self) {
        let Some((saves, seen)) = self.jobs.glance.take() else { return };
        let is_late = saves != self.saves || self.filing.is_busy();
        let Some(opened) = self.opened.as_mut().filter(|o| !is_late && o.path == seen.path) else { return };
        if self.jobs.recordings.is_empty() {
            self.jobs.beside = seen.beside;
        }
        if let Some(content) = seen.content {
            opened.modified = seen.modified;
            opened.changed_outside = content != opened.session.saved().as_bytes();
        }
    }

    fn look_at_journal(&mut self) {
        let trouble = self.journal.trouble().filter(|_| self.opened.is_some());
        if trouble == self.troubled {
            return;
        }
        match &trouble {
            Some(why) => self.view.warn(format!(
                "edits are not kept against a crash: {why}. Make room, or save (Ctrl+S) as soon as there is some"
            )),
            None => self.view.say("edits are kept again against a crash"),
        }
        self.troubled = trouble;
    }
}
