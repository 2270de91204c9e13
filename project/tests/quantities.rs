//! Quantities with units: a table of conversions in both directions, dimensions that do not fit, and hostile texts.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::{PI, TAU};

use counterpoise_project::unit::{read_quantity, rewrite_quantity};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// The text that is written, the unit of the key, and the value in it (NIST SP 811, SI brochure).
const CONVERSIONS: &[(&str, &str, f64)] = &[
    ("1500 mm", "m", 1.5),
    ("12 cm", "m", 0.12),
    ("35 µm", "m", 35e-6),
    ("35 μm", "m", 35e-6),
    ("2 in", "m", 0.0508),
    ("3 inch", "m", 0.0762),
    ("1 ft", "m", 0.3048),
    ("25 mm^2", "m^2", 25e-6),
    ("3 cm^4", "m^4", 3e-8),
    ("250 g", "kg", 0.25),
    ("2 lb", "kg", 0.907_184_74),
    ("8 oz", "kg", 0.226_796_185),
    ("1.2 t", "kg", 1200.0),
    ("1 slug", "kg", 14.593_902_937_206_364),
    ("7.85 g/cm^3", "kg/m^3", 7850.0),
    ("205 GPa", "Pa", 205e9),
    ("29e6 psi", "Pa", 29e6 * 6_894.757_293_168_361),
    ("2 min", "s", 120.0),
    ("250 us", "s", 250e-6),
    ("0.5 mrad", "rad", 0.5e-3),
    ("90 deg", "rad", PI / 2.0),
    ("90°", "rad", PI / 2.0),
    ("6 arcmin", "rad", 6.0 * PI / 10_800.0),
    ("20 arcsec", "rad", 20.0 * PI / 648_000.0),
    ("0.25 rev", "rad", TAU / 4.0),
    ("100 gon", "rad", PI / 2.0),
    ("3000 rpm", "rad/s", 100.0 * PI),
    ("3 krpm", "rad/s", 100.0 * PI),
    ("0.2 deg/s", "rad/s", 0.2 * PI / 180.0),
    ("60 Hz", "rad/s", 60.0 * TAU),
    ("377 rad/s", "Hz", 377.0 / TAU),
    ("1.5 kHz", "Hz", 1500.0),
    ("100 1/s", "rad/s", 100.0),
    ("20 deg/s^2", "rad/s^2", 20.0 * PI / 180.0),
    ("5 rad/s/s", "rad/s^2", 5.0),
    ("36 km/h", "m/s", 10.0),
    ("2 g", "m/s^2", 19.6133),
    ("5 mg", "m/s^2", 5e-3 * 9.80665),
    ("10 lbf", "N", 44.482_216_152_605),
    ("10 kgf", "N", 98.0665),
    ("3.78e4 dyn cm/A", "N m/A", 3.78e-3),
    ("3.78e4 dyne cm/A", "N m/A", 3.78e-3),
    ("350 mN m", "N m", 0.35),
    ("350 mNm", "N m", 0.35),
    ("50 oz-in", "N m", 50.0 * 0.278_013_850_953_781_2 * 0.0254),
    ("10 kg cm", "N m", 0.980_665),
    ("12 ft-lb", "N m", 12.0 * 0.3048 * 4.448_221_615_260_5),
    ("41 kN m/rad", "N m/rad", 41e3),
    ("2 N m/arcmin", "N m/rad", 2.0 * 10_800.0 / PI),
    ("700 N m/deg", "N m/rad", 700.0 * 180.0 / PI),
    ("2 N m s", "N m s/rad", 2.0),
    ("1 mN m/rpm", "N m s/rad", 1e-3 * 30.0 / PI),
    ("120 kg cm^2", "kg m^2", 0.012),
    ("135 g cm²", "kg m^2", 1.35e-5),
    ("135 g cm2", "kg m^2", 1.35e-5),
    ("0.01 oz-in-s^2", "kg m^2", 0.01 * 0.278_013_850_953_781_2 * 0.0254),
    ("12 oz-in^2", "kg m^2", 12.0 * 0.028_349_523_125 * 0.0254 * 0.0254),
    ("3 lb ft", "kg m", 3.0 * 0.453_592_37 * 0.3048),
    ("86 mN m/A", "N m/A", 0.086),
    ("12 oz-in/A", "N m/A", 12.0 * 0.278_013_850_953_781_2 * 0.0254),
    ("9 V/krpm", "V s/rad", 9.0 * 30.0 / (PI * 1000.0)),
    ("0.86 V s", "V s/rad", 0.86),
    ("1.2 kohm", "ohm", 1200.0),
    ("800 mΩ", "ohm", 0.8),
    ("4 mH", "H", 4e-3),
    ("48 V", "V", 48.0),
    ("500 mA", "A", 0.5),
    ("200:1", "", 200.0),
    ("7 : 2", "", 3.5),
    ("12 %", "", 0.12),
    ("50 ppm", "", 50e-6),
    ("14 bit", "bits", 14.0),
    ("12 bit", "counts/rev", 4096.0),
    ("4096 cpr", "counts/rev", 4096.0),
    ("16 bit", "counts", 65536.0),
    ("20-bit", "counts", 1_048_576.0),
    ("17 bit/rev", "counts", 131_072.0),
    ("4096 CPR", "counts", 4096.0),
    ("4096 counts/turn", "counts", 4096.0),
    ("2000 steps", "counts", 2000.0),
    ("40 mm", "m/rev", 0.04),
    ("40 mm/rev", "m/rev", 0.04),
    ("0.5 in/turn", "m/rev", 0.0127),
    ("3000 RPM", "rad/s", 100.0 * PI),
    ("3000 r/min", "rad/s", 100.0 * PI),
    ("200 dps", "rad/s", 200.0 * PI / 180.0),
    ("5 V/1000 rpm", "V s/rad", 5.0 * 30.0 / (PI * 1000.0)),
    ("5 V/1000rpm", "V s/rad", 5.0 * 30.0 / (PI * 1000.0)),
    ("0.05 Vs/rad", "V s/rad", 0.05),
    ("135 gcm²", "kg m^2", 1.35e-5),
    ("0.02 kgm^2", "kg m^2", 0.02),
    ("0.02 kg.m2", "kg m^2", 0.02),
    ("12 ozin2", "kg m^2", 12.0 * 0.028_349_523_125 * 0.0254 * 0.0254),
    ("2 Nms/rad", "N m s/rad", 2.0),
    ("0.4 Ohm", "ohm", 0.4),
    ("0.4 \u{2126}", "ohm", 0.4),
    ("100 usec", "s", 100e-6),
    ("20 arcseconds", "rad", 20.0 * PI / 648_000.0),
    ("150 lbs", "kg", 150.0 * 0.453_592_37),
    ("7.85 g/cc", "kg/m^3", 7850.0),
    ("12 dB", "dB", 12.0),
    ("4e-8 (rad/s)^2/Hz", "(rad/s)^2 s", 4e-8),
    ("1 (deg/s)^2/Hz", "(rad/s)^2 s", (PI / 180.0) * (PI / 180.0)),
    ("\u{2212}3.5 mm", "m", -3.5e-3),
    (" +2  mm ", "m", 2e-3),
];

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 4.0 * f64::EPSILON * a.abs().max(b.abs())
}

