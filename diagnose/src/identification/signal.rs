//! Signals made comparable: one low-pass for all, the gyroscope's lag for all, the amplifier's current from the control.

#![allow(non_snake_case)]

use crate::recording::series::derivative;
use crate::tolerance::identification::KERNEL_POWER;
use crate::tolerance::recording::ON_SAMPLE;
use counterpoise_linalg::{Mat, expm_integral, solve};
use counterpoise_models::{AmplifierDynamics, Link, LumpedStructure, Parameters, parameters::Sensor};

/// A symmetric low-pass of compact support, and the exact derivative of what it passes.
#[derive(Debug, Clone, PartialEq)]
pub struct Kernel {
    smooth: Vec<f64>,
    slope: Vec<f64>,
}

impl Kernel {
    /// Returns the kernel of a standard deviation (s) at a sample period (s).
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

    /// Returns the samples on either side that enter.
    pub fn half_length(&self) -> usize {
        self.smooth.len() / 2
    }

    /// Returns the smoothed series; its ends are held beyond the ends.
    pub fn smooth(&self, series: &[f64]) -> Vec<f64> {
        convolve(series, &self.smooth)
    }

    /// Returns the derivative of the smoothed series, per second.
    pub fn slope(&self, series: &[f64]) -> Vec<f64> {
        convolve(series, &self.slope)
    }

    /// Returns the variance of the smoothed series and of its derivative, per unit of white noise.
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

/// A linear filter x' = A x + B u, y = C x + D u that starts in its steady state; exact for an input that is held between samples, or
/// straight. It may have no state.
///
/// The answer to a held input is the mean over the half periods before and after a sample: the answer of a quick filter to the steps at the samples
/// is over before the next one, which would show it half a period late.
struct Filter {
    Ad: Mat,
    held: Mat,
    ramp: Mat,
    /// State after half a period, and its mean over it, of the state before and the held input.
    half: Mat,
    half_mean: Mat,
    start: Mat,
    output: Vec<f64>,
    direct: f64,
}

/// The course of an input between samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum InputHold {
    /// The input is held, as a converter does.
    Held,
    /// The input goes straight to the next sample.
    Straight,
}

impl Filter {
    /// Returns the filter of a system; `None` if A is singular or something is not finite.
    fn new(system: &System, period_s: f64) -> Option<Self> {
        let System { A, B, output, direct } = system;
        let n = A.nrows();
        if !B.as_slice().iter().chain(A.as_slice()).chain(output).all(|x| x.is_finite()) {
            return None;
        }
        let (output, direct) = (output.clone(), *direct);
        if n == 0 {
            let none = || Mat::zeros(0, 1);
            return Some(Self {
                Ad: Mat::zeros(0, 0),
                held: none(),
                ramp: none(),
                half: Mat::zeros(0, 1),
                half_mean: Mat::zeros(0, 1),
                start: none(),
                output,
                direct,
            });
        }
        // with the input as one more state, its slope is the input
        let mut wide = Mat::zeros(n + 1, n + 1);
        wide.set_block(0, 0, A);
        wide.set_block(0, n, B);
        let mut slope = Mat::zeros(n + 1, 1);
        slope[(n, 0)] = 1.0;
        let (moved, ramp) = expm_integral(&wide, &slope, period_s).ok()?;
        let half_s = 0.5 * period_s;
        let (half, integral) = expm_integral(&wide, &Mat::eye(n + 1), half_s).ok()?;
        Some(Self {
            half: half.block(0, 0, n, n + 1),
            half_mean: integral.block(0, 0, n, n + 1).scale(1.0 / half_s),
            Ad: moved.block(0, 0, n, n),
            held: moved.block(0, n, n, 1),
            ramp: ramp.block(0, 0, n, 1).scale(1.0 / period_s),
            start: solve(A, &B.scale(-1.0)).ok()?,
            output,
            direct,
        })
    }

