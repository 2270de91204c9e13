//! Structures M x'' + C x' + K x = F u before they become systems: Guyan condensation and modal truncation.

use crate::Error;
use crate::error::StepContext;
use crate::tolerance::{COMPARED_FREQUENCIES, RIGID_RATE};
use counterpoise_linalg as linalg;
use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};

/// A structure
///
/// ```text
///   M x'' + C x' + K x = F u,     y = P x + V x'          M, C, K: n x n symmetric, M > 0; F: n x m; P, V: p x n
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SecondOrder {
    /// Mass, symmetric positive definite.
    pub M: Mat,
    /// Damping, symmetric.
    pub C: Mat,
    /// Stiffness, symmetric.
    pub K: Mat,
    /// Directions of the input forces.
    pub F: Mat,
    /// Output rows of the positions.
    pub P: Mat,
    /// Output rows of the velocities.
    pub V: Mat,
}

/// A reduced structure with x = basis q, and how far its natural frequencies moved.
#[derive(Debug, Clone, PartialEq)]
pub struct SecondOrderReduction {
    /// The reduced structure.
    pub structure: SecondOrder,
    /// n x r.
    pub basis: Mat,
    /// Natural frequencies of the whole structure in rad/s, lowest first (as many as compared).
    pub rates_rad_s: Vec<f64>,
    /// Those of the reduced one; never below the former (Rayleigh's quotient on a subspace).
    pub reduced_rates_rad_s: Vec<f64>,
    /// The largest relative difference; rigid-body modes are compared against the highest rate.
    pub measured_error: f64,
}

impl SecondOrder {
    /// Checks the shapes.
    ///
    /// # Errors
    /// [`Error::Shape`] with the matrix that does not fit.
    pub fn check(&self) -> Result<(), Error> {
        let (n, m, p) = (self.M.nrows(), self.F.ncols(), self.P.nrows());
        let shapes = [
            ("M", &self.M, (n, n)),
            ("C", &self.C, (n, n)),
            ("K", &self.K, (n, n)),
            ("F", &self.F, (n, m)),
            ("P", &self.P, (p, n)),
            ("V", &self.V, (p, n)),
        ];
        let wrong = shapes.into_iter().find(|(_, matrix, expected)| matrix.shape() != *expected);
        wrong.map_or(Ok(()), |(what, matrix, expected)| {
            Err(Error::Shape { what, found: matrix.shape(), expected })
        })
    }

    /// Returns the structure in the coordinates x = basis q.
    pub fn project(&self, basis: &Mat) -> Self {
        let both = |S: &Mat| (&basis.t() * &(S * basis)).symmetric_part();
        Self {
            M: both(&self.M),
            C: both(&self.C),
            K: both(&self.K),
            F: &basis.t() * &self.F,
            P: &self.P * basis,
            V: &self.V * basis,
        }
    }

    /// Returns the continuous system with the states \[x; x'\].
    ///
    /// # Errors
    /// [`Error::Shape`], [`Error::Matrix`] if M is not positive definite.
    pub fn to_state_space(&self) -> Result<StateSpace, Error> {
        self.check()?;
        let n = self.M.nrows();
        let L = linalg::cholesky(&self.M).with_step("mass matrix")?;
        let solve = |S: &Mat| linalg::solve(&L.t(), &linalg::solve(&L, S)?);
        let (MK, MC, MF) = (solve(&self.K), solve(&self.C), solve(&self.F));
        let (MK, MC, MF) =
            (MK.with_step("mass matrix")?, MC.with_step("mass matrix")?, MF.with_step("mass matrix")?);
        let A = Mat::from_blocks(&[&[&Mat::zeros(n, n), &Mat::eye(n)], &[&-&MK, &-&MC]]);
        let B = Mat::zeros(n, self.F.ncols()).vstack(&MF);
        let D = Mat::zeros(self.P.nrows(), self.F.ncols());
        Ok(StateSpace::new(A, B, self.P.hstack(&self.V), D, Timebase::Continuous)?)
    }

