//! The engine of several mechanisms at once: variants of one machine, side by side in the lanes of a register.
//!
//! A smooth sample is one step, and the same operations for every variant. Four variants take it together: each number of the
//! step is a register with one lane a variant, so that the matrices, friction, gravity and the decisions of a step cost the core little
//! more than those of one variant. Where a lane is not smooth (teeth part, the voltage meets its limit, a step must be halved) the step
//! leaves that lane as it was, and the engine of one mechanism takes the variant over the sample. It comes back to its lane as
//! soon as its steps are whole samples again.
//!
//! The operations of a lane are those of [`crate::engine`] in the same order, and no operation mixes lanes. So a variant has the same bytes
//! alone, beside any others, and with any registers.
//!
//! Modules in reading order: [`number`], [`table`], [`nonlinear_parts`], [`state`], [`step`], [`group`].

pub(crate) mod group;
pub(crate) mod nonlinear_parts;
pub(crate) mod number;
pub(crate) mod state;
pub(crate) mod step;
pub(crate) mod table;