    fn run(&self, input: &[f64], between: InputHold) -> Vec<f64> {
        let mut x = self.start.scale(input.first().copied().unwrap_or(0.0));
        let mut shown_before = self.output_of(&x);
        let mut out = Vec::with_capacity(input.len());
        for (k, u) in input.iter().enumerate() {
            let (before, shown) = match between {
                InputHold::Straight => (*u, self.output_of(&x)),
                InputHold::Held => {
                    let after = self.output_of(&self.apply_half_period(&self.half_mean, &x, *u));
                    let shown = 0.5 * (shown_before + after);
                    let middle = self.apply_half_period(&self.half, &x, *u);
                    shown_before = self.output_of(&self.apply_half_period(&self.half_mean, &middle, *u));
                    (input[k.saturating_sub(1)], shown)
                }
            };
            out.push(shown + self.direct * 0.5 * (before + u));
            let next = input.get(k + 1).copied().unwrap_or(*u);
            let rise = if between == InputHold::Held { 0.0 } else { next - u };
            x = self.next_state(&x, *u, rise);
        }
        out
    }

    /// Returns the output of a state, without what the input adds to it.
    fn output_of(&self, x: &Mat) -> f64 {
        self.output.iter().enumerate().map(|(i, c)| c * x[(i, 0)]).sum()
    }

    /// Returns what a map of half a period makes of a state and a held input.
    fn apply_half_period(&self, map: &Mat, x: &Mat, u: f64) -> Mat {
        let n = x.nrows();
        let of = |i: usize| (0..n).map(|j| map[(i, j)] * x[(j, 0)]).sum::<f64>() + map[(i, n)] * u;
        Mat::from_fn(n, 1, |i, _| of(i))
    }

    fn next_state(&self, x: &Mat, u: f64, rise: f64) -> Mat {
        let n = x.nrows();
        let mut out = Mat::zeros(n, 1);
        for i in 0..n {
            let moved: f64 = (0..n).map(|j| self.Ad[(i, j)] * x[(j, 0)]).sum();
            out[(i, 0)] = moved + self.held[(i, 0)] * u + self.ramp[(i, 0)] * rise;
        }
        out
    }
}

/// A linear system of one input and one output; it may have no state.
struct System {
    A: Mat,
    B: Mat,
    output: Vec<f64>,
    direct: f64,
}

impl System {
    /// Returns a system whose output is one of its states.
    fn with_output_state(A: Mat, B: Mat, state: usize) -> Self {
        let output = (0..A.nrows()).map(|i| if i == state { 1.0 } else { 0.0 }).collect();
        Self { A, B, output, direct: 0.0 }
    }
}

/// The current of a drive: states of voltage and current as far as the drive has them, the inputs drive (V) and motor rate (rad/s), the
/// output current (A).
struct Electrical {
    A: Mat,
    /// Columns of the drive and of the motor's rate.
    B: [Vec<f64>; 2],
    C: Vec<f64>,
    D: [f64; 2],
}

impl Electrical {
    /// ```text
    ///     tau dV/dt = -V + K_v (v - K_ifb i),   L di/dt = V - R i - K_e w_m
    /// ```
    ///
    /// Without a lag the voltage is its input, without an inductance the current is (V - K_e w_m) / R. A current loop follows its gain
    /// times the drive with its bandwidth, and an ideal current source or a torque command at once, whatever the motor's rate.
    fn of(p: &Parameters) -> Self {
        let (amplifier, motor) = (&p.amplifier, &p.motor);
        let (tau, L) = (amplifier.time_constant_s, motor.inductance_h);
        let (R, Ke, K, feedback) =
            (motor.resistance_ohm, motor.back_emf_v_s_rad, amplifier.gain, amplifier.current_feedback_v_a);
        let gain = amplifier.stall_gain_a_v(motor);
        let none =
            || Self { A: Mat::zeros(0, 0), B: [Vec::new(), Vec::new()], C: Vec::new(), D: [gain, 0.0] };
        match amplifier.dynamics {
            AmplifierDynamics::IdealCurrent
            | AmplifierDynamics::TorqueCommand
            | AmplifierDynamics::CurrentCommand => none(),
            AmplifierDynamics::CurrentLoop { bandwidth_rad_s: w, .. } => {
                let B = [vec![w * gain], vec![0.0]];
                Self { A: Mat::from_rows(&[&[-w]]), B, C: vec![1.0], D: [0.0; 2] }
            }
            AmplifierDynamics::Modelled if tau > 0.0 && L > 0.0 => Self {
                A: Mat::from_rows(&[&[-1.0 / tau, -K * feedback / tau], &[1.0 / L, -R / L]]),
                B: [vec![K / tau, 0.0], vec![0.0, -Ke / L]],
                C: vec![0.0, 1.0],
                D: [0.0; 2],
            },
            AmplifierDynamics::Modelled if tau > 0.0 => Self {
                A: Mat::from_rows(&[&[-(1.0 + K * feedback / R) / tau]]),
                B: [vec![K / tau], vec![K * feedback * Ke / (R * tau)]],
                C: vec![1.0 / R],
                D: [0.0, -Ke / R],
            },
            AmplifierDynamics::Modelled if L > 0.0 => Self {
                A: Mat::from_rows(&[&[-(R + K * feedback) / L]]),
                B: [vec![K / L], vec![-Ke / L]],
                C: vec![1.0],
                D: [0.0; 2],
            },
            AmplifierDynamics::Modelled => Self { D: [gain, -Ke / (R + K * feedback)], ..none() },
        }
    }

