//! The whole diagnosis: from recordings to an answer, in one function.

use counterpoise_models::{FeedbackSignal, Parameters};
use counterpoise_recordings::{Channel, Recording};
use counterpoise_simulate::replay::ReplayLoop;

use crate::error::Error;
use crate::explanation::{Explanation, explain};
use crate::findings::answer::{Answer, DiagnosisVerdict};
use crate::findings::axis_units::set_axis_units;
use crate::findings::instrument_findings::make_finding;
use crate::findings::similarity::SimilarityScale;
use crate::findings::verdict::VerdictEvidence;
use crate::identification::{IdentifiedAmplifier, apply_identified, identify};
use crate::library::{
    Component, Effect, EffectName, find_effects, list_effects, list_textbook_effects, make_free_gain_curve,
};
use crate::localisation::error_map::{MapCell, localise_errors};
use crate::localisation::residual_regression::AssessedReplay;
use crate::localisation::torque_balances::{BalanceVisibility, list_balances};
use crate::machine::{
    RedundantSensors, can_have, can_have_textbook, can_show, has_component, usable_sensors,
};
use crate::recording::gap_repair::repair_gaps;
use crate::recording::instrument_faults::{InstrumentFault, find_instrument_faults};
use crate::recording::measured_signals::read_signals;
use crate::recording::noise::{with_noise_levels_of, with_recorded_noise};
use crate::recording::remarks::{ComparisonState, RecordingRemark};
use crate::recording::sanity_checks::{check_control, check_signals};
use crate::recording::unknown_heave::drop_unknown_heave;
use crate::selection::searcher::Searcher;
use crate::selection::sizes::Sizes;
use crate::shortening::{shorten, textbook_samples};
use crate::simulator_access::SimulatorAccess;
use crate::simulator_access::objective::{PreparedRecordings, RecordingReplays};
use crate::tolerance::{BIAS_SEEN_RAD_S, SAMPLES_AT_MOST, STIFF_STEPS_PER_SAMPLE};
use counterpoise_pool::{Pool, map};

/// A diagnosis: the answer, and the machine that explains the recordings.
#[derive(Debug, Clone)]
pub struct Diagnosis {
    /// The answer.
    pub answer: Answer,
    /// The mechanism with the effects that were found; as it was if there are none.
    pub improved: Parameters,
    /// The recordings as they were diagnosed: without the faults of sensors and recorder that could be repaired.
    pub recordings: Vec<Recording>,
    /// The loop in which they were replayed.
    pub control: ReplayLoop,
}

/// Treatment of a recorded control that the loop's controller does not compute from the recorded readings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contradiction {
    /// All recordings are replayed under their recorded control: another controller was in the loop.
    PlayBack,
    /// The recordings are replayed in closed loop all the same: their columns are not the samples that the controller read.
    Ignore,
}

/// Input of a diagnosis: the nominal mechanism, the recordings and the options.
#[derive(Debug, Clone)]
pub struct Request<'a> {
    /// The mechanism as the project has it.
    pub base: &'a Parameters,
    /// The controller that was in the loop, or [`ReplayLoop::Open`] if it is not known.
    pub control: ReplayLoop,
    /// Treatment of recordings that contradict that controller.
    pub contradiction: Contradiction,
    /// The recordings of one machine.
    pub recordings: &'a [Recording],
}

impl Diagnosis {
    /// Adds the faults of sensors and recorder in front of the other findings: they were found before any physics, and what is
    /// explained after their repair is explained by them.
    fn with_faults(mut self, faults: &[InstrumentFault]) -> Self {
        if faults.is_empty() {
            return self;
        }
        let answer = &mut self.answer;
        answer.verdict = match answer.verdict {
            DiagnosisVerdict::Consistent => DiagnosisVerdict::Named,
            DiagnosisVerdict::Unknown => DiagnosisVerdict::Incomplete,
            other => other,
        };
        answer.findings.splice(0..0, faults.iter().map(make_finding));
        answer.remarks.splice(0..0, faults.iter().cloned().map(RecordingRemark::Fault));
        self
    }
}

