//! The slopes of dry friction along a step: of its state over the motion of the joint, of its torque over rate and state.

use super::direction::Family;
use super::dual::Dual;
use super::refusal::SensitivityRefusal;
use super::stencil::MEMBERS;
use crate::engine::ports::dry_torque;
use counterpoise_models::friction::{DryFriction, FrictionModel, Law};

/// Slopes over the joint's own motion: rate before, rate after, travel and state before.
const MOTION: usize = 4;
/// Directions whose slopes are found together.
const TOGETHER: usize = 4;
const ALL: usize = MOTION + TOGETHER;
const BEFORE: usize = 0;
const AFTER: usize = 1;
const TRAVEL: usize = 2;
const STATE: usize = 3;
/// The nominal law and the members of the families that are joined to it.
const JOINED: usize = 1 + TOGETHER * MEMBERS;

/// The motion of a joint from one node to the next.
#[derive(Debug, Clone, Copy)]
pub(crate) struct JointPath {
    pub rates: [f64; 2],
    pub travel: f64,
    pub time_s: f64,
    /// State of the friction before and after.
    pub states: [f64; 2],
}

/// The slopes of a joint's friction over one part of a step.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct JointSlopes {
    /// Of the state after, over rate before, rate after, travel and state before.
    pub state: [f64; MOTION],
    /// Of the torque after, over rate and state after.
    pub torque: [f64; 2],
}

/// The laws of a joint in numbers that know their derivatives.
#[derive(Debug, Clone)]
pub(crate) struct JointFriction {
    model: FrictionModel,
    kind: Kind,
    /// The directions in which the joint's friction differs.
    pub directions: Vec<usize>,
    /// What those directions change.
    pub own: Vec<OwnSlopes>,
}

/// What a direction changes of a joint's friction at the same motion.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct OwnSlopes {
    /// Of the state over the last path.
    state: f64,
    /// Of the torque after it.
    pub torque: f64,
    /// Of the state since the start of the step.
    pub carried: f64,
}

#[derive(Debug, Clone)]
enum Kind {
    None,
    /// True stick: the members of each direction.
    Sliding(Vec<SlidingFamily>),
    /// The law with its own slopes alone, and with those of a few directions each.
    Smooth {
        plain: Box<DryFriction<Dual<MOTION>>>,
        varied: Vec<DryFriction<Dual<ALL>>>,
    },
}

/// The friction of a joint in the members of a direction.
#[derive(Debug, Clone)]
struct SlidingFamily {
    stencil: super::stencil::Stencil,
    models: [FrictionModel; MEMBERS],
}

impl JointFriction {
    /// Returns the friction of the motor's (0) or the pivot's (1) joint.
    pub fn new(model: &FrictionModel, joint: usize, families: &[Family]) -> Result<Self, SensitivityRefusal> {
        let differs = |k: &usize| families[*k].has_other_friction[joint];
        let directions: Vec<usize> = (0..families.len()).filter(differs).collect();
        let members = |k: &usize| families[*k].ports.each_ref().map(|ports| *ports.frictions()[joint]);
        let kind = match model.law() {
            Law::None => Kind::None,
            Law::Sliding(_) => Kind::Sliding(
                directions
                    .iter()
                    .map(|k| SlidingFamily { stencil: families[*k].stencil, models: members(k) })
                    .collect(),
            ),
            Law::Bristle(_) => return Err(SensitivityRefusal::Jump { law: "bristle friction" }),
            Law::ResetIntegrator(law)
                if law.static_ratio != 1.0 || law.damping_nm_s_rad != 0.0 || model.asymmetry() != 0.0 =>
            {
                return Err(SensitivityRefusal::Jump { law: "the reset integrator" });
            }
            _ => smooth(model, &directions, families, joint)?,
        };
        let own = vec![OwnSlopes::default(); directions.len()];
        Ok(Self { model: *model, kind, directions, own })
    }

    /// Begins a step: what the directions change of the state at its start is in that state.
    pub fn begin_step(&mut self) {
        self.own.iter_mut().for_each(|own| own.carried = 0.0);
    }

    /// Returns the slopes over a path, and keeps the derivatives in the directions in which the law differs.
    pub fn slopes(&mut self, path: &JointPath) -> JointSlopes {
        let slopes = self.slopes_of_path(path);
        for own in &mut self.own {
            own.carried = slopes.state[STATE] * own.carried + own.state;
        }
        slopes
    }

    fn slopes_of_path(&mut self, path: &JointPath) -> JointSlopes {
        match &self.kind {
            Kind::None => JointSlopes::default(),
            Kind::Sliding(families) => {
                for (own, family) in self.own.iter_mut().zip(families) {
                    (own.state, own.torque) = (0.0, family.torque_slope(&self.model, path));
                }
                JointSlopes { state: [0.0, 0.0, 0.0, 1.0], torque: [sliding_slope(&self.model, path), 0.0] }
            }
            Kind::Smooth { plain, varied } if varied.is_empty() => path_slopes(plain, path).0,
            Kind::Smooth { varied, .. } => {
                let mut slopes = JointSlopes::default();
                for (law, own) in varied.iter().zip(self.own.chunks_mut(TOGETHER)) {
                    let (found, directions) = path_slopes(law, path);
                    slopes = found;
                    for (own, found) in own.iter_mut().zip(directions) {
                        [own.state, own.torque] = found;
                    }
                }
                slopes
            }
        }
    }

