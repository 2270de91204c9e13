//! The joint optimum of feedback and feedforwards: certificates, and no other assembly is as good.
#![allow(clippy::unwrap_used, clippy::panic, non_snake_case)]

use crate::common;

use common::{rig, weights};
use counterpoise_synth::{
    Assembly, DisturbanceKnowledge, FeedforwardWeights, Sampling, Specification, design, design_feedback,
    discretise, joint_optimum,
};

/// Predicted and achieved cost agree, the loop is stable, and no gain of a part lowers the cost.
#[test]
fn the_joint_optimum_is_certified() {
    let found = joint_optimum(&rig(), &weights()).unwrap();
    println!("{:?} {:?} {}", found.cost, found.slopes, found.sylvester_residual);
    assert!(found.cost.relative_difference().unwrap() < 1e-7);
    assert!(found.closed_loop.iter().all(|pole| pole.re < 0.0));
    assert!(found.regulator.relative_residual < 1e-10 && found.filter.relative_residual < 1e-10);
    assert!(found.slopes.iter().all(|slope| slope.abs() < 1e-4), "{:?}", found.slopes);
    assert_eq!((found.controller.inputs(), found.controller.outputs()), (4, 2));
}

/// Without motions it is the feedback.
#[test]
fn without_motions_it_is_the_feedback() {
    let specification = Specification { heave: None, pitch: None, ..weights() };
    let joint = joint_optimum(&rig(), &specification).unwrap();
    let alone = design_feedback(&rig(), &specification.feedback, specification.reference).unwrap();
    let (a, b) = (joint.cost.achieved.unwrap(), alone.cost.achieved.unwrap());
    assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    assert!((&joint.controller.A - &alone.controller.A).norm_fro() < 1e-9 * alone.controller.A.norm_fro());
}

/// A motion that is measured less well costs more; one that is not measured costs most.
#[test]
fn better_sensors_cost_less() {
    let cost = |noise: f64| {
        let mut specification = weights();
        for part in [&mut specification.heave, &mut specification.pitch] {
            let weights: &mut FeedforwardWeights = part.as_mut().unwrap();
            let DisturbanceKnowledge::Measured { noise: usual } = weights.knowledge else {
                panic!("measured")
            };
            weights.knowledge = DisturbanceKnowledge::Measured { noise: noise * usual };
        }
        joint_optimum(&rig(), &specification).unwrap().cost.achieved.unwrap()
    };
    let costs: Vec<f64> = [1e-2, 1.0, 1e4, 1e8].into_iter().map(cost).collect();
    println!("{costs:?}");
    assert!(costs.windows(2).all(|pair| pair[0] < pair[1]), "{costs:?}");
}

/// As an assembly it runs: one path from all sensors, stable in sampled time.
#[test]
fn as_an_assembly_it_runs_in_sampled_time() {
    let specification = Specification { assembly: Assembly::Joint, ..weights() };
    let design = design(&rig(), &specification).unwrap();
    assert!(design.heave.is_none() && design.joint.is_some());
    let sampled = discretise(&design, &Sampling::new(1e-3, 10.0)).unwrap();
    let paths = &sampled.controller.parts().paths;
    assert_eq!((paths.len(), paths[0].inputs.len()), (1, 4));
    assert!(sampled.closed_loop.iter().all(|pole| pole.norm() < 1.0));
}
