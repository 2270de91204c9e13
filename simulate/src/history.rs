//! The history of a run: one value a sample in every column.

use counterpoise_models::Parameters;
use counterpoise_recordings::{Channel, ColumnName, Recording, Signals};

use crate::engine::state::{Effort, PlantState};

/// The columns of a run. Those of [`truth`](TrueColumns) have no samples if only the recording was kept.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeHistory {
    /// Sample period, s; sample k is at k periods.
    pub sample_period_s: f64,
    /// Readings and controls of the controller.
    pub readings: ReadingColumns,
    /// True motions and torques.
    pub truth: TrueColumns,
    /// The state at the end of the run.
    pub final_state: PlantState,
    /// Computing work.
    pub effort: Effort,
}

/// A column of [`ReadingColumns`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReadingColumn {
    /// Demanded hub rate, rad/s.
    Demand,
    /// Control before the output converter, V, injection included.
    ControlRequest,
    /// Control after the output converter, V.
    Control,
    /// Hub gyroscope, rad/s.
    HubRate,
    /// Platform gyroscope, rad/s.
    PlatformRate,
    /// Platform accelerometer, m/s^2.
    PlatformAccel,
    /// Motor tachometer, rad/s; zeros if none is fitted.
    MotorRate,
    /// Hub resolver, rad; zeros if none is fitted.
    HubPosition,
    /// Second platform accelerometer (surge), m/s^2; there is no such column if none is fitted.
    PlatformSurge,
}

/// A column of [`TrueColumns`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrueColumn {
    /// Hub rate, rad/s, inertial.
    HubRate,
    /// Tip rate, rad/s, inertial.
    TipRate,
    /// Motor rate, rad/s, relative to the platform.
    MotorRate,
    /// Hub angle, rad, inertial.
    HubAngle,
    /// Platform angle, rad, inertial.
    PlatformAngle,
    /// Platform pitch rate, rad/s.
    PlatformRate,
    /// Heave, m/s^2.
    Heave,
    /// Armature current, A.
    Current,
    /// Amplifier voltage, V.
    Voltage,
    /// Gear wind-up, rad.
    WindUp,
    /// Gear torque T_2 at the output, N m; the motor's, times the ratio, if the transmission is rigid.
    MeshTorque,
    /// Contact of the teeth: 1 or -1 by the flank, 0 inside the gap.
    Contact,
    /// Dry friction torque at the motor shaft, N m, opposing positive rates.
    MotorFriction,
    /// Dry friction torque at the pivot, N m, opposing positive rates.
    PivotFriction,
    /// Temperature of the winding, K, 0 if the motor has no heat; this column and those after it exist only with limits of the drive.
    Winding,
    /// Average of the squared current, A^2.
    Overload,
    /// Lowest current that the drive gives over the sample, A.
    LowestCurrent,
    /// Highest current that the drive gives over the sample, A.
    HighestCurrent,
}

impl ColumnName for ReadingColumn {
    fn index(self) -> usize {
        self as usize
    }
}

impl ColumnName for TrueColumn {
    fn index(self) -> usize {
        self as usize
    }
}

/// Readings and control at each sample: an array time x signal.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadingColumns {
    /// The array.
    pub signals: Signals<ReadingColumn>,
}

/// True motions and torques at each sample: an array time x signal.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TrueColumns {
    /// The array.
    pub signals: Signals<TrueColumn>,
}

/// Samples for which room is made at once.
const ROOM: usize = 1 << 20;

impl ReadingColumns {
    /// Returns the columns of a machine's run, without samples but with room for them. Only a machine with a second accelerometer has the
    /// last column.
    pub(crate) fn of_machine(parameters: &Parameters, samples: usize) -> Self {
        let last = if parameters.sensors.surge_accelerometer.is_some() {
            ReadingColumn::PlatformSurge
        } else {
            ReadingColumn::HubPosition
        };
        Self { signals: Signals::with_room(samples.min(ROOM), last as usize + 1) }
    }

