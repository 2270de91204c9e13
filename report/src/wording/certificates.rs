//! The names of the numbers that certify a design, and of the parts that have a cost.

use counterpoise_synth::DisturbanceChannel;

use super::design_findings::describe_part;
use super::figures::drop_small_sign;
use crate::tolerance::WORTH_A_WORD_PERCENT;
use counterpoise_pipeline::certificates::{
    CertifiedEquation, CertifiedPart, CertifiedPlant, CertifiedQuantity,
};
use counterpoise_pipeline::results::CostedPart;
use counterpoise_pipeline::studies::comparison::{CostSource, PartCostRow, TotalCostResult};
use counterpoise_plot::number::short_number;

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

/// Returns the name of a part of a design that has a cost.
pub fn describe_costed_part(part: CostedPart) -> String {
    match part {
        CostedPart::Feedback => "feedback".to_owned(),
        CostedPart::Feedforward(channel) => name_channel(channel).to_owned(),
        CostedPart::Joint => "joint".to_owned(),
        CostedPart::Sampled(part) => format!("{} in sampled time", describe_part(part)),
    }
}

/// Returns the name of what a share of a loop's cost belongs to.
pub fn describe_cost_source(source: CostSource) -> String {
    match source {
        CostSource::Part(part) => describe_part(part).to_owned(),
        CostSource::HubSensor => "hub sensor".to_owned(),
        CostSource::DisturbanceSensor(channel) => format!("{} sensor", name_channel(channel)),
    }
}

fn name_channel(channel: DisturbanceChannel) -> &'static str {
    match channel {
        DisturbanceChannel::Heave => "heave",
        DisturbanceChannel::Pitch => "pitch",
    }
}

/// Returns the total cost of an assembled loop in lines: the sum, then each part with its slope and its best gain. Empty if no total cost was computed.
pub fn total_cost_lines(cost: Option<&TotalCostResult>) -> Vec<String> {
    let Some(cost) = cost else { return Vec::new() };
    let total = format!(
        "total cost of the assembled loop {}, each part's disturbances under its own weights:",
        short_number(cost.total)
    );
    let mut lines: Vec<String> =
        std::iter::once(total).chain(cost.parts.iter().map(part_cost_line)).collect();
    // only parts that were designed apart have a basis
    let is_apart = cost.basis.is_some();
    if is_apart
        && cost.parts.iter().filter_map(|row| row.gained_percent).any(|gained| gained > WORTH_A_WORD_PERCENT)
    {
        lines.push(
            "  a part whose best gain is not 1 is optimal by itself alone: `assembly = \"grimble\"` or `\"joint\"` takes the other parts into account, and `counterpoise compare` shows what the joint optimum changes in simulation"
                .to_owned(),
        );
    }
    lines
}

fn part_cost_line(row: &PartCostRow) -> String {
    let best = match (row.best_gain, row.gained_percent) {
        (Some(gain), Some(gained)) => {
            format!("; the best gain is {gain:.4}, which lowers the total by {gained:.3} %")
        }
        _ => String::new(),
    };
    let slope = drop_small_sign(row.slope);
    format!(
        "  {:18} {:>10}, slope {slope:+.4} per unit of its gain{best}",
        describe_cost_source(row.part),
        short_number(row.cost)
    )
}
