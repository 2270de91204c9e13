//! Generated C: it compiles without a word and answers what the reference answers, to the last bit.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::support;

use std::path::PathBuf;
use std::process::Command;

use counterpoise_controller::{Controller, Parts};
use counterpoise_export::ExportSource::Unverified;
use counterpoise_export::{CodeOptions, Precision, c99};
use support::{
    STRICT, Target, complete_controller, equal_to_the_last_bit, folder, is_there, provenance,
    random_controller, reference, requests, run, server, typical_controller, write,
};

/// Compiles controllers into one program that answers requests.
fn build(test: &str, controllers: &[Controller], precision: Precision, flags: &[&str]) -> PathBuf {
    let folder = folder(test);
    let mut names = Vec::new();
    let mut sources = vec!["server.c".to_owned()];
    for (i, controller) in controllers.iter().enumerate() {
        let name = format!("controller_{i}");
        let options = CodeOptions { name: name.clone(), precision };
        write(&folder, &c99(Unverified(controller), &provenance(), &options).unwrap());
        sources.push(format!("{name}.c"));
        names.push(name);
    }
    std::fs::write(folder.join("server.c"), server(&names)).unwrap();
    run(Command::new("cc").current_dir(&folder).args(flags).args(&sources).args(["-o", "server"]));
    folder.join("server")
}

#[test]
fn double_and_single_are_equal_to_the_reference_to_the_last_bit() {
    if !is_there("cc") {
        return support::report_skip("no C compiler");
    }
    let controllers = [typical_controller()];
    let asked = requests(1, 3000);
    let double = build("typical_double", &controllers, Precision::Double, &STRICT);
    let answers = Target::start(&double).ask_all(&asked);
    assert!(answers.iter().any(|u| u.abs() == 10.0) && answers.iter().any(|u| u.abs() < 9.0 && *u != 0.0));
    equal_to_the_last_bit(&answers, &reference::<f64>(&controllers, &asked));
    let single = build("typical_single", &controllers, Precision::Single, &STRICT);
    equal_to_the_last_bit(&Target::start(&single).ask_all(&asked), &reference::<f32>(&controllers, &asked));
}

/// Corrections, schedule, observers, estimator, bumpless transfer, prefilter, anti-windup: nothing is left out.
#[test]
fn a_controller_with_every_block_is_equal_to_the_reference() {
    if !is_there("cc") {
        return support::report_skip("no C compiler");
    }
    let (controllers, asked) = ([complete_controller()], requests(1, 3000));
    let double = build("complete_double", &controllers, Precision::Double, &STRICT);
    equal_to_the_last_bit(&Target::start(&double).ask_all(&asked), &reference::<f64>(&controllers, &asked));
    let single = build("complete_single", &controllers, Precision::Single, &STRICT);
    equal_to_the_last_bit(&Target::start(&single).ask_all(&asked), &reference::<f32>(&controllers, &asked));
    let code = c99(Unverified(&complete_controller()), &provenance(), &CodeOptions::double("axis")).unwrap()
        [1]
    .text
    .clone();
    for block in [
        "corrected readings",
        "reference prefilter",
        "friction observer motor_friction",
        "excess_v",
        "estimate of the out-of-balance",
        "gains and bias that belong to it",
        "the step this makes is taken out, to fade in",
    ] {
        assert!(code.contains(block), "{block}");
    }
}

/// Random controllers of each order from 1 to 40: two, or five with `EVERY_CONTROLLER` set, as in `.ci/evidence`.
fn of_each_order() -> u64 {
    if std::env::var_os("EVERY_CONTROLLER").is_some() { 5 } else { 2 }
}

#[test]
fn random_controllers_of_every_order_are_equal_to_the_reference() {
    if !is_there("cc") {
        return support::report_skip("no C compiler");
    }
    let controllers: Vec<Controller> = (0..40 * of_each_order()).map(random_controller).collect();
    let orders: Vec<usize> = controllers.iter().map(|c| c.parts().paths[0].system.order()).collect();
    assert!(
        (1..=40)
            .all(|order| orders.iter().filter(|found| **found == order).count() as u64 == of_each_order())
    );
    let flags = ["-std=c99", "-O0", "-ffp-contract=off", "-Werror", "-Wall"];
    let asked = requests(controllers.len(), 120);
    let program = build("random_double", &controllers, Precision::Double, &flags);
    equal_to_the_last_bit(&Target::start(&program).ask_all(&asked), &reference::<f64>(&controllers, &asked));
}

