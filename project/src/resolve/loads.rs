//! The loads of a machine beside its weight, and the limits of what its drive can do for long: `[plant.equilibrator]`, `[plant.end_stops]`, `[plant.recoil]` and
//! `[plant.drive_limits]`.

use counterpoise_models::loads::equilibrator::{Action, Force, Gas};
use counterpoise_models::loads::{EndStops, Equilibrator, Recoil};
use counterpoise_models::{AxisKind, DriveLimits, MotorHeat, Parameters};

use crate::file::field::{Field, NumberRange, TableField};
use crate::file::visit::{Count, NamedChoice, Presence, Visit, choose, visit_optional};

const AT_LEAST_0: NumberRange = NumberRange::AtLeast(0.0);
const ABOVE_0: NumberRange = NumberRange::Above(0.0);
/// Temperature of the charge of a gas, and of a machine at rest, K: 20 degrees Celsius.
const ROOM_K: f64 = 293.15;
/// Polytropic exponent of strokes that are neither fast nor slow; between 1 (isothermal) and 1.4 (adiabatic).
const EXPONENT: f64 = 1.2;

impl NamedChoice for Action {
    const NAMES: &'static [(&'static str, Self)] = &[("pull", Self::Pull), ("push", Self::Push)];
}

/// The source of the force of an equilibrator.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Spring,
    Gas,
}

impl NamedChoice for Kind {
    const NAMES: &'static [(&'static str, Self)] = &[("spring", Self::Spring), ("gas", Self::Gas)];
}

/// Reads or lists equilibrator, stops and recoil.
pub(super) fn loads(v: &mut dyn Visit, plant: &mut Parameters) {
    let section = TableField::optional(
        "equilibrator",
        "spring or gas strut between elevated mass and platform that holds the out-of-balance",
    );
    visit_optional(v, &section, &mut plant.loads.equilibrator, blank_equilibrator(), equilibrator);
    let section = TableField::optional("end_stops", "stops at the ends of the travel on the platform");
    visit_optional(v, &section, &mut plant.loads.end_stops, BLANK_STOPS, end_stops);
    let section = TableField::optional(
        "recoil",
        "what the machine fires: it does so on the road, or while heave and pitch move together",
    );
    visit_optional(v, &section, &mut plant.loads.recoil, blank_recoil(), recoil);
    let turning =
        [("equilibrator", plant.loads.equilibrator.is_some()), ("recoil", plant.loads.recoil.is_some())];
    for (key, _) in turning.into_iter().filter(|(_, there)| *there && plant.axis == AxisKind::Linear) {
        v.complain(key, "must not stand where axis = \"linear\": it acts about a trunnion", None);
    }
}

fn blank_equilibrator() -> Equilibrator {
    Equilibrator {
        arm_m: f64::NAN,
        arm_angle_rad: 0.0,
        anchor_m: f64::NAN,
        anchor_angle_rad: 0.0,
        factor: 1.0,
        force: Force::Spring { stiffness_n_m: f64::NAN, free_length_m: f64::NAN },
    }
}

fn equilibrator(v: &mut dyn Visit, of: &mut Equilibrator) {
    let length = |key, meaning| Field::new(key, meaning).unit("m").limit(ABOVE_0);
    let angle = |key, meaning| Field::new(key, meaning).unit("rad");
    v.number(&length("arm", "from the trunnion to the pin on the elevated mass"), &mut of.arm_m);
    v.number(
        &angle("arm_angle", "of that pin, from the beam, positive upward").or(0.0),
        &mut of.arm_angle_rad,
    );
    v.number(&length("anchor", "from the trunnion to the pin on the platform"), &mut of.anchor_m);
    v.number(&angle("anchor_angle", "of that pin, from forward, positive upward"), &mut of.anchor_angle_rad);
    let factor = Field::new("factor", "factor on the force; 1 as stated").limit(AT_LEAST_0);
    v.number(&factor.or(1.0), &mut of.factor);
    let mut kind = if matches!(of.force, Force::Spring { .. }) { Kind::Spring } else { Kind::Gas };
    let field = Field::new("kind", "what makes the force: a coil spring that pulls, or a gas");
    choose(v, &field.or_text("spring"), &mut kind);
    match kind {
        Kind::Spring => spring(v, &mut of.force),
        Kind::Gas => gas(v, &mut of.force),
    }
}

