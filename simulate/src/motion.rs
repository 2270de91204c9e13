//! The platform's motion, as the integrator takes it: polynomials over each sample period.

use crate::engine::moments::NODES;
use crate::engine::ports::{FurtherPoint, PlatformPoint, PlatformSpan};
use crate::signal::{Signal, SignalCourse, Sine};
use crate::tolerance::{ROTOR_SAMPLES, SLOW_SINE_RAD};
use std::ops::Range;
use std::sync::Arc;

/// Motion of the platform. Rates and accelerations are inertial; heave is the pivot's upward acceleration without gravity.
#[derive(Debug, Clone, PartialEq)]
pub struct PlatformMotion {
    /// Pitch rate, rad/s.
    pub pitch_rate_rad_s: Signal,
    /// Heave, m/s^2.
    pub heave_m_s2: Signal,
    /// Platform angle at the start, rad.
    pub initial_angle_rad: f64,
    /// Further motion that acts on the axis; `None` if the platform only heaves and pitches.
    pub further: Option<FurtherMotion>,
}

/// The platform's motion beside heave and pitch, in axes that do not turn about the elevation axis
/// ([`counterpoise_models::base_motion`] defines them).
#[derive(Debug, Clone, PartialEq)]
pub struct FurtherMotion {
    /// Surge: forward acceleration of the pivot, m/s^2.
    pub surge_m_s2: Signal,
    /// Rate about the forward axis, rad/s.
    pub roll_rate_rad_s: Signal,
    /// Rate about the upward axis, rad/s.
    pub yaw_rate_rad_s: Signal,
}

impl FurtherMotion {
    /// Returns the motion from one of its samples on, as [`Signal::part`] does.
    pub(crate) fn part(&self, samples: Range<usize>) -> Self {
        Self {
            surge_m_s2: self.surge_m_s2.part(samples.clone()),
            roll_rate_rad_s: self.roll_rate_rad_s.part(samples.clone()),
            yaw_rate_rad_s: self.yaw_rate_rad_s.part(samples),
        }
    }
}

impl PlatformMotion {
    /// A platform at rest and level.
    pub const STILL: Self = Self {
        pitch_rate_rad_s: Signal::ZERO,
        heave_m_s2: Signal::ZERO,
        initial_angle_rad: 0.0,
        further: None,
    };

    /// Returns a platform motion simulator that only pitches, with the mechanism's pivot a distance in front of its axis:
    /// heave = offset x pitch acceleration. The pitch angle is a sum of sines (rad).
    pub fn pitch_simulator(angle: &[Sine], offset_m: f64) -> Self {
        let derivative = |order: i32, factor: f64| {
            let turned = angle.iter().map(|s| Sine {
                amplitude: factor * s.amplitude * s.frequency_rad_s.powi(order),
                frequency_rad_s: s.frequency_rad_s,
                phase_rad: s.phase_rad + f64::from(order) * std::f64::consts::FRAC_PI_2,
            });
            Signal::Sines(turned.collect())
        };
        Self {
            pitch_rate_rad_s: derivative(1, 1.0),
            heave_m_s2: derivative(2, offset_m),
            initial_angle_rad: angle.iter().map(|s| s.at(0.0)).sum(),
            further: None,
        }
    }

    /// Returns the same motion with its courses over so many samples of a length computed: for many runs on one platform.
    pub(crate) fn with_courses(self, period_s: f64, samples: usize) -> Self {
        let course = |signal| with_course(signal, period_s, samples);
        Self {
            pitch_rate_rad_s: course(self.pitch_rate_rad_s),
            heave_m_s2: course(self.heave_m_s2),
            further: self.further.map(|further| FurtherMotion {
                surge_m_s2: course(further.surge_m_s2),
                roll_rate_rad_s: course(further.roll_rate_rad_s),
                yaw_rate_rad_s: course(further.yaw_rate_rad_s),
            }),
            ..self
        }
    }

    /// Returns the motion over the sample that starts at `start_s`, with the angle there.
    #[cfg(test)]
    pub(crate) fn sample(&self, start_s: f64, period_s: f64, angle_rad: f64) -> MotionSample {
        MotionTrack::new(self, period_s, start_s).sample(angle_rad)
    }
}

