//! The base's motion in six degrees of freedom, and the elevated accelerometer, in the project file.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_models::AccelerometerAxis;
use counterpoise_project::resolve::base_motion::UnitReading;
use counterpoise_project::{Attachments, Document, MotionKind, PlatformSource, Project};

const GOOD: &str = include_str!("data/rig.toml");

/// Returns the rig's file with other motion and other text put in.
fn file(motion: &str, changes: &[(&str, &str)]) -> String {
    let bare = Document::parse(GOOD, "rig.toml").remove("verify.road").unwrap().text().to_owned();
    let changed = changes.iter().fold(bare, |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    });
    format!("{changed}\n[verify.road]\n{motion}\n")
}

fn read(text: &str) -> Result<Project, Vec<String>> {
    let document = Document::parse(text, "rig.toml");
    match Project::resolve(&document, &Attachments::none()) {
        Ok(parsed) => Ok(parsed.project),
        Err(errors) => Err(errors.iter().map(ToString::to_string).collect()),
    }
}

fn error_text(text: &str) -> String {
    read(text).unwrap_err().join("\n")
}

const UNIT: &str = r#"kind = "inertial-unit"
recording = "drive.csv"
acceleration = ["ax", "ay", "az"]
rate = ["wx", "wy", "wz"]
reading = "acceleration"
mounting = [0.0, 0.1, 3.14]
lever_arm = [1.0, 0.0, -0.5]
traverse_angle = 0.3
duration = 20.0"#;

#[test]
fn every_source_of_motion_survives_the_file() {
    let six = "kind = \"six-axes\"\nsurge_sines = [[2.0, 0.5]]\nroll_psd = [[0.3, 0.01], [3.0, 0.01]]\ncoherence = 0.5\ntraverse_rate = 0.2";
    let surge = "recording = \"drive.csv\"\nheave = \"az\"\npitch = \"wy\"\nsurge = \"ax\"\nsurge_scale = -1.0\nduration = 10.0";
    for motion in [UNIT, six, surge] {
        let project = read(&file(motion, &[])).unwrap();
        assert_eq!(read(&project.to_text()).unwrap(), project, "{motion}");
        match project.verify.unwrap().road.unwrap() {
            PlatformSource::InertialUnit(unit) => {
                assert_eq!((unit.reading, unit.lever_arm_m), (UnitReading::Acceleration, [1.0, 0.0, -0.5]));
            }
            PlatformSource::Made(motion) => {
                let MotionKind::SixAxes(axes) = &motion.kind else { panic!("six axes") };
                assert_eq!((axes.coherence, axes.axes[0].sines.len(), axes.axes[3].psd.len()), (0.5, 1, 2));
            }
            PlatformSource::Recording(source) => {
                assert_eq!((source.surge.as_str(), source.surge_scale), ("ax", -1.0))
            }
        }
    }
}

const SEA: &str = r#"kind = "sea"
significant_height = "2.5 m"
peak_period = 8.8
waves = "jonswap"
heading = "135 deg"
length = 100.0
beam = 14.0
draught = 4.5
roll_period = 9.0
ship_speed = 7.0
pivot = [20.0, 0.0, 12.0]
duration = 60.0"#;

const FOUR_WHEELS: &str = "kind = \"iso-8608\"\nclass = \"D\"\nspeed = 8.0\nbody_mass = 9000.0\ntrack = 2.2\npivot_height = 1.0\nduration = 20.0";

#[test]
fn a_ship_and_a_vehicle_of_the_users_own_survive_the_file() {
    let project = read(&file(SEA, &[])).unwrap();
    assert_eq!(read(&project.to_text()).unwrap(), project);
    let Some(PlatformSource::Made(motion)) = project.verify.unwrap().road else { panic!("a sea") };
    let MotionKind::Sea(sea) = &motion.kind else { panic!("a sea") };
    assert!((sea.waves.heading_rad - 0.75 * std::f64::consts::PI).abs() < 1e-12);
    assert_eq!((sea.ship.pivot_m, sea.ship.roll_damping), ([20.0, 0.0, 12.0], 0.1));

    let project = read(&file(FOUR_WHEELS, &[])).unwrap();
    assert_eq!(read(&project.to_text()).unwrap(), project);
    let Some(PlatformSource::Made(motion)) = project.verify.unwrap().road else { panic!("a road") };
    let MotionKind::IsoRoad { vehicle, .. } = &motion.kind else { panic!("a road") };
    let sides = vehicle.sides.unwrap();
    assert_eq!((vehicle.body_mass_kg, sides.track_m, sides.pivot_height_m), (9000.0, 2.2, 1.0));
    assert!((sides.roll_inertia_kg_m2 - 9000.0 * 0.88 * 0.88).abs() < 1e-9);
    let flat = FOUR_WHEELS.replace("track = 2.2\n", "");
    assert!(
        error_text(&file(&flat, &[])).contains("has no effect without `track`"),
        "{}",
        error_text(&file(&flat, &[]))
    );
    let half = FOUR_WHEELS.replace("track = 2.2\npivot_height = 1.0\n", "");
    let Some(PlatformSource::Made(motion)) = read(&file(&half, &[])).unwrap().verify.unwrap().road else {
        panic!("a road")
    };
    let MotionKind::IsoRoad { vehicle, .. } = &motion.kind else { panic!("a road") };
    assert!(vehicle.sides.is_none());
}

