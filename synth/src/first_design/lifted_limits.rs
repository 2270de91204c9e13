//! The limits of a bandwidth: the limits are lifted one by one, and the loop is looked for again above the answer.
//!
//! A limit that is a rule (noise, quantisation, the control's limit, the sample rate, what was asked for) is lifted by leaving the
//! rule out: candidates count that miss it and no other. Margins and shifted modes are rules with two possible causes, so the causes
//! are lifted: the structure becomes much stiffer, or sensor and delay become ideal. The rule of the margins alone is
//! left out only if neither explains it: then the lags of the drive or poles and zeros of the plant are the cause.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::{Mutex, OnceLock};

use counterpoise_lti::StateSpace;

use super::candidate::{MORE_PHASE, Shape};
use super::scan::{Candidate, FurtherShapes, PER_DECADE, Scan, TriedFeedback};
use super::{Circumstances, LimitLoops};
use crate::bandwidth::{Bandwidth, BandwidthLimit, LimitKind, Unknown};
use crate::modes::stiffen;
use crate::tolerance::{HIGHER_BANDWIDTH, NEARLY_USED_UP, SHARE_FOR_LIMITS};
use crate::{DesignPlant, Error, Sampling};
use counterpoise_pool::Pool;

/// Aims in a row without a loop at which the climb ends.
const MISSES: usize = 2;
/// Aims above the answer at most: two decades.
const MOST_AIMS: i32 = 2 * PER_DECADE;
/// Halvings between the last aim with a loop and the first without.
const HALVINGS: usize = 3;

/// The candidate of the highest bandwidth among those that miss certain limits and no others.
type HighestFeedbacks = BTreeMap<Vec<u8>, TriedFeedback>;

/// A bandwidth with its limits, and the loops that show them.
pub(super) struct BandwidthWithLoops {
    pub bandwidth: Bandwidth,
    pub shown_by: Vec<LimitLoops>,
}

/// A loop above the answer, and its bandwidth.
#[derive(Clone)]
struct HigherLoop {
    rate_rad_s: f64,
    shown_by: StateSpace,
}

/// Returns the bandwidth of an answer with its limits.
///
/// # Errors
/// Those of the design.
pub(super) fn bandwidth(scan: &mut Scan, found: &TriedFeedback) -> Result<BandwidthWithLoops, Error> {
    let reached = found.judgement.bandwidth_rad_s;
    let limits = scan.summary();
    // One limit at a time is left out: what misses two is not the answer without either.
    scan.judge_up_to(2);
    scan.limit_designs_to(SHARE_FOR_LIMITS);
    let kinds: Vec<LimitKind> = limits.iter().map(|limit| limit.kind).collect();
    let (missed, causes) = search_in_parallel(scan, found, &kinds)?;
    let mut shown = Vec::new();
    for mut limit in limits {
        let lifted = match limit.kind {
            LimitKind::Resonance => causes.structure.clone(),
            LimitKind::Margins if causes.structure.is_some() || causes.lags.is_some() => causes.lags.clone(),
            kind => higher_loop(scan, missed.get(&vec![kind as u8]), reached)?,
        };
        limit.lifted_rad_s = lifted.as_ref().map(|loop_| loop_.rate_rad_s);
        let loops = LimitLoops {
            allowed: scan.demonstrate_limit(&limit)?,
            lifted: lifted.map(|loop_| loop_.shown_by),
        };
        shown.push((limit, loops));
    }
    let size = |rate: Option<f64>| rate.unwrap_or(0.0);
    shown.sort_by(|(a, _), (b, _)| {
        let lifted = size(b.lifted_rad_s).total_cmp(&size(a.lifted_rad_s));
        lifted
            .then(size(b.used).total_cmp(&size(a.used)))
            .then(a.bandwidth_rad_s.total_cmp(&b.bandwidth_rad_s))
    });
    let (limits, shown_by): (Vec<_>, Vec<_>) = shown.into_iter().unzip();
    let first = limits.first().filter(|limit| limit.lifted_rad_s.is_some()).map(|limit| vec![limit.kind]);
    let limited_by = first.unwrap_or_else(|| limits_together(scan, &limits));
    let bandwidth = Bandwidth {
        bandwidth_rad_s: reached,
        limited_by,
        limits,
        unknown: scan.unknown.clone(),
        asked_rad_s: scan.circumstances.asked_rad_s,
    };
    Ok(BandwidthWithLoops { bandwidth, shown_by })
}

