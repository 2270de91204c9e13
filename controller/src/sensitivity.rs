//! The choice of a realisation: what rounded coefficients do to a path's frequency response, in modal and in balanced form.

use counterpoise_linalg::{C64, CMat, Mat, svd};
use counterpoise_lti::{StateSpace, Timebase, frequency_response, gramian_factors, poles};

use crate::Error;
use crate::realisation::{count_coefficients, modal_form};
use crate::tolerance::{MARGINAL, NEGLIGIBLE, SINGLE_ROUNDING, WORTH};

/// A form in which a path can run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RealisationForm {
    /// Sections of first and second order: about 3 products a state.
    Modal,
    /// Equal and diagonal Gramians: the whole matrix, one product for each pair of states.
    Balanced,
    /// Whichever rounded coefficients move less; balanced only if it is [`WORTH`] times better, for it multiplies more.
    LeastSensitive,
}

/// A realisation with what rounding its coefficients to single precision does.
#[derive(Debug, Clone, PartialEq)]
pub struct RealisationCandidate {
    /// [`RealisationForm::Modal`] or [`RealisationForm::Balanced`].
    pub form: RealisationForm,
    /// The system in this form.
    pub system: StateSpace,
    /// Coefficients that a step multiplies by.
    pub coefficients: usize,
    /// Predicted error of the frequency response, RMS, where it is largest; relative to the response or, where that is
    /// larger, to its median.
    pub predicted: f64,
    /// Error with rounded coefficients, where it is largest.
    pub measured: f64,
}

/// Number of frequencies at which responses are compared.
const FREQUENCIES: usize = 100;
/// Decades that these frequencies span, up to half the sample rate.
const DECADES: f64 = 5.0;

/// Returns a discrete system in the form asked for.
///
/// # Errors
/// As [`modal_form`]; [`Error::Realisation`] if the Gramians of the stable part fail.
pub fn realise_form(system: &StateSpace, form: RealisationForm) -> Result<StateSpace, Error> {
    match form {
        RealisationForm::Modal => Ok(modal_form(system)?.system),
        RealisationForm::Balanced => balanced_form(system),
        RealisationForm::LeastSensitive => {
            let (modal, balanced) = (modal_form(system)?.system, balanced_form(system)?);
            let is_worth = predict_error(&balanced)? * WORTH < predict_error(&modal)?;
            Ok(if is_worth { balanced } else { modal })
        }
    }
}

/// Returns the predicted error of [`RealisationCandidate`] alone, without the rounded response.
fn predict_error(system: &StateSpace) -> Result<f64, Error> {
    let rates = rates(system.timebase);
    Ok(Sizes::of(&frequency_response(system, &rates)?).largest_relative_error(&deviations(system, &rates)?))
}

/// Sizes of a response, to which errors are related.
struct Sizes {
    all: Vec<f64>,
    median: f64,
}

impl Sizes {
    fn of(response: &[CMat]) -> Self {
        let all: Vec<f64> = response.iter().map(CMat::norm_max).collect();
        Self { median: median(&all), all }
    }

    /// Returns the largest of errors relative to the response or, where that is larger, to its median.
    fn largest_relative_error(&self, errors: &[f64]) -> f64 {
        let relative = errors.iter().zip(&self.all).map(|(error, size)| error / size.max(self.median));
        relative.filter(|value| value.is_finite()).fold(0.0, f64::max)
    }
}

/// Returns the modal and the balanced form of a discrete system, with their sensitivities.
///
/// # Errors
/// As [`realise_form`].
pub fn form_candidates(system: &StateSpace) -> Result<Vec<RealisationCandidate>, Error> {
    [RealisationForm::Modal, RealisationForm::Balanced]
        .into_iter()
        .map(|form| form_candidate(&realise_form(system, form)?, form))
        .collect()
}

/// Returns the one that [`RealisationForm::LeastSensitive`] takes.
pub fn least_sensitive(candidates: &[RealisationCandidate]) -> Option<&RealisationCandidate> {
    let of = |form: RealisationForm| candidates.iter().find(|candidate| candidate.form == form);
    match (of(RealisationForm::Modal), of(RealisationForm::Balanced)) {
        (Some(modal), Some(balanced)) if balanced.predicted * WORTH < modal.predicted => Some(balanced),
        (Some(modal), _) => Some(modal),
        (None, other) => other,
    }
}

/// Returns the sensitivity of a system as it is.
///
/// # Errors
/// [`Error::Realisation`] if a response cannot be computed.
pub fn form_candidate(system: &StateSpace, form: RealisationForm) -> Result<RealisationCandidate, Error> {
    let rates = rates(system.timebase);
    let response = frequency_response(system, &rates)?;
    let sizes = Sizes::of(&response);
    let rounded = frequency_response(&in_single(system), &rates)?;
    let off: Vec<f64> = rounded.iter().zip(&response).map(|(a, b)| (a - b).norm_max()).collect();
    Ok(RealisationCandidate {
        form,
        system: system.clone(),
        coefficients: count_coefficients(system),
        predicted: sizes.largest_relative_error(&deviations(system, &rates)?),
        measured: sizes.largest_relative_error(&off),
    })
}