    /// Returns the number of states.
    fn order(&self) -> usize {
        self.C.len()
    }

    /// Returns the system from one input to the current: 0 the drive, 1 the motor's rate.
    fn system(&self, input: usize) -> System {
        System {
            A: self.A.clone(),
            B: Mat::col(&self.B[input]),
            output: self.C.clone(),
            direct: self.D[input],
        }
    }
}

/// The known linear machinery between the signals of a recording.
pub struct Chain<'a> {
    p: &'a Parameters,
    period_s: f64,
    /// Samples by which the control is held back.
    delay: usize,
    /// Samples by which the readings of the loop's sensor are late, on the average.
    late: f64,
}

impl<'a> Chain<'a> {
    /// Returns the chain of a mechanism at a sample period, s.
    pub fn new(p: &'a Parameters, period_s: f64) -> Self {
        let late = p.sensors.hub_gyro.mean_delay_samples(period_s);
        Self { p, period_s, delay: p.interface.output_delay_samples, late }
    }

    /// Returns what a sensor has shown without its scale and bias, as late as the loop's own sensor shows it.
    pub fn reading_of(&self, sensor: &Sensor, series: &[f64]) -> Vec<f64> {
        let moved = shift_later(series, self.late - sensor.mean_delay_samples(self.period_s));
        if !sensor.is_fitted() {
            return moved;
        }
        moved.into_iter().map(|reading| (reading - sensor.bias) / sensor.gain).collect()
    }

    /// Returns the sample period, s.
    pub fn period_s(&self) -> f64 {
        self.period_s
    }

    /// Returns a signal that is not late as late as the loop's sensor shows it.
    pub fn as_late(&self, series: &[f64]) -> Vec<f64> {
        shift_later(series, self.late)
    }

    /// Returns a signal that is as late as the loop's sensor with that sensor's lag too: w^2 / (s^2 + 2 z w s + w^2).
    pub fn as_gyro(&self, series: &[f64]) -> Vec<f64> {
        let lagged =
            self.gyro().and_then(|(A, B)| Filter::new(&System::with_output_state(A, B, 0), self.period_s));
        lagged.map_or_else(|| series.to_vec(), |filter| filter.run(series, InputHold::Straight))
    }

    /// Returns state matrix and input of the gyroscope, the reading first; `None` if it is ideal.
    fn gyro(&self) -> Option<(Mat, Mat)> {
        let Sensor { natural_frequency_rad_s: w, damping_ratio: z, .. } = self.p.sensors.hub_gyro;
        let A = || Mat::from_rows(&[&[0.0, 1.0], &[-w * w, -2.0 * z * w]]);
        w.is_finite().then(|| (A(), Mat::col(&[0.0, w * w])))
    }

    /// Returns the platform's accelerometer advanced by its own lag, 2 z / w, and then lagged as the gyroscope is.
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

    /// Returns the current (A) that a drive (V) makes with the motor stalled, as the gyroscope would show it.
    pub fn current_of_drive(&self, drive_v: &[f64]) -> Vec<f64> {
        let late = self.delayed_drive(drive_v);
        let electrical = Electrical::of(self.p);
        let alone = electrical.system(0);
        let system = match self.gyro() {
            None => alone,
            Some((gyro, reads)) => {
                // the gyroscope reads the current: one filter, exact for the held control
                let n = electrical.order();
                let mut A = Mat::zeros(n + 2, n + 2);
                A.set_block(0, 0, &alone.A);
                A.set_block(n, n, &gyro);
                A.set_block(n, 0, &(&reads * &Mat::row(&alone.output)));
                System::with_output_state(A, alone.B.vstack(&reads.scale(alone.direct)), n)
            }
        };
        let filter = Filter::new(&system, self.period_s);
        let made = filter.map_or_else(|| vec![0.0; late.len()], |filter| filter.run(&late, InputHold::Held));
        shift_later(&made, self.late.fract())
    }

