//! `[plant.cylinder]`: a hydraulic cylinder with its servo valve, in place of motor, gear and amplifier.

use counterpoise_models::parameters::cylinder::{L_PER_M3, Lever, PA_PER_MPA};
use counterpoise_models::{
    Amplifier, AmplifierDynamics, AxisKind, Cylinder, Gearbox, Linkage, Motor, Parameters,
};

use super::digits::round_to_digits;
use super::findings::Findings;
use super::{Project, drive};
use crate::diagnostic::{DiagnosticKind, Severity};
use crate::file::field::{Field, NumberRange, TableField, UsualRange};
use crate::file::source::Remark;
use crate::file::visit::{Presence, Visit, maybe_number, visit_optional};
use crate::tolerance::LEAST_LEVER;

const ABOVE_0: NumberRange = NumberRange::Above(0.0);
/// Effective bulk modulus of oil with hoses and a little air, Pa (H. Merritt, *Hydraulic Control Systems*, Wiley 1967, section 2-4: 100 000 psi).
const BULK_MODULUS_PA: f64 = 6.9e8;
/// Pressure drop at which servo valves are rated, Pa (ISO 10770-1).
const RATED_DROP_PA: f64 = 7e6;
/// Control at which the valve is fully open, V.
const RATED_CONTROL_V: f64 = 10.0;
/// Damping ratio of a spool of which nothing is known.
const VALVE_DAMPING: f64 = 0.7;
/// Sections that a cylinder takes the place of.
const REPLACED: [&str; 8] =
    ["gearbox", "belt", "cable", "harmonic_drive", "ball_screw", "motor", "amplifier", "drive"];

/// The statements of `[plant.cylinder]`, in SI.
struct CylinderKeys {
    area_m2: f64,
    supply_pa: f64,
    volume_m3: f64,
    bulk_modulus_pa: f64,
    leakage_m3_s_pa: f64,
    rated_flow_m3_s: f64,
    rated_drop_pa: f64,
    rated_control_v: f64,
    valve_frequency_rad_s: f64,
    valve_damping: f64,
    /// As a share of the full opening.
    overlap: f64,
    lever: Lever,
}

impl CylinderKeys {
    const BLANK: Self = Self {
        area_m2: f64::NAN,
        supply_pa: f64::NAN,
        volume_m3: f64::NAN,
        bulk_modulus_pa: BULK_MODULUS_PA,
        leakage_m3_s_pa: f64::NAN,
        rated_flow_m3_s: f64::NAN,
        rated_drop_pa: RATED_DROP_PA,
        rated_control_v: RATED_CONTROL_V,
        valve_frequency_rad_s: f64::NAN,
        valve_damping: VALVE_DAMPING,
        overlap: 0.0,
        lever: Lever::Constant(f64::NAN),
    };

    /// Returns what a mechanism has.
    fn of(cylinder: &Cylinder, plant: &Parameters) -> Self {
        let (motor, amplifier) = (&plant.motor, &plant.amplifier);
        let full = amplifier.gain * amplifier.input_limit_v;
        let share = cylinder.rated_drop_mpa / cylinder.supply_mpa;
        Self {
            area_m2: round_to_digits(motor.torque_constant_nm_a / PA_PER_MPA),
            supply_pa: round_to_digits(cylinder.supply_mpa * PA_PER_MPA),
            volume_m3: round_to_digits(cylinder.volume_l / L_PER_M3),
            bulk_modulus_pa: round_to_digits(cylinder.volume_l / (4.0 * motor.inductance_h) * PA_PER_MPA),
            leakage_m3_s_pa: round_to_digits(motor.resistance_ohm / (L_PER_M3 * PA_PER_MPA)),
            rated_flow_m3_s: round_to_digits((full - cylinder.overlap_l_s) * share.sqrt() / L_PER_M3),
            rated_drop_pa: round_to_digits(cylinder.rated_drop_mpa * PA_PER_MPA),
            rated_control_v: amplifier.input_limit_v,
            valve_frequency_rad_s: cylinder.valve_frequency_rad_s,
            valve_damping: cylinder.valve_damping,
            overlap: round_to_digits(cylinder.overlap_l_s / full),
            lever: cylinder.lever,
        }
    }

