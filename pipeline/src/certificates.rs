//! The certificates of a design: residuals of its equations, costs predicted and found, and the poles of the sampled loop.

use counterpoise_synth::{Cost, DisturbanceChannel, Equation, Feedforward, Part, PartCertificates};
use counterpoise_verify::Verification;

use crate::SynthesisedDesign;
use crate::tolerance::SAME_COST;
use crate::tolerance::SOLVED_RESIDUAL;

/// A number that certifies the design, with whether it is as it must be.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// The quantity that was computed.
    pub quantity: CertifiedQuantity,
    /// Its value.
    pub value: f64,
    /// `true` if the value is within its limit.
    pub holds: bool,
}

/// The kind of a number that certifies a design.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CertifiedQuantity {
    /// The residual of an equation, relative to its terms.
    Residual(CertifiedPart, CertifiedEquation),
    /// The cost as predicted against the cost as achieved, relative.
    CostDifference(CertifiedPart),
    /// The largest modulus of the poles of the sampled loop.
    LargestPole(CertifiedPlant),
}

/// A part of a design that has certificates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CertifiedPart {
    /// The feedback in continuous time.
    Feedback,
    /// A feedforward in continuous time.
    Feedforward(DisturbanceChannel),
    /// A part in sampled time.
    Sampled(Part),
}

/// An equation whose residual certifies a design.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CertifiedEquation {
    /// The Riccati equation of the regulator.
    Regulator,
    /// The Riccati equation of the filter.
    Filter,
    /// The Sylvester equation of a feedforward.
    Sylvester,
}

/// A plant on which the poles of the sampled loop are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CertifiedPlant {
    /// The plant of the design.
    Design,
    /// The plant before the reduction.
    Full,
}

/// Returns every certificate of a design; with a verification, that of the loop on the full plant too.
pub fn certify_designs(made: &SynthesisedDesign, verification: Option<&Verification>) -> Vec<Certificate> {
    let design = &made.design;
    let mut all = Vec::new();
    if !made.has_fixed_structure() {
        let (part, feedback) = (CertifiedPart::Feedback, &design.feedback);
        all.push(of_equation(part, CertifiedEquation::Regulator, &feedback.regulator));
        all.push(of_equation(part, CertifiedEquation::Filter, &feedback.filter));
        all.extend(of_cost(part, feedback.cost));
    }
    for channel in [DisturbanceChannel::Heave, DisturbanceChannel::Pitch] {
        design.part(channel).into_iter().for_each(|part| all.extend(of_feedforward(channel, part)));
    }
    made.sampled.certified.iter().for_each(|part| all.extend(of_sampled(part)));
    let largest =
        |poles: &[counterpoise_linalg::C64]| poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    all.push(of_radius(CertifiedPlant::Design, largest(&made.sampled.closed_loop)));
    all.extend(verification.map(|found| of_radius(CertifiedPlant::Full, largest(&found.evidence.poles))));
    all
}

fn of_radius(plant: CertifiedPlant, value: f64) -> Certificate {
    Certificate { quantity: CertifiedQuantity::LargestPole(plant), value, holds: value < 1.0 }
}

fn of_residual(part: CertifiedPart, equation: CertifiedEquation, value: f64) -> Certificate {
    let quantity = CertifiedQuantity::Residual(part, equation);
    Certificate { quantity, value, holds: value < SOLVED_RESIDUAL }
}

fn of_equation(part: CertifiedPart, kind: CertifiedEquation, equation: &Equation) -> Certificate {
    of_residual(part, kind, equation.relative_residual)
}

fn of_cost(part: CertifiedPart, cost: Cost) -> Option<Certificate> {
    let value = cost.relative_difference()?;
    Some(Certificate { quantity: CertifiedQuantity::CostDifference(part), value, holds: value < SAME_COST })
}

fn of_sampled(certified: &PartCertificates) -> Vec<Certificate> {
    let part = CertifiedPart::Sampled(certified.part);
    let filter = certified.filter.as_ref();
    let mut all = vec![of_equation(part, CertifiedEquation::Regulator, &certified.regulator)];
    all.extend(filter.map(|filter| of_equation(part, CertifiedEquation::Filter, filter)));
    all.extend(of_cost(part, certified.cost));
    all
}

fn of_feedforward(channel: DisturbanceChannel, feedforward: &Feedforward) -> Vec<Certificate> {
    let part = CertifiedPart::Feedforward(channel);
    let filter = feedforward.filter.as_ref();
    let mut all = vec![of_equation(part, CertifiedEquation::Regulator, &feedforward.regulator)];
    all.extend(filter.map(|filter| of_equation(part, CertifiedEquation::Filter, filter)));
    all.push(of_residual(part, CertifiedEquation::Sylvester, feedforward.sylvester_residual));
    all.extend(of_cost(part, feedforward.cost));
    all
}