/// Returns a signal that is made of samples with its course over so many samples of a length; another one as it is.
fn with_course(signal: Signal, period_s: f64, samples: usize) -> Signal {
    if !matches!(signal, Signal::Samples { .. }) {
        return signal;
    }
    let mut followed = SignalFollower::new(&signal, period_s);
    let quartics = (0..samples).map(|k| followed.next(k, k as f64 * period_s, period_s)).collect();
    Signal::WithCourse(Arc::new(SignalCourse::new(signal, period_s, quartics)))
}

/// A platform motion sample by sample.
#[derive(Debug, Clone)]
pub(crate) struct MotionTrack<'a> {
    period_s: f64,
    first_s: f64,
    next: usize,
    rate: SignalFollower<'a>,
    heave: SignalFollower<'a>,
    /// Surge, roll rate, yaw rate.
    further: Option<[SignalFollower<'a>; 3]>,
}

impl<'a> MotionTrack<'a> {
    /// Returns the track from a time on.
    pub fn new(platform: &'a PlatformMotion, period_s: f64, first_s: f64) -> Self {
        // a course begins at the first sample
        let follow = |signal: &'a Signal| match first_s == 0.0 {
            true => SignalFollower::new(signal, period_s),
            false => SignalFollower::new(signal.without_course(), period_s),
        };
        Self {
            period_s,
            first_s,
            next: 0,
            rate: follow(&platform.pitch_rate_rad_s),
            heave: follow(&platform.heave_m_s2),
            further: platform.further.as_ref().map(|further| {
                [&further.surge_m_s2, &further.roll_rate_rad_s, &further.yaw_rate_rad_s].map(follow)
            }),
        }
    }

    /// Returns the motion over the next sample, with the angle at its start.
    pub fn sample(&mut self, angle_rad: f64) -> MotionSample {
        let (k, period_s) = (self.next, self.period_s);
        let start_s = self.first_s + k as f64 * period_s;
        self.next += 1;
        MotionSample {
            angle_rad,
            period_s,
            rate: self.rate.next(k, start_s, period_s),
            heave: self.heave.next(k, start_s, period_s),
            further: self.further.as_mut().map(|all| {
                let [surge, roll, yaw] = all.each_mut().map(|followed| followed.next(k, start_s, period_s));
                [surge, roll, yaw, [0.0; 5]]
            }),
        }
    }
}

/// A signal that is followed from sample to sample.
#[derive(Debug, Clone)]
pub(crate) enum SignalFollower<'a> {
    Constant(f64),
    Sines(Vec<Rotor>),
    /// The quartics of the first samples, and the signal.
    Course(&'a [[f64; 5]], &'a Signal),
    Other(&'a Signal),
}

impl<'a> SignalFollower<'a> {
    pub fn new(signal: &'a Signal, period_s: f64) -> Self {
        match signal {
            Signal::Constant(value) => Self::Constant(*value),
            Signal::Sines(sines)
                if sines.iter().all(|s| s.frequency_rad_s.abs() * period_s < SLOW_SINE_RAD) =>
            {
                Self::Sines(sines.iter().map(|sine| Rotor::new(*sine, period_s)).collect())
            }
            Signal::WithCourse(course) => match course.quartics(period_s) {
                Some(quartics) => Self::Course(quartics, course.signal()),
                None => Self::new(course.signal(), period_s),
            },
            other => Self::Other(other),
        }
    }

    /// Returns the quartic in the fraction of sample k, which starts at a time; the samples are asked for one after the other.
    pub fn next(&mut self, k: usize, start_s: f64, period_s: f64) -> [f64; 5] {
        match self {
            Self::Constant(value) => [*value, 0.0, 0.0, 0.0, 0.0],
            Self::Sines(rotors) => {
                let mut about = [0.0; 5];
                for rotor in rotors {
                    if k.is_multiple_of(ROTOR_SAMPLES) {
                        rotor.set(start_s + 0.5 * period_s);
                    }
                    rotor.add(&mut about);
                    rotor.turn();
                }
                from_middle(about)
            }
            Self::Course(quartics, _) if k < quartics.len() => quartics[k],
            Self::Course(_, signal) | Self::Other(signal) => {
                fit_quartic(signal.at_each(POINTS.map(|s| start_s + s * period_s)))
            }
        }
    }
}

/// A sine in the middle of a sample, turned from sample to sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rotor {
    sine: Sine,
    turn: f64,
    rotation: (f64, f64),
    now: (f64, f64),
}

