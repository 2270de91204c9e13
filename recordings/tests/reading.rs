//! Recordings: what is read, in which unit, on which clock; and what a damaged file is told.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::PathBuf;

use counterpoise_recordings::{
    Channel, ChannelSource, ChannelUnits, LoopQuantity, Mapping, Recording, RecordingTable, Remark, Travel,
    Unit,
};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn data(name: &str) -> Vec<u8> {
    std::fs::read(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)).unwrap()
}

fn read(text: &str) -> RecordingTable {
    RecordingTable::read(text.as_bytes(), "run.csv").unwrap()
}

fn refusal_text(text: &str) -> String {
    let table = RecordingTable::read(text.as_bytes(), "run.csv");
    table.and_then(|t| Mapping::default().apply(&t).map(|_| t)).unwrap_err().to_string()
}

fn channel(recording: &Recording, channel: Channel) -> &[f64] {
    recording.samples(channel).unwrap()
}

#[test]
fn units_in_si() {
    let size = |unit: &str| Unit::parse(unit).map(|u| u.factor);
    let close = |unit: &str, wanted: f64| {
        let found = size(unit).unwrap();
        assert!((found - wanted).abs() <= 1e-15 * wanted, "{unit}: {found} is not {wanted}");
    };
    close("rad/s", 1.0);
    close("deg/s", PI / 180.0);
    close("deg/s^2", PI / 180.0);
    close("°", PI / 180.0);
    close("mrad", 1e-3);
    close("rpm", TAU / 60.0);
    close("g", 9.80665);
    close("mg", 9.80665e-3);
    close("m/s²", 1.0);
    close("m/s2", 1.0);
    close("m s^-2", 1.0);
    close("mV", 1e-3);
    close("ms", 1e-3);
    close("min", 60.0);
    close("kN m", 1e3);
    close("N m s/rad", 1.0);
    close("kg m^2", 1.0);
    close("in/s", 0.0254);
    close("turns/s", TAU);
    close("oz in", 0.028_349_523_125 * 0.0254);
    close("count", 1.0);
    assert!(Unit::parse("N m").unwrap().is_like(&Unit::parse("kg m^2/s^2").unwrap()));
    assert!(Unit::parse("V").unwrap().is_like(&Unit::parse("ohm A").unwrap()));
    assert!(Unit::parse("H").unwrap().is_like(&Unit::parse("ohm s").unwrap()));
    assert!(!Unit::parse("rpm").unwrap().is_like(&Unit::parse("Hz").unwrap()));
    assert_eq!(size("dB"), None, "a level is no number");
    assert_eq!([size("furlong"), size("rad/"), size("m^x"), size("k")], [None, Some(1.0), None, None]);
}

#[test]
fn csv_with_units_comments_and_empty_cells() {
    let table =
        read("# a run\ntime [ms], hub_rate [deg/s], control [mV]\n0, 90, 1000\n1, , 2000\n2, -90, 3000\n");
    let record = Mapping::default().apply(&table).unwrap();
    assert_eq!(record.sample_period_s, 1e-3);
    let rate = channel(&record, Channel::HubRate);
    assert_eq!((rate[0], rate[2]), (FRAC_PI_2, -FRAC_PI_2));
    assert!(rate[1].is_nan());
    assert_eq!(channel(&record, Channel::Control), [1.0, 2.0, 3.0]);
    assert_eq!(record.remarks, [Remark::Missing { channel: Channel::HubRate, samples: 1, first_row: 2 }]);
}

#[test]
fn csv_with_semicolons_and_decimal_commas() {
    let table = read("\u{feff}time [s];control [V]\r\n0,0;1,5\r\n0,5;2,5\r\n1,0;-3,5\r\n");
    assert_eq!(table.column("control").unwrap().values.to_vec(), [1.5, 2.5, -3.5]);
    assert_eq!(table.column("time").unwrap().values.to_vec(), [0.0, 0.5, 1.0]);
}

