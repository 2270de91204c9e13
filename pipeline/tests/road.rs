//! The recorded motion of a platform: cut, filtered, scaled and centred before it drives a verification.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_pipeline::road::road_from_table;
use counterpoise_project::RoadSource;
use counterpoise_recordings::Table;

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
        Table::read(format!("time [s],az [m/s^2],wy [rad/s]\n{rows}").as_bytes(), "road.csv").unwrap();
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
    assert_eq!((made.sample_period_s, made.heave_m_s2.len(), made.heave_m_s2[0]), (0.01, 1001, 0.0));
    let at = |k: usize| (made.heave_m_s2[k], made.pitch_rate_rad_s[k]);
    let quarter = at(525);
    assert!((quarter.0 - 0.5).abs() < 2e-3 && (quarter.1 + 0.5).abs() < 2e-3, "{quarter:?}");
    let late = RoadSource { start_s: 15.0, ..source.clone() };
    let told = road_from_table(&late, &table).unwrap_err().to_string();
    assert_eq!(told, "road.csv: not usable as a road: 10 s from 15 s are asked for, but it is 20.00 s long");
    let sharp = RoadSource { low_pass_hz: Some(80.0), ..source };
    assert!(road_from_table(&sharp, &table).is_err());
}
