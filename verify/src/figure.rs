//! The figures that a verification measures: what each is called, its unit, and what it means.

use std::fmt;

use counterpoise_models::ControlledQuantity;

use crate::Error;
use crate::spelling::nearest_key;

/// Plant on which a figure is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Model {
    /// The plant linearised about its operating point, sampled exactly.
    Linear,
    /// The simulator: friction, backlash, limits, converters, sensor noise.
    Nonlinear,
}

/// Motion of the platform.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Source {
    /// Heave alone.
    Heave,
    /// Pitch alone.
    Pitch,
    /// Heave and pitch together.
    Both,
    /// A recorded or synthesised road: heave and pitch as they come.
    Road,
}

/// Part of the controller that acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Arrangement {
    /// Only the constant voltage that holds the out-of-balance: without it the mechanism would fall.
    Uncontrolled,
    /// The feedback, without feedforward.
    Feedback,
    /// The feedback plus all feedforwards: the controller as exported.
    Compensated,
}

/// All arrangements, from least to most control.
pub const ARRANGEMENTS: [Arrangement; 3] =
    [Arrangement::Uncontrolled, Arrangement::Feedback, Arrangement::Compensated];

/// A figure of the loop broken at the plant's input, of the discrete controller with the sampled plant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum LoopFigure {
    /// Smallest factor, in dB, by which the gain may grow.
    GainMargin,
    /// Smallest factor, in dB, by which the gain may shrink (infinite if any reduction is stable).
    GainReductionMargin,
    /// Smallest phase lag, in degrees, that destabilises.
    PhaseMargin,
    /// Smallest additional delay that destabilises.
    DelayMargin,
    /// Radius of the disk of simultaneous gain and phase changes that the loop withstands.
    DiskMargin,
    /// Largest |1 / (1 + L)|.
    MaxSensitivity,
    /// Largest |L / (1 + L)|.
    MaxComplementary,
    /// Largest modulus of a pole of the closed loop.
    PoleRadius,
    /// Highest frequency at which |L| crosses 1, Hz.
    Crossover,
}

/// A figure of the response to a step of the demanded hub rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum StepFigure {
    /// Largest excess over the demand, percent of the demand.
    Overshoot,
    /// Time from 10 % to 90 % of the demand.
    RiseTime,
    /// Time of the largest value, from the step.
    PeakTime,
    /// Time after which the response stays within 5 % of the demand.
    SettlingTime,
    /// |demand - mean over the last tenth|, percent of the demand.
    SteadyStateError,
    /// Largest modulus of the control.
    ControlPeak,
}

/// A figure of the response to a triangle of the demanded hub rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum TriangleFigure {
    /// RMS of demand less hub rate.
    ErrorRms,
    /// Peak of demand less hub rate: friction shows at the reversals.
    ErrorPeak,
    /// Peak of the control.
    ControlPeak,
}

/// Quantity that is measured while the platform moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Quantity {
    /// RMS of the hub's inertial rate.
    HubRms,
    /// Peak of the hub's inertial rate.
    HubPeak,
    /// RMS of the tip's inertial rate.
    TipRms,
    /// Peak of the tip's inertial rate.
    TipPeak,
    /// RMS of the control about its mean.
    ControlRms,
    /// Peak of the control.
    ControlPeak,
    /// Peak of the motor current.
    CurrentPeak,
    /// Largest hub angle, relative to the platform, from where it started.
    TravelPeak,
    /// Fraction of the time during which the gear teeth are apart.
    GearOpen,
    /// Disturbance rejection ratio at the procedure's own motion, dB: RMS of the hub's rate over that of the platform's pitch rate, or
    /// of its acceleration if it heaves alone.
    Rejection,
}

/// A figure of the nonlinear loop at rest: no demand, platform still.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum RestFigure {
    /// RMS hub rate over the second half: a limit cycle shows here.
    HubRms,
    /// Hub rotation over the second half: creep of friction that is stuck.
    Drift,
}

