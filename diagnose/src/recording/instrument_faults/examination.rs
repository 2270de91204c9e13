//! The examination of recordings for faults of sensors and recorder, before any physics.
//!
//! A column is examined by itself (`single_column`), then against what all columns must satisfy whatever the mechanism is like
//! (`identities`): factors and exchanged columns (`factors`), the accelerometer's unit (`accelerometer_unit`), clocks (`clocks`).
//! Faults that a gyroscope itself may have (gain, bias, lag, delay) are left to the library of physics, because this sensor is
//! inside the control loop.

use counterpoise_models::{FeedbackSignal, Parameters};
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::replay::ReplayLoop;

use crate::recording::instrument_faults::column::RecorderColumn;
use crate::recording::instrument_faults::factors::{FoundMistake, Mistake};
use crate::recording::instrument_faults::fault::{self, FaultKind, InstrumentFault, Treatment};
use crate::recording::instrument_faults::regression::{delay_series, regress};
use crate::recording::instrument_faults::{accelerometer_unit, clocks, factors, identities, single_column};
use crate::recording::noise::measure_white_noise;
use crate::recording::series::deviation;
use crate::tolerance::recording::{
    FACTOR_CERTAINTY, MOTOR_BIAS_RAD_S, NEARLY_WHOLE_SAMPLES, PLATFORM_REST_MULTIPLE,
    RECOMPUTED_CONTROL_MULTIPLE, RESOLVER_MEAN_SHARE, WRONG_FACTORS_AT_MOST,
};

/// Recordings without the faults that could be repaired, and the faults.
#[derive(Debug, Clone, PartialEq)]
pub struct ExaminedRecordings {
    /// The recordings: columns that cannot be repaired are missing, useless readings are not numbers.
    pub recordings: Vec<Recording>,
    /// Faults that were found.
    pub faults: Vec<InstrumentFault>,
    /// The columns that each recording had.
    written: Vec<Vec<RecorderColumn>>,
}

/// Examines the recordings of one machine; `control` is the controller that was in the loop, if the project knows it.
pub fn find_instrument_faults(
    base: &Parameters,
    control: &ReplayLoop,
    recordings: &[Recording],
) -> ExaminedRecordings {
    let columns = |r: &Recording| RecorderColumn::ALL.into_iter().filter(|c| c.of(r).is_some()).collect();
    let written = recordings.iter().map(columns).collect();
    let mut out = ExaminedRecordings { recordings: recordings.to_vec(), faults: Vec::new(), written };
    out.examine_single_columns(base, control);
    if base.sensors.measured != FeedbackSignal::HubRate {
        // what the columns must satisfy together is stated for a gyroscope on the hub
        out.control_offsets(base, control);
        return out;
    }
    for _ in 0..WRONG_FACTORS_AT_MOST {
        let Some(found) = factors::find_mistake(base, control, &out.recordings) else { break };
        out.mistake(&found);
    }
    out.heave(base);
    out.coarse(base);
    out.control_offsets(base, control);
    out.drifts(base);
    out.offsets(base);
    out.biases(base);
    out
}

/// Returns whether a column shows a place in steps: such a reading stands still while the machine rests, and is not stuck.
fn shows_a_place(base: &Parameters, column: RecorderColumn) -> bool {
    column == RecorderColumn::HubRate && base.sensors.measured.is_position()
}

/// Returns whether a fault is no more than a machine at rest: where the loop's sensor shows a place in steps, the control stands still with it.
fn rests_with_machine(base: &Parameters, column: RecorderColumn, kind: &FaultKind) -> bool {
    let stands_still = matches!(kind, FaultKind::Stuck { .. });
    stands_still && column == RecorderColumn::Control && base.sensors.measured.is_position()
}

