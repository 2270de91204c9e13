//! An exported controller in a replay: how it passes noise on, and its state at the start of a recording, each computed once.

use std::sync::{Arc, OnceLock};

use counterpoise_controller::signal::{PLATFORM_RATE, PLATFORM_SURGE};
use counterpoise_controller::{Controller, READINGS, Runner};
use counterpoise_recordings::Recording;

use super::initial_controller_state::fit_initial_states;
use crate::tolerance::{NOISE_RESPONSE_SAMPLES, SMALL_IMPULSE};

/// A controller as it is exported, with what its replays ask for again and again.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportedController {
    controller: Controller,
    /// RMS of the control for white noise of RMS 1 on each reading, V per unit.
    noise_gains: [f64; READINGS],
    /// `true` for each reading on which the control depends.
    reads: [bool; READINGS],
}

impl ExportedController {
    /// Returns the controller with its response to each reading.
    pub fn new(controller: Controller) -> Self {
        let responses = impulse_responses(&controller);
        let gain = |response: &Vec<f64>| {
            let settled = response.last().copied().unwrap_or(0.0);
            response.iter().map(|g| (g - settled) * (g - settled)).sum::<f64>().sqrt()
        };
        let noise_gains = std::array::from_fn(|j| gain(&responses[j]));
        // a projection reads surge and an angle, to which the control at rest does not respond
        let projection = controller.parts().projection;
        let projected = |j: usize| {
            projection.is_some_and(|each| {
                let pitches = each.pitch_washout_s.is_some() && j == PLATFORM_RATE;
                j == PLATFORM_SURGE || each.angle_reading == Some(j) || pitches
            })
        };
        let reads = std::array::from_fn(|j| projected(j) || responses[j].iter().any(|g| *g != 0.0));
        Self { controller, noise_gains, reads }
    }

    /// Returns the controller.
    pub fn controller(&self) -> &Controller {
        &self.controller
    }

    /// Returns the RMS of the control for white noise of RMS 1 on a reading, V per unit.
    pub(super) fn noise_gain(&self, reading: usize) -> f64 {
        self.noise_gains[reading]
    }

    /// Returns whether the control depends on a reading.
    pub(super) fn reads(&self, reading: usize) -> bool {
        self.reads[reading]
    }
}

/// The state of an exported controller at the first sample of one recording, fitted when it is first asked for. Copies share it.
#[derive(Debug, Clone, Default)]
pub(crate) struct FittedStart(Arc<OnceLock<(Arc<ExportedController>, Runner)>>);

impl FittedStart {
    /// Returns the controller in the state that fits the recorded control best; as it starts if the recording does not show it.
    ///
    /// The state of the first controller that asks is kept. A replay has one controller; another one is fitted at each call.
    pub(super) fn of(&self, controller: &Arc<ExportedController>, recording: &Recording) -> Runner {
        let fit = || {
            let found = fit_initial_states(controller.controller(), recording);
            found.unwrap_or_else(|| controller.controller().runner())
        };
        let (kept, runner) = self.0.get_or_init(|| (Arc::clone(controller), fit()));
        if Arc::ptr_eq(kept, controller) || kept == controller { runner.clone() } else { fit() }
    }
}

/// Returns the responses of the control to a small impulse on each reading, V per unit, from the controller at rest. A small impulse
/// keeps friction observers in presliding and the limiter out of the way.
fn impulse_responses(controller: &Controller) -> [Vec<f64>; READINGS] {
    let run = |impulse: Option<usize>| -> Vec<f64> {
        let mut runner = controller.runner();
        let step = |k: usize| {
            let mut readings = [0.0; READINGS];
            if let (Some(j), 0) = (impulse, k) {
                readings[j] = SMALL_IMPULSE;
            }
            runner.step_array(&readings)
        };
        (0..NOISE_RESPONSE_SAMPLES).map(step).collect()
    };
    let rest = run(None);
    std::array::from_fn(|j| run(Some(j)).iter().zip(&rest).map(|(a, b)| (a - b) / SMALL_IMPULSE).collect())
}