impl Rotor {
    fn new(sine: Sine, period_s: f64) -> Self {
        let turn = sine.frequency_rad_s * period_s;
        Self { sine, turn, rotation: turn.sin_cos(), now: (0.0, 1.0) }
    }

    fn set(&mut self, time_s: f64) {
        self.now = (self.sine.frequency_rad_s * time_s + self.sine.phase_rad).sin_cos();
    }

    fn turn(&mut self) {
        let ((sin, cos), (s, c)) = (self.now, self.rotation);
        self.now = (sin * c + cos * s, cos * c - sin * s);
    }

    /// Adds the series about the middle of the sample in powers of its fraction.
    fn add(&self, about: &mut [f64; 5]) {
        let ((sin, cos), a, turn) = (self.now, self.sine.amplitude, self.turn);
        let square = turn * turn;
        let terms =
            [sin, turn * cos, -0.5 * square * sin, -turn * square / 6.0 * cos, square * square / 24.0 * sin];
        about.iter_mut().zip(terms).for_each(|(c, term)| *c += a * term);
    }
}

/// The platform over one sample: polynomials in the fraction of the sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MotionSample {
    /// Angle of the platform at the start, rad.
    pub angle_rad: f64,
    pub period_s: f64,
    pub rate: [f64; 5],
    pub heave: [f64; 5],
    /// Surge, roll rate, yaw rate, torque of another axis.
    pub further: Option<[[f64; 5]; 4]>,
}

impl MotionSample {
    /// Returns the platform at a fraction of the sample.
    #[inline]
    pub fn at(&self, s: f64) -> PlatformPoint {
        let r = &self.rate;
        let integral = s * (r[0] + s * (r[1] / 2.0 + s * (r[2] / 3.0 + s * (r[3] / 4.0 + s * r[4] / 5.0))));
        PlatformPoint {
            angle: self.angle_rad + self.period_s * integral,
            rate: quartic(r, s),
            heave: quartic(&self.heave, s),
        }
    }

    /// Returns what the platform does beside heave and pitch at a fraction of the sample.
    #[inline]
    pub fn further_at(&self, s: f64) -> Option<FurtherPoint> {
        self.further.as_ref().map(|all| further_point(all, s))
    }

    /// Returns the platform along a step that starts at a fraction of the sample and takes a share of it.
    #[inline]
    pub fn span(&self, start: f64, share: f64) -> PlatformSpan {
        PlatformSpan {
            nodes: NODES.map(|node| self.at(start + node * share)),
            middle: self.at(start + 0.5 * share),
            further: self.further.as_ref().map(|all| {
                let mut points = [FurtherPoint::default(); 5];
                for (point, part) in points.iter_mut().zip([NODES[0], NODES[1], NODES[2], NODES[3], 0.5]) {
                    *point = further_point(all, start + part * share);
                }
                points
            }),
        }
    }

    /// Returns the torque of another axis at the stages of a step that starts at a fraction of the sample and takes a share of it, N m.
    #[inline]
    pub fn other_torques(&self, start: f64, share: f64) -> [f64; 3] {
        let Some([_, _, _, torque]) = &self.further else { return [0.0; 3] };
        [NODES[1], NODES[2], NODES[3]].map(|part| quartic(torque, start + part * share))
    }

    /// Returns the input of a platform sensor at the nodes of the whole sample.
    pub fn nodes(&self, of: impl Fn(&PlatformPoint) -> f64) -> [f64; 4] {
        NODES.map(|node| of(&self.at(node)))
    }

    /// Returns the pitch acceleration at the start of the sample, rad/s^2.
    pub fn pitch_acceleration_at(&self, s: f64) -> f64 {
        slope(&self.rate, s) / self.period_s
    }
}

#[inline]
fn further_point([surge, roll, yaw, torque]: &[[f64; 5]; 4], s: f64) -> FurtherPoint {
    FurtherPoint {
        surge: quartic(surge, s),
        rates: [quartic(roll, s), quartic(yaw, s)],
        torque: quartic(torque, s),
    }
}

/// Returns the value of a quartic, lowest power first.
#[inline]
pub(crate) fn quartic(c: &[f64; 5], s: f64) -> f64 {
    c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * c[4])))
}

