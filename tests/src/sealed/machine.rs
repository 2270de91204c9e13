//! The mechanism of the reference rig, written apart from the studio's simulator: Runge and Kutta's classical method
//! at a fixed step, states and friction in forms of its own, for recordings whose truth the diagnosis cannot see.

/// Parameters of a sealed machine; every field in SI units.
#[derive(Debug, Clone)]
pub struct Machine {
    pub gravity: f64,
    pub hub_inertia: f64,
    pub beam_inertia: f64,
    pub beam_stiffness: f64,
    pub beam_damping: f64,
    pub moment: f64,
    pub moment_above: f64,
    pub spring: f64,
    pub spring_centre: f64,
    pub spring_cubic: f64,
    /// Level, N m, and stiffness, N m/rad, of a hose that remembers (Bouc and Wen), between hub and platform.
    pub hysteresis: [f64; 2],
    pub ratio: f64,
    pub gear_stiffness: f64,
    pub gear_damping: f64,
    pub backlash: f64,
    pub motor_inertia: f64,
    pub torque_constant: f64,
    pub back_emf: f64,
    pub resistance: f64,
    pub inductance: f64,
    pub cogging: [f64; 3],
    /// Amplitude, order per motor turn, phase: of the torque constant, and of the torque on the hub.
    pub torque_ripple: [f64; 3],
    pub mesh_ripple: [f64; 3],
    pub mesh_efficiency: f64,
    pub amplifier_gain: f64,
    pub current_feedback: f64,
    pub amplifier_time: f64,
    pub amplifier_curve: Vec<[f64; 2]>,
    pub dead_zone: f64,
    pub current_limit: f64,
    pub motor_friction: DahlFriction,
    pub pivot_friction: DahlFriction,
    pub quadratic_drag: f64,
    pub delay_samples: usize,
    pub hub_gyro: Gyro,
    pub platform_gyro: Gyro,
    pub accelerometer: Gyro,
    pub lever_arm: f64,
    pub platform_late: usize,
    /// Torque on the hub that no model of the library has: amplitude, frequency in Hz, phase (a pump, a fan).
    pub hum: [f64; 3],
    /// Relative loss of drive torque per second of running, up to a fifth.
    pub fading: f64,
    /// Functions that no formula of the library equals.
    pub hidden: Vec<HiddenFunction>,
    /// Levels, N m, and stiffnesses, N m/rad, of elements that stretch and then slip, between hub and platform.
    pub slips: [[f64; 2]; SLIPS],
}

/// Number of elements that slip.
pub const SLIPS: usize = 3;

/// A function of one variable, somewhere in the machine.
#[derive(Debug, Clone, PartialEq)]
pub struct HiddenFunction {
    pub acts: FunctionTarget,
    pub over: FunctionVariable,
    /// Terms; they add up.
    pub terms: Vec<Term>,
}

/// Quantity that a hidden function acts on: a torque, N m, or a factor of 1 to which it is added.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FunctionTarget {
    PivotTorque,
    PivotLevel,
    MotorTorque,
    MotorLevel,
    TorqueConstant,
    GearStiffness,
}

/// Variable of a hidden function.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FunctionVariable {
    /// The hub's angle on the platform, rad.
    Angle,
    /// The hub's rate on the platform, rad/s.
    Rate,
    /// The motor's angle, rad.
    Shaft,
    /// Torque of the gear, N m.
    Load,
    /// Time, s.
    Time,
}

/// A term of a hidden function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Term {
    /// a sin(n x + p).
    Sine([f64; 3]),
    /// Height, centre, width: h exp(-((x - c) / w)^2).
    Bump([f64; 3]),
    /// Coefficient and whole power.
    Power(f64, i32),
    /// Stiffness k, distance d and width w of a soft stop at either side.
    Stops([f64; 3]),
    /// a (1 - exp(-x / t)).
    Rise([f64; 2]),
}

