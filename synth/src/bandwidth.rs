//! The limits of a loop's bandwidth.

/// Kind of limit of a bandwidth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LimitKind {
    /// A twentieth of the sample rate, lowered by what is not known.
    SampleRate,
    /// The margins: delay, hold, lags of sensors and drive, zeros and poles of the right half plane.
    Margins,
    /// Modes that are lightly damped, which may be off by a fraction of their frequency.
    Resonance,
    /// The control that the noise of the readings costs.
    Noise,
    /// The control that the quantisation of the readings costs.
    Quantisation,
    /// The control's limit, at the step of the demand.
    Control,
    /// The forces that the linear plant leaves out and the loop must hold all the same: dry friction at rest, gravity's gradient.
    AtRest,
    /// Values of the machine that are known within tolerances.
    Tolerances,
    /// Values that are not stated, over their usual ranges.
    UsualRanges,
    /// The value that was requested.
    Asked,
}

/// A limit of the bandwidth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandwidthLimit {
    /// Kind of the limit.
    pub kind: LimitKind,
    /// The highest bandwidth that it allows, rad/s; infinite if it allows every one that was looked at.
    pub bandwidth_rad_s: f64,
    /// The share of what it allows that the loop uses up; `None` if there is no loop.
    pub used: Option<f64>,
    /// The bandwidth if this limit alone were lifted, rad/s; `None` if it would be no higher.
    pub lifted_rad_s: Option<f64>,
}

/// A fact of the loop that is not known, and lowers the ceiling of the bandwidth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unknown {
    /// No mode of the structure or the transmission is known.
    Structure,
    /// Neither noise nor resolution of the readings is known.
    Noise,
    /// No lag of the sensor is known.
    Sensor,
    /// No delay is known.
    Delay,
    /// No step of the demand is stated.
    Demand,
    /// No limit of the drive is stated.
    DriveLimit,
}

/// A bandwidth with its limits.
#[derive(Debug, Clone, PartialEq)]
pub struct Bandwidth {
    /// The bandwidth that was reached, rad/s.
    pub bandwidth_rad_s: f64,
    /// Deciding limits: the limit whose lifting alone raises it most, or, if none does, those of which the loop uses up nearly all.
    pub limited_by: Vec<LimitKind>,
    /// Every limit: those whose lifting alone raises the bandwidth first, by how much they do; then by how much of them the loop uses up.
    pub limits: Vec<BandwidthLimit>,
    /// Unknown facts.
    pub unknown: Vec<Unknown>,
    /// Requested value, rad/s.
    pub asked_rad_s: Option<f64>,
}
