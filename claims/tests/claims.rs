//! The thesis' claims on the reference rig: every row is there, and what it is known to find stays found.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_claims::{Claim, ClaimOutcome, measure_claims};
use counterpoise_host::workers::QuietPool;
use counterpoise_pipeline::World;
use counterpoise_plot::Content;
use counterpoise_pool::Pool;
use counterpoise_project::Project;

struct Example;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/reference-rig/");

impl World for Example {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        std::fs::read(format!("{FOLDER}{name}")).map_err(|error| error.to_string())
    }

    fn pool(&self) -> &dyn Pool {
        &QuietPool
    }
}

/// Every row shows what decided it: axes with their quantity, curves with names and numbers.
fn check_drawings(row: &Claim) {
    assert!(!row.drawings.is_empty(), "{}: no figure", row.id);
    for figure in &row.drawings {
        let Content::Panels(all) = &figure.content else { panic!("{}: no panels", row.id) };
        assert!(!figure.title.is_empty() && !all.x.label.is_empty(), "{}", row.id);
        for panel in &all.panels {
            assert!(!panel.y.label.is_empty() && !panel.series.is_empty(), "{}: {}", row.id, figure.title);
            for curve in &panel.series {
                let sound =
                    curve.points.rows().into_iter().filter(|point| point.iter().all(|v| v.is_finite()));
                assert!(sound.count() > 0 && !curve.name.is_empty(), "{}: {}", row.id, figure.title);
            }
        }
    }
}

/// A row fails if any one of its measured figures is outside what the thesis says and outside what the explanation predicts.
fn fails_if_any_figure_is_elsewhere(row: &Claim) {
    for (k, one) in row.criteria.iter().enumerate() {
        let ranges = [Some(one.accepted), one.explained];
        let low = ranges.iter().flatten().map(|range| range.0).fold(f64::INFINITY, f64::min);
        let high = ranges.iter().flatten().map(|range| range.1).fold(f64::NEG_INFINITY, f64::max);
        let beyond = [low - 1e-6 * low.abs().max(1.0), high + 1e-6 * high.abs().max(1.0), f64::NAN];
        let wrong: Vec<f64> = beyond.into_iter().filter(|value| !value.is_infinite()).collect();
        assert!(wrong.len() > 1, "{}: {} cannot fail", row.id, one.what);
        for measured in wrong {
            let mut other = row.clone();
            other.criteria[k].measured = measured;
            assert_eq!(other.finding(), ClaimOutcome::Fails, "{}: {} at {measured}", row.id, one.what);
        }
    }
}

#[test]
fn every_claim_of_the_thesis_is_answered_on_the_reference_rig() {
    let text = std::fs::read_to_string(format!("{FOLDER}project.toml")).unwrap();
    let project = Project::parse(&text, "project.toml").unwrap().project;
    let rows = measure_claims(&project, &Example, &|_| true, &|_, _| {}).unwrap();
    for row in &rows {
        println!("{:4} {:?}\n     {}\n     {}", row.id, row.finding(), row.says, row.measured);
        assert!(!row.measured.contains("NaN"), "{}: {}", row.id, row.measured);
    }
    let thesis = (1..=34).map(|k| format!("C{k}"));
    let ids: Vec<String> = thesis.chain((1..=4).map(|k| format!("F{k}"))).collect();
    for row in &rows {
        assert!(!matches!(row.finding(), ClaimOutcome::NotMeasured { .. }), "{}", row.id);
        if let ClaimOutcome::Differs { why } = row.finding() {
            assert!(!why.is_empty(), "{}", row.id);
        }
        for one in &row.criteria {
            assert!(!one.reason.is_empty() && !one.thesis.is_empty(), "{}: {}", row.id, one.what);
            let (low, high) = one.accepted;
            assert!(low.is_finite() || high.is_finite(), "{}: {} cannot fail", row.id, one.what);
        }
        fails_if_any_figure_is_elsewhere(row);
        check_drawings(row);
    }
    assert_eq!(rows.iter().map(|row| row.id).collect::<Vec<_>>(), ids);
    for id in ["C5", "C7", "C19", "C20"] {
        let row = rows.iter().find(|row| row.id == id).unwrap();
        assert_eq!(row.finding(), ClaimOutcome::Holds, "{id}: {}", row.measured);
    }
}
