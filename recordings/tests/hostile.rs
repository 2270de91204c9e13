//! Damaged, odd and hostile recordings: what is not read is said, what is damaged is refused, and nothing takes memory without
//! bounds. The files are written by `tests/peers/recordings/hostile.py`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::PathBuf;

use counterpoise_recordings::{Channel, DoubtfulUnit, Error, Mapping, Recording, RecordingTable, Remark};

fn read(name: &str) -> Result<RecordingTable, Error> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/hostile").join(name);
    RecordingTable::read(&std::fs::read(path).unwrap(), name)
}

fn columns(table: &RecordingTable) -> Vec<&str> {
    table.columns.iter().map(|c| c.name.as_str()).collect()
}

/// The columns that were not read or not used, with the reason.
fn remark_texts(remarks: &[Remark]) -> Vec<String> {
    let text = |remark: &Remark| match remark {
        Remark::Unread { column, why } => format!("column \"{column}\" was not read: {why}"),
        Remark::NearlyNamed { column, meant } => format!("column \"{column}\" is nearly {meant}"),
        other => format!("{other:?}"),
    };
    remarks.iter().map(text).collect()
}

fn csv(text: &str) -> RecordingTable {
    RecordingTable::read(text.as_bytes(), "run.csv").unwrap()
}

fn record_text(text: &str, sample_period_s: Option<f64>) -> Result<Recording, Error> {
    Mapping { sample_period_s, ..Mapping::default() }.apply(&csv(text))
}

#[test]
fn hdf5_says_what_it_does_not_read() {
    let table = read("types.h5").unwrap();
    assert_eq!(columns(&table), ["Hub_Position", "control", "hub_rate", "time"]);
    let recording = Mapping::default().apply(&table).unwrap();
    let said = remark_texts(&recording.remarks);
    for wanted in [
        "column \"complex\" was not read: it holds complex numbers, not real numbers",
        "column \"cube\" was not read: its shape is 40 x 2 x 2, but a column or a matrix of columns is needed",
        "column \"flag\" was not read: it holds enumerated values, not real numbers",
        "column \"records\" was not read: it holds records of several fields, not real numbers",
        "column \"short\" was not read: it has 39 values, the columns that were read 40",
        "column \"texts\" was not read: it holds texts, not real numbers",
        "column \"Hub_Position\" is nearly hub_position",
    ] {
        assert!(said.iter().any(|s| s == wanted), "{wanted} in {said:#?}");
    }
    assert!(said.iter().any(|s| s.starts_with("column \"half\" was not read")), "{said:#?}");
    assert_eq!(said.len(), 8, "{said:#?}");
}

#[test]
fn a_link_in_a_group_of_the_older_format_hides_only_what_has_no_channel_s_name() {
    let table = read("link_old_group.h5").unwrap();
    assert_eq!(columns(&table), ["hub_rate", "time"]);
    let said = remark_texts(&table.remarks);
    assert!(
        said[0].starts_with("column \"*\" was not read") && said[0].contains("holds a link"),
        "{said:#?}"
    );
    assert!(said[1].starts_with("column \"control\" was not read"), "{said:#?}");
    assert_eq!(said.len(), 2, "{said:#?}");
}

#[test]
fn a_leap_of_one_of_two_steps_is_refused() {
    let said = record_text("time [s],hub_rate\n0,0\n0.001,1\n343868,2\n", Some(1e-3)).unwrap_err();
    assert!(matches!(said, Error::TimeLeaps { row: 3, .. }), "{said}");
}

#[test]
fn matrices_are_read_as_columns_beside_vectors() {
    let table = read("matrix.h5").unwrap();
    assert_eq!(columns(&table), ["time", "w_1", "w_2", "w_3", "wide_1", "wide_2"]);
    let (first, third) = (&table.column("w_1").unwrap().values, &table.column("w_3").unwrap().values);
    assert!(first.iter().zip(third).all(|(a, c)| (c - 3.0 * a).abs() < 1e-15));
    assert!((table.column("wide_2").unwrap().values[0] + 2.0).abs() < 1e-15);
    assert_eq!(
        remark_texts(&table.remarks),
        [
            "column \"image\" was not read: its shape is 30 x 70, but a column or a matrix of columns is needed"
        ]
    );
}