/// A figure of the stability certificate: the worst over all cases of the schedule and all regimes of friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CertificateFigure {
    /// Gain margin of the regime nearest to instability, dB; 0 if it is unstable.
    GainMargin,
    /// Largest sensitivity of the regime nearest to instability; infinite if it is unstable.
    MaxSensitivity,
    /// Amplitude of the limit cycle that stays: 0 without one, infinite if the motion grows.
    LimitCyclePeak,
}

/// A figure of the line of sight under the platform's motion: the road, or heave and pitch together, with the whole controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SightFigure {
    /// RMS of the hub's angle about its mean.
    Hub,
    /// RMS of the hub's angle about its mean in each exposure.
    HubJitter,
    /// RMS of the tip's angle about its mean.
    Tip,
    /// RMS of the tip's angle about its mean in each exposure.
    TipJitter,
    /// RMS of the tip's angle against the hub's, about its mean.
    Bending,
    /// Share of the time during which the hub's error is within the coincidence window.
    Coincidence,
    /// Mean time from the trigger to the release of a shot.
    Wait,
    /// Probability that a shot hits.
    Hit,
    /// Share of an image's modulation that motion of the hub takes.
    HubTransferLoss,
    /// Share of an image's modulation that motion of the tip takes.
    TipTransferLoss,
}

impl SightFigure {
    /// Every figure.
    pub const ALL: [Self; 10] = [
        Self::Hub,
        Self::HubJitter,
        Self::Tip,
        Self::TipJitter,
        Self::Bending,
        Self::Coincidence,
        Self::Wait,
        Self::Hit,
        Self::HubTransferLoss,
        Self::TipTransferLoss,
    ];
    /// Figures that are an RMS of an angle, which an error budget divides.
    pub const ANGLES: [Self; 5] = [Self::Hub, Self::HubJitter, Self::Tip, Self::TipJitter, Self::Bending];
}

/// Anything that a requirement can limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PerformanceFigure {
    /// Margins and poles of the loop.
    Loop(LoopFigure),
    /// A step of the demand.
    Step(Model, StepFigure),
    /// A triangle of the demand.
    Triangle(Model, TriangleFigure),
    /// The platform in motion.
    Disturbance(Model, Source, Arrangement, Quantity),
    /// Disturbance rejection ratio of the linear loop at one frequency, dB: hub rate over platform motion. In pitch both are
    /// rates; in heave hub rate over acceleration, rad/s per m/s^2.
    Rejection {
        /// Heave or pitch.
        source: Source,
        /// Part of the controller that acts.
        arrangement: Arrangement,
        /// At which frequency, Hz.
        frequency_hz: f64,
    },
    /// Nothing happens.
    Rest(RestFigure),
    /// The line of sight.
    Sight(SightFigure),
    /// The stability certificate of the exported controller.
    Certificate(CertificateFigure),
}

/// Key and unit of a figure, or of a part of one.
#[derive(Debug, Clone, Copy, Default)]
struct Words {
    /// In a project file.
    key: &'static str,
    /// Unit; empty for a pure number and for a part without one.
    unit: &'static str,
}

/// A row of a table: a value with its key and unit.
struct Row<K> {
    of: K,
    words: Words,
}

impl<K> Row<K> {
    const fn new(of: K, key: &'static str, unit: &'static str) -> Self {
        Self { of, words: Words { key, unit } }
    }
}

const MODELS: [Row<Model>; 2] =
    [Row::new(Model::Linear, "linear", ""), Row::new(Model::Nonlinear, "nonlinear", "")];

const SOURCES: [Row<Source>; 4] = [
    Row::new(Source::Heave, "heave", ""),
    Row::new(Source::Pitch, "pitch", ""),
    Row::new(Source::Both, "both", ""),
    Row::new(Source::Road, "road", ""),
];

const ARRANGEMENT_NAMES: [Row<Arrangement>; 3] = [
    Row::new(Arrangement::Uncontrolled, "uncontrolled", ""),
    Row::new(Arrangement::Feedback, "feedback", ""),
    Row::new(Arrangement::Compensated, "compensated", ""),
];

