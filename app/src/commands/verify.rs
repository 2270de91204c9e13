//! `counterpoise verify`: the verdicts, on the plant and the road that the user asks for, alone or beside another project's.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use clap::{Args, ValueEnum};
use counterpoise_pipeline::results::VerifyResult;
use counterpoise_pipeline::{self as pipeline, export::project_hash};
use counterpoise_project::{Project, Purpose, StructureChoice};
use counterpoise_report::{Context, difference, html, of_verification, robust};
use counterpoise_verify::difference::{Change, changes};
use counterpoise_verify::signals::iso_road::{Drive, RoadClass, Vehicle, iso_road};
use counterpoise_verify::structured::RobustStability;
use counterpoise_verify::{Procedure, Triangle, Verification};

use super::design::print_verdicts;
use super::{Done, pages, verdict_code};
use crate::arguments::Results;
use crate::output::{self, say};
use counterpoise_host::projects::{self, Loaded, Surroundings};

/// Arguments of `verify`.
#[derive(Args)]
pub struct VerifyOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// The plant that the controller is verified on; the controller stays the project's
    #[arg(long, value_enum, default_value = "project")]
    pub plant: PlantChoice,
    /// Drive over a road of this ISO 8608 class (A to E) instead of the project's recording
    #[arg(long, value_name = "CLASS")]
    pub road: Option<String>,
    /// Speed on that road, m/s
    #[arg(long, value_name = "M_S", default_value_t = 8.0, requires = "road")]
    pub speed: f64,
    /// Also run a triangle of the demanded hub rate: peak in rad/s and period in s, for example 0.1/4
    #[arg(long, value_name = "RATE/PERIOD")]
    pub triangle: Option<String>,
    /// Print what changed from this project (or folder) to PROJECT
    #[arg(long, value_name = "BEFORE")]
    pub against: Option<PathBuf>,
    /// Write a report with pictures to this HTML file
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Where results go.
    #[command(flatten)]
    pub results: Results,
}

/// On what a controller is verified.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PlantChoice {
    /// As the project's [model] says: nonlinear and linear
    Project,
    /// The linear plant alone: margins, linear step and disturbances, rejection ratios
    Linear,
    /// The two lumped inertias, nonlinear and linear
    Lumped,
    /// The finite elements' modes, nonlinear and linear
    Fe,
}

/// Length of a synthetic drive, s, the period of its samples, s, and the time in which it fades in and out, s.
const DRIVE_S: (f64, f64, f64) = (30.0, 0.005, 1.0);

/// Runs the command.
pub fn run(options: &VerifyOptions) -> Done {
    let (loaded, found, stability) = verified(options, &options.project)?;
    let before = options.against.as_ref().map(|path| verified(options, path)).transpose()?;
    let changed = before.as_ref().map(|(_, before, _)| changes(before, &found));
    if let Some(path) = &options.report {
        projects::write(
            path,
            page(options, (&loaded, &found, stability.as_ref()), changed.as_deref()).as_bytes(),
        )?;
    }
    match &changed {
        Some(changed) => tell_changes(options, changed)?,
        None => tell(options, &found, stability.as_ref())?,
    }
    if let (Some(path), None) = (&options.report, &options.results.json) {
        say!("report  {}", path.display());
    }
    Ok(verdict_code(found.passes()))
}

/// The verdicts and the linear worst case, for a machine.
#[derive(serde::Serialize)]
struct Told {
    #[serde(flatten)]
    result: VerifyResult,
    /// Stable within so many times the ranges of the sweep; absent where nothing varies.
    #[serde(skip_serializing_if = "Option::is_none")]
    robust_to_times_the_ranges: Option<f64>,
}

fn tell(options: &VerifyOptions, found: &Verification, stability: Option<&RobustStability>) -> Result<()> {
    let robust_to_times_the_ranges = stability.map(|found| found.guaranteed);
    let told = Told { result: VerifyResult::from(found), robust_to_times_the_ranges };
    if !output::json(&options.results, &told)? {
        print_verdicts(found);
        stability.into_iter().flat_map(robust::lines).for_each(|line| say!("linear: {line}"));
    }
    Ok(())
}

/// A project's controller, verified as the options ask, and the linear worst case of its sweep's ranges.
fn verified(options: &VerifyOptions, path: &Path) -> Result<(Loaded, Verification, Option<RobustStability>)> {
    let loaded = projects::load(path, Purpose::Verify)?;
    output::warnings(&loaded, options.results.quiet);
    let world = Surroundings::of(&loaded, options.results.quiet);
    let project = &loaded.project;
    let modelled = pipeline::model(project)?;
    let made = pipeline::synthesise(project, &modelled, &pipeline::reduce(project, &modelled)?)?;
    let mut procedure = pipeline::procedure(project, &world)?;
    if let Some(class) = &options.road {
        procedure.road = Some(drive(class, options.speed, &procedure)?);
    }
    if let Some(text) = &options.triangle {
        procedure.triangle = Some(triangle(text)?);
    }
    let structure = match options.plant {
        PlantChoice::Lumped => StructureChoice::Lumped,
        PlantChoice::Fe => pipeline::finite_elements_of(project)
            .context("--plant fe: the project has neither [plant.beam] nor [plant.import]")?,
        PlantChoice::Project | PlantChoice::Linear => project.model.structure,
    };
    let plant = pipeline::model(&with_structure(project, structure))?.plant;
    let found = match options.plant {
        PlantChoice::Linear => pipeline::verify_linear_on(project, &plant, &made, &procedure)?,
        _ => pipeline::verify_on(project, &plant, &made, &procedure)?.into_parts().1,
    };
    let controller = &made.sampled.controller;
    let stability = pipeline::robust_stability(&loaded.project, &modelled, controller, &world)?;
    Ok((loaded, found, stability))
}

