//! Zeros, poles and gain: what a person reads and what a weight is written as.

use crate::connect::series;
use crate::error::OperationContext;
use crate::response::Response;
use crate::root_order::sort_roots;
use crate::roots::{poles, zeros};
use crate::scaling::balance;
use crate::tolerance::{APART_FROM_ROOTS, CONJUGATE, GAIN_POINTS, KNOWN_GAIN};
use crate::{C64, Error, Mat, StateSpace, Timebase};
use counterpoise_linalg as linalg;

/// gain (s - z1)(s - z2).../((s - p1)(s - p2)...) in s or z. Complex roots come in conjugate pairs.
#[derive(Debug, Clone, PartialEq)]
pub struct Zpk {
    /// Zeros.
    pub zeros: Vec<C64>,
    /// Poles.
    pub poles: Vec<C64>,
    /// The factor in front.
    pub gain: f64,
    /// Continuous (roots in s) or discrete (roots in z).
    pub timebase: Timebase,
}

impl Zpk {
    /// Returns the value at a point s (or z).
    pub fn at(&self, s: C64) -> C64 {
        // Factors are taken in turn so that neither product overflows alone.
        let mut value = C64::new(self.gain, 0.0);
        for k in 0..self.zeros.len().max(self.poles.len()) {
            value *= self.zeros.get(k).map_or(C64::new(1.0, 0.0), |z| s - z);
            value /= self.poles.get(k).map_or(C64::new(1.0, 0.0), |p| s - p);
        }
        value
    }

    /// Returns zeros, poles and gain of a system with one input and one output; what cancels is left in.
    ///
    /// The gain is read off the response at a point away from all roots at which rounding leaves it known.
    ///
    /// # Errors
    /// [`Error::NotSiso`], [`Error::Matrix`].
    pub fn of(g: &StateSpace) -> Result<Self, Error> {
        needs_siso("zpk", g)?;
        Self::with_zeros(g, zeros(g)?)
    }

    /// Returns zeros, poles and gain of a system with one input and one output whose zeros are known.
    ///
    /// # Errors
    /// [`Error::Matrix`].
    pub(crate) fn with_zeros(g: &StateSpace, zeros: Vec<C64>) -> Result<Self, Error> {
        let mut zpk = Self { zeros, poles: poles(g)?, gain: 1.0, timebase: g.timebase };
        let response = Response::of(g)?;
        let away = zpk.point_for_gain(&response, balance(g).0.A.norm_max());
        let value = response.at_points(&[away])?[0][(0, 0)];
        zpk.gain = (value / zpk.at(away)).re;
        if zpk.gain.is_nan() {
            return Err(linalg::Error::OutOfRange { what: "the gain" }).with_operation("zpk");
        }
        if zpk.gain == 0.0 {
            zpk.zeros.clear();
        }
        Ok(zpk)
    }

    /// Returns a point at which the gain is read off: at twice the largest root, if the response is known there; otherwise the best known of points
    /// between the roots, because a response that falls off fast cancels to rounding far from them; if none is known there, as of poles at the origin
    /// that rounding left traces of, the best up to the size of the couplings of the states.
    fn point_for_gain(&self, response: &Response, coupling: f64) -> C64 {
        let roots = || self.zeros.iter().chain(&self.poles);
        let largest = roots().map(|r| r.norm()).fold(0.0, f64::max);
        let away = if largest > 0.0 { 2.0 * largest } else { 1.0 };
        let error = |s: C64| {
            let value = response.at_points(&[s]).map_or(0.0, |values| values[0][(0, 0)].norm());
            response.rounding(s) / value
        };
        let first = C64::new(away, 0.0);
        if error(first) <= KNOWN_GAIN {
            return first;
        }
        let is_apart = |s: &C64| roots().all(|root| (s - root).norm() > APART_FROM_ROOTS * s.norm());
        let inward = (0..GAIN_POINTS).map(|k| away * 0.25_f64.powi(k));
        let outward = (1..GAIN_POINTS).map(|k| away * 4f64.powi(k)).take_while(|s| *s <= 4.0 * coupling);
        let points = inward.chain(outward).map(|s| C64::new(s, 0.0)).filter(is_apart);
        let mut best = (f64::INFINITY, first);
        for s in points {
            let error = error(s);
            if error < best.0 {
                best = (error, s);
            }
            if error <= KNOWN_GAIN {
                break;
            }
        }
        best.1
    }