#[test]
fn the_table_of_conversions_holds_in_both_directions() {
    assert!(CONVERSIONS.len() >= 40);
    for (text, unit, value) in CONVERSIONS {
        let found = read_quantity(text, unit).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert!(close(found, *value), "{text} is {found} {unit}, not {value}");
        let back = rewrite_quantity(text, found, unit).unwrap();
        let again = read_quantity(&back, unit).unwrap();
        assert_eq!(again, found, "{text} is written back as {back}");
        let other = 1.7 * found;
        let back = rewrite_quantity(text, other, unit).unwrap();
        assert!(
            close(read_quantity(&back, unit).unwrap(), other),
            "{text} with {other} is written as {back}"
        );
        assert_eq!(tail(&back), tail(text.trim()), "the unit stays as it was written");
    }
}

/// Returns what follows the number.
fn tail(text: &str) -> &str {
    let number = |c: char| c.is_ascii_digit() || ".+-e\u{2212}".contains(c);
    text.trim_start_matches(number)
}

#[test]
fn decimal_prefixes_are_exact() {
    for (text, unit, value) in [("0.5 mrad", "rad", 0.5e-3), ("0.1 mm", "m", 1e-4), ("3.3 kV", "V", 3300.0)] {
        assert_eq!(read_quantity(text, unit), Ok(value), "{text}");
    }
    assert_eq!(rewrite_quantity("0.5 mrad", 7e-4, "rad").unwrap(), "0.7 mrad");
    assert_eq!(rewrite_quantity("30 deg", 31.0 * (PI / 180.0), "rad").unwrap(), "31 deg");
    assert_eq!(rewrite_quantity("3000rpm", 350.0 * PI / 3.0, "rad/s").unwrap(), "3500rpm");
    assert_eq!(rewrite_quantity("200:1", 250.0, "").unwrap(), "250:1");
    assert_eq!(rewrite_quantity("14 bit", 16.0, "bits").unwrap(), "16 bit");
}

