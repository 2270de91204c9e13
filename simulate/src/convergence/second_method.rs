//! The second method: the classical Runge-Kutta method in short steps, on the plant's right-hand side without dry friction, with
//! friction beside it as its own differential equation, its bonds, or a joint at rest.
//!
//! A step in which something switches (teeth part or meet, a rate changes its sign, a bond snaps or reaches its limit, a joint
//! breaks away) is halved down to a millionth, so that the method keeps its order between those instants.

use super::{PLATFORM, STEPS};
use crate::Error;
use crate::tolerance::{MOST_SWITCHES, SECOND_LEVELS, SECOND_RATE_ROUNDING};
use counterpoise_models::friction::{FrictionConditions, FrictionModel, Law};
use counterpoise_models::plant::core::{input, state};
use counterpoise_models::plant::{JointMotion, LearnedRegime};
use counterpoise_models::{Excitation, Friction, FrictionLaw, LearnedPlace, Mesh, Plant};

/// Number of things that switch.
const SWITCHES: usize = 6;

/// Returns the hub rates at the end of every one of [`STEPS`] stretches of `stretch_s` seconds, each taken in `substeps` steps.
pub(super) fn hub_rates(
    plant: &Plant,
    control_v: f64,
    start: &[f64],
    stretch_s: f64,
    substeps: usize,
) -> Result<Vec<f64>, Error> {
    let second = SecondMethod::new(plant, control_v)?;
    let mut now = second.begin(start);
    let step_s = stretch_s / substeps as f64;
    let row = plant.hub_rate_row();
    let mut rates = Vec::with_capacity(STEPS);
    for stretch in 0..STEPS {
        for step in 0..substeps {
            let time_s = stretch as f64 * stretch_s + step as f64 * step_s;
            second.step(&mut now, time_s, step_s, 0);
        }
        rates.push(dot(&row, &now.y));
    }
    Ok(rates)
}

/// Dry friction at a joint.
struct Joint {
    model: FrictionModel,
    /// The rate of its body, from the core.
    rate: Vec<f64>,
    /// Acceleration of the core per torque on it.
    push: Vec<f64>,
    /// Share of the platform's rate that the body has at rest.
    share: f64,
    /// Turns of the joint per turn of the hub.
    turns: f64,
}

/// The memory of a joint's friction.
#[derive(Clone)]
enum Memory {
    /// Nothing, or a state that is integrated with the others.
    Smooth,
    /// The direction in which a law that truly sticks slides.
    Slides(f64),
    /// At rest.
    Rests,
    /// Bonds at the beginning of the step, and the angle there, rad.
    Bonds(Vec<f64>, f64),
}

#[derive(Clone)]
struct IntegrationState {
    /// The core, then a state of each friction, then what else the plant remembers.
    y: Vec<f64>,
    memory: [Memory; 2],
    switches: usize,
}

struct SecondMethod<'a> {
    plant: &'a Plant,
    smooth: Plant,
    joints: [Joint; 2],
    control_v: f64,
}

impl<'a> SecondMethod<'a> {
    fn new(plant: &'a Plant, control_v: f64) -> Result<Self, Error> {
        let mut parameters = plant.parameters().clone();
        let without = |f: &Friction| Friction { law: FrictionLaw::None, load_coefficient: 0.0, ..f.clone() };
        parameters.motor_friction = without(&parameters.motor_friction);
        parameters.pivot_friction = without(&parameters.pivot_friction);
        let smooth = Plant::with_whole_body(&parameters, plant.body().clone())?;
        let core = smooth.core(Mesh::Free);
        let joint = |friction: &Friction, rate: Vec<f64>, port: usize, share: f64, turns: f64| {
            let push = core.B.column(port).to_vec();
            Ok::<_, Error>(Joint { model: FrictionModel::new(friction)?, rate, push, share, turns })
        };
        let own = plant.parameters();
        let (coupling, ratio) = (plant.motor_share(), own.gearbox.ratio);
        let joints = [
            joint(&own.motor_friction, plant.motor_rate_row(), input::MOTOR_TORQUE, coupling, ratio)?,
            joint(&own.pivot_friction, plant.hub_rate_row(), input::HUB_TORQUE, 1.0, 1.0)?,
        ];
        Ok(Self { plant, smooth, joints, control_v })
    }

