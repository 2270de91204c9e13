//! The out-of-balance estimated while the machine runs, and the controller that uses it.
//!
//! What is estimated goes into the bias and the heave feedforward's gain, nowhere else: the feedback loop does not
//! contain the estimate, so in the linear model no estimate, however wrong, can make the loop unstable.

use counterpoise_controller::{Readings, Runner, SampledController};

use crate::Error;

/// How control volts become what the drive acts on: the inverse use of an amplifier's measured curve.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curve {
    /// Points (control V, equivalent V of a linear drive), the control increasing; empty for a linear drive. Beyond the
    /// last points the curve goes on with unit slope.
    pub points: Vec<(f64, f64)>,
}

impl Curve {
    /// The equivalent volts of a control.
    pub fn at(&self, control_v: f64) -> f64 {
        let (Some(&first), Some(&last)) = (self.points.first(), self.points.last()) else { return control_v };
        if control_v <= first.0 {
            return first.1 + control_v - first.0;
        }
        let above = self.points.iter().position(|point| point.0 >= control_v);
        let Some(k) = above.filter(|k| *k > 0) else { return last.1 + control_v - last.0 };
        let ((x0, y0), (x1, y1)) = (self.points[k - 1], self.points[k]);
        y0 + (y1 - y0) * (control_v - x0) / (x1 - x0)
    }
}

/// What both estimators need to know of the machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    /// Equivalent volts that hold one kg m at one m/s^2.
    pub volts_per_kg_m_s2: f64,
    /// Gravity along the direction that the imbalance feels, m/s^2; 0 in azimuth or without gravity.
    pub gravity_m_s2: f64,
    /// The drive's curve.
    pub curve: Curve,
}

/// The thesis' estimator: the mean of the control over a window, over the volts that gravity's share of one kg m takes.
///
/// Friction averages out only over motions of both signs; without gravity it has nothing to go by.
#[derive(Debug, Clone)]
pub struct WindowedMean {
    scale: Scale,
    window: usize,
    count: usize,
    sum: f64,
    gravity: f64,
    estimate: Option<f64>,
}

impl WindowedMean {
    /// An estimator that gives a new estimate at the end of every window.
    ///
    /// # Errors
    /// [`Error::Range`] for an empty window, no gravity, or volts of zero.
    pub fn new(scale: Scale, window_samples: usize) -> Result<Self, Error> {
        let refuse = |what, value, allowed| Err(Error::Range { what, value, allowed });
        if window_samples == 0 {
            return refuse("window in samples", 0.0, "positive");
        }
        if scale.gravity_m_s2 == 0.0 {
            return refuse("gravity in m/s^2", 0.0, "not zero for the windowed mean");
        }
        if !(scale.volts_per_kg_m_s2 != 0.0 && scale.volts_per_kg_m_s2.is_finite()) {
            return refuse("volts a kg m a m/s^2", scale.volts_per_kg_m_s2, "not zero");
        }
        Ok(Self { scale, window: window_samples, count: 0, sum: 0.0, gravity: 0.0, estimate: None })
    }

    /// Takes a sample; a new estimate at the end of a window, kg m.
    pub fn update(&mut self, readings: &Readings, control_v: f64) -> Option<f64> {
        self.sum += self.scale.curve.at(control_v);
        self.gravity += self.scale.gravity_m_s2 * readings.hub_position_rad.cos();
        self.count += 1;
        if self.count < self.window {
            return None;
        }
        let estimate = self.sum / (self.gravity * self.scale.volts_per_kg_m_s2);
        (self.count, self.sum, self.gravity) = (0, 0.0, 0.0);
        self.estimate = Some(estimate);
        self.estimate
    }
}

/// Settings of [`Recursive`].
#[derive(Debug, Clone, PartialEq)]
pub struct RecursiveSettings {
    /// The machine.
    pub scale: Scale,
    /// Forgetting time, s: what lies further back counts less than 1/e.
    pub memory_s: f64,
    /// Sample period, s.
    pub sample_period_s: f64,
    /// Below this RMS of the imbalance's regressor, m/s^2, the estimate stands still. Gravity alone exceeds it; in
    /// azimuth the lateral acceleration must.
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
/// Learning fades out where the mean square of the first regressor falls from 1.21 to 1 times the dead-band's, forgetting
/// where a variance grows from 9 to 10 times its start. The controller's own estimator
/// ([`counterpoise_controller::Learning::Squares`]) is the same with the covariance in factors.
#[derive(Debug, Clone)]
pub struct Recursive {
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

impl Recursive {
    /// The estimator at its start.
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

    /// The estimate, kg m.
    pub fn estimate_kg_m(&self) -> f64 {
        self.estimate
    }

    /// Takes a sample and gives the estimate, kg m.
    pub fn update(&mut self, readings: &Readings, control_v: f64) -> f64 {
        let (phi, volts) = self.lag(readings, self.settings.scale.curve.at(control_v));
        let forget = (-self.settings.sample_period_s / self.settings.memory_s).exp();
        self.excitation = forget * self.excitation + (1.0 - forget) * phi[0] * phi[0];
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

    /// 1 where the first regressor is lively, 0 inside the dead-band.
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

/// Which estimator sets the out-of-balance of an [`Adaptive`] controller.
#[derive(Debug, Clone)]
pub enum Estimation {
    /// The windowed mean.
    Mean(WindowedMean),
    /// Recursive least squares.
    Squares(Box<Recursive>),
}

/// A controller whose out-of-balance follows an estimate.
#[derive(Debug, Clone)]
pub struct Adaptive {
    runner: Runner,
    estimation: Estimation,
    start: Estimation,
    history: Vec<f64>,
    held_samples: usize,
    samples: usize,
}

impl Adaptive {
    /// The controller with its estimator.
    pub fn new(runner: Runner, estimation: Estimation) -> Self {
        let start = estimation.clone();
        Self { runner, start, estimation, history: Vec::new(), held_samples: 0, samples: 0 }
    }

    /// The same, but estimates are used only after so many samples; before, they are made and not used.
    #[must_use]
    pub fn held(mut self, samples: usize) -> Self {
        self.held_samples = samples;
        self
    }

    /// Every out-of-balance that was set, kg m, in order.
    pub fn history_kg_m(&self) -> &[f64] {
        &self.history
    }
}

impl SampledController for Adaptive {
    fn reset(&mut self) {
        self.runner.reset();
        self.estimation = self.start.clone();
        self.history.clear();
        self.samples = 0;
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        let control = self.runner.step(readings);
        let estimate = match &mut self.estimation {
            Estimation::Mean(mean) => mean.update(readings, control),
            Estimation::Squares(squares) => Some(squares.update(readings, control)),
        };
        self.samples += 1;
        if let Some(out_of_balance) = estimate.filter(|_| self.samples > self.held_samples) {
            self.runner.set_out_of_balance(out_of_balance);
            self.history.push(out_of_balance);
        }
        control
    }
}
