//! A value of what the loop controls, whose key ends in its unit.

use counterpoise_models::ControlledQuantity;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

/// A value of what the loop controls. Flattened into a result it is one entry whose key ends in the unit: `residual_nm` in a loop of torque
/// for `residual_rad_s` in one of rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnitValue<T> {
    /// The key without its unit.
    pub stem: &'static str,
    /// Quantity whose unit the value has; `None` for a pure number, whose key is the stem.
    pub controlled: Option<ControlledQuantity>,
    /// The value, in the unit of what the loop controls.
    pub value: T,
}

impl<T> UnitValue<T> {
    /// Returns a value of a quantity, whose key begins with a stem.
    pub const fn new(stem: &'static str, controlled: ControlledQuantity, value: T) -> Self {
        Self { stem, controlled: Some(controlled), value }
    }

    /// Returns a value without a unit.
    pub const fn pure_number(stem: &'static str, value: T) -> Self {
        Self { stem, controlled: None, value }
    }
}

impl<T: Serialize> Serialize for UnitValue<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(1))?;
        let key = self.controlled.map_or(self.stem.to_owned(), |controlled| controlled.key_of(self.stem));
        map.serialize_entry(&key, &self.value)?;
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use counterpoise_models::parameters::QuantityKind;

    use super::*;

    #[derive(Serialize)]
    struct Figures {
        before: f64,
        #[serde(flatten)]
        residual: UnitValue<Option<f64>>,
        after: f64,
    }

    fn written_figures(kind: QuantityKind, value: Option<f64>) -> String {
        let controlled = ControlledQuantity { kind, ..ControlledQuantity::default() };
        let residual = UnitValue::new("residual", controlled, value);
        serde_json::to_string(&Figures { before: 1.5, residual, after: 2.5 }).expect("figures are plain data")
    }

    #[test]
    fn a_key_ends_in_the_unit_of_what_the_loop_controls_and_keeps_its_place() {
        assert_eq!(
            written_figures(QuantityKind::Rate, Some(0.25)),
            r#"{"before":1.5,"residual_rad_s":0.25,"after":2.5}"#
        );
        assert_eq!(
            written_figures(QuantityKind::Effort, None),
            r#"{"before":1.5,"residual_nm":null,"after":2.5}"#
        );
        assert_eq!(
            written_figures(QuantityKind::Position, Some(0.0)),
            r#"{"before":1.5,"residual_rad":0.0,"after":2.5}"#
        );
    }
}
