//! `counterpoise verify`: the verdicts, on the plant and the road that the user asks for, alone or beside another project's.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use clap::{Args, ValueEnum};
use counterpoise_pipeline::results::{AdviceResult, RobustnessResult, TwoAxesResult, VerifyResult};
use counterpoise_pipeline::studies::advice::KeptDesigns;
use counterpoise_pipeline::studies::verification::{
    VerificationOptions, VerificationStudy, VerifiedPlant, drive_over_road,
};
use counterpoise_pipeline::{self as pipeline, TwoAxisStudy, studies};
use counterpoise_project::{Project, Purpose, StructureChoice};
use counterpoise_report::adaptation::{describe_action, describe_refusal, trial_section};
use counterpoise_report::results::VerifyText;
use counterpoise_report::results::verification::VerifiedAxes;
use counterpoise_report::summary::worse_feedforwards;
use counterpoise_report::terminal::changes::change_lines;
use counterpoise_report::terminal::verdicts::verdict_lines;
use counterpoise_report::{
    Report, ReportOrigin, VerificationContext, advice, certificate, difference, error_budget,
    of_verification, robustness, two_axes,
};
use counterpoise_verify::certificate::CaseCertificate;
use counterpoise_verify::difference::FigureChange;
use counterpoise_verify::signals::RoadClass;
use counterpoise_verify::structured::Joints;
use counterpoise_verify::{Road, Triangle};

use crate::exit::{CommandResult, verdict_code};
use crate::options::{ResultOutput, WRITTEN};
use crate::output::{self, say};
use counterpoise_host::projects::{self, ProjectWorld};

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
    /// With --json or --data: also the time histories of every experiment, from which the nonlinear figures can be recomputed (tens of megabytes)
    #[arg(long, requires = WRITTEN)]
    pub histories: bool,
    /// The destination of results.
    #[command(flatten)]
    pub results: ResultOutput,
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

/// Runs the command.
pub fn run(options: &VerifyOptions) -> CommandResult {
    let study = verify_project(options, &options.project)?;
    let before = options.against.as_ref().map(|path| verify_project(options, path)).transpose()?;
    let changed = before.as_ref().map(|before| study.list_changes_from(before));
    if let Some(path) = &options.report {
        output::write_report(path, &options.results, &page(options, &study, changed.as_deref()))?;
    }
    let found = &study.found;
    match &changed {
        Some(changed) => print_changes(options, changed)?,
        None => print_verification(options, &study)?,
    }
    if let (Some(path), None) = (&options.report, &options.results.json) {
        say!("report  {}", path.display());
    }
    let refused = study.adaptation.as_ref().is_some_and(|tried| !tried.refused.is_empty());
    let together = study.two_axes.as_ref().is_none_or(TwoAxisStudy::passes);
    Ok(verdict_code([found.passes(), !refused, together]))
}

/// The verdicts and the linear worst case, for another program.
#[derive(serde::Serialize)]
struct VerifyOutput {
    #[serde(flatten)]
    result: VerifyText,
    /// Stable within so many times the ranges of the sweep; absent if nothing varies.
    #[serde(skip_serializing_if = "Option::is_none")]
    robust_to_times_the_ranges: Option<f64>,
    /// The linear worst case in each case and regime of friction, the design's own sliding first; empty if nothing varies.
    robustness: Vec<RobustnessResult>,
    /// The changes that meet a requirement that fails.
    advice: Vec<AdviceResult>,
}

fn print_verification(options: &VerifyOptions, study: &VerificationStudy) -> Result<()> {
    let (found, stability) = (&study.found, study.stability.as_ref());
    let mut result = VerifyResult::new(found, study.measured_on.clone());
    result.studies.error_budget = study.budget.clone();
    result.studies.certificate = study.certificate.as_ref().map(Into::into);
    let both = study.two_axes.as_ref().map(TwoAxesResult::from);
    let mut result = result.with_adaptation(study.adaptation.clone()).with_two_axes(both);
    if !options.histories {
        result.leave_histories_out();
    }
    let axes = VerifiedAxes { own: found, both: study.two_axes.as_ref() };
    let result = VerifyText::new(axes, result);
    let robust_to_times_the_ranges = stability.map(|found| found.guaranteed);
    let design = study.certificate.as_ref().and_then(|found| found.cases.first());
    let joints = design.map_or(Joints::Sliding, CaseCertificate::first_joints);
    let robustness = RobustnessResult::list(stability, joints, &study.regimes);
    let advised = study.advice.iter().map(Into::into).collect();
    let shown = VerifyOutput { result, robust_to_times_the_ranges, robustness, advice: advised };
    if !output::write_result(&options.results, &shown)? {
        output::print_lines(&verdict_lines(found));
        let both = study.two_axes.iter().flat_map(two_axes::two_axes_lines);
        both.for_each(|line| say!("two axes: {line}"));
        error_budget::budget_lines(found).iter().for_each(|line| say!("line of sight: {line}"));
        advice::advice_lines(&study.advice).iter().for_each(|line| say!("advice: {line}"));
        worse_feedforwards(&study.found).iter().for_each(|line| say!("note: {line}"));
        let certified = study.certificate.iter().flat_map(certificate::certificate_lines);
        certified.for_each(|line| say!("stability: {line}"));
        let heading = certificate::worst_case_heading(joints);
        let robust = stability.into_iter().flat_map(robustness::robustness_lines);
        robust.for_each(|line| say!("{heading}: {line}"));
        certificate::robustness_lines(&study.regimes).iter().for_each(|line| say!("linear: {line}"));
        let action = study.adaptation.iter().filter_map(describe_action);
        action.for_each(|action| say!("adaptation: {action}"));
        let refused = study.adaptation.iter().flat_map(|tried| &tried.refused);
        refused.for_each(|why| say!("adaptation: {}", describe_refusal(why)));
    }
    Ok(())
}

