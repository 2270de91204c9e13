//! Error hypotheses: at which component, and along which regime variable, something may act that the model lacks.
//!
//! A hypothesis is a free function of one variable, at one port, times what that component's errors scale with: friction with the
//! direction of sliding, a motor's loss with its torque, a spring with nothing else. Nothing more is assumed of the function.

use crate::library::{Component, EffectName, named};
use crate::localisation::ports::Port;
use crate::localisation::torque_balances::{BalanceColumn as B, BalanceSignals, envelope};
use crate::recording::series::derivative;
use Port::{Accelerometer, Gear, Hub, HubGyro, Motor, PlatformGyro};
use SignalQuantity as Q;

/// A quantity that the signals give at every sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SignalQuantity {
    One,
    Time,
    Rate,
    Speed,
    /// Angle since the last reversal.
    Travel,
    Position,
    Amplitude,
    Acceleration,
    AccelerationBend,
    Sliding,
    Forward,
    Backward,
    Turning,
    MotorSpeed,
    MotorTravel,
    MotorAngle,
    Drive,
    Mesh,
    /// The gear's torque while the motor drives the hub, and while the hub drives the motor.
    Driving,
    Driven,
    Control,
    /// The change of the drive's torque if it came this many samples late, or followed with a lag of this many milliseconds.
    Late(u8),
    Lagged(u8),
    Weight,
    Heave,
    HeaveSlope,
    HubRate,
    HubRateSlope,
    PlatformRate,
    PlatformRateSlope,
}

/// The form of an error.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Law {
    /// A free function of the first times the second.
    Free(Port, SignalQuantity, SignalQuantity),
    /// A sine of time times a quantity, of any phase in every recording.
    Sine(Port, SignalQuantity),
    /// A sine of the first, the phase common to all recordings, times the second.
    Repeats(Port, SignalQuantity, SignalQuantity),
    /// A sine of the motor's angle times a quantity.
    Turns(Port, SignalQuantity),
    /// Any multiple of each, at its port.
    Fixed(&'static [(Port, SignalQuantity)]),
    /// Any multiple of that one of them that gains most.
    OneOf(Port, &'static [SignalQuantity]),
    /// Multiples of several ports' errors that come together.
    Together(&'static [(Port, SignalQuantity)]),
}

/// An error hypothesis: a component, a regime variable, and the form of the error.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ErrorHypothesis {
    pub component: Component,
    pub regime: Regime,
    pub law: Law,
}

const fn at(component: Component, regime: Regime, law: Law) -> ErrorHypothesis {
    ErrorHypothesis { component, regime, law }
}

named! {
    /// A regime: the variable along which an error is sought, in the order of the charts.
    Regime {
        /// Rate of the hub on the platform, or of the motor.
        Rate = "rate",
        /// Distance since the last reversal.
        Reversal = "reversal",
        /// Angle of the hub on the platform.
        Position = "position",
        /// Angle of the motor.
        MotorAngle = "motor angle",
        /// Torque carried.
        Load = "load",
        /// Control voltage.
        Control = "control",
        /// Time.
        Time = "time",
        /// Acceleration.
        Acceleration = "acceleration",
        /// Amplitude of the motion.
        Amplitude = "amplitude",
        /// Frequency.
        Frequency = "frequency",
    }
}

/// The components in which an error is sought, the one with the higher prior probability first: if two explain equally much, the
/// first is reported first.
pub(crate) const COMPONENTS: [Component; 10] = [
    Component::Structure,
    Component::Pivot,
    Component::Gearbox,
    Component::Motor,
    Component::Amplifier,
    Component::Control,
    Component::HubGyro,
    Component::PlatformGyro,
    Component::PlatformAccelerometer,
    Component::Platform,
];

/// Returns the regime variables along which an effect of the library shows, the plainest first; empty for an effect that has no
/// cell.
pub(crate) fn regimes_of(component: Component, effect: EffectName) -> &'static [Regime] {
    use {Component as C, EffectName as E, Regime as R};
    match (component, effect) {
        (C::Pivot | C::Motor, E::Coulomb) => &[R::Reversal, R::Rate],
        (C::Pivot, E::Stribeck) => &[R::Rate, R::Reversal],
        (C::Pivot | C::Motor, E::Viscous | E::QuadraticDrag | E::AsymmetricFriction) => &[R::Rate],
        (C::Pivot, E::PreslidingStiffness) | (C::Structure, E::Hysteresis) => &[R::Reversal],
        (C::Structure, E::VerticalOffset | E::PositionStiffness | E::Equilibrator | E::EndStops)
        | (C::Pivot, E::PositionDependentFriction) => &[R::Position],
        (C::Structure, E::OutOfBalance)
        | (C::Pivot, E::LoadDependentFriction)
        | (C::Gearbox, E::Stiffness | E::Backlash)
        | (C::Motor, E::TorqueConstant) => &[R::Load],
        (C::Gearbox, E::MeshEfficiency) => &[R::Rate, R::Load],
        (C::Structure | C::Motor, E::Inertia) => &[R::Acceleration],
        (C::Motor, E::Cogging | E::TorqueRipple) | (C::Gearbox, E::MeshRipple) => &[R::MotorAngle],
        (C::Amplifier, E::GainCurve | E::DeadZone | E::CurrentLimit | E::ContinuousCurrent) => &[R::Control],
        (C::Pivot, E::WarmUp) | (C::Structure, E::Recoil) => &[R::Time],
        (C::HubGyro | C::PlatformGyro, E::Scale) => &[R::Rate],
        (_, E::Bias) => &[R::Time],
        (_, E::GSensitivity | E::Tilt) | (C::PlatformAccelerometer, E::Scale) => &[R::Acceleration],
        // no balance has the base's roll and yaw, so what they make shows by its spectrum and its course alone
        (_, E::Misalignment) => &[R::Frequency, R::Time],
        (_, E::FlexibleMode | E::Damping | E::Bandwidth | E::Delay | E::LeverArm | E::ChannelSkew) => {
            &[R::Frequency]
        }
        _ => &[],
    }
}

