//! Eigenvectors of single eigenvalues from the Schur form, O(n^2) each: how the input reaches a mode, and how well an
//! eigenvalue is determined by the entries of its matrix.

use crate::balance::balance;
use crate::boundary::Boundary;
use crate::dense::dot;
use crate::error::Error;
use crate::mat::{C64, Mat};
use crate::pencil_roots::{DoubtfulMode, corrected_modes};
use crate::schur::{Schur, schur};
use crate::structure::Structure;
use crate::tolerance::{BOUNDARY_SUSPECT, EIGENVALUE_ERROR, EPS, FIRST_ORDER, GROWN_ENTRIES, VECTOR_NOISE};

/// A matrix `A = D B D^-1`, its balanced form `B` and the Schur form of that.
pub(crate) struct Spectrum {
    balanced: Mat,
    form: Schur,
    scale: Vec<f64>,
    size: f64,
}

/// The action of the input on one mode, from the left eigenvector `v` of the mode.
pub(crate) struct Reach {
    pub(crate) mode: C64,
    /// `norm(v'M)` relative to `norm(v)` and the norm of `M`: an upper bound of the distance from losing the mode.
    pub(crate) normwise: f64,
    /// `|v'M|` beyond rounding, relative to `|v|'|M|`, the largest over the columns of `M`: does not depend on units.
    pub(crate) entrywise: f64,
}

/// By how much rounding may move an eigenvalue.
struct Movement {
    /// If each entry of the matrix is rounded.
    by_entries: f64,
    /// The part of that across the boundary of stability.
    across: f64,
    /// If the matrix is changed by a rounding of its norm, as the iteration for eigenvalues does.
    by_norm: f64,
}

impl Spectrum {
    /// The spectrum of `A`.
    pub(crate) fn of(A: &Mat) -> Result<Self, Error> {
        let balanced = balance(A)?;
        let form = schur(&balanced.A)?;
        Ok(Self::from_form(balanced.A, form, balanced.scale))
    }

    /// The spectrum of a balanced matrix whose Schur form is known.
    pub(crate) fn from_form(balanced: Mat, form: Schur, scale: Vec<f64>) -> Self {
        let norm = balanced.norm_fro();
        let size = if norm > 0.0 { norm } else { 1.0 };
        Self { balanced, form, scale, size }
    }

    /// The Schur form and the scale of each state.
    pub(crate) fn into_form(self) -> (Schur, Vec<f64>) {
        (self.form, self.scale)
    }

    /// The eigenvalues with an imaginary part that is not negative.
    pub(crate) fn modes(&self) -> Vec<C64> {
        self.form.eigenvalues().into_iter().filter(|l| l.im >= 0.0).collect()
    }

    /// Returns how `M`, n x m, reaches a mode.
    pub(crate) fn reachability(&self, M: &Mat, mode: C64) -> Reach {
        let back: Vec<f64> = self.scale.iter().map(|d| 1.0 / d).collect();
        acts_on(M, mode, &self.left_vector(mode), &back)
    }

    /// Returns how `M`, n x m, sees a mode: its reach for the transposed matrix.
    pub(crate) fn observability(&self, M: &Mat, mode: C64) -> Reach {
        let triangle = Triangle::of(&self.form.T, mode, EPS * self.size);
        let x = triangle.solve_right(vec![C64::new(1.0, 0.0); self.form.T.nrows()]);
        acts_on(M, mode, &self.transform_vector(&triangle.solve_right(x)), &self.scale)
    }

    /// The eigenvalues (one of each conjugate pair) that lie on the boundary of stability within what rounding the entries of `A`
    /// may move them by.
    ///
    /// A change of each entry by a share e moves a simple eigenvalue by at most `e |y|'|A||x| / |y'x|` with its eigenvectors `x` and `y`, whatever the
    /// units of the states; only eigenvalues near the boundary are examined. One that is nearer than this, or than the iteration that computes
    /// eigenvalues moves it, `e norm(A) norm(y) norm(x) / |y'x|`, is corrected in 32 digits if there are at most 32 states, and its movement is then that across
    /// the boundary: `e` times the sum of the sizes of the parts of `y_i A_ij x_j / y'x` that point across. Rounding the stiffnesses of an oscillator
    /// does not damp it.
    pub(crate) fn eigenvalues_on_boundary(&self, boundary: Boundary) -> Vec<C64> {
        let distance = |l: C64| boundary.excess(l).abs();
        let near = |l: &C64| distance(*l) <= BOUNDARY_SUSPECT * self.size.max(l.norm());
        let nearby: Vec<(C64, Movement)> =
            self.modes().into_iter().filter(near).map(|l| (l, self.movements(l, boundary))).collect();
        let is_doubtful = |(l, moved): &&(C64, Movement)| {
            distance(*l) > 0.0 && distance(*l) <= moved.by_entries.max(moved.by_norm)
        };
        let of = |(l, moved): &(C64, Movement)| DoubtfulMode { eigenvalue: *l, across: moved.across };
        let doubtful: Vec<DoubtfulMode> = nearby.iter().filter(is_doubtful).map(of).collect();
        let corrected = corrected_modes(&self.balanced, &self.form.eigenvalues(), &doubtful);
        let is_on_boundary =
            |(l, moved): &&(C64, Movement)| match corrected.iter().find(|(mode, _)| mode == l) {
                Some((_, exact)) => distance(*exact) <= moved.across,
                None => distance(*l) <= moved.by_entries,
            };
        nearby.iter().filter(is_on_boundary).map(|(l, _)| *l).collect()
    }

