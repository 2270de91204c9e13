//! Weights by the name of their form, then the keys of that form.

use counterpoise_lti::C64;
use counterpoise_synth::Weight;

use crate::file::field::{Field, Limit, TableField};
use crate::file::visit::{Choice, Visit, choose, list};

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
    Shelf,
    Notch,
    Product,
}

impl Choice for Form {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("constant", Self::Constant),
        ("integral", Self::Integral),
        ("lag", Self::Lag),
        ("lead", Self::Lead),
        ("quadratic", Self::Quadratic),
        ("quadratic-free-at-zero", Self::QuadraticFreeAtZero),
        ("zero-pole-gain", Self::ZeroPoleGain),
        ("shelf", Self::Shelf),
        ("notch", Self::Notch),
        ("product", Self::Product),
    ];
}

const FORM: Field = Field::new("form", "form of the weight");
const GAIN: Field = Field::new("gain", "K").limit(Limit::Not0);
const TIME: Field = Field::new("time", "a: the corner is at 1/a").unit("s").limit(Limit::Above(0.0));
const SECOND: Field = Field::new("second", "b of b s^2").unit("s^2").limit(Limit::AtLeast(0.0));
const FIRST: Field = Field::new("first", "a of a s").unit("s").limit(Limit::AtLeast(0.0));
const LOW: Field = Field::new("low", "modulus at zero frequency").limit(Limit::Above(0.0));
const HIGH: Field = Field::new("high", "modulus at infinity").limit(Limit::Above(0.0));
const CORNER: Field =
    Field::new("corner", "where it is the geometric mean").unit("rad/s").limit(Limit::Above(0.0));
const CENTRE: Field = Field::new("centre", "where the notch is").unit("rad/s").limit(Limit::Above(0.0));
const WIDTH: Field = Field::new("width", "relative half width").limit(Limit::Above(0.0));
const FACTOR: Field =
    Field::new("factor", "at the centre; below 1 a notch, above 1 a peak").limit(Limit::Above(0.0));
const ZEROS: Field = Field::new("zeros", "[real, imaginary], with their conjugates").unit("rad/s").or_empty();
const POLES: Field = Field::new("poles", "[real, imaginary], with their conjugates").unit("rad/s").or_empty();
const PART: TableField = TableField::required("part", "a factor of the product");

/// A weight still to be read.
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
    match weight {
        Weight::Product(parts) => list(v, &PART, parts, blank_weight(), self::weight),
        Weight::ZeroPoleGain { zeros, poles, gain } => {
            roots(v, &ZEROS, zeros);
            roots(v, &POLES, poles);
            v.number(&GAIN, gain);
        }
        simple => numbers(v, simple),
    }
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
        Weight::ZeroPoleGain { .. } | Weight::Product(_) => Vec::new(),
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
        Weight::ZeroPoleGain { .. } => Form::ZeroPoleGain,
        Weight::Shelf { .. } => Form::Shelf,
        Weight::Notch { .. } => Form::Notch,
        Weight::Product(_) => Form::Product,
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
        Form::ZeroPoleGain => Weight::ZeroPoleGain { zeros: Vec::new(), poles: Vec::new(), gain },
        Form::Shelf => Weight::Shelf { low: f64::NAN, high: f64::NAN, corner_rad_s: f64::NAN },
        Form::Notch => Weight::Notch { gain, centre_rad_s: f64::NAN, width: f64::NAN, factor: f64::NAN },
        Form::Product => Weight::Product(Vec::new()),
    }
}
