//! Damping matrices, (5-11) to (5-14), and the first-order form (5-16).

use super::fe::FeModel;
use super::modes::Modes;
use crate::Error;
use counterpoise_linalg::{Mat, solve};

/// A frequency and the damping ratio there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DampedFrequency {
    /// Angular frequency, rad/s.
    pub frequency_rad_s: f64,
    /// Damping ratio.
    pub ratio: f64,
}

impl From<[f64; 2]> for DampedFrequency {
    /// From a frequency in rad/s and its damping ratio, as [`crate::parameters::StructuralDamping::Rayleigh`] has them.
    fn from([frequency_rad_s, ratio]: [f64; 2]) -> Self {
        Self { frequency_rad_s, ratio }
    }
}

/// The coefficients of Rayleigh damping, C = a_0 M + a_1 K.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rayleigh {
    /// a_0, 1/s.
    pub mass_factor: f64,
    /// a_1, s.
    pub stiffness_factor: f64,
}

/// Returns the Rayleigh damping that gives two frequencies their damping ratios: (5-11), (5-12).
///
/// # Errors
/// [`Error::Parameter`] if the frequencies are not positive and different.
pub fn rayleigh_coefficients(first: DampedFrequency, second: DampedFrequency) -> Result<Rayleigh, Error> {
    let (w1, z1) = (first.frequency_rad_s, first.ratio);
    let (w2, z2) = (second.frequency_rad_s, second.ratio);
    let apart = w2 * w2 - w1 * w1;
    if !(w1 > 0.0 && w2 > 0.0 && apart != 0.0 && apart.is_finite()) {
        let allowed = "must be positive and differ from the first frequency";
        return Err(Error::Parameter {
            parameter: "rayleigh.second_frequency".to_owned(),
            value: w2,
            allowed: allowed.into(),
        });
    }
    let stiffness = 2.0 * (z2 * w2 - z1 * w1) / apart;
    Ok(Rayleigh { mass_factor: 2.0 * z1 * w1 - stiffness * w1 * w1, stiffness_factor: stiffness })
}

/// Returns C = a_0 M + a_1 K, n x n: (5-11).
pub fn rayleigh_damping(model: &FeModel, factors: Rayleigh) -> Mat {
    &model.M.scale(factors.mass_factor) + &model.K.scale(factors.stiffness_factor)
}

/// Returns C = sum 2 zeta_k w_k (M phi_k) (M phi_k)' over the flexible modes k = 1 .. `ratios.len()`, n x n: (5-13). Modes beyond
/// have no damping.
pub fn modal_damping(model: &FeModel, modes: &Modes, ratios: &[f64]) -> Mat {
    let mut C = Mat::zeros(model.M.nrows(), model.M.nrows());
    for (k, (&frequency, &ratio)) in modes.flexible_rad_s().iter().zip(ratios).enumerate() {
        let carried = &model.M * &Mat::col(modes.flexible_shape(k));
        C += &(&carried * &carried.t()).scale(2.0 * ratio * frequency);
    }
    C
}

/// Returns C = a_1 K + modal damping of what a_1 K leaves, n x n: (5-14) with zeta_n - zeta_Nc w_n / w_Nc in place of the printed
/// zeta_n, which counts the stiffness part twice. The first modes have the ratios given; mode n beyond the last, N_c, has zeta_Nc
/// w_n / w_Nc.
pub fn modal_with_stiffness(model: &FeModel, modes: &Modes, ratios: &[f64]) -> Mat {
    let frequencies = modes.flexible_rad_s();
    let last = ratios.len().min(frequencies.len());
    if last == 0 {
        return Mat::zeros(model.M.nrows(), model.M.nrows());
    }
    let stiffness_factor = 2.0 * ratios[last - 1] / frequencies[last - 1];
    let left = |k: usize| ratios[k] - 0.5 * stiffness_factor * frequencies[k];
    let rest: Vec<f64> = (0..last - 1).map(left).collect();
    &model.K.scale(stiffness_factor) + &modal_damping(model, modes, &rest)
}

/// Returns A of x' = A x + [M^-1; 0] p, x = [q'; q]: [-M^-1 C, -M^-1 K; I, 0], 2n x 2n; (5-16) with the sign of M^-1 C that the
/// print lacks.
///
/// # Errors
/// [`Error::Linalg`] if the shapes differ or M is singular.
pub fn state_matrix(M: &Mat, C: &Mat, K: &Mat) -> Result<Mat, Error> {
    let n = M.nrows();
    let upper = -solve(M, &C.hstack(K))?;
    Ok(upper.vstack(&Mat::eye(n).hstack(&Mat::zeros(n, n))))
}
