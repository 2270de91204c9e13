//! A weight from a table: the stable function of minimum phase whose modulus comes nearest to drawn points.

use counterpoise_linalg::{C64, Cone, ConeFailure, ConeProgram, Mat, eigenvalues};

use crate::tolerance::{LEADING, POSITIVE, TABLE_DEVIATION, TABLE_LEAST_DB, TABLE_MOST_DB};
use crate::{Error, Weight};

impl Weight {
    /// Returns a table of (frequency in rad/s, modulus), fitted by a function of the given order ([`fit_table`]).
    ///
    /// # Errors
    /// As [`fit_table`].
    pub fn table(points: &[[f64; 2]], order: usize) -> Result<Self, Error> {
        let table: Vec<TablePoint> = points.iter().copied().map(TablePoint::from).collect();
        let fitted = Box::new(fit_table(&table, order)?.weight);
        Ok(Weight::Table { points: points.to_vec(), order, fitted })
    }
}

/// A point of a table: what the modulus of a weight is to be at a frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TablePoint {
    /// Frequency, rad/s.
    pub rate_rad_s: f64,
    /// Modulus of the weight there, above 0.
    pub modulus: f64,
}

impl From<[f64; 2]> for TablePoint {
    fn from([rate_rad_s, modulus]: [f64; 2]) -> Self {
        Self { rate_rad_s, modulus }
    }
}

/// A fitted weight and how far it is from the table.
#[derive(Debug, Clone, PartialEq)]
pub struct WeightFit {
    /// The weight: as many zeros as poles, all in the left half plane.
    pub weight: Weight,
    /// Largest deviation from a point of the table, dB.
    pub worst_db: f64,
}

/// Points between -1 and 1 at which numerator and denominator are kept positive.
const GRID: usize = 161;
/// Highest order: beyond it a table asks for noise to be fitted.
pub const HIGHEST_ORDER: usize = 8;

/// Fits a table of frequencies and moduli by a weight of the given order.
///
/// ```text
///     |W(jw)|^2 = P(xi) / Q(xi),   xi = (w^2 - w0^2) / (w^2 + w0^2),   P, Q > 0 on [-1, 1]
///     smallest t:   m^2 Q / t <= P <= m^2 Q t   at every point
/// ```
///
/// Each t is a linear program in the Chebyshev coefficients of P and Q (interior points, clarabel); t by bisection; the
/// roots of P and Q, reflected into the left half plane, give zeros and poles. No guess of the phase is needed.
///
/// # Errors
/// [`Error::Range`] for fewer points than the order needs, frequencies that do not increase, moduli that are not positive, an
/// order of 0 or above [`HIGHEST_ORDER`]. [`Error::Weight`] if no function of that order comes within 80 dB.
pub fn fit_table(table: &[TablePoint], order: usize) -> Result<WeightFit, Error> {
    check(table, order)?;
    let problem = Problem::new(table, order);
    let (mut low, mut high) = (TABLE_LEAST_DB, TABLE_MOST_DB);
    let mut best = problem.solve(high)?;
    while high / low > 1.0 + TABLE_DEVIATION {
        let middle = (low * high).sqrt();
        match problem.solve(middle)? {
            Some(solution) => (best, high) = (Some(solution), middle),
            None => low = middle,
        }
    }
    let Some((P, Q)) = best else {
        let weight = format!("table of {} points", table.len());
        return Err(Error::Weight { weight, problem: "no function of this order comes near it" });
    };
    let weight = problem.weight(&P, &Q)?;
    let deviation = |at: &TablePoint| 20.0 * (weight.magnitude(at.rate_rad_s) / at.modulus).log10().abs();
    let worst_db = table.iter().map(deviation).fold(0.0, f64::max);
    Ok(WeightFit { weight, worst_db })
}

fn check(table: &[TablePoint], order: usize) -> Result<(), Error> {
    let refuse = |what, value, allowed| Err(Error::Range { what, value, allowed });
    if order == 0 || order > HIGHEST_ORDER {
        return refuse("order of the fit", order as f64, "from 1 to 8");
    }
    if table.len() < 2 * order + 1 {
        return refuse("number of points", table.len() as f64, "twice the order and one");
    }
    if let Some(point) = table.iter().find(|point| !(point.modulus > 0.0 && point.modulus.is_finite())) {
        return refuse("modulus", point.modulus, "positive");
    }
    let increasing = table.windows(2).all(|pair| pair[1].rate_rad_s > pair[0].rate_rad_s);
    if !(increasing && table[0].rate_rad_s > 0.0 && table[table.len() - 1].rate_rad_s.is_finite()) {
        return refuse(
            "first frequency in rad/s",
            table[0].rate_rad_s,
            "positive, and the frequencies increasing",
        );
    }
    Ok(())
}

