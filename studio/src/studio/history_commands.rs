//! The history of designs: kept with a name, restored, renamed and deleted.

use std::collections::BTreeMap;
use std::sync::Arc;

use counterpoise_pipeline::live_figures::SensitivityPoints;
use counterpoise_pipeline::preview::DesignPreview;
use counterpoise_project::{Document, Project};
use counterpoise_verify::{
    Arrangement, LoopFigure, Model, PerformanceFigure, Quantity, Source, Value, Verdict, Verification,
};

use super::Studio;
use crate::command::Command;
use crate::design_overlays::{AwaitedVerification, HistoryFileState};
use crate::editing::design_history::{DesignHistory, KeptVerdict, NamedDesign};
use crate::editing::weight_text::{design_sections, replace_design_sections, weight_differences};
use crate::jobs::history_file::{HistoryFile, HistoryJob, HistoryOutcome, history_path};
use crate::results::VerificationState;

/// Points of the curve of a thumbnail: enough for a line of 150 pixels, and one readable line of the file.
const THUMBNAIL_POINTS: usize = 32;
/// The figures of the loop that are kept of every design.
const LOOP_FIGURES: [LoopFigure; 5] = [
    LoopFigure::GainMargin,
    LoopFigure::PhaseMargin,
    LoopFigure::DelayMargin,
    LoopFigure::MaxSensitivity,
    LoopFigure::Crossover,
];

impl Studio {
    /// Has the history read if it may have changed, as soon as it is not being written.
    pub(super) fn read_changed_history(&mut self) {
        let is_free = self.is_history_read_due && !self.jobs.history.is_pending();
        let Some(opened) = self.opened.as_ref().filter(|_| is_free) else { return };
        self.jobs.history.ask(0, HistoryJob::Read { path: history_path(&opened.path) });
        self.is_history_read_due = false;
    }

    /// Takes over the content of the file.
    pub(super) fn take_history(&mut self) {
        let Some((_, HistoryFile { path, content, outcome })) = self.jobs.history.take() else { return };
        if self.opened.as_ref().is_none_or(|opened| history_path(&opened.path) != path) {
            self.is_history_read_due = true;
            return;
        }
        if let HistoryOutcome::NotWritten(why) = &outcome {
            self.view.show_error(format!("the history was not written: {}: {why}", path.display()));
        }
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        match content {
            Ok(text) if outcome == HistoryOutcome::Written => {
                let known = &mut self.view.history.known;
                if known.last() == Some(&text) {
                    *known = vec![text];
                }
            }
            Ok(text) if self.view.history.known == [text.as_str()] => {}
            Ok(text) => self.take_history_text(&name, text),
            Err(why) => {
                let advice = "Put this right, or move the file away; until it can be read, nothing is written into it.";
                let history = &mut self.view.history;
                history.file = HistoryFileState::Damaged(format!("{name} cannot be read: {why}. {advice}"));
                history.known.clear();
            }
        }
    }

    /// Takes over the text of a file that was read.
    fn take_history_text(&mut self, name: &str, text: String) {
        self.view.history.file = match DesignHistory::parse(&text) {
            Ok(designs) => {
                self.take_designs(designs);
                HistoryFileState::Readable
            }
            Err(damage) => HistoryFileState::Damaged(format!(
                "{name}, line {}: {}. Correct this line, or take back the last good version of the file; until it can be read, nothing is written into it.",
                damage.line, damage.message
            )),
        };
        self.view.history.known = vec![text];
    }

    /// Takes over designs that another program has written.
    fn take_designs(&mut self, designs: DesignHistory) {
        let history = &mut self.view.history;
        let is_same = |name: &str| {
            let weights = |of: &DesignHistory| of.find(name).map(|design| design.weights.clone());
            weights(&designs) == weights(&history.designs)
        };
        let changed: Vec<String> = history.shown.values().filter(|name| !is_same(name)).cloned().collect();
        changed.iter().for_each(|name| history.forget_design(name));
        history.shown.retain(|_, name| designs.find(name).is_some());
        history.designs = designs;
    }

    /// Has changed designs written; returns `None` and shows why if nothing may be written.
    fn change_history(&mut self, failure: &str, change: impl FnOnce(&mut DesignHistory)) -> Option<()> {
        let opened = self.opened.as_ref()?;
        let path = history_path(&opened.path);
        let refusal = match &self.view.history.file {
            _ if opened.is_read_only() => {
                Some("the project is open in another window, which alone writes its history".to_owned())
            }
            HistoryFileState::Unread => Some("the history is still being read; do it again".to_owned()),
            HistoryFileState::Damaged(why) => Some(why.clone()),
            HistoryFileState::Readable => None,
        };
        if let Some(why) = refusal {
            self.view.show_error(format!("{failure}: {why}"));
            return None;
        }
        let history = &mut self.view.history;
        change(&mut history.designs);
        let (known, text) = (history.known.clone(), history.designs.to_text());
        history.known.push(text.clone());
        self.jobs.history.ask(0, HistoryJob::Write { path, known, text });
        Some(())
    }

