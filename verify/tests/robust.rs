//! Robustness: families, campaigns that do not depend on who runs them, and the search for the worst.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::support;

use counterpoise_verify::robustness::{
    Campaign, Distribution, Family, Layout, PointLayout, Sense, Variation, VariedParameter,
    compare_configurations, figures_of, merge_shards, one_at_a_time, rank_parameters, summarise_requirement,
    worst_case,
};
use counterpoise_verify::{Limit, PerformanceFigure, Procedure, Requirement, Value, verify};
use support::{controller, plant, rig};

fn short_procedure() -> Procedure {
    Procedure { duration_s: 1.0, settle_s: 0.3, ..Procedure::default() }
}

fn require(key: &str, limit: Limit) -> Requirement {
    Requirement::new(PerformanceFigure::from_key(key).unwrap(), limit).unwrap()
}

fn campaign(samples: usize) -> Campaign {
    let vary =
        |parameter, low, high| Variation { parameter, distribution: Distribution::Uniform { low, high } };
    let variations = vec![
        vary(VariedParameter::Inertia, 0.5, 2.0),
        vary(VariedParameter::TorqueConstant, 0.9, 1.1),
        vary(VariedParameter::Backlash, 0.0, 2.0),
    ];
    let requirements = vec![
        require("gain_margin_db", Limit::AtLeast(10.0)),
        require("nonlinear_both_compensated_hub_rms_rad_s", Limit::AtMost(0.04)),
    ];
    Campaign::new(
        rig(),
        controller(),
        short_procedure(),
        variations,
        requirements,
        Layout { samples, seed: 11, points: PointLayout::LatinHypercube },
    )
    .unwrap()
}

#[test]
fn a_few_figures_are_those_of_the_whole_verification() {
    let verified = verify(&plant(), &controller(), &short_procedure(), &[]).unwrap();
    let wanted: Vec<PerformanceFigure> =
        verified.verification().figures.iter().map(|measured| measured.figure).collect();
    let values = figures_of(&plant(), &controller(), &short_procedure(), &wanted).unwrap();
    for (measured, value) in verified.verification().figures.iter().zip(&values) {
        assert_eq!(&measured.value, value, "{}", measured.figure);
    }
}

#[test]
fn shards_in_any_order_give_the_same_bytes() {
    let campaign = campaign(12);
    let all: Vec<_> = (0..12).map(|index| campaign.run(index).unwrap()).collect();
    for shards in [1, 5, 12, 20] {
        let run = |shard| {
            campaign.shard(shard, shards).unwrap().map(|index| campaign.run(index).unwrap()).collect()
        };
        let parts: Vec<Vec<_>> = (0..shards).rev().map(run).collect();
        assert_eq!(merge_shards(&campaign, parts).unwrap(), all);
    }
    assert!(merge_shards(&campaign, vec![all.clone(), all[..1].to_vec()]).is_err());
    assert!(merge_shards(&campaign, vec![all[1..].to_vec()]).is_err());
    assert!(campaign.shard(5, 5).is_err());
}

#[test]
fn the_ranking_finds_what_matters_and_the_search_does_not_lose() {
    let campaign = campaign(24);
    let samples: Vec<_> = (0..24).map(|index| campaign.run(index).unwrap()).collect();
    let order = rank_parameters(&campaign, &samples, 0);
    assert_eq!(order[0].variation, 0, "inertia sets the gain margin: {order:?}");
    let backlash = order.iter().find(|ranked| ranked.variation == 2).unwrap();
    assert!(backlash.correlation.abs() < 0.5, "a gap is not in the linear loop");
    let overall = summarise_requirement(&campaign, &samples, 0);
    let worst = worst_case(&campaign, &samples, 0, 60).unwrap();
    assert!(worst.converged && worst.value <= overall.lowest, "{worst:?}");
    assert!(overall.interval.0 <= overall.share && overall.share <= overall.interval.1);
}

#[test]
fn families_and_configurations_are_measured() {
    let figures = [
        PerformanceFigure::from_key("phase_margin_deg").unwrap(),
        PerformanceFigure::from_key("nonlinear_step_overshoot_percent").unwrap(),
    ];
    let families = [Family { parameter: VariedParameter::Inertia, factors: vec![0.5, 1.0, 2.0] }];
    let members = one_at_a_time(&rig(), &controller(), &short_procedure(), &figures, &families).unwrap();
    assert_eq!(members.len(), 3);
    assert_eq!(members[1].values, figures_of(&plant(), &controller(), &short_procedure(), &figures).unwrap());
    let loaded = compare_configurations(&rig(), &controller(), &short_procedure(), &figures).unwrap();
    assert_eq!(loaded.len(), rig().configurations.len());
    assert!(loaded.iter().all(|member| matches!(member.values[0], Value::Is(margin) if margin > 0.0)));
}

/// A feedforward's rejection is spoilt by too much and by too little of what it was designed for.
#[test]
fn what_matters_in_either_direction_is_found() {
    let variations = vec![
        Variation {
            parameter: VariedParameter::Inertia,
            distribution: Distribution::Uniform { low: 0.9, high: 1.1 },
        },
        Variation {
            parameter: VariedParameter::TorqueConstant,
            distribution: Distribution::Uniform { low: 0.9, high: 1.1 },
        },
    ];
    let drr = require("heave_compensated_drr_db at 1 Hz", Limit::AtMost(-40.0));
    let layout = Layout { samples: 40, seed: 3, points: PointLayout::LatinHypercube };
    let campaign =
        Campaign::new(rig(), controller(), short_procedure(), variations, vec![drr], layout).unwrap();
    let samples: Vec<_> = (0..40).map(|index| campaign.run(index).unwrap()).collect();
    let order = rank_parameters(&campaign, &samples, 0);
    assert_eq!((order[0].variation, order[0].sense), (1, Sense::EitherWay), "{order:?}");
    assert!(order[0].correlation > 0.8, "{order:?}");
}
