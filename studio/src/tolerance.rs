//! The numbers that decide what the window shows or starts, each with its reason.

/// Smallest modulus that is shown: below it lies rounding, and 0 has no logarithm.
pub(crate) const SMALLEST_MODULUS: f64 = 1e-30;

/// Smallest value of a logarithmic axis: below it lies rounding.
pub(crate) const SMALLEST_VALUE: f64 = 1e-16;

/// Share above which a requirement counts as held by all mechanisms: rounding of a share of thousands.
pub(crate) const HELD_BY_ALL_SHARE: f64 = 0.999;

/// Smallest move of the slider that starts a trial, kg m: less is rounding of the slider.
pub(crate) const SMALLEST_TRIAL_KG_M: f64 = 0.05;

/// Largest out-of-balance that can be tried, kg m.
pub(crate) const LARGEST_TRIAL_KG_M: f64 = 400.0;

/// Relative difference of limits that is rounding.
pub(crate) const SAME_LIMITS: f64 = 1e-6;

/// Largest distance of a simplified curve from its points, in pixels: less than the eye can see.
pub(crate) const TOLERANCE_PX: f64 = 0.3;

/// Largest exponent of ten that a number can have.
pub(crate) const LARGEST_EXPONENT: f64 = 300.0;

/// Distance of a logarithmic tick from a whole power of ten, in decades, that is rounding.
pub(crate) const WHOLE_DECADE: f64 = 1e-6;

/// Shortest window of a recording, as a share of it: a shorter one could not be gripped again on a screen of a thousand points.
pub(crate) const SHORTEST_WINDOW_SHARE: f64 = 0.002;

/// Pause after which typing is another step of undo, s: longer than between two letters of a word, shorter than between two thoughts.
pub(crate) const TYPING_PAUSE_S: f64 = 1.0;

/// Fewest letters of a term that is looked for in a text: shorter ones stand for other things, too.
pub(crate) const SHORTEST_TERM: usize = 3;

/// Smallest limit of the largest sensitivity to which it is dragged: no loop is below 1, and the project file refuses 1.
pub(crate) const SMALLEST_SENSITIVITY_LIMIT: f64 = 1.01;

/// Largest distance of a click from the point of a design, as a share of the plot: about the size of a fingertip on a usual screen.
pub(crate) const CLICK_REACH: f64 = 0.04;

/// Points of a curve from which on those of one pixel column may be drawn as a band: about as many as a plot is wide in pixels. With fewer the band would
/// fill the corner of two steep lines.
pub(crate) const FEWEST_BAND_POINTS: usize = 600;

/// Angle to which a motion is magnified to be seen, rad: about a seventh of a right angle.
pub(crate) const SEEN_ANGLE_RAD: f64 = 0.22;
