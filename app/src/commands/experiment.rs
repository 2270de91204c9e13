//! `counterpoise experiment`: the demand that best separates what a diagnosis leaves possible.

use std::path::PathBuf;

use anyhow::{Context, Error};
use clap::Args;
use counterpoise_diagnose::experiment::{ExperimentPlan, Limits, MachineMotion, PossibleMachine};
use counterpoise_host::workers::ProgressPool;
use counterpoise_host::{files, projects};
use counterpoise_pipeline::exchange::{RunHistory, RunSignal, WithHistories};
use counterpoise_pipeline::recordings::experiment::{DiagnosisFindings, demand_csv, plan_experiment};
use counterpoise_project::Purpose;
use counterpoise_report::experiment::{PlannedMotion, experiment_report};
use counterpoise_report::terminal::experiment::experiment_lines;
use counterpoise_report::wording::experiment::describe_plan;
use counterpoise_report::wording::recordings::describe_recordings_error;

use crate::exit::{CommandResult, ExitStatus};
use crate::options::{ResultOutput, WRITTEN};
use crate::output::{self, say};

/// Arguments of `experiment`.
#[derive(Args)]
pub struct ExperimentOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// JSON result of a diagnosis of this project; without it the plan is for the effects that machines most often lack
    pub findings: Option<PathBuf>,
    /// The limits that the machine must not pass.
    #[command(flatten)]
    pub limits: MotionLimits,
    /// Duration, s
    #[arg(long, value_name = "DURATION", default_value = "10", value_parser = parse_seconds)]
    pub duration: f64,
    /// CSV file for the demand
    #[arg(short, long, value_name = "FILE", default_value = "demand.csv")]
    pub output: PathBuf,
    /// Write a report to this HTML file
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// With --json or --data: also the motion of every machine in the best experiment
    #[arg(long, requires = WRITTEN)]
    pub histories: bool,
    /// The destination of results.
    #[command(flatten)]
    pub results: ResultOutput,
}

/// The limits that a machine must not pass in an experiment.
#[derive(Args)]
pub struct MotionLimits {
    /// Largest angle from the start to either side, rad (m on a linear axis)
    #[arg(long, value_name = "ANGLE", value_parser = parse_positive)]
    pub angle: f64,
    /// Largest rate in either direction, rad/s (m/s)
    #[arg(long, value_name = "RATE", value_parser = parse_positive)]
    pub rate: f64,
    /// Largest current in either direction, A; no limit if absent
    #[arg(long, value_name = "CURRENT", value_parser = parse_positive)]
    pub current: Option<f64>,
}

impl MotionLimits {
    /// Returns the limits of an experiment of a duration in s.
    pub fn experiment_limits(&self, duration_s: f64) -> Limits {
        Limits {
            angle_rad: self.angle,
            rate_rad_s: self.rate,
            current_a: self.current.unwrap_or(f64::INFINITY),
            duration_s,
        }
    }
}

/// Returns a finite number above 0.
fn parse_positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        _ => Err("must be a number above 0, such as 0.1".to_owned()),
    }
}

/// Longest experiment that is planned, s.
const LONGEST_S: f64 = 600.0;

/// Returns a duration that can be planned.
pub(crate) fn parse_seconds(text: &str) -> Result<f64, String> {
    match parse_positive(text)? {
        duration if duration <= LONGEST_S => Ok(duration),
        _ => Err(format!("must be at most {LONGEST_S} s: a longer experiment is this one, repeated")),
    }
}

/// Runs the command.
pub fn run(options: &ExperimentOptions) -> CommandResult {
    let loaded = projects::load_project(&options.project, Purpose::Experiment)?;
    output::print_warnings(&loaded, options.results.progress());
    let findings = options.findings.as_ref().map(|path| -> anyhow::Result<DiagnosisFindings> {
        let bytes = files::read_file(path).with_context(|| format!("cannot read {}", path.display()))?;
        serde_json::from_slice(&bytes).with_context(|| {
            format!("{} is not the JSON result of a diagnosis: write it with `counterpoise diagnose PROJECT RECORDINGS --json=FILE`", path.display())
        })
    });
    let findings = findings.transpose()?;
    let limits = options.limits.experiment_limits(options.duration);
    let workers = ProgressPool::new(options.results.progress());
    let planned = plan_experiment(&loaded.project, findings.as_ref(), limits, &workers);
    workers.finish();
    let planned = planned.map_err(|error| Error::msg(describe_recordings_error(&error)))?;
    let period_s = loaded.project.plant.interface.sample_period_s;
    let text = describe_plan(&planned);
    if let Some(best) = planned.experiments.first() {
        projects::write_file(&options.output, demand_csv(&best.demand, period_s).as_bytes())?;
    }
    let controlled = loaded.project.plant.controlled_quantity();
    if let Some(path) = &options.report {
        let command = format!("counterpoise experiment {}", loaded.path.display());
        let page = experiment_report(
            &loaded.project.plant.name,
            &command,
            &text,
            PlannedMotion { plan: &planned, controlled },
        );
        output::write_report(path, &options.results, &page)?;
    }
    let histories = if options.histories { motion_histories(&planned) } else { Vec::new() };
    if !output::write_result(&options.results, &WithHistories { result: &text, histories })? {
        output::print_lines(&experiment_lines(&text, controlled));
        say!("the demand is written to {}", options.output.display());
    }
    Ok(ExitStatus::SUCCESS)
}

/// Returns the motion of every machine in the best experiment.
fn motion_histories(planned: &ExperimentPlan) -> Vec<RunHistory> {
    let history = |(machine, motion): (&PossibleMachine, &MachineMotion)| {
        let signals = [
            ("angle_rad", &motion.angle_rad),
            ("rate_rad_s", &motion.rate_rad_s),
            ("current_a", &motion.current_a),
        ];
        let signals = signals.map(|(name, samples)| RunSignal::new(name, samples.as_slice()));
        RunHistory::new(&machine.name, motion.period_s, signals)
    };
    planned.machines.iter().zip(&planned.motions).map(history).collect()
}
