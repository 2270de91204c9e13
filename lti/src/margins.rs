//! Stability margins of a loop with one input and one output: every crossing, the peaks, the disk, the delay.

use std::f64::consts::PI;

use crate::connect::feedback;
use crate::peak::Peak;
use crate::response::Point;
use crate::roots::{is_stable_pole, poles};
use crate::scan::Scan;
use crate::tolerance::{CERTAIN_SIGN, NEGLIGIBLE_GAIN, REAL_CROSSING, UNIT_CROSSING};
use crate::zpk::needs_siso;
use crate::{C64, Error, Mat, StateSpace, Timebase, response};

/// Effect of a change of gain at a crossing of the negative real axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GainChange {
    /// The loop reaches the critical point when its gain rises by the factor (above one).
    Increase,
    /// The loop reaches the critical point when its gain falls to the factor (below one).
    Decrease,
}

/// A crossing of the negative real axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GainMargin {
    /// -1 / L: the loop times this passes through -1.
    pub factor: f64,
    /// The factor in dB; negative for a decrease.
    pub db: f64,
    /// Frequency in rad/s; 0, pi/T or infinite for a crossing at the end of the axis.
    pub rate_rad_s: f64,
    /// Direction of the change.
    pub change: GainChange,
}

/// A crossing of the unit circle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhaseMargin {
    /// The angle of L above -180 degrees, between -180 and 180 degrees.
    pub deg: f64,
    /// Frequency in rad/s.
    pub rate_rad_s: f64,
    /// The added delay in seconds that turns L onto -1.
    pub delay_s: f64,
}

/// Gain and phase that may vary together (disk margin without skew, Seiler, Packard and Gahinet 2020).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiskMargin {
    /// Size of the disk: the reciprocal of the peak of (S - T)/2; 2 or more means any gain and 90 degrees.
    pub alpha: f64,
    /// Gain may fall to this, alone.
    pub lowest_gain: f64,
    /// Gain may rise to this, alone.
    pub highest_gain: f64,
    /// Phase may vary by this either way, alone, in degrees.
    pub phase_deg: f64,
    /// Frequency in rad/s at which the disk touches.
    pub rate_rad_s: f64,
}

/// All margins of a loop under negative unit feedback. They are margins only where the closed loop is stable.
#[derive(Debug, Clone, PartialEq)]
pub struct Margins {
    /// Every crossing of the negative real axis, by frequency.
    pub gain: Vec<GainMargin>,
    /// Every crossing of the unit circle, by frequency.
    pub phase: Vec<PhaseMargin>,
    /// Smallest added delay in seconds that reaches the critical point; infinite without a crossing.
    pub delay_s: f64,
    /// `true` if the gain is one at all frequencies, to rounding: there are no crossings, and every frequency reaches the critical point by some delay.
    pub is_all_pass: bool,
    /// Peak of the sensitivity S = 1/(1 + L).
    pub ms: Peak,
    /// Peak of the complementary sensitivity T = L/(1 + L).
    pub mt: Peak,
    /// The disk margin.
    pub disk: DiskMargin,
    /// `true` if every closed-loop pole is stable.
    pub closed_loop_stable: bool,
    /// The closed-loop pole that is nearest to, or farthest beyond, the border of stability; `None` for a loop with a delay, which
    /// has infinitely many.
    pub critical_pole: Option<C64>,
}

/// The margins that one of many loops is judged by, under negative unit feedback. They are margins only where the closed loop is stable.
#[derive(Debug, Clone, PartialEq)]
pub struct CandidateMargins {
    /// Every crossing of the negative real axis, by frequency.
    pub gain: Vec<GainMargin>,
    /// Every crossing of the unit circle, by frequency.
    pub phase: Vec<PhaseMargin>,
    /// Peak of the sensitivity S = 1/(1 + L).
    pub ms: Peak,
}

impl CandidateMargins {
    /// Returns the gain margin nearest to one either way, in dB without sign; infinite if nothing crosses.
    pub fn gain_margin_db(&self) -> f64 {
        nearest_gain_db(&self.gain)
    }

    /// Returns the phase margin of smallest size, if the loop gain crosses one.
    pub fn phase_margin(&self) -> Option<&PhaseMargin> {
        smallest_phase(&self.phase)
    }
}

