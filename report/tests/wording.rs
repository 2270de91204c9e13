//! The words about weights and requirements.

use counterpoise_report::wording::weights::describe_weight;
use counterpoise_synth::Weight;

#[test]
fn the_words_name_both_ends_and_where_one_passes_into_the_other() {
    let said = |weight: Weight, signal: &str, words: &[&str]| {
        let text = describe_weight(&weight, signal);
        words.iter().for_each(|word| assert!(text.contains(word), "{word}: {text}"));
    };
    let integral = Weight::Integral { gain: 1.0, time_s: 0.5 };
    said(integral, "error", &["no steady error may remain", "1 at 0.318 Hz", "fast error is not penalised"]);
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
