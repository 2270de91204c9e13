//! Diagnose: recordings against the model, what was left out, and the improved mechanism taken over.

use std::sync::Arc;

use counterpoise_recordings::Channel;
use egui::{RichText, Ui};

use super::{findings, parts};
use crate::chart::{Chart, Curve, Dash};
use crate::command::{Command, Inquiry, Purpose};
use crate::jobs::Jobs;
use crate::pyramid::{Points, Pyramid};
use crate::recordings::{Seen, Track};
use crate::results::Of;
use crate::studio::{Opened, Studio};
use crate::theme::{Theme, space};
use crate::view::View;

/// Shows the place.
pub fn show(studio: &mut Studio, ui: &mut Ui, queue: &mut Vec<Command>) {
    let Some(opened) = &studio.opened else { return };
    let (jobs, view) = (&studio.jobs, &mut studio.view);
    let theme = view.theme;
    parts::side("recordings", &theme, 330.0).show(ui, |ui| {
        egui::ScrollArea::vertical().show(ui, |ui| {
            theme.card().show(ui, |ui| {
                ui.set_width(ui.available_width());
                list(ui, view, queue, jobs);
            });
            ui.add_space(space::SMALL);
            mapping(ui, view, queue, (jobs, opened));
        });
    });
    if jobs.recordings.is_empty() {
        return parts::empty(
            ui,
            &theme,
            "No recordings yet",
            "recordings tell what the model leaves out: friction, backlash, out-of-balance, sensors, delay",
        );
    }
    tabs(ui, view, queue, jobs);
    match (view.inquiry, &jobs.diagnosed) {
        (Inquiry::Signals | Inquiry::Errors, _) => channels(ui, view, queue, jobs),
        (_, Some(Err(why))) => parts::reasons(ui, &theme, "The recordings could not be diagnosed", why),
        (inquiry, Some(Ok(found))) => {
            egui::ScrollArea::vertical().show(ui, |ui| match inquiry {
                Inquiry::Map => findings::map(ui, &theme, &found.answer),
                Inquiry::Tried => findings::tried(ui, &theme, &found.answer),
                _ => findings::answer(ui, view, queue, &found.answer),
            });
        }
        (_, None) if jobs.diagnose.is_busy() => parts::empty(ui, &theme, "Diagnosing", &jobs.progress()),
        (_, None) => parts::empty(
            ui,
            &theme,
            "No diagnosis yet",
            "F6 fits every effect of the library to part of the data and judges it on the rest",
        ),
    }
}

fn tabs(ui: &mut Ui, view: &View, queue: &mut Vec<Command>, jobs: &Jobs) {
    ui.horizontal(|ui| {
        for inquiry in Inquiry::ALL {
            if ui.selectable_label(view.inquiry == inquiry, inquiry.name()).clicked() {
                queue.push(Command::Inquire { inquiry });
            }
        }
        if let (Some(Ok(found)), true) = (&jobs.diagnosed, view.inquiry != Inquiry::Findings) {
            ui.add_space(space::LARGE);
            ui.label(RichText::new(findings::sentence(found.answer.verdict)).color(view.theme.weak));
        }
    });
}

