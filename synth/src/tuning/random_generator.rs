//! The random numbers of starts and of generations.

/// A small portable generator (SplitMix64, Steele, Lea and Flood 2014).
pub(crate) struct RandomGenerator(pub u64);

impl RandomGenerator {
    /// Returns a number from -1 to 1.
    pub fn next_symmetric(&mut self, salt: usize) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15).wrapping_add(salt as u64);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Returns a number from 0 to below 1.
    pub fn next_share(&mut self) -> f64 {
        0.5 * (1.0 + self.next_symmetric(0))
    }

    /// Returns a whole number below `count`; 0 if that is 0.
    pub fn next_place(&mut self, count: usize) -> usize {
        ((self.next_share() * count as f64) as usize).min(count.saturating_sub(1))
    }
}