/// A text, the unit of its key, and what is said of it.
const WRONG: &[(&str, &str, &str)] = &[
    ("5 N m", "rad/s", "must be an angular rate, in a unit like rad/s; \"5 N m\" is a torque"),
    ("5 N m", "N m/rad", "must be an angular stiffness, in a unit like N m/rad; \"5 N m\" is a torque"),
    (
        "5 rad/s/s",
        "rad/s",
        "must be an angular rate, in a unit like rad/s; \"5 rad/s/s\" is an angular acceleration",
    ),
    ("1 m m", "m", "must be a length, in a unit like m; \"1 m m\" is an area"),
    (
        "20 V",
        "V/rad",
        "must be measured in m^2 kg s^-3 A^-1 rad^-1, in a unit like V/rad; \"20 V\" is a voltage",
    ),
    ("5 mm", "", "must be a number without unit; \"5 mm\" is a length"),
    ("14 bit", "", "must be a number without unit; \"14 bit\" is a number of bits"),
    ("20 dB", "", "must be a number without unit; \"20 dB\" is a level in decibels"),
    ("200:1", "m", "must be a length, in a unit like m; \"200:1\" is a ratio"),
    ("1 kHz", "s", "must be a time, in a unit like s; \"1 kHz\" is a frequency"),
    ("5", "m", "has no unit: write the number without quotes if it is in m, or add its unit"),
    ("much", "m", "must be a number in m, or a text with a number and a unit"),
    ("", "m", "must be a number in m, or a text with a number and a unit"),
    (
        "1,5 mm",
        "m",
        "must be written with a decimal point and without separators of thousands, as in \"1234.5 mm\"",
    ),
    (
        "3 000 rpm",
        "rad/s",
        "must be written with a decimal point and without separators of thousands, as in \"1234.5 mm\"",
    ),
    ("NaN rad", "rad", "must be a finite number in rad"),
    ("-inf m", "m", "must be a finite number in m"),
    ("1e999999999999999999999 m", "m", "must be a finite number in m"),
    ("5 furlong", "m", "must be a quantity in a unit like m: there is no unit \"furlong\""),
    (
        "5 m^99",
        "m",
        "must be a quantity in a unit like m: the power in \"m^99\" must be a whole number from -9 to 9",
    ),
    (
        "5 m^0.5",
        "m",
        "must be a quantity in a unit like m: the power in \"m^0.5\" must be a whole number from -9 to 9",
    ),
    ("5 (m", "m", "must be a quantity in a unit like m: \"(m\" is no product or quotient of units"),
    ("5 m/", "m", "must be a quantity in a unit like m: \"m/\" is no product or quotient of units"),
];

