//! The settings that the studio remembers: theme, units, zoom and size for each user; page, tabs and kept designs for each project.
//!
//! The user's settings are one file in the studio's own folder; those of a project stand beside its journal.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use counterpoise_host::journals::journal_path;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::command::{DesignSlot, DesignTab, DiagnosisTab, Page, VerificationTab};
use crate::theme::{DARK, LIGHT};
use crate::tile_layout::{LayoutNode, TilePlace};
use crate::units::DisplayUnits;
use crate::view::{ControllerPart, StudioView};

/// Smallest and largest zoom that is restored: beyond, the window could not be used to change it back.
const ZOOMS: (f32, f32) = (0.5, 3.0);
/// Smallest and largest side of a window that is restored, points.
const SIDES: (f32, f32) = (400.0, 10_000.0);

/// The theme by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ThemeChoice {
    /// Dark.
    #[default]
    Dark,
    /// Light.
    Light,
}

/// The settings of a user.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct UserSettings {
    /// The theme.
    pub theme: ThemeChoice,
    /// The units.
    pub units: DisplayUnits,
    /// The zoom; `None` for 1.
    pub zoom: Option<f32>,
    /// `true` if the hint on what can be dragged was closed.
    pub is_hint_closed: bool,
    /// The size of the window, points; `None` before the first window.
    pub window_size: Option<[f32; 2]>,
}

/// The settings of a project.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ProjectSettings {
    /// The page.
    pub page: Page,
    /// The tab of the page Design.
    pub design_tab: DesignTab,
    /// The tab of the page Verify.
    pub verification_tab: VerificationTab,
    /// The tab of the page Diagnose.
    pub diagnosis_tab: DiagnosisTab,
    /// The part of the controller whose weights are shown.
    pub part: ControllerPart,
    /// The section of parameters that is open.
    pub section: usize,
    /// The requirement that is selected.
    pub requirement: usize,
    /// The folder for exported code, if another than the default was chosen.
    pub output_folder: Option<PathBuf>,
    /// The texts of the projects whose designs are kept.
    pub kept: BTreeMap<DesignSlot, String>,
    /// The named designs that are drawn, by the place of their colour.
    pub overlaid: BTreeMap<usize, String>,
    /// The layouts of plots that differ from the usual ones.
    pub plots: BTreeMap<TilePlace, LayoutNode>,
}

impl Default for ProjectSettings {
    fn default() -> Self {
        Self {
            page: Page::Design,
            design_tab: DesignTab::Consequences,
            verification_tab: VerificationTab::Histories,
            diagnosis_tab: DiagnosisTab::Signals,
            part: ControllerPart::Feedback,
            section: 0,
            requirement: 0,
            output_folder: None,
            kept: BTreeMap::new(),
            overlaid: BTreeMap::new(),
            plots: BTreeMap::new(),
        }
    }
}

impl UserSettings {
    /// Reads the settings of a user; a file that is missing or cannot be read gives the defaults.
    pub fn load(state: &Path) -> Self {
        let mut settings: Self = read_json(&user_path(state)).unwrap_or_default();
        settings.zoom = settings.zoom.filter(|zoom| (ZOOMS.0..=ZOOMS.1).contains(zoom));
        settings.window_size =
            settings.window_size.filter(|size| size.iter().all(|side| (SIDES.0..=SIDES.1).contains(side)));
        settings
    }

    /// Applies the settings to a view.
    pub fn apply(&self, view: &mut StudioView) {
        view.theme = if self.theme == ThemeChoice::Light { LIGHT } else { DARK };
        view.units = self.units;
        view.shows_hint = !self.is_hint_closed;
    }

    /// Takes over what the view shows.
    pub fn update_from(&mut self, view: &StudioView) {
        self.theme = if view.theme == LIGHT { ThemeChoice::Light } else { ThemeChoice::Dark };
        self.units = view.units;
        self.is_hint_closed = !view.shows_hint;
    }
}

impl ProjectSettings {
    /// Reads the settings of a project, or `None` if there are none.
    pub fn load(state: &Path, project: &Path) -> Option<Self> {
        read_json(&project_path(state, project))
    }

