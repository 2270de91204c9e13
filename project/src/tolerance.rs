//! The numbers that decide when a project file is checked, each with its reason.

/// Two ends of sections closer than this fraction of the beam's length adjoin.
pub(crate) const ADJOINING_SHARE: f64 = 1e-9;

/// Relative difference between two sample periods that is rounding in a file.
pub(crate) const SAME_SAMPLE_PERIOD: f64 = 1e-6;

/// Fraction of a sample period that is rounding when a delay is counted in whole samples.
pub(crate) const WHOLE_DELAY: f64 = 1e-9;

/// Sizes that a number of a machine can have: beyond them squares overflow or vanish.
pub(crate) const NUMBER_SIZES: std::ops::RangeInclusive<f64> = 1e-40..=1e40;

/// Distance of a sensor's own sample period from a whole number of samples that a file may round, in samples.
pub(crate) const ROUNDED_PERIOD: f64 = 1e-6;

/// Least cosine of the elevation at which a feedforward from an elevated accelerometer can be designed on heave: 84 degrees. Beyond, the sensor
/// feels next to nothing of heave, and the design would divide by it.
pub(crate) const LEAST_SHARE_OF_HEAVE: f64 = 0.1;

/// Fraction by which a beam's lumped and distributed description may differ: more than what
/// is lost when mass and inertia are written with two digits, less than a part of the beam.
pub(crate) const BEAM_AGREEMENT: f64 = 0.02;

/// A mass lies on the beam if it is within this fraction of the beam's length beyond its ends: farther out it is a mass on an arm of its own,
/// or its place is in another unit.
pub(crate) const BEAM_OVERHANG: f64 = 0.1;

/// Most samples by which a sensor may be late: each is a state of the sampled plant, and the time of its eigenvalues grows with their cube.
pub(crate) const MOST_SENSOR_DELAY_SAMPLES: f64 = 1000.0;

/// Largest number of samples over which a position is differenced: a rate of later than that closes no loop.
pub(crate) const MOST_RATE_SAMPLES: f64 = 1000.0;

/// Smallest lever of a linkage, as a share of the shorter of its radii: at its dead centre a linkage has none, and the torque of a cylinder
/// is not defined there.
pub(crate) const LEAST_LEVER: f64 = 1e-3;

/// Most bits that a converter may have: beyond, double precision has no smaller step over its range.
pub(crate) const MOST_CONVERTER_BITS: f64 = 52.0;

/// Most samples by which the control may be held back: each is a state of the sampled plant, as with a sensor.
pub(crate) const MOST_CONTROL_DELAY_SAMPLES: f64 = 1000.0;

/// Largest share of samples that are missed or late, and of codes that are missing: beyond, it is no loop or no converter.
pub(crate) const MOST_ERRANT: f64 = 0.5;

/// Largest tilt of an accelerometer, rad: beyond, it reads another axis.
pub(crate) const MOST_TILT_RAD: f64 = 0.8;

/// Most mechanisms of a campaign: what a campaign estimates has converged long before, so more is a mistyped number.
pub(crate) const MOST_CAMPAIGN_SAMPLES: f64 = 1e7;

/// Most samples of a run whose length is not written: a machine that is sampled at 100 kHz moves in a tenth of the time of one at
/// 10 kHz, and a default shall not take minutes. Machines that are sampled at 4 kHz or more slowly move for the usual time.
pub(crate) const MOST_UNSTATED_SAMPLES: f64 = 4e4;

/// Deviation of a fitted weight from a point of its table that is allowed, dB: so far a first-order weight is from its
/// asymptotes at its corner, from which tables are often written.
pub(crate) const FITTED_WEIGHT_DB: f64 = 3.0;

/// Shortest sample period of a controller, s: a clock of 1 MHz is a thousand times as quick as any mechanism follows.
pub(crate) const SHORTEST_PERIOD_S: f64 = 1e-6;