/// The recordings, and what can be done with them.
fn list(ui: &mut Ui, view: &mut View, queue: &mut Vec<Command>, jobs: &Jobs) {
    let theme = view.theme;
    parts::heading(ui, "Recordings");
    let seen = jobs.seen.as_ref().map(|of| of.value.as_slice()).unwrap_or_default();
    for (k, one) in seen.iter().enumerate() {
        let bad = !one.trouble.is_empty();
        let text = RichText::new(&one.name).color(if bad { theme.bad } else { theme.text });
        if ui
            .selectable_label(view.recording == k, text)
            .on_hover_text(one.path.display().to_string())
            .clicked()
        {
            view.recording = k;
        }
    }
    if seen.is_empty() {
        for path in &jobs.recordings {
            ui.label(path.file_name().unwrap_or_default().to_string_lossy());
        }
    }
    add(ui, view, queue, jobs);
    ui.add_space(space::SMALL);
    let busy = jobs.diagnose.is_busy();
    ui.horizontal(|ui| {
        let ready = !busy && !jobs.recordings.is_empty();
        if ui.add_enabled(ready, egui::Button::new("Diagnose")).on_hover_text("F6").clicked() {
            queue.push(Command::Diagnose);
        }
        let found = matches!(&jobs.diagnosed, Some(Ok(found)) if !found.answer.findings.is_empty());
        let accept = ui.add_enabled(found && !busy, egui::Button::new("Accept into the project"));
        if accept.on_hover_text("one step that can be undone; design and verification follow").clicked() {
            queue.push(Command::Accept);
        }
        if busy && ui.button("Stop").on_hover_text("Esc").clicked() {
            queue.push(Command::Cancel);
        }
    });
    if busy {
        ui.label(RichText::new(jobs.progress()).small().color(theme.accent));
    }
}

/// Ways to give recordings beside dropping them.
fn add(ui: &mut Ui, view: &View, queue: &mut Vec<Command>, jobs: &Jobs) {
    if jobs.recordings.is_empty() {
        ui.label(RichText::new("Drop files or a folder onto the window, or").small().color(view.theme.weak));
    }
    ui.horizontal(|ui| {
        if ui.button("Add\u{2026}").on_hover_text("look for recordings (Ctrl+R)").clicked() {
            queue.push(Command::Browse { purpose: Purpose::Recordings });
        }
        let text = format!("Take the {} beside the project", jobs.beside.len());
        if !jobs.recordings.is_empty() {
            if ui.button("Remove all").clicked() {
                queue.push(Command::Recordings { paths: Vec::new() });
            }
        } else if !jobs.beside.is_empty() && ui.button(text).clicked() {
            queue.push(Command::Recordings { paths: jobs.beside.clone() });
        }
    });
}

/// Which column of the chosen recording is which channel.
fn mapping(ui: &mut Ui, view: &mut View, queue: &mut Vec<Command>, (jobs, opened): (&Jobs, &Opened)) {
    let (Some(seen), Some(project)) = (chosen(view, jobs.seen.as_ref()), opened.session.project()) else {
        return;
    };
    let theme = view.theme;
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        parts::heading(ui, "Channels");
        egui::Grid::new("channels").num_columns(2).spacing([8.0, 4.0]).show(ui, |ui| {
            for channel in Channel::ALL {
                let source = project.recording.channels.iter().find(|(c, _)| *c == channel).map(|(_, s)| s);
                let there = seen.tracks.iter().any(|track| track.channel == channel.name());
                let name = channel.name().replace('_', " ");
                ui.label(RichText::new(&name).color(if there { theme.text } else { theme.weak }));
                let (path, shown) = (path_of(channel), source.map_or("by its name", |s| s.column.as_str()));
                column(ui, queue, (&name, &path, shown), (&seen.columns, source.is_some()));
                ui.end_row();
            }
        });
        for (channel, source) in &project.recording.channels {
            let path = path_of(*channel);
            parts::heading(ui, &channel.name().replace('_', " "));
            egui::Grid::new(&path).num_columns(3).spacing([8.0, 2.0]).show(ui, |ui| {
                parts::number(ui, view, queue, &format!("{path}.scale"), source.scale);
                parts::number(ui, view, queue, &format!("{path}.offset"), source.offset);
            });
        }
    });
}

fn path_of(channel: Channel) -> String {
    format!("recording.channels.{}", channel.name())
}

fn column(
    ui: &mut Ui,
    queue: &mut Vec<Command>,
    (name, path, shown): (&str, &str, &str),
    (columns, mapped): (&[(String, Option<String>)], bool),
) {
    let boxed = egui::ComboBox::from_id_salt(path).selected_text(shown).width(150.0);
    let response = boxed.show_ui(ui, |ui| {
        if ui.selectable_label(!mapped, "by its name").clicked() && mapped {
            queue.push(Command::Remove { path: path.to_owned() });
        }
        for (column, unit) in columns {
            let text = unit.as_ref().map_or(column.clone(), |unit| format!("{column} [{unit}]"));
            if ui.selectable_label(mapped && shown == column, text).clicked() {
                queue.push(Command::SetText { path: format!("{path}.column"), value: column.clone() });
            }
        }
    });
    response.response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::ComboBox, true, format!("column of the {name}"))
    });
}

