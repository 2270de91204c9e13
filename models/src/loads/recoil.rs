//! Firing: the impulse of a shot, and the recoil of a mass that moves.
//!
//! A force B drives the recoiling mass m back along the bore while the shot is in the barrel, with the impulse I. The mass recoils freely during
//! that time d, is then stopped within the recoil length X, and runs out again in the time r:
//!
//! ```text
//!     0 < t < d            B = I pi/(2 d) sin(pi t/d)     m v = I (1 - cos(pi t/d))/2     K = 0
//!     0 < t - d < s        B = 0                          m v = I (1 + cos(pi (t-d)/s))/2    s = 2 m X/I - d
//!     0 < t - d - s < r    x = X (1 - 10 z^3 + 15 z^4 - 6 z^5),  z = (t-d-s)/r
//! ```
//!
//! K = B - m v' is the force of the recoil system on the cradle, rearward: Newton's second law for the recoiling mass. Its integral is I, for the
//! mass rests before and after. The stopping force is half a sine, which keeps the force continuous; its peak is I pi/(2 s). All of it
//! follows from the balance of momentum.
//!
//! The centre of mass of the recoiling parts lies at `e` above the trunnion's axis, the bore at `e + o`, and at rest `b` ahead of the trunnion. The
//! elevated mass about its trunnion then feels, nose-up, beside what it feels with the recoiling mass at rest,
//!
//! ```text
//!     T = e K + o B + m x G + 2 m (b - x) v w_h
//! ```
//!
//! The first two are the moments of B about the trunnion and of the mass that accelerates (B (e + o) - m v' e); the third is the weight's, whose
//! moment has moved back by x; the last is -dJ/dt w_h. The moment of inertia itself is kept: it changes by m (x^2 - 2 b x).

use std::f64::consts::PI;

use super::LoadPoint;
use super::ranges::{require, require_finite, require_positive};
use crate::Error;

/// Impulse and recoiling mass of a gun.
#[derive(Debug, Clone, PartialEq)]
pub struct Recoil {
    /// Instants of the shots, s since the start of the run, rising.
    pub shots_s: Vec<f64>,
    /// Impulse of a shot, N s.
    pub impulse_ns: f64,
    /// Time of the shot in the barrel with the gas's after-effect, s.
    pub shot_time_s: f64,
    /// Recoiling mass, kg.
    pub mass_kg: f64,
    /// Length of the recoil, m.
    pub length_m: f64,
    /// Time in which the mass runs out again, s.
    pub run_out_s: f64,
    /// Height of the centre of mass of the recoiling parts above the trunnion's axis, m.
    pub height_m: f64,
    /// Height of the bore's axis above that centre of mass, m.
    pub bore_offset_m: f64,
    /// Distance of that centre of mass ahead of the trunnion at rest, m.
    pub ahead_m: f64,
}

/// The recoiling mass at an instant.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct RecoilState {
    /// Way back, m.
    pub way_m: f64,
    /// Rate of it, m/s.
    pub rate_m_s: f64,
    /// Force of the shot on the recoiling mass, rearward, N.
    pub shot_n: f64,
    /// Force of the recoil system on the cradle, rearward, N.
    pub cradle_n: f64,
}

impl Recoil {
    /// Returns the time from the end of a shot until the mass has stopped, s.
    pub fn stopping_s(&self) -> f64 {
        2.0 * self.mass_kg * self.length_m / self.impulse_ns - self.shot_time_s
    }

    /// Returns the time from a shot until the mass is back, s.
    pub fn cycle_s(&self) -> f64 {
        self.shot_time_s + self.stopping_s() + self.run_out_s
    }

    /// Returns the recoiling mass at an instant of a run; it stands between shots.
    #[inline]
    pub fn at(&self, time_s: f64) -> RecoilState {
        let shot = self.shots_s.iter().rev().find(|shot| **shot < time_s);
        shot.map_or(RecoilState::default(), |shot| self.mass_after_shot(time_s - shot))
    }

