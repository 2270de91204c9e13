//! A sparse real matrix, stored column by column.

use crate::error::{Error, check_finite};
use crate::mat::Mat;
use crate::tolerance::SYMMETRY;

/// An entry of a sparse matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entry {
    /// Row, from 0.
    pub row: usize,
    /// Column, from 0.
    pub col: usize,
    /// Value.
    pub value: f64,
}

/// An entry of a sparse vector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VectorEntry {
    /// Place in the vector, from 0.
    pub index: usize,
    /// Value.
    pub value: f64,
}

impl VectorEntry {
    /// Returns the entry with a value at a place.
    pub const fn new(index: usize, value: f64) -> Self {
        Self { index, value }
    }
}

/// A sparse real matrix: the rows and values of each column, rows rising.
///
/// Places are stored in 32 bits, which halves what a large matrix takes; a matrix may have 2^32 - 1 rows and columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Sparse {
    rows: usize,
    cols: usize,
    starts: Vec<u32>,
    indices: Vec<u32>,
    values: Vec<f64>,
}

impl Sparse {
    /// Returns the matrix with the given entries; entries of one place add up in their order.
    ///
    /// # Errors
    /// [`Error::Shape`] if an entry lies outside, or if the matrix is too large for 32-bit places, [`Error::NotFinite`].
    pub fn from_entries(rows: usize, cols: usize, entries: &[Entry]) -> Result<Self, Error> {
        check_places(rows, cols, entries)?;
        let mut starts = vec![0_u32; cols + 1];
        entries.iter().for_each(|e| starts[e.col + 1] += 1);
        for j in 0..cols {
            starts[j + 1] += starts[j];
        }
        let mut next: Vec<usize> = starts.iter().map(|&s| s as usize).collect();
        let mut placed = vec![VectorEntry::new(0, 0.0); entries.len()];
        for e in entries {
            placed[next[e.col]] = VectorEntry::new(e.row, e.value);
            next[e.col] += 1;
        }
        let mut out = Self {
            rows,
            cols,
            starts: vec![0],
            indices: Vec::with_capacity(placed.len()),
            values: Vec::with_capacity(placed.len()),
        };
        for j in 0..cols {
            let column = &mut placed[starts[j] as usize..starts[j + 1] as usize];
            column.sort_by_key(|entry| entry.index);
            out.push_column(column);
        }
        Ok(out)
    }

    /// Appends a column whose rows rise and may repeat.
    fn push_column(&mut self, column: &[VectorEntry]) {
        let first = self.indices.len();
        for &VectorEntry { index, value } in column {
            let row = index as u32;
            match self.indices.len() > first && self.indices.last() == Some(&row) {
                true => self.values.last_mut().into_iter().for_each(|last| *last += value),
                false => {
                    self.indices.push(row);
                    self.values.push(value);
                }
            }
        }
        self.starts.push(self.indices.len() as u32);
    }

    /// Returns the sparse form of a dense matrix, without its zeros.
    pub fn from_dense(A: &Mat) -> Self {
        let mut out =
            Self { rows: A.nrows(), cols: A.ncols(), starts: vec![0], indices: vec![], values: vec![] };
        for j in 0..A.ncols() {
            let column: Vec<VectorEntry> = A
                .column(j)
                .iter()
                .enumerate()
                .filter(|(_, v)| **v != 0.0)
                .map(|(i, &value)| VectorEntry::new(i, value))
                .collect();
            out.push_column(&column);
        }
        out
    }

    /// Returns the dense form.
    pub fn to_dense(&self) -> Mat {
        let mut out = Mat::zeros(self.rows, self.cols);
        self.entries().for_each(|e| out[(e.row, e.col)] = e.value);
        out
    }

    /// Returns the number of rows.
    pub fn nrows(&self) -> usize {
        self.rows
    }

    /// Returns the number of columns.
    pub fn ncols(&self) -> usize {
        self.cols
    }

    /// Returns (rows, columns).
    pub fn shape(&self) -> (usize, usize) {
        (self.rows, self.cols)
    }

    /// Returns the number of stored entries.
    pub fn entry_count(&self) -> usize {
        self.values.len()
    }

