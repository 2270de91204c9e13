//! Ticks: few, round, all over the axis, and each with a text of its own.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_plot::ruler::{Margin, Ruler};
use counterpoise_plot::ticks::{
    Tick, degree_ticks, linear_step, linear_ticks, logarithmic_minor, logarithmic_ticks,
};
use counterpoise_plot::{Axis, Scale};
use proptest::prelude::*;

fn texts(ticks: &[Tick]) -> Vec<&str> {
    ticks.iter().map(|tick| tick.text.as_str()).collect()
}

#[test]
fn ticks_are_round_and_few() {
    assert_eq!(texts(&linear_ticks(0.0, 10.0, 7.0)), ["0", "2", "4", "6", "8", "10"]);
    assert_eq!(texts(&linear_ticks(-0.03, 0.05, 7.0)), ["\u{2212}0.02", "0.00", "0.02", "0.04"]);
    assert_eq!(degree_ticks(-270.0, 0.0, 7.0).iter().map(|t| t.value).collect::<Vec<_>>().len(), 7);
    assert_eq!(texts(&logarithmic_ticks(0.01, 100.0, 9.0)), ["0.01", "0.1", "1", "10", "100"]);
    assert_eq!(texts(&logarithmic_ticks(2.0, 9.0, 9.0)), ["2", "5"]);
    assert_eq!(
        texts(&logarithmic_ticks(5e-3, 800.0, 2.0)),
        ["0.01", "1", "100"],
        "a low plot over five decades"
    );
    assert_eq!(
        texts(&logarithmic_ticks(2.1, 2.4, 9.0)),
        ["2.10", "2.15", "2.20", "2.25", "2.30", "2.35", "2.40"]
    );
    assert_eq!(
        texts(&logarithmic_ticks(1e-7, 1e-4, 9.0)),
        ["10\u{207B}\u{2077}", "10\u{207B}\u{2076}", "10\u{207B}\u{2075}", "10\u{207B}\u{2074}"]
    );
    assert_eq!(logarithmic_minor(1.0, 20.0), [2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 20.0]);
    assert!(logarithmic_minor(1e-9, 1e9).is_empty());
}

#[test]
fn small_steps_at_large_values_can_be_told_apart() {
    assert_eq!(texts(&linear_ticks(1e6, 1e6 + 3.0, 3.0))[1], "1.000001\u{D7}10\u{2076}");
    assert_eq!(
        texts(&linear_ticks(0.0, 3e-7, 3.0)),
        ["0", "1\u{D7}10\u{207B}\u{2077}", "2\u{D7}10\u{207B}\u{2077}", "3\u{D7}10\u{207B}\u{2077}"]
    );
}

#[test]
fn data_without_a_range_give_a_usable_ruler() {
    for data in
        [vec![], vec![f64::NAN; 2], vec![0.0], vec![3.0, 3.0], vec![-1e-300, 1e300], vec![f64::MIN, f64::MAX]]
    {
        for axis in [Axis::linear("y", ""), Axis::logarithmic("y", ""), Axis::degrees("y")] {
            for margin in [Margin::Tight, Margin::Padded] {
                let ruler = Ruler::new(&axis, data.iter().copied(), margin);
                let ticks = ruler.major();
                assert!((2..20).contains(&ticks.len()), "{axis:?} {data:?} {ticks:?}");
                assert!(ruler.place(f64::NAN).is_none() && ruler.place(f64::INFINITY).is_none());
            }
        }
    }
    for range in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
        let ruler = Ruler::new(
            &Axis::linear("y", "").with_range(range.0, range.1),
            [0.0, 5.0].into_iter(),
            Margin::Tight,
        );
        assert_eq!(ruler.ends(), (0.0, 5.0), "a range that is none is not taken");
    }
}

#[test]
fn what_is_no_range_has_no_ticks() {
    for (from, to) in [(1.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY), (f64::NEG_INFINITY, 0.0)] {
        assert!(
            linear_ticks(from, to, 7.0).is_empty() && degree_ticks(from, to, 7.0).is_empty(),
            "{from} {to}"
        );
    }
    for (from, to) in [(1.0, 1.0), (0.0, 1.0), (-1.0, 1.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)] {
        assert!(
            logarithmic_ticks(from, to, 9.0).is_empty() && logarithmic_minor(from, to).is_empty(),
            "{from} {to}"
        );
    }
}

/// Returns a range from anywhere between tiny and huge, of a width between a millionth of its values and all
/// of them.
fn ranges() -> impl Strategy<Value = (f64, f64)> {
    (-280.0..280.0f64, -6.0..1.0f64, -1.0..1.0f64).prop_map(|(size, width, from)| {
        let size = 10f64.powf(size);
        (from * size, (from + 10f64.powf(width)) * size)
    })
}

/// Returns a positive range of up to 30 decades.
fn positive_ranges() -> impl Strategy<Value = (f64, f64)> {
    (-200.0..200.0f64, -5.0..1.5f64)
        .prop_map(|(from, decades)| (10f64.powf(from), 10f64.powf(from + 10f64.powf(decades))))
}

