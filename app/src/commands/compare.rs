//! `counterpoise compare`: the project's own design, the joint optimum and tuned fixed structures in one table.

use anyhow::{Context as _, Result, bail};
use clap::Args;
use counterpoise_host::projects::{self, ProjectWorld};
use counterpoise_pipeline::PipelineStage;
use counterpoise_pipeline::studies::designs::{ComparisonRequest, design_table};
use counterpoise_project::Purpose;
use counterpoise_report::results::DesignTableText;
use counterpoise_report::terminal::comparison::comparison_lines;
use counterpoise_report::{ReportOrigin, designs};
use counterpoise_synth::LoopLimits;
use serde::Serialize;
use std::path::PathBuf;

use crate::exit::{CommandResult, ExitStatus};
use crate::options::{ResultOutput, WRITTEN};
use crate::output::{self, say};

/// Arguments of `compare`.
#[derive(Args)]
pub struct CompareOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// Tune under these limits too: largest |S|, largest |T|, largest noise gain and largest |KS| in V s/rad; 0 for no limit. May be repeated
    #[arg(long, value_name = "MS,MT,NOISE,KS")]
    pub limits: Vec<String>,
    /// Write the table in Markdown to this file
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,
    /// Write a report to this HTML file
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// With --json or --data: also the runs of every design, from which the nonlinear figures can be recomputed
    #[arg(long, requires = WRITTEN)]
    pub histories: bool,
    /// The destination of results.
    #[command(flatten)]
    pub results: ResultOutput,
}

/// The table with the time of each design, for another program.
#[derive(Serialize)]
struct TimedTable<'a> {
    #[serde(flatten)]
    table: &'a DesignTableText,
    /// Time of each row's design without its simulation, s; it differs from run to run.
    design_time_s: &'a [f64],
}

/// Runs the command.
pub fn run(options: &CompareOptions) -> CommandResult {
    let further = options.limits.iter().map(|text| limits(text)).collect::<Result<_>>()?;
    let loaded = projects::load_project(&options.project, Purpose::Compare)?;
    output::print_warnings(&loaded, options.results.progress());
    let world = ProjectWorld::of(&loaded, options.results.progress());
    let found = design_table(
        &loaded.project,
        &ComparisonRequest { further, keeps_histories: options.histories },
        &world,
    )?;
    let table = DesignTableText::from(found);
    let times = world.times();
    let designs = times.iter().filter(|time| time.name == PipelineStage::Synthesise.name());
    let times_s: Vec<f64> = designs.map(|time| 1e-3 * time.milliseconds).collect();
    let project = loaded.path.display().to_string();
    let asked: String = options.limits.iter().map(|limits| format!(" --limits {limits}")).collect();
    let origin = ReportOrigin { command: format!("counterpoise compare {project}{asked}"), project };
    if let Some(path) = &options.markdown {
        let text = format!("`{}`\n\n{}", origin.command, designs::markdown_table(&table, &times_s));
        projects::write_file(path, text.as_bytes())?;
    }
    if let Some(path) = &options.report {
        let page = designs::comparison_report(&table, &times_s, &origin);
        output::write_report(path, &options.results, &page)?;
    }
    if !output::write_result(&options.results, &TimedTable { table: &table, design_time_s: &times_s })? {
        output::print_lines(&comparison_lines(&table, &times_s));
        options.markdown.iter().for_each(|path| say!("table   {}", path.display()));
        options.report.iter().for_each(|path| say!("report  {}", path.display()));
    }
    Ok(ExitStatus::SUCCESS)
}

/// Reads MS,MT,NOISE,KS.
fn limits(text: &str) -> Result<LoopLimits> {
    let usage = || {
        format!(
            "--limits {text}: write four numbers, for example 1.35,1.09,8.3,36 (largest |S|, |T|, noise gain, |KS|; 0 for no limit)"
        )
    };
    let numbers: Vec<f64> =
        text.split(',').map(|part| part.trim().parse().with_context(usage)).collect::<Result<_>>()?;
    let [ms, mt, noise, peak] = numbers[..] else { bail!(usage()) };
    let good = |limit: f64, least: f64| limit == 0.0 || (limit.is_finite() && limit > least);
    if !(good(ms, 1.0) && good(mt, 1.0) && good(noise, 0.0) && good(peak, 0.0)) {
        bail!("{}; limits of |S| and |T| must be above 1, the others positive", usage());
    }
    let or_none = |limit: f64| if limit == 0.0 { f64::INFINITY } else { limit };
    Ok(LoopLimits {
        max_sensitivity: or_none(ms),
        max_complementary: or_none(mt),
        noise_gain: or_none(noise),
        control_peak: or_none(peak),
        ..LoopLimits::default()
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn limits_are_four_numbers_and_0_means_none() {
        let found = limits("1.35, 1.09,8.3,0").unwrap();
        assert_eq!((found.max_sensitivity, found.max_complementary), (1.35, 1.09));
        assert_eq!((found.noise_gain, found.control_peak), (8.3, f64::INFINITY));
        for text in ["", "1.35", "1.35,1.09,8.3", "0.9,1.1,1,1", "1.3,1.1,-2,0", "1.3,x,1,1", "1.3,nan,1,1"] {
            assert!(limits(text).is_err(), "{text}");
        }
    }
}
