//! What a designer can do about each cause.

use crate::cause::{Cause, Hidden};

impl Cause {
    /// Returns what the designer can do about it.
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
            Cause::FreeControlUnseen { .. } => {
                "use a control weight that is not zero there, or the basis \"open-loop\""
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
            Cause::NoBandwidth { .. } => {
                "sample faster, remove delay, or lower the margins that are required; a plant with an unstable pole needs twice its rate as bandwidth"
            }
            Cause::SampledUnstable { .. } => "sample faster, or lower the crossover",
            _ => "look at the weight that is named",
        }
    }
}

impl Hidden {
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
