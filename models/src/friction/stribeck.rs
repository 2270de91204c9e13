//! The level of dry friction as a function of the rate.

use super::real::Real;
use crate::parameters::StribeckCurve;
use crate::tolerance::SPENT;

/// g(w) = F_c + (F_s - F_c) shape(|w| / w_s), N m: F_s at rest, F_c at speed.
///
/// Shapes: exp(-x) (Tustin 1947), exp(-x^2) (Gaussian; Armstrong-Helouvry 1991), exp(-x^a) (Bo and Pavelescu 1982),
/// 1/(1 + x^2) (Lorentzian; Hess and Soom 1990), and a cubic that is given (polynomial), constant beyond x = 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StribeckLevel<R = f64> {
    coulomb_nm: R,
    excess_nm: R,
    per_rate_s_rad: R,
    curve: StribeckCurve,
}

impl StribeckLevel {
    /// Returns the level that starts at `static_ratio` x `coulomb_nm` and has fallen at `rate_rad_s` by its curve.
    pub fn new(coulomb_nm: f64, static_ratio: f64, rate_rad_s: f64, curve: StribeckCurve) -> Self {
        Self {
            coulomb_nm,
            excess_nm: (static_ratio - 1.0) * coulomb_nm,
            per_rate_s_rad: rate_rad_s.recip(),
            curve,
        }
    }

    /// Returns the Coulomb level F_c, N m.
    pub fn coulomb_nm(&self) -> f64 {
        self.coulomb_nm
    }

    /// Returns the level at rest F_s, N m.
    pub fn static_nm(&self) -> f64 {
        self.coulomb_nm + self.excess_nm
    }

    /// Returns the same level at rest, whatever the rate.
    pub fn level_at_rest(&self) -> Self {
        Self { coulomb_nm: self.static_nm(), excess_nm: 0.0, curve: StribeckCurve::Gaussian, ..*self }
    }

    /// Returns dg/dw, N m s/rad; odd in w, 0 at w = 0.
    #[inline]
    pub fn slope(&self, rate_rad_s: f64) -> f64 {
        if self.is_constant() || rate_rad_s == 0.0 {
            return 0.0;
        }
        let x = rate_rad_s.abs() * self.per_rate_s_rad;
        let per_x = self.excess_nm * self.shape_slope(x) + self.coulomb_nm * cubic_slope(self.curve, x);
        per_x * self.per_rate_s_rad * rate_rad_s.signum()
    }

    fn shape_slope(&self, x: f64) -> f64 {
        match self.curve {
            StribeckCurve::Gaussian if x > SPENT => 0.0,
            StribeckCurve::Tustin => -(-x).exp(),
            StribeckCurve::Gaussian => -2.0 * x * (-x * x).exp(),
            StribeckCurve::Exponential { exponent } => {
                -exponent * x.powf(exponent - 1.0) * (-x.powf(exponent)).exp()
            }
            StribeckCurve::Lorentzian => -2.0 * x / (1.0 + x * x).powi(2),
            StribeckCurve::Polynomial { .. } => 0.0,
        }
    }
}

impl<R: Copy> StribeckLevel<R> {
    /// Returns the level in other numbers: each of its numbers as `convert` has it.
    #[inline(always)]
    pub fn map_numbers<T>(&self, convert: impl Fn(R) -> T) -> StribeckLevel<T> {
        StribeckLevel {
            coulomb_nm: convert(self.coulomb_nm),
            excess_nm: convert(self.excess_nm),
            per_rate_s_rad: convert(self.per_rate_s_rad),
            curve: self.curve,
        }
    }
}

/// Returns the levels of several laws side by side; `None` if their curves differ.
pub(super) fn join_levels<const N: usize>(levels: [StribeckLevel; N]) -> Option<StribeckLevel<[f64; N]>> {
    let curve = levels.first()?.curve;
    levels.iter().all(|level| level.curve == curve).then(|| StribeckLevel {
        coulomb_nm: levels.map(|level| level.coulomb_nm),
        excess_nm: levels.map(|level| level.excess_nm),
        per_rate_s_rad: levels.map(|level| level.per_rate_s_rad),
        curve,
    })
}