    /// The drive as the amplifier gets it, held back by the controller, as late as the loop's sensor shows it, in whole samples.
    fn delayed_drive(&self, drive_v: &[f64]) -> Vec<f64> {
        let first = drive_v.first().copied().unwrap_or(0.0);
        let delay = self.delay + self.late as usize;
        (0..drive_v.len()).map(|k| if k < delay { first } else { drive_v[k - delay] }).collect()
    }

    /// Returns the motor rate (rad/s) as the gyroscope would show it, of a motor whose gear twists between it and a joint whose
    /// rate (rad/s) the gyroscopes have shown, from the drive (V) and the joint's direction (1 or -1):
    ///
    /// ```text
    ///     J_m dw_m/dt = K_t i - F_m sgn - b_m w_m - (K x + D dx/dt) / N,   dx/dt = w_m / N - w_joint
    /// ```
    ///
    /// Backlash is taken as closed. Of a gear without an elasticity: N times the joint's rate.
    pub fn motor_rate(&self, drive_v: &[f64], joint_rate: &[f64], direction: &[f64]) -> Vec<f64> {
        let p = self.p;
        let (ratio, inertia) = (p.gearbox.ratio, p.motor.inertia_kg_m2);
        if p.gearbox.is_rigid() {
            return joint_rate.iter().map(|w| ratio * w).collect();
        }
        let electrical = Electrical::of(p);
        let n = electrical.order();
        let A = self.motor_on_its_gear(&electrical);
        let of =
            |B: Vec<f64>| Filter::new(&System::with_output_state(A.clone(), Mat::col(&B), n), self.period_s);
        let with = |motor: f64, twist: f64| {
            let mut B = vec![0.0; n];
            B.extend([motor, twist]);
            B
        };
        let mut drive = electrical.B[0].clone();
        drive.extend([p.motor.torque_constant_nm_a * electrical.D[0] / inertia, 0.0]);
        let driven = of(drive);
        let turned = of(with(p.gearbox.damping_nm_s_rad / (ratio * inertia), -1.0));
        let braked = of(with(-p.motor_friction.coulomb_nm() / inertia, 0.0));
        let (Some(driven), Some(turned), Some(braked)) = (driven, turned, braked) else {
            return joint_rate.iter().map(|w| ratio * w).collect();
        };
        let forced =
            shift_later(&driven.run(&self.delayed_drive(drive_v), InputHold::Held), self.late.fract());
        let dry = braked.run(direction, InputHold::Held);
        let forced: Vec<f64> = forced.iter().zip(&dry).map(|(a, b)| a + b).collect();
        let led = turned.run(joint_rate, InputHold::Straight);
        self.as_gyro(&forced).iter().zip(&led).map(|(a, b)| a + b).collect()
    }

    /// States: those of the drive's current, motor rate, twist of the gear.
    fn motor_on_its_gear(&self, electrical: &Electrical) -> Mat {
        let (motor, gear) = (&self.p.motor, &self.p.gearbox);
        let (J, N, n) = (motor.inertia_kg_m2, gear.ratio, electrical.order());
        let loss = self.p.motor_friction.viscous_nm_s_rad + gear.damping_nm_s_rad / (N * N);
        let mut A = Mat::zeros(n + 2, n + 2);
        A.set_block(0, 0, &electrical.A);
        for k in 0..n {
            A[(k, n)] = electrical.B[1][k];
            A[(n, k)] = motor.torque_constant_nm_a * electrical.C[k] / J;
        }
        A[(n, n)] = -loss / J;
        if electrical.D[1] != 0.0 {
            A[(n, n)] += motor.torque_constant_nm_a * electrical.D[1] / J;
        }
        A[(n, n + 1)] = -gear.stiffness_nm_rad / (N * J);
        A[(n + 1, n)] = 1.0 / N;
        A
    }

