//! `counterpoise synth`: the controller with its certificates, compared with its alternatives; or the search for its weights.

use clap::Args;
use counterpoise_pipeline::results::SynthResult;
use counterpoise_pipeline::studies::comparison::{DesignComparison, LoopFigures, MethodRow};
use counterpoise_pipeline::studies::search::{
    JudgedWeights, SearchAnswer, TradeOffPoint, search_weights, verify_found,
};
use counterpoise_pipeline::tuning::TuningResult;
use counterpoise_pipeline::{
    self as pipeline, FirstDesignResult, PlantModel, ProjectIdentity, ReducedPlant, SynthesisStudy,
    study_synthesis,
};
use counterpoise_project::Purpose;
use counterpoise_synth::{Figures, SearchEnding, SearchTrial};
use serde::Serialize;
use std::path::{Path, PathBuf};

use super::synth_front::{self, FrontArguments, FrontRequest};
use super::synth_outputs::{report_origin, save_project, verdicts_of};
use crate::exit::{CommandResult, ExitStatus, verdict_code};
use crate::options::CommandOutputs;
use crate::output::{self, say};
use counterpoise_host::interrupt;
use counterpoise_host::projects::{self, ProjectOnDisk, ProjectWorld};
use counterpoise_host::stages::ProgressDisplay;
use counterpoise_plot::number::short_number;
use counterpoise_report::results::{ComparisonText, FirstDesignText, SynthText};
use counterpoise_report::trade_off::VerifiedPoint;
use counterpoise_report::wording::certificates::total_cost_lines;
use counterpoise_report::wording::design_findings::describe_design_findings;
use counterpoise_report::wording::figures::{describe_modulus, drop_small_sign};
use counterpoise_report::wording::schedule::{describe_conditions, describe_law};
use counterpoise_report::wording::weights::describe_weights;
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
        super::tuning::print_tuning(&loaded);
        describe_weights(&study.asked).iter().for_each(|line| say!("{line}"));
        print_design(&result);
        print_comparison(&study);
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

fn print_design(result: &SynthText) {
    let figures = &result.figures;
    say!();
    say!("design plant of order {}", figures.plant_order);
    figures.path_orders.iter().for_each(|(name, order)| say!("{name}: order {order}"));
    let largest = figures.largest_pole_modulus;
    say!(
        "closed sampled loop: {} poles, largest modulus {}",
        figures.closed_loop_poles.len(),
        describe_modulus(largest)
    );
    if let Some(difference) = figures.cost_difference {
        say!("predicted cost and cost of the assembled loop differ by {difference:.1e}");
    }
    result.demanded_rate.iter().for_each(|limit| say!("{limit}"));
    result.warnings.iter().for_each(|w| say!("warning: {w}"));
}

/// Prints the comparison of a design with its alternatives.
pub fn print_comparison(study: &SynthesisStudy) {
    let (beside, gain_unit) = (&study.comparison, study.synthesised.controlled.gain_unit());
    print_methods(&beside.methods, gain_unit);
    if let Some(row) = &beside.lowered {
        say!();
        say!(
            "feedback of order {} lowered to {} by frequency-weighted balancing:",
            row.order[0],
            row.order[1]
        );
        say!("  the closed loop changes by {} % at most", short_number(100.0 * row.loop_change));
        for (name, found) in [("before", &row.before), ("after", &row.after)] {
            say!("  {name:8}{}", figures_line(found, gain_unit));
        }
    }
    print_motions(study);
    print_total_cost(beside);
    print_balance(study);
    if let Some(found) = &beside.spillover {
        let says = if found.largest_pole < 1.0 { "stable" } else { "NOT STABLE" };
        let (modes, order, pole) = (found.modes, found.order, found.largest_pole);
        say!();
        say!(
            "on the beam with {modes} modes (order {order}): {says}, largest modulus {}",
            describe_modulus(pole)
        );
    }
}