#[test]
fn what_does_not_fit_is_told_with_both_dimensions() {
    for (text, unit, told) in WRONG {
        assert_eq!(read_quantity(text, unit).unwrap_err().to_string(), *told, "{text:?}");
    }
    let two_ways = read_quantity("5 N m/rad s", "N m s/rad").unwrap_err().to_string();
    assert!(two_ways.contains("can be read in two ways"), "{two_ways}");
    assert_eq!(read_quantity("5 NM", "N m").unwrap_err().hint().unwrap(), "did you mean \"Nm\"?");
    assert_eq!(
        read_quantity("1 kHz", "s").unwrap_err().hint().unwrap(),
        "give the period, the inverse of the frequency"
    );
    assert_eq!(read_quantity("1e-999999999999999999999 m", "m"), Ok(0.0));
}

#[test]
fn long_and_deep_texts_are_refused_at_once() {
    let deep = format!("1 {}m{}", "(".repeat(30), ")".repeat(30));
    let long = format!("1 {}", "m ".repeat(10_000));
    let digits = format!("{} m", "9".repeat(100_000));
    for text in [&deep, &long, &digits, &"(".repeat(1_000_000)] {
        assert!(read_quantity(text, "m").is_err(), "{}", &text[..20]);
        assert!(rewrite_quantity(text, 1.0, "m").is_none());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn noise_is_refused_or_finite(text in "[-+0-9.eE]{0,6} ?[a-zA-Zµ°%()/^*²0-9 -]{0,12}") {
        for unit in ["", "m", "rad/s", "N m/rad", "bits"] {
            if let Ok(value) = read_quantity(&text, unit) {
                prop_assert!(value.is_finite(), "{}", text);
            }
        }
    }

    #[test]
    fn any_value_is_kept_by_its_text_to_the_last_bit_but_one(digits in -10.0..10.0f64, exponent in -12i32..12) {
        let value = digits * 10f64.powi(exponent);
        for (text, unit) in [("1 mrad", "rad"), ("1 deg", "rad"), ("1 rpm", "rad/s"), ("1 oz-in", "N m"), ("1 in", "m")] {
            let again = read_quantity(&rewrite_quantity(text, value, unit).unwrap(), unit).unwrap();
            prop_assert!(close(again, value), "{} {}", again, value);
        }
    }
}

#[test]
fn what_data_sheets_write_in_two_ways_is_asked_for() {
    let hint = |text: &str, unit: &str| read_quantity(text, unit).unwrap_err().hint().unwrap_or_default();
    for text in ["3000 1/min", "3000 min^-1"] {
        assert!(hint(text, "rad/s").contains("rpm"), "{text}");
    }
    assert!(hint("5 mV/min^-1", "V s/rad").contains("rpm"));
    assert!(hint("1024 lines", "counts").contains("4 N counts"));
    assert!(hint("1024 ppr", "counts").contains("4 N counts"));
    assert!(hint("380 rpm/V", "V s/rad").contains("inverse"));
    assert!(read_quantity("5 mm/rev", "m").is_err(), "a length is no travel a turn");
}

#[test]
fn words_that_are_units_elsewhere_are_answered() {
    let said = |text: &str, wanted: &str| {
        let error = read_quantity(text, wanted).unwrap_err();
        format!("{error} ({})", error.hint().unwrap_or_default())
    };
    assert!(
        said("0.5 mil", "rad").contains("6400 to the turn is 0.98175 mrad"),
        "{}",
        said("0.5 mil", "rad")
    );
    // a prefix and a unit that make a word by chance
    assert!(said("0.5 Grad", "rad").contains("write deg"), "{}", said("0.5 Grad", "rad"));
    assert!(read_quantity("2 Mrad/s", "rad/s").is_ok());
    for text in ["200:0", "200:", "200:-1", "200:x", "1:nan"] {
        assert!(said(text, "").contains("second number is above 0"), "{text}: {}", said(text, ""));
    }
}
