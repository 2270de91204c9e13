//! What commands print of a result, in lines. Tables of channels, whose heads depend on the machine's signals, and paths of written files are printed
//! by the command line itself.
//!
//! Modules in the order of the commands: [`model`], [`synthesis`], [`tuning`], [`search`], [`front`], [`comparison`], [`verdicts`], [`sweep`], [`identification`], [`diagnosis`], [`structure`], [`experiment`].

pub mod comparison;
pub mod diagnosis;
pub mod experiment;
pub mod front;
pub mod identification;
pub mod model;
pub mod search;
pub mod structure;
pub mod sweep;
pub mod synthesis;
pub mod tuning;
pub mod verdicts;

/// Adds a line to lines, as `println!` would print it.
macro_rules! add_line {
    ($lines:expr) => { $lines.push(String::new()) };
    ($lines:expr, $($text:tt)*) => { $lines.push(format!($($text)*)) };
}
pub(crate) use add_line;
