//! The derivatives of the sensors' readings: gain, bias and delay, but no rounding.
//!
//! Converters round what they read, and a rounded signal has no derivative. The derivatives are those of the signal before it is rounded; where
//! a reading or the control is at the end of the converter's range they are 0.

use super::direction::Family;
use super::stencil::{MEMBERS, Stencil};
use crate::sensing::AngleDifference;
use counterpoise_models::plant::{SensorErrors, SensorRegime};
use counterpoise_models::{CONVERTER_RANGE_V, LearnedPlace, Parameters, Plant, Sensor};

/// One sensor from the filtered truth to the reading.
#[derive(Debug, Clone)]
pub(crate) struct ReadingSlopes {
    sensor: Sensor,
    period_s: f64,
    delay_samples: f64,
    /// What differences the derivatives if the readings are differences of angles, direction by direction; otherwise empty.
    differences: Vec<AngleDifference>,
    /// Derivatives of gain, bias, sensitivity to heave, and delay in samples, direction by direction.
    own: Vec<[f64; 4]>,
    /// Errors that free functions give.
    errors: Option<SensorErrors>,
    /// Those of the members of each direction along which they differ.
    varied_errors: Vec<Option<VariedErrors>>,
    /// Values before the delay, and their derivatives.
    past: Vec<f64>,
    past_slopes: Vec<Vec<f64>>,
    held: Vec<f64>,
    sample: usize,
}

/// The errors of a sensor along a direction.
#[derive(Debug, Clone)]
struct VariedErrors {
    stencil: Stencil,
    members: [Option<SensorErrors>; MEMBERS],
}

/// A sensor of a machine as the derivatives take it.
pub(crate) struct ReadSensor {
    /// Returns it in a machine; `None` if the machine does not have it.
    pub of: fn(&Parameters) -> Option<&Sensor>,
    /// The place of its errors.
    pub place: LearnedPlace,
}

/// The truth that a sensor reads, with its derivatives direction by direction.
pub(crate) struct ReadTruth<'a> {
    /// The filtered truth.
    pub value: f64,
    /// Its derivatives.
    pub slopes: &'a [f64],
    /// Heave that the sensor feels, m/s^2.
    pub heave: f64,
    /// Angle of the hub on the platform, rad.
    pub hub_angle_rad: f64,
    /// Its derivatives.
    pub angle_slopes: &'a [f64],
}

impl VariedErrors {
    /// Returns the errors along a direction; `None` if they do not differ there.
    fn of(family: &Family, own: Option<&SensorErrors>, place: LearnedPlace) -> Option<Self> {
        let members = family.plants.each_ref().map(|plant| SensorErrors::of(plant.parameters(), place));
        let differ = members.iter().any(|member| member.as_ref() != own);
        differ.then_some(Self { stencil: family.stencil, members })
    }

    /// Returns the derivative of what they add to a reading.
    fn slope_at(&self, own: f64, at: &SensorRegime) -> f64 {
        let of = self.members.each_ref().map(|one| one.as_ref().map_or(0.0, |errors| errors.at(at)));
        self.stencil.derivative(own, of)
    }
}

impl ReadingSlopes {
    /// Returns the derivatives of a sensor that every member of the families has.
    pub fn new(plant: &Plant, families: &[Family], read: ReadSensor) -> Option<Self> {
        let ReadSensor { of: sensor, place } = read;
        let parameters = plant.parameters();
        let errors = SensorErrors::of(parameters, place);
        let own = sensor(parameters)?.clone();
        let period_s = parameters.interface.sample_period_s;
        let of = |plant: &Plant, number: fn(&Sensor) -> f64| sensor(plant.parameters()).map_or(0.0, number);
        let slopes = families.iter().map(|family| {
            let slope = |number: fn(&Sensor) -> f64| family.slope_of(plant, |member| of(member, number));
            [
                slope(|sensor| sensor.gain),
                slope(|sensor| sensor.bias),
                slope(|sensor| sensor.g_sensitivity),
                slope(|sensor| sensor.delay_s) / period_s,
            ]
        });
        Some(Self {
            delay_samples: own.delay_s / period_s,
            differences: AngleDifference::of(&own, period_s)
                .map_or_else(Vec::new, |one| vec![one; families.len()]),
            own: slopes.collect(),
            varied_errors: families.iter().map(|f| VariedErrors::of(f, errors.as_ref(), place)).collect(),
            errors,
            held: vec![0.0; families.len()],
            sensor: own,
            period_s,
            past: Vec::new(),
            past_slopes: Vec::new(),
            sample: 0,
        })
    }

