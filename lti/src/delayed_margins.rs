//! Stability margins of a continuous loop with a delay, which is not approximated.

use std::f64::consts::PI;

use crate::discretise::needs_continuous;
use crate::margins::{Margins, PhaseMargin, delayed_phase_margins, gain_margins};
use crate::response::Point;
use crate::roots::{poles, poles_on_boundary};
use crate::scan::Scan;
use crate::tolerance::{CROSSING_SIDE, DELAYED_BOUNDARY_POLE, DELAYED_POLE_ON_AXIS, LEAST_GAINS};
use crate::zpk::needs_siso;
use crate::{C64, Error, StateSpace, response};

/// All margins of the loop L(s) exp(-s delay) under negative unit feedback, with its sensitivities. They are margins only if the closed
/// loop is stable.
#[derive(Debug, Clone, PartialEq)]
pub struct DelayedMargins {
    /// The margins; a crossing of the negative real axis counts if the gain is at least `least_gain` there. If that is infinite, none is listed, and the
    /// peaks and the disk margin are those of the worst phase at each frequency, which a delay so long all but attains.
    pub margins: Margins,
    /// The gain down to which the loop was followed: -60 dB; more if the delay turns the loop so often that four hundred thousand points do not
    /// resolve it, infinite if they resolve it nowhere.
    pub least_gain: f64,
    /// Number of closed-loop poles in the right half plane; `None` if there are infinitely many, because the direct path is one or more.
    pub unstable_poles: Option<usize>,
}

/// Returns the margins of a continuous loop with one input, one output and a delay in seconds.
///
/// The response of L is evaluated as for [`crate::margins`](fn@crate::margins) and turned by the delay exactly; the grid ends where the gain falls below
/// -60 dB for good. The delay moves no crossing of the unit circle, so that these are found however long it is. The closed loop has infinitely many poles.
/// Those in the right half plane are counted by the turns of the response about the critical point (Nyquist); if the delay turns it too often, from those
/// without delay and the pairs that pass each crossing of the unit circle while the delay grows (K. Cooke and P. van den Driessche, Funkcialaj Ekvacioj
/// 29, 1986). In sampled time a delay of whole samples is a system of its own ([`crate::delay_samples`]).
///
/// # Errors
/// [`Error::NotSiso`], [`Error::Timebase`] for a sampled loop, [`Error::Range`] for a delay that is negative or not finite.
pub fn margins_with_delay(loop_gain: &StateSpace, delay_s: f64) -> Result<DelayedMargins, Error> {
    needs_siso("margins with delay", loop_gain)?;
    needs_continuous("margins with delay", loop_gain)?;
    if !(delay_s >= 0.0 && delay_s.is_finite()) {
        return Err(Error::Range { what: "delay_s", value: delay_s, allowed: "finite and not negative" });
    }
    let scan = Scan::of(loop_gain)?;
    let phase = delayed_phase_margins(&scan, delay_s);
    let at_rest = response::response_at(loop_gain, 0.0).ok();
    let ends: Vec<Point> = at_rest.map(|H| Point { rate: 0.0, value: H[(0, 0)] }).into_iter().collect();
    for least_gain in LEAST_GAINS {
        let Some(mut scan) = Scan::of(loop_gain)?.with_delay(loop_gain, delay_s, least_gain)? else {
            continue;
        };
        let gain = gain_margins(&scan, &ends);
        scan.points.splice(0..0, ends);
        let unstable_poles = unstable_poles(loop_gain, &scan.points)?;
        let margins = Margins::of_scan(&scan, gain, phase);
        return Ok(DelayedMargins { margins, least_gain, unstable_poles }.judge());
    }
    unfollowed_margins(loop_gain, scan, UnitCrossings { phase, ends, delay_s })
}

/// The points of the response that a delay only turns.
struct UnitCrossings {
    phase: Vec<PhaseMargin>,
    /// The response at rest, if it is finite.
    ends: Vec<Point>,
    delay_s: f64,
}

