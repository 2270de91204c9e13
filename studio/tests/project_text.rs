//! The page Text: a broken file is corrected in the window, and what is typed is an edit like every other.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use std::time::{Duration, Instant};

use common::{StudioHarness, bench, crash, rest, rig, says, studio, text, wait_until};
use counterpoise_studio::command::{Command, Page};
use counterpoise_studio::offscreen::OffscreenStudio;
use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};

/// Types a text where the cursor stands, letter by letter.
fn type_text(bench: &mut StudioHarness, text: &str) {
    for letter in text.chars() {
        bench.event(egui::Event::Text(letter.to_string()));
        bench.run_steps(2);
    }
}

#[test]
fn a_broken_file_is_mended_where_it_is_shown_and_saved() {
    let folder = rig("corrected");
    let path = folder.join("project.toml");
    let good = std::fs::read_to_string(&path).unwrap();
    let broken =
        good.replace("\nstiffness = 2.4e6", "\nstifness = 2.4e6").replace("\nbacklash =", "\nbcklash =");
    std::fs::write(&path, broken).unwrap();
    let mut bench = bench(&folder);
    rest(&mut bench);
    assert_eq!(bench.state().view.page, Page::Text, "a file that was never read opens on its text");
    let count = bench.state().opened.as_ref().unwrap().session.errors().len();
    assert!(count >= 2 && says(&bench, &format!("{count} errors")));
    for (wrong, from) in [("stifness", 4), ("bcklash", 1)] {
        let error = bench
            .query_all_by_label_contains(wrong)
            .find(|node| node.accesskit_node().label().unwrap_or_default().starts_with("line "));
        error.unwrap().click();
        rest(&mut bench);
        let place = text(&bench).find(wrong).unwrap();
        let line = text(&bench)[..place].matches('\n').count() + 1;
        assert!(says(&bench, &format!("line {line}: ")), "{wrong}");
        // the cursor stands at the word
        (0..from).for_each(|_| bench.key_press(Key::ArrowRight));
        bench.run_steps(1);
        type_text(&mut bench, if wrong == "stifness" { "f" } else { "a" });
        assert!(!text(&bench).contains(wrong), "{wrong} is corrected");
    }
    rest(&mut bench);
    assert!(says(&bench, "No errors"));
    assert_eq!(text(&bench), good);
    assert!(bench.state().results.design.is_some(), "the design follows");
    bench.key_press_modifiers(Modifiers::COMMAND, Key::S);
    rest(&mut bench);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), good);
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn letters_typed_in_one_go_are_one_step_of_undo_and_come_back_after_a_crash() {
    let folder = rig("typed");
    let mut window = bench(&folder);
    rest(&mut window);
    let before = text(&window);
    window.state_mut().run(&Command::ShowLine { line: 1, column: 1 });
    rest(&mut window);
    type_text(&mut window, "# ab");
    window.key_press(Key::Enter);
    window.run_steps(2);
    assert_eq!(text(&window), format!("# ab\n{before}"));
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.run_steps(2);
    assert_eq!(text(&window), format!("# ab{before}"), "a new line is a step of its own");
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.run_steps(2);
    assert_eq!(text(&window), before);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Y);
    rest(&mut window);
    wait_until(&mut window, "the journal", |studio| studio.is_idle());
    std::thread::sleep(Duration::from_millis(50));
    crash(window);
    let again = studio(&folder);
    assert_eq!(again.opened.as_ref().unwrap().session.text(), format!("# ab{before}"));
    drop(again);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn an_error_that_is_typed_is_told_at_once_and_leads_back_from_every_page() {
    let folder = rig("typo");
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.state_mut().run(&Command::ShowLine { line: 2, column: 1 });
    rest(&mut bench);
    type_text(&mut bench, "]");
    rest(&mut bench);
    assert!(says(&bench, "error"), "the error is in the list");
    bench.state_mut().run(&Command::Go { page: Page::Design });
    rest(&mut bench);
    assert!(says(&bench, "plot: Loop gain"), "the last design stays");
    bench.get_by_label("Correct the text").click();
    rest(&mut bench);
    assert_eq!(bench.state().view.page, Page::Text);
    bench.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    rest(&mut bench);
    assert!(says(&bench, "No errors"));
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_word_is_found_and_the_key_at_the_cursor_is_explained() {
    let folder = rig("found");
    let mut bench = bench(&folder);
    rest(&mut bench);
    bench.state_mut().run(&Command::Go { page: Page::Text });
    rest(&mut bench);
    bench.key_press_modifiers(Modifiers::COMMAND, Key::F);
    bench.run_steps(2);
    type_text(&mut bench, "backlash =");
    bench.key_press(Key::Enter);
    rest(&mut bench);
    assert!(says(&bench, "plant.gearbox.backlash"), "the path of the key");
    assert!(says(&bench, "allowed:"), "its range");
    drop(bench);
    std::fs::remove_dir_all(folder).unwrap();
}

/// The text of a project of five thousand lines, drawn again and again: figures are printed, for a loaded machine tells nothing.
#[test]
fn a_long_text_is_drawn() {
    let folder = rig("long");
    let path = folder.join("project.toml");
    let comment = "# a comment of a line that is as long as a line of a project file usually is\n";
    let long = format!("{}{}", std::fs::read_to_string(&path).unwrap(), comment.repeat(5000));
    std::fs::write(&path, long).unwrap();
    let mut seat = OffscreenStudio::new(&folder.join("state"), [1280.0, 800.0]);
    seat.run_script(
        vec![Command::Open { path: folder.clone() }, Command::ShowLine { line: 2500, column: 1 }],
        &mut counterpoise_studio::frame_log::FrameLog::new(None),
    );
    let mut took: Vec<f64> = Vec::new();
    for _ in 0..30 {
        let begun = Instant::now();
        drop(seat.draw_frame(Vec::new()));
        took.push(begun.elapsed().as_secs_f64() * 1e3);
    }
    took.sort_by(f64::total_cmp);
    eprintln!("a text of 5000 lines: median {:.2} ms, largest {:.2} ms", took[15], took[29]);
    drop(seat);
    std::fs::remove_dir_all(folder).unwrap();
}
