//! The line of sight: the inertial angle of the stabilised axis less the one that is demanded, at the hub and at the tip.
//!
//! In a loop of rate the demand is a rate, so the error of the angle is the integral of demand less rate. Its mean over the run says nothing:
//! nobody told the loop where to point. The RMS is therefore about the mean. Jitter is what blurs one exposure of a sensor: the RMS of
//! the angle about its mean within each exposure.

use counterpoise_models::Plant;

use crate::history::{Experiment, History, integrated};
use crate::measure::{Measured, Value};
use crate::signals::rms;
use crate::signals::statistics::centred;
use crate::{Arrangement, Figure, Procedure, SightFigure, Source};

/// How the line of sight is judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineOfSight {
    /// Length of one exposure, s.
    pub exposure_s: f64,
}

impl Default for LineOfSight {
    /// 20 ms: the exposure of a camera at 50 Hz.
    fn default() -> Self {
        Self { exposure_s: 0.02 }
    }
}

/// Size of the error of the line of sight over a run, rad.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SightError {
    /// RMS of the hub's angle about its mean.
    pub hub_rad: f64,
    /// RMS of the hub's angle about its mean in each exposure.
    pub hub_jitter_rad: f64,
    /// RMS of the tip's angle about its mean.
    pub tip_rad: f64,
    /// RMS of the tip's angle about its mean in each exposure.
    pub tip_jitter_rad: f64,
}

impl SightError {
    /// Returns the values in the order of [`SightFigure`]: hub, jitter of the hub, tip, jitter of the tip.
    pub fn values(&self) -> [f64; 4] {
        [self.hub_rad, self.hub_jitter_rad, self.tip_rad, self.tip_jitter_rad]
    }
}

/// The run on which the line of sight is judged: the road, or heave and pitch together, with the whole controller.
pub fn experiment(procedure: &Procedure) -> Experiment {
    let source = if procedure.road.is_some() { Source::Road } else { Source::Both };
    Experiment::Disturbance(source, Arrangement::Compensated)
}

/// Returns the error of the line of sight from the settling time on.
pub fn sight_error(history: &History, settle_s: f64, sight: LineOfSight) -> SightError {
    let first = history.index_at(settle_s);
    let period_s = match history.time_s.get(..2) {
        Some([a, b]) => b - a,
        _ => return SightError::default(),
    };
    let exposure = ((sight.exposure_s / period_s).round() as usize).max(2);
    let of = |rates: &[f64]| {
        let errors = rates.iter().zip(&history.demand_rad_s).skip(first).map(|(rate, demand)| rate - demand);
        let angle = integrated(errors, period_s);
        // a run that is shorter than an exposure is one
        let window = exposure.min(angle.len()).max(1);
        let windows: Vec<f64> = angle.chunks_exact(window).flat_map(centred).collect();
        [rms(&centred(&angle)), rms(&windows)]
    };
    let ([hub_rad, hub_jitter_rad], [tip_rad, tip_jitter_rad]) =
        (of(&history.hub_rate_rad_s), of(&history.tip_rate_rad_s));
    SightError { hub_rad, hub_jitter_rad, tip_rad, tip_jitter_rad }
}

/// Returns the figures of the line of sight from the run on which it is judged; none if nobody asks for them.
pub(crate) fn figures(history: &History, procedure: &Procedure, loop_holds: LoopHolds) -> Vec<Measured> {
    let Some(sight) = procedure.line_of_sight.filter(|_| history.experiment == experiment(procedure)) else {
        return Vec::new();
    };
    let values = sight_error(history, procedure.settle_s, sight).values();
    let measured = |(figure, value): (SightFigure, f64)| Measured {
        figure: Figure::Sight(figure),
        value: match loop_holds {
            LoopHolds::InertialRate => Value::Is(value),
            LoopHolds::Position => Value::Absent {
                why: "the loop holds a position on the platform: its line of sight moves with it".to_owned(),
            },
        },
    };
    SightFigure::ALL.into_iter().zip(values).map(measured).collect()
}

/// What the loop holds still.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum LoopHolds {
    /// A rate: the columns of a history are inertial rates.
    InertialRate,
    /// A position on the platform: the columns are positions.
    Position,
}

impl From<&Plant> for LoopHolds {
    fn from(plant: &Plant) -> Self {
        if plant.parameters().sensors.measured.is_position() { Self::Position } else { Self::InertialRate }
    }
}

/// Returns the figures of a run that diverges.
pub(crate) fn diverged(procedure: &Procedure, ran: Experiment) -> Vec<Measured> {
    let asked = procedure.line_of_sight.is_some() && ran == experiment(procedure);
    let infinite = |figure| Measured { figure: Figure::Sight(figure), value: Value::Is(f64::INFINITY) };
    SightFigure::ALL.into_iter().filter(|_| asked).map(infinite).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Model;
    use std::f64::consts::TAU;

    fn history(rate: impl Fn(f64) -> f64) -> History {
        let time_s: Vec<f64> = (0..20_001).map(|k| 1e-3 * f64::from(k)).collect();
        let rates: Vec<f64> = time_s.iter().map(|t| rate(*t)).collect();
        History {
            model: Model::Nonlinear,
            experiment: Experiment::Disturbance(Source::Both, Arrangement::Compensated),
            demand_rad_s: vec![0.0; rates.len()],
            heave_m_s2: Vec::new(),
            pitch_rate_rad_s: Vec::new(),
            tip_rate_rad_s: rates.iter().map(|rate| 2.0 * rate).collect(),
            hub_rate_rad_s: rates,
            control_v: Vec::new(),
            current_a: Vec::new(),
            travel_rad: Vec::new(),
            contact: Vec::new(),
            time_s,
        }
    }

    #[test]
    fn a_sine_of_the_rate_is_one_of_the_angle_over_its_frequency() {
        let found = sight_error(&history(|t| 0.3 * (TAU * 2.0 * t).cos()), 2.0, LineOfSight::default());
        let expected = 0.3 / (TAU * 2.0) / 2f64.sqrt();
        assert!((found.hub_rad / expected - 1.0).abs() < 1e-3, "{found:?}");
        assert!((found.tip_rad / (2.0 * expected) - 1.0).abs() < 1e-3, "{found:?}");
    }

    #[test]
    fn an_exposure_longer_than_the_run_is_the_run() {
        let found =
            sight_error(&history(|t| 0.3 * (TAU * 2.0 * t).cos()), 2.0, LineOfSight { exposure_s: 1e3 });
        assert_eq!(found.hub_jitter_rad, found.hub_rad);
    }

    /// Within an exposure T a slow sine is a straight line of slope w: its RMS about the mean is w T / sqrt(12).
    #[test]
    fn jitter_is_what_moves_within_an_exposure() {
        let found =
            sight_error(&history(|t| 0.3 * (TAU * 0.5 * t).cos()), 2.0, LineOfSight { exposure_s: 0.1 });
        let expected = 0.3 / 2f64.sqrt() * 0.1 / 12f64.sqrt();
        assert!((found.hub_jitter_rad / expected - 1.0).abs() < 0.01, "{found:?} {expected}");
    }
}
