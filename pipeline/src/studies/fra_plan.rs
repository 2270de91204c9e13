//! The signals that a map of frequency responses relates, and its points, unless something else is asked for.

use counterpoise_models::CONVERTER_RANGE_V;
use counterpoise_project::Project;

use super::fra::{LoopUnderTest, MeasurementPlan};
use crate::frequencies::logarithmic_hz;

/// The size of what is excited over the usual amplitudes of a map: more than a decade, in which friction shows. A size of 0.1 divided by them
/// gives the numbers that a reader writes, 0.01 and not 0.010000000000000002.
const SIZE_OVER_AMPLITUDES: [f64; 5] = [10.0, 5.0, 2.0, 1.0, 0.5];
/// Size of a control: its share of the largest control, so that the largest usual amplitude stays far from the limit.
const USUAL_CONTROL_SHARE: f64 = 0.1;
/// Size of a platform's rate, rad/s: that of a vehicle on a road.
const USUAL_PLATFORM_RATE_RAD_S: f64 = 0.1;
/// Lowest and highest of the usual frequencies, Hz, and their number.
const USUAL_FREQUENCIES_HZ: [f64; 2] = [0.3, 30.0];
const USUAL_FREQUENCIES: usize = 25;
/// Amplitudes of the platform's rate of a quick map, rad/s: from the rates at which friction sticks to those at which it slides.
const QUICK_AMPLITUDES_RAD_S: [f64; 4] = [0.02, 0.05, 0.1, 0.2];
/// Number of frequencies of a quick map: ten a decade.
const QUICK_FREQUENCIES: usize = 21;
/// Highest usual frequency over the sample rate: below one half, where a sampled sine has no amplitude of its own.
const USUAL_SAMPLED_SHARE: f64 = 0.4;

/// Returns the usual frequencies of a map, Hz, on a logarithmic scale; none is near half the sample rate.
pub fn usual_frequencies_hz(project: &Project) -> Vec<f64> {
    let [from_hz, to_hz] = USUAL_FREQUENCIES_HZ;
    let to_hz = to_hz.min(USUAL_SAMPLED_SHARE / project.plant.interface.sample_period_s);
    logarithmic_hz([from_hz.min(0.1 * to_hz), to_hz], USUAL_FREQUENCIES)
}

/// Returns the plan of a map that is measured while a designer waits: from the platform's motion to the hub, with fewer amplitudes and
/// frequencies than the usual map.
pub fn quick_plan() -> MeasurementPlan {
    let [low, high] = USUAL_FREQUENCIES_HZ;
    let frequency = |k: usize| low * (high / low).powf(k as f64 / (QUICK_FREQUENCIES - 1) as f64);
    MeasurementPlan {
        around: LoopUnderTest::Disturbance,
        amplitudes: QUICK_AMPLITUDES_RAD_S.to_vec(),
        frequencies_hz: (0..QUICK_FREQUENCIES).map(frequency).collect(),
        offset_m: 0.0,
    }
}

impl LoopUnderTest {
    /// Returns what a map of a project's machine relates unless something else is asked for: the hub to the platform's motion if a
    /// gyroscope on the platform reads that, otherwise to the demand.
    pub fn usual_of(project: &Project) -> Self {
        if project.plant.sensors.platform_gyro.is_fitted() { Self::Disturbance } else { Self::Closed }
    }

    /// Returns the usual amplitudes of what is excited, in its unit: shares of the largest control, multiples of the step of the demand that is
    /// verified, or rates of the platform.
    pub fn usual_amplitudes(self, project: &Project) -> [f64; 5] {
        let limit_v = project.plant.amplifier.input_limit_v;
        let size = match self {
            Self::Plant if limit_v.is_finite() => USUAL_CONTROL_SHARE * limit_v,
            // a machine that states no limit has that of the converters
            Self::Plant => USUAL_CONTROL_SHARE * CONVERTER_RANGE_V,
            Self::Closed => usual_demand(project),
            Self::Disturbance | Self::Disconnected => USUAL_PLATFORM_RATE_RAD_S,
        };
        SIZE_OVER_AMPLITUDES.map(|over| size / over)
    }
}

/// Returns the size of a demand in its unit: the step that is verified, or that of a project that verifies nothing.
fn usual_demand(project: &Project) -> f64 {
    let step = project.verify.as_ref().map(|verify| verify.procedure.step.rate_rad_s.abs());
    step.filter(|size| *size > 0.0).unwrap_or(USUAL_PLATFORM_RATE_RAD_S)
}