    /// By how much rounding the entries of `A` may move an eigenvalue.
    pub(crate) fn rounding_error(&self, mode: C64) -> f64 {
        self.movements(mode, Boundary::ImaginaryAxis).by_entries
    }

    /// By how much rounding may move an eigenvalue.
    fn movements(&self, mode: C64, boundary: Boundary) -> Movement {
        let n = self.balanced.nrows();
        if let Some(moved) = self.own_movement(mode) {
            return moved;
        }
        let (y, x) = (self.left_vector(mode), self.right_vector(mode));
        let product = y.iter().zip(&x).map(|(a, b)| a * b).sum::<C64>();
        let overlap = product.norm();
        let outward = boundary.outward_direction(mode).conj() * overlap / product;
        let (mut total, mut across) = (0.0, 0.0);
        for j in 0..n {
            let column = || self.balanced.column(j).iter().zip(&y);
            total += column().map(|(a, y)| a.abs() * y.norm()).sum::<f64>() * x[j].norm();
            across += column().map(|(a, y)| (outward * y * x[j]).re.abs() * a.abs()).sum::<f64>();
        }
        let length = |v: &[C64]| v.iter().map(|e| e.norm_sqr()).sum::<f64>().sqrt();
        let unit = EIGENVALUE_ERROR * n as f64 * EPS / overlap.max(f64::MIN_POSITIVE);
        let by_entries = unit * total;
        // To first order only: beside another eigenvalue, an eigenvalue may turn before it moves.
        let others = self.form.eigenvalues().into_iter().map(|other| (other - mode).norm());
        let apart = others.filter(|&distance| distance > 0.0).fold(f64::INFINITY, f64::min);
        let is_apart = by_entries <= FIRST_ORDER * apart && mode.im != 0.0;
        let across = if is_apart { unit * across } else { by_entries };
        Movement { by_entries, across, by_norm: unit * self.size * length(&y) * length(&x) }
    }

    /// The same of an eigenvalue that is a diagonal entry which no other entry moves; `None` for the others.
    fn own_movement(&self, mode: C64) -> Option<Movement> {
        let own: Vec<usize> =
            (0..self.balanced.nrows()).filter(|&i| C64::new(self.balanced[(i, i)], 0.0) == mode).collect();
        // A double eigenvalue may be a defective one, which rounding splits.
        let [state] = own[..] else { return None };
        let moved = EPS * mode.norm();
        let movement = Movement { by_entries: moved, across: moved, by_norm: moved };
        Structure::of(&self.balanced).is_alone(state).then_some(movement)
    }

    /// `v` with `v'B = mode v'` for the balanced matrix, its largest entry about 1.
    fn left_vector(&self, mode: C64) -> Vec<C64> {
        let n = self.form.T.nrows();
        let triangle = Triangle::of(&self.form.T, mode, EPS * self.size);
        let y = triangle.solve_left(vec![C64::new(1.0, 0.0); n]);
        self.transform_vector(&triangle.solve_left(triangle.combine_row(&y)))
    }

    /// `v` with `B v = mode v` for the balanced matrix, its largest entry about 1.
    fn right_vector(&self, mode: C64) -> Vec<C64> {
        let n = self.form.T.nrows();
        let triangle = Triangle::of(&self.form.T, mode, EPS * self.size);
        let x = triangle.solve_right(vec![C64::new(1.0, 0.0); n]);
        self.transform_vector(&triangle.solve_right(x))
    }

