//! `counterpoise commission`: rounds of design, experiment, diagnosis and redesign on a machine behind a program.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, Error, Result, bail};
use clap::Args;
use counterpoise_export::host::machine_step;
use counterpoise_host::machine_program::{
    RunEnd, RunLimits, has_answer, read_answer, read_recording_file, request_of, run_machine, write_request,
};
use counterpoise_host::projects::{self, ProjectOnDisk, ProjectWorld};
use counterpoise_host::workers::ProgressPool;
use counterpoise_host::{code_files, files};
use counterpoise_pipeline::commission::{
    PlannedRun, RecordedRun, ReplayUse, RoundSummary, StopReason, assign_controller, judge_requirements,
    judge_run, machine_time_s, plan_runs, stop_after_update, stop_before_update, update_model,
};
use counterpoise_pipeline::exchange::ControllerResult;
use counterpoise_pipeline::identity::ProjectIdentity;
use counterpoise_pipeline::recordings::{GapTreatment, RecordingFile, read_files};
use counterpoise_pipeline::{DesignStages, PipelineError, run_stages};
use counterpoise_project::resolve::controller_file::ControllerContent;
use counterpoise_project::{Document, Language, Purpose};
use counterpoise_report::commission::{commission_report, describe_round, describe_stop};
use counterpoise_report::html_page;
use counterpoise_report::wording::code_header::HeaderText;
use counterpoise_report::wording::recordings::describe_recordings_error;
use serde::Serialize;

use crate::commands::experiment::{MotionLimits, parse_seconds};
use crate::exit::{CommandResult, verdict_code};
use crate::options::ResultOutput;
use crate::output::{self, say};

/// Arguments of `commission`.
#[derive(Args)]
pub struct CommissionOptions {
    /// Project file, or a folder with a project.toml: the drawing values, with tolerances where they are not certain
    pub project: PathBuf,
    /// Program that runs an experiment on the machine; it is started with the folder of the experiment as its last argument
    #[arg(long, value_name = "COMMAND")]
    pub machine: String,
    /// Rounds at most
    #[arg(long, value_name = "ROUNDS", default_value = "5")]
    pub rounds: usize,
    /// The limits that the machine must not pass.
    #[command(flatten)]
    pub limits: MotionLimits,
    /// Duration of the experiment that tells machines apart, s
    #[arg(long, value_name = "DURATION", default_value = "10", value_parser = parse_seconds)]
    pub duration: f64,
    /// Folder for the rounds; a commissioning that was stopped goes on where it was
    #[arg(short, long, default_value = "commission")]
    pub output: PathBuf,
    /// The destination of results.
    #[command(flatten)]
    pub results: ResultOutput,
}

impl CommissionOptions {
    fn run_limits(&self) -> RunLimits {
        let limits = &self.limits;
        RunLimits { angle_rad: limits.angle, rate_rad_s: limits.rate, current_a: limits.current }
    }

    fn round_folder(&self, round: usize) -> PathBuf {
        self.output.join(format!("round-{round}"))
    }
}

/// The whole commissioning for another program.
#[derive(Serialize)]
struct Story<'a> {
    rounds: &'a [RoundSummary],
}

/// Runs the command.
pub fn run(options: &CommissionOptions) -> CommandResult {
    let path = projects::project_file(&options.project);
    let (given, attachments) = projects::read_as_written(&path)?;
    begin(options, &given)?;
    let mut rounds: Vec<RoundSummary> = Vec::new();
    for round in 1..=options.rounds {
        let folder = options.round_folder(round);
        let summary = match finished_round(&folder)? {
            Some(finished) => finished,
            None => {
                let text = files::read_file(&folder.join(MODEL))?;
                let document = Document::from_bytes(&text, &path.display().to_string()).map_err(|_| {
                    Error::msg(format!("{} is no project file", folder.join(MODEL).display()))
                })?;
                let loaded = projects::load_document(path.clone(), document, &attachments, Purpose::Design)?;
                Round { options, number: round, folder: folder.clone(), loaded }.run()?
            }
        };
        print_round(options, &summary);
        let stop = summary.stop.clone();
        rounds.push(summary);
        if stop.is_some() {
            break;
        }
    }
    let last = rounds.last_mut().context("--rounds must be at least 1")?;
    last.stop.get_or_insert(StopReason::RoundsOver);
    let met = matches!(last.stop, Some(StopReason::RequirementsMet | StopReason::ModelExplains));
    let page = commission_report(&path.display().to_string(), &rounds, machine_time_s(&rounds));
    projects::write_file(&options.output.join("story.html"), html_page(&page).as_bytes())?;
    if !output::write_json(&options.results, &Story { rounds: &rounds })? {
        rounds
            .last()
            .and_then(|last| last.stop.as_ref())
            .iter()
            .for_each(|stop| say!("{}", describe_stop(stop)));
        say!("the whole story: {}", options.output.join("story.html").display());
    }
    Ok(verdict_code([met]))
}

