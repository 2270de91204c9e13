//! The out-of-balance by recursive least squares with forgetting.

use counterpoise_controller::Readings;

use super::Scale;
use crate::Error;

/// Settings of [`RecursiveLeastSquares`].
#[derive(Debug, Clone, PartialEq)]
pub struct RecursiveSettings {
    /// The machine.
    pub scale: Scale,
    /// Forgetting time, s: what lies further back counts less than 1/e.
    pub memory_s: f64,
    /// Sample period, s.
    pub sample_period_s: f64,
    /// Below this RMS of the platform's acceleration, m/s^2, the estimate stands still. Gravity does not count.
    pub dead_band_m_s2: f64,
    /// Rate at which the sign of the rate counts half, rad/s: a soft sign, for a rate that is noise near zero.
    pub half_rate_rad_s: f64,
    /// Largest change of the estimate, kg m/s.
    pub rate_limit_kg_m_s: f64,
    /// Estimate to start from, kg m.
    pub start_kg_m: f64,
    /// Standard deviation of the start, kg m.
    pub start_deviation_kg_m: f64,
    /// Lag that control and regressors pass, s: their relation stays, and accelerations are known. 0 for none.
    pub filter_s: f64,
    /// Volts that accelerate the hub, and the hub against the platform, by 1 rad/s^2; used with a filter alone.
    pub inertia_v_s2_rad: [f64; 2],
}

/// Recursive least squares with forgetting on
///
/// ```text
///     u = p0 (g cos theta + a) + p1 sign(w) + p2 w + p3,    M = p0 / volts per kg m per m/s^2
/// ```
///
/// with w the hub's rate relative to the platform, a the accelerometer's reading. The fourth regressor (a constant) is
/// used only without gravity, where it takes what is not the imbalance's: with gravity it could not be told from it.
/// Learning fades out where the mean square of the platform's acceleration falls from 1.21 to 1 times the dead-band's, forgetting
/// where a variance grows from 9 to 10 times its start. The controller's own estimator
/// ([`counterpoise_controller::Learning::Squares`]) is the same with the covariance in factors.
#[derive(Debug, Clone)]
pub struct RecursiveLeastSquares {
    settings: RecursiveSettings,
    parameters: [f64; SIZE],
    covariance: [[f64; SIZE]; SIZE],
    lagged: [f64; SIZE + 1],
    excitation: f64,
    estimate: f64,
}

/// Number of regressors.
const SIZE: usize = 4;
/// Parameters other than the imbalance start with this standard deviation, V or V s/rad.
const LOOSE: f64 = 10.0;
/// Forgetting fades while a variance grows between these times its start.
const WIND_UP: (f64, f64) = (9.0, 10.0);
/// The mean square over that of the dead-band at which learning is whole.
const WHOLE: f64 = 1.21;

