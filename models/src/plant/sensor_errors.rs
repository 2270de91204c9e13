//! Errors of a sensor that free functions give: what they add to its reading.

use super::free_functions::LearnedTable;
use crate::parameters::{LearnedPlace, Parameters, RegimeVariable};
use crate::tolerance::{READING_ITERATIONS, READING_ROUNDING};

/// The errors of one sensor, ready for evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorErrors {
    all: Vec<SensorError>,
}

/// One error of a sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorError {
    /// The variable that it is a function of.
    pub variable: RegimeVariable,
    /// Values.
    pub table: LearnedTable,
}

/// The regime variables of a sensor.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SensorRegime {
    /// What it would read without the errors, in its unit.
    pub reading: f64,
    /// Angle of the hub on the platform, rad.
    pub hub_angle_rad: f64,
    /// Time since the start, s.
    pub time_s: f64,
}

impl SensorErrors {
    /// Returns the errors of a machine's sensor; `None` if it has none.
    pub fn of(parameters: &Parameters, place: LearnedPlace) -> Option<Self> {
        let here = parameters.learned.iter().filter(|element| element.place == place && place.is_sensor());
        let all = here.filter_map(|element| {
            Some(SensorError { variable: element.variable, table: LearnedTable::new(element)? })
        });
        let all: Vec<SensorError> = all.collect();
        (!all.is_empty()).then_some(Self { all })
    }

    /// Returns the errors, in the order of the machine's elements.
    pub fn iter(&self) -> impl Iterator<Item = &SensorError> {
        self.all.iter()
    }

    /// Returns what they add to the reading, in its unit.
    #[inline]
    pub fn at(&self, at: &SensorRegime) -> f64 {
        self.all.iter().map(|error| error.table.at(error.variable(at))).sum()
    }

    /// Returns the derivatives of what they add by the reading and by the hub's angle.
    pub fn slopes_at(&self, at: &SensorRegime) -> [f64; 2] {
        let slope = |error: &SensorError| error.table.slope_at(error.variable(at));
        self.all.iter().fold([0.0; 2], |[reading, angle], error| match error.variable {
            RegimeVariable::Reading => [reading + slope(error), angle],
            RegimeVariable::Angle | RegimeVariable::Turn => [reading, angle + slope(error)],
            _ => [reading, angle],
        })
    }

    /// Returns the reading without the errors from one that has them, by iteration; nearly the one with them where the errors leave no trace of it.
    pub fn corrected_reading(&self, read: f64, time_s: f64) -> f64 {
        let mut found = read;
        for _ in 0..READING_ITERATIONS {
            let next = read - self.at(&SensorRegime { reading: found, hub_angle_rad: 0.0, time_s });
            let is_still = (next - found).abs() <= READING_ROUNDING * next.abs();
            found = next;
            if is_still {
                break;
            }
        }
        found
    }
}

impl SensorError {
    fn variable(&self, at: &SensorRegime) -> f64 {
        match self.variable {
            RegimeVariable::Angle | RegimeVariable::Turn => at.hub_angle_rad,
            RegimeVariable::Time => at.time_s,
            _ => at.reading,
        }
    }
}
