//! Handles of a weight on its Bode plot: where they stand, and which of its numbers they change.

use crate::weight::Weight;

/// A place on a Bode plot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandlePosition {
    /// Frequency, rad/s.
    pub rate_rad_s: f64,
    /// Modulus.
    pub magnitude: f64,
}

/// A handle on a weight.
#[derive(Debug, Clone, PartialEq)]
pub struct WeightHandle {
    /// Its name: "gain", "corner", "corner and damping".
    pub name: &'static str,
    /// Its place.
    pub position: HandlePosition,
    /// The keys that it changes.
    pub effect: HandleEffect,
}

/// The change of a handle when it is moved along the frequency axis or up and down. Keys are below the weight's path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HandleEffect {
    /// Up and down: `gain` in proportion.
    Gain,
    /// Along: `time` = 1/w; up and down: `gain`.
    TimeAndGain,
    /// Along: `corner` (or `natural_frequency`, `centre`); up and down: `gain`.
    CornerAndGain(&'static str),
    /// Along: `second` and `first` at the same damping; up and down: `first`.
    Quadratic,
    /// Along: `second` at the same `first`.
    Second,
    /// Along: `natural_frequency`; up and down: `damping_ratio`.
    Resonance,
    /// Along: the corner alone.
    Corner(&'static str),
    /// Up and down: this key in proportion.
    Level(&'static str),
    /// Along: `centre`; up and down: `factor`.
    Notch,
}

/// A number of a weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightNumber {
    /// Its key in the table of the weight.
    pub key: &'static str,
    /// Its value, in the unit of the project file.
    pub value: f64,
}

const fn number(key: &'static str, value: f64) -> WeightNumber {
    WeightNumber { key, value }
}

/// Returns the numbers of a weight as the project file has them; empty for a form without plain numbers.
pub fn weight_numbers(weight: &Weight) -> Vec<WeightNumber> {
    match weight {
        Weight::Constant { gain } => vec![number("gain", *gain)],
        Weight::Integral { gain, time_s } | Weight::Lag { gain, time_s } | Weight::Lead { gain, time_s } => {
            vec![number("gain", *gain), number("time", *time_s)]
        }
        Weight::Quadratic { gain, second_s2, first_s }
        | Weight::QuadraticFreeAtZero { gain, second_s2, first_s } => {
            vec![number("gain", *gain), number("second", *second_s2), number("first", *first_s)]
        }
        Weight::Shelf { low, high, corner_rad_s } => {
            vec![number("low", *low), number("high", *high), number("corner", *corner_rad_s)]
        }
        Weight::Notch { gain, centre_rad_s, width, factor } => {
            vec![
                number("gain", *gain),
                number("centre", *centre_rad_s),
                number("width", *width),
                number("factor", *factor),
            ]
        }
        Weight::ZeroPoleGain { zeros, poles, gain } => match (&zeros[..], &poles[..]) {
            ([zero], [pole]) if pole.norm() == 0.0 && zero.im == 0.0 => {
                vec![number("gain", *gain), number("corner", -zero.re)]
            }
            ([], [a, _]) if a.norm() > 0.0 => {
                let w = a.norm();
                vec![
                    number("gain", gain / (w * w)),
                    number("natural_frequency", w),
                    number("damping_ratio", -a.re / w),
                ]
            }
            _ => Vec::new(),
        },
        Weight::Product(_) | Weight::Table { .. } => Vec::new(),
    }
}

/// Returns the name of a weight's form, as the file spells it.
pub fn form_name(weight: &Weight) -> &'static str {
    match weight {
        Weight::Constant { .. } => "constant",
        Weight::Integral { .. } => "integral",
        Weight::Lag { .. } => "lag",
        Weight::Lead { .. } => "lead",
        Weight::Quadratic { .. } => "quadratic",
        Weight::QuadraticFreeAtZero { .. } => "quadratic-free-at-zero",
        Weight::Shelf { .. } => "shelf",
        Weight::Notch { .. } => "notch",
        Weight::ZeroPoleGain { zeros, .. } => match (zeros.len(), weight_numbers(weight).len()) {
            (_, 2) => "proportional-integral",
            (_, 3) => "second-order",
            _ => "zero-pole-gain",
        },
        Weight::Product(_) => "product",
        Weight::Table { .. } => "table",
    }
}

fn find_number(numbers: &[WeightNumber], key: &str) -> Option<f64> {
    numbers.iter().find(|number| number.key == key).map(|number| number.value)
}

