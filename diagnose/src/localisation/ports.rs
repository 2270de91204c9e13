//! Ports: what an error at a place of the mechanism does to each balance.

use crate::localisation::torque_balances::{Balance, Signals};
use crate::machine::SteadyDrive;
use crate::recording::series::derivative;

/// A place at which something may act that the model lacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Port {
    /// A torque on the hub, N m.
    Hub,
    /// A torque on the motor's shaft, N m at the hub.
    Motor,
    /// Wind-up of the gear, rad at the hub.
    Gear,
    /// An error of the hub gyroscope, rad/s.
    HubGyro,
    /// An error of the platform gyroscope, rad/s.
    PlatformGyro,
    /// An error of the platform's accelerometer, m/s^2.
    Accelerometer,
}

impl Port {
    /// Returns what an error here adds to a balance of these signals.
    pub fn balance_error(self, balance: Balance, error: &[f64], at: &Signals) -> Vec<f64> {
        let stiffness = at.p.gearbox.stiffness_nm_rad;
        let slope = || derivative(error, at.period_s);
        let times = |series: &[f64], factor: f64| series.iter().map(|x| factor * x).collect();
        match (self, balance) {
            (Self::Hub, Balance::Drive | Balance::Hub) | (Self::Motor, Balance::Drive) => error.to_vec(),
            (Self::Motor, Balance::Twist) => times(&slope(), -1.0 / stiffness),
            (Self::Gear, Balance::Hub) => times(error, -stiffness),
            (Self::Gear, Balance::Twist) => times(&slope(), -1.0),
            (Self::HubGyro | Self::PlatformGyro, _) => self.misread(balance, error, at),
            (Self::Accelerometer, Balance::Drive | Balance::Hub) => times(error, at.moment()),
            _ => vec![0.0; error.len()],
        }
    }

    /// Returns what an error of a gyroscope adds.
    fn misread(self, balance: Balance, error: &[f64], at: &Signals) -> Vec<f64> {
        let own = if self == Self::HubGyro { 1.0 } else { -1.0 };
        if matches!(balance, Balance::Twist | Balance::Angle) {
            return error.iter().map(|e| own * e).collect();
        }
        let inertial = if self == Self::HubGyro { at.inertia() } else { 0.0 };
        let viscous = at.p.pivot_friction.viscous_nm_s_rad;
        let geared =
            if balance == Balance::Drive && !at.motor_measured { own * through_gear(at) } else { 0.0 };
        let rotor = geared * at.p.motor.inertia_kg_m2;
        let pairs = error.iter().zip(derivative(error, at.period_s));
        let torque = |(e, slope): (&f64, f64)| {
            (inertial + rotor) * slope + (own * viscous + geared * motor_viscous(at)) * e
        };
        pairs.map(torque).collect()
    }
}

/// Returns the square of the gear's ratio, which refers a torque in proportion to the motor's rate to the hub.
fn through_gear(at: &Signals) -> f64 {
    at.p.gearbox.ratio.powi(2)
}

/// Returns the torque at the shaft for the motor's rate, by friction and back-EMF, N m s/rad.
fn motor_viscous(at: &Signals) -> f64 {
    let motor = &at.p.motor;
    let drive = SteadyDrive::of(at.p);
    at.p.motor_friction.viscous_nm_s_rad + motor.torque_constant_nm_a * drive.back_emf / drive.loss
}
