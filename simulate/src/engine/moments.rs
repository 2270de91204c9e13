//! How a linear core moves over a time, exactly: its exponential, and the answer to polynomial inputs.

use counterpoise_lti::Mat;

/// Nodes of a step, as fractions of it: the four points of Lobatto's rule. A polynomial through them integrates with
/// order six at the end of the step.
pub(crate) const NODES: [f64; 4] = [0.0, 0.276_393_202_250_021, 0.723_606_797_749_979, 1.0];

/// Values of the cardinal polynomials of the nodes in the middle of a step.
pub(crate) const MIDDLE: [f64; 4] = [-0.125, 0.625, 0.625, -0.125];

/// Number of polynomial coefficients of an input over a step.
const TERMS: usize = 4;

/// Largest norm of A t at which the power series starts.
const SMALL: f64 = 0.1;

/// Terms of the power series: at the norm above, the first one left out is below the rounding error.
const SERIES_TERMS: usize = 12;

/// Over a time t: `Phi = exp(A t)` and `P_k = int_0^t exp(A (t - s)) B s^k / k! ds`, k = 0..3.
#[derive(Debug, Clone)]
pub(crate) struct Moments {
    pub Phi: Mat,
    pub P: [Mat; TERMS],
}

impl Moments {
    /// The moments at the times `finest`, 2 `finest`, 4 `finest`, ... (`count` of them).
    ///
    /// A power series where |A t| is small, then the doubling formulas
    /// `Phi(2t) = Phi Phi`, `P_k(2t) = Phi P_k + sum_j P_j t^(k-j) / (k-j)!`.
    pub fn family(A: &Mat, B: &Mat, finest: f64, count: usize) -> Vec<Self> {
        let mut time = finest;
        let mut halvings = 0;
        while A.norm_one() * time > SMALL && halvings < 60 {
            time *= 0.5;
            halvings += 1;
        }
        let mut now = Self::series(A, B, time);
        for _ in 0..halvings {
            now = now.doubled(time);
            time *= 2.0;
        }
        let mut family = vec![now];
        while family.len() < count {
            let next = family[family.len() - 1].doubled(time);
            family.push(next);
            time *= 2.0;
        }
        family
    }

    fn series(A: &Mat, B: &Mat, time: f64) -> Self {
        let n = A.nrows();
        let mut Phi = Mat::eye(n);
        let mut P = [0; TERMS].map(|_| Mat::zeros(n, B.ncols()));
        // powers of A t over the factorial
        let mut power = Mat::eye(n);
        for m in 0..SERIES_TERMS {
            let forced = &power * B;
            let mut factor = time;
            for (k, moment) in P.iter_mut().enumerate() {
                // A^m t^(m+k+1) / (m+k+1)! = (A^m t^m / m!) t^(k+1) m! / (m+k+1)!
                factor /= (m + k + 1) as f64;
                *moment += &forced.scale(factor);
                factor *= time;
            }
            power = (&power * A).scale(time / (m + 1) as f64);
            Phi += &power;
        }
        Self { Phi, P }
    }

    fn doubled(&self, time: f64) -> Self {
        let mut P = [0, 1, 2, 3].map(|k| &self.Phi * &self.P[k]);
        for (k, moment) in P.iter_mut().enumerate() {
            let mut factor = 1.0;
            for j in (0..=k).rev() {
                *moment += &self.P[j].scale(factor);
                factor *= time / (k - j + 1) as f64;
            }
        }
        Self { Phi: &self.Phi * &self.Phi, P }
    }

    /// The answer to input column `column` when it is the cardinal polynomial of node `node` of a step of length
    /// `step`, whatever part of the step these moments span.
    pub fn cardinal(&self, column: usize, node: usize, step: f64) -> Vec<f64> {
        let coefficients = cardinal_coefficients(node);
        let mut answer = vec![0.0; self.Phi.nrows()];
        let mut factor = 1.0;
        for (k, coefficient) in coefficients.into_iter().enumerate() {
            for (a, p) in answer.iter_mut().zip(self.P[k].column(column)) {
                *a += coefficient * factor * p;
            }
            factor *= (k + 1) as f64 / step;
        }
        answer
    }
}

/// Coefficients, lowest first, of the polynomial that is 1 at node `node` and 0 at the others.
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
    fn moments_of_an_integrator_are_powers() {
        let family = Moments::family(&Mat::zeros(1, 1), &Mat::eye(1), 0.25, 3);
        let expected = [1.0, 0.5, 1.0 / 6.0, 1.0 / 24.0];
        for (k, value) in expected.into_iter().enumerate() {
            assert!((family[2].P[k][(0, 0)] - value).abs() < 1e-15);
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
        assert!((family[10].Phi[(0, 0)] - z.exp()).abs() < 1e-14);
        assert!((family[10].P[0][(0, 0)] / (time * phi1) - 1.0).abs() < 1e-12);
        assert!((family[10].P[1][(0, 0)] / (time * time * phi2) - 1.0).abs() < 1e-12);
    }
}
