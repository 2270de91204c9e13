//! Motion of a base in six degrees of freedom from sines and spectra of each axis.
//!
//! Translations are accelerations of the pivot in axes that do not turn, x forward and z up at the start; rotations are rates in axes of the
//! base. What the elevation axis feels of them follows from [`counterpoise_models::base_motion`]. All spectra are realised on one grid of
//! frequencies, so that they can be coherent: of each axis' variance the share sqrt(coherence) has phases that all axes have in common.

use std::f64::consts::TAU;

use counterpoise_models::base_motion::{Level, Traverse, from_inertial, motion_at_elevation_axis};
use counterpoise_recordings::Signals;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::spectrum::{
    MotionRealisation, MotionTone, PERIOD_S, SINES, check, check_density, frequency, power_in_band,
    range_error, sine_tones, sum, window,
};
use crate::{Error, Road, RoadColumn, RoadOrigin};

/// Motion of one axis, m/s^2 or rad/s.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct AxisMotion {
    /// Sines, each by amplitude and frequency in Hz.
    pub sines: Vec<[f64; 2]>,
    /// Points of the spectral density, each by frequency in Hz and density.
    pub psd: Vec<[f64; 2]>,
}

/// Motion of a base.
#[derive(Debug, Clone, PartialEq)]
pub struct SixAxes {
    /// Forward, to the left and up, m/s^2; then about the forward axis (the left side rises), nose-up and about the upward axis (to the left), rad/s.
    pub axes: [AxisMotion; 6],
    /// Coherence (magnitude squared) between the spectra of any two axes.
    pub coherence: f64,
    /// The ring on which the elevation axis stands.
    pub traverse: Traverse,
}

/// Samples of a base's motion: accelerations of the pivot in axes that do not turn (forward, to the left, up), m/s^2, and rates about the
/// base's axes (left side up, nose up, to the left), rad/s.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BaseSeries {
    pub(super) rows: Vec<[f64; 6]>,
    period_s: f64,
}

impl BaseSeries {
    /// Returns a base at rest.
    pub(super) fn at_rest(samples: usize, period_s: f64) -> Self {
        Self { rows: vec![[0.0; 6]; samples], period_s }
    }

    /// Sets one sample.
    pub(super) fn set(&mut self, k: usize, row: [f64; 6]) {
        self.rows[k] = row;
    }
}

/// Returns what the elevation axis feels of a base's motion.
pub(super) fn felt_road(
    origin: RoadOrigin,
    series: &BaseSeries,
    traverse: Traverse,
    gravity_m_s2: f64,
) -> Road {
    let accelerations: Vec<[f64; 3]> = series.rows.iter().map(|row| [row[0], row[1], row[2]]).collect();
    // nose-up is the negative sense about the axis to the left
    let rates: Vec<[f64; 3]> = series.rows.iter().map(|row| [row[3], -row[4], row[5]]).collect();
    let base = from_inertial(&accelerations, &rates, series.period_s, gravity_m_s2);
    let felt = motion_at_elevation_axis(&base, series.period_s, traverse, gravity_m_s2, Level::Known);
    let mut signals = Signals::with_room(felt.len(), RoadColumn::YawRate as usize + 1);
    for at in &felt {
        signals.push([
            at.heave_m_s2,
            at.pitch_rate_rad_s,
            at.surge_m_s2,
            at.roll_rate_rad_s,
            at.yaw_rate_rad_s,
        ]);
    }
    Road { origin, sample_period_s: series.period_s, signals }
}

/// Names of the axes of [`SixAxes`], in their order.
pub const AXES: [&str; 6] = ["surge", "sway", "heave", "roll", "pitch", "yaw"];
/// Stream of the phases that all axes have in common; those of the axes follow.
const COMMON_STREAM: u64 = 16;

impl SixAxes {
    /// Returns whether nothing moves.
    pub fn is_still(&self) -> bool {
        self.axes.iter().all(|axis| axis.sines.is_empty() && axis.psd.is_empty())
            && self.traverse.rate_rad_s == 0.0
    }

    /// Returns what the elevation axis feels of the motion, from rest to rest.
    ///
    /// # Errors
    /// [`Error::Range`] for a duration, fade, coherence, amplitude, frequency or density out of range.
    pub fn road(&self, how: MotionRealisation, gravity_m_s2: f64) -> Result<Road, Error> {
        let samples = check(how)?;
        self.check()?;
        let mut series = BaseSeries::at_rest(samples, PERIOD_S);
        for (axis, tones) in self.all_tones(how.seed).iter().enumerate() {
            for (k, row) in series.rows.iter_mut().enumerate() {
                let t = k as f64 * PERIOD_S;
                row[axis] = window(t, how)[0] * sum(tones, t)[0];
            }
        }
        let origin = RoadOrigin::SixAxes { seed: how.seed };
        Ok(felt_road(origin, &series, self.traverse, gravity_m_s2))
    }

    /// Checks the motion, without realising it.
    ///
    /// # Errors
    /// [`Error::Range`] for a coherence, amplitude, frequency or density out of range.
    pub fn check(&self) -> Result<(), Error> {
        if !(0.0..=1.0).contains(&self.coherence) {
            return Err(range_error("coherence", self.coherence, "from 0 to 1"));
        }
        // what a spectrum alone may not have, it may not have here
        self.axes.iter().try_for_each(|axis| check_density(&axis.psd))?;
        for [amplitude, hz] in self.axes.iter().flat_map(|axis| &axis.sines) {
            if !amplitude.is_finite() {
                return Err(range_error("amplitude of a sine", *amplitude, "finite"));
            }
            frequency(*hz)?;
        }
        Ok(())
    }