/// Diagnoses a machine of any size from its recordings: in closed loop with the controller that was in the loop, or under the
/// recorded control if the controller is not known ([`ReplayLoop::Open`]).
///
/// # Errors
/// No recording, a channel that is missing, a recording that does not fit the project's clock, a mechanism that cannot
/// be simulated; [`Error::Cancelled`] if the pool was asked to stop.
pub fn diagnose(
    base: &Parameters,
    control: impl Into<ReplayLoop>,
    recordings: &[Recording],
    pool: &dyn Pool,
) -> Result<Diagnosis, Error> {
    diagnose_request(
        &Request { base, control: control.into(), contradiction: Contradiction::Ignore, recordings },
        pool,
    )
}

/// Carries out a request: [`diagnose`] with a choice of what happens if the recordings were made under another controller.
///
/// # Errors
/// As [`diagnose`].
pub fn diagnose_request(request: &Request, pool: &dyn Pool) -> Result<Diagnosis, Error> {
    let mut found = match SimilarityScale::of(request.base, request.recordings) {
        Some(scale) => {
            diagnose_scaled(scale, request.base, request.control.clone(), request.recordings, pool)?
        }
        None => diagnose_as_built(request, pool)?,
    };
    set_axis_units(&mut found.answer, request.base);
    Ok(found)
}

/// Diagnoses a machine whose sizes are those of the library.
fn diagnose_as_built(request: &Request, pool: &dyn Pool) -> Result<Diagnosis, Error> {
    let Request { base, control, contradiction, recordings } = request;
    check(base, recordings, control)?;
    pool.progress("examining", 0, 1);
    let examined = find_instrument_faults(base, control, recordings);
    let foreign = match contradiction {
        Contradiction::PlayBack => foreign_controls(base, control, &examined.recordings),
        Contradiction::Ignore => Vec::new(),
    };
    let control = if foreign.is_empty() { control.clone() } else { ReplayLoop::Open };
    let (heard, remarks) = drop_unknown_heave(examined.recordings);
    let mut found = diagnose_of(Sizes::TYPICAL, base, control, &heard, pool)?.with_faults(&examined.faults);
    found.answer.remarks.splice(0..0, foreign.into_iter().chain(remarks));
    Ok(found)
}

/// Returns a remark on each recording whose control is not what the loop's controller makes of its readings.
fn foreign_controls(
    base: &Parameters,
    control: &ReplayLoop,
    recordings: &[Recording],
) -> Vec<RecordingRemark> {
    let remark = |recording: &Recording| {
        let mismatch = check_control(base, recording, control)?;
        Some(RecordingRemark::OtherController { recording: recording.name.clone(), mismatch })
    };
    recordings.iter().filter_map(remark).collect()
}

/// Diagnoses a dynamically similar machine of the library's sizes, and brings the answer back to the machine itself.
fn diagnose_scaled(
    scale: SimilarityScale,
    base: &Parameters,
    control: ReplayLoop,
    recordings: &[Recording],
    pool: &dyn Pool,
) -> Result<Diagnosis, Error> {
    let (scaled, measured) = (scale.apply_to(base), base.sensors.measured);
    let resized: Vec<Recording> = recordings.iter().map(|r| scale.recording(r, measured)).collect();
    let control = scale.replayed_loop(control, measured);
    let sizes = scale.sizes().with_rates_of(&resized, measured).with_motor_of(base);
    let mut found = diagnose_of(sizes, &scaled, control, &resized, pool)?;
    found.recordings = recordings.to_vec();
    scale.bring_back(&mut found.answer, &scaled);
    found.improved = scale.inverse().apply_to(&found.improved);
    Ok(found)
}

