//! Project files: what good ones mean, that writing and reading are inverse, and that edits leave the rest alone.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_linalg::sparse::VectorEntry;
use std::path::PathBuf;

use counterpoise_models::{
    Clock, Drift, FrictionLaw, Interpolation, LearnedElement, LearnedPlace, LearnedQuantity, LumpedStructure,
    MapPoint, Parameters, RegimeVariable, Ripple, Sensor, StribeckCurve, reference,
};
use counterpoise_project::resolve::controller::RecordingController;
use counterpoise_project::{Document, PlatformSource, Project, SettingValue, StructureChoice};
use counterpoise_recordings::{Channel, ChannelSource};
use counterpoise_synth::Weight;
use counterpoise_verify::{Limit, LoopFigure, PerformanceFigure, Requirement};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

const GOOD: &str = include_str!("data/rig.toml");

fn good() -> Project {
    Project::parse(GOOD, "rig.toml").unwrap().project
}

fn stored_file(path: &str) -> Vec<u8> {
    std::fs::read(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..").join(path)).unwrap()
}

/// Returns what writing and reading makes of a project.
fn again(project: &Project) -> Project {
    let text = project.to_text();
    match Project::parse(&text, "again.toml") {
        Ok(parsed) => parsed.project,
        Err(errors) => panic!("{}", errors.iter().map(|e| e.excerpt(&text)).collect::<Vec<_>>().join("\n")),
    }
}

#[test]
fn the_reference_file_is_the_reference_rig() {
    assert_eq!(good().plant, reference::rig());
}

#[test]
fn the_given_files_are_read_as_they_stand() {
    let practice = (1..=8).map(|n| format!("tests/data/practice/p{n:02}/project.toml"));
    for path in practice.chain(["tests/data/reference-rig.toml".to_owned()]) {
        let bytes = stored_file(&path);
        let parsed = Project::from_bytes(&bytes, &path).unwrap();
        let out_of_balance = parsed.project.plant.lumped.unwrap().out_of_balance_kg_m;
        let lightened = path.contains("p02") || path.contains("p03");
        assert_eq!(
            (out_of_balance, parsed.warnings.len()),
            if lightened { (20.0, 1) } else { (151.67, 0) },
            "{path}"
        );
        let controller = parsed
            .project
            .recording_controller
            .as_ref()
            .and_then(RecordingController::as_proportional_integral)
            .unwrap()
            .clone();
        assert_eq!(
            (controller.kp_v_s_rad, controller.ki_v_rad, controller.sample_period_s),
            (18.0, 80.0, 1e-3)
        );
    }
}

#[test]
fn design_sections_mean_what_they_say() {
    let project = good();
    let synth = project.synth.clone().unwrap().specification;
    let Weight::ZeroPoleGain { zeros, poles, gain } = &synth.feedback.error else {
        panic!("{:?}", synth.feedback.error)
    };
    assert_eq!((zeros[0].re, poles[0].re, *gain), (-18.0, 0.0, 25.0));
    assert_eq!(synth.feedback.control, Weight::Lead { gain: 1.0, time_s: 0.005 });
    assert_eq!(synth.feedback.disturbances, [VectorEntry::new(1, 3.6e-4)]);
    let generator = synth.heave.unwrap().generator;
    assert!((generator.magnitude(0.0) - 1.0).abs() < 1e-14);
    assert!((generator.magnitude(20.0) - 1.0 / 1.4).abs() < 1e-12, "{}", generator.magnitude(20.0));
    let verify = project.verify.unwrap();
    let margin =
        Requirement::new(PerformanceFigure::Loop(LoopFigure::GainMargin), Limit::AtLeast(12.0)).unwrap();
    assert_eq!((verify.requirements.len(), &verify.requirements[0]), (5, &margin));
    let Some(PlatformSource::Recording(road)) = verify.road else { panic!("the road is recorded") };
    assert_eq!(road.recording, "road.parquet");
    assert_eq!(project.model.structure, StructureChoice::Lumped);
}

#[test]
fn writing_and_reading_are_inverse() {
    let project = good();
    assert_eq!(again(&project), project);
    assert_eq!(again(&project).to_text(), project.to_text(), "the canonical text is a fixed point");
    let bare = Project { synth: None, verify: None, recording_controller: None, ..project };
    assert_eq!(again(&bare), bare);
}

/// Returns every field of the mechanism away from its usual value.
fn unusual() -> Parameters {
    let mut plant = reference::rig();
    let ripple = Ripple { amplitude: 0.16, order: 6.0, phase_rad: -0.7 };
    plant.gearbox.mesh_ripple = ripple;
    plant.gearbox.mesh_efficiency = 0.93;
    (plant.motor.cogging, plant.motor.torque_ripple, plant.motor.platform_coupling) = (ripple, ripple, -1.0);
    plant.amplifier.map =
        vec![MapPoint { input_v: 0.12, current_a: 0.27 }, MapPoint { input_v: 2.0, current_a: 6.0 }];
    (plant.amplifier.dead_zone_v, plant.amplifier.current_limit_a) = (0.05, 40.0);
    let friction = &mut plant.pivot_friction;
    (friction.static_ratio, friction.stribeck_rate_rad_s, friction.asymmetry) = (1.55, 0.012, -0.1);
    (friction.quadratic_nm_s2_rad2, friction.load_coefficient, friction.position_ripple) =
        (3.0, 0.02, ripple);
    (friction.warm_up, friction.warm_up_time_s) = (0.2, 30.0);
    let sensor = Sensor {
        gain: 0.98,
        bias: 1e-3,
        delay_s: 0.002,
        g_sensitivity: 1e-4,
        drift: Drift { angle_random_walk: 3e-5, bias_instability: 2e-5, rate_random_walk: 1e-6 },
        ..plant.sensors.hub_gyro.clone()
    };
    plant.sensors.hub_gyro = sensor;
    plant.sensors.accelerometer_lever_arm_m = 0.4;
    plant.sensors.motor_tachometer = None;
    plant.interface.output_delay_samples = 6;
    plant.interface.clock = Clock { jitter_s: 2e-5, missed_samples: 1e-3, late_samples: 0.01 };
    plant.interface.missing_codes = 0.02;
    let lumped: &mut LumpedStructure = plant.lumped.as_mut().unwrap();
    (lumped.position_stiffness_nm_rad, lumped.position_stiffness_centre_rad) = (900.0, -0.04);
    lumped.vertical_offset_kg_m = 3.0;
    plant.learned = free_functions(&plant);
    plant
}

/// Free functions at two joints and at the sensor of a machine's loop.
fn free_functions(plant: &Parameters) -> Vec<LearnedElement> {
    vec![
        LearnedElement {
            name: "tight spot".to_owned(),
            place: LearnedPlace::Pivot,
            quantity: LearnedQuantity::FrictionLevel,
            variable: RegimeVariable::Angle,
            interpolation: Interpolation::Linear,
            points: vec![-0.1, 0.0, 0.15],
            values: vec![1.0, 1.4, 1.1],
            half_width: vec![0.1, 0.02, 0.2],
            coverage: vec![0.25, 0.5, 0.25],
            ..LearnedElement::default()
        },
        LearnedElement {
            values: vec![2e-3, 0.0, -2e-3],
            interpolation: Interpolation::Linear,
            measured: plant.sensors.measured,
            ..LearnedElement::neutral(
                LearnedPlace::LoopSensor,
                LearnedQuantity::Error,
                RegimeVariable::Reading,
                vec![-2e-3, 0.0, 2e-3],
            )
        },
        LearnedElement {
            values: vec![0.01, -0.01],
            ..LearnedElement::neutral(
                LearnedPlace::Motor,
                LearnedQuantity::Torque,
                RegimeVariable::Turn,
                vec![0.0, 3.0],
            )
        },
    ]
}

#[test]
fn every_field_of_the_mechanism_is_written_and_read() {
    let project = Project { plant: unusual(), ..good() };
    assert_eq!(again(&project).plant, project.plant);
}

#[test]
fn every_law_of_friction_is_written_and_read() {
    let coulomb_nm = 3.0;
    let stribeck = |curve| FrictionLaw::Stribeck { coulomb_nm, curve };
    let laws = [
        FrictionLaw::None,
        FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad: 70.0, exponent: 1.5 },
        FrictionLaw::Lugre { coulomb_nm, bristle_stiffness_nm_rad: 1e5, bristle_damping_nm_s_rad: 316.0 },
        FrictionLaw::Coulomb { coulomb_nm },
        FrictionLaw::ResetIntegrator { coulomb_nm, deflection_rad: 1e-4, damping_nm_s_rad: 2.0 },
        stribeck(StribeckCurve::Tustin),
        stribeck(StribeckCurve::Gaussian),
        stribeck(StribeckCurve::Exponential { exponent: 0.5 }),
        stribeck(StribeckCurve::Lorentzian),
        stribeck(StribeckCurve::Polynomial { coefficients: [-1.0, 0.5, 0.1] }),
        FrictionLaw::Karnopp { coulomb_nm, stick_rate_rad_s: 1e-3 },
        FrictionLaw::Walrath { coulomb_nm, time_constant_s: 0.01, smoothing_rate_rad_s: 1e-3 },
        FrictionLaw::Bristle { coulomb_nm, bristles: 20, bond_rad: 1e-4 },
    ];
    for law in laws {
        let mut project = good();
        project.plant.motor_friction.law = law.clone();
        assert_eq!(again(&project).plant.motor_friction.law, law);
    }
}