    /// Returns the entries, column by column.
    pub fn entries(&self) -> impl Iterator<Item = Entry> + '_ {
        (0..self.cols)
            .flat_map(move |col| self.column(col).map(move |(row, value)| Entry { row, col, value }))
    }

    /// Returns the row and value of each entry of column `j`.
    pub fn column(&self, j: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.starts[j] as usize..self.starts[j + 1] as usize;
        self.indices[range.clone()].iter().zip(&self.values[range]).map(|(&i, &v)| (i as usize, v))
    }

    /// Returns the entry (i, j); 0 if it is not stored.
    pub fn at(&self, i: usize, j: usize) -> f64 {
        let range = self.starts[j] as usize..self.starts[j + 1] as usize;
        let place = self.indices[range.clone()].binary_search(&(i as u32));
        place.map_or(0.0, |k| self.values[range.start + k])
    }

    /// Returns the diagonal.
    pub fn diagonal(&self) -> Vec<f64> {
        (0..self.rows.min(self.cols)).map(|i| self.at(i, i)).collect()
    }

    /// Returns the transpose.
    pub fn t(&self) -> Self {
        let mut starts = vec![0_u32; self.rows + 1];
        self.indices.iter().for_each(|&i| starts[i as usize + 1] += 1);
        for i in 0..self.rows {
            starts[i + 1] += starts[i];
        }
        let mut next: Vec<usize> = starts.iter().map(|&s| s as usize).collect();
        let (mut indices, mut values) = (vec![0_u32; self.values.len()], vec![0.0; self.values.len()]);
        for e in self.entries() {
            indices[next[e.row]] = e.col as u32;
            values[next[e.row]] = e.value;
            next[e.row] += 1;
        }
        Self { rows: self.cols, cols: self.rows, starts, indices, values }
    }

    /// Returns the product with a dense matrix.
    pub fn times(&self, X: &Mat) -> Mat {
        let mut out = Mat::zeros(self.rows, X.ncols());
        for k in 0..X.ncols() {
            let (x, y) = (X.column(k), out.column_mut(k));
            for (j, &factor) in x.iter().enumerate().filter(|(_, factor)| **factor != 0.0) {
                self.column(j).for_each(|(i, value)| y[i] += value * factor);
            }
        }
        out
    }

    /// Returns the rows and columns with the given indices, which rise; a square matrix.
    pub fn select(&self, kept: &[usize]) -> Self {
        let mut place = vec![u32::MAX; self.rows];
        kept.iter().enumerate().for_each(|(k, &i)| place[i] = k as u32);
        let mut out =
            Self { rows: kept.len(), cols: kept.len(), starts: vec![0], indices: vec![], values: vec![] };
        for &j in kept {
            for (i, value) in self.column(j).filter(|(i, _)| place[*i] != u32::MAX) {
                out.indices.push(place[i]);
                out.values.push(value);
            }
            out.starts.push(out.indices.len() as u32);
        }
        out
    }

    /// Returns the matrix with each entry (i, j) changed to `change(i, j, value)`; entries that are not stored stay zero.
    pub fn map(&self, change: impl Fn(usize, usize, f64) -> f64) -> Self {
        let values = self.entries().map(|e| change(e.row, e.col, e.value)).collect();
        Self { values, ..self.clone() }
    }

    /// Returns the matrix with more entries added.
    ///
    /// # Errors
    /// As for [`Sparse::from_entries`].
    pub fn plus(&self, more: &[Entry]) -> Result<Self, Error> {
        let all: Vec<Entry> = self.entries().chain(more.iter().copied()).collect();
        Self::from_entries(self.rows, self.cols, &all)
    }

    /// Returns `(A + A') / 2`.
    ///
    /// # Errors
    /// [`Error::NotSquare`].
    pub fn symmetric_part(&self) -> Result<Self, Error> {
        if self.rows != self.cols {
            return Err(Error::NotSquare { what: "A", rows: self.rows, cols: self.cols });
        }
        let other = self.t();
        if other == *self {
            return Ok(other);
        }
        let half = |e: Entry| Entry { value: 0.5 * e.value, ..e };
        let all: Vec<Entry> = self.entries().chain(other.entries()).map(half).collect();
        Self::from_entries(self.rows, self.cols, &all)
    }

    /// Returns the largest modulus of an entry.
    pub fn norm_max(&self) -> f64 {
        self.values.iter().fold(0.0, |largest, v| v.abs().max(largest))
    }

    /// Returns the square root of the sum of the squares.
    pub fn norm_fro(&self) -> f64 {
        let largest = self.norm_max();
        if largest == 0.0 {
            return 0.0;
        }
        largest * self.values.iter().map(|v| (v / largest).powi(2)).sum::<f64>().sqrt()
    }

    /// Returns the largest difference of an entry from the one across the diagonal, of a square matrix.
    pub fn asymmetry(&self) -> f64 {
        let other = self.t();
        let here = self.entries().map(|e| (e.value - other.at(e.row, e.col)).abs());
        let there = other.entries().map(|e| (e.value - self.at(e.row, e.col)).abs());
        here.chain(there).fold(0.0, f64::max)
    }

    /// Refuses a matrix whose halves differ by more than rounding.
    ///
    /// # Errors
    /// [`Error::NotSquare`], [`Error::NotSymmetric`], [`Error::NotFinite`].
    pub(crate) fn check_symmetric(&self, what: &'static str) -> Result<(), Error> {
        let (rows, cols) = self.shape();
        if rows != cols {
            return Err(Error::NotSquare { what, rows, cols });
        }
        if let Some(e) = self.entries().find(|e| !e.value.is_finite()) {
            return check_finite(what, &Mat::row(&[e.value]));
        }
        let (skew, size) = (self.asymmetry(), self.norm_max());
        match skew > SYMMETRY * size {
            true => Err(Error::NotSymmetric { what, relative: skew / size }),
            false => Ok(()),
        }
    }

    /// A matrix with a place for each entry and for the one across the diagonal, for its pattern alone.
    pub(crate) fn with_symmetric_pattern(&self) -> Result<Self, Error> {
        let other = self.t();
        if other.starts == self.starts && other.indices == self.indices {
            return Ok(other);
        }
        let more: Vec<Entry> = other.entries().map(|e| Entry { value: 0.0, ..e }).collect();
        self.plus(&more)
    }

    /// The start of each column, the row of each entry and its value.
    pub(crate) fn parts(&self) -> (&[u32], &[u32], &[f64]) {
        (&self.starts, &self.indices, &self.values)
    }
}

