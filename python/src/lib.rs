//! Counterpoise in Python: the native half of the package `counterpoise`.
//!
//! Modules: `background` (work beside the interpreter), `failures` (exceptions), `numerics` (equations, norms, margins, syntheses),
//! `project` (a project file and everything that is made of it), `simulation` (runs of the machine).
//!
//! *Invariant*: no mathematics. Results cross as JSON, which is what the command line writes, and arrays as arrays.

mod background;
mod failures;
mod numerics;
mod project;
mod simulation;

use pyo3::prelude::*;

/// The native half of the package `counterpoise`.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("SCHEMA", counterpoise_pipeline::exchange::SCHEMA)?;
    module.add("CounterpoiseError", module.py().get_type::<failures::CounterpoiseError>())?;
    module.add("ProjectError", module.py().get_type::<failures::ProjectError>())?;
    module.add("NumericalError", module.py().get_type::<failures::NumericalError>())?;
    module.add_class::<project::NativeProject>()?;
    module.add_function(wrap_pyfunction!(simulation::simulate, module)?)?;
    numerics::add_to(module)
}