    /// Puts the linear part into the places of gear, motor and amplifier, and the rest beside them.
    fn drive(&self, plant: &mut Parameters) {
        let (supply_mpa, rated_drop_mpa) = (self.supply_pa / PA_PER_MPA, self.rated_drop_pa / PA_PER_MPA);
        let volume_l = self.volume_m3 * L_PER_M3;
        let free = self.rated_flow_m3_s * L_PER_M3 * (supply_mpa / rated_drop_mpa).sqrt();
        let full = free / (1.0 - self.overlap);
        plant.gearbox = Gearbox { ratio: self.lever.at(0.0).arm_m, ..Gearbox::DIRECT };
        plant.motor = Motor {
            torque_constant_nm_a: self.area_m2 * PA_PER_MPA,
            back_emf_v_s_rad: self.area_m2 * L_PER_M3,
            resistance_ohm: self.leakage_m3_s_pa * L_PER_M3 * PA_PER_MPA,
            inductance_h: volume_l / (4.0 * (self.bulk_modulus_pa / PA_PER_MPA)),
            ..drive::usual_motor()
        };
        plant.amplifier = Amplifier {
            gain: full / self.rated_control_v,
            input_limit_v: self.rated_control_v,
            time_constant_s: 2.0 * self.valve_damping / self.valve_frequency_rad_s,
            dynamics: AmplifierDynamics::Modelled,
            ..drive::blank_amplifier()
        };
        plant.cylinder = Some(Cylinder {
            supply_mpa,
            volume_l,
            overlap_l_s: self.overlap * full,
            valve_frequency_rad_s: self.valve_frequency_rad_s,
            valve_damping: self.valve_damping,
            rated_drop_mpa,
            lever: self.lever,
        });
    }
}

/// Reads or lists the cylinder; where there is none the walk may still ask for its keys, and the motor drives.
pub(super) fn cylinder(v: &mut dyn Visit, presence: Presence, plant: &mut Parameters) {
    let section = TableField::optional(
        "cylinder",
        "hydraulic cylinder with a servo valve, in place of motor, gear and amplifier",
    );
    if !v.enter(&section, presence) {
        return;
    }
    let mut stated =
        plant.cylinder.as_ref().map_or(CylinderKeys::BLANK, |cylinder| CylinderKeys::of(cylinder, plant));
    keys(v, &mut stated);
    v.leave();
    if presence == Presence::Absent {
        return;
    }
    stated.drive(plant);
    let replaced: Vec<&str> = REPLACED.into_iter().filter(|key| v.has(key)).collect();
    for key in replaced {
        let hint = "leave the section out, or leave [plant.cylinder] out";
        v.complain(
            key,
            "must not stand beside [plant.cylinder], which drives in its place",
            Some(hint.into()),
        );
    }
    if plant.axis == AxisKind::Linear {
        let hint = "leave `axis` out: the cylinder turns the mechanism by its lever";
        v.complain(
            "cylinder",
            "must not stand where axis = \"linear\": it acts about a pivot",
            Some(hint.to_owned()),
        );
    }
}