#[test]
fn what_is_shipped_compiles_and_passes_on_every_compiler() {
    for compiler in ["gcc", "clang"] {
        if !is_there(compiler) {
            support::report_skip(&format!("no {compiler}"));
            continue;
        }
        for (kind, options) in
            [("double", CodeOptions::double("axis")), ("single", CodeOptions::single("axis"))]
        {
            let folder = folder(&format!("shipped_{compiler}_{kind}"));
            write(&folder, &c99(Unverified(&typical_controller()), &provenance(), &options).unwrap());
            let compile = |arguments: &[&str]| {
                run(Command::new(compiler).current_dir(&folder).args(STRICT).args(arguments))
            };
            let said = compile(&["axis.c", "axis_self_test.c", "axis_test.c", "-o", "axis_test"]);
            assert_eq!(said, "");
            assert_eq!(compile(&["-c", "axis_interrupt.c"]), "");
            let outcome = run(&mut Command::new(folder.join("axis_test")));
            assert!(outcome.contains("48 samples equal to the last bit"), "{outcome}");
        }
    }
}

#[test]
fn the_self_test_sees_a_changed_coefficient() {
    if !is_there("cc") {
        return support::report_skip("no C compiler");
    }
    let folder = folder("spoilt");
    let mut files =
        c99(Unverified(&typical_controller()), &provenance(), &CodeOptions::double("axis")).unwrap();
    let coefficient = format!("{:?}", typical_controller().parts().paths[0].system.B[(3, 0)].abs());
    let nudged = files[1].text.replacen(&coefficient, &format!("1.001 * {coefficient}"), 1);
    assert_ne!(nudged, files[1].text);
    files[1].text = nudged;
    write(&folder, &files);
    let sources = ["axis.c", "axis_self_test.c", "axis_test.c"];
    run(Command::new("cc").current_dir(&folder).args(["-std=c99"]).args(sources).args(["-o", "axis_test"]));
    assert_eq!(Command::new(folder.join("axis_test")).status().unwrap().code(), Some(1));
}

#[test]
fn an_empty_controller_compiles_too() {
    if !is_there("cc") {
        return support::report_skip("no C compiler");
    }
    let folder = folder("empty");
    let controller = Controller::new(Parts::new(1e-3, 10.0)).unwrap();
    write(&folder, &c99(Unverified(&controller), &provenance(), &CodeOptions::double("nothing")).unwrap());
    let sources = ["nothing.c", "nothing_self_test.c", "nothing_test.c"];
    run(Command::new("cc").current_dir(&folder).args(STRICT).args(sources).args(["-o", "test"]));
    run(&mut Command::new(folder.join("test")));
}

#[test]
fn the_header_says_where_the_code_comes_from() {
    let files = c99(Unverified(&typical_controller()), &provenance(), &CodeOptions::double("axis")).unwrap();
    for line in provenance().lines() {
        assert!(files[0].text.contains(&line) && files[1].text.contains(&line), "{line}");
    }
    assert!(files[0].text.contains("sample-period: 0.001 s (1000 Hz)"));
}

#[test]
fn the_readme_names_what_is_there() {
    let files = c99(Unverified(&typical_controller()), &provenance(), &CodeOptions::double("axis")).unwrap();
    let readme = &files.iter().find(|file| file.name == "axis_README.md").unwrap().text;
    assert!(files.iter().all(|file| file.name.ends_with(".md") || readme.contains(&file.name)));
    for said in
        ["verified: NO", "project-hash: 0123456789abcdef", "1000 Hz", "| `hub_rate_rad_s` |", "+/- 10.0"]
    {
        assert!(readme.contains(said), "{said}");
    }
}

#[test]
fn names_that_are_no_identifiers_are_refused() {
    for name in ["", "9axis", "Axis", "an axis", "a_name_that_is_much_too_long_for_a_prefix"] {
        assert!(
            c99(Unverified(&typical_controller()), &provenance(), &CodeOptions::double(name)).is_err(),
            "{name}"
        );
    }
}

/// A name that is a keyword of a target language, or that its tools have taken.
#[test]
fn words_of_the_target_languages_are_refused() {
    for name in ["double", "match", "class", "core", "std", "test", "linux", "async"] {
        assert!(
            c99(Unverified(&typical_controller()), &provenance(), &CodeOptions::double(name)).is_err(),
            "{name}"
        );
    }
}

#[test]
fn files_of_different_exports_do_not_compile_together() {
    if !is_there("cc") {
        return support::report_skip("no C compiler");
    }
    let folder = folder("mixed_set");
    let files = |project: &str| {
        let provenance = counterpoise_export::Provenance { project: project.into(), ..provenance() };
        c99(Unverified(&typical_controller()), &provenance, &CodeOptions::double("axis")).unwrap()
    };
    write(&folder, &files("yesterday"));
    let compile = |source: &str| {
        let mut compiler = Command::new("cc");
        compiler.current_dir(&folder).args(["-std=c99", "-c", source]).output().unwrap()
    };
    for source in ["axis.c", "axis_self_test.c", "axis_interrupt.c", "axis_test.c"] {
        assert!(compile(source).status.success(), "{source}");
    }
    write(&folder, &files("today")[..1]);
    for source in ["axis.c", "axis_self_test.c", "axis_interrupt.c", "axis_test.c"] {
        let said = compile(source);
        assert!(!said.status.success(), "{source}");
        assert!(String::from_utf8_lossy(&said.stderr).contains("come from different exports"), "{source}");
    }
}