fn nearest_gain_db(margins: &[GainMargin]) -> f64 {
    margins.iter().map(|margin| margin.db.abs()).fold(f64::INFINITY, f64::min)
}

fn smallest_phase(margins: &[PhaseMargin]) -> Option<&PhaseMargin> {
    margins.iter().min_by(|a, b| a.deg.abs().total_cmp(&b.deg.abs()))
}

impl Margins {
    /// Returns the margins that a response shows; whether the closed loop is stable is not known yet.
    pub(crate) fn of_scan(scan: &Scan, gain: Vec<GainMargin>, phase: Vec<PhaseMargin>) -> Self {
        let is_all_pass = scan.is_all_pass();
        let reaching = scan.points.iter().filter(|_| is_all_pass).filter(|point| point.rate > 0.0);
        let delays = phase.iter().map(|margin| margin.delay_s);
        Self {
            delay_s: delays
                .chain(reaching.map(|point| lag(*point) / point.rate))
                .fold(f64::INFINITY, f64::min),
            is_all_pass,
            ms: sensitivity_peak(scan),
            mt: or_at_rest(scan, 1.0, peak(scan, |L| L.norm() / (L + 1.0).norm())),
            disk: disk(scan),
            closed_loop_stable: false,
            critical_pole: None,
            gain,
            phase,
        }
    }

    /// Returns the margins with the peaks of a scan's points as they are, without those between them.
    pub(crate) fn of_points(scan: &Scan, phase: Vec<PhaseMargin>) -> Self {
        let highest = |of: fn(C64) -> f64| {
            let peaks =
                scan.points.iter().map(|point| Peak { value: of(point.value), rate_rad_s: point.rate });
            peaks.max_by(|a, b| a.value.total_cmp(&b.value)).unwrap_or(Peak { value: 0.0, rate_rad_s: 0.0 })
        };
        Self {
            delay_s: phase.iter().map(|margin| margin.delay_s).fold(f64::INFINITY, f64::min),
            is_all_pass: scan.is_all_pass(),
            ms: highest(|L| 1.0 / (L + 1.0).norm()),
            mt: or_at_rest(scan, 1.0, highest(|L| L.norm() / (L + 1.0).norm())),
            disk: DiskMargin::of(or_at_rest(
                scan,
                0.5,
                highest(|L| 0.5 * (L - 1.0).norm() / (L + 1.0).norm()),
            )),
            closed_loop_stable: false,
            critical_pole: None,
            gain: Vec::new(),
            phase,
        }
    }

    /// Returns the smallest increase of gain, if any reaches the critical point.
    pub fn gain_increase(&self) -> Option<&GainMargin> {
        let upward = self.gain.iter().filter(|margin| margin.change == GainChange::Increase);
        upward.min_by(|a, b| a.factor.total_cmp(&b.factor))
    }

    /// Returns the smallest decrease of gain, if any reaches the critical point.
    pub fn gain_decrease(&self) -> Option<&GainMargin> {
        let downward = self.gain.iter().filter(|margin| margin.change == GainChange::Decrease);
        downward.max_by(|a, b| a.factor.total_cmp(&b.factor))
    }

    /// Returns the gain margin nearest to one either way, in dB without sign; infinite if nothing crosses.
    pub fn gain_margin_db(&self) -> f64 {
        nearest_gain_db(&self.gain)
    }

    /// Returns the phase margin of smallest size, if the loop gain crosses one.
    pub fn phase_margin(&self) -> Option<&PhaseMargin> {
        smallest_phase(&self.phase)
    }
}

/// Returns the margins of L in the loop 1/(1 + L).
///
/// The response is evaluated on a grid that starts from all poles and zeros and is refined until neighbours agree within
/// a quarter of the distance to the critical point (three percent near the unit circle and the negative axis); each
/// change of sign is then closed in on to the last bit. Sampled loops are evaluated on the unit circle, up to and with
/// half the sampling rate.
///
/// # Errors
/// [`Error::NotSiso`]; [`Error::AlgebraicLoop`] if 1 + L(infinity) = 0.
pub fn margins(loop_gain: &StateSpace) -> Result<Margins, Error> {
    needs_siso("margins", loop_gain)?;
    margins_on(Scan::of(loop_gain)?, loop_gain)
}