type Coefficients = (Vec<f64>, Vec<f64>);

struct Problem {
    order: usize,
    centre: f64,
    /// Chebyshev polynomials at the points of the table, and the squares of the moduli.
    points: Vec<(Vec<f64>, f64)>,
    /// The same on the grid, with the moduli interpolated.
    grid: Vec<(Vec<f64>, f64)>,
}

impl Problem {
    fn new(table: &[TablePoint], order: usize) -> Self {
        let centre = (table[0].rate_rad_s * table[table.len() - 1].rate_rad_s).sqrt();
        let points = table.iter().map(|point| {
            let ratio = (point.rate_rad_s / centre).powi(2);
            (chebyshev((ratio - 1.0) / (ratio + 1.0), order), point.modulus * point.modulus)
        });
        let grid = (0..GRID).map(|k| {
            let xi = -(std::f64::consts::PI * k as f64 / (GRID - 1) as f64).cos();
            let rate = centre * ((1.0 + xi) / (1.0 - xi).max(f64::MIN_POSITIVE)).sqrt();
            (chebyshev(xi, order), interpolate_modulus(table, rate).powi(2))
        });
        Self { order, centre, points: points.collect(), grid: grid.collect() }
    }

    /// P and Q within `db` of the table, with the largest room to zero; `None` if there are none.
    fn solve(&self, db: f64) -> Result<Option<Coefficients>, Error> {
        let factor = 10f64.powf(db / 10.0);
        let (n, mut rows) = (self.order + 1, Vec::new());
        // Unknowns: P, Q, the room. Each row r x <= 0.
        for (basis, square) in &self.points {
            rows.push(row(basis, 1.0 / square, -factor, 0.0));
            rows.push(row(basis, -1.0 / square, 1.0 / factor, 0.0));
        }
        for (basis, square) in &self.grid {
            rows.push(row(basis, -1.0 / square, 0.0, 1.0));
            rows.push(row(basis, 0.0, -1.0, 1.0));
        }
        let mean = self.points.iter().fold(vec![0.0; 2 * n + 1], |mut sum, (basis, _)| {
            sum[n..2 * n].iter_mut().zip(basis).for_each(|(s, b)| *s += b / self.points.len() as f64);
            sum
        });
        let Some(x) = linear_program(rows, mean)? else { return Ok(None) };
        let feasible = x[2 * n] > POSITIVE;
        Ok(feasible.then(|| (x[..n].to_vec(), x[n..2 * n].to_vec())))
    }

    fn weight(&self, P: &[f64], Q: &[f64]) -> Result<Weight, Error> {
        let (zeros, poles) = (self.roots(P)?, self.roots(Q)?);
        let shape = Weight::ZeroPoleGain { zeros: zeros.clone(), poles: poles.clone(), gain: 1.0 };
        let at = |coefficients: &[f64], basis: &[f64]| -> f64 {
            coefficients.iter().zip(basis).map(|(c, b)| c * b).sum()
        };
        // The centre frequency is xi = 0.
        let middle = chebyshev(0.0, self.order);
        let modulus = (at(P, &middle) / at(Q, &middle)).sqrt();
        let gain = modulus / shape.magnitude(self.centre);
        Ok(Weight::ZeroPoleGain { zeros, poles, gain })
    }

    /// The left half plane roots s, s^2 = -w0^2 (1 + xi)/(1 - xi), of a Chebyshev series: conjugate pairs exact.
    fn roots(&self, series: &[f64]) -> Result<Vec<C64>, Error> {
        let mut roots = Vec::new();
        for xi in chebyshev_roots(series)? {
            if xi.im < 0.0 {
                continue;
            }
            let square = -(C64::ONE + xi) / (C64::ONE - xi) * self.centre * self.centre;
            let s = -square.sqrt();
            if xi.im == 0.0 {
                roots.push(C64::new(s.re, 0.0));
            } else {
                roots.extend([s, s.conj()]);
            }
        }
        Ok(roots)
    }
}

fn row(basis: &[f64], of_P: f64, of_Q: f64, of_room: f64) -> Vec<f64> {
    let scaled = |factor: f64| basis.iter().map(move |b| b * factor);
    scaled(of_P).chain(scaled(of_Q)).chain([of_room]).collect()
}

/// T_0 ... T_n at xi.
fn chebyshev(xi: f64, order: usize) -> Vec<f64> {
    let mut values = vec![1.0, xi];
    for k in 2..=order {
        values.push(2.0 * xi * values[k - 1] - values[k - 2]);
    }
    values.truncate(order + 1);
    values
}

