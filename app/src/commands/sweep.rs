//! `counterpoise sweep`: robustness, in shards that anybody may run.

use crate::output::say;
use anyhow::{Context, Error, Result, anyhow, bail};
use clap::Args;
use counterpoise_host::terminal::print_message;
use counterpoise_pipeline::results::RobustnessResult;
use counterpoise_pipeline::studies::certificate::{RegimeRobustness, other_robust_regimes};
use counterpoise_pipeline::studies::sweep::MechanismColumns;
use counterpoise_pipeline::studies::sweep::{
    BesideSamples, CampaignResult, ShardsProblem, campaign_is_stated, merge_shards, worst_cases,
};
use counterpoise_pipeline::{self as pipeline, DesignStages, ProjectIdentity};
use counterpoise_project::Purpose;
use counterpoise_report::sweep::SweepFigure;
use counterpoise_report::terminal::sweep::sweep_lines;
use counterpoise_report::wording::code_header::HeaderText;
use counterpoise_report::{ProvenanceEntry, VerificationContext, sweep};
use counterpoise_verify::robustness::{Campaign, FamilyMember};
use counterpoise_verify::structured::RobustStability;
use std::path::Path;

use crate::exit::{CommandResult, ExitStatus, verdict_code};
use crate::options::{ResultOutput, WRITTEN};
use crate::output;
use counterpoise_host::campaign_progress::CampaignPace;
use counterpoise_host::interrupt::Interruption;
use counterpoise_host::projects::{self, ProjectWorld};
use counterpoise_host::stages::ProgressDisplay;
use counterpoise_host::workers::{ProgressPool, try_map};
use counterpoise_host::{interrupt, shards};

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
    /// Put the shards of the folder together, running no sample
    #[arg(long, conflicts_with = "sample")]
    pub merge: bool,
    /// Run one sample again and print its factors and figures
    #[arg(long, value_name = "NUMBER")]
    pub sample: Option<usize>,
    /// Other factors for that sample, for example friction=2,backlash=0 (the report prints those of a worst case)
    #[arg(long, value_name = "KEY=FACTOR,...", requires = "sample", value_delimiter = ',')]
    pub factors: Vec<String>,
    /// With --json or --data: also the factors and figures of every mechanism, from which shares and quantiles can be recomputed
    #[arg(long, requires = WRITTEN)]
    pub histories: bool,
    /// The destination of results.
    #[command(flatten)]
    pub results: ResultOutput,
}

/// Samples in a shard if the command does not state the number of shards.
const SHARD: usize = 50;

/// A campaign with its name: only files of the same name belong together.
struct NamedCampaign {
    designed: DesignStages,
    campaign: Campaign,
    name: String,
    families: Vec<FamilyMember>,
    identity: ProjectIdentity,
    /// The linear worst case, where the whole campaign is reported.
    stability: Option<RobustStability>,
    /// The linear worst case in the other cases and regimes.
    regimes: Vec<RegimeRobustness>,
}

/// Runs the command.
pub fn run(options: &SweepOptions) -> CommandResult {
    let named = prepare(options)?;
    if let Some(index) = options.sample {
        return one_sample(&named, index, &options.factors, &options.results);
    }
    if let Some(shard) = &options.shard {
        let shard = shard_of(shard)?;
        let pace = pace(options, named.campaign.shard(shard.index, shard.count)?.len())?;
        run_shard(&named, &options.output, shard, &pace)?;
        print_cost(options, pace.finish());
        return Ok(ExitStatus::SUCCESS);
    }
    let cost = if options.merge { None } else { run_all(&named, options)? };
    let code = finish(&named, options)?;
    print_cost(options, cost);
    Ok(code)
}

fn pace(options: &SweepOptions, count: usize) -> Result<CampaignPace> {
    if options.results.quiet { Ok(CampaignPace::silent(count)) } else { CampaignPace::with_bar(count) }
}

/// Prints what a large campaign would cost on the error stream, apart from the results.
fn print_cost(options: &SweepOptions, cost: Option<String>) {
    if let Some(cost) = cost.filter(|_| !options.results.quiet) {
        print_message(&cost);
    }
}