    /// Returns the derivatives of a reading.
    pub fn read(&mut self, at: &ReadTruth) -> &[f64] {
        let sensor = &self.sensor;
        let ReadTruth { value: truth, slopes, heave, .. } = *at;
        let value = sensor.gain * truth + sensor.bias + sensor.g_sensitivity * heave;
        let own = self.own.iter().zip(slopes);
        let slopes: Vec<f64> = own
            .map(|([gain, bias, heaved, _], slope)| {
                sensor.gain * slope + gain * truth + bias + heaved * heave
            })
            .collect();
        let (value, slopes) = self.add_errors(at, value, slopes);
        let (reading, slopes) = self.delay_value(value, slopes);
        let slopes = match self.differences.is_empty() {
            true => slopes,
            false => {
                self.differences.iter_mut().zip(slopes).map(|(one, slope)| one.next(slope, |it| it)).collect()
            }
        };
        let is_at_end =
            self.sensor.resolution <= 0.0 && (reading * self.sensor.scale_v_unit).abs() >= CONVERTER_RANGE_V;
        if self.sample.is_multiple_of(self.sensor.samples_between_readings(self.period_s).max(1)) {
            self.held = if is_at_end { vec![0.0; slopes.len()] } else { slopes };
        }
        self.sample += 1;
        &self.held
    }

    /// Returns a value and its derivatives with the errors that free functions give.
    fn add_errors(&self, at: &ReadTruth, value: f64, mut slopes: Vec<f64>) -> (f64, Vec<f64>) {
        if self.errors.is_none() && self.varied_errors.iter().all(Option::is_none) {
            return (value, slopes);
        }
        let time_s = self.sample as f64 * self.period_s;
        let regime = SensorRegime { reading: value, hub_angle_rad: at.hub_angle_rad, time_s };
        let own = self.errors.as_ref().map_or(0.0, |errors| errors.at(&regime));
        let [by_reading, by_angle] =
            self.errors.as_ref().map_or([0.0; 2], |errors| errors.slopes_at(&regime));
        for (k, slope) in slopes.iter_mut().enumerate() {
            let varied = self.varied_errors[k].as_ref().map_or(0.0, |varied| varied.slope_at(own, &regime));
            *slope += by_reading * *slope + by_angle * at.angle_slopes[k] + varied;
        }
        (value + own, slopes)
    }

    /// Returns a value and its derivatives as they are after the delay.
    fn delay_value(&mut self, value: f64, slopes: Vec<f64>) -> (f64, Vec<f64>) {
        let is_varied = self.own.iter().any(|own| own[3] != 0.0);
        if self.delay_samples == 0.0 && !is_varied {
            return (value, slopes);
        }
        self.past.push(value);
        self.past_slopes.push(slopes);
        let last = self.past.len() - 1;
        let position = last as f64 - self.delay_samples;
        if position <= 0.0 {
            return (self.past[0], self.past_slopes[0].clone());
        }
        let (index, part) = (position as usize, position.fract());
        let next = (index + 1).min(last);
        // a whole number of samples is a corner of the straight lines between them: the mean of both slopes stands there
        let before = index.saturating_sub(usize::from(part == 0.0));
        let steepness = (self.past[next] - self.past[before]) / ((next - before).max(1) as f64);
        let slopes = (0..self.own.len()).map(|k| {
            let (from, to) = (self.past_slopes[index][k], self.past_slopes[next][k]);
            from + part * (to - from) - steepness * self.own[k][3]
        });
        (self.past[index] + part * (self.past[next] - self.past[index]), slopes.collect())
    }
}
