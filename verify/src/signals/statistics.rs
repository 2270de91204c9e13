//! Mean, RMS and peak.

/// Returns the arithmetic mean; 0 of an empty series.
pub fn mean(samples: &[f64]) -> f64 {
    if samples.is_empty() { 0.0 } else { samples.iter().sum::<f64>() / samples.len() as f64 }
}

/// Returns the square root of the mean square; 0 of an empty series.
pub fn rms(samples: &[f64]) -> f64 {
    if samples.is_empty() {
        0.0
    } else {
        (samples.iter().map(|v| v * v).sum::<f64>() / samples.len() as f64).sqrt()
    }
}

/// Returns the largest modulus; 0 of an empty series, NaN if a sample is NaN.
pub fn peak(samples: &[f64]) -> f64 {
    samples.iter().map(|v| v.abs()).fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a })
}

/// Returns the series less its mean.
pub fn subtract_mean(samples: &[f64]) -> Vec<f64> {
    let middle = mean(samples);
    samples.iter().map(|v| v - middle).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_has_the_rms_it_should() {
        let sine: Vec<f64> =
            (0..1000).map(|k| 3.0 * (2.0 * std::f64::consts::PI * k as f64 / 100.0).sin()).collect();
        assert!((rms(&sine) - 3.0 / 2f64.sqrt()).abs() < 1e-12);
        assert!((peak(&sine) - 3.0).abs() < 1e-12);
        assert!(mean(&sine).abs() < 1e-12);
        assert!(peak(&[1.0, f64::NAN, 0.0]).is_nan());
    }
}
