//! `counterpoise claims`: the thesis' claims on a project's mechanism.

use crate::output::say;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Result, bail};
use clap::Args;
use counterpoise_claims::page;
use counterpoise_claims::{Agreement, Claim, ClaimOutcome, Criterion, claim_ids, measure_claims};
use counterpoise_pipeline::{ProjectIdentity, run_stages};
use counterpoise_project::Purpose;
use counterpoise_report::wording::code_header::HeaderText;
use counterpoise_report::wording::figures::format_figure;
use counterpoise_report::{ReportOrigin, VerificationContext, evidence};
use indicatif::{ProgressBar, ProgressStyle};

use crate::examples::write_example;
use crate::exit::{CommandResult, verdict_code};
use crate::options::ResultOutput;
use crate::output;
use counterpoise_host::files::scratch_folder;
use counterpoise_host::projects::{self, ProjectWorld};
use counterpoise_host::stages::ProgressDisplay;

/// Arguments of `claims`.
#[derive(Args)]
pub struct ClaimsOptions {
    /// Project file, or a folder with a project.toml [default: examples/reference-rig, which the program carries]
    pub project: Option<PathBuf>,
    /// Measure only these rows, for example C6,C24
    #[arg(long, value_name = "ID,...", value_delimiter = ',')]
    pub only: Vec<String>,
    /// Write table and figures as a page to this HTML file [default: out/claims.html, or out/claims-ID-....html with --only]
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// The destination of results.
    #[command(flatten)]
    pub results: ResultOutput,
}

/// A row, for another program.
#[derive(serde::Serialize)]
struct Row<'a> {
    id: &'a str,
    title: &'a str,
    source: &'a str,
    says: &'a str,
    measured: &'a str,
    finding: &'static str,
    why: &'a str,
    criteria: Vec<CriterionRow<'a>>,
}

/// A criterion of a row, for another program.
#[derive(serde::Serialize)]
struct CriterionRow<'a> {
    what: &'a str,
    thesis: &'a str,
    measured: f64,
    /// Least and largest value that agree; `null` for no bound.
    accepted: [Option<f64>; 2],
    /// Least and largest value that the explanation predicts.
    explained: Option<[f64; 2]>,
    reason: &'a str,
    agreement: &'static str,
}

/// Runs the command.
pub fn run(options: &ClaimsOptions) -> CommandResult {
    let wanted = select_claims(&options.only)?;
    let scratch = scratch_folder()?;
    let project = project_of(options, scratch.path())?;
    let loaded = projects::load_project(&project, Purpose::Design)?;
    let world = ProjectWorld::of(&loaded, ProgressDisplay::Quiet);
    let bar = if options.results.quiet { ProgressBar::hidden() } else { ProgressBar::new(1) };
    bar.set_style(ProgressStyle::with_template("{bar:30} {pos}/{len} claims, {elapsed}")?);
    bar.enable_steady_tick(Duration::from_millis(200));
    let progress = |done: usize, of: usize| {
        bar.set_length(of as u64);
        bar.set_position(done as u64);
    };
    let rows = measure_claims(&loaded.project, &world, &|id| wanted.contains(&id), &progress)?;
    bar.finish_and_clear();
    let title = format!("The thesis' claims on the {}", loaded.project.plant.name);
    let designed = run_stages(&loaded.project, &HeaderText, &world)?;
    let named = options.project.as_deref().unwrap_or(Path::new(RIG));
    let command = format!("counterpoise claims {}", named.display());
    let mut more = if options.only.is_empty() {
        evidence::evidence_sections(designed.verified.verification())
    } else {
        Vec::new()
    };
    let verified = format!("counterpoise verify {}", named.display());
    more.iter_mut()
        .flat_map(|section| &mut section.figures)
        .for_each(|figure| figure.command.clone_from(&verified));
    let origin = ReportOrigin { project: String::new(), command: command.clone() };
    let context = VerificationContext {
        loop_view: None,
        sight_views: Vec::new(),
        title,
        subtitle: "measured, nothing tuned for a row; after the rows, the evidence of the design that they put to the test".to_owned(),
        more,
        provenance: origin.provenance(&ProjectIdentity::of(&loaded.project, &loaded.project_folder())),
    };
    let report = page::claims_report(&rows, context, &|id| format!("{command} --only {id}"));
    let path = options.report.clone().unwrap_or_else(|| page_of(&options.only));
    output::write_report(&path, &options.results, &report)?;
    let table: Vec<Row<'_>> = rows.iter().map(row).collect();
    if !output::write_list(&options.results, "claims", &table)? {
        table.iter().for_each(print);
        say!("report  {}", path.display());
    }
    Ok(verdict_code(rows.iter().map(|claim| claim.finding() != ClaimOutcome::Fails)))
}

