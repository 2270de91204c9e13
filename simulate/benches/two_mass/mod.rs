//! The two-mass servo on which other solvers are measured: motor, gear with backlash, load, friction, gyroscope, and a
//! controller of order eleven at 1 kHz.

use counterpoise_controller::{Readings, SampledController};
use counterpoise_models::plant::Body;
use counterpoise_models::plant::core::state;
use counterpoise_models::{Friction, FrictionLaw, Parameters, Plant, Sensor, reference};
use counterpoise_simulate::{
    Bonds, FrictionState, Initial, PlantState, PlatformMotion, Scenario, Signal, Sine,
};
use std::error::Error;
use std::f64::consts::TAU;

/// The control is halved on its way through the +/- 10 V converter, and doubled by the amplifier.
pub const VOLTS_PER_TORQUE: f64 = 0.5;
/// Gear ratio.
pub const RATIO: f64 = 500.0;

/// u = C x + D e, limited to +/- 20; x+ = A x + B e.
pub struct Controller {
    A: Vec<[f64; 11]>,
    B: [f64; 11],
    C: [f64; 11],
    D: f64,
    x: [f64; 11],
}

impl Controller {
    /// Reads `controller.txt` of the comparison.
    pub fn read(path: &str) -> Result<Self, Box<dyn Error>> {
        let text = std::fs::read_to_string(path)?;
        let numbers: Vec<f64> = text.split_whitespace().skip(3).map(str::parse).collect::<Result<_, _>>()?;
        let row = |k: usize| -> Result<[f64; 11], Box<dyn Error>> {
            Ok(numbers.get(11 * k..11 * (k + 1)).ok_or("the file is too short")?.try_into()?)
        };
        let A = (0..11).map(row).collect::<Result<_, _>>()?;
        let D = *numbers.get(143).ok_or("the file is too short")?;
        Ok(Self { A, B: row(11)?, C: row(12)?, D, x: [0.0; 11] })
    }
}

impl SampledController for Controller {
    fn reset(&mut self) {
        self.x = [0.0; 11];
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        let error = readings.demand_rad_s - readings.hub_rate_rad_s;
        let dot = |row: &[f64; 11]| row.iter().zip(&self.x).map(|(a, x)| a * x).sum::<f64>();
        let control = (self.D * error + dot(&self.C)).clamp(-20.0, 20.0);
        let mut next = [0.0; 11];
        for (i, entry) in next.iter_mut().enumerate() {
            *entry = dot(&self.A[i]) + self.B[i] * error;
        }
        self.x = next;
        control * VOLTS_PER_TORQUE
    }
}

fn friction(law: u32, levels: [f64; 4], stribeck: f64, viscous: f64) -> Friction {
    let [coulomb_nm, stiffness, damping, times] = levels;
    let (stiffness, damping) = (stiffness * times, damping * times.sqrt());
    let law = match law {
        0 => FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad: stiffness, exponent: 1.0 },
        1 => FrictionLaw::Lugre {
            coulomb_nm,
            bristle_stiffness_nm_rad: stiffness,
            bristle_damping_nm_s_rad: damping,
        },
        _ => FrictionLaw::ResetIntegrator {
            coulomb_nm,
            deflection_rad: coulomb_nm / stiffness,
            damping_nm_s_rad: damping,
        },
    };
    let ratio = if matches!(law, FrictionLaw::Dahl { .. }) { 1.0 } else { 1.3 };
    Friction {
        static_ratio: ratio,
        stribeck_rate_rad_s: stribeck,
        ..Friction::with_viscous_part(law, viscous)
    }
}

fn parameters(law: u32, stiffness: u32) -> Parameters {
    let times = [1.0, 20.0, 500.0][stiffness.min(2) as usize];
    let mut p = Parameters { gravity_m_s2: 0.0, lumped: None, ..reference::rig() };
    p.gearbox.ratio = RATIO;
    p.gearbox.stiffness_nm_rad = 1.5e6;
    p.gearbox.damping_nm_s_rad = 3000.0;
    p.gearbox.backlash_rad = 3e-4;
    p.motor.inertia_kg_m2 = 0.005;
    p.motor.torque_constant_nm_a = 1.0;
    p.motor.back_emf_v_s_rad = 0.0;
    p.motor.resistance_ohm = 1.0;
    p.motor.inductance_h = 1e-7;
    p.motor.platform_coupling = 1.0;
    p.amplifier.gain = 1.0 / VOLTS_PER_TORQUE;
    p.amplifier.current_feedback_v_a = 0.0;
    p.amplifier.time_constant_s = 1e-3;
    p.motor_friction = friction(law, [0.4, 4.0, 0.04, times], 5.0, 0.002);
    p.pivot_friction = friction(law, [250.0, 5e5, 1e4, times], 0.01, 50.0);
    p.sensors.hub_gyro = Sensor { natural_frequency_rad_s: TAU * 50.0, ..Sensor::IDEAL };
    p
}

/// Ten seconds on a moving platform, with a demand.
pub fn scenario(plant: &Plant) -> Scenario {
    let sines = |rows: [(f64, f64); 3], order: i32| {
        let sine = |(a, hz): (f64, f64)| Sine {
            amplitude: a * (TAU * hz).powi(order),
            frequency_rad_s: TAU * hz,
            phase_rad: f64::from(order) * TAU / 4.0,
        };
        Signal::Sines(rows.map(sine).to_vec())
    };
    let pitch_rate = sines([(0.020, 0.7), (0.008, 1.3), (0.003, 2.9)], 1);
    let mut core = vec![0.0; plant.core_order()];
    core[state::MOTOR] = pitch_rate.at(0.0);
    Scenario {
        demand_rad_s: Signal::Steps(vec![(3.0, 0.02), (5.0, -0.02), (7.0, 0.0)]),
        platform: PlatformMotion {
            pitch_rate_rad_s: pitch_rate,
            heave_m_s2: sines([(1.5, 1.1), (0.8, 2.3), (0.4, 4.1)], 0),
            initial_angle_rad: 0.0,
            further: None,
        },
        initial: Initial::State(Box::new(PlantState {
            core,
            friction: FrictionState::default(),
            bonds: Bonds::default(),
            hub_gyro: [0.0; 2],
        })),
        ..Scenario::at_rest(10.001)
    }
}

/// The plant with a friction (0 Dahl, 1 LuGre, 2 reset integrator) at a stiffness (0, 1, 2: once, 20 times, 500 times).
pub fn plant(law: u32, stiffness: u32) -> Result<Plant, counterpoise_models::Error> {
    let body = Body {
        inertia_kg_m2: 2500.0,
        out_of_balance_kg_m: -300.0,
        vertical_offset_kg_m: 0.0,
        modes: Vec::new(),
    };
    Plant::with_body(&parameters(law, stiffness), body)
}
