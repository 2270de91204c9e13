//! A continuous plant under held inputs, with the exact cost and noise of a period.

use counterpoise_linalg::Mat;
use counterpoise_lti::{Discretisation, Noise, QuadraticCost as Quadratic, StateSpace, c2d, sampled_problem};

use crate::stage::{SampledNoise, Stage};
use crate::{DesignPlant, Error};

/// A continuous problem `x' = A x + B q + white noise, z = seen x + direct q` whose inputs q are held.
pub(super) struct Problem<'a> {
    pub A: &'a Mat,
    pub B: &'a Mat,
    pub seen: &'a Mat,
    pub direct: &'a Mat,
    /// Spectral density of the white noise on the states.
    pub process: &'a Mat,
    /// Spectral density of the noise of a reading.
    pub density: f64,
    /// The reading's row on the states.
    pub reading: &'a Mat,
}

/// Returns the problem under held inputs, with the cost and the noise of one period.
///
/// # Errors
/// Those of the matrix exponentials.
pub(super) fn discretise_under_hold(
    problem: &Problem<'_>,
    period_s: f64,
) -> Result<(Stage, SampledNoise), Error> {
    let Problem { A, B, seen, direct, process, density, reading } = *problem;
    let (Q, R, S) = (&seen.t() * seen, &direct.t() * direct, &seen.t() * direct);
    let cost = Quadratic { Q: &Q, R: &R, S: &S };
    let measurement = Mat::eye(1).scale(density);
    let noise = Noise { process, measurement: &measurement };
    let found = sampled_problem(A, B, cost, noise, period_s)?;
    let weight = Mat::from_blocks(&[&[&found.cost.Q, &found.cost.S], &[&found.cost.S.t(), &found.cost.R]]);
    let noise = SampledNoise {
        process: found.process,
        reading: reading.clone(),
        measurement: found.measurement[(0, 0)],
        unavoidable: found.unavoidable,
    };
    Ok((Stage { A: found.cost.A, B: found.cost.B, weight }, noise))
}

pub(super) fn remove_delay(plant: &DesignPlant) -> DesignPlant {
    DesignPlant { pade_order: 0, ..plant.clone() }
}

pub(super) fn bilinear(weight: &StateSpace, period_s: f64) -> Result<StateSpace, Error> {
    Ok(c2d(weight, period_s, Discretisation::Tustin { prewarp_rad_s: None })?)
}

/// The row with zeros behind it.
pub(super) fn pad_columns(row: &Mat, columns: usize) -> Mat {
    row.hstack(&Mat::zeros(1, columns - row.ncols()))
}
