//! The numbers that decide when recordings are read, each with its reason.

/// A period that is this near to the project's, or to a whole number of microseconds, as a fraction of itself, is meant to be it: the times
/// of a file are rounded when they are written.
pub(crate) const SAME_PERIOD_BY_ROUNDING: f64 = 1e-6;

/// Places on a clock are compared with this margin, in samples: far above the rounding of their products, far below a sample.
pub(crate) const SAME_PLACE_SAMPLES: f64 = 1e-9;

/// By this much, in samples, the window of an average is moved so that the samples at its two ends count half each.
pub(crate) const WINDOW_SHIFT_SAMPLES: f64 = 1e-6;

/// An outlier is this many times farther from its neighbours' mean than nine in ten samples are from the sample before: 46 standard
/// deviations of white noise, which no healthy recorder shows.
pub(crate) const OUTLIER_DISTANCE: f64 = 20.0;

/// The neighbours of an outlier agree within this fraction of its distance: in a step or a slope they do not.
pub(crate) const OUTLIER_NEIGHBOURS: f64 = 0.1;

/// A larger fraction of outliers is a signal of pulses.
pub(crate) const MOST_OUTLIERS: f64 = 1e-3;

/// A file's period may differ from the project's by this fraction: what its times were rounded to when they were written.
pub(crate) const STATED_PERIOD: f64 = 1e-3;

/// A step of at least this many periods is a gap.
pub(crate) const GAP_PERIODS: f64 = 3.0;

/// Steps that scatter by less than this fraction of the period are even.
pub(crate) const EVEN_STEPS: f64 = 1e-3;

/// A gap of more than this many times the recording's own length is not a gap but a broken clock.
pub(crate) const LONGEST_GAP: f64 = 10.0;

/// A recording has at least this many rows: a sample period and its scatter need two steps.
pub(crate) const FEWEST_ROWS: usize = 3;

/// A time column without a unit is refused if its steps differ from the sample period by more than this factor: no experiment is
/// recorded so much slower or faster than its controller runs, but a file in milliseconds is off by a thousand.
pub(crate) const FAR_FROM_PERIOD: f64 = 20.0;

/// In its own unit, the steps of a time column match the sample period within this factor: units differ by 60 at least, so that one alone fits.
pub(crate) const MATCHES_PERIOD: f64 = 3.0;

/// A window has at least this many sample periods: fewer have no second difference.
pub(crate) const FEWEST_PERIODS: f64 = 2.0;

/// Samples for which signals make room when the first is added: a run of a second at 1 kHz does not grow.
pub(crate) const FIRST_ROOM: usize = 1024;
