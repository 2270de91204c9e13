//! A loop with what is uncertain about it, and its bounds over frequency.

use counterpoise_controller::Controller;
use counterpoise_linalg::{C64, CMat};
use counterpoise_models::parameters::Parameters;

use super::closing::{GainErrors, LoopClosure, close_perturbed_loop, outermost_pole};
use super::factor::{Factor, Reach};
use super::loops::{UncertainLoop, UncertainParameter};
use super::places::{
    Joints, LinearisedDryFriction, Place, dry_as_viscous, parameter_places, presliding_stiffness, without_dry,
};
use super::{Perturbation, PerturbationBlock, UpperBound, lower_bound, upper_bound, vertex_bound};
use crate::robustness::{Variation, VariedParameter};
use crate::tolerance::{
    MU_HIGH_PEAK, MU_LOWEST_HZ, MU_POINTS, MU_REFINEMENTS, MU_SEARCHED, MU_SPARSE, MU_STEEP,
};
use crate::{Error, Procedure};

/// Uncertain parameters of a loop.
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
    /// mu is at least this; 0 if no perturbation was found.
    pub lower: f64,
}

/// A mechanism with which the loop is at its limit of stability, closed exactly as it is sampled.
#[derive(Debug, Clone, PartialEq)]
pub struct DestabilisingMechanism {
    /// By how much the stated ranges are widened to hold it.
    pub scale: f64,
    /// Factor of each parameter that enters the loop.
    pub factors: Vec<(VariedParameter, f64)>,
    /// Relative errors at the plant's input and of the hub gyroscope's reading at its frequency.
    pub errors: [C64; 2],
    /// The closed loop's pole at the limit.
    pub pole: C64,
    /// Frequency of that pole, Hz.
    pub frequency_hz: f64,
    /// The deviation of each parameter over its stated range, and of the two errors: between -1 and 1, or complex of size 1 at most.
    pub deltas: Vec<f64>,
    /// See [`DestabilisingMechanism::deltas`].
    pub phases: [C64; 2],
    /// The perturbed plant as it is sampled, and the controller with the errors before and behind it: the loop that has the pole.
    pub closed: LoopClosure,
}

/// A stated range of a parameter as a factor over a deviation between -1 and 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedRange {
    /// The parameter.
    pub varied: VariedParameter,
    /// Factor over the deviation.
    pub factor: Factor,
}

/// A mechanism with the regime of its friction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mechanism<'a> {
    pub parameters: &'a Parameters,
    pub joints: Joints,
}

/// The loop with what is uncertain about it.
pub(super) struct Problem<'a> {
    parameters: &'a Parameters,
    controller: &'a Controller,
    procedure: &'a Procedure,
    pub(super) pulled: UncertainLoop,
    /// Parameters that enter the loop, in the order of its blocks.
    pub(super) entering: Vec<StatedRange>,
    pub(super) left_out: Vec<VariedParameter>,
    joints: Joints,
    /// Viscous friction in the place of dry friction, at motor and pivot.
    dry: [f64; 2],
    pub(super) dry_at: Option<f64>,
    pub(super) errors: [f64; 2],
}

/// The bounds at a frequency.
pub(super) struct FrequencyBounds {
    pub(super) hz: f64,
    pub(super) upper: UpperBound,
    pub(super) lower: Option<Perturbation>,
}

impl FrequencyBounds {
    pub(super) fn bounds(&self) -> Bounds {
        let lower = self.lower.as_ref().map_or(0.0, |found| found.beta);
        Bounds { frequency_hz: self.hz, upper: self.upper.beta, lower }
    }
}

fn is_dry(varied: VariedParameter) -> bool {
    parameter_places(varied).iter().any(|place| matches!(place, Place::MotorDry | Place::PivotDry))
}

/// A direction of perturbation: where in its range each entering parameter is, and the phases of the errors of gain.
#[derive(Clone)]
pub(super) struct Direction {
    /// From -1 to 1.
    pub(super) deltas: Vec<f64>,
    /// Of modulus 1, at the plant's input and at the gyroscope.
    pub(super) phases: [C64; 2],
    /// The rate at which the errors have these phases.
    pub(super) rate_rad_s: f64,
}

impl Direction {
    /// The nominal parameters without errors of gain.
    pub(super) fn none(parameters: usize) -> Self {
        Self { deltas: vec![0.0; parameters], phases: [C64::new(0.0, 0.0); 2], rate_rad_s: 1.0 }
    }
}

