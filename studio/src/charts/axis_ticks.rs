//! Ticks and numbers of axes.

use crate::tolerance::{LARGEST_EXPONENT, WHOLE_DECADE};
use counterpoise_plot::ticks;
use egui_plot::{GridInput, GridMark};

use super::chart::AxisScale;
use crate::number_format::format_short;

/// Distance of the numbers on an x axis, points: a number of five digits and a gap.
pub const X_DISTANCE: f32 = 58.0;
/// Distance of the numbers on a y axis, points: twice the height of a line.
pub const Y_DISTANCE: f32 = 34.0;

/// Returns the ticks of an axis that has room for some numbers.
pub fn axis_ticks(scale: AxisScale, input: GridInput, number_count: f32) -> Vec<GridMark> {
    match scale {
        AxisScale::Linear => linear_ticks(input, f64::from(number_count.max(2.0))),
        AxisScale::Log => decade_ticks(input, f64::from(number_count.max(2.0))),
    }
}

/// Returns the ticks of a linear axis, at round numbers.
fn linear_ticks(input: GridInput, count: f64) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let step_size = ticks::linear_step(low, high, count);
    let mark = |tick: ticks::Tick| GridMark { value: tick.value, step_size };
    ticks::linear_ticks(low, high, count).into_iter().map(mark).collect()
}

/// Writes the number of a linear tick, with the digits that its step needs.
pub fn format_linear_tick(mark: GridMark) -> String {
    let digits = (-mark.step_size.log10()).ceil().clamp(0.0, 9.0) as usize;
    format!("{:.digits$}", mark.value + 0.0)
}

/// Step of a tick with a number on a logarithmic axis, by which the formatter recognises it.
const NUMBERED: f64 = 1.0;
/// Step of a tick without a number.
const BARE: f64 = 0.1;

/// Returns the ticks of a logarithmic axis; its coordinates are exponents of ten.
fn decade_ticks(input: GridInput, count: f64) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let (from, to) = (10f64.powf(low.max(-LARGEST_EXPONENT)), 10f64.powf(high.min(LARGEST_EXPONENT)));
    let mark = |value: f64, step_size| GridMark { value: value.log10(), step_size };
    let numbered =
        ticks::logarithmic_ticks(from, to, count).into_iter().map(|tick| mark(tick.value, NUMBERED));
    let bare = ticks::logarithmic_minor(from, to).into_iter().map(|value| mark(value, BARE));
    numbered.chain(bare).collect()
}

/// Writes the number of a logarithmic tick; a tick between the numbered ones has none.
pub fn format_decade_tick(mark: GridMark) -> String {
    if mark.step_size < 0.9 {
        return String::new();
    }
    let is_decade = (mark.value - mark.value.round()).abs() < WHOLE_DECADE;
    if is_decade && !(-3.01..=4.01).contains(&mark.value) {
        format!("1e{}", mark.value.round() as i32)
    } else {
        format_short(10f64.powf(mark.value))
    }
}