    /// `U y`
    fn transform_vector(&self, y: &[C64]) -> Vec<C64> {
        let mut out = vec![C64::default(); y.len()];
        for (k, factor) in y.iter().enumerate() {
            out.iter_mut().zip(self.form.U.column(k)).for_each(|(o, &u)| *o += factor * u);
        }
        out
    }
}

/// Returns how `M` acts on a mode with the eigenvector `inner` of the balanced matrix, whose entries are to be multiplied by `scale`.
fn acts_on(M: &Mat, mode: C64, inner: &[C64], scale: &[f64]) -> Reach {
    let v: Vec<C64> = inner.iter().zip(scale).map(|(e, d)| e * d).collect();
    let length = v.iter().map(|e| e.norm_sqr()).sum::<f64>().sqrt();
    let each = VECTOR_NOISE * v.len() as f64;
    let (re, im): (Vec<f64>, Vec<f64>) = v.iter().map(|e| (e.re, e.im)).unzip();
    let moduli: Vec<f64> = v.iter().map(|e| e.norm()).collect();
    let unknown: Vec<f64> = scale.iter().map(|d| each * d).collect();
    let absolute = |weights: &[f64], column: &[f64]| -> f64 {
        weights.iter().zip(column).map(|(w, m)| w * m.abs()).sum()
    };
    let (mut sum, mut entrywise) = (0.0, 0.0_f64);
    for j in 0..M.ncols() {
        let column = M.column(j);
        let product = dot(&re, column).hypot(dot(&im, column));
        let noise = absolute(&unknown, column);
        sum += product * product;
        if product > noise {
            entrywise = entrywise.max((product - noise) / absolute(&moduli, column));
        }
    }
    let normwise = sum.sqrt() / (length * M.norm_fro()).max(f64::MIN_POSITIVE);
    Reach { mode, normwise, entrywise }
}

/// `T - mode I` times the column operations that make it upper triangular.
struct Triangle {
    /// Column by column, the upper entries.
    columns: Vec<Vec<C64>>,
    /// For each column k but the first: whether it changed places with column k-1, then the factor of it that was added to
    /// that column.
    steps: Vec<(bool, C64)>,
}

impl Triangle {
    fn of(T: &Mat, mode: C64, smallest: f64) -> Self {
        let n = T.nrows();
        let column = |j: usize| -> Vec<C64> {
            let entry = |i: usize| C64::new(T[(i, j)], 0.0) - if i == j { mode } else { C64::default() };
            (0..n.min(j + 2)).map(entry).collect()
        };
        let mut columns: Vec<Vec<C64>> = (0..n).map(column).collect();
        let mut steps = vec![(false, C64::default()); n];
        for k in (1..n).rev() {
            let (left, right) = columns.split_at_mut(k);
            let (left, right) = (&mut left[k - 1], &mut right[0]);
            let below = left.pop().unwrap_or_default();
            let swap = below.norm() > right[k].norm();
            if swap {
                left.push(below);
                std::mem::swap(left, right);
                let last = left.pop().unwrap_or_default();
                steps[k] = (true, -last / right[k]);
            } else if below != C64::default() {
                steps[k] = (false, -below / right[k]);
            }
            let factor = steps[k].1;
            left.iter_mut().zip(&*right).for_each(|(l, &r)| *l += factor * r);
        }
        for (k, column) in columns.iter_mut().enumerate() {
            if column[k].norm() < smallest {
                column[k] = C64::new(smallest, 0.0);
            }
        }
        Self { columns, steps }
    }

    /// `y` with `y' (T - mode I) = b'` for the right-hand side `b` after [`Triangle::combine_row`], its largest entry 1.
    fn solve_left(&self, b: Vec<C64>) -> Vec<C64> {
        let mut y: Vec<C64> = Vec::with_capacity(b.len());
        let mut scale = 1.0;
        for (column, right) in self.columns.iter().zip(b) {
            let known: C64 = y.iter().zip(column).map(|(a, b)| a * b).sum();
            let entry = (right * scale - known) / column[y.len()];
            y.push(entry);
            if entry.norm() > GROWN_ENTRIES {
                y.iter_mut().for_each(|e| *e /= GROWN_ENTRIES);
                scale /= GROWN_ENTRIES;
            }
        }
        normalise(&mut y);
        y
    }