fn prepare(options: &SweepOptions) -> Result<NamedCampaign> {
    let loaded = projects::load_project(&options.project, Purpose::Sweep)?;
    output::print_warnings(&loaded, options.results.progress());
    campaign_is_stated(&loaded.project)?;
    let world = ProjectWorld::of(&loaded, options.results.progress());
    let designed = pipeline::run_stages(&loaded.project, &HeaderText, &world)?;
    let campaign =
        pipeline::prepare_campaign(&loaded.project, &designed.modelled, &designed.verified, &world)?;
    let mut named = NamedCampaign {
        name: String::new(),
        families: Vec::new(),
        identity: ProjectIdentity::of(&loaded.project, &loaded.project_folder()),
        stability: None,
        regimes: Vec::new(),
        designed,
        campaign,
    };
    named.name = format!("{} {} {}", env!("CARGO_PKG_VERSION"), named.identity.hash, named.campaign.len());
    if options.shard.is_none() && options.sample.is_none() {
        let (project, designed) = (&loaded.project, &named.designed);
        named.families = pipeline::vary_families(project, &designed.modelled, &designed.verified, &world)?;
        named.stability =
            pipeline::robust_stability(project, &designed.modelled, designed.verified.controller(), &world)?;
        named.regimes =
            other_robust_regimes(project, &designed.modelled, &designed.synthesised, &designed.procedure)?;
    }
    Ok(named)
}

/// One of the parts into which a campaign is divided.
#[derive(Clone, Copy)]
struct Shard {
    index: usize,
    count: usize,
}

fn shard_of(text: &str) -> Result<Shard> {
    let usage = || format!("--shard {text}: write K/N, for example 17/400 (the first is 0)");
    let (k, n) = text.split_once('/').with_context(usage)?;
    let (k, n): (usize, usize) = (k.parse().with_context(usage)?, n.parse().with_context(usage)?);
    match n {
        0 => bail!("--shard {text}: there must be at least 1 shard"),
        _ if k >= n => bail!("--shard {text}: of {n} shards the first is 0 and the last is {}", n - 1),
        _ => Ok(Shard { index: k, count: n }),
    }
}

/// Runs a shard unless its file is there and whole.
fn run_shard(named: &NamedCampaign, folder: &Path, shard: Shard, pace: &CampaignPace) -> Result<()> {
    let range = named.campaign.shard(shard.index, shard.count)?;
    let path = shards::shard_path(folder, shard.index, shard.count);
    if path.exists() {
        let there = shards::read_shard(&path, &named.campaign, &named.name);
        if there.is_ok_and(|samples| samples.iter().map(|sample| sample.index).eq(range.clone())) {
            pace.count_kept(range.len());
            return Ok(());
        }
    }
    let one = |index: usize| {
        let sample = named.campaign.run(index);
        pace.count_run();
        sample
    };
    let samples = try_map(range, one)?;
    shards::write_shard(&path, &named.campaign, &named.name, &samples)
}

/// Runs every shard on all processors; what was done before stays done. Says what a large campaign would cost.
fn run_all(named: &NamedCampaign, options: &SweepOptions) -> Result<Option<String>> {
    let count = named.campaign.len().div_ceil(SHARD);
    let pace = pace(options, named.campaign.len())?;
    let _watch = interrupt::watch_interrupts();
    for index in 0..count {
        if interrupt::is_stop_requested() {
            pace.finish();
            let kept = options.output.display();
            return Err(Interruption(format!(
                "stopped after {index} of {count} shards, which are kept in {kept}; the same command goes on from there"
            ))
            .into());
        }
        run_shard(named, &options.output, Shard { index, count }, &pace)?;
    }
    Ok(pace.finish())
}

