//! Variants that run side by side leave the bytes that each leaves alone.

use crate::common::RandomGenerator;
use counterpoise_controller::ProportionalIntegral;
use counterpoise_models::{Friction, FrictionLaw, OperatingPoint, Parameters, Plant, Ripple, reference};
use counterpoise_simulate::{
    Detail, EnsembleRun, Imperfections, Initial, PlatformMotion, Registers, RunObserver, Scenario, Signal,
    Simulator, TimeHistory, run_ensemble, run_ensemble_in,
};

/// The kinds of laws that take part: the last three never do.
fn law(kind: usize, coulomb_nm: f64, random: &mut RandomGenerator) -> FrictionLaw {
    let stiffness = coulomb_nm * 2000.0 * random.factor();
    match kind {
        0 => FrictionLaw::None,
        1 => FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad: stiffness, exponent: 1.0 },
        2 => FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad: stiffness, exponent: 1.5 },
        3 => FrictionLaw::Lugre {
            coulomb_nm,
            bristle_stiffness_nm_rad: stiffness,
            bristle_damping_nm_s_rad: 0.001 * stiffness * random.next(),
        },
        4 => FrictionLaw::ResetIntegrator {
            coulomb_nm,
            deflection_rad: 5e-4 * random.factor(),
            damping_nm_s_rad: 0.1 * coulomb_nm,
        },
        5 => FrictionLaw::Walrath { coulomb_nm, time_constant_s: 0.02, smoothing_rate_rad_s: 0.01 },
        _ => FrictionLaw::Coulomb { coulomb_nm },
    }
}

/// A kind of mechanism: what variants of it have in common.
#[derive(Clone, Copy)]
struct Kind {
    motor_law: usize,
    pivot_law: usize,
    falls: f64,
    gap: f64,
    extras: f64,
    rigid: f64,
}

fn kind(random: &mut RandomGenerator) -> Kind {
    Kind {
        motor_law: random.draw_below(7),
        pivot_law: random.draw_below(6),
        falls: random.next(),
        gap: random.next(),
        extras: random.next(),
        rigid: random.next(),
    }
}

fn variant(kind: Kind, random: &mut RandomGenerator) -> Parameters {
    let mut rig = reference::rig();
    let friction = |kind: Kind, number: usize, coulomb: f64, viscous: f64, random: &mut RandomGenerator| {
        let mut friction =
            Friction::with_viscous_part(law(number, coulomb * random.factor(), random), viscous);
        if kind.falls > 0.5 {
            friction.static_ratio = random.draw_between(1.0, 1.6);
            friction.stribeck_rate_rad_s = 0.02 * random.factor();
        }
        friction.asymmetry = if random.next() > 0.7 { random.draw_between(-0.2, 0.2) } else { 0.0 };
        friction
    };
    rig.motor_friction = friction(kind, kind.motor_law, 0.065, 0.002 * random.factor(), random);
    rig.pivot_friction = friction(kind, kind.pivot_law, 117.0, 60.0 * random.factor(), random);
    rig.gearbox.backlash_rad = if kind.gap > 0.5 { 0.5e-3 * random.factor() } else { 0.0 };
    rig.gearbox.stiffness_nm_rad *= random.factor();
    if kind.rigid > 0.8 {
        (rig.gearbox.stiffness_nm_rad, rig.gearbox.damping_nm_s_rad) = (f64::INFINITY, 0.0);
        rig.gearbox.backlash_rad = 0.0;
    }
    rig.amplifier.bus_voltage_v = if random.next() > 0.7 { 20.0 } else { 150.0 };
    if kind.extras > 0.6 {
        rig.motor.cogging = Ripple { amplitude: 0.05 * random.next(), ..rig.motor.cogging };
        rig.amplifier.current_limit_a = 30.0;
        rig.pivot_friction.quadratic_nm_s2_rad2 = 5.0;
    }
    let lumped = rig.lumped.as_mut().unwrap();
    lumped.beam_inertia_kg_m2 *= random.factor();
    lumped.vertical_offset_kg_m = 20.0 * random.next();
    rig
}