    /// Returns the system as a cascade of sections of first and second order; nothing is expanded.
    ///
    /// Zeros go to the poles nearest to them, pairs first; each section is scaled so that its largest output entry is one.
    ///
    /// # Errors
    /// [`Error::Rational`] for more zeros than poles or a complex root without its conjugate; [`Error::NotFinite`].
    pub fn to_state_space(&self) -> Result<StateSpace, Error> {
        if self.zeros.len() > self.poles.len() {
            let problem = "more zeros than poles: no state space has this response";
            return Err(Error::Rational { what: "zpk", problem });
        }
        let mut system = StateSpace::gain(Mat::eye(1), self.timebase)?;
        let mut gain = self.gain;
        for section in sections(&self.zeros, &self.poles)? {
            let (part, size) = section.realise(self.timebase)?;
            gain *= size;
            system = series(&system, &part)?;
        }
        system.scale_io(&[gain], &[1.0])
    }
}

/// Refuses a system with more than one input or output.
pub(crate) fn needs_siso(what: &'static str, g: &StateSpace) -> Result<(), Error> {
    let (inputs, outputs) = (g.inputs(), g.outputs());
    if inputs == 1 && outputs == 1 { Ok(()) } else { Err(Error::NotSiso { what, inputs, outputs }) }
}

/// A real factor of degree 0, 1 or 2: its roots, one of a conjugate pair first.
type Factor = Vec<C64>;

/// Conjugate pairs, then real roots, each group with the one nearest the imaginary axis relative to its size first.
fn quadratics(roots: &[C64]) -> Result<Vec<Factor>, Error> {
    let mut rest: Vec<C64> = roots.to_vec();
    sort_roots(&mut rest);
    let (mut pairs, mut reals) = (Vec::new(), Vec::new());
    while let Some(root) = rest.pop() {
        if root.im.abs() <= f64::EPSILON * root.norm() {
            reals.push(vec![C64::new(root.re, 0.0)]);
            continue;
        }
        let distance = |other: &C64| (other - root.conj()).norm();
        let near = (0..rest.len()).min_by(|&a, &b| distance(&rest[a]).total_cmp(&distance(&rest[b])));
        match near {
            Some(k) if distance(&rest[k]) <= CONJUGATE * root.norm() => {
                let other = rest.remove(k);
                let mean = 0.5 * (root + other.conj());
                pairs.push(vec![mean, mean.conj()]);
            }
            _ => {
                let problem = "a complex root without its conjugate";
                return Err(Error::Rational { what: "zpk", problem });
            }
        }
    }
    pairs.sort_by(|a, b| damping(a[0]).total_cmp(&damping(b[0])));
    pairs.extend(reals);
    Ok(pairs)
}

fn damping(root: C64) -> f64 {
    root.re.abs() / root.norm()
}

/// One or two poles (a conjugate pair, or two real ones) with as many zeros at most.
struct Section {
    poles: Factor,
    zeros: Factor,
}

/// Deals the zeros out to the poles nearest to them.
fn sections(zeros: &[C64], poles: &[C64]) -> Result<Vec<Section>, Error> {
    let (zeros, mut poles) = (quadratics(zeros)?, quadratics(poles)?);
    let pairs = |factors: &[Factor]| factors.iter().filter(|f| f.len() == 2).count();
    while pairs(&zeros) > pairs(&poles) {
        let (first, second) = (poles.pop().unwrap_or_default(), poles.pop().unwrap_or_default());
        poles.insert(0, [first, second].concat());
    }
    let mut sections: Vec<Section> =
        poles.into_iter().map(|poles| Section { poles, zeros: Factor::new() }).collect();
    for factor in zeros {
        let fits = |s: &&mut Section| s.poles.len() - s.zeros.len() >= factor.len();
        let distance = |s: &&mut Section| (s.poles[0] - factor[0]).norm();
        let nearest = sections.iter_mut().filter(fits).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        if let Some(section) = nearest {
            section.zeros.extend(factor);
        }
    }
    Ok(sections)
}