/// Merges, writes the samples and the report, and prints the summary.
fn finish(named: &NamedCampaign, options: &SweepOptions) -> CommandResult {
    let mut parts = Vec::new();
    for path in shards::shard_files(&options.output)? {
        parts.push(shards::read_shard(&path, &named.campaign, &named.name)?);
    }
    let samples = merge_shards(&named.campaign, parts).map_err(refuse_shards)?;
    shards::write_shard(&options.output.join("samples.parquet"), &named.campaign, &named.name, &samples)?;
    let others = BesideSamples {
        worst: worst_cases(&named.campaign, &samples, &ProgressPool::new(ProgressDisplay::Quiet))?,
        families: named.families.clone(),
        stability: named.stability.clone(),
        regimes: named.regimes.clone(),
    };
    let found = CampaignResult::new(&named.campaign, &samples, others);
    let nominal = named.designed.verified.verification();
    let project = options.project.display().to_string();
    let subtitle = format!("{} mechanisms that differ from the one that was designed for", samples.len());
    let command = format!("counterpoise sweep {project} -o {}", options.output.display());
    let context = VerificationContext {
        loop_view: None,
        sight_views: Vec::new(),
        title: named.identity.name.clone(),
        subtitle,
        more: Vec::new(),
        provenance: vec![
            ProvenanceEntry::new("campaign (version, project hash, samples)", &named.name),
            ProvenanceEntry::new("command", &command),
        ],
    };
    let page = sweep::campaign_report(nominal, &found, &project, context).with_command(&command);
    output::write_report(&options.output.join("report.html"), &options.results, &page)?;
    let result = SweepOutput {
        samples: found.samples(),
        figures: sweep::sweep_figures(&found),
        robustness: RobustnessResult::list(found.stability.as_ref(), found.own_joints(), &found.regimes),
        mechanisms: options.histories.then(|| (&found).into()),
    };
    if !output::write_result(&options.results, &result)? {
        output::print_lines(&sweep_lines(&found, &result.figures));
        say!("report  {}", options.output.join("report.html").display());
    }
    Ok(verdict_code([found.passing == found.samples()]))
}

/// A campaign, for another program; its samples are in `samples.parquet`.
#[derive(serde::Serialize)]
struct SweepOutput {
    /// Number of mechanisms.
    samples: usize,
    /// The requirements over all mechanisms.
    figures: Vec<SweepFigure>,
    /// How far the ranges may be widened in each case and regime; empty if nothing that enters the linear loop varies.
    robustness: Vec<RobustnessResult>,
    /// The mechanisms; absent unless they were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    mechanisms: Option<MechanismColumns>,
}

fn refuse_shards(problem: ShardsProblem) -> Error {
    match problem {
        ShardsProblem::Missing { count, all, first, last } => anyhow!(
            "{count} of {all} samples are missing, from {first} to {last}: run the shards that hold them, or the same command without --merge and --shard"
        ),
        ShardsProblem::Inconsistent(cause) => Error::new(cause).context(
            "the shards do not make one campaign: remove those of other cuts, or run the missing ones",
        ),
    }
}

/// One sample, for another program.
#[derive(serde::Serialize)]
struct OneSample {
    sample: usize,
    factors: Vec<(&'static str, f64)>,
    figures: Vec<(String, f64)>,
}

fn one_sample(
    named: &NamedCampaign,
    index: usize,
    changed: &[String],
    results: &ResultOutput,
) -> CommandResult {
    if index >= named.campaign.len() {
        bail!("the campaign has {} samples: the last is {}", named.campaign.len(), named.campaign.len() - 1);
    }
    let mut factors = named.campaign.factors(index)?;
    for change in changed {
        changed_factor(&named.campaign, &mut factors, change)?;
    }
    let sample = named.campaign.run_with(index, factors)?;
    let keys = named.campaign.variations().iter().map(|variation| variation.parameter.key());
    let controlled = named.campaign.controlled_quantity();
    let figures =
        named.campaign.requirements().iter().map(|requirement| requirement.figure.key_in(controlled));
    let one = OneSample {
        sample: index,
        factors: keys.zip(sample.factors.iter().copied()).collect(),
        figures: figures.zip(sample.values.iter().copied()).collect(),
    };
    if !output::write_result(results, &one)? {
        one.factors.iter().for_each(|(key, factor)| say!("{key} x {factor:.4}"));
        one.figures.iter().for_each(|(key, value)| say!("{key} = {value:.6}"));
    }
    Ok(verdict_code([named.campaign.passes(&sample)]))
}

/// Sets the factor of a variation from `key=factor`.
fn changed_factor(campaign: &Campaign, factors: &mut [f64], change: &str) -> Result<()> {
    let usage = || {
        format!("--factors {change}: write KEY=FACTOR with a factor of at least 0, for example friction=2")
    };
    let (key, factor) = change.split_once('=').with_context(usage)?;
    let factor: f64 = factor.trim().parse().with_context(usage)?;
    if !(factor >= 0.0 && factor.is_finite()) {
        bail!(usage());
    }
    let keys: Vec<&str> = campaign.variations().iter().map(|variation| variation.parameter.key()).collect();
    let at = keys.iter().position(|one| *one == key.trim());
    let at = at.with_context(|| format!("--factors {change}: what varies here is {}", keys.join(", ")))?;
    factors[at] = factor;
    Ok(())
}
