//! The simulator's speed: `cargo bench -p counterpoise-simulate`.
//!
//! Ten seconds of the two-mass servo with three laws of friction at three stiffnesses (the rows of
//! `tests/peers/nonlinear/TABLE.md`; their ratio is the cost of the laws), of the reference rig with more and more modes, and of the
//! rig on a recorded road with noise; one point of a frequency response; variants of the rig side by side.
#![allow(missing_docs, non_snake_case, clippy::unwrap_used)]

mod two_mass;

use counterpoise_controller::ProportionalIntegral;
use counterpoise_models::plant::{Body, BodyMode};
use counterpoise_models::{FrictionLaw, OperatingPoint, Plant, reference};
use counterpoise_simulate::fra::{Settings, Test, TestSine, measure_point};
use counterpoise_simulate::{
    Detail, EnsembleRun, Imperfections, PlatformMotion, Scenario, Signal, Simulator, run_ensemble,
};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use two_mass::{Controller, scenario};

const FRICTIONS: [&str; 3] = ["Dahl", "LuGre", "reset integrator"];
const TIMES: [u32; 3] = [1, 20, 500];
/// Defect at which every row but the stiffest LuGre's is exact to 1e-5, but for the reset integrator's own corners.
const TOLERANCE: f64 = 1e-3;

fn servo(criterion: &mut Criterion) {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/benchmarks/peers/nonlinear/controller.txt");
    if Controller::read(file).is_err() {
        println!("skipped: {file} is absent");
        return;
    }
    let mut group = criterion.benchmark_group("two-mass servo");
    group.sample_size(20);
    for (law, friction) in FRICTIONS.into_iter().enumerate() {
        for (stiffness, times) in TIMES.into_iter().enumerate() {
            let plant = two_mass::plant(law as u32, stiffness as u32).unwrap();
            let scenario = Scenario { detail: Detail::Recording, ..scenario(&plant) };
            group.bench_function(BenchmarkId::new(friction, times), |bencher| {
                bencher.iter(|| {
                    let mut controller = Controller::read(file).unwrap();
                    Simulator::with_tolerance(&plant, TOLERANCE)
                        .unwrap()
                        .run(&mut controller, &scenario)
                        .unwrap()
                });
            });
        }
    }
    group.finish();
}

/// The rig with more modes.
fn flexible_rig(modes: u32) -> Plant {
    let rig = reference::rig();
    let mut body = Body::from_lumped(rig.lumped.as_ref().unwrap());
    body.modes.extend((2..=modes).map(|k| BodyMode {
        frequency_rad_s: 240.0 * f64::from(k * k),
        damping_ratio: 0.01,
        hub_shape: 0.05 / f64::from(k),
        tip_shape: -0.05,
        load_share_kg_m: 0.1 / f64::from(k),
    }));
    Plant::with_body(&rig, body).unwrap()
}

fn proportional_integral(plant: &Plant) -> ProportionalIntegral {
    ProportionalIntegral {
        kp_v_s_rad: 18.0,
        ki_v_rad: 80.0,
        bias_v: plant.equilibrium(&OperatingPoint::default()).control_v,
        sample_period_s: 1e-3,
        ..ProportionalIntegral::default()
    }
}

/// Ten seconds on a recorded road, as a replay has them, and a point of a frequency response.
fn rig(criterion: &mut Criterion) {
    let plant = Plant::from_lumped(&reference::rig()).unwrap();
    let controller = proportional_integral(&plant);
    let recorded = |amplitude: f64| Signal::Samples {
        period_s: 1e-3,
        values: (0..10_000)
            .map(|k| f64::from(k) * 1e-3)
            .map(|t| amplitude * ((8.0 * t).sin() + 0.5 * (21.0 * t).sin() + 0.2 * (55.0 * t).cos()))
            .collect(),
    };
    let scenario = Scenario {
        platform: PlatformMotion {
            pitch_rate_rad_s: recorded(0.1),
            heave_m_s2: recorded(0.5),
            ..PlatformMotion::STILL
        },
        imperfections: Imperfections::NoiseAndQuantisation { seed: 3 },
        detail: Detail::Recording,
        ..Scenario::at_rest(10.0)
    };
    let mut simulator = Simulator::new(&plant).unwrap();
    criterion.bench_function("recorded road with noise, ten seconds", |bencher| {
        bencher.iter(|| simulator.run(&mut controller.clone(), &scenario).unwrap());
    });
    criterion.bench_function("frequency response, one point", |bencher| {
        let at = TestSine { frequency_rad_s: 6.0, amplitude: 0.05 };
        let settings = Settings::default();
        bencher.iter(|| {
            measure_point(&plant, &mut controller.clone(), Test::PlatformToHub, at, &settings).unwrap()
        });
    });
}

