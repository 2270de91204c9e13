//! The factors `P A P' = L D L'` of a sparse symmetric matrix, real or complex, without pivoting, block by block.
//!
//! Each block of columns is completed and then subtracted from the blocks that it is coupled with. Blocks are dense, so nearly all
//! work is the product of matrices. Source: Rothberg and Gupta, SIAM J. Sci. Comput. 15 (1994) 1413.
//! A complex matrix is symmetric here, not Hermitian.

use std::ops::ControlFlow;

use faer::linalg::{matmul::matmul, triangular_solve};
use faer::traits::ComplexField;
use faer::{Accum, MatMut, MatRef, Par};

use super::analysis::{Analysis, Panel};
use super::matrix::Sparse;
use super::modes::{ProgressObserver, StageProgress};
use crate::error::Error;
use crate::mat::C64;
use crate::scalar::Scalar;

/// Columns that are eliminated one after the other; wider blocks are halved.
const NARROW: usize = 8;

/// A number that sparse factors are made of.
pub(super) trait Number: Scalar + ComplexField {
    /// The product with a real number.
    fn scale_by(self, by: f64) -> Self;
    /// 1 / x
    fn inverse(self) -> Self;
    /// The real part.
    fn real_part(self) -> f64;
}

impl Number for f64 {
    fn scale_by(self, by: f64) -> Self {
        self * by
    }
    fn inverse(self) -> Self {
        1.0 / self
    }
    fn real_part(self) -> f64 {
        self
    }
}

impl Number for C64 {
    fn scale_by(self, by: f64) -> Self {
        self * by
    }
    fn inverse(self) -> Self {
        1.0 / self
    }
    fn real_part(self) -> f64 {
        self.re
    }
}

/// A matrix and the factor that it is multiplied with; what is factorised is a sum of such terms.
pub(super) struct Term<'a, T> {
    pub(super) factor: T,
    pub(super) matrix: &'a Sparse,
}

/// The result that is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FactorRequest {
    /// The factors of a positive definite matrix.
    PositiveFactors,
    /// The factors.
    Factors,
    /// `D` alone, which takes far less memory.
    Pivots,
}

/// The factors: for each block the columns of `L`, with `D` in place of the diagonal.
#[derive(Debug)]
pub(super) struct Factors<T> {
    panels: Vec<Vec<T>>,
    /// `D`, in the order of elimination.
    pub(super) pivots: Vec<T>,
}

/// Factorises the sum of the terms, whose patterns lie within the analysed one. `watch` is told the percentage that is done.
///
/// # Errors
/// [`Error::NotPositiveDefinite`], [`Error::Singular`] for a pivot that is zero, [`Error::TooLarge`], or [`Error::Cancelled`].
pub(super) fn factorise<T: Number>(
    analysis: &Analysis,
    terms: &[Term<T>],
    wanted: FactorRequest,
    stage: &'static str,
    watch: &mut ProgressObserver,
) -> Result<Factors<T>, Error> {
    let (n, total) = (analysis.size(), analysis.operations());
    let mut run = Elimination {
        analysis,
        panels: (0..analysis.blocks()).map(|_| Vec::new()).collect(),
        local: vec![u32::MAX; n],
        product: Vec::new(),
        scaled: Vec::new(),
    };
    let (mut pivots, mut done, mut told) = (Vec::with_capacity(n), 0.0, 0);
    for s in 0..analysis.blocks() {
        let Panel { rows, cols } = analysis.panel(s);
        let mut panel = run.assemble_panel(s, terms)?;
        eliminate(&mut panel, rows, 0..cols, &mut run.scaled);
        let found = (0..cols).map(|j| panel[j * rows + j]);
        pivots.extend(found);
        check(&pivots[pivots.len() - cols..], wanted)?;
        run.update(s, &panel)?;
        if wanted != FactorRequest::Pivots {
            run.panels[s] = panel;
        }
        done += analysis.panel(s).operations();
        let percent = (100.0 * done / total) as usize;
        if percent > told {
            told = percent;
            if watch(StageProgress { stage, done: percent.min(99), of: 100 }) == ControlFlow::Break(()) {
                return Err(Error::Cancelled { what: stage });
            }
        }
    }
    Ok(Factors { panels: run.panels, pivots })
}

