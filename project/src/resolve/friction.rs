//! Friction sections: the law by its name, then the keys of that law, then what every law may have.

use counterpoise_models::friction::ranges;
use counterpoise_models::{Friction, FrictionLaw, Ripple, StribeckCurve};

use crate::file::field::{Field, NumberRange, TableField};
use crate::file::visit::{Count, NamedChoice, Presence, Visit, choose};

/// The name of a law.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Law {
    None,
    Dahl,
    Lugre,
    Coulomb,
    ResetIntegrator,
    Stribeck,
    Karnopp,
    Walrath,
    Bristle,
}

impl NamedChoice for Law {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("none", Self::None),
        ("dahl", Self::Dahl),
        ("lugre", Self::Lugre),
        ("coulomb", Self::Coulomb),
        ("reset-integrator", Self::ResetIntegrator),
        ("stribeck", Self::Stribeck),
        ("karnopp", Self::Karnopp),
        ("walrath", Self::Walrath),
        ("bristle", Self::Bristle),
    ];
}

/// The name of a Stribeck curve.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Curve {
    Tustin,
    Gaussian,
    Exponential,
    Lorentzian,
    Polynomial,
}

impl NamedChoice for Curve {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("tustin", Self::Tustin),
        ("gaussian", Self::Gaussian),
        ("exponential", Self::Exponential),
        ("lorentzian", Self::Lorentzian),
        ("polynomial", Self::Polynomial),
    ];
}

const MODEL: Field = Field::new("model", "law of the dry friction").or_text("none").show_default();
const COULOMB: Field = Field::new("coulomb", "level of the dry friction while sliding")
    .unit("N m")
    .limit(NumberRange::of(ranges::COULOMB));
const REST_STIFFNESS: Field = Field::new("rest_stiffness", "stiffness of the friction at rest (presliding)")
    .unit("N m/rad")
    .limit(NumberRange::of(ranges::REST_STIFFNESS));
const EXPONENT: Field =
    Field::new("exponent", "exponent of the Dahl law").limit(NumberRange::of(ranges::EXPONENT)).or(1.0);
const BRISTLE_STIFFNESS: Field = Field::new("bristle_stiffness", "stiffness of the bristles")
    .unit("N m/rad")
    .limit(NumberRange::of(ranges::BRISTLE_STIFFNESS));
const BRISTLE_DAMPING: Field = Field::new("bristle_damping", "damping of the bristles")
    .unit("N m s/rad")
    .limit(NumberRange::of(ranges::BRISTLE_DAMPING));
const DEFLECTION: Field = Field::new("deflection", "deflection at which the bond breaks")
    .unit("rad")
    .limit(NumberRange::of(ranges::DEFLECTION));
const DAMPING: Field =
    Field::new("damping", "damping of the bond").unit("N m s/rad").limit(NumberRange::of(ranges::DAMPING));
const CURVE: Field = Field::new("curve", "how the level falls as the rate rises").or_text("gaussian");
const CURVE_EXPONENT: Field =
    Field::new("curve_exponent", "exponent of the curve").limit(NumberRange::of(ranges::CURVE_EXPONENT));
const COEFFICIENTS: Field = Field::new(
    "coefficients",
    "coefficients c1, c2, c3 of the polynomial in the rate divided by stribeck_rate",
);
const STICK_RATE: Field = Field::new("stick_rate", "half-width of the band of rates that counts as rest")
    .unit("rad/s")
    .limit(NumberRange::of(ranges::STICK_RATE));
const TIME_CONSTANT: Field = Field::new("time_constant", "time constant of the lag of the dry friction")
    .unit("s")
    .limit(NumberRange::of(ranges::TIME_CONSTANT));
const SMOOTHING_RATE: Field = Field::new("smoothing_rate", "rate over which the sign is smoothed")
    .unit("rad/s")
    .limit(NumberRange::of(ranges::SMOOTHING_RATE));
const BRISTLES: Field = Field::new("bristles", "number of bristles").limit(NumberRange::of(ranges::BRISTLES));
const BOND: Field =
    Field::new("bond", "deflection at which a bond breaks").unit("rad").limit(NumberRange::of(ranges::BOND));

const VISCOUS: Field = Field::new("viscous", "viscous coefficient")
    .unit("N m s/rad")
    .limit(NumberRange::of(ranges::VISCOUS))
    .or(0.0);
const STATIC_RATIO: Field = Field::new("static_ratio", "ratio of the breakaway level to the Coulomb level")
    .limit(NumberRange::of(ranges::STATIC_RATIO_OF_BREAKAWAY))
    .or(1.0);
const STRIBECK_RATE: Field =
    Field::new("stribeck_rate", "rate at which the excess over the sliding level has fallen to 1/e")
        .unit("rad/s")
        .limit(NumberRange::of(ranges::STRIBECK_RATE))
        .or(0.01);
