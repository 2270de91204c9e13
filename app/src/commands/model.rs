//! `counterpoise model`: the plant, its poles, the modes of its structure, and pictures of both and of its friction.

use clap::Args;
use counterpoise_pipeline::check::rank_assumptions;
use counterpoise_pipeline::exchange::StructureResult;
use counterpoise_pipeline::plant_views::{MeshColumn, MeshComparison, ModeSet, view_plant};
use counterpoise_pipeline::results::ModelResult;
use counterpoise_pipeline::studies::accuracy::simulation_accuracy;
use counterpoise_pipeline::{self as pipeline, PipelineError};
use counterpoise_project::Purpose;
use counterpoise_report::check::ranking_lines;
use counterpoise_report::model::model_report;
use counterpoise_report::wording::errors::describe_pipeline_error;
use std::path::PathBuf;

use crate::exit::{CommandResult, ExitStatus};
use crate::options::ResultOutput;
use crate::output::{self, say};
use counterpoise_host::interrupt;
use counterpoise_host::projects;
use counterpoise_host::workers::ProgressPool;

/// Arguments of `model`.
#[derive(Args)]
pub struct ModelOptions {
    /// Project file, or a folder with a project.toml
    pub project: PathBuf,
    /// Write a report with mode shapes, friction characteristics and the simulator's own error to this HTML file
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// The destination of results.
    #[command(flatten)]
    pub results: ResultOutput,
}

/// Runs the command.
pub fn run(options: &ModelOptions) -> CommandResult {
    let loaded = projects::load_project(&options.project, Purpose::Model)?;
    output::print_warnings(&loaded, options.results.progress());
    let watched = ProgressPool::new(options.results.progress());
    let watch = interrupt::watch_interrupts();
    let modelled = pipeline::model_watched(&loaded.project, &watched);
    drop(watch);
    watched.finish();
    let modelled = modelled?;
    let mut result = ModelResult::from(&modelled);
    let ranked =
        rank_assumptions(&loaded.project, &modelled, &loaded.assumptions, options.results.loop_systems());
    let unranked = ranked.as_ref().err().map(describe_pipeline_error);
    match ranked {
        Ok(ranked) => {
            (result.assumptions, result.assumption_effects) = (ranked.assumptions, ranked.effects);
            result.assumed_loop = ranked.assumed_loop;
        }
        Err(_) => result.assumptions.clone_from(&loaded.assumptions),
    }
    let views = view_plant(&loaded.project, &modelled)?;
    result.structure = StructureResult::of(&views, loaded.project.plant.beam.as_ref());
    result.frictions.clone_from(&views.frictions);
    if let Some(path) = &options.report {
        let command = format!("counterpoise model {} --report {}", options.project.display(), path.display());
        let workers = ProgressPool::new(options.results.progress());
        let accuracy = simulation_accuracy(&modelled, &workers);
        workers.finish();
        result.accuracy = accuracy?;
        let page = model_report(&result, &views, &result.accuracy, &command);
        output::write_report(path, &options.results, &page)?;
    }
    if !output::write_result(&options.results, &result)? {
        print(&result, pipeline::cannot_hold(&modelled).as_ref());
        print_assumptions(&result);
        if let Some(why) = unranked {
            say!("assumptions are not ranked, because there is no design: {why}");
        }
        if let Some(left_out) = modelled.elements.as_ref().and_then(|elements| elements.truncation) {
            say!(
                "structure condensed to {} balanced states; estimated relative error of what was left out: {:.1e}",
                left_out.kept,
                left_out.estimated_error
            );
        }
        modes(&views.modes);
        views.meshes.iter().for_each(meshes);
    }
    Ok(ExitStatus::SUCCESS)
}

fn print(result: &ModelResult, unheld: Option<&PipelineError>) {
    say!("{}: linear plant of order {}", result.name, result.order);
    match unheld {
        None if result.out_of_balance_kg_m == 0.0 && result.holding_v == 0.0 => {
            say!("in balance: it stays at its operating point without control");
        }
        None => {
            say!("out-of-balance {:.4} kg m, held by {:.4} V", result.out_of_balance_kg_m, result.holding_v)
        }
        Some(why) => say!("warning: {}", describe_pipeline_error(why)),
    }
    say!("states: {}", result.states.join(", "));
    say!("{:>14} {:>14}", "frequency Hz", "damping");
    for pole in result.pole_figures() {
        say!("{:14.4} {:14.4}", pole.frequency_hz, pole.damping_ratio);
    }
}

/// Says how many values are assumed, and which of them may lie elsewhere.
fn print_assumptions(result: &ModelResult) {
    let open: Vec<&str> =
        result.assumptions.iter().filter(|a| a.usual.is_some()).map(|a| a.key.as_str()).collect();
    let count = result.assumptions.len();
    match open.len() {
        0 => say!("assumed: {count} values (`counterpoise check` lists them)"),
        _ => say!("assumed: {count} values, among them {} (`counterpoise check` lists all)", open.join(", ")),
    }
    ranking_lines(&result.assumption_effects).iter().for_each(|line| say!("{line}"));
}

fn modes(sets: &[ModeSet]) {
    if sets.is_empty() {
        return;
    }
    say!("flexible modes of the structure:");
    say!("{:>10} {:>12} {:>16} {:>24}", "hub", "Hz", "effective kg", "effective kg m^2, pitch");
    for set in sets {
        for mode in &set.modes {
            say!(
                "{:>10} {:12.4} {:16.4} {:24.4}",
                set.support,
                mode.frequency_hz,
                mode.effective_mass_kg,
                mode.effective_inertia_kg_m2
            );
        }
    }
}

fn meshes(meshes: &MeshComparison) {
    say!("frequencies over those of {} elements, free at both ends:", meshes.reference);
    let head = |c: &MeshColumn| format!("{:>11}", format!("{} {}", c.elements, c.kind));
    say!("{:>5} {:>10}{}", "mode", "Hz", meshes.columns.iter().map(head).collect::<String>());
    for (mode, hz) in meshes.reference_hz.iter().enumerate() {
        let cell = |c: &MeshColumn| c.ratios.get(mode).map_or(format!("{:>11}", ""), |r| format!("{r:11.4}"));
        say!("{:>5} {hz:10.3}{}", mode + 1, meshes.columns.iter().map(cell).collect::<String>());
    }
}
