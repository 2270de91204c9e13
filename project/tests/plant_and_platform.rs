//! Structures, amplifiers and platforms of the project file: what is read is written, and what is wrong is told at its key.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_models::{AmplifierDynamics, SectionShape, StructuralDamping};
use counterpoise_project::{Attachments, Document, PlatformSource, Project, SettingValue};

const GOOD: &str = include_str!("data/rig.toml");

fn with(changes: &[(&str, SettingValue)]) -> Document {
    let start = Document::parse(GOOD, "rig.toml");
    changes.iter().fold(start, |document, (path, setting)| document.set(path, setting).unwrap())
}

fn resolve_project(document: &Document) -> Project {
    match Project::resolve(document, &Attachments::none()) {
        Ok(parsed) => parsed.project,
        Err(errors) => panic!("{errors:?}"),
    }
}

fn again(project: &Project) -> Project {
    resolve_project(&Document::parse(&project.to_text(), "again.toml"))
}

fn text(value: &str) -> SettingValue {
    SettingValue::Text(value.to_owned())
}

/// Returns what is said about a file.
fn error_texts(document: &Document, files: &Attachments) -> Vec<String> {
    let errors = Project::resolve(document, files).unwrap_err();
    errors.iter().map(|error| error.to_string().split_once("error: ").unwrap().1.to_owned()).collect()
}

/// What a data sheet says of a sensor on the motor is said of the motor's shaft; the loop has its readings divided by the ratio.
#[test]
fn a_sensor_on_the_motor_is_in_the_terms_of_its_shaft() {
    let rpm = std::f64::consts::TAU / 60.0;
    let file = |load: &str, sensor: &str| {
        format!(
            "format = 2\n[plant]\n{load}\nmotor = {{ inertia = 3e-4 }}\ndrive = {{ limit = 2.0 }}\n\
             sensors.{sensor}\ninterface = {{ sample_period = 1e-3 }}\n"
        )
    };
    let turning = "inertia = 2.0\ngearbox = { ratio = 120.0 }";
    let sliding = "axis = \"linear\"\nmass = 30.0\nball_screw = { lead = \"10 mm\" }";
    let radian_m = std::f64::consts::TAU / 0.01;
    for (load, ratio) in [(turning, 120.0), (sliding, radian_m)] {
        let sensor =
            "tachometer = { place = \"motor\", noise = \"2 rpm\", bias = \"0.5 rpm\", scale = 0.05 }";
        let project = resolve_project(&Document::parse(&file(load, sensor), "sensor.toml"));
        let found = &project.plant.sensors.hub_gyro;
        for (value, expected) in [
            (found.noise_rms, 2.0 * rpm / ratio),
            (found.bias, 0.5 * rpm / ratio),
            (found.scale_v_unit, 0.05 * ratio),
        ] {
            assert!((value / expected - 1.0).abs() < 1e-9, "{load}: {value}, not {expected}");
        }
        assert_eq!(again(&project).plant, project.plant, "{load}:\n{}", project.to_text());
        assert_eq!(again(&again(&project)).plant, project.plant, "{load}");
        let sensor = "resolver = { place = \"motor\", noise = \"1 mrad\" }";
        let resolver =
            resolve_project(&Document::parse(&file(load, sensor), "sensor.toml")).plant.sensors.hub_gyro;
        assert!((resolver.noise_rms * ratio / 1e-3 - 1.0).abs() < 1e-9, "{load}: {}", resolver.noise_rms);
        // the motor's own tachometer beside a sensor of the load
        let sensor = "motor_tachometer = { noise = \"3 rpm\" }";
        let beside = resolve_project(&Document::parse(&file(load, sensor), "sensor.toml"))
            .plant
            .sensors
            .motor_tachometer;
        assert!((beside.unwrap().noise_rms / (3.0 * rpm) - 1.0).abs() < 1e-9, "{load}");
    }
    let on_the_load = "tachometer = { noise = \"2 rpm\" }";
    let project = resolve_project(&Document::parse(&file(turning, on_the_load), "sensor.toml"));
    assert!((project.plant.sensors.hub_gyro.noise_rms / (2.0 * rpm) - 1.0).abs() < 1e-9);
}