#[test]
fn every_weight_is_written_and_read() {
    let simple = Weight::Notch { gain: 2.0, centre_rad_s: 110.0, width: 0.1, factor: 0.01 };
    let shelf = Weight::Shelf { low: 10.0, high: 0.1, corner_rad_s: 3.0 };
    let roots = |re, im| vec![counterpoise_linalg::C64::new(re, im), counterpoise_linalg::C64::new(re, -im)];
    let weights = [
        Weight::Constant { gain: 3.0 },
        Weight::Integral { gain: 200.0, time_s: 1.0 },
        Weight::Lag { gain: 2.0, time_s: 0.5 },
        Weight::Quadratic { gain: 0.1, second_s2: 1e-4, first_s: 0.03 },
        Weight::ZeroPoleGain { zeros: roots(-1.0, 3.0), poles: roots(-0.1, 7.0), gain: 4.0 },
        Weight::ZeroPoleGain { zeros: vec![], poles: roots(-0.123_456_789_123_4, 7.77), gain: 4.0 },
        Weight::Product(vec![simple.clone(), Weight::Product(vec![shelf, Weight::Constant { gain: 0.5 }])]),
        simple,
    ];
    for weight in weights {
        let mut project = good();
        project.synth.as_mut().unwrap().specification.feedback.error = weight.clone();
        assert_eq!(again(&project).synth.unwrap().specification.feedback.error, weight);
    }
}

