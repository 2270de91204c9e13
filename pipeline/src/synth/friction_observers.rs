//! From a law of the friction toolbox to the observer that runs in the controller.

use counterpoise_controller::ObserverLaw;
use counterpoise_models::friction::StribeckLevel;
use counterpoise_models::friction::bristle::MEAN_DEFLECTION;
use counterpoise_models::{Friction, FrictionLaw, StribeckCurve};
use counterpoise_synth::{FrictionSide, ObservedFriction};

use crate::tolerance::SAME_FRICTION_LEVEL;
use counterpoise_project::resolve::synthesis_options::ObserverFriction;

/// Stiffness at rest; a law without one breaks away within this angle in the observer, rad.
const BREAKAWAY_RAD: f64 = 5e-4;
/// Rates over the Stribeck rate at which the observer has points of the level's curve.
const LEVEL_AT: [f64; 14] = [0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0, 6.0, 10.0];

/// Returns the friction as an observer follows it: its law with the Stribeck curve of its level; what the level does
/// with angle, load, warmth and direction is left out. `None` if there is no dry friction.
///
/// Laws that truly stick have no state: their sign is softened below `sign_rate_rad_s` (Karnopp's below its own stick
/// rate). Bristles become Dahl's law of their stiffness.
pub(crate) fn observer_friction(
    name: &str,
    side: FrictionSide,
    friction: &Friction,
    model: ObserverFriction,
    sign_rate_rad_s: f64,
) -> Option<ObservedFriction> {
    let coulomb_nm = friction.coulomb_nm();
    if coulomb_nm.is_nan() || coulomb_nm <= 0.0 {
        return None;
    }
    let (law, rest_stiffness_nm_rad, curve) = match model {
        ObserverFriction::Dahl => (ObserverLaw::Dahl, rest_stiffness_nm_rad(&friction.law), None),
        ObserverFriction::OwnLaw => by_itself(friction, sign_rate_rad_s),
    };
    let level = curve.map_or(Vec::new(), |curve| level(friction, curve));
    Some(ObservedFriction {
        name: name.to_owned(),
        side,
        law,
        coulomb_nm,
        rest_stiffness_nm_rad,
        level,
        viscous_nm_s_rad: 0.0,
    })
}

fn by_itself(friction: &Friction, sign_rate_rad_s: f64) -> (ObserverLaw, f64, Option<StribeckCurve>) {
    let gaussian = Some(StribeckCurve::Gaussian);
    match friction.law {
        FrictionLaw::None => (ObserverLaw::Dahl, 0.0, None),
        FrictionLaw::Dahl { rest_stiffness_nm_rad, exponent: 1.0, .. } => {
            (ObserverLaw::Dahl, rest_stiffness_nm_rad, gaussian)
        }
        FrictionLaw::Dahl { rest_stiffness_nm_rad, exponent, .. } => {
            (ObserverLaw::DahlPower { exponent }, rest_stiffness_nm_rad, gaussian)
        }
        FrictionLaw::Lugre { bristle_stiffness_nm_rad, bristle_damping_nm_s_rad, .. } => {
            let law = ObserverLaw::Lugre { damping_nm_s_rad: bristle_damping_nm_s_rad };
            (law, bristle_stiffness_nm_rad, gaussian)
        }
        FrictionLaw::ResetIntegrator { coulomb_nm, deflection_rad, damping_nm_s_rad } => {
            let static_ratio = friction.static_ratio;
            let law = ObserverLaw::ResetIntegrator { static_ratio, damping_nm_s_rad };
            (law, coulomb_nm / deflection_rad, None)
        }
        FrictionLaw::Bristle { coulomb_nm, bond_rad, .. } => {
            (ObserverLaw::Dahl, coulomb_nm / (MEAN_DEFLECTION * bond_rad), gaussian)
        }
        FrictionLaw::Walrath { time_constant_s, smoothing_rate_rad_s, .. } => {
            let law = ObserverLaw::Walrath { sign_rate_rad_s: smoothing_rate_rad_s, time_constant_s };
            (law, 0.0, None)
        }
        FrictionLaw::Coulomb { .. } => (ObserverLaw::Sliding { sign_rate_rad_s }, 0.0, None),
        FrictionLaw::Karnopp { stick_rate_rad_s, .. } => {
            (ObserverLaw::Sliding { sign_rate_rad_s: stick_rate_rad_s }, 0.0, None)
        }
        FrictionLaw::Stribeck { curve, .. } => (ObserverLaw::Sliding { sign_rate_rad_s }, 0.0, Some(curve)),
    }
}

/// Returns points of g(w) / F_c; `None` if it is constant.
fn level(friction: &Friction, curve: StribeckCurve) -> Vec<[f64; 2]> {
    let (coulomb_nm, rate) = (friction.coulomb_nm(), friction.stribeck_rate_rad_s);
    let level = StribeckLevel::new(coulomb_nm, friction.static_ratio, rate, curve);
    let mut points: Vec<[f64; 2]> = Vec::new();
    for at in LEVEL_AT {
        let point = [at * rate, level.at(at * rate) / coulomb_nm];
        if points.last().is_none_or(|before| (before[1] - point[1]).abs() > SAME_FRICTION_LEVEL) {
            points.push(point);
        }
    }
    if points.len() < 2 { Vec::new() } else { points }
}

/// Returns the stiffness at rest with which Dahl's law stands for a law; of a law without one, what lets it break
/// away within half a milliradian.
pub fn rest_stiffness_nm_rad(law: &FrictionLaw) -> f64 {
    match law {
        FrictionLaw::Dahl { rest_stiffness_nm_rad, .. } => *rest_stiffness_nm_rad,
        FrictionLaw::Lugre { bristle_stiffness_nm_rad, .. } => *bristle_stiffness_nm_rad,
        other => other.coulomb_nm() / BREAKAWAY_RAD,
    }
}
