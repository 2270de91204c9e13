//! The ranges of the friction parameters, defined once: the models check them, and readers of project files quote them.

use crate::Error;
use crate::Range;
use crate::parameters::Friction;

/// Coulomb level, N m.
pub const COULOMB: Range = Range::NOT_NEGATIVE;
/// Rest stiffness of the Dahl law, N m/rad.
pub const REST_STIFFNESS: Range = Range::POSITIVE;
/// Exponent of the Dahl law.
pub const EXPONENT: Range = Range::POSITIVE;
/// Stiffness of the bristles of the LuGre law, N m/rad.
pub const BRISTLE_STIFFNESS: Range = Range::POSITIVE;
/// Damping of the bristles of the LuGre law, N m s/rad.
pub const BRISTLE_DAMPING: Range = Range::NOT_NEGATIVE;
/// Deflection at which the bond of the reset integrator breaks, rad.
pub const DEFLECTION: Range = Range::POSITIVE;
/// Damping of the bond of the reset integrator, N m s/rad.
pub const DAMPING: Range = Range::NOT_NEGATIVE;
/// Exponent of the exponential Stribeck curve.
pub const CURVE_EXPONENT: Range = Range::POSITIVE;
/// Half width of Karnopp's band of rates, rad/s.
pub const STICK_RATE: Range = Range::POSITIVE;
/// Time constant of Walrath's law, s.
pub const TIME_CONSTANT: Range = Range::POSITIVE;
/// Rate that smooths the sign in Walrath's law, rad/s.
pub const SMOOTHING_RATE: Range = Range::POSITIVE;
/// Number of bristles. The upper end bounds the memory that a project file can ask for.
pub const BRISTLES: Range = Range::Between(1.0, 100_000.0);
/// Deflection at which the bond of a bristle snaps, rad.
pub const BOND: Range = Range::POSITIVE;

/// Viscous coefficient, N m s/rad.
pub const VISCOUS: Range = Range::NOT_NEGATIVE;
/// Quadratic drag, N m s^2/rad^2.
pub const QUADRATIC: Range = Range::NOT_NEGATIVE;
/// Static level over Coulomb level, for laws whose level is a smooth function of the rate. A fit may probe values below 1.
pub const STATIC_RATIO: Range = Range::POSITIVE;
/// Static level over Coulomb level, for laws that break away from true stick or from a bond, and in project files: friction
/// at rest is not below sliding friction.
pub const STATIC_RATIO_OF_BREAKAWAY: Range = Range::AtLeast(1.0);
/// Rate at which the Stribeck effect has fallen, rad/s.
pub const STRIBECK_RATE: Range = Range::POSITIVE;
/// Half the difference between the directions, as a fraction, of the Coulomb level or of the viscous coefficient. A fraction of
/// 1 leaves no friction in one direction, and laws divide by the level; hence the thousandth.
pub const ASYMMETRY: Range = Range::Between(-0.999, 0.999);
/// Amplitude of the variation of the Coulomb level with the angle, as a fraction; limited as [`ASYMMETRY`] is.
pub const RIPPLE_AMPLITUDE: Range = Range::Between(-0.999, 0.999);
/// Growth of the Coulomb level per N m of load.
pub const LOAD_COEFFICIENT: Range = Range::NOT_NEGATIVE;
/// Relative change of the level as the joint warms up. At 1 no friction is left when the joint is warm. A level that rises evenly has a time
/// constant far beyond the recording, so that what it would reach says nothing; below -20 the number is taken for a wrong sign or unit.
pub const WARM_UP: Range = Range::AboveTo(-20.0, 0.999);
/// Time constant of the warm-up, s.
pub const WARM_UP_TIME: Range = Range::POSITIVE;

/// Checks the parameters that every law shares.
pub(super) fn check_shared(path: &str, friction: &Friction) -> Result<(), Error> {
    let numbers = [
        (COULOMB, "coulomb_nm", friction.coulomb_nm()),
        (VISCOUS, "viscous_nm_s_rad", friction.viscous_nm_s_rad),
        (QUADRATIC, "quadratic_nm_s2_rad2", friction.quadratic_nm_s2_rad2),
        (STATIC_RATIO, "static_ratio", friction.static_ratio),
        (STRIBECK_RATE, "stribeck_rate_rad_s", friction.stribeck_rate_rad_s),
        (ASYMMETRY, "asymmetry", friction.asymmetry),
        (ASYMMETRY, "viscous_asymmetry", friction.viscous_asymmetry),
        (RIPPLE_AMPLITUDE, "position_ripple.amplitude", friction.position_ripple.amplitude),
        (WARM_UP, "warm_up", friction.warm_up),
        (WARM_UP_TIME, "warm_up_time_s", friction.warm_up_time_s),
        (LOAD_COEFFICIENT, "load_coefficient", friction.load_coefficient),
    ];
    for (range, name, value) in numbers {
        range.check(path, name, value)?;
    }
    if friction.load_coefficient > 0.0 && friction.coulomb_nm() == 0.0 {
        return Err(Error::Parameter {
            parameter: format!("{path}.load_coefficient"),
            value: friction.load_coefficient,
            allowed: "must be 0 if the law has no Coulomb level, which it would scale".into(),
        });
    }
    Ok(())
}
