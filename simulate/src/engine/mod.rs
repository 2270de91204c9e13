//! The integrator: exact where the plant is linear, by collocation where it is not.
//!
//! The plant is a linear core with a few nonlinear inputs ("ports": the torques of dry friction, gravity's angle,
//! ripples and springs), and its core changes where the teeth part or meet. A step carries the core by its matrix
//! exponential, and the ports as cubic polynomials through the four nodes of Lobatto's rule: an exponential
//! collocation method, of order six where the ports are smooth. The unknown port values at three nodes are found by
//! fixed-point iteration on five outputs a node, so that a step costs one product with a stored matrix and a few
//! small ones.
//!
//! Dry friction is advanced from node to node by its own closed form in the displacement, which is exact however
//! stiff presliding is: nothing in a step can blow up, and a saturated friction costs no small steps.
//!
//! The steps are a sample period and its halves, so that every matrix is made once. Where the ports are not a cubic (a
//! reversal inside the step) the step is halved, up to eight times; where teeth part or meet, the voltage meets its limit, a
//! joint comes to rest or breaks away, shorter and shorter steps end at that instant. The control is held between
//! samples, and most samples of a smooth motion are one step.
//!
//! Modules in reading order: [`modal_transform`], [`moments`], [`strips`], [`tables`], [`linear_core`] (the core in its modes), [`table_computation`],
//! [`ports`], [`state`], [`crossing`], [`attempt`] (one step), [`present_plant`] (where the plant is), [`joints`] (true stick),
//! [`events`], [`filter`], [`stepper`]. Each uses only modules before it in this list.

pub(crate) mod attempt;
pub(crate) mod crossing;
pub(crate) mod events;
pub(crate) mod filter;
pub(crate) mod joints;
pub(crate) mod linear_core;
pub(crate) mod modal_transform;
pub(crate) mod moments;
pub(crate) mod ports;
pub(crate) mod present_plant;
pub(crate) mod state;
pub(crate) mod stepper;
pub(crate) mod strips;
pub(crate) mod table_computation;
pub(crate) mod tables;