#[test]
fn a_value_is_set_and_nothing_else_is_touched() {
    let document = Document::parse(GOOD, "rig.toml");
    let set = document.set("plant.gearbox.backlash", &SettingValue::Number(0.006)).unwrap();
    assert_eq!(set.text(), GOOD.replacen("backlash = 0.5e-3 ", "backlash = 0.006 ", 1));
    let moved = set.set("plant.beam.mass[2].position", &SettingValue::Number(-0.5)).unwrap();
    let changed: Vec<_> = moved.text().lines().zip(GOOD.lines()).filter(|(new, old)| new != old).collect();
    assert_eq!(changed.len(), 2);
    assert_eq!(changed[0].0, "position = -0.5");
    let back = moved.remove("plant.gearbox.backlash").unwrap();
    assert!(!back.text().contains("backlash ="));
}

#[test]
fn new_sections_and_items_are_made() {
    let document = Document::parse(GOOD, "rig.toml");
    let number = SettingValue::Number(0.16);
    let cogging = document.set("plant.motor.cogging.amplitude", &number).unwrap();
    let read = |d: &Document| Project::parse(d.text(), "rig.toml").unwrap().project;
    assert_eq!(read(&cogging).plant.motor.cogging.amplitude, 0.16);
    let named =
        document.set("plant.configuration[8].name", &SettingValue::Text("new \"one\"".to_owned())).unwrap();
    assert_eq!(read(&named).plant.configurations[8].name, "new \"one\"");
    let told = |path: &str| document.set(path, &number).unwrap_err().to_string();
    assert_eq!(
        told("plant.beam.mass[9].mass"),
        "\"plant.beam.mass[9].mass\": there is no item 9 in \"mass\" with its 5 items"
    );
    assert_eq!(told("plant.name.x"), "\"plant.name.x\": \"name\" is not a table");
    assert_eq!(told("plant..x"), "\"plant..x\" does not name a key");
}

#[test]
fn an_improved_project_changes_only_what_differs() {
    let (document, old) = (Document::parse(GOOD, "rig.toml"), good());
    assert_eq!(old.update(&document, &old).unwrap().text(), GOOD);
    let improved = Project { plant: unusual(), ..old.clone() };
    let saved = improved.update(&document, &old).unwrap();
    assert_eq!(values(Project::parse(saved.text(), "rig.toml").unwrap().project), values(improved));
    assert!(saved.text().contains("# --- drive train ---"), "comments stay");
    let mut other = old.clone();
    other.plant.configurations.remove(2);
    other.plant.beam.as_mut().unwrap().masses[0].mass_kg = 100.0;
    other.plant.pivot_friction.law = FrictionLaw::Coulomb { coulomb_nm: 100.0 };
    other.recording_controller = None;
    other.synth.as_mut().unwrap().specification.pitch = None;
    let saved = other.update(&document, &old).unwrap();
    assert_eq!(values(Project::parse(saved.text(), "rig.toml").unwrap().project), values(other.clone()));
    let restored = old.update(&saved, &other).unwrap();
    assert_eq!(values(Project::parse(restored.text(), "rig.toml").unwrap().project), values(old));
}

