//! The commands of studies.

use counterpoise_pipeline::recordings::experiment::DiagnosisFindings;

use super::Studio;
use crate::command::Command;
use crate::jobs::studies::StudyRequest;
use crate::study_inputs::StudyKind;
use crate::versioned_results::VersionedResult;

impl Studio {
    /// Asks for a study of the project as it stands, and shows its place.
    pub(super) fn run_study(&mut self, study: StudyKind) {
        self.view.apply(&Command::ShowStudy { study });
        let Some(opened) = &self.opened else { return };
        if !opened.session.errors().is_empty() {
            return self.view.show_error("no study was made: the project file has errors");
        }
        let request = StudyRequest {
            kind: study,
            path: opened.path.clone(),
            document: opened.session.document().clone(),
            attachments: opened.session.attachments().clone(),
            recordings: self.jobs.recordings.clone(),
            findings: self.diagnosis_findings(),
            inputs: self.view.study_inputs.clone(),
        };
        self.jobs.asked_study = study;
        self.jobs.study.ask(opened.session.revision(), request);
    }

    /// Returns what the last diagnosis left possible, as its JSON result has it.
    fn diagnosis_findings(&self) -> Option<DiagnosisFindings> {
        let found = self.jobs.diagnosis.as_ref()?.as_ref().ok()?;
        serde_json::from_value(serde_json::to_value(&found.answer).ok()?).ok()
    }

    /// Takes over what a study found.
    pub(super) fn take_study(&mut self) {
        let Some((revision, (kind, Some(value)))) = self.jobs.study.take() else { return };
        if let Some(file) = value.as_ref().ok().and_then(|found| found.written.as_ref()) {
            self.view.show_message(format!("the demand is in {}", file.display()));
        }
        self.jobs.studies.insert(kind, VersionedResult { revision, value });
    }

    /// Puts a proposal of the study that is shown into the project, if it belongs to the project as it stands.
    pub(super) fn take_proposal(&mut self, number: usize) {
        let revision = self.opened.as_ref().map(|opened| opened.session.revision());
        let Some(found) = self.jobs.studies.get(&self.view.study) else {
            return self.view.show_error("not taken: the study was not made yet (F10)");
        };
        if Some(found.revision) != revision {
            return self
                .view
                .show_error("not taken: the project has changed since the study; make it again (F10)");
        }
        let proposals = found.value.as_ref().map(|found| found.proposals.as_slice()).unwrap_or_default();
        match number.checked_sub(1).and_then(|place| proposals.get(place)) {
            Some(proposal) => {
                let (name, text) = (format!("{}, {}", proposal.group, proposal.name), proposal.text.clone());
                self.run(&Command::Replace { text });
                self.view.show_message(format!("{name}: in the project (Ctrl+Z undoes this)"));
            }
            None => self
                .view
                .show_error(format!("not taken: the study proposes nothing with the number {number}")),
        }
    }
}
