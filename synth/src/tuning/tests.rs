#![allow(clippy::unwrap_used)]

use counterpoise_linalg::C64;
use counterpoise_linalg::sparse::VectorEntry;

use super::problem::Problem;
use super::*;
use crate::fixed_structure::{Block, BlockKind};
use crate::rational_function::RationalFunction;

/// A servo with drag and a structural mode: 40 (s^2/60^2 + ...) / ((s + 0.5)(s^2/80^2 + ...)).
fn servo(gain: f64, mode: f64) -> DesignPlant {
    let pair = |frequency: f64, damping: f64| {
        let im = frequency * (1.0 - damping * damping).sqrt();
        vec![C64::new(-damping * frequency, im), C64::new(-damping * frequency, -im)]
    };
    let mut poles = pair(mode, 0.02);
    poles.push(C64::new(-0.5, 0.0));
    let zeros = pair(0.75 * mode, 0.02);
    let system = RationalFunction::new(&zeros, &poles, gain * (4.0_f64 / 3.0).powi(2)).realise().unwrap();
    DesignPlant::ideal(system, 0, 0)
}

fn open_structure(kinds: &[BlockKind]) -> FixedStructure {
    FixedStructure { blocks: kinds.iter().map(|kind| Block::open(*kind)).collect() }
}

fn limits() -> LoopLimits {
    LoopLimits {
        max_sensitivity: 1.4,
        max_complementary: 1.25,
        gain_margin_db: 11.0,
        phase_margin_deg: 55.0,
        delay_margin_s: 0.01,
        noise_gain: 3.0,
        control_peak: 12.0,
        effort_v: 2.0,
        decay_rad_s: 0.5,
        damping: 0.3,
    }
}

const PI_LAG: [BlockKind; 2] = [BlockKind::ProportionalIntegral, BlockKind::LowPass];

#[test]
fn every_row_has_the_slope_of_differences() {
    let (structure, plants) = (open_structure(&PI_LAG), [servo(2.0, 80.0), servo(1.6, 90.0)]);
    let (sampling, disturbance) = (Sampling::new(2e-3, 10.0), Disturbance::of_band([1.0, 10.0]));
    let disturbance = Disturbance { reading_noise_rad_s: 0.3, ..disturbance };
    let task = TuningTask {
        subject: TuningSubject::Structure(&structure),
        plants: &plants,
        held: &[],
        sampling: &sampling,
        disturbance: &disturbance,
        limits: limits(),
        starts: 1,
        seed: 1,
    };
    let problem = Problem::new(&task).unwrap();
    let at: Vec<f64> = [4.0_f64, 2.0, 60.0].map(f64::ln).into();
    assert!(problem.is_stable(&at));
    let here = problem.evaluate(&at).unwrap();
    assert!(here.limits.len() >= 12, "{} rows", here.limits.len());
    for k in 0..at.len() {
        let moved = |sign: f64| {
            let mut at = at.clone();
            at[k] += sign * 1e-6;
            problem.evaluate(&at).unwrap()
        };
        let (above, below) = (moved(1.0), moved(-1.0));
        let rows = |e: &evaluation::Evaluation| [e.objectives.clone(), e.limits.clone()].concat();
        for ((row, up), down) in rows(&here).iter().zip(rows(&above)).zip(rows(&below)) {
            let difference = (up.value - down.value) / 2e-6;
            let slope = row.slope[k];
            assert!(
                (slope - difference).abs() < 1e-4 * (1.0 + difference.abs()),
                "{k}: {slope} against {difference}"
            );
        }
    }
}

