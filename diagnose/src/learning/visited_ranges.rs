//! The values that recordings have of each regime variable: the range over which a free function is known, and how often.

use counterpoise_models::{FeedbackSignal, LearnedElement, LearnedPlace, Parameters, RegimeVariable};
use counterpoise_recordings::{ColumnName, Signals};

use crate::localisation::torque_balances::{BalanceColumn, BalanceSignals};
use crate::machine::RedundantSensors;
use crate::recording::measured_signals::MeasuredSignals;
use crate::recording::series::rms;
use crate::tolerance::FITTED_SHARE;
use crate::tolerance::learning::{LEAST_RELATIVE_RANGE, LEAST_SHOWN};
use crate::tolerance::learning::{RANGE_MARGIN, RANGE_QUANTILE};

/// The values of the regime variables, recording by recording.
#[derive(Debug, Clone, Default)]
pub struct VisitedRanges {
    recordings: Vec<Signals<VisitedColumn>>,
    /// RMS torque of the drive at the hub, N m.
    pub drive_torque_nm: f64,
    ratio: f64,
    stiffness: f64,
    /// Sensors that every recording has beside those that it must have.
    recorded: RedundantSensors,
}

/// The extent to which the first parts of recordings are taken to tell of a function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Reach {
    /// As far as their samples go.
    Samples,
    /// To the points nearest to their samples.
    Points,
}

/// Share of recordings beyond the range over which a free function is known.
#[derive(Debug, Clone, PartialEq)]
pub struct RangeExceedance {
    /// Name of the function.
    pub name: String,
    /// The component at which it acts.
    pub place: LearnedPlace,
    /// The variable that it is a function of.
    pub variable: RegimeVariable,
    /// Unit of the variable.
    pub unit: &'static str,
    /// The range over which it is known.
    pub known: [f64; 2],
    /// The range that the recordings visit.
    pub reached: [f64; 2],
    /// Share of the samples beyond the known range, 0 to 1.
    pub share: f64,
}

/// A column of the values that a recording visits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum VisitedColumn {
    /// Hub angle on the platform, rad.
    Angle,
    /// Hub rate on the platform, rad/s.
    Rate,
    /// Motor rate, rad/s.
    MotorRate,
    /// Torque that the motor gives to the gear, at its output, N m.
    Load,
    /// Control that the amplifier passes to the motor, V.
    Drive,
    /// Time, s.
    Time,
    /// What the loop's sensor should read, in its unit.
    LoopReading,
    /// Rate of the platform, rad/s.
    PlatformRate,
    /// Heave, m/s^2.
    Heave,
    /// What the loop's sensor shows beyond what it should read, in its unit; not a number if no other sensor tells.
    LoopError,
}

impl ColumnName for VisitedColumn {
    fn index(self) -> usize {
        self as usize
    }
}

impl VisitedRanges {
    /// Returns what recordings visit.
    pub fn of(base: &Parameters, recordings: &[MeasuredSignals]) -> Self {
        let mut torques = Vec::new();
        let one = |recording: &MeasuredSignals| {
            let signals = BalanceSignals::new(base, recording, None);
            let torque = signals.column(BalanceColumn::Drive);
            torques.extend(torque.iter().filter(|torque| torque.is_finite()));
            let drive = |control: &f64| base.amplifier.drive_v(*control, &base.motor);
            let drive: Vec<f64> = recording.control().iter().map(drive).collect();
            let time: Vec<f64> = (0..signals.len()).map(|k| k as f64 * recording.period_s).collect();
            let reading = loop_reading(base, recording, &signals);
            // in the order of `VisitedColumn`
            Signals::stack([
                signals.column(BalanceColumn::Angle),
                signals.column(BalanceColumn::Relative),
                signals.column(BalanceColumn::Motor),
                signals.column(BalanceColumn::Mesh),
                &drive,
                &time,
                &reading,
                signals.column(BalanceColumn::Platform),
                signals.column(BalanceColumn::Heave),
                &loop_error(recording, &signals, &reading),
            ])
        };
        let recorded = RedundantSensors {
            motor_rate: recordings.iter().all(|r| r.recorded.motor_rate),
            hub_position: recordings.iter().all(|r| r.recorded.hub_position),
        };
        let recordings = recordings.iter().map(one).collect();
        Self {
            recordings,
            recorded,
            drive_torque_nm: rms(&torques),
            ratio: base.gearbox.ratio,
            stiffness: base.gearbox.stiffness_nm_rad,
        }
    }

    /// Returns whether a sensor of the machine was recorded.
    pub(crate) fn has_recorded(&self, place: LearnedPlace) -> bool {
        match place {
            LearnedPlace::MotorTachometer => self.recorded.motor_rate,
            LearnedPlace::HubResolver => self.recorded.hub_position,
            _ => true,
        }
    }

