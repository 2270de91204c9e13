//! Equations, norms, margins, reductions and syntheses on arrays. Arguments are converted and checked by `counterpoise/numerics.py`.

#![allow(non_snake_case)]

use counterpoise_linalg::riccati::Outcome;
use counterpoise_linalg::{
    C64, CostWeights, Mat, Riccati, care, dare, dlyap, dsylvester, gcare, gdare, gdlyap, glyap, lyap,
    sylvester,
};
use counterpoise_lti as lti;
use counterpoise_lti::{StateSpace, Timebase, h2norm, linfnorm_bounds, margins};
use counterpoise_reduce::{Method, Order, balred};
use counterpoise_report::wording::design_findings::describe_synthesis_error;
use counterpoise_synth::{GeneralisedPlant, h2syn, hinfsyn};
use ndarray::{Array2, ShapeBuilder};
use numpy::{Complex64, PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::failures::numerical;

type Array<'py> = PyReadonlyArray2<'py, f64>;
type Complex<'py> = Bound<'py, PyArray1<Complex64>>;
type ArrayObject<'py> = Bound<'py, PyArray2<f64>>;
/// Matrices, Hankel values, bound, measured error.
type ReductionTuple<'py> = ([ArrayObject<'py>; 4], Vec<f64>, Option<f64>, f64);

/// The equation that is meant, of two.
#[pyclass(eq, from_py_object, module = "counterpoise._native")]
#[derive(Clone, Copy, PartialEq)]
pub enum Time {
    /// In derivatives.
    Continuous,
    /// In samples.
    Discrete,
}

/// The frequency at which a reduced system is exact.
#[pyclass(eq, from_py_object, module = "counterpoise._native")]
#[derive(Clone, Copy, PartialEq)]
pub enum Kept {
    /// In the limit of high frequencies, as balanced truncation is.
    HighFrequencies,
    /// At zero frequency, as singular perturbation is.
    ZeroFrequency,
}

/// Adds the functions to the module.
pub fn add_to(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Time>()?;
    module.add_class::<Kept>()?;
    module.add_function(wrap_pyfunction!(riccati, module)?)?;
    module.add_function(wrap_pyfunction!(lyapunov, module)?)?;
    module.add_function(wrap_pyfunction!(two_sided, module)?)?;
    module.add_function(wrap_pyfunction!(peak_gain, module)?)?;
    module.add_function(wrap_pyfunction!(h2_norm, module)?)?;
    module.add_function(wrap_pyfunction!(loop_margins, module)?)?;
    module.add_function(wrap_pyfunction!(poles, module)?)?;
    module.add_function(wrap_pyfunction!(zeros, module)?)?;
    module.add_function(wrap_pyfunction!(balanced_reduction, module)?)?;
    module.add_function(wrap_pyfunction!(h2_synthesis, module)?)?;
    module.add_function(wrap_pyfunction!(hinf_synthesis, module)?)
}

fn matrix(array: &Array<'_>) -> Mat {
    let view = array.as_array();
    Mat::from_fn(view.nrows(), view.ncols(), |i, j| view[(i, j)])
}

/// An array of the matrix's entries as they lie, column by column.
fn array<'py>(py: Python<'py>, matrix: &Mat) -> PyResult<ArrayObject<'py>> {
    let shape = (matrix.nrows(), matrix.ncols()).f();
    let owned = Array2::from_shape_vec(shape, matrix.as_slice().to_vec()).map_err(numerical)?;
    Ok(PyArray2::from_owned_array(py, owned))
}

/// Returns the exception of a synthesis, with every reason of a refusal.
fn no_controller(why: counterpoise_synth::Error) -> PyErr {
    numerical(describe_synthesis_error(&why))
}

fn complex<'py>(py: Python<'py>, values: &[C64]) -> Complex<'py> {
    PyArray1::from_iter(py, values.iter().map(|z| Complex64::new(z.re, z.im)))
}

/// A system as a tuple: A, B, C, D and the sample period in s, `None` in continuous time.
#[derive(FromPyObject)]
struct SystemMatrices<'py>(Array<'py>, Array<'py>, Array<'py>, Array<'py>, Option<f64>);

impl SystemMatrices<'_> {
    fn system(&self) -> PyResult<StateSpace> {
        let Self(A, B, C, D, period_s) = self;
        let timebase = period_s.map_or(Timebase::Continuous, |period_s| Timebase::Discrete { period_s });
        StateSpace::new(matrix(A), matrix(B), matrix(C), matrix(D), timebase).map_err(numerical)
    }
}

