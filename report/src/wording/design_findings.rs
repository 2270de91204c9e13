//! The obstacles of a design, in words that a designer can act on: which weight, at which frequency, and what to do.

use counterpoise_linalg::C64;
use counterpoise_plot::number::short_number;
use counterpoise_synth::{
    BandwidthLimit, Cause, ConcernedWeight, DesignEquation, DesignFinding, HiddenDirection, LimitKind,
    ModeBlock, Part, PlantCause, SpecificationCause, StatedDensity, Unknown, WeightRole,
};

/// Describes a finding in one line: the part, the weight and the frequency that are concerned, what is wrong, and what to do.
pub fn describe_design_finding(finding: &DesignFinding) -> String {
    let weight = finding.weight.as_ref().map_or(String::new(), describe_weight);
    let at = match finding.rate_rad_s {
        Some(rate) if rate.is_infinite() => ", at high frequency".to_owned(),
        Some(0.0) => ", at zero frequency".to_owned(),
        Some(rate) => format!(", at {rate:.4} rad/s"),
        None => String::new(),
    };
    let (part, cause) = (describe_part(finding.part), describe_cause(&finding.cause));
    format!("{part}{weight}{at}: {cause}; {}", suggest_remedy(&finding.cause))
}

/// Describes findings in one line.
pub fn describe_design_findings(findings: &[DesignFinding]) -> String {
    findings.iter().map(describe_design_finding).collect::<Vec<_>>().join("; ")
}

/// Describes an error of the synthesis: every finding of a refusal, or the error itself.
pub fn describe_synthesis_error(error: &counterpoise_synth::Error) -> String {
    match error.findings() {
        [] => error.to_string(),
        findings => describe_design_findings(findings),
    }
}

/// Returns the name of a part of a design.
pub fn describe_part(part: Part) -> &'static str {
    match part {
        Part::Plant => "plant",
        Part::Feedback => "feedback",
        Part::Heave => "heave feedforward",
        Part::Pitch => "pitch feedforward",
        Part::Generalised => "generalised plant",
    }
}

/// Describes what is wrong, with its numbers.
pub fn describe_cause(cause: &Cause) -> String {
    match cause {
        Cause::Specification(cause) => describe_cause_in_specification(cause),
        Cause::Plant(cause) => describe_cause_in_plant(cause),
    }
}

fn describe_cause_in_specification(cause: &SpecificationCause) -> String {
    match cause {
        SpecificationCause::WeightVoid => "the weight is zero or one of its numbers is not finite".to_owned(),
        SpecificationCause::WeightComplex => "a complex root of the weight lacks its conjugate".to_owned(),
        SpecificationCause::ErrorWeightImproper { excess } => format!(
            "the error weight rises with the power {excess} of frequency: the noise would cost infinitely much"
        ),
        SpecificationCause::ControlWeightVanishes { excess } => format!(
            "the control weight falls with the power {excess} of frequency: fast control would be free"
        ),
        SpecificationCause::WeightMirrored { root } => format!(
            "the root {root:.4} lies in the right half plane and is mirrored: only the modulus counts"
        ),
        SpecificationCause::PlantZeroAtErrorPole { relative_gain } => format!(
            "the error weight is infinite where the plant cannot act (its gain there is {relative_gain:.1e} of its largest)"
        ),
        SpecificationCause::SensorBlindAtErrorPole => {
            "the error weight is infinite where the hub sensor reads nothing".to_owned()
        }
        SpecificationCause::ControlFreeUnseen => {
            "control costs nothing where the weighted error does not show it".to_owned()
        }
        SpecificationCause::FreeControlUnseen { moved_rad_s } => format!(
            "control is free where the closed loop's rate does not show it: it is given a cost below {moved_rad_s} rad/s"
        ),
        SpecificationCause::WeightsBothInfinite => {
            "error weight and control weight are both infinite".to_owned()
        }
        SpecificationCause::GeneratorNotProper => {
            "the disturbance's generator passes white noise on: infinite power".to_owned()
        }
        SpecificationCause::GeneratorUnstable { pole } => {
            format!("the disturbance's generator has the pole {pole:.4}: its power grows without bound")
        }
        SpecificationCause::GeneratorTooRough { relative_degree, needed } => format!(
            "the disturbance acts through its derivatives, but its generator has {relative_degree} more poles than zeros where {needed} are needed"
        ),
        SpecificationCause::KnowledgeIncomplete { order, known } => format!(
            "exact knowledge is assumed of {order} states of the disturbance, but {known} signals act on the plant"
        ),
        SpecificationCause::Density { of, value } => {
            format!("the spectral density of {} is {value}", describe_density(*of))
        }
        SpecificationCause::NothingDisturbs => {
            "nothing disturbs the loop, so the observer ignores the measurement".to_owned()
        }
    }
}

