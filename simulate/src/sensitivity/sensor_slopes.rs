//! The derivatives of the loop's sensor along a step.

use super::block::Block;
use super::direction::Family;
use super::machine_slopes::Machine;
use super::refusal::SensitivityRefusal;
use super::stencil::MEMBERS;
use crate::engine::filter::Filter;
use crate::engine::ports::SensorPoint;
use crate::engine::stepper::TakenStep;
use crate::engine::tables::{OUTPUTS, STAGES};
use counterpoise_models::{FeedbackSignal, Plant};

const NODE_COUNT: usize = STAGES + 1;

/// The loop's sensor: its rows over a step, and the directions along which they or what it feels differ.
#[derive(Debug, Clone)]
pub(crate) struct LoopSensor {
    own: Filter,
    /// What it feels of the outputs.
    felt: [f64; OUTPUTS],
    /// The sensors of the members of a direction whose dynamics differ.
    dynamics: Vec<(usize, [Filter; MEMBERS])>,
    /// The directions in which it feels the same motion in another way.
    readings: Vec<usize>,
}

impl LoopSensor {
    /// Returns the sensor of a plant.
    pub fn new(plant: &Plant, families: &[Family], period_s: f64) -> Result<Self, SensitivityRefusal> {
        let filter = |plant: &Plant| Filter::new(&plant.parameters().sensors.hub_gyro, period_s);
        let ratio = plant.parameters().gearbox.ratio;
        let felt = match plant.parameters().sensors.measured {
            FeedbackSignal::HubRate | FeedbackSignal::RelativeRate => [0.0, 0.0, 0.0, 1.0, 0.0],
            FeedbackSignal::MotorRate => [1.0 / ratio, 0.0, 0.0, 0.0, 0.0],
            FeedbackSignal::HubPosition => [0.0, 0.0, 1.0, 0.0, 0.0],
            FeedbackSignal::MotorPosition => [0.0, 1.0, 1.0, 0.0, 0.0],
            FeedbackSignal::Current => [0.0, 0.0, 0.0, 0.0, 1.0],
            FeedbackSignal::Torque => {
                return Err(SensitivityRefusal::Part { part: "a sensor of torque in the loop" });
            }
        };
        let key = |plant: &Plant| {
            let gyro = &plant.parameters().sensors.hub_gyro;
            [gyro.natural_frequency_rad_s, gyro.damping_ratio]
        };
        let differs = |k: &usize| families[*k].plants.iter().any(|member| key(member) != key(plant));
        let turns = |plant: &Plant| [plant.parameters().gearbox.ratio, plant.motor_share()];
        let turned = |k: &usize| families[*k].plants.iter().any(|member| turns(member) != turns(plant));
        let dynamics = (0..families.len()).filter(differs);
        Ok(Self {
            own: filter(plant),
            felt,
            dynamics: dynamics.map(|k| (k, families[k].plants.each_ref().map(filter))).collect(),
            readings: (0..families.len()).filter(turned).collect(),
        })
    }

    /// Returns what it feels of the outputs.
    pub fn felt_outputs(&self) -> &[f64; OUTPUTS] {
        &self.felt
    }

    /// Moves the derivatives of what it shows over a step; `felt` are those of what it feels of the outputs at the nodes.
    #[inline(always)]
    pub fn advance(&self, machine: &Machine, step: &TakenStep, felt: &mut Block, gyro: &mut Block) {
        for node in 0..NODE_COUNT {
            self.add_readings(machine, step, node, felt.row_mut(node));
        }
        let Some(rows) = self.own.rows(step.level) else {
            gyro.row_mut(0).copy_from_slice(felt.row(NODE_COUNT - 1));
            gyro.row_mut(1).fill(0.0);
            return;
        };
        let [first, second] = &rows;
        gyro.transform_pair([first[0], first[1]], [second[0], second[1]]);
        felt.combine(&first[2..], gyro.row_mut(0));
        felt.combine(&second[2..], gyro.row_mut(1));
        self.add_dynamics(machine, step, &rows, gyro);
    }

    /// Adds what a direction changes of the reading of the same motion.
    fn add_readings(&self, machine: &Machine, step: &TakenStep, node: usize, felt: &mut [f64]) {
        if self.readings.is_empty() {
            return;
        }
        let outputs = &step.attempt.outputs()[node];
        let at = SensorPoint { outputs, platform: &step.nodes[node], gear_hysteresis_nm: 0.0 };
        let own = step.present.ports.sensor_reading(&machine.plant, &at);
        for &k in &self.readings {
            let family = &machine.families[k];
            let of = std::array::from_fn(|m| family.ports[m].sensor_reading(&family.plants[m], &at));
            felt[k] += family.stencil.derivative(own, of);
        }
    }

    /// Adds what a direction changes of the sensor's own motion.
    fn add_dynamics(&self, machine: &Machine, step: &TakenStep, own: &[[f64; 6]; 2], gyro: &mut Block) {
        if self.dynamics.is_empty() {
            return;
        }
        let felt = |node: usize| {
            let outputs = &step.attempt.outputs()[node];
            let at = SensorPoint { outputs, platform: &step.nodes[node], gear_hysteresis_nm: 0.0 };
            step.present.ports.sensor_reading(&machine.plant, &at)
        };
        let [shown, slope] = step.present.hub_gyro;
        let inputs = [shown, slope, felt(0), felt(1), felt(2), felt(3)];
        for (k, members) in &self.dynamics {
            let stencil = &machine.families[*k].stencil;
            for row in 0..2 {
                for (j, input) in inputs.iter().enumerate() {
                    let of = members
                        .each_ref()
                        .map(|m| m.rows(step.level).map_or(own[row][j], |rows| rows[row][j]));
                    gyro.row_mut(row)[*k] += input * stencil.derivative(own[row][j], of);
                }
            }
        }
    }
}