fn spring(v: &mut dyn Visit, force: &mut Force) {
    let (mut stiffness_n_m, mut free_length_m) = match *force {
        Force::Spring { stiffness_n_m, free_length_m } => (stiffness_n_m, free_length_m),
        Force::Gas(_) => (f64::NAN, f64::NAN),
    };
    let stiffness = Field::new("stiffness", "of the spring").unit("N/m").limit(ABOVE_0);
    v.number(&stiffness, &mut stiffness_n_m);
    let length = Field::new("free_length", "length between the pins at which the spring is slack").unit("m");
    v.number(&length, &mut free_length_m);
    *force = Force::Spring { stiffness_n_m, free_length_m };
}

fn gas(v: &mut dyn Visit, force: &mut Force) {
    let mut gas = match *force {
        Force::Gas(gas) => gas,
        Force::Spring { .. } => BLANK_GAS,
    };
    let field = Field::new("acts", "whether the cylinder pulls its pins together or pushes them apart");
    choose(v, &field.or_text("pull"), &mut gas.acts);
    let positive = |key, unit, meaning| Field::new(key, meaning).unit(unit).limit(ABOVE_0);
    v.number(&positive("pressure", "Pa", "absolute pressure of the charge"), &mut gas.pressure_pa);
    v.number(&positive("area", "m^2", "area of the piston"), &mut gas.area_m2);
    v.number(&positive("volume", "m^3", "volume of the gas at charge_length"), &mut gas.volume_m3);
    v.number(
        &positive("charge_length", "m", "length between the pins at which it was charged"),
        &mut gas.length_m,
    );
    let field = positive("exponent", "", "polytropic exponent: 1 isothermal, 1.4 adiabatic");
    v.number(&field.or(EXPONENT), &mut gas.exponent);
    v.number(
        &positive("charge_temperature", "K", "of the gas at its charge").or(ROOM_K),
        &mut gas.charge_temperature_k,
    );
    v.number(&positive("temperature", "K", "of the gas").or(ROOM_K), &mut gas.temperature_k);
    *force = Force::Gas(gas);
}

const BLANK_GAS: Gas = Gas {
    acts: Action::Pull,
    pressure_pa: f64::NAN,
    area_m2: f64::NAN,
    volume_m3: f64::NAN,
    length_m: f64::NAN,
    exponent: EXPONENT,
    charge_temperature_k: ROOM_K,
    temperature_k: ROOM_K,
};

const BLANK_STOPS: EndStops =
    EndStops { lower_rad: f64::NAN, upper_rad: f64::NAN, stiffness_nm_rad: f64::NAN, dissipation_s_rad: 0.0 };

fn end_stops(v: &mut dyn Visit, stops: &mut EndStops) {
    v.number(&Field::new("lower", "angle at which the lower stop is met").unit("rad"), &mut stops.lower_rad);
    v.number(&Field::new("upper", "angle at which the upper stop is met").unit("rad"), &mut stops.upper_rad);
    let stiffness = Field::new("stiffness", "of a stop").unit("N m/rad").limit(ABOVE_0);
    v.number(&stiffness, &mut stops.stiffness_nm_rad);
    let dissipation = Field::new(
        "dissipation",
        "c in the torque k x depth x (1 + c x rate): the rebound has 1 - 2/3 c x rate of the rate",
    );
    v.number(&dissipation.unit("s/rad").limit(AT_LEAST_0).or(0.0), &mut stops.dissipation_s_rad);
}

fn blank_recoil() -> Recoil {
    Recoil {
        shots_s: Vec::new(),
        impulse_ns: f64::NAN,
        shot_time_s: f64::NAN,
        mass_kg: f64::NAN,
        length_m: f64::NAN,
        run_out_s: f64::NAN,
        height_m: 0.0,
        bore_offset_m: 0.0,
        ahead_m: 0.0,
    }
}

