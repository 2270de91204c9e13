//! Sobol's sequence: points that fill the cube more evenly than chance, whatever their number.

use ndarray::Array2;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::Error;

/// Primitive polynomials (degree, inner coefficients) and first direction numbers of dimensions 2 to 18: Joe and Kuo 2008,
/// *Constructing Sobol sequences with better two-dimensional projections*, their table new-joe-kuo-6.
const DIRECTIONS: [(u32, u32, &[u32]); 17] = [
    (1, 0, &[1]),
    (2, 1, &[1, 3]),
    (3, 1, &[1, 3, 1]),
    (3, 2, &[1, 1, 1]),
    (4, 1, &[1, 1, 3, 3]),
    (4, 4, &[1, 3, 5, 13]),
    (5, 2, &[1, 1, 5, 5, 17]),
    (5, 4, &[1, 1, 5, 5, 5]),
    (5, 7, &[1, 1, 7, 11, 19]),
    (5, 11, &[1, 1, 5, 1, 1]),
    (5, 13, &[1, 1, 1, 3, 11]),
    (5, 14, &[1, 3, 5, 5, 31]),
    (6, 1, &[1, 3, 3, 9, 7, 49]),
    (6, 13, &[1, 1, 1, 15, 21, 21]),
    (6, 16, &[1, 3, 1, 13, 27, 49]),
    (6, 19, &[1, 1, 1, 15, 7, 5]),
    (6, 22, &[1, 3, 1, 15, 13, 25]),
];

/// Most dimensions: one for every parameter that can vary.
pub const MOST_DIMENSIONS: usize = DIRECTIONS.len() + 1;
const BITS: u32 = 32;

/// Returns the first `samples` points of the open unit cube, samples x dimensions, each coordinate shifted by its own random bits (a digital shift,
/// which keeps every stratum): a pure function of its arguments. Point k does not depend on how many there are.
///
/// # Errors
/// [`Error::Range`] for no dimension, or more than [`MOST_DIMENSIONS`].
pub fn sobol(samples: usize, dimensions: usize, seed: u64) -> Result<Array2<f64>, Error> {
    if dimensions == 0 || dimensions > MOST_DIMENSIONS {
        let value = dimensions as f64;
        return Err(Error::Range { what: "parameters of a Sobol campaign", value, allowed: "1 to 18" });
    }
    let numbers: Vec<[u32; BITS as usize]> = (0..dimensions).map(direction_numbers).collect();
    let shifts: Vec<u32> = (0..dimensions).map(|dimension| shift(dimension, seed)).collect();
    let mut at = vec![0u32; dimensions];
    let mut points = Array2::zeros((samples, dimensions));
    for (k, mut point) in points.rows_mut().into_iter().enumerate() {
        let shifted = at.iter().zip(&shifts).map(|(x, s)| (f64::from(x ^ s) + 0.5) / 2f64.powi(32));
        point.iter_mut().zip(shifted).for_each(|(u, shifted)| *u = shifted);
        let bit = (k as u64).trailing_ones().min(BITS - 1) as usize;
        at.iter_mut().zip(&numbers).for_each(|(x, v)| *x ^= v[bit]);
    }
    Ok(points)
}

fn shift(dimension: usize, seed: u64) -> u32 {
    let mut source = ChaCha8Rng::seed_from_u64(seed);
    source.set_stream(dimension as u64 + 1);
    source.next_u32()
}

fn direction_numbers(dimension: usize) -> [u32; BITS as usize] {
    let mut v = [0u32; BITS as usize];
    let Some((degree, inner, first)) = dimension.checked_sub(1).map(|k| DIRECTIONS[k]) else {
        (0..BITS).for_each(|k| v[k as usize] = 1 << (BITS - 1 - k));
        return v;
    };
    let s = degree as usize;
    for k in 0..BITS as usize {
        v[k] = if k < s {
            first[k] << (BITS as usize - 1 - k)
        } else {
            let own = v[k - s] ^ (v[k - s] >> s);
            (1..s).filter(|j| inner >> (s - 1 - j) & 1 == 1).fold(own, |sum, j| sum ^ v[k - j])
        };
    }
    v
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use ndarray::{ArrayView1, s};

    #[test]
    fn every_coordinate_is_stratified_and_a_seed_repeats() {
        let points = sobol(256, MOST_DIMENSIONS, 3).unwrap();
        for d in 0..MOST_DIMENSIONS {
            let mut strata: Vec<usize> = points.column(d).iter().map(|u| (u * 256.0) as usize).collect();
            strata.sort_unstable();
            assert_eq!(strata, (0..256).collect::<Vec<_>>(), "dimension {d}");
        }
        assert_eq!(points, sobol(256, MOST_DIMENSIONS, 3).unwrap());
        assert_ne!(points, sobol(256, MOST_DIMENSIONS, 4).unwrap());
        assert_eq!(points.slice(s![..100, ..]), sobol(100, MOST_DIMENSIONS, 3).unwrap());
        assert!(sobol(1, MOST_DIMENSIONS + 1, 1).is_err());
    }

    #[test]
    fn a_smooth_integral_is_closer_than_by_chance() {
        // the mean of the product of 1 + (u - 1/2) / (d + 1) is 1
        let points = sobol(4096, 10, 1).unwrap();
        let value = |p: ArrayView1<'_, f64>| {
            p.iter().enumerate().map(|(d, u)| 1.0 + (u - 0.5) / (d + 1) as f64).product::<f64>()
        };
        let mean = points.rows().into_iter().map(value).sum::<f64>() / 4096.0;
        // by chance the standard error is 5e-3
        assert!((mean - 1.0).abs() < 5e-4, "{mean}");
    }

    #[test]
    fn the_first_two_dimensions_fill_every_elementary_box() {
        let points = sobol(64, 2, 9).unwrap();
        let mut boxes: Vec<usize> =
            points.rows().into_iter().map(|p| 8 * (p[0] * 8.0) as usize + (p[1] * 8.0) as usize).collect();
        boxes.sort_unstable();
        boxes.dedup();
        assert_eq!(boxes.len(), 64);
    }

    #[test]
    fn an_unshifted_point_is_that_of_the_published_numbers() {
        // point 37 times 64 of scipy.stats.qmc.Sobol(18, scramble=False), SciPy 1.17, which reads Joe and Kuo's table
        let published = [59, 41, 37, 59, 49, 19, 11, 51, 39, 11, 1, 5, 37, 55, 7, 31, 51, 27];
        let gray = 37u32 ^ (37 >> 1);
        for (dimension, expected) in published.into_iter().enumerate() {
            let numbers = direction_numbers(dimension);
            let at = (0..BITS as usize).filter(|k| gray >> k & 1 == 1).fold(0, |x, k| x ^ numbers[k]);
            assert_eq!(at >> (BITS - 6), expected, "dimension {dimension}");
        }
    }
}