const ASYMMETRY: Field = Field::new(
    "asymmetry",
    "half the difference between the Coulomb levels of the two directions, as a fraction",
)
.limit(NumberRange::of(ranges::ASYMMETRY))
.or(0.0);
const VISCOUS_ASYMMETRY: Field = Field::new(
    "viscous_asymmetry",
    "half the difference between the viscous coefficients of the two directions, as a fraction",
)
.limit(NumberRange::of(ranges::ASYMMETRY))
.or(0.0);
const QUADRATIC: Field = Field::new("quadratic", "coefficient of quadratic drag")
    .unit("N m s^2/rad^2")
    .limit(NumberRange::of(ranges::QUADRATIC))
    .or(0.0);
const LOAD: Field = Field::new("load_coefficient", "relative growth of the Coulomb level per N m of load")
    .limit(NumberRange::of(ranges::LOAD_COEFFICIENT))
    .or(0.0);
const WARM_UP: Field =
    Field::new("warm_up", "fraction by which the Coulomb level changes as the joint warms up")
        .limit(NumberRange::of(ranges::WARM_UP))
        .or(0.0);
const WARM_UP_TIME: Field = Field::new("warm_up_time", "time constant of the warm-up")
    .unit("s")
    .limit(NumberRange::of(ranges::WARM_UP_TIME))
    .or(1.0);
const POSITION_RIPPLE: TableField =
    TableField::inline("position_ripple", "variation of the Coulomb level with the angle, as a fraction");

/// Reads or lists a friction section.
pub(crate) fn friction(v: &mut dyn Visit, value: &mut Friction) {
    law(v, &mut value.law);
    v.number(&VISCOUS, &mut value.viscous_nm_s_rad);
    v.number(&STATIC_RATIO, &mut value.static_ratio);
    v.number(&STRIBECK_RATE, &mut value.stribeck_rate_rad_s);
    v.number(&ASYMMETRY, &mut value.asymmetry);
    v.number(&VISCOUS_ASYMMETRY, &mut value.viscous_asymmetry);
    v.number(&QUADRATIC, &mut value.quadratic_nm_s2_rad2);
    v.number(&LOAD, &mut value.load_coefficient);
    v.number(&WARM_UP, &mut value.warm_up);
    v.number(&WARM_UP_TIME, &mut value.warm_up_time_s);
    ripple(v, &POSITION_RIPPLE, &mut value.position_ripple, "");
}

/// Reads or lists a ripple with its amplitude in a unit; without one, the machine has none.
pub(crate) fn ripple(v: &mut dyn Visit, section: &TableField, value: &mut Ripple, unit: &'static str) {
    let amplitude = Field::new("amplitude", "amplitude of the ripple").unit(unit).or(0.0);
    if !v.enter(section, Presence::Present) {
        v.assume(&Field { key: section.key, ..amplitude }, value.amplitude);
        return;
    }
    v.number(&amplitude, &mut value.amplitude);
    v.number(
        &Field::new("order", "periods per turn").limit(NumberRange::AtLeast(0.0)).or(1.0),
        &mut value.order,
    );
    v.number(&Field::new("phase", "phase at angle zero").unit("rad").or(0.0), &mut value.phase_rad);
    v.leave();
}

/// Reads or lists a dry friction as it was identified: a law, Dahl's if none is named, and its Stribeck level.
pub(crate) fn identified_friction(v: &mut dyn Visit, value: &mut Friction) {
    named_law(v, &MODEL.or_text("dahl"), &mut value.law);
    v.number(&STATIC_RATIO, &mut value.static_ratio);
    v.number(&STRIBECK_RATE, &mut value.stribeck_rate_rad_s);
}

/// Returns an identified friction still to be read.
pub(crate) fn blank_identified() -> Friction {
    Friction::with_viscous_part(blank(Law::Dahl), 0.0)
}

/// Reads or lists the law of a joint. Where none is named, a stiffness at rest means Dahl's law, a level alone Coulomb's, and
/// neither no dry friction.
fn law(v: &mut dyn Visit, value: &mut FrictionLaw) {
    let usual = if v.has("rest_stiffness") {
        "dahl"
    } else if v.has("coulomb") {
        "coulomb"
    } else {
        "none"
    };
    named_law(v, &MODEL.or_text(usual), value);
}

fn named_law(v: &mut dyn Visit, field: &Field, value: &mut FrictionLaw) {
    let mut name = name_of(value);
    choose(v, field, &mut name);
    if name != name_of(value) {
        *value = blank(name);
    }
    parts(v, value);
}

fn name_of(law: &FrictionLaw) -> Law {
    match law {
        FrictionLaw::None => Law::None,
        FrictionLaw::Dahl { .. } => Law::Dahl,
        FrictionLaw::Lugre { .. } => Law::Lugre,
        FrictionLaw::Coulomb { .. } => Law::Coulomb,
        FrictionLaw::ResetIntegrator { .. } => Law::ResetIntegrator,
        FrictionLaw::Stribeck { .. } => Law::Stribeck,
        FrictionLaw::Karnopp { .. } => Law::Karnopp,
        FrictionLaw::Walrath { .. } => Law::Walrath,
        FrictionLaw::Bristle { .. } => Law::Bristle,
    }
}

