//! The outputs of the linear plant: rates or positions of hub and tip, the motor's rate, and what the loop's sensor measures.

use super::Plant;
use super::core::{input, state};
use super::linearisation::{Angles, LinearPlant, OutputRow, unit};
use crate::parameters::{ControlledQuantity, FeedbackSignal, QuantityKind};

impl Plant {
    /// Returns the outputs over the states of the core and the relative angle behind them.
    pub(super) fn output_rows(&self, angles: Angles) -> Vec<OutputRow> {
        let plain = |states: Vec<f64>| OutputRow { states, inputs: [0.0; 3] };
        let mut motor = plain(self.motor_rate_row());
        motor.inputs[LinearPlant::PITCH_RATE] = -self.motor_share();
        let mut rows = match angles {
            Angles::Drop | Angles::Keep | Angles::Relative => {
                vec![plain(self.hub_rate_row()), plain(self.tip_rate_row())]
            }
            Angles::Position => vec![plain(self.relative_angle_row()), plain(self.relative_tip_row())],
        };
        rows.push(motor);
        rows.extend(self.measured_row(angles));
        rows
    }

    /// Returns what the outputs are, each with its unit.
    pub(super) fn output_names(&self, angles: Angles) -> Vec<String> {
        let controlled = self.parameters.controlled_quantity();
        let motion = match angles {
            Angles::Position => ControlledQuantity { kind: QuantityKind::Position, ..controlled },
            Angles::Drop | Angles::Keep | Angles::Relative => controlled.rate(),
        };
        let mut names = vec![motion.signal(), motion.tip_signal(), "motor_rate_rad_s".to_owned()];
        names.extend(self.measured_row(angles).map(|_| match self.parameters.sensors.measured {
            FeedbackSignal::HubRate => controlled.signal(),
            _ => controlled.key_of(&format!("measured_{}", controlled.short_name())),
        }));
        names
    }

    /// Returns what the loop's sensor measures, if that is neither the hub's inertial rate nor its angle.
    fn measured_row(&self, angles: Angles) -> Option<OutputRow> {
        let ratio = self.parameters.gearbox.ratio;
        let mut inputs = [0.0; 3];
        let states = match self.parameters.sensors.measured {
            FeedbackSignal::HubRate if angles != Angles::Position => return None,
            FeedbackSignal::HubPosition if angles != Angles::Relative => return None,
            FeedbackSignal::HubPosition => self.relative_angle_row(),
            FeedbackSignal::HubRate => self.hub_rate_row(),
            FeedbackSignal::RelativeRate => {
                inputs[LinearPlant::PITCH_RATE] = -1.0;
                self.hub_rate_row()
            }
            FeedbackSignal::MotorRate => {
                inputs[LinearPlant::PITCH_RATE] = -self.motor_share() / ratio;
                self.motor_rate_row().into_iter().map(|entry| entry / ratio).collect()
            }
            FeedbackSignal::MotorPosition => {
                let mut row = self.relative_angle_row();
                row[state::WINDUP] += 1.0;
                row
            }
            FeedbackSignal::Torque => {
                inputs[LinearPlant::PITCH_RATE] =
                    self.parameters.gearbox.damping_nm_s_rad * (1.0 - self.motor_share() / ratio);
                self.transmitted_torque_row()
            }
            FeedbackSignal::Current => self.current_row()[..self.core_order()].to_vec(),
        };
        Some(OutputRow { states, inputs })
    }

    /// Returns the torque that a transmission with touching teeth passes to the hub: T_2 = K_gb delta + D_gb delta'.
    pub fn transmitted_torque_row(&self) -> Vec<f64> {
        let gearbox = &self.parameters.gearbox;
        let mut row: Vec<f64> =
            self.hub_rate_row().iter().map(|rate| -gearbox.damping_nm_s_rad * rate).collect();
        row[state::MOTOR] += gearbox.damping_nm_s_rad / gearbox.ratio;
        row[state::WINDUP] += gearbox.stiffness_nm_rad;
        row
    }

    /// The hub's angle relative to the platform: the state behind those of the core.
    fn relative_angle_row(&self) -> Vec<f64> {
        unit(self.core_order() + 1, self.core_order())
    }

    /// The tip's angle relative to the platform.
    fn relative_tip_row(&self) -> Vec<f64> {
        let mut row = self.relative_angle_row();
        for (k, mode) in self.body.modes.iter().enumerate() {
            row[state::MODES + 2 * k] = mode.tip_shape - mode.hub_shape;
        }
        row
    }

    /// Returns the current over the states that are kept and the inputs.
    pub(super) fn linear_current(&self, kept: &[usize], slope: f64) -> OutputRow {
        let (n, row) = (self.core_order(), self.current_row());
        let moved: f64 = row.iter().zip(self.carried_moments()).map(|(entry, c)| entry * c).sum();
        let mut inputs = [0.0; 3];
        inputs[LinearPlant::CONTROL] = slope * row[n + input::DRIVE];
        inputs[LinearPlant::PITCH_RATE] = row[n + input::PLATFORM_RATE] + moved;
        OutputRow { states: kept.iter().map(|&s| if s < n { row[s] } else { 0.0 }).collect(), inputs }
    }

    /// Returns how a linear plant of this machine keeps its angles: a loop of position has them among its states, and so has one of a torque or
    /// a current against a spring, which answers them.
    pub fn angles(&self) -> Angles {
        let measured = self.parameters.sensors.measured;
        match (measured.is_position(), measured.is_effort() && self.spring.0 != 0.0) {
            (true, _) => Angles::Position,
            (_, true) => Angles::Relative,
            _ => Angles::Drop,
        }
    }
}
