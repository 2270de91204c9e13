//! The numbers of a measured map as arrays, frequency by amplitude, and each of its points.

use counterpoise_linalg::C64;
use ndarray::{Array1, Array2};
use serde::{Serialize, Serializer};
use std::f64::consts::TAU;

/// The numbers of a map. Arrays of two dimensions are frequency x amplitude; a map of a recording has one amplitude at each
/// frequency, so its arrays have one column. Their JSON is a list of [`ResponseMapPoint`]s, amplitude by amplitude, frequency rising.
#[derive(Debug, Clone, PartialEq)]
pub struct MapPoints {
    /// Frequencies, Hz, moved so that whole cycles fill whole samples.
    pub frequency_hz: Array1<f64>,
    /// Whole cycles in the window at each frequency.
    pub cycles: Array1<usize>,
    /// The linear model without dry friction at each frequency.
    pub linear: Array1<C64>,
    /// The linear model with dry friction as its describing function, frequency x amplitude; see [`ResponseMapPoint::describing`].
    pub describing: Array2<Option<C64>>,
    /// Amplitudes of the excitation, in the input's unit, frequency x amplitude.
    pub amplitude: Array2<f64>,
    /// Responses, frequency x amplitude.
    pub response: Array2<C64>,
    /// Means of what is measured, in the output's unit, frequency x amplitude.
    pub mean: Array2<f64>,
    /// Harmonics from the second on over the fundamental, frequency x amplitude.
    pub distortion: Array2<f64>,
    /// Relative change of the response from the window before, frequency x amplitude; `None` on a recording.
    pub last_change: Option<Array2<f64>>,
    /// `true` if the motion had settled, or if the recording was excited, frequency x amplitude.
    pub settled: Array2<bool>,
}

/// One point of the map, with the numbers that its JSON has.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ResponseMapPoint {
    /// Amplitude of the excitation, in the input's unit.
    pub amplitude: f64,
    /// Frequency, Hz, moved so that whole cycles fill whole samples.
    pub frequency_hz: f64,
    /// Real and imaginary part of the response.
    pub response: [f64; 2],
    /// Gain, dB.
    pub gain_db: f64,
    /// Phase, degrees, from -180 to 180.
    pub phase_deg: f64,
    /// Mean of what is measured: of the hub rate, rad/s, in a loop of rate, otherwise in the output's unit.
    pub mean_rad_s: f64,
    /// Harmonics of what is measured from the second on, over its fundamental.
    pub distortion: f64,
    /// Whole cycles in the window.
    pub cycles: usize,
    /// Relative change of the response from the window before; none on a recording.
    pub last_change: Option<f64>,
    /// `true` if the motion had settled; on a recording, whether it was excited at this frequency at all.
    pub settled: bool,
    /// The linear model without dry friction.
    pub linear: [f64; 2],
    /// The linear model with dry friction as its describing function; `None` if there is no dry friction, or if the
    /// describing function finds no amplitude that repeats itself.
    pub describing: Option<[f64; 2]>,
}

impl MapPoints {
    /// Arranges what was found amplitude by amplitude, `frequencies` points each.
    pub(crate) fn of(found: &[ResponseMapPoint], frequencies: usize) -> Self {
        let amplitudes = found.len().checked_div(frequencies).unwrap_or(0);
        // frequency, cycles and linear model are the same at every amplitude
        let first = &found[..frequencies.min(found.len())];
        let at = |(frequency, amplitude): (usize, usize)| &found[amplitude * frequencies + frequency];
        let shape = (first.len(), amplitudes);
        let is_recorded = found.iter().any(|point| point.last_change.is_none());
        let last_change = |place| at(place).last_change.unwrap_or(f64::NAN);
        Self {
            frequency_hz: first.iter().map(|point| point.frequency_hz).collect(),
            cycles: first.iter().map(|point| point.cycles).collect(),
            linear: first.iter().map(|point| complex(point.linear)).collect(),
            describing: Array2::from_shape_fn(shape, |place| at(place).describing.map(complex)),
            amplitude: Array2::from_shape_fn(shape, |place| at(place).amplitude),
            response: Array2::from_shape_fn(shape, |place| complex(at(place).response)),
            mean: Array2::from_shape_fn(shape, |place| at(place).mean_rad_s),
            distortion: Array2::from_shape_fn(shape, |place| at(place).distortion),
            last_change: (!is_recorded).then(|| Array2::from_shape_fn(shape, last_change)),
            settled: Array2::from_shape_fn(shape, |place| at(place).settled),
        }
    }

    /// Returns the number of points.
    pub fn len(&self) -> usize {
        self.response.len()
    }

    /// Returns whether the map has no points.
    pub fn is_empty(&self) -> bool {
        self.response.is_empty()
    }

    /// Returns the number of amplitudes; 1 for a recording.
    pub fn amplitudes(&self) -> usize {
        self.response.ncols()
    }

    /// Returns the point of a frequency and an amplitude, by their numbers.
    pub fn at(&self, frequency: usize, amplitude: usize) -> ResponseMapPoint {
        let place = (frequency, amplitude);
        let response = self.response[place];
        ResponseMapPoint {
            amplitude: self.amplitude[place],
            frequency_hz: self.frequency_hz[frequency],
            response: pair(response),
            gain_db: gain_db(response),
            phase_deg: phase_deg(response),
            mean_rad_s: self.mean[place],
            distortion: self.distortion[place],
            cycles: self.cycles[frequency],
            last_change: self.last_change.as_ref().map(|change| change[place]),
            settled: self.settled[place],
            linear: pair(self.linear[frequency]),
            describing: self.describing[place].map(pair),
        }
    }

    /// Returns the points of an amplitude, frequency rising.
    pub fn of_amplitude(&self, amplitude: usize) -> impl Iterator<Item = ResponseMapPoint> + '_ {
        (0..self.response.nrows()).map(move |frequency| self.at(frequency, amplitude))
    }

    /// Returns all points: amplitude by amplitude, frequency rising.
    pub fn iter(&self) -> impl Iterator<Item = ResponseMapPoint> + '_ {
        (0..self.amplitudes()).flat_map(|amplitude| self.of_amplitude(amplitude))
    }

    /// Returns the frequencies, rad/s.
    pub fn frequency_rad_s(&self) -> Array1<f64> {
        self.frequency_hz.mapv(|hz| TAU * hz)
    }

    /// Returns the moduli of the responses, frequency x amplitude.
    pub fn modulus(&self) -> Array2<f64> {
        self.response.mapv(C64::norm)
    }

    /// Returns the moduli of the linear model without dry friction at each frequency.
    pub fn linear_modulus(&self) -> Array1<f64> {
        self.linear.mapv(C64::norm)
    }

    /// Returns the gains, dB, frequency x amplitude: -infinity if nothing moves.
    pub fn gain_db(&self) -> Array2<f64> {
        self.response.mapv(gain_db)
    }
}

impl Serialize for MapPoints {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.iter())
    }
}

/// Returns the gain of a response, dB: 20 log10 |h|.
pub(super) fn gain_db(h: C64) -> f64 {
    20.0 * h.norm().log10()
}

/// Returns the phase of a response, degrees, from -180 to 180.
pub(super) fn phase_deg(h: C64) -> f64 {
    h.arg().to_degrees()
}

fn complex([re, im]: [f64; 2]) -> C64 {
    C64::new(re, im)
}

pub(super) fn pair(value: C64) -> [f64; 2] {
    [value.re, value.im]
}