    /// Returns the recoiling mass at a time after a shot.
    fn mass_after_shot(&self, time_s: f64) -> RecoilState {
        let (shot_time, stopping) = (self.shot_time_s, self.stopping_s());
        let (impulse, mass) = (self.impulse_ns, self.mass_kg);
        let started = 0.5 * impulse * shot_time / mass;
        if time_s < shot_time {
            let angle = PI * time_s / shot_time;
            return RecoilState {
                way_m: 0.5 * impulse / mass * (time_s - shot_time / PI * angle.sin()),
                rate_m_s: 0.5 * impulse / mass * (1.0 - angle.cos()),
                shot_n: 0.5 * PI * impulse / shot_time * angle.sin(),
                cradle_n: 0.0,
            };
        }
        let since = time_s - shot_time;
        if since < stopping {
            let angle = PI * since / stopping;
            return RecoilState {
                way_m: started + 0.5 * impulse / mass * (since + stopping / PI * angle.sin()),
                rate_m_s: 0.5 * impulse / mass * (1.0 + angle.cos()),
                shot_n: 0.0,
                cradle_n: 0.5 * PI * impulse / stopping * angle.sin(),
            };
        }
        let z = (since - stopping) / self.run_out_s;
        if z >= 1.0 {
            return RecoilState::default();
        }
        let length = self.length_m;
        let slope = -length / self.run_out_s * 30.0 * z * z * (1.0 - z) * (1.0 - z);
        let bend = -length / (self.run_out_s * self.run_out_s) * 60.0 * z * (1.0 - z) * (1.0 - 2.0 * z);
        RecoilState {
            way_m: length * (1.0 - z * z * z * (10.0 - z * (15.0 - 6.0 * z))),
            rate_m_s: slope,
            shot_n: 0.0,
            cradle_n: -mass * bend,
        }
    }

    /// Returns the torque on the hub, N m.
    #[inline]
    pub fn torque_nm(&self, at: &LoadPoint) -> f64 {
        let moved = self.at(at.time_s);
        let turning = 2.0 * self.mass_kg * (self.ahead_m - moved.way_m) * moved.rate_m_s;
        self.height_m * moved.cradle_n
            + self.bore_offset_m * moved.shot_n
            + self.mass_kg * moved.way_m * at.load_m_s2
            + turning * at.hub_rate_rad_s
    }

    /// Returns the largest torque of the forces along the bore, N m, in size.
    pub fn peak_torque_nm(&self) -> f64 {
        let stopped = 0.5 * PI * self.impulse_ns / self.stopping_s();
        let driven = 0.5 * PI * self.impulse_ns / self.shot_time_s;
        (self.height_m * stopped).abs().max((self.bore_offset_m * driven).abs())
    }

    /// Refuses shots that do not recoil as stated.
    pub(super) fn check(&self) -> Result<(), Error> {
        require_positive("recoil.impulse", self.impulse_ns)?;
        require_positive("recoil.shot_time", self.shot_time_s)?;
        require_positive("recoil.mass", self.mass_kg)?;
        require_positive("recoil.length", self.length_m)?;
        require_positive("recoil.run_out", self.run_out_s)?;
        require_finite("recoil.height", self.height_m)?;
        require_finite("recoil.bore_offset", self.bore_offset_m)?;
        require_finite("recoil.ahead", self.ahead_m)?;
        let least = 0.5 * self.impulse_ns * self.shot_time_s / self.mass_kg;
        let allowed = "must be more than impulse x shot_time / (2 mass), the way of the mass while the shot is in the barrel";
        require(|length| length > least, "recoil.length", self.length_m, allowed)?;
        for (k, shot) in self.shots_s.iter().enumerate() {
            require_finite(&format!("recoil.shots[{k}]"), *shot)?;
        }
        let cycle = self.cycle_s();
        let allowed = "must come after the mass has run out from the shot before";
        for pair in self.shots_s.windows(2) {
            require(|shot| shot >= pair[0] + cycle, "recoil.shots", pair[1], allowed)?;
        }
        Ok(())
    }
}