#[test]
fn a_tuned_loop_keeps_its_limits_by_figures_of_another_path_and_beats_a_long_random_search() {
    let (structure, plants) = (open_structure(&PI_LAG), [servo(2.0, 80.0)]);
    let (sampling, disturbance) = (Sampling::new(2e-3, 10.0), Disturbance::of_band([1.0, 10.0]));
    let limits =
        LoopLimits { max_sensitivity: 1.4, max_complementary: 1.2, noise_gain: 3.0, ..LoopLimits::default() };
    let task = TuningTask {
        subject: TuningSubject::Structure(&structure),
        plants: &plants,
        held: &[],
        sampling: &sampling,
        disturbance: &disturbance,
        limits,
        starts: 6,
        seed: 1,
    };
    let tuned = tune_parameters(&task).unwrap();
    assert_eq!(tuned.missed, 0.0, "{:?}", tuned.measures);
    assert!(tuned.measures[0].max_sensitivity < 1.4 * 1.0002);
    let problem = Problem::new(&task).unwrap();
    let mut state = 7_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut best = f64::INFINITY;
    for _ in 0..20_000 {
        // Gain 0.3 to 30, corner 0.1 to 30 rad/s, lag 10 to 1000 rad/s: about the answer, to the search's advantage.
        let at: Vec<f64> = [[0.3_f64, 30.0], [0.1, 30.0], [10.0, 1000.0]]
            .map(|[a, b]| a.ln() + (b / a).ln() * random())
            .into();
        let found = problem.evaluate(&at).unwrap();
        if found.worst_exceedance() == 0.0 && found.objective().exp() < best && problem.is_stable(&at) {
            best = found.objective().exp();
        }
    }
    let answer = tuned.residual_rad_s();
    assert!(answer <= 1.0005 * best, "tuned {answer}, the best of 20000 random loops {best}");
    assert!(best < 1.3 * answer, "the search looked about the answer: {best} against {answer}");
}

#[test]
fn one_controller_for_two_plants_keeps_the_limits_on_both() {
    let plants = [servo(2.0, 80.0), servo(1.0, 60.0)];
    let (sampling, disturbance) = (Sampling::new(2e-3, 10.0), Disturbance::of_band([1.0, 10.0]));
    let structure = open_structure(&PI_LAG);
    let limits = LoopLimits { max_sensitivity: 1.4, max_complementary: 1.25, ..LoopLimits::default() };
    let task = |plants| TuningTask {
        subject: TuningSubject::Structure(&structure),
        plants,
        held: &[],
        sampling: &sampling,
        disturbance: &disturbance,
        limits,
        starts: 5,
        seed: 1,
    };
    let both = tune_parameters(&task(&plants[..])).unwrap();
    assert_eq!((both.missed, both.measures.len()), (0.0, 2));
    let first = tune_parameters(&task(&plants[..1])).unwrap();
    assert!(first.residual_rad_s() < both.residual_rad_s(), "one plant alone allows more");
}

#[test]
fn a_loop_holds_a_pendulum_that_the_plant_without_its_angle_does_not_show() {
    // 2 / (s + 0.5) and the same with gravity that topples it: 2 s / (s^2 + 0.5 s - 4).
    let poles = [C64::new(-0.5, 0.0), C64::new(-60.0, 0.0)];
    let plant = DesignPlant::ideal(RationalFunction::new(&[], &poles, 120.0).realise().unwrap(), 0, 0);
    let root = (0.0625_f64 + 4.0).sqrt();
    let toppling = [C64::new(-0.25 + root, 0.0), C64::new(-0.25 - root, 0.0), C64::new(-60.0, 0.0)];
    let held =
        DesignPlant::ideal(RationalFunction::new(&[C64::ZERO], &toppling, 120.0).realise().unwrap(), 0, 0);
    let (sampling, disturbance) = (Sampling::new(2e-3, 10.0), Disturbance::of_band([3.0, 10.0]));
    let (structure, plants) = (open_structure(&PI_LAG), [plant]);
    let task = |held| TuningTask {
        subject: TuningSubject::Structure(&structure),
        plants: &plants,
        held,
        sampling: &sampling,
        disturbance: &disturbance,
        limits: LoopLimits { max_sensitivity: 1.4, noise_gain: 1.5, ..LoopLimits::default() },
        starts: 6,
        seed: 1,
    };
    let pendulum = [held];
    let tuned = tune_parameters(&task(&pendulum[..])).unwrap();
    let problem_of_pendulum = task(&pendulum[..]);
    let problem = Problem::new(&problem_of_pendulum).unwrap();
    let values: Vec<f64> = tuned.structure().values().unwrap().concat().into_iter().map(f64::ln).collect();
    assert!(problem.is_stable(&values));
}

