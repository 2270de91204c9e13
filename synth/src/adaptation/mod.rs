//! The out-of-balance estimated while the machine runs, and the controller that uses it.
//!
//! The estimate goes into the bias and the heave feedforward's gain, nowhere else: the feedback loop does not
//! contain the estimate, so in the linear model no estimate, however wrong, can make the loop unstable.

mod recursive_least_squares;

use counterpoise_controller::{Readings, Runner, SampledController};

use crate::Error;

pub use recursive_least_squares::{RecursiveLeastSquares, RecursiveSettings};

/// Curve from control volts to the quantity that the drive acts on: the inverse use of an amplifier's measured curve.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curve {
    /// Points (control V, equivalent V of a linear drive), the control increasing; empty for a linear drive. Beyond the
    /// last points the curve goes on with unit slope.
    pub points: Vec<(f64, f64)>,
}

impl Curve {
    /// Returns the equivalent volts of a control.
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

/// Machine parameters that both estimators need.
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
    /// Returns an estimator that gives a new estimate at the end of every window.
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

/// Estimator that sets the out-of-balance of an [`AdaptiveController`].
#[derive(Debug, Clone)]
pub enum Estimation {
    /// The windowed mean.
    Mean(WindowedMean),
    /// Recursive least squares.
    Squares(Box<RecursiveLeastSquares>),
}

/// A controller whose out-of-balance follows an estimate.
#[derive(Debug, Clone)]
pub struct AdaptiveController {
    runner: Runner,
    estimation: Estimation,
    start: Estimation,
    history: Vec<f64>,
    held_samples: usize,
    samples: usize,
}

impl AdaptiveController {
    /// Returns the controller with its estimator.
    pub fn new(runner: Runner, estimation: Estimation) -> Self {
        let start = estimation.clone();
        Self { runner, start, estimation, history: Vec::new(), held_samples: 0, samples: 0 }
    }

    /// Returns the same controller, which uses estimates only after so many samples; before, they are made and not used.
    #[must_use]
    pub fn hold_estimates(mut self, samples: usize) -> Self {
        self.held_samples = samples;
        self
    }

    /// Returns every out-of-balance that was set, kg m, in order.
    pub fn history_kg_m(&self) -> &[f64] {
        &self.history
    }
}

impl SampledController for AdaptiveController {
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
