//! An effect as data: where it sits, its parameters with bounds, and the values from which a fit starts.

use counterpoise_models::{LearnedElement, Parameters};

use super::names::{Component, EffectName};
use super::{amplifier_map, learned_values};

/// Mapping of a parameter's value to the variable of the fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ParameterMapping {
    /// The value over its typical size.
    Linear,
    /// The logarithm of the value; for quantities that are positive by nature.
    Log,
    /// A whole number: found by search.
    Whole,
}

/// One parameter of an effect.
#[derive(Debug, Clone, Copy)]
pub struct EffectParameter {
    /// Name in the answer.
    pub name: &'static str,
    /// Unit in the answer.
    pub unit: &'static str,
    /// Smallest and largest value that make physical sense.
    pub bounds: [f64; 2],
    /// Typical size of a change; the unit of the fit and of the screening.
    pub size: f64,
    /// Mapping to the variable of the fit.
    pub mapping: ParameterMapping,
    /// Access to the value in the mechanism's parameters.
    pub access: Access,
}

/// Access to a parameter in the parameters of a mechanism.
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
        /// The index among them.
        point: usize,
    },
    /// A value of a free function.
    Learned {
        /// The function.
        element: &'static LearnedElement,
        /// The index among its points.
        point: usize,
    },
    /// A coefficient of a free function that is a sum of rows.
    Coefficient {
        /// The function, without any row.
        element: &'static LearnedElement,
        /// What a coefficient of one adds to its values.
        row: &'static [f64],
        /// What the coefficient is of its values: 1 times its own row, 0 times every other.
        dual: &'static [f64],
    },
}

impl EffectParameter {
    /// Returns its value in a mechanism.
    pub fn read(&self, of: &Parameters) -> f64 {
        match self.access {
            Access::Field { get, .. } => get(of),
            Access::Curve { inputs_v, point } => amplifier_map::fraction(of, inputs_v[point]),
            Access::Learned { element, point } => learned_values::read(of, element, point),
            Access::Coefficient { element, dual, .. } => learned_values::read_coefficient(of, element, dual),
        }
    }

    /// Sets its value in a mechanism; a curve with other knots is first read at the parameter's own.
    pub fn write(&self, of: &mut Parameters, value: f64) {
        match self.access {
            Access::Field { set, .. } => set(of, value),
            Access::Curve { inputs_v, point } => {
                amplifier_map::set_fraction(of, amplifier_map::CurvePoint { inputs_v, point }, value);
            }
            Access::Learned { element, point } => learned_values::write(of, element, point, value),
            Access::Coefficient { element, row, .. } => {
                learned_values::add_row(of, element, row, value - self.read(of));
            }
        }
    }
}

/// Kind of an effect: physics that the model knows with another value, or physics that it lacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EffectKind {
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
    pub effect: EffectName,
    /// The component in which it acts.
    pub component: Component,
    /// Parameter change, missing physics or instrument.
    pub kind: EffectKind,
    /// Parameters.
    pub parameters: &'static [EffectParameter],
    /// Values of the parameters from which a fit starts; an empty list starts at the model's own values.
    pub starts: &'static [&'static [f64]],
}

impl Effect {
    /// Returns the mechanism with the parameters at the given values.
    pub fn apply_to(&self, base: &Parameters, values: &[f64]) -> Parameters {
        let mut changed = base.clone();
        for (parameter, &value) in self.parameters.iter().zip(values) {
            parameter.write(&mut changed, value);
        }
        changed
    }

    /// Returns whether the parameters are amplitude, order and phase of something that repeats with an angle.
    pub fn is_ripple(&self) -> bool {
        self.parameters.len() == 3 && self.parameters[1].name == "order"
    }

    /// Returns the parameters' values in a mechanism.
    pub fn values(&self, of: &Parameters) -> Vec<f64> {
        self.parameters.iter().map(|parameter| parameter.read(of)).collect()
    }
}

macro_rules! parameter {
    ($name:literal, $unit:literal, [$low:expr, $high:expr], $size:expr, $mapping:ident, $($field:ident).+) => {
        $crate::library::EffectParameter {
            name: $name,
            unit: $unit,
            bounds: [$low, $high],
            size: $size,
            mapping: $crate::library::ParameterMapping::$mapping,
            access: $crate::library::Access::Field { get: |p| p.$($field).+, set: |p, value| p.$($field).+ = value },
        }
    };
    ($name:literal, $unit:literal, [$low:expr, $high:expr], $size:expr, $mapping:ident, get $get:expr, set $set:expr) => {
        $crate::library::EffectParameter {
            name: $name,
            unit: $unit,
            bounds: [$low, $high],
            size: $size,
            mapping: $crate::library::ParameterMapping::$mapping,
            access: $crate::library::Access::Field { get: $get, set: $set },
        }
    };
}
pub(crate) use parameter;
