//! Disk margins of several loops: each alone, all at once and independently (diagonal), and with coupling (full).
//!
//! Source: Seiler, Packard and Gahinet, An introduction to disk margins, IEEE Control Systems 40 (2020), without skew: every loop
//! passes through (2 + d)/(2 - d), and the closed loop stays stable for all perturbations smaller than the margin.

use crate::connect::feedback;
use crate::error::OperationContext;
use crate::margins::DiskMargin;
use crate::norms::{linfnorm, linfnorm_bounds};
use crate::peak::Peak;
use crate::response::Response;
use crate::roots::{is_stable, poles};
use crate::tolerance::{
    GOLDEN_STEPS, HIGH_SUMMIT, MULTILOOP_BEYOND, MULTILOOP_NORM, MULTILOOP_PER_DECADE, MULTILOOP_ROUNDS,
    MULTILOOP_SETTLED, MULTILOOP_SWEEPS,
};
use crate::{CMat, Error, Mat, StateSpace, Timebase};
use counterpoise_linalg as linalg;

/// The margins of a loop with several channels under negative unit feedback.
#[derive(Debug, Clone, PartialEq)]
pub struct MultiloopMargins {
    /// Each channel alone, the others closed as they are.
    pub each: Vec<DiskMargin>,
    /// All channels vary independently. Computed frequency by frequency from scaled norms: exact for up to three channels, on the safe
    /// side for more; between the frequencies of the refined grid it is an estimate.
    pub diagonal: DiskMargin,
    /// A margin of independent variations that is proved: from the norm over all frequencies with constant scales. At most `diagonal`.
    pub diagonal_proved: DiskMargin,
    /// All channels vary, coupled in any way. Proved: from an upper bound of the norm.
    pub full: DiskMargin,
    /// `true` if the closed loop is stable; without that there are no margins.
    pub closed_loop_stable: bool,
}

/// Returns the disk margins of L with as many outputs as inputs.
///
/// # Errors
/// [`Error::Shape`] if L is not square, [`Error::AlgebraicLoop`] if I + L(infinity) is singular, and those of [`linfnorm`].
pub fn multiloop_margins(loop_gain: &StateSpace) -> Result<MultiloopMargins, Error> {
    let m = loop_gain.inputs();
    if loop_gain.outputs() != m || m == 0 {
        let found = (loop_gain.outputs(), m);
        return Err(Error::Shape { what: "loop", found, expected: (m.max(1), m.max(1)) });
    }
    // (S - T)/2 = S - I/2.
    let unit = StateSpace::gain(Mat::eye(m), loop_gain.timebase)?;
    let mut half = feedback(&unit, loop_gain)?;
    half.D -= &Mat::eye(m).scale(0.5);
    let each = (0..m).map(|k| Ok(DiskMargin::of(linfnorm(&channel(&half, k)?, MULTILOOP_NORM)?)));
    let each: Result<Vec<DiskMargin>, Error> = each.collect();
    let full = proved_margin(&half)?;
    let structured = structured_margin(&half)?;
    let scaled = half.scale_io(&structured.scales, &inverses(&structured.scales))?;
    let constant = proved_margin(&scaled)?;
    let diagonal_proved = if constant.alpha > full.alpha { constant } else { full };
    let diagonal = DiskMargin::of(structured.peak);
    Ok(MultiloopMargins {
        each: each?,
        diagonal: if diagonal.alpha < diagonal_proved.alpha { diagonal_proved } else { diagonal },
        diagonal_proved,
        full,
        closed_loop_stable: is_stable(&half)?,
    })
}

/// Returns the margin that belongs to an upper bound of the norm.
fn proved_margin(g: &StateSpace) -> Result<DiskMargin, Error> {
    let bounds = linfnorm_bounds(g, MULTILOOP_NORM)?;
    Ok(DiskMargin::of(Peak { value: bounds.upper, ..bounds.lower }))
}

/// Returns one diagonal channel.
fn channel(g: &StateSpace, k: usize) -> Result<StateSpace, Error> {
    let n = g.order();
    let D = Mat::eye(1).scale(g.D[(k, k)]);
    StateSpace::new(g.A.clone(), g.B.block(0, k, n, 1), g.C.block(k, 0, 1, n), D, g.timebase)
}

fn inverses(scales: &[f64]) -> Vec<f64> {
    scales.iter().map(|d| 1.0 / d).collect()
}

/// The peak over frequency of the smallest scaled norm, and the scales there.
struct ScaledPeak {
    peak: Peak,
    scales: Vec<f64>,
}