#[test]
fn matlab_says_what_it_does_not_read() {
    let table = read("types.mat").unwrap();
    assert_eq!(columns(&table), ["time", "control", "wide_1", "wide_2", "hub-rate"]);
    let said = remark_texts(&Mapping::default().apply(&table).unwrap().remarks);
    for (name, why) in [
        ("complex", "complex numbers"),
        ("sparse", "a sparse matrix"),
        ("cells", "cells"),
        ("texts", "texts"),
        ("cube", "40 x 2 x 2"),
        ("short", "39 values"),
        ("image", "30 x 70"),
        ("hub-rate", "nearly hub_rate"),
    ] {
        let hit = |s: &String| s.starts_with(&format!("column \"{name}\"")) && s.contains(why);
        assert!(said.iter().any(hit), "{name} in {said:#?}");
    }
    assert_eq!(said.len(), 8, "{said:#?}");
}

#[test]
fn parquet_reads_by_type_and_says_what_it_does_not_read() {
    let table = read("types.parquet").unwrap();
    assert_eq!(
        columns(&table),
        ["time", "hub_rate", "control", "half", "unsigned", "small", "large", "HubPosition"]
    );
    let at = |column: &str| table.column(column).unwrap().values[3];
    assert_eq!((at("unsigned"), at("small"), at("large")), (4e9, 1.25, 1.25));
    assert!((at("half") - at("hub_rate")).abs() < 1e-4);
    let said = remark_texts(&Mapping::default().apply(&table).unwrap().remarks);
    let unread = ["texts", "dates", "lists"];
    for name in unread {
        assert!(said.iter().any(|s| s.starts_with(&format!("column \"{name}\" was not read"))), "{said:#?}");
    }
    assert!(said.iter().any(|s| s.contains("nearly hub_position")), "{said:#?}");
    assert_eq!(said.len(), unread.len() + 1, "{said:#?}");
}

/// Arrow stores decimal numbers as bytes, the most significant first, whatever their number of digits.
#[test]
fn decimal_numbers_are_read_up_to_38_digits() {
    let table = read("decimals.parquet").unwrap();
    assert_eq!(columns(&table), ["time", "control", "hub_rate"]);
    let values = |column: &str| table.column(column).unwrap().values.to_vec();
    let close = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-15;
    let (times, control, rates) = (values("time"), values("control"), values("hub_rate"));
    assert!(times[0] == 0.0 && close(times[1], 1e-3) && close(times[2], 2e-3), "{times:?}");
    assert!(
        close(control[0], -1.25) && control[1].is_nan() && close(control[2], 123456.789012),
        "{control:?}"
    );
    assert!(close(rates[0], -1e-38) && close(rates[1], 0.5) && close(rates[2], -1.0), "{rates:?}");
    let said = remark_texts(&table.remarks);
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].starts_with("column \"demand\" was not read: it holds decimal numbers of more than 38"));
}

#[test]
fn timestamps_have_their_unit() {
    for unit in ["ms", "us", "ns"] {
        let table = read(&format!("timestamp_{unit}.parquet")).unwrap();
        assert_eq!(table.column("time").unwrap().unit.as_deref(), Some(unit));
        let recording = Mapping { sample_period_s: Some(1e-3), ..Mapping::default() }.apply(&table).unwrap();
        assert_eq!((recording.sample_period_s, recording.len()), (1e-3, 40), "{unit}");
        assert!((recording.start_s - 0.25).abs() < 1e-12 && recording.remarks.is_empty(), "{unit}");
    }
}

#[test]
fn every_codec_is_read() {
    for codec in ["gzip", "lz4", "brotli"] {
        let table = read(&format!("{codec}.parquet")).unwrap();
        assert!((table.column("control").unwrap().values[0] - 2.0).abs() < 1e-12, "{codec}");
    }
}

