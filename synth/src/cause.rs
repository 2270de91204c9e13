//! What can be wrong with a design's problem, and what helps: the two texts of every finding.

use counterpoise_linalg::C64;

use crate::bandwidth::Limit;

/// What is wrong, with its numbers.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Cause {
    /// A weight is zero everywhere, or one of its numbers is not finite.
    #[error("the weight is zero or one of its numbers is not finite")]
    WeightVoid,
    /// Zeros and poles of a weight do not make a real function.
    #[error("a complex root of the weight lacks its conjugate")]
    WeightComplex,
    /// An error weight that rises without bound.
    #[error(
        "the error weight rises with the power {excess} of frequency: the noise would cost infinitely much"
    )]
    ErrorWeightImproper {
        /// Zeros in excess of poles.
        excess: i32,
    },
    /// A control weight that vanishes at high frequency.
    #[error("the control weight falls with the power {excess} of frequency: fast control would be free")]
    ControlWeightVanishes {
        /// Poles in excess of zeros.
        excess: i32,
    },
    /// A weight with roots in the right half plane.
    #[error("the root {root:.4} lies in the right half plane and is mirrored: only the modulus counts")]
    WeightMirrored {
        /// The root.
        root: C64,
    },
    /// The plant cannot act where the error weight is infinite.
    #[error(
        "the error weight is infinite where the plant cannot act (its gain there is {relative_gain:.1e} of its largest)"
    )]
    PlantZeroAtErrorPole {
        /// Plant gain there over its largest.
        relative_gain: f64,
    },
    /// The hub sensor is blind where the error weight is infinite.
    #[error("the error weight is infinite where the hub sensor reads nothing")]
    SensorBlindAtErrorPole,
    /// Control costs nothing where the error does not show it.
    #[error("control costs nothing where the weighted error does not show it")]
    ControlFreeUnseen,
    /// A feedforward's control is free where the closed loop cancels it.
    #[error(
        "control is free where the closed loop's rate does not show it: it is given a cost below {moved_rad_s} rad/s"
    )]
    FreeControlUnseen {
        /// Corner below which the control costs, rad/s.
        moved_rad_s: f64,
    },
    /// Error and control weight are infinite at the same frequency.
    #[error("error weight and control weight are both infinite")]
    WeightsBothInfinite,
    /// The disturbance's generator passes white noise on.
    #[error("the disturbance's generator passes white noise on: infinite power")]
    GeneratorNotProper,
    /// The disturbance's generator has a pole that is not in the left half plane.
    #[error("the disturbance's generator has the pole {pole:.4}: its power grows without bound")]
    GeneratorUnstable {
        /// The pole.
        pole: C64,
    },
    /// The generator is not smooth enough for the derivatives that act on the plant.
    #[error(
        "the disturbance acts through its derivatives, but its generator has {relative_degree} more poles than zeros where {needed} are needed"
    )]
    GeneratorTooRough {
        /// Poles in excess of zeros.
        relative_degree: i32,
        /// How many are needed.
        needed: usize,
    },
    /// Exact knowledge of a disturbance whose states are not all known.
    #[error(
        "exact knowledge is assumed of {order} states of the disturbance, but {known} signals act on the plant"
    )]
    KnowledgeIncomplete {
        /// Order of the generator.
        order: usize,
        /// Signals that are known.
        known: usize,
    },
    /// A spectral density that is not positive where it must be.
    #[error("the spectral density of {what} is {value}")]
    Density {
        /// Which.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// Nothing disturbs the loop: the observer would not listen to the measurement.
    #[error("nothing disturbs the loop, so the observer ignores the measurement")]
    NothingDisturbs,
    /// A mode that is not stable and that the control does not reach.
    #[error("the control does not reach the mode {pole:.4}")]
    NotStabilisable {
        /// The mode's pole.
        pole: C64,
    },
    /// A mode that is not stable and that the measurement does not show.
    #[error("the measured rate does not show the mode {pole:.4}")]
    NotDetectable {
        /// The mode's pole.
        pole: C64,
    },
    /// An undamped mode that no noise excites.
    #[error("no disturbance excites the undamped mode {pole:.4}")]
    NoiseMissesMode {
        /// The mode's pole.
        pole: C64,
    },
    /// The control reaches the rate without delay.
    #[error("the control reaches the measured rate directly (gain {gain:.3e})")]
    DirectPath {
        /// The direct gain.
        gain: f64,
    },
    /// A delay that the design leaves out.
    #[error("the delay of {delay_s} s is left out (Pade order 0)")]
    DelayLeftOut {
        /// The delay, s.
        delay_s: f64,
    },
    /// The weights ask for a crossover that the delay does not allow.
    #[error("the weights cross at {crossover_rad_s:.1} rad/s, where the delay of {delay_s} s costs {:.0} degrees", (delay_s * crossover_rad_s).to_degrees())]
    DelayLimits {
        /// The delay, s.
        delay_s: f64,
        /// Where the weights cross, rad/s.
        crossover_rad_s: f64,
    },
    /// The weights ask for a crossover beyond a zero in the right half plane.
    #[error("the weights cross at {crossover_rad_s:.1} rad/s, beyond the right half plane zero {zero:.4}")]
    ZeroLimits {
        /// The zero.
        zero: C64,
        /// Where the weights cross, rad/s.
        crossover_rad_s: f64,
    },
    /// A feedforward is asked for a disturbance that the plant has no input for.
    #[error("the plant has no input for this disturbance")]
    ChannelMissing,
    /// The disturbance does not reach the rate.
    #[error("this disturbance does not reach the rate")]
    ChannelWithoutEffect,
    /// A feedforward whose error cannot stay bounded: a mode of the plant or of the error weight is not stable, and
    /// noise in the disturbance's sensor reaches it.
    #[error("sensor noise reaches the mode {pole:.4}, which the feedforward alone cannot keep bounded")]
    FeedforwardUnbounded {
        /// The mode's pole.
        pole: C64,
    },
    /// The demand would enter the error weight's states, of which there are none.
    #[error("the demand would enter the error weight's states, of which there are none")]
    ReferenceWithoutStates,
    /// A mode of a generalised plant that one side of the problem does not meet.
    #[error("{} (relative distance {distance:.1e})", from.sentence(*mode, block))]
    ModeHidden {
        /// Its eigenvalue.
        mode: C64,
        /// Relative distance from being met.
        distance: f64,
        /// What does not meet it.
        from: Hidden,
        /// The block that it lives in.
        block: String,
    },
    /// A matrix equation without a stabilising solution.
    #[error("{what} has no stabilising solution: {reason}")]
    Equation {
        /// Which equation.
        what: &'static str,
        /// Why.
        reason: String,
    },
    /// A control without weight: D12 lacks full column rank.
    #[error("control {control} has no weight of its own (D12 lacks full column rank)")]
    ControlUnweighed {
        /// Its number, from 1: the one with most of the direction that is free.
        control: usize,
    },
    /// A measurement without noise: D21 lacks full row rank.
    #[error("measurement {measurement} has no noise of its own (D21 lacks full row rank)")]
    MeasurementNoiseless {
        /// Its number, from 1: the one with most of the direction that is free of noise.
        measurement: usize,
    },
    /// White noise reaches the weighted outputs directly: D11 is not zero.
    #[error("white noise reaches the weighted outputs directly (D11 up to {gain:.3e}): infinite cost")]
    NoiseReachesCost {
        /// Its largest entry.
        gain: f64,
    },
    /// No H-infinity bound was found that a controller reaches.
    #[error("no controller keeps a bound up to {largest:.3e}")]
    NoBoundReached {
        /// The largest that was tried.
        largest: f64,
    },
    /// No bandwidth keeps what a first design must keep.
    #[error("no bandwidth keeps every limit: {}", limits_in_words(limits))]
    NoBandwidth {
        /// The bandwidth up to which each limit alone would allow the loop.
        limits: Vec<Limit>,
    },
    /// The sampled loop is not stable.
    #[error("sampled every {period_s} s the loop has the pole {pole:.6}, of modulus {:.6}", pole.norm())]
    SampledUnstable {
        /// The pole with the largest modulus.
        pole: C64,
        /// Sample period, s.
        period_s: f64,
    },
}

