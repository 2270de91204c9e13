//! Lightly damped modes of a plant, and plants whose modes are elsewhere: a little off and less damped, or those of a much stiffer structure.

use counterpoise_linalg::{C64, CMat, CSvd, Mat, csvd};
use counterpoise_lti::poles;

use crate::tolerance::{DEFECTIVE_MODE, LIGHTLY_DAMPED, MODE_SHIFT};
use crate::{DesignPlant, Error};

impl DesignPlant {
    /// Returns the plant with its lightly damped modes far quicker and well damped: what a much stiffer structure would be.
    ///
    /// # Errors
    /// Those of the modes.
    pub fn with_stiff_modes(&self) -> Result<Self, Error> {
        stiffen(self, 0.0)
    }
}

/// Returns the natural frequencies of a plant's lightly damped modes, rad/s, rising; those of the delay's approximation are
/// not among them.
///
/// # Errors
/// Those of the eigenvalues.
pub(crate) fn light_modes(plant: &DesignPlant) -> Result<Vec<C64>, Error> {
    let mut found: Vec<C64> = poles(&plant.system)?
        .into_iter()
        .filter(|pole| pole.im > 0.0 && pole.re.abs() < LIGHTLY_DAMPED * pole.norm())
        .collect();
    found.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
    Ok(found)
}

/// Returns the plants whose lightly damped modes are all slower and all faster by [`MODE_SHIFT`], with half the damping.
///
/// # Errors
/// Those of the decompositions.
pub(crate) fn shifted_modes(plant: &DesignPlant, modes: &[C64]) -> Result<Vec<DesignPlant>, Error> {
    if modes.is_empty() {
        return Ok(Vec::new());
    }
    let both = [1.0 / (1.0 + MODE_SHIFT), 1.0 + MODE_SHIFT];
    let halved = |factor: f64| move |mode: C64| C64::new(0.5 * mode.re, mode.im) * factor;
    both.into_iter().map(|factor| move_modes(plant, modes, halved(factor))).collect()
}

/// Returns a plant whose lightly damped modes beyond a frequency are far quicker and well damped: what a much stiffer structure would be.
///
/// # Errors
/// Those of the decompositions.
pub(crate) fn stiffen(plant: &DesignPlant, beyond_rad_s: f64) -> Result<DesignPlant, Error> {
    let mut modes = light_modes(plant)?;
    modes.retain(|mode| mode.norm() > beyond_rad_s);
    let mut stiff = move_modes(plant, &modes, |mode| C64::from_polar(STIFFER * mode.norm(), STIFF_ANGLE))?;
    if let Some(inner) = &mut stiff.rate_loop {
        inner.plant = stiffen(&inner.plant, beyond_rad_s)?;
    }
    Ok(stiff)
}

/// Factor on the frequencies of the modes of a much stiffer structure: out of reach of any loop that they limited.
const STIFFER: f64 = 5.0;
/// Angle of their poles: a damping ratio of 0.5, so that sampling does not fold a peak back.
const STIFF_ANGLE: f64 = 2.0 * std::f64::consts::FRAC_PI_3;

/// Moves each mode p to its target q: `A + 2 Re((q - p) v w^H / w^H v)` with the right and left eigenvectors v and w of p.
/// Eigenvectors and all other modes stay.
fn move_modes(plant: &DesignPlant, modes: &[C64], target: impl Fn(C64) -> C64) -> Result<DesignPlant, Error> {
    let A = &plant.system.A;
    let mut moved = A.clone();
    for &mode in modes {
        let change = target(mode) - mode;
        if let Some(projector) = projector(A, mode)? {
            let n = A.nrows();
            moved += &Mat::from_fn(n, n, |i, j| 2.0 * (change * projector[(i, j)]).re);
        }
    }
    let mut other = plant.clone();
    other.system.A = moved;
    Ok(other)
}

/// The projector `v w^H / (w^H v)` onto a mode; `None` if its eigenvectors are orthogonal (a defective mode).
fn projector(A: &Mat, mode: C64) -> Result<Option<CMat>, Error> {
    let n = A.nrows();
    let CSvd { U, V, .. } = csvd(&(&A.to_complex() - &CMat::eye(n).scale(mode)))?;
    let (left, right) = (U.column(n - 1), V.column(n - 1));
    let product: C64 = left.iter().zip(right).map(|(w, v)| w.conj() * v).sum();
    if product.norm() < DEFECTIVE_MODE {
        return Ok(None);
    }
    Ok(Some(CMat::from_fn(n, n, |i, j| right[i] * left[j].conj() / product)))
}
