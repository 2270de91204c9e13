//! The line of sight: the inertial angle of the stabilised axis less the one that is demanded, at the hub and at the tip.
//!
//! In a loop of rate the demand is a rate, so the error of the angle is the integral of demand less rate. Its mean over the run says nothing:
//! a loop of rate has no demanded direction. The RMS is therefore about the mean. Jitter is what blurs one exposure of a sensor: the RMS of
//! the angle about its mean within each exposure.

use counterpoise_models::{Plant, QuantityKind};

use crate::coincidence::coincidence_figures;
use crate::history::{Experiment, History, integrate};
use crate::measure::{MeasuredFigure, Value};
use crate::signals::rms;
use crate::signals::statistics::subtract_mean;
use crate::{Arrangement, LineOfSight, MissingReason, PerformanceFigure, Procedure, SightFigure, Source};

impl Procedure {
    /// Returns the time at the beginning that the figures of the line of sight leave out, s.
    pub fn sight_settle_s(&self) -> f64 {
        self.line_of_sight.and_then(|sight| sight.settle_s).unwrap_or(self.settle_s)
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
    /// RMS of the tip's angle against the hub's, about its mean: what bending makes.
    pub bending_rad: f64,
}

impl SightError {
    /// Returns the values in the order of [`SightFigure::ANGLES`].
    pub fn values(&self) -> [f64; 5] {
        [self.hub_rad, self.hub_jitter_rad, self.tip_rad, self.tip_jitter_rad, self.bending_rad]
    }
}

/// Returns the run on which the line of sight is judged: the road, or heave and pitch together, with the whole controller.
pub fn sight_experiment(procedure: &Procedure) -> Experiment {
    let source = if procedure.road.is_some() { Source::Road } else { Source::Both };
    Experiment::Disturbance(source, Arrangement::Compensated)
}

/// The error of the line of sight in samples: the angle less the demanded one, about its mean.
#[derive(Debug, Clone, PartialEq)]
pub struct SightAngles {
    /// Sample period, s.
    pub period_s: f64,
    /// At the hub, rad.
    pub hub_rad: Vec<f64>,
    /// At the tip, rad.
    pub tip_rad: Vec<f64>,
}

impl SightAngles {
    /// Returns the angles of a history from a time on; `None` if it has fewer than two samples.
    pub fn of(history: &History, settle_s: f64) -> Option<Self> {
        let first = history.index_at(settle_s);
        let period_s = match history.time_s().get(..2) {
            Some([a, b]) => b - a,
            _ => return None,
        };
        let of = |rates: &[f64]| {
            let errors =
                rates.iter().zip(history.demand_rad_s()).skip(first).map(|(rate, demand)| rate - demand);
            subtract_mean(&integrate(errors, period_s))
        };
        Some(Self { period_s, hub_rad: of(history.hub_rate_rad_s()), tip_rad: of(history.tip_rate_rad_s()) })
    }

    /// Returns the first samples, about their mean.
    pub fn first_samples(&self, samples: usize) -> Self {
        let of = |angles: &[f64]| subtract_mean(&angles[..samples.min(angles.len())]);
        Self { period_s: self.period_s, hub_rad: of(&self.hub_rad), tip_rad: of(&self.tip_rad) }
    }

    /// Returns the number of samples in an exposure: at least 2, and no more than there are.
    fn samples_in(&self, exposure_s: f64) -> usize {
        let exposure = ((exposure_s / self.period_s).round() as usize).max(2);
        // a run that is shorter than an exposure is one
        exposure.min(self.hub_rad.len()).max(1)
    }

    /// Returns the sizes of the error; jitter is that within exposures of a length.
    pub fn error(&self, exposure_s: f64) -> SightError {
        let window = self.samples_in(exposure_s);
        let jitter = |angle: &[f64]| {
            let windows: Vec<f64> = angle.chunks_exact(window).flat_map(subtract_mean).collect();
            rms(&windows)
        };
        let bending: Vec<f64> = self.tip_rad.iter().zip(&self.hub_rad).map(|(tip, hub)| tip - hub).collect();
        SightError {
            hub_rad: rms(&self.hub_rad),
            hub_jitter_rad: jitter(&self.hub_rad),
            tip_rad: rms(&self.tip_rad),
            tip_jitter_rad: jitter(&self.tip_rad),
            bending_rad: rms(&bending),
        }
    }
}

/// Returns the error of the line of sight from the settling time on.
pub fn sight_error(history: &History, settle_s: f64, sight: LineOfSight) -> SightError {
    SightAngles::of(history, settle_s).map(|angles| angles.error(sight.exposure_s)).unwrap_or_default()
}

/// Returns the figures of the line of sight from the run on which it is judged; none if the project requires none.
pub(crate) fn figures(
    history: &History,
    procedure: &Procedure,
    loop_holds: LoopHolds,
) -> Vec<MeasuredFigure> {
    let Some(sight) = procedure.line_of_sight.filter(|_| history.experiment == sight_experiment(procedure))
    else {
        return Vec::new();
    };
    let asked = SightFigure::ALL.into_iter().filter(|figure| sight.has(*figure));
    if let Some(why) = loop_holds.unlike_sight() {
        let absent = |figure| MeasuredFigure {
            figure: PerformanceFigure::Sight(figure),
            value: Value::Absent { why: why.clone() },
        };
        return asked.map(absent).collect();
    }
    let values = values(history, procedure.sight_settle_s(), sight);
    let value = |figure: SightFigure| {
        let found = values.iter().find(|(known, _)| *known == figure).map(|(_, value)| *value);
        found.map_or(Value::Absent { why: MissingReason::ShortRun }, Value::Is)
    };
    asked
        .map(|figure| MeasuredFigure { figure: PerformanceFigure::Sight(figure), value: value(figure) })
        .collect()
}

/// Returns why a figure that a project's `[verify.line_of_sight]` does not have was not measured.
pub(crate) fn missing_section(figure: SightFigure) -> MissingReason {
    match figure {
        SightFigure::Coincidence | SightFigure::Wait | SightFigure::Hit => MissingReason::NoCoincidence,
        _ => MissingReason::NoOptics,
    }
}

/// Returns every figure that a run gives.
fn values(history: &History, settle_s: f64, sight: LineOfSight) -> Vec<(SightFigure, f64)> {
    let error = sight_error(history, settle_s, sight).values();
    let mut all: Vec<(SightFigure, f64)> = SightFigure::ANGLES.into_iter().zip(error).collect();
    let Some(angles) = SightAngles::of(history, settle_s) else { return all };
    if let Some(optics) = &sight.optics {
        let exposure = angles.samples_in(sight.exposure_s);
        all.push((SightFigure::HubTransferLoss, optics.loss(&angles.hub_rad, exposure)));
        all.push((SightFigure::TipTransferLoss, optics.loss(&angles.tip_rad, exposure)));
    }
    let fired = sight
        .coincidence
        .and_then(|asked| coincidence_figures(&angles.hub_rad, &angles.tip_rad, angles.period_s, &asked));
    if let Some(fired) = fired {
        all.push((SightFigure::Coincidence, fired.inside));
        all.push((SightFigure::Wait, fired.wait_s));
        all.push((SightFigure::Hit, fired.hit));
    }
    all
}

/// The quantity that the loop holds still.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum LoopHolds {
    /// A rate: the columns of a history are inertial rates.
    InertialRate,
    /// A position on the platform: the columns are positions.
    Position,
    /// A torque, a force or a current: the hub's column is that.
    Effort,
}