fn with_structure(project: &Project, structure: StructureChoice) -> Project {
    let mut other = project.clone();
    other.model.structure = structure;
    other
}

fn drive(class: &str, speed_m_s: f64, procedure: &Procedure) -> Result<counterpoise_verify::Road> {
    let class = RoadClass::from_letter(class).with_context(|| {
        format!("--road {class}: the classes of ISO 8608 here are A (very good) to E (very poor)")
    })?;
    let (duration_s, sample_period_s, fade_s) = DRIVE_S;
    let drive = Drive { class, speed_m_s, duration_s, sample_period_s, fade_s, seed: procedure.seed };
    iso_road(drive, Vehicle::HEAVY).with_context(|| format!("--speed {speed_m_s}"))
}

/// A triangle from `RATE/PERIOD`.
fn triangle(text: &str) -> Result<Triangle> {
    let told = || format!("--triangle {text}: write RATE/PERIOD in rad/s and s, for example 0.1/4");
    let (rate, period) = text.split_once('/').with_context(told)?;
    let number =
        |word: &str| word.trim().parse::<f64>().ok().filter(|value| *value > 0.0 && value.is_finite());
    let (rate_rad_s, period_s) = number(rate).zip(number(period)).with_context(told)?;
    Ok(Triangle { rate_rad_s, period_s })
}

fn command(options: &VerifyOptions) -> String {
    let mut words = format!("counterpoise verify {}", options.project.display());
    if let Some(value) = options.plant.to_possible_value().filter(|_| options.plant != PlantChoice::Project) {
        words += &format!(" --plant {}", value.get_name());
    }
    if let Some(class) = &options.road {
        words += &format!(" --road {class} --speed {}", options.speed);
    }
    if let Some(text) = &options.triangle {
        words += &format!(" --triangle {text}");
    }
    if let Some(path) = &options.against {
        words += &format!(" --against {}", path.display());
    }
    words
}

fn page(
    options: &VerifyOptions,
    (loaded, found, stability): (&Loaded, &Verification, Option<&RobustStability>),
    changed: Option<&[Change]>,
) -> String {
    let command = command(options);
    let context = Context {
        title: loaded.project.plant.name.clone(),
        subtitle: "Verification of the controller as it is exported".to_owned(),
        more: stability.map(robust::section).into_iter().collect(),
        provenance: vec![
            ("version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
            ("project hash".to_owned(), project_hash(&loaded.project)),
            ("command".to_owned(), command.clone()),
        ],
    };
    let mut report = of_verification(found, context);
    if let (Some(changed), Some(path)) = (changed, &options.against) {
        let before = path.display().to_string();
        let told = difference::headline(&before, changed);
        report.headline.detail = format!("{} {told}", report.headline.detail).trim().to_owned();
        report.sections.insert(0, difference::section(&before, changed));
    }
    pages::reproduced_by(&mut report, &command);
    html(&report)
}

/// A figure before and after, for a machine.
#[derive(serde::Serialize)]
struct Row {
    figure: String,
    unit: &'static str,
    before: Option<f64>,
    after: Option<f64>,
    held: Option<bool>,
    holds: Option<bool>,
}

fn tell_changes(options: &VerifyOptions, changed: &[Change]) -> Result<()> {
    let row = |change: &Change| Row {
        figure: change.figure.key(),
        unit: change.figure.unit(),
        before: change.before,
        after: change.after,
        held: change.held,
        holds: change.holds,
    };
    let rows: Vec<Row> = changed.iter().map(row).collect();
    if output::json(&options.results, &rows)? {
        return Ok(());
    }
    let judged = changed.iter().filter(|change| change.holds.is_some() || change.held.is_some());
    let shown: Vec<&Change> = judged.collect();
    for change in &shown {
        let text = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), output::figure);
        say!(
            "  {:15} {}: {} -> {} {} ({})",
            difference::verdict(change).1,
            change.figure.name(),
            text(change.before),
            text(change.after),
            change.figure.unit(),
            difference::size(change)
        );
    }
    let others = changed.iter().filter(|change| difference::moved(change)).count();
    let turned = changed.iter().filter(|change| change.turned()).count();
    let word = if turned == 1 { "verdict" } else { "verdicts" };
    say!("{turned} {word} turned; {others} of {} figures changed (--report shows all)", changed.len());
    Ok(())
}
