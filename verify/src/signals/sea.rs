//! Motion of a ship in irregular waves.
//!
//! Long-crested waves of a Pierson-Moskowitz or JONSWAP spectrum act on a box-shaped hull in deep water. Heave and pitch follow the
//! closed-form operators of J. Jensen, A. Mansour and A. Olsen (Estimation of ship motions using closed-form expressions, Ocean Engineering
//! 31, 2004); the phase of their f is that of a force by the relative motion of hull and water, so that a small float stays on the
//! surface. Roll is an oscillator that the slope of the waves drives; surge and sway are the mean acceleration of
//! the water about the hull. With wave number k = w^2/g, heading b, encounter frequency w_e = w - k V cos b and a = w_e/w:
//!
//! ```text
//!     (1 - 2 k T a^2 + j d a) z     = A F,     F = e^(-|k cos b| T) f sin(x)/x,               x = |k cos b| L / 2
//!     (1 - 2 k T a^2 + j d a) theta = -j A G,  G = e^(-|k cos b| T) f 3 k cos b (sin x - x cos x)/x^3
//!     d = k B a (sin y / y)^2 e^(-2 k T a^2),  y = k B a^2 / 2,   f = 1 - k T + j d
//! ```

use std::f64::consts::TAU;

use counterpoise_linalg::C64;
use counterpoise_models::base_motion::Traverse;

use super::six_axes::{BaseSeries, felt_road, phases};
use super::spectrum::{MotionRealisation, SINES, check, range_error, window};
use crate::tolerance::{SINC_SERIES, SLOPE_FACTOR_SERIES};
use crate::{Error, Road, RoadOrigin};

/// Shape of the spectrum of the waves' height.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WaveShape {
    /// A fully developed sea: Pierson and Moskowitz 1964, by height and peak period (Bretschneider's form).
    PiersonMoskowitz,
    /// A growing sea: the same with a peak 3.3 times as high (Hasselmann et al., JONSWAP, 1973).
    Jonswap,
}

/// The waves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waves {
    /// Shape of the spectrum.
    pub shape: WaveShape,
    /// Significant height, four times the standard deviation, m.
    pub significant_height_m: f64,
    /// Period of the peak of the spectrum, s.
    pub peak_period_s: f64,
    /// Angle from the ship's course to the direction in which the waves go, rad: 0 with the ship, pi against it, pi/2 from its right side.
    pub heading_rad: f64,
}

/// The ship.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ship {
    /// Length of the waterline, m.
    pub length_m: f64,
    /// Beam, m.
    pub beam_m: f64,
    /// Draught, m.
    pub draught_m: f64,
    /// Speed, m/s.
    pub speed_m_s: f64,
    /// Natural period of roll, s.
    pub roll_period_s: f64,
    /// Damping ratio of roll.
    pub roll_damping: f64,
    /// Place of the pivot from the middle of the waterline: forward, to the left, up, m.
    pub pivot_m: [f64; 3],
}

/// A ship in a sea.
#[derive(Debug, Clone, PartialEq)]
pub struct Sea {
    /// The waves.
    pub waves: Waves,
    /// The ship.
    pub ship: Ship,
    /// The ring on which the elevation axis stands.
    pub traverse: Traverse,
}

/// Period of the samples, s: ships hardly move above 1 Hz.
const SEA_PERIOD_S: f64 = 0.01;
/// The band that is realised, over the frequency of the peak: a thousandth of the variance lies above, nothing below.
const BAND: [f64; 2] = [0.5, 6.0];
/// Stream of the waves' phases.
const WAVE_STREAM: u64 = 32;
/// The peak of a JONSWAP spectrum over that of a Pierson-Moskowitz spectrum, and its widths below and above.
const PEAKEDNESS: f64 = 3.3;
const WIDTHS: [f64; 2] = [0.07, 0.09];

/// One wave: frequency in rad/s in the earth's frame, and amplitude in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wave {
    /// Frequency for an observer at rest, rad/s.
    pub rate_rad_s: f64,
    /// Amplitude, m.
    pub amplitude_m: f64,
}

