//! The procedure of a verification: the step, the platform's motion, the frequencies that are looked at.

use counterpoise_models::plant::{FrictionLinearisation, OperatingPoint};
use counterpoise_recordings::{ColumnName, Signals};
use counterpoise_simulate::Signal;

use crate::road_class::RoadClass;
use crate::signals::{check_finite, rms};
use crate::{Error, LineOfSight, Source};

/// Everything that a verification does.
#[derive(Debug, Clone, PartialEq)]
pub struct Procedure {
    /// Operating point of the mechanism.
    pub operating_point: OperatingPoint,
    /// Linear replacement of dry friction.
    pub friction: FrictionLinearisation,
    /// The step of the demand.
    pub step: Step,
    /// A triangle of the demand, where one is run; it lasts as long as the platform heaves.
    pub triangle: Option<Triangle>,
    /// Heave, m/s^2.
    pub heave: Sine,
    /// Pitch rate, rad/s.
    pub pitch: Sine,
    /// The platform's motion on a road, where there is one.
    pub road: Option<Road>,
    /// Duration of heave and pitch of the platform, s.
    pub duration_s: f64,
    /// Statistics leave out this much at the beginning, for what starts abruptly rings; on the nonlinear plant the step comes
    /// after it, s.
    pub settle_s: f64,
    /// Frequencies at which the rejection ratio is tabulated, Hz.
    pub rejection_hz: Vec<f64>,
    /// Seed of the sensor noise.
    pub seed: u64,
    /// Options for the figures of the line of sight; `None` if no figure of it is required.
    pub line_of_sight: Option<LineOfSight>,
}

/// A step of the demanded hub rate from rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Height, rad/s.
    pub rate_rad_s: f64,
    /// Length of the record after the step, s.
    pub duration_s: f64,
}

/// A triangle wave of the demanded hub rate that starts at zero and rises: with it, control against rate shows out-of-balance, friction and
/// inertia.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangle {
    /// Peak rate, rad/s.
    pub rate_rad_s: f64,
    /// Period, s.
    pub period_s: f64,
}

/// A sine that starts at zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sine {
    /// Amplitude, in the unit of what it drives.
    pub amplitude: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
}

/// A column of the signals of a [`Road`]. A motion of heave and pitch alone ends before [`RoadColumn::Surge`]; the others are in axes that do not
/// turn about the elevation axis ([`counterpoise_models::base_motion`] defines them).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RoadColumn {
    /// Heave at the pivot, m/s^2, gravity removed.
    Heave,
    /// Pitch rate, rad/s.
    PitchRate,
    /// Surge: forward acceleration of the pivot, m/s^2.
    Surge,
    /// Rate about the forward axis, rad/s.
    RollRate,
    /// Rate about the upward axis, rad/s.
    YawRate,
}

impl RoadColumn {
    /// The columns beside heave and pitch.
    pub const FURTHER: [Self; 3] = [Self::Surge, Self::RollRate, Self::YawRate];
}

impl ColumnName for RoadColumn {
    fn index(self) -> usize {
        self as usize
    }
}

/// Source of a platform motion.
#[derive(Debug, Clone, PartialEq)]
pub enum RoadOrigin {
    /// A recording, by the name of its file.
    Recording(String),
    /// A drive over a road of a class of ISO 8608.
    IsoRoad {
        /// Roughness of the road.
        class: RoadClass,
        /// Speed of the vehicle, m/s.
        speed_m_s: f64,
    },
    /// A ship at sea.
    Sea {
        /// Significant height of the waves, m.
        significant_height_m: f64,
        /// Seed of the phases.
        seed: u64,
    },
    /// Spectra of six axes.
    SixAxes {
        /// Seed of the phases.
        seed: u64,
    },
    /// Spectra of heave and pitch.
    Spectrum {
        /// Seed of the phases.
        seed: u64,
    },
    /// A platform motion simulator that only pitches.
    MotionSimulator {
        /// Distance of the mechanism's pivot in front of its axis, m.
        offset_m: f64,
    },
}

/// Platform motion in samples of one period, straight lines between.
#[derive(Debug, Clone, PartialEq)]
pub struct Road {
    /// Source.
    pub origin: RoadOrigin,
    /// Sample period, s.
    pub sample_period_s: f64,
    /// The samples.
    pub signals: Signals<RoadColumn>,
}