#[test]
fn a_checksum_that_does_not_match_is_refused() {
    for (file, column) in [("checksum.h5", "control"), ("checksum.parquet", "control")] {
        let error = read(file).unwrap_err();
        assert!(matches!(&error, Error::Checksum { column: c, .. } if c == column), "{file}: {error}");
    }
    let error = read("damaged.mat").unwrap_err().to_string();
    assert!(error.contains("damaged"), "{error}");
}

#[test]
fn what_is_neither_text_nor_known_is_refused() {
    let error = read("version4.mat").unwrap_err();
    assert!(matches!(error, Error::UnknownFormat { .. }), "{error}");
    let error = RecordingTable::read(b"0.0,1\n0.1,2\n", "run.csv").unwrap_err().to_string();
    assert!(
        error.starts_with("run.csv: the first row (0.0,1) holds numbers, but must name the columns"),
        "{error}"
    );
}

#[test]
fn a_time_without_a_unit_is_asked_for_it() {
    let rows: String = (0..50).map(|k| format!("{k},{}\n", 0.1 * f64::from(k))).collect();
    let error = record_text(&format!("time,control [V]\n{rows}"), Some(1e-3)).unwrap_err();
    assert!(matches!(error, Error::TimeUnit { meant: Some("ms"), .. }), "{error}");
    assert!(error.to_string().contains("far from the sample period of 0.001 s; are they ms?"), "{error}");
    let given = record_text(&format!("time [ms],control [V]\n{rows}"), Some(1e-3)).unwrap();
    assert_eq!((given.sample_period_s, given.len()), (1e-3, 50));
    let slow = record_text(&format!("time [s],control [V]\n{rows}"), Some(1e-3)).unwrap();
    assert!(matches!(slow.remarks[..], [Remark::Resampled { .. }]));
    let error = record_text(&format!("time [h],control [V]\n{rows}"), Some(1e-9)).unwrap_err();
    assert!(matches!(error, Error::TooLong { .. }), "{error}");
}

#[test]
fn infinities_and_outliers_count_as_missing_and_are_named() {
    let rate = |k: i32| match k {
        20 => "inf".to_owned(),
        40 => "1e6".to_owned(),
        _ => (0.1 * (0.1 * f64::from(k)).sin()).to_string(),
    };
    let rows: String = (0..100).map(|k| format!("{},{}\n", 0.01 * f64::from(k), rate(k))).collect();
    let recording = record_text(&format!("time [s],hub_rate [rad/s]\n{rows}"), None).unwrap();
    assert!(recording.samples(Channel::HubRate).unwrap()[20].is_nan());
    let channel = Channel::HubRate;
    let wanted = [
        Remark::Infinite { channel, samples: 1, first_row: 21 },
        Remark::Outliers { channel, samples: 1, first_row: 41, value: 1e6 },
        Remark::Missing { channel, samples: 2, first_row: 21 },
    ];
    assert_eq!(recording.remarks, wanted);
}

#[test]
fn a_step_and_noise_are_no_outliers() {
    let noise = |k: u32| f64::from(k.wrapping_mul(2_654_435_761) >> 16) / 65_536.0;
    let row = |k: u32| format!("{},{}\n", 0.01 * f64::from(k), noise(k) + if k > 50 { 100.0 } else { 0.0 });
    let rows: String = (0..100).map(row).collect();
    let recording = record_text(&format!("time [s],hub_rate [rad/s]\n{rows}"), None).unwrap();
    assert!(recording.remarks.is_empty(), "{:?}", recording.remarks);
}

#[test]
fn a_claimed_size_is_refused_before_it_is_allocated() {
    // a variable of 4 GiB that is claimed by the first eight bytes of a compressed element
    let mut bytes = include_bytes!("data/structure_v7.mat")[..128].to_vec();
    let tag = [14, 0, 0, 0, 0xf0, 0xff, 0xff, 0xff];
    let mut packed = vec![0x78, 0x01, 0x00, 8, 0, 0xf7, 0xff];
    packed.extend(tag);
    bytes.extend([15, 0, 0, 0]);
    bytes.extend((packed.len() as u32).to_le_bytes());
    bytes.extend(packed);
    let error = RecordingTable::read(&bytes, "bomb.mat").unwrap_err();
    assert!(matches!(error, Error::TooLarge { bytes, .. } if bytes > 4_000_000_000), "{error}");
}

