//! A commissioning on disk: rounds of design, experiment, diagnosis and redesign on a machine behind a program, each in a folder of its own.
//!
//! A round that was stopped at any point goes on where it was: its experiments, its result and the model of the next round are files that are written once.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, Error, Result, bail};
use counterpoise_diagnose::experiment::Limits;
use counterpoise_export::host::machine_step;
use counterpoise_pipeline::commission::{
    PlannedRun, RecordedRun, ReplayUse, RoundSummary, StopReason, assign_controller, judge_requirements,
    judge_run, plan_runs, stop_after_update, stop_before_update, update_model,
};
use counterpoise_pipeline::exchange::ControllerResult;
use counterpoise_pipeline::identity::ProjectIdentity;
use counterpoise_pipeline::recordings::{GapTreatment, RecordingFile, read_files};
use counterpoise_pipeline::{DesignStages, HeaderWords, run_stages};
use counterpoise_pool::Pool;
use counterpoise_project::resolve::controller_file::ControllerContent;
use counterpoise_project::{Attachments, Document, Language, Purpose};

use crate::machine_program::{
    RunEnd, RunLimits, check_same_limits, check_within_limits, has_answer, read_answer, read_recording_file,
    request_of, run_machine, write_request,
};
use crate::projects::{self, ProjectOnDisk, ProjectWorld};
use crate::stages::ProgressDisplay;
use crate::{code_files, files};

/// Name of the model of a round in its folder, and of its result.
const MODEL: &str = "project.toml";
const RESULT: &str = "round.json";
/// Name of the page of all rounds.
const STORY: &str = "story.html";

/// Returns the folder of a round in that of the rounds.
fn round_folder(folder: &Path, round: usize) -> PathBuf {
    folder.join(format!("round-{round}"))
}

/// Data of a commissioning before its first round.
#[derive(Debug, Clone, PartialEq)]
pub struct CommissioningSetup {
    /// The project file.
    pub project: PathBuf,
    /// The machine program, with its arguments.
    pub machine: String,
    /// Limits that the machine must not pass.
    pub limits: RunLimits,
    /// Duration of the experiment that tells machines apart, s.
    pub duration_s: f64,
    /// Folder of the rounds.
    pub folder: PathBuf,
}

impl CommissioningSetup {
    fn round_folder(&self, round: usize) -> PathBuf {
        round_folder(&self.folder, round)
    }

    fn experiment_limits(&self) -> Limits {
        let RunLimits { angle_rad, rate_rad_s, current_a } = self.limits;
        let current_a = current_a.unwrap_or(f64::INFINITY);
        Limits { angle_rad, rate_rad_s, current_a, duration_s: self.duration_s }
    }
}

/// The means of a round: processors for its computations, whether its stages are printed, and the words of its code's headers.
#[derive(Clone, Copy)]
pub struct RoundTools<'a> {
    /// The processors.
    pub pool: &'a dyn Pool,
    /// Whether stages are printed.
    pub stages: ProgressDisplay,
    /// The words.
    pub words: &'a dyn HeaderWords,
}

/// A commissioning whose folder belongs to its project.
#[derive(Debug, Clone)]
pub struct Commissioning {
    setup: CommissioningSetup,
    attachments: Attachments,
}

impl Commissioning {
    /// Opens a commissioning: makes the folder of the first round, or checks that one that goes on is of the same project.
    ///
    /// # Errors
    /// A project that cannot be read, a folder that cannot be written or holds the commissioning of another project.
    pub fn open(setup: CommissioningSetup) -> Result<Self> {
        let (given, attachments) = projects::read_as_written(&setup.project)?;
        let first = setup.round_folder(1).join(MODEL);
        if !first.exists() {
            projects::write_file(&first, given.text().as_bytes())?;
        } else if files::read_file(&first)? != given.text().as_bytes() {
            bail!(
                "{} holds the commissioning of another project, or of this one before it was changed: give another folder (-o)",
                setup.folder.display()
            );
        }
        Ok(Self { setup, attachments })
    }

    /// Returns the summaries of the rounds that have come to their end.
    ///
    /// # Errors
    /// A result that cannot be read.
    pub fn finished_rounds(&self) -> Result<Vec<RoundSummary>> {
        read_rounds(&self.setup.folder)
    }