impl Waves {
    /// Returns the waves that realise the spectrum: their variances add up to that of the significant height.
    pub fn realise(&self) -> Vec<Wave> {
        let peak = TAU / self.peak_period_s;
        let ratio = (BAND[1] / BAND[0]).powf(1.0 / SINES as f64);
        let below = |over: f64| (-1.25 * over.powi(-4)).exp();
        let share = |k: usize| {
            let low = BAND[0] * ratio.powi(k as i32);
            let middle = low * ratio.sqrt();
            (middle, (below(low * ratio) - below(low)) * self.enhancement(middle))
        };
        let total: f64 = (0..SINES).map(|k| share(k).1).sum();
        let variance = self.significant_height_m.powi(2) / 16.0;
        let wave = |k: usize| {
            let (middle, part) = share(k);
            Wave { rate_rad_s: peak * middle, amplitude_m: (2.0 * variance * part / total).sqrt() }
        };
        (0..SINES).map(wave).collect()
    }

    fn enhancement(&self, over_peak: f64) -> f64 {
        if self.shape == WaveShape::PiersonMoskowitz {
            return 1.0;
        }
        let width = if over_peak <= 1.0 { WIDTHS[0] } else { WIDTHS[1] };
        PEAKEDNESS.powf((-0.5 * ((over_peak - 1.0) / width).powi(2)).exp())
    }
}

/// Complex amplitudes of a ship's motion for a wave of 1 m, in level axes at the pivot: accelerations forward, to the left and up, m/s^2;
/// then roll (left side up), pitch (nose up) and yaw rate, rad/s.
pub type Operators = [C64; 6];

impl Ship {
    /// Returns the frequency at which the ship meets a wave, rad/s; negative where it overtakes the wave.
    pub fn encounter_rad_s(&self, rate_rad_s: f64, heading_rad: f64, gravity_m_s2: f64) -> f64 {
        rate_rad_s - rate_rad_s * rate_rad_s / gravity_m_s2 * self.speed_m_s * heading_rad.cos()
    }

    /// Returns the operators for waves of a frequency (for an observer at rest) and a heading.
    pub fn operators(&self, rate_rad_s: f64, heading_rad: f64, gravity_m_s2: f64) -> Operators {
        let j = C64::new(0.0, 1.0);
        let k = rate_rad_s * rate_rad_s / gravity_m_s2;
        let (along, across) = (k * heading_rad.cos(), k * heading_rad.sin());
        let met = self.encounter_rad_s(rate_rad_s, heading_rad, gravity_m_s2);
        let a = met / rate_rad_s;
        let (draught, beam) = (self.draught_m, self.beam_m);
        let damping =
            k * beam * a * sinc(0.5 * k * beam * a * a).powi(2) * (-2.0 * k * draught * a * a).exp();
        let dynamics = C64::new(1.0 - 2.0 * k * draught * a * a, damping * a);
        let reduction = (-along.abs() * draught).exp() * C64::new(1.0 - k * draught, damping);
        let half = 0.5 * along * self.length_m;
        let heave = reduction * sinc(half) / dynamics;
        let pitch = -j * reduction * along * slope_factor(half) / dynamics;
        let felt = (-0.5 * k * draught).exp() * sinc(half) * sinc(0.5 * across * beam);
        let relative = met * self.roll_period_s / TAU;
        let roll_dynamics = C64::new(1.0 - relative * relative, 2.0 * self.roll_damping * relative);
        let roll = -j * across * felt / roll_dynamics;
        let [x, y, z] = self.pivot_m;
        let twice = -met * met;
        [
            j * gravity_m_s2 * along * felt - twice * z * pitch,
            j * gravity_m_s2 * across * felt - twice * z * roll,
            twice * (heave + y * roll + x * pitch),
            j * met * roll,
            j * met * pitch,
            C64::new(0.0, 0.0),
        ]
    }
}

fn sinc(x: f64) -> f64 {
    if x.abs() < SINC_SERIES { 1.0 - x * x / 6.0 } else { x.sin() / x }
}

/// 3 (sin x - x cos x) / x^3, which is 1 for long waves.
fn slope_factor(x: f64) -> f64 {
    if x.abs() < SLOPE_FACTOR_SERIES { 1.0 - x * x / 10.0 } else { 3.0 * (x.sin() - x * x.cos()) / x.powi(3) }
}

