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

use crate::Error;
use crate::parameters::LumpedStructure;
use counterpoise_linalg::{Mat, sym_gen_eigen};

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
    /// (the out-of-balance torque acts on the hub). Inertias and stiffness must be positive. A rigid structure
    /// ([`LumpedStructure::is_rigid`]) is one inertia without a mode.
    pub fn from_lumped(lumped: &LumpedStructure) -> Self {
        let (hub, beam) = (lumped.hub_inertia_kg_m2, lumped.beam_inertia_kg_m2);
        let total = hub + beam;
        if lumped.is_rigid() {
            return Self {
                inertia_kg_m2: total,
                out_of_balance_kg_m: lumped.out_of_balance_kg_m,
                vertical_offset_kg_m: lumped.vertical_offset_kg_m,
                modes: Vec::new(),
            };
        }
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

    /// Returns the structure of inertias in a chain: the modes of the diagonal matrix of inertias and the tridiagonal one of
    /// stiffnesses. Damping between the modes is left out, as modal damping means. The out-of-balance acts on the hub.
    ///
    /// # Errors
    /// [`Error::Linalg`] if the eigenproblem has no solution.
    pub fn chain(lumped: &LumpedStructure) -> Result<Self, Error> {
        if lumped.chain.is_empty() {
            return Ok(Self::from_lumped(lumped));
        }
        let mut inertias = vec![lumped.hub_inertia_kg_m2];
        let mut springs = Vec::new();
        if lumped.is_rigid() {
            inertias[0] += lumped.beam_inertia_kg_m2;
        } else {
            inertias.push(lumped.beam_inertia_kg_m2);
            springs.push([lumped.stiffness_nm_rad, lumped.damping_nm_s_rad]);
        }
        for link in &lumped.chain {
            inertias.push(link.inertia_kg_m2);
            springs.push([link.stiffness_nm_rad, link.damping_nm_s_rad]);
        }
        let n = inertias.len();
        let M = Mat::from_fn(n, n, |i, j| if i == j { inertias[i] } else { 0.0 });
        let of_springs = |kind: usize| {
            let mut matrix = Mat::zeros(n, n);
            for (i, spring) in springs.iter().enumerate() {
                for (row, column, sign) in
                    [(i, i, 1.0), (i + 1, i + 1, 1.0), (i, i + 1, -1.0), (i + 1, i, -1.0)]
                {
                    matrix[(row, column)] += sign * spring[kind];
                }
            }
            matrix
        };
        let (values, vectors) = sym_gen_eigen(&of_springs(0), &M)?;
        let damping = of_springs(1);
        // the first one is the rigid rotation
        let modes = (1..n).map(|k| {
            let shape = Mat::col(vectors.column(k));
            let frequency = values[k].max(0.0).sqrt();
            let sign = if shape[(0, 0)] < 0.0 { -1.0 } else { 1.0 };
            let damped = (&shape.t() * &(&damping * &shape))[(0, 0)];
            BodyMode {
                frequency_rad_s: frequency,
                damping_ratio: 0.5 * damped / frequency,
                hub_shape: sign * shape[(0, 0)],
                tip_shape: sign * shape[(n - 1, 0)],
                load_share_kg_m: lumped.out_of_balance_kg_m * sign * shape[(0, 0)],
            }
        });
        Ok(Self {
            inertia_kg_m2: inertias.iter().sum(),
            out_of_balance_kg_m: lumped.out_of_balance_kg_m,
            vertical_offset_kg_m: lumped.vertical_offset_kg_m,
            modes: modes.collect(),
        })
    }

    /// Returns the structure with an inertia added at its hub: the modes of M + a phi phi' and K, where phi is the hub's share of
    /// each coordinate. Damping between the new modes is left out, as modal damping means; a structure of one mode has none.
    ///
    /// # Errors
    /// [`Error::Linalg`] if the eigenproblem has no solution.
    pub fn with_hub_inertia(&self, added_kg_m2: f64) -> Result<Self, Error> {
        let n = self.modes.len();
        let hub: Vec<f64> = std::iter::once(1.0).chain(self.modes.iter().map(|m| m.hub_shape)).collect();
        let own = |i: usize| if i == 0 { self.inertia_kg_m2 } else { 1.0 };
        let M = Mat::from_fn(n + 1, n + 1, |i, j| {
            added_kg_m2 * hub[i] * hub[j] + if i == j { own(i) } else { 0.0 }
        });
        // the rigid rotation costs no energy: the flexible modes are those of what is left without it
        let total = M[(0, 0)];
        let apart = Mat::from_fn(n, n, |i, j| M[(i + 1, j + 1)] - M[(i + 1, 0)] * M[(0, j + 1)] / total);
        let K = Mat::from_fn(n, n, |i, j| if i == j { self.modes[i].frequency_rad_s.powi(2) } else { 0.0 });
        let (values, vectors) =
            if n == 0 { (Vec::new(), Mat::zeros(0, 0)) } else { sym_gen_eigen(&K, &apart)? };
        let modes = values.iter().enumerate().map(|(k, value)| {
            let q = vectors.column(k);
            let rigid = -(0..n).map(|i| M[(0, i + 1)] * q[i]).sum::<f64>() / total;
            let sum = |share: &dyn Fn(&BodyMode) -> f64| {
                self.modes.iter().zip(q).map(|(mode, q)| share(mode) * q).sum::<f64>()
            };
            let frequency = value.max(0.0).sqrt();
            let damped =
                self.modes.iter().zip(q).map(|(mode, q)| mode.damping_ratio * mode.frequency_rad_s * q * q);
            BodyMode {
                frequency_rad_s: frequency,
                damping_ratio: damped.sum::<f64>() / frequency,
                hub_shape: rigid + sum(&|mode| mode.hub_shape),
                tip_shape: rigid + sum(&|mode| mode.tip_shape),
                load_share_kg_m: rigid * self.out_of_balance_kg_m + sum(&|mode| mode.load_share_kg_m),
            }
        });
        Ok(Self { inertia_kg_m2: total, modes: modes.collect(), ..self.clone() })
    }
}