/// Time constants of a lag in the drive, ms.
const LAGS: &[SignalQuantity] = &[Q::Lagged(1), Q::Lagged(2), Q::Lagged(4), Q::Lagged(8), Q::Lagged(16)];
/// Samples by which the control may be late.
const DELAYS: &[SignalQuantity] =
    &[Q::Late(1), Q::Late(2), Q::Late(3), Q::Late(4), Q::Late(6), Q::Late(8), Q::Late(11), Q::Late(15)];

/// Every error hypothesis.
pub(crate) const ERROR_HYPOTHESES: &[ErrorHypothesis] = &[
    at(Component::Structure, Regime::Position, Law::Free(Hub, Q::Position, Q::One)),
    at(Component::Structure, Regime::Position, Law::Repeats(Hub, Q::Position, Q::One)),
    at(Component::Structure, Regime::Time, Law::Free(Hub, Q::Time, Q::One)),
    at(Component::Structure, Regime::Time, Law::Sine(Hub, Q::One)),
    at(Component::Structure, Regime::Load, Law::Fixed(&[(Hub, Q::Weight)])),
    at(Component::Structure, Regime::Acceleration, Law::Fixed(&[(Hub, Q::Acceleration)])),
    at(
        Component::Structure,
        Regime::Frequency,
        Law::Fixed(&[(Hub, Q::Acceleration), (Hub, Q::AccelerationBend)]),
    ),
    at(Component::Pivot, Regime::Rate, Law::Free(Hub, Q::Speed, Q::Sliding)),
    at(Component::Pivot, Regime::Rate, Law::Fixed(&[(Hub, Q::Rate), (Hub, Q::Forward), (Hub, Q::Backward)])),
    at(Component::Pivot, Regime::Reversal, Law::Free(Hub, Q::Travel, Q::Sliding)),
    at(Component::Pivot, Regime::Position, Law::Free(Hub, Q::Position, Q::Sliding)),
    at(Component::Pivot, Regime::Position, Law::Repeats(Hub, Q::Position, Q::Sliding)),
    at(Component::Pivot, Regime::Load, Law::Free(Hub, Q::Mesh, Q::Sliding)),
    at(Component::Pivot, Regime::Time, Law::Free(Hub, Q::Time, Q::Sliding)),
    at(Component::Pivot, Regime::Acceleration, Law::Free(Hub, Q::Acceleration, Q::Sliding)),
    at(Component::Pivot, Regime::Amplitude, Law::Free(Hub, Q::Amplitude, Q::Sliding)),
    at(Component::Gearbox, Regime::Load, Law::Free(Gear, Q::Mesh, Q::One)),
    at(Component::Gearbox, Regime::MotorAngle, Law::Turns(Hub, Q::One)),
    at(Component::Gearbox, Regime::MotorAngle, Law::Turns(Gear, Q::One)),
    at(Component::Gearbox, Regime::Rate, Law::Fixed(&[(Hub, Q::Driving), (Motor, Q::Driven)])),
    at(Component::Gearbox, Regime::Time, Law::Free(Gear, Q::Time, Q::Mesh)),
    at(Component::Motor, Regime::Rate, Law::Free(Motor, Q::MotorSpeed, Q::Turning)),
    at(Component::Motor, Regime::Reversal, Law::Free(Motor, Q::MotorTravel, Q::Turning)),
    at(Component::Motor, Regime::MotorAngle, Law::Turns(Motor, Q::One)),
    at(Component::Motor, Regime::MotorAngle, Law::Turns(Motor, Q::Drive)),
    at(Component::Motor, Regime::Load, Law::Fixed(&[(Motor, Q::Drive)])),
    at(Component::Motor, Regime::Time, Law::Free(Motor, Q::Time, Q::Drive)),
    at(Component::Motor, Regime::Time, Law::Sine(Motor, Q::Drive)),
    at(Component::Amplifier, Regime::Control, Law::Free(Motor, Q::Control, Q::One)),
    at(Component::Amplifier, Regime::Time, Law::Free(Motor, Q::Time, Q::One)),
    at(Component::Amplifier, Regime::Time, Law::Sine(Motor, Q::One)),
    at(Component::Amplifier, Regime::Frequency, Law::OneOf(Motor, LAGS)),
    at(Component::Control, Regime::Frequency, Law::OneOf(Motor, DELAYS)),
    at(Component::HubGyro, Regime::Rate, Law::Fixed(&[(HubGyro, Q::HubRate)])),
    at(Component::HubGyro, Regime::Time, Law::Free(HubGyro, Q::Time, Q::One)),
    at(Component::HubGyro, Regime::Acceleration, Law::Fixed(&[(HubGyro, Q::Heave)])),
    at(Component::HubGyro, Regime::Frequency, Law::Fixed(&[(HubGyro, Q::HubRateSlope)])),
    at(Component::PlatformGyro, Regime::Rate, Law::Fixed(&[(PlatformGyro, Q::PlatformRate)])),
    at(Component::PlatformGyro, Regime::Time, Law::Free(PlatformGyro, Q::Time, Q::One)),
    at(Component::PlatformGyro, Regime::Acceleration, Law::Fixed(&[(PlatformGyro, Q::Heave)])),
    at(Component::PlatformGyro, Regime::Frequency, Law::Fixed(&[(PlatformGyro, Q::PlatformRateSlope)])),
    at(Component::PlatformAccelerometer, Regime::Acceleration, Law::Fixed(&[(Accelerometer, Q::Heave)])),
    at(Component::PlatformAccelerometer, Regime::Time, Law::Free(Accelerometer, Q::Time, Q::One)),
    at(
        Component::PlatformAccelerometer,
        Regime::Frequency,
        Law::Fixed(&[(Accelerometer, Q::PlatformRateSlope)]),
    ),
    at(
        Component::Platform,
        Regime::Frequency,
        Law::Together(&[(PlatformGyro, Q::PlatformRateSlope), (Accelerometer, Q::HeaveSlope)]),
    ),
];

