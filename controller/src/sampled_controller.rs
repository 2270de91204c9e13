//! The readings of a sampled controller, and the control that it returns.

/// Readings of a controller at a sample instant: converter readings divided by their scale, in SI units.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Readings {
    /// Demanded hub rate, rad/s.
    pub demand_rad_s: f64,
    /// Hub gyroscope, rad/s (inertial).
    pub hub_rate_rad_s: f64,
    /// Platform gyroscope, rad/s (inertial).
    pub platform_rate_rad_s: f64,
    /// Platform accelerometer (heave), m/s^2, gravity removed.
    pub platform_accel_m_s2: f64,
    /// Motor tachometer, rad/s relative to the platform; 0 if none is fitted.
    pub motor_rate_rad_s: f64,
    /// Hub angle relative to the platform, rad; 0 if no resolver is fitted.
    pub hub_position_rad: f64,
    /// Second accelerometer on the platform (surge, forward), m/s^2, gravity removed; 0 if none is fitted.
    pub platform_surge_m_s2: f64,
}

/// A controller that acts once a sample.
pub trait SampledController {
    /// Puts every state back to its start.
    fn reset(&mut self);
    /// Takes the readings of this instant and returns the control in volts, before the output converter.
    fn step(&mut self, readings: &Readings) -> f64;
}

/// Treatment of an integral while the control is limited.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum AntiWindup {
    /// The integral goes on as if the control were not limited.
    #[default]
    None,
    /// The control is limited, in volts, and the integral waits while it is.
    Hold(f64),
    /// The control is limited, in volts, and the integral waits while the error would drive it further.
    HoldOutward(f64),
    /// The integral itself stays within a limit, in volts.
    Clamp(f64),
}

/// What an integral did from one sample to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IntegralMotion {
    /// It grew by what the error added.
    Grew,
    /// It stayed.
    Stayed,
    /// It reached a bound.
    Bounded,
}

impl AntiWindup {
    /// Returns an integral after a sample: the error would raise it by `growth`, beside a control that is not limited yet.
    fn advance(self, integral: f64, growth: f64, control: f64) -> f64 {
        match self {
            Self::Hold(limit) if control.abs() >= limit => integral,
            Self::HoldOutward(limit) if control.abs() >= limit && control * growth > 0.0 => integral,
            Self::Clamp(limit) => (integral + growth).clamp(-limit, limit),
            Self::None | Self::Hold(_) | Self::HoldOutward(_) => integral + growth,
        }
    }

    /// Returns the control that leaves a controller with this rule.
    fn limit_control(self, control: f64) -> f64 {
        match self {
            Self::Hold(limit) | Self::HoldOutward(limit) => control.clamp(-limit, limit),
            Self::None | Self::Clamp(_) => control,
        }
    }

    /// Returns whether a control that left the controller stands at the limit of this rule.
    pub fn is_limited(self, control: f64) -> bool {
        matches!(self, Self::Hold(limit) | Self::HoldOutward(limit) if control.abs() >= limit)
    }

    /// Returns what an integral did between two samples.
    pub fn motion_between(self, before: f64, after: f64) -> IntegralMotion {
        match self {
            Self::Hold(_) | Self::HoldOutward(_) if after == before => IntegralMotion::Stayed,
            Self::Clamp(limit) if after.abs() >= limit => IntegralMotion::Bounded,
            _ => IntegralMotion::Grew,
        }
    }
}

/// The controller of a recording: e = demand - hub rate, u = kp e + q + bias, then q += ki T e unless the rule against windup forbids it. By default every
/// number is 0 and there is no such rule.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ProportionalIntegral {
    /// Proportional gain, V s/rad.
    pub kp_v_s_rad: f64,
    /// Integral gain, V/rad.
    pub ki_v_rad: f64,
    /// Constant added, V.
    pub bias_v: f64,
    /// Sample period, s.
    pub sample_period_s: f64,
    /// State q, V.
    pub integral_v: f64,
    /// Treatment of the integral while the control is limited.
    pub anti_windup: AntiWindup,
}

impl SampledController for ProportionalIntegral {
    fn reset(&mut self) {
        self.integral_v = 0.0;
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        let error = readings.demand_rad_s - readings.hub_rate_rad_s;
        let control = self.kp_v_s_rad * error + self.integral_v + self.bias_v;
        let growth = self.ki_v_rad * self.sample_period_s * error;
        self.integral_v = self.anti_windup.advance(self.integral_v, growth, control);
        self.anti_windup.limit_control(control)
    }
}

/// Source of the rate of a position controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RateSource {
    /// The reading of a rate sensor.
    Measured,
    /// The difference of the position over this many samples.
    Differences(usize),
}

/// Source of the position of a position controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PositionSource {
    /// The hub's angle, beside a rate sensor in the loop.
    HubPosition,
    /// The sensor of the loop, which measures a position itself.
    LoopSensor,
}

