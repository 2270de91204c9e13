//! Controllers that know the derivatives of their control.

use counterpoise_controller::number::Dual;
use counterpoise_controller::{
    Controller, IntegralMotion, PositionController, PositionSource, ProportionalIntegral, READINGS,
    RateSource, Readings, Runner, SampledController,
};

/// A controller in a run with derivatives.
pub trait DifferentiableController {
    /// Takes the readings of this instant and their derivatives along each direction; returns the control in volts, before the output
    /// converter, and writes its derivatives.
    fn step(&mut self, readings: &Readings, slopes: &[Readings], control: &mut [f64]) -> f64;
}

/// A proportional-integral controller whose gains may be varied.
#[derive(Debug, Clone)]
pub struct DifferentiablePi {
    controller: ProportionalIntegral,
    gains: Vec<PiGains>,
    integral: Vec<f64>,
}

/// What a direction changes of a proportional-integral controller, per unit of the direction.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PiGains {
    /// Proportional gain, V s/rad.
    pub kp_v_s_rad: f64,
    /// Integral gain, V/rad.
    pub ki_v_rad: f64,
    /// Constant added, V.
    pub bias_v: f64,
    /// Integral at the start, V.
    pub integral_v: f64,
}

impl DifferentiablePi {
    /// Returns a controller as it stands; directions without an entry change nothing of it.
    pub fn new(controller: &ProportionalIntegral, gains: &[PiGains]) -> Self {
        Self {
            controller: controller.clone(),
            integral: gains.iter().map(|gains| gains.integral_v).collect(),
            gains: gains.to_vec(),
        }
    }
}

impl DifferentiableController for DifferentiablePi {
    fn step(&mut self, readings: &Readings, slopes: &[Readings], control: &mut [f64]) -> f64 {
        let count = slopes.len();
        self.gains.resize(count, PiGains::default());
        self.integral.resize(count, 0.0);
        let Self { controller, gains, integral } = self;
        let error = readings.demand_rad_s - readings.hub_rate_rad_s;
        let before = controller.integral_v;
        let own = controller.step(readings);
        let motion = controller.anti_windup.motion_between(before, controller.integral_v);
        for k in 0..count {
            let slope = slopes[k].demand_rad_s - slopes[k].hub_rate_rad_s;
            control[k] =
                controller.kp_v_s_rad * slope + gains[k].kp_v_s_rad * error + integral[k] + gains[k].bias_v;
            let grown = controller.ki_v_rad * slope + gains[k].ki_v_rad * error;
            integral[k] = integral_slope(motion, integral[k], controller.sample_period_s * grown);
        }
        if controller.anti_windup.is_limited(own) {
            control.fill(0.0);
        }
        own
    }
}

/// Returns the derivative of an integral after a sample: its own before it, and that of what the error would add.
fn integral_slope(motion: IntegralMotion, before: f64, growth: f64) -> f64 {
    match motion {
        IntegralMotion::Grew => before + growth,
        IntegralMotion::Stayed => before,
        IntegralMotion::Bounded => 0.0,
    }
}

/// A position controller with fixed gains.
#[derive(Debug, Clone)]
pub struct DifferentiablePosition {
    controller: PositionController,
    integral: Vec<f64>,
    /// Derivatives of the positions of the samples before, the latest first.
    earlier: Vec<Vec<f64>>,
}

impl DifferentiablePosition {
    /// Returns a controller as it stands.
    pub fn new(controller: &PositionController) -> Self {
        Self { controller: controller.clone(), integral: Vec::new(), earlier: Vec::new() }
    }

    /// Returns the derivative of the rate along a direction.
    fn rate_slope(&mut self, direction: usize, position: f64, slopes: &Readings) -> f64 {
        let RateSource::Differences(count) = self.controller.rate else { return slopes.hub_rate_rad_s };
        let count = count.max(1);
        let earlier = &mut self.earlier[direction];
        // positions before the first sample follow from the first one
        while earlier.len() < count {
            earlier.push(position);
        }
        let rate = (position - earlier[count - 1]) / (count as f64 * self.controller.sample_period_s);
        earlier.rotate_right(1);
        earlier[0] = position;
        rate
    }
}

impl DifferentiableController for DifferentiablePosition {
    fn step(&mut self, readings: &Readings, slopes: &[Readings], control: &mut [f64]) -> f64 {
        self.integral.resize(slopes.len(), 0.0);
        self.earlier.resize(slopes.len(), Vec::new());
        let before = self.controller.integral_v;
        let own = self.controller.step(readings);
        let motion = self.controller.anti_windup.motion_between(before, self.controller.integral_v);
        for (k, slopes) in slopes.iter().enumerate() {
            let position = match self.controller.position {
                PositionSource::HubPosition => slopes.hub_position_rad,
                PositionSource::LoopSensor => slopes.hub_rate_rad_s,
            };
            let rate = self.rate_slope(k, position, slopes);
            let controller = &self.controller;
            let error = controller.kp_1_s * (slopes.demand_rad_s - position) - rate;
            control[k] = controller.kv_v_s_rad * error + self.integral[k];
            let growth = controller.ki_v_rad * controller.sample_period_s * error;
            self.integral[k] = integral_slope(motion, self.integral[k], growth);
        }
        if self.controller.anti_windup.is_limited(own) {
            control.fill(0.0);
        }
        own
    }
}

/// A control that is played back: no direction changes it.
pub struct FixedControl<'a>(pub &'a mut dyn SampledController);

impl DifferentiableController for FixedControl<'_> {
    fn step(&mut self, readings: &Readings, _slopes: &[Readings], control: &mut [f64]) -> f64 {
        control.fill(0.0);
        self.0.step(readings)
    }
}

/// A controller as it is exported: each of its operations is differentiated.
#[derive(Debug, Clone)]
pub struct DifferentiableProgram {
    reference: Runner,
    differentiated: Runner<Dual>,
}

impl DifferentiableProgram {
    /// Returns a controller in the states of a runner of it.
    pub fn new(controller: &Controller, runner: &Runner) -> Self {
        let differentiated = controller.runner_in::<Dual>().with_states(&runner.states());
        Self { reference: runner.clone(), differentiated }
    }
}

impl DifferentiableController for DifferentiableProgram {
    fn step(&mut self, readings: &Readings, slopes: &[Readings], control: &mut [f64]) -> f64 {
        let (own, arrays) = (readings.to_array(), slopes.iter().map(Readings::to_array).collect::<Vec<_>>());
        let inputs: [Dual; READINGS] = std::array::from_fn(|j| Dual {
            value: own[j],
            slope: arrays.iter().map(|slopes| slopes[j]).collect(),
        });
        let found = self.differentiated.step_numbers(&inputs);
        for (k, control) in control.iter_mut().enumerate() {
            *control = found.slope.get(k).copied().unwrap_or(0.0);
        }
        self.reference.step(readings)
    }
}