/// Diagnoses a machine of given sizes from recordings without instrument faults.
fn diagnose_of(
    sizes: Sizes,
    base: &Parameters,
    control: ReplayLoop,
    recordings: &[Recording],
    pool: &dyn Pool,
) -> Result<Diagnosis, Error> {
    check(base, recordings, &control)?;
    pool.progress("checking", 0, 1);
    let (mut sound, mut remarks) = check_recordings(base, recordings)?;
    let most = match sizes.typical {
        true => SAMPLES_AT_MOST,
        false => textbook_samples(base, &control, &sound, pool),
    };
    shorten(&mut sound, most, &mut remarks);
    let examined = recordings;
    let recordings = sound.as_slice();
    let project = base;
    let base = &with_recorded_noise(project, recordings);
    let prepared = PreparedRecordings::new(recordings, base);
    let simulator = RecordingReplays::new(base, &control, &prepared)?;
    let simulator = if sizes.typical { simulator } else { simulator.with_stated_noise(project) };
    let simulator = with_steps_enough(simulator, base, pool);
    let has = |column: fn(&Recording) -> bool| recordings.iter().all(column);
    let redundant = RedundantSensors {
        motor_rate: has(|r| r.has(Channel::MotorRate)),
        hub_position: has(|r| r.has(Channel::HubPosition)),
    };
    let isolability = balances_of(base, redundant);
    let localisation = locate_error(base, &simulator, &isolability, pool);
    let mut seeds = seeds(base, recordings);
    seeds.extend(biases(base, recordings));
    let mut effects = effects_for(sizes, base);
    effects.retain(|effect| can_show(base, recordings, effect));
    let searcher = Searcher { simulator: &simulator, pool, base, effects, seeds, sizes };
    let search = searcher.search();
    if pool.is_cancelled() {
        return Err(Error::Cancelled);
    }
    let search = search.ok_or(Error::NotSimulated)?;
    let evidence = VerdictEvidence {
        simulator: &simulator,
        base,
        search: &search,
        map: localisation,
        isolability,
        remarks,
        sizes,
    };
    let Explanation { answer, improved } = explain(&searcher, evidence);
    let improved = with_noise_levels_of(improved, project);
    Ok(Diagnosis { answer, improved, recordings: examined.to_vec(), control })
}

/// Returns the replays with a bound on their steps that the mechanism as the project file has it keeps.
fn with_steps_enough<'a>(
    simulator: RecordingReplays<'a>,
    base: &Parameters,
    pool: &dyn Pool,
) -> RecordingReplays<'a> {
    let judged = map(pool, simulator.count(), |index| simulator.assess(base, index).is_some());
    match judged.contains(&false) {
        true => simulator.with_step_bound(STIFF_STEPS_PER_SAMPLE),
        false => simulator,
    }
}

/// Locates the residuals of the replay of the model as it was: component by regime.
fn locate_error(
    base: &Parameters,
    simulator: &RecordingReplays,
    isolability: &[BalanceVisibility],
    pool: &dyn Pool,
) -> Vec<MapCell> {
    let replayed = map(pool, simulator.count(), |index| {
        let (measured, assessment) = (simulator.signals_of(index)?, simulator.assess(base, index)?);
        Some(AssessedReplay { measured, assessment })
    });
    localise_errors(base, &replayed.into_iter().flatten().collect::<Vec<_>>(), isolability, pool)
}

/// Returns the balances of a machine that recorded columns allow, each with the components that the machine has.
fn balances_of(base: &Parameters, recorded: RedundantSensors) -> Vec<BalanceVisibility> {
    let mut all = list_balances(usable_sensors(base, recorded));
    all.iter_mut().for_each(|row| row.sees.retain(|component| has_component(base, *component)));
    all
}

/// Returns the effects that a machine of given sizes may have.
fn effects_for(sizes: Sizes, base: &Parameters) -> Vec<&'static Effect> {
    let mut effects = list_effects();
    effects.retain(|effect| can_have(base, effect));
    if !sizes.typical {
        // a textbook leaves friction out: there it has a scale of its own, and is no change of the model's own level
        effects.retain(|e| e.effect != EffectName::Coulomb);
        let tied = sizes.one_motor_constant && base.motor.back_emf_v_s_rad > 0.0;
        effects.retain(|e| !(tied && e.effect == EffectName::TorqueConstant));
        let own = list_textbook_effects().into_iter().filter(|effect| can_have_textbook(base, effect));
        effects.extend(own.filter(|e| tied || e.effect != EffectName::TorqueConstant));
        // a drive that is written as a source of current has neither: its resistance would stand for the torque constant
        let winding = [EffectName::BackEmf, EffectName::Resistance];
        effects.retain(|e| base.motor.back_emf_v_s_rad > 0.0 || !winding.contains(&e.effect));
    }
    effects
}

