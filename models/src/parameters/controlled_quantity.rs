//! The quantity that a loop controls: the quantity, its unit, and its names in tables and in results.
//!
//! Figures, signals and readings were named for a loop of the hub's rate. A loop of something else has them of its own quantity, with
//! the names from here.

use super::{AxisKind, FeedbackSignal, Parameters};

/// Kind of quantity that a loop controls.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum QuantityKind {
    /// A rate: rad/s, or m/s on a sliding axis.
    #[default]
    Rate,
    /// An angle, rad, or a position, m.
    Position,
    /// The effort that the transmission passes: a torque, N m, or a force, N.
    Effort,
    /// The motor's current, A.
    Current,
}

/// Input quantity of the drive, from which it makes its torque or force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DriveQuantity {
    /// The motor's current, A.
    #[default]
    Current,
    /// The load pressure of a hydraulic cylinder, MPa.
    Pressure,
}

/// The quantity that a loop controls, on the axis that it moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ControlledQuantity {
    /// Kind.
    pub kind: QuantityKind,
    /// The motion of the axis: it turns or slides.
    pub axis: AxisKind,
    /// Input quantity of the drive.
    pub drive: DriveQuantity,
}

impl Parameters {
    /// Returns the quantity that the loop of this machine controls: what its sensor measures.
    pub fn controlled_quantity(&self) -> ControlledQuantity {
        let drive = if self.cylinder.is_some() { DriveQuantity::Pressure } else { DriveQuantity::Current };
        ControlledQuantity { kind: self.sensors.measured.kind(), axis: self.axis, drive }
    }
}

impl FeedbackSignal {
    /// Returns the kind of the measured quantity.
    pub fn kind(self) -> QuantityKind {
        match self {
            Self::HubRate | Self::RelativeRate | Self::MotorRate => QuantityKind::Rate,
            Self::HubPosition | Self::MotorPosition => QuantityKind::Position,
            Self::Torque => QuantityKind::Effort,
            Self::Current => QuantityKind::Current,
        }
    }
}

/// The names of a quantity.
struct Words {
    /// In a sentence, for example "hub angle".
    name: &'static str,
    /// Alone, for example "angle".
    short: &'static str,
    unit: &'static str,
    /// A thousandth of the unit.
    milli_unit: &'static str,
    /// The unit at the end of a key.
    suffix: &'static str,
    /// The part of a key before the suffix, for example "hub_angle".
    signal: &'static str,
    /// The word for the hub in the key of a figure, for example "hub" in `hub_rms_rad`.
    stem: &'static str,
}

