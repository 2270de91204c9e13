//! Balances of motion and torque, formed from the measured signals alone.
//!
//! All signals pass the same low-pass Q, so that a derivative brings no bias:
//!
//! ```text
//!     twist   Q[w_h - w_p - w_m / N] + d/dt (T_2 / K)            gear kinematics and elasticity
//!     angle   Q[w_h - w_p - d/dt (theta_h - theta_p)]            gyroscopes against the resolver
//!     drive   Q[J w_h' + N J_m w_m' - N K_t i + N F_m + F_p + T_oob]   everything that makes torque, either side
//!     hub     Q[J w_h' + F_p + T_oob - K deadzone(delta)]        what acts on the hub side of the gear
//! ```
//!
//! An error shows in the balances that contain its component, and in no other; which balances there are depends on the sensors.

use crate::tolerance::localisation::{
    BALANCE_MARGIN, BALANCE_SMOOTHING, BALANCE_THINNING, NEARLY_AT_REST_SHARE,
};
use counterpoise_models::Parameters;
use counterpoise_recordings::{ColumnName, Signals};
use serde::Serialize;

use crate::library::{Component, named};
use crate::machine::{RedundantSensors, SteadyDrive, cosine};
use crate::recording::measured_signals::MeasuredSignals;
use crate::recording::series::{derivative, low_pass, moving_mean};
use crate::tolerance::localisation::LEAST_RMS_RATE_RAD_S;

/// The quantities that a balance can show.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct BalanceVisibility {
    /// The balance.
    pub balance: Balance,
    /// `true` if these sensors allow it.
    pub available: bool,
    /// Components whose errors show in it.
    pub sees: Vec<Component>,
}

named! {
    /// A balance of motion or torque that measured signals are put into.
    Balance {
        /// The motor's current against the amplifier; it needs a current sensor, which no recording has.
        Current = "current",
        /// Gear kinematics and elasticity.
        Twist = "twist",
        /// The gyroscopes against the resolver.
        Angle = "angle",
        /// Everything that makes torque, on either side of the gear.
        Drive = "drive",
        /// The torque on the hub side of the gear.
        Hub = "hub",
    }
}

impl Balance {
    /// Returns the balances that a set of sensors allows.
    pub(crate) fn select_allowed(sensors: RedundantSensors) -> Vec<Self> {
        list_balances(sensors).into_iter().filter(|row| row.available).map(|row| row.balance).collect()
    }
}

/// Lists every balance, whether a set of sensors allows it, and the components whose errors show in it.
pub fn list_balances(sensors: RedundantSensors) -> Vec<BalanceVisibility> {
    use Component as C;
    let RedundantSensors { motor_rate, hub_position } = sensors;
    let row = |balance, available, sees: &[C]| BalanceVisibility { balance, available, sees: sees.to_vec() };
    let torque = [
        C::Amplifier,
        C::Motor,
        C::Gearbox,
        C::Pivot,
        C::Structure,
        C::Control,
        C::HubGyro,
        C::PlatformAccelerometer,
    ];
    let hub_side = [C::Gearbox, C::Pivot, C::Structure, C::HubGyro, C::PlatformAccelerometer];
    vec![
        row(Balance::Current, false, &[C::Amplifier]),
        row(Balance::Twist, motor_rate, &[C::Gearbox, C::HubGyro, C::PlatformGyro, C::Platform]),
        row(Balance::Angle, hub_position, &[C::HubGyro, C::PlatformGyro, C::Platform]),
        row(Balance::Drive, true, &torque),
        row(Balance::Hub, motor_rate && hub_position, &hub_side),
    ]
}

/// A column of the signals of the balances.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum BalanceColumn {
    /// Control, V.
    Control,
    /// Hub rate, rad/s.
    Hub,
    /// Platform rate, rad/s.
    Platform,
    /// Heave, m/s^2.
    Heave,
    /// Motor rate, rad/s.
    Motor,
    /// Hub rate on the platform, rad/s.
    Relative,
    /// Hub angle on the platform, rad.
    Angle,
    /// Acceleration of the hub, rad/s^2.
    Acceleration,
    /// Direction of sliding at the pivot, -1 to 1.
    Sliding,
    /// Direction of turning at the motor, -1 to 1.
    Turning,
    /// Torque that the motor's current makes, at the hub, N m.
    Drive,
    /// Torque that the load side needs, N m.
    Load,
    /// Torque that the motor gives to the gear, at its output, N m.
    Mesh,
}

impl BalanceColumn {
    /// Number of columns.
    const COUNT: usize = 13;
}

impl ColumnName for BalanceColumn {
    fn index(self) -> usize {
        self as usize
    }
}

/// The measured signals of a recording after the low-pass, and what follows from them.
pub(crate) struct BalanceSignals<'a> {
    pub p: &'a Parameters,
    pub period_s: f64,
    /// `true` if the motor's rate was measured; otherwise it is the hub's through a rigid gear.
    pub motor_measured: bool,
    signals: Signals<BalanceColumn>,
}

