//! The exact motion of a linear core over a time: its exponential, and the answer to polynomial inputs.

use crate::tolerance::{MOST_HALVINGS, SERIES_NORM, SERIES_TERMS};
use counterpoise_linalg::Mat;

/// Nodes of a step, as fractions of it: the four points of Lobatto's rule. A polynomial through them integrates with
/// order six at the end of the step.
pub(crate) const NODES: [f64; 4] = [0.0, 0.276_393_202_250_021, 0.723_606_797_749_979, 1.0];

/// Values of the cardinal polynomials of the nodes in the middle of a step.
pub(crate) const MIDDLE: [f64; 4] = [-0.125, 0.625, 0.625, -0.125];

/// Number of polynomial coefficients of an input over a step.
const TERMS: usize = 4;

/// Over a time t: `Phi = exp(A t)` and `P_k = int_0^t exp(A (t - s)) B s^k / k! ds`, k = 0..3; row by row, the P_k of a
/// row one after the other.
#[derive(Debug, Clone)]
pub(crate) struct Moments {
    order: usize,
    inputs: usize,
    phi: Vec<f64>,
    forced: Vec<f64>,
}

impl Moments {
    /// Returns the moments at the times `finest`, 2 `finest`, 4 `finest`, ... (`count` of them).
    ///
    /// A power series where |A t| is small, then the doubling formulas
    /// `Phi(2t) = Phi Phi`, `P_k(2t) = Phi P_k + sum_j P_j t^(k-j) / (k-j)!`.
    pub fn family(A: &Mat, B: &Mat, finest: f64, count: usize) -> Vec<Self> {
        let mut time = finest;
        let mut halvings = 0;
        while A.norm_one() * time > SERIES_NORM && halvings < 80 {
            time *= 0.5;
            halvings += 1;
        }
        if halvings > MOST_HALVINGS {
            return Self::family_by_changes(A, B, time, halvings, count);
        }
        let mut now = Self::series(A, B, time);
        for _ in 0..halvings {
            now = now.double_time(time);
            time *= 2.0;
        }
        let mut family = vec![now];
        while family.len() < count {
            let next = family[family.len() - 1].double_time(time);
            family.push(next);
            time *= 2.0;
        }
        family
    }

    /// Returns what [`Self::family`] does, for a core with a motion so quick that beside it, over the time of the series, the slow motion is
    /// below the rounding error of one: `Phi - I` is doubled, by `2 (Phi - I) + (Phi - I)^2`, and keeps its digits.
    fn family_by_changes(A: &Mat, B: &Mat, series_s: f64, halvings: usize, count: usize) -> Vec<Self> {
        let mut time = series_s;
        let mut change = Self::series_from(A, B, time, Mat::zeros(A.nrows(), A.nrows()));
        let mut family = Vec::with_capacity(count);
        for doublings in 0..halvings + count {
            if doublings >= halvings {
                family.push(change.add_identity());
            }
            change = change.double_change(time);
            time *= 2.0;
        }
        family
    }

    fn series(A: &Mat, B: &Mat, time: f64) -> Self {
        Self::series_from(A, B, time, Mat::eye(A.nrows()))
    }

    /// Returns the moments by the power series, with Phi - I on top of a matrix.
    fn series_from(A: &Mat, B: &Mat, time: f64, start: Mat) -> Self {
        let (n, c) = (A.nrows(), B.ncols());
        let rows = |M: &Mat| -> Vec<f64> { (0..n).flat_map(|i| M.row_vec(i)).collect() };
        let (a, b) = (rows(A), rows(B));
        let mut phi = rows(&start);
        let mut forced = vec![0.0; n * TERMS * c];
        // powers of A t over the factorial
        let mut power = rows(&Mat::eye(n));
        for m in 0..SERIES_TERMS {
            let answer = product(&power, &b, n, c);
            let mut factor = time;
            for k in 0..TERMS {
                // A^m t^(m+k+1) / (m+k+1)! = (A^m t^m / m!) t^(k+1) m! / (m+k+1)!
                factor /= (m + k + 1) as f64;
                for i in 0..n {
                    for j in 0..c {
                        forced[(i * TERMS + k) * c + j] += factor * answer[i * c + j];
                    }
                }
                factor *= time;
            }
            power = product(&power, &a, n, n);
            let scale = time / (m + 1) as f64;
            for (p, total) in power.iter_mut().zip(&mut phi) {
                *p *= scale;
                *total += *p;
            }
        }
        Self { order: n, inputs: c, phi, forced }
    }

