//! One recording as rows of the torque balance, all its signals passed by the same low-pass Q and the gyroscope's lag G:
//!
//! ```text
//!     Q G [N K_t i] - N J_m Q' G [w_m + s w_p] - known
//!         = mu Q G [(g + a_p) cos theta] + F_c Q [sgn v] + F_v Q [v] + J Q' [w]
//! ```
//!
//! sgn v is that of the motor's rate, v the mean of motor's and hub's rates on the platform, at the output, weighted by
//! their parts of the viscous friction in the project (they differ while the gear twists); w is the rate of the mean
//! inertia, `known` the torque of what is known: the first moment above the axis and the spring to the platform.

use counterpoise_models::{AccelerometerAxis, AxisKind, FeedbackSignal, Parameters};
use counterpoise_recordings::{Channel, ColumnName, Recording, Signals, repeat_last};

use super::signal::{Chain, Kernel};
use crate::Error;
use crate::machine::{SteadyDrive, cosine, sine};
use crate::recording::series::derivative;
use crate::tolerance::identification::*;

/// A column of the rows of one recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowColumn {
    /// Torque that current and rotor leave for the hub, N m.
    Torque,
    /// Weight and heave, m/s^2: the regressor of the first moment.
    Weight,
    /// Sign of the rate after the low-pass: the regressor of the Coulomb level.
    Sign,
    /// Rate, rad/s: the regressor of the viscous friction.
    Rate,
    /// Acceleration, rad/s^2: the regressor of the inertia.
    Acceleration,
    /// Control as recorded, V.
    Control,
    /// Control after the low-pass, V.
    SmoothControl,
    /// Hub rate after the low-pass, rad/s.
    SmoothHubRate,
    /// Direction of sliding, 1 or -1.
    Direction,
    /// The share of a knot of a change of the amplifier's map in the torque of the map as it is, N m per V. There is a column for each knot,
    /// which is why these stand last.
    Knot(usize),
}

impl RowColumn {
    /// Number of columns before those of the knots.
    const FIXED: usize = 9;
}

impl ColumnName for RowColumn {
    fn index(self) -> usize {
        match self {
            Self::Torque => 0,
            Self::Weight => 1,
            Self::Sign => 2,
            Self::Rate => 3,
            Self::Acceleration => 4,
            Self::Control => 5,
            Self::SmoothControl => 6,
            Self::SmoothHubRate => 7,
            Self::Direction => 8,
            Self::Knot(knot) => Self::FIXED + knot,
        }
    }
}

/// Rows of one recording; a row is a sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    /// The torque, the regressors and the signals that they are chosen by.
    pub signals: Signals<RowColumn>,
    /// `true` if the row is sliding throughout the filter's window.
    pub sliding: Vec<bool>,
    /// `true` if the joint has not yet slid its presliding distance since it turned.
    pub turning: Vec<bool>,
    /// Variance of the noise in rate and acceleration after the filter.
    pub noise: [f64; 2],
    /// Covariance of that noise with the noise in the torque: the motor's rate follows from the same reading if it has no sensor.
    pub noise_in_torque: [f64; 2],
    /// The effect of the accelerometer's lever arm; `None` if the recording does not show it.
    pub lever_arm: Option<LeverArmColumn>,
    /// Sample period, s.
    pub period_s: f64,
}

/// The effect of a longer lever arm of the accelerometer: the reading then holds more of the pitch acceleration, and less of heave acts on the
/// out-of-balance.
#[derive(Debug, Clone, PartialEq)]
pub struct LeverArmColumn {
    /// -mu Q G [w_p' cos theta] with the project's moment mu, N m per metre of arm.
    pub torque_per_metre: Vec<f64>,
    /// Variance of its noise.
    pub noise: f64,
}

/// The data from which rows are made: the mechanism, the low-pass (its standard deviation, s), the knots of the amplifier's map (V).
pub struct Maker<'a> {
    /// The mechanism.
    pub p: &'a Parameters,
    /// Standard deviation of the low-pass, s.
    pub deviation_s: f64,
    /// Knots, V.
    pub knots_v: &'a [f64],
}