impl Term {
    fn at(&self, x: f64) -> f64 {
        match *self {
            Self::Sine([a, n, p]) => a * (n * x + p).sin(),
            Self::Bump([height, centre, width]) => height * (-((x - centre) / width).powi(2)).exp(),
            Self::Power(coefficient, power) => coefficient * x.powi(power),
            Self::Stops([k, d, w]) => {
                let beyond = |y: f64| w * (1.0 + (y / w).exp()).ln();
                -k * (beyond(x - d) - beyond(-x - d))
            }
            Self::Rise([a, t]) => a * (1.0 - (-x.max(0.0) / t).exp()),
        }
    }
}

impl HiddenFunction {
    fn at(&self, x: f64) -> f64 {
        self.terms.iter().map(|term| term.at(x)).sum()
    }
}

/// The variables of hidden functions at an instant.
#[derive(Debug, Clone, Copy, Default)]
struct Regimes {
    angle: f64,
    rate: f64,
    shaft: f64,
    load: f64,
    time: f64,
}

impl Machine {
    /// Sum of the hidden functions of one kind.
    fn hidden_sum(&self, acts: FunctionTarget, at: Regimes) -> f64 {
        let value = |h: &HiddenFunction| {
            h.at(match h.over {
                FunctionVariable::Angle => at.angle,
                FunctionVariable::Rate => at.rate,
                FunctionVariable::Shaft => at.shaft,
                FunctionVariable::Load => at.load,
                FunctionVariable::Time => at.time,
            })
        };
        self.hidden.iter().filter(|h| h.acts == acts).map(value).sum()
    }
}

/// Dry friction by Dahl's law with exponent 1, Stribeck level, asymmetry, and viscous part.
#[derive(Debug, Clone)]
pub struct DahlFriction {
    pub level: f64,
    pub stiffness: f64,
    pub viscous: f64,
    pub static_ratio: f64,
    pub stribeck_rate: f64,
    pub asymmetry: f64,
    /// Amplitude, order per turn, phase of the level along the angle.
    pub along: [f64; 3],
    pub per_load: f64,
    /// Relative fall of the level, and its time constant.
    pub warming: [f64; 2],
}

/// The place of a friction: what its level may depend on beside the rate.
#[derive(Debug, Clone, Copy, Default)]
struct Place {
    angle: f64,
    load: f64,
    time: f64,
    /// The part that hidden functions add to a factor of 1.
    more: f64,
}

/// A sensor of second order with errors.
#[derive(Debug, Clone)]
pub struct Gyro {
    pub natural: f64,
    pub damping: f64,
    pub volts: f64,
    pub noise: f64,
    pub gain: f64,
    pub bias: f64,
    pub per_heave: f64,
    pub late: usize,
}

/// Motion of the platform at an instant.
#[derive(Debug, Clone, Copy, Default)]
pub struct Platform {
    pub angle: f64,
    pub rate: f64,
    pub acceleration: f64,
    pub heave: f64,
}

/// Number of states: drive voltage, current, motor angle and rate, hub angle and rate, beam angle and rate, two
/// friction torques, three sensors of two states, the hose's torque, those of the elements that slip.
pub const STATES: usize = 17 + SLIPS;

impl DahlFriction {
    /// Level at a rate and place.
    fn at(&self, rate: f64, place: Place) -> f64 {
        let stribeck = 1.0 + (self.static_ratio - 1.0) * (-(rate / self.stribeck_rate).powi(2)).exp();
        let [amplitude, order, phase] = self.along;
        let warm = 1.0 - self.warming[0] * (1.0 - (-place.time / self.warming[1]).exp());
        let own = self.level * (1.0 + amplitude * (order * place.angle + phase).sin()) * warm;
        // a friction that drives would be no friction
        let own = own * (1.0 + place.more).max(0.1);
        (own + self.per_load * place.load.abs()) * stribeck * (1.0 + self.asymmetry * rate.signum())
    }

    fn slope(&self, torque: f64, rate: f64, place: Place) -> f64 {
        self.stiffness * rate * (1.0 - torque / self.at(rate, place) * rate.signum())
    }
}

