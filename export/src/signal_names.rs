//! What the first two readings are called in the code of a loop of position.
//!
//! The code of a controller is generated with the names of a rate loop. A loop of position runs the same operations on other
//! quantities; its files have these quantities' names, units and meanings in place of the rates'.

use crate::File;

/// The quantity that a loop of position controls.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ControlledPosition {
    /// The angle of a turning axis.
    Angle,
    /// The place of a sliding axis.
    Place,
}

/// Identifiers of a rate loop with those of the two loops of position.
const NAMES: [(&str, &str, &str); 4] = [
    ("demand_rad_s", "demand_rad", "demand_m"),
    ("hub_rate_rad_s", "measured_angle_rad", "measured_position_m"),
    ("filtered_demand_rad_s", "filtered_demand_rad", "filtered_demand_m"),
    ("rate_error_rad_s", "angle_error_rad", "position_error_m"),
];

/// Meanings of the readings of a rate loop with those of the two loops of position.
const MEANINGS: [(&str, &str, &str); 3] = [
    ("demanded hub rate, rad/s", "demanded angle, rad", "demanded position, m"),
    (
        "hub gyroscope, rad/s, positive nose-up, inertial",
        "measured angle relative to the platform, rad",
        "measured position relative to the platform, m",
    ),
    (
        "\"hub gyroscope\"",
        "\"measured angle relative to the platform\"",
        "\"measured position relative to the platform\"",
    ),
];

/// The unit that FMI units of a turning axis do not define, and the line that it precedes.
const METRE: &str = "    <Unit name=\"m\"><BaseUnit m=\"1\"/></Unit>";
const AFTER_METRE: &str = "    <Unit name=\"V\">";

impl ControlledPosition {
    /// Returns generated files with the names of this quantity.
    pub fn named(self, files: Vec<File>) -> Vec<File> {
        files.into_iter().map(|file| File { text: self.text(&file.text), ..file }).collect()
    }

    fn of(self, angle: &'static str, place: &'static str) -> &'static str {
        match self {
            Self::Angle => angle,
            Self::Place => place,
        }
    }

    fn text(self, text: &str) -> String {
        let described = MEANINGS
            .iter()
            .fold(text.to_owned(), |text, (rate, angle, place)| text.replace(rate, self.of(angle, place)));
        let mut named = match self {
            Self::Angle => described,
            Self::Place => described.replace(AFTER_METRE, &format!("{METRE}\n{AFTER_METRE}")),
        };
        for (index, (rate, angle, place)) in NAMES.iter().enumerate() {
            let name = self.of(angle, place);
            // The first two are variables of FMI units, whose lines state the unit as well.
            named = match index {
                0 | 1 => with_unit(&named, rate, self.of("rad", "m")),
                _ => named,
            };
            named = with_identifier(&named, rate, name);
        }
        named
    }
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
        let found = ControlledPosition::Place.named(files);
        let expected = "    <Float64 name=\"demand_m\" unit=\"m\"/>\n    <Float64 name=\"motor_rate_rad_s\" unit=\"rad/s\"/>";
        assert_eq!(found[0].text, expected);
    }
}
