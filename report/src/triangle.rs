//! A triangle of the demand, as a section.

use counterpoise_models::{ControlledQuantity, QuantityKind};
use counterpoise_verify::{Experiment, History, HistoryColumn, Model, Verification};

use crate::ReportSection;
use counterpoise_plot::thinning::MOST_POINTS;
use counterpoise_plot::{Axis, Colour, Dash, Figure, Panel, Point, Series};

const MODELS: [(Model, &str, Colour, Dash); 2] = [
    (Model::Linear, "linear plant", Colour::Muted, Dash::Dashed),
    (Model::Nonlinear, "nonlinear plant", Colour::First, Dash::Solid),
];

/// Draws hub rate, error and control while the demand is a triangle, and control against rate. Returns `None` if no triangle was run.
pub fn triangle_section(found: &Verification) -> Option<ReportSection> {
    let runs: Vec<Run<'_>> = MODELS
        .iter()
        .filter_map(|&(model, name, colour, dash)| {
            let history = found.history(model, Experiment::Triangle)?;
            Some(Run { history, name, colour, dash })
        })
        .collect();
    let first = runs.first()?.history;
    let text = "With a triangle, control against hub rate shows the out-of-balance as an offset, Coulomb friction as a step at zero rate, \
                viscous friction as the slope of the lobes and inertia as the width of the loop.";
    let controlled = found.controlled_quantity();
    let section = ReportSection::new(&format!("Triangle of the demanded {}", controlled.name()));
    let section = if controlled.kind == QuantityKind::Rate { section.with_text(text) } else { section };
    Some(section.with_figures([over_time(&runs, first, controlled), loops(&runs, controlled)]))
}

/// A plant's history and how it is drawn.
struct Run<'a> {
    history: &'a History,
    name: &'static str,
    colour: Colour,
    dash: Dash,
}

impl Run<'_> {
    fn series(&self, points: Vec<Point>) -> Series {
        Series::new(self.name, self.colour, self.dash, points)
    }
}

fn over_time(runs: &[Run<'_>], first: &History, controlled: ControlledQuantity) -> Figure {
    let of = |column: HistoryColumn| -> Vec<Series> {
        let points = |history: &History| -> Vec<Point> {
            history
                .time_s()
                .iter()
                .zip(history.signals.column(column))
                .map(|(time, value)| Point::new(*time, *value))
                .collect()
        };
        runs.iter().map(|run| run.series(points(run.history))).collect()
    };
    let mut rates = of(HistoryColumn::HubRate);
    let demand = first.time_s().iter().copied().zip(first.demand_rad_s().iter().copied());
    rates.push(Series::dotted_line("demand", Colour::Third, demand));
    let error = |run: &Run<'_>| {
        let errors = run.history.tracking_error_rad_s();
        let points = run.history.time_s().iter().zip(&errors);
        run.series(points.map(|(time, error)| Point::new(*time, 1e3 * error)).collect())
    };
    let errors = runs.iter().map(error).collect();
    let panels = vec![
        Panel::new(Axis::linear(controlled.name(), controlled.unit()), rates).with_height(150.0),
        Panel::new(Axis::linear("error", controlled.milli_unit()), errors).with_height(130.0),
        Panel::new(Axis::linear("control", "V"), of(HistoryColumn::Control)).with_height(130.0),
    ];
    Figure::new("Triangle of the demand", Axis::linear("time", "s"), panels)
}

/// Control against rate over the second half; few enough points that none is left out in drawing.
fn loops(runs: &[Run<'_>], controlled: ControlledQuantity) -> Figure {
    let one = |run: &Run<'_>| {
        let history = run.history;
        let half = history.len() / 2;
        let every = (history.len() - half).div_ceil(MOST_POINTS).max(1);
        let samples = (half..history.len()).step_by(every);
        let point = |k: usize| Point::new(1e3 * history.hub_rate_rad_s()[k], history.control_v()[k]);
        run.series(samples.map(point).collect())
    };
    let panel = Panel::new(Axis::linear("control", "V"), runs.iter().map(one).collect()).with_height(300.0);
    let title = format!("Control against {}", controlled.name());
    Figure::new(&title, Axis::linear(controlled.name(), controlled.milli_unit()), vec![panel])
}
