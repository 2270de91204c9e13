//! The generated Rust crate: no warning, its own tests pass, and it answers what the reference answers.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

use crate::support;

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::Command;

use counterpoise_controller::{Controller, Parts, READING_NAMES};
use counterpoise_export::ExportSource::Unverified;
use counterpoise_export::{CodeOptions, Precision, rust_crate};
use support::{
    Target, complete_controller, equal_to_the_last_bit, folder, provenance, random_controller, reference,
    requests, run, typical_controller, write,
};

fn rustc() -> Command {
    Command::new(std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()))
}

/// Returns a crate a controller, and a program that answers requests.
fn build(test: &str, controllers: &[Controller], precision: Precision) -> PathBuf {
    let folder = folder(test);
    let (mut modules, mut starts, mut arms) = (String::new(), String::new(), String::new());
    for (i, controller) in controllers.iter().enumerate() {
        let name = format!("controller_{i}");
        let options = CodeOptions { name: name.clone(), precision };
        write(&folder, &rust_crate(Unverified(controller), &provenance(), &options).unwrap());
        let source = format!("{name}/src/lib.rs");
        let flags =
            ["--edition=2021", "--crate-type=lib", "-Dwarnings", "-L.", "--crate-name", &name, &source];
        run(rustc().current_dir(&folder).args(flags));
        writeln!(modules, "extern crate {name};").unwrap();
        writeln!(starts, "let mut state_{i} = {name}::Controller::new();").unwrap();
        let fields: Vec<String> = READING_NAMES[..controller.parts().reading_count()]
            .iter()
            .enumerate()
            .map(|(k, field)| format!("{field}: v[{}] as _", k + 2))
            .collect();
        writeln!(
            arms,
            "{i} => match v[1] as i32 {{ 0 => {{ state_{i}.reset(); 0.0 }} 1 => {{ state_{i}.set_out_of_balance(v[2] as _); 0.0 }} _ => f64::from(state_{i}.step(&{name}::Readings {{ {} }})) }},",
            fields.join(", ")
        )
        .unwrap();
    }
    let text = format!(
        "{modules}\nuse std::io::{{Read, Write}};\nfn main() {{\n{starts}\nlet mut bytes = [0u8; 72];\nwhile std::io::stdin().read_exact(&mut bytes).is_ok() {{\nlet v: Vec<f64> = bytes.chunks(8).map(|c| f64::from_ne_bytes(c.try_into().unwrap())).collect();\nlet out: f64 = match v[0] as i32 {{ {arms} _ => 0.0 }};\nstd::io::stdout().write_all(&out.to_ne_bytes()).unwrap();\n}}\nstd::io::stdout().flush().unwrap();\n}}\n"
    );
    std::fs::write(folder.join("server.rs"), text).unwrap();
    run(rustc().current_dir(&folder).args(["--edition=2021", "-L.", "server.rs", "-o", "server"]));
    folder.join("server")
}

#[test]
fn double_and_single_are_equal_to_the_reference_to_the_last_bit() {
    let controllers = [typical_controller(), complete_controller()];
    let asked = requests(2, 2000);
    let double = build("rust_double", &controllers, Precision::Double);
    equal_to_the_last_bit(&Target::start(&double).ask_all(&asked), &reference::<f64>(&controllers, &asked));
    let single = build("rust_single", &controllers, Precision::Single);
    equal_to_the_last_bit(&Target::start(&single).ask_all(&asked), &reference::<f32>(&controllers, &asked));
}

#[test]
fn random_controllers_are_equal_to_the_reference() {
    let mut controllers: Vec<Controller> = (200..212).map(random_controller).collect();
    controllers.push(Controller::new(Parts::new(1e-3, 10.0)).unwrap());
    let asked = requests(controllers.len(), 150);
    let program = build("rust_random", &controllers, Precision::Double);
    equal_to_the_last_bit(&Target::start(&program).ask_all(&asked), &reference::<f64>(&controllers, &asked));
}

#[test]
fn the_crate_passes_its_own_tests() {
    let folder = folder("rust_own_tests");
    write(
        &folder,
        &rust_crate(Unverified(&typical_controller()), &provenance(), &CodeOptions::single("axis")).unwrap(),
    );
    let source = folder.join("axis/src/lib.rs");
    let lib = ["--edition=2021", "--crate-type=lib", "--crate-name=axis", "-Dwarnings"];
    run(rustc().current_dir(&folder).args(lib).arg(source));
    let tests = folder.join("axis/tests/vectors.rs");
    run(rustc()
        .current_dir(&folder)
        .args(["--edition=2021", "--test", "-L.", "--extern", "axis", "-Dwarnings"])
        .arg(tests));
    assert!(run(&mut Command::new(folder.join("vectors"))).contains("1 passed"));
}
