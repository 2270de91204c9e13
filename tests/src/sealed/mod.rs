//! Machines whose truth is concealed: an independent simulator, experiments, and the sealed answer of each seed.
//!
//! The diagnosis is handed the project and the recordings of a seed; what the seed conceals stays here, for scoring.

pub mod experiment;
pub mod machine;
pub mod oracle;
pub mod row;
pub mod table;
pub mod truth;
pub mod unnamed_machines;

pub use experiment::{
    Dice, Experiment, Kind, PERIOD, Recorder, SAMPLES, WrittenColumns, record, record_under,
};
pub use row::{Row, score};
pub use truth::{ConcealedEffect, MachineFamily, SealedAnswer};

use counterpoise_controller::{Controller, ProportionalIntegral, Runner};
use counterpoise_models::{Parameters, reference};
use machine::Machine;

/// One machine: what the diagnosis sees, and what it does not.
pub struct Case {
    /// Recordings, one of each of [`KINDS`].
    pub recordings: Vec<WrittenColumns>,
    /// For each concealed effect: the same experiments on the machine without it, the same noise.
    pub without: Vec<Vec<WrittenColumns>>,
    /// The sealed answer.
    pub sealed: SealedAnswer,
}

/// The kinds of experiment of every machine, in order.
pub const KINDS: [Kind; 4] = [Kind::Triangle, Kind::Steps, Kind::Road, Kind::Multisine];

/// Proportional and integral gain and bias of the loop in which the machines are recorded.
pub const GAINS: [f64; 3] = [18.0, 80.0, 2.88];

/// Returns the controller of that loop.
pub fn controller() -> ProportionalIntegral {
    let [kp_v_s_rad, ki_v_rad, bias_v] = GAINS;
    ProportionalIntegral {
        kp_v_s_rad,
        ki_v_rad,
        bias_v,
        sample_period_s: PERIOD,
        ..ProportionalIntegral::default()
    }
}

/// Returns the machine of a seed, recorded.
pub fn case(seed: u64, nominal: &Parameters) -> Case {
    let mut machine = truth::machine(nominal);
    let (sealed, without) = truth::conceal(seed, &mut machine);
    record_case(seed, nominal, &machine, sealed, &without)
}

/// Returns the machine with one given effect of a given size, recorded: see [`truth::conceal_one`]. `nominal` is as [`nominal_of`] has it.
pub fn case_of(which: usize, size: f64, nominal: &Parameters) -> Case {
    let mut machine = truth::machine(nominal);
    let (sealed, without) = truth::conceal_one(which, size, &mut machine);
    record_case(1_000 + which as u64, nominal, &machine, sealed, &without)
}

/// Returns the machine as modelled, recorded under the proportional-integral controller.
pub fn case_of_nothing(nominal: &Parameters) -> Case {
    record_case(1_999, nominal, &truth::machine(nominal), truth::unchanged_machine(), &[])
}

/// Returns the project in which one given effect shows: nearly balanced for those at small torques, the rig otherwise.
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

fn record_case(
    seed: u64,
    nominal: &Parameters,
    machine: &Machine,
    sealed: SealedAnswer,
    without: &[Machine],
) -> Case {
    let [kp, ki, bias] = GAINS;
    let balanced = nominal.lumped.as_ref().is_some_and(|l| l.out_of_balance_kg_m == BALANCED_KG_M);
    let bias = if balanced { BALANCED_BIAS_V } else { bias };
    let mut recorder = truth::recorder(nominal, kp, ki, bias);
    recorder.tachometer.noise *= sealed.noise;
    recorder.resolver.noise *= sealed.noise;
    let one = |machine: &Machine, k: usize| {
        let (experiment, mut dice) = experiment_of(seed, k);
        record(machine, &recorder, &experiment, &mut dice)
    };
    let all = |machine: &Machine| (0..KINDS.len()).map(|k| one(machine, k)).collect::<Vec<WrittenColumns>>();
    Case { recordings: all(machine), without: without.iter().map(all).collect(), sealed }
}

/// One experiment of a machine under the proportional-integral controller, with the usual noise.
fn recorded_plainly(
    nominal: &Parameters,
    machine: &Machine,
    experiment: &Experiment,
    dice: &mut Dice,
) -> WrittenColumns {
    let [kp, ki, bias] = GAINS;
    record(machine, &truth::recorder(nominal, kp, ki, bias), experiment, dice)
}

/// The k-th experiment of a seed, and the numbers that its noise is drawn from.
fn experiment_of(seed: u64, k: usize) -> (Experiment, Dice) {
    let mut dice = Dice::new(seed.wrapping_mul(31).wrapping_add(k as u64 + 1));
    (Experiment::new(KINDS[k], &mut dice), dice)
}

/// Returns a machine of [`case_of`] recorded under an exported controller; `None` for the effect conceals nothing.
pub fn case_under(which: Option<usize>, size: f64, nominal: &Parameters, controller: &Controller) -> Case {
    let mut machine = truth::machine(nominal);
    let (sealed, without) = match which {
        Some(which) => truth::conceal_one(which, size, &mut machine),
        None => (truth::unchanged_machine(), Vec::new()),
    };
    let recorder = truth::recorder(nominal, 0.0, 0.0, controller_at_rest(controller));
    let seed = 2_000 + which.map_or(999, |which| which as u64);
    let one = |machine: &Machine, k: usize| {
        let (experiment, mut dice) = experiment_of(seed, k);
        let mut runner = controller.runner();
        record_under(
            machine,
            &recorder,
            &mut |readings| step_of(&mut runner, readings),
            &experiment,
            &mut dice,
        )
    };
    let all = |machine: &Machine| (0..KINDS.len()).map(|k| one(machine, k)).collect::<Vec<WrittenColumns>>();
    Case { recordings: all(&machine), without: without.iter().map(all).collect(), sealed }
}

/// Runs a controller that takes no surge on the six readings of a recorder.
fn step_of(runner: &mut Runner, readings: &[f64; 6]) -> f64 {
    let [demand, hub, platform, accel, motor, position] = *readings;
    runner.step_array(&[demand, hub, platform, accel, motor, position, 0.0])
}

/// The control of a controller whose readings are all 0, V.
fn controller_at_rest(controller: &Controller) -> f64 {
    controller.runner().step_array(&[0.0; counterpoise_controller::READINGS])
}

/// One of the eight practice effects.
pub struct PracticeEffect {
    /// Name, as the practice machines have it.
    pub name: &'static str,
    /// Place in the vocabulary; `None` for the machine as modelled.
    pub which: Option<usize>,
}

/// The effects of the eight practice machines, in their order.
pub const PRACTICE: [PracticeEffect; 8] = [
    PracticeEffect { name: "Stribeck friction at the pivot", which: Some(2) },
    PracticeEffect { name: "backlash", which: Some(8) },
    PracticeEffect { name: "amplifier's gain curve", which: Some(23) },
    PracticeEffect { name: "out-of-balance", which: Some(12) },
    PracticeEffect { name: "cogging", which: Some(6) },
    PracticeEffect { name: "delay", which: Some(11) },
    PracticeEffect { name: "position stiffness", which: Some(14) },
    PracticeEffect { name: "none", which: None },
];
