//! What a diagnosis finds in a drive is written into a file that states it as a drive, and read again as it was.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_models::{MapPoint, Parameters};
use counterpoise_project::{Attachments, Document, Project};

const MACHINE: &str = "format = 2\n[plant]\nname = \"axis\"\ninertia = 0.4\nMOTOR\nDRIVE\n\
    sensors = { hub_gyro = { natural_frequency = 300.0 } }\ninterface = { sample_period = 1e-3 }\n";
const MOTOR: &str = "motor = { inertia = 1e-4, torque_constant = 0.06, resistance = 0.6 }";

/// Changes a plant and returns the text of the file that was updated.
fn saved(text: &str, change: impl Fn(&mut Parameters)) -> String {
    let document = Document::parse(text, "machine.toml");
    let old = Project::resolve(&document, &Attachments::none()).unwrap().project;
    let mut new = old.clone();
    change(&mut new.plant);
    let updated = new.update(&document, &old).unwrap();
    let again =
        Project::resolve(&updated, &Attachments::none()).unwrap_or_else(|e| panic!("{e:?}\n{updated:?}"));
    assert_eq!(again.project.plant, new.plant, "{}", updated.text());
    updated.text().to_owned()
}

fn files(drives: &[&str]) -> Vec<String> {
    let one = |drive: &&str| MACHINE.replace("MOTOR", MOTOR).replace("DRIVE", drive);
    drives.iter().map(one).collect()
}

const VOLTAGE: [&str; 3] = [
    "drive = { kind = \"voltage\", limit = 14.49 }",
    "drive = { kind = \"voltage\" }",
    "drive = \"voltage\"",
];
const OTHERS: [&str; 5] = [
    "drive = { kind = \"current\", limit = 20.0, bandwidth = 800.0 }",
    "drive = { kind = \"current\", limit = 20.0 }",
    "drive = \"current\"",
    "drive = { kind = \"torque\", limit = 2.0 }",
    "drive = \"torque\"",
];

#[test]
fn every_drive_keeps_a_dead_zone_and_a_map() {
    let map = || vec![MapPoint { input_v: 0.5, current_a: 0.7 }, MapPoint { input_v: 2.0, current_a: 3.1 }];
    for text in files(&VOLTAGE).into_iter().chain(files(&OTHERS)) {
        let written = saved(&text, |plant| plant.amplifier.dead_zone_v = 0.143);
        assert!(written.contains("dead_zone = 0.143") && !written.contains("amplifier"), "{written}");
        let written = saved(&text, |plant| plant.amplifier.map = map());
        assert!(!written.contains("amplifier"), "{written}");
    }
}

#[test]
fn a_drive_that_takes_a_voltage_keeps_its_lag_and_its_largest_current() {
    for text in files(&VOLTAGE) {
        let written = saved(&text, |plant| {
            plant.amplifier.time_constant_s = 2.5e-3;
            plant.amplifier.current_limit_a = 9.5;
        });
        assert!(written.contains("current_limit = 9.5") && !written.contains("amplifier"), "{written}");
    }
}

#[test]
fn what_a_drive_cannot_state_makes_it_an_amplifier() {
    for text in files(&VOLTAGE) {
        let written = saved(&text, |plant| {
            plant.amplifier.gain = 1.7;
            plant.amplifier.current_feedback_v_a = 0.2;
            plant.amplifier.dead_zone_v = 0.1;
        });
        assert!(written.contains("[plant.amplifier]") && !written.contains("drive"), "{written}");
    }
}
