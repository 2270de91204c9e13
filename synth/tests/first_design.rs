//! Weights that are chosen for the highest bandwidth: they keep every limit, on plants of many kinds and sizes.
#![allow(non_snake_case, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use common::{plant as design_plant, rig};
use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase, margins};
use counterpoise_models::reference;
use counterpoise_synth::{
    Cause, Circumstances, ControlLimit, Design, DesignPlant, Error, FirstDesign, LimitKind, PlantCause,
    RequiredMargins, Sampling, Unknown, UsualPlants, UsualReading, design, discretise, first_design,
};

const CEILING: f64 = std::f64::consts::TAU / 20.0;

fn circumstances(plant: DesignPlant, sampling: Sampling) -> Circumstances {
    Circumstances {
        plant,
        load_output: None,
        others: Vec::new(),
        within_tolerances: Vec::new(),
        known_absent: Vec::new(),
        usual: UsualPlants::default(),
        usual_reading: UsualReading::default(),
        sampling,
        control_limit: ControlLimit::OfDrive,
        noise_rms: 0.0,
        reading_step: 0.0,
        holding_v: 0.0,
        demand_step: 0.0,
        margins: RequiredMargins::default(),
        may_stiffen_modes: true,
        position_gain: None,
        asked_rad_s: None,
        heave: None,
        pitch: None,
    }
}

/// Inertia with a drive: rate' = -drag rate + gain u.
fn servo(gain: f64, drag: f64) -> DesignPlant {
    let system = StateSpace::new(
        Mat::from_rows(&[&[-drag]]),
        Mat::from_rows(&[&[gain]]),
        Mat::eye(1),
        Mat::zeros(1, 1),
        Timebase::Continuous,
    );
    DesignPlant::ideal(system.unwrap(), 0, 0)
}

/// A position: angle'' = stiffness angle + gain u.
fn position(gain: f64, stiffness: f64) -> DesignPlant {
    let system = StateSpace::new(
        Mat::from_rows(&[&[0.0, 1.0], &[stiffness, 0.0]]),
        Mat::from_rows(&[&[0.0], &[gain]]),
        Mat::from_rows(&[&[1.0, 0.0]]),
        Mat::zeros(1, 1),
        Timebase::Continuous,
    );
    DesignPlant::ideal(system.unwrap(), 0, 0)
}

/// Checks the exported loop itself against what was stated.
fn check_exported_loop(given: &Circumstances) -> Result<FirstDesign, Error> {
    let found = first_design(given)?;
    let designed = design(&given.plant, &found.specification)?;
    let sampled = discretise(&designed, &given.sampling)?;
    let exported = margins(&sampled.loop_gain)?;
    assert!(exported.closed_loop_stable);
    let crossover = exported.phase.iter().map(|margin| margin.rate_rad_s).fold(0.0, f64::max);
    let required = given.margins;
    // Long delays are judged on a coarser grid.
    let near = if given.sampling.delay_samples > 24 { 3e-2 } else { 1e-3 };
    assert!((crossover / found.bandwidth.bandwidth_rad_s - 1.0).abs() < near, "{crossover} {found:?}");
    assert!(crossover <= CEILING / given.sampling.period_s, "{crossover}");
    assert!(crossover <= given.asked_rad_s.unwrap_or(f64::INFINITY));
    assert!(exported.gain_margin_db() >= required.gain_db - 1e-3, "{found:?}");
    assert!(exported.ms.value <= required.max_sensitivity * 1.001, "{found:?}");
    Ok(found)
}

#[test]
fn the_reference_rig_is_given_the_bandwidth_that_its_structure_allows() {
    let sampling = Sampling { out_of_balance_kg_m: 151.67, ..Sampling::new(1e-3, 10.0) };
    let given = Circumstances { noise_rms: 2e-4, demand_step: 0.1, ..circumstances(rig(), sampling) };
    let found = check_exported_loop(&given).unwrap();
    println!("{:?} {:?}", found.bandwidth, found.judgement);
    assert!(found.bandwidth.bandwidth_rad_s > 15.0 && found.bandwidth.unknown.is_empty());
}

