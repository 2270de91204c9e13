//! The drive: `[plant.amplifier]` for a voltage amplifier, `[plant.drive]` for one that takes a current or a torque.
//!
//! A drive that takes a current or a torque has its limit at the full 10 V of the control. If no limit is stated, 10 V command the
//! torque that gives the whole inertia [`FULL_SCALE`].

use counterpoise_models::{Amplifier, AmplifierDynamics, MapPoint, Motor, Parameters, Ripple};

use crate::assumption::{LATEST_USUAL_DRIVE_S, SLOWEST_USUAL_DRIVE_RAD_S};
use crate::file::field::{Field, NumberRange, TableField, UnitHint, UsualRange};
use crate::file::visit::{NamedChoice, Presence, Visit, choose};
use crate::tolerance::WHOLE_DELAY;

use super::digits::shortest_that_gives;

const AT_LEAST_0: NumberRange = NumberRange::AtLeast(0.0);
const ABOVE_0: NumberRange = NumberRange::Above(0.0);
/// Full scale of the control, V.
const FULL_V: f64 = 10.0;
/// Acceleration of the load that a drive without a stated limit has at full scale, rad/s^2 or m/s^2: far above what a servo uses,
/// and a torque that converters of 12 bits still resolve.
const FULL_SCALE: f64 = 1000.0;
/// Torque of such a drive if no inertia is stated as a number, N m.
const UNKNOWN_TORQUE: f64 = 10.0;

/// Largest time constant of the armature that is usual, inductance over resistance, s: that of small servo motors is below a millisecond, that of large ones a few.
pub(super) const SLOWEST_USUAL_ARMATURE_S: f64 = 5e-3;
/// Largest lag of a voltage amplifier that is usual, s: a few periods of its switching at a few kilohertz.
const SLOWEST_USUAL_VOLTAGE_S: f64 = 5e-4;

/// The meaning of a limit in the unit of another kind of drive.
const OF_CURRENT: UnitHint =
    UnitHint { unit: "A", add: "a drive with a largest current is a current loop: add kind = \"current\"" };
const OF_VOLTAGE: UnitHint =
    UnitHint { unit: "V", add: "a drive with a largest voltage: add kind = \"voltage\"" };
const OF_TORQUE: UnitHint = UnitHint { unit: "N m", add: "a drive that takes a torque: kind = \"torque\"" };

/// The command that a drive takes.
#[derive(Debug, Clone, Copy, PartialEq)]
enum DriveInput {
    Torque,
    Current,
    Voltage,
}

impl NamedChoice for DriveInput {
    const NAMES: &'static [(&'static str, Self)] =
        &[("torque", Self::Torque), ("current", Self::Current), ("voltage", Self::Voltage)];
}

/// Returns a drive that takes a torque, without a limit.
pub(super) fn blank_amplifier() -> Amplifier {
    Amplifier {
        gain: 1.0,
        current_feedback_v_a: 0.0,
        time_constant_s: 0.0,
        input_limit_v: f64::INFINITY,
        bus_voltage_v: f64::INFINITY,
        map: Vec::new(),
        dead_zone_v: 0.0,
        current_limit_a: f64::INFINITY,
        dynamics: AmplifierDynamics::TorqueCommand,
    }
}

/// Returns a motor of which nothing is written: its current is its torque.
pub(super) fn usual_motor() -> Motor {
    Motor {
        inertia_kg_m2: 0.0,
        torque_constant_nm_a: 1.0,
        back_emf_v_s_rad: 1.0,
        resistance_ohm: 1.0,
        inductance_h: 0.0,
        cogging: Ripple::NONE,
        torque_ripple: Ripple::NONE,
        platform_coupling: 0.0,
    }
}

