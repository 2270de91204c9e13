//! The columns of a recording's file that become the channels, chosen on the page Diagnose.

use counterpoise_project::Project;
use counterpoise_recordings::{Channel, ChannelSource};
use egui::{RichText, Ui};

use super::recording_charts::channel_words;
use super::widgets;
use crate::command::Command;
use crate::jobs::recording_views::{ColumnName, RecordingView};
use crate::view::StudioView;

/// A channel, or the time, whose column is chosen.
struct MappedQuantity<'a> {
    name: String,
    path: String,
    source: Option<&'a ChannelSource>,
    is_found: bool,
}

/// The source of a quantity without a chosen column.
const BY_NAME: &str = "by its name";

/// Shows which column of a recording is the time and which is which channel.
pub fn show(
    ui: &mut Ui,
    view: &mut StudioView,
    queue: &mut Vec<Command>,
    recording: &RecordingView,
    project: &Project,
) {
    let theme = view.theme;
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        widgets::show_heading(ui, "Channels");
        egui::Grid::new("channels").num_columns(2).spacing([8.0, 4.0]).show(ui, |ui| {
            for quantity in quantities(recording, project) {
                let colour = if quantity.is_found { theme.text } else { theme.weak };
                ui.label(RichText::new(&quantity.name).color(colour));
                show_column_choice(ui, queue, &quantity, &recording.columns);
                ui.end_row();
            }
        });
        for (channel, source) in &project.recording.channels {
            let path = channel_path(*channel);
            widgets::show_heading(ui, &channel_words(*channel));
            egui::Grid::new(&path).num_columns(3).spacing([8.0, 2.0]).show(ui, |ui| {
                widgets::number_field(ui, view, queue, &format!("{path}.scale"), source.scale);
                widgets::number_field(ui, view, queue, &format!("{path}.offset"), source.offset);
            });
        }
    });
}

/// Returns the time and every channel.
fn quantities<'a>(recording: &RecordingView, project: &'a Project) -> Vec<MappedQuantity<'a>> {
    let time = MappedQuantity {
        name: "time".to_owned(),
        path: "recording.channels.time".to_owned(),
        source: project.recording.time.as_ref(),
        is_found: !recording.channels.is_empty(),
    };
    let channel = |channel: Channel| MappedQuantity {
        name: channel_words(channel),
        path: channel_path(channel),
        source: project.recording.channels.iter().find(|(c, _)| *c == channel).map(|(_, source)| source),
        is_found: recording.channels.iter().any(|view| view.channel == channel),
    };
    std::iter::once(time).chain(Channel::ALL.into_iter().map(channel)).collect()
}

fn channel_path(channel: Channel) -> String {
    format!("recording.channels.{}", channel.name())
}

fn show_column_choice(
    ui: &mut Ui,
    queue: &mut Vec<Command>,
    quantity: &MappedQuantity,
    columns: &[ColumnName],
) {
    let selected = quantity.source.map(|source| source.column.as_str());
    let shown = selected.unwrap_or(BY_NAME);
    let combo = egui::ComboBox::from_id_salt(&quantity.path).selected_text(shown).width(150.0);
    let response = combo.show_ui(ui, |ui| {
        if ui.selectable_label(selected.is_none(), BY_NAME).clicked() && selected.is_some() {
            queue.push(Command::Remove { path: quantity.path.clone() });
        }
        for column in columns {
            let text = match &column.unit {
                Some(unit) => format!("{} [{unit}]", column.name),
                None => column.name.clone(),
            };
            if ui.selectable_label(selected == Some(column.name.as_str()), text).clicked() {
                let path = format!("{}.column", quantity.path);
                queue.push(Command::SetText { path, value: column.name.clone() });
            }
        }
    });
    let name = format!("column of the {}", quantity.name);
    response.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, name.clone()));
}
