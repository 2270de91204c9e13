//! The complaints of users of other tools, one test each: stacked blocks that become unstabilisable, refusals without a
//! reason, searches that hang where nothing is feasible.
#![allow(clippy::unwrap_used, clippy::panic, non_snake_case)]

use counterpoise_linalg::Mat;
use counterpoise_lti::{NamedSystem, SignalTerm, StateSpace, Timebase, poles, series};
use counterpoise_synth::{
    Cause, Error, GeneralisedPlant, HiddenDirection, ModeBlock, NamedBlock, PlantCause, Ports, StateOrigin,
    h2syn, hinfsyn,
};

const CONTINUOUS: Timebase = Timebase::Continuous;

fn first_order(pole: f64, gain: f64) -> StateSpace {
    let one = |x: f64| Mat::diag(&[x]);
    StateSpace::new(one(pole), one(1.0), one(gain), one(0.0), CONTINUOUS).unwrap()
}

/// An unstable plant (its pole at +2) whose output is judged by two weights and measured with noise.
fn by_name() -> GeneralisedPlant {
    let plant = NamedSystem::new(first_order(2.0, 1.0), &["drive"], &["rate"]).unwrap();
    let drive =
        NamedSystem::sum("drive", &[SignalTerm::new(1.0, "u"), SignalTerm::new(1.0, "w")], CONTINUOUS)
            .unwrap();
    let slow = NamedSystem::new(first_order(-0.1, 3.0), &["rate"], &["z1"]).unwrap();
    let fast = NamedSystem::new(first_order(-40.0, 10.0), &["rate"], &["z2"]).unwrap();
    let effort = NamedSystem::sum("z3", &[SignalTerm::new(1.0, "u")], CONTINUOUS).unwrap();
    let sensor =
        NamedSystem::sum("y", &[SignalTerm::new(1.0, "rate"), SignalTerm::new(0.1, "n")], CONTINUOUS)
            .unwrap();
    let blocks = [
        NamedBlock { name: "plant", system: plant },
        NamedBlock { name: "sum of the drive", system: drive },
        NamedBlock { name: "slow weight", system: slow },
        NamedBlock { name: "fast weight", system: fast },
        NamedBlock { name: "effort", system: effort },
        NamedBlock { name: "sensor", system: sensor },
    ];
    let inputs = Ports { names: &["w", "n", "u"], of_controller: 1 };
    let outputs = Ports { names: &["z1", "z2", "z3", "y"], of_controller: 1 };
    GeneralisedPlant::connect_by_name(&blocks, inputs, outputs).unwrap()
}

/// The same written as other tools stack it: each row with a plant of its own.
fn stacked_system() -> StateSpace {
    let g = || first_order(2.0, 1.0);
    let rows = [series(&g(), &first_order(-0.1, 3.0)), series(&g(), &first_order(-40.0, 10.0)), Ok(g())];
    let all = rows.into_iter().map(Result::unwrap).reduce(|a, b| counterpoise_lti::append(&a, &b).unwrap());
    let all = all.unwrap();
    // One input for all three plants: (w, n, u); outputs z1, z2, z3 = u, y.
    let drive = Mat::from_rows(&[&[1.0, 0.0, 1.0], &[1.0, 0.0, 1.0], &[1.0, 0.0, 1.0]]);
    let zeros = Mat::zeros(1, all.order());
    let C = all.C.block(0, 0, 2, all.order()).vstack(&zeros).vstack(&all.C.block(2, 0, 1, all.order()));
    let mut D = Mat::zeros(4, 3);
    (D[(2, 2)], D[(3, 1)]) = (1.0, 0.1);
    StateSpace::new(all.A, &all.B * &drive, C, D, CONTINUOUS).unwrap()
}

fn causes(outcome: &Error) -> Vec<&Cause> {
    outcome.findings().iter().map(|finding| &finding.cause).collect()
}

#[test]
fn blocks_connected_by_name_share_their_plant() {
    let plant = by_name();
    assert_eq!(plant.system.order(), 3, "the plant's state is there once");
    let h2 = h2syn(&plant).unwrap();
    assert!(poles(&plant.close(&h2.controller).unwrap()).unwrap().iter().all(|pole| pole.re < 0.0));
    let hinf = hinfsyn(&plant, 1e-3).unwrap();
    assert!(hinf.achieved_norm <= hinf.bound * (1.0 + 1e-6));
}