/// A position controller with a rate loop inside, as a positioning drive has it: e = kp (demand - position) - rate,
/// u = kv e + q, then q += ki T e unless the rule against windup forbids it.
#[derive(Debug, Clone, PartialEq)]
pub struct PositionController {
    /// Gain of the position loop, 1/s.
    pub kp_1_s: f64,
    /// Proportional gain of the rate loop, V s/rad.
    pub kv_v_s_rad: f64,
    /// Integral gain of the rate loop, V/rad.
    pub ki_v_rad: f64,
    /// Sample period, s.
    pub sample_period_s: f64,
    /// Source of the rate.
    pub rate: RateSource,
    /// Source of the position.
    pub position: PositionSource,
    /// Rate before the first sample, rad/s: the differences at the start need positions that were not read.
    pub start_rate_rad_s: f64,
    /// State q, V.
    pub integral_v: f64,
    /// Treatment of the integral while the control is limited.
    pub anti_windup: AntiWindup,
    /// The positions of the samples before, the latest first, rad.
    pub earlier_rad: Vec<f64>,
}

impl PositionController {
    /// Returns over how many samples the position is differenced; 0 if a sensor measures the rate.
    pub fn rate_samples(&self) -> usize {
        match self.rate {
            RateSource::Differences(count) => count.max(1),
            RateSource::Measured => 0,
        }
    }

    /// Returns the rate at a sample with a position, and keeps the position.
    fn rate_rad_s(&mut self, position_rad: f64, readings: &Readings) -> f64 {
        let RateSource::Differences(count) = self.rate else { return readings.hub_rate_rad_s };
        let count = count.max(1);
        for k in self.earlier_rad.len()..count {
            let before_s = (k + 1) as f64 * self.sample_period_s;
            self.earlier_rad.push(position_rad - before_s * self.start_rate_rad_s);
        }
        let rate = (position_rad - self.earlier_rad[count - 1]) / (count as f64 * self.sample_period_s);
        self.earlier_rad.rotate_right(1);
        self.earlier_rad[0] = position_rad;
        rate
    }
}

impl SampledController for PositionController {
    fn reset(&mut self) {
        self.integral_v = 0.0;
        self.earlier_rad.clear();
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        let position = match self.position {
            PositionSource::HubPosition => readings.hub_position_rad,
            PositionSource::LoopSensor => readings.hub_rate_rad_s,
        };
        let rate = self.rate_rad_s(position, readings);
        let error = self.kp_1_s * (readings.demand_rad_s - position) - rate;
        let control = self.kv_v_s_rad * error + self.integral_v;
        let growth = self.ki_v_rad * self.sample_period_s * error;
        self.integral_v = self.anti_windup.advance(self.integral_v, growth, control);
        self.anti_windup.limit_control(control)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_position_controller_differences_its_position_from_the_first_sample_on() {
        let mut controller = PositionController {
            kp_1_s: 10.0,
            kv_v_s_rad: 2.0,
            ki_v_rad: 0.0,
            sample_period_s: 1e-3,
            rate: RateSource::Differences(2),
            position: PositionSource::LoopSensor,
            start_rate_rad_s: 0.5,
            integral_v: 0.0,
            anti_windup: AntiWindup::None,
            earlier_rad: Vec::new(),
        };
        for k in 0..5 {
            let position = 0.2 + 0.5e-3 * f64::from(k);
            let readings = Readings { demand_rad_s: 0.3, hub_rate_rad_s: position, ..Readings::default() };
            let control = controller.step(&readings);
            assert!((control - 2.0 * (10.0 * (0.3 - position) - 0.5)).abs() < 1e-9, "{k}: {control}");
        }
        controller.reset();
        assert!(controller.earlier_rad.is_empty());
    }

    /// A controller that integrates an error of 1 with a gain of 2 V, sample after sample, beside a bias.
    fn integrals(anti_windup: AntiWindup, errors: &[f64]) -> Vec<[f64; 2]> {
        let mut controller = ProportionalIntegral {
            kp_v_s_rad: 1.0,
            ki_v_rad: 2.0,
            bias_v: 0.5,
            sample_period_s: 1.0,
            integral_v: 0.0,
            anti_windup,
        };
        let one = |error: &f64| {
            let readings = Readings { demand_rad_s: *error, ..Readings::default() };
            [controller.step(&readings), controller.integral_v]
        };
        errors.iter().map(one).collect()
    }

    #[test]
    fn the_integral_waits_or_is_bounded_while_the_control_is_limited() {
        let errors = [1.0, 1.0, 1.0, -1.0, -1.0];
        let of = |rule| integrals(rule, &errors);
        let on = [[1.5, 2.0], [3.5, 4.0], [5.5, 6.0], [5.5, 4.0], [3.5, 2.0]];
        assert_eq!(of(AntiWindup::None), on);
        // beyond 5 V the control is 5 V; the integral waits at the third and the fourth sample, and only while it would grow outward
        assert_eq!(of(AntiWindup::Hold(5.0))[2..], [[5.0, 4.0], [3.5, 2.0], [1.5, 0.0]]);
        let outward = integrals(AntiWindup::HoldOutward(3.0), &[1.0, 1.0, 1.0, -0.1]);
        assert_eq!(outward[1..3], [[3.0, 2.0], [3.0, 2.0]]);
        assert!((outward[3][1] - 1.8).abs() < 1e-12, "{outward:?}");
        assert_eq!(of(AntiWindup::Clamp(3.0)), [[1.5, 2.0], [3.5, 3.0], [4.5, 3.0], [2.5, 1.0], [0.5, -1.0]]);
    }
}