fn describe_cause_in_plant(cause: &PlantCause) -> String {
    match cause {
        PlantCause::NotStabilisable { pole } => format!("the control does not reach the mode {pole:.4}"),
        PlantCause::NotDetectable { pole } => format!("the measured rate does not show the mode {pole:.4}"),
        PlantCause::NoiseMissesMode { pole } => format!("no disturbance excites the undamped mode {pole:.4}"),
        PlantCause::DirectPath { gain } => {
            format!("the control reaches the measured rate directly (gain {gain:.3e})")
        }
        PlantCause::DelayLeftOut { delay_s } => {
            format!("the delay of {delay_s} s is left out (Pade order 0)")
        }
        PlantCause::DelayLimits { delay_s, crossover_rad_s } => format!(
            "the weights cross at {crossover_rad_s:.1} rad/s, where the delay of {delay_s} s costs {:.0} degrees",
            (delay_s * crossover_rad_s).to_degrees()
        ),
        PlantCause::ZeroLimits { zero, crossover_rad_s } => format!(
            "the weights cross at {crossover_rad_s:.1} rad/s, beyond the right half plane zero {zero:.4}"
        ),
        PlantCause::ChannelMissing => "the plant has no input for this disturbance".to_owned(),
        PlantCause::ChannelWithoutEffect => "this disturbance does not reach the rate".to_owned(),
        PlantCause::FeedforwardUnbounded { pole } => format!(
            "sensor noise reaches the mode {pole:.4}, which the feedforward alone cannot keep bounded"
        ),
        PlantCause::ReferenceWithoutStates => {
            "the demand would enter the error weight's states, of which there are none".to_owned()
        }
        PlantCause::ModeHidden { mode, distance, from, block } => {
            format!("{} (relative distance {distance:.1e})", describe_hidden(*from, *mode, block))
        }
        PlantCause::Equation { equation, reason } => {
            format!("{} has no stabilising solution: {reason}", describe_equation(*equation))
        }
        PlantCause::ControlUnweighed { control } => {
            format!("control {control} has no weight of its own (D12 lacks full column rank)")
        }
        PlantCause::MeasurementNoiseless { measurement } => {
            format!("measurement {measurement} has no noise of its own (D21 lacks full row rank)")
        }
        PlantCause::NoiseReachesCost { gain } => {
            format!("white noise reaches the weighted outputs directly (D11 up to {gain:.3e}): infinite cost")
        }
        PlantCause::NoBoundReached { largest } => {
            format!("no controller keeps a bound up to {}", short_number(*largest))
        }
        PlantCause::NoBandwidth { limits } => {
            format!("no bandwidth keeps every limit: {}", describe_limits(limits))
        }
        PlantCause::SampledUnstable { pole, period_s } => format!(
            "sampled every {period_s} s the loop has the pole {pole:.6}, of modulus {:.6}",
            pole.norm()
        ),
    }
}

fn describe_weight(weight: &ConcernedWeight) -> String {
    let role = match weight.role {
        WeightRole::Error => "error weight",
        WeightRole::Control => "control weight",
        WeightRole::Generator => "generator",
    };
    format!(", {role} {}", weight.weight)
}

fn describe_density(of: StatedDensity) -> &'static str {
    match of {
        StatedDensity::MeasurementNoise => "the measurement noise",
        StatedDensity::LoopRecovery => "the loop recovery",
        StatedDensity::Disturbance => "a disturbance",
        StatedDensity::DisturbanceSensorNoise => "the disturbance sensor's noise",
    }
}

fn describe_equation(equation: DesignEquation) -> &'static str {
    match equation {
        DesignEquation::Regulator => "the regulator's equation",
        DesignEquation::Filter => "the filter's equation",
        DesignEquation::SampledRegulator => "the regulator's equation in sampled time",
        DesignEquation::SampledFilter => "the filter's equation in sampled time",
        DesignEquation::JointFilter => "the equation of the joint filter",
        DesignEquation::DisturbanceFilter => "the equation of the disturbance's filter",
    }
}

fn describe_hidden(from: HiddenDirection, mode: C64, block: &ModeBlock) -> String {
    let block = match block {
        ModeBlock::Named(name) => name.clone(),
        ModeBlock::State(number) => format!("state {number}"),
        ModeBlock::Plant => "the plant".to_owned(),
    };
    let at = if mode.im == 0.0 {
        format!("the mode {:.6} of {block}", mode.re)
    } else {
        format!("the mode {:.6} +/- {:.6}j of {block}", mode.re, mode.im.abs())
    };
    match from {
        HiddenDirection::Control => format!("no control reaches {at}, which is not stable"),
        HiddenDirection::Measurement => format!("no measurement shows {at}, which is not stable"),
        HiddenDirection::Cost => {
            format!("no weighted output shows {at}, which lies on the stability boundary")
        }
        HiddenDirection::Noise => {
            format!("no disturbance or noise excites {at}, which lies on the stability boundary")
        }
    }
}

