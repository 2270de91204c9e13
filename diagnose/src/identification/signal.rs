//! Signals made comparable: one low-pass for all, the gyroscope's lag for all, the amplifier's current from the control.

#![allow(non_snake_case)]

use crate::tolerance::identification::KERNEL_POWER;
use counterpoise_linalg::{Mat, expm_integral, solve};
use counterpoise_models::{Parameters, parameters::Sensor};

/// A symmetric low-pass of compact support, and the exact derivative of what it passes.
#[derive(Debug, Clone, PartialEq)]
pub struct Kernel {
    smooth: Vec<f64>,
    slope: Vec<f64>,
}

impl Kernel {
    /// The kernel of a standard deviation (s) at a sample period (s).
    pub fn new(deviation_s: f64, period_s: f64) -> Self {
        let half_s = deviation_s * f64::from(2 * KERNEL_POWER + 3).sqrt();
        let half = ((half_s / period_s).ceil() as isize).max(1);
        let share = |k: isize| k as f64 / (half + 1) as f64;
        let raw: Vec<f64> = (-half..=half).map(|k| (1.0 - share(k).powi(2)).powi(KERNEL_POWER)).collect();
        let tilt: Vec<f64> =
            (-half..=half).map(|k| share(k) * (1.0 - share(k).powi(2)).powi(KERNEL_POWER - 1)).collect();
        let area: f64 = raw.iter().sum();
        let moment: f64 = tilt.iter().zip(-half..=half).map(|(t, k)| t * k as f64 * period_s).sum();
        let scaled = |values: &[f64], by: f64| values.iter().map(|v| v / by).collect();
        Self { smooth: scaled(&raw, area), slope: scaled(&tilt, moment) }
    }

    /// Samples on either side that enter.
    pub fn half(&self) -> usize {
        self.smooth.len() / 2
    }

    /// The smoothed series; its ends are held beyond the ends.
    pub fn smooth(&self, series: &[f64]) -> Vec<f64> {
        convolve(series, &self.smooth)
    }

    /// The derivative of the smoothed series, per second.
    pub fn slope(&self, series: &[f64]) -> Vec<f64> {
        convolve(series, &self.slope)
    }

    /// Variance of the smoothed series and of its derivative, per unit of white noise.
    pub fn noise_gains(&self) -> [f64; 2] {
        [&self.smooth, &self.slope].map(|k| k.iter().map(|w| w * w).sum())
    }
}

/// Sum over the kernel of weight x sample: a weight after the middle meets a later sample.
fn convolve(series: &[f64], kernel: &[f64]) -> Vec<f64> {
    let (half, last) = (kernel.len() / 2, series.len().saturating_sub(1));
    let at = |k: usize| {
        if k >= half && k + half <= last {
            return kernel.iter().zip(&series[k - half..=k + half]).map(|(w, x)| w * x).sum();
        }
        let near = |j: usize| series[(k + j).saturating_sub(half).min(last)];
        kernel.iter().enumerate().map(|(j, w)| w * near(j)).sum()
    };
    (0..series.len()).map(at).collect()
}

/// A linear filter x' = A x + B u that starts in its steady state; exact for an input that is held between samples, or
/// straight.
struct Filter {
    Ad: Mat,
    held: Mat,
    ramp: Mat,
    start: Mat,
    output: usize,
}

/// What an input does between samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Between {
    /// It is held, as a converter does.
    Held,
    /// It goes straight to the next sample.
    Straight,
}

impl Filter {
    /// Returns the filter whose output is a state; `None` if A is singular or not finite.
    fn new(A: &Mat, B: &Mat, output: usize, period_s: f64) -> Option<Self> {
        let n = A.nrows();
        // with the input as one more state, its slope is the input
        let mut wide = Mat::zeros(n + 1, n + 1);
        wide.set_block(0, 0, A);
        wide.set_block(0, n, B);
        let mut slope = Mat::zeros(n + 1, 1);
        slope[(n, 0)] = 1.0;
        let (moved, ramp) = expm_integral(&wide, &slope, period_s).ok()?;
        Some(Self {
            Ad: moved.block(0, 0, n, n),
            held: moved.block(0, n, n, 1),
            ramp: ramp.block(0, 0, n, 1).scale(1.0 / period_s),
            start: solve(A, &B.scale(-1.0)).ok()?,
            output,
        })
    }

