//! The tab History of the page Design: designs with names, what they differ in, their verification and a thumbnail.

use counterpoise_models::ControlledQuantity;
use counterpoise_pipeline::preview::DesignPreview;
use counterpoise_report::wording::figures::describe_figure;
use counterpoise_verify::{LoopFigure, PerformanceFigure};
use egui::{Color32, Pos2, Rect, RichText, Sense, Stroke, Ui, Vec2, pos2};

use super::requirement_values::RequirementValue;
use super::widgets;
use crate::command::Command;
use crate::design_overlays::{DesignRenaming, HistoryFileState};
use crate::editing::design_history::{KeptVerdict, NamedDesign};
use crate::editing::weight_text::{WeightDifference, weight_differences};
use crate::number_format::format_short;
use crate::studio::rate_figures;
use crate::theme::{WindowTheme, space};
use crate::tolerance::SMALLEST_MODULUS;
use crate::view::StudioView;

/// Size of a thumbnail, points.
const THUMBNAIL: Vec2 = Vec2::new(170.0, 74.0);
/// Ends of the sensitivity in a thumbnail, dB.
const THUMBNAIL_DB: [f64; 2] = [-60.0, 12.0];
/// Most differing weights that are listed; the others are counted.
const MOST_DIFFERENCES: usize = 8;
/// Width of the field for a name, points.
const NAME_WIDTH: f32 = 220.0;

/// The design as it stands, with which the kept ones are compared.
pub struct CurrentDesign<'a> {
    /// The design; `None` if there is none.
    pub design: Option<&'a DesignPreview>,
    /// The requirements of the project.
    pub values: &'a [RequirementValue],
    /// The sections of the project that make the design.
    pub weights: &'a str,
}

/// Shows the tab.
pub fn show(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, now: &CurrentDesign) {
    show_name_field(ui, view, queue);
    if let HistoryFileState::Damaged(why) = view.history.file.clone() {
        widgets::show_error_list(ui, &view.theme, "The history of designs cannot be read", &[why]);
    }
    if view.history.designs.is_empty() && view.history.file == HistoryFileState::Readable {
        let text = "A design is kept here with a name: its weights, its figures and its sensitivity, in a file beside the project. \
            A, B and C on the left are quick places for a comparison in this window; a design of the history belongs to the project.";
        ui.label(RichText::new(text).color(view.theme.weak));
    }
    let designs: Vec<NamedDesign> = view.history.designs.designs().rev().cloned().collect();
    egui::ScrollArea::vertical().id_salt("history").auto_shrink(false).show(ui, |ui| {
        for kept in &designs {
            show_design(ui, view, queue, kept, now);
            ui.add_space(space::SMALL);
        }
    });
}

fn show_name_field(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let label = ui.label(RichText::new("Keep this design as").strong());
        let field =
            egui::TextEdit::singleline(&mut view.history.typed).hint_text("name").desired_width(NAME_WIDTH);
        let output = field.show(ui);
        let response = output.response.response.labelled_by(label.id);
        if std::mem::take(&mut view.history.focuses_name) {
            select_whole_name(ui, &response, output.state, &view.history.typed);
        }
        let is_entered = response.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
        let is_named = !view.history.typed.trim().is_empty();
        let keep =
            ui.add_enabled(is_named, egui::Button::new("Keep")).on_hover_text("Ctrl+D proposes a name");
        if keep.clicked() || (is_entered && is_named) {
            queue.push(Command::KeepDesign { name: view.history.typed.clone() });
        }
        if let Some(deleted) = &view.history.deleted {
            let text = format!("Put \"{}\" back", deleted.name());
            if ui.button(text).on_hover_text("it was deleted last").clicked() {
                queue.push(Command::PutDesignBack);
            }
        }
    });
    ui.add_space(space::SMALL);
}