    /// Returns the voltage that the amplifier's map makes of the control, V.
    pub fn drive_of_control(&self, control_v: &[f64]) -> Vec<f64> {
        control_v.iter().map(|u| self.p.amplifier.drive_v(*u, &self.p.motor)).collect()
    }

    /// Returns the rate that the rotor's inertia feels, w_m + s w_p, rad/s.
    pub fn rotor_rate(&self, motor: &[f64], platform: &[f64]) -> Vec<f64> {
        let coupling = self.p.motor.platform_coupling;
        motor.iter().zip(platform).map(|(motor, base)| motor + coupling * base).collect()
    }

    /// Returns the torque that the transmission passes to the hub, N m, from the control (V) and the rates of motor and platform (rad/s) as
    /// the loop's sensor shows them:
    ///
    /// ```text
    ///     T = N (K_t i - J_m d(w_m + s w_p)/dt - F_m sgn w_m - b_m w_m)
    /// ```
    pub fn passed_torque(&self, control_v: &[f64], motor: &[f64], platform: &[f64]) -> Vec<f64> {
        let (p, friction) = (self.p, &self.p.motor_friction);
        let driven = self.current_of_drive(&self.drive_of_control(control_v));
        let braked = self.current_of_rate(motor);
        let accelerations = derivative(&self.rotor_rate(motor, platform), self.period_s);
        let (dry_nm, viscous) = (friction.coulomb_nm(), friction.viscous_nm_s_rad);
        let at = |k: usize| {
            let made = p.motor.torque_constant_nm_a * (driven[k] + braked[k]);
            let lost = dry_nm * motor[k].signum() + viscous * motor[k];
            p.gearbox.ratio * (made - p.motor.inertia_kg_m2 * accelerations[k] - lost)
        };
        (0..motor.len()).map(at).collect()
    }

    /// Returns the current (A) that the back-EMF of a motor rate (rad/s) makes.
    pub fn current_of_rate(&self, motor_rate: &[f64]) -> Vec<f64> {
        let filter = Filter::new(&Electrical::of(self.p).system(1), self.period_s);
        filter
            .map_or_else(|| vec![0.0; motor_rate.len()], |filter| filter.run(motor_rate, InputHold::Straight))
    }

    /// Returns the rate of the mean inertia, the sum of J_k w_k over J: the inertias beyond the hub move as their springs and the
    /// measured hub make them.
    pub fn mean_rate(&self, hub_rate: &[f64]) -> Vec<f64> {
        let Some(l) = self.p.lumped.as_ref().filter(|l| !l.is_rigid()) else { return hub_rate.to_vec() };
        let total = l.inertia_kg_m2();
        let share = (total - l.hub_inertia_kg_m2) / total;
        let Some(filter) = Filter::new(&beyond_the_hub(l), self.period_s) else {
            return hub_rate.to_vec();
        };
        let beyond = filter.run(hub_rate, InputHold::Straight);
        hub_rate.iter().zip(&beyond).map(|(h, b)| (1.0 - share) * h + share * b).collect()
    }
}

/// Returns a series so many samples later; its ends are held beyond the ends.
fn shift_later(series: &[f64], samples: f64) -> Vec<f64> {
    if samples.abs() < ON_SAMPLE {
        return series.to_vec();
    }
    let last = series.len().saturating_sub(1);
    let at = |k: usize| {
        let place = (k as f64 - samples).clamp(0.0, last as f64);
        let (low, share) = (place as usize, place.fract());
        series[low] * (1.0 - share) + series[(low + 1).min(last)] * share
    };
    (0..series.len()).map(at).collect()
}