    fn run(&self, input: &[f64], between: Between) -> Vec<f64> {
        let mut x = self.start.scale(input.first().copied().unwrap_or(0.0));
        let mut out = Vec::with_capacity(input.len());
        for (k, u) in input.iter().enumerate() {
            out.push(x[(self.output, 0)]);
            let next = input.get(k + 1).copied().unwrap_or(*u);
            let rise = if between == Between::Held { 0.0 } else { next - u };
            x = self.advanced(&x, *u, rise);
        }
        out
    }

    fn advanced(&self, x: &Mat, u: f64, rise: f64) -> Mat {
        let n = x.nrows();
        let mut out = Mat::zeros(n, 1);
        for i in 0..n {
            let moved: f64 = (0..n).map(|j| self.Ad[(i, j)] * x[(j, 0)]).sum();
            out[(i, 0)] = moved + self.held[(i, 0)] * u + self.ramp[(i, 0)] * rise;
        }
        out
    }
}

/// The known linear machinery between the signals of a recording.
pub struct Chain<'a> {
    p: &'a Parameters,
    period_s: f64,
    /// Samples by which the control is held back.
    delay: usize,
}

impl<'a> Chain<'a> {
    /// The chain of a mechanism at a sample period, s.
    pub fn new(p: &'a Parameters, period_s: f64) -> Self {
        Self { p, period_s, delay: p.interface.output_delay_samples }
    }

    /// Sample period, s.
    pub fn period_s(&self) -> f64 {
        self.period_s
    }

    /// A true signal as the hub gyroscope would show it: w^2 / (s^2 + 2 z w s + w^2).
    pub fn as_gyro(&self, series: &[f64]) -> Vec<f64> {
        let lagged = self.gyro().and_then(|(A, B)| Filter::new(&A, &B, 0, self.period_s));
        lagged.map_or_else(|| series.to_vec(), |filter| filter.run(series, Between::Straight))
    }

    /// Returns state matrix and input of the gyroscope, the reading first; `None` if it is ideal.
    fn gyro(&self) -> Option<(Mat, Mat)> {
        let Sensor { natural_frequency_rad_s: w, damping_ratio: z, .. } = self.p.sensors.hub_gyro;
        let A = || Mat::from_rows(&[&[0.0, 1.0], &[-w * w, -2.0 * z * w]]);
        w.is_finite().then(|| (A(), Mat::col(&[0.0, w * w])))
    }

    /// The platform's accelerometer advanced by its own lag, 2 z / w, and then lagged as the gyroscope is.
    pub fn heave_as_gyro(&self, series: &[f64]) -> Vec<f64> {
        let sensor = &self.p.sensors.platform_accelerometer;
        let ahead = 2.0 * sensor.damping_ratio / sensor.natural_frequency_rad_s / self.period_s;
        let (whole, part) = (ahead.floor() as usize, ahead.fract());
        let last = series.len().saturating_sub(1);
        let at = |k: usize| series[k.min(last)];
        let advanced: Vec<f64> =
            (0..series.len()).map(|k| (1.0 - part) * at(k + whole) + part * at(k + whole + 1)).collect();
        self.as_gyro(&advanced)
    }

    /// Current (A) that a drive (V) makes with the motor stalled, as the gyroscope would show it.
    pub fn current_of_drive(&self, drive_v: &[f64]) -> Vec<f64> {
        let late = self.late(drive_v);
        let B = Mat::col(&[self.p.amplifier.gain / self.p.amplifier.time_constant_s, 0.0]);
        let filter = match self.gyro() {
            None => Filter::new(&self.electrical(), &B, 1, self.period_s),
            Some((gyro, reads)) => {
                // the gyroscope reads the current: one filter, exact for the held control
                let mut reading = Mat::zeros(2, 2);
                reading.set_block(0, 1, &reads);
                let both = Mat::from_blocks(&[&[&self.electrical(), &Mat::zeros(2, 2)], &[&reading, &gyro]]);
                Filter::new(&both, &B.vstack(&Mat::zeros(2, 1)), 2, self.period_s)
            }
        };
        filter.map_or_else(|| vec![0.0; late.len()], |filter| filter.run(&late, Between::Held))
    }