const LOOP: [Row<LoopFigure>; 9] = [
    Row::new(LoopFigure::GainMargin, "gain_margin_db", "dB"),
    Row::new(LoopFigure::GainReductionMargin, "gain_reduction_margin_db", "dB"),
    Row::new(LoopFigure::PhaseMargin, "phase_margin_deg", "deg"),
    Row::new(LoopFigure::DelayMargin, "delay_margin_s", "s"),
    Row::new(LoopFigure::DiskMargin, "disk_margin", ""),
    Row::new(LoopFigure::MaxSensitivity, "max_sensitivity", ""),
    Row::new(LoopFigure::MaxComplementary, "max_complementary_sensitivity", ""),
    Row::new(LoopFigure::PoleRadius, "closed_loop_pole_radius", ""),
    Row::new(LoopFigure::Crossover, "crossover_hz", "Hz"),
];

const STEP: [Row<StepFigure>; 6] = [
    Row::new(StepFigure::Overshoot, "overshoot_percent", "%"),
    Row::new(StepFigure::RiseTime, "rise_time_s", "s"),
    Row::new(StepFigure::PeakTime, "peak_time_s", "s"),
    Row::new(StepFigure::SettlingTime, "settling_time_s", "s"),
    Row::new(StepFigure::SteadyStateError, "steady_state_error_percent", "%"),
    Row::new(StepFigure::ControlPeak, "control_peak_v", "V"),
];

const TRIANGLE: [Row<TriangleFigure>; 3] = [
    Row::new(TriangleFigure::ErrorRms, "error_rms_rad_s", "rad/s"),
    Row::new(TriangleFigure::ErrorPeak, "error_peak_rad_s", "rad/s"),
    Row::new(TriangleFigure::ControlPeak, "control_peak_v", "V"),
];

const QUANTITIES: [Row<Quantity>; 10] = [
    Row::new(Quantity::HubRms, "hub_rms_rad_s", "rad/s"),
    Row::new(Quantity::HubPeak, "hub_peak_rad_s", "rad/s"),
    Row::new(Quantity::TipRms, "tip_rms_rad_s", "rad/s"),
    Row::new(Quantity::TipPeak, "tip_peak_rad_s", "rad/s"),
    Row::new(Quantity::ControlRms, "control_rms_v", "V"),
    Row::new(Quantity::ControlPeak, "control_peak_v", "V"),
    Row::new(Quantity::CurrentPeak, "current_peak_a", "A"),
    Row::new(Quantity::TravelPeak, "travel_peak_rad", "rad"),
    Row::new(Quantity::GearOpen, "gear_open_fraction", "of the time"),
    Row::new(Quantity::Rejection, "drr_db", "dB"),
];

const REST: [Row<RestFigure>; 2] = [
    Row::new(RestFigure::HubRms, "rest_hub_rms_rad_s", "rad/s"),
    Row::new(RestFigure::Drift, "rest_drift_rad", "rad"),
];

const CERTIFICATE: [Row<CertificateFigure>; 3] = [
    Row::new(CertificateFigure::GainMargin, "worst_regime_gain_margin_db", "dB"),
    Row::new(CertificateFigure::MaxSensitivity, "worst_regime_max_sensitivity", ""),
    Row::new(CertificateFigure::LimitCyclePeak, "limit_cycle_peak_rad_s", "rad/s"),
];

const SIGHT: [Row<SightFigure>; 10] = [
    Row::new(SightFigure::Hub, "line_of_sight_rms_rad", "rad"),
    Row::new(SightFigure::HubJitter, "line_of_sight_jitter_rad", "rad"),
    Row::new(SightFigure::Tip, "tip_line_of_sight_rms_rad", "rad"),
    Row::new(SightFigure::TipJitter, "tip_line_of_sight_jitter_rad", "rad"),
    Row::new(SightFigure::Bending, "tip_against_hub_rms_rad", "rad"),
    Row::new(SightFigure::Coincidence, "coincidence_fraction", "of the time"),
    Row::new(SightFigure::Wait, "coincidence_wait_s", "s"),
    Row::new(SightFigure::Hit, "hit_probability", ""),
    Row::new(SightFigure::HubTransferLoss, "line_of_sight_mtf_loss", ""),
    Row::new(SightFigure::TipTransferLoss, "tip_line_of_sight_mtf_loss", ""),
];