/// Returns the system from the hub's rate to the mean rate of the inertias beyond it. States: of each inertia, the twist of its spring
/// and its rate.
fn beyond_the_hub(l: &LumpedStructure) -> System {
    let first = Link {
        inertia_kg_m2: l.beam_inertia_kg_m2,
        stiffness_nm_rad: l.stiffness_nm_rad,
        damping_nm_s_rad: l.damping_nm_s_rad,
    };
    let links: Vec<Link> = std::iter::once(first).chain(l.chain.iter().copied()).collect();
    let n = 2 * links.len();
    let sum: f64 = links.iter().map(|link| link.inertia_kg_m2).sum();
    let (mut A, mut B) = (Mat::zeros(n, n), Mat::zeros(n, 1));
    for (k, link) in links.iter().enumerate() {
        let (twist, rate) = (2 * k, 2 * k + 1);
        let (stiff, damp) =
            (link.stiffness_nm_rad / link.inertia_kg_m2, link.damping_nm_s_rad / link.inertia_kg_m2);
        A[(twist, rate)] = -1.0;
        A[(rate, twist)] = stiff;
        A[(rate, rate)] -= damp;
        if k == 0 {
            (B[(twist, 0)], B[(rate, 0)]) = (1.0, damp);
            continue;
        }
        // the inertia before feels the same spring
        let before = links[k - 1].inertia_kg_m2;
        A[(twist, rate - 2)] = 1.0;
        A[(rate, rate - 2)] = damp;
        A[(rate - 2, twist)] -= link.stiffness_nm_rad / before;
        A[(rate - 2, rate - 2)] -= link.damping_nm_s_rad / before;
        A[(rate - 2, rate)] += link.damping_nm_s_rad / before;
    }
    let output = (0..n).map(|i| if i % 2 == 1 { links[i / 2].inertia_kg_m2 / sum } else { 0.0 }).collect();
    System { A, B, output, direct: 0.0 }
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
    fn every_kind_of_drive_has_its_static_gain_and_its_back_emf() {
        let rig = reference::rig();
        let kinds = [
            AmplifierDynamics::Modelled,
            AmplifierDynamics::IdealCurrent,
            AmplifierDynamics::CurrentLoop { bandwidth_rad_s: 2e3, delay_s: 0.0 },
            AmplifierDynamics::TorqueCommand,
        ];
        for dynamics in kinds {
            for (lag, inductance) in [(1.5e-3, 4e-3), (1.5e-3, 0.0), (0.0, 4e-3), (0.0, 0.0)] {
                let mut p = rig.clone();
                p.amplifier.dynamics = dynamics;
                (p.amplifier.time_constant_s, p.motor.inductance_h) = (lag, inductance);
                let chain = Chain::new(&p, 1e-3);
                let stalled = 0.5 * p.amplifier.stall_gain_a_v(&p.motor);
                let driven = chain.current_of_drive(&[0.5; 400])[399];
                assert!((driven / stalled - 1.0).abs() < 1e-9, "{dynamics:?} {driven} {stalled}");
                let braked = chain.current_of_rate(&[10.0; 400])[399];
                let loss = p.motor.resistance_ohm + p.amplifier.gain * p.amplifier.current_feedback_v_a;
                let is_modelled = dynamics == AmplifierDynamics::Modelled;
                let expected = if is_modelled { -10.0 * p.motor.back_emf_v_s_rad / loss } else { 0.0 };
                assert!((braked - expected).abs() < 1e-9, "{dynamics:?} {braked} {expected}");
                let even = chain.motor_rate(&[0.0; 2000], &[0.1; 2000], &[1.0; 2000]);
                assert!((even[1999] - 0.1 * p.gearbox.ratio).abs() < 1e-6, "{dynamics:?} {}", even[1999]);
            }
        }
    }

    #[test]
    fn a_chain_that_turns_evenly_has_the_hubs_rate_and_resonates_where_its_modes_are() {
        let mut p = reference::rig();
        let lumped = p.lumped.as_mut().unwrap();
        lumped.chain = vec![Link { inertia_kg_m2: 30.0, stiffness_nm_rad: 2e6, damping_nm_s_rad: 100.0 }; 2];
        let mean = Chain::new(&p, 1e-3).mean_rate(&[0.3; 50]);
        assert!(mean.iter().all(|w| (w - 0.3).abs() < 1e-9));
        let lumped = p.lumped.as_ref().unwrap();
        let system = beyond_the_hub(lumped);
        // the hub held: the determinant of the held chain's matrix is the product of k_j / J_j
        let product = lumped.stiffness_nm_rad / lumped.beam_inertia_kg_m2 * (2e6_f64 / 30.0).powi(2);
        let determinant = counterpoise_linalg::eigenvalues(&system.A)
            .unwrap()
            .iter()
            .fold(1.0, |product, pole| product * pole.norm());
        assert!((determinant / product - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_beam_that_turns_evenly_has_the_hubs_rate() {
        let rig = reference::rig();
        let mean = Chain::new(&rig, 1e-3).mean_rate(&[0.3; 50]);
        assert!(mean.iter().all(|w| (w - 0.3).abs() < 1e-9));
    }
}
