//! The thesis' claims on the reference rig: every row is there, and what it is known to find stays found.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_claims::{Claim, Finding, claims};
use counterpoise_pipeline::World;
use counterpoise_project::Project;

struct Example;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/reference-rig/");

impl World for Example {
    fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        std::fs::read(format!("{FOLDER}{name}")).map_err(|error| error.to_string())
    }
}

/// Every row shows what decided it: axes with their quantity, curves with names and numbers.
fn drawn(row: &Claim) {
    assert!(!row.pictures.is_empty(), "{}: no picture", row.id);
    for picture in &row.pictures {
        assert!(!picture.title.is_empty() && !picture.x.quantity.is_empty(), "{}", row.id);
        for panel in &picture.panels {
            assert!(
                !panel.y.quantity.is_empty() && !panel.curves.is_empty(),
                "{}: {}",
                row.id,
                picture.title
            );
            for curve in &panel.curves {
                let sound = curve.points.iter().filter(|point| point.0.is_finite() && point.1.is_finite());
                assert!(sound.count() > 0 && !curve.name.is_empty(), "{}: {}", row.id, picture.title);
            }
        }
    }
}

#[test]
fn every_claim_of_the_thesis_is_answered_on_the_reference_rig() {
    let text = std::fs::read_to_string(format!("{FOLDER}project.toml")).unwrap();
    let project = Project::parse(&text, "project.toml").unwrap().project;
    let rows = claims(&project, &Example, &|_| true, &|_, _| {}).unwrap();
    for row in &rows {
        println!("{:4} {:?}\n     {}\n     {}", row.id, row.finding, row.says, row.measured);
        assert!(!row.measured.contains("NaN"), "{}: {}", row.id, row.measured);
    }
    let thesis = (1..=27).map(|k| format!("C{k}"));
    let ids: Vec<String> = thesis.chain((1..=4).map(|k| format!("F{k}"))).collect();
    for row in &rows {
        assert!(!matches!(row.finding, Finding::NotMeasured { .. }), "{}", row.id);
        if let Finding::Differs { why } = &row.finding {
            assert!(!why.is_empty(), "{}", row.id);
        }
        drawn(row);
    }
    assert_eq!(rows.iter().map(|row| row.id).collect::<Vec<_>>(), ids);
    for id in ["C5", "C7", "C19", "C20"] {
        let row = rows.iter().find(|row| row.id == id).unwrap();
        assert_eq!(row.finding, Finding::Holds, "{id}: {}", row.measured);
    }
}
