//! Processor in the loop: the generated C cross-compiled for Cortex-M4F and M7, run bare metal in QEMU. Answers are equal
//! to the last bit; instructions, flash, memory and stack of a step are counted.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, non_snake_case)]

mod support;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use counterpoise_controller::{Controller, Number, READINGS};
use counterpoise_export::Source::Unverified;
use counterpoise_export::{File, Fixed, FixedRunner, Options, Precision, Ranges, c99, fixed_c99, plan};
use support::{
    Random, Request, STRICT, Target, equal_to_the_last_bit, folder, is_there, provenance, reference,
    requests, run, server, server_in, typical, write,
};

/// A core, QEMU's board for it, and the compiler's flags.
struct Core {
    name: &'static str,
    machine: &'static str,
    flags: [&'static str; 4],
}

const CORES: [Core; 2] = [
    Core {
        name: "Cortex-M4F",
        machine: "mps2-an386",
        flags: ["-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"],
    },
    Core {
        name: "Cortex-M7",
        machine: "mps2-an500",
        flags: ["-mcpu=cortex-m7", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv5-d16"],
    },
];

const COMPILER: &str = "arm-none-eabi-gcc";
const EMULATOR: &str = "qemu-system-arm";

fn tools_are_there() -> bool {
    let missing: Vec<&str> = [COMPILER, EMULATOR].into_iter().filter(|tool| !is_there(tool)).collect();
    if !missing.is_empty() {
        println!(
            "skipped: {} missing (apt install gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm)",
            missing.join(", ")
        );
    }
    missing.is_empty()
}

/// Cross-compiles sources in a folder, the controller itself without a warning allowed.
fn build(core: &Core, folder: &Path, own: &[&str], harness: &[&str], defines: &[&str]) -> PathBuf {
    let board = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/target");
    let common = ["-O2", "-ffp-contract=off", "-c"];
    for source in own {
        let strict = STRICT.iter().filter(|flag| !flag.starts_with("-O"));
        let stack = ["-fstack-usage"];
        run(Command::new(COMPILER)
            .current_dir(folder)
            .args(core.flags)
            .args(strict)
            .args(common)
            .args(stack)
            .arg(source));
    }
    let objects: Vec<String> = own.iter().map(|source| source.replace(".c", ".o")).collect();
    let link =
        ["-std=gnu99", "-O2", "-ffp-contract=off", "-nostartfiles", "--specs=rdimon.specs", "-I.", "-T"];
    run(Command::new(COMPILER)
        .current_dir(folder)
        .args(core.flags)
        .args(link)
        .arg(board.join("mps2.ld"))
        .arg(board.join("startup.c"))
        .args(defines)
        .args(harness)
        .args(&objects)
        .args(["-lm", "-o", "firmware.elf"]));
    folder.join("firmware.elf")
}

fn emulator(core: &Core, firmware: &Path) -> Command {
    let mut command = Command::new(EMULATOR);
    let board = ["-M", core.machine, "-nographic", "-monitor", "none", "-serial", "none"];
    command.args(board).args(["-semihosting-config", "enable=on,target=native", "-kernel"]).arg(firmware);
    command.stderr(Stdio::inherit());
    command
}

fn known_ranges(controller: &Controller) -> Ranges {
    let mut random = Random(3);
    let history: Vec<[f64; READINGS]> =
        (0..2000).map(|_| random.readings().map(|value| 0.05 * value)).collect();
    Ranges::from_readings(controller, &[history], 4.0)
}

fn fixed(controller: &Controller) -> Fixed {
    plan(controller, &known_ranges(controller), 1e-2, 2000).unwrap()
}

/// What a step costs on a core.
#[derive(Debug)]
struct Cost {
    instructions: u64,
    flash_bytes: u64,
    state_bytes: u64,
    stack_bytes: u64,
}

fn cost(core: &Core, kind: &str, files: &[File]) -> Cost {
    let folder = folder(&format!("count_{}_{kind}", core.machine));
    write(&folder, files);
    let count = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/target/count.c");
    let defines: &[&str] = if kind == "fixed" { &["-DAXIS_FIXED"] } else { &[] };
    let firmware = build(core, &folder, &["axis.c", "axis_self_test.c"], &[count.to_str().unwrap()], defines);
    let said = run(emulator(core, &firmware).args(["-icount", "shift=0"]));
    let words: Vec<&str> = said.split_whitespace().collect();
    assert_eq!(words[..2], ["wrong", "0"], "{said}");
    let number = |text: &str| text.parse::<u64>().unwrap();
    let size = run(Command::new("arm-none-eabi-size").current_dir(&folder).arg("axis.o"));
    let flash = size.lines().nth(1).unwrap().split_whitespace().next().unwrap().to_owned();
    let usage = std::fs::read_to_string(folder.join("axis.su")).unwrap();
    let stack = usage.lines().map(|line| number(line.split('\t').nth(1).unwrap())).max().unwrap();
    Cost {
        instructions: number(words[3]),
        flash_bytes: number(&flash),
        state_bytes: number(words[5]),
        stack_bytes: stack,
    }
}

#[test]
fn a_step_costs_what_its_multiplications_need() {
    if !tools_are_there() {
        return;
    }
    let controller = typical();
    let step = &controller.programs().step;
    let (multiplications, additions) = (step.multiplications(), step.additions());
    println!("one step: {multiplications} multiplications, {additions} additions");
    let exact = |options: Options| c99(Unverified(&controller), &provenance(), &options).unwrap();
    let kinds = [
        ("single", exact(Options::single("axis"))),
        ("double", exact(Options::double("axis"))),
        ("fixed", fixed_c99(Unverified(&controller), &fixed(&controller), &provenance(), "axis").unwrap()),
    ];
    for core in &CORES {
        for (kind, files) in &kinds {
            let cost = cost(core, kind, files);
            println!("{} {kind}: {cost:?}", core.name);
            if *kind == "single" {
                // One instruction each for product, sum and the load of its coefficient, one to store and one to load a
                // state; the rest is call, limits and addresses.
                let states = controller.programs().state_count();
                let needed = (2 * multiplications + additions + 2 * states) as u64;
                assert!(cost.instructions < 2000, "{cost:?}");
                assert!(
                    cost.instructions < needed + needed / 2 && cost.instructions > needed / 2,
                    "{cost:?} {needed}"
                );
            }
            assert!(cost.flash_bytes < 16 * 1024 && cost.stack_bytes < 1024, "{cost:?}");
            assert!(cost.state_bytes <= 8 * controller.programs().state_count() as u64);
        }
    }
}

/// Builds a server of one controller for a core and gives its answers.
fn answers(core: &Core, test: &str, files: &[File], main: &str, asked: &[(usize, Request)]) -> Vec<f64> {
    let folder = folder(&format!("{test}_{}", core.machine));
    write(&folder, files);
    std::fs::write(folder.join("server.c"), main).unwrap();
    let firmware = build(core, &folder, &["controller_0.c"], &["server.c"], &[]);
    Target::launch(&mut emulator(core, &firmware)).ask_all(asked)
}

fn compare<N: Number>(core: &Core, precision: Precision) {
    let (controllers, asked) = ([typical()], requests(1, 600));
    let options = Options { name: "controller_0".into(), precision };
    let files = c99(Unverified(&controllers[0]), &provenance(), &options).unwrap();
    let main = server(&["controller_0".into()]);
    let found = answers(core, &format!("answers_{precision:?}"), &files, &main, &asked);
    equal_to_the_last_bit(&found, &reference::<N>(&controllers, &asked));
}

#[test]
fn floating_point_answers_are_equal_to_the_last_bit() {
    if !tools_are_there() {
        return;
    }
    for core in &CORES {
        compare::<f32>(core, Precision::Single);
        compare::<f64>(core, Precision::Double);
    }
}

#[test]
fn fixed_point_answers_are_equal() {
    if !tools_are_there() {
        return;
    }
    let fixed = fixed(&typical());
    let files = fixed_c99(Unverified(&fixed.controller), &fixed, &provenance(), "controller_0").unwrap();
    let main = server_in(&["controller_0".into()], |_| "int32_t".into());
    let mut random = Random(8);
    let mut runner = FixedRunner::new(&fixed);
    let integers: Vec<[f64; READINGS]> =
        (0..600).map(|_| std::array::from_fn(|_| (2147483647.0 * random.signed()).round())).collect();
    let asked: Vec<(usize, Request)> =
        integers.iter().map(|readings| (0, Request::Step(*readings))).collect();
    let expected: Vec<f64> = integers
        .iter()
        .map(|readings| runner.step_integers(&readings.map(|value| value as i64)) as f64)
        .collect();
    for core in &CORES {
        assert_eq!(answers(core, "answers_fixed", &files, &main, &asked), expected);
    }
}
