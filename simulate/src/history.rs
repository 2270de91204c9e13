//! What a run leaves: one value a sample in every column.

use crate::engine::state::{Effort, PlantState};
use counterpoise_recordings::{Channel, Recording};

/// The columns of a run. Those of [`Truth`](TrueColumns) are empty if only the recording was kept.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeHistory {
    /// Sample period, s; sample k is at k periods.
    pub sample_period_s: f64,
    /// What the controller read and gave.
    pub readings: ReadingColumns,
    /// What was true.
    pub truth: TrueColumns,
    /// The state at the end of the run.
    pub final_state: PlantState,
    /// How much work it was.
    pub effort: Effort,
}

/// What the controller read and gave at each sample.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadingColumns {
    /// Demanded hub rate, rad/s.
    pub demand_rad_s: Vec<f64>,
    /// Control before the output converter, V, injection included.
    pub control_request_v: Vec<f64>,
    /// Control after the output converter, V.
    pub control_v: Vec<f64>,
    /// Hub gyroscope, rad/s.
    pub hub_rate_rad_s: Vec<f64>,
    /// Platform gyroscope, rad/s.
    pub platform_rate_rad_s: Vec<f64>,
    /// Platform accelerometer, m/s^2.
    pub platform_accel_m_s2: Vec<f64>,
    /// Motor tachometer, rad/s; zeros if none is fitted.
    pub motor_rate_rad_s: Vec<f64>,
    /// Hub resolver, rad; zeros if none is fitted.
    pub hub_position_rad: Vec<f64>,
    /// Second platform accelerometer (surge), m/s^2; empty if none is fitted.
    pub platform_surge_m_s2: Vec<f64>,
}

/// What was true at each sample.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TrueColumns {
    /// Hub rate, rad/s, inertial.
    pub hub_rate_rad_s: Vec<f64>,
    /// Tip rate, rad/s, inertial.
    pub tip_rate_rad_s: Vec<f64>,
    /// Motor rate, rad/s, relative to the platform.
    pub motor_rate_rad_s: Vec<f64>,
    /// Hub angle, rad, inertial.
    pub hub_angle_rad: Vec<f64>,
    /// Platform angle, rad, inertial.
    pub platform_angle_rad: Vec<f64>,
    /// Platform pitch rate, rad/s.
    pub platform_rate_rad_s: Vec<f64>,
    /// Heave, m/s^2.
    pub heave_m_s2: Vec<f64>,
    /// Armature current, A.
    pub current_a: Vec<f64>,
    /// Amplifier voltage, V.
    pub voltage_v: Vec<f64>,
    /// Gear wind-up, rad.
    pub wind_up_rad: Vec<f64>,
    /// Gear torque T_2 at the output, N m; the motor's, times the ratio, if the transmission is rigid.
    pub mesh_torque_nm: Vec<f64>,
    /// Contact of the teeth: 1 or -1 by the flank, 0 inside the gap.
    pub contact: Vec<i8>,
    /// Dry friction torque at the motor shaft, N m, opposing positive rates.
    pub motor_friction_nm: Vec<f64>,
    /// Dry friction torque at the pivot, N m, opposing positive rates.
    pub pivot_friction_nm: Vec<f64>,
    /// Temperature of the winding, K; empty without limits of the drive, 0 if the motor has no heat.
    pub winding_k: Vec<f64>,
    /// Average of the squared current, A^2; empty without limits of the drive.
    pub overload_a2: Vec<f64>,
    /// Lowest and highest current that the drive gives over the sample, A; empty without limits of the drive.
    pub current_range_a: Vec<[f64; 2]>,
}

/// Samples for which room is made at once.
const ROOM: usize = 1 << 20;

impl ReadingColumns {
    /// Empty columns with room for a run.
    pub(crate) fn with_capacity(samples: usize) -> Self {
        let column = || Vec::with_capacity(samples.min(ROOM));
        Self {
            demand_rad_s: column(),
            control_request_v: column(),
            control_v: column(),
            hub_rate_rad_s: column(),
            platform_rate_rad_s: column(),
            platform_accel_m_s2: column(),
            motor_rate_rad_s: column(),
            hub_position_rad: column(),
            platform_surge_m_s2: Vec::new(),
        }
    }

    /// Returns the column of a channel; it is empty for the motor's angle and current and for the platform's roll and yaw, which no simulated
    /// instrument reads.
    pub fn channel(&self, channel: Channel) -> &[f64] {
        match channel {
            Channel::Demand => &self.demand_rad_s,
            Channel::Control => &self.control_v,
            Channel::HubRate => &self.hub_rate_rad_s,
            Channel::PlatformRate => &self.platform_rate_rad_s,
            Channel::PlatformAccel => &self.platform_accel_m_s2,
            Channel::MotorRate => &self.motor_rate_rad_s,
            Channel::HubPosition => &self.hub_position_rad,
            Channel::PlatformSurge => &self.platform_surge_m_s2,
            Channel::MotorPosition | Channel::MotorCurrent | Channel::PlatformRoll | Channel::PlatformYaw => {
                &[]
            }
        }
    }

    /// Returns the column of a channel, to be changed; it is empty where [`Self::channel`] is.
    pub(crate) fn channel_mut(&mut self, channel: Channel) -> &mut [f64] {
        match channel {
            Channel::Demand => &mut self.demand_rad_s,
            Channel::Control => &mut self.control_v,
            Channel::HubRate => &mut self.hub_rate_rad_s,
            Channel::PlatformRate => &mut self.platform_rate_rad_s,
            Channel::PlatformAccel => &mut self.platform_accel_m_s2,
            Channel::MotorRate => &mut self.motor_rate_rad_s,
            Channel::HubPosition => &mut self.hub_position_rad,
            Channel::PlatformSurge => &mut self.platform_surge_m_s2,
            Channel::MotorPosition | Channel::MotorCurrent | Channel::PlatformRoll | Channel::PlatformYaw => {
                &mut []
            }
        }
    }

    /// Returns the recording that a machine like the simulated one would have left of the run.
    pub fn recording(&self, name: &str, sample_period_s: f64) -> Recording {
        let is_fitted = |c: &Channel| *c != Channel::PlatformSurge || !self.channel(*c).is_empty();
        let recorded = Channel::ALL.into_iter().filter(|c| !UNREAD.contains(c) && is_fitted(c));
        recorded.fold(Recording::new(name, sample_period_s), |recording, channel| {
            recording.with(channel, self.channel(channel).to_vec())
        })
    }
}

/// Channels that no simulated instrument reads.
const UNREAD: [Channel; 4] =
    [Channel::MotorPosition, Channel::MotorCurrent, Channel::PlatformRoll, Channel::PlatformYaw];

impl TimeHistory {
    /// Returns the number of samples.
    pub fn len(&self) -> usize {
        self.readings.control_v.len()
    }

    /// Returns whether the run had no sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the instants of the samples, s.
    pub fn time_s(&self) -> Vec<f64> {
        (0..self.len()).map(|k| k as f64 * self.sample_period_s).collect()
    }
}