/// Verifies the project at a path as the options ask.
fn verify_project(options: &VerifyOptions, path: &Path) -> Result<VerificationStudy> {
    let loaded = projects::load_project(path, Purpose::Verify)?;
    output::print_warnings(&loaded, options.results.progress());
    let world = ProjectWorld::of(&loaded, options.results.progress());
    let project = &loaded.project;
    let asked = verification_options(options, project)?;
    Ok(studies::verification::verify_project(project, &asked, &world)?)
}

fn verification_options(options: &VerifyOptions, project: &Project) -> Result<VerificationOptions> {
    let plant = match options.plant {
        PlantChoice::Project => VerifiedPlant::Project,
        PlantChoice::Linear => VerifiedPlant::Linear,
        PlantChoice::Lumped => VerifiedPlant::Structure(StructureChoice::Lumped),
        PlantChoice::Fe => VerifiedPlant::Structure(
            pipeline::finite_elements_of(project)
                .context("--plant fe: the project has neither [plant.beam] nor [plant.import]")?,
        ),
    };
    let road = options.road.as_ref().map(|class| drive(project, class, options.speed)).transpose()?;
    let triangle = options.triangle.as_ref().map(|text| triangle(text)).transpose()?;
    let kept = if options.histories { KeptDesigns::Histories } else { KeptDesigns::Systems };
    Ok(VerificationOptions { plant, road, triangle, kept })
}

fn drive(project: &Project, class: &str, speed_m_s: f64) -> Result<Road> {
    let class = RoadClass::from_letter(class).with_context(|| {
        format!("--road {class}: the classes of ISO 8608 here are A (very good) to E (very poor)")
    })?;
    drive_over_road(project, class, speed_m_s).with_context(|| format!("--speed {speed_m_s}"))
}

/// Returns a triangle from `RATE/PERIOD`.
fn triangle(text: &str) -> Result<Triangle> {
    let usage = || format!("--triangle {text}: write RATE/PERIOD in rad/s and s, for example 0.1/4");
    let (rate, period) = text.split_once('/').with_context(usage)?;
    let number =
        |word: &str| word.trim().parse::<f64>().ok().filter(|value| *value > 0.0 && value.is_finite());
    let (rate_rad_s, period_s) = number(rate).zip(number(period)).with_context(usage)?;
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

fn page(options: &VerifyOptions, study: &VerificationStudy, changed: Option<&[FigureChange]>) -> Report {
    let origin = ReportOrigin { project: String::new(), command: command(options) };
    let advised = advice::advice_section(&study.advice);
    let certified =
        study.certificate.iter().map(|found| certificate::certificate_section(found, &study.regimes));
    let context = VerificationContext {
        title: study.identity.name.clone(),
        subtitle: "Verification of the controller as it is exported".to_owned(),
        loop_view: Some(study.loop_view.clone()),
        sight_views: study.sight_views.clone(),
        more: advised
            .into_iter()
            .chain(certified)
            .chain(study.stability.as_ref().map(robustness::robustness_section))
            .chain(study.adaptation.as_ref().map(trial_section))
            .chain(study.two_axes.as_ref().map(two_axes::two_axes_section))
            .collect(),
        provenance: origin.provenance(&study.identity),
    };
    let mut report = of_verification(&study.found, &study.on_road, context);
    if let (Some(changed), Some(path)) = (changed, &options.against) {
        let before = path.display().to_string();
        let difference = difference::summarise_changes(&before, changed);
        report.headline.detail = format!("{} {difference}", report.headline.detail).trim().to_owned();
        report.sections.insert(0, difference::changes_section(&before, changed));
    }
    report.with_command(&origin.command)
}

/// A figure before and after, for another program.
#[derive(serde::Serialize)]
struct Row {
    figure: String,
    unit: &'static str,
    before: Option<f64>,
    after: Option<f64>,
    held: Option<bool>,
    holds: Option<bool>,
}

fn print_changes(options: &VerifyOptions, changed: &[FigureChange]) -> Result<()> {
    let row = |change: &FigureChange| Row {
        figure: change.figure.key_in(change.controlled),
        unit: change.unit(),
        before: change.before,
        after: change.after,
        held: change.held,
        holds: change.holds,
    };
    let rows: Vec<Row> = changed.iter().map(row).collect();
    if output::write_list(&options.results, "changes", &rows)? {
        return Ok(());
    }
    output::print_lines(&change_lines(changed));
    Ok(())
}