    /// Returns the RMS of what a sensor reads, in its unit.
    pub(crate) fn reading_rms(&self, place: LearnedPlace) -> f64 {
        rms(&self.samples(place, RegimeVariable::Reading).concat())
    }

    /// Returns the values of an error of the loop's sensor that redundant sensors show, its values near each point in the mean; `None` for
    /// another element, or if no other sensor tells.
    pub(crate) fn shown_error(&self, element: &LearnedElement) -> Option<Vec<f64>> {
        if element.place != LearnedPlace::LoopSensor || element.variable != RegimeVariable::Reading {
            return None;
        }
        let mut sums = vec![[0.0; 2]; element.points.len()];
        let variable = self.samples(element.place, element.variable).concat();
        let errors = self.recordings.iter().flat_map(|r| r.column(VisitedColumn::LoopError));
        for (at, error) in variable.iter().zip(errors).filter(|(at, error)| (*at + *error).is_finite()) {
            let above = element.points.partition_point(|point| point < at).clamp(1, sums.len() - 1);
            let (low, high) = (element.points[above - 1], element.points[above]);
            let share = ((at - low) / (high - low)).clamp(0.0, 1.0);
            for (k, weight) in [(above - 1, 1.0 - share), (above, share)] {
                sums[k] = [sums[k][0] + weight, sums[k][1] + weight * error];
            }
        }
        let known = |k: usize| (sums[k][0] >= LEAST_SHOWN).then(|| sums[k][1] / sums[k][0]);
        let first = (0..sums.len()).find_map(known)?;
        let mut last = first;
        let mut value = |k: usize| {
            last = known(k).unwrap_or(last);
            last
        };
        Some((0..sums.len()).map(&mut value).collect())
    }

    /// Returns the samples of a variable at a place, recording by recording.
    fn samples(&self, place: LearnedPlace, variable: RegimeVariable) -> Vec<Vec<f64>> {
        let one = |r: &Signals<VisitedColumn>| {
            let own = |column: VisitedColumn| r.column(column).to_vec();
            let scaled =
                |column: VisitedColumn, factor: f64| r.column(column).iter().map(|x| factor * x).collect();
            match (variable, place) {
                (RegimeVariable::Angle | RegimeVariable::Turn, LearnedPlace::Pivot) => {
                    own(VisitedColumn::Angle)
                }
                (RegimeVariable::Angle | RegimeVariable::Turn, LearnedPlace::Motor) => {
                    scaled(VisitedColumn::Angle, self.ratio)
                }
                (RegimeVariable::Angle | RegimeVariable::Turn, LearnedPlace::Gearbox) => {
                    scaled(VisitedColumn::Load, 1.0 / self.stiffness)
                }
                (RegimeVariable::Angle | RegimeVariable::Turn, _) => own(VisitedColumn::Angle),
                (RegimeVariable::Reading, LearnedPlace::MotorTachometer) => own(VisitedColumn::MotorRate),
                (RegimeVariable::Reading, LearnedPlace::HubResolver) => own(VisitedColumn::Angle),
                (RegimeVariable::Reading, LearnedPlace::PlatformGyro) => own(VisitedColumn::PlatformRate),
                (RegimeVariable::Reading, LearnedPlace::PlatformAccelerometer) => own(VisitedColumn::Heave),
                (RegimeVariable::Reading, _) => own(VisitedColumn::LoopReading),
                (RegimeVariable::Rate, LearnedPlace::Motor) => own(VisitedColumn::MotorRate),
                (RegimeVariable::Rate, _) => own(VisitedColumn::Rate),
                (RegimeVariable::Load, LearnedPlace::Motor) => scaled(VisitedColumn::Load, 1.0 / self.ratio),
                (RegimeVariable::Load, _) => own(VisitedColumn::Load),
                (RegimeVariable::Control, _) => own(VisitedColumn::Drive),
                (RegimeVariable::Time, _) => own(VisitedColumn::Time),
            }
        };
        self.recordings.iter().map(one).collect()
    }

