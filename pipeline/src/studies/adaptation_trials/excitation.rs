//! On what an adaptation is tried: motions of the platform that no window fits, and loads that change.

use counterpoise_simulate::signal::Sine;
use counterpoise_simulate::{FurtherMotion, PlatformMotion, Signal};
use counterpoise_verify::Procedure;
use counterpoise_verify::signals::{RoadClass, RoadDrive, Vehicle, iso_road};
use serde::Serialize;

use crate::PipelineError;

/// Motion of the platform in a trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TrialMotion {
    /// Heave and pitch of the verification, at frequencies of which no window holds whole periods.
    Sines,
    /// The project's road; one of ISO 8608, class C at 8 m/s, without it.
    Road,
    /// Sines of eight frequencies from 0.3 to 5 Hz in heave and in pitch.
    Multisine,
}

/// Load in a trial, and the initial value of the estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TrialLoad {
    /// The design's load, from the right value.
    Nominal,
    /// The design's load, from a value 30 % too low.
    WrongStart,
    /// Thirty percent more from one sample to the next.
    Sudden,
    /// Thirty percent more, in ten steps over half the run.
    Slow,
    /// Thirty percent less from one sample to the next.
    Lower,
    /// Thirty percent more from the start, which is taken away again once it has been learnt.
    Returned,
}

/// Every motion of the platform that is tried.
pub(crate) const MOTIONS: [TrialMotion; 3] = [TrialMotion::Sines, TrialMotion::Road, TrialMotion::Multisine];
/// Every load that is tried.
pub(crate) const LOADS: [TrialLoad; 6] = [
    TrialLoad::Nominal,
    TrialLoad::WrongStart,
    TrialLoad::Sudden,
    TrialLoad::Slow,
    TrialLoad::Lower,
    TrialLoad::Returned,
];
/// Change of the load, and error of a wrong starting value.
pub(super) const CHANGE: f64 = 0.3;
/// Length of a trial, s; its times are no whole number of any period.
const LENGTH_S: f64 = 47.3;
/// Instant at which a slow change ends, s.
const SETTLED_S: f64 = 23.7;
/// Length of the end of a trial in which the hub rate is measured, s.
const MEASURED_END_S: f64 = 16.2;
/// Instant at which a load that returns does so, s.
const RETURN_S: f64 = 15.9;
/// Length of the trial of a load that returns, s: what was learnt before it did is forgotten at its end.
const RETURNED_LENGTH_S: f64 = 79.3;
/// Instant at which the load begins to change, s.
const CHANGE_S: f64 = 7.9;
/// Steps of a slow change.
const SLOW_STEPS: usize = 10;
/// Factors on the frequencies of heave and pitch, away from whole numbers of periods in a window.
const DETUNED: [f64; 2] = [0.887, 1.137];

/// Returns a motion of the platform for the whole trial.
///
/// # Errors
/// A road that cannot be made.
pub(super) fn platform_motion(
    procedure: &Procedure,
    gravity_m_s2: f64,
    motion: TrialMotion,
) -> Result<PlatformMotion, PipelineError> {
    let sine = |sine: &counterpoise_verify::Sine, by: f64| {
        Signal::sine(sine.amplitude, by * std::f64::consts::TAU * sine.frequency_hz)
    };
    let (heave_m_s2, pitch_rate_rad_s) = match motion {
        TrialMotion::Sines => (sine(&procedure.heave, DETUNED[0]), sine(&procedure.pitch, DETUNED[1])),
        TrialMotion::Multisine => {
            (multisine(procedure.heave.amplitude, 0.31), multisine(procedure.pitch.amplitude, 0.37))
        }
        TrialMotion::Road => return road(procedure, gravity_m_s2),
    };
    Ok(PlatformMotion { heave_m_s2, pitch_rate_rad_s, ..PlatformMotion::STILL })
}