impl<R: Real> StribeckLevel<R> {
    /// Returns g(w), N m; even in w.
    #[inline(always)]
    pub fn at(&self, rate_rad_s: R) -> R {
        if self.is_constant() {
            return self.coulomb_nm;
        }
        let x = rate_rad_s.abs() * self.per_rate_s_rad;
        self.coulomb_nm + self.excess_nm * self.shape(x) + self.coulomb_nm * cubic(self.curve, x)
    }

    #[inline(always)]
    fn is_constant(&self) -> bool {
        self.excess_nm.is_zero_throughout() && !matches!(self.curve, StribeckCurve::Polynomial { .. })
    }

    #[inline(always)]
    fn shape(&self, x: R) -> R {
        let one = x.constant(1.0);
        match self.curve {
            StribeckCurve::Tustin => (-x).exp(),
            StribeckCurve::Gaussian => x.gaussian(),
            StribeckCurve::Exponential { exponent } => (-x.powf(exponent)).exp(),
            StribeckCurve::Lorentzian => one / (one + x * x),
            StribeckCurve::Polynomial { .. } => one,
        }
    }
}

#[inline(always)]
fn cubic<R: Real>(curve: StribeckCurve, x: R) -> R {
    let StribeckCurve::Polynomial { coefficients } = curve else { return x.constant(0.0) };
    let [c1, c2, c3] = coefficients;
    let (c1, c2, c3) = (x.constant(c1), x.constant(c2), x.constant(c3));
    let x = x.min(x.constant(1.0));
    x * (c1 + x * (c2 + x * c3))
}

fn cubic_slope(curve: StribeckCurve, x: f64) -> f64 {
    match curve {
        StribeckCurve::Polynomial { coefficients: [c1, c2, c3] } if x < 1.0 => {
            c1 + x * (2.0 * c2 + x * 3.0 * c3)
        }
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CURVES: [StribeckCurve; 5] = [
        StribeckCurve::Tustin,
        StribeckCurve::Gaussian,
        StribeckCurve::Exponential { exponent: 1.5 },
        StribeckCurve::Lorentzian,
        StribeckCurve::Polynomial { coefficients: [0.0, -1.5, 1.0] },
    ];

    #[test]
    fn starts_at_the_static_level_and_is_even() {
        for curve in CURVES {
            let level = StribeckLevel::new(2.0, 1.5, 0.01, curve);
            assert!((level.at(0.0) - 3.0).abs() < 1e-15);
            assert_eq!(level.at(0.007), level.at(-0.007));
            assert!((level.at(10.0) - 2.0).abs() < 1e-5, "{curve:?}");
        }
    }

    #[test]
    fn at_the_stribeck_rate_each_shape_has_its_value() {
        let excess = |curve| StribeckLevel::new(1.0, 2.0, 0.3, curve).at(0.3) - 1.0;
        let e = (-1.0_f64).exp();
        assert!((excess(StribeckCurve::Tustin) - e).abs() < 1e-15);
        assert!((excess(StribeckCurve::Gaussian) - e).abs() < 1e-15);
        assert!((excess(StribeckCurve::Exponential { exponent: 0.5 }) - e).abs() < 1e-15);
        assert!((excess(StribeckCurve::Lorentzian) - 0.5).abs() < 1e-15);
    }

    #[test]
    fn the_slope_is_the_derivative() {
        for curve in CURVES {
            let level = StribeckLevel::new(2.0, 1.5, 0.01, curve);
            for rate in [-0.02, -0.004, 0.003, 0.0099] {
                let step = 1e-8;
                let difference = (level.at(rate + step) - level.at(rate - step)) / (2.0 * step);
                assert!(
                    (level.slope(rate) - difference).abs() < 1e-4 * (1.0 + difference.abs()),
                    "{curve:?} {rate}"
                );
            }
        }
    }
}
