//! The paths of the closed loop's poles while its gain varies.

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{StateSpace, poles, zeros};

use crate::Error;
use crate::tolerance::{
    LOCUS_GAIN_RATIO, LOCUS_GAINS_PER_DECADE, LOCUS_STEP, MOST_LOCUS_GAINS, NEAREST_POLE,
};

/// The poles of 1 + k L over the gain k: for k = 0 those of L, for k = 1 those of the loop as it is; for large k they end in the zeros
/// of L or leave.
#[derive(Debug, Clone, PartialEq)]
pub struct RootLocus {
    /// Sample period, s.
    pub sample_period_s: f64,
    /// Gains, rising from [`LEAST_GAIN`] to its reciprocal; 1 is among them.
    pub gains: Vec<f64>,
    /// One branch a pole, one point a gain, in the z-plane.
    pub branches: Vec<Vec<C64>>,
    /// Poles of the open loop, in the z-plane.
    pub open_poles: Vec<C64>,
    /// Finite zeros of the open loop, in the z-plane.
    pub open_zeros: Vec<C64>,
    /// Poles of the closed loop at k = 1, in the z-plane.
    pub closed_poles: Vec<C64>,
}

/// The smallest gain of a root locus; its reciprocal is the largest.
pub const LEAST_GAIN: f64 = 1e-2;

/// A root locus at the equivalents of poles and zeros in continuous time, ln(z)/T in rad/s. A zero or pole at z = 0 has none.
#[derive(Debug, Clone, PartialEq)]
pub struct ContinuousLocus {
    /// One branch a pole. A point that is not a number breaks the curve: at z = 0, and where a branch passes the negative real axis of the z-plane
    /// and its equivalent jumps to the other side.
    pub branches: Vec<Vec<C64>>,
    /// Poles of the open loop.
    pub open_poles: Vec<C64>,
    /// Finite zeros of the open loop.
    pub open_zeros: Vec<C64>,
    /// Poles of the closed loop.
    pub closed_poles: Vec<C64>,
}

/// A root locus is shown up to this many crossover frequencies from the origin.
pub const LOCUS_CROSSOVERS: f64 = 5.0;

impl RootLocus {
    /// Returns the locus in the s-plane.
    pub fn convert_to_continuous(&self) -> ContinuousLocus {
        let equivalent = |z: &C64| continuous_equivalent(*z, self.sample_period_s);
        let all = |places: &[C64]| places.iter().filter_map(equivalent).collect();
        let point = |z: &C64| equivalent(z).unwrap_or(BREAK);
        ContinuousLocus {
            branches: self.branches.iter().map(|branch| with_breaks(branch.iter().map(point))).collect(),
            open_poles: all(&self.open_poles),
            open_zeros: all(&self.open_zeros),
            closed_poles: all(&self.closed_poles),
        }
    }
}

const BREAK: C64 = C64::new(f64::NAN, f64::NAN);

/// Returns the equivalent in the s-plane of a pole or zero in the z-plane, ln(z)/T in rad/s; `None` at z = 0, which has none.
pub fn continuous_equivalent(z: C64, sample_period_s: f64) -> Option<C64> {
    (z.norm() > 0.0).then(|| z.ln() / sample_period_s)
}

/// The points with a break where a branch reaches the negative real axis of the z-plane and its equivalent jumps to the other side.
fn with_breaks(points: impl Iterator<Item = C64>) -> Vec<C64> {
    let mut all: Vec<C64> = Vec::new();
    for at in points {
        let jumps = all.last().is_some_and(|last| {
            last.im * at.im < 0.0 && (last.im - at.im).abs() > 0.5 * last.norm().max(at.norm())
        });
        if jumps {
            all.push(BREAK);
        }
        all.push(at);
    }
    all
}

