//! What the studio does by itself, once a frame: takes answers, asks for what is due, looks at the file and the journal.

use std::sync::Arc;
use std::time::{Duration, Instant};

use counterpoise_project::verify::VerifiedController;

use crate::browser::Browser;
use crate::command::Purpose;
use crate::filing::modified;
use crate::journal::Journal;
use crate::live::{Ask, Live};
use crate::measure::MeasureAnswer;
use crate::recordings;
use crate::results::Of;
use crate::studio::Studio;

/// How long after the last change the nonlinear verification begins.
const VERIFY_AFTER: Duration = Duration::from_millis(120);
/// How often it is looked whether the file was changed outside.
const LOOK_EVERY: Duration = Duration::from_secs(1);

impl Studio {
    /// Takes answers, asks for what is due; once a frame.
    pub fn tick(&mut self) {
        self.take_answers();
        self.ask_design();
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
        self.verify_at.is_none() && !self.jobs.is_busy()
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
        if self.jobs.take_diagnosis() {
            self.look();
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
            Some((_, Ok(Some(paths)))) => {
                let folder = paths.first().and_then(|p| p.parent()).unwrap_or(std::path::Path::new("."));
                let names: Vec<String> = paths
                    .iter()
                    .map(|path| path.strip_prefix(folder).unwrap_or(path).display().to_string())
                    .collect();
                self.view.say(format!("wrote {} to {}", names.join(", "), folder.display()));
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
        if self.opened.is_none() && self.view.browser.is_none() {
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

    /// Looks whether somebody else wrote the file, and whether the journal is written.
    fn look_outside(&mut self) {
        if self.looked.elapsed() < LOOK_EVERY {
            return;
        }
        self.looked = Instant::now();
        let Some(opened) = &mut self.opened else { return };
        if self.jobs.recordings.is_empty() {
            let folder = opened.path.parent().map(std::path::Path::to_owned);
            self.jobs.beside = folder.map_or(Vec::new(), |folder| recordings::files(&[folder]));
        }
        let now = modified(&opened.path);
        if now.is_some() && now != opened.modified {
            opened.modified = now;
            opened.changed_outside =
                std::fs::read(&opened.path).is_ok_and(|b| b != opened.session.text().as_bytes());
        }
        match opened.journal.as_ref().map(Journal::trouble) {
            Some(Some(why)) => {
                opened.troubled = true;
                self.view.warn(format!(
                    "edits are not kept against a crash: {why}. Make room, or save (Ctrl+S) as soon as there is some"
                ));
            }
            Some(None) if std::mem::take(&mut opened.troubled) => {
                self.view.say("edits are kept again against a crash");
            }
            _ => {}
        }
    }
}