    /// Keeps the design as it stands with a name. If it is being verified, its figures follow.
    pub(super) fn keep_named_design(&mut self, name: &str) {
        let name = name.trim();
        match self.named_design(name) {
            Ok(design) => {
                let has_verdicts = !design.verdicts.is_empty();
                let kept = self.change_history("not kept", |designs| designs.add(design));
                if kept.is_none() {
                    return;
                }
                let revision = self.opened.as_ref().map(|opened| opened.session.revision());
                let history = &mut self.view.history;
                history.typed.clear();
                history.awaited = revision
                    .filter(|_| !has_verdicts)
                    .map(|revision| AwaitedVerification { revision, name: name.to_owned() });
                self.view.show_message(format!("kept as \"{name}\", in {}", self.history_file_name()));
            }
            Err(why) => self.view.show_error(format!("not kept: {why}")),
        }
    }

    fn history_file_name(&self) -> String {
        let path = self.opened.as_ref().map(|opened| history_path(&opened.path)).unwrap_or_default();
        path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
    }

    /// Returns the design as it stands as the history keeps it, or why it cannot be kept.
    fn named_design(&self, name: &str) -> Result<NamedDesign, String> {
        let missing = || "there is no design of the project as it stands".to_owned();
        let opened = self.opened.as_ref().ok_or_else(missing)?;
        let revision = opened.session.revision();
        let of = self.results.design.as_ref().filter(|of| of.revision == revision).ok_or_else(missing)?;
        if name.is_empty() {
            return Err("give the design a name".to_owned());
        }
        if of.value.trial_moment_kg_m.is_some() || self.view.trial_moment_kg_m.is_some() {
            return Err("another out-of-balance is tried; end the trial first".to_owned());
        }
        let weights = design_sections(opened.session.text());
        if weights.is_empty() && !opened.session.document().parts().is_empty() {
            return Err(
                "the weights stand in a file that the project includes, and are kept there".to_owned()
            );
        }
        if weight_differences(&weights, &weights).is_none() {
            return Err(
                "the sections [synth] and [reduce] cannot be taken out of the text by themselves".to_owned()
            );
        }
        let other = self.view.history.designs.find(name);
        if other.is_some_and(|other| !has_same_weights(&other.weights, &weights)) {
            return Err(format!(
                "\"{name}\" is the name of another design; choose another one, or delete that design"
            ));
        }
        let verification = self.results.verification(revision);
        let complete = verification.filter(|(_, state)| *state == VerificationState::Complete);
        Ok(describe_design(name, weights, &of.value, complete.map(|(found, _)| found)))
    }

    /// Adds the figures to a design that was kept before its verification had ended.
    pub(super) fn complete_kept_design(&mut self, revision: u64) {
        let Some(awaited) = self.view.history.awaited.take_if(|awaited| awaited.revision == revision) else {
            return;
        };
        if self.view.history.designs.find(&awaited.name).is_some()
            && let Ok(design) = self.named_design(&awaited.name)
        {
            let _ = self.change_history("its figures were not kept", |designs| designs.add(design));
        }
    }

    /// Puts the weights and the order of a named design into the project; one step of undo removes them again.
    pub(super) fn restore_named_design(&mut self, name: &str) {
        let Some(kept) = self.view.history.designs.find(name) else { return };
        let Some(opened) = &self.opened else { return };
        let Some(now) = opened.session.project() else { return };
        let document = opened.session.document();
        let text = replace_design_sections(document.text(), &kept.weights);
        match Project::resolve(&document.with_text(&text), opened.session.attachments()) {
            Ok(kept) => {
                let (synth, reduce) = (kept.project.synth, kept.project.reduce);
                let project = Project { synth, reduce, ..Project::clone(now) };
                // comments of the project stay if its values alone can be changed; otherwise the kept text replaces its sections
                let is_whole = |updated: &Document| {
                    let read = Project::resolve(updated, opened.session.attachments());
                    let weights = |of: &Project| (of.synth.clone(), of.reduce);
                    read.is_ok_and(|read| weights(&read.project) == weights(&project))
                };
                let updated = project.update(document, now).ok().filter(is_whole);
                let text = updated.map_or(text, |updated| updated.text().to_owned());
                self.run(&Command::Replace { text });
                self.view
                    .show_message(format!("the weights of \"{name}\" are restored (Ctrl+Z undoes this)"));
            }
            Err(errors) => {
                let why = errors.first().map_or_else(String::new, ToString::to_string);
                self.view.show_error(format!("the weights of \"{name}\" cannot be restored: {why}"));
            }
        }
    }

