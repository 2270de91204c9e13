//! Weights by the name of their form, then the keys of that form.

use counterpoise_linalg::C64;
use counterpoise_synth::Weight;

use super::digits::round_to_digits;
use super::model::count;
use crate::file::field::{Field, NumberRange, TableField};
use crate::file::visit::{NamedChoice, Visit, choose, list};
use crate::tolerance::FITTED_WEIGHT_DB;

/// The name of a form.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Form {
    Constant,
    Integral,
    Lag,
    Lead,
    Quadratic,
    QuadraticFreeAtZero,
    ZeroPoleGain,
    ProportionalIntegral,
    SecondOrder,
    Shelf,
    Notch,
    Product,
    Table,
}

impl NamedChoice for Form {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("constant", Self::Constant),
        ("integral", Self::Integral),
        ("lag", Self::Lag),
        ("lead", Self::Lead),
        ("quadratic", Self::Quadratic),
        ("quadratic-free-at-zero", Self::QuadraticFreeAtZero),
        ("zero-pole-gain", Self::ZeroPoleGain),
        ("proportional-integral", Self::ProportionalIntegral),
        ("second-order", Self::SecondOrder),
        ("shelf", Self::Shelf),
        ("notch", Self::Notch),
        ("product", Self::Product),
        ("table", Self::Table),
    ];
}

const FORM: Field = Field::new("form", "form of the weight");
const GAIN: Field = Field::new("gain", "factor K").limit(NumberRange::Not0);
const TIME: Field = Field::new("time", "time constant a: the corner frequency is 1/a")
    .unit("s")
    .limit(NumberRange::Above(0.0));
const SECOND: Field =
    Field::new("second", "coefficient b of the term b s^2").unit("s^2").limit(NumberRange::AtLeast(0.0));
const FIRST: Field =
    Field::new("first", "coefficient a of the term a s").unit("s").limit(NumberRange::AtLeast(0.0));
const LOW: Field = Field::new("low", "modulus at zero frequency").limit(NumberRange::Above(0.0));
const HIGH: Field = Field::new("high", "modulus at infinity").limit(NumberRange::Above(0.0));
const CORNER: Field =
    Field::new("corner", "corner frequency, where the modulus is the geometric mean of `low` and `high`")
        .unit("rad/s")
        .limit(NumberRange::Above(0.0));
const CENTRE: Field =
    Field::new("centre", "centre of the notch").unit("rad/s").limit(NumberRange::Above(0.0));
const WIDTH: Field = Field::new("width", "half-width relative to the centre").limit(NumberRange::Above(0.0));
const FACTOR: Field = Field::new("factor", "modulus at the centre: below 1 it is a notch, above 1 a peak")
    .limit(NumberRange::Above(0.0));
const PI_CORNER: Field = Field::new("corner", "K (s + corner) / s: integral below, constant above")
    .unit("rad/s")
    .limit(NumberRange::Above(0.0));
const NATURAL: Field =
    Field::new("natural_frequency", "natural frequency w of K w^2 / (s^2 + 2 z w s + w^2)")
        .unit("rad/s")
        .limit(NumberRange::Above(0.0));
const DAMPING: Field = Field::new("damping_ratio", "damping ratio z").limit(NumberRange::AboveTo(0.0, 1.0));
const ZEROS: Field =
    Field::new("zeros", "real and imaginary parts, conjugates included").unit("rad/s").or_empty();
const POLES: Field =
    Field::new("poles", "real and imaginary parts, conjugates included").unit("rad/s").or_empty();
const POINTS: Field =
    Field::new("points", "frequency and modulus, in rising order, or the name of a CSV file")
        .units("rad/s", "")
        .limit(NumberRange::Above(0.0));
const ORDER: Field =
    Field::new("order", "order of the stable, minimum-phase function that is fitted to the points")
        .limit(NumberRange::Between(1.0, 8.0))
        .or(2.0);
const PART: TableField = TableField::mandatory("part", "a factor of the product");

/// Returns a weight still to be read.
pub(crate) fn blank_weight() -> Weight {
    Weight::Constant { gain: f64::NAN }
}