impl RecursiveLeastSquares {
    /// Returns the estimator at its start.
    ///
    /// # Errors
    /// [`Error::Range`] for times, limits or volts that are not positive.
    pub fn new(settings: RecursiveSettings) -> Result<Self, Error> {
        let positive = [
            ("memory in s", settings.memory_s),
            ("sample period in s", settings.sample_period_s),
            ("half rate in rad/s", settings.half_rate_rad_s),
            ("rate limit in kg m/s", settings.rate_limit_kg_m_s),
            ("start deviation in kg m", settings.start_deviation_kg_m),
            ("volts a kg m a m/s^2", settings.scale.volts_per_kg_m_s2.abs()),
        ];
        for (what, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::Range { what, value, allowed: "positive" });
            }
        }
        let volts = settings.scale.volts_per_kg_m_s2;
        let mut parameters = [0.0; SIZE];
        parameters[0] = settings.start_kg_m * volts;
        let covariance = start_covariance(&settings);
        let estimate = settings.start_kg_m;
        let lagged = [0.0; SIZE + 1];
        Ok(Self { settings, parameters, covariance, lagged, excitation: 0.0, estimate })
    }

    /// Returns the estimate, kg m.
    pub fn estimate_kg_m(&self) -> f64 {
        self.estimate
    }

    /// Takes a sample and gives the estimate, kg m.
    pub fn update(&mut self, readings: &Readings, control_v: f64) -> f64 {
        let (phi, volts) = self.lag(readings, self.settings.scale.curve.at(control_v));
        let forget = (-self.settings.sample_period_s / self.settings.memory_s).exp();
        let heave = readings.platform_accel_m_s2;
        self.excitation = forget * self.excitation + (1.0 - forget) * heave * heave;
        let gate = self.gate();
        self.learn(&phi.map(|regressor| gate * regressor), gate * volts, 1.0 - (1.0 - forget) * gate);
        let wanted = self.parameters[0] / self.settings.scale.volts_per_kg_m_s2;
        let step = self.settings.rate_limit_kg_m_s * self.settings.sample_period_s;
        self.estimate += (wanted - self.estimate).clamp(-step, step);
        self.estimate
    }

    fn regressors(&self, readings: &Readings) -> [f64; SIZE] {
        let rate = readings.hub_rate_rad_s - readings.platform_rate_rad_s;
        let gravity = self.settings.scale.gravity_m_s2;
        let constant = if gravity == 0.0 { 1.0 } else { 0.0 };
        [
            gravity * readings.hub_position_rad.cos() + readings.platform_accel_m_s2,
            rate / (rate.abs() + self.settings.half_rate_rad_s),
            rate,
            constant,
        ]
    }

    /// Returns 1 if the platform is lively, 0 inside the dead-band.
    fn gate(&self) -> f64 {
        let dead_band = self.settings.dead_band_m_s2;
        if dead_band == 0.0 {
            return 1.0;
        }
        ((self.excitation / (dead_band * dead_band) - 1.0) / (WHOLE - 1.0)).clamp(0.0, 1.0)
    }

    /// Regressors, and the volts less what the inertias take, after the lag.
    fn lag(&mut self, readings: &Readings, volts: f64) -> ([f64; SIZE], f64) {
        let phi = self.regressors(readings);
        if self.settings.filter_s == 0.0 {
            return (phi, volts);
        }
        let period_s = self.settings.sample_period_s;
        let share = period_s / (self.settings.filter_s + period_s);
        let all = [phi[0], phi[1], phi[2], readings.hub_rate_rad_s, volts];
        let mut change = [0.0; SIZE + 1];
        for (i, value) in all.into_iter().enumerate() {
            change[i] = share * (value - self.lagged[i]);
            self.lagged[i] += change[i];
        }
        let [of_hub, of_rate] = self.settings.inertia_v_s2_rad;
        let left = self.lagged[4] - (of_hub * change[3] + of_rate * change[2]) / period_s;
        ([self.lagged[0], self.lagged[1], self.lagged[2], phi[3]], left)
    }

    /// One step of recursive least squares; forgetting fades while the covariance is large.
    fn learn(&mut self, phi: &[f64; SIZE], volts: f64, forget: f64) {
        let mut gain = [0.0; SIZE];
        for (i, row) in self.covariance.iter().enumerate() {
            gain[i] = row.iter().zip(phi).map(|(p, x)| p * x).sum();
        }
        let spread: f64 = gain.iter().zip(phi).map(|(g, x)| g * x).sum();
        let predicted: f64 = self.parameters.iter().zip(phi).map(|(p, x)| p * x).sum();
        let forget = 1.0 - (1.0 - forget) * self.may_forget();
        let scale = 1.0 / (forget + spread);
        for i in 0..SIZE {
            self.parameters[i] += scale * gain[i] * (volts - predicted);
            for j in 0..SIZE {
                self.covariance[i][j] = (self.covariance[i][j] - scale * gain[i] * gain[j]) / forget;
            }
        }
    }

    fn may_forget(&self) -> f64 {
        let start = start_covariance(&self.settings);
        let used = (0..SIZE).filter(|&i| start[i][i] > 0.0);
        let room = |i: usize| (WIND_UP.1 - self.covariance[i][i] / start[i][i]) / (WIND_UP.1 - WIND_UP.0);
        used.map(|i| room(i).clamp(0.0, 1.0)).product()
    }
}

fn start_covariance(settings: &RecursiveSettings) -> [[f64; SIZE]; SIZE] {
    let mut covariance = [[0.0; SIZE]; SIZE];
    covariance[0][0] = (settings.start_deviation_kg_m * settings.scale.volts_per_kg_m_s2).powi(2);
    for (i, row) in covariance.iter_mut().enumerate().skip(1) {
        row[i] = LOOSE * LOOSE;
    }
    if settings.scale.gravity_m_s2 != 0.0 {
        covariance[SIZE - 1][SIZE - 1] = 0.0;
    }
    covariance
}
