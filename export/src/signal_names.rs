//! The names of the first two readings in the code of a loop of position, torque or current.
//!
//! The code of a controller is generated with the names of a rate loop. Another loop runs the same operations on other
//! quantities; its files have these quantities' names, units and meanings in place of the rates'.

use counterpoise_models::{AxisKind, ControlledQuantity, QuantityKind};

use crate::File;

/// The names of a quantity.
struct Words {
    controlled: ControlledQuantity,
    /// The part of it that is measured, after the quantity.
    of: &'static str,
    /// Name and definition of a unit that FMI units of a turning axis lack.
    definition: Option<(&'static str, &'static str)>,
}

impl Words {
    /// Returns the identifiers of demand, reading, filtered demand and error.
    fn names(&self) -> [String; 4] {
        let of_rate_loop =
            ["demand_rad_s", "measured_rate_rad_s", "filtered_demand_rad_s", "rate_error_rad_s"];
        of_rate_loop.map(|name| self.controlled.named_signal(name))
    }

    /// Returns the meanings of demand and reading, and that of the sensor in quotation marks.
    fn meanings(&self) -> [String; 3] {
        let (quantity, unit) = (self.controlled.short_name(), self.controlled.unit());
        let measured = format!("measured {quantity} {}", self.of);
        [format!("demanded {quantity}, {unit}"), format!("{measured}, {unit}"), format!("\"{measured}\"")]
    }

    /// Returns the name of the unit in an FMI unit.
    fn unit_name(&self) -> &'static str {
        self.definition.map_or(self.controlled.unit(), |(name, _)| name)
    }
}

/// Identifiers of a rate loop.
const NAMES: [&str; 4] = ["demand_rad_s", "hub_rate_rad_s", "filtered_demand_rad_s", "rate_error_rad_s"];

/// Meanings of the readings of a rate loop.
const MEANINGS: [&str; 3] =
    ["demanded hub rate, rad/s", "hub gyroscope, rad/s, positive nose-up, inertial", "\"hub gyroscope\""];

/// The line of FMI units before which units are defined.
const AFTER_DEFINITION: &str = "    <Unit name=\"V\">";

/// Returns generated files with the names of what the loop controls; those of a loop of rate as they are.
pub fn with_loop_names(controlled: ControlledQuantity, files: Vec<File>) -> Vec<File> {
    let Some(words) = words_of(controlled) else { return files };
    files.into_iter().map(|file| File { text: rename_signals(&file.text, &words), ..file }).collect()
}

/// Returns what a quantity is called; `None` for a rate.
fn words_of(controlled: ControlledQuantity) -> Option<Words> {
    let (of, definition) = match (controlled.kind, controlled.axis) {
        (QuantityKind::Rate, _) => return None,
        (QuantityKind::Position, AxisKind::Rotary) => ("relative to the platform", None),
        (QuantityKind::Position, AxisKind::Linear) => ("relative to the platform", Some(("m", "m=\"1\""))),
        (QuantityKind::Effort, AxisKind::Rotary) => {
            ("of the transmission", Some(("N.m", "kg=\"1\" m=\"2\" s=\"-2\"")))
        }
        (QuantityKind::Effort, AxisKind::Linear) => {
            ("of the transmission", Some(("N", "kg=\"1\" m=\"1\" s=\"-2\"")))
        }
        (QuantityKind::Current, _) => ("of the motor", None),
    };
    Some(Words { controlled, of, definition })
}

fn rename_signals(text: &str, words: &Words) -> String {
    let pairs = MEANINGS.iter().zip(words.meanings());
    let described = pairs.fold(text.to_owned(), |text, (rate, own)| text.replace(rate, &own));
    let mut named = match words.definition {
        None => described,
        Some((name, base)) => {
            let defined = format!("    <Unit name=\"{name}\"><BaseUnit {base}/></Unit>\n{AFTER_DEFINITION}");
            described.replace(AFTER_DEFINITION, &defined)
        }
    };
    for (index, (rate, name)) in NAMES.iter().zip(words.names()).enumerate() {
        // The first two are variables of FMI units, whose lines state the unit as well.
        named = match index {
            0 | 1 => with_unit(&named, rate, words.unit_name()),
            _ => named,
        };
        named = with_identifier(&named, rate, &name);
    }
    named
}

/// Returns the text with the unit of an FMI variable changed.
fn with_unit(text: &str, variable: &str, unit: &str) -> String {
    let (start, changed) = (format!("<Float64 name=\"{variable}\""), format!("unit=\"{unit}\""));
    let line = |line: &str| match line.trim_start().starts_with(&start) {
        true => line.replace("unit=\"rad/s\"", &changed),
        false => line.to_owned(),
    };
    text.split('\n').map(line).collect::<Vec<_>>().join("\n")
}

/// Returns the text with a whole identifier replaced wherever it stands, and no longer one that contains it.
fn with_identifier(text: &str, old: &str, new: &str) -> String {
    let is_part = |c: Option<char>| c.is_some_and(|c| c.is_ascii_alphanumeric() || c == '_');
    let (mut out, mut rest) = (String::with_capacity(text.len()), text);
    while let Some(at) = rest.find(old) {
        let (before, after) = (&rest[..at], &rest[at + old.len()..]);
        let last = before.chars().next_back().or_else(|| out.chars().next_back());
        out.push_str(before);
        out.push_str(if is_part(last) || is_part(after.chars().next()) { old } else { new });
        rest = after;
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_identifiers_are_replaced_and_others_kept() {
        let text = "in->hub_rate_rad_s; true_hub_rate_rad_s; hub_rate_rad_s_2; hub_rate_rad_s";
        let found = with_identifier(text, "hub_rate_rad_s", "x");
        assert_eq!(found, "in->x; true_hub_rate_rad_s; hub_rate_rad_s_2; x");
    }

    #[test]
    fn a_variable_of_a_unit_has_the_unit_of_its_quantity() {
        let text = "    <Float64 name=\"demand_rad_s\" unit=\"rad/s\"/>\n    <Float64 name=\"motor_rate_rad_s\" unit=\"rad/s\"/>";
        let files = vec![File { name: "modelDescription.xml".into(), text: text.into() }];
        let place = ControlledQuantity {
            kind: QuantityKind::Position,
            axis: AxisKind::Linear,
            ..ControlledQuantity::RATE
        };
        let found = with_loop_names(place, files);
        let expected = "    <Float64 name=\"demand_m\" unit=\"m\"/>\n    <Float64 name=\"motor_rate_rad_s\" unit=\"rad/s\"/>";
        assert_eq!(found[0].text, expected);
    }
}
