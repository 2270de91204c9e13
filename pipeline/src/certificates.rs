//! What certifies a design: residuals of its equations, costs predicted and found, and the poles of the sampled loop.

use counterpoise_synth::{Cost, DisturbanceChannel, Equation, Feedforward, PartCertificates};
use counterpoise_verify::Verification;

use crate::SynthesisedDesign;
use crate::tolerance::SAME_COST;
use crate::tolerance::SOLVED_RESIDUAL;
use crate::wording::design_findings::describe_part;

/// A number that certifies the design, with whether it is as it must be.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// What was computed.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Whether the value is within its limit.
    pub holds: bool,
}

/// Returns every certificate of a design; with a verification, that of the loop on the full plant too.
pub fn certify_designs(made: &SynthesisedDesign, verification: Option<&Verification>) -> Vec<Certificate> {
    let design = &made.design;
    let mut all = Vec::new();
    if !made.has_fixed_structure() {
        all.push(of_equation("feedback, regulator equation", &design.feedback.regulator));
        all.push(of_equation("feedback, filter equation", &design.feedback.filter));
        all.extend(of_cost("feedback", design.feedback.cost));
    }
    for (name, channel) in [("heave", DisturbanceChannel::Heave), ("pitch", DisturbanceChannel::Pitch)] {
        design.part(channel).into_iter().for_each(|part| all.extend(of_feedforward(name, part)));
    }
    made.sampled.certified.iter().for_each(|part| all.extend(of_sampled(part)));
    let largest =
        |poles: &[counterpoise_linalg::C64]| poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    all.push(of_radius("design", largest(&made.sampled.closed_loop)));
    all.extend(verification.map(|found| of_radius("full", largest(&found.evidence.poles))));
    all
}

fn of_radius(plant: &str, value: f64) -> Certificate {
    Certificate {
        name: format!("largest pole of the sampled loop on the {plant} plant"),
        value,
        holds: value < 1.0,
    }
}

fn of_equation(name: &str, equation: &Equation) -> Certificate {
    let value = equation.relative_residual;
    Certificate { name: format!("{name}: residual"), value, holds: value < SOLVED_RESIDUAL }
}

fn of_cost(name: &str, cost: Cost) -> Option<Certificate> {
    let value = cost.relative_difference()?;
    let name = format!("{name}: predicted against achieved cost, relative");
    Some(Certificate { name, value, holds: value < SAME_COST })
}

fn of_sampled(part: &PartCertificates) -> Vec<Certificate> {
    let name = format!("{} in sampled time", describe_part(part.part));
    let mut all = vec![of_equation(&format!("{name}, regulator equation"), &part.regulator)];
    all.extend(part.filter.as_ref().map(|filter| of_equation(&format!("{name}, filter equation"), filter)));
    all.extend(of_cost(&name, part.cost));
    all
}

fn of_feedforward(name: &str, part: &Feedforward) -> Vec<Certificate> {
    let name = format!("{name} feedforward");
    let mut all = vec![of_equation(&format!("{name}, regulator equation"), &part.regulator)];
    all.extend(part.filter.as_ref().map(|filter| of_equation(&format!("{name}, filter equation"), filter)));
    let value = part.sylvester_residual;
    all.push(Certificate {
        name: format!("{name}, Sylvester equation: residual"),
        value,
        holds: value < SOLVED_RESIDUAL,
    });
    all.extend(of_cost(&name, part.cost));
    all
}
