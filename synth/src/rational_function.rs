//! A rational function of s by its gain, zeros and poles, and its realisation as a cascade of low-order sections.

use counterpoise_linalg::{C64, Mat};
use counterpoise_lti::{StateSpace, Timebase, series};

use crate::Error;
use crate::tolerance::REAL_ROOT;

/// `gain prod(s - z) / prod(s - p)`, never expanded.
#[derive(Debug, Clone, PartialEq)]
pub struct RationalFunction {
    /// Zeros, rad/s.
    pub zeros: Vec<C64>,
    /// Poles, rad/s.
    pub poles: Vec<C64>,
    /// The factor in front of the monic products.
    pub gain: f64,
}

impl RationalFunction {
    /// Returns the function with the given roots.
    pub fn new(zeros: &[C64], poles: &[C64], gain: f64) -> Self {
        Self { zeros: zeros.to_vec(), poles: poles.to_vec(), gain }
    }

    /// Returns its value at s.
    pub fn at(&self, s: C64) -> C64 {
        let product = |roots: &[C64]| roots.iter().fold(C64::ONE, |all, root| all * (s - root));
        product(&self.zeros) * self.gain / product(&self.poles)
    }

    /// Returns the product with `other`.
    pub fn times(&self, other: &Self) -> Self {
        let join = |a: &[C64], b: &[C64]| [a, b].concat();
        Self {
            zeros: join(&self.zeros, &other.zeros),
            poles: join(&self.poles, &other.poles),
            gain: self.gain * other.gain,
        }
    }

    /// Returns the reciprocal.
    pub fn inverse(&self) -> Self {
        Self { zeros: self.poles.clone(), poles: self.zeros.clone(), gain: 1.0 / self.gain }
    }

    /// Moves zeros and poles of the right half plane to the left, and makes the gain positive: the modulus on the axis stays.
    pub fn mirror_to_left(&self) -> Self {
        let left = |roots: &[C64]| roots.iter().map(|root| C64::new(-root.re.abs(), root.im)).collect();
        Self { zeros: left(&self.zeros), poles: left(&self.poles), gain: self.gain.abs() }
    }

    /// Returns poles minus zeros: negative where it rises without bound.
    pub fn relative_degree(&self) -> i32 {
        self.poles.len() as i32 - self.zeros.len() as i32
    }

    /// Returns zeros minus poles at s = 0: negative where it is infinite there.
    pub fn order_at_zero(&self) -> i32 {
        let count = |roots: &[C64]| roots.iter().filter(|root| root.norm() == 0.0).count() as i32;
        count(&self.zeros) - count(&self.poles)
    }

    /// Returns whether every number is finite and the gain is not zero.
    pub fn is_finite(&self) -> bool {
        let roots = self.zeros.iter().chain(&self.poles);
        self.gain.is_finite() && self.gain != 0.0 && roots.into_iter().all(|root| root.is_finite())
    }

    /// Returns a minimal realisation as a cascade of sections of order one and two (a longer one only where roots do not pair).
    ///
    /// # Errors
    /// [`Error::Lti`] if it is improper, or complex roots lack their conjugates.
    pub fn realise(&self) -> Result<StateSpace, Error> {
        let (zeros, poles) = (factors(&self.zeros)?, factors(&self.poles)?);
        let unit = StateSpace::gain(Mat::from_rows(&[&[self.gain]]), Timebase::Continuous)?;
        let sections = pair(zeros, poles)?;
        sections.iter().try_fold(unit, |all, section| Ok(series(&all, &realised_section(section)?)?))
    }
}

/// A monic real polynomial of degree up to two: [constant, linear], the leading one left out.
type Factor = Vec<f64>;

/// The monic real factors of degree one and two, slowest first.
fn factors(roots: &[C64]) -> Result<Vec<Factor>, Error> {
    let mut open: Vec<C64> = roots.to_vec();
    open.sort_by(|a, b| a.norm().total_cmp(&b.norm()).then(a.im.total_cmp(&b.im)));
    let mut out = Vec::new();
    while let Some(root) = open.pop() {
        if root.im.abs() <= REAL_ROOT * root.norm() {
            out.push(vec![-root.re]);
            continue;
        }
        let partner = open
            .iter()
            .position(|other| (other - root.conj()).norm() <= REAL_ROOT * root.norm().max(f64::MIN_POSITIVE));
        let Some(index) = partner else {
            let problem = "a complex root lacks its conjugate";
            return Err(counterpoise_lti::Error::Rational { what: "weight", problem }.into());
        };
        open.remove(index);
        out.push(vec![root.norm_sqr(), -2.0 * root.re]);
    }
    out.reverse();
    Ok(out)
}