    /// The drive as the amplifier gets it: held back by the controller.
    fn late(&self, drive_v: &[f64]) -> Vec<f64> {
        let first = drive_v.first().copied().unwrap_or(0.0);
        (0..drive_v.len()).map(|k| if k < self.delay { first } else { drive_v[k - self.delay] }).collect()
    }

    /// Motor rate (rad/s) as the gyroscope would show it, of a motor whose gear twists between it and a joint whose rate
    /// (rad/s) the gyroscopes have shown, from the drive (V) and the joint's direction (1 or -1):
    ///
    /// ```text
    ///     J_m dw_m/dt = K_t i - F_m sgn - b_m w_m - (K x + D dx/dt) / N,   dx/dt = w_m / N - w_joint
    /// ```
    ///
    /// Backlash is taken as closed. Of a gear without an elasticity: N times the joint's rate.
    pub fn motor_rate(&self, drive_v: &[f64], joint_rate: &[f64], direction: &[f64]) -> Vec<f64> {
        let p = self.p;
        let (ratio, inertia) = (p.gearbox.ratio, p.motor.inertia_kg_m2);
        let A = self.motor_on_its_gear();
        let of = |B: [f64; 4]| Filter::new(&A, &Mat::col(&B), 2, self.period_s);
        let driven = of([p.amplifier.gain / p.amplifier.time_constant_s, 0.0, 0.0, 0.0]);
        let turned = of([0.0, 0.0, p.gearbox.damping_nm_s_rad / (ratio * inertia), -1.0]);
        let braked = of([0.0, 0.0, -p.motor_friction.coulomb_nm() / inertia, 0.0]);
        let (Some(driven), Some(turned), Some(braked)) = (driven, turned, braked) else {
            return joint_rate.iter().map(|w| ratio * w).collect();
        };
        let forced = driven.run(&self.late(drive_v), Between::Held);
        let dry = braked.run(direction, Between::Held);
        let forced: Vec<f64> = forced.iter().zip(&dry).map(|(a, b)| a + b).collect();
        let led = turned.run(joint_rate, Between::Straight);
        self.as_gyro(&forced).iter().zip(&led).map(|(a, b)| a + b).collect()
    }

    /// States: amplifier's voltage, current, motor rate, twist of the gear.
    fn motor_on_its_gear(&self) -> Mat {
        let (motor, gear) = (&self.p.motor, &self.p.gearbox);
        let (J, N) = (motor.inertia_kg_m2, gear.ratio);
        let loss = self.p.motor_friction.viscous_nm_s_rad + gear.damping_nm_s_rad / (N * N);
        let mut A = Mat::zeros(4, 4);
        A.set_block(0, 0, &self.electrical());
        A[(1, 2)] = -motor.back_emf_v_s_rad / motor.inductance_h;
        A[(2, 1)] = motor.torque_constant_nm_a / J;
        A[(2, 2)] = -loss / J;
        A[(2, 3)] = -gear.stiffness_nm_rad / (N * J);
        A[(3, 2)] = 1.0 / N;
        A
    }

    /// Current (A) that the back-EMF of a motor rate (rad/s) makes.
    pub fn current_of_rate(&self, motor_rate: &[f64]) -> Vec<f64> {
        let motor = &self.p.motor;
        let B = Mat::col(&[0.0, -motor.back_emf_v_s_rad / motor.inductance_h]);
        let filter = Filter::new(&self.electrical(), &B, 1, self.period_s);
        filter.map_or_else(|| vec![0.0; motor_rate.len()], |filter| filter.run(motor_rate, Between::Straight))
    }

    /// ```text
    ///     tau dV/dt = -V + K_v (v - K_ifb i),   L di/dt = V - R i - K_e w_m
    /// ```
    fn electrical(&self) -> Mat {
        let (amplifier, motor) = (&self.p.amplifier, &self.p.motor);
        let tau = amplifier.time_constant_s;
        let feedback = -amplifier.gain * amplifier.current_feedback_v_a / tau;
        let L = motor.inductance_h;
        Mat::from_rows(&[&[-1.0 / tau, feedback], &[1.0 / L, -motor.resistance_ohm / L]])
    }