/// Returns a candidate with its loop if its bandwidth is higher than what is reached.
fn higher_loop(
    scan: &Scan,
    tried: Option<&TriedFeedback>,
    reached_rad_s: f64,
) -> Result<Option<HigherLoop>, Error> {
    match tried {
        Some(tried) if tried.judgement.bandwidth_rad_s > reached_rad_s * (1.0 + HIGHER_BANDWIDTH) => {
            let rate_rad_s = tried.judgement.bandwidth_rad_s;
            Ok(Some(HigherLoop { rate_rad_s, shown_by: scan.nominal_loop(tried)? }))
        }
        _ => Ok(None),
    }
}

/// The limits of a bandwidth that lifting one alone does not raise: those of which the loop uses up nearly all, or else those beyond which no loop was seen to keep
/// them, or else the fewest that only together keep the loops that were seen from being the answer.
fn limits_together(scan: &Scan, limits: &[BandwidthLimit]) -> Vec<LimitKind> {
    let kinds = |is_one: &dyn Fn(&BandwidthLimit) -> bool| -> Vec<LimitKind> {
        limits.iter().filter(|limit| is_one(limit)).map(|limit| limit.kind).collect()
    };
    let used_up = kinds(&|limit| limit.used.is_some_and(|used| used >= NEARLY_USED_UP));
    if !used_up.is_empty() {
        return used_up;
    }
    let allowed = (1.0 + HIGHER_BANDWIDTH) * scan.best_bandwidth();
    let lowest = kinds(&|limit| limit.bandwidth_rad_s <= allowed);
    let together = if lowest.is_empty() { scan.joint_limits() } else { lowest };
    // Nothing above the answer is a stable loop.
    if together.is_empty() { vec![LimitKind::Margins] } else { together }
}

/// The loop with a cause of phase lag lifted; `None` if its bandwidth is no higher or there is no such cause.
struct Causes {
    structure: Option<HigherLoop>,
    lags: Option<HigherLoop>,
}

/// Looks for the bandwidths without each limit, and those with each cause of phase lag lifted: three searches that know nothing of each other.
fn search_in_parallel(
    scan: &mut Scan,
    found: &TriedFeedback,
    kinds: &[LimitKind],
) -> Result<(HighestFeedbacks, Causes), Error> {
    let given = SharedSearch::of(scan);
    let pool = scan.pool;
    let (limits, structure, lags) = (OnceLock::new(), OnceLock::new(), OnceLock::new());
    let searched = Mutex::new(scan);
    let climb_limits = || match searched.lock() {
        Ok(mut scan) => climb_all(&mut scan, found.aim_rad_s, kinds),
        Err(poisoned) => climb_all(&mut poisoned.into_inner(), found.aim_rad_s, kinds),
    };
    pool.run(3, &|part| match part {
        0 => drop(limits.set(climb_limits())),
        1 => drop(structure.set(given.without_modes(found))),
        _ => drop(lags.set(given.without_lags(found))),
    });
    let structure = structure.into_inner().unwrap_or_else(|| given.without_modes(found))?;
    let lags = lags.into_inner().unwrap_or_else(|| given.without_lags(found))?;
    let missed = limits.into_inner().unwrap_or_else(climb_limits)?;
    Ok((missed, Causes { structure, lags }))
}

/// The data that the searches in other circumstances take from that in the given ones.
struct SharedSearch<'a> {
    circumstances: &'a Circumstances,
    unknown: Vec<Unknown>,
    shapes: Vec<Shape>,
    further_shapes: FurtherShapes,
    pool: &'a dyn Pool,
}

impl<'a> SharedSearch<'a> {
    fn of(scan: &Scan<'a>) -> Self {
        let Scan { circumstances, further_shapes, pool, .. } = *scan;
        let (unknown, shapes) = (scan.unknown.clone(), scan.shapes.clone());
        Self { circumstances, unknown, shapes, further_shapes, pool }
    }

    /// The bandwidth with a much stiffer structure; `None` if it is no higher or there is no mode to stiffen.
    fn without_modes(&self, found: &TriedFeedback) -> Result<Option<HigherLoop>, Error> {
        let reached = found.judgement.bandwidth_rad_s;
        let stiff = with_plants(self.circumstances, |plant| stiffen(plant, reached))?;
        if stiff == *self.circumstances { Ok(None) } else { self.loop_above(&stiff, found) }
    }

    /// The bandwidth with an ideal sensor and no delay; `None` if it is no higher or they are so already.
    fn without_lags(&self, found: &TriedFeedback) -> Result<Option<HigherLoop>, Error> {
        let mut quick = with_plants(self.circumstances, |plant| Ok(without_lags(plant)))?;
        quick.sampling = Sampling { delay_samples: 0, ..quick.sampling };
        if quick == *self.circumstances { Ok(None) } else { self.loop_above(&quick, found) }
    }

