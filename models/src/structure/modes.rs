//! Modal analysis: natural frequencies, shapes and effective masses.

use super::fe::FeModel;
use crate::Error;
use crate::tolerance::FREE;
use counterpoise_linalg::{Mat, sym_gen_eigen};

/// Support of the structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Support {
    /// Not at all: two rigid modes.
    Free,
    /// The hub's deflection is held, its rotation free: one rigid mode.
    Pinned,
    /// Deflection and rotation of the hub are held.
    Clamped,
}

/// A rigid motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Upward translation.
    Heave,
    /// Rotation about the pivot.
    Pitch,
}

/// The undamped modes of a structure.
#[derive(Debug, Clone, PartialEq)]
pub struct Modes {
    /// Support of the structure.
    pub support: Support,
    /// Number of rigid modes, which come first and have frequency 0.
    pub rigid: usize,
    /// Natural frequencies, rad/s, rising.
    pub frequencies_rad_s: Vec<f64>,
    /// Mode shapes as columns over all unknowns, held ones included as zeros; phi' M phi = 1, the tip moves upward.
    pub shapes: Mat,
}

/// Returns the modes: K phi = w^2 M phi on the unknowns that the support leaves free.
///
/// The rigid modes are the exact rigid motions, and the flexible ones are made orthogonal to them. Unknowns without mass
/// (rotations of a lumped-mass model) follow the others statically; there are as many modes as unknowns with mass. Cost:
/// one symmetric eigenproblem of the number of unknowns.
///
/// # Errors
/// [`Error::Parameter`] if an unknown has a negative mass, or fewer have any than there are rigid motions, [`Error::NoHubNode`] if a held structure has no node at the pivot, [`Error::NotFree`] if K resists a rigid
/// motion that the support leaves free, [`Error::Linalg`] if M is not positive definite.
pub fn undamped_modes(model: &FeModel, support: Support) -> Result<Modes, Error> {
    let n = model.M.nrows();
    let held = restrained_unknowns(model, support)?;
    let free: Vec<usize> = (0..n).filter(|i| !held.contains(i)).collect();
    masses(model, &free, support)?;
    let rigid = rigid_modes(model, support)?;
    let (values, vectors) = pencil(&model.K.select(&free, &free), &model.M.select(&free, &free))?;
    let mut out = Modes {
        support,
        rigid: rigid.len(),
        frequencies_rad_s: values.iter().map(|v| v.max(0.0).sqrt()).collect(),
        shapes: Mat::zeros(n, values.len()),
    };
    for (j, shape) in rigid.iter().enumerate() {
        out.frequencies_rad_s[j] = 0.0;
        out.shapes.column_mut(j).copy_from_slice(shape);
    }
    for j in rigid.len()..values.len() {
        let mut shape = vec![0.0; n];
        free.iter().enumerate().for_each(|(k, &i)| shape[i] = vectors[(k, j)]);
        rigid.iter().for_each(|r| remove(model, &mut shape, r));
        normalise(model, &mut shape);
        out.shapes.column_mut(j).copy_from_slice(&shape);
    }
    Ok(out)
}

impl Modes {
    /// Returns the natural frequencies of the flexible modes, rad/s.
    pub fn flexible_rad_s(&self) -> &[f64] {
        &self.frequencies_rad_s[self.rigid..]
    }

    /// Returns the shape of flexible mode `k`, from 0.
    pub fn flexible_shape(&self, k: usize) -> &[f64] {
        self.shapes.column(self.rigid + k)
    }

    /// Returns the participation phi_k' M r of each mode in a rigid motion, kg^(1/2) or kg^(1/2) m.
    pub fn participation(&self, model: &FeModel, direction: Direction) -> Vec<f64> {
        let rigid = match direction {
            Direction::Heave => &model.heave,
            Direction::Pitch => &model.pitch,
        };
        let carried = &model.M * &Mat::col(rigid);
        (&self.shapes.t() * &carried).as_slice().to_vec()
    }

    /// Returns the effective mass (phi_k' M r)^2 of each mode: kg for heave, kg m^2 for pitch. Over all modes they add up to the
    /// total mass or inertia, less what rests on the held unknowns.
    pub fn effective_mass(&self, model: &FeModel, direction: Direction) -> Vec<f64> {
        self.participation(model, direction).into_iter().map(|p| p * p).collect()
    }
}

