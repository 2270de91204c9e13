//! Counterpoise in Python: the native half of the package `counterpoise`.
//!
//! Modules: `background` (work beside the interpreter), `failures` (exceptions), `numerics` (equations, norms, margins, syntheses),
//! `project` (a project file and everything that is made of it), `simulation` (runs of the machine), `studies` (robustness, frequency
//! response maps, adaptation, identification).
//!
//! *Invariant*: no mathematics. Results cross as JSON, which is what the command line writes, and arrays as arrays.

mod background;
mod failures;
mod numerics;
mod project;
mod simulation;
mod studies;

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the command line: the arguments with the name of the program first; returns the exit code. It takes the process over, as the
/// program `counterpoise` does.
#[pyfunction]
fn run_command_line(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| counterpoise::run_command_line(arguments))
}

/// The native half of the package `counterpoise`.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("SCHEMA", counterpoise_pipeline::exchange::SCHEMA)?;
    module.add("CounterpoiseError", module.py().get_type::<failures::CounterpoiseError>())?;
    module.add("ProjectError", module.py().get_type::<failures::ProjectError>())?;
    module.add("NumericalError", module.py().get_type::<failures::NumericalError>())?;
    module.add_class::<project::NativeProject>()?;
    module.add_function(wrap_pyfunction!(run_command_line, module)?)?;
    module.add_function(wrap_pyfunction!(simulation::simulate, module)?)?;
    module.add_function(wrap_pyfunction!(studies::sweep, module)?)?;
    module.add_function(wrap_pyfunction!(studies::adaptation, module)?)?;
    module.add_function(wrap_pyfunction!(studies::frequency_response_map, module)?)?;
    module.add_function(wrap_pyfunction!(studies::identification, module)?)?;
    numerics::add_to(module)
}
