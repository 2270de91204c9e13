//! Sensors and the recorder.

use super::effect::{Effect, Kind, parameter};

const IEEE_GYRO: &str = "IEEE Std 528; Titterton and Weston 2004";

macro_rules! instrument {
    ($component:literal, $effect:literal, $equation:literal, $when:literal, $experiment:literal, $starts:expr, $parameter:expr) => {
        Effect {
            effect: $effect,
            component: $component,
            kind: Kind::Instrument,
            equation: $equation,
            source: IEEE_GYRO,
            when: $when,
            experiment: $experiment,
            parameters: &[$parameter],
            starts: $starts,
        }
    };
}

/// Gyroscopes and the accelerometer.
pub(super) static EFFECTS: &[Effect] = &[
    instrument!(
        "hub_gyro",
        "scale",
        "reading = gain x rate",
        "in proportion to hub rate",
        "constant rates against the resolver",
        &[],
        parameter!("gain", "1", [0.2, 5.0], 0.02, Linear, sensors.hub_gyro.gain)
    ),
    instrument!(
        "hub_gyro",
        "bias",
        "reading = rate + bias",
        "always, constant",
        "stand still",
        &[],
        parameter!("bias", "rad/s", [-0.5, 0.5], 1e-3, Linear, sensors.hub_gyro.bias)
    ),
    instrument!(
        "hub_gyro",
        "bandwidth",
        "second-order lag of another natural frequency",
        "at the highest frequencies",
        "multisine to the highest frequency",
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
    instrument!(
        "hub_gyro",
        "delay",
        "reading late by a time",
        "in proportion to frequency",
        "multisine to the highest frequency, against the tachometer",
        &[&[0.002], &[0.006]],
        parameter!("delay", "s", [0.0, 0.05], 1e-3, Linear, sensors.hub_gyro.delay_s)
    ),
    instrument!(
        "hub_gyro",
        "g_sensitivity",
        "reading = rate + c a_p",
        "in proportion to heave",
        "heave with the hub locked",
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
    instrument!(
        "platform_gyro",
        "scale",
        "reading = gain x rate",
        "in proportion to platform rate",
        "platform pitch with the hub held on the platform",
        &[],
        parameter!("gain", "1", [0.2, 5.0], 0.02, Linear, sensors.platform_gyro.gain)
    ),
    instrument!(
        "platform_gyro",
        "bias",
        "reading = rate + bias",
        "always, constant",
        "stand still",
        &[],
        parameter!("bias", "rad/s", [-0.5, 0.5], 1e-3, Linear, sensors.platform_gyro.bias)
    ),
    instrument!(
        "platform_gyro",
        "bandwidth",
        "second-order lag of another natural frequency",
        "at the highest frequencies of the platform",
        "platform pitch to the highest frequency",
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
    instrument!(
        "platform_gyro",
        "delay",
        "reading late by a time",
        "in proportion to the platform's frequency",
        "platform pitch to the highest frequency",
        &[&[0.004], &[0.015]],
        parameter!("delay", "s", [0.0, 0.1], 2e-3, Linear, sensors.platform_gyro.delay_s)
    ),
    instrument!(
        "platform_gyro",
        "g_sensitivity",
        "reading = rate + c a_p",
        "in proportion to heave",
        "pure heave",
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
    instrument!(
        "platform_accelerometer",
        "scale",
        "reading = gain x heave",
        "in proportion to heave",
        "heave of known size",
        &[],
        parameter!("gain", "1", [0.2, 5.0], 0.02, Linear, sensors.platform_accelerometer.gain)
    ),
    instrument!(
        "platform_accelerometer",
        "bias",
        "reading = heave + bias",
        "always, constant",
        "stand still",
        &[],
        parameter!("bias", "m/s^2", [-5.0, 5.0], 0.02, Linear, sensors.platform_accelerometer.bias)
    ),
    instrument!(
        "platform_accelerometer",
        "lever_arm",
        "reading = heave + arm x pitch acceleration",
        "in proportion to pitch acceleration",
        "pure platform pitch",
        &[],
        parameter!("lever_arm", "m", [-5.0, 5.0], 0.1, Linear, sensors.accelerometer_lever_arm_m)
    ),
    Effect {
        effect: "channel_skew",
        component: "platform",
        kind: Kind::Instrument,
        equation: "the platform's channels are recorded late by a time",
        source: "two clocks, or one channel group sampled after the other",
        when: "in proportion to the platform's frequency",
        experiment: "platform pitch to the highest frequency",
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