#[test]
fn fixed_parameters_stay_and_ranges_hold() {
    let mut structure = open_structure(&PI_LAG);
    structure.blocks[1].parameters[0] = crate::fixed_structure::BlockParameter::with_fixed_value(150.0);
    structure.blocks[0].parameters[1].range = Some([1.0, 2.0]);
    let plants = [servo(2.0, 80.0)];
    let (sampling, disturbance) = (Sampling::new(2e-3, 10.0), Disturbance::of_band([1.0, 10.0]));
    let limits = LoopLimits { max_sensitivity: 1.5, ..LoopLimits::default() };
    let task = TuningTask {
        subject: TuningSubject::Structure(&structure),
        plants: &plants,
        held: &[],
        sampling: &sampling,
        disturbance: &disturbance,
        limits,
        starts: 3,
        seed: 1,
    };
    let values = tune_parameters(&task).unwrap().structure().values().unwrap();
    assert_eq!(values[1][0], 150.0);
    assert!((1.0 - 1e-12..=2.0 + 1e-12).contains(&values[0][1]), "{values:?}");
    let all_fixed = tune_parameters(&task).unwrap().structure();
    let nothing_open = TuningTask { subject: TuningSubject::Structure(&all_fixed), ..task };
    assert!(matches!(tune_parameters(&nothing_open), Err(Error::System { .. })));
}

/// H2 weights for the servo: an integrating error weight, and white torque at the control.
fn servo_weights() -> Specification {
    use crate::{Assembly, LightModes, Reference, Weight};
    let feedback = FeedbackWeights {
        error: Weight::ZeroPoleGain { zeros: vec![C64::new(-3.0, 0.0)], poles: vec![C64::ZERO], gain: 3.0 },
        control: Weight::Lead { gain: 1.0, time_s: 0.01 },
        combination: Vec::new(),
        measurement_noise: 1e-4,
        disturbances: vec![VectorEntry::new(0, 1e-2)],
        loop_recovery: 1e-3,
        modes: LightModes::Kept,
    };
    let (assembly, reference) = (Assembly::SimpleAdd, Reference::Error);
    Specification { feedback, heave: None, pitch: None, assembly, reference, position_gain: None }
}

#[test]
fn tuned_weights_leave_less_than_a_tuned_pi_under_the_same_limits() {
    let plants = [servo(2.0, 80.0)];
    let (sampling, disturbance) = (Sampling::new(2e-3, 10.0), Disturbance::of_band([1.0, 10.0]));
    let limits = LoopLimits {
        max_sensitivity: 1.4,
        max_complementary: 1.25,
        noise_gain: 3.0,
        control_peak: 12.0,
        decay_rad_s: 0.5,
        ..LoopLimits::default()
    };
    let (structure, specification) = (open_structure(&PI_LAG), servo_weights());
    let tuned = |subject| {
        let task = TuningTask {
            subject,
            plants: &plants,
            held: &[],
            sampling: &sampling,
            disturbance: &disturbance,
            limits,
            starts: 8,
            seed: 1,
        };
        tune_parameters(&task).unwrap()
    };
    let pi = tuned(TuningSubject::Structure(&structure));
    let h2 = tuned(TuningSubject::Weights(&specification));
    assert_eq!((pi.missed, h2.missed), (0.0, 0.0));
    let (of_pi, of_h2) = (pi.residual_rad_s(), h2.residual_rad_s());
    assert!(of_h2 < 0.97 * of_pi, "H2 {of_h2}, PI {of_pi}");
    // The weights that are returned make the loop that was measured.
    let TunedFeedback::Weights(weights) = h2.feedback else { panic!("weights were tuned") };
    let again = Specification { feedback: *weights, ..servo_weights() };
    let made = crate::discretise(&crate::design(&plants[0], &again).unwrap(), &sampling).unwrap();
    let found = measure_controller(&plants[0], &made.controller, &sampling, &disturbance).unwrap();
    assert!((found.residual_rad_s / of_h2 - 1.0).abs() < 1e-9, "{} {of_h2}", found.residual_rad_s);
}

