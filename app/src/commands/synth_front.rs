//! `counterpoise synth --search`: the front of a project's designs, and the choice of one of them.

use std::path::Path;

use anyhow::{Context as _, Result, bail};
use clap::Args;
use counterpoise_host::projects::{self, ProjectOnDisk, ProjectWorld};
use counterpoise_pipeline::first_design::with_chosen_weights_on;
use counterpoise_pipeline::studies::front::{self, ProjectFront, project_front, project_with_point};
use counterpoise_pipeline::{World as _, build_plant_model, reduce_plant, synthesise, verify};
use counterpoise_project::resolve::front::{FrontOptions, read_objectives};
use counterpoise_project::{Project, Purpose};
use counterpoise_report::front::front_report;
use counterpoise_report::results::FrontText;
use counterpoise_report::results::front::VerdictSummary;
use counterpoise_report::terminal::front::front_lines;
use counterpoise_synth::LoopLimits;

use super::synth_outputs::{report_origin, save_project};
use crate::exit::{CommandResult, ExitStatus, verdict_code};
use crate::options::CommandOutputs;
use crate::output::{self, say};

/// What a front trades and how, over what the project file says.
#[derive(Args, Default)]
pub struct FrontArguments {
    /// Trade these figures of the loop (residual, effort, noise-gain, max-sensitivity, max-complementary, control-peak, gain-margin, phase-margin, delay-margin)
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', requires = "search")]
    pub objectives: Vec<String>,
    /// Keep a limit in every design, for example max-sensitivity=1.4 or gain-margin=12; the names are those of the objectives but the residual, and decay and damping. May be repeated
    #[arg(long, value_name = "NAME=VALUE", requires = "search")]
    pub limit: Vec<String>,
    /// Evaluate about this many feedbacks for each kind of design
    #[arg(long, value_name = "NUMBER", requires = "search", value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    pub evaluations: Option<u32>,
    /// Choose the design of this number from the front, verify it, and write it with --save
    #[arg(long, value_name = "NUMBER", requires = "search")]
    pub choose: Option<usize>,
}

impl FrontArguments {
    fn are_given(&self) -> bool {
        !self.objectives.is_empty()
            || !self.limit.is_empty()
            || self.evaluations.is_some()
            || self.choose.is_some()
    }
}

/// What a front is asked of, and where it goes.
pub struct FrontRequest<'a> {
    /// Project file, or its folder.
    pub project: &'a Path,
    /// What is traded and how.
    pub arguments: &'a FrontArguments,
    /// File of the project with the design that is chosen.
    pub save: Option<&'a Path>,
    /// The destinations of report and results.
    pub outputs: &'a CommandOutputs,
}

/// A project whose front is asked for.
pub struct AskedFront {
    loaded: ProjectOnDisk,
    options: FrontOptions,
}

/// Returns the front that is asked for; `None` if the file states requirements of a search for weights and no front is named.
///
/// # Errors
/// A project file or an argument that cannot be used.
pub fn asked_front(request: &FrontRequest<'_>) -> Result<Option<AskedFront>> {
    let loaded = projects::load_project(request.project, Purpose::Front)?;
    let (stated, asked) = (front::asked_front(&loaded.project), request.arguments);
    if stated.is_none() && !asked.are_given() {
        return Ok(None);
    }
    let mut front = stated.unwrap_or_default();
    if !asked.objectives.is_empty() {
        let names: Vec<String> = asked.objectives.iter().map(|name| name.trim().to_owned()).collect();
        front.objectives = read_objectives(&names).map_err(|problem| {
            let hint = problem.hint.map_or(String::new(), |hint| format!("; {hint}"));
            anyhow::anyhow!("--objectives {}: it {}{hint}", asked.objectives.join(","), problem.allowed)
        })?;
    }
    for text in &asked.limit {
        set_limit(&mut front.limits, text)?;
    }
    if let Some(evaluations) = asked.evaluations {
        front.evaluations = evaluations as usize;
    }
    if request.save.is_some() && asked.choose.is_none() {
        bail!(
            "--save writes the design that --choose NUMBER names: look at the front without --save, and repeat the command with both"
        );
    }
    Ok(Some(AskedFront { loaded, options: front }))
}

/// Names of the limits.
const LIMIT_NAMES: [&str; 10] = [
    "max-sensitivity",
    "max-complementary",
    "noise-gain",
    "control-peak",
    "effort",
    "gain-margin",
    "phase-margin",
    "delay-margin",
    "decay",
    "damping",
];