/// Prints what the expected motions leave. In a loop of torque or current the tip moves by another quantity, which stands in the report.
fn print_motions(study: &SynthesisStudy) {
    let (rows, controlled) = (&study.comparison.motions, study.synthesised.controlled);
    if rows.is_empty() {
        return;
    }
    say!();
    say!(
        "RMS {} under the expected motion, feedback alone -> with feedforward, {}",
        controlled.short_name(),
        controlled.milli_unit()
    );
    for row in rows {
        let pair = |[alone, both]: [f64; 2]| {
            let shown = |value: f64| short_number(1e3 * value);
            format!("{} -> {}", shown(alone), shown(both))
        };
        let tip = if controlled.motion() == controlled {
            format!("   tip {:>20}", pair(row.tip_rad_s))
        } else {
            String::new()
        };
        say!("  {:8} hub {:>20}{tip}", row.disturbance, pair(row.hub_rad_s));
    }
}

fn print_total_cost(beside: &DesignComparison) {
    let lines = total_cost_lines(beside.total_cost.as_ref());
    lines.first().iter().for_each(|_| say!());
    lines.iter().for_each(|line| say!("{line}"));
}

fn print_methods(rows: &[MethodRow], gain_unit: &str) {
    if rows.len() < 2 {
        return;
    }
    say!();
    say!("methods of the feedback, the same plant and weights, figures of the sampled loop:");
    for row in rows {
        let kind = if row.integral { "integral" } else { "no integral" };
        let norm = row.norm.map_or(String::new(), |norm| format!(", norm {norm:.4}"));
        say!("  {}, {kind}: order {}{norm}", row.method, row.order);
        match (&row.figures, &row.why) {
            (Some(found), _) => say!("    {}", figures_line(found, gain_unit)),
            (None, Some(why)) => say!("    no controller: {}", describe_design_findings(why)),
            (None, None) => {}
        }
    }
}

fn figures_line(f: &LoopFigures, gain_unit: &str) -> String {
    format!(
        "margins {:.1} dB, {:.1} deg; Ms {:.3}; crossover {:.1} rad/s; overshoot {:.1} %; |S| {:.3}; noise gain {} {gain_unit}",
        f.gain_margin_db,
        f.phase_margin_deg,
        f.max_sensitivity,
        f.crossover_rad_s,
        f.overshoot_percent,
        f.rejection,
        short_number(f.noise_gain)
    )
}

fn print_balance(study: &SynthesisStudy) {
    let (beside, controlled) = (&study.comparison, study.synthesised.controlled);
    if beside.balance.is_empty() {
        return;
    }
    say!();
    say!("over out-of-balance: change of each controller from 0.1 to 20 Hz, lowest .. highest, dB,");
    say!(
        "and RMS {} under the expected heave, {}: nominal controllers | gain law | redesign",
        controlled.name(),
        controlled.milli_unit()
    );
    for row in &beside.balance {
        let range =
            |[low, high]: [f64; 2]| format!("{:+.2} .. {:+.2}", drop_small_sign(low), drop_small_sign(high));
        let change = |db: Option<[f64; 2]>| db.map_or("none".to_owned(), range);
        let error = |value: Option<f64>| value.map_or("-".to_owned(), |rate| format!("{:.3}", 1e3 * rate));
        say!("  {} ({:.2} kg m)", row.name, row.out_of_balance_kg_m);
        say!(
            "    feedback {}; heave {}; pitch {}",
            range(row.feedback_db),
            change(row.heave_db),
            change(row.pitch_db)
        );
        say!(
            "    error {} | {} | {}",
            error(row.error_before_rad_s),
            error(row.error_gain_law_rad_s),
            error(row.error_after_rad_s)
        );
        say!("    {}", describe_conditions(&row.conditions));
        say!("    {}", describe_law(&row.law));
    }
}

/// The search, for another program.
#[derive(Serialize)]
struct SearchResult {
    settled: &'static str,
    trials: usize,
    missed: f64,
    missed_on_full_plant: f64,
    weights: Vec<String>,
    curve: Vec<CurvePoint>,
    verified: Vec<VerifiedPoint>,
}

/// A point of the trade-off curve.
#[derive(Serialize)]
struct CurvePoint {
    max_sensitivity_limit: f64,
    max_sensitivity: f64,
    rejection: f64,
    noise_gain: f64,
    missed: f64,
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
    let points: Vec<VerifiedPoint> = judged.iter().map(verified_point).collect();
    let result = search_result(&found, points);
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
        print_search(&found, &result, loaded.project.plant.controlled_quantity().gain_unit());
        print_verified(&result.verified, chosen);
        options.save.iter().for_each(|path| say!("project {}", path.display()));
        options.outputs.report.iter().for_each(|path| say!("report  {}", path.display()));
    }
    Ok(verdict_code([holds]))
}