#[test]
fn what_is_not_known_lowers_the_bandwidth() {
    let sampling = Sampling::new(1e-3, 10.0);
    let known = Circumstances { noise_rms: 1e-4, demand_step: 0.1, ..circumstances(rig(), sampling.clone()) };
    let all = check_exported_loop(&known).unwrap().bandwidth.bandwidth_rad_s;
    for less in [
        Circumstances { noise_rms: 0.0, ..known.clone() },
        Circumstances { demand_step: 0.0, ..known.clone() },
        Circumstances { control_limit: ControlLimit::OfConverter, ..known.clone() },
    ] {
        let found = check_exported_loop(&less).unwrap();
        assert!(found.bandwidth.bandwidth_rad_s <= all * 1.001 && !found.bandwidth.unknown.is_empty());
    }
    let nothing = check_exported_loop(&circumstances(servo(2.0, 0.0), sampling)).unwrap();
    println!("{:?}", nothing.bandwidth);
    assert_eq!(nothing.bandwidth.unknown.len(), 5);
    assert!(nothing.bandwidth.bandwidth_rad_s < 0.2 * CEILING / 1e-3);
    assert!(nothing.bandwidth.unknown.contains(&Unknown::Structure));
    assert_eq!(nothing.bandwidth.limited_by, [LimitKind::SampleRate]);
}

#[test]
fn the_bandwidth_does_not_depend_on_the_size_of_the_machine() {
    let mut all = Vec::new();
    for exponent in [-9, -6, -3, 0, 3, 6, 9] {
        let given = circumstances(servo(10f64.powi(exponent), 0.0), Sampling::new(1e-3, 10.0));
        all.push(check_exported_loop(&given).unwrap().bandwidth.bandwidth_rad_s);
    }
    println!("{all:?}");
    assert!(all.iter().all(|rate| (rate / all[0] - 1.0).abs() < 1e-3), "{all:?}");
}

#[test]
fn a_longer_delay_leaves_less_and_is_named() {
    let mut last = f64::INFINITY;
    for delay_s in [0.01, 0.03, 0.1] {
        let delay_samples = (delay_s / 1e-3) as usize;
        let plant = DesignPlant { delay_s, pade_order: 4, ..servo(2.0, 0.1) };
        let sampling = Sampling { delay_samples, ..Sampling::new(1e-3, 10.0) };
        let found = check_exported_loop(&circumstances(plant, sampling)).unwrap();
        println!("{delay_s} {:?} {:?}", found.bandwidth, found.judgement);
        assert!(found.bandwidth.bandwidth_rad_s < last && found.bandwidth.bandwidth_rad_s * delay_s < 1.0);
        assert!(found.bandwidth.bandwidth_rad_s * delay_s > 0.2);
        assert_eq!(found.bandwidth.limited_by, [LimitKind::Margins]);
        last = found.bandwidth.bandwidth_rad_s;
    }
}

#[test]
fn an_unstable_plant_is_held_or_said_to_be_out_of_reach() {
    let sampling = Sampling { delay_samples: 1, ..Sampling::new(1e-3, 10.0) };
    let found = check_exported_loop(&circumstances(position(3.0, 25.0), sampling.clone())).unwrap();
    println!("{:?} {:?}", found.bandwidth, found.judgement);
    assert!(found.bandwidth.bandwidth_rad_s > 10.0);
    let late = Sampling { delay_samples: 200, ..sampling };
    let plant = DesignPlant { delay_s: 0.2, pade_order: 4, ..position(3.0, 400.0) };
    let refused = first_design(&circumstances(plant, late)).unwrap_err();
    assert!(
        matches!(refused.findings()[0].cause, Cause::Plant(PlantCause::NoBandwidth { .. })),
        "{refused:?}"
    );
}