impl Machine {
    /// Input of the amplifier after dead zone and curve.
    fn amplifier_input(&self, control: f64) -> f64 {
        let v = control.clamp(-10.0, 10.0);
        let v = v.signum() * (v.abs() - self.dead_zone).max(0.0);
        if self.amplifier_curve.is_empty() {
            return v;
        }
        let linear = self.amplifier_gain / (self.resistance + self.amplifier_gain * self.current_feedback);
        let mut from = [0.0, 0.0];
        for &to in &self.amplifier_curve {
            if v.abs() <= to[0] {
                let current = from[1] + (to[1] - from[1]) * (v.abs() - from[0]) / (to[0] - from[0]);
                return v.signum() * current / linear;
            }
            from = to;
        }
        v
    }

    /// Torque of the gear's teeth: none inside the gap.
    fn mesh(&self, wound: f64, winding: f64) -> f64 {
        let half = 0.5 * self.backlash;
        if wound.abs() > half {
            self.gear_stiffness * (wound - half * wound.signum()) + self.gear_damping * winding
        } else {
            0.0
        }
    }

    /// Derivative of a hose's torque, of Bouc and Wen with n = 1 and beta = gamma = 1/2.
    fn hose(&self, torque: f64, sliding: f64) -> f64 {
        let [yields, stiff] = self.hysteresis;
        if yields <= 0.0 {
            return 0.0;
        }
        let bent = torque / yields;
        stiff * (sliding - 0.5 * sliding.abs() * bent - 0.5 * sliding * bent.abs())
    }

    /// Derivatives of the torques of the elements that slip.
    fn slip_slopes(&self, torques: &[f64], sliding: f64) -> [f64; SLIPS] {
        std::array::from_fn(|k| {
            let [level, stiffness] = self.slips[k];
            let slips = torques[k].abs() >= level && torques[k] * sliding > 0.0;
            if slips { 0.0 } else { stiffness * sliding }
        })
    }

    /// Returns the derivatives of the states.
    pub fn slopes(&self, t: f64, x: &[f64; STATES], control: f64, platform: Platform) -> [f64; STATES] {
        let [volts, amps, shaft, spin, hub, hub_rate, beam, beam_rate, motor_dry, pivot_dry, ..] = *x;
        let mut d = [0.0; STATES];
        let clamp = |v: f64| v.clamp(-150.0, 150.0);
        d[0] = (self.amplifier_gain * (self.amplifier_input(control) - self.current_feedback * amps) - volts)
            / self.amplifier_time;
        d[1] = (clamp(volts) - self.resistance * amps - self.back_emf * spin) / self.inductance;
        let fade = 1.0 - (self.fading * t).min(0.2);
        let wave = |[a, n, p]: [f64; 3]| a * (n * shaft + p).sin();
        let sliding = hub_rate - platform.rate;
        let mut at = Regimes { angle: hub - platform.angle, rate: sliding, shaft, load: 0.0, time: t };
        let own = self.torque_constant * (1.0 + wave(self.torque_ripple));
        let constant = own * (1.0 + self.hidden_sum(FunctionTarget::TorqueConstant, at));
        let drive = constant * fade * amps.clamp(-self.current_limit, self.current_limit);
        let wound = shaft / self.ratio + platform.angle - hub;
        let winding = spin / self.ratio + platform.rate - hub_rate;
        let gear = self.mesh(wound, winding);
        at.load = gear;
        let gear =
            gear + self.hidden_sum(FunctionTarget::GearStiffness, at) * (gear - self.gear_damping * winding);
        let lost = (1.0 - self.mesh_efficiency) * gear;
        let forward = 0.5 * (1.0 + spin / spin.hypot(0.05) * gear.signum());
        let (to_hub, to_motor) = (gear - forward * lost, gear - (1.0 - forward) * lost);
        d[2] = spin;
        d[3] = (drive + wave(self.cogging) + self.hidden_sum(FunctionTarget::MotorTorque, at)
            - motor_dry
            - self.motor_friction.viscous * spin
            - to_motor / self.ratio)
            / self.motor_inertia;
        let twist = self.beam_stiffness * (hub - beam) + self.beam_damping * (hub_rate - beam_rate);
        let weight =
            (self.gravity + platform.heave) * (self.moment * hub.cos() - self.moment_above * hub.sin());
        let stretch = hub - platform.angle - self.spring_centre;
        let cable = self.spring * stretch + self.spring_cubic * stretch.powi(3) + x[16];
        let drag = self.pivot_friction.viscous * sliding + self.quadratic_drag * sliding * sliding.abs();
        let slipping: f64 = x[17..].iter().sum();
        let free = self.hidden_sum(FunctionTarget::PivotTorque, at) - slipping;
        let hum = free + self.hum[0] * (std::f64::consts::TAU * self.hum[1] * t + self.hum[2]).sin();
        d[4] = hub_rate;
        d[5] = (to_hub + wave(self.mesh_ripple) + hum - twist - pivot_dry - drag - weight - cable)
            / self.hub_inertia;
        d[6] = beam_rate;
        d[7] = twist / self.beam_inertia;
        let of_motor = Place { more: self.hidden_sum(FunctionTarget::MotorLevel, at), ..Place::default() };
        d[8] = self.motor_friction.slope(motor_dry, spin, of_motor);
        let more = self.hidden_sum(FunctionTarget::PivotLevel, at);
        let place = Place { angle: hub - platform.angle, load: gear, time: t, more };
        d[9] = self.pivot_friction.slope(pivot_dry, sliding, place);
        d[16] = self.hose(x[16], sliding);
        d[17..].copy_from_slice(&self.slip_slopes(&x[17..], sliding));
        d[10..16].copy_from_slice(&self.sensor_slopes(x, platform));
        d
    }

