//! Straight stretches between points, as sums of clamped values: no branch, no table.

use crate::lowering::{Limits, Writer};
use crate::program::Slot;

/// Writes a curve of a slot that is 0 or positive: y_0 at x_0 and below, straight between the points, y_n beyond. The x rise.
pub(crate) fn level(writer: &mut Writer, name: &str, of: Slot, points: &[[f64; 2]]) -> Slot {
    let mut terms = Vec::new();
    let mut constant = points.first().map_or(1.0, |point| point[1]);
    for (k, pair) in points.windows(2).enumerate() {
        let [[x0, y0], [x1, y1]] = [pair[0], pair[1]];
        let slope = (y1 - y0) / (x1 - x0);
        constant -= slope * x0;
        terms.push(slope * writer.clamp(format!("{name}_stretch_{k}"), of, Limits { low: x0, high: x1 }));
    }
    let into = writer.local(name);
    writer.sum_into(into, Some(constant), &terms);
    into
}

/// Writes the odd curve through 0 and the points, whose x rise from beyond 0; constant beyond the last.
pub(crate) fn write_odd_curve(writer: &mut Writer, name: &str, of: Slot, points: &[[f64; 2]]) -> Slot {
    let mut terms = Vec::new();
    let mut from = [0.0, 0.0];
    for (k, &to) in points.iter().enumerate() {
        let slope = (to[1] - from[1]) / (to[0] - from[0]);
        if k == 0 {
            terms.push(slope * writer.clamp(format!("{name}_middle"), of, Limits::symmetric(to[0])));
        } else {
            terms.push(
                slope * writer.clamp(format!("{name}_above_{k}"), of, Limits { low: from[0], high: to[0] }),
            );
            terms.push(
                slope * writer.clamp(format!("{name}_below_{k}"), of, Limits { low: -to[0], high: -from[0] }),
            );
        }
        from = to;
    }
    writer.sum(name, &terms)
}
