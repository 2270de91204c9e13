//! What can be wrong with a design's problem, and what helps: the two texts of every finding.

use counterpoise_lti::C64;

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

    fn suggestion(self) -> &'static str {
        match self {
            Hidden::Control => {
                "let a control act on it, or leave it out; a block that is there twice is connected once, by name"
            }
            Hidden::Measurement => {
                "measure it, or leave it out; a block that is there twice is connected once, by name"
            }
            Hidden::Cost => "weigh an output that shows it, or move a weight's pole off the axis",
            Hidden::Noise => {
                "let a disturbance excite it, if only a little, or move a weight's pole off the axis"
            }
        }
    }
}

impl Cause {
    /// What the designer can do about it.
    pub fn suggestion(&self) -> &'static str {
        match self {
            Cause::WeightVoid => "give it a gain and time constants that are not zero",
            Cause::WeightComplex => "give complex roots in conjugate pairs",
            Cause::ErrorWeightImproper { .. } => "give the error weight as many poles as zeros",
            Cause::ControlWeightVanishes { .. } => {
                "give the control weight as many zeros as poles, K (a s + 1) for instance"
            }
            Cause::WeightMirrored { .. } => "write the root with a negative real part",
            Cause::PlantZeroAtErrorPole { .. } => {
                "use K / (a s + 1) in place of K / (a s), or control the angle rather than the rate"
            }
            Cause::SensorBlindAtErrorPole => {
                "use a sensor that reads there, or an error weight that is finite there"
            }
            Cause::ControlFreeUnseen => {
                "use a control weight that is not zero there, K (b s^2 + a s + 1) for instance"
            }
            Cause::WeightsBothInfinite => "keep one of the two finite there",
            Cause::GeneratorNotProper => "give the generator more poles than zeros",
            Cause::GeneratorUnstable { .. } => {
                "move the pole into the left half plane, at the lowest frequency that matters"
            }
            Cause::GeneratorTooRough { .. } => {
                "give the generator more poles than zeros by the number of inputs of the channel"
            }
            Cause::KnowledgeIncomplete { .. } => {
                "use a generator of that order, or say what noise the sensor has"
            }
            Cause::Density { .. } => {
                "give a positive number (zero is allowed for disturbances and loop recovery)"
            }
            Cause::NothingDisturbs => "give a loop recovery or a disturbance a positive density",
            other => other.plant_suggestion(),
        }
    }

    /// The same for causes that lie in the plant, the channels or the equations.
    fn plant_suggestion(&self) -> &'static str {
        match self {
            Cause::NotStabilisable { .. } => "remove the mode from the plant, or give it an actuator",
            Cause::NotDetectable { .. } => {
                "remove the mode from the plant (the hub angle, where only rate is measured), or measure it"
            }
            Cause::NoiseMissesMode { .. } => {
                "give the loop recovery a positive density, or the mode some damping"
            }
            Cause::DirectPath { .. } => "model the sensor or the delay",
            Cause::DelayLeftOut { .. } => "use a Pade order of 1 or 2",
            Cause::DelayLimits { .. } => {
                "raise the control weight or lower the error weight, or sample faster"
            }
            Cause::ZeroLimits { .. } => {
                "raise the control weight or lower the error weight until they cross below half the zero"
            }
            Cause::ChannelMissing => "name its input, or leave the feedforward out",
            Cause::ChannelWithoutEffect => "leave the feedforward out: it would be zero",
            Cause::FeedforwardUnbounded { .. } => {
                "use an error weight that is finite at that frequency, or let the feedback hold the mode"
            }
            Cause::ReferenceWithoutStates => {
                "let the demand enter through the error, or use an error weight with a pole"
            }
            Cause::ModeHidden { from, .. } => from.suggestion(),
            Cause::Equation { .. } => {
                "give the mode named an input, a sensor, a weight or a noise; a block that is there twice is connected once, by name"
            }
            Cause::ControlUnweighed { .. } => "weigh every control, if only lightly",
            Cause::MeasurementNoiseless { .. } => "give every measurement a noise, if only a small one",
            Cause::NoiseReachesCost { .. } => "let the noise pass a filter, or the weighted output one",
            Cause::NoBoundReached { .. } => {
                "look for a mode on the axis that no control reaches or no measurement shows"
            }
            Cause::SampledUnstable { .. } => "sample faster, or lower the crossover",
            _ => "look at the weight that is named",
        }
    }
}