/// Returns the margins of a loop whose delay turns it too often to be followed.
fn unfollowed_margins(
    g: &StateSpace,
    mut scan: Scan,
    crossings: UnitCrossings,
) -> Result<DelayedMargins, Error> {
    let UnitCrossings { phase, ends, delay_s } = crossings;
    let at = scan.unit_crossings();
    scan.points.splice(0..0, ends);
    let without = unstable_poles(g, &scan.points)?;
    let unstable_poles = without.map(|count| {
        let passed = at.iter().map(|point| pairs_passed(&scan, *point, delay_s)).sum::<f64>();
        (count as f64 + 2.0 * passed).max(0.0) as usize
    });
    // At the worst phase the response is as near to the critical point as its size lets it be.
    scan.points.extend(at);
    scan.points.iter_mut().for_each(|point| point.value = C64::new(-point.value.norm(), 0.0));
    let least_gain = f64::INFINITY;
    Ok(DelayedMargins { margins: Margins::of_points(&scan, phase), least_gain, unstable_poles }.judge())
}

/// Returns the number of pairs of poles that pass a crossing of the unit circle while the delay grows from zero: into the right half plane if the gain falls
/// there, out of it if it rises.
fn pairs_passed(scan: &Scan, at: Point, delay_s: f64) -> f64 {
    let angle = (-at.value).arg();
    let first = if angle <= 0.0 { angle + 2.0 * PI } else { angle };
    let turns = ((at.rate * delay_s - first) / (2.0 * PI)).floor() + 1.0;
    let beside = scan.evaluate(&[at.rate * (1.0 - CROSSING_SIDE), at.rate * (1.0 + CROSSING_SIDE)]);
    let rises = beside.first().map(|p| p.value.norm()) < beside.last().map(|p| p.value.norm());
    turns.max(0.0) * if rises { -1.0 } else { 1.0 }
}

impl DelayedMargins {
    /// Returns the margins with the verdict on the closed loop.
    fn judge(mut self) -> Self {
        self.margins.closed_loop_stable = self.unstable_poles == Some(0);
        self
    }
}

