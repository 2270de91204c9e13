//! The places along the road. Each is one function `show(studio, ui, queue)`: it draws what the studio knows and pushes commands;
//! it changes nothing of the project itself. How a place is written:
//!
//! 1. Take the design by `studio.results.design(revision)`, a verification from `studio.results.verified`; show a stale one dimmed.
//! 2. Draw plots as [`Chart`](crate::chart::Chart)s through [`parts::chart`], which makes them copyable, in cells of [`parts::grid`].
//! 3. Show numbers of the project by [`parts::number`]: unit, range and meaning come from the project file's own reference.
//! 4. Say in place what is missing and how to get it ([`parts::empty`]), never with a blank.

pub mod browse;
pub mod consequences;
pub mod design;
pub mod diagnose;
pub mod fields;
pub mod findings;
pub mod kept;
pub mod limits;
pub mod parts;
pub mod plant;
pub mod reduce;
pub mod robustness;
pub mod schematic;
pub mod verify;
pub mod welcome;
