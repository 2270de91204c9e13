//! Whether time has the unit that it seems to have.

/// A time column without a unit is refused if its steps differ from the sample period by more than this factor: no experiment is
/// recorded so much slower or faster than its controller runs, but a file in milliseconds is off by a thousand.
const FAR: f64 = 20.0;
/// Units that a time column may be in, with their size in seconds.
const UNITS: [(&str, f64); 5] = [("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9), ("min", 60.0), ("h", 3600.0)];
/// In its own unit, the steps of a time column match the sample period within this factor.
const MATCHES: f64 = 3.0;

/// Steps of a time that are far from the sample period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct DoubtfulUnit {
    /// The unit in which they would match it; `None` if they match it in none.
    pub(crate) meant: Option<&'static str>,
}

/// Returns that the steps of a time, taken as seconds, are far from the sample period; `None` if they are near it.
pub(crate) fn doubtful_unit(file_s: f64, project_s: f64) -> Option<DoubtfulUnit> {
    let is_within = |step_s: f64, factor: f64| step_s < factor * project_s && project_s < factor * step_s;
    if is_within(file_s, FAR) {
        return None;
    }
    let meant = UNITS.into_iter().find(|(_, size)| is_within(file_s * size, MATCHES)).map(|(unit, _)| unit);
    Some(DoubtfulUnit { meant })
}
