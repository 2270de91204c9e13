//! The parts between motor and hub, each kind a section of its own; none of them: the motor sits on the hub's axis.

use counterpoise_models::{AxisKind, Gearbox, Parameters, Ripple, Transmission};
use std::f64::consts::TAU;

use super::friction::ripple;
use crate::file::field::{Field, NumberRange, TableField, UsualRange};
use crate::file::visit::{Presence, Visit};

const AT_LEAST_0: NumberRange = NumberRange::AtLeast(0.0);
const ABOVE_0: NumberRange = NumberRange::Above(0.0);
/// Damping ratio of a compliance of which nothing is known.
const DAMPING_RATIO: f64 = 0.01;
/// Periods of a harmonic drive's error a turn of its wave generator, whose two lobes are alike.
const LOBES: f64 = 2.0;

const STIFFNESS: Field = Field::new("stiffness", "at the output; rigid if absent")
    .unit("N m/rad")
    .limit(ABOVE_0)
    .or(f64::INFINITY);
/// Lowest usual frequency at which a load swings on its transmission while the motor is held, Hz. A first design must hold the load on a transmission
/// that is as soft as this if the file does not state how stiff it is. Belts and cables stretch, the teeth of gears and harmonic drives bend, a ball
/// screw's nut and bearings are preloaded. The reference rig has 13 Hz on its gearbox, the belt antenna 7 Hz.
const SOFT_BELT_HZ: f64 = 5.0;
const SOFT_GEAR_HZ: f64 = 10.0;
const SOFT_SCREW_HZ: f64 = 20.0;
const BACKLASH: Field =
    Field::new("backlash", "total gap at the output").unit("rad").limit(AT_LEAST_0).or(0.0);
const EFFICIENCY: Field =
    Field::new("mesh_efficiency", "fraction of the torque through it that arrives while it drives")
        .limit(NumberRange::AboveTo(0.0, 1.0))
        .or(1.0);
const RATIO: Field = Field::new("ratio", "motor turns per hub turn").limit(ABOVE_0).if_unknown(
    "turn the load by hand and count the turns of the motor; without the section the motor drives directly",
);

/// Reads or lists the gearbox; without one the motor is on the hub's axis.
pub(super) fn gearbox_section(v: &mut dyn Visit, plant: &mut Parameters) {
    let load = plant.lumped.as_ref().map_or(0.0, |l| l.inertia_kg_m2());
    let gearbox = &mut plant.gearbox;
    let there = gearbox.kind == Transmission::Gearbox;
    let section = TableField::optional("gearbox", "gearbox between motor and hub");
    if !v.enter(&section, Presence::from(there)) {
        if there {
            *gearbox = Gearbox::DIRECT;
        }
        return;
    }
    begin(gearbox, Transmission::Gearbox);
    v.number(&RATIO, &mut gearbox.ratio);
    v.number(&stiffness(Transmission::Gearbox, load), &mut gearbox.stiffness_nm_rad);
    let damping = Field::new("damping", "at the output, only while the teeth touch").unit("N m s/rad");
    let damping = as_usual(damping.limit(AT_LEAST_0), gearbox.stiffness_nm_rad, load);
    v.number(&damping, &mut gearbox.damping_nm_s_rad);
    v.number(&BACKLASH, &mut gearbox.backlash_rad);
    v.number(&EFFICIENCY, &mut gearbox.mesh_efficiency);
    ripple(
        v,
        &TableField::inline("mesh_ripple", "ripple of the torque on the hub, periodic in the motor angle"),
        &mut gearbox.mesh_ripple,
        "N m",
    );
    v.leave();
}

/// Reads or lists a transmission of another kind.
pub(super) fn other_sections(v: &mut dyn Visit, plant: &mut Parameters) {
    for (kind, key, meaning) in [
        (Transmission::Belt, "belt", "belt between motor and hub"),
        (Transmission::Cable, "cable", "cable between motor and hub"),
        (Transmission::HarmonicDrive, "harmonic_drive", "harmonic drive between motor and hub"),
        (Transmission::BallScrew { lead_m: f64::NAN }, "ball_screw", "ball screw between motor and slide"),
    ] {
        let there = std::mem::discriminant(&plant.gearbox.kind) == std::mem::discriminant(&kind);
        if !v.enter(&TableField::optional(key, meaning), Presence::from(there)) {
            continue;
        }
        if !there && plant.gearbox.kind != Transmission::Direct {
            v.complain(
                "",
                "must be the only transmission: one section says what lies between motor and hub",
                None,
            );
        }
        if !there {
            begin(&mut plant.gearbox, kind);
        }
        keys(v, plant);
        v.leave();
    }
}

/// Returns the name of the section of a kind of transmission; `None` if the motor drives directly.
pub(super) fn section_of(kind: Transmission) -> Option<&'static str> {
    match kind {
        Transmission::Direct => None,
        Transmission::Gearbox => Some("gearbox"),
        Transmission::Belt => Some("belt"),
        Transmission::Cable => Some("cable"),
        Transmission::HarmonicDrive => Some("harmonic_drive"),
        Transmission::BallScrew { .. } => Some("ball_screw"),
    }
}

