//! The strip of requirements above a page: a chip for each, with its value, its limit and the room between them.

use counterpoise_models::ControlledQuantity;
use counterpoise_report::wording::figures::describe_figure;
use counterpoise_verify::{Limit, Verdict};
use egui::{Align2, Color32, FontId, Rect, Sense, Stroke, Ui, Vec2, pos2, vec2};

use super::requirement_values::RequirementValue;
use crate::help::glossary::describe_terms;
use crate::number_format::format_short;
use crate::theme::{WindowTheme, space};
use crate::versioned_results::Freshness;
use crate::view::StudioView;

/// Least width of a chip, and its height, points.
const CHIP: Vec2 = Vec2::new(140.0, 44.0);
/// Rows of chips that are shown at once; further ones are scrolled to.
const STRIP_ROWS: f32 = 2.0;
/// Room at both sides of the text of a chip, points.
const CHIP_MARGIN: f32 = 7.0;
/// Sizes of the text of a chip, points.
const NAME_SIZE: f32 = 12.0;
const DETAILS_SIZE: f32 = 12.0;
const VALUE_SIZE: f32 = 13.0;
const LIMIT_SIZE: f32 = 12.0;
/// Room between two texts of a chip, and for the sign of its verdict, points.
const TEXT_GAP: f32 = 5.0;
const SIGN_WIDTH: f32 = 13.0;
/// What help says of a chip.
const CHIP_HELP: &str = "A requirement of the project: the value of the figure, its limit, and the room between them as a bar from the middle. A click stresses the limit in the plots that it concerns, where it can be dragged. A dim chip shows the value of an older design.";
/// Height of the bar of a margin, points.
const BAR_HEIGHT: f32 = 4.0;

/// Shows the strip; a click selects the requirement, whose limit is then stressed in the plots.
pub fn show(ui: &mut Ui, view: &mut StudioView, values: &[RequirementValue], controlled: ControlledQuantity) {
    if values.is_empty() {
        return;
    }
    let most = STRIP_ROWS * (CHIP.y + space::SMALL);
    egui::ScrollArea::vertical().id_salt("requirements").auto_shrink([false, true]).max_height(most).show(
        ui,
        |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing = Vec2::splat(space::SMALL);
                for (k, value) in values.iter().enumerate() {
                    let chip =
                        Chip { is_selected: view.requirement == k, ..Chip::new(view, value, controlled) };
                    let response = chip.show(ui, &view.theme);
                    if response.clicked() {
                        view.requirement = k;
                    }
                    if response.hovered() || response.has_focus() {
                        view.help.note(chip.whole_name(), CHIP_HELP);
                    }
                }
            });
        },
    );
    ui.add_space(space::SMALL);
}

/// What a chip says.
struct Chip {
    name: String,
    details: String,
    value: String,
    limit: String,
    /// Room to the limit relative to it: from -1, far beyond, to 1, far from it.
    room: Option<f64>,
    freshness: Freshness,
    source: String,
    is_selected: bool,
}

impl Chip {
    fn new(view: &StudioView, value: &RequirementValue, controlled: ControlledQuantity) -> Self {
        let requirement = &value.requirement;
        let unit = view.units.display_unit(requirement.figure.unit(controlled));
        let whole = describe_figure(requirement.figure, controlled);
        let (name, details) = whole.split_once(", ").unwrap_or((whole.as_str(), ""));
        let (measured, room) = match &value.verdict {
            Some(Verdict::Holds { value, margin, .. }) => (Some(*value), Some(*margin)),
            Some(Verdict::Fails { value, by, .. }) => (Some(*value), Some(-*by)),
            _ => (None, None),
        };
        let sign = if matches!(requirement.limit, Limit::AtLeast(_)) { "\u{2265}" } else { "\u{2264}" };
        let limit = format_short(unit.factor * requirement.limit.value());
        let scale = requirement.limit.value().abs().max(f64::MIN_POSITIVE);
        Self {
            name: name.to_owned(),
            details: details.replace("feedback + feedforward", "with feedforward"),
            value: measured.map_or("-".to_owned(), |value| format_short(unit.factor * value)),
            limit: format!("{sign} {limit} {}", unit.name).trim_end().to_owned(),
            room: room.map(|room| (room / scale).clamp(-1.0, 1.0)),
            freshness: value.freshness,
            source: requirement.source.clone(),
            is_selected: false,
        }
    }

    fn whole_name(&self) -> String {
        let words = [self.name.as_str(), self.details.as_str()].into_iter().filter(|text| !text.is_empty());
        words.collect::<Vec<_>>().join(", ")
    }

    /// Returns the details as they stand in the chip.
    fn short_details(&self) -> String {
        self.details.replace(" plant", "")
    }

    /// Returns the width that shows all of its texts.
    fn width(&self, ui: &Ui) -> f32 {
        let width = |text: &str, size| {
            let font = FontId::proportional(size);
            ui.painter().layout_no_wrap(text.to_owned(), font, Color32::WHITE).size().x
        };
        let heading = width(&self.name, NAME_SIZE) + TEXT_GAP + width(&self.short_details(), DETAILS_SIZE);
        let numbers =
            SIGN_WIDTH + width(&self.value, VALUE_SIZE) + 2.0 * TEXT_GAP + width(&self.limit, LIMIT_SIZE);
        (heading.max(numbers) + 2.0 * CHIP_MARGIN).max(CHIP.x).ceil()
    }

