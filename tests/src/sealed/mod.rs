//! Machines whose truth is concealed: an independent simulator, experiments, and the sealed answer of each seed.
//!
//! The diagnosis is handed the project and the recordings of a seed; what the seed conceals stays here, for scoring.

pub mod experiment;
pub mod machine;
pub mod truth;

pub use experiment::{Dice, Experiment, Kind, PERIOD, Recorder, SAMPLES, Written, record};
pub use truth::{Concealed, Family, Sealed};

use counterpoise_models::Parameters;

/// One machine: what the diagnosis sees, and what it does not.
pub struct Case {
    /// Recordings by kind of experiment.
    pub recordings: Vec<(Kind, Written)>,
    /// The sealed answer.
    pub sealed: Sealed,
}

/// The kinds of experiment of every machine, in order.
pub const KINDS: [Kind; 4] = [Kind::Triangle, Kind::Steps, Kind::Road, Kind::Multisine];

/// The machine of a seed, recorded with the given proportional and integral gain and bias.
pub fn case(seed: u64, nominal: &Parameters, gains: [f64; 3]) -> Case {
    let mut machine = truth::machine(nominal);
    let sealed = truth::conceal(seed, &mut machine);
    let mut recorder = truth::recorder(nominal, gains[0], gains[1], gains[2]);
    recorder.tachometer.noise *= sealed.noise;
    recorder.resolver.noise *= sealed.noise;
    let one = |(k, kind): (u64, Kind)| {
        let mut dice = Dice::new(seed.wrapping_mul(31).wrapping_add(k + 1));
        let experiment = Experiment::new(kind, &mut dice);
        (kind, record(&machine, &recorder, &experiment, &mut dice))
    };
    let recordings = KINDS.into_iter().enumerate().map(|(k, kind)| one((k as u64, kind))).collect();
    Case { recordings, sealed }
}