/// A column of the channels of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ChannelColumn {
    /// Control, V.
    Control,
    /// Hub rate, rad/s.
    Hub,
    /// Platform rate, rad/s.
    Platform,
    /// Heave, m/s^2.
    Heave,
    /// Hub rate on the platform, rad/s.
    Relative,
    /// Hub angle on the platform as the hub gyroscope would show it, rad.
    Position,
    /// Motor rate as the loop's sensor would show it, from the motor's tachometer or from the loop's sensor on the motor, rad/s; there is no
    /// such column if neither shows it.
    Motor,
}

impl ColumnName for ChannelColumn {
    fn index(self) -> usize {
        self as usize
    }
}

/// The channels of a recording without gaps, missing ones filled in by what they mean.
struct Channels {
    signals: Signals<ChannelColumn>,
    /// The source of the noise of the hub's rate.
    noise: RateNoise,
    /// `true` for the samples in which the recording has every channel.
    whole: Vec<bool>,
}

impl Channels {
    fn control(&self) -> &[f64] {
        self.signals.column(ChannelColumn::Control)
    }

    fn hub(&self) -> &[f64] {
        self.signals.column(ChannelColumn::Hub)
    }

    fn platform(&self) -> &[f64] {
        self.signals.column(ChannelColumn::Platform)
    }

    fn relative(&self) -> &[f64] {
        self.signals.column(ChannelColumn::Relative)
    }

    fn position(&self) -> &[f64] {
        self.signals.column(ChannelColumn::Position)
    }

    /// Returns the motor's rate; `None` if no sensor shows it.
    fn motor(&self) -> Option<&[f64]> {
        self.signals.has(ChannelColumn::Motor).then(|| self.signals.column(ChannelColumn::Motor))
    }
}

/// The source of the noise of the hub's rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum RateNoise {
    /// A sensor of the rate: white noise, which the low-pass lets through in part.
    White,
    /// A sensor of the position: its noise is differentiated, and the low-pass takes nearly all of it.
    Differentiated,
    /// The motor's tachometer, white; and a sensor of the torque, whose noise is differentiated.
    WhiteOfMotor,
}

impl Rows {
    /// Returns the torque that current and rotor leave for the hub, N m.
    pub fn torque(&self) -> &[f64] {
        self.signals.column(RowColumn::Torque)
    }

    /// Returns the control as recorded, V.
    pub fn control_v(&self) -> &[f64] {
        self.signals.column(RowColumn::Control)
    }

    /// Returns the control after the low-pass, V.
    pub fn smooth_control_v(&self) -> &[f64] {
        self.signals.column(RowColumn::SmoothControl)
    }

    /// Returns the hub rate after the low-pass, rad/s.
    pub fn smooth_rate_rad_s(&self) -> &[f64] {
        self.signals.column(RowColumn::SmoothHubRate)
    }

    /// Returns the direction of sliding, 1 or -1.
    pub fn direction(&self) -> &[f64] {
        self.signals.column(RowColumn::Direction)
    }
}

