//! Names of components and effects: one list of each, with the names that results carry.

/// Defines an enum whose variants have a name in results.
macro_rules! named {
    ($(#[$doc:meta])* $type:ident { $($(#[$variant_doc:meta])* $variant:ident = $name:literal,)+ }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum $type {
            $($(#[$variant_doc])* $variant,)+
        }

        impl $type {
            /// Every variant, in the order of the definition.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)+];

            /// Returns the name in results.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)+
                }
            }

            /// Finds the variant with a name; returns `None` if there is none.
            pub fn from_name(name: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|one| one.name() == name)
            }
        }

        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl serde::Serialize for $type {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(self.name())
            }
        }
    };
}
pub(crate) use named;

named! {
    /// A component of the mechanism, of its sensors, or of the recorder.
    Component {
        /// The structure on the hub side: masses, springs to the platform, the flexible beam.
        Structure = "structure",
        /// The joint about which the hub turns.
        Pivot = "pivot",
        /// The gearbox.
        Gearbox = "gearbox",
        /// The motor.
        Motor = "motor",
        /// The power amplifier.
        Amplifier = "amplifier",
        /// The control signal between controller and amplifier.
        Control = "control",
        /// The gyroscope on the hub.
        HubGyro = "hub_gyro",
        /// The gyroscope on the platform.
        PlatformGyro = "platform_gyro",
        /// The accelerometer on the platform.
        PlatformAccelerometer = "platform_accelerometer",
        /// The platform's channels together.
        Platform = "platform",
        /// The demand signal.
        Demand = "demand",
        /// The tachometer on the motor.
        MotorTachometer = "motor_tachometer",
        /// The resolver on the hub.
        HubResolver = "hub_resolver",
        /// A component that could not be located.
        Unknown = "unknown",
    }
}

named! {
    /// The name of a finding: an effect of the library, a fault of an instrument, or something unknown.
    EffectName {
        /// First moment of mass along the beam.
        OutOfBalance = "out_of_balance",
        /// First moment of mass above the axis.
        VerticalOffset = "vertical_offset",
        /// Moment of inertia.
        Inertia = "inertia",
        /// A spring between hub and platform.
        PositionStiffness = "position_stiffness",
        /// A hose between hub and platform that yields.
        Hysteresis = "hysteresis",
        /// A spring or gas strut that holds the out-of-balance.
        Equilibrator = "equilibrator",
        /// Stops at the ends of the travel.
        EndStops = "end_stops",
        /// Recoil of what the machine fires.
        Recoil = "recoil",
        /// Current that the drive bears for ever.
        ContinuousCurrent = "continuous_current",
        /// The first bending mode of the beam.
        FlexibleMode = "flexible_mode",
        /// Coulomb friction level.
        Coulomb = "coulomb",
        /// Viscous friction.
        Viscous = "viscous",
        /// Friction that falls with the rate near zero.
        Stribeck = "stribeck",
        /// Friction that differs between the two directions.
        AsymmetricFriction = "asymmetric_friction",
        /// Friction that repeats with the angle.
        PositionDependentFriction = "position_dependent_friction",
        /// Stiffness of the friction below breakaway.
        PreslidingStiffness = "presliding_stiffness",
        /// Drag with the square of the rate.
        QuadraticDrag = "quadratic_drag",
        /// Friction that grows with the torque carried.
        LoadDependentFriction = "load_dependent_friction",
        /// Friction that drifts with temperature.
        WarmUp = "warm_up",
        /// Damping.
        Damping = "damping",
        /// Cogging torque of the motor.
        Cogging = "cogging",
        /// Torque constant that repeats with the motor's angle.
        TorqueRipple = "torque_ripple",
        /// Torque constant of the motor.
        TorqueConstant = "torque_constant",
        /// Voltage that the motor's speed induces.
        BackEmf = "back_emf",
        /// Resistance of the winding.
        Resistance = "resistance",
        /// Gap between the teeth.
        Backlash = "backlash",
        /// Stiffness.
        Stiffness = "stiffness",
        /// Torque of the mesh that repeats with the motor's angle.
        MeshRipple = "mesh_ripple",
        /// Loss in the mesh.
        MeshEfficiency = "mesh_efficiency",
        /// Gain of the amplifier at small inputs.
        GainCurve = "gain_curve",
        /// Input below which the amplifier gives nothing.
        DeadZone = "dead_zone",
        /// Largest current of the amplifier.
        CurrentLimit = "current_limit",
        /// Bandwidth.
        Bandwidth = "bandwidth",
        /// Delay.
        Delay = "delay",
        /// Gain of a sensor, or of a column as written.
        Scale = "scale",
        /// Constant added to a reading.
        Bias = "bias",
        /// Sensitivity of a gyroscope to acceleration.
        GSensitivity = "g_sensitivity",
        /// Lever arm of the accelerometer.
        LeverArm = "lever_arm",
        /// Axis of a gyroscope that is not where it should be, or sensitivity to rates about other axes.
        Misalignment = "misalignment",
        /// Axis of an accelerometer that is turned about the elevation axis.
        Tilt = "tilt",
        /// Delay of all the platform's channels together.
        ChannelSkew = "channel_skew",
        /// Clock of a column that is off by a time.
        ClockOffset = "clock_offset",
        /// Clock of a column that runs fast or slow.
        ClockDrift = "clock_drift",
        /// Readings that stand still.
        Stuck = "stuck",
        /// Readings that are cut off at a value.
        Clipped = "clipped",
        /// Coarse quantisation.
        Quantisation = "quantisation",
        /// Lower sampling rate than the file's.
        SampleRate = "sample_rate",
        /// Columns in each other's place.
        Exchanged = "exchanged",
        /// None of the known effects.
        Unknown = "unknown",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_distinct_and_found_again() {
        assert!(Component::ALL.iter().all(|c| Component::from_name(c.name()) == Some(*c)));
        assert!(EffectName::ALL.iter().all(|e| EffectName::from_name(e.name()) == Some(*e)));
    }
}
