//! An equilibrator: a spring or a gas strut between elevated mass and platform that holds the out-of-balance.
//!
//! It joins a pin on the elevated mass, at the radius r from the trunnion and the angle a from the beam, to a pin on the platform at the
//! distance R and the angle b. With the hub at the angle p on the platform its length is L, and a tension F turns the hub by
//!
//! ```text
//!     c = b - a - p       L^2 = r^2 + R^2 - 2 r R cos c       T = F r R sin(c) / L = -F dL/dp
//! ```
//!
//! (virtual work). A spring has
//! F = k (L - L_0). A gas of the absolute pressure p_0 at the temperature t_0, enclosed in V_0 at the length L_0, has at the temperature t
//!
//! ```text
//!     p = p_0 (t / t_0) (V_0 / V)^n       V = V_0 -+ A (L - L_0)       F = +-(p - p_a) A
//! ```
//!
//! with the upper signs for a cylinder that pulls (its gas is pressed together as it grows longer) and the lower ones for a strut that pushes.
//! The charge follows the gas law at a constant volume, fast strokes the polytropic exponent n (1 isothermal, 1.4 adiabatic).

use super::ranges::{require, require_finite, require_positive};
use crate::Error;
use crate::linkage::Linkage;

/// Pressure of the atmosphere, Pa (ISO 2533).
pub const ATMOSPHERE_PA: f64 = 101_325.0;

/// An equilibrator and its pins.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrator {
    /// Distance of the pin on the elevated mass from the trunnion, m.
    pub arm_m: f64,
    /// Angle from the beam, rad.
    pub arm_angle_rad: f64,
    /// Distance of the pin on the platform from the trunnion, m.
    pub anchor_m: f64,
    /// Angle above forward, rad.
    pub anchor_angle_rad: f64,
    /// Factor on the force; 1 as stated.
    pub factor: f64,
    /// Law of the force.
    pub force: Force,
}

/// Law of the force of an equilibrator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Force {
    /// A coil spring that pulls.
    Spring {
        /// Stiffness, N/m.
        stiffness_n_m: f64,
        /// Length without force, m.
        free_length_m: f64,
    },
    /// A gas.
    Gas(Gas),
}

/// A gas in a cylinder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gas {
    /// The direction: it pulls or pushes.
    pub acts: Action,
    /// Absolute pressure of the charge, Pa.
    pub pressure_pa: f64,
    /// Area of the piston, m^2.
    pub area_m2: f64,
    /// Volume of the gas at the length below, m^3.
    pub volume_m3: f64,
    /// Length at which pressure and volume are stated, m.
    pub length_m: f64,
    /// Polytropic exponent.
    pub exponent: f64,
    /// Temperature of the charge, K.
    pub charge_temperature_k: f64,
    /// Temperature of the gas, K.
    pub temperature_k: f64,
}

/// Direction of a strut's force: pull or push.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Action {
    /// The strut pulls its pins together.
    #[default]
    Pull,
    /// The strut pushes them apart.
    Push,
}

/// A force with its slope over the length.
#[derive(Debug, Clone, Copy)]
struct Tension {
    /// N, positive where it pulls.
    force_n: f64,
    /// N/m.
    slope_n_m: f64,
}

impl Equilibrator {
    fn pins(&self) -> Linkage {
        let Self { arm_m, arm_angle_rad, anchor_m, anchor_angle_rad, .. } = *self;
        Linkage { arm_m, arm_angle_rad, anchor_m, anchor_angle_rad }
    }

    /// Returns the length at an angle of the hub on the platform, m.
    #[inline]
    pub fn length_m(&self, angle_rad: f64) -> f64 {
        self.pins().length_m(angle_rad)
    }

    /// Returns the torque on the hub, N m.
    #[inline]
    pub fn torque_nm(&self, angle_rad: f64) -> f64 {
        // virtual work: T = -F dL/dp
        let side = self.pins().side_at(angle_rad);
        self.tension(side.length_m).force_n * -side.slope_m_rad
    }

    /// Returns the tension, N; negative where it pushes.
    pub fn tension_n(&self, angle_rad: f64) -> f64 {
        self.tension(self.length_m(angle_rad)).force_n
    }