impl Maker<'_> {
    /// Returns the rows of a recording.
    ///
    /// # Errors
    /// No control or no hub rate.
    pub fn rows(&self, recording: &Recording) -> Result<Rows, Error> {
        let period_s = recording.sample_period_s;
        let (chain, kernel) = (Chain::new(self.p, period_s), Kernel::new(self.deviation_s, period_s));
        let channels = channels(recording, &chain, self.p)?;
        let ratio = self.p.gearbox.ratio;
        let twisting = || self.motor_behind_gear(&chain, &channels);
        let motor: Vec<f64> = channels.motor().map_or_else(twisting, <[f64]>::to_vec);
        let driven: Vec<f64> = motor.iter().map(|w| w / ratio).collect();
        let rate = self.damped_rate(&driven, &channels);
        let (direction, turning) = self.directions(&driven, period_s);
        let mean = chain.mean_rate(channels.hub());
        let variance = |series: &[f64]| match channels.noise {
            RateNoise::White => noise_variance(series),
            RateNoise::Differentiated => 0.0,
            RateNoise::WhiteOfMotor => noise_variance(&driven),
        };
        let noise = variance(channels.hub());
        let [kept, steep] = kernel.noise_gains();
        let variances = [variance(&rate) * kept, noise * steep];
        let shared = if self.p.sensors.motor_tachometer.is_none() { self.losses_of_rate() } else { [0.0; 2] };
        let columns = [
            self.torque(&chain, &kernel, &channels, &motor),
            kernel.smooth(&self.load(&chain, &channels, cosine)),
            kernel.smooth(&direction),
            kernel.smooth(&rate),
            kernel.slope(&mean),
            channels.control().to_vec(),
            kernel.smooth(channels.control()),
            kernel.smooth(channels.hub()),
            direction,
        ];
        let hats = self.hats(&chain, &kernel, channels.control());
        Ok(Rows {
            signals: Signals::stack(columns.iter().chain(&hats).map(Vec::as_slice)),
            lever_arm: self.lever_arm(recording, &kernel, &channels, &chain),
            sliding: self.sliding(&kernel, &channels, &turning, &self.smooth_for_sign(&driven, period_s)),
            turning,
            noise: variances,
            noise_in_torque: [-shared[0] * variances[0], -shared[1] * variances[1]],
            period_s,
        })
    }

    fn torque(&self, chain: &Chain, kernel: &Kernel, c: &Channels, motor: &[f64]) -> Vec<f64> {
        let p = self.p;
        let ratio = p.gearbox.ratio;
        let driven = chain.current_of_drive(&chain.drive_of_control(c.control()));
        let braked = chain.current_of_rate(motor);
        let gain = ratio * p.motor.torque_constant_nm_a;
        let current = kernel.smooth(&sum(&driven, &braked, gain));
        let rotor = kernel.slope(&chain.rotor_rate(motor, c.platform()));
        let known = kernel.smooth(&self.known_torque(chain, c));
        let inertia = ratio * p.motor.inertia_kg_m2;
        (0..current.len()).map(|k| current[k] - inertia * rotor[k] - known[k]).collect()
    }

    /// Torque at the hub per rate of the joint that the back-EMF takes, N m s/rad, and per acceleration that the rotor takes, kg m^2.
    fn losses_of_rate(&self) -> [f64; 2] {
        let (p, drive) = (self.p, SteadyDrive::of(self.p));
        let square = p.gearbox.ratio * p.gearbox.ratio;
        let back = p.motor.torque_constant_nm_a * drive.back_emf / drive.loss;
        [square * back, square * p.motor.inertia_kg_m2]
    }

    /// The motor's rate where no sensor shows it: the joint's, and the twist of the gear under the control's torque.
    fn motor_behind_gear(&self, chain: &Chain, c: &Channels) -> Vec<f64> {
        let (direction, _) = self.directions(c.relative(), chain.period_s());
        chain.motor_rate(&chain.drive_of_control(c.control()), c.relative(), &direction)
    }

    /// The rate that viscous friction acts on: the motor's and the hub's, each by its part of it.
    fn damped_rate(&self, driven: &[f64], c: &Channels) -> Vec<f64> {
        let p = self.p;
        let pivot = p.pivot_friction.viscous_nm_s_rad;
        let all = pivot + p.gearbox.ratio.powi(2) * p.motor_friction.viscous_nm_s_rad;
        let part = if all > 0.0 { pivot / all } else { 0.5 };
        driven.iter().zip(c.relative()).map(|(motor, hub)| motor + part * (hub - motor)).collect()
    }

    /// (g + a_p) f(theta_h), as the gyroscope would show it.
    fn load(&self, chain: &Chain, c: &Channels, of: fn(&Parameters, f64) -> f64) -> Vec<f64> {
        let heave = chain.heave_as_gyro(c.signals.column(ChannelColumn::Heave));
        let weigh = |(angle, heave): (f64, &f64)| (self.p.gravity_m_s2 + heave) * of(self.p, angle);
        inertial(c, chain).into_iter().zip(&heave).map(weigh).collect()
    }

    /// Torque of what is taken as known: the first moment above the axis, the spring to the platform.
    fn known_torque(&self, chain: &Chain, c: &Channels) -> Vec<f64> {
        let Some(l) = self.p.lumped.as_ref() else { return vec![0.0; c.signals.len()] };
        let upright = self.load(chain, c, sine);
        let spring = |x: &f64| l.position_stiffness_nm_rad * (x - l.position_stiffness_centre_rad);
        upright.iter().zip(c.position()).map(|(g, x)| spring(x) - l.vertical_offset_kg_m * g).collect()
    }

    /// Returns what the accelerometer's lever arm does; `None` if there is none to be identified, or the platform hardly pitches.
    fn lever_arm(
        &self,
        recording: &Recording,
        kernel: &Kernel,
        c: &Channels,
        chain: &Chain,
    ) -> Option<LeverArmColumn> {
        let (p, sensors) = (self.p, &self.p.sensors);
        let is_fitted = sensors.platform_accelerometer.is_fitted() && sensors.platform_gyro.is_fitted();
        let is_level =
            sensors.accelerometer_axis == AccelerometerAxis::Vertical && p.axis == AxisKind::Rotary;
        let recorded = [Channel::PlatformAccel, Channel::PlatformRate].iter().all(|one| recording.has(*one));
        let moment = p.lumped.as_ref()?.out_of_balance_kg_m;
        if !(is_fitted && is_level && recorded) || moment == 0.0 {
            return None;
        }
        let pitching = kernel.slope(c.platform());
        let noise = noise_variance(c.platform()) * kernel.noise_gains()[1];
        let power = pitching.iter().map(|a| a * a).sum::<f64>() / pitching.len().max(1) as f64;
        let turned = inertial(c, chain).into_iter().map(|angle| cosine(p, angle));
        let torque_per_metre = pitching.iter().zip(turned).map(|(a, cos)| -moment * a * cos).collect();
        let found = LeverArmColumn { torque_per_metre, noise: moment * moment * noise };
        (power > LEAST_PITCH_OVER_NOISE * noise).then_some(found)
    }

    fn hats(&self, chain: &Chain, kernel: &Kernel, control: &[f64]) -> Vec<Vec<f64>> {
        let p = self.p;
        let gain = p.gearbox.ratio * p.motor.torque_constant_nm_a;
        let one = |index: usize| {
            let of = |u: &f64| -gain * u.signum() * hat_function(self.knots_v, index, u.abs());
            let shape: Vec<f64> = control.iter().map(of).collect();
            kernel.smooth(&chain.current_of_drive(&shape))
        };
        (1..self.knots_v.len().saturating_sub(1)).map(one).collect()
    }

    /// Direction of sliding, and whether the joint is still in its presliding zone.
    fn directions(&self, rate: &[f64], period_s: f64) -> (Vec<f64>, Vec<bool>) {
        let smooth = self.smooth_for_sign(rate, period_s);
        let slack = PRESLIDING_LENGTHS * presliding_rad(self.p);
        let mut travelled = 0.0;
        let mut turning = Vec::with_capacity(rate.len());
        for k in 0..rate.len() {
            let turned = k == 0 || (smooth[k] >= 0.0) != (smooth[k - 1] >= 0.0);
            travelled = if turned { 0.0 } else { travelled + smooth[k].abs() * period_s };
            turning.push(travelled < slack);
        }
        (smooth.iter().map(|w| if *w >= 0.0 { 1.0 } else { -1.0 }).collect(), turning)
    }

    /// The rate quiet enough for its sign to be taken.
    fn smooth_for_sign(&self, rate: &[f64], period_s: f64) -> Vec<f64> {
        Kernel::new(SIGN_DEVIATION_S.max(2.0 * period_s), period_s).smooth(rate)
    }

    /// Rows whose whole window slides, faster than crawling, with no limit reached and no sample missing.
    fn sliding(&self, kernel: &Kernel, c: &Channels, turning: &[bool], calm: &[f64]) -> Vec<bool> {
        let rms = (calm.iter().map(|w| w * w).sum::<f64>() / calm.len().max(1) as f64).sqrt();
        let limit = LIMIT_SHARE * self.p.amplifier.input_limit_v;
        let control = c.control();
        let good = |k: usize| {
            !turning[k] && c.whole[k] && calm[k].abs() > CRAWL_SHARE * rms && control[k].abs() < limit
        };
        let mut bad_so_far = vec![0_usize; turning.len() + 1];
        (0..turning.len()).for_each(|k| bad_so_far[k + 1] = bad_so_far[k] + usize::from(!good(k)));
        let half = kernel.half_length();
        let clear = |k: usize| {
            k >= half && k + half < turning.len() && bad_so_far[k + half + 1] == bad_so_far[k - half]
        };
        (0..turning.len()).map(clear).collect()
    }
}