/// Eigenvalues of the colleague matrix; leading coefficients that are nothing are left out.
fn chebyshev_roots(series: &[f64]) -> Result<Vec<C64>, Error> {
    let largest = series.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let degree = series.iter().rposition(|c| c.abs() > LEADING * largest).unwrap_or(0);
    if degree == 0 {
        return Ok(Vec::new());
    }
    if degree == 1 {
        return Ok(vec![C64::new(-series[0] / series[1], 0.0)]);
    }
    let mut A = Mat::zeros(degree, degree);
    A[(0, 1)] = 1.0;
    for k in 1..degree {
        A[(k, k - 1)] = 0.5;
        if k + 1 < degree {
            A[(k, k + 1)] = 0.5;
        }
    }
    for j in 0..degree {
        A[(degree - 1, j)] -= 0.5 * series[j] / series[degree];
    }
    Ok(eigenvalues(&A)?)
}

/// The modulus at a frequency by straight lines in logarithms, held beyond the ends.
fn interpolate_modulus(table: &[TablePoint], rate: f64) -> f64 {
    let Some(above) = table.iter().position(|point| point.rate_rad_s >= rate) else {
        return table[table.len() - 1].modulus;
    };
    if above == 0 {
        return table[0].modulus;
    }
    let (low, high) = (table[above - 1], table[above]);
    let share = (rate / low.rate_rad_s).ln() / (high.rate_rad_s / low.rate_rad_s).ln();
    low.modulus * (high.modulus / low.modulus).powf(share)
}

/// Maximises the last unknown with rows x <= 0 and mean x = 1; `None` if no point keeps them.
fn linear_program(rows: Vec<Vec<f64>>, mean: Vec<f64>) -> Result<Option<Vec<f64>>, Error> {
    let (m, n) = (rows.len(), mean.len());
    let mut cost = vec![0.0; n];
    cost[n - 1] = -1.0;
    let mut program = ConeProgram::new(cost);
    program.push(vec![mean], vec![1.0], Cone::Zero);
    program.push(rows, vec![0.0; m], Cone::Nonnegative);
    match program.solve() {
        Ok(found) => Ok(Some(found.x)),
        Err(ConeFailure::Malformed) => {
            Err(Error::Weight { weight: "table".into(), problem: "the linear program could not be set up" })
        }
        Err(_) => Ok(None),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn rates(count: usize) -> Vec<f64> {
        (0..count).map(|k| 0.1 * 10f64.powf(4.0 * k as f64 / (count - 1) as f64)).collect()
    }

    #[test]
    fn a_table_of_a_rational_weight_gives_the_weight_back() {
        let truth = Weight::ZeroPoleGain {
            zeros: vec![C64::new(-2.0, 6.0), C64::new(-2.0, -6.0)],
            poles: vec![C64::new(-0.5, 0.0), C64::new(-90.0, 0.0)],
            gain: 3.0,
        };
        let table: Vec<TablePoint> =
            rates(40).into_iter().map(|rate| [rate, truth.magnitude(rate)].into()).collect();
        let fit = fit_table(&table, 2).unwrap();
        assert!(fit.worst_db < 0.02, "{}", fit.worst_db);
        for rate in rates(77) {
            let db = 20.0 * (fit.weight.magnitude(rate) / truth.magnitude(rate)).log10();
            assert!(db.abs() < 0.05, "{db} dB at {rate}");
        }
    }

    #[test]
    fn a_drawn_shape_is_met_better_with_more_order_and_stays_stable() {
        let drawn = |rate: f64| if rate < 3.0 { 10.0 } else { (10.0 * (3.0 / rate).powf(1.5)).max(0.05) };
        let table: Vec<TablePoint> = rates(60).into_iter().map(|rate| [rate, drawn(rate)].into()).collect();
        let mut last = f64::INFINITY;
        for order in [1, 2, 4, 6] {
            let fit = fit_table(&table, order).unwrap();
            assert!(fit.worst_db < last, "{order}: {} dB after {last}", fit.worst_db);
            last = fit.worst_db;
            let rational = fit.weight.rational();
            assert!(rational.zeros.iter().chain(&rational.poles).all(|root| root.re < 0.0));
            assert!(fit.weight.realise().is_ok() && fit.weight.realise_inverse().is_ok());
        }
        assert!(last < 1.0, "{last} dB");
    }

    #[test]
    fn tables_that_are_none_are_refused() {
        let is_refused = |points: &[[f64; 2]], order: usize| Weight::table(points, order).is_err();
        assert!(is_refused(&[[1.0, 1.0], [2.0, 1.0]], 2));
        assert!(is_refused(&[[1.0, 1.0], [2.0, -1.0], [3.0, 1.0]], 1));
        assert!(is_refused(&[[1.0, 1.0], [1.0, 1.0], [3.0, 1.0]], 1));
        assert!(is_refused(&[[1.0, 1.0], [2.0, 1.0], [3.0, 1.0]], 0));
    }
}