/// A drive that takes a torque has its limit in N m whatever the motor's torque constant, and one that takes a current in A.
#[test]
fn a_limit_of_torque_is_one_whatever_the_torque_constant() {
    let file = |constant: f64, kind: &str, limit: &str| {
        format!(
            "format = 2\nplant.inertia = 2.0\nplant.motor = {{ torque_constant = {constant} }}\n\
             plant.drive = {{ kind = \"{kind}\", limit = {limit} }}\nplant.sensors.hub_gyro = {{ noise = 1e-4 }}\n\
             plant.interface = {{ sample_period = 1e-3 }}\n"
        )
    };
    let largest_nm = |project: &Project| {
        let (amplifier, motor) = (&project.plant.amplifier, &project.plant.motor);
        [10.0 * amplifier.gain, amplifier.current_limit_a]
            .map(|current_a| current_a * motor.torque_constant_nm_a)
    };
    for constant in [0.02, 0.2, 0.3, 1.0, 7.0] {
        for (kind, limit, expected_nm) in [
            ("torque", "2.0", 2.0),
            ("torque", "\"2 N m\"", 2.0),
            ("current", "2.0", 2.0 * constant),
            ("current", "\"2 A\"", 2.0 * constant),
        ] {
            let project = resolve_project(&Document::parse(&file(constant, kind, limit), "drive.toml"));
            for found in largest_nm(&project) {
                assert!((found / expected_nm - 1.0).abs() < 1e-12, "{constant} {kind} {limit}: {found}");
            }
            let written = project.to_text();
            assert!(written.contains(&format!("limit = {:?}", 2.0)), "{constant} {kind}:\n{written}");
            assert_eq!(written.contains("kind = \"current\""), kind == "current", "{written}");
            assert_eq!(again(&project).plant, project.plant, "{constant} {kind}");
        }
    }
}

#[test]
fn rectangles_and_laws_of_damping_survive_the_file() {
    let tube = "outer_diameter = [0.105, 0.070]\ninner_diameter = [0.050, 0.050]";
    let bar = "shape = \"rectangle\"\nheight = [0.1, 0.06]\nwidth = [0.05, 0.05]";
    assert!(GOOD.contains(tube));
    let barred = GOOD.replace(tube, bar);
    let rayleigh =
        "damping = \"rayleigh\"\nrayleigh_first = [100.0, 0.01]\nrayleigh_second = [900.0, 0.02] #";
    let project = resolve_project(&Document::parse(&barred.replace("modal_damping =", rayleigh), "rig.toml"));
    let beam = project.plant.beam.as_ref().unwrap();
    let expected = SectionShape::Rectangle { height_m: [0.1, 0.06], width_m: [0.05, 0.05] };
    assert_eq!(beam.sections[2].shape, expected);
    let law = StructuralDamping::Rayleigh { first: [100.0, 0.01], second: [900.0, 0.02] };
    assert_eq!((beam.damping, again(&project) == project), (law, true));
    let grown = resolve_project(&with(&[("plant.beam.damping", text("modal-stiffness"))]));
    assert_eq!(grown.plant.beam.as_ref().unwrap().damping, StructuralDamping::ModalWithStiffness);
    assert_eq!(again(&grown), grown);
}

#[test]
fn an_ideal_current_source_survives_the_file() {
    let project = resolve_project(&with(&[("plant.amplifier.dynamics", text("ideal-current"))]));
    assert_eq!(project.plant.amplifier.dynamics, AmplifierDynamics::IdealCurrent);
    assert_eq!(again(&project), project);
}

fn moving(changes: &[(&str, SettingValue)]) -> Document {
    let bare = Document::parse(GOOD, "rig.toml").remove("verify.road").unwrap();
    let path = |key: &str| format!("verify.road.{key}");
    changes.iter().fold(bare, |document, (key, setting)| document.set(&path(key), setting).unwrap())
}

#[test]
fn every_kind_of_motion_survives_the_file() {
    let psd = || SettingValue::Pairs(vec![[0.3, 0.02], [2.0, 0.1], [8.0, 1e-3]]);
    let kinds = [
        moving(&[("kind", text("spectrum")), ("heave_psd", psd()), ("seed", SettingValue::Whole(7))]),
        moving(&[("kind", text("simulator")), ("offset", SettingValue::Number(1.2)), ("pitch_psd", psd())]),
        moving(&[("kind", text("iso-8608")), ("class", text("D")), ("speed", SettingValue::Number(5.0))]),
    ];
    for document in kinds {
        let project = resolve_project(&document);
        assert_eq!(again(&project), project);
        let Some(PlatformSource::Made(motion)) = project.verify.unwrap().road else { panic!("it is made") };
        assert_eq!(motion.realisation.duration_s, 30.0);
    }
}

