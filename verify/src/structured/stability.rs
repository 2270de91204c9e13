//! How far the stated ranges of all parameters together may be widened before the loop can become unstable.

use counterpoise_controller::Controller;
use counterpoise_lti::{C64, CMat};
use counterpoise_models::parameters::Parameters;

use super::closing::{GainErrors, outermost_pole};
use super::factor::Factor;
use super::loops::{Uncertain, UncertainLoop};
use super::nearest::nearest;
use super::places::{Place, dry_as_viscous, places, without_dry};
use super::{Block, Perturbation, UpperBound, lower_bound, upper_bound, vertex_bound};
use crate::robust::{Variation, Varied};
use crate::{Error, Procedure};

/// What is uncertain about a loop.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// Parameters with their ranges.
    pub variations: Vec<Variation>,
    /// Relative error of any phase at the plant's input; 0 for none.
    pub input_error: f64,
    /// Relative error of any phase of the hub gyroscope's reading; 0 for none.
    pub output_error: f64,
}

/// Bounds of the structured singular value at a frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// mu is below this.
    pub upper: f64,
    /// mu is at least this; 0 where no perturbation was found.
    pub lower: f64,
}

/// The robust stability of a loop.
#[derive(Debug, Clone, PartialEq)]
pub struct RobustStability {
    /// Bounds over frequency, by rising frequency.
    pub bounds: Vec<Bounds>,
    /// The loop is stable for all parameters in the stated ranges widened by less than this: 1 over the largest upper bound.
    pub guaranteed: f64,
    /// Where the upper bound is largest, Hz.
    pub worst_hz: f64,
    /// The smallest perturbation that was found to make the loop unstable.
    pub found: Option<Destabilising>,
    /// Parameters that do not enter the linear loop.
    pub left_out: Vec<Varied>,
    /// The sinusoidal hub rate at which dry friction is taken as viscous friction, where it varies, rad/s.
    pub dry_friction_at_rad_s: Option<f64>,
    /// The errors at the plant's input and of the hub gyroscope's reading.
    pub errors: [f64; 2],
}

/// A mechanism with which the loop is at its limit of stability, closed exactly as it is sampled.
#[derive(Debug, Clone, PartialEq)]
pub struct Destabilising {
    /// By how much the stated ranges are widened to hold it.
    pub scale: f64,
    /// Factor of each parameter that enters the loop.
    pub factors: Vec<(Varied, f64)>,
    /// Relative errors at the plant's input and of the hub gyroscope's reading at its frequency.
    pub errors: [C64; 2],
    /// The closed loop's pole at the limit.
    pub pole: C64,
    /// Frequency of that pole, Hz.
    pub frequency_hz: f64,
}

/// Frequencies of the first grid.
const POINTS: usize = 80;
/// Lowest frequency, Hz.
const LOWEST_HZ: f64 = 0.05;
/// Most refinements about peaks.
const REFINEMENTS: usize = 6;
/// Neighbours of a peak that differ by more than this are refined.
const STEEP: f64 = 0.01;
/// Frequencies at which the parameters are searched.
const SEARCHED: usize = 16;
/// Ranges are widened at most so far.
const WIDEST: f64 = 1e3;

/// Bounds how far the ranges of all parameters together may be widened before the loop can be unstable.
///
/// At each frequency the structured singular value of the loop's uncertain parts is bounded from above by scalings D and G and from
/// below by the power iteration; the most dangerous perturbations are then closed with the sampled loop, and scaled until a pole
/// stands on the unit circle. `None` if the nominal loop is unstable, or nothing that enters the loop is uncertain.
///
/// # Errors
/// Parameters that make no mechanism, and those of the linear loop.
pub fn robust_stability(
    parameters: &Parameters,
    controller: &Controller,
    procedure: &Procedure,
    uncertainty: &Uncertainty,
) -> Result<Option<RobustStability>, Error> {
    let problem = Problem::new(parameters, controller, procedure, uncertainty)?;
    let nothing = vec![0.0; problem.entering.len()];
    let stable = problem.pole(&nothing, [C64::new(0.0, 0.0); 2], 1.0)?.norm() < 1.0;
    if !stable || problem.pulled.structure.blocks.is_empty() {
        return Ok(None);
    }
    let scanned = problem.scan()?;
    let found = nearest(&problem, &scanned)?;
    let worst = scanned.iter().max_by(|a, b| a.upper.beta.total_cmp(&b.upper.beta));
    let (peak, worst_hz) = worst.map_or((0.0, 0.0), |at| (at.upper.beta, at.hz));
    let bounds = scanned.iter().map(Scanned::bounds).collect();
    Ok(Some(RobustStability {
        bounds,
        guaranteed: 1.0 / peak.max(1.0 / WIDEST),
        worst_hz,
        found,
        left_out: problem.left_out.clone(),
        dry_friction_at_rad_s: problem.dry_at,
        errors: problem.errors,
    }))
}