/// Gives the keyboard to a field, with its whole text selected.
fn select_whole_name(
    ui: &Ui,
    response: &egui::Response,
    mut state: egui::text_edit::TextEditState,
    text: &str,
) {
    response.request_focus();
    let end = egui::text::CCursor::new(text.chars().count());
    state.cursor.set_char_range(Some(egui::text::CCursorRange::two(egui::text::CCursor::new(0), end)));
    state.store(ui.ctx(), response.id);
}

fn show_design(
    ui: &mut Ui,
    view: &mut StudioView,
    queue: &mut Vec<Command>,
    kept: &NamedDesign,
    now: &CurrentDesign,
) {
    let theme = view.theme;
    theme.card().show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal(|ui| {
            show_thumbnail(ui, view, kept, now.design);
            ui.vertical(|ui| {
                show_heading(ui, view, queue, kept, now);
                ui.spacing_mut().interact_size.y = 14.0;
                ui.horizontal_wrapped(|ui| {
                    ui.spacing_mut().item_spacing.x = 14.0;
                    show_figures(ui, view, kept, now);
                });
                show_differences(ui, &theme, kept, now);
            });
        });
    });
}

/// Shows the name, the verdicts, and what can be done with a design.
fn show_heading(
    ui: &mut Ui,
    view: &mut StudioView,
    queue: &mut Vec<Command>,
    kept: &NamedDesign,
    now: &CurrentDesign,
) {
    ui.horizontal(|ui| {
        show_name(ui, view, queue, kept);
        let verdicts = current_verdicts(kept, now);
        let count = |wanted| verdicts.iter().filter(|verdict| **verdict == wanted).count();
        let (holds, fails) = (count(KeptVerdict::Holds), count(KeptVerdict::Fails));
        let (text, colour) = match () {
            () if kept.verdicts.is_empty() => ("not verified".to_owned(), view.theme.warn),
            () if fails > 0 => (format!("{fails} of {} requirements fail", verdicts.len()), view.theme.bad),
            () => (format!("{holds} of {} requirements hold", verdicts.len()), view.theme.good),
        };
        ui.label(RichText::new(text).small().color(colour));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            show_buttons(ui, view, queue, &kept.name);
        });
    });
}

impl CurrentDesign<'_> {
    fn controlled_quantity(&self) -> Option<ControlledQuantity> {
        self.design.map(|design| design.synthesised.controlled)
    }
}

/// Returns the verdicts on the figures of a kept design, by the limits of the project as it stands; those that it lacks are open. Without
/// a design of the project they are those of the day on which it was kept.
fn current_verdicts(kept: &NamedDesign, now: &CurrentDesign) -> Vec<KeptVerdict> {
    let Some(controlled) = now.controlled_quantity() else {
        return kept.verdicts.values().copied().collect();
    };
    let verdict =
        |value: &RequirementValue| match kept.figures.get(&value.requirement.figure.key_in(controlled)) {
            Some(figure) if value.requirement.limit.distance_to_limit(*figure) >= 0.0 => KeptVerdict::Holds,
            Some(_) => KeptVerdict::Fails,
            None => KeptVerdict::Open,
        };
    now.values.iter().map(verdict).collect()
}

fn show_name(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, kept: &NamedDesign) {
    let Some(renaming) = view.history.renaming.as_mut().filter(|renaming| renaming.name == kept.name) else {
        let place = view.history.colour_place(&kept.name);
        let colour =
            place.and_then(|place| view.theme.overlays.get(place)).copied().unwrap_or(view.theme.text);
        ui.label(RichText::new(&kept.name).strong().color(colour));
        return;
    };
    let field = egui::TextEdit::singleline(&mut renaming.typed).desired_width(NAME_WIDTH);
    let output = field.show(ui);
    let response = output.response.response;
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::TextInput, true, format!("new name of {}", kept.name))
    });
    if std::mem::take(&mut renaming.takes_focus) {
        select_whole_name(ui, &response, output.state, &renaming.typed);
    } else if response.lost_focus() {
        match ui.input(|i| i.key_pressed(egui::Key::Escape)) {
            true => view.history.renaming = None,
            false => queue
                .push(Command::RenameDesign { name: kept.name.clone(), new_name: renaming.typed.clone() }),
        }
    }
}

