//! Seeds of random numbers.

use crate::file::field::{Field, NumberRange};
use crate::file::visit::Visit;

/// Reads or lists a seed of random numbers.
pub(crate) fn seed(v: &mut dyn Visit, meaning: &'static str, seed: &mut u64) {
    let mut whole = u32::try_from(*seed).unwrap_or(u32::MAX);
    let range = NumberRange::Between(0.0, f64::from(u32::MAX));
    v.whole_number(&Field::new("seed", meaning).limit(range).or(1.0).show_default(), &mut whole);
    *seed = u64::from(whole);
}
