//! A platform's recorded motion as a verification drives the platform with it.

use counterpoise_verify::Road;
use counterpoise_verify::signals::filter::{LowPass, from_rest, low_pass};

use super::timing::even;
use super::{RecordingError, Table, Unit};
use crate::resolve::platform::RoadSource;

/// Heave and pitch rate from a recording: the stretch that is asked for, low-passed, scaled, without their means (which
/// takes gravity away), and faded in and out.
///
/// # Errors
/// A column is missing or of another quantity, time cannot be told, samples are missing, the stretch is not in the
/// recording, or the low-pass frequency is not below half the sample rate.
pub fn road(source: &RoadSource, table: &Table) -> Result<Road, RecordingError> {
    let (time, _) = table.in_si("time")?;
    let heave = quantity(table, &source.heave, "heave", "m/s^2")?;
    let pitch = quantity(table, &source.pitch, "pitch rate", "rad/s")?;
    let (period, columns) = even(&table.name, &time, vec![heave, pitch])?;
    let shape = |column: &[f64], scale: f64| shaped(source, table, period, column, scale);
    Ok(Road {
        name: table.name.clone(),
        sample_period_s: period,
        heave_m_s2: shape(&columns[0], source.heave_scale)?,
        pitch_rate_rad_s: shape(&columns[1], source.pitch_scale)?,
    })
}

fn quantity(
    table: &Table,
    column: &str,
    channel: &'static str,
    wanted: &'static str,
) -> Result<Vec<f64>, RecordingError> {
    let (values, unit) = table.in_si(column)?;
    let written = table.column(column)?.unit.clone();
    if written.is_none() || Unit::parse(wanted).is_some_and(|u| u.is_like(&unit)) {
        return Ok(values);
    }
    let (file, column) = (table.name.clone(), column.to_owned());
    Err(RecordingError::WrongUnit { file, column, unit: written.unwrap_or_default(), channel, wanted })
}

fn shaped(
    source: &RoadSource,
    table: &Table,
    period: f64,
    column: &[f64],
    scale: f64,
) -> Result<Vec<f64>, RecordingError> {
    let refuse = |why: String| RecordingError::Road { file: table.name.clone(), why };
    if let Some(row) = column.iter().position(|v| !v.is_finite()) {
        return Err(refuse(format!("a sample is missing in row {}", row + 1)));
    }
    let filtered = match source.low_pass_hz {
        Some(half_amplitude_hz) => {
            low_pass(column, period, LowPass { half_amplitude_hz }).map_err(|e| refuse(e.to_string()))?
        }
        None => column.to_vec(),
    };
    let from = (source.start_s / period).round() as usize;
    let count = (source.duration_s / period).round() as usize + 1;
    let length = (column.len() - 1) as f64 * period;
    let stretch = filtered.get(from..from.saturating_add(count)).ok_or_else(|| {
        refuse(format!(
            "{} s from {} s are asked for, but it is {length:.2} s long",
            source.duration_s, source.start_s
        ))
    })?;
    let scaled: Vec<f64> = stretch.iter().map(|v| scale * v).collect();
    Ok(from_rest(&scaled, period, source.fade_s))
}
