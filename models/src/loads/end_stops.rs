//! Stops at the ends of the travel: a contact that takes energy.
//!
//! With d the depth of the contact and v its rate,
//!
//! ```text
//!     T = k d (1 + c v),  not below 0                (K. Hunt and F. Crossley, Journal of Applied Mechanics 42, 1975, p. 440, exponent 1)
//! ```
//!
//! The torque begins and ends at 0, unlike that of a spring beside a damper, and never pulls. A body of inertia J that meets the stop with the
//! rate v leaves it with the rate w and goes as deep as d, where
//!
//! ```text
//!     c (v + w) = ln((1 + c v) / (1 - c w))          d^2 = 2 J / (k c^2) (c v - ln(1 + c v))
//! ```
//!
//! (the integral of J v dv = -k d (1 + c v) dd over the way in and over the way out). For small c v the coefficient of restitution is
//! 1 - 2 c v / 3.

use super::ranges::{not_negative, require, require_finite, require_positive};
use crate::Error;

/// Stops at the ends of the travel of the hub on the platform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndStops {
    /// Angle at which the lower stop is met, rad.
    pub lower_rad: f64,
    /// Angle at which the upper stop is met, rad.
    pub upper_rad: f64,
    /// Stiffness, N m/rad.
    pub stiffness_nm_rad: f64,
    /// Dissipation c, s/rad.
    pub dissipation_s_rad: f64,
}

impl EndStops {
    /// Returns the torque on the hub, N m.
    #[inline]
    pub fn torque_nm(&self, angle_rad: f64, rate_rad_s: f64) -> f64 {
        if angle_rad > self.upper_rad {
            return -self.contact_nm(angle_rad - self.upper_rad, rate_rad_s);
        }
        if angle_rad < self.lower_rad {
            return self.contact_nm(self.lower_rad - angle_rad, -rate_rad_s);
        }
        0.0
    }

    #[inline]
    fn contact_nm(&self, depth_rad: f64, rate_rad_s: f64) -> f64 {
        (self.stiffness_nm_rad * depth_rad * (1.0 + self.dissipation_s_rad * rate_rad_s)).max(0.0)
    }

    /// Returns the stiffness of what rests at an angle, N m/rad.
    pub fn stiffness_at(&self, angle_rad: f64) -> f64 {
        let touches = angle_rad > self.upper_rad || angle_rad < self.lower_rad;
        if touches { self.stiffness_nm_rad } else { 0.0 }
    }

    /// Refuses stops without room between them, or that push the wrong way.
    pub(super) fn check(&self) -> Result<(), Error> {
        require_finite("end_stops.lower", self.lower_rad)?;
        require_finite("end_stops.upper", self.upper_rad)?;
        let lower = self.lower_rad;
        require(|upper| upper > lower, "end_stops.upper", self.upper_rad, "must be above end_stops.lower")?;
        require_positive("end_stops.stiffness", self.stiffness_nm_rad)?;
        not_negative("end_stops.dissipation", self.dissipation_s_rad)
    }
}
