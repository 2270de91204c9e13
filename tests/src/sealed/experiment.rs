//! Experiments: what is demanded, how the platform moves, and what the recorder writes down.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::f64::consts::TAU;

use super::machine::{Gyro, Machine, Platform, STATES};

/// Samples of a recording.
pub const SAMPLES: usize = 5_000;
/// Sample period, s.
pub const PERIOD: f64 = 1e-3;
/// Steps of the integrator per sample.
const STEPS: usize = 16;
/// Samples for which the loop holds still before the recorder starts.
const HOLD: usize = 2_000;

/// The four kinds of experiment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Triangle,
    Steps,
    Road,
    Multisine,
}

/// The loop's controller and sensors while recording.
#[derive(Debug, Clone)]
pub struct Recorder {
    pub kp: f64,
    pub ki: f64,
    pub bias: f64,
    pub input_bits: u32,
    pub output_bits: u32,
    pub tachometer: Gyro,
    pub resolver: Gyro,
}

/// The columns that a recorder writes.
#[derive(Debug, Clone, Default)]
pub struct WrittenColumns {
    pub demand: Vec<f64>,
    pub control: Vec<f64>,
    pub hub_rate: Vec<f64>,
    pub platform_rate: Vec<f64>,
    pub platform_accel: Vec<f64>,
    pub motor_rate: Vec<f64>,
    pub hub_position: Vec<f64>,
}

/// Seeded numbers.
#[derive(Clone)]
pub struct Dice(ChaCha8Rng);

impl Dice {
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64)
    }

    pub fn draw_below(&mut self, count: usize) -> usize {
        (self.0.next_u64() % count as u64) as usize
    }

    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform(f64::MIN_POSITIVE, 1.0).ln()).sqrt();
        radius * (TAU * self.uniform(0.0, 1.0)).cos()
    }
}

/// A sum of sines: amplitude, frequency in Hz, phase.
type Sines = Vec<[f64; 3]>;

fn at(sines: &Sines, t: f64) -> f64 {
    sines.iter().map(|[a, f, p]| a * (TAU * f * t + p).sin()).sum()
}

/// Demand and platform motion of one experiment.
pub struct Experiment {
    kind: Kind,
    amplitude: f64,
    period: f64,
    levels: Vec<f64>,
    multisine: Sines,
    pitch: Sines,
    heave: Sines,
}

impl Experiment {
    pub fn new(kind: Kind, dice: &mut Dice) -> Self {
        let mut sines = |count: usize, low: f64, high: f64, rms: f64| -> Sines {
            let each = rms * (2.0 / count as f64).sqrt();
            let frequency = |k: usize| low * (high / low).powf((k as f64 + 0.5) / count as f64);
            (0..count).map(|k| [each, frequency(k), dice.uniform(0.0, TAU)]).collect()
        };
        let multisine = sines(24, 0.2, 14.0, 0.05);
        let pitch = sines(9, 0.25, 3.0, 1.0);
        let heave = sines(9, 0.5, 5.0, 1.75);
        let pitch =
            pitch.into_iter().map(|[_, f, p]| [0.117 * (2.0f64 / 9.0).sqrt() / (TAU * f), f, p]).collect();
        Self {
            kind,
            amplitude: dice.uniform(0.11, 0.16),
            period: dice.uniform(1.6, 2.6),
            levels: (0..20).map(|_| dice.uniform(-0.17, 0.17)).collect(),
            multisine,
            pitch,
            heave,
        }
    }

    fn demand(&self, t: f64) -> f64 {
        match self.kind {
            Kind::Road => 0.0,
            Kind::Multisine => at(&self.multisine, t),
            Kind::Steps => self.levels[((t / 0.7) as usize).min(self.levels.len() - 1)] * self.alternate(t),
            Kind::Triangle => {
                let phase = (t / self.period + 0.25).rem_euclid(1.0);
                self.amplitude * (1.0 - 4.0 * (phase - 0.5).abs())
            }
        }
    }

    /// Every other step goes back, so that the mechanism stays near its middle.
    fn alternate(&self, t: f64) -> f64 {
        if ((t / 0.7) as usize).is_multiple_of(2) { 1.0 } else { -1.0 }
    }

