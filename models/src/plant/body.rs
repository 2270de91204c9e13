//! The structure in pinned-free modal coordinates: a rigid rotation about the pivot and its flexible modes.
//!
//! ```text
//!     theta_h = theta_r + sum phi_k q_k               hub angle
//!     theta_t = theta_r + sum psi_k q_k               tip angle
//!     J theta_r''                       = T_hub - mu G
//!     q_k'' + 2 zeta_k w_k q_k' + w_k^2 q_k = phi_k T_hub - p_k G
//!     G = (g + a_p) cos theta_h
//! ```
//!
//! T_hub is every torque that acts at the hub (gear, pivot friction, spring), G the weight and heave that act on
//! every mass: mu is the first moment, p_k the work that a unit of G does on mode k. The modes are scaled to unit
//! modal mass (kg m^2, so that q_k has the unit rad). Undamped cross terms are absent: damping is modal.

use crate::parameters::Lumped;

/// The structure in pinned-free modal coordinates; the module's documentation has the equations.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Moment of inertia about the pivot, J, kg m^2.
    pub inertia_kg_m2: f64,
    /// First moment of mass about the pivot, mu, kg m, positive nose-heavy.
    pub out_of_balance_kg_m: f64,
    /// First moment of mass above the pivot axis, nu, kg m; its torque acts at the hub.
    pub vertical_offset_kg_m: f64,
    /// The flexible modes of the structure pinned at the hub, by rising frequency.
    pub modes: Vec<BodyMode>,
}

/// A flexible mode of the pinned structure, of unit modal mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyMode {
    /// Natural frequency w, rad/s.
    pub frequency_rad_s: f64,
    /// Damping ratio zeta.
    pub damping_ratio: f64,
    /// Rotation of the hub per unit of the mode, phi.
    pub hub_shape: f64,
    /// Rotation of the tip per unit of the mode, psi.
    pub tip_shape: f64,
    /// Work of a unit of G on a unit of the mode, p, kg m.
    pub load_share_kg_m: f64,
}

impl Body {
    /// Returns the two-inertia structure, exactly: one rigid rotation and one mode with
    ///
    /// ```text
    ///     m = J_h J_b / (J_h + J_b),  w^2 = K_h / m,  2 zeta w = D_h / m,
    ///     phi = sqrt(J_b / (J_h J)),  psi = -sqrt(J_h / (J_b J)),  p = mu phi
    /// ```
    ///
    /// (the out-of-balance torque acts on the hub). Inertias and stiffness must be positive.
    pub fn lumped(lumped: &Lumped) -> Self {
        let (hub, beam) = (lumped.hub_inertia_kg_m2, lumped.beam_inertia_kg_m2);
        let total = hub + beam;
        let reduced = hub * beam / total;
        let frequency = (lumped.stiffness_nm_rad / reduced).sqrt();
        let hub_shape = (beam / (hub * total)).sqrt();
        let mode = BodyMode {
            frequency_rad_s: frequency,
            damping_ratio: 0.5 * lumped.damping_nm_s_rad / (reduced * frequency),
            hub_shape,
            tip_shape: -(hub / (beam * total)).sqrt(),
            load_share_kg_m: lumped.out_of_balance_kg_m * hub_shape,
        };
        Self {
            inertia_kg_m2: total,
            out_of_balance_kg_m: lumped.out_of_balance_kg_m,
            vertical_offset_kg_m: lumped.vertical_offset_kg_m,
            modes: vec![mode],
        }
    }
}
