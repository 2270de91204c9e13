//! The whole road of a diagnosis.

use counterpoise_models::Parameters;
use counterpoise_simulate::recording::Recording;
use counterpoise_simulate::replay::Loop;

use crate::answer::Answer;
use crate::bench::Pool;
use crate::error::Error;
use crate::identify::{Amplifier, identify, improved};
use crate::judge::Evidence;
use crate::library::{Effect, free_curve, library};
use crate::locate::{isolability, regime_map};
use crate::qualify::qualify;
use crate::replays::{Prepared, Replays, measured};
use crate::select::Searcher;

/// What a diagnosis gives: the answer, and the machine that explains the recordings.
#[derive(Debug, Clone)]
pub struct Diagnosis {
    /// The answer.
    pub answer: Answer,
    /// The mechanism with the named effects; as it was where there is none.
    pub improved: Parameters,
}

/// Diagnoses a machine from its recordings: in closed loop with the controller that was in the loop, or under the
/// recorded control where it is not known ([`Loop::Open`]).
///
/// # Errors
/// No recording, a channel that is missing, a recording that does not fit the project's clock, a mechanism that cannot
/// be simulated; [`Error::Cancelled`] where the pool was asked to stop.
pub fn diagnose(
    base: &Parameters,
    control: impl Into<Loop>,
    recordings: &[Recording],
    pool: &dyn Pool,
) -> Result<Diagnosis, Error> {
    let control = control.into();
    check(recordings, &control)?;
    pool.progress("qualifying", 0, 1);
    let qualification = remarks(base, recordings);
    let prepared = Prepared::new(recordings, base);
    let bench = Replays::new(base, &control, &prepared)?;
    let has = |column: fn(&Recording) -> bool| recordings.iter().all(column);
    let isolability =
        isolability(has(|r| r.motor_rate_rad_s.is_some()), has(|r| r.hub_position_rad.is_some()));
    let map = regime_map(base, &bench.measured());
    let seeds = seeds(base, recordings);
    let searcher = Searcher { bench: &bench, pool, base, effects: library(), seeds };
    let search = searcher.search();
    if pool.cancelled() {
        return Err(Error::Cancelled);
    }
    let search = search.ok_or(Error::NotSimulated)?;
    let evidence = Evidence { bench: &bench, base, search: &search, map, isolability, qualification };
    let improved = evidence.improved();
    Ok(Diagnosis { answer: evidence.answer(), improved })
}

/// What the triangle-wave method finds of the amplifier's curve, as a start: from a distance no fit would get there.
fn seeds(base: &Parameters, recordings: &[Recording]) -> Vec<(&'static Effect, Vec<f64>)> {
    let Ok(found) = identify(base, &[recordings]) else { return Vec::new() };
    match found.amplifier {
        Amplifier::Curve { .. } => vec![(free_curve(), free_curve().values(&improved(base, &found)))],
        _ => Vec::new(),
    }
}

fn check(recordings: &[Recording], control: &Loop) -> Result<(), Error> {
    if recordings.is_empty() {
        return Err(Error::NoRecording);
    }
    for r in recordings {
        let needed = [
            ("demand", r.demand_rad_s.is_some() || *control == Loop::Open),
            ("control", r.control_v.is_some()),
            ("hub_rate", r.hub_rate_rad_s.is_some()),
        ];
        if let Some((channel, _)) = needed.into_iter().find(|(_, present)| !present) {
            return Err(Error::NoChannel { recording: r.name.clone(), channel });
        }
    }
    Ok(())
}

fn remarks(base: &Parameters, recordings: &[Recording]) -> Vec<String> {
    let of =
        |r: &Recording| measured(r).map(|m| qualify(&r.name, &m, base.gearbox.ratio)).unwrap_or_default();
    let remarks = recordings.iter().flat_map(of);
    remarks.map(|r| format!("{}: {}: {}", r.recording, r.channel, r.what)).collect()
}
