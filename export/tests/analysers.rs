//! Static analysers on the generated C: not a word from Clang's analyser and cppcheck, nothing suppressed; MISRA C:2012
//! deviations are those that the code itself lists.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::support;

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::Command;

use counterpoise_controller::READINGS;
use counterpoise_export::ExportSource::Unverified;
use counterpoise_export::fmi::{PlantUnit, controller_unit, plant_unit};
use counterpoise_export::{CodeOptions, Ranges, c99, fixed_c99, plan_fixed_point};
use counterpoise_models::{Plant, reference};
use support::{
    RandomGenerator, complete_controller, folder, is_there, provenance, run, typical_controller, write,
};

/// Rules that generated code deviates from, all advisory.
const DEVIATIONS: [&str; 2] = ["misra-c2012-2.5", "misra-c2012-8.7"];

/// Returns a folder for each kind of generated C.
fn generate_folders(test: &str) -> Vec<PathBuf> {
    let controller = typical_controller();
    let mut random = RandomGenerator(3);
    let history: Vec<[f64; READINGS]> =
        (0..2000).map(|_| random.readings().map(|value| 0.05 * value)).collect();
    let known = Ranges::from_readings(&controller, &[history], 4.0);
    let fixed = plan_fixed_point(&controller, &known, 1e-2, 2000).unwrap();
    let kinds = [
        ("double", c99(Unverified(&controller), &provenance(), &CodeOptions::double("axis")).unwrap()),
        (
            "complete",
            c99(Unverified(&complete_controller()), &provenance(), &CodeOptions::single("axis")).unwrap(),
        ),
        ("single", c99(Unverified(&controller), &provenance(), &CodeOptions::single("axis")).unwrap()),
        ("fixed", fixed_c99(Unverified(&controller), &fixed, &provenance(), "axis").unwrap()),
    ];
    let place = |(kind, files): &(&str, Vec<counterpoise_export::File>)| {
        let folder = folder(&format!("{test}_{kind}"));
        write(&folder, files);
        folder
    };
    kinds.iter().map(place).collect()
}

#[test]
fn clangs_analyser_is_silent() {
    if !is_there("clang") {
        return support::report_skip("no clang");
    }
    for folder in generate_folders("clang_analyser") {
        for source in ["axis.c", "axis_self_test.c", "axis_test.c"] {
            let flags =
                ["--analyze", "-Xanalyzer", "-analyzer-output=text", "-std=c99", "-Wall", "-Wextra", source];
            assert_eq!(run(Command::new("clang").current_dir(&folder).args(flags)), "");
        }
    }
}

#[test]
fn cppcheck_is_silent() {
    if !is_there("cppcheck") {
        return support::report_skip("no cppcheck (apt install cppcheck)");
    }
    for folder in generate_folders("cppcheck") {
        let flags =
            ["--std=c99", "--quiet", "--enable=warning,style,performance,portability", "--error-exitcode=1"];
        assert_eq!(run(Command::new("cppcheck").current_dir(&folder).args(flags).arg(".")), "");
    }
}

#[test]
fn misra_deviations_are_the_ones_listed() {
    if !is_there("cppcheck") {
        return support::report_skip("no cppcheck (apt install cppcheck)");
    }
    for folder in generate_folders("misra") {
        let flags = ["--addon=misra", "--std=c99", "--quiet", "--enable=style", "axis.c"];
        let said = run(Command::new("cppcheck").current_dir(&folder).args(flags));
        let rules: BTreeSet<&str> =
            said.split(['[', ']']).filter(|word| word.starts_with("misra-c2012-")).collect();
        assert_eq!(rules, BTreeSet::from(DEVIATIONS), "{said}");
        let code = std::fs::read_to_string(folder.join("axis.c")).unwrap();
        assert!(code.contains("only the advisory rules 2.5 and 8.7"));
    }
}

/// Returns the units of controller and plant, each in a folder; the plant has every law that its C knows.
fn units(test: &str) -> Vec<(PathBuf, Vec<String>)> {
    let plant = Plant::from_lumped(&reference::rig()).unwrap();
    let asked = PlantUnit { plant: &plant, name: "rig" };
    let kinds = [
        (
            "axis",
            controller_unit(Unverified(&complete_controller()), &provenance(), &CodeOptions::double("axis"))
                .unwrap(),
        ),
        ("rig", plant_unit(asked, &provenance()).unwrap()),
    ];
    let place = |(name, files): &(&str, Vec<counterpoise_export::File>)| {
        let folder = folder(&format!("{test}_{name}_unit"));
        write(&folder, files);
        (folder.join(name).join("sources"), vec![format!("{name}.c"), "fmu.c".to_owned()])
    };
    kinds.iter().map(place).collect()
}

#[test]
fn the_analysers_are_silent_on_fmi_units() {
    for (folder, sources) in units("analysed") {
        if is_there("clang") {
            let flags = ["--analyze", "-Xanalyzer", "-analyzer-output=text", "-std=c99", "-Wall", "-Wextra"];
            let said = run(Command::new("clang").current_dir(&folder).args(flags).args(&sources));
            assert_eq!(said, "");
        } else {
            support::report_skip("clang's analyser: no clang");
        }
        if is_there("cppcheck") {
            let flags = ["--std=c99", "--quiet", "--enable=warning,style,performance,portability"];
            let said = run(Command::new("cppcheck")
                .current_dir(&folder)
                .args(flags)
                .arg("--error-exitcode=1")
                .args(&sources));
            assert_eq!(said, "");
        } else {
            support::report_skip("no cppcheck (apt install cppcheck)");
        }
    }
}
