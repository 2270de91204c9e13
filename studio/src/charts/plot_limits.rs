//! The limits of each plot: its own range until the user zooms or pans, and again after a reset.
//!
//! The plotting library keeps limits by the plot's name. Here it is decided, in each frame, whether they are the chart's or the user's.
//! They become the chart's again if its scope changes (another unit, part or project), by a double click, and by command.

use crate::tolerance::SAME_LIMITS;
use std::hash::{DefaultHasher, Hash, Hasher};

use egui::{Id, Rect, Ui, Vec2};
use egui_plot::PlotUi;

use super::chart::{Chart, PlotAxis};

/// Zoom for one point of the wheel: a notch of 50 points zooms by about a quarter.
const ZOOM_PER_POINT: f32 = 0.005;

/// Who has set the limits of a plot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum LimitsOwner {
    /// The chart.
    #[default]
    Chart,
    /// The user, by zooming or panning.
    User,
}

/// The limits as they were left in the last frame.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct LimitsState {
    scope: u64,
    resets: u64,
    owner: LimitsOwner,
    set: [Option<(f64, f64)>; 2],
}

/// Limits of one chart in a window.
pub struct PlotLimits {
    id: Id,
    group_id: Id,
    scope: u64,
    wheel: f32,
}

impl PlotLimits {
    /// Returns the limits of a chart; `scope` names what the limits belong to beside the chart's own axes.
    pub fn new(chart: &Chart, scope: &str) -> Self {
        let mut hasher = DefaultHasher::new();
        (scope, &chart.labels, chart.scales).hash(&mut hasher);
        let group = chart.group.unwrap_or(chart.title.as_str());
        Self {
            id: Id::unique(("limits", &chart.title)),
            group_id: Id::unique(("resets", group)),
            scope: hasher.finish(),
            wheel: 0.0,
        }
    }

    /// Takes the wheel for the plot while the pointer is in its area, so that a list around the plot does not scroll.
    pub fn take_wheel(&mut self, ui: &Ui, area: Rect) {
        if ui.rect_contains_pointer(area) {
            self.wheel = ui.input_mut(|input| std::mem::take(&mut input.smooth_scroll_delta).y);
        }
    }

    /// Gives the limits of the plot, and of the plots that are zoomed with it, back to the charts.
    pub fn reset(&self, ui: &Ui) {
        ui.data_mut(|data| *data.get_temp_mut_or_default::<u64>(self.group_id) += 1);
        ui.ctx().request_repaint();
    }

    /// Returns whether the user has zoomed or panned.
    pub fn is_users(&self, ui: &Ui) -> bool {
        ui.data(|data| data.get_temp::<LimitsState>(self.id)).is_some_and(|s| s.owner == LimitsOwner::User)
    }

    /// Sets the limits of this frame.
    pub fn apply(&self, chart: &Chart, plot: &mut PlotUi<'_>) {
        let context = plot.ctx().clone();
        let resets = context.data(|data| data.get_temp::<u64>(self.group_id)).unwrap_or_default();
        let last = context.data(|data| data.get_temp::<LimitsState>(self.id));
        let mut state = last
            .filter(|state| (state.scope, state.resets) == (self.scope, resets))
            .unwrap_or(LimitsState { scope: self.scope, resets, ..LimitsState::default() });
        if last == Some(state) && was_moved(&state, plot) {
            state.owner = LimitsOwner::User;
        }
        if self.wheel != 0.0 && plot.response().hovered() {
            plot.zoom_bounds_around_hovered(Vec2::splat((self.wheel * ZOOM_PER_POINT).exp()));
            state.owner = LimitsOwner::User;
        } else if state.owner == LimitsOwner::Chart {
            plot.set_auto_bounds([true, true]);
            state.set = [PlotAxis::X, PlotAxis::Y].map(|axis| chart.plot_range(axis));
            if let Some((low, high)) = state.set[0] {
                plot.set_plot_bounds_x(low..=high);
            }
            if let Some((low, high)) = state.set[1] {
                plot.set_plot_bounds_y(low..=high);
            }
        }
        context.data_mut(|data| data.insert_temp(self.id, state));
    }
}

/// Returns whether the limits are not those that were set in the last frame.
fn was_moved(state: &LimitsState, plot: &PlotUi<'_>) -> bool {
    let (bounds, auto) = (plot.plot_bounds(), plot.auto_bounds());
    [PlotAxis::X, PlotAxis::Y].into_iter().any(|axis| {
        let k = axis.index();
        let is_auto = if k == 0 { auto.x } else { auto.y };
        match state.set[k] {
            Some((low, high)) => {
                let tolerance = SAME_LIMITS * (high - low).abs();
                (bounds.min()[k] - low).abs() > tolerance || (bounds.max()[k] - high).abs() > tolerance
            }
            None => !is_auto,
        }
    })
}
