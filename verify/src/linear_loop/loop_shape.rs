//! The loop as a path in the complex plane: for Nyquist and Nichols charts, with the regions that it must avoid.

use counterpoise_linalg::C64;
use counterpoise_lti::{Margins, Response, StateSpace};

use super::root_locus::root_locus;
use super::{Curves, RootLocus};
use crate::tolerance::{LOWEST_PATH_GAIN, MOST_PATH_POINTS, PATH_LOGARITHM, PATH_STEP, SAME_FREQUENCY};
use crate::{Error, LoopFigure, PerformanceFigure, Requirement};

/// The loop broken at the plant's input, as charts of the whole loop show it.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopShape {
    /// Frequency response.
    pub path: LoopPath,
    /// Root locus.
    pub locus: RootLocus,
}

/// A frequency response L(jw) whose neighbours lie so near to each other that straight lines between them look like the curve.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopPath {
    /// Frequencies, Hz.
    pub frequency_hz: Vec<f64>,
    /// L, one value a frequency.
    pub response: Vec<C64>,
}

/// A disk of the plane of L.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disk {
    /// Centre on the real axis.
    pub centre: f64,
    /// Radius.
    pub radius: f64,
}

/// The kind of a margin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MarginKind {
    /// Of the gain, dB.
    Gain,
    /// Of the phase, degrees.
    Phase,
}

/// A margin, with the value of L at which it is read.
#[derive(Debug, Clone, PartialEq)]
pub struct MarginOnPath {
    /// Kind of the margin.
    pub kind: MarginKind,
    /// Size, dB or degrees.
    pub size: f64,
    /// Frequency at which it is read, rad/s.
    pub rate_rad_s: f64,
    /// L there.
    pub response: C64,
}

/// Returns path and root locus of a sampled loop under negative feedback, with its response in `curves`.
///
/// # Errors
/// A response that does not exist because of a pole on the unit circle, and those of the eigenvalues.
pub fn loop_shape(broken: &StateSpace, curves: &Curves, sample_period_s: f64) -> Result<LoopShape, Error> {
    let coarse =
        LoopPath { frequency_hz: curves.frequency_hz.clone(), response: curves.broken.response.clone() };
    Ok(LoopShape { path: loop_path(broken, &coarse)?, locus: root_locus(broken, sample_period_s)? })
}

/// Returns the nearest gain margins, upwards and downwards, and the nearest phase margin; a margin at zero or unbounded frequency is no point of
/// the path.
pub fn margins_on_path(margins: &Margins) -> Vec<MarginOnPath> {
    let gains = [margins.gain_increase(), margins.gain_decrease()].into_iter().flatten();
    let gains =
        gains.filter(|gain| gain.rate_rad_s > 0.0 && gain.rate_rad_s.is_finite()).map(|gain| MarginOnPath {
            kind: MarginKind::Gain,
            size: gain.db,
            rate_rad_s: gain.rate_rad_s,
            response: C64::new(-1.0 / gain.factor, 0.0),
        });
    let phase = margins.phase_margin().map(|phase| MarginOnPath {
        kind: MarginKind::Phase,
        size: phase.deg,
        rate_rad_s: phase.rate_rad_s,
        response: C64::from_polar(1.0, (phase.deg - 180.0).to_radians()),
    });
    gains.chain(phase).collect()
}

/// Returns L at the frequencies of `coarse`, which is a part of the response of `broken`, and between them where L turns fast: neighbours are at most
/// [`PATH_STEP`] apart on the Riemann sphere and [`PATH_LOGARITHM`] in the logarithm, unless the limit of points is reached.
///
/// # Errors
/// A response that does not exist because of a pole on the unit circle.
pub fn loop_path(broken: &StateSpace, coarse: &LoopPath) -> Result<LoopPath, Error> {
    let response = Response::of(broken)?;
    let value = |hz: f64| -> Result<C64, Error> { Ok(response.at(std::f64::consts::TAU * hz)?[(0, 0)]) };
    let known = coarse.frequency_hz.iter().copied().zip(coarse.response.iter().copied());
    let mut ahead: Vec<(f64, C64)> = known.rev().collect();
    let mut path = LoopPath { frequency_hz: Vec::new(), response: Vec::new() };
    while let Some((hz, L)) = ahead.pop() {
        let last = path.frequency_hz.last().copied().zip(path.response.last().copied());
        let room = path.response.len() + ahead.len() < MOST_PATH_POINTS;
        match last.filter(|(before, at)| room && is_far(*at, L) && hz > before * (1.0 + SAME_FREQUENCY)) {
            Some((before, _)) => {
                let between = (before * hz).sqrt();
                ahead.push((hz, L));
                ahead.push((between, value(between)?));
            }
            None => {
                path.frequency_hz.push(hz);
                path.response.push(L);
            }
        }
    }
    Ok(path)
}

