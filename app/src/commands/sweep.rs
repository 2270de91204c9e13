//! `counterpoise sweep`: robustness, in shards that anybody may run.

use crate::output::say;
use std::path::Path;

use anyhow::{Context, Result, bail};
use clap::Args;
use counterpoise::report::{Context as PageContext, html, sweep};
use counterpoise_project::Purpose;
use counterpoise_project::pipeline::export::project_hash;
use counterpoise_project::pipeline::{self, Designed};
use counterpoise_project::verify::robust::{Campaign, Member, Sample, merge, summary};
use rayon::prelude::*;

use super::{Done, verdict_code};
use crate::arguments::Results;
use crate::files::{self, Surroundings};
use crate::pace::Pace;
use crate::{output, shards, stop};

/// Arguments of `sweep`.
#[derive(Args)]
pub struct SweepOptions {
    /// Project file, or a folder with a project.toml
    pub project: std::path::PathBuf,
    /// Folder for shards, merged samples and report
    #[arg(short, long, default_value = "out/sweep")]
    pub output: std::path::PathBuf,
    /// Run one shard alone, for example 17/400 (the first is 0), and write its file
    #[arg(long, value_name = "K/N", conflicts_with_all = ["merge", "sample"])]
    pub shard: Option<String>,
    /// Put the shards of the folder together, running nothing
    #[arg(long, conflicts_with = "sample")]
    pub merge: bool,
    /// Run one sample again and print its factors and figures
    #[arg(long, value_name = "NUMBER")]
    pub sample: Option<usize>,
    /// Where results go.
    #[command(flatten)]
    pub results: Results,
}

/// Samples in a shard where nobody says how many shards there are.
const SHARD: usize = 50;

/// A campaign with its name: only files of the same name belong together.
struct Named {
    designed: Designed,
    campaign: Campaign,
    name: String,
    families: Vec<Member>,
    title: String,
}

/// Runs the command.
pub fn run(options: &SweepOptions) -> Done {
    let named = prepare(options)?;
    if let Some(index) = options.sample {
        return one_sample(&named, index, &options.results);
    }
    if let Some(shard) = &options.shard {
        let (shard, of) = shard_of(shard)?;
        let pace = pace(options, named.campaign.shard(shard, of)?.len())?;
        run_shard(&named, &options.output, (shard, of), &pace)?;
        told(options, pace.finish());
        return Ok(verdict_code(true));
    }
    let cost = if options.merge { None } else { run_all(&named, options)? };
    let code = finish(&named, options)?;
    told(options, cost);
    Ok(code)
}

fn pace(options: &SweepOptions, count: usize) -> Result<Pace> {
    if options.results.quiet { Ok(Pace::silent(count)) } else { Pace::shown(count) }
}

/// Tells what a large campaign would cost, beside the results and not among them.
fn told(options: &SweepOptions, cost: Option<String>) {
    if let Some(cost) = cost.filter(|_| !options.results.quiet) {
        eprintln!("{cost}");
    }
}

fn prepare(options: &SweepOptions) -> Result<Named> {
    let loaded = files::load(&options.project, Purpose::Sweep)?;
    output::warnings(&loaded, options.results.quiet);
    let world = Surroundings::of(&loaded, options.results.quiet);
    let designed = pipeline::design(&loaded.project, &world)?;
    let campaign = pipeline::campaign(&loaded.project, &designed.modelled, &designed.verified, &world)?;
    let families = match options.shard.is_some() || options.sample.is_some() {
        true => Vec::new(),
        false => pipeline::families(&loaded.project, &designed.modelled, &designed.verified, &world)?,
    };
    let name = format!("{} {} {}", env!("CARGO_PKG_VERSION"), project_hash(&loaded.project), campaign.len());
    Ok(Named { designed, campaign, name, families, title: loaded.project.plant.name.clone() })
}

fn shard_of(text: &str) -> Result<(usize, usize)> {
    let told = || format!("--shard {text}: write K/N, for example 17/400 (the first is 0)");
    let (k, n) = text.split_once('/').with_context(told)?;
    Ok((k.parse().with_context(told)?, n.parse().with_context(told)?))
}

/// Runs a shard unless its file is there and whole.
fn run_shard(named: &Named, folder: &Path, (shard, of): (usize, usize), pace: &Pace) -> Result<()> {
    let range = named.campaign.shard(shard, of)?;
    let path = shards::path(folder, shard, of);
    if path.exists() {
        let there = shards::read(&path, &named.campaign, &named.name);
        if there.is_ok_and(|samples| samples.iter().map(|sample| sample.index).eq(range.clone())) {
            pace.kept(range.len());
            return Ok(());
        }
    }
    let one = |index: usize| {
        let sample = named.campaign.run(index);
        pace.ran();
        sample
    };
    let samples = range.into_par_iter().map(one).collect::<Result<Vec<Sample>, _>>()?;
    shards::write(&path, &named.campaign, &named.name, &samples)
}