    /// Returns the settings that a view shows.
    pub fn of_view(view: &StudioView) -> Self {
        Self {
            page: view.page,
            design_tab: view.design_tab,
            verification_tab: view.verification_tab,
            diagnosis_tab: view.diagnosis_tab,
            part: view.part,
            section: view.section,
            requirement: view.requirement,
            output_folder: view.output_folder.clone(),
            kept: view.kept_texts.clone(),
            overlaid: view.history.shown.clone(),
            plots: view.tiles.layouts(),
        }
    }

    /// Applies the settings to a view; kept designs follow when they are computed.
    pub fn apply(&self, view: &mut StudioView) {
        (view.page, view.verification_tab, view.diagnosis_tab) =
            (self.page, self.verification_tab, self.diagnosis_tab);
        view.design_tab = self.design_tab;
        (view.part, view.section, view.requirement) = (self.part, self.section, self.requirement);
        view.output_folder.clone_from(&self.output_folder);
        view.kept_texts.clone_from(&self.kept);
        view.history.shown.clone_from(&self.overlaid);
        view.tiles.set_layouts(&self.plots);
    }
}

/// A file to be written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SettingsFile {
    /// Path.
    pub path: PathBuf,
    /// Content.
    pub content: Vec<u8>,
}

/// Returns the file for the settings of the user.
pub fn user_settings_file(state: &Path, settings: &UserSettings) -> Option<SettingsFile> {
    Some(SettingsFile { path: user_path(state), content: serde_json::to_vec_pretty(settings).ok()? })
}

/// Returns the file for the settings of the project at a path.
pub fn project_settings_file(
    state: &Path,
    project: &Path,
    settings: &ProjectSettings,
) -> Option<SettingsFile> {
    let content = serde_json::to_vec_pretty(settings).ok()?;
    Some(SettingsFile { path: project_path(state, project), content })
}

/// Writes settings. An error of the disk is ignored: the defaults are used the next time.
pub fn write_settings(files: &[SettingsFile]) {
    for file in files {
        let _ = counterpoise_host::files::write_file(&file.path, &file.content);
    }
}

fn user_path(state: &Path) -> PathBuf {
    state.join("settings.json")
}

fn project_path(state: &Path, project: &Path) -> PathBuf {
    journal_path(state, project).with_extension("view.json")
}

fn read_json<T: DeserializeOwned>(path: &Path) -> Option<T> {
    counterpoise_host::files::read_file(path).ok().and_then(|bytes| serde_json::from_slice(&bytes).ok())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::units::GainUnit;

    #[test]
    fn settings_come_back_and_damaged_ones_give_the_defaults() {
        let state = counterpoise_host::files::scratch_folder().unwrap();
        let project = Path::new("rig.toml");
        let mut view = StudioView { theme: LIGHT, page: Page::Verify, ..StudioView::default() };
        view.units.gain = GainUnit::Absolute;
        view.kept_texts.insert(DesignSlot::B, "[plant]\n".to_owned());
        let mut user = UserSettings { zoom: Some(1.25), ..UserSettings::default() };
        user.update_from(&view);
        let settings = ProjectSettings::of_view(&view);
        let files = [
            user_settings_file(state.path(), &user).unwrap(),
            project_settings_file(state.path(), project, &settings).unwrap(),
        ];
        write_settings(&files);
        assert_eq!(UserSettings::load(state.path()), user);
        assert_eq!(ProjectSettings::load(state.path(), project), Some(settings));
        assert_eq!(ProjectSettings::load(state.path(), Path::new("other.toml")), None);
        std::fs::write(state.path().join("settings.json"), "{\"zoom\": 99, \"units\": {").unwrap();
        assert_eq!(UserSettings::load(state.path()), UserSettings::default());
        std::fs::write(state.path().join("settings.json"), "{\"zoom\": 99}").unwrap();
        assert_eq!(UserSettings::load(state.path()).zoom, None, "a zoom that would hide everything");
    }
}
