//! Signals as one array: time along its rows, a named column for each signal.

use std::marker::PhantomData;

use ndarray::{Array2, ArrayView1, ArrayView2, ShapeBuilder as _, s};

use crate::clock::stack_columns;
use crate::tolerance::FIRST_ROOM;

/// Names the columns of an array of [`Signals`]: an enum whose variants stand in the order of the columns.
pub trait ColumnName: Copy {
    /// Returns the column's place, from 0.
    fn index(self) -> usize;
}

/// Samples of several signals on one clock, time x signal, each column contiguous in memory and named by `C`.
///
/// An array may end before the last of its names; the columns that it lacks have no samples.
#[derive(Debug, Clone)]
pub struct Signals<C> {
    /// The samples, and below them room for more.
    values: Array2<f64>,
    samples: usize,
    names: PhantomData<C>,
}

impl<C> Default for Signals<C> {
    fn default() -> Self {
        Self { values: Array2::zeros((0, 0)), samples: 0, names: PhantomData }
    }
}

impl<C> PartialEq for Signals<C> {
    /// Compares the samples.
    fn eq(&self, other: &Self) -> bool {
        self.values.slice(s![..self.samples, ..]) == other.values.slice(s![..other.samples, ..])
    }
}

impl<C: ColumnName> Signals<C> {
    /// Returns signals that are 0 at every sample.
    pub fn zeros(samples: usize, columns: usize) -> Self {
        Self { values: Array2::zeros((samples, columns).f()), samples, names: PhantomData }
    }

    /// Returns columns without samples, with room for a number of them.
    pub fn with_room(samples: usize, columns: usize) -> Self {
        Self { samples: 0, ..Self::zeros(samples, columns) }
    }

    /// Returns the array of columns in the order of their names; a column that is shorter than others ends in NaN.
    pub fn stack<'a>(columns: impl IntoIterator<Item = &'a [f64]>) -> Self {
        let values = stack_columns(columns.into_iter().map(ArrayView1::from));
        Self { samples: values.nrows(), values, names: PhantomData }
    }

    /// Returns all samples, time x column.
    pub fn view(&self) -> ArrayView2<'_, f64> {
        self.values.slice(s![..self.samples, ..])
    }

    /// Returns whether the array has a column.
    pub fn has(&self, column: C) -> bool {
        column.index() < self.values.ncols()
    }

    /// Returns the samples of a column; none if there is no such column.
    pub fn column(&self, column: C) -> &[f64] {
        if !self.has(column) {
            return &[];
        }
        let whole = self.values.column(column.index()).to_slice();
        whole.map(|whole| &whole[..self.samples]).unwrap_or_default()
    }

    /// Returns the samples of a column, to be changed; none if there is no such column.
    pub fn column_mut(&mut self, column: C) -> &mut [f64] {
        if !self.has(column) {
            return &mut [];
        }
        let samples = self.samples;
        let whole = self.values.column_mut(column.index()).into_slice();
        whole.map(|whole| &mut whole[..samples]).unwrap_or_default()
    }

    /// Returns the number of samples.
    pub fn len(&self) -> usize {
        self.samples
    }

    /// Returns whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.samples == 0
    }

    /// Adds a sample of every column, in the order of their names; the columns for which no value is given get 0.
    pub fn push(&mut self, row: impl IntoIterator<Item = f64>) {
        if self.samples == self.values.nrows() {
            self.make_room();
        }
        let mut places = self.values.row_mut(self.samples);
        places.fill(0.0);
        places.iter_mut().zip(row).for_each(|(place, value)| *place = value);
        self.samples += 1;
    }

    /// Sets the newest sample of a column. Nothing happens if there is no such column or no sample.
    pub fn set_newest(&mut self, column: C, value: f64) {
        if let Some(newest) = self.column_mut(column).last_mut() {
            *newest = value;
        }
    }

    /// Removes the samples after a number of them.
    pub fn truncate(&mut self, samples: usize) {
        self.samples = self.samples.min(samples);
    }

    /// Returns the signals from a sample on; none from beyond the last.
    #[must_use]
    pub fn from_sample(&self, first: usize) -> Self {
        let later = self.values.slice(s![first.min(self.samples)..self.samples, ..]);
        let mut values = Array2::zeros(later.raw_dim().f());
        values.assign(&later);
        Self { samples: values.nrows(), values, names: PhantomData }
    }

    /// Doubles the room, so that a run of n samples copies each of them about once.
    fn make_room(&mut self) {
        let rows = (2 * self.samples).max(FIRST_ROOM);
        let mut values = Array2::zeros((rows, self.values.ncols()).f());
        values.slice_mut(s![..self.samples, ..]).assign(&self.view());
        self.values = values;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Clone, Copy)]
    enum NamedColumn {
        First,
        Second,
        Third,
    }

    impl ColumnName for NamedColumn {
        fn index(self) -> usize {
            self as usize
        }
    }

    #[test]
    fn pushed_samples_stand_in_their_columns_however_many_there_are() {
        let mut signals = Signals::<NamedColumn>::with_room(2, 2);
        let count = 3 * FIRST_ROOM;
        for k in 0..count {
            signals.push([k as f64]);
            signals.set_newest(NamedColumn::Second, -(k as f64));
        }
        assert_eq!(signals.view().dim(), (count, 2));
        assert!(signals.column(NamedColumn::First).iter().zip(0..).all(|(value, k)| *value == f64::from(k)));
        assert!(
            signals.column(NamedColumn::Second).iter().zip(0..).all(|(value, k)| *value == -f64::from(k))
        );
        assert!(signals.column(NamedColumn::Third).is_empty() && !signals.has(NamedColumn::Third));
        signals.truncate(2);
        assert_eq!(signals, Signals::stack([&[0.0, 1.0][..], &[0.0, -1.0]]));
    }

    #[test]
    fn a_shorter_column_ends_in_nan() {
        let signals = Signals::<NamedColumn>::stack([&[1.0, 2.0][..], &[3.0]]);
        assert!(signals.column(NamedColumn::Second)[1].is_nan());
        assert_eq!(signals.len(), 2);
    }
}
