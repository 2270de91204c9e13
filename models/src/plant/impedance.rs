//! Stiffness and damping of a joint.

/// Stiffness and damping that act on the relative motion of a joint.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Impedance {
    /// Stiffness, N m/rad.
    pub stiffness: f64,
    /// Damping, N m s/rad.
    pub damping: f64,
}

impl Impedance {
    /// Returns the sum with another.
    pub(super) fn plus(self, other: Self) -> Self {
        Self { stiffness: self.stiffness + other.stiffness, damping: self.damping + other.damping }
    }
}