fn check_places(rows: usize, cols: usize, entries: &[Entry]) -> Result<(), Error> {
    let most = u32::MAX as usize - 1;
    let shape = |rows, cols| Error::Shape {
        what: "sparse matrix",
        rows,
        cols,
        needed_rows: rows.min(most),
        needed_cols: cols.min(most),
    };
    if rows > most || cols > most || entries.len() > most {
        return Err(shape(rows, cols));
    }
    if let Some(e) = entries.iter().find(|e| e.row >= rows || e.col >= cols) {
        return Err(Error::Shape {
            what: "sparse matrix",
            rows: e.row + 1,
            cols: e.col + 1,
            needed_rows: rows,
            needed_cols: cols,
        });
    }
    match entries.iter().find(|e| !e.value.is_finite()) {
        Some(e) => check_finite("sparse matrix", &Mat::row(&[e.value])),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn entries_add_up_and_products_agree_with_dense_ones() {
        let entry = |row, col, value| Entry { row, col, value };
        let list =
            [entry(2, 0, 1.0), entry(0, 0, 2.0), entry(2, 0, 0.5), entry(1, 2, -3.0), entry(2, 2, 4.0)];
        let A = Sparse::from_entries(3, 3, &list).unwrap();
        let dense = A.to_dense();
        assert_eq!(A.at(2, 0), 1.5);
        assert_eq!(A.entry_count(), 4);
        assert_eq!(Sparse::from_dense(&dense), A);
        assert_eq!(A.t().to_dense(), dense.t());
        let X = Mat::from_fn(3, 2, |i, j| (i + 2 * j) as f64);
        assert_eq!(A.times(&X), &dense * &X);
        assert_eq!(A.select(&[0, 2]).to_dense(), dense.select(&[0, 2], &[0, 2]));
        assert_eq!(A.symmetric_part().unwrap().to_dense(), dense.symmetric_part());
        assert_eq!(A.asymmetry(), 3.0);
        assert!(Sparse::from_entries(2, 3, &list).is_err());
    }
}
