//! Blocks one by one: every law of friction, every way of learning the out-of-balance, the inverse of the drive's curve.
//! The generated C answers what the reference answers, to the last bit, in double and in single precision.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::support;

use std::process::Command;

use counterpoise_controller::{Controller, Estimator, Learning, ObserverLaw, Parts, PathSignal};
use counterpoise_export::ExportSource::Unverified;
use counterpoise_export::{CodeOptions, Precision, c99};
use support::{
    STRICT, Target, equal_to_the_last_bit, folder, is_there, provenance, reference, requests, run, server,
    typical_controller, write,
};

fn with(change: impl FnOnce(&mut Parts)) -> Controller {
    typical_controller().with(change).unwrap()
}

fn following_controller(law: ObserverLaw, level: &[[f64; 2]]) -> Controller {
    with(|parts| {
        parts.observers[0].law = law;
        parts.observers[0].level = level.to_vec();
    })
}

fn learning(learning: Learning, gravity_m_s2: f64, hold_samples: u32) -> Controller {
    with(|parts| {
        parts.transfer_time_s = 0.2;
        parts.estimator = Some(Estimator {
            learning,
            gravity_m_s2,
            rate: PathSignal::RelativeRate,
            half_rate_rad_s: 0.01,
            volts_per_kg_m_s2: 0.019 / 9.80665,
            rate_limit_kg_m_s: f64::INFINITY,
            hold_band_kg_m: 0.0,
            follow_samples: 0,
            hold_samples,
        });
    })
}

fn squares(filter_s: f64) -> Learning {
    Learning::Squares {
        forget: 0.998,
        dead_band_m_s2: 0.2,
        deviation: [0.3, 10.0, 10.0, 10.0],
        filter_s,
        inertia_v_s2_rad: [0.67, 0.31],
    }
}

fn every_block() -> Vec<Controller> {
    let level = [[0.0, 1.5], [0.01, 1.2], [0.03, 1.0]];
    let (sign_rate_rad_s, damping_nm_s_rad) = (5e-3, 250.0);
    vec![
        following_controller(ObserverLaw::Dahl, &level),
        following_controller(ObserverLaw::DahlPower { exponent: 1.5 }, &level),
        following_controller(ObserverLaw::Lugre { damping_nm_s_rad }, &level),
        following_controller(ObserverLaw::ResetIntegrator { static_ratio: 1.3, damping_nm_s_rad }, &[]),
        following_controller(ObserverLaw::Sliding { sign_rate_rad_s }, &level),
        following_controller(ObserverLaw::Walrath { sign_rate_rad_s, time_constant_s: 0.02 }, &[]),
        learning(Learning::Gradient { step: 0.3, scale: [0.02, 0.1, 0.1] }, 9.80665, 0),
        learning(Learning::Mean { window_samples: 100 }, 9.80665, 250),
        learning(squares(0.0), 9.80665, 0),
        learning(squares(0.02), 0.0, 0),
        with(|parts| parts.drive_curve = vec![[0.2, 0.5], [0.5, 0.8], [3.0, 3.0]]),
    ]
}

fn program(test: &str, controllers: &[Controller], precision: Precision) -> Target {
    let folder = folder(test);
    let mut sources = vec!["server.c".to_owned()];
    let names: Vec<String> = (0..controllers.len()).map(|i| format!("controller_{i}")).collect();
    for (controller, name) in controllers.iter().zip(&names) {
        let options = CodeOptions { name: name.clone(), precision };
        write(&folder, &c99(Unverified(controller), &provenance(), &options).unwrap());
        sources.push(format!("{name}.c"));
    }
    std::fs::write(folder.join("server.c"), server(&names)).unwrap();
    run(Command::new("cc").current_dir(&folder).args(STRICT).args(&sources).args(["-o", "server"]));
    Target::start(&folder.join("server"))
}

#[test]
fn each_block_is_equal_to_the_reference_to_the_last_bit() {
    if !is_there("cc") {
        return support::report_skip("no C compiler");
    }
    let controllers = every_block();
    let asked = requests(controllers.len(), 1500);
    let double = program("blocks_double", &controllers, Precision::Double).ask_all(&asked);
    assert!(double.iter().all(|volts| volts.is_finite()));
    equal_to_the_last_bit(&double, &reference::<f64>(&controllers, &asked));
    let single = program("blocks_single", &controllers, Precision::Single).ask_all(&asked);
    equal_to_the_last_bit(&single, &reference::<f32>(&controllers, &asked));
}
