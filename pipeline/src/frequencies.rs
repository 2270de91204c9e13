//! Grids of frequencies.

/// Returns frequencies at a constant ratio, Hz, both ends included.
pub fn logarithmic_hz([from_hz, to_hz]: [f64; 2], count: usize) -> Vec<f64> {
    let step = (to_hz / from_hz).ln() / count.saturating_sub(1).max(1) as f64;
    (0..count).map(|k| from_hz * (step * k as f64).exp()).collect()
}