    fn double_time(&self, time: f64) -> Self {
        let n = self.order;
        let forced = product(&self.phi, &self.forced, n, TERMS * self.inputs);
        let phi = product(&self.phi, &self.phi, n, n);
        Self { phi, forced: self.add_shifted(forced, time), ..*self }
    }

    /// Doubles the time of moments that hold Phi - I in the place of Phi.
    fn double_change(&self, time: f64) -> Self {
        let n = self.order;
        let mut forced = product(&self.phi, &self.forced, n, TERMS * self.inputs);
        forced.iter_mut().zip(&self.forced).for_each(|(new, old)| *new += old);
        let mut phi = product(&self.phi, &self.phi, n, n);
        phi.iter_mut().zip(&self.phi).for_each(|(new, old)| *new += 2.0 * old);
        Self { phi, forced: self.add_shifted(forced, time), ..*self }
    }

    /// Returns moments that hold Phi, of such that hold Phi - I.
    fn add_identity(&self) -> Self {
        let mut phi = self.phi.clone();
        phi.iter_mut().step_by(self.order + 1).for_each(|entry| *entry += 1.0);
        Self { phi, forced: self.forced.clone(), ..*self }
    }

    /// Adds the answers to the first half of a doubled time to those of its second half.
    fn add_shifted(&self, mut forced: Vec<f64>, time: f64) -> Vec<f64> {
        let c = self.inputs;
        let factors = [1.0, time, time * time / 2.0, time * time * time / 6.0];
        for (new, old) in forced.chunks_exact_mut(TERMS * c).zip(self.forced.chunks_exact(TERMS * c)) {
            for k in 0..TERMS {
                for j in 0..=k {
                    for column in 0..c {
                        new[k * c + column] += factors[k - j] * old[j * c + column];
                    }
                }
            }
        }
        forced
    }

    /// Returns the number of states.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Returns an entry of Phi.
    pub fn phi(&self, i: usize, j: usize) -> f64 {
        self.phi[i * self.order + j]
    }

    /// Returns an entry of P_k.
    #[cfg(test)]
    pub fn p(&self, k: usize, i: usize, j: usize) -> f64 {
        self.forced[(i * TERMS + k) * self.inputs + j]
    }

    /// Returns the answer of row `row` to a constant input.
    pub fn constant(&self, row: usize, column: usize) -> f64 {
        self.forced[row * TERMS * self.inputs + column]
    }

    /// Returns the answer of row `row` to input column `column` when it is a polynomial over a step, of which these moments
    /// span a part; `weights` as [`cardinal_weights`] gives them.
    pub fn answer(&self, row: usize, column: usize, weights: &[f64; TERMS]) -> f64 {
        let at = row * TERMS * self.inputs + column;
        (0..TERMS).map(|k| weights[k] * self.forced[at + k * self.inputs]).sum()
    }
}

/// Returns the weights of the moments P_k of a step of a given length for each node's cardinal polynomial: coefficient k! / step^k.
pub(crate) fn cardinal_weights(step: f64) -> [[f64; TERMS]; 4] {
    let factors = [1.0, 1.0 / step, 2.0 / step.powi(2), 6.0 / step.powi(3)];
    std::array::from_fn(|node| {
        let coefficients = cardinal_coefficients(node);
        std::array::from_fn(|k| coefficients[k] * factors[k])
    })
}

