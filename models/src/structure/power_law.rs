//! The thesis' non-uniform element (R. Gallagher and C. Lee, 1970): area and second moment follow a power law.
//!
//! A(xi) = A_0 (1 + s xi^b), I(xi) = I_0 (1 + r xi^a) through the near end, the middle and the far end: (5-17) to
//! (5-20), with the entries that the print has wrong corrected and the rotation's sign that of the uniform element.

use crate::tolerance::SAME_SECTION;
use nalgebra::Matrix4;

/// 1 + excess xi^exponent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaw {
    /// Value at the far end over that at the near end, less 1.
    pub excess: f64,
    /// Exponent.
    pub exponent: f64,
}

impl PowerLaw {
    /// Returns the law through the values at the near end, the middle and the far end: (5-19), (5-20). `None` if the
    /// middle is not strictly between the ends, unless all three are the same.
    pub fn fit(near: f64, middle: f64, far: f64) -> Option<Self> {
        let same = |a: f64, b: f64| (a - b).abs() <= SAME_SECTION * near.abs();
        if same(near, far) {
            return same(near, middle).then_some(Self { excess: 0.0, exponent: 1.0 });
        }
        let share = (middle - near) / (far - near);
        let monotone = share > 0.0 && share < 1.0 && near > 0.0;
        monotone.then(|| Self { excess: far / near - 1.0, exponent: -share.log2() })
    }

    /// The integral of excess x^exponent (c_1 + c_2 x + c_3 x^2 + ...) over x from 0 to 1, for the given c_1, c_2, ...:
    /// excess times the sum of c_k / (exponent + k). A power that the polynomial lacks adds nothing.
    fn moment(&self, polynomial: &[f64]) -> f64 {
        let powers = polynomial.iter().zip(1_u32..).filter(|(c, _)| **c != 0.0);
        self.excess * powers.map(|(c, k)| c / (self.exponent + f64::from(k))).sum::<f64>()
    }
}

/// Returns the mass matrix, (5-17) corrected; `line_mass` is rho A_0, kg/m.
pub fn element_mass(line_mass: f64, length: f64, law: &PowerLaw) -> Matrix4<f64> {
    let m =
        |uniform: f64, polynomial: &[f64]| line_mass * length * (uniform / 420.0 + law.moment(polynomial));
    let l = length;
    let m11 = m(156.0, &[1.0, 0.0, -6.0, 4.0, 9.0, -12.0, 4.0]);
    let m21 = l * m(22.0, &[0.0, 1.0, -2.0, -2.0, 8.0, -7.0, 2.0]);
    let m31 = m(54.0, &[0.0, 0.0, 3.0, -2.0, -9.0, 12.0, -4.0]);
    let m41 = -l * m(13.0, &[0.0, 0.0, 1.0, -1.0, -3.0, 5.0, -2.0]);
    let m22 = l * l * m(4.0, &[0.0, 0.0, 1.0, -4.0, 6.0, -4.0, 1.0]);
    let m32 = l * m(13.0, &[0.0, 0.0, 0.0, 3.0, -8.0, 7.0, -2.0]);
    let m42 = -l * l * m(3.0, &[0.0, 0.0, 0.0, 1.0, -3.0, 3.0, -1.0]);
    let m33 = m(156.0, &[0.0, 0.0, 0.0, 0.0, 9.0, -12.0, 4.0]);
    let m43 = -l * m(22.0, &[0.0, 0.0, 0.0, 0.0, 3.0, -5.0, 2.0]);
    let m44 = l * l * m(4.0, &[0.0, 0.0, 0.0, 0.0, 1.0, -2.0, 1.0]);
    Matrix4::new(m11, m21, m31, m41, m21, m22, m32, m42, m31, m32, m33, m43, m41, m42, m43, m44)
}

/// Returns the stiffness matrix, (5-18) in the sign convention of (5-5); `rigidity` is E I_0, N m^2.
pub fn element_stiffness(rigidity: f64, length: f64, law: &PowerLaw) -> Matrix4<f64> {
    let l = length;
    let k = |factor: f64, many: f64, polynomial: &[f64]| {
        factor * rigidity * (1.0 + many * law.moment(polynomial))
    };
    let k11 = k(12.0 / (l * l * l), 3.0, &[1.0, -4.0, 4.0]);
    let k21 = k(6.0 / (l * l), 2.0, &[2.0, -7.0, 6.0]);
    let k22 = k(4.0 / l, 1.0, &[4.0, -12.0, 9.0]);
    let k41 = k(6.0 / (l * l), 2.0, &[1.0, -5.0, 6.0]);
    let k42 = k(2.0 / l, 2.0, &[2.0, -9.0, 9.0]);
    let k44 = k(4.0 / l, 1.0, &[1.0, -6.0, 9.0]);
    Matrix4::new(k11, k21, -k11, k41, k21, k22, -k21, k42, -k11, -k21, k11, -k41, k41, k42, -k41, k44)
}