fn check<T: Number>(pivots: &[T], wanted: FactorRequest) -> Result<(), Error> {
    let is_good = |pivot: &T| {
        let size = pivot.modulus();
        size > 0.0
            && size.is_finite()
            && (wanted != FactorRequest::PositiveFactors || pivot.real_part() > 0.0)
    };
    match (pivots.iter().all(is_good), wanted) {
        (true, _) => Ok(()),
        (false, FactorRequest::PositiveFactors) => {
            Err(Error::NotPositiveDefinite { what: "the sparse matrix" })
        }
        (false, _) => Err(Error::Singular { what: "a sparse matrix", rcond: 0.0 }),
    }
}

struct Elimination<'a, T> {
    analysis: &'a Analysis,
    panels: Vec<Vec<T>>,
    /// The row of the present panel that belongs to each row of the matrix; `u32::MAX` elsewhere.
    local: Vec<u32>,
    product: Vec<T>,
    scaled: Vec<T>,
}

impl<T: Number> Elimination<'_, T> {
    /// The panel of a block: what was subtracted from it, and the entries of the matrix.
    fn assemble_panel(&mut self, s: usize, terms: &[Term<T>]) -> Result<Vec<T>, Error> {
        let analysis = self.analysis;
        self.allocate(s)?;
        let mut panel = std::mem::take(&mut self.panels[s]);
        let (columns, rows) = (analysis.columns(s), analysis.panel(s).rows);
        let width = columns.len();
        let number = |(k, &row): (usize, &u32)| (row as usize, (width + k) as u32);
        analysis.rows(s).iter().enumerate().map(number).for_each(|(row, k)| self.local[row] = k);
        columns.clone().for_each(|c| self.local[c] = (c - columns.start) as u32);
        for c in columns.clone() {
            let column = &mut panel[(c - columns.start) * rows..][..rows];
            for term in terms {
                for (i, value) in term.matrix.column(analysis.order[c] as usize) {
                    let row = analysis.place[i] as usize;
                    if row >= c {
                        column[self.local[row] as usize] += term.factor.scale_by(value);
                    }
                }
            }
        }
        columns.clone().for_each(|c| self.local[c] = u32::MAX);
        analysis.rows(s).iter().for_each(|&row| self.local[row as usize] = u32::MAX);
        Ok(panel)
    }

    /// Makes room for the panel of a block, if it has none yet.
    fn allocate(&mut self, s: usize) -> Result<(), Error> {
        if self.panels[s].is_empty() {
            let entries = self.analysis.panel(s).entries();
            let too_large =
                |_| Error::TooLarge { what: "the factors of a sparse matrix", rows: self.analysis.size() };
            self.panels[s].try_reserve_exact(entries).map_err(too_large)?;
            self.panels[s].resize(entries, <T as Scalar>::ZERO);
        }
        Ok(())
    }

    /// Subtracts `L D L'` of a completed block from the blocks of its rows.
    fn update(&mut self, s: usize, panel: &[T]) -> Result<(), Error> {
        let analysis = self.analysis;
        let Panel { rows, cols } = analysis.panel(s);
        let pattern = analysis.rows(s);
        let whole = MatRef::from_column_major_slice(panel, rows, cols);
        let below = whole.subrows(cols, rows - cols);
        let mut from = 0;
        while from < pattern.len() {
            let t = analysis.block[pattern[from] as usize] as usize;
            let end = analysis.columns(t).end as u32;
            let width = pattern[from..].partition_point(|&row| row < end);
            self.allocate(t)?;
            self.scaled.clear();
            for k in from..from + width {
                let row = cols + k;
                self.scaled.extend((0..cols).map(|j| panel[j * rows + row] * panel[j * rows + j]));
            }
            self.subtract(t, below.subrows(from, pattern.len() - from), &pattern[from..], width);
            from += width;
        }
        Ok(())
    }

    /// Subtracts the product of `left` and what is scaled from the panel of block `t`, at the given rows, of which the first `width` are columns.
    fn subtract(&mut self, t: usize, left: MatRef<T>, pattern: &[u32], width: usize) {
        let rows_of_target = self.analysis.panel(t).rows;
        let places = self.places(t, pattern);
        let (height, depth) = left.shape();
        let right = MatRef::from_column_major_slice(&self.scaled[..depth * width], depth, width);
        let first = places[0];
        let target = &mut self.panels[t];
        if places[height - 1] - first == height - 1 {
            let cols = target.len() / rows_of_target;
            let whole = MatMut::from_column_major_slice_mut(target.as_mut_slice(), rows_of_target, cols);
            let part = whole.submatrix_mut(first, first, height, width);
            return matmul(part, Accum::Add, left, right, -<T as Scalar>::ONE, Par::Seq);
        }
        self.product.clear();
        self.product.resize(height * width, <T as Scalar>::ZERO);
        let product = MatMut::from_column_major_slice_mut(&mut self.product, height, width);
        matmul(product, Accum::Replace, left, right, <T as Scalar>::ONE, Par::Seq);
        for (j, column) in self.product.chunks_exact(height).enumerate() {
            let target = &mut target[places[j] * rows_of_target..][..rows_of_target];
            places[j..].iter().zip(&column[j..]).for_each(|(&row, &value)| target[row] -= value);
        }
    }

    /// The rows of a block's panel that belong to rows of the matrix, which rise.
    fn places(&self, t: usize, pattern: &[u32]) -> Vec<usize> {
        let (columns, rows) = (self.analysis.columns(t), self.analysis.rows(t));
        let mut next = 0;
        let place = |&row: &u32| {
            if (row as usize) < columns.end {
                return row as usize - columns.start;
            }
            while rows[next] < row {
                next += 1;
            }
            columns.len() + next
        };
        pattern.iter().map(place).collect()
    }
}

