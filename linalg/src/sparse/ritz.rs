//! The poles of a large structure that a subspace knows, and which of them matters most.

use super::pencil::{QuadraticPencil, ShiftedPencil};
use crate::dense::{csolve, transpose_times};
use crate::error::Error;
use crate::mat::{C64, CMat, Mat};
use crate::schur::eigenvalues;
use crate::tolerance::{RITZ_INDEPENDENT, RITZ_LEAST_DAMPING, RITZ_SHIFT_OFFSET};

/// Blocks of the Krylov space of the static shapes from which the first shifts come: as many as find some modes to two digits.
const KRYLOV_BLOCKS: usize = 5;

/// Shapes beyond which the subspace is cut down to the newest, and how many stay.
const LARGEST_BASIS: usize = 90;
const KEPT_SHAPES: usize = 50;

/// The residual of the two equations, for which the next shift is sought.
#[derive(Clone, Copy)]
pub(super) struct Weights<'a> {
    pub(super) reach_position: &'a Mat,
    pub(super) reach_force: &'a Mat,
    pub(super) observe_position: &'a Mat,
    pub(super) observe_force: &'a Mat,
}

/// Shapes that are orthonormal in the inner product of the mass matrix.
pub(super) struct RitzBasis {
    shapes: Mat,
    /// The largest contributions to both Gramians when the iteration began.
    first: Option<[f64; 2]>,
}

/// A pole of the structure within the subspace.
struct Pole {
    value: C64,
    /// The contribution of its mode to what is missing of either Gramian.
    contributions: [f64; 2],
}

/// The structure within the subspace, and what remains of the equations there.
struct ProjectedStructure {
    damping: Mat,
    stiffness: Mat,
    position: CMat,
    force: CMat,
    dual_position: CMat,
    dual_force: CMat,
}

impl RitzBasis {
    /// The space of the shapes under static loads and under the inertia of those shapes, several times.
    pub(super) fn of_static_shapes(
        pencil: &QuadraticPencil,
        factors: &ShiftedPencil,
        loads: &Mat,
    ) -> Result<Self, Error> {
        let mut out = Self { shapes: Mat::zeros(loads.nrows(), 0), first: None };
        let mut block = loads.clone();
        for _ in 0..KRYLOV_BLOCKS {
            let moved = factors.solve(&block.to_complex())?.map(|x| x.re);
            let before = out.shapes.ncols();
            out.add(pencil, &moved)?;
            let added = out.shapes.ncols() - before;
            block = pencil.M.times(&out.shapes.block(0, before, loads.nrows(), added));
        }
        Ok(out)
    }

    /// Adds the real and imaginary parts of shapes.
    pub(super) fn extend(&mut self, pencil: &QuadraticPencil, shapes: &[&CMat]) -> Result<(), Error> {
        for shape in shapes {
            self.add(pencil, &shape.map(|x| x.re))?;
            self.add(pencil, &shape.map(|x| x.im))?;
        }
        Ok(())
    }

    fn add(&mut self, pencil: &QuadraticPencil, shapes: &Mat) -> Result<(), Error> {
        let n = shapes.nrows();
        for j in 0..shapes.ncols() {
            let mut x = shapes.block(0, j, n, 1);
            let length = |x: &Mat| (x.t() * pencil.M.times(x))[(0, 0)].max(0.0).sqrt();
            let before = length(&x);
            for _ in 0..2 {
                x -= &(&self.shapes * &transpose_times(&self.shapes, &pencil.M.times(&x))?);
            }
            let left = length(&x);
            // What is left of a shape must stand well above its rounding.
            if left > RITZ_INDEPENDENT * before {
                self.shapes = self.shapes.hstack(&x.scale(1.0 / left));
            }
        }
        Ok(())
    }

