//! The parts of a controller: plain data, checked when a controller is built from it.

use counterpoise_lti::StateSpace;
use serde::{Deserialize, Serialize};

use crate::tolerance::READING_LIMITS;
use crate::{COMMON_READINGS, Estimator, FrictionObserver, LevelLearning, PathSignal, READINGS};

/// A discrete transfer path from signals to volts
///
/// ```text
///     y[k]   = gain (C x[k] + D u[k])
///     x[k+1] = A x[k] + B u[k] + anti_windup (limited - unlimited control)
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    /// Name: a lower-case identifier, for target code and reports.
    pub name: String,
    /// The signals u, one an input of `system`.
    pub inputs: Vec<PathSignal>,
    /// Discrete system with one output, in the realisation in which it is to run (see [`crate::realisation::modal_form`]).
    pub system: StateSpace,
    /// Gain a state on what the limiter cut off; zeros if the path does not wind up.
    pub anti_windup: Vec<f64>,
    /// Scaling of the output with the out-of-balance.
    pub scaling: Scaling,
}

impl Path {
    /// Returns whether the path feeds back a motion that the control moves.
    pub fn is_feedback(&self) -> bool {
        let fed_back =
            [PathSignal::HubRate, PathSignal::RateError, PathSignal::MotorRate, PathSignal::HubPosition];
        self.inputs.iter().any(|input| fed_back.contains(input))
    }
}

/// Law by which a path's output follows the out-of-balance M that is set.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Scaling {
    /// The output does not follow the out-of-balance.
    Fixed,
    /// Gain M / design out-of-balance: the gain law.
    WithOutOfBalance,
    /// One design of several, each made for an out-of-balance: gain 1 at `at_kg_m`, falling linearly to 0 at its
    /// neighbours, and held beyond the first and the last design.
    Scheduled {
        /// Neighbour below, kg m; `None` for the lowest design.
        below_kg_m: Option<f64>,
        /// The out-of-balance that this path was designed for, kg m.
        at_kg_m: f64,
        /// Neighbour above, kg m; `None` for the highest design.
        above_kg_m: Option<f64>,
    },
}

/// Correction of a reading: corrected = gain reading + offset.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Correction {
    /// Index of the reading in [`crate::READING_NAMES`].
    pub reading: usize,
    /// Gain, 1 for none.
    pub gain: f64,
    /// Offset, in the unit of the reading.
    pub offset: f64,
}

/// Projection of the platform's heave and surge across the beam
///
/// ```text
///     a = a_z cos(theta) - a_x sin(theta)
/// ```
///
/// which is what the out-of-balance feels at the elevation theta. It takes the place of the heave reading in every path and in the estimator, so that
/// the geometry schedules the heave feedforward over elevation. Sine and cosine are Taylor series to the ninth order within
/// [`HIGHEST_ELEVATION_RAD`](crate::tolerance::HIGHEST_ELEVATION_RAD), at which theta is limited.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Projection {
    /// Elevation of the design, rad: that of the linear part.
    pub design_angle_rad: f64,
    /// Index of the reading that is theta, in [`crate::READING_NAMES`]; `None` keeps theta at the elevation of the design.
    pub angle_reading: Option<usize>,
    /// Time constant, s, within which the platform's pitch angle is the integral of its gyroscope, added to the reading of the angle: theta is then
    /// inertial for motion faster than this. A bias b of the gyroscope leaves an angle of b times this. `None` takes the reading as it is.
    pub pitch_washout_s: Option<f64>,
}

/// Limit of the rate with which a loop of position follows its demand.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", content = "most", rename_all = "kebab-case")]
pub enum DemandLimit {
    /// The error between demand and reading is kept within +/- this. A position loop in cascade demands its gain times the error
    /// as rate, so that its demanded rate is limited.
    Error(f64),
    /// The demand that the paths see moves by at most this a second, from the first reading on.
    Rate(f64),
}

