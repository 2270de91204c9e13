//! The sources of the line of sight's error, and how each is switched off.

use counterpoise_models::plant::Body;
use counterpoise_models::{Clock, Drift, Friction, FrictionLaw, Parameters, Ripple, Sensor};

use crate::{Procedure, RoadColumn};

/// A source of the line of sight's error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ErrorSource {
    /// Upward acceleration of the base.
    Heave,
    /// Forward acceleration of the base.
    Surge,
    /// Rate of the base about the elevation axis.
    Pitch,
    /// Rate of the base about its forward axis.
    Roll,
    /// Rate of the base about its upward axis.
    Yaw,
    /// Bending: the flexible modes of the structure.
    Bending,
    /// Friction of motor and pivot, hoses and hysteresis.
    Friction,
    /// The gap of the gear.
    Backlash,
    /// Cogging, torque ripple, mesh ripple and the kinematic error of the transmission.
    Ripple,
    /// Noise, bias and drift of the gyroscope in the loop.
    HubGyro,
    /// Errors of the gyroscope on the platform.
    PlatformGyro,
    /// Errors of the accelerometer of heave.
    Accelerometer,
    /// Errors of the accelerometer of surge.
    SurgeAccelerometer,
    /// Errors of the motor's tachometer.
    MotorTachometer,
    /// Errors of the hub's resolver.
    HubResolver,
    /// Steps of the converters and missing codes.
    Quantisation,
    /// Errors of the clock.
    Clock,
    /// Recoil of what the machine fires.
    Recoil,
}

impl ErrorSource {
    /// Every source, in the order in which they are switched on.
    pub const ALL: [Self; 18] = [
        Self::Heave,
        Self::Surge,
        Self::Pitch,
        Self::Roll,
        Self::Yaw,
        Self::Bending,
        Self::Friction,
        Self::Backlash,
        Self::Ripple,
        Self::HubGyro,
        Self::PlatformGyro,
        Self::Accelerometer,
        Self::SurgeAccelerometer,
        Self::MotorTachometer,
        Self::HubResolver,
        Self::Quantisation,
        Self::Clock,
        Self::Recoil,
    ];

    /// Returns the source's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Heave => "heave",
            Self::Surge => "surge",
            Self::Pitch => "pitch",
            Self::Roll => "roll",
            Self::Yaw => "yaw",
            Self::Bending => "bending",
            Self::Friction => "friction",
            Self::Backlash => "backlash",
            Self::Ripple => "cogging and ripple",
            Self::HubGyro => "hub gyroscope",
            Self::PlatformGyro => "platform gyroscope",
            Self::Accelerometer => "platform accelerometer",
            Self::SurgeAccelerometer => "surge accelerometer",
            Self::MotorTachometer => "motor tachometer",
            Self::HubResolver => "hub resolver",
            Self::Quantisation => "converters",
            Self::Clock => "clock",
            Self::Recoil => "recoil",
        }
    }
}

/// A machine and its motion, from which sources are taken.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BudgetMachine {
    pub parameters: Parameters,
    pub body: Body,
    pub procedure: Procedure,
}

/// Takes a source out of the machine or of its motion.
pub(super) fn switch_off(source: ErrorSource, from: &mut BudgetMachine) {
    let (p, procedure) = (&mut from.parameters, &mut from.procedure);
    match source {
        ErrorSource::Bending => from.body.modes.clear(),
        ErrorSource::Friction => remove_friction(p),
        ErrorSource::Backlash => p.gearbox.backlash_rad = p.gearbox.backlash_rad.min(0.0),
        ErrorSource::Ripple => {
            (p.motor.cogging, p.motor.torque_ripple) = (Ripple::NONE, Ripple::NONE);
            (p.gearbox.mesh_ripple, p.gearbox.kinematic_error) = (Ripple::NONE, Ripple::NONE);
        }
        ErrorSource::HubGyro => make_exact(&mut p.sensors.hub_gyro),
        ErrorSource::PlatformGyro => make_exact(&mut p.sensors.platform_gyro),
        ErrorSource::Accelerometer => make_exact(&mut p.sensors.platform_accelerometer),
        ErrorSource::SurgeAccelerometer => p.sensors.surge_accelerometer.iter_mut().for_each(make_exact),
        ErrorSource::MotorTachometer => p.sensors.motor_tachometer.iter_mut().for_each(make_exact),
        ErrorSource::HubResolver => p.sensors.hub_resolver.iter_mut().for_each(make_exact),
        ErrorSource::Quantisation => {
            // as fine as doubles resolve the range of +/- 10 V
            (p.interface.input_bits, p.interface.output_bits) = (FINEST_BITS, FINEST_BITS);
            p.interface.missing_codes = 0.0;
        }
        ErrorSource::Clock => p.interface.clock = Clock::IDEAL,
        ErrorSource::Recoil => p.loads.recoil = None,
        ErrorSource::Heave
        | ErrorSource::Surge
        | ErrorSource::Pitch
        | ErrorSource::Roll
        | ErrorSource::Yaw => remove_motion(source, procedure),
    }
}

/// Bits of converters whose steps are lost in the rounding of doubles.
const FINEST_BITS: u32 = 32;

fn remove_friction(p: &mut Parameters) {
    let none = Friction::with_viscous_part(FrictionLaw::None, 0.0);
    (p.motor_friction, p.pivot_friction) = (none.clone(), none);
    p.gearbox.hysteresis_nm = 0.0;
    if let Some(lumped) = &mut p.lumped {
        lumped.hysteresis_nm = 0.0;
    }
}

/// A sensor without noise, bias, drift and error of its gain; its dynamics and its delay stay, for the loop is designed on them.
fn make_exact(sensor: &mut Sensor) {
    (sensor.noise_rms, sensor.bias, sensor.drift) = (0.0, 0.0, Drift::NONE);
    (sensor.resolution, sensor.g_sensitivity) = (0.0, 0.0);
    if sensor.is_fitted() {
        sensor.gain = 1.0;
    }
}

fn remove_motion(source: ErrorSource, procedure: &mut Procedure) {
    let Some(road) = &mut procedure.road else {
        match source {
            ErrorSource::Heave => procedure.heave.amplitude = 0.0,
            ErrorSource::Pitch => procedure.pitch.amplitude = 0.0,
            _ => {}
        }
        return;
    };
    let column = match source {
        ErrorSource::Heave => RoadColumn::Heave,
        ErrorSource::Pitch => RoadColumn::PitchRate,
        ErrorSource::Surge => RoadColumn::Surge,
        ErrorSource::Roll => RoadColumn::RollRate,
        ErrorSource::Yaw => RoadColumn::YawRate,
        _ => return,
    };
    road.signals.column_mut(column).fill(0.0);
}