/// Returns the RMS error of the response at each rate when every coefficient is off by an independent, uniform
/// relative error
///
/// ```text
///     dG = g dA f + g dB + dC f + dD,     f = inv(z I - A) B,  g = C inv(z I - A)
/// ```
fn deviations(system: &StateSpace, rates: &[f64]) -> Result<Vec<f64>, Error> {
    let n = system.order();
    let with = |B: &Mat, C: &Mat| {
        let D = Mat::zeros(C.nrows(), B.ncols());
        frequency_response(
            &StateSpace::new(system.A.clone(), B.clone(), C.clone(), D, system.timebase)?,
            rates,
        )
    };
    let (f, g) = (with(&system.B, &Mat::eye(n))?, with(&Mat::eye(n), &system.C)?);
    let at = |k: usize| {
        let row = |i: usize| (0..system.outputs()).map(|o| g[k][(o, i)].norm_sqr()).sum::<f64>();
        let column = |j: usize| (0..system.inputs()).map(|u| f[k][(j, u)].norm_sqr()).sum::<f64>();
        let mut sum = squares(&system.D, |_, _| 1.0);
        sum += squares(&system.A, |i, j| row(i) * column(j));
        sum += squares(&system.B, |i, _| row(i));
        sum += squares(&system.C, |_, j| column(j));
        SINGLE_ROUNDING * (sum / 3.0).sqrt()
    };
    Ok((0..rates.len()).map(at).collect())
}

/// Returns the sum over the coefficients that rounding can change of their squares times a weight.
fn squares(matrix: &Mat, weight: impl Fn(usize, usize) -> f64) -> f64 {
    let exact = |value: f64| value == 0.0 || value.abs() == 1.0;
    let all = (0..matrix.nrows()).flat_map(|i| (0..matrix.ncols()).map(move |j| (i, j)));
    all.filter(|&at| !exact(matrix[at])).map(|(i, j)| matrix[(i, j)].powi(2) * weight(i, j)).sum()
}

fn in_single(system: &StateSpace) -> StateSpace {
    let rounded = |M: &Mat| Mat::from_fn(M.nrows(), M.ncols(), |i, j| f64::from(M[(i, j)] as f32));
    StateSpace {
        A: rounded(&system.A),
        B: rounded(&system.B),
        C: rounded(&system.C),
        D: rounded(&system.D),
        timebase: system.timebase,
    }
}

fn rates(timebase: Timebase) -> Vec<f64> {
    let period = if let Timebase::Discrete { period_s } = timebase { period_s } else { 1.0 };
    let share = |k: usize| (k as f64 + 0.5) / FREQUENCIES as f64 - 1.0;
    (0..FREQUENCIES).map(|k| std::f64::consts::PI / period * 10f64.powf(DECADES * share(k))).collect()
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}

/// Returns the stable part with equal, diagonal Gramians (square-root method), beside marginal poles in modal form.
fn balanced_form(system: &StateSpace) -> Result<StateSpace, Error> {
    let realised = modal_form(system)?;
    let (mut marginal, mut stable, mut first) = (Vec::new(), Vec::new(), 0);
    for size in &realised.blocks {
        let places = first..first + size;
        let block = realised.system.A.block(first, first, *size, *size);
        if radius(&block, system.timebase)? > MARGINAL {
            marginal.extend(places)
        } else {
            stable.extend(places)
        }
        first += size;
    }
    let part = |places: &[usize]| states(&realised.system, places);
    let stable = without_feedthrough(&balance_stable(&part(&stable))?);
    let marginal = part(&marginal);
    Ok(counterpoise_lti::parallel(&marginal, &stable)?)
}

fn radius(A: &Mat, timebase: Timebase) -> Result<f64, Error> {
    let n = A.nrows();
    let alone = StateSpace::new(A.clone(), Mat::zeros(n, 1), Mat::zeros(1, n), Mat::zeros(1, 1), timebase)?;
    Ok(poles(&alone)?.iter().map(|pole: &C64| pole.norm()).fold(0.0, f64::max))
}

/// Returns the part of a block-diagonal system that some states make, with all of its feedthrough.
fn states(system: &StateSpace, places: &[usize]) -> StateSpace {
    let n = places.len();
    StateSpace {
        A: Mat::from_fn(n, n, |i, j| system.A[(places[i], places[j])]),
        B: Mat::from_fn(n, system.inputs(), |i, j| system.B[(places[i], j)]),
        C: Mat::from_fn(system.outputs(), n, |i, j| system.C[(i, places[j])]),
        ..system.clone()
    }
}

fn without_feedthrough(system: &StateSpace) -> StateSpace {
    StateSpace { D: Mat::zeros(system.outputs(), system.inputs()), ..system.clone() }
}

