//! The same controller with its paths in other forms: what each form costs, and what small numbers do to it.

use counterpoise_controller::sensitivity::{RealisationForm, realise_form};
use counterpoise_controller::{Controller, Path};
use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, poles};

use crate::tolerance::ANTI_WINDUP_SHARE;
use crate::{AdjustableController, MeasuredDeviation, Ranges};

/// A form that every path of a controller is brought to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathForm {
    /// As the controller has them.
    InUse,
    /// Sections of first and second order.
    Modal,
    /// Equal and diagonal Gramians.
    Balanced,
    /// The coefficients of the characteristic polynomial in a column: what a transfer function written out gives.
    Companion,
}

impl PathForm {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::InUse, Self::Modal, Self::Balanced, Self::Companion];

    /// Returns the name in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::InUse => "as exported",
            Self::Modal => "modal sections",
            Self::Balanced => "balanced",
            Self::Companion => "companion",
        }
    }
}

/// A controller in one form, beside the reference.
#[derive(Debug, Clone, PartialEq)]
pub struct FormFigures {
    /// Form of the realisation.
    pub form: PathForm,
    /// Multiplications of a step.
    pub multiplications: usize,
    /// Deviation of its control in double from the reference's for the same readings.
    pub double: MeasuredDeviation,
    /// Deviation in single precision: that of its C and Rust, to the last bit.
    pub single: MeasuredDeviation,
}

/// Returns the controller in every form, for the readings and settings of runs; a form that a path cannot have is
/// left out.
///
/// If a run leaves all range the figures are infinite.
pub fn figures_by_form(controller: &Controller, known: &Ranges) -> Vec<FormFigures> {
    let of = |form: PathForm| {
        let other = convert_to_form(controller, form)?;
        let double = || Box::new(other.runner()) as Box<dyn AdjustableController>;
        let single = || Box::new(other.runner_in::<f32>()) as Box<dyn AdjustableController>;
        Some(FormFigures {
            form,
            multiplications: other.programs().step.multiplications(),
            double: known.measure(&double),
            single: known.measure(&single),
        })
    };
    PathForm::ALL.into_iter().filter_map(of).collect()
}

/// Returns the controller with every path in `form`, or `None` if a path has no such form.
pub fn convert_to_form(controller: &Controller, form: PathForm) -> Option<Controller> {
    let paths = controller.parts().paths.iter().map(|path| path_in_form(path, form));
    let paths: Option<Vec<Path>> = paths.collect();
    controller
        .with(|parts| parts.paths = paths.unwrap_or_default())
        .ok()
        .filter(|other| other.parts().paths.len() == controller.parts().paths.len())
}

/// Returns a path in a form. The anti-windup is a further input of the system, so it comes along.
fn path_in_form(path: &Path, form: PathForm) -> Option<Path> {
    if form == PathForm::InUse || path.system.order() == 0 {
        return Some(path.clone());
    }
    let (system, inputs) = (&path.system, path.system.inputs());
    let B = system.B.hstack(&Mat::col(&path.anti_windup).scale(ANTI_WINDUP_SHARE));
    let D = system.D.hstack(&Mat::zeros(system.outputs(), 1));
    let both = StateSpace { B, D, ..system.clone() };
    let realised = match form {
        PathForm::Modal => realise_form(&both, RealisationForm::Modal).ok()?,
        PathForm::Balanced => realise_form(&both, RealisationForm::Balanced).ok()?,
        PathForm::Companion | PathForm::InUse => companion(&both)?,
    };
    let order = realised.order();
    let anti_windup = (0..order).map(|i| realised.B[(i, inputs)] / ANTI_WINDUP_SHARE).collect();
    let system = StateSpace { B: realised.B.block(0, 0, order, inputs), D: system.D.clone(), ..realised };
    Some(Path { system, anti_windup, ..path.clone() })
}

/// Returns the observable companion form of a system with one output: with a the characteristic polynomial and h the Markov
/// parameters
///
/// ```text
///     A = [-a_1 1 0 ...; -a_2 0 1 ...; ...; -a_n 0 ... 0],   C = [1 0 ... 0],   b_i = h_i + a_1 h_(i-1) + ... + a_(i-1) h_1
/// ```
fn companion(system: &StateSpace) -> Option<StateSpace> {
    if system.outputs() != 1 {
        return None;
    }
    let n = system.order();
    let a = polynomial(system)?;
    let mut markov = Vec::with_capacity(n);
    let mut row = system.C.clone();
    for _ in 0..n {
        markov.push(&row * &system.B);
        row = &row * &system.A;
    }
    let numerator = |i: usize, j: usize| (0..=i).map(|k| a[k] * markov[i - k][(0, j)]).sum::<f64>();
    Some(StateSpace {
        A: Mat::from_fn(n, n, |i, j| match j {
            0 => -a[i + 1],
            _ => f64::from(u8::from(i + 1 == j)),
        }),
        B: Mat::from_fn(n, system.inputs(), numerator),
        C: Mat::from_fn(1, n, |_, j| f64::from(u8::from(j == 0))),
        ..system.clone()
    })
}

/// 1, a_1, ..., a_n from the poles; products of complex numbers whose conjugates are among them.
fn polynomial(system: &StateSpace) -> Option<Vec<f64>> {
    let mut coefficients = vec![counterpoise_linalg::C64::new(1.0, 0.0)];
    for pole in poles(system).ok()? {
        let mut next = coefficients.clone();
        next.push(counterpoise_linalg::C64::new(0.0, 0.0));
        for (k, value) in coefficients.iter().enumerate() {
            next[k + 1] -= pole * value;
        }
        coefficients = next;
    }
    Some(coefficients.into_iter().map(|value| value.re).collect())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use counterpoise_lti::{Timebase, frequency_response};

    #[test]
    fn the_companion_form_is_the_same_system() {
        let system = StateSpace {
            A: Mat::from_rows(&[&[0.9, 0.2, 0.0], &[-0.2, 0.9, 0.1], &[0.0, 0.0, 0.7]]),
            B: Mat::from_rows(&[&[0.1, 1.0], &[0.5, 0.0], &[1.0, -0.3]]),
            C: Mat::from_rows(&[&[1.0, 0.3, -0.4]]),
            D: Mat::from_rows(&[&[0.2, 0.0]]),
            timebase: Timebase::Discrete { period_s: 1e-3 },
        };
        let rates = [1.0, 50.0, 900.0];
        let other = companion(&system).unwrap();
        let [a, b] = [&system, &other].map(|g| frequency_response(g, &rates).unwrap());
        for (x, y) in a.iter().zip(&b) {
            assert!((x - y).norm_max() < 1e-10 * x.norm_max(), "{x:?} {y:?}");
        }
    }
}