fn matrices<'py>(py: Python<'py>, g: &StateSpace) -> PyResult<[ArrayObject<'py>; 4]> {
    Ok([array(py, &g.A)?, array(py, &g.B)?, array(py, &g.C)?, array(py, &g.D)?])
}

/// Solves a Riccati equation; `E` and `S` may be left out.
#[pyfunction]
fn riccati<'py>(
    py: Python<'py>,
    A: Array<'py>,
    B: Array<'py>,
    Q: Array<'py>,
    R: Array<'py>,
    S: Option<Array<'py>>,
    E: Option<Array<'py>>,
    time: Time,
) -> PyResult<(ArrayObject<'py>, Complex<'py>, ArrayObject<'py>, Bound<'py, PyDict>)> {
    let (A, B, Q, R) = (matrix(&A), matrix(&B), matrix(&Q), matrix(&R));
    let (S, E) = (S.as_ref().map(matrix), E.as_ref().map(matrix));
    let solved = py.detach(|| match (&E, time) {
        (None, Time::Continuous) => care(&A, &B, &Q, &R, S.as_ref()),
        (None, Time::Discrete) => dare(&A, &B, &Q, &R, S.as_ref()),
        (Some(E), Time::Continuous) => gcare(&A, E, &B, &CostWeights { Q: &Q, R: &R, S: S.as_ref() }),
        (Some(E), Time::Discrete) => gdare(&A, E, &B, &CostWeights { Q: &Q, R: &R, S: S.as_ref() }),
    });
    match solved.map_err(numerical)? {
        Outcome::Solved(found) => {
            let (X, F) = (array(py, &found.X)?, array(py, &found.F)?);
            Ok((X, complex(py, &found.closed_loop), F, certificate(py, &found)?))
        }
        Outcome::Infeasible(reason) => Err(numerical(reason)),
    }
}

fn certificate<'py>(py: Python<'py>, found: &Riccati) -> PyResult<Bound<'py, PyDict>> {
    let (certificate, dict) = (&found.certificate, PyDict::new(py));
    dict.set_item("relative_residual", certificate.relative_residual)?;
    dict.set_item("backward_error", certificate.backward_error)?;
    dict.set_item("condition", certificate.condition)?;
    dict.set_item("separation", certificate.separation)?;
    dict.set_item("residual_norm", certificate.residual_norm)?;
    dict.set_item("newton_steps", certificate.newton_steps)?;
    dict.set_item("forward_error", array(py, &certificate.forward_error)?)?;
    dict.set_item("data_error", array(py, &certificate.data_error)?)?;
    Ok(dict)
}

/// Solves a Lyapunov equation.
#[pyfunction]
fn lyapunov<'py>(
    py: Python<'py>,
    A: Array<'py>,
    Q: Array<'py>,
    E: Option<Array<'py>>,
    time: Time,
) -> PyResult<ArrayObject<'py>> {
    let (A, Q, E) = (matrix(&A), matrix(&Q), E.as_ref().map(matrix));
    let solved = py.detach(|| match (&E, time) {
        (None, Time::Continuous) => lyap(&A, &Q),
        (None, Time::Discrete) => dlyap(&A, &Q),
        (Some(E), Time::Continuous) => glyap(&A, E, &Q),
        (Some(E), Time::Discrete) => gdlyap(&A, E, &Q),
    });
    array(py, &solved.map_err(numerical)?)
}

/// Solves A X + X B + C = 0, or A X B - X + C = 0.
#[pyfunction]
fn two_sided<'py>(
    py: Python<'py>,
    A: Array<'py>,
    B: Array<'py>,
    C: Array<'py>,
    time: Time,
) -> PyResult<ArrayObject<'py>> {
    let (A, B, C) = (matrix(&A), matrix(&B), matrix(&C));
    let solved = py.detach(|| match time {
        Time::Continuous => sylvester(&A, &B, &C.scale(-1.0)),
        Time::Discrete => dsylvester(&A, &B, &C),
    });
    array(py, &solved.map_err(numerical)?)
}

