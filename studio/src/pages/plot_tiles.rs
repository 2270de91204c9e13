//! The plots of a page as tiles, which are dragged by their titles, split, put into tabs, and maximised.

use egui::{Rect, Stroke, Ui};
use egui_tiles::{Behavior, EditAction, ResizeState, SimplificationOptions, TileId, Tiles, UiResponse};

use super::widgets;
use crate::charts::chart_heading::HeadingResponse;
use crate::charts::chart_view::ChartResponse;
use crate::command::Command;
use crate::theme::{WindowTheme, space};
use crate::tile_layout::{PlotDrop, TilePlace, mend_drop};
use crate::view::StudioView;

/// Smallest side of a tile, points: a plot with its axes.
const LEAST_SIDE: f32 = 90.0;

/// Share of a row or a column from which a place in it is all of it: half of it is the largest other place.
const WHOLE_SHARE: f32 = 0.75;

/// A plot to be drawn.
pub struct TileRequest<'a> {
    /// The key of the plot.
    pub key: &'a str,
    /// Its place on the screen.
    pub cell: Rect,
}

/// Draws the plot of a key.
type DrawPlot<'a> =
    dyn FnMut(&mut Ui, &mut StudioView, &mut Vec<Command>, TileRequest) -> Option<ChartResponse> + 'a;

/// Shows the plots of a place in their layout; `draw` draws the plot of a key.
pub fn show(
    ui: &mut Ui,
    view: &mut StudioView,
    queue: &mut Vec<Command>,
    place: TilePlace,
    draw: &mut DrawPlot<'_>,
) {
    let area = widgets::take_remaining_area(ui);
    let mut inside = ui.new_child(egui::UiBuilder::new().id_salt(("tiles", place)).max_rect(area));
    if let Some(key) = view.tiles.maximised_at(place) {
        let mut shown = ShownTiles::new(view, queue, place, draw);
        let _ = shown.show_plot(&mut inside, &key);
        return;
    }
    let mut tree = view.tiles.take_tree(place);
    let dragged = tree.dragged_id(ui.ctx());
    let before = dragged.map(|_| tree.clone());
    let at = ui.input(|input| input.pointer.interact_pos());
    let mut shown = ShownTiles::new(view, queue, place, draw);
    tree.ui(&mut shown, &mut inside);
    if let (true, Some(before), Some(dragged), Some(at)) = (shown.is_dropped, before, dragged, at)
        && let Some(repaired) = mend_drop(place, &PlotDrop { before: &before, after: &tree, dragged, at })
    {
        tree = repaired;
    }
    view.tiles.put_tree(place, tree);
}

/// Shows the menu of the plots of a place: those that are hidden, and the usual layout.
pub fn show_menu(ui: &mut Ui, view: &StudioView, queue: &mut Vec<Command>) {
    let Some(place) = view.shown_tiles() else { return };
    let hidden = view.tiles.hidden_plots(place);
    let is_usual = !view.tiles.layouts().contains_key(&place);
    if is_usual && view.tiles.maximised_at(place).is_none() {
        return;
    }
    let plots = egui::Button::new("Plots").frame_when_inactive(false);
    egui::containers::menu::MenuButton::from_button(plots).ui(ui, |ui| {
        for plot in hidden {
            if ui.button(format!("Show {}", plot.name)).clicked() {
                queue.push(Command::ShowPlot { plot: plot.key.to_owned() });
                ui.close();
            }
        }
        if ui.button("Usual layout").clicked() {
            queue.push(Command::ResetPlots);
            ui.close();
        }
    });
}

/// The tiles of a place in a frame.
struct ShownTiles<'a, 'd> {
    view: &'a mut StudioView,
    queue: &'a mut Vec<Command>,
    place: TilePlace,
    theme: WindowTheme,
    draw: &'a mut DrawPlot<'d>,
    /// The places of the plots in this frame.
    cells: Vec<Rect>,
    is_dropped: bool,
}

