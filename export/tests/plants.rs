//! The plant unit's C beside the simulator: the same equations by two methods, physics by physics, in an open loop that drives the
//! mechanism hard while its platform heaves and pitches.
//!
//! Each method is run twice, as it is and refined: that shows its own error, and the bound on the difference is made of these two.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::support;

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use counterpoise_export::fmi::{MOST_DELAY_SAMPLES, PlantUnit, PlantUnitError, plant_unit};
use counterpoise_models::loads::equilibrator::{Action, Equilibrator, Force, Gas};
use counterpoise_models::loads::{EndStops, Recoil};
use counterpoise_models::parameters::cylinder::Lever;
use counterpoise_models::plant::{Body, BodyMode};
use counterpoise_models::{
    AccelerometerAxis, AmplifierDynamics, AxisKind, FeedbackSignal, Friction, FrictionLaw, LearnedElement,
    LearnedPlace, LearnedQuantity, Linkage, MapPoint, MotorHeat, OperatingPoint, Parameters, Plant,
    RegimeVariable, Ripple, Sensor, StribeckCurve, reference,
};
use counterpoise_simulate::convergence::convergence_cases;
use counterpoise_simulate::{Firing, FurtherMotion, PlatformMotion, Playback, Scenario, Signal, Simulator};
use support::{STRICT, folder, is_there, provenance, run, write};

/// Samples of a run.
const SAMPLES: usize = 1000;
/// Factor by which the C's shortest step is shorter when it is refined; its tolerance is smaller by the square of that.
const REFINED: f64 = 8.0;
/// Parts of a sample period that the refined simulator's longest step is one of.
const PARTS: usize = 4;
/// Difference relative to the largest value that rounding and printing leave.
const FLOOR: f64 = 2e-7;
/// The difference may be so many times the sum of what both methods change by when they are refined.
const TIMES: f64 = 2.0;
/// No difference may be larger than this, whatever the methods' own errors.
const MOST: f64 = 2e-3;

/// A machine, and what drives it.
struct Machine {
    name: String,
    plant: Plant,
    control_v: f64,
}

/// The signals that are compared: readings and truths, sample by sample.
type Columns = Vec<[f64; COLUMNS]>;
/// Readings and truths; the last one is the second accelerometer, 0 for a machine without one.
const COLUMNS: usize = 9;

fn machine(name: &str, change: impl FnOnce(&mut Parameters)) -> Machine {
    let mut parameters = reference::rig();
    change(&mut parameters);
    Machine { name: name.to_owned(), plant: Plant::from_lumped(&parameters).unwrap(), control_v: 0.8 }
}

/// Returns a drive through rest and both directions around the control that holds the machine.
fn controls(machine: &Machine) -> Vec<f64> {
    let held = machine.plant.equilibrium(&OperatingPoint::default()).control_v;
    let period_s = machine.plant.parameters().interface.sample_period_s;
    let at = |k: usize| {
        let t = k as f64 * period_s;
        let ramp = (t / 0.2).min(1.0);
        held + machine.control_v * ramp * ((9.0 * t).sin() + 0.6 * (23.0 * t).sin())
    };
    (0..SAMPLES).map(at).collect()
}

/// Straight lines from sample to sample, with corners at samples: what the unit is given over a step is exact.
fn platform(machine: &Machine) -> PlatformMotion {
    let period_s = machine.plant.parameters().interface.sample_period_s;
    let surge_m_s2 = Signal::Triangle { amplitude: 2.0, period_s: 320.0 * period_s };
    let further = FurtherMotion { surge_m_s2, roll_rate_rad_s: Signal::ZERO, yaw_rate_rad_s: Signal::ZERO };
    PlatformMotion {
        further: machine.plant.parameters().sensors.reads_surge().then_some(further),
        pitch_rate_rad_s: Signal::Triangle { amplitude: 0.05, period_s: 400.0 * period_s },
        heave_m_s2: Signal::Triangle { amplitude: 0.6, period_s: 240.0 * period_s },
        ..PlatformMotion::STILL
    }
}

