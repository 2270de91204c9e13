//! An axis whose range is settled, as one dimension of plotters' coordinate system.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

use crate::figure::{Axis, Scale};
use crate::ticks::{self, Tick};
use crate::tolerance::{FARTHEST, LARGEST_DRAWN, LEAST_SPAN};

/// Room for ticks, in intervals: on a linear axis a figure's height holds seven numbers, on a logarithmic one nine powers of ten.
const INTERVALS: f64 = 7.0;
const DECADES: f64 = 9.0;
/// Part of the data's range that is left free above and below.
const PADDING: f64 = 0.06;

/// An axis with its range settled.
#[derive(Debug, Clone, PartialEq)]
pub struct Ruler {
    from: f64,
    to: f64,
    scale: Scale,
}

/// Room between the ends of the data and the ends of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Margin {
    /// The axis ends where the data end.
    Tight,
    /// The axis leaves room at both ends.
    Padded,
}

impl Ruler {
    /// Returns the ruler of an axis over `data`. Without a usable value it runs from 0 to 1, or from 1 to 10 if it is logarithmic.
    pub fn new(axis: &Axis, data: impl Iterator<Item = f64>, margin: Margin) -> Self {
        let scale = axis.scale;
        let usable = data.filter(|value| is_drawable(*value, scale));
        let (low, high) = usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        let fixed = axis.range.filter(|(from, to)| {
            is_drawable(*from, scale) && is_drawable(*to, scale) && to - from > LEAST_SPAN * from.abs()
        });
        let (from, to) = match fixed {
            Some(range) => range,
            None if low > high && scale == Scale::Logarithmic => (1.0, 10.0),
            None if low > high => (0.0, 1.0),
            None => pad_range(low, high, scale, margin),
        };
        Self { from, to, scale }
    }

    /// Returns 0 at the start of the axis and 1 at its end; `None` if the value cannot be drawn.
    pub fn place(&self, value: f64) -> Option<f64> {
        if !is_drawable(value, self.scale) {
            return None;
        }
        Some(match self.scale {
            Scale::Logarithmic => (value / self.from).ln() / (self.to / self.from).ln(),
            Scale::Linear | Scale::Degrees => (value - self.from) / (self.to - self.from),
        })
    }

    /// Returns the value at a place: the inverse of [`place`](Self::place).
    pub fn value_at(&self, place: f64) -> f64 {
        match self.scale {
            Scale::Logarithmic => self.from * (place * (self.to / self.from).ln()).exp(),
            Scale::Linear | Scale::Degrees => self.from + place * (self.to - self.from),
        }
    }

    /// Returns its ends.
    pub fn ends(&self) -> (f64, f64) {
        (self.from, self.to)
    }

    /// Returns the same ruler, widened about its middle to `times` its length. A logarithmic one is returned as it is.
    pub fn widen(&self, times: f64) -> Self {
        if self.scale == Scale::Logarithmic {
            return self.clone();
        }
        let (middle, half) = (0.5 * (self.from + self.to), 0.5 * (self.to - self.from));
        Self { from: middle - times * half, to: middle + times * half, scale: self.scale }
    }

    /// Returns the ticks with text.
    pub fn major(&self) -> Vec<Tick> {
        match self.scale {
            Scale::Linear => ticks::linear_ticks(self.from, self.to, INTERVALS),
            Scale::Degrees => ticks::degree_ticks(self.from, self.to, INTERVALS),
            Scale::Logarithmic => ticks::logarithmic_ticks(self.from, self.to, DECADES),
        }
    }

    /// Returns the places of the ticks without text.
    pub fn minor(&self) -> Vec<f64> {
        match self.scale {
            Scale::Logarithmic => ticks::logarithmic_minor(self.from, self.to),
            Scale::Linear | Scale::Degrees => Vec::new(),
        }
    }
}

fn is_drawable(value: f64, scale: Scale) -> bool {
    value.abs() <= LARGEST_DRAWN && (scale != Scale::Logarithmic || value >= 1.0 / LARGEST_DRAWN)
}

fn pad_range(low: f64, high: f64, scale: Scale, margin: Margin) -> (f64, f64) {
    let part = if margin == Margin::Tight { 0.0 } else { PADDING };
    if scale == Scale::Logarithmic {
        let is_point = high <= low * (1.0 + LEAST_SPAN);
        // a single value stands in the middle of about a decade
        let room = if is_point { 3.0 } else { (high / low).powf(part) };
        return (low / room, high * room);
    }
    let span = high - low;
    let largest = low.abs().max(high.abs());
    let room = match (span > LEAST_SPAN * largest, largest > 0.0) {
        (true, _) => part * span,
        (false, true) => 0.5 * largest,
        (false, false) => 0.5,
    };
    (low - room, high + room)
}

impl Ranged for Ruler {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let place = self.place(*value).unwrap_or(0.0).clamp(-FARTHEST, FARTHEST);
        (f64::from(limit.0) + place * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            self.minor()
        } else {
            self.major().iter().map(|tick| tick.value).collect()
        }
    }

    fn range(&self) -> Range<f64> {
        self.from..self.to
    }
}

impl ValueFormatter<f64> for Ruler {
    fn format_ext(&self, value: &f64) -> String {
        self.major().into_iter().find(|tick| tick.value == *value).map(|tick| tick.text).unwrap_or_default()
    }
}
