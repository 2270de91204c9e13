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
//! The steps are a sample period halved up to eight times, so that every matrix is stored. Where the ports are not a
//! cubic (a reversal inside the step), or the teeth change, the step is halved; the control is held between samples,
//! and most samples of a smooth motion are one step.

pub(crate) mod attempt;
pub(crate) mod filter;
pub(crate) mod joints;
pub(crate) mod linear;
pub(crate) mod moments;
pub(crate) mod ports;
pub(crate) mod stepper;
pub(crate) mod strips;
pub(crate) mod tables;
