//! The examples of the welcome page: a copy of one is written and opened.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::common;

use std::path::PathBuf;
use std::sync::Arc;

use common::{open_window, says, wait_for_files, wait_until};
use counterpoise_studio::browser::Browser;
use counterpoise_studio::command::{BrowsePurpose, Command};
use counterpoise_studio::examples::EXAMPLES;
use counterpoise_studio::studio::Studio;
use egui_kittest::kittest::Queryable;

fn empty_folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("counterpoise-examples-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn every_example_is_written_and_opens_without_errors() {
    let folder = empty_folder("all");
    let mut studio = Studio::new(&folder.join("state"), Arc::new(|| {}));
    for example in EXAMPLES {
        let command = Command::CopyExample { example: example.name.to_owned(), folder: folder.clone() };
        studio.run(&command);
        wait_for_files(&mut studio);
        let opened = studio.opened.as_ref().unwrap();
        assert_eq!(opened.path.parent().unwrap().file_name().unwrap(), example.name);
        assert!(opened.session.errors().is_empty(), "{}: {:?}", example.name, opened.session.errors());
        assert!(opened.session.project().is_some());
        for file in example.files {
            assert_eq!(std::fs::read(folder.join(example.name).join(file.name)).unwrap(), file.content);
        }
    }
    drop(studio);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn an_example_is_chosen_on_the_welcome_page_and_a_second_copy_leaves_the_first() {
    let folder = empty_folder("welcome");
    let mut window = open_window(Studio::new(&folder.join("state"), Arc::new(|| {})));
    window.run_steps(2);
    window.state_mut().view.browser = Some(Browser::new(BrowsePurpose::Project, &folder));
    wait_until(&mut window, "the list", |s| s.view.browser.as_ref().is_some_and(Browser::is_listed));
    window.run_steps(2);
    assert!(says(&window, "A copy is written into"), "the window says where");
    window.get_by_label_contains("Pan-tilt head").click();
    wait_until(&mut window, "the example", |s| s.opened.is_some());
    let first = folder.join("direct-gimbal/project.toml");
    assert!(first.is_file());
    std::fs::write(&first, "name = \"mine\"\n").unwrap();
    let again = Command::CopyExample { example: "direct-gimbal".to_owned(), folder: folder.clone() };
    window.state_mut().run(&again);
    wait_for_files(window.state_mut());
    assert!(window.state().opened.as_ref().unwrap().path.ends_with("direct-gimbal-2/project.toml"));
    assert_eq!(std::fs::read_to_string(&first).unwrap(), "name = \"mine\"\n");
    let blocked = Command::CopyExample { example: "ball-screw".to_owned(), folder: first.clone() };
    window.state_mut().run(&blocked);
    wait_for_files(window.state_mut());
    assert!(window.state().view.notice.as_ref().unwrap().text.contains("cannot be written"));
    drop(window);
    std::fs::remove_dir_all(folder).unwrap();
}
