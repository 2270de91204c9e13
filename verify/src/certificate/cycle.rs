//! Limit cycles predicted by harmonic balance.
//!
//! At each amplitude of the hub's rate every nonlinear part is replaced by its describing function at its own amplitude, and the loop's
//! poles are computed. The motion grows where the outermost oscillating pole lies outside the unit circle. An amplitude at which
//! growth turns into fading is a stable limit cycle, one at which fading turns into growth an unstable one: a disturbance beyond it
//! leads to the next stable one. (A. Gelb and W. Vander Velde, *Multiple-Input Describing Functions*, 1968, ch. 3.)

use counterpoise_linalg::C64;
use counterpoise_lti::Response;

use super::balance::{CycleBalance, MeshBalance, SettledLoop};
use super::elements::{ElementLoop, Elements, Learning, Sinusoid};
use super::floor::Subject;
use super::gap::gap_share;
use super::regime::{Teeth, teeth_can_part};
use crate::Error;
use crate::linear_loop::plant::port;
use crate::tolerance::{
    CYCLE_HALVINGS, FREQUENCY_ERROR, FREQUENCY_ROUNDS, OPEN, STEADY_GROWTH, THIRD_HARMONIC,
};

/// A predicted limit cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    /// Amplitude of the hub's rate, rad/s.
    pub rate_rad_s: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Share of the first harmonic with which the third one returns round the loop.
    pub third_harmonic: f64,
    /// Relative difference between the frequency of the pole and the one for which the describing functions hold, the larger of both sides;
    /// infinite if growth does not turn into fading between them.
    pub frequency_error: f64,
}

/// Growth of a sinusoidal motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Growth {
    /// Amplitude of the hub's rate, rad/s.
    pub rate_rad_s: f64,
    /// Growth, 1/s; negative where the motion fades.
    pub growth_per_s: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
}

impl Cycle {
    /// Returns whether the loop is enough of a low-pass for the prediction to hold, and its describing functions hold for its frequency.
    pub fn is_reliable(&self) -> bool {
        self.third_harmonic <= THIRD_HARMONIC && self.is_consistent()
    }

    /// Returns whether the describing functions hold for the frequency of the predicted motion.
    pub fn is_consistent(&self) -> bool {
        self.frequency_error <= FREQUENCY_ERROR
    }
}

/// A predicted limit cycle with the loops below and above it.
pub(super) struct CycleBracket {
    pub cycle: Cycle,
    pub balances: Vec<CycleBalance>,
}

/// The loop whose balance is sought.
pub(super) struct HarmonicBalance<'a> {
    pub(super) subject: &'a Subject<'a>,
    pub(super) teeth: Teeth,
    /// Torque that presses the teeth together at rest, N m.
    pressed_nm: f64,
    /// Frequency of the outermost oscillating pole at rest, rad/s.
    pub(super) start_rad_s: f64,
}

impl<'a> HarmonicBalance<'a> {
    pub(super) fn new(subject: &'a Subject<'a>) -> Result<Self, Error> {
        let point = &subject.procedure.operating_point;
        let rest = ElementLoop::close(subject, &Elements::at_rest(subject)?, Learning::Still)?;
        let period_s = rest.plant.sample_period_s;
        let start_rad_s = rest.least_stable_pole().map_or(1.0, |pole| rate_of(pole, period_s));
        Ok(Self {
            subject,
            teeth: teeth_can_part(subject.case, point)?,
            pressed_nm: subject.case.plant.equilibrium(point).mesh_torque_nm.abs(),
            start_rad_s,
        })
    }

    /// The growth at an amplitude, the frequency sought from `from_rad_s`; `None` if nothing oscillates.
    pub(super) fn growth(&self, rate_rad_s: f64, from_rad_s: f64) -> Result<Option<Growth>, Error> {
        let Some(SettledLoop { pole, .. }) = self.settle_frequency(rate_rad_s, from_rad_s)? else {
            return Ok(None);
        };
        let period_s = self.subject.case.plant.parameters().interface.sample_period_s;
        Ok(Some(Growth {
            rate_rad_s,
            growth_per_s: pole.norm().ln() / period_s,
            frequency_hz: rate_of(pole, period_s) / std::f64::consts::TAU,
        }))
    }

    /// The loop at an amplitude whose describing functions have the frequency of its own pole.
    fn settle_frequency(&self, rate_rad_s: f64, from_rad_s: f64) -> Result<Option<SettledLoop>, Error> {
        let ratio = self.subject.case.plant.parameters().gearbox.ratio;
        let mut motion = Sinusoid { rate_rad_s, frequency_rad_s: from_rad_s, motor_over_hub: ratio };
        let mut found = None;
        for _ in 0..FREQUENCY_ROUNDS {
            let mut elements = Elements::harmonic(self.subject, &motion)?;
            let mesh = self.mesh(&motion);
            elements.mesh_share = mesh.share;
            let linear = ElementLoop::close(self.subject, &elements, Learning::Still)?;
            let Some(pole) = linear.least_stable_pole() else { return Ok(None) };
            let (frequency, used) = (rate_of(pole, linear.plant.sample_period_s), motion);
            motion.frequency_rad_s = frequency;
            motion.motor_over_hub = motor_over_hub(&linear, frequency)?.unwrap_or(ratio);
            found = Some(SettledLoop { motion: used, elements, linear, pole, mesh });
        }
        Ok(found)
    }