#[test]
fn positions_are_held_from_micrometres_to_kilometres() {
    for exponent in [-9, -3, 0, 3, 9] {
        let given = circumstances(position(10f64.powi(exponent), 0.0), Sampling::new(1e-3, 10.0));
        let found = check_exported_loop(&given).unwrap();
        println!("{exponent} {:?}", found.judgement);
    }
}

#[test]
fn noise_and_an_asked_bandwidth_lower_it() {
    let sampling = Sampling::new(1e-3, 10.0);
    let given = circumstances(design_plant(&reference::rig()), sampling);
    let quiet = check_exported_loop(&Circumstances { noise_rms: 1e-5, ..given.clone() }).unwrap().bandwidth;
    let loud = check_exported_loop(&Circumstances { noise_rms: 1.0, ..given.clone() }).unwrap().bandwidth;
    println!("{quiet:?} {loud:?}");
    assert!(loud.bandwidth_rad_s < quiet.bandwidth_rad_s);
    assert_eq!(loud.limited_by, [LimitKind::Noise]);
    let asked =
        check_exported_loop(&Circumstances { asked_rad_s: Some(10.0), noise_rms: 1e-5, ..given }).unwrap();
    println!("{:?}", asked.bandwidth);
    assert!((asked.bandwidth.bandwidth_rad_s / 10.0 - 1.0).abs() < 0.02);
    assert_eq!(asked.bandwidth.limited_by, [LimitKind::Asked]);
}

/// A motor that winds a spring up against a load on a spring of its own: outputs \[torque of the first spring, rate of the load\].
fn series_elastic(load_inertia: f64) -> DesignPlant {
    let (motor, spring, damping, support, drag) = (0.0825, 300.0, 0.2, 40.0, 0.3);
    let system = StateSpace::new(
        Mat::from_rows(&[
            &[-damping / motor, -spring / motor, damping / motor, 0.0],
            &[1.0, 0.0, -1.0, 0.0],
            &[
                damping / load_inertia,
                spring / load_inertia,
                -(damping + drag) / load_inertia,
                -support / load_inertia,
            ],
            &[0.0, 0.0, 1.0, 0.0],
        ]),
        Mat::col(&[4.0 / motor, 0.0, 0.0, 0.0]),
        Mat::from_rows(&[&[damping, spring, -damping, 0.0], &[0.0, 0.0, 1.0, 0.0]]),
        Mat::zeros(2, 1),
        Timebase::Continuous,
    );
    DesignPlant { delay_s: 1e-3, pade_order: 2, ..DesignPlant::ideal(system.unwrap(), 0, 0) }
}

#[test]
fn a_load_that_the_reading_does_not_show_is_damped_and_holds_for_other_loads() {
    let sampling = Sampling { delay_samples: 1, ..Sampling::new(1e-3, 10.0) };
    let blind = Circumstances { noise_rms: 0.05, ..circumstances(series_elastic(0.09), sampling) };
    let seen = Circumstances { load_output: Some(1), ..blind.clone() };
    let (without, with) = (check_exported_loop(&blind).unwrap(), check_exported_loop(&seen).unwrap());
    let rates = [&without, &with].map(|found| found.bandwidth.bandwidth_rad_s);
    println!("{rates:?}");
    assert!(rates[1] > 20.0 * rates[0], "{rates:?}");
    let designed = design(&seen.plant, &with.specification).unwrap();
    for factor in [0.7, 0.85, 1.15, 1.3] {
        let other = DesignPlant { system: series_elastic(0.09 * factor).system, ..designed.plant.clone() };
        let loop_gain =
            discretise(&Design { plant: other, ..designed.clone() }, &seen.sampling).unwrap().loop_gain;
        let found = margins(&loop_gain).unwrap();
        assert!(found.closed_loop_stable && found.ms.value < 2.0, "{factor}: {:?}", found.ms);
    }
}