impl Section {
    /// Returns the section divided by its size, and that size.
    ///
    /// States: x2 = b (s - a)/den u, x1 = b^2/den u, with a the first real pole or the pair's real part.
    fn realise(&self, timebase: Timebase) -> Result<(StateSpace, f64), Error> {
        let direct = if self.zeros.len() == self.poles.len() { 1.0 } else { 0.0 };
        let (A, B, C) = match *self.poles.as_slice() {
            [p] => {
                let c = self.zeros.first().map_or(1.0, |z| p.re - z.re);
                (Mat::row(&[p.re]), Mat::eye(1), Mat::row(&[c]))
            }
            [p, q] => {
                let b = if p.im == 0.0 { p.re.abs().max(q.re.abs()) } else { p.im.abs() };
                let b = if b > 0.0 { b } else { 1.0 };
                let (slope, value) = self.remainder(p, q);
                let A = Mat::from_rows(&[&[p.re, b], &[-p.im * p.im / b, q.re]]);
                (A, Mat::col(&[0.0, b]), Mat::row(&[value / (b * b), slope / b]))
            }
            _ => (Mat::zeros(0, 0), Mat::zeros(0, 1), Mat::zeros(1, 0)),
        };
        let size = C.norm_max().max(direct);
        let D = Mat::eye(1).scale(direct / size);
        Ok((StateSpace::new(A, B, C.scale(1.0 / size), D, timebase)?, size))
    }

    /// Returns the numerator less the direct path's share, as slope (s - a) + value, exact in the differences of
    /// the roots.
    fn remainder(&self, p: C64, q: C64) -> (f64, f64) {
        match *self.zeros.as_slice() {
            [] => (0.0, 1.0),
            [z] => (1.0, p.re - z.re),
            [z, y, ..] => {
                let (d1, d2) = (p.re - z.re, p.re - y.re);
                let curved = (z.im.abs() - p.im.abs()) * (z.im.abs() + p.im.abs());
                (d1 + (q.re - y.re), d1 * d2 + curved)
            }
        }
    }
}