    /// Returns the range of an element's variable in the first parts of all recordings, with a share of the spacing of its points at either
    /// end.
    fn range_of_heads(&self, element: &LearnedElement, margin: f64) -> [f64; 2] {
        let heads = |series: Vec<f64>| {
            let count = (series.len() as f64 * FITTED_SHARE) as usize;
            series.into_iter().take(count).collect::<Vec<f64>>()
        };
        let all = self.samples(element.place, element.variable).into_iter().flat_map(heads);
        let (low, high) = all
            .filter(|x| x.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        let count = element.points.len();
        let spacing = (element.points[count - 1] - element.points[0]) / (count - 1).max(1) as f64;
        [low - margin * spacing, high + margin * spacing]
    }

    /// Returns whether the first parts of the recordings determine each point of an element.
    pub(crate) fn determined_points(&self, element: &LearnedElement) -> Vec<bool> {
        if matches!(element.variable, RegimeVariable::Turn | RegimeVariable::Time) {
            return vec![true; element.points.len()];
        }
        let [low, high] = self.range_of_heads(element, 0.5);
        element.points.iter().map(|point| (low..=high).contains(point)).collect()
    }

    /// Returns the share of a recording up to which it stays in the range of the first parts of all recordings: nothing is known of an
    /// element beyond. With [`Reach::Points`] the range extends to half a spacing of the element's points at either end.
    pub(crate) fn share_in_range(&self, element: &LearnedElement, recording: usize, reach: Reach) -> f64 {
        if matches!(element.variable, RegimeVariable::Turn | RegimeVariable::Time) {
            return 1.0;
        }
        let [low, high] = match reach {
            Reach::Points => self.range_of_heads(element, 0.5),
            Reach::Samples => self.range_of_heads(element, RANGE_MARGIN),
        };
        let samples = self.samples(element.place, element.variable);
        let Some(series) = samples.get(recording) else { return 1.0 };
        let outside = |x: &f64| x.is_finite() && !(low..=high).contains(x);
        series.iter().position(outside).map_or(1.0, |first| first as f64 / series.len() as f64)
    }

    /// Returns the range of a variable at a place without the rarest samples; `None` if it does not move.
    pub fn range(&self, place: LearnedPlace, variable: RegimeVariable) -> Option<[f64; 2]> {
        let mut sorted = self.samples(place, variable).concat();
        sorted.retain(|x| x.is_finite());
        sorted.sort_by(f64::total_cmp);
        let last = sorted.len().checked_sub(1)?;
        let rare = (RANGE_QUANTILE * last as f64) as usize;
        let (low, high) = (sorted[rare], sorted[last - rare]);
        (high - low > LEAST_RELATIVE_RANGE * low.abs().max(high.abs()) && high > low).then_some([low, high])
    }

    /// Returns how far the recordings leave the range over which an element is known; `None` if they hardly do.
    pub fn range_exceedance(&self, element: &LearnedElement) -> Option<RangeExceedance> {
        let (Some(&first), Some(&last)) = (element.points.first(), element.points.last()) else {
            return None;
        };
        if element.variable == RegimeVariable::Turn {
            return None;
        }
        let mut samples = self.samples(element.place, element.variable).concat();
        samples.retain(|x| x.is_finite());
        let margin = RANGE_MARGIN * (last - first);
        let outside = samples.iter().filter(|x| **x < first - margin || **x > last + margin).count();
        let share = outside as f64 / samples.len().max(1) as f64;
        let reached = [
            samples.iter().copied().fold(f64::INFINITY, f64::min),
            samples.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        ];
        (share > RANGE_QUANTILE).then(|| RangeExceedance {
            name: element.name.clone(),
            place: element.place,
            variable: element.variable,
            unit: element.variable_unit(),
            known: [first, last],
            reached,
            share,
        })
    }

    /// Returns the share of the samples nearest to each point of an element.
    pub fn coverage(&self, element: &LearnedElement) -> Vec<f64> {
        let mut counts = vec![0.0; element.points.len()];
        let turn = element.variable == RegimeVariable::Turn;
        let mut total = 0.0;
        for sample in self.samples(element.place, element.variable).concat() {
            let at = if turn { sample.rem_euclid(std::f64::consts::TAU) } else { sample };
            if !at.is_finite() {
                continue;
            }
            let above = element.points.partition_point(|point| *point < at).min(counts.len() - 1);
            let below = above.saturating_sub(1);
            let nearer_below = (at - element.points[below]).abs() < (element.points[above] - at).abs();
            counts[if nearer_below { below } else { above }] += 1.0;
            total += 1.0;
        }
        // four digits are enough for a drawing
        counts.iter().map(|count| (1e4 * count / f64::max(total, 1.0)).round() * 1e-4).collect()
    }
}

/// Returns what the loop's sensor should read: a gyroscope on the hub what tachometer and platform say, if the tachometer was recorded, because a
/// sensor with an error does not show its own range.
fn loop_reading(base: &Parameters, recording: &MeasuredSignals, signals: &BalanceSignals) -> Vec<f64> {
    if recording.measured != FeedbackSignal::HubRate || !recording.recorded.motor_rate {
        return recording.hub_rate().to_vec();
    }
    let (motor, platform) = (signals.column(BalanceColumn::Motor), signals.column(BalanceColumn::Platform));
    motor.iter().zip(platform).map(|(m, p)| m / base.gearbox.ratio + p).collect()
}

/// Returns what the loop's sensor shows beyond what it should read; not a number if no other sensor tells.
fn loop_error(recording: &MeasuredSignals, signals: &BalanceSignals, reading: &[f64]) -> Vec<f64> {
    if recording.measured != FeedbackSignal::HubRate || !recording.recorded.motor_rate {
        return vec![f64::NAN; reading.len()];
    }
    signals.column(BalanceColumn::Hub).iter().zip(reading).map(|(shown, should)| shown - should).collect()
}