/// K v = lambda M v, rising, for as many lambda as unknowns have mass.
///
/// If some have none, M v = mu (K + s M) v with a shift s of the order of the first flexible lambda, and
/// lambda = 1 / mu - s.
fn pencil(K: &Mat, M: &Mat) -> Result<(Vec<f64>, Mat), Error> {
    let n = M.nrows();
    let with_mass: Vec<usize> = (0..n).filter(|&i| M[(i, i)] > 0.0).collect();
    if with_mass.len() == n {
        return Ok(sym_gen_eigen(K, M)?);
    }
    let highest = with_mass.iter().map(|&i| K[(i, i)] / M[(i, i)]).fold(0.0, f64::max);
    let shift = highest * (2.0 / n as f64).powi(4);
    let (inverses, vectors) = sym_gen_eigen(M, &(K + &M.scale(shift)))?;
    let order: Vec<usize> = (n - with_mass.len()..n).rev().collect();
    let values = order.iter().map(|&j| 1.0 / inverses[j] - shift).collect();
    Ok((values, vectors.select(&(0..n).collect::<Vec<_>>(), &order)))
}

/// No unknown has a negative mass, and as many have one as there are rigid motions.
fn masses(model: &FeModel, free: &[usize], support: Support) -> Result<(), Error> {
    let mass = |i: &usize| model.M[(*i, *i)];
    if let Some(row) = free.iter().find(|i| mass(i) < 0.0 || mass(i).is_nan()) {
        let parameter = format!("entry ({0}, {0}) of the mass matrix", row + 1);
        return Err(Error::Parameter { parameter, value: mass(row), allowed: "must not be negative".into() });
    }
    let rigid = match support {
        Support::Free => 2,
        Support::Pinned => 1,
        Support::Clamped => 0,
    };
    let with_mass = free.iter().filter(|i| mass(i) > 0.0).count();
    if with_mass < rigid {
        let parameter = "number of unknowns with mass".to_owned();
        let allowed = "must be at least that of the motions that nothing holds";
        return Err(Error::Parameter { parameter, value: with_mass as f64, allowed: allowed.into() });
    }
    Ok(())
}

fn restrained_unknowns(model: &FeModel, support: Support) -> Result<Vec<usize>, Error> {
    match support {
        Support::Free => Ok(Vec::new()),
        Support::Pinned => model.hub.map(|h| vec![h.deflection]).ok_or(Error::NoHubNode),
        Support::Clamped => model.hub.map(|h| vec![h.deflection, h.rotation]).ok_or(Error::NoHubNode),
    }
}

/// Returns the rigid modes that the support leaves, of unit modal mass and orthogonal.
fn rigid_modes(model: &FeModel, support: Support) -> Result<Vec<Vec<f64>>, Error> {
    let motions: &[(&'static str, &Vec<f64>)] = match support {
        Support::Free => &[("heave", &model.heave), ("pitch", &model.pitch)],
        Support::Pinned => &[("pitch", &model.pitch)],
        Support::Clamped => &[],
    };
    let mut out: Vec<Vec<f64>> = Vec::new();
    for (motion, vector) in motions {
        let vector_norm = Mat::col(vector).norm_fro();
        let relative = (&model.K * &Mat::col(vector)).norm_fro() / (model.K.norm_fro() * vector_norm);
        if relative > FREE {
            return Err(Error::NotFree { motion, relative });
        }
        let mut shape = (*vector).clone();
        out.iter().for_each(|r| remove(model, &mut shape, r));
        normalise(model, &mut shape);
        out.push(shape);
    }
    Ok(out)
}

fn remove(model: &FeModel, shape: &mut [f64], rigid: &[f64]) {
    let share = model.inner(rigid, shape);
    shape.iter_mut().zip(rigid).for_each(|(s, r)| *s -= share * r);
}

/// Unit modal mass, tip upward.
fn normalise(model: &FeModel, shape: &mut [f64]) {
    let norm = model.inner(shape, shape).sqrt();
    let factor = if shape[model.tip.deflection] < 0.0 { -1.0 / norm } else { 1.0 / norm };
    shape.iter_mut().for_each(|s| *s *= factor);
}