    /// Rate of the mean inertia (J_h w_h + J_b w_b) / J, the beam moving as its spring and the measured hub make it.
    pub fn mean_rate(&self, hub_rate: &[f64]) -> Vec<f64> {
        let Some(l) = self.p.lumped.as_ref() else { return hub_rate.to_vec() };
        let beam = l.beam_inertia_kg_m2;
        let share = beam / (beam + l.hub_inertia_kg_m2);
        let (k, d) = (l.stiffness_nm_rad / beam, l.damping_nm_s_rad / beam);
        let A = Mat::from_rows(&[&[0.0, -1.0], &[k, -d]]);
        let Some(filter) = Filter::new(&A, &Mat::col(&[1.0, d]), 1, self.period_s) else {
            return hub_rate.to_vec();
        };
        let beam_rate = filter.run(hub_rate, Between::Straight);
        hub_rate.iter().zip(&beam_rate).map(|(h, b)| (1.0 - share) * h + share * b).collect()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use counterpoise_models::reference;

    #[test]
    fn the_kernel_keeps_lines_and_gives_their_slope() {
        let kernel = Kernel::new(0.03, 1e-3);
        let line: Vec<f64> = (0..1000).map(|k| 2.0 - 3e-3 * f64::from(k)).collect();
        assert!((kernel.smooth(&line)[500] - line[500]).abs() < 1e-12);
        assert!((kernel.slope(&line)[500] + 3.0).abs() < 1e-12);
    }

    #[test]
    fn the_derivative_is_that_of_what_is_passed() {
        let kernel = Kernel::new(0.03, 1e-3);
        let (w, t) = (15.0_f64, 0.5_f64);
        let wave: Vec<f64> = (0..1000).map(|k| (w * f64::from(k) * 1e-3).sin()).collect();
        let passed = kernel.smooth(&wave)[500] / (w * t).sin();
        assert!((kernel.slope(&wave)[500] - passed * w * (w * t).cos()).abs() < 1e-7 * w);
    }

    #[test]
    fn the_stalled_amplifier_has_its_static_gain() {
        let rig = reference::rig();
        let chain = Chain::new(&rig, 1e-3);
        let current = chain.current_of_drive(&[0.5; 50]);
        let expected = 0.5 * rig.amplifier.stall_gain_a_v(&rig.motor);
        assert!(current.iter().all(|i| (i - expected).abs() < 1e-9 * expected), "{current:?}");
    }

    #[test]
    fn a_motor_behind_its_gear_turns_with_the_joint_and_lags_where_the_gear_twists() {
        let rig = reference::rig();
        let chain = Chain::new(&rig, 1e-3);
        let even = chain.motor_rate(&[0.0; 2000], &[0.1; 2000], &[1.0; 2000]);
        assert!((even[1999] - 0.1 * rig.gearbox.ratio).abs() < 1e-9, "{}", even[1999]);
        // a joint that is held while the drive steps: the motor travels the twist that balances the torque
        let mut drive = vec![0.0; 2000];
        drive[100..].fill(0.5);
        let stepped = chain.motor_rate(&drive, &[0.0; 2000], &[0.0; 2000]);
        let travelled: f64 = stepped.iter().sum::<f64>() * 1e-3;
        let torque = 0.5
            * rig.amplifier.stall_gain_a_v(&rig.motor)
            * rig.motor.torque_constant_nm_a
            * rig.gearbox.ratio;
        let twist = torque / rig.gearbox.stiffness_nm_rad;
        assert!((travelled / rig.gearbox.ratio / twist - 1.0).abs() < 1e-3, "{travelled} {twist}");
    }

    #[test]
    fn a_beam_that_turns_evenly_has_the_hubs_rate() {
        let rig = reference::rig();
        let mean = Chain::new(&rig, 1e-3).mean_rate(&[0.3; 50]);
        assert!(mean.iter().all(|w| (w - 0.3).abs() < 1e-9));
    }
}