    fn colour(&self, theme: &WindowTheme) -> Color32 {
        match self.room {
            Some(room) if room < 0.0 => theme.bad,
            Some(_) => theme.good,
            None => theme.warn,
        }
    }

    /// Returns the verdict in a word.
    fn word(&self) -> &'static str {
        match self.room {
            Some(room) if room < 0.0 => "FAILS",
            Some(_) => "holds",
            None => "open",
        }
    }

    fn show(&self, ui: &mut Ui, theme: &WindowTheme) -> egui::Response {
        let is_selected = self.is_selected;
        let (area, response) = ui.allocate_exact_size(vec2(self.width(ui), CHIP.y), Sense::click());
        let stale = if self.freshness == Freshness::Stale { " (of an older design)" } else { "" };
        let whole = self.whole_name();
        let text = format!("requirement: {whole}: {} {}, {}{stale}", self.value, self.limit, self.word());
        response
            .widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, is_selected, text.clone()));
        if response.gained_focus() {
            response.scroll_to_me(None);
        }
        self.paint(ui, theme, area, self.stroke(theme, &response));
        let source = if self.source.is_empty() { String::new() } else { format!("\n{}", self.source) };
        if !response.hovered() {
            return response;
        }
        let terms = describe_terms(&whole).map_or_else(String::new, |terms| format!("\n{terms}"));
        let verdict = format!("{} {}: {}{stale}", self.value, self.limit, self.word());
        response.on_hover_text(format!("{whole}\n{verdict}{source}{terms}"))
    }

    fn stroke(&self, theme: &WindowTheme, response: &egui::Response) -> Stroke {
        if response.has_focus() {
            Stroke::new(2.0, theme.accent)
        } else if self.is_selected || response.hovered() {
            Stroke::new(1.5, theme.accent.gamma_multiply(0.8))
        } else {
            Stroke::new(1.0, theme.line)
        }
    }

    fn paint(&self, ui: &Ui, theme: &WindowTheme, area: Rect, stroke: Stroke) {
        let painter = ui.painter().with_clip_rect(area.intersect(ui.clip_rect()));
        painter.rect(area, 5.0, theme.card, stroke, egui::StrokeKind::Inside);
        let dim = if self.freshness == Freshness::Stale { 0.55 } else { 1.0 };
        let (left, right) = (area.left() + CHIP_MARGIN, area.right() - CHIP_MARGIN);
        let text = |at, anchor, text: &str, size, colour: Color32| {
            painter.text(at, anchor, text, FontId::proportional(size), colour.gamma_multiply(dim))
        };
        let name = text(pos2(left, area.top() + 3.0), Align2::LEFT_TOP, &self.name, NAME_SIZE, theme.text);
        let details = pos2(name.right() + TEXT_GAP, name.bottom() - 1.0);
        text(details, Align2::LEFT_BOTTOM, &self.short_details(), DETAILS_SIZE, theme.weak);
        let middle = area.top() + 26.0;
        let value_colour = if self.word() == "holds" { theme.text } else { self.colour(theme) };
        let sign = pos2(left + 4.0, middle);
        draw_sign(&painter, sign, self.word(), self.colour(theme).gamma_multiply(dim));
        text(pos2(left + SIGN_WIDTH, middle), Align2::LEFT_CENTER, &self.value, VALUE_SIZE, value_colour);
        text(pos2(right, middle), Align2::RIGHT_CENTER, &self.limit, LIMIT_SIZE, theme.weak);
        let bar =
            Rect::from_min_size(pos2(left, area.bottom() - BAR_HEIGHT - 3.0), vec2(right - left, BAR_HEIGHT));
        self.paint_bar(&painter, theme, bar, dim);
    }

    /// Draws the room to the limit from the middle: to the right what is left, to the left what is missing.
    fn paint_bar(&self, painter: &egui::Painter, theme: &WindowTheme, bar: Rect, dim: f32) {
        painter.rect_filled(bar, 2.0, theme.field);
        let middle = bar.center().x;
        if let Some(room) = self.room {
            let end = middle + 0.5 * bar.width() * room as f32;
            let filled = Rect::from_x_y_ranges(middle.min(end)..=middle.max(end), bar.y_range());
            painter.rect_filled(filled, 2.0, self.colour(theme).gamma_multiply(dim));
        }
        painter.vline(middle, bar.expand(1.5).y_range(), Stroke::new(1.0, theme.weak));
    }
}

/// Draws a verdict as a sign that can be read without colour: a dot, a cross, or a ring.
fn draw_sign(painter: &egui::Painter, at: egui::Pos2, word: &str, colour: Color32) {
    let stroke = Stroke::new(2.0, colour);
    match word {
        "holds" => {
            painter.circle_filled(at, 3.5, colour);
        }
        "FAILS" => {
            for side in [vec2(3.5, 3.5), vec2(3.5, -3.5)] {
                painter.line_segment([at - side, at + side], stroke);
            }
        }
        _ => {
            painter.circle_stroke(at, 3.0, stroke);
        }
    }
}
