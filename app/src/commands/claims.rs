//! `counterpoise claims`: the thesis' claims on a project's mechanism.

use crate::output::say;
use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Result, bail};
use clap::Args;
use counterpoise_claims::page;
use counterpoise_claims::{Claim, Finding, claims, ids};
use counterpoise_pipeline as pipeline;
use counterpoise_pipeline::export::project_hash;
use counterpoise_project::Purpose;
use counterpoise_report::{Context, evidence, html};
use indicatif::{ProgressBar, ProgressStyle};

use super::{Done, verdict_code};
use crate::arguments::Results;
use crate::output;
use counterpoise_host::projects::{self, Surroundings};

/// Arguments of `claims`.
#[derive(Args)]
pub struct ClaimsOptions {
    /// Project file, or a folder with a project.toml
    #[arg(default_value = "examples/reference-rig")]
    pub project: PathBuf,
    /// Measure only these rows, for example C6,C24
    #[arg(long, value_name = "ID,...", value_delimiter = ',')]
    pub only: Vec<String>,
    /// Write table and figures as a page to this HTML file [default: out/claims.html, or out/claims-ID-....html with --only]
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Where results go.
    #[command(flatten)]
    pub results: Results,
}

/// A row, for a machine.
#[derive(serde::Serialize)]
struct Row<'a> {
    id: &'a str,
    title: &'a str,
    source: &'a str,
    says: &'a str,
    measured: &'a str,
    finding: &'static str,
    why: &'a str,
}

/// Runs the command.
pub fn run(options: &ClaimsOptions) -> Done {
    let wanted = wanted(&options.only)?;
    let loaded = projects::load(&options.project, Purpose::Design)?;
    let world = Surroundings::of(&loaded, true);
    let bar = if options.results.quiet { ProgressBar::hidden() } else { ProgressBar::new(1) };
    bar.set_style(ProgressStyle::with_template("{bar:30} {pos}/{len} claims, {elapsed}")?);
    bar.enable_steady_tick(Duration::from_millis(200));
    let progress = |done: usize, of: usize| {
        bar.set_length(of as u64);
        bar.set_position(done as u64);
    };
    let rows = claims(&loaded.project, &world, &|id| wanted.contains(&id), &progress)?;
    bar.finish_and_clear();
    let title = format!("The thesis' claims on the {}", loaded.project.plant.name);
    let designed = pipeline::design(&loaded.project, &world)?;
    let command = format!("counterpoise claims {}", options.project.display());
    let mut more = if options.only.is_empty() {
        evidence::sections(designed.verified.verification())
    } else {
        Vec::new()
    };
    let verified = format!("counterpoise verify {}", options.project.display());
    more.iter_mut()
        .flat_map(|section| &mut section.figures)
        .for_each(|figure| figure.command.clone_from(&verified));
    let context = Context {
        title,
        subtitle: "measured, nothing tuned for a row; after the rows, the evidence of the design that they put to the test".to_owned(),
        more,
        provenance: vec![
            ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
            ("project hash".to_owned(), project_hash(&loaded.project)),
            ("command".to_owned(), command.clone()),
        ],
    };
    let report = page::report(&rows, context, &|id| format!("{command} --only {id}"));
    let path = options.report.clone().unwrap_or_else(|| page_of(&options.only));
    projects::write(&path, html(&report).as_bytes())?;
    let table: Vec<Row<'_>> = rows.iter().map(row).collect();
    if !output::json(&options.results, &table)? {
        table.iter().for_each(print);
        say!("report  {}", path.display());
    }
    Ok(verdict_code(rows.iter().all(|claim| claim.finding != Finding::Fails)))
}

/// Where the page goes where nobody says: rows alone do not take the place of the whole table.
fn page_of(only: &[String]) -> PathBuf {
    let name: String = only.iter().map(|id| format!("-{}", id.trim().to_uppercase())).collect();
    PathBuf::from(format!("out/claims{name}.html"))
}

/// The rows that are asked for; all where none is named.
fn wanted(only: &[String]) -> Result<Vec<&'static str>> {
    let all: Vec<&'static str> = ids().collect();
    if only.is_empty() {
        return Ok(all);
    }
    for name in only {
        if !all.iter().any(|id| id.eq_ignore_ascii_case(name.trim())) {
            bail!("--only {name}: the rows are C1 to C27 and F1 to F4");
        }
    }
    Ok(all.into_iter().filter(|id| only.iter().any(|name| id.eq_ignore_ascii_case(name.trim()))).collect())
}

fn row(claim: &Claim) -> Row<'_> {
    let (finding, why) = match &claim.finding {
        Finding::Holds => ("holds", ""),
        Finding::Fails => ("fails", ""),
        Finding::Differs { why } => ("differs", why.as_str()),
        Finding::NotMeasured { why } => ("not measured", *why),
    };
    Row {
        id: claim.id,
        title: claim.title,
        source: claim.source,
        says: claim.says,
        measured: &claim.measured,
        finding,
        why,
    }
}

fn print(row: &Row<'_>) {
    say!("{:4} {:13} {}: {}", row.id, row.finding, row.title, row.says);
    [row.measured, row.why].iter().filter(|text| !text.is_empty()).for_each(|text| say!("     {text}"));
}
