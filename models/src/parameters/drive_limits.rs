//! The limits of what a drive can do for long: limits of its rate, of its power and of its heat.

use super::{Amplifier, Motor};

/// Limits of the drive beside the amplifier's voltage and peak current; none by default. They hold from sample to sample, as the
/// firmware of a drive applies them.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveLimits {
    /// Largest change of the control, V/s; infinite if there is none.
    pub slew_v_s: f64,
    /// Speed of the motor above which it is not driven on, rad/s; infinite if there is none.
    pub motor_rate_rad_s: f64,
    /// Electrical power that the supply gives, W; infinite if there is no limit.
    pub supply_power_w: f64,
    /// Current that the amplifier bears for ever, A; infinite if there is no limit.
    pub continuous_current_a: f64,
    /// Time constant of the average of the squared current, s.
    pub overload_time_s: f64,
    /// Heat of the motor; `None` if nothing limits it.
    pub heat: Option<MotorHeat>,
}

/// The motor as two bodies that store heat: winding and housing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorHeat {
    /// Thermal resistance from winding to housing, K/W.
    pub winding_k_w: f64,
    /// Thermal resistance from housing to ambience, K/W.
    pub housing_k_w: f64,
    /// Time constant of the winding on a housing that stays as it is, s.
    pub winding_time_s: f64,
    /// Time constant of the housing, s.
    pub housing_time_s: f64,
    /// Temperature of the ambience, K.
    pub ambient_k: f64,
    /// Temperature of winding and housing at the start, K.
    pub start_k: f64,
    /// Largest temperature of the winding, K.
    pub limit_k: f64,
}

/// Heat in a drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveHeat {
    /// Average of the squared current, A^2.
    pub overload_a2: f64,
    /// Temperature of the winding, K; 0 if the motor has no heat.
    pub winding_k: f64,
    /// Temperature of the housing, K.
    pub housing_k: f64,
}

/// Temperature at which a motor's resistance is stated, K.
pub const RESISTANCE_AT_K: f64 = 298.15;
/// Temperature coefficient of copper's resistance, 1/K (IEC 60034-1: 1/(235 + 25) per degree at 25 degrees).
pub const COPPER_PER_K: f64 = 1.0 / 260.0;
/// Share of a limit over which the drive folds its current back: a hard switch would chatter from sample to sample.
pub const FOLD_SHARE: f64 = 0.1;
/// Distance below the limit of the winding from which on the current is folded back, K.
pub const FOLD_K: f64 = 10.0;

impl Default for DriveLimits {
    fn default() -> Self {
        Self {
            slew_v_s: f64::INFINITY,
            motor_rate_rad_s: f64::INFINITY,
            supply_power_w: f64::INFINITY,
            continuous_current_a: f64::INFINITY,
            overload_time_s: 1.0,
            heat: None,
        }
    }
}

impl MotorHeat {
    /// Returns the current that holds the winding at its limit for ever, A: R(limit) i^2 (R_w + R_h) = limit - ambience.
    pub fn lasting_current_a(&self, resistance_ohm: f64) -> f64 {
        let resistance = resistance_ohm * resistance_factor(self.limit_k);
        let rise = (self.limit_k - self.ambient_k).max(0.0);
        (rise / (resistance * (self.winding_k_w + self.housing_k_w))).sqrt()
    }
}

/// Returns the factor of a resistance at a temperature.
pub fn resistance_factor(temperature_k: f64) -> f64 {
    1.0 + COPPER_PER_K * (temperature_k - RESISTANCE_AT_K)
}

impl DriveLimits {
    /// Returns whether anything limits the current.
    pub fn limits_current(&self) -> bool {
        self.motor_rate_rad_s.is_finite()
            || self.supply_power_w.is_finite()
            || self.continuous_current_a.is_finite()
            || self.heat.is_some()
    }

    /// Returns the heat at the start of a run.
    pub fn heat_at_start(&self) -> DriveHeat {
        let start_k = self.heat.map_or(0.0, |heat| heat.start_k);
        DriveHeat { overload_a2: 0.0, winding_k: start_k, housing_k: start_k }
    }

    /// Returns the lowest and the highest current at a speed of the motor, A:
    ///
    /// ```text
    ///     |i| <= i_p                                   peak current of the amplifier
    ///     i^2 <= i_c^2 + f (i_p^2 - i_c^2)             f = (1 - s/i_c^2)/0.1 within 0 and 1; s the average of i^2
    ///     |i| <= i_w + f (i_p - i_w)                   f = (limit - winding)/10 K within 0 and 1; i_w bears the limit for ever
    ///     R i^2 + K_e w i <= P                         power of the supply
    ///     |i| -> 0 in the direction of w               from 0.95 to 1.05 times the largest speed
    /// ```
    pub fn current_range_a(
        &self,
        amplifier: &Amplifier,
        motor: &Motor,
        at: DriveHeat,
        motor_rate_rad_s: f64,
    ) -> [f64; 2] {
        let peak = amplifier.current_limit_a;
        let limit = self.overload_limit_a(peak, at).min(self.heat_limit_a(peak, motor, at));
        let of = |sense: f64| {
            let along = sense * motor_rate_rad_s;
            let fast = (0.5 + (1.0 - along / self.motor_rate_rad_s) / FOLD_SHARE).clamp(0.0, 1.0);
            // an unlimited current times no share is none
            let driven = if fast == 0.0 { 0.0 } else { fast * limit };
            driven.min(self.supply_limit_a(motor, along))
        };
        [-of(-1.0), of(1.0)]
    }

    fn overload_limit_a(&self, peak: f64, at: DriveHeat) -> f64 {
        let lasting = self.continuous_current_a;
        if lasting == f64::INFINITY || lasting >= peak {
            return peak;
        }
        let room = ((1.0 - at.overload_a2 / (lasting * lasting)) / FOLD_SHARE).clamp(0.0, 1.0);
        if room == 0.0 {
            return lasting;
        }
        (lasting * lasting + room * (peak * peak - lasting * lasting)).sqrt()
    }

    fn heat_limit_a(&self, peak: f64, motor: &Motor, at: DriveHeat) -> f64 {
        let Some(heat) = self.heat else { return peak };
        let lasting = heat.lasting_current_a(motor.resistance_ohm).min(peak);
        let room = ((heat.limit_k - at.winding_k) / FOLD_K).clamp(0.0, 1.0);
        if room == 0.0 { lasting } else { lasting + room * (peak - lasting) }
    }

    /// Returns the current whose power in the direction of a speed the supply gives: the positive root of R i^2 + K_e w i = P.
    fn supply_limit_a(&self, motor: &Motor, along_rad_s: f64) -> f64 {
        if self.supply_power_w == f64::INFINITY {
            return f64::INFINITY;
        }
        let emf = motor.back_emf_v_s_rad * along_rad_s;
        let root = (emf * emf + 4.0 * motor.resistance_ohm * self.supply_power_w).sqrt();
        // of two forms of the root the one without cancellation
        if emf > 0.0 {
            2.0 * self.supply_power_w / (emf + root)
        } else {
            (root - emf) / (2.0 * motor.resistance_ohm)
        }
    }
}
