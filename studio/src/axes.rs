//! Marks and numbers of axes.

use counterpoise_plot::ticks;
use egui_plot::{GridInput, GridMark};

use crate::chart::Scale;
use crate::number::short;

/// How far apart the numbers of an axis should stand, points.
pub const X_APART: f32 = 58.0;
/// How far apart they should stand one above the other.
pub const Y_APART: f32 = 34.0;

/// Marks of an axis that has room for some numbers.
pub fn marks(scale: Scale, input: GridInput, room: f32) -> Vec<GridMark> {
    match scale {
        Scale::Linear => even(input, f64::from(room.max(2.0))),
        Scale::Log => decades(input, f64::from(room.max(2.0))),
    }
}

/// Marks of an even axis, at round numbers.
fn even(input: GridInput, count: f64) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let step_size = ticks::linear_step(low, high, count);
    let mark = |tick: ticks::Tick| GridMark { value: tick.value, step_size };
    ticks::linear(low, high, count).into_iter().map(mark).collect()
}

/// A mark's number, with the digits that its step needs.
pub fn plain(mark: GridMark) -> String {
    let digits = (-mark.step_size.log10()).ceil().clamp(0.0, 9.0) as usize;
    format!("{:.digits$}", mark.value + 0.0)
}

/// Step of a mark with a number on an axis that runs by decades, and of one without.
const NUMBERED: f64 = 1.0;
const BARE: f64 = 0.1;
/// Powers of ten beyond this are no numbers.
const FARTHEST: f64 = 300.0;

/// Marks of an axis that runs by decades; its coordinates are powers of ten.
fn decades(input: GridInput, count: f64) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let (from, to) = (10f64.powf(low.max(-FARTHEST)), 10f64.powf(high.min(FARTHEST)));
    let mark = |value: f64, step_size| GridMark { value: value.log10(), step_size };
    let numbered = ticks::logarithmic(from, to, count).into_iter().map(|tick| mark(tick.value, NUMBERED));
    let bare = ticks::logarithmic_minor(from, to).into_iter().map(|value| mark(value, BARE));
    numbered.chain(bare).collect()
}

/// A mark of decades as its number; nothing where it has none.
pub fn power(mark: GridMark) -> String {
    if mark.step_size < 0.9 {
        return String::new();
    }
    let is_decade = (mark.value - mark.value.round()).abs() < 1e-6;
    if is_decade && !(-3.01..=4.01).contains(&mark.value) {
        format!("1e{}", mark.value.round() as i32)
    } else {
        short(10f64.powf(mark.value))
    }
}