#[test]
fn motions_that_cannot_be_made_are_told_at_their_key() {
    let none = Attachments::none();
    let nothing = error_texts(&moving(&[("kind", text("spectrum"))]), &none);
    assert_eq!(
        nothing,
        [
            "verify.road.kind = \"spectrum\": has nothing that moves: give a density or, for the simulator, sines"
        ]
    );
    let falling = SettingValue::Pairs(vec![[2.0, 0.1], [1.0, 0.1]]);
    let told = error_texts(&moving(&[("kind", text("spectrum")), ("heave_psd", falling)]), &none);
    assert!(
        told[0].starts_with("verify.road.heave_psd") && told[0].contains("above the one before"),
        "{told:?}"
    );
    let psd = SettingValue::Pairs(vec![[1.0, 0.1], [2.0, 0.1]]);
    let long = [("kind", text("spectrum")), ("heave_psd", psd), ("fade", SettingValue::Number(20.0))];
    assert!(error_texts(&moving(&long), &none)[0].contains("at most half the duration of 30 s"));
    let missing = error_texts(&moving(&[("kind", text("spectrum")), ("heave_psd", text("road.csv"))]), &none);
    let told = "the file \"road.csv\" was not found in the folder of the project file";
    assert!(missing.iter().any(|line| line.contains(told)), "{missing:?}");
}

fn imported_document() -> Document {
    with(&[
        ("plant.import.mass_matrix", text("m.mtx")),
        ("plant.import.stiffness_matrix", text("k.mtx")),
        ("plant.import.node_map", text("nodes.map")),
        ("plant.import.modal_damping", SettingValue::Numbers(vec![0.01])),
    ])
}

/// Returns two nodes of a rigid bar, pivot at the first, with one spring between the rotations.
fn files(mass: &str, map: &str) -> Attachments {
    let head = "%%MatrixMarket matrix coordinate real symmetric\n4 4 ";
    let stiffness = format!("{head}3\n2 2 1e6\n4 2 -1e6\n4 4 1e6\n");
    let add = |all: Attachments, name: &str, text: &str| all.with(name, text.as_bytes().to_vec());
    let all = add(Attachments::none(), "m.mtx", mass);
    add(add(all, "k.mtx", &stiffness), "nodes.map", map)
}

const MASS: &str =
    "%%MatrixMarket matrix coordinate real symmetric\n4 4 4\n1 1 5.0\n2 2 3.0\n3 3 5.0\n4 4 3.0\n";
const MAP: &str = "axes 3 5\npivot 1\ntip 2\nnode 1 0.0\nnode 2 2.0\nrow 1 3\nrow 1 5\nrow 2 3\nrow 2 5\n";

#[test]
fn an_import_is_read_with_its_files_and_asks_for_them_by_name() {
    assert_eq!(imported_document().attachments(), ["k.mtx", "m.mtx", "nodes.map"]);
    let project = Project::resolve(&imported_document(), &files(MASS, MAP)).unwrap().project;
    let content = project.import.as_ref().unwrap().content.as_ref().unwrap();
    let structure = content.matrices.structure(&content.map).unwrap();
    assert_eq!((structure.mass_kg(), structure.first_moment_kg_m()), (10.0, 10.0));
    assert_eq!(structure.inertia_kg_m2(), 3.0 + 3.0 + 5.0 * 4.0);
}

#[test]
fn what_is_wrong_with_an_import_is_told_at_the_key_that_names_the_file() {
    let missing = error_texts(&imported_document(), &Attachments::none());
    assert!(missing[0].contains("plant.import.mass_matrix") || missing[0].contains("plant.import.node_map"));
    let broken = error_texts(&imported_document(), &files(&MASS.replace("2 2 3.0", "2 2 x"), MAP));
    assert_eq!(broken, ["plant.import.mass_matrix = \"m.mtx\": line 4: \"x\" is not a number"]);
    let lost = error_texts(&imported_document(), &files(MASS, &MAP.replace("pivot 1", "pivot 9")));
    assert!(
        lost[0].starts_with("plant.import.node_map = \"nodes.map\": does not fit the matrices"),
        "{lost:?}"
    );
    let undamped = imported_document().remove("plant.import.modal_damping").unwrap();
    let parsed = Project::resolve(&undamped, &files(MASS, MAP)).unwrap();
    assert!(parsed.assumptions.iter().any(|a| a.key == "plant.import.modal_damping"));
    assert_eq!(parsed.project.import.unwrap().modal_damping, [0.01], "the usual damping ratio");
    let absent = error_texts(&with(&[("model.structure", text("import"))]), &Attachments::none());
    assert!(absent[0].contains("needs the section [plant.import]"), "{absent:?}");
}

#[test]
fn a_gyroscope_is_no_sensor_of_a_slide() {
    let starter = include_str!("../src/starters/linear-axis.toml");
    let file = starter
        .replace("tachometer = { place = \"motor\", natural_frequency", "hub_gyro = { natural_frequency");
    let errors = error_texts(&Document::parse(&file, "slide.toml"), &Attachments::default());
    let told = |text: &String| text.contains("hub_gyro") && text.contains("no sensor of a slide");
    assert_eq!(errors.iter().filter(|text| told(text)).count(), 1, "{errors:?}");
    assert!(Project::resolve(&Document::parse(starter, "slide.toml"), &Attachments::default()).is_ok());
}
