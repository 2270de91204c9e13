//! The triangle that a strut or a cylinder makes with the pivot: its length, and how that follows the angle.

/// The pins of a strut or a cylinder between elevated mass and platform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linkage {
    /// Distance of the pin on the elevated mass from the pivot, m.
    pub arm_m: f64,
    /// Angle from the beam, rad.
    pub arm_angle_rad: f64,
    /// Distance of the pin on the platform from the pivot, m.
    pub anchor_m: f64,
    /// Angle above forward, rad.
    pub anchor_angle_rad: f64,
}

/// The third side of the triangle at an angle, with its slopes; all 0 if the pins meet.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LinkageSide {
    /// L, m.
    pub length_m: f64,
    /// dL/dp, m/rad.
    pub slope_m_rad: f64,
    /// d2L/dp2, m/rad^2.
    pub curvature_m_rad2: f64,
}

impl Linkage {
    /// Returns the angle c between both arms at an angle of the hub on the platform, rad.
    #[inline]
    pub fn included_angle_rad(&self, angle_rad: f64) -> f64 {
        self.anchor_angle_rad - self.arm_angle_rad - angle_rad
    }

    /// Returns the distance of the pins, m: L^2 = r^2 + R^2 - 2 r R cos c.
    #[inline]
    pub fn length_m(&self, angle_rad: f64) -> f64 {
        let product = self.arm_m * self.anchor_m;
        let squares = self.arm_m * self.arm_m + self.anchor_m * self.anchor_m;
        (squares - 2.0 * product * self.included_angle_rad(angle_rad).cos()).max(0.0).sqrt()
    }

    /// Returns the distance of the pins with its slopes over the angle p of the hub on the platform. With the angle c = anchor angle - arm angle - p
    /// between both arms,
    ///
    /// ```text
    ///     L^2 = r^2 + R^2 - 2 r R cos c     dL/dp = -r R sin(c)/L     d2L/dp2 = (r R cos c - (dL/dp)^2)/L
    /// ```
    #[inline]
    pub fn side_at(&self, angle_rad: f64) -> LinkageSide {
        let length_m = self.length_m(angle_rad);
        if length_m == 0.0 {
            return LinkageSide::default();
        }
        let (product, between) = (self.arm_m * self.anchor_m, self.included_angle_rad(angle_rad));
        let slope_m_rad = -product * between.sin() / length_m;
        let curvature_m_rad2 = (product * between.cos() - slope_m_rad * slope_m_rad) / length_m;
        LinkageSide { length_m, slope_m_rad, curvature_m_rad2 }
    }
}