/// Returns the road, driven again and again for the whole trial.
fn road(procedure: &Procedure, gravity_m_s2: f64) -> Result<PlatformMotion, PipelineError> {
    let seed = procedure.seed;
    let road = match (&procedure.road, RoadClass::from_letter("C")) {
        (Some(road), _) => road.clone(),
        (None, None) => return Ok(PlatformMotion::STILL),
        (None, Some(class)) => {
            let (speed_m_s, duration_s, sample_period_s, fade_s) = (8.0, 30.0, 0.005, 1.0);
            let drive = RoadDrive { class, speed_m_s, duration_s, sample_period_s, fade_s, seed };
            iso_road(drive, Vehicle::HEAVY, gravity_m_s2)?
        }
    };
    let count = (RETURNED_LENGTH_S / road.sample_period_s) as usize + 2;
    let again = |values: &[f64]| Signal::Samples {
        period_s: road.sample_period_s,
        values: values.iter().copied().cycle().take(count).collect(),
    };
    Ok(PlatformMotion {
        heave_m_s2: again(road.heave_m_s2()),
        pitch_rate_rad_s: again(road.pitch_rate_rad_s()),
        further: road.has_further_motion().then(|| FurtherMotion {
            surge_m_s2: again(road.surge_m_s2()),
            roll_rate_rad_s: again(road.roll_rate_rad_s()),
            yaw_rate_rad_s: again(road.yaw_rate_rad_s()),
        }),
        ..PlatformMotion::STILL
    })
}

/// Eight sines from a lowest frequency up, with phases that spread the peaks (M. Schroeder, IEEE Trans. Information Theory 16, 1970).
fn multisine(amplitude: f64, lowest_hz: f64) -> Signal {
    const COUNT: usize = 8;
    let share = amplitude / (COUNT as f64).sqrt();
    let sine = |k: usize| Sine {
        amplitude: share,
        frequency_rad_s: std::f64::consts::TAU * lowest_hz * 1.443f64.powi(k as i32),
        phase_rad: -std::f64::consts::PI * (k * (k + 1)) as f64 / COUNT as f64,
    };
    Signal::Sines((0..COUNT).map(sine).collect())
}

/// A part of a run with a factor on the out-of-balance.
pub(super) struct Part {
    pub from_s: f64,
    pub to_s: f64,
    pub factor: f64,
}

/// Returns from when the hub rate of a run is measured, s.
pub(super) fn measured_from_s(load: TrialLoad) -> f64 {
    load_parts(load).last().map_or(0.0, |part| part.to_s - MEASURED_END_S)
}

/// Returns the parts of a run.
pub(super) fn load_parts(load: TrialLoad) -> Vec<Part> {
    let part = |from_s, to_s, factor| Part { from_s, to_s, factor };
    match load {
        TrialLoad::Nominal | TrialLoad::WrongStart => vec![part(0.0, LENGTH_S, 1.0)],
        TrialLoad::Lower => vec![part(0.0, CHANGE_S, 1.0), part(CHANGE_S, LENGTH_S, 1.0 - CHANGE)],
        TrialLoad::Returned => {
            vec![part(0.0, RETURN_S, 1.0 + CHANGE), part(RETURN_S, RETURNED_LENGTH_S, 1.0)]
        }
        TrialLoad::Sudden => vec![part(0.0, CHANGE_S, 1.0), part(CHANGE_S, LENGTH_S, 1.0 + CHANGE)],
        TrialLoad::Slow => {
            let step_s = (SETTLED_S - CHANGE_S) / SLOW_STEPS as f64;
            let at = |k: usize| CHANGE_S + step_s * k as f64;
            let changed = |k: usize| {
                let end_s = if k == SLOW_STEPS { LENGTH_S } else { at(k) };
                part(at(k - 1), end_s, 1.0 + CHANGE * k as f64 / SLOW_STEPS as f64)
            };
            std::iter::once(part(0.0, CHANGE_S, 1.0)).chain((1..=SLOW_STEPS).map(changed)).collect()
        }
    }
}

/// Returns the motion from a time on.
pub(super) fn motion_from(platform: &PlatformMotion, from_s: f64, initial_angle_rad: f64) -> PlatformMotion {
    let later = |signal: &Signal| match signal {
        Signal::Sines(sines) => {
            let shift = |s: &Sine| Sine { phase_rad: s.phase_rad + s.frequency_rad_s * from_s, ..*s };
            Signal::Sines(sines.iter().map(shift).collect())
        }
        Signal::Samples { period_s, values } => {
            let first = ((from_s / period_s).round() as usize).min(values.len().saturating_sub(1));
            Signal::Samples { period_s: *period_s, values: values[first..].to_vec() }
        }
        other => other.clone(),
    };
    PlatformMotion {
        heave_m_s2: later(&platform.heave_m_s2),
        pitch_rate_rad_s: later(&platform.pitch_rate_rad_s),
        initial_angle_rad,
        further: platform.further.as_ref().map(|further| FurtherMotion {
            surge_m_s2: later(&further.surge_m_s2),
            roll_rate_rad_s: later(&further.roll_rate_rad_s),
            yaw_rate_rad_s: later(&further.yaw_rate_rad_s),
        }),
    }
}
