#![allow(clippy::unwrap_used)]

use counterpoise_linalg::sparse::VectorEntry;
use counterpoise_pool::Serial;

use super::domination::{CandidateRating, select_survivors, thin_points};
use super::*;
use crate::fixed_structure::{Block, BlockKind};
use crate::rational_function::RationalFunction;
use crate::{
    Assembly, DesignPlant, Disturbance, FeedbackWeights, FixedStructure, LightModes, LoopLimits, Reference,
    Sampling, Specification, TuningSubject, Weight,
};
use counterpoise_linalg::C64;

fn points(rows: &[&[f64]]) -> Vec<Vec<f64>> {
    rows.iter().map(|row| row.to_vec()).collect()
}

#[test]
fn the_volume_of_few_points_is_that_of_their_boxes() {
    assert_eq!(hypervolume(&points(&[&[0.25]]), &[1.0]), 0.75);
    // Two boxes of 1 x 2 and 2 x 1 that share 1 x 1.
    assert_eq!(hypervolume(&points(&[&[1.0, 2.0], &[2.0, 1.0]]), &[3.0, 3.0]), 3.0);
    // All cells of 2 x 2 x 2 but the one in the corner.
    let three = points(&[&[1.0, 1.0, 2.0], &[1.0, 2.0, 1.0], &[2.0, 1.0, 1.0]]);
    assert_eq!(hypervolume(&three, &[3.0, 3.0, 3.0]), 7.0);
    assert_eq!(hypervolume(&points(&[&[4.0, 0.0]]), &[3.0, 3.0]), 0.0);
    assert_eq!(hypervolume(&[], &[3.0, 3.0]), 0.0);
}

#[test]
fn only_points_that_no_other_dominates_stay_and_of_equal_ones_the_first() {
    let costs = points(&[
        &[1.0, 3.0],
        &[2.0, 2.0],
        &[2.0, 2.0],
        &[3.0, 3.0],
        &[f64::NAN, 0.0],
        &[f64::INFINITY, 0.0],
    ]);
    assert_eq!(nondominated_places(&costs), [0, 1]);
    assert!(nondominated_places(&[]).is_empty());
}

#[test]
fn a_point_that_keeps_the_limits_survives_one_that_misses_them() {
    let rating = |cost: f64, missed: f64| CandidateRating { costs: vec![cost, -cost], missed };
    let all =
        [rating(0.0, f64::INFINITY), rating(1.0, 0.2), rating(2.0, 0.1), rating(9.0, 0.0), rating(5.0, 0.0)];
    assert_eq!(select_survivors(&all, 2), [3, 4]);
    assert_eq!(select_survivors(&all, 3), [3, 4, 2]);
    assert_eq!(select_survivors(&all, 9), [3, 4, 2, 1, 0]);
}

#[test]
fn few_points_that_stand_for_many_contain_the_least_of_every_cost() {
    let many: Vec<Vec<f64>> = (0..40).map(|k| vec![f64::from(k), f64::from((39 - k) * (39 - k))]).collect();
    let few = thin_points(&many, 5);
    assert_eq!(few.len(), 5);
    assert!(few.contains(&0) && few.contains(&39), "{few:?}");
    assert_eq!(thin_points(&many, 100).len(), 40);
    assert!(thin_points(&[], 3).is_empty());
}

/// A servo with drag and a structural mode.
fn servo() -> DesignPlant {
    let pair = |frequency: f64| {
        let im = frequency * (1.0 - 4e-4_f64).sqrt();
        vec![C64::new(-0.02 * frequency, im), C64::new(-0.02 * frequency, -im)]
    };
    let mut poles = pair(80.0);
    poles.push(C64::new(-0.5, 0.0));
    let system = RationalFunction::new(&pair(60.0), &poles, 2.0 * (4.0_f64 / 3.0).powi(2)).realise().unwrap();
    DesignPlant::ideal(system, 0, 0)
}

const TRADED: [FrontObjective; 3] =
    [FrontObjective::Residual, FrontObjective::NoiseGain, FrontObjective::MaxSensitivity];

struct Bench {
    plants: [DesignPlant; 1],
    sampling: Sampling,
    disturbance: Disturbance,
}

impl Bench {
    fn new() -> Self {
        Self {
            plants: [servo()],
            sampling: Sampling::new(2e-3, 10.0),
            disturbance: Disturbance { reading_noise_rad_s: 0.01, ..Disturbance::of_band([1.0, 10.0]) },
        }
    }

    fn task<'a>(
        &'a self,
        subject: TuningSubject<'a>,
        method: FrontMethod,
        evaluations: usize,
    ) -> FrontTask<'a> {
        let limits = LoopLimits { max_sensitivity: 2.0, max_complementary: 1.5, ..LoopLimits::default() };
        let tuning = TuningTask {
            subject,
            plants: &self.plants,
            held: &[],
            sampling: &self.sampling,
            disturbance: &self.disturbance,
            limits,
            starts: 1,
            seed: 1,
        };
        FrontTask { tuning, objectives: &TRADED, method, evaluations, points: 20 }
    }
}

fn pi_with_lag() -> FixedStructure {
    let kinds = [BlockKind::ProportionalIntegral, BlockKind::LowPass];
    FixedStructure { blocks: kinds.iter().map(|kind| Block::open(*kind)).collect() }
}

fn h2() -> Specification {
    let feedback = FeedbackWeights {
        error: Weight::Integral { gain: 10.0, time_s: 1.0 },
        control: Weight::Lead { gain: 1.0, time_s: 0.01 },
        combination: vec![],
        measurement_noise: 1e-4,
        disturbances: vec![VectorEntry::new(0, 1.0)],
        loop_recovery: 0.0,
        modes: LightModes::Kept,
    };
    Specification {
        feedback,
        heave: None,
        pitch: None,
        assembly: Assembly::SimpleAdd,
        reference: Reference::Error,
        position_gain: None,
    }
}

