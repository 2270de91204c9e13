//! The check that a feedforward's weights and generator make a solvable problem.

use counterpoise_linalg::C64;
use counterpoise_lti::{StateSpace, poles};

use super::gain::Gain;
use super::{against_plant, axis_roots, not_stable, weight_forms, well_formed};
use crate::cause::StatedDensity;
use crate::cause::{Cause, PlantCause, SpecificationCause};
use crate::finding::WeightRole;
use crate::finding::{DesignFinding, Part};
use crate::{
    Assembly, DesignPlant, DisturbanceChannel, DisturbanceKnowledge, Error, FeedforwardBasis, Specification,
    Weight,
};

pub(super) fn check_feedforward(
    plant: &DesignPlant,
    spec: &Specification,
    channel: DisturbanceChannel,
) -> Result<Vec<DesignFinding>, Error> {
    let (part, columns) = (Part::from(channel), plant.columns(channel));
    let Some(weights) = spec.feedforward(channel) else { return Ok(Vec::new()) };
    let mut findings = weight_forms(part, &weights.error, &weights.control);
    if columns.is_empty() {
        findings.push(DesignFinding::refusal(part, Cause::Plant(PlantCause::ChannelMissing)));
    }
    findings.extend(generator(part, &weights.generator, columns.len(), weights.knowledge));
    if findings.iter().any(DesignFinding::is_refusal) || spec.assembly == Assembly::Joint {
        return Ok(findings);
    }
    let system = plant.delayed_plant()?;
    let weighed = weights.output.unwrap_or(plant.rate);
    let (index, count) = (weighed, system.outputs());
    if index >= count {
        return Err(Error::Index { what: "weighted output", index, count });
    }
    let gain = Gain::of(&system.select(&[weighed], &[plant.control]))?;
    findings.extend(against_plant(part, &weights.error, &weights.control, &gain)?);
    let disturbed = Gain::of(&system.select(&[weighed], columns))?;
    if disturbed.largest == 0.0 {
        findings.push(DesignFinding::warning(part, Cause::Plant(PlantCause::ChannelWithoutEffect)));
    }
    if weights.knowledge != DisturbanceKnowledge::Exact && weights.basis == FeedforwardBasis::OpenLoop {
        findings.extend(check_bounded_error(part, &system, &weights.error)?);
    }
    Ok(findings)
}

fn generator(
    part: Part,
    weight: &Weight,
    inputs: usize,
    knowledge: DisturbanceKnowledge,
) -> Vec<DesignFinding> {
    let rational = weight.rational();
    let mut findings = well_formed(part, WeightRole::Generator, weight);
    let relative_degree = rational.relative_degree();
    let mut refuse = |cause, rate: f64| {
        findings.push(DesignFinding::refusal(part, cause).with_weight(WeightRole::Generator, weight).at(rate))
    };
    if relative_degree <= 0 {
        refuse(Cause::Specification(SpecificationCause::GeneratorNotProper), f64::INFINITY);
    } else if (relative_degree as usize) < inputs {
        refuse(
            Cause::Specification(SpecificationCause::GeneratorTooRough { relative_degree, needed: inputs }),
            f64::INFINITY,
        );
    }
    if let Some(&pole) = rational.poles.iter().find(|pole| pole.re >= 0.0) {
        refuse(Cause::Specification(SpecificationCause::GeneratorUnstable { pole }), pole.im.abs());
    }
    let order = rational.poles.len();
    if knowledge == DisturbanceKnowledge::Exact && order != inputs {
        findings.push(
            DesignFinding::refusal(
                part,
                Cause::Specification(SpecificationCause::KnowledgeIncomplete { order, known: inputs }),
            )
            .with_weight(WeightRole::Generator, weight),
        );
    }
    if let DisturbanceKnowledge::Measured { noise } = knowledge
        && !(noise > 0.0 && noise.is_finite())
    {
        findings.push(DesignFinding::refusal(
            part,
            Cause::Specification(SpecificationCause::Density {
                of: StatedDensity::DisturbanceSensorNoise,
                value: noise,
            }),
        ));
    }
    findings
}

/// With a noisy sensor the uncontrolled error must be bounded: the plant and the error weight are stable.
fn check_bounded_error(part: Part, system: &StateSpace, error: &Weight) -> Result<Vec<DesignFinding>, Error> {
    let refuse = |pole: C64| {
        DesignFinding::refusal(part, Cause::Plant(PlantCause::FeedforwardUnbounded { pole }))
            .at(pole.im.abs())
    };
    if let Some(&pole) = not_stable(&poles(system)?).first() {
        return Ok(vec![refuse(pole)]);
    }
    let pole = axis_roots(&error.rational().poles).first().map(|&rate| C64::new(0.0, rate));
    Ok(pole.map(|pole| refuse(pole).with_weight(WeightRole::Error, error)).into_iter().collect())
}