fn keys(v: &mut dyn Visit, of: &mut CylinderKeys) {
    let positive = |key, unit, meaning| Field::new(key, meaning).unit(unit).limit(ABOVE_0);
    let area = "effective area of the piston: its force per load pressure, the difference between both sides";
    v.number(&positive("area", "m^2", area), &mut of.area_m2);
    let supply = "supply pressure less that of the tank";
    v.number(&positive("supply_pressure", "Pa", supply), &mut of.supply_pa);
    let volume = "volume of oil on both sides, with the lines from the valve";
    v.number(&positive("volume", "m^3", volume), &mut of.volume_m3);
    let bulk = positive("bulk_modulus", "Pa", "effective bulk modulus of the oil with its air and the hoses");
    let bulk = bulk.or(BULK_MODULUS_PA).with_assumption(
        "6.9e8 Pa",
        "Merritt, Hydraulic Control Systems, 1967, section 2-4",
        UsualRange::Values(2e8, 1.8e9),
    );
    v.number(&bulk, &mut of.bulk_modulus_pa);
    let leakage = positive(
        "leakage",
        "m^3/s/Pa",
        "flow from side to side per load pressure, that of the valve's edges about its centre with it: it damps the load",
    );
    let leakage = leakage.if_unknown(
        "a hundredth to a fiftieth of the rated flow at the supply pressure is usual: `rated_flow` times 0.02 over `supply_pressure`",
    );
    v.number(&leakage, &mut of.leakage_m3_s_pa);
    let mut arm = match of.lever {
        Lever::Constant(arm_m) => Some(arm_m).filter(|arm_m| arm_m.is_finite()),
        Lever::Linkage(_) => None,
    };
    let lever_arm = "lever of the cylinder about the pivot, where it is the same at every angle";
    maybe_number(v, &Field::new("lever_arm", lever_arm).unit("m").limit(ABOVE_0), &mut arm);
    valve(v, of);
    lever(v, arm, &mut of.lever);
}

fn valve(v: &mut dyn Visit, of: &mut CylinderKeys) {
    let positive = |key, unit, meaning| Field::new(key, meaning).unit(unit).limit(ABOVE_0);
    let flow = "of the fully open valve at rated_pressure_drop";
    v.number(&positive("rated_flow", "m^3/s", flow), &mut of.rated_flow_m3_s);
    let drop = "over both edges of the valve together, at which its flow is rated";
    v.number(&positive("rated_pressure_drop", "Pa", drop).or(RATED_DROP_PA), &mut of.rated_drop_pa);
    let control = "control at which the valve is fully open; it opens no further";
    v.number(&positive("rated_control", "V", control).or(RATED_CONTROL_V), &mut of.rated_control_v);
    let frequency = "natural frequency of the spool with its pilot stage";
    let frequency = positive("valve_frequency", "rad/s", frequency)
        .if_unknown("servo valves usually have 50 to 200 Hz, proportional valves 10 to 50 Hz");
    v.number(&frequency, &mut of.valve_frequency_rad_s);
    let damping = positive("valve_damping", "", "damping ratio of the spool").or(VALVE_DAMPING);
    v.number(&damping, &mut of.valve_damping);
    let overlap = "share of the full opening within which the lands cover the ports and nothing flows";
    v.number(&Field::new("overlap", overlap).limit(NumberRange::Between(0.0, 0.5)).or(0.0), &mut of.overlap);
}

/// Reads or lists the lever: a number, or the pins of a triangle. Tables come after the other keys.
fn lever(v: &mut dyn Visit, arm: Option<f64>, lever: &mut Lever) {
    let mut pins = match *lever {
        Lever::Constant(_) => None,
        Lever::Linkage(pins) => Some(pins),
    };
    let section = TableField::optional("linkage", "pins of the cylinder, whose lever then follows the angle");
    visit_optional(v, &section, &mut pins, BLANK_PINS, linkage);
    *lever = match pins {
        Some(pins) => Lever::Linkage(pins),
        None => Lever::Constant(arm.unwrap_or(1.0)),
    };
    match (arm, pins) {
        (None, None) => {
            let hint = "write lever_arm = \"0.4 m\", or a section [plant.cylinder.linkage] with arm, anchor and their angles";
            let allowed = "must be stated, or the section linkage in its place";
            v.complain("lever_arm", allowed, Some(hint.to_owned()));
        }
        (Some(_), Some(_)) => {
            let hint = "leave lever_arm out, or the section [plant.cylinder.linkage]";
            let allowed = "must not stand beside the section linkage, which gives the lever";
            v.complain("lever_arm", allowed, Some(hint.to_owned()));
        }
        (None, Some(pins)) if has_no_lever(&pins, 0.0) => {
            let allowed = "must have a lever at the angle 0: both pins lie on one line through the pivot";
            let hint = "move anchor_angle or arm_angle, so that they differ";
            v.complain("linkage", allowed, Some(hint.to_owned()));
        }
        _ => {}
    }
}