impl<'a> Problem<'a> {
    pub(super) fn new(
        mechanism: Mechanism<'a>,
        controller: &'a Controller,
        procedure: &'a Procedure,
        uncertainty: &Uncertainty,
    ) -> Result<Self, Error> {
        let Mechanism { parameters, joints } = mechanism;
        let slides = joints == Joints::Sliding;
        let dry_at = slides && uncertainty.variations.iter().any(|one| is_dry(one.parameter));
        let dry_at = dry_at.then_some(procedure.step.rate_rad_s.abs());
        let dry = dry_at.map_or([0.0; 2], |rate| dry_as_viscous(parameters, rate));
        let errors = [uncertainty.input_error, uncertainty.output_error];
        let range =
            |one: &Variation| StatedRange { varied: one.parameter, factor: Factor::of(one.distribution) };
        let all: Vec<StatedRange> = uncertainty.variations.iter().map(range).collect();
        let moves = |one: &&StatedRange| one.factor.a != one.factor.b;
        let of = |one: &StatedRange| UncertainParameter {
            factor: one.factor,
            places: parameter_places(one.varied).to_vec(),
        };
        let mut problem = Self {
            parameters,
            controller,
            procedure,
            pulled: UncertainLoop::new(
                &without_dry(parameters, dry),
                LinearisedDryFriction { viscous: dry, springs: [0.0; 2] },
                controller,
                &procedure.operating_point,
                &[],
                errors,
            )?,
            entering: all.clone(),
            left_out: Vec::new(),
            joints,
            dry,
            dry_at,
            errors,
        };
        let (nominal, dry) = problem.perturb_mechanism(&vec![0.0; all.len()], 1.0)?;
        let loop_of = |some: &[StatedRange]| {
            let uncertain: Vec<UncertainParameter> = some.iter().map(of).collect();
            UncertainLoop::new(&nominal, dry, controller, &procedure.operating_point, &uncertain, errors)
        };
        let mut entering = Vec::new();
        for one in all.iter().filter(moves) {
            let alone = loop_of(std::slice::from_ref(one))?;
            if alone.structure.blocks.iter().any(|block| matches!(block, PerturbationBlock::Real { .. })) {
                entering.push(*one);
            }
        }
        problem.left_out = all.iter().filter(|one| !entering.contains(one)).map(|one| one.varied).collect();
        problem.pulled = loop_of(&entering)?;
        problem.entering = entering;
        Ok(problem)
    }

    /// The mechanism at deviations `scale` times `deltas`, dry friction replaced, and the viscous friction in its place.
    fn perturb_mechanism(
        &self,
        deltas: &[f64],
        scale: f64,
    ) -> Result<(Parameters, LinearisedDryFriction), Error> {
        let mut parameters = self.parameters.clone();
        let mut dry = self.dry;
        for (StatedRange { varied, factor }, delta) in self.entering.iter().zip(deltas) {
            let by = factor.at(scale * delta);
            if is_dry(*varied) {
                let here = |place| if parameter_places(*varied).contains(&place) { by } else { 1.0 };
                dry = [dry[0] * here(Place::MotorDry), dry[1] * here(Place::PivotDry)];
            } else {
                varied.scale(&mut parameters, by)?;
            }
        }
        let springs = match self.joints {
            Joints::Sliding | Joints::Frictionless => [0.0; 2],
            Joints::AtRest => presliding_stiffness(&parameters),
        };
        Ok((without_dry(&parameters, dry), LinearisedDryFriction { viscous: dry, springs }))
    }

    /// The errors of gain in a direction, `scale` times the stated ones.
    fn gain_errors(&self, direction: &Direction, scale: f64) -> GainErrors {
        let at = [0, 1].map(|k| direction.phases[k] * (scale * self.errors[k]));
        GainErrors { at, rate_rad_s: direction.rate_rad_s }
    }

    /// The outermost pole at a perturbation, `scale` times the ranges in a direction.
    pub(super) fn pole(&self, direction: &Direction, scale: f64) -> Result<C64, Error> {
        let (parameters, dry) = self.perturb_mechanism(&direction.deltas, scale)?;
        let errors = self.gain_errors(direction, scale);
        outermost_pole(&parameters, &dry, self.controller, &self.procedure.operating_point, &errors)
    }