/// Returns the simulator's run, its sample period cut into parts with the control held over them, and its tolerance by the cube
/// of that.
fn simulate_parts(machine: &Machine, parts: usize) -> Columns {
    let mut parameters = machine.plant.parameters().clone();
    let held = controls(machine).into_iter().flat_map(|control| std::iter::repeat_n(control, parts));
    let motion = platform(machine);
    parameters.interface.sample_period_s /= parts as f64;
    parameters.interface.output_delay_samples *= parts;
    let plant = Plant::with_whole_body(&parameters, machine.plant.body().clone()).unwrap();
    let duration_s = (SAMPLES * parts) as f64 * parameters.interface.sample_period_s;
    let scenario = Scenario { platform: motion, firing: Firing::Stated, ..Scenario::at_rest(duration_s) };
    let tolerance = counterpoise_simulate::tolerance::TOLERANCE / parts.pow(3) as f64;
    let mut simulator = Simulator::with_tolerance(&plant, tolerance).unwrap();
    let run = simulator.run(&mut Playback::new(&held.collect::<Vec<_>>()), &scenario).unwrap();
    let (r, t) = (&run.readings, &run.truth);
    let at = |k: usize| {
        let readings = [r.hub_rate_rad_s()[k], r.platform_rate_rad_s()[k], r.platform_accel_m_s2()[k]];
        let relative = [r.motor_rate_rad_s()[k], r.hub_position_rad()[k]];
        let truths = [t.hub_rate_rad_s()[k], t.tip_rate_rad_s()[k], t.current_a()[k]];
        let surge = [r.platform_surge_m_s2().get(k).copied().unwrap_or(0.0)];
        let all = readings.iter().chain(&relative).chain(&truths).chain(&surge);
        let row: Vec<f64> = all.copied().collect();
        row.try_into().unwrap()
    };
    (0..SAMPLES).map(|k| at(k * parts)).collect()
}

const DRIVER: &str = r#"#include "rig.h"
#include <stdio.h>

int main(void)
{
    static rig_state s;
    rig_inputs in;
    double period;
    double next[2];
    double surge[2];
    int first = 1;
    if (scanf("%lf", &period) != 1) {
        return 1;
    }
    while (scanf("%lf %lf %lf %lf %lf %lf %lf", &in.control_v, &in.heave_m_s2, &next[0], &in.pitch_rate_rad_s, &next[1],
        &surge[0], &surge[1]) == 7) {
        rig_outputs o;
        if (first) {
#ifdef SURGE
            rig_begin(&s, 0.0, in.heave_m_s2, in.pitch_rate_rad_s, surge[0]);
#else
            rig_begin(&s, 0.0, in.heave_m_s2, in.pitch_rate_rad_s);
#endif
            first = 0;
        }
        rig_read(&s, &o);
        printf("%.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", o.hub_rate_rad_s, o.platform_rate_rad_s,
            o.platform_accel_m_s2, o.motor_rate_rad_s, o.hub_position_rad, o.true_hub_rate_rad_s,
            o.true_tip_rate_rad_s, o.current_a, SECOND);
        in.heave_slope_m_s3 = (next[0] - in.heave_m_s2) / period;
#ifdef SURGE
        in.surge_m_s2 = surge[0];
        in.surge_slope_m_s3 = (surge[1] - surge[0]) / period;
#endif
        in.pitch_slope_rad_s2 = (next[1] - in.pitch_rate_rad_s) / period;
        rig_move(&s, &in, period);
    }
    return 0;
}
"#;

