//! The Jacobian of a fit from exact derivatives of the runs: one run with all directions in place of one run a direction.

use counterpoise_pool::map;
use counterpoise_simulate::sensitivity::Side;

use super::output_error::{FitState, Problem, from_variable, parameters_of, to_variable, weight_residuals};
use crate::library::{EffectParameter, ParameterMapping};
use crate::simulator_access::{Assessment, MechanismVariant, VariantDirection};
use crate::tolerance::{FEWEST_EXACT_DIRECTIONS, VARIED_UNITS};

impl Problem<'_> {
    /// Returns what each variable changes of the residuals, variable by variable and recording by recording; `None` if the simulator has no
    /// derivatives, or if differences are quicker.
    pub(super) fn exact_columns(&self, now: &FitState, near: &[Assessment]) -> Option<Vec<Vec<Vec<f64>>>> {
        let free = parameters_of(&self.effects);
        if free.len() < FEWEST_EXACT_DIRECTIONS
            || free.iter().any(|one| one.mapping == ParameterMapping::Whole)
        {
            return None;
        }
        let sides: Vec<Side> = free.iter().zip(&now.x).map(|(one, x)| side(one, *x)).collect();
        let of_recording = |place: usize| {
            let shift = now.shifts[place];
            let moved = |j: usize, by: f64| {
                let mut x = now.x.clone();
                x[j] += by;
                MechanismVariant { parameters: self.mechanism_at(&x), shift }
            };
            let members: Vec<_> = (0..free.len()).map(|j| move |by: f64| moved(j, by)).collect();
            let directions = members.iter().zip(&sides);
            let directions: Vec<VariantDirection> =
                directions.map(|(member, side)| VariantDirection { member, side: *side }).collect();
            self.weighted_slopes(
                &MechanismVariant { parameters: self.mechanism_at(&now.x), shift },
                &directions,
                place,
                near,
            )
        };
        let found = map(self.pool, near.len(), of_recording);
        let found: Vec<Vec<Vec<f64>>> = found.into_iter().collect::<Option<_>>()?;
        let mut columns: Vec<Vec<Vec<f64>>> =
            (0..free.len()).map(|j| found.iter().map(|of| of[j].clone()).collect()).collect();
        if !self.preferences.is_empty() {
            for (j, column) in columns.iter_mut().enumerate() {
                column.push(self.preference_slopes(&now.x, j));
            }
        }
        Some(columns)
    }

    /// Returns the derivatives of the weighted residuals of one recording of the selection, direction by direction.
    fn weighted_slopes(
        &self,
        variant: &MechanismVariant,
        directions: &[VariantDirection],
        place: usize,
        near: &[Assessment],
    ) -> Option<Vec<Vec<f64>>> {
        let (index, span) = (self.selection.recordings[place], self.selection.span);
        let found = self.simulator.residual_slopes(variant, directions, index, span, &near[place])?;
        found.iter().map(|channels| weight_residuals(channels, &near[place])).collect()
    }

    /// Returns what a variable changes of the preferences, which are linear in the parameters' values.
    fn preference_slopes(&self, x: &[f64], variable: usize) -> Vec<f64> {
        let free = parameters_of(&self.effects);
        let value = match free[variable].mapping {
            ParameterMapping::Log => free[variable].size * from_variable(free[variable], x[variable]),
            ParameterMapping::Linear | ParameterMapping::Whole => free[variable].size,
        };
        let weight = |(place, weight): &(usize, f64)| if *place == variable { *weight } else { 0.0 };
        self.preferences.iter().map(|one| value * one.weights.iter().map(weight).sum::<f64>()).collect()
    }
}

/// Returns the side on which a parameter may be varied within its bounds.
fn side(parameter: &EffectParameter, x: f64) -> Side {
    let [lower, upper] = parameter.bounds.map(|bound| to_variable(parameter, bound));
    if x - VARIED_UNITS < lower {
        Side::Above
    } else if x + VARIED_UNITS > upper {
        Side::Below
    } else {
        Side::Both
    }
}