impl<'a, 'd> ShownTiles<'a, 'd> {
    fn new(
        view: &'a mut StudioView,
        queue: &'a mut Vec<Command>,
        place: TilePlace,
        draw: &'a mut DrawPlot<'d>,
    ) -> Self {
        let theme = view.theme;
        Self { view, queue, place, theme, draw, cells: Vec::new(), is_dropped: false }
    }

    fn show_plot(&mut self, ui: &mut Ui, key: &str) -> UiResponse {
        let cell = ui.max_rect();
        self.cells.push(cell);
        if ui.rect_contains_pointer(cell) {
            self.view.tiles.pointed = Some(key.to_owned());
        }
        let is_maximised = self.view.tiles.maximised_at(self.place).is_some();
        self.view.tiles.corner = Some(if is_maximised { "show all plots beside" } else { "maximise" });
        let shown = (self.draw)(ui, self.view, self.queue, TileRequest { key, cell });
        self.view.tiles.corner = None;
        let Some(HeadingResponse { title, corner }) = shown.map(|shown| shown.heading) else {
            return UiResponse::None;
        };
        if corner.is_some_and(|corner| corner.clicked()) || title.double_clicked() {
            self.view.tiles.pointed = Some(key.to_owned());
            self.queue.push(Command::MaximisePlot);
        }
        if title.drag_started() && !is_maximised { UiResponse::DragStarted } else { UiResponse::None }
    }
}

impl Behavior<String> for ShownTiles<'_, '_> {
    fn pane_ui(&mut self, ui: &mut Ui, _: TileId, key: &mut String) -> UiResponse {
        self.show_plot(ui, key)
    }

    fn tab_title_for_pane(&mut self, key: &String) -> egui::WidgetText {
        self.place.plot(key).map_or("", |plot| plot.name).into()
    }

    fn gap_width(&self, _: &egui::Style) -> f32 {
        space::MEDIUM
    }

    fn min_size(&self) -> f32 {
        LEAST_SIDE
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions { flatten_tabs_in_tabs: true, ..SimplificationOptions::default() }
    }

    fn is_tab_closable(&self, _: &Tiles<String>, _: TileId) -> bool {
        true
    }

    fn resize_stroke(&self, _: &egui::Style, state: ResizeState) -> Stroke {
        match state {
            ResizeState::Idle => Stroke::NONE,
            ResizeState::Hovering => Stroke::new(2.0, self.theme.accent.gamma_multiply(0.6)),
            ResizeState::Dragging => Stroke::new(2.0, self.theme.accent),
        }
    }

    fn tab_bar_color(&self, _: &egui::Visuals) -> egui::Color32 {
        self.theme.ground
    }

    fn on_edit(&mut self, action: EditAction) {
        self.is_dropped |= action == EditAction::TileDropped;
    }

    fn paint_drag_preview(
        &self,
        visuals: &egui::Visuals,
        painter: &egui::Painter,
        parent: Option<Rect>,
        preview: Rect,
    ) {
        // a plot that is let go in the middle of a row or a column becomes a tab beside the plot under the pointer
        let fills_parent = parent.is_some_and(|parent| preview.area() > WHOLE_SHARE * parent.area());
        let at = painter.ctx().pointer_interact_pos().unwrap_or_default();
        let under = self.cells.iter().copied().find(|cell| cell.contains(at));
        let shown = under.filter(|_| fills_parent).unwrap_or(preview);
        let stroke = self.drag_preview_stroke(visuals);
        painter.rect(shown, 4.0, self.drag_preview_color(visuals), stroke, egui::StrokeKind::Inside);
    }

    fn drag_preview_stroke(&self, _: &egui::Visuals) -> Stroke {
        Stroke::new(1.5, self.theme.accent)
    }

    fn drag_preview_color(&self, _: &egui::Visuals) -> egui::Color32 {
        self.theme.accent.gamma_multiply(0.25)
    }
}
