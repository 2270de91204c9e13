//! The limits of a drive from sample to sample: the slew of its control, and the heat that folds its current back.

use counterpoise_models::{Amplifier, DriveHeat, DriveLimits, Motor, Parameters, resistance_factor};

/// A drive whose limits hold.
#[derive(Debug, Clone)]
pub(crate) struct LimitedDrive {
    limits: DriveLimits,
    amplifier: Amplifier,
    motor: Motor,
    period_s: f64,
    /// The control that acts, V.
    control_v: f64,
    heat: DriveHeat,
    range_a: Option<[f64; 2]>,
}

impl LimitedDrive {
    /// Returns the drive of a mechanism at the start of a run, whose amplifier holds a control; `None` if nothing limits it.
    pub fn new(parameters: &Parameters, control_v: f64) -> Option<Self> {
        let limits = &parameters.drive_limits;
        if *limits == DriveLimits::default() {
            return None;
        }
        Some(Self {
            limits: limits.clone(),
            amplifier: parameters.amplifier.clone(),
            motor: parameters.motor.clone(),
            period_s: parameters.interface.sample_period_s,
            control_v,
            heat: limits.heat_at_start(),
            range_a: None,
        })
    }

    /// Returns the control that acts where another is asked for, V.
    pub fn slew(&mut self, asked_v: f64) -> f64 {
        let most = self.limits.slew_v_s * self.period_s;
        self.control_v += (asked_v - self.control_v).clamp(-most, most);
        self.control_v
    }

    /// Returns the lowest and the highest current over the next sample at a speed of the motor, A; `None` if nothing limits it.
    pub fn range_a(&mut self, motor_rate_rad_s: f64) -> Option<[f64; 2]> {
        let limits = &self.limits;
        self.range_a = limits
            .limits_current()
            .then(|| limits.current_range_a(&self.amplifier, &self.motor, self.heat, motor_rate_rad_s));
        self.range_a
    }

    /// Returns the heat at this instant.
    pub fn heat(&self) -> DriveHeat {
        self.heat
    }

    /// Heats the drive over a sample with the currents at its ends:
    ///
    /// ```text
    ///     tau_o ds/dt = i^2 - s
    ///     C_w dT_w/dt = R (1 + a (T_w - 25 deg C)) i^2 - (T_w - T_h)/R_w       C_w = tau_w / R_w
    ///     C_h dT_h/dt = (T_w - T_h)/R_w - (T_h - T_a)/R_h                     C_h = tau_h / R_h
    /// ```
    ///
    /// s by its closed form for a constant square, the temperatures by Heun's method: their time constants are thousands of samples.
    pub fn advance(&mut self, currents_a: [f64; 2]) {
        let peak = self.amplifier.current_limit_a;
        let [low, high] = self.range_a.unwrap_or([-peak, peak]);
        let square = |current: f64| current.min(high).max(low).clamp(-peak, peak).powi(2);
        let mean = 0.5 * (square(currents_a[0]) + square(currents_a[1]));
        let keep = (-self.period_s / self.limits.overload_time_s).exp();
        self.heat.overload_a2 = mean + keep * (self.heat.overload_a2 - mean);
        let Some(heat) = self.limits.heat else { return };
        let slopes = |[winding, housing]: [f64; 2]| {
            let loss = self.motor.resistance_ohm * resistance_factor(winding) * mean;
            let passed = (winding - housing) / heat.winding_k_w;
            let left = (housing - heat.ambient_k) / heat.housing_k_w;
            [
                (loss - passed) * heat.winding_k_w / heat.winding_time_s,
                (passed - left) * heat.housing_k_w / heat.housing_time_s,
            ]
        };
        let at = [self.heat.winding_k, self.heat.housing_k];
        let first = slopes(at);
        let ahead = [at[0] + self.period_s * first[0], at[1] + self.period_s * first[1]];
        let second = slopes(ahead);
        self.heat.winding_k += 0.5 * self.period_s * (first[0] + second[0]);
        self.heat.housing_k += 0.5 * self.period_s * (first[1] + second[1]);
    }
}
