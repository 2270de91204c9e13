//! The lags that are usual for a sensor, a control and a drive of which none is stated.
//!
//! Each key is open by itself: a sensor whose delay is stated may still filter, and a control that is computed within a sample period may still pass through a drive that
//! acts later. In a loop of one signal it does not matter where a lag is, so all of them act on the reading. The lags of a drive that takes a voltage belong to the
//! machine (`usual_ranges`), because its back-EMF acts within them.

use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase, pade, series};
use counterpoise_models::{AmplifierDynamics, Parameters, Sensor};
use counterpoise_project::{Assumption, LATEST_USUAL_DRIVE_S, Project, SLOWEST_USUAL_DRIVE_RAD_S};
use counterpoise_synth::{DesignPlant, LateReading};

use crate::PipelineError;
use crate::tolerance::WHOLE_SAMPLES;

/// Key of the delay of the control.
pub(super) const CONTROL_DELAY: &str = "plant.interface.output_delay_samples";
/// Order of the approximation of a delay that is usual: its phase is right to 1e-5 rad up to the inverse of the delay.
const DELAY_ORDER: usize = 3;

/// The lags that are usual where a file states none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct UsualLags {
    /// Delay of the reading, s.
    reading_delay_s: f64,
    /// Natural frequency of the sensor, rad/s; infinite if it is stated.
    sensor_rad_s: f64,
    /// Whole samples of delay of the control and of its drive.
    control_samples: usize,
    /// Bandwidth of a drive that controls its current, rad/s; infinite if it is stated, or if the drive takes something else.
    drive_rad_s: f64,
}

impl UsualLags {
    /// No lags.
    pub const NONE: Self = Self {
        reading_delay_s: 0.0,
        sensor_rad_s: f64::INFINITY,
        control_samples: 0,
        drive_rad_s: f64::INFINITY,
    };

    /// Returns the lags of what a project leaves open.
    pub fn of(project: &Project, assumptions: &[Assumption]) -> Self {
        let usual = |key: &str| assumptions.iter().filter(|open| open.key == key).find_map(|open| open.usual);
        let latest = |key: &str| usual(key).map_or(0.0, |[_, latest]| latest);
        let slowest = |key: &str| usual(key).map_or(f64::INFINITY, |[slowest, _]| slowest);
        let sensor = |key: &str| project.key_of_loop_sensor(key);
        let period_s = project.plant.interface.sample_period_s;
        // A drive of which not even the limit is stated is not known at all.
        let is_drive_open = project.plant.amplifier.dynamics == AmplifierDynamics::TorqueCommand
            && project.plant.cylinder.is_none()
            && usual("plant.drive.limit").is_some();
        let [drive_s, drive_rad_s] = match is_drive_open {
            true => [LATEST_USUAL_DRIVE_S, SLOWEST_USUAL_DRIVE_RAD_S],
            false => [latest("plant.drive.delay"), slowest("plant.drive.bandwidth")],
        };
        let samples = latest(CONTROL_DELAY) + (drive_s / period_s - WHOLE_SAMPLES).ceil().max(0.0);
        Self {
            reading_delay_s: latest(&sensor("delay")),
            sensor_rad_s: slowest(&sensor("natural_frequency")),
            control_samples: samples as usize,
            drive_rad_s,
        }
    }

    /// Returns whether there is none.
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// Returns whether the reading has any.
    pub fn has_reading_lags(&self) -> bool {
        !self.reading_lags().is_none()
    }

    /// Returns whether the control or its drive has any.
    pub fn has_control_lags(&self) -> bool {
        self.control_samples > 0 || self.drive_rad_s.is_finite()
    }

    /// Returns the lags without those of the control and its drive.
    pub fn reading_lags(&self) -> Self {
        let Self { reading_delay_s, sensor_rad_s, .. } = *self;
        Self { reading_delay_s, sensor_rad_s, ..Self::NONE }
    }

    /// Returns a plant with the lags, which act on its readings.
    ///
    /// # Errors
    /// Those of the sensor and of the approximation of a delay.
    pub fn late_plant(
        &self,
        plant: &DesignPlant,
        machine: &Parameters,
    ) -> Result<DesignPlant, PipelineError> {
        if self.is_none() {
            return Ok(plant.clone());
        }
        let known = match plant.late_reading.clone() {
            Some(reading) => reading,
            None => LateReading { dynamics: machine.sensors.hub_gyro.dynamics()?, delay_s: 0.0 },
        };
        let mut dynamics = known.dynamics;
        if self.reading_delay_s > 0.0 {
            dynamics = series(&dynamics, &pade(self.reading_delay_s, DELAY_ORDER)?)?;
        }
        if self.sensor_rad_s.is_finite() {
            let natural_frequency_rad_s = self.sensor_rad_s;
            let sensor = Sensor { natural_frequency_rad_s, ..Sensor::IDEAL };
            dynamics = series(&dynamics, &sensor.dynamics()?)?;
        }
        if self.drive_rad_s.is_finite() {
            dynamics = series(&dynamics, &first_order_lag(self.drive_rad_s)?)?;
        }
        let delay_s = known.delay_s + self.control_samples as f64 * machine.interface.sample_period_s;
        Ok(DesignPlant { late_reading: Some(LateReading { dynamics, delay_s }), ..plant.clone() })
    }
}

/// Returns a lag of first order with a corner.
fn first_order_lag(corner_rad_s: f64) -> Result<StateSpace, PipelineError> {
    let scalar = |value: f64| Mat::from_rows(&[&[value]]);
    let (pole, gain) = (scalar(-corner_rad_s), scalar(corner_rad_s));
    Ok(StateSpace::new(pole, gain, Mat::eye(1), Mat::zeros(1, 1), Timebase::Continuous)?)
}
