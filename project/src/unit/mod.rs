//! Quantities with units: `0.5 mrad`, `120 kg cm^2`, `3000 rpm`, `200:1`, `14 bit`.
//!
//! A key of the project file states the unit in which it takes a bare number. A text in its place is a number with a unit of
//! the user's choice, of the same dimension. [`read_quantity`] converts it to the unit of the key, and [`rewrite_quantity`] puts a new value into
//! a text in the unit that the user wrote.
//!
//! A unit is a size, split into a factor and a power of ten so that decimal prefixes are exact (`"0.5 mrad"` is the same number
//! as `0.5e-3`), and a dimension. The radian is a dimension of its own, so that `N m` is not mistaken for `N m/rad`; it may be
//! left out of rates, viscous coefficients and back-EMF constants, where the SI writes `1/s`, `N m s` and `V s`. The hertz counts
//! cycles: a frequency in `Hz` becomes 2 pi times as many `rad/s`, and a density per `Hz` is one times seconds.
//!
//! The units by name stand in [`counterpoise_recordings::unit::table`], because recordings have them, too.
//!
//! Modules in reading order: [`dimension`], [`parser`] (products, quotients, powers), [`quantity`]
//! (number and unit together), `scale` (from one unit to another).

pub mod dimension;
pub mod parser;
pub mod quantity;
mod scale;

pub use dimension::Dimension;
pub use parser::{MassOrForce, Unit, UnitError};
pub use quantity::{QuantityError, read_quantity, rewrite_quantity};
