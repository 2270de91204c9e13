//! The bristle law: bonds that bend with the displacement, snap at a limit and form again.

use super::stribeck::StribeckLevel;
use crate::tolerance::MEMORY_BONDS;

/// T = k(w) sum z_i; each deflection z_i follows the displacement and, at +/- bond, snaps to a fraction of it.
///
/// The states are the deflections z_1..z_N (rad) and the counts of snaps n_1..n_N. A new bond forms at a fraction of
/// the limit that is spread evenly over 0 to 1 by a fixed hash of i and n_i: repeatable, in place of the paper's random
/// numbers. (A regular sequence would bring the bristles into step with each other.) Evenly spread fractions give the mean deflection 2/3 bond while sliding, hence k = 3 g(w) / (2 N bond), and a
/// breakaway of 3/2 of the sliding level when all bonds start unbent. D. Haessig and B. Friedland, "On the modeling
/// and simulation of friction", ASME JDSMC 113, 1991, where sigma_0(v) falls with the rate as g does here.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bristle {
    /// Mean sliding level by the rate.
    pub level: StribeckLevel,
    /// Number of bristles N.
    pub bristles: usize,
    /// Deflection at which a bond snaps, rad.
    pub bond_rad: f64,
}

/// Mean deflection of a bristle over the limit of its bond while sliding, for fractions that are spread evenly over 0 to 1:
/// the integral of (f + 1) / 2, weighted by the distance 1 - f that the bond lasts.
pub const MEAN_DEFLECTION: f64 = 2.0 / 3.0;

impl Bristle {
    /// Returns the torque, N m, from the deflections (and counts, unused).
    #[inline]
    pub fn torque(&self, rate_rad_s: f64, level: f64, states: &[f64]) -> f64 {
        let bent: f64 = states.iter().take(self.bristles).sum();
        level * self.stiffness_nm_rad(rate_rad_s) * bent
    }

    /// Writes dz_i/dt = w, rad/s, and 0 for the counts.
    #[inline]
    pub fn derivative(&self, rate_rad_s: f64, slopes: &mut [f64]) {
        for (i, slope) in slopes.iter_mut().enumerate() {
            *slope = if i < self.bristles { rate_rad_s } else { 0.0 };
        }
    }

    /// Returns the states after a displacement, with every snap on the way.
    pub fn displace(&self, displacement_rad: f64, states: &mut [f64]) {
        let reach = MEMORY_BONDS * self.bond_rad;
        let displacement = displacement_rad.clamp(-reach, reach);
        let (deflections, counts) = states.split_at_mut(self.bristles);
        for (i, (z, count)) in deflections.iter_mut().zip(counts).enumerate() {
            self.drag(i, displacement, z, count);
        }
    }

    /// Returns the states with every bond beyond its limit snapped; an integrator calls it after each step.
    pub fn project(&self, states: &mut [f64]) {
        self.displace(0.0, states);
    }

    /// Returns the stiffness k(w) of one bristle, N m/rad.
    #[inline]
    pub fn stiffness_nm_rad(&self, rate_rad_s: f64) -> f64 {
        self.level.at(rate_rad_s) / (MEAN_DEFLECTION * self.bristles as f64 * self.bond_rad)
    }

    fn drag(&self, index: usize, displacement: f64, z: &mut f64, count: &mut f64) {
        let mut target = *z + displacement;
        while target.abs() >= self.bond_rad {
            let beyond = target.abs() - self.bond_rad;
            *count += 1.0;
            let start = fraction(index as u64, *count as u64);
            target = target.signum() * (start * self.bond_rad + beyond);
        }
        *z = target;
    }
}

/// Returns a number from 0 up to 1 (excluded) for the n-th bond of a bristle: the finaliser of SplitMix64.
fn fraction(index: u64, count: u64) -> f64 {
    let mut x =
        index.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(count.wrapping_mul(0xd1b5_4a32_d192_ed03));
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::StribeckCurve;

    fn bristle(bristles: usize) -> Bristle {
        Bristle {
            level: StribeckLevel::new(2.0, 1.0, 1.0, StribeckCurve::Gaussian),
            bristles,
            bond_rad: 1e-3,
        }
    }

    fn torques(law: &Bristle, steps: usize) -> Vec<f64> {
        let mut states = vec![0.0; 2 * law.bristles];
        let record = |_| {
            law.displace(1e-5, &mut states);
            law.torque(1.0, 1.0, &states)
        };
        (0..steps).map(record).collect()
    }

    #[test]
    fn unbent_bonds_break_away_at_three_halves_of_the_level() {
        let peak = torques(&bristle(25), 200).into_iter().fold(0.0, f64::max);
        assert!((peak / 3.0 - 1.0).abs() < 0.02, "{peak}");
    }

    #[test]
    fn the_mean_sliding_torque_is_the_level() {
        let slid: Vec<f64> = torques(&bristle(25), 40_000).split_off(1000);
        let mean = slid.iter().sum::<f64>() / slid.len() as f64;
        assert!((mean / 2.0 - 1.0).abs() < 0.01, "{mean}");
        let spread = slid.iter().map(|t| (t - mean).abs()).fold(0.0, f64::max);
        assert!(spread < 0.3 * mean, "{spread}");
    }
}