fn costs(front: &DesignFront) -> Vec<Vec<f64>> {
    front.points.iter().map(|point| point.costs(&TRADED)).collect()
}

#[test]
fn a_front_keeps_its_limits_and_dominates_more_than_as_many_designs_of_a_random_search_of_the_same_evaluations()
 {
    let (bench, structure) = (Bench::new(), pi_with_lag());
    let subject = TuningSubject::Structure(&structure);
    let found = search_front(&bench.task(subject, FrontMethod::Evolution, 1500), &Serial).unwrap();
    let drawn = search_front(&bench.task(subject, FrontMethod::Random, 1500), &Serial).unwrap();
    assert!(found.is_complete && found.points.len() >= 15, "{} points", found.points.len());
    assert!(found.evaluations < 2000, "{} evaluations", found.evaluations);
    for point in &found.points {
        let m = &point.measures[0];
        assert!(m.decay_rad_s > 0.0 && m.max_sensitivity < 2.002 && m.max_complementary < 1.502, "{m:?}");
        assert_eq!(point.figures, [m.residual_rad_s, m.noise_gain, m.max_sensitivity]);
    }
    let (ours, theirs) = (costs(&found), costs(&drawn));
    assert_eq!(nondominated_places(&ours).len(), ours.len());
    let worst = |k: usize| ours.iter().chain(&theirs).map(|point| point[k]).fold(f64::NEG_INFINITY, f64::max);
    let reference: Vec<f64> = (0..3).map(|k| worst(k) + 0.1).collect();
    let (here, there) = (hypervolume(&ours, &reference), hypervolume(&theirs, &reference));
    assert!(here > there, "{here} against {there} with {} points", theirs.len());
}

/// Runs the jobs from the last to the first.
struct ReversedPool;

impl Pool for ReversedPool {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        (0..count).rev().for_each(job);
    }

    fn processors(&self) -> usize {
        4
    }
}

#[test]
fn a_front_is_the_same_in_whatever_order_its_jobs_run() {
    let (bench, structure, specification) = (Bench::new(), pi_with_lag(), h2());
    for subject in [TuningSubject::Structure(&structure), TuningSubject::Weights(&specification)] {
        let task = bench.task(subject, FrontMethod::Evolution, 300);
        let (one, four) =
            (search_front(&task, &Serial).unwrap(), search_front(&task, &ReversedPool).unwrap());
        assert!(!one.points.is_empty());
        assert_eq!(one, four);
    }
}

#[test]
fn the_weights_of_a_front_are_those_of_its_feedback() {
    let (bench, specification) = (Bench::new(), h2());
    let task = bench.task(TuningSubject::Weights(&specification), FrontMethod::Evolution, 400);
    let found = search_front(&task, &Serial).unwrap();
    assert!(found.points.len() > 5);
    for point in found.points.iter().step_by(5) {
        let TunedFeedback::Weights(weights) = &point.feedback else { unreachable!() };
        let specification = Specification { feedback: (**weights).clone(), ..specification.clone() };
        let design = crate::design(&bench.plants[0], &specification).unwrap();
        let sampled = crate::discretise(&design, &bench.sampling).unwrap();
        let again = crate::measure_controller(
            &bench.plants[0],
            &sampled.controller,
            &bench.sampling,
            &bench.disturbance,
        )
        .unwrap();
        assert!((again.residual_rad_s / point.figures[0] - 1.0).abs() < 1e-9);
        assert!((again.noise_gain / point.figures[1] - 1.0).abs() < 1e-9);
    }
}

/// Is asked to stop from its third batch of jobs on.
struct StoppablePool(std::sync::atomic::AtomicUsize);

impl Pool for StoppablePool {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        self.0.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        (0..count).for_each(job);
    }

    fn is_cancelled(&self) -> bool {
        self.0.load(std::sync::atomic::Ordering::Relaxed) > 2
    }
}

#[test]
fn a_search_that_is_stopped_says_so() {
    let (bench, structure) = (Bench::new(), pi_with_lag());
    let task = bench.task(TuningSubject::Structure(&structure), FrontMethod::Evolution, 100_000);
    let found = search_front(&task, &StoppablePool(0.into())).unwrap();
    assert!(!found.is_complete && found.evaluations < 1000, "{}", found.evaluations);
}

#[test]
fn limits_that_no_loop_keeps_give_an_empty_front_and_a_bad_task_an_error() {
    let (bench, structure) = (Bench::new(), pi_with_lag());
    let subject = TuningSubject::Structure(&structure);
    let mut task = bench.task(subject, FrontMethod::Evolution, 300);
    task.tuning.limits = LoopLimits { noise_gain: 1e-9, gain_margin_db: 59.0, ..task.tuning.limits };
    assert!(search_front(&task, &Serial).unwrap().points.is_empty());
    let one = [FrontObjective::Residual];
    let twice = [FrontObjective::Residual, FrontObjective::Residual];
    for objectives in [&one[..], &twice[..], &[]] {
        let task = FrontTask { objectives, ..bench.task(subject, FrontMethod::Evolution, 10) };
        assert!(search_front(&task, &Serial).is_err());
    }
    let task = FrontTask { points: 0, ..bench.task(subject, FrontMethod::Evolution, 10) };
    assert!(search_front(&task, &Serial).is_err());
    let silent = Disturbance { lines: vec![], reading_noise_rad_s: 0.0 };
    let mut task = bench.task(subject, FrontMethod::Evolution, 10);
    task.tuning.disturbance = &silent;
    assert!(search_front(&task, &Serial).is_err());
}