/// T = Lc V S^-1/2, inv(T) = S^-1/2 U' Lo', from U S V' = Lo' Lc.
fn balance_stable(system: &StateSpace) -> Result<StateSpace, Error> {
    if system.order() == 0 {
        return Ok(system.clone());
    }
    let (Lc, Lo) = gramian_factors(system)?;
    let cross = svd(&(&Lo.t() * &Lc)).map_err(|error| Error::Realisation(error.to_string()))?;
    let largest = cross.s.first().copied().unwrap_or(0.0);
    let kept = cross.s.iter().filter(|value| **value > NEGLIGIBLE * largest).count();
    let root = |k: usize| 1.0 / cross.s[k].sqrt();
    let (U, V) = (&Lo * &cross.U, &Lc * &cross.V);
    let T = Mat::from_fn(system.order(), kept, |i, k| V[(i, k)] * root(k));
    let W = Mat::from_fn(kept, system.order(), |k, i| U[(i, k)] * root(k));
    let A = &(&W * &system.A) * &T;
    Ok(StateSpace { A, B: &W * &system.B, C: &system.C * &T, ..system.clone() })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const PERIOD: Timebase = Timebase::Discrete { period_s: 1e-3 };

    /// Returns an integrator, a lag and a lightly damped pair, in coordinates that mix them.
    fn mixed_system() -> StateSpace {
        let A = Mat::from_rows(&[
            &[1.0, 0.0, 0.0, 0.0],
            &[0.0, 0.97, 0.0, 0.0],
            &[0.0, 0.0, 0.98, 0.15],
            &[0.0, 0.0, -0.15, 0.98],
        ]);
        let B = Mat::from_rows(&[&[0.03], &[1.0], &[0.2], &[-0.4]]);
        let C = Mat::from_rows(&[&[1.0, 0.02, -0.3, 0.1]]);
        let T =
            Mat::from_fn(4, 4, |i, j| f64::from(i == j) + 0.3 * f64::from((i * 5 + j * 3) as u8 % 7) - 0.6);
        let W = counterpoise_linalg::inverse(&T).unwrap();
        let D = Mat::from_rows(&[&[0.5]]);
        StateSpace::new(&(&W * &A) * &T, &W * &B, &C * &T, D, PERIOD).unwrap()
    }

    fn difference(a: &StateSpace, b: &StateSpace) -> f64 {
        let rates = rates(PERIOD);
        let (x, y) = (frequency_response(a, &rates).unwrap(), frequency_response(b, &rates).unwrap());
        x.iter().zip(&y).map(|(p, q)| (p - q).norm_max() / p.norm_max()).fold(0.0, f64::max)
    }

    #[test]
    fn every_form_has_the_same_response_and_an_exact_integrator() {
        let given = mixed_system();
        for form in [RealisationForm::Modal, RealisationForm::Balanced, RealisationForm::LeastSensitive] {
            let found = realise_form(&given, form).unwrap();
            assert!(difference(&given, &found) < 1e-10, "{form:?}");
            assert!(found.A.as_slice().contains(&1.0), "{form:?}");
        }
    }

    #[test]
    fn the_balanced_part_has_equal_diagonal_gramians() {
        let given = states(&modal_form(&mixed_system()).unwrap().system, &[0, 1, 2]);
        let stable = StateSpace { A: given.A.scale(0.9), ..given };
        let found = balance_stable(&stable).unwrap();
        let P = counterpoise_lti::ctrb_gramian(&found).unwrap();
        let Q = counterpoise_lti::obsv_gramian(&found).unwrap();
        assert!((&P - &Q).norm_max() < 1e-10 * P.norm_max());
        let off = Mat::from_fn(3, 3, |i, j| if i == j { 0.0 } else { P[(i, j)] });
        assert!(off.norm_max() < 1e-10 * P.norm_max());
    }

    #[test]
    fn the_predicted_sensitivity_is_what_rounding_does() {
        for candidate in form_candidates(&mixed_system()).unwrap() {
            let ratio = candidate.measured / candidate.predicted;
            assert!((0.1..6.0).contains(&ratio), "{:?} {ratio}", candidate.form);
        }
    }

    /// Poles next to 1 that come in a companion form: rounding its coefficients moves the response by many times more.
    #[test]
    fn a_companion_form_is_far_more_sensitive() {
        let A = Mat::from_rows(&[&[2.97, -2.940_3, 0.970_299], &[1.0, 0.0, 0.0], &[0.0, 1.0, 0.0]]);
        let A = &A + &Mat::from_rows(&[&[0.0, -1e-4, 1e-4], &[0.0; 3], &[0.0; 3]]);
        let B = Mat::from_rows(&[&[1.0], &[0.0], &[0.0]]);
        let C = Mat::from_rows(&[&[1e-6, 1e-6, 1e-6]]);
        let given = StateSpace::new(A, B, C, Mat::zeros(1, 1), PERIOD).unwrap();
        let as_it_is = form_candidate(&given, RealisationForm::Modal).unwrap();
        let all = form_candidates(&given).unwrap();
        let chosen = least_sensitive(&all).unwrap();
        assert!(
            as_it_is.predicted > 100.0 * chosen.predicted,
            "{:e} {:e}",
            as_it_is.predicted,
            chosen.predicted
        );
        assert!(as_it_is.measured > 10.0 * chosen.measured);
    }
}