    /// Returns minus the slope of the torque, N m/rad: F' (dL/dp)^2 + F d2L/dp2.
    pub fn stiffness_nm_rad(&self, angle_rad: f64) -> f64 {
        let side = self.pins().side_at(angle_rad);
        if side.length_m == 0.0 {
            return 0.0;
        }
        let tension = self.tension(side.length_m);
        tension.slope_n_m * side.slope_m_rad * side.slope_m_rad + tension.force_n * side.curvature_m_rad2
    }

    #[inline]
    fn tension(&self, length_m: f64) -> Tension {
        let Tension { force_n, slope_n_m } = self.force.tension(length_m);
        Tension { force_n: self.factor * force_n, slope_n_m: self.factor * slope_n_m }
    }

    /// Refuses pins and forces that make no equilibrator.
    pub(super) fn check(&self) -> Result<(), Error> {
        require_positive("equilibrator.arm", self.arm_m)?;
        require_finite("equilibrator.arm_angle", self.arm_angle_rad)?;
        require_positive("equilibrator.anchor", self.anchor_m)?;
        require_finite("equilibrator.anchor_angle", self.anchor_angle_rad)?;
        require_finite("equilibrator.factor", self.factor)?;
        match self.force {
            Force::Spring { stiffness_n_m, free_length_m } => {
                require_positive("equilibrator.spring.stiffness", stiffness_n_m)?;
                require_finite("equilibrator.spring.free_length", free_length_m)
            }
            Force::Gas(gas) => self.check_gas(&gas),
        }
    }

    fn check_gas(&self, gas: &Gas) -> Result<(), Error> {
        for (name, value) in [
            ("equilibrator.gas.pressure", gas.pressure_pa),
            ("equilibrator.gas.area", gas.area_m2),
            ("equilibrator.gas.length", gas.length_m),
            ("equilibrator.gas.exponent", gas.exponent),
            ("equilibrator.gas.charge_temperature", gas.charge_temperature_k),
            ("equilibrator.gas.temperature", gas.temperature_k),
        ] {
            require_positive(name, value)?;
        }
        // the longest or the shortest length of the linkage leaves gas in the cylinder
        let extreme = match gas.acts {
            Action::Pull => self.arm_m + self.anchor_m,
            Action::Push => (self.arm_m - self.anchor_m).abs(),
        };
        let stroke = gas.area_m2 * (extreme - gas.length_m).abs();
        let allowed = "must be more than the piston's area times the way from equilibrator.gas.length to the end of the linkage: no gas would be left there";
        require(|volume| volume > stroke, "equilibrator.gas.volume", gas.volume_m3, allowed)
    }
}

impl Force {
    #[inline]
    fn tension(&self, length_m: f64) -> Tension {
        match *self {
            Self::Spring { stiffness_n_m, free_length_m } => {
                // a coil spring that hangs slack does not push
                let stretch = length_m - free_length_m;
                if stretch > 0.0 {
                    Tension { force_n: stiffness_n_m * stretch, slope_n_m: stiffness_n_m }
                } else {
                    Tension { force_n: 0.0, slope_n_m: 0.0 }
                }
            }
            Self::Gas(gas) => gas.tension(length_m),
        }
    }
}

impl Gas {
    /// Returns whether it pulls, as a sign.
    fn sign(&self) -> f64 {
        if self.acts == Action::Pull { 1.0 } else { -1.0 }
    }

    /// Returns the area of the piston, negative if the gas pushes, m^2.
    pub fn signed_area_m2(&self) -> f64 {
        self.sign() * self.area_m2
    }

    /// Returns the pressure of the charge at the temperature of the gas, Pa.
    pub fn warm_pressure_pa(&self) -> f64 {
        self.pressure_pa * self.temperature_k / self.charge_temperature_k
    }

    #[inline]
    fn tension(&self, length_m: f64) -> Tension {
        let volume = self.volume_m3 - self.signed_area_m2() * (length_m - self.length_m);
        let pressure = self.warm_pressure_pa() * (self.volume_m3 / volume).powf(self.exponent);
        Tension {
            force_n: self.sign() * (pressure - ATMOSPHERE_PA) * self.area_m2,
            slope_n_m: self.exponent * pressure * self.area_m2 * self.area_m2 / volume,
        }
    }
}
