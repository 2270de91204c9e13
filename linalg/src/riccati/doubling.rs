//! Structure-preserving doubling: quadratically convergent, made of products and one LU a step.
//!
//! Source: Chu, Fan and Lin, A structure-preserving doubling algorithm for continuous-time algebraic Riccati equations,
//! Lin. Alg. Appl. 396 (2005); for discrete time the same with Hwang and Wang, Int. J. Control 77 (2004).

use crate::dense::solve;
use crate::error::Error;
use crate::mat::Mat;
use crate::tolerance::DOUBLING_STEPS;

use super::scaling::Problem;

/// A first approximation of the stabilising solution of the continuous equation; `None` where the iteration breaks down
/// or does not settle.
pub(super) fn by_doubling(problem: &Problem) -> Option<Mat> {
    let Problem { A, G, Q } = problem;
    let base = A.norm_fro().max((G.norm_fro() * Q.norm_fro()).sqrt()) / (A.nrows() as f64).sqrt();
    [0.3, 1.7, 0.05].iter().find_map(|factor| run(cayley(A, G, Q, factor * base).ok()?))
}

/// The Cayley transform with parameter `gamma`: the discrete equation with the same solution.
fn cayley(A: &Mat, G: &Mat, Q: &Mat, gamma: f64) -> Result<Problem, Error> {
    let n = A.nrows();
    let identity = Mat::eye(n);
    let shifted = A - &identity.scale(gamma);
    let forward = solve(&shifted, &G.hstack(&identity))?;
    let (AG, inverse) = (forward.block(0, 0, n, n), forward.block(0, n, n, n));
    let W = shifted.t() + Q * &AG;
    let QA = Q * &inverse;
    let right = solve(&W, &QA.hstack(&identity))?;
    let H = right.block(0, 0, n, n).scale(2.0 * gamma);
    let W_inverse = right.block(0, n, n, n);
    let G = (&AG * &W_inverse).scale(2.0 * gamma);
    let A = identity + W_inverse.t().scale(2.0 * gamma);
    Ok(Problem { A, G: G.symmetric_part(), Q: H.symmetric_part() })
}

/// Convergence is quadratic: below this change the next one would be rounding, and Newton steps follow anyhow.
const SETTLED: f64 = 1e-7;

/// Doubles `X = A'X (I + G X)^-1 A + Q` until `Q`, which tends to `X`, stands still.
pub(super) fn run(mut form: Problem) -> Option<Mat> {
    let n = form.A.nrows();
    for _ in 0..DOUBLING_STEPS {
        let middle = Mat::eye(n) + &form.G * &form.Q;
        // Both parts of the next form, (I + G Q)^-1 [A, G].
        let solved = solve(&middle, &form.A.hstack(&form.G)).ok()?;
        let transposed = form.A.t();
        let step = (&transposed * (&form.Q * &solved.block(0, 0, n, n))).symmetric_part();
        form.Q += &step;
        let change = step.norm_fro() / form.Q.norm_fro().max(f64::MIN_POSITIVE);
        if !change.is_finite() {
            return None;
        }
        if change < SETTLED {
            return Some(form.Q);
        }
        let moved = &form.A * &solved;
        form.G += &(&moved.block(0, n, n, n) * &transposed).symmetric_part();
        form.A = moved.block(0, 0, n, n);
    }
    None
}
