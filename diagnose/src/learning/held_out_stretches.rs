//! The promise of a free function on stretches that did not choose it, by linear algebra on slopes that were simulated once, and how smooth
//! it should be.

use counterpoise_linalg::{Mat, solve};
use counterpoise_models::{LearnedElement, RegimeVariable};

use crate::fitting::output_error::{Preference, Slopes};
use crate::recording::series::{dot, rms};
use crate::simulator_access::Assessment;
use crate::tolerance::learning::{HELD_OUT_GROUPS, HELD_OUT_STRETCH, NEUTRAL_WEIGHT};

/// The rows of second differences of a function's values; over a turn they close.
pub(crate) fn second_differences(element: &LearnedElement) -> Vec<Vec<(usize, f64)>> {
    let n = element.points.len();
    if n < 3 {
        return Vec::new();
    }
    let row = |k: usize| vec![(k % n, 1.0), ((k + 1) % n, -2.0), ((k + 2) % n, 1.0)];
    let count = if element.variable == RegimeVariable::Turn { n } else { n - 2 };
    (0..count).map(row).collect()
}

/// Returns the preferences for a smooth function and for the value that changes nothing; `first` is the place of its first value, and
/// `curvature` the cost's curvature by a value.
pub(crate) fn preferences(
    element: &LearnedElement,
    first: usize,
    roughness: f64,
    curvature: f64,
) -> Vec<Preference> {
    let weight = (roughness * curvature).sqrt();
    let smooth = second_differences(element).into_iter().map(|row| Preference {
        weights: row.iter().map(|(k, c)| (first + k, weight * c)).collect(),
        target: 0.0,
    });
    let held = (NEUTRAL_WEIGHT * curvature).sqrt();
    let neutral = (0..element.points.len())
        .map(|k| Preference { weights: vec![(first + k, held)], target: held * element.quantity.neutral() });
    smooth.chain(neutral).collect()
}

/// Returns the preferences that keep a function flat where nothing is known of it: each such point follows its neighbour towards those that
/// are known.
pub(crate) fn flat_preferences(known: &[bool], first: usize, curvature: f64) -> Vec<Preference> {
    let (Some(low), Some(high)) = (known.iter().position(|k| *k), known.iter().rposition(|k| *k)) else {
        return Vec::new();
    };
    let weight = curvature.sqrt();
    let follows = |k: usize, neighbour: usize| Preference {
        weights: vec![(first + k, weight), (first + neighbour, -weight)],
        target: 0.0,
    };
    let below = (0..low).map(|k| follows(k, k + 1));
    below.chain((high + 1..known.len()).map(|k| follows(k, k - 1))).collect()
}

/// The normal equations of one group of stretches.
struct Group {
    gram: Mat,
    right: Vec<f64>,
    power: f64,
}

/// The normal equations of a function, group by group.
pub(crate) struct HeldOutEquations {
    groups: Vec<Group>,
    /// Median curvature of the cost by a value, as the fit has it.
    pub curvature: f64,
    /// The same with every channel at its own size.
    scaled_curvature: f64,
}

impl HeldOutEquations {
    /// Groups the stretches of all recordings; every channel counts by its own size.
    pub fn new(slopes: &Slopes, near: &[Assessment]) -> Self {
        let count = slopes.columns.len();
        let empty = || Group { gram: Mat::zeros(count, count), right: vec![0.0; count], power: 0.0 };
        let mut groups: Vec<Group> = (0..HELD_OUT_GROUPS).map(|_| empty()).collect();
        for (r, judged) in near.iter().enumerate() {
            let mut first = 0;
            for channel in &judged.channels {
                let length = channel.residual.len();
                let all = first..first + length;
                let weight = 1.0 / rms(&slopes.residual[r][all.clone()]).max(1.0);
                for (k, at) in all.clone().step_by(HELD_OUT_STRETCH).enumerate() {
                    let stretch = at..(at + HELD_OUT_STRETCH).min(all.end);
                    groups[(k + r) % HELD_OUT_GROUPS].add(slopes, r, stretch, weight * weight);
                }
                first += length;
            }
        }
        let raw = slopes.columns.iter().map(|c| c.iter().map(|own| dot(own, own)).sum::<f64>()).collect();
        let scaled = (0..count).map(|j| groups.iter().map(|g| g.gram[(j, j)]).sum::<f64>()).collect();
        Self { groups, curvature: median(raw), scaled_curvature: median(scaled) }
    }

    /// Returns the share of the residual's power that the function removes from each group, its values found from the others, with a
    /// weight of roughness; `values` are those at which the slopes were taken.
    pub fn share(&self, element: &LearnedElement, values: &[f64], roughness: f64) -> f64 {
        let preferences = preferences(element, 0, roughness, self.scaled_curvature);
        let total: f64 = self.groups.iter().map(|g| g.power).sum();
        let mut left = 0.0;
        for (k, held) in self.groups.iter().enumerate() {
            let others = self.groups.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, g)| g);
            let Some(step) = minimum(others, &preferences, values) else { return f64::NEG_INFINITY };
            let column = Mat::col(&step);
            left +=
                held.power + 2.0 * dot(&step, &held.right) + (&column.t() * &(&held.gram * &column))[(0, 0)];
        }
        1.0 - left / total.max(f64::MIN_POSITIVE)
    }
}

impl Group {
    fn add(&mut self, slopes: &Slopes, recording: usize, stretch: std::ops::Range<usize>, weight: f64) {
        let residual = &slopes.residual[recording][stretch.clone()];
        let columns: Vec<&[f64]> = slopes.columns.iter().map(|c| &c[recording][stretch.clone()]).collect();
        self.power += weight * dot(residual, residual);
        for (i, a) in columns.iter().enumerate() {
            self.right[i] += weight * dot(a, residual);
            for (j, b) in columns.iter().enumerate().take(i + 1) {
                let entry = weight * dot(a, b);
                self.gram[(i, j)] += entry;
                if i != j {
                    self.gram[(j, i)] += entry;
                }
            }
        }
    }
}

/// Returns the step of the values that minimises the residual of some groups and the missed preferences.
fn minimum<'g>(
    groups: impl Iterator<Item = &'g Group>,
    preferences: &[Preference],
    values: &[f64],
) -> Option<Vec<f64>> {
    let count = values.len();
    let (mut normal, mut right) = (Mat::zeros(count, count), vec![0.0; count]);
    for group in groups {
        normal = &normal + &group.gram;
        right.iter_mut().zip(&group.right).for_each(|(sum, own)| *sum -= own);
    }
    for preference in preferences {
        let missed = preference.shortfall(values);
        for (i, a) in &preference.weights {
            right[*i] -= a * missed;
            for (j, b) in &preference.weights {
                normal[(*i, *j)] += a * b;
            }
        }
    }
    let step = solve(&normal, &Mat::col(&right)).ok()?;
    step.is_finite().then(|| step.as_slice().to_vec())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.retain(|value| *value > 0.0);
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(1.0)
}