impl SignalQuantity {
    /// Returns its value at every sample of a recording.
    pub fn of(self, s: &BalanceSignals) -> Vec<f64> {
        match self {
            Self::One => vec![1.0; s.len()],
            Self::Time => (0..s.len()).map(|k| k as f64 * s.period_s).collect(),
            Self::Position => s.column(B::Angle).to_vec(),
            Self::Acceleration => s.column(B::Acceleration).to_vec(),
            Self::Weight => s.weight(),
            Self::Heave => s.column(B::Heave).to_vec(),
            Self::HubRate => s.column(B::Hub).to_vec(),
            Self::PlatformRate => s.column(B::Platform).to_vec(),
            Self::Control => s.column(B::Control).to_vec(),
            Self::Drive => s.column(B::Drive).to_vec(),
            Self::Mesh => s.column(B::Mesh).to_vec(),
            Self::Driving => s
                .column(B::Mesh)
                .iter()
                .zip(s.column(B::Turning))
                .map(|(t, w)| t * (t * w).signum().max(0.0))
                .collect(),
            Self::Driven => s
                .column(B::Mesh)
                .iter()
                .zip(s.column(B::Turning))
                .map(|(t, w)| t * (t * w).signum().min(0.0))
                .collect(),
            Self::Late(samples) => delay_difference(s.column(B::Drive), usize::from(samples)),
            Self::Lagged(ms) => lag_difference(s.column(B::Drive), 1e-3 * f64::from(ms) / s.period_s),
            Self::AccelerationBend | Self::HeaveSlope | Self::HubRateSlope | Self::PlatformRateSlope => {
                self.derivative_series(s)
            }
            _ => self.of_motion(s),
        }
    }

