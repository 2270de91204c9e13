//! Odd arguments for routines that must not panic: matrices of any scale, extreme and special numbers, and the assessment of the calls.

// each of the crates that share this module uses a part of it
#![allow(dead_code)]

use std::panic::{AssertUnwindSafe, catch_unwind};

use counterpoise_linalg::Mat;

/// A routine by name, and a call of it.
pub type Call<'a> = (&'static str, Box<dyn Fn() + 'a>);

/// Returns the next number in [0, 1) of a small generator (SplitMix64).
pub fn next_uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// Returns a whole number from 0 to below `most`.
pub fn size(state: &mut u64, most: f64) -> usize {
    (next_uniform(state) * most) as usize
}

/// Returns a matrix of zeros, of huge, tiny or whole entries, of entries over twelve decades, or of plain ones.
pub fn odd_matrix(state: &mut u64, rows: usize, cols: usize) -> Mat {
    let kind = size(state, 9.0);
    Mat::from_fn(rows, cols, |_, _| {
        let plain = 2.0 * next_uniform(state) - 1.0;
        match kind {
            0 => 0.0,
            1 => plain * 1e300,
            2 => plain * 1e-300,
            3 => (4.0 * plain).round(),
            4 => plain * 10f64.powf(12.0 * next_uniform(state) - 6.0),
            _ => plain,
        }
    })
}

/// Returns a number that an argument may not expect.
pub fn odd_number(state: &mut u64) -> f64 {
    let list = [0.0, -1.0, 0.03, 1.0, 1e-300, 1e300, f64::INFINITY, f64::NAN, 0.25, 1e9];
    list[size(state, list.len() as f64)]
}

/// Asserts that an answer holds no number that is none: `Ok` is as good as its entries. An error may quote what it refuses.
pub fn judge<T: std::fmt::Debug>(answer: T) {
    let text = format!("{answer:?}");
    let is_error = ["Err(", "Ok(Err(", "Some(Err("].iter().any(|start| text.starts_with(start));
    assert!(is_error || !text.contains("NaN"), "an answer with NaN");
}

/// Returns the names of the routines that panic, or answer with NaN.
pub fn panicking(calls: &[Call]) -> Vec<&'static str> {
    let panics = |call: &dyn Fn()| catch_unwind(AssertUnwindSafe(call)).is_err();
    calls.iter().filter(|(_, call)| panics(call)).map(|(name, _)| *name).collect()
}

/// Asserts that no call of `call_all` panics for a seed below `seeds`.
pub fn assert_none_panics(seeds: u64, call_all: &dyn Fn(u64) -> Vec<&'static str>) {
    std::panic::set_hook(Box::new(|_| ()));
    let all = (0..seeds).flat_map(|seed| call_all(seed).into_iter().map(move |name| (name, seed)));
    let mut found: Vec<(&str, u64)> = all.collect();
    let _ = std::panic::take_hook();
    found.sort_unstable();
    let count = found.len();
    found.dedup_by_key(|(name, _)| *name);
    assert!(found.is_empty(), "{count} panics, the first of each: {found:?}");
}
