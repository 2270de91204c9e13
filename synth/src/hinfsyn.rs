//! H-infinity control of a generalised plant by two Riccati equations and a search for the smallest bound.

use counterpoise_linalg::{C64, CMat, Mat, csingular_values, csolve};
use counterpoise_lti::{Peak, StateSpace, frequency_response, linfnorm, poles};

use crate::Error;
use crate::cause::{Cause, PlantCause};
use crate::error::attempt;
use crate::finding::{DesignFinding, Part};
use crate::generalised_plant::GeneralisedPlant;
use crate::h2syn::h2syn;
use crate::normal_form::{Attempt, NormalForm};
use crate::tolerance::{
    HINF_FIRST_RAISE, HINF_NORM, HINF_NOTHING, HINF_ROUNDED_UP, HINF_TRIALS, HINF_VERIFIED, HINF_WORTHWHILE,
};

/// An H-infinity controller with its certificates.
#[derive(Debug, Clone, PartialEq)]
pub struct HInfinity {
    /// u = K y.
    pub controller: StateSpace,
    /// The bound at which the controller was made, or the norm of its loop if rounding of the controller left that above the bound.
    pub bound: f64,
    /// The norm that the assembled loop really has, at most `bound` (1 + [`HINF_VERIFIED`]): the figure to quote.
    pub achieved_norm: f64,
    /// Frequency of the peak, rad/s.
    pub peak_rad_s: f64,
    /// The largest bound that was found not to be reachable: the optimum lies between the two.
    pub unreachable: f64,
    /// Poles of the assembled loop.
    pub closed_loop: Vec<C64>,
    /// Bounds that were tried.
    pub trials: usize,
}

/// Returns the controller whose H-infinity norm from w to z is within a factor (1 + tolerance) of the smallest
///
/// ```text
///     X, Y from H-infinity Riccati equations at the bound g;  X >= 0, Y >= 0, rho(XY) < g^2
/// ```
///
/// and the central controller of Glover and Doyle (Zhou, Doyle, Glover, Robust and Optimal Control, theorem 17.1), D11
/// of any kind. The smallest bound is found by a guarded secant on ln rho(XY) - 2 ln g. The answer is then looked at
/// afresh: the assembled loop must be stable and its norm must keep the bound, or the bound is raised until it does. The
/// claim is thus never below what is reached.
///
/// # Errors
/// [`Error::Range`] for a tolerance that is not positive, [`Error`] if a decomposition fails. A plant that breaks a
/// condition is [`Error::Refused`] and says which.
pub fn hinfsyn(plant: &GeneralisedPlant, tolerance: f64) -> Result<HInfinity, Error> {
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(Error::Range { what: "tolerance", value: tolerance, allowed: "positive" });
    }
    plant.check_regular()?;
    let normal = NormalForm::of(plant)?;
    let low = End { bound: normal.lower_bound()?, attempt: Attempt::Unreachable };
    let mut search = Search { plant, normal: &normal, unreachable: low.bound, low, high: None, trials: 0 };
    search.raise_bound()?;
    if search.high.is_none()
        && let Some(findings) = obstacle(plant)?
    {
        return Err(Error::refusal(findings));
    }
    search.narrow(tolerance)?;
    search.verified_solution()
}

/// The mode in the way where no bound is kept: as the bound grows the equations become those of H2, which name it.
fn obstacle(plant: &GeneralisedPlant) -> Result<Option<Vec<DesignFinding>>, Error> {
    let mut limit = plant.clone();
    let system = &mut limit.system;
    let (p, m) = (system.outputs() - plant.measurements, system.inputs() - plant.controls);
    system.D.set_block(0, 0, &Mat::zeros(p, m));
    Ok(attempt(h2syn(&limit))?.err().map(|refusal| refusal.findings))
}

/// A bound with what it turned out to be.
#[derive(Clone, Copy)]
struct End {
    bound: f64,
    attempt: Attempt,
}

struct Search<'a> {
    plant: &'a GeneralisedPlant,
    normal: &'a NormalForm,
    low: End,
    high: Option<End>,
    /// The largest bound that is certainly not reachable.
    unreachable: f64,
    trials: usize,
}

