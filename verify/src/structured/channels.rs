//! The addition of each place's deviation to the plant.

use counterpoise_linalg::Mat;
use counterpoise_models::plant::core::{input, state};
use counterpoise_models::plant::{Core, Mesh, Plant};
use counterpoise_models::{FeedbackSignal, LumpedStructure};

use super::places::{LinearisedDryFriction, Place};
use crate::linear_loop::plant::Resolver;

/// A signal that a deviation adds, and what it is proportional to.
pub(super) struct Channel {
    pub(super) place: (Place, usize),
    /// The addition of a unit of the signal to x'.
    pub(super) column: Vec<f64>,
    /// z as a row over x.
    pub(super) row: Vec<f64>,
    /// z as a row over x': an inertia's acceleration.
    pub(super) derivative: Vec<f64>,
}

/// The plant that channels are added to.
pub(super) struct Base {
    pub(super) A: Mat,
    pub(super) control: Vec<f64>,
    /// Rows of the readings that are fed back.
    pub(super) readings: [Vec<f64>; 3],
}

/// The core with the gyroscope behind it and, where the controller reads it, the hub's angle.
pub(super) fn build_base(plant: &Plant, slope_per_drive: f64, resolver: Resolver, springs: [f64; 2]) -> Base {
    let core = plant.core(Mesh::Touching);
    let (n, gyro) = (plant.core_order(), &plant.parameters().sensors.hub_gyro);
    let (first, second, angle) = (n, n + 1, n + 2);
    let mut A = Mat::zeros(n + 3, n + 3);
    A.set_block(0, 0, &core.A);
    let hub = plant.hub_rate_row();
    if gyro.natural_frequency_rad_s.is_finite() {
        let (w, z) = (gyro.natural_frequency_rad_s, gyro.damping_ratio);
        A[(first, second)] = w;
        let felt = measured_row(plant, angle);
        (0..n + 3).filter(|j| felt[*j] != 0.0).for_each(|j| A[(second, j)] = w * felt[j]);
        (A[(second, first)], A[(second, second)]) = (-w, -2.0 * z * w);
    }
    let sensors = &plant.parameters().sensors;
    if resolver == Resolver::Read || springs != [0.0; 2] || sensors.measured.is_position() {
        (0..n).for_each(|j| A[(angle, j)] = hub[j]);
    }
    let torque = Torques::of(plant);
    let ratio = plant.parameters().gearbox.ratio;
    for i in 0..n {
        A[(i, angle)] -= springs[1] * torque.hub[i] + springs[0] * ratio * torque.motor[i];
        if plant.has_state(state::WINDUP) {
            A[(i, state::WINDUP)] -= springs[0] * ratio * torque.motor[i];
        }
    }
    let mut control: Vec<f64> =
        (0..n).map(|i| core.B[(i, input::DRIVE)] * slope_per_drive / drive_gain(plant, &core)).collect();
    control.resize(n + 3, 0.0);
    let readings = readings(plant, first, angle);
    Base { A, control, readings }
}

/// Returns what the drive's strongest state receives of it; 1 if the drive has no state, whose slope is then the control's own.
pub(super) fn drive_gain(plant: &Plant, core: &Core) -> f64 {
    if plant.drive_states().next().is_none() {
        return 1.0;
    }
    plant.drive_states().map(|index| core.B[(index, input::DRIVE)]).sum()
}

/// Returns what the loop's sensor feels, as a row over the states of [`build_base`]; `angle` is the place of the hub's angle on the platform.
fn measured_row(plant: &Plant, angle: usize) -> Vec<f64> {
    let n = plant.core_order();
    let wide = |mut row: Vec<f64>| {
        row.resize(n + 3, 0.0);
        row
    };
    match plant.parameters().sensors.measured {
        FeedbackSignal::HubRate | FeedbackSignal::RelativeRate => wide(plant.hub_rate_row()),
        FeedbackSignal::MotorRate => {
            let ratio = plant.parameters().gearbox.ratio;
            wide(plant.motor_rate_row().into_iter().map(|entry| entry / ratio).collect())
        }
        FeedbackSignal::HubPosition => one_at(n + 3, angle),
        FeedbackSignal::MotorPosition => {
            let mut row = one_at(n + 3, angle);
            row[state::WINDUP] = 1.0;
            row
        }
        FeedbackSignal::Torque => wide(plant.transmitted_torque_row()),
        FeedbackSignal::Current => wide(plant.current_row()[..n].to_vec()),
    }
}