impl Sea {
    /// Returns what the elevation axis feels of the ship's motion, from rest to rest.
    ///
    /// # Errors
    /// [`Error::Range`] for a height, period, size, damping, speed or duration out of range.
    pub fn road(&self, how: MotionRealisation, gravity_m_s2: f64) -> Result<Road, Error> {
        check(how)?;
        self.check()?;
        let (waves, phases) = (self.waves.realise(), phases(how.seed, WAVE_STREAM));
        let heading = self.waves.heading_rad;
        let mut tones: Vec<(f64, Operators)> = Vec::with_capacity(waves.len());
        for (wave, phase_rad) in waves.iter().zip(phases) {
            let phasor = C64::from_polar(wave.amplitude_m, phase_rad);
            let operators = self.ship.operators(wave.rate_rad_s, heading, gravity_m_s2);
            let met = self.ship.encounter_rad_s(wave.rate_rad_s, heading, gravity_m_s2);
            tones.push((met, operators.map(|operator| operator * phasor)));
        }
        let samples = (how.duration_s / SEA_PERIOD_S).round() as usize + 1;
        let mut series = BaseSeries::at_rest(samples, SEA_PERIOD_S);
        for k in 0..samples {
            let time_s = k as f64 * SEA_PERIOD_S;
            let faded = window(time_s, how)[0];
            let mut now = [0.0; 6];
            for (rate, amplitudes) in &tones {
                let turned = C64::from_polar(1.0, rate * time_s);
                (0..6).for_each(|axis| now[axis] += (amplitudes[axis] * turned).re);
            }
            series.set(k, now.map(|value| faded * value));
        }
        let significant_height_m = self.waves.significant_height_m;
        let origin = RoadOrigin::Sea { significant_height_m, seed: how.seed };
        Ok(felt_road(origin, &series, self.traverse, gravity_m_s2))
    }