#[test]
fn weights_that_have_no_problem_of_their_own_are_refused() {
    let plants = [servo(2.0, 80.0)];
    let (sampling, disturbance) = (Sampling::new(2e-3, 10.0), Disturbance::of_band([1.0, 10.0]));
    let joint = Specification { assembly: crate::Assembly::Joint, ..servo_weights() };
    let apart = Specification { reference: crate::Reference::WeightOnly, ..servo_weights() };
    let mut noiseless = servo_weights();
    noiseless.feedback.measurement_noise = 0.0;
    for specification in [joint, apart, noiseless] {
        let task = TuningTask {
            subject: TuningSubject::Weights(&specification),
            plants: &plants,
            held: &[],
            sampling: &sampling,
            disturbance: &disturbance,
            limits: limits(),
            starts: 1,
            seed: 1,
        };
        assert!(matches!(tune_parameters(&task), Err(Error::System { .. })));
    }
}

/// Tunes a structure for a band on a servo.
fn tune_on_servo(structure: &FixedStructure, plant: DesignPlant, limits: LoopLimits) -> TunedDesign {
    let (sampling, disturbance) = (Sampling::new(2e-3, 10.0), Disturbance::of_band([1.0, 10.0]));
    let task = TuningTask {
        subject: TuningSubject::Structure(structure),
        plants: &[plant],
        held: &[],
        sampling: &sampling,
        disturbance: &disturbance,
        limits,
        starts: 6,
        seed: 1,
    };
    tune_parameters(&task).unwrap()
}

#[test]
fn an_answer_keeps_the_limits_if_any_start_does() {
    let structure = open_structure(&PI_LAG);
    let mut kept = 0;
    for (k, decay_rad_s) in [0.3, 1.0, 2.0, 4.0, 8.0].into_iter().enumerate() {
        for max_complementary in [1.02, 1.06, 1.2] {
            let limits = LoopLimits {
                max_sensitivity: 1.1 + 0.05 * k as f64,
                max_complementary,
                noise_gain: 1.5,
                decay_rad_s,
                ..LoopLimits::default()
            };
            let found = tune_on_servo(&structure, servo(2.0, 80.0), limits);
            if found.starts_rad_s.iter().any(|residual| residual.is_finite()) {
                kept += 1;
                assert_eq!(found.missed, 0.0, "{limits:?}: {found:?}");
            }
        }
    }
    assert!(kept >= 6, "{kept}");
}

#[test]
fn a_low_pass_whose_range_is_not_stated_costs_nothing() {
    let alone = open_structure(&[BlockKind::ProportionalIntegral]);
    for (rate, resonance) in [(2.0, 80.0), (0.4, 200.0), (10.0, 30.0)] {
        let limits = LoopLimits { max_sensitivity: 1.4, max_complementary: 1.4, ..LoopLimits::default() };
        let [without, with] = [&alone, &open_structure(&PI_LAG)]
            .map(|structure| tune_on_servo(structure, servo(rate, resonance), limits));
        assert!(with.residual_rad_s() < 1.005 * without.residual_rad_s(), "{with:?}\n{without:?}");
    }
}

#[test]
fn a_parameter_at_the_end_of_its_range_is_told() {
    let mut structure = open_structure(&PI_LAG);
    let limits = LoopLimits { max_sensitivity: 1.4, max_complementary: 1.4, ..LoopLimits::default() };
    let open = tune_on_servo(&structure, servo(2.0, 80.0), limits);
    assert!(open.range_ends.is_empty(), "{:?}", open.range_ends);
    structure.blocks[0].parameters[1].range = Some([0.01, 0.02]);
    structure.blocks[1].parameters[0].range = Some([20.0, 40.0]);
    let found = tune_on_servo(&structure, servo(2.0, 80.0), limits);
    let told: Vec<(usize, ParameterName)> =
        found.range_ends.iter().map(|end| (end.block, end.parameter)).collect();
    assert_eq!(told, [(0, ParameterName::Corner), (1, ParameterName::Frequency)], "{found:?}");
}
