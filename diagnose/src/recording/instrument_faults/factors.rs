//! Detection of a column that is written with a wrong factor, or of two that are exchanged: the smallest mistake after which every identity of
//! every recording holds.

use crate::tolerance::recording::{
    BROKEN_IDENTITY_AT_MOST, CONTROLLER_IDENTITY_MULTIPLE, EQUIVALENT_EXPLANATIONS, EXCHANGE_REMAINDER,
    FACTOR_DOUBT, GYROSCOPE_GAINS, KINEMATIC_REMAINDER,
};
use counterpoise_models::Parameters;
use counterpoise_recordings::Recording;
use counterpoise_simulate::replay::ReplayLoop;

use super::column::RecorderColumn;
use super::fault::{intended_factor, is_known};
use super::identities::{Identity, Ratio, list_identities};

/// A mistake in writing the columns.
#[derive(Debug, Clone)]
pub(super) enum Mistake {
    /// Written = gain x true, relative doubt.
    Scale { column: RecorderColumn, gain: f64, doubt: f64 },
    /// In each other's place.
    Exchange { one: RecorderColumn, other: RecorderColumn },
}

/// A mistake with the recordings that have it, and the columns that could have made it instead.
#[derive(Debug, Clone)]
pub(super) struct FoundMistake {
    pub mistake: Mistake,
    pub recordings: Vec<usize>,
    pub or: Vec<RecorderColumn>,
}

/// The origin of a factor: a column as it was written, or the hub's gyroscope itself, which the controller reads.
#[derive(Debug, Clone, Copy, PartialEq)]
enum FactorOrigin {
    Written(RecorderColumn),
    HubGyro,
}

/// The identities of every recording.
type Table = Vec<Vec<Identity>>;

/// The identities of every recording.
fn table_of(base: &Parameters, control: &ReplayLoop, recordings: &[Recording]) -> Table {
    recordings.iter().map(|r| list_identities(base, control, r)).collect()
}

/// Returns the mistake that explains what is wrong; `None` if nothing is wrong, if it may be a gyroscope's own gain, or if no
/// single mistake explains it.
pub(super) fn find_mistake(
    base: &Parameters,
    control: &ReplayLoop,
    recordings: &[Recording],
) -> Option<FoundMistake> {
    let table = table_of(base, control, recordings);
    let bad: Vec<usize> = (0..table.len()).filter(|r| !holds(&table[*r])).collect();
    if bad.is_empty() || own_gain(&table) {
        return None;
    }
    let whole = |found: &FoundMistake| {
        let cured: Vec<Recording> = correct_mistake(recordings, found);
        found
            .recordings
            .iter()
            .map(|r| total_violation(&list_identities(base, control, &cured[*r])))
            .sum::<f64>()
    };
    let heard = |found: &FoundMistake| {
        let after = correct_mistake(recordings, found);
        let exact = |r: &usize| list_identities(base, control, &after[*r]).iter().all(|i| is_exact(i, base));
        !needs_exactness(found) || found.recordings.iter().all(exact)
    };
    let scales = RecorderColumn::ALL
        .into_iter()
        .filter_map(|column| find_scale_mistake(&table, column, &bad))
        .filter(heard);
    let exchanges = pairs(&recordings[bad[0]]).into_iter().filter_map(|(one, other)| {
        let all = (0..recordings.len()).collect();
        let found =
            FoundMistake { mistake: Mistake::Exchange { one, other }, recordings: all, or: Vec::new() };
        let after = table_of(base, control, &correct_mistake(recordings, &found));
        let better = |r: &usize| is_better(&table[*r], &after[*r]);
        let everywhere = (0..after.len()).all(|r| better(&r) || (!bad.contains(&r) && holds(&after[r])));
        let recordings = (0..after.len()).filter(|r| everywhere || better(r)).collect();
        bad.iter().all(better).then_some(FoundMistake { recordings, ..found })
    });
    let mut all: Vec<(f64, FoundMistake)> =
        scales.chain(exchanges).map(|found| (whole(&found), found)).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (least, best) = all.first()?.clone();
    let alike = all[1..]
        .iter()
        .filter(|(left, _)| *left < EQUIVALENT_EXPLANATIONS.0 * least + EQUIVALENT_EXPLANATIONS.1);
    let or = alike.filter_map(|(_, found)| match found.mistake {
        Mistake::Scale { column, .. } => Some(column),
        Mistake::Exchange { .. } => None,
    });
    Some(FoundMistake { or: or.collect(), ..best })
}

/// Returns whether an exchange makes the identities of a recording hold that did not, or makes them computable at all.
fn is_better(before: &[Identity], after: &[Identity]) -> bool {
    let holding = after.iter().all(|i| i.broken < EXCHANGE_REMAINDER.1);
    let is_repaired =
        !holds(before) && total_violation(after) < EXCHANGE_REMAINDER.0 * total_violation(before);
    holding && (after.len() > before.len() || (after.len() == before.len() && is_repaired))
}

/// Returns the recordings without the mistake.
pub(super) fn correct_mistake(recordings: &[Recording], found: &FoundMistake) -> Vec<Recording> {
    let mut out = recordings.to_vec();
    for &r in &found.recordings {
        match found.mistake {
            Mistake::Scale { column, gain, .. } => {
                if let Some(series) = column.of_mut(&mut out[r]) {
                    series.iter_mut().for_each(|v| *v /= gain);
                }
            }
            Mistake::Exchange { one, other } => {
                let [first, second] = [one, other].map(|column| out[r].remove(column.channel()));
                first.and_then(|series| out[r].set(other.channel(), series));
                second.and_then(|series| out[r].set(one.channel(), series));
            }
        }
    }
    out
}