    /// Checks waves and ship, without realising their motion.
    ///
    /// # Errors
    /// [`Error::Range`] for a height, period, size, damping or speed out of range.
    pub fn check(&self) -> Result<(), Error> {
        let (waves, ship) = (&self.waves, &self.ship);
        for (what, value) in [
            ("significant height in m", waves.significant_height_m),
            ("peak period in s", waves.peak_period_s),
            ("length of the ship in m", ship.length_m),
            ("beam of the ship in m", ship.beam_m),
            ("draught of the ship in m", ship.draught_m),
            ("roll period in s", ship.roll_period_s),
            ("damping ratio of roll", ship.roll_damping),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(range_error(what, value, "positive"));
            }
        }
        for (what, value, most) in [
            ("speed of the ship in m/s", ship.speed_m_s, 40.0),
            ("heading of the waves in rad", waves.heading_rad.abs(), TAU),
        ] {
            if !(0.0..=most).contains(&value) {
                return Err(range_error(what, value, "a ship's"));
            }
        }
        // steeper waves break: the significant steepness of an open sea stays below 1/7 of the wave's length (Miche 1944)
        let length_m = 9.81 * waves.peak_period_s.powi(2) / TAU;
        if waves.significant_height_m > length_m / 7.0 {
            return Err(range_error(
                "significant height in m",
                waves.significant_height_m,
                "at most a seventh of the length of the waves at the peak, g T^2 / (2 pi)",
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::signals::rms;
    use std::f64::consts::PI;

    const G: f64 = 9.80665;
    const HOW: MotionRealisation = MotionRealisation { duration_s: 300.0, fade_s: 1.0, seed: 3 };

    fn sea(shape: WaveShape, heading_rad: f64) -> Sea {
        Sea {
            waves: Waves { shape, significant_height_m: 2.5, peak_period_s: 8.8, heading_rad },
            ship: Ship {
                length_m: 100.0,
                beam_m: 14.0,
                draught_m: 4.5,
                speed_m_s: 7.0,
                roll_period_s: 9.0,
                roll_damping: 0.1,
                pivot_m: [0.0; 3],
            },
            traverse: Traverse::default(),
        }
    }

    #[test]
    fn the_waves_have_the_variance_and_the_peak_of_their_spectrum() {
        for shape in [WaveShape::PiersonMoskowitz, WaveShape::Jonswap] {
            let waves = sea(shape, PI).waves;
            let all = waves.realise();
            let variance: f64 = all.iter().map(|wave| 0.5 * wave.amplitude_m.powi(2)).sum();
            assert!((variance / (2.5 * 2.5 / 16.0) - 1.0).abs() < 1e-12);
            // the lines are even in the logarithm: density times frequency
            let density = |wave: &Wave| wave.amplitude_m.powi(2) / wave.rate_rad_s;
            let highest = all.iter().max_by(|a, b| density(a).total_cmp(&density(b))).unwrap();
            assert!((highest.rate_rad_s * 8.8 / TAU - 1.0).abs() < 0.02, "{}", highest.rate_rad_s);
        }
    }

    #[test]
    fn a_small_float_follows_the_surface_of_long_waves() {
        // waves of 8.8 s are 120 m long: a raft of 0.5 m stays on them and takes their slope
        let ship = Ship {
            length_m: 0.5,
            beam_m: 0.5,
            draught_m: 0.01,
            speed_m_s: 0.0,
            roll_period_s: 0.05,
            roll_damping: 0.7,
            pivot_m: [0.0; 3],
        };
        let w = TAU / 8.8;
        let k = w * w / G;
        for heading in [0.0, 0.9, PI / 2.0, PI] {
            let found = ship.operators(w, heading, G);
            let slope = C64::new(0.0, -k);
            let expected = [
                -G * slope * heading.cos(),
                -G * slope * heading.sin(),
                C64::new(-w * w, 0.0),
                C64::new(0.0, w) * slope * heading.sin(),
                C64::new(0.0, w) * slope * heading.cos(),
                C64::new(0.0, 0.0),
            ];
            for (found, expected) in found.iter().zip(expected) {
                let allowed = 0.02 * expected.norm().max(0.01 * w * w);
                assert!((found - expected).norm() < allowed, "{heading}: {found} {expected}");
            }
        }
    }

    #[test]
    fn a_place_away_from_the_middle_moves_with_the_rotation() {
        let mut ship = sea(WaveShape::Jonswap, PI).ship;
        let (w, heading) = (0.8, 2.4);
        let middle = ship.operators(w, heading, G);
        ship.pivot_m = [30.0, -3.0, 12.0];
        let away = ship.operators(w, heading, G);
        let j = C64::new(0.0, 1.0);
        let met = ship.encounter_rad_s(w, heading, G);
        let turn = [j * met * middle[3], j * met * middle[4]];
        assert!((away[2] - middle[2] - (30.0 * turn[1] - 3.0 * turn[0])).norm() < 1e-12);
        assert!((away[0] - middle[0] + 12.0 * turn[1]).norm() < 1e-12);
        assert!((away[1] - middle[1] + 12.0 * turn[0]).norm() < 1e-12);
        assert_eq!(away[3..], middle[3..]);
    }

    #[test]
    fn the_axis_feels_what_the_operators_say_and_head_seas_do_not_roll() {
        let motion = sea(WaveShape::PiersonMoskowitz, PI);
        let road = motion.road(HOW, G).unwrap();
        let waves = motion.waves.realise();
        let expected = |axis: usize| {
            let one = |wave: &Wave| {
                0.5 * (motion.ship.operators(wave.rate_rad_s, PI, G)[axis] * wave.amplitude_m).norm_sqr()
            };
            waves.iter().map(one).sum::<f64>().sqrt()
        };
        // four realisations of 50 waves each know an RMS to about 4 %
        let pooled = |column: fn(&Road) -> &[f64]| {
            let square =
                |seed| rms(column(&motion.road(MotionRealisation { seed, ..HOW }, G).unwrap())).powi(2);
            ((1..5).map(square).sum::<f64>() / 4.0).sqrt()
        };
        let (pitch, heave) = (pooled(Road::pitch_rate_rad_s), pooled(Road::heave_m_s2));
        assert!((pitch / expected(4) - 1.0).abs() < 0.1, "{pitch} {}", expected(4));
        // the axis also feels that the base tilts: by (1 - cos) alone, which is small
        assert!((heave / expected(2) - 1.0).abs() < 0.1, "{heave} {}", expected(2));
        assert!(rms(road.roll_rate_rad_s()) < 1e-12);
        let beam = sea(WaveShape::PiersonMoskowitz, PI / 2.0).road(HOW, G).unwrap();
        assert!(rms(beam.roll_rate_rad_s()) > 0.02);
        assert_eq!(motion.road(HOW, G).unwrap().heave_m_s2(), road.heave_m_s2());
        assert_eq!((road.heave_m_s2()[0], road.pitch_rate_rad_s()[0]), (0.0, 0.0));
    }

    #[test]
    fn a_sea_that_would_break_and_a_ship_without_size_are_refused() {
        let mut steep = sea(WaveShape::Jonswap, 0.0);
        steep.waves.peak_period_s = 3.0;
        assert!(steep.road(HOW, G).is_err());
        let mut flat = sea(WaveShape::Jonswap, 0.0);
        flat.ship.draught_m = 0.0;
        assert!(flat.road(HOW, G).is_err());
        // a ship as fast as the waves meets them at no frequency, and nothing becomes infinite
        let mut surfing = sea(WaveShape::Jonswap, 0.0);
        surfing.ship.speed_m_s = 8.8 * G / TAU;
        assert!(surfing.road(HOW, G).unwrap().heave_m_s2().iter().all(|heave| heave.is_finite()));
    }
}
