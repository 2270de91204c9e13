//! The schedule over out-of-balance: the gain law where theory allows it, a redesign where it does not.
#![allow(clippy::unwrap_used, clippy::panic, non_snake_case)]

use crate::common;

use common::{plant, rig, weights};
use counterpoise_lti::response::response_at;
use counterpoise_models::reference;
use counterpoise_synth::{
    Design, DisturbanceChannel, HeaveFeedforwardLaw, Sampling, ScheduleConfiguration, ScheduleEntry, design,
    design_schedule, discretise_schedule, stabilisation_error,
};

fn nominal() -> ScheduleConfiguration {
    ScheduleConfiguration { name: "normal".into(), out_of_balance_kg_m: 151.67, plant: rig() }
}

/// The configurations of the reference rig, with masses fitted and inertia changed with them.
fn table() -> Vec<ScheduleConfiguration> {
    let rig = reference::rig();
    let fitted = rig.configurations.iter().map(|configuration| {
        let parameters = rig.with_configuration(configuration).unwrap();
        let out_of_balance_kg_m = parameters.lumped.as_ref().unwrap().out_of_balance_kg_m;
        ScheduleConfiguration {
            name: configuration.name.clone(),
            out_of_balance_kg_m,
            plant: plant(&parameters),
        }
    });
    fitted.collect()
}

/// The nominal plant with its heave column scaled: inertia kept.
fn same_inertia(factor: f64) -> ScheduleConfiguration {
    let mut plant = rig();
    for state in 0..plant.system.order() {
        plant.system.B[(state, 1)] *= factor;
    }
    ScheduleConfiguration { name: format!("{factor}"), out_of_balance_kg_m: 151.67 * factor, plant }
}

fn entries(others: &[ScheduleConfiguration]) -> Vec<ScheduleEntry> {
    design_schedule(&nominal(), others, &weights()).unwrap()
}

fn base() -> Design {
    design(&rig(), &weights()).unwrap()
}

#[test]
fn with_inertia_kept_the_gain_law_is_exact_and_said_to_be() {
    for entry in entries(&[same_inertia(0.37), same_inertia(1.48)]).iter().skip(1) {
        let factor = entry.out_of_balance_kg_m / 151.67;
        assert!(
            matches!(entry.law, HeaveFeedforwardLaw::ExactGain { factor: f } if (f - factor).abs() < 1e-12),
            "{:?}",
            entry.law
        );
        let heave = entry.heave_db.unwrap();
        let expected = 20.0 * factor.log10();
        assert!((heave.0 - expected).abs() < 1e-9 && (heave.1 - expected).abs() < 1e-9, "{heave:?}");
        assert!(entry.conditions.feedback_stays());
        for change in [entry.feedback_db, entry.pitch_db.unwrap()] {
            assert!(change.0.abs() < 1e-9 && change.1.abs() < 1e-9, "{change:?}");
        }
        let (law, after) = (entry.error_gain_law.unwrap(), entry.error_after.unwrap());
        assert!((law / after - 1.0).abs() < 1e-9, "{law} {after}");
    }
}

#[test]
fn with_the_masses_fitted_the_conditions_fail_and_the_deviation_is_measured() {
    let entries = entries(&table());
    for entry in entries.iter().filter(|entry| entry.name == "148 percent" || entry.name == "37 percent") {
        assert!(!entry.conditions.hold() && entry.conditions.path_deviation > 1e-3, "{:?}", entry.conditions);
        assert!(matches!(
            entry.law,
            HeaveFeedforwardLaw::NearlyGain { .. } | HeaveFeedforwardLaw::Redesign { .. }
        ));
        let (before, after) = (entry.error_before.unwrap(), entry.error_after.unwrap());
        assert!(after < 0.5 * before, "{}: {before} before, {after} after", entry.name);
        assert!(entry.feedback_db.1 - entry.feedback_db.0 < 6.0);
    }
}

#[test]
fn a_redesign_brings_the_error_back_to_its_share_of_the_out_of_balance() {
    let entries = entries(&table());
    let reference = entries[0].error_after.unwrap() / entries[0].out_of_balance_kg_m;
    for entry in entries.iter().filter(|entry| entry.out_of_balance_kg_m > 1.0) {
        let share = entry.error_after.unwrap() / entry.out_of_balance_kg_m / reference;
        assert!((0.5..2.0).contains(&share), "{}: {share}", entry.name);
    }
}

#[test]
fn heave_feedforward_all_but_removes_the_error_of_the_feedback() {
    let (design, plant) = (base(), rig());
    let with = stabilisation_error(&plant, &design, DisturbanceChannel::Heave, 1.0).unwrap();
    let without = stabilisation_error(&plant, &design, DisturbanceChannel::Heave, 0.0).unwrap();
    assert!(with < 0.2 * without, "{with} and {without}");
    let with = stabilisation_error(&plant, &design, DisturbanceChannel::Pitch, 1.0).unwrap();
    let without = stabilisation_error(&plant, &design, DisturbanceChannel::Pitch, 0.0).unwrap();
    assert!(with < 0.3 * without, "{with} and {without}");
}

#[test]
fn one_controller_carries_the_whole_schedule() {
    let entries: Vec<ScheduleEntry> = entries(&table())
        .into_iter()
        .filter(|e| ["normal", "37 percent", "148 percent"].contains(&e.name.as_str()))
        .collect();
    let entries = &entries[entries.len() - 3..];
    let sampling = Sampling { out_of_balance_kg_m: 151.67, ..Sampling::new(1e-3, 10.0) };
    let sampled = discretise_schedule(&base(), entries, &sampling).unwrap();
    for entry in entries {
        let linear = sampled.controller.linear(entry.out_of_balance_kg_m).unwrap();
        let expected = entry.design.feedforward_controller(DisturbanceChannel::Heave).unwrap();
        let (a, b) =
            (response_at(&linear, 5.0).unwrap()[(0, 3)], response_at(&expected, 5.0).unwrap()[(0, 0)]);
        assert!((a - b).norm() < 1e-4 * b.norm(), "{}: {a} {b}", entry.name);
    }
}