    /// The loop closed with a perturbation.
    pub(super) fn close_loop_at(&self, direction: &Direction, scale: f64) -> Result<LoopClosure, Error> {
        let (parameters, dry) = self.perturb_mechanism(&direction.deltas, scale)?;
        let errors = self.gain_errors(direction, scale);
        close_perturbed_loop(&parameters, &dry, self.controller, &self.procedure.operating_point, &errors)
    }

    /// Bounds over a grid that is refined about the peaks of the upper bound.
    pub(super) fn scan(&self) -> Result<Vec<FrequencyBounds>, Error> {
        let highest = 0.49 / self.pulled.sample_period_s();
        let ratio = (highest / MU_LOWEST_HZ).ln() / (MU_POINTS - 1) as f64;
        let first: Vec<f64> = (0..MU_POINTS).map(|k| MU_LOWEST_HZ * (ratio * k as f64).exp()).collect();
        let mut all = self.bound_grid(&first, None)?;
        for _ in 0..MU_REFINEMENTS {
            let between = refined_frequencies(&all);
            if between.is_empty() {
                break;
            }
            let near = all.iter().max_by(|a, b| a.upper.beta.total_cmp(&b.upper.beta));
            let more = self.bound_grid(&between, near.map(|at| &at.upper))?;
            all.extend(more);
            all.sort_by(|a, b| a.hz.total_cmp(&b.hz));
        }
        self.raise_lower(&mut all)?;
        Ok(all)
    }

    /// Searches over the parameters where the upper bound leaves room for a perturbation smaller than the best so far.
    fn raise_lower(&self, all: &mut [FrequencyBounds]) -> Result<(), Error> {
        let mut order: Vec<usize> = (0..all.len()).collect();
        order.sort_by(|a, b| all[*b].upper.beta.total_cmp(&all[*a].upper.beta));
        let mut best = all.iter().map(|at| at.bounds().lower).fold(0.0, f64::max);
        let (structure, count) = (&self.pulled.structure, self.entering.len());
        let reach: Vec<Reach> = self.entering.iter().map(|one| one.factor.reach()).collect();
        for k in order.into_iter().take(MU_SEARCHED) {
            if all[k].upper.beta < best {
                break;
            }
            let M = self.pulled.at(&[std::f64::consts::TAU * all[k].hz])?;
            let start = all[k]
                .lower
                .as_ref()
                .map_or(vec![0.0; count], |found| found.delta.iter().take(count).map(|q| q.re).collect());
            let found = vertex_bound(&M[0], structure, &start, &reach, all[k].upper.beta);
            let lower = all[k].lower.take().into_iter().chain(found);
            all[k].lower = lower.max_by(|a, b| a.beta.total_cmp(&b.beta));
            best = best.max(all[k].bounds().lower);
        }
        Ok(())
    }

    fn bound_grid(&self, hz: &[f64], near: Option<&UpperBound>) -> Result<Vec<FrequencyBounds>, Error> {
        let rates: Vec<f64> = hz.iter().map(|f| std::f64::consts::TAU * f).collect();
        let structure = &self.pulled.structure;
        let mut last = near.cloned();
        let mut one = |(hz, M): (&f64, &CMat)| {
            let upper = upper_bound(M, structure, last.as_ref());
            last = Some(upper.clone());
            FrequencyBounds { hz: *hz, lower: lower_bound(M, structure), upper }
        };
        Ok(hz.iter().zip(&self.pulled.at(&rates)?).map(&mut one).collect())
    }
}

/// Frequencies between neighbours of the highest peaks where the bound is steep.
fn refined_frequencies(all: &[FrequencyBounds]) -> Vec<f64> {
    let upper = |k: usize| all[k].upper.beta;
    let peak = all.iter().map(|at| at.upper.beta).fold(0.0, f64::max);
    let mut between = Vec::new();
    for k in 0..all.len().saturating_sub(1) {
        let high = upper(k).max(upper(k + 1));
        let around = [k.checked_sub(1), Some(k), Some(k + 1), Some(k + 2)];
        let is_peak = around.into_iter().flatten().filter_map(|i| all.get(i)).all(|at| at.upper.beta <= high);
        let steep =
            (upper(k) - upper(k + 1)).abs() > MU_STEEP * high || all[k + 1].hz > MU_SPARSE * all[k].hz;
        if high > MU_HIGH_PEAK * peak && is_peak && steep {
            between.push((all[k].hz * all[k + 1].hz).sqrt());
        }
    }
    between
}