    /// `x` with `(T - mode I) x = b`, its largest entry 1.
    fn solve_right(&self, mut b: Vec<C64>) -> Vec<C64> {
        for k in (0..b.len()).rev() {
            b[k] /= self.columns[k][k];
            if b[k].norm() > GROWN_ENTRIES {
                b.iter_mut().for_each(|e| *e /= GROWN_ENTRIES);
            }
            let x = b[k];
            b[..k].iter_mut().zip(&self.columns[k]).for_each(|(b, &entry)| *b -= entry * x);
        }
        for k in 1..b.len() {
            let (swap, factor) = self.steps[k];
            let added = factor * b[k - 1];
            b[k] += added;
            if swap {
                b.swap(k - 1, k);
            }
        }
        normalise(&mut b);
        b
    }

    /// The column operations applied to a row.
    fn combine_row(&self, b: &[C64]) -> Vec<C64> {
        let mut b = b.to_vec();
        for k in (1..b.len()).rev() {
            let (swap, factor) = self.steps[k];
            if swap {
                b.swap(k - 1, k);
            }
            let last = b[k];
            b[k - 1] += factor * last;
        }
        b
    }
}

fn normalise(v: &mut [C64]) {
    let largest = v.iter().map(|e| e.norm()).fold(f64::MIN_POSITIVE, f64::max);
    v.iter_mut().for_each(|e| *e /= largest);
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn eigenvectors_satisfy_their_definition() {
        let entry = |i: usize, j: usize| ((7 * i + 3 * j) % 11) as f64 - 5.0;
        let A = Mat::from_fn(9, 9, |i, j| entry(i, j) + if i == j { i as f64 } else { 0.0 });
        let spectrum = Spectrum::of(&A).unwrap();
        for mode in spectrum.modes() {
            let (v, x) = (spectrum.left_vector(mode), spectrum.right_vector(mode));
            for j in 0..9 {
                let left: C64 = v.iter().zip(spectrum.balanced.column(j)).map(|(e, &a)| e * a).sum();
                let right: C64 = x.iter().enumerate().map(|(k, e)| e * spectrum.balanced[(j, k)]).sum();
                assert!((left - mode * v[j]).norm() < 1e-12, "left {mode} {j}");
                assert!((right - mode * x[j]).norm() < 1e-12, "right {mode} {j}");
            }
        }
    }

    #[test]
    fn a_chain_of_integrators_has_finite_vectors() {
        for n in [1, 2, 30] {
            let A = Mat::from_fn(n, n, |i, j| if j == i + 1 { 1.0 } else { 0.0 });
            let spectrum = Spectrum::of(&A).unwrap();
            let mut last = Mat::zeros(n, 1);
            last[(n - 1, 0)] = 1.0;
            let reach = spectrum.reachability(&last, C64::default());
            assert!((reach.normwise - 1.0).abs() < 1e-12, "{n}: {}", reach.normwise);
            assert!(
                spectrum.rounding_error(C64::default()) >= 0.0
                    && spectrum.eigenvalues_on_boundary(Boundary::ImaginaryAxis).len() <= n
            );
        }
    }

    #[test]
    fn a_mode_out_of_reach_is_found_in_any_units() {
        let A = Mat::from_rows(&[&[2.0, 0.0, 0.0], &[1e9, -1.0, 3e-7], &[4e8, 5.0, -2.0]]);
        let spectrum = Spectrum::of(&A).unwrap();
        let reach = spectrum.reachability(&Mat::col(&[0.0, 1.0, 1e6]), C64::new(2.0, 0.0));
        assert!(reach.entrywise < 1e-15, "{}", reach.entrywise);
        assert!(spectrum.reachability(&Mat::col(&[1e-3, 1.0, 1e6]), C64::new(2.0, 0.0)).entrywise > 0.99);
    }

    #[test]
    fn the_boundary_is_judged_mode_by_mode() {
        let found = |A: &Mat| Spectrum::of(A).unwrap().eigenvalues_on_boundary(Boundary::ImaginaryAxis).pop();
        // An integrator in coordinates that hide it.
        assert!(found(&Mat::from_rows(&[&[2.0, 2.0], &[-3.0, -3.0]])).is_some());
        // Slow, and certain to be stable in spite of a fast neighbour.
        assert!(found(&Mat::from_rows(&[&[-1e12, 3.0], &[0.0, -1e-6]])).is_none());
        // A double integrator that rounding splits.
        let T = Mat::from_rows(&[&[1.0, 2.0, 0.3], &[0.7, -1.0, 0.2], &[0.1, 0.4, 1.1]]);
        let N = Mat::from_rows(&[&[0.0, 1.0, 0.0], &[0.0, 0.0, 0.0], &[0.0, 0.0, -2.0]]);
        let A = &T * &N * crate::dense::inverse(&T).unwrap();
        assert!(found(&A).is_some(), "{:?}", crate::schur::eigenvalues(&A));
    }
}
