//! What commands print of a feedback that was tuned.

use counterpoise_models::ControlledQuantity;
use counterpoise_pipeline::tuning::{DisturbedFigures, LoopMeasuresResult, RangeEndResult, TuningResult};
use counterpoise_plot::number::short_number;
use counterpoise_project::TuningObjective;

use super::add_line;
use crate::designs::{block_words, shown_residual, weight_words};

/// Returns the lines on the tuned blocks or weights, with their figures.
pub fn tuning_lines(result: &TuningResult, controlled: ControlledQuantity) -> Vec<String> {
    let mut lines = Vec::new();
    match &result.weights {
        Some(weights) => {
            add_line!(
                lines,
                "the weights of the H2 feedback were tuned: {}",
                weight_words(weights, controlled)
            );
        }
        None => add_line!(lines, "the feedback has a fixed structure, and its open parameters were tuned:"),
    }
    result.blocks.iter().for_each(|block| add_line!(lines, "  {}", block_words(block)));
    result.range_ends.iter().for_each(|end| add_line!(lines, "  {}", range_end_words(end)));
    let reached = result.starts.value.iter().flatten().count();
    add_line!(
        lines,
        "{} loops were evaluated from {} starts, of which {reached} reached a loop within the limits; checked on {} plant{}",
        result.evaluations,
        result.starts.value.len(),
        result.plants,
        if result.plants == 1 { "" } else { "s" }
    );
    for (k, measures) in result.measures.iter().enumerate() {
        let plant = if k == 0 { "nominal plant".to_owned() } else { format!("plant {}", k + 1) };
        add_line!(lines, "  {plant}: {}", measures_words(measures));
    }
    if result.missed > 0.0 {
        add_line!(
            lines,
            "warning: A LIMIT IS MISSED by {} %: widen the limits of [synth.tune], or add a block",
            short_number(100.0 * result.missed)
        );
    }
    add_line!(lines, "`counterpoise synth PROJECT --save FILE` writes the values into the file");
    add_line!(lines);
    lines
}

fn measures_words(m: &LoopMeasuresResult) -> String {
    let gain_unit = m.disturbed.controlled.gain_unit();
    format!(
        "{}; Ms {}, Mt {}; margins {} dB, {} deg, {} ms; noise gain {}, largest KS {} {gain_unit}; {}",
        residual_words(&m.disturbed),
        short_number(m.max_sensitivity),
        short_number(m.max_complementary),
        short_number(m.gain_margin_db),
        short_number(m.phase_margin_deg),
        short_number(1e3 * m.delay_margin_s),
        short_number(m.noise_gain),
        short_number(m.control_peak),
        effort_words(&m.disturbed)
    )
}

fn residual_words(figures: &DisturbedFigures) -> String {
    let shown = short_number(shown_residual(figures));
    match figures.objective {
        TuningObjective::Motion => format!("residual {shown} {}", figures.controlled.milli_unit()),
        TuningObjective::Band => format!("RMS of S in the band {shown}"),
    }
}

fn effort_words(figures: &DisturbedFigures) -> String {
    let shown = short_number(figures.effort);
    match figures.objective {
        TuningObjective::Motion => format!("effort {shown} V"),
        TuningObjective::Band => {
            format!("RMS of KS in the band {shown} {}", figures.controlled.gain_unit())
        }
    }
}

/// Returns a remark on a parameter that ended at the end of its range.
fn range_end_words(end: &RangeEndResult) -> String {
    let [low, high] = end.range.map(short_number);
    format!(
        "{} of block {} ended at an end of its range, {low} to {high}: `{}_range` of the block states another one",
        end.parameter, end.block, end.parameter
    )
}