    /// Returns a derivative.
    fn derivative_series(self, s: &BalanceSignals) -> Vec<f64> {
        let slope = |series: &[f64]| derivative(series, s.period_s);
        match self {
            Self::AccelerationBend => slope(&slope(s.column(B::Acceleration))),
            Self::HeaveSlope => slope(s.column(B::Heave)),
            Self::HubRateSlope => slope(s.column(B::Hub)),
            _ => slope(s.column(B::Platform)),
        }
    }

    /// Returns what follows from the rates of hub and motor.
    fn of_motion(self, s: &BalanceSignals) -> Vec<f64> {
        let size = |series: &[f64]| series.iter().map(|v| v.abs()).collect();
        match self {
            Self::Speed => size(s.column(B::Relative)),
            Self::MotorSpeed => size(s.column(B::Motor)),
            Self::Travel => since_reversal(s.column(B::Relative), s.period_s),
            Self::MotorTravel => since_reversal(s.column(B::Motor), s.period_s),
            Self::Amplitude => envelope(s.column(B::Relative), s.period_s),
            Self::MotorAngle => s.column(B::Angle).iter().map(|a| a * s.p.gearbox.ratio).collect(),
            Self::Sliding => s.column(B::Sliding).to_vec(),
            Self::Forward => s.column(B::Sliding).iter().map(|w| w.max(0.0)).collect(),
            Self::Backward => s.column(B::Sliding).iter().map(|w| w.min(0.0)).collect(),
            Self::Turning => s.column(B::Turning).to_vec(),
            _ => s.column(B::Relative).to_vec(),
        }
    }

    /// Returns whether a function of it changes most at small values.
    pub fn is_dense_at_rest(self) -> bool {
        matches!(self, Self::Speed | Self::Travel | Self::MotorSpeed | Self::MotorTravel)
    }

    /// Returns whether it is the derivative of a noisy rate that occurs in a balance itself.
    pub fn is_mostly_noise(self) -> bool {
        matches!(self, Self::Acceleration | Self::AccelerationBend | Self::HubRateSlope)
    }

    /// Returns its unit; empty if it has none.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Rate | Self::Speed | Self::Amplitude | Self::MotorSpeed => "rad/s",
            Self::Position | Self::Travel | Self::MotorTravel => "rad",
            Self::Mesh => "N m",
            Self::Control => "V",
            Self::Time => "s",
            Self::Acceleration => "rad/s^2",
            _ => "",
        }
    }
}

/// Returns a delayed series less the series itself.
fn delay_difference(series: &[f64], samples: usize) -> Vec<f64> {
    (0..series.len()).map(|k| series[k.saturating_sub(samples)] - series[k]).collect()
}

/// Returns a series behind a lag, whose time constant is given in samples, less the series itself.
fn lag_difference(series: &[f64], samples: f64) -> Vec<f64> {
    let mut state = series.first().copied().unwrap_or(0.0);
    let step = |v: &f64| {
        state += (v - state) / (1.0 + samples);
        state - v
    };
    series.iter().map(step).collect()
}

/// Returns the angle moved since the direction was last reversed, rad.
fn since_reversal(rate: &[f64], period_s: f64) -> Vec<f64> {
    let slow = 0.02 * crate::recording::series::rms(rate);
    let (mut direction, mut moved) = (0.0, 0.0);
    let step = |w: &f64| {
        if w.abs() > slow && w.signum() != direction {
            (direction, moved) = (w.signum(), 0.0);
        }
        moved += w.abs() * period_s;
        moved
    };
    rate.iter().map(step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library::list_effects;

    #[test]
    fn every_effect_of_the_library_has_its_cell() {
        for effect in list_effects() {
            let regimes = regimes_of(effect.component, effect.effect);
            assert!(!regimes.is_empty(), "{effect:?}");
            assert!(regimes.iter().all(|r| Regime::ALL.contains(r)), "{effect:?}");
            assert!(COMPONENTS.contains(&effect.component), "{effect:?}");
        }
    }
}