fn scenario(random: &mut RandomGenerator) -> Scenario {
    let recorded = (0..400).map(|k| 0.2 * (0.02 * f64::from(k)).sin() * random.next()).collect();
    let rate = match random.draw_below(3) {
        0 => Signal::sine(0.3 * random.next(), 60.0 * random.next()),
        1 => Signal::Samples { period_s: 1e-3, values: recorded },
        _ => Signal::ZERO,
    };
    Scenario {
        demand_rad_s: match random.draw_below(3) {
            0 => Signal::step(0.02, 0.4 * random.next()),
            1 => Signal::Triangle { amplitude: 0.1, period_s: 0.2 },
            _ => Signal::ZERO,
        },
        platform: PlatformMotion { pitch_rate_rad_s: rate, ..PlatformMotion::STILL },
        imperfections: match random.draw_below(3) {
            0 => Imperfections::NoiseAndQuantisation { seed: random.draw_below(5) as u64 },
            1 => Imperfections::Quantisation,
            _ => Imperfections::None,
        },
        initial: Initial::Rest { hub_angle_rad: random.draw_between(-0.2, 0.2) },
        detail: if random.next() > 0.5 { Detail::Everything } else { Detail::Recording },
        ..Scenario::at_rest(random.draw_between(0.1, 0.3))
    }
}

/// One run: its plant, its controller, its scenario.
type Run = (Plant, ProportionalIntegral, Scenario);

fn runs(random: &mut RandomGenerator, count: usize) -> Vec<Run> {
    let kind = kind(random);
    let shared = scenario(random);
    let shares = random.next() > 0.5;
    (0..count)
        .map(|_| {
            let plant = Plant::from_lumped(&variant(kind, random)).unwrap();
            let controller = ProportionalIntegral {
                kp_v_s_rad: 18.0 * random.factor(),
                ki_v_rad: 80.0 * random.factor(),
                bias_v: plant.equilibrium(&OperatingPoint::default()).control_v,
                sample_period_s: 1e-3,
                ..ProportionalIntegral::default()
            };
            let own = scenario(random);
            (
                plant,
                controller,
                if shares { Scenario { demand_rad_s: own.demand_rad_s, ..shared.clone() } } else { own },
            )
        })
        .collect()
}

fn run_alone((plant, controller, scenario): &Run) -> String {
    text(Simulator::new(plant).unwrap().run(&mut controller.clone(), scenario).as_ref())
}

fn run_together(registers: Registers, runs: &[Run]) -> Vec<String> {
    let mut simulators: Vec<Simulator> =
        runs.iter().map(|(plant, ..)| Simulator::new(plant).unwrap()).collect();
    let mut controllers: Vec<ProportionalIntegral> = runs.iter().map(|run| run.1.clone()).collect();
    let mut variants: Vec<EnsembleRun> = simulators
        .iter_mut()
        .zip(&mut controllers)
        .zip(runs)
        .map(|((simulator, controller), run)| EnsembleRun {
            simulator,
            controller,
            scenario: &run.2,
            watch: None,
        })
        .collect();
    run_ensemble_in(registers, &mut variants).iter().map(|result| text(result.as_ref())).collect()
}

/// Every number of a run as it is to be told from any other, the sign of 0 included.
fn text(history: Result<&TimeHistory, &counterpoise_simulate::Error>) -> String {
    format!("{history:?}")
}

#[test]
fn a_variant_leaves_the_same_bytes_alone_and_in_any_ensemble() {
    for seed in 1..=60 {
        let mut random = RandomGenerator(seed * 0x9e37_79b9_7f4a_7c15);
        let count = 1 + random.draw_below(9);
        let runs = runs(&mut random, count);
        let expected: Vec<String> = runs.iter().map(run_alone).collect();
        for registers in [Registers::Widest, Registers::Scalar] {
            let found = run_together(registers, &runs);
            for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
                assert!(found == expected, "seed {seed}, variant {k} of {count}, {registers:?}");
            }
        }
        let mut turned = runs.clone();
        turned.reverse();
        let found = run_together(Registers::Widest, &turned);
        assert!(found.iter().rev().eq(expected.iter()), "seed {seed}, in the opposite order");
    }
}

#[test]
fn a_watched_variant_ends_where_it_would_alone() {
    let mut random = RandomGenerator(7);
    let runs: Vec<Run> = runs(&mut random, 4);
    let mut simulators: Vec<Simulator> =
        runs.iter().map(|(plant, ..)| Simulator::new(plant).unwrap()).collect();
    let mut controllers: Vec<ProportionalIntegral> = runs.iter().map(|run| run.1.clone()).collect();
    let mut variants: Vec<EnsembleRun> = simulators
        .iter_mut()
        .zip(&mut controllers)
        .zip(&runs)
        .enumerate()
        .map(|(k, ((simulator, controller), run))| EnsembleRun {
            simulator,
            controller,
            scenario: &run.2,
            watch: Some(RunObserver {
                every: 10,
                goes_on: Box::new(move |seen| seen.control_v().len() < 20 * (k + 1)),
            }),
        })
        .collect();
    let lengths: Vec<usize> =
        run_ensemble(&mut variants).iter().map(|history| history.as_ref().unwrap().len()).collect();
    assert_eq!(lengths, [20, 40, 60, 80]);
}
