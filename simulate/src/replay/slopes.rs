//! A replay with the derivatives of its readings along directions of mechanism and start.

use super::start;
use super::{Replay, ReplayLoop, Replayer, START_FREEDOMS};
use crate::history::column_of;
use crate::sensitivity::{
    DifferentiableController, Direction, FixedControl, Member, OutputSlopes, SensitiveRun,
    SensitivityRefusal, Side,
};
use crate::tolerance::FAMILY_STEP;
use crate::{Error, PlantState};
use counterpoise_models::Parameters;
use counterpoise_recordings::Channel;

/// A mechanism, and by how many of their step sizes the freedoms of its start are moved.
#[derive(Debug, Clone)]
pub struct ReplayMember {
    /// The mechanism.
    pub parameters: Parameters,
    /// The moves, as [`Replayer::replay_nudged`] has them.
    pub steps: [f64; START_FREEDOMS],
}

/// A direction along which a replay is differentiated.
pub struct ReplayDirection<'a> {
    /// Returns mechanism and start at a distance from those that are replayed, in units of the direction.
    pub member: &'a (dyn Fn(f64) -> ReplayMember + Sync),
    /// The side on which there are mechanisms.
    pub side: Side,
}

/// A replay with the derivatives of its readings.
#[derive(Debug, Clone)]
pub struct SlopedReplay {
    /// The replay itself.
    pub replay: Replay,
    slopes: OutputSlopes,
}

impl SlopedReplay {
    /// Returns the derivatives of a channel along a direction; empty for channels that no direction changes.
    pub fn slope(&self, direction: usize, channel: Channel) -> &[f64] {
        column_of(channel).map_or(&[], |column| self.slopes.reading(direction, column))
    }
}

impl Replayer<'_> {
    /// Replays the recording once, as [`Self::replay_nudged`] does, with the derivatives of its readings along directions; `near` is the start
    /// of a similar mechanism.
    ///
    /// # Errors
    /// [`SensitivityRefusal`]: the replay fails, or it has no derivatives, with the reason.
    pub fn replay_with_slopes(
        &self,
        control: &ReplayLoop,
        near: &PlantState,
        nominal: &ReplayMember,
        directions: &[ReplayDirection],
    ) -> Result<SlopedReplay, SensitivityRefusal> {
        let at = self.member(nominal, near)?;
        let start = at.start.unwrap_or_else(|| near.clone());
        let members: Vec<_> = directions
            .iter()
            .map(|direction| move |by: f64| self.member(&(direction.member)(by), near))
            .collect();
        let families: Vec<Direction> = members
            .iter()
            .zip(directions)
            .map(|(member, direction)| Direction { member, step: FAMILY_STEP, side: direction.side })
            .collect();
        let scenario = self.scenario(self.samples, &start);
        let mut simulator = self.simulator(&at.plant)?;
        let mut run = |controller: &mut dyn DifferentiableController| {
            simulator.run_with_slopes(controller, &scenario, &families)
        };
        let SensitiveRun { history, slopes } = match control {
            ReplayLoop::Open => run(&mut FixedControl(&mut self.playback()?))?,
            ReplayLoop::Closed(controller) => {
                run(controller.differentiable_at_start_of(self.recording, &self.fitted)?.as_mut())?
            }
        };
        Ok(SlopedReplay { replay: self.compare_channels(&at.plant, control, history, start), slopes })
    }

    /// Returns the plant of a member and its start.
    fn member(&self, member: &ReplayMember, near: &PlantState) -> Result<Member, Error> {
        let plant = self.plant(&member.parameters)?;
        let start = if member.steps.iter().any(|step| *step != 0.0) {
            start::nudge_start(&mut self.simulator(&plant)?, self, near, &member.steps)
        } else {
            near.clone()
        };
        Ok(Member { plant, start: Some(start) })
    }
}
