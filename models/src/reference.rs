//! The reference rig: a steel cantilever on a moving platform, nose-heavy by 1.5 kN m, driven through a gearbox.
//!
//! The numbers are those of the project's reference machine; examples and tests of every crate start from it.

use crate::loads::Loads;
use crate::parameters::cylinder::Lever;
use crate::parameters::*;

/// Puts a hydraulic cylinder of 25 cm^2 at 20 MPa, with a valve of 60 Hz, in the place of motor, gear and amplifier of the rig.
pub fn put_cylinder(p: &mut Parameters, lever: Lever) {
    let (valve_frequency_rad_s, valve_damping) = (60.0 * std::f64::consts::TAU, 0.8);
    p.gearbox = Gearbox { ratio: lever.at(0.0).arm_m, ..Gearbox::DIRECT };
    (p.motor.inertia_kg_m2, p.motor.torque_constant_nm_a, p.motor.back_emf_v_s_rad) = (0.0, 2500.0, 2.5);
    (p.motor.resistance_ohm, p.motor.inductance_h) = (0.004, 2.0 / (4.0 * 800.0));
    (p.amplifier.gain, p.amplifier.current_feedback_v_a) = (0.09, 0.0);
    p.amplifier.time_constant_s = 2.0 * valve_damping / valve_frequency_rad_s;
    p.amplifier.bus_voltage_v = f64::INFINITY;
    p.cylinder = Some(Cylinder {
        supply_mpa: 20.0,
        volume_l: 2.0,
        overlap_l_s: 0.0,
        valve_frequency_rad_s,
        valve_damping,
        rated_drop_mpa: 7.0,
        lever,
    });
}

/// Returns the reference rig in its normal configuration.
pub fn rig() -> Parameters {
    Parameters {
        name: "reference rig".to_owned(),
        axis: AxisKind::Rotary,
        gravity_m_s2: 9.80665,
        beam: Some(beam()),
        lumped: Some(lumped_rig()),
        gearbox: Gearbox {
            kind: Transmission::Gearbox,
            ratio: 200.0,
            stiffness_nm_rad: 2.4e6,
            damping_nm_s_rad: 2500.0,
            backlash_rad: 0.5e-3,
            mesh_ripple: Ripple::NONE,
            mesh_efficiency: 1.0,
            kinematic_error: Ripple::NONE,
            hysteresis_nm: 0.0,
            hysteresis_stiffness_nm_rad: 0.0,
        },
        motor: motor(),
        amplifier: amplifier(),
        cylinder: None,
        motor_friction: dahl(0.065, 1.3, 0.002),
        pivot_friction: dahl(117.0, 2.4e5, 60.0),
        sensors: sensors(),
        interface: Interface {
            sample_period_s: 1e-3,
            input_bits: 16,
            output_bits: 12,
            output_delay_samples: 0,
            clock: Clock::IDEAL,
            missing_codes: 0.0,
        },
        configurations: configurations(),
        learned: Vec::new(),
        loads: Loads::default(),
        drive_limits: DriveLimits::default(),
    }
}

fn beam() -> Beam {
    let tube = |name: &str, from_m, to_m, outer_diameter_m| BeamSection {
        name: name.to_owned(),
        from_m,
        to_m,
        shape: SectionShape::Tube { outer_diameter_m, inner_diameter_m: [0.05, 0.05] },
    };
    let mass = |name: &str, position_m, mass_kg| PointMass {
        name: name.to_owned(),
        position_m,
        mass_kg,
        inertia_kg_m2: 0.0,
    };
    Beam {
        youngs_modulus_pa: 205e9,
        poissons_ratio: 0.3,
        density_kg_m3: 7850.0,
        pivot_m: 0.0,
        modal_damping: vec![0.010, 0.008, 0.008, 0.010],
        damping: StructuralDamping::Modal,
        sections: vec![
            tube("breech and hub", -0.55, 0.25, [0.220, 0.220]),
            tube("rear tube", 0.25, 1.30, [0.140, 0.105]),
            tube("front tube", 1.30, 3.20, [0.105, 0.070]),
        ],
        masses: vec![
            mass("1", 0.35, 104.0),
            mass("2", 0.35, 104.0),
            mass("3", -0.60, 63.2),
            mass("4", -0.60, 96.1),
            mass("5", -0.60, 93.5),
        ],
    }
}

