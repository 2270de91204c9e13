//! Limits of what is reported, and of the scaling of a machine whose size is not the usual one.

/// Inertia, kg m^2, and gear ratio of the machines for which the library's sizes are meant.
pub const USUAL_INERTIA_AND_RATIO: (f64, f64) = (345.0, 200.0);
/// Torque of the drive at the hub of those machines, N m.
pub const USUAL_TORQUE_NM: f64 = 600.0;
/// Factors of inertia and gear ratio within which a machine is taken as it is.
pub const UNSCALED_WITHIN: (f64, f64) = (20.0, 5.0);
/// Multiple of the typical size beyond which no size is reported: the effect does not move these recordings.
pub const LARGEST_REPORTED_MULTIPLE: f64 = 100.0;
/// Travel below which the sine of the angle and the angle itself are one: they differ by less than 1 % of the largest torque.
pub const SMALL_TRAVEL_RAD: f64 = 0.5;

/// Least information of an effect: keeps the smallest change that would show finite where an effect changes nothing at all.
pub const LEAST_INFORMATION: f64 = 1e-12;
/// Multiple of an effect's typical size above which the smallest detectable size must lie for the recordings not to excite it.
pub const EXCITED_MULTIPLE: f64 = 2.0;
/// Least distance from the noise floors that a share is taken of: below, nothing is left to explain.
pub const LEAST_DISTANCE: f64 = 1e-3;
/// Distance from a whole number of samples up to which a reading may be late by samples.
pub const WHOLE_SAMPLES: f64 = 0.15;