impl LoopHolds {
    /// Returns why a loop holds no line of sight; `None` if it does.
    fn unlike_sight(self) -> Option<MissingReason> {
        match self {
            Self::InertialRate => None,
            Self::Position => Some(MissingReason::HoldsPosition),
            Self::Effort => Some(MissingReason::HoldsEffort),
        }
    }
}

impl From<&Plant> for LoopHolds {
    fn from(plant: &Plant) -> Self {
        match plant.parameters().sensors.measured.kind() {
            QuantityKind::Rate => Self::InertialRate,
            QuantityKind::Position => Self::Position,
            QuantityKind::Effort | QuantityKind::Current => Self::Effort,
        }
    }
}

/// Returns the figures of a run that diverges: the error is infinite, nothing is within the window, and no image is left.
pub(crate) fn infinite_figures(procedure: &Procedure, ran: Experiment) -> Vec<MeasuredFigure> {
    let Some(sight) = procedure.line_of_sight.filter(|_| ran == sight_experiment(procedure)) else {
        return Vec::new();
    };
    let worst = |figure| match figure {
        SightFigure::Coincidence | SightFigure::Hit => 0.0,
        SightFigure::HubTransferLoss | SightFigure::TipTransferLoss => 1.0,
        _ => f64::INFINITY,
    };
    let measured =
        |figure| MeasuredFigure { figure: PerformanceFigure::Sight(figure), value: Value::Is(worst(figure)) };
    SightFigure::ALL.into_iter().filter(|figure| sight.has(*figure)).map(measured).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{HistoryColumn, Model};
    use std::f64::consts::TAU;

    fn history(rate: impl Fn(f64) -> f64) -> History {
        let time_s: Vec<f64> = (0..20_001).map(|k| 1e-3 * f64::from(k)).collect();
        let rates: Vec<f64> = time_s.iter().map(|t| rate(*t)).collect();
        let experiment = Experiment::Disturbance(Source::Both, Arrangement::Compensated);
        History::zeros(Model::Nonlinear, experiment, rates.len())
            .with(HistoryColumn::Time, time_s)
            .with(HistoryColumn::TipRate, rates.iter().map(|rate| 2.0 * rate))
            .with(HistoryColumn::HubRate, rates)
    }

    #[test]
    fn a_sine_of_the_rate_is_one_of_the_angle_over_its_frequency() {
        let found = sight_error(&history(|t| 0.3 * (TAU * 2.0 * t).cos()), 2.0, LineOfSight::default());
        let expected = 0.3 / (TAU * 2.0) / 2f64.sqrt();
        assert!((found.hub_rad / expected - 1.0).abs() < 1e-3, "{found:?}");
        assert!((found.tip_rad / (2.0 * expected) - 1.0).abs() < 1e-3, "{found:?}");
        // the tip moves twice as far as the hub, so against the hub as far as the hub
        assert!((found.bending_rad / expected - 1.0).abs() < 1e-3, "{found:?}");
    }

    #[test]
    fn an_exposure_longer_than_the_run_is_the_run() {
        let found = sight_error(
            &history(|t| 0.3 * (TAU * 2.0 * t).cos()),
            2.0,
            LineOfSight { exposure_s: 1e3, ..LineOfSight::default() },
        );
        assert_eq!(found.hub_jitter_rad, found.hub_rad);
    }

    /// Within an exposure T a slow sine is a straight line of slope w: its RMS about the mean is w T / sqrt(12).
    #[test]
    fn jitter_is_what_moves_within_an_exposure() {
        let found = sight_error(
            &history(|t| 0.3 * (TAU * 0.5 * t).cos()),
            2.0,
            LineOfSight { exposure_s: 0.1, ..LineOfSight::default() },
        );
        let expected = 0.3 / 2f64.sqrt() * 0.1 / 12f64.sqrt();
        assert!((found.hub_jitter_rad / expected - 1.0).abs() < 0.01, "{found:?} {expected}");
    }
}