#[test]
fn blocks_stacked_with_a_plant_each_are_refused_with_the_mode_that_is_there_thrice() {
    let copies = ["copy 1", "slow weight", "copy 2", "fast weight", "copy 3"];
    let origins = copies.map(|name| StateOrigin::new(name, 1)).to_vec();
    let plant = GeneralisedPlant::new(stacked_system(), 1, 1).unwrap().of_blocks(origins).unwrap();
    for found in [causes(&h2syn(&plant).err().unwrap()), causes(&hinfsyn(&plant, 1e-3).err().unwrap())] {
        assert!(
            found.iter().any(
                |cause| matches!(cause, Cause::Plant(PlantCause::ModeHidden { mode, from: HiddenDirection::Control, block: ModeBlock::Named(block), .. })
                if (mode - 2.0).norm() < 1e-6 && block.starts_with("copy"))
            ),
            "{found:?}"
        );
    }
}

/// x' = A x + w + B2 u, y = C2 x + n, both judged.
fn plain_plant(A: &Mat, B2: &Mat, C2: &Mat) -> GeneralisedPlant {
    let n = A.nrows();
    let (I, o) = (Mat::eye(n), Mat::zeros(n, 1));
    let B = I.hstack(&o).hstack(B2);
    let C = I.vstack(&o.t()).vstack(C2);
    let mut D = Mat::zeros(n + 2, n + 2);
    (D[(n, n + 1)], D[(n + 1, n)]) = (1.0, 1.0);
    let system = StateSpace::new(A.clone(), B, C, D, CONTINUOUS).unwrap();
    GeneralisedPlant::new(system, 1, 1).unwrap()
}

#[test]
fn a_mode_that_nothing_reaches_ends_the_search_at_once_and_is_named() {
    // An undamped oscillator at 7 rad/s beside the loop, and one that no output shows.
    let A = Mat::from_rows(&[&[-1.0, 0.0, 0.0], &[0.0, 0.0, 7.0], &[0.0, -7.0, 0.0]]);
    let (reached, seen) = (Mat::col(&[1.0, 0.0, 1.0]), Mat::row(&[1.0, 1.0, 0.0]));
    let (missed, unseen) = (Mat::col(&[1.0, 0.0, 0.0]), Mat::row(&[1.0, 0.0, 0.0]));
    for (B2, C2) in [(&missed, &seen), (&reached, &unseen)] {
        let plant = plain_plant(&A, B2, C2);
        let (h2, hinf) = (h2syn(&plant).err().unwrap(), hinfsyn(&plant, 1e-4).err().unwrap());
        assert!(h2.findings().len() + hinf.findings().len() >= 2);
        for finding in h2.findings().iter().chain(hinf.findings()) {
            let Cause::Plant(PlantCause::ModeHidden { mode, .. }) = finding.cause else {
                panic!("{finding:?}")
            };
            let rate = finding.rate_rad_s.unwrap();
            assert!((mode.im.abs() - 7.0).abs() < 1e-6 && (rate - 7.0).abs() < 1e-4, "{finding:?}");
        }
    }
    assert!(h2syn(&plain_plant(&A, &reached, &seen)).is_ok());
}

#[test]
fn a_mode_that_is_barely_reached_ends_within_the_trials() {
    for reach in [1e-3, 1e-6, 1e-9, 1e-12] {
        let plant = plain_plant(&Mat::diag(&[1.0, -2.0]), &Mat::col(&[reach, 1.0]), &Mat::row(&[1.0, 1.0]));
        match hinfsyn(&plant, 1e-3) {
            Ok(found) => {
                assert!(found.trials <= 200, "{reach:e}: {}", found.trials);
                assert!(found.closed_loop.iter().all(|pole| pole.re < 0.0), "{reach:e}");
                assert!(found.achieved_norm <= found.bound * (1.0 + 1e-6), "{reach:e}");
            }
            Err(why) => {
                assert!(reach < 1e-5 && !why.findings().is_empty(), "{reach:e}: {why:?}");
            }
        }
    }
}
