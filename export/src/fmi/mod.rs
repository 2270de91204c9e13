//! The controller, and the plant, as FMI 3.0 co-simulation units.
//!
//! A unit is a folder: `modelDescription.xml`, and under `sources` C99 with a `buildDescription.xml`. Packed as a zip
//! with ending `.fmu` (and a compiled library under `binaries/x86_64-linux`) it runs in any FMI 3.0 importer.
//!
//! The controller samples at k periods, with the readings as they were set for the step that contains this instant, and
//! holds its control. Step the controller first and the plant second, both by one sample period: then the closed loop is
//! the simulator's, without a further delay.

mod controller;
mod free_functions;
mod loads;
mod machine;
mod pack;
mod plant;
mod unused_functions;

pub use crate::tolerance::{MOST_BRISTLES, MOST_DELAY_SAMPLES};
pub use controller::controller_unit;
pub use pack::pack_unit;
pub use plant::{PlantUnit, PlantUnitError, plant_unit};

use minijinja::{Environment, Value, context};
use unused_functions::ABSENT;

use crate::{Error, File};

/// A variable of a unit; its value reference is its place in the list.
pub(crate) struct Variable {
    name: &'static str,
    causality: &'static str,
    variability: &'static str,
    unit: &'static str,
    says: &'static str,
    start: Option<f64>,
}

impl Variable {
    pub(crate) fn time() -> Self {
        let (causality, variability) = ("independent", "continuous");
        Self { name: "time", causality, variability, unit: "s", says: "time", start: None }
    }

    pub(crate) fn input(name: &'static str, unit: &'static str, says: &'static str) -> Self {
        Self { name, causality: "input", variability: "continuous", unit, says, start: Some(0.0) }
    }

    pub(crate) fn output(name: &'static str, unit: &'static str, says: &'static str) -> Self {
        Self { name, causality: "output", variability: "continuous", unit, says, start: Some(0.0) }
    }

    pub(crate) fn parameter(name: &'static str, unit: &'static str, says: &'static str, start: f64) -> Self {
        Self { name, causality: "parameter", variability: "tunable", unit, says, start: Some(start) }
    }

    fn value(&self) -> Value {
        let initial = match self.causality {
            "output" | "parameter" => Some("exact"),
            _ => None,
        };
        context! {
            name => self.name, causality => self.causality, variability => self.variability, unit => self.unit,
            says => self.says, start => self.start.map(|start| format!("{start:?}")), initial,
        }
    }
}

/// The data that the parts of a unit share.
pub(crate) struct Unit<'a> {
    /// Name of the unit and of its functions.
    pub name: &'a str,
    /// One line for the importer.
    pub description: &'a str,
    /// Program and version that generated the unit.
    pub tool: &'a str,
    /// Lines of the header.
    pub provenance: &'a [String],
    /// Variables in the order of their value references.
    pub variables: &'a [Variable],
    /// Sample period, s.
    pub period_s: f64,
    /// Functions in C that give the unit its behaviour.
    pub behaviour: String,
}

impl Unit<'_> {
    /// `modelDescription.xml`, `sources/fmu.c` and `sources/buildDescription.xml` in the unit's folder.
    pub(crate) fn files(&self) -> Result<Vec<File>, Error> {
        let environment = Environment::new();
        let data = self.data();
        let templates = [
            ("modelDescription.xml", include_str!("../../templates/model_description.xml.jinja")),
            ("sources/buildDescription.xml", include_str!("../../templates/build_description.xml.jinja")),
            ("sources/fmu.c", include_str!("../../templates/fmu.c.jinja")),
        ];
        let fill = |(name, template): (&str, &str)| {
            let text = environment.render_str(template, &data)?.trim_end().to_owned() + "\n";
            Ok(File { name: format!("{}/{name}", self.name), text })
        };
        templates.into_iter().map(fill).collect()
    }

    fn data(&self) -> Value {
        let settable =
            |v: &Variable| if matches!(v.causality, "input" | "parameter") { "true" } else { "false" };
        let starts = |v: &Variable| format!("{:?}", v.start.unwrap_or(0.0));
        let absent = |&(name, gives, takes): &(&'static str, &'static str, &'static str)| {
            let argument = |part: &str| {
                let word = part.rsplit([' ', '*']).next().unwrap_or("");
                word.trim_end_matches("[]").to_owned()
            };
            let arguments: Vec<String> = takes.split(", ").map(argument).collect();
            let answer = if gives == "fmi3Status" { "fmi3Error" } else { "NULL" };
            context! { name, gives, takes, arguments, answer }
        };
        context! {
            name => self.name,
            token => self.token(),
            description => escape_xml(self.description),
            tool => escape_xml(self.tool),
            provenance => self.provenance.to_vec(),
            variables => self.variables.iter().map(Variable::value).collect::<Vec<_>>(),
            settable => self.variables.iter().map(settable).collect::<Vec<_>>(),
            starts => self.variables.iter().map(starts).collect::<Vec<_>>(),
            period => format!("{:?}", self.period_s),
            behaviour => self.behaviour.as_str(),
            absent => ABSENT.iter().map(absent).collect::<Vec<_>>(),
        }
    }

    /// Returns the instantiation token: a hash of what the unit is (FNV-1a, twice), in the form of a GUID.
    fn token(&self) -> String {
        let names: Vec<&str> = self.variables.iter().map(|v| v.name).collect();
        let text =
            format!("{}{}{}{}", self.name, names.join(","), self.provenance.join("\n"), self.behaviour);
        let hash = |seed: u64| {
            text.bytes().fold(seed, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
        };
        let (a, b) = (hash(0xcbf2_9ce4_8422_2325), hash(0x8422_2325_cbf2_9ce4));
        let (first, second, third) = (a >> 32, (a >> 16) & 0xffff, a & 0xffff);
        format!("{{{first:08x}-{second:04x}-{third:04x}-{:04x}-{:012x}}}", b >> 48, b & 0xffff_ffff_ffff)
    }
}

fn escape_xml(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
