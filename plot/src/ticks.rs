//! The places of an axis' ticks, and their labels.
//!
//! One algorithm for every axis of the product: pages, exported pictures and the window. Each function takes the range of the
//! axis and the number of intervals for which there is room.

use crate::number::{short_number, superscript, times_power_of_ten, with_minus};
use crate::tolerance::{FEW_DECADES, MANY_DECADES, TICK_SLACK};

/// Parts of a turn that are round, in degrees.
const DEGREE_STEPS: [f64; 9] = [1.0, 2.0, 5.0, 15.0, 30.0, 45.0, 90.0, 180.0, 360.0];
/// Powers of ten that are short enough to be written as numbers: from 0.001 to 10000.
const SHORT_DECADES: std::ops::RangeInclusive<i32> = -3..=4;

/// A tick and its text.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// Position, in the unit of the axis.
    pub value: f64,
    /// The label.
    pub text: String,
}

/// Returns the step of ticks on a linear axis: the smallest of 1, 2 and 5 times a power of ten that makes at most `intervals`.
pub fn linear_step(from: f64, to: f64, intervals: f64) -> f64 {
    let wanted = to / intervals - from / intervals;
    let power = 10f64.powf(wanted.log10().floor());
    let mantissa = wanted / power;
    [1.0, 2.0, 5.0].into_iter().find(|nice| mantissa <= nice * (1.0 + TICK_SLACK)).unwrap_or(10.0) * power
}

/// Returns ticks of a linear axis; there are none if the range is empty or infinite, here and in the other functions.
pub fn linear_ticks(from: f64, to: f64, intervals: f64) -> Vec<Tick> {
    multiples(from, to, linear_step(from, to, intervals))
}

/// Returns ticks of an axis of angles: at parts of a turn, and at multiples of it on a long axis.
pub fn degree_ticks(from: f64, to: f64, intervals: f64) -> Vec<Tick> {
    let wanted = (to - from) / intervals;
    if wanted < DEGREE_STEPS[0] {
        return linear_ticks(from, to, intervals);
    }
    let step = DEGREE_STEPS.into_iter().find(|step| *step >= wanted);
    multiples(from, to, step.unwrap_or_else(|| 360.0 * linear_step(from / 360.0, to / 360.0, intervals)))
}

/// Returns ticks of a logarithmic axis: decades, on a short axis 1, 2 and 5 in each, and on one shorter still round numbers.
pub fn logarithmic_ticks(from: f64, to: f64, intervals: f64) -> Vec<Tick> {
    if !is_positive_range(from, to) {
        return Vec::new();
    }
    let (first, last) = (from.log10(), to.log10());
    let decades = whole_decades(first, last, intervals);
    if last - first >= FEW_DECADES && decades.len() >= 2 {
        return decades;
    }
    let parts = parts_of_decades(from, to);
    if parts.len() >= 2 { parts } else { linear_ticks(from, to, intervals) }
}

/// Returns the places of ticks without text on a logarithmic axis; there are none on an axis of many decades.
pub fn logarithmic_minor(from: f64, to: f64) -> Vec<f64> {
    let (first, last) = (from.log10(), to.log10());
    if !is_positive_range(from, to) || last - first > MANY_DECADES {
        return Vec::new();
    }
    let all = (first.floor() as i32..last.ceil() as i32)
        .flat_map(|decade| (2..10).map(move |k| f64::from(k) * 10f64.powi(decade)));
    all.filter(|value| (from..=to).contains(value)).collect()
}

fn is_positive_range(from: f64, to: f64) -> bool {
    0.0 < from && from < to && to.is_finite()
}

fn whole_decades(first: f64, last: f64, intervals: f64) -> Vec<Tick> {
    let widest = ((last - first) / intervals).ceil().max(1.0) as i32;
    let whole = ((first - TICK_SLACK).ceil() as i32)..=((last + TICK_SLACK).floor() as i32);
    let with_stride =
        |stride: i32| -> Vec<i32> { whole.clone().filter(|decade| decade.rem_euclid(stride) == 0).collect() };
    // of an axis that holds several decades two have a number, even if they stand closer than others would
    let enough = (1..=widest).rev().map(with_stride).find(|decades| decades.len() >= 2);
    let decades = enough.unwrap_or_else(|| with_stride(widest));
    // either all as numbers or all as powers
    let are_short = decades.iter().all(|decade| SHORT_DECADES.contains(decade));
    let text = |decade: i32| {
        if are_short { short_number(10f64.powi(decade)) } else { format!("10{}", superscript(decade)) }
    };
    decades.into_iter().map(|decade| Tick { value: 10f64.powi(decade), text: text(decade) }).collect()
}

fn parts_of_decades(from: f64, to: f64) -> Vec<Tick> {
    let decades = from.log10().floor() as i32..=to.log10().floor() as i32;
    let all = decades.flat_map(|decade| [1.0, 2.0, 5.0].map(|part| part * 10f64.powi(decade)));
    let within = all.filter(|value| (from..=to).contains(value));
    within.map(|value| Tick { value, text: short_number(value) }).collect()
}

fn multiples(from: f64, to: f64, step: f64) -> Vec<Tick> {
    let is_range = from.is_finite() && to.is_finite() && step > 0.0 && step.is_finite();
    if !is_range {
        return Vec::new();
    }
    let (first, last) = ((from / step - TICK_SLACK).ceil() as i64, (to / step + TICK_SLACK).floor() as i64);
    let largest = from.abs().max(to.abs());
    // adding 0 takes the sign from a zero
    let values = (first..=last).map(|k| k as f64 * step + 0.0);
    values.map(|value| Tick { value, text: multiple(value, step, largest) }).collect()
}

/// Writes a multiple of a step with as many digits as tell it from its neighbours, alike on the whole axis.
fn multiple(value: f64, step: f64, largest: f64) -> String {
    let (digit, exponent) = (exponent_of(step), exponent_of(largest));
    if value == 0.0 && !(-4..6).contains(&exponent) {
        return "0".to_owned();
    }
    if (-4..6).contains(&exponent) {
        let decimals = (-digit).clamp(0, 17) as usize;
        return with_minus(&format!("{value:.decimals$}"));
    }
    let decimals = (exponent - digit).clamp(0, 17) as usize;
    // in two factors: the power alone may be out of range
    let mantissa = value / 10f64.powi(exponent / 2) / 10f64.powi(exponent - exponent / 2);
    times_power_of_ten(&format!("{mantissa:.decimals$}"), exponent)
}

/// Returns the power of ten of a number's first digit.
fn exponent_of(value: f64) -> i32 {
    // a step such as 9.999e-5, which is 1e-4 but for rounding, counts as what it stands for
    (value.abs() * (1.0 + TICK_SLACK)).log10().floor() as i32
}