/// The largest gain over frequency, from below and from above, and where it is, rad/s.
#[pyfunction]
fn peak_gain(py: Python<'_>, given: SystemMatrices<'_>, tolerance: f64) -> PyResult<(f64, f64, f64)> {
    let g = given.system()?;
    let found = py.detach(|| linfnorm_bounds(&g, tolerance)).map_err(numerical)?;
    Ok((found.lower.value, found.upper, found.lower.rate_rad_s))
}

/// The H2 norm.
#[pyfunction]
fn h2_norm(py: Python<'_>, given: SystemMatrices<'_>) -> PyResult<f64> {
    let g = given.system()?;
    py.detach(|| h2norm(&g)).map_err(numerical)
}

/// The poles.
#[pyfunction]
fn poles<'py>(py: Python<'py>, given: SystemMatrices<'py>) -> PyResult<Complex<'py>> {
    let g = given.system()?;
    Ok(complex(py, &py.detach(|| lti::poles(&g)).map_err(numerical)?))
}

/// The finite invariant zeros.
#[pyfunction]
fn zeros<'py>(py: Python<'py>, given: SystemMatrices<'py>) -> PyResult<Complex<'py>> {
    let g = given.system()?;
    Ok(complex(py, &py.detach(|| lti::zeros(&g)).map_err(numerical)?))
}

/// All margins of a loop of one input and output under negative feedback.
#[pyfunction]
fn loop_margins<'py>(py: Python<'py>, given: SystemMatrices<'py>) -> PyResult<Bound<'py, PyDict>> {
    let g = given.system()?;
    let found = py.detach(|| margins(&g)).map_err(numerical)?;
    let dict = PyDict::new(py);
    dict.set_item("gain", found.gain.iter().map(|m| (m.factor, m.rate_rad_s)).collect::<Vec<_>>())?;
    dict.set_item("phase", found.phase.iter().map(|m| (m.deg, m.rate_rad_s)).collect::<Vec<_>>())?;
    dict.set_item("delay_s", found.delay_s)?;
    dict.set_item("ms", (found.ms.value, found.ms.rate_rad_s))?;
    dict.set_item("mt", (found.mt.value, found.mt.rate_rad_s))?;
    dict.set_item("disk", found.disk.alpha)?;
    dict.set_item("is_stable", found.closed_loop_stable)?;
    Ok(dict)
}

/// Balanced reduction to an order: the matrices, the Hankel values that were ranked, the bound and the measured error.
#[pyfunction]
fn balanced_reduction<'py>(
    py: Python<'py>,
    given: SystemMatrices<'py>,
    order: usize,
    kept: Kept,
) -> PyResult<ReductionTuple<'py>> {
    let g = given.system()?;
    let method = match kept {
        Kept::HighFrequencies => Method::SquareRoot,
        Kept::ZeroFrequency => Method::MatchDc,
    };
    let found = py.detach(|| balred(&g, Order::States(order), method)).map_err(numerical)?;
    Ok((matrices(py, &found.system)?, found.hankel, found.bound, found.measured_error.value))
}

fn generalised_plant(
    given: &SystemMatrices<'_>,
    measurements: usize,
    controls: usize,
) -> PyResult<GeneralisedPlant> {
    GeneralisedPlant::new(given.system()?, controls, measurements).map_err(numerical)
}

/// The controller u = K y that makes the H2 norm smallest, and that norm.
#[pyfunction]
fn h2_synthesis<'py>(
    py: Python<'py>,
    given: SystemMatrices<'py>,
    measurements: usize,
    controls: usize,
) -> PyResult<([ArrayObject<'py>; 4], f64)> {
    let plant = generalised_plant(&given, measurements, controls)?;
    let found = py.detach(|| h2syn(&plant)).map_err(no_controller)?;
    Ok((matrices(py, &found.controller)?, found.achieved_norm))
}

/// A controller u = K y whose H-infinity norm is within `tolerance` of the smallest, the norm that its loop has, and the largest bound that
/// was found not to be reachable.
#[pyfunction]
fn hinf_synthesis<'py>(
    py: Python<'py>,
    given: SystemMatrices<'py>,
    measurements: usize,
    controls: usize,
    tolerance: f64,
) -> PyResult<([ArrayObject<'py>; 4], f64, f64)> {
    let plant = generalised_plant(&given, measurements, controls)?;
    let found = py.detach(|| hinfsyn(&plant, tolerance)).map_err(no_controller)?;
    Ok((matrices(py, &found.controller)?, found.achieved_norm, found.unreachable))
}
