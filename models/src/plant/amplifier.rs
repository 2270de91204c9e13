//! The static part of the amplifier: limit, dead zone and measured map of its input.

use crate::parameters::{Amplifier, AmplifierDynamics, Motor};

impl Amplifier {
    /// Returns whether anything is known of the most that the drive can give: a limit of its input, voltage or current, or a measured map.
    pub fn has_limit(&self) -> bool {
        let limits = [self.input_limit_v, self.bus_voltage_v, self.current_limit_a];
        limits.into_iter().any(f64::is_finite) || !self.map.is_empty()
    }

    /// Returns the static gain of the closed amplifier loop, motor stalled: K_v / (R + K_v K_ifb), A/V; of a drive that takes a
    /// current or a torque, its gain.
    pub fn stall_gain_a_v(&self, motor: &Motor) -> f64 {
        if self.dynamics.is_command() || matches!(self.dynamics, AmplifierDynamics::CurrentLoop { .. }) {
            return self.gain;
        }
        self.gain / (motor.resistance_ohm + self.gain * self.current_feedback_v_a)
    }

    /// Returns the drive under which voltage and current stay as they are: V / K_v + K_ifb i, or i over the static gain for an ideal
    /// current source.
    pub fn holding_drive_v(&self, voltage_v: f64, current_a: f64, motor: &Motor) -> f64 {
        match self.dynamics {
            AmplifierDynamics::Modelled => voltage_v / self.gain + self.current_feedback_v_a * current_a,
            _ => current_a / self.stall_gain_a_v(motor),
        }
    }

    /// Returns what the linear amplifier receives for a control: v = map(dead zone(clip(u))).
    ///
    /// The map is odd and linear between its points, with map(v) = i(v) / (stall gain); beyond the last point it goes
    /// on with the linear amplifier's slope. Without a lag, the bus limits the drive: to +/- bus voltage / gain.
    pub fn drive_v(&self, control_v: f64, motor: &Motor) -> f64 {
        let clipped = control_v.abs().min(self.input_limit_v);
        let beyond = (clipped - self.dead_zone_v).max(0.0);
        let drive_v = control_v.signum() * self.map_input(beyond, self.stall_gain_a_v(motor));
        if self.time_constant_s > 0.0 || self.dynamics != AmplifierDynamics::Modelled {
            return drive_v;
        }
        let most = self.bus_voltage_v / self.gain;
        drive_v.clamp(-most, most)
    }

    /// Returns the smallest control (in size) whose drive is `drive_v`; beyond the input limit the limit.
    pub fn control_v(&self, drive_v: f64, motor: &Motor) -> f64 {
        let size = drive_v.abs();
        if size == 0.0 {
            return 0.0;
        }
        let beyond = self.invert_map(size, self.stall_gain_a_v(motor));
        drive_v.signum() * (beyond + self.dead_zone_v).min(self.input_limit_v)
    }

    /// Returns the map of a positive input.
    fn map_input(&self, input_v: f64, gain_a_v: f64) -> f64 {
        let mut low = (0.0, 0.0);
        for point in &self.map {
            let high = (point.input_v, point.current_a / gain_a_v);
            if input_v <= high.0 {
                return low.1 + (input_v - low.0) * (high.1 - low.1) / (high.0 - low.0);
            }
            low = high;
        }
        low.1 + (input_v - low.0)
    }

    /// Returns the smallest positive input whose map is `drive_v`.
    fn invert_map(&self, drive_v: f64, gain_a_v: f64) -> f64 {
        let mut low = (0.0, 0.0);
        for point in &self.map {
            let high = (point.input_v, point.current_a / gain_a_v);
            if drive_v <= high.1 {
                return low.0 + (drive_v - low.1) * (high.0 - low.0) / (high.1 - low.1);
            }
            low = high;
        }
        low.0 + (drive_v - low.1)
    }
}