    fn begin(&self, core: &[f64]) -> IntegrationState {
        let mut y = core.to_vec();
        y.resize(self.smooth.order(), 0.0);
        let memory = [0, 1].map(|k| match self.joints[k].model.law() {
            Law::Sliding(_) => Memory::Rests,
            Law::Bristle(law) => Memory::Bonds(vec![0.0; 2 * law.bristles], self.angle(k, &y, 0.0)),
            _ => Memory::Smooth,
        });
        IntegrationState { y, memory, switches: 0 }
    }

    /// Returns the relative angle of a joint, rad.
    fn angle(&self, joint: usize, y: &[f64], time_s: f64) -> f64 {
        let relative = dot(&self.plant.hub_angle_row(), y) - PLATFORM.0 * time_s;
        if joint == 0 { self.joints[0].turns * (y[state::WINDUP] + relative) } else { relative }
    }

    /// Returns the relative rate of a joint, rad/s.
    fn rate(&self, joint: usize, y: &[f64]) -> f64 {
        dot(&self.joints[joint].rate, y) - self.joints[joint].share * PLATFORM.0
    }

    fn level(&self, joint: usize, y: &[f64], time_s: f64) -> f64 {
        let model = &self.joints[joint].model;
        if !model.is_modulated() && self.plant.learned_functions().is_none() {
            return 1.0;
        }
        let hub_rate = dot(&self.plant.hub_rate_row(), y);
        let mesh = self.plant.mesh_torque_nm(y[state::WINDUP], hub_rate, self.rate(0, y), PLATFORM.0);
        let load_nm = mesh.abs() / self.joints[joint].turns;
        let motion = |k| JointMotion { angle_rad: self.angle(k, y, time_s), rate_rad_s: self.rate(k, y) };
        let regime = LearnedRegime {
            time_s,
            drive_v: 0.0,
            current_a: 0.0,
            motor: motion(0),
            hub: motion(1),
            wind_up_rad: y[state::WINDUP],
            mesh_torque_nm: mesh,
        };
        let place = [LearnedPlace::Motor, LearnedPlace::Pivot][joint];
        let own =
            model.level(&FrictionConditions { angle_rad: self.angle(joint, y, time_s), load_nm, time_s });
        own * self.plant.learned_level(place, &regime)
    }

    /// Returns the derivative of [core, friction at the motor, friction at the pivot].
    fn slope(&self, y: &[f64], time_s: f64, memory: &[Memory; 2]) -> Vec<f64> {
        let mut slope = self.free_slope(y, time_s);
        for joint in [0, 1] {
            let torque = match &memory[joint] {
                Memory::Rests => self.holding_torque(joint, &slope),
                moving => self.torque(joint, y, time_s, moving),
            };
            let push = &self.joints[joint].push;
            slope.iter_mut().zip(push).for_each(|(s, p)| *s -= p * torque);
            if matches!(memory[joint], Memory::Smooth) && self.joints[joint].model.states() == 1 {
                let (rate, level) = (self.rate(joint, y), self.level(joint, y, time_s));
                let at = self.core_order() + joint;
                let mut own = [0.0];
                self.joints[joint].model.derivative(rate, level, &y[at..=at], &mut own);
                slope[at] = own[0];
            }
        }
        slope
    }

    fn core_order(&self) -> usize {
        self.plant.core_order()
    }

    /// Returns the derivative without dry friction.
    fn free_slope(&self, y: &[f64], time_s: f64) -> Vec<f64> {
        let (rate, heave, frequency) = PLATFORM;
        let at = Excitation {
            time_s,
            control_v: self.control_v,
            heave_m_s2: heave * (frequency * time_s).sin(),
            platform_angle_rad: rate * time_s,
            platform_rate_rad_s: rate,
            ..Excitation::default()
        };
        let mut slope = vec![0.0; y.len()];
        self.smooth.derivative(y, &at, &mut slope);
        slope
    }

