//! Free functions: what a machine does that no law of the library gives, as tables over one regime variable.

use super::sensing::FeedbackSignal;

/// A free function of one regime variable at one component: a torque, a factor on a parameter, or an error of a sensor.
///
/// Outside the range of its points it keeps its end values: nothing is known there.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LearnedElement {
    /// Name, for messages and drawings.
    pub name: String,
    /// The component at which it acts.
    pub place: LearnedPlace,
    /// Quantity that it adds to or multiplies.
    pub quantity: LearnedQuantity,
    /// The variable that it is a function of.
    pub variable: RegimeVariable,
    /// Interpolation between the points.
    pub interpolation: Interpolation,
    /// Values of the variable, rising, in SI units.
    pub points: Vec<f64>,
    /// Values of the function at the points: N m, factors, or the unit of a sensor.
    pub values: Vec<f64>,
    /// Half width of the 95 % band at each point, in the unit of the values; empty if it is not known.
    pub half_width: Vec<f64>,
    /// Share of the recorded samples nearest to each point; empty if it is not known.
    pub coverage: Vec<f64>,
    /// Quantity that the loop's sensor measures, whose unit a function at that sensor has; without meaning elsewhere.
    pub measured: FeedbackSignal,
}

impl LearnedElement {
    /// Returns the ends of the 95 % band at each point, in the unit of the values; the value itself if the band is not known.
    pub fn band(&self) -> Vec<[f64; 2]> {
        let ends = |(k, value): (usize, &f64)| {
            let half = self.half_width.get(k).copied().unwrap_or(0.0);
            [value - half, value + half]
        };
        self.values.iter().enumerate().map(ends).collect()
    }

    /// Returns the least and the largest value.
    pub fn value_range(&self) -> [f64; 2] {
        let fold = |start: f64, pick: fn(f64, f64) -> f64| self.values.iter().copied().fold(start, pick);
        [fold(f64::INFINITY, f64::min), fold(f64::NEG_INFINITY, f64::max)]
    }
}

/// The component at which a free function acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LearnedPlace {
    /// The joint between hub and platform. Its angle is the hub's on the platform.
    #[default]
    Pivot,
    /// The motor's shaft. Its angle is the shaft's on the platform.
    Motor,
    /// The transmission, at its output. Its angle is the wind-up.
    Gearbox,
    /// The sensor of the loop: a gyroscope on the hub, or what the loop has in its place. Its angle, and that of the two sensors below, is
    /// the hub's on the platform.
    LoopSensor,
    /// The tachometer on the motor.
    MotorTachometer,
    /// The resolver on the hub.
    HubResolver,
    /// The gyroscope on the platform.
    PlatformGyro,
    /// The accelerometer on the platform.
    PlatformAccelerometer,
}

impl LearnedPlace {
    /// Every place.
    pub const ALL: [Self; 8] = [
        Self::Pivot,
        Self::Motor,
        Self::Gearbox,
        Self::LoopSensor,
        Self::MotorTachometer,
        Self::HubResolver,
        Self::PlatformGyro,
        Self::PlatformAccelerometer,
    ];

    /// Returns whether it is a sensor, and no part of the mechanism.
    pub fn is_sensor(self) -> bool {
        !matches!(self, Self::Pivot | Self::Motor | Self::Gearbox)
    }

    /// Returns whether it is a sensor of the platform, which the mechanism does not move.
    pub fn is_platform_sensor(self) -> bool {
        matches!(self, Self::PlatformGyro | Self::PlatformAccelerometer)
    }
}

/// Quantity that a free function adds to or multiplies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LearnedQuantity {
    /// An added torque, N m: on the hub (pivot), on the shaft (motor), or on the hub with its reaction on the motor (gearbox). It is
    /// positive where it raises the hub.
    #[default]
    Torque,
    /// A factor on the level of dry friction (pivot, motor).
    FrictionLevel,
    /// A factor on the stiffness of the position spring (pivot) or of the mesh (gearbox).
    Stiffness,
    /// A factor on the viscous friction (pivot, motor) or on the damping of the mesh (gearbox).
    Damping,
    /// A factor on the torque constant (motor).
    TorqueConstant,
    /// An error that is added to the reading of a sensor after its dynamics, gain and bias, and before its delay and noise.
    Error,
}

/// The variable of a free function; of the joint at which the function acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RegimeVariable {
    /// Angle, rad.
    #[default]
    Angle,
    /// Angle modulo one turn, rad: the function repeats, and its points lie from 0 to below 2 pi.
    Turn,
    /// Rate, rad/s.
    Rate,
    /// Torque that the joint carries, N m: of the mesh at the output, or over the ratio at the motor.
    Load,
    /// Drive of the amplifier after limit, dead zone and map, V.
    Control,
    /// Time since the start, s.
    Time,
    /// What a sensor would read without the error, in its unit.
    Reading,
}

/// Interpolation of a free function between its points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Interpolation {
    /// A cubic spline with two continuous derivatives, without curvature at its ends.
    #[default]
    Cubic,
    /// Straight lines.
    Linear,
}

impl LearnedQuantity {
    /// Returns whether it multiplies a parameter, so that 1 changes nothing.
    pub fn is_factor(self) -> bool {
        !matches!(self, Self::Torque | Self::Error)
    }

    /// Returns the value that changes nothing.
    pub fn neutral(self) -> f64 {
        if self.is_factor() { 1.0 } else { 0.0 }
    }
}

impl LearnedElement {
    /// Returns an element that changes nothing yet, with its points evenly over a range.
    pub fn neutral(
        place: LearnedPlace,
        quantity: LearnedQuantity,
        variable: RegimeVariable,
        points: Vec<f64>,
    ) -> Self {
        let values = vec![quantity.neutral(); points.len()];
        Self { place, quantity, variable, points, values, ..Self::default() }
    }

    /// Returns the unit of its values on a turning axis; empty for a factor.
    pub fn value_unit(&self) -> &'static str {
        match self.quantity {
            LearnedQuantity::Torque => "N m",
            LearnedQuantity::Error => self.reading_unit(),
            _ => "",
        }
    }

    /// Returns the unit of its variable on a turning axis.
    pub fn variable_unit(&self) -> &'static str {
        match self.variable {
            RegimeVariable::Angle | RegimeVariable::Turn => "rad",
            RegimeVariable::Rate => "rad/s",
            RegimeVariable::Load => "N m",
            RegimeVariable::Control => "V",
            RegimeVariable::Time => "s",
            RegimeVariable::Reading => self.reading_unit(),
        }
    }

    /// Returns the unit of what the sensor at its place reads; empty if there is none.
    fn reading_unit(&self) -> &'static str {
        match self.place {
            LearnedPlace::Pivot | LearnedPlace::Motor | LearnedPlace::Gearbox => "",
            LearnedPlace::HubResolver => "rad",
            LearnedPlace::MotorTachometer | LearnedPlace::PlatformGyro => "rad/s",
            LearnedPlace::PlatformAccelerometer => "m/s^2",
            LearnedPlace::LoopSensor => match self.measured {
                FeedbackSignal::HubRate | FeedbackSignal::RelativeRate | FeedbackSignal::MotorRate => "rad/s",
                FeedbackSignal::HubPosition | FeedbackSignal::MotorPosition => "rad",
                FeedbackSignal::Torque => "N m",
                FeedbackSignal::Current => "A",
            },
        }
    }
}
