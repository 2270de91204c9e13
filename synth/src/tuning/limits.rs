//! The limits of a tuned loop, and the figures of any sampled loop, computed from state-space systems.

use counterpoise_controller::{Controller, PathSignal};
use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::response::Response;
use counterpoise_lti::{StateSpace, Timebase, feedback, h2norm, linfnorm, margins, poles, series};

use super::Disturbance;
use crate::figures::driven_part;
use crate::sampling::sampled_plant;
use crate::tolerance::{CONTROL_PEAK, FASTEST_POLE, LIMIT_TIGHTENING, REGION_REACH};
use crate::{DesignPlant, Error, Sampling};

/// Limits that a loop must keep. An infinite upper or a zero lower limit asks for nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopLimits {
    /// Largest |S|.
    pub max_sensitivity: f64,
    /// Largest |T|.
    pub max_complementary: f64,
    /// Smallest gain margin, dB.
    pub gain_margin_db: f64,
    /// Smallest phase margin, degrees.
    pub phase_margin_deg: f64,
    /// Smallest delay margin, s.
    pub delay_margin_s: f64,
    /// Largest RMS control for readings with noise of unit RMS, V s/rad.
    pub noise_gain: f64,
    /// Largest |KS|, V s/rad.
    pub control_peak: f64,
    /// Largest RMS control under the disturbance, V.
    pub effort_v: f64,
    /// Slowest decay of a pole of the closed loop, rad/s.
    pub decay_rad_s: f64,
    /// Smallest damping ratio of the poles up to twice the crossover.
    pub damping: f64,
}

/// The figures of a sampled feedback loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopMeasures {
    /// Largest |S|.
    pub max_sensitivity: f64,
    /// Largest |T|.
    pub max_complementary: f64,
    /// Gain margin, dB.
    pub gain_margin_db: f64,
    /// Phase margin, degrees.
    pub phase_margin_deg: f64,
    /// Delay margin, s.
    pub delay_margin_s: f64,
    /// Highest frequency at which the loop's gain is 1, rad/s.
    pub crossover_rad_s: f64,
    /// RMS control for readings with noise of unit RMS, V s/rad.
    pub noise_gain: f64,
    /// Largest |KS|, V s/rad.
    pub control_peak: f64,
    /// RMS control under the disturbance, V.
    pub effort_v: f64,
    /// RMS rate that the disturbance leaves, rad/s.
    pub residual_rad_s: f64,
    /// Slowest decay of a pole of the closed loop, rad/s.
    pub decay_rad_s: f64,
    /// Smallest damping ratio of the poles up to twice the crossover.
    pub damping: f64,
}

impl Default for LoopLimits {
    /// No limit.
    fn default() -> Self {
        Self {
            max_sensitivity: f64::INFINITY,
            max_complementary: f64::INFINITY,
            gain_margin_db: 0.0,
            phase_margin_deg: 0.0,
            delay_margin_s: 0.0,
            noise_gain: f64::INFINITY,
            control_peak: f64::INFINITY,
            effort_v: f64::INFINITY,
            decay_rad_s: 0.0,
            damping: 0.0,
        }
    }
}

impl LoopLimits {
    /// Returns by how much the worst limit is missed, relative to it; 0 if all are kept.
    pub fn worst_shortfall(&self, found: &LoopMeasures) -> f64 {
        let above = self.upper_limits(found).into_iter().map(|(limit, value)| value / limit - 1.0);
        let below = self.lower_limits(found).into_iter().map(|(limit, value)| 1.0 - value / limit);
        let asked = |share: &f64| share.is_finite();
        above.chain(below).filter(asked).fold(0.0, f64::max)
    }

    fn upper_limits(&self, found: &LoopMeasures) -> [(f64, f64); 5] {
        [
            (self.max_sensitivity, found.max_sensitivity),
            (self.max_complementary, found.max_complementary),
            (self.noise_gain, found.noise_gain),
            (self.control_peak, found.control_peak),
            (self.effort_v, found.effort_v),
        ]
    }

    fn lower_limits(&self, found: &LoopMeasures) -> [(f64, f64); 5] {
        [
            (self.gain_margin_db, found.gain_margin_db),
            (self.phase_margin_deg, found.phase_margin_deg),
            (self.delay_margin_s, found.delay_margin_s),
            (self.decay_rad_s, found.decay_rad_s),
            (self.damping, found.damping),
        ]
    }

    /// Returns the limits with every limit tightened by a share of itself.
    pub(crate) fn tighten_by(&self, share: f64) -> Self {
        let (lowered, raised) = (1.0 - share, 1.0 + share);
        Self {
            max_sensitivity: self.max_sensitivity * lowered,
            max_complementary: self.max_complementary * lowered,
            gain_margin_db: self.gain_margin_db * raised,
            phase_margin_deg: self.phase_margin_deg * raised,
            delay_margin_s: self.delay_margin_s * raised,
            noise_gain: self.noise_gain * lowered,
            control_peak: self.control_peak * lowered,
            effort_v: self.effort_v * lowered,
            decay_rad_s: self.decay_rad_s * raised,
            damping: self.damping * raised,
        }
    }

