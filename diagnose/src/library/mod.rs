//! The library of physics: every effect that a machine may have and its model may lack.
//!
//! An [`Effect`] is data: where it sits, its equation and source, its parameters ([`Knob`]s) with bounds, and the
//! values from which a fit starts. Its block in the simulator is the field of the mechanism's parameters that the
//! knob writes, so an effect that is accepted is an ordinary machine that every other part of the studio takes.

mod curve;
mod drive;
mod sensing;
mod structure;

pub use curve::{curve_inputs, curve_of, free_curve};

use counterpoise_models::Parameters;

/// How a knob's value is mapped to the variable of the fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mapping {
    /// The value over its typical size.
    Linear,
    /// The logarithm of the value; for quantities that are positive by nature.
    Log,
    /// A whole number: found by search.
    Whole,
}

/// One parameter of an effect.
#[derive(Debug, Clone, Copy)]
pub struct Knob {
    /// Name in the answer.
    pub name: &'static str,
    /// Unit in the answer.
    pub unit: &'static str,
    /// Smallest and largest value that make physical sense.
    pub bounds: [f64; 2],
    /// Typical size of a change; the unit of the fit and of the first look.
    pub size: f64,
    /// Mapping to the variable of the fit.
    pub mapping: Mapping,
    /// Where the value stands in the mechanism's parameters.
    pub access: Access,
}

/// Where the value of a knob stands in a mechanism's parameters.
#[derive(Debug, Clone, Copy)]
pub enum Access {
    /// One number of its own.
    Field {
        /// Reads the value.
        get: fn(&Parameters) -> f64,
        /// Writes the value.
        set: fn(&mut Parameters, f64),
    },
    /// A point of the amplifier's curve, as a fraction of the linear gain.
    Curve {
        /// Inputs of all points of the curve, V, rising.
        inputs_v: &'static [f64],
        /// Which of them.
        point: usize,
    },
}

impl Knob {
    /// Its value in a mechanism.
    pub fn read(&self, of: &Parameters) -> f64 {
        match self.access {
            Access::Field { get, .. } => get(of),
            Access::Curve { inputs_v, point } => curve::fraction(of, inputs_v[point]),
        }
    }

    /// Sets its value in a mechanism; a curve with other points is first read at the knob's own.
    pub fn write(&self, of: &mut Parameters, value: f64) {
        match self.access {
            Access::Field { set, .. } => set(of, value),
            Access::Curve { inputs_v, point } => curve::set_fraction(of, (inputs_v, point), value),
        }
    }
}

/// Whether an effect is physics that the model knows with another value, or physics that it lacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The right physics with another value.
    ParameterChange,
    /// Physics that was left out.
    MissingPhysics,
    /// A fault of a sensor or of the recorder.
    Instrument,
}

/// An effect of the library.
#[derive(Debug, Clone, Copy)]
pub struct Effect {
    /// Name in the answer.
    pub effect: &'static str,
    /// Where it sits.
    pub component: &'static str,
    /// Parameter change, missing physics or instrument.
    pub kind: Kind,
    /// Its equation in words and symbols.
    pub equation: &'static str,
    /// Where the equation comes from.
    pub source: &'static str,
    /// The regime in which it shows.
    pub when: &'static str,
    /// An experiment that shows it clearly.
    pub experiment: &'static str,
    /// Parameters.
    pub knobs: &'static [Knob],
    /// Values of the knobs to start from; an empty list starts at the model's own values.
    pub starts: &'static [&'static [f64]],
}

impl Effect {
    /// `component: effect`, as written in answers and messages.
    pub fn label(&self) -> String {
        format!("{}: {}", self.component, self.effect)
    }

    /// The mechanism with the knobs at the given values.
    pub fn applied(&self, base: &Parameters, values: &[f64]) -> Parameters {
        let mut changed = base.clone();
        for (knob, &value) in self.knobs.iter().zip(values) {
            knob.write(&mut changed, value);
        }
        changed
    }

    /// The knobs' present values.
    pub fn values(&self, of: &Parameters) -> Vec<f64> {
        self.knobs.iter().map(|knob| knob.read(of)).collect()
    }
}

/// The library, component by component.
pub fn library() -> Vec<&'static Effect> {
    structure::EFFECTS.iter().chain(drive::EFFECTS).chain(sensing::EFFECTS).collect()
}

/// What a textbook's model may have at another value besides, and a reference rig's is known for.
pub fn textbook() -> Vec<&'static Effect> {
    drive::TEXTBOOK.iter().collect()
}

/// The range over which an effect's only parameter is scanned before it is fitted: where the response is so far from
/// proportional to it that a fit from a distance goes astray.
pub fn scan_range(effect: &Effect) -> Option<[f64; 2]> {
    match (effect.component, effect.effect) {
        ("gearbox", "backlash") => Some([1e-4, 0.03]),
        ("control", "delay") => Some([1.0, 16.0]),
        _ => None,
    }
}

/// What an effect found in a coarse form is refined to: the same effect with more parameters.
pub fn refinement(effect: &Effect) -> Option<&'static Effect> {
    let coarse =
        effect.component == "amplifier" && effect.effect == "gain_curve" && curve_inputs(effect).is_none();
    coarse.then(free_curve)
}

/// The effects that carry a name, in library order.
pub fn named<'a>(component: &'a str, effect: &'a str) -> impl Iterator<Item = &'static Effect> + 'a {
    let all = library().into_iter().chain(textbook());
    all.filter(move |e| e.component == component && e.effect == effect)
}

macro_rules! knob {
    ($name:literal, $unit:literal, [$low:expr, $high:expr], $size:expr, $mapping:ident, $($field:ident).+) => {
        $crate::library::Knob {
            name: $name,
            unit: $unit,
            bounds: [$low, $high],
            size: $size,
            mapping: $crate::library::Mapping::$mapping,
            access: $crate::library::Access::Field { get: |p| p.$($field).+, set: |p, value| p.$($field).+ = value },
        }
    };
    ($name:literal, $unit:literal, [$low:expr, $high:expr], $size:expr, $mapping:ident, get $get:expr, set $set:expr) => {
        $crate::library::Knob {
            name: $name,
            unit: $unit,
            bounds: [$low, $high],
            size: $size,
            mapping: $crate::library::Mapping::$mapping,
            access: $crate::library::Access::Field { get: $get, set: $set },
        }
    };
}
pub(crate) use knob;
