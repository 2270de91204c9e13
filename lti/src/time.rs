//! Time responses, exact at the samples for inputs that are held between them.

use crate::discretise::{Discretisation, c2d};
use crate::tolerance::MOST_POINTS;
use crate::{Error, Mat, StateSpace, Timebase};

/// Outputs over time.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeResponse {
    /// Seconds, from 0.
    pub time_s: Vec<f64>,
    /// One row a sample; column j p + i is output i for a signal in input j.
    pub y: Mat,
}

/// Returns the outputs for a unit step in each input, `n` points from 0 to `t_end_s` (a sampled system: its own samples up to there).
///
/// # Errors
/// [`Error::Range`] for an end that is not positive, fewer than two points or more than ten million; as [`c2d`].
pub fn step(g: &StateSpace, t_end_s: f64, n: usize) -> Result<TimeResponse, Error> {
    let (sampled, time_s) = sample_system(g, t_end_s, n)?;
    let ones = Mat::from_fn(time_s.len(), 1, |_, _| 1.0);
    each_input(&sampled, time_s, |one| lsim(one, &ones, None))
}

/// Returns the outputs for a unit impulse in each input: of area one in continuous time (a direct path's own impulse is left
/// out), one sample of height one in sampled time. Points as [`step`].
///
/// # Errors
/// As [`step`].
pub fn impulse(g: &StateSpace, t_end_s: f64, n: usize) -> Result<TimeResponse, Error> {
    let (sampled, time_s) = sample_system(g, t_end_s, n)?;
    let rows = time_s.len();
    if g.timebase == Timebase::Continuous {
        // C exp(A t) B: free motion from the state B.
        let mut free = sampled.clone();
        free.B = g.B.clone();
        return each_input(&free, time_s, |one| {
            let still = StateSpace { D: Mat::zeros(one.outputs(), 1), ..one.clone() };
            lsim(&still, &Mat::zeros(rows, 1), Some(one.B.column(0)))
        });
    }
    let pulse = Mat::from_fn(rows, 1, |k, _| if k == 0 { 1.0 } else { 0.0 });
    each_input(&sampled, time_s, |one| lsim(one, &pulse, None))
}

/// Returns the outputs of a **sampled** system for the inputs `u` (one row a sample, one column an input), from the state `x0` or
/// rest; one row a sample. A continuous system goes through [`c2d`] first, with the hold that fits the input.
///
/// # Errors
/// [`Error::Timebase`] for a continuous system, [`Error::Shape`]; [`Error::NotFinite`] if an output is no number because the states have left the range of doubles.
pub fn lsim(g: &StateSpace, u: &Mat, x0: Option<&[f64]>) -> Result<Mat, Error> {
    if g.timebase == Timebase::Continuous {
        let expected = "a discrete timebase (c2d first)".to_string();
        return Err(Error::Timebase { what: "lsim", found: g.timebase.to_string(), expected });
    }
    let (n, samples) = (g.order(), u.nrows());
    let x0 = x0.map_or(vec![0.0; n], <[f64]>::to_vec);
    if x0.len() != n || u.ncols() != g.inputs() {
        let (found, expected) = ((x0.len(), u.ncols()), (n, g.inputs()));
        return Err(Error::Shape { what: "lsim: initial state, inputs", found, expected });
    }
    let mut march = March {
        parts: [&g.C, &g.D, &g.A, &g.B].map(Runs::of),
        inputs: u.t(),
        y: Mat::zeros(g.outputs(), samples),
        x: x0,
    };
    pulp::Arch::new().dispatch(&mut march);
    if march.y.as_slice().iter().any(|y| y.is_nan()) {
        return Err(Error::NotFinite { what: "the response in time" });
    }
    Ok(march.y.t())
}

/// The samples one after another; compiled once for each instruction set, chosen when the program runs.
struct March<'a> {
    /// C, D, A, B.
    parts: [Runs<'a>; 4],
    inputs: Mat,
    y: Mat,
    x: Vec<f64>,
}

impl pulp::NullaryFnOnce for &mut March<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let [C, D, A, B] = &self.parts;
        let mut next = vec![0.0; self.x.len()];
        for k in 0..self.inputs.ncols() {
            let u = self.inputs.column(k);
            C.accumulate(self.y.column_mut(k), &self.x);
            D.accumulate(self.y.column_mut(k), u);
            next.fill(0.0);
            A.accumulate(&mut next, &self.x);
            B.accumulate(&mut next, u);
            std::mem::swap(&mut self.x, &mut next);
        }
    }
}