fn verified_point(point: &JudgedWeights) -> VerifiedPoint {
    let found = verdicts_of(point.verified.verification());
    VerifiedPoint {
        max_sensitivity_limit: point.ms_limit,
        rejection: point.found.best.figures.rejection,
        verdicts: found.verdicts,
        failing: found.failing,
        holds: point.holds(),
    }
}

fn print_verified(points: &[VerifiedPoint], chosen: Option<usize>) {
    if points.is_empty() {
        return say!("no [verify] section: the figures are those of the linear loop alone");
    }
    say!("verified on the nonlinear plant, the answer first, then the points by their rejection:");
    for (k, point) in points.iter().enumerate() {
        let [holds, fails, _] = point.verdicts;
        let name = point.max_sensitivity_limit.map_or("answer".to_owned(), |limit| format!("Ms <= {limit}"));
        let mark = if Some(k) == chosen { "  <- taken" } else { "" };
        say!("  {name:12} |S| {:.4}: {holds} requirements hold, {fails} fail{mark}", point.rejection);
        point.failing.iter().for_each(|line| say!("      {line}"));
    }
    if chosen.is_none() {
        say!("NO POINT KEEPS EVERY REQUIREMENT on the nonlinear plant");
    }
}

fn search_result(found: &SearchAnswer, verified: Vec<VerifiedPoint>) -> SearchResult {
    let point = |TradeOffPoint { ms_limit, found }: &TradeOffPoint| CurvePoint {
        max_sensitivity_limit: *ms_limit,
        max_sensitivity: found.best.figures.ms,
        rejection: found.best.figures.rejection,
        noise_gain: found.best.figures.noise_gain,
        missed: found.best.missed,
    };
    SearchResult {
        settled: found.found.ended.name(),
        trials: found.found.trials,
        missed: found.found.best.missed,
        missed_on_full_plant: found.missed_on_full_plant,
        weights: describe_weights(&found.asked),
        curve: found.curve.iter().map(point).collect(),
        verified,
    }
}

fn print_search(found: &SearchAnswer, result: &SearchResult, gain_unit: &str) {
    let ended = match found.found.ended {
        SearchEnding::Settled => "no step improves any more",
        SearchEnding::OutOfTrials => "as many as [synth.search] allows for one answer",
        SearchEnding::Stopped => "stopped",
    };
    say!("{} designs were tried ({ended})", result.trials);
    result.weights.iter().take(2).for_each(|line| say!("{line}"));
    let recovery = found.found.best.specification.feedback.loop_recovery;
    say!("loop recovery {recovery:.4e} V^2 s");
    for (name, figures, missed) in [
        ("on the design plant", &found.found.best.figures, result.missed),
        ("on the plant before reduction", &found.on_full_plant, result.missed_on_full_plant),
    ] {
        let verdict = if missed == 0.0 { "the requirements hold" } else { "REQUIREMENTS ARE MISSED" };
        say!("{name}: {verdict}");
        say!("  {}", searched_line(figures, gain_unit));
    }
    if !result.curve.is_empty() {
        say!("trade-off: limit of Ms, Ms, |S| over the band, noise gain {gain_unit}");
    }
    for point in &result.curve {
        let missed = if point.missed == 0.0 { "" } else { "  (requirements are missed)" };
        let (limit, ms) = (point.max_sensitivity_limit, point.max_sensitivity);
        say!("  {limit:6.3} {ms:7.3} {:8.4} {:9.3}{missed}", point.rejection, point.noise_gain);
    }
}

fn searched_line(f: &Figures, gain_unit: &str) -> String {
    let found = LoopFigures {
        gain_margin_db: f.gain_margin_db,
        phase_margin_deg: f.phase_margin_deg,
        max_sensitivity: f.ms,
        crossover_rad_s: f.crossover_rad_s,
        overshoot_percent: 100.0 * f.overshoot,
        rejection: f.rejection,
        noise_gain: f.noise_gain,
    };
    figures_line(&found, gain_unit)
}