impl Default for Procedure {
    /// A step of 0.1 rad/s, heave of 2 m/s^2 at 1.5 Hz, pitch of 0.2 rad/s at 1 Hz, 10 s each, level, without a road.
    fn default() -> Self {
        Self {
            operating_point: OperatingPoint::default(),
            friction: FrictionLinearisation::Viscous,
            step: Step { rate_rad_s: 0.1, duration_s: 3.0 },
            triangle: None,
            heave: Sine { amplitude: 2.0, frequency_hz: 1.5 },
            pitch: Sine { amplitude: 0.2, frequency_hz: 1.0 },
            road: None,
            duration_s: 10.0,
            settle_s: 2.0,
            rejection_hz: vec![0.3, 1.0, 1.5, 3.0, 5.0],
            seed: 1,
            line_of_sight: None,
        }
    }
}

impl Triangle {
    /// Returns the demand as a signal.
    pub fn signal(&self) -> Signal {
        Signal::Triangle { amplitude: self.rate_rad_s, period_s: self.period_s }
    }
}

impl Sine {
    /// Returns the value at a time.
    pub fn at(&self, time_s: f64) -> f64 {
        self.amplitude * (std::f64::consts::TAU * self.frequency_hz * time_s).sin()
    }
}

/// The motion of the platform that the linear plant takes, at a time.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct HeaveAndPitch {
    /// Heave, m/s^2.
    pub heave_m_s2: f64,
    /// Pitch rate, rad/s.
    pub pitch_rate_rad_s: f64,
}

impl Road {
    /// Returns the duration, s.
    pub fn duration_s(&self) -> f64 {
        self.signals.len().saturating_sub(1) as f64 * self.sample_period_s
    }

    /// Returns the heave at the pivot, m/s^2, gravity removed.
    pub fn heave_m_s2(&self) -> &[f64] {
        self.signals.column(RoadColumn::Heave)
    }

    /// Returns the pitch rate, rad/s.
    pub fn pitch_rate_rad_s(&self) -> &[f64] {
        self.signals.column(RoadColumn::PitchRate)
    }

    /// Returns the RMS of the heave, m/s^2.
    pub fn heave_rms_m_s2(&self) -> f64 {
        rms(self.heave_m_s2())
    }

    /// Returns the RMS of the pitch rate, rad/s.
    pub fn pitch_rms_rad_s(&self) -> f64 {
        rms(self.pitch_rate_rad_s())
    }

    /// Returns the surge, m/s^2; no sample if the platform does nothing but heave and pitch.
    pub fn surge_m_s2(&self) -> &[f64] {
        self.signals.column(RoadColumn::Surge)
    }

    /// Returns the rate about the forward axis, rad/s; no sample if the platform does nothing but heave and pitch.
    pub fn roll_rate_rad_s(&self) -> &[f64] {
        self.signals.column(RoadColumn::RollRate)
    }

    /// Returns the rate about the upward axis, rad/s; no sample if the platform does nothing but heave and pitch.
    pub fn yaw_rate_rad_s(&self) -> &[f64] {
        self.signals.column(RoadColumn::YawRate)
    }

    /// Returns whether the platform surges, rolls and yaws too.
    pub fn has_further_motion(&self) -> bool {
        self.signals.has(RoadColumn::YawRate)
    }

    /// Returns the surge at a time, m/s^2; 0 outside the record and if there is none.
    pub fn surge_at(&self, time_s: f64) -> f64 {
        self.interpolate(self.surge_m_s2(), time_s)
    }

    /// The value of a column of the road at a time; 0 outside the record.
    pub(crate) fn interpolate(&self, column: &[f64], time_s: f64) -> f64 {
        interpolate_series(column, time_s / self.sample_period_s)
    }

    /// Returns the heave and pitch rate at a time; 0 outside the record.
    pub fn at(&self, time_s: f64) -> HeaveAndPitch {
        HeaveAndPitch {
            heave_m_s2: self.interpolate(self.heave_m_s2(), time_s),
            pitch_rate_rad_s: self.interpolate(self.pitch_rate_rad_s(), time_s),
        }
    }
}

/// The series at a fractional index.
fn interpolate_series(samples: &[f64], at: f64) -> f64 {
    if at < 0.0 {
        return 0.0;
    }
    let (k, fraction) = (at.floor() as usize, at - at.floor());
    match (samples.get(k), samples.get(k + 1)) {
        (Some(a), Some(b)) => a + fraction * (b - a),
        (Some(a), None) if fraction == 0.0 => *a,
        _ => 0.0,
    }
}