fn recoil(v: &mut dyn Visit, recoil: &mut Recoil) {
    let shots = Field::new("shots", "instants of the shots since the start of a run, rising").unit("s");
    v.numbers(&shots, Count::AtLeastOne, &mut recoil.shots_s);
    let positive = |key, unit, meaning| Field::new(key, meaning).unit(unit).limit(ABOVE_0);
    v.number(&positive("impulse", "N s", "of a shot"), &mut recoil.impulse_ns);
    let time = positive("shot_time", "s", "time of the shot in the barrel with the after-effect of its gas");
    v.number(&time, &mut recoil.shot_time_s);
    v.number(&positive("mass", "kg", "recoiling mass"), &mut recoil.mass_kg);
    v.number(&positive("length", "m", "length of the recoil"), &mut recoil.length_m);
    v.number(&positive("run_out", "s", "time in which the mass runs out again"), &mut recoil.run_out_s);
    let length = |key, meaning| Field::new(key, meaning).unit("m").or(0.0);
    let height = "of the recoiling mass's centre above the trunnion's axis, across the bore";
    v.number(&length("height", height), &mut recoil.height_m);
    let offset = "of the bore's axis above the recoiling mass's centre";
    v.number(&length("bore_offset", offset), &mut recoil.bore_offset_m);
    let ahead = "distance of the recoiling mass's centre ahead of the trunnion, in battery";
    v.number(&length("ahead", ahead), &mut recoil.ahead_m);
}

/// Reads or lists the limits of the drive.
pub(super) fn drive_limits(v: &mut dyn Visit, plant: &mut Parameters) {
    let limits = &mut plant.drive_limits;
    let there = *limits != DriveLimits::default();
    let section = TableField::optional(
        "drive_limits",
        "limits of the drive beside the amplifier's voltage and peak current",
    );
    if !v.enter(&section, Presence::from(there)) {
        *limits = DriveLimits::default();
        return;
    }
    let limit = |key, unit, meaning| Field::new(key, meaning).unit(unit).limit(ABOVE_0).or(f64::INFINITY);
    v.number(&limit("slew", "V/s", "largest change of the control; none if absent"), &mut limits.slew_v_s);
    let speed = "speed of the motor above which it is not driven on; none if absent";
    v.number(&limit("motor_speed", "rad/s", speed), &mut limits.motor_rate_rad_s);
    let power = "electrical power that the supply gives; no limit if absent";
    v.number(&limit("supply_power", "W", power), &mut limits.supply_power_w);
    let current = "current that the amplifier bears for ever (i^2 t); no limit if absent";
    v.number(&limit("continuous_current", "A", current), &mut limits.continuous_current_a);
    let time = Field::new("overload_time", "time constant of the average of the squared current");
    v.number(&time.unit("s").limit(ABOVE_0).or(1.0), &mut limits.overload_time_s);
    let section = TableField::optional("heat", "winding and housing of the motor as stores of heat");
    visit_optional(v, &section, &mut limits.heat, BLANK_HEAT, motor_heat);
    v.leave();
}

const BLANK_HEAT: MotorHeat = MotorHeat {
    winding_k_w: f64::NAN,
    housing_k_w: f64::NAN,
    winding_time_s: f64::NAN,
    housing_time_s: f64::NAN,
    ambient_k: ROOM_K,
    start_k: ROOM_K,
    limit_k: f64::NAN,
};

fn motor_heat(v: &mut dyn Visit, heat: &mut MotorHeat) {
    let positive = |key, unit, meaning| Field::new(key, meaning).unit(unit).limit(ABOVE_0);
    let winding = "thermal resistance from winding to housing";
    v.number(&positive("winding_resistance", "K/W", winding), &mut heat.winding_k_w);
    let housing = "thermal resistance from housing to ambience";
    v.number(&positive("housing_resistance", "K/W", housing), &mut heat.housing_k_w);
    v.number(
        &positive("winding_time", "s", "thermal time constant of the winding"),
        &mut heat.winding_time_s,
    );
    v.number(
        &positive("housing_time", "s", "thermal time constant of the housing"),
        &mut heat.housing_time_s,
    );
    v.number(&positive("ambient", "K", "temperature of the ambience").or(ROOM_K), &mut heat.ambient_k);
    v.number(&positive("start", "K", "temperature of the motor at the start").or(ROOM_K), &mut heat.start_k);
    v.number(&positive("limit", "K", "largest temperature of the winding"), &mut heat.limit_k);
}