    /// The share of the gear's stiffness that acts: the describing function of a gap that is pressed to one side.
    fn mesh(&self, motion: &Sinusoid) -> MeshBalance {
        let gearbox = &self.subject.case.plant.parameters().gearbox;
        let hub_rad = motion.rate_rad_s / motion.frequency_rad_s;
        let wind_up_rad = hub_rad * (motion.motor_over_hub / gearbox.ratio - 1.0).abs();
        let pressed_rad = self.pressed_wind_up_rad();
        if self.teeth == Teeth::WithoutGap || self.pressed_nm == 0.0 {
            return MeshBalance { wind_up_rad, pressed_rad, gap_rad: 0.0, share: 1.0 };
        }
        let gap_rad = gearbox.backlash_rad;
        let share = gap_share(wind_up_rad, pressed_rad, gap_rad).max(OPEN);
        MeshBalance { wind_up_rad, pressed_rad, gap_rad, share }
    }

    /// Wind-up by which the teeth are pressed together, rad: below 0 in the middle of the gap, where nothing presses them.
    pub(super) fn pressed_wind_up_rad(&self) -> f64 {
        let gearbox = &self.subject.case.plant.parameters().gearbox;
        if self.pressed_nm == 0.0 {
            -0.5 * gearbox.backlash_rad
        } else {
            self.pressed_nm / gearbox.stiffness_nm_rad
        }
    }

    /// The limit cycle between an amplitude at which the motion grows and one at which it fades.
    pub(super) fn cycle(&self, grows: Growth, fades: Growth) -> Result<CycleBracket, Error> {
        let (mut low, mut high) = (grows, fades);
        for _ in 0..CYCLE_HALVINGS {
            let middle = (low.rate_rad_s * high.rate_rad_s).sqrt();
            let from = std::f64::consts::TAU * low.frequency_hz;
            let Some(growth) = self.growth(middle, from)? else { break };
            if growth.growth_per_s > STEADY_GROWTH { low = growth } else { high = growth }
        }
        let mut sides = Vec::new();
        for side in [low, high] {
            sides.extend(self.settle_frequency(side.rate_rad_s, std::f64::consts::TAU * side.frequency_hz)?);
        }
        let rate = std::f64::consts::TAU * low.frequency_hz;
        let third = sides.first().map(|below| third_harmonic(&below.linear, rate)).transpose()?;
        let cycle = Cycle {
            rate_rad_s: low.rate_rad_s,
            frequency_hz: low.frequency_hz,
            third_harmonic: third.unwrap_or(0.0),
            frequency_error: frequency_error(&sides),
        };
        CycleBracket::new(self.subject, cycle, &sides)
    }
}

impl CycleBracket {
    /// Returns a limit cycle with the loops below and above it.
    pub(super) fn new(subject: &Subject<'_>, cycle: Cycle, sides: &[SettledLoop]) -> Result<Self, Error> {
        let balances = sides.iter().map(|side| CycleBalance::new(subject, side));
        Ok(Self { cycle, balances: balances.collect::<Result<_, _>>()? })
    }
}

/// Returns the largest relative difference between the frequency of the pole and the one for which the describing functions hold, below and
/// above a limit cycle; infinite if growth does not turn into fading between them.
pub(super) fn frequency_error(sides: &[SettledLoop]) -> f64 {
    let [below, above] = sides else { return f64::INFINITY };
    let growth = |at: &SettledLoop| at.pole.norm().ln() / at.linear.plant.sample_period_s;
    if growth(below) <= STEADY_GROWTH || growth(above) > STEADY_GROWTH {
        return f64::INFINITY;
    }
    let error = |at: &SettledLoop| {
        (rate_of(at.pole, at.linear.plant.sample_period_s) / at.motion.frequency_rad_s - 1.0).abs()
    };
    error(below).max(error(above))
}

/// The frequency of a pole, rad/s: for a real one, the rate at which it grows, which is that of the motion that it starts.
pub(super) fn rate_of(pole: C64, period_s: f64) -> f64 {
    if pole.im == 0.0 { pole.re.abs().ln().abs() / period_s } else { pole.arg() / period_s }
}

/// |L(3 w)| / |L(w)|, with the hold's own fall beyond half the sample rate taken as complete.
pub(super) fn third_harmonic(linear: &ElementLoop, rate: f64) -> Result<f64, Error> {
    if 3.0 * rate * linear.plant.sample_period_s >= std::f64::consts::PI {
        return Ok(0.0);
    }
    let response = Response::of(&linear.broken)?.at_all(&[rate, 3.0 * rate])?;
    Ok(response[1][(0, 0)].norm() / response[0][(0, 0)].norm().max(f64::MIN_POSITIVE))
}

/// The amplitude of the motor's motion over the hub's under the control alone; `None` if the hub does not move.
pub(super) fn motor_over_hub(linear: &ElementLoop, frequency_rad_s: f64) -> Result<Option<f64>, Error> {
    let response = Response::of(&linear.plant.continuous)?.at(frequency_rad_s)?;
    let (hub, motor) = (response[(port::HUB, 0)].norm(), response[(port::MOTOR, 0)].norm());
    Ok((hub > 0.0).then(|| motor / hub))
}
