//! The basis of a predicted limit cycle: the linear loop in which every nonlinear part is its describing function, on both sides of the
//! amplitude at which growth turns into fading, with the friction pulled out so that other code can put it in again.

use counterpoise_linalg::C64;
use counterpoise_lti::StateSpace;
use counterpoise_models::friction::FrictionModel;
use counterpoise_models::friction::describing_function::sinusoidal_loop;
use counterpoise_models::plant::{Angles, FrictionLinearisation, Impedance};
use counterpoise_models::{Friction, FrictionLaw};

use super::elements::{ElementLoop, Elements, ObserverGain, Sinusoid, quasi_linear, with_mesh};
use super::floor::Subject;
use crate::Error;
use crate::linear_loop::SampledPlant;
use crate::linear_loop::closed_loop::resolver_use;
use crate::linear_loop::plant::port;

/// A loop with the poles that its describing functions give.
pub(super) struct SettledLoop {
    /// The motion for which the describing functions hold.
    pub motion: Sinusoid,
    /// The describing functions.
    pub elements: Elements,
    /// The loop with them.
    pub linear: ElementLoop,
    /// Least stable pole.
    pub pole: C64,
    /// The gear's gap.
    pub mesh: MeshBalance,
}

/// Quantity of the first output of the mechanism.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HubOutput {
    /// The hub's rate.
    Rate,
    /// The hub's angle relative to the platform: the loop controls a position.
    Position,
    /// A torque or a current: the loop controls it.
    Effort,
}

/// The describing function of a joint's dry friction.
#[derive(Debug, Clone, PartialEq)]
pub struct JointBalance {
    /// Amplitude of the joint's relative angle, rad.
    pub amplitude_rad: f64,
    /// Torque of dry friction over one period of x = A sin(w t), N m: sample k = 1, 2, ... at w t = 2 pi k / count.
    pub torque_nm: Vec<f64>,
    /// Equivalent stiffness and damping of its first harmonic.
    pub impedance: Impedance,
    /// Coulomb level, N m, and rest stiffness, N m/rad, of a law of Dahl with the exponent 1; `None` for other laws.
    pub dahl: Option<[f64; 2]>,
}

/// The describing function of the gear's gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshBalance {
    /// Amplitude of the wind-up, rad.
    pub wind_up_rad: f64,
    /// Wind-up by which the teeth are pressed together, rad; negative inside the gap.
    pub pressed_rad: f64,
    /// The gap, rad; 0 if the teeth are taken as touching.
    pub gap_rad: f64,
    /// Share of the gear's stiffness and damping that acts.
    pub share: f64,
}

/// The loop at an amplitude on one side of a predicted limit cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct CycleBalance {
    /// Amplitude of the hub's rate, rad/s.
    pub rate_rad_s: f64,
    /// Frequency for which the describing functions hold, rad/s.
    pub frequency_rad_s: f64,
    /// Amplitude of the motor's motion over that of the hub.
    pub motor_over_hub: f64,
    /// Turns of the motor for one of the hub.
    pub gear_ratio: f64,
    /// Growth of the least stable pole, 1/s.
    pub growth_per_s: f64,
    /// Friction at the motor shaft.
    pub motor: JointBalance,
    /// Friction at the pivot.
    pub pivot: JointBalance,
    /// The gear.
    pub mesh: MeshBalance,
    /// The friction observers, in the controller's order.
    pub observers: Vec<ObserverGain>,
    /// Quantity of the first output of the mechanism.
    pub hub_output: HubOutput,
    /// The mechanism without dry friction: (control, torque on the motor shaft, torque on the hub) to (hub, tip and motor rate, current,
    /// readings).
    pub without_friction: StateSpace,
    /// The mechanism with the describing functions: control to the same outputs.
    pub mechanism: StateSpace,
    /// The same, sampled and late: control to the readings.
    pub sampled: StateSpace,
    /// The controller with its describing functions: readings to control.
    pub controller: StateSpace,
}

impl CycleBalance {
    /// Returns the loop of a settled motion as the result states it.
    pub(super) fn new(subject: &Subject<'_>, at: &SettledLoop) -> Result<Self, Error> {
        let parameters = subject.case.plant.parameters();
        let (motion, ratio) = (&at.motion, parameters.gearbox.ratio);
        let body = with_mesh(&subject.case.plant, at.elements.mesh_share)?;
        let friction =
            FrictionLinearisation::Impedances { motor: Impedance::default(), pivot: Impedance::default() };
        let equilibrium = body.equilibrium(&subject.procedure.operating_point);
        let free = body.linearise(&equilibrium, friction, Angles::Relative)?;
        let resolver = resolver_use(&quasi_linear(subject.controller, &at.elements.observers)?);
        let free = SampledPlant::with_torque_inputs(&free, body.parameters(), resolver)?.continuous;
        let hub_rad = motion.rate_rad_s / motion.frequency_rad_s;
        let all: Vec<usize> = (0..free.outputs()).collect();
        let readings: Vec<usize> = (port::FIRST_READING..at.linear.plant.sampled.outputs()).collect();
        let joint = |friction, amplitude_rad, impedance| {
            joint_balance(friction, amplitude_rad, motion.frequency_rad_s, impedance)
        };
        Ok(Self {
            rate_rad_s: motion.rate_rad_s,
            frequency_rad_s: motion.frequency_rad_s,
            motor_over_hub: motion.motor_over_hub,
            gear_ratio: ratio,
            growth_per_s: at.pole.norm().ln() / at.linear.plant.sample_period_s,
            motor: joint(&parameters.motor_friction, hub_rad * motion.motor_over_hub, at.elements.motor)?,
            pivot: joint(&parameters.pivot_friction, hub_rad, at.elements.pivot)?,
            mesh: at.mesh,
            observers: at.elements.observers.clone(),
            hub_output: match (at.linear.plant.controls_effort, at.linear.plant.controls_position) {
                (true, _) => HubOutput::Effort,
                (false, true) => HubOutput::Position,
                (false, false) => HubOutput::Rate,
            },
            without_friction: free,
            mechanism: at.linear.plant.continuous.select(&all, &[0]),
            sampled: at.linear.plant.sampled.select(&readings, &[port::CONTROL]),
            controller: at.linear.controller.clone(),
        })
    }
}

/// Returns one period of a joint's dry friction.
fn joint_balance(
    friction: &Friction,
    amplitude_rad: f64,
    frequency_rad_s: f64,
    impedance: Impedance,
) -> Result<JointBalance, Error> {
    let dry = Friction {
        viscous_nm_s_rad: 0.0,
        viscous_asymmetry: 0.0,
        quadratic_nm_s2_rad2: 0.0,
        ..friction.clone()
    };
    let torque_nm = sinusoidal_loop(&FrictionModel::new(&dry)?, amplitude_rad, frequency_rad_s).torque_nm;
    let is_plain = dry.static_ratio == 1.0 && dry.asymmetry == 0.0;
    let dahl = match dry.law {
        FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad, exponent } if exponent == 1.0 && is_plain => {
            Some([coulomb_nm, rest_stiffness_nm_rad])
        }
        _ => None,
    };
    Ok(JointBalance { amplitude_rad, torque_nm, impedance, dahl })
}
