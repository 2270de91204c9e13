//! True stick in a mechanism of several joints: which joints stick during a step, and what their friction holds.
//!
//! D. Karnopp's model leaves the torque at rest to the mechanism's momentum equations, which he derives separately for every
//! mechanism. Stated as a complementarity they are the same for all (J. Moreau 1988, D. Stewart and J. Trinkle 1996):
//! with the rates w = w_free - B T at the end of a step, B the joints' mobility over it, each joint has
//!
//! ```text
//!     w = 0  and  -T_- <= T <= T_+ ,   or   w > 0 and T = T_+ ,   or   w < 0 and T = -T_-
//! ```
//!
//! A joint that rests holds up to its breakaway levels, one that slides has its sliding level; a rate that would change
//! sign stops at zero instead. Nothing chatters or creeps, whatever the step.

use super::law::Law;
use super::model::FrictionModel;
use super::sliding::Stick;
use crate::tolerance::{MOST_SWEEPS, SETTLED};
use nalgebra::SMatrix;

/// A joint with true stick at the beginning of a step.
#[derive(Debug, Clone, Copy)]
pub struct Joint<'a> {
    /// Friction.
    pub friction: &'a FrictionModel,
    /// The factor on the Coulomb level.
    pub level: f64,
    /// Rate at the beginning of the step, rad/s.
    pub rate_rad_s: f64,
    /// Rate that it would have at the end without its own dry friction and the others', rad/s.
    pub free_rate_rad_s: f64,
}

/// The friction torques of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact<const N: usize> {
    /// Constant dry friction torques over the step, N m.
    pub torque_nm: [f64; N],
    /// Rates at the end of the step, rad/s; exactly 0 for a joint that sticks.
    pub rate_rad_s: [f64; N],
    /// Sweeps that were needed; [`MOST_SWEEPS`] if the torques still changed.
    pub sweeps: usize,
}

/// Returns the friction torques of N joints over a step.
///
/// `mobility` is B, (rad/s)/(N m): what a constant torque on joint j takes from the rate of joint i over the step;
/// symmetric positive definite for a mechanism. Joints whose law does not stick take no part (torque 0). Method: projected
/// Gauss-Seidel, which converges for every such B; one sweep is exact for a single joint.
pub fn contact_torques<const N: usize>(joints: &[Joint<'_>; N], mobility: &SMatrix<f64, N, N>) -> Contact<N> {
    let bounds: [Option<Stick>; N] = std::array::from_fn(|i| bounds(&joints[i]));
    let mut out = Contact {
        torque_nm: [0.0; N],
        rate_rad_s: std::array::from_fn(|i| joints[i].free_rate_rad_s),
        sweeps: 0,
    };
    let scale = joints.iter().map(|j| j.free_rate_rad_s.abs().max(j.rate_rad_s.abs())).fold(0.0, f64::max);
    while out.sweeps < MOST_SWEEPS {
        out.sweeps += 1;
        if out.sweep(&bounds, mobility) <= SETTLED * scale {
            break;
        }
    }
    out.settle(&bounds);
    out
}

impl<const N: usize> Contact<N> {
    /// Makes one pass over the joints; returns the largest change of a rate.
    fn sweep(&mut self, bounds: &[Option<Stick>; N], mobility: &SMatrix<f64, N, N>) -> f64 {
        let mut moved = 0.0_f64;
        for (i, bound) in bounds.iter().enumerate() {
            let Some(bound) = bound else { continue };
            let wanted = bound.holding_torque_nm(self.torque_nm[i] + self.rate_rad_s[i] / mobility[(i, i)]);
            let change = wanted - self.torque_nm[i];
            self.torque_nm[i] = wanted;
            for (k, rate) in self.rate_rad_s.iter_mut().enumerate() {
                *rate -= mobility[(k, i)] * change;
            }
            moved = moved.max((mobility[(i, i)] * change).abs());
        }
        moved
    }

    /// A joint inside its bounds is at rest exactly.
    fn settle(&mut self, bounds: &[Option<Stick>; N]) {
        for (i, bound) in bounds.iter().enumerate() {
            let inside = |b: &Stick| -b.negative_nm < self.torque_nm[i] && self.torque_nm[i] < b.positive_nm;
            if bound.as_ref().is_some_and(inside) {
                self.rate_rad_s[i] = 0.0;
            }
        }
    }
}

/// Returns the torques that a joint can have over the step: up to breakaway from rest, up to the sliding level in motion.
fn bounds(joint: &Joint<'_>) -> Option<Stick> {
    let Law::Sliding(law) = joint.friction.law() else { return None };
    let stick = joint.friction.stick(joint.level)?;
    if joint.rate_rad_s.abs() <= stick.rest_rate_rad_s {
        return Some(stick);
    }
    let share = law.level.at(joint.rate_rad_s) / law.breakaway_nm();
    Some(Stick { positive_nm: share * stick.positive_nm, negative_nm: share * stick.negative_nm, ..stick })
}