fn words<K: PartialEq>(table: &[Row<K>], of: &K) -> Words {
    table.iter().find(|row| row.of == *of).map_or(Words::default(), |row| row.words)
}

impl PerformanceFigure {
    /// Returns the figure's name in a project file, for example `nonlinear_road_feedback_hub_rms_rad_s` or
    /// `pitch_compensated_drr_db at 1.5 Hz`. [`PerformanceFigure::from_key`] is its inverse.
    pub fn key(&self) -> String {
        match self {
            PerformanceFigure::Loop(figure) => words(&LOOP, figure).key.to_owned(),
            PerformanceFigure::Step(model, figure) => {
                format!("{}_step_{}", words(&MODELS, model).key, words(&STEP, figure).key)
            }
            PerformanceFigure::Triangle(model, figure) => {
                format!("{}_triangle_{}", words(&MODELS, model).key, words(&TRIANGLE, figure).key)
            }
            PerformanceFigure::Disturbance(model, source, arrangement, quantity) => format!(
                "{}_{}_{}_{}",
                words(&MODELS, model).key,
                words(&SOURCES, source).key,
                words(&ARRANGEMENT_NAMES, arrangement).key,
                words(&QUANTITIES, quantity).key
            ),
            PerformanceFigure::Rejection { source, arrangement, frequency_hz } => {
                format!(
                    "{}_{}_drr_db at {frequency_hz} Hz",
                    words(&SOURCES, source).key,
                    words(&ARRANGEMENT_NAMES, arrangement).key
                )
            }
            PerformanceFigure::Rest(figure) => words(&REST, figure).key.to_owned(),
            PerformanceFigure::Sight(figure) => words(&SIGHT, figure).key.to_owned(),
            PerformanceFigure::Certificate(figure) => words(&CERTIFICATE, figure).key.to_owned(),
        }
    }

    /// Returns whether the figure is read from responses over frequency: a margin, a sensitivity or a rejection at a frequency.
    pub fn is_over_frequency(&self) -> bool {
        match self {
            PerformanceFigure::Loop(figure) => {
                !matches!(figure, LoopFigure::PoleRadius | LoopFigure::Crossover)
            }
            PerformanceFigure::Rejection { .. } => true,
            _ => false,
        }
    }

    /// Returns the figure's name in the project file and in the results of a loop: [`PerformanceFigure::key`] with the quantity that the loop controls and
    /// its unit, for example `nonlinear_road_feedback_torque_rms_nm`.
    pub fn key_in(&self, controlled: ControlledQuantity) -> String {
        controlled.named_figure(&self.key())
    }

    /// Returns the figure with the given key in a loop: its own, or that of a loop of rate, which older files have.
    ///
    /// # Errors
    /// As [`PerformanceFigure::from_key`].
    pub fn from_key_in(controlled: ControlledQuantity, key: &str) -> Result<Self, Error> {
        if controlled == ControlledQuantity::RATE {
            return Self::from_key(key);
        }
        let own = Self::all().into_iter().find(|figure| figure.key_in(controlled) == key);
        own.map_or_else(|| Self::from_key(key), Ok)
    }

    /// Returns the figure with the given key.
    ///
    /// # Errors
    /// [`Error::UnknownFigure`] with the nearest keys where there is none, [`Error::Range`] for a frequency that is not
    /// positive.
    pub fn from_key(key: &str) -> Result<Self, Error> {
        if let Some((stem, frequency)) = key.split_once(" at ") {
            return Self::rejection_from_key(key, stem, frequency);
        }
        Self::all().into_iter().find(|figure| figure.key() == key).ok_or_else(|| unknown_figure(key))
    }