#[test]
fn a_sea_that_cannot_be_is_told_at_its_height() {
    let steep = SEA.replace("8.8", "3.0");
    let told_of_it = error_text(&file(&steep, &[]));
    assert!(told_of_it.contains("verify.road.significant_height"), "{told_of_it}");
    assert!(told_of_it.contains("a seventh of the length"), "{told_of_it}");
    assert!(error_text(&file(&SEA.replace("beam = 14.0\n", ""), &[])).contains("verify.road.beam"));
    // where the kind is not stated, the keys say what is meant
    let unstated = SEA.replace("kind = \"sea\"\n", "");
    assert!(error_text(&file(&unstated, &[])).contains("\"sea\""), "{}", error_text(&file(&unstated, &[])));
}

#[test]
fn what_is_wrong_with_a_motion_is_told_at_its_key() {
    let two = UNIT.replace("\"ax\", \"ay\", \"az\"", "\"ax\", \"az\"");
    assert!(
        error_text(&file(&two, &[])).contains("must name three columns"),
        "{}",
        error_text(&file(&two, &[]))
    );
    let far = UNIT.replace("[1.0, 0.0, -0.5]", "[1.0, 0.0]");
    assert!(error_text(&file(&far, &[])).contains("lever_arm"));
    let nothing = "kind = \"six-axes\"";
    assert!(error_text(&file(nothing, &[])).contains("has nothing that moves"));
    let fast = "kind = \"six-axes\"\nyaw_sines = [[0.1, 90.0]]";
    assert!(error_text(&file(fast, &[])).contains("cannot be realised"), "{}", error_text(&file(fast, &[])));
}

#[test]
fn an_elevated_accelerometer_stands_at_the_pivot_of_a_hub_that_is_not_upright() {
    let section = "[plant.sensors.platform_accelerometer]";
    let elevated = format!("{section}\naxis = \"elevated\"");
    let project = read(&file(UNIT, &[(section, &elevated)])).unwrap();
    assert_eq!(project.plant.sensors.accelerometer_axis, AccelerometerAxis::Elevated);
    assert_eq!(read(&project.to_text()).unwrap(), project);
    let away = format!("{elevated}\nlever_arm = 0.4");
    assert!(error_text(&file(UNIT, &[(section, &away)])).contains("it stands at the pivot"));
}

#[test]
fn a_surge_accelerometer_needs_that_of_heave_and_an_angle() {
    let section = "[plant.sensors.platform_accelerometer]";
    let second = format!("[plant.sensors.surge_accelerometer]\nnoise = 5.0e-3\n\n{section}");
    let project = read(&file(UNIT, &[(section, &second)])).unwrap();
    assert_eq!(project.plant.sensors.surge_accelerometer.as_ref().unwrap().noise_rms, 5.0e-3);
    assert_eq!(read(&project.to_text()).unwrap(), project);
    let elevated = format!("{second}\naxis = \"elevated\"");
    assert!(
        error_text(&file(UNIT, &[(section, &elevated)]))
            .contains("needs [plant.sensors.platform_accelerometer]")
    );
    let steep =
        |angle: f64| file(UNIT, &[(section, &second)]) + &format!("\n[model]\nhub_angle = {angle:?}\n");
    assert!(error_text(&steep(1.5)).contains("within +/- 1.47 rad"), "{}", error_text(&steep(1.5)));
    assert!(
        error_text(&steep(0.6)).contains("within +/- 0.5 rad, where the resolver's converter ends"),
        "{}",
        error_text(&steep(0.6))
    );
}

#[test]
fn the_line_of_sight_survives_the_file() {
    let text = file(UNIT, &[]) + "\n[verify.line_of_sight]\nexposure = 0.005\n";
    let project = read(&text).unwrap();
    assert_eq!(project.verify.as_ref().unwrap().procedure.line_of_sight.unwrap().exposure_s, 0.005);
    assert_eq!(read(&project.to_text()).unwrap(), project);
    assert_eq!(read(&file(UNIT, &[])).unwrap().verify.unwrap().procedure.line_of_sight, None);
    let section = "[verify.line_of_sight]\nsettle = \"500 ms\"\n\
                   [verify.line_of_sight.coincidence]\nwindow = \"0.3 mrad\"\ndelay = 0.012\ntarget = 4e-4\n\
                   [verify.line_of_sight.optics]\nfocal_length = \"150 mm\"\nspatial_frequency = \"33 1/mm\"\n";
    let project = read(&format!("{}\n{section}", file(UNIT, &[]))).unwrap();
    let sight = project.verify.as_ref().unwrap().procedure.line_of_sight.unwrap();
    assert_eq!(sight.settle_s, Some(0.5));
    let coincidence = sight.coincidence.unwrap();
    assert!((coincidence.window_rad - 3e-4).abs() < 1e-15 && coincidence.dispersion_rad == 0.0);
    let optics = sight.optics.unwrap();
    assert!(
        (optics.focal_length_m - 0.15).abs() < 1e-15 && (optics.spatial_frequency_m - 3.3e4).abs() < 1e-9
    );
    assert_eq!(read(&project.to_text()).unwrap(), project);
    let without = section.replace("target = 4e-4\n", "");
    assert!(error_text(&format!("{}\n{without}", file(UNIT, &[]))).contains("target"));
    let negative = section.replace("window = \"0.3 mrad\"", "window = -1.0");
    assert!(error_text(&format!("{}\n{negative}", file(UNIT, &[]))).contains("above 0"));
}