/// Returns the hat function of a knot: 1 there, 0 at its neighbours and beyond.
pub fn hat_function(knots: &[f64], index: usize, at: f64) -> f64 {
    let (low, here, high) = (knots[index - 1], knots[index], knots[index + 1]);
    let up = (at - low) / (here - low);
    let down = (high - at) / (high - here);
    up.min(down).max(0.0)
}

/// Hub angle to the horizon, as the gyroscope would show it.
fn inertial(c: &Channels, chain: &Chain) -> Vec<f64> {
    let platform = integral(c.platform(), chain.period_s());
    c.position().iter().zip(&platform).map(|(a, b)| a + b).collect()
}

fn sum(a: &[f64], b: &[f64], gain: f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| gain * (a + b)).collect()
}

/// From 0 on, straight between samples.
fn integral(rate: &[f64], period_s: f64) -> Vec<f64> {
    let (mut angle, mut before) = (0.0, rate.first().copied().unwrap_or(0.0));
    let step = |w: &f64| {
        angle += 0.5 * (before + w) * period_s;
        before = *w;
        angle
    };
    rate.iter().map(step).collect()
}

/// Distance over which dry friction builds up after a reversal, at the output, rad: 0 if the law has none.
fn presliding_rad(p: &Parameters) -> f64 {
    let joints = [
        p.pivot_friction.law.presliding_deflection_rad(),
        p.motor_friction.law.presliding_deflection_rad() / p.gearbox.ratio,
    ];
    joints.into_iter().filter(|x| x.is_finite()).fold(LEAST_PRESLIDING_RAD, f64::max)
}