/// Returns the biases of both gyroscopes as starting points if the kinematics show that one of them has a bias: a loop that holds a
/// biased rate moves from the first sample on, and the signature of a small bias does not show that.
fn biases(base: &Parameters, recordings: &[Recording]) -> Vec<(&'static Effect, Vec<f64>)> {
    if base.sensors.measured != FeedbackSignal::HubRate {
        return Vec::new();
    }
    let each: Vec<f64> = recordings.iter().filter_map(|r| rate_error(r, base.gearbox.ratio)).collect();
    let mean = each.iter().sum::<f64>() / each.len().max(1) as f64;
    if mean.abs() < BIAS_SEEN_RAD_S {
        return Vec::new();
    }
    let (hub, platform) = (
        find_effects(Component::HubGyro, EffectName::Bias),
        find_effects(Component::PlatformGyro, EffectName::Bias),
    );
    let hub = hub.map(|e| (e, vec![base.sensors.hub_gyro.bias + mean]));
    hub.chain(platform.map(|e| (e, vec![base.sensors.platform_gyro.bias - mean])))
        .filter(|(effect, _)| can_have(base, effect))
        .collect()
}

/// Returns the mean of the gyroscopes' rate of the hub on the platform, less that of motor or resolver, rad/s.
fn rate_error(recording: &Recording, ratio: f64) -> Option<f64> {
    let mean = |series: &[f64]| series.iter().sum::<f64>() / series.len().max(1) as f64;
    let hub = mean(recording.samples(Channel::HubRate)?);
    let platform = recording.samples(Channel::PlatformRate).map_or(0.0, mean);
    let known = match (recording.samples(Channel::MotorRate), recording.samples(Channel::HubPosition)) {
        (Some(motor), _) => mean(motor) / ratio,
        (None, Some([first, .., last])) => {
            (last - first) / ((recording.len() - 1) as f64 * recording.sample_period_s)
        }
        _ => return None,
    };
    Some(hub - platform - known).filter(|error| error.is_finite())
}

/// Returns the amplifier's curve that the triangle-wave method finds, as a starting point: no fit converges to it from a distance.
fn seeds(base: &Parameters, recordings: &[Recording]) -> Vec<(&'static Effect, Vec<f64>)> {
    let Ok(found) = identify(base, &[recordings]) else { return Vec::new() };
    match found.amplifier {
        IdentifiedAmplifier::Curve { .. } => {
            vec![(make_free_gain_curve(), make_free_gain_curve().values(&apply_identified(base, &found)))]
        }
        _ => Vec::new(),
    }
}

fn check(base: &Parameters, recordings: &[Recording], control: &ReplayLoop) -> Result<(), Error> {
    if recordings.is_empty() {
        return Err(Error::NoRecording);
    }
    for r in recordings {
        let needed = [
            (Channel::Demand, r.has(Channel::Demand) || *control == ReplayLoop::Open),
            (Channel::Control, r.has(Channel::Control)),
            (Channel::HubRate, r.has(Channel::HubRate)),
        ];
        if let Some((channel, _)) = needed.into_iter().find(|(_, present)| !present) {
            return Err(Error::NoChannel {
                controlled: base.controlled_quantity(),
                replays_control: *control == ReplayLoop::Open,
                recording: r.name.clone(),
                channel,
            });
        }
    }
    Ok(())
}

/// Returns the recordings without gaps and without channels that cannot be what they claim, and what was remarked.
fn check_recordings(
    base: &Parameters,
    recordings: &[Recording],
) -> Result<(Vec<Recording>, Vec<RecordingRemark>), Error> {
    let (ratio, measured) = (base.gearbox.ratio, base.sensors.measured);
    let (mut sound, mut told) = (Vec::new(), Vec::new());
    for recording in recordings {
        let repaired = repair_gaps(recording, ratio);
        told.extend(repaired.repairs.into_iter().map(|(part, repair)| RecordingRemark::Repaired {
            recording: recording.name.clone(),
            part,
            repair,
        }));
        for mut part in repaired.parts {
            let remarks = read_signals(&part, measured)
                .map(|m| check_signals(&part.name, &m, ratio))
                .unwrap_or_default();
            for remark in remarks {
                let out = remark.anomaly.is_disqualifying() && left_out(&mut part, remark.channel);
                let comparison = if out { ComparisonState::NotCompared } else { ComparisonState::Compared };
                told.push(RecordingRemark::Checked { remark, comparison });
            }
            sound.push(part);
        }
    }
    if sound.is_empty() {
        return Err(Error::Unusable { remarks: told });
    }
    Ok((sound, told))
}

/// Removes a channel from a recording that can do without it; returns whether it was removed.
fn left_out(recording: &mut Recording, channel: Channel) -> bool {
    let is_redundant = matches!(channel, Channel::MotorRate | Channel::HubPosition);
    is_redundant && recording.remove(channel).is_some()
}
