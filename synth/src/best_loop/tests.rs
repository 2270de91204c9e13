#![allow(clippy::unwrap_used)]

use super::*;
use crate::fixed_structure::{Block, BlockKind, FixedStructure};
use crate::rational_function::RationalFunction;
use crate::tuning::{TuningTask, tune_parameters};

/// A servo with drag and a lag of the drive.
fn servo() -> DesignPlant {
    let poles = [C64::new(-0.5, 0.0), C64::new(-40.0, 0.0)];
    DesignPlant::ideal(RationalFunction::new(&[], &poles, 80.0).realise().unwrap(), 0, 0)
}

#[test]
fn no_tuned_controller_is_better_than_the_best_feedback_and_its_dual_closes_the_gap() {
    let plant = servo();
    let (sampling, disturbance) = (Sampling::new(5e-3, 10.0), Disturbance::of_band([1.0, 10.0]));
    let limits = LoopLimits {
        max_sensitivity: 1.4,
        max_complementary: 1.2,
        noise_gain: 4.0,
        control_peak: 15.0,
        ..LoopLimits::default()
    };
    let task = BestLoopTask { plant: &plant, sampling: &sampling, disturbance: &disturbance, limits };
    let best = best_loop(&task).unwrap();
    let slack = 1.0 + BEST_LOOP_LIMIT_KEPT;
    assert!(best.max_sensitivity <= 1.4 * slack && best.max_complementary <= 1.2 * slack);
    assert!(best.noise_gain <= 4.0 * slack && best.control_peak <= 15.0 * slack);
    assert!(best.lower_bound_rad_s <= best.residual_rad_s * (1.0 + 1e-6), "{best:?}");
    assert!(best.residual_rad_s <= 1.02 * best.lower_bound_rad_s, "{best:?}");
    let kinds = [BlockKind::ProportionalIntegral, BlockKind::Lead, BlockKind::LowPass];
    let structure = FixedStructure { blocks: kinds.into_iter().map(Block::open).collect() };
    let plants = [plant.clone()];
    let tuned = tune_parameters(&TuningTask {
        subject: crate::TuningSubject::Structure(&structure),
        plants: &plants,
        held: &[],
        sampling: &sampling,
        disturbance: &disturbance,
        limits,
        starts: 6,
        seed: 1,
    })
    .unwrap();
    assert_eq!(tuned.missed, 0.0);
    assert!(tuned.residual_rad_s() >= 0.999 * best.lower_bound_rad_s, "{} {best:?}", tuned.residual_rad_s());
    assert!(tuned.residual_rad_s() <= 2.0 * best.residual_rad_s, "{} {best:?}", tuned.residual_rad_s());
}

#[test]
fn limits_that_no_feedback_keeps_are_refused() {
    let plant = servo();
    let (sampling, disturbance) = (Sampling::new(5e-3, 10.0), Disturbance::of_band([1.0, 10.0]));
    // Integral action asks for |KS| of 1/P(0) = 0.25 at zero frequency.
    let limits = LoopLimits { control_peak: 0.1, ..LoopLimits::default() };
    let task = BestLoopTask { plant: &plant, sampling: &sampling, disturbance: &disturbance, limits };
    assert!(matches!(best_loop(&task), Err(Error::BestLoop(BestLoopProblem::Infeasible))));
}