/// Eliminates some columns of a panel: halves, of which the first is subtracted from the second by a product of matrices.
fn eliminate<T: Number>(panel: &mut [T], rows: usize, columns: std::ops::Range<usize>, scaled: &mut Vec<T>) {
    if columns.len() <= NARROW {
        return eliminate_narrow(panel, rows, columns);
    }
    let middle = columns.start + (columns.len() / 2).next_multiple_of(NARROW).min(columns.len() - 1);
    eliminate(panel, rows, columns.start..middle, scaled);
    let (first, second) = panel.split_at_mut(middle * rows);
    scaled.clear();
    for row in middle..columns.end {
        scaled.extend((columns.start..middle).map(|j| first[j * rows + row] * first[j * rows + j]));
    }
    let (depth, width) = (middle - columns.start, columns.end - middle);
    let right = MatRef::from_column_major_slice(scaled.as_slice(), depth, width);
    let left = MatRef::from_column_major_slice(&first[..], rows, middle);
    let left = left.submatrix(middle, columns.start, rows - middle, depth);
    let target = MatMut::from_column_major_slice_mut(&mut second[..width * rows], rows, width);
    let target = target.submatrix_mut(middle, 0, rows - middle, width);
    matmul(target, Accum::Add, left, right, -<T as Scalar>::ONE, Par::Seq);
    eliminate(panel, rows, middle..columns.end, scaled);
}

fn eliminate_narrow<T: Number>(panel: &mut [T], rows: usize, columns: std::ops::Range<usize>) {
    for j in columns.clone() {
        let (before, here) = panel.split_at_mut(j * rows);
        let here = &mut here[j..rows];
        for k in columns.start..j {
            let other = &before[k * rows..][..rows];
            let factor = other[j] * other[k];
            here.iter_mut().zip(&other[j..]).for_each(|(x, &y)| *x -= factor * y);
        }
        let factor = here[0].inverse();
        here[1..].iter_mut().for_each(|x| *x *= factor);
    }
}