/// Shows the buttons of a design, from the right to the left.
fn show_buttons(ui: &mut Ui, view: &mut StudioView, queue: &mut Vec<Command>, name: &str) {
    let named = |response: egui::Response, what: &str| {
        let text = format!("{what} {name}");
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, text.clone()));
        response
    };
    let delete =
        named(ui.button("Delete"), "delete").on_hover_text("it can be put back until the project is closed");
    if delete.clicked() {
        queue.push(Command::DeleteDesign { name: name.to_owned() });
    }
    if named(ui.button("Rename"), "rename").clicked() {
        let (name, typed) = (name.to_owned(), name.to_owned());
        view.history.renaming = Some(DesignRenaming { name, typed, takes_focus: true });
    }
    let hint = "puts its weights and its order into the project; one step of undo takes them out again";
    if named(ui.button("Go back to it"), "go back to").on_hover_text(hint).clicked() {
        queue.push(Command::RestoreDesign { name: name.to_owned() });
    }
    let is_drawn = view.history.colour_place(name).is_some();
    let draw = named(ui.selectable_label(is_drawn, "Draw in plots"), "draw")
        .on_hover_text("on the pages Design and Verify");
    if draw.clicked() {
        queue.push(Command::OverlayDesign { name: name.to_owned() });
    }
    if let Some(why) = view.history.failures.get(name) {
        ui.label(RichText::new("cannot be drawn").small().color(view.theme.bad)).on_hover_text(why);
    }
}

/// Shows margins, RMS rates and the figures of the requirements, each in the colour of the verdict on it.
fn show_figures(ui: &mut Ui, view: &StudioView, kept: &NamedDesign, now: &CurrentDesign) {
    let Some(controlled) = now.controlled_quantity() else { return };
    let margins =
        [LoopFigure::GainMargin, LoopFigure::PhaseMargin, LoopFigure::MaxSensitivity, LoopFigure::Crossover];
    let mut figures: Vec<PerformanceFigure> = margins.into_iter().map(PerformanceFigure::Loop).collect();
    figures.extend(rate_figures());
    figures.extend(now.values.iter().map(|value| value.requirement.figure));
    let mut once: Vec<PerformanceFigure> = Vec::new();
    for figure in figures {
        if !once.contains(&figure) {
            once.push(figure);
            show_figure(ui, view, &FigureOfDesign { kept, figure, controlled }, now.values);
        }
    }
}

/// A figure of a kept design.
struct FigureOfDesign<'a> {
    kept: &'a NamedDesign,
    figure: PerformanceFigure,
    controlled: ControlledQuantity,
}

fn show_figure(ui: &mut Ui, view: &StudioView, of: &FigureOfDesign, values: &[RequirementValue]) {
    let Some(kept) = of.kept.figures.get(&of.figure.key_in(of.controlled)) else { return };
    let unit = view.units.display_unit(of.figure.unit(of.controlled));
    let limits = values.iter().filter(|value| value.requirement.figure == of.figure);
    let fails = limits.map(|value| value.requirement.limit.distance_to_limit(*kept)).any(|room| room < 0.0);
    // what every kept figure has in common
    let name = describe_figure(of.figure, of.controlled)
        .replace(", nonlinear plant", "")
        .replace(", feedback + feedforward", "");
    let sign = if fails { " (fails)" } else { "" };
    let text = format!("{name} {} {}", format_short(unit.factor * kept), unit.name);
    let colour = if fails { view.theme.bad } else { view.theme.weak };
    let text = RichText::new(format!("{}{sign}", text.trim_end())).small().color(colour);
    ui.add(egui::Label::new(text).extend());
}