#[test]
fn damaged_csv_names_row_column_and_value() {
    let table: [(&str, &str); 12] = [
        ("", "run.csv: there is no row of numbers"),
        ("time [s],control [V]\n", "run.csv: there is no row of numbers"),
        ("time [s],control [V]\n0,1\n1,x\n", "run.csv:3: column \"control\": \"x\" is not a number"),
        ("time [s],control [V]\n0,1\n1\n", "run.csv:3: 1 cells, but the header has 2"),
        ("time [s],time [s]\n0,1\n1,2\n", "run.csv: two columns are named \"time\""),
        (
            "control [V]\n0\n1\n2\n",
            "run.csv: there is no time column and no recording.sample_period in the project file",
        ),
        (
            "time [s],control [V]\n0,1\n1,2\n",
            "run.csv: a recording needs at least 3 rows with a time, and this file has 2",
        ),
        ("time [s],control [V]\n0,1\n2,2\n1,2\n", "run.csv: time does not grow: row 3 is at 1 s after 2 s"),
        (
            "time [s],control [V]\n0,1\n1,2\n2,2\n3,1\n1e9,2\n",
            "run.csv: time leaps: row 5 is at 1000000000 s after 3 s",
        ),
        (
            "time [s],control [A]\n0,1\n1,2\n2,2\n",
            "run.csv: column \"control\" is in [A], but control is in [V]",
        ),
        (
            "time [s],hub_rate [Hz]\n0,1\n1,2\n2,2\n",
            "run.csv: column \"hub_rate\" is in [Hz], but hub_rate is in [rad/s]",
        ),
        (
            "time [s],hub_rate [furlongs/h]\n0,1\n1,2\n2,2\n",
            "run.csv: column \"hub_rate\": unit [furlongs/h] is not known",
        ),
    ];
    for (text, wanted) in table {
        let said = refusal_text(text);
        assert!(said.starts_with(wanted), "{text:?}: {said}");
    }
}

#[test]
fn a_mapping_renames_scales_and_turns_the_sign() {
    let table = read("t [s],w [count],u\n0,10,1\n0.1,20,2\n0.2,30,3\n");
    let source = |column: &str, unit: Option<&str>, scale, offset| ChannelSource {
        unit: unit.map(str::to_owned),
        scale,
        offset,
        ..ChannelSource::from_column(column)
    };
    let channels = vec![
        (Channel::HubRate, source("w", Some("deg/s"), -2.0, 5.0)),
        (Channel::Control, source("u", None, 1.0, 0.0)),
    ];
    let mapping = Mapping { channels, ..Mapping::default() };
    let record = mapping.apply(&table).unwrap();
    let expected = [-15.0, -35.0, -55.0].map(|v: f64| v * (PI / 180.0));
    assert_eq!(channel(&record, Channel::HubRate), expected);
    assert_eq!(channel(&record, Channel::Control), [1.0, 2.0, 3.0]);
    let wrong =
        Mapping { channels: vec![(Channel::HubRate, ChannelSource::from_column("W"))], ..Mapping::default() };
    assert_eq!(
        wrong.apply(&table).unwrap_err().to_string(),
        "run.csv: there is no column \"W\"; it has t, w, u (did you mean \"w\"?)"
    );
}

#[test]
fn a_gap_becomes_missing_samples() {
    let mut text = "time [s],control [V]\n".to_owned();
    for k in (0..10).chain(15..20) {
        text += &format!("{},{}\n", f64::from(k) * 0.01, k);
    }
    let record = Mapping::default().apply(&read(&text)).unwrap();
    let control = channel(&record, Channel::Control);
    assert_eq!(control.len(), 20);
    for (k, value) in control.iter().enumerate() {
        let missing = (10..15).contains(&k);
        assert!(if missing { value.is_nan() } else { (value - k as f64).abs() < 1e-9 }, "{k}: {value}");
    }
    assert_eq!(record.remarks[0], Remark::Gap { row: 10, samples: 5 });
}

#[test]
fn uneven_time_is_evened_out() {
    let time = |k: usize| k as f64 * 0.01 + if k % 2 == 1 { 0.001 } else { 0.0 };
    let rows: String = (0..101).map(|k| format!("{},{}\n", time(k), 3.0 * time(k))).collect();
    let record = Mapping::default().apply(&read(&format!("time [s],control [V]\n{rows}"))).unwrap();
    let worst =
        channel(&record, Channel::Control).iter().enumerate().map(|(k, v)| (v - 0.03 * k as f64).abs());
    assert!(worst.fold(0.0, f64::max) < 1e-12, "a straight line stays a straight line");
    assert!(
        matches!(record.remarks[..], [Remark::Uneven { jitter, .. }] if (jitter - 0.1).abs() < 1e-3),
        "{:?}",
        record.remarks
    );
}

