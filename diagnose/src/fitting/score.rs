//! The quality of a mechanism as an explanation of the recordings, as numbers that can be compared.

use counterpoise_models::Parameters;
use counterpoise_recordings::Channel;

use crate::recording::series::{correlation_time, rms};
use crate::simulator_access::{Assessment, SimulatorAccess};
use crate::tolerance::{EXPLAINED, NOTHING_LEFT, SCORE_FLOOR};
use counterpoise_pool::{Pool, map};

/// The fit of one channel over one part of one recording.
#[derive(Debug, Clone, PartialEq)]
pub struct ScoreCell {
    /// Recording.
    pub recording: usize,
    /// Channel name.
    pub channel: Channel,
    /// RMS error in noise floors, reduced by what does not repeat between two runs of the same machine.
    pub excess: f64,
    /// RMS error in the channel's unit.
    pub rms_error: f64,
    /// Floor in the channel's unit.
    pub floor: f64,
    /// Number of independent samples that the residual contains.
    pub worth: f64,
    /// Number of samples.
    pub samples: f64,
}

/// The fit of every channel of every recording.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Score {
    /// Cells, recording by recording.
    pub cells: Vec<ScoreCell>,
}

/// A part of a recording: from one share of its length to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordingPart {
    /// Recording.
    pub recording: usize,
    /// Share of the length at which the part begins.
    pub from: f64,
    /// Share of the length at which it ends.
    pub to: f64,
}

/// Assesses every recording, whole; returns `None` if the mechanism cannot be simulated.
pub fn assess_recordings(
    simulator: &dyn SimulatorAccess,
    pool: &dyn Pool,
    parameters: &Parameters,
) -> Option<Vec<Assessment>> {
    let judged = map(pool, simulator.count(), |index| simulator.assess(parameters, index));
    (judged.len() == simulator.count()).then(|| judged.into_iter().collect::<Option<Vec<_>>>()).flatten()
}

/// Assesses every recording like [`assess_recordings`], from the initial states of the assessments of a similar mechanism.
pub fn assess_near(
    simulator: &dyn SimulatorAccess,
    pool: &dyn Pool,
    parameters: &Parameters,
    near: &[Assessment],
) -> Option<Vec<Assessment>> {
    let judged = map(pool, near.len(), |index| simulator.assess_near(parameters, index, &near[index]));
    (judged.len() == near.len()).then(|| judged.into_iter().collect::<Option<Vec<_>>>()).flatten()
}

/// Returns the score over parts of assessed recordings; `None` if a residual is not finite.
pub fn score_parts(judged: &[Assessment], parts: &[RecordingPart]) -> Option<Score> {
    let mut cells = Vec::new();
    for part in parts {
        let here = &judged[part.recording];
        for (c, channel) in here.channels.iter().enumerate() {
            let length = channel.residual.len() as f64;
            let slice = &channel.residual[(length * part.from) as usize..(length * part.to) as usize];
            cells.push(ScoreCell {
                recording: part.recording,
                channel: channel.channel,
                excess: rms(slice) * here.weight(c),
                rms_error: rms(slice) * channel.floor,
                floor: channel.floor,
                worth: slice.len() as f64 / correlation_time(slice),
                samples: slice.len() as f64,
            });
        }
    }
    cells.iter().all(|cell| cell.excess.is_finite()).then_some(Score { cells })
}

impl Score {
    /// Returns the log-likelihood gained over another mechanism on the same parts.
    ///
    /// Each cell adds `worth x ln(before / after)`, the log-likelihood ratio of Gaussian residuals of unknown size; the worth is
    /// that of the better of the two, whose residual is closer to white.
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

    /// Returns the log-likelihood gained over another mechanism, if every residual were white and of the size of the noise
    /// floor, or of the residual if that is larger.
    pub fn energy_over(&self, before: &Score) -> f64 {
        let size = |cell: &ScoreCell| cell.rms_error / cell.floor;
        let one = |(after, before): (&ScoreCell, &ScoreCell)| {
            let (now, was) = (size(after), size(before));
            0.5 * after.samples * (was * was - now * now) / (now * now).max(1.0)
        };
        self.cells.iter().zip(&before.cells).map(one).sum()
    }

    /// Returns [`Self::gain_over`] for one recording alone.
    pub fn gain_in(&self, recording: usize, before: &Score) -> f64 {
        self.of_recording(recording).gain_over(&before.of_recording(recording))
    }

    /// Returns the cells of one recording.
    pub fn of_recording(&self, recording: usize) -> Score {
        Score { cells: self.cells.iter().filter(|cell| cell.recording == recording).cloned().collect() }
    }

    /// Returns the log-likelihood by which this mechanism is behind another on the same parts, every cell weighted by its
    /// worth to the other.
    pub fn loss_against(&self, other: &Score) -> f64 {
        let cells = self.cells.iter().zip(&other.cells);
        cells.map(|(ours, theirs)| theirs.worth * (log_level(ours) - log_level(theirs))).sum()
    }

    /// Returns the mean over the cells of ln(excess), also below the floor, and of the reduction for runs that do not repeat. It
    /// distinguishes models that are all close to the floor.
    pub fn level(&self) -> f64 {
        self.cells.iter().map(log_level).sum::<f64>() / self.cells.len().max(1) as f64
    }

    /// Returns the mean over the cells of ln(excess), the distance from the noise floor: 0 is perfect.
    pub fn distance(&self) -> f64 {
        let sum: f64 = self.cells.iter().map(|cell| cell.excess.max(1.0).ln()).sum();
        sum / self.cells.len().max(1) as f64
    }

    /// Returns the largest excess of a cell.
    pub fn largest_excess(&self) -> f64 {
        self.cells.iter().map(|cell| cell.excess).fold(0.0, f64::max)
    }

    /// Returns whether nothing is left that a further effect could explain.
    pub fn is_complete(&self) -> bool {
        self.largest_excess() < EXPLAINED && self.distance() < NOTHING_LEFT
    }
}

fn log_excess(cell: &ScoreCell) -> f64 {
    cell.excess.max(SCORE_FLOOR).ln()
}

/// Returns [`log_excess`] plus half the logarithm of what the floor was raised by because runs do not repeat: a mechanism whose
/// runs all diverge explains nothing by that.
fn log_level(cell: &ScoreCell) -> f64 {
    let raised = cell.rms_error / (cell.floor * cell.excess);
    log_excess(cell) + if raised.is_finite() { 0.5 * raised.max(1.0).ln() } else { 0.0 }
}