const fn words_of(names: [&'static str; 7]) -> Words {
    let [name, short, unit, milli_unit, suffix, signal, stem] = names;
    Words { name, short, unit, milli_unit, suffix, signal, stem }
}

const RATE: Words = words_of(["hub rate", "rate", "rad/s", "mrad/s", "rad_s", "hub_rate", "hub"]);
const SPEED: Words = words_of(["slide speed", "speed", "m/s", "mm/s", "m_s", "slide_speed", "slide"]);
const ANGLE: Words = words_of(["hub angle", "angle", "rad", "mrad", "rad", "hub_angle", "hub"]);
const PLACE: Words = words_of(["slide position", "position", "m", "mm", "m", "slide_position", "slide"]);
const TORQUE: Words =
    words_of(["transmitted torque", "torque", "N m", "mN m", "nm", "transmitted_torque", "torque"]);
const FORCE: Words = words_of(["transmitted force", "force", "N", "mN", "n", "transmitted_force", "force"]);
const CURRENT: Words =
    words_of(["controlled current", "current", "A", "mA", "a", "controlled_current", "controlled_current"]);

impl ControlledQuantity {
    /// The rate of a turning axis.
    pub const RATE: Self =
        Self { kind: QuantityKind::Rate, axis: AxisKind::Rotary, drive: DriveQuantity::Current };

    fn words(self) -> &'static Words {
        match (self.kind, self.axis) {
            (QuantityKind::Rate, AxisKind::Rotary) => &RATE,
            (QuantityKind::Rate, AxisKind::Linear) => &SPEED,
            (QuantityKind::Position, AxisKind::Rotary) => &ANGLE,
            (QuantityKind::Position, AxisKind::Linear) => &PLACE,
            (QuantityKind::Effort, AxisKind::Rotary) => &TORQUE,
            (QuantityKind::Effort, AxisKind::Linear) => &FORCE,
            (QuantityKind::Current, _) => &CURRENT,
        }
    }

    /// Returns the quantity with a unit; a rate if no loop controls one of it.
    pub fn of_unit(unit: &str) -> Self {
        Self::all().find(|quantity| quantity.unit() == unit).unwrap_or_default()
    }

    /// Returns every quantity on every axis.
    fn all() -> impl Iterator<Item = Self> {
        let kinds = [QuantityKind::Rate, QuantityKind::Position, QuantityKind::Effort, QuantityKind::Current];
        kinds.into_iter().flat_map(|kind| {
            [AxisKind::Rotary, AxisKind::Linear].map(|axis| Self { kind, axis, ..Self::RATE })
        })
    }

    /// Returns the rate on the same axis: what the inner loop of a cascade controls.
    pub fn rate(self) -> Self {
        Self { kind: QuantityKind::Rate, ..self }
    }

    /// Returns what hub and tip of the plant move by: positions in a loop of position, rates in every other.
    pub fn motion(self) -> Self {
        if self.kind == QuantityKind::Position { self } else { self.rate() }
    }

    /// Returns what the drive makes its torque or force of, in a sentence: "current" or "load pressure".
    pub fn drive_name(self) -> &'static str {
        match self.drive {
            DriveQuantity::Current => "current",
            DriveQuantity::Pressure => "load pressure",
        }
    }

    /// Returns the unit of what the drive makes its torque or force of.
    pub fn drive_unit(self) -> &'static str {
        match self.drive {
            DriveQuantity::Current => "A",
            DriveQuantity::Pressure => "MPa",
        }
    }

    /// Returns the quantity in a sentence, for example "hub rate" or "transmitted torque".
    pub fn name(self) -> &'static str {
        self.words().name
    }

    /// Returns the quantity without the part of the machine, for example "rate" or "torque".
    pub fn short_name(self) -> &'static str {
        self.words().short
    }

    /// Returns the tip's motion in a sentence, for example "tip rate": a loop of torque or current has no quantity of the tip's.
    pub fn tip_name(self) -> String {
        format!("tip {}", self.motion().words().short)
    }

    /// Returns the unit, for example "rad/s".
    pub fn unit(self) -> &'static str {
        self.words().unit
    }

    /// Returns a thousandth of the unit, for example "mrad/s".
    pub fn milli_unit(self) -> &'static str {
        self.words().milli_unit
    }

    /// Returns the unit of a gain from a reading to the control, for example "V s/rad" or "V/m".
    pub fn gain_unit(self) -> &'static str {
        match self.unit() {
            "rad/s" => "V s/rad",
            "m/s" => "V s/m",
            "rad" => "V/rad",
            "m" => "V/m",
            "N m" => "V/(N m)",
            "N" => "V/N",
            _ => "V/A",
        }
    }

    /// Returns the unit of the spectral density of white noise in a reading, for example "(rad/s)^2 s".
    pub fn density_unit(self) -> &'static str {
        match self.unit() {
            "rad/s" => "(rad/s)^2 s",
            "m/s" => "(m/s)^2 s",
            "rad" => "rad^2 s",
            "m" => "m^2 s",
            "N m" => "(N m)^2 s",
            "N" => "N^2 s",
            _ => "A^2 s",
        }
    }

    /// Returns the unit of the tip's motion.
    pub fn tip_unit(self) -> &'static str {
        self.motion().words().unit
    }

    /// Returns the name of the motion of the base that the axis feels as a rate: the pitch rate, or the speed along a slide.
    pub fn base_rate_name(self) -> &'static str {
        match self.axis {
            AxisKind::Rotary => "pitch rate",
            AxisKind::Linear => "speed of the base",
        }
    }

    /// Returns the unit of [`Self::base_rate_name`].
    pub fn base_rate_unit(self) -> &'static str {
        self.axis.unit("rad/s")
    }

    /// Returns the unit of the axis' travel.
    pub fn travel_unit(self) -> &'static str {
        Self { kind: QuantityKind::Position, ..self }.words().unit
    }

    /// Returns the unit as it stands at the end of a key, for example `rad_s`.
    pub fn suffix(self) -> &'static str {
        self.words().suffix
    }

    /// Returns the key of the controlled signal with its unit, for example `hub_rate_rad_s` or `transmitted_torque_nm`.
    pub fn signal(self) -> String {
        format!("{}_{}", self.words().signal, self.words().suffix)
    }

    /// Returns the key of the tip's motion with its unit, for example `tip_rate_rad_s`.
    pub fn tip_signal(self) -> String {
        let words = self.motion().words();
        format!("tip_{}_{}", words.short, words.suffix)
    }

    /// Returns a key that ends in this quantity's unit, for example `demand_nm` of "demand".
    pub fn key_of(self, stem: &str) -> String {
        format!("{stem}_{}", self.words().suffix)
    }

    /// Returns the name of a signal of a rate loop as this loop has it; every other name as it is.
    pub fn named_signal(self, of_rate_loop: &str) -> String {
        let short = self.words().short;
        let own = |stem: String| self.key_of(&stem);
        match of_rate_loop {
            "demand_rad_s" => own("demand".to_owned()),
            "filtered_demand_rad_s" => own("filtered_demand".to_owned()),
            "rate_error_rad_s" => own(format!("{short}_error")),
            "measured_rate_rad_s" => own(format!("measured_{short}")),
            "expected_rate_rad_s" => own(format!("expected_{short}")),
            "hub_rate_rad_s" => self.signal(),
            "tip_rate_rad_s" => self.tip_signal(),
            "current_a" if self.drive == DriveQuantity::Pressure => "load_pressure_mpa".to_owned(),
            other => other.to_owned(),
        }
    }

    /// Returns the end of a figure's key as this loop has it: `hub_rms_rad_s` in a loop of rate is `torque_rms_nm` in one of torque.
    pub fn named_figure(self, of_rate_loop: &str) -> String {
        let (own, tip) = (self.words(), self.motion().words());
        let travel = Self { kind: QuantityKind::Position, ..self }.words().suffix;
        let ends: [(&str, &dyn Fn() -> String); 10] = [
            ("limit_cycle_peak_rad_s", &|| format!("limit_cycle_peak_{}", own.suffix)),
            ("hub_rms_rad_s", &|| format!("{}_rms_{}", own.stem, own.suffix)),
            ("hub_peak_rad_s", &|| format!("{}_peak_{}", own.stem, own.suffix)),
            ("tip_rms_rad_s", &|| format!("tip_rms_{}", tip.suffix)),
            ("tip_peak_rad_s", &|| format!("tip_peak_{}", tip.suffix)),
            ("error_rms_rad_s", &|| format!("error_rms_{}", own.suffix)),
            ("error_peak_rad_s", &|| format!("error_peak_{}", own.suffix)),
            ("travel_peak_rad", &|| format!("travel_peak_{travel}")),
            ("rest_drift_rad", &|| format!("rest_drift_{travel}")),
            ("current_peak_a", &|| match self.drive {
                DriveQuantity::Current => "current_peak_a".to_owned(),
                DriveQuantity::Pressure => "load_pressure_peak_mpa".to_owned(),
            }),
        ];
        for (rate, name) in ends {
            if let Some(start) = of_rate_loop.strip_suffix(rate) {
                return format!("{start}{}", name());
            }
        }
        of_rate_loop.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loop_of_rate_on_a_turning_axis_keeps_every_name() {
        let rate = ControlledQuantity::RATE;
        assert_eq!(rate, ControlledQuantity::default());
        for name in ["demand_rad_s", "hub_rate_rad_s", "tip_rate_rad_s", "rate_error_rad_s", "control_v"] {
            assert_eq!(rate.named_signal(name), name);
        }
        for key in ["linear_pitch_feedback_hub_rms_rad_s", "rest_drift_rad", "x_tip_peak_rad_s"] {
            assert_eq!(rate.named_figure(key), key);
        }
    }

    #[test]
    fn a_unit_finds_its_quantity() {
        for quantity in ControlledQuantity::all().filter(|quantity| quantity.kind != QuantityKind::Current) {
            assert_eq!(ControlledQuantity::of_unit(quantity.unit()), quantity);
        }
        assert_eq!(ControlledQuantity::of_unit("V"), ControlledQuantity::RATE);
    }

    #[test]
    fn no_name_of_another_loop_speaks_of_a_rate_of_the_hub() {
        for quantity in ControlledQuantity::all().filter(|quantity| *quantity != ControlledQuantity::RATE) {
            for name in [quantity.named_signal("hub_rate_rad_s"), quantity.named_figure("a_hub_rms_rad_s")] {
                assert!(!name.contains("rate") && !name.ends_with("rad_s"), "{name}");
            }
            let keys = ["a_hub_rms_rad_s", "a_tip_rms_rad_s", "a_current_peak_a", "a_travel_peak_rad"];
            let mut own = keys.map(|key| quantity.named_figure(key)).to_vec();
            own.sort();
            own.dedup();
            assert_eq!(own.len(), keys.len(), "{own:?}");
        }
        let force = ControlledQuantity {
            kind: QuantityKind::Effort,
            axis: AxisKind::Linear,
            ..ControlledQuantity::RATE
        };
        assert_eq!((force.signal().as_str(), force.unit()), ("transmitted_force_n", "N"));
        assert_eq!(force.tip_signal(), "tip_speed_m_s");
    }
}