    /// Runs a round to its end, and leaves its result and the model of the next round. Experiments that were run before are not run again.
    ///
    /// # Errors
    /// Those of the design, the machine program and the recordings.
    pub fn run_round(&self, round: usize, tools: RoundTools<'_>) -> Result<RoundSummary> {
        let folder = self.setup.round_folder(round);
        let model = folder.join(MODEL);
        let text = files::read_file(&model)?;
        let path = &self.setup.project;
        let document = Document::from_bytes(&text, &path.display().to_string())
            .map_err(|_| Error::msg(format!("{} is no project file", model.display())))?;
        let loaded = projects::load_document(path.clone(), document, &self.attachments, Purpose::Design)?;
        Round { setup: &self.setup, number: round, folder, loaded, tools }.run()
    }
}

/// Returns the summaries of the rounds of a folder that have come to their end, in their order.
///
/// # Errors
/// A result that cannot be read.
pub fn read_rounds(folder: &Path) -> Result<Vec<RoundSummary>> {
    let mut rounds = Vec::new();
    loop {
        let path = round_folder(folder, rounds.len() + 1).join(RESULT);
        if !path.exists() {
            return Ok(rounds);
        }
        let summary = serde_json::from_slice(&files::read_file(&path)?);
        rounds.push(summary.with_context(|| format!("{} is not the result of a round", path.display()))?);
    }
}

/// Returns the text of the newest model that so many finished rounds of a folder have left; `None` if none left one.
pub fn read_newest_model(folder: &Path, rounds: usize) -> Option<String> {
    let model = |round: usize| files::read_file(&round_folder(folder, round).join(MODEL)).ok();
    let newest = (2..=rounds + 1).rev().find_map(model)?;
    String::from_utf8(newest).ok()
}

/// Writes the page of all rounds into their folder, and returns its path.
///
/// # Errors
/// A page that cannot be written.
pub fn write_story(folder: &Path, page: &str) -> Result<PathBuf> {
    let path = folder.join(STORY);
    projects::write_file(&path, page.as_bytes())?;
    Ok(path)
}

/// A round with its project.
struct Round<'a> {
    setup: &'a CommissioningSetup,
    number: usize,
    folder: PathBuf,
    loaded: ProjectOnDisk,
    tools: RoundTools<'a>,
}

/// An exported controller, with the design that it came from.
struct DesignedRound {
    stages: DesignStages,
    content: Arc<ControllerContent>,
}

/// The recordings that a machine left of the experiments of a round.
#[derive(Default)]
struct RecordedRuns {
    runs: Vec<RecordedRun>,
    /// The files of those that can be replayed.
    replayed: Vec<RecordingFile>,
}

/// The end of the experiments of a round.
enum RunsEnd {
    Complete(RecordedRuns),
    Stopped(StopReason),
}

