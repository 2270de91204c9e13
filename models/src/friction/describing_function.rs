//! Friction as a frequency response sees it: the describing function of a sinusoidal motion.

use super::model::FrictionModel;
use crate::tolerance::{CLOSED, LOOP_STEPS, MOST_PERIODS};
use counterpoise_linalg::C64;
use std::f64::consts::TAU;

/// One period of the torque under a sinusoidal motion.
#[derive(Debug, Clone, PartialEq)]
pub struct TorqueLoop {
    /// Relative angle, rad.
    pub angle_rad: Vec<f64>,
    /// Relative rate, rad/s.
    pub rate_rad_s: Vec<f64>,
    /// Torque, N m.
    pub torque_nm: Vec<f64>,
    /// Energy lost in the period, J.
    pub lost_j: f64,
    /// Complex stiffness, N m/rad: the torque's first harmonic over the angle's.
    pub stiffness_nm_rad: C64,
    /// Change of the state over the period, relative to its largest value: how well the loop is closed. 0 for bristles,
    /// whose snaps do not repeat: their loop is the one after four periods.
    pub gap: f64,
}

/// Returns the settled loop under x = A sin(omega t), at nominal level.
///
/// The states move exactly over each of 2000 steps of constant mean rate; the periodic solution is sought by Aitken's
/// extrapolation from period to period. With the complex stiffness k, friction acts
/// like a spring Re k and a damper Im k / omega; lost energy = pi A^2 Im k exactly for any law.
pub fn sinusoidal_loop(model: &FrictionModel, amplitude_rad: f64, frequency_rad_s: f64) -> TorqueLoop {
    let motion = Motion { model, amplitude_rad, frequency_rad_s };
    let mut states = vec![0.0; model.states()];
    let gap = motion.settle(&mut states);
    let mut out = TorqueLoop {
        angle_rad: Vec::with_capacity(LOOP_STEPS),
        rate_rad_s: Vec::with_capacity(LOOP_STEPS),
        torque_nm: Vec::with_capacity(LOOP_STEPS),
        lost_j: 0.0,
        stiffness_nm_rad: C64::new(0.0, 0.0),
        gap,
    };
    motion.period(&mut states, |angle, rate, states| {
        out.angle_rad.push(angle);
        out.rate_rad_s.push(rate);
        out.torque_nm.push(model.torque(rate, 1.0, states));
    });
    out.analyse(amplitude_rad, motion.step_s());
    out
}

struct Motion<'a> {
    model: &'a FrictionModel,
    amplitude_rad: f64,
    frequency_rad_s: f64,
}

impl Motion<'_> {
    fn step_s(&self) -> f64 {
        TAU / self.frequency_rad_s / LOOP_STEPS as f64
    }

    /// Moves the states through one period and shows angle, rate and states after each step.
    fn period(&self, states: &mut [f64], mut show: impl FnMut(f64, f64, &[f64])) {
        let mut sin = 0.0;
        for k in 1..=LOOP_STEPS {
            let (next, cos) = (TAU * (k % LOOP_STEPS) as f64 / LOOP_STEPS as f64).sin_cos();
            let moved = self.amplitude_rad * (next - sin);
            self.model.advance(moved / self.step_s(), self.step_s(), 1.0, states);
            sin = next;
            show(self.amplitude_rad * sin, self.amplitude_rad * self.frequency_rad_s * cos, states);
        }
    }

    /// Brings the states onto the closed loop and returns the gap that is left.
    fn settle(&self, states: &mut [f64]) -> f64 {
        let mut gap = 0.0;
        for _ in 0..if states.len() == 1 { MOST_PERIODS / 2 } else { 2 } {
            let first = states.first().copied().unwrap_or(0.0);
            self.period(states, |_, _, _| {});
            let (second, mut largest) = (states.first().copied().unwrap_or(0.0), 0.0_f64);
            self.period(states, |_, _, z| largest = largest.max(z.first().map_or(0.0, |z| z.abs())));
            let [third] = states else { continue };
            gap = if largest > 0.0 { (*third - second).abs() / largest } else { 0.0 };
            if gap < CLOSED {
                return gap;
            }
            *third = extrapolate_limit(first, second, *third);
        }
        gap
    }
}

/// Aitken: where a sequence a, b, c that converges geometrically ends.
fn extrapolate_limit(a: f64, b: f64, c: f64) -> f64 {
    let bend = c - 2.0 * b + a;
    let limit = c - (c - b) * (c - b) / bend;
    if limit.is_finite() { limit } else { c }
}

/// Returns the complex stiffness of [`sinusoidal_loop`], N m/rad.
pub fn describing_function(model: &FrictionModel, amplitude_rad: f64, frequency_rad_s: f64) -> C64 {
    sinusoidal_loop(model, amplitude_rad, frequency_rad_s).stiffness_nm_rad
}

impl TorqueLoop {
    fn analyse(&mut self, amplitude_rad: f64, step_s: f64) {
        let frequency = TAU / (step_s * LOOP_STEPS as f64);
        let dot = |a: &[f64]| a.iter().zip(&self.torque_nm).map(|(a, t)| a * t).sum::<f64>();
        self.lost_j = dot(&self.rate_rad_s) * step_s;
        let per = 2.0 / (LOOP_STEPS as f64 * amplitude_rad * amplitude_rad);
        self.stiffness_nm_rad = C64::new(dot(&self.angle_rad), dot(&self.rate_rad_s) / frequency) * per;
    }
}
