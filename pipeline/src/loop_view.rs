//! The loop that was verified, as Nichols, Nyquist and root-locus charts show it: every point of them.

use std::f64::consts::TAU;

use counterpoise_linalg::C64;
use counterpoise_lti::Margins;
use counterpoise_verify::linear_loop::loop_shape::nichols_points;
use counterpoise_verify::linear_loop::{
    Disk, LOCUS_CROSSOVERS, LoopShape, MarginKind, RootLocus, largest_sensitivity, loop_shape,
    margins_on_path,
};
use counterpoise_verify::{Requirement, Verification};

use crate::PipelineError;

/// Points of a chart, x and y; a point without numbers breaks the curve.
pub type ChartPoints = Vec<[f64; 2]>;

/// A curve of the plane of L, as a Nyquist chart and as a Nichols chart show it.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneCurve {
    /// Real and imaginary part.
    pub nyquist: ChartPoints,
    /// Phase in degrees, from -360 to 0, and modulus in dB.
    pub nichols: ChartPoints,
}

/// A margin, at the point of L where it is read.
#[derive(Debug, Clone, PartialEq)]
pub struct MarginPoint {
    /// The margin.
    pub kind: MarginKind,
    /// Its size, dB or degrees.
    pub size: f64,
    /// The frequency at which it is read, Hz.
    pub frequency_hz: f64,
    /// The point.
    pub place: PlaneCurve,
}

/// A root locus at the equivalents of poles and zeros in continuous time, ln(z)/T over 2 pi: real and imaginary part, Hz.
#[derive(Debug, Clone, PartialEq)]
pub struct LocusView {
    /// One branch a pole.
    pub branches: Vec<ChartPoints>,
    /// Poles of the open loop.
    pub open_poles: ChartPoints,
    /// Zeros of the open loop.
    pub open_zeros: ChartPoints,
    /// Poles of the closed loop.
    pub closed_poles: ChartPoints,
    /// Half the side of the square about the origin that shows the poles near the crossover, Hz.
    pub reach_hz: f64,
}

/// The loop in the complex plane, with what its Nyquist and Nichols charts show beside it.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopPlane {
    /// L at positive frequencies.
    pub path: PlaneCurve,
    /// The largest sensitivity that the requirements allow; 2 if they name none.
    pub largest_sensitivity: f64,
    /// The same, dB.
    pub largest_sensitivity_db: f64,
    /// The frequency at which the sensitivity has that value.
    pub outline: PlaneCurve,
    /// The disk of the disk margin that the loop touches, by the size of that margin; `None` if it is no disk.
    pub disk: Option<PlaneCurve>,
    /// The unit circle.
    pub unit: PlaneCurve,
    /// The nearest margins.
    pub margins: Vec<MarginPoint>,
}

/// The loop in the complex plane, and its root locus.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopView {
    /// The Nyquist and Nichols charts.
    pub plane: LoopPlane,
    /// The root locus.
    pub locus: LocusView,
}

impl LoopPlane {
    /// Returns the charts of a loop from L at positive frequencies, its margins, and the requirements on it.
    pub fn new(response: &[C64], margins: &Margins, requirements: &[Requirement]) -> Self {
        let largest = largest_sensitivity(requirements);
        let disk = Disk::of_disk_margin(margins.disk.alpha);
        Self {
            path: plane_curve(response),
            largest_sensitivity: largest,
            largest_sensitivity_db: 20.0 * largest.log10(),
            outline: plane_curve(&Disk::of_sensitivity(largest).edge()),
            disk: disk.map(|disk| plane_curve(&disk.edge())),
            unit: plane_curve(&Disk { centre: 0.0, radius: 1.0 }.edge()),
            margins: margin_points(margins),
        }
    }
}

/// Returns the charts of the loop that was verified.
///
/// # Errors
/// A frequency response that does not exist, or eigenvalues that were not found.
pub fn loop_view(found: &Verification) -> Result<LoopView, PipelineError> {
    let evidence = &found.evidence;
    let shape = loop_shape(&evidence.broken, &evidence.curves, evidence.sample_period_s)?;
    let requirements: Vec<Requirement> = found.verdicts.iter().map(|(asked, _)| asked.clone()).collect();
    Ok(LoopView::new(&shape, &evidence.margins, &requirements))
}

impl LoopView {
    /// Returns the charts of a loop from its shape, its margins, and the requirements on it.
    pub fn new(shape: &LoopShape, margins: &Margins, requirements: &[Requirement]) -> Self {
        Self {
            plane: LoopPlane::new(&shape.path.response, margins, requirements),
            locus: locus_view(margins, &shape.locus),
        }
    }
}

fn plane_curve(points: &[C64]) -> PlaneCurve {
    PlaneCurve {
        nyquist: points.iter().map(|point| [point.re, point.im]).collect(),
        nichols: nichols_points(points),
    }
}

fn margin_points(margins: &Margins) -> Vec<MarginPoint> {
    let points = margins_on_path(margins).into_iter().map(|margin| MarginPoint {
        kind: margin.kind,
        size: margin.size,
        frequency_hz: margin.rate_rad_s / TAU,
        place: plane_curve(&[margin.response]),
    });
    points.collect()
}

fn locus_view(margins: &Margins, locus: &RootLocus) -> LocusView {
    let locus = locus.convert_to_continuous();
    let places = |all: &[C64]| all.iter().map(|s| [s.re / TAU, s.im / TAU]).collect::<ChartPoints>();
    let closed_poles = places(&locus.closed_poles);
    let crossover_hz = margins.phase.iter().map(|p| p.rate_rad_s / TAU).fold(0.0, f64::max);
    let farthest = closed_poles.iter().map(|at| at[0].hypot(at[1])).fold(0.0, f64::max);
    let reach_hz = if crossover_hz > 0.0 { LOCUS_CROSSOVERS * crossover_hz } else { farthest.max(1.0) };
    LocusView {
        branches: locus.branches.iter().map(|branch| places(branch)).collect(),
        open_poles: places(&locus.open_poles),
        open_zeros: places(&locus.open_zeros),
        closed_poles,
        reach_hz,
    }
}