impl Procedure {
    /// Refuses durations, frequencies and roads that cannot be run.
    ///
    /// # Errors
    /// [`Error::Range`], [`Error::Length`], [`Error::NotFinite`].
    pub fn check(&self) -> Result<(), Error> {
        let positive = [
            ("step duration in s", self.step.duration_s),
            ("duration in s", self.duration_s),
            ("heave frequency in Hz", self.heave.frequency_hz),
            ("pitch frequency in Hz", self.pitch.frequency_hz),
        ];
        for (what, value) in
            positive.into_iter().chain(self.rejection_hz.iter().map(|f| ("rejection frequency in Hz", *f)))
        {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::Range { what, value, allowed: "positive" });
            }
        }
        if let Some(period_s) = self.triangle.map(|triangle| triangle.period_s)
            && !(period_s > 0.0 && period_s.is_finite())
        {
            return Err(Error::Range {
                what: "period of the triangle in s",
                value: period_s,
                allowed: "positive",
            });
        }
        check_finite("triangle in rad/s", &[self.triangle.map_or(0.0, |triangle| triangle.rate_rad_s)])?;
        check_finite("amplitudes", &[self.heave.amplitude, self.pitch.amplitude, self.step.rate_rad_s])?;
        if self.step.rate_rad_s == 0.0 {
            return Err(Error::Range { what: "step in rad/s", value: 0.0, allowed: "not 0" });
        }
        if !(0.0..self.duration_s).contains(&self.settle_s) {
            return Err(Error::Range {
                what: "settling time in s",
                value: self.settle_s,
                allowed: "0 or more, below the duration",
            });
        }
        if let Some(road) = &self.road {
            self.check_road(road)?;
        }
        let source = if self.road.is_some() { Source::Road } else { Source::Both };
        let sight = self.line_of_sight.as_ref();
        sight.map_or(Ok(()), |sight| sight.check(self.duration_of(source), self.settle_s))
    }

    fn check_road(&self, road: &Road) -> Result<(), Error> {
        for (what, column) in [
            ("heave of the road", RoadColumn::Heave),
            ("pitch rate of the road", RoadColumn::PitchRate),
            ("surge of the road", RoadColumn::Surge),
            ("roll rate of the road", RoadColumn::RollRate),
            ("yaw rate of the road", RoadColumn::YawRate),
        ] {
            check_finite(what, road.signals.column(column))?;
        }
        if !(road.sample_period_s > 0.0 && road.sample_period_s.is_finite()) {
            return Err(Error::Range {
                what: "sample period of the road in s",
                value: road.sample_period_s,
                allowed: "positive",
            });
        }
        if road.duration_s() <= self.settle_s {
            return Err(Error::Range {
                what: "duration of the road in s",
                value: road.duration_s(),
                allowed: "above the settling time",
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_default_can_be_run_and_nonsense_cannot() {
        let good = Procedure::default();
        good.check().unwrap();
        assert!(Procedure { duration_s: 0.0, ..good.clone() }.check().is_err());
        assert!(Procedure { settle_s: 10.0, ..good.clone() }.check().is_err());
        assert!(Procedure { rejection_hz: vec![f64::NAN], ..good.clone() }.check().is_err());
        let road = Road {
            origin: RoadOrigin::Recording(String::new()),
            sample_period_s: 0.01,
            signals: Signals::stack([&[0.0; 500][..], &[0.0; 499]]),
        };
        assert!(matches!(Procedure { road: Some(road), ..good }.check(), Err(Error::NotFinite { .. })));
    }

    #[test]
    fn a_road_is_straight_between_its_samples() {
        let road = Road {
            origin: RoadOrigin::Recording(String::new()),
            sample_period_s: 0.5,
            signals: Signals::stack([&[0.0, 1.0, 3.0][..], &[1.0; 3]]),
        };
        let at = |time_s: f64| (road.at(time_s).heave_m_s2, road.at(time_s).pitch_rate_rad_s);
        assert_eq!(at(0.75), (2.0, 1.0));
        assert_eq!(at(1.0), (3.0, 1.0));
        assert_eq!(at(1.1), (0.0, 0.0));
        assert_eq!(road.duration_s(), 1.0);
    }
}