fn lumped_rig() -> LumpedStructure {
    LumpedStructure {
        hub_inertia_kg_m2: 74.1,
        beam_inertia_kg_m2: 271.6,
        stiffness_nm_rad: 3.305e6,
        damping_nm_s_rad: 277.0,
        out_of_balance_kg_m: 151.67,
        vertical_offset_kg_m: 0.0,
        position_stiffness_nm_rad: 0.0,
        position_stiffness_centre_rad: 0.0,
        hysteresis_nm: 0.0,
        hysteresis_stiffness_nm_rad: 0.0,
        chain: Vec::new(),
    }
}

fn motor() -> Motor {
    Motor {
        inertia_kg_m2: 4.0e-3,
        torque_constant_nm_a: 0.86,
        back_emf_v_s_rad: 0.86,
        resistance_ohm: 0.8,
        inductance_h: 4.0e-3,
        cogging: Ripple::NONE,
        torque_ripple: Ripple::NONE,
        platform_coupling: 0.0,
    }
}

fn amplifier() -> Amplifier {
    Amplifier {
        gain: 30.0,
        current_feedback_v_a: 0.3067,
        time_constant_s: 1.5e-3,
        input_limit_v: 10.0,
        bus_voltage_v: 150.0,
        map: Vec::new(),
        dead_zone_v: 0.0,
        current_limit_a: f64::INFINITY,
        dynamics: AmplifierDynamics::Modelled,
    }
}

fn dahl(coulomb_nm: f64, rest_stiffness_nm_rad: f64, viscous_nm_s_rad: f64) -> Friction {
    Friction::with_viscous_part(
        FrictionLaw::Dahl { coulomb_nm, rest_stiffness_nm_rad, exponent: 1.0 },
        viscous_nm_s_rad,
    )
}

fn sensors() -> Sensors {
    let gyro =
        Sensor { natural_frequency_rad_s: 377.0, scale_v_unit: 10.0, noise_rms: 2.0e-4, ..Sensor::IDEAL };
    Sensors {
        hub_gyro: gyro.clone(),
        measured: FeedbackSignal::HubRate,
        platform_gyro: gyro,
        platform_accelerometer: Sensor {
            natural_frequency_rad_s: 628.0,
            scale_v_unit: 0.5,
            noise_rms: 5.0e-3,
            ..Sensor::IDEAL
        },
        accelerometer_lever_arm_m: 0.0,
        accelerometer_axis: AccelerometerAxis::Vertical,
        surge_accelerometer: None,
        motor_tachometer: Some(Sensor { scale_v_unit: 0.1, noise_rms: 2.0e-2, ..Sensor::IDEAL }),
        hub_resolver: Some(Sensor { scale_v_unit: 20.0, noise_rms: 2.0e-5, ..Sensor::IDEAL }),
    }
}

fn configurations() -> Vec<Configuration> {
    let with = |name: &str, masses: &[&str], added_hub_inertia_kg_m2| Configuration {
        name: name.to_owned(),
        masses: masses.iter().map(|m| (*m).to_owned()).collect(),
        added_hub_inertia_kg_m2,
    };
    vec![
        with("normal", &[], 0.0),
        with("75 percent", &["3"], 0.0),
        with("37 percent", &["3", "4"], 0.0),
        with("balanced", &["3", "4", "5"], 0.0),
        with("148 percent", &["1", "2"], 0.0),
        with("dumb-bell", &[], 41.5),
        with("dumb-bell and 2 masses", &[], 86.4),
        with("dumb-bell and 4 masses", &[], 127.9),
    ]
}