/// Reads or lists the drive.
pub(super) fn drive(v: &mut dyn Visit, plant: &mut Parameters) {
    let of_voltage =
        matches!(plant.amplifier.dynamics, AmplifierDynamics::Modelled | AmplifierDynamics::IdealCurrent);
    let section = TableField::optional("amplifier", "amplifier that drives the motor with a voltage");
    if v.enter(&section, Presence::from(of_voltage)) {
        if !of_voltage {
            plant.amplifier = Amplifier { dynamics: AmplifierDynamics::Modelled, ..blank_amplifier() };
        }
        amplifier(v, &mut plant.amplifier);
        v.leave();
        if !v.sees_every_section() {
            return;
        }
    }
    let mut word = String::new();
    if v.shorthand("drive", &mut word) {
        let Some((_, takes)) = DriveInput::NAMES.iter().find(|(name, _)| *name == word) else {
            v.complain(
                "drive",
                "must be \"torque\", \"current\" or \"voltage\", or a section [plant.drive]",
                None,
            );
            return;
        };
        ask_for_motor(v, plant, *takes);
        return set(v, plant, *takes, &DriveKeys::NONE);
    }
    let section = TableField::optional("drive", "a drive that takes a torque, a current or a voltage");
    let amplifier = &plant.amplifier;
    let is_curved = amplifier.dead_zone_v != 0.0 || !amplifier.map.is_empty();
    let usual = amplifier.dynamics == AmplifierDynamics::TorqueCommand
        && amplifier.current_limit_a == f64::INFINITY
        && !is_curved;
    if !v.enter(&section, Presence::from(!usual)) {
        return set(v, plant, DriveInput::Torque, &DriveKeys::NONE);
    }
    let mut takes = takes_of(plant);
    let kind = Field::new("kind", "what the drive takes").or_text("torque").show_default();
    choose(v, &kind, &mut takes);
    let stated = keys(v, plant, takes);
    v.leave();
    ask_for_motor(v, plant, takes);
    set(v, plant, takes, &stated);
}

/// Lists the section of a drive that takes a voltage as a file states it, which becomes an amplifier.
pub(super) fn list_voltage_drive(v: &mut dyn Visit, plant: &Parameters) {
    let section = TableField::optional("drive", "a drive that takes a torque, a current or a voltage");
    if v.enter(&section, Presence::Present) {
        let mut takes = DriveInput::Voltage;
        choose(v, &Field::new("kind", "what the drive takes").or_text("torque").show_default(), &mut takes);
        keys(v, plant, takes);
        v.leave();
    }
}

/// Complains of what a drive needs of its motor and the file does not have.
fn ask_for_motor(v: &mut dyn Visit, plant: &Parameters, takes: DriveInput) {
    // Without a motor, a transmission that has a stiffness asks for the motor first.
    let asks_for_motor = !plant.gearbox.is_rigid() && !v.has("motor");
    if takes == DriveInput::Voltage && !asks_for_motor && !v.has("motor.resistance") {
        let hint = "add `resistance` to [plant.motor]; if none is known, measure it between two terminals, or divide a voltage by the current at stall";
        v.complain(
            "drive",
            "takes a voltage, which makes a torque through the motor's resistance",
            Some(hint.to_owned()),
        );
    }
    if takes != DriveInput::Torque && !asks_for_motor && !v.has("motor.torque_constant") {
        let hint = "add `torque_constant` to [plant.motor], as its data sheet has it (60 / (2 pi) over the speed constant in rpm/V); if only the torque is known, take kind = \"torque\" \
                    and its largest torque as `limit`";
        let what = match takes {
            DriveInput::Voltage => "takes a voltage, whose torque the motor's torque constant decides",
            DriveInput::Torque | DriveInput::Current => {
                "takes a current, whose torque the motor's torque constant decides"
            }
        };
        v.complain("drive", what, Some(hint.to_owned()));
    }
}

/// The statements of `[plant.drive]`.
struct DriveKeys {
    /// Of the torque, N m, or of the current, A; infinite if it is not stated.
    limit: f64,
    bandwidth_rad_s: f64,
    delay_s: f64,
    dead_zone_v: f64,
    /// Lag of a drive that takes a voltage, s.
    time_constant_s: f64,
    /// Largest current of a drive that takes a voltage, A.
    current_limit_a: f64,
    map: Vec<MapPoint>,
}