/// Describes the limits of a bandwidth, each with its number.
fn describe_limits(limits: &[BandwidthLimit]) -> String {
    let words: Vec<String> = limits
        .iter()
        .filter(|limit| limit.bandwidth_rad_s.is_finite())
        .map(|limit| match limit.bandwidth_rad_s {
            0.0 => format!("{} at none", describe_limit(limit.kind)),
            rate => format!("{} up to {} rad/s", describe_limit(limit.kind), short_number(rate)),
        })
        .collect();
    if words.is_empty() { "no loop was stable".to_owned() } else { words.join(", ") }
}

/// Returns the name of what limits a bandwidth.
pub fn describe_limit(kind: LimitKind) -> &'static str {
    match kind {
        LimitKind::SampleRate => "sample rate",
        LimitKind::Margins => "margins (delay and lags)",
        LimitKind::Resonance => "resonance",
        LimitKind::Noise => "noise",
        LimitKind::Quantisation => "quantisation",
        LimitKind::Control => "control limit",
        LimitKind::AtRest => "friction at rest, gravity",
        LimitKind::Tolerances => "tolerances of the file",
        LimitKind::UsualRanges => "usual ranges of what the file leaves open",
        LimitKind::Asked => "what is asked for",
    }
}

/// Returns the names of several limits that bind together.
pub fn join_limits(kinds: &[LimitKind]) -> String {
    kinds.iter().map(|kind| describe_limit(*kind)).collect::<Vec<_>>().join(" and ")
}

/// Describes a fact of the loop that is not known.
pub fn describe_unknown(unknown: Unknown) -> &'static str {
    match unknown {
        Unknown::Structure => "a flexible mode of structure or transmission",
        Unknown::Noise => "noise or resolution of the measured signal",
        Unknown::Sensor => "the lag of the sensor",
        Unknown::Delay => "the delay of the loop",
        Unknown::Demand => "the largest step of the demand",
        Unknown::DriveLimit => "the limit of the drive",
    }
}

/// Returns whether no loop at all keeps the share of the control that noise or quantisation may take.
fn is_drive_too_weak(limits: &[BandwidthLimit]) -> bool {
    let is_of_readings = |kind| matches!(kind, LimitKind::Noise | LimitKind::Quantisation);
    limits.iter().any(|limit| is_of_readings(limit.kind) && limit.bandwidth_rad_s == 0.0)
}

/// Returns what the designer can do about a cause.
pub fn suggest_remedy(cause: &Cause) -> &'static str {
    match cause {
        Cause::Specification(cause) => suggest_remedy_in_specification(cause),
        Cause::Plant(cause) => suggest_remedy_in_plant(cause),
    }
}

fn suggest_remedy_in_specification(cause: &SpecificationCause) -> &'static str {
    match cause {
        SpecificationCause::WeightVoid => "give it a gain and time constants that are not zero",
        SpecificationCause::WeightComplex => "give complex roots in conjugate pairs",
        SpecificationCause::ErrorWeightImproper { .. } => "give the error weight as many poles as zeros",
        SpecificationCause::ControlWeightVanishes { .. } => {
            "give the control weight as many zeros as poles, K (a s + 1) for instance"
        }
        SpecificationCause::WeightMirrored { .. } => "write the root with a negative real part",
        SpecificationCause::PlantZeroAtErrorPole { .. } => {
            "use K / (a s + 1) in place of K / (a s), or control the angle rather than the rate"
        }
        SpecificationCause::SensorBlindAtErrorPole => {
            "use a sensor that reads there, or an error weight that is finite there"
        }
        SpecificationCause::ControlFreeUnseen => {
            "use a control weight that is not zero there, K (b s^2 + a s + 1) for instance"
        }
        SpecificationCause::FreeControlUnseen { .. } => {
            "use a control weight that is not zero there, or the basis \"open-loop\""
        }
        SpecificationCause::WeightsBothInfinite => "keep one of the two finite there",
        SpecificationCause::GeneratorNotProper => "give the generator more poles than zeros",
        SpecificationCause::GeneratorUnstable { .. } => {
            "move the pole into the left half plane, at the lowest frequency that matters"
        }
        SpecificationCause::GeneratorTooRough { .. } => {
            "give the generator more poles than zeros by the number of inputs of the channel"
        }
        SpecificationCause::KnowledgeIncomplete { .. } => {
            "use a generator of that order, or say what noise the sensor has"
        }
        SpecificationCause::Density { .. } => {
            "give a positive number (zero is allowed for disturbances and loop recovery)"
        }
        SpecificationCause::NothingDisturbs => "give a loop recovery or a disturbance a positive density",
    }
}