struct Section {
    numerator: Vec<f64>,
    denominator: Vec<f64>,
}

/// Sections whose numerators have no higher degree than their denominators.
fn pair(zeros: Vec<Factor>, poles: Vec<Factor>) -> Result<Vec<Section>, Error> {
    let degree = |list: &[Factor]| list.iter().map(Vec::len).sum::<usize>();
    if degree(&zeros) > degree(&poles) {
        return Err(
            counterpoise_lti::Error::Rational { what: "weight", problem: "more zeros than poles" }.into()
        );
    }
    let mut sections: Vec<Section> =
        poles.into_iter().map(|p| Section { numerator: vec![1.0], denominator: monic(&p) }).collect();
    for zero in zeros {
        place(&mut sections, &monic(&zero));
    }
    Ok(sections)
}

/// Puts a zero factor into the first section with room; joins sections where none has enough.
fn place(sections: &mut Vec<Section>, zero: &[f64]) {
    let room = |s: &Section| s.denominator.len() - s.numerator.len();
    loop {
        if let Some(section) = sections.iter_mut().find(|s| room(s) + 1 >= zero.len()) {
            section.numerator = product(&section.numerator, zero);
            return;
        }
        let mut free: Vec<usize> = (0..sections.len()).filter(|&i| room(&sections[i]) > 0).collect();
        let (Some(last), Some(first)) = (free.pop(), free.first().copied()) else { return };
        let other = sections.remove(last);
        let joined = &mut sections[first];
        joined.numerator = product(&joined.numerator, &other.numerator);
        joined.denominator = product(&joined.denominator, &other.denominator);
    }
}

fn monic(factor: &[f64]) -> Vec<f64> {
    [factor, &[1.0]].concat()
}

/// The product of two polynomials, constant term first.
fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            out[i + j] += x * y;
        }
    }
    out
}

/// The controllable form of one section, its states scaled so that a mode of modulus w has entries of size w.
fn realised_section(section: &Section) -> Result<StateSpace, Error> {
    let n = section.denominator.len() - 1;
    let coefficient = |k: usize| section.numerator.get(k).copied().unwrap_or(0.0);
    let direct = coefficient(n);
    let size = section.denominator[0].abs().powf(1.0 / n as f64);
    let unit = if size > 0.0 { size } else { 1.0 };
    let power = |k: usize| unit.powi(k as i32);
    let A = Mat::from_fn(n, n, |i, j| match (i + 1 == n, j == i + 1) {
        (true, _) => -section.denominator[j] / power(n - 1 - j),
        (false, true) => unit,
        (false, false) => 0.0,
    });
    let B = Mat::from_fn(n, 1, |i, _| if i + 1 == n { 1.0 } else { 0.0 });
    let C = Mat::from_fn(1, n, |_, j| (coefficient(j) - direct * section.denominator[j]) / power(n - 1 - j));
    Ok(StateSpace::new(A, B, C, Mat::from_rows(&[&[direct]]), Timebase::Continuous)?)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use counterpoise_lti::response::response_at;

    #[test]
    fn a_cascade_of_mixed_sections_has_the_function_s_response() {
        let zeros = [C64::new(-2.0, 5.0), C64::new(-2.0, -5.0), C64::new(-30.0, 0.0)];
        let poles = [C64::new(-0.1, 0.0), C64::new(-7.0, 0.0), C64::new(-1.0, 90.0), C64::new(-1.0, -90.0)];
        let function = RationalFunction::new(&zeros, &poles, 4.0);
        let system = function.realise().unwrap();
        assert_eq!(system.order(), 4);
        for rate in [0.01, 1.0, 5.0, 90.0, 1e3] {
            let (found, expected) =
                (response_at(&system, rate).unwrap()[(0, 0)], function.at(C64::new(0.0, rate)));
            assert!((found - expected).norm() < 1e-12 * expected.norm(), "{rate}: {found} {expected}");
        }
    }

    #[test]
    fn complex_zeros_over_real_poles_share_a_section() {
        let zeros = [C64::new(-2.0, 5.0), C64::new(-2.0, -5.0)];
        let function = RationalFunction::new(&zeros, &[C64::new(-1.0, 0.0), C64::new(-50.0, 0.0)], 2.0);
        let system = function.realise().unwrap();
        let found = response_at(&system, 3.0).unwrap()[(0, 0)];
        assert!((found - function.at(C64::new(0.0, 3.0))).norm() < 1e-12);
    }

    #[test]
    fn unpaired_roots_are_refused() {
        assert!(RationalFunction::new(&[], &[C64::new(-1.0, 1.0)], 1.0).realise().is_err());
        assert!(RationalFunction::new(&[C64::ONE, C64::ONE], &[C64::ONE], 1.0).realise().is_err());
    }
}
