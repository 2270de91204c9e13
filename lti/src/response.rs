//! Frequency response: Hessenberg form once, then one pass over it for each handful of points.

use crate::components::{components, independent_blocks};
use crate::error::OperationContext;
use crate::hessenberg_sweep::{LANES, Lane, sweep};
use crate::scaling::balance;
use crate::structure::modes;
use crate::{C64, CMat, Error, Mat, StateSpace, Timebase};
use counterpoise_linalg as linalg;

/// One point of the response of a system with one input and one output: a frequency in rad/s and the value there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point {
    pub rate: f64,
    pub value: C64,
}

/// Returns `C inv(s I - A) B + D` at s = j w (continuous) or z = exp(j w T) (discrete), for each w in rad/s.
///
/// States scaled by powers of two, orthogonal reduction to Hessenberg form (10/3 n^3), then per point O(n^2) with
/// pivoting between neighbouring columns (the arrangement of Laub, IEEE TAC 26 (1981) 407, from the right so that nothing
/// needs storing). Eight points are worked on at a time.
///
/// # Errors
/// [`Error::Pole`] if a point is a pole to working precision, [`Error::Range`] for a frequency that is not finite.
pub fn frequency_response(g: &StateSpace, rates_rad_s: &[f64]) -> Result<Vec<CMat>, Error> {
    Response::of(g)?.at_all(rates_rad_s)
}

/// Returns the response at one frequency in rad/s; as [`frequency_response`].
///
/// # Errors
/// As [`frequency_response`].
pub fn response_at(g: &StateSpace, rate_rad_s: f64) -> Result<CMat, Error> {
    Response::of(g)?.at(rate_rad_s)
}

/// Returns the singular values of the response, largest first, for each frequency in rad/s.
///
/// # Errors
/// As [`frequency_response`].
pub fn sigma(g: &StateSpace, rates_rad_s: &[f64]) -> Result<Vec<Vec<f64>>, Error> {
    let responses = frequency_response(g, rates_rad_s)?;
    responses.iter().map(|H| linalg::csingular_values(H).with_operation("sigma")).collect()
}

/// Returns the gain at zero frequency: C inv(-A) B + D, or C inv(I - A) B + D.
///
/// # Errors
/// [`Error::Pole`] if the system integrates.
pub fn dcgain(g: &StateSpace) -> Result<Mat, Error> {
    Ok(response_at(g, 0.0)?.map(|entry| entry.re))
}

/// A system prepared for many evaluations of its response.
#[derive(Debug, Clone)]
pub struct Response {
    /// Systems side by side whose responses add up.
    parts: Vec<Part>,
    /// p x m.
    D: Mat,
    /// `true` if the dual system is held: one with fewer inputs than outputs is cheaper.
    dual: bool,
    timebase: Timebase,
}

/// One system without direct path, in Hessenberg form.
#[derive(Debug, Clone)]
struct Part {
    /// Upper Hessenberg, n x n.
    H: Mat,
    /// n x m.
    B: Mat,
    /// p x n.
    C: Mat,
    /// Size of the numbers that the entries were computed from.
    size: Size,
}

/// Lower bounds of the numbers whose rounding errors the entries of H, B and C carry; 0 if the entries are the given ones.
#[derive(Debug, Clone, Copy, Default)]
struct Size {
    H: f64,
    B: f64,
    C: f64,
}

impl Size {
    fn of(g: &StateSpace) -> Self {
        Self { H: g.A.norm_max(), B: g.B.norm_max(), C: g.C.norm_max() }
    }
}

impl Response {
    /// Scales and reduces a system. A flexible structure is taken apart into its modes, and whatever falls into
    /// independent parts is evaluated part by part: a modal model costs O(n) a point.
    ///
    /// # Errors
    /// [`Error::Matrix`] if the reduction fails.
    pub fn of(g: &StateSpace) -> Result<Self, Error> {
        let dual = g.outputs() < g.inputs();
        let modal = modes(g)?;
        let (scaled, _) = balance(modal.as_ref().unwrap_or(g));
        let scaled = if dual { scaled.dual() } else { scaled };
        let groups = independent_blocks(&scaled.A);
        let parts: Result<Vec<Part>, Error> =
            groups.iter().map(|group| Part::of(&scaled.permute(group))).collect();
        let mut parts = parts?;
        if modal.is_some() {
            // The entries of mode shapes have errors relative to the largest one.
            let size = Size::of(&scaled);
            parts.iter_mut().for_each(|part| part.size = Size { H: 0.0, ..size });
        }
        Ok(Self { parts, D: scaled.D, dual, timebase: g.timebase })
    }