/// Returns whether pins turn the hub by less than a thousandth of the shorter of their radii at an angle, or the other way than at the angle 0.
fn has_no_lever(pins: &Linkage, angle_rad: f64) -> bool {
    Lever::Linkage(*pins).at(angle_rad).arm_m < LEAST_LEVER * pins.arm_m.min(pins.anchor_m)
}

/// The checks of a cylinder that no single key allows: its lever where the hub stands and may go, and what else only a motor has.
pub(super) fn fitting(findings: &mut Findings<'_>, project: &Project) {
    let plant = &project.plant;
    let Some(cylinder) = &plant.cylinder else { return };
    let mut complain = |path: &str, allowed: String, hint: &str| {
        let remark = Remark::new(DiagnosticKind::Conflict, path, allowed);
        findings.add(Severity::Error, remark.hint(Some(hint.to_owned())));
    };
    if let Lever::Linkage(pins) = &cylinder.lever {
        let stops = plant.loads.end_stops.iter().flat_map(|stops| [stops.lower_rad, stops.upper_rad]);
        let angles =
            stops.chain([project.model.operating_point.hub_angle_rad]).filter(|angle| angle.is_finite());
        let dead = angles.into_iter().find(|angle| has_no_lever(pins, *angle) && !has_no_lever(pins, 0.0));
        if let Some(angle) = dead {
            let allowed =
                format!("has no lever on the way to the angle {angle} rad, where the hub stands or may go");
            complain(
                "plant.cylinder.linkage",
                allowed,
                "turn anchor_angle or arm_angle, or bound the travel with [plant.end_stops]",
            );
        }
    }
    if plant.motor_friction.law.sticks() {
        let allowed =
            "must be a law with presliding: on a piston no law that truly sticks is simulated".to_owned();
        complain(
            "plant.friction.motor.model",
            allowed,
            "take \"dahl\" or \"lugre\" with a rest_stiffness, or put the friction at the pivot",
        );
    }
    if plant.drive_limits.limits_current() {
        let allowed = "must not limit a current or a motor: a cylinder has none".to_owned();
        complain("plant.drive_limits", allowed, "keep `slew` alone");
    }
    if !plant.learned.is_empty() {
        let allowed =
            "must not stand beside [plant.cylinder]: free functions act on a motor and its gear".to_owned();
        complain("plant.learned", allowed, "leave the section out");
    }
}

const BLANK_PINS: Linkage =
    Linkage { arm_m: f64::NAN, arm_angle_rad: 0.0, anchor_m: f64::NAN, anchor_angle_rad: f64::NAN };

fn linkage(v: &mut dyn Visit, of: &mut Linkage) {
    let length = |key, meaning| Field::new(key, meaning).unit("m").limit(ABOVE_0);
    let angle = |key, meaning| Field::new(key, meaning).unit("rad");
    v.number(&length("arm", "from the pivot to the pin on the elevated mass"), &mut of.arm_m);
    v.number(
        &angle("arm_angle", "of that pin, from the beam, positive upward").or(0.0),
        &mut of.arm_angle_rad,
    );
    v.number(&length("anchor", "from the pivot to the pin on the platform"), &mut of.anchor_m);
    v.number(&angle("anchor_angle", "of that pin, from forward, positive upward"), &mut of.anchor_angle_rad);
}
