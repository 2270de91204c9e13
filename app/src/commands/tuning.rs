//! The printed lines on a feedback that was tuned.

use counterpoise_host::projects::ProjectOnDisk;
use counterpoise_pipeline::tuning::TuningResult;
use counterpoise_plot::number::short_number;
use counterpoise_report::designs::{block_words, weight_words};

use crate::output::say;

/// Prints the tuned blocks or weights with their figures; nothing if the project has nothing to tune.
pub fn print_tuning(loaded: &ProjectOnDisk) {
    let Some(found) = &loaded.tuned else { return };
    let controlled = loaded.project.plant.controlled_quantity();
    let result = TuningResult::of(found, controlled);
    match &result.weights {
        Some(weights) => {
            say!("the weights of the H2 feedback were tuned: {}", weight_words(weights, controlled))
        }
        None => say!("the feedback has a fixed structure, and its open parameters were tuned:"),
    }
    result.blocks.iter().for_each(|block| say!("  {}", block_words(block)));
    let reached = result.starts.value.iter().flatten().count();
    say!(
        "{} loops were evaluated from {} starts, of which {reached} reached a loop within the limits; checked on {} plant{}",
        result.evaluations,
        result.starts.value.len(),
        result.plants,
        if result.plants == 1 { "" } else { "s" }
    );
    for (k, m) in result.measures.iter().enumerate() {
        let plant = if k == 0 { "nominal plant".to_owned() } else { format!("plant {}", k + 1) };
        say!(
            "  {plant}: residual {} {}; Ms {}, Mt {}; margins {} dB, {} deg, {} ms; noise gain {}, largest KS {} {}; effort {} V",
            short_number(1e3 * m.residual.value),
            controlled.milli_unit(),
            short_number(m.max_sensitivity),
            short_number(m.max_complementary),
            short_number(m.gain_margin_db),
            short_number(m.phase_margin_deg),
            short_number(1e3 * m.delay_margin_s),
            short_number(m.noise_gain),
            short_number(m.control_peak),
            controlled.gain_unit(),
            short_number(m.effort_v)
        );
    }
    if result.missed > 0.0 {
        say!(
            "warning: A LIMIT IS MISSED by {} %: widen the limits of [synth.tune], or add a block",
            short_number(100.0 * result.missed)
        );
    }
    say!("`counterpoise synth PROJECT --save FILE` writes the values into the file");
    say!();
}
