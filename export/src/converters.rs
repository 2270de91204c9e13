//! A board's converters: from counts to SI units and from volts to counts, for the block that goes into the sampling interrupt.

use counterpoise_controller::{Controller, READINGS};
use counterpoise_models::{CONVERTER_RANGE_V, Parameters, Sensor, converter_step_v};
use minijinja::{Value, context};

use crate::fixed_point::unit;
use crate::{fixed_point::FixedPointController, reading_fields};

/// Converters of a board: scales of the readings and of the control. Input converters and the output converter take +/- 10 V, their counts are
/// signed.
#[derive(Debug, Clone, PartialEq)]
pub struct Converters {
    /// Bits of the input converters.
    pub input_bits: u32,
    /// Bits of the output converter.
    pub output_bits: u32,
    /// Volts at the converter per unit of each reading, in the order of [`counterpoise_controller::Readings`]. The demand comes
    /// with the scale of the hub gyroscope: what it is compared with.
    pub volts_per_unit: [f64; READINGS],
    /// Source of the figures, for the code's comment.
    pub origin: &'static str,
}

impl Default for Converters {
    fn default() -> Self {
        Self {
            input_bits: 16,
            output_bits: 16,
            volts_per_unit: [1.0; READINGS],
            origin: "an example: 16 bits over +/- 10 V, 1 V a unit",
        }
    }
}

/// Bits that a fixed-point factor fills: times a count of up to 32 bits it stays within 64.
const FACTOR_BITS: i32 = 30;

impl Converters {
    /// Returns those of a mechanism: its sensors' scales and its controller's converters. A sensor that is not fitted has 1 V
    /// a unit.
    pub fn of(parameters: &Parameters) -> Self {
        let s = &parameters.sensors;
        let optional = |sensor: &Option<Sensor>| sensor.as_ref().map_or(1.0, |sensor| sensor.scale_v_unit);
        Self {
            input_bits: parameters.interface.input_bits,
            output_bits: parameters.interface.output_bits,
            volts_per_unit: [
                s.hub_gyro.scale_v_unit,
                s.hub_gyro.scale_v_unit,
                s.platform_gyro.scale_v_unit,
                s.platform_accelerometer.scale_v_unit,
                optional(&s.motor_tachometer),
                optional(&s.hub_resolver),
                optional(&s.surge_accelerometer),
            ],
            origin: "as the project describes sensors and converters",
        }
    }

    /// Returns units of each reading per count.
    pub fn units_per_count(&self) -> [f64; READINGS] {
        let volts = converter_step_v(self.input_bits);
        self.volts_per_unit.map(|scale| volts / scale)
    }

    /// Counts of the output converter per volt.
    pub fn counts_per_volt(&self) -> f64 {
        f64::from(self.output_bits).exp2() / (2.0 * CONVERTER_RANGE_V)
    }

    /// Returns the largest count of the output converter.
    fn most_count(&self) -> i64 {
        (1_i64 << (self.output_bits.clamp(1, 32) - 1)) - 1
    }

    /// Returns what the block in floating point needs, with numbers as the code writes them.
    pub(crate) fn block(&self, controller: &Controller, literal: &dyn Fn(f64) -> String) -> Value {
        let fields = reading_fields(controller);
        let rows = fields.iter().zip(self.units_per_count());
        let row = |(&(field, says), per_count): (&(&str, &str), f64)| {
            context! { field, macro => macro_name(field), says, per_count => literal(per_count) }
        };
        context! {
            origin => self.origin,
            rows => rows.map(row).collect::<Vec<_>>(),
            counts_per_volt => literal(self.counts_per_volt()),
            most_count => self.most_count(),
            half => literal(0.5),
            nothing => literal(0.0),
        }
    }

    /// Returns the same in integers: each factor with the bits by which its product is shifted down.
    pub(crate) fn fixed_block(&self, fixed: &FixedPointController) -> Value {
        let fields = reading_fields(&fixed.controller);
        let rows = fields.iter().zip(self.units_per_count()).zip(&fixed.step.inputs);
        let row = |((&(field, says), per_count), bits): ((&(&str, &str), f64), &i32)| {
            let (factor, shift) = factor(per_count / unit(*bits));
            let per_count = format!("{per_count:?}");
            context! { field, macro => macro_name(field), says, bits => *bits, per_count, factor, shift }
        };
        let (factor, shift) = factor(self.counts_per_volt() * unit(fixed.control_bits()));
        context! {
            origin => self.origin,
            rows => rows.map(row).collect::<Vec<_>>(),
            counts_per_volt => format!("{:?}", self.counts_per_volt()),
            control_factor => factor,
            control_shift => shift,
            most_count => self.most_count(),
        }
    }
}

/// Returns a factor as a whole number of [`FACTOR_BITS`] bits and the shift that its product is moved down by: `value = factor
/// 2^-shift`.
pub(crate) fn factor(value: f64) -> (i64, i32) {
    let shift = (FACTOR_BITS - value.abs().log2().ceil() as i32).clamp(0, 2 * FACTOR_BITS);
    ((value * f64::from(shift).exp2()).round().clamp(-FULL_FACTOR, FULL_FACTOR) as i64, shift)
}

const FULL_FACTOR: f64 = crate::fixed_point::FULL as f64;

/// Returns the name of a reading in capitals, without its unit.
fn macro_name(field: &str) -> String {
    let short = ["_rad_s", "_m_s2", "_rad"].iter().find_map(|unit| field.strip_suffix(unit));
    short.unwrap_or(field).to_uppercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factor_and_its_shift_are_the_number() {
        for value in [3.05e-5, 1.0, 512.0, 1e-9, 7.3e4] {
            let (factor, shift) = factor(value);
            assert!((factor as f64 * f64::from(-shift).exp2() / value - 1.0).abs() < 4e-9, "{value}");
            assert!(factor < 1 << 31 && (0..=60).contains(&shift));
        }
    }

    #[test]
    fn the_reference_rig_s_gyroscope_has_a_unit_of_30_microradians_a_second() {
        let converters = Converters::of(&counterpoise_models::reference::rig());
        assert!((converters.units_per_count()[1] - 20.0 / 65536.0 / 10.0).abs() < 1e-18);
        assert_eq!((converters.counts_per_volt(), converters.most_count()), (204.8, 2047));
    }
}
