//! Digits of numbers that a file states and the machine keeps in other terms.

/// Digits after the first that a number keeps.
const DIGITS: usize = 11;

/// Most digits after the first that a number has.
const MOST_DIGITS: usize = 16;

/// Returns the number of fewest digits beside `near` that `kept` turns into `value`, so that what is written comes back to the last bit; `near`
/// itself if none does.
pub(super) fn shortest_that_gives(value: f64, near: f64, kept: impl Fn(f64) -> f64) -> f64 {
    let with = |digits: usize| format!("{near:.digits$e}").parse::<f64>().ok();
    let beside = [near, near.next_up(), near.next_down()];
    let all = (DIGITS..=MOST_DIGITS).filter_map(with).chain(beside);
    all.into_iter().find(|written| kept(*written) == value).unwrap_or(near)
}

/// Returns a number to twelve digits: what was written in few of them comes back as it was written.
pub(super) fn round_to_digits(value: f64) -> f64 {
    format!("{value:.DIGITS$e}").parse().unwrap_or(value)
}