/// A project's values alone, without which of them its file states as their defaults.
fn values(project: Project) -> Project {
    Project { stated_defaults: std::collections::BTreeSet::new(), ..project }
}

#[test]
fn a_mapping_of_channels_is_written_and_read() {
    let text = GOOD.replacen(
        "[synth]",
        "[recording]\nsample_period = 0.002\n[recording.channels]\nhub_rate = \"w\"\ntime = \"t\"\n\
         control = { column = \"u\", unit = \"mV\", scale = -1, offset = 3 }\n\n[synth]",
        1,
    );
    let mapping = Project::parse(&text, "rig.toml").unwrap().project.recording;
    let control = ChannelSource {
        unit: Some("mV".to_owned()),
        scale: -1.0,
        offset: 3.0,
        ..ChannelSource::from_column("u")
    };
    assert_eq!(
        mapping.channels,
        [(Channel::Control, control), (Channel::HubRate, ChannelSource::from_column("w"))]
    );
    assert_eq!(
        (mapping.sample_period_s, mapping.time.as_ref().map(|t| t.column.as_str())),
        (Some(0.002), Some("t"))
    );
    let project = Project { recording: mapping.clone(), ..good() };
    assert_eq!(again(&project).recording, mapping);
}

/// Returns the project files that users are shown.
fn examples() -> Vec<String> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path().join("project.toml")).collect();
    files.sort();
    files.iter().filter_map(|file| std::fs::read_to_string(file).ok()).collect()
}

/// Returns a project file with one line less, or with the first number of a line another one.
fn alter_file(text: &str, place: f64, number: Option<f64>) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let at = ((lines.len() as f64 * place) as usize).min(lines.len() - 1);
    let Some(number) = number else {
        lines.remove(at);
        return lines.join("\n");
    };
    let Some((key, value)) = lines[at].split_once('=').map(|(k, v)| (k.to_owned(), v.to_owned())) else {
        return lines.join("\n");
    };
    let digit = |c: char| c.is_ascii_digit() || "+-.e".contains(c);
    if let Some(from) = value.find(|c: char| c.is_ascii_digit()) {
        let length = value[from..].find(|c| !digit(c)).unwrap_or(value.len() - from);
        lines[at] = format!("{key}={}{number:?}{}", &value[..from], &value[from + length..]);
    }
    lines.join("\n")
}

/// Returns the good file with a piece cut out, doubled, or overwritten.
fn damage_file(from: f64, length: usize, what: &str) -> String {
    let characters: Vec<char> = GOOD.chars().collect();
    let start = (from * characters.len() as f64) as usize;
    let end = (start + length).min(characters.len());
    characters[..start].iter().collect::<String>() + what + &characters[end..].iter().collect::<String>()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn a_damaged_file_never_panics(from in 0.0..1.0_f64, length in 0_usize..60, what in r#"[\[\]{}="'#.,a-z0-9 \n+-]{0,8}"#) {
        let text = damage_file(from, length, &what);
        match Project::parse(&text, "rig.toml") {
            Ok(parsed) => prop_assert_eq!(again(&parsed.project), parsed.project),
            Err(errors) => {
                prop_assert!(!errors.is_empty());
                let lines = text.lines().count().max(1) + 1;
                for error in errors {
                    prop_assert!((1..=lines).contains(&error.line) && error.column >= 1, "{}", error);
                }
            }
        }
    }

    #[test]
    fn a_changed_line_is_told_or_means_the_same_when_written(
        which in 0_usize..20,
        place in 0.0..1.0_f64,
        number in prop::option::of(prop::sample::select(vec![0.0, 1.0, -1.0, 0.5, 2.0, 3.0, 20.0, 1e3, 1e-6, 1e9])),
    ) {
        let texts = examples();
        if let Ok(parsed) = Project::parse(&alter_file(&texts[which % texts.len()], place, number), "rig.toml") {
            prop_assert_eq!(again(&parsed.project), parsed.project);
        }
    }

    #[test]
    fn noise_never_panics(text in "\\PC{0,200}") {
        let document = Document::parse(&text, "noise.toml");
        let _ = Project::parse(&text, "noise.toml");
        let _ = document.set("plant.gearbox.backlash", &SettingValue::Number(1.0));
        let _ = document.remove("plant.beam.mass[0]");
    }

    #[test]
    fn any_number_of_a_machine_survives_the_file(digits in 1.0..10.0f64, exponent in -40i32..40) {
        let value = digits * 10f64.powi(exponent);
        let mut project = good();
        project.plant.gearbox.backlash_rad = value;
        prop_assert_eq!(again(&project).plant.gearbox.backlash_rad, value);
    }
}