impl DriveKeys {
    const NONE: Self = Self {
        limit: f64::INFINITY,
        bandwidth_rad_s: f64::INFINITY,
        delay_s: 0.0,
        dead_zone_v: 0.0,
        time_constant_s: 0.0,
        current_limit_a: f64::INFINITY,
        map: Vec::new(),
    };
}

fn takes_of(plant: &Parameters) -> DriveInput {
    match plant.amplifier.dynamics {
        AmplifierDynamics::TorqueCommand => DriveInput::Torque,
        AmplifierDynamics::CurrentCommand | AmplifierDynamics::CurrentLoop { .. } => DriveInput::Current,
        AmplifierDynamics::Modelled | AmplifierDynamics::IdealCurrent => DriveInput::Voltage,
    }
}

fn keys(v: &mut dyn Visit, plant: &Parameters, takes: DriveInput) -> DriveKeys {
    let mut stated = DriveKeys { limit: plant.amplifier.current_limit_a, ..DriveKeys::NONE };
    if plant.amplifier.dynamics == AmplifierDynamics::Modelled {
        (stated.time_constant_s, stated.current_limit_a) =
            (plant.amplifier.time_constant_s, plant.amplifier.current_limit_a);
    }
    if let AmplifierDynamics::CurrentLoop { bandwidth_rad_s, delay_s } = plant.amplifier.dynamics {
        (stated.bandwidth_rad_s, stated.delay_s) = (bandwidth_rad_s, delay_s);
    }
    match takes {
        DriveInput::Torque => {
            stated.limit = torque_limit_nm(plant);
            let limit = Field::new("limit", "largest torque of the motor, at 10 V of control; with `kind` current the largest current in A, with voltage the largest voltage in V").unit("N m");
            let limit = limit.with_unit_hints(&[OF_CURRENT, OF_VOLTAGE]);
            v.number(&limit.limit(ABOVE_0).or(f64::INFINITY), &mut stated.limit);
        }
        DriveInput::Current => {
            let limit = Field::new("limit", "largest current, at 10 V of control").unit("A");
            let limit = limit.with_unit_hints(&[OF_TORQUE, OF_VOLTAGE]);
            v.number(&limit.limit(ABOVE_0).or(f64::INFINITY), &mut stated.limit);
            let bandwidth = Field::new("bandwidth", "of the current loop").unit("rad/s").limit(ABOVE_0);
            let bandwidth = bandwidth.or(f64::INFINITY).with_assumption(
                "unlimited, as in an ideal drive",
                "what is left out is ideal; current loops usually have 1 kHz or more",
                UsualRange::Values(SLOWEST_USUAL_DRIVE_RAD_S, f64::INFINITY),
            );
            v.number(&bandwidth, &mut stated.bandwidth_rad_s);
            let delay = Field::new("delay", "of the current loop, taken as whole sample periods, rounded up");
            let delay = delay.unit("s").limit(AT_LEAST_0).or(0.0).with_assumption(
                "none, as in an ideal drive",
                "what is left out is ideal; drives usually act within 0.2 ms",
                UsualRange::Values(0.0, LATEST_USUAL_DRIVE_S),
            );
            v.number(&delay, &mut stated.delay_s);
        }
        DriveInput::Voltage => {
            let limit = Field::new("limit", "largest voltage, at 10 V of control").unit("V").limit(ABOVE_0);
            let limit = limit.with_unit_hints(&[OF_TORQUE, OF_CURRENT]).or(f64::INFINITY).with_assumption(
                "unlimited; a volt of control is a volt at the motor, and the control ends at 10 V",
                "what is left out is ideal",
                UsualRange::Unknown,
            );
            stated.limit = plant.amplifier.bus_voltage_v;
            v.number(&limit, &mut stated.limit);
            v.number(&voltage_lag("lag of the voltage"), &mut stated.time_constant_s);
            current_limit(v, &mut stated.current_limit_a);
        }
    }
    (stated.dead_zone_v, stated.map) = (plant.amplifier.dead_zone_v, plant.amplifier.map.clone());
    dead_zone(v, &mut stated.dead_zone_v);
    map(v, &mut stated.map);
    stated
}