/// Nyquist's criterion on the upper half of the axis, poles on the axis passed on their right:
/// Z = P + P0 / 2 - (turn of 1 + L) / pi, with P open-loop poles in the right half plane and P0 on the axis.
fn unstable_poles(g: &StateSpace, points: &[Point]) -> Result<Option<usize>, Error> {
    if g.D[(0, 0)].abs() >= 1.0 {
        return Ok(None);
    }
    let boundary = poles_on_boundary(g)?;
    let on_axis = |pole: &C64| {
        let near =
            |b: &C64| (pole - b).norm().min((pole.conj() - b).norm()) <= DELAYED_BOUNDARY_POLE * b.norm();
        pole.re.abs() <= DELAYED_POLE_ON_AXIS * pole.norm() || boundary.iter().any(near)
    };
    let (border, inside): (Vec<C64>, Vec<C64>) = poles(g)?.into_iter().partition(on_axis);
    let right = inside.iter().filter(|pole| pole.re > 0.0).count();
    let jumps: Vec<f64> = border.iter().filter(|pole| pole.im > 0.0).map(|pole| pole.im).collect();
    let mut turn = 0.0;
    for w in points.windows(2) {
        let margin = 2.0 * DELAYED_POLE_ON_AXIS * w[1].rate;
        if !jumps.iter().any(|rate| w[0].rate - margin <= *rate && *rate <= w[1].rate + margin) {
            turn += ((w[1].value + 1.0) / (w[0].value + 1.0)).arg();
        }
    }
    let count = right as f64 + 0.5 * border.len() as f64 - turn / PI;
    Ok(Some(count.round().max(0.0) as usize))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{Timebase, Zpk, margins};

    fn lag(gain: f64, poles: &[f64]) -> StateSpace {
        let poles = poles.iter().map(|p| C64::new(*p, 0.0)).collect();
        Zpk { zeros: vec![], poles, gain, timebase: Timebase::Continuous }.to_state_space().unwrap()
    }

    #[test]
    fn an_integrator_with_delay_has_the_margins_of_the_closed_form() {
        let (k, delay) = (2.0, 0.3);
        let found = margins_with_delay(&lag(k, &[0.0]), delay).unwrap().margins;
        assert!((found.phase[0].rate_rad_s / k - 1.0).abs() < 1e-12);
        assert!((found.phase[0].deg - (90.0 - (k * delay).to_degrees())).abs() < 1e-9);
        assert!((found.delay_s - (PI / 2.0 / k - delay)).abs() < 1e-12);
        // The phase is -180 degrees where w delay = pi/2 + 2 pi n.
        for (n, margin) in found.gain.iter().enumerate().take(5) {
            let rate = (PI / 2.0 + 2.0 * PI * n as f64) / delay;
            assert!((margin.rate_rad_s / rate - 1.0).abs() < 1e-9, "{margin:?} {rate}");
            assert!((margin.factor / (rate / k) - 1.0).abs() < 1e-9);
        }
        assert!(found.closed_loop_stable);
    }

    #[test]
    fn unstable_poles_are_counted() {
        // k/s with a delay: a pair crosses the axis wherever k delay passes pi/2 + 2 pi n.
        for (gain, pairs) in [(1.5, 0), (1.6, 1), (7.8, 1), (7.9, 2), (14.2, 3)] {
            let found = margins_with_delay(&lag(gain, &[0.0]), 1.0).unwrap();
            assert_eq!(found.unstable_poles, Some(2 * pairs), "{gain}");
        }
        // An unstable pole that the loop holds, and one that it does not.
        assert_eq!(margins_with_delay(&lag(3.0, &[1.0]), 0.1).unwrap().unstable_poles, Some(0));
        assert_eq!(margins_with_delay(&lag(0.5, &[1.0]), 0.1).unwrap().unstable_poles, Some(1));
        assert_eq!(margins_with_delay(&lag(2.0, &[0.0, 0.0]), 0.0).unwrap().margins.gain.len(), 0);
    }

    #[test]
    fn a_delay_of_any_length_leaves_the_crossings_of_the_unit_circle_and_the_count_of_poles() {
        // k / (s + 1) crosses at root(k^2 - 1); a pair of poles passes there with each turn.
        for (k, delay) in [(2.0, 50.0), (1.2, 300.0), (2.0, 1e5), (3.0, 1e9)] {
            let found = margins_with_delay(&lag(k, &[-1.0]), delay).unwrap();
            let rate = f64::sqrt(k * k - 1.0);
            assert_eq!(found.margins.phase.len(), 1);
            assert!((found.margins.phase[0].rate_rad_s / rate - 1.0).abs() < 1e-12);
            let turns = ((rate * delay + rate.atan() - PI) / (2.0 * PI)).floor() + 1.0;
            assert_eq!(found.unstable_poles, Some(2 * turns as usize), "{k} {delay}");
            assert_eq!(found.least_gain.is_finite(), delay < 1e4, "{}", found.least_gain);
        }
        // A gain below one is stable with any delay, with the peak of the worst phase.
        for delay in [100.0, 1e7] {
            let found = margins_with_delay(&lag(0.9, &[-1.0]), delay).unwrap();
            assert_eq!((found.margins.phase.len(), found.unstable_poles), (0, Some(0)));
            assert!(
                found.margins.closed_loop_stable && found.margins.ms.value > 9.0,
                "{:?}",
                found.margins.ms
            );
            assert!(found.margins.ms.value < 10.0 * (1.0 + 1e-12));
        }
    }

    #[test]
    fn without_delay_the_margins_are_the_plain_ones() {
        let g = lag(4.0, &[-1.0, -2.0, -0.5]);
        let (plain, found) = (margins(&g).unwrap(), margins_with_delay(&g, 0.0).unwrap().margins);
        assert!((plain.ms.value / found.ms.value - 1.0).abs() < 1e-9);
        assert!((plain.gain[0].factor / found.gain[0].factor - 1.0).abs() < 1e-9);
        assert_eq!(plain.closed_loop_stable, found.closed_loop_stable);
    }
}