/// Reads or lists a weight.
pub(crate) fn weight(v: &mut dyn Visit, weight: &mut Weight) {
    let mut form = form_of(weight);
    choose(v, &FORM, &mut form);
    if form != form_of(weight) {
        *weight = blank(form);
    }
    match (form, weight) {
        (Form::ProportionalIntegral, weight) => proportional_integral(v, weight),
        (Form::SecondOrder, weight) => second_order(v, weight),
        (_, Weight::Product(parts)) => list(v, &PART, parts, blank_weight(), self::weight),
        (_, Weight::ZeroPoleGain { zeros, poles, gain }) => {
            roots(v, &ZEROS, zeros);
            roots(v, &POLES, poles);
            v.number(&GAIN, gain);
        }
        (Form::Table, weight) => table(v, weight),
        (_, simple) => numbers(v, simple),
    }
}

/// A table and the function that stands for it; fitted again only where points or order have changed.
fn table(v: &mut dyn Visit, weight: &mut Weight) {
    let Weight::Table { points, order, .. } = &*weight else { return };
    let (mut new, mut new_order) = (points.clone(), *order);
    v.pairs(&POINTS, &mut new);
    count(v, &ORDER, &mut new_order);
    if (&new, new_order) == (points, *order) || new.is_empty() {
        return;
    }
    match Weight::table(&new, new_order) {
        Ok(fitted) if fitted.worst_db() > FITTED_WEIGHT_DB => {
            let off = fitted.worst_db();
            let hint = format!("the best is {off:.2} dB away: raise order, or smooth the table");
            let allowed =
                format!("must be met by a function of order {new_order} within {FITTED_WEIGHT_DB} dB");
            v.complain("points", &allowed, Some(hint));
        }
        Ok(fitted) => *weight = fitted,
        Err(error) => v.complain("points", &format!("must be a table of moduli ({error})"), None),
    }
}

/// K (s + corner) / s.
fn proportional_integral(v: &mut dyn Visit, weight: &mut Weight) {
    let (mut gain, mut corner) = pi_parts(weight).unwrap_or((f64::NAN, f64::NAN));
    v.number(&GAIN, &mut gain);
    v.number(&PI_CORNER, &mut corner);
    *weight = pi(gain, corner);
}

fn pi(gain: f64, corner: f64) -> Weight {
    Weight::ZeroPoleGain { zeros: vec![C64::new(-corner, 0.0)], poles: vec![C64::ZERO], gain }
}

fn pi_parts(weight: &Weight) -> Option<(f64, f64)> {
    let Weight::ZeroPoleGain { zeros, poles, gain } = weight else { return None };
    match (&zeros[..], &poles[..]) {
        ([zero], [pole]) if *pole == C64::ZERO && zero.im == 0.0 && zero.re < 0.0 => Some((*gain, -zero.re)),
        _ => None,
    }
}

/// K w^2 / (s^2 + 2 z w s + w^2).
fn second_order(v: &mut dyn Visit, weight: &mut Weight) {
    let (mut gain, mut natural, mut damping) =
        second_order_parts(weight).unwrap_or((f64::NAN, f64::NAN, f64::NAN));
    v.number(&GAIN, &mut gain);
    v.number(&NATURAL, &mut natural);
    v.number(&DAMPING, &mut damping);
    *weight = resonator(gain, natural, damping);
}

fn resonator(gain: f64, natural: f64, damping: f64) -> Weight {
    let (re, im) = (-damping * natural, natural * (1.0 - damping * damping).max(0.0).sqrt());
    Weight::ZeroPoleGain {
        zeros: Vec::new(),
        poles: vec![C64::new(re, im), C64::new(re, -im)],
        gain: gain * natural * natural,
    }
}

/// Returns the gain, natural frequency and damping ratio, where a few digits of them give the weight to the
/// last bit.
fn second_order_parts(weight: &Weight) -> Option<(f64, f64, f64)> {
    let Weight::ZeroPoleGain { zeros, poles, gain } = weight else { return None };
    let ([], [first, _]) = (&zeros[..], &poles[..]) else { return None };
    let natural = round_to_digits(first.norm());
    let damping = round_to_digits(-first.re / natural);
    let k = round_to_digits(gain / (natural * natural));
    (resonator(k, natural, damping) == *weight).then_some((k, natural, damping))
}

