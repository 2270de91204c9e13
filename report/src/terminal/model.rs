//! What `counterpoise model` prints of a plant.

use counterpoise_pipeline::PipelineError;
use counterpoise_pipeline::plant_views::{MeshColumn, MeshComparison, ModeSet};
use counterpoise_pipeline::results::ModelResult;
use counterpoise_pipeline::studies::model::ModelStudy;

use super::add_line;
use crate::check::ranking_lines;
use crate::wording::errors::describe_pipeline_error;

/// Returns the lines on a plant: its figures, its assumptions, and the modes of its structure.
pub fn model_lines(study: &ModelStudy) -> Vec<String> {
    let mut all = Vec::new();
    let lines = &mut all;
    add_plant(lines, &study.result, study.unheld.as_ref());
    add_assumptions(lines, &study.result);
    if let Some(why) = &study.unranked {
        let why = describe_pipeline_error(why);
        add_line!(lines, "assumptions are not ranked, because there is no design: {why}");
    }
    if let Some(left_out) = study.truncation {
        add_line!(
            lines,
            "structure condensed to {} balanced states; estimated relative error of what was left out: {:.1e}",
            left_out.kept,
            left_out.estimated_error
        );
    }
    add_modes(lines, &study.views.modes);
    study.views.meshes.iter().for_each(|meshes| add_meshes(lines, meshes));
    all
}

fn add_plant(lines: &mut Vec<String>, result: &ModelResult, unheld: Option<&PipelineError>) {
    add_line!(lines, "{}: linear plant of order {}", result.name, result.order);
    match unheld {
        None if result.out_of_balance_kg_m == 0.0 && result.holding_v == 0.0 => {
            add_line!(lines, "in balance: it stays at its operating point without control");
        }
        None => {
            add_line!(
                lines,
                "out-of-balance {:.4} kg m, held by {:.4} V",
                result.out_of_balance_kg_m,
                result.holding_v
            )
        }
        Some(why) => add_line!(lines, "warning: {}", describe_pipeline_error(why)),
    }
    add_line!(lines, "states: {}", result.states.join(", "));
    add_line!(lines, "{:>14} {:>14}", "frequency Hz", "damping");
    for pole in result.pole_figures() {
        add_line!(lines, "{:14.4} {:14.4}", pole.frequency_hz, pole.damping_ratio);
    }
}

/// Says how many values are assumed, and which of them may lie elsewhere.
fn add_assumptions(lines: &mut Vec<String>, result: &ModelResult) {
    let open: Vec<&str> =
        result.assumptions.iter().filter(|a| a.usual.is_some()).map(|a| a.key.as_str()).collect();
    let count = result.assumptions.len();
    match open.len() {
        0 => add_line!(lines, "assumed: {count} values (`counterpoise check` lists them)"),
        _ => add_line!(
            lines,
            "assumed: {count} values, among them {} (`counterpoise check` lists all)",
            open.join(", ")
        ),
    }
    ranking_lines(&result.assumption_effects).iter().for_each(|line| add_line!(lines, "{line}"));
}

fn add_modes(lines: &mut Vec<String>, sets: &[ModeSet]) {
    if sets.is_empty() {
        return;
    }
    add_line!(lines, "flexible modes of the structure:");
    add_line!(lines, "{:>10} {:>12} {:>16} {:>24}", "hub", "Hz", "effective kg", "effective kg m^2, pitch");
    for set in sets {
        for mode in &set.modes {
            add_line!(
                lines,
                "{:>10} {:12.4} {:16.4} {:24.4}",
                set.support,
                mode.frequency_hz,
                mode.effective_mass_kg,
                mode.effective_inertia_kg_m2
            );
        }
    }
}

fn add_meshes(lines: &mut Vec<String>, meshes: &MeshComparison) {
    add_line!(lines, "frequencies over those of {} elements, free at both ends:", meshes.reference);
    let head = |c: &MeshColumn| format!("{:>11}", format!("{} {}", c.elements, c.kind));
    add_line!(lines, "{:>5} {:>10}{}", "mode", "Hz", meshes.columns.iter().map(head).collect::<String>());
    for (mode, hz) in meshes.reference_hz.iter().enumerate() {
        let cell = |c: &MeshColumn| c.ratios.get(mode).map_or(format!("{:>11}", ""), |r| format!("{r:11.4}"));
        add_line!(lines, "{:>5} {hz:10.3}{}", mode + 1, meshes.columns.iter().map(cell).collect::<String>());
    }
}
