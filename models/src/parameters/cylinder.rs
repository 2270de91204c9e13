//! A hydraulic cylinder with a servo valve as the drive of a rotary axis.
//!
//! The linear part of a cylinder has the equations of a motor behind a rigid transmission, and takes its places: an ampere stands for a
//! load pressure of 1 MPa, a volt behind the amplifier for a flow of 1 L/s, and a turn of the motor for the piston's travel. With the piston's
//! area A, the volume V, the bulk modulus b and the leakage C,
//!
//! ```text
//!     ratio = r(0)     torque constant = A     back-EMF = A     resistance = C     inductance = V/(4 b)     gain = full flow / full control
//! ```
//!
//! A [`Cylinder`] holds what has no such place.

use super::{AmplifierDynamics, Parameters};
use crate::Error;
use crate::linkage::Linkage;
use crate::loads::ranges::{not_negative, require, require_positive};

/// Pascals in a megapascal.
pub const PA_PER_MPA: f64 = 1e6;
/// Litres in a cubic metre.
pub const L_PER_M3: f64 = 1e3;

/// Share of the supply pressure below which the flow through an orifice is proportional to its pressure drop: there it is laminar, and the
/// root would have an infinite slope (M. Jelali and A. Kroll, *Hydraulic Servo-systems*, Springer 2003, section 3.2).
pub const LAMINAR_SHARE: f64 = 1e-4;

/// Parameters of a cylinder and its valve, beside those in the places of a motor.
#[derive(Debug, Clone, PartialEq)]
pub struct Cylinder {
    /// Supply pressure less that of the tank, MPa.
    pub supply_mpa: f64,
    /// Volume under pressure on both sides, with the lines, L; the bulk modulus is volume / (4 inductance).
    pub volume_l: f64,
    /// Opening at which the valve begins to pass, as the flow without load that it would pass if it had no overlap, L/s.
    pub overlap_l_s: f64,
    /// Natural frequency of the spool, rad/s.
    pub valve_frequency_rad_s: f64,
    /// Damping ratio of the spool.
    pub valve_damping: f64,
    /// Pressure drop over the whole valve at which its flow is rated, MPa.
    pub rated_drop_mpa: f64,
    /// Lever of the piston on the hub.
    pub lever: Lever,
}

/// Lever of a piston on the hub: a constant one, or a triangle of pins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Lever {
    /// The same at every angle, m.
    Constant(f64),
    /// The cylinder is the third side of a triangle.
    Linkage(Linkage),
}

/// The lever at an angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeverPoint {
    /// Travel of the piston per angle of the hub, m/rad: the lever of its force.
    pub arm_m: f64,
    /// Slope of the lever over the angle, m/rad.
    pub slope_m_rad: f64,
    /// Travel of the piston since the angle 0, m.
    pub travel_m: f64,
}

impl Lever {
    /// Returns the lever at an angle of the hub on the platform. That of a linkage counts positive where it raises the hub at the angle 0.
    #[inline]
    pub fn at(&self, angle_rad: f64) -> LeverPoint {
        match self {
            Self::Constant(arm_m) => {
                LeverPoint { arm_m: *arm_m, slope_m_rad: 0.0, travel_m: arm_m * angle_rad }
            }
            Self::Linkage(pins) => {
                // a cylinder that shortens to raise pulls: its travel counts as it shortens
                let sense = pulling_sense(pins);
                let side = pins.side_at(angle_rad);
                LeverPoint {
                    arm_m: sense * side.slope_m_rad,
                    slope_m_rad: sense * side.curvature_m_rad2,
                    travel_m: sense * (side.length_m - pins.length_m(0.0)),
                }
            }
        }
    }
}

/// Returns -1 for a cylinder that raises the hub at the angle 0 as it shortens, 1 for one that pushes.
pub fn pulling_sense(pins: &Linkage) -> f64 {
    -pins.included_angle_rad(0.0).sin().signum()
}

/// The slopes of a valve's flow at an operating point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ValveSlopes {
    /// Over the opening, as a share of that without load.
    pub flow_gain: f64,
    /// Against the load pressure, L/s/MPa.
    pub pressure_l_s_mpa: f64,
}

impl Cylinder {
    /// Returns the flow to the cylinder, L/s, at an opening (the flow that it would pass without load and overlap, L/s) and a load pressure, MPa:
    ///
    /// ```text
    ///     Q = (|o| - o_0) sgn(o) sqrt(1 - sgn(o) p/p_s)        0 within the overlap o_0
    /// ```
    ///
    /// H. Merritt, *Hydraulic Control Systems*, Wiley 1967, equation 5-6: a matched, symmetrical valve with four edges. A load above the supply drives the
    /// flow back.
    #[inline]
    pub fn flow_l_s(&self, opening_l_s: f64, pressure_mpa: f64) -> f64 {
        let sense = opening_l_s.signum();
        let open = (opening_l_s.abs() - self.overlap_l_s).max(0.0);
        sense * open * self.root(1.0 - sense * pressure_mpa / self.supply_mpa)
    }

