//! The FMI units compile in silence, describe themselves, and (in `tests/peers/fmi`) run in FMPy.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::support;

use std::process::Command;

use counterpoise_export::CodeOptions;
use counterpoise_export::ExportSource::Unverified;
use counterpoise_export::fmi::controller_unit;
use support::{STRICT, folder, is_there, provenance, run, typical_controller, write};

#[test]
fn the_controller_unit_is_complete_and_compiles_in_silence() {
    let files =
        controller_unit(Unverified(&typical_controller()), &provenance(), &CodeOptions::double("axis"))
            .unwrap();
    let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
    let expected =
        ["sources/axis.h", "sources/axis.c", "modelDescription.xml", "sources/buildDescription.xml"];
    assert!(expected.iter().all(|name| names.contains(&format!("axis/{name}").as_str())), "{names:?}");
    let description = &files.iter().find(|file| file.name.ends_with("modelDescription.xml")).unwrap().text;
    let code = &files.iter().find(|file| file.name.ends_with("fmu.c")).unwrap().text;
    let token = description.split("instantiationToken=\"").nth(1).unwrap().split('"').next().unwrap();
    assert!(token.len() == 38 && code.contains(token), "{token}");
    if !is_there("cc") {
        return support::report_skip("compilation: no C compiler");
    }
    let folder = folder("fmu_controller");
    write(&folder, &files);
    let sources = ["-fPIC", "-shared", "axis/sources/axis.c", "axis/sources/fmu.c", "-o", "axis.so"];
    assert_eq!(run(Command::new("cc").current_dir(&folder).args(STRICT).args(sources)), "");
}
