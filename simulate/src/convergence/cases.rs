//! Every law of friction, and contact, on one machine.

use crate::Error;
use counterpoise_models::plant::Body;
use counterpoise_models::{Friction, FrictionLaw, Plant, StribeckCurve};

/// A machine whose error is looked at over the step.
#[derive(Debug, Clone)]
pub struct Case {
    /// The law of friction at its pivot, or `contact`.
    pub name: &'static str,
    /// `true` if the law truly sticks.
    pub sticks: bool,
    /// The machine.
    pub plant: Plant,
    /// Control that sets it in motion, V, beside the one that holds it.
    pub control_v: f64,
}

/// Deflection of presliding and of bonds, rad.
const DEFLECTION_RAD: f64 = 5e-4;
/// Rate at which Stribeck's curves have fallen, and that of Walrath's smoothed sign, rad/s.
const FALLEN_RAD_S: f64 = 0.05;
/// Breakaway over sliding level.
const STICTION: f64 = 1.3;
/// Torque of the control over the sliding level.
const DRIVEN: f64 = 4.4;
/// Share of the weight's moment that is the sliding level of a machine without dry friction at its pivot.
const LEVEL_SHARE: f64 = 0.1;
/// Share of the weight that is left where teeth part and meet.
const BALANCED: f64 = 0.01;
/// Least gap of the teeth there, rad.
const GAP_RAD: f64 = 5e-4;

/// Returns the machine with every law in turn at its pivot, at its own level, without friction at the motor; and nearly balanced with a gap
/// between its teeth.
///
/// # Errors
/// A machine that a law does not fit.
pub fn convergence_cases(plant: &Plant) -> Result<Vec<Case>, Error> {
    let own = plant.parameters();
    let weight = plant.body().out_of_balance_kg_m.abs() * own.gravity_m_s2.abs();
    let level = [own.pivot_friction.coulomb_nm(), LEVEL_SHARE * weight, 1.0];
    let level = level.into_iter().find(|nm| *nm > 0.0).unwrap_or(1.0);
    let per_volt =
        own.gearbox.ratio * own.motor.torque_constant_nm_a * own.amplifier.stall_gain_a_v(&own.motor);
    let control_v = DRIVEN * level / per_volt;
    let mut out = Vec::new();
    for (name, law, static_ratio) in laws(level) {
        let sticks = law.has_true_stick();
        let plant = with_law(plant, law, static_ratio)?;
        out.push(Case { name, sticks, plant, control_v });
    }
    out.push(Case {
        name: "contact",
        sticks: false,
        plant: gaping_teeth(plant, level)?,
        control_v: -control_v,
    });
    Ok(out)
}

/// Each law by name, with its breakaway over its sliding level.
fn laws(coulomb_nm: f64) -> Vec<(&'static str, FrictionLaw, f64)> {
    let curve = |curve| FrictionLaw::Stribeck { coulomb_nm, curve };
    let rest_stiffness_nm_rad = coulomb_nm / DEFLECTION_RAD;
    let dahl = |exponent| FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad, exponent };
    let lugre = FrictionLaw::Lugre {
        coulomb_nm,
        bristle_stiffness_nm_rad: rest_stiffness_nm_rad,
        bristle_damping_nm_s_rad: 2e-3 * rest_stiffness_nm_rad,
    };
    let reset =
        FrictionLaw::ResetIntegrator { coulomb_nm, deflection_rad: DEFLECTION_RAD, damping_nm_s_rad: 0.0 };
    let walrath =
        FrictionLaw::Walrath { coulomb_nm, time_constant_s: 0.02, smoothing_rate_rad_s: 0.4 * FALLEN_RAD_S };
    vec![
        ("Coulomb", FrictionLaw::Coulomb { coulomb_nm }, 1.0),
        ("Coulomb with stiction", FrictionLaw::Coulomb { coulomb_nm }, STICTION),
        ("Karnopp", FrictionLaw::Karnopp { coulomb_nm, stick_rate_rad_s: 0.02 * FALLEN_RAD_S }, STICTION),
        ("Tustin", curve(StribeckCurve::Tustin), STICTION),
        ("Gaussian", curve(StribeckCurve::Gaussian), STICTION),
        ("exponential", curve(StribeckCurve::Exponential { exponent: 1.5 }), STICTION),
        ("Lorentzian", curve(StribeckCurve::Lorentzian), STICTION),
        ("polynomial", curve(StribeckCurve::Polynomial { coefficients: [-0.3, 0.2, -0.05] }), STICTION),
        ("Dahl", dahl(1.0), 1.0),
        ("Dahl, exponent 2", dahl(2.0), 1.0),
        ("LuGre", lugre, STICTION),
        ("reset integrator", reset, 1.0),
        ("Walrath", walrath, 1.0),
        ("bristles", FrictionLaw::Bristle { coulomb_nm, bristles: 12, bond_rad: 2.0 * DEFLECTION_RAD }, 1.0),
    ]
}

fn with_law(plant: &Plant, law: FrictionLaw, static_ratio: f64) -> Result<Plant, Error> {
    let mut parameters = plant.parameters().clone();
    let viscous = |f: &Friction| f.viscous_nm_s_rad;
    parameters.motor_friction =
        Friction::with_viscous_part(FrictionLaw::None, viscous(&parameters.motor_friction));
    parameters.pivot_friction = Friction {
        static_ratio,
        stribeck_rate_rad_s: FALLEN_RAD_S,
        ..Friction::with_viscous_part(law, viscous(&parameters.pivot_friction))
    };
    Ok(Plant::with_whole_body(&parameters, plant.body().clone())?)
}

/// Returns the machine nearly balanced, its teeth with a gap.
fn gaping_teeth(plant: &Plant, coulomb_nm: f64) -> Result<Plant, Error> {
    let rest_stiffness_nm_rad = coulomb_nm / DEFLECTION_RAD;
    let law = FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad, exponent: 1.0 };
    let mut parameters = with_law(plant, law, 1.0)?.parameters().clone();
    parameters.gearbox.backlash_rad = parameters.gearbox.backlash_rad.max(GAP_RAD);
    let mut body = Body { vertical_offset_kg_m: 0.0, ..plant.body().clone() };
    body.out_of_balance_kg_m *= BALANCED;
    body.modes.iter_mut().for_each(|mode| mode.load_share_kg_m *= BALANCED);
    Ok(Plant::with_whole_body(&parameters, body)?)
}