    /// The pole whose mode contributes most to what is missing of the Gramians; `None` if nothing is missing.
    pub(super) fn next_shift(
        &mut self,
        pencil: &QuadraticPencil,
        weights: &Weights,
    ) -> Result<Option<C64>, Error> {
        let poles = self.project_structure(pencil, weights)?.poles()?;
        let largest = |k: usize| poles.iter().map(|pole| pole.contributions[k]).fold(0.0, f64::max);
        let first = *self.first.get_or_insert([largest(0), largest(1)]);
        let importance = |pole: &Pole| {
            let share = |k: usize| if first[k] > 0.0 { pole.contributions[k] / first[k] } else { 0.0 };
            share(0).max(share(1))
        };
        let best = poles.iter().max_by(|a, b| importance(a).total_cmp(&importance(b)));
        Ok(best.filter(|pole| importance(pole) > 0.0).map(|pole| pole.value))
    }

    /// The structure within the subspace; a large subspace is cut down first.
    fn project_structure(
        &mut self,
        pencil: &QuadraticPencil,
        weights: &Weights,
    ) -> Result<ProjectedStructure, Error> {
        if self.shapes.ncols() > LARGEST_BASIS {
            let count = self.shapes.ncols() - KEPT_SHAPES;
            // The shapes that came first know least of the modes that are still missing.
            self.shapes = self.shapes.block(0, count, self.shapes.nrows(), KEPT_SHAPES);
        }
        let Q = &self.shapes;
        let onto = |A: &Mat| transpose_times(Q, A);
        Ok(ProjectedStructure {
            damping: onto(&pencil.D.times(Q))?.symmetric_part(),
            stiffness: onto(&pencil.K.times(Q))?.symmetric_part(),
            position: onto(&pencil.M.times(weights.reach_position))?.to_complex(),
            force: onto(weights.reach_force)?.to_complex(),
            dual_position: onto(weights.observe_position)?.to_complex(),
            dual_force: onto(weights.observe_force)?.to_complex(),
        })
    }
}

impl ProjectedStructure {
    /// The poles on and above the real axis.
    fn poles(&self) -> Result<Vec<Pole>, Error> {
        let q = self.stiffness.nrows();
        if q == 0 {
            return Ok(Vec::new());
        }
        let upper = Mat::zeros(q, q).hstack(&Mat::eye(q));
        let values = eigenvalues(&upper.vstack(&(-&self.stiffness).hstack(&-&self.damping)))?;
        if let Some(&eigenvalue) = values.iter().find(|value| value.re > -RITZ_LEAST_DAMPING * value.norm()) {
            return Err(Error::NotStable { what: "the large structure", eigenvalue });
        }
        values.into_iter().filter(|value| value.im >= 0.0).map(|value| self.pole(value)).collect()
    }

    /// The contributions of a pole, from its residue: `x x' / (x' (2 l + D) x)` with its shape `x`.
    fn pole(&self, value: C64) -> Result<Pole, Error> {
        let q = self.stiffness.nrows();
        let at = |l: C64| {
            CMat::from_fn(q, q, |i, j| {
                let inertia = if i == j { l * l } else { C64::new(0.0, 0.0) };
                inertia + l * self.damping[(i, j)] + self.stiffness[(i, j)]
            })
        };
        // One step of inverse iteration beside the eigenvalue, from a shape without a pattern.
        let start = CMat::from_fn(q, 1, |i, _| C64::new(1.0 + 0.3 * ((7 * i + 3) % 11) as f64, 0.0));
        let x = csolve(&at(value * (1.0 + RITZ_SHIFT_OFFSET)), &start)?;
        let x = x.scale(C64::new(1.0 / x.norm_fro(), 0.0));
        let slope = &x.scale(2.0 * value) + &(&self.damping.to_complex() * &x);
        let size = (x.t() * &slope)[(0, 0)].norm();
        let moved = &(&self.damping.to_complex() * &self.position) + &self.position.scale(value);
        let reach = x.t() * &(&self.force + &moved);
        let observe = x.t() * &(&self.dual_force.scale(value) + &self.dual_position);
        let energy = |A: &CMat| (A.norm_fro() / size.max(f64::MIN_POSITIVE)).powi(2) / (-2.0 * value.re);
        Ok(Pole { value, contributions: [energy(&reach), energy(&observe)] })
    }
}
