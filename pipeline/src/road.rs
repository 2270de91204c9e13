//! The motion of the platform of a verification: prepared from a recording, or realised from numbers.

use counterpoise_recordings::clock::{stack_columns, to_uniform_clock};
use counterpoise_recordings::{Error, RecordingTable, Signals};
use counterpoise_verify::signals::filter::{LowPass, from_rest, low_pass};
use counterpoise_verify::signals::spectrum::{
    angle_tones, pitch_simulator, random_motion, sine_tones, spectrum_tones,
};
use counterpoise_verify::signals::{RoadDrive, iso_road};
use counterpoise_verify::{Road, RoadOrigin};

use counterpoise_project::resolve::platform::{GeneratedMotion, MotionKind, RoadSource};

/// Period of the samples of a drive over a road, s: a vehicle has little above 20 Hz.
const ROAD_PERIOD_S: f64 = 0.005;

/// Returns heave, pitch rate and, where its column is named, surge from a recording: the stretch that is asked for, low-passed, scaled, without their means (which
/// takes gravity away), and faded in and out.
///
/// # Errors
/// A column is missing or of another quantity, the clock cannot be read, samples are missing, the stretch is not in the
/// recording, or the low-pass frequency is not below half the sample rate.
pub fn road_from_table(source: &RoadSource, table: &RecordingTable) -> Result<Road, Error> {
    let (time, _) = table.convert_to_si("time")?;
    let heave = table.quantity(&source.heave, "heave", "m/s^2")?;
    let pitch = table.quantity(&source.pitch, "pitch rate", "rad/s")?;
    let mut columns = vec![heave, pitch];
    if !source.surge.is_empty() {
        columns.push(table.quantity(&source.surge, "surge", "m/s^2")?);
    }
    let clocked = to_uniform_clock(
        &table.name,
        time.view(),
        None,
        stack_columns(columns.iter().map(|values| values.view())),
    )?;
    let shape = |signal: usize, scale: f64| {
        shape_column(source, table, clocked.period_s, &clocked.signals.column(signal).to_vec(), scale)
    };
    let mut columns = vec![shape(0, source.heave_scale)?, shape(1, source.pitch_scale)?];
    if !source.surge.is_empty() {
        let surge = shape(2, source.surge_scale)?;
        let still = vec![0.0; surge.len()];
        columns.extend([surge, still.clone(), still]);
    }
    Ok(Road {
        origin: RoadOrigin::Recording(table.name.clone()),
        sample_period_s: clocked.period_s,
        signals: Signals::stack(columns.iter().map(Vec::as_slice)),
    })
}

/// Realises a motion from its numbers: where the base rolls or traverses, the axis feels gravity's share of it, `gravity_m_s2` in m/s^2.
///
/// # Errors
/// Those of the generators.
pub fn realise_motion(
    motion: &GeneratedMotion,
    gravity_m_s2: f64,
) -> Result<Road, counterpoise_verify::Error> {
    let how = motion.realisation;
    match &motion.kind {
        MotionKind::Spectrum { heave_psd, pitch_psd } => random_motion(heave_psd, pitch_psd, how),
        MotionKind::Simulator { offset_m, sines, pitch_psd } => {
            let mut angle = sine_tones(sines);
            angle.extend(angle_tones(&spectrum_tones(pitch_psd, how.seed, 0)?));
            pitch_simulator(&angle, *offset_m, how)
        }
        MotionKind::IsoRoad { class, speed_m_s, vehicle } => {
            let drive = RoadDrive {
                class: *class,
                speed_m_s: *speed_m_s,
                duration_s: how.duration_s,
                sample_period_s: ROAD_PERIOD_S,
                fade_s: how.fade_s,
                seed: how.seed,
            };
            iso_road(drive, *vehicle, gravity_m_s2)
        }
        MotionKind::Sea(sea) => sea.road(how, gravity_m_s2),
        MotionKind::SixAxes(motion) => motion.road(how, gravity_m_s2),
    }
}

fn shape_column(
    source: &RoadSource,
    table: &RecordingTable,
    period: f64,
    column: &[f64],
    scale: f64,
) -> Result<Vec<f64>, Error> {
    let wanted = Stretch {
        low_pass_hz: source.low_pass_hz,
        start_s: source.start_s,
        duration_s: source.duration_s,
        period_s: period,
    };
    let scaled: Vec<f64> = stretch(&wanted, table, column)?.iter().map(|v| scale * v).collect();
    Ok(from_rest(&scaled, period, source.fade_s))
}

/// The part of a column that is taken.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stretch {
    /// Frequency above which motion is removed, Hz; `None` leaves it.
    pub low_pass_hz: Option<f64>,
    /// Start in the recording, s.
    pub start_s: f64,
    /// Length, s.
    pub duration_s: f64,
    /// Period of the samples, s.
    pub period_s: f64,
}

/// Returns the low-passed part of a column.
pub(crate) fn stretch(wanted: &Stretch, table: &RecordingTable, column: &[f64]) -> Result<Vec<f64>, Error> {
    let (refuse, period) = (|why: String| Error::Road { file: table.name.clone(), why }, wanted.period_s);
    if let Some(row) = column.iter().position(|v| !v.is_finite()) {
        return Err(refuse(format!("a sample is missing in row {}", row + 1)));
    }
    let filtered = match wanted.low_pass_hz {
        Some(half_amplitude_hz) => {
            low_pass(column, period, LowPass { half_amplitude_hz }).map_err(|e| refuse(e.to_string()))?
        }
        None => column.to_vec(),
    };
    let from = (wanted.start_s / period).round() as usize;
    let count = (wanted.duration_s / period).round() as usize + 1;
    let length = (column.len() - 1) as f64 * period;
    let taken = filtered.get(from..from.saturating_add(count)).ok_or_else(|| {
        refuse(format!(
            "{} s from {} s are asked for, but it is {length:.2} s long",
            wanted.duration_s, wanted.start_s
        ))
    })?;
    Ok(taken.to_vec())
}
