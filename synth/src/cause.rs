//! The faults of a design's problem, with its numbers.

use counterpoise_linalg::{C64, Reason};

use crate::bandwidth::BandwidthLimit;

/// Cause of a refusal or a warning, with its numbers.
#[derive(Debug, Clone, PartialEq)]
pub enum Cause {
    /// It lies in what the designer states.
    Specification(SpecificationCause),
    /// It lies in the plant, its channels, or the equations of the design on it.
    Plant(PlantCause),
}

impl Cause {
    /// Returns whether it is that the weights cross where a delay or a zero does not allow it.
    pub fn is_crossover_of_weights(&self) -> bool {
        matches!(self, Self::Plant(PlantCause::DelayLimits { .. } | PlantCause::ZeroLimits { .. }))
    }
}

/// A cause in what the designer states: weights, generators of disturbances and spectral densities.
#[derive(Debug, Clone, PartialEq)]
pub enum SpecificationCause {
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
    /// Control costs nothing if the error does not show it.
    ControlFreeUnseen,
    /// A feedforward's control is free where the closed loop cancels it.
    FreeControlUnseen {
        /// Corner below which the control costs, rad/s.
        moved_rad_s: f64,
    },
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
        /// Number that is needed.
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
        /// Stated density that is meant.
        of: StatedDensity,
        /// Value.
        value: f64,
    },
    /// Nothing disturbs the loop: the observer would not listen to the measurement.
    NothingDisturbs,
}

/// A cause in the plant, its channels, or the equations of the design on it.
#[derive(Debug, Clone, PartialEq)]
pub enum PlantCause {
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
        /// Rate at which the weights cross, rad/s.
        crossover_rad_s: f64,
    },
    /// The weights ask for a crossover beyond a zero in the right half plane.
    ZeroLimits {
        /// The zero.
        zero: C64,
        /// Rate at which the weights cross, rad/s.
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
    /// A mode of a generalised plant that one side of the problem does not meet.
    ModeHidden {
        /// Eigenvalue.
        mode: C64,
        /// Relative distance from being met.
        distance: f64,
        /// The part that does not meet it.
        from: HiddenDirection,
        /// The block that it lives in.
        block: ModeBlock,
    },
    /// A matrix equation without a stabilising solution.
    Equation {
        /// The equation.
        equation: DesignEquation,
        /// Why.
        reason: Reason,
    },
    /// A control without weight: D12 lacks full column rank.
    ControlUnweighed {
        /// Number, from 1: the one with most of the direction that is free.
        control: usize,
    },
    /// A measurement without noise: D21 lacks full row rank.
    MeasurementNoiseless {
        /// Number, from 1: the one with most of the direction that is free of noise.
        measurement: usize,
    },
    /// White noise reaches the weighted outputs directly: D11 is not zero.
    NoiseReachesCost {
        /// Largest entry.
        gain: f64,
    },
    /// No H-infinity bound was found that a controller reaches.
    NoBoundReached {
        /// The largest that was tried.
        largest: f64,
    },
    /// No bandwidth keeps what a first design must keep.
    NoBandwidth {
        /// The bandwidth up to which each limit alone would allow the loop.
        limits: Vec<BandwidthLimit>,
    },
    /// The sampled loop is not stable.
    SampledUnstable {
        /// The pole with the largest modulus.
        pole: C64,
        /// Sample period, s.
        period_s: f64,
    },
}

/// A spectral density that a designer states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StatedDensity {
    /// Of the noise of the measured signal.
    MeasurementNoise,
    /// Of the fictitious noise of loop recovery.
    LoopRecovery,
    /// Of a disturbance.
    Disturbance,
    /// Of the noise of the sensor that measures a disturbance.
    DisturbanceSensorNoise,
}

/// A matrix equation that a design solves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DesignEquation {
    /// The Riccati equation of the regulator.
    Regulator,
    /// Riccati equation of the filter.
    Filter,
    /// Riccati equation of the regulator in sampled time.
    SampledRegulator,
    /// Riccati equation of the filter in sampled time.
    SampledFilter,
    /// Riccati equation of the filter of the sensors of several disturbances together.
    JointFilter,
    /// Riccati equation of the filter of a measured disturbance.
    DisturbanceFilter,
}

/// The block of a generalised plant in which a mode lives.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ModeBlock {
    /// A block that has a name.
    Named(String),
    /// Without names: the state with most of the mode, from 1.
    State(usize),
    /// The plant has no states.
    Plant,
}

/// Signal that a hidden mode does not meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HiddenDirection {
    /// No control reaches it, and it is not stable.
    Control,
    /// No measurement shows it, and it is not stable.
    Measurement,
    /// No weighted output shows it, and it lies on the stability boundary.
    Cost,
    /// No disturbance and no noise excites it, and it lies on the stability boundary.
    Noise,
}
