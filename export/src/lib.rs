//! The verified controller as source code.
//!
//! In come a verified controller (a [`ExportSource`]) and its [`Provenance`]; out go files as text: C99 and a
//! `no_std` Rust crate, each with test vectors from the reference. Both print the same straight line of arithmetic that
//! the reference runs, so their answers are equal to the last bit.
//!
//! *Invariant*: no file system, no clock, no compiler: text in memory only.
//!
//! Modules in reading order: [`source`], [`converters`], [`provenance`], [`c99`](mod@c99), [`rust_crate`](mod@rust_crate), [`ranges`],
//! [`rounding`], [`forms`], [`fixed_point`], [`targets`], [`signal_names`], [`board`], [`host`],
//! [`fmi`], [`vectors`], [`check`], [`error`].
//!
//! ```
//! use counterpoise_controller::{Controller, Parts};
//! use counterpoise_export::{CodeOptions, ExportSource, Provenance, c99};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let controller = Controller::new(Parts::new(1e-3, 10.0))?;
//! let files = c99(ExportSource::Unverified(&controller), &Provenance::default(), &CodeOptions::double("controller"))?;
//! assert_eq!(files[1].name, "controller.c");
//! assert!(files[1].text.contains("controller_step"));
//! # Ok(())
//! # }
//! ```
#![allow(non_snake_case)]

pub mod board;
pub mod c99;
pub mod check;
pub mod converters;
pub mod error;
pub mod fixed_point;
pub mod fmi;
pub mod forms;
pub mod host;
pub mod provenance;
pub mod ranges;
pub mod rounding;
pub mod rust_crate;
pub mod signal_names;
pub mod source;
pub mod targets;
pub mod vectors;

mod comment;
mod guard;
mod print;
mod tolerance;

pub use c99::c99;
pub use check::{CheckOutcome, check_file};
pub use converters::Converters;
pub use error::Error;
pub use fixed_point::{FixedError, FixedPointController, FixedRunner, fixed_c99, plan_fixed_point};
pub use forms::{FormFigures, PathForm, figures_by_form};
pub use provenance::Provenance;
pub use ranges::{AdjustableController, MeasuredDeviation, Ranges};
pub use rounding::{Deviation, single_precision};
pub use rust_crate::rust_crate;
pub use source::ExportSource;
pub use targets::{
    FixedFigures, Numbers, Record, TargetFigures, TargetRuns, Targets, compare_targets, fixed_form,
};

use counterpoise_controller::program::Operation;
use counterpoise_controller::words::is_word;
use counterpoise_controller::{Controller, READINGS};

/// A file of generated code.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct File {
    /// Name, with folders separated by '/'.
    pub name: String,
    /// Contents.
    pub text: String,
}

/// The numbers that the target computes in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// IEEE double: equal to the reference to the last bit.
    Double,
    /// IEEE single.
    Single,
}

/// Options of generated code.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CodeOptions {
    /// Prefix of every name and every file of the code: a lower-case identifier.
    pub name: String,
    /// Numbers of the target.
    pub precision: Precision,
}

impl CodeOptions {
    /// Returns double precision under a name.
    pub fn double(name: &str) -> Self {
        Self { name: name.to_owned(), precision: Precision::Double }
    }

    /// Returns single precision under a name.
    pub fn single(name: &str) -> Self {
        Self { name: name.to_owned(), precision: Precision::Single }
    }
}

/// Name and meaning of each reading, in order.
pub(crate) const READING_FIELDS: [(&str, &str); READINGS] = [
    ("demand_rad_s", "demanded hub rate, rad/s"),
    ("hub_rate_rad_s", "hub gyroscope, rad/s, positive nose-up, inertial"),
    ("platform_rate_rad_s", "platform gyroscope, rad/s, inertial"),
    ("platform_accel_m_s2", "platform accelerometer (heave, upwards), m/s^2, without gravity"),
    ("motor_rate_rad_s", "motor tachometer, rad/s relative to the platform"),
    ("hub_position_rad", "hub angle relative to the platform, rad"),
    ("platform_surge_m_s2", "second platform accelerometer (surge, forwards), m/s^2, without gravity"),
];

/// Returns name and meaning of the readings that a controller takes.
pub(crate) fn reading_fields(controller: &Controller) -> Vec<(&'static str, &'static str)> {
    READING_FIELDS[..controller.parts().reading_count()].to_vec()
}

/// Refuses a name that is no short lower-case identifier.
pub(crate) fn check_name(name: &str) -> Result<(), Error> {
    let problem = match name.chars().next() {
        None => Some("is empty"),
        Some(first) if !first.is_ascii_lowercase() => Some("must start with a lower-case letter"),
        _ if !name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_') => {
            Some("may hold only a to z, 0 to 9 and _")
        }
        _ if name.len() > 24 => Some("is longer than 24 characters"),
        _ if is_word(name) => {
            Some("is a keyword of C, C++ or Rust, or a name that their tools have taken: give another")
        }
        _ => None,
    };
    problem.map_or(Ok(()), |problem| Err(Error::Name { name: name.to_owned(), problem }))
}

/// Refuses coefficients that the precision cannot hold: overflow, or underflow to 0.
pub(crate) fn check_range(controller: &Controller, precision: Precision) -> Result<(), Error> {
    if precision == Precision::Double {
        return Ok(());
    }
    let programs = controller.programs();
    let operations = programs.step.operations().chain(programs.set_out_of_balance.operations());
    for value in operations.flat_map(constants).chain(programs.initial()) {
        let held = value as f32;
        if !held.is_finite() || (held == 0.0 && value != 0.0) {
            return Err(Error::SingleRange { what: "a coefficient".into(), value });
        }
    }
    Ok(())
}

fn constants(operation: &Operation) -> Vec<f64> {
    match operation {
        Operation::Sum { constant, terms, .. } => {
            constant.iter().copied().chain(terms.iter().map(|term| term.coefficient)).collect()
        }
        Operation::Clamp { low, high, .. } => vec![*low, *high],
        _ => Vec::new(),
    }
}