    /// Returns the torque that keeps a joint at rest: the platform's rate is constant.
    fn holding_torque(&self, joint: usize, slope: &[f64]) -> f64 {
        let joint = &self.joints[joint];
        dot(&joint.rate, slope) / dot(&joint.rate, &joint.push)
    }

    fn torque(&self, joint: usize, y: &[f64], time_s: f64, memory: &Memory) -> f64 {
        let model = &self.joints[joint].model;
        let (rate, level) = (self.rate(joint, y), self.level(joint, y, time_s));
        match memory {
            Memory::Smooth | Memory::Rests => {
                let at = self.core_order() + joint;
                model.dry_torque(rate, level, &y[at..=at])
            }
            Memory::Slides(direction) if self.in_band(joint, rate) => {
                model.stick(level).map_or(0.0, |stick| stick.holding_torque_nm(direction * f64::INFINITY))
            }
            Memory::Slides(direction) => {
                model.dry_torque(direction * rate.abs().max(f64::MIN_POSITIVE), level, &[])
            }
            Memory::Bonds(bonds, from) => {
                let travel = self.angle(joint, y, time_s) - from;
                let bent: Vec<f64> = bonds.iter().map(|z| z + travel).collect();
                model.dry_torque(rate, level, &bent)
            }
        }
    }

    /// Returns whether a sliding joint is in the band of rates in which Karnopp's law has its breakaway level.
    fn in_band(&self, joint: usize, rate: f64) -> bool {
        match self.joints[joint].model.law() {
            Law::Sliding(law) => law.breakaway_ratio > 1.0 && rate.abs() < law.rest_rate_rad_s,
            _ => false,
        }
    }

    /// Returns what switches: while it stays the same the equations are smooth.
    fn switches(&self, now: &IntegrationState, y: &[f64], time_s: f64) -> [i32; SWITCHES] {
        let mut out = [0; SWITCHES];
        if self.plant.mesh(y[state::WINDUP]).0 == Mesh::Touching {
            out[0] = sign(y[state::WINDUP]);
        }
        let bus = self.plant.parameters().amplifier.bus_voltage_v;
        out[1] = i32::from(y[state::VOLTAGE].abs() >= bus);
        for joint in [0, 1] {
            let [a, b] = self.joint_switches(joint, now, y, time_s);
            (out[2 + 2 * joint], out[3 + 2 * joint]) = (a, b);
        }
        out
    }

    fn joint_switches(&self, joint: usize, now: &IntegrationState, y: &[f64], time_s: f64) -> [i32; 2] {
        let (model, rate) = (&self.joints[joint].model, self.rate(joint, y));
        match &now.memory[joint] {
            Memory::Smooth if model.states() == 1 => {
                let at = self.core_order() + joint;
                let mut own = [0.0];
                model.derivative(rate, 1.0, &y[at..=at], &mut own);
                [sign(rate), i32::from(own[0] == 0.0)]
            }
            Memory::Smooth => [sign(rate), 0],
            Memory::Slides(direction) => {
                [i32::from(rate * direction < -SECOND_RATE_ROUNDING), i32::from(self.in_band(joint, rate))]
            }
            Memory::Rests => [self.breakaway_sign(joint, now, y, time_s), 0],
            Memory::Bonds(bonds, from) => {
                let travel = self.angle(joint, y, time_s) - from;
                let limit = match model.law() {
                    Law::Bristle(law) => law.bond_rad,
                    _ => f64::INFINITY,
                };
                let deflections = &bonds[..bonds.len() / 2];
                [i32::from(deflections.iter().any(|z| (z + travel).abs() >= limit)), 0]
            }
        }
    }

