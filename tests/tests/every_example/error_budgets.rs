//! The error budget of examples whose loop holds a rate: its shares add up to the error that the simulator shows.

use std::path::Path;
use std::sync::Mutex;

use counterpoise_models::Plant;
use counterpoise_pipeline::project_procedure;
use counterpoise_tests::examples;
use counterpoise_verify::robustness::figures_of;
use counterpoise_verify::{
    LineOfSight, PerformanceFigure, Procedure, Road, SightFigure, Value, error_budget,
};

/// The shares and the simulated error agree within this, as a share of the error.
const SUM: f64 = 0.05;
/// Length of a run and of its settling, s: enough for several periods of a loop of 10 Hz.
const RUN_S: f64 = 0.6;
const SETTLE_S: f64 = 0.2;

/// The beginning of a road.
fn cut(road: &Road) -> Road {
    let kept = (RUN_S / road.sample_period_s).ceil() as usize + 1;
    let mut road = road.clone();
    road.signals.truncate(kept);
    road
}

/// Returns what is wrong with the budget of an example, and the number of its sources; `None` if its loop holds no rate.
fn budget(path: &Path) -> Option<Result<usize, String>> {
    let designed = examples::design_example(path)?;
    let whole = project_procedure(&designed.project, &examples::world(path)).unwrap();
    let asked = Procedure {
        road: whole.road.as_ref().map(cut),
        duration_s: RUN_S.min(whole.duration_s),
        settle_s: SETTLE_S.min(whole.settle_s),
        line_of_sight: Some(LineOfSight::default()),
        ..whole
    };
    let (plant, controller): (&Plant, _) = (&designed.modelled.plant, &designed.made.sampled.controller);
    let budget = error_budget(plant, controller, &asked).unwrap()?;
    let figures = SightFigure::ANGLES.map(PerformanceFigure::Sight);
    let simulated = figures_of(plant, controller, &asked, &figures).unwrap();
    let mut wrong = Vec::new();
    for ((figure, value), sum) in figures.iter().zip(simulated).zip(budget.sum_rad()) {
        let Value::Is(value) = value else { continue };
        let apart = (sum - value).abs();
        if apart > SUM * value || apart.is_nan() {
            wrong.push(format!("{}: {figure}: {sum} {value}", examples::name(path)));
        }
    }
    Some(if wrong.is_empty() { Ok(budget.contributions.len()) } else { Err(wrong.join("\n")) })
}

#[test]
fn shares_add_up_to_the_simulated_error() {
    let files = examples::chosen_files();
    let found = Mutex::new(Vec::new());
    counterpoise_tests::run_in_parallel(files.len(), &|k| found.lock().unwrap().extend(budget(&files[k])));
    let found = found.into_inner().unwrap();
    let wrong: Vec<&String> = found.iter().filter_map(|one| one.as_ref().err()).collect();
    assert!(wrong.is_empty(), "{wrong:?}");
    let sources: Vec<usize> = found.into_iter().flatten().collect();
    assert!(sources.len() >= 4, "{} budgets", sources.len());
    assert!(sources.iter().all(|count| *count >= 3), "{sources:?}");
}