/// A transmission still to be read, unless it is of this kind already.
fn begin(gearbox: &mut Gearbox, kind: Transmission) {
    if gearbox.kind != kind {
        *gearbox = Gearbox { kind, ..Gearbox::DIRECT };
    }
}

fn keys(v: &mut dyn Visit, plant: &mut Parameters) {
    if let Transmission::BallScrew { mut lead_m } = plant.gearbox.kind {
        v.number(&Field::new("lead", "travel a turn").unit("m/rev").limit(ABOVE_0), &mut lead_m);
        if plant.axis == AxisKind::Rotary {
            v.complain("lead", "must be that of a linear axis: write axis = \"linear\" in [plant]", None);
        }
        plant.gearbox.kind = Transmission::BallScrew { lead_m };
        plant.gearbox.ratio = TAU / lead_m;
    } else {
        v.number(&RATIO, &mut plant.gearbox.ratio);
    }
    let damping = Field::new("damping", "at the output").unit("N m s/rad").limit(AT_LEAST_0);
    let load = plant.lumped.as_ref().map_or(0.0, |l| l.inertia_kg_m2());
    let gearbox = &mut plant.gearbox;
    v.number(&stiffness(gearbox.kind, load), &mut gearbox.stiffness_nm_rad);
    let damping = as_usual(damping, gearbox.stiffness_nm_rad, load);
    v.number(&damping, &mut gearbox.damping_nm_s_rad);
    match gearbox.kind {
        Transmission::HarmonicDrive => harmonic(v, gearbox),
        Transmission::BallScrew { .. } => {
            v.number(&BACKLASH, &mut gearbox.backlash_rad);
            v.number(&EFFICIENCY, &mut gearbox.mesh_efficiency);
        }
        _ => {}
    }
}

fn harmonic(v: &mut dyn Visit, gearbox: &mut Gearbox) {
    let level = Field::new("hysteresis", "largest torque of its hysteresis").unit("N m").limit(AT_LEAST_0);
    v.number(&level.or(0.0), &mut gearbox.hysteresis_nm);
    let spring = Field::new("hysteresis_stiffness", "stiffness of the hysteresis where it springs back");
    let usual = if gearbox.hysteresis_nm > 0.0 { gearbox.stiffness_nm_rad } else { 0.0 };
    let spring = spring.unit("N m/rad").limit(AT_LEAST_0).or(usual).with_assumption(
        "that of the compliance",
        "a loop that closes within its own wind-up",
        UsualRange::Factors(0.3, 3.0),
    );
    v.number(&spring, &mut gearbox.hysteresis_stiffness_nm_rad);
    let mut amplitude = gearbox.kinematic_error.amplitude;
    let error = Field::new("kinematic_error", "amplitude at the output, two periods a turn of the motor");
    v.number(&error.unit("rad").or(0.0), &mut amplitude);
    gearbox.kinematic_error =
        if amplitude == 0.0 { Ripple::NONE } else { Ripple { amplitude, order: LOBES, phase_rad: 0.0 } };
}

/// Returns the key of a transmission's stiffness: rigid if it is absent, and usually no softer than what lets the load swing at the lowest usual frequency of
/// such transmissions.
fn stiffness(kind: Transmission, load_kg_m2: f64) -> Field {
    let softest_hz = match kind {
        Transmission::Belt | Transmission::Cable => SOFT_BELT_HZ,
        Transmission::BallScrew { .. } => SOFT_SCREW_HZ,
        _ => SOFT_GEAR_HZ,
    };
    assumed_rigid(STIFFNESS, softest_hz, load_kg_m2)
}

/// Returns the key of a stiffness that is rigid if absent, and usually lets what it carries swing at no less than a frequency.
pub(super) fn assumed_rigid(stiffness: Field, softest_hz: f64, carried_kg_m2: f64) -> Field {
    let softest = (TAU * softest_hz).powi(2) * carried_kg_m2;
    let usual = match softest > 0.0 && softest.is_finite() {
        true => UsualRange::Values(softest, f64::INFINITY),
        false => UsualRange::Unknown,
    };
    stiffness.with_assumption("rigid", "what is left out is ideal", usual)
}

/// Returns the key of a compliance's damping, at a damping ratio of 0.01 of the load on it, the motor held, if it is absent; 0 if the
/// compliance is rigid or the load's inertia is not stated as a number. Without any damping a resonance has no bound, and no loop bears
/// it.
fn as_usual(damping: Field, stiffness_nm_rad: f64, load_kg_m2: f64) -> Field {
    let usual = 2.0 * DAMPING_RATIO * (stiffness_nm_rad * load_kg_m2).sqrt();
    damping.or(if usual.is_finite() { usual } else { 0.0 }).with_assumption(
        "damping ratio 0.01 with the motor held",
        "metal parts without a damper: 0.005 to 0.03",
        UsualRange::Factors(0.5, 3.0),
    )
}
