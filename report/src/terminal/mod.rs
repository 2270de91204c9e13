//! What commands print of a result, in lines. The paths of written files are printed by the command line itself.
//!
//! Modules in the order of the commands: [`model`], [`reduction`], [`first_design`], [`synthesis`], [`tuning`], [`search`], [`front`], [`comparison`], [`verdicts`], [`changes`], [`response_map`], [`adaptation`], [`sweep`], [`identification`], [`replay`], [`diagnosis`], [`structure`], [`experiment`].

pub mod adaptation;
pub mod changes;
pub mod comparison;
pub mod diagnosis;
pub mod experiment;
pub mod first_design;
pub mod front;
pub mod identification;
pub mod model;
pub mod reduction;
pub mod replay;
pub mod response_map;
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