    /// The highest bandwidth above an answer in other circumstances, where the same is known as in the given ones.
    fn loop_above(&self, other: &Circumstances, found: &TriedFeedback) -> Result<Option<HigherLoop>, Error> {
        let mut lifted = Scan::new(other, self.pool)?;
        lifted.unknown.clone_from(&self.unknown);
        lifted.adopt_shapes(&self.shapes, self.further_shapes);
        lifted.judge_up_to(1);
        lifted.limit_designs_to(SHARE_FOR_LIMITS);
        let highest = climb_all(&mut lifted, found.aim_rad_s, &[])?;
        higher_loop(&lifted, highest.get(&Vec::new()), found.judgement.bandwidth_rad_s)
    }
}

/// The circumstances with the plants changed; those within tolerances stay, for their limit is one of its own.
fn with_plants(
    given: &Circumstances,
    change: impl Fn(&DesignPlant) -> Result<DesignPlant, Error>,
) -> Result<Circumstances, Error> {
    let all = |plants: &[DesignPlant]| plants.iter().map(&change).collect::<Result<Vec<_>, _>>();
    Ok(Circumstances { plant: change(&given.plant)?, others: all(&given.others)?, ..given.clone() })
}

/// The plant without the delay and the lag of its sensor; the lag of a cascade's difference quotient belongs to the sampling and stays.
fn without_lags(plant: &DesignPlant) -> DesignPlant {
    let mut quick = DesignPlant { delay_s: 0.0, hub_sensor: None, late_reading: None, ..plant.clone() };
    if let Some(inner) = &mut quick.rate_loop {
        inner.plant.delay_s = 0.0;
    }
    quick
}

/// Climbs from an aim once for the candidates that keep everything and once for each limit that may be left out.
fn climb_all(scan: &mut Scan, aim_rad_s: f64, kinds: &[LimitKind]) -> Result<HighestFeedbacks, Error> {
    let mut highest = HighestFeedbacks::new();
    if kinds.is_empty() {
        climb(scan, aim_rad_s, &[], &mut highest)?;
    }
    for kind in kinds {
        climb(scan, aim_rad_s, &[*kind], &mut highest)?;
    }
    Ok(highest)
}

/// Climbs as long as there are candidates that keep every limit but those that are left out.
fn climb(
    scan: &mut Scan,
    from: f64,
    left_out: &[LimitKind],
    highest: &mut HighestFeedbacks,
) -> Result<(), Error> {
    let step = |k: i32| from * 10f64.powf(f64::from(k) / f64::from(PER_DECADE));
    let (mut low, mut high, mut misses) = (from, None, 0);
    let top = scan.highest_aim();
    let aims: Vec<f64> = (1..=MOST_AIMS).map(step).take_while(|aim| *aim <= top).collect();
    for (k, &aim) in aims.iter().enumerate() {
        if has_loop(scan, &aims[k..], left_out, highest)? {
            (low, high, misses) = (aim, None, 0);
            continue;
        }
        high = high.or(Some(aim));
        misses += 1;
        if misses == MISSES {
            break;
        }
    }
    let Some(mut high) = high else { return Ok(()) };
    for _ in 0..HALVINGS {
        let middle = (low * high).sqrt();
        if has_loop(scan, &[middle], left_out, highest)? {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(())
}

/// Returns whether some shape keeps every limit but those that are left out at the first of the aims of a climb.
fn has_loop(
    scan: &mut Scan,
    aims: &[f64],
    left_out: &[LimitKind],
    highest: &mut HighestFeedbacks,
) -> Result<bool, Error> {
    let Some(&aim) = aims.first().filter(|_| scan.may_design_more()) else { return Ok(false) };
    let usual = |aim: &f64| {
        let aim_rad_s = *aim;
        (0..MORE_PHASE).map(move |shape| Candidate { aim_rad_s, shape })
    };
    for shape in scan.shapes_to_climb() {
        if shape < MORE_PHASE {
            scan.look_ahead(aims.iter().flat_map(usual).skip(shape));
        }
        let Some(tried) = scan.attempt_if_worthwhile(aim, shape)? else { continue };
        let missed = scan.missed_limits(&tried.judgement);
        let keeps_the_rest = missed.iter().all(|kind| left_out.contains(kind));
        let known = highest.entry(missed.iter().map(|kind| *kind as u8).collect());
        let rate = tried.judgement.bandwidth_rad_s;
        match known {
            Entry::Occupied(known) if known.get().judgement.bandwidth_rad_s >= rate => {}
            Entry::Occupied(mut known) => drop(known.insert(tried)),
            Entry::Vacant(place) => {
                place.insert(tried);
            }
        }
        if keeps_the_rest {
            return Ok(true);
        }
    }
    Ok(false)
}