fn readings(plant: &Plant, gyro_state: usize, angle: usize) -> [Vec<f64>; 3] {
    let (sensors, n) = (&plant.parameters().sensors, plant.core_order());
    let mut gyro = measured_row(plant, angle);
    if sensors.hub_gyro.natural_frequency_rad_s.is_finite() {
        gyro = one_at(n + 3, gyro_state);
    }
    gyro.iter_mut().for_each(|entry| *entry *= sensors.hub_gyro.gain);
    let mut tachometer = plant.motor_rate_row();
    tachometer.resize(n + 3, 0.0);
    let gain = sensors.motor_tachometer.as_ref().map_or(0.0, |sensor| sensor.gain);
    tachometer.iter_mut().for_each(|entry| *entry *= gain);
    let mut position = one_at(n + 3, angle);
    let gain = sensors.hub_resolver.as_ref().map_or(0.0, |sensor| sensor.gain);
    position.iter_mut().for_each(|entry| *entry *= gain);
    [gyro, tachometer, position]
}

fn one_at(n: usize, at: usize) -> Vec<f64> {
    let mut row = vec![0.0; n];
    row[at] = 1.0;
    row
}

/// Returns a row times a factor, with zeros up to a size.
fn scale_and_pad(row: &[f64], factor: f64, size: usize) -> Vec<f64> {
    let mut row: Vec<f64> = row.iter().map(|entry| entry * factor).collect();
    row.resize(size, 0.0);
    row
}

/// Returns the channels that the deviation of a place adds; they are empty if the plant has no such part.
pub(super) fn channels_of(
    place: Place,
    plant: &Plant,
    base: &Base,
    dry: &LinearisedDryFriction,
) -> Vec<Channel> {
    let LinearisedDryFriction { viscous: dry, springs } = *dry;
    let size = base.A.nrows();
    let wide = |row: Vec<f64>, factor: f64| scale_and_pad(&row, factor, size);
    let torque = Torques::of(plant);
    let (p, motor_rate) = (plant.parameters(), wide(plant.motor_rate_row(), 1.0));
    let (hub, tip) = (plant.hub_rate_row(), plant.tip_rate_row());
    let Some(lumped) = p.lumped.as_ref().filter(|lumped| has_part(plant, lumped, place)) else {
        return Vec::new();
    };
    let less = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(a, b)| a - b).collect::<Vec<f64>>();
    let between = less(&torque.hub, &torque.tip);
    let none = || vec![0.0; size];
    let force = |column: &[f64], row: Vec<f64>| vec![(wide(column.to_vec(), 1.0), row, none())];
    let inertial = |column: &[f64], row: Vec<f64>| vec![(wide(column.to_vec(), -1.0), none(), row)];
    let made = match place {
        Place::HubInertia => inertial(&torque.hub, wide(hub, lumped.hub_inertia_kg_m2)),
        Place::BeamInertia => inertial(&torque.tip, wide(tip, lumped.beam_inertia_kg_m2)),
        Place::MotorInertia => inertial(&torque.motor, wide(motor_rate, p.motor.inertia_kg_m2)),
        Place::StructureStiffness => {
            force(&between, wide(less(&tip_angle(plant), &plant.hub_angle_row()), lumped.stiffness_nm_rad))
        }
        Place::StructureDamping => force(&between, wide(less(&tip, &hub), lumped.damping_nm_s_rad)),
        Place::MotorViscous => {
            force(&torque.motor, wide(motor_rate, dry[0] - p.motor_friction.viscous_nm_s_rad))
        }
        Place::PivotViscous => force(&torque.hub, wide(hub, dry[1] - p.pivot_friction.viscous_nm_s_rad)),
        Place::MotorDry => force(&torque.motor, wide(motor_rate, -dry[0])),
        Place::PivotDry => force(&torque.hub, wide(hub, -dry[1])),
        Place::MotorPresliding => {
            let ratio = p.gearbox.ratio;
            let mut angle = one_at(size, plant.core_order() + 2);
            angle[state::WINDUP] += 1.0;
            force(&torque.motor, wide(angle, -springs[0] * ratio))
        }
        Place::PivotPresliding => force(&torque.hub, wide(one_at(size, plant.core_order() + 2), -springs[1])),
        Place::GearStiffness => {
            force(&torque.mesh, wide(one_at(size, state::WINDUP), p.gearbox.stiffness_nm_rad))
        }
        Place::TorqueConstant => force(
            &torque.motor,
            wide(plant.current_row()[..plant.core_order()].to_vec(), p.motor.torque_constant_nm_a),
        ),
        Place::Resistance => resistance(plant, size),
        Place::GyroBandwidth => gyroscope(base, plant.core_order()),
    };
    let acts = |(column, row, derivative): &(Vec<f64>, Vec<f64>, Vec<f64>)| {
        column.iter().any(|e| *e != 0.0) && row.iter().chain(derivative).any(|e| *e != 0.0)
    };
    let channel = |(k, (column, row, derivative))| Channel { place: (place, k), column, row, derivative };
    made.into_iter().filter(acts).enumerate().map(channel).collect()
}

