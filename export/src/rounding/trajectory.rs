//! The effect of rounding along a run: the errors of every sample carried on by the derivatives of the step as it ran.

use std::ops::Range;

use counterpoise_controller::Controller;
use counterpoise_linalg::sparse::VectorEntry;

use super::tangent::Tangent;
use super::{Arithmetic, Line, OperationRounding};
use crate::ranges::{Run, RunVisitor, play_runs};
use crate::tolerance::NEGLIGIBLE_COVARIANCE;

/// The errors of the control of a run, sample by sample.
#[derive(Debug, Clone, Default)]
pub(crate) struct ErrorTrack {
    /// The part that is known with its sign, V.
    pub mean_v: Vec<f64>,
    /// Sum of the squared bounds of all roundings so far, each times what it does to this control, V^2.
    pub squares_v2: Vec<f64>,
}

/// Follows runs:
///
/// ```text
///     m <- A m + E b,   P <- A P A' + E diag(r^2) E',   control: c m + f b,  c P c' + f diag(r^2) f'
/// ```
///
/// with A, E, c, f the derivatives of this sample's step by its states and by an error of each of its operations, b the
/// known part of the roundings and r the bound of the rest.
pub(crate) fn track_errors(
    controller: &Controller,
    runs: &[Run],
    arithmetic: &impl Arithmetic,
) -> Vec<ErrorTrack> {
    play_runs(runs, &TrajectoryVisitor { controller, arithmetic })
        .into_iter()
        .map(|walk| walk.track)
        .collect()
}

struct TrajectoryVisitor<'a, T> {
    controller: &'a Controller,
    arithmetic: &'a T,
}

impl<'a, T: Arithmetic> RunVisitor<Walk<'a>> for TrajectoryVisitor<'a, T> {
    fn start(&self) -> Walk<'a> {
        let programs = self.controller.programs();
        let n = programs.state_count();
        Walk {
            step: Tangent::new(&programs.step, n),
            set: Tangent::new(&programs.set_out_of_balance, n),
            states: programs.initial(),
            rounded: Vec::new(),
            errors: Errors::at_rest(n),
            track: ErrorTrack::default(),
        }
    }

    fn set(&self, walk: &mut Walk<'a>, out_of_balance_kg_m: f64) {
        walk.set(out_of_balance_kg_m, self.arithmetic);
    }

    fn sample(&self, walk: &mut Walk<'a>, run: &Run, k: usize) {
        // A difference of readings that are nearly alike is as large as what their rounding changes in it.
        walk.step(&run.readings[k].map(|value| self.arithmetic.stored_reading(value)), self.arithmetic);
    }
}

#[derive(Clone)]
struct Walk<'a> {
    step: Tangent<'a>,
    set: Tangent<'a>,
    states: Vec<f64>,
    rounded: Vec<OperationRounding>,
    errors: Errors,
    track: ErrorTrack,
}

impl Walk<'_> {
    fn set(&mut self, value: f64, arithmetic: &impl Arithmetic) {
        self.set.run(&mut self.states, &[value]);
        roundings(&self.set, Line::Set, arithmetic, &mut self.rounded);
        self.errors.advance(&self.set, &self.rounded);
    }

    fn step(&mut self, readings: &[f64], arithmetic: &impl Arithmetic) {
        self.step.run(&mut self.states, readings);
        roundings(&self.step, Line::Step, arithmetic, &mut self.rounded);
        let (mean, squares) = self.errors.of(self.step.output(), &self.rounded);
        self.track.mean_v.push(mean);
        self.track.squares_v2.push(squares);
        self.errors.advance(&self.step, &self.rounded);
    }
}

fn roundings(
    tangent: &Tangent<'_>,
    line: Line,
    arithmetic: &impl Arithmetic,
    rounded: &mut Vec<OperationRounding>,
) {
    rounded.clear();
    rounded.extend(tangent.executed_operations().map(|executed| arithmetic.rounding_of(line, &executed)));
}