impl Search<'_> {
    /// Raises the bound until one seems reachable.
    fn raise_bound(&mut self) -> Result<(), Error> {
        let mut bound = if self.low.bound > 0.0 { 2.0 * self.low.bound } else { self.normal.initial_bound() };
        while self.high.is_none() && self.trials < HINF_TRIALS {
            self.attempt(bound)?;
            bound *= 4.0;
        }
        Ok(())
    }

    /// Brings the ends together to the tolerance, or the upper one down to what counts as nothing.
    fn narrow(&mut self, tolerance: f64) -> Result<(), Error> {
        let first = self.high.map_or(0.0, |high| high.bound);
        while let Some(high) = self.high {
            let close = high.bound <= self.low.bound * (1.0 + tolerance);
            if close || high.bound < HINF_NOTHING * first || self.trials >= HINF_TRIALS {
                return Ok(());
            }
            self.attempt(bound_between(self.low, high, tolerance))?;
        }
        Ok(())
    }

    fn attempt(&mut self, bound: f64) -> Result<(), Error> {
        self.trials += 1;
        let attempt = self.normal.attempt(bound)?;
        let end = End { bound, attempt };
        match attempt {
            Attempt::Margin(margin) if margin < 0.0 => self.high = Some(end),
            Attempt::Undecided => self.low = end,
            Attempt::Margin(_) | Attempt::Unreachable => {
                self.low = end;
                self.unreachable = self.unreachable.max(bound);
            }
        }
        Ok(())
    }

    /// The controller at the upper end, or at the first bound above it whose loop keeps it; one between the two whose loop has a clearly lower norm,
    /// although that is above its own bound, as rounding leaves it near the optimum.
    fn verified_solution(mut self) -> Result<HInfinity, Error> {
        let mut bound = self.high.map_or(self.low.bound, |high| high.bound);
        let mut raise = HINF_FIRST_RAISE;
        let mut lowest: Option<HInfinity> = None;
        while self.high.is_some() && self.trials < 2 * HINF_TRIALS {
            self.trials += 1;
            if let Some(K) = self.normal.central_controller(bound)?
                && let Some(answer) = self.verify(K, bound)?
            {
                let limit = answer.achieved_norm * (1.0 - HINF_WORTHWHILE);
                if answer.bound <= bound * (1.0 + HINF_VERIFIED) {
                    let lower = lowest.filter(|other| other.achieved_norm < limit);
                    return Ok(lower.unwrap_or(HInfinity { bound, ..answer }));
                }
                if lowest.as_ref().is_none_or(|other| answer.achieved_norm < other.achieved_norm) {
                    lowest = Some(answer);
                }
            }
            bound *= 1.0 + raise;
            raise = (2.0 * raise).min(1.0);
        }
        let cause = Cause::Plant(PlantCause::NoBoundReached { largest: bound });
        Err(Error::refusal(vec![DesignFinding::refusal(Part::Generalised, cause)]))
    }

    /// The controller with its certificates, if its loop is stable; its bound is raised to the norm of the loop if that is larger.
    fn verify(&self, K: StateSpace, bound: f64) -> Result<Option<HInfinity>, Error> {
        // A bound so large or so small that the controller leaves the range of numbers proves nothing.
        if !(bound.is_finite() && [&K.A, &K.B, &K.C, &K.D].iter().all(|matrix| matrix.is_finite())) {
            return Ok(None);
        }
        let closed = self.plant.close(&K)?;
        let closed_loop = poles(&closed)?;
        if closed_loop.iter().any(|pole| pole.re >= 0.0) {
            return Ok(None);
        }
        let mut peak = linfnorm(&closed, HINF_NORM)?;
        // Plant and controller are put together once more, frequency by frequency: near the optimum the controller is so large
        // that the loop's matrices lose digits, and the two disagree.
        let composed = self.composed_peak(&K, &closed_loop, peak.rate_rad_s)?;
        if composed.value > peak.value {
            peak = composed;
        }
        if peak.value.is_nan() {
            return Ok(None);
        }
        Ok(Some(HInfinity {
            controller: K,
            bound: bound.max(peak.value),
            achieved_norm: peak.value * (1.0 + HINF_ROUNDED_UP),
            peak_rad_s: peak.rate_rad_s,
            unreachable: self.unreachable,
            closed_loop,
            trials: self.trials,
        }))
    }
}

impl Search<'_> {
    /// The largest singular value of P11 + P12 K (I - P22 K)^-1 P21 among the frequency of the peak, those of the poles, and close ones.
    fn composed_peak(&self, K: &StateSpace, poles: &[C64], rate_rad_s: f64) -> Result<Peak, Error> {
        let around = [0.9, 0.99, 0.999, 1.0, 1.001, 1.01, 1.1];
        let centres =
            poles.iter().map(|pole| pole.norm()).chain([rate_rad_s]).filter(|rate| rate.is_finite());
        let rates: Vec<f64> = centres.flat_map(|rate| around.map(|factor| factor * rate)).collect();
        let plants = frequency_response(&self.plant.system, &rates);
        let controllers = frequency_response(K, &rates);
        let mut best = Peak { value: 0.0, rate_rad_s };
        // A frequency that is a pole of plant or controller has no value there; the loop's own norm covers it.
        let (Ok(plants), Ok(controllers)) = (plants, controllers) else { return Ok(best) };
        let (y, u) = (self.plant.measurements, self.plant.controls);
        for ((P, K), rate_rad_s) in plants.iter().zip(&controllers).zip(rates) {
            let (z, w) = (P.nrows() - y, P.ncols() - u);
            let inner = CMat::eye(y) - P.block(z, w, y, u) * K;
            let Ok(seen) = csolve(&inner, &P.block(z, 0, y, w)) else { continue };
            let H = P.block(0, 0, z, w) + P.block(0, w, z, u) * (K * &seen);
            let value = csingular_values(&H)?.first().copied().unwrap_or(0.0);
            if value > best.value {
                best = Peak { value, rate_rad_s };
            }
        }
        Ok(best)
    }
}

/// A bound strictly between two ends: by the secant where both margins are known, else the middle; never nearer to an
/// end than half the tolerance, so that the ends meet.
fn bound_between(low: End, high: End, tolerance: f64) -> f64 {
    if low.bound <= 0.0 {
        return 0.1 * high.bound;
    }
    let (a, b) = (low.bound.ln(), high.bound.ln());
    let middle = 0.5 * (a + b);
    let guess = match (low.attempt, high.attempt) {
        (Attempt::Margin(above), Attempt::Margin(below)) if above.is_finite() && below.is_finite() => {
            b - below * (b - a) / (below - above)
        }
        _ => middle,
    };
    let guard = (0.5 * tolerance).min(0.25 * (b - a));
    guess.clamp(a + guard, b - guard).exp()
}
