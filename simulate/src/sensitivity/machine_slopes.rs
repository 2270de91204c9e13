//! The numbers of a machine that its step uses beside matrices and laws of friction, with their derivatives along each direction.

use super::block::pad_width;
use super::direction::Family;
use crate::engine::ports::PlatformPoint;
use crate::engine::tables::PORTS;
use counterpoise_models::friction::{FrictionModel, Law};
use counterpoise_models::{AxisKind, Plant};

/// The derivatives of single numbers along the directions.
#[derive(Debug, Clone)]
pub(crate) struct MachineSlopes {
    pub ratio: Vec<f64>,
    /// Share of the platform's rate that the motor's body has.
    pub coupling: Vec<f64>,
    /// Half the gap, rad, and the torque that belongs to it, N m.
    pub half_gap: Vec<f64>,
    pub gap_torque: Vec<f64>,
    /// Current per volt of drive and per platform rate.
    pub direct_current: [Vec<f64>; 2],
    pub bus_v: Vec<f64>,
    /// Bands of rates of the joints' friction at rest.
    pub bands: [Vec<f64>; 2],
}

impl MachineSlopes {
    pub fn new(plant: &Plant, families: &[Family]) -> Self {
        let slopes = |value: &dyn Fn(&Plant) -> f64| -> Vec<f64> {
            let mut slopes: Vec<f64> = families.iter().map(|family| family.slope_of(plant, value)).collect();
            slopes.resize(pad_width(families.len()), 0.0);
            slopes
        };
        let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
        let band =
            |friction: &counterpoise_models::Friction| match FrictionModel::new(friction).map(|m| *m.law()) {
                Ok(Law::Sliding(law)) if law.breakaway_ratio > 1.0 => law.rest_rate_rad_s,
                _ => 0.0,
            };
        Self {
            ratio: slopes(&|plant| plant.parameters().gearbox.ratio),
            coupling: slopes(&Plant::motor_share),
            half_gap: slopes(&|plant| 0.5 * plant.parameters().gearbox.backlash_rad),
            gap_torque: slopes(&|plant| {
                let gearbox = &plant.parameters().gearbox;
                if gearbox.backlash_rad == 0.0 {
                    0.0
                } else {
                    0.5 * gearbox.backlash_rad * gearbox.stiffness_nm_rad
                }
            }),
            direct_current: [
                slopes(&|plant| plant.direct_current_a(1.0, 0.0)),
                slopes(&|plant| plant.direct_current_a(0.0, 1.0)),
            ],
            bus_v: slopes(&|plant| finite(plant.parameters().amplifier.bus_voltage_v)),
            bands: [
                slopes(&|plant| band(&plant.parameters().motor_friction)),
                slopes(&|plant| band(&plant.parameters().pivot_friction)),
            ],
        }
    }
}

/// The machine and its families.
#[derive(Debug, Clone)]
pub(crate) struct Machine {
    pub plant: Plant,
    pub families: Vec<Family>,
    pub slopes: MachineSlopes,
}

/// A node of a step: what its smooth torques depend on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    /// Drive of the amplifier, V.
    pub drive_v: f64,
    pub current_a: f64,
    pub wind_up_rad: f64,
    pub hub_angle_rad: f64,
    pub motor_angle_rad: f64,
    pub motor_rate_rad_s: f64,
    pub pivot_angle_rad: f64,
    pub pivot_rate_rad_s: f64,
    pub platform: PlatformPoint,
}

impl Node {
    /// Returns the relative motions where a plant shows outputs under a drive, on a platform.
    #[inline(always)]
    pub fn new(plant: &Plant, outputs: &[f64; 5], drive_v: f64, platform: PlatformPoint) -> Self {
        let [motor, wind_up_rad, hub_angle_rad, hub_rate, current] = *outputs;
        let pivot_angle_rad = hub_angle_rad - platform.angle;
        Self {
            drive_v,
            current_a: current + plant.direct_current_a(drive_v, platform.rate),
            wind_up_rad,
            hub_angle_rad,
            motor_angle_rad: plant.parameters().gearbox.ratio * (wind_up_rad + pivot_angle_rad),
            motor_rate_rad_s: motor - plant.motor_share() * platform.rate,
            pivot_angle_rad,
            pivot_rate_rad_s: hub_rate - platform.rate,
            platform,
        }
    }

    /// Returns the joints' rates relative to the platform.
    #[inline(always)]
    pub fn rates(&self) -> [f64; 2] {
        [self.motor_rate_rad_s, self.pivot_rate_rad_s]
    }

    /// Returns the joints' angles relative to the platform.
    #[inline(always)]
    pub fn angles(&self) -> [f64; 2] {
        [self.motor_angle_rad, self.pivot_angle_rad]
    }

    /// Returns the torques at motor and hub and the load, without dry friction.
    #[inline(always)]
    fn smooth_parts(&self, plant: &Plant) -> [f64; PORTS] {
        let (sin, cos) = plant.tilt(self.hub_angle_rad);
        let gravity = plant.parameters().gravity_m_s2 + self.platform.heave;
        [
            plant.motor_torque_nm(self.current_a, self.motor_angle_rad, self.motor_rate_rad_s),
            gravity * plant.body().vertical_offset_kg_m * sin
                + plant.hub_torque_nm(self.pivot_angle_rad, self.motor_angle_rad, self.pivot_rate_rad_s),
            gravity * cos,
        ]
    }

    /// Returns the derivatives of the smooth parts along a direction, at this motion.
    pub fn slopes_along(&self, plant: &Plant, family: &Family) -> [f64; PORTS] {
        let own = self.smooth_parts(plant);
        let members = family.plants.each_ref().map(|member| self.smooth_parts(member));
        std::array::from_fn(|p| family.stencil.derivative(own[p], members.map(|member| member[p])))
    }

    /// Returns the slopes of the smooth parts over the motion.
    #[inline(always)]
    pub fn slopes(&self, plant: &Plant) -> PartSlopes {
        let (sin, cos) = plant.tilt(self.hub_angle_rad);
        let turns = f64::from(u8::from(plant.parameters().axis == AxisKind::Rotary));
        let gravity = turns * (plant.parameters().gravity_m_s2 + self.platform.heave);
        let hub = plant.hub_torque_slopes(self.motor_angle_rad, self.pivot_rate_rad_s);
        PartSlopes {
            motor: plant.motor_torque_slopes(self.current_a, self.motor_angle_rad, self.motor_rate_rad_s),
            hub: [hub[0] + gravity * plant.body().vertical_offset_kg_m * cos, hub[1], hub[2]],
            load: -gravity * sin,
        }
    }
}

/// The slopes of the smooth parts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PartSlopes {
    /// Of the motor's torque over current, motor angle and motor rate.
    pub motor: [f64; 3],
    /// Of the hub's torque over hub angle, motor angle and hub rate.
    pub hub: [f64; 3],
    /// Of the load over the hub angle.
    pub load: f64,
}
