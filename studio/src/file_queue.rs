//! The queue of commands that concern files: one is carried out at a time.

use std::collections::VecDeque;
use std::path::Path;

use crate::command::Command;

/// A command that waits, with the text to be saved.
#[derive(Debug)]
pub struct QueuedCommand {
    /// The command.
    pub command: Command,
    /// The project's text at the time of the command.
    pub text: String,
}

/// The commands that concern files and are not done yet.
#[derive(Debug, Default)]
pub struct FileQueue {
    /// The command that the worker carries out.
    pub running: Option<Command>,
    waiting: VecDeque<QueuedCommand>,
}

/// Returns whether a command writes the project.
pub fn is_save(command: &Command) -> bool {
    matches!(command, Command::Save | Command::Overwrite | Command::SaveAs { .. })
}

impl FileQueue {
    /// Returns whether a command runs or waits.
    pub fn is_busy(&self) -> bool {
        self.running.is_some() || !self.waiting.is_empty()
    }

    /// Returns whether the project is being saved.
    pub fn is_saving(&self) -> bool {
        self.running.as_ref().is_some_and(is_save)
            || self.waiting.iter().any(|queued| is_save(&queued.command))
    }

    /// Returns the path that is being opened or made.
    pub fn path_being_opened(&self) -> Option<&Path> {
        match self.running.as_ref()? {
            Command::Open { path } => Some(path),
            Command::New { folder, .. } | Command::CopyExample { folder, .. } => Some(folder),
            Command::Reload => Some(Path::new("the project again")),
            _ => None,
        }
    }

    /// Queues a command: a save stands before what leaves the project, otherwise the order is kept.
    pub fn push(&mut self, command: Command, text: String) {
        let place = if is_save(&command) { self.waiting_saves() } else { self.waiting.len() };
        self.waiting.insert(place, QueuedCommand { command, text });
    }

    /// Queues a command before everything else that leaves the project.
    pub fn push_first(&mut self, command: Command) {
        let place = self.waiting_saves();
        self.waiting.insert(place, QueuedCommand { command, text: String::new() });
    }

    /// Returns the next command.
    pub fn pop(&mut self) -> Option<QueuedCommand> {
        self.waiting.pop_front()
    }

    /// Removes what would leave the project.
    pub fn keep_saves(&mut self) {
        self.waiting.retain(|queued| is_save(&queued.command));
    }

    fn waiting_saves(&self) -> usize {
        self.waiting.iter().take_while(|queued| is_save(&queued.command)).count()
    }
}
