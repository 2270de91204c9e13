//! The numbers of several measured maps together.

use super::fra::ResponseMap;

/// The numbers of several maps together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapTotals {
    /// Points.
    pub points: usize,
    /// Points that had not settled, or were not excited on a recording.
    pub unsettled: usize,
    /// Simulated time of the mechanism, s.
    pub simulated_s: f64,
}

impl MapTotals {
    /// Returns the numbers of maps together.
    pub fn of<Remark>(maps: &[ResponseMap<Remark>]) -> Self {
        Self {
            points: maps.iter().map(|map| map.points.len()).sum(),
            unsettled: maps.iter().map(|map| map.summary.unsettled).sum(),
            simulated_s: maps.iter().map(|map| map.simulated_s).sum(),
        }
    }
}