    fn rejection_from_key(key: &str, stem: &str, frequency: &str) -> Result<Self, Error> {
        let number =
            frequency.trim().strip_suffix("Hz").map(str::trim).and_then(|text| text.parse::<f64>().ok());
        let frequency_hz = number.ok_or_else(|| unknown_figure(key))?;
        if !(frequency_hz > 0.0 && frequency_hz.is_finite()) {
            return Err(Error::Range {
                what: "frequency of a DRR",
                value: frequency_hz,
                allowed: "positive, in Hz",
            });
        }
        let all = rejections(frequency_hz);
        all.into_iter()
            .find(|figure| figure.key().starts_with(&format!("{stem} at")))
            .ok_or_else(|| unknown_figure(key))
    }

    /// Returns every figure; the DRR at 1 Hz stands for the DRR at any frequency.
    pub fn all() -> Vec<Self> {
        let mut out: Vec<Self> = LOOP.iter().map(|row| PerformanceFigure::Loop(row.of)).collect();
        for Row { of: model, .. } in MODELS {
            out.extend(STEP.iter().map(|row| PerformanceFigure::Step(model, row.of)));
            out.extend(TRIANGLE.iter().map(|row| PerformanceFigure::Triangle(model, row.of)));
        }
        for Row { of: model, .. } in MODELS {
            for Row { of: source, .. } in SOURCES {
                for Row { of: arrangement, .. } in ARRANGEMENT_NAMES {
                    out.extend(
                        QUANTITIES
                            .iter()
                            .map(|row| PerformanceFigure::Disturbance(model, source, arrangement, row.of)),
                    );
                }
            }
        }
        out.extend(rejections(1.0));
        out.extend(REST.iter().map(|row| PerformanceFigure::Rest(row.of)));
        out.extend(SIGHT.iter().map(|row| PerformanceFigure::Sight(row.of)));
        out.extend(CERTIFICATE.iter().map(|row| PerformanceFigure::Certificate(row.of)));
        out
    }

    /// Returns the unit in a loop; empty for a pure number.
    pub fn unit(&self, controlled: ControlledQuantity) -> &'static str {
        match self {
            PerformanceFigure::Loop(figure) => words(&LOOP, figure).unit,
            PerformanceFigure::Step(_, figure) => words(&STEP, figure).unit,
            PerformanceFigure::Triangle(_, TriangleFigure::ErrorRms | TriangleFigure::ErrorPeak)
            | PerformanceFigure::Disturbance(_, _, _, Quantity::HubRms | Quantity::HubPeak)
            | PerformanceFigure::Rest(RestFigure::HubRms)
            | PerformanceFigure::Certificate(CertificateFigure::LimitCyclePeak) => controlled.unit(),
            PerformanceFigure::Disturbance(_, _, _, Quantity::TipRms | Quantity::TipPeak) => {
                controlled.tip_unit()
            }
            PerformanceFigure::Disturbance(_, _, _, Quantity::CurrentPeak) => controlled.drive_unit(),
            PerformanceFigure::Disturbance(_, _, _, Quantity::TravelPeak)
            | PerformanceFigure::Rest(RestFigure::Drift) => controlled.travel_unit(),
            PerformanceFigure::Triangle(_, figure) => words(&TRIANGLE, figure).unit,
            PerformanceFigure::Disturbance(_, _, _, quantity) => words(&QUANTITIES, quantity).unit,
            PerformanceFigure::Rejection { .. } => "dB",
            PerformanceFigure::Sight(figure) => words(&SIGHT, figure).unit,
            PerformanceFigure::Certificate(figure) => words(&CERTIFICATE, figure).unit,
        }
    }
}

impl fmt::Display for PerformanceFigure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.key())
    }
}