/// Returns whether a straight line between two neighbours would show in a Nyquist or in a Nichols chart.
fn is_far(a: C64, b: C64) -> bool {
    let is_seen = a.norm() > LOWEST_PATH_GAIN && b.norm() > LOWEST_PATH_GAIN;
    chordal(a, b) > PATH_STEP || (is_seen && (b / a).ln().norm() > PATH_LOGARITHM)
}

/// The distance of two numbers on the Riemann sphere about -1: large loop gains are all far from the critical point.
fn chordal(a: C64, b: C64) -> f64 {
    let (a, b) = (a + 1.0, b + 1.0);
    2.0 * (a - b).norm() / ((1.0 + a.norm_sqr()) * (1.0 + b.norm_sqr())).sqrt()
}

/// Returns points of the plane of L in a Nichols chart, phase in degrees from -360 up to 0 and modulus in dB, broken where the phase passes from 0 to -360 degrees.
pub fn nichols_points(response: &[C64]) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = Vec::with_capacity(response.len());
    for L in response {
        let deg = L.arg().to_degrees();
        let at = [if deg > 0.0 { deg - 360.0 } else { deg }, 20.0 * L.norm().log10()];
        if points.last().is_some_and(|last| (last[0] - at[0]).abs() > 180.0) {
            points.push([f64::NAN; 2]);
        }
        points.push(at);
    }
    points
}

impl Disk {
    /// Returns the disk that a loop avoids whose sensitivity |1/(1 + L)| stays below `largest`: about -1, with the reciprocal as its radius.
    pub fn of_sensitivity(largest: f64) -> Self {
        Self { centre: -1.0, radius: 1.0 / largest }
    }

    /// Returns the disk that a loop with a disk margin alpha touches: on the real axis from -(2 + alpha)/(2 - alpha) to its reciprocal
    /// (Seiler, Packard and Gahinet 2020). `None` from alpha = 2 on, where it is no disk.
    pub fn of_disk_margin(alpha: f64) -> Option<Self> {
        let highest = (2.0 + alpha) / (2.0 - alpha);
        let (left, right) = (-highest, -1.0 / highest);
        let disk = Self { centre: 0.5 * (left + right), radius: 0.5 * (right - left) };
        (alpha > 0.0 && alpha < 2.0).then_some(disk)
    }

    /// Returns its edge as a closed line.
    pub fn edge(&self) -> Vec<C64> {
        const CORNERS: u32 = 180;
        let at = |k| C64::from_polar(self.radius, std::f64::consts::TAU * f64::from(k) / f64::from(CORNERS));
        (0..=CORNERS).map(|k| at(k) + self.centre).collect()
    }
}

/// The sensitivity that charts take as the largest wanted where no requirement names one: 6 dB (Astrom and Hagglund,
/// *Advanced PID Control*, 2006, section 4.6).
pub const USUAL_SENSITIVITY: f64 = 2.0;

/// Returns the largest sensitivity that the requirements allow, or the usual one.
pub fn largest_sensitivity(requirements: &[Requirement]) -> f64 {
    let limit = |requirement: &Requirement| {
        (requirement.figure == PerformanceFigure::Loop(LoopFigure::MaxSensitivity))
            .then(|| requirement.limit.value())
    };
    requirements.iter().find_map(limit).filter(|ms| *ms > 1.0).unwrap_or(USUAL_SENSITIVITY)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_edge_of_a_disk_has_its_sensitivity_and_its_disk_margin() {
        for L in Disk::of_sensitivity(1.6).edge() {
            assert!((1.0 / (L + 1.0).norm() - 1.6).abs() < 1e-9);
        }
        // at the edge |S - T| / 2 is 1 / alpha
        let touching = Disk::of_disk_margin(0.8).map_or(Vec::new(), |disk| disk.edge());
        assert_eq!(touching.len(), 181);
        for L in touching {
            let half = 0.5 * ((C64::new(1.0, 0.0) - L) / (L + 1.0)).norm();
            assert!((half - 1.0 / 0.8).abs() < 1e-9, "{half}");
        }
        assert_eq!(Disk::of_disk_margin(2.0), None);
    }

    #[test]
    fn the_phase_of_a_nichols_chart_breaks_where_it_passes_zero() {
        let turning: Vec<C64> = (0..8).map(|k| C64::from_polar(2.0, 0.3 - 0.2 * f64::from(k))).collect();
        let points = nichols_points(&turning);
        assert_eq!(points.iter().filter(|p| p[0].is_nan()).count(), 1);
        assert!(points.iter().all(|p| p[0].is_nan() || (-360.0..=0.0).contains(&p[0])));
    }
}