    /// Gives a named design another name.
    pub(super) fn rename_named_design(&mut self, name: &str, new_name: &str) {
        let new_name = new_name.trim();
        self.view.history.renaming = None;
        let designs = &self.view.history.designs;
        if new_name.is_empty() || new_name == name || designs.find(name).is_none() {
            return;
        }
        if designs.find(new_name).is_some() {
            let why = format!("not renamed: another design is called \"{new_name}\"");
            return self.view.show_error(why);
        }
        if self.change_history("not renamed", |designs| designs.rename(name, new_name)).is_some() {
            self.view.history.move_design(name, new_name);
        }
    }

    /// Deletes a named design; it can be put back until the project is closed.
    pub(super) fn delete_named_design(&mut self, name: &str) {
        let mut deleted = None;
        let done = self.change_history("not deleted", |designs| deleted = designs.remove(name));
        if let (Some(()), Some(deleted)) = (done, deleted) {
            let history = &mut self.view.history;
            if let Some(place) = history.colour_place(name) {
                history.shown.remove(&place);
            }
            history.forget_design(name);
            history.deleted = Some(deleted);
            self.view
                .show_message(format!("\"{name}\" is deleted; \"Put the deleted design back\" undoes this"));
        }
    }

    /// Puts the design that was deleted last back to its place.
    pub(super) fn put_design_back(&mut self) {
        let Some(deleted) = self.view.history.deleted.clone() else {
            return self.view.show_error("no design was deleted since the project was opened");
        };
        if self.view.history.designs.find(deleted.name()).is_some() {
            let why =
                format!("not put back: another design is called \"{}\" now; rename it first", deleted.name());
            return self.view.show_error(why);
        }
        if self.change_history("not put back", |designs| designs.put_back(deleted)).is_some() {
            self.view.history.deleted = None;
        }
    }
}

fn has_same_weights(first: &str, second: &str) -> bool {
    weight_differences(first, second).is_some_and(|differences| differences.is_empty())
}

/// Returns a design as the history keeps it.
fn describe_design(
    name: &str,
    weights: String,
    design: &Arc<DesignPreview>,
    verification: Option<&Verification>,
) -> NamedDesign {
    let controlled = design.synthesised.controlled;
    let mut figures = BTreeMap::new();
    for measured in design.loop_figures() {
        if let (PerformanceFigure::Loop(figure), Value::Is(value)) = (measured.figure, measured.value)
            && LOOP_FIGURES.contains(&figure)
        {
            figures.insert(measured.figure.key_in(controlled), value);
        }
    }
    let mut verdicts = BTreeMap::new();
    if let Some(found) = verification {
        for figure in rate_figures() {
            figures.extend(found.value(figure).map(|value| (figure.key_in(controlled), value)));
        }
        for (requirement, verdict) in &found.verdicts {
            let key = requirement.figure.key_in(controlled);
            figures.extend(found.value(requirement.figure).map(|value| (key.clone(), value)));
            verdicts.insert(key, kept_verdict(verdict));
        }
    }
    figures.retain(|_, value| value.is_finite());
    let SensitivityPoints { ends_hz, modulus_db } = design.sensitivity_points(THUMBNAIL_POINTS);
    let name = name.to_owned();
    NamedDesign { name, sensitivity_hz: ends_hz, sensitivity_db: modulus_db, weights, figures, verdicts }
}

/// Returns the RMS hub rates with the whole controller on the full plant.
pub fn rate_figures() -> impl Iterator<Item = PerformanceFigure> {
    let rate = |source| {
        PerformanceFigure::Disturbance(Model::Nonlinear, source, Arrangement::Compensated, Quantity::HubRms)
    };
    [Source::Heave, Source::Pitch, Source::Both, Source::Road].into_iter().map(rate)
}

fn kept_verdict(verdict: &Verdict) -> KeptVerdict {
    match verdict {
        Verdict::Holds { .. } => KeptVerdict::Holds,
        Verdict::Fails { .. } => KeptVerdict::Fails,
        Verdict::NotApplicable { .. } => KeptVerdict::Open,
    }
}
