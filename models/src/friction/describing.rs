//! Friction as a frequency response sees it: the describing function of a sinusoidal motion.

use super::model::FrictionModel;
use counterpoise_lti::C64;

/// Steps per period of the motion.
const STEPS: usize = 2000;
/// Periods after which the loop of every law has closed.
const SETTLING_PERIODS: usize = 3;

/// One period of the torque under a sinusoidal motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Loop {
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
}

/// The settled loop under x = A sin(omega t), at nominal level.
///
/// The states move exactly over each of 2000 steps of constant mean rate. With the complex stiffness k, friction acts
/// like a spring Re k and a damper Im k / omega; lost energy = pi A^2 Im k exactly for any law.
pub fn sinusoidal_loop(model: &FrictionModel, amplitude_rad: f64, frequency_rad_s: f64) -> Loop {
    let step_s = std::f64::consts::TAU / frequency_rad_s / STEPS as f64;
    let mut states = vec![0.0; model.states()];
    let mut out = Loop {
        angle_rad: Vec::with_capacity(STEPS),
        rate_rad_s: Vec::with_capacity(STEPS),
        torque_nm: Vec::with_capacity(STEPS),
        lost_j: 0.0,
        stiffness_nm_rad: C64::new(0.0, 0.0),
    };
    for k in 0..STEPS * (SETTLING_PERIODS + 1) {
        let angle = |j: usize| std::f64::consts::TAU * (j % STEPS) as f64 / STEPS as f64;
        let moved = amplitude_rad * (angle(k + 1).sin() - angle(k).sin());
        model.advance(moved / step_s, step_s, 1.0, &mut states);
        if k >= STEPS * SETTLING_PERIODS {
            let (sin, cos) = angle(k + 1).sin_cos();
            out.push(amplitude_rad * sin, amplitude_rad * frequency_rad_s * cos, model, &states);
        }
    }
    out.analyse(amplitude_rad, step_s);
    out
}

/// The complex stiffness of [`sinusoidal_loop`], N m/rad.
pub fn describing_function(model: &FrictionModel, amplitude_rad: f64, frequency_rad_s: f64) -> C64 {
    sinusoidal_loop(model, amplitude_rad, frequency_rad_s).stiffness_nm_rad
}

impl Loop {
    fn push(&mut self, angle_rad: f64, rate_rad_s: f64, model: &FrictionModel, states: &[f64]) {
        self.angle_rad.push(angle_rad);
        self.rate_rad_s.push(rate_rad_s);
        self.torque_nm.push(model.torque(rate_rad_s, 1.0, states));
    }

    fn analyse(&mut self, amplitude_rad: f64, step_s: f64) {
        let frequency = std::f64::consts::TAU / (step_s * STEPS as f64);
        let dot = |a: &[f64]| a.iter().zip(&self.torque_nm).map(|(a, t)| a * t).sum::<f64>();
        self.lost_j = dot(&self.rate_rad_s) * step_s;
        let per = 2.0 / (STEPS as f64 * amplitude_rad * amplitude_rad);
        self.stiffness_nm_rad = C64::new(dot(&self.angle_rad), dot(&self.rate_rad_s) / frequency) * per;
    }
}