impl ExaminedRecordings {
    /// Notes a fault in recordings; adds them to a fault of this kind that is known already.
    fn note(&mut self, column: RecorderColumn, kind: FaultKind, recordings: &[usize], treatment: Treatment) {
        let names: Vec<String> = recordings.iter().map(|r| self.recordings[*r].name.clone()).collect();
        let count = self.written.iter().filter(|columns| columns.contains(&column)).count();
        let same = |f: &&mut InstrumentFault| {
            f.column == column && std::mem::discriminant(&f.kind) == std::mem::discriminant(&kind)
        };
        match self.faults.iter_mut().find(same) {
            Some(known) => {
                let more: Vec<String> = names.into_iter().filter(|n| !known.recordings.contains(n)).collect();
                known.recordings.extend(more);
                known.everywhere = known.recordings.len() >= count;
            }
            None => self.faults.push(InstrumentFault {
                column,
                kind,
                everywhere: names.len() >= count,
                recordings: names,
                treatment,
                or: Vec::new(),
            }),
        }
    }

    fn examine_single_columns(&mut self, base: &Parameters, control: &ReplayLoop) {
        for r in 0..self.recordings.len() {
            for column in RecorderColumn::ALL.into_iter().filter(|column| !shows_a_place(base, *column)) {
                let period_s = self.recordings[r].sample_period_s;
                self.bridge(r, column, control, base);
                let Some(series) = column.of(&self.recordings[r]) else { continue };
                let found = single_column::find_faults(column, series, base, period_s);
                for seen in found.into_iter().filter(|seen| !rests_with_machine(base, column, &seen.kind)) {
                    let done = self.without(r, column, &seen.useless, &seen.kind, control, base);
                    self.note(column, seen.kind, &[r], done);
                }
            }
        }
    }

    /// Replaces missing values by what they must have been: the controller's own output, or the rest of a platform at rest.
    fn bridge(&mut self, r: usize, column: RecorderColumn, control: &ReplayLoop, base: &Parameters) {
        let recording = &mut self.recordings[r];
        let Some(series) = column.of_mut(recording) else { return };
        let missing = series.iter().filter(|v| !v.is_finite()).count();
        if missing == 0 || missing == series.len() {
            return;
        }
        match column {
            RecorderColumn::Control => {
                recompute_controls(recording, control, base);
            }
            RecorderColumn::PlatformRate | RecorderColumn::PlatformAccel
                if deviation(series) < PLATFORM_REST_MULTIPLE * measure_white_noise(series) =>
            {
                fill_missing(series);
            }
            _ => {}
        }
    }

    /// Removes useless readings from a column, or replaces them by what they must have been; returns what was done.
    fn without(
        &mut self,
        r: usize,
        column: RecorderColumn,
        useless: &[usize],
        kind: &FaultKind,
        control: &ReplayLoop,
        base: &Parameters,
    ) -> Treatment {
        let recording = &mut self.recordings[r];
        let clip_of_drive = matches!(kind, FaultKind::Clipped { .. })
            && matches!(column, RecorderColumn::PlatformRate | RecorderColumn::PlatformAccel);
        if useless.is_empty() || clip_of_drive {
            return Treatment::UsedAsItIs;
        }
        let Some(series) = column.of_mut(recording) else { return Treatment::UsedAsItIs };
        useless.iter().for_each(|k| series[*k] = f64::NAN);
        if column == RecorderColumn::Control && recompute_controls(recording, control, base) {
            return Treatment::ControlRecomputed;
        }
        match (kind, column) {
            (FaultKind::Held { .. }, RecorderColumn::PlatformRate | RecorderColumn::PlatformAccel) => {
                if let Some(series) = column.of_mut(recording) {
                    fill_missing(series);
                }
                Treatment::Interpolated
            }
            (_, RecorderColumn::PlatformRate | RecorderColumn::PlatformAccel | RecorderColumn::Control) => {
                Treatment::StretchesLeftOut
            }
            _ => Treatment::SamplesNotCompared,
        }
    }