/// Returns whether the plant has the part that a place belongs to.
fn has_part(plant: &Plant, lumped: &LumpedStructure, place: Place) -> bool {
    match place {
        // in a chain these parts act between its inertias, and not between hub and tip
        Place::BeamInertia | Place::StructureStiffness | Place::StructureDamping => {
            !lumped.is_rigid() && lumped.chain.is_empty()
        }
        Place::GearStiffness => !plant.is_rigid(),
        _ => true,
    }
}

/// Voltage on the armature; nothing with an ideal current source, whose current is what it is told.
fn resistance(plant: &Plant, size: usize) -> Vec<(Vec<f64>, Vec<f64>, Vec<f64>)> {
    let motor = &plant.parameters().motor;
    let modelled = counterpoise_models::parameters::AmplifierDynamics::Modelled;
    if plant.parameters().amplifier.dynamics != modelled || !plant.has_state(state::CURRENT) {
        return Vec::new();
    }
    let mut column = one_at(size, state::CURRENT);
    column.iter_mut().for_each(|entry| *entry /= motor.inductance_h);
    let mut row = one_at(size, state::CURRENT);
    row.iter_mut().for_each(|entry| *entry *= -motor.resistance_ohm);
    vec![(column, row, vec![0.0; size])]
}

/// x1' = f w x2 and x2' = f w (u - x1 - 2 z x2).
fn gyroscope(base: &Base, first: usize) -> Vec<(Vec<f64>, Vec<f64>, Vec<f64>)> {
    let size = base.A.nrows();
    [first, first + 1].map(|k| (one_at(size, k), base.A.row_vec(k), vec![0.0; size])).into()
}

/// The addition of a unit of torque to x'.
struct Torques {
    hub: Vec<f64>,
    tip: Vec<f64>,
    motor: Vec<f64>,
    mesh: Vec<f64>,
}

impl Torques {
    fn of(plant: &Plant) -> Self {
        let core = plant.core(Mesh::Touching);
        let column = |j: usize| core.B.column(j).to_vec();
        let mut tip = vec![0.0; plant.core_order()];
        tip[state::RATE] = 1.0 / plant.body().inertia_kg_m2;
        for (k, mode) in plant.body().modes.iter().enumerate() {
            tip[state::MODES + 2 * k + 1] = mode.tip_shape;
        }
        let [hub, motor, mesh] = [input::HUB_TORQUE, input::MOTOR_TORQUE, input::MESH_TORQUE].map(column);
        Self { hub, tip, motor, mesh }
    }
}

fn tip_angle(plant: &Plant) -> Vec<f64> {
    let mut row = vec![0.0; plant.core_order()];
    row[state::ANGLE] = 1.0;
    for (k, mode) in plant.body().modes.iter().enumerate() {
        row[state::MODES + 2 * k] = mode.tip_shape;
    }
    row
}