/// The forms that are a few numbers.
fn numbers(v: &mut dyn Visit, weight: &mut Weight) {
    let fields: Vec<(&Field, &mut f64)> = match weight {
        Weight::Constant { gain } => vec![(&GAIN, gain)],
        Weight::Integral { gain, time_s } | Weight::Lag { gain, time_s } | Weight::Lead { gain, time_s } => {
            vec![(&GAIN, gain), (&TIME, time_s)]
        }
        Weight::Quadratic { gain, second_s2, first_s }
        | Weight::QuadraticFreeAtZero { gain, second_s2, first_s } => {
            vec![(&GAIN, gain), (&SECOND, second_s2), (&FIRST, first_s)]
        }
        Weight::Shelf { low, high, corner_rad_s } => {
            vec![(&LOW, low), (&HIGH, high), (&CORNER, corner_rad_s)]
        }
        Weight::Notch { gain, centre_rad_s, width, factor } => {
            vec![(&GAIN, gain), (&CENTRE, centre_rad_s), (&WIDTH, width), (&FACTOR, factor)]
        }
        Weight::ZeroPoleGain { .. } | Weight::Product(_) | Weight::Table { .. } => Vec::new(),
    };
    for (field, value) in fields {
        v.number(field, value);
    }
}

fn roots(v: &mut dyn Visit, field: &Field, roots: &mut Vec<C64>) {
    let mut pairs: Vec<[f64; 2]> = roots.iter().map(|r| [r.re, r.im]).collect();
    v.pairs(field, &mut pairs);
    *roots = pairs.iter().map(|[re, im]| C64::new(*re, *im)).collect();
    let lonely = roots.iter().find(|r| r.im != 0.0 && !roots.contains(&r.conj()));
    if let Some(root) = lonely {
        v.complain(field.key, &format!("the root {} + {}i lacks its conjugate", root.re, root.im), None);
    }
}

fn form_of(weight: &Weight) -> Form {
    match weight {
        Weight::Constant { .. } => Form::Constant,
        Weight::Integral { .. } => Form::Integral,
        Weight::Lag { .. } => Form::Lag,
        Weight::Lead { .. } => Form::Lead,
        Weight::Quadratic { .. } => Form::Quadratic,
        Weight::QuadraticFreeAtZero { .. } => Form::QuadraticFreeAtZero,
        Weight::ZeroPoleGain { .. } if pi_parts(weight).is_some() => Form::ProportionalIntegral,
        Weight::ZeroPoleGain { .. } if second_order_parts(weight).is_some() => Form::SecondOrder,
        Weight::ZeroPoleGain { .. } => Form::ZeroPoleGain,
        Weight::Shelf { .. } => Form::Shelf,
        Weight::Notch { .. } => Form::Notch,
        Weight::Product(_) => Form::Product,
        Weight::Table { .. } => Form::Table,
    }
}

fn blank(form: Form) -> Weight {
    let (gain, time_s, second_s2, first_s) = (f64::NAN, f64::NAN, f64::NAN, f64::NAN);
    match form {
        Form::Constant => Weight::Constant { gain },
        Form::Integral => Weight::Integral { gain, time_s },
        Form::Lag => Weight::Lag { gain, time_s },
        Form::Lead => Weight::Lead { gain, time_s },
        Form::Quadratic => Weight::Quadratic { gain, second_s2, first_s },
        Form::QuadraticFreeAtZero => Weight::QuadraticFreeAtZero { gain, second_s2, first_s },
        Form::ZeroPoleGain | Form::ProportionalIntegral | Form::SecondOrder => {
            Weight::ZeroPoleGain { zeros: Vec::new(), poles: Vec::new(), gain }
        }
        Form::Shelf => Weight::Shelf { low: f64::NAN, high: f64::NAN, corner_rad_s: f64::NAN },
        Form::Notch => Weight::Notch { gain, centre_rad_s: f64::NAN, width: f64::NAN, factor: f64::NAN },
        Form::Product => Weight::Product(Vec::new()),
        Form::Table => {
            Weight::Table { points: Vec::new(), order: 2, fitted: Box::new(Weight::Constant { gain }) }
        }
    }
}
