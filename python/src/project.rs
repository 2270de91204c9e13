//! A project file in memory, and everything that is made of it.

use std::path::{Path, PathBuf};

use anyhow::Context;
use counterpoise_host::code_files;
use counterpoise_host::projects::{self, ProjectOnDisk};
use counterpoise_pipeline::exchange::ControllerResult;
use counterpoise_pipeline::recordings::{ProjectReplayer, ReplaySettings, diagnose};
use counterpoise_pipeline::results::{DesignResult, ModelResult, ReduceResult, ReplayResult, SynthResult};
use counterpoise_pipeline::{
    self as pipeline, DesignContents, ProjectIdentity, design_project, run_stages, study_synthesis,
};
use counterpoise_project::{Attachments, Document, Purpose, SettingValue};
use counterpoise_report::results::{DesignText, SynthText, describe_reduction};
use counterpoise_report::wording::answer::describe_diagnosed_recordings;
use counterpoise_report::wording::code_header::HeaderText;
use counterpoise_report::wording::recordings::{describe_recordings_error, describe_replay};
use pyo3::prelude::*;
use serde::Serialize;

use crate::background;
use crate::failures::{CounterpoiseError, exception};

/// A project file in memory. Changes are kept here until `save` writes them.
#[pyclass(name = "NativeProject", module = "counterpoise._native")]
#[derive(Clone)]
pub struct NativeProject {
    path: PathBuf,
    document: Document,
    attachments: Attachments,
}

impl NativeProject {
    pub(crate) fn load_for(&self, purpose: Purpose) -> anyhow::Result<ProjectOnDisk> {
        projects::load_document(self.path.clone(), self.document.clone(), &self.attachments, purpose)
    }

    pub(crate) fn folder(&self) -> PathBuf {
        self.path.parent().unwrap_or(Path::new(".")).to_owned()
    }

    /// The same project with another file.
    pub(crate) fn with_document(self, document: Document) -> Self {
        Self { document, ..self }
    }

    /// Runs a job on the project and returns its result as JSON.
    pub(crate) fn json<T: Serialize>(
        &self,
        py: Python<'_>,
        progress: Option<&Bound<'_, PyAny>>,
        job: impl FnOnce(&Self, &background::BackgroundWorld) -> anyhow::Result<T> + Send + 'static,
    ) -> PyResult<String> {
        let project = self.clone();
        background::run(py, self.folder(), progress, move |world| {
            serde_json::to_string(&job(&project, world)?).context("cannot write the result as JSON")
        })
    }
}

