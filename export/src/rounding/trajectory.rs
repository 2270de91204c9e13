//! What rounding does along a run: the errors of every sample carried on by the derivatives of the step as it ran.

use counterpoise_controller::Controller;

use super::tangent::{Row, Tangent};
use super::{Arithmetic, Line, Rounded};
use crate::ranges::Run;
use crate::tolerance::NEGLIGIBLE_COVARIANCE;

/// The errors of the control of a run, sample by sample.
#[derive(Debug, Clone, Default)]
pub(crate) struct Track {
    /// The part that is known with its sign, V.
    pub mean_v: Vec<f64>,
    /// Sum of the squared bounds of all roundings so far, each times what it does to this control, V^2.
    pub squares_v2: Vec<f64>,
}

/// Follows a run:
///
/// ```text
///     m <- A m + E b,   P <- A P A' + E diag(r^2) E',   control: c m + f b,  c P c' + f diag(r^2) f'
/// ```
///
/// with A, E, c, f the derivatives of this sample's step by its states and by an error of each of its operations, b the
/// known part of the roundings and r the bound of the rest.
pub(crate) fn follow(controller: &Controller, run: &Run, arithmetic: &impl Arithmetic) -> Track {
    let programs = controller.programs();
    let n = programs.state_count();
    let mut walk = Walk {
        step: Tangent::new(&programs.step, n),
        set: Tangent::new(&programs.set_out_of_balance, n),
        states: programs.initial(),
        errors: Errors::none(n),
        track: Track::default(),
    };
    run.play(
        &mut walk,
        |walk, value| walk.set(value, arithmetic),
        |walk, _, readings| walk.step(readings, arithmetic),
    );
    walk.track
}

struct Walk<'a> {
    step: Tangent<'a>,
    set: Tangent<'a>,
    states: Vec<f64>,
    errors: Errors,
    track: Track,
}

impl Walk<'_> {
    fn set(&mut self, value: f64, arithmetic: &impl Arithmetic) {
        self.set.run(&mut self.states, &[value]);
        let rounded = roundings(&self.set, Line::Set, arithmetic);
        self.errors.advance(&self.set, &rounded);
    }

    fn step(&mut self, readings: &[f64], arithmetic: &impl Arithmetic) {
        self.step.run(&mut self.states, readings);
        let rounded = roundings(&self.step, Line::Step, arithmetic);
        let (mean, squares) = self.errors.of(self.step.output(), &rounded);
        self.track.mean_v.push(mean);
        self.track.squares_v2.push(squares);
        self.errors.advance(&self.step, &rounded);
    }
}

fn roundings(tangent: &Tangent<'_>, line: Line, arithmetic: &impl Arithmetic) -> Vec<Rounded> {
    tangent.executed().map(|executed| arithmetic.rounded(line, &executed)).collect()
}

/// Known errors of the states and the covariance bound of the rest.
struct Errors {
    n: usize,
    mean: Vec<f64>,
    covariance: Vec<f64>,
    turned: Vec<f64>,
}

impl Errors {
    fn none(n: usize) -> Self {
        Self { n, mean: vec![0.0; n], covariance: vec![0.0; n * n], turned: vec![0.0; n * n] }
    }

    /// Known error and sum of squares of what a row of derivatives gives.
    fn of(&self, row: &[(usize, f64)], rounded: &[Rounded]) -> (f64, f64) {
        let (mut mean, mut squares) = (0.0, 0.0);
        for (i, a) in row {
            match i.checked_sub(self.n) {
                Some(number) => {
                    mean += a * rounded[number].known;
                    squares += a * a * rounded[number].square;
                }
                None => {
                    mean += a * self.mean[*i];
                    let line = &self.covariance[i * self.n..(i + 1) * self.n];
                    squares +=
                        a * row.iter().filter(|e| e.0 < self.n).map(|(j, b)| b * line[*j]).sum::<f64>();
                }
            }
        }
        (mean, squares.max(0.0))
    }

    fn advance(&mut self, tangent: &Tangent<'_>, rounded: &[Rounded]) {
        let n = self.n;
        let mean = |i: usize| {
            let each = tangent.state(i).iter().map(|(j, a)| match j.checked_sub(n) {
                Some(number) => a * rounded[number].known,
                None => a * self.mean[*j],
            });
            each.sum::<f64>()
        };
        self.mean = (0..n).map(mean).collect();
        let row = |i: usize| tangent.state(i);
        product(n, &row, &self.covariance, &mut self.turned);
        transpose(n, &mut self.turned);
        product(n, &row, &self.turned, &mut self.covariance);
        for (number, one) in rounded.iter().enumerate().filter(|(_, one)| one.square > 0.0) {
            let column = tangent.column(number);
            for (i, a) in column {
                let weight = a * one.square;
                column.iter().for_each(|(j, b)| self.covariance[i * n + j] += weight * b);
            }
        }
    }
}

/// out = A of, for the rows of A. Paths that share no error have no covariance: rows of `of` are used from their first to
/// their last entry that is not 0.
fn product<'r>(n: usize, row: &dyn Fn(usize) -> &'r Row, of: &[f64], out: &mut [f64]) {
    let spans: Vec<(usize, usize)> = of.chunks_exact(n).map(span).collect();
    for (i, into) in out.chunks_exact_mut(n).enumerate() {
        into.fill(0.0);
        for (j, a) in row(i).iter().filter(|entry| entry.0 < n) {
            let (first, last) = spans[*j];
            let from = &of[j * n + first..j * n + last];
            into[first..last].iter_mut().zip(from).for_each(|(x, y)| *x += a * y);
        }
        into.iter_mut().for_each(|x| *x = if x.abs() < NEGLIGIBLE_COVARIANCE { 0.0 } else { *x });
    }
}

fn span(row: &[f64]) -> (usize, usize) {
    let first = row.iter().position(|x| *x != 0.0).unwrap_or(0);
    (first, row.iter().rposition(|x| *x != 0.0).map_or(first, |last| last + 1))
}

fn transpose(n: usize, square: &mut [f64]) {
    for i in 0..n {
        for j in 0..i {
            square.swap(i * n + j, j * n + i);
        }
    }
}
