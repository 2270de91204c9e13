//! Check of the unit that time seems to have.

use crate::tolerance::{FAR_FROM_PERIOD, MATCHES_PERIOD};

/// Units that a time column may be in, with their size in seconds.
const UNITS: [(&str, f64); 5] = [("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9), ("min", 60.0), ("h", 3600.0)];

/// Steps of a time that are far from the sample period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DoubtfulUnit {
    /// The unit in which they would match it; `None` if they match it in none.
    pub meant: Option<&'static str>,
}

/// Returns that the steps of a time, taken as seconds, are far from the sample period; `None` if they are near it.
pub(crate) fn doubtful_unit(file_s: f64, project_s: f64) -> Option<DoubtfulUnit> {
    let is_within = |step_s: f64, factor: f64| step_s < factor * project_s && project_s < factor * step_s;
    if is_within(file_s, FAR_FROM_PERIOD) {
        return None;
    }
    let meant =
        UNITS.into_iter().find(|(_, size)| is_within(file_s * size, MATCHES_PERIOD)).map(|(unit, _)| unit);
    Some(DoubtfulUnit { meant })
}