/// Returns the key of the lag of a voltage.
fn voltage_lag(meaning: &'static str) -> Field {
    Field::new("time_constant", meaning).unit("s").limit(AT_LEAST_0).or(0.0).with_assumption(
        "none, as in an ideal amplifier",
        "what is left out is ideal; amplifiers usually lag by 0.5 ms or less",
        UsualRange::Values(0.0, SLOWEST_USUAL_VOLTAGE_S),
    )
}

fn current_limit(v: &mut dyn Visit, current_limit_a: &mut f64) {
    let field = Field::new("current_limit", "current is clipped to +/- this; none if absent").unit("A");
    v.number(&field.limit(ABOVE_0).or(f64::INFINITY), current_limit_a);
}

fn dead_zone(v: &mut dyn Visit, dead_zone_v: &mut f64) {
    let field = Field::new("dead_zone", "half width of a dead zone at the input").unit("V");
    v.number(&field.limit(AT_LEAST_0).or(0.0), dead_zone_v);
}

/// Returns the largest torque of the motor, N m: that of the largest current.
fn torque_limit_nm(plant: &Parameters) -> f64 {
    let (limit_a, constant) = (plant.amplifier.current_limit_a, plant.motor.torque_constant_nm_a);
    shortest_that_gives(limit_a, limit_a * constant, |limit_nm| limit_nm / constant)
}

/// Makes the amplifier of what is stated.
fn set(v: &mut dyn Visit, plant: &mut Parameters, takes: DriveInput, stated: &DriveKeys) {
    let blank = Amplifier { dead_zone_v: stated.dead_zone_v, map: stated.map.clone(), ..blank_amplifier() };
    let stated_limit = stated.limit.is_finite();
    if takes == DriveInput::Voltage {
        let gain = if stated_limit { stated.limit / FULL_V } else { 1.0 };
        let dynamics = AmplifierDynamics::Modelled;
        let DriveKeys { limit: bus_voltage_v, time_constant_s, current_limit_a, .. } = *stated;
        plant.amplifier =
            Amplifier { gain, bus_voltage_v, time_constant_s, current_limit_a, dynamics, ..blank };
        return;
    }
    let current_limit_a = match takes {
        DriveInput::Torque => stated.limit / plant.motor.torque_constant_nm_a,
        DriveInput::Current | DriveInput::Voltage => stated.limit,
    };
    let full_a = if stated_limit { current_limit_a } else { full_scale_a(v, plant) };
    let lagging = stated.bandwidth_rad_s.is_finite() || stated.delay_s > 0.0;
    let dynamics = match takes {
        DriveInput::Current if lagging => {
            let bandwidth_rad_s = stated.bandwidth_rad_s.min(1.0 / counterpoise_models::IDEAL_LAG_S);
            AmplifierDynamics::CurrentLoop { bandwidth_rad_s, delay_s: stated.delay_s }
        }
        DriveInput::Current => AmplifierDynamics::CurrentCommand,
        DriveInput::Torque | DriveInput::Voltage => AmplifierDynamics::TorqueCommand,
    };
    plant.amplifier = Amplifier { gain: full_a / FULL_V, current_limit_a, dynamics, ..blank };
}