/// Checks what holds on every axis: inside the range, in order, with texts that differ.
fn check(ticks: &[Tick], from: f64, to: f64) {
    let slack = 1e-6 * (to - from);
    assert!(
        ticks.iter().all(|t| t.value >= from - slack && t.value <= to + slack),
        "{from:e} {to:e} {ticks:?}"
    );
    assert!(ticks.windows(2).all(|pair| pair[0].value < pair[1].value), "{ticks:?}");
    assert!(ticks.windows(2).all(|pair| pair[0].text != pair[1].text), "{from:e} {to:e} {ticks:?}");
    assert!(ticks.iter().all(|t| !t.text.is_empty() && !t.text.contains(['-', 'e', 'N'])), "{ticks:?}");
}

proptest! {
    #[test]
    fn linear_ticks_are_few_round_and_cover_the_axis((from, to) in ranges(), intervals in 2.0..12.0f64) {
        let (ticks, step) = (linear_ticks(from, to, intervals), linear_step(from, to, intervals));
        check(&ticks, from, to);
        prop_assert!(ticks.len() as f64 <= intervals + 1.0 + 1e-6, "{} ticks", ticks.len());
        prop_assert!(ticks.len() as f64 >= (intervals / 2.5).floor(), "{} ticks of {}", ticks.len(), intervals);
        let mantissa = step / 10f64.powf(step.log10().floor());
        let is_round = [1.0, 2.0, 5.0, 10.0].iter().any(|nice| (mantissa / nice - 1.0).abs() < 1e-6);
        prop_assert!(is_round, "step {:e}", step);
        // no part of the axis longer than a step is without a tick
        match (ticks.first(), ticks.last()) {
            (Some(first), Some(last)) => {
                prop_assert!(first.value - from < 1.001 * step && to - last.value < 1.001 * step);
            }
            // with room for fewer than 2.5 intervals, an axis may lie between two ticks
            _ => prop_assert!(to - from < 1.001 * step),
        }
        for tick in &ticks {
            let multiple = tick.value / step;
            prop_assert!((multiple - multiple.round()).abs() < 1e-6 * (1.0 + multiple.abs()));
        }
    }

    #[test]
    fn ticks_of_angles_are_parts_or_multiples_of_a_turn(from in -4000.0..4000.0f64, width in 10.0..9000.0f64) {
        let ticks = degree_ticks(from, from + width, 7.0);
        check(&ticks, from, from + width);
        prop_assert!((2..=8).contains(&ticks.len()), "{ticks:?}");
        let step = ticks[1].value - ticks[0].value;
        let is_part = (360.0 / step - (360.0 / step).round()).abs() < 1e-9;
        let is_multiple = (step / 360.0 - (step / 360.0).round()).abs() < 1e-9;
        prop_assert!(is_part || is_multiple, "{step}");
    }

    #[test]
    fn logarithmic_ticks_cover_the_axis((from, to) in positive_ranges()) {
        let ticks = logarithmic_ticks(from, to, 9.0);
        check(&ticks, from, to);
        prop_assert!((2..=10).contains(&ticks.len()), "{ticks:?}");
        let decades = (to / from).log10();
        if decades > 3.0 {
            let are_decades = ticks.iter().all(|t| (t.value.log10() - t.value.log10().round()).abs() < 1e-9);
            prop_assert!(are_decades, "{ticks:?}");
        }
        let minor = logarithmic_minor(from, to);
        prop_assert!(minor.iter().all(|value| (from..=to).contains(value)));
        prop_assert!(minor.len() <= 64);
    }

    #[test]
    fn a_ruler_places_its_values_and_finds_them_again((low, high) in ranges(), part in 0.0..1.0f64) {
        for scale in [Scale::Linear, Scale::Degrees] {
            let axis = Axis { scale, ..Axis::linear("y", "") };
            let ruler = Ruler::new(&axis, [low, high].into_iter(), Margin::Padded);
            let value = ruler.value_at(part);
            prop_assert!((ruler.place(value).unwrap() - part).abs() < 1e-6);
            prop_assert!(ruler.place(low).unwrap() >= 0.0 && ruler.place(high).unwrap() <= 1.0);
        }
    }

    #[test]
    fn a_logarithmic_ruler_places_its_values_and_finds_them_again((low, high) in positive_ranges(), part in 0.0..1.0f64) {
        let ruler = Ruler::new(&Axis::logarithmic("y", ""), [low, high].into_iter(), Margin::Padded);
        prop_assert!((ruler.place(ruler.value_at(part)).unwrap() - part).abs() < 1e-6);
        prop_assert!(ruler.place(low).unwrap() >= -1e-9 && ruler.place(high).unwrap() <= 1.0 + 1e-9);
        prop_assert!(ruler.place(-1.0).is_none() && ruler.place(0.0).is_none());
    }
}