/// Rates at which the two frictions count as sliding, rad/s: pivot, motor.
pub(crate) type SlidingRates = [f64; 2];

impl<'a> BalanceSignals<'a> {
    /// Computes the signals of a recording; `slow` gives the rates below which the frictions count as at rest, if another reading
    /// of the recording determines them.
    pub fn new(p: &'a Parameters, m: &MeasuredSignals, slow: Option<SlidingRates>) -> Self {
        let inertial = m.with_inertial_rate();
        let m = inertial.as_ref();
        let smooth = |series: &[f64]| low_pass(series, BALANCE_SMOOTHING);
        let (hub, platform) = (smooth(m.hub_rate()), smooth(m.platform_rate()));
        let relative: Vec<f64> = hub.iter().zip(&platform).map(|(h, p)| h - p).collect();
        let geared = || relative.iter().map(|w| w * p.gearbox.ratio).collect();
        let motor = m.motor_rate().map_or_else(geared, smooth);
        let angle = m.hub_position().map_or_else(|| integral(&relative, m.period_s), smooth);
        let [pivot, shaft] = slow.unwrap_or_else(|| [slow_rate(&relative), slow_rate(&motor)]);
        let measured = [
            (BalanceColumn::Control, smooth(m.control())),
            (BalanceColumn::Heave, smooth(m.platform_accel())),
            (BalanceColumn::Acceleration, derivative(&hub, m.period_s)),
            (BalanceColumn::Sliding, relative.iter().map(|w| (w / pivot).tanh()).collect()),
            (BalanceColumn::Turning, motor.iter().map(|w| (w / shaft).tanh()).collect()),
            (BalanceColumn::Hub, hub),
            (BalanceColumn::Platform, platform),
            (BalanceColumn::Motor, motor),
            (BalanceColumn::Relative, relative),
            (BalanceColumn::Angle, angle),
        ];
        let mut out = Self {
            p,
            period_s: m.period_s,
            motor_measured: m.recorded.motor_rate,
            signals: Signals::zeros(measured[0].1.len(), BalanceColumn::COUNT),
        };
        measured.into_iter().for_each(|(column, values)| out.set(column, &values));
        out.set(BalanceColumn::Load, &out.load_torque());
        out.set(BalanceColumn::Drive, &out.drive_torque());
        out.set(BalanceColumn::Mesh, &out.motor_torque());
        out
    }

    fn set(&mut self, column: BalanceColumn, values: &[f64]) {
        self.signals.column_mut(column).iter_mut().zip(values).for_each(|(sample, value)| *sample = *value);
    }

    /// Returns the samples of a column.
    pub fn column(&self, column: BalanceColumn) -> &[f64] {
        self.signals.column(column)
    }

    /// Returns the number of samples.
    pub fn len(&self) -> usize {
        self.signals.len()
    }

    /// Returns the rates below which the frictions count as at rest, rad/s.
    pub fn slow_rates(&self) -> SlidingRates {
        [slow_rate(self.column(BalanceColumn::Relative)), slow_rate(self.column(BalanceColumn::Motor))]
    }

    /// Returns (g + a) cos(theta_h - theta_p), m/s^2.
    pub fn weight(&self) -> Vec<f64> {
        let heavy = self.column(BalanceColumn::Heave).iter().zip(self.column(BalanceColumn::Angle));
        heavy.map(|(a, angle)| (self.p.gravity_m_s2 + a) * cosine(self.p, *angle)).collect()
    }

    /// Returns the first moment of mass about the pivot, kg m.
    pub fn moment(&self) -> f64 {
        self.p.lumped.as_ref().map_or(0.0, |l| l.out_of_balance_kg_m)
    }

    /// Returns the inertia about the pivot, kg m^2.
    pub fn inertia(&self) -> f64 {
        self.p.lumped.as_ref().map_or(0.0, |l| l.inertia_kg_m2())
    }

    /// J w_h' + F_p + T_oob.
    fn load_torque(&self) -> Vec<f64> {
        let friction = &self.p.pivot_friction;
        let (inertia, moment, weight) = (self.inertia(), self.moment(), self.weight());
        let (dry, viscous) = (friction.coulomb_nm(), friction.viscous_nm_s_rad);
        let (acceleration, relative) =
            (self.column(BalanceColumn::Acceleration), self.column(BalanceColumn::Relative));
        let sliding = self.column(BalanceColumn::Sliding);
        let rates = |k: usize| inertia * acceleration[k] + viscous * relative[k];
        (0..self.len()).map(|k| rates(k) + dry * sliding[k] + moment * weight[k]).collect()
    }

