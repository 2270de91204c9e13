//! A linear system in state space, and its timebase.

use std::fmt;

use crate::{Error, Mat};

/// Continuous or sampled time. There is no default: a system without a timebase is a frequent, silent mistake.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Timebase {
    /// x' = A x + B u.
    Continuous,
    /// x\[k+1\] = A x\[k\] + B u\[k\], one step every `period_s` seconds.
    Discrete {
        /// Sample period in seconds.
        period_s: f64,
    },
}

impl fmt::Display for Timebase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Timebase::Continuous => write!(f, "continuous"),
            Timebase::Discrete { period_s } => write!(f, "discrete, {period_s} s"),
        }
    }
}

/// A linear system
///
/// ```text
///     x' (or x[k+1]) = A x + B u        A: n x n, B: n x m
///     y              = C x + D u        C: p x n, D: p x m
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct StateSpace {
    /// State matrix, n x n.
    pub A: Mat,
    /// Input matrix, n x m.
    pub B: Mat,
    /// Output matrix, p x n.
    pub C: Mat,
    /// Direct path, p x m.
    pub D: Mat,
    /// Continuous, or discrete with its period.
    pub timebase: Timebase,
}

impl StateSpace {
    /// Returns the system with the given matrices.
    ///
    /// # Errors
    /// [`Error::Shape`] if the sizes do not fit, [`Error::NotFinite`] if an entry is NaN or infinite,
    /// [`Error::Period`] if a sample period is not positive.
    pub fn new(A: Mat, B: Mat, C: Mat, D: Mat, timebase: Timebase) -> Result<Self, Error> {
        let n = A.nrows();
        check_shape("A", &A, n, n)?;
        check_shape("B", &B, n, B.ncols())?;
        check_shape("C", &C, C.nrows(), n)?;
        check_shape("D", &D, C.nrows(), B.ncols())?;
        for (what, matrix) in [("A", &A), ("B", &B), ("C", &C), ("D", &D)] {
            if !matrix.is_finite() {
                return Err(Error::NotFinite { what });
            }
        }
        match timebase {
            Timebase::Discrete { period_s } if !(period_s > 0.0 && period_s.is_finite()) => {
                Err(Error::Period { period_s })
            }
            _ => Ok(Self { A, B, C, D, timebase }),
        }
    }

    /// Returns the static gain y = D u.
    ///
    /// # Errors
    /// As [`StateSpace::new`].
    pub fn gain(D: Mat, timebase: Timebase) -> Result<Self, Error> {
        let (p, m) = D.shape();
        Self::new(Mat::zeros(0, 0), Mat::zeros(0, m), Mat::zeros(p, 0), D, timebase)
    }

    /// Returns the number of states, n.
    pub fn order(&self) -> usize {
        self.A.nrows()
    }

    /// Returns the number of inputs, m.
    pub fn inputs(&self) -> usize {
        self.B.ncols()
    }

    /// Returns the number of outputs, p.
    pub fn outputs(&self) -> usize {
        self.C.nrows()
    }

    /// Returns the subsystem from the inputs `inputs` to the outputs `outputs`, with all states kept.
    pub fn select(&self, outputs: &[usize], inputs: &[usize]) -> Self {
        let states: Vec<usize> = (0..self.order()).collect();
        Self {
            A: self.A.clone(),
            B: self.B.select(&states, inputs),
            C: self.C.select(outputs, &states),
            D: self.D.select(outputs, inputs),
            timebase: self.timebase,
        }
    }
}

fn check_shape(what: &'static str, matrix: &Mat, rows: usize, columns: usize) -> Result<(), Error> {
    let (found, expected) = (matrix.shape(), (rows, columns));
    if found == expected { Ok(()) } else { Err(Error::Shape { what, found, expected }) }
}
