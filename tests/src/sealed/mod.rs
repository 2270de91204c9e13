//! Machines whose truth is concealed: an independent simulator, experiments, and the sealed answer of each seed.
//!
//! The diagnosis is handed the project and the recordings of a seed; what the seed conceals stays here, for scoring.

pub mod experiment;
pub mod machine;
pub mod oracle;
pub mod row;
pub mod table;
pub mod truth;

pub use experiment::{Dice, Experiment, Kind, PERIOD, Recorder, SAMPLES, Written, record};
pub use row::{Row, scored};
pub use truth::{Concealed, Family, Sealed};

use counterpoise_controller::ProportionalIntegral;
use counterpoise_models::{Parameters, reference};
use machine::Machine;

/// One machine: what the diagnosis sees, and what it does not.
pub struct Case {
    /// Recordings, one of each of [`KINDS`].
    pub recordings: Vec<Written>,
    /// For each concealed effect: the same experiments on the machine without it, the same noise.
    pub without: Vec<Vec<Written>>,
    /// The sealed answer.
    pub sealed: Sealed,
}

/// The kinds of experiment of every machine, in order.
pub const KINDS: [Kind; 4] = [Kind::Triangle, Kind::Steps, Kind::Road, Kind::Multisine];

/// Proportional and integral gain and bias of the loop in which the machines are recorded.
pub const GAINS: [f64; 3] = [18.0, 80.0, 2.88];

/// The controller of that loop.
pub fn controller() -> ProportionalIntegral {
    let [kp_v_s_rad, ki_v_rad, bias_v] = GAINS;
    ProportionalIntegral { kp_v_s_rad, ki_v_rad, bias_v, sample_period_s: PERIOD, integral_v: 0.0 }
}

/// The machine of a seed, recorded.
pub fn case(seed: u64, nominal: &Parameters) -> Case {
    let mut machine = truth::machine(nominal);
    let (sealed, without) = truth::conceal(seed, &mut machine);
    recorded(seed, nominal, &machine, (sealed, without))
}

/// The machine with one given effect of a given size, recorded: see [`truth::conceal_one`]. `nominal` is as [`nominal_of`] has it.
pub fn case_of(which: usize, size: f64, nominal: &Parameters) -> Case {
    let mut machine = truth::machine(nominal);
    let sealed = truth::conceal_one(which, size, &mut machine);
    recorded(1_000 + which as u64, nominal, &machine, sealed)
}

/// The project in which one given effect shows: nearly balanced for those at small torques, the rig otherwise.
pub fn nominal_of(which: usize) -> Parameters {
    let mut nominal = reference::rig();
    if truth::SHOW_WHEN_BALANCED.contains(&which) {
        nominal.lumped.iter_mut().for_each(|l| l.out_of_balance_kg_m = BALANCED_KG_M);
    }
    nominal
}

/// First moment of the nearly balanced machine, and the controller's bias that holds it.
const BALANCED_KG_M: f64 = 20.0;
const BALANCED_BIAS_V: f64 = 0.38;

fn recorded(
    seed: u64,
    nominal: &Parameters,
    machine: &Machine,
    (sealed, without): (Sealed, Vec<Machine>),
) -> Case {
    let [kp, ki, bias] = GAINS;
    let balanced = nominal.lumped.as_ref().is_some_and(|l| l.out_of_balance_kg_m == BALANCED_KG_M);
    let bias = if balanced { BALANCED_BIAS_V } else { bias };
    let mut recorder = truth::recorder(nominal, kp, ki, bias);
    recorder.tachometer.noise *= sealed.noise;
    recorder.resolver.noise *= sealed.noise;
    let one = |machine: &Machine, k: usize| {
        let mut dice = Dice::new(seed.wrapping_mul(31).wrapping_add(k as u64 + 1));
        let experiment = Experiment::new(KINDS[k], &mut dice);
        record(machine, &recorder, &experiment, &mut dice)
    };
    let all = |machine: &Machine| (0..KINDS.len()).map(|k| one(machine, k)).collect::<Vec<Written>>();
    Case { recordings: all(machine), without: without.iter().map(all).collect(), sealed }
}