fn structured_margin(g: &StateSpace) -> Result<ScaledPeak, Error> {
    let response = Response::of(g)?;
    let rates = grid(g)?;
    let mut values = Vec::with_capacity(rates.len());
    for H in response.at_all(&rates)? {
        values.push(smallest_norm(&H)?);
    }
    let value = |k: usize| values[k].norm;
    let best = (0..rates.len()).max_by(|&a, &b| value(a).total_cmp(&value(b))).unwrap_or(0);
    let direct = smallest_norm(&g.D.to_complex())?;
    let mut out =
        ScaledPeak { peak: Peak { value: direct.norm, rate_rad_s: f64::INFINITY }, scales: direct.scales };
    let near = |k: &usize| value(*k) >= HIGH_SUMMIT * value(best) && is_summit(&values, *k);
    for k in (0..rates.len()).filter(near) {
        let ends = [rates[k.saturating_sub(1)], rates[(k + 1).min(rates.len() - 1)]];
        let top = ScaledPeak {
            peak: Peak { value: values[k].norm, rate_rad_s: rates[k] },
            scales: values[k].scales.clone(),
        };
        let top = climb(&response, ends, top)?;
        if top.peak.value > out.peak.value {
            out = top;
        }
    }
    Ok(out)
}

fn is_summit(values: &[ScaledNorm], k: usize) -> bool {
    let next = values.get(k + 1).map_or(0.0, |value| value.norm);
    values[k].norm >= values[k.saturating_sub(1)].norm && values[k].norm >= next
}

/// Returns the top of the hill between two frequencies.
fn climb(
    response: &Response,
    [mut low, mut high]: [f64; 2],
    mut top: ScaledPeak,
) -> Result<ScaledPeak, Error> {
    for _ in 0..MULTILOOP_ROUNDS {
        let rates: Vec<f64> = (1..8).map(|k| low + (high - low) * f64::from(k) / 8.0).collect();
        for (H, &rate_rad_s) in response.at_all(&rates)?.iter().zip(&rates) {
            let ScaledNorm { norm: value, scales } = smallest_norm(H)?;
            if value > top.peak.value {
                top = ScaledPeak { peak: Peak { value, rate_rad_s }, scales };
            }
        }
        let below = rates.iter().copied().filter(|&rate| rate < top.peak.rate_rad_s);
        let above = rates.iter().copied().filter(|&rate| rate > top.peak.rate_rad_s);
        (low, high) = (below.fold(low, f64::max), above.fold(high, f64::min));
    }
    Ok(top)
}

/// Returns frequencies over all poles of the closed loop.
fn grid(g: &StateSpace) -> Result<Vec<f64>, Error> {
    let mut roots = poles(g)?;
    let mut highest = f64::INFINITY;
    if let Timebase::Discrete { period_s } = g.timebase {
        roots.iter_mut().for_each(|root| *root = root.ln() / period_s);
        highest = std::f64::consts::PI / period_s;
    }
    let sizes: Vec<f64> = roots.iter().map(|root| root.norm()).filter(|size| size.is_normal()).collect();
    let low = sizes.iter().copied().fold(f64::INFINITY, f64::min).min(highest);
    let high = sizes.iter().copied().fold(0.0, f64::max);
    let (low, high) = if high > 0.0 {
        (low / MULTILOOP_BEYOND, (high * MULTILOOP_BEYOND).min(highest))
    } else {
        (0.1, 1.0)
    };
    let count = ((high / low).log10() * MULTILOOP_PER_DECADE).ceil().clamp(1.0, 4000.0) as usize;
    let mut rates: Vec<f64> = (0..=count).map(|k| low * (high / low).powf(k as f64 / count as f64)).collect();
    for root in roots.iter().filter(|root| root.im > 0.0) {
        rates.extend([root.im, root.norm(), root.im - root.re.abs(), root.im + root.re.abs()]);
    }
    rates.push(0.0);
    rates.retain(|rate| *rate >= 0.0 && *rate <= highest);
    rates.sort_by(f64::total_cmp);
    rates.dedup();
    Ok(rates)
}

/// A largest singular value of D H D^-1, and the diagonal of D.
struct ScaledNorm {
    norm: f64,
    scales: Vec<f64>,
}

/// Returns the smallest largest singular value of D H D^-1 over positive diagonal D, and D. The norm is convex in the
/// logarithms of D (Sezginer and Overton 1990), which are searched one after the other.
fn smallest_norm(H: &CMat) -> Result<ScaledNorm, Error> {
    let m = H.nrows();
    let mut logs = osborne(H);
    let norm = |logs: &[f64]| -> Result<f64, Error> {
        let scaled = CMat::from_fn(m, m, |i, j| H[(i, j)] * (logs[i] - logs[j]).exp());
        let values = linalg::csingular_values(&scaled).with_operation("disk margin")?;
        Ok(values.first().copied().unwrap_or(0.0))
    };
    let mut best = norm(&logs)?;
    if m == 1 || best == 0.0 {
        return Ok(ScaledNorm { norm: best, scales: vec![1.0; m] });
    }
    let mut width = 1.0;
    for _ in 0..MULTILOOP_SWEEPS {
        let before = best;
        for k in 1..m {
            best = golden(&norm, &mut logs, k, width)?.min(best);
        }
        if m == 2 || before - best <= MULTILOOP_SETTLED * before {
            break;
        }
        width *= 0.5;
    }
    Ok(ScaledNorm { norm: norm(&logs)?, scales: logs.iter().map(|log| log.exp()).collect() })
}

