//! The partial derivatives of a law with one state.

/// Partial derivatives of a law with one state z: dz/dt and the torque, by the rate w and by z.
///
/// With z in N m (Dahl, Walrath) or rad (LuGre, reset integrator). At w = 0 they are one-sided limits from w > 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Partials {
    /// d(dz/dt)/dw.
    pub state_by_rate: f64,
    /// d(dz/dt)/dz.
    pub state_by_state: f64,
    /// dT/dw.
    pub torque_by_rate: f64,
    /// dT/dz.
    pub torque_by_state: f64,
}