    fn all_tones(&self, seed: u64) -> Vec<Vec<MotionTone>> {
        let grid = self.grid();
        let common = phases(seed, COMMON_STREAM);
        let mut all = Vec::with_capacity(6);
        for (k, axis) in self.axes.iter().enumerate() {
            let mut tones = sine_tones(&axis.sines);
            if let (Some(grid), false) = (&grid, axis.psd.is_empty()) {
                let own = phases(seed, COMMON_STREAM + 1 + k as u64);
                tones.extend(self.realise_tones(&axis.psd, grid, &common, &own));
            }
            all.push(tones);
        }
        all
    }

    /// Lowest frequency of all spectra and the ratio from each line to the next; `None` without a spectrum.
    fn grid(&self) -> Option<Grid> {
        let mut band: Option<[f64; 2]> = None;
        for axis in self.axes.iter().filter(|axis| !axis.psd.is_empty()) {
            let (low, high) = (axis.psd[0][0], axis.psd[axis.psd.len() - 1][0]);
            band = Some(band.map_or([low, high], |[l, h]| [l.min(low), h.max(high)]));
        }
        band.map(|[low, high]| Grid { low_hz: low, ratio: (high / low).powf(1.0 / SINES as f64) })
    }

    fn realise_tones(&self, psd: &[[f64; 2]], grid: &Grid, common: &[f64], own: &[f64]) -> Vec<MotionTone> {
        let shared = self.coherence.sqrt();
        let mut tones = Vec::new();
        for k in 0..SINES {
            let low = grid.low_hz * grid.ratio.powi(k as i32);
            let amplitude = (2.0 * power_in_band(psd, low, low * grid.ratio)).sqrt();
            let rate_rad_s = TAU * low * grid.ratio.sqrt();
            for (share, phase_rad) in [(shared, common[k]), (1.0 - shared, own[k])] {
                if share * amplitude > 0.0 {
                    tones.push(MotionTone { rate_rad_s, amplitude: share.sqrt() * amplitude, phase_rad });
                }
            }
        }
        tones
    }
}

/// Frequencies of the lines of all spectra.
struct Grid {
    low_hz: f64,
    ratio: f64,
}

/// Phases of the lines of a spectrum, rad.
pub(super) fn phases(seed: u64, stream: u64) -> Vec<f64> {
    let mut source = ChaCha8Rng::seed_from_u64(seed);
    source.set_stream(stream);
    (0..SINES).map(|_| TAU * (source.next_u64() >> 11) as f64 / (1u64 << 53) as f64).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::signals::rms;

    const HOW: MotionRealisation = MotionRealisation { duration_s: 60.0, fade_s: 1.0, seed: 5 };
    const POINTS: [[f64; 2]; 2] = [[0.3, 0.1], [6.0, 0.1]];

    fn axes(coherence: f64) -> SixAxes {
        let mut axes: [AxisMotion; 6] = Default::default();
        axes[0].psd = POINTS.to_vec();
        axes[2].psd = POINTS.to_vec();
        SixAxes { axes, coherence, traverse: Traverse::default() }
    }

    #[test]
    fn heave_and_surge_are_as_coherent_as_is_asked() {
        for (coherence, low, high) in [(0.0, -0.2, 0.2), (0.49, 0.5, 0.9), (1.0, 0.9999, 1.0001)] {
            let road = axes(coherence).road(HOW, 9.81).unwrap();
            let surge = road.surge_m_s2();
            let both: f64 =
                road.heave_m_s2().iter().zip(surge).map(|(a, b)| a * b).sum::<f64>() / surge.len() as f64;
            let correlation = both / (rms(road.heave_m_s2()) * rms(surge));
            assert!((low..=high).contains(&correlation), "{coherence}: {correlation}");
            let variance = power_in_band(&POINTS, 0.0, 100.0);
            assert!((rms(surge).powi(2) / variance - 1.0).abs() < 0.25, "{}", rms(surge));
        }
    }

    #[test]
    fn roll_reaches_the_elevation_axis_through_gravity_alone() {
        let mut axes: [AxisMotion; 6] = Default::default();
        axes[3].sines = vec![[0.2, 0.5]];
        let motion = SixAxes { axes, coherence: 0.0, traverse: Traverse::default() };
        let road = motion.road(HOW, 9.81).unwrap();
        assert!(rms(road.pitch_rate_rad_s()) == 0.0 && rms(road.heave_m_s2()) > 0.01);
        assert!(road.heave_m_s2().iter().all(|heave| *heave <= 1e-9), "a tilted base feels less of gravity");
        assert!(rms(road.roll_rate_rad_s()) > 0.1);
    }

    #[test]
    fn nonsense_is_refused() {
        assert!(axes(1.5).road(HOW, 9.81).is_err());
        let mut bad = axes(0.0);
        bad.axes[4].sines = vec![[0.1, 80.0]];
        assert!(bad.road(HOW, 9.81).is_err());
        bad.axes[4].sines.clear();
        bad.axes[1].psd = vec![[2.0, 1.0], [1.0, 1.0]];
        assert!(bad.road(HOW, 9.81).is_err());
    }
}