/// Returns a law whose numbers are still to be read.
fn blank(law: Law) -> FrictionLaw {
    let coulomb_nm = f64::NAN;
    match law {
        Law::None => FrictionLaw::None,
        Law::Dahl => FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad: f64::NAN, exponent: 1.0 },
        Law::Lugre => FrictionLaw::Lugre {
            coulomb_nm,
            bristle_stiffness_nm_rad: f64::NAN,
            bristle_damping_nm_s_rad: f64::NAN,
        },
        Law::Coulomb => FrictionLaw::Coulomb { coulomb_nm },
        Law::ResetIntegrator => {
            FrictionLaw::ResetIntegrator { coulomb_nm, deflection_rad: f64::NAN, damping_nm_s_rad: f64::NAN }
        }
        Law::Stribeck => FrictionLaw::Stribeck { coulomb_nm, curve: StribeckCurve::Gaussian },
        Law::Karnopp => FrictionLaw::Karnopp { coulomb_nm, stick_rate_rad_s: f64::NAN },
        Law::Walrath => {
            FrictionLaw::Walrath { coulomb_nm, time_constant_s: f64::NAN, smoothing_rate_rad_s: f64::NAN }
        }
        Law::Bristle => FrictionLaw::Bristle { coulomb_nm, bristles: 1, bond_rad: f64::NAN },
    }
}

fn parts(v: &mut dyn Visit, law: &mut FrictionLaw) {
    match law {
        FrictionLaw::None => {}
        FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad, exponent } => {
            v.number(&COULOMB, coulomb_nm);
            v.number(&REST_STIFFNESS, rest_stiffness_nm_rad);
            v.number(&EXPONENT, exponent);
        }
        FrictionLaw::Lugre { coulomb_nm, bristle_stiffness_nm_rad, bristle_damping_nm_s_rad } => {
            v.number(&COULOMB, coulomb_nm);
            v.number(&BRISTLE_STIFFNESS, bristle_stiffness_nm_rad);
            v.number(&BRISTLE_DAMPING, bristle_damping_nm_s_rad);
        }
        FrictionLaw::Coulomb { coulomb_nm } => v.number(&COULOMB, coulomb_nm),
        FrictionLaw::ResetIntegrator { coulomb_nm, deflection_rad, damping_nm_s_rad } => {
            v.number(&COULOMB, coulomb_nm);
            v.number(&DEFLECTION, deflection_rad);
            v.number(&DAMPING, damping_nm_s_rad);
        }
        FrictionLaw::Walrath { coulomb_nm, time_constant_s, smoothing_rate_rad_s } => {
            v.number(&COULOMB, coulomb_nm);
            v.number(&TIME_CONSTANT, time_constant_s);
            v.number(&SMOOTHING_RATE, smoothing_rate_rad_s);
        }
        FrictionLaw::Karnopp { coulomb_nm, stick_rate_rad_s } => {
            v.number(&COULOMB, coulomb_nm);
            v.number(&STICK_RATE, stick_rate_rad_s);
        }
        FrictionLaw::Stribeck { coulomb_nm, curve } => {
            v.number(&COULOMB, coulomb_nm);
            stribeck_curve(v, curve);
        }
        FrictionLaw::Bristle { coulomb_nm, bristles, bond_rad } => {
            v.number(&COULOMB, coulomb_nm);
            let mut count = u32::try_from(*bristles).unwrap_or(u32::MAX);
            v.whole_number(&BRISTLES, &mut count);
            *bristles = count as usize;
            v.number(&BOND, bond_rad);
        }
    }
}

fn stribeck_curve(v: &mut dyn Visit, curve: &mut StribeckCurve) {
    let mut name = match curve {
        StribeckCurve::Tustin => Curve::Tustin,
        StribeckCurve::Gaussian => Curve::Gaussian,
        StribeckCurve::Exponential { .. } => Curve::Exponential,
        StribeckCurve::Lorentzian => Curve::Lorentzian,
        StribeckCurve::Polynomial { .. } => Curve::Polynomial,
    };
    choose(v, &CURVE, &mut name);
    *curve = match name {
        Curve::Tustin => StribeckCurve::Tustin,
        Curve::Gaussian => StribeckCurve::Gaussian,
        Curve::Lorentzian => StribeckCurve::Lorentzian,
        Curve::Exponential => {
            let mut exponent =
                if let StribeckCurve::Exponential { exponent } = *curve { exponent } else { f64::NAN };
            v.number(&CURVE_EXPONENT, &mut exponent);
            StribeckCurve::Exponential { exponent }
        }
        Curve::Polynomial => {
            let old = if let StribeckCurve::Polynomial { coefficients } = *curve {
                coefficients.to_vec()
            } else {
                vec![f64::NAN; 3]
            };
            let mut list = old;
            v.numbers(&COEFFICIENTS, Count::Exactly(3), &mut list);
            StribeckCurve::Polynomial {
                coefficients: [0, 1, 2].map(|i| list.get(i).copied().unwrap_or(f64::NAN)),
            }
        }
    };
}