/// Current at 10 V of a drive without a stated limit, A.
fn full_scale_a(v: &mut dyn Visit, plant: &Parameters) -> f64 {
    let (ratio, constant) = (plant.gearbox.ratio, plant.motor.torque_constant_nm_a);
    let rotor = ratio * ratio * plant.motor.inertia_kg_m2;
    let of_inertia =
        |l: &counterpoise_models::LumpedStructure| (l.inertia_kg_m2() + rotor) * FULL_SCALE / ratio;
    let torque_nm = plant.lumped.as_ref().map_or(UNKNOWN_TORQUE, of_inertia);
    let limit = Field::new("drive.limit", "largest torque of the motor, at 10 V of control").unit("N m");
    let limit = limit.with_assumption(
        "unlimited; 10 V of control command the torque that accelerates the load by 1000 rad/s^2",
        "what is left out is ideal",
        UsualRange::Factors(0.001, 1.0),
    );
    v.assume(&limit, torque_nm);
    torque_nm / constant
}

/// Whole samples of a drive's own delay.
fn samples(plant: &Parameters) -> usize {
    let period_s = plant.interface.sample_period_s;
    match plant.amplifier.dynamics {
        AmplifierDynamics::CurrentLoop { delay_s, .. } if period_s > 0.0 => {
            (delay_s / period_s - WHOLE_DELAY).ceil().max(0.0) as usize
        }
        _ => 0,
    }
}

/// Takes the drive's own delay out of the interface's, which the file states without it.
pub(super) fn without_its_delay(plant: &mut Parameters) {
    let own = samples(plant);
    plant.interface.output_delay_samples = plant.interface.output_delay_samples.saturating_sub(own);
}

/// Adds the drive's own delay to the interface's.
pub(super) fn with_its_delay(plant: &mut Parameters) {
    plant.interface.output_delay_samples += samples(plant);
}

/// Reads or lists the voltage amplifier.
fn amplifier(v: &mut dyn Visit, amplifier: &mut Amplifier) {
    let gain = Field::new("gain", "voltage gain").unit("V/V").limit(ABOVE_0).or(1.0);
    v.number(&gain, &mut amplifier.gain);
    let feedback = Field::new("current_feedback", "current feedback").unit("V/A").limit(AT_LEAST_0).or(0.0);
    v.number(&feedback, &mut amplifier.current_feedback_v_a);
    v.number(&voltage_lag("lag"), &mut amplifier.time_constant_s);
    let input = Field::new("input_limit", "input is clipped to +/- this").unit("V").limit(ABOVE_0);
    v.number(&input.or(f64::INFINITY), &mut amplifier.input_limit_v);
    let bus = Field::new("bus_voltage", "output is clipped to +/- this").unit("V").limit(ABOVE_0);
    v.number(&bus.or(f64::INFINITY), &mut amplifier.bus_voltage_v);
    dead_zone(v, &mut amplifier.dead_zone_v);
    current_limit(v, &mut amplifier.current_limit_a);
    let dynamics = "modelled: lag, feedbacks, armature and back-EMF; ideal-current: the current follows the input at once";
    choose(v, &Field::new("dynamics", dynamics).or_text("modelled"), &mut amplifier.dynamics);
    map(v, &mut amplifier.map);
}

impl NamedChoice for AmplifierDynamics {
    const NAMES: &'static [(&'static str, Self)] =
        &[("modelled", Self::Modelled), ("ideal-current", Self::IdealCurrent)];
}

fn map(v: &mut dyn Visit, map: &mut Vec<MapPoint>) {
    let field = Field::new("map", "measured input voltage and stalled current, or the name of a CSV file")
        .units("V", "A")
        .limit(ABOVE_0)
        .or_empty();
    let mut pairs: Vec<[f64; 2]> = map.iter().map(|p| [p.input_v, p.current_a]).collect();
    v.pairs(&field, &mut pairs);
    *map = merge_points(pairs);
}

/// Returns the points in order of voltage; points at one voltage become their mean.
fn merge_points(mut pairs: Vec<[f64; 2]>) -> Vec<MapPoint> {
    pairs.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mean = |points: &[[f64; 2]]| points.iter().map(|p| p[1]).sum::<f64>() / points.len() as f64;
    pairs
        .chunk_by(|a, b| a[0] == b[0])
        .map(|same| MapPoint { input_v: same[0][0], current_a: mean(same) })
        .collect()
}