    /// Returns the slopes of the torque over rate and state at the start of a step, and keeps the torque's derivatives.
    pub fn slopes_at_start(&mut self, rate: f64, state: f64) -> [f64; 2] {
        self.begin_step();
        let still = JointPath { rates: [rate; 2], travel: 0.0, time_s: 1.0, states: [state; 2] };
        match &self.kind {
            Kind::Smooth { plain, varied } if varied.is_empty() => torque_slopes(plain, &still).0,
            Kind::Smooth { varied, .. } => {
                let mut slopes = [0.0; 2];
                for (law, own) in varied.iter().zip(self.own.chunks_mut(TOGETHER)) {
                    let (found, directions) = torque_slopes(law, &still);
                    slopes = found;
                    for (k, own) in own.iter_mut().enumerate() {
                        own.torque = directions[k];
                    }
                }
                slopes
            }
            _ => self.slopes_of_path(&still).torque,
        }
    }
}

impl SlidingFamily {
    fn torque_slope(&self, nominal: &FrictionModel, path: &JointPath) -> f64 {
        let torque = |model: &FrictionModel| dry_torque(model, path.rates[1], 1.0, path.states[1]);
        self.stencil.derivative(torque(nominal), self.models.each_ref().map(torque))
    }
}

/// Returns the slope of a sliding torque over the rate.
fn sliding_slope(model: &FrictionModel, path: &JointPath) -> f64 {
    let (rate, state) = (path.rates[1], path.states[1]);
    if state.abs() != 1.0 {
        return 0.0;
    }
    let directed = rate.abs().max(f64::MIN_POSITIVE) * state;
    let level = 1.0 + model.asymmetry() * directed.signum();
    model.law().steady_slope(directed, level)
}

fn smooth(
    model: &FrictionModel,
    directions: &[usize],
    families: &[Family],
    joint: usize,
) -> Result<Kind, SensitivityRefusal> {
    let refusal =
        |direction: usize| SensitivityRefusal::Structure { direction, what: "the shape of a friction law" };
    let part = SensitivityRefusal::Part { part: "friction whose level depends on angle, load or time" };
    let plain = DryFriction::join([model]).ok_or(part)?.map_numbers(|[own]: [f64; 1]| Dual::number(own));
    let mut varied = Vec::new();
    for few in directions.chunks(TOGETHER) {
        let mut joined = [model; JOINED];
        for (place, &k) in few.iter().enumerate() {
            for member in 0..MEMBERS {
                joined[1 + place * MEMBERS + member] = families[k].ports[member].frictions()[joint];
            }
        }
        let law = DryFriction::join(joined).ok_or_else(|| refusal(few[0]))?;
        varied.push(law.map_numbers(|numbers: [f64; JOINED]| {
            let mut dual = Dual::number(numbers[0]);
            for (place, &k) in few.iter().enumerate() {
                let of = std::array::from_fn(|member| numbers[1 + place * MEMBERS + member]);
                dual.slope[MOTION + place] = families[k].stencil.derivative(numbers[0], of);
            }
            dual
        }));
    }
    Ok(Kind::Smooth { plain: Box::new(plain), varied })
}

/// Returns the slopes over a path, and those of state and torque in the directions of the law's own numbers.
fn path_slopes<const N: usize>(
    law: &DryFriction<Dual<N>>,
    path: &JointPath,
) -> (JointSlopes, [[f64; 2]; TOGETHER]) {
    let [before, after] = path.rates;
    let state = Dual::<N>::variable(path.states[0], STATE);
    let travel = Dual::variable(path.travel, TRAVEL);
    let time = Dual::number(path.time_s);
    let moved = if before * after >= 0.0 {
        law.advance(travel / time, time, state)
    } else {
        let rates = [Dual::variable(before, BEFORE), Dual::variable(after, AFTER)];
        let mut state = state;
        for (travel, time) in parts(rates, travel, time) {
            if time.value > 0.0 {
                state = law.advance(travel / time, time, state);
            }
        }
        state
    };
    let (torque, own) = torque_slopes(law, path);
    let slopes = JointSlopes { state: std::array::from_fn(|k| moved.slope[k]), torque };
    let directions = std::array::from_fn(|k| [moved.slope.get(MOTION + k).copied().unwrap_or(0.0), own[k]]);
    (slopes, directions)
}

/// Returns the slopes of the torque over rate and state, and in the directions of the law's own numbers.
fn torque_slopes<const N: usize>(
    law: &DryFriction<Dual<N>>,
    path: &JointPath,
) -> ([f64; 2], [f64; TOGETHER]) {
    let torque = law.torque(Dual::variable(path.rates[1], AFTER), Dual::<N>::variable(path.states[1], STATE));
    let own = std::array::from_fn(|k| torque.slope.get(MOTION + k).copied().unwrap_or(0.0));
    ([torque.slope[AFTER], torque.slope[STATE]], own)
}

/// Returns travel and time before and after a reversal, as the engine splits them.
fn parts<const N: usize>(
    [before, after]: [Dual<N>; 2],
    travel: Dual<N>,
    time: Dual<N>,
) -> [(Dual<N>, Dual<N>); 2] {
    let number = Dual::<N>::number;
    let part = before / (before - after);
    let straight = number(0.5) * (before + after) * time;
    let bend = (travel - straight) * part * part * (number(3.0) - number(2.0) * part);
    let first = number(0.5) * before * part * time + bend;
    [(first, part * time), (travel - first, (number(1.0) - part) * time)]
}