/// Returns the root locus of a sampled loop L under negative feedback:
///
/// ```text
///     poles of x' = (A - k B (1 + k D)^-1 C) x,      k from 0.01 to 100
/// ```
///
/// Gains are added where a pole moves far between neighbours, so that branches can be followed.
///
/// # Errors
/// Those of the eigenvalues and of the zeros.
pub fn root_locus(broken: &StateSpace, sample_period_s: f64) -> Result<RootLocus, Error> {
    let closed = |gain: f64| -> Result<Vec<C64>, Error> { Ok(poles(&closed_at(broken, gain))?) };
    let steps = (-2.0 * LEAST_GAIN.log10() * LOCUS_GAINS_PER_DECADE).round() as usize;
    let gain_at = |k: usize| LEAST_GAIN * (-2.0 * LEAST_GAIN.ln() * k as f64 / steps as f64).exp();
    let mut found = vec![Point { gain: LEAST_GAIN, poles: closed(LEAST_GAIN)? }];
    for k in 1..=steps {
        let gain = if 2 * k == steps { 1.0 } else { gain_at(k) };
        follow(&mut found, gain, &closed, MOST_LOCUS_GAINS - (steps - k))?;
    }
    let branch = |j: usize| found.iter().map(|point| point.poles[j]).collect();
    Ok(RootLocus {
        sample_period_s,
        gains: found.iter().map(|point| point.gain).collect(),
        branches: (0..broken.order()).map(branch).collect(),
        open_poles: poles(broken)?,
        open_zeros: zeros(broken)?,
        closed_poles: closed(1.0)?,
    })
}

/// Poles at a gain, in the order of the branches.
struct Point {
    gain: f64,
    poles: Vec<C64>,
}

/// The loop with its gain multiplied by k, closed: only its poles matter.
fn closed_at(broken: &StateSpace, gain: f64) -> StateSpace {
    let mut closed = broken.clone();
    let through = gain / (1.0 + gain * broken.D[(0, 0)]);
    for i in 0..broken.order() {
        for j in 0..broken.order() {
            closed.A[(i, j)] -= through * broken.B[(i, 0)] * broken.C[(0, j)];
        }
    }
    closed.B = Mat::zeros(broken.order(), 1);
    closed
}

/// Goes on to `gain`, with gains between where a pole moves far and less than `most` points are there.
fn follow(
    found: &mut Vec<Point>,
    gain: f64,
    closed: &dyn Fn(f64) -> Result<Vec<C64>, Error>,
    most: usize,
) -> Result<(), Error> {
    let mut ahead = vec![Point { gain, poles: closed(gain)? }];
    while let Some(next) = ahead.pop() {
        let Some(last) = found.last() else { break };
        let matched = in_order(&last.poles, &next.poles);
        // relative to the distance from z = 1, where the slow poles of a loop lie that is sampled fast
        let step = |(a, b): (&C64, &C64)| (a - b).norm() / ((a - 1.0).norm() + NEAREST_POLE);
        let farthest = last.poles.iter().zip(&matched).map(step).fold(0.0, f64::max);
        if farthest > LOCUS_STEP
            && found.len() + ahead.len() < most
            && next.gain > LOCUS_GAIN_RATIO * last.gain
        {
            let between = (last.gain * next.gain).sqrt();
            ahead.push(next);
            ahead.push(Point { gain: between, poles: closed(between)? });
        } else {
            found.push(Point { gain: next.gain, poles: matched });
        }
    }
    Ok(())
}

/// The poles `next` in the order of `last`: the two that are nearest to each other are joined first.
fn in_order(last: &[C64], next: &[C64]) -> Vec<C64> {
    let count = last.len();
    let mut pairs: Vec<[usize; 2]> = (0..count).flat_map(|i| (0..count).map(move |j| [i, j])).collect();
    let apart = |[i, j]: &[usize; 2]| (last[*i] - next[*j]).norm();
    pairs.sort_by(|a, b| apart(a).total_cmp(&apart(b)));
    let (mut matched, mut is_taken) = (vec![None; count], vec![false; count]);
    for [i, j] in pairs {
        if matched[i].is_none() && !is_taken[j] {
            matched[i] = Some(next[j]);
            is_taken[j] = true;
        }
    }
    matched.into_iter().zip(last).map(|(pole, old)| pole.unwrap_or(*old)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn branches_break_where_they_pass_to_the_other_side() {
        let branch = |points: [[f64; 2]; 4]| with_breaks(points.into_iter().map(|[re, im]| C64::new(re, im)));
        let points = branch([[-1.0, 3.0], [-1.0, 3.1], [-1.0, -3.1], [-1.0, -3.0]]);
        assert_eq!(points.len(), 5);
        assert!(points[2].re.is_nan());
        assert_eq!(branch([[-4.0, 0.1], [-4.0, -0.1], [-4.0, -0.2], [-4.0, -0.3]]).len(), 4);
    }
}
