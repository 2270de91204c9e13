//! Drag that neither the linear core nor the dry law holds.

use crate::parameters::Friction;

impl Friction {
    /// Returns the torque that opposes the rate beside the dry one and the mean viscous one, N m: quadratic drag, and what the viscous
    /// part differs by between the directions, `F_q w |w| + a_v F_v |w|`.
    pub fn drag_nm(&self, rate_rad_s: f64) -> f64 {
        let speed = rate_rad_s.abs();
        speed * (self.quadratic_nm_s2_rad2 * rate_rad_s + self.viscous_asymmetry * self.viscous_nm_s_rad)
    }

    /// Returns the slope of [`Friction::drag_nm`] over the rate, N m s/rad; at rest that of the positive direction.
    pub fn drag_slope_nm_s_rad(&self, rate_rad_s: f64) -> f64 {
        2.0 * self.quadratic_nm_s2_rad2 * rate_rad_s.abs()
            + self.viscous_asymmetry * self.viscous_nm_s_rad * rate_rad_s.signum()
    }

    /// Returns whether [`Friction::drag_nm`] is not zero throughout.
    pub fn has_drag(&self) -> bool {
        self.quadratic_nm_s2_rad2 != 0.0 || self.viscous_asymmetry * self.viscous_nm_s_rad != 0.0
    }
}