    /// Platform motion, faded in over the first half second.
    fn platform(&self, t: f64) -> Platform {
        if self.kind != Kind::Road || t <= 0.0 {
            return Platform::default();
        }
        let angle = |t: f64| at(&self.pitch, t) * fade(t);
        let h = 1e-4;
        let (before, here, after) = (angle((t - h).max(0.0)), angle(t), angle(t + h));
        Platform {
            angle: here,
            rate: (after - before) / (2.0 * h),
            acceleration: (after - 2.0 * here + before) / (h * h),
            heave: at(&self.heave, t) * fade(t),
        }
    }
}

fn fade(t: f64) -> f64 {
    let s = (t / 0.5).clamp(0.0, 1.0);
    s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
}

fn quantise(value: f64, bits: u32) -> f64 {
    let step = 20.0 / f64::from(1u32 << bits);
    ((value / step).round() * step).clamp(-10.0, 10.0)
}

/// A reading of a sensor: its state with errors, noise, converter.
fn read(sensor: &Gyro, value: f64, heave: f64, bits: u32, dice: &mut Dice) -> f64 {
    let reading = sensor.gain * value + sensor.bias + sensor.per_heave * heave + sensor.noise * dice.normal();
    quantise(reading * sensor.volts, bits) / sensor.volts
}

/// Returns what came out of a sensor some samples ago.
fn late_reading(history: &[f64], samples: usize) -> f64 {
    history[history.len().saturating_sub(1 + samples)]
}

/// Runs the machine through an experiment in closed loop with the recorder's own controller and writes it down.
pub fn record(
    machine: &Machine,
    recorder: &Recorder,
    experiment: &Experiment,
    dice: &mut Dice,
) -> WrittenColumns {
    let mut integral = 0.0;
    let mut law = |readings: &[f64; 6]| {
        let error = readings[0] - readings[1];
        let control = recorder.kp * error + integral + recorder.bias;
        integral += recorder.ki * PERIOD * error;
        control
    };
    record_under(machine, recorder, &mut law, experiment, dice)
}

/// Runs the machine through an experiment in closed loop and writes it down. The law makes volts of demand, hub rate, platform rate and
/// acceleration, motor rate and hub position.
pub fn record_under(
    machine: &Machine,
    recorder: &Recorder,
    law: &mut dyn FnMut(&[f64; 6]) -> f64,
    experiment: &Experiment,
    dice: &mut Dice,
) -> WrittenColumns {
    let mut out = WrittenColumns::default();
    let mut x = machine.at_rest();
    let mut pending = vec![recorder.bias; machine.delay_samples];
    let mut past: [Vec<f64>; 3] = Default::default();
    for k in 0..HOLD + SAMPLES {
        let t = (k as f64 - HOLD as f64) * PERIOD;
        let platform = experiment.platform(t);
        for (s, history) in past.iter_mut().enumerate() {
            history.push(x[10 + 2 * s]);
        }
        let bits = recorder.input_bits;
        let hub = read(
            &machine.hub_gyro,
            late_reading(&past[0], machine.hub_gyro.late),
            platform.heave,
            bits,
            dice,
        );
        let skew = machine.platform_late;
        let pitch = read(
            &machine.platform_gyro,
            late_reading(&past[1], machine.platform_gyro.late + skew),
            platform.heave,
            bits,
            dice,
        );
        let heave = read(
            &machine.accelerometer,
            late_reading(&past[2], machine.accelerometer.late + skew),
            0.0,
            bits,
            dice,
        );
        let motor = read(&recorder.tachometer, x[3], 0.0, bits, dice);
        let position = read(&recorder.resolver, x[4] - platform.angle, 0.0, bits, dice);
        let demand = if k < HOLD { 0.0 } else { experiment.demand(t) };
        let control = quantise(law(&[demand, hub, pitch, heave, motor, position]), recorder.output_bits);
        pending.push(control);
        let applied = pending.remove(0);
        if k >= HOLD {
            out.demand.push(demand);
            out.control.push(control);
            out.hub_rate.push(hub);
            out.platform_rate.push(pitch);
            out.platform_accel.push(heave);
            out.motor_rate.push(motor);
            out.hub_position.push(position);
        }
        x = advance(machine, experiment, t, &x, applied);
    }
    out
}

fn advance(
    machine: &Machine,
    experiment: &Experiment,
    t: f64,
    x: &[f64; STATES],
    control: f64,
) -> [f64; STATES] {
    let h = PERIOD / STEPS as f64;
    let mut x = *x;
    for s in 0..STEPS {
        let now = t + s as f64 * h;
        let platform = [0.0, 0.5, 1.0].map(|c| experiment.platform(now + c * h));
        x = machine.step(now.max(0.0), h, &x, control, platform);
    }
    x
}