    fn mistake(&mut self, found: &FoundMistake) {
        let cured = factors::correct_mistake(&self.recordings, found);
        let (column, kind) = match found.mistake {
            Mistake::Scale { column, gain, doubt } => (column, FaultKind::Scale { gain, doubt }),
            Mistake::Exchange { one, other } => (one, FaultKind::Exchanged { with: other }),
        };
        let unsure = match kind {
            FaultKind::Scale { gain, doubt } => !fault::is_known(gain) && doubt > FACTOR_CERTAINTY,
            _ => false,
        };
        let spare = matches!(column, RecorderColumn::MotorRate | RecorderColumn::HubPosition);
        self.recordings = cured;
        let done = match (&kind, unsure && spare) {
            (_, true) => {
                for r in &found.recordings {
                    self.recordings[*r].remove(column.channel());
                }
                Treatment::NotCompared
            }
            (FaultKind::Exchanged { .. }, _) => Treatment::ExchangedBack,
            _ => Treatment::DividedByGain,
        };
        self.note(column, kind, &found.recordings, done);
        if let Some(fault) = self.faults.last_mut() {
            fault.or.extend(found.or.iter().filter(|c| **c != column));
        }
    }

    fn heave(&mut self, base: &Parameters) {
        for r in 0..self.recordings.len() {
            let Some((gain, doubt)) = accelerometer_unit::estimate_gain(base, &self.recordings[r]) else {
                continue;
            };
            let column = RecorderColumn::PlatformAccel;
            if let Some(series) = column.of_mut(&mut self.recordings[r]) {
                series.iter_mut().for_each(|v| *v /= gain);
            }
            self.note(column, FaultKind::Scale { gain, doubt }, &[r], Treatment::DividedByGain);
        }
    }

    fn drifts(&mut self, base: &Parameters) {
        for column in [RecorderColumn::MotorRate, RecorderColumn::HubPosition] {
            let Some((slow, doubt)) = clocks::estimate_drift(base, &self.recordings, column) else {
                continue;
            };
            for recording in &mut self.recordings {
                recording.remove(column.channel());
            }
            let all: Vec<usize> = (0..self.recordings.len()).collect();
            self.note(column, FaultKind::ClockDrift { slow, doubt }, &all, Treatment::NotCompared);
        }
    }

    /// Notes converters coarser than the project's, of columns that are sound otherwise.
    fn coarse(&mut self, base: &Parameters) {
        for r in 0..self.recordings.len() {
            for column in RecorderColumn::ALL {
                let sound = self.faults.iter().all(|f| f.column != column);
                let known =
                    |f: &InstrumentFault| f.column == column && matches!(f.kind, FaultKind::Coarse { .. });
                let Some(series) = column.of(&self.recordings[r]) else { continue };
                let kind = single_column::find_coarse_converter(column, series, base);
                if let Some(kind) = kind.filter(|_| sound || self.faults.iter().any(known)) {
                    self.note(column, kind, &[r], Treatment::UsedAsItIs);
                }
            }
        }
    }

    fn control_offsets(&mut self, base: &Parameters, control: &ReplayLoop) {
        if let Some((column, lateness, recordings)) = clocks::control_offset(base, control, &self.recordings)
        {
            recordings.into_iter().for_each(|r| self.shift(r, column, lateness));
        }
    }

    fn offsets(&mut self, base: &Parameters) {
        let found = clocks::estimate_offsets(base, &self.recordings);
        found.into_iter().for_each(|(r, column, lateness)| self.shift(r, column, lateness));
    }

    /// Shifts a late column back. The motor's is left out, because its offset is known no better than the twist of its gear.
    fn shift(&mut self, r: usize, column: RecorderColumn, lateness: clocks::Lateness) {
        let clocks::Lateness { late_s, doubt_s } = lateness;
        let samples = snap_to_whole(late_s / self.recordings[r].sample_period_s);
        let recording = &mut self.recordings[r];
        let series = recording.remove(column.channel());
        let done = if column == RecorderColumn::MotorRate {
            Treatment::NotCompared
        } else {
            let shifted = series.and_then(|series| Some(delay_series(series.as_slice()?, -samples)));
            shifted.and_then(|shifted| recording.set(column.channel(), shifted));
            Treatment::ShiftedBack
        };
        let kind = FaultKind::ClockOffset { late_s, doubt_s };
        self.note(column, kind, &[r], done);
    }