/// Returns the unit's own C, compiled with a driver.
fn program(machine: &Machine, folder: &Path, refined: f64) -> PathBuf {
    let files = plant_unit(PlantUnit { plant: &machine.plant, name: "rig" }, &provenance()).unwrap();
    write(folder, &files);
    let sources = folder.join("rig/sources");
    std::fs::write(sources.join("driver.c"), DRIVER).unwrap();
    let name = format!("driver{refined}");
    let flags = ["-O2", "-ffp-contract=off", "rig.c", "driver.c", "-lm", "-o", &name];
    let sensors = &machine.plant.parameters().sensors;
    let second = if sensors.surge_accelerometer.is_some() { "o.platform_surge_m_s2" } else { "0.0" };
    let mut define = vec![format!("-DREFINED={refined:?}"), format!("-DSECOND={second}")];
    define.extend(sensors.reads_surge().then(|| "-DSURGE".to_owned()));
    let said = run(Command::new("cc")
        .current_dir(&sources)
        .args(&STRICT[2..])
        .arg("-std=c99")
        .args(define)
        .args(flags));
    assert_eq!(said, "", "{}", machine.name);
    sources.join(name)
}

fn in_c(machine: &Machine, folder: &Path, refined: f64) -> Columns {
    let period_s = machine.plant.parameters().interface.sample_period_s;
    let motion = platform(machine);
    let surge = motion.further.as_ref().map_or(Signal::ZERO, |further| further.surge_m_s2.clone());
    let mut rows = format!("{period_s:?}\n");
    for (k, control) in controls(machine).iter().enumerate() {
        let [now, next] = [k, k + 1].map(|k| k as f64 * period_s);
        let [heave, heave_next] = [now, next].map(|t| motion.heave_m_s2.at(t));
        let [rate, rate_next] = [now, next].map(|t| motion.pitch_rate_rad_s.at(t));
        let [forward, forward_next] = [now, next].map(|t| surge.at(t));
        writeln!(
            rows,
            "{control:?} {heave:?} {heave_next:?} {rate:?} {rate_next:?} {forward:?} {forward_next:?}"
        )
        .unwrap();
    }
    let mut started = Command::new(program(machine, folder, refined))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = started.stdin.take().unwrap();
    let feeder = std::thread::spawn(move || stdin.write_all(rows.as_bytes()));
    let output = started.wait_with_output().unwrap();
    feeder.join().unwrap().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let row = |line: &str| {
        let values: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        std::array::from_fn(|k| values[k])
    };
    text.lines().map(row).collect()
}

/// Returns the largest difference of a column, relative to its largest value, and which column it is.
fn difference(a: &Columns, b: &Columns) -> (f64, usize) {
    assert_eq!(a.len(), b.len());
    let of = |column: usize| {
        let largest = b.iter().fold(f64::MIN_POSITIVE, |most, row| most.max(row[column].abs()));
        let worst = a.iter().zip(b).fold(0.0, |most: f64, (a, b)| {
            let off = (a[column] - b[column]).abs();
            if off <= most { most } else { off }
        });
        (if worst == 0.0 { 0.0 } else { worst / largest }, column)
    };
    (0..COLUMNS).map(of).fold((0.0, 0), |most, one| if one.0 <= most.0 { most } else { one })
}

/// Compares the C with the simulator; tells what is wrong.
fn compare(machine: &Machine) -> Option<String> {
    let folder = folder(&format!("plant_{}", machine.name.replace([' ', ',', ':'], "_")));
    let (ours, finer) = (simulate_parts(machine, 1), simulate_parts(machine, PARTS));
    let (c, finer_c) = (in_c(machine, &folder, 1.0), in_c(machine, &folder, REFINED));
    let (own, own_c) = (difference(&ours, &finer).0, difference(&c, &finer_c).0);
    let (refined, _) = difference(&finer_c, &finer);
    let (found, column) = difference(&c, &ours);
    let allowed = (FLOOR + TIMES * (own + own_c)).min(MOST);
    println!(
        "{:38} C from simulator {found:.1e} (column {column}; refined {refined:.1e}), allowed {allowed:.1e}; refining \
         changes the simulator by {own:.1e}, the C by {own_c:.1e}",
        machine.name
    );
    let wrong = found > allowed || found.is_nan();
    wrong.then(|| format!("{}: {found:e} above {allowed:e}", machine.name))
}

