//! Where an axis has its ticks, and what they say.

use crate::{Axis, Scale};

const MOST_TICKS: f64 = 7.0;
const DEGREE_STEPS: [f64; 9] = [1.0, 2.0, 5.0, 15.0, 30.0, 45.0, 90.0, 180.0, 360.0];
/// Part of the data's range that is left free above and below.
const PADDING: f64 = 0.06;

/// An axis with its range settled: maps values to 0 .. 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Ruler {
    from: f64,
    to: f64,
    scale: Scale,
}

/// A tick and its text; minor ticks have none.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// Where.
    pub value: f64,
    /// What it says.
    pub text: String,
}

impl Ruler {
    /// The ruler of an axis whose values are `data`; without data it runs from 0 (or 1) to 1 (or 10).
    pub fn new(axis: &Axis, data: impl Iterator<Item = f64>, tight: Tightness) -> Self {
        let logarithmic = axis.scale == Scale::Logarithmic;
        let usable = data.filter(|v| v.is_finite() && (!logarithmic || *v > 0.0));
        let (low, high) = usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        let (from, to) = match axis.range {
            Some(range) => range,
            None if low > high => (if logarithmic { 1.0 } else { 0.0 }, if logarithmic { 10.0 } else { 1.0 }),
            None => padded(low, high, axis.scale, tight),
        };
        Self { from, to, scale: axis.scale }
    }

    /// 0 at the start of the axis, 1 at its end; `None` where the value cannot be drawn.
    pub fn place(&self, value: f64) -> Option<f64> {
        if !value.is_finite() {
            return None;
        }
        if self.scale != Scale::Logarithmic {
            return Some((value - self.from) / (self.to - self.from));
        }
        (value > 0.0).then(|| (value / self.from).ln() / (self.to / self.from).ln())
    }

    /// Ticks with text.
    pub fn major(&self) -> Vec<Tick> {
        match self.scale {
            Scale::Linear => self.every(nice_step((self.to - self.from) / MOST_TICKS)),
            Scale::Degrees => self.every(self.degree_step()),
            Scale::Logarithmic => self.decades(),
        }
    }

    /// Ticks without text, on a logarithmic axis of not too many decades.
    pub fn minor(&self) -> Vec<f64> {
        let decades = (self.to / self.from).log10();
        if self.scale != Scale::Logarithmic || decades > 7.0 {
            return Vec::new();
        }
        let (first, last) = (self.from.log10().floor() as i32, self.to.log10().ceil() as i32);
        let all = (first..last).flat_map(|d| (2..10).map(move |k| f64::from(k) * 10f64.powi(d)));
        all.filter(|v| (self.from..=self.to).contains(v)).collect()
    }

    fn degree_step(&self) -> f64 {
        let wanted = (self.to - self.from) / MOST_TICKS;
        DEGREE_STEPS
            .into_iter()
            .find(|&step| step >= wanted)
            .unwrap_or_else(|| 360.0 * nice_step(wanted / 360.0).max(1.0))
    }

    fn every(&self, step: f64) -> Vec<Tick> {
        let slack = 1e-9 * step;
        let (first, last) =
            (((self.from - slack) / step).ceil() as i64, ((self.to + slack) / step).floor() as i64);
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        (first..=last)
            .map(|k| k as f64 * step)
            .map(|value| Tick { value, text: number(value, step, decimals) })
            .collect()
    }

    fn decades(&self) -> Vec<Tick> {
        let (first, last) = (self.from.log10(), self.to.log10());
        if last - first < 1.2 {
            return self.parts_of_a_decade();
        }
        let stride = ((last - first) / 9.0).ceil().max(1.0) as i32;
        let whole = ((first - 1e-9).ceil() as i32)..=((last + 1e-9).floor() as i32);
        let decade = |d: i32| Tick { value: 10f64.powi(d), text: power_of_ten(d) };
        whole.filter(|d| d.rem_euclid(stride) == 0).map(decade).collect()
    }

    fn parts_of_a_decade(&self) -> Vec<Tick> {
        let first = self.from.log10().floor() as i32;
        let all = (first..first + 3).flat_map(|d| [1.0, 2.0, 5.0].map(|k| (k, d)));
        let within = all.filter(|(k, d)| (self.from..=self.to).contains(&(k * 10f64.powi(*d))));
        within.map(|(k, d)| Tick { value: k * 10f64.powi(d), text: short(k * 10f64.powi(d)) }).collect()
    }
}

/// Whether the axis ends where the data end, or leaves some room.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tightness {
    /// Ends where the data end.
    Tight,
    /// Leaves room above and below.
    Padded,
}