/// Runs every shard on all processors; what was done before stays done. Says what a large campaign would cost.
fn run_all(named: &Named, options: &SweepOptions) -> Result<Option<String>> {
    let count = named.campaign.len().div_ceil(SHARD);
    let pace = pace(options, named.campaign.len())?;
    stop::watch();
    for shard in 0..count {
        if stop::asked() {
            pace.finish();
            bail!(
                "stopped after {shard} of {count} shards, which are kept in {}; the same command goes on from there",
                options.output.display()
            );
        }
        run_shard(named, &options.output, (shard, count), &pace)?;
    }
    Ok(pace.finish())
}

/// Merges, writes the samples and the report, and prints the summary.
fn finish(named: &Named, options: &SweepOptions) -> Done {
    let mut parts = Vec::new();
    for path in shards::found(&options.output)? {
        parts.push(shards::read(&path, &named.campaign, &named.name)?);
    }
    let samples = merge(&named.campaign, parts).context(
        "the shards do not make one campaign: remove those of other cuts, or run the missing ones",
    )?;
    shards::write(&options.output.join("samples.parquet"), &named.campaign, &named.name, &samples)?;
    let found = named.designed.verified.verification();
    let section = sweep::sections(&named.campaign, &samples, &named.families);
    let subtitle = format!("{} mechanisms", samples.len());
    let context = PageContext {
        title: named.title.clone(),
        subtitle,
        more: section,
        provenance: vec![("campaign".to_owned(), named.name.clone())],
    };
    let page = html(&sweep::report(found, &named.campaign, &samples, context));
    files::write(&options.output.join("report.html"), page.as_bytes())?;
    let passes = samples.iter().all(|sample| named.campaign.passes(sample));
    if !output::json(&options.results, &summaries(named, &samples))? {
        print(named, &samples);
        say!("report  {}", options.output.join("report.html").display());
    }
    Ok(verdict_code(passes))
}

/// A requirement over the campaign, for a machine.
#[derive(serde::Serialize)]
struct Row {
    figure: String,
    share: f64,
    interval: (f64, f64),
    q05: f64,
    median: f64,
    q95: f64,
    worst_sample: Option<usize>,
}

fn summaries(named: &Named, samples: &[Sample]) -> Vec<Row> {
    let row = |(k, requirement): (usize, &counterpoise_project::verify::Requirement)| {
        let found = summary(&named.campaign, samples, k);
        Row {
            figure: requirement.figure.key(),
            share: found.share,
            interval: found.interval,
            q05: found.q05,
            median: found.median,
            q95: found.q95,
            worst_sample: found.worst,
        }
    };
    named.campaign.requirements().iter().enumerate().map(row).collect()
}

fn print(named: &Named, samples: &[Sample]) {
    for row in summaries(named, samples) {
        let (low, high) = (100.0 * row.interval.0, 100.0 * row.interval.1);
        let worst = row.worst_sample.map_or(String::new(), |k| format!(", worst: --sample {k}"));
        say!(
            "{:6.2} % ({low:.1} to {high:.1})  {}: 5 % {}, median {}, 95 % {}{worst}",
            100.0 * row.share,
            row.figure,
            output::figure(row.q05),
            output::figure(row.median),
            output::figure(row.q95)
        );
    }
}

/// One sample, for a machine.
#[derive(serde::Serialize)]
struct One {
    sample: usize,
    factors: Vec<(&'static str, f64)>,
    figures: Vec<(String, f64)>,
}

fn one_sample(named: &Named, index: usize, results: &Results) -> Done {
    if index >= named.campaign.len() {
        bail!("the campaign has {} samples: the last is {}", named.campaign.len(), named.campaign.len() - 1);
    }
    let sample = named.campaign.run(index)?;
    let keys = named.campaign.variations().iter().map(|variation| variation.parameter.key());
    let figures = named.campaign.requirements().iter().map(|requirement| requirement.figure.key());
    let one = One {
        sample: index,
        factors: keys.zip(sample.factors.iter().copied()).collect(),
        figures: figures.zip(sample.values.iter().copied()).collect(),
    };
    if !output::json(results, &one)? {
        one.factors.iter().for_each(|(key, factor)| say!("{key} x {factor:.4}"));
        one.figures.iter().for_each(|(key, value)| say!("{key} = {value:.6}"));
    }
    Ok(verdict_code(named.campaign.passes(&sample)))
}
