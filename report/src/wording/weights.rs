//! The demands of a specification's weights, in words.

use std::f64::consts::TAU;

use counterpoise_pipeline::tuning::BlockResult;
use counterpoise_project::resolve::synthesis::DesignRequest;
use counterpoise_synth::weight::shape::{HighFrequency, LowFrequency, Transition, WeightShape};
use counterpoise_synth::{LightModes, Weight};

/// Returns what each weight asks for, in words, one a line; of a feedback of fixed structure its blocks.
pub fn describe_weights(synth: &DesignRequest) -> Vec<String> {
    let s = &synth.specification;
    let blocks = synth.options.structure.blocks.iter().map(Into::into);
    let mut lines: Vec<String> =
        blocks.map(|block| format!("feedback: {}", describe_block(&block))).collect();
    lines.extend(
        synth
            .options
            .imported
            .iter()
            .map(|imported| format!("feedback: the controller in {}", imported.file)),
    );
    if lines.is_empty() {
        lines.push(format!("feedback: {}", describe_weight(&s.feedback.error, "measured error")));
        lines.push(format!("feedback: {}", describe_weight(&s.feedback.control, "control")));
        if s.feedback.modes == LightModes::Stiffened {
            lines.push(
                "feedback: designed as if the structure were much stiffer: its observer follows no lightly damped mode"
                    .to_owned(),
            );
        }
    }
    if let Some(gain) = s.position_gain {
        lines.push(format!(
            "cascade: a position loop with the gain {gain} 1/s around this rate loop; the rate is the difference of two readings over the sample period"
        ));
    }
    for (name, part) in [("heave", &s.heave), ("pitch", &s.pitch)] {
        if let Some(part) = part {
            lines.push(format!("{name}: {}", describe_weight(&part.error, "hub rate")));
            lines.push(format!("{name}: {}", describe_weight(&part.control, "control")));
        }
    }
    lines
}

/// Describes a block of a fixed structure: its kind and its values.
fn describe_block(block: &BlockResult) -> String {
    let values: Vec<String> = block.values.iter().map(|(key, value)| format!("{key} {value:.6}")).collect();
    format!("{} ({})", block.kind, values.join(", "))
}

/// Describes a weight on a signal ("error", "control"): what it says of the steady and of the fast signal, up to where it is the one,
/// and where it weighs most or least in between.
pub fn describe_weight(weight: &Weight, signal: &str) -> String {
    match weight.shape() {
        WeightShape::Constant { modulus } => {
            format!("weight on the {signal}: {} at every frequency", plain_number(modulus))
        }
        WeightShape::Varying { low, transition, high } => {
            let (low, high) = (describe_low_frequency(low, signal), describe_high_frequency(high, signal));
            format!("weight on the {signal}: {low}, {}; {high}", describe_transition(transition))
        }
    }
}

fn describe_low_frequency(low: LowFrequency, signal: &str) -> String {
    match low {
        LowFrequency::Level { modulus } => format!("{} at low frequency", plain_number(modulus)),
        LowFrequency::Unbounded => {
            format!("without bound towards zero frequency, so that no steady {signal} may remain")
        }
        LowFrequency::Zero => format!("zero at zero frequency, so that a steady {signal} is not penalised"),
    }
}

fn describe_high_frequency(high: HighFrequency, signal: &str) -> String {
    match high {
        HighFrequency::Level { modulus } => format!("{} at high frequency", plain_number(modulus)),
        HighFrequency::Rising { power } => {
            format!("rising with the power {power} of frequency, so that fast {signal} is forbidden")
        }
        HighFrequency::Falling { power } => {
            format!("falling with the power {power} of frequency, so that fast {signal} is not penalised")
        }
    }
}

fn describe_transition(transition: Transition) -> String {
    match transition {
        Transition::UnitModulus { rate_rad_s } => format!("1 at {} Hz", plain_number(rate_rad_s / TAU)),
        Transition::Corner { rate_rad_s } => format!("up to {} Hz", plain_number(rate_rad_s / TAU)),
        Transition::Peak { rate_rad_s, modulus } => {
            format!("most at {} Hz ({})", plain_number(rate_rad_s / TAU), plain_number(modulus))
        }
        Transition::Dip { rate_rad_s, modulus } => {
            format!("least at {} Hz ({})", plain_number(rate_rad_s / TAU), plain_number(modulus))
        }
    }
}

/// Three significant digits, as a person writes them.
fn plain_number(value: f64) -> String {
    if !(1e-3..1e6).contains(&value) {
        return format!("{value:.2e}");
    }
    let decimals = (2.0 - value.log10().floor()).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_words_name_both_ends_and_where_one_passes_into_the_other() {
        let said = |weight: Weight, signal: &str, words: &[&str]| {
            let text = describe_weight(&weight, signal);
            words.iter().for_each(|word| assert!(text.contains(word), "{word}: {text}"));
        };
        let integral = Weight::Integral { gain: 1.0, time_s: 0.5 };
        said(
            integral,
            "error",
            &["no steady error may remain", "1 at 0.318 Hz", "fast error is not penalised"],
        );
        let lead = Weight::Lead { gain: 1.0, time_s: 0.005 };
        said(lead, "control", &["1 at low frequency, up to 31", "fast control is forbidden"]);
        let shelf = Weight::Shelf { low: 100.0, high: 1.0, corner_rad_s: 20.0 };
        said(shelf, "error", &["100 at low frequency, up to ", "; 1 at high frequency"]);
        let notch = Weight::Notch { gain: 2.0, centre_rad_s: 50.0, width: 0.2, factor: 10.0 };
        said(notch, "error", &["2 at low frequency", "at 7.9", "2 at high frequency"]);
        said(Weight::Constant { gain: 300.0 }, "hub rate", &["300 at every frequency"]);
        let free = Weight::QuadraticFreeAtZero { gain: 1.0, second_s2: 1e-4, first_s: 1.4e-2 };
        said(free, "control", &["a steady control is not penalised, up to", "power 2"]);
    }
}