fn padded(low: f64, high: f64, scale: Scale, tight: Tightness) -> (f64, f64) {
    let part = if tight == Tightness::Tight { 0.0 } else { PADDING };
    if scale == Scale::Logarithmic {
        let ratio = if high > low * 1.001 { high / low } else { 10.0 };
        let room = ratio.powf(part);
        return if high > low * 1.001 { (low / room, high * room) } else { (low / 3.0, high * 3.0) };
    }
    let span = high - low;
    let least = 1e-12 + 1e-9 * low.abs().max(high.abs());
    if span > least {
        (low - part * span, high + part * span)
    } else {
        (low - 0.5 * half(low), high + 0.5 * half(low))
    }
}

fn half(value: f64) -> f64 {
    if value == 0.0 { 1.0 } else { value.abs() }
}

/// The next of 1, 2, 5 times a power of ten.
fn nice_step(wanted: f64) -> f64 {
    let power = 10f64.powf(wanted.log10().floor());
    let mantissa = wanted / power;
    let nice = if mantissa <= 1.0 {
        1.0
    } else if mantissa <= 2.0 {
        2.0
    } else if mantissa <= 5.0 {
        5.0
    } else {
        10.0
    };
    nice * power
}

fn number(value: f64, step: f64, decimals: usize) -> String {
    let value = if value.abs() < 1e-9 * step { 0.0 } else { value };
    if value != 0.0 && (step < 1e-4 || value.abs() >= 1e6) {
        format!("{value:.1e}")
    } else {
        with_minus(format!("{value:.decimals$}"))
    }
}

/// A hyphen is too short for a minus sign.
fn with_minus(text: String) -> String {
    text.replace('-', "\u{2212}")
}

fn power_of_ten(exponent: i32) -> String {
    if (-3..=4).contains(&exponent) {
        short(10f64.powi(exponent))
    } else {
        format!("10{}", superscript(exponent))
    }
}

fn superscript(exponent: i32) -> String {
    let digit = |c: char| match c {
        '-' => '\u{207B}',
        '1' => '\u{B9}',
        '2' => '\u{B2}',
        '3' => '\u{B3}',
        other => char::from_u32(0x2070 + other as u32 - '0' as u32).unwrap_or(other),
    };
    exponent.to_string().chars().map(digit).collect()
}

/// A number with at most four significant digits and no trailing noise, for labels and tables.
pub fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return match value {
            v if v == f64::INFINITY => "\u{221E}".to_owned(),
            v if v == f64::NEG_INFINITY => "\u{2212}\u{221E}".to_owned(),
            v if v.is_nan() => "\u{2013}".to_owned(),
            _ => "0".to_owned(),
        };
    }
    let magnitude = value.abs().log10().floor();
    if !(-4.0..6.0).contains(&magnitude) {
        return scientific(value);
    }
    let decimals = (3.0 - magnitude).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    with_minus(text.to_owned())
}

fn scientific(value: f64) -> String {
    let text = format!("{value:.2e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let power = superscript(exponent.parse().unwrap_or(0));
    with_minus(format!("{mantissa}\u{D7}10{power}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(axis: &Axis, data: [f64; 2]) -> Vec<String> {
        Ruler::new(axis, data.into_iter(), Tightness::Tight).major().into_iter().map(|t| t.text).collect()
    }

    #[test]
    fn ticks_are_round_and_few() {
        assert_eq!(texts(&Axis::linear("t", "s"), [0.0, 10.0]), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(texts(&Axis::linear("y", ""), [-0.03, 0.05]), ["\u{2212}0.02", "0.00", "0.02", "0.04"]);
        assert_eq!(texts(&Axis::degrees("phase"), [-270.0, 0.0]).len(), 7);
        assert_eq!(texts(&Axis::logarithmic("f", "Hz"), [0.01, 100.0]), ["0.01", "0.1", "1", "10", "100"]);
        assert_eq!(texts(&Axis::logarithmic("f", "Hz"), [2.0, 9.0]), ["2", "5"]);
    }

    #[test]
    fn odd_data_give_a_usable_ruler() {
        for data in [[f64::NAN, f64::NAN], [0.0, 0.0], [3.0, 3.0], [-1e-300, 1e300]] {
            for axis in [Axis::linear("y", ""), Axis::logarithmic("y", ""), Axis::degrees("y")] {
                let ruler = Ruler::new(&axis, data.into_iter(), Tightness::Padded);
                assert!(ruler.major().len() < 40, "{axis:?} {data:?}");
                assert!(ruler.place(f64::NAN).is_none());
            }
        }
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(short(13.456_78), "13.46");
        assert_eq!(short(-0.5), "\u{2212}0.5");
        assert_eq!(short(120_000.0), "120000");
        assert_eq!(short(1.5e-9), "1.50\u{D7}10\u{207B}\u{2079}");
        assert_eq!(short(f64::INFINITY), "\u{221E}");
    }
}
