//! The place along a step at which a quantity first falls below zero.

/// The distance of an event at a fraction of a step: negative beyond it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Margin {
    /// Fraction of the step.
    pub part: f64,
    /// The distance, in the unit of the quantity.
    pub value: f64,
}

/// Returns the fraction at which margins along a step first fall below zero, by a straight line between the points; infinite if
/// none does.
pub(crate) fn first_crossing(margins: &[Margin]) -> f64 {
    let below = margins.windows(2).find(|pair| pair[1].value < 0.0);
    below.map_or(f64::INFINITY, |pair| crossing(pair[0], pair[1]))
}

/// Returns the fraction at which margins along a step first dip below zero between two points at which they do not: by the
/// parabola through a least one and its neighbours; infinite if none does.
pub(crate) fn first_dip(margins: &[Margin]) -> f64 {
    let dips = margins.windows(3).filter_map(|three| {
        let [Margin { part: a, value: fa }, Margin { part: b, value: fb }, Margin { part: c, value: fc }] =
            [three[0], three[1], three[2]];
        let (left, right) = ((fb - fa) / (b - a), (fc - fb) / (c - b));
        let bend = (right - left) / (c - a);
        let slope = left + bend * (b - a);
        let at = b - slope / (2.0 * bend);
        let least = fb - slope * slope / (4.0 * bend);
        let dips = fb >= 0.0 && left <= 0.0 && right >= 0.0 && bend > 0.0 && least < 0.0;
        dips.then(|| if at > a { crossing(three[0], Margin { part: at, value: least }) } else { a })
    });
    dips.fold(f64::INFINITY, f64::min)
}

/// Returns the fraction at which the straight line between a margin that holds and one below zero is zero.
pub(crate) fn crossing(before: Margin, after: Margin) -> f64 {
    let from = before.value.max(0.0);
    before.part + (after.part - before.part) * from / (from - after.value)
}