/// Returns a square matrix of order n times one of `columns` columns, row by row.
fn product(left: &[f64], right: &[f64], n: usize, columns: usize) -> Vec<f64> {
    let mut out = vec![0.0; n * columns];
    for (row, target) in left.chunks_exact(n).zip(out.chunks_exact_mut(columns)) {
        for (factor, source) in row.iter().zip(right.chunks_exact(columns)) {
            for (t, s) in target.iter_mut().zip(source) {
                *t += factor * s;
            }
        }
    }
    out
}

/// Returns the coefficients, lowest first, of the polynomial that is 1 at node `node` and 0 at the others.
pub(crate) fn cardinal_coefficients(node: usize) -> [f64; TERMS] {
    let mut polynomial = [1.0, 0.0, 0.0, 0.0];
    let mut degree = 0;
    for (i, root) in NODES.into_iter().enumerate() {
        if i == node {
            continue;
        }
        let scale = 1.0 / (NODES[node] - root);
        for k in (0..=degree).rev() {
            polynomial[k + 1] += scale * polynomial[k];
            polynomial[k] *= -root * scale;
        }
        degree += 1;
    }
    polynomial
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cardinal_polynomials_are_cardinal() {
        for node in 0..4 {
            let c = cardinal_coefficients(node);
            for (i, s) in NODES.into_iter().enumerate() {
                let value = c[0] + s * (c[1] + s * (c[2] + s * c[3]));
                assert!((value - f64::from(u8::from(i == node))).abs() < 1e-14);
            }
            let middle = c[0] + 0.5 * (c[1] + 0.5 * (c[2] + 0.5 * c[3]));
            assert!((middle - MIDDLE[node]).abs() < 1e-14, "{middle}");
        }
    }

    #[test]
    fn slow_motion_beside_a_mode_of_any_frequency_keeps_its_digits() {
        // A body with drag, and one on it that swings a billion times as quick and dies out: x' = -0.3 x + u in the end.
        for rate in [1e4, 1e7, 1e9, 1e11] {
            let A = Mat::from_rows(&[&[-0.3, 0.0, 0.0], &[0.0, 0.0, 1.0], &[0.0, -rate * rate, -2.0 * rate]]);
            let B = Mat::col(&[1.0, 0.0, rate]);
            let last = Moments::family(&A, &B, 1e-9, 21).remove(20);
            let time = 1e-9 * f64::from(1u32 << 20);
            let expected = [(-0.3 * time).exp(), (-(-0.3 * time).exp_m1()) / 0.3];
            assert!((last.phi(0, 0) - expected[0]).abs() < 3e-10, "{rate}: {}", last.phi(0, 0));
            assert!((last.p(0, 0, 0) / expected[1] - 1.0).abs() < 1e-8, "{rate}: {}", last.p(0, 0, 0));
            let decay = 1.0 - last.phi(0, 0);
            assert!((decay / -(-0.3 * time).exp_m1() - 1.0).abs() < 1e-6, "{rate}: {decay}");
        }
    }

    #[test]
    fn moments_of_an_integrator_are_powers() {
        let family = Moments::family(&Mat::zeros(1, 1), &Mat::eye(1), 0.25, 3);
        let expected = [1.0, 0.5, 1.0 / 6.0, 1.0 / 24.0];
        for (k, value) in expected.into_iter().enumerate() {
            assert!((family[2].p(k, 0, 0) - value).abs() < 1e-15);
        }
    }

    #[test]
    fn moments_of_a_stiff_decay_are_the_phi_functions() {
        let rate = -3000.0;
        let A = Mat::from_rows(&[&[rate]]);
        let family = Moments::family(&A, &Mat::eye(1), 1e-6, 11);
        let time = 1.024e-3;
        let z = rate * time;
        let phi1 = (z.exp() - 1.0) / z;
        let phi2 = (phi1 - 1.0) / z;
        assert!((family[10].phi(0, 0) - z.exp()).abs() < 1e-14);
        assert!((family[10].p(0, 0, 0) / (time * phi1) - 1.0).abs() < 1e-12);
        assert!((family[10].p(1, 0, 0) / (time * time * phi2) - 1.0).abs() < 1e-12);
    }
}
