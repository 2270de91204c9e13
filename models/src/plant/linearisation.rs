//! The plant linearised about an operating point.

use super::core::{input, state};
use super::impedance::Impedance;
use super::{Core, Equilibrium, Mesh, Plant};
use crate::Error;
use crate::friction::FrictionModel;
use crate::friction::describing_function::describing_function;
use crate::parameters::{AxisKind, Friction};
use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};

/// Linear replacement of dry friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FrictionLinearisation {
    /// Nothing: the viscous part alone.
    Viscous,
    /// The describing function of the dry law for a sinusoidal hub motion relative to the platform; the motor turns
    /// by the gear's ratio more. Stiffness enters only if [`Angles::Keep`] is chosen.
    DescribingFunction {
        /// Amplitude of the hub's relative motion, rad.
        hub_amplitude_rad: f64,
        /// Frequency, rad/s.
        frequency_rad_s: f64,
    },
    /// A stiffness and a damping at each joint: of presliding at rest, of steady sliding, or of one harmonic at the joint's own
    /// amplitude. Stiffness enters only if angles are kept.
    Impedances {
        /// At the motor shaft.
        motor: Impedance,
        /// At the pivot.
        pivot: Impedance,
    },
}

/// Treatment of the angles among the states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Angles {
    /// No angle, hence no free integrator: gravity's gradient, the position spring and friction's stiffness are left
    /// out; gear wind-up and twist remain.
    Drop,
    /// The hub angle and the hub's angle relative to the platform are states, with everything that depends on them.
    Keep,
    /// The hub's angle relative to the platform alone is a state: gravity's gradient acts on it, as on a platform whose own
    /// angle stays. Without the second angle the system has no pole that neither the control nor a reading reaches.
    Relative,
    /// The hub's angle relative to the platform is a state, and gravity's gradient, the spring and friction's stiffness act on
    /// it, as with [`Angles::Relative`]. Hub and tip are then outputs as positions: for a loop of position.
    Position,
}

/// The plant as a linear system about an operating point
///
/// ```text
///     x' = A x + B [control, heave, pitch rate]        control V, heave m/s^2, pitch rate rad/s (deviations)
///     [hub rate, tip rate, motor rate] = C x + D [...]  rad/s; hub and tip inertial, motor relative to the platform
/// ```
///
/// With [`Angles::Position`] hub and tip are angles relative to the platform, rad. If the loop's sensor measures neither the hub's
/// inertial rate nor its angle, a fourth output is what it measures (see [`crate::FeedbackSignal`]).
///
/// The motor's inertial coupling to the platform needs no pitch acceleration: its state is the sum of motor rate and
/// coupling x pitch rate, and the pitch rate enters directly. Sensors are not included; the static gain of the
/// amplifier map at the operating point is.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearPlant {
    /// The system, continuous.
    pub system: StateSpace,
    /// Names of the states, with their units.
    pub state_names: Vec<String>,
    /// Equilibrium at which it holds.
    pub equilibrium: Equilibrium,
    /// The armature current, A.
    pub current: OutputRow,
    /// Output that the loop's sensor measures.
    pub measured: usize,
    /// Names of the outputs, with their units.
    pub output_names: Vec<String>,
    /// Effect of further torques on the states' rates, n x 2: on the motor shaft, on the hub.
    pub torque_columns: Mat,
}

/// An output of a linear plant: y = c x + d u.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputRow {
    /// Over the states.
    pub states: Vec<f64>,
    /// Over the inputs.
    pub inputs: [f64; 3],
}

impl LinearPlant {
    /// The inputs, in order.
    pub const INPUTS: [&str; 3] = ["control_v", "heave_m_s2", "pitch_rate_rad_s"];
    /// The outputs of a loop of rate, in order; what those of any machine are called is in [`LinearPlant::output_names`].
    pub const OUTPUTS: [&str; 3] = ["hub_rate_rad_s", "tip_rate_rad_s", "motor_rate_rad_s"];
    /// Column of the control.
    pub const CONTROL: usize = 0;
    /// Column of heave.
    pub const HEAVE: usize = 1;
    /// Column of the platform's pitch rate.
    pub const PITCH_RATE: usize = 2;
    /// Row of the hub rate, or of its angle with [`Angles::Position`].
    pub const HUB_RATE: usize = 0;
    /// Row of the tip rate, or of its angle with [`Angles::Position`].
    pub const TIP_RATE: usize = 1;
    /// Row of the motor rate.
    pub const MOTOR_RATE: usize = 2;

