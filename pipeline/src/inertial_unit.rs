//! The recording of an inertial measurement unit on the base, prepared to drive the platform of a verification.

use counterpoise_models::base_motion::{BaseState, FeltMotion, Level, Mounting, motion_at_elevation_axis};
use counterpoise_recordings::clock::{stack_columns, to_uniform_clock};
use counterpoise_recordings::{ColumnName, Error, RecordingTable, Signals};
use counterpoise_verify::signals::filter::from_rest;
use counterpoise_verify::signals::statistics::subtract_mean;
use counterpoise_verify::{Road, RoadOrigin};

use crate::road::{Stretch, stretch};
use counterpoise_project::resolve::base_motion::{InertialUnit, UnitReading};

/// The axes of the unit: x, y and z.
const AXES: [usize; 3] = [0, 1, 2];

/// A column of the readings of an inertial measurement unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum UnitColumn {
    /// Acceleration or specific force along an axis, m/s^2.
    Acceleration(usize),
    /// Rate about an axis, rad/s.
    Rate(usize),
}

impl ColumnName for UnitColumn {
    fn index(self) -> usize {
        match self {
            Self::Acceleration(axis) => axis,
            Self::Rate(axis) => AXES.len() + axis,
        }
    }
}

/// Returns what the elevation axis feels of the recorded motion: the stretch that is asked for, low-passed, at the pivot, in axes that do not turn about
/// the elevation axis, without its means, and faded in and out. The means of the rates are the gyroscopes' biases and are taken out first; where
/// the accelerations contain gravity, its direction is the mean of the specific force.
///
/// # Errors
/// A column is missing or of another quantity, the clock cannot be read, samples are missing, the stretch is not in the
/// recording, or the low-pass frequency is not below half the sample rate.
pub fn inertial_unit(source: &InertialUnit, table: &RecordingTable) -> Result<Road, Error> {
    let (time, _) = table.convert_to_si("time")?;
    let mut columns = Vec::with_capacity(6);
    for name in &source.acceleration {
        columns.push(table.quantity(name, "acceleration", "m/s^2")?);
    }
    for name in &source.rate {
        columns.push(table.quantity(name, "rate", "rad/s")?);
    }
    let clocked = to_uniform_clock(
        &table.name,
        time.view(),
        None,
        stack_columns(columns.iter().map(|values| values.view())),
    )?;
    let wanted = Stretch {
        low_pass_hz: source.low_pass_hz,
        start_s: source.start_s,
        duration_s: source.duration_s,
        period_s: clocked.period_s,
    };
    let taken: Vec<Vec<f64>> = clocked
        .signals
        .columns()
        .into_iter()
        .map(|signal| stretch(&wanted, table, &signal.to_vec()))
        .collect::<Result<_, Error>>()?;
    let mut signals = Signals::stack(taken.iter().map(Vec::as_slice));
    for column in AXES.map(UnitColumn::Rate) {
        let centred = subtract_mean(signals.column(column));
        signals.column_mut(column).copy_from_slice(&centred);
    }
    let unit: Vec<BaseState> = (0..signals.len())
        .map(|k| BaseState {
            specific_force_m_s2: AXES.map(|axis| signals.column(UnitColumn::Acceleration(axis))[k]),
            rate_rad_s: AXES.map(|axis| signals.column(UnitColumn::Rate(axis))[k]),
        })
        .collect();
    let mounting = Mounting::new(source.mounting_rad, source.lever_arm_m);
    let base = mounting.at_pivot(&unit, clocked.period_s);
    Ok(fade_in(source, table, clocked.period_s, &felt_by(source, &base, clocked.period_s)))
}

fn felt_by(source: &InertialUnit, base: &[BaseState], period_s: f64) -> Vec<FeltMotion> {
    let level = match source.reading {
        UnitReading::SpecificForce => Level::ByMean,
        UnitReading::Acceleration => Level::Known,
    };
    // gravity is a constant here: it goes with the mean
    let all = motion_at_elevation_axis(base, period_s, source.traverse, 0.0, level);
    if source.reading == UnitReading::SpecificForce {
        return all;
    }
    let unturned = |(k, (at, base)): (usize, (&FeltMotion, &BaseState))| {
        let turned = source.traverse.angle_rad + source.traverse.rate_rad_s * k as f64 * period_s;
        let [x, y, z] = base.specific_force_m_s2;
        FeltMotion { heave_m_s2: z, surge_m_s2: x * turned.cos() + y * turned.sin(), ..*at }
    };
    all.iter().zip(base).enumerate().map(unturned).collect()
}

fn fade_in(source: &InertialUnit, table: &RecordingTable, period_s: f64, felt: &[FeltMotion]) -> Road {
    let shaped = |of: fn(&FeltMotion) -> f64| {
        from_rest(&felt.iter().map(of).collect::<Vec<f64>>(), period_s, source.fade_s)
    };
    // in the order of `RoadColumn`
    let columns = [
        shaped(|at| at.heave_m_s2),
        shaped(|at| at.pitch_rate_rad_s),
        shaped(|at| at.surge_m_s2),
        shaped(|at| at.roll_rate_rad_s),
        shaped(|at| at.yaw_rate_rad_s),
    ];
    Road {
        origin: RoadOrigin::Recording(table.name.clone()),
        sample_period_s: period_s,
        signals: Signals::stack(columns.iter().map(Vec::as_slice)),
    }
}