impl Round<'_> {
    /// Runs the round to its end, and leaves its result and the model of the next round.
    fn run(&self) -> Result<RoundSummary> {
        let designed = self.design()?;
        let hash = designed.content.project_hash.clone();
        let mut summary = RoundSummary::begin(self.number, &hash, &designed.stages);
        let project = assign_controller(&self.loaded.project, &designed.content);
        let limits = self.setup.experiment_limits();
        let planned = plan_runs(&project, &designed.stages, limits, self.tools.pool)?;
        summary.left_out.extend(planned.left_out.iter().map(|run| run.name.to_owned()));
        let recorded = match self.run_experiments(&planned.runs, &hash, &mut summary)? {
            RunsEnd::Complete(recorded) => recorded,
            RunsEnd::Stopped(stop) => return self.finish(summary, Some(stop)),
        };
        let verdicts = judge_requirements(&self.loaded.project, &designed.stages, &recorded.runs);
        summary.add_verdicts(&self.loaded.project, &verdicts);
        if let Some(stop) = stop_before_update(&verdicts, &summary.runs) {
            return self.finish(summary, Some(stop));
        }
        let pool = self.tools.pool;
        let update = update_model(&self.loaded.stated, &designed.content, &recorded.replayed, pool)?;
        summary.add_update(&update);
        let stop = stop_after_update(&self.loaded.stated, &update, &verdicts, &summary);
        let next = update.project.update(&self.loaded.document, &self.loaded.stated)?;
        let path = self.setup.round_folder(self.number + 1).join(MODEL);
        projects::write_file(&path, next.text().as_bytes())?;
        self.finish(summary, stop)
    }

    fn finish(&self, summary: RoundSummary, stop: Option<StopReason>) -> Result<RoundSummary> {
        let summary = RoundSummary { stop, ..summary };
        let text = crate::json::json_text(&summary)?;
        projects::write_file(&self.folder.join(RESULT), text.as_bytes())?;
        Ok(summary)
    }

    /// Designs the controller of the round and writes its code.
    fn design(&self) -> Result<DesignedRound> {
        let world = ProjectWorld::of(&self.loaded, self.tools.stages);
        let mut project = self.loaded.project.clone();
        project.export.languages = vec![Language::C99];
        let stages = run_stages(&project, self.tools.words, &world)?;
        let identity = ProjectIdentity::of(&project, &world);
        let controller = stages.verified.controller();
        let result = ControllerResult::new(&identity, controller);
        let step = machine_step(&project.export.options.name);
        code_files::write_with_controller(&self.folder.join("controller"), &stages.files, &result, &[step])?;
        let content = ControllerContent { controller: controller.clone(), project_hash: identity.hash };
        Ok(DesignedRound { stages, content: Arc::new(content) })
    }

    /// Runs the experiments that have not been run yet, and reads what the machine left.
    fn run_experiments(
        &self,
        runs: &[PlannedRun],
        hash: &str,
        summary: &mut RoundSummary,
    ) -> Result<RunsEnd> {
        if runs.is_empty() {
            return Ok(RunsEnd::Stopped(StopReason::NoExperiment));
        }
        let mut recorded = RecordedRuns::default();
        for run in runs {
            if self.tools.pool.is_cancelled() {
                bail!("stopped before the experiment {}: the same round goes on from here", run.name);
            }
            let folder = self.folder.join(run.name);
            let request = request_of(run, self.number, self.setup.limits, hash);
            if has_answer(&folder) {
                check_same_limits(&folder, &request)?;
            } else {
                write_request(&folder, &request, run)?;
                run_machine(&self.setup.machine, &folder)?;
            }
            let answer = read_answer(&folder, &request)?;
            let file = read_recording_file(&folder)?;
            let recording = self.read_recording(run, &file, answer.ended)?;
            summary.add_run(run, &judge_run(run, &recording.recording));
            if answer.ended == RunEnd::Aborted {
                let (run, why) = (run.name.to_owned(), answer.reason);
                return Ok(RunsEnd::Stopped(StopReason::Aborted { run, why }));
            }
            recorded.runs.push(recording);
            if run.replay == ReplayUse::Replayed {
                recorded.replayed.push(file);
            }
        }
        Ok(RunsEnd::Complete(recorded))
    }

    /// Reads the recording of a run, and checks that it is that of the request.
    fn read_recording(&self, run: &PlannedRun, file: &RecordingFile, ended: RunEnd) -> Result<RecordedRun> {
        let files = std::slice::from_ref(file);
        let read = read_files(&self.loaded.project, None, files, GapTreatment::AsWritten)?;
        let first = read.into_iter().next().with_context(|| format!("{} holds no recording", file.name))?;
        let (samples, wanted) = (first.recording.len(), run.request.demand.len());
        if ended == RunEnd::Complete && samples != wanted {
            bail!("{} has {samples} samples, the request {wanted}", file.name);
        }
        let (period_s, asked_s) = (first.recording.sample_period_s, run.request.sample_period_s);
        if !run.request.has_clock_of(&first.recording) {
            bail!("{} has a sample period of {period_s} s, the request {asked_s} s", file.name);
        }
        if ended == RunEnd::Complete {
            check_within_limits(&first.recording, &run.request, &self.setup.limits)?;
        }
        Ok(RecordedRun { run: run.clone(), recording: first.recording })
    }
}
