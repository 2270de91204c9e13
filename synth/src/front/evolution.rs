//! A generation of new points from those there are: differential evolution on the logarithms of the parameters.
//!
//! A child is a parent moved towards a good point and by the difference of two others, in some of its parameters (current-to-pbest/1 with binomial
//! crossover: Zhang and Sanderson, IEEE Transactions on Evolutionary Computation 13, 2009, page 945). Differences carry the scale and
//! the correlation of the parameters, which for the weights of a feedback differ by decades. Parents and children compete together, as in GDE3 (Kukkonen and Lampinen,
//! IEEE Congress on Evolutionary Computation 2005, page 443).

use super::evaluator::Candidate;
use crate::tuning::random_generator::RandomGenerator;

/// Least and largest factor on a difference, and on the way to the good point: the usual range of the method.
const FACTORS: [f64; 2] = [0.2, 0.9];
/// Shares of the parameters that a child takes from its move, one of which is drawn for each child: a low one follows single parameters, a
/// high one their correlation.
const CROSSOVERS: [f64; 3] = [0.2, 0.6, 1.0];
/// Share of the children that get a random step in one parameter besides: without it a parameter on which all parents agree never moves.
const STEPPED: f64 = 0.25;
/// Largest such step, as a natural logarithm.
const STEP: f64 = 0.7;

/// Returns a child of each parent, within the ranges. `good` are the places of the points that no parent dominates.
pub(super) fn make_children(
    parents: &[Candidate],
    good: &[usize],
    ranges: &[[f64; 2]],
    random: &mut RandomGenerator,
) -> Vec<Vec<f64>> {
    (0..parents.len()).map(|k| make_child(parents, k, good, ranges, random)).collect()
}

fn make_child(
    parents: &[Candidate],
    place: usize,
    good: &[usize],
    ranges: &[[f64; 2]],
    random: &mut RandomGenerator,
) -> Vec<f64> {
    let factor = |random: &mut RandomGenerator| FACTORS[0] + (FACTORS[1] - FACTORS[0]) * random.next_share();
    let base = &parents[place].at;
    let leader = &parents[good.get(random.next_place(good.len())).copied().unwrap_or(place)].at;
    let (first, second) =
        (&parents[random.next_place(parents.len())].at, &parents[random.next_place(parents.len())].at);
    let (towards, along) = (factor(random), factor(random));
    let share = CROSSOVERS[random.next_place(CROSSOVERS.len())];
    let always = random.next_place(base.len());
    let mut child = base.clone();
    for n in 0..child.len() {
        if n == always || random.next_share() < share {
            child[n] += towards * (leader[n] - base[n]) + along * (first[n] - second[n]);
        }
    }
    if random.next_share() < STEPPED {
        let n = random.next_place(child.len());
        child[n] += STEP * random.next_symmetric(n);
    }
    for ((value, base), [low, high]) in child.iter_mut().zip(base).zip(ranges) {
        // Halfway to the bound, so that points do not gather on it.
        if *value < *low {
            *value = 0.5 * (base.max(*low) + low);
        } else if *value > *high {
            *value = 0.5 * (base.min(*high) + high);
        }
    }
    child
}
