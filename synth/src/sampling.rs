//! The additions of sampling to a design, and the sampled loop that a controller makes.

use counterpoise_controller::sensitivity::RealisationForm;
use counterpoise_controller::{Controller, PathSignal};
use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{Discretisation, StateSpace, c2d, delay_samples, poles, series};

use crate::cause::{Cause, PlantCause};
use crate::certificate::PartCertificates;
use crate::finding::{DesignFinding, Part};
use crate::{DesignPlant, Error};

/// Method by which a controller for sampled time is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SamplingMethod {
    /// Each continuous path is converted by itself.
    Emulation(Discretisation),
    /// Every part is designed anew on the sampled problem: hold and delay exact, the cost of the time between the samples
    /// included. A feedback that stands in place of the three-part one, and the demand's
    /// prefilter, are converted by the bilinear map: they have no sampled problem.
    SampledData,
}

impl SamplingMethod {
    /// The bilinear map, without prewarping.
    pub const TUSTIN: Self = Self::Emulation(Discretisation::Tustin { prewarp_rad_s: None });

    /// Returns how a continuous path that has no sampled problem of its own is converted.
    pub fn conversion(self) -> Discretisation {
        match self {
            Self::Emulation(method) => method,
            Self::SampledData => Discretisation::Tustin { prewarp_rad_s: None },
        }
    }
}

/// Sampling of a design: the period, the hold and the converters.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampling {
    /// Sample period, s.
    pub period_s: f64,
    /// Discretisation of each path.
    pub method: SamplingMethod,
    /// The form in which each path runs.
    pub form: RealisationForm,
    /// The control is limited to +/- this, V.
    pub limit_v: f64,
    /// Whole samples of delay of the real loop beyond the hold, for the check of the sampled loop.
    pub delay_samples: usize,
    /// Out-of-balance that the plant was taken at, kg m; 0 keeps the heave feedforward's gain fixed.
    pub out_of_balance_kg_m: f64,
    /// Lowest and highest out-of-balance that may be set, kg m.
    pub out_of_balance_range_kg_m: (f64, f64),
    /// Volts that hold one kg m against gravity.
    pub bias_v_per_kg_m: f64,
    /// Time in which the step of a changed out-of-balance fades in, s.
    pub transfer_time_s: f64,
}

impl Sampling {
    /// Returns Tustin's method, no further delay, no out-of-balance.
    pub fn new(period_s: f64, limit_v: f64) -> Self {
        Self {
            period_s,
            method: SamplingMethod::TUSTIN,
            form: RealisationForm::LeastSensitive,
            limit_v,
            delay_samples: 0,
            out_of_balance_kg_m: 0.0,
            out_of_balance_range_kg_m: (-1e6, 1e6),
            bias_v_per_kg_m: 0.0,
            transfer_time_s: 0.0,
        }
    }
}

impl Sampling {
    /// Returns the sample rate, rad/s.
    pub fn rate_rad_s(&self) -> f64 {
        std::f64::consts::TAU / self.period_s
    }

    /// Returns half the sample rate, rad/s: the highest frequency that samples show.
    pub fn highest_rad_s(&self) -> f64 {
        0.5 * self.rate_rad_s()
    }
}

/// A sampled controller with the loop it makes.
#[derive(Debug, Clone)]
pub struct SampledLoop {
    /// The controller, in the realisation in which it runs.
    pub controller: Controller,
    /// The loop cut at the control, from control to the negative of the control that comes back: feed it to `margins`.
    pub loop_gain: StateSpace,
    /// Poles of the closed sampled loop.
    pub closed_loop: Vec<C64>,
    /// The certificates of the parts that were designed in sampled time; empty with [`SamplingMethod::Emulation`].
    pub certified: Vec<PartCertificates>,
}

impl SampledLoop {
    /// Returns the largest relative difference between predicted and achieved cost over the parts designed in sampled time;
    /// `None` if there are none, or none of them has both.
    pub fn worst_cost_difference(&self) -> Option<f64> {
        self.certified.iter().filter_map(|part| part.cost.relative_difference()).max_by(f64::total_cmp)
    }
}

/// Returns a controller with the sampled loop it makes around a plant, refused where that is not stable.
///
/// # Errors
/// [`Error`] for a plant that is not one.
pub fn check_sampled_loop(
    plant: &DesignPlant,
    controller: Controller,
    sampling: &Sampling,
) -> Result<SampledLoop, Error> {
    let loop_gain = sampled_loop(plant, &controller, sampling)?;
    let closed = counterpoise_lti::feedback(&loop_gain, &StateSpace::gain(Mat::eye(1), loop_gain.timebase)?)?;
    let closed_loop = poles(&closed)?;
    let largest = closed_loop.iter().copied().max_by(|a, b| a.norm().total_cmp(&b.norm()));
    match largest {
        Some(pole) if pole.norm() >= 1.0 => {
            let cause = Cause::Plant(PlantCause::SampledUnstable { pole, period_s: sampling.period_s });
            let rate = (pole.arg() / sampling.period_s).abs();
            Err(Error::refusal(vec![DesignFinding::refusal(Part::Feedback, cause).at(rate)]))
        }
        _ => Ok(SampledLoop { controller, loop_gain, closed_loop, certified: Vec::new() }),
    }
}

/// Returns the sampled loop cut at the control: plant and hub sensor under a zero-order hold, delayed by whole samples, then the
/// controller from the hub rate; the sign is that of negative feedback.
///
/// # Errors
/// [`Error::Lti`], [`Error::Controller`].
pub fn sampled_loop(
    plant: &DesignPlant,
    controller: &Controller,
    sampling: &Sampling,
) -> Result<StateSpace, Error> {
    let seen = sampled_plant(plant, sampling)?;
    let linear = controller.linear(sampling.out_of_balance_kg_m)?;
    let hub = PathSignal::HubRate.reading().unwrap_or(1);
    Ok(series(&seen, &linear.select(&[0], &[hub]).negate())?)
}

/// Returns the plant with its sensor and delay under a zero-order hold: from the held control to the reading. A reading that is late is so by
/// whole samples.
///
/// # Errors
/// [`Error`] of the plant and of the conversion.
pub fn sampled_plant(plant: &DesignPlant, sampling: &Sampling) -> Result<StateSpace, Error> {
    let late = plant.late_reading.as_ref();
    let hub_sensor = late.map(|reading| reading.dynamics.clone()).or_else(|| plant.hub_sensor.clone());
    let late_samples = late.map_or(0, |reading| reading.samples(sampling.period_s));
    let undelayed = DesignPlant { pade_order: 0, hub_sensor, ..plant.clone() };
    let seen = undelayed.measured_plant()?.select(&[0], &[plant.control]);
    let held = c2d(&seen, sampling.period_s, Discretisation::ZeroOrderHold)?;
    match sampling.delay_samples + late_samples {
        0 => Ok(held),
        count => Ok(series(&delay_samples(count, sampling.period_s)?, &held)?),
    }
}
