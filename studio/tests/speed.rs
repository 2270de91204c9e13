//! What the live road takes while a weight is dragged; printed, for a loaded machine tells nothing (`-- --nocapture`).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::Arc;

use counterpoise_project::{Attachments, Project};
use counterpoise_studio::command::Command;
use counterpoise_studio::live::{Ask, Cache, live};
use counterpoise_studio::session::Session;

const TEXT: &str = include_str!("../../examples/reference-rig/project.toml");

#[test]
fn every_revision_of_a_drag_is_designed() {
    let mut session = Session::new(TEXT, "project.toml", Attachments::none());
    let mut cache = Cache::default();
    let mut took: Vec<f64> = Vec::new();
    for k in 0..60 {
        let value = 25.0 + 0.2 * f64::from(k);
        let path = "synth.feedback.error.gain".to_owned();
        session.apply(&Command::Set { path, value, gesture: Some(1) }).unwrap();
        let project: Arc<Project> = Arc::clone(session.project().unwrap());
        let ask = Ask { project, out_of_balance_kg_m: None };
        let made = live(&ask, &mut cache).unwrap();
        assert!(made.margins.closed_loop_stable);
        took.push(made.took.as_secs_f64() * 1e3);
    }
    took.sort_by(f64::total_cmp);
    eprintln!("live road: median {:.2} ms, 95 % {:.2} ms, largest {:.2} ms", took[30], took[57], took[59]);
}