    /// Returns the sign of the torque that a joint at rest cannot hold; 0 if it holds.
    fn breakaway_sign(&self, joint: usize, now: &IntegrationState, y: &[f64], time_s: f64) -> i32 {
        let mut slope = self.free_slope(y, time_s);
        if joint == 1 {
            let torque = match &now.memory[0] {
                Memory::Rests => self.holding_torque(0, &slope),
                moving => self.torque(0, y, time_s, moving),
            };
            slope.iter_mut().zip(&self.joints[0].push).for_each(|(s, p)| *s -= p * torque);
        }
        let torque = self.holding_torque(joint, &slope);
        let holds =
            self.joints[joint].model.stick(self.level(joint, y, time_s)).is_none_or(|s| s.holds(torque));
        if holds { 0 } else { sign(torque) }
    }

    /// Takes a step, halved if something switches in it.
    fn step(&self, now: &mut IntegrationState, time_s: f64, step_s: f64, depth: u32) {
        let next = self.classical_step(now, time_s, step_s);
        let end = time_s + step_s;
        let switched = self.switches(now, &now.y, time_s) != self.switches(now, &next, end);
        if switched && depth < SECOND_LEVELS && now.switches < MOST_SWITCHES {
            self.step(now, time_s, 0.5 * step_s, depth + 1);
            self.step(now, time_s + 0.5 * step_s, 0.5 * step_s, depth + 1);
            return;
        }
        now.y = next;
        now.switches += usize::from(switched);
        [0, 1].into_iter().for_each(|joint| self.settle(now, joint, end));
    }

    /// The memory of a joint's friction after a step.
    fn settle(&self, now: &mut IntegrationState, joint: usize, time_s: f64) {
        let rate = self.rate(joint, &now.y);
        let angle = self.angle(joint, &now.y, time_s);
        let order = self.core_order();
        let model = &self.joints[joint].model;
        match &mut now.memory[joint] {
            Memory::Smooth if model.states() == 1 => model.project(&mut now.y[order + joint..=order + joint]),
            Memory::Smooth => {}
            Memory::Bonds(bonds, from) => {
                if let Law::Bristle(law) = model.law() {
                    law.displace(angle - *from, bonds);
                }
                *from = angle;
            }
            Memory::Slides(direction) => {
                if rate * *direction < -SECOND_RATE_ROUNDING {
                    self.arrest(now, joint, rate);
                    self.leave(now, joint, time_s);
                }
            }
            Memory::Rests => self.leave(now, joint, time_s),
        }
    }

    /// Takes the rate of a joint by an impulse and lets it rest.
    fn arrest(&self, now: &mut IntegrationState, joint: usize, rate: f64) {
        let at = &self.joints[joint];
        let impulse = rate / dot(&at.rate, &at.push);
        now.y.iter_mut().zip(&at.push).for_each(|(y, p)| *y -= p * impulse);
        now.memory[joint] = Memory::Rests;
    }

    /// Lets a joint at rest slide if it cannot hold.
    fn leave(&self, now: &mut IntegrationState, joint: usize, time_s: f64) {
        match self.breakaway_sign(joint, now, &now.y, time_s) {
            0 => {}
            direction => now.memory[joint] = Memory::Slides(f64::from(direction)),
        }
    }

    /// Returns the state after one step of the classical Runge-Kutta method.
    fn classical_step(&self, now: &IntegrationState, time_s: f64, h: f64) -> Vec<f64> {
        let moved = |slope: &[f64], part: f64| -> Vec<f64> {
            now.y.iter().zip(slope).map(|(y, s)| y + part * h * s).collect()
        };
        let slope = |y: &[f64], part: f64| self.slope(y, time_s + part * h, &now.memory);
        let first = slope(&now.y, 0.0);
        let second = slope(&moved(&first, 0.5), 0.5);
        let third = slope(&moved(&second, 0.5), 0.5);
        let fourth = slope(&moved(&third, 1.0), 1.0);
        let sum = |i: usize| first[i] + 2.0 * (second[i] + third[i]) + fourth[i];
        (0..now.y.len()).map(|i| now.y[i] + h / 6.0 * sum(i)).collect()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn sign(value: f64) -> i32 {
    if value > 0.0 { 1 } else { -i32::from(value < 0.0) }
}
