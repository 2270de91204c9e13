//! The plant linearised about an operating point.

use super::core::{input, state};
use super::{Core, Equilibrium, Mesh, Plant};
use crate::Error;
use crate::friction::FrictionModel;
use crate::friction::describing::describing_function;
use crate::parameters::Friction;
use counterpoise_lti::{Mat, StateSpace, Timebase};

/// What takes the place of dry friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FrictionLinearisation {
    /// Nothing: the viscous part alone.
    Viscous,
    /// The describing function of the dry law for a sinusoidal hub motion relative to the platform; the motor turns
    /// by the gear's ratio more. Stiffness enters only if [`Angles::Keep`] is chosen.
    DescribingFunction {
        /// Amplitude of the hub's relative motion, rad.
        hub_amplitude_rad: f64,
        /// Its frequency, rad/s.
        frequency_rad_s: f64,
    },
}

/// Whether angles stay among the states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Angles {
    /// No angle, hence no free integrator: gravity's gradient, the position spring and friction's stiffness are left
    /// out; gear wind-up and twist remain.
    Drop,
    /// The hub angle and the hub's angle relative to the platform are states, with everything that depends on them.
    Keep,
}

/// The plant as a linear system about an operating point
///
/// ```text
///     x' = A x + B [control, heave, pitch rate]        control V, heave m/s^2, pitch rate rad/s (deviations)
///     [hub rate, tip rate, motor rate] = C x + D [...]  rad/s; hub and tip inertial, motor relative to the platform
/// ```
///
/// The motor's inertial coupling to the platform needs no pitch acceleration: its state is the sum of motor rate and
/// coupling x pitch rate, and the pitch rate enters directly. Sensors are not included; the static gain of the
/// amplifier map at the operating point is.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearPlant {
    /// The system, continuous.
    pub system: StateSpace,
    /// What each state is, with its unit.
    pub state_names: Vec<String>,
    /// Where it holds.
    pub equilibrium: Equilibrium,
}

impl LinearPlant {
    /// The inputs, in order.
    pub const INPUTS: [&str; 3] = ["control_v", "heave_m_s2", "pitch_rate_rad_s"];
    /// The outputs, in order.
    pub const OUTPUTS: [&str; 3] = ["hub_rate_rad_s", "tip_rate_rad_s", "motor_rate_rad_s"];
    /// Column of the control.
    pub const CONTROL: usize = 0;
    /// Column of heave.
    pub const HEAVE: usize = 1;
    /// Column of the platform's pitch rate.
    pub const PITCH_RATE: usize = 2;
    /// Row of the hub rate.
    pub const HUB_RATE: usize = 0;
    /// Row of the tip rate.
    pub const TIP_RATE: usize = 1;
    /// Row of the motor rate.
    pub const MOTOR_RATE: usize = 2;
}

/// Stiffness and damping that act on a relative motion.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Impedance {
    stiffness: f64,
    damping: f64,
}

impl Plant {
    /// Returns the linearisation about an equilibrium, the teeth touching.
    ///
    /// # Errors
    /// An amplitude or frequency of the describing function that is not positive.
    pub fn linearise(
        &self,
        equilibrium: &Equilibrium,
        friction: FrictionLinearisation,
        angles: Angles,
    ) -> Result<LinearPlant, Error> {
        let (motor, pivot) = self.dry_impedances(friction)?;
        let mut core = self.core(Mesh::Touching);
        let relative = self.append_relative_angle(&mut core);
        self.add_motor_impedance(&mut core, relative, motor);
        self.add_hub_impedance(&mut core, relative, pivot, equilibrium);
        let mut kept: Vec<usize> = (0..=relative).collect();
        if angles == Angles::Drop {
            kept.retain(|&s| s != state::ANGLE && s != relative);
        }
        let system = self.to_state_space(&core, &kept, equilibrium)?;
        let names = self.core_state_names();
        let state_names = kept.iter().map(|&s| names[s].clone()).collect();
        Ok(LinearPlant { system, state_names, equilibrium: equilibrium.clone() })
    }

    /// Slope of the drive over the control at an equilibrium, by the map's secant over one converter-sized step.
    fn drive_slope(&self, equilibrium: &Equilibrium) -> f64 {
        let (amplifier, motor) = (&self.parameters.amplifier, &self.parameters.motor);
        if amplifier.map.is_empty() {
            return 1.0;
        }
        let step = 1e-3;
        let drive = |control: f64| amplifier.drive_v(control, motor);
        (drive(equilibrium.control_v + step) - drive(equilibrium.control_v - step)) / (2.0 * step)
    }

    fn dry_impedances(&self, friction: FrictionLinearisation) -> Result<(Impedance, Impedance), Error> {
        let FrictionLinearisation::DescribingFunction { hub_amplitude_rad, frequency_rad_s } = friction
        else {
            return Ok((Impedance::default(), Impedance::default()));
        };
        for (name, value) in [("hub_amplitude_rad", hub_amplitude_rad), ("frequency_rad_s", frequency_rad_s)]
        {
            if !(value > 0.0 && value.is_finite()) {
                let parameter = format!("describing function: {name}");
                return Err(Error::Parameter {
                    parameter,
                    value,
                    allowed: "must be positive and finite".into(),
                });
            }
        }
        let motor_amplitude = hub_amplitude_rad * self.parameters.gearbox.ratio;
        Ok((
            impedance(&self.parameters.motor_friction, motor_amplitude, frequency_rad_s)?,
            impedance(&self.parameters.pivot_friction, hub_amplitude_rad, frequency_rad_s)?,
        ))
    }

