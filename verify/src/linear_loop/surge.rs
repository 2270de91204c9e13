//! The addition of surge to a history of the linear loop.

use super::{ArrangedLoop, SampledPlant};
use crate::history::{Experiment, History, HistoryColumn};
use crate::{Arrangement, Error, HeaveAndPitch, Procedure, Source};

/// Adds the response to the road's surge to the history of a road; every other history is left as it is.
///
/// At an elevation theta the out-of-balance feels heave cos(theta) - surge sin(theta): the linear plant takes surge as a heave of -surge tan(theta). An
/// accelerometer on the elevated mass reads it so, too. One that stands upright reads heave alone, so that the loop meets surge with its feedback only.
/// The centre of mass is taken to lie on the axis of the beam.
///
/// # Errors
/// Those of the simulation.
pub fn add_surge(
    history: &mut History,
    plant: &SampledPlant,
    loops: &[ArrangedLoop],
    procedure: &Procedure,
) -> Result<(), Error> {
    let Experiment::Disturbance(Source::Road, arrangement) = history.experiment else { return Ok(()) };
    let tangent = plant.hub_angle_rad.tan();
    let Some(road) = procedure.road.as_ref().filter(|road| road.has_further_motion() && tangent != 0.0)
    else {
        return Ok(());
    };
    let acting = acting_arrangement(plant, arrangement);
    let Some(acting) = loops.iter().find(|one| one.arrangement == acting) else { return Ok(()) };
    let motion =
        |time_s: f64| HeaveAndPitch { heave_m_s2: -tangent * road.surge_at(time_s), pitch_rate_rad_s: 0.0 };
    let duration_s = procedure.duration_of(Source::Road);
    let surge =
        super::simulate_disturbance(plant, &acting.closed, Source::Road, arrangement, duration_s, motion)?;
    for column in
        [HistoryColumn::HubRate, HistoryColumn::TipRate, HistoryColumn::Current, HistoryColumn::Travel]
    {
        let added = surge.signals.column(column);
        history.signals.column_mut(column).iter_mut().zip(added).for_each(|(value, more)| *value += more);
    }
    let added = surge.control_v().iter().map(|v| v - plant.holding_v);
    let control_v = history.signals.column_mut(HistoryColumn::Control);
    control_v.iter_mut().zip(added).for_each(|(value, more)| *value += more);
    Ok(())
}

/// Returns the arrangement whose loop meets surge: an accelerometer that stands upright does not see it, so that the heave feedforward does nothing
/// against it.
pub fn acting_arrangement(plant: &SampledPlant, arrangement: Arrangement) -> Arrangement {
    match arrangement {
        Arrangement::Compensated if !plant.surge_is_measured => Arrangement::Feedback,
        other => other,
    }
}
