//! Curves are read: each simple form with its numbers; a curve without one gets no reading.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_diagnose::learning::reading::{CurveForm, CurveReading, read_curve};
use counterpoise_models::{LearnedElement, LearnedPlace, LearnedQuantity, RegimeVariable};

fn curve(variable: RegimeVariable, low: f64, high: f64, of: impl Fn(f64) -> f64) -> LearnedElement {
    let points: Vec<f64> = (0..25).map(|k| low + (high - low) * f64::from(k) / 24.0).collect();
    // a small error that no form has
    let values: Vec<f64> =
        points.iter().enumerate().map(|(k, x)| of(*x) + 0.01 * (2.4 * (k * k) as f64).sin()).collect();
    let half_width = vec![0.02; 25];
    let element =
        LearnedElement::neutral(LearnedPlace::Pivot, LearnedQuantity::FrictionLevel, variable, points);
    LearnedElement { values, half_width, ..element }
}

#[test]
fn each_form_is_read_with_its_numbers() {
    use RegimeVariable::{Angle, Rate, Time};
    let near = |reading: &CurveReading, name: &str, value: f64| {
        let (found, half) = (reading.value(name), reading.half_width(name));
        assert!(
            (found - value).abs() < half.max(0.03 * value.abs()),
            "{name} {found} +- {half}, not {value}"
        );
    };
    let read =
        |variable, low, high, of: &dyn Fn(f64) -> f64| read_curve(&curve(variable, low, high, of)).unwrap();
    let flat = read(Angle, -0.1, 0.1, &|_| 1.2);
    assert_eq!(flat.form, CurveForm::Constant);
    let bump = read(Angle, -0.1, 0.1, &|x| 1.0 + 0.4 * (-((x + 0.06) / 0.02f64).powi(2)).exp());
    assert_eq!(bump.form, CurveForm::Bump);
    [("height", 0.4), ("centre", -0.06), ("width", 0.02)].iter().for_each(|(n, v)| near(&bump, n, *v));
    let linear = read(Angle, -0.1, 0.1, &|x| 1.0 + 5.0 * x);
    assert_eq!(linear.form, CurveForm::Linear);
    near(&linear, "slope", 5.0);
    let cubic = read(Rate, -1.0, 1.0, &|x| 0.2 * x - 1.5 * x * x * x);
    assert_eq!(cubic.form, CurveForm::Cubic);
    near(&cubic, "cubic", -1.5);
    let sine = read(Angle, -0.1, 0.1, &|x| 1.0 + 0.3 * (90.0 * x + 0.5).sin());
    assert_eq!(sine.form, CurveForm::Sine);
    [("amplitude", 0.3), ("order", 90.0), ("phase", 0.5)].iter().for_each(|(n, v)| near(&sine, n, *v));
    let rise = read(Time, 0.0, 5.0, &|t| 1.0 + 0.6 * (1.0 - (-t / 1.3).exp()));
    assert_eq!(rise.form, CurveForm::ExponentialApproach);
    [("rise", 0.6), ("constant", 1.3)].iter().for_each(|(n, v)| near(&rise, n, *v));
    let stops = read(Angle, -0.1, 0.1, &|x| -20.0 * (x.abs() - 0.05f64).max(0.0) * x.signum());
    assert_eq!(stops.form, CurveForm::DeadZone);
    near(&stops, "distance", 0.05);
    let sign = read(Rate, -1.0, 1.0, &|x| if x > 0.0 { 0.4 } else { -0.4 });
    assert!(matches!(sign.form, CurveForm::Sign | CurveForm::Saturation), "{sign:?}");
}

#[test]
fn a_curve_without_a_simple_form_is_not_read() {
    let rough = curve(RegimeVariable::Angle, -0.1, 0.1, |x| (3e3 * (x + 0.11) * (x + 0.11)).sin());
    assert_eq!(read_curve(&rough), None);
}