/// The error for a key that no figure has.
fn unknown_figure(key: &str) -> Error {
    let close = nearest_key(key, PerformanceFigure::all().iter().map(PerformanceFigure::key));
    let hint = close.map_or(String::new(), |best| format!(", did you mean '{best}'?"));
    Error::UnknownFigure { key: key.to_owned(), hint }
}

fn rejections(frequency_hz: f64) -> Vec<PerformanceFigure> {
    let mut out = Vec::new();
    for source in [Source::Heave, Source::Pitch] {
        out.extend(ARRANGEMENT_NAMES.iter().map(|row| PerformanceFigure::Rejection {
            source,
            arrangement: row.of,
            frequency_hz,
        }));
    }
    out
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;
    use counterpoise_models::{AxisKind, DriveQuantity, QuantityKind};

    #[test]
    fn every_key_finds_its_figure_and_no_two_are_alike() {
        let all = PerformanceFigure::all();
        let mut keys: Vec<String> = all.iter().map(PerformanceFigure::key).collect();
        for figure in &all {
            assert_eq!(PerformanceFigure::from_key(&figure.key()).unwrap(), *figure);
        }
        keys.sort();
        keys.dedup();
        assert_eq!(keys.len(), all.len());
    }

    #[test]
    fn a_drr_is_named_with_its_frequency() {
        let figure = PerformanceFigure::from_key("pitch_compensated_drr_db at 1.5 Hz").unwrap();
        let expected = PerformanceFigure::Rejection {
            source: Source::Pitch,
            arrangement: Arrangement::Compensated,
            frequency_hz: 1.5,
        };
        assert_eq!(figure, expected);
        assert!(matches!(
            PerformanceFigure::from_key("pitch_compensated_drr_db at -1 Hz"),
            Err(Error::Range { .. })
        ));
    }

    #[test]
    fn a_figure_has_the_key_and_the_unit_of_what_its_loop_controls() {
        let of = |kind, axis| ControlledQuantity { kind, axis, ..ControlledQuantity::RATE };
        let torque = of(QuantityKind::Effort, AxisKind::Rotary);
        let peak = PerformanceFigure::from_key("linear_pitch_feedback_current_peak_a").unwrap();
        assert_eq!((peak.key_in(torque), peak.unit(torque)), (peak.key(), "A"));
        let boom = ControlledQuantity { drive: DriveQuantity::Pressure, ..ControlledQuantity::RATE };
        assert_eq!(peak.key_in(boom), "linear_pitch_feedback_load_pressure_peak_mpa");
        assert_eq!(peak.unit(boom), "MPa");
        assert_eq!(PerformanceFigure::from_key_in(boom, &peak.key_in(boom)), Ok(peak));
        let rms = PerformanceFigure::from_key("linear_pitch_feedback_hub_rms_rad_s").unwrap();
        assert_eq!(
            (rms.unit(torque), rms.key_in(torque).as_str()),
            ("N m", "linear_pitch_feedback_torque_rms_nm")
        );
        for quantity in
            [QuantityKind::Rate, QuantityKind::Position, QuantityKind::Effort, QuantityKind::Current]
        {
            for controlled in [of(quantity, AxisKind::Rotary), of(quantity, AxisKind::Linear)] {
                let mut keys: Vec<String> =
                    PerformanceFigure::all().iter().map(|f| f.key_in(controlled)).collect();
                for (figure, key) in PerformanceFigure::all().iter().zip(&keys) {
                    assert_eq!(PerformanceFigure::from_key_in(controlled, key).unwrap(), *figure);
                    assert_eq!(PerformanceFigure::from_key_in(controlled, &figure.key()).unwrap(), *figure);
                }
                keys.sort();
                keys.dedup();
                assert_eq!(keys.len(), PerformanceFigure::all().len());
            }
        }
    }

    #[test]
    fn a_misspelt_figure_is_answered_with_the_nearest() {
        let Err(Error::UnknownFigure { hint, .. }) = PerformanceFigure::from_key("gain_margn_db") else {
            panic!()
        };
        assert_eq!(hint, ", did you mean 'gain_margin_db'?");
    }
}
