//! How well a mechanism explains the recordings, as a number that can be compared.

use counterpoise_models::Parameters;

use crate::bench::{Bench, Judged, Pool, map, rms};
use crate::tolerance::SCORE_FLOOR;

/// The fit of one channel over one part of one recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Recording.
    pub recording: usize,
    /// Channel name.
    pub channel: &'static str,
    /// RMS error in units of the floor, what does not repeat between two runs of the same machine discounted.
    pub excess: f64,
    /// RMS error in the channel's unit.
    pub rms_error: f64,
    /// Floor in the channel's unit.
    pub floor: f64,
    /// Number of independent samples that the residual is worth.
    pub worth: f64,
    /// Number of samples.
    pub samples: f64,
}

/// The fit of every channel of every recording.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Score {
    /// Cells, recording by recording.
    pub cells: Vec<Cell>,
}

/// A part of a recording: from one share of its length to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// Recording.
    pub recording: usize,
    /// Share of the length at which the part begins.
    pub from: f64,
    /// Share of the length at which it ends.
    pub to: f64,
}

/// Judges every recording, whole; none where the mechanism cannot be simulated.
pub fn judge(bench: &dyn Bench, pool: &dyn Pool, parameters: &Parameters) -> Option<Vec<Judged>> {
    let judged = map(pool, bench.count(), |index| bench.judge(parameters, index));
    (judged.len() == bench.count()).then(|| judged.into_iter().collect::<Option<Vec<_>>>()).flatten()
}

/// As [`judge`], from the starts of judgements of a mechanism nearby.
pub fn judge_near(
    bench: &dyn Bench,
    pool: &dyn Pool,
    parameters: &Parameters,
    near: &[Judged],
) -> Option<Vec<Judged>> {
    let judged = map(pool, near.len(), |index| bench.judge_near(parameters, index, &near[index]));
    (judged.len() == near.len()).then(|| judged.into_iter().collect::<Option<Vec<_>>>()).flatten()
}

/// The score over parts of judged recordings; none where a residual is not finite.
pub fn score(judged: &[Judged], parts: &[Part]) -> Option<Score> {
    let mut cells = Vec::new();
    for part in parts {
        let here = &judged[part.recording];
        for (c, misfit) in here.misfits.iter().enumerate() {
            let length = misfit.residual.len() as f64;
            let slice = &misfit.residual[(length * part.from) as usize..(length * part.to) as usize];
            cells.push(Cell {
                recording: part.recording,
                channel: misfit.channel,
                excess: rms(slice) * here.weight(c),
                rms_error: rms(slice) * misfit.floor,
                floor: misfit.floor,
                worth: slice.len() as f64 / correlation_time(slice),
                samples: slice.len() as f64,
            });
        }
    }
    cells.iter().all(|cell| cell.excess.is_finite()).then_some(Score { cells })
}

impl Score {
    /// Log-likelihood gained over another mechanism on the same parts, in nats.
    ///
    /// Each cell adds `worth x ln(before / after)`, the log-likelihood ratio of Gaussian residuals of unknown
    /// size; the worth is that of the better of the two, whose residual is closer to white.
    pub fn gain_over(&self, before: &Score) -> f64 {
        let cells = self.cells.iter().zip(&before.cells);
        cells
            .map(|(after, before)| {
                let ratio = log_excess(before) - log_excess(after);
                let worth = if ratio > 0.0 { after.worth } else { before.worth };
                worth * ratio
            })
            .sum()
    }

    /// Log-likelihood gained over another mechanism, in nats, were every residual white and of the size of the floor, or of
    /// what is left where that is more.
    pub fn energy_over(&self, before: &Score) -> f64 {
        let size = |cell: &Cell| cell.rms_error / cell.floor;
        let one = |(after, before): (&Cell, &Cell)| {
            let (now, was) = (size(after), size(before));
            0.5 * after.samples * (was * was - now * now) / (now * now).max(1.0)
        };
        self.cells.iter().zip(&before.cells).map(one).sum()
    }

    /// As [`Self::gain_over`], of one recording alone.
    pub fn gain_in(&self, recording: usize, before: &Score) -> f64 {
        let of = |score: &Score| Score {
            cells: score.cells.iter().filter(|cell| cell.recording == recording).cloned().collect(),
        };
        of(self).gain_over(&of(before))
    }

    /// Nats by which this mechanism is behind another on the same parts, every cell weighed by what it is worth to the other.
    pub fn loss_against(&self, other: &Score) -> f64 {
        let cells = self.cells.iter().zip(&other.cells);
        cells.map(|(ours, theirs)| theirs.worth * (log_level(ours) - log_level(theirs))).sum()
    }

    /// Mean over the cells of ln(excess), below the floor as well, and of what it was lowered by: what tells models apart that are
    /// all close to the floor.
    pub fn level(&self) -> f64 {
        self.cells.iter().map(log_level).sum::<f64>() / self.cells.len().max(1) as f64
    }

    /// Mean over the cells of ln(excess), the distance from the floor: 0 is perfect.
    pub fn distance(&self) -> f64 {
        let sum: f64 = self.cells.iter().map(|cell| cell.excess.max(1.0).ln()).sum();
        sum / self.cells.len().max(1) as f64
    }

    /// The largest excess of a cell.
    pub fn worst(&self) -> f64 {
        self.cells.iter().map(|cell| cell.excess).fold(0.0, f64::max)
    }
}

fn log_excess(cell: &Cell) -> f64 {
    cell.excess.max(SCORE_FLOOR).ln()
}

/// [`log_excess`], and half the logarithm of what the floor was raised by because runs do not repeat: a mechanism that
/// lets everything wander explains nothing by that.
fn log_level(cell: &Cell) -> f64 {
    let raised = cell.rms_error / (cell.floor * cell.excess);
    log_excess(cell) + if raised.is_finite() { 0.5 * raised.max(1.0).ln() } else { 0.0 }
}

/// Integrated correlation time of a series in samples, 1 for white noise (initial positive sequence, Geyer 1992).
pub fn correlation_time(series: &[f64]) -> f64 {
    let power = series.iter().map(|r| r * r).sum::<f64>();
    if power == 0.0 {
        return 1.0;
    }
    let lagged = |lag: usize| series.iter().zip(&series[lag..]).map(|(a, b)| a * b).sum::<f64>() / power;
    let mut time = 1.0;
    let mut lag = 1;
    while lag < series.len() / 4 {
        let correlation = lagged(lag);
        if correlation < 0.05 {
            break;
        }
        let stride = (lag / 8).max(1);
        time += 2.0 * correlation * stride as f64;
        lag += stride;
    }
    time
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlation_time_of_a_first_order_process() {
        let (mut state, mut seed) = (0.0, 1u64);
        let mut noise = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 33) as f64 / (1u64 << 30) as f64 - 1.0
        };
        let series: Vec<f64> = (0..200_000)
            .map(|_| {
                state = 0.9 * state + noise();
                state
            })
            .collect();
        let time = correlation_time(&series);
        assert!((time / 19.0 - 1.0).abs() < 0.15, "{time}");
    }
}
