//! The names of the numbers that certify a design. The JSON result carries them.

use counterpoise_synth::DisturbanceChannel;

use super::design_findings::describe_part;
use crate::certificates::{CertifiedEquation, CertifiedPart, CertifiedPlant, CertifiedQuantity};

/// Describes what a number that certifies a design is.
pub fn describe_certified_quantity(quantity: CertifiedQuantity) -> String {
    match quantity {
        CertifiedQuantity::Residual(part, equation) => {
            let equation = match equation {
                CertifiedEquation::Regulator => "regulator equation",
                CertifiedEquation::Filter => "filter equation",
                CertifiedEquation::Sylvester => "Sylvester equation",
            };
            format!("{}, {equation}: residual", describe_certified_part(part))
        }
        CertifiedQuantity::CostDifference(part) => {
            format!("{}: predicted against achieved cost, relative", describe_certified_part(part))
        }
        CertifiedQuantity::LargestPole(plant) => {
            let plant = match plant {
                CertifiedPlant::Design => "design",
                CertifiedPlant::Full => "full",
            };
            format!("largest pole of the sampled loop on the {plant} plant")
        }
    }
}

fn describe_certified_part(part: CertifiedPart) -> String {
    match part {
        CertifiedPart::Feedback => "feedback".to_owned(),
        CertifiedPart::Feedforward(DisturbanceChannel::Heave) => "heave feedforward".to_owned(),
        CertifiedPart::Feedforward(DisturbanceChannel::Pitch) => "pitch feedforward".to_owned(),
        CertifiedPart::Sampled(part) => format!("{} in sampled time", describe_part(part)),
    }
}
