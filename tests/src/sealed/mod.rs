//! Machines whose truth is concealed: an independent simulator, experiments, and the sealed answer of each seed.
//!
//! The diagnosis is handed the project and the recordings of a seed; what the seed conceals stays here, for scoring.

pub mod experiment;
pub mod machine;
pub mod row;
pub mod table;
pub mod truth;

pub use experiment::{Dice, Experiment, Kind, PERIOD, Recorder, SAMPLES, Written, record};
pub use row::{Row, scored};
pub use truth::{Concealed, Family, Sealed};

use counterpoise_models::Parameters;
use machine::Machine;

/// One machine: what the diagnosis sees, and what it does not.
pub struct Case {
    /// Recordings by kind of experiment.
    pub recordings: Vec<(Kind, Written)>,
    /// The same experiments on the machine without what is concealed, the same noise.
    pub plain: Vec<Written>,
    /// The sealed answer.
    pub sealed: Sealed,
}

/// The kinds of experiment of every machine, in order.
pub const KINDS: [Kind; 4] = [Kind::Triangle, Kind::Steps, Kind::Road, Kind::Multisine];

/// Proportional and integral gain and bias of the loop in which the machines are recorded.
pub const GAINS: [f64; 3] = [18.0, 80.0, 2.88];

/// The machine of a seed, recorded with the given proportional and integral gain and bias.
pub fn case(seed: u64, nominal: &Parameters, gains: [f64; 3]) -> Case {
    let mut plain = truth::machine(nominal);
    let mut machine = plain.clone();
    let sealed = truth::conceal(seed, &mut machine);
    for gyro in [&mut plain.hub_gyro, &mut plain.platform_gyro, &mut plain.accelerometer] {
        gyro.noise *= sealed.noise;
    }
    let mut recorder = truth::recorder(nominal, gains[0], gains[1], gains[2]);
    recorder.tachometer.noise *= sealed.noise;
    recorder.resolver.noise *= sealed.noise;
    let one = |machine: &Machine, k: usize| {
        let mut dice = Dice::new(seed.wrapping_mul(31).wrapping_add(k as u64 + 1));
        let experiment = Experiment::new(KINDS[k], &mut dice);
        record(machine, &recorder, &experiment, &mut dice)
    };
    let recordings = (0..KINDS.len()).map(|k| (KINDS[k], one(&machine, k))).collect();
    let plain = (0..KINDS.len()).map(|k| one(&plain, k)).collect();
    Case { recordings, plain, sealed }
}
