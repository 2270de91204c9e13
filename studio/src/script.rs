//! A script of commands: each command waits until the one before has had its consequences.

use crate::command::Command;
use crate::studio::Studio;

/// A script.
pub struct Script(std::vec::IntoIter<Command>);

impl Script {
    /// Returns a script of commands.
    pub fn new(commands: Vec<Command>) -> Self {
        Self(commands.into_iter())
    }

    /// Returns whether no command is left.
    pub fn is_done(&self) -> bool {
        self.0.len() == 0
    }

    /// Returns the next command if the studio is ready for it.
    pub fn next_command(&mut self, studio: &Studio) -> Option<Command> {
        if studio.file_queue.is_busy() {
            return None;
        }
        let drawn = studio.results.plant.as_ref().map(|of| of.revision);
        let now = studio.opened.as_ref().map(|o| o.session.revision());
        let has_failed = studio.results.design_failure.is_some();
        let is_designing = studio.results.designing || (drawn != now && !has_failed);
        let is_early = self.0.as_slice().first().is_some_and(needs_rest) && !studio.is_idle();
        if (is_designing || is_early) && now.is_some() { None } else { self.0.next() }
    }
}

/// Returns whether a command can only be carried out on what has been verified, diagnosed or drawn.
fn needs_rest(command: &Command) -> bool {
    matches!(
        command,
        Command::Sweep
            | Command::Export
            | Command::ExportTo { .. }
            | Command::Accept
            | Command::RunStudy { .. }
            | Command::RunShownStudy
            | Command::TakeProposal { .. }
            | Command::SavePlot { .. }
            | Command::WriteReport { .. }
            | Command::Keep { .. }
            | Command::KeepDesign { .. }
            | Command::RestoreDesign { .. }
    )
}
