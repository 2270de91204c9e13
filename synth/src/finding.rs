//! What stands in a design's way, said so that a designer can act: which weight, at which frequency, and what to do.

use std::fmt;

use counterpoise_lti::C64;

/// Whether a design can go on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// The problem has no solution as it is put.
    Refusal,
    /// There is a solution, but perhaps not the one that is wanted.
    Warning,
}

/// Which part of the design is concerned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The plant, its sensors or its delay.
    Plant,
    /// The feedback.
    Feedback,
    /// The heave feedforward.
    Heave,
    /// The pitch feedforward.
    Pitch,
    /// A generalised plant.
    Generalised,
}

impl From<crate::Channel> for Part {
    fn from(channel: crate::Channel) -> Self {
        match channel {
            crate::Channel::Heave => Part::Heave,
            crate::Channel::Pitch => Part::Pitch,
        }
    }
}

/// What is wrong, with its numbers.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Cause {
    /// A weight is zero everywhere, or one of its numbers is not finite.
    WeightVoid,
    /// Zeros and poles of a weight do not make a real function.
    WeightComplex,
    /// An error weight that rises without bound.
    ErrorWeightImproper {
        /// Zeros in excess of poles.
        excess: i32,
    },
    /// A control weight that vanishes at high frequency.
    ControlWeightVanishes {
        /// Poles in excess of zeros.
        excess: i32,
    },
    /// A weight with roots in the right half plane.
    WeightMirrored {
        /// The root.
        root: C64,
    },
    /// The plant cannot act where the error weight is infinite.
    PlantZeroAtErrorPole {
        /// Plant gain there over its largest.
        relative_gain: f64,
    },
    /// The hub sensor is blind where the error weight is infinite.
    SensorBlindAtErrorPole,
    /// Control costs nothing where the error does not show it.
    ControlFreeUnseen,
    /// Error and control weight are infinite at the same frequency.
    WeightsBothInfinite,
    /// The disturbance's generator passes white noise on.
    GeneratorNotProper,
    /// The disturbance's generator has a pole that is not in the left half plane.
    GeneratorUnstable {
        /// The pole.
        pole: C64,
    },
    /// The generator is not smooth enough for the derivatives that act on the plant.
    GeneratorTooRough {
        /// Poles in excess of zeros.
        relative_degree: i32,
        /// How many are needed.
        needed: usize,
    },
    /// Exact knowledge of a disturbance whose states are not all known.
    KnowledgeIncomplete {
        /// Order of the generator.
        order: usize,
        /// Signals that are known.
        known: usize,
    },
    /// A spectral density that is not positive where it must be.
    Density {
        /// Which.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// Nothing disturbs the loop: the observer would not listen to the measurement.
    NothingDisturbs,
    /// A mode that is not stable and that the control does not reach.
    NotStabilisable {
        /// The mode's pole.
        pole: C64,
    },
    /// A mode that is not stable and that the measurement does not show.
    NotDetectable {
        /// The mode's pole.
        pole: C64,
    },
    /// An undamped mode that no noise excites.
    NoiseMissesMode {
        /// The mode's pole.
        pole: C64,
    },
    /// The control reaches the rate without delay.
    DirectPath {
        /// The direct gain.
        gain: f64,
    },
    /// A delay that the design leaves out.
    DelayLeftOut {
        /// The delay, s.
        delay_s: f64,
    },
    /// The weights ask for a crossover that the delay does not allow.
    DelayLimits {
        /// The delay, s.
        delay_s: f64,
        /// Where the weights cross, rad/s.
        crossover_rad_s: f64,
    },
    /// The weights ask for a crossover beyond a zero in the right half plane.
    ZeroLimits {
        /// The zero.
        zero: C64,
        /// Where the weights cross, rad/s.
        crossover_rad_s: f64,
    },
    /// A feedforward is asked for a disturbance that the plant has no input for.
    ChannelMissing,
    /// The disturbance does not reach the rate.
    ChannelWithoutEffect,
    /// A feedforward whose error cannot stay bounded: a mode of the plant or of the error weight is not stable, and
    /// noise in the disturbance's sensor reaches it.
    FeedforwardUnbounded {
        /// The mode's pole.
        pole: C64,
    },
    /// The demand would enter the error weight's states, of which there are none.
    ReferenceWithoutStates,
    /// A matrix equation without a stabilising solution.
    Equation {
        /// Which equation.
        what: &'static str,
        /// Why.
        reason: String,
    },
    /// A control without weight: D12 lacks full column rank.
    ControlUnweighed,
    /// A measurement without noise: D21 lacks full row rank.
    MeasurementNoiseless,
    /// White noise reaches the weighted outputs directly: D11 is not zero.
    NoiseReachesCost {
        /// Its largest entry.
        gain: f64,
    },
    /// No H-infinity bound was found that a controller reaches.
    NoBoundReached {
        /// The largest that was tried.
        largest: f64,
    },
    /// The sampled loop is not stable.
    SampledUnstable {
        /// The pole with the largest modulus.
        pole: C64,
        /// Sample period, s.
        period_s: f64,
    },
}

