//! The motion of a platform: a recording is cut, filtered, scaled and centred before it drives a verification; numbers are realised.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_pipeline::road::{realise_motion, road_from_table};
use counterpoise_project::{
    Attachments, Document, GeneratedMotion, MotionKind, PlatformSource, Project, RoadSource,
};
use counterpoise_recordings::RecordingTable;
use counterpoise_verify::Road;

const RIG: &str = include_str!("../../project/tests/data/rig.toml");

/// Returns the motion that keys of `[verify.road]` describe, and what it is over time.
fn realise_road(keys: &str) -> (GeneratedMotion, Road) {
    let bare = Document::parse(RIG, "rig.toml").remove("verify.road").unwrap().text().to_owned();
    let document = Document::parse(&format!("{bare}\n[verify.road]\n{keys}\n"), "rig.toml");
    let project = Project::resolve(&document, &Attachments::none()).unwrap().project;
    let Some(PlatformSource::Made(motion)) = project.verify.unwrap().road else { panic!("it is made") };
    let road = realise_motion(&motion, 9.80665).unwrap();
    assert_eq!(road, realise_motion(&motion, 9.80665).unwrap(), "a seed repeats");
    (motion, road)
}

const PSD: &str = "[[0.3, 0.02], [2.0, 0.1], [8.0, 1e-3]]";

#[test]
fn every_kind_of_motion_is_realised_from_its_keys() {
    for keys in [
        format!("kind = \"spectrum\"\nheave_psd = {PSD}\nseed = 7"),
        format!("kind = \"simulator\"\noffset = 1.2\npitch_psd = {PSD}"),
        "kind = \"iso-8608\"\nclass = \"D\"\nspeed = 5.0".to_owned(),
    ] {
        let (motion, road) = realise_road(&keys);
        assert!(
            (road.duration_s() - 30.0).abs() < 1e-9
                && road.pitch_rate_rad_s().len() == road.heave_m_s2().len()
        );
        let still = matches!(&motion.kind, MotionKind::Spectrum { pitch_psd, .. } if pitch_psd.is_empty());
        assert_eq!(still, road.pitch_rate_rad_s().iter().all(|rate| *rate == 0.0));
    }
}

#[test]
fn bases_with_more_axes_than_heave_and_pitch_surge_and_roll() {
    let (_, road) = realise_road(
        "kind = \"six-axes\"\nsurge_sines = [[2.0, 0.5]]\nroll_psd = [[0.3, 0.01], [3.0, 0.01]]\ncoherence = 0.5\ntraverse_rate = 0.2",
    );
    assert!(road.surge_m_s2().iter().any(|surge| surge.abs() > 1.5));
    let sea = "kind = \"sea\"\nsignificant_height = 2.5\npeak_period = 8.8\nheading = \"135 deg\"\nlength = 100.0\nbeam = 14.0\n\
               draught = 4.5\nroll_period = 9.0\nship_speed = 7.0\npivot = [20.0, 0.0, 12.0]\nduration = 60.0";
    let (_, road) = realise_road(sea);
    assert!(road.roll_rate_rad_s().iter().any(|rate| rate.abs() > 0.005));
    let vehicle = "kind = \"iso-8608\"\nclass = \"D\"\nspeed = 8.0\nbody_mass = 9000.0\nduration = 20.0";
    assert!(realise_road(vehicle).1.surge_m_s2().is_empty());
    assert!(realise_road(&format!("{vehicle}\ntrack = 2.2\npivot_height = 1.0")).1.has_further_motion());
}

#[test]
fn a_road_is_cut_filtered_scaled_and_centred() {
    let rows: String = (0..2001)
        .map(|k| {
            let t = f64::from(k) * 0.01;
            let (slow, fast) = ((std::f64::consts::TAU * t).sin(), (std::f64::consts::TAU * 30.0 * t).sin());
            format!("{t},{},{}\n", 9.8 + slow + fast, 0.5 * slow)
        })
        .collect();
    let table =
        RecordingTable::read(format!("time [s],az [m/s^2],wy [rad/s]\n{rows}").as_bytes(), "road.csv")
            .unwrap();
    let source = RoadSource {
        recording: "road.csv".to_owned(),
        heave: "az".to_owned(),
        pitch: "wy".to_owned(),
        surge: String::new(),
        surge_scale: 1.0,
        heave_scale: 0.5,
        pitch_scale: -1.0,
        low_pass_hz: Some(5.0),
        start_s: 2.0,
        duration_s: 10.0,
        fade_s: 1.0,
    };
    let made = road_from_table(&source, &table).unwrap();
    assert_eq!((made.sample_period_s, made.heave_m_s2().len(), made.heave_m_s2()[0]), (0.01, 1001, 0.0));
    let at = |k: usize| (made.heave_m_s2()[k], made.pitch_rate_rad_s()[k]);
    let quarter = at(525);
    assert!((quarter.0 - 0.5).abs() < 2e-3 && (quarter.1 + 0.5).abs() < 2e-3, "{quarter:?}");
    let late = RoadSource { start_s: 15.0, ..source.clone() };
    let told = road_from_table(&late, &table).unwrap_err().to_string();
    assert_eq!(told, "road.csv: not usable as a road: 10 s from 15 s are asked for, but it is 20.00 s long");
    let sharp = RoadSource { low_pass_hz: Some(80.0), ..source };
    assert!(road_from_table(&sharp, &table).is_err());
}
