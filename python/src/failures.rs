//! Exceptions: what was found in a project file, and what an equation says of its data.

use std::fmt::Display;

use counterpoise_host::projects::BadProject;
use counterpoise_host::terminal::error_causes;
use counterpoise_report::wording::errors::describe_error;
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

create_exception!(
    counterpoise,
    CounterpoiseError,
    PyValueError,
    "What was asked for cannot be done; the text says why."
);
create_exception!(
    counterpoise,
    ProjectError,
    CounterpoiseError,
    "A project file cannot be used. `findings` lists every mistake with file, line, column, path, found, allowed and hint."
);
create_exception!(
    counterpoise,
    NumericalError,
    CounterpoiseError,
    "An equation has no solution, or none that double precision can certify; the text says why."
);

/// Returns an exception for work that failed.
pub fn exception(py: Python<'_>, error: &anyhow::Error) -> PyErr {
    let Some(bad) = error.downcast_ref::<BadProject>() else {
        return CounterpoiseError::new_err(error_causes(error, describe_error).join(": "));
    };
    let raised = ProjectError::new_err(bad.to_string());
    let findings = serde_json::to_string(&bad.errors).unwrap_or_default();
    match raised.value(py).setattr("_findings_json", findings) {
        Ok(()) => raised,
        Err(other) => other,
    }
}

/// Returns an exception for an equation, a norm or a synthesis without an answer.
pub fn numerical(why: impl Display) -> PyErr {
    NumericalError::new_err(why.to_string())
}