    /// Returns the number of samples.
    pub fn len(&self) -> usize {
        self.signals.len()
    }

    /// Returns whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.signals.is_empty()
    }

    /// Returns the demanded hub rate, rad/s.
    pub fn demand_rad_s(&self) -> &[f64] {
        self.signals.column(ReadingColumn::Demand)
    }

    /// Returns the control before the output converter, V, injection included.
    pub fn control_request_v(&self) -> &[f64] {
        self.signals.column(ReadingColumn::ControlRequest)
    }

    /// Returns the control after the output converter, V.
    pub fn control_v(&self) -> &[f64] {
        self.signals.column(ReadingColumn::Control)
    }

    /// Returns the readings of the hub gyroscope, rad/s.
    pub fn hub_rate_rad_s(&self) -> &[f64] {
        self.signals.column(ReadingColumn::HubRate)
    }

    /// Returns the readings of the platform gyroscope, rad/s.
    pub fn platform_rate_rad_s(&self) -> &[f64] {
        self.signals.column(ReadingColumn::PlatformRate)
    }

    /// Returns the readings of the platform accelerometer, m/s^2.
    pub fn platform_accel_m_s2(&self) -> &[f64] {
        self.signals.column(ReadingColumn::PlatformAccel)
    }

    /// Returns the readings of the motor tachometer, rad/s; zeros if none is fitted.
    pub fn motor_rate_rad_s(&self) -> &[f64] {
        self.signals.column(ReadingColumn::MotorRate)
    }

    /// Returns the readings of the hub resolver, rad; zeros if none is fitted.
    pub fn hub_position_rad(&self) -> &[f64] {
        self.signals.column(ReadingColumn::HubPosition)
    }

    /// Returns the readings of the second platform accelerometer (surge), m/s^2; none if none is fitted.
    pub fn platform_surge_m_s2(&self) -> &[f64] {
        self.signals.column(ReadingColumn::PlatformSurge)
    }

    /// Returns the samples of a channel; there are none of the motor's angle and current and of the platform's roll and yaw, which no
    /// simulated instrument reads.
    pub fn channel(&self, channel: Channel) -> &[f64] {
        column_of(channel).map_or(&[], |column| self.signals.column(column))
    }

    /// Returns the samples of a channel, to be changed; an empty slice for a channel that no simulated instrument reads.
    pub(crate) fn channel_mut(&mut self, channel: Channel) -> &mut [f64] {
        column_of(channel).map_or(&mut [], |column| self.signals.column_mut(column))
    }

    /// Returns the recording that a machine like the simulated one would have left of the run.
    pub fn recording(&self, name: &str, sample_period_s: f64) -> Recording {
        let is_read = |channel: &Channel| column_of(*channel).is_some_and(|column| self.signals.has(column));
        let recorded = Channel::ALL.into_iter().filter(is_read);
        recorded.fold(Recording::new(name, sample_period_s), |recording, channel| {
            recording.with(channel, self.channel(channel).to_vec())
        })
    }
}

/// Returns the column of a channel; `None` if no simulated instrument reads it.
pub(crate) fn column_of(channel: Channel) -> Option<ReadingColumn> {
    Some(match channel {
        Channel::Demand => ReadingColumn::Demand,
        Channel::Control => ReadingColumn::Control,
        Channel::HubRate => ReadingColumn::HubRate,
        Channel::PlatformRate => ReadingColumn::PlatformRate,
        Channel::PlatformAccel => ReadingColumn::PlatformAccel,
        Channel::MotorRate => ReadingColumn::MotorRate,
        Channel::HubPosition => ReadingColumn::HubPosition,
        Channel::PlatformSurge => ReadingColumn::PlatformSurge,
        Channel::MotorPosition | Channel::MotorCurrent | Channel::PlatformRoll | Channel::PlatformYaw => {
            return None;
        }
    })
}

