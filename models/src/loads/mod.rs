//! The loads of a mechanism beside its weight, its base and its friction: an equilibrator, the stops at the ends of its travel, and the recoil
//! of what it fires.
//!
//! Each acts as a torque on the hub that is a function of time, of the hub's angle and rate on the platform, and of the load on its mass.
//!
//! Modules in reading order: `ranges`, [`equilibrator`], [`end_stops`], [`recoil`].

pub mod end_stops;
pub mod equilibrator;
pub(crate) mod ranges;
pub mod recoil;

pub use end_stops::EndStops;
pub use equilibrator::{Equilibrator, Force};
pub use recoil::Recoil;

use crate::Error;

/// Loads of a mechanism; none by default.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Loads {
    /// A spring or a gas strut that holds the out-of-balance.
    pub equilibrator: Option<Equilibrator>,
    /// Stops at the ends of the travel.
    pub end_stops: Option<EndStops>,
    /// Impulse of the shots and the recoiling mass.
    pub recoil: Option<Recoil>,
}

/// The instant and the motion at which loads are asked for.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LoadPoint {
    /// Time since the start, s.
    pub time_s: f64,
    /// Hub angle on the platform, rad.
    pub angle_rad: f64,
    /// Hub rate on the platform, rad/s.
    pub rate_rad_s: f64,
    /// Inertial rate of the hub, rad/s.
    pub hub_rate_rad_s: f64,
    /// Acceleration across the beam that every mass of it feels, G = (g + a_p) cos theta_h - a_x sin theta_h, m/s^2.
    pub load_m_s2: f64,
}

impl Loads {
    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Returns the torque on the hub, N m, positive nose-up.
    #[inline]
    pub fn torque_nm(&self, at: &LoadPoint) -> f64 {
        let equilibrator = self.equilibrator.as_ref().map_or(0.0, |one| one.torque_nm(at.angle_rad));
        let stops = self.end_stops.as_ref().map_or(0.0, |stops| stops.torque_nm(at.angle_rad, at.rate_rad_s));
        let recoil = self.recoil.as_ref().map_or(0.0, |recoil| recoil.torque_nm(at));
        equilibrator + stops + recoil
    }

    /// Returns the torque at rest at an angle on the platform, N m: without recoil.
    pub fn torque_at_rest_nm(&self, angle_rad: f64) -> f64 {
        let equilibrator = self.equilibrator.as_ref().map_or(0.0, |one| one.torque_nm(angle_rad));
        equilibrator + self.end_stops.as_ref().map_or(0.0, |stops| stops.torque_nm(angle_rad, 0.0))
    }

    /// Returns the stiffness against the angle on the platform at rest, N m/rad: minus the slope of the torque.
    pub fn stiffness_nm_rad(&self, angle_rad: f64) -> f64 {
        let equilibrator = self.equilibrator.as_ref().map_or(0.0, |one| one.stiffness_nm_rad(angle_rad));
        equilibrator + self.end_stops.as_ref().map_or(0.0, |stops| stops.stiffness_at(angle_rad))
    }

    /// Returns a torque against which an error is small, N m: that of the recoil, as the others follow the motion.
    pub fn scale_nm(&self) -> f64 {
        self.recoil.as_ref().map_or(0.0, |recoil| 0.1 * recoil.peak_torque_nm())
    }

    /// Refuses loads that have no motion.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the first number out of its range.
    pub fn check(&self) -> Result<(), Error> {
        self.equilibrator.as_ref().map_or(Ok(()), Equilibrator::check)?;
        self.end_stops.as_ref().map_or(Ok(()), EndStops::check)?;
        self.recoil.as_ref().map_or(Ok(()), Recoil::check)
    }
}