/// Returns the margins of a loop that is shown while it is changed: those of [`margins`], on the grid of [`candidate_margins`], so the answers
/// differ by rounding and two crossings that are close together may be missed where their margin is more than 26 dB.
///
/// # Errors
/// Those of [`margins`].
pub fn provisional_margins(loop_gain: &StateSpace) -> Result<Margins, Error> {
    needs_siso("margins", loop_gain)?;
    margins_on(Scan::of_candidate(loop_gain)?, loop_gain)
}

/// Returns the margins that a scan of a loop closes in on.
fn margins_on(mut scan: Scan, loop_gain: &StateSpace) -> Result<Margins, Error> {
    let unit = StateSpace::gain(Mat::eye(1), loop_gain.timebase)?;
    let closed_poles = poles(&feedback(loop_gain, &unit)?)?;
    let (gain, phase) = crossings(&mut scan, loop_gain);
    Ok(Margins {
        closed_loop_stable: closed_poles.iter().all(|&pole| is_stable_pole(pole, loop_gain.timebase)),
        critical_pole: Some(critical(&closed_poles, loop_gain.timebase)),
        ..Margins::of_scan(&scan, gain, phase)
    })
}

/// Returns the margins of one of many loops that are compared: crossings and the sensitivity's peak as [`margins`] closes in on them, on a
/// grid that starts from zeros without the correction in 32 digits, so the answers differ by rounding. A loop with double zeros, as the
/// bilinear map makes them at half the sampling rate, takes a hundredth of the time. Of crossings of the negative axis with a margin of more
/// than 26 dB, two that are close together may be missed. Whether the closed loop is stable is left to the caller.
///
/// # Errors
/// [`Error::NotSiso`].
pub fn candidate_margins(loop_gain: &StateSpace) -> Result<CandidateMargins, Error> {
    needs_siso("margins", loop_gain)?;
    let mut scan = Scan::of_candidate(loop_gain)?;
    let (gain, phase) = crossings(&mut scan, loop_gain);
    Ok(CandidateMargins { ms: sensitivity_peak(&scan), gain, phase })
}

/// Returns the largest sensitivity of one of many loops that are compared: that of [`candidate_margins`], without its crossings.
///
/// # Errors
/// [`Error::NotSiso`].
pub fn candidate_sensitivity(loop_gain: &StateSpace) -> Result<Peak, Error> {
    needs_siso("margins", loop_gain)?;
    let mut scan = Scan::of_candidate(loop_gain)?;
    scan.points.extend(ends(loop_gain));
    scan.points.sort_by(|a, b| a.rate.total_cmp(&b.rate));
    Ok(sensitivity_peak(&scan))
}

/// Returns the crossings of the negative real axis and of the unit circle; the ends of the axis are added to
/// the scan.
fn crossings(scan: &mut Scan, loop_gain: &StateSpace) -> (Vec<GainMargin>, Vec<PhaseMargin>) {
    let ends = ends(loop_gain);
    let phase = phase_margins(scan);
    let gain = gain_margins(scan, &ends);
    scan.points.extend(&ends);
    scan.points.sort_by(|a, b| a.rate.total_cmp(&b.rate));
    (gain, phase)
}

/// Returns the loop at zero frequency and at the upper end of the axis, where it is finite there.
fn ends(g: &StateSpace) -> Vec<Point> {
    let mut ends = Vec::new();
    let mut add = |rate: f64, value: Option<C64>| ends.extend(value.map(|value| Point { rate, value }));
    let at = |rate: f64| response::response_at(g, rate).ok().map(|H| H[(0, 0)]);
    add(0.0, at(0.0));
    match g.timebase {
        Timebase::Continuous => add(f64::INFINITY, Some(C64::new(g.D[(0, 0)], 0.0))),
        Timebase::Discrete { period_s } => add(PI / period_s, at(PI / period_s)),
    }
    ends
}