    /// N K_t i.
    fn drive_torque(&self) -> Vec<f64> {
        let (p, drive) = (self.p, SteadyDrive::of(self.p));
        let gain = p.gearbox.ratio * p.motor.torque_constant_nm_a;
        let pairs = self.column(BalanceColumn::Control).iter().zip(self.column(BalanceColumn::Motor));
        pairs.map(|(u, w)| gain * drive.current_a(*u, *w)).collect()
    }

    /// N (K_t i - F_m - J_m w_m').
    fn motor_torque(&self) -> Vec<f64> {
        let p = self.p;
        let (dry, viscous) = (p.motor_friction.coulomb_nm(), p.motor_friction.viscous_nm_s_rad);
        let (motor, turning) = (self.column(BalanceColumn::Motor), self.column(BalanceColumn::Turning));
        let acceleration = derivative(motor, self.period_s);
        let lost = |k: usize| dry * turning[k] + viscous * motor[k] + p.motor.inertia_kg_m2 * acceleration[k];
        let drive = self.column(BalanceColumn::Drive);
        (0..self.len()).map(|k| drive[k] - p.gearbox.ratio * lost(k)).collect()
    }

    /// Returns the residual of a balance.
    pub fn residual(&self, balance: Balance) -> Vec<f64> {
        match balance {
            Balance::Twist => self.twist(),
            Balance::Angle => subtract(
                self.column(BalanceColumn::Relative),
                &derivative(self.column(BalanceColumn::Angle), self.period_s),
            ),
            Balance::Drive => subtract(self.column(BalanceColumn::Load), self.column(BalanceColumn::Mesh)),
            Balance::Hub => self.hub_side(),
            // no recording has the motor's current, so this balance is never allowed
            Balance::Current => vec![f64::NAN; self.len()],
        }
    }

    fn twist(&self) -> Vec<f64> {
        let windup = derivative(self.column(BalanceColumn::Mesh), self.period_s);
        let gear = &self.p.gearbox;
        let (relative, motor) = (self.column(BalanceColumn::Relative), self.column(BalanceColumn::Motor));
        let at = |k: usize| relative[k] - motor[k] / gear.ratio + windup[k] / gear.stiffness_nm_rad;
        (0..self.len()).map(at).collect()
    }

    /// Returns the torque of the gear's wind-up, measured by both encoders and started from the load, against the load torque.
    fn hub_side(&self) -> Vec<f64> {
        let gear = &self.p.gearbox;
        let turned = integral(self.column(BalanceColumn::Motor), self.period_s);
        let (load, angle) = (self.column(BalanceColumn::Load), self.column(BalanceColumn::Angle));
        let gap = 0.5 * gear.backlash_rad;
        let first = load.first().copied().unwrap_or(0.0);
        let start =
            first / gear.stiffness_nm_rad + gap * first.signum() + angle.first().copied().unwrap_or(0.0);
        let at = |k: usize| {
            let delta: f64 = start + turned[k] / gear.ratio - angle[k];
            load[k] - gear.stiffness_nm_rad * (delta.abs() - gap).max(0.0) * delta.signum()
        };
        (0..self.len()).map(at).collect()
    }
}

fn subtract(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn slow_rate(rate: &[f64]) -> f64 {
    NEARLY_AT_REST_SHARE * crate::recording::series::rms(rate).max(LEAST_RMS_RATE_RAD_S)
}

pub(crate) fn integral(series: &[f64], period: f64) -> Vec<f64> {
    let mut sum = 0.0;
    let step = |w: &f64| {
        sum += w * period;
        sum
    };
    series.iter().map(step).collect()
}

/// Returns the RMS over half a second.
pub(crate) fn envelope(series: &[f64], period: f64) -> Vec<f64> {
    let half = (0.25 / period).round() as usize;
    let squares: Vec<f64> = series.iter().map(|w| w * w).collect();
    moving_mean(&squares, half).iter().map(|s| s.sqrt()).collect()
}

/// Returns what is kept of a balance: without its ends, at which the low-pass sees half of what it needs.
pub(crate) fn trim_ends(series: &[f64]) -> Vec<f64> {
    let margin = BALANCE_MARGIN.min(series.len() / 4);
    series[margin..series.len() - margin].iter().step_by(BALANCE_THINNING).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sensors_decide_which_balances_there_are() {
        let allowed =
            |motor_rate, hub_position| Balance::select_allowed(RedundantSensors { motor_rate, hub_position });
        assert_eq!(allowed(false, false), [Balance::Drive]);
        assert_eq!(allowed(false, true), [Balance::Angle, Balance::Drive]);
        assert_eq!(allowed(true, true), Balance::ALL[1..]);
    }

    #[test]
    fn the_low_pass_keeps_a_straight_line_and_its_slope() {
        let line: Vec<f64> = (0..400).map(|k| 3.0 * f64::from(k)).collect();
        let slopes = trim_ends(&derivative(&low_pass(&line, BALANCE_SMOOTHING), 0.5));
        assert!(slopes.iter().all(|s| (s - 6.0).abs() < 1e-9));
    }
}
