//! The initial state with which a mechanism explains most of a recording: the one that the diagnosis judges a mechanism by.

use counterpoise_models::Parameters;
use counterpoise_recordings::Recording;
use counterpoise_simulate::PlantState;
use counterpoise_simulate::replay::ReplayLoop;

use crate::fitting::output_error::{FitSelection, Problem};
use crate::recording::noise::with_recorded_noise;
use crate::simulator_access::objective::{PreparedRecordings, RecordingReplays};
use crate::simulator_access::{Assessment, ControlSource};
use crate::tolerance::SEARCH_ITERATIONS;
use counterpoise_pool::Serial;

/// Returns the initial state of a recording that leaves the smallest residual over all of it, sought from one nearby; `None` if the recording
/// cannot be replayed, or if the loop hunts so that a replay in closed loop does not repeat.
///
/// The first moments of a recording do not show everything: without a position channel, the angle shows only in what the weight does later.
pub fn fit_start(
    mechanism: &Parameters,
    control: &ReplayLoop,
    recording: &Recording,
    near: &PlantState,
) -> Option<PlantState> {
    let recordings = std::slice::from_ref(recording);
    let base = &with_recorded_noise(mechanism, recordings);
    let prepared = PreparedRecordings::new(recordings, base);
    let simulator = RecordingReplays::new(base, control, &prepared).ok()?;
    let source =
        if *control == ReplayLoop::Open { ControlSource::Playback } else { ControlSource::ClosedLoop };
    let known =
        Assessment { channels: Vec::new(), divergence: Vec::new(), start: Some(near.clone()), source };
    let selection = FitSelection { iterations: SEARCH_ITERATIONS, restarts: 0, ..FitSelection::all(1) };
    let problem = Problem {
        simulator: &simulator,
        pool: &Serial,
        selection: &selection,
        base,
        effects: Vec::new(),
        assessments: std::slice::from_ref(&known),
        preferences: &[],
    };
    let fit = problem.fit(&[])?;
    let found = fit.assessment(0).filter(|assessment| assessment.source == source)?;
    found.start.clone()
}