    /// Leaves out a motor's rate with a mean that neither gyroscopes nor resolver have.
    fn biases(&mut self, base: &Parameters) {
        let biased: Vec<(usize, f64, f64)> =
            (0..self.recordings.len()).filter_map(|r| motor_bias(base, &self.recordings[r], r)).collect();
        let count = self.recordings.iter().filter(|r| r.has(Channel::MotorRate)).count();
        if biased.is_empty() || biased.len() < count {
            return;
        }
        for (r, bias, doubt) in biased {
            self.recordings[r].remove(Channel::MotorRate);
            self.note(
                RecorderColumn::MotorRate,
                FaultKind::Bias { bias, doubt },
                &[r],
                Treatment::NotCompared,
            );
        }
    }
}

/// Returns the motor's mean rate beyond the resolver's, if the resolver has none beyond the gyroscopes.
fn motor_bias(base: &Parameters, recording: &Recording, r: usize) -> Option<(usize, f64, f64)> {
    let found = identities::list_identities(base, &ReplayLoop::Open, recording);
    let of = |column| found.iter().find(|i| i.of == column);
    let (motor, resolver) = (of(RecorderColumn::MotorRate)?, of(RecorderColumn::HubPosition)?);
    let apart = motor.constant.0 - resolver.constant.0;
    let doubt = motor.left.max(resolver.left);
    let told = apart.abs() > MOTOR_BIAS_RAD_S
        && apart.abs() > doubt
        && resolver.constant.0.abs() < RESOLVER_MEAN_SHARE * apart.abs();
    told.then_some((r, apart * base.gearbox.ratio, doubt * base.gearbox.ratio))
}

/// Returns a whole number of samples if the number is nearly whole.
fn snap_to_whole(samples: f64) -> f64 {
    if (samples - samples.round()).abs() < NEARLY_WHOLE_SAMPLES { samples.round() } else { samples }
}

/// Interpolates what is missing by straight lines, with the nearest reading at the ends.
fn fill_missing(series: &mut [f64]) {
    let known: Vec<usize> = (0..series.len()).filter(|k| series[*k].is_finite()).collect();
    let (Some(&first), Some(&last)) = (known.first(), known.last()) else { return };
    let (start, end) = (series[first], series[last]);
    series[..first].fill(start);
    series[last..].fill(end);
    for two in known.windows(2) {
        let (from, to) = (two[0], two[1]);
        let step = (series[to] - series[from]) / (to - from) as f64;
        let start = series[from];
        (from + 1..to).for_each(|k| series[k] = start + step * (k - from) as f64);
    }
}

/// Replaces missing controls by the controller's own output if it agrees with the others; returns whether it did.
fn recompute_controls(recording: &mut Recording, control: &ReplayLoop, base: &Parameters) -> bool {
    let Some(controller) = identities::proportional_integral(control) else { return false };
    let channels = [Channel::Demand, Channel::HubRate, Channel::Control];
    let [Some(demand), Some(hub), Some(u)] = channels.map(|channel| recording.samples(channel)) else {
        return false;
    };
    let error: Vec<f64> = demand.iter().zip(hub).map(|(d, h)| d - h).collect();
    let made = identities::apply_proportional_integral(controller, &error, recording.sample_period_s);
    let one = vec![1.0; u.len()];
    let rest: Vec<f64> = u.iter().zip(&made).map(|(u, m)| u - m).collect();
    let Some(fit) = regress(&[&one], &rest) else { return false };
    let noise = RecorderColumn::Control.converter_step(base).unwrap_or(0.0) / 12f64.sqrt();
    if fit.left > RECOMPUTED_CONTROL_MULTIPLE * noise || made.iter().any(|v| !v.is_finite()) {
        return false;
    }
    let whole = u.iter().zip(&made).map(|(u, m)| if u.is_finite() { *u } else { m + fit.value[0] });
    let whole: Vec<f64> = whole.collect();
    recording.set(Channel::Control, whole);
    true
}