/// Shows the weights in which a kept design differs from the one as it stands.
fn show_differences(ui: &mut Ui, theme: &WindowTheme, kept: &NamedDesign, now: &CurrentDesign) {
    let text = match weight_differences(now.weights, &kept.weights) {
        None => "its weights cannot be compared: the project's text has errors".to_owned(),
        Some(differences) if differences.is_empty() => "the weights are those of the project".to_owned(),
        Some(differences) => {
            let shown: Vec<String> =
                differences.iter().take(MOST_DIFFERENCES).map(describe_difference).collect();
            let more = differences.len().saturating_sub(MOST_DIFFERENCES);
            let rest = if more > 0 { format!("; {more} more") } else { String::new() };
            format!("weights that differ: {}{rest}", shown.join("; "))
        }
    };
    ui.label(RichText::new(text).small().color(theme.text));
}

fn describe_difference(difference: &WeightDifference) -> String {
    let value = |value: &Option<String>| {
        let Some(value) = value else { return "not stated".to_owned() };
        value.parse().map_or_else(|_| value.clone(), |number: f64| format_short(number))
    };
    let path = difference.path.trim_start_matches("synth.").replace(['_', '.'], " ");
    format!("{path} {} (now {})", value(&difference.second), value(&difference.first))
}

/// Shows the sensitivity of a kept design over that of the design as it stands.
fn show_thumbnail(ui: &mut Ui, view: &StudioView, kept: &NamedDesign, design: Option<&DesignPreview>) {
    let theme = &view.theme;
    let (area, response) = ui.allocate_exact_size(THUMBNAIL, Sense::hover());
    let name = format!("sensitivity of {}", kept.name);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, name.clone()));
    let painter = ui.painter().with_clip_rect(area.intersect(ui.clip_rect()));
    painter.rect_filled(area, 4.0, theme.field);
    let ends = kept.sensitivity_hz;
    let zero = place_in(area, ends, [ends[0], 0.0]).y;
    painter.hline(area.x_range(), zero, Stroke::new(1.0, theme.weak.gamma_multiply(0.5)));
    let curve = |points: Vec<Pos2>, colour: Color32, width: f32| {
        painter.add(egui::Shape::line(points, Stroke::new(width, colour)));
    };
    if let Some(design) = design
        && let Some(sensitivity) = design.curves.sensitivities.first()
    {
        let points = design.curves.frequency_hz.iter().zip(&sensitivity.response);
        let decibel = |h: &counterpoise_linalg::C64| 20.0 * h.norm().max(SMALLEST_MODULUS).log10();
        curve(points.map(|(hz, h)| place_in(area, ends, [*hz, decibel(h)])).collect(), theme.weak, 1.0);
    }
    let last = kept.sensitivity_db.len().saturating_sub(1).max(1) as f64;
    let hz = |k: usize| ends[0] * (ends[1] / ends[0]).powf(k as f64 / last);
    let points = kept.sensitivity_db.iter().enumerate().map(|(k, db)| place_in(area, ends, [hz(k), *db]));
    let place = view.history.colour_place(&kept.name);
    let colour = place.and_then(|place| theme.overlays.get(place)).copied().unwrap_or(theme.curves[0]);
    curve(points.collect(), colour, 1.8);
    response.on_hover_text("sensitivity; the thin line is the design as it stands, the level is 0 dB");
}

/// Returns the place of a frequency and a sensitivity in dB in a thumbnail between two frequencies.
fn place_in(area: Rect, ends_hz: [f64; 2], [hz, db]: [f64; 2]) -> Pos2 {
    let decades = |hz: f64| hz.max(f64::MIN_POSITIVE).log10();
    let share = (decades(hz) - decades(ends_hz[0]))
        / (decades(ends_hz[1]) - decades(ends_hz[0])).max(f64::MIN_POSITIVE);
    let height = (db - THUMBNAIL_DB[0]) / (THUMBNAIL_DB[1] - THUMBNAIL_DB[0]);
    pos2(
        area.left() + share.clamp(-1.0, 2.0) as f32 * area.width(),
        area.bottom() - height.clamp(-1.0, 2.0) as f32 * area.height(),
    )
}
