//! Effects are identified in recordings under the exported controller, replayed in closed loop from its file, and played back. The binary
//! `exported_loop` does it for all eight practice effects. Each takes a minute and a half of processor time, so they are part of the evidence.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use counterpoise_tests::Threads;
use counterpoise_tests::exported_loop::{RecordedLoop, record_and_diagnose};
use counterpoise_tests::sealed::{PRACTICE, PracticeEffect};

fn effect(name: &str) -> &'static PracticeEffect {
    PRACTICE.iter().find(|effect| effect.name == name).unwrap()
}

fn assert_identified(name: &str, way: RecordedLoop) {
    let found = record_and_diagnose(effect(name), way, &Threads);
    let names: Vec<_> = found.answer.findings.iter().map(|finding| finding.name().names()).collect();
    assert!(found.is_right, "{name}, {way:?}: {:?} {names:?}", found.answer.verdict);
}

#[test]
fn an_effect_is_identified_in_closed_loop_with_the_controller_of_the_file() {
    assert_identified("out-of-balance", RecordedLoop::Exported);
}

#[test]
fn an_effect_is_identified_with_the_recorded_control_played_back() {
    assert_identified("position stiffness", RecordedLoop::PlayedBack);
}