/// Project on which the claims are measured if the command names none.
const RIG: &str = "examples/reference-rig";

/// Returns the project that was asked for; otherwise the reference rig, which is written into a scratch folder if it is not there.
fn project_of(options: &ClaimsOptions, scratch: &Path) -> Result<PathBuf> {
    if let Some(project) = &options.project {
        return Ok(project.clone());
    }
    let there = PathBuf::from(RIG);
    if there.exists() {
        return Ok(there);
    }
    let folder = scratch.join("reference-rig");
    write_example("reference-rig", &folder)?;
    Ok(folder)
}

/// Returns the file of the page if the command names none. A page of selected rows has a name of its own and does not replace the whole table.
fn page_of(only: &[String]) -> PathBuf {
    let name: String = only.iter().map(|id| format!("-{}", id.trim().to_uppercase())).collect();
    PathBuf::from(format!("out/claims{name}.html"))
}

/// Returns the names of the claims that are asked for, or of all claims if none is named.
fn select_claims(only: &[String]) -> Result<Vec<&'static str>> {
    let all: Vec<&'static str> = claim_ids().collect();
    if only.is_empty() {
        return Ok(all);
    }
    for name in only {
        if !all.iter().any(|id| id.eq_ignore_ascii_case(name.trim())) {
            bail!("--only {name}: the rows are C1 to C34 and F1 to F4");
        }
    }
    Ok(all.into_iter().filter(|id| only.iter().any(|name| id.eq_ignore_ascii_case(name.trim()))).collect())
}

fn row(claim: &Claim) -> Row<'_> {
    let (finding, why) = match claim.finding() {
        ClaimOutcome::Holds => ("holds", ""),
        ClaimOutcome::Fails => ("fails", claim.why.as_str()),
        ClaimOutcome::Differs { .. } => ("differs", claim.why.as_str()),
        ClaimOutcome::NotMeasured { .. } => ("not measured", claim.why.as_str()),
    };
    Row {
        id: claim.id,
        title: claim.title,
        source: claim.source,
        says: claim.says,
        measured: &claim.measured,
        finding,
        why,
        criteria: claim.criteria.iter().map(criterion).collect(),
    }
}

fn criterion(one: &Criterion) -> CriterionRow<'_> {
    let bound = |value: f64| value.is_finite().then_some(value);
    CriterionRow {
        what: &one.what,
        thesis: &one.thesis,
        measured: one.measured,
        accepted: [bound(one.accepted.0), bound(one.accepted.1)],
        explained: one.explained.map(|(low, high)| [low, high]),
        reason: &one.reason,
        agreement: match one.agreement() {
            Agreement::Agrees => "agrees",
            Agreement::Explained => "explained",
            Agreement::Disagrees => "disagrees",
        },
    }
}

fn print(row: &Row<'_>) {
    say!("{:4} {:13} {}: {}", row.id, row.finding, row.title, row.says);
    [row.measured, row.why].iter().filter(|text| !text.is_empty()).for_each(|text| say!("     {text}"));
    for one in row.criteria.iter().filter(|one| one.agreement != "agrees") {
        say!("     {}: {} {} (thesis: {})", one.agreement, one.what, format_figure(one.measured), one.thesis);
    }
}
