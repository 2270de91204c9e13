//! The settings that the studio remembers of its windows, kept up to date on disk.

use super::Studio;
use crate::settings::{
    ProjectSettings, SettingsFile, project_settings_file, user_settings_file, write_settings,
};

impl Studio {
    /// Has the settings written if they differ from those that were written last.
    pub(super) fn save_changed_settings(&mut self) {
        if self.take_settings() == SettingsChange::Changed {
            self.jobs.settings.ask(0, self.settings_files());
        }
    }

    /// Writes the settings before the project is left; a request that has not begun is replaced.
    pub(super) fn save_settings_now(&mut self) {
        let change = self.take_settings();
        if change == SettingsChange::Changed || self.opened.is_some() {
            self.jobs.settings.cancel();
            write_settings(&self.settings_files());
        }
    }

    /// Takes over the settings that the view shows.
    fn take_settings(&mut self) -> SettingsChange {
        self.user_settings.update_from(&self.view);
        let project = self.opened.as_ref().map(|_| ProjectSettings::of_view(&self.view));
        let now = (self.user_settings.clone(), project);
        if now == self.stored_settings {
            return SettingsChange::Unchanged;
        }
        self.stored_settings = now;
        SettingsChange::Changed
    }

    fn settings_files(&self) -> Vec<SettingsFile> {
        let (user, project) = &self.stored_settings;
        let writable = self.opened.as_ref().filter(|opened| !opened.is_read_only());
        let path = writable.map(|opened| opened.path.as_path());
        let project = path
            .zip(project.as_ref())
            .and_then(|(path, settings)| project_settings_file(&self.state, path, settings));
        user_settings_file(&self.state, user).into_iter().chain(project).collect()
    }
}

/// The comparison of the settings with those that were written last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SettingsChange {
    Unchanged,
    Changed,
}
