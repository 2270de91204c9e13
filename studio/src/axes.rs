//! Marks and numbers of axes.

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
    let raw = ((high - low) / count).max(f64::MIN_POSITIVE);
    let decade = 10f64.powf(raw.log10().floor());
    let step_size = [1.0, 2.0, 5.0, 10.0].map(|k| k * decade).into_iter().find(|s| *s >= raw).unwrap_or(raw);
    let marks = (low / step_size).ceil() as i64..=(high / step_size).floor() as i64;
    marks.map(|k| GridMark { value: k as f64 * step_size, step_size }).collect()
}

/// A mark's number, with the digits that its step needs.
pub fn plain(mark: GridMark) -> String {
    let digits = (-mark.step_size.log10()).ceil().clamp(0.0, 9.0) as usize;
    format!("{:.digits$}", mark.value + 0.0)
}

/// Step of a mark without a number.
const BARE: f64 = 0.1;
/// Decades that are so few that 2 and 5 have numbers, too; and so many that what is between decades has no mark.
const FEW: f64 = 1.3;
const MANY: f64 = 7.0;

/// Marks of an axis that runs by decades.
fn decades(input: GridInput, count: f64) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let each = ((high - low) / count).ceil().max(1.0) as i64;
    let mut marks = Vec::new();
    for decade in low.floor() as i64..=high.ceil() as i64 {
        let step_size = if decade.rem_euclid(each) == 0 { 1.0 } else { BARE };
        marks.push(GridMark { value: decade as f64, step_size });
        if high - low <= MANY {
            let numbered = |k: i32| high - low < FEW && (k == 2 || k == 5);
            marks.extend((2..10).map(|k| GridMark {
                value: decade as f64 + f64::from(k).log10(),
                step_size: if numbered(k) { 1.0 } else { BARE },
            }));
        }
    }
    marks.retain(|mark| (low..=high).contains(&mark.value));
    marks
}

/// A mark of decades as its number; nothing where it has none.
pub fn power(mark: GridMark) -> String {
    if mark.step_size < 0.9 {
        return String::new();
    }
    match mark.value {
        -3.01..=4.01 => short(10f64.powf(mark.value)),
        _ => format!("1e{}", mark.value.round() as i32),
    }
}