/// The loop with what is uncertain about it.
pub(super) struct Problem<'a> {
    parameters: &'a Parameters,
    controller: &'a Controller,
    procedure: &'a Procedure,
    pub(super) pulled: UncertainLoop,
    /// Parameters that enter the loop, in the order of its blocks.
    pub(super) entering: Vec<(Varied, Factor)>,
    left_out: Vec<Varied>,
    /// Viscous friction in the place of dry friction, at motor and pivot.
    dry: [f64; 2],
    dry_at: Option<f64>,
    pub(super) errors: [f64; 2],
}

/// What was found at a frequency.
pub(super) struct Scanned {
    pub(super) hz: f64,
    pub(super) upper: UpperBound,
    pub(super) lower: Option<Perturbation>,
}

impl Scanned {
    pub(super) fn bounds(&self) -> Bounds {
        let lower = self.lower.as_ref().map_or(0.0, |found| found.beta);
        Bounds { frequency_hz: self.hz, upper: self.upper.beta, lower }
    }
}

fn is_dry(varied: Varied) -> bool {
    places(varied).iter().any(|place| matches!(place, Place::MotorDry | Place::PivotDry))
}

impl<'a> Problem<'a> {
    fn new(
        parameters: &'a Parameters,
        controller: &'a Controller,
        procedure: &'a Procedure,
        uncertainty: &Uncertainty,
    ) -> Result<Self, Error> {
        let dry_at = uncertainty.variations.iter().any(|one| is_dry(one.parameter));
        let dry_at = dry_at.then_some(procedure.step.rate_rad_s.abs());
        let dry = dry_at.map_or([0.0; 2], |rate| dry_as_viscous(parameters, rate));
        let errors = [uncertainty.input_error, uncertainty.output_error];
        let all: Vec<(Varied, Factor)> =
            uncertainty.variations.iter().map(|one| (one.parameter, Factor::of(one.distribution))).collect();
        let moves = |(_, factor): &&(Varied, Factor)| factor.a != factor.b;
        let of = |one: &(Varied, Factor)| Uncertain { factor: one.1, places: places(one.0).to_vec() };
        let mut problem = Self {
            parameters,
            controller,
            procedure,
            pulled: UncertainLoop::new(
                (&without_dry(parameters, dry), dry),
                (controller, &procedure.operating_point),
                &[],
                errors,
            )?,
            entering: all.clone(),
            left_out: Vec::new(),
            dry,
            dry_at,
            errors,
        };
        let (nominal, dry) = problem.perturbed(&vec![0.0; all.len()], 1.0)?;
        let loop_of = |some: &[(Varied, Factor)]| {
            let uncertain: Vec<Uncertain> = some.iter().map(of).collect();
            UncertainLoop::new((&nominal, dry), (controller, &procedure.operating_point), &uncertain, errors)
        };
        let mut entering = Vec::new();
        for one in all.iter().filter(moves) {
            let alone = loop_of(std::slice::from_ref(one))?;
            if alone.structure.blocks.iter().any(|block| matches!(block, Block::Real { .. })) {
                entering.push(*one);
            }
        }
        problem.left_out =
            all.iter().filter(|one| !entering.contains(one)).map(|(varied, _)| *varied).collect();
        problem.pulled = loop_of(&entering)?;
        problem.entering = entering;
        Ok(problem)
    }

    /// The mechanism at deviations `scale` times `deltas`, dry friction replaced, and the viscous friction in its place.
    fn perturbed(&self, deltas: &[f64], scale: f64) -> Result<(Parameters, [f64; 2]), Error> {
        let mut parameters = self.parameters.clone();
        let mut dry = self.dry;
        for ((varied, factor), delta) in self.entering.iter().zip(deltas) {
            let by = factor.at(scale * delta);
            if is_dry(*varied) {
                let here = |place| if places(*varied).contains(&place) { by } else { 1.0 };
                dry = [dry[0] * here(Place::MotorDry), dry[1] * here(Place::PivotDry)];
            } else {
                varied.scale(&mut parameters, by)?;
            }
        }
        Ok((without_dry(&parameters, dry), dry))
    }