    /// Adds theta_h - theta_p as the last state and returns its index.
    fn append_relative_angle(&self, core: &mut Core) -> usize {
        let n = core.A.nrows();
        let mut A = Mat::zeros(n + 1, n + 1);
        A.set_block(0, 0, &core.A);
        let mut B = Mat::zeros(n + 1, input::COUNT);
        B.set_block(0, 0, &core.B);
        for (j, entry) in self.hub_rate_row().into_iter().enumerate() {
            A[(n, j)] = entry;
        }
        B[(n, input::PLATFORM_RATE)] = -1.0;
        (core.A, core.B) = (A, B);
        n
    }

    /// Adds a torque -(k theta_m + c w_m) at the motor: theta_m = N (delta + theta_h - theta_p).
    fn add_motor_impedance(&self, core: &mut Core, relative: usize, dry: Impedance) {
        let gain = core.B[(state::MOTOR, input::MOTOR_TORQUE)];
        let ratio = self.parameters.gearbox.ratio;
        core.A[(state::MOTOR, state::WINDUP)] -= gain * dry.stiffness * ratio;
        core.A[(state::MOTOR, relative)] -= gain * dry.stiffness * ratio;
        core.A[(state::MOTOR, state::MOTOR)] -= gain * dry.damping;
        core.B[(state::MOTOR, input::PLATFORM_RATE)] +=
            gain * dry.damping * self.parameters.motor.platform_coupling;
    }

    /// Adds the torque of friction, spring and gravity's gradient at the hub.
    fn add_hub_impedance(&self, core: &mut Core, relative: usize, dry: Impedance, at: &Equilibrium) {
        let (sin, cos) = at.point.hub_angle_rad.sin_cos();
        let gravity = self.parameters.gravity_m_s2;
        let lift = gravity * self.body.vertical_offset_kg_m * cos;
        let (rates, angles) = (self.hub_rate_row(), self.hub_angle_row());
        for row in 0..relative {
            let (torque, load) = (core.B[(row, input::HUB_TORQUE)], core.B[(row, input::LOAD)]);
            core.A[(row, relative)] -= torque * (dry.stiffness + self.spring.0);
            core.B[(row, input::PLATFORM_RATE)] += torque * dry.damping;
            for j in 0..relative {
                core.A[(row, j)] -= torque * dry.damping * rates[j];
                core.A[(row, j)] += (torque * lift - load * gravity * sin) * angles[j];
            }
        }
    }

    fn to_state_space(&self, core: &Core, kept: &[usize], at: &Equilibrium) -> Result<StateSpace, Error> {
        let (sin, cos) = at.point.hub_angle_rad.sin_cos();
        let heave_torque = self.body.vertical_offset_kg_m * sin;
        let slope = self.drive_slope(at);
        let B = Mat::from_fn(kept.len(), 3, |i, j| match j {
            LinearPlant::CONTROL => slope * core.B[(kept[i], input::DRIVE)],
            LinearPlant::HEAVE => {
                cos * core.B[(kept[i], input::LOAD)] + heave_torque * core.B[(kept[i], input::HUB_TORQUE)]
            }
            _ => core.B[(kept[i], input::PLATFORM_RATE)],
        });
        let mut motor = vec![0.0; self.core_order()];
        motor[state::MOTOR] = 1.0;
        let rows = [self.hub_rate_row(), self.tip_rate_row(), motor];
        let C = Mat::from_fn(3, kept.len(), |i, j| rows[i].get(kept[j]).copied().unwrap_or(0.0));
        let mut D = Mat::zeros(3, 3);
        D[(LinearPlant::MOTOR_RATE, LinearPlant::PITCH_RATE)] = -self.parameters.motor.platform_coupling;
        Ok(StateSpace::new(core.A.select(kept, kept), B, C, D, Timebase::Continuous)?)
    }

    /// Returns the names of the core's states and of the relative angle behind them.
    fn core_state_names(&self) -> Vec<String> {
        let fixed = [
            "amplifier_voltage_v",
            "current_a",
            "motor_rate_rad_s",
            "wind_up_rad",
            "angle_rad",
            "rate_rad_s",
        ];
        let mut names: Vec<String> = fixed.iter().map(|name| (*name).to_owned()).collect();
        for k in 1..=self.body.modes.len() {
            names.push(format!("mode_{k}_rad"));
            names.push(format!("mode_{k}_rate_rad_s"));
        }
        names.push("relative_hub_angle_rad".to_owned());
        names
    }
}

/// Returns the describing function of the dry part as a stiffness and a damping: F = k x + c x' for x = A sin(w t).
fn impedance(friction: &Friction, amplitude: f64, frequency: f64) -> Result<Impedance, Error> {
    let dry = Friction {
        viscous_nm_s_rad: 0.0,
        viscous_asymmetry: 0.0,
        quadratic_nm_s2_rad2: 0.0,
        ..friction.clone()
    };
    let complex = describing_function(&FrictionModel::new(&dry)?, amplitude, frequency);
    Ok(Impedance { stiffness: complex.re, damping: complex.im / frequency })
}