/// Zeros between two entries of a column that are worked through rather than stepped over.
const GAP: usize = 4;

/// A matrix with the stretches of rows, column by column, that are not zero: a loop of filters has few.
struct Runs<'a> {
    M: &'a Mat,
    rows: Vec<Vec<std::ops::Range<usize>>>,
}

impl<'a> Runs<'a> {
    fn of(M: &'a Mat) -> Self {
        let stretches = |j: usize| {
            let mut found: Vec<std::ops::Range<usize>> = Vec::new();
            for i in (0..M.nrows()).filter(|&i| M[(i, j)] != 0.0) {
                match found.last_mut() {
                    Some(last) if i < last.end + GAP => last.end = i + 1,
                    _ => found.push(i..i + 1),
                }
            }
            found
        };
        Self { M, rows: (0..M.ncols()).map(stretches).collect() }
    }

    /// sum += M v.
    #[inline(always)]
    fn accumulate(&self, sum: &mut [f64], v: &[f64]) {
        for (j, &factor) in v.iter().enumerate().filter(|(_, factor)| **factor != 0.0) {
            let column = self.M.column(j);
            for rows in &self.rows[j] {
                let part = sum[rows.clone()].iter_mut().zip(&column[rows.clone()]);
                part.for_each(|(s, m)| *s += m * factor);
            }
        }
    }
}

/// Returns the system on the points' own samples, and the points.
fn sample_system(g: &StateSpace, t_end_s: f64, n: usize) -> Result<(StateSpace, Vec<f64>), Error> {
    if !(t_end_s > 0.0 && t_end_s.is_finite()) {
        return Err(Error::Range { what: "t_end_s", value: t_end_s, allowed: "positive and finite" });
    }
    if let Timebase::Discrete { period_s } = g.timebase {
        let last = (t_end_s / period_s * (1.0 + f64::EPSILON)).floor();
        needs_few(last)?;
        let count = last as usize + 1;
        return Ok((g.clone(), (0..count).map(|k| k as f64 * period_s).collect()));
    }
    if n < 2 {
        return Err(Error::Range { what: "number of points", value: n as f64, allowed: "two or more" });
    }
    needs_few(n as f64)?;
    let period_s = t_end_s / (n - 1) as f64;
    Ok((c2d(g, period_s, Discretisation::ZeroOrderHold)?, (0..n).map(|k| k as f64 * period_s).collect()))
}

fn needs_few(points: f64) -> Result<(), Error> {
    if points <= MOST_POINTS {
        return Ok(());
    }
    Err(Error::Range {
        what: "number of points",
        value: points,
        allowed: "at most ten million: ask for a shorter time",
    })
}

fn each_input(
    g: &StateSpace,
    time_s: Vec<f64>,
    mut simulate: impl FnMut(&StateSpace) -> Result<Mat, Error>,
) -> Result<TimeResponse, Error> {
    let outputs: Vec<usize> = (0..g.outputs()).collect();
    let mut y = Mat::zeros(time_s.len(), g.outputs() * g.inputs());
    for j in 0..g.inputs() {
        y.set_block(0, j * g.outputs(), &simulate(&g.select(&outputs, &[j]))?);
    }
    Ok(TimeResponse { time_s, y })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn step_and_impulse_of_an_oscillator_are_the_closed_forms() {
        let A = Mat::from_rows(&[&[0.0, 1.0], &[-25.0, 0.0]]);
        let C = Mat::row(&[25.0, 0.0]);
        let g = StateSpace::new(A, Mat::col(&[0.0, 1.0]), C, Mat::zeros(1, 1), Timebase::Continuous).unwrap();
        let (step, impulse) = (step(&g, 3.0, 61).unwrap(), impulse(&g, 3.0, 61).unwrap());
        for (k, &t) in step.time_s.iter().enumerate() {
            assert!((step.y[(k, 0)] - (1.0 - (5.0 * t).cos())).abs() < 1e-13);
            assert!((impulse.y[(k, 0)] - 5.0 * (5.0 * t).sin()).abs() < 1e-12);
        }
    }

    #[test]
    fn a_sampled_system_keeps_its_own_samples() {
        let g = crate::delay_samples(2, 0.25).unwrap();
        let y = step(&g, 1.0, 0).unwrap();
        assert_eq!(y.time_s, vec![0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(y.y.column(0), &[0.0, 0.0, 1.0, 1.0, 1.0]);
        assert_eq!(impulse(&g, 1.0, 0).unwrap().y.column(0), &[0.0, 0.0, 1.0, 0.0, 0.0]);
    }
}
