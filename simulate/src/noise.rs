//! White noise of a seed, with independent streams.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// White noise of unit variance, five values a sample, by Box and Muller's method on ChaCha8.
#[derive(Debug, Clone)]
pub(crate) struct Noise {
    source: ChaCha8Rng,
    spare: Option<f64>,
}

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        Self { source: ChaCha8Rng::seed_from_u64(seed), spare: None }
    }

    /// Returns noise of a seed that is independent of the seed's other streams.
    pub(crate) fn from_stream(seed: u64, stream: u64) -> Self {
        let mut source = ChaCha8Rng::seed_from_u64(seed);
        source.set_stream(stream);
        Self { source, spare: None }
    }

    pub(crate) fn next(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = (-2.0 * self.next_uniform().ln()).sqrt();
        let (sin, cos) = (std::f64::consts::TAU * self.next_uniform()).sin_cos();
        self.spare = Some(radius * sin);
        radius * cos
    }

    /// Uniform in (0, 1\].
    pub(crate) fn next_uniform(&mut self) -> f64 {
        let bits = rand::Rng::next_u64(&mut self.source) >> 11;
        (bits as f64 + 1.0) / (1u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_white_of_unit_variance() {
        let mut noise = Noise::new(7);
        let values: Vec<f64> = (0..100_000).map(|_| noise.next()).collect();
        let mean = values.iter().sum::<f64>() / 1e5;
        let variance = values.iter().map(|v| v * v).sum::<f64>() / 1e5;
        let neighbour = values.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / 1e5;
        assert!(mean.abs() < 0.01 && (variance - 1.0).abs() < 0.02 && neighbour.abs() < 0.01);
    }
}
