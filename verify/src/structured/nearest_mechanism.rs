//! The mechanism nearest to the nominal one that was found to be at the limit of stability.

use counterpoise_linalg::C64;

use super::Perturbation;
use super::problem::{DestabilisingMechanism, Direction, FrequencyBounds, Problem, StatedRange};
use crate::Error;
use crate::tolerance::{LIMIT_GAIN, LIMIT_NEARNESS, NEAREST_CANDIDATES};

/// The least widening of the ranges that was found to destabilise, each perturbation closed with the sampled loop.
///
/// # Errors
/// Those of the closed loop.
pub(super) fn find_nearest(
    problem: &Problem<'_>,
    scanned: &[FrequencyBounds],
) -> Result<Option<DestabilisingMechanism>, Error> {
    Search(problem).search(scanned)
}

struct Search<'a, 'b>(&'a Problem<'b>);

impl Search<'_, '_> {
    /// Closes the loop with the perturbations of the largest lower bounds, and keeps the one that needs least.
    fn search(&self, scanned: &[FrequencyBounds]) -> Result<Option<DestabilisingMechanism>, Error> {
        let mut ordered: Vec<&FrequencyBounds> = scanned.iter().filter(|at| at.lower.is_some()).collect();
        ordered.sort_by(|a, b| b.bounds().lower.total_cmp(&a.bounds().lower));
        let mut best = None;
        for at in ordered.into_iter().take(NEAREST_CANDIDATES) {
            let Some(lower) = &at.lower else { continue };
            best = nearer_of(best, self.improve_candidate(self.candidate(lower, at.hz), 1.0 / lower.beta)?);
        }
        if self.0.errors == [0.0; 2] {
            let peak = scanned.iter().map(|at| at.upper.beta).fold(0.0, f64::max);
            best = nearer_of(best, self.ascend_parameters(1.0 / peak)?);
        }
        Ok(best)
    }

    /// Without complex errors: the parameters' ends that bring a pole furthest out, one parameter at a time.
    fn ascend_parameters(&self, scale: f64) -> Result<Option<DestabilisingMechanism>, Error> {
        let count = self.0.entering.len();
        let mut candidate = Direction::none(count);
        let mut best = 0.0;
        for k in (0..count).chain(0..count) {
            for end in [-1.0, 1.0] {
                let mut other = candidate.clone();
                other.deltas[k] = end;
                let radius = self.0.pole(&other, scale)?.norm();
                if radius > best {
                    (candidate, best) = (other, radius);
                }
            }
        }
        self.improve_candidate(candidate, scale * 1.2)
    }

    fn candidate(&self, lower: &Perturbation, hz: f64) -> Direction {
        let (real, complex) = lower.delta.split_at(self.0.entering.len());
        let mut phases = [C64::new(0.0, 0.0); 2];
        let present = (0..2).filter(|k| self.0.errors[*k] > 0.0);
        present.zip(complex).for_each(|(k, phase)| phases[k] = *phase);
        let rate_rad_s = std::f64::consts::TAU * hz;
        Direction { deltas: real.iter().map(|q| q.re).collect(), phases, rate_rad_s }
    }

    /// The least scale at which the candidate destabilises, each parameter also tried at the ends of its range.
    fn improve_candidate(
        &self,
        mut candidate: Direction,
        near: f64,
    ) -> Result<Option<DestabilisingMechanism>, Error> {
        let Some(mut scale) = self.limit(&candidate, near)? else { return Ok(None) };
        for k in 0..candidate.deltas.len() {
            for end in [-1.0, 1.0] {
                let mut other = candidate.clone();
                other.deltas[k] = end;
                let closer = self.is_unstable(&other, (1.0 - LIMIT_GAIN) * scale)?;
                if let Some(less) = if closer { self.limit(&other, scale)? } else { None } {
                    (candidate, scale) = (other, less.min(scale));
                }
            }
        }
        self.describe_perturbation(&candidate, scale).map(Some)
    }

    fn is_unstable(&self, candidate: &Direction, scale: f64) -> Result<bool, Error> {
        let pole = self.0.pole(candidate, scale)?;
        Ok(pole.norm() >= 1.0)
    }

    /// The scale at which a pole reaches the unit circle, near the one that the bound names; `None` if none does.
    fn limit(&self, candidate: &Direction, near: f64) -> Result<Option<f64>, Error> {
        let (mut low, mut high) = (0.0, f64::NAN);
        for k in 1..=60 {
            let scale = near * (0.7 + 0.02 * f64::from(k));
            if self.is_unstable(candidate, scale)? {
                high = scale;
                break;
            }
            low = scale;
        }
        if high.is_nan() {
            return Ok(None);
        }
        while high - low > LIMIT_NEARNESS * high {
            let middle = 0.5 * (low + high);
            if self.is_unstable(candidate, middle)? { high = middle } else { low = middle }
        }
        Ok(Some(high))
    }

    fn describe_perturbation(
        &self,
        candidate: &Direction,
        scale: f64,
    ) -> Result<DestabilisingMechanism, Error> {
        let pole = self.0.pole(candidate, scale)?;
        let factor = |(one, delta): (&StatedRange, &f64)| (one.varied, one.factor.at(scale * delta));
        let factors = self.0.entering.iter().zip(&candidate.deltas).map(factor).collect();
        let errors = [0, 1].map(|k| candidate.phases[k] * (scale * self.0.errors[k]));
        let period_s = self.0.pulled.sample_period_s();
        let frequency_hz = pole.arg().abs() / (std::f64::consts::TAU * period_s);
        let (deltas, phases) = (candidate.deltas.clone(), candidate.phases);
        let closed = self.0.close_loop_at(candidate, scale)?;
        Ok(DestabilisingMechanism { scale, factors, errors, pole, frequency_hz, deltas, phases, closed })
    }
}

fn nearer_of(
    old: Option<DestabilisingMechanism>,
    new: Option<DestabilisingMechanism>,
) -> Option<DestabilisingMechanism> {
    old.into_iter().chain(new).min_by(|a, b| a.scale.total_cmp(&b.scale))
}
