//! From finite elements to what the plant needs: a few modes, or two inertias.

use super::fe::FeModel;
use super::modes::{Direction, Modes, Support, undamped_modes};
use crate::Error;
use crate::parameters::LumpedStructure;
use crate::plant::{Body, BodyMode};
use counterpoise_linalg::Mat;

/// The structure pinned at the hub, as the plant takes it, with what the plant does not need.
///
/// q(t) = pitch theta_r + sum phi_k eta_k, relative to the platform's heave, solves M q'' + C q' + K q =
/// T_hub e_hub - G M heave with the hub's deflection held. In these coordinates it is [`Body`]'s set of equations:
/// J = pitch' M pitch, mu = heave' M pitch, p_k = heave' M phi_k; phi_k and psi_k are the rotations of hub and tip.
#[derive(Debug, Clone, PartialEq)]
pub struct PinnedStructure {
    /// The body in modal coordinates.
    pub body: Body,
    /// Total mass, kg.
    pub mass_kg: f64,
    /// Distance of the tip from the pivot, m.
    pub tip_arm_m: f64,
    /// Deflection of the tip per unit of each mode, m/rad: y = arm theta_r + sum (this) eta_k.
    pub tip_deflection_m: Vec<f64>,
    /// Rotation of the hub per N m of static hub torque that the modes left out would add, rad/(N m).
    pub residual_flexibility_rad_nm: f64,
}

/// The structure with its hub's rotation as a coordinate and the flexible modes of the locked hub.
///
/// q = pitch theta_h + sum phi_k eta_k gives J theta_h'' + sum c_k eta_k'' = T_hub - mu G and
/// eta_k'' + 2 zeta_k w_k eta_k' + w_k^2 eta_k + c_k theta_h'' = -p_k G: coupled by c_k = pitch' M phi_k.
#[derive(Debug, Clone, PartialEq)]
pub struct LockedStructure {
    /// Moment of inertia J about the pivot, kg m^2.
    pub inertia_kg_m2: f64,
    /// First moment mu, kg m.
    pub out_of_balance_kg_m: f64,
    /// The modes of the locked hub.
    pub modes: Vec<LockedMode>,
}

/// A mode of the structure with its hub locked, of unit modal mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LockedMode {
    /// Natural frequency w, rad/s.
    pub frequency_rad_s: f64,
    /// Inertial coupling c to the hub's rotation.
    pub hub_coupling: f64,
    /// Work p of a unit of G on the mode, kg m.
    pub load_share_kg_m: f64,
    /// Rotation of the tip relative to the hub.
    pub tip_shape: f64,
    /// Deflection of the tip relative to the hub's axis, m/rad.
    pub tip_deflection_m: f64,
}

/// Returns the first `count` modes (or all there are) of the structure pinned at its hub.
///
/// The damping ratios are those of flexible mode 1, 2, ..., the last holding for all above; a model with a matrix C takes
/// phi' C phi / (2 w) instead.
///
/// # Errors
/// As for [`undamped_modes`] with the hub pinned.
pub fn pinned_modes(model: &FeModel, damping_ratios: &[f64], count: usize) -> Result<PinnedStructure, Error> {
    let all = undamped_modes(model, Support::Pinned)?;
    let hub = model.hub.ok_or(Error::NoHubNode)?;
    let shares = all.participation(model, Direction::Heave);
    let frequencies = all.flexible_rad_s();
    let kept = count.min(frequencies.len());
    let mode = |k: usize| BodyMode {
        frequency_rad_s: frequencies[k],
        damping_ratio: damping_ratio(model, &all, damping_ratios, k),
        hub_shape: all.flexible_shape(k)[hub.rotation],
        tip_shape: all.flexible_shape(k)[model.tip.rotation],
        load_share_kg_m: shares[all.rigid + k],
    };
    let flexibility = |k: usize| (all.flexible_shape(k)[hub.rotation] / frequencies[k]).powi(2);
    Ok(PinnedStructure {
        body: Body {
            inertia_kg_m2: model.inertia_kg_m2(),
            out_of_balance_kg_m: model.first_moment_kg_m(),
            vertical_offset_kg_m: 0.0,
            modes: (0..kept).map(mode).collect(),
        },
        mass_kg: model.mass_kg(),
        tip_arm_m: model.tip_arm_m,
        tip_deflection_m: (0..kept).map(|k| all.flexible_shape(k)[model.tip.deflection]).collect(),
        residual_flexibility_rad_nm: (kept..frequencies.len()).map(flexibility).sum(),
    })
}