    /// Returns the limits that a grid must keep so that the figures keep these: those of the last round, moved by what the
    /// worst plant's figures exceed.
    pub(crate) fn tighten(&self, last: &Self, found: &[LoopMeasures]) -> Self {
        let mut next = *last;
        for each in found {
            let over = |(limit, value): (f64, f64)| (limit / value).min(1.0) * (1.0 - LIMIT_TIGHTENING);
            let under = |(limit, value): (f64, f64)| (limit / value).max(1.0) * (1.0 + LIMIT_TIGHTENING);
            let lowered = |at: &mut f64, last: f64, pair: (f64, f64)| {
                if pair.1 > pair.0 {
                    *at = at.min(last * over(pair));
                }
            };
            let raised = |at: &mut f64, last: f64, pair: (f64, f64)| {
                if pair.1 < pair.0 {
                    *at = at.max(last * under(pair));
                }
            };
            let (upper, lower) = (self.upper_limits(each), self.lower_limits(each));
            lowered(&mut next.max_sensitivity, last.max_sensitivity, upper[0]);
            lowered(&mut next.max_complementary, last.max_complementary, upper[1]);
            lowered(&mut next.noise_gain, last.noise_gain, upper[2]);
            lowered(&mut next.control_peak, last.control_peak, upper[3]);
            lowered(&mut next.effort_v, last.effort_v, upper[4]);
            raised(&mut next.gain_margin_db, last.gain_margin_db, lower[0]);
            raised(&mut next.phase_margin_deg, last.phase_margin_deg, lower[1]);
            raised(&mut next.delay_margin_s, last.delay_margin_s, lower[2]);
            raised(&mut next.decay_rad_s, last.decay_rad_s, lower[3]);
            raised(&mut next.damping, last.damping, lower[4]);
        }
        next
    }
}

/// Returns the figures of the loop of a sampled plant (control to reading) and a sampled controller (error to control).
///
/// # Errors
/// [`Error::Lti`].
pub fn measure_loop(
    plant: &StateSpace,
    K: &StateSpace,
    disturbance: &Disturbance,
) -> Result<LoopMeasures, Error> {
    let L = series(plant, K)?;
    let margin = margins(&L)?;
    let unit = StateSpace::gain(Mat::eye(1), L.timebase)?;
    let closed = feedback(&L, &unit)?;
    let KS = feedback(K, plant)?;
    let crossover_rad_s = margin.phase.iter().map(|phase| phase.rate_rad_s).fold(0.0, f64::max);
    let (decay_rad_s, damping) = pole_region(&poles(&closed)?, plant, crossover_rad_s);
    let (plants, controllers) = (Response::of(plant)?, Response::of(K)?);
    let (mut left, mut effort) = (0.0, 0.0);
    for &[rate, power] in &disturbance.lines {
        let (P, C) = (plants.at(rate)?[(0, 0)], controllers.at(rate)?[(0, 0)]);
        let S = (C64::ONE + P * C).inv();
        left += power * S.norm_sqr();
        effort += power * (C * S).norm_sqr();
    }
    let noise = disturbance.reading_noise_rad_s;
    let of_noise = if noise > 0.0 { noise * h2norm(&closed)? } else { 0.0 };
    Ok(LoopMeasures {
        max_sensitivity: margin.ms.value,
        max_complementary: margin.mt.value,
        gain_margin_db: margin.gain_margin_db(),
        phase_margin_deg: margin.phase_margin().map_or(f64::INFINITY, |phase| phase.deg.abs()),
        delay_margin_s: margin.delay_s,
        crossover_rad_s,
        noise_gain: h2norm(&KS)?,
        control_peak: linfnorm(&KS, CONTROL_PEAK)?.value,
        effort_v: effort.sqrt(),
        residual_rad_s: left.sqrt().hypot(of_noise),
        decay_rad_s,
        damping,
    })
}

/// Returns the feedback of any controller as it runs, from the error to the control; feedforwards play no part in it.
///
/// # Errors
/// [`Error::Controller`].
pub fn feedback_path(controller: &Controller, sampling: &Sampling) -> Result<StateSpace, Error> {
    let linear = controller.linear(sampling.out_of_balance_kg_m)?;
    let hub = PathSignal::HubRate.reading().unwrap_or(1);
    Ok(driven_part(linear.select(&[0], &[hub])).negate())
}

/// Returns the figures of the feedback loop of any controller on a plant.
///
/// # Errors
/// [`Error::Lti`], [`Error::Controller`].
pub fn measure_controller(
    plant: &DesignPlant,
    controller: &Controller,
    sampling: &Sampling,
    disturbance: &Disturbance,
) -> Result<LoopMeasures, Error> {
    measure_loop(&sampled_plant(plant, sampling)?, &feedback_path(controller, sampling)?, disturbance)
}

/// Slowest decay in rad/s, and the smallest damping ratio of the poles up to twice the crossover.
pub(crate) fn pole_region(poles: &[C64], system: &StateSpace, crossover_rad_s: f64) -> (f64, f64) {
    let period_s = match system.timebase {
        Timebase::Discrete { period_s } => period_s,
        Timebase::Continuous => 1.0,
    };
    let (mut decay, mut damping) = (f64::INFINITY, 1.0_f64);
    for pole in poles.iter().filter(|pole| pole.norm() > FASTEST_POLE) {
        let s = pole.ln() / period_s;
        decay = decay.min(-s.re);
        if s.norm() <= REGION_REACH * crossover_rad_s {
            damping = damping.min(-s.re / s.norm().max(f64::MIN_POSITIVE));
        }
    }
    (decay, damping)
}

/// Decays of the poles of a sampled loop, rad/s.
pub(crate) fn decay_rates(poles: &[C64], system: &StateSpace) -> Vec<f64> {
    let period_s = match system.timebase {
        Timebase::Discrete { period_s } => period_s,
        Timebase::Continuous => 1.0,
    };
    poles.iter().filter(|pole| pole.norm() > FASTEST_POLE).map(|pole| -pole.norm().ln() / period_s).collect()
}
