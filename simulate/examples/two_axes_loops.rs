//! Reads the motion of a base from standard input (a period, then lines of three specific forces and three rates), runs two axes with proportional-integral
//! controllers on it, and prints time, rate of the elevation axis, rate of the ring, and elevation. `tests/peers/base_motion/two_axes_loops.py` solves
//! Lagrange's equations of the same machine.

use std::error::Error;
use std::io::{BufRead, Write};

use counterpoise_controller::ProportionalIntegral;
use counterpoise_models::plant::SinCos;
use counterpoise_models::two_axes::{BodyInertia, Coupling, ElevatedBody, PivotPosition, TraverseGyroscope};
use counterpoise_models::{
    AmplifierDynamics, Friction, FrictionLaw, Gearbox, LumpedStructure, Plant, Sensor, reference,
};
use counterpoise_simulate::{
    AxisScenario, BaseMotion, Controllers, Detail, Firing, Signal, TwoAxisScenario, TwoAxisSimulator,
};

/// One inertia with viscous friction, driven by a torque.
struct Axis {
    inertia_kg_m2: f64,
    out_of_balance_kg_m: f64,
    vertical_offset_kg_m: f64,
    viscous_nm_s_rad: f64,
    gravity_m_s2: f64,
}

impl Axis {
    fn plant(&self) -> Result<Plant, counterpoise_models::Error> {
        let mut p = reference::rig();
        let lumped = LumpedStructure {
            out_of_balance_kg_m: self.out_of_balance_kg_m,
            vertical_offset_kg_m: self.vertical_offset_kg_m,
            ..LumpedStructure::rigid(self.inertia_kg_m2)
        };
        (p.beam, p.lumped, p.gearbox) = (None, Some(lumped), Gearbox::DIRECT);
        p.gravity_m_s2 = self.gravity_m_s2;
        p.motor.inertia_kg_m2 = 0.0;
        p.amplifier.dynamics = AmplifierDynamics::TorqueCommand;
        p.motor_friction = Friction::with_viscous_part(FrictionLaw::None, 0.0);
        p.pivot_friction = Friction::with_viscous_part(FrictionLaw::None, self.viscous_nm_s_rad);
        p.sensors.hub_gyro = Sensor::IDEAL;
        Plant::from_lumped(&p)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let lines: Vec<String> = std::io::stdin().lock().lines().collect::<Result<_, _>>()?;
    let (period, rows) = lines.split_first().ok_or("no input")?;
    let period_s: f64 = period.trim().parse()?;
    let mut columns = vec![Vec::new(); 6];
    for row in rows {
        for (column, word) in columns.iter_mut().zip(row.split_whitespace()) {
            column.push(word.parse::<f64>()?);
        }
    }
    let signal = |k: usize| Signal::Samples { period_s, values: columns[k].clone() };
    let base = BaseMotion {
        specific_force_m_s2: [signal(0), signal(1), signal(2)],
        rate_rad_s: [signal(3), signal(4), signal(5)],
        initial_pitch_rad: 0.0,
    };
    let elevation = Axis {
        inertia_kg_m2: 12.0,
        out_of_balance_kg_m: 1.5,
        vertical_offset_kg_m: 0.4,
        viscous_nm_s_rad: 2.0,
        gravity_m_s2: 9.80665,
    };
    let traverse = Axis {
        inertia_kg_m2: 30.0,
        out_of_balance_kg_m: 2.5,
        vertical_offset_kg_m: -0.6,
        viscous_nm_s_rad: 3.0,
        gravity_m_s2: 0.0,
    };
    run(&elevation.plant()?, &traverse.plant()?, base)
}

fn run(elevation: &Plant, traverse: &Plant, base: BaseMotion) -> Result<(), Box<dyn Error>> {
    let inertia = BodyInertia {
        about_axis_kg_m2: 12.0,
        about_beam_kg_m2: 2.0,
        about_normal_kg_m2: 13.0,
        product_kg_m2: 0.7,
    };
    let pivot = PivotPosition { forward_m: 0.4, left_m: -0.6 };
    let body = ElevatedBody::of_plant(elevation, inertia, pivot, SinCos::of(0.2));
    let coupling = Coupling { body, gyroscope: TraverseGyroscope::ElevatedMass };
    let steps = |pairs: &[(f64, f64)]| Signal::Steps(pairs.to_vec());
    let scenario = TwoAxisScenario {
        duration_s: 5.0,
        base,
        elevation: AxisScenario {
            demand_rad_s: steps(&[(0.5, 0.3), (2.0, -0.2)]),
            ..AxisScenario::at_rest(0.3)
        },
        traverse: AxisScenario {
            demand_rad_s: steps(&[(1.0, -0.4), (3.0, 0.5)]),
            ..AxisScenario::at_rest(0.5)
        },
        detail: Detail::Everything,
        firing: Firing::Silent,
    };
    let gains = |kp_v_s_rad: f64, ki_v_rad: f64| ProportionalIntegral {
        kp_v_s_rad,
        ki_v_rad,
        bias_v: 0.0,
        sample_period_s: 1e-3,
        ..ProportionalIntegral::default()
    };
    let mut controllers = Controllers { elevation: &mut gains(8.0, 40.0), traverse: &mut gains(20.0, 100.0) };
    let found = TwoAxisSimulator::new(elevation, traverse, coupling)?.run(&mut controllers, &scenario)?;
    let mut out = std::io::stdout().lock();
    for k in 0..found.elevation_rad().len() {
        let (above, below) =
            (found.elevation.truth.hub_rate_rad_s()[k], found.traverse.truth.hub_rate_rad_s()[k]);
        writeln!(out, "{} {above:e} {below:e} {:e}", k as f64 * 1e-3, found.elevation_rad()[k])?;
    }
    Ok(())
}