/// Returns the first `count` modes (or all there are) of the structure with its hub locked.
///
/// # Errors
/// As for [`undamped_modes`] with the hub clamped.
pub fn locked_modes(model: &FeModel, count: usize) -> Result<LockedStructure, Error> {
    let all = undamped_modes(model, Support::Clamped)?;
    let shares = all.participation(model, Direction::Heave);
    let couplings = all.participation(model, Direction::Pitch);
    let mode = |k: usize| LockedMode {
        frequency_rad_s: all.frequencies_rad_s[k],
        hub_coupling: couplings[k],
        load_share_kg_m: shares[k],
        tip_shape: all.shapes[(model.tip.rotation, k)],
        tip_deflection_m: all.shapes[(model.tip.deflection, k)],
    };
    Ok(LockedStructure {
        inertia_kg_m2: model.inertia_kg_m2(),
        out_of_balance_kg_m: model.first_moment_kg_m(),
        modes: (0..count.min(all.frequencies_rad_s.len())).map(mode).collect(),
    })
}

/// Returns the two-inertia structure with the model's inertia J, first moment, first pinned frequency w_p (with its damping
/// ratio) and first hub-locked frequency w_c.
///
/// J_h = J (w_c / w_p)^2, J_b = J - J_h, K_h = J_b w_c^2, D_h = 2 zeta w_p J_h J_b / J. Then K_h (1/J_h + 1/J_b) = w_p^2.
/// The out-of-balance torque acts on the hub, so the flexible share of weight and heave is the lumped plant's own.
///
/// # Errors
/// As for [`pinned_modes`] and [`locked_modes`].
pub fn reduce_to_lumped(model: &FeModel, damping_ratios: &[f64]) -> Result<LumpedStructure, Error> {
    let pinned = undamped_modes(model, Support::Pinned)?;
    let locked = undamped_modes(model, Support::Clamped)?;
    let (wp, wc) = (pinned.flexible_rad_s()[0], locked.flexible_rad_s()[0]);
    let inertia = model.inertia_kg_m2();
    let hub = inertia * (wc / wp).powi(2);
    let beam = inertia - hub;
    let ratio = damping_ratio(model, &pinned, damping_ratios, 0);
    Ok(LumpedStructure {
        hub_inertia_kg_m2: hub,
        beam_inertia_kg_m2: beam,
        stiffness_nm_rad: beam * wc * wc,
        damping_nm_s_rad: 2.0 * ratio * wp * hub * beam / inertia,
        out_of_balance_kg_m: model.first_moment_kg_m(),
        vertical_offset_kg_m: 0.0,
        position_stiffness_nm_rad: 0.0,
        position_stiffness_centre_rad: 0.0,
        hysteresis_nm: 0.0,
        hysteresis_stiffness_nm_rad: 0.0,
        chain: Vec::new(),
    })
}

fn damping_ratio(model: &FeModel, modes: &Modes, ratios: &[f64], k: usize) -> f64 {
    let Some(C) = &model.C else {
        return ratios.get(k).or(ratios.last()).copied().unwrap_or(0.0);
    };
    let shape = Mat::col(modes.flexible_shape(k));
    (&shape.t() * &(C * &shape))[(0, 0)] / (2.0 * modes.flexible_rad_s()[k])
}
