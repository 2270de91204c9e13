//! The figures of a sampled feedback loop that a search needs: margins, overshoot, rejection, effort.

use counterpoise_controller::PathSignal;
use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::components::driven_states;
use counterpoise_lti::response::Response;
use counterpoise_lti::{Discretisation, StateSpace, c2d, h2norm, margins};

use crate::{DesignPlant, Error, SampledLoop, Sampling};

/// Figures of a sampled feedback loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    /// Smallest gain margin, dB.
    pub gain_margin_db: f64,
    /// Smallest phase margin, degrees; infinite without crossover.
    pub phase_margin_deg: f64,
    /// Largest sensitivity.
    pub ms: f64,
    /// Highest frequency at which the loop's gain is 1, rad/s; 0 without crossover.
    pub crossover_rad_s: f64,
    /// Peak of the true rate after a unit step of the demand, less 1.
    pub overshoot: f64,
    /// Largest control after a unit step of the demand, V s/rad.
    pub step_control_v: f64,
    /// RMS control for measurement noise of unit RMS, V s/rad.
    pub noise_gain: f64,
    /// RMS of |S| over the band of interest: the share of a disturbance that is left.
    pub rejection: f64,
}

/// The systems that the figures of a sampled feedback loop are measured on.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureSystems {
    /// The loop broken at the control: 1 + L is the return difference.
    pub broken: StateSpace,
    /// From the held control to measured and true rate.
    pub plant: StateSpace,
    /// From demand and measured rate to the control.
    pub controller: StateSpace,
}

/// Returns the systems on which [`sampled_loop_figures`] measures a loop.
///
/// # Errors
/// As [`sampled_loop_figures`].
pub fn figure_systems(
    plant: &DesignPlant,
    sampled: &SampledLoop,
    sampling: &Sampling,
) -> Result<FigureSystems, Error> {
    Ok(FigureSystems {
        broken: sampled.loop_gain.clone(),
        plant: hold_system(plant, sampling)?,
        controller: controller(sampled, sampling)?,
    })
}

/// Over how many seconds a step is watched.
pub const STEP_S: f64 = 1.5;
/// Frequencies in the band.
pub(crate) const BAND_POINTS: usize = 24;

/// Returns the figures of a sampled feedback loop; rejection over the band [low, high], rad/s.
///
/// # Errors
/// [`Error`] if the plant is not one, or a decomposition fails.
pub fn sampled_loop_figures(
    plant: &DesignPlant,
    sampled: &SampledLoop,
    sampling: &Sampling,
    band_rad_s: [f64; 2],
) -> Result<Figures, Error> {
    let margin = margins(&sampled.loop_gain)?;
    let (peak, control) = step(plant, sampled, sampling)?;
    let crossings = margin.phase.iter().map(|phase| phase.rate_rad_s);
    Ok(Figures {
        gain_margin_db: margin.gain_margin_db(),
        phase_margin_deg: margin.phase_margin().map_or(f64::INFINITY, |phase| phase.deg),
        ms: margin.ms.value,
        crossover_rad_s: crossings.fold(0.0, f64::max),
        overshoot: peak - 1.0,
        step_control_v: control,
        noise_gain: noise_gain(plant, sampled, sampling)?,
        rejection: rejection(&sampled.loop_gain, band_rad_s, &[1.0; BAND_POINTS])?,
    })
}

/// Measured and true rate from the held control.
fn hold_system(plant: &DesignPlant, sampling: &Sampling) -> Result<StateSpace, Error> {
    let undelayed = DesignPlant { pade_order: 0, ..plant.clone() };
    let seen = undelayed.measured_plant()?.select(&[0, 1 + plant.rate], &[plant.control]);
    Ok(c2d(&seen, sampling.period_s, Discretisation::ZeroOrderHold)?)
}

/// From (demand, hub rate) to the control.
fn controller(sampled: &SampledLoop, sampling: &Sampling) -> Result<StateSpace, Error> {
    let linear = sampled.controller.linear(sampling.out_of_balance_kg_m)?;
    let reading = |signal: PathSignal, fallback: usize| signal.reading().unwrap_or(fallback);
    let inputs = [reading(PathSignal::Demand, 0), reading(PathSignal::HubRate, 1)];
    Ok(driven_part(linear.select(&[0], &inputs)))
}

/// Returns a system without the states that no input drives: they stay at zero.
pub(crate) fn driven_part(g: StateSpace) -> StateSpace {
    let driven = driven_states(&g);
    let (inputs, outputs): (Vec<usize>, Vec<usize>) = ((0..g.inputs()).collect(), (0..g.outputs()).collect());
    StateSpace {
        A: g.A.select(&driven, &driven),
        B: g.B.select(&driven, &inputs),
        C: g.C.select(&outputs, &driven),
        ..g
    }
}

/// Peak of the true rate and of the control after a unit step of the demand.
fn step(plant: &DesignPlant, sampled: &SampledLoop, sampling: &Sampling) -> Result<(f64, f64), Error> {
    let (P, K) = (hold_system(plant, sampling)?, controller(sampled, sampling)?);
    let (mut x, mut q) = (Mat::zeros(P.order(), 1), Mat::zeros(K.order(), 1));
    let (mut peak, mut largest) = (0.0_f64, 0.0_f64);
    for _ in 0..(STEP_S / sampling.period_s).ceil() as usize {
        let y = &P.C * &x;
        let read = Mat::col(&[1.0, y[(0, 0)]]);
        let u = &(&K.C * &q) + &(&K.D * &read);
        (peak, largest) = (peak.max(y[(1, 0)]), largest.max(u[(0, 0)].abs()));
        q = &(&K.A * &q) + &(&K.B * &read);
        x = &(&P.A * &x) + &(&P.B * &u);
    }
    Ok((peak, largest))
}

fn noise_gain(plant: &DesignPlant, sampled: &SampledLoop, sampling: &Sampling) -> Result<f64, Error> {
    let seen = hold_system(plant, sampling)?.select(&[0], &[0]);
    let K = controller(sampled, sampling)?.select(&[0], &[1]);
    Ok(h2norm(&counterpoise_lti::feedback(&K, &seen.negate())?)?)
}

/// Point k of the band, rad/s.
pub(crate) fn band_rate([low, high]: [f64; 2], k: usize) -> f64 {
    low * (high / low).powf(k as f64 / (BAND_POINTS - 1) as f64)
}

/// RMS of |S| over the band, averaged by the given powers.
pub(crate) fn rejection(
    loop_gain: &StateSpace,
    band_rad_s: [f64; 2],
    powers: &[f64; BAND_POINTS],
) -> Result<f64, Error> {
    let response = Response::of(loop_gain)?;
    let mut sum = 0.0;
    for (k, power) in powers.iter().enumerate() {
        let L = response.at(band_rate(band_rad_s, k))?[(0, 0)];
        sum += power * (C64::ONE + L).norm_sqr().recip();
    }
    Ok((sum / powers.iter().sum::<f64>()).sqrt())
}