/// Right-hand sides in the order of elimination, column by column.
struct Sides<'a, T> {
    values: &'a mut [T],
    count: usize,
}

impl<T: Number> Factors<T> {
    /// Replaces the right-hand sides, n x `count` column by column, by the solutions.
    pub(super) fn solve(&self, analysis: &Analysis, sides: &mut [T], count: usize) {
        let n = analysis.size();
        let mut x = vec![<T as Scalar>::ZERO; sides.len()];
        for (x, side) in x.chunks_exact_mut(n).zip(sides.chunks_exact(n)) {
            x.iter_mut().zip(&analysis.order).for_each(|(x, &v)| *x = side[v as usize]);
        }
        let mut buffer = Vec::new();
        let mut sides_in_order = Sides { values: &mut x, count };
        (0..analysis.blocks()).for_each(|s| self.forward(analysis, s, &mut sides_in_order, &mut buffer));
        for x in sides_in_order.values.chunks_exact_mut(n) {
            x.iter_mut().zip(&self.pivots).for_each(|(x, pivot)| *x *= pivot.inverse());
        }
        let blocks = (0..analysis.blocks()).rev();
        blocks.for_each(|s| self.substitute_backward(analysis, s, &mut sides_in_order, &mut buffer));
        for (x, side) in x.chunks_exact(n).zip(sides.chunks_exact_mut(n)) {
            x.iter().zip(&analysis.order).for_each(|(&x, &v)| side[v as usize] = x);
        }
    }

    /// The part of `L` on the diagonal of a block, and the part below.
    fn parts(&self, analysis: &Analysis, s: usize) -> (MatRef<'_, T>, MatRef<'_, T>) {
        let Panel { rows, cols } = analysis.panel(s);
        MatRef::from_column_major_slice(self.panels[s].as_slice(), rows, cols).split_at_row(cols)
    }

    fn forward(&self, analysis: &Analysis, s: usize, sides: &mut Sides<T>, buffer: &mut Vec<T>) {
        let (x, count) = (&mut *sides.values, sides.count);
        let (n, columns, rows) = (analysis.size(), analysis.columns(s), analysis.rows(s));
        let (top, below) = self.parts(analysis, s);
        let whole = MatMut::from_column_major_slice_mut(&mut *x, n, count);
        let mut part = whole.subrows_mut(columns.start, columns.len());
        triangular_solve::solve_unit_lower_triangular_in_place(top, part.as_mut(), Par::Seq);
        if rows.is_empty() {
            return;
        }
        buffer.clear();
        buffer.resize(rows.len() * count, <T as Scalar>::ZERO);
        let product = MatMut::from_column_major_slice_mut(buffer.as_mut_slice(), rows.len(), count);
        matmul(product, Accum::Replace, below, part.as_ref(), <T as Scalar>::ONE, Par::Seq);
        for (x, product) in x.chunks_exact_mut(n).zip(buffer.chunks_exact(rows.len())) {
            rows.iter().zip(product).for_each(|(&row, &value)| x[row as usize] -= value);
        }
    }

    fn substitute_backward(&self, analysis: &Analysis, s: usize, sides: &mut Sides<T>, buffer: &mut Vec<T>) {
        let (x, count) = (&mut *sides.values, sides.count);
        let (n, columns, rows) = (analysis.size(), analysis.columns(s), analysis.rows(s));
        let (top, below) = self.parts(analysis, s);
        buffer.clear();
        for x in x.chunks_exact(n) {
            buffer.extend(rows.iter().map(|&row| x[row as usize]));
        }
        let whole = MatMut::from_column_major_slice_mut(x, n, count);
        let mut part = whole.subrows_mut(columns.start, columns.len());
        if !rows.is_empty() {
            let known = MatRef::from_column_major_slice(buffer.as_slice(), rows.len(), count);
            let target = part.as_mut();
            matmul(target, Accum::Add, below.transpose(), known, -<T as Scalar>::ONE, Par::Seq);
        }
        triangular_solve::solve_unit_upper_triangular_in_place(top.transpose(), part, Par::Seq);
    }
}