/// Returns the handles of a weight; a form without plain numbers has none.
pub fn weight_handles(weight: &Weight) -> Vec<WeightHandle> {
    let numbers = weight_numbers(weight);
    let handle = |name, rate_rad_s: f64, magnitude: f64, effect| WeightHandle {
        name,
        position: HandlePosition { rate_rad_s, magnitude },
        effect,
    };
    let at = |name, rate: f64, effect| handle(name, rate, weight.magnitude(rate), effect);
    let Some(gain) = find_number(&numbers, "gain").or_else(|| find_number(&numbers, "low")) else {
        return Vec::new();
    };
    let gain = gain.abs();
    match (form_name(weight), &numbers[..]) {
        ("constant", _) => vec![handle("gain", 10.0, gain, HandleEffect::Gain)],
        ("integral" | "lag" | "lead", [_, WeightNumber { value: time, .. }]) => {
            vec![handle("corner and gain", 1.0 / time, gain, HandleEffect::TimeAndGain)]
        }
        ("proportional-integral", [_, WeightNumber { value: corner, .. }]) => {
            vec![handle("corner and gain", *corner, gain, HandleEffect::CornerAndGain("corner"))]
        }
        ("quadratic", [_, WeightNumber { value: second, .. }, _]) if *second > 0.0 => {
            let natural = 1.0 / second.sqrt();
            vec![
                at("gain", 0.1 * natural, HandleEffect::Gain),
                at("corner and damping", natural, HandleEffect::Quadratic),
            ]
        }
        (
            "quadratic-free-at-zero",
            [_, WeightNumber { value: second, .. }, WeightNumber { value: first, .. }],
        ) if *second > 0.0 && *first > 0.0 => {
            let corner = first / second;
            vec![at("gain", 0.1 * corner, HandleEffect::Gain), at("corner", corner, HandleEffect::Second)]
        }
        ("second-order", [_, WeightNumber { value: natural, .. }, _]) => {
            vec![
                at("gain", 0.1 * natural, HandleEffect::Gain),
                at("corner and damping", *natural, HandleEffect::Resonance),
            ]
        }
        ("shelf", [_, _, WeightNumber { value: corner, .. }]) => vec![
            at("low gain", 0.01 * corner, HandleEffect::Level("low")),
            at("corner", *corner, HandleEffect::Corner("corner")),
            at("high gain", 100.0 * corner, HandleEffect::Level("high")),
        ],
        ("notch", [_, WeightNumber { value: centre, .. }, ..]) => {
            vec![
                at("gain", 0.1 * centre, HandleEffect::Gain),
                at("centre and depth", *centre, HandleEffect::Notch),
            ]
        }
        _ => Vec::new(),
    }
}

/// Smallest and largest damping ratio that a handle gives: below, the resonance is too sharp to be drawn.
const DAMPING: (f64, f64) = (0.02, 1.0);

/// Returns the numbers that put a handle of a weight at a position.
pub fn move_handle(weight: &Weight, handle: &WeightHandle, to: HandlePosition) -> Vec<WeightNumber> {
    let HandlePosition { rate_rad_s, magnitude } = to;
    let numbers = weight_numbers(weight);
    let now = |key: &str| find_number(&numbers, key).unwrap_or(1.0);
    let scale = magnitude / handle.position.magnitude;
    match handle.effect {
        HandleEffect::Gain => vec![number("gain", now("gain") * scale)],
        HandleEffect::Level(key) => vec![number(key, now(key) * scale)],
        HandleEffect::TimeAndGain => {
            vec![number("gain", now("gain") * scale), number("time", 1.0 / rate_rad_s)]
        }
        HandleEffect::CornerAndGain(key) => {
            vec![number("gain", now("gain") * scale), number(key, rate_rad_s)]
        }
        HandleEffect::Corner(key) => vec![number(key, rate_rad_s)],
        HandleEffect::Quadratic => {
            let damping = 0.5 * magnitude / now("gain").abs();
            vec![number("second", rate_rad_s.powi(-2)), number("first", 2.0 * damping / rate_rad_s)]
        }
        HandleEffect::Second => vec![number("second", now("first") / rate_rad_s)],
        HandleEffect::Resonance => {
            let damping = (0.5 * now("gain").abs() / magnitude).clamp(DAMPING.0, DAMPING.1);
            vec![number("natural_frequency", rate_rad_s), number("damping_ratio", damping)]
        }
        HandleEffect::Notch => {
            vec![number("centre", rate_rad_s), number("factor", magnitude / now("gain").abs())]
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use counterpoise_linalg::C64;

    fn all() -> Vec<Weight> {
        let pole = C64::new(-14.0, 14.282_856_857_085_7);
        vec![
            Weight::Constant { gain: 300.0 },
            Weight::Lead { gain: 1.0, time_s: 0.005 },
            Weight::Quadratic { gain: 1.0, second_s2: 1e-4, first_s: 1.4e-2 },
            Weight::QuadraticFreeAtZero { gain: 1.0, second_s2: 1e-4, first_s: 1.4e-2 },
            Weight::Shelf { low: 3.0, high: 0.1, corner_rad_s: 10.0 },
            Weight::Notch { gain: 2.0, centre_rad_s: 110.0, width: 0.3, factor: 0.1 },
            Weight::ZeroPoleGain { zeros: vec![C64::new(-13.0, 0.0)], poles: vec![C64::ZERO], gain: 25.0 },
            Weight::ZeroPoleGain { zeros: vec![], poles: vec![pole, pole.conj()], gain: 400.0 },
        ]
    }

    #[test]
    fn a_handle_left_where_it_stands_changes_nothing() {
        for weight in all() {
            let before = weight_numbers(&weight);
            for handle in weight_handles(&weight) {
                for WeightNumber { key, value } in move_handle(&weight, &handle, handle.position) {
                    let was = find_number(&before, key).unwrap();
                    assert!((value / was - 1.0).abs() < 6e-3, "{weight}: {key} {was} -> {value}");
                }
            }
        }
    }

    #[test]
    fn every_plain_form_has_a_handle_and_its_name() {
        for weight in all() {
            assert!(!weight_handles(&weight).is_empty(), "{weight}");
            assert_ne!(form_name(&weight), "zero-pole-gain");
        }
    }

    #[test]
    fn corner_and_damping_go_where_they_are_put() {
        let quadratic = Weight::Quadratic { gain: 1.0, second_s2: 1e-4, first_s: 1.4e-2 };
        let handle = &weight_handles(&quadratic)[1];
        let new = move_handle(&quadratic, handle, HandlePosition { rate_rad_s: 200.0, magnitude: 1.0 });
        let moved = Weight::Quadratic {
            gain: 1.0,
            second_s2: find_number(&new, "second").unwrap(),
            first_s: find_number(&new, "first").unwrap(),
        };
        let stands = &weight_handles(&moved)[1];
        assert!((stands.position.rate_rad_s / 200.0 - 1.0).abs() < 1e-2);
        assert!((stands.position.magnitude - 1.0).abs() < 1e-2);
    }
}
