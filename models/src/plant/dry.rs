//! Quadratic drag, which neither the linear core nor the dry law holds.

use crate::parameters::Friction;

impl Friction {
    /// Torque that opposes the rate beside the dry one and the linear viscous one: quadratic drag, N m.
    pub fn drag_nm(&self, rate_rad_s: f64) -> f64 {
        self.quadratic_nm_s2_rad2 * rate_rad_s * rate_rad_s.abs()
    }
}