/// What does not meet a mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hidden {
    /// No control reaches it, and it is not stable.
    Control,
    /// No measurement shows it, and it is not stable.
    Measurement,
    /// No weighted output shows it, and it lies on the stability boundary.
    Cost,
    /// No disturbance and no noise excites it, and it lies on the stability boundary.
    Noise,
}

impl Hidden {
    fn sentence(self, mode: C64, block: &str) -> String {
        let at = if mode.im == 0.0 {
            format!("the mode {:.6} of {block}", mode.re)
        } else {
            format!("the mode {:.6} +/- {:.6}j of {block}", mode.re, mode.im.abs())
        };
        match self {
            Hidden::Control => format!("no control reaches {at}, which is not stable"),
            Hidden::Measurement => format!("no measurement shows {at}, which is not stable"),
            Hidden::Cost => format!("no weighted output shows {at}, which lies on the stability boundary"),
            Hidden::Noise => {
                format!("no disturbance or noise excites {at}, which lies on the stability boundary")
            }
        }
    }
}

/// The limits, each with its number.
fn limits_in_words(limits: &[Limit]) -> String {
    let words: Vec<String> = limits
        .iter()
        .filter(|limit| limit.bandwidth_rad_s.is_finite())
        .map(|limit| format!("{} up to {:.3e} rad/s", limit.kind, limit.bandwidth_rad_s))
        .collect();
    if words.is_empty() { "no loop was stable".to_owned() } else { words.join(", ") }
}