/// Name of the model of a round in its folder, and of its result.
const MODEL: &str = "project.toml";
const RESULT: &str = "round.json";

/// Makes the folder of the first round, or checks that a commissioning that goes on is of the same project.
fn begin(options: &CommissionOptions, given: &Document) -> Result<()> {
    let first = options.round_folder(1).join(MODEL);
    if !first.exists() {
        return projects::write_file(&first, given.text().as_bytes());
    }
    if files::read_file(&first)? != given.text().as_bytes() {
        bail!(
            "{} holds the commissioning of another project, or of this one before it was changed: give another folder with -o",
            options.output.display()
        );
    }
    Ok(())
}

/// Returns the summary of a round that came to its end; `None` if it did not.
fn finished_round(folder: &Path) -> Result<Option<RoundSummary>> {
    let path = folder.join(RESULT);
    if !path.exists() {
        return Ok(None);
    }
    let summary = serde_json::from_slice(&files::read_file(&path)?);
    summary.map(Some).with_context(|| format!("{} is not the result of a round", path.display()))
}

fn print_round(options: &CommissionOptions, summary: &RoundSummary) {
    if options.results.json.is_none() {
        describe_round(summary).iter().for_each(|line| say!("{line}"));
    }
}

/// A round with its project.
struct Round<'a> {
    options: &'a CommissionOptions,
    number: usize,
    folder: PathBuf,
    loaded: ProjectOnDisk,
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
        let workers = ProgressPool::new(self.options.results.progress());
        let project = assign_controller(&self.loaded.project, &designed.content);
        let limits = self.options.limits.experiment_limits(self.options.duration);
        let planned = plan_runs(&project, &designed.stages, limits, &workers)?;
        workers.finish();
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
        let workers = ProgressPool::new(self.options.results.progress());
        let update = update_model(&self.loaded.stated, &designed.content, &recorded.replayed, &workers);
        workers.finish();
        let update = update.map_err(|error| Error::msg(describe_recordings_error(&error)))?;
        summary.add_update(&update);
        let stop = stop_after_update(&self.loaded.stated, &update, &verdicts, &summary);
        let next = update.project.update(&self.loaded.document, &self.loaded.stated)?;
        let path = self.options.round_folder(self.number + 1).join(MODEL);
        projects::write_file(&path, next.text().as_bytes())?;
        self.finish(summary, stop)
    }

    fn finish(&self, summary: RoundSummary, stop: Option<StopReason>) -> Result<RoundSummary> {
        let summary = RoundSummary { stop, ..summary };
        let text = counterpoise_host::json::json_text(&summary)?;
        projects::write_file(&self.folder.join(RESULT), text.as_bytes())?;
        Ok(summary)
    }

    /// Designs the controller of the round and writes its code.
    fn design(&self) -> Result<DesignedRound> {
        let world = ProjectWorld::of(&self.loaded, self.options.results.progress());
        let mut project = self.loaded.project.clone();
        project.export.languages = vec![Language::C99];
        let stages = run_stages(&project, &HeaderText, &world)?;
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
            let folder = self.folder.join(run.name);
            let request = request_of(run, self.number, self.options.run_limits(), hash);
            if !has_answer(&folder) {
                write_request(&folder, &request, run)?;
                run_machine(&self.options.machine, &folder)?;
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
        let refused = |error: PipelineError| Error::msg(describe_recordings_error(&error));
        let files = std::slice::from_ref(file);
        let read = read_files(&self.loaded.project, None, files, GapTreatment::AsWritten).map_err(refused)?;
        let first = read.into_iter().next().with_context(|| format!("{} holds no recording", file.name))?;
        let (samples, wanted) = (first.recording.len(), run.request.demand.len());
        if ended == RunEnd::Complete && samples != wanted {
            bail!("{} has {samples} samples, the request {wanted}", file.name);
        }
        let (period_s, asked_s) = (first.recording.sample_period_s, run.request.sample_period_s);
        if !run.request.has_clock_of(&first.recording) {
            bail!("{} has a sample period of {period_s} s, the request {asked_s} s", file.name);
        }
        Ok(RecordedRun { run: run.clone(), recording: first.recording })
    }
}
