//! Sensors and the recorder.

use super::effect::{Effect, EffectKind, parameter};
use super::names::{Component, EffectName};

macro_rules! instrument {
    ($component:ident, $effect:ident, $starts:expr, $parameter:expr) => {
        Effect {
            effect: EffectName::$effect,
            component: Component::$component,
            kind: EffectKind::Instrument,
            parameters: &[$parameter],
            starts: $starts,
        }
    };
}

/// A gyroscope that reads rate + c_r w_f + c_y w_u, with the rates about the forward and upward axes of what carries it.
macro_rules! misalignment {
    ($component:ident, sensors.$sensor:ident) => {
        Effect {
            effect: EffectName::Misalignment,
            component: Component::$component,
            kind: EffectKind::Instrument,
            parameters: &[
                parameter!(
                    "roll_sensitivity",
                    "rad",
                    [-0.5, 0.5],
                    0.01,
                    Linear,
                    sensors.$sensor.alignment.roll_sensitivity
                ),
                parameter!(
                    "yaw_sensitivity",
                    "rad",
                    [-0.5, 0.5],
                    0.01,
                    Linear,
                    sensors.$sensor.alignment.yaw_sensitivity
                ),
            ],
            starts: &[],
        }
    };
}

/// Gyroscopes and the accelerometer (IEEE Std 528; Titterton and Weston 2004).
pub(super) static EFFECTS: &[Effect] = &[
    // reading = gain x rate
    instrument!(
        HubGyro,
        Scale,
        &[],
        parameter!("gain", "1", [0.2, 5.0], 0.02, Linear, sensors.hub_gyro.gain)
    ),
    // reading = rate + bias
    instrument!(
        HubGyro,
        Bias,
        &[],
        parameter!("bias", "rad/s", [-0.5, 0.5], 1e-3, Linear, sensors.hub_gyro.bias)
    ),
    // reading = torque + bias: a typical one is a thousandth of the torque of a drive of the usual size
    instrument!(
        HubGyro,
        Bias,
        &[],
        parameter!("bias", "N m", [-300.0, 300.0], 0.6, Linear, sensors.hub_gyro.bias)
    ),
    // reading = current + bias
    instrument!(
        HubGyro,
        Bias,
        &[],
        parameter!("bias", "A", [-20.0, 20.0], 1e-2, Linear, sensors.hub_gyro.bias)
    ),
    // second-order lag of another natural frequency
    instrument!(
        HubGyro,
        Bandwidth,
        &[&[377.0], &[120.0]],
        parameter!(
            "natural_frequency",
            "rad/s",
            [20.0, 1e4],
            0.2,
            Log,
            sensors.hub_gyro.natural_frequency_rad_s
        )
    ),
    // reading late by a time
    instrument!(
        HubGyro,
        Delay,
        &[&[0.002], &[0.006]],
        parameter!("delay", "s", [0.0, 0.05], 1e-3, Linear, sensors.hub_gyro.delay_s)
    ),
    // reading = rate + c a_p
    instrument!(
        HubGyro,
        GSensitivity,
        &[],
        parameter!(
            "g_sensitivity",
            "(rad/s)/(m/s^2)",
            [-0.1, 0.1],
            3e-4,
            Linear,
            sensors.hub_gyro.g_sensitivity
        )
    ),
    // reading = gain x rate
    instrument!(
        PlatformGyro,
        Scale,
        &[],
        parameter!("gain", "1", [0.2, 5.0], 0.02, Linear, sensors.platform_gyro.gain)
    ),
    // reading = rate + bias
    instrument!(
        PlatformGyro,
        Bias,
        &[],
        parameter!("bias", "rad/s", [-0.5, 0.5], 1e-3, Linear, sensors.platform_gyro.bias)
    ),
    // second-order lag of another natural frequency
    instrument!(
        PlatformGyro,
        Bandwidth,
        &[&[377.0], &[60.0]],
        parameter!(
            "natural_frequency",
            "rad/s",
            [10.0, 1e4],
            0.2,
            Log,
            sensors.platform_gyro.natural_frequency_rad_s
        )
    ),
    // reading late by a time
    instrument!(
        PlatformGyro,
        Delay,
        &[&[0.004], &[0.015]],
        parameter!("delay", "s", [0.0, 0.1], 2e-3, Linear, sensors.platform_gyro.delay_s)
    ),
    // reading = rate + c a_p
    instrument!(
        PlatformGyro,
        GSensitivity,
        &[],
        parameter!(
            "g_sensitivity",
            "(rad/s)/(m/s^2)",
            [-0.1, 0.1],
            3e-4,
            Linear,
            sensors.platform_gyro.g_sensitivity
        )
    ),
    // reading = gain x heave
    instrument!(
        PlatformAccelerometer,
        Scale,
        &[],
        parameter!("gain", "1", [0.2, 5.0], 0.02, Linear, sensors.platform_accelerometer.gain)
    ),
    // reading = heave + bias
    instrument!(
        PlatformAccelerometer,
        Bias,
        &[],
        parameter!("bias", "m/s^2", [-5.0, 5.0], 0.02, Linear, sensors.platform_accelerometer.bias)
    ),
    // reading = heave + arm x pitch acceleration
    instrument!(
        PlatformAccelerometer,
        LeverArm,
        &[],
        parameter!("lever_arm", "m", [-5.0, 5.0], 0.1, Linear, sensors.accelerometer_lever_arm_m)
    ),
    misalignment!(HubGyro, sensors.hub_gyro),
    misalignment!(PlatformGyro, sensors.platform_gyro),
    // reading = heave cos(tilt) - surge sin(tilt) + g (cos(tilt) - 1)
    instrument!(
        PlatformAccelerometer,
        Tilt,
        &[],
        parameter!(
            "tilt",
            "rad",
            [-0.5, 0.5],
            0.01,
            Linear,
            sensors.platform_accelerometer.alignment.tilt_rad
        )
    ),
    Effect {
        // the platform's channels are recorded late by a time (two clocks, or one channel group sampled after the other)
        effect: EffectName::ChannelSkew,
        component: Component::Platform,
        kind: EffectKind::Instrument,
        parameters: &[parameter!(
            "skew",
            "s",
            [0.0, 0.1],
            2e-3,
            Linear,
            get | p | p.sensors.platform_gyro.delay_s,
            set | p,
            v | {
                p.sensors.platform_gyro.delay_s = v;
                p.sensors.platform_accelerometer.delay_s = v;
            }
        )],
        starts: &[&[0.004], &[0.015]],
    },
];