#[test]
fn parquet_of_mixed_types_with_nulls() {
    for file in ["mixed.parquet", "mixed_snappy.parquet"] {
        let table = RecordingTable::read(&data(file), file).unwrap();
        let names: Vec<_> = table.columns.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["time", "hub_rate", "control", "motor_rate", "flag"]);
        let record = Mapping::default().apply(&table).unwrap();
        assert_eq!(record.sample_period_s, 0.25);
        let rate = channel(&record, Channel::HubRate);
        assert!(rate[2].is_nan() && (rate[3] - PI).abs() < 1e-15);
        assert_eq!(channel(&record, Channel::Control)[5], 0.006);
        assert!((channel(&record, Channel::MotorRate)[1] - TAU).abs() < 1e-15);
    }
}

#[test]
fn matlab_plain_and_compressed_structures() {
    let plain = RecordingTable::read(&data("plain_v5.mat"), "plain_v5.mat").unwrap();
    let names: Vec<_> = plain.columns.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["time", "hub_rate", "count"]);
    assert_eq!(plain.column("count").unwrap().values[49], 49.0);
    assert_eq!(Mapping::default().apply(&plain).unwrap().sample_period_s, 1e-3);
    let log = RecordingTable::read(&data("structure_v7.mat"), "structure_v7.mat").unwrap();
    let mapping = Mapping {
        time: Some(ChannelSource::from_column("log.time")),
        channels: vec![
            (Channel::HubRate, ChannelSource::from_column("log.w_1")),
            (Channel::MotorRate, ChannelSource::from_column("log.w_2")),
        ],
        ..Mapping::default()
    };
    let record = mapping.apply(&log).unwrap();
    let (hub, motor) = (channel(&record, Channel::HubRate), channel(&record, Channel::MotorRate));
    assert!((hub[10] - 0.4_f64.sin()).abs() < 1e-6 && motor.iter().zip(hub).all(|(m, h)| *m == -2.0 * h));
}