#[pymethods]
impl NativeProject {
    /// Reads a project file, or the project.toml of a folder, with the files that it names.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let path = projects::project_file(&path);
        let read = py.detach(|| projects::read_as_written(&path));
        let (document, attachments) = read.map_err(|error| exception(py, &error))?;
        Ok(Self { path, document, attachments })
    }

    /// Makes a project of a text, beside whose files it stands in `folder`.
    #[staticmethod]
    fn from_text(text: &str, folder: PathBuf) -> Self {
        let path = projects::project_file(&folder);
        let document = Document::parse(text, &path.display().to_string());
        let attachments = counterpoise_host::files::read_attachments(&document, &path);
        Self { path, document: document.with_parts(&attachments), attachments }
    }

    /// Path of the file.
    #[getter]
    fn path(&self) -> PathBuf {
        self.path.clone()
    }

    /// The file as it would be saved.
    #[getter]
    fn text(&self) -> &str {
        self.document.text()
    }

    /// Returns the text at a path of keys as it is written; `None` if nothing is there.
    fn source_text(&self, key: &str) -> Option<String> {
        self.document.source_text_at(key)
    }

    /// Returns whether a text, quoted, stands at a path of keys.
    fn is_text(&self, key: &str) -> bool {
        self.document.is_text(key)
    }

    /// Returns the project with a number at a path of keys; comments, order, and the unit that was written stay.
    fn with_number(&self, key: &str, value: f64) -> PyResult<Self> {
        self.with(key, &SettingValue::Number(value))
    }

    /// Returns the project with a whole number at a path of keys.
    fn with_whole(&self, key: &str, value: i64) -> PyResult<Self> {
        self.with(key, &SettingValue::Whole(value))
    }

    /// Returns the project with a text at a path of keys.
    fn with_text(&self, key: &str, value: String) -> PyResult<Self> {
        self.with(key, &SettingValue::Text(value))
    }

    /// Returns the project with a list of numbers at a path of keys.
    fn with_numbers(&self, key: &str, values: Vec<f64>) -> PyResult<Self> {
        self.with(key, &SettingValue::Numbers(values))
    }

    /// Returns the project without a key.
    fn without(&self, key: &str) -> PyResult<Self> {
        let removed = self.document.remove(key);
        self.with_checked_document(removed.map_err(|error| CounterpoiseError::new_err(error.to_string()))?)
    }

    /// Writes the project to a file, whole or not at all.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        projects::write_file(&path, self.document.text().as_bytes()).map_err(|error| exception(py, &error))
    }

    /// Warnings and assumptions of the file, as JSON.
    fn check(&self, py: Python<'_>) -> PyResult<String> {
        #[derive(Serialize)]
        struct CheckOutput {
            warnings: Vec<counterpoise_project::Diagnostic>,
            assumptions: Vec<counterpoise_project::Assumption>,
        }
        self.json(py, None, |project, _| {
            let loaded = project.load_for(Purpose::Model)?;
            Ok(CheckOutput { warnings: loaded.warnings, assumptions: loaded.assumptions })
        })
    }

    /// The plant, as JSON.
    fn model(&self, py: Python<'_>) -> PyResult<String> {
        self.json(py, None, |project, _| {
            let loaded = project.load_for(Purpose::Model)?;
            let mut result = ModelResult::from(&pipeline::build_plant_model(&loaded.project)?);
            result.assumptions = loaded.assumptions;
            Ok(result)
        })
    }

    /// The reduced plant, as JSON.
    fn reduce(&self, py: Python<'_>) -> PyResult<String> {
        self.json(py, None, |project, _| {
            let loaded = project.load_for(Purpose::Reduce)?;
            let modelled = pipeline::build_plant_model(&loaded.project)?;
            let reduced = pipeline::reduce_plant(&loaded.project, &modelled)?;
            Ok(describe_reduction(ReduceResult::from(&reduced)))
        })
    }

    /// The controller with its certificates, as JSON.
    fn synth(&self, py: Python<'_>, progress: Option<&Bound<'_, PyAny>>) -> PyResult<String> {
        self.json(py, progress, |project, world| {
            let loaded = project.load_for(Purpose::Synth)?;
            let study = study_synthesis(&loaded.project, world)?;
            Ok(SynthText::from(SynthResult::from(&study.synthesised)))
        })
    }

    /// The design with everything that was verified, as JSON.
    fn design(&self, py: Python<'_>, progress: Option<&Bound<'_, PyAny>>) -> PyResult<String> {
        self.json(py, progress, |project, world| {
            let loaded = project.load_for(Purpose::Design)?;
            let designed = design_project(&loaded.project, &DesignContents::default(), &HeaderText, world)?;
            Ok(DesignText::new(&designed, DesignResult::from(&designed)))
        })
    }

    /// Writes the code of the controller into a folder; returns the paths of the files, as JSON.
    fn export(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<String> {
        self.json(py, progress, move |project, world| {
            let loaded = project.load_for(Purpose::Export)?;
            let made = run_stages(&loaded.project, &HeaderText, world)?;
            let identity = ProjectIdentity::of(&loaded.project, &loaded.project_folder());
            let controller = ControllerResult::new(&identity, made.verified.controller());
            let paths = code_files::write_with_controller(&folder, &made.files, &controller, &[])?;
            Ok(paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>())
        })
    }

    /// Replays recordings on the model, as JSON.
    fn replay(&self, py: Python<'_>, recordings: Vec<PathBuf>) -> PyResult<String> {
        self.json(py, None, move |project, _| {
            let loaded = project.load_for(Purpose::Replay)?;
            let files = projects::read_recordings(&recordings)?;
            let refused = |error| anyhow::Error::msg(describe_recordings_error(&error));
            let replayer =
                ProjectReplayer::new(&loaded.project, ReplaySettings::default()).map_err(refused)?;
            let read = replayer.read_files(&files).map_err(refused)?;
            let replayed = replayer.replay(&read).map_err(refused)?;
            Ok(ReplayResult { recordings: replayed.iter().map(describe_replay).collect() })
        })
    }

    /// Compares recordings with the model and says what was left out: the answer as JSON, and the project with it.
    fn diagnose(
        &self,
        py: Python<'_>,
        recordings: Vec<PathBuf>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<(String, Self)> {
        let project = self.clone();
        background::run(py, self.folder(), progress, move |world| {
            let loaded = project.load_for(Purpose::Diagnose)?;
            let files = projects::read_recordings(&recordings)?;
            let diagnosed = diagnose(&loaded.project, &files, world);
            let diagnosed =
                diagnosed.map_err(|error| anyhow::Error::msg(describe_recordings_error(&error)))?;
            let answer = describe_diagnosed_recordings(&diagnosed).answer;
            let json = serde_json::to_string(&answer).context("cannot write the result as JSON")?;
            let document = projects::improved_document(&loaded, &diagnosed.diagnosis.improved)?;
            Ok((json, project.with_document(document)))
        })
    }
}

impl NativeProject {
    fn with(&self, key: &str, setting: &SettingValue) -> PyResult<Self> {
        let set = self.document.set(key, setting);
        self.with_checked_document(set.map_err(|error| CounterpoiseError::new_err(error.to_string()))?)
    }

    fn with_checked_document(&self, document: Document) -> PyResult<Self> {
        let mut changed = self.clone().with_document(document);
        if changed.document.attachments() != self.document.attachments() {
            changed.attachments =
                counterpoise_host::files::read_attachments(&changed.document, &changed.path);
        }
        Ok(changed)
    }
}