impl TrueColumns {
    /// Returns the columns up to one of them, without samples but with room for them.
    pub(crate) fn columns_to(last: TrueColumn, samples: usize) -> Self {
        Self { signals: Signals::with_room(samples.min(ROOM), last as usize + 1) }
    }

    /// Returns the number of samples.
    pub fn len(&self) -> usize {
        self.signals.len()
    }

    /// Returns whether there is no sample: only the recording was kept.
    pub fn is_empty(&self) -> bool {
        self.signals.is_empty()
    }

    /// Returns the hub rate, rad/s, inertial.
    pub fn hub_rate_rad_s(&self) -> &[f64] {
        self.signals.column(TrueColumn::HubRate)
    }

    /// Returns the tip rate, rad/s, inertial.
    pub fn tip_rate_rad_s(&self) -> &[f64] {
        self.signals.column(TrueColumn::TipRate)
    }

    /// Returns the motor rate, rad/s, relative to the platform.
    pub fn motor_rate_rad_s(&self) -> &[f64] {
        self.signals.column(TrueColumn::MotorRate)
    }

    /// Returns the hub angle, rad, inertial.
    pub fn hub_angle_rad(&self) -> &[f64] {
        self.signals.column(TrueColumn::HubAngle)
    }

    /// Returns the platform angle, rad, inertial.
    pub fn platform_angle_rad(&self) -> &[f64] {
        self.signals.column(TrueColumn::PlatformAngle)
    }

    /// Returns the platform pitch rate, rad/s.
    pub fn platform_rate_rad_s(&self) -> &[f64] {
        self.signals.column(TrueColumn::PlatformRate)
    }

    /// Returns the heave, m/s^2.
    pub fn heave_m_s2(&self) -> &[f64] {
        self.signals.column(TrueColumn::Heave)
    }

    /// Returns the armature current, A.
    pub fn current_a(&self) -> &[f64] {
        self.signals.column(TrueColumn::Current)
    }

    /// Returns the amplifier voltage, V.
    pub fn voltage_v(&self) -> &[f64] {
        self.signals.column(TrueColumn::Voltage)
    }

    /// Returns the gear wind-up, rad.
    pub fn wind_up_rad(&self) -> &[f64] {
        self.signals.column(TrueColumn::WindUp)
    }

    /// Returns the gear torque T_2 at the output, N m; the motor's, times the ratio, if the transmission is rigid.
    pub fn mesh_torque_nm(&self) -> &[f64] {
        self.signals.column(TrueColumn::MeshTorque)
    }

    /// Returns the contact of the teeth: 1 or -1 by the flank, 0 inside the gap.
    pub fn contact(&self) -> &[f64] {
        self.signals.column(TrueColumn::Contact)
    }

    /// Returns the dry friction torque at the motor shaft, N m, opposing positive rates.
    pub fn motor_friction_nm(&self) -> &[f64] {
        self.signals.column(TrueColumn::MotorFriction)
    }

    /// Returns the dry friction torque at the pivot, N m, opposing positive rates.
    pub fn pivot_friction_nm(&self) -> &[f64] {
        self.signals.column(TrueColumn::PivotFriction)
    }

    /// Returns the temperature of the winding, K; nothing without limits of the drive.
    pub fn winding_k(&self) -> &[f64] {
        self.signals.column(TrueColumn::Winding)
    }

    /// Returns the average of the squared current, A^2; nothing without limits of the drive.
    pub fn overload_a2(&self) -> &[f64] {
        self.signals.column(TrueColumn::Overload)
    }

    /// Returns the lowest current that the drive gives over the sample, A; nothing without limits of the drive.
    pub fn lowest_current_a(&self) -> &[f64] {
        self.signals.column(TrueColumn::LowestCurrent)
    }

    /// Returns the highest current that the drive gives over the sample, A; nothing without limits of the drive.
    pub fn highest_current_a(&self) -> &[f64] {
        self.signals.column(TrueColumn::HighestCurrent)
    }
}

impl TimeHistory {
    /// Returns the number of samples.
    pub fn len(&self) -> usize {
        self.readings.len()
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