    /// Returns the response at one frequency in rad/s.
    ///
    /// # Errors
    /// As [`frequency_response`].
    pub fn at(&self, rate_rad_s: f64) -> Result<CMat, Error> {
        let s = point_of_rate(rate_rad_s, self.timebase);
        self.gather(&self.sum(&Lane::new(&[s])), 0, s)
    }

    /// Returns the response at each frequency in rad/s.
    ///
    /// # Errors
    /// As [`frequency_response`].
    pub fn at_all(&self, rates_rad_s: &[f64]) -> Result<Vec<CMat>, Error> {
        let points: Vec<C64> = rates_rad_s.iter().map(|&rate| point_of_rate(rate, self.timebase)).collect();
        self.at_points(&points)
    }

    /// Returns the response at each point s (or z) of the complex plane.
    ///
    /// # Errors
    /// As [`frequency_response`].
    pub fn at_points(&self, points: &[C64]) -> Result<Vec<CMat>, Error> {
        let mut out = Vec::with_capacity(points.len());
        for group in points.chunks(LANES) {
            let mut lanes = [*group.last().unwrap_or(&C64::new(0.0, 0.0)); LANES];
            lanes[..group.len()].copy_from_slice(group);
            let values = self.sum(&Lane::new(&lanes));
            for (lane, &s) in group.iter().enumerate() {
                out.push(self.gather(&values, lane, s)?);
            }
        }
        Ok(out)
    }

    /// Returns the parts' responses added, p x m, column by column.
    fn sum<const N: usize>(&self, s: &Lane<N>) -> Vec<Lane<N>> {
        let mut sum = vec![Lane::ZERO; self.D.as_slice().len()];
        for part in &self.parts {
            let values = sweep(&part.H, &part.B, &part.C, s);
            sum.iter_mut().zip(&values).for_each(|(total, value)| total.add(value));
        }
        sum
    }

    /// Returns the first entry of the response at each frequency, not finite where that is a pole.
    pub(crate) fn scalar_at_all(&self, rates_rad_s: &[f64]) -> Vec<C64> {
        let mut out = Vec::with_capacity(rates_rad_s.len());
        for group in rates_rad_s.chunks(LANES) {
            let mut lanes = [C64::new(0.0, 1.0); LANES];
            lanes.iter_mut().zip(group).for_each(|(lane, &rate)| *lane = point_of_rate(rate, self.timebase));
            let values = self.sum(&Lane::new(&lanes));
            out.extend((0..group.len()).map(|lane| values[0].get(lane) + self.D[(0, 0)]));
        }
        out
    }

    /// Returns how much one rounding of each operand may change the first entry of the response at a frequency in rad/s; infinite if it is not known,
    /// as at a pole.
    ///
    /// |y| (|H| + |s|) |x| + |C| |x| + |y| |B| + |D| times the unit roundoff, with x = inv(s I - H) B and y = C inv(s I - H), in the
    /// coordinates in which the response is computed (N. Higham, Accuracy and Stability of Numerical Algorithms, section 7.2). O(n^2).
    pub(crate) fn rounding_at(&self, rate_rad_s: f64) -> f64 {
        self.rounding(point_of_rate(rate_rad_s, self.timebase))
    }

    /// Returns the same at a point s (or z) of the complex plane.
    pub(crate) fn rounding(&self, s: C64) -> f64 {
        let direct = self.D[(0, 0)].abs();
        let sum = self.parts.iter().fold(direct, |sum, part| sum + part.magnitude(s));
        let noise = 0.5 * f64::EPSILON * sum;
        if noise.is_nan() { f64::INFINITY } else { noise }
    }

    /// Returns one lane's answer, with the direct path, refused where the point was a pole.
    fn gather<const N: usize>(&self, values: &[Lane<N>], lane: usize, s: C64) -> Result<CMat, Error> {
        let (p, m) = self.D.shape();
        let G = CMat::from_fn(p, m, |i, j| values[j * p + i].get(lane) + self.D[(i, j)]);
        if !s.re.is_finite() || !s.im.is_finite() {
            let value = if s.re.is_finite() { s.im } else { s.re };
            return Err(Error::Range { what: "frequency", value, allowed: "finite" });
        }
        if !G.is_finite() {
            let (what, problem) = ("frequency response", "lies on the frequency asked for");
            return Err(Error::Pole { what, re: s.re, im: s.im, problem });
        }
        Ok(if self.dual { CMat::from_fn(m, p, |i, j| G[(j, i)]) } else { G })
    }
}