    /// Returns the plant on a platform that stands still, driven by torques: its inputs are \[control (V), torque on the motor shaft (N m), torque
    /// on the hub (N m)\], the torques in the columns of heave and pitch rate.
    ///
    /// # Errors
    /// [`Error::Lti`] if the matrices do not fit, which those of a linearisation do.
    pub fn with_torque_inputs(&self) -> Result<Self, Error> {
        let g = &self.system;
        let kept = |of: f64, column: usize| if column == Self::CONTROL { of } else { 0.0 };
        let B = Mat::from_fn(g.order(), 3, |i, j| match j {
            Self::CONTROL => g.B[(i, j)],
            _ => self.torque_columns[(i, j - 1)],
        });
        let D = Mat::from_fn(g.outputs(), 3, |i, j| kept(g.D[(i, j)], j));
        let system = StateSpace::new(g.A.clone(), B, g.C.clone(), D, Timebase::Continuous)?;
        let inputs = std::array::from_fn(|j| kept(self.current.inputs[j], j));
        let current = OutputRow { inputs, ..self.current.clone() };
        Ok(Self { system, current, ..self.clone() })
    }
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
        let local = self.cylinder_local(equilibrium).or_else(|| self.linearise_learned(equilibrium));
        let Some((local, added)) = local else {
            return self.linearise_with(equilibrium, friction, angles, [Impedance::default(); 2]);
        };
        local.linearise_with(equilibrium, friction, angles, added)
    }

    /// Returns the linearisation with a stiffness and a damping beside those of friction, at the motor and at the pivot.
    fn linearise_with(
        &self,
        equilibrium: &Equilibrium,
        friction: FrictionLinearisation,
        angles: Angles,
        added: [Impedance; 2],
    ) -> Result<LinearPlant, Error> {
        let (motor, pivot) = self.dry_impedances(friction)?;
        let (motor, pivot) = (motor.plus(added[0]), pivot.plus(added[1]));
        let mut core = self.core(Mesh::Touching);
        let relative = self.append_relative_angle(&mut core);
        self.add_motor_impedance(&mut core, relative, motor);
        let of_gradient = match angles {
            Angles::Drop | Angles::Keep | Angles::Relative => self.hub_angle_row(),
            Angles::Position => unit(relative + 1, relative),
        };
        self.add_hub_impedance(&mut core, &of_gradient, pivot, equilibrium);
        let mut kept: Vec<usize> = (0..=relative).filter(|&s| self.has_state(s)).collect();
        match angles {
            Angles::Drop => kept.retain(|&s| s != state::ANGLE && s != relative),
            Angles::Relative => {
                move_gradient(&mut core, relative, &self.hub_angle_row());
                kept.retain(|&s| s != state::ANGLE);
            }
            Angles::Position => kept.retain(|&s| s != state::ANGLE),
            Angles::Keep => {}
        }
        let rows = self.output_rows(angles);
        let system = self.to_state_space(&core, &kept, &rows, equilibrium)?;
        let names = self.core_state_names();
        let state_names = kept.iter().map(|&s| names[s].clone()).collect();
        let current = self.linear_current(&kept, self.drive_slope(equilibrium));
        let measured = if rows.len() > LinearPlant::OUTPUTS.len() { rows.len() - 1 } else { 0 };
        let torques = [input::MOTOR_TORQUE, input::HUB_TORQUE];
        let torque_columns = Mat::from_fn(kept.len(), 2, |i, j| core.B[(kept[i], torques[j])]);
        Ok(LinearPlant {
            system,
            state_names,
            equilibrium: equilibrium.clone(),
            current,
            measured,
            output_names: self.output_names(angles),
            torque_columns,
        })
    }

    /// Returns the slope of the drive over the control at an equilibrium, by the map's secant over one converter-sized step.
    pub fn drive_slope(&self, equilibrium: &Equilibrium) -> f64 {
        let (amplifier, motor) = (&self.parameters.amplifier, &self.parameters.motor);
        if amplifier.map.is_empty() {
            return 1.0;
        }
        let step = 1e-3;
        let drive = |control: f64| amplifier.drive_v(control, motor);
        (drive(equilibrium.control_v + step) - drive(equilibrium.control_v - step)) / (2.0 * step)
    }

    fn dry_impedances(&self, friction: FrictionLinearisation) -> Result<(Impedance, Impedance), Error> {
        let (hub_amplitude_rad, frequency_rad_s) = match friction {
            FrictionLinearisation::Viscous => return Ok((Impedance::default(), Impedance::default())),
            FrictionLinearisation::Impedances { motor, pivot } => return Ok((motor, pivot)),
            FrictionLinearisation::DescribingFunction { hub_amplitude_rad, frequency_rad_s } => {
                (hub_amplitude_rad, frequency_rad_s)
            }
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
            friction_impedance(&self.parameters.motor_friction, motor_amplitude, frequency_rad_s)?,
            friction_impedance(&self.parameters.pivot_friction, hub_amplitude_rad, frequency_rad_s)?,
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
        if self.is_rigid() {
            return self.add_rotor_impedance(core, relative, dry);
        }
        let gain = core.B[(state::MOTOR, input::MOTOR_TORQUE)];
        let ratio = self.parameters.gearbox.ratio;
        core.A[(state::MOTOR, state::WINDUP)] -= gain * dry.stiffness * ratio;
        core.A[(state::MOTOR, relative)] -= gain * dry.stiffness * ratio;
        core.A[(state::MOTOR, state::MOTOR)] -= gain * dry.damping;
        core.B[(state::MOTOR, input::PLATFORM_RATE)] +=
            gain * dry.damping * self.parameters.motor.platform_coupling;
    }

    /// The same where the rotor turns with the hub.
    fn add_rotor_impedance(&self, core: &mut Core, relative: usize, dry: Impedance) {
        let (ratio, rates) = (self.parameters.gearbox.ratio, self.motor_rate_row());
        for row in 0..relative {
            let gain = core.B[(row, input::MOTOR_TORQUE)];
            core.A[(row, relative)] -= gain * dry.stiffness * ratio;
            for (j, rate) in rates.iter().enumerate() {
                core.A[(row, j)] -= gain * dry.damping * rate;
            }
            core.B[(row, input::PLATFORM_RATE)] += gain * dry.damping * self.motor_share();
        }
    }

    /// Adds the torque of friction, spring and gravity's gradient at the hub, whose angle is a row over the states.
    fn add_hub_impedance(&self, core: &mut Core, angles: &[f64], dry: Impedance, at: &Equilibrium) {
        let (sin, cos) = self.tilt(at.point.hub_angle_rad);
        let gravity = self.parameters.gravity_m_s2;
        let lift = match self.parameters.axis {
            AxisKind::Rotary => gravity * self.body.vertical_offset_kg_m * cos,
            AxisKind::Linear => 0.0,
        };
        let rates = self.hub_rate_row();
        let relative = rates.len();
        let spring = self.support_stiffness_nm_rad(at.point.hub_angle_rad - at.point.platform_angle_rad);
        for row in 0..relative {
            let (torque, load) = (core.B[(row, input::HUB_TORQUE)], core.B[(row, input::LOAD)]);
            core.A[(row, relative)] -= torque * (dry.stiffness + spring);
            core.B[(row, input::PLATFORM_RATE)] += torque * dry.damping;
            for (j, rate) in rates.iter().enumerate() {
                core.A[(row, j)] -= torque * dry.damping * rate;
            }
            for (j, angle) in angles.iter().enumerate() {
                core.A[(row, j)] += (torque * lift - load * gravity * sin) * angle;
            }
        }
    }

    fn to_state_space(
        &self,
        core: &Core,
        kept: &[usize],
        rows: &[OutputRow],
        at: &Equilibrium,
    ) -> Result<StateSpace, Error> {
        let (sin, cos) = self.tilt(at.point.hub_angle_rad);
        let heave_torque = self.body.vertical_offset_kg_m * sin;
        let is_carried = core.carried.iter().any(|c| *c != 0.0);
        let slope = self.drive_slope(at);
        let B = Mat::from_fn(kept.len(), 3, |i, j| match j {
            LinearPlant::CONTROL => slope * core.B[(kept[i], input::DRIVE)],
            LinearPlant::HEAVE => {
                cos * core.B[(kept[i], input::LOAD)] + heave_torque * core.B[(kept[i], input::HUB_TORQUE)]
            }
            _ if is_carried => core.B[(kept[i], input::PLATFORM_RATE)] + carried_through(core, kept[i]),
            _ => core.B[(kept[i], input::PLATFORM_RATE)],
        });
        let C =
            Mat::from_fn(rows.len(), kept.len(), |i, j| rows[i].states.get(kept[j]).copied().unwrap_or(0.0));
        let D = Mat::from_fn(rows.len(), 3, |i, j| match j {
            LinearPlant::PITCH_RATE if is_carried => {
                rows[i].inputs[j] + carried_part(&rows[i].states, &core.carried)
            }
            _ => rows[i].inputs[j],
        });
        Ok(StateSpace::new(core.A.select(kept, kept), B, C, D, Timebase::Continuous)?)
    }

    /// Returns the names of the core's states and of the relative angle behind them.
    fn core_state_names(&self) -> Vec<String> {
        let (angle, rate) = match self.parameters.axis {
            AxisKind::Rotary => ("angle_rad", "rate_rad_s"),
            AxisKind::Linear => ("position_m", "speed_m_s"),
        };
        let travel = angle.rsplit_once('_').map_or("rad", |(_, unit)| unit);
        let mut names: Vec<String> =
            ["amplifier_voltage_v", "current_a", "motor_rate_rad_s"].map(str::to_owned).to_vec();
        if self.parameters.cylinder.is_some() {
            names =
                ["valve_flow_l_s", "load_pressure_mpa", "valve_flow_rate_l_s2"].map(str::to_owned).to_vec();
        }
        names.extend([format!("wind_up_{travel}"), angle.to_owned(), rate.to_owned()]);
        for k in 1..=self.body.modes.len() {
            names.push(format!("mode_{k}_{travel}"));
            names.push(format!("mode_{k}_{rate}"));
        }
        names.push(match self.parameters.axis {
            AxisKind::Rotary => "relative_hub_angle_rad".to_owned(),
            AxisKind::Linear => "relative_position_m".to_owned(),
        });
        names
    }
}