/// Known errors of the states and the covariance bound of the rest.
#[derive(Clone)]
struct Errors {
    n: usize,
    mean: Vec<f64>,
    /// The mean after the step, while it is computed.
    next: Vec<f64>,
    covariance: Vec<f64>,
    turned: Vec<f64>,
    spans: Vec<Range<usize>>,
}

impl Errors {
    fn at_rest(n: usize) -> Self {
        let (mean, square) = (vec![0.0; n], vec![0.0; n * n]);
        Self { n, next: mean.clone(), mean, covariance: square.clone(), turned: square, spans: Vec::new() }
    }

    /// Known error and sum of squares of what a row of derivatives gives.
    fn of(&self, row: &[VectorEntry], rounded: &[OperationRounding]) -> (f64, f64) {
        let (mut mean, mut squares) = (0.0, 0.0);
        for &VectorEntry { index: i, value: a } in row {
            match i.checked_sub(self.n) {
                Some(number) => {
                    mean += a * rounded[number].known;
                    squares += a * a * rounded[number].square;
                }
                None => {
                    mean += a * self.mean[i];
                    let line = &self.covariance[i * self.n..(i + 1) * self.n];
                    let of_states = row.iter().filter(|entry| entry.index < self.n);
                    squares += a * of_states.map(|entry| entry.value * line[entry.index]).sum::<f64>();
                }
            }
        }
        (mean, squares.max(0.0))
    }

    fn advance(&mut self, tangent: &Tangent<'_>, rounded: &[OperationRounding]) {
        let n = self.n;
        let mean = |i: usize| {
            let each = tangent.state(i).iter().map(|entry| match entry.index.checked_sub(n) {
                Some(number) => entry.value * rounded[number].known,
                None => entry.value * self.mean[entry.index],
            });
            each.sum::<f64>()
        };
        let mut next = std::mem::take(&mut self.next);
        next.clear();
        next.extend((0..n).map(mean));
        self.next = std::mem::replace(&mut self.mean, next);
        product(n, tangent, &self.covariance, &mut self.spans, &mut self.turned);
        transpose(n, &mut self.turned);
        product(n, tangent, &self.turned, &mut self.spans, &mut self.covariance);
        for (number, one) in rounded.iter().enumerate().filter(|(_, one)| one.square > 0.0) {
            let column = tangent.column(number);
            for &VectorEntry { index: i, value: a } in column {
                let weight = a * one.square;
                column.iter().for_each(|other| self.covariance[i * n + other.index] += weight * other.value);
            }
        }
    }
}

/// out = A of, for the derivatives A of the states. Paths that share no error have no covariance: rows of `of` are used from their first to
/// their last entry that is not 0.
fn product(n: usize, tangent: &Tangent<'_>, of: &[f64], spans: &mut Vec<Range<usize>>, out: &mut [f64]) {
    spans.clear();
    spans.extend(of.chunks_exact(n).map(span));
    for (i, into) in out.chunks_exact_mut(n).enumerate() {
        into.fill(0.0);
        for &VectorEntry { index: j, value: a } in tangent.state(i).iter().filter(|entry| entry.index < n) {
            let span = spans[j].clone();
            let from = &of[j * n + span.start..j * n + span.end];
            into[span].iter_mut().zip(from).for_each(|(x, y)| *x += a * y);
        }
        into.iter_mut().for_each(|x| *x = if x.abs() < NEGLIGIBLE_COVARIANCE { 0.0 } else { *x });
    }
}

/// Returns the places from the first to the last entry that is not 0.
fn span(row: &[f64]) -> Range<usize> {
    let first = row.iter().position(|x| *x != 0.0).unwrap_or(0);
    first..row.iter().rposition(|x| *x != 0.0).map_or(first, |last| last + 1)
}

fn transpose(n: usize, square: &mut [f64]) {
    for i in 0..n {
        for j in 0..i {
            square.swap(i * n + j, j * n + i);
        }
    }
}