/// c2d by z = exp(s T): zeros at infinity go to z = -1 but for one. The gain is matched at zero frequency; roots at the
/// origin count there as their slopes, s^n as ((z - 1) / T)^n.
pub(crate) fn match_poles_and_zeros(g: &StateSpace, period_s: f64) -> Result<StateSpace, Error> {
    needs_siso("matched discretisation", g)?;
    let zpk = Zpk::of(g)?;
    let map = |roots: &[C64]| roots.iter().map(|r| (r * period_s).exp()).collect::<Vec<_>>();
    let mut sampled = Zpk {
        zeros: map(&zpk.zeros),
        poles: map(&zpk.poles),
        gain: 1.0,
        timebase: Timebase::Discrete { period_s },
    };
    let missing = sampled.poles.len() - sampled.zeros.len();
    sampled.zeros.extend(vec![C64::new(-1.0, 0.0); missing.saturating_sub(1)]);
    let away = |r: &&C64| r.norm() * period_s > CONJUGATE;
    let factors = |roots: &[C64]| {
        roots.iter().filter(away).map(|r| -r / (C64::new(1.0, 0.0) - (r * period_s).exp())).product::<C64>()
    };
    let at_origin = |roots: &[C64]| roots.iter().filter(|r| !away(r)).count() as i32;
    let slope = at_origin(&zpk.zeros) - at_origin(&zpk.poles);
    let added = 2f64.powi(missing.saturating_sub(1) as i32);
    let ratio = (factors(&zpk.zeros) / factors(&zpk.poles)).re;
    sampled.gain = zpk.gain * ratio / (added * period_s.powi(slope));
    sampled.to_state_space()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn example() -> Zpk {
        let c = C64::new;
        Zpk {
            zeros: vec![c(-3.0, 0.0), c(-0.1, 7.0), c(-0.1, -7.0), c(5.0, 0.0)],
            poles: vec![
                c(-1.0, 4.0),
                c(-1.0, -4.0),
                c(-0.2, 8.0),
                c(-0.2, -8.0),
                c(-900.0, 0.0),
                c(0.0, 0.0),
            ],
            gain: -40.0,
            timebase: Timebase::Continuous,
        }
    }

    #[test]
    fn an_integrator_sampled_by_matching_keeps_its_slope() {
        let c = C64::new;
        let (zeros, poles) = (vec![c(-3.0, 0.0)], vec![c(0.0, 0.0), c(-40.0, 0.0), c(-90.0, 0.0)]);
        let zpk = Zpk { zeros, poles, gain: 700.0, timebase: Timebase::Continuous };
        let sampled = match_poles_and_zeros(&zpk.to_state_space().unwrap(), 1e-3).unwrap();
        for (rate, within) in [(0.01, 1e-4), (1.0, 1e-3), (15.0, 1e-2)] {
            let found = crate::frequency_response(&sampled, &[rate]).unwrap()[0][(0, 0)];
            let ratio = found.norm() / zpk.at(c(0.0, rate)).norm();
            assert!((ratio - 1.0).abs() < within, "{rate} rad/s: {ratio}");
        }
    }

    #[test]
    fn the_cascade_has_the_response_of_the_factors() {
        let zpk = example();
        let g = Response::of(&zpk.to_state_space().unwrap()).unwrap();
        for s in [C64::new(0.0, 0.5), C64::new(0.0, 8.0), C64::new(2.0, 3.0), C64::new(0.0, 2000.0)] {
            let (found, expected) = (g.at_points(&[s]).unwrap()[0][(0, 0)], zpk.at(s));
            assert!((found - expected).norm() < 1e-13 * expected.norm(), "{s}: {found} {expected}");
        }
    }

    #[test]
    fn a_system_gives_back_the_roots_it_was_made_from() {
        let mut zpk = example();
        let back = Zpk::of(&zpk.to_state_space().unwrap()).unwrap();
        sort_roots(&mut zpk.zeros);
        sort_roots(&mut zpk.poles);
        assert!((back.gain / zpk.gain - 1.0).abs() < 1e-10);
        assert_eq!(back.zeros.len(), 4);
        for (a, b) in back.zeros.iter().chain(&back.poles).zip(zpk.zeros.iter().chain(&zpk.poles)) {
            assert!((a - b).norm() < 1e-9 * b.norm().max(1.0), "{a} {b}");
        }
    }

    #[test]
    fn sixteen_poles_keep_their_places() {
        let poles: Vec<C64> = (1..=16).map(|k| C64::new(-f64::from(k), 0.0)).collect();
        let zpk = Zpk { zeros: vec![], poles, gain: 1e13, timebase: Timebase::Continuous };
        let mut found = crate::poles(&zpk.to_state_space().unwrap()).unwrap();
        found.sort_by(|a, b| b.re.total_cmp(&a.re));
        for (k, pole) in found.iter().enumerate() {
            assert!((pole + (k + 1) as f64).norm() < 1e-12, "{pole}");
        }
    }

    #[test]
    fn a_notch_over_real_poles_keeps_its_zeros() {
        let c = C64::new;
        let zeros = vec![c(-0.1, 30.0), c(-0.1, -30.0)];
        let zpk = Zpk {
            zeros,
            poles: vec![c(-10.0, 0.0), c(-80.0, 0.0)],
            gain: 2.0,
            timebase: Timebase::Continuous,
        };
        let g = Response::of(&zpk.to_state_space().unwrap()).unwrap();
        let s = c(0.0, 29.0);
        assert!((g.at_points(&[s]).unwrap()[0][(0, 0)] - zpk.at(s)).norm() < 1e-15);
    }

    #[test]
    fn an_improper_quotient_and_a_lone_complex_root_are_refused() {
        let improper =
            Zpk { zeros: vec![C64::new(0.0, 0.0)], poles: vec![], gain: 1.0, timebase: Timebase::Continuous };
        assert!(matches!(improper.to_state_space(), Err(Error::Rational { .. })));
        let lone = Zpk {
            zeros: vec![],
            poles: vec![C64::new(-1.0, 1.0)],
            gain: 1.0,
            timebase: Timebase::Continuous,
        };
        assert!(matches!(lone.to_state_space(), Err(Error::Rational { .. })));
    }
}
