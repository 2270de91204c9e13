//! Domination between points of several costs: ranks, distances, and the choice of few points that stand for many.
//!
//! Ranks and crowding distances are those of NSGA-II (Deb, Pratap, Agarwal and Meyarivan, IEEE Transactions on Evolutionary Computation 6, 2002,
//! page 182); a point that misses a limit comes after all that keep it, by how much it misses. The choice of few points removes the closest neighbours
//! (SPEA2: Zitzler, Laumanns and Thiele, TIK report 103, 2001).

use std::cmp::Ordering;

/// Returns whether costs are nowhere more and somewhere less than others. A cost that is not a number dominates nothing.
pub fn dominates(costs: &[f64], others: &[f64]) -> bool {
    let mut is_less = false;
    for (cost, other) in costs.iter().zip(others) {
        if cost.is_nan() || cost > other {
            return false;
        }
        is_less |= cost < other;
    }
    is_less
}

/// Returns the places of the points that no other point dominates. Of equal points the first stays.
pub fn nondominated_places(costs: &[Vec<f64>]) -> Vec<usize> {
    let stands = |k: usize| {
        let beaten = |j: usize| dominates(&costs[j], &costs[k]) || (j < k && costs[j] == costs[k]);
        costs[k].iter().all(|cost| cost.is_finite()) && !(0..costs.len()).any(beaten)
    };
    (0..costs.len()).filter(|&k| stands(k)).collect()
}

/// Returns the volume that points dominate below a reference, with each cost in its own unit. Points beyond the reference add nothing.
///
/// The last cost is cut into slices, and each slice is a volume of one cost less (hypervolume by slicing objectives; While, Hingston, Barone and
/// Huband, IEEE Transactions on Evolutionary Computation 10, 2006, page 29).
pub fn hypervolume(costs: &[Vec<f64>], reference: &[f64]) -> f64 {
    let is_inside = |point: &&Vec<f64>| point.iter().zip(reference).all(|(cost, limit)| cost < limit);
    let mut inside: Vec<&[f64]> = costs.iter().filter(is_inside).map(Vec::as_slice).collect();
    slice_volume(&mut inside, reference)
}

fn slice_volume(points: &mut [&[f64]], reference: &[f64]) -> f64 {
    let Some((&limit, lower)) = reference.split_last() else { return 0.0 };
    let last = lower.len();
    if last == 0 {
        return points.iter().map(|point| limit - point[0]).fold(0.0, f64::max);
    }
    points.sort_by(|a, b| a[last].total_cmp(&b[last]));
    let mut volume = 0.0;
    for k in 0..points.len() {
        let top = points.get(k + 1).map_or(limit, |next| next[last]);
        let depth = top - points[k][last];
        if depth > 0.0 {
            let mut below: Vec<&[f64]> = points[..=k].to_vec();
            volume += depth * slice_volume(&mut below, lower);
        }
    }
    volume
}

/// What decides between two candidates besides their place.
#[derive(Debug, Clone)]
pub(super) struct CandidateRating {
    /// Costs, each to be made least.
    pub costs: Vec<f64>,
    /// By how much the worst limit is missed; infinite if the loop is not stable.
    pub missed: f64,
}

impl CandidateRating {
    fn is_before(&self, other: &Self) -> bool {
        match (self.missed > 0.0, other.missed > 0.0) {
            (false, false) => dominates(&self.costs, &other.costs),
            (false, true) => true,
            (true, false) => false,
            (true, true) => self.missed < other.missed,
        }
    }
}

/// Returns the places of `count` candidates that survive a generation: by their rank, and within the last rank that fits the least crowded.
pub(super) fn select_survivors(all: &[CandidateRating], count: usize) -> Vec<usize> {
    let mut left: Vec<usize> = (0..all.len()).collect();
    let mut chosen: Vec<usize> = Vec::new();
    while chosen.len() < count && !left.is_empty() {
        let is_first = |k: &usize| !left.iter().any(|&j| all[j].is_before(&all[*k]));
        let mut rank: Vec<usize> = left.iter().copied().filter(is_first).collect();
        left.retain(|k| !rank.contains(k));
        let room = count - chosen.len();
        if rank.len() > room {
            let costs: Vec<Vec<f64>> = rank.iter().map(|&k| all[k].costs.clone()).collect();
            rank = least_crowded(&costs, room).into_iter().map(|place| rank[place]).collect();
        }
        chosen.extend(rank);
    }
    chosen
}