fn chosen<'a>(view: &View, seen: Option<&'a Of<Vec<Seen>>>) -> Option<&'a Seen> {
    let all = &seen?.value;
    all.get(view.recording.min(all.len().saturating_sub(1)))
}

/// The channels of the chosen recording, under one cursor.
fn channels(ui: &mut Ui, view: &mut View, queue: &mut Vec<Command>, jobs: &Jobs) {
    let theme = view.theme;
    let Some(seen) = chosen(view, jobs.seen.as_ref()) else {
        return parts::empty(ui, &theme, "Reading", "the recordings are read and replayed on the model");
    };
    if !seen.trouble.is_empty() {
        let title = format!("{}: mend it, or its mapping on the left", seen.name);
        parts::reasons(ui, &theme, &title, &seen.trouble);
    }
    if !seen.remarks.is_empty() {
        theme.card().show(ui, |ui| {
            ui.set_width(ui.available_width());
            for remark in seen.remarks.iter().take(4) {
                ui.label(RichText::new(remark).small().color(theme.warn));
            }
        });
    }
    let errors = view.inquiry == Inquiry::Errors;
    let drawn: Vec<&Track> = seen.tracks.iter().filter(|t| t.model.is_some() || !errors).collect();
    if drawn.is_empty() {
        return;
    }
    let room = parts::room(ui);
    let columns = if drawn.len() > 4 { 2 } else { 1 };
    for (cell, track) in parts::grid(room, drawn.len(), columns).iter().zip(drawn) {
        let chart = if errors { error_chart(view, track) } else { signal_chart(view, track) };
        parts::chart(ui, view, queue, *cell, &chart);
    }
}

fn titled(view: &View, track: &Track) -> (Chart, f64) {
    let name = track.channel.replace('_', " ");
    let mut title = name.clone();
    if let (Some(model), Some(floor)) = (&track.model, track.floor) {
        title = format!("{name}: error {:.2} x its floor", model.rms / floor);
        if let Some(improved) = &track.improved {
            title = format!("{title}, {:.2} with the diagnosis", improved.rms / floor);
        }
    }
    let (unit, factor) = view.shown_unit(track.unit);
    (Chart::new(&title, "time, s", &format!("{name}, {unit}")).grouped("recording"), factor)
}

/// A long curve, its values multiplied to be shown.
fn long(name: &str, theme: &Theme, k: usize, (pyramid, factor): (&Arc<Pyramid>, f64)) -> Curve {
    let points = Points::Many(Arc::clone(pyramid), factor);
    Curve { name: name.to_owned(), points, colour: theme.curves[k], dash: Dash::Solid }
}

fn signal_chart(view: &View, track: &Track) -> Chart {
    let (mut chart, factor) = titled(view, track);
    let theme = &view.theme;
    chart = chart.with(long("measured", theme, 1, (&track.measured, factor)));
    if let Some(model) = &track.model {
        chart = chart.with(long("model", theme, 0, (&model.signal, factor)));
    }
    if let Some(improved) = &track.improved {
        chart = chart.with(long("with the diagnosis", theme, 2, (&improved.signal, factor)));
    }
    chart
}

fn error_chart(view: &View, track: &Track) -> Chart {
    let (mut chart, factor) = titled(view, track);
    if let Some(model) = &track.model {
        chart = chart.with(long("model", &view.theme, 0, (&model.error, factor)));
    }
    if let Some(improved) = &track.improved {
        chart = chart.with(long("with the diagnosis", &view.theme, 2, (&improved.error, factor)));
    }
    chart
}