fn all_equal(machines: &[Machine]) {
    if !is_there("cc") {
        return support::report_skip("no C compiler");
    }
    let wrong: Vec<String> = machines.iter().filter_map(compare).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_law_of_friction_and_contact() {
    let rig = Plant::from_lumped(&reference::rig()).unwrap();
    let of = |case: counterpoise_simulate::convergence::Case| Machine {
        name: format!("pivot: {}", case.name),
        plant: case.plant,
        control_v: case.control_v.abs(),
    };
    all_equal(&convergence_cases(&rig).unwrap().into_iter().map(of).collect::<Vec<_>>());
}

#[test]
fn friction_that_sticks_at_motor_and_pivot() {
    let sticking = |law: FrictionLaw, ratio: f64, viscous: f64| Friction {
        static_ratio: ratio,
        stribeck_rate_rad_s: 0.05,
        ..Friction::with_viscous_part(law, viscous)
    };
    let stribeck = |coulomb_nm| FrictionLaw::Stribeck { coulomb_nm, curve: StribeckCurve::Gaussian };
    all_equal(&[
        machine("motor: Coulomb with stiction", |p| {
            p.motor_friction = sticking(FrictionLaw::Coulomb { coulomb_nm: 0.3 }, 1.2, 0.002);
        }),
        machine("both joints stick, rotor coupled", |p| {
            p.motor.platform_coupling = 1.0;
            p.motor_friction = sticking(stribeck(0.3), 1.2, 0.002);
            p.pivot_friction = sticking(stribeck(117.0), 1.3, 60.0);
        }),
        machine("Karnopp at both joints", |p| {
            let karnopp =
                |coulomb_nm, stick_rate_rad_s| FrictionLaw::Karnopp { coulomb_nm, stick_rate_rad_s };
            p.motor_friction = sticking(karnopp(0.3, 0.1), 1.2, 0.002);
            p.pivot_friction = sticking(karnopp(117.0, 1e-3), 1.2, 60.0);
        }),
    ]);
}

#[test]
fn a_platform_that_surges() {
    let offset = |p: &mut Parameters| p.lumped.as_mut().unwrap().vertical_offset_kg_m = 40.0;
    all_equal(&[
        machine("accelerometer on the elevated mass", |p| {
            offset(p);
            p.sensors.accelerometer_axis = AccelerometerAxis::Elevated;
        }),
        machine("accelerometers of heave and surge", |p| {
            offset(p);
            let second = Sensor { delay_s: 2e-3, gain: 1.02, ..p.sensors.platform_accelerometer.clone() };
            p.sensors.surge_accelerometer = Some(second);
        }),
        machine("tilted accelerometers of heave and surge", |p| {
            let mut second = p.sensors.platform_accelerometer.clone();
            second.alignment.tilt_rad = -0.04;
            p.sensors.surge_accelerometer = Some(second);
            p.sensors.platform_accelerometer.alignment.tilt_rad = 0.07;
            p.sensors.accelerometer_lever_arm_m = 0.3;
        }),
        machine("tilted accelerometer on the elevated mass", |p| {
            p.sensors.accelerometer_axis = AccelerometerAxis::Elevated;
            p.sensors.platform_accelerometer.alignment.tilt_rad = -0.05;
        }),
        machine("tilted accelerometer alone", |p| {
            p.sensors.platform_accelerometer.alignment.tilt_rad = 0.05;
        }),
    ]);
}

#[test]
fn what_modulates_friction() {
    all_equal(&[
        machine("asymmetric friction", |p| {
            p.pivot_friction.asymmetry = 0.2;
            p.motor_friction.viscous_asymmetry = -0.3;
        }),
        machine("quadratic drag", |p| p.motor_friction.quadratic_nm_s2_rad2 = 2e-3),
        machine("friction over the angle", |p| {
            p.pivot_friction.position_ripple = Ripple { amplitude: 0.3, order: 40.0, phase_rad: 0.4 };
            p.motor_friction.position_ripple = Ripple { amplitude: 0.2, order: 2.0, phase_rad: 0.0 };
        }),
        machine("friction with load and warmth", |p| {
            p.pivot_friction.load_coefficient = 0.02;
            p.motor_friction.load_coefficient = 0.02;
            p.pivot_friction.warm_up = 0.3;
            p.pivot_friction.warm_up_time_s = 0.7;
        }),
        machine("Dahl of exponent 1.5 at the motor", |p| {
            p.motor_friction.law =
                FrictionLaw::Dahl { coulomb_nm: 0.3, rest_stiffness_nm_rad: 5.0, exponent: 1.5 };
        }),
        machine("hose with hysteresis", |p| {
            let lumped = p.lumped.as_mut().unwrap();
            (lumped.hysteresis_nm, lumped.hysteresis_stiffness_nm_rad) = (200.0, 2e4);
        }),
    ]);
}

#[test]
fn motor_amplifier_and_gear() {
    let ripple = |amplitude, order| Ripple { amplitude, order, phase_rad: 0.7 };
    all_equal(&[
        machine("the reference rig", |_| {}),
        machine("cogging", |p| p.motor.cogging = ripple(0.2, 6.0)),
        machine("torque ripple", |p| p.motor.torque_ripple = ripple(0.1, 12.0)),
        machine("mesh ripple", |p| p.gearbox.mesh_ripple = ripple(60.0, 3.0)),
        machine("mesh efficiency", |p| p.gearbox.mesh_efficiency = 0.8),
        machine("current limit", |p| p.amplifier.current_limit_a = 9.0),
        machine("bus limit", |p| p.amplifier.bus_voltage_v = 14.0),
        machine("dead zone and map", |p| {
            p.amplifier.dead_zone_v = 0.1;
            let point = |input_v, current_a| MapPoint { input_v, current_a };
            p.amplifier.map = vec![point(2.0, 3.0), point(4.0, 14.0), point(8.0, 20.0)];
        }),
        machine("ideal current source", |p| p.amplifier.dynamics = AmplifierDynamics::IdealCurrent),
        machine("rotor coupled to the platform", |p| p.motor.platform_coupling = -1.0),
        machine("output delay", |p| p.interface.output_delay_samples = 6),
        machine("nearly balanced with backlash", |p| {
            p.gearbox.backlash_rad = 6e-3;
            p.lumped.as_mut().unwrap().out_of_balance_kg_m = 8.0;
        }),
    ]);
}

/// Returns a free function with points evenly over a reach to either side, or over a turn.
fn free_function(
    place: LearnedPlace,
    quantity: LearnedQuantity,
    variable: RegimeVariable,
    of: fn(f64) -> f64,
) -> LearnedElement {
    let reach = match variable {
        RegimeVariable::Load => 3000.0,
        RegimeVariable::Control => 8.0,
        _ if place == LearnedPlace::Gearbox => 2e-3,
        _ if matches!(place, LearnedPlace::Motor | LearnedPlace::MotorTachometer) => 20.0,
        _ => 0.15,
    };
    let share = |k: i32| f64::from(k - 10) / 10.0;
    let points: Vec<f64> = match variable {
        RegimeVariable::Turn => (0..20).map(|k| 0.1 + 0.3 * f64::from(k)).collect(),
        _ => (0..21).map(|k| reach * share(k)).collect(),
    };
    let values = (0..points.len()).map(|k| of(share(k as i32))).collect();
    LearnedElement { values, ..LearnedElement::neutral(place, quantity, variable, points) }
}

#[test]
fn what_free_functions_add() {
    use LearnedPlace::{
        Gearbox, HubResolver, LoopSensor, Motor, MotorTachometer, Pivot, PlatformAccelerometer, PlatformGyro,
    };
    use LearnedQuantity::{Damping, Error, FrictionLevel, Stiffness, Torque, TorqueConstant};
    use RegimeVariable::{Angle, Control, Load, Rate, Reading, Time, Turn};
    let bump = |x: f64| 1.0 + 0.4 * (-9.0 * x * x).exp();
    all_equal(&[
        machine("free friction and torque at the pivot", |p| {
            p.learned.push(free_function(Pivot, FrictionLevel, Angle, bump));
            p.learned.push(free_function(Pivot, Torque, Rate, |x| -80.0 * x * x * x));
            p.learned.push(free_function(Pivot, Damping, Time, |x| 1.0 + 0.5 * x));
        }),
        machine("free functions at the motor", |p| {
            p.learned.push(free_function(Motor, FrictionLevel, Load, bump));
            p.learned.push(free_function(Motor, Torque, Turn, |x| 0.2 * (6.0 * x).sin()));
            p.learned.push(free_function(Motor, TorqueConstant, Control, |x| 1.0 - 0.1 * x * x));
        }),
        machine("free functions of the gear", |p| {
            p.learned.push(free_function(Gearbox, Stiffness, Load, |x| 1.0 + 0.2 * x));
            p.learned.push(free_function(Gearbox, Damping, Rate, |x| 1.0 + x * x));
        }),
        machine("errors of the sensors", |p| {
            p.learned.push(free_function(Pivot, Torque, Angle, |x| -40.0 * x));
            p.learned
                .push(free_function(LoopSensor, Error, Reading, |x| -(20.0 * x).clamp(-1.0, 1.0) * 5e-3));
            p.learned.push(free_function(LoopSensor, Error, Time, |x| 2e-3 * x));
            p.learned.push(free_function(MotorTachometer, Error, Turn, |x| (3.0 * x).sin()));
            p.learned.push(free_function(HubResolver, Error, Reading, |x| 1e-3 * x * x));
            p.learned.push(free_function(PlatformGyro, Error, Reading, |x| -0.01 * x));
            p.learned.push(free_function(PlatformAccelerometer, Error, Reading, |x| 0.1 * x * x));
        }),
        machine("a constant free torque behind a rigid gear", |p| {
            (p.gearbox.stiffness_nm_rad, p.gearbox.backlash_rad) = (f64::INFINITY, 0.0);
            let one = LearnedElement {
                values: vec![40.0],
                ..LearnedElement::neutral(Pivot, Torque, Angle, vec![0.0])
            };
            p.learned.push(one);
        }),
    ]);
}

/// Puts a hydraulic cylinder in the place of motor and gear.
fn driven_by_cylinder(p: &mut Parameters, lever: Lever) {
    reference::put_cylinder(p, lever);
    p.cylinder.as_mut().unwrap().overlap_l_s = 0.01;
    let seals = FrictionLaw::Dahl { coulomb_nm: 300.0, rest_stiffness_nm_rad: 3e6, exponent: 1.0 };
    p.motor_friction = Friction::with_viscous_part(seals, 2500.0);
}

#[test]
fn a_hydraulic_cylinder() {
    let pushes = Linkage { arm_m: 0.6, arm_angle_rad: -0.3, anchor_m: 1.3, anchor_angle_rad: -1.7 };
    let pulls = Linkage { arm_angle_rad: 0.2, anchor_angle_rad: 1.9, ..pushes };
    all_equal(&[
        machine("cylinder with a constant lever", |p| driven_by_cylinder(p, Lever::Constant(0.5))),
        machine("cylinder that pushes", move |p| driven_by_cylinder(p, Lever::Linkage(pushes))),
        machine("cylinder that pulls", move |p| driven_by_cylinder(p, Lever::Linkage(pulls))),
    ]);
}

#[test]
fn kinds_of_machine() {
    let rigid = |p: &mut Parameters| {
        (p.gearbox.stiffness_nm_rad, p.gearbox.backlash_rad) = (f64::INFINITY, 0.0);
    };
    all_equal(&[
        machine("rigid gear, rotor coupled", |p| {
            rigid(p);
            p.motor.platform_coupling = 1.0;
        }),
        machine("rigid gear and one inertia, torque command, position at the hub", |p| {
            rigid(p);
            p.lumped.as_mut().unwrap().stiffness_nm_rad = f64::INFINITY;
            (p.amplifier.dynamics, p.amplifier.gain) = (AmplifierDynamics::TorqueCommand, 3.0);
            p.sensors.measured = FeedbackSignal::HubPosition;
        }),
        machine("current loop, tachometer on the motor", |p| {
            p.amplifier.dynamics = AmplifierDynamics::CurrentLoop { bandwidth_rad_s: 900.0, delay_s: 0.0 };
            p.amplifier.gain = 3.0;
            p.sensors.measured = FeedbackSignal::MotorRate;
        }),
        machine("armature without inductance", |p| p.motor.inductance_h = 0.0),
        machine("amplifier without lag, bus limit", |p| {
            (p.amplifier.time_constant_s, p.amplifier.current_feedback_v_a) = (0.0, 0.0);
            (p.amplifier.gain, p.amplifier.bus_voltage_v) = (2.0, 12.0);
        }),
        machine("neither lag nor inductance", |p| {
            (p.amplifier.time_constant_s, p.motor.inductance_h) = (0.0, 0.0);
            p.amplifier.bus_voltage_v = f64::INFINITY;
        }),
        machine("harmonic drive, encoder on the motor", |p| {
            p.gearbox.backlash_rad = 0.0;
            p.gearbox.kinematic_error = Ripple { amplitude: 5e-5, order: 2.0, phase_rad: 0.2 };
            (p.gearbox.hysteresis_nm, p.gearbox.hysteresis_stiffness_nm_rad) = (60.0, 4e5);
            p.sensors.measured = FeedbackSignal::MotorPosition;
        }),
        machine("linear axis", |p| p.axis = AxisKind::Linear),
        machine("torque sensor in a gearbox with a gap", |p| p.sensors.measured = FeedbackSignal::Torque),
        machine("torque sensor behind a harmonic drive", |p| {
            p.gearbox.backlash_rad = 0.0;
            p.gearbox.kinematic_error = Ripple { amplitude: 5e-5, order: 2.0, phase_rad: 0.2 };
            (p.gearbox.hysteresis_nm, p.gearbox.hysteresis_stiffness_nm_rad) = (60.0, 4e5);
            p.sensors.measured = FeedbackSignal::Torque;
        }),
        machine("current sensor", |p| p.sensors.measured = FeedbackSignal::Current),
    ]);
}

#[test]
fn structure_and_sensors() {
    let faulty = |sensor: &mut Sensor| {
        (sensor.gain, sensor.bias, sensor.delay_s, sensor.g_sensitivity) = (1.05, 0.01, 2e-3, 2e-3);
    };
    all_equal(&[
        machine("position spring, vertical offset", |p| {
            let lumped = p.lumped.as_mut().unwrap();
            (lumped.position_stiffness_nm_rad, lumped.position_stiffness_centre_rad) = (900.0, -0.04);
            lumped.vertical_offset_kg_m = 20.0;
        }),
        machine("sensors with faults", |p| {
            faulty(&mut p.sensors.hub_gyro);
            faulty(&mut p.sensors.platform_gyro);
            p.sensors.accelerometer_lever_arm_m = 0.4;
            faulty(p.sensors.motor_tachometer.as_mut().unwrap());
        }),
        machine("a delay of a part of a sample", |p| p.sensors.platform_gyro.delay_s = 1.4e-3),
        machine("ideal sensors", |p| {
            for sensor in
                [&mut p.sensors.hub_gyro, &mut p.sensors.platform_gyro, &mut p.sensors.platform_accelerometer]
            {
                sensor.natural_frequency_rad_s = f64::INFINITY;
            }
        }),
        machine("sensors of 20 000 rad/s", |p| p.sensors.hub_gyro.natural_frequency_rad_s = 2e4),
        twelve_modes(),
    ]);
}

/// The rig's structure with more modes than the lumped one has.
fn twelve_modes() -> Machine {
    let lumped = Plant::from_lumped(&reference::rig()).unwrap();
    let first = lumped.body().modes[0];
    let mode = |k: u32| {
        let n = f64::from(k);
        BodyMode {
            frequency_rad_s: first.frequency_rad_s * n * n,
            hub_shape: first.hub_shape / n,
            tip_shape: first.tip_shape * (-1.0_f64).powi(k as i32 + 1),
            load_share_kg_m: first.load_share_kg_m / n,
            ..first
        }
    };
    let body = Body { modes: (1..=12).map(mode).collect(), ..lumped.body().clone() };
    let plant = Plant::with_body(&reference::rig(), body).unwrap();
    Machine { name: "twelve modes".into(), plant, control_v: 0.8 }
}

#[test]
fn what_the_unit_s_memory_cannot_hold_is_refused_with_its_limit() {
    let mut parameters = reference::rig();
    parameters.interface.output_delay_samples = 20_000;
    let plant = Plant::from_lumped(&parameters).unwrap();
    let refused = plant_unit(PlantUnit { plant: &plant, name: "rig" }, &provenance());
    let expected =
        PlantUnitError::Memory { what: "delay in samples", value: 20_002.0, most: MOST_DELAY_SAMPLES };
    assert_eq!(refused, Err(expected));
}

#[test]
fn what_loads_a_machine() {
    let pins = |force| Equilibrator {
        arm_m: 0.4,
        arm_angle_rad: -0.2,
        anchor_m: 0.9,
        anchor_angle_rad: 1.3,
        factor: 1.05,
        force,
    };
    let gas = |acts| {
        Force::Gas(Gas {
            acts,
            pressure_pa: 6e6,
            area_m2: 1.2e-3,
            volume_m3: 4e-3,
            length_m: 0.9,
            exponent: 1.25,
            charge_temperature_k: 293.0,
            temperature_k: 263.0,
        })
    };
    all_equal(&[
        machine("spring equilibrator", |p| {
            p.loads.equilibrator = Some(pins(Force::Spring { stiffness_n_m: 8e3, free_length_m: 0.5 }));
        }),
        machine("gas equilibrator that pulls", |p| p.loads.equilibrator = Some(pins(gas(Action::Pull)))),
        machine("gas equilibrator that pushes", |p| {
            let below = Equilibrator { anchor_angle_rad: -1.3, ..pins(gas(Action::Push)) };
            p.loads.equilibrator = Some(below);
        }),
        machine("end stops", |p| {
            p.loads.end_stops = Some(EndStops {
                lower_rad: -6e-3,
                upper_rad: 4e-3,
                stiffness_nm_rad: 2e5,
                dissipation_s_rad: 3.0,
            });
        }),
        machine("recoil", |p| {
            p.loads.recoil = Some(Recoil {
                shots_s: vec![0.1503, 0.7],
                impulse_ns: 900.0,
                shot_time_s: 0.006,
                mass_kg: 60.0,
                length_m: 0.3,
                run_out_s: 0.25,
                height_m: 0.02,
                bore_offset_m: -0.01,
                ahead_m: 0.8,
            });
        }),
    ]);
}

#[test]
fn what_a_drive_can_do_for_long() {
    all_equal(&[
        machine("slew of the control", |p| p.drive_limits.slew_v_s = 12.0),
        machine("power of the supply", |p| {
            p.drive_limits.supply_power_w = 40.0;
        }),
        machine("speed of the motor", |p| p.drive_limits.motor_rate_rad_s = 2.5),
        machine("current for ever", |p| {
            p.amplifier.current_limit_a = 20.0;
            (p.drive_limits.continuous_current_a, p.drive_limits.overload_time_s) = (6.0, 0.3);
        }),
        machine("heat of the winding", |p| {
            p.amplifier.current_limit_a = 25.0;
            p.drive_limits.heat = Some(MotorHeat {
                winding_k_w: 0.8,
                housing_k_w: 1.5,
                winding_time_s: 2.0,
                housing_time_s: 60.0,
                ambient_k: 293.0,
                start_k: 300.0,
                limit_k: 315.0,
            });
        }),
    ]);
}
