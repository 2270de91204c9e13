//! The reference rig's beam against what its numbers are said to be.

use super::assert_close;
use counterpoise_models::reference::rig;
use counterpoise_models::structure::{
    ConfiguredStructure, FeOptions, Support, reduce_to_lumped, undamped_modes, with_derived_lumped,
};
use counterpoise_models::{Parameters, Plant, StructuralDamping};
use std::f64::consts::TAU;

#[test]
fn the_beam_has_the_stated_inertia_moment_and_frequencies() {
    let structure = ConfiguredStructure::new(&rig(), None).unwrap();
    let model = structure.build_fe_model(&FeOptions::default()).unwrap();
    assert_close(model.inertia_kg_m2(), 345.7, 0.05);
    assert_close(model.first_moment_kg_m(), 151.67, 0.005);
    assert_close(undamped_modes(&model, Support::Pinned).unwrap().flexible_rad_s()[0] / TAU, 37.9, 0.05);
    assert_close(undamped_modes(&model, Support::Clamped).unwrap().flexible_rad_s()[0] / TAU, 17.6, 0.05);
}

#[test]
fn frequencies_are_those_of_an_independent_program() {
    let model =
        ConfiguredStructure::new(&rig(), None).unwrap().build_fe_model(&FeOptions::default()).unwrap();
    let cases = [
        (Support::Free, [37.9218352, 106.059864, 211.282733, 358.175963]),
        (Support::Pinned, [37.9168922, 103.301924, 198.434032, 332.694206]),
        (Support::Clamped, [17.5562389, 70.44562388, 169.3579973, 315.53715035]),
    ];
    for (support, expected) in cases {
        let found = undamped_modes(&model, support).unwrap();
        for (w, hz) in found.flexible_rad_s().iter().zip(expected) {
            assert_close(w / TAU / hz, 1.0, 2e-4);
        }
    }
}

#[test]
fn the_derived_two_inertias_are_the_given_ones() {
    let rig = rig();
    let structure = ConfiguredStructure::new(&rig, None).unwrap();
    let derived = reduce_to_lumped(
        &structure.build_fe_model(&FeOptions::default()).unwrap(),
        &structure.beam.modal_damping,
    )
    .unwrap();
    let given = rig.lumped.clone().unwrap();
    for (derived, given, relative) in [
        (derived.hub_inertia_kg_m2, given.hub_inertia_kg_m2, 1e-3),
        (derived.beam_inertia_kg_m2, given.beam_inertia_kg_m2, 1e-3),
        (derived.stiffness_nm_rad, given.stiffness_nm_rad, 1e-3),
        (derived.damping_nm_s_rad, given.damping_nm_s_rad, 3e-3),
        (derived.out_of_balance_kg_m, given.out_of_balance_kg_m, 1e-4),
    ] {
        assert_close(derived / given, 1.0, relative);
    }
    let without = Parameters { lumped: None, ..rig };
    assert_eq!(with_derived_lumped(&without, &FeOptions::default()).unwrap().lumped, Some(derived));
}

#[test]
fn each_configuration_has_its_inertia_and_moment() {
    let rig = rig();
    for configuration in &rig.configurations {
        let model = ConfiguredStructure::new(&rig, Some(configuration))
            .unwrap()
            .build_fe_model(&FeOptions::default())
            .unwrap();
        let lumped = rig.with_configuration(configuration).unwrap().lumped.unwrap();
        let inertia = lumped.hub_inertia_kg_m2 + lumped.beam_inertia_kg_m2;
        assert_close(model.inertia_kg_m2() / inertia, 1.0, 3e-4);
        assert_close(model.first_moment_kg_m(), lumped.out_of_balance_kg_m, 0.01);
    }
}

#[test]
fn the_plant_takes_any_number_of_modes() {
    let rig = rig();
    let structure = ConfiguredStructure::new(&rig, None).unwrap();
    for count in [1, 3, 14, 40] {
        let pinned = structure.pinned_modes(&FeOptions::default(), count).unwrap();
        assert_eq!(pinned.body.modes.len(), count);
        assert!(Plant::with_body(&rig, pinned.body).is_ok());
    }
}

#[test]
fn damping_ratios_go_by_mode_and_the_last_holds_above() {
    let pinned =
        ConfiguredStructure::new(&rig(), None).unwrap().pinned_modes(&FeOptions::default(), 6).unwrap();
    let ratios: Vec<f64> = pinned.body.modes.iter().map(|m| m.damping_ratio).collect();
    assert_eq!(ratios, [0.010, 0.008, 0.008, 0.010, 0.010, 0.010]);
}

#[test]
fn the_damping_of_the_plant_follows_the_law_that_the_beam_names() {
    let ratios = |damping| {
        let mut structure = ConfiguredStructure::new(&rig(), None).unwrap();
        structure.beam.damping = damping;
        let pinned = structure.pinned_modes(&FeOptions::default(), 6).unwrap();
        pinned.body.modes.iter().map(|m| (m.frequency_rad_s, m.damping_ratio)).collect::<Vec<_>>()
    };
    let modal = ratios(StructuralDamping::Modal);
    let grown = ratios(StructuralDamping::ModalWithStiffness);
    for k in 0..6 {
        let expected = if k < 4 { modal[k].1 } else { 0.010 * modal[k].0 / modal[3].0 };
        assert_close(grown[k].1 / expected, 1.0, 1e-6);
    }
    let (first, second) = ([modal[0].0, 0.01], [modal[2].0, 0.03]);
    let rayleigh = ratios(StructuralDamping::Rayleigh { first, second });
    assert_close(rayleigh[0].1, 0.01, 1e-9);
    assert_close(rayleigh[2].1, 0.03, 1e-9);
    assert!(rayleigh[1].1 < 0.02 && rayleigh[5].1 > 0.03, "{rayleigh:?}");
}
