//! Derivatives of a machine's stored numbers along a direction, by differences of fourth order.
//!
//! Matrices of a step, rows of a sensor and levels of friction are smooth functions of a parameter that are known to rounding. Their
//! differences over a share h of the direction's unit are wrong by h^4, and by the rounding over h: with h = 1e-3 both are near 1e-12. Runs are
//! never differenced.

/// Members of a family beside the nominal one.
pub(crate) const MEMBERS: usize = 4;

/// The side of the nominal machine on which the family of a direction exists.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// On both: the derivative is that of the machine.
    Both,
    /// Above alone, as for an effect that is absent or acts in one sense: the derivative is the one-sided one.
    Above,
    /// Below alone.
    Below,
}

/// The places of the members of a family, and what their numbers weigh in a derivative.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stencil {
    /// Distances from the nominal machine, in the direction's unit.
    pub distances: [f64; MEMBERS],
    weights: [f64; MEMBERS],
}

impl Stencil {
    /// Returns the places at whole steps on the side where the family exists.
    pub fn new(side: Side, step: f64) -> Self {
        let per = step.recip();
        let (places, weights, sign) = match side {
            Side::Both => ([-2.0, -1.0, 1.0, 2.0], [1.0 / 12.0, -8.0 / 12.0, 8.0 / 12.0, -1.0 / 12.0], 1.0),
            Side::Above => ([1.0, 2.0, 3.0, 4.0], [4.0, -3.0, 4.0 / 3.0, -0.25], 1.0),
            Side::Below => ([1.0, 2.0, 3.0, 4.0], [4.0, -3.0, 4.0 / 3.0, -0.25], -1.0),
        };
        Self {
            distances: places.map(|place| sign * place * step),
            weights: weights.map(|weight| sign * weight * per),
        }
    }

    /// Returns the derivative of a number that is `own` for the nominal machine and `of` for each member.
    #[inline]
    pub fn derivative(&self, own: f64, of: [f64; MEMBERS]) -> f64 {
        // the weights of the members and of the nominal machine add up to 0
        (0..MEMBERS).map(|k| self.weights[k] * (of[k] - own)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_side_differentiates_a_quartic_exactly() {
        let value = |s: f64| 3.0 - 2.0 * s + s * s - 0.5 * s.powi(3) + 0.25 * s.powi(4);
        for side in [Side::Both, Side::Above, Side::Below] {
            let stencil = Stencil::new(side, 0.1);
            let slope = stencil.derivative(value(0.0), stencil.distances.map(value));
            assert!((slope + 2.0).abs() < 1e-13, "{side:?}: {slope}");
        }
    }
}