fn rates(rate: impl Fn(usize) -> f64) -> Recording {
    let rows: String = (0..100).map(|k| format!("{},{}\n", 0.01 * k as f64, rate(k))).collect();
    record_text(&format!("time [s],hub_rate [rad/s]\n{rows}"), None).unwrap()
}

#[test]
fn outliers_of_several_readings_and_at_the_ends_are_named() {
    let channel = Channel::HubRate;
    let slow = |k: usize| (0.1 * k as f64).sin();
    for (places, first_row) in [(vec![0], 1), (vec![99], 100), (vec![50, 51], 51), (vec![50, 51, 52], 51)] {
        let recording = rates(|k| if places.contains(&k) { 1e6 } else { slow(k) });
        let samples = places.len();
        assert_eq!(recording.remarks[0], Remark::Outliers { channel, samples, first_row, value: 1e6 });
        let kept = recording.samples(channel).unwrap();
        assert!(kept.iter().enumerate().all(|(k, v)| v.is_nan() == places.contains(&k)));
    }
    let long = rates(|k| if (50..60).contains(&k) { 1e6 } else { slow(k) });
    assert!(long.remarks.is_empty(), "ten readings may be a motion: {:?}", long.remarks);
}

#[test]
fn names_that_contain_a_channels_are_asked_about() {
    for name in ["hub_rate_filtered", "meas_hub_rate", "Hub Rate", "hub_rate_rad_s", "hubrat", "run.hub_rate"]
    {
        let rows = "0,1\n0.001,2\n0.002,3\n";
        let recording = record_text(&format!("time [s],{name}\n{rows}"), None).unwrap();
        let meant = "hub_rate";
        assert_eq!(recording.remarks, [Remark::NearlyNamed { column: name.to_owned(), meant }], "{name}");
    }
}

#[test]
fn very_many_columns_are_refused_or_counted() {
    let commas = ",".repeat(20_000);
    let error =
        RecordingTable::read(format!("{commas}\n{commas}\n").as_bytes(), "wide.csv").unwrap_err().to_string();
    assert!(error.contains("20001 columns, more than the 10000 that are read"), "{error}");
    let names: String = (0..100).map(|k| format!(",hub_rate_{k}")).collect();
    let row = ",1".repeat(100);
    let text = format!("time [s]{names}\n0{row}\n0.001{row}\n0.002{row}\n");
    let recording = record_text(&text, None).unwrap();
    assert_eq!(recording.remarks.len(), 31);
    assert_eq!(recording.remarks[30], Remark::Further { columns: 70 });
}

#[test]
fn text_in_another_encoding_is_refused_with_advice() {
    let utf16: Vec<u8> = "\u{feff}time,control\n0,1\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let error = RecordingTable::read(&utf16, "run.csv").unwrap_err().to_string();
    assert!(error.contains("text in UTF-16: save it as UTF-8"), "{error}");
    let latin = b"time,hub_rate [\xb0/s]\n0,1\n";
    let error = RecordingTable::read(latin, "run.csv").unwrap_err().to_string();
    assert!(error.contains("save it as UTF-8"), "{error}");
}

#[test]
fn a_stated_unit_that_is_far_from_the_sample_period_is_asked_about() {
    let rows: String = (0..50).map(|k| format!("{k},{}\n", 0.1 * f64::from(k))).collect();
    let recording = record_text(&format!("time [s],control [V]\n{rows}"), Some(1e-3)).unwrap();
    let Remark::Resampled { doubt, .. } = recording.remarks[0] else { panic!("{recording:?}") };
    assert_eq!(doubt, Some(DoubtfulUnit { meant: Some("ms") }));
}