/// With x = y + c w_p the platform's rate drives y by A c: a row of it.
fn carried_through(core: &Core, row: usize) -> f64 {
    core.carried.iter().enumerate().map(|(j, c)| core.A[(row, j)] * c).sum()
}

/// Moves what acts on the hub's inertial angle, the row `angles` of the core's states, onto its relative angle.
fn move_gradient(core: &mut Core, relative: usize, angles: &[f64]) {
    for row in 0..relative {
        let gradient = core.A[(row, state::ANGLE)];
        core.A[(row, relative)] += gradient;
        for (j, share) in angles.iter().enumerate() {
            core.A[(row, j)] -= gradient * share;
        }
    }
}

/// Returns what the platform's rate moves of an output by moving the state.
fn carried_part(states: &[f64], carried: &[f64]) -> f64 {
    states.iter().zip(carried).map(|(row, c)| row * c).sum()
}

/// Returns the row that picks one of n.
pub(super) fn unit(n: usize, k: usize) -> Vec<f64> {
    (0..n).map(|j| f64::from(u8::from(j == k))).collect()
}

/// Returns the describing function of the dry part as a stiffness and a damping: F = k x + c x' for x = A sin(w t).
pub fn friction_impedance(friction: &Friction, amplitude: f64, frequency: f64) -> Result<Impedance, Error> {
    let dry = Friction {
        viscous_nm_s_rad: 0.0,
        viscous_asymmetry: 0.0,
        quadratic_nm_s2_rad2: 0.0,
        ..friction.clone()
    };
    let complex = describing_function(&FrictionModel::new(&dry)?, amplitude, frequency);
    Ok(Impedance { stiffness: complex.re, damping: complex.im / frequency })
}