    /// The outermost pole at a perturbation.
    pub(super) fn pole(&self, deltas: &[f64], phases: [C64; 2], scale: f64) -> Result<C64, Error> {
        self.pole_at(deltas, (phases, 1.0), scale)
    }

    pub(super) fn pole_at(
        &self,
        deltas: &[f64],
        (phases, rate_rad_s): ([C64; 2], f64),
        scale: f64,
    ) -> Result<C64, Error> {
        let (parameters, _) = self.perturbed(deltas, scale)?;
        let at = [0, 1].map(|k| phases[k] * (scale * self.errors[k]));
        let errors = GainErrors { at, rate_rad_s };
        let with = (self.controller, &self.procedure.operating_point);
        outermost_pole(&parameters, with, &errors)
    }

    /// Bounds over a grid that is refined about the peaks of the upper bound.
    fn scan(&self) -> Result<Vec<Scanned>, Error> {
        let highest = 0.49 / self.pulled.sample_period_s();
        let ratio = (highest / LOWEST_HZ).ln() / (POINTS - 1) as f64;
        let first: Vec<f64> = (0..POINTS).map(|k| LOWEST_HZ * (ratio * k as f64).exp()).collect();
        let mut all = self.bounded(&first, None)?;
        for _ in 0..REFINEMENTS {
            let between = refined(&all);
            if between.is_empty() {
                break;
            }
            let near = all.iter().max_by(|a, b| a.upper.beta.total_cmp(&b.upper.beta));
            let more = self.bounded(&between, near.map(|at| &at.upper))?;
            all.extend(more);
            all.sort_by(|a, b| a.hz.total_cmp(&b.hz));
        }
        self.raise_lower(&mut all)?;
        Ok(all)
    }

    /// Searches over the parameters where the upper bound leaves room for a perturbation smaller than the best so far.
    fn raise_lower(&self, all: &mut [Scanned]) -> Result<(), Error> {
        let mut order: Vec<usize> = (0..all.len()).collect();
        order.sort_by(|a, b| all[*b].upper.beta.total_cmp(&all[*a].upper.beta));
        let mut best = all.iter().map(|at| at.bounds().lower).fold(0.0, f64::max);
        let (structure, count) = (&self.pulled.structure, self.entering.len());
        let reach: Vec<(f64, f64)> = self.entering.iter().map(|(_, factor)| factor.reach()).collect();
        for k in order.into_iter().take(SEARCHED) {
            if all[k].upper.beta < best {
                break;
            }
            let M = self.pulled.at(&[std::f64::consts::TAU * all[k].hz])?;
            let start = all[k]
                .lower
                .as_ref()
                .map_or(vec![0.0; count], |found| found.delta.iter().take(count).map(|q| q.re).collect());
            let found = vertex_bound(&M[0], structure, (&start, &reach), all[k].upper.beta);
            let lower = all[k].lower.take().into_iter().chain(found);
            all[k].lower = lower.max_by(|a, b| a.beta.total_cmp(&b.beta));
            best = best.max(all[k].bounds().lower);
        }
        Ok(())
    }

    fn bounded(&self, hz: &[f64], near: Option<&UpperBound>) -> Result<Vec<Scanned>, Error> {
        let rates: Vec<f64> = hz.iter().map(|f| std::f64::consts::TAU * f).collect();
        let structure = &self.pulled.structure;
        let mut last = near.cloned();
        let mut one = |(hz, M): (&f64, &CMat)| {
            let upper = upper_bound(M, structure, last.as_ref());
            last = Some(upper.clone());
            Scanned { hz: *hz, lower: lower_bound(M, structure), upper }
        };
        Ok(hz.iter().zip(&self.pulled.at(&rates)?).map(&mut one).collect())
    }
}

/// Frequencies between neighbours of the highest peaks where the bound is steep.
fn refined(all: &[Scanned]) -> Vec<f64> {
    let upper = |k: usize| all[k].upper.beta;
    let peak = all.iter().map(|at| at.upper.beta).fold(0.0, f64::max);
    let mut between = Vec::new();
    for k in 0..all.len().saturating_sub(1) {
        let high = upper(k).max(upper(k + 1));
        let around = [k.checked_sub(1), Some(k), Some(k + 1), Some(k + 2)];
        let is_peak = around.into_iter().flatten().filter_map(|i| all.get(i)).all(|at| at.upper.beta <= high);
        let steep = (upper(k) - upper(k + 1)).abs() > STEEP * high || all[k + 1].hz > 1.02 * all[k].hz;
        if high > 0.8 * peak && is_peak && steep {
            between.push((all[k].hz * all[k + 1].hz).sqrt());
        }
    }
    between
}