/// Returns the rate of the load, rad/s, from that of the motor and the torque that the transmission passes: it stays behind by the rate at
/// which the transmission is wound up, T'/k.
fn behind_the_gear(motor_rad_s: &[f64], torque_nm: &[f64], period_s: f64, p: &Parameters) -> Vec<f64> {
    let (ratio, stiffness) = (p.gearbox.ratio, p.gearbox.stiffness_nm_rad);
    let winding = derivative(torque_nm, period_s);
    motor_rad_s.iter().zip(winding).map(|(motor, steep)| motor / ratio - steep / stiffness).collect()
}

/// Variance of white noise, from second differences: they keep little of what moves.
fn noise_variance(series: &[f64]) -> f64 {
    let squares = series.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).powi(2));
    squares.sum::<f64>() / 6.0 / series.len().saturating_sub(2).max(1) as f64
}

/// Control, reading of the loop's sensor and rate of the platform.
struct LoopSignals<'a> {
    control: &'a [f64],
    reading: &'a [f64],
    platform: &'a [f64],
}

/// Rates of the hub on the platform and, where a sensor shows it, of the motor.
struct JointRates {
    relative: Vec<f64>,
    motor: Option<Vec<f64>>,
}

/// Returns the rates from the reading of the loop's sensor and that of the motor's tachometer; `None` if the loop's sensor shows no motion and the
/// motor has no tachometer.
fn joint_rates(
    signals: &LoopSignals<'_>,
    tachometer: Option<Vec<f64>>,
    chain: &Chain,
    p: &Parameters,
) -> Option<JointRates> {
    let LoopSignals { control, reading, platform } = *signals;
    let period_s = chain.period_s();
    let with_tachometer = |relative| JointRates { relative, motor: tachometer.clone() };
    let on_the_motor = |at_output: Vec<f64>| {
        let motor: Vec<f64> = at_output.iter().map(|rate| p.gearbox.ratio * rate).collect();
        let relative = match p.gearbox.is_rigid() {
            true => at_output,
            false => behind_the_gear(&motor, &chain.passed_torque(control, &motor, platform), period_s, p),
        };
        JointRates { relative, motor: Some(motor) }
    };
    Some(match p.sensors.measured {
        FeedbackSignal::HubRate => {
            with_tachometer(reading.iter().zip(platform).map(|(hub, base)| hub - base).collect())
        }
        FeedbackSignal::RelativeRate => with_tachometer(reading.to_vec()),
        FeedbackSignal::HubPosition => with_tachometer(derivative(reading, period_s)),
        FeedbackSignal::MotorRate => on_the_motor(reading.to_vec()),
        FeedbackSignal::MotorPosition => on_the_motor(derivative(reading, period_s)),
        // A torque and a current show no motion; the motor's tachometer does, and a torque how far the load stays behind.
        FeedbackSignal::Torque => {
            let motor = tachometer.as_ref()?;
            with_tachometer(behind_the_gear(motor, reading, period_s, p))
        }
        FeedbackSignal::Current => {
            let motor = tachometer.as_ref()?;
            with_tachometer(motor.iter().map(|rate| rate / p.gearbox.ratio).collect())
        }
    })
}