    /// Returns the natural frequencies in rad/s, lowest first, and mass-normalised shapes.
    fn modes(&self) -> Result<(Vec<f64>, Mat), Error> {
        let (values, shapes) = linalg::sym_gen_eigen(&self.K, &self.M).with_step("natural frequencies")?;
        Ok((values.iter().map(|value| value.max(0.0).sqrt()).collect(), shapes))
    }
}

/// Returns Guyan's static condensation on the master degrees of freedom (AIAA J. 3 (1965) 380): the slaves follow as the
/// stiffness alone would have them, x = \[1; -inv(Kss) Ksm\] q.
///
/// # Errors
/// [`Error::Shape`] for a master that does not exist or is named twice, [`Error::Matrix`] if the slaves are not held
/// (Kss singular).
pub fn guyan(structure: &SecondOrder, masters: &[usize]) -> Result<SecondOrderReduction, Error> {
    structure.check()?;
    let n = structure.M.nrows();
    let repeated = (1..masters.len()).any(|k| masters[..k].contains(&masters[k]));
    if repeated || masters.is_empty() || masters.iter().any(|&k| k >= n) {
        let worst = masters.iter().max().copied().unwrap_or(0);
        return Err(Error::Shape {
            what: "master degrees of freedom",
            found: (worst, masters.len()),
            expected: (n, n),
        });
    }
    let slaves: Vec<usize> = (0..n).filter(|k| !masters.contains(k)).collect();
    let (Kss, Ksm) = (structure.K.select(&slaves, &slaves), structure.K.select(&slaves, masters));
    let follow = linalg::solve(&Kss, &Ksm).with_step("stiffness of the slave degrees of freedom")?;
    let mut basis = Mat::zeros(n, masters.len());
    for j in 0..masters.len() {
        basis[(masters[j], j)] = 1.0;
        for (i, &slave) in slaves.iter().enumerate() {
            basis[(slave, j)] = -follow[(i, j)];
        }
    }
    reduction(structure, basis)
}

/// Returns the `modes` lowest undamped modes, mass-normalised: M becomes 1, K the squares of the natural
/// frequencies.
///
/// # Errors
/// [`Error::Shape`], [`Error::Order`] for no mode or more modes than degrees of freedom.
pub fn modal_basis(structure: &SecondOrder, modes: usize) -> Result<SecondOrderReduction, Error> {
    structure.check()?;
    let n = structure.M.nrows();
    if modes == 0 || modes > n {
        return Err(Error::Order { wanted: modes, kept: n });
    }
    let (_, shapes) = structure.modes()?;
    reduction(structure, shapes.block(0, 0, n, modes))
}

fn reduction(structure: &SecondOrder, basis: Mat) -> Result<SecondOrderReduction, Error> {
    let reduced = structure.project(&basis);
    if [&reduced.M, &reduced.C, &reduced.K, &basis].iter().any(|matrix| !matrix.is_finite()) {
        return Err(linalg::Error::OutOfRange { what: "the reduced structure" }).with_step("reduction");
    }
    let count = basis.ncols().min(COMPARED_FREQUENCIES);
    let (mut rates_rad_s, mut reduced_rates_rad_s) = (structure.modes()?.0, reduced.modes()?.0);
    rates_rad_s.truncate(count);
    reduced_rates_rad_s.truncate(count);
    let highest = rates_rad_s.last().copied().unwrap_or(0.0);
    let relative =
        |(a, b): (&f64, &f64)| (b - a).abs() / if *a > RIGID_RATE * highest { *a } else { highest };
    let measured_error = rates_rad_s.iter().zip(&reduced_rates_rad_s).map(relative).fold(0.0, f64::max);
    Ok(SecondOrderReduction { structure: reduced, basis, rates_rad_s, reduced_rates_rad_s, measured_error })
}
