//! The derivatives of the sensors' readings: gain, bias and delay, but no rounding.
//!
//! Converters round what they read, and a rounded signal has no derivative. The derivatives are those of the signal before it is rounded; where
//! a reading or the control is at the end of the converter's range they are 0.

use super::direction::Family;
use counterpoise_models::{CONVERTER_RANGE_V, Parameters, Plant, Sensor};

/// One sensor from the filtered truth to the reading.
#[derive(Debug, Clone)]
pub(crate) struct ReadingSlopes {
    sensor: Sensor,
    period_s: f64,
    delay_samples: f64,
    /// Derivatives of gain, bias, sensitivity to heave, and delay in samples, direction by direction.
    own: Vec<[f64; 4]>,
    /// Values before the delay, and their derivatives.
    past: Vec<f64>,
    past_slopes: Vec<Vec<f64>>,
    held: Vec<f64>,
    sample: usize,
}

impl ReadingSlopes {
    /// Returns the derivatives of a sensor that every member of the families has.
    pub fn new(
        plant: &Plant,
        families: &[Family],
        sensor: impl Fn(&Parameters) -> Option<&Sensor>,
    ) -> Option<Self> {
        let parameters = plant.parameters();
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
            own: slopes.collect(),
            held: vec![0.0; families.len()],
            sensor: own,
            period_s,
            past: Vec::new(),
            past_slopes: Vec::new(),
            sample: 0,
        })
    }

    /// Returns the derivatives of a reading from a truth, its derivatives, and the heave that the sensor feels.
    pub fn read(&mut self, truth: f64, slopes: &[f64], heave: f64) -> &[f64] {
        let sensor = &self.sensor;
        let value = sensor.gain * truth + sensor.bias + sensor.g_sensitivity * heave;
        let own = self.own.iter().zip(slopes);
        let slopes: Vec<f64> = own
            .map(|([gain, bias, heaved, _], slope)| {
                sensor.gain * slope + gain * truth + bias + heaved * heave
            })
            .collect();
        let (reading, slopes) = self.delay_value(value, slopes);
        let is_at_end =
            self.sensor.resolution <= 0.0 && (reading * self.sensor.scale_v_unit).abs() >= CONVERTER_RANGE_V;
        if self.sample.is_multiple_of(self.sensor.samples_between_readings(self.period_s).max(1)) {
            self.held = if is_at_end { vec![0.0; slopes.len()] } else { slopes };
        }
        self.sample += 1;
        &self.held
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