#[test]
fn matlab_version_7_3() {
    let table = RecordingTable::read(include_bytes!("data/v73.mat"), "v73.mat").unwrap();
    let names: Vec<&str> = table.columns.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["big", "count", "hub_rate", "time", "log.w_1", "log.w_2"]);
    assert!(table.columns.iter().all(|c| c.values.len() == 50));
    let record = Mapping::default().apply(&table).unwrap();
    assert!(record.samples(Channel::HubRate).unwrap().iter().all(|v| v.is_finite()));
    let mut bytes = include_bytes!("data/v73.mat").to_vec();
    bytes.truncate(700);
    let error = RecordingTable::read(&bytes, "cut.mat").unwrap_err().to_string();
    assert!(error.starts_with("cut.mat: not a readable HDF5 file"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn a_damaged_file_never_panics(which in 0_usize..11, place in 0.0..1.0_f64, byte in any::<u8>(), cut in any::<bool>()) {
        let file = [
            "plain_v5.mat", "structure_v7.mat", "mixed.parquet", "mixed_snappy.parquet", "v73.mat", "hostile/types.h5",
            "hostile/types.mat", "hostile/types.parquet", "arrays.npz", "fields.npy", "run.csv",
        ][which];
        let mut bytes = if which < 10 { data(file) } else { b"time [s],control [V]\n0,1\n0.1,2\n0.2,nan\n0.4,inf\n".to_vec() };
        let at = ((bytes.len() - 1) as f64 * place) as usize;
        if cut { bytes.truncate(at) } else { bytes[at] = byte }
        let _ = RecordingTable::read(&bytes, file).map(|table| Mapping::default().apply(&table));
    }
}

#[test]
fn a_mapping_unrolls_adds_and_differentiates() {
    let table = read("time [s],count,bend [count]\n0,8000,0\n0.1,8100,1\n0.2,8,2\n0.3,108,3\n0.4,208,4\n");
    let turns = ChannelSource {
        scale: TAU / 8192.0,
        unit: Some("rad".to_owned()),
        wraps_at: Some(8192.0),
        ..ChannelSource::from_column("count")
    };
    let rate = ChannelSource { slope_over_s: Some(0.2), ..turns.clone() };
    let bent = ChannelSource { plus: Some("bend".to_owned()), ..turns.clone() };
    let channels =
        vec![(Channel::MotorPosition, turns), (Channel::MotorRate, rate), (Channel::HubPosition, bent)];
    let record = Mapping { channels, ..Mapping::default() }.apply(&table).unwrap();
    let counts = |channel| -> Vec<f64> {
        record.samples(channel).unwrap().iter().map(|v| (v * 8192.0 / TAU).round()).collect()
    };
    assert_eq!(counts(Channel::MotorPosition), [8000.0, 8100.0, 8200.0, 8300.0, 8400.0]);
    assert_eq!(counts(Channel::HubPosition), [8000.0, 8101.0, 8202.0, 8303.0, 8404.0]);
    assert_eq!(counts(Channel::MotorRate), [1000.0; 5]);
}

#[test]
fn windows_and_other_rates() {
    let rows: String = (0..40).map(|k| format!("{},{},{}\n", 0.01 * f64::from(k), k, 2 * k)).collect();
    let table = read(&format!("time [s],control [V],hub_rate [rad/s]\n{rows}"));
    let mapping = Mapping { windows_s: vec![[0.0, 0.1], [0.2, 0.4]], ..Mapping::default() };
    let parts = mapping.recordings(&table).unwrap();
    assert_eq!(parts.len(), 2);
    assert_eq!(channel(&parts[1], Channel::Control), (20..40).map(f64::from).collect::<Vec<_>>());
    assert!((parts[1].start_s - 0.2).abs() < 1e-12);
    let beyond = Mapping { windows_s: vec![[0.3, 0.5]], ..Mapping::default() };
    let said = beyond.recordings(&table).unwrap_err().to_string();
    assert!(said.contains("from 0.3 s to 0.5 s is not within"), "{said}");
    // a held control is averaged over the sample for which it is held, a reading about its instant
    let coarse = Mapping { sample_period_s: Some(0.04), ..Mapping::default() }.apply(&table).unwrap();
    assert_eq!(coarse.sample_period_s, 0.04);
    assert_eq!(channel(&coarse, Channel::Control)[1], 5.5);
    assert_eq!(channel(&coarse, Channel::HubRate)[1], 2.0 * 4.0);
    assert!(coarse.remarks.iter().any(|f| matches!(f, Remark::Resampled { .. })));
    let fine = Mapping { sample_period_s: Some(0.005), ..Mapping::default() }.apply(&table).unwrap();
    assert_eq!(channel(&fine, Channel::Control)[..4], [0.0, 0.0, 1.0, 1.0]);
    assert_eq!(channel(&fine, Channel::HubRate)[..4], [0.0, 1.0, 2.0, 3.0]);
}

#[test]
fn the_lagging_slope_makes_a_position_controller_one_of_the_rate() {
    let (period, kp, kv) = (1e-3, 160.0, 240.0);
    let reference = |k: u32| 0.1 * (0.02 * f64::from(k)).sin();
    let rows: String =
        (0..500).map(|k| format!("{},{},{}\n", period * f64::from(k), reference(k), 0.5)).collect();
    let table = read(&format!("time [s],reference [rad],pulse [V]\n{rows}"));
    let demand = ChannelSource {
        slope_lag_s: Some(1.0 / kp),
        plus: Some("pulse".to_owned()),
        plus_scale: 0.01,
        ..ChannelSource::from_column("reference")
    };
    let mapping = Mapping { channels: vec![(Channel::Demand, demand)], ..Mapping::default() };
    let record = mapping.apply(&table).unwrap();
    // with q = 0, u = kp kv (reference - q) - kv q' is kv d + kp kv (sum of d), but for the start that the follower takes over
    let start = kp * kv * (reference(0) + 0.005);
    let mut sum = 0.0;
    for (k, d) in channel(&record, Channel::Demand).iter().enumerate() {
        let u = kv * d + kp * kv * sum + start;
        let wanted = kp * kv * (reference(u32::try_from(k).unwrap()) + 0.005);
        assert!((u - wanted).abs() < 1e-9 * kp * kv, "{k}: {u} {wanted}");
        sum += period * d;
    }
}

#[test]
fn a_clock_of_its_own() {
    let table = read("time [s],w [rad/s],t2 [s]\n0,0,0.05\n0.1,1,0.15\n0.2,2,0.25\n0.3,3,0.35\n");
    let source = ChannelSource { clock: Some("t2".to_owned()), ..ChannelSource::from_column("w") };
    let mapping = Mapping { channels: vec![(Channel::HubRate, source)], ..Mapping::default() };
    let record = mapping.apply(&table).unwrap();
    let found = channel(&record, Channel::HubRate);
    assert!(found[0].is_nan());
    assert!(found[1..].iter().zip([0.5, 1.5, 2.5]).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
}

#[test]
fn rows_written_twice_count_once_and_a_time_that_stands_still_with_other_values_is_refused() {
    let head = "time [s], hub_rate [rad/s], control [V]\n";
    let table = read(&format!("{head}0.000,1,4\n0.001,2,5\n0.001,2,5\n0.002,3,6\n0.003,4,7\n"));
    let record = Mapping::default().apply(&table).unwrap();
    assert_eq!(record.remarks, [Remark::Repeated { rows: 1, first_row: 3 }]);
    assert_eq!(channel(&record, Channel::HubRate), [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(record.sample_period_s, 1e-3);
    let said = refusal_text(&format!("{head}0.000,1,4\n0.001,2,5\n0.001,2.5,5\n0.002,3,6\n"));
    assert!(said.contains("time does not grow: row 3"), "{said}");
}

#[test]
fn a_column_of_texts_is_left_out_and_said() {
    let table = read("time [s],state,hub_rate [rad/s]\n0,idle,1\n0.1,run,2\n0.2,,3\n");
    assert_eq!(table.columns.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(), ["time", "hub_rate"]);
    let Remark::Unread { column, why } = &table.remarks[0] else { panic!("{table:?}") };
    assert_eq!((column.as_str(), why.to_string().as_str()), ("state", "it holds texts, not real numbers"));
    assert!(refusal_text("time [s],state\n0,idle\n0.1,3\n").contains("\"idle\" is not a number"));
}

#[test]
fn the_time_of_plot_juggler_is_the_time() {
    let table = read("__time,/axis/rate,hub_rate [rad/s]\n5.0,,1\n5.1,7,2\n5.2,8,3\n");
    let recording = Mapping::default().apply(&table).unwrap();
    assert!((recording.sample_period_s - 0.1).abs() < 1e-9);
}

#[test]
fn a_position_loop_reads_its_position_in_the_units_of_its_axis() {
    let table = read("time [s],demand [mm],hub_position [mm],control [V]\n0,1,2,0\n0.1,1,3,0\n0.2,1,4,0\n");
    let units = ChannelUnits {
        reading: LoopQuantity::Position,
        demand: LoopQuantity::Position,
        travel: Travel::Sliding,
    };
    let recording = Mapping { units, ..Mapping::default() }.apply(&table).unwrap();
    assert_eq!(recording.samples(Channel::HubRate), Some(&[2e-3, 3e-3, 4e-3][..]));
    assert_eq!(
        (recording.samples(Channel::HubPosition), recording.samples(Channel::Demand).unwrap()[0]),
        (None, 1e-3)
    );
    assert!(Mapping::default().apply(&table).is_err(), "a rate loop of a turning axis has no demand in mm");
}

#[test]
fn numpy_arrays_are_read_with_their_names() {
    // np.savez_compressed(time=t, hub_rate=sin(t) as float32, pair=[t; sin(t)], label=texts)
    let table = RecordingTable::read(&data("arrays.npz"), "arrays.npz").unwrap();
    let names: Vec<&str> = table.columns.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["time", "hub_rate", "pair_1", "pair_2"]);
    let is_label = |remark: &Remark| matches!(remark, Remark::Unread { column, .. } if column == "label");
    assert!(table.remarks.iter().any(is_label), "{:?}", table.remarks);
    let recording = Mapping::default().apply(&table).unwrap();
    let rate = recording.samples(Channel::HubRate).unwrap();
    assert!((recording.sample_period_s - 0.01).abs() < 1e-9 && (rate[30] - 0.3_f64.sin()).abs() < 1e-6);
    // a structured array (time, hub_rate, count, note)
    let fields = RecordingTable::read(&data("fields.npy"), "fields.npy").unwrap();
    assert_eq!(
        fields.columns.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(),
        ["time", "hub_rate", "count"]
    );
    assert_eq!(fields.column("count").unwrap().values[49], 49.0);
}