/// Returns the places of at most `count` points, the least crowded first.
pub(super) fn least_crowded(costs: &[Vec<f64>], count: usize) -> Vec<usize> {
    let distances = crowding_distances(costs);
    let mut places: Vec<usize> = (0..costs.len()).collect();
    places.sort_by(|&a, &b| distances[b].total_cmp(&distances[a]).then(a.cmp(&b)));
    places.truncate(count);
    places
}

/// Returns half the circumference of the box between the neighbours of each point, each cost over its range; infinite at the ends.
fn crowding_distances(costs: &[Vec<f64>]) -> Vec<f64> {
    let mut distances = vec![0.0_f64; costs.len()];
    for objective in 0..costs.first().map_or(0, Vec::len) {
        let mut order: Vec<usize> = (0..costs.len()).collect();
        order.sort_by(|&a, &b| costs[a][objective].total_cmp(&costs[b][objective]).then(a.cmp(&b)));
        let (first, last) = (order[0], order[order.len() - 1]);
        let range = costs[last][objective] - costs[first][objective];
        (distances[first], distances[last]) = (f64::INFINITY, f64::INFINITY);
        for window in order.windows(3).filter(|_| range > 0.0) {
            distances[window[1]] += (costs[window[2]][objective] - costs[window[0]][objective]) / range;
        }
    }
    distances
}

/// Returns the places of at most `count` points that stand for all: of the two closest points the one goes whose next neighbour is nearer. The least
/// of every cost stays.
pub(super) fn thin_points(costs: &[Vec<f64>], count: usize) -> Vec<usize> {
    let scaled = scale_costs(costs);
    let ends = least_places(costs);
    let mut kept: Vec<usize> = (0..costs.len()).collect();
    while kept.len() > count.max(ends.len()) {
        let mut closest: Option<([f64; 2], usize)> = None;
        for &k in kept.iter().filter(|k| !ends.contains(k)) {
            let near = nearest_two(&scaled, &kept, k);
            if closest.is_none_or(|(least, _)| compare_distances(&near, &least).is_lt()) {
                closest = Some((near, k));
            }
        }
        let Some((_, crowded)) = closest else { break };
        kept.retain(|&k| k != crowded);
    }
    kept
}

/// Returns the squared distances to the two nearest of the points that are kept.
fn nearest_two(scaled: &[Vec<f64>], kept: &[usize], place: usize) -> [f64; 2] {
    let mut near = [f64::INFINITY; 2];
    for &other in kept.iter().filter(|&&other| other != place) {
        let distance = squared_distance(&scaled[place], &scaled[other]);
        if distance < near[0] {
            near = [distance, near[0]];
        } else if distance < near[1] {
            near[1] = distance;
        }
    }
    near
}

fn compare_distances(a: &[f64; 2], b: &[f64; 2]) -> Ordering {
    a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
}

fn squared_distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum()
}

fn least_places(costs: &[Vec<f64>]) -> Vec<usize> {
    let mut places = Vec::new();
    for objective in 0..costs.first().map_or(0, Vec::len) {
        let least = (0..costs.len())
            .min_by(|&a, &b| costs[a][objective].total_cmp(&costs[b][objective]).then(a.cmp(&b)));
        places.extend(least.filter(|place| !places.contains(place)));
    }
    places
}

/// Each cost over its range.
fn scale_costs(costs: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut scaled = costs.to_vec();
    for objective in 0..costs.first().map_or(0, Vec::len) {
        let all = || costs.iter().map(|point| point[objective]);
        let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
        let range = if high > low { high - low } else { 1.0 };
        scaled.iter_mut().for_each(|point| point[objective] = (point[objective] - low) / range);
    }
    scaled
}
