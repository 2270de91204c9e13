//! `counterpoise synth`: the controller with its certificates, compared with its alternatives; or the search for its weights.

use clap::Args;
use counterpoise_pipeline::results::SynthResult;
use counterpoise_pipeline::studies::search::{JudgedWeights, search_weights, verify_found};
use counterpoise_pipeline::tuning::TuningResult;
use counterpoise_pipeline::{
    self as pipeline, FirstDesignResult, PlantModel, ProjectIdentity, ReducedPlant, study_synthesis,
};
use counterpoise_project::Purpose;
use counterpoise_synth::SearchTrial;
use serde::Serialize;
use std::path::{Path, PathBuf};

use super::synth_front::{self, FrontArguments, FrontRequest};
use super::synth_outputs::{report_origin, save_project};
use crate::exit::{CommandResult, ExitStatus, verdict_code};
use crate::options::CommandOutputs;
use crate::output::{self, say};
use counterpoise_host::interrupt;
use counterpoise_host::projects::{self, ProjectOnDisk, ProjectWorld};
use counterpoise_host::stages::ProgressDisplay;
use counterpoise_report::results::search::SearchText;
use counterpoise_report::results::{ComparisonText, FirstDesignText, SynthText};
use counterpoise_report::terminal::search::search_lines;
use counterpoise_report::terminal::synthesis::synthesis_lines;
use counterpoise_report::terminal::tuning::tuning_lines;
use counterpoise_report::trade_off::VerifiedPoint;
use counterpoise_report::{of_synthesis, trade_off};

/// Arguments of `synth`.
#[derive(Args)]
pub struct SynthOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// Search the front of designs that [synth.front] trades; the weights for the requirements of [synth.search] if the file has these and no [synth.front]
    #[arg(long)]
    pub search: bool,
    /// What the front trades and how.
    #[command(flatten)]
    pub front: FrontArguments,
    /// Write the project with its weights, or with the values of its blocks: those that were chosen or tuned if the file states none, or with --search those that were found or chosen from the front
    #[arg(long, value_name = "FILE")]
    pub save: Option<PathBuf>,
    /// The destinations of report and results.
    #[command(flatten)]
    pub outputs: CommandOutputs,
}

/// The design and its comparison with alternatives, for another program.
#[derive(Serialize)]
struct SynthOutput<'a> {
    #[serde(flatten)]
    synth: &'a SynthText,
    beside: ComparisonText,
    #[serde(skip_serializing_if = "Option::is_none")]
    first_design: Option<FirstDesignText>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tuning: Option<TuningResult>,
}

/// Runs the command.
pub fn run(options: &SynthOptions) -> CommandResult {
    let request = FrontRequest {
        project: &options.project,
        arguments: &options.front,
        save: options.save.as_deref(),
        outputs: &options.outputs,
    };
    if options.search
        && let Some(asked) = synth_front::asked_front(&request)?
    {
        return synth_front::run(&request, &asked);
    }
    let loaded = projects::load_project(&options.project, Purpose::Synth)?;
    output::print_warnings(&loaded, options.outputs.results.progress());
    if options.search {
        let modelled = pipeline::build_plant_model(&loaded.project)?;
        let reduced = pipeline::reduce_plant(&loaded.project, &modelled)?;
        return report_search(options, &loaded, &modelled, &reduced);
    }
    let study = study_synthesis(&loaded.project, &loaded.project_folder())?;
    let mut result = SynthResult::from(&study.synthesised);
    if loaded.first_design.is_some() {
        // Chosen weights were judged by the margins of their loop, whatever they ask for by themselves.
        result.warnings.retain(|warning| !warning.cause.is_crossover_of_weights());
    }
    if let Some(path) = &options.outputs.report {
        let origin = report_origin(&loaded, "");
        output::write_report(path, &options.outputs.results, &of_synthesis(&study, &result, &origin))?;
    }
    if let Some(path) = &options.save {
        save_project(&loaded, &loaded.project, path)?;
    }
    let first_design = loaded.first_design.as_ref().map(|first| FirstDesignResult::from(first).into());
    let (result, beside) = (SynthText::from(result), ComparisonText::from(&study.comparison));
    let controlled = loaded.project.plant.controlled_quantity();
    let tuning = loaded.tuned.as_ref().map(|tuned| TuningResult::of(tuned, controlled));
    let whole = SynthOutput { synth: &result, beside, first_design, tuning };
    if !output::write_result(&options.outputs.results, &whole)? {
        super::first_design::print_first_design(&loaded);
        whole.tuning.iter().for_each(|tuned| output::print_lines(&tuning_lines(tuned, controlled)));
        output::print_lines(&synthesis_lines(&study, &result));
        options.save.iter().for_each(|path| print_saved(&loaded, path));
        options.outputs.report.iter().for_each(|path| say!("report  {}", path.display()));
    }
    Ok(ExitStatus::SUCCESS)
}

/// Prints where a project was saved, and what its chosen weights took the place of.
fn print_saved(loaded: &ProjectOnDisk, path: &Path) {
    say!("project {}", path.display());
    let asked = loaded.stated.synth.as_ref().and_then(|synth| synth.bandwidth_rad_s);
    if loaded.first_design.is_some() && asked.is_some() {
        say!("        its weights stand in the place of synth.bandwidth, which is not written");
    }
}

fn report_search(
    options: &SynthOptions,
    loaded: &ProjectOnDisk,
    modelled: &PlantModel,
    reduced: &ReducedPlant,
) -> CommandResult {
    let _watch = interrupt::watch_interrupts();
    let mut found = search_weights(&loaded.project, modelled, reduced, &mut |_: &SearchTrial| {
        !interrupt::is_stop_requested()
    })?;
    let world = ProjectWorld::of(loaded, ProgressDisplay::Quiet);
    let judged = match loaded.project.verify {
        Some(_) => verify_found(&found, modelled, reduced, &world, &mut || !interrupt::is_stop_requested())?,
        None => Vec::new(),
    };
    let chosen = judged.iter().position(JudgedWeights::holds);
    if let Some(point) = chosen.and_then(|k| judged.get(k)) {
        found.project = point.project.clone();
    }
    let full = found.found.best.missed == 0.0 && found.missed_on_full_plant == 0.0;
    let holds = if judged.is_empty() { full } else { chosen.is_some() };
    if let Some(path) = &options.save {
        save_project(loaded, &found.project, path)?;
    }
    let points: Vec<VerifiedPoint> = judged.iter().map(VerifiedPoint::from).collect();
    let result = SearchText::new(&found, points);
    if let Some(path) = &options.outputs.report {
        let identity = ProjectIdentity::of(&loaded.project, &loaded.project_folder());
        let page = trade_off::trade_off_report(
            &identity,
            &found,
            &result.verified,
            &report_origin(loaded, " --search"),
        );
        output::write_report(path, &options.outputs.results, &page)?;
    }
    if !output::write_result(&options.outputs.results, &result)? {
        let gain_unit = loaded.project.plant.controlled_quantity().gain_unit();
        output::print_lines(&search_lines(&found, &result, chosen, gain_unit));
        options.save.iter().for_each(|path| say!("project {}", path.display()));
        options.outputs.report.iter().for_each(|path| say!("report  {}", path.display()));
    }
    Ok(verdict_code([holds]))
}