/// One thing that stands in a design's way.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Whether the design can go on.
    pub severity: Severity,
    /// Which part is concerned.
    pub part: Part,
    /// The weight that is concerned, as role and formula.
    pub weight: Option<String>,
    /// The frequency that is concerned, rad/s; infinite for "at high frequency".
    pub rate_rad_s: Option<f64>,
    /// What is wrong.
    pub cause: Cause,
}

impl Finding {
    /// A refusal.
    pub fn refusal(part: Part, cause: Cause) -> Self {
        Self { severity: Severity::Refusal, part, weight: None, rate_rad_s: None, cause }
    }

    /// A warning.
    pub fn warning(part: Part, cause: Cause) -> Self {
        Self { severity: Severity::Warning, ..Self::refusal(part, cause) }
    }

    /// With the weight named.
    pub fn on(self, role: &str, weight: &crate::Weight) -> Self {
        Self { weight: Some(format!("{role} {weight}")), ..self }
    }

    /// With the frequency named.
    pub fn at(self, rate_rad_s: f64) -> Self {
        Self { rate_rad_s: Some(rate_rad_s), ..self }
    }

    /// Whether the design cannot go on.
    pub fn is_refusal(&self) -> bool {
        self.severity == Severity::Refusal
    }

    /// What the designer can do about it.
    pub fn suggestion(&self) -> &'static str {
        suggestion(&self.cause)
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.part)?;
        if let Some(weight) = &self.weight {
            write!(f, ", {weight}")?;
        }
        match self.rate_rad_s {
            Some(rate) if rate.is_infinite() => write!(f, ", at high frequency")?,
            Some(rate) => write!(f, ", at {rate:.4} rad/s")?,
            None => {}
        }
        write!(f, ": {}; {}", self.cause, self.suggestion())
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Part::Plant => "plant",
            Part::Feedback => "feedback",
            Part::Heave => "heave feedforward",
            Part::Pitch => "pitch feedforward",
            Part::Generalised => "generalised plant",
        })
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Cause::WeightVoid => write!(f, "the weight is zero or one of its numbers is not finite"),
            Cause::WeightComplex => write!(f, "a complex root of the weight lacks its conjugate"),
            Cause::ErrorWeightImproper { excess } => {
                write!(
                    f,
                    "the error weight rises with the power {excess} of frequency: the noise would cost infinitely much"
                )
            }
            Cause::ControlWeightVanishes { excess } => {
                write!(
                    f,
                    "the control weight falls with the power {excess} of frequency: fast control would be free"
                )
            }
            Cause::WeightMirrored { root } => {
                write!(
                    f,
                    "the root {root:.4} lies in the right half plane and is mirrored: only the modulus counts"
                )
            }
            Cause::PlantZeroAtErrorPole { relative_gain } => write!(
                f,
                "the error weight is infinite where the plant cannot act (its gain there is {relative_gain:.1e} of its largest)"
            ),
            Cause::SensorBlindAtErrorPole => {
                write!(f, "the error weight is infinite where the hub sensor reads nothing")
            }
            Cause::ControlFreeUnseen => {
                write!(f, "control costs nothing where the weighted error does not show it")
            }
            Cause::WeightsBothInfinite => write!(f, "error weight and control weight are both infinite"),
            Cause::GeneratorNotProper => {
                write!(f, "the disturbance's generator passes white noise on: infinite power")
            }
            Cause::GeneratorUnstable { pole } => {
                write!(f, "the disturbance's generator has the pole {pole:.4}: its power grows without bound")
            }
            Cause::GeneratorTooRough { relative_degree, needed } => write!(
                f,
                "the disturbance acts through its derivatives, but its generator has {relative_degree} more poles than zeros where {needed} are needed"
            ),
            Cause::KnowledgeIncomplete { order, known } => {
                write!(
                    f,
                    "exact knowledge is assumed of {order} states of the disturbance, but {known} signals act on the plant"
                )
            }
            Cause::Density { what, value } => write!(f, "the spectral density of {what} is {value}"),
            Cause::NothingDisturbs => {
                write!(f, "nothing disturbs the loop, so the observer ignores the measurement")
            }
            Cause::NotStabilisable { pole } => write!(f, "the control does not reach the mode {pole:.4}"),
            Cause::NotDetectable { pole } => write!(f, "the measured rate does not show the mode {pole:.4}"),
            Cause::NoiseMissesMode { pole } => {
                write!(f, "no disturbance excites the undamped mode {pole:.4}")
            }
            Cause::DirectPath { gain } => {
                write!(f, "the control reaches the measured rate directly (gain {gain:.3e})")
            }
            Cause::DelayLeftOut { delay_s } => {
                write!(f, "the delay of {delay_s} s is left out (Pade order 0)")
            }
            Cause::DelayLimits { delay_s, crossover_rad_s } => {
                write!(
                    f,
                    "the weights cross at {crossover_rad_s:.1} rad/s, where the delay of {delay_s} s costs {:.0} degrees",
                    (delay_s * crossover_rad_s).to_degrees()
                )
            }
            Cause::ZeroLimits { zero, crossover_rad_s } => {
                write!(
                    f,
                    "the weights cross at {crossover_rad_s:.1} rad/s, beyond the right half plane zero {zero:.4}"
                )
            }
            Cause::ChannelMissing => write!(f, "the plant has no input for this disturbance"),
            Cause::ChannelWithoutEffect => write!(f, "this disturbance does not reach the rate"),
            Cause::FeedforwardUnbounded { pole } => {
                write!(
                    f,
                    "sensor noise reaches the mode {pole:.4}, which the feedforward alone cannot keep bounded"
                )
            }
            Cause::ReferenceWithoutStates => {
                write!(f, "the demand would enter the error weight's states, of which there are none")
            }
            Cause::Equation { what, reason } => write!(f, "{what} has no stabilising solution: {reason}"),
            Cause::ControlUnweighed => write!(f, "a control has no weight (D12 lacks full column rank)"),
            Cause::MeasurementNoiseless => write!(f, "a measurement has no noise (D21 lacks full row rank)"),
            Cause::NoiseReachesCost { gain } => {
                write!(
                    f,
                    "white noise reaches the weighted outputs directly (D11 up to {gain:.3e}): infinite cost"
                )
            }
            Cause::NoBoundReached { largest } => write!(f, "no controller keeps a bound up to {largest:.3e}"),
            Cause::SampledUnstable { pole, period_s } => {
                write!(
                    f,
                    "sampled every {period_s} s the loop has the pole {pole:.6}, of modulus {:.6}",
                    pole.norm()
                )
            }
        }
    }
}

fn suggestion(cause: &Cause) -> &'static str {
    match cause {
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
        Cause::NotStabilisable { .. } => "remove the mode from the plant, or give it an actuator",
        Cause::NotDetectable { .. } => {
            "remove the mode from the plant (the hub angle, where only rate is measured), or measure it"
        }
        Cause::NoiseMissesMode { .. } => {
            "give the loop recovery a positive density, or the mode some damping"
        }
        Cause::DirectPath { .. } => "model the sensor or the delay",
        Cause::DelayLeftOut { .. } => "use a Pade order of 1 or 2",
        Cause::DelayLimits { .. } => "raise the control weight or lower the error weight, or sample faster",
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
        Cause::Equation { .. } => "raise the weight or noise that the mode named needs",
        Cause::ControlUnweighed => "weigh every control, if only lightly",
        Cause::MeasurementNoiseless => "give every measurement a noise, if only a small one",
        Cause::NoiseReachesCost { .. } => "let the noise pass a filter, or the weighted output one",
        Cause::NoBoundReached { .. } => {
            "look for a mode on the axis that no control reaches or no measurement shows"
        }
        Cause::SampledUnstable { .. } => "sample faster, or lower the crossover",
    }
}
