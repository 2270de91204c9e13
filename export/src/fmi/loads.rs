//! Equilibrator, stops, recoil, a hydraulic cylinder, and the limits of the drive, as the plant unit's templates take them.

use counterpoise_models::loads::equilibrator::{ATMOSPHERE_PA, Force};
use counterpoise_models::loads::{EndStops, Equilibrator, Recoil};
use counterpoise_models::parameters::cylinder::{LAMINAR_SHARE, Lever, pulling_sense};
use counterpoise_models::plant::Plant;
use counterpoise_models::{COPPER_PER_K, FOLD_K, FOLD_SHARE, MotorHeat, RESISTANCE_AT_K};
use minijinja::{Value, context};

use super::machine::number;

/// Equilibrator, stops and recoil; each undefined if there is none.
pub(super) fn loads(plant: &Plant) -> Value {
    let loads = &plant.parameters().loads;
    context! {
        any => !loads.is_empty(),
        equilibrator => loads.equilibrator.as_ref().map(equilibrator),
        stops => loads.end_stops.as_ref().map(stops),
        recoil => loads.recoil.as_ref().map(recoil),
    }
}

fn equilibrator(of: &Equilibrator) -> Value {
    let geometry = context! {
        between => number(of.anchor_angle_rad - of.arm_angle_rad),
        arms => number(of.arm_m * of.anchor_m),
        squares => number(of.arm_m * of.arm_m + of.anchor_m * of.anchor_m),
        factor => number(of.factor),
    };
    let force = match of.force {
        Force::Spring { stiffness_n_m, free_length_m } => context! {
            gas => false, stiffness => number(stiffness_n_m), free_length => number(free_length_m),
        },
        Force::Gas(gas) => context! {
            gas => true,
            signed_area => number(gas.signed_area_m2()),
            volume => number(gas.volume_m3),
            at_length => number(gas.length_m),
            pressure => number(gas.warm_pressure_pa()),
            exponent => number(gas.exponent),
            atmosphere => number(ATMOSPHERE_PA),
        },
    };
    context! { ..geometry, ..force }
}

fn stops(of: &EndStops) -> Value {
    context! {
        lower => number(of.lower_rad),
        upper => number(of.upper_rad),
        stiffness => number(of.stiffness_nm_rad),
        dissipation => number(of.dissipation_s_rad),
    }
}

fn recoil(of: &Recoil) -> Value {
    context! {
        shots => of.shots_s.iter().map(|shot| number(*shot)).collect::<Vec<_>>(),
        shot_time => number(of.shot_time_s),
        stopping => number(of.stopping_s()),
        rate => number(of.impulse_ns / of.mass_kg),
        mass => number(of.mass_kg),
        length => number(of.length_m),
        run_out => number(of.run_out_s),
        height => number(of.height_m),
        bore_offset => number(of.bore_offset_m),
        ahead => number(of.ahead_m),
    }
}

/// Returns the valve and the lever of a hydraulic cylinder; undefined without one.
pub(super) fn cylinder(plant: &Plant) -> Option<Value> {
    let cylinder = plant.parameters().cylinder.as_ref()?;
    let valve = context! {
        supply => number(cylinder.supply_mpa),
        overlap => number(cylinder.overlap_l_s),
        frequency => number(cylinder.valve_frequency_rad_s),
        damping => number(cylinder.valve_damping),
        laminar => number(LAMINAR_SHARE),
    };
    let lever = match cylinder.lever {
        Lever::Constant(_) => context! { linkage => false },
        Lever::Linkage(pins) => context! {
            linkage => true,
            between => number(pins.included_angle_rad(0.0)),
            arms => number(pins.arm_m * pins.anchor_m),
            squares => number(pins.arm_m * pins.arm_m + pins.anchor_m * pins.anchor_m),
            sense => number(pulling_sense(&pins)),
        },
    };
    Some(context! { ..valve, ..lever })
}

/// The limits of the drive.
pub(super) fn limits(plant: &Plant) -> Value {
    let p = plant.parameters();
    let limits = &p.drive_limits;
    let heat = |heat: &MotorHeat| {
        context! {
            lasting => number(heat.lasting_current_a(p.motor.resistance_ohm)),
            limit => number(heat.limit_k),
            start => number(heat.start_k),
            ambient => number(heat.ambient_k),
            winding_k_w => number(heat.winding_k_w),
            housing_k_w => number(heat.housing_k_w),
            winding_time => number(heat.winding_time_s),
            housing_time => number(heat.housing_time_s),
            copper => number(COPPER_PER_K),
            stated_at => number(RESISTANCE_AT_K),
        }
    };
    context! {
        current => limits.limits_current(),
        slew => limits.slew_v_s.is_finite().then(|| number(limits.slew_v_s)),
        speed => limits.motor_rate_rad_s.is_finite(),
        motor_rate => number(limits.motor_rate_rad_s),
        power => limits.supply_power_w.is_finite(),
        supply_power => number(limits.supply_power_w),
        overload => limits.continuous_current_a.is_finite(),
        continuous => number(limits.continuous_current_a),
        overload_time => number(limits.overload_time_s),
        heat => limits.heat.as_ref().map(heat),
        fold_share => number(FOLD_SHARE),
        fold_k => number(FOLD_K),
    }
}