    /// Derivatives of the states of hub gyroscope, platform gyroscope and accelerometer: a reading and its rate each.
    fn sensor_slopes(&self, x: &[f64; STATES], platform: Platform) -> [f64; 6] {
        let lever = platform.heave + self.lever_arm * platform.acceleration;
        let sensed =
            [(&self.hub_gyro, x[5]), (&self.platform_gyro, platform.rate), (&self.accelerometer, lever)];
        let mut d = [0.0; 6];
        for (k, (gyro, truth)) in sensed.into_iter().enumerate() {
            let (y, speed) = (x[10 + 2 * k], x[11 + 2 * k]);
            d[2 * k] = speed;
            d[2 * k + 1] =
                gyro.natural * gyro.natural * (truth - y) - 2.0 * gyro.damping * gyro.natural * speed;
        }
        d
    }

    /// Takes one classical Runge-Kutta step of length `h`, the platform given at its start, middle and end.
    pub fn step(
        &self,
        t: f64,
        h: f64,
        x: &[f64; STATES],
        control: f64,
        platform: [Platform; 3],
    ) -> [f64; STATES] {
        let along = |x: &[f64; STATES], k: &[f64; STATES], s: f64| std::array::from_fn(|i| x[i] + s * k[i]);
        let k1 = self.slopes(t, x, control, platform[0]);
        let k2 = self.slopes(t + 0.5 * h, &along(x, &k1, 0.5 * h), control, platform[1]);
        let k3 = self.slopes(t + 0.5 * h, &along(x, &k2, 0.5 * h), control, platform[1]);
        let k4 = self.slopes(t + h, &along(x, &k3, h), control, platform[2]);
        std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    }

    /// Returns the states at rest with the motor holding the imbalance, everything level.
    pub fn at_rest(&self) -> [f64; STATES] {
        let weight = self.gravity * self.moment - self.spring * self.spring_centre;
        let wound = weight / self.gear_stiffness + 0.5 * self.backlash * weight.signum();
        let mut x = [0.0; STATES];
        x[1] = weight / self.ratio / self.torque_constant;
        x[0] = self.resistance * x[1];
        x[2] = self.ratio * wound;
        x
    }
}