/// All parts of a controller.
#[derive(Debug, Clone, PartialEq)]
pub struct Parts {
    /// Sample period, s.
    pub sample_period_s: f64,
    /// Corrections of readings, at most one a reading; usually none.
    pub corrections: Vec<Correction>,
    /// Projection of heave and surge across the beam; `None` if the heave reading is taken as it is.
    pub projection: Option<Projection>,
    /// Reference prefilter from demand to demand, discrete, one input and one output.
    pub prefilter: Option<StateSpace>,
    /// Limit of the rate with which a loop of position follows its demand; `None` for a loop of rate, or without a limit.
    pub demand_limit: Option<DemandLimit>,
    /// Transfer paths, in the order in which their outputs are summed.
    pub paths: Vec<Path>,
    /// Friction observers, summed after the paths.
    pub observers: Vec<FrictionObserver>,
    /// The learning of the friction's level; `None` cancels what the observers give.
    pub level_learning: Option<LevelLearning>,
    /// Out-of-balance that the paths were designed for, kg m.
    pub design_out_of_balance_kg_m: f64,
    /// Lowest and highest out-of-balance that may be set, kg m.
    pub out_of_balance_range_kg_m: (f64, f64),
    /// Volts that hold one kg m of out-of-balance against gravity, V/(kg m).
    pub bias_v_per_kg_m: f64,
    /// Time constant with which the step of a changed out-of-balance fades in, s; 0 lets it through at once.
    pub transfer_time_s: f64,
    /// Estimator of the out-of-balance.
    pub estimator: Option<Estimator>,
    /// The inverse of the drive's measured curve: (volts of a linear drive, control that has their effect), both rising
    /// from beyond 0; odd, straight between, of slope 1 beyond the last. Empty if the drive is linear.
    ///
    /// Everything before it (paths, limiter, anti-windup, estimator) is in volts of a linear drive.
    pub drive_curve: Vec<[f64; 2]>,
    /// The control is limited to +/- this, V.
    pub limit_v: f64,
    /// Largest magnitude of each reading, in the order of [`crate::READING_NAMES`]; one beyond it is replaced by the last good
    /// one.
    pub reading_limits: [f64; READINGS],
}

impl Parts {
    /// Returns the control limit in volts of a linear drive: the limit, seen through the drive's curve.
    pub(crate) fn equivalent_limit_v(&self) -> f64 {
        let mut from = [0.0, 0.0];
        for to in &self.drive_curve {
            if to[1] >= self.limit_v {
                let slope = (to[0] - from[0]) / (to[1] - from[1]);
                return from[0] + slope * (self.limit_v - from[1]);
            }
            from = *to;
        }
        from[0] + self.limit_v - from[1]
    }

    /// Returns the part of the friction that its observers cancel when their level is right.
    pub fn cancelled_part(&self) -> f64 {
        self.level_learning.map_or(1.0, |learning| learning.cancelled)
    }

    /// Returns parts without paths and observers: control 0 within +/- `limit_v`, out-of-balance 0 within +/- 1e6 kg m.
    pub fn new(sample_period_s: f64, limit_v: f64) -> Self {
        Self {
            sample_period_s,
            corrections: Vec::new(),
            projection: None,
            prefilter: None,
            demand_limit: None,
            paths: Vec::new(),
            observers: Vec::new(),
            level_learning: None,
            design_out_of_balance_kg_m: 0.0,
            out_of_balance_range_kg_m: (-1e6, 1e6),
            bias_v_per_kg_m: 0.0,
            transfer_time_s: 0.0,
            estimator: None,
            drive_curve: Vec::new(),
            limit_v,
            reading_limits: READING_LIMITS,
        }
    }

    /// Returns the number of readings that the controller takes: those of every controller, and surge where it is projected.
    pub fn reading_count(&self) -> usize {
        if self.projection.is_some() { READINGS } else { COMMON_READINGS }
    }
}
