//! The out-of-balance estimated from the control while the machine runs.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::PathSignal;

/// Estimates the out-of-balance from the control, and sets it
///
/// ```text
///     phi = (g cos(theta) + a_p, w / (|w| + w0), w, 1)        v = phi p
///     M   = p_0 / volts_per_kg_m_s2, moved by at most `rate_limit_kg_m_s` T a sample, kept inside the range
/// ```
///
/// M stands still until the estimate differs from it by more than `hold_band_kg_m`. It is then followed until the estimate itself
/// has moved by no more than a quarter of the band for `follow_samples`: M then stands still again, at a settled estimate.
///
/// with theta the hub's position reading, a_p the platform's acceleration reading, w the rate. How p is learnt is the
/// [`Learning`]. It acts on the feedforward's gain and the bias only: no estimate can make the linear loop unstable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Estimator {
    /// Law of the learning.
    pub learning: Learning,
    /// Acceleration of gravity along the axis that the imbalance feels, m/s^2; 0 in azimuth or without gravity.
    pub gravity_m_s2: f64,
    /// Rate of the friction regressors.
    pub rate: PathSignal,
    /// Rate w0 at which the dry regressor is half grown, rad/s.
    pub half_rate_rad_s: f64,
    /// Volts that hold one kg m at one m/s^2.
    pub volts_per_kg_m_s2: f64,
    /// Largest change of the out-of-balance, kg m/s; infinite for none.
    #[serde(serialize_with = "limit_or_none", deserialize_with = "none_is_infinite")]
    pub rate_limit_kg_m_s: f64,
    /// The out-of-balance in force stands still while the estimate is no further from it than this, kg m: the noise of an estimate then
    /// makes nothing worse. 0 for none.
    #[serde(default)]
    pub hold_band_kg_m: f64,
    /// Number of samples for which an estimate must stand before it is no longer followed; 0 to follow it to the edge of the hold band only.
    #[serde(default)]
    pub follow_samples: u32,
    /// Number of samples before the out-of-balance in force begins to follow the estimate.
    pub hold_samples: u32,
}

/// Law by which an [`Estimator`] learns.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Learning {
    /// Normalised gradient on the first three regressors:
    /// `p += step (u - v) phi / (1 + phi' S phi) S, S = diag(scale^2)`; stable for 0 < step < 2.
    Gradient {
        /// Adaptation step, 0 < step < 2.
        step: f64,
        /// Typical sizes of the three parameters relative to each other's regressors.
        scale: [f64; 3],
    },
    /// The mean of the control over each window, over that of gravity's share: p_0 is set at the end of every window, the
    /// step that this makes faded in over the transfer time. The other regressors are not used. A setting of the
    /// out-of-balance begins a new window. Gravity's share counts at least half of gravity.
    Mean {
        /// Samples of a window.
        window_samples: u32,
    },
    /// Recursive least squares with forgetting, on the first three regressors, and on the fourth if gravity is 0.
    ///
    /// Control and regressors first pass the same lag `filter_s`, which leaves their relation as it is and gives the
    /// accelerations of hub and rate; what the inertias take is known, and is taken from the control.
    ///
    /// The covariance is kept as U D U' (G. J. Bierman, *Factorization Methods for Discrete Sequential Estimation*, 1977),
    /// so that it stays positive in single precision. Two factors between 0 and 1 hold it back: learning fades out where
    /// the mean square of the platform's acceleration falls from 1.21 to 1 times `dead_band_m_s2`^2, and forgetting fades out
    /// where a variance grows from 9 to 10 times its start. What one sample tells counts at most 1e9 times all before.
    Squares {
        /// The share of the weight of those before it that a sample keeps, 0 < forget < 1.
        forget: f64,
        /// Below this RMS of the platform's acceleration the estimate stands still, m/s^2; 0 for none. Gravity does not count.
        dead_band_m_s2: f64,
        /// Standard deviations of the parameters at the start: V per m/s^2, V, V s/rad, V.
        deviation: [f64; 4],
        /// Lag that control and regressors pass, s; 0 for none, and then the inertias are not used.
        filter_s: f64,
        /// Volts that accelerate the hub, and what follows the estimator's rate, by 1 rad/s^2.
        inertia_v_s2_rad: [f64; 2],
    },
}

/// Writes a limit; an infinite one, which JSON has no number for, as none.
fn limit_or_none<S: Serializer>(limit: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    limit.is_finite().then_some(limit).serialize(serializer)
}

/// Reads what [`limit_or_none`] wrote.
fn none_is_infinite<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
}