    /// The root of a share of the supply pressure, with its sign.
    #[inline]
    fn root(&self, share: f64) -> f64 {
        share / share.abs().max(LAMINAR_SHARE).sqrt()
    }

    /// Returns the opening that passes a flow against a load pressure; infinite if the supply does not reach.
    pub fn opening_l_s(&self, flow_l_s: f64, pressure_mpa: f64) -> f64 {
        if flow_l_s == 0.0 {
            return 0.0;
        }
        let sense = flow_l_s.signum();
        let share = 1.0 - sense * pressure_mpa / self.supply_mpa;
        if share <= 0.0 {
            return sense * f64::INFINITY;
        }
        flow_l_s / self.root(share) + sense * self.overlap_l_s
    }

    /// Returns the slopes of the flow where the valve passes what leaks at a load pressure.
    pub fn valve_slopes(&self, opening_l_s: f64, pressure_mpa: f64) -> ValveSlopes {
        let sense = opening_l_s.signum();
        let share = (1.0 - sense * pressure_mpa / self.supply_mpa).max(LAMINAR_SHARE);
        let open =
            if opening_l_s.is_finite() { (opening_l_s.abs() - self.overlap_l_s).max(0.0) } else { 0.0 };
        ValveSlopes {
            flow_gain: share.sqrt(),
            pressure_l_s_mpa: open / (2.0 * self.supply_mpa * share.sqrt()),
        }
    }

    /// Returns an error if a number is out of its range, or if a part that only a motor has is there.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the first number out of its range, and for parts that only a motor has.
    pub(crate) fn check(&self, p: &Parameters) -> Result<(), Error> {
        let positive_numbers = [
            ("cylinder.supply_mpa", self.supply_mpa),
            ("cylinder.volume_l", self.volume_l),
            ("cylinder.valve_frequency_rad_s", self.valve_frequency_rad_s),
            ("cylinder.valve_damping", self.valve_damping),
            ("cylinder.rated_drop_mpa", self.rated_drop_mpa),
            ("cylinder.lever at the angle 0", self.lever.at(0.0).arm_m),
            ("motor.inductance_h of a cylinder", p.motor.inductance_h),
        ];
        for (name, value) in positive_numbers {
            require_positive(name, value)?;
        }
        not_negative("cylinder.overlap_l_s", self.overlap_l_s)?;
        require(
            f64::is_finite,
            "amplifier.input_limit_v",
            p.amplifier.input_limit_v,
            "must be finite: the control at which the valve is fully open",
        )?;
        require(
            |ratio| ratio == self.lever.at(0.0).arm_m,
            "gearbox.ratio",
            p.gearbox.ratio,
            "must be the cylinder's lever at the angle 0",
        )?;
        self.check_parts(p)
    }

    fn check_parts(&self, p: &Parameters) -> Result<(), Error> {
        let modelled = p.amplifier.dynamics == AmplifierDynamics::Modelled && p.gearbox.is_rigid();
        require(
            |_| modelled,
            "amplifier.gain",
            p.amplifier.gain,
            "must belong to a modelled drive with a rigid transmission where a cylinder drives",
        )?;
        let absent = [
            ("motor.inertia_kg_m2", p.motor.inertia_kg_m2),
            ("motor.platform_coupling", p.motor.platform_coupling),
            ("motor.cogging.amplitude", p.motor.cogging.amplitude),
            ("motor.torque_ripple.amplitude", p.motor.torque_ripple.amplitude),
            ("gearbox.mesh_ripple.amplitude", p.gearbox.mesh_ripple.amplitude),
            ("amplifier.current_feedback_v_a", p.amplifier.current_feedback_v_a),
            ("number of free functions", p.learned.len() as f64),
            ("number of points of amplifier.map", p.amplifier.map.len() as f64),
        ];
        for (name, value) in absent {
            require(|value| value == 0.0, name, value, "must be 0 where a cylinder drives")?;
        }
        let infinite = [
            ("amplifier.bus_voltage_v", p.amplifier.bus_voltage_v),
            ("amplifier.current_limit_a", p.amplifier.current_limit_a),
        ];
        for (name, value) in infinite {
            require(
                |value| value == f64::INFINITY,
                name,
                value,
                "must be infinite where a cylinder drives: supply and valve limit it",
            )?;
        }
        let limits = p.drive_limits.limits_current();
        require(
            |_| !limits,
            "drive_limits",
            f64::from(u8::from(limits)),
            "must not limit a current where a cylinder drives; slew may stand",
        )?;
        require(
            |_| !p.motor_friction.law.sticks(),
            "motor_friction.coulomb",
            p.motor_friction.coulomb_nm(),
            "must have a law with presliding on a piston; a law that truly sticks belongs to the pivot",
        )
    }
}
