//! `counterpoise claims`: the thesis' claims on a project's mechanism.

use crate::output::say;
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use counterpoise::report::{Context, claims as page, evidence, html};
use counterpoise_project::claims::{Claim, Finding, claims};
use counterpoise_project::{Purpose, pipeline};
use indicatif::{ProgressBar, ProgressStyle};

use super::{Done, pages, verdict_code};
use crate::arguments::Results;
use crate::files::{self, Surroundings};
use crate::output;

/// Arguments of `claims`.
#[derive(Args)]
pub struct ClaimsOptions {
    /// Project file, or a folder with a project.toml
    #[arg(default_value = "examples/reference-rig")]
    pub project: PathBuf,
    /// Write the table as a page to this HTML file
    #[arg(long, value_name = "FILE", default_value = "out/claims.html")]
    pub report: PathBuf,
    /// Where results go.
    #[command(flatten)]
    pub results: Results,
}

/// A row, for a machine.
#[derive(serde::Serialize)]
struct Row<'a> {
    id: &'a str,
    source: &'a str,
    says: &'a str,
    measured: &'a str,
    finding: &'static str,
    why: &'a str,
}

/// Runs the command.
pub fn run(options: &ClaimsOptions) -> Done {
    let loaded = files::load(&options.project, Purpose::Design)?;
    let world = Surroundings::of(&loaded, true);
    let bar = if options.results.quiet { ProgressBar::hidden() } else { ProgressBar::new(1) };
    bar.set_style(ProgressStyle::with_template("{bar:30} {pos}/{len} claims, {elapsed}")?);
    bar.enable_steady_tick(Duration::from_millis(200));
    let progress = |done: usize, of: usize| {
        bar.set_length(of as u64);
        bar.set_position(done as u64);
    };
    let rows = claims(&loaded.project, &world, &progress)?;
    bar.finish_and_clear();
    let title = format!("The thesis' claims on the {}", loaded.project.plant.name);
    let designed = pipeline::design(&loaded.project, &world)?;
    let command = format!("counterpoise claims {}", options.project.display());
    let context = Context {
        title,
        subtitle: "measured, nothing tuned for a row; the figures are those of the design that the rows put to the test"
            .to_owned(),
        more: evidence::sections(designed.verified.verification()),
        provenance: vec![("command".to_owned(), command.clone())],
    };
    let mut report = page::report(&rows, context);
    pages::reproduced_by(&mut report, &command);
    files::write(&options.report, html(&report).as_bytes())?;
    let table: Vec<Row<'_>> = rows.iter().map(row).collect();
    if !output::json(&options.results, &table)? {
        table.iter().for_each(print);
        say!("report  {}", options.report.display());
    }
    Ok(verdict_code(rows.iter().all(|claim| claim.finding != Finding::Fails)))
}

fn row(claim: &Claim) -> Row<'_> {
    let (finding, why) = match &claim.finding {
        Finding::Holds => ("holds", ""),
        Finding::Fails => ("fails", ""),
        Finding::Differs { why } => ("differs", why.as_str()),
        Finding::NotMeasured { why } => ("not measured", *why),
    };
    Row { id: claim.id, source: claim.source, says: claim.says, measured: &claim.measured, finding, why }
}

fn print(row: &Row<'_>) {
    say!("{:4} {:13} {}", row.id, row.finding, row.says);
    [row.measured, row.why].iter().filter(|text| !text.is_empty()).for_each(|text| say!("     {text}"));
}