fn channels(r: &Recording, chain: &Chain, p: &Parameters) -> Result<Channels, Error> {
    let controlled = p.controlled_quantity();
    let missing = |channel| Error::NotIdentifiable { controlled, recording: r.name.clone(), channel };
    let period_s = r.sample_period_s;
    let recorded = |channel| r.samples(channel).ok_or_else(|| missing(channel));
    let (control, hub) = (recorded(Channel::Control)?, recorded(Channel::HubRate)?);
    let n = control.len().min(hub.len());
    let mut whole = vec![true; n];
    let mut filled = |column: &[f64]| {
        whole.iter_mut().enumerate().for_each(|(k, is_whole)| {
            *is_whole &= column.get(k).is_some_and(|value| value.is_finite());
        });
        let mut all = repeat_last(column);
        all.resize(n, all.last().copied().unwrap_or(0.0));
        all
    };
    let (control, reading) = (filled(control), chain.reading_of(&p.sensors.hub_gyro, &filled(hub)));
    let mut of_base = |channel, sensor| {
        r.samples(channel).map_or_else(|| vec![0.0; n], |column| chain.reading_of(sensor, &filled(column)))
    };
    let platform = of_base(Channel::PlatformRate, &p.sensors.platform_gyro);
    let mut heave = of_base(Channel::PlatformAccel, &p.sensors.platform_accelerometer);
    let arm = p.sensors.accelerometer_lever_arm_m;
    if arm != 0.0 {
        let pitching = derivative(&platform, period_s);
        heave.iter_mut().zip(pitching).for_each(|(reading, a)| *reading -= arm * a);
    }
    let tachometer = r.samples(Channel::MotorRate).zip(p.sensors.motor_tachometer.as_ref());
    let tachometer =
        tachometer.map(|(column, sensor)| chain.as_gyro(&chain.reading_of(sensor, &filled(column))));
    let signals = LoopSignals { control: &control, reading: &reading, platform: &platform };
    let JointRates { relative, motor } =
        joint_rates(&signals, tachometer, chain, p).ok_or_else(|| missing(Channel::MotorRate))?;
    let measured = p.sensors.measured;
    let hub = match measured {
        FeedbackSignal::HubRate => reading.clone(),
        _ => relative.iter().zip(&platform).map(|(r, p)| r + p).collect(),
    };
    // the integral of what the gyroscopes read has their lag already
    let resolver = r.samples(Channel::HubPosition).zip(p.sensors.hub_resolver.as_ref());
    let position = match resolver {
        Some((column, sensor)) => chain.as_gyro(&chain.reading_of(sensor, &filled(column))),
        None if measured.is_position() => reading,
        None => integral(&relative, period_s),
    };
    let noise = match measured {
        FeedbackSignal::Torque => RateNoise::WhiteOfMotor,
        _ if measured.is_position() => RateNoise::Differentiated,
        _ => RateNoise::White,
    };
    // in the order of `ChannelColumn`
    let columns = [&control[..], &hub, &platform, &heave, &relative, &position];
    let signals = Signals::stack(columns.into_iter().chain(motor.as_deref()));
    Ok(Channels { signals, noise, whole })
}