fn modes(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("modes");
    group.sample_size(20);
    for modes in [1, 3, 14, 40] {
        let plant = flexible_rig(modes);
        let controller = proportional_integral(&plant);
        let scenario = Scenario {
            demand_rad_s: Signal::Triangle { amplitude: 0.1, period_s: 1.0 },
            platform: PlatformMotion { pitch_rate_rad_s: Signal::sine(0.1, 8.0), ..PlatformMotion::STILL },
            detail: Detail::Recording,
            ..Scenario::at_rest(10.0)
        };
        let mut simulator = Simulator::new(&plant).unwrap();
        group.bench_function(BenchmarkId::new("ten seconds", modes), |bencher| {
            bencher.iter(|| simulator.run(&mut controller.clone(), &scenario).unwrap());
        });
        group.bench_function(BenchmarkId::new("matrices", modes), |bencher| {
            let moment = Scenario { duration_s: 1e-3, ..scenario.clone() };
            bencher.iter(|| Simulator::new(&plant).unwrap().run(&mut controller.clone(), &moment).unwrap());
        });
    }
    group.finish();
}

/// Variants of the rig side by side and one after the other: with friction and gains of their own on one linear part, and with a linear part
/// of their own; under noise of their own, and without noise.
fn ensemble(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("ensemble, two seconds of eight variants");
    group.sample_size(20);
    for (name, stiffness, noise) in
        [("friction", 0.0, None), ("friction, noise", 0.0, Some(3)), ("linear part", 0.02, None)]
    {
        let plants: Vec<Plant> = (0..8).map(|k| varied_rig(f64::from(k), stiffness)).collect();
        let scenarios: Vec<Scenario> = (0..8).map(|k| road(noise.map(|seed| seed + k))).collect();
        let mut simulators: Vec<Simulator> =
            plants.iter().map(|plant| Simulator::new(plant).unwrap()).collect();
        let controllers: Vec<_> = plants.iter().map(proportional_integral).collect();
        group.bench_function(BenchmarkId::new(name, "one after the other"), |bencher| {
            bencher.iter(|| {
                for ((simulator, controller), scenario) in
                    simulators.iter_mut().zip(&controllers).zip(&scenarios)
                {
                    simulator.run(&mut controller.clone(), scenario).unwrap();
                }
            });
        });
        group.bench_function(BenchmarkId::new(name, "side by side"), |bencher| {
            bencher.iter(|| {
                let mut controllers = controllers.clone();
                let variants = simulators.iter_mut().zip(&mut controllers).zip(&scenarios);
                let mut variants: Vec<EnsembleRun> = variants
                    .map(|((simulator, controller), scenario)| EnsembleRun {
                        simulator,
                        controller,
                        scenario,
                        watch: None,
                    })
                    .collect();
                run_ensemble(&mut variants)
            });
        });
    }
    group.finish();
}

/// The rig with friction that differs by variant, and with a stiffness that does so by a share.
fn varied_rig(number: f64, stiffness: f64) -> Plant {
    let mut rig = reference::rig();
    if let FrictionLaw::Dahl { coulomb_nm, .. } = &mut rig.pivot_friction.law {
        *coulomb_nm *= 1.0 + 0.02 * number;
    }
    rig.gearbox.stiffness_nm_rad *= 1.0 + stiffness * number;
    Plant::from_lumped(&rig).unwrap()
}

/// Two seconds on a recorded road, with noise from a seed.
fn road(seed: Option<u64>) -> Scenario {
    let recorded = |amplitude: f64| Signal::Samples {
        period_s: 1e-3,
        values: (0..2_000)
            .map(|k| f64::from(k) * 1e-3)
            .map(|t| amplitude * ((8.0 * t).sin() + 0.5 * (21.0 * t).sin() + 0.2 * (55.0 * t).cos()))
            .collect(),
    };
    Scenario {
        platform: PlatformMotion {
            pitch_rate_rad_s: recorded(0.1),
            heave_m_s2: recorded(0.5),
            ..PlatformMotion::STILL
        },
        imperfections: seed.map_or(Imperfections::None, |seed| Imperfections::NoiseAndQuantisation { seed }),
        detail: Detail::Recording,
        ..Scenario::at_rest(2.0)
    }
}

criterion_group!(benches, servo, modes, rig, ensemble);
criterion_main!(benches);
