//! Machines with physics that the library does not have: shapes drawn at random, a quarter with nothing concealed.

use counterpoise_models::Parameters;

use super::experiment::{Dice, WrittenColumns};
use super::machine::{FunctionTarget, FunctionVariable, HiddenFunction, Machine, Term};
use super::truth::machine;
use super::{KINDS, experiment_of, recorded_plainly};

/// Concealed function of a machine.
pub struct UnnamedMachine {
    /// The kind of shape.
    pub shape: &'static str,
    /// Recordings, one of each of [`KINDS`].
    pub recordings: Vec<WrittenColumns>,
}

/// The name of a machine without concealed physics.
pub const NOTHING: &str = "nothing";

/// The kinds of shape, in the order in which seeds go through them; every fourth seed conceals nothing.
pub const SHAPES: [&str; 12] = [
    "bump of the friction over the angle",
    "smooth friction over the angle",
    "hardening spring",
    "negative spring",
    "soft stops",
    "one-sided spring",
    "smooth torque over the angle",
    "drag with the cube of the rate",
    "torque constant over a turn",
    "friction that grows with time",
    "hardening gear",
    "hysteresis of elements that slip",
];

/// Returns the machine of a seed, recorded.
pub fn record_unnamed(seed: u64, nominal: &Parameters) -> UnnamedMachine {
    let mut made = machine(nominal);
    let mut dice = Dice::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0xf2ee);
    let shape = if seed.is_multiple_of(4) {
        NOTHING
    } else {
        let which = ((seed - seed / 4 - 1) % SHAPES.len() as u64) as usize;
        conceal(which, &mut made, &mut dice);
        SHAPES[which]
    };
    let one = |k: usize| {
        let (experiment, mut dice) = experiment_of(seed.wrapping_add(50_000), k);
        recorded_plainly(nominal, &made, &experiment, &mut dice)
    };
    UnnamedMachine { shape, recordings: (0..KINDS.len()).map(one).collect() }
}

/// A size spread evenly in its logarithm over a decade around one.
fn size(dice: &mut Dice) -> f64 {
    10f64.powf(dice.uniform(-0.5, 0.5))
}

/// A sum of sines with random phases: about a size, at some wave numbers.
fn smooth(dice: &mut Dice, size: f64, waves: [f64; 2]) -> Vec<Term> {
    let sine =
        |dice: &mut Dice| Term::Sine([0.5 * size, dice.uniform(waves[0], waves[1]), dice.uniform(-3.0, 3.0)]);
    (0..4).map(|_| sine(dice)).collect()
}

fn conceal(which: usize, m: &mut Machine, dice: &mut Dice) {
    let s = size(dice);
    let sign = if dice.draw_below(2) == 0 { 1.0 } else { -1.0 };
    let mut hide = |acts, over, terms| m.hidden.push(HiddenFunction { acts, over, terms });
    match which {
        0 => {
            let (centre, width) = (dice.uniform(-0.04, 0.04), dice.uniform(0.008, 0.03));
            hide(
                FunctionTarget::PivotLevel,
                FunctionVariable::Angle,
                vec![Term::Bump([0.8 * s, centre, width])],
            );
        }
        1 => hide(
            FunctionTarget::PivotLevel,
            FunctionVariable::Angle,
            smooth(dice, (0.4 * s).min(0.8), [15.0, 80.0]),
        ),
        2 => hide(FunctionTarget::PivotTorque, FunctionVariable::Angle, vec![Term::Power(-1.5e5 * s, 3)]),
        3 => hide(FunctionTarget::PivotTorque, FunctionVariable::Angle, vec![Term::Power(800.0 * s, 1)]),
        4 => {
            let stop = dice.uniform(0.02, 0.05);
            hide(
                FunctionTarget::PivotTorque,
                FunctionVariable::Angle,
                vec![Term::Stops([8e3 * s, stop, 0.006])],
            );
        }
        5 => {
            hide(FunctionTarget::PivotTorque, FunctionVariable::Angle, vec![Term::Power(1.5e4 * s * sign, 2)])
        }
        6 => hide(FunctionTarget::PivotTorque, FunctionVariable::Angle, smooth(dice, 60.0 * s, [10.0, 60.0])),
        7 => hide(FunctionTarget::PivotTorque, FunctionVariable::Rate, vec![Term::Power(-1.5e4 * s, 3)]),
        8 => {
            let wave = |dice: &mut Dice, n| Term::Sine([0.03 * s, n, dice.uniform(-3.0, 3.0)]);
            let terms = vec![wave(dice, 1.0), wave(dice, 2.0), wave(dice, 5.0)];
            hide(FunctionTarget::TorqueConstant, FunctionVariable::Shaft, terms);
        }
        9 => {
            let time = dice.uniform(0.8, 8.0);
            hide(FunctionTarget::PivotLevel, FunctionVariable::Time, vec![Term::Rise([0.6 * s, time])]);
        }
        10 => {
            hide(FunctionTarget::GearStiffness, FunctionVariable::Load, vec![Term::Power(4e-4 * s * sign, 1)])
        }
        _ => {
            let level = |k: usize| 25.0 * s * (1.0 + k as f64);
            m.slips = std::array::from_fn(|k| [level(k), level(k) / (0.004 * 2.5f64.powi(k as i32))]);
        }
    }
}