/// Returns the derivative of a quartic, lowest power first.
#[inline]
pub(crate) fn slope(c: &[f64; 5], s: f64) -> f64 {
    c[1] + s * (2.0 * c[2] + s * (3.0 * c[3] + s * 4.0 * c[4]))
}

/// From powers of the distance from the middle of a sample to powers of the fraction of the sample.
fn from_middle([c0, c1, c2, c3, c4]: [f64; 5]) -> [f64; 5] {
    [
        c0 - 0.5 * (c1 - 0.5 * (c2 - 0.5 * (c3 - 0.5 * c4))),
        c1 - c2 + 0.75 * c3 - 0.5 * c4,
        c2 - 1.5 * c3 + 1.5 * c4,
        c3 - 2.0 * c4,
        c4,
    ]
}

/// The places at which a quartic is fitted over a sample: never at the ends, where a step may lie.
const POINTS: [f64; 5] =
    [0.024_471_741_852_423, 0.206_107_373_853_763, 0.5, 0.793_892_626_146_237, 0.975_528_258_147_577];

/// Returns the quartic through values at [`POINTS`].
fn fit_quartic(values: [f64; 5]) -> [f64; 5] {
    // Newton's divided differences, then expanded in powers
    let mut difference = values;
    if difference.iter().all(|&y| y == difference[0]) {
        return [difference[0], 0.0, 0.0, 0.0, 0.0];
    }
    for order in 1..5 {
        for i in (order..5).rev() {
            difference[i] = (difference[i] - difference[i - 1]) / (POINTS[i] - POINTS[i - order]);
        }
    }
    let mut c = [0.0; 5];
    for i in (0..5).rev() {
        for k in (1..5).rev() {
            c[k] = c[k - 1] - POINTS[i] * c[k];
        }
        c[0] = difference[i] - POINTS[i] * c[0];
    }
    c
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quartic_is_fitted_exactly() {
        let c = [1.0, -2.0, 0.5, 3.0, -1.5];
        let fitted = fit_quartic(POINTS.map(|s| quartic(&c, s)));
        for (a, b) in fitted.iter().zip(c) {
            assert!((a - b).abs() < 1e-12, "{fitted:?}");
        }
    }

    #[test]
    fn a_rotor_follows_its_sine() {
        let sine = Sine { amplitude: 0.7, frequency_rad_s: 30.0, phase_rad: 0.4 };
        let signal = Signal::Sines(vec![sine]);
        let platform = PlatformMotion { heave_m_s2: signal, ..PlatformMotion::STILL };
        let mut track = MotionTrack::new(&platform, 1e-3, 1.234);
        for k in 0..500 {
            let sample = track.sample(0.0);
            for s in [0.0, 0.3, 0.8, 1.0] {
                let expected = sine.at(1.234 + (f64::from(k) + s) * 1e-3);
                assert!((sample.at(s).heave - expected).abs() < 1e-11);
            }
        }
    }

    #[test]
    fn surge_roll_and_yaw_are_followed_as_heave_is() {
        let signal = |amplitude| Signal::sine(amplitude, 30.0);
        let further = FurtherMotion {
            surge_m_s2: signal(2.0),
            roll_rate_rad_s: signal(0.3),
            yaw_rate_rad_s: Signal::Constant(0.1),
        };
        let platform =
            PlatformMotion { heave_m_s2: signal(2.0), further: Some(further), ..PlatformMotion::STILL };
        let mut track = MotionTrack::new(&platform, 1e-3, 0.5);
        for _ in 0..200 {
            let sample = track.sample(0.0);
            let (heave, further) = (sample.at(0.4).heave, sample.further_at(0.4).unwrap_or_default());
            assert_eq!(further.surge, heave);
            assert!((further.rates[0] - 0.15 * heave).abs() < 1e-15 && further.rates[1] == 0.1);
            assert_eq!(sample.span(0.4, 0.5).further_at(0), Some(&further));
        }
    }

    #[test]
    fn the_angle_is_the_integral_of_the_rate() {
        let motion = PlatformMotion { pitch_rate_rad_s: Signal::sine(0.3, 20.0), ..PlatformMotion::STILL };
        let mut angle = 0.0;
        for k in 0..1000 {
            angle = motion.sample(f64::from(k) * 1e-3, 1e-3, angle).at(1.0).angle;
        }
        assert!((angle - 0.3 / 20.0 * (1.0 - 20.0_f64.cos())).abs() < 1e-13);
    }
}