/// Returns the crossings of the negative real axis on a scan and at the ends of the axis. Where the loop is zero to rounding it crosses
/// nothing: half the sampling rate is such a place after the bilinear map, and so is an undamped antiresonance.
pub(crate) fn gain_margins(scan: &Scan, ends: &[Point]) -> Vec<GainMargin> {
    let largest = scan.points.iter().map(|point| point.value.norm()).fold(0.0, f64::max);
    let is_certain = |end: &&Point| match end.rate.is_finite() {
        true => end.value.norm() > CERTAIN_SIGN * scan.rounding_at(**end),
        false => end.value.norm() > NEGLIGIBLE_GAIN * largest,
    };
    let mut crossings = scan.axis_crossings();
    crossings.extend(ends.iter().filter(is_certain));
    if crossings.iter().all(|point| point.rate != 0.0) {
        crossings.extend(scan.limit_at_rest());
    }
    crossings.retain(|point| point.value.re < 0.0 && point.value.im.abs() <= REAL_CROSSING * -point.value.re);
    crossings.sort_by(|a, b| a.rate.total_cmp(&b.rate));
    let margin = |point: &Point| {
        let factor = -1.0 / point.value.re;
        let change = if factor > 1.0 { GainChange::Increase } else { GainChange::Decrease };
        GainMargin { factor, db: 20.0 * factor.log10(), rate_rad_s: point.rate, change }
    };
    crossings.iter().map(margin).collect()
}

pub(crate) fn phase_margins(scan: &Scan) -> Vec<PhaseMargin> {
    delayed_phase_margins(scan, 0.0)
}

/// Returns the crossings of the unit circle behind a delay in seconds, which moves none of them.
pub(crate) fn delayed_phase_margins(scan: &Scan, delay_s: f64) -> Vec<PhaseMargin> {
    if scan.is_all_pass() {
        return Vec::new();
    }
    let crossings = scan.unit_crossings().into_iter();
    let real = crossings.filter(|point| (point.value.norm() - 1.0).abs() <= UNIT_CROSSING);
    let margin = |point: Point| {
        let turned = Point { value: point.value * C64::from_polar(1.0, -point.rate * delay_s), ..point };
        let deg = (-turned.value).arg().to_degrees();
        PhaseMargin { deg, rate_rad_s: point.rate, delay_s: lag(turned) / point.rate }
    };
    real.map(margin).collect()
}

/// Returns the angle, from 0 to 2 pi, by which a response is to be turned back onto the negative axis.
fn lag(point: Point) -> f64 {
    let angle = (-point.value).arg();
    if angle < 0.0 { angle + 2.0 * PI } else { angle }
}

pub(crate) fn peak(scan: &Scan, of: impl Fn(C64) -> f64) -> Peak {
    let found = scan.maximum(&of);
    found.map_or(Peak { value: 0.0, rate_rad_s: 0.0 }, |p| Peak { value: of(p.value), rate_rad_s: p.rate })
}

/// Returns a peak, or the limit that the function has where the gain is infinite at rest, if that is larger.
fn or_at_rest(scan: &Scan, limit: f64, found: Peak) -> Peak {
    if scan.is_infinite_at_rest() && limit > found.value {
        return Peak { value: limit, rate_rad_s: 0.0 };
    }
    found
}

fn sensitivity_peak(scan: &Scan) -> Peak {
    peak(scan, |L| 1.0 / (L + 1.0).norm())
}

pub(crate) fn disk(scan: &Scan) -> DiskMargin {
    DiskMargin::of(or_at_rest(scan, 0.5, peak(scan, |L| 0.5 * (L - 1.0).norm() / (L + 1.0).norm())))
}

impl DiskMargin {
    /// Returns the margin that belongs to a peak of (S - T)/2.
    pub(crate) fn of(peak: Peak) -> Self {
        let alpha = 1.0 / peak.value;
        let highest_gain = if alpha < 2.0 { (2.0 + alpha) / (2.0 - alpha) } else { f64::INFINITY };
        let lowest_gain = if alpha < 2.0 { 1.0 / highest_gain } else { 0.0 };
        let phase_deg = 2.0 * (0.5 * alpha).atan().to_degrees();
        Self { alpha, lowest_gain, highest_gain, phase_deg, rate_rad_s: peak.rate_rad_s }
    }
}

/// Returns the pole nearest to or farthest beyond the border.
fn critical(poles: &[C64], timebase: Timebase) -> C64 {
    let size = |pole: &C64| if timebase == Timebase::Continuous { pole.re } else { pole.norm() };
    poles.iter().max_by(|a, b| size(a).total_cmp(&size(b))).copied().unwrap_or_default()
}
