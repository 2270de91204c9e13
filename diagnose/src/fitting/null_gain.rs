//! The gain under the null hypothesis: what an effect gains, on average, on the noise of the sensors in the loop alone.
//!
//! The noise of the gyroscope in the loop moves the mechanism, and a slightly wrong rate integrates to an angle that drifts: slow
//! motion that no replay repeats, and that an effect with a slow signature fits. The likelihood of white residuals takes that for
//! evidence. Therefore other realisations of the noise are simulated, and what the effect explains of them is the gain under the
//! null hypothesis.

use counterpoise_linalg::{Mat, solve};
use counterpoise_models::Parameters;

use crate::fitting::output_error::{EffectFit, from_variable, to_variable};
use crate::library::{EffectParameter, ParameterMapping};
use crate::recording::series::dot;
use crate::simulator_access::{Assessment, SimulatorAccess, Span};
use crate::tolerance::fitting::GRAM_RIDGE;
use crate::tolerance::{FIT_STEP, NULL_REALISATIONS};
use counterpoise_pool::{Pool, map};

/// The inner products of one recording: of the columns with each other, and with each realisation of the noise.
struct NoiseProjection {
    gram: Mat,
    right: Vec<Vec<f64>>,
}

/// Returns the mean log-likelihood, that the newest effect of a fit would gain on other realisations of the noise; 0 if
/// the simulator has no noise.
pub(crate) fn mean_null_gain(
    simulator: &dyn SimulatorAccess,
    pool: &dyn Pool,
    fit: &EffectFit,
    assessments: &[Assessment],
) -> f64 {
    let Some(newest) = fit.effects.last() else { return 0.0 };
    let free = newest.parameters;
    let values = &fit.values[fit.values.len() - free.len()..];
    let newest_parameters = FittedParameters { definitions: free, values };
    let said = map(pool, assessments.len(), |r| {
        project_noise(simulator, &fit.parameters, &newest_parameters, r, &assessments[r])
    });
    let said: Vec<NoiseProjection> = said.into_iter().flatten().collect();
    let Some(first) = said.first() else { return 0.0 };
    let mut gram = said.iter().skip(1).fold(first.gram.clone(), |sum, s| &sum + &s.gram);
    let ridge = GRAM_RIDGE * gram.trace().max(f64::MIN_POSITIVE);
    (0..free.len()).for_each(|j| gram[(j, j)] += ridge);
    let outcomes = said.iter().map(|s| s.right.len()).min().unwrap_or(0);
    let one = |k: usize| {
        let right: Vec<f64> = (0..free.len()).map(|j| said.iter().map(|s| s.right[k][j]).sum()).collect();
        let found = solve(&gram, &Mat::col(&right)).ok()?;
        Some(0.5 * dot(found.as_slice(), &right))
    };
    let each: Vec<f64> = (0..outcomes).filter_map(one).filter(|e: &f64| e.is_finite()).collect();
    each.iter().sum::<f64>() / each.len().max(1) as f64
}

/// Parameters of an effect with their fitted values.
struct FittedParameters<'a> {
    definitions: &'a [EffectParameter],
    values: &'a [f64],
}

/// The inner products of what a step of each parameter does to a recording.
fn project_noise(
    simulator: &dyn SimulatorAccess,
    parameters: &Parameters,
    fitted: &FittedParameters,
    index: usize,
    near: &Assessment,
) -> Option<NoiseProjection> {
    let here = simulator.residuals(parameters, index, Span::Whole, near)?;
    let weights: Vec<f64> = here.iter().map(|m| 1.0 / m.relative_rms().max(1.0)).collect();
    let column = |(parameter, &value): (&EffectParameter, &f64)| {
        let step = if parameter.mapping == ParameterMapping::Whole { 1.0 } else { 10.0 * FIT_STEP };
        let mut moved = parameters.clone();
        parameter.write(&mut moved, from_variable(parameter, to_variable(parameter, value) + step));
        let there = simulator.residuals(&moved, index, Span::Whole, near)?;
        let change = |(c, (t, h)): (
            usize,
            (&crate::simulator_access::ChannelResidual, &crate::simulator_access::ChannelResidual),
        )| {
            let pairs = t.residual.iter().zip(&h.residual);
            pairs.map(|(a, b)| weights[c] * (a - b) / step).collect::<Vec<f64>>()
        };
        Some(there.iter().zip(&here).enumerate().flat_map(change).collect::<Vec<f64>>())
    };
    let columns: Vec<Vec<f64>> =
        fitted.definitions.iter().zip(fitted.values).map(column).collect::<Option<_>>()?;
    let gram = Mat::from_fn(columns.len(), columns.len(), |i, j| dot(&columns[i], &columns[j]));
    let outcome = |which: u64| {
        let moved = simulator.noise_response(parameters, index, near, which)?;
        let weighted = moved.iter().zip(&weights).flat_map(|(channel, w)| channel.iter().map(move |d| w * d));
        let series: Vec<f64> = weighted.collect();
        Some(columns.iter().map(|c| dot(c, &series)).collect())
    };
    Some(NoiseProjection { gram, right: (0..NULL_REALISATIONS).map_while(outcome).collect() })
}
