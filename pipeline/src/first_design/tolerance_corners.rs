//! The machine with values at the ends of their tolerances, for a first design to hold.
//!
//! Each value is put to either end alone, and all of them to ends that an orthogonal array of strength 3 chooses: the rows of a Hadamard matrix
//! of Sylvester's kind and their negatives (A. Hedayat, N. Sloane and J. Stufken, Orthogonal Arrays, 1999, chapter 7). Of up to four values
//! all corners are taken instead; with more, any three of them are seen in all of their eight combinations, in 16 corners for up to eight values. The
//! first two corners are those at which every value raises, or lowers, the gain at the highest bandwidth that the clock allows.

use std::f64::consts::TAU;

use counterpoise_lti::frequency_response;
use counterpoise_project::Project;
use counterpoise_project::resolve::synthesis::DesignRequest;
use counterpoise_synth::DesignPlant;
use counterpoise_verify::robustness::{Distribution, VariedParameter};

use super::with_angles;
use crate::synth::design_plant;
use crate::{PipelineError, ReducedPlant, build_plant_model};

/// Share of the sample rate at which the gains of plants within tolerances are compared: the highest bandwidth of a first design.
const SHARE_OF_CLOCK: f64 = 0.05;

/// A parameter and the factor on it.
#[derive(Clone, Copy)]
struct ScaledParameter {
    parameter: VariedParameter,
    factor: f64,
}

/// The two ends of a tolerance.
struct Ends {
    raises_gain: ScaledParameter,
    lowers_gain: ScaledParameter,
}

/// Returns the plants at the ends of the tolerances. A plant that cannot be built is left out.
///
/// # Errors
/// Those of the frequency response.
pub(super) fn plants_within_tolerances(
    project: &Project,
    asked: &DesignRequest,
    reduced: &ReducedPlant,
) -> Result<Vec<DesignPlant>, PipelineError> {
    let rate_rad_s = SHARE_OF_CLOCK * TAU / project.plant.interface.sample_period_s;
    let gain = |plant: &DesignPlant| -> Result<f64, PipelineError> {
        let measured = plant.system.select(&[plant.rate], &[plant.control]);
        Ok(frequency_response(&measured, &[rate_rad_s])?.first().map_or(0.0, |value| value[(0, 0)].norm()))
    };
    let scaled = |ends: &[ScaledParameter]| scaled_plant(project, asked, reduced, ends);
    let (mut alone, mut ends) = (Vec::new(), Vec::new());
    for variation in project.variations_within_tolerances() {
        let Distribution::Uniform { low, high } = variation.distribution else { continue };
        let [low, high] =
            [low, high].map(|factor| ScaledParameter { parameter: variation.parameter, factor });
        let (Some(below), Some(above)) = (scaled(&[low]), scaled(&[high])) else { continue };
        if below == above {
            continue;
        }
        let (raises_gain, lowers_gain) =
            if gain(&above)? > gain(&below)? { (high, low) } else { (low, high) };
        ends.push(Ends { raises_gain, lowers_gain });
        alone.extend([below, above]);
    }
    let at = |corner: Vec<bool>| -> Vec<ScaledParameter> {
        let each = ends.iter().zip(corner);
        each.map(|(ends, raises)| if raises { ends.raises_gain } else { ends.lowers_gain }).collect()
    };
    let corners = if ends.len() > 1 { corners(ends.len()) } else { Vec::new() };
    let mut all: Vec<DesignPlant> = corners.into_iter().filter_map(|corner| scaled(&at(corner))).collect();
    all.append(&mut alone);
    Ok(all)
}

/// Most values of which all corners are taken.
const MOST_OF_ALL_CORNERS: usize = 4;

/// Returns all corners of few values, and of more an orthogonal array of strength 3 of two levels: rows of the Hadamard matrix, each followed by
/// its negative.
fn corners(values: usize) -> Vec<Vec<bool>> {
    let takes_all = values <= MOST_OF_ALL_CORNERS;
    let rows = if takes_all { 1 << (values - 1) } else { values.next_power_of_two() };
    let mask = |column: usize| match takes_all {
        true if column + 1 == values => 0,
        true => 1 << column,
        false => column,
    };
    let row = |row: usize, sign: bool| -> Vec<bool> {
        (0..values).map(|column| (row & mask(column)).count_ones().is_multiple_of(2) == sign).collect()
    };
    (0..rows).flat_map(|k| [row(k, true), row(k, false)]).collect()
}

/// The plant of the design with some parameters scaled; `None` if there is none.
fn scaled_plant(
    project: &Project,
    asked: &DesignRequest,
    reduced: &ReducedPlant,
    scaled: &[ScaledParameter],
) -> Option<DesignPlant> {
    let mut changed = project.clone();
    for ScaledParameter { parameter, factor } in scaled {
        parameter.scale(&mut changed.plant, *factor).ok()?;
    }
    let made = build_plant_model(&changed).ok()?;
    let plant = design_plant(asked, &made, reduced).ok()?;
    with_angles(&changed, &made, &plant).ok()
}

#[cfg(test)]
mod tests {
    use super::corners;

    #[test]
    fn any_three_values_are_seen_in_all_combinations() {
        for values in 3..=12 {
            let all = corners(values);
            assert!(all.len() <= 4 * values, "{values} values: {} corners", all.len());
            for (a, b, c) in triples(values) {
                let mut seen = [false; 8];
                for corner in &all {
                    seen[usize::from(corner[a]) + 2 * usize::from(corner[b]) + 4 * usize::from(corner[c])] =
                        true;
                }
                assert!(seen.iter().all(|seen| *seen), "{values}: {a} {b} {c}");
            }
        }
        for values in 1..=4 {
            let mut all = corners(values);
            assert_eq!(all[..2], [vec![true; values], vec![false; values]]);
            all.sort();
            all.dedup();
            assert_eq!(all.len(), 1 << values);
        }
    }

    fn triples(values: usize) -> impl Iterator<Item = (usize, usize, usize)> {
        (0..values)
            .flat_map(move |a| (a + 1..values).flat_map(move |b| (b + 1..values).map(move |c| (a, b, c))))
    }
}