fn suggest_remedy_in_plant(cause: &PlantCause) -> &'static str {
    match cause {
        PlantCause::NotStabilisable { .. } => "remove the mode from the plant, or give it an actuator",
        PlantCause::NotDetectable { .. } => {
            "remove the mode from the plant (the hub angle, where only rate is measured), or measure it"
        }
        PlantCause::NoiseMissesMode { .. } => {
            "give the loop recovery a positive density, or the mode some damping"
        }
        PlantCause::DirectPath { .. } => "model the sensor or the delay",
        PlantCause::DelayLeftOut { .. } => "use a Pade order of 1 or 2",
        PlantCause::DelayLimits { .. } => {
            "raise the control weight or lower the error weight, or sample faster"
        }
        PlantCause::ZeroLimits { .. } => {
            "raise the control weight or lower the error weight until they cross below half the zero"
        }
        PlantCause::ChannelMissing => "name its input, or leave the feedforward out",
        PlantCause::ChannelWithoutEffect => "leave the feedforward out: it would be zero",
        PlantCause::FeedforwardUnbounded { .. } => {
            "use an error weight that is finite at that frequency, or let the feedback hold the mode"
        }
        PlantCause::ReferenceWithoutStates => {
            "let the demand enter through the error, or use an error weight with a pole"
        }
        PlantCause::ModeHidden { from, .. } => suggest_remedy_for_hidden(*from),
        PlantCause::Equation { .. } => {
            "give the mode named an input, a sensor, a weight or a noise; a block that is there twice is connected once, by name"
        }
        PlantCause::ControlUnweighed { .. } => "weigh every control, if only lightly",
        PlantCause::MeasurementNoiseless { .. } => "give every measurement a noise, if only a small one",
        PlantCause::NoiseReachesCost { .. } => "let the noise pass a filter, or the weighted output one",
        PlantCause::NoBoundReached { .. } => {
            "look for a mode on the axis that no control reaches or no measurement shows"
        }
        PlantCause::NoBandwidth { limits } if is_drive_too_weak(limits) => {
            "the drive is too weak for the noise or the steps of the readings, stated or usual: raise plant.drive.limit, state a quieter sensor (a gyroscope that is not stated is taken with 0.01 deg/s per root hertz), or check the inertia"
        }
        PlantCause::NoBandwidth { .. } => {
            "sample faster, remove delay, or lower the margins that are required; a loop of position keeps more phase as a cascade (synth.loop = \"cascade\"); a plant with an unstable pole needs twice its rate as bandwidth"
        }
        PlantCause::SampledUnstable { .. } => "sample faster, or lower the crossover",
    }
}

fn suggest_remedy_for_hidden(from: HiddenDirection) -> &'static str {
    match from {
        HiddenDirection::Control => {
            "let a control act on it, or leave it out; a block that is there twice is connected once, by name"
        }
        HiddenDirection::Measurement => {
            "measure it, or leave it out; a block that is there twice is connected once, by name"
        }
        HiddenDirection::Cost => "weigh an output that shows it, or move a weight's pole off the axis",
        HiddenDirection::Noise => {
            "let a disturbance excite it, if only a little, or move a weight's pole off the axis"
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use counterpoise_synth::Weight;

    #[test]
    fn findings_read_like_an_engineer_s() {
        let weight = Weight::Integral { gain: 200.0, time_s: 1.0 };
        let finding = DesignFinding::refusal(
            Part::Feedback,
            Cause::Specification(SpecificationCause::PlantZeroAtErrorPole { relative_gain: 0.0 }),
        );
        let text = describe_design_finding(&finding.with_weight(WeightRole::Error, &weight).at(0.0));
        let start = "feedback, error weight 200 / (1 s), at zero frequency: the error weight is infinite";
        assert!(text.starts_with(start), "{text}");
        assert!(text.contains("use K / (a s + 1)"), "{text}");
    }

    #[test]
    fn a_mode_that_nothing_reaches_is_named_with_its_block() {
        let (mode, block) = (C64::new(1.0, 0.0), ModeBlock::State(1));
        let cause = Cause::Plant(PlantCause::ModeHidden {
            mode,
            distance: 1e-12,
            from: HiddenDirection::Control,
            block,
        });
        let text = describe_cause(&cause);
        assert!(
            text.starts_with("no control reaches the mode 1.000000 of state 1, which is not stable"),
            "{text}"
        );
        assert!(suggest_remedy(&cause).contains("let a control act on it"));
    }

    #[test]
    fn a_bandwidth_without_a_stable_loop_says_so() {
        assert_eq!(describe_limits(&[]), "no loop was stable");
    }
}