impl Part {
    fn of(g: &StateSpace) -> Result<Self, Error> {
        let (H, U, g) = block_hessenberg(g)?;
        let size = if U == Mat::eye(g.order()) { Size::default() } else { Size::of(&g) };
        Ok(Self { B: &U.t() * &g.B, C: &g.C * &U, H, size })
    }

    /// Returns the sum of the magnitudes of the terms that make the first entry of the response at a point.
    fn magnitude(&self, s: C64) -> f64 {
        let n = self.H.nrows();
        let shifted = |i: usize, j: usize| if i == j { s } else { C64::ZERO } - self.H[(i, j)];
        let turned = |i: usize, j: usize| shifted(n - 1 - j, n - 1 - i);
        let x = solve_hessenberg(n, shifted, self.B.column(0));
        let C: Vec<f64> = (0..n).rev().map(|j| self.C[(0, j)]).collect();
        let mut y = solve_hessenberg(n, turned, &C);
        y.reverse();
        let (x, y): (Vec<f64>, Vec<f64>) =
            (x.iter().map(|e| e.norm()).collect(), y.iter().map(|e| e.norm()).collect());
        let mut sum = 0.0;
        for j in 0..n {
            let through: f64 = (0..n).map(|i| y[i] * self.H[(i, j)].abs().max(self.size.H)).sum();
            sum += (through + s.norm() * y[j] + self.C[(0, j)].abs().max(self.size.C)) * x[j];
            sum += y[j] * self.B[(j, 0)].abs().max(self.size.B);
        }
        sum
    }
}

/// Returns the solution of M x = b for an upper Hessenberg matrix given by its entries; not finite if it is singular. Gaussian elimination
/// with pivoting between neighbouring rows.
fn solve_hessenberg(n: usize, entry: impl Fn(usize, usize) -> C64, b: &[f64]) -> Vec<C64> {
    let mut x: Vec<C64> = b.iter().map(|&value| C64::new(value, 0.0)).collect();
    let mut rows: Vec<Vec<C64>> = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
    for k in 0..n.saturating_sub(1) {
        if rows[k + 1][k].norm() > rows[k][k].norm() {
            rows.swap(k, k + 1);
            x.swap(k, k + 1);
        }
        let (above, below) = rows.split_at_mut(k + 1);
        let (top, row) = (&above[k], &mut below[0]);
        let factor = if row[k] == C64::ZERO { C64::ZERO } else { row[k] / top[k] };
        for (target, source) in row[k..].iter_mut().zip(&top[k..]) {
            *target -= factor * source;
        }
        let known = factor * x[k];
        x[k + 1] -= known;
    }
    for i in (0..n).rev() {
        let known: C64 = (i + 1..n).map(|j| rows[i][j] * x[j]).sum();
        x[i] = (x[i] - known) / rows[i][i];
    }
    x
}

/// Returns the upper Hessenberg H = U' A U, group of states by group, and the system in the order of the groups that
/// U refers to.
fn block_hessenberg(g: &StateSpace) -> Result<(Mat, Mat, StateSpace), Error> {
    let groups = components(&g.A);
    let order: Vec<usize> = groups.iter().flatten().copied().collect();
    let g = g.permute(&order);
    if groups.len() < 2 {
        let (H, U) = linalg::hessenberg(&g.A).with_operation("frequency response")?;
        return Ok((H, U, g));
    }
    let mut U = Mat::eye(g.order());
    let mut blocks = Vec::with_capacity(groups.len());
    let mut top = 0;
    for size in groups.iter().map(Vec::len) {
        if size > 2 {
            let (H, V) =
                linalg::hessenberg(&g.A.block(top, top, size, size)).with_operation("frequency response")?;
            U.set_block(top, top, &V);
            blocks.push((top, H));
        }
        top += size;
    }
    let mut H = if blocks.is_empty() { g.A.clone() } else { &U.t() * &(&g.A * &U) };
    blocks.iter().for_each(|(top, block)| H.set_block(*top, *top, block));
    Ok((H, U, g))
}

/// Returns the point of the complex plane that belongs to a frequency in rad/s.
pub fn point_of_rate(rate_rad_s: f64, timebase: Timebase) -> C64 {
    match timebase {
        Timebase::Continuous => C64::new(0.0, rate_rad_s),
        Timebase::Discrete { period_s } => C64::from_polar(1.0, rate_rad_s * period_s),
    }
}