/// Searches the logarithm of one scale within a width of where it is; returns the norm there.
fn golden(
    norm: &impl Fn(&[f64]) -> Result<f64, Error>,
    logs: &mut [f64],
    k: usize,
    width: f64,
) -> Result<f64, Error> {
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let centre = logs[k];
    let (mut low, mut high) = (centre - width, centre + width);
    let mut at = |place: f64| {
        logs[k] = place;
        norm(logs)
    };
    let mut inner = [high - ratio * (high - low), low + ratio * (high - low)];
    let mut values = [at(inner[0])?, at(inner[1])?];
    for _ in 0..GOLDEN_STEPS {
        if values[0] <= values[1] {
            (high, inner[1], values[1]) = (inner[1], inner[0], values[0]);
            inner[0] = high - ratio * (high - low);
            values[0] = at(inner[0])?;
        } else {
            (low, inner[0], values[0]) = (inner[0], inner[1], values[1]);
            inner[1] = low + ratio * (high - low);
            values[1] = at(inner[1])?;
        }
    }
    at(0.5 * (low + high))
}

/// Logarithms of scales that make rows and columns of one size (Osborne 1960): near the best ones.
fn osborne(H: &CMat) -> Vec<f64> {
    let m = H.nrows();
    let mut logs = vec![0.0_f64; m];
    for _ in 0..20 {
        for k in 0..m {
            let size = |i: usize, j: usize| (H[(i, j)].norm() * (logs[i] - logs[j]).exp()).powi(2);
            let row: f64 = (0..m).filter(|&j| j != k).map(|j| size(k, j)).sum();
            let column: f64 = (0..m).filter(|&i| i != k).map(|i| size(i, k)).sum();
            if row > 0.0 && column > 0.0 {
                logs[k] += 0.25 * (column / row).ln();
            }
        }
    }
    let first = logs.first().copied().unwrap_or(0.0);
    logs.iter_mut().for_each(|log| *log -= first);
    logs
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::C64;

    /// Returns the spinning satellite of Doyle: good margins loop by loop, poor ones together.
    fn satellite() -> StateSpace {
        let a = 10.0;
        let A = Mat::from_rows(&[&[0.0, a], &[-a, 0.0]]);
        let C = Mat::from_rows(&[&[1.0, a], &[-a, 1.0]]);
        StateSpace::new(A, Mat::eye(2), C, Mat::zeros(2, 2), Timebase::Continuous).unwrap()
    }

    #[test]
    fn the_spinning_satellite_is_weaker_with_both_loops() {
        let found = multiloop_margins(&satellite()).unwrap();
        assert!(found.closed_loop_stable);
        // One loop at a time is 1/s; S - T = (s - 1)/(s + 1): margin 2.
        assert!(found.each.iter().all(|margin| (margin.alpha - 2.0).abs() < 1e-6), "{:?}", found.each);
        assert!((found.diagonal.alpha - 0.0997).abs() < 2e-4, "{:?}", found.diagonal);
        assert!(found.full.alpha <= found.diagonal_proved.alpha * (1.0 + 1e-9));
        assert!(found.diagonal_proved.alpha <= found.diagonal.alpha * (1.0 + 1e-9));
    }

    #[test]
    fn loops_that_do_not_meet_have_the_smallest_margin_of_each() {
        let poles = Mat::diag(&[-1.0, -3.0]);
        let C = Mat::from_rows(&[&[4.0, 0.0], &[0.0, 20.0]]);
        let g = StateSpace::new(poles, Mat::eye(2), C, Mat::zeros(2, 2), Timebase::Continuous).unwrap();
        let found = multiloop_margins(&g).unwrap();
        let least = found.each.iter().map(|margin| margin.alpha).fold(f64::INFINITY, f64::min);
        assert!((found.diagonal.alpha / least - 1.0).abs() < 1e-6, "{found:?}");
        assert!((found.full.alpha / least - 1.0).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn the_scaled_norm_of_a_triangular_matrix_is_its_spectral_radius() {
        let H = CMat::from_fn(2, 2, |i, j| C64::new([[0.5, 1e3], [0.0, -0.7]][i][j], 0.0));
        let value = smallest_norm(&H).unwrap().norm;
        assert!((0.7..1e3).contains(&value));
    }
}