/// Reads NAME=VALUE.
fn set_limit(limits: &mut LoopLimits, text: &str) -> Result<()> {
    let usage =
        || format!("--limit {text}: write NAME=VALUE with one of the names {}", LIMIT_NAMES.join(", "));
    let (name, value) = text.split_once('=').with_context(usage)?;
    let name = name.trim();
    LIMIT_NAMES.iter().find(|known| **known == name).with_context(usage)?;
    let above = if name.starts_with("max-") { 1.0 } else { 0.0 };
    let value: f64 = value.trim().parse().with_context(usage)?;
    let most = if name == "damping" { 1.0 } else { f64::INFINITY };
    if !(value > above && value < most) {
        let below = if most.is_finite() { format!(" and below {most}") } else { " and finite".to_owned() };
        bail!("--limit {text}: the value must be above {above}{below}");
    }
    match name {
        "max-sensitivity" => limits.max_sensitivity = value,
        "max-complementary" => limits.max_complementary = value,
        "noise-gain" => limits.noise_gain = value,
        "control-peak" => limits.control_peak = value,
        "effort" => limits.effort_v = value,
        "gain-margin" => limits.gain_margin_db = value,
        "phase-margin" => limits.phase_margin_deg = value,
        "delay-margin" => limits.delay_margin_s = value,
        "decay" => limits.decay_rad_s = value,
        _ => limits.damping = value,
    }
    Ok(())
}

/// Searches the front, and does with it what was asked.
pub fn run(request: &FrontRequest<'_>, asked: &AskedFront) -> CommandResult {
    let AskedFront { loaded, options } = asked;
    let outputs = request.outputs;
    output::print_warnings(loaded, outputs.results.progress());
    let world = ProjectWorld::of(loaded, outputs.results.progress());
    let chosen_weights = with_chosen_weights_on(&loaded.project, world.pool())?;
    let project = chosen_weights.map_or_else(|| loaded.project.clone(), |chosen| chosen.project);
    let found = project_front(&project, options, &world)?;
    let mut text = FrontText::from(&found);
    let mut code = ExitStatus::SUCCESS;
    if let Some(number) = request.arguments.choose {
        let chosen = choose(&project, &found, number)?;
        text.chosen = Some(number);
        if chosen.verify.is_some() {
            let modelled = build_plant_model(&chosen)?;
            let made = synthesise(&chosen, &modelled, &reduce_plant(&chosen, &modelled)?)?;
            let verified = verify(&chosen, &modelled, &made, &world)?;
            let verdicts = VerdictSummary::from(verified.verification());
            code = verdict_code([verdicts.holds]);
            text.verified = Some(verdicts);
        }
        if let Some(path) = request.save {
            save_project(loaded, &chosen, path)?;
        }
    }
    if let Some(path) = &outputs.report {
        let page = front_report(&text, &report_origin(loaded, " --search"));
        output::write_report(path, &outputs.results, &page)?;
    }
    if !output::write_result(&outputs.results, &text)? {
        output::print_lines(&front_lines(&text));
        request.save.iter().for_each(|path| say!("project {}", path.display()));
        outputs.report.iter().for_each(|path| say!("report  {}", path.display()));
    }
    Ok(code)
}

fn choose(project: &Project, found: &ProjectFront, number: usize) -> Result<Project> {
    let count = found.points.len();
    project_with_point(project, found, number)
        .with_context(|| format!("--choose {number}: the front has the designs 1 to {count}"))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_limit_is_a_name_and_a_value_in_its_range() {
        let mut limits = LoopLimits::default();
        set_limit(&mut limits, "max-sensitivity=1.4").unwrap();
        set_limit(&mut limits, " gain-margin = 12 ").unwrap();
        set_limit(&mut limits, "damping=0.3").unwrap();
        assert_eq!((limits.max_sensitivity, limits.gain_margin_db, limits.damping), (1.4, 12.0, 0.3));
        let wrong = [
            "",
            "max-sensitivity",
            "ms=1.4",
            "max-sensitivity=0.9",
            "noise-gain=nan",
            "effort=inf",
            "decay=-1",
            "damping=1",
            "decay=x",
        ];
        for text in wrong {
            assert!(set_limit(&mut LoopLimits::default(), text).is_err(), "{text}");
        }
    }
}
