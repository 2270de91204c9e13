//! `counterpoise commission`: rounds of design, experiment, diagnosis and redesign on a machine behind a program.

use std::path::PathBuf;

use anyhow::{Context, Error};
use clap::Args;
use counterpoise_host::commissioning::{Commissioning, CommissioningSetup, RoundTools, write_story};
use counterpoise_host::machine_program::RunLimits;
use counterpoise_host::projects;
use counterpoise_host::workers::ProgressPool;
use counterpoise_pipeline::PipelineError;
use counterpoise_pipeline::commission::{RoundSummary, StopReason, machine_time_s};
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
    fn setup(&self) -> CommissioningSetup {
        let limits = &self.limits;
        CommissioningSetup {
            project: projects::project_file(&self.project),
            machine: self.machine.clone(),
            limits: RunLimits { angle_rad: limits.angle, rate_rad_s: limits.rate, current_a: limits.current },
            duration_s: self.duration,
            folder: self.output.clone(),
        }
    }
}

/// The whole commissioning for another program.
#[derive(Serialize)]
struct Story<'a> {
    rounds: &'a [RoundSummary],
}

/// Runs the command.
pub fn run(options: &CommissionOptions) -> CommandResult {
    let setup = options.setup();
    let project = setup.project.display().to_string();
    let commissioning = Commissioning::open(setup)?;
    let mut rounds = commissioning.finished_rounds()?;
    rounds.truncate(options.rounds);
    rounds.iter().for_each(|round| print_round(options, round));
    while rounds.len() < options.rounds && rounds.last().is_none_or(|round| round.stop.is_none()) {
        let stages = options.results.progress();
        let workers = ProgressPool::new(stages);
        let summary = commissioning
            .run_round(rounds.len() + 1, RoundTools { pool: &workers, stages, words: &HeaderText });
        workers.finish();
        let summary = summary.map_err(in_words)?;
        print_round(options, &summary);
        rounds.push(summary);
    }
    let last = rounds.last_mut().context("--rounds must be at least 1")?;
    last.stop.get_or_insert(StopReason::RoundsOver);
    let met = matches!(last.stop, Some(StopReason::RequirementsMet | StopReason::ModelExplains));
    let page = commission_report(&project, &rounds, machine_time_s(&rounds));
    let story = write_story(&options.output, &html_page(&page))?;
    output::write_figures(&options.results, &page)?;
    if !output::write_result(&options.results, &Story { rounds: &rounds })? {
        rounds
            .last()
            .and_then(|last| last.stop.as_ref())
            .iter()
            .for_each(|stop| say!("{}", describe_stop(stop)));
        say!("the whole story: {}", story.display());
    }
    Ok(verdict_code([met]))
}

/// Words what the pipeline says of recordings.
fn in_words(error: Error) -> Error {
    match error.downcast_ref::<PipelineError>() {
        Some(refused) => Error::msg(describe_recordings_error(refused)),
        None => error,
    }
}

fn print_round(options: &CommissionOptions, summary: &RoundSummary) {
    if options.results.json.is_none() {
        describe_round(summary).iter().for_each(|line| say!("{line}"));
    }
}