fn total_violation(identities: &[Identity]) -> f64 {
    identities.iter().map(|i| i.broken.min(BROKEN_IDENTITY_AT_MOST)).sum()
}

fn ratios(identities: &[Identity]) -> impl Iterator<Item = &Ratio> {
    identities.iter().flat_map(|i| &i.ratios)
}

/// Returns whether every factor is one within its uncertainty, and the exact identities explain most of what they should.
fn holds(identities: &[Identity]) -> bool {
    let exact = |i: &Identity| i.of == RecorderColumn::MotorRate || i.broken < EXCHANGE_REMAINDER.1;
    identities.iter().all(exact) && ratios(identities).all(|ratio| agrees(ratio, 1.0))
}

fn agrees(ratio: &Ratio, expected: f64) -> bool {
    (ratio.value / expected - 1.0).abs() <= ratio.doubt
}

/// Returns whether the controller's identity must hold to the converter's noise for a mistake to be believed: a factor near one on
/// what the controller reads or writes looks like a late column.
fn needs_exactness(found: &FoundMistake) -> bool {
    let heard = [RecorderColumn::Demand, RecorderColumn::Control, RecorderColumn::HubRate];
    matches!(found.mistake, Mistake::Scale { column, gain, .. } if heard.contains(&column) && !is_known(gain))
}

fn is_exact(identity: &Identity, base: &Parameters) -> bool {
    let noise = RecorderColumn::Control.converter_step(base).unwrap_or(0.0) / 12f64.sqrt();
    identity.of != RecorderColumn::Control || identity.left < CONTROLLER_IDENTITY_MULTIPLE * noise
}

/// Returns how a origin's gain shows in a ratio: 1 above, -1 below, 0 not at all.
fn share(ratio: &Ratio, origin: FactorOrigin) -> i32 {
    let is = |column: RecorderColumn| match origin {
        FactorOrigin::Written(c) => c == column,
        FactorOrigin::HubGyro => column == RecorderColumn::HubRate && ratio.above != RecorderColumn::Control,
    };
    i32::from(is(ratio.above)) - i32::from(is(ratio.below))
}

/// The gain that a origin must have in a recording, with its doubt: from the surest ratio.
fn gain(identities: &[Identity], origin: FactorOrigin) -> Option<(f64, f64)> {
    let telling = ratios(identities).filter(|r| share(r, origin) != 0 && r.doubt < FACTOR_DOUBT);
    let surest = telling.min_by(|a, b| a.doubt.total_cmp(&b.doubt))?;
    Some((surest.value.powi(share(surest, origin)), surest.doubt))
}

fn explains(identities: &[Identity], origin: FactorOrigin, gain: f64) -> bool {
    ratios(identities).all(|ratio| agrees(ratio, gain.powi(share(ratio, origin))))
}

/// Returns whether a gain of one of the gyroscopes themselves, within what the library covers, explains everything.
fn own_gain(table: &[Vec<Identity>]) -> bool {
    let origins = [FactorOrigin::HubGyro, FactorOrigin::Written(RecorderColumn::PlatformRate)];
    origins.into_iter().any(|origin| {
        let surest = table.iter().filter_map(|ids| gain(ids, origin)).min_by(|a, b| a.1.total_cmp(&b.1));
        surest.is_some_and(|(gain, _)| {
            (GYROSCOPE_GAINS.0..GYROSCOPE_GAINS.1).contains(&gain)
                && table.iter().all(|ids| explains(ids, origin, gain))
        })
    })
}

/// Returns the factor of one column that explains every recording in which something is wrong.
fn find_scale_mistake(
    table: &[Vec<Identity>],
    column: RecorderColumn,
    bad: &[usize],
) -> Option<FoundMistake> {
    let origin = FactorOrigin::Written(column);
    let mut gains = Vec::new();
    for &r in bad {
        let (found, doubt) = gain(&table[r], origin)?;
        let found = intended_factor(found, doubt);
        if !is_known(found) && !has_kinematics(&table[r]) {
            return None;
        }
        gains.push((found, doubt));
        explains(&table[r], origin, found).then_some(())?;
    }
    let (gain, doubt) = gains.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let good = |r: &usize| !bad.contains(r);
    let sound = (0..table.len()).filter(good).any(|r| !explains(&table[r], origin, gain));
    let recordings = if sound { bad.to_vec() } else { (0..table.len()).collect() };
    Some(FoundMistake { mistake: Mistake::Scale { column, gain, doubt }, recordings, or: Vec::new() })
}

/// Returns whether the kinematics of a recording hold at all, with whatever factors: an elastic drive between two sensors, or a motion that
/// no sensor shows, leaves much of a rate, and what looks like a factor is then none.
fn has_kinematics(identities: &[Identity]) -> bool {
    let kinematic = identities.iter().filter(|i| i.of != RecorderColumn::Control);
    kinematic.into_iter().all(|i| i.share < KINEMATIC_REMAINDER)
}

fn pairs(recording: &Recording) -> Vec<(RecorderColumn, RecorderColumn)> {
    let there: Vec<RecorderColumn> =
        RecorderColumn::ALL.into_iter().filter(|c| c.of(recording).is_some()).collect();
    let sensor = |column: &RecorderColumn| RecorderColumn::SENSORS.contains(column);
    let after = |(k, one): (usize, &RecorderColumn)| {
        let ordered = |other: &RecorderColumn| {
            if sensor(one) || !sensor(other) { (*one, *other) } else { (*other, *one) }
        };
        there[k + 1..].iter().map(ordered).collect::<Vec<_>>()
    };
    there.iter().enumerate().flat_map(after).collect()
}
