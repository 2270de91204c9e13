//! The derivatives of a run's outputs with respect to parameters of the machine, its start and the gains of its controller.
//!
//! Forward mode along the steps that the run takes: every step is differentiated as it stands (the matrices of the core, the
//! ports from their linear equation, the closed forms of friction), every operation of sensors and controller too, and at events the
//! derivatives jump as the state's slope does. What a direction changes of stored numbers (matrices, levels of friction, gains) is found once
//! by differences of fourth order of these numbers. The run itself has the same bytes as without derivatives.
//!
//! Quantised converters pass the derivatives of the signal before it is rounded; at the end of a converter's range they are 0.
//!
//! Not covered, and refused with the reason: bristle friction and a reset integrator that jumps, grazing and simultaneous events, hoses,
//! losses and errors of the mesh, loads, learned functions, cylinders, friction of varying level, bases that roll, yaw or surge, limits of the
//! drive, clocks with errors.
//!
//! Modules in reading order: `refusal`, `stencil`, [`direction`], `dual`, `block`, `machine_slopes`, `friction_slopes`, `port_rows`, `core_tables`,
//! `sensor_slopes`, `step_slopes`, `jumps`, `readings`, [`controllers`], [`mod@run`].

mod block;
pub mod controllers;
mod core_tables;
pub mod direction;
mod dual;
mod friction_slopes;
mod jumps;
mod machine_slopes;
mod port_rows;
mod readings;
mod refusal;
pub mod run;
mod sensor_slopes;
mod stencil;
mod step_slopes;

pub use controllers::{
    DifferentiableController, DifferentiablePi, DifferentiablePosition, DifferentiableProgram, FixedControl,
    PiGains,
};
pub use direction::{Direction, Member};
pub use refusal::SensitivityRefusal;
pub use run::{OutputSlopes, SensitiveRun};
pub use stencil::Side;
